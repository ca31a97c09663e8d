//! When tasks run (semantics.md \[C1\] \[C2\]).

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
        Self { order, intervals: tasks.iter().map(|t| t.interval_ns).collect(), due: vec![0; tasks.len()] }
    }

    /// Calls `run` for each task that is due at `now`, in order; stops at the first error.
    pub fn release<E>(&mut self, now: i64, mut run: impl FnMut(usize) -> Result<(), E>) -> Result<(), E> {
        for n in &self.order {
            let n = *n;
            if let Some(interval) = self.intervals[n] {
                if now < self.due[n] {
                    continue;
                }
                // The next due time behind now; releases that a long tick skipped are not made up for.
                let behind = (now - self.due[n]) / interval;
                self.due[n] += (behind + 1) * interval;
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
                let _: Result<(), ()> = schedule.release(n * tick_ms * 1_000_000, |t| {
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
}
