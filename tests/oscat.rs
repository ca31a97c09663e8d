//! The functions and function blocks of the OSCAT Basic library against values that are known without it: mathematics, the calendar,
//! published check values, definitions, timing diagrams. `oscat/*.st` holds the checks, one PROGRAM a topic; nothing of the library
//! is in this repository. To run it, fetch the library's edition for open compilers and say where it lies:
//!
//! ```text
//! git clone --depth 1 https://github.com/PLC-lang/oscat ../oscat
//! OSCAT="$PWD/../oscat/oscat.st" cargo test -p plcc-tests --test oscat
//! ```
//! In `oscat/*.st` a BOOL named like a POU of the library is the verdict on it. What the checks leave out, because the library itself is
//! wrong there, stands in the notes at the end of `oscat/config.st`.

use plcc_tests::{Done, command, difference, root};
use std::collections::BTreeSet;
use std::path::Path;

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");

/// The slowest check looks at cycle 120.
const RUN: [&str; 5] = ["--virtual-time", "--cycles", "130", "--trace", "-"];

/// POUs with a verdict; fewer means that checks got lost.
const CHECKED_AT_LEAST: usize = 530;

#[test]
fn known_values() {
    let Some(library) = std::env::var_os("OSCAT") else {
        println!("skipped: OSCAT does not name the library's oscat.st");
        return;
    };
    let library = std::fs::canonicalize(&library).unwrap_or_else(|e| panic!("OSCAT = {}: {e}", library.display()));
    let sources = ["oscat", &library.display().to_string(), "--profile", "codesys", "--message-format", "short"]
        .map(str::to_string);
    let plcc = |first: &str, rest: &[&str]| {
        let args: Vec<&str> = [first].into_iter().chain(sources.iter().map(String::as_str)).collect();
        command(Path::new(PLCC), &root(), &[&args, rest].concat())
    };

    let reference = trace("interp", plcc("run", &[&["--engine", "interp"], &RUN[..]].concat()));
    judge(&reference, &library);

    same("jit", &reference, &trace("jit", plcc("run", &[&["--engine", "jit"], &RUN[..]].concat())));
    let folder = tempfile::tempdir().expect("a folder for the program");
    let app = folder.path().join("app");
    let built = plcc("build", &["-o", &app.display().to_string()]);
    assert!(app.exists(), "build failed:\n{}", errors(&built));
    same("linked", &reference, &trace("linked", command(&app, &root(), &RUN)));
}

/// The trace of a run that ended well.
fn trace(engine: &str, done: Done) -> String {
    assert_eq!(done.code, 0, "{engine}:\n{}", errors(&done));
    done.stdout
}

fn same(engine: &str, reference: &str, got: &str) {
    if let Some(diff) = difference(reference, got) {
        panic!("{engine} differs from the interpreter:\n{diff}");
    }
}

/// Every check has passed, every verdict is TRUE, and a verdict's POU is one of the library that the checks call.
fn judge(trace: &str, library: &Path) {
    let mut lines = trace.lines();
    let names = fields(lines.next().unwrap_or_default());
    let last = fields(lines.next_back().unwrap_or_default());
    let value = |name: &str| last[names.iter().position(|n| *n == name).unwrap_or_else(|| panic!("no column {name}"))];
    assert_eq!(value("Failed"), "0", "failed checks: {}", value("Log"));

    let pous = pous(&String::from_utf8_lossy(&std::fs::read(library).expect("the library")));
    let checks = checks();
    let mut verdicts = BTreeSet::new();
    for (name, value) in names.iter().zip(&last) {
        let Some((_, pou)) = name.split_once('.').filter(|(_, pou)| pous.contains(*pou)) else { continue };
        assert_eq!(*value, "TRUE", "{pou} does not give what it should");
        let called = checks.contains(&format!("{pou}(")) || checks.contains(&format!(": {pou};"));
        assert!(called, "{pou} has a verdict but is never called");
        verdicts.insert(pou);
    }
    println!("{} POUs, {} checks", verdicts.len(), value("Checks"));
    assert!(verdicts.len() >= CHECKED_AT_LEAST, "only {} POUs have a verdict", verdicts.len());
}

/// The fields of a line; commas between double quotes do not part them.
fn fields(line: &str) -> Vec<&str> {
    let mut quoted = false;
    line.split(|c| {
        quoted ^= c == '"';
        c == ',' && !quoted
    })
    .collect()
}

/// Names of the POUs that a source declares, as it writes them.
fn pous(source: &str) -> BTreeSet<String> {
    let mut words = source.split(|c: char| !c.is_alphanumeric() && c != '_');
    let mut out = BTreeSet::new();
    while let Some(word) = words.next() {
        if word == "FUNCTION" || word == "FUNCTION_BLOCK" {
            out.extend(words.find(|w| !w.is_empty()).map(str::to_string));
        }
    }
    out
}

/// The text of all checks.
fn checks() -> String {
    let files = std::fs::read_dir(root().join("oscat")).expect("the folder of the checks").flatten();
    files.map(|f| std::fs::read_to_string(f.path()).expect("a file of the checks")).collect()
}

/// What went wrong, without the warnings that the library gives by the hundred.
fn errors(done: &Done) -> String {
    done.stderr
        .lines()
        .filter(|l| !l.contains(": warning[") && !l.contains(": hint["))
        .fold(String::new(), |all, l| all + l + "\n")
}
