//! The values of the last finished cycle in shared memory: they outlive a process that is killed, not the machine.
//!
//! The area is a file in /dev/shm named after the id of the retain file. It lies there and not beside the file, because a
//! page of a file on a disk faults when it is written after each write-back, and waits while one runs: a cycle may do
//! neither.
//!
//! ```text
//!  0  8 bytes   magic "plcclive"
//!  8  u32, u32  CRC-32 of the directory; 0
//! 16  u64, u64  device and number of the retain file: a copy of the file has other values
//! 32            for each set two slots: u64 begun, u64 ended, then the values, aligned to 8 bytes
//! ```
//! The cycle writes the slot that does not count: its number into `begun`, the values, its number into `ended`. A slot whose
//! two numbers differ is half written and does not count.

use super::directory::Directory;
use super::empty_sets;
use super::file::{Id, Set, crc32};
use std::ffi::CString;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering, fence};

const MAGIC: &[u8; 8] = b"plcclive";
const HEAD_BYTES: usize = 32;
const SLOT_HEAD_BYTES: usize = 16;
/// A slot that is overwritten while it is read is tried so often.
const TRIES: usize = 64;

/// The mapped area.
#[derive(Debug)]
pub struct Live {
    map: Arc<Map>,
    /// First slot of each set, and bytes of its values.
    sets: Vec<(usize, usize)>,
}

#[derive(Debug)]
struct Map {
    base: *mut u8,
    bytes: usize,
}

// SAFETY: plain memory; who may write where is said at `Writer` and `Live`.
unsafe impl Send for Map {}
// SAFETY: as above.
unsafe impl Sync for Map {}

impl Drop for Map {
    fn drop(&mut self) {
        // SAFETY: mapped by `map`, and nobody has the value any more.
        unsafe { libc::munmap(self.base.cast(), self.bytes) };
    }
}

/// Keeps the values of one set at the end of each cycle. There is one for each set, so each slot has one writer.
#[derive(Debug)]
pub struct Writer {
    map: Arc<Map>,
    at: usize,
    /// Bytes of the memory (start, length) in the order of the values.
    ranges: Vec<(u32, u32)>,
    bytes: usize,
    sequence: u64,
    /// The slot that counts.
    slot: usize,
}

/// The sets' places, and the size of the area.
fn places(directory: &Directory) -> (Vec<(usize, usize)>, usize) {
    let mut at = HEAD_BYTES;
    let sets = directory.sets.iter().map(|set| {
        let bytes = set.bytes as usize;
        let place = (at, bytes);
        at += 2 * slot_bytes(bytes);
        place
    });
    (sets.collect(), at)
}

fn slot_bytes(values: usize) -> usize {
    SLOT_HEAD_BYTES + values.next_multiple_of(8)
}

fn name(id: &Id) -> CString {
    let hex: String = id.iter().map(|b| format!("{b:02x}")).collect();
    // Hexadecimal digits hold no 0.
    CString::new(format!("/plcc-retain-{hex}")).unwrap_or_default()
}

/// Removes the area of a file.
pub fn remove(id: &Id) {
    let name = name(id);
    // SAFETY: `name` is a C string.
    unsafe { libc::shm_unlink(name.as_ptr()) };
}

/// What a killed run left: for each set its newest values, number 0 where there are none.
pub fn read(id: &Id, identity: (u64, u64), directory: &Directory) -> Vec<Set> {
    let mut sets = empty_sets(directory);
    let (places, bytes) = places(directory);
    if let Ok(map) = map(id, bytes, false)
        && is_of(&map, identity, directory)
    {
        for (set, (at, _)) in sets.iter_mut().zip(places) {
            read_newest(&map, at, set);
        }
    }
    sets
}

fn directory_crc(directory: &Directory) -> u32 {
    crc32(postcard::to_stdvec(directory).unwrap_or_default().iter())
}

fn is_of(map: &Map, (device, number): (u64, u64), directory: &Directory) -> bool {
    let head = map.copy(0, HEAD_BYTES);
    let crc = u64::from(directory_crc(directory));
    head[..8] == *MAGIC && head[8..] == [crc.to_le_bytes(), device.to_le_bytes(), number.to_le_bytes()].concat()
}

/// Maps the area; makes it if `create`.
fn map(id: &Id, bytes: usize, create: bool) -> std::io::Result<Map> {
    let name = name(id);
    let error = std::io::Error::last_os_error;
    let flags = libc::O_RDWR | libc::O_NOFOLLOW | if create { libc::O_CREAT } else { 0 };
    // SAFETY: `name` is a C string.
    let fd = unsafe { libc::shm_open(name.as_ptr(), flags, 0o600) };
    if fd < 0 {
        return Err(error());
    }
    // SAFETY: the descriptor was just opened and belongs to nobody else.
    let file = unsafe { <std::fs::File as std::os::fd::FromRawFd>::from_raw_fd(fd) };
    let meta = file.metadata()?;
    // SAFETY: the call has no conditions.
    let me = unsafe { libc::geteuid() };
    // Everybody may write to /dev/shm: only what is our own counts.
    if std::os::unix::fs::MetadataExt::uid(&meta) != me {
        return Err(std::io::ErrorKind::PermissionDenied.into());
    }
    if create {
        // All pages, now: a full /dev/shm is found here and not in a cycle.
        // SAFETY: the descriptor is open.
        let done = unsafe { libc::posix_fallocate(fd, 0, bytes as libc::off_t) };
        if done != 0 {
            return Err(std::io::Error::from_raw_os_error(done));
        }
    } else if meta.len() < bytes as u64 {
        return Err(std::io::ErrorKind::UnexpectedEof.into());
    }
    map_descriptor(fd, bytes, libc::MAP_SHARED)
}

fn map_descriptor(fd: i32, bytes: usize, flags: i32) -> std::io::Result<Map> {
    let protection = libc::PROT_READ | libc::PROT_WRITE;
    // SAFETY: a new mapping of `bytes` bytes, of a file that has them or of none.
    let base = unsafe { libc::mmap(std::ptr::null_mut(), bytes, protection, flags | libc::MAP_POPULATE, fd, 0) };
    if base == libc::MAP_FAILED {
        return Err(std::io::Error::last_os_error());
    }
    Ok(Map { base: base.cast(), bytes })
}

impl Map {
    fn number(&self, at: usize) -> &AtomicU64 {
        debug_assert!(at.is_multiple_of(8) && at + 8 <= self.bytes);
        // SAFETY: inside the mapping and aligned, as the mapping is to a page.
        unsafe { AtomicU64::from_ptr(self.base.add(at).cast()) }
    }

    fn copy(&self, at: usize, bytes: usize) -> Vec<u8> {
        let mut out = vec![0; bytes];
        self.copy_out(at, &mut out);
        out
    }

    /// Bytes that may be overwritten meanwhile: what they are worth is for the numbers around them to say.
    fn copy_out(&self, at: usize, to: &mut [u8]) {
        assert!(at + to.len() <= self.bytes, "outside of the area");
        // SAFETY: inside the mapping, and `to` is other memory.
        unsafe { std::ptr::copy_nonoverlapping(self.base.add(at), to.as_mut_ptr(), to.len()) };
    }

    fn copy_in(&self, at: usize, from: &[u8]) {
        assert!(at + from.len() <= self.bytes, "outside of the area");
        // SAFETY: inside the mapping, and `from` is other memory.
        unsafe { std::ptr::copy_nonoverlapping(from.as_ptr(), self.base.add(at), from.len()) };
    }
}

/// Reads the newest whole slot of a set if it is newer than what is there. Whether it was.
fn read_newest(map: &Map, at: usize, set: &mut Set) -> bool {
    let bytes = slot_bytes(set.values.len());
    for _ in 0..TRIES {
        let ended = [0, 1].map(|n| map.number(at + n * bytes + 8).load(Ordering::Acquire));
        let slot = usize::from(ended[1] > ended[0]);
        if ended[slot] <= set.sequence {
            return false;
        }
        let start = at + slot * bytes;
        let mut values = map.copy(start + SLOT_HEAD_BYTES, set.values.len());
        fence(Ordering::Acquire);
        if map.number(start).load(Ordering::Relaxed) == ended[slot] {
            set.sequence = ended[slot];
            std::mem::swap(&mut set.values, &mut values);
            return true;
        }
        // The slot is half written. Of a process that was killed there the other one counts.
        let other = 1 - slot;
        let start = at + other * bytes;
        let number = map.number(start).load(Ordering::Acquire);
        if number == ended[other] && number > set.sequence {
            let values = map.copy(start + SLOT_HEAD_BYTES, set.values.len());
            fence(Ordering::Acquire);
            if map.number(start).load(Ordering::Relaxed) == number {
                (set.sequence, set.values) = (number, values);
                return true;
            }
        }
        std::thread::yield_now();
    }
    false
}

impl Live {
    /// Makes the area of a retain file, with these values in it. If that cannot be, a memory of this process alone takes its
    /// place, and the second value says why.
    pub fn open(id: &Id, (device, number): (u64, u64), directory: &Directory, sets: &[Set]) -> (Self, Option<String>) {
        let (places, bytes) = places(directory);
        let (map, told) = match map(id, bytes, true) {
            Ok(map) => (map, None),
            Err(e) => {
                let own = map_descriptor(-1, bytes, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS);
                let own = own
                    .unwrap_or_else(|_| Map { base: Vec::leak(vec![0u64; bytes / 8 + 1]).as_mut_ptr().cast(), bytes });
                (own, Some(format!("no shared memory for retained values ({e})")))
            }
        };
        let live = Self { map: Arc::new(map), sets: places };
        // An area that a killed run of this file left holds these values, and stays valid through all of this. Any other is
        // of nobody.
        if !is_of(&live.map, (device, number), directory) {
            live.map.number(0).store(0, Ordering::Release);
            for ((at, bytes), set) in live.sets.iter().zip(sets) {
                let other = at + slot_bytes(*bytes);
                live.map.copy_in(at + SLOT_HEAD_BYTES, &set.values);
                for (at, sequence) in [(*at, set.sequence), (other, 0)] {
                    live.map.number(at).store(sequence, Ordering::Relaxed);
                    live.map.number(at + 8).store(sequence, Ordering::Relaxed);
                }
            }
            live.map.number(8).store(u64::from(directory_crc(directory)), Ordering::Relaxed);
            live.map.number(16).store(device, Ordering::Relaxed);
            live.map.number(24).store(number, Ordering::Relaxed);
            live.map.number(0).store(u64::from_le_bytes(*MAGIC), Ordering::Release);
        }
        (live, told)
    }

    /// One for each resource, and the last for what they share; `None` where nothing is retained.
    pub fn writers(&self, directory: &Directory) -> Vec<Option<Writer>> {
        let places = self.sets.iter().zip(&directory.sets).zip(&directory.ranges);
        let writers = places.map(|(((at, bytes), _), ranges)| {
            let slot = slot_bytes(*bytes);
            let ended = [0, 1].map(|n| {
                let [begun, ended] = [0, 8].map(|k| self.map.number(at + n * slot + k).load(Ordering::Acquire));
                if begun == ended { ended } else { 0 }
            });
            let newest = usize::from(ended[1] > ended[0]);
            (*bytes > 0).then(|| Writer {
                map: Arc::clone(&self.map),
                at: *at,
                ranges: ranges.clone(),
                bytes: *bytes,
                sequence: ended[newest],
                slot: newest,
            })
        });
        writers.collect()
    }

    /// Reads the newest values of a set if they are newer than what is there. Whether they were.
    pub fn read_set(&self, number: usize, set: &mut Set) -> bool {
        read_newest(&self.map, self.sets[number].0, set)
    }
}

impl Writer {
    /// Takes the values of a finished cycle from memory that starts at `start`. Nothing is written if nothing has changed
    /// since; never waits and never allocates.
    pub fn capture(&mut self, start: usize, memory: &[u8]) {
        if self.is_unchanged(start, memory) {
            return;
        }
        let (slot, sequence) = (1 - self.slot, self.sequence + 1);
        let at = self.at + slot * slot_bytes(self.bytes);
        self.map.number(at).store(sequence, Ordering::Relaxed);
        fence(Ordering::Release);
        let mut to = at + SLOT_HEAD_BYTES;
        for (first, bytes) in &self.ranges {
            let (first, bytes) = (*first as usize - start, *bytes as usize);
            self.map.copy_in(to, &memory[first..first + bytes]);
            to += bytes;
        }
        self.map.number(at + 8).store(sequence, Ordering::Release);
        (self.slot, self.sequence) = (slot, sequence);
    }

    fn is_unchanged(&self, start: usize, memory: &[u8]) -> bool {
        if self.sequence == 0 {
            return false;
        }
        let mut at = self.at + self.slot * slot_bytes(self.bytes) + SLOT_HEAD_BYTES;
        self.ranges.iter().all(|(first, bytes)| {
            let (first, bytes) = (*first as usize - start, *bytes as usize);
            // SAFETY: inside the mapping; only this writer writes this slot.
            let kept = unsafe { std::slice::from_raw_parts(self.map.base.add(at), bytes) };
            at += bytes;
            kept == &memory[first..first + bytes]
        })
    }
}
