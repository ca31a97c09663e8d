//! Divisions by constants become multiplications and shifts.

use super::{count, optimised};
use plcc_mir::ir::{Inst, Program};
use plcc_stdlib::prim::PrimOp;

fn divisions(program: &Program) -> usize {
    let divides = |op: PrimOp| matches!(op, PrimOp::DivS | PrimOp::DivU | PrimOp::RemS | PrimOp::RemU);
    count(program, |inst| matches!(inst, Inst::Prim { op, .. } if divides(*op)))
}

#[test]
fn by_constants_none_is_left() {
    for (body, left) in [
        ("d := d * 31 + 17; e := e + d / 10 + d MOD 7;", 0),
        ("d := d * 31 + 17; i := i + DINT_TO_INT(d) / 3; s := DINT_TO_SINT(d) MOD SINT#-5;", 0),
        ("u := u * 31 + 17; u := u / 7 + u MOD 10; u := u + u / 16#FFFF_FFF0;", 0),
        ("q := q * 16#5851_F42D_4C95_7F2D + 17; q := q / 7 + q MOD 1000 + q / 16#F000_0000_0000_0000;", 0),
        ("l := l * 16#5851_F42D_4C95_7F2D + 17; l := l / -1000 + l MOD 86400 + l / 64 + l MOD -8;", 0),
        ("t := t + T#1234567ms; d := d + TIME_TO_DINT(t);", 0),
        ("d := d * 31 + 17; IF d <> 0 THEN e := 1000 / d; END_IF;", 1),
    ] {
        let program = optimised("d, e : DINT; i : INT; s : SINT; u : UDINT; q : ULINT; l : LINT; t : TIME;", body);
        let got = divisions(&program);
        assert_eq!(got, left, "{body}\n{}", plcc_mir::print::program(&program, None));
    }
}
