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
    due: Vec<i64>,
    overruns: Vec<u64>,
}

/// The base tick: the greatest common divisor of the intervals.
pub fn base_tick(tasks: &[Task]) -> i64 {
    fn gcd(a: i64, b: i64) -> i64 {
        if b == 0 { a } else { gcd(b, a % b) }
    }
    match tasks.iter().filter_map(|t| t.interval_ns).reduce(gcd) {
        Some(tick) if tick > 0 => tick,
        _ => DEFAULT_TICK_NS,
    }
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
            due: vec![0; tasks.len()],
            overruns: vec![0; tasks.len()],
        }
    }

    /// Releases of each task that started late or not at all because cycles took too long.
    pub fn overruns(&self) -> &[u64] {
        &self.overruns
    }

    /// Calls `run` for each task that is due in a tick, in order; stops at the first error.
    pub fn release<E>(&mut self, tick: Tick, mut run: impl FnMut(usize) -> Result<(), E>) -> Result<(), E> {
        for n in &self.order {
            let n = *n;
            let now = tick.now_ns;
            let mut releases = tick.late;
            if let Some(interval) = self.intervals[n] {
                if now < self.due[n] {
                    continue;
                }
                // The next due time behind now; releases that a long tick skipped are not made up for.
                let behind = (now - self.due[n]) / interval;
                self.due[n] = self.due[n].saturating_add((behind + 1).saturating_mul(interval));
                releases = behind as u64 + 1;
            }
            if tick.late > 0 {
                self.overruns[n] += releases;
            }
            run(n)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn task(name: &str, ms: Option<i64>, priority: u32) -> Task {
        Task { name: name.into(), interval_ns: ms.map(|m| m * 1_000_000), priority, watchdog_ns: 1 }
    }

    fn runs(tasks: &[Task], tick_ms: i64, ticks: i64) -> Vec<String> {
        let mut schedule = Schedule::new(tasks);
        (0..ticks)
            .map(|n| {
                let mut list = Vec::new();
                let _: Result<(), ()> = schedule.release(Tick { now_ns: n * tick_ms * 1_000_000, late: 0 }, |t| {
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
    fn late_ticks_are_overruns_of_the_tasks_that_were_due() {
        let tasks = [task("t", Some(20), 0), task("slow", Some(1000), 0), task("", None, 0)];
        let mut schedule = Schedule::new(&tasks);
        let mut tick = |ms: i64, late| {
            let _: Result<(), ()> = schedule.release(Tick { now_ns: ms * 1_000_000, late }, |_| Ok(()));
        };
        tick(0, 0);
        tick(10, 0);
        // The ticks at 20, 30 and 40 ms were due, the last one runs.
        tick(40, 3);
        tick(50, 0);
        assert_eq!(schedule.overruns(), [2, 0, 3]);
    }
}
