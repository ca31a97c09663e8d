//! One resource at work: which of its tasks run in a tick, and what happens around each execution.

use crate::charts::Charts;
use crate::clock::{Tick, monotonic_ns};
use crate::edges::{Edges, Taken};
use crate::engine::{Engine, Part};
use crate::fault;
use crate::history::History;
use crate::image::Image;
use crate::path::Resolver;
use crate::retain::Writer;
use crate::stats::{Execution, Stats};
use crate::task::Schedule;
use crate::watchdog::Watchdog;

/// How many faults of a task that restarts are told; the others are counted.
const TOLD_RESTARTS: u64 = 10;

/// The edges of the process image and the home of shared values, alone or behind a lock.
pub trait Meeting<'m> {
    /// Calls `f` with exclusive use of both.
    fn meet<R>(&mut self, f: impl FnOnce(&mut Edges, Option<&mut Part<'m>>) -> R) -> R;
}

/// What runs a resource.
pub struct Worker<'a> {
    pub image: &'a Image,
    pub resolver: &'a Resolver<'a>,
    pub resource: usize,
    pub engine: &'a mut dyn Engine,
    pub watchdog: Watchdog,
    pub schedule: Schedule,
    pub stats: Option<Stats>,
    pub retain: Option<Writer>,
    pub history: Option<History>,
    pub charts: Charts,
    /// The whole memory after a cold start, for tasks that start again after a fault.
    pub initial: Option<&'a [u8]>,
    pub taken: Taken,
    /// Whether variables release tasks.
    pub events: bool,
    /// Faults of each task that started again.
    pub restarts: Vec<u64>,
}

/// Why a resource cannot go on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Halt {
    /// A fault: the message.
    Fault(String),
    /// A driver failed: what to say.
    Driver(String),
}

impl Worker<'_> {
    /// Runs what is due in a tick.
    pub fn tick<'m>(
        &mut self,
        cycle: u64,
        tick: Tick,
        part: &mut Part<'m>,
        meeting: &mut impl Meeting<'m>,
    ) -> Result<(), Halt> {
        let Worker { image, resolver, resource, engine, watchdog, schedule, stats, history, initial, taken, .. } = self;
        let (image, resolver, restarts) = (*image, *resolver, &mut self.restarts);
        let this = &image.resources[*resource];
        let first = image.tasks_of(*resource).start;
        if self.events {
            meeting
                .meet(|edges, mut home| {
                    edges.inputs(part, home.as_deref_mut())?;
                    schedule.sample(|at| {
                        let inside = |p: &Part| p.as_slice().get((at as usize).wrapping_sub(p.start())).copied();
                        inside(part).or_else(|| home.as_deref().and_then(inside)).unwrap_or(0)
                    });
                    Ok(())
                })
                .map_err(Halt::Driver)?;
        }
        schedule.release(tick, |n| {
            let task = first + n;
            meeting.meet(|edges, home| edges.before(this, part, home, taken)).map_err(Halt::Driver)?;
            let start_ns = stats.as_ref().map_or(0, |_| monotonic_ns());
            watchdog.start(n);
            let status = engine.scan(part, task as u32, tick.now_ns);
            // An execution that ended late without a poll has ended: there is nothing left to stop.
            let _ = watchdog.stop();
            if let Some(stats) = stats.as_mut() {
                let release_ns = (tick.release_ns != 0).then_some(tick.release_ns);
                stats.record(task, Execution { now_ns: tick.now_ns, release_ns, start_ns, end_ns: monotonic_ns() });
            }
            if status == 0 {
                return meeting.meet(|edges, home| edges.after(this, part, home, taken)).map_err(Halt::Driver);
            }
            let Some(initial) = initial else {
                // Outside first: whoever reads the message finds the outputs safe.
                let safe = meeting.meet(|edges, home| edges.safe_state(part, home));
                let told = fault::describe(image, part, status, task, cycle);
                let told = with_history(told, history.as_ref(), image, resolver, part, cycle);
                return Err(match safe {
                    Ok(()) => Halt::Fault(told),
                    Err(e) => Halt::Driver(format!("{told}{e}")),
                });
            };
            restarts[n] += 1;
            if restarts[n] <= TOLD_RESTARTS {
                let told = fault::describe(image, part, status, task, cycle);
                let last = if restarts[n] == TOLD_RESTARTS { "; further ones are not told" } else { "" };
                let told = with_history(told, history.as_ref(), image, resolver, part, cycle);
                eprintln!("{told}  the task starts again{last}");
            }
            for (start, bytes) in &image.tasks[task].programs {
                let source = &initial[*start as usize..][..*bytes as usize];
                let at = *start as usize - part.start();
                part.as_mut_slice()[at..][..source.len()].copy_from_slice(source);
            }
            meeting
                .meet(|edges, mut home| {
                    edges.after(this, part, home.as_deref_mut(), taken)?;
                    edges.safe_outputs(task, part, home)
                })
                .map_err(Halt::Driver)
        })
    }

    /// The run has ended.
    pub fn end(&mut self, elapsed_ns: i64, ticks: u64) {
        self.schedule.end(elapsed_ns, ticks);
        if let Some(stats) = &mut self.stats {
            stats.elapsed_ns = Some(elapsed_ns);
        }
    }

    /// A tick has ended without a fault.
    pub fn finish_cycle(&mut self, cycle: u64, part: &mut Part) {
        let news = self.charts.check(cycle, part.as_mut_slice());
        if !news.is_empty() {
            eprint!("{news}");
        }
        if let Some(retain) = &mut self.retain {
            retain.capture(part.start(), part.as_slice());
        }
        if let Some(history) = &mut self.history {
            history.record(cycle, part.as_slice());
        }
    }
}

fn with_history(
    mut told: String,
    history: Option<&History>,
    image: &Image,
    resolver: &Resolver,
    part: &Part,
    cycle: u64,
) -> String {
    if let Some(history) = history {
        let (statement, instance) = fault::statement(image, part);
        match statement {
            Some(statement) => told += &history.table(resolver, statement, instance, (cycle, part.as_slice())),
            None => told += "  the variables of this place are not known\n",
        }
    }
    told
}
