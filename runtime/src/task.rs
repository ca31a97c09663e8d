//! When tasks run (semantics.md \[C1\] \[C2\]).

use crate::clock::Tick;
use crate::image::Task;

/// The base tick when no task has an interval.
const DEFAULT_TICK_NS: i64 = 10_000_000;

/// Due times of all tasks of a resource.
#[derive(Debug)]
pub struct Schedule {
    /// Task numbers in the order in which they run when several are due.
    order: Vec<usize>,
    intervals: Vec<Option<i64>>,
    events: Vec<Option<Event>>,
    due: Vec<i64>,
    counts: Vec<Counts>,
}

/// What became of the releases of a task.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Executions.
    pub executed: u64,
    /// Times that the releases of this task met a cycle that still ran: the execution was late, or releases were skipped.
    pub overruns: u64,
    /// Releases that were not executed.
    pub skipped: u64,
}

/// A BOOL variable whose rising edge releases a task.
#[derive(Debug)]
struct Event {
    offset: u32,
    bit: Option<u8>,
    level: bool,
    rose: bool,
}

impl Event {
    fn new((offset, bit): (u32, Option<u8>)) -> Self {
        Self { offset, bit, level: false, rose: false }
    }

    fn sample(&mut self, byte: u8) {
        let level = self.bit.map_or(byte != 0, |bit| byte >> bit & 1 != 0);
        self.rose = level && !self.level;
        self.level = level;
    }
}

/// The base tick: the greatest common divisor of the intervals.
pub fn base_tick(tasks: &[Task]) -> i64 {
    match tasks.iter().filter_map(|t| t.interval_ns).reduce(gcd) {
        Some(tick) if tick > 0 => tick,
        _ => DEFAULT_TICK_NS,
    }
}

/// Greatest common divisor.
pub fn gcd(a: i64, b: i64) -> i64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

impl Schedule {
    /// All tasks are due at 0.
    pub fn new(tasks: &[Task]) -> Self {
        let mut order: Vec<usize> = (0..tasks.len()).collect();
        // Programs without a task (an unnamed one) come last, whatever its priority says.
        order.sort_by_key(|n| (tasks[*n].name.is_empty(), tasks[*n].priority, *n));
        Self {
            order,
            intervals: tasks.iter().map(|t| t.interval_ns.filter(|ns| *ns > 0)).collect(),
            events: tasks.iter().map(|t| t.single.map(Event::new)).collect(),
            due: vec![0; tasks.len()],
            counts: vec![Counts::default(); tasks.len()],
        }
    }

    /// Reads the variables that release tasks (SINGLE), at the start of a tick. A task with an INTERVAL too runs
    /// periodically while its variable is FALSE.
    pub fn sample(&mut self, byte: impl Fn(u32) -> u8) {
        self.events.iter_mut().flatten().for_each(|event| event.sample(byte(event.offset)));
    }

    /// Whether variables release tasks.
    pub fn has_events(&self) -> bool {
        self.events.iter().any(Option::is_some)
    }

    /// Of each task.
    pub fn counts(&self) -> &[Counts] {
        &self.counts
    }

    /// The run has ended after so long, and so many base ticks have passed that were not executed: releases of every task
    /// that nothing has counted yet were skipped.
    pub fn end(&mut self, elapsed_ns: i64, ticks: u64) {
        for (n, counts) in self.counts.iter_mut().enumerate() {
            match (self.intervals[n], &self.events[n]) {
                (Some(interval), None) if elapsed_ns >= self.due[n] => {
                    counts.skipped += ((elapsed_ns - self.due[n]) / interval) as u64 + 1;
                }
                (None, None) => counts.skipped += ticks,
                _ => {}
            }
        }
    }

    /// Calls `run` for each task that is due in a tick, in order; stops at the first error.
    pub fn release<E>(&mut self, tick: Tick, mut run: impl FnMut(usize) -> Result<(), E>) -> Result<(), E> {
        for n in &self.order {
            let n = *n;
            let now = tick.now_ns;
            // What the tick skipped was a release of the tasks that run in every tick.
            let mut skipped = tick.skipped;
            let (rose, level) = self.events[n].as_ref().map_or((false, false), |e| (e.rose, e.level));
            if self.events[n].is_some() {
                // An edge is one release, seen in the tick that reads it.
                skipped = 0;
                if !rose && (level || self.intervals[n].is_none()) {
                    continue;
                }
            }
            if let Some(interval) = self.intervals[n].filter(|_| !rose) {
                if now < self.due[n] {
                    continue;
                }
                // The next due time behind now; releases that a long tick skipped are not made up for.
                let behind = (now - self.due[n]) / interval;
                self.due[n] = self.due[n].saturating_add((behind + 1).saturating_mul(interval));
                skipped = behind as u64;
            }
            let counts = &mut self.counts[n];
            counts.executed += 1;
            counts.skipped += skipped;
            counts.overruns += u64::from(tick.late || (skipped > 0 && tick.skipped > 0));
            run(n)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn task(name: &str, ms: Option<i64>, priority: u32) -> Task {
        Task { name: name.into(), interval_ns: ms.map(|m| m * 1_000_000), priority, ..Task::default() }
    }

    fn runs(tasks: &[Task], tick_ms: i64, ticks: i64) -> Vec<String> {
        let mut schedule = Schedule::new(tasks);
        (0..ticks)
            .map(|n| {
                let mut list = Vec::new();
                let _: Result<(), ()> = schedule.release(Tick::at(n * tick_ms * 1_000_000), |t| {
                    list.push(tasks[t].name.clone());
                    Ok(())
                });
                list.join(" ")
            })
            .collect()
    }

    #[test]
    fn due_tasks_run_by_priority_then_declaration() {
        let tasks =
            [task("slow", Some(30), 5), task("fast", Some(10), 1), task("", None, 0), task("same", Some(30), 5)];
        assert_eq!(runs(&tasks, 10, 4), ["fast slow same ", "fast ", "fast ", "fast slow same "]);
        assert_eq!(base_tick(&tasks), 10_000_000);
        assert_eq!(base_tick(&tasks[2..3]), 10_000_000);
        assert_eq!(base_tick(&[task("a", Some(15), 0), task("b", Some(20), 0)]), 5_000_000);
    }

    #[test]
    fn a_task_runs_in_the_first_tick_at_or_after_its_due_time() {
        let tasks = [task("t", Some(25), 0)];
        assert_eq!(runs(&tasks, 10, 8), ["t", "", "", "t", "", "t", "", ""]);
    }

    #[test]
    fn a_rising_variable_releases_its_task() {
        let event = Task { single: Some((3, Some(1))), ..task("event", None, 0) };
        let both = Task { single: Some((2, None)), ..task("both", Some(20), 1) };
        let tasks = [event, both];
        let mut schedule = Schedule::new(&tasks);
        let mut tick = |n: i64, bytes: [u8; 4]| {
            let mut list = Vec::new();
            schedule.sample(|at| bytes[at as usize]);
            let _: Result<(), ()> = schedule.release(Tick::at(n * 10_000_000), |t| {
                list.push(tasks[t].name.clone());
                Ok(())
            });
            list.join(" ")
        };
        assert_eq!(tick(0, [0, 0, 0, 0]), "both");
        assert_eq!(tick(1, [0, 0, 0, 2]), "event");
        assert_eq!(tick(2, [0, 0, 0, 2]), "both");
        assert_eq!(tick(3, [0, 0, 1, 1]), "both");
        assert_eq!(tick(4, [0, 0, 1, 3]), "event");
        assert_eq!(tick(5, [0, 0, 0, 0]), "both");
    }

    #[test]
    fn every_release_is_executed_or_skipped() {
        let tasks = [task("t", Some(20), 0), task("slow", Some(1000), 0), task("", None, 0)];
        let mut schedule = Schedule::new(&tasks);
        let mut tick = |ms: i64, skipped, late| {
            let tick = Tick { skipped, late, ..Tick::at(ms * 1_000_000) };
            let _: Result<(), ()> = schedule.release(tick, |_| Ok(()));
        };
        tick(0, 0, false);
        tick(10, 0, false);
        // The ticks at 20, 30 and 40 ms were due, the last one runs.
        tick(40, 2, true);
        tick(50, 0, false);
        let counts = |executed, overruns, skipped| Counts { executed, overruns, skipped };
        assert_eq!(schedule.counts(), [counts(2, 1, 1), counts(1, 0, 0), counts(4, 1, 2)]);
    }
}
