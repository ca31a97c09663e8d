//! Values as text, exactly as a trace shows them (docs/cli.md, "Trace CSV"). Reading is in [`literal`](crate::literal).

use crate::elem::{Elem, Family};
use crate::literal::civil_from_days;
use std::fmt::Write;

const DAY_NS: i64 = 86_400_000_000_000;

/// A scalar as the trace shows it: `TRUE`, `-3`, `16#FF`, `0.1`, `T#1s500ms`, `D#2024-01-31`.
pub fn format_scalar(elem: Elem, raw: u64) -> String {
    let ns = raw as i64;
    match elem.family() {
        Family::Bool => if raw != 0 { "TRUE" } else { "FALSE" }.to_string(),
        Family::Signed | Family::Unsigned => elem.to_i128(raw).to_string(),
        Family::Bits => format!("16#{raw:X}"),
        Family::Real if elem == Elem::Real => real(f64::from(f32::from_bits(raw as u32)), format!("{:?}", f32::from_bits(raw as u32))),
        Family::Real => real(f64::from_bits(raw), format!("{:?}", f64::from_bits(raw))),
        Family::Duration => {
            let prefix = if elem == Elem::Ltime { "LTIME#" } else { "T#" };
            format!("{prefix}{}", duration(ns))
        }
        Family::Date => {
            let prefix = if elem == Elem::Ldate { "LDATE" } else { "D" };
            format!("{prefix}#{}", date(ns.div_euclid(DAY_NS)))
        }
        Family::TimeOfDay => format!("{}#{}", elem.name(), time_of_day(ns)),
        Family::DateTime => {
            format!("{}#{}-{}", elem.name(), date(ns.div_euclid(DAY_NS)), time_of_day(ns.rem_euclid(DAY_NS)))
        }
        Family::Char if elem == Elem::Char => format_string(&[raw as u8]),
        Family::Char => format_wstring(&[raw as u16]),
    }
}

/// The shortest text that reads back to the same value; Rust's debug form is that, but for the name of NaN.
fn real(value: f64, text: String) -> String {
    if value.is_nan() { "nan".to_string() } else { text }
}

/// `1d2h3m4s5ms6us7ns` with zero units left out, `0s` for zero.
fn duration(ns: i64) -> String {
    let mut out = String::new();
    if ns < 0 {
        out.push('-');
    }
    let mut rest = ns.unsigned_abs();
    if rest == 0 {
        return "0s".to_string();
    }
    for (unit, size) in [
        ("d", 86_400_000_000_000),
        ("h", 3_600_000_000_000),
        ("m", 60_000_000_000),
        ("s", 1_000_000_000),
        ("ms", 1_000_000),
        ("us", 1_000),
        ("ns", 1),
    ] {
        if rest >= size {
            let _ = write!(out, "{}{unit}", rest / size);
            rest %= size;
        }
    }
    out
}

fn date(days: i64) -> String {
    let (year, month, day) = civil_from_days(days);
    format!("{year:04}-{month:02}-{day:02}")
}

/// `13:05:00`, with a fraction only if it is not zero.
fn time_of_day(ns: i64) -> String {
    let (sign, ns) = if ns < 0 { ("-", ns.unsigned_abs()) } else { ("", ns as u64) };
    let (seconds, fraction) = (ns / 1_000_000_000, ns % 1_000_000_000);
    let mut out = format!("{sign}{:02}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60);
    if fraction != 0 {
        let digits = format!("{fraction:09}");
        let _ = write!(out, ".{}", digits.trim_end_matches('0'));
    }
    out
}

/// A STRING's characters as an IEC literal in single quotes.
pub fn format_string(text: &[u8]) -> String {
    let mut out = String::from("'");
    for byte in text {
        escape(&mut out, u32::from(*byte), '\'');
    }
    out.push('\'');
    out
}

/// A WSTRING's units as an IEC literal in double quotes.
pub fn format_wstring(text: &[u16]) -> String {
    let mut out = String::from("\"");
    for c in char::decode_utf16(text.iter().copied()) {
        match c {
            Ok(c) => escape(&mut out, u32::from(c), '"'),
            Err(lone) => {
                let _ = write!(out, "${:04X}", lone.unpaired_surrogate());
            }
        }
    }
    out.push('"');
    out
}

fn escape(out: &mut String, code: u32, quote: char) {
    match char::from_u32(code) {
        Some('$') => out.push_str("$$"),
        Some(c) if c == quote => {
            out.push('$');
            out.push(c);
        }
        Some('\n') => out.push_str("$L"),
        Some('\r') => out.push_str("$R"),
        Some('\x0C') => out.push_str("$P"),
        Some('\t') => out.push_str("$T"),
        Some(c) if c.is_control() => {
            // The literal of a WSTRING reads four digits.
            let _ = if quote == '"' { write!(out, "${code:04X}") } else { write!(out, "${code:02X}") };
        }
        Some(c) => out.push(c),
        None => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Elem::*;

    #[test]
    fn texts_of_the_trace() {
        let f32 = |v: f32| format_scalar(Real, u64::from(v.to_bits()));
        let f64 = |v: f64| format_scalar(Lreal, v.to_bits());
        assert_eq!([f64(1.0), f64(0.1), f64(1e20), f64(-0.0)], ["1.0", "0.1", "1e20", "-0.0"]);
        assert_eq!([f32(0.1), f32(f32::INFINITY), f64(f64::NEG_INFINITY), f32(f32::NAN)], ["0.1", "inf", "-inf", "nan"]);
        assert_eq!(format_scalar(Sint, 0xFF), "-1");
        assert_eq!(format_scalar(Word, 0xFF), "16#FF");
        assert_eq!(format_scalar(Time, 0), "T#0s");
        assert_eq!(format_scalar(Time, -1_500_000_000i64 as u64), "T#-1s500ms");
        assert_eq!(format_scalar(Ltime, 93_784_005_006_007), "LTIME#1d2h3m4s5ms6us7ns");
        assert_eq!(format_scalar(Date, 1_706_659_200_000_000_000), "D#2024-01-31");
        assert_eq!(format_scalar(Tod, 47_100_250_000_000), "TOD#13:05:00.25");
        assert_eq!(format_scalar(Dt, 1_706_706_300_000_000_000), "DT#2024-01-31-13:05:00");
        assert_eq!(format_string(b"it's $5\n\x01"), "'it$'s $$5$L$01'");
    }
}
