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

/// Whether a number is divisible by a power of two, its low bits say, whatever its sign.
#[test]
fn of_even_numbers_the_bits_are_asked() {
    for (body, shifts) in [
        ("i := i + 7; t := i MOD 2 = 0;", 0),
        ("d := d + 7; t := d MOD -8 <> 0;", 0),
        ("d := d + 7; t := d MOD 8 = 3;", 2),
    ] {
        let program = optimised("d : DINT; i : INT; t : BOOL;", body);
        let got = count(&program, |inst| matches!(inst, Inst::Prim { op: PrimOp::ShrS | PrimOp::ShrU, .. }));
        assert_eq!(got, shifts, "{body}\n{}", plcc_mir::print::program(&program, None));
    }
}

/// One more if something holds is a sum.
#[test]
fn truths_are_counted() {
    for (body, selects) in [
        ("i := i * 3; IF t OR u THEN i := i + 1; END_IF;", 0),
        ("d := d * 3; IF t AND NOT u THEN d := d - 1; END_IF;", 0),
        ("d := d * 3; IF t THEN d := d + 2; END_IF;", 1),
    ] {
        let program = optimised("d : DINT; i : INT; t, u : BOOL;", body);
        let got = count(&program, |inst| matches!(inst, Inst::Prim { op: PrimOp::Select, .. }));
        assert_eq!(got, selects, "{body}\n{}", plcc_mir::print::program(&program, None));
    }
}
