//! The meaning of each [`PrimOp`] on register values: the one definition that folding, the interpreter and the tests share.
//!
//! Every operation is total: what native code guards by a check gives a fixed value here.

use super::{PrimOp, Repr};

/// Computes `op` on register values; `repr` is that of the operands (for `Select` that of the choices).
///
/// Operands and result are zero-extended in their `u64`. A missing operand counts as 0, so that no caller can make it panic.
#[inline]
pub fn eval(op: PrimOp, repr: Repr, args: &[u64]) -> u64 {
    let a = args.first().copied().unwrap_or(0);
    let b = args.get(1).copied().unwrap_or(0);
    match op {
        PrimOp::Select => {
            if a & 0xFF != 0 {
                b
            } else {
                args.get(2).copied().unwrap_or(0)
            }
        }
        PrimOp::BitsF | PrimOp::FBits => a,
        _ => match repr {
            Repr::F32 => eval_f32(op, f32::from_bits(a as u32), f32::from_bits(b as u32)),
            Repr::F64 => eval_f64(op, f64::from_bits(a), f64::from_bits(b)),
            _ => eval_int(op, repr, a, b),
        },
    }
}

#[inline]
fn eval_int(op: PrimOp, repr: Repr, a: u64, b: u64) -> u64 {
    use PrimOp::*;
    let (sa, sb) = (repr.sign_extend(a), repr.sign_extend(b));
    let bits = repr.bits();
    let mask = repr.mask();
    match op {
        Add => a.wrapping_add(b) & mask,
        Sub => a.wrapping_sub(b) & mask,
        Mul => a.wrapping_mul(b) & mask,
        MulHiS => ((i128::from(sa) * i128::from(sb)) >> bits) as u64 & mask,
        MulHiU => ((u128::from(a) * u128::from(b)) >> bits) as u64,
        DivS if sb == 0 => 0,
        DivS => sa.wrapping_div(sb) as u64 & mask,
        DivU => a.checked_div(b).unwrap_or(0),
        RemS if sb == 0 => 0,
        RemS => sa.wrapping_rem(sb) as u64 & mask,
        RemU => a.checked_rem(b).unwrap_or(0),
        Neg => a.wrapping_neg() & mask,
        And => a & b,
        Or => a | b,
        Xor => a ^ b,
        Not => !a & mask,
        Shl if b >= u64::from(bits) => 0,
        Shl => (a << b) & mask,
        ShrU if b >= u64::from(bits) => 0,
        ShrU => a >> b,
        ShrS => (sa >> b.min(63)) as u64 & mask,
        Rotl => rotate_left(a, (b % u64::from(bits)) as u32, repr),
        Rotr => rotate_left(a, bits - (b % u64::from(bits)) as u32, repr),
        MinS => sa.min(sb) as u64 & mask,
        MinU => a.min(b),
        MaxS => sa.max(sb) as u64 & mask,
        MaxU => a.max(b),
        Eq => u64::from(a == b),
        Ne => u64::from(a != b),
        LtS => u64::from(sa < sb),
        LeS => u64::from(sa <= sb),
        LtU => u64::from(a < b),
        LeU => u64::from(a <= b),
        Zext(_) => a,
        Sext(to) => sa as u64 & to.mask(),
        Wrap(to) => a & to.mask(),
        SToF(Repr::F32) => u64::from((sa as f32).to_bits()),
        SToF(_) => (sa as f64).to_bits(),
        UToF(Repr::F32) => u64::from((a as f32).to_bits()),
        UToF(_) => (a as f64).to_bits(),
        // Not defined on integers (see `PrimOp::accepts`).
        _ => 0,
    }
}

fn rotate_left(a: u64, count: u32, repr: Repr) -> u64 {
    match repr {
        Repr::I8 => u64::from((a as u8).rotate_left(count)),
        Repr::I16 => u64::from((a as u16).rotate_left(count)),
        Repr::I32 => u64::from((a as u32).rotate_left(count)),
        _ => a.rotate_left(count),
    }
}

/// The operations that read the same for both real types.
macro_rules! eval_real {
    ($name:ident, $float:ty, $bits:ty) => {
        #[inline]
        fn $name(op: PrimOp, a: $float, b: $float) -> u64 {
            use PrimOp::*;
            let real = |x: $float| u64::from(x.to_bits());
            const SIGN: $bits = 1 << (<$bits>::BITS - 1);
            match op {
                FAdd => real(a + b),
                FSub => real(a - b),
                FMul => real(a * b),
                FDiv => real(a / b),
                // On the bits: a NaN keeps its payload, as in native code.
                FNeg => u64::from(a.to_bits() ^ SIGN),
                FAbs => u64::from(a.to_bits() & !SIGN),
                FSqrt => real(a.sqrt()),
                FCeil => real(a.ceil()),
                FFloor => real(a.floor()),
                FTrunc => real(a.trunc()),
                FNearest => real(a.round_ties_even()),
                FEq => u64::from(a == b),
                FNe => u64::from(a != b),
                FLt => u64::from(a < b),
                FLe => u64::from(a <= b),
                FPromote => f64::from(a as f32).to_bits(),
                FDemote => u64::from((a as f32).to_bits()),
                // `as` goes toward zero, saturates and takes NaN to 0.
                FToS(Repr::I8) => u64::from(a as i8 as u8),
                FToS(Repr::I16) => u64::from(a as i16 as u16),
                FToS(Repr::I32) => u64::from(a as i32 as u32),
                FToS(_) => a as i64 as u64,
                FToU(Repr::I8) => u64::from(a as u8),
                FToU(Repr::I16) => u64::from(a as u16),
                FToU(Repr::I32) => u64::from(a as u32),
                FToU(_) => a as u64,
                // Not defined on reals (see `PrimOp::accepts`).
                _ => 0,
            }
        }
    };
}

eval_real!(eval_f32, f32, u32);
eval_real!(eval_f64, f64, u64);

#[cfg(test)]
mod tests;
