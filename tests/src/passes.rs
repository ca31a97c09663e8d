//! Do the passes of the optimiser keep the meaning of a program? The interpreter runs it before and after every row of the
//! table of passes, native code (JIT) after the last one.
//!
//! What must be equal after every scan: the status, the region behind the header but for the frames, which no one sees, and
//! after a fault its record. Source rows are compared by what they say: a pass that copies code may make new ones.

use super::memory::{bytes_of, difference, excerpt, region};
use plcc_mir::interp::Interp;
use plcc_mir::ir::{Program, SourceId};
use plcc_mir::opt::Pass;
use plcc_stdlib::region::{DEADLINE_FLAG, FAULT_INSTANCE, FAULT_OPERANDS, FAULT_SOURCE, HEADER_BYTES};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

const TICK_NS: i64 = 10_000_000;

/// Which pass broke a program, and how.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Disagreement {
    /// Row and name; `native code` behind the last row.
    pub pass: String,
    /// What differs.
    pub what: String,
}

impl std::fmt::Display for Disagreement {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.pass, self.what)
    }
}

/// How a program is run: task 0, once per cycle, also after a fault.
pub struct Run<'a> {
    /// How often.
    pub cycles: usize,
    /// What is written into the region before a cycle.
    pub inputs: &'a (dyn Fn(usize, &mut [u8]) + Sync),
    /// Whether native code runs too.
    pub native: bool,
    /// After this time the watchdog's flag is set, so that nothing hangs: a reduced program may loop for ever, and so may
    /// what a wrong pass makes.
    pub patience: Duration,
}

/// What is seen after a cycle.
struct Seen {
    status: u32,
    /// Position, POU and name of the source row, instance and operands of a fault.
    fault: String,
    memory: Vec<u8>,
}

/// Runs a program; `scan` executes one cycle. Gives nothing if that took too long.
fn run(
    program: &Program,
    run: &Run,
    init: impl FnOnce(&mut [u8]),
    mut scan: impl FnMut(&mut [u8], i64) -> u32,
) -> Vec<Seen> {
    let size = program.region_bytes as usize;
    let mut lines = region(size);
    let mem = &mut bytes_of(&mut lines)[..size];
    init(mem);
    // SAFETY: it lies at the beginning of the region, aligned, and the region outlives the scope.
    let flag = unsafe { AtomicU32::from_ptr(mem.as_mut_ptr().add(DEADLINE_FLAG as usize).cast()) };
    std::thread::scope(|s| {
        let (done, wait) = mpsc::channel::<()>();
        let watchdog = s.spawn(move || {
            let late = wait.recv_timeout(run.patience) == Err(RecvTimeoutError::Timeout);
            if late {
                flag.store(1, Ordering::Relaxed);
            }
            late
        });
        let mut seen = Vec::new();
        for cycle in 0..run.cycles {
            (run.inputs)(cycle, mem);
            let status = scan(mem, cycle as i64 * TICK_NS);
            let fault = if status == 0 { String::new() } else { record(program, mem) };
            let memory = mem[HEADER_BYTES as usize..program.frame_base as usize].to_vec();
            seen.push(Seen { status, fault, memory });
        }
        drop(done);
        if watchdog.join().unwrap_or(true) { Vec::new() } else { seen }
    })
}

fn record(program: &Program, mem: &[u8]) -> String {
    let word = |at: u32| u32::from_le_bytes(*mem[at as usize..].first_chunk().expect("the header"));
    let number =
        |n: u32| i64::from_le_bytes(*mem[(FAULT_OPERANDS + 8 * n) as usize..].first_chunk().expect("the header"));
    let source = match program.sources.get(SourceId::from_raw(word(FAULT_SOURCE))) {
        Some(row) => format!("{:?} of `{}`, `{}`", row.span, row.pou, row.what),
        None => "no row of the source table".into(),
    };
    // Frames of bodies that were put in lie elsewhere.
    let instance = match word(FAULT_INSTANCE) {
        offset if offset >= program.frame_base => "in a frame".to_string(),
        offset => offset.to_string(),
    };
    format!("{source}, instance {instance}, operands {:?}", [number(0), number(1), number(2)])
}

fn interpret(program: &Program, how: &Run) -> Vec<Seen> {
    let mut interp = Interp::new(program);
    let mut other = Interp::new(program);
    run(program, how, |mem| other.init(mem, true), |mem, now| interp.scan(mem, 0, now))
}

fn native(program: &Program, how: &Run) -> Result<Vec<Seen>, String> {
    let code = plcc_codegen::jit::compile(program).map_err(|e| format!("{e:?}"))?;
    Ok(run(program, how, |mem| code.init(mem, true), |mem, now| code.scan(mem, 0, now)))
}

fn same(before: &[Seen], after: &[Seen]) -> Result<(), String> {
    if before.len() != after.len() {
        return Err("runs too long".into());
    }
    for (cycle, (x, y)) in before.iter().zip(after).enumerate() {
        let cycle = cycle + 1;
        if x.status != y.status {
            return Err(format!("cycle {cycle}: status {}, was {}; {}{}", y.status, x.status, x.fault, y.fault));
        }
        if x.fault != y.fault {
            return Err(format!("cycle {cycle}: fault {}: {}; was {}", x.status, y.fault, x.fault));
        }
        if let Some(at) = difference(&x.memory, &y.memory) {
            return Err(format!(
                "cycle {cycle} (status {}): byte {} is {}, was {}",
                x.status,
                at + HEADER_BYTES as usize,
                excerpt(&y.memory, at),
                excerpt(&x.memory, at)
            ));
        }
    }
    Ok(())
}

/// Runs a verified program before and after each pass. Gives how many cycles ended with a fault.
pub fn agree(program: &Program, passes: &[Pass], how: &Run) -> Result<usize, Disagreement> {
    let before = interpret(program, how);
    if before.is_empty() {
        return Err(Disagreement { pass: "none".into(), what: "runs too long".into() });
    }
    let mut program = program.clone();
    for (row, pass) in passes.iter().enumerate() {
        let fail = |what: String| Disagreement { pass: format!("pass {row} `{}`", pass.name), what };
        // A pass may find a bug of its own, and what it made may lead the interpreter out of the region.
        let result = catch_unwind(AssertUnwindSafe(|| {
            (pass.run)(&mut program);
            if let Some(first) = plcc_mir::verify::verify(&program).first() {
                return Err(format!("verifier: {first}"));
            }
            same(&before, &interpret(&program, how))
        }));
        result.unwrap_or_else(|_| Err("panics".into())).map_err(fail)?;
    }
    if how.native {
        let fail = |what| Disagreement { pass: "native code".into(), what };
        same(&before, &native(&program, how).map_err(fail)?).map_err(fail)?;
    }
    Ok(before.iter().filter(|seen| seen.status != 0).count())
}

/// Runs a verified program in the interpreter, and as native code after all passes. Gives whether it ended with a fault.
pub fn native_agrees(program: &Program, passes: &[Pass], how: &Run) -> Result<bool, String> {
    let before = interpret(program, how);
    let mut optimised = program.clone();
    passes.iter().for_each(|pass| (pass.run)(&mut optimised));
    same(&before, &native(&optimised, how)?)?;
    Ok(before.iter().any(|seen| seen.status != 0))
}

/// The status of each cycle in the interpreter, which must be that of native code if that runs too.
pub fn statuses(program: &Program, how: &Run) -> Vec<u32> {
    let list = |seen: Vec<Seen>| seen.iter().map(|s| s.status).collect::<Vec<u32>>();
    let statuses = list(interpret(program, how));
    if how.native {
        assert_eq!(native(program, how).map(list), Ok(statuses.clone()), "native code");
    }
    statuses
}
