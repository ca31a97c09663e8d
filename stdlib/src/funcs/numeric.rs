//! Arithmetic, bit and comparison functions (Ed. 2 tables 23 to 26 and 28).

use super::*;
use crate::ops::{self, Op};
use crate::prim::Repr;
use crate::rt::{self, RtFn};

/// A library function on REAL or LREAL: each in its own precision (semantics.md \[N1\]).
fn math(elem: Elem, args: &[Val], e: &mut dyn Emit, single: &'static RtFn, double: &'static RtFn) -> Option<Val> {
    Some(e.call(if elem == Elem::Real { single } else { double }, args))
}

/// One operation of the operator table.
macro_rules! op {
    ($op:ident) => {
        Meaning::Formula(|t, args, e| Some(ops::emit(Op::$op, t, args, e)))
    };
}

macro_rules! math {
    ($single:ident, $double:ident) => {
        Meaning::Formula(|t, args, e| math(t, args, e, &rt::math::$single, &rt::math::$double))
    };
}

/// Every neighbouring pair of arguments must hold.
fn chain(op: Op, t: Elem, args: &[Val], e: &mut dyn Emit) -> Option<Val> {
    let mut all = None;
    for pair in args.windows(2) {
        let holds = ops::emit(op, t, pair, e);
        all = Some(match all {
            Some(before) => e.prim(PrimOp::And, Repr::I8, &[before, holds]),
            None => holds,
        });
    }
    all
}

macro_rules! compare {
    ($op:ident) => {
        Meaning::Compare(Operator::$op, |t, args, e| chain(Op::$op, t, args, e))
    };
}

/// Between the infinities, both excluded; a comparison with a NaN is FALSE.
fn is_valid(t: Elem, x: Val, e: &mut dyn Emit) -> Val {
    let r = t.repr();
    let infinity = if r == Repr::F32 { u64::from(f32::INFINITY.to_bits()) } else { f64::INFINITY.to_bits() };
    let infinity = e.constant(r, infinity);
    let magnitude = e.prim(PrimOp::FAbs, r, &[x]);
    e.prim(PrimOp::FLt, r, &[magnitude, infinity])
}

pub(super) fn rows() -> Vec<StdFn> {
    use Generic::*;
    use Type::*;
    let one = [("IN", Var)];
    let two = [("IN1", Var), ("IN2", Var)];
    let shift = [("IN", Var), ("N", Integer)];
    let unary = "Ed. 2 table 23";
    let arithmetic = "Ed. 2 table 24";
    let mut rows = vec![
        row("ABS", unary, Num, &one, op!(Abs), "The absolute value; that of the smallest integer is itself."),
        row("SQRT", unary, Real, &one, op!(Sqrt), "The square root; NaN for negative numbers."),
        row("LN", unary, Real, &one, math!(LN_F32, LN_F64), "The natural logarithm."),
        row("LOG", unary, Real, &one, math!(LOG_F32, LOG_F64), "The logarithm to base 10."),
        row("EXP", unary, Real, &one, math!(EXP_F32, EXP_F64), "e to the power of IN."),
        row("SIN", unary, Real, &one, math!(SIN_F32, SIN_F64), "The sine of an angle in radians."),
        row("COS", unary, Real, &one, math!(COS_F32, COS_F64), "The cosine of an angle in radians."),
        row("TAN", unary, Real, &one, math!(TAN_F32, TAN_F64), "The tangent of an angle in radians."),
        row("ASIN", unary, Real, &one, math!(ASIN_F32, ASIN_F64), "The arc sine, -pi/2 to pi/2."),
        row("ACOS", unary, Real, &one, math!(ACOS_F32, ACOS_F64), "The arc cosine, 0 to pi."),
        row("ATAN", unary, Real, &one, math!(ATAN_F32, ATAN_F64), "The arc tangent, -pi/2 to pi/2."),
        row(
            "ATAN2",
            "Ed. 3 table 28",
            Real,
            &[("Y", Var), ("X", Var)],
            math!(ATAN2_F32, ATAN2_F64),
            "The angle of the point (X, Y), -pi to pi.",
        ),
        row(
            "TRUNC",
            "Ed. 2 table 22",
            Real,
            &one,
            Meaning::Integral(PrimOp::FTrunc),
            "The integral part, toward zero.",
        )
        .gives(IntegerOfPlace),
        row(
            "ROUND",
            "common extension",
            Real,
            &one,
            Meaning::Integral(PrimOp::FNearest),
            "The nearest integer, ties to even.",
        )
        .gives(IntegerOfPlace),
        row(
            "CEIL",
            "common extension",
            Real,
            &one,
            Meaning::Integral(PrimOp::FCeil),
            "The smallest integer not below IN.",
        )
        .gives(IntegerOfPlace),
        row(
            "FLOOR",
            "common extension",
            Real,
            &one,
            Meaning::Integral(PrimOp::FFloor),
            "The greatest integer not above IN.",
        )
        .gives(IntegerOfPlace),
        row("ADD", arithmetic, Magnitude, &[], Meaning::Operator(Operator::Add), "The sum, left to right.")
            .extensible(1, 2),
        row("MUL", arithmetic, Magnitude, &[], Meaning::Operator(Operator::Mul), "The product, left to right.")
            .extensible(1, 2),
        row("SUB", arithmetic, Magnitude, &two, Meaning::Operator(Operator::Sub), "IN1 - IN2."),
        row("DIV", arithmetic, Magnitude, &two, Meaning::Operator(Operator::Div), "IN1 / IN2; integers toward zero."),
        row(
            "MOD",
            arithmetic,
            Int,
            &two,
            Meaning::Operator(Operator::Mod),
            "The remainder of IN1 / IN2, with the sign of IN1.",
        ),
        row("EXPT", arithmetic, Num, &two, Meaning::Operator(Operator::Power), "IN1 to the power of IN2."),
        row("MOVE", arithmetic, Any, &one, Meaning::Move, "IN itself."),
        row("SHL", "Ed. 2 table 25", Bit, &shift, Meaning::Shift(Op::Shl), "IN shifted left by N bits, filled with 0."),
        row(
            "SHR",
            "Ed. 2 table 25",
            Bit,
            &shift,
            Meaning::Shift(Op::Shr),
            "IN shifted right by N bits, filled with 0.",
        ),
        row("ROL", "Ed. 2 table 25", Bit, &shift, Meaning::Shift(Op::Rol), "IN rotated left by N bits."),
        row("ROR", "Ed. 2 table 25", Bit, &shift, Meaning::Shift(Op::Ror), "IN rotated right by N bits."),
        row("AND", "Ed. 2 table 26", Bit, &[], Meaning::Operator(Operator::And), "Bitwise AND.").extensible(1, 2),
        row("OR", "Ed. 2 table 26", Bit, &[], Meaning::Operator(Operator::Or), "Bitwise OR.").extensible(1, 2),
        row("XOR", "Ed. 2 table 26", Bit, &[], Meaning::Operator(Operator::Xor), "Bitwise exclusive OR.")
            .extensible(1, 2),
        row("NOT", "Ed. 2 table 26", Bit, &one, Meaning::Operator(Operator::Not), "Bitwise complement."),
    ];
    for (name, meaning, doc) in [
        ("GT", compare!(Gt), "TRUE if the arguments fall."),
        ("GE", compare!(Ge), "TRUE if the arguments do not rise."),
        ("EQ", compare!(Eq), "TRUE if all arguments are equal."),
        ("LE", compare!(Le), "TRUE if the arguments do not fall."),
        ("LT", compare!(Lt), "TRUE if the arguments rise."),
    ] {
        let row = row(name, "Ed. 2 table 28", Elementary, &[], meaning, doc);
        rows.push(row.extensible(1, 2).gives(Fixed(Elem::Bool)));
    }
    for (name, formula) in [
        ("$TRUNC", Meaning::Formula(|t, a, e| Some(e.prim(PrimOp::FTrunc, t.repr(), a)))),
        ("$NEAREST", Meaning::Formula(|t, a, e| Some(e.prim(PrimOp::FNearest, t.repr(), a)))),
        ("$CEIL", Meaning::Formula(|t, a, e| Some(e.prim(PrimOp::FCeil, t.repr(), a)))),
        ("$FLOOR", Meaning::Formula(|t, a, e| Some(e.prim(PrimOp::FFloor, t.repr(), a)))),
    ] {
        rows.push(row(name, "", Real, &one, formula, "Rounds to an integral real."));
    }
    rows.push(
        row(
            "IS_VALID",
            "Ed. 3 table 39",
            Real,
            &one,
            Meaning::Formula(|t, a, e| Some(is_valid(t, a[0], e))),
            "TRUE if IN is a number: neither NaN nor infinite.",
        )
        .gives(Fixed(Elem::Bool)),
    );
    let ne = row("NE", "Ed. 2 table 28", Elementary, &two, compare!(Ne), "TRUE if the arguments differ.");
    rows.push(ne.gives(Fixed(Elem::Bool)));
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fold::Folder;

    #[test]
    fn valid_numbers() {
        let valid = |t: Elem, raw: u64| {
            let mut e = Folder::new();
            let x = e.value(raw);
            let v = find("IS_VALID").unwrap().emit(t, &[x], &mut e).unwrap();
            e.raw(v) == 1
        };
        for (x, want) in [(0.0, true), (f64::MAX, true), (-1.5, true), (f64::NAN, false), (f64::NEG_INFINITY, false)] {
            assert_eq!(valid(Elem::Lreal, x.to_bits()), want, "{x}");
        }
        assert!(valid(Elem::Real, u64::from(f32::MIN.to_bits())));
        assert!(!valid(Elem::Real, u64::from(f32::INFINITY.to_bits())));
    }
}
