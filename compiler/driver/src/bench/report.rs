//! A report of measured programs as Markdown and JSON. Which lanes there are, and which one the others are compared with, is
//! the caller's choice.

use crate::bench::measure::Times;
use crate::bench::stats::geometric_mean;
use serde::Serialize;
use std::fmt::Write;

/// Everything that was measured in one run.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Report {
    /// Its heading.
    pub title: String,
    /// What it ran on, one fact a line.
    pub machine: Vec<String>,
    /// The lanes in the order of the columns.
    pub lanes: Vec<LaneAbout>,
    /// The lane that ratios refer to.
    pub base: String,
    /// The programs in the order of the rows.
    pub programs: Vec<ProgramReport>,
    /// How it was measured, one fact a line.
    pub method: Vec<String>,
}

/// A lane.
#[derive(Debug, Clone, Serialize)]
pub struct LaneAbout {
    /// Its name.
    pub name: &'static str,
    /// What runs in it.
    pub what: &'static str,
}

/// A program.
#[derive(Debug, Clone, Default, Serialize)]
pub struct ProgramReport {
    /// Its name.
    pub name: String,
    /// What it does, in one line.
    pub what: String,
    /// Lines of source.
    pub lines: usize,
    /// Cycles a batch.
    pub batch: u64,
    /// Cycles that were timed one by one.
    pub cycles: u64,
    /// Its lanes.
    pub lanes: Vec<LaneReport>,
    /// CPU milliseconds of each stage of the compiler, in its order.
    pub compile_ms: Vec<(&'static str, f64)>,
    /// CPU milliseconds of each pass of the optimiser.
    pub passes_ms: Vec<(&'static str, f64)>,
}

/// What a lane took.
#[derive(Debug, Clone, Serialize)]
pub struct LaneReport {
    /// Its name.
    pub name: &'static str,
    /// The median over batches of the mean cycle of a batch, nanoseconds.
    pub median_ns: f64,
    /// Of cycles timed one by one: 99 % are not longer.
    pub p99_ns: f64,
    /// 99.9 % are not longer.
    pub p99_9_ns: f64,
    /// The longest that was seen.
    pub worst_ns: f64,
    /// The longest cycle after the least of each cycle's repeats was taken.
    pub undisturbed_worst_ns: f64,
    /// Bytes of machine code.
    pub code_bytes: Option<u64>,
    /// Instructions a cycle.
    pub instructions: Option<Instructions>,
    /// Operations that the interpreter executes in a cycle, mean.
    pub operations: Option<f64>,
}

/// Instructions that a cycle executes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Instructions {
    /// Cycles counted.
    pub cycles: u64,
    /// Mean.
    pub mean: f64,
    /// Of the cycle with the most.
    pub greatest: u64,
}

impl LaneReport {
    /// From times.
    pub fn new(name: &'static str, times: &Times) -> Self {
        Self {
            name,
            median_ns: times.batches.at(0.5),
            p99_ns: times.singles.at(0.99),
            p99_9_ns: times.singles.at(0.999),
            worst_ns: times.singles.worst(),
            undisturbed_worst_ns: times.floors.worst(),
            code_bytes: None,
            instructions: None,
            operations: None,
        }
    }
}

impl ProgramReport {
    /// A lane of it.
    pub fn lane(&self, name: &str) -> Option<&LaneReport> {
        self.lanes.iter().find(|l| l.name == name)
    }

    /// A figure of a lane relative to that of another one.
    pub fn ratio(&self, lane: &str, base: &str, figure: impl Fn(&LaneReport) -> Option<f64>) -> Option<f64> {
        let (a, b) = (figure(self.lane(lane)?)?, figure(self.lane(base)?)?);
        (b > 0.0).then(|| a / b)
    }

    /// CPU milliseconds from source to running.
    pub fn total_compile_ms(&self) -> f64 {
        self.compile_ms.iter().map(|(_, ms)| ms).sum()
    }
}

/// The mean of a lane, to be shown.
type Mean<'a> = &'a dyn Fn(&str) -> Option<String>;

/// A figure of a lane.
pub type Figure = fn(&LaneReport) -> Option<f64>;

/// The figures by name.
pub mod figure {
    use super::LaneReport;

    /// The typical cycle.
    pub fn median(lane: &LaneReport) -> Option<f64> {
        Some(lane.median_ns)
    }
    /// The longest cycle seen.
    pub fn worst(lane: &LaneReport) -> Option<f64> {
        Some(lane.worst_ns)
    }
    /// The longest cycle when nothing disturbs it.
    pub fn undisturbed_worst(lane: &LaneReport) -> Option<f64> {
        Some(lane.undisturbed_worst_ns)
    }
    /// The most instructions of a cycle.
    pub fn greatest_instructions(lane: &LaneReport) -> Option<f64> {
        lane.instructions.map(|i| i.greatest as f64)
    }
    /// The mean instructions of a cycle.
    pub fn mean_instructions(lane: &LaneReport) -> Option<f64> {
        lane.instructions.map(|i| i.mean)
    }
    /// Operations of the interpreter.
    pub fn operations(lane: &LaneReport) -> Option<f64> {
        lane.operations
    }
    /// Nanoseconds that the interpreter takes for an operation.
    pub fn ns_an_operation(lane: &LaneReport) -> Option<f64> {
        lane.operations.filter(|n| *n > 0.0).map(|n| lane.median_ns / n)
    }
    /// Machine code.
    pub fn code_bytes(lane: &LaneReport) -> Option<f64> {
        lane.code_bytes.map(|b| b as f64)
    }
}

impl Report {
    /// The geometric mean over the programs of a figure of a lane relative to that of another one; programs that lack one of
    /// them do not count.
    pub fn mean_ratio(&self, lane: &str, base: &str, figure: Figure) -> Option<f64> {
        geometric_mean(self.programs.iter().filter_map(|p| p.ratio(lane, base, figure)))
    }

    /// As JSON.
    pub fn json(&self) -> String {
        // Plain data always serialises.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// Heading, machine, lanes.
    pub fn head(&self) -> String {
        let mut out = format!("# {}\n\n", self.title);
        self.machine.iter().for_each(|line| out.push_str(&format!("- {line}\n")));
        out.push_str("\n| lane | what runs |\n|---|---|\n");
        self.lanes.iter().for_each(|lane| out.push_str(&format!("| {} | {} |\n", lane.name, lane.what)));
        out
    }

    /// A table of one figure: programs by lanes.
    pub fn table(&self, heading: &str, text: &str, figure: Figure, show: fn(f64) -> String) -> String {
        self.grid(heading, text, |program, lane| program.lane(lane).and_then(figure).map(show), None)
    }

    /// A table of one figure relative to the base lane, with geometric means.
    pub fn ratios(&self, heading: &str, text: &str, figure: Figure) -> String {
        let cell = |program: &ProgramReport, lane: &str| program.ratio(lane, &self.base, figure).map(two);
        let mean = |lane: &str| self.mean_ratio(lane, &self.base, figure).map(two);
        self.grid(heading, text, cell, Some(&mean))
    }

    fn grid(
        &self,
        heading: &str,
        text: &str,
        cell: impl Fn(&ProgramReport, &str) -> Option<String>,
        mean: Option<Mean>,
    ) -> String {
        let has = |lane: &&LaneAbout| self.programs.iter().any(|p| cell(p, lane.name).is_some());
        let lanes: Vec<&LaneAbout> = self.lanes.iter().filter(has).collect();
        if lanes.is_empty() {
            return String::new();
        }
        let mut out = format!("\n## {heading}\n\n{text}\n\n| program |");
        lanes.iter().for_each(|lane| out.push_str(&format!(" {} |", lane.name)));
        out.push_str(&format!("\n|---|{}\n", "---:|".repeat(lanes.len())));
        let missing = || String::from("–");
        for program in &self.programs {
            let _ = write!(out, "| {} |", program.name);
            lanes.iter().for_each(|lane| {
                let _ = write!(out, " {} |", cell(program, lane.name).unwrap_or_else(missing));
            });
            out.push('\n');
        }
        if let Some(mean) = mean {
            out.push_str("| **geometric mean** |");
            lanes.iter().for_each(|lane| {
                let _ = write!(out, " **{}** |", mean(lane.name).unwrap_or_else(missing));
            });
            out.push('\n');
        }
        out
    }

    /// The slow cycles of the lanes that matter, a row for each.
    pub fn tails(&self, heading: &str, text: &str, lanes: &[&str]) -> String {
        let mut out = format!(
            "\n## {heading}\n\n{text}\n\n| program | lane | p99 | p99.9 | worst | undisturbed worst |\n|---|---|---:|---:|---:|---:|\n"
        );
        for program in &self.programs {
            let rows = lanes.iter().filter_map(|name| program.lane(name));
            for (n, lane) in rows.enumerate() {
                let name = if n == 0 { program.name.as_str() } else { "" };
                let [a, b, c, d] = [lane.p99_ns, lane.p99_9_ns, lane.worst_ns, lane.undisturbed_worst_ns].map(whole);
                let _ = writeln!(out, "| {name} | {} | {a} | {b} | {c} | {d} |", lane.name);
            }
        }
        out
    }

    /// What compiling took.
    pub fn compile_times(&self, heading: &str, text: &str) -> String {
        let Some(first) = self.programs.first() else { return String::new() };
        let mut out = format!("\n## {heading}\n\n{text}\n\n| program | lines |");
        first.compile_ms.iter().for_each(|(stage, _)| out.push_str(&format!(" {stage} |")));
        out.push_str(&format!(" all |\n|---|---:|{}---:|\n", "---:|".repeat(first.compile_ms.len())));
        for program in &self.programs {
            let _ = write!(out, "| {} | {} |", program.name, program.lines);
            program.compile_ms.iter().for_each(|(_, ms)| out.push_str(&format!(" {ms:.2} |")));
            let _ = writeln!(out, " {:.2} |", program.total_compile_ms());
        }
        out
    }

    /// What the passes of the optimiser took, over all programs.
    pub fn passes(&self, heading: &str, text: &str) -> String {
        let mut sums: Vec<(&str, f64)> = Vec::new();
        for (name, ms) in self.programs.iter().flat_map(|p| &p.passes_ms) {
            match sums.iter_mut().find(|(n, _)| n == name) {
                Some((_, sum)) => *sum += ms,
                None => sums.push((name, *ms)),
            }
        }
        if sums.is_empty() {
            return String::new();
        }
        let mut out = format!("\n## {heading}\n\n{text}\n\n| pass | CPU ms |\n|---|---:|\n");
        sums.iter().for_each(|(name, ms)| out.push_str(&format!("| {name} | {ms:.2} |\n")));
        out
    }

    /// How it was measured.
    pub fn tail(&self) -> String {
        let mut out = "\n## Method\n\n".to_string();
        self.method.iter().for_each(|line| out.push_str(&format!("- {line}\n")));
        out
    }
}

/// Nanoseconds, bytes, instructions: three digits are enough below a hundred.
pub fn whole(value: f64) -> String {
    if value < 100.0 { format!("{value:.1}") } else { format!("{value:.0}") }
}

/// A ratio.
pub fn two(value: f64) -> String {
    if value < 10.0 { format!("{value:.2}") } else { format!("{value:.1}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lane(name: &'static str, median_ns: f64, code_bytes: Option<u64>) -> LaneReport {
        LaneReport { median_ns, code_bytes, ..LaneReport::new(name, &Times::default()) }
    }

    fn report() -> Report {
        let about = |name| LaneAbout { name, what: "w" };
        let program = |name: &str, a, b| ProgramReport {
            name: name.into(),
            lanes: vec![lane("a", a, None), lane("b", b, Some(12))],
            ..ProgramReport::default()
        };
        Report {
            title: "T".into(),
            lanes: vec![about("a"), about("b")],
            base: "b".into(),
            programs: vec![program("one", 200.0, 100.0), program("two", 50.0, 100.0)],
            ..Report::default()
        }
    }

    #[test]
    fn ratios_have_their_geometric_mean() {
        let text = report().ratios("R", "t", figure::median);
        assert_eq!(
            text,
            "\n## R\n\nt\n\n| program | a | b |\n|---|---:|---:|\n| one | 2.00 | 1.00 |\n| two | 0.50 | 1.00 |\n\
             | **geometric mean** | **1.00** | **1.00** |\n"
        );
    }

    #[test]
    fn lanes_without_a_figure_have_no_column() {
        let text = report().table("C", "t", figure::code_bytes, whole);
        assert!(text.contains("| program | b |\n|---|---:|\n| one | 12.0 |"), "{text}");
        assert_eq!(report().table("I", "t", figure::mean_instructions, whole), "");
    }
}
