//! What passes over neighbouring elements do side by side becomes instructions on 16 bytes; what may not, does not.

use super::optimised;

const DECLARATIONS: &str = "x, y, z : ARRAY [0..39] OF REAL; d, e : ARRAY [0..39] OF DINT; t : ARRAY [0..39] OF BOOL;
    m, n, p : ARRAY [0..8, 0..7] OF LREAL; q : ARRAY [0..7, 0..7] OF LREAL; i, j, k : INT; l : LINT; a : REAL; s : LREAL; b : BOOL;";

/// Body; an instruction that is there, or none.
const BODIES: &[(&str, Option<&str>)] = &[
    ("FOR i := 0 TO 39 DO y[i] := a * x[i] + y[i]; END_FOR;", Some("fadd")),
    ("FOR i := 3 TO 37 DO y[i] := a / x[i]; END_FOR;", Some("fdiv")),
    ("FOR i := 0 TO 39 DO y[i] := MAX(x[i], z[i]); END_FOR;", Some("bitselect")),
    ("FOR i := 0 TO 39 DO y[i] := SEL(x[i] < a AND z[i] > a, x[i], z[i]); END_FOR;", Some("bitselect")),
    ("FOR i := 0 TO 39 DO IF b THEN y[i] := SQRT(x[i]); END_IF; END_FOR;", Some("sqrt")),
    ("FOR i := 0 TO 39 DO d[i] := MIN(d[i] * 3, e[i]); END_FOR;", Some("smin")),
    // Each element is read before the pass that writes it, or after it, as in single passes.
    ("FOR l := 0 TO 38 DO x[l] := x[l + 1] * a; END_FOR;", Some("fmul")),
    ("FOR l := 4 TO 39 DO x[l] := x[l - 4] * a; END_FOR;", Some("fmul")),
    ("FOR l := 0 TO 7 DO FOR j := 0 TO 7 DO m[l, j] := m[l, j] * 0.9 + m[l + 1, j]; END_FOR; END_FOR;", Some("fadd")),
    (
        "FOR i := 0 TO 7 DO FOR j := 0 TO 7 DO s := 0.0; FOR k := 0 TO 7 DO s := s + m[i, k] * q[k, j]; END_FOR;
         p[i, j] := s; END_FOR; END_FOR;",
        Some("fadd"),
    ),
    // A sum has an order.
    ("FOR i := 0 TO 39 DO a := a + x[i]; y[i] := a; END_FOR;", None),
    ("FOR l := 1 TO 39 DO x[l] := x[l - 1] * a; END_FOR;", None),
    ("FOR l := 3 TO 39 DO x[l] := x[l - 3] * a; END_FOR;", None),
    ("FOR l := 0 TO 38 DO x[l + 1] := a; y[l] := x[l] * a; x[l] := y[l] - a; END_FOR;", None),
    // What is the same for all may not change meanwhile.
    ("FOR i := 0 TO 39 DO y[i] := y[7] * x[i]; END_FOR;", None),
    // The outer loop goes over neighbours.
    ("FOR i := 0 TO 7 DO FOR j := 0 TO 7 DO q[j, i] := m[j, i] * 0.5; END_FOR; END_FOR;", Some("fmul")),
    // Not neighbours.
    ("FOR i := 0 TO 19 DO y[2 * i] := x[2 * i] * a; END_FOR;", None),
    // Each element goes its own way.
    ("FOR i := 0 TO 39 DO IF t[i] THEN y[i] := x[i] * a; ELSE z[i] := a; END_IF; END_FOR;", None),
    (
        "FOR i := 0 TO 7 DO FOR j := 0 TO 7 DO s := 0.0; FOR k := 0 TO 7 DO s := s + m[i, k] * q[k, j]; END_FOR;
         q[i, j] := s; END_FOR; END_FOR;",
        None,
    ),
];

#[test]
fn neighbours_are_done_together() {
    let mut wrong = Vec::new();
    for (body, expected) in BODIES {
        let program = optimised(DECLARATIONS, body);
        let text = plcc_codegen::text::emit_clif(&program, Some("x86_64-unknown-linux-gnu")).expect("CLIF");
        let types = ["f32x4", "f64x2", "i32x4", "i64x2"];
        let vectors: Vec<&str> = text.lines().filter(|line| types.iter().any(|ty| line.contains(ty))).collect();
        // The type stands where a register is loaded; operations say what they do.
        let loads = vectors.iter().filter(|line| line.contains("load.")).count();
        let right = match expected {
            Some(op) => loads > 0 && text.contains(op),
            None => loads == 0,
        };
        if !right {
            wrong.push(format!("{loads} loads: {body}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
