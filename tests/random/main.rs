//! Differential test: random programs give the same memory, byte for byte, in the interpreter and in native code (JIT), and
//! the same trace when many of them are linked into one executable.
//!
//! `RANDOM_PROGRAMS` (default 400) says how many for interpreter against JIT, `RANDOM_LINKED` (default 60) how many for the
//! linked batches, `RANDOM_SEED` where to start. A failure prints the seed and the program.

mod generate;
mod il;

use plcc_hir::Profile;
use plcc_mir::interp::Interp;
use plcc_tests::{command, compile::compile};
use std::path::Path;

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");
const CYCLES: i64 = 12;
const TICK_NS: i64 = 10_000_000;

fn setting(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}

/// A region with the alignment that compiled code expects.
#[repr(C, align(64))]
#[derive(Clone, Copy)]
struct Line([u8; 64]);

fn region(bytes: usize) -> Vec<Line> {
    vec![Line([0; 64]); bytes.div_ceil(64)]
}

fn bytes_of(lines: &mut [Line]) -> &mut [u8] {
    let (pointer, length) = (lines.as_mut_ptr(), lines.len() * 64);
    // SAFETY: a Line is 64 plain bytes.
    unsafe { std::slice::from_raw_parts_mut(pointer.cast(), length) }
}

/// How a program ran.
#[derive(Debug, PartialEq, Eq, Clone, Copy)]
enum Outcome {
    Finished,
    Fault(u32),
}

/// Runs one program on both engines; `Err` says where they part.
fn both_engines(text: &str) -> Result<Outcome, String> {
    let program = compile(text, Profile::Strict)?;
    let mut interp = Interp::new(&program);
    let code = plcc_codegen::jit::compile(&program).map_err(|e| format!("{e:?}"))?;
    let size = program.region_bytes as usize;
    let (mut a, mut b) = (region(size), region(size));
    let (a, b) = (&mut bytes_of(&mut a)[..size], &mut bytes_of(&mut b)[..size]);
    interp.init(a, true);
    code.init(b, true);
    same(a, b, &program, "after the cold start")?;
    for cycle in 1..=CYCLES {
        let now = (cycle - 1) * TICK_NS;
        let x = interp.scan(a, 0, now);
        let y = code.scan(b, 0, now);
        if x != y {
            return Err(format!("cycle {cycle}: the interpreter gives {x}, native code {y}"));
        }
        same(a, b, &program, &format!("after cycle {cycle} (status {x})"))?;
        if x != 0 {
            return Ok(Outcome::Fault(x));
        }
    }
    Ok(Outcome::Finished)
}

/// Compares whole regions. Sign and payload of a NaN are not defined: words that are NaN in both count as equal.
fn same(a: &[u8], b: &[u8], program: &plcc_mir::ir::Program, when: &str) -> Result<(), String> {
    let mut at = 0;
    while at < a.len() {
        if a[at] == b[at] {
            at += 1;
            continue;
        }
        let nan = |width: usize| {
            let start = at / width * width;
            let word = |m: &[u8]| m.get(start..start + width).map(|w| w.to_vec());
            let is_nan = |w: Option<Vec<u8>>| match w.as_deref() {
                Some([x, y, z, w]) => f32::from_le_bytes([*x, *y, *z, *w]).is_nan(),
                Some(w) if w.len() == 8 => w.try_into().is_ok_and(|w| f64::from_le_bytes(w).is_nan()),
                _ => false,
            };
            (is_nan(word(a)) && is_nan(word(b))).then_some(start + width)
        };
        match nan(4).or_else(|| nan(8)) {
            Some(next) => at = next,
            None => {
                return Err(format!(
                    "memory differs {when} at byte {at} of {}: interpreter {:02x?}, native {:02x?}",
                    program.region_bytes,
                    &a[at..(at + 8).min(a.len())],
                    &b[at..(at + 8).min(b.len())]
                ));
            }
        }
    }
    Ok(())
}

/// Work on a thread with the stack that the driver has.
fn deep<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    std::thread::scope(|s| {
        let thread = std::thread::Builder::new().stack_size(256 << 20).spawn_scoped(s, work);
        thread.expect("a thread starts").join().unwrap_or_else(|e| std::panic::resume_unwind(e))
    })
}

fn source(body: &str) -> String {
    format!("{}{body}", generate::SHARED)
}

#[test]
fn interpreter_and_jit_agree() {
    let (count, first) = (setting("RANDOM_PROGRAMS", 400), setting("RANDOM_SEED", 1));
    let workers = std::thread::available_parallelism().map_or(1, |n| n.get() as u64).min(count.max(1));
    let totals: Vec<(u64, u64)> = std::thread::scope(|s| {
        let threads: Vec<_> = (0..workers)
            .map(|w| {
                let work = move || {
                    let (mut finished, mut faults) = (0, 0);
                    for seed in (first + w..first + count).step_by(workers as usize) {
                        let text = source(&generate::program(seed, "", true));
                        match both_engines(&text) {
                            Ok(Outcome::Finished) => finished += 1,
                            Ok(Outcome::Fault(_)) => faults += 1,
                            Err(e) => panic!("seed {seed}: {e}\n{text}"),
                        }
                    }
                    (finished, faults)
                };
                std::thread::Builder::new().stack_size(256 << 20).spawn_scoped(s, work).expect("a thread starts")
            })
            .collect();
        threads.into_iter().map(|t| t.join().unwrap_or_else(|e| std::panic::resume_unwind(e))).collect()
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
            if deep(|| both_engines(&alone)).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{alone}"))
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
    ] {
        assert!(text.contains(form), "no program uses `{form}`");
    }
}
