//! What compiling takes: the least of some runs, stage by stage.

use plcc::bench::app::{Front, timed};
use plcc::bench::report::ProgramReport;
use plcc::cli::OptArg;
use plcc_hir::Profile;

/// CPU milliseconds of each stage.
pub type Stages = Vec<(&'static str, f64)>;

/// From sources to running in the JIT, with `--opt speed` and every check; the run with the least sum.
pub fn to_jit(sources: &[(&str, &str)], runs: usize) -> Result<Stages, String> {
    let mut best: Option<Stages> = None;
    for _ in 0..runs.max(1) {
        let front = Front::new(sources, Profile::Strict)?;
        let back = front.compile("all", OptArg::Speed)?;
        let stages = stages(&front, back.cpu_ms, back.jit().1);
        let sum = |stages: &Stages| stages.iter().map(|(_, ms)| ms).sum::<f64>();
        if best.as_ref().is_none_or(|b| sum(&stages) < sum(b)) {
            best = Some(stages);
        }
    }
    Ok(best.unwrap_or_default())
}

fn stages(front: &Front, lower_ms: f64, code_ms: f64) -> Stages {
    let [parse, check] = front.cpu_ms;
    vec![("parse", parse), ("check", check), ("lower, optimise", lower_ms), ("machine code", code_ms)]
}

/// The library that the environment variable OSCAT names (`oscat.st`), every POU of it to an object file; `None` without it.
pub fn oscat() -> Result<Option<ProgramReport>, String> {
    let Some(path) = std::env::var_os("OSCAT") else { return Ok(None) };
    let bytes = std::fs::read(&path).map_err(|e| format!("OSCAT = {}: {e}", path.display()))?;
    let text: String = match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(e) => e.into_bytes().into_iter().map(char::from).collect(),
    };
    let main = "PROGRAM Main\nVAR x : BOOL; END_VAR\nx := NOT x;\nEND_PROGRAM\n";
    let front = Front::new(&[("oscat.st", &text), ("main.st", main)], Profile::Codesys)?;
    let back = front.compile_library()?;
    let (object, code_ms) = timed(|| back.object());
    let code = plcc::bench::app::code_bytes(&object).unwrap_or(0);
    Ok(Some(ProgramReport {
        name: "OSCAT Basic".into(),
        what: format!("every POU, {code} bytes of machine code"),
        lines: text.lines().count(),
        compile_ms: stages(&front, back.cpu_ms, code_ms),
        ..ProgramReport::default()
    }))
}
