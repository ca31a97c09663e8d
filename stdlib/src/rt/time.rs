//! Durations times and divided by reals, exact before the one rounding (semantics.md \[T7\]).
//!
//! A double is an integer of 53 bits times a power of two, so product and quotient of 64-bit nanoseconds are ratios of integers
//! that fit 128 bits: they are rounded once, to the nearest nanosecond, ties to even. Results outside 64 bits saturate, NaN
//! gives 0, as in conversions of reals to integers.

use super::RtFn;
use crate::prim::Repr;

macro_rules! rows {
    ($($row:ident $symbol:ident: $doc:literal;)*) => {
        $(
            #[doc = $doc]
            #[unsafe(no_mangle)]
            pub extern "C" fn $symbol(ns: i64, factor: f64) -> i64 {
                rows!(@body $row)(ns, factor)
            }

            #[doc = $doc]
            pub static $row: RtFn = RtFn {
                symbol: stringify!($symbol),
                params: &[Repr::I64, Repr::F64],
                result: Repr::I64,
                eval: |args| {
                    let arg = |n: usize| args.get(n).copied().unwrap_or(0);
                    $symbol(arg(0) as i64, f64::from_bits(arg(1))) as u64
                },
                address: || $symbol as *const u8,
            };
        )*
        /// Every row.
        pub static ALL: &[&RtFn] = &[$(&$row),*];
    };
    (@body MUL_REAL) => { product };
    (@body DIV_REAL) => { quotient };
}

rows! {
    MUL_REAL plcc_time_mul_real: "A duration in nanoseconds times a double.";
    DIV_REAL plcc_time_div_real: "A duration in nanoseconds divided by a double.";
}

fn product(ns: i64, factor: f64) -> i64 {
    let negative = (ns < 0) != factor.is_sign_negative();
    if factor.is_nan() || ns == 0 {
        return 0;
    }
    if factor.is_infinite() {
        return signed(u128::MAX, negative);
    }
    let (mantissa, exponent) = parts(factor);
    let exact = u128::from(ns.unsigned_abs()) * u128::from(mantissa);
    let magnitude = match exponent {
        // 116 bits that move left: past 64 of them nothing but saturation is left, and 0.
        0.. if exact == 0 => 0,
        0.. if exact.leading_zeros() < exponent as u32 => u128::MAX,
        0.. => exact << exponent,
        -126..0 => rounded(exact, 1 << -exponent),
        // Less than half a nanosecond.
        _ => 0,
    };
    signed(magnitude, negative)
}

fn quotient(ns: i64, divisor: f64) -> i64 {
    let negative = (ns < 0) != divisor.is_sign_negative();
    if divisor.is_nan() || ns == 0 || divisor.is_infinite() {
        return 0;
    }
    if divisor == 0.0 {
        return signed(u128::MAX, negative);
    }
    let ns = u128::from(ns.unsigned_abs());
    let (mantissa, exponent) = parts(divisor);
    let mantissa = u128::from(mantissa);
    let magnitude = match exponent {
        // The divisor exceeds twice any duration.
        66.. => 0,
        0..66 => rounded(ns, mantissa << exponent),
        // 128 bits of dividend against 53 of divisor: outside 64 bits whatever the rest is.
        _ if ns.leading_zeros() < -exponent as u32 => u128::MAX,
        _ => rounded(ns << -exponent, mantissa),
    };
    signed(magnitude, negative)
}

/// A finite double as mantissa times two to the power of the exponent; the mantissa of what is not 0 is odd.
fn parts(x: f64) -> (u64, i32) {
    let bits = x.to_bits();
    let fraction = bits & ((1 << 52) - 1);
    let (mantissa, exponent) = match (bits >> 52) & 0x7FF {
        0 => (fraction, -1074),
        biased => (fraction | 1 << 52, biased as i32 - 1075),
    };
    if mantissa == 0 {
        return (0, 0);
    }
    let zeros = mantissa.trailing_zeros();
    (mantissa >> zeros, exponent + zeros as i32)
}

/// The ratio to the nearest integer, ties to even. The divisor is at most 2^126 and not 0.
fn rounded(dividend: u128, divisor: u128) -> u128 {
    let (q, rest) = (dividend / divisor, dividend % divisor);
    let up = match (2 * rest).cmp(&divisor) {
        std::cmp::Ordering::Less => false,
        std::cmp::Ordering::Equal => q % 2 == 1,
        std::cmp::Ordering::Greater => true,
    };
    q + u128::from(up)
}

/// A magnitude with its sign, at most the largest and least duration.
fn signed(magnitude: u128, negative: bool) -> i64 {
    let limit = if negative { 1 << 63 } else { (1 << 63) - 1 };
    let magnitude = magnitude.min(limit) as u64;
    if negative { (magnitude as i64).wrapping_neg() } else { magnitude as i64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_beyond_53_bits() {
        let odd = (1 << 53) + 1;
        assert_eq!(product(odd, 1.0), odd);
        assert_eq!(quotient(odd, 1.0), odd);
        assert_eq!(product(i64::MAX, 1.0), i64::MAX);
        assert_eq!(product(i64::MIN, 1.0), i64::MIN);
        assert_eq!(product(i64::MIN, -1.0), i64::MAX);
        // (2^63 - 1) / 2 = 2^62 - 1/2: a tie, to the even 2^62.
        assert_eq!(product(i64::MAX, 0.5), 1 << 62);
        assert_eq!(quotient(i64::MAX, 2.0), 1 << 62);
        assert_eq!(quotient(i64::MAX, 0.5), i64::MAX);
        // 0.1 as a double is 3602879701896397 / 2^55.
        let ns: i64 = 9_000_000_000_000_000_001;
        let exact = (ns as i128 * 3_602_879_701_896_397 + (1 << 54)) >> 55;
        assert_eq!(i128::from(product(ns, 0.1)), exact);
    }

    #[test]
    fn ties_go_to_even() {
        assert_eq!([1, 3, 5, 7].map(|ns| product(ns, 0.5)), [0, 2, 2, 4]);
        assert_eq!([-1, -3, -5].map(|ns| product(ns, 0.5)), [0, -2, -2]);
        assert_eq!([1, 3, 5, 7].map(|ns| quotient(ns, -2.0)), [0, -2, -2, -4]);
        assert_eq!(quotient(5, 3.0), 2);
    }

    #[test]
    fn special_values() {
        let inf = f64::INFINITY;
        assert_eq!([product(5, inf), product(-5, inf), product(5, -inf)], [i64::MAX, i64::MIN, i64::MIN]);
        assert_eq!([product(0, inf), product(5, f64::NAN), quotient(0, 0.0), quotient(5, f64::NAN)], [0; 4]);
        assert_eq!([quotient(5, 0.0), quotient(5, -0.0), quotient(-5, 0.0)], [i64::MAX, i64::MIN, i64::MIN]);
        assert_eq!([quotient(5, inf), quotient(i64::MAX, f64::MAX), product(5, f64::MIN_POSITIVE)], [0; 3]);
        assert_eq!([product(1, 0.0), product(i64::MIN, f64::from_bits(1))], [0; 2]);
        assert_eq!([product(1, f64::MAX), quotient(1, f64::from_bits(1))], [i64::MAX; 2]);
        assert_eq!(product(1, 2f64.powi(62)), 1 << 62);
        assert_eq!(product(1, 2f64.powi(64)), i64::MAX);
        assert_eq!(quotient(1 << 62, 2f64.powi(62)), 1);
        assert_eq!(quotient(1 << 62, 2f64.powi(63)), 0, "a half, to the even 0");
        assert_eq!(quotient(3 << 61, 2f64.powi(63)), 1);
        assert_eq!(quotient(1, 2f64.powi(-62)), 1 << 62);
        assert_eq!(quotient(1, 2f64.powi(-64)), i64::MAX);
    }

    /// Against a division bit by bit, on patterns of all sizes.
    #[test]
    fn against_long_division() {
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            seed >> 11
        };
        for _ in 0..20_000 {
            let ns = (random() << 11 >> (random() % 64)) as i64;
            let factor = (random() >> (random() % 52)) as f64 * 2f64.powi((random() % 100) as i32 - 70);
            let (m, e) = parts(factor);
            if m == 0 || ns == 0 {
                continue;
            }
            let top = u128::from(ns.unsigned_abs()) * u128::from(m);
            let want = long_division(top, e, 1, 0);
            assert_eq!(i128::from(product(ns, factor)).unsigned_abs(), want.min(limit(ns)), "{ns} * {factor:e}");
            let want = long_division(u128::from(ns.unsigned_abs()), 0, u128::from(m), e);
            assert_eq!(i128::from(quotient(ns, factor)).unsigned_abs(), want.min(limit(ns)), "{ns} / {factor:e}");
        }
    }

    fn limit(ns: i64) -> u128 {
        if ns < 0 { 1 << 63 } else { (1 << 63) - 1 }
    }

    /// a * 2^i / (b * 2^j), rounded, at most 2^64: doubles the rest once per bit.
    fn long_division(a: u128, i: i32, b: u128, j: i32) -> u128 {
        let (mut q, mut rest) = (a / b, a % b);
        let mut lost = false;
        let mut shift = i - j;
        while shift > 0 && q < 1 << 64 {
            rest *= 2;
            q = 2 * q + rest / b;
            rest %= b;
            shift -= 1;
        }
        if shift >= 0 {
            let up = 2 * rest > b || 2 * rest == b && q % 2 == 1;
            return (q + u128::from(up)).min(1 << 64);
        }
        let mut half = false;
        lost |= rest != 0;
        while shift < 0 {
            lost |= half;
            half = q % 2 == 1;
            q /= 2;
            shift += 1;
        }
        (q + u128::from(half && (lost || q % 2 == 1))).min(1 << 64)
    }
}
