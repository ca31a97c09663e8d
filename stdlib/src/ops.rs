//! The operators of IEC 61131-3 on elementary types: which types they take, and their meaning as formulas over [`Emit`].
//!
//! In: operands that already have the operator's type. Which types may meet, and what they are converted to, is decided by
//! the compiler's typing rules; the mixed forms of time arithmetic are a table here ([`time_forms`]).

use crate::convert::resize;
use crate::elem::{Elem, Family};
use crate::emit::{Emit, Val};
use crate::fault::Fault;
use crate::prim::{PrimOp, Repr};
use crate::rt::{RtFn, math, time};

/// An operator. Operands have the type `elem` that goes with it, unless said otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Op {
    /// `+`. Also date or duration + duration: all are nanoseconds.
    Add,
    /// `-` with two operands. Also the difference of dates, and a date less a duration.
    Sub,
    /// `*` of numbers.
    Mul,
    /// `/` of numbers; a fault for integers and 0.
    Div,
    /// MOD of integers; sign of the dividend, a fault for 0.
    Mod,
    /// `**`, EXPT: base and exponent have the real type `elem`.
    Power,
    /// `-` with one operand.
    Neg,
    /// NOT.
    Not,
    /// AND, `&`.
    And,
    /// OR.
    Or,
    /// XOR.
    Xor,
    /// `=`; the result is BOOL.
    Eq,
    /// `<>`; the result is BOOL.
    Ne,
    /// `<`; the result is BOOL.
    Lt,
    /// `<=`; the result is BOOL.
    Le,
    /// `>`; the result is BOOL.
    Gt,
    /// `>=`; the result is BOOL.
    Ge,
    /// SHL; the count is a LINT, a fault if negative.
    Shl,
    /// SHR, fills with zeros; the count is a LINT, a fault if negative.
    Shr,
    /// ROL; the count is a LINT, a fault if negative.
    Rol,
    /// ROR; the count is a LINT, a fault if negative.
    Ror,
    /// MIN of two.
    Min,
    /// MAX of two.
    Max,
    /// `SEL(G, IN0, IN1)`: G is BOOL, the others have the type `elem`.
    Sel,
    /// ABS; wraps for the smallest integer.
    Abs,
    /// SQRT.
    Sqrt,
    /// TIME or LTIME times a number: operands are the duration, then the number of type `elem`.
    TimeMul,
    /// TIME or LTIME divided by a number: operands are the duration, then the number of type `elem`.
    TimeDiv,
}

/// Every operator.
pub const ALL: [Op; 28] = [
    Op::Add,
    Op::Sub,
    Op::Mul,
    Op::Div,
    Op::Mod,
    Op::Power,
    Op::Neg,
    Op::Not,
    Op::And,
    Op::Or,
    Op::Xor,
    Op::Eq,
    Op::Ne,
    Op::Lt,
    Op::Le,
    Op::Gt,
    Op::Ge,
    Op::Shl,
    Op::Shr,
    Op::Rol,
    Op::Ror,
    Op::Min,
    Op::Max,
    Op::Sel,
    Op::Abs,
    Op::Sqrt,
    Op::TimeMul,
    Op::TimeDiv,
];

impl Op {
    /// As the standard names its function: `ADD`, `GE`.
    pub fn name(self) -> &'static str {
        match self {
            Op::Add => "ADD",
            Op::Sub => "SUB",
            Op::Mul => "MUL",
            Op::Div => "DIV",
            Op::Mod => "MOD",
            Op::Power => "EXPT",
            Op::Neg => "NEG",
            Op::Not => "NOT",
            Op::And => "AND",
            Op::Or => "OR",
            Op::Xor => "XOR",
            Op::Eq => "EQ",
            Op::Ne => "NE",
            Op::Lt => "LT",
            Op::Le => "LE",
            Op::Gt => "GT",
            Op::Ge => "GE",
            Op::Shl => "SHL",
            Op::Shr => "SHR",
            Op::Rol => "ROL",
            Op::Ror => "ROR",
            Op::Min => "MIN",
            Op::Max => "MAX",
            Op::Sel => "SEL",
            Op::Abs => "ABS",
            Op::Sqrt => "SQRT",
            Op::TimeMul => "MULTIME",
            Op::TimeDiv => "DIVTIME",
        }
    }

    /// As it is written in ST: `+`, `>=`, `MOD`; a function's name where there is no sign.
    pub fn symbol(self) -> &'static str {
        match self {
            Op::Add => "+",
            Op::Sub | Op::Neg => "-",
            Op::Mul | Op::TimeMul => "*",
            Op::Div | Op::TimeDiv => "/",
            Op::Power => "**",
            Op::Eq => "=",
            Op::Ne => "<>",
            Op::Lt => "<",
            Op::Le => "<=",
            Op::Gt => ">",
            Op::Ge => ">=",
            _ => self.name(),
        }
    }

    /// How many operands it takes.
    pub fn arity(self) -> usize {
        match self {
            Op::Neg | Op::Not | Op::Abs | Op::Sqrt => 1,
            Op::Sel => 3,
            _ => 2,
        }
    }

    /// `=`, `<>`, `<`, `<=`, `>`, `>=`.
    pub fn is_comparison(self) -> bool {
        matches!(self, Op::Eq | Op::Ne | Op::Lt | Op::Le | Op::Gt | Op::Ge)
    }

    /// The representation of operand `n`.
    pub fn operand(self, elem: Elem, n: usize) -> Repr {
        match (self, n) {
            (Op::Shl | Op::Shr | Op::Rol | Op::Ror, 1) | (Op::TimeMul | Op::TimeDiv, 0) => Repr::I64,
            (Op::Sel, 0) => Repr::I8,
            _ => elem.repr(),
        }
    }

    /// The representation of its result.
    pub fn result(self, elem: Elem) -> Repr {
        match self {
            Op::TimeMul | Op::TimeDiv => Repr::I64,
            _ if self.is_comparison() => Repr::I8,
            _ => elem.repr(),
        }
    }
}

/// Whether [`emit`] has a formula for `op` on `elem`. Wider than what may be written in profile strict: arithmetic on bit
/// strings and logic on integers count as unsigned numbers and bits.
pub fn accepts(op: Op, elem: Elem) -> bool {
    let integer = elem.is_integer() || elem.is_bits();
    match op {
        Op::Add | Op::Sub => integer || elem.is_real() || elem.is_time_like(),
        Op::Mul | Op::Div | Op::TimeMul | Op::TimeDiv => integer || elem.is_real(),
        Op::Mod | Op::Shl | Op::Shr | Op::Rol | Op::Ror => integer,
        Op::Power | Op::Sqrt => elem.is_real(),
        Op::Neg | Op::Abs => integer || elem.is_real() || elem.family() == Family::Duration,
        Op::Not | Op::And | Op::Or | Op::Xor => integer || elem == Elem::Bool,
        Op::Eq | Op::Ne | Op::Lt | Op::Le | Op::Gt | Op::Ge | Op::Min | Op::Max | Op::Sel => true,
    }
}

/// Whether [`emit`] checks an operand of `op` on `elem`: a divisor, the count of a shift.
pub fn may_fault(op: Op, elem: Elem) -> bool {
    match op {
        Op::Div | Op::Mod | Op::TimeDiv => !elem.is_real(),
        Op::Shl | Op::Shr | Op::Rol | Op::Ror => true,
        _ => false,
    }
}

/// The operator applied to `args`; the caller has asked [`accepts`].
pub fn emit(op: Op, elem: Elem, args: &[Val], e: &mut dyn Emit) -> Val {
    let repr = elem.repr();
    let real = elem.is_real();
    let signed = elem.is_signed();
    let pick = |on_real, on_signed, on_unsigned| match (real, signed) {
        (true, _) => on_real,
        (false, true) => on_signed,
        (false, false) => on_unsigned,
    };
    let simple = match op {
        Op::Add => pick(PrimOp::FAdd, PrimOp::Add, PrimOp::Add),
        Op::Sub => pick(PrimOp::FSub, PrimOp::Sub, PrimOp::Sub),
        Op::Mul => pick(PrimOp::FMul, PrimOp::Mul, PrimOp::Mul),
        Op::Neg => pick(PrimOp::FNeg, PrimOp::Neg, PrimOp::Neg),
        Op::And => PrimOp::And,
        Op::Or => PrimOp::Or,
        Op::Xor => PrimOp::Xor,
        Op::Eq => pick(PrimOp::FEq, PrimOp::Eq, PrimOp::Eq),
        Op::Ne => pick(PrimOp::FNe, PrimOp::Ne, PrimOp::Ne),
        Op::Lt | Op::Gt => pick(PrimOp::FLt, PrimOp::LtS, PrimOp::LtU),
        Op::Le | Op::Ge => pick(PrimOp::FLe, PrimOp::LeS, PrimOp::LeU),
        Op::Sqrt => PrimOp::FSqrt,
        Op::Div if real => PrimOp::FDiv,
        Op::Div => return divide(PrimOp::DivS, PrimOp::DivU, elem, args[0], args[1], e),
        Op::Mod => return divide(PrimOp::RemS, PrimOp::RemU, elem, args[0], args[1], e),
        Op::Not if elem == Elem::Bool => {
            let one = e.constant(Repr::I8, 1);
            return e.prim(PrimOp::Xor, Repr::I8, &[args[0], one]);
        }
        Op::Not => PrimOp::Not,
        Op::Power => {
            let row = if repr == Repr::F32 { &math::POW_F32 } else { &math::POW_F64 };
            return e.call(row, args);
        }
        Op::Shl => return shift(PrimOp::Shl, repr, args, e),
        Op::Shr => return shift(PrimOp::ShrU, repr, args, e),
        Op::Rol => return shift(PrimOp::Rotl, repr, args, e),
        Op::Ror => return shift(PrimOp::Rotr, repr, args, e),
        Op::Min | Op::Max if real => {
            // The first operand stays unless the second is beyond it: a NaN in first place stays.
            let (a, b) = (args[0], args[1]);
            let beyond = if op == Op::Min { [b, a] } else { [a, b] };
            let better = e.prim(PrimOp::FLt, repr, &beyond);
            return e.prim(PrimOp::Select, repr, &[better, b, a]);
        }
        Op::Min => pick(PrimOp::MinS, PrimOp::MinS, PrimOp::MinU),
        Op::Max => pick(PrimOp::MaxS, PrimOp::MaxS, PrimOp::MaxU),
        Op::Sel => return e.prim(PrimOp::Select, repr, &[args[0], args[2], args[1]]),
        Op::Abs if real => PrimOp::FAbs,
        Op::Abs if signed => {
            let negative = e.prim(PrimOp::Neg, repr, &[args[0]]);
            return e.prim(PrimOp::MaxS, repr, &[args[0], negative]);
        }
        Op::Abs => return args[0],
        Op::TimeMul if real => return scale_time(&time::MUL_REAL, elem, args, e),
        Op::TimeMul => {
            let factor = resize(elem, Repr::I64, e, args[1]);
            return e.prim(PrimOp::Mul, Repr::I64, &[args[0], factor]);
        }
        Op::TimeDiv if real => return scale_time(&time::DIV_REAL, elem, args, e),
        Op::TimeDiv => return divide_time(elem, args[0], args[1], e),
    };
    match op {
        Op::Gt | Op::Ge => e.prim(simple, repr, &[args[1], args[0]]),
        _ => e.prim(simple, repr, args),
    }
}

/// Integer division or remainder behind the check of the divisor; without checks the total form: 0 for a divisor of 0.
fn divide(on_signed: PrimOp, on_unsigned: PrimOp, elem: Elem, a: Val, b: Val, e: &mut dyn Emit) -> Val {
    let op = if elem.is_signed() { on_signed } else { on_unsigned };
    guarded(elem, a, b, e, |e, b| e.prim(op, elem.repr(), &[a, b]))
}

/// `quotient` of a divisor that is not 0; `dividend` is for the fault's report. Both have the type `elem`.
fn guarded(
    elem: Elem,
    dividend: Val,
    divisor: Val,
    e: &mut dyn Emit,
    quotient: impl FnOnce(&mut dyn Emit, Val) -> Val,
) -> Val {
    let repr = elem.repr();
    let zero = e.constant(repr, 0);
    if e.checks_division() {
        let ok = e.prim(PrimOp::Ne, repr, &[divisor, zero]);
        let shown = resize(elem, Repr::I64, e, dividend);
        e.check(ok, Fault::DivisionByZero, &[shown]);
        return quotient(e, divisor);
    }
    let is_zero = e.prim(PrimOp::Eq, repr, &[divisor, zero]);
    let one = e.constant(repr, 1);
    let safe = e.prim(PrimOp::Select, repr, &[is_zero, one, divisor]);
    let q = quotient(e, safe);
    e.prim(PrimOp::Select, repr, &[is_zero, zero, q])
}

fn shift(op: PrimOp, repr: Repr, args: &[Val], e: &mut dyn Emit) -> Val {
    let zero = e.constant(Repr::I64, 0);
    let ok = e.prim(PrimOp::LeS, Repr::I64, &[zero, args[1]]);
    e.check(ok, Fault::NegativeShift, &[args[1]]);
    e.prim(op, repr, args)
}

/// A duration times or divided by a real, to the nearest nanosecond, ties to even; saturates.
fn scale_time(row: &'static RtFn, elem: Elem, args: &[Val], e: &mut dyn Emit) -> Val {
    let factor = match elem.repr() {
        Repr::F32 => e.prim(PrimOp::FPromote, Repr::F32, &[args[1]]),
        _ => args[1],
    };
    e.call(row, &[args[0], factor])
}

/// A duration divided by an integer, to the nearest nanosecond, ties to even. Computed on magnitudes, where unsigned 64 bits
/// hold every value, also `MIN / -1` and divisors beyond LINT.
fn divide_time(elem: Elem, time: Val, divisor: Val, e: &mut dyn Emit) -> Val {
    let r = Repr::I64;
    let divisor = resize(elem, r, e, divisor);
    guarded(Elem::Lint, time, divisor, e, |e, divisor| {
        let zero = e.constant(r, 0);
        let one = e.constant(r, 1);
        let t_negative = e.prim(PrimOp::LtS, r, &[time, zero]);
        let minus_t = e.prim(PrimOp::Neg, r, &[time]);
        let t = e.prim(PrimOp::Select, r, &[t_negative, minus_t, time]);
        let (d, negative) = if elem.is_signed() {
            let d_negative = e.prim(PrimOp::LtS, r, &[divisor, zero]);
            let minus_d = e.prim(PrimOp::Neg, r, &[divisor]);
            let d = e.prim(PrimOp::Select, r, &[d_negative, minus_d, divisor]);
            (d, e.prim(PrimOp::Xor, Repr::I8, &[t_negative, d_negative]))
        } else {
            (divisor, t_negative)
        };
        let q = e.prim(PrimOp::DivU, r, &[t, d]);
        let whole = e.prim(PrimOp::Mul, r, &[q, d]);
        let rem = e.prim(PrimOp::Sub, r, &[t, whole]);
        // rem against d - rem is twice the remainder against the divisor, without overflow.
        let rest = e.prim(PrimOp::Sub, r, &[d, rem]);
        let above = e.prim(PrimOp::LtU, r, &[rest, rem]);
        let tie = e.prim(PrimOp::Eq, r, &[rest, rem]);
        let odd = e.prim(PrimOp::And, r, &[q, one]);
        let odd = e.prim(PrimOp::Ne, r, &[odd, zero]);
        let tie_up = e.prim(PrimOp::And, Repr::I8, &[tie, odd]);
        let up = e.prim(PrimOp::Or, Repr::I8, &[above, tie_up]);
        let up = e.prim(PrimOp::Zext(r), Repr::I8, &[up]);
        let q = e.prim(PrimOp::Add, r, &[q, up]);
        let minus_q = e.prim(PrimOp::Neg, r, &[q]);
        e.prim(PrimOp::Select, r, &[negative, minus_q, q])
    })
}

/// A form of arithmetic with times (Ed. 3 tables 30 and 31, semantics.md \[T7\]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimeForm {
    /// The operator whose formula it is.
    pub op: Op,
    /// The type for [`emit`]: for `TimeMul` and `TimeDiv` that of the number.
    pub elem: Elem,
    /// What the left operand is converted to before: a long form if the other one is.
    pub left: Elem,
    /// What the right operand is converted to before.
    pub right: Elem,
    /// The type of the result.
    pub result: Elem,
}

/// What `left op right` means when at least one of them is a duration or date: `op` is Add, Sub, Mul or Div.
/// `None`: there is no such form.
pub fn time_forms(op: Op, left: Elem, right: Elem) -> Option<TimeForm> {
    use Family::*;
    let long = is_long(left) || is_long(right);
    let form = |op, elem, left, right, result| Some(TimeForm { op, elem, left, right, result });
    match (op, left.family(), right.family()) {
        (Op::Mul, Duration, _) if right.is_integer() || right.is_real() => form(Op::TimeMul, right, left, right, left),
        (Op::Div, Duration, _) if right.is_integer() || right.is_real() => form(Op::TimeDiv, right, left, right, left),
        (Op::Add | Op::Sub, Duration | TimeOfDay | DateTime, Duration) => {
            let (l, r) = (lengthen(left, long), lengthen(right, long));
            form(op, l, l, r, l)
        }
        (Op::Sub, Date | TimeOfDay | DateTime, f) if f == left.family() => {
            let t = lengthen(left, long);
            form(op, t, t, t, lengthen(Elem::Time, long))
        }
        _ => None,
    }
}

fn is_long(elem: Elem) -> bool {
    matches!(elem, Elem::Ltime | Elem::Ldate | Elem::Ltod | Elem::Ldt)
}

/// The long form of a time or date type, if wanted.
fn lengthen(elem: Elem, long: bool) -> Elem {
    match elem {
        Elem::Time if long => Elem::Ltime,
        Elem::Date if long => Elem::Ldate,
        Elem::Tod if long => Elem::Ltod,
        Elem::Dt if long => Elem::Ldt,
        _ => elem,
    }
}

#[cfg(test)]
mod tests;
