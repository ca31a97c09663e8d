//! Differential test: random programs give the same memory, byte for byte, in the interpreter and in native code (JIT, every
//! second one after the optimiser), and the same trace when many of them are linked into one executable.
//!
//! `RANDOM_PROGRAMS` (default 400) says how many for interpreter against JIT, `RANDOM_LINKED` (default 60) how many for the
//! linked batches, `RANDOM_TEXTS` (default 150) how many for work on strings, `RANDOM_PASSES` (default 80) how many for the passes of the optimiser, `RANDOM_SEED` where to start. A
//! failure prints the seed and the program.

mod generate;
mod il;
mod lanes;
mod loops;
mod passes;
mod texts;

use plcc_hir::Profile;
use plcc_tests::passes::{Run, native_agrees};
use plcc_tests::{command, compile::compile};
use std::path::Path;
use std::time::Duration;

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");
const RUN: Run = Run { cycles: 12, inputs: &|_, _| {}, native: true, patience: Duration::from_secs(60) };

fn setting(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}

/// How a program ran.
#[derive(Debug, PartialEq, Eq, Clone, Copy)]
enum Outcome {
    Finished,
    Fault,
}

/// Runs one program on both engines, native code after the optimiser if asked; `Err` says where they part.
fn both_engines(text: &str, optimised: bool) -> Result<Outcome, String> {
    let program = compile(text, Profile::Strict)?;
    let passes = if optimised { plcc_mir::opt::passes() } else { &[] };
    let fault = native_agrees(&program, passes, &RUN)?;
    Ok(if fault { Outcome::Fault } else { Outcome::Finished })
}

/// Work on a thread with the stack that the driver has.
fn deep<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    std::thread::scope(|s| {
        let thread = std::thread::Builder::new().stack_size(256 << 20).spawn_scoped(s, work);
        thread.expect("a thread starts").join().unwrap_or_else(|e| std::panic::resume_unwind(e))
    })
}

/// Work on seeds, by as many threads as there are processors.
fn shared_out<T: Send>(seeds: std::ops::Range<u64>, work: impl Fn(u64) -> T + Sync) -> Vec<T> {
    let workers = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
    let (work, seeds) = (&work, &seeds);
    std::thread::scope(|s| {
        let threads: Vec<_> = (0..workers)
            .map(|w| {
                let own = move || (seeds.start + w..seeds.end).step_by(workers as usize).map(work).collect::<Vec<T>>();
                std::thread::Builder::new().stack_size(256 << 20).spawn_scoped(s, own).expect("a thread starts")
            })
            .collect();
        threads.into_iter().flat_map(|t| t.join().unwrap_or_else(|e| std::panic::resume_unwind(e))).collect()
    })
}

fn source(body: &str) -> String {
    format!("{}{body}", generate::SHARED)
}

#[test]
fn interpreter_and_jit_agree() {
    let (count, first) = (setting("RANDOM_PROGRAMS", 400), setting("RANDOM_SEED", 1));
    let totals = shared_out(first..first + count, |seed| {
        let text = source(&generate::program(seed, "", true));
        match both_engines(&text, seed % 2 == 0) {
            Ok(Outcome::Finished) => (1, 0),
            Ok(Outcome::Fault) => (0, 1),
            Err(e) => {
                // Which pass it is, and the smallest program that shows it.
                passes::judge(seed, &text);
                panic!("seed {seed}: {e}\n{text}")
            }
        }
    });
    let finished: u64 = totals.iter().map(|t| t.0).sum();
    let faults: u64 = totals.iter().map(|t| t.1).sum();
    println!("{finished} programs finished, {faults} stopped with the same fault");
    assert_eq!(finished + faults, count);
    // The generator must neither fault all the time nor never.
    if count >= 200 {
        assert!(finished > count / 4 && faults > 0, "{finished} finished, {faults} faults");
    }
}

/// Programs that did not fault alone, many in one executable: one CONFIGURATION, one task, one trace of all variables.
#[test]
fn linked_batches_agree_with_the_interpreter() {
    let (count, first) = (setting("RANDOM_LINKED", 60), setting("RANDOM_SEED", 1) + 1_000_000);
    let batch = setting("RANDOM_BATCH", 300).min(count).max(1);
    let mut seed = first;
    let mut left = count;
    while left > 0 {
        let size = left.min(batch);
        left -= size;
        let mut text = generate::SHARED.to_string();
        let mut instances = String::new();
        let mut taken = 0;
        while taken < size {
            let alone = source(&generate::program(seed, "", false));
            if deep(|| both_engines(&alone, true)).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{alone}"))
                == Outcome::Finished
            {
                let prefix = format!("P{taken}_");
                text.push_str(&generate::program(seed, &prefix, false));
                instances.push_str(&format!("  PROGRAM I{taken} WITH T : {prefix}Main;\n"));
                taken += 1;
            }
            seed += 1;
        }
        text.push_str(&format!(
            "CONFIGURATION C\n RESOURCE R ON PLC\n  TASK T(INTERVAL := T#10ms, PRIORITY := 1);\n{instances} END_RESOURCE\nEND_CONFIGURATION\n"
        ));
        linked(&text, seed);
    }
}

fn linked(text: &str, seed: u64) {
    let folder = tempfile::tempdir().expect("a folder for the batch");
    let path = folder.path();
    std::fs::write(path.join("batch.st"), text).expect("the source is written");
    let flags = ["--virtual-time", "--cycles", "12", "--trace", "-"];
    let run = |engine: &str| {
        let args = [&["run", "batch.st", "--engine", engine, "--message-format", "short"], &flags[..]].concat();
        command(Path::new(PLCC), path, &args)
    };
    let interp = run("interp");
    assert_eq!(interp.code, 0, "batch before seed {seed}: {}", tail(&interp.stderr));
    let built = command(Path::new(PLCC), path, &["build", "batch.st", "-o", "batch", "--message-format", "short"]);
    assert_eq!(built.code, 0, "batch before seed {seed}: {}", tail(&built.stderr));
    let native = command(&path.join("batch"), path, &flags);
    assert_eq!(native.code, 0, "batch before seed {seed}: {}", native.stderr);
    assert!(interp.stdout.lines().count() == 13, "{} lines", interp.stdout.lines().count());
    if interp.stdout != native.stdout {
        let keep = std::env::temp_dir().join("plcc-batch.st");
        let _ = std::fs::write(&keep, text);
        let (x, y) = first_difference(&interp.stdout, &native.stdout);
        panic!("batch before seed {seed} (kept as {}): interpreter {x}, linked {y}", keep.display());
    }
}

fn tail(text: &str) -> String {
    let lines: Vec<&str> = text.lines().filter(|l| l.contains("error")).collect();
    lines.iter().take(10).map(|l| format!("{l}\n")).collect()
}

/// Header and value of the first cell in which two traces differ.
fn first_difference(a: &str, b: &str) -> (String, String) {
    let header: Vec<&str> = a.lines().next().unwrap_or_default().split(',').collect();
    for (x, y) in a.lines().zip(b.lines()) {
        for (n, (p, q)) in x.split(',').zip(y.split(',')).enumerate() {
            if p != q {
                let name = header.get(n).copied().unwrap_or("?");
                return (format!("{name} = {p}"), format!("{name} = {q}"));
            }
        }
    }
    ("ends".into(), "ends elsewhere".into())
}

/// What the differential test is about: it covers these forms, in a few hundred programs.
#[test]
fn the_generator_uses_every_form() {
    let text: String = (1..300).map(|seed| generate::program(seed, "", true)).collect();
    for form in [
        "REF_TO STRING[",
        "ref0^ := ",
        "ref0 ?= ",
        ":= NULL;",
        "ptr^[",
        "open := ",
        "UPPER_BOUND(open, 1)]",
        "fbs[3](",
        "nest.m[2].b := ",
        "R_EDGE",
        "ENO => ",
        "CONCAT(",
        "_TO_STRING(",
        "DINT_TO_TIME(",
        "CASE ",
        "WHILE ",
        "FOR ",
        ".act();",
        "s := t;",
        "rest := DELETE(rest, FIND(rest, 'a'), 1);",
        ":= LEFT(rest, FIND(rest, 'b') - 1);",
        ":= LEFT(rest, 2) = ",
        ":= LEN(rest);",
    ] {
        assert!(text.contains(form), "no program uses `{form}`");
    }
}
