//! Constant texts that are short enough to stand in the code, as numbers.

use plcc_stdlib::prim::Repr;

/// So many bytes at most, the closing 0 with them.
pub const SHORT_BYTES: u32 = 16;

/// Bytes cut into words, great ones first: offset, representation and register value.
pub fn words(bytes: &[u8]) -> Vec<(u32, Repr, u64)> {
    let mut words = Vec::new();
    let mut at = 0;
    for repr in [Repr::I64, Repr::I32, Repr::I16, Repr::I8] {
        while let Some(word) = bytes[at..].get(..repr.bytes() as usize) {
            let raw = word.iter().rev().fold(0, |raw, byte| raw << 8 | u64::from(*byte));
            words.push((at as u32, repr, raw));
            at += word.len();
        }
    }
    words
}
