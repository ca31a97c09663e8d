//! Conversions between elementary types (semantics.md \[T6\]): explicit ones (`A_TO_B`) and the implicit ones that the
//! compiler writes out. Each is a formula over [`Emit`].
//!
//! Which conversion may happen without being written is not decided here but in the compiler's typing rules.

use crate::elem::{Elem, Family};
use crate::emit::{Emit, Val};
use crate::prim::{PrimOp, Repr};

const NS_PER_MS: i64 = 1_000_000;
const NS_PER_S: i64 = 1_000_000_000;
/// Nanoseconds of a day: what a DATE is a multiple of.
pub const NS_PER_DAY: i64 = 86_400 * NS_PER_S;

/// `from_TO_to` of a value; `None` where the language has no such conversion. A type converts to itself unchanged.
pub fn convert(from: Elem, to: Elem, e: &mut dyn Emit, v: Val) -> Option<Val> {
    if !exists(from, to) {
        return None;
    }
    if from == to {
        return Some(v);
    }
    Some(match (from.is_time_like(), to.is_time_like()) {
        (true, true) => between_times(from, to, e, v),
        (true, false) => time_to_number(from, to, e, v),
        (false, true) => number_to_time(from, to, e, v),
        (false, false) => numbers(from, to, e, v),
    })
}

/// Whether there is a `from_TO_to`.
pub fn exists(from: Elem, to: Elem) -> bool {
    use Family::*;
    if from == to {
        return true;
    }
    match (from.family(), to.family()) {
        (Char, Char) => true,
        // A character's code; it has no value as a real or a time.
        (Char, f) | (f, Char) => matches!(f, Signed | Unsigned | Bits),
        (Duration, Date | DateTime) | (Date | DateTime, Duration) => false,
        (Date, TimeOfDay) | (TimeOfDay, Date | DateTime) => false,
        _ => true,
    }
}

/// `from_TRUNC_to`: a real to an integer, toward zero, saturating; NaN gives 0. `None` for other types.
pub fn trunc(from: Elem, to: Elem, e: &mut dyn Emit, v: Val) -> Option<Val> {
    (from.is_real() && to.is_integer()).then(|| real_to_integer(from.repr(), to, e, v))
}

/// Neither is a time: BOOL, integers, bit strings, reals, characters.
fn numbers(from: Elem, to: Elem, e: &mut dyn Emit, v: Val) -> Val {
    if to == Elem::Bool {
        return non_zero(from.repr(), e, v);
    }
    match (from.is_real(), to.is_real()) {
        (true, true) if from.repr() == Repr::F32 => e.prim(PrimOp::FPromote, Repr::F32, &[v]),
        (true, true) => e.prim(PrimOp::FDemote, Repr::F64, &[v]),
        (true, false) => {
            let nearest = e.prim(PrimOp::FNearest, from.repr(), &[v]);
            real_to_integer(from.repr(), to, e, nearest)
        }
        (false, true) => integer_to_real(from, to.repr(), e, v),
        (false, false) => resize(from, to.repr(), e, v),
    }
}

/// An integer, bit string, BOOL or character in another width: sign-extended if its own type is signed; low bits kept.
pub(crate) fn resize(from: Elem, to: Repr, e: &mut dyn Emit, v: Val) -> Val {
    let repr = from.repr();
    match (repr.bytes(), to.bytes()) {
        (a, b) if a == b => v,
        (a, b) if a > b => e.prim(PrimOp::Wrap(to), repr, &[v]),
        _ if from.is_signed() => e.prim(PrimOp::Sext(to), repr, &[v]),
        _ => e.prim(PrimOp::Zext(to), repr, &[v]),
    }
}

/// Not 0 (a NaN is not 0).
fn non_zero(repr: Repr, e: &mut dyn Emit, v: Val) -> Val {
    let zero = e.constant(repr, 0);
    let op = if repr.is_int() { PrimOp::Ne } else { PrimOp::FNe };
    e.prim(op, repr, &[v, zero])
}

/// To the real type of representation `to`, nearest even. Exact extensions first, so that one signed conversion does for all
/// but ULINT and LWORD.
pub(crate) fn integer_to_real(from: Elem, to: Repr, e: &mut dyn Emit, v: Val) -> Val {
    if from.repr() == Repr::I64 {
        let op = if from.is_signed() { PrimOp::SToF(to) } else { PrimOp::UToF(to) };
        return e.prim(op, Repr::I64, &[v]);
    }
    let wide = if from.bytes() < 4 || from.is_signed() { Repr::I32 } else { Repr::I64 };
    let v = resize(from, wide, e, v);
    e.prim(PrimOp::SToF(to), wide, &[v])
}

/// Toward zero, saturating at the limits of `to`; NaN gives 0.
fn real_to_integer(from: Repr, to: Elem, e: &mut dyn Emit, v: Val) -> Val {
    let signed = to.is_signed();
    let wide = if to.repr() == Repr::I64 { Repr::I64 } else { Repr::I32 };
    let op = if signed { PrimOp::FToS(wide) } else { PrimOp::FToU(wide) };
    let v = e.prim(op, from, &[v]);
    if to.repr() == wide {
        return v;
    }
    // Types narrower than 32 bits saturate at their own limits, then lose bits that carry nothing.
    let bits = to.repr().bits();
    let v = if signed {
        let max = e.constant(Repr::I32, (1 << (bits - 1)) - 1);
        let min = e.constant(Repr::I32, (-(1i64 << (bits - 1))) as u64);
        let v = e.prim(PrimOp::MinS, Repr::I32, &[v, max]);
        e.prim(PrimOp::MaxS, Repr::I32, &[v, min])
    } else {
        let max = e.constant(Repr::I32, to.repr().mask());
        e.prim(PrimOp::MinU, Repr::I32, &[v, max])
    };
    e.prim(PrimOp::Wrap(to.repr()), Repr::I32, &[v])
}

/// How many nanoseconds the number 1 stands for: TIME and TOD count milliseconds, DATE and DT seconds, long forms nanoseconds.
fn unit_ns(elem: Elem) -> i64 {
    match elem {
        Elem::Time | Elem::Tod => NS_PER_MS,
        Elem::Date | Elem::Dt => NS_PER_S,
        _ => 1,
    }
}

fn time_to_number(from: Elem, to: Elem, e: &mut dyn Emit, v: Val) -> Val {
    let unit = unit_ns(from);
    if to == Elem::Bool {
        return non_zero(Repr::I64, e, v);
    }
    if to.is_real() {
        let mut x = e.prim(PrimOp::SToF(Repr::F64), Repr::I64, &[v]);
        if unit != 1 {
            let unit = e.constant(Repr::F64, (unit as f64).to_bits());
            x = e.prim(PrimOp::FDiv, Repr::F64, &[x, unit]);
        }
        return if to == Elem::Real { e.prim(PrimOp::FDemote, Repr::F64, &[x]) } else { x };
    }
    let mut n = v;
    if unit != 1 {
        let unit = e.constant(Repr::I64, unit as u64);
        n = e.prim(PrimOp::DivS, Repr::I64, &[v, unit]);
    }
    resize(Elem::Lint, to.repr(), e, n)
}

fn number_to_time(from: Elem, to: Elem, e: &mut dyn Emit, v: Val) -> Val {
    let unit = unit_ns(to);
    let ns = if from.is_real() {
        let mut x = v;
        if from == Elem::Real {
            x = e.prim(PrimOp::FPromote, Repr::F32, &[x]);
        }
        if unit != 1 {
            let unit = e.constant(Repr::F64, (unit as f64).to_bits());
            x = e.prim(PrimOp::FMul, Repr::F64, &[x, unit]);
        }
        let x = e.prim(PrimOp::FNearest, Repr::F64, &[x]);
        e.prim(PrimOp::FToS(Repr::I64), Repr::F64, &[x])
    } else {
        let n = resize(from, Repr::I64, e, v);
        if unit == 1 {
            n
        } else {
            let unit = e.constant(Repr::I64, unit as u64);
            e.prim(PrimOp::Mul, Repr::I64, &[n, unit])
        }
    };
    if to.family() == Family::Date { whole_days(e, ns) } else { ns }
}

fn between_times(from: Elem, to: Elem, e: &mut dyn Emit, v: Val) -> Val {
    match (from.family(), to.family()) {
        (Family::DateTime, Family::Date) => whole_days(e, v),
        (Family::DateTime, Family::TimeOfDay) => {
            let days = whole_days(e, v);
            e.prim(PrimOp::Sub, Repr::I64, &[v, days])
        }
        _ => v,
    }
}

/// The midnight at or before an instant, also before 1970: a DATE holds whole days.
fn whole_days(e: &mut dyn Emit, v: Val) -> Val {
    let day = e.constant(Repr::I64, NS_PER_DAY as u64);
    let zero = e.constant(Repr::I64, 0);
    let rem = e.prim(PrimOp::RemS, Repr::I64, &[v, day]);
    let negative = e.prim(PrimOp::LtS, Repr::I64, &[rem, zero]);
    let borrow = e.prim(PrimOp::Select, Repr::I64, &[negative, day, zero]);
    let rem = e.prim(PrimOp::Add, Repr::I64, &[rem, borrow]);
    e.prim(PrimOp::Sub, Repr::I64, &[v, rem])
}

#[cfg(test)]
mod tests;
