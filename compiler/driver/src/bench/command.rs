//! `plcc bench`: how fast an application is in native code and in the interpreter, on the inputs of a stimulus.

use crate::bench::app::Front;
use crate::bench::lane::{AllTasks, Cycle, Lane};
use crate::bench::measure::{Plan, measure};
use crate::bench::report::{LaneAbout, LaneReport, ProgramReport, Report, figure, whole};
use crate::bench::ticks::Scale;
use crate::bench::{count, load, machine, method, svg};
use crate::cli::{BenchArgs, CodeArgs, Color, OptArg};
use crate::failure::Failure;
use crate::{pipeline, report};
use plcc_runtime::engine::{Engine, Region};
use plcc_runtime::fault;
use plcc_runtime::image::Image;
use plcc_runtime::path::Resolver;
use plcc_runtime::stimulus::Stimulus;
use plcc_runtime::task::base_tick;
use plcc_runtime::watchdog::Watchdog;
use std::path::{Path, PathBuf};

const INTERP: &str = "interpreter";
const JIT_NONE: &str = "jit, opt none";
const JIT_UNCHECKED: &str = "jit, no checks";
const JIT: &str = "jit";
const LINKED: &str = "linked";

const ABOUT: [LaneAbout; 5] = [
    LaneAbout { name: INTERP, what: "the reference interpreter, `--engine interp --opt none`" },
    LaneAbout { name: JIT_NONE, what: "machine code in memory, `--opt none`" },
    LaneAbout { name: JIT_UNCHECKED, what: "machine code in memory, `--opt speed --checks none`" },
    LaneAbout { name: JIT, what: "machine code in memory, `--opt speed`, with the checks of the project" },
    LaneAbout { name: LINKED, what: "the code of `plcc build`, as a shared object" },
];

/// Does it.
pub fn bench(args: &BenchArgs, color: Color) -> Result<u8, Failure> {
    let (project, sources, ids) = pipeline::load(&args.sources)?;
    let lines = ids.iter().map(|(id, _)| sources.file(*id).text.lines().count()).sum();
    let front = Front::check(sources, &ids, project);
    report(&front.parsed, Some(&front.checked), args.sources.message_format, color)?;
    let folder = Scratch::new()?;
    let mut bench = Bench::new(&front, args, &folder.0)?;
    if args.count_instructions {
        let cycles = bench.plan.cycles.min(count::CYCLES);
        count::run(&bench.name, &mut bench.lanes, cycles);
        return Ok(0);
    }
    if let Some(code) = bench.rehearse()? {
        return Ok(code);
    }
    let scale = Scale::calibrate();
    let plan = bench.plan;
    let measured =
        measure(&mut bench.lanes, &plan, scale).unwrap_or_else(|f| plcc_diag::bug!("{f:?}, which no other lane did"));
    let lanes = bench.lanes.iter().zip(&measured.times).map(|(lane, times)| {
        let code_bytes = bench.code_bytes.iter().find(|(name, _)| *name == lane.name).and_then(|(_, bytes)| *bytes);
        LaneReport { code_bytes, ..LaneReport::new(lane.name, times) }
    });
    let program = ProgramReport {
        name: bench.name.clone(),
        what: String::new(),
        lines,
        batch: measured.batch,
        cycles: plan.cycles,
        lanes: lanes.collect(),
        compile_ms: bench.compile_ms.clone(),
        passes_ms: bench.passes_ms.clone(),
    };
    let mut report = Report {
        title: format!("Cycle times of {}", bench.name),
        machine: machine(),
        lanes: ABOUT.iter().filter(|a| bench.lanes.iter().any(|l| l.name == a.name)).cloned().collect(),
        base: JIT.into(),
        programs: vec![program],
        method: method(&plan, scale),
    };
    report.machine.push(load("after"));
    report.machine.extend(bench.missing.clone());
    count_instructions(&mut report, &folder.0);
    write(&report, args.output.as_deref())?;
    Ok(0)
}

/// This command again, under valgrind.
fn count_instructions(report: &mut Report, folder: &Path) {
    let args: Vec<String> = std::env::args().skip(1).chain(["--count-instructions".to_string()]).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    match count::count(&args, folder) {
        Ok(Some(counts)) => count::add(report, &counts),
        Ok(None) => report.machine.push("instructions were not counted: that needs valgrind on x86-64".into()),
        Err(e) => report.machine.push(format!("instructions were not counted: {e}")),
    }
}

fn markdown(report: &Report) -> String {
    [
        report.head(),
        report.table("Typical cycle", "Nanoseconds: median over batches of the mean cycle.", figure::median, whole),
        report.ratios("Relative to native code", "The same figures, relative to `jit`.", figure::median),
        report.tails(
            "Slow cycles",
            "Nanoseconds, of cycles timed one by one. *Undisturbed worst*: of each cycle the least of its repeats, then the \
             longest of all cycles: what the program itself does in its worst cycle. *Worst* is the longest that was seen, with \
             what the machine did meanwhile.",
            &ABOUT.map(|a| a.name),
        ),
        report.table("Most instructions of a cycle", "Of the counted cycles.", figure::greatest_instructions, whole),
        report.table("Instructions of a cycle", "Mean.", figure::mean_instructions, whole),
        report.table("Code size", "Bytes of machine code, libraries not counted.", figure::code_bytes, whole),
        report.compile_times(
            "Compile time",
            "CPU milliseconds from source to running, the standard function blocks with it.",
        ),
        report.passes("Passes of the optimiser", "CPU milliseconds."),
        report.tail(),
    ]
    .concat()
}

/// Markdown to standard output; with a folder all forms there.
fn write(report: &Report, folder: Option<&Path>) -> Result<(), Failure> {
    let text = markdown(report);
    let Some(folder) = folder else { return crate::build::output(&text) };
    std::fs::create_dir_all(folder).map_err(|e| Failure::io("make folder", folder, e))?;
    let lanes: Vec<&str> = report.lanes.iter().map(|l| l.name).filter(|n| *n != JIT).collect();
    let files = [
        ("report.md", text),
        ("report.json", report.json()),
        ("ratios.svg", svg::ratios(report, "Typical cycle", &lanes, figure::median)),
    ];
    for (name, text) in files {
        crate::link::write_file(&folder.join(name), text.as_bytes())?;
    }
    eprintln!("report: {}", folder.join("report.md").display());
    Ok(())
}

/// A folder that goes away in any case.
struct Scratch(PathBuf);

impl Scratch {
    fn new() -> Result<Self, Failure> {
        let path = std::env::temp_dir().join(format!("plcc-bench-{}", std::process::id()));
        std::fs::create_dir_all(&path).map_err(|e| Failure::io("make folder", &path, e))?;
        Ok(Self(path))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// What is needed to measure.
struct Bench {
    name: String,
    image: Image,
    plan: Plan,
    lanes: Vec<Lane<'static>>,
    /// The first lane again, to be watched.
    first: AllTasks<Box<dyn Engine>>,
    code_bytes: Vec<(&'static str, Option<u64>)>,
    compile_ms: Vec<(&'static str, f64)>,
    passes_ms: Vec<(&'static str, f64)>,
    /// The user turned checks off.
    unchecked: bool,
    /// What could not be measured, and why.
    missing: Vec<String>,
}

impl Bench {
    fn new(front: &Front, args: &BenchArgs, folder: &Path) -> Result<Self, Failure> {
        let code = |opt| CodeArgs { checks: args.checks.clone(), opt: Some(opt) };
        let speed = front.back(&code(OptArg::Speed), false)?;
        let none = front.back(&code(OptArg::None), false)?;
        let unchecked = front.back(&CodeArgs { checks: Some("none".into()), opt: Some(OptArg::Speed) }, false)?;
        let image = speed.compiled.image.clone();
        if image.resources.len() > 1 {
            return Err(Failure::usage("plcc bench measures an application of one RESOURCE"));
        }
        let resolver = Resolver::new(&image);
        let stimulus = args.stimulus.as_deref().map(|path| Stimulus::read(path, &resolver)).transpose();
        let stimulus = stimulus.map_err(|(code, message)| Failure { code, message })?;
        let interval_ns = args.interval.unwrap_or_else(|| base_tick(&image.tasks));
        let tasks =
            |engine: Box<dyn Engine>, bytes| AllTasks::new(engine, bytes, &image.tasks, stimulus.clone(), interval_ns);
        let (jit, code_ms) = speed.jit();
        let mut engines: Vec<(&'static str, Box<dyn Engine>, &crate::bench::app::Back)> = vec![
            (INTERP, Box::new(none.interpreter()), &none),
            (JIT_NONE, Box::new(none.jit().0), &none),
            (JIT_UNCHECKED, Box::new(unchecked.jit().0), &unchecked),
            (JIT, Box::new(jit), &speed),
        ];
        let mut missing = Vec::new();
        match speed.linked(&folder.join("app.so")) {
            Ok(linked) => engines.push((LINKED, Box::new(linked), &speed)),
            Err(e) => missing.push(format!("`{LINKED}` was not measured: {}", e.lines().next().unwrap_or_default())),
        }
        if none.catches_faults() {
            // Where a fault is caught, code without checks does something else, without end perhaps.
            engines.retain(|(name, ..)| *name != JIT_UNCHECKED);
            missing.push(format!("`{JIT_UNCHECKED}` was not measured: a call with ENO may catch faults"));
        }
        if args.count_instructions {
            engines.retain(|(name, ..)| *name != INTERP);
        }
        let native = |name: &str| name != INTERP;
        let size = |back: &crate::bench::app::Back| crate::bench::app::code_bytes(&back.object());
        let code_bytes = engines.iter().filter(|e| native(e.0)).map(|(name, _, back)| (*name, size(back))).collect();
        let lane = |(name, engine, back): (&'static str, Box<dyn Engine>, &crate::bench::app::Back)| Lane {
            name,
            subject: Box::new(tasks(engine, back.region_bytes())),
        };
        let first = tasks(Box::new(none.interpreter()), none.region_bytes());
        let lanes = engines.into_iter().map(lane).collect();
        Ok(Self {
            name: image.name.clone(),
            plan: Plan { stimulus: args.cycles, cycles: args.cycles, ..Plan::FULL },
            lanes,
            first,
            code_bytes,
            compile_ms: vec![
                ("parse", front.cpu_ms[0]),
                ("check", front.cpu_ms[1]),
                ("lower, optimise", speed.cpu_ms),
                ("machine code", code_ms),
            ],
            passes_ms: none.passes_ms(),
            unchecked: args.checks.as_deref().is_some_and(|c| c != "all"),
            missing,
            image,
        })
    }

    /// Runs all cycles once in every lane before anything is timed; the first time under the watchdog, so that nothing that is
    /// measured can run without end. A fault is printed and gives the exit code.
    fn rehearse(&mut self) -> Result<Option<u8>, Failure> {
        let Self { image, first, lanes, plan, .. } = self;
        first.restart();
        // SAFETY: the region lives in `first`, which outlives the watchdog; it does not move.
        let mut watchdog = unsafe { Watchdog::new(first.region_mut().as_mut_ptr(), &image.tasks, || ()) }
            .map_err(|e| Failure::device(format!("cannot start the watchdog thread: {e}")))?;
        for cycle in 0..plan.cycles {
            first.feed(cycle);
            watchdog.start(0);
            let number = first.execute(cycle);
            let _ = watchdog.stop();
            if number != 0 {
                let (task, cycle) = (first.faulted, cycle + 1);
                eprint!("{}", fault::describe(image, &first.region_mut().whole(), number, task, cycle));
                return Ok(Some(1));
            }
        }
        drop(watchdog);
        let resolver = Resolver::new(image);
        let values = |region: &Region| -> Vec<(String, String)> {
            let all = resolver.all().unwrap_or_default();
            all.into_iter().map(|(name, leaf)| (name, resolver.text(&leaf, region.as_slice()))).collect()
        };
        let expected = values(first.memory());
        for lane in lanes {
            lane.subject.restart();
            let status = lane.subject.run(0, plan.cycles);
            let got = values(lane.subject.memory());
            if status != 0 || got != expected {
                if self.unchecked {
                    // semantics.md [E6]
                    self.missing.push(format!("`{}` gives other values: some check is off", lane.name));
                    continue;
                }
                let wrong = expected.iter().zip(&got).find(|(a, b)| a != b);
                plcc_diag::bug!("`{}` does not what the interpreter does: status {status}, {wrong:?}", lane.name);
            }
        }
        Ok(None)
    }
}
