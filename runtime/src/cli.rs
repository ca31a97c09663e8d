//! The run flags of `plcc run` and of linked programs (the contract is in docs/cli.md).

use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// How an application is run.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Run flags")]
pub struct RunFlags {
    /// Stop after N cycles of the base tick; without it run until SIGINT or SIGTERM.
    #[arg(long, value_name = "N")]
    pub cycles: Option<u64>,
    /// Base tick (10ms without a CONFIGURATION, else the greatest common divisor of the tasks' INTERVALs).
    #[arg(long, value_name = "TIME", value_parser = parse_interval)]
    pub interval: Option<i64>,
    /// Do not sleep: cycle n happens at (n-1)*interval exactly.
    #[arg(long)]
    pub virtual_time: bool,
    /// Values of inputs by cycle, as CSV (- is standard input).
    #[arg(long, value_name = "in.csv")]
    pub stimulus: Option<PathBuf>,
    /// Variables of the trace; without it all.
    #[arg(long, value_name = "A,B,C")]
    pub watch: Option<String>,
    /// Write the trace as CSV (- is standard output, also where only --watch is given).
    #[arg(long, value_name = "out.csv")]
    pub trace: Option<PathBuf>,
    /// Write the trace as a VCD waveform.
    #[arg(long, value_name = "out.vcd")]
    pub vcd: Option<PathBuf>,
    /// Where RETAIN variables live.
    #[arg(long, value_name = "FILE")]
    pub retain: Option<PathBuf>,
    /// On exit, print execution times and overruns of each task.
    #[arg(long, value_name = "FORMAT", value_enum, num_args = 0..=1, default_missing_value = "text")]
    pub stats: Option<StatsFormat>,
}

/// `--stats`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StatsFormat {
    /// A table.
    Text,
    /// One JSON object.
    Json,
}

/// `--interval`: a duration above 0.
fn parse_interval(text: &str) -> Result<i64, String> {
    match parse_duration(text)? {
        0 => Err("the interval must be longer than 0".into()),
        ns => Ok(ns),
    }
}

/// Units and their nanoseconds, in the order in which they may follow each other.
const UNITS: [(&str, i128); 7] = [
    ("d", 86_400_000_000_000),
    ("h", 3_600_000_000_000),
    ("m", 60_000_000_000),
    ("s", 1_000_000_000),
    ("ms", 1_000_000),
    ("us", 1_000),
    ("ns", 1),
];

/// A duration in nanoseconds: `10ms`, `1.5s`, `1m30s`, `2us`, `T#10ms`. Never negative.
pub fn parse_duration(text: &str) -> Result<i64, String> {
    let lower = text.trim().to_ascii_lowercase();
    let mut rest = ["time#", "ltime#", "t#", "lt#"].iter().find_map(|p| lower.strip_prefix(p)).unwrap_or(&lower);
    let malformed = || format!("`{text}` is no duration; write for example 10ms, 1.5s or 1m30s");
    if rest.is_empty() {
        return Err(malformed());
    }
    let (mut total, mut next_unit) = (0i128, 0);
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.' && c != '_').unwrap_or(rest.len());
        let (number, tail) = rest.split_at(digits);
        let letters = tail.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(tail.len());
        let (unit, tail) = tail.split_at(letters);
        if unit.is_empty() && !number.is_empty() {
            return Err(format!("`{text}` needs a unit: d, h, m, s, ms, us or ns"));
        }
        let index = UNITS.iter().position(|(name, _)| *name == unit).ok_or_else(malformed)?;
        if index < next_unit {
            return Err(format!("`{text}`: the units must fall, each once (d h m s ms us ns)"));
        }
        total = decimal(number, UNITS[index].1).and_then(|ns| total.checked_add(ns)).ok_or_else(malformed)?;
        next_unit = index + 1;
        rest = tail;
        if number.contains('.') && !rest.is_empty() {
            return Err(format!("`{text}`: only the last unit may have a fraction"));
        }
    }
    i64::try_from(total).map_err(|_| format!("`{text}` is longer than 292 years"))
}

/// `number` times `scale`, cut to an integer; `None` if it is no decimal number.
fn decimal(number: &str, scale: i128) -> Option<i128> {
    let number = number.replace('_', "");
    let (whole, fraction) = number.split_once('.').unwrap_or((&number, "0"));
    let digit = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    // 20 digits of fraction are more than a day has in nanoseconds.
    if !digit(whole) || !digit(fraction) || whole.len() > 20 {
        return None;
    }
    let fraction = &fraction[..fraction.len().min(20)];
    let whole: i128 = whole.parse().ok()?;
    let part: i128 = fraction.parse().ok()?;
    whole.checked_mul(scale)?.checked_add(part * scale / 10i128.pow(fraction.len() as u32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations() {
        assert_eq!(parse_duration("10ms"), Ok(10_000_000));
        assert_eq!(parse_duration("2us"), Ok(2_000));
        assert_eq!(parse_duration("1.5s"), Ok(1_500_000_000));
        assert_eq!(parse_duration("T#10ms"), Ok(10_000_000));
        assert_eq!(parse_duration("ltime#1h"), Ok(3_600_000_000_000));
        assert_eq!(parse_duration("1m30s"), Ok(90_000_000_000));
        assert_eq!(parse_duration("0.1d"), Ok(8_640_000_000_000));
        assert_eq!(parse_duration("0s"), Ok(0));
    }

    #[test]
    fn what_is_no_duration() {
        for text in ["", "T#", "10", "ms", "-5ms", "1s2m", "1s1s", "1.5s20ms", "1.s", ".5s", "1e3s", "10 ms", "1x"] {
            assert!(parse_duration(text).is_err(), "{text}");
        }
        assert!(parse_duration("10").unwrap_err().contains("unit"));
        assert!(parse_duration("99999999999d").is_err());
        assert!(parse_duration("999999999999999999999999999999999999999999s").is_err());
        assert!(parse_interval("0ms").is_err());
    }
}
