//! %I and %Q in shared memory that another process maps (docs/cli.md, "I/O drivers", has the layout).
//!
//! ```text
//!   0  8 bytes  magic "plccshm1"
//!   8  u32      bytes of %I       12  u32  bytes of %Q
//!  16  u32      offset of the input block    20  u32  offset of the output block
//!  24  u32      offset of the force mask of %I    28  u32  offset of the force mask of %Q
//!  32  u32      1 while the program runs     36  u32  process id
//!  40  u64      cycles begun
//! input block:   u32 sequence, u32 0, %I bytes           written by the other process
//! output block:  u32 sequence, u32 0, %Q bytes           written by the program
//! force masks:   %I (%Q) mask bytes, then as many value bytes; a bit of the mask forces that bit to the value's
//! ```
//! A writer makes the sequence odd, writes, makes it even again; a reader that finds it odd or changed has nothing and tries
//! later. So no side ever waits, and no value is torn. Blocks are aligned to 64 bytes; numbers are in the machine's order.

use super::IoDriver;
use crate::image::Image;
use std::ffi::CString;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering, fence};

const MAGIC: &[u8; 8] = b"plccshm1";
const HEADER_BYTES: usize = 64;
const BLOCK_HEAD_BYTES: usize = 8;
const RUNNING_AT: usize = 32;
const CYCLES_AT: usize = 40;
/// A block that is being written is tried so often; then the inputs of before count.
const TRIES: usize = 8;

pub struct Shm {
    base: *mut u8,
    bytes: usize,
    inputs: Block,
    outputs: Block,
    /// Inputs as they were read last, and a place to read them to.
    last: Vec<u8>,
    fresh: Vec<u8>,
    forced: Vec<u8>,
    _file: std::fs::File,
}

#[derive(Clone, Copy)]
struct Block {
    at: usize,
    mask_at: usize,
    bytes: usize,
}

// SAFETY: the mapping belongs to the process, and its contents are accessed through this value only.
unsafe impl Send for Shm {}

impl Shm {
    /// Makes `/dev/shm/NAME`, or takes over what an earlier run left there.
    pub fn open(name: &str, image: &Image) -> Result<Self, (u8, String)> {
        let name = name.trim_start_matches('/');
        if name.is_empty() || name.contains('/') {
            return Err((2, "--io shm: needs a name without slashes: shm:mixer".into()));
        }
        let fail = |e: std::io::Error| (3, format!("cannot use shared memory `{name}`: {e}"));
        let [(_, in_bytes), (_, out_bytes), _] = image.areas.map(|(a, b)| (a as usize, b as usize));
        let align = |n: usize| n.next_multiple_of(64);
        let inputs = HEADER_BYTES;
        let outputs = align(inputs + BLOCK_HEAD_BYTES + in_bytes);
        let in_mask = align(outputs + BLOCK_HEAD_BYTES + out_bytes);
        let out_mask = align(in_mask + 2 * in_bytes);
        let bytes = align(out_mask + 2 * out_bytes);
        let path = CString::new(format!("/{name}")).map_err(|_| (2, "--io shm: a name without NUL".to_string()))?;
        // SAFETY: `path` is a C string.
        let fd = unsafe { libc::shm_open(path.as_ptr(), libc::O_RDWR | libc::O_CREAT, 0o660) };
        if fd < 0 {
            return Err(fail(std::io::Error::last_os_error()));
        }
        // SAFETY: the descriptor was just opened and belongs to nobody else.
        let file = unsafe { <std::fs::File as std::os::fd::FromRawFd>::from_raw_fd(fd) };
        match file.try_lock() {
            Ok(()) => {}
            Err(std::fs::TryLockError::WouldBlock) => {
                return Err((3, format!("shared memory `{name}` is used by another program that runs")));
            }
            Err(std::fs::TryLockError::Error(e)) => return Err(fail(e)),
        }
        file.set_len(bytes as u64).map_err(fail)?;
        // SAFETY: a new mapping of `bytes` bytes of a file that has them.
        let base = unsafe {
            libc::mmap(std::ptr::null_mut(), bytes, libc::PROT_READ | libc::PROT_WRITE, libc::MAP_SHARED, fd, 0)
        };
        if base == libc::MAP_FAILED {
            return Err(fail(std::io::Error::last_os_error()));
        }
        let mut shm = Self {
            base: base.cast(),
            bytes,
            inputs: Block { at: inputs, mask_at: in_mask, bytes: in_bytes },
            outputs: Block { at: outputs, mask_at: out_mask, bytes: out_bytes },
            last: vec![0; in_bytes],
            fresh: vec![0; in_bytes],
            forced: vec![0; out_bytes],
            _file: file,
        };
        let head: [(usize, u32); 6] = [
            (8, in_bytes as u32),
            (12, out_bytes as u32),
            (16, inputs as u32),
            (20, outputs as u32),
            (24, in_mask as u32),
            (28, out_mask as u32),
        ];
        let same = shm.copy(0, 8) == MAGIC && head.iter().all(|(at, v)| shm.word(*at).load(Ordering::Relaxed) == *v);
        if !same {
            // Of another program, or new: nothing in it counts, forces least of all.
            // SAFETY: inside the mapping.
            unsafe { std::ptr::write_bytes(shm.base, 0, bytes) };
            for (at, value) in head {
                shm.word(at).store(value, Ordering::Relaxed);
            }
        }
        shm.word(RUNNING_AT + 4).store(std::process::id(), Ordering::Relaxed);
        shm.word(RUNNING_AT).store(1, Ordering::Relaxed);
        // The magic comes last: who sees it sees the rest.
        fence(Ordering::Release);
        // SAFETY: inside the mapping.
        unsafe { std::ptr::copy_nonoverlapping(MAGIC.as_ptr(), shm.base, MAGIC.len()) };
        shm.touch();
        Ok(shm)
    }

    /// Every page, so that none is touched for the first time in a cycle.
    fn touch(&mut self) {
        for at in (0..self.bytes).step_by(4096) {
            // SAFETY: inside the mapping; adding 0 changes nothing.
            unsafe { AtomicU32::from_ptr(self.base.add(at).cast()) }.fetch_add(0, Ordering::Relaxed);
        }
    }

    fn word(&self, at: usize) -> &AtomicU32 {
        debug_assert!(at.is_multiple_of(4) && at + 4 <= self.bytes);
        // SAFETY: inside the mapping, aligned as the mapping is to a page.
        unsafe { AtomicU32::from_ptr(self.base.add(at).cast()) }
    }

    fn copy(&self, at: usize, bytes: usize) -> Vec<u8> {
        let mut out = vec![0; bytes];
        self.copy_out(at, &mut out);
        out
    }

    /// Bytes that another process may be writing: what they are worth is for the sequence to say.
    fn copy_out(&self, at: usize, to: &mut [u8]) {
        debug_assert!(at + to.len() <= self.bytes);
        // SAFETY: inside the mapping, and `to` is memory of this process.
        unsafe { std::ptr::copy_nonoverlapping(self.base.add(at), to.as_mut_ptr(), to.len()) };
    }

    /// Applies a force mask to bytes.
    fn force(&self, block: Block, bytes: &mut [u8]) {
        for (n, byte) in bytes.iter_mut().enumerate().take(block.bytes) {
            // SAFETY: both lie inside the mapping.
            let (mask, value) = unsafe {
                let mask = self.base.add(block.mask_at + n);
                (mask.read_volatile(), mask.add(block.bytes).read_volatile())
            };
            *byte = *byte & !mask | value & mask;
        }
    }
}

impl IoDriver for Shm {
    fn begin(&mut self, cycle: u64) {
        // SAFETY: inside the header, aligned.
        unsafe { AtomicU64::from_ptr(self.base.add(CYCLES_AT).cast()) }.store(cycle, Ordering::Relaxed);
    }

    fn read(&mut self, inputs: &mut [u8]) -> Result<(), String> {
        let block = self.inputs;
        let mut fresh = std::mem::take(&mut self.fresh);
        for _ in 0..TRIES {
            let before = self.word(block.at).load(Ordering::Acquire);
            if before.is_multiple_of(2) {
                self.copy_out(block.at + BLOCK_HEAD_BYTES, &mut fresh);
                fence(Ordering::Acquire);
                if self.word(block.at).load(Ordering::Relaxed) == before {
                    self.last.copy_from_slice(&fresh);
                    break;
                }
            }
            std::hint::spin_loop();
        }
        self.fresh = fresh;
        inputs.copy_from_slice(&self.last);
        self.force(block, inputs);
        Ok(())
    }

    fn write(&mut self, outputs: &[u8]) -> Result<(), String> {
        let block = self.outputs;
        let mut forced = std::mem::take(&mut self.forced);
        forced.copy_from_slice(outputs);
        self.force(block, &mut forced);
        let sequence = self.word(block.at).load(Ordering::Relaxed) | 1;
        self.word(block.at).store(sequence, Ordering::Relaxed);
        fence(Ordering::Release);
        // SAFETY: inside the mapping, which is no other memory of this process.
        unsafe {
            let to = self.base.add(block.at + BLOCK_HEAD_BYTES);
            std::ptr::copy_nonoverlapping(forced.as_ptr(), to, block.bytes);
        }
        self.word(block.at).store(sequence.wrapping_add(1), Ordering::Release);
        self.forced = forced;
        Ok(())
    }
}

impl Drop for Shm {
    /// The memory stays for the other process; it sees that nobody runs.
    fn drop(&mut self) {
        self.word(RUNNING_AT).store(0, Ordering::Release);
        // SAFETY: mapped by `open`, used by nobody any more.
        unsafe { libc::munmap(self.base.cast(), self.bytes) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_forces_and_halves_of_writes() {
        let name = format!("plcc-test-{}", std::process::id());
        let image = Image { areas: [(64, 8), (72, 16), (88, 0)], ..Image::default() };
        let mut shm = Shm::open(&name, &image).unwrap();
        assert_eq!(Shm::open(&name, &image).err().map(|e| e.0), Some(3), "two programs on one memory");
        let (at, out) = (shm.inputs.at, shm.outputs.at);
        let mut inputs = [9; 8];
        shm.read(&mut inputs).unwrap();
        assert_eq!(inputs, [0; 8]);
        let poke = |shm: &Shm, at: usize, value: u8| unsafe { shm.base.add(at).write_volatile(value) };
        // The other process is in the middle of a write: the old inputs count.
        shm.word(at).store(1, Ordering::Relaxed);
        poke(&shm, at + 8, 7);
        shm.read(&mut inputs).unwrap();
        assert_eq!(inputs[0], 0);
        shm.word(at).store(2, Ordering::Relaxed);
        shm.read(&mut inputs).unwrap();
        assert_eq!(inputs[0], 7);
        // Bit 1 of byte 0 forced to 0, bit 3 to 1.
        poke(&shm, shm.inputs.mask_at, 0b1010);
        poke(&shm, shm.inputs.mask_at + 8, 0b1000);
        shm.read(&mut inputs).unwrap();
        assert_eq!(inputs[0], 0b1101);
        shm.write(&[5; 16]).unwrap();
        assert_eq!(shm.copy(out + 8, 16), [5; 16]);
        assert_eq!(shm.word(out).load(Ordering::Relaxed), 2);
        drop(shm);
        // Another size: nothing of it counts.
        let shm = Shm::open(&name, &Image { areas: [(64, 16), (80, 8), (88, 0)], ..Image::default() }).unwrap();
        assert_eq!(shm.copy(shm.inputs.mask_at, 32), [0; 32]);
        drop(shm);
        let path = CString::new(format!("/{name}")).unwrap();
        unsafe { libc::shm_unlink(path.as_ptr()) };
    }
}
