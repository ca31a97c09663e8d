//! `plcc trace`: a trace as a timing diagram, one lane a column: levels of a BOOL, steps of a chart as filled bars, numbers
//! as a curve with their values, everything else as words. Vertical lines are cycles.

use crate::cli::TraceArgs;
use crate::failure::Failure;
use std::fmt::Write as _;
use std::io::Write as _;

const LEFT: f64 = 190.0;
const TOP: f64 = 34.0;
const LANE: f64 = 34.0;
const GAP: f64 = 14.0;
/// Width of a cycle, pixels: as wide as fits, within these, but narrower in a drawing that would get wider than the last.
const CYCLE: (f64, f64) = (2.0, 28.0);
const WIDTH: f64 = 1100.0;
const WIDEST: f64 = 20_000.0;

/// A column of the trace.
struct Lane {
    name: String,
    /// One for each cycle.
    values: Vec<String>,
}

#[derive(Clone, Copy, PartialEq)]
enum Form {
    Level,
    Step,
    Number,
    Word,
}

/// Does it.
pub fn trace(args: &TraceArgs) -> Result<u8, Failure> {
    let bytes = std::fs::read(&args.trace).map_err(|e| Failure::io("read", &args.trace, e))?;
    let name = args.trace.display().to_string();
    let (cycles, lanes) = read(&bytes).map_err(|e| Failure::usage(format!("{name}: {e}")))?;
    let lanes = chosen(lanes, args.watch.as_deref()).map_err(|e| Failure::usage(format!("{name}: {e}")))?;
    let range = args.cycles.as_deref().map(parse_range).transpose().map_err(Failure::usage)?;
    let kept: Vec<usize> =
        (0..cycles.len()).filter(|n| range.is_none_or(|(first, last)| (first..=last).contains(&cycles[*n]))).collect();
    if kept.is_empty() {
        return Err(Failure::usage(format!("{name}: there are no such cycles")));
    }
    let cycles: Vec<u64> = kept.iter().map(|n| cycles[*n]).collect();
    let lanes: Vec<Lane> = lanes
        .into_iter()
        .map(|l| Lane { values: kept.iter().map(|n| l.values[*n].clone()).collect(), name: l.name })
        .collect();
    let svg = draw(&cycles, &lanes);
    match &args.svg {
        Some(path) => crate::link::write_file(path, svg.as_bytes())?,
        // A reader that went away does not matter.
        None => drop(std::io::stdout().write_all(svg.as_bytes())),
    }
    Ok(0)
}

fn read(bytes: &[u8]) -> Result<(Vec<u64>, Vec<Lane>), String> {
    let mut reader = csv::Reader::from_reader(bytes);
    let header = reader.headers().map_err(|e| e.to_string())?.clone();
    if !header.get(0).is_some_and(|c| c.trim().eq_ignore_ascii_case("cycle")) {
        return Err("no trace: its first column is not `cycle`".into());
    }
    let mut lanes: Vec<Lane> =
        header.iter().skip(1).map(|name| Lane { name: name.trim().to_string(), values: Vec::new() }).collect();
    let mut cycles = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| e.to_string())?;
        let cycle = record.get(0).unwrap_or_default();
        cycles.push(cycle.trim().parse().map_err(|_| format!("`{cycle}` is no cycle"))?);
        for (lane, value) in lanes.iter_mut().zip(record.iter().skip(1)) {
            lane.values.push(value.to_string());
        }
    }
    if cycles.is_empty() { Err("the trace has no rows".into()) } else { Ok((cycles, lanes)) }
}

fn chosen(mut lanes: Vec<Lane>, watch: Option<&str>) -> Result<Vec<Lane>, String> {
    let Some(watch) = watch else { return Ok(lanes) };
    let mut wanted = Vec::new();
    for name in plcc_runtime::path::split_names(watch) {
        let Some(at) = lanes.iter().position(|l| l.name.eq_ignore_ascii_case(name)) else {
            let hint = plcc_hir::similar(name, lanes.iter().map(|l| l.name.as_str()));
            let hint = hint.map(|h| format!("; did you mean `{h}`?")).unwrap_or_default();
            return Err(format!("there is no column `{name}`{hint}"));
        };
        wanted.push(lanes.remove(at));
    }
    Ok(wanted)
}

fn parse_range(text: &str) -> Result<(u64, u64), String> {
    let wrong = || format!("--cycles: `{text}` is not FIRST..LAST");
    let (first, last) = text.split_once("..").ok_or_else(wrong)?;
    let number = |text: &str, open: u64| match text.trim() {
        "" => Ok(open),
        digits => digits.parse().map_err(|_| wrong()),
    };
    Ok((number(first, 0)?, number(last, u64::MAX)?))
}

impl Lane {
    fn form(&self) -> Form {
        let all = |f: fn(&str) -> bool| self.values.iter().all(|v| f(v));
        if all(|v| matches!(v, "TRUE" | "FALSE")) {
            return if self.name.to_ascii_uppercase().ends_with(".X") { Form::Step } else { Form::Level };
        }
        if all(|v| number(v).is_some()) { Form::Number } else { Form::Word }
    }
}

fn draw(cycles: &[u64], lanes: &[Lane]) -> String {
    let count = cycles.len() as f64;
    let step = ((WIDTH - LEFT) / count).clamp(CYCLE.0, CYCLE.1).min(WIDEST / count);
    let width = LEFT + step * cycles.len() as f64 + 20.0;
    let height = TOP + lanes.len() as f64 * (LANE + GAP) + 10.0;
    let mut out = String::new();
    // Writing to a String does not fail.
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
         height=\"{height:.0}\">\n<style>text{{font:12px sans-serif;fill:#222}}.small{{font-size:10px;fill:#555}}\
         .grid{{stroke:#ddd}}.line{{fill:none;stroke:#1f5fa8;stroke-width:1.6}}.step{{fill:#e8a33d}}.word{{fill:#eef;\
         stroke:#88a}}@media(prefers-color-scheme:dark){{text{{fill:#ddd}}.small{{fill:#aaa}}.grid{{stroke:#444}}\
         .line{{stroke:#7fb6f0}}.word{{fill:#223;stroke:#778}}}}</style>\n"
    );
    grid(&mut out, cycles, step, height);
    for (n, lane) in lanes.iter().enumerate() {
        let top = TOP + n as f64 * (LANE + GAP);
        let _ = writeln!(
            out,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>",
            LEFT - 8.0,
            top + LANE / 2.0 + 4.0,
            escaped(&shortened(&lane.name, 28))
        );
        match lane.form() {
            Form::Level => level(&mut out, lane, top, step),
            Form::Step => bars(&mut out, lane, top, step),
            Form::Number => curve(&mut out, lane, top, step),
            Form::Word => words(&mut out, lane, top, step),
        }
    }
    out.push_str("</svg>\n");
    out
}

/// A line for each cycle while they are far enough apart, and numbers that do not overlap.
fn grid(out: &mut String, cycles: &[u64], step: f64, height: f64) {
    let mut steps = (0..12).flat_map(|power| [1, 2, 5].map(|n| n * 10u64.pow(power)));
    let every = steps.find(|e| *e as f64 * step >= 26.0).unwrap_or(u64::MAX);
    for (n, cycle) in cycles.iter().enumerate() {
        let x = LEFT + n as f64 * step;
        let numbered = cycle % every == 0 || (every == 1 || n == 0);
        if step >= 6.0 || numbered {
            let _ = writeln!(
                out,
                "<line class=\"grid\" x1=\"{x:.1}\" y1=\"22\" x2=\"{x:.1}\" y2=\"{:.0}\"/>",
                height - 8.0
            );
        }
        if numbered {
            let _ = writeln!(out, "<text class=\"small\" x=\"{x:.1}\" y=\"16\">{cycle}</text>");
        }
    }
}

/// Where the value of a cycle begins.
fn x(n: usize, step: f64) -> f64 {
    LEFT + n as f64 * step
}

/// Runs of equal values: first cycle, one past the last, value.
fn runs(values: &[String]) -> Vec<(usize, usize, &str)> {
    let mut runs: Vec<(usize, usize, &str)> = Vec::new();
    for (n, value) in values.iter().enumerate() {
        match runs.last_mut() {
            Some((_, end, last)) if *last == value.as_str() => *end = n + 1,
            _ => runs.push((n, n + 1, value)),
        }
    }
    runs
}

fn level(out: &mut String, lane: &Lane, top: f64, step: f64) {
    let mut path = String::new();
    for (first, end, value) in runs(&lane.values) {
        let y = if value == "TRUE" { top + 4.0 } else { top + LANE - 4.0 };
        let command = if path.is_empty() { 'M' } else { 'L' };
        let _ = write!(path, "{command}{:.1} {y} L{:.1} {y} ", x(first, step), x(end, step));
    }
    let _ = writeln!(out, "<path class=\"line\" d=\"{}\"/>", path.trim_end());
}

fn bars(out: &mut String, lane: &Lane, top: f64, step: f64) {
    for (first, end, _) in runs(&lane.values).into_iter().filter(|r| r.2 == "TRUE") {
        let (left, width) = (x(first, step), x(end, step) - x(first, step));
        let _ = writeln!(
            out,
            "<rect class=\"step\" x=\"{left:.1}\" y=\"{}\" width=\"{width:.1}\" height=\"{}\"/>",
            top + 6.0,
            LANE - 12.0
        );
    }
}

/// A number or a duration, which is drawn as one.
fn number(value: &str) -> Option<f64> {
    if let Some(duration) = value.strip_prefix("T#").or_else(|| value.strip_prefix("LTIME#")) {
        return plcc_stdlib::literal::duration(duration).ok().map(|ns| ns as f64);
    }
    value.parse().ok().filter(|n: &f64| n.is_finite())
}

fn curve(out: &mut String, lane: &Lane, top: f64, step: f64) {
    let number = |v: &str| number(v).unwrap_or(0.0);
    let numbers = lane.values.iter().map(|v| number(v));
    let (low, high) = numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let span = if high > low { high - low } else { 1.0 };
    let mut path = String::new();
    let mut labels = String::new();
    let mut free = LEFT;
    for (first, end, value) in runs(&lane.values) {
        let y = top + LANE - 4.0 - (number(value) - low) / span * (LANE - 12.0);
        let command = if path.is_empty() { 'M' } else { 'L' };
        let _ = write!(path, "{command}{:.1} {y:.1} L{:.1} {y:.1} ", x(first, step), x(end, step));
        let (at, needed) = (x(first, step) + 2.0, 7.0 * value.len() as f64 + 4.0);
        if at >= free && (end - first) as f64 * step >= needed {
            let _ = writeln!(labels, "<text class=\"small\" x=\"{at:.1}\" y=\"{:.1}\">{value}</text>", y - 3.0);
            free = at + needed;
        }
    }
    let _ = writeln!(out, "<path class=\"line\" d=\"{}\"/>", path.trim_end());
    out.push_str(&labels);
}

fn words(out: &mut String, lane: &Lane, top: f64, step: f64) {
    for (first, end, value) in runs(&lane.values) {
        let (left, width) = (x(first, step), x(end, step) - x(first, step));
        let _ = writeln!(
            out,
            "<rect class=\"word\" x=\"{left:.1}\" y=\"{}\" width=\"{width:.1}\" height=\"{}\"><title>{}</title></rect>",
            top + 5.0,
            LANE - 10.0,
            escaped(value)
        );
        let room = ((width - 6.0) / 7.0).max(0.0) as usize;
        if room >= 2 {
            let _ = writeln!(
                out,
                "<text class=\"small\" x=\"{:.1}\" y=\"{}\">{}</text>",
                left + 3.0,
                top + LANE / 2.0 + 4.0,
                escaped(&shortened(value, room))
            );
        }
    }
}

fn shortened(text: &str, room: usize) -> String {
    if text.chars().count() <= room {
        return text.to_string();
    }
    text.chars().take(room.saturating_sub(1)).chain(['…']).collect()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_of_value_has_its_lane() {
        let text = "cycle,go,A.X,n,mode\n3,FALSE,TRUE,1,Idle\n4,TRUE,TRUE,-2,Idle\n5,TRUE,FALSE,4,Run<\n";
        let (cycles, lanes) = read(text.as_bytes()).unwrap();
        assert_eq!(cycles, [3, 4, 5]);
        let forms: Vec<Form> = lanes.iter().map(Lane::form).collect();
        assert!(forms == [Form::Level, Form::Step, Form::Number, Form::Word]);
        let svg = draw(&cycles, &lanes);
        // A level of two runs, a curve of three.
        assert!(svg.contains("d=\"M190.0 64 L218.0 64 L218.0 38 L274.0 38\""), "{svg}");
        assert_eq!(svg.matches("class=\"step\"").count(), 1);
        assert_eq!(svg.matches("class=\"word\"").count(), 2);
        assert!(svg.contains("Run&lt;") && svg.contains(">-2</text>"));
        assert_eq!(svg.matches("class=\"grid\"").count(), 3);
    }

    #[test]
    fn durations_are_curves_and_long_traces_stay_drawings() {
        assert_eq!((number("T#1s500ms"), number("T#-2ms"), number("inf")), (Some(1.5e9), Some(-2e6), None));
        let lane = Lane { name: "t".into(), values: (0..100_000).map(|n| format!("T#{n}ms")).collect() };
        let svg = draw(&(1..=100_000).collect::<Vec<_>>(), &[lane]);
        assert!(svg.contains("width=\"20210\""), "{}", &svg[..200]);
        // Numbered lines only.
        assert!(svg.matches("class=\"grid\"").count() < 800);
    }

    #[test]
    fn what_is_no_trace_is_said() {
        assert!(read(b"a,b\n1,2\n").err().unwrap().contains("not `cycle`"));
        assert!(read(b"cycle,b\n").err().unwrap().contains("no rows"));
        assert!(read(b"cycle,b\nx,2\n").err().unwrap().contains("`x` is no cycle"));
        assert!(parse_range("3").is_err());
        assert_eq!(parse_range("3..").unwrap(), (3, u64::MAX));
    }
}
