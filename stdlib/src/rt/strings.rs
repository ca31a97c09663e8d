//! Strings in the region (semantics.md \[T8\] \[N2\]): the bodies of the string functions and of the conversions from and to
//! text, for STRING (bytes) and WSTRING (little-endian UTF-16 units).
//!
//! A string is a place in the region and a capacity: its characters end at the first 0, or at the capacity if there is none.
//! Every body is safe code on the bytes of the region, so it stays inside whatever the bytes are. What builds a string cuts
//! it at the capacity of its destination and closes it with a 0; the destination must not overlap what is read, which is the
//! caller's business: the lowering goes through a temporary unless it has proved that. Only what gives a part of one string
//! (LEFT, RIGHT, MID, DELETE, a copy) may also be built over that string itself. Nothing allocates.

use crate::elem::{Elem, Family};
use crate::literal::prefix;
use crate::value;
use std::cmp::Ordering;
use std::fmt;
use std::ops::Range;

mod narrow;

/// Where a string lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Text {
    /// Region offset of its first character.
    pub at: u32,
    /// Characters that it can hold; one more unit for the closing 0 lies behind them.
    pub capacity: u32,
}

impl Text {
    /// In one word: the capacity above the offset. So too a reference to a `STRING` without length (\[S4\]) lies in memory.
    pub fn pack(self) -> u64 {
        u64::from(self.capacity) << 32 | u64::from(self.at)
    }

    /// The inverse of [`Text::pack`].
    pub fn unpack(packed: u64) -> Self {
        Self { at: packed as u32, capacity: (packed >> 32) as u32 }
    }
}

/// A body that works on strings in the region. The native function takes the region's address and size (I32), each string as
/// [`Text::pack`] makes it, then the parameters (I64); every one gives an I64.
#[derive(Debug)]
pub struct TextFn {
    /// The symbol that native code calls.
    pub symbol: &'static str,
    /// How many strings it takes.
    pub texts: usize,
    /// The first string is written; then the result is its length.
    pub builds: bool,
    /// How many other parameters, I64.
    pub params: usize,
    /// Its meaning on a region and register values.
    pub eval: fn(&mut [u8], &[Text], &[u64]) -> u64,
    /// Its address in this process, for the JIT.
    pub address: fn() -> *const u8,
}

impl TextFn {
    /// Bytes of a character of one of its strings.
    pub fn unit_bytes(&self, text: usize) -> u32 {
        let wide = self.symbol.starts_with("plcc_wstring_");
        // The conversion between the two kinds reads the other one.
        let other = text == 1 && [STRING.recode.symbol, WSTRING.recode.symbol].contains(&self.symbol);
        if wide != other { 2 } else { 1 }
    }
}

/// The bodies for one kind of string.
#[derive(Debug)]
pub struct TextFns {
    /// `put(dst, src; n)`: behind the first `n` characters of `dst` (which has them) those of `src`; the new length.
    pub put: TextFn,
    /// LEN.
    pub len: TextFn,
    /// -1, 0 or 1: by character code, then by length.
    pub compare: TextFn,
    /// LEFT(dst, IN; L).
    pub left: TextFn,
    /// RIGHT(dst, IN; L).
    pub right: TextFn,
    /// MID(dst, IN; L, P).
    pub mid: TextFn,
    /// INSERT(dst, IN1, IN2; P).
    pub insert: TextFn,
    /// DELETE(dst, IN; L, P).
    pub delete: TextFn,
    /// REPLACE(dst, IN1, IN2; L, P).
    pub replace: TextFn,
    /// `change(dst, IN2; L, P)`: `dst := REPLACE(dst, IN2, L, P)`.
    pub change: TextFn,
    /// FIND(IN1, IN2).
    pub find: TextFn,
    /// `find_unit(IN; unit, n)`: FIND of one character behind the first `n` of `IN` (which has them), counted from there.
    pub find_unit: TextFn,
    /// `skip(IN; n, l)`: `n` and how many characters there are, at most `l`, behind the first `n` of `IN` (which has them).
    pub skip: TextFn,
    /// `tail(dst, IN; n, l)`: at most `l` of the characters behind the first `n` of `IN` (which has them).
    pub tail: TextFn,
    /// `write(dst; n, raw, elem)`: a value as text behind the first `n` characters of `dst` (which has them); the new length.
    pub write: TextFn,
    /// `whole(dst; n, value)`: the same for a signed integer.
    pub whole: TextFn,
    /// `read(IN; elem)`: the value with which a text begins.
    pub read: TextFn,
    /// `recode(dst, src)`: from the other kind of string.
    pub recode: TextFn,
}

impl TextFns {
    /// The bodies for STRING or WSTRING.
    pub fn of(wide: bool) -> &'static TextFns {
        if wide { &WSTRING } else { &STRING }
    }

    fn all(&self) -> [&TextFn; 18] {
        [
            &self.put,
            &self.len,
            &self.compare,
            &self.left,
            &self.right,
            &self.mid,
            &self.insert,
            &self.delete,
            &self.replace,
            &self.change,
            &self.find,
            &self.find_unit,
            &self.skip,
            &self.tail,
            &self.write,
            &self.whole,
            &self.read,
            &self.recode,
        ]
    }
}

/// The greatest length and position that LEN and FIND can tell: they give INT.
const INT_MAX: usize = i16::MAX as usize;

/// One code unit of a string.
trait Unit {
    const BYTES: usize;
    /// The unit that starts at a byte.
    fn get(bytes: &[u8], n: usize) -> u16;
    fn set(bytes: &mut [u8], n: usize, unit: u16);
    /// Units before the first 0, or all of a range of bytes.
    fn before_zero(mem: &[u8], range: Range<usize>) -> usize;
    /// The order of two texts that end at their first 0 or with their range.
    fn compare(mem: &[u8], a: Range<usize>, b: Range<usize>) -> Ordering;
    /// The first unit at which a text that is not empty begins in another, which end likewise.
    fn find(mem: &[u8], text: Range<usize>, wanted: Range<usize>) -> Option<usize>;
    /// Where a unit that is not 0 stands in a text, which ends likewise.
    fn find_unit(mem: &[u8], text: Range<usize>, unit: u16) -> Option<usize>;
    /// Moves the characters that start at a byte, at most `limit`, to a byte in front of them or apart from them, and puts a 0
    /// behind them; how many these were. There must be room for them.
    fn advance(mem: &mut [u8], from: usize, limit: usize, to: usize) -> usize;
    /// What [`Unit::advance`] does, for what is short; the two may overlap. `None` if it is not, then nothing was written.
    fn copy_short(_mem: &mut [u8], _from: usize, _limit: usize, _to: usize) -> Option<usize> {
        None
    }
    /// The position, from 1, of a unit that is not 0 among the first `limit` and before the first 0; 0 if it is not there.
    /// `None` if one would have to look far.
    fn find_near(_mem: &[u8], _at: usize, _limit: usize, _unit: u16) -> Option<usize> {
        None
    }
    /// Copies characters from a byte to a byte; the two may overlap.
    fn copy(mem: &mut [u8], from: usize, count: usize, to: usize);
    /// Writes the text of an integer below 10^8 at a byte, where there is room for it, and puts a 0 behind it; its length.
    /// `None` near the end of the memory, then nothing was written.
    fn short_number(_mem: &mut [u8], _to: usize, _negative: bool, _number: u32) -> Option<usize> {
        None
    }
}

struct Narrow;
struct Wide;

impl Unit for Narrow {
    const BYTES: usize = 1;
    #[inline(always)]
    fn get(bytes: &[u8], n: usize) -> u16 {
        u16::from(bytes[n])
    }
    #[inline(always)]
    fn set(bytes: &mut [u8], n: usize, unit: u16) {
        bytes[n] = unit as u8;
    }
    #[inline(always)]
    fn before_zero(mem: &[u8], range: Range<usize>) -> usize {
        narrow::before_zero(mem, range)
    }
    #[inline(always)]
    fn compare(mem: &[u8], a: Range<usize>, b: Range<usize>) -> Ordering {
        narrow::compare(mem, a, b)
    }
    #[inline(always)]
    fn find(mem: &[u8], text: Range<usize>, wanted: Range<usize>) -> Option<usize> {
        narrow::find(mem, text, wanted)
    }
    #[inline(always)]
    fn find_unit(mem: &[u8], text: Range<usize>, unit: u16) -> Option<usize> {
        narrow::find_unit(mem, text, u8::try_from(unit).ok()?)
    }
    #[inline(always)]
    fn advance(mem: &mut [u8], from: usize, limit: usize, to: usize) -> usize {
        narrow::advance(mem, from, limit, to)
    }
    #[inline(always)]
    fn copy_short(mem: &mut [u8], from: usize, limit: usize, to: usize) -> Option<usize> {
        narrow::copy_short(mem, from, limit, to)
    }
    #[inline(always)]
    fn find_near(mem: &[u8], at: usize, limit: usize, unit: u16) -> Option<usize> {
        narrow::find_near(mem, at, limit, u8::try_from(unit).ok()?)
    }
    #[inline(always)]
    fn copy(mem: &mut [u8], from: usize, count: usize, to: usize) {
        narrow::copy(mem, from, count, to);
    }
    #[inline(always)]
    fn short_number(mem: &mut [u8], to: usize, negative: bool, number: u32) -> Option<usize> {
        let room = mem.get_mut(to..to.checked_add(narrow::SHORT_NUMBER)?)?.first_chunk_mut()?;
        Some(narrow::short_number(room, negative, number))
    }
}

impl Unit for Wide {
    const BYTES: usize = 2;
    fn get(bytes: &[u8], n: usize) -> u16 {
        u16::from_le_bytes([bytes[2 * n], bytes[2 * n + 1]])
    }
    fn set(bytes: &mut [u8], n: usize, unit: u16) {
        bytes[2 * n..2 * n + 2].copy_from_slice(&unit.to_le_bytes());
    }
    fn before_zero(mem: &[u8], range: Range<usize>) -> usize {
        let bytes = &mem[range];
        bytes.chunks_exact(2).position(|unit| unit == [0, 0]).unwrap_or(bytes.len() / 2)
    }
    fn compare(mem: &[u8], a: Range<usize>, b: Range<usize>) -> Ordering {
        let (m, n) = (Self::before_zero(mem, a.clone()), Self::before_zero(mem, b.clone()));
        (0..m).map(|i| Self::get(&mem[a.start..], i)).cmp((0..n).map(|i| Self::get(&mem[b.start..], i)))
    }
    fn find(mem: &[u8], text: Range<usize>, wanted: Range<usize>) -> Option<usize> {
        let first = |range: Range<usize>| &mem[range.start..range.start + 2 * Self::before_zero(mem, range.clone())];
        let (text, wanted) = (first(text), first(wanted));
        let windows = (!wanted.is_empty()).then(|| text.windows(wanted.len()).step_by(2))?;
        windows.into_iter().position(|window| window == wanted)
    }
    fn find_unit(mem: &[u8], text: Range<usize>, unit: u16) -> Option<usize> {
        let count = Self::before_zero(mem, text.clone());
        (0..count).position(|n| Self::get(&mem[text.start..], n) == unit)
    }
    fn advance(mem: &mut [u8], from: usize, limit: usize, to: usize) -> usize {
        let count = Self::before_zero(mem, from..from + 2 * limit);
        mem.copy_within(from..from + 2 * count, to);
        Self::set(&mut mem[to..], count, 0);
        count
    }
    fn copy(mem: &mut [u8], from: usize, count: usize, to: usize) {
        mem.copy_within(from..from + 2 * count, to);
    }
}

/// The bytes that a string has for characters. One outside the region (no caller has such) counts as empty.
#[inline(always)]
fn extent<U: Unit>(mem: &[u8], text: Text) -> Range<usize> {
    let (start, bytes) = (text.at as usize, text.capacity as usize * U::BYTES);
    if start + bytes <= mem.len() { start..start + bytes } else { 0..0 }
}

/// The bytes of the characters of a string.
#[inline(always)]
fn characters<U: Unit>(mem: &[u8], text: Text) -> Range<usize> {
    let all = extent::<U>(mem, text);
    all.start..all.start + U::before_zero(mem, all.clone()) * U::BYTES
}

/// Units in a range of bytes.
#[inline(always)]
fn count<U: Unit>(range: &Range<usize>) -> usize {
    range.len() / U::BYTES
}

/// A range without its first `n` units, all of which it has.
#[inline(always)]
fn from<U: Unit>(range: &Range<usize>, n: usize) -> Range<usize> {
    range.start + n * U::BYTES..range.end
}

/// The first `n` units of a range that has so many.
#[inline(always)]
fn first<U: Unit>(range: &Range<usize>, n: usize) -> Range<usize> {
    range.start..range.start + n * U::BYTES
}

/// The byte behind the first `n` characters of `dst`, their number, and how many more it can take; `None` if it lies outside.
#[inline(always)]
fn behind<U: Unit>(mem: &[u8], dst: Text, n: usize) -> Option<(usize, usize, usize)> {
    let capacity = dst.capacity as usize;
    if dst.at as usize + (capacity + 1) * U::BYTES > mem.len() {
        return None;
    }
    let n = n.min(capacity);
    Some((dst.at as usize + n * U::BYTES, n, capacity - n))
}

/// Copies characters behind the first `n` of `dst` and closes the string; the new length.
#[inline(always)]
fn put<U: Unit>(mem: &mut [u8], dst: Text, n: usize, src: Range<usize>) -> usize {
    let Some((to, n, room)) = behind::<U>(mem, dst, n) else { return 0 };
    let more = count::<U>(&src).min(room);
    if to != src.start && !src.contains(&to) {
        return n + U::advance(mem, src.start, more, to);
    }
    if to != src.start {
        // Part of it would be written before it is read.
        mem.copy_within(first::<U>(&src, more), to);
    }
    U::set(&mut mem[to..], more, 0);
    n + more
}

/// The same for the first characters of a string, whose end need not be known.
#[inline(always)]
fn put_first<U: Unit>(mem: &mut [u8], dst: Text, n: usize, src: Text, most: usize) -> usize {
    let Some((to, n, room)) = behind::<U>(mem, dst, n) else { return 0 };
    let all = extent::<U>(mem, src);
    if all.contains(&to) {
        let src = characters::<U>(mem, src);
        return put::<U>(mem, dst, n, first::<U>(&src, most.min(count::<U>(&src))));
    }
    n + U::advance(mem, all.start, count::<U>(&all).min(room).min(most), to)
}

/// Copies what is short behind the first `n` of `dst`: at most `most` of the characters behind the first `skip` of `src`. The
/// new length; `None` if it is not short or a number is none, then nothing was written.
#[inline(always)]
fn at_once<U: Unit>(mem: &mut [u8], dst: Text, n: u64, src: Text, skip: u64, most: usize) -> Option<u64> {
    let room = u64::from(dst.capacity).checked_sub(n)?.min(u64::from(src.capacity).checked_sub(skip)?) as usize;
    let (from, to) = (src.at as usize + skip as usize * U::BYTES, dst.at as usize + n as usize * U::BYTES);
    Some(n + U::copy_short(mem, from, most.min(room), to)? as u64)
}

/// A length or position as the language counts: a negative one is 0, one beyond any string is as good as its end.
#[inline(always)]
fn number(raw: u64) -> usize {
    usize::try_from((raw as i64).max(0)).unwrap_or(usize::MAX)
}

#[inline(always)]
fn len<U: Unit>(mem: &mut [u8], [a]: [Text; 1], _: [u64; 0]) -> u64 {
    count::<U>(&characters::<U>(mem, a)).min(INT_MAX) as u64
}

#[inline(always)]
fn compare<U: Unit>(mem: &mut [u8], [a, b]: [Text; 2], _: [u64; 0]) -> u64 {
    U::compare(mem, extent::<U>(mem, a), extent::<U>(mem, b)) as i64 as u64
}

#[inline(always)]
fn append<U: Unit>(mem: &mut [u8], [dst, src]: [Text; 2], [n]: [u64; 1]) -> u64 {
    at_once::<U>(mem, dst, n, src, 0, usize::MAX).unwrap_or_else(|| append_any::<U>(mem, dst, src, n))
}

#[inline(never)]
fn append_any<U: Unit>(mem: &mut [u8], dst: Text, src: Text, n: u64) -> u64 {
    put_first::<U>(mem, dst, number(n), src, usize::MAX) as u64
}

#[inline(always)]
fn left<U: Unit>(mem: &mut [u8], [dst, a]: [Text; 2], [l]: [u64; 1]) -> u64 {
    tail::<U>(mem, [dst, a], [0, l])
}

fn right<U: Unit>(mem: &mut [u8], [dst, a]: [Text; 2], [l]: [u64; 1]) -> u64 {
    let a = characters::<U>(mem, a);
    let skip = count::<U>(&a).saturating_sub(number(l));
    put::<U>(mem, dst, 0, from::<U>(&a, skip)) as u64
}

/// A string without its first `n` characters, which it has.
#[inline(always)]
fn behind_first<U: Unit>(text: Text, n: usize) -> Text {
    Text { at: text.at + (n * U::BYTES) as u32, capacity: text.capacity - n as u32 }
}

/// Where a part of a string lies: from position P on L characters, or what there is of them. `None` if P is outside.
struct Part {
    start: usize,
    end: usize,
    /// The string goes on behind it.
    more: bool,
}

impl Part {
    fn new<U: Unit>(mem: &[u8], text: Text, l: u64, p: u64) -> Option<Self> {
        let all = extent::<U>(mem, text);
        let room = count::<U>(&all);
        let start = number(p).checked_sub(1).filter(|start| *start < room)?;
        let end = start.saturating_add(number(l)).min(room);
        // Not further than is needed to know that.
        let looked_at = end.max(start + 1);
        let head = U::before_zero(mem, first::<U>(&all, looked_at));
        (start < head).then_some(Self { start, end: end.min(head), more: head == looked_at })
    }
}

fn mid<U: Unit>(mem: &mut [u8], [dst, a]: [Text; 2], [l, p]: [u64; 2]) -> u64 {
    match Part::new::<U>(mem, a, 0, p) {
        Some(part) => put_first::<U>(mem, dst, 0, behind_first::<U>(a, part.start), number(l)) as u64,
        None => put_first::<U>(mem, dst, 0, a, 0) as u64,
    }
}

fn insert<U: Unit>(mem: &mut [u8], [dst, a, b]: [Text; 3], [p]: [u64; 1]) -> u64 {
    let p = number(p);
    let all = extent::<U>(mem, a);
    if p > count::<U>(&all) || U::before_zero(mem, first::<U>(&all, p)) < p {
        return put_first::<U>(mem, dst, 0, a, usize::MAX) as u64;
    }
    splice::<U>(mem, dst, a, Part { start: p, end: p, more: true }, Some(b))
}

fn delete<U: Unit>(mem: &mut [u8], [dst, a]: [Text; 2], [l, p]: [u64; 2]) -> u64 {
    match Part::new::<U>(mem, a, l, p) {
        Some(part) if part.start < part.end => splice::<U>(mem, dst, a, part, None),
        _ => put_first::<U>(mem, dst, 0, a, usize::MAX) as u64,
    }
}

fn replace<U: Unit>(mem: &mut [u8], [dst, a, b]: [Text; 3], [l, p]: [u64; 2]) -> u64 {
    match Part::new::<U>(mem, a, l, p) {
        Some(part) => splice::<U>(mem, dst, a, part, Some(b)),
        None => put_first::<U>(mem, dst, 0, a, usize::MAX) as u64,
    }
}

/// REPLACE in the string itself; the other one does not overlap it.
fn change<U: Unit>(mem: &mut [u8], [dst, new]: [Text; 2], [l, p]: [u64; 2]) -> u64 {
    let Some((first, _, room)) = behind::<U>(mem, dst, 0) else { return 0 };
    let at = |n: usize| first + n * U::BYTES;
    let Some(part) = Part::new::<U>(mem, dst, l, p).filter(|part| part.start < room) else {
        let length = U::before_zero(mem, first..at(room));
        U::set(&mut mem[first..], length, 0);
        return length as u64;
    };
    let rest = if part.more { U::before_zero(mem, at(part.end.min(room))..at(room)) } else { 0 };
    let new = characters::<U>(mem, new);
    let end = part.start + count::<U>(&new).min(room - part.start);
    let rest = rest.min(room - end);
    if end != part.end {
        U::copy(mem, at(part.end), rest, at(end));
    }
    U::copy(mem, new.start, end - part.start, at(part.start));
    U::set(&mut mem[first..], end + rest, 0);
    (end + rest) as u64
}

/// `a` with other characters in place of a part.
fn splice<U: Unit>(mem: &mut [u8], dst: Text, a: Text, part: Part, new: Option<Text>) -> u64 {
    let all = extent::<U>(mem, a);
    let mut n = put::<U>(mem, dst, 0, first::<U>(&all, part.start));
    if let Some(new) = new {
        n = put_first::<U>(mem, dst, n, new, usize::MAX);
    }
    if part.more {
        n = put_first::<U>(mem, dst, n, behind_first::<U>(a, part.end), usize::MAX);
    }
    n as u64
}

/// The position of the first occurrence; 0 if there is none, and for an empty text.
fn find<U: Unit>(mem: &mut [u8], [a, b]: [Text; 2], _: [u64; 0]) -> u64 {
    let at = U::find(mem, extent::<U>(mem, a), extent::<U>(mem, b));
    at.map_or(0, |at| (at + 1).min(INT_MAX) as u64)
}

/// The same for one character, looked for behind the first `n` characters; the position counts from there.
#[inline(always)]
fn find_unit<U: Unit>(mem: &mut [u8], [a]: [Text; 1], [unit, n]: [u64; 2]) -> u64 {
    let near = u64::from(a.capacity)
        .checked_sub(n)
        .filter(|_| unit != 0)
        .and_then(|limit| U::find_near(mem, a.at as usize + n as usize * U::BYTES, limit as usize, unit as u16));
    near.map_or_else(|| find_unit_any::<U>(mem, a, unit, n), |position| position as u64)
}

#[inline(never)]
fn find_unit_any<U: Unit>(mem: &[u8], a: Text, unit: u64, n: u64) -> u64 {
    let all = extent::<U>(mem, a);
    let n = number(n).min(count::<U>(&all));
    let at = if unit == 0 { None } else { U::find_unit(mem, from::<U>(&all, n), unit as u16) };
    at.map_or(0, |at| (at + 1).min(INT_MAX) as u64)
}

/// How many characters lie in front of what is left of a string when `l` more are taken away behind the first `n`.
#[inline(always)]
fn skip<U: Unit>(mem: &mut [u8], [a]: [Text; 1], [n, l]: [u64; 2]) -> u64 {
    let all = extent::<U>(mem, a);
    let n = number(n).min(count::<U>(&all));
    let rest = from::<U>(&all, n);
    let l = number(l).min(count::<U>(&rest));
    (n + U::before_zero(mem, first::<U>(&rest, l))) as u64
}

/// At most `l` of the characters behind the first `n`.
#[inline(always)]
fn tail<U: Unit>(mem: &mut [u8], [dst, a]: [Text; 2], [n, l]: [u64; 2]) -> u64 {
    at_once::<U>(mem, dst, 0, a, n, number(l)).unwrap_or_else(|| tail_any::<U>(mem, dst, a, n, l))
}

#[inline(never)]
fn tail_any<U: Unit>(mem: &mut [u8], dst: Text, a: Text, n: u64, l: u64) -> u64 {
    let n = number(n).min(a.capacity as usize);
    put_first::<U>(mem, dst, 0, behind_first::<U>(a, n), number(l)) as u64
}

/// Appends to a string, cuts at its capacity.
struct Writer<'m, U> {
    mem: &'m mut [u8],
    dst: Text,
    length: usize,
    unit: std::marker::PhantomData<U>,
}

impl<'m, U: Unit> Writer<'m, U> {
    /// Behind the first `length` characters, which it has.
    fn new(mem: &'m mut [u8], dst: Text, length: usize) -> Self {
        let length = length.min(dst.capacity as usize);
        let mut writer = Self { mem, dst, length, unit: std::marker::PhantomData };
        writer.close();
        writer
    }

    fn unit(&mut self, unit: u16) {
        let start = (self.dst.at as usize).min(self.mem.len());
        let units = (self.mem.len() - start) / U::BYTES;
        if self.length < self.dst.capacity as usize && self.length + 1 < units {
            U::set(&mut self.mem[start..], self.length, unit);
            self.length += 1;
            self.close();
        }
    }

    fn close(&mut self) {
        let start = (self.dst.at as usize).min(self.mem.len());
        if (self.length + 1) * U::BYTES <= self.mem.len() - start {
            U::set(&mut self.mem[start..], self.length, 0);
        }
    }
}

impl<U: Unit> fmt::Write for Writer<'_, U> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        // Values are ASCII, but for a CHAR, which is one unit.
        text.chars().for_each(|c| self.unit(c as u32 as u16));
        Ok(())
    }
}

fn write<U: Unit>(mem: &mut [u8], [dst]: [Text; 1], [n, raw, elem]: [u64; 3]) -> u64 {
    let Some(elem) = Elem::from_code(elem as u8) else { return 0 };
    let mut out = Writer::<U>::new(mem, dst, number(n));
    if elem.family() == Family::Char {
        if raw != 0 {
            out.unit(narrowed::<U>(raw as u16));
        }
    } else {
        // The writer takes everything.
        let _ = value::write_text(&mut out, elem, raw);
    }
    out.length as u64
}

/// Integers below are written at once.
const SHORT: u64 = 100_000_000;

/// A signed integer as [`value::write_text`] writes it.
#[inline(always)]
fn whole<U: Unit>(mem: &mut [u8], [dst]: [Text; 1], [n, value]: [u64; 2]) -> u64 {
    let magnitude = (value as i64).unsigned_abs();
    let room = u64::from(dst.capacity).checked_sub(n).filter(|room| *room >= narrow::SHORT_NUMBER as u64);
    if room.is_some() && magnitude < SHORT {
        let to = dst.at as usize + n as usize * U::BYTES;
        if let Some(length) = U::short_number(mem, to, (value as i64) < 0, magnitude as u32) {
            return n + length as u64;
        }
    }
    whole_any::<U>(mem, dst, n, value)
}

#[inline(never)]
fn whole_any<U: Unit>(mem: &mut [u8], dst: Text, n: u64, value: u64) -> u64 {
    write::<U>(mem, [dst], [n, value, u64::from(Elem::Lint.code())])
}

/// A unit that a STRING cannot hold becomes a question mark.
fn narrowed<U: Unit>(unit: u16) -> u16 {
    if U::BYTES == 1 && unit > 0xFF { u16::from(b'?') } else { unit }
}

/// No number of a WSTRING is looked at beyond so many characters.
const LONGEST_NUMBER: usize = 1024;

fn read<U: Unit>(mem: &mut [u8], [a]: [Text; 1], [elem]: [u64; 1]) -> u64 {
    let Some(elem) = Elem::from_code(elem as u8) else { return 0 };
    if U::BYTES == 1
        && (elem.is_integer() || elem.is_bits())
        && let Some(number) = prefix::short_decimal(&mem[extent::<U>(mem, a)])
    {
        return number as u64 & elem.repr().mask();
    }
    let a = &mem[characters::<U>(mem, a)];
    if elem.family() == Family::Char {
        let unit = if a.is_empty() { 0 } else { U::get(a, 0) };
        return if elem == Elem::Char { u64::from(narrowed::<Narrow>(unit)) } else { u64::from(unit) };
    }
    if U::BYTES == 1 {
        return prefix::value(elem, a);
    }
    let mut text = [0; LONGEST_NUMBER];
    let units = (0..a.len() / U::BYTES).map(|n| U::get(a, n)).skip_while(|unit| *unit == 0x20 || *unit == 0x09);
    let mut length = 0;
    for (to, unit) in text.iter_mut().zip(units.take_while(|unit| *unit < 0x80)) {
        *to = unit as u8;
        length += 1;
    }
    prefix::value(elem, &text[..length])
}

fn recode<To: Unit, From: Unit>(mem: &mut [u8], [dst, src]: [Text; 2], _: [u64; 0]) -> u64 {
    let src = characters::<From>(mem, src);
    let length = count::<From>(&src);
    let mut out = Writer::<To>::new(mem, dst, 0);
    for n in 0..length {
        let unit = From::get(&out.mem[src.clone()], n);
        out.unit(narrowed::<To>(unit));
    }
    out.length as u64
}

macro_rules! bodies {
    ($($set:ident $doc:literal {
        $($field:ident $symbol:ident $builds:literal ($($text:ident)+; $($param:ident)*) $body:expr;)*
    })*) => {
        mod c {
            use super::*;
            $($(
                /// # Safety
                /// `region` points to `size` bytes that nobody else uses meanwhile.
                #[unsafe(no_mangle)]
                pub unsafe extern "C" fn $symbol(region: *mut u8, size: u32, $($text: u64,)+ $($param: u64),*) -> u64 {
                    // SAFETY: the caller's promise.
                    let mem = unsafe { std::slice::from_raw_parts_mut(region, size as usize) };
                    ($body)(mem, [$(Text::unpack($text)),+], [$($param),*])
                }
            )*)*
        }
        $(
            #[doc = $doc]
            pub static $set: TextFns = TextFns {
                $($field: TextFn {
                    symbol: stringify!($symbol),
                    texts: [$(stringify!($text)),+].len(),
                    builds: $builds,
                    params: <[&str]>::len(&[$(stringify!($param)),*]),
                    eval: |mem, texts, params| {
                        // A caller's mistake gives a number, not a panic.
                        let (Ok(texts), Ok(params)) = (texts.try_into(), params.try_into()) else { return 0 };
                        ($body)(mem, texts, params)
                    },
                    address: || c::$symbol as *const u8,
                },)*
            };
        )*
    };
}

bodies! {
    STRING "The bodies for STRING." {
        put plcc_string_put true (dst src; n) append::<Narrow>;
        len plcc_string_len false (a;) len::<Narrow>;
        compare plcc_string_compare false (a b;) compare::<Narrow>;
        left plcc_string_left true (dst a; l) left::<Narrow>;
        right plcc_string_right true (dst a; l) right::<Narrow>;
        mid plcc_string_mid true (dst a; l p) mid::<Narrow>;
        insert plcc_string_insert true (dst a b; p) insert::<Narrow>;
        delete plcc_string_delete true (dst a; l p) delete::<Narrow>;
        replace plcc_string_replace true (dst a b; l p) replace::<Narrow>;
        change plcc_string_change true (dst b; l p) change::<Narrow>;
        find plcc_string_find false (a b;) find::<Narrow>;
        find_unit plcc_string_find_unit false (a; unit n) find_unit::<Narrow>;
        skip plcc_string_skip false (a; n l) skip::<Narrow>;
        tail plcc_string_tail true (dst a; n l) tail::<Narrow>;
        write plcc_string_write true (dst; n raw elem) write::<Narrow>;
        whole plcc_string_whole true (dst; n value) whole::<Narrow>;
        read plcc_string_read false (a; elem) read::<Narrow>;
        recode plcc_string_recode true (dst src;) recode::<Narrow, Wide>;
    }
    WSTRING "The bodies for WSTRING." {
        put plcc_wstring_put true (dst src; n) append::<Wide>;
        len plcc_wstring_len false (a;) len::<Wide>;
        compare plcc_wstring_compare false (a b;) compare::<Wide>;
        left plcc_wstring_left true (dst a; l) left::<Wide>;
        right plcc_wstring_right true (dst a; l) right::<Wide>;
        mid plcc_wstring_mid true (dst a; l p) mid::<Wide>;
        insert plcc_wstring_insert true (dst a b; p) insert::<Wide>;
        delete plcc_wstring_delete true (dst a; l p) delete::<Wide>;
        replace plcc_wstring_replace true (dst a b; l p) replace::<Wide>;
        change plcc_wstring_change true (dst b; l p) change::<Wide>;
        find plcc_wstring_find false (a b;) find::<Wide>;
        find_unit plcc_wstring_find_unit false (a; unit n) find_unit::<Wide>;
        skip plcc_wstring_skip false (a; n l) skip::<Wide>;
        tail plcc_wstring_tail true (dst a; n l) tail::<Wide>;
        write plcc_wstring_write true (dst; n raw elem) write::<Wide>;
        whole plcc_wstring_whole true (dst; n value) whole::<Wide>;
        read plcc_wstring_read false (a; elem) read::<Wide>;
        recode plcc_wstring_recode true (dst src;) recode::<Wide, Narrow>;
    }
}

/// The function with this symbol.
pub fn find_symbol(symbol: &str) -> Option<&'static TextFn> {
    STRING.all().into_iter().chain(WSTRING.all()).find(|f| f.symbol == symbol)
}

#[cfg(test)]
mod tests;
