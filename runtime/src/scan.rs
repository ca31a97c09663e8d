//! The scan loop on one thread: all resources in order of declaration, and what is recorded of each cycle.

use crate::clock::{Clock, Tick};
use crate::edges::Edges;
use crate::engine::{Part, Region};
use crate::image::Image;
use crate::path::Resolver;
use crate::realtime;
use crate::retain::Writer;
use crate::signals;
use crate::stimulus::Stimulus;
use crate::trace::Trace;
use crate::vcd::Vcd;
use crate::worker::{Halt, Meeting, Worker};

/// Cycles before this one touch what they touch for the first time.
const WARM_FROM: u64 = 17;

/// Tells the statistics of workers.
pub type Report<'r> = dyn Fn(&[(Worker, i64)]) + 'r;

/// Everything a run works on.
pub struct Scan<'a> {
    pub image: &'a Image,
    pub resolver: &'a Resolver<'a>,
    pub mem: &'a mut Region,
    /// By resource, with its base tick.
    pub workers: Vec<(Worker<'a>, i64)>,
    pub edges: Edges<'a>,
    pub clock: Clock,
    pub stimulus: Option<Stimulus>,
    pub trace: Option<Trace>,
    pub vcd: Option<Vcd>,
    pub interval_ns: i64,
    /// Of what resources share.
    pub retain: Option<Writer>,
    /// Cycles to run; `None` is without end.
    pub cycles: Option<u64>,
    /// Page faults of this thread in cycles behind the first ones.
    pub page_faults: Option<u64>,
    /// Tells the statistics, when somebody asked for them.
    pub report: &'a Report<'a>,
}

/// How a run ended.
#[derive(Debug, PartialEq, Eq)]
pub enum End {
    /// All cycles ran, or somebody asked to stop.
    Stopped,
    /// A task faulted; the message.
    Fault(String),
    /// A file or device failed; empty if only a reader of the trace went away.
    Failed(String),
}

/// No other thread: nothing to wait for.
struct Alone<'e, 'a, 'm> {
    edges: &'e mut Edges<'a>,
    home: Option<Part<'m>>,
}

impl<'m> Meeting<'m> for Alone<'_, '_, 'm> {
    fn meet<R>(&mut self, f: impl FnOnce(&mut Edges, Option<&mut Part<'m>>) -> R) -> R {
        f(self.edges, self.home.as_mut())
    }
}

impl Scan<'_> {
    /// Runs cycles until one of the ends.
    pub fn run(&mut self) -> End {
        let end = self.cycles();
        if let Some((elapsed_ns, ticks)) = self.clock.end() {
            for (worker, _) in &mut self.workers {
                worker.end(elapsed_ns, ticks);
            }
        }
        // Until here the number is that of before the first counted cycle.
        self.page_faults = self.page_faults.map(|before| realtime::page_faults() - before);
        match (self.flush(), end) {
            (Err(e), End::Stopped) => End::Failed(e),
            (Err(e), End::Fault(told)) if !e.is_empty() => End::Failed(format!("{told}{e}")),
            (_, end) => end,
        }
    }

    fn cycles(&mut self) -> End {
        let (mut cycle, mut reports) = (1u64, signals::reports_requested());
        while self.cycles.is_none_or(|n| cycle <= n) && !signals::stop_requested() {
            let Some(tick) = self.clock.wait(cycle, || {
                let asked = signals::reports_requested();
                if asked != std::mem::replace(&mut reports, asked) {
                    (self.report)(&self.workers);
                }
                signals::stop_requested()
            }) else {
                break;
            };
            if cycle == WARM_FROM {
                self.page_faults = Some(realtime::page_faults());
            }
            if let Some(stimulus) = &mut self.stimulus {
                stimulus.apply(cycle, self.mem.as_mut_slice());
            }
            if let Err(halt) = self.execute(cycle, tick) {
                return match halt {
                    Halt::Fault(told) => End::Fault(told),
                    Halt::Driver(told) => End::Failed(told),
                };
            }
            if let Err(e) = self.record(cycle, tick) {
                return End::Failed(e);
            }
            cycle += 1;
        }
        End::Stopped
    }

    fn execute(&mut self, cycle: u64, tick: Tick) -> Result<(), Halt> {
        let Scan { image, workers, edges, mem, retain, .. } = self;
        edges.begin(cycle);
        let several = image.resources.len() > 1;
        for (worker, every_ns) in workers.iter_mut() {
            if tick.now_ns % *every_ns != 0 && several {
                continue;
            }
            let resource = &image.resources[worker.resource];
            let own = (resource.start, resource.bytes);
            let (mut part, home) = if several {
                let [part, home] = mem.parts([own, image.home]);
                (part, Some(home))
            } else {
                let [part] = mem.parts([own]);
                (part, None)
            };
            let mut alone = Alone { edges, home };
            worker.tick(cycle, tick, &mut part, &mut alone)?;
            worker.finish_cycle(cycle, &mut part);
        }
        let first = &image.resources[0];
        let end = if several {
            let [mut part, mut home] = mem.parts([(first.start, first.bytes), image.home]);
            if let Some(retain) = retain {
                retain.capture(home.start(), home.as_slice());
            }
            edges.end(&mut part, Some(&mut home))
        } else {
            let [mut part] = mem.parts([(first.start, first.bytes)]);
            edges.end(&mut part, None)
        };
        end.map_err(Halt::Driver)
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
