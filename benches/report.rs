//! All programs in all lanes, in one run, to a report below `target/bench-report` (Markdown, JSON, SVG).
//!
//! `cargo bench` measures everything; `cargo bench -p plcc-benches -- pid fir` those programs, `--quick` in a third of the
//! time, `--brief` prints medians of a few lanes at once and writes no report, `--compile` how long compiling takes. `cargo test` runs all programs for some cycles:
//! every lane must give the same outputs after each cycle.

use plcc::bench::measure::{Plan, measure};
use plcc::bench::report::{LaneAbout, LaneReport, ProgramReport, Report, figure, two, whole};
use plcc::bench::ticks::Scale;
use plcc::bench::{count, machine, method, svg};
use plcc_benches::lanes::{ABOUT, Choice, INTERP, JIT, JIT_NONE, LINKED, Lanes};
use plcc_benches::programs::{PROGRAMS, Program};
use plcc_benches::{compile_time, reference, targets};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The argument with which the bench starts itself to count instructions.
const COUNT: &str = "--count";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let has = |flag: &str| args.iter().any(|a| a == flag);
    let names: Vec<&str> = args.iter().map(String::as_str).filter(|a| !a.starts_with('-')).collect();
    let chosen: Vec<&Program> =
        PROGRAMS.iter().filter(|p| names.is_empty() || names.iter().any(|n| p.name.contains(n))).collect();
    let folder = tempfile::tempdir().expect("a folder for what the C compiler makes");
    let result = if has(COUNT) {
        chosen.iter().try_for_each(|program| counted(program, folder.path()))
    } else if has("--brief") {
        println!("median cycle, ns: program, then each lane and its ratio to C -O2");
        chosen.iter().try_for_each(|program| brief(program, folder.path()))
    } else if has("--compile") {
        println!("ms of CPU from sources to machine code, by stages");
        chosen.iter().try_for_each(|program| stages(program))
    } else if has("--bench") {
        let plan = if has("--quick") { Plan::QUICK } else { Plan::FULL };
        write_report(&chosen, &charts(&names), &plan, folder.path())
    } else {
        chosen.iter().try_for_each(|program| check(program, folder.path())).and_then(|()| check_charts(&names))
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// What runs under valgrind.
fn counted(program: &Program, folder: &Path) -> Result<(), String> {
    let lanes = Lanes::new(program, Choice::Counted, count::CYCLES, folder)?;
    let mut lanes: Vec<_> = lanes.lanes.into_iter().map(|p| p.lane).collect();
    count::run(program.name, &mut lanes, count::CYCLES);
    Ok(())
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
    let plan = Plan { samples: 100, sample_ns: 10_000.0, stimulus: 20_000, cycles: 400, repeats: 1 };
    let mut lanes = Lanes::new(program, Choice::Few { linked: false }, plan.stimulus, folder).map_err(named)?;
    lanes.compare(plan.cycles).map_err(named)?;
    let mut running: Vec<_> = lanes.lanes.into_iter().map(|p| p.lane).collect();
    let measured = measure(&mut running, &plan, Scale::calibrate()).map_err(|f| named(format!("{f:?}")))?;
    let reports = running.iter().zip(&measured.times).map(|(lane, times)| LaneReport::new(lane.name, times));
    let medians: Vec<(&str, f64)> =
        reports.map(|lane| (lane.name, figure::median(&lane).unwrap_or(f64::NAN))).collect();
    let base = medians.iter().find(|(name, _)| *name == reference::O2.lane).map_or(f64::NAN, |(_, ns)| *ns);
    let cells = medians.iter().map(|(name, ns)| format!("{name} {ns:.1} ({:.2})", ns / base));
    println!("{:10} {}", program.name, cells.collect::<Vec<_>>().join(", "));
    Ok(())
}

/// How long compiling takes, a line a program.
fn stages(program: &Program) -> Result<(), String> {
    let stages = compile_time::to_jit(program.sources, 9)?;
    let sum: f64 = stages.iter().map(|(_, ms)| ms).sum();
    let cells: Vec<String> = stages.iter().map(|(stage, ms)| format!("{stage} {ms:.2}")).collect();
    println!("{:10} {sum:.2}: {}", program.name, cells.join(", "));
    Ok(())
}

type Chart = (String, String, String);

/// The charts whose names are asked for.
fn charts(names: &[&str]) -> Vec<Chart> {
    let mut all = plcc_benches::charts::all();
    all.retain(|(chart, ..)| names.is_empty() || names.iter().any(|n| chart.contains(n)));
    all
}

fn check_charts(names: &[&str]) -> Result<(), String> {
    for (name, _, text) in charts(names).iter().filter(|(name, ..)| !name.ends_with("1000")) {
        let (_, moved) = Lanes::without_reference(name, text)?.compare(200).map_err(|e| format!("{name}: {e}"))?;
        assert_eq!(moved, 1, "{name}: the total of all actions does not move");
    }
    Ok(())
}

/// Charts by size, in a report of their own: they have no reference in C.
fn chart_report(charts: &[Chart], plan: &Plan, scale: Scale) -> Result<Report, String> {
    let wanted = |lane: &&LaneAbout| [INTERP, JIT_NONE, JIT].contains(&lane.name);
    let lanes = ABOUT.iter().filter(wanted).cloned().collect();
    let mut report = Report { title: "Charts by size".into(), lanes, base: JIT.into(), ..Report::default() };
    for (name, what, text) in charts {
        eprintln!("{name}: {what}");
        let lanes = Lanes::without_reference(name, text)?;
        report.programs.push(measured(name, what, lanes, plan, scale)?);
    }
    Ok(report)
}

fn write_report(programs: &[&Program], charts: &[Chart], plan: &Plan, folder: &Path) -> Result<(), String> {
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
    let charts = chart_report(charts, plan, scale)?;
    let library = compile_time::oscat()?;
    report.machine.push(plcc::bench::load("after"));
    eprintln!("instructions");
    let names = programs.iter().map(|p| p.name);
    match count::count(&std::iter::once(COUNT).chain(names).collect::<Vec<_>>(), folder) {
        Ok(Some(counts)) => count::add(&mut report, &counts),
        Ok(None) => report.machine.push("there is no valgrind for this machine: instructions were not counted".into()),
        Err(e) => report.machine.push(format!("instructions were not counted: {e}")),
    }
    let out = out_folder();
    let text = markdown(&report, &charts, library);
    let write = |name: &str, text: &str| {
        let path = out.join(name);
        std::fs::write(&path, text).map_err(|e| format!("cannot write {}: {e}", path.display()))
    };
    std::fs::create_dir_all(&out).map_err(|e| format!("cannot make {}: {e}", out.display()))?;
    write("report.md", &text)?;
    write("report.json", &report.json())?;
    write("charts.json", &charts.json())?;
    let lanes = [JIT, JIT_NONE, reference::O3_NATIVE.lane];
    write("ratios.svg", &svg::ratios(&report, "Median cycle", &lanes, figure::median))?;
    write("worst.svg", &svg::ratios(&report, "Longest undisturbed cycle", &lanes, figure::undisturbed_worst))?;
    println!("{text}\nreport: {}", out.display());
    Ok(())
}

fn markdown(report: &Report, charts: &Report, library: Option<ProgramReport>) -> String {
    let base = &report.base;
    let library = Report { programs: library.into_iter().collect(), ..Report::default() };
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
            "CPU milliseconds from source to running in the JIT, the standard function blocks with it; of the lane `jit`, the \
             least of five runs.",
        ),
        library.compile_times(
            "Compile time of a library",
            "CPU milliseconds, every POU to an object file (`OSCAT` names the source).",
        ),
        report.passes("Passes of the optimiser", "CPU milliseconds over all programs; a pass that comes several times counts once."),
        report.table("Interpreter: operations of a cycle", "Mean.", figure::operations, whole),
        report.table(
            "Interpreter: nanoseconds an operation",
            "The typical cycle by its operations.",
            figure::ns_an_operation,
            two,
        ),
        charts.table(
            "Charts by size: typical cycle",
            "Nanoseconds. A ring has one active step, lanes have ten; each step has an action and an output with N, L, D or P.",
            figure::median,
            whole,
        ),
        charts.table("Charts by size: longest undisturbed cycle", "Nanoseconds.", figure::undisturbed_worst, whole),
        charts.compile_times("Charts by size: compile time", "CPU milliseconds."),
        report.tail(),
    ]
    .concat()
}

fn one(program: &Program, plan: &Plan, scale: Scale, folder: &Path) -> Result<ProgramReport, String> {
    let mut lanes = Lanes::new(program, Choice::All, plan.stimulus, folder)?;
    lanes.compare(plan.cycles)?;
    measured(program.name, program.what, lanes, plan, scale)
}

fn measured(name: &str, what: &str, lanes: Lanes, plan: &Plan, scale: Scale) -> Result<ProgramReport, String> {
    let Lanes { lanes, compile_ms, passes_ms, lines, .. } = lanes;
    let facts: Vec<_> = lanes.iter().map(|p| (p.code_bytes, p.operations)).collect();
    let mut running: Vec<_> = lanes.into_iter().map(|p| p.lane).collect();
    let measured = measure(&mut running, plan, scale).map_err(|f| format!("{f:?}"))?;
    let reports = running.iter().zip(&measured.times).zip(facts).map(|((lane, times), (code_bytes, operations))| {
        LaneReport { code_bytes, operations, ..LaneReport::new(lane.name, times) }
    });
    Ok(ProgramReport {
        name: name.into(),
        what: what.into(),
        lines,
        batch: measured.batch,
        cycles: plan.cycles,
        lanes: reports.collect(),
        compile_ms,
        passes_ms,
    })
}

/// `target/bench-report` of the workspace.
fn out_folder() -> PathBuf {
    let tmp = Path::new(env!("CARGO_TARGET_TMPDIR"));
    tmp.parent().unwrap_or(tmp).join("bench-report")
}
