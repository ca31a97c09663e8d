//! Real time: the grid, overruns, statistics, deadlines, resources on threads.

use crate::{Plant, signal};
use std::time::Duration;

/// Busy for about `n` thousand passes.
const BUSY: &str = "PROGRAM Main\nVAR n : DINT := 1; i : DINT; x : LREAL; END_VAR\nFOR i := 1 TO n * 1000 DO\nx := SIN(x + 1.0);\nEND_FOR;\nEND_PROGRAM\n";

fn stats(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}: {text}"))
}

#[test]
fn executed_and_skipped_releases_are_all_releases() {
    let plant = Plant::new(&[("busy.st", BUSY)]);
    plant.build("busy.st", "busy");
    // An execution takes several intervals of 200 us, whatever the machine; both policies.
    for policy in ["asap", "skip"] {
        let args = ["--interval", "200us", "--cycles", "100", "--overrun", policy, "--stats", "json"];
        let done = plant.run("busy", &[&args[..], &["--force", "Main.n=200"]].concat());
        assert_eq!(done.code, 0, "{}", done.stderr);
        let task = &stats(&done.stdout)["tasks"][0];
        let number = |name: &str| task[name].as_u64().unwrap_or(0);
        assert_eq!(number("cycles"), 100);
        assert!(number("skipped") >= 100 && number("overruns") >= 90, "{policy}: {task}");
        // Executions and skipped releases make up the elapsed time, to the unit.
        let elapsed = stats(&done.stdout)["elapsed_ns"].as_u64().unwrap_or(0);
        assert_eq!(number("cycles") + number("skipped"), elapsed / 200_000 + 1, "{}", done.stdout);
    }
}

#[test]
fn a_missed_deadline_is_an_exit_code() {
    let plant = Plant::new(&[("busy.st", BUSY)]);
    plant.build("busy.st", "busy");
    let run = |deadline: &str| {
        plant.run("busy", &["--interval", "10ms", "--cycles", "5", "--virtual-time", "--deadline", deadline])
    };
    let kept = run("1h");
    assert_eq!((kept.code, kept.stderr.as_str()), (0, ""));
    // 10 ms from one release to the next are never below 5 ms.
    let missed = run("5ms");
    assert_eq!(missed.code, 1);
    assert!(
        missed.stderr.contains("reaction time of (every tick)") && missed.stderr.contains("deadline is 5000000 ns")
    );
    let project =
        "[project]\nname = \"busy\"\nsources = [\"busy.st\"]\n[tasks.T]\ninterval = \"10ms\"\nprograms = [\"Main\"]\n";
    let in_project = |more: &str| {
        plant.write("project.toml", &format!("{project}{more}"));
        plant.plcc(&["run", "project.toml", "--virtual-time", "--cycles", "3"])
    };
    assert_eq!(in_project("deadline = \"5ms\"\n").code, 1);
    assert_eq!(in_project("[runtime]\ndeadline = \"5ms\"\n").code, 1);
    assert_eq!(in_project("[runtime.tasks.T]\ndeadline = \"5ms\"\n").code, 1);
    assert_eq!(in_project("[runtime.tasks.T]\ndeadline = \"1h\"\n").code, 0);
    let wrong = in_project("[runtime.tasks.U]\ndeadline = \"1h\"\n");
    assert_eq!(wrong.code, 2);
    assert!(wrong.stderr.contains("there is no task `U`"), "{}", wrong.stderr);
}

#[test]
fn statistics_are_printed_while_the_program_runs_and_drawn_at_its_end() {
    let plant = Plant::new(&[("busy.st", BUSY)]);
    plant.build("busy.st", "busy");
    let child = plant.start("busy", &["--interval", "2ms", "--stats", "json", "--stats-svg", "s.svg"]);
    std::thread::sleep(Duration::from_millis(300));
    signal(&child, "-USR1");
    std::thread::sleep(Duration::from_millis(300));
    signal(&child, "-TERM");
    let done = child.wait_with_output().expect("it ends");
    let (stdout, stderr) = (String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr));
    assert_eq!(done.status.code(), Some(0), "{stderr}");
    assert!(stderr.starts_with("task [ns]") && stderr.contains("reaction time"), "{stderr}");
    let cycles = |text: &str| text.split_whitespace().nth(12).and_then(|w| w.parse::<u64>().ok());
    assert!(stats(&stdout)["tasks"][0]["cycles"].as_u64() > cycles(&stderr), "{stderr}");
    assert!(plant.read("s.svg").contains("wake-up"));
}

const STATIONS: &str = "
TYPE Pair : STRUCT a, b : LINT; END_STRUCT; END_TYPE
PROGRAM Writer
VAR_EXTERNAL pair : Pair; list : ARRAY [1..200] OF LINT; torn : DINT; END_VAR
VAR_INPUT step : LINT; END_VAR
VAR n : LINT; i : INT; END_VAR
n := n + step;
FOR i := 1 TO 200 DO
  IF list[i] <> list[1] THEN torn := torn + 1; END_IF;
END_FOR;
IF pair.a <> -pair.b THEN torn := torn + 1; END_IF;
FOR i := 1 TO 200 DO list[i] := n; END_FOR;
pair.a := n;
pair.b := -n;
END_PROGRAM
PROGRAM Count
VAR_EXTERNAL seen : LINT; pair : Pair; torn : DINT; END_VAR
VAR n : LINT; END_VAR
seen := pair.a;
END_PROGRAM
CONFIGURATION Conf
VAR_GLOBAL pair : Pair; list : ARRAY [1..200] OF LINT; torn : DINT; END_VAR
VAR_GLOBAL seen : LINT; END_VAR
RESOURCE A ON PLC TASK T(INTERVAL := T#1ms); PROGRAM P WITH T : Writer(step := 1); END_RESOURCE
RESOURCE B ON PLC TASK T(INTERVAL := T#1ms); PROGRAM P WITH T : Writer(step := 1000000); END_RESOURCE
RESOURCE C ON PLC TASK T(INTERVAL := T#2ms); PROGRAM P WITH T : Count; END_RESOURCE
END_CONFIGURATION
";

/// Two threads write all elements of an array and both halves of a structure; each sees only whole sets.
#[test]
fn resources_run_on_threads_and_never_see_half_of_a_set() {
    let plant = Plant::new(&[("stations.st", STATIONS)]);
    plant.build("stations.st", "stations");
    let done = plant.run("stations", &["--cycles", "400", "--stats", "json", "--retain", "r"]);
    assert_eq!(done.code, 0, "{}", done.stderr);
    let report = stats(&done.stdout);
    let tasks = report["tasks"].as_array().expect("tasks");
    let elapsed = report["elapsed_ns"].as_u64().unwrap_or(0);
    assert_eq!(tasks.len(), 3);
    assert_eq!(tasks[1]["task"], "B.T");
    // The time is that of the resource that ended last; it waits for its next release after 400 ticks of 1 ms.
    for (task, interval) in tasks.iter().zip([1_000_000, 1_000_000, 2_000_000]) {
        let total = task["cycles"].as_u64().unwrap_or(0) + task["skipped"].as_u64().unwrap_or(0);
        assert!(total >= 400_000_000 / interval && total <= elapsed / interval + 1, "{report}");
    }
}

/// The third resource faults in its 40th cycle, at another line if a set was torn before.
#[test]
fn a_fault_in_one_resource_stops_all_of_them() {
    let counting =
        "n := n + 1;\nIF torn > 0 THEN\nn := 1 / (torn - torn);\nEND_IF;\nIF n = 40 THEN\nn := 7 / (n - 40);\nEND_IF;";
    let text = STATIONS.replace("seen := pair.a;", counting);
    let line = 1 + text.lines().position(|l| l.contains("n - 40")).expect("the line");
    let plant = Plant::new(&[("stations.st", &text)]);
    plant.build("stations.st", "stations");
    let done = plant.run("stations", &["--cycles", "100000"]);
    assert_eq!(done.code, 1, "{}", done.stderr);
    let expected = format!(
        "error[E0601]: division by zero\n  --> stations.st:{line}:6\n  in Count (instance C.P)\n  7 was divided by 0\n  task T, cycle 40\n"
    );
    assert_eq!(done.stderr, expected);
}
