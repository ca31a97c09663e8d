//! Literals and addresses. Only their form is judged here.

use super::Lexer;
use crate::token::Tok;
use plcc_diag::codes;

/// What may stand before the `#` of a duration.
const DURATIONS: &[&str] = &["T", "TIME", "LT", "LTIME"];
/// What may stand before the `#` of a date or a time of day.
const DATES: &[&str] = &[
    "D",
    "DATE",
    "LD",
    "LDATE",
    "TOD",
    "TIME_OF_DAY",
    "LTOD",
    "LTIME_OF_DAY",
    "DT",
    "DATE_AND_TIME",
    "LDT",
    "LDATE_AND_TIME",
];
/// Units of a duration.
const UNITS: &[&str] = &["d", "h", "m", "s", "ms", "us", "ns"];

/// Whether `word` is the prefix of a duration.
pub(crate) fn is_duration_prefix(word: &str) -> bool {
    DURATIONS.iter().any(|d| d.eq_ignore_ascii_case(word))
}

/// Whether `word` is the prefix of a date or a time of day.
pub(crate) fn is_date_prefix(word: &str) -> bool {
    DATES.iter().any(|d| d.eq_ignore_ascii_case(word))
}

impl Lexer<'_, '_, '_> {
    /// A word with `#` at `hash` behind it: a typed literal, a duration, a date or a qualified enumeration value.
    pub(super) fn prefixed(&mut self, hash: usize) {
        let prefix = &self.text[self.at..hash];
        let next = self.bytes.get(hash + 1).copied().unwrap_or(0);
        let signed = matches!(next, b'+' | b'-') && self.bytes.get(hash + 2).is_some_and(u8::is_ascii_digit);
        let digit = next.is_ascii_digit() || signed;
        if digit && is_duration_prefix(prefix) {
            return self.duration(hash + 1 + usize::from(signed));
        }
        if digit && is_date_prefix(prefix) {
            let end = self.date_end(hash + 1);
            return self.push(Tok::Lit, end - self.at);
        }
        match next {
            _ if digit => {
                let end = self.number_end(hash + 1 + usize::from(signed)).1;
                self.finish_number(Tok::Lit, end);
            }
            b'\'' | b'"' => match self.string_end(hash + 1) {
                Ok(end) => self.push(Tok::Lit, end - self.at),
                Err(end) => self.unclosed_string(hash + 1, end),
            },
            b'a'..=b'z' | b'A'..=b'Z' | b'_' => {
                let end = self.word_end(hash + 1);
                let word = &self.text[hash + 1..end];
                let kind = if word.eq_ignore_ascii_case("TRUE") || word.eq_ignore_ascii_case("FALSE") {
                    Tok::Lit
                } else {
                    Tok::Qualified
                };
                self.push(kind, end - self.at);
            }
            _ => {
                let (start, end) = (self.at as u32, hash as u32 + 1);
                self.report.push(
                    self.report
                        .at(codes::BAD_LITERAL, start, end, format!("a value is missing behind `{prefix}#`"))
                        .help("a typed literal has no blank around `#`: `INT#5`"),
                );
                // What stands behind the blank is the value that was meant.
                let blanks = self.text[hash + 1..].bytes().take_while(|b| *b == b' ').count();
                let value = hash + 1 + blanks;
                let digit = self.bytes.get(value).is_some_and(u8::is_ascii_digit);
                let end = if digit { self.word_end(value) } else { hash + 1 };
                self.push(Tok::Bad, end - self.at);
            }
        }
    }

    /// The value from byte `from` on (behind the sign); the token starts at the prefix.
    fn duration(&mut self, from: usize) {
        let mut end = from;
        let mut unit_start = from;
        let mut wrong = None;
        while end < self.bytes.len() {
            let b = self.bytes[end];
            if b.is_ascii_alphabetic() {
                if end == 0 || !self.bytes[end - 1].is_ascii_alphabetic() {
                    unit_start = end;
                }
                if !self.bytes.get(end + 1).is_some_and(u8::is_ascii_alphabetic) {
                    let unit = &self.text[unit_start..end + 1];
                    if !UNITS.iter().any(|u| u.eq_ignore_ascii_case(unit)) {
                        wrong.get_or_insert((unit_start, end + 1));
                    }
                }
            } else if !(b.is_ascii_digit()
                || b == b'_'
                || (b == b'.' && self.bytes.get(end + 1).is_some_and(u8::is_ascii_digit)))
            {
                break;
            }
            end += 1;
        }
        if let Some(stop) = self.decimal_comma(end) {
            let written = &self.text[self.at..stop];
            let message = self.report.at(
                codes::BAD_LITERAL,
                self.at as u32,
                stop as u32,
                format!("`{written}` has a comma in its value"),
            );
            self.report.push(message.help(format!("write `{}`", written.replacen(',', ".", 1))));
            return self.push(Tok::Bad, stop - self.at);
        }
        let Some((start, stop)) = wrong else { return self.push(Tok::Lit, end - self.at) };
        let unit = &self.text[start..stop];
        let mut message = self.report.at(
            codes::BAD_LITERAL,
            start as u32,
            stop as u32,
            format!("`{unit}` is not a unit of a duration"),
        );
        message = match meant_unit(unit) {
            Some(meant) => {
                let fixed = format!("{}{meant}{}", &self.text[self.at..start], &self.text[stop..end]);
                message.help(format!("write `{meant}`: `{fixed}`"))
            }
            None => message.help("the units are d, h, m, s, ms, us, ns, in this order: `T#1m30s`"),
        };
        self.report.push(message);
        self.push(Tok::Bad, end - self.at);
    }

    /// Where a duration ends whose fraction stands behind a comma at `comma`: `T#2,5s`.
    fn decimal_comma(&self, comma: usize) -> Option<usize> {
        if self.bytes.get(comma) != Some(&b',') || !self.bytes[comma - 1].is_ascii_digit() {
            return None;
        }
        let stop = self.word_end(comma + 1);
        let unit = self.text[comma + 1..stop].trim_start_matches(|c: char| c.is_ascii_digit());
        let digits = stop - comma - 1 - unit.len();
        (digits > 0 && UNITS.iter().any(|u| u.eq_ignore_ascii_case(unit))).then_some(stop)
    }

    fn date_end(&self, from: usize) -> usize {
        let mut end = from;
        while let Some(b) = self.bytes.get(end) {
            let digit_follows = self.bytes.get(end + 1).is_some_and(u8::is_ascii_digit);
            if !(b.is_ascii_digit() || *b == b'_' || (matches!(b, b'-' | b':' | b'.') && digit_follows)) {
                break;
            }
            end += 1;
        }
        end
    }

    pub(super) fn number(&mut self) {
        // `w.3`: digits behind a dot are a bit number, never a real.
        let part = self.out.tokens.last().is_some_and(|t| t.kind == Tok::Dot && t.end as usize == self.at);
        let (kind, end) = if part { (Tok::Int, self.digits_end(self.at)) } else { self.number_end(self.at) };
        self.finish_number(kind, end);
    }

    /// Pushes a number up to `end`, unless letters or digits stick to it.
    fn finish_number(&mut self, kind: Tok, end: usize) {
        let stop = self.word_end(end);
        if stop == end {
            return self.push(kind, end - self.at);
        }
        let text = &self.text[self.at..stop];
        let mut message = self.report.at(
            codes::BAD_LITERAL,
            self.at as u32,
            stop as u32,
            format!("`{text}` is neither a number nor a name"),
        );
        let tail = &self.text[end..stop];
        message = if UNITS.iter().any(|u| u.eq_ignore_ascii_case(tail)) {
            message.help(format!("a duration is written `T#{text}`"))
        } else if text.starts_with('0') && tail.starts_with(['x', 'X']) {
            message.help(format!("a hexadecimal number is written `16#{}`", &tail[1..]))
        } else if text.starts_with('0') && tail.starts_with(['b', 'B']) {
            message.help(format!("a binary number is written `2#{}`", &tail[1..]))
        } else if matches!(tail, "f" | "F" | "L" | "u" | "U" | "l" | "d") {
            message.help(format!(
                "the type of a literal stands before it: `{}`, `DINT#5`, `LREAL#1.5`",
                &text[..end - self.at]
            ))
        } else {
            message.help("names start with a letter or an underline; numbers are `12`, `16#FF`, `1.5`, `1e6`")
        };
        self.report.push(message);
        self.push(Tok::Bad, stop - self.at);
    }

    fn digits_end(&self, from: usize) -> usize {
        let more = self.bytes[from..].iter().take_while(|b| b.is_ascii_digit() || **b == b'_').count();
        from + more
    }

    /// Kind and end of the number whose first digit is at `from`.
    fn number_end(&self, from: usize) -> (Tok, usize) {
        let mut end = self.digits_end(from);
        let at = |i: usize| self.bytes.get(i).copied().unwrap_or(0);
        if at(end) == b'#' {
            let more = self.bytes[end + 1..].iter().take_while(|b| b.is_ascii_alphanumeric() || **b == b'_').count();
            return (Tok::Lit, end + 1 + more);
        }
        let mut kind = Tok::Int;
        if at(end) == b'.' && at(end + 1).is_ascii_digit() {
            kind = Tok::Lit;
            end = self.digits_end(end + 1);
        }
        if matches!(at(end), b'e' | b'E') {
            let sign = usize::from(matches!(at(end + 1), b'+' | b'-'));
            if at(end + 1 + sign).is_ascii_digit() {
                return (Tok::Lit, self.digits_end(end + 1 + sign));
            }
        }
        (kind, end)
    }

    pub(super) fn string(&mut self) {
        match self.string_end(self.at) {
            Ok(end) => self.push(Tok::Lit, end - self.at),
            Err(end) => self.unclosed_string(self.at, end),
        }
    }

    /// End of the string that opens at `open`: behind its closing quote, or where its line ends without one.
    fn string_end(&self, open: usize) -> Result<usize, usize> {
        let quote = self.bytes[open];
        let mut i = open + 1;
        while let Some(b) = self.bytes.get(i) {
            match *b {
                b'\n' | b'\r' => return Err(i),
                // The escaped character may be the quote, but not the end of the line.
                b'$' if !matches!(self.bytes.get(i + 1), None | Some(b'\n' | b'\r')) => i += 1,
                b if b == quote => return Ok(i + 1),
                _ => {}
            }
            i += 1;
        }
        Err(self.bytes.len())
    }

    fn unclosed_string(&mut self, open: usize, end: usize) {
        let quote = self.bytes[open] as char;
        // A code block follows on the line more often than a long text: what stands behind is given up.
        self.report.push(
            self.report
                .at(codes::UNCLOSED_STRING, open as u32, open as u32 + 1, "this string is not closed on its line")
                .help(format!("write `{quote}` where the text ends; `$N` is a new line, `${quote}` the quote itself")),
        );
        self.push(Tok::Bad, end - self.at);
    }

    /// A string between typographic quotes, which word processors and web pages make of `'` and `"`.
    pub(super) fn smart_string(&mut self, open: char) {
        let double = matches!(open, '“' | '”' | '„');
        let line = &self.text[self.at..self.line_end()];
        let ends = |c: char| if double { matches!(c, '“' | '”' | '"') } else { matches!(c, '‘' | '’' | '\'') };
        let body = &line[open.len_utf8()..];
        let length = match body.char_indices().find(|(_, c)| ends(*c)) {
            Some((i, c)) => open.len_utf8() + i + c.len_utf8(),
            None => open.len_utf8(),
        };
        let quote = if double { '"' } else { '\'' };
        self.report.push(
            self.report
                .at(
                    codes::SMART_QUOTES,
                    self.at as u32,
                    (self.at + length) as u32,
                    format!("`{open}` is a typographic quote"),
                )
                .help(format!("strings stand in straight quotes: `{quote}`")),
        );
        self.push(Tok::Bad, length);
    }

    /// `%IX0.0`, `%QW4`, `%I*`, or the `%X3` of a part access.
    pub(super) fn address(&mut self) {
        let upper = |i: usize| self.bytes.get(i).copied().unwrap_or(0).to_ascii_uppercase();
        let mut end = self.at + 1;
        let located = matches!(upper(end), b'I' | b'Q' | b'M');
        end += usize::from(located);
        let sized = matches!(upper(end), b'X' | b'B' | b'W' | b'D' | b'L');
        end += usize::from(sized);
        if located && upper(end) == b'*' {
            return self.push(Tok::Address, end + 1 - self.at);
        }
        let digits = self.digits_end(end);
        if digits > end && located {
            end = digits;
            while self.bytes.get(end) == Some(&b'.') && self.bytes.get(end + 1).is_some_and(u8::is_ascii_digit) {
                end = self.digits_end(end + 1);
            }
            return self.push(Tok::Address, end - self.at);
        }
        if digits > end && sized {
            return self.push(Tok::Part, digits - self.at);
        }
        let stop = self.word_end(end).max(self.at + 1);
        self.report.push(
            self.report
                .at(
                    codes::BAD_LITERAL,
                    self.at as u32,
                    stop as u32,
                    format!("`{}` is not an address", &self.text[self.at..stop]),
                )
                .help("addresses are `%IX0.0`, `%QW4`, `%MD8`, `%I*`; the remainder of a division is MOD"),
        );
        self.push(Tok::Bad, stop - self.at);
    }
}

/// The unit that somebody means who writes `min` or `sec`.
fn meant_unit(unit: &str) -> Option<&'static str> {
    let lower = unit.to_ascii_lowercase();
    Some(match lower.as_str() {
        "day" | "days" => "d",
        "hr" | "hrs" | "hour" | "hours" => "h",
        "min" | "mins" | "minute" | "minutes" => "m",
        "sec" | "secs" | "second" | "seconds" => "s",
        "msec" | "millis" | "milliseconds" => "ms",
        "usec" | "micros" | "microseconds" => "us",
        "nsec" | "nanos" | "nanoseconds" => "ns",
        _ => return None,
    })
}
