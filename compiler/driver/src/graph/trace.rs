//! The active steps of one cycle of a trace (docs/cli.md): columns `Instance.Step.X`.

use super::Named;
use crate::failure::Failure;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// One row of a trace: its step flags.
#[derive(Debug)]
pub struct Row {
    /// By instance path and step, both in capitals.
    flags: BTreeMap<(String, String), bool>,
    /// Instance paths as written.
    instances: BTreeMap<String, String>,
}

impl Row {
    /// Reads the row of a cycle.
    pub fn read(path: &Path, cycle: u64) -> Result<Self, Failure> {
        let text = std::fs::read_to_string(path).map_err(|e| Failure::io("read", path, e))?;
        Self::parse(&text, cycle).map_err(|problem| Failure::usage(format!("{}: {problem}", path.display())))
    }

    fn parse(text: &str, cycle: u64) -> Result<Self, String> {
        let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(text.as_bytes());
        let header = reader.headers().map_err(|e| e.to_string())?.clone();
        if !header.get(0).is_some_and(|h| h.trim().eq_ignore_ascii_case("cycle")) {
            return Err("the first column of a trace is `cycle`".into());
        }
        let mut last = None;
        for record in reader.records() {
            let record = record.map_err(|e| e.to_string())?;
            let number: Option<u64> = record.get(0).and_then(|n| n.trim().parse().ok());
            if number == Some(cycle) {
                return Ok(Self::of(&header, &record));
            }
            last = number.or(last);
        }
        let last = last.map(|n| format!("; the last one is {n}")).unwrap_or_default();
        Err(format!("there is no cycle {cycle}{last}"))
    }

    fn of(header: &csv::StringRecord, record: &csv::StringRecord) -> Self {
        let mut row = Self { flags: BTreeMap::new(), instances: BTreeMap::new() };
        for (column, value) in header.iter().zip(record.iter()).skip(1) {
            let column = column.trim();
            let Some((step, flag)) = column.rsplit_once('.') else { continue };
            if !flag.eq_ignore_ascii_case("x") {
                continue;
            }
            let (instance, step) = step.rsplit_once('.').unwrap_or(("", step));
            row.instances.entry(instance.to_uppercase()).or_insert_with(|| instance.to_string());
            row.flags.insert((instance.to_uppercase(), step.to_uppercase()), value.trim().eq_ignore_ascii_case("true"));
        }
        row
    }

    /// Marks the active steps of a chart. Without `instance` there must be one that has steps of this chart.
    pub fn mark(&self, named: &mut Named, instance: Option<&str>) -> Result<(), Failure> {
        let steps: BTreeSet<String> = named.chart.steps.iter().map(|s| s.name.to_uppercase()).collect();
        let fits = |i: &&String| self.flags.keys().any(|(of, step)| of == *i && steps.contains(step));
        let candidates: Vec<&String> = match instance {
            Some(wanted) => self.instances.keys().filter(|i| i.eq_ignore_ascii_case(wanted)).collect(),
            None => self.instances.keys().filter(fits).collect(),
        };
        let own: Vec<&String> =
            candidates.iter().copied().filter(|i| last_name(i).eq_ignore_ascii_case(&named.pou)).collect();
        let chosen = match (candidates.as_slice(), own.as_slice()) {
            ([one], _) | (_, [one]) => (*one).clone(),
            ([], _) => {
                let what = instance.map(|i| format!(" of `{i}`")).unwrap_or_default();
                let column = format!("{}.{}.X", instance.unwrap_or(&named.pou), first_step(named));
                return Err(Failure::usage(format!(
                    "the trace has no step flags{what} for chart `{}`, such as `{column}`",
                    named.name
                )));
            }
            _ => {
                let names: Vec<&str> = candidates.iter().map(|i| self.instances[*i].as_str()).collect();
                let message = format!(
                    "several instances have steps of `{}`; choose with --instance: {}",
                    named.name,
                    names.join(", ")
                );
                return Err(Failure::usage(message));
            }
        };
        for step in &mut named.chart.steps {
            step.active = self.flags.get(&(chosen.clone(), step.name.to_uppercase())).copied().unwrap_or(false);
        }
        Ok(())
    }
}

fn last_name(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}

fn first_step(named: &Named) -> &str {
    named.chart.steps.first().map_or("Step", |s| s.name.as_str())
}
