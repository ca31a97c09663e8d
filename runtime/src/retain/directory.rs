//! Which retained variable lies where in the values, and how values find their variables after an edit of the program.

use super::empty_sets;
use super::file::{Old, Set};
use crate::image::{Image, TypeDesc};
use crate::path::{Leaf, Resolver};
use plcc_stdlib::elem::Elem;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Every retained variable of elementary, enumeration or string type.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Directory {
    /// For each resource, and last for what they share.
    pub sets: Vec<SetPlace>,
    /// Types, by index.
    pub kinds: Vec<Kind>,
    pub entries: Vec<Entry>,
    /// Where the bytes of each set come from: ranges of the memory (start, length). Not part of the file.
    #[serde(skip)]
    pub ranges: Vec<Vec<(u32, u32)>>,
}

/// The ranges do not count: a file has none.
impl PartialEq for Directory {
    fn eq(&self, other: &Self) -> bool {
        (&self.sets, &self.kinds, &self.entries) == (&other.sets, &other.kinds, &other.entries)
    }
}

/// A set of values in all values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct SetPlace {
    pub start: u32,
    pub bytes: u32,
}

/// A retained variable.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Entry {
    /// As declared; names do not differ by case.
    pub name: String,
    /// Index in `kinds`.
    pub kind: u32,
    /// Where its bytes stand in all values.
    pub at: u32,
    pub bit: Option<u8>,
}

/// What decides whether a value still fits its variable.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// By its code.
    Elem(u8),
    Subrange {
        elem: u8,
        low: i128,
        high: i128,
    },
    Enum {
        elem: u8,
        values: Vec<(String, i64)>,
    },
    String {
        wide: bool,
        capacity: u32,
    },
}

/// A restored value: bytes for a place in the memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Restored {
    /// Where in the memory.
    pub offset: u32,
    /// The bit of a packed BOOL.
    pub bit: Option<u8>,
    /// The bytes.
    pub bytes: Vec<u8>,
}

impl Kind {
    pub fn bytes(&self) -> u32 {
        match self {
            Kind::Elem(code) | Kind::Enum { elem: code, .. } | Kind::Subrange { elem: code, .. } => {
                Elem::from_code(*code).map_or(0, Elem::bytes)
            }
            Kind::String { wide: false, capacity } => capacity.saturating_add(1),
            Kind::String { wide: true, capacity } => capacity.saturating_add(1).saturating_mul(2),
        }
    }

    /// As a user knows it.
    pub fn text(&self) -> String {
        match self {
            Kind::Elem(code) => Elem::from_code(*code).map_or("?".into(), |e| e.name().to_string()),
            Kind::Subrange { elem, low, high } => format!("{} ({low}..{high})", Kind::Elem(*elem).text()),
            Kind::Enum { values, .. } => {
                format!("({})", values.iter().map(|(n, _)| n.as_str()).collect::<Vec<_>>().join(", "))
            }
            Kind::String { wide, capacity } => format!("{}STRING[{capacity}]", if *wide { "W" } else { "" }),
        }
    }

    pub fn desc(&self) -> TypeDesc {
        match self.clone() {
            Kind::Elem(code) => TypeDesc::Elem(code),
            Kind::Subrange { elem, low, high } => TypeDesc::Subrange { elem, low, high },
            Kind::Enum { elem, values } => TypeDesc::Enum { elem, values },
            Kind::String { wide, capacity } => TypeDesc::String { wide, capacity },
        }
    }
}

impl Directory {
    /// Of a program. References are in no retain range.
    pub fn of(image: &Image, resolver: &Resolver) -> Result<Self, String> {
        let mut parts: Vec<(u32, u32)> = image.resources.iter().map(|r| (r.start, r.bytes)).collect();
        parts.push(image.home);
        let mut directory = Self { sets: Vec::new(), kinds: Vec::new(), entries: Vec::new(), ranges: Vec::new() };
        let mut at = 0;
        for (start, bytes) in parts {
            let inside = |r: &&(u32, u32)| r.0 >= start && r.0 + r.1 <= start + bytes;
            let own: Vec<(u32, u32)> = image.retain.iter().filter(inside).copied().collect();
            let set = SetPlace { start: at, bytes: own.iter().map(|r| r.1).sum() };
            at += set.bytes;
            directory.sets.push(set);
            directory.ranges.push(own);
        }
        let mut kinds: HashMap<u32, Option<u32>> = HashMap::new();
        for (name, leaf) in resolver.every_leaf()? {
            let kind = *kinds.entry(leaf.ty).or_insert_with(|| {
                let kind = kind(image, leaf.ty)?;
                let known = directory.kinds.iter().position(|k| *k == kind);
                Some(known.unwrap_or_else(|| {
                    directory.kinds.push(kind);
                    directory.kinds.len() - 1
                }) as u32)
            });
            let Some(kind) = kind else { continue };
            if let Some(at) = directory.value_offset(&leaf, directory.kinds[kind as usize].bytes()) {
                directory.entries.push(Entry { name, kind, at, bit: leaf.bit });
            }
        }
        Ok(directory)
    }

    /// Whether it can be used: a file may hold anything.
    pub fn is_sound(&self) -> bool {
        let mut at = 0u64;
        let sets = self.sets.iter().all(|s| {
            let fits = u64::from(s.start) == at;
            at += u64::from(s.bytes);
            fits
        });
        let entry = |e: &Entry| {
            let kind = self.kinds.get(e.kind as usize);
            kind.is_some_and(|k| u64::from(e.at) + u64::from(k.bytes()) <= at && k.bytes() > 0)
                && e.bit.is_none_or(|b| b < 8)
        };
        sets && at <= u64::from(u32::MAX) && self.entries.iter().all(entry)
    }

    pub fn kind(&self, entry: &Entry) -> &Kind {
        &self.kinds[entry.kind as usize]
    }

    /// The bytes of an entry in sets.
    pub fn value<'s>(&self, entry: &Entry, sets: &'s [Set]) -> &'s [u8] {
        let set = self.set_of(entry.at);
        let at = (entry.at - self.sets[set].start) as usize;
        sets[set].values.get(at..at + self.kind(entry).bytes() as usize).unwrap_or_default()
    }

    fn set_of(&self, at: u32) -> usize {
        self.sets.iter().rposition(|s| s.start <= at && s.bytes > 0).unwrap_or(0)
    }

    /// Where bytes of the memory stand in all values; `None` if they are not retained.
    fn value_offset(&self, leaf: &Leaf, bytes: u32) -> Option<u32> {
        for (set, ranges) in self.sets.iter().zip(&self.ranges) {
            let mut at = set.start;
            for (start, length) in ranges {
                if leaf.offset >= *start && leaf.offset + bytes <= start + length {
                    return Some(at + leaf.offset - start);
                }
                at += length;
            }
        }
        None
    }

    /// The reverse of [`Directory::value_offset`].
    fn memory_offset(&self, at: u32) -> u32 {
        for (set, ranges) in self.sets.iter().zip(&self.ranges) {
            let mut first = set.start;
            for (start, length) in ranges {
                if (first..first + length).contains(&at) {
                    return start + at - first;
                }
                first += length;
            }
        }
        0
    }
}

fn kind(image: &Image, ty: u32) -> Option<Kind> {
    match image.types.get(ty as usize)? {
        TypeDesc::Elem(code) => Some(Kind::Elem(*code)),
        TypeDesc::Subrange { elem, low, high } => Some(Kind::Subrange { elem: *elem, low: *low, high: *high }),
        TypeDesc::Enum { elem, values } => Some(Kind::Enum { elem: *elem, values: values.clone() }),
        TypeDesc::String { wide, capacity } => Some(Kind::String { wide: *wide, capacity: *capacity }),
        _ => None,
    }
}

/// How a variable of the program relates to what a file has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Fate {
    /// Its value is restored: these bytes (one, 0 or 1, for a bit).
    Kept(Vec<u8>),
    /// The file has the name with another type, which it says.
    OtherType(String),
    /// An enumeration that has no value of the old name any more, or a subrange that does not hold the value.
    ValueGone(String),
    /// The file does not have it.
    New,
}

/// The fate of every variable of the program, in order, and the old names that no variable has any more.
pub fn fates(old: &Old, directory: &Directory) -> (Vec<Fate>, Vec<usize>) {
    let mut by_name: HashMap<String, usize> =
        old.directory.entries.iter().enumerate().map(|(n, e)| (e.name.to_ascii_uppercase(), n)).collect();
    let fates = directory.entries.iter().map(|entry| {
        let Some(n) = by_name.remove(&entry.name.to_ascii_uppercase()) else { return Fate::New };
        let before = &old.directory.entries[n];
        convert(old.directory.kind(before), before.bit, old.directory.value(before, &old.sets), directory.kind(entry))
    });
    let fates = fates.collect();
    let mut gone: Vec<usize> = by_name.into_values().collect();
    gone.sort_unstable();
    (fates, gone)
}

fn convert(before: &Kind, bit: Option<u8>, value: &[u8], now: &Kind) -> Fate {
    let other = || Fate::OtherType(before.text());
    // A subrange has the type of its base; what lies outside of it now has no place.
    let base = |kind: &Kind| match kind {
        Kind::Subrange { elem, .. } => Kind::Elem(*elem),
        other => other.clone(),
    };
    if let Kind::Subrange { elem, low, high } = now
        && base(before) == Kind::Elem(*elem)
        && let Some(elem) = Elem::from_code(*elem)
    {
        let mut raw = [0; 8];
        raw[..value.len().min(8)].copy_from_slice(&value[..value.len().min(8)]);
        let number = elem.to_i128(u64::from_le_bytes(raw));
        return if (*low..=*high).contains(&number) {
            Fate::Kept(value.to_vec())
        } else {
            Fate::ValueGone(number.to_string())
        };
    }
    match (&base(before), now) {
        (Kind::Elem(a), Kind::Elem(b)) if a == b => match (Elem::from_code(*a), bit) {
            (Some(Elem::Bool), Some(bit)) => Fate::Kept(vec![value.first().map_or(0, |v| v >> bit & 1)]),
            (Some(Elem::Bool), None) => Fate::Kept(vec![u8::from(value.first().is_some_and(|v| *v != 0))]),
            _ => Fate::Kept(value.to_vec()),
        },
        (Kind::Enum { elem: a, values: old }, Kind::Enum { elem: b, values: new }) => {
            if old == new && a == b {
                return Fate::Kept(value.to_vec());
            }
            // Numbers may mean something else now: the name counts.
            let mut raw = [0; 8];
            raw[..value.len().min(8)].copy_from_slice(&value[..value.len().min(8)]);
            let number = Elem::from_code(*a).map_or(0, |e| e.to_i128(u64::from_le_bytes(raw)));
            let name = old.iter().find(|(_, v)| i128::from(*v) == number).map(|(n, _)| n);
            let Some(name) = name else { return Fate::ValueGone(number.to_string()) };
            let bytes = Elem::from_code(*b).map_or(0, Elem::bytes) as usize;
            match new.iter().find(|(n, _)| n.eq_ignore_ascii_case(name)) {
                Some((_, v)) => Fate::Kept(v.to_le_bytes()[..bytes].to_vec()),
                None => Fate::ValueGone(name.clone()),
            }
        }
        (Kind::String { wide: a, .. }, Kind::String { wide: b, capacity }) if a == b => {
            // A string that was longer is cut at its new capacity.
            let unit = if *a { 2 } else { 1 };
            let mut bytes = value[..value.len().min(unit * (*capacity as usize + 1))].to_vec();
            let end = bytes.len();
            bytes[end - unit.min(end)..].fill(0);
            Fate::Kept(bytes)
        }
        _ => other(),
    }
}

/// The values with which a program starts: its sets, filled with what an old file has for it. What is restored is added to
/// `restored`; the second result lists what was dropped.
pub fn carry_over(old: Option<&Old>, directory: &Directory, restored: &mut Vec<Restored>) -> (Vec<Set>, Vec<String>) {
    let mut sets = empty_sets(directory);
    let Some(old) = old else { return (sets, Vec::new()) };
    let (fates, gone) = fates(old, directory);
    let mut dropped: Vec<String> = Vec::new();
    for (entry, fate) in directory.entries.iter().zip(fates) {
        match fate {
            Fate::Kept(bytes) => {
                let set = directory.set_of(entry.at);
                crate::path::write(&mut sets[set].values, entry.at - directory.sets[set].start, entry.bit, &bytes);
                restored.push(Restored { offset: directory.memory_offset(entry.at), bit: entry.bit, bytes });
            }
            Fate::OtherType(before) => {
                dropped.push(format!("{} was {before}, is {} now", entry.name, directory.kind(entry).text()));
            }
            Fate::ValueGone(value) => dropped.push(format!("{} had the value {value}, which is gone", entry.name)),
            Fate::New => {}
        }
    }
    let gone = gone.into_iter().map(|n| &old.directory.entries[n]);
    dropped.extend(gone.map(|e| format!("{} ({}) is not retained any more", e.name, old.directory.kind(e).text())));
    // The same program goes on counting where the file stopped.
    if old.directory == *directory {
        for (set, before) in sets.iter_mut().zip(&old.sets) {
            set.sequence = before.sequence;
            set.values.clone_from(&before.values);
        }
    }
    (sets, dropped)
}
