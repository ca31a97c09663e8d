//! Functions of time and date with scalar results (Ed. 3 tables 34 and 35), and the scan clock.

use super::{IN, Param, Ret, Sem, StdFn, Ty, both, param, row};
use crate::convert::NS_PER_DAY;
use crate::elem::Elem::{self, *};
use crate::elem::Generic;
use crate::emit::{Emit, Val};
use crate::ops::Op;
use crate::prim::{PrimOp, Repr};

const T35: &str = "IEC 61131-3 Ed. 3, 6.6.2.5.11, table 35";
const T36: &str = "IEC 61131-3 Ed. 3, 6.6.2.5.12, table 36";
const CLOCK: &str = "not in the standard: the scan clock, constant through a cycle";

/// All times are nanoseconds in 64 bits, so one formula does for each sum.
const fn sum(name: &'static str, params: &'static [Param], result: Elem) -> StdFn {
    row(name, T35, params, Ret::Fixed(result), Sem::Formula(|e, _, args| e.prim(PrimOp::Add, Repr::I64, args)))
}

const fn difference(name: &'static str, params: &'static [Param], result: Elem) -> StdFn {
    row(name, T35, params, Ret::Fixed(result), Sem::Formula(|e, _, args| e.prim(PrimOp::Sub, Repr::I64, args)))
}

const fn scaled(name: &'static str, params: &'static [Param], result: Elem, op: Op) -> StdFn {
    row(name, T35, params, Ret::Fixed(result), Sem::Op(op)).over(Generic::Num)
}

/// Parameters of two fixed types.
macro_rules! two {
    ($a:ident, $b:ident) => {
        &[param("IN1", Ty::Fixed($a)), param("IN2", Ty::Fixed($b))]
    };
}

const TIME_NUM: &[Param] = &[param("IN1", Ty::Fixed(Time)), param("IN2", Ty::Var)];
const LTIME_NUM: &[Param] = &[param("IN1", Ty::Fixed(Ltime)), param("IN2", Ty::Var)];

pub(super) static ROWS: &[StdFn] = &[
    row("TIME", CLOCK, &[], Ret::Fixed(Time), Sem::Clock),
    row("LTIME", CLOCK, &[], Ret::Fixed(Ltime), Sem::Clock),
    sum("ADD_TIME", two!(Time, Time), Time),
    sum("ADD_LTIME", two!(Ltime, Ltime), Ltime),
    sum("ADD_TOD_TIME", two!(Tod, Time), Tod),
    sum("ADD_LTOD_LTIME", two!(Ltod, Ltime), Ltod),
    sum("ADD_DT_TIME", two!(Dt, Time), Dt),
    sum("ADD_LDT_LTIME", two!(Ldt, Ltime), Ldt),
    difference("SUB_TIME", two!(Time, Time), Time),
    difference("SUB_LTIME", two!(Ltime, Ltime), Ltime),
    difference("SUB_DATE_DATE", two!(Date, Date), Time),
    difference("SUB_LDATE_LDATE", two!(Ldate, Ldate), Ltime),
    difference("SUB_TOD_TIME", two!(Tod, Time), Tod),
    difference("SUB_LTOD_LTIME", two!(Ltod, Ltime), Ltod),
    difference("SUB_TOD_TOD", two!(Tod, Tod), Time),
    difference("SUB_LTOD_LTOD", two!(Ltod, Ltod), Ltime),
    difference("SUB_DT_TIME", two!(Dt, Time), Dt),
    difference("SUB_LDT_LTIME", two!(Ldt, Ltime), Ldt),
    difference("SUB_DT_DT", two!(Dt, Dt), Time),
    difference("SUB_LDT_LDT", two!(Ldt, Ldt), Ltime),
    scaled("MULTIME", TIME_NUM, Time, Op::TimeMul),
    scaled("MUL_TIME", TIME_NUM, Time, Op::TimeMul),
    scaled("MUL_LTIME", LTIME_NUM, Ltime, Op::TimeMul),
    scaled("DIVTIME", TIME_NUM, Time, Op::TimeDiv),
    scaled("DIV_TIME", TIME_NUM, Time, Op::TimeDiv),
    scaled("DIV_LTIME", LTIME_NUM, Ltime, Op::TimeDiv),
    concat("CONCAT_DATE_TOD", &[param("DATE", Ty::Fixed(Date)), param("TOD", Ty::Fixed(Tod))], Dt),
    concat("CONCAT_DATE_LTOD", &[param("DATE", Ty::Fixed(Date)), param("LTOD", Ty::Fixed(Ltod))], Ldt),
    row("DAY_OF_WEEK", T36, &[param("IN", Ty::Fixed(Date))], Ret::Fixed(Int), Sem::Formula(day_of_week)),
    row("IS_VALID", "IEC 61131-3 Ed. 3, 6.6.2.5.14, table 38", IN, Ret::Fixed(Bool), Sem::Formula(is_valid))
        .over(Generic::Real),
];

const fn concat(name: &'static str, params: &'static [Param], result: Elem) -> StdFn {
    let sem = Sem::Formula(|e, _, args| e.prim(PrimOp::Add, Repr::I64, args));
    row(name, T36, params, Ret::Fixed(result), sem)
}

/// 0 is Sunday; 1970-01-01 was a Thursday.
fn day_of_week(e: &mut dyn Emit, _: Elem, args: &[Val]) -> Val {
    let r = Repr::I64;
    let day = e.constant(r, NS_PER_DAY as u64);
    let seven = e.constant(r, 7);
    // Dates lie on midnights: the division is exact, and i64 nanoseconds are less than 2^17 days.
    let days = e.prim(PrimOp::DivS, r, &[args[0], day]);
    let shifted = e.constant(r, 4 + 7 * (1 << 17));
    let days = e.prim(PrimOp::Add, r, &[days, shifted]);
    let weekday = e.prim(PrimOp::RemS, r, &[days, seven]);
    e.prim(PrimOp::Wrap(Repr::I16), r, &[weekday])
}

/// Neither NaN nor infinite.
fn is_valid(e: &mut dyn Emit, elem: Elem, args: &[Val]) -> Val {
    let r = elem.repr();
    let infinity = if r == Repr::F32 { u64::from(f32::INFINITY.to_bits()) } else { f64::INFINITY.to_bits() };
    let above = e.constant(r, infinity);
    let below = e.prim(PrimOp::FNeg, r, &[above]);
    let low = e.prim(PrimOp::FLt, r, &[below, args[0]]);
    let high = e.prim(PrimOp::FLt, r, &[args[0], above]);
    both(e, low, high)
}
