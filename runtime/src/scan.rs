//! The scan loop: inputs, execute, outputs.

use crate::charts::Charts;
use crate::clock::{Clock, Tick, monotonic_ns};
use crate::engine::{Engine, Region};
use crate::image::Image;
use crate::path::Resolver;
use crate::retain::Retain;
use crate::stats::Stats;
use crate::stimulus::Stimulus;
use crate::task::Schedule;
use crate::trace::Trace;
use crate::vcd::Vcd;
use crate::watchdog::Watchdog;
use crate::{process_image, signals};

/// Everything a run works on.
pub struct Scan<'a> {
    pub image: &'a Image,
    pub resolver: &'a Resolver<'a>,
    pub engine: &'a mut dyn Engine,
    pub mem: &'a mut Region,
    pub watchdog: &'a mut Watchdog,
    pub clock: Clock,
    pub schedule: Schedule,
    pub stimulus: Option<Stimulus>,
    pub trace: Option<Trace>,
    pub vcd: Option<Vcd>,
    pub interval_ns: i64,
    pub retain: Option<Retain>,
    pub stats: Option<Stats>,
    pub charts: Charts,
    /// Cycles to run; `None` is without end.
    pub cycles: Option<u64>,
}

/// How a run ended.
#[derive(Debug, PartialEq, Eq)]
pub enum End {
    /// All cycles ran, or somebody asked to stop.
    Stopped,
    /// A task faulted: the fault's number, the task, the cycle.
    Fault(u32, usize, u64),
    /// The trace cannot be written; empty if only its reader went away.
    Trace(String),
}

impl Scan<'_> {
    /// Runs cycles until one of the ends.
    pub fn run(&mut self) -> End {
        let mut cycle: u64 = 1;
        while self.cycles.is_none_or(|n| cycle <= n) && !signals::stop_requested() {
            let Some(tick) = self.clock.wait(cycle, signals::stop_requested) else { break };
            if let Some(stimulus) = &mut self.stimulus {
                stimulus.apply(cycle, self.mem.as_mut_slice());
            }
            if let Err((number, task)) = self.execute(tick) {
                process_image::safe_state(self.image, self.mem);
                return match self.flush() {
                    Err(e) if !e.is_empty() => End::Trace(e),
                    _ => End::Fault(number, task, cycle),
                };
            }
            let news = self.charts.check(cycle, self.mem.as_mut_slice());
            if !news.is_empty() {
                eprint!("{news}");
            }
            if let Some(retain) = &mut self.retain {
                retain.capture(self.mem.as_slice());
            }
            if let Err(e) = self.record(cycle, tick) {
                return End::Trace(e);
            }
            cycle += 1;
        }
        match self.flush() {
            Ok(()) => End::Stopped,
            Err(e) => End::Trace(e),
        }
    }

    fn execute(&mut self, tick: Tick) -> Result<(), (u32, usize)> {
        let Scan { schedule, engine, mem, watchdog, stats, .. } = self;
        schedule.sample(mem.as_slice());
        schedule.release(tick, |task| {
            let before = stats.as_ref().map(|_| monotonic_ns());
            watchdog.start(task);
            let status = engine.scan(mem, task as u32, tick.now_ns);
            // An execution that ended late without a poll has ended: there is nothing left to stop.
            let _ = watchdog.stop();
            if let (Some(stats), Some(before)) = (stats.as_mut(), before) {
                stats.record(task, monotonic_ns() - before);
            }
            if status == 0 { Ok(()) } else { Err((status, task)) }
        })
    }

    /// Trace and waveform of a finished cycle.
    fn record(&mut self, cycle: u64, tick: Tick) -> Result<(), String> {
        let mem = self.mem.as_slice();
        if let Some(trace) = &mut self.trace {
            trace.row(cycle, self.resolver, mem)?;
            if trace.is_live() && matches!(self.clock, Clock::Real { .. }) {
                trace.flush()?;
            }
        }
        self.vcd.as_mut().map_or(Ok(()), |vcd| vcd.row(tick.now_ns, self.resolver, mem))
    }

    fn flush(&mut self) -> Result<(), String> {
        let vcd = self.vcd.as_mut().map_or(Ok(()), |vcd| vcd.finish(self.interval_ns));
        self.trace.as_mut().map_or(Ok(()), Trace::flush).and(vcd)
    }
}
