//! Projects as editors save them, in PLCopen TC6 XML. Nothing of them is in this repository; fetch them and say where they lie:
//!
//! ```text
//! git clone --depth 1 https://github.com/beremiz/beremiz ../beremiz
//! git clone --depth 1 https://github.com/beremiz/matiec ../matiec
//! git clone --depth 1 https://github.com/wonka929/OSCAT_OpenPLC ../OSCAT_OpenPLC
//! BEREMIZ=../beremiz MATIEC=../matiec OSCAT_OPENPLC=../OSCAT_OpenPLC cargo test -p plcc-tests --test xml_corpora
//! ```
//! `xml_corpora/beremiz.st` declares what Beremiz itself adds (written in C or Python there), so that projects which use it can be
//! checked for everything else, and run.

use plcc_tests::{Done, command, root};
use std::path::{Path, PathBuf};

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");

/// The folder that a variable names; `None` if the test is to be skipped.
fn corpus(variable: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os(variable) else {
        println!("skipped: {variable} names no folder");
        return None;
    };
    Some(std::fs::canonicalize(&folder).unwrap_or_else(|e| panic!("{variable} = {}: {e}", folder.display())))
}

/// All `plc.xml` below a folder.
fn projects(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                open.push(path);
            } else if path.file_name().is_some_and(|n| n == "plc.xml") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn plcc(args: &[&str]) -> Done {
    command(Path::new(PLCC), &root(), args)
}

/// The errors of a check, `E0203: there is no type ...`.
fn errors(files: &[&str], profile: &str) -> Vec<String> {
    let args = [&["check"], files, &["--profile", profile, "--message-format", "short"]].concat();
    let done = plcc(&args);
    assert!(done.code <= 1, "{files:?}: exit code {}\n{}", done.code, done.stderr);
    let errors = done.stderr.lines().filter_map(|l| l.split_once(": error[").map(|(_, e)| e.replacen(']', "", 1)));
    let errors: Vec<String> = errors.collect();
    assert_eq!(errors.is_empty(), done.code == 0, "{}", done.stderr);
    errors
}

const STUBS: &str = "xml_corpora/beremiz.st";

#[test]
fn beremiz() {
    let Some(folder) = corpus("BEREMIZ") else { return };
    let projects = projects(&folder);
    assert!(projects.len() >= 35, "{} projects", projects.len());
    let (mut alone, mut with_stubs) = (Vec::new(), Vec::new());
    for project in &projects {
        let path = project.display().to_string();
        let name = project.parent().and_then(Path::file_name).unwrap_or_default().display().to_string();
        if errors(&[&path], "strict").is_empty() {
            alone.push(name.clone());
        }
        let left = errors(&[&path, STUBS], "strict");
        // Globals that C or Python files give, and addresses of their I/O drivers; the unquoted text of a Python type.
        let foreign = |e: &String| {
            e.starts_with("E0208") || e.starts_with("E0213") || (e.starts_with("E0201") && e.contains("`blup`"))
        };
        let other: Vec<&String> = left.iter().filter(|e| !foreign(e)).collect();
        assert!(other.is_empty(), "{path}: {other:?}");
        if left.is_empty() {
            with_stubs.push(name);
        }
    }
    println!("{} of {} compile alone: {alone:?}", alone.len(), projects.len());
    println!("{} with the declarations of Beremiz: {with_stubs:?}", with_stubs.len());
    for needed in ["first_steps", "genericmake", "svghmi_json_table"] {
        assert!(alone.iter().any(|n| n == needed), "{needed} does not compile");
    }
    assert!(with_stubs.len() >= 15, "{with_stubs:?}");
}

/// `first_steps`: one counter in all five notations, which count alike.
#[test]
fn first_steps_counts_alike() {
    let Some(folder) = corpus("BEREMIZ") else { return };
    let project = folder.join("exemples/first_steps/plc.xml").display().to_string();
    let stimulus = tempfile::NamedTempFile::new().expect("a file");
    std::fs::write(stimulus.path(), "cycle,plc_task_instance.Reset\n5,TRUE\n8,FALSE\n").expect("the stimulus");
    let stimulus = stimulus.path().display().to_string();
    let watch = "plc_task_instance.Cnt1,plc_task_instance.Cnt2,plc_task_instance.Cnt4,plc_task_instance.Cnt5,plc_task_instance.Cnt3";
    let mut traces = Vec::new();
    for engine in ["interp", "jit"] {
        let run = ["run", &project, "--engine", engine, "--virtual-time", "--cycles", "20", "--trace", "-"];
        let done = plcc(&[&run[..], &["--stimulus", &stimulus, "--watch", watch]].concat());
        assert_eq!(done.code, 0, "{}", done.stderr);
        traces.push(done.stdout);
    }
    assert_eq!(traces[0], traces[1]);
    for (number, row) in traces[0].lines().skip(1).enumerate() {
        let values: Vec<&str> = row.split(',').skip(1).collect();
        let expected = match number + 1 {
            n @ 1..=4 => n,
            5..=7 => 17,
            n => 17 + n - 7,
        };
        assert_eq!(values[..4], vec![expected.to_string().as_str(); 4], "{row}");
    }
}

/// `iec61131_lang_test`: 240 conversions and the timers. Where the standard leaves the result to the implementer, the expectation is
/// what semantics.md [T6] says instead of what Beremiz chose.
#[test]
fn language_test_passes() {
    let Some(folder) = corpus("BEREMIZ") else { return };
    let project = folder.join("tests/projects/iec61131_lang_test/plc.xml");
    let mut text = std::fs::read_to_string(&project).expect("the project");
    let choices = [
        ("<> '16#2a'", "<> '42'"),
        ("REAL_TO_STRING(REAL#42.0) <> '42'", "REAL_TO_STRING(REAL#42.0) <> '42.0'"),
        ("LREAL_TO_STRING(LREAL#42.0) <> '42'", "LREAL_TO_STRING(LREAL#42.0) <> '42.0'"),
    ];
    for (theirs, ours) in choices {
        assert!(text.contains(theirs), "{theirs}");
        text = text.replace(theirs, ours);
    }
    let boolean = "STRING_TO_BOOL('42') <> BOOL#FALSE";
    text = text.replace(boolean, "STRING_TO_BOOL('42') <> BOOL#TRUE");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("plc.xml");
    std::fs::write(&path, text).expect("the project");
    let path = path.display().to_string();
    let run = ["run", &path, STUBS, "--virtual-time", "--cycles", "1500", "--trace", "-"];
    let watch = ["--watch", "instance0.CONVERSION_TEST0.RESULT,instance0.TEMPO_TEST0.RESULT,instance0.LOGGER2.TRIG"];
    let done = plcc(&[&run[..], &watch[..]].concat());
    assert_eq!(done.code, 0, "{}", done.stderr);
    let last = done.stdout.lines().last().unwrap_or_default();
    assert!(last.contains("'OK','OK'"), "{last}");
    assert!(done.stdout.lines().any(|l| l.ends_with(",TRUE")), "no `ALL TESTS OK`");
}

#[test]
fn matiec() {
    let Some(folder) = corpus("MATIEC") else { return };
    for (name, mistakes) in [("LD_TEST", 0), ("SFC_TEST", 0), ("STD_TEST", 1)] {
        let path = folder.join(format!("tests/{name}.xml")).display().to_string();
        let found = errors(&[&path], "strict");
        assert_eq!(found.len(), mistakes, "{path}: {found:?}");
        // The BOOL of an EQ goes into an INT MUX.
        assert!(found.iter().all(|e| e.starts_with("E0310")), "{found:?}");
    }
}

/// OSCAT as OpenPLC Editor saves it. Three of its projects have mistakes that no profile accepts.
#[test]
fn oscat_openplc() {
    let Some(folder) = corpus("OSCAT_OPENPLC") else { return };
    let projects = projects(&folder);
    assert_eq!(projects.len(), 24);
    let known = [
        // BYTE_TO_STRING(IN, '%02X'), a printf of the vendor.
        ("-13 String Functions", "E0325"),
        // MEMSET, a C function.
        ("-25 Buffer Management", "E0322"),
        // A VAR_IN_OUT that is assigned from outside instead of connected.
        ("-6 Arrays", "E032"),
    ];
    for project in projects {
        let path = project.display().to_string();
        let found = errors(&[&path], "codesys");
        let code = known.iter().find(|(name, _)| path.contains(name)).map(|(_, code)| *code);
        match code {
            None => assert!(found.is_empty(), "{path}: {found:?}"),
            Some(code) => assert!(found.iter().all(|e| e.starts_with(code)), "{path}: {found:?}"),
        }
    }
}
