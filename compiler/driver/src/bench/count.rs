//! Instructions of single cycles, counted by `valgrind --tool=callgrind`: the same in every run on every machine, whatever else
//! the machine does.
//!
//! The program starts itself under valgrind; that process ([`run`]) marks each cycle with client requests, which do nothing
//! outside valgrind, and its output file says what was executed between the marks. The emulated processor lacks the newest
//! vector instructions, so C for exactly this machine is not among the lanes.

use crate::bench::lane::{Cycle, Lane, OneTask, Rows};
use crate::bench::report::{Instructions, Report};
use plcc_runtime::engine::NativeEngine;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};
use std::rc::Rc;

/// Cycles that are counted, from the start on.
pub const CYCLES: u64 = 200;

/// By program and lane.
pub type Counts = BTreeMap<(String, String), Instructions>;

/// Starts this executable with `args`, with which it must [`run`] lanes, under valgrind; `None` where there is none.
pub fn count(args: &[&str], folder: &Path) -> Result<Option<Counts>, String> {
    if cfg!(not(target_arch = "x86_64")) || Command::new("valgrind").arg("--version").output().is_err() {
        return Ok(None);
    }
    let exe = std::env::current_exe().map_err(|e| e.to_string())?;
    let out = folder.join("callgrind.out");
    let done = Command::new("valgrind")
        .args(["--tool=callgrind", "--quiet", "--instr-atstart=no", "--collect-atstart=no"])
        .args(["--combine-dumps=yes", "--compress-strings=no", "--dump-line=no"])
        .arg(format!("--callgrind-out-file={}", out.display()))
        .arg(exe)
        .args(args)
        .stdout(Stdio::null())
        .output()
        .map_err(|e| format!("cannot start valgrind: {e}"))?;
    if !done.status.success() {
        return Err(format!("counting failed:\n{}", String::from_utf8_lossy(&done.stderr)));
    }
    let text = std::fs::read_to_string(&out).map_err(|e| format!("valgrind wrote nothing: {e}"))?;
    Ok(Some(read(&text)))
}

/// What a file of callgrind says: parts with a trigger `program|lane|cycle` and a total.
fn read(text: &str) -> Counts {
    let mut cycles: BTreeMap<(String, String), Vec<u64>> = BTreeMap::new();
    let mut mark = None;
    for line in text.lines() {
        if let Some(trigger) = line.strip_prefix("desc: Trigger: Client Request: ") {
            mark = Some(trigger.trim().to_string());
        } else if let Some(total) = line.strip_prefix("totals: ") {
            let Some(mark) = mark.take() else { continue };
            let mut parts = mark.split('|').map(str::to_string);
            if let (Some(program), Some(lane), Ok(total)) = (parts.next(), parts.next(), total.trim().parse()) {
                cycles.entry((program, lane)).or_default().push(total);
            }
        }
    }
    // What calling a lane takes, without its program.
    let empty = cycles.remove(&(EMPTY.into(), EMPTY.into())).and_then(|c| c.into_iter().min()).unwrap_or(0);
    let instructions = |totals: Vec<u64>| {
        let own = totals.iter().map(|t| t.saturating_sub(empty));
        let (sum, greatest) = own.fold((0, 0), |(sum, greatest), n| (sum + n, n.max(greatest)));
        let cycles = totals.len() as u64;
        Instructions { cycles, mean: sum as f64 / cycles.max(1) as f64, greatest }
    };
    cycles.into_iter().map(|(key, totals)| (key, instructions(totals))).collect()
}

/// Program and lane of an empty scan.
const EMPTY: &str = "empty";

/// What runs under valgrind: the lanes of a program.
pub fn run(program: &str, lanes: &mut [Lane], cycles: u64) {
    // What compiled the program is no business of callgrind: each dump would go through it.
    request(START_INSTRUMENTATION, 0);
    let mut empty = empty();
    empty.restart();
    (0..10).for_each(|cycle| marked(&mut empty, EMPTY, EMPTY, cycle));
    for lane in lanes {
        lane.subject.restart();
        (0..cycles).for_each(|cycle| marked(lane.subject.as_mut(), program, lane.name, cycle));
    }
    request(STOP_INSTRUMENTATION, 0);
}

/// Adds them to a report.
pub fn add(report: &mut Report, counts: &Counts) {
    for program in &mut report.programs {
        for lane in &mut program.lanes {
            lane.instructions = counts.get(&(program.name.clone(), lane.name.to_string())).copied();
        }
    }
    report.method.push(format!(
        "*Instructions*: callgrind counts every instruction of the first {CYCLES} cycles, cycle by cycle, libraries with it, less \
         those of an empty scan. The numbers are the same in every run."
    ));
}

fn marked(subject: &mut dyn Cycle, program: &str, lane: &str, cycle: u64) {
    subject.feed(cycle);
    let mark = format!("{program}|{lane}|{cycle}\0");
    request(TOGGLE_COLLECT, 0);
    let status = subject.execute(cycle);
    request(TOGGLE_COLLECT, 0);
    request(DUMP_STATS_AT, mark.as_ptr() as u64);
    assert_eq!(status, 0, "a program that is counted must not fault");
}

fn empty() -> OneTask<NativeEngine> {
    unsafe extern "C" fn init(_: *mut u8, _: i32) {}
    unsafe extern "C" fn scan(_: *mut u8, _: u32, _: i64) -> u32 {
        0
    }
    // SAFETY: they touch no memory.
    let engine = unsafe { NativeEngine::new(init, scan) };
    OneTask::new(engine, 64, Rows { offset: 0, bytes: 0, table: Rc::default() }, 1)
}

/// Requests of callgrind: `'C' << 24 | 'T' << 16`, then in the order of `callgrind.h`.
const TOGGLE_COLLECT: u64 = 0x4354_0002;
const DUMP_STATS_AT: u64 = 0x4354_0003;
const START_INSTRUMENTATION: u64 = 0x4354_0004;
const STOP_INSTRUMENTATION: u64 = 0x4354_0005;

/// A client request (`valgrind.h`); without valgrind it does nothing.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn request(request: u64, argument: u64) {
    let block = [request, argument, 0, 0, 0, 0];
    // SAFETY: the rotations of rdi add up to none, the exchange is of a register with itself; valgrind reads the block.
    unsafe {
        std::arch::asm!(
            "rol rdi, 3",
            "rol rdi, 13",
            "rol rdi, 61",
            "rol rdi, 51",
            "xchg rbx, rbx",
            in("rax") &raw const block,
            inout("rdx") 0u64 => _,
        );
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn request(_: u64, _: u64) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn totals_belong_to_the_mark_before_them_less_the_empty_scan() {
        let part =
            |mark: &str, total: u64| format!("part: 1\ndesc: Trigger: Client Request: {mark}\ntotals: {total}\n");
        let text = [
            part("empty|empty|0", 12),
            part("empty|empty|1", 10),
            part("a|jit|0", 110),
            part("a|jit|1", 210),
            "desc: Trigger: Program termination\ntotals: 99\n".to_string(),
        ];
        let counts = read(&text.concat());
        let expected = Instructions { cycles: 2, mean: 150.0, greatest: 200 };
        assert_eq!(counts.into_iter().collect::<Vec<_>>(), [(("a".into(), "jit".into()), expected)]);
    }
}
