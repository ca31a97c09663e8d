//! Durations, dates, times of day: exact nanoseconds, the proleptic Gregorian calendar.

use super::LiteralError;
use super::number::{digits, sign};
use crate::convert::NS_PER_DAY;
use crate::elem::Elem;

/// Units from the largest to the smallest: name, nanoseconds, how many make the next larger one.
const UNITS: [(&str, i64, u32); 7] = [
    ("d", 86_400_000_000_000, u32::MAX),
    ("h", 3_600_000_000_000, 24),
    ("m", 60_000_000_000, 60),
    ("s", 1_000_000_000, 60),
    ("ms", 1_000_000, 1000),
    ("us", 1_000, 1000),
    ("ns", 1, 1000),
];

/// Nanoseconds of `1d2h_3m`, `-1.5s`. A fraction below one nanosecond is rounded to the nearest, ties to even.
pub fn duration(text: &str) -> Result<i64, LiteralError> {
    let (negative, start) = sign(text);
    let bytes = text.as_bytes();
    let too_large = LiteralError::TooLarge { elem: Elem::Time };
    let mut at = start;
    let mut total: i128 = 0;
    let mut next_unit = 0;
    let mut first = true;
    let mut fraction_at = None;
    if at == bytes.len() {
        return Err(LiteralError::Malformed { at, expected: "a duration as in 1m30s" });
    }
    while at < bytes.len() {
        if !first && bytes[at] == b'_' {
            at += 1;
        }
        let number_at = at;
        if !bytes.get(at).is_some_and(u8::is_ascii_digit) {
            return Err(LiteralError::Malformed { at, expected: "a duration as in 1m30s" });
        }
        let whole_end = digits(bytes, at)?;
        let mut number_end_at = whole_end;
        let mut fraction = "";
        if bytes.get(whole_end) == Some(&b'.') {
            number_end_at = digits(bytes, whole_end + 1)?;
            fraction = &text[whole_end + 1..number_end_at];
        }
        at = number_end_at;
        let unit_at = at;
        let rest = &text[at..];
        let unit = &rest[..rest.find(|c: char| !c.is_alphabetic()).unwrap_or(rest.len())];
        at += unit.len();
        let unknown = || LiteralError::UnknownUnit { unit: unit.to_string(), at: unit_at };
        let index = UNITS.iter().position(|(name, ..)| unit.eq_ignore_ascii_case(name)).ok_or_else(unknown)?;
        if index < next_unit {
            return Err(LiteralError::UnitOrder { at: unit_at });
        }
        next_unit = index + 1;
        if let Some(at) = fraction_at {
            return Err(LiteralError::FractionNotLast { at });
        }
        if !fraction.is_empty() {
            fraction_at = Some(number_at);
        }
        let (_, unit_ns, limit) = UNITS[index];
        let whole = plain_number(&text[number_at..whole_end]).ok_or_else(|| too_large.clone())?;
        if !first && whole >= i128::from(limit) {
            return Err(LiteralError::UnitOverflow { at: number_at, limit });
        }
        first = false;
        total = with_fraction(total + whole * i128::from(unit_ns), fraction, unit_ns);
    }
    i64::try_from(if negative { -total } else { total }).map_err(|_| too_large)
}

/// The value of digits with underscores, if it is below 10^24.
fn plain_number(text: &str) -> Option<i128> {
    let mut value: i128 = 0;
    for c in text.bytes().filter(u8::is_ascii_digit) {
        value = value * 10 + i128::from(c - b'0');
        if value >= 10i128.pow(24) {
            return None;
        }
    }
    Some(value)
}

/// `ns` and `0.fraction` of a unit, to the nearest nanosecond, ties to even.
fn with_fraction(ns: i128, fraction: &str, unit_ns: i64) -> i128 {
    const PLACES: u32 = 22;
    let mut value: i128 = 0;
    let mut places = 0;
    let mut beyond = false;
    for c in fraction.bytes().filter(u8::is_ascii_digit) {
        if places < PLACES {
            value = value * 10 + i128::from(c - b'0');
            places += 1;
        } else {
            beyond |= c != b'0';
        }
    }
    let scale = 10i128.pow(places);
    let product = value * i128::from(unit_ns);
    let (q, r) = (ns + product / scale, product % scale);
    let up = 2 * r > scale || (2 * r == scale && (beyond || q % 2 == 1));
    q + i128::from(up)
}

const DATE: &str = "a date as in 2024-01-31";
const TIME: &str = "a time as in 13:05:00";

/// Nanoseconds from 1970-01-01 to the midnight that starts `2024-01-31`.
pub fn date(text: &str) -> Result<i64, LiteralError> {
    let mut fields = Fields { text, at: 0 };
    let ns = fields.date()?;
    fields.end(DATE)?;
    instant(ns, Elem::Date)
}

/// Nanoseconds since midnight of `13:05:00.25`; seconds may be left out.
pub fn time_of_day(text: &str) -> Result<i64, LiteralError> {
    let mut fields = Fields { text, at: 0 };
    let ns = fields.time()?;
    fields.end(TIME)?;
    instant(ns, Elem::Tod)
}

/// Nanoseconds from 1970-01-01 to `2024-01-31-13:05:00`.
pub fn date_and_time(text: &str) -> Result<i64, LiteralError> {
    let mut fields = Fields { text, at: 0 };
    let mut ns = fields.date()?;
    fields.expect(b'-', "a date and time as in 2024-01-31-13:05:00")?;
    ns += fields.time()?;
    fields.end(TIME)?;
    instant(ns, Elem::Dt)
}

fn instant(ns: i128, elem: Elem) -> Result<i64, LiteralError> {
    i64::try_from(ns).map_err(|_| LiteralError::TooLarge { elem })
}

/// Reads numbers with separators.
struct Fields<'a> {
    text: &'a str,
    at: usize,
}

impl Fields<'_> {
    fn number(&mut self, expected: &'static str) -> Result<(usize, u32), LiteralError> {
        let start = self.at;
        if !self.text.as_bytes().get(start).is_some_and(u8::is_ascii_digit) {
            return Err(LiteralError::Malformed { at: start, expected });
        }
        self.at = digits(self.text.as_bytes(), start)?;
        let value = plain_number(&self.text[start..self.at]).and_then(|v| u32::try_from(v).ok()).unwrap_or(u32::MAX);
        Ok((start, value))
    }

    fn field(&mut self, field: &'static str, min: u32, max: u32, expected: &'static str) -> Result<u32, LiteralError> {
        let (at, value) = self.number(expected)?;
        if value < min || value > max {
            return Err(LiteralError::BadField { field, at, range: (min, max) });
        }
        Ok(value)
    }

    fn expect(&mut self, separator: u8, expected: &'static str) -> Result<(), LiteralError> {
        if self.text.as_bytes().get(self.at) != Some(&separator) {
            return Err(LiteralError::Malformed { at: self.at, expected });
        }
        self.at += 1;
        Ok(())
    }

    fn end(&self, expected: &'static str) -> Result<(), LiteralError> {
        if self.at < self.text.len() { Err(LiteralError::Malformed { at: self.at, expected }) } else { Ok(()) }
    }

    fn date(&mut self) -> Result<i128, LiteralError> {
        let year = self.field("year", 1, 9999, DATE)?;
        self.expect(b'-', DATE)?;
        let month = self.field("month", 1, 12, DATE)?;
        self.expect(b'-', DATE)?;
        let day = self.field("day", 1, days_in_month(year, month), DATE)?;
        Ok(i128::from(days_from_civil(i64::from(year), month, day)) * i128::from(NS_PER_DAY))
    }

    fn time(&mut self) -> Result<i128, LiteralError> {
        let hour = self.field("hour", 0, 23, TIME)?;
        self.expect(b':', TIME)?;
        let minute = self.field("minute", 0, 59, TIME)?;
        let mut ns = (i128::from(hour) * 60 + i128::from(minute)) * 60_000_000_000;
        if self.text.as_bytes().get(self.at) == Some(&b':') {
            self.at += 1;
            ns += i128::from(self.field("second", 0, 59, TIME)?) * 1_000_000_000;
            if self.text.as_bytes().get(self.at) == Some(&b'.') {
                let start = self.at + 1;
                self.at = digits(self.text.as_bytes(), start)?;
                ns = with_fraction(ns, &self.text[start..self.at], 1_000_000_000);
            }
        }
        Ok(ns)
    }
}

fn days_in_month(year: u32, month: u32) -> u32 {
    match month {
        2 if year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400)) => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

/// Days since 1970-01-01. Years are counted from March, so that the leap day is the last of its year.
fn days_from_civil(year: i64, month: u32, day: u32) -> i64 {
    let y = if month <= 2 { year - 1 } else { year };
    let era = y.div_euclid(400);
    let year_of_era = y.rem_euclid(400);
    let month_from_march = i64::from((month + 9) % 12);
    let day_of_year = (153 * month_from_march + 2) / 5 + i64::from(day) - 1;
    let day_of_era = year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
    era * 146_097 + day_of_era - 719_468
}

/// Year, month, day of a day number since 1970-01-01: the inverse of what [`date`] counts.
pub fn civil_from_days(days: i64) -> (i64, u32, u32) {
    let z = days + 719_468;
    let era = z.div_euclid(146_097);
    let day_of_era = z.rem_euclid(146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = (day_of_year - (153 * month_from_march + 2) / 5 + 1) as u32;
    let month = ((month_from_march + 2) % 12 + 1) as u32;
    (era * 400 + year_of_era + i64::from(month <= 2), month, day)
}
