//! Runs an application as the flags say; the result is the exit code of docs/cli.md.

use crate::charts::Charts;
use crate::cli::RunFlags;
use crate::clock::Clock;
use crate::engine::{Engine, Region};
use crate::image::Image;
use crate::path::{self, Resolver};
use crate::retain::Retain;
use crate::scan::{End, Scan};
use crate::stats::Stats;
use crate::stimulus::Stimulus;
use crate::task::{Schedule, base_tick};
use crate::trace::{self, Trace};
use crate::vcd::Vcd;
use crate::watchdog::Watchdog;
use crate::{fault, signals};
use std::io::Write;
use std::path::Path;

/// Runs it; messages go to standard error.
pub fn run(image: &Image, engine: &mut dyn Engine, flags: &RunFlags) -> u8 {
    match prepare_and_run(image, engine, flags) {
        Ok(code) => code,
        Err((code, message)) => {
            if !message.is_empty() {
                eprintln!("{}: {message}", image.name);
            }
            code
        }
    }
}

fn prepare_and_run(image: &Image, engine: &mut dyn Engine, flags: &RunFlags) -> Result<u8, (u8, String)> {
    let resolver = Resolver::new(image);
    let columns = match (&flags.trace, &flags.vcd, &flags.watch) {
        (None, None, None) => Vec::new(),
        (_, _, watch) => trace::columns(watch.as_deref(), &resolver).map_err(|e| (2, e))?,
    };
    let stimulus = flags.stimulus.as_deref().map(|path| Stimulus::read(path, &resolver)).transpose()?;
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
    signals::install();
    let retain_file = flags.retain.as_deref().or(image.retain_file.as_deref().map(Path::new));
    let (retain, restored) = match retain_file.map(|path| Retain::open(path, image, &resolver)).transpose()? {
        Some((retain, restored)) => (Some(retain), restored),
        None => (None, Vec::new()),
    };
    let mut mem = Region::new(image.region_bytes as usize);
    // Variables that the retain file does not know yet need their initial values even in a warm start.
    engine.init(&mut mem, true);
    for value in &restored {
        path::write(mem.as_mut_slice(), value.offset, value.bit, &value.bytes);
    }
    // SAFETY: `mem` lives to the end of this function, behind the watchdog's drop: it is declared before.
    let mut watchdog = unsafe { Watchdog::new(mem.as_mut_ptr(), &image.tasks) }
        .map_err(|e| (3, format!("cannot start the watchdog thread: {e}")))?;
    let interval_ns = flags.interval.unwrap_or_else(|| base_tick(&image.tasks));
    let mut scan = Scan {
        image,
        resolver: &resolver,
        engine,
        mem: &mut mem,
        watchdog: &mut watchdog,
        clock: Clock::new(flags.virtual_time, interval_ns),
        schedule: Schedule::new(&image.tasks),
        stimulus,
        trace,
        vcd,
        interval_ns,
        retain,
        stats: flags.stats.as_ref().map(|_| Stats::new(&image.tasks)),
        charts: Charts::new(image, &resolver),
        cycles: flags.cycles,
    };
    let end = scan.run();
    if let (Some(stats), Some(format)) = (&scan.stats, &flags.stats) {
        let report = stats.report(&image.tasks, scan.schedule.overruns(), format == "json");
        // A result; but where the trace is on standard output, nothing else may stand there.
        if [trace_path, flags.vcd.as_deref()].contains(&Some(Path::new("-"))) {
            eprint!("{report}");
        } else {
            // A reader that went away does not matter any more.
            let _ = std::io::stdout().write_all(report.as_bytes());
        }
    }
    let kept = scan.retain.take().map_or(Ok(()), Retain::finish);
    match end {
        End::Stopped => kept.map(|()| 0).map_err(|e| (3, e)),
        End::Fault(number, task, cycle) => {
            eprint!("{}", fault::describe(image, scan.mem, number, task, cycle));
            if let Err(e) = kept {
                eprintln!("{}: {e}", image.name);
            }
            Ok(1)
        }
        End::Trace(message) if message.is_empty() => Ok(0),
        End::Trace(message) => Err((3, message)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Root, Source, Task, TypeDesc};
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
        fn scan(&mut self, mem: &mut Region, _task: u32, now_ns: i64) -> u32 {
            let m = mem.as_mut_slice();
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
        let root = Root { name: "M.n".into(), offset: 64, bit: None, ty: 0, constant: false, retain: false };
        Image {
            name: "test".into(),
            region_bytes: 128,
            types: vec![TypeDesc::Elem(Elem::Int.code())],
            roots: vec![root],
            tasks: vec![Task {
                name: String::new(),
                interval_ns: None,
                single: None,
                priority: 0,
                watchdog_ns: 30_000_000,
            }],
            files: vec!["m.st".into()],
            sources: vec![Source { file: 0, line: 3, column: 5, pou: "M".into(), what: "a".into() }],
            ..Image::default()
        }
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
        assert_eq!(run(&image(), &mut Counter { limit: 12 }, &flags), 1);
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
        assert_eq!(run(&image, &mut Counter { limit: -9 }, &flags), 0);
        assert_eq!(traced(), "cycle,M.n\n1,2\n2,3\n3,4\n");
        // The third cycle of this run, which would make it 7, faults.
        assert_eq!(run(&image, &mut Counter { limit: 6 }, &flags), 1);
        assert_eq!(traced(), "cycle,M.n\n1,5\n2,6\n");
        assert_eq!(run(&image, &mut Counter { limit: -9 }, &flags), 0);
        assert_eq!(traced(), "cycle,M.n\n1,7\n2,8\n3,9\n");
        std::fs::write(&retain, "something else").unwrap();
        assert_eq!(run(&image, &mut Counter { limit: -9 }, &flags), 3);
        let _ = (std::fs::remove_file(trace), std::fs::remove_file(retain));
    }

    #[test]
    fn an_endless_execution_becomes_a_fault_in_virtual_time_too() {
        let stimulus = scratch("endless.csv");
        std::fs::write(&stimulus, "cycle,M.n\n2,-1\n").unwrap();
        let flags =
            RunFlags { cycles: Some(9), virtual_time: true, stimulus: Some(stimulus.clone()), ..RunFlags::default() };
        let start = std::time::Instant::now();
        assert_eq!(run(&image(), &mut Counter { limit: -9 }, &flags), 1);
        assert!(start.elapsed() >= std::time::Duration::from_millis(30));
        let _ = std::fs::remove_file(stimulus);
    }

    #[test]
    fn wrong_names_and_files_end_before_the_first_cycle() {
        let watch = |name: &str| RunFlags { watch: Some(name.into()), cycles: Some(1), ..RunFlags::default() };
        assert_eq!(run(&image(), &mut Counter { limit: -9 }, &watch("M.x")), 2);
        let trace = RunFlags { trace: Some("no/such/folder/t.csv".into()), ..watch("M.n") };
        assert_eq!(run(&image(), &mut Counter { limit: -9 }, &trace), 3);
    }

    #[test]
    fn a_fault_is_told_with_place_values_and_cycle() {
        let mut mem = Region::new(128);
        let m = mem.as_mut_slice();
        for (n, v) in [7i64, 1, 5].iter().enumerate() {
            m[region::FAULT_OPERANDS as usize + 8 * n..][..8].copy_from_slice(&v.to_le_bytes());
        }
        let text = fault::describe(&image(), &mem, Fault::IndexOutOfBounds.number(), 0, 4);
        assert_eq!(
            text,
            "error[E0602]: index out of bounds\n  --> m.st:3:5\n  in M\n  index of `a` is 7, its bounds are 1..5\n  cycle 4\n"
        );
    }
}
