//! All programs in all lanes, in one run, to a report below `target/bench-report` (Markdown, JSON, SVG).
//!
//! `cargo bench` measures everything; `cargo bench -p plcc-benches -- pid fir` those programs, `--quick` in a tenth of the
//! time; `cargo test -p plcc-benches --bench report -- --brief pid` prints medians at once. `cargo test` runs them for some cycles: every lane must give the same outputs after each cycle.

use plcc::bench::measure::{Plan, measure};
use plcc::bench::report::{LaneReport, ProgramReport, Report, figure, whole};
use plcc::bench::ticks::Scale;
use plcc::bench::{machine, method};
use plcc_benches::lanes::{ABOUT, Choice, INTERP, JIT, JIT_NONE, LINKED, Lanes};
use plcc_benches::programs::{PROGRAMS, Program};
use plcc_benches::{count, reference, svg, targets};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let has = |flag: &str| args.iter().any(|a| a == flag);
    let names: Vec<&str> = args.iter().map(String::as_str).filter(|a| !a.starts_with('-')).collect();
    let chosen: Vec<&Program> =
        PROGRAMS.iter().filter(|p| names.is_empty() || names.iter().any(|n| p.name.contains(n))).collect();
    let folder = tempfile::tempdir().expect("a folder for what the C compiler makes");
    let result = if has(count::FLAG) {
        count::run(&chosen, folder.path())
    } else if has("--brief") {
        println!("median cycle, ns: program, then each lane and its ratio to C -O2");
        chosen.iter().try_for_each(|program| brief(program, folder.path()))
    } else if has("--bench") {
        let plan = if has("--quick") { Plan::QUICK } else { Plan::FULL };
        write_report(&chosen, &plan, folder.path())
    } else {
        chosen.iter().try_for_each(|program| check(program, folder.path()))
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// The same outputs in all lanes, and a measurement in small.
fn check(program: &Program, folder: &Path) -> Result<(), String> {
    let named = |e: String| format!("{}: {e}", program.name);
    // Linking takes longer than all the rest; strings need the runtime's library.
    let choice = Choice::Few { linked: program.name == "strings" };
    let mut lanes = Lanes::new(program, choice, 400, folder).map_err(named)?;
    let (checksum, moved) = lanes.compare(400).map_err(named)?;
    let (count, outputs) = (lanes.lanes.len(), lanes.output_count());
    println!("{}: {count} lanes agree, checksum {checksum:016x}, {moved} of {outputs} outputs moved", program.name);
    if moved * 2 < outputs {
        return Err(named("hardly any output ever changes".into()));
    }
    let mut running: Vec<_> = lanes.lanes.into_iter().map(|p| p.lane).collect();
    let measured = measure(&mut running, &Plan::SMOKE, Scale::calibrate()).map_err(|f| named(format!("{f:?}")))?;
    assert_eq!(measured.times.len(), count);
    Ok(())
}

/// Medians of a few lanes, a line a program: what one looks at while working on the compiler.
fn brief(program: &Program, folder: &Path) -> Result<(), String> {
    let named = |e: String| format!("{}: {e}", program.name);
    let mut lanes = Lanes::new(program, Choice::Few { linked: false }, 400, folder).map_err(named)?;
    lanes.compare(400).map_err(named)?;
    let mut running: Vec<_> = lanes.lanes.into_iter().map(|p| p.lane).collect();
    let plan = Plan { samples: 100, sample_ns: 10_000.0, cycles: 400, repeats: 1 };
    let measured = measure(&mut running, &plan, Scale::calibrate()).map_err(|f| named(format!("{f:?}")))?;
    let reports = running.iter().zip(&measured.times).map(|(lane, times)| LaneReport::new(lane.name, times));
    let medians: Vec<(&str, f64)> =
        reports.map(|lane| (lane.name, figure::median(&lane).unwrap_or(f64::NAN))).collect();
    let base = medians.iter().find(|(name, _)| *name == reference::O2.lane).map_or(f64::NAN, |(_, ns)| *ns);
    let cells = medians.iter().map(|(name, ns)| format!("{name} {ns:.1} ({:.2})", ns / base));
    println!("{:10} {}", program.name, cells.collect::<Vec<_>>().join(", "));
    Ok(())
}

fn write_report(programs: &[&Program], plan: &Plan, folder: &Path) -> Result<(), String> {
    let scale = Scale::calibrate();
    let mut report = Report {
        title: "Cycle times of plcc".into(),
        machine: machine(),
        lanes: ABOUT.to_vec(),
        base: reference::O2.lane.into(),
        method: method(plan, scale),
        ..Report::default()
    };
    match reference::compiler() {
        Some(name) => report.machine.push(format!("C compiler: {name}")),
        None => report.machine.push("there is no `cc`: the C references were not measured".into()),
    }
    for program in programs {
        eprintln!("{}: {}", program.name, program.what);
        report.programs.push(one(program, plan, scale, folder).map_err(|e| format!("{}: {e}", program.name))?);
    }
    report.machine.push(plcc::bench::load("after"));
    eprintln!("instructions");
    let names: Vec<&str> = programs.iter().map(|p| p.name).collect();
    match count::count(&names, folder)? {
        Some(counts) => add_counts(&mut report, &counts),
        None => report.machine.push("there is no valgrind for this machine: instructions were not counted".into()),
    }
    let out = out_folder();
    let text = markdown(&report);
    let write = |name: &str, text: &str| {
        let path = out.join(name);
        std::fs::write(&path, text).map_err(|e| format!("cannot write {}: {e}", path.display()))
    };
    std::fs::create_dir_all(&out).map_err(|e| format!("cannot make {}: {e}", out.display()))?;
    write("report.md", &text)?;
    write("report.json", &report.json())?;
    let lanes = [JIT, JIT_NONE, reference::O3_NATIVE.lane];
    write("ratios.svg", &svg::ratios(&report, "Median cycle", &lanes, figure::median))?;
    write("worst.svg", &svg::ratios(&report, "Longest undisturbed cycle", &lanes, figure::undisturbed_worst))?;
    println!("{text}\nreport: {}", out.display());
    Ok(())
}

fn add_counts(report: &mut Report, counts: &count::Counts) {
    for program in &mut report.programs {
        for lane in &mut program.lanes {
            lane.instructions = counts.get(&(program.name.clone(), lane.name.to_string())).copied();
        }
    }
    report.method.push(format!(
        "*Instructions*: callgrind counts every instruction of the first {} cycles, cycle by cycle, libraries with it, less those \
         of an empty scan. The numbers are the same in every run.",
        count::CYCLES
    ));
}

fn markdown(report: &Report) -> String {
    let base = &report.base;
    [
        report.head(),
        targets::table(report),
        report.table("Typical cycle", "Nanoseconds: median over batches of the mean cycle.", figure::median, whole),
        report.ratios("Typical cycle in ratios", &format!("Relative to {base}."), figure::median),
        report.tails(
            "Slow cycles",
            "Nanoseconds, of cycles timed one by one. *Undisturbed worst*: of each cycle the least of its repeats, then the \
             longest of all cycles: what the program itself does in its worst cycle. *Worst* is the longest that was seen, with \
             what the machine did meanwhile.",
            &[JIT, LINKED, reference::O2.lane, reference::O2_COPY, INTERP],
        ),
        report.ratios(
            "Longest undisturbed cycle in ratios",
            &format!("Relative to {base}."),
            figure::undisturbed_worst,
        ),
        report.table(
            "Most instructions of a cycle",
            "Of any of the counted cycles.",
            figure::greatest_instructions,
            whole,
        ),
        report.ratios("The same in ratios", &format!("Relative to {base}."), figure::greatest_instructions),
        report.table("Instructions of a cycle", "Mean.", figure::mean_instructions, whole),
        report.ratios("The same in ratios", &format!("Relative to {base}."), figure::mean_instructions),
        report.table("Code size", "Bytes of machine code, tables and libraries not counted.", figure::code_bytes, whole),
        report.compile_times(
            "Compile time",
            "CPU milliseconds from source to running in the JIT, the standard function blocks with it; of the lane `jit`.",
        ),
        report.tail(),
    ]
    .concat()
}

fn one(program: &Program, plan: &Plan, scale: Scale, folder: &Path) -> Result<ProgramReport, String> {
    let mut lanes = Lanes::new(program, Choice::All, plan.cycles, folder)?;
    lanes.compare(plan.cycles)?;
    let (compile_ms, lines) = (lanes.compile_ms.clone(), lanes.lines);
    let code: Vec<_> = lanes.lanes.iter().map(|p| p.code_bytes).collect();
    let mut running: Vec<_> = lanes.lanes.into_iter().map(|p| p.lane).collect();
    let measured = measure(&mut running, plan, scale).map_err(|f| format!("{f:?}"))?;
    let reports = running
        .iter()
        .zip(&measured.times)
        .zip(code)
        .map(|((lane, times), code_bytes)| LaneReport { code_bytes, ..LaneReport::new(lane.name, times) });
    Ok(ProgramReport {
        name: program.name.into(),
        what: program.what.into(),
        lines,
        batch: measured.batch,
        cycles: plan.cycles,
        lanes: reports.collect(),
        compile_ms,
    })
}

/// `target/bench-report` of the workspace.
fn out_folder() -> PathBuf {
    let tmp = Path::new(env!("CARGO_TARGET_TMPDIR"));
    tmp.parent().unwrap_or(tmp).join("bench-report")
}
