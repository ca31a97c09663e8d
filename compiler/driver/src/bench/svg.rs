//! Bars of ratios as SVG: a group of bars for each program, one for each lane, a line at 1. The scale is logarithmic, so that
//! twice and half are equally far from the line. Colours follow the reader's light or dark scheme.

use crate::bench::report::{Figure, Report};
use std::fmt::Write;

const STYLE: &str = "\
.bench text { font: 12px system-ui, sans-serif; fill: #1f2933; }
.bench .paper { fill: #ffffff; }
.bench .title { font-size: 15px; font-weight: 600; }
.bench .grid { stroke: #d3d9df; stroke-width: 1; }
.bench .one { stroke: #1f2933; stroke-width: 1.5; }
.bench .value { font-size: 10px; }
.bench .bar0 { fill: #1d4ed8; } .bench .bar1 { fill: #0d9488; } .bench .bar2 { fill: #b45309; } .bench .bar3 { fill: #7c3aed; }
@media (prefers-color-scheme: dark) {
.bench text { fill: #e2e8f0; }
.bench .paper { fill: #14181d; }
.bench .grid { stroke: #39424d; }
.bench .one { stroke: #e2e8f0; }
.bench .bar0 { fill: #60a5fa; } .bench .bar1 { fill: #2dd4bf; } .bench .bar2 { fill: #fbbf24; } .bench .bar3 { fill: #a78bfa; }
}
";

const LEFT: f64 = 110.0;
const WIDTH: f64 = 620.0;
const BAR: f64 = 11.0;
const TOP: f64 = 64.0;

/// The lanes of a report relative to its base.
pub fn ratios(report: &Report, title: &str, lanes: &[&str], figure: Figure) -> String {
    let mut groups: Vec<(String, Vec<Option<f64>>)> = Vec::new();
    for program in &report.programs {
        let values = lanes.iter().map(|lane| program.ratio(lane, &report.base, figure)).collect();
        groups.push((program.name.clone(), values));
    }
    let means = lanes.iter().map(|lane| report.mean_ratio(lane, &report.base, figure)).collect();
    groups.push(("geometric mean".into(), means));
    draw(title, &format!("relative to {}, logarithmic", report.base), lanes, &groups)
}

fn draw(title: &str, axis: &str, lanes: &[&str], groups: &[(String, Vec<Option<f64>>)]) -> String {
    let values = || groups.iter().flat_map(|(_, v)| v.iter().flatten().copied()).filter(|v| *v > 0.0);
    let low = values().fold(0.5, f64::min).log2().floor();
    let high = values().fold(2.0, f64::max).log2().ceil();
    let x = |ratio: f64| LEFT + (ratio.max(low.exp2()).log2() - low) / (high - low) * WIDTH;
    let group = BAR * lanes.len() as f64 + 8.0;
    let height = TOP + group * groups.len() as f64 + 30.0;
    let width = LEFT + WIDTH + 60.0;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"bench\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n<style>\n{STYLE}</style>\n\
         <rect class=\"paper\" width=\"{width}\" height=\"{height}\"/>\n<text class=\"title\" x=\"12\" y=\"22\">{title}</text>\n<text x=\"12\" y=\"{}\">{axis}</text>\n",
        height - 8.0
    );
    for (n, lane) in lanes.iter().enumerate() {
        let at = 12.0 + 170.0 * n as f64;
        let _ = writeln!(
            out,
            "<rect class=\"bar{n}\" x=\"{at}\" y=\"34\" width=\"10\" height=\"10\"/><text x=\"{}\" y=\"43\">{lane}</text>",
            at + 15.0
        );
    }
    let bottom = TOP + group * groups.len() as f64;
    for step in low as i32..=high as i32 {
        let ratio = f64::from(step).exp2();
        let class = if step == 0 { "one" } else { "grid" };
        let _ = writeln!(
            out,
            "<line class=\"{class}\" x1=\"{0:.1}\" x2=\"{0:.1}\" y1=\"{TOP}\" y2=\"{bottom}\"/><text class=\"value\" text-anchor=\"middle\" x=\"{0:.1}\" y=\"{1}\">{ratio}</text>",
            x(ratio),
            bottom + 12.0
        );
    }
    for (row, (name, values)) in groups.iter().enumerate() {
        let top = TOP + group * row as f64 + 4.0;
        let middle = top + BAR * lanes.len() as f64 / 2.0 + 4.0;
        let _ = writeln!(out, "<text text-anchor=\"end\" x=\"{}\" y=\"{middle:.1}\">{name}</text>", LEFT - 8.0);
        for (n, value) in values.iter().enumerate() {
            let Some(value) = value else { continue };
            let (from, to) = (x(1.0).min(x(*value)), x(1.0).max(x(*value)));
            let y = top + BAR * n as f64;
            let _ = writeln!(
                out,
                "<rect class=\"bar{n}\" x=\"{from:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{}\"/><text class=\"value\" x=\"{:.1}\" y=\"{:.1}\">{value:.2}</text>",
                (to - from).max(1.0),
                BAR - 2.0,
                to + 3.0,
                y + BAR - 2.5
            );
        }
    }
    out + "</svg>\n"
}
