//! Values from semantics.md \[T6\] and the limits of every pair of types.

use super::*;
use crate::elem::ALL;
use crate::fold::Folder;
use Elem::*;

fn conv(from: Elem, to: Elem, raw: u64) -> u64 {
    let mut e = Folder::new();
    let v = e.value(raw & from.repr().mask());
    let r = convert(from, to, &mut e, v).unwrap_or_else(|| panic!("{}_TO_{}", from.name(), to.name()));
    assert_eq!(e.raw(r) & !to.repr().mask(), 0);
    e.raw(r)
}
fn real(x: f32) -> u64 {
    u64::from(x.to_bits())
}
fn lreal(x: f64) -> u64 {
    x.to_bits()
}
fn s(to: Elem, raw: u64) -> i128 {
    to.to_i128(raw)
}

#[test]
fn integers_and_bit_strings_keep_the_low_bits() {
    assert_eq!(s(Sint, conv(Byte, Sint, 0xFF)), -1);
    assert_eq!(conv(Int, Word, -1i64 as u64), 0xFFFF);
    assert_eq!(conv(Int, Dword, -1i64 as u64), 0xFFFF_FFFF, "sign-extended");
    assert_eq!(s(Int, conv(Byte, Int, 0xFF)), 255, "a bit string extends with zeros");
    assert_eq!(s(Sint, conv(Dint, Sint, 300)), 44);
    assert_eq!(conv(Usint, Bool, 2), 1);
    assert_eq!(conv(Bool, Lword, 1), 1);
    assert_eq!(conv(Char, Int, 0xE4), 0xE4);
    assert_eq!(conv(Byte, Wchar, 0x41), 0x41);
    for from in ALL.into_iter().filter(|e| e.is_integer() || e.is_bits()) {
        for to in ALL.into_iter().filter(|e| e.is_integer() || e.is_bits()) {
            for x in [0i128, 1, -1, 127, 128, 255, -128, 32767, 65535, i128::from(i64::MIN), i128::from(i64::MAX)] {
                let raw = x as u64 & from.repr().mask();
                let want = from.to_i128(raw) as u64 & to.repr().mask();
                assert_eq!(conv(from, to, raw), want, "{} {} {x}", from.name(), to.name());
            }
        }
    }
}

#[test]
fn reals_round_to_even_and_saturate() {
    for (x, want) in [(2.5, 2), (3.5, 4), (-2.5, -2), (-1.6, -2), (0.4, 0)] {
        for to in [Sint, Int, Dint, Lint] {
            assert_eq!(s(to, conv(Real, to, real(x))), i128::from(want), "{x}");
            assert_eq!(s(to, conv(Lreal, to, lreal(f64::from(x)))), i128::from(want), "{x}");
        }
    }
    for to in ALL.into_iter().filter(|e| e.is_integer() || e.is_bits()) {
        let (min, max) = to.range().unwrap();
        assert_eq!(s(to, conv(Lreal, to, lreal(1e30))), max, "{}", to.name());
        assert_eq!(s(to, conv(Real, to, real(-1e30))), min, "{}", to.name());
        assert_eq!(s(to, conv(Real, to, real(f32::INFINITY))), max);
        assert_eq!(s(to, conv(Lreal, to, lreal(f64::NAN))), 0);
        if to.bytes() < 8 {
            assert_eq!(s(to, conv(Lreal, to, lreal(max as f64))), max);
            assert_eq!(s(to, conv(Lreal, to, lreal(max as f64 + 1.0))), max);
            assert_eq!(s(to, conv(Lreal, to, lreal(min as f64 - 1.0))), min);
        }
    }
    assert_eq!(conv(Real, Bool, real(0.5)), 1);
    assert_eq!(conv(Lreal, Bool, lreal(-0.0)), 0);
}

#[test]
fn integers_to_reals_round_once() {
    assert_eq!(conv(Udint, Real, 0xFFFF_FFFF), real(4294967296.0));
    assert_eq!(conv(Udint, Lreal, 0xFFFF_FFFF), lreal(4294967295.0));
    assert_eq!(conv(Ulint, Lreal, u64::MAX), lreal(18446744073709551616.0));
    assert_eq!(conv(Lint, Real, u64::MAX), real(-1.0));
    assert_eq!(conv(Word, Real, 0xFFFF), real(65535.0), "a bit string by value");
    assert_eq!(conv(Sint, Lreal, 0x80), lreal(-128.0));
    assert_eq!(conv(Dword, Real, 0x3F80_0000), real(1065353216.0));
    assert_eq!(conv(Bool, Real, 1), real(1.0));
    // 2^24 + 1 is halfway, 2^61 + 2^37 + 1 just above halfway: a detour over LREAL would lose the 1.
    assert_eq!(conv(Dint, Real, 16_777_217), real(16_777_216.0));
    assert_eq!(conv(Lint, Real, (1 << 61) + (1 << 37) + 1), real(((1u64 << 61) + (1 << 38)) as f32));
}

#[test]
fn times_in_their_units() {
    let ms = |n: i64| (n * 1_000_000) as u64;
    assert_eq!(conv(Time, Dint, ms(1500)), 1500);
    assert_eq!(s(Dint, conv(Time, Dint, (-1_999_999i64) as u64)), -1, "toward zero");
    assert_eq!(conv(Time, Real, ms(1500) + 500_000), real(1500.5));
    assert_eq!(conv(Dint, Time, 25), ms(25));
    assert_eq!(conv(Dword, Time, 0xFFFF_FFFF), ms(4294967295));
    assert_eq!(conv(Real, Time, real(1.5)), 1_500_000);
    assert_eq!(conv(Lreal, Ltime, lreal(2.5)), 2);
    assert_eq!(conv(Lint, Ltime, 7), 7);
    assert_eq!(conv(Ltime, Lint, 1_999), 1_999);
    assert_eq!(conv(Lreal, Time, lreal(f64::NAN)), 0);
    assert_eq!(conv(Lreal, Time, lreal(1e300)), i64::MAX as u64);
    assert_eq!(conv(Time, Bool, 1), 1);
    assert_eq!(conv(Tod, Udint, ms(47_100_000)), 47_100_000);
    assert_eq!(conv(Udint, Dt, 86_401), 86_401_000_000_000);
    assert_eq!(conv(Dt, Udint, 86_401_999_000_000), 86_401);
    assert_eq!(conv(Udint, Date, 86_401), NS_PER_DAY as u64, "whole days");
    assert_eq!(conv(Time, Ltime, 5), 5);
}

#[test]
fn dates_split_at_midnight() {
    let day = NS_PER_DAY;
    assert_eq!(conv(Dt, Date, (3 * day + 17) as u64), (3 * day) as u64);
    assert_eq!(conv(Dt, Tod, (3 * day + 17) as u64), 17);
    assert_eq!(conv(Dt, Date, -17i64 as u64), -day as u64);
    assert_eq!(conv(Ldt, Ltod, -17i64 as u64), (day - 17) as u64);
    assert_eq!(conv(Date, Dt, day as u64), day as u64);
}

#[test]
fn what_does_not_exist() {
    for (from, to) in [(Time, Date), (Date, Tod), (Tod, Dt), (Char, Real), (Time, Char), (Bool, Char), (Dt, Ltime)] {
        assert!(!exists(from, to), "{}_TO_{}", from.name(), to.name());
    }
    for from in ALL {
        for to in ALL {
            let mut e = Folder::new();
            let v = e.value(0);
            let result = convert(from, to, &mut e, v);
            assert_eq!(result.is_some(), exists(from, to));
            if let Some(r) = result {
                assert_eq!(e.raw(r), 0, "0 is 0 in {}_TO_{}", from.name(), to.name());
            }
        }
    }
}

#[test]
fn trunc_goes_toward_zero() {
    let t = |x: f64, to: Elem| {
        let mut e = Folder::new();
        let v = e.value(lreal(x));
        trunc(Lreal, to, &mut e, v).map(|r| s(to, e.raw(r)))
    };
    assert_eq!(t(-1.9, Int), Some(-1));
    assert_eq!(t(1.9, Dint), Some(1));
    assert_eq!(t(1e9, Int), Some(32767));
    assert_eq!(t(-5.0, Uint), Some(0));
    assert_eq!(t(1.0, Word), None);
}
