//! Each operation on its edge values, against 128-bit arithmetic or values worked out by hand.

use super::*;
use PrimOp::*;
use Repr::*;

const INTS: [Repr; 4] = [I8, I16, I32, I64];

fn edges(r: Repr) -> Vec<u64> {
    let top = 1u64 << (r.bits() - 1);
    vec![0, 1, 2, 3, 7, top - 1, top, top + 1, r.mask() - 1, r.mask()]
}

/// Runs over all pairs of edge values of all integer representations; `want` is the mathematical result, cut to the width.
fn pairs(op: PrimOp, want: impl Fn(Repr, i128, i128, i128, i128) -> i128) {
    for r in INTS {
        for a in edges(r) {
            for b in edges(r) {
                let (sa, sb) = (i128::from(r.sign_extend(a)), i128::from(r.sign_extend(b)));
                let expected = want(r, sa, sb, i128::from(a), i128::from(b)) as u64 & op.result(r).mask();
                assert_eq!(eval(op, r, &[a, b]), expected, "{op:?} {} {a:#x} {b:#x}", r.name());
            }
        }
    }
}

#[test]
fn arithmetic_wraps_at_its_width() {
    pairs(Add, |_, a, b, _, _| a + b);
    pairs(Sub, |_, a, b, _, _| a - b);
    pairs(Mul, |_, a, b, _, _| a.wrapping_mul(b));
    pairs(DivS, |_, a, b, _, _| if b == 0 { 0 } else { a / b });
    pairs(RemS, |_, a, b, _, _| if b == 0 { 0 } else { a % b });
    pairs(DivU, |_, _, _, a, b| if b == 0 { 0 } else { a / b });
    pairs(RemU, |_, _, _, a, b| if b == 0 { 0 } else { a % b });
    assert_eq!(eval(DivS, I8, &[0x80, 0xFF]), 0x80, "MIN / -1 = MIN");
    assert_eq!(eval(RemS, I64, &[1 << 63, u64::MAX]), 0, "MIN MOD -1 = 0");
    assert_eq!(eval(RemS, I16, &[0xFFF9, 2]), 0xFFFF, "sign of the dividend");
    assert_eq!(eval(Neg, I8, &[0x80]), 0x80);
    assert_eq!(eval(Neg, I32, &[1]), 0xFFFF_FFFF);
}

#[test]
fn upper_halves_of_products() {
    let max = u64::MAX;
    let of = |op: PrimOp, a: u64, b: u64| eval(op, I64, &[a, b]);
    // (2^64 - 1)^2 = 2^128 - 2^65 + 1.
    assert_eq!(of(MulHiU, max, max), max - 1);
    assert_eq!(of(MulHiU, 1 << 32, 1 << 32), 1);
    assert_eq!(of(MulHiU, max, 1), 0);
    assert_eq!(of(MulHiS, max, 1), max, "-1 * 1 = -1");
    assert_eq!(of(MulHiS, max, max), 0, "-1 * -1 = 1");
    assert_eq!(of(MulHiS, 1 << 63, 1 << 63), 1 << 62, "MIN * MIN = 2^126");
    assert_eq!(of(MulHiS, 1 << 63, max >> 1), 0xC000_0000_0000_0000, "MIN * MAX = -2^126 + 2^63");
    for a in edges(I64) {
        for b in edges(I64) {
            // Upper and lower half are the product.
            let (sa, sb) = (i128::from(a as i64), i128::from(b as i64));
            let low = u128::from(eval(Mul, I64, &[a, b]));
            assert_eq!((i128::from(of(MulHiS, a, b) as i64) << 64) + low as i128, sa * sb, "{a:#x} {b:#x}");
            assert_eq!((u128::from(of(MulHiU, a, b)) << 64) + low, u128::from(a) * u128::from(b), "{a:#x} {b:#x}");
        }
    }
}

#[test]
fn bits_and_order() {
    pairs(And, |_, _, _, a, b| a & b);
    pairs(Or, |_, _, _, a, b| a | b);
    pairs(Xor, |_, _, _, a, b| a ^ b);
    pairs(MinS, |_, a, b, _, _| a.min(b));
    pairs(MaxS, |_, a, b, _, _| a.max(b));
    pairs(MinU, |_, _, _, a, b| a.min(b));
    pairs(MaxU, |_, _, _, a, b| a.max(b));
    pairs(Eq, |_, a, b, _, _| i128::from(a == b));
    pairs(Ne, |_, a, b, _, _| i128::from(a != b));
    pairs(LtS, |_, a, b, _, _| i128::from(a < b));
    pairs(LeS, |_, a, b, _, _| i128::from(a <= b));
    pairs(LtU, |_, _, _, a, b| i128::from(a < b));
    pairs(LeU, |_, _, _, a, b| i128::from(a <= b));
    for r in INTS {
        for a in edges(r) {
            assert_eq!(eval(Not, r, &[a]), r.mask() - a);
        }
    }
}

#[test]
fn shifts_take_the_whole_count() {
    for r in INTS {
        let bits = u64::from(r.bits());
        for a in edges(r) {
            for n in [0, 1, bits - 1, bits, bits + 1, 64, 1 << 32, u64::MAX] {
                let (wide, s) = (u128::from(a), r.sign_extend(a));
                let shl = if n >= bits { 0 } else { (wide << n) as u64 & r.mask() };
                let shr = if n >= bits { 0 } else { (wide >> n) as u64 };
                let sar = if n >= bits { if s < 0 { r.mask() } else { 0 } } else { (s >> n) as u64 & r.mask() };
                assert_eq!(eval(Shl, r, &[a, n]), shl, "shl {} {a:#x} {n}", r.name());
                assert_eq!(eval(ShrU, r, &[a, n]), shr, "shr {} {a:#x} {n}", r.name());
                assert_eq!(eval(ShrS, r, &[a, n]), sar, "sar {} {a:#x} {n}", r.name());
                let doubled = wide | wide << bits;
                let rotl = ((doubled << (n % bits)) >> bits) as u64 & r.mask();
                let rotr = (doubled >> (n % bits)) as u64 & r.mask();
                assert_eq!(eval(Rotl, r, &[a, n]), rotl, "rotl {} {a:#x} {n}", r.name());
                assert_eq!(eval(Rotr, r, &[a, n]), rotr, "rotr {} {a:#x} {n}", r.name());
            }
        }
    }
}

#[test]
fn widths_change() {
    assert_eq!(eval(Zext(I64), I8, &[0xFF]), 0xFF);
    assert_eq!(eval(Sext(I16), I8, &[0x80]), 0xFF80);
    assert_eq!(eval(Sext(I64), I32, &[0x8000_0000]), 0xFFFF_FFFF_8000_0000);
    assert_eq!(eval(Wrap(I8), I64, &[0x1234]), 0x34);
    for r in Repr::ALL {
        assert_eq!(eval(Select, r, &[1, 5, 6]), 5);
        assert_eq!(eval(Select, r, &[0, 5, 6]), 6);
    }
}

fn f(x: f64) -> u64 {
    x.to_bits()
}
fn s(x: f32) -> u64 {
    u64::from(x.to_bits())
}

#[test]
fn reals_follow_ieee() {
    assert_eq!(eval(FAdd, F32, &[s(16777216.0), s(1.0)]), s(16777216.0), "single precision, ties to even");
    assert_eq!(eval(FAdd, F64, &[f(16777216.0), f(1.0)]), f(16777217.0));
    assert_eq!(eval(FSub, F64, &[f(0.3), f(0.1)]), f(0.3 - 0.1));
    assert_eq!(eval(FMul, F32, &[s(1e30), s(1e30)]), s(f32::INFINITY));
    assert_eq!(eval(FDiv, F64, &[f(-1.0), f(0.0)]), f(f64::NEG_INFINITY));
    assert!(f64::from_bits(eval(FDiv, F64, &[f(0.0), f(0.0)])).is_nan());
    assert_eq!(eval(FNeg, F32, &[s(0.0)]), s(-0.0));
    assert_eq!(eval(FAbs, F64, &[f(-0.0)]), f(0.0));
    assert_eq!(eval(FSqrt, F64, &[f(2.0)]), f(std::f64::consts::SQRT_2));
    for (x, ceil, floor, trunc, nearest) in [
        (2.5, 3.0, 2.0, 2.0, 2.0),
        (3.5, 4.0, 3.0, 3.0, 4.0),
        (-2.5, -2.0, -3.0, -2.0, -2.0),
        (-0.4, -0.0, -1.0, -0.0, -0.0),
    ] {
        assert_eq!(eval(FCeil, F64, &[f(x)]), f(ceil));
        assert_eq!(eval(FFloor, F64, &[f(x)]), f(floor));
        assert_eq!(eval(FTrunc, F64, &[f(x)]), f(trunc));
        assert_eq!(eval(FNearest, F64, &[f(x)]), f(nearest));
        assert_eq!(eval(FNearest, F32, &[s(x as f32)]), s(nearest as f32));
    }
    let nan = f(f64::NAN);
    for (op, with_nan, equal, less) in [(FEq, 0, 1, 0), (FNe, 1, 0, 1), (FLt, 0, 0, 1), (FLe, 0, 1, 1)] {
        assert_eq!(eval(op, F64, &[nan, f(1.0)]), with_nan, "{op:?}");
        assert_eq!(eval(op, F64, &[nan, nan]), with_nan, "{op:?}");
        assert_eq!(eval(op, F64, &[f(1.0), f(1.0)]), equal, "{op:?}");
        assert_eq!(eval(op, F32, &[s(1.0), s(2.0)]), less, "{op:?}");
    }
    assert_eq!(eval(FEq, F64, &[f(0.0), f(-0.0)]), 1);
}

#[test]
fn reals_and_integers() {
    assert_eq!(eval(SToF(F32), I64, &[u64::MAX]), s(-1.0));
    assert_eq!(eval(SToF(F64), I8, &[0x80]), f(-128.0));
    assert_eq!(eval(UToF(F64), I64, &[u64::MAX]), f(18446744073709551616.0));
    assert_eq!(eval(UToF(F32), I32, &[u64::from(u32::MAX)]), s(4294967296.0));
    assert_eq!(eval(SToF(F32), I32, &[16777217]), s(16777216.0));
    for (x, i8_, u8_, i32_) in [
        (1.9, 1u64, 1u64, 1u64),
        (-1.9, 0xFF, 0, 0xFFFF_FFFF),
        (300.0, 0x7F, 0xFF, 300),
        (-300.0, 0x80, 0, 0xFFFF_FED4),
        (f64::INFINITY, 0x7F, 0xFF, 0x7FFF_FFFF),
        (f64::NEG_INFINITY, 0x80, 0, 0x8000_0000),
        (f64::NAN, 0, 0, 0),
    ] {
        assert_eq!(eval(FToS(I8), F64, &[f(x)]), i8_, "{x}");
        assert_eq!(eval(FToU(I8), F32, &[s(x as f32)]), u8_, "{x}");
        assert_eq!(eval(FToS(I32), F64, &[f(x)]), i32_, "{x}");
    }
    assert_eq!(eval(FToS(I64), F64, &[f(1e30)]), i64::MAX as u64);
    assert_eq!(eval(FToU(I64), F64, &[f(1e30)]), u64::MAX);
    assert_eq!(eval(FPromote, F32, &[s(0.1)]), f(f64::from(0.1f32)));
    assert_eq!(eval(FDemote, F64, &[f(0.1)]), s(0.1));
    assert_eq!(eval(FBits, F32, &[s(1.0)]), 0x3F80_0000);
    assert_eq!(eval(BitsF, I64, &[f(1.5)]), f(1.5));
}

#[test]
fn every_result_fits_its_representation() {
    let all = [
        Add, Sub, Mul, MulHiS, MulHiU, DivS, DivU, RemS, RemU, Neg, And, Or, Xor, Not, Shl, ShrU, ShrS, Rotl, Rotr,
        MinS, MinU, MaxS, MaxU, Eq, Ne, LtS, LeS, LtU, LeU, FAdd, FSub, FMul, FDiv, FNeg, FAbs, FSqrt, FCeil, FFloor,
        FTrunc, FNearest, FEq, FNe, FLt, FLe, FPromote, FDemote, FBits, BitsF,
    ];
    let to = INTS.into_iter().flat_map(|r| [Zext(r), Sext(r), Wrap(r), FToS(r), FToU(r)]);
    let reals = [F32, F64].into_iter().flat_map(|r| [SToF(r), UToF(r)]);
    for op in all.into_iter().chain(to).chain(reals) {
        for r in Repr::ALL.into_iter().filter(|r| op.accepts(*r)) {
            for a in edges(r) {
                for b in edges(r) {
                    let got = eval(op, r, &[a, b]);
                    assert_eq!(got & !op.result(r).mask(), 0, "{op:?} {} {a:#x} {b:#x} = {got:#x}", r.name());
                }
            }
        }
    }
}
