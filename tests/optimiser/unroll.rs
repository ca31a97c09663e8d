//! Short loops become straight code, longer ones with small bodies do several passes in one.

use super::{count, optimised};
use plcc_mir::ir::{Inst, Program};

/// Ways back: blocks stand in reverse post-order behind the last pass.
fn loops(program: &Program) -> usize {
    let mut found = 0;
    for func in &program.funcs {
        for (id, block) in func.blocks.iter_enumerated() {
            block.term.for_each_target(|target| found += usize::from(target.block <= id));
        }
    }
    found
}

const DECLARATIONS: &str = "a : ARRAY [0..99] OF DINT; m, p, q : ARRAY [0..3, 0..3] OF REAL; i, j, k : INT; u : USINT;
    d : DINT; f : REAL; t : BOOL;";

/// Body, loops that are left.
const BODIES: &[(&str, usize)] = &[
    ("FOR i := 0 TO 9 DO a[i] := a[i] + i; END_FOR;", 0),
    ("FOR i := 9 TO 0 BY -3 DO a[i] := a[i] + i; END_FOR;", 0),
    ("FOR u := 250 TO 255 DO d := d + u; END_FOR;", 0),
    ("i := 0; WHILE i < 5 DO d := d * 3 + i; i := i + 1; END_WHILE;", 0),
    ("i := 0; REPEAT d := d * 3 + i; i := i + 2; UNTIL i > 9 END_REPEAT;", 0),
    ("FOR i := 1 TO 4 DO IF d > i THEN d := d - a[i]; ELSE d := d + i; END_IF; END_FOR;", 0),
    ("FOR i := 1 TO 6 DO IF d > 100 THEN CONTINUE; END_IF; d := d + i; END_FOR;", 0),
    ("FOR i := 0 TO 2 DO FOR j := 0 TO 2 DO d := d * 5 + i * j; END_FOR; END_FOR;", 0),
    // Of these one way back is left.
    ("FOR i := 0 TO 99 DO a[i] := a[i] + i; END_FOR;", 1),
    ("FOR i := 0 TO 96 DO a[i] := a[i] * 3 + i; END_FOR;", 1),
    ("FOR i := 0 TO 98 DO IF a[i] > a[i + 1] THEN a[i] := a[i] * 3 + i; END_IF; END_FOR;", 1),
    ("d := 1; FOR i := 0 TO 50 DO d := d * 3 + 7; END_FOR; a[3] := d;", 1),
    ("FOR i := 0 TO 20 DO d := d + i; IF d > 100 THEN EXIT; END_IF; END_FOR;", 1),
    (
        "FOR i := 0 TO 3 DO FOR j := 0 TO 3 DO f := 0.0; FOR k := 0 TO 3 DO f := f + p[i, k] * q[k, j]; END_FOR; m[i, j] := f; END_FOR; END_FOR;",
        1,
    ),
    ("d := d + 1; FOR i := 0 TO DINT_TO_INT(d) DO a[i] := d; END_FOR;", 1),
    ("FOR i := 0 TO 49 DO FOR j := 0 TO 1 DO a[2 * i + j] := a[2 * i + j] + 1; END_FOR; END_FOR;", 1),
];

#[test]
fn known_loops_go() {
    let mut wrong = String::new();
    for (body, left) in BODIES {
        let program = optimised(DECLARATIONS, body);
        let got = loops(&program);
        if got != *left {
            wrong += &format!("{got} loops, expected {left}: {body}\n{}\n", plcc_mir::print::program(&program, None));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// Four passes in one: four loads, and the odd pass in front.
#[test]
fn several_passes_in_one() {
    let stores = |body| {
        count(
            &optimised(DECLARATIONS, body),
            |inst| matches!(inst, Inst::Store { place, .. } if !place.index.is_empty()),
        )
    };
    assert_eq!(stores("FOR i := 0 TO 99 DO a[i] := a[i] + i; END_FOR;"), 4);
    let loads = |body| {
        count(
            &optimised(DECLARATIONS, body),
            |inst| matches!(inst, Inst::Load { place, .. } if !place.index.is_empty()),
        )
    };
    assert_eq!(loads("FOR i := 0 TO 96 DO a[i] := a[i] * 3 + i; END_FOR;"), 4);
}
