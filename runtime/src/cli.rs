//! The run flags: the same for `plcc run` and for every program that plcc built (docs/cli.md, "Run flags").

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
    /// Print execution times on exit.
    #[arg(long, value_name = "FORMAT", num_args = 0..=1, default_missing_value = "text", value_parser = ["text", "json"])]
    pub stats: Option<String>,
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
