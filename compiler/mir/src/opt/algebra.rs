//! What an operation is when something is known of its operands: the rules of [`fold`](super::fold), without its tables.
//!
//! Reals follow IEEE 754: nothing here changes a result but for sign and payload of a NaN, which are not defined.

use super::fold::{Def, Defs};
use crate::ir::{Args, ValueId};
use plcc_stdlib::prim::{PrimOp, Repr, eval};

/// What takes the place of an operation.
pub enum Simpler {
    /// A register value.
    Const(u64),
    /// One of the values it was made of.
    Value(ValueId),
    /// Another operation.
    Prim(PrimOp, Repr, Args),
    /// A binary operation with a constant as second operand.
    WithConst(PrimOp, Repr, ValueId, (Repr, u64)),
    /// A binary operation with a truth value, 0 or 1 of the same representation, as second operand.
    WithTruth(PrimOp, Repr, ValueId, ValueId),
    /// A comparison of some bits of a value with 0.
    Masked(PrimOp, Repr, ValueId, u64),
}

/// Whether a value is 0 or 1.
pub fn is_truth(defs: &Defs, value: ValueId) -> bool {
    use PrimOp::*;
    let mut work = vec![value];
    let mut steps = 0;
    while let Some(value) = work.pop() {
        steps += 1;
        match defs[value] {
            Def::Truth | Def::Const(0 | 1) => {}
            Def::Prim(Eq | Ne | LtS | LeS | LtU | LeU | FEq | FNe | FLt | FLe, ..) => {}
            Def::Prim(op, Repr::I8, args) if op.is_bitwise() && steps < 8 => work.extend(args.iter()),
            Def::Prim(Select, Repr::I8, Args::Three([_, a, b])) if steps < 8 => work.extend([a, b]),
            _ => return false,
        }
    }
    true
}

/// What the operation is, if that is simpler.
pub fn simplify(op: PrimOp, repr: Repr, args: Args, defs: &Defs) -> Option<Simpler> {
    let constant = |v: ValueId| match defs[v] {
        Def::Const(raw) => Some(raw),
        _ => None,
    };
    let raws: Vec<u64> = args.iter().filter_map(|v| constant(*v)).collect();
    if raws.len() == args.len() {
        return Some(Simpler::Const(eval(op, repr, &raws)));
    }
    match args {
        Args::One([x]) => unary(op, repr, x, defs),
        Args::Two([x, y]) => match (constant(x), constant(y)) {
            (Some(_), None) if commutes(op) => Some(Simpler::Prim(op, repr, Args::Two([y, x]))),
            (_, Some(c)) => with_constant(op, repr, x, c, defs),
            (None, None) if x == y => of_same(op, x),
            (None, None) if commutes(op) && y < x => Some(Simpler::Prim(op, repr, Args::Two([y, x]))),
            _ => None,
        },
        Args::Three([c, a, b]) => select(repr, c, a, b, defs),
    }
}

fn commutes(op: PrimOp) -> bool {
    use PrimOp::*;
    // Minimum and maximum of integers; sums and products of reals commute too, to the last bit.
    matches!(
        op,
        Add | Mul | MulHiS | MulHiU | And | Or | Xor | MinS | MinU | MaxS | MaxU | Eq | Ne | FAdd | FMul | FEq | FNe
    )
}

fn unary(op: PrimOp, repr: Repr, x: ValueId, defs: &Defs) -> Option<Simpler> {
    use PrimOp::*;
    let Def::Prim(inner, from, args) = defs[x] else { return None };
    let y = args[0];
    match (op, inner) {
        (Neg, Neg) | (Not, Not) | (FNeg, FNeg) => Some(Simpler::Value(y)),
        (FAbs, FNeg | FAbs) => Some(Simpler::Prim(FAbs, repr, Args::One([y]))),
        (FBits, BitsF) | (BitsF, FBits) => Some(Simpler::Value(y)),
        // Exact both ways.
        (FDemote, FPromote) => Some(Simpler::Value(y)),
        (Zext(to), Zext(_)) => Some(Simpler::Prim(Zext(to), from, Args::One([y]))),
        (Sext(to), Sext(_)) => Some(Simpler::Prim(Sext(to), from, Args::One([y]))),
        // A zero-extended number is not negative.
        (Sext(to), Zext(_)) => Some(Simpler::Prim(Zext(to), from, Args::One([y]))),
        (Wrap(to), Zext(_) | Sext(_)) => Some(if to == from {
            Simpler::Value(y)
        } else if to.bytes() < from.bytes() {
            Simpler::Prim(Wrap(to), from, Args::One([y]))
        } else {
            Simpler::Prim(if matches!(inner, Zext(_)) { Zext(to) } else { Sext(to) }, from, Args::One([y]))
        }),
        (Wrap(to), Wrap(_)) => Some(Simpler::Prim(Wrap(to), from, Args::One([y]))),
        // Exact numbers of a smaller type: from the smaller one at once.
        (SToF(to), Sext(_)) if from.bytes() >= 4 => Some(Simpler::Prim(SToF(to), from, Args::One([y]))),
        _ => None,
    }
}

fn of_same(op: PrimOp, x: ValueId) -> Option<Simpler> {
    use PrimOp::*;
    match op {
        Sub | Xor | Ne | LtS | LtU => Some(Simpler::Const(0)),
        Eq | LeS | LeU => Some(Simpler::Const(1)),
        And | Or | MinS | MinU | MaxS | MaxU => Some(Simpler::Value(x)),
        _ => None,
    }
}

/// The second operand is a constant, the first is not.
fn with_constant(op: PrimOp, repr: Repr, x: ValueId, c: u64, defs: &Defs) -> Option<Simpler> {
    use PrimOp::*;
    let all = repr.mask();
    let value = Some(Simpler::Value(x));
    let number = |raw: u64| Some(Simpler::Const(raw));
    match (op, c) {
        (Add | Sub | Or | Xor | Shl | ShrU | ShrS | Rotl | Rotr, 0) => return value,
        (Mul | And, 0) => return number(0),
        (Mul | DivS | DivU, 1) => return value,
        (RemS | RemU, 1) => return number(0),
        (And, c) if c == all => return value,
        (Or, c) if c == all => return number(all),
        (And, 1) | (Ne, 0) if repr == Repr::I8 && is_truth(defs, x) => return value,
        (Eq, 1) if repr == Repr::I8 && is_truth(defs, x) => return value,
        (Eq, 0) | (Ne, 1) if repr == Repr::I8 && is_truth(defs, x) => {
            return Some(Simpler::WithConst(Xor, repr, x, (repr, 1)));
        }
        (Or, 1) if repr == Repr::I8 && is_truth(defs, x) => return number(1),
        (LtU, 0) => return number(0),
        (LeU, c) if c == all => return number(1),
        (Sub, c) => return Some(Simpler::WithConst(Add, repr, x, (repr, c.wrapping_neg() & all))),
        (Mul, c) if c.is_power_of_two() => {
            return Some(Simpler::WithConst(Shl, repr, x, (Repr::I64, u64::from(c.trailing_zeros()))));
        }
        (DivU, c) if c.is_power_of_two() => {
            return Some(Simpler::WithConst(ShrU, repr, x, (Repr::I64, u64::from(c.trailing_zeros()))));
        }
        (RemU, c) if c.is_power_of_two() => return Some(Simpler::WithConst(And, repr, x, (repr, c - 1))),
        (Shl | ShrU, c) if c >= u64::from(repr.bits()) => return number(0),
        (FMul | FDiv, _) if is_one(repr, c) => return value,
        (FDiv, c) => {
            if let Some(inverse) = exact_inverse(repr, c) {
                return Some(Simpler::WithConst(FMul, repr, x, (repr, inverse)));
            }
        }
        _ => {}
    }
    let Def::Prim(inner, inner_repr, args) = defs[x] else { return None };
    let second = args.get(1).and_then(|v| match defs[*v] {
        Def::Const(raw) => Some(raw),
        _ => None,
    });
    match (op, inner, second) {
        (Add, Add, Some(d)) => Some(Simpler::WithConst(Add, repr, args[0], (repr, c.wrapping_add(d) & all))),
        (And, And, Some(d)) => Some(Simpler::WithConst(And, repr, args[0], (repr, c & d))),
        (Or, Or, Some(d)) => Some(Simpler::WithConst(Or, repr, args[0], (repr, c | d))),
        (Xor, Xor, Some(d)) => Some(Simpler::WithConst(Xor, repr, args[0], (repr, c ^ d))),
        (Eq | Ne, Add, Some(d)) => Some(Simpler::WithConst(op, repr, args[0], (repr, c.wrapping_sub(d) & all))),
        // Whatever the sign: it divides if the low bits are 0.
        (Eq | Ne, RemS, Some(d)) if c == 0 && power_of_two(inner_repr, d) => {
            let size = inner_repr.sign_extend(d).unsigned_abs();
            Some(Simpler::Masked(op, repr, args[0], size - 1))
        }
        (Xor, _, _) if c == 1 && repr == Repr::I8 => negated(inner, inner_repr, args),
        // Comparing an extended number with a constant of its own width.
        (Eq | Ne | LtU | LeU, Zext(_), _) if c <= inner_repr.mask() => {
            Some(Simpler::WithConst(op, inner_repr, args[0], (inner_repr, c)))
        }
        (Eq | Ne | LtS | LeS, Sext(_), _) => {
            let narrow = c & inner_repr.mask();
            let same = repr.sign_extend(c) == inner_repr.sign_extend(narrow);
            same.then_some(Simpler::WithConst(op, inner_repr, args[0], (inner_repr, narrow)))
        }
        _ => None,
    }
}

/// Whether a divisor, without its sign, is a power of two.
fn power_of_two(repr: Repr, raw: u64) -> bool {
    repr.sign_extend(raw).unsigned_abs().is_power_of_two()
}

/// NOT of a comparison. (Of reals only equality has an opposite: a NaN makes all others FALSE.)
fn negated(op: PrimOp, repr: Repr, args: Args) -> Option<Simpler> {
    use PrimOp::*;
    let Args::Two([a, b]) = args else { return None };
    let (op, args) = match op {
        Eq => (Ne, [a, b]),
        Ne => (Eq, [a, b]),
        LtS => (LeS, [b, a]),
        LeS => (LtS, [b, a]),
        LtU => (LeU, [b, a]),
        LeU => (LtU, [b, a]),
        FEq => (FNe, [a, b]),
        FNe => (FEq, [a, b]),
        _ => return None,
    };
    Some(Simpler::Prim(op, repr, Args::Two(args)))
}

fn select(repr: Repr, c: ValueId, a: ValueId, b: ValueId, defs: &Defs) -> Option<Simpler> {
    if a == b {
        return Some(Simpler::Value(a));
    }
    if let Def::Prim(PrimOp::Xor, Repr::I8, Args::Two([x, one])) = defs[c]
        && defs[one] == Def::Const(1)
        && is_truth(defs, x)
    {
        return Some(Simpler::Prim(PrimOp::Select, repr, Args::Three([x, b, a])));
    }
    if repr == Repr::I8 && is_truth(defs, c) {
        match (defs[a], defs[b]) {
            (Def::Const(1), Def::Const(0)) => return Some(Simpler::Value(c)),
            (Def::Const(0), Def::Const(1)) => {
                return Some(Simpler::WithConst(PrimOp::Xor, repr, c, (repr, 1)));
            }
            (Def::Const(1), _) if is_truth(defs, b) => return Some(Simpler::Prim(PrimOp::Or, repr, Args::Two([c, b]))),
            (_, Def::Const(0)) if is_truth(defs, a) => {
                return Some(Simpler::Prim(PrimOp::And, repr, Args::Two([c, a])));
            }
            _ => {}
        }
    }
    counted(repr, c, a, b, defs)
}

/// One more, or one less, if a truth value holds: its sum with the value. What was compared right before needs no register
/// as a condition, and stays one.
fn counted(repr: Repr, c: ValueId, a: ValueId, b: ValueId, defs: &Defs) -> Option<Simpler> {
    let Def::Prim(PrimOp::Add, _, Args::Two([x, step])) = defs[a] else { return None };
    let compared = matches!(defs[c], Def::Prim(op, ..) if !op.is_bitwise());
    if x != b || compared {
        return None;
    }
    match defs[step] {
        Def::Const(1) => Some(Simpler::WithTruth(PrimOp::Add, repr, b, c)),
        Def::Const(raw) if raw == repr.mask() => Some(Simpler::WithTruth(PrimOp::Sub, repr, b, c)),
        _ => None,
    }
}

fn is_one(repr: Repr, raw: u64) -> bool {
    match repr {
        Repr::F32 => raw == u64::from(1f32.to_bits()),
        _ => raw == 1f64.to_bits(),
    }
}

/// The inverse of a power of two, if both are normal numbers: then the quotient is the product, to the last bit.
fn exact_inverse(repr: Repr, raw: u64) -> Option<u64> {
    match repr {
        Repr::F32 => {
            let x = f32::from_bits(raw as u32);
            let exact = x.is_normal() && raw as u32 & 0x007F_FFFF == 0 && x.recip().is_normal();
            exact.then(|| u64::from(x.recip().to_bits()))
        }
        _ => {
            let x = f64::from_bits(raw);
            let exact = x.is_normal() && raw & 0x000F_FFFF_FFFF_FFFF == 0 && x.recip().is_normal();
            exact.then(|| x.recip().to_bits())
        }
    }
}
