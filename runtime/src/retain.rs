//! RETAIN variables in a file (`--retain`): read before the first cycle, written while the program runs and when it ends.
//!
//! In: the retain ranges of the image, the region after each finished cycle. Out: a file that is valid at any moment:
//!
//! ```text
//! magic, length and CRC of the directory, directory     names, types and places of the variables, written once
//! slot A: sequence number, CRC, values                   the slots are written in turn,
//! slot B: sequence number, CRC, values                   the valid one with the higher number counts
//! ```
//!
//! When the program has changed, the directory says what of the old values still has a place: same name, same type. Then
//! the file is made anew beside the old one and renamed over it.

use crate::image::{Image, TypeDesc};
use crate::path::{Leaf, Resolver};
use plcc_stdlib::elem::Elem;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Read};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// First bytes; the digit is the version.
const MAGIC: &[u8; 8] = b"plccret1";
/// Magic, length and CRC of the directory.
const HEAD_BYTES: u64 = 16;
/// Sequence number and CRC of a slot.
const SLOT_HEAD_BYTES: usize = 12;
/// How often changed values are written while the program runs.
const SAVE_EVERY: Duration = Duration::from_millis(500);

/// A retained variable.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Entry {
    /// Upper case.
    name: String,
    /// Elementary type by its code, or one of the next two.
    kind: u8,
    /// Where its bytes stand in the values.
    at: u32,
    bytes: u32,
    bit: Option<u8>,
}

const STRING: u8 = 0x40;
const WSTRING: u8 = 0x41;

/// Why retained values cannot be used: an exit code and what to say.
type Problem = (u8, String);

/// Keeps the values of the last finished cycle.
#[derive(Debug)]
pub struct Retain {
    path: PathBuf,
    ranges: Vec<(u32, u32)>,
    /// Their bytes after the last finished cycle.
    values: Vec<u8>,
    /// What the file does not have yet.
    unpublished: bool,
    shared: Arc<Shared>,
    thread: Option<std::thread::JoinHandle<()>>,
}

#[derive(Debug)]
struct Shared {
    state: Mutex<State>,
    store: Mutex<Store>,
}

#[derive(Debug)]
struct State {
    values: Vec<u8>,
    dirty: bool,
    done: bool,
    error: Option<io::Error>,
}

/// The open file.
#[derive(Debug)]
struct Store {
    file: File,
    /// Where slot A starts.
    slots: u64,
    sequence: u64,
    /// Head and values of a slot, reused.
    buffer: Vec<u8>,
}

impl Retain {
    /// Opens or makes the file and gives its values, if there are any, as bytes of the region (offset, bytes).
    pub fn open(path: &Path, image: &Image, resolver: &Resolver) -> Result<(Self, Vec<Restored>), Problem> {
        let fail = |e: io::Error| (3, format!("cannot use retain file `{}`: {e}", path.display()));
        let directory = directory(image, resolver).map_err(|e| (2, e))?;
        let length: usize = image.retain.iter().map(|(_, n)| *n as usize).sum();
        let old = match File::open(path) {
            Ok(mut file) => {
                lock(&file, path)?;
                let mut bytes = Vec::new();
                file.read_to_end(&mut bytes).map_err(fail)?;
                Some(bytes)
            }
            Err(e) if e.kind() == ErrorKind::NotFound => None,
            Err(e) => return Err(fail(e)),
        };
        let old = match old.as_deref() {
            // A file that was just made by hand (touch, mktemp) is a cold start.
            None | Some([]) => None,
            Some(bytes) => Some(read_file(bytes).ok_or_else(|| {
                (3, format!("`{}` is no retain file, or it is damaged; a cold start needs it removed", path.display()))
            })?),
        };
        let encoded = postcard::to_stdvec(&directory).unwrap_or_default();
        let slots = HEAD_BYTES + encoded.len() as u64;
        let (mut values, mut restored, mut sequence, mut same) = (vec![0; length], Vec::new(), 0, false);
        if let Some(old) = old {
            same = old.directory == directory && (old.values.is_empty() || old.values.len() == length);
            sequence = old.sequence;
            let count = carry_over(&old, &directory, &mut values, &mut restored, image);
            if !same {
                eprintln!(
                    "{}: the retain file is of another version of this program: {count} of {} variables restored",
                    image.name,
                    directory.len()
                );
            }
        }
        let file = if same {
            OpenOptions::new().read(true).write(true).open(path).map_err(fail)?
        } else {
            let sibling = sibling(path);
            let file = OpenOptions::new().read(true).write(true).create(true).truncate(true).open(&sibling);
            let file = file.map_err(fail)?;
            let mut head = MAGIC.to_vec();
            head.extend((encoded.len() as u32).to_le_bytes());
            head.extend(crc32(&encoded).to_le_bytes());
            head.extend(&encoded);
            file.write_all_at(&head, 0).map_err(fail)?;
            // Both slots exist from the start, so that half of the rest is always one.
            file.set_len(slots + 2 * (SLOT_HEAD_BYTES + length) as u64).map_err(fail)?;
            file
        };
        lock(&file, path)?;
        let mut store = Store { file, slots, sequence, buffer: Vec::new() };
        if !same && !restored.is_empty() {
            store.save(&values).map_err(fail)?;
        }
        if !same {
            store.file.sync_all().map_err(fail)?;
            std::fs::rename(sibling(path), path).map_err(fail)?;
        }
        let state = State { values: values.clone(), dirty: false, done: false, error: None };
        let shared = Arc::new(Shared { state: Mutex::new(state), store: Mutex::new(store) });
        let own = Arc::clone(&shared);
        let thread = std::thread::Builder::new().name("retain".into()).spawn(move || own.save_on_and_on());
        let thread = Some(thread.map_err(fail)?);
        let retain =
            Self { path: path.into(), ranges: image.retain.clone(), values, unpublished: false, shared, thread };
        Ok((retain, restored))
    }

    /// Takes the values of a finished cycle. Never waits: when the thread is just copying, the next cycle tells it.
    pub fn capture(&mut self, mem: &[u8]) {
        let mut at = 0;
        for (start, bytes) in &self.ranges {
            let (start, bytes) = (*start as usize, *bytes as usize);
            if let Some(source) = mem.get(start..start + bytes) {
                let target = &mut self.values[at..at + bytes];
                if target != source {
                    target.copy_from_slice(source);
                    self.unpublished = true;
                }
            }
            at += bytes;
        }
        if self.unpublished
            && let Ok(mut state) = self.shared.state.try_lock()
        {
            state.values.copy_from_slice(&self.values);
            state.dirty = true;
            self.unpublished = false;
        }
    }

    /// Ends the thread and writes the values of the last finished cycle.
    pub fn finish(mut self) -> Result<(), String> {
        self.end_thread();
        let written = guard(&self.shared.store).save(&self.values);
        let error = written.err().or_else(|| guard(&self.shared.state).error.take());
        error.map_or(Ok(()), |e| Err(format!("cannot write retain file `{}`: {e}", self.path.display())))
    }

    fn end_thread(&mut self) {
        guard(&self.shared.state).done = true;
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            let _ = thread.join();
        }
    }
}

impl Drop for Retain {
    fn drop(&mut self) {
        self.end_thread();
    }
}

impl Shared {
    /// The thread: writes what has changed until the run ends.
    fn save_on_and_on(&self) {
        let mut values = guard(&self.state).values.clone();
        loop {
            std::thread::park_timeout(SAVE_EVERY);
            let mut state = guard(&self.state);
            if state.done {
                return;
            }
            if !std::mem::take(&mut state.dirty) {
                continue;
            }
            values.copy_from_slice(&state.values);
            drop(state);
            let error = guard(&self.store).save(&values).err();
            guard(&self.state).error = error;
        }
    }
}

impl Store {
    /// Writes the slot that does not count at the moment, which makes it count.
    fn save(&mut self, values: &[u8]) -> io::Result<()> {
        self.sequence += 1;
        self.buffer.clear();
        self.buffer.extend(self.sequence.to_le_bytes());
        self.buffer.extend([0; 4]);
        self.buffer.extend(values);
        let crc = slot_crc(self.sequence, values);
        self.buffer[8..SLOT_HEAD_BYTES].copy_from_slice(&crc.to_le_bytes());
        let slot = self.slots + (self.sequence % 2) * self.buffer.len() as u64;
        self.file.write_all_at(&self.buffer, slot)?;
        self.file.sync_data()
    }
}

/// A panic elsewhere does not make the values wrong.
fn guard<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Two programs on one file would overwrite each other.
fn lock(file: &File, path: &Path) -> Result<(), Problem> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => {
            Err((3, format!("retain file `{}` is used by another program that runs", path.display())))
        }
        // Some file systems know no locks.
        Err(TryLockError::Error(_)) => Ok(()),
    }
}

/// Where a new file is made.
fn sibling(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".new");
    name.into()
}

/// A restored value: bytes for a place in the region.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Restored {
    /// Where in the region.
    pub offset: u32,
    /// The bit of a packed BOOL.
    pub bit: Option<u8>,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// What a file holds.
struct Old {
    directory: Vec<Entry>,
    sequence: u64,
    /// Empty if no slot was ever written.
    values: Vec<u8>,
}

/// `None` if the bytes are no retain file or nothing in them can be trusted.
fn read_file(bytes: &[u8]) -> Option<Old> {
    let rest = bytes.strip_prefix(MAGIC)?;
    let (length, rest) = rest.split_first_chunk::<4>()?;
    let (crc, rest) = rest.split_first_chunk::<4>()?;
    let (encoded, slots) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
    if crc32(encoded) != u32::from_le_bytes(*crc) {
        return None;
    }
    let directory: Vec<Entry> = postcard::from_bytes(encoded).ok()?;
    if slots.iter().all(|b| *b == 0) {
        // Made, but never written.
        return Some(Old { directory, sequence: 0, values: Vec::new() });
    }
    let (a, b) = slots.split_at_checked(slots.len() / 2)?;
    let (sequence, values) = [a, b].into_iter().filter_map(read_slot).max_by_key(|(sequence, _)| *sequence)?;
    let fits = |e: &Entry| u64::from(e.at) + u64::from(e.bytes) <= values.len() as u64;
    directory.iter().all(fits).then(|| Old { sequence, values: values.to_vec(), directory })
}

fn read_slot(slot: &[u8]) -> Option<(u64, &[u8])> {
    let (sequence, rest) = slot.split_first_chunk::<8>()?;
    let (crc, values) = rest.split_first_chunk::<4>()?;
    let sequence = u64::from_le_bytes(*sequence);
    (sequence > 0 && slot_crc(sequence, values) == u32::from_le_bytes(*crc)).then_some((sequence, values))
}

/// Takes from an old file what still has a place; how many variables.
fn carry_over(old: &Old, directory: &[Entry], values: &mut [u8], restored: &mut Vec<Restored>, image: &Image) -> usize {
    if old.values.is_empty() {
        return 0;
    }
    let by_name: HashMap<&str, &Entry> = old.directory.iter().map(|e| (e.name.as_str(), e)).collect();
    for entry in directory {
        let Some(before) = by_name.get(entry.name.as_str()).filter(|b| b.kind == entry.kind) else { continue };
        let source = &old.values[before.at as usize..][..before.bytes as usize];
        let bytes = match entry.bit.is_some() || before.bit.is_some() {
            true => {
                let value = before.bit.map_or(u8::from(source[0] != 0), |bit| source[0] >> bit & 1);
                vec![value]
            }
            false => {
                let mut bytes = source[..source.len().min(entry.bytes as usize)].to_vec();
                let unit = match entry.kind {
                    STRING => 1,
                    WSTRING => 2,
                    _ => 0,
                };
                // A string that was longer is cut at its new capacity.
                let end = bytes.len();
                bytes[end - unit.min(end)..].fill(0);
                bytes
            }
        };
        crate::path::write(values, entry.at, entry.bit, &bytes);
        let offset = region_offset(image, entry.at);
        restored.push(Restored { offset, bit: entry.bit, bytes });
    }
    restored.len()
}

/// Every variable inside the retain ranges, hidden ones too. References are in no range.
fn directory(image: &Image, resolver: &Resolver) -> Result<Vec<Entry>, String> {
    let mut entries = Vec::new();
    for (name, leaf) in resolver.every_leaf()? {
        let Some((kind, bytes)) = kind(image, &leaf) else { continue };
        if let Some(at) = value_offset(image, leaf.offset, bytes) {
            entries.push(Entry { name: name.to_ascii_uppercase(), kind, at, bytes, bit: leaf.bit });
        }
    }
    Ok(entries)
}

fn kind(image: &Image, leaf: &Leaf) -> Option<(u8, u32)> {
    match image.types.get(leaf.ty as usize)? {
        TypeDesc::Elem(code) | TypeDesc::Enum { elem: code, .. } => Some((*code, Elem::from_code(*code)?.bytes())),
        TypeDesc::String { wide: false, capacity } => Some((STRING, capacity + 1)),
        TypeDesc::String { wide: true, capacity } => Some((WSTRING, 2 * (capacity + 1))),
        _ => None,
    }
}

/// Where bytes of the region stand in the values; `None` if they are not retained.
fn value_offset(image: &Image, offset: u32, bytes: u32) -> Option<u32> {
    let mut at = 0;
    for (start, length) in &image.retain {
        if offset >= *start && offset + bytes <= start + length {
            return Some(at + offset - start);
        }
        at += length;
    }
    None
}

/// The reverse of [`value_offset`].
fn region_offset(image: &Image, at: u32) -> u32 {
    let mut first = 0;
    for (start, length) in &image.retain {
        if at < first + length {
            return start + at - first;
        }
        first += length;
    }
    0
}

/// The sequence number is part of what the CRC covers.
fn slot_crc(sequence: u64, values: &[u8]) -> u32 {
    crc32_of(sequence.to_le_bytes().iter().chain(values))
}

fn crc32(bytes: &[u8]) -> u32 {
    crc32_of(bytes.iter())
}

/// CRC-32 as in IEEE 802.3, reflected.
fn crc32_of<'a>(bytes: impl Iterator<Item = &'a u8>) -> u32 {
    const TABLE: [u32; 256] = table();
    !bytes.fold(!0, |crc, byte| crc >> 8 ^ TABLE[((crc ^ u32::from(*byte)) & 0xFF) as usize])
}

const fn table() -> [u32; 256] {
    let mut table = [0; 256];
    let mut n = 0;
    while n < 256 {
        let mut crc = n as u32;
        let mut bit = 0;
        while bit < 8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
            bit += 1;
        }
        table[n] = crc;
        n += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Root;

    fn image(names: &[(&str, u32)]) -> Image {
        let root = |(name, offset): &(&str, u32)| Root {
            name: name.to_string(),
            offset: *offset,
            bit: None,
            ty: 0,
            constant: false,
            retain: true,
        };
        Image {
            name: "test".into(),
            types: vec![TypeDesc::Elem(Elem::Int.code())],
            roots: names.iter().map(root).collect(),
            retain: names.iter().map(|(_, offset)| (*offset, 2)).collect(),
            ..Image::default()
        }
    }

    fn open(path: &Path, image: &Image) -> Result<(Retain, Vec<Restored>), Problem> {
        Retain::open(path, image, &Resolver::new(image))
    }

    fn scratch(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("plcc-retain-{}-{name}", std::process::id()));
        let _ = std::fs::remove_file(&path);
        path
    }

    fn value(offset: u32, byte: u8) -> Restored {
        Restored { offset, bit: None, bytes: vec![byte, 0] }
    }

    /// Memory with its own number in each even byte.
    fn memory() -> Vec<u8> {
        (0..=127).map(|n| if n % 2 == 0 { n } else { 0 }).collect()
    }

    #[test]
    fn the_check_value_of_crc32() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn the_last_finished_cycle_comes_back() {
        let (path, image) = (scratch("back"), image(&[("a", 64), ("b", 80)]));
        let (mut retain, restored) = open(&path, &image).unwrap();
        assert_eq!(restored, []);
        assert_eq!(open(&path, &image).unwrap_err().0, 3, "two programs on one file");
        retain.capture(&[9; 128]);
        retain.capture(&memory());
        retain.finish().unwrap();
        let (retain, restored) = open(&path, &image).unwrap();
        assert_eq!(restored, [value(64, 64), value(80, 80)]);
        retain.finish().unwrap();
        let _ = std::fs::remove_file(path);
    }

    #[test]
    fn a_changed_program_finds_its_variables_by_name() {
        let path = scratch("changed");
        let (mut retain, _) = open(&path, &image(&[("a", 64), ("b", 80)])).unwrap();
        retain.capture(&memory());
        retain.finish().unwrap();
        let changed = image(&[("c", 64), ("B", 100)]);
        let (retain, restored) = open(&path, &changed).unwrap();
        assert_eq!(restored, [value(100, 80)]);
        drop(retain);
        // The new file holds them even though nothing was captured.
        assert_eq!(open(&path, &changed).unwrap().1, [value(64, 0), value(100, 80)]);
        let _ = std::fs::remove_file(path);
    }

    #[test]
    fn a_torn_slot_falls_back_to_the_other_one() {
        let (path, image) = (scratch("torn"), image(&[("a", 64)]));
        for byte in [1, 2] {
            let (mut retain, _) = open(&path, &image).unwrap();
            retain.capture(&[byte; 128]);
            retain.finish().unwrap();
        }
        let mut bytes = std::fs::read(&path).unwrap();
        // The second save went to slot A; a changed byte there brings back the first.
        let slot = SLOT_HEAD_BYTES + 2;
        let at = bytes.len() - slot - 1;
        bytes[at] ^= 1;
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(open(&path, &image).unwrap().1, [Restored { offset: 64, bit: None, bytes: vec![1, 1] }]);
        let last = bytes.len() - 1;
        bytes[last] ^= 1;
        std::fs::write(&path, &bytes).unwrap();
        assert!(open(&path, &image).unwrap_err().1.contains("damaged"));
        let _ = std::fs::remove_file(path);
    }
}
