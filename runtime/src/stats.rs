//! Execution times per task (`--stats`): histograms with fixed bounds, so that recording never allocates.

use crate::image::Task;
use hdrhistogram::Histogram;

/// Longest time that is told apart, nanoseconds.
const LONGEST_NS: u64 = 3_600_000_000_000;

/// One histogram a task.
#[derive(Debug)]
pub struct Stats {
    tasks: Vec<Histogram<u64>>,
}

impl Stats {
    /// Empty.
    pub fn new(tasks: &[Task]) -> Self {
        // The bounds are constants that the crate accepts.
        let histogram =
            || Histogram::new_with_bounds(1, LONGEST_NS, 3).unwrap_or_else(|_| unreachable!("fixed bounds"));
        Self { tasks: tasks.iter().map(|_| histogram()).collect() }
    }

    /// One execution.
    pub fn record(&mut self, task: usize, ns: i64) {
        if let Some(histogram) = self.tasks.get_mut(task) {
            histogram.saturating_record((ns.max(1) as u64).min(LONGEST_NS));
        }
    }

    /// The report; `json` chooses the form. `overruns` are the releases of each task that were left out.
    pub fn report(&self, tasks: &[Task], overruns: &[u64], json: bool) -> String {
        let rows = tasks.iter().zip(&self.tasks).zip(overruns).map(|((task, h), overruns)| {
            let name = if task.name.is_empty() { "(every tick)" } else { &task.name };
            let quantile = |q| h.value_at_quantile(q);
            let times = [h.min(), h.mean() as u64, quantile(0.5), quantile(0.99), quantile(0.999), h.max()];
            (name, h.len(), times, overruns)
        });
        if json {
            let rows: Vec<String> = rows
                .map(|(name, cycles, [min, mean, p50, p99, p999, max], overruns)| {
                    format!(
                        "{{\"task\":\"{name}\",\"cycles\":{cycles},\"min_ns\":{min},\"mean_ns\":{mean},\"p50_ns\":{p50},\
                         \"p99_ns\":{p99},\"p99_9_ns\":{p999},\"max_ns\":{max},\"overruns\":{overruns}}}"
                    )
                })
                .collect();
            return format!("{{\"tasks\":[{}]}}\n", rows.join(","));
        }
        let mut out = format!(
            "{:<16}{:>12}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}\n",
            "task [ns]", "cycles", "min", "mean", "p50", "p99", "p99.9", "max", "overruns"
        );
        for (name, cycles, times, overruns) in rows {
            out.push_str(&format!("{name:<16}{cycles:>12}"));
            out.extend(times.map(|v| format!("{v:>10}")));
            out.push_str(&format!("{overruns:>10}\n"));
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_each_task_in_both_forms() {
        let task = |name: &str| Task { name: name.into(), interval_ns: None, priority: 0, watchdog_ns: 1 };
        let tasks = [task("Fast"), task("")];
        let mut stats = Stats::new(&tasks);
        for ns in [100, 200, 300, i64::MAX] {
            stats.record(0, ns);
        }
        let json = stats.report(&tasks, &[7, 0], true);
        assert!(json.starts_with("{\"tasks\":[{\"task\":\"Fast\",\"cycles\":4,\"min_ns\":100,"), "{json}");
        assert!(json.contains("\"p50_ns\":200,") && json.contains("\"overruns\":7}"), "{json}");
        let text = stats.report(&tasks, &[7, 0], false);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3);
        assert!(lines[1].starts_with("Fast") && lines[1].ends_with(" 7"), "{text}");
        assert!(lines[2].starts_with("(every tick)") && lines[2].contains(" 0 "), "{text}");
    }
}
