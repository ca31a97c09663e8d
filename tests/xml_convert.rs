//! `plcc convert --to st`: what it writes compiles, to the same code, and does the same under random stimulus.
//!
//! Over the XML cases of this repository, and over the corpora of `xml_corpora.rs` where `BEREMIZ`, `MATIEC` or `OSCAT_OPENPLC`
//! name them.

use plcc_hir::Profile;
use plcc_tests::{command, compile, difference, root};
use std::path::{Path, PathBuf};

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");
const CYCLES: usize = 40;

fn plcc(args: &[&str]) -> plcc_tests::Done {
    command(Path::new(PLCC), &root(), args)
}

/// All files with an extension below a folder.
fn files(folder: &Path, name: impl Fn(&Path) -> bool + Copy) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(files(&path, name));
        } else if name(&path) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The file as text, in a folder of its own; `None` if plcc does not accept it.
fn converted(path: &Path, profile: &str, others: &[&str]) -> Option<(tempfile::TempDir, String)> {
    let folder = tempfile::tempdir().expect("a folder");
    let text = folder.path().join("out.st").display().to_string();
    let source = path.display().to_string();
    let done = plcc(&[&["convert", &source], others, &["--to", "st", "-o", &text, "--profile", profile]].concat());
    assert!(done.code <= 1, "{source}: exit code {}\n{}", done.code, done.stderr);
    (done.code == 0).then_some((folder, text))
}

/// Runs both and compares what both have; says whether there was anything to run.
fn behave_alike(path: &Path, text: &str, profile: &str, others: &[&str], seed: u64) -> bool {
    let source = path.display().to_string();
    let folder = tempfile::tempdir().expect("a folder");
    let checked = plcc(&[&["check", text], others, &["--profile", profile, "--message-format", "short"]].concat());
    assert_eq!(checked.code, 0, "{source}: its text does not compile:\n{}", checked.stderr);
    let cycles = CYCLES.to_string();
    let run = |file: &str, more: &[&str]| {
        let base = ["--profile", profile, "--virtual-time", "--engine", "jit", "--cycles", &cycles, "--trace", "-"];
        plcc(&[&["run", file], others, &base, more].concat())
    };
    let first = run(&source, &[]);
    if first.code == 2 && first.stderr.contains("there is no PROGRAM") {
        return false;
    }
    let mut rows = first.stdout.lines();
    let header: Vec<String> = columns(rows.next().unwrap_or_default());
    let values: Vec<String> = columns(rows.next().unwrap_or_default());
    // What both have: names that only one needs begin with an underline in the text.
    let shared: Vec<&str> = header.iter().skip(1).map(String::as_str).filter(|n| !n.contains('[')).collect();
    if shared.is_empty() {
        return true;
    }
    let mut settable: Vec<(&str, bool)> = header
        .iter()
        .zip(&values)
        .skip(1)
        .filter(|(n, _)| n.matches('.').count() == 1 && !n.contains('['))
        .filter_map(|(n, v)| match v.as_str() {
            "TRUE" | "FALSE" => Some((n.as_str(), true)),
            v if v.parse::<i64>().is_ok() => Some((n.as_str(), false)),
            _ => None,
        })
        .collect();
    let mut random = fastrand::Rng::with_seed(seed);
    let watch = shared.join(",");
    let path = folder.path().join("in.csv").display().to_string();
    let more = ["--stimulus", &path, "--watch", &watch];
    let drawn = loop {
        let names: String = settable.iter().map(|(n, _)| format!(",{n}")).collect();
        let mut stimulus = format!("cycle{names}\n");
        for cycle in 1..=CYCLES {
            let cells = settable.iter().map(|(_, bool)| match (random.u8(0..3), bool) {
                (0, true) => format!(",{}", if random.bool() { "TRUE" } else { "FALSE" }),
                (0, false) => format!(",{}", random.u8(0..9)),
                _ => ",".into(),
            });
            stimulus.push_str(&format!("{cycle}{}\n", cells.collect::<String>()));
        }
        std::fs::write(&path, stimulus).expect("the stimulus");
        let drawn = run(&source, &more);
        // Constants cannot be set; the message names one.
        let constant = drawn.stderr.split_once("` is a CONSTANT").and_then(|(before, _)| before.rsplit('`').next());
        match constant {
            Some(name) if settable.iter().any(|(n, _)| *n == name) => settable.retain(|(n, _)| *n != name),
            _ => break drawn,
        }
    };
    let written = run(text, &more);
    // A random value may lie outside of a subrange: then both stop with the same fault.
    assert_eq!(drawn.code, written.code, "{source}:\n{}\n{}", drawn.stderr, written.stderr);
    if let Some(diff) = difference(&drawn.stdout, &written.stdout) {
        panic!("{source}, seed {seed}: the text behaves otherwise\n{diff}");
    }
    drawn.code <= 1
}

/// The fields of a row of a trace, quoted ones too.
fn columns(row: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    for c in row.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            c => fields.last_mut().expect("a field").push(c),
        }
    }
    fields
}

/// The lowering, without the names that only one of them has.
fn code(path: &Path, text: &str) -> Result<String, String> {
    let read = |path: &Path| std::fs::read_to_string(path).map_err(|e| e.to_string());
    let print = |text: &str| {
        let program = compile::compile(&read(Path::new(text))?, Profile::Strict)?;
        Ok::<String, String>(plcc_mir::print::program(&program, None))
    };
    let (drawn, written) = (print(&path.display().to_string())?, print(text)?);
    match difference(&drawn.replace('$', "_"), &written.replace('$', "_")) {
        None => Ok(drawn),
        Some(diff) => Err(diff),
    }
}

#[test]
fn cases_of_this_repository() {
    let mut number = 0;
    for path in files(&root().join("cases/xml"), |p| p.extension().is_some_and(|e| e == "xml")) {
        let Some((_folder, text)) = converted(&path, "strict", &[]) else { panic!("{} is refused", path.display()) };
        number += 1;
        let ran = (0..3).filter(|seed| behave_alike(&path, &text, "strict", &[], *seed)).count();
        assert!(ran > 0, "{}: nothing was compared", path.display());
        // A drawn condition with a block in it is an action in the text; the inputs of action controls are computed in the
        // order of their places, which drawings do not share with texts.
        let chart = path.file_stem().is_some_and(|n| n == "sequence" || n == "qualifiers");
        if !chart && let Err(diff) = code(&path, &text) {
            panic!("{}: the text gives other code\n{diff}", path.display());
        }
    }
    assert!(number >= 10, "{number} cases");
}

#[test]
fn corpora() {
    let plc = |p: &Path| p.file_name().is_some_and(|n| n == "plc.xml");
    let tests = |p: &Path| p.file_name().is_some_and(|n| n.to_string_lossy().ends_with("_TEST.xml"));
    let stubs = ["xml_corpora/beremiz.st"];
    let walk = |variable: &str, profile: &str, others: &[&str], at_least: usize| {
        let Some(folder) = std::env::var_os(variable) else { return println!("skipped: {variable} names no folder") };
        let folder = std::fs::canonicalize(&folder).unwrap_or_else(|e| panic!("{variable}: {e}"));
        let mut number = 0;
        for path in files(&folder, |p| plc(p) || tests(p)) {
            let Some((_folder, text)) = converted(&path, profile, others) else { continue };
            number += 1;
            behave_alike(&path, &text, profile, others, number as u64);
        }
        println!("{variable}: {number} projects as text");
        assert!(number >= at_least, "{variable}: {number}");
    };
    walk("BEREMIZ", "strict", &stubs, 15);
    walk("MATIEC", "strict", &[], 2);
    walk("OSCAT_OPENPLC", "codesys", &[], 21);
}
