//! Values and their text: what the trace writes, a stimulus file reads, and a message shows (the table of `cli.md`).
//!
//! Text -> value goes through [`literal`]; here a type prefix is checked and taken off. Value -> text and back gives the same
//! value. Enumerations are left to the caller, who knows the names of their values.

use crate::convert::NS_PER_DAY;
use crate::elem::{Elem, Family};
use crate::literal::{self, LiteralError, Nul};
use std::fmt::{self, Write};

/// A value of an elementary type or a string.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Value {
    /// Fits a register.
    Scalar {
        /// Its type.
        elem: Elem,
        /// Register value, zero-extended.
        raw: u64,
    },
    /// STRING: Latin-1 characters without the closing 0.
    String(Vec<u8>),
    /// WSTRING: UTF-16 units without the closing 0.
    WString(Vec<u16>),
}

/// What a text is read as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// An elementary type.
    Elem(Elem),
    /// STRING.
    String,
    /// WSTRING.
    WString,
}

/// Why a text is no value of a type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ValueError {
    /// The literal is wrong; positions count in the text after the prefix.
    Literal {
        /// What is wrong.
        error: LiteralError,
        /// Length of the prefix with its `#`.
        prefix: usize,
    },
    /// `INT#5` where a TIME is needed.
    WrongType {
        /// What stands there.
        found: String,
        /// What is needed.
        expected: &'static str,
    },
    /// `5s` instead of `T#5s`.
    MissingPrefix {
        /// `T#`.
        expected: &'static str,
    },
}

impl fmt::Display for ValueError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ValueError::Literal { error, .. } => {
                write!(f, "{error}")?;
                error.help().map_or(Ok(()), |help| write!(f, "; {help}"))
            }
            ValueError::WrongType { found, expected } => write!(f, "`{found}` is no value of type {expected}"),
            ValueError::MissingPrefix { expected } => write!(f, "the value starts with `{expected}`"),
        }
    }
}

impl Kind {
    /// The keyword.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Elem(e) => e.name(),
            Kind::String => "STRING",
            Kind::WString => "WSTRING",
        }
    }

    /// Reads an IEC literal of this type, with or without prefix (durations and dates need theirs); also `inf`, `-inf` and
    /// `nan`, as the trace writes them.
    pub fn parse(self, text: &str) -> Result<Value, ValueError> {
        let text = text.trim();
        let plain = |error| ValueError::Literal { error, prefix: 0 };
        match self {
            Kind::String => {
                let text = strip_keyword(text, "STRING#");
                literal::string(text, Nul::Error).map(Value::String).map_err(plain)
            }
            Kind::WString => {
                let text = strip_keyword(text, "WSTRING#");
                literal::wstring(text, Nul::Error).map(Value::WString).map_err(plain)
            }
            Kind::Elem(elem) => parse_scalar(elem, text).map(|raw| Value::Scalar { elem, raw }),
        }
    }
}

fn strip_keyword<'a>(text: &'a str, keyword: &str) -> &'a str {
    match text.split_at_checked(keyword.len()) {
        Some((head, rest)) if head.eq_ignore_ascii_case(keyword) => rest,
        _ => text,
    }
}

fn parse_scalar(elem: Elem, text: &str) -> Result<u64, ValueError> {
    if elem.is_real() {
        let special = [("inf", f64::INFINITY), ("+inf", f64::INFINITY), ("-inf", f64::NEG_INFINITY), ("nan", f64::NAN)];
        if let Some((_, x)) = special.iter().find(|(name, _)| text.eq_ignore_ascii_case(name)) {
            return Ok(if elem == Elem::Real { u64::from((*x as f32).to_bits()) } else { x.to_bits() });
        }
    }
    let Some((prefix, rest)) = split_prefix(text) else {
        if elem.is_time_like() {
            return Err(ValueError::MissingPrefix { expected: short_prefix(elem) });
        }
        return literal::parse(elem, text).map_err(|error| ValueError::Literal { error, prefix: 0 });
    };
    let at = |error| ValueError::Literal { error, prefix: text.len() - rest.len() };
    let wrong = || ValueError::WrongType { found: text.to_string(), expected: elem.name() };
    let own = prefix_type(prefix).ok_or_else(wrong)?;
    if own.family() == elem.family() && elem.is_time_like() {
        return literal::parse(elem, rest).map_err(at);
    }
    let number = |e: Elem| e.is_integer() || e.is_bits();
    if own == elem {
        literal::parse(elem, rest).map_err(at)
    } else if number(own) && number(elem) {
        // By value: INT#5 is a DINT too, if it fits both.
        let n = own.to_i128(literal::parse(own, rest).map_err(at)?);
        literal::fit(elem, n).map_err(at)
    } else if elem.is_real() && (number(own) || own.is_real()) {
        literal::parse(own, rest).map_err(at)?;
        literal::parse(elem, rest).map_err(at)
    } else {
        Err(wrong())
    }
}

/// `INT#5` as INT and `5`; a based number (`16#FF`) has no prefix.
fn split_prefix(text: &str) -> Option<(&str, &str)> {
    if !text.starts_with(|c: char| c.is_ascii_alphabetic()) {
        return None;
    }
    text.split_once('#')
}

/// The type that a prefix names: T, D, TOD and the like are short for durations and dates.
pub fn prefix_type(prefix: &str) -> Option<Elem> {
    let short = [("T", Elem::Time), ("LT", Elem::Ltime), ("D", Elem::Date), ("LD", Elem::Ldate)];
    let short = short.iter().find(|(name, _)| prefix.eq_ignore_ascii_case(name)).map(|(_, e)| *e);
    short.or_else(|| Elem::from_name(prefix))
}

fn short_prefix(elem: Elem) -> &'static str {
    match elem {
        Elem::Time => "T#",
        Elem::Ltime => "LTIME#",
        Elem::Date => "D#",
        Elem::Ldate => "LDATE#",
        Elem::Tod => "TOD#",
        Elem::Ltod => "LTOD#",
        Elem::Dt => "DT#",
        Elem::Ldt => "LDT#",
        _ => "",
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Scalar { elem, raw } => write_scalar(f, *elem, *raw),
            Value::String(s) => write_string(f, s),
            Value::WString(s) => write_wstring(f, s),
        }
    }
}

/// Writes a register value as the trace shows it; never allocates.
pub fn write_scalar(out: &mut dyn Write, elem: Elem, raw: u64) -> fmt::Result {
    match elem.family() {
        Family::Bool => out.write_str(if raw == 0 { "FALSE" } else { "TRUE" }),
        Family::Signed => write!(out, "{}", elem.repr().sign_extend(raw)),
        Family::Unsigned => write!(out, "{raw}"),
        Family::Bits => write!(out, "16#{raw:X}"),
        Family::Real => write_real(out, elem, raw),
        Family::Duration => write_duration(out, elem, raw as i64),
        Family::Date => {
            out.write_str(short_prefix(elem))?;
            write_date(out, raw as i64)
        }
        Family::TimeOfDay => {
            out.write_str(short_prefix(elem))?;
            write_time(out, raw as i64)
        }
        Family::DateTime => {
            out.write_str(short_prefix(elem))?;
            write_date(out, raw as i64)?;
            out.write_char('-')?;
            write_time(out, (raw as i64).rem_euclid(NS_PER_DAY))
        }
        Family::Char if elem == Elem::Char => write_string(out, &[raw as u8]),
        Family::Char => write_wstring(out, &[raw as u16]),
    }
}

/// Writes a register value as `A_TO_STRING` gives it (semantics.md \[T6\]): as the trace does, but bit strings as decimal
/// numbers and a character as itself (0: nothing). Never allocates.
pub fn write_text(out: &mut dyn Write, elem: Elem, raw: u64) -> fmt::Result {
    match elem.family() {
        Family::Bits => write!(out, "{raw}"),
        Family::Char if raw == 0 => Ok(()),
        // A unit that is no character of its own (half of a pair) is the caller's business.
        Family::Char => char::from_u32(raw as u32).map_or(Ok(()), |c| out.write_char(c)),
        _ => write_scalar(out, elem, raw),
    }
}

/// The most characters that [`write_text`] writes for a type.
pub fn longest_text(elem: Elem) -> u32 {
    match elem.family() {
        Family::Bool => 5,
        Family::Signed => [4, 6, 11, 20][elem.bytes().trailing_zeros() as usize],
        Family::Unsigned | Family::Bits => [3, 5, 10, 20][elem.bytes().trailing_zeros() as usize],
        Family::Real => 24,
        Family::Duration => 38,
        Family::Date => 16,
        Family::TimeOfDay => 29,
        Family::DateTime => 33,
        Family::Char => 1,
    }
}

/// The shortest text that reads back to the same value, always with a point or an exponent.
fn write_real(out: &mut dyn Write, elem: Elem, raw: u64) -> fmt::Result {
    let single = elem == Elem::Real;
    let x = if single { f64::from(f32::from_bits(raw as u32)) } else { f64::from_bits(raw) };
    if x.is_nan() {
        out.write_str("nan")
    } else if single {
        write!(out, "{:?}", f32::from_bits(raw as u32))
    } else {
        write!(out, "{x:?}")
    }
}

fn write_duration(out: &mut dyn Write, elem: Elem, ns: i64) -> fmt::Result {
    out.write_str(short_prefix(elem))?;
    if ns == 0 {
        return out.write_str("0s");
    }
    if ns < 0 {
        out.write_char('-')?;
    }
    let mut rest = ns.unsigned_abs();
    let units = [
        ("d", 86_400_000_000_000),
        ("h", 3_600_000_000_000),
        ("m", 60_000_000_000),
        ("s", 1_000_000_000),
        ("ms", 1_000_000),
        ("us", 1_000),
        ("ns", 1),
    ];
    for (name, unit) in units {
        let n = rest / unit;
        rest %= unit;
        if n != 0 {
            write!(out, "{n}{name}")?;
        }
    }
    Ok(())
}

fn write_date(out: &mut dyn Write, ns: i64) -> fmt::Result {
    let (year, month, day) = literal::civil_from_days(ns.div_euclid(NS_PER_DAY));
    write!(out, "{year:04}-{month:02}-{day:02}")
}

/// A sum may leave the day: then hours go past 23, and a minus stands before what is before midnight.
fn write_time(out: &mut dyn Write, ns: i64) -> fmt::Result {
    if ns < 0 {
        out.write_char('-')?;
    }
    let ns = ns.unsigned_abs();
    let (seconds, mut fraction) = (ns / 1_000_000_000, ns % 1_000_000_000);
    write!(out, "{:02}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)?;
    if fraction != 0 {
        let mut digits = 9;
        while fraction % 10 == 0 {
            fraction /= 10;
            digits -= 1;
        }
        write!(out, ".{fraction:0digits$}")?;
    }
    Ok(())
}

/// A STRING as a literal in single quotes.
pub fn write_string(out: &mut dyn Write, characters: &[u8]) -> fmt::Result {
    out.write_char('\'')?;
    for c in characters {
        let c = char::from(*c);
        match c {
            '$' | '\'' => write!(out, "${c}")?,
            _ if c.is_control() => write_control(out, u32::from(c), 2)?,
            _ => out.write_char(c)?,
        }
    }
    out.write_char('\'')
}

/// A WSTRING as a literal in double quotes. A surrogate without its partner is written as `$hhhh`.
pub fn write_wstring(out: &mut dyn Write, units: &[u16]) -> fmt::Result {
    out.write_char('"')?;
    for decoded in char::decode_utf16(units.iter().copied()) {
        match decoded {
            Ok(c @ ('$' | '"')) => write!(out, "${c}")?,
            Ok(c) if c.is_control() => write_control(out, u32::from(c), 4)?,
            Ok(c) => out.write_char(c)?,
            Err(lone) => write!(out, "${:04X}", lone.unpaired_surrogate())?,
        }
    }
    out.write_char('"')
}

fn write_control(out: &mut dyn Write, code: u32, digits: usize) -> fmt::Result {
    match code {
        0x0A => out.write_str("$L"),
        0x0C => out.write_str("$P"),
        0x0D => out.write_str("$R"),
        0x09 => out.write_str("$T"),
        _ => write!(out, "${code:0digits$X}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Elem::*;

    fn show(elem: Elem, raw: u64) -> String {
        Value::Scalar { elem, raw }.to_string()
    }
    fn read(elem: Elem, text: &str) -> Result<u64, ValueError> {
        match Kind::Elem(elem).parse(text)? {
            Value::Scalar { raw, .. } => Ok(raw),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn as_the_trace_table_says() {
        assert_eq!((show(Bool, 0), show(Bool, 1)), ("FALSE".into(), "TRUE".into()));
        assert_eq!(show(Sint, 0xFF), "-1");
        assert_eq!(show(Ulint, u64::MAX), "18446744073709551615");
        assert_eq!((show(Word, 0), show(Byte, 255)), ("16#0".into(), "16#FF".into()));
        for (x, text) in [(1.0, "1.0"), (0.1, "0.1"), (1e20, "1e20"), (-0.0, "-0.0"), (123456.5, "123456.5")] {
            assert_eq!(show(Lreal, f64::to_bits(x)), text);
            assert_eq!(show(Real, u64::from((x as f32).to_bits())), text);
        }
        assert_eq!(show(Lreal, f64::INFINITY.to_bits()), "inf");
        assert_eq!(show(Real, u64::from(f32::NEG_INFINITY.to_bits())), "-inf");
        assert_eq!(show(Lreal, (-f64::NAN).to_bits()), "nan");
        let ns = |n: i64| n as u64;
        assert_eq!(show(Time, 93_784_005_006_007), "T#1d2h3m4s5ms6us7ns");
        assert_eq!(show(Time, 0), "T#0s");
        assert_eq!(show(Time, ns(-1_500_000_000)), "T#-1s500ms");
        assert_eq!(show(Ltime, 10_000_000), "LTIME#10ms");
        assert_eq!(show(Time, ns(i64::MIN)), "T#-106751d23h47m16s854ms775us808ns");
        assert_eq!(show(Date, ns(19753 * NS_PER_DAY)), "D#2024-01-31");
        assert_eq!(show(Tod, 47_100_000_000_000), "TOD#13:05:00");
        assert_eq!(show(Ltod, 47_100_250_000_000), "LTOD#13:05:00.25");
        assert_eq!(show(Tod, 1), "TOD#00:00:00.000000001");
        assert_eq!(show(Dt, ns(19753 * NS_PER_DAY + 47_100_000_000_000)), "DT#2024-01-31-13:05:00");
        assert_eq!(show(Ldt, ns(-1_000_000_000)), "LDT#1969-12-31-23:59:59");
        assert_eq!(show(Ldate, 0), "LDATE#1970-01-01");
    }

    #[test]
    fn strings_are_literals() {
        assert_eq!(Value::String(b"a$'\"\n\r\x0C\t\x01\xE4\x85".to_vec()).to_string(), "'a$$$'\"$L$R$P$T$01ä$85'");
        let w: Vec<u16> = "a$'\"\n€😀".encode_utf16().chain([1, 0xD83D]).collect();
        assert_eq!(Value::WString(w.clone()).to_string(), "\"a$$'$\"$L€😀$0001$D83D\"");
        assert_eq!(Kind::WString.parse(&Value::WString(w.clone()).to_string()).unwrap(), Value::WString(w));
        let all: Vec<u8> = (1..=255).collect();
        assert_eq!(Kind::String.parse(&Value::String(all.clone()).to_string()).unwrap(), Value::String(all));
        assert_eq!(Kind::String.parse("string#'x'").unwrap(), Value::String(b"x".to_vec()));
        assert!(Kind::String.parse("x").is_err());
    }

    #[test]
    fn text_reads_back() {
        let mut seed = 0x9E37_79B9_7F4A_7C15u64;
        for elem in crate::elem::ALL {
            for n in 0..500u64 {
                seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                let mut raw = match n {
                    0 => 0,
                    1 => 1,
                    2 => elem.repr().mask(),
                    3 => 1 << (elem.repr().bits() - 1),
                    4 => elem.repr().mask() >> 1,
                    _ => (seed >> (n % 60)) & elem.repr().mask(),
                };
                match elem.family() {
                    Family::Bool => raw &= 1,
                    Family::Char if raw == 0 || (0xD800..0xE000).contains(&raw) => continue,
                    Family::Date => raw = (raw as i64 / NS_PER_DAY * NS_PER_DAY) as u64,
                    Family::TimeOfDay => raw %= NS_PER_DAY as u64,
                    _ => {}
                }
                let text = show(elem, raw);
                let is_nan = text == "nan";
                let back = read(elem, &text).unwrap_or_else(|e| panic!("{text}: {e}"));
                assert!(back == raw || is_nan, "{text} {raw:#x} {back:#x}");
            }
        }
    }

    #[test]
    fn no_text_is_longer_than_its_limit() {
        let mut seed = 0x2545_F491_4F6C_DD1Du64;
        for elem in crate::elem::ALL {
            let mut longest = 0;
            let mut raws = vec![0, 1, elem.repr().mask(), 1 << (elem.repr().bits() - 1), elem.repr().mask() >> 1];
            let long = [f64::MIN_POSITIVE, f64::MAX, 9_999_999_999_999_998.0, 0.000_012_345_678_901_234_567];
            for x in long.into_iter().filter(|_| elem.is_real()) {
                raws.push(if elem == Real { u64::from((-x as f32).to_bits()) } else { (-x).to_bits() });
            }
            for n in 0..2000u32 {
                seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                raws.push((seed >> (n % 60)) & elem.repr().mask());
            }
            for raw in raws {
                let raw = if elem == Bool { raw & 1 } else { raw };
                let mut text = String::new();
                write_text(&mut text, elem, raw).unwrap();
                longest = longest.max(text.chars().count() as u32);
            }
            assert!(longest <= longest_text(elem), "{elem:?}: {longest}");
        }
    }

    #[test]
    fn prefixes() {
        assert_eq!(read(Dint, "INT#-5").unwrap(), 0xFFFF_FFFB);
        assert_eq!(read(Int, "int#16#7F").unwrap(), 127);
        assert_eq!(read(Real, "LREAL#1.5"), read(Real, "1.5"));
        assert_eq!(read(Time, "TIME#1s").unwrap(), 1_000_000_000);
        assert_eq!(read(Dt, "date_and_time#1970-01-01-00:00:01").unwrap(), 1_000_000_000);
        assert_eq!(read(Bool, "BOOL#1").unwrap(), 1);
        assert_eq!(read(Time, "5s"), Err(ValueError::MissingPrefix { expected: "T#" }));
        for (elem, bad) in [
            (Time, "INT#5"),
            (Int, "T#5s"),
            (Bool, "INT#1"),
            (Sint, "INT#200"),
            (Int, "REAL#1.5"),
            (Int, "Color#Red"),
            (Date, "TOD#00:00:00"),
            (Int, ""),
        ] {
            assert!(read(elem, bad).is_err(), "{bad}");
        }
    }
}
