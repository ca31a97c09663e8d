//! STRING, eight characters at a time: strings are short, and a call of the system's library takes longer than most of them.

use std::cmp::Ordering;

const LOW: u64 = 0x0101_0101_0101_0101;

/// Marks bytes that are 0 by their highest bit; the lowest mark is right, what is above it may be not.
fn zeros(word: u64) -> u64 {
    word.wrapping_sub(LOW) & !word & (LOW << 7)
}

/// The byte in which the lowest bit is; 8 if there is none.
fn byte(marks: u64) -> usize {
    marks.trailing_zeros() as usize / 8
}

#[inline(always)]
fn word(bytes: &[u8], at: usize) -> Option<u64> {
    bytes.get(at..)?.first_chunk().map(|word| u64::from_le_bytes(*word))
}

/// Where the first of two bytes is, one of which is 0; the length of the slice if none is.
#[inline(always)]
fn walk(bytes: &[u8], wanted: u8) -> usize {
    let pattern = LOW * u64::from(wanted);
    let (words, rest) = bytes.as_chunks::<8>();
    for (n, word) in words.iter().enumerate() {
        let word = u64::from_le_bytes(*word);
        let marks = if wanted == 0 { zeros(word) } else { zeros(word) | zeros(word ^ pattern) };
        if marks != 0 {
            return 8 * n + byte(marks);
        }
    }
    let found = rest.iter().position(|b| *b == 0 || *b == wanted);
    bytes.len() - rest.len() + found.unwrap_or(rest.len())
}

/// How many bytes there are before the first 0.
#[inline(always)]
pub fn before_zero(bytes: &[u8]) -> usize {
    walk(bytes, 0)
}

/// The order of two texts that end at their first 0 or with their slice.
#[inline(always)]
pub fn compare(a: &[u8], b: &[u8]) -> Ordering {
    let mut at = 0;
    while let (Some(x), Some(y)) = (word(a, at), word(b, at)) {
        let (differ, end) = (x ^ y, zeros(x));
        if differ | end != 0 {
            let n = byte(differ);
            // Where both end there is no difference.
            return if n > byte(end) { Ordering::Equal } else { a[at + n].cmp(&b[at + n]) };
        }
        at += 8;
    }
    loop {
        let byte = |text: &[u8]| text.get(at).copied().unwrap_or(0);
        let (x, y) = (byte(a), byte(b));
        if x != y || x == 0 {
            return x.cmp(&y);
        }
        at += 1;
    }
}

/// Where a text that is not empty begins in another; both end at their first 0 or with their slice.
#[inline(always)]
pub fn find(text: &[u8], wanted: &[u8]) -> Option<usize> {
    let (first, rest) = wanted.split_first()?;
    if *first == 0 {
        return None;
    }
    let rest = &rest[..before_zero(rest)];
    let mut start = 0;
    loop {
        let at = start + walk(&text[start..], *first);
        if text.get(at) != Some(first) {
            return None;
        }
        // What is found has no 0 in it, so that the end needs no look.
        if rest.is_empty() || text[at + 1..].starts_with(rest) {
            return Some(at);
        }
        start = at + 1;
    }
}

/// Moves bytes up to the first 0, at most `limit`, to a place in front of them or apart from them; how many these were.
#[inline(always)]
pub fn advance(mem: &mut [u8], from: usize, limit: usize, to: usize) -> usize {
    let mut done = 0;
    while done < limit {
        let Some(word) = word(mem, from + done) else { break };
        let end = zeros(word);
        let count = if end == 0 { 8 } else { byte(end) }.min(limit - done);
        if !piece(mem, to + done, word, count) {
            break;
        }
        done += count;
        if count < 8 {
            return done;
        }
    }
    // At the end of the memory.
    while done < limit && mem[from + done] != 0 {
        mem[to + done] = mem[from + done];
        done += 1;
    }
    done
}

/// Writes the first `count` bytes of a word; FALSE if there is no room.
#[inline(always)]
fn piece(mem: &mut [u8], to: usize, word: u64, count: usize) -> bool {
    #[inline(always)]
    fn set<const N: usize>(target: &mut [u8], at: usize, bytes: [u8; N]) {
        if let Some(target) = target.get_mut(at..).and_then(|t| t.first_chunk_mut()) {
            *target = bytes;
        }
    }
    let Some(target) = mem.get_mut(to..to + count) else { return false };
    // Two halves that overlap, where that is simpler than a loop.
    match count {
        8.. => set(target, 0, word.to_le_bytes()),
        4.. => {
            set(target, 0, (word as u32).to_le_bytes());
            set(target, count - 4, ((word >> (8 * (count - 4))) as u32).to_le_bytes());
        }
        2.. => {
            set(target, 0, (word as u16).to_le_bytes());
            set(target, count - 2, ((word >> (8 * (count - 2))) as u16).to_le_bytes());
        }
        1 => set(target, 0, [word as u8]),
        0 => {}
    }
    true
}
