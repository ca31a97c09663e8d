//! The value with which a text begins: conversions of strings (semantics.md \[T6\]).
//!
//! Unlike the parsers of literals these accept any text and never allocate: they run in every scan.

use crate::elem::{Elem, Family};
use crate::value::prefix_type;

/// The register value that a text begins with: leading blanks are skipped, then counts the longest prefix that is a number
/// (an integer may be based, `16#FF`); no such prefix is 0. A duration or date is the whole text, as a literal with its
/// prefix (`T#5s`), else 0. An integer outside its type keeps its low bits, as between integers.
///
/// A CHAR or WCHAR is not read here: its value is the first character, whatever that is.
pub fn value(elem: Elem, text: &[u8]) -> u64 {
    if matches!(elem.family(), Family::Signed | Family::Unsigned | Family::Bits)
        && let Some(number) = short_decimal(text)
    {
        return number as u64 & elem.repr().mask();
    }
    let text = ascii(text).trim_start_matches([' ', '\t']);
    match elem.family() {
        Family::Bool if text.get(..4).is_some_and(|t| t.eq_ignore_ascii_case("TRUE")) => 1,
        Family::Bool => u64::from(integer(text) != 0),
        Family::Signed | Family::Unsigned | Family::Bits => integer(text) as u64 & elem.repr().mask(),
        Family::Real => real(elem, text),
        Family::Duration | Family::Date | Family::TimeOfDay | Family::DateTime => time(elem, text),
        Family::Char => 0,
    }
}

/// What nearly every text is: blanks, a minus, up to 18 digits, and something else or the end. The rest is left to
/// [`integer`]. The text may go on behind a 0, at which it ends.
pub fn short_decimal(text: &[u8]) -> Option<i64> {
    let blanks = text.iter().take_while(|c| matches!(c, b' ' | b'\t')).count();
    let (negative, digits) = match &text[blanks..] {
        [b'-', digits @ ..] => (true, digits),
        digits => (false, digits),
    };
    let mut value = 0i64;
    for (n, c) in digits.iter().enumerate() {
        let digit = c.wrapping_sub(b'0');
        if digit > 9 {
            let more = matches!(c, b'#' | b'_') || n == 0 && *c != 0;
            return (!more).then_some(if negative { -value } else { value });
        }
        if n == 18 {
            return None;
        }
        value = value * 10 + i64::from(digit);
    }
    (!digits.is_empty()).then_some(if negative { -value } else { value })
}

/// The characters before the first one outside ASCII: no value has such a character.
fn ascii(text: &[u8]) -> &str {
    let end = text.iter().position(|c| !c.is_ascii()).unwrap_or(text.len());
    std::str::from_utf8(&text[..end]).unwrap_or("")
}

/// Cut at the limits of LINT and ULINT.
fn integer(text: &str) -> i128 {
    let (negative, start) = super::number::sign(text);
    let text = &text[start..];
    let based = [("2#", 2), ("8#", 8), ("16#", 16)].into_iter().find_map(|(prefix, base)| {
        let digits = text.strip_prefix(prefix)?;
        digits.starts_with(|c: char| c.is_digit(base)).then_some((digits, base))
    });
    let (digits, base) = based.unwrap_or((text, 10));
    let mut value: i128 = 0;
    let mut rest = digits;
    while let Some(c) = rest.chars().next() {
        let follows = rest[1..].starts_with(|c: char| c.is_digit(base));
        match c.to_digit(base) {
            Some(d) => value = (value * i128::from(base) + i128::from(d)).min(i128::from(u64::MAX)),
            None if c == '_' && rest.len() < digits.len() && follows => {}
            None => break,
        }
        rest = &rest[1..];
    }
    if negative { (-value).max(i128::from(i64::MIN)) } else { value }
}

fn real(elem: Elem, text: &str) -> u64 {
    let end = real_end(text.as_bytes());
    // What Rust reads from this is correctly rounded in each precision.
    if elem == Elem::Real {
        u64::from(text[..end].parse::<f32>().unwrap_or(0.0).to_bits())
    } else {
        text[..end].parse::<f64>().unwrap_or(0.0).to_bits()
    }
}

/// The end of the longest real number: digits with a point somewhere, an exponent; or `inf` and `nan` as the trace writes
/// them.
fn real_end(text: &[u8]) -> usize {
    let sign = usize::from(matches!(text.first(), Some(b'-' | b'+')));
    let digits = |from: usize| text[from.min(text.len())..].iter().take_while(|c| c.is_ascii_digit()).count();
    let special = |name: &[u8]| text[sign..].get(..name.len()).is_some_and(|t| t.eq_ignore_ascii_case(name));
    if special(b"inf") || special(b"nan") {
        return sign + 3;
    }
    let whole = digits(sign);
    let mut end = sign + whole;
    let mut any = whole > 0;
    if text.get(end) == Some(&b'.') {
        let fraction = digits(end + 1);
        if fraction > 0 {
            end += 1 + fraction;
            any = true;
        }
    }
    if !any {
        return 0;
    }
    if matches!(text.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(text.get(end + 1), Some(b'-' | b'+')));
        let exponent = digits(end + 1 + sign);
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}

fn time(elem: Elem, text: &str) -> u64 {
    let text = text.trim_end_matches([' ', '\t']);
    let Some((prefix, rest)) = text.split_once('#') else { return 0 };
    let of_family = prefix_type(prefix).is_some_and(|own| own.family() == elem.family());
    if !of_family || (elem.family() == Family::Duration && !units_are_known(rest)) {
        return 0;
    }
    super::parse(elem, rest).unwrap_or(0)
}

/// Whether every run of letters is a unit of a duration: the message about another one would be allocated.
fn units_are_known(text: &str) -> bool {
    let names = text.split(|c: char| !c.is_ascii_alphabetic()).filter(|name| !name.is_empty());
    let known = ["d", "h", "m", "s", "ms", "us", "ns"];
    names.into_iter().all(|name| known.iter().any(|unit| unit.eq_ignore_ascii_case(name)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use Elem::*;

    #[test]
    fn integers_by_longest_prefix() {
        for (text, want) in [
            ("12", 12),
            ("  -12abc", -12),
            ("+7", 7),
            ("1.9", 1),
            ("1e3", 1),
            ("16#fF", 255),
            ("2#1012", 5),
            ("16#", 16),
            ("16#g", 16),
            ("3#12", 3),
            ("1_000", 1000),
            ("1__0", 1),
            ("_1", 0),
            ("", 0),
            ("-", 0),
            ("abc", 0),
            ("\t5", 5),
            ("5\u{e4}6", 5),
            ("-9223372036854775808", i64::MIN),
            ("-99999999999999999999999999999999999999999999999999", i64::MIN),
        ] {
            assert_eq!(value(Lint, text.as_bytes()) as i64, want, "{text}");
        }
        assert_eq!(value(Ulint, b"18446744073709551615"), u64::MAX);
        assert_eq!(value(Ulint, b"99999999999999999999999"), u64::MAX);
        assert_eq!(value(Int, b"40000"), 40000, "the low bits are kept");
        assert_eq!(value(Byte, b"-1"), 0xFF);
        assert_eq!(value(Usint, b"\xFF1"), 0);
    }

    #[test]
    fn truth_values() {
        for (text, want) in [("TRUE", 1), (" true", 1), ("1", 1), ("-5", 1), ("FALSE", 0), ("0", 0), ("", 0), ("x", 0)]
        {
            assert_eq!(value(Bool, text.as_bytes()), want, "{text}");
        }
    }

    #[test]
    fn reals_by_longest_prefix() {
        for (text, want) in [
            ("1.5", 1.5),
            (" -2.5e3x", -2500.0),
            ("1e", 1.0),
            ("1e+", 1.0),
            ("7.", 7.0),
            (".5", 0.5),
            (".", 0.0),
            ("-", 0.0),
            ("1.2.3", 1.2),
            ("inf", f64::INFINITY),
            ("-inf", f64::NEG_INFINITY),
            ("1e999", f64::INFINITY),
            ("0.1", 0.1),
        ] {
            assert_eq!(f64::from_bits(value(Lreal, text.as_bytes())), want, "{text}");
        }
        assert_eq!(f32::from_bits(value(Real, b"0.1") as u32), 0.1);
        assert!(f64::from_bits(value(Lreal, b"nan")).is_nan());
        // A value halfway between two floats, decided by a digit that a detour over LREAL would lose.
        assert_eq!(f32::from_bits(value(Real, b"1.00000017881393432617187499") as u32), 1.000_000_1);
    }

    #[test]
    fn times_are_whole_literals() {
        assert_eq!(value(Time, b" T#1m30s "), 90_000_000_000);
        assert_eq!(value(Ltime, b"TIME#-5ns") as i64, -5);
        assert_eq!(value(Date, b"D#1970-01-02"), 86_400_000_000_000);
        assert_eq!(value(Dt, b"DT#1970-01-01-00:00:01"), 1_000_000_000);
        assert_eq!(value(Tod, b"TOD#00:00:00.5"), 500_000_000);
        for bad in ["5s", "T#", "T#5x", "T#5min", "D#1970-01-01", "T#5s x", ""] {
            assert_eq!(value(Time, bad.as_bytes()), 0, "{bad}");
        }
        assert_eq!(value(Date, b"D#2024-02-30"), 0);
    }
}
