//! What `--stats` measures, per task: execution time, wake-up latency and period as histograms, and the reaction time that
//! follows. Recording never allocates; the histograms have fixed bounds and touched pages.

mod svg;

use crate::image::{Image, Task};
use crate::task::Counts;
use hdrhistogram::Histogram;
use std::fmt::Write;
use std::ops::Range;

/// Longest time that is told apart, nanoseconds.
const LONGEST_NS: u64 = 3_600_000_000_000;
/// What is measured of each task, in the order of [`TaskStats::histograms`].
const MEASURES: [&str; 3] = ["execution", "wake-up", "period"];

/// One execution of a task. Times are CLOCK_MONOTONIC.
#[derive(Debug, Clone, Copy)]
pub struct Execution {
    /// When it was released, on the scan clock.
    pub now_ns: i64,
    /// When it should have started; `None` in virtual time.
    pub release_ns: Option<i64>,
    /// When it started.
    pub start_ns: i64,
    /// When it ended.
    pub end_ns: i64,
}

/// All tasks.
#[derive(Debug)]
pub struct Stats {
    tasks: Vec<TaskStats>,
    /// Page faults in cycles behind the first ones; `None` where nobody counted.
    pub page_faults: Option<u64>,
    /// How long the run was, from the first release on; `None` in virtual time and while it runs.
    pub elapsed_ns: Option<i64>,
}

#[derive(Debug)]
struct TaskStats {
    execution: Histogram<u64>,
    wake_up: Histogram<u64>,
    period: Histogram<u64>,
    last: Option<Execution>,
    /// Longest time from the end of an execution to the start of the next.
    release_delay_ns: i64,
    /// Longest time from the start of an execution to the end of the next.
    observed_ns: i64,
}

/// How long an input can take to have its effect on an output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reaction {
    /// Longest execution.
    pub max_cycle_ns: i64,
    /// Longest time from the end of an execution to the start of the next.
    pub release_delay_ns: i64,
    /// Longest time from the start of an execution to the end of the next that was seen.
    pub observed_ns: i64,
    /// What it has to keep.
    pub deadline_ns: Option<i64>,
}

impl Reaction {
    /// 2 x longest cycle + release delay: the input changes just after it was read, waits for this execution to end and for
    /// the next one to be released, which then takes as long as the longest.
    pub fn worst_ns(&self) -> i64 {
        self.max_cycle_ns.saturating_mul(2).saturating_add(self.release_delay_ns)
    }

    /// Whether the deadline is missed.
    pub fn missed(&self) -> bool {
        self.deadline_ns.is_some_and(|deadline| self.worst_ns() > deadline)
    }
}

impl Stats {
    /// Empty.
    pub fn new(tasks: usize) -> Self {
        Self { tasks: (0..tasks).map(|_| TaskStats::new()).collect(), page_faults: None, elapsed_ns: None }
    }

    /// One execution.
    pub fn record(&mut self, task: usize, execution: Execution) {
        if let Some(stats) = self.tasks.get_mut(task) {
            stats.record(execution);
        }
    }

    /// Takes over what another one, of other tasks, has.
    pub fn merge(&mut self, other: Stats) {
        self.elapsed_ns = self.elapsed_ns.max(other.elapsed_ns);
        for (own, other) in self.tasks.iter_mut().zip(other.tasks) {
            if !other.execution.is_empty() {
                *own = other;
            }
        }
    }

    /// The reaction time of a task.
    pub fn reaction(&self, task: usize, deadline_ns: Option<i64>) -> Reaction {
        let stats = &self.tasks[task];
        Reaction {
            max_cycle_ns: stats.execution.max() as i64,
            release_delay_ns: stats.release_delay_ns,
            observed_ns: stats.observed_ns,
            deadline_ns,
        }
    }

    /// The report of some tasks, with their counts; `json` chooses the form.
    pub fn report(&self, image: &Image, tasks: Range<usize>, counts: &[Counts], json: bool) -> String {
        let rows: Vec<Row> = tasks
            .zip(counts)
            .map(|(n, counts)| Row {
                name: shown(image, &image.tasks[n]),
                stats: &self.tasks[n],
                counts: *counts,
                reaction: self.reaction(n, image.tasks[n].deadline_ns),
            })
            .collect();
        if json { self.as_json(&rows) } else { self.as_text(&rows) }
    }

    /// The histograms as a drawing.
    pub fn svg(&self, image: &Image) -> String {
        let rows = image.tasks.iter().zip(&self.tasks);
        svg::drawing(rows.map(|(task, stats)| (shown(image, task), MEASURES.iter().copied().zip(stats.histograms()))))
    }
}

/// What a report says of a task.
struct Row<'s> {
    name: String,
    stats: &'s TaskStats,
    counts: Counts,
    reaction: Reaction,
}

impl Stats {
    fn as_json(&self, rows: &[Row]) -> String {
        let rows = rows.iter().map(|Row { name, stats, counts, reaction }| {
        let deadline = reaction.deadline_ns.map_or("null".into(), |ns| ns.to_string());
        format!(
            "{{\"task\":{name},\"cycles\":{},\"overruns\":{},\"skipped\":{},{},\"wake_up\":{{{}}},\"period\":{{{}}},\
             \"reaction\":{{\"max_cycle_ns\":{},\"release_delay_ns\":{},\"worst_ns\":{},\"observed_ns\":{},\
             \"deadline_ns\":{deadline},\"missed\":{}}}}}",
            counts.executed,
            counts.overruns,
            counts.skipped,
            json_values(&stats.execution),
            json_values(&stats.wake_up),
            json_values(&stats.period),
            reaction.max_cycle_ns,
            reaction.release_delay_ns,
            reaction.worst_ns(),
            reaction.observed_ns,
            reaction.missed(),
            name = quoted(name),
        )
    });
        let page_faults = self.page_faults.map_or("null".into(), |n| n.to_string());
        let elapsed = self.elapsed_ns.map_or("null".into(), |n| n.to_string());
        let rows = rows.collect::<Vec<_>>().join(",");
        format!("{{\"tasks\":[{rows}],\"page_faults\":{page_faults},\"elapsed_ns\":{elapsed}}}\n")
    }

    fn as_text(&self, rows: &[Row]) -> String {
        let width = rows.iter().map(|r| r.name.chars().count()).max().unwrap_or(0).max(14) + 2;
        let mut out = String::new();
        // Writing to a String does not fail.
        let _ = write!(out, "{:<width$}{:>12}", "task [ns]", "cycles");
        for name in ["min", "mean", "p50", "p99", "p99.9", "max", "overruns", "skipped"] {
            let _ = write!(out, "{name:>12}");
        }
        out.push('\n');
        for Row { name, stats, counts, .. } in rows {
            let _ = write!(out, "{name:<width$}{:>12}", counts.executed);
            for (_, value) in values(&stats.execution) {
                let _ = write!(out, "{value:>12}");
            }
            let _ = writeln!(out, "{:>12}{:>12}", counts.overruns, counts.skipped);
            for (what, histogram) in MEASURES.iter().zip(stats.histograms()).skip(1) {
                if histogram.is_empty() {
                    continue;
                }
                let _ = write!(out, "{:<width$}{:>12}", format!("  {what}"), histogram.len());
                for (_, value) in values(histogram) {
                    let _ = write!(out, "{value:>12}");
                }
                out.push('\n');
            }
        }
        for Row { name, reaction, .. } in rows {
            let _ = write!(
                out,
                "reaction time of {name}: worst {} = 2 x {} + {} (longest cycle, release delay), longest seen {}",
                reaction.worst_ns(),
                reaction.max_cycle_ns,
                reaction.release_delay_ns,
                reaction.observed_ns
            );
            if let Some(deadline) = reaction.deadline_ns {
                let _ = write!(out, "; deadline {deadline}: {}", if reaction.missed() { "MISSED" } else { "kept" });
            }
            out.push('\n');
        }
        if let Some(page_faults) = self.page_faults {
            let _ = writeln!(out, "page faults in cycles: {page_faults}");
        }
        if let Some(elapsed) = self.elapsed_ns {
            let _ = writeln!(out, "elapsed since the first release: {elapsed}");
        }
        out
    }
}

impl TaskStats {
    fn new() -> Self {
        let histogram = || {
            // The bounds are constants that the crate accepts.
            let mut histogram =
                Histogram::new_with_bounds(1, LONGEST_NS, 3).unwrap_or_else(|_| unreachable!("fixed bounds"));
            // Writes every counter: no page of them is touched for the first time in a cycle.
            histogram.saturating_record(1);
            histogram.reset();
            histogram
        };
        Self {
            execution: histogram(),
            wake_up: histogram(),
            period: histogram(),
            last: None,
            release_delay_ns: 0,
            observed_ns: 0,
        }
    }

    fn histograms(&self) -> [&Histogram<u64>; 3] {
        [&self.execution, &self.wake_up, &self.period]
    }

    fn record(&mut self, e: Execution) {
        let took = e.end_ns - e.start_ns;
        put(&mut self.execution, took);
        if let Some(release) = e.release_ns {
            put(&mut self.wake_up, e.start_ns - release);
        }
        let (delay, seen) = match (&self.last, e.release_ns) {
            (None, _) => (0, took),
            (Some(last), Some(_)) => {
                put(&mut self.period, e.start_ns - last.start_ns);
                (e.start_ns - last.end_ns, e.end_ns - last.start_ns)
            }
            // In virtual time executions take the time they take, but releases are as far apart as the scan clock says.
            (Some(last), None) => {
                let period = e.now_ns - last.now_ns;
                put(&mut self.period, period);
                let before = last.end_ns - last.start_ns;
                ((period - before).max(0), period.max(before) + took)
            }
        };
        self.release_delay_ns = self.release_delay_ns.max(delay);
        self.observed_ns = self.observed_ns.max(seen);
        self.last = Some(e);
    }
}

fn put(histogram: &mut Histogram<u64>, ns: i64) {
    histogram.saturating_record((ns.max(1) as u64).min(LONGEST_NS));
}

/// The name of a task in reports.
pub fn shown(image: &Image, task: &Task) -> String {
    let name = if task.name.is_empty() { "(every tick)" } else { &task.name };
    match image.resources.get(task.resource as usize) {
        Some(resource) if image.resources.len() > 1 => format!("{}.{name}", resource.name),
        _ => name.to_string(),
    }
}

fn values(h: &Histogram<u64>) -> [(&'static str, u64); 6] {
    [
        ("min_ns", h.min()),
        ("mean_ns", h.mean() as u64),
        ("p50_ns", h.value_at_quantile(0.5)),
        ("p99_ns", h.value_at_quantile(0.99)),
        ("p99_9_ns", h.value_at_quantile(0.999)),
        ("max_ns", h.max()),
    ]
}

fn json_values(h: &Histogram<u64>) -> String {
    let values = values(h).map(|(name, value)| format!("\"{name}\":{value}")).join(",");
    let counts: Vec<String> =
        h.iter_recorded().map(|v| format!("[{},{}]", v.value_iterated_to(), v.count_at_value())).collect();
    format!("{values},\"histogram\":[{}]", counts.join(","))
}

/// A JSON string; names are IEC identifiers and dots.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(deadline_ns: Option<i64>) -> Image {
        Image { tasks: vec![Task { name: "Fast".into(), deadline_ns, ..Task::default() }], ..Image::default() }
    }

    /// Executions of 100, 300 and 200 ns, released every 1000 ns, each 50 ns late.
    fn stats() -> Stats {
        let mut stats = Stats::new(1);
        for (n, took) in [100, 300, 200].into_iter().enumerate() {
            let release = 1000 * n as i64;
            let start = release + 50;
            let execution =
                Execution { now_ns: release, release_ns: Some(release), start_ns: start, end_ns: start + took };
            stats.record(0, execution);
        }
        stats
    }

    #[test]
    fn both_forms_tell_the_same() {
        let (image, counts) = (image(Some(1500)), [Counts { executed: 3, overruns: 4, skipped: 5 }]);
        assert_eq!(
            stats().report(&image, 0..1, &counts, true),
            "{\"tasks\":[{\"task\":\"Fast\",\"cycles\":3,\"overruns\":4,\"skipped\":5,\"min_ns\":100,\"mean_ns\":200,\
             \"p50_ns\":200,\"p99_ns\":300,\"p99_9_ns\":300,\"max_ns\":300,\"histogram\":[[100,1],[200,1],[300,1]],\
             \"wake_up\":{\"min_ns\":50,\"mean_ns\":50,\"p50_ns\":50,\"p99_ns\":50,\"p99_9_ns\":50,\"max_ns\":50,\
             \"histogram\":[[50,3]]},\"period\":{\"min_ns\":1000,\"mean_ns\":1000,\"p50_ns\":1000,\"p99_ns\":1000,\
             \"p99_9_ns\":1000,\"max_ns\":1000,\"histogram\":[[1000,2]]},\"reaction\":{\"max_cycle_ns\":300,\
             \"release_delay_ns\":900,\"worst_ns\":1500,\"observed_ns\":1300,\"deadline_ns\":1500,\"missed\":false}}],\
             \"page_faults\":null,\"elapsed_ns\":null}\n"
        );
        let text = stats().report(&image, 0..1, &counts, false);
        let words: Vec<&str> = text.lines().nth(1).unwrap().split_whitespace().collect();
        assert_eq!(words, ["Fast", "3", "100", "200", "200", "300", "300", "300", "4", "5"]);
        assert!(text.contains("worst 1500 = 2 x 300 + 900 "), "{text}");
        assert!(text.ends_with("deadline 1500: kept\n"), "{text}");
    }

    #[test]
    fn a_deadline_is_missed_by_a_nanosecond() {
        assert!(!stats().reaction(0, Some(1500)).missed());
        assert!(stats().reaction(0, Some(1499)).missed());
        assert!(!stats().reaction(0, None).missed());
    }

    /// In virtual time the release delay is what the scan clock leaves between executions.
    #[test]
    fn virtual_time_waits_as_long_as_its_clock_says() {
        let mut stats = Stats::new(1);
        for n in 0..3 {
            let start = 10 * n;
            stats.record(0, Execution { now_ns: 1000 * n, release_ns: None, start_ns: start, end_ns: start + 4 });
        }
        let reaction = stats.reaction(0, None);
        assert_eq!((reaction.release_delay_ns, reaction.observed_ns, reaction.worst_ns()), (996, 1004, 1004));
    }

    #[test]
    fn the_drawing_has_every_measured_bar() {
        let svg = stats().svg(&image(None));
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
        for what in ["Fast", "execution", "wake-up", "period"] {
            assert!(svg.contains(what), "{what}");
        }
        // Three different execution times, one latency, one period.
        assert_eq!(svg.matches("<rect class=\"bar\"").count(), 5);
    }
}
