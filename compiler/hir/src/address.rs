//! Addresses of located variables: `%IX0.0 %QW4 %MD8` (semantics.md \[R4\]).

use crate::defs::{Address, Area};

/// Highest byte of an area; far beyond any process image, low enough that nothing overflows.
const MAX_BYTE: u64 = 1 << 24;

/// Reads an address. The number counts units of its own size: `%MW1` is bytes 2 and 3, `%MX1.5` is bit 5 of byte 1.
pub fn parse(text: &str) -> Result<Address, String> {
    let upper = text.to_ascii_uppercase();
    let mut chars = upper.strip_prefix('%').ok_or("an address starts with %")?.chars().peekable();
    let area = match chars.next() {
        Some('I') => Area::Input,
        Some('Q') => Area::Output,
        Some('M') => Area::Memory,
        _ => return Err("the area is I, Q or M".into()),
    };
    let size = match chars.peek().copied() {
        Some(c @ ('X' | 'B' | 'W' | 'D' | 'L')) => {
            chars.next();
            c
        }
        Some('*') => return Err("VAR_CONFIG gives the address, with a size and a number".into()),
        _ => 'X',
    };
    let rest: String = chars.collect();
    let numbers: Option<Vec<u64>> = rest.split('.').map(|n| n.parse().ok()).collect();
    let numbers = numbers.filter(|n| !n.is_empty()).ok_or("a number must follow the size")?;
    let unit = match size {
        'W' => 2,
        'D' => 4,
        'L' => 8,
        _ => 1,
    };
    let (byte, bit) = match (size, numbers.as_slice()) {
        ('X', [byte, bit]) if *bit < 8 => (*byte, Some(*bit as u8)),
        ('X', [_, _]) => return Err("a byte has bits 0 to 7".into()),
        // `%IX7` alone: a plain bit number.
        ('X', [bit]) => (bit / 8, Some((bit % 8) as u8)),
        (_, [number]) => (number.saturating_mul(unit), None),
        _ => return Err("deeper paths belong to I/O drivers".into()),
    };
    if byte > MAX_BYTE {
        return Err(format!("the highest byte of an area is {MAX_BYTE}"));
    }
    Ok(Address { area, byte: byte as u32, bit })
}

/// The area of an address that is left open: `%I*`.
pub fn open(text: &str) -> Option<Area> {
    match text.to_ascii_uppercase().as_str() {
        "%I*" => Some(Area::Input),
        "%Q*" => Some(Area::Output),
        "%M*" => Some(Area::Memory),
        _ => None,
    }
}

/// An address and the bytes that it covers (0 for a bit).
pub fn parse_with_width(text: &str) -> Result<(Address, u32), String> {
    parse(text).map(|a| (a, width(text)))
}

/// Bytes from the address on that a direct use of it covers, from its size letter; 0 for a bit.
pub fn width(text: &str) -> u32 {
    match text.chars().nth(2).map(|c| c.to_ascii_uppercase()) {
        Some('B') => 1,
        Some('W') => 2,
        Some('D') => 4,
        Some('L') => 8,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_count_units_of_their_size() {
        let at = |t| parse(t).map(|a| (a.area, a.byte, a.bit));
        assert_eq!(at("%MW1"), Ok((Area::Memory, 2, None)));
        assert_eq!(at("%MD8"), Ok((Area::Memory, 32, None)));
        assert_eq!(at("%mx1.5"), Ok((Area::Memory, 1, Some(5))));
        assert_eq!(at("%IX0.0"), Ok((Area::Input, 0, Some(0))));
        assert_eq!(at("%QL2"), Ok((Area::Output, 16, None)));
        assert!(at("%IX0.8").is_err());
        assert!(at("%IW2.5.7").is_err());
        assert!(at("%ZW2").is_err());
        assert!(at("%MB99999999999999999999").is_err());
    }
}
