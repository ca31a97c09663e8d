//! The README tells the truth: its commands run, its outputs are what the commands print.

use plcc_tests::{command, difference, project_root};
use std::path::Path;

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");

fn readme() -> String {
    std::fs::read_to_string(project_root().join("README.md")).expect("the README")
}

/// The fenced block behind a comment.
fn block_behind(text: &str, comment: &str) -> String {
    let start = text.find(comment).unwrap_or_else(|| panic!("the README has no {comment}"));
    let rest = &text[start..];
    let open = rest.find("```").expect("a fenced block");
    let body = rest[open..].split_once('\n').expect("a line behind the fence").1;
    body[..body.find("```").expect("a closing fence")].to_string()
}

fn update() -> bool {
    std::env::var_os("UPDATE").is_some_and(|v| v == "1")
}

/// Compares a block with what it should be; `UPDATE=1` writes it.
fn judge(comment: &str, got: &str) {
    let text = readme();
    let expected = block_behind(&text, comment);
    if expected == got {
        return;
    }
    if update() {
        let start = text.find(comment).expect("the comment");
        let open = start + text[start..].find("```").expect("a fence");
        let body = open + text[open..].find('\n').expect("a line end") + 1;
        let new = format!("{}{got}{}", &text[..body], &text[body + expected.len()..]);
        std::fs::write(project_root().join("README.md"), new).expect("the README is written");
        return;
    }
    panic!("{comment}:\n{}", difference(&expected, got).unwrap_or_default());
}

#[test]
fn the_tank_runs_as_the_readme_says() {
    let text = readme();
    let line = block_behind(&text, "<!-- run command -->");
    let (cargo, plcc) = line.trim().split_once(" -- ").expect("cargo run ... -- plcc's arguments");
    assert_eq!(cargo, "cargo run --release --locked --package plcc");
    let folder = tempfile::tempdir().expect("a folder");
    std::os::unix::fs::symlink(project_root().join("examples"), folder.path().join("examples")).expect("a link");
    let args: Vec<&str> = plcc.split_whitespace().collect();
    let done = command(Path::new(PLCC), folder.path(), &args);
    assert_eq!(done.code, 0, "{}", done.stderr);
    let trace = std::fs::read_to_string(folder.path().join("tank.csv")).expect("the trace");
    let lines: Vec<&str> = trace.lines().collect();
    assert_eq!(lines.len(), 2001);
    judge(
        "<!-- output: sed -n '1p;1001p;2001p' tank.csv -->",
        &format!("{}\n{}\n{}\n", lines[0], lines[1000], lines[2000]),
    );
    // The interpreter and the linked program give the same bytes.
    let interp = [&args[..], &["--engine", "interp"]].concat();
    let interp: Vec<&str> = interp.iter().map(|a| if *a == "tank.csv" { "interp.csv" } else { a }).collect();
    assert_eq!(command(Path::new(PLCC), folder.path(), &interp).code, 0);
    assert_eq!(std::fs::read_to_string(folder.path().join("interp.csv")).expect("its trace"), trace);
    assert_eq!(command(Path::new(PLCC), folder.path(), &["build", "examples/tank/project.toml"]).code, 0);
    let flags: Vec<&str> = args[2..].iter().map(|a| if *a == "tank.csv" { "linked.csv" } else { a }).collect();
    assert_eq!(command(&folder.path().join("tank"), folder.path(), &flags).code, 0);
    assert_eq!(std::fs::read_to_string(folder.path().join("linked.csv")).expect("its trace"), trace);
}

#[test]
fn the_mistake_is_told_as_the_readme_says() {
    let done = command(Path::new(PLCC), &project_root(), &["check", "tests/cases/diag/readme.st"]);
    judge("<!-- output: plcc check tests/cases/diag/readme.st -->", &done.stderr);
}

#[test]
fn the_commands_of_use_it_run() {
    let text = readme();
    let block = block_behind(&text, "## Use it");
    let folder = tempfile::tempdir().expect("a folder");
    let plcc = folder.path().join("plcc");
    std::os::unix::fs::symlink(PLCC, &plcc).expect("a link");
    let path = format!("{}:{}", folder.path().display(), std::env::var("PATH").unwrap_or_default());
    let script = format!("set -eu\n{block}");
    let done = std::process::Command::new("sh")
        .args(["-c", &script])
        .current_dir(folder.path())
        .env("PATH", path)
        .output()
        .expect("a shell");
    assert!(
        done.status.success(),
        "{}\n{}",
        String::from_utf8_lossy(&done.stdout),
        String::from_utf8_lossy(&done.stderr)
    );
}

#[test]
fn the_chart_is_drawn() {
    let line = block_behind(&readme(), "<!-- graph command -->");
    let folder = tempfile::tempdir().expect("a folder");
    let target = folder.path().join("chart.svg").to_string_lossy().into_owned();
    let args: Vec<&str> =
        line.split_whitespace().skip(1).map(|a| if a == "chart.svg" { target.as_str() } else { a }).collect();
    assert_eq!(command(Path::new(PLCC), &project_root(), &args).code, 0);
    let svg = std::fs::read_to_string(&target).expect("the drawing");
    assert!(svg.starts_with("<svg") && svg.contains("Heat"), "{}", &svg[..svg.len().min(300)]);
}

#[test]
fn the_test_command_is_what_ci_runs() {
    let text = readme();
    assert_eq!(block_behind(&text, "<!-- test command -->"), "cargo test --workspace --locked\n");
    let ci = std::fs::read_to_string(project_root().join(".ci/run")).expect(".ci/run");
    assert!(ci.contains("<!-- test command -->"), "{ci}");
}

/// The golden traces of the examples, in all engines. The alarm is written in several languages: one stimulus, one trace.
#[test]
fn examples_give_their_traces() {
    let alarm = "Main.danger,Main.receipt,Main.reset,Main.red,Main.yellow";
    for (name, project, cycles, watch) in [
        (
            "tank",
            ".",
            "700",
            "Main.control.step,Main.control.V1,Main.control.V2,Main.control.V3,Main.control.V4,Main.plant.level2",
        ),
        ("trip", ".", "240", "Main.boiler.pressure,Main.tripped,Main.burner,Main.first"),
        ("interlock", ".", "200", "Main.drive.left,Main.drive.right,Main.k1.closed,Main.k2.closed,Main.danger"),
        ("control_loop", ".", "900", "Main.seconds,Main.setpoint,Main.temperature,Main.power,Main.load"),
        ("plant_states", ".", "60", "Main.room.temp,Main.unit.state,Main.switch,Main.alarm"),
        (
            "dosing",
            ".",
            "240",
            "Main.control.V1,Main.control.V2,Main.control.V3,Main.control.V4,Main.control.batches,Main.plant.temperature,\
             Main.control2.V1,Main.control2.V2,Main.control2.V3,Main.control2.V4,Main.control2.batches,\
             Main.plant2.temperature",
        ),
        (
            "heat_drain",
            ".",
            "430",
            "Main.heater,Main.drain,Main.agitator,Main.announce,Main.rounds,Main.Off.X,Main.Heating.T,Main.Draining.T",
        ),
        (
            "mixer",
            ".",
            "420",
            "Main.mixer.coarse,Main.mixer.fine,Main.mixer.agitator,Main.mixer.outlet,Main.mixer.water,Main.mixer.batches,\
             Main.vessel.weight,Main.vessel.content",
        ),
        (
            "safe_tank",
            ".",
            "320",
            "Main.control.fill,Main.control.steam,Main.control.cooling,Main.control.drain,Main.control.shutOff,\
             Main.control.horn,Main.control.lamp,Main.fill.open,Main.steam.open,Main.control.Automatic.X,\
             Main.control.Protect.X,Main.control.sequence.Heating.X,Main.tank.level,Main.tank.temperature",
        ),
        ("path", ".", "6", "Main.level,Main.passes,Main.strongest"),
        ("alarm", "il", "30", alarm),
        ("alarm", "st", "30", alarm),
        ("alarm", "sfc", "30", alarm),
    ] {
        let example = project_root().join("examples").join(name);
        let folder = tempfile::tempdir().expect("a folder");
        let mut flags = vec!["--virtual-time", "--cycles", cycles, "--watch", watch, "--trace", "-"];
        let stimulus = example.join("stimulus.csv").display().to_string();
        if Path::new(&stimulus).exists() {
            flags.extend(["--stimulus", &stimulus]);
        }
        let project = example.join(project).join("project.toml").display().to_string();
        let run = |engine| {
            command(Path::new(PLCC), folder.path(), &[&["run", &project, "--engine", engine], &flags[..]].concat())
        };
        let built = command(Path::new(PLCC), folder.path(), &["build", &project, "-o", "app"]);
        assert_eq!(built.code, 0, "{name}: {}", built.stderr);
        assert!(built.stderr.is_empty(), "{name}: {}", built.stderr);
        let golden = example.join("trace.csv");
        for done in [run("interp"), run("jit"), command(&folder.path().join("app"), folder.path(), &flags)] {
            assert_eq!(done.code, 0, "{name}: {}", done.stderr);
            let expected = std::fs::read_to_string(&golden).unwrap_or_default();
            if update() && expected.is_empty() {
                std::fs::write(&golden, &done.stdout).expect("the trace is written");
                continue;
            }
            if let Some(diff) = difference(&expected, &done.stdout) {
                panic!("{name}: {diff}");
            }
        }
    }
}
