//! The pictures of the lecture in Function Block Diagram and Ladder Diagram (`examples/lecture`): they compile without a mistake, do
//! what they show, and are drawn as the SVG beside them. `UPDATE=1` draws them again.

use plcc_tests::{command, difference, project_root};
use std::path::{Path, PathBuf};

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");

fn folder() -> PathBuf {
    project_root().join("examples/lecture")
}

fn plcc(args: &[&str]) -> plcc_tests::Done {
    command(Path::new(PLCC), &folder(), args)
}

/// The rows of a run: values of `watch` after each cycle that the rows of `stimulus` describe, one cycle a row.
fn run(file: &str, interval: &str, inputs: &str, rows: &[&[bool]], watch: &str) -> Vec<Vec<String>> {
    let place = tempfile::tempdir().expect("a folder");
    let mut stimulus = format!("cycle,{inputs}\n");
    for (n, row) in rows.iter().enumerate() {
        let values: Vec<&str> = row.iter().map(|v| if *v { "TRUE" } else { "FALSE" }).collect();
        stimulus.push_str(&format!("{},{}\n", n + 1, values.join(",")));
    }
    let path = place.path().join("in.csv").display().to_string();
    std::fs::write(&path, stimulus).expect("the stimulus");
    let cycles = rows.len().to_string();
    let mut traces = Vec::new();
    for engine in ["interp", "jit"] {
        let how = ["run", file, "--engine", engine, "--virtual-time", "--interval", interval, "--cycles", &cycles];
        let done = plcc(&[&how[..], &["--stimulus", &path, "--watch", watch, "--trace", "-"]].concat());
        assert_eq!(done.code, 0, "{file}: {}", done.stderr);
        traces.push(done.stdout);
    }
    assert_eq!(traces[0], traces[1], "{file}");
    let values = |line: &str| line.split(',').skip(1).map(str::to_string).collect();
    traces[0].lines().skip(1).map(values).collect()
}

fn text(values: &[bool]) -> Vec<String> {
    values.iter().map(|v| if *v { "TRUE" } else { "FALSE" }.to_string()).collect()
}

#[test]
fn each_picture_compiles_and_is_drawn() {
    let mut number = 0;
    for entry in std::fs::read_dir(folder()).expect("examples/lecture").flatten() {
        let path = entry.path();
        if path.extension().is_none_or(|e| e != "xml") {
            continue;
        }
        number += 1;
        let name = path.file_name().unwrap_or_default().display().to_string();
        let checked = plcc(&["check", &name, "--message-format", "short"]);
        assert_eq!(checked.code, 0, "{}", checked.stderr);
        assert!(!checked.stderr.contains("warning"), "{}", checked.stderr);
        let drawn = plcc(&["graph", &name]);
        assert_eq!(drawn.code, 0, "{}", drawn.stderr);
        let svg = path.with_extension("svg");
        let expected = std::fs::read_to_string(&svg).unwrap_or_default();
        if std::env::var_os("UPDATE").is_some_and(|v| v == "1") {
            std::fs::write(&svg, &drawn.stdout).expect("the drawing");
        } else if let Some(diff) = difference(&expected, &drawn.stdout) {
            panic!("{} differs:\n{diff}", svg.display());
        }
    }
    assert_eq!(number, 6);
}

#[test]
fn gates() {
    let rows: Vec<[bool; 3]> = (0..8).map(|n| [n & 4 != 0, n & 2 != 0, n & 1 != 0]).collect();
    let inputs: Vec<&[bool]> = rows.iter().map(|r| r.as_slice()).collect();
    for file in ["gates_fbd.xml", "gates_ld.xml"] {
        let got = run(file, "10ms", "Gates.a,Gates.b,Gates.c", &inputs, "Gates.both,Gates.either,Gates.f");
        for ([a, b, c], values) in rows.iter().zip(got) {
            assert_eq!(values, text(&[*a && *b, *a || *b, *a && (*b || !*c)]), "{file}: {a} {b} {c}");
        }
    }
}

/// Set, hold, reset, hold, both at once, hold.
const SET_RESET: [&[bool]; 6] =
    [&[true, false], &[false, false], &[false, true], &[false, false], &[true, true], &[false, false]];

#[test]
fn latches() {
    let watch = "Latches.by_loop,Latches.by_block,Latches.reset_wins,Latches.set_wins";
    let got = run("latches.xml", "10ms", "Latches.set,Latches.reset", &SET_RESET, watch);
    let reset_wins = [true, true, false, false, false, false];
    let set_wins = [true, true, false, false, true, true];
    for (n, values) in got.iter().enumerate() {
        assert_eq!(*values, text(&[reset_wins[n], reset_wins[n], reset_wins[n], set_wins[n]]), "cycle {}", n + 1);
    }
    let watch = "Latches.held,Latches.coil_latch";
    let got = run("latches_ld.xml", "10ms", "Latches.set,Latches.reset", &SET_RESET, watch);
    for (n, values) in got.iter().enumerate() {
        assert_eq!(*values, text(&[reset_wins[n], reset_wins[n]]), "cycle {}", n + 1);
    }
}

#[test]
fn edges() {
    let button: [&[bool]; 7] = [&[false], &[true], &[true], &[false], &[true], &[false], &[false]];
    let got = run("edge.xml", "10ms", "Edges.button", &button, "Edges.pulse,Edges.light");
    let pulse = [false, true, false, false, true, false, false];
    let light = [false, true, true, true, false, false, false];
    for (n, values) in got.iter().enumerate() {
        assert_eq!(*values, text(&[pulse[n], light[n]]), "cycle {}", n + 1);
    }
}

#[test]
fn delay() {
    let rows: [&[bool]; 7] = [
        &[false, false],
        &[true, false],
        &[false, false],
        &[false, false],
        &[false, false],
        &[false, true],
        &[false, false],
    ];
    let got = run("delay.xml", "1s", "Conveyor.start,Conveyor.stop", &rows, "Conveyor.lubricated,Conveyor.motor");
    let pump = [false, true, true, true, true, false, false];
    // Two seconds after the second cycle.
    let motor = [false, false, false, true, true, false, false];
    for (n, values) in got.iter().enumerate() {
        assert_eq!(*values, text(&[pump[n], motor[n]]), "cycle {}", n + 1);
    }
}
