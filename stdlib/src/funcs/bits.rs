//! The bytes and decimal digits of bit strings: BCD (Ed. 2 table 22, Ed. 3 table 22), byte order (Ed. 3 table 37), IS_VALID_BCD
//! (Ed. 3 table 39).
//!
//! A BCD number has one decimal digit in each four bits. A digit above 9 counts with its value, so that every pattern is a
//! number; a number with more digits than there is room keeps the low ones, and a negative one is 0 (semantics.md \[T6\]).

use super::*;
use crate::elem::ALL;
use crate::prim::Repr;

/// The number of a BCD pattern, I64: pairs of digits first, then pairs of pairs.
fn from_bcd(t: Elem, pattern: Val, e: &mut dyn Emit) -> Val {
    let r = Repr::I64;
    let mut v = crate::convert::resize(t, r, e, pattern);
    let mut width = 4;
    let mut base: u64 = 10;
    while width < t.repr().bits() {
        // In each field of twice the width: low + base * high.
        let mask = u64::MAX / ((1 << width) + 1);
        let mask = e.constant(r, mask);
        let shift = e.constant(Repr::I64, u64::from(width));
        let high = e.prim(PrimOp::ShrU, r, &[v, shift]);
        let high = e.prim(PrimOp::And, r, &[high, mask]);
        let low = e.prim(PrimOp::And, r, &[v, mask]);
        let factor = e.constant(r, base);
        let high = e.prim(PrimOp::Mul, r, &[high, factor]);
        v = e.prim(PrimOp::Add, r, &[low, high]);
        width *= 2;
        base *= base;
    }
    v
}

/// The BCD pattern of a number that is not negative (as unsigned I64), its low digits.
fn to_bcd(t: Elem, number: Val, e: &mut dyn Emit) -> Val {
    let r = Repr::I64;
    let ten = e.constant(r, 10);
    let mut rest = number;
    let mut pattern = e.constant(r, 0);
    let digits = t.repr().bits() / 4;
    for n in 0..digits {
        let digit = e.prim(PrimOp::RemU, r, &[rest, ten]);
        rest = e.prim(PrimOp::DivU, r, &[rest, ten]);
        let shift = e.constant(Repr::I64, u64::from(4 * n));
        let digit = e.prim(PrimOp::Shl, r, &[digit, shift]);
        pattern = e.prim(PrimOp::Or, r, &[pattern, digit]);
    }
    crate::convert::resize(Elem::Ulint, t.repr(), e, pattern)
}

/// No digit is above 9: none has its highest bit together with one of the two behind it.
fn is_bcd(t: Elem, pattern: Val, e: &mut dyn Emit) -> Val {
    let r = t.repr();
    let mut shifted = |n| {
        let n = e.constant(Repr::I64, n);
        e.prim(PrimOp::ShrU, r, &[pattern, n])
    };
    let (eights, fours, twos) = (shifted(3), shifted(2), shifted(1));
    let either = e.prim(PrimOp::Or, r, &[fours, twos]);
    let both = e.prim(PrimOp::And, r, &[eights, either]);
    let digits = e.constant(r, 0x1111_1111_1111_1111);
    let wrong = e.prim(PrimOp::And, r, &[both, digits]);
    let zero = e.constant(r, 0);
    e.prim(PrimOp::Eq, r, &[wrong, zero])
}

/// The bytes of a value in the opposite order; a real by its bits.
fn swapped(t: Elem, v: Val, e: &mut dyn Emit) -> Val {
    let r = t.repr();
    if !r.is_int() {
        let bits = e.prim(PrimOp::FBits, r, &[v]);
        let whole = PrimOp::FBits.result(r);
        let bits = swapped_bits(whole, bits, e);
        return e.prim(PrimOp::BitsF, whole, &[bits]);
    }
    swapped_bits(r, v, e)
}

fn swapped_bits(r: Repr, v: Val, e: &mut dyn Emit) -> Val {
    // Neighbouring bytes, then neighbouring pairs, then halves.
    let mut v = v;
    let mut width = 8;
    while width < r.bits() {
        let mask = e.constant(r, u64::MAX / ((1 << width) + 1));
        let shift = e.constant(Repr::I64, u64::from(width));
        let high = e.prim(PrimOp::ShrU, r, &[v, shift]);
        let high = e.prim(PrimOp::And, r, &[high, mask]);
        let low = e.prim(PrimOp::And, r, &[v, mask]);
        let low = e.prim(PrimOp::Shl, r, &[low, shift]);
        v = e.prim(PrimOp::Or, r, &[high, low]);
        width *= 2;
    }
    v
}

pub(super) fn rows() -> Vec<StdFn> {
    use Generic::*;
    use Type::*;
    let one = [("IN", Var)];
    let mut rows = vec![
        row("$FROM_BCD", "", Bit, &one, Meaning::Formula(|t, a, e| Some(from_bcd(t, a[0], e))), ""),
        row("$TO_BCD", "", Bit, &one, Meaning::Formula(|t, a, e| Some(to_bcd(t, a[0], e))), ""),
        row(
            "IS_VALID_BCD",
            "Ed. 3 table 39",
            BitString,
            &one,
            Meaning::Formula(|t, a, e| Some(is_bcd(t, a[0], e))),
            "TRUE if every four bits of IN are a decimal digit.",
        )
        .gives(Fixed(Elem::Bool)),
    ];
    for (name, swaps, doc) in [
        ("TO_BIG_ENDIAN", true, "IN with its bytes in big-endian order."),
        ("FROM_BIG_ENDIAN", true, "IN, whose bytes are in big-endian order, as a value."),
        ("TO_LITTLE_ENDIAN", false, "IN with its bytes in little-endian order: IN itself, on every target."),
        ("FROM_LITTLE_ENDIAN", false, "IN, whose bytes are in little-endian order, as a value: IN itself."),
    ] {
        let meaning = if swaps {
            Meaning::Formula(|t, a, e| Some(swapped(t, a[0], e)))
        } else {
            Meaning::Formula(|_, a, _| Some(a[0]))
        };
        rows.push(row(name, "Ed. 3 table 37", Elementary, &one, meaning, doc));
    }
    let integers = || ALL.into_iter().filter(|e| e.is_integer());
    let clause = "Ed. 2 table 22";
    let from = "The number that IN shows in BCD. A digit above 9 counts with its value.";
    let to = "IN in BCD: its low digits, as many as there is room for; 0 if IN is negative.";
    for number in integers() {
        let name = number.name();
        let general = row(&format!("BCD_TO_{name}"), clause, BitString, &one, Meaning::FromBcd(number), from);
        rows.push(general.gives(Fixed(number)));
        // Without a width it is that of the number.
        let same = ALL.into_iter().find(|e| e.is_bits() && e.bits() == number.bits()).unwrap_or(Elem::Lword);
        let param = [("IN", Fixed(number))];
        let short = row(&format!("{name}_TO_BCD"), clause, Int, &param, Meaning::ToBcd(same), to);
        rows.push(short.gives(Fixed(same)));
    }
    for bits in ALL.into_iter().filter(|e| e.is_bits()) {
        let width = bits.name();
        let general = row(&format!("TO_BCD_{width}"), "Ed. 3 table 22", Int, &one, Meaning::ToBcd(bits), to);
        rows.push(general.gives(Fixed(bits)));
        for number in integers() {
            let name = number.name();
            let param = [("IN", Fixed(bits))];
            let meaning = Meaning::FromBcd(number);
            rows.push(
                row(&format!("{width}_BCD_TO_{name}"), clause, BitString, &param, meaning, from).gives(Fixed(number)),
            );
            let param = [("IN", Fixed(number))];
            let meaning = Meaning::ToBcd(bits);
            rows.push(row(&format!("{name}_TO_BCD_{width}"), clause, Int, &param, meaning, to).gives(Fixed(bits)));
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fold::Folder;

    fn apply(name: &str, t: Elem, raw: u64) -> u64 {
        let mut e = Folder::new();
        let x = e.value(raw);
        let v = table().get(name).unwrap().emit(t, &[x], &mut e).unwrap();
        e.raw(v)
    }

    #[test]
    fn digits() {
        assert_eq!(apply("$FROM_BCD", Elem::Byte, 0x42), 42);
        assert_eq!(apply("$FROM_BCD", Elem::Word, 0x9999), 9999);
        assert_eq!(apply("$FROM_BCD", Elem::Dword, 0x1234_5678), 12_345_678);
        assert_eq!(apply("$FROM_BCD", Elem::Lword, 0x1234_5678_9012_3456), 1_234_567_890_123_456);
        assert_eq!(apply("$FROM_BCD", Elem::Byte, 0x1F), 25);
        assert_eq!(apply("$FROM_BCD", Elem::Lword, u64::MAX), 15 * 1_111_111_111_111_111);
        assert_eq!(apply("$TO_BCD", Elem::Byte, 142), 0x42);
        assert_eq!(apply("$TO_BCD", Elem::Word, 65535), 0x5535);
        assert_eq!(apply("$TO_BCD", Elem::Lword, u64::MAX), 0x6744_0737_0955_1615);
        for n in 0..10_000 {
            let pattern = apply("$TO_BCD", Elem::Word, n);
            assert_eq!(format!("{pattern:x}"), n.to_string());
            assert_eq!(apply("$FROM_BCD", Elem::Word, pattern), n);
        }
    }

    #[test]
    fn valid_patterns() {
        for pattern in 0..=0xFFFFu64 {
            let valid = format!("{pattern:x}").bytes().all(|b| b.is_ascii_digit());
            assert_eq!(apply("IS_VALID_BCD", Elem::Word, pattern) == 1, valid, "{pattern:x}");
        }
        assert_eq!(apply("IS_VALID_BCD", Elem::Lword, 0x9999_9999_9999_9999), 1);
        assert_eq!(apply("IS_VALID_BCD", Elem::Lword, 0xA000_0000_0000_0000), 0);
    }

    #[test]
    fn byte_order() {
        let swap = |t, raw| apply("TO_BIG_ENDIAN", t, raw);
        assert_eq!(swap(Elem::Byte, 0x12), 0x12);
        assert_eq!(swap(Elem::Bool, 1), 1);
        assert_eq!(swap(Elem::Int, 0x1234), 0x3412);
        assert_eq!(swap(Elem::Dword, 0x1234_5678), 0x7856_3412);
        assert_eq!(swap(Elem::Lint, 0x0102_0304_0506_0708), 0x0807_0605_0403_0201);
        assert_eq!(swap(Elem::Real, u64::from(1.0f32.to_bits())), 0x803F);
        assert_eq!(swap(Elem::Lreal, swap(Elem::Lreal, 2.5f64.to_bits())), 2.5f64.to_bits());
        assert_eq!(apply("FROM_LITTLE_ENDIAN", Elem::Int, 0x1234), 0x1234);
    }
}
