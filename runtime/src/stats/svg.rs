//! Histograms as SVG: one row per task, one panel per measure, logarithmic time axis (eight bars a decade), logarithmic
//! counts, so that the rare late ones are seen.

use hdrhistogram::Histogram;
use std::fmt::Write;

const PANEL: (f64, f64) = (300.0, 120.0);
const MARGIN: (f64, f64) = (20.0, 46.0);
const BARS_PER_DECADE: f64 = 8.0;

/// The drawing.
pub fn drawing<'h, M>(tasks: impl Iterator<Item = (String, M)>) -> String
where
    M: Iterator<Item = (&'static str, &'h Histogram<u64>)>,
{
    let mut body = String::new();
    let mut rows = 0;
    for (name, measures) in tasks {
        for (column, (measure, histogram)) in measures.enumerate() {
            let at =
                (MARGIN.0 + column as f64 * (PANEL.0 + MARGIN.0), MARGIN.1 + rows as f64 * (PANEL.1 + MARGIN.1 + 16.0));
            panel(&mut body, at, &format!("{name}: {measure}"), histogram);
        }
        rows += 1;
    }
    let width = MARGIN.0 + 3.0 * (PANEL.0 + MARGIN.0);
    let height = MARGIN.1 + rows as f64 * (PANEL.1 + MARGIN.1 + 16.0);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\">\n\
         <style>text{{font:11px sans-serif;fill:#222}}.bar{{fill:#3b6ea5}}.axis{{stroke:#888}}\
         @media(prefers-color-scheme:dark){{text{{fill:#ddd}}.bar{{fill:#7fb0e0}}}}</style>\n{body}</svg>\n"
    )
}

fn panel(out: &mut String, (x, y): (f64, f64), title: &str, histogram: &Histogram<u64>) {
    let (width, height) = PANEL;
    // Writing to a String does not fail.
    let _ = writeln!(out, "<text x=\"{x}\" y=\"{}\">{}</text>", y - 22.0, escaped(title));
    let _ = writeln!(out, "<line class=\"axis\" x1=\"{x}\" y1=\"{0}\" x2=\"{1}\" y2=\"{0}\"/>", y + height, x + width);
    if histogram.is_empty() {
        let _ = writeln!(out, "<text x=\"{x}\" y=\"{}\">nothing measured</text>", y - 8.0);
        return;
    }
    let slot = |ns: u64| ((ns.max(1) as f64).log10() * BARS_PER_DECADE).floor() as i64;
    let mut bars = std::collections::BTreeMap::<i64, u64>::new();
    for value in histogram.iter_recorded() {
        *bars.entry(slot(value.value_iterated_to())).or_default() += value.count_at_value();
    }
    let first = bars.keys().next().copied().unwrap_or(0);
    let last = bars.keys().last().copied().unwrap_or(0);
    let most = bars.values().copied().max().unwrap_or(1);
    let step = width / (last - first + 1) as f64;
    let tall = |count: u64| height * ((count as f64).ln_1p() / (most as f64).ln_1p());
    for (slot, count) in &bars {
        let (left, high) = (x + (slot - first) as f64 * step, tall(*count));
        let _ = writeln!(
            out,
            "<rect class=\"bar\" x=\"{left:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{high:.1}\"><title>{} to {}: {count}</title></rect>",
            y + height - high,
            (step - 1.0).clamp(0.5, 24.0),
            time(edge(*slot)),
            time(edge(slot + 1)),
        );
    }
    let summary = format!(
        "{} times, p50 {}, p99 {}, max {}",
        histogram.len(),
        time(histogram.value_at_quantile(0.5) as f64),
        time(histogram.value_at_quantile(0.99) as f64),
        time(histogram.max() as f64)
    );
    let _ = writeln!(out, "<text x=\"{x}\" y=\"{}\">{summary}</text>", y - 8.0);
    let _ = writeln!(out, "<text x=\"{x}\" y=\"{}\">{}</text>", y + height + 14.0, time(edge(first)));
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>",
        x + width,
        y + height + 14.0,
        time(edge(last + 1))
    );
}

fn edge(slot: i64) -> f64 {
    10f64.powf(slot as f64 / BARS_PER_DECADE)
}

fn time(ns: f64) -> String {
    match ns {
        n if n < 1e3 => format!("{n:.0} ns"),
        n if n < 1e6 => format!("{:.1} us", n / 1e3),
        n if n < 1e9 => format!("{:.1} ms", n / 1e6),
        n => format!("{:.1} s", n / 1e9),
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
