//! Text of IEC literals -> values (semantics.md \[L4\], \[L5\]). The one parser for sources, stimulus files and `explain`.
//!
//! In: the text of a literal without its type prefix (`16#FF`, `1d2h`, `'text'` with its quotes) and the elementary type it
//! is to have. Out: the register value, or what is wrong as data; the words are made where the error is shown.

mod number;
pub mod prefix;
mod text;
mod time;

use crate::elem::{Elem, Family};
use std::fmt;

pub use number::{integer, real};
pub use text::{Nul, string, wstring};
pub use time::{civil_from_days, date, date_and_time, duration, time_of_day};

/// Why a value could not be read from IEC literal text. Positions are byte offsets in that text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LiteralError {
    /// `SINT#200`: well formed, but outside the type.
    OutOfRange {
        /// The type.
        elem: Elem,
        /// Its smallest value.
        min: i128,
        /// Its greatest value.
        max: i128,
    },
    /// A real, duration or date that its type cannot hold.
    TooLarge {
        /// The type.
        elem: Elem,
    },
    /// `T#1s2d`: units must fall (d, h, m, s, ms, us, ns), each once.
    UnitOrder {
        /// The unit.
        at: usize,
    },
    /// `T#1d25h`: only the first unit may overflow.
    UnitOverflow {
        /// The number.
        at: usize,
        /// One more than it may be.
        limit: u32,
    },
    /// `T#1.5h3m`: only the last unit may have a fraction.
    FractionNotLast {
        /// The number.
        at: usize,
    },
    /// `T#1min`, or a number without unit.
    UnknownUnit {
        /// What stands in the unit's place; may be empty.
        unit: String,
        /// Where.
        at: usize,
    },
    /// `2#102`: a digit that the base does not have.
    BadDigit {
        /// Where.
        at: usize,
        /// 2, 8, 10 or 16.
        base: u8,
    },
    /// `7#1`.
    BadBase {
        /// Where.
        at: usize,
    },
    /// `_1`, `1__0`, `1_`: an underscore stands between two digits.
    Underscore {
        /// Where.
        at: usize,
    },
    /// `2024-13-01`, `25:00:00`: a field outside its range.
    BadField {
        /// `month`.
        field: &'static str,
        /// Where.
        at: usize,
        /// Smallest and greatest value.
        range: (u32, u32),
    },
    /// `$00`: a string holds no character 0.
    NulCharacter {
        /// Where.
        at: usize,
    },
    /// `$x`, `$4`.
    BadEscape {
        /// Where.
        at: usize,
    },
    /// A character that a STRING (Latin-1) cannot hold.
    NotLatin1 {
        /// The character.
        found: char,
        /// Where.
        at: usize,
    },
    /// A CHAR or WCHAR literal has exactly one character.
    NotOneCharacter,
    /// Not the form of a literal of this type.
    Malformed {
        /// Where it goes wrong.
        at: usize,
        /// `a date as in 2024-01-31`.
        expected: &'static str,
    },
}

impl LiteralError {
    /// Where in the text, if at a certain byte.
    pub fn at(&self) -> Option<usize> {
        use LiteralError::*;
        match self {
            OutOfRange { .. } | TooLarge { .. } | NotOneCharacter => None,
            UnitOrder { at }
            | UnitOverflow { at, .. }
            | FractionNotLast { at }
            | UnknownUnit { at, .. }
            | BadDigit { at, .. }
            | BadBase { at }
            | Underscore { at }
            | BadField { at, .. }
            | NulCharacter { at }
            | BadEscape { at }
            | NotLatin1 { at, .. }
            | Malformed { at, .. } => Some(*at),
        }
    }

    /// What to write instead, where that is clear.
    pub fn help(&self) -> Option<String> {
        match self {
            LiteralError::UnknownUnit { unit, .. } => {
                let meant = match unit.to_ascii_lowercase().as_str() {
                    "min" | "mins" | "minute" | "minutes" => "m",
                    "sec" | "secs" | "second" | "seconds" => "s",
                    "hour" | "hours" | "hr" | "hrs" | "std" => "h",
                    "day" | "days" => "d",
                    "msec" | "millis" => "ms",
                    "usec" | "µs" | "μs" => "us",
                    "nsec" => "ns",
                    _ => return None,
                };
                Some(format!("write `{meant}`"))
            }
            LiteralError::BadDigit { base, .. } => {
                let digits = match base {
                    2 => "0 and 1",
                    8 => "0 to 7",
                    16 => "0 to 9 and A to F",
                    _ => "0 to 9",
                };
                Some(format!("its digits are {digits}"))
            }
            LiteralError::UnitOrder { .. } => Some("write for example T#1d2h3m4s5ms".to_string()),
            LiteralError::UnitOverflow { .. } => Some("carry it over: T#1d25h is T#2d1h".to_string()),
            LiteralError::FractionNotLast { .. } => Some("T#1.5h3m is T#1h33m".to_string()),
            LiteralError::NulCharacter { .. } => Some("end the string before it, or set its length".to_string()),
            LiteralError::NotLatin1 { .. } => Some("use a WSTRING: \"...\"".to_string()),
            _ => None,
        }
    }
}

impl fmt::Display for LiteralError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use LiteralError::*;
        match self {
            OutOfRange { elem, min, max } => write!(f, "the value is outside {}, which is {min}..{max}", elem.name()),
            TooLarge { elem } => write!(f, "the value is too large for {}", elem.name()),
            UnitOrder { .. } => {
                f.write_str("units of a duration fall from d over h, m, s, ms, us to ns, each at most once")
            }
            UnitOverflow { limit, .. } => {
                write!(f, "only the first unit of a duration may overflow; here the number stays below {limit}")
            }
            FractionNotLast { .. } => f.write_str("only the last unit of a duration may have a fraction"),
            UnknownUnit { unit, .. } if unit.is_empty() => {
                f.write_str("a number of a duration needs a unit: d, h, m, s, ms, us or ns")
            }
            UnknownUnit { unit, .. } => write!(f, "`{unit}` is no unit of a duration: d, h, m, s, ms, us or ns"),
            BadDigit { base, .. } => write!(f, "not a digit of base {base}"),
            BadBase { .. } => f.write_str("the base of a number is 2, 8 or 16"),
            Underscore { .. } => f.write_str("an underscore stands between two digits"),
            BadField { field, range: (min, max), .. } => write!(f, "the {field} is {min} to {max}"),
            NulCharacter { .. } => f.write_str("a string cannot hold the character 0"),
            BadEscape { .. } => f.write_str(
                "`$` stands before $, ', \", L, N, P, R, T or the hexadecimal code of a character \
                 (two digits, four in a WSTRING)",
            ),
            NotLatin1 { found, .. } => write!(f, "a STRING cannot hold `{found}`, only Latin-1"),
            NotOneCharacter => f.write_str("one character is needed"),
            Malformed { expected, .. } => write!(f, "expected {expected}"),
        }
    }
}

/// The register value of a literal of type `elem`; `text` has no prefix, but may have a sign before a number or duration.
pub fn parse(elem: Elem, text: &str) -> Result<u64, LiteralError> {
    let ns = |ns: i64| ns as u64;
    match elem.family() {
        Family::Bool if text.eq_ignore_ascii_case("TRUE") => Ok(1),
        Family::Bool if text.eq_ignore_ascii_case("FALSE") => Ok(0),
        Family::Bool => match integer(text) {
            Ok(n) => fit(elem, n),
            Err(LiteralError::BadDigit { at, base: 10 }) => {
                Err(LiteralError::Malformed { at, expected: "TRUE, FALSE, 1 or 0" })
            }
            Err(e) => Err(e),
        },
        Family::Signed | Family::Unsigned | Family::Bits => fit(elem, integer(text)?),
        Family::Real => real(elem, text),
        Family::Duration => duration(text).map(ns),
        Family::Date => date(text).map(ns),
        Family::TimeOfDay => time_of_day(text).map(ns),
        Family::DateTime => date_and_time(text).map(ns),
        Family::Char if elem == Elem::Char => match string(text, Nul::Error)?[..] {
            [c] => Ok(u64::from(c)),
            _ => Err(LiteralError::NotOneCharacter),
        },
        Family::Char => match wstring(text, Nul::Error)?[..] {
            [c] => Ok(u64::from(c)),
            _ => Err(LiteralError::NotOneCharacter),
        },
    }
}

/// A mathematical integer as a register value of an integer, bit-string or BOOL type.
pub fn fit(elem: Elem, n: i128) -> Result<u64, LiteralError> {
    match elem.range() {
        Some((min, max)) if n < min || n > max => Err(LiteralError::OutOfRange { elem, min, max }),
        _ => Ok(n as u64 & elem.repr().mask()),
    }
}

#[cfg(test)]
mod tests;
