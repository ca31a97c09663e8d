//! Division and remainder by a constant: multiplication by its reciprocal, or shifts if it is a power of two.
//!
//! The reciprocal is rounded up: `m = ceil(2^k / d)` with `m * d - 2^k` so small that the quotient of every dividend of
//! the width is the product's upper part (Granlund and Montgomery 1994). Up to 32 bits the product fits 64; the unsigned
//! one of 32 bits does not always, and then, as for 64 bits, the upper half of a product of 128 bits is taken.
//!
//! ```text
//! v2 = i32 10                v3 = sext_i64 i32 v0
//! v1 = div_s i32 v0, v2      v4 = i64 1717986919
//!                            v5 = mul i64 v3, v4
//!                      =>    v6 = i64 34
//!                            v7 = shr_s i64 v5, v6
//!                            v8 = i64 63
//!                            v9 = shr_u i64 v3, v8
//!                            v10 = add i64 v7, v9
//!                            v1 = wrap_i32 i64 v10
//! ```
//!
//! Comes late: other passes know a division better than what becomes of it.

use super::rewrite::Constants;
use crate::ir::{Args, Func, Inst, ValueId};
use index_vec::IndexVec;
use plcc_stdlib::prim::PrimOp::{self, DivS, DivU, RemS, RemU};
use plcc_stdlib::prim::Repr;

/// The pass.
pub fn run(func: &mut Func) {
    let constants = Constants::new(func);
    for block in func.blocks.indices() {
        let by_constant = |inst: &Inst| match inst {
            Inst::Prim { dst, op: op @ (DivS | DivU | RemS | RemU), repr, args: Args::Two([x, y]) } => {
                Some((*dst, *op, *repr, *x, *y, constants.get(*y)?))
            }
            _ => None,
        };
        if !func.blocks[block].insts.iter().any(|inst| by_constant(inst).is_some()) {
            continue;
        }
        let insts = std::mem::take(&mut func.blocks[block].insts);
        let mut code = Code { values: &mut func.values, out: Vec::with_capacity(insts.len() + 8) };
        for inst in insts {
            match by_constant(&inst) {
                Some((dst, op, repr, x, y, raw)) if worth_it(op, repr, raw) => {
                    code.division(dst, op, repr, x, (y, raw));
                }
                _ => code.out.push(inst),
            }
        }
        func.blocks[block].insts = code.out;
    }
}

/// 0, 1 and -1 are special, and for algebra.
fn worth_it(op: PrimOp, repr: Repr, raw: u64) -> bool {
    raw > 1 && !(matches!(op, DivS | RemS) && raw == repr.mask())
}

/// What is being written.
struct Code<'a> {
    values: &'a mut IndexVec<ValueId, Repr>,
    out: Vec<Inst>,
}

impl Code<'_> {
    fn number(&mut self, repr: Repr, raw: u64) -> ValueId {
        let dst = self.values.push(repr);
        self.out.push(Inst::Const { dst, raw: raw & repr.mask() });
        dst
    }

    fn op(&mut self, op: PrimOp, repr: Repr, operands: &[ValueId]) -> ValueId {
        let dst = self.values.push(op.result(repr));
        self.set(dst, op, repr, operands);
        dst
    }

    fn set(&mut self, dst: ValueId, op: PrimOp, repr: Repr, operands: &[ValueId]) {
        let args = match *operands {
            [a, b] => Args::Two([a, b]),
            [a, ..] => Args::One([a]),
            [] => return,
        };
        self.out.push(Inst::Prim { dst, op, repr, args });
    }

    /// A shift by a constant; none by 0.
    fn shift(&mut self, op: PrimOp, repr: Repr, x: ValueId, by: u32) -> ValueId {
        if by == 0 {
            return x;
        }
        let by = self.number(Repr::I64, by.into());
        self.op(op, repr, &[x, by])
    }

    fn wide(&mut self, signed: bool, repr: Repr, x: ValueId) -> ValueId {
        let extend = if signed { PrimOp::Sext(Repr::I64) } else { PrimOp::Zext(Repr::I64) };
        if repr == Repr::I64 { x } else { self.op(extend, repr, &[x]) }
    }

    /// `dst` becomes `x / y` or `x MOD y` for a constant `y`, which is also given as a register value.
    fn division(&mut self, dst: ValueId, op: PrimOp, repr: Repr, x: ValueId, (y, raw): (ValueId, u64)) {
        match op {
            DivU | RemU if raw.is_power_of_two() => {
                if op == DivU {
                    let by = self.number(Repr::I64, raw.trailing_zeros().into());
                    self.set(dst, PrimOp::ShrU, repr, &[x, by]);
                } else {
                    let mask = self.number(repr, raw - 1);
                    self.set(dst, PrimOp::And, repr, &[x, mask]);
                }
            }
            DivU | RemU => {
                let quotient = self.unsigned(repr, x, raw);
                self.finish(dst, op == DivU, repr, quotient, x, y);
            }
            _ => {
                let divisor = repr.sign_extend(raw);
                let size = divisor.unsigned_abs();
                if size.is_power_of_two() {
                    return self.signed_shift(dst, op == DivS, repr, x, divisor);
                }
                let mut quotient = self.signed(repr, x, size);
                if divisor < 0 {
                    quotient = self.op(PrimOp::Neg, Repr::I64, &[quotient]);
                }
                self.finish(dst, op == DivS, repr, quotient, x, y);
            }
        }
    }

    /// The quotient is there, as I64: it, or the remainder.
    fn finish(&mut self, dst: ValueId, is_quotient: bool, repr: Repr, quotient: ValueId, x: ValueId, y: ValueId) {
        let wrap = PrimOp::Wrap(repr);
        match (is_quotient, repr) {
            (true, Repr::I64) => {
                // Algebra makes one value of the two.
                let zero = self.number(Repr::I64, 0);
                self.set(dst, PrimOp::Add, repr, &[quotient, zero]);
            }
            (true, _) => self.set(dst, wrap, Repr::I64, &[quotient]),
            (false, _) => {
                let quotient = if repr == Repr::I64 { quotient } else { self.op(wrap, Repr::I64, &[quotient]) };
                let whole = self.op(PrimOp::Mul, repr, &[quotient, y]);
                self.set(dst, PrimOp::Sub, repr, &[x, whole]);
            }
        }
    }

    /// The quotient by a number that is no power of two, as I64.
    fn unsigned(&mut self, repr: Repr, x: ValueId, divisor: u64) -> ValueId {
        let wide = self.wide(false, repr, x);
        if repr != Repr::I64 {
            let (m, k) = reciprocal(divisor, repr.bits(), repr.bits());
            if m >> 32 == 0 || repr != Repr::I32 {
                let m = self.number(Repr::I64, m as u64);
                let product = self.op(PrimOp::Mul, Repr::I64, &[wide, m]);
                return self.shift(PrimOp::ShrU, Repr::I64, product, k);
            }
            // 2^64 is so large that the rounding never shows in 32 bits.
            let m = self.number(Repr::I64, u64::MAX / divisor + 1);
            return self.op(PrimOp::MulHiU, Repr::I64, &[wide, m]);
        }
        if divisor >> 63 != 0 {
            let least = self.number(Repr::I64, divisor);
            let once = self.op(PrimOp::LeU, Repr::I64, &[least, x]);
            return self.op(PrimOp::Zext(Repr::I64), Repr::I8, &[once]);
        }
        // Factors 2 go first: they leave room for the rounding.
        for even in [0, divisor.trailing_zeros()] {
            let (m, k) = reciprocal(divisor >> even, 64 - even, 64);
            if m >> 64 == 0 {
                let x = self.shift(PrimOp::ShrU, Repr::I64, x, even);
                let m = self.number(Repr::I64, m as u64);
                let high = self.op(PrimOp::MulHiU, Repr::I64, &[x, m]);
                return self.shift(PrimOp::ShrU, Repr::I64, high, k - 64);
            }
        }
        // Sixty-five bits: the product by the highest one is added, halved so that it does not overflow.
        let (m, k) = reciprocal(divisor, 64, 64);
        let m = self.number(Repr::I64, m as u64);
        let high = self.op(PrimOp::MulHiU, Repr::I64, &[x, m]);
        let rest = self.op(PrimOp::Sub, Repr::I64, &[x, high]);
        let half = self.shift(PrimOp::ShrU, Repr::I64, rest, 1);
        let sum = self.op(PrimOp::Add, Repr::I64, &[half, high]);
        self.shift(PrimOp::ShrU, Repr::I64, sum, k - 65)
    }

    /// The quotient by a positive number that is no power of two, as I64: rounded down, and one more for negative ones.
    fn signed(&mut self, repr: Repr, x: ValueId, divisor: u64) -> ValueId {
        let wide = self.wide(true, repr, x);
        let floor = if repr == Repr::I64 {
            let (m, k) = reciprocal(divisor, 63, 64);
            let number = self.number(Repr::I64, m as u64);
            let mut high = self.op(PrimOp::MulHiS, Repr::I64, &[x, number]);
            if m >> 63 != 0 {
                // As a signed number it is too small by 2^64.
                high = self.op(PrimOp::Add, Repr::I64, &[high, x]);
            }
            self.shift(PrimOp::ShrS, Repr::I64, high, k - 64)
        } else {
            let (m, k) = reciprocal(divisor, repr.bits() - 1, repr.bits() - 1);
            let m = self.number(Repr::I64, m as u64);
            let product = self.op(PrimOp::Mul, Repr::I64, &[wide, m]);
            self.shift(PrimOp::ShrS, Repr::I64, product, k)
        };
        let negative = self.shift(PrimOp::ShrU, Repr::I64, wide, 63);
        self.op(PrimOp::Add, Repr::I64, &[floor, negative])
    }

    /// By a power of two: negative numbers are moved up before they are shifted, so that they are rounded toward 0.
    fn signed_shift(&mut self, dst: ValueId, is_quotient: bool, repr: Repr, x: ValueId, divisor: i64) {
        let bits = divisor.unsigned_abs().trailing_zeros();
        let sign = self.shift(PrimOp::ShrS, repr, x, repr.bits() - 1);
        let bias = self.shift(PrimOp::ShrU, repr, sign, repr.bits() - bits);
        let moved = self.op(PrimOp::Add, repr, &[x, bias]);
        if !is_quotient {
            let mask = self.number(repr, divisor.unsigned_abs() - 1);
            let low = self.op(PrimOp::And, repr, &[moved, mask]);
            self.set(dst, PrimOp::Sub, repr, &[low, bias]);
        } else if divisor < 0 {
            let quotient = self.shift(PrimOp::ShrS, repr, moved, bits);
            self.set(dst, PrimOp::Neg, repr, &[quotient]);
        } else {
            let by = self.number(Repr::I64, bits.into());
            self.set(dst, PrimOp::ShrS, repr, &[moved, by]);
        }
    }
}

/// `m = ceil(2^k / divisor)` and the least `k >= least` for which `floor(x * m / 2^k)` is the quotient of every `x` up to
/// `2^bits`: the rounding of `m`, `x` times, must stay below one.
fn reciprocal(divisor: u64, bits: u32, least: u32) -> (u128, u32) {
    let divisor = u128::from(divisor);
    let mut k = least;
    loop {
        // At most 2^127.
        let power = 1u128 << k;
        let m = power.div_ceil(divisor);
        let rounding = m * divisor - power;
        if k >= bits && rounding <= 1 << (k - bits) {
            return (m, k);
        }
        k += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::Builder;
    use plcc_stdlib::prim::eval;

    /// `x op divisor` behind the pass.
    fn divided(op: PrimOp, repr: Repr, divisor: u64) -> Func {
        let mut b = Builder::new("f", &[repr], Some(repr), false);
        let x = b.params()[0];
        let y = b.number(repr, divisor);
        let result = b.op(op, repr, &[x, y]);
        b.ret(Some(result));
        let mut func = b.finish(0);
        run(&mut func);
        func
    }

    fn calculate(func: &Func, registers: &mut [u64], x: u64) -> u64 {
        let block = &func.blocks[0];
        registers[block.params[0].index()] = x;
        for inst in &block.insts {
            match inst {
                Inst::Const { dst, raw } => registers[dst.index()] = *raw,
                Inst::Prim { dst, op, repr, args: Args::Two([a, b]) } => {
                    registers[dst.index()] = eval(*op, *repr, &[registers[a.index()], registers[b.index()]]);
                }
                Inst::Prim { dst, op, repr, args } => {
                    registers[dst.index()] = eval(*op, *repr, &[registers[args[0].index()]]);
                }
                other => panic!("{other:?}"),
            }
        }
        match block.term {
            crate::ir::Term::Return(Some(v)) => registers[v.index()],
            _ => 0,
        }
    }

    const OPS: [PrimOp; 4] = [DivS, DivU, RemS, RemU];

    fn check(op: PrimOp, repr: Repr, divisor: u64, dividends: impl IntoIterator<Item = u64>) {
        let func = divided(op, repr, divisor);
        let mut registers = vec![0; func.values.len()];
        for x in dividends {
            let x = x & repr.mask();
            let got = calculate(&func, &mut registers, x);
            let wanted = eval(op, repr, &[x, divisor]);
            assert_eq!(got, wanted, "{op:?} {} {x:#x} {divisor:#x}: {func:?}", repr.name());
        }
    }

    /// Where a wrong reciprocal shows: around the multiples of the divisor next to the ends of the range.
    fn edges(repr: Repr, divisor: u64) -> Vec<u64> {
        let (top, half) = (repr.mask(), repr.mask() >> 1);
        let size = if divisor > half { divisor.wrapping_neg() & top } else { divisor };
        let mut list = vec![0, 1, 2, half - 1, half, half + 1, half + 2, top, top - 1];
        for end in [top, half, half + 1] {
            for by in [divisor, size].into_iter().filter(|by| *by != 0) {
                let multiple = end / by * by;
                list.extend([multiple, multiple.wrapping_sub(1), multiple.wrapping_add(1), multiple.wrapping_sub(by)]);
                list.extend([multiple.wrapping_neg(), multiple.wrapping_neg().wrapping_add(1)]);
            }
        }
        list.extend([divisor, divisor.wrapping_sub(1), divisor.wrapping_add(1), size.wrapping_neg(), size]);
        list
    }

    #[test]
    fn eight_bits_all() {
        for op in OPS {
            for divisor in 0..256 {
                check(op, Repr::I8, divisor, 0..256);
            }
        }
    }

    /// Every fifth divisor (`DIVIDE_ALL=1`: every one) at the dividends where it is hardest; every dividend for some.
    #[test]
    fn sixteen_bits() {
        let all = std::env::var_os("DIVIDE_ALL").is_some();
        for op in OPS {
            for divisor in 0..=0xFFFFu64 {
                let whole = matches!(divisor, 3 | 7 | 10 | 100 | 641 | 1000 | 32767 | 32769 | 0xFFF6);
                if whole {
                    check(op, Repr::I16, divisor, 0..=0xFFFF);
                } else if all || divisor % 5 == 0 || divisor < 300 {
                    check(op, Repr::I16, divisor, edges(Repr::I16, divisor));
                }
            }
        }
    }

    #[test]
    fn thirty_two_and_sixty_four_bits() {
        let mut seed = 11u64;
        let mut random = || {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            seed.wrapping_mul(0x2545_F491_4F6C_DD1D)
        };
        for repr in [Repr::I32, Repr::I64] {
            let mut divisors: Vec<u64> =
                (0..200).chain([641, 1000, 1_000_000, 1_000_000_000, 86_400_000_000_000]).collect();
            divisors.extend((0..repr.bits()).flat_map(|n| [(1 << n) - 1, 1 << n, (1 << n) + 1, 10u64.wrapping_pow(n)]));
            divisors.extend((0..300).map(|_| random() >> (random() % 64)));
            divisors.extend(divisors.clone().iter().map(|d| d.wrapping_neg()));
            for divisor in divisors {
                let divisor = divisor & repr.mask();
                let mut dividends = edges(repr, divisor);
                dividends.extend((0..20).map(|_| random() >> (random() % 64)));
                OPS.iter().for_each(|op| check(*op, repr, divisor, dividends.iter().copied()));
            }
        }
    }

    #[test]
    fn no_division_is_left() {
        for (op, repr, divisor) in
            [(DivS, Repr::I64, 1_000_000), (RemU, Repr::I32, 7), (DivU, Repr::I64, 7), (RemS, Repr::I8, 0xF0)]
        {
            let func = divided(op, repr, divisor);
            let left = |inst: &&Inst| matches!(inst, Inst::Prim { op: DivS | DivU | RemS | RemU, .. });
            assert_eq!(func.blocks[0].insts.iter().filter(left).count(), 0, "{func:?}");
        }
    }
}
