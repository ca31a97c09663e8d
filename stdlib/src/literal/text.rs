//! Character strings: quotes and `$` escapes.

use super::LiteralError;

/// What `$00` in a string means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Nul {
    /// An error.
    Error,
    /// The end of the string (profile codesys); what follows is still checked.
    Ends,
}

/// The characters of `'text'` (with its quotes), Latin-1.
pub fn string(text: &str, nul: Nul) -> Result<Vec<u8>, LiteralError> {
    let units = units(text, '\'', 2, nul, |at, c, out: &mut Vec<u32>| {
        if u32::from(c) > 0xFF {
            return Err(LiteralError::NotLatin1 { found: c, at });
        }
        out.push(u32::from(c));
        Ok(())
    })?;
    Ok(units.into_iter().map(|u| u as u8).collect())
}

/// The characters of `"text"` (with its quotes), UTF-16 units.
pub fn wstring(text: &str, nul: Nul) -> Result<Vec<u16>, LiteralError> {
    let units = units(text, '"', 4, nul, |_, c, out: &mut Vec<u32>| {
        out.extend(c.encode_utf16(&mut [0; 2]).iter().map(|u| u32::from(*u)));
        Ok(())
    })?;
    Ok(units.into_iter().map(|u| u as u16).collect())
}

fn units(
    text: &str,
    quote: char,
    hex_digits: usize,
    nul: Nul,
    push: impl Fn(usize, char, &mut Vec<u32>) -> Result<(), LiteralError>,
) -> Result<Vec<u32>, LiteralError> {
    let quoted = text.strip_prefix(quote).and_then(|t| t.strip_suffix(quote));
    let expected = if quote == '"' { "a text in double quotes" } else { "a text in single quotes" };
    let inner = quoted.ok_or(LiteralError::Malformed { at: 0, expected })?;
    let mut out = Vec::with_capacity(inner.len());
    let mut end = None;
    let mut at = 0;
    while let Some(c) = inner[at..].chars().next() {
        let shown = at + 1;
        if c == quote {
            return Err(LiteralError::Malformed { at: shown, expected: "`$` before a quote inside a text" });
        }
        if c != '$' {
            push(shown, c, &mut out)?;
            at += c.len_utf8();
            continue;
        }
        let bad = LiteralError::BadEscape { at: shown };
        let code = inner.get(at + 1..at + 1 + hex_digits);
        if let Some(hex) = code.filter(|h| h.bytes().all(|b| b.is_ascii_hexdigit())) {
            let unit = u32::from_str_radix(hex, 16).map_err(|_| bad)?;
            if unit == 0 {
                if nul == Nul::Error {
                    return Err(LiteralError::NulCharacter { at: shown });
                }
                end.get_or_insert(out.len());
            }
            out.push(unit);
            at += 1 + hex_digits;
            continue;
        }
        out.push(match inner[at + 1..].chars().next().ok_or_else(|| bad.clone())?.to_ascii_uppercase() {
            c @ ('$' | '\'' | '"') => u32::from(c),
            'L' | 'N' => 0x0A,
            'P' => 0x0C,
            'R' => 0x0D,
            'T' => 0x09,
            _ => return Err(bad),
        });
        at += 2;
    }
    out.truncate(end.unwrap_or(out.len()));
    Ok(out)
}
