//! Integers, based integers, reals.

use super::LiteralError;
use crate::elem::Elem;

/// The mathematical value of `-12`, `1_000`, `16#FF`. Values beyond 126 bits count as out of range of ULINT.
pub fn integer(text: &str) -> Result<i128, LiteralError> {
    let (negative, start) = sign(text);
    let body = &text[start..];
    let (base, digits_at) = match body.find('#') {
        None => (10, start),
        Some(hash) => {
            let base = match body[..hash].replace('_', "").as_str() {
                "2" => 2,
                "8" => 8,
                "16" => 16,
                _ => return Err(LiteralError::BadBase { at: start }),
            };
            (base, start + hash + 1)
        }
    };
    let digits = &text[digits_at..];
    if digits.is_empty() {
        return Err(LiteralError::Malformed { at: digits_at, expected: "a number" });
    }
    let mut value: i128 = 0;
    let mut digit_before = false;
    for (i, c) in digits.char_indices() {
        if c == '_' {
            let digit_follows = digits[i + 1..].chars().next().is_some_and(|c| c.is_digit(base));
            if !digit_before || !digit_follows {
                return Err(LiteralError::Underscore { at: digits_at + i });
            }
            digit_before = false;
            continue;
        }
        let Some(d) = c.to_digit(base) else {
            return Err(LiteralError::BadDigit { at: digits_at + i, base: base as u8 });
        };
        digit_before = true;
        if value >= 1 << 121 {
            let (min, max) = (0, i128::from(u64::MAX));
            return Err(LiteralError::OutOfRange { elem: Elem::Ulint, min, max });
        }
        value = value * i128::from(base) + i128::from(d);
    }
    Ok(if negative { -value } else { value })
}

/// A real of type REAL or LREAL, correctly rounded from its decimal text; an integer literal counts as real too.
/// A magnitude that rounds to infinity is an error, one that rounds to 0 is 0.
pub fn real(elem: Elem, text: &str) -> Result<u64, LiteralError> {
    let (_, start) = sign(text);
    let plain: String = if text.contains('#') {
        // A based integer: its decimal text has the same value.
        integer(text)?.to_string()
    } else {
        check_decimal(text, start)?;
        text.chars().filter(|c| *c != '_').collect()
    };
    let malformed = LiteralError::Malformed { at: start, expected: "a number" };
    let (raw, finite) = if elem == Elem::Real {
        let x: f32 = plain.parse().map_err(|_| malformed)?;
        (u64::from(x.to_bits()), x.is_finite())
    } else {
        let x: f64 = plain.parse().map_err(|_| malformed)?;
        (x.to_bits(), x.is_finite())
    };
    if finite { Ok(raw) } else { Err(LiteralError::TooLarge { elem }) }
}

/// Digits, then optionally a point and digits, then optionally an exponent; underscores between digits.
fn check_decimal(text: &str, start: usize) -> Result<(), LiteralError> {
    let bytes = text.as_bytes();
    let mut at = digits(bytes, start)?;
    if bytes.get(at) == Some(&b'.') {
        at = digits(bytes, at + 1)?;
    }
    if matches!(bytes.get(at), Some(b'e' | b'E')) {
        at += 1;
        if matches!(bytes.get(at), Some(b'+' | b'-')) {
            at += 1;
        }
        at = digits(bytes, at)?;
    }
    if at < bytes.len() { Err(LiteralError::Malformed { at, expected: "a number" }) } else { Ok(()) }
}

/// The end of a non-empty run of digits with underscores between them.
pub(super) fn digits(bytes: &[u8], start: usize) -> Result<usize, LiteralError> {
    let is_digit = |i: usize| bytes.get(i).is_some_and(u8::is_ascii_digit);
    if !is_digit(start) {
        return Err(LiteralError::Malformed { at: start, expected: "a digit" });
    }
    let mut at = start;
    loop {
        if is_digit(at) {
            at += 1;
        } else if bytes.get(at) == Some(&b'_') {
            if !is_digit(at + 1) {
                return Err(LiteralError::Underscore { at });
            }
            at += 1;
        } else {
            return Ok(at);
        }
    }
}

/// Whether a minus stands in front, and where the rest begins.
pub(super) fn sign(text: &str) -> (bool, usize) {
    match text.as_bytes().first() {
        Some(b'-') => (true, 1),
        Some(b'+') => (false, 1),
        _ => (false, 0),
    }
}
