//! What the project promises about speed, each against what was measured.

use crate::lanes::{INTERP, INTERP_SPEED, JIT, JIT_UNCHECKED};
use crate::reference::{O2, O2_COPY, O2_NO_SLP, O3_NATIVE};
use plcc::bench::report::{Report, figure, two};
use std::fmt::Write;

/// Programs that must come close to C each.
const CLOSE: [&str; 8] = ["pid", "cascade", "timers", "drives", "logic", "states", "sfc", "il"];

/// A table of promises: what, how much, measured, kept.
pub fn table(report: &Report) -> String {
    let mut out =
        "\n## In short\n\nRatios of medians where nothing else is said; geometric means over all programs.\n\n\
                   | promise | limit | measured | kept |\n|---|---:|---:|---|\n"
            .to_string();
    let slowest_compile =
        report.programs.iter().map(plcc::bench::report::ProgramReport::total_compile_ms).reduce(f64::max);
    let interpreter_ns = |lane: &str| {
        let each = report.programs.iter().filter_map(|p| p.lane(lane).and_then(figure::ns_an_operation));
        plcc::bench::stats::geometric_mean(each)
    };
    let mut row = |what: &str, limit: f64, measured: Option<f64>, at_least: bool| {
        let Some(value) = measured else { return };
        let kept = if at_least { value >= limit } else { value <= limit };
        let _ = writeln!(out, "| {what} | {} | {} | {} |", two(limit), two(value), if kept { "yes" } else { "**no**" });
    };
    let ratio =
        |name: &str, base: &str| report.programs.iter().find(|p| p.name == name)?.ratio(JIT, base, figure::median);
    let greatest =
        |lane: &str, base: &str, f| report.programs.iter().filter_map(|p| p.ratio(lane, base, f)).reduce(f64::max);
    let base = O2.lane;
    row("native code against C -O2, mean", 1.0, report.mean_ratio(JIT, base, figure::median), false);
    row("native code against C -O2, worst program", 1.5, greatest(JIT, base, figure::median), false);
    for name in CLOSE {
        row(&format!("{name} against C -O2"), 1.15, ratio(name, base), false);
    }
    row("strings against C -O2", 1.5, ratio("strings", base), false);
    row("checks, mean", 1.05, report.mean_ratio(JIT, JIT_UNCHECKED, figure::median), false);
    row("checks, worst program", 1.15, greatest(JIT, JIT_UNCHECKED, figure::median), false);
    row("interpreter against native code, mean", 30.0, report.mean_ratio(INTERP, JIT, figure::median), true);
    row("the same on optimised MIR", 30.0, report.mean_ratio(INTERP_SPEED, JIT, figure::median), true);
    row("nanoseconds of the interpreter for an operation (or 30 above), mean", 15.0, interpreter_ns(INTERP), false);
    row("CPU milliseconds from source to running, slowest program", 20.0, slowest_compile, false);
    row(
        "most instructions of a cycle against C -O2, mean",
        1.0,
        report.mean_ratio(JIT, base, figure::greatest_instructions),
        false,
    );
    row(
        "longest undisturbed cycle against C -O2, mean",
        1.0,
        report.mean_ratio(JIT, base, figure::undisturbed_worst),
        false,
    );
    out.push_str("\nFor comparison:\n\n");
    let mut note = |what: &str, value: Option<f64>| {
        if let Some(value) = value {
            let _ = writeln!(out, "- {what}: {}", two(value));
        }
    };
    note("native code against C -O2 without SLP, mean", report.mean_ratio(JIT, O2_NO_SLP.lane, figure::median));
    note("native code against C -O3 -march=native, mean", report.mean_ratio(JIT, O3_NATIVE.lane, figure::median));
    note("noise: two copies of C -O2, mean of medians", report.mean_ratio(O2_COPY, base, figure::median));
    let apart = |f: fn(&_) -> Option<f64>| {
        let apart = |p: &plcc::bench::report::ProgramReport| p.ratio(O2_COPY, base, f).map(|r| r.max(1.0 / r));
        report.programs.iter().filter_map(apart).reduce(f64::max)
    };
    note("noise: two copies of C -O2, medians furthest apart", apart(figure::median));
    note("noise: two copies of C -O2, longest undisturbed cycles furthest apart", apart(figure::undisturbed_worst));
    note("noise: two copies of C -O2, longest cycles furthest apart", apart(figure::worst));
    out
}
