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

    /// The report; `json` chooses the form.
    pub fn report(&self, tasks: &[Task], overruns: &[u64], json: bool) -> String {
        let rows = tasks.iter().zip(&self.tasks).zip(overruns).map(|((task, h), overruns)| {
            let name = if task.name.is_empty() { "(every tick)" } else { &task.name };
            let values = [
                h.len(),
                h.min(),
                h.mean() as u64,
                h.value_at_quantile(0.5),
                h.value_at_quantile(0.99),
                h.value_at_quantile(0.999),
                h.max(),
                *overruns,
            ];
            (name, values)
        });
        if json {
            let rows: Vec<String> = rows
                .map(|(name, [cycles, min, mean, p50, p99, p999, max, overruns])| {
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
        for (name, [cycles, rest @ ..]) in rows {
            out.push_str(&format!("{name:<16}{cycles:>12}"));
            out.extend(rest.map(|v| format!("{v:>10}")));
            out.push('\n');
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_tell_the_same() {
        let tasks = [Task { name: "Fast".into(), interval_ns: None, single: None, priority: 0, watchdog_ns: 0 }];
        let mut stats = Stats::new(&tasks);
        for ns in [100, 300, 200] {
            stats.record(0, ns);
        }
        assert_eq!(
            stats.report(&tasks, &[4], true),
            "{\"tasks\":[{\"task\":\"Fast\",\"cycles\":3,\"min_ns\":100,\"mean_ns\":200,\"p50_ns\":200,\"p99_ns\":300,\
             \"p99_9_ns\":300,\"max_ns\":300,\"overruns\":4}]}\n"
        );
        let text = stats.report(&tasks, &[4], false);
        let words: Vec<&str> = text.lines().nth(1).unwrap().split_whitespace().collect();
        assert_eq!(words, ["Fast", "3", "100", "200", "200", "300", "300", "300", "4"]);
    }
}
