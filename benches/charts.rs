//! Charts: what a scan costs with 10, 100 and 1000 steps of which one is active, and with a simultaneous branch of ten; and the
//! twenty-step mixer of `examples/mixer` beside the same sequence as a state machine written by hand in C
//! (`programs/mixer.c`, compiled with the system's `cc -O2` when there is one).
//!
//! Printed per program: median, 99.9 % and worst scan of native code in nanoseconds, less what an empty program takes.
//! `cargo test` runs it with a few scans, to keep it alive.

use plcc_hir::Profile;
use plcc_tests::compile::compile;
use std::fmt::Write;
use std::process::Command;
use std::time::Instant;

const TICK_NS: i64 = 10_000_000;

#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Line([u8; 64]);

fn main() {
    let quick = !std::env::args().any(|a| a == "--bench");
    let scans = if quick { 300 } else { 200_000 };
    let empty = measure("PROGRAM Main\nVAR x : BOOL; END_VAR\nx := NOT x;\nEND_PROGRAM\n", scans);
    println!("an empty program: median {} ns, subtracted from the others", empty[0]);
    println!("| chart | median | p99.9 | worst |");
    println!("|---|---|---|---|");
    for steps in [10, 100, 1000] {
        row(&format!("{steps} steps in a ring, one active"), &ring(steps), scans, empty[0]);
    }
    for steps in [10, 100, 1000] {
        row(&format!("{steps} steps, ten active"), &lanes(steps), scans, empty[0]);
    }
    let mixer = [
        include_str!("../examples/mixer/src/recipes.st"),
        include_str!("../examples/mixer/src/control.st"),
        include_str!("../examples/mixer/src/main.st"),
    ];
    row("the mixer, 20 steps, with its plant", &mixer.concat(), scans, empty[0]);
    match hand_written(scans) {
        Some(text) => println!("the mixer as a state machine in C, with its plant: {text}"),
        None => println!("the mixer in C was not measured: there is no cc"),
    }
}

fn row(name: &str, text: &str, scans: i64, less: u64) {
    let [median, tail, worst] = measure(text, scans).map(|t| t.saturating_sub(less));
    println!("| {name} | {median} | {tail} | {worst} |");
}

/// Median, 99.9 % and worst scan.
fn measure(text: &str, scans: i64) -> [u64; 3] {
    let program = compile(text, Profile::Strict).unwrap_or_else(|e| panic!("{e}"));
    let code = plcc_codegen::jit::compile(&program).unwrap_or_else(|e| panic!("{e:?}"));
    let mut memory = vec![Line([0; 64]); (program.region_bytes as usize).div_ceil(64)];
    // SAFETY: a Line is 64 plain bytes.
    let memory = unsafe { std::slice::from_raw_parts_mut(memory.as_mut_ptr().cast::<u8>(), memory.len() * 64) };
    code.init(memory, true);
    let mut times = Vec::with_capacity(scans as usize);
    for scan in 0..scans {
        let start = Instant::now();
        let status = code.scan(memory, 0, scan * TICK_NS);
        times.push(start.elapsed().as_nanos() as u64);
        assert_eq!(status, 0, "a benchmark program faulted");
    }
    times.sort_unstable();
    [times[times.len() / 2], times[(times.len() - 1) * 999 / 1000], times[times.len() - 1]]
}

/// A ring of steps, each 50 ms, each with an action of its own and an output with some qualifier.
fn ring(steps: usize) -> String {
    let mut t = declarations(steps);
    for n in 0..steps {
        step(&mut t, n, n == 0);
        let _ = writeln!(t, "TRANSITION FROM S{n} TO S{} := S{n}.T >= T#50ms; END_TRANSITION", (n + 1) % steps);
    }
    t + "END_PROGRAM\n"
}

/// Ten rings side by side, which one transition starts.
fn lanes(steps: usize) -> String {
    let mut t = declarations(steps);
    let each = steps / 10;
    t.push_str("INITIAL_STEP Start: END_STEP\n");
    let heads: Vec<String> = (0..10).map(|lane| format!("S{}", lane * each)).collect();
    let _ = writeln!(t, "TRANSITION FROM Start TO ({}) := TRUE; END_TRANSITION", heads.join(", "));
    for n in 0..steps {
        step(&mut t, n, false);
        let next = n / each * each + (n % each + 1) % each;
        let _ = writeln!(t, "TRANSITION FROM S{n} TO S{next} := S{n}.T >= T#50ms; END_TRANSITION");
    }
    t + "END_PROGRAM\n"
}

fn declarations(steps: usize) -> String {
    let mut t = "PROGRAM Main\nVAR\n  total : DINT;\n".to_string();
    for n in 0..steps {
        let _ = writeln!(t, "  v{n} : BOOL;");
    }
    t + "END_VAR\n"
}

fn step(t: &mut String, n: usize, initial: bool) {
    let qualifier = ["N", "L, T#30ms", "D, T#20ms", "P", "N"][n % 5];
    let word = if initial { "INITIAL_STEP" } else { "STEP" };
    let _ = writeln!(t, "{word} S{n}: A{n}; v{n}({qualifier}); END_STEP\nACTION A{n}: total := total + 1; END_ACTION");
}

/// What `programs/mixer.c` prints about itself.
fn hand_written(scans: i64) -> Option<String> {
    let folder = std::env::temp_dir().join(format!("plcc-bench-{}", std::process::id()));
    std::fs::create_dir_all(&folder).ok()?;
    let (source, program) = (folder.join("mixer.c"), folder.join("mixer"));
    std::fs::write(&source, include_str!("programs/mixer.c")).ok()?;
    let built = Command::new("cc").arg("-O2").arg("-o").arg(&program).arg(&source).status().ok()?;
    let output = built.success().then(|| Command::new(&program).arg(scans.to_string()).output().ok()).flatten();
    let _ = std::fs::remove_dir_all(&folder);
    Some(String::from_utf8_lossy(&output?.stdout).trim().to_string())
}
