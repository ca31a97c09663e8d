//! Retained values: cold and warm starts, kill -9, `plcc retain`.

use crate::Plant;
use std::time::Duration;

/// Two values that belong together, spread over 4,000 elements, and what is not kept.
const SETS: &str = "
TYPE Mode : (Idle, Filling, Heating); END_TYPE
FUNCTION_BLOCK Meter
VAR n : LINT; END_VAR
VAR NON_RETAIN volatile : LINT; END_VAR
VAR RETAIN own : LINT; END_VAR
n := n + 1;
volatile := volatile + 1;
own := own + 1;
END_FUNCTION_BLOCK
PROGRAM Main
VAR RETAIN n : LINT; list : ARRAY [1..4000] OF LINT; meter : Meter; mode : Mode; name : STRING[8] := 'start'; END_VAR
VAR free : LINT; other : Meter; i : INT; bad : BOOL; END_VAR
FOR i := 2 TO 4000 DO
  IF list[i] <> list[1] THEN bad := TRUE; END_IF;
END_FOR;
IF list[1] <> n THEN bad := TRUE; END_IF;
IF bad THEN free := 1 / (free - free); END_IF;
n := n + 1;
FOR i := 1 TO 4000 DO list[i] := n; END_FOR;
meter();
other();
mode := Mode#Heating;
name := 'run';
free := free + 1;
END_PROGRAM
";

#[test]
fn a_warm_start_goes_on_a_cold_one_begins_again() {
    let plant = Plant::new(&[("m.st", SETS)]);
    plant.build("m.st", "m");
    let watch = "Main.n,Main.free,Main.meter.n,Main.meter.volatile,Main.meter.own,Main.other.n,Main.other.own,Main.mode,Main.name";
    let run = |more: &[&str]| {
        let args = ["--virtual-time", "--cycles", "3", "--retain", "r", "--watch", watch];
        let done = plant.run("m", &[&args[..], more].concat());
        assert_eq!(done.code, 0, "{}", done.stderr);
        done.stdout.lines().last().unwrap_or_default().to_string()
    };
    assert_eq!(run(&[]), "3,3,3,3,3,3,3,3,Heating,'run'");
    // NON_RETAIN inside a RETAIN instance begins again, RETAIN inside another goes on.
    assert_eq!(run(&[]), "3,6,3,6,3,6,3,6,Heating,'run'");
    assert_eq!(run(&["--cold"]), "3,3,3,3,3,3,3,3,Heating,'run'");
    assert_eq!(run(&[]), "3,6,3,6,3,6,3,6,Heating,'run'");
}

/// A stored action in the middle of its time, and one that no step holds any more; `%` is where a step and an action come in
/// front of them.
const CHART: &str = "
FUNCTION_BLOCK Seq
VAR_OUTPUT pump, motor, siren : BOOL; END_VAR
INITIAL_STEP Start: END_STEP
TRANSITION FROM Start TO Fill := TRUE; END_TRANSITION
%
STEP Fill: motor(S); END_STEP
TRANSITION FROM Fill TO Hold := TRUE; END_TRANSITION
STEP Hold: pump(D, T#70ms); END_STEP
TRANSITION FROM Hold TO Start := FALSE; END_TRANSITION
END_FUNCTION_BLOCK
PROGRAM Main
VAR RETAIN s : Seq; END_VAR
s();
END_PROGRAM
";

#[test]
fn a_chart_that_was_edited_goes_on() {
    let more = "STEP Alarm: siren(SD, T#0ms); END_STEP TRANSITION FROM Alarm TO Start := TRUE; END_TRANSITION
        TRANSITION FROM Start TO Alarm := FALSE; END_TRANSITION";
    let plant = Plant::new(&[("old.st", &CHART.replace('%', "")), ("new.st", &CHART.replace('%', more))]);
    let watch = "Main.s.Hold.X,Main.s.Fill.X,Main.s.motor,Main.s.pump,Main.s.siren";
    let run = |file: &str, cycles: &str| {
        let args = ["run", file, "--virtual-time", "--cycles", cycles, "--retain", "r", "--watch", watch];
        let done = plant.plcc(&args);
        assert_eq!(done.code, 0, "{}", done.stderr);
        done.stdout.lines().skip(1).map(|l| l.split_once(',').map_or("", |l| l.1).to_string()).collect::<Vec<_>>()
    };
    // Fill acts in the second call, Hold from the third on: the pump's delay is not over in the fifth.
    assert_eq!(run("old.st", "5").last().map(String::as_str), Some("TRUE,FALSE,TRUE,FALSE,FALSE"));
    // The motor stays stored from the first call on; the delay began at 20 ms, and virtual time begins again at 0.
    let rows = run("new.st", "10");
    assert_eq!(rows[0], "TRUE,FALSE,TRUE,FALSE,FALSE");
    assert_eq!(rows[8], "TRUE,FALSE,TRUE,FALSE,FALSE");
    assert_eq!(rows[9], "TRUE,FALSE,TRUE,TRUE,FALSE");
}

#[test]
fn retained_values_are_shown_and_compared() {
    let plant = Plant::new(&[("m.st", SETS)]);
    let run =
        |file: &str, cycles: &str| plant.plcc(&["run", "m.st", "--virtual-time", "--cycles", cycles, "--retain", file]);
    assert_eq!((run("a", "2").code, run("b", "3").code), (0, 0));
    let show = plant.plcc(&["retain", "show", "a"]);
    assert_eq!(show.code, 0, "{}", show.stderr);
    for line in [
        "Main.n : LINT := 2\n",
        "Main.list[4000] : LINT := 2\n",
        "Main.mode : (Idle, Filling, Heating) := Heating\n",
        "Main.name : STRING[8] := 'run'\n",
    ] {
        assert!(show.stdout.contains(line), "{line} {}", &show.stdout[..500]);
    }
    assert!(!show.stdout.contains("volatile") && !show.stdout.contains("free"));
    let diff = plant.plcc(&["retain", "diff", "a", "b"]);
    assert!(diff.stdout.contains("~ Main.n : LINT := 2 -> LINT := 3\n"), "{}", &diff.stdout[..200]);
    assert!(!diff.stdout.contains("Main.name"));
    let edited =
        SETS.replace("n : LINT; list", "n : DINT; list").replace("name : STRING[8] := 'start'", "label : STRING[8]");
    let edited = edited.replace("name := 'run'", "label := 'x'").replace("n := n + 1;\nFOR", "n := n + DINT#1;\nFOR");
    plant.write("edited.st", &edited);
    let diff = plant.plcc(&["retain", "diff", "a", "edited.st"]);
    for line in [
        "dropped  Main.n : LINT; it is DINT now\n",
        "new      Main.label : STRING[8]\n",
        "dropped  Main.name : STRING[8] := 'run'\n",
    ] {
        assert!(diff.stdout.contains(line), "{line} {} {}", diff.stdout, diff.stderr);
    }
    // A subrange keeps what it can hold.
    let percent = |low: &str| format!("PROGRAM Main\nVAR RETAIN p : INT ({low}..100) := 50; END_VAR\nEND_PROGRAM\n");
    plant.write("wide.st", &percent("0"));
    plant.write("narrow.st", &percent("40"));
    let force = ["run", "wide.st", "--virtual-time", "--cycles", "1", "--retain", "p", "--force"];
    assert_eq!(plant.plcc(&[&force[..], &["Main.p=30"]].concat()).code, 0);
    assert_eq!(plant.plcc(&[&force[..], &["Main.p=101"]].concat()).code, 2);
    let diff = plant.plcc(&["retain", "diff", "p", "narrow.st"]);
    assert_eq!(diff.stdout, "dropped  Main.p := 30; there is no such value now\nkept     0 of 1 variables\n");
    let narrow = ["run", "narrow.st", "--virtual-time", "--cycles", "1", "--retain", "p", "--watch", "Main.p"];
    assert_eq!(plant.plcc(&narrow).stdout, "cycle,Main.p\n1,50\n");
    let wrong = plant.plcc(&["retain", "show", "m.st"]);
    assert!(wrong.code == 3 && wrong.stderr.contains("no retain file"), "{}", wrong.stderr);
    assert_eq!(plant.plcc(&["retain", "show", "nothing"]).code, 3);
}

/// The program faults if a set is torn; n must never be behind what the trace of the killed run shows.
#[test]
fn killed_at_random_moments_nothing_is_torn_or_lost() {
    let kills: u64 = std::env::var("KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(12);
    let plant = Plant::new(&[("m.st", SETS)]);
    plant.build("m.st", "m");
    let mut random = fastrand::Rng::with_seed(7);
    let mut before: i64 = 0;
    for kill in 0..kills {
        // Every other run is in real time; the flush runs as often as it can, in some runs never.
        let flush = ["1ms", "3ms", "1h"][random.usize(0..3)];
        let mut args = vec!["--retain", "r", "--watch", "Main.n", "--trace", "t.csv", "--retain-flush", flush];
        args.extend(if random.bool() { ["--virtual-time", "--cycles=100000000"] } else { ["--interval", "300us"] });
        let mut child = plant.start("m", &args);
        std::thread::sleep(Duration::from_micros(random.u64(0..60_000)));
        child.kill().expect("it is killed");
        let done = child.wait_with_output().expect("it ends");
        let stderr = String::from_utf8_lossy(&done.stderr);
        assert!(!stderr.contains("E0"), "kill {kill}: {stderr}");
        let show = plant.plcc(&["retain", "show", "r"]);
        if !plant.path("r").exists() {
            continue;
        }
        assert_eq!(show.code, 0, "kill {kill}: {}", show.stderr);
        let mut values = show.stdout.lines().filter_map(|l| {
            let (name, rest) = l.split_once(" : LINT := ")?;
            (name == "Main.n" || name.starts_with("Main.list[")).then(|| rest.parse::<i64>().expect("a number"))
        });
        let n = values.next().expect("Main.n");
        assert!(values.all(|v| v == n), "kill {kill}: torn at {n}");
        // The trace is written behind the capture, so what it shows is kept.
        let trace = std::fs::read_to_string(plant.path("t.csv")).unwrap_or_default();
        let rows = trace.rfind('\n').map_or("", |end| &trace[..end]);
        let traced = rows.lines().last().and_then(|l| l.split_once(',')).and_then(|(_, n)| n.parse::<i64>().ok());
        assert!(n >= traced.unwrap_or(before), "kill {kill}: {n} is kept, {traced:?} was traced, {before} before");
        before = n;
    }
    assert!(before > 0 || kills < 3, "no run came to a cycle");
    // A run that ends by itself leaves nothing in memory.
    assert_eq!(plant.run("m", &["--retain", "r", "--virtual-time", "--cycles", "1"]).code, 0);
}
