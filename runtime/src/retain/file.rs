//! The retain file:
//!
//! ```text
//!  0  8 bytes   magic "plccret2"
//!  8  u32, u32  length and CRC-32 of the directory (with the id)
//! 16  16 bytes  id of this file
//! 32            the directory (postcard)
//! slot A, slot B, each at a multiple of 4096 bytes:
//!    u64 number of the save, u32 CRC-32 of all that follows and the number, then for each set u64 sequence; then the values
//! ```
//! Magic, id and directory are written once, before the file has its name. A save writes the slot that does not count and
//! waits until it is on the medium; only then it counts, and the other slot is the next to be overwritten. So whatever a
//! power cut does to the writes since, one slot is whole. All numbers are little-endian.

use super::directory::Directory;
use super::disk::{Disk, RealDisk};
use super::empty_sets;
use std::io;

/// First bytes of the file; the digit is the version.
pub const MAGIC: &[u8; 8] = b"plccret2";
const HEAD_BYTES: usize = 32;
const SLOT_HEAD_BYTES: usize = 12;
/// Slots share no block of a medium, whatever its size up to this.
const ALIGN: usize = 4096;

/// The number of a file: what a killed run leaves in memory is found by it.
pub type Id = [u8; 16];

/// The values of one resource (or of what resources share), all of one cycle.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Set {
    /// Rises with each change; 0: no values yet.
    pub sequence: u64,
    pub values: Vec<u8>,
}

/// What a file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Old {
    pub id: Id,
    pub directory: Directory,
    pub sets: Vec<Set>,
    /// Number of the save that counts and its slot.
    save: u64,
    slot: usize,
}

/// What was found at the file's path.
#[derive(Debug, PartialEq)]
pub enum Found {
    /// No file, or an empty one: a file that was just made by hand (touch, mktemp) is a cold start.
    Nothing,
    /// No retain file, or nothing in it can be trusted.
    Damaged,
    Old(Old),
}

/// Reads the file.
pub fn read(disk: &mut impl Disk) -> io::Result<Found> {
    Ok(match disk.read()? {
        None => Found::Nothing,
        Some(bytes) if bytes.is_empty() => Found::Nothing,
        Some(bytes) => parse(&bytes).map_or(Found::Damaged, Found::Old),
    })
}

/// The contents of a file.
pub fn parse(bytes: &[u8]) -> Option<Old> {
    let rest = bytes.strip_prefix(MAGIC)?;
    let (length, rest) = rest.split_first_chunk::<4>()?;
    let (crc, rest) = rest.split_first_chunk::<4>()?;
    let (id, rest) = rest.split_first_chunk::<16>()?;
    let encoded = rest.get(..u32::from_le_bytes(*length) as usize)?;
    if crc32(id.iter().chain(encoded)) != u32::from_le_bytes(*crc) {
        return None;
    }
    let directory: Directory = postcard::from_bytes(encoded).ok()?;
    if !directory.is_sound() {
        return None;
    }
    let place = Place::new(&directory, encoded.len());
    let slots = [0, 1].map(|n| bytes.get(place.slots[n]..).and_then(|slot| read_slot(slot, &directory)));
    let newest = slots.into_iter().enumerate().filter_map(|(n, s)| Some((n, s?))).max_by_key(|(_, (save, _))| *save);
    // The first save is made before the file has its name, so there always is one.
    let (slot, (save, sets)) = newest?;
    Some(Old { id: *id, directory, sets, save, slot })
}

fn read_slot(slot: &[u8], directory: &Directory) -> Option<(u64, Vec<Set>)> {
    let body = slot.get(..slot_bytes(directory))?;
    let (save, rest) = body.split_first_chunk::<8>()?;
    let (crc, rest) = rest.split_first_chunk::<4>()?;
    if crc32(save.iter().chain(rest)) != u32::from_le_bytes(*crc) {
        return None;
    }
    let mut sets = empty_sets(directory);
    let (sequences, mut values) = rest.split_at_checked(8 * sets.len())?;
    for (set, sequence) in sets.iter_mut().zip(sequences.chunks_exact(8)) {
        set.sequence = u64::from_le_bytes(sequence.try_into().ok()?);
        let (own, others) = values.split_at_checked(set.values.len())?;
        set.values.copy_from_slice(own);
        values = others;
    }
    Some((u64::from_le_bytes(*save), sets))
}

fn slot_bytes(directory: &Directory) -> usize {
    let sets = directory.sets.iter().map(|s| 8 + s.bytes as usize);
    SLOT_HEAD_BYTES + sets.sum::<usize>()
}

/// Where the slots lie.
#[derive(Debug)]
struct Place {
    slots: [usize; 2],
}

impl Place {
    fn new(directory: &Directory, encoded_bytes: usize) -> Self {
        let first = (HEAD_BYTES + encoded_bytes).next_multiple_of(ALIGN);
        Self { slots: [first, first + slot_bytes(directory).next_multiple_of(ALIGN)] }
    }
}

/// The open file.
#[derive(Debug)]
pub struct Store<D> {
    disk: D,
    pub id: Id,
    /// As they were saved last.
    pub sets: Vec<Set>,
    /// The file may be older than `sets`.
    pub behind: bool,
    place: Place,
    save: u64,
    /// The slot that counts.
    slot: usize,
    /// A slot, reused.
    buffer: Vec<u8>,
}

impl Store<RealDisk> {
    /// Device and number of the file.
    pub fn identity(&self) -> (u64, u64) {
        self.disk.identity()
    }
}

impl<D: Disk> Store<D> {
    /// Goes on with a file of the same directory.
    pub fn resume(disk: D, old: &Old) -> Self {
        let encoded = postcard::to_stdvec(&old.directory).unwrap_or_default();
        let place = Place::new(&old.directory, encoded.len());
        // The caller may have put in newer values than the file's, which the next save writes.
        let (sets, buffer) = (old.sets.clone(), Vec::new());
        Self { disk, id: old.id, sets, behind: true, place, save: old.save, slot: old.slot, buffer }
    }

    /// Makes a file beside the old one, with its first save in it, and puts it in the old one's place.
    pub fn create(disk: D, directory: &Directory, sets: &[Set]) -> io::Result<Self> {
        Self::create_as(disk, directory, sets, new_id())
    }

    pub(super) fn create_as(mut disk: D, directory: &Directory, sets: &[Set], id: Id) -> io::Result<Self> {
        let encoded = postcard::to_stdvec(directory).unwrap_or_default();
        let place = Place::new(directory, encoded.len());
        let mut head = MAGIC.to_vec();
        head.extend((encoded.len() as u32).to_le_bytes());
        head.extend(crc32(id.iter().chain(&encoded)).to_le_bytes());
        head.extend(id);
        head.extend(&encoded);
        disk.create()?;
        disk.write_at(0, &head)?;
        // The first save goes to slot A.
        let mut store = Self { disk, id, sets: Vec::new(), behind: true, place, save: 0, slot: 1, buffer: Vec::new() };
        store.save(sets)?;
        store.disk.replace()?;
        Ok(store)
    }

    /// Writes the slot that does not count, which makes it count. After an error the same slot is the next to be written.
    pub fn save(&mut self, sets: &[Set]) -> io::Result<()> {
        let (save, slot) = (self.save + 1, 1 - self.slot);
        self.buffer.clear();
        self.buffer.extend(save.to_le_bytes());
        self.buffer.extend([0; 4]);
        sets.iter().for_each(|set| self.buffer.extend(set.sequence.to_le_bytes()));
        sets.iter().for_each(|set| self.buffer.extend(&set.values));
        let crc = crc32(self.buffer[..8].iter().chain(&self.buffer[SLOT_HEAD_BYTES..]));
        self.buffer[8..SLOT_HEAD_BYTES].copy_from_slice(&crc.to_le_bytes());
        self.disk.write_at(self.place.slots[slot] as u64, &self.buffer)?;
        self.disk.sync()?;
        (self.save, self.slot) = (save, slot);
        self.sets = sets.to_vec();
        self.behind = false;
        Ok(())
    }
}

fn new_id() -> Id {
    let mut id = [0; 16];
    // SAFETY: `id` has 16 writable bytes.
    let got = unsafe { libc::getrandom(id.as_mut_ptr().cast(), id.len(), 0) };
    if got != 16 {
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).map_or(0, |d| d.as_nanos());
        id = (now ^ u128::from(std::process::id()) << 96).to_le_bytes();
    }
    id
}

/// CRC-32 as in IEEE 802.3, reflected.
pub fn crc32<'a>(bytes: impl Iterator<Item = &'a u8>) -> u32 {
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

    #[test]
    fn the_check_value_of_crc32() {
        assert_eq!(crc32(b"123456789".iter()), 0xCBF4_3926);
    }
}
