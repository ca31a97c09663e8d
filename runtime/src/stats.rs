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
    pub fn report(&self, tasks: &[Task], overruns: u64, json: bool) -> String {
        let rows = tasks.iter().zip(&self.tasks).map(|(task, h)| {
            let name = if task.name.is_empty() { "(every tick)" } else { &task.name };
            let values = [
                h.len(),
                h.min(),
                h.mean() as u64,
                h.value_at_quantile(0.5),
                h.value_at_quantile(0.99),
                h.value_at_quantile(0.999),
                h.max(),
            ];
            (name, values)
        });
        if json {
            let rows: Vec<String> = rows
                .map(|(name, [cycles, min, mean, p50, p99, p999, max])| {
                    format!(
                        "{{\"task\":\"{name}\",\"executions\":{cycles},\"min_ns\":{min},\"mean_ns\":{mean},\"p50_ns\":{p50},\
                         \"p99_ns\":{p99},\"p99_9_ns\":{p999},\"max_ns\":{max}}}"
                    )
                })
                .collect();
            return format!("{{\"overruns\":{overruns},\"tasks\":[{}]}}\n", rows.join(","));
        }
        let mut out = format!(
            "{:<16}{:>12}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}\n",
            "task [ns]", "executions", "min", "mean", "p50", "p99", "p99.9", "max"
        );
        for (name, [cycles, rest @ ..]) in rows {
            out.push_str(&format!("{name:<16}{cycles:>12}"));
            out.extend(rest.map(|v| format!("{v:>10}")));
            out.push('\n');
        }
        out.push_str(&format!("overruns: {overruns}\n"));
        out
    }
}
