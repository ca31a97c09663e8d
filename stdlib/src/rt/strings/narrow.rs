//! STRING, 32 characters at a time: strings are short, and nearly every one is looked at without a loop, whose end a machine
//! could not foresee. A call of the system's library takes longer than most of them.

use std::cmp::Ordering;
use std::ops::Range;

/// So many bytes are looked at in one go.
const STEP: usize = 32;

/// The bytes from there on; `None` near the end of the memory.
#[inline(always)]
fn window(mem: &[u8], at: usize) -> Option<&[u8; STEP]> {
    mem.get(at..at.checked_add(STEP)?)?.first_chunk()
}

/// Marks, bit by bit, of which the lowest one is right; what is above it may be not.
#[cfg(target_arch = "x86_64")]
mod marks {
    use super::STEP;
    use std::arch::x86_64::{_mm_cmpeq_epi8, _mm_loadu_si128, _mm_movemask_epi8, _mm_set1_epi8};

    /// Bytes that are this one.
    #[inline(always)]
    pub fn of(bytes: &[u8; STEP], wanted: u8) -> u32 {
        let (low, high) = (bytes.as_ptr().cast(), bytes[16..].as_ptr().cast());
        // SAFETY: this target always has these instructions, and 16 bytes lie at either address.
        unsafe {
            let pattern = _mm_set1_epi8(wanted as i8);
            let low = _mm_movemask_epi8(_mm_cmpeq_epi8(_mm_loadu_si128(low), pattern)) as u32;
            let high = _mm_movemask_epi8(_mm_cmpeq_epi8(_mm_loadu_si128(high), pattern)) as u32;
            low | high << 16
        }
    }

    /// Bytes in which two differ.
    #[inline(always)]
    pub fn differing(a: &[u8; STEP], b: &[u8; STEP]) -> u32 {
        let at = |bytes: &[u8; STEP]| [bytes.as_ptr().cast(), bytes[16..].as_ptr().cast()];
        let (a, b) = (at(a), at(b));
        // SAFETY: as above.
        unsafe {
            let low = _mm_movemask_epi8(_mm_cmpeq_epi8(_mm_loadu_si128(a[0]), _mm_loadu_si128(b[0]))) as u32;
            let high = _mm_movemask_epi8(_mm_cmpeq_epi8(_mm_loadu_si128(a[1]), _mm_loadu_si128(b[1]))) as u32;
            !(low | high << 16)
        }
    }
}

#[cfg(not(target_arch = "x86_64"))]
mod marks {
    use super::STEP;

    const LOW: u64 = 0x0101_0101_0101_0101;

    pub fn of(bytes: &[u8; STEP], wanted: u8) -> u32 {
        let pattern = LOW * u64::from(wanted);
        lowest(bytes, |n| {
            let word = word(bytes, n) ^ pattern;
            word.wrapping_sub(LOW) & !word & (LOW << 7)
        })
    }

    pub fn differing(a: &[u8; STEP], b: &[u8; STEP]) -> u32 {
        lowest(a, |n| word(a, n) ^ word(b, n))
    }

    fn word(bytes: &[u8; STEP], n: usize) -> u64 {
        bytes.as_chunks::<8>().0.get(n).map_or(0, |word| u64::from_le_bytes(*word))
    }

    /// The byte in which the lowest bit of four words is.
    fn lowest(bytes: &[u8; STEP], marks: impl Fn(usize) -> u64) -> u32 {
        let found = (0..bytes.len() / 8).map(|n| (n, marks(n))).find(|(_, marks)| *marks != 0);
        found.map_or(0, |(n, marks)| 1 << (8 * n as u32 + marks.trailing_zeros() / 8))
    }
}

/// How many bytes there are before the first 0, or all.
#[inline(always)]
pub fn before_zero(mem: &[u8], range: Range<usize>) -> usize {
    if let Some(bytes) = window(mem, range.start) {
        let ends = marks::of(bytes, 0);
        if ends != 0 {
            return (ends.trailing_zeros() as usize).min(range.len());
        }
    }
    before_far_zero(mem, range)
}

#[inline(never)]
fn before_far_zero(mem: &[u8], range: Range<usize>) -> usize {
    let mut at = range.start;
    while at < range.end {
        let Some(bytes) = window(mem, at) else { return at - range.start + slow(&mem[at..range.end], 0) };
        let ends = marks::of(bytes, 0);
        if ends != 0 {
            return (at + ends.trailing_zeros() as usize).min(range.end) - range.start;
        }
        at += STEP;
    }
    range.len()
}

/// Where the first of two bytes is, one of which is 0; the length of the slice if none is.
#[cold]
#[inline(never)]
fn slow(bytes: &[u8], wanted: u8) -> usize {
    bytes.iter().position(|b| *b == 0 || *b == wanted).unwrap_or(bytes.len())
}

/// The order of two texts that end at their first 0 or with their range.
#[inline(always)]
pub fn compare(mem: &[u8], a: Range<usize>, b: Range<usize>) -> Ordering {
    let both = a.len().min(b.len());
    let mut at = 0;
    while at < both {
        let (Some(x), Some(y)) = (window(mem, a.start + at), window(mem, b.start + at)) else {
            return slow_compare(mem, a.start + at..a.end, b.start + at..b.end);
        };
        let stop = marks::differing(x, y) | marks::of(x, 0);
        if stop != 0 {
            at += stop.trailing_zeros() as usize;
            break;
        }
        at += STEP;
    }
    // Behind its range a text has ended.
    let at = at.min(both);
    let byte = |range: &Range<usize>| if at < range.len() { mem[range.start + at] } else { 0 };
    byte(&a).cmp(&byte(&b))
}

#[cold]
#[inline(never)]
fn slow_compare(mem: &[u8], a: Range<usize>, b: Range<usize>) -> Ordering {
    let (a, b) = (&mem[a], &mem[b]);
    a[..slow(a, 0)].cmp(&b[..slow(b, 0)])
}

/// The position, from 1, of a byte that is not 0 within `limit` bytes and before the first 0; 0 if it is not there. `None` if
/// one would have to look further.
#[inline(always)]
pub fn find_near(mem: &[u8], at: usize, limit: usize, unit: u8) -> Option<usize> {
    let bytes = window(mem, at)?;
    let units = marks::of(bytes, unit);
    let stop = units | marks::of(bytes, 0);
    if stop == 0 {
        return None;
    }
    let found = stop.trailing_zeros();
    Some(if (found as usize) < limit && units >> found & 1 != 0 { found as usize + 1 } else { 0 })
}

/// Where a byte that is not 0 is found before the text ends, at its first 0 or with its range; from its start.
#[inline(always)]
pub fn find_unit(mem: &[u8], range: Range<usize>, unit: u8) -> Option<usize> {
    let mut at = range.start;
    while at < range.end {
        let Some(bytes) = window(mem, at) else {
            let rest = &mem[at..range.end];
            let found = slow(rest, unit);
            return (found < rest.len() && rest[found] != 0).then_some(at - range.start + found);
        };
        let stop = marks::of(bytes, unit) | marks::of(bytes, 0);
        if stop != 0 {
            let found = at + stop.trailing_zeros() as usize;
            return (found < range.end && mem[found] == unit).then_some(found - range.start);
        }
        at += STEP;
    }
    None
}

/// Where a text that is not empty begins in another; both end at their first 0 or with their range.
#[inline(always)]
pub fn find(mem: &[u8], text: Range<usize>, wanted: Range<usize>) -> Option<usize> {
    let first = *mem[wanted.clone()].first().filter(|first| **first != 0)?;
    let rest = wanted.start + 1..wanted.start + 1 + before_zero(mem, wanted.start + 1..wanted.end);
    let rest = &mem[rest];
    let mut start = text.start;
    loop {
        let at = start + find_unit(mem, start..text.end, first)?;
        // What is found has no 0 in it, so that the end needs no look.
        if rest.is_empty() || mem[at + 1..text.end].starts_with(rest) {
            return Some(at - text.start);
        }
        start = at + 1;
    }
}

/// Copies what is short, bytes up to the first 0, at most `limit`, and puts a 0 behind them; how many these were. All is read
/// before anything is written: as two parts that overlap, the last one first, so that who then reads from the start finds
/// what one store wrote. `None` if it is longer, or near the end of the memory: then nothing was written.
#[inline(always)]
pub fn copy_short(mem: &mut [u8], from: usize, limit: usize, to: usize) -> Option<usize> {
    #[inline(always)]
    fn store<const N: usize>(mem: &mut [u8], to: usize, end: usize, first: [u8; N], last: [u8; N]) -> Option<()> {
        let target = mem.get_mut(to..)?.get_mut(..end)?;
        *target.last_chunk_mut()? = last;
        *target.first_chunk_mut()? = first;
        Some(())
    }
    let bytes = window(mem, from)?;
    let count = (marks::of(bytes, 0).trailing_zeros() as usize).min(limit);
    // With the 0, which takes the place of the last byte of the last part.
    let end = count + 1;
    let text = bytes.get(..end)?;
    match end {
        17.. => {
            let (first, last) = (*text.first_chunk()?, u128::from_le_bytes(*text.last_chunk()?));
            store(mem, to, end, first, (last & (u128::MAX >> 8)).to_le_bytes())?;
        }
        9.. => {
            let (first, last) = (*text.first_chunk()?, u64::from_le_bytes(*text.last_chunk()?));
            store(mem, to, end, first, (last & (u64::MAX >> 8)).to_le_bytes())?;
        }
        5.. => {
            let (first, last) = (*text.first_chunk()?, u32::from_le_bytes(*text.last_chunk()?));
            store(mem, to, end, first, (last & (u32::MAX >> 8)).to_le_bytes())?;
        }
        3.. => {
            let (first, last) = (*text.first_chunk()?, u16::from_le_bytes(*text.last_chunk()?));
            store(mem, to, end, first, (last & (u16::MAX >> 8)).to_le_bytes())?;
        }
        _ => {
            let first = bytes[0];
            let target = mem.get_mut(to..)?.get_mut(..end)?;
            target[count] = 0;
            if count > 0 {
                target[0] = first;
            }
        }
    }
    Some(count)
}

/// Moves bytes up to the first 0, at most `limit`, to a place in front of them or apart from them, and puts a 0 behind them;
/// how many these were. There must be room for `limit` bytes and the 0.
pub fn advance(mem: &mut [u8], from: usize, limit: usize, to: usize) -> usize {
    let mut done = 0;
    loop {
        let (at, target, left) = (from + done, to + done, limit - done);
        let Some(bytes) = window(mem, at) else { return done + slow_advance(mem, at, left, target) };
        let found = marks::of(bytes, 0).trailing_zeros() as usize;
        if left <= found {
            piece(mem, at, left, target);
            mem[target + left] = 0;
            return done + left;
        }
        if found < STEP {
            piece(mem, at, found + 1, target);
            return done + found;
        }
        piece(mem, at, STEP, target);
        done += STEP;
    }
}

#[cold]
#[inline(never)]
fn slow_advance(mem: &mut [u8], from: usize, limit: usize, to: usize) -> usize {
    let mut done = 0;
    while done < limit && mem[from + done] != 0 {
        mem[to + done] = mem[from + done];
        done += 1;
    }
    mem[to + done] = 0;
    done
}

/// Copies bytes; the two may overlap.
#[inline(always)]
pub fn copy(mem: &mut [u8], from: usize, count: usize, to: usize) {
    if count <= 2 * STEP { piece(mem, from, count, to) } else { mem.copy_within(from..from + count, to) }
}

/// Moves at most `2 * STEP` bytes, all of which are read before any is written: as two parts that overlap, the last one first.
/// Who then reads from the start finds what one store wrote.
#[inline(always)]
fn piece(mem: &mut [u8], from: usize, count: usize, to: usize) {
    #[inline(always)]
    fn twice<const N: usize>(mem: &mut [u8], from: usize, count: usize, to: usize) {
        let source = &mem[from..from + count];
        let (Some(first), Some(last)) = (source.first_chunk::<N>().copied(), source.last_chunk::<N>().copied()) else {
            return;
        };
        let target = &mut mem[to..to + count];
        if let Some(end) = target.last_chunk_mut() {
            *end = last;
        }
        if let Some(start) = target.first_chunk_mut() {
            *start = first;
        }
    }
    match count {
        STEP.. => twice::<STEP>(mem, from, count, to),
        16.. => twice::<16>(mem, from, count, to),
        8.. => twice::<8>(mem, from, count, to),
        4.. => twice::<4>(mem, from, count, to),
        2.. => twice::<2>(mem, from, count, to),
        1 => mem[to] = mem[from],
        0 => {}
    }
}

/// The decimal digits of a number below 10^8, the first one lowest, and how many these are; what is above them is 0.
#[inline(always)]
pub fn digits(number: u32) -> (u64, usize) {
    // Two numbers of four digits, four of two, eight of one, side by side.
    let number = u64::from(number);
    let fours = (number / 10_000) | ((number % 10_000) << 32);
    let high = ((fours * 10_486) >> 20) & 0x0000_007F_0000_007F;
    let twos = high | (fours - 100 * high) << 16;
    let high = ((twos * 103) >> 10) & 0x000F_000F_000F_000F;
    let ones = high | (twos - 10 * high) << 8;
    // Leading zeros go, but for the last digit.
    let leading = (ones | 1 << 56).trailing_zeros() as usize / 8;
    ((ones | 0x3030_3030_3030_3030) >> (8 * leading), 8 - leading)
}

/// Room for a minus, eight digits and a 0.
pub const SHORT_NUMBER: usize = 10;

/// Writes the text of an integer below 10^8 and a 0 behind it; how many characters these are. No other byte is touched.
#[inline(always)]
pub fn short_number(room: &mut [u8; SHORT_NUMBER], negative: bool, number: u32) -> usize {
    let (digits, count) = digits(number);
    let sign = usize::from(negative);
    if negative {
        room[0] = b'-';
    }
    let target = &mut room[sign..];
    // Two parts that overlap, and the 0 with the last one.
    match count {
        8.. => target[..8].copy_from_slice(&digits.to_le_bytes()),
        4.. => {
            let last = (digits >> (8 * (count - 3))) as u32;
            target[count - 3..count + 1].copy_from_slice(&last.to_le_bytes());
            target[..4].copy_from_slice(&(digits as u32).to_le_bytes());
            return sign + count;
        }
        2.. => {
            let last = (digits >> (8 * (count - 1))) as u16;
            target[count - 1..count + 1].copy_from_slice(&last.to_le_bytes());
            target[..2].copy_from_slice(&(digits as u16).to_le_bytes());
            return sign + count;
        }
        _ => target[0] = digits as u8,
    }
    target[count] = 0;
    sign + count
}
