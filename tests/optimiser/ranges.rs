//! Checks and polls that ranges prove unneeded, and those that must stay.

use super::{count, optimised, optimised_with};
use plcc_mir::ir::{Inst, Program};
use plcc_stdlib::prim::PrimOp;

fn checks(program: &Program) -> usize {
    count(program, |inst| matches!(inst, Inst::Check { .. }))
}

fn polls(program: &Program) -> usize {
    count(program, |inst| matches!(inst, Inst::Poll { .. }))
}

const DECLARATIONS: &str =
    "a : ARRAY [0..9] OF DINT; m : ARRAY [0..3, 0..3] OF DINT; b : ARRAY [1..8] OF INT; i, j, n : INT;
    k : DINT; u : UINT; w : BYTE; x : INT; y : DINT; q : UDINT; l : LINT; cycle : DINT; t : BOOL;";

/// Body, checks that are left.
const BODIES: &[(&str, usize)] = &[
    ("FOR i := 0 TO 9 DO a[i] := i; END_FOR;", 0),
    ("FOR i := 0 TO 10 DO y := i; END_FOR; FOR i := 0 TO 8 DO a[i] := a[i + 1]; END_FOR;", 0),
    ("FOR i := 0 TO 9 DO IF i < 9 THEN a[i] := a[i + 1]; END_IF; END_FOR;", 0),
    ("FOR i := 9 TO 0 BY -1 DO a[i] := i; END_FOR;", 0),
    ("FOR i := 0 TO 9 BY 3 DO a[i] := i; END_FOR;", 0),
    ("FOR i := 1 TO 9 BY 2 DO a[i - 1] := i; END_FOR;", 0),
    ("FOR u := 0 TO 9 DO a[u] := 3; END_FOR;", 0),
    ("FOR i := 0 TO 3 DO FOR j := 0 TO 3 DO m[i, j] := m[j, i] + 1; END_FOR; END_FOR;", 0),
    ("FOR i := 0 TO 1 DO FOR j := 0 TO 3 DO a[i * 4 + j] := i; END_FOR; END_FOR;", 0),
    // The inner loop begins where the outer one stands.
    (
        "FOR i := 0 TO 8 DO FOR j := i + 1 TO 9 DO IF a[j] < a[i] THEN y := a[i]; a[i] := a[j]; a[j] := y; END_IF; END_FOR; END_FOR;",
        0,
    ),
    ("FOR i := 0 TO 8 DO FOR j := 0 TO 8 - i DO a[j] := a[j + 1]; END_FOR; END_FOR;", 0),
    // The end is known from a condition only.
    ("n := n + 1; IF n >= 0 AND n <= 9 THEN FOR i := 0 TO n DO a[i] := i; END_FOR; END_IF;", 0),
    ("n := n + 1; FOR i := 0 TO LIMIT(0, n, 9) DO a[i] := i; END_FOR;", 0),
    ("n := n + 1; IF n >= 0 AND n <= 9 THEN FOR i := n TO 9 DO a[i] := i; END_FOR; END_IF;", 0),
    // Both ends are known from conditions, the loop lies between.
    ("n := n + 3; x := x + 5; IF n >= 0 AND x <= 9 THEN FOR i := n TO x DO a[i] := i; END_FOR; END_IF;", 0),
    ("k := k + 1; i := 0; WHILE i < 10 DO a[i] := k; i := i + 1; END_WHILE;", 0),
    ("k := k + 1; i := 0; REPEAT a[i] := k; i := i + 1; UNTIL i > 9 END_REPEAT;", 0),
    ("u := u + 3; a[u MOD 10] := 1;", 0),
    ("w := w XOR 16#35; a[w AND 7] := 1;", 0),
    ("w := w XOR 16#35; a[SHR(w, 5)] := 1;", 0),
    ("x := x + 1; a[LIMIT(0, x, 9)] := 1;", 0),
    ("x := x + 1; a[MAX(MIN(x, 9), 0)] := 1;", 0),
    ("x := x + 1; IF x > 9 OR x < 0 THEN x := 0; END_IF; a[x] := 5;", 0),
    ("x := x + 1; IF x > 9 THEN x := 0; END_IF; IF x >= 0 THEN a[x] := 5; END_IF;", 0),
    ("x := x + 1; CASE x OF 1: b[x] := 4; 2..5: b[x + 1] := 9; 7, 8: b[x] := 2; END_CASE;", 0),
    ("x := x + 1; IF x = 3 THEN a[x] := 1; END_IF;", 0),
    ("w := w XOR 16#35; a[BOOL_TO_INT(w.3)] := 1;", 0),
    // A check that passed holds for what follows; the first one stays.
    ("x := (x + 1) MOD 10; a[x] := 5; b[x + 1] := 6; a[x] := 7;", 2),
    ("u := u + 1; q := 7 / (u + 1);", 1),
    ("u := u + 1; q := 7 / (UINT_TO_UDINT(u) + 1); y := 1000 / (UINT_TO_DINT(u) + 1);", 0),
    ("x := x + 1; IF x > 0 THEN y := 1000 / x; END_IF;", 0),
    ("x := x + 1; IF x <> 0 THEN y := 1000 / x; END_IF;", 0),
    // Not provable: these must stay.
    ("FOR i := 0 TO 10 DO IF i <> 5 THEN a[i] := i; END_IF; IF cycle > 100 THEN EXIT; END_IF; END_FOR;", 1),
    ("x := x + 1; a[x MOD 10] := 1;", 1),
    ("n := n + 1; FOR i := 0 TO n DO IF i < 8 OR cycle > 0 THEN a[i] := i; END_IF; END_FOR;", 1),
    ("k := k + 1; a[k] := 1; a[k + 1] := 2;", 2),
];

#[test]
fn checks_go_where_they_are_proved() {
    let mut wrong = String::new();
    for (body, left) in BODIES {
        let program = optimised(DECLARATIONS, body);
        let got = checks(&program);
        if got != *left {
            wrong += &format!("{got} checks, expected {left}: {body}\n{}\n", plcc_mir::print::program(&program, None));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// Body, polls that are left.
const LOOPS: &[(&str, usize)] = &[
    ("n := (n + 1) MOD 8; IF n >= 0 THEN FOR i := 0 TO n DO a[i] := i; END_FOR; END_IF;", 0),
    ("u := u + 1; FOR i := 0 TO UINT_TO_INT(u MOD 5) DO y := y + i; END_FOR;", 0),
    ("i := 0; WHILE i < 10 DO y := y + i; i := i + 1; END_WHILE;", 0),
    ("i := 0; REPEAT y := y + i; i := i + 3; UNTIL i > 20 END_REPEAT;", 0),
    // 100 * 100 passes are too many for one poll; the outer loop keeps it.
    ("FOR i := 1 TO 100 DO FOR j := 1 TO 100 DO y := y + 1; END_FOR; END_FOR;", 1),
    ("FOR k := 1 TO 5000 DO y := y + 1; END_FOR;", 1),
    ("WHILE y < 5 DO y := y + 1; IF cycle > 0 THEN y := 0; END_IF; END_WHILE;", 1),
    ("n := n + 1; FOR i := 0 TO n DO y := y + i; END_FOR;", 1),
    ("i := 0; WHILE i < 10 DO IF y > 3 THEN i := i + 1; END_IF; y := y + 1; END_WHILE;", 1),
    // It ends only when an unsigned number wraps round.
    ("u := 5; WHILE u > 2 DO u := u + 3; END_WHILE;", 1),
];

#[test]
fn polls_go_where_loops_are_short() {
    let mut wrong = String::new();
    for (body, left) in LOOPS {
        let program = optimised(DECLARATIONS, body);
        let got = polls(&program);
        if got != *left {
            wrong += &format!("{got} polls, expected {left}: {body}\n{}\n", plcc_mir::print::program(&program, None));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// A loop that calls keeps its poll: what it calls may be long.
#[test]
fn loops_that_call_keep_their_poll() {
    // Too big and too often called to be put in.
    let body: String = (0..60).map(|n| format!("  IF b[{}] > {n} THEN s := s * 3 + {n}; END_IF;\n", n % 5)).collect();
    let function = format!(
        "FUNCTION long : DINT VAR_INPUT c : DINT; END_VAR VAR b : ARRAY [0..4] OF DINT; s, n : DINT; END_VAR\n\
         FOR n := 1 TO 4000 DO\n{body}END_FOR;\nlong := s;\nEND_FUNCTION\n"
    );
    let program = optimised_with(
        &function,
        "y, n : DINT; i : INT;",
        "n := n + 1; y := y + long(n); y := y - long(y);\n\
         FOR i := 0 TO DINT_TO_INT(n MOD 3) DO y := y + long(y); END_FOR;",
    );
    let calls = count(&program, |inst| matches!(inst, Inst::Call { .. }));
    assert!(calls > 0, "it is to be called\n{}", plcc_mir::print::program(&program, None));
    assert_eq!(polls(&program), 1, "{}", plcc_mir::print::program(&program, None));
}

/// Operations on numbers that are not negative are unsigned ones, comparisons that are decided are gone.
#[test]
fn operations_become_cheaper() {
    let signed = |program: &Program| {
        count(program, |inst| {
            matches!(inst, Inst::Prim { op: PrimOp::DivS | PrimOp::RemS | PrimOp::Sext(_) | PrimOp::ShrS, .. })
        })
    };
    for body in [
        "FOR i := 0 TO 9 DO k := k + i / n; IF k > 50 THEN EXIT; END_IF; END_FOR; IF n <= 0 THEN n := 5; END_IF;",
        "k := UINT_TO_DINT(u) / (UINT_TO_DINT(u) + 3); u := u + 1;",
        "k := UINT_TO_DINT(u) MOD (UINT_TO_DINT(u) + 3); u := u + 1;",
    ] {
        let program = optimised(DECLARATIONS, body);
        let left = signed(&program);
        // The quotient may be negative, and so its extension stays.
        let expected = 2 * usize::from(body.contains("/ n"));
        assert!(left <= expected, "{left} signed operations: {body}\n{}", plcc_mir::print::program(&program, None));
    }
    let program =
        optimised(DECLARATIONS, "u := u + 1; IF UINT_TO_DINT(u) >= 0 THEN k := k + 1; ELSE k := k - 1; END_IF;");
    let compared = count(&program, |inst| matches!(inst, Inst::Prim { op: PrimOp::LeS | PrimOp::LtS, .. }));
    assert_eq!(compared, 0, "{}", plcc_mir::print::program(&program, None));
}
