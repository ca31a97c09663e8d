//! The reference engine: runs MIR as it stands. What it leaves in the region is what compiled code must leave.
//!
//! In: a verified [`Program`] and a region. Out: the region after a scan, and the fault number. Functions are decoded once
//! into flat lists of operations ([`decode`]) on a file of 64-bit registers; the frames of registers lie in one array whose
//! size follows from the call graph, so a scan allocates nothing and does not recurse.

mod decode;
mod exec;
mod op;

use crate::ir::{FuncId, Part, Program};
use op::Code;
use plcc_stdlib::region::{CLOCK_NS, FAULT_CODE, HEADER_BYTES};
use std::ops::Range;

/// A program ready to run, and the registers it runs in.
pub struct Interp {
    code: Code,
    tasks: Vec<FuncId>,
    region_bytes: usize,
    /// By task.
    parts: Vec<Part>,
    cold: Vec<InitStep>,
    warm: Vec<InitStep>,
    registers: Vec<u64>,
    calls: Vec<exec::Activation>,
}

impl Interp {
    /// Decodes a program, which must be free of problems ([`verify`](crate::verify::verify)).
    pub fn new(program: &Program) -> Self {
        let (code, depth) = decode::decode(program);
        Self {
            registers: vec![0; depth.registers],
            calls: Vec::with_capacity(depth.calls),
            code,
            tasks: program.tasks.clone(),
            region_bytes: program.region_bytes as usize,
            parts: (0..program.tasks.len()).map(|n| program.part_of_task(n)).collect(),
            cold: init_steps(program, true),
            warm: init_steps(program, false),
        }
    }

    /// Bytes of the region.
    pub fn region_bytes(&self) -> usize {
        self.region_bytes
    }

    /// Number of tasks.
    pub fn task_count(&self) -> u32 {
        self.tasks.len() as u32
    }

    /// Sets all variables to their initial values; a warm start (`cold` FALSE) keeps the retain ranges.
    ///
    /// # Panics
    /// If `mem` is shorter than the region.
    pub fn init(&mut self, mem: &mut [u8], cold: bool) {
        for step in if cold { &self.cold } else { &self.warm } {
            let (at, end) = (step.offset as usize, step.offset as usize + step.length as usize);
            match &step.bytes {
                Some(bytes) => mem[at..end].copy_from_slice(bytes),
                None => mem[at..end].fill(0),
            }
        }
    }

    /// Executes a task once at a time of the scan clock. 0, or the number of the fault whose record the header then holds.
    /// A task that does not exist does nothing.
    ///
    /// # Panics
    /// If `mem` is shorter than the region or not aligned to 4 bytes, and on code that leaves the region (a compiler bug).
    pub fn scan(&mut self, mem: &mut [u8], task: u32, now_ns: i64) -> u32 {
        let Some(part) = self.parts.get(task as usize) else { return 0 };
        let (start, bytes) = (part.start as usize, part.bytes.max(HEADER_BYTES) as usize);
        self.scan_part(&mut mem[start..start + bytes], task, now_ns)
    }

    /// The same with the part of the task's resource alone.
    ///
    /// # Panics
    /// As [`Interp::scan`].
    pub fn scan_part(&mut self, mem: &mut [u8], task: u32, now_ns: i64) -> u32 {
        self.execute::<false>(mem, task, now_ns).0
    }

    /// The same, and how many operations it took.
    ///
    /// # Panics
    /// As [`Interp::scan`].
    pub fn scan_counted(&mut self, mem: &mut [u8], task: u32, now_ns: i64) -> (u32, u64) {
        self.execute::<true>(mem, task, now_ns)
    }

    fn execute<const COUNT: bool>(&mut self, mem: &mut [u8], task: u32, now_ns: i64) -> (u32, u64) {
        let Some(&entry) = self.tasks.get(task as usize) else { return (0, 0) };
        let part = self.parts[task as usize];
        let mem = &mut mem[..part.bytes.max(HEADER_BYTES) as usize];
        mem[CLOCK_NS as usize..][..8].copy_from_slice(&now_ns.to_le_bytes());
        mem[FAULT_CODE as usize..][..4].fill(0);
        let (registers, calls, mut operations) = (&mut self.registers, &mut self.calls, 0);
        let status = exec::run::<COUNT>(&self.code, registers, calls, mem, entry, part.frame_base, &mut operations);
        (status, operations)
    }
}

/// A step of the initialisation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InitStep {
    /// Where in the region.
    pub offset: u32,
    /// How many bytes.
    pub length: u32,
    /// The bytes; `None` for zeros.
    pub bytes: Option<Vec<u8>>,
}

/// What initialises a region: a cold start sets everything, a warm one everything but the retain ranges. The code
/// generator makes its table of the same steps.
pub fn init_steps(program: &Program, cold: bool) -> Vec<InitStep> {
    let kept: &[(u32, u32)] = if cold { &[] } else { &program.retain };
    let mut steps = Vec::new();
    for range in without(0..program.region_bytes, kept) {
        steps.push(InitStep { offset: range.start, length: range.end - range.start, bytes: None });
    }
    for segment in &program.initial {
        let end = segment.offset + segment.bytes.len() as u32;
        for range in without(segment.offset..end, kept) {
            let bytes = &segment.bytes[(range.start - segment.offset) as usize..(range.end - segment.offset) as usize];
            steps.push(InitStep { offset: range.start, length: bytes.len() as u32, bytes: Some(bytes.to_vec()) });
        }
    }
    steps
}

/// The parts of `range` outside the ranges (start, length), which are sorted and disjoint.
fn without(range: Range<u32>, kept: &[(u32, u32)]) -> Vec<Range<u32>> {
    let mut parts = Vec::new();
    let mut at = range.start;
    let first = kept.partition_point(|(start, length)| start + length <= range.start);
    for (start, length) in &kept[first..] {
        if *start >= range.end {
            break;
        }
        if *start > at {
            parts.push(at..*start);
        }
        at = start + length;
    }
    if at < range.end {
        parts.push(at..range.end);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kept_ranges_are_cut_out() {
        let kept = [(10, 5), (15, 5), (30, 10)];
        assert_eq!(without(0..50, &kept), [0..10, 20..30, 40..50]);
        assert_eq!(without(12..35, &kept), vec![20..30; 1]);
        assert_eq!(without(10..20, &kept), []);
        assert_eq!(without(40..40, &kept), []);
        assert_eq!(without(35..41, &kept), vec![40..41; 1]);
        assert_eq!(without(3..8, &[]), vec![3..8; 1]);
    }
}
