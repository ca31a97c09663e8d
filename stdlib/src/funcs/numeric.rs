//! Numeric and arithmetic functions (Ed. 3 tables 28 and 29).

use super::convert::Rounding;
use super::{IN, IN1_IN2, Param, Ret, Sem, StdFn, Ty, call_real, param, row};
use crate::elem::{Elem, Generic};
use crate::ops::Op;
use crate::rt::math;

const T28: &str = "IEC 61131-3 Ed. 3, 6.6.2.5.3, table 28";
const T29: &str = "IEC 61131-3 Ed. 3, 6.6.2.5.4, table 29";
const EXTENSION: &str = "not in the standard: common among vendors";

const fn numeric(name: &'static str, over: Generic, sem: Sem) -> StdFn {
    row(name, T28, IN, Ret::Var, sem).over(over)
}

const fn rounding(name: &'static str, clause: &'static str, how: Rounding, alone: Option<Elem>) -> StdFn {
    row(name, clause, IN, Ret::Place { alone }, Sem::Round(how, alone)).over(Generic::Real)
}

/// A row over libm.
macro_rules! libm {
    ($name:literal, $single:ident, $double:ident) => {
        numeric(
            $name,
            Generic::Real,
            Sem::Formula(|e, elem, args| call_real(e, elem, args, &math::$single, &math::$double)),
        )
    };
}

pub(super) static ROWS: &[StdFn] = &[
    numeric("ABS", Generic::Num, Sem::Op(Op::Abs)),
    numeric("SQRT", Generic::Real, Sem::Op(Op::Sqrt)),
    libm!("LN", LN_F32, LN_F64),
    libm!("LOG", LOG_F32, LOG_F64),
    libm!("EXP", EXP_F32, EXP_F64),
    libm!("SIN", SIN_F32, SIN_F64),
    libm!("COS", COS_F32, COS_F64),
    libm!("TAN", TAN_F32, TAN_F64),
    libm!("ASIN", ASIN_F32, ASIN_F64),
    libm!("ACOS", ACOS_F32, ACOS_F64),
    libm!("ATAN", ATAN_F32, ATAN_F64),
    row(
        "ATAN2",
        T28,
        &[param("Y", Ty::Var), param("X", Ty::Var)],
        Ret::Var,
        Sem::Formula(|e, elem, args| call_real(e, elem, args, &math::ATAN2_F32, &math::ATAN2_F64)),
    )
    .over(Generic::Real),
    rounding("TRUNC", "IEC 61131-3 Ed. 3, 6.6.2.5.2, table 22", Rounding::TowardZero, Some(Elem::Dint)),
    rounding("ROUND", EXTENSION, Rounding::Nearest, None),
    rounding("CEIL", EXTENSION, Rounding::Up, None),
    rounding("FLOOR", EXTENSION, Rounding::Down, None),
    row("ADD", T29, IN1_IN2, Ret::Var, Sem::Op(Op::Add)).over(Generic::Magnitude).extensible(),
    row("MUL", T29, IN1_IN2, Ret::Var, Sem::Op(Op::Mul)).over(Generic::Num).extensible(),
    row("SUB", T29, IN1_IN2, Ret::Var, Sem::Op(Op::Sub)).over(Generic::Magnitude),
    row("DIV", T29, IN1_IN2, Ret::Var, Sem::Op(Op::Div)).over(Generic::Num),
    row("MOD", T29, IN1_IN2, Ret::Var, Sem::Op(Op::Mod)).over(Generic::Int),
    row("EXPT", T29, BASE_EXPONENT, Ret::Var, Sem::Op(Op::Power)).over(Generic::Real),
    row("MOVE", T29, IN, Ret::Var, Sem::Formula(|_, _, args| args[0])).over(Generic::Any),
];

/// An integer base becomes REAL or LREAL (semantics.md \[T5\]), by the conversion into the type variable.
const BASE_EXPONENT: &[Param] = &[param("IN1", Ty::Var), param("IN2", Ty::Num)];
