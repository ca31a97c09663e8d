//! The run flags: the same for `plcc run` and for every program that plcc built (docs/cli.md, "Run flags").

use crate::realtime;
use crate::release::Policy;
use clap::Args;
use std::path::PathBuf;

/// How to run.
#[derive(Debug, Clone, Default, Args)]
pub struct RunFlags {
    /// Stop after N cycles of the base tick; without it run until SIGINT or SIGTERM.
    #[arg(long, value_name = "N")]
    pub cycles: Option<u64>,
    /// Base tick, for example 10ms; default is the greatest common divisor of the tasks' intervals, 10ms without any.
    #[arg(long, value_name = "TIME", value_parser = parse_duration)]
    pub interval: Option<i64>,
    /// Do not sleep: cycle n happens at (n-1) * interval exactly.
    #[arg(long)]
    pub virtual_time: bool,
    /// Inputs as CSV; - is standard input.
    #[arg(long, value_name = "FILE")]
    pub stimulus: Option<PathBuf>,
    /// Variables of the trace, separated by commas.
    #[arg(long, value_name = "A,B,C")]
    pub watch: Option<String>,
    /// Write the trace as CSV; - is standard output.
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
    /// The trace as a VCD waveform.
    #[arg(long, value_name = "FILE")]
    pub vcd: Option<PathBuf>,
    /// Where RETAIN variables live.
    #[arg(long, value_name = "FILE")]
    pub retain: Option<PathBuf>,
    /// How often changed RETAIN variables are written to their file while the program runs (default 500ms).
    #[arg(long, value_name = "TIME", value_parser = parse_duration)]
    pub retain_flush: Option<i64>,
    /// Start with initial values: RETAIN variables forget what they kept.
    #[arg(long)]
    pub cold: bool,
    /// Print execution time, wake-up latency, period and reaction time on exit, and on SIGUSR1.
    #[arg(long, value_name = "FORMAT", num_args = 0..=1, default_missing_value = "text", value_parser = ["text", "json"])]
    pub stats: Option<String>,
    /// Draw the histograms of --stats on exit.
    #[arg(long, value_name = "FILE")]
    pub stats_svg: Option<PathBuf>,
    /// The reaction time that every task has to keep; exit code 1 if one does not.
    #[arg(long, value_name = "TIME", value_parser = parse_duration)]
    pub deadline: Option<i64>,
    /// The longest execution of every task, instead of what the project says (default 1s).
    #[arg(long, value_name = "TIME", value_parser = parse_duration)]
    pub watchdog: Option<i64>,
    /// What follows when a cycle runs past its next release.
    #[arg(long, value_enum, value_name = "POLICY", default_value_t = Policy::Asap)]
    pub overrun: Policy,
    /// What a fault does: stop the program, or restart the programs of its task.
    #[arg(long, value_enum, value_name = "POLICY")]
    pub on_fault: Option<OnFault>,
    /// At a fault show the variables of the statement in the last N cycles (20).
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "20", value_parser = clap::value_parser!(u16).range(1..=10_000))]
    pub history: Option<u16>,
    /// Where %I comes from and %Q goes to: none, csv:IN.csv,OUT.csv, shm:NAME.
    #[arg(long, value_name = "DRIVER")]
    pub io: Option<String>,
    /// Hold variables at values: NAME=VALUE,NAME=VALUE.
    #[arg(long, value_name = "A=1,B=2")]
    pub force: Option<String>,
    /// Run with SCHED_FIFO at a priority (60), locked memory, and on a CPU if one is given.
    #[arg(long, value_name = "PRIORITY[,CPU]", num_args = 0..=1, default_missing_value = "60", value_parser = realtime::parse)]
    pub realtime: Option<realtime::Request>,
}

/// What a fault does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum OnFault {
    /// The program stops, outputs go to their safe state.
    Stop,
    /// The programs of the task get their initial values and go on; its outputs go to their safe state once.
    RestartTask,
}

/// A duration as `10ms`, `1.5s`, `2us`, `T#1m30s`, in nanoseconds; more than zero.
pub fn parse_duration(text: &str) -> Result<i64, String> {
    let body = match text.split_once('#') {
        Some((prefix, rest)) if ["T", "TIME", "LT", "LTIME"].iter().any(|p| prefix.eq_ignore_ascii_case(p)) => rest,
        _ => text,
    };
    match plcc_stdlib::literal::duration(body) {
        Ok(ns) if ns > 0 => Ok(ns),
        Ok(_) => Err(format!("`{text}` is not more than zero")),
        Err(e) => Err(format!("`{text}`: {e}; write for example 10ms")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations() {
        assert_eq!(parse_duration("10ms"), Ok(10_000_000));
        assert_eq!(parse_duration("T#1.5s"), Ok(1_500_000_000));
        assert!(parse_duration("0ms").is_err());
        assert!(parse_duration("10").is_err());
        assert!(parse_duration("fast").is_err());
    }
}
