//! Runs an application as the flags say; the result is the exit code of docs/cli.md.

use crate::charts::Charts;
use crate::cli::{OnFault, RunFlags};
use crate::clock::Clock;
use crate::edges::{Edges, Taken};
use crate::engine::{Engine, Region};
use crate::history::History;
use crate::image::Image;
use crate::path::{self, Resolver};
use crate::retain::{Opened, Retain, Writer};
use crate::scan::{End, Scan};
use crate::stats::{self, Stats};
use crate::stimulus::Stimulus;
use crate::task::{Counts, Schedule, base_tick};
use crate::threads::{self, Threads};
use crate::trace::{self, Trace};
use crate::vcd::Vcd;
use crate::watchdog::Watchdog;
use crate::worker::Worker;
use crate::{force, io, realtime, signals};
use std::io::Write;
use std::path::Path;
use std::time::Duration;

/// Runs it, with one engine for each resource; messages go to standard error.
pub fn run(image: &Image, engines: &mut [Box<dyn Engine>], flags: &RunFlags) -> u8 {
    match prepare_and_run(image, engines, flags) {
        Ok(code) => code,
        Err((code, message)) => {
            if !message.is_empty() {
                eprintln!("{}: {message}", image.name);
            }
            code
        }
    }
}

fn prepare_and_run(image: &Image, engines: &mut [Box<dyn Engine>], flags: &RunFlags) -> Result<u8, (u8, String)> {
    assert_eq!(engines.len(), image.resources.len(), "an engine for each resource");
    let mut image = image.clone();
    for task in &mut image.tasks {
        task.watchdog_ns = flags.watchdog.unwrap_or(task.watchdog_ns);
        task.deadline_ns = flags.deadline.or(task.deadline_ns);
    }
    let image = &image;
    // Virtual time does not sleep: with SCHED_FIFO nothing else would run.
    let wanted = flags.realtime.filter(|_| !flags.virtual_time);
    let resolver = Resolver::new(image);
    let columns = match (&flags.trace, &flags.vcd, &flags.watch) {
        (None, None, None) => Vec::new(),
        (_, _, watch) => trace::columns(watch.as_deref(), &resolver).map_err(|e| (2, e))?,
    };
    let stimulus = flags.stimulus.as_deref().map(|path| Stimulus::read(path, &resolver)).transpose()?;
    let forces = flags.force.as_deref().map(|text| force::parse(text, &resolver)).transpose().map_err(|e| (2, e))?;
    // A watch list alone is read on standard output.
    let alone = (flags.watch.is_some() && flags.vcd.is_none()).then_some(Path::new("-"));
    let trace_path = flags.trace.as_deref().or(alone);
    if [trace_path, flags.vcd.as_deref()] == [Some(Path::new("-")); 2] {
        return Err((2, "--trace and --vcd cannot both be on standard output".into()));
    }
    // A reader that went away is no failure.
    let unwritable = |e: String| (if e.is_empty() { 0 } else { 3 }, e);
    let vcd =
        flags.vcd.as_deref().map(|path| Vcd::open(path, image, columns.clone())).transpose().map_err(unwritable)?;
    let trace = trace_path.map(|path| Trace::open(path, columns)).transpose().map_err(unwritable)?;
    let driver_name = flags.io.as_deref().or(image.defaults.io.as_deref()).unwrap_or("none");
    let driver = io::open(driver_name, image, &resolver)?;
    signals::install();
    let (retain, restored, writers) = open_retain(image, &resolver, flags)?;
    let mut mem = Region::new(image.region_bytes as usize);
    // Variables that the retain file does not know yet need their initial values even in a warm start.
    engines[0].init(&mut mem, true);
    let initial = (flags.on_fault.map_or(image.defaults.restart_task, |p| p == OnFault::RestartTask))
        .then(|| mem.as_slice().to_vec());
    for value in &restored {
        path::write(mem.as_mut_slice(), value.offset, value.bit, &value.bytes);
    }
    let measured =
        flags.stats.is_some() || flags.stats_svg.is_some() || image.tasks.iter().any(|t| t.deadline_ns.is_some());
    let mut writers = writers.into_iter();
    let mut workers = Vec::new();
    for (number, engine) in engines.iter_mut().enumerate() {
        let tasks = &image.tasks[image.tasks_of(number)];
        let resource = &image.resources[number];
        let realtime = wanted;
        let ready = move || {
            // What could not be had was said before.
            let _ = realtime.map(|request| realtime::enter(&request, 1, None));
        };
        // SAFETY: `mem` lives to the end of this function, behind the workers' drop: it is declared before.
        let watchdog = unsafe { Watchdog::new(mem.as_mut_ptr().add(resource.start as usize), tasks, ready) }
            .map_err(|e| (3, format!("cannot start the watchdog thread: {e}")))?;
        let schedule = Schedule::new(tasks);
        let worker = Worker {
            image,
            resolver: &resolver,
            resource: number,
            engine: engine.as_mut(),
            watchdog,
            events: schedule.has_events(),
            schedule,
            stats: measured.then(|| Stats::new(image.tasks.len())),
            retain: writers.next().flatten(),
            charts: Charts::new(image, &resolver, (resource.start, resource.bytes)),
            history: flags.history.map(|n| History::new(usize::from(n), resource.bytes as usize)),
            initial: initial.as_deref(),
            taken: Taken::new(resource),
            restarts: vec![0; tasks.len()],
        };
        workers.push((worker, flags.interval.unwrap_or_else(|| base_tick(tasks))));
    }
    let interval_ns = workers.iter().map(|(_, ns)| *ns).reduce(crate::task::gcd).unwrap_or(1);
    let shared_retain = writers.next().flatten();
    let edges = Edges::new(image, driver, forces.unwrap_or_default());
    if wanted.is_some()
        && let Err(e) = realtime::lock_memory()
    {
        eprintln!("{}: --realtime: {e}", image.name);
    }
    let report = |workers: &[(Worker, i64)]| print_now(image, &workers.iter().map(|(w, _)| w).collect::<Vec<_>>());
    // What is recorded needs one moment for all resources: then they run one after the other, as in virtual time.
    let recorded = trace.is_some() || vcd.is_some() || stimulus.is_some() || driver_name.starts_with("csv:");
    let (end, workers) = if image.resources.len() > 1 && !flags.virtual_time && !recorded {
        run_threads(image, &mut mem, workers, edges, shared_retain, flags, interval_ns)
    } else {
        if let Some(request) = &wanted
            && let Err(e) = realtime::enter(request, 0, request.cpu)
        {
            eprintln!("{}: --realtime: {e}; it runs with normal scheduling", image.name);
        }
        realtime::precise_timers();
        realtime::touch_stack();
        let mut scan = Scan {
            image,
            resolver: &resolver,
            mem: &mut mem,
            workers,
            edges,
            clock: Clock::new(flags.virtual_time, interval_ns, flags.overrun),
            stimulus,
            trace,
            vcd,
            interval_ns,
            retain: shared_retain,
            cycles: flags.cycles,
            page_faults: None,
            report: &report,
        };
        let end = scan.run();
        if let Some(stats) = scan.workers.first_mut().and_then(|(w, _)| w.stats.as_mut()) {
            stats.page_faults = scan.page_faults;
        }
        (end, scan.workers.into_iter().map(|(w, _)| w).collect())
    };
    let on_stdout = [trace_path, flags.vcd.as_deref()].contains(&Some(Path::new("-")));
    let missed = finish_stats(image, workers, flags, on_stdout)?;
    let kept = retain.map_or(Ok(()), Retain::finish);
    match end {
        End::Stopped => kept.map(|()| u8::from(missed)).map_err(|e| (3, e)),
        End::Fault(told) => {
            eprint!("{told}");
            if let Err(e) = kept {
                eprintln!("{}: {e}", image.name);
            }
            Ok(1)
        }
        End::Failed(message) if message.is_empty() => Ok(0),
        End::Failed(message) => Err((3, message)),
    }
}

type Kept = (Option<Retain>, Vec<crate::retain::Restored>, Vec<Option<Writer>>);

fn open_retain(image: &Image, resolver: &Resolver, flags: &RunFlags) -> Result<Kept, (u8, String)> {
    let file = flags.retain.as_deref().or(image.retain_file.as_deref().map(Path::new));
    let flush = flags.retain_flush.or(image.defaults.retain_flush_ns).map(|ns| Duration::from_nanos(ns as u64));
    match file {
        None => Ok((None, Vec::new(), Vec::new())),
        Some(path) => {
            let Opened { retain, restored, writers } = Retain::open(path, image, resolver, flush)?;
            Ok((Some(retain), if flags.cold { Vec::new() } else { restored }, writers))
        }
    }
}

fn run_threads<'a>(
    image: &'a Image,
    mem: &mut Region,
    workers: Vec<(Worker<'a>, i64)>,
    edges: Edges<'a>,
    retain: Option<Writer>,
    flags: &RunFlags,
    interval_ns: i64,
) -> (End, Vec<Worker<'a>>) {
    let mut ranges: Vec<(u32, u32)> = image.resources.iter().map(|r| (r.start, r.bytes)).collect();
    ranges.push(image.home);
    let mut parts = mem.split(&ranges);
    let Some(home) = parts.pop() else { return (End::Stopped, Vec::new()) };
    let workers = workers.into_iter().zip(parts).map(|((worker, tick), part)| (worker, tick, part)).collect();
    let until_ns = flags.cycles.map(|n| i64::try_from(n).unwrap_or(i64::MAX).saturating_mul(interval_ns));
    let report = |worker: &Worker| print_now(image, &[worker]);
    let (policy, realtime) = (flags.overrun, flags.realtime);
    threads::run(Threads { edges, home, workers, policy, until_ns, realtime, retain, report: &report })
}

/// The statistics of a run that goes on, on standard error.
fn print_now(image: &Image, workers: &[&Worker]) {
    for worker in workers {
        let tasks = image.tasks_of(worker.resource);
        match &worker.stats {
            Some(stats) => eprint!("{}", stats.report(image, tasks.clone(), worker.schedule.counts(), false)),
            None => {
                for (task, counts) in image.tasks[tasks].iter().zip(worker.schedule.counts()) {
                    let Counts { executed, overruns, skipped } = counts;
                    let name = stats::shown(image, task);
                    eprintln!("{name}: {executed} cycles, {overruns} overruns, {skipped} skipped (times need --stats)");
                }
            }
        }
    }
}

/// Prints and draws the statistics, and tells missed deadlines and restarts. Whether a deadline was missed.
fn finish_stats(image: &Image, workers: Vec<Worker>, flags: &RunFlags, on_stdout: bool) -> Result<bool, (u8, String)> {
    let mut counts: Vec<Counts> = Vec::new();
    let mut all: Option<Stats> = None;
    for worker in workers {
        counts.extend(worker.schedule.counts());
        for (task, restarts) in image.tasks[image.tasks_of(worker.resource)].iter().zip(&worker.restarts) {
            if *restarts > 0 {
                eprintln!("{}: {} started again after {restarts} faults", image.name, stats::shown(image, task));
            }
        }
        match (&mut all, worker.stats) {
            (Some(all), Some(stats)) => all.merge(stats),
            (all, stats) => *all = stats,
        }
    }
    let Some(stats) = all else { return Ok(false) };
    let tasks = 0..image.tasks.len();
    if let Some(format) = &flags.stats {
        let report = stats.report(image, tasks.clone(), &counts, format == "json");
        // A result; but where the trace is on standard output, nothing else may stand there.
        if on_stdout {
            eprint!("{report}");
        } else {
            // A reader that went away does not matter any more.
            let _ = std::io::stdout().write_all(report.as_bytes());
        }
    }
    if let Some(path) = &flags.stats_svg {
        std::fs::write(path, stats.svg(image)).map_err(|e| (3, format!("cannot write `{}`: {e}", path.display())))?;
    }
    let mut missed = false;
    for (n, task) in image.tasks.iter().enumerate() {
        let reaction = stats.reaction(n, task.deadline_ns);
        if let (true, Some(deadline)) = (reaction.missed(), reaction.deadline_ns) {
            missed = true;
            eprintln!(
                "{}: the reaction time of {} may be {} ns, its deadline is {deadline} ns",
                image.name,
                stats::shown(image, task),
                reaction.worst_ns()
            );
        }
    }
    Ok(missed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Part;
    use crate::fault;
    use crate::image::{Resource, Root, Source, Task, TypeDesc};
    use plcc_stdlib::elem::Elem;
    use plcc_stdlib::fault::Fault;
    use plcc_stdlib::region;
    use std::sync::atomic::{AtomicU32, Ordering};

    /// Counts in an INT at byte 64; faults when it reaches a limit; runs without end when it is negative.
    struct Counter {
        limit: i16,
    }

    impl Engine for Counter {
        fn init(&mut self, mem: &mut Region, _cold: bool) {
            mem.as_mut_slice()[64] = 1;
        }
        fn scan(&mut self, part: &mut Part, _task: u32, now_ns: i64) -> u32 {
            let m = part.as_mut_slice();
            m[region::CLOCK_NS as usize..][..8].copy_from_slice(&now_ns.to_le_bytes());
            let value = i16::from_le_bytes([m[64], m[65]]);
            if value < 0 {
                let flag = m[region::DEADLINE_FLAG as usize..].as_mut_ptr().cast::<u32>();
                // SAFETY: the header is aligned, and the region outlives this call.
                let flag = unsafe { AtomicU32::from_ptr(flag) };
                while flag.load(Ordering::Relaxed) == 0 {
                    std::hint::spin_loop();
                }
                return Fault::Deadline.number();
            }
            if value == self.limit {
                return Fault::IndexOutOfBounds.number();
            }
            m[64..66].copy_from_slice(&(value + 1).to_le_bytes());
            0
        }
    }

    fn image() -> Image {
        let root = Root { name: "M.n".into(), offset: 64, ..Root::default() };
        Image {
            name: "test".into(),
            region_bytes: 128,
            types: vec![TypeDesc::Elem(Elem::Int.code())],
            roots: vec![root],
            resources: vec![Resource { bytes: 128, ..Resource::default() }],
            tasks: vec![Task { watchdog_ns: 30_000_000, ..Task::default() }],
            files: vec!["m.st".into()],
            sources: vec![Source { file: 0, line: 3, column: 5, pou: "M".into(), what: "a".into(), statement: None }],
            ..Image::default()
        }
    }

    fn go(image: &Image, limit: i16, flags: &RunFlags) -> u8 {
        run(image, &mut [Box::new(Counter { limit })], flags)
    }

    fn scratch(name: &str) -> std::path::PathBuf {
        std::env::temp_dir().join(format!("plcc-runtime-{}-{name}", std::process::id()))
    }

    #[test]
    fn traces_stimulates_and_stops_at_a_fault() {
        let (trace, stimulus) = (scratch("trace.csv"), scratch("stimulus.csv"));
        std::fs::write(&stimulus, "cycle,M.n\n3,10\n").unwrap();
        let flags = RunFlags {
            cycles: Some(9),
            virtual_time: true,
            trace: Some(trace.clone()),
            stimulus: Some(stimulus.clone()),
            watch: Some("m.N".into()),
            ..RunFlags::default()
        };
        assert_eq!(go(&image(), 12, &flags), 1);
        assert_eq!(std::fs::read_to_string(&trace).unwrap(), "cycle,m.N\n1,2\n2,3\n3,11\n4,12\n");
        let _ = (std::fs::remove_file(trace), std::fs::remove_file(stimulus));
    }

    #[test]
    fn retained_values_of_the_last_finished_cycle_come_back() {
        let retain = scratch("retain");
        let _ = std::fs::remove_file(&retain);
        let image = Image { retain: vec![(64, 2)], ..image() };
        let trace = scratch("retain.csv");
        let flags = RunFlags {
            cycles: Some(3),
            virtual_time: true,
            retain: Some(retain.clone()),
            trace: Some(trace.clone()),
            ..RunFlags::default()
        };
        let traced = || std::fs::read_to_string(&trace).unwrap();
        assert_eq!(go(&image, -9, &flags), 0);
        assert_eq!(traced(), "cycle,M.n\n1,2\n2,3\n3,4\n");
        // The third cycle of this run, which would make it 7, faults.
        assert_eq!(go(&image, 6, &flags), 1);
        assert_eq!(traced(), "cycle,M.n\n1,5\n2,6\n");
        assert_eq!(go(&image, -9, &flags), 0);
        assert_eq!(traced(), "cycle,M.n\n1,7\n2,8\n3,9\n");
        std::fs::write(&retain, "something else").unwrap();
        assert_eq!(go(&image, -9, &flags), 3);
        let _ = (std::fs::remove_file(trace), std::fs::remove_file(retain));
    }

    #[test]
    fn an_endless_execution_becomes_a_fault_in_virtual_time_too() {
        let stimulus = scratch("endless.csv");
        std::fs::write(&stimulus, "cycle,M.n\n2,-1\n").unwrap();
        let flags =
            RunFlags { cycles: Some(9), virtual_time: true, stimulus: Some(stimulus.clone()), ..RunFlags::default() };
        let start = std::time::Instant::now();
        assert_eq!(go(&image(), -9, &flags), 1);
        assert!(start.elapsed() >= std::time::Duration::from_millis(30));
        let _ = std::fs::remove_file(stimulus);
    }

    #[test]
    fn wrong_names_and_files_end_before_the_first_cycle() {
        let watch = |name: &str| RunFlags { watch: Some(name.into()), cycles: Some(1), ..RunFlags::default() };
        assert_eq!(go(&image(), -9, &watch("M.x")), 2);
        let trace = RunFlags { trace: Some("no/such/folder/t.csv".into()), ..watch("M.n") };
        assert_eq!(go(&image(), -9, &trace), 3);
    }

    #[test]
    fn a_fault_is_told_with_place_values_and_cycle() {
        let mut mem = Region::new(128);
        let m = mem.as_mut_slice();
        for (n, v) in [7i64, 1, 5].iter().enumerate() {
            m[region::FAULT_OPERANDS as usize + 8 * n..][..8].copy_from_slice(&v.to_le_bytes());
        }
        let [part] = mem.parts([(0, 128)]);
        let text = fault::describe(&image(), &part, Fault::IndexOutOfBounds.number(), 0, 4);
        assert_eq!(
            text,
            "error[E0602]: index out of bounds\n  --> m.st:3:5\n  in M\n  index of `a` is 7, its bounds are 1..5\n  cycle 4\n"
        );
    }
}
