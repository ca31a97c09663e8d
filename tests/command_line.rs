//! The contract of docs/cli.md: commands, exit codes, files, formats.

use plcc_tests::{Done, command, project_root};
use std::path::Path;

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");

fn plcc(folder: &Path, args: &[&str]) -> Done {
    command(Path::new(PLCC), folder, args)
}

fn folder_with(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().expect("inside the folder")).expect("its folder");
        std::fs::write(path, text).expect("a file");
    }
    folder
}

const COUNTER: &str = "PROGRAM Main\nVAR n : INT; END_VAR\nn := n + 1;\nEND_PROGRAM\n";

#[test]
fn exit_codes() {
    let f = folder_with(&[
        ("good.st", COUNTER),
        ("bad.st", "PROGRAM Main\nx := 1;\nEND_PROGRAM\n"),
        ("warned.st", "PROGRAM Main\nVAR n : INT; END_VAR\nEND_PROGRAM\n"),
        ("fault.st", "PROGRAM Main\nVAR n, z : INT; END_VAR\nn := 1 / z;\nEND_PROGRAM\n"),
    ]);
    let p = f.path();
    let run = |args: &[&str]| plcc(p, args).code;
    assert_eq!(run(&["check", "good.st"]), 0);
    assert_eq!(run(&["check", "bad.st"]), 1);
    // [G1] 1 on errors only.
    let done = plcc(p, &["check", "warned.st", "--message-format", "short"]);
    assert!(done.stderr.starts_with("warned.st:2:5: warning[W0351]: `n`"), "{}", done.stderr);
    assert_eq!(done.code, 0);
    assert_eq!(run(&["run", "good.st", "--virtual-time", "--cycles", "3"]), 0);
    assert_eq!(run(&["run", "fault.st", "--virtual-time", "--cycles", "3"]), 1);
    assert_eq!(run(&["run", "good.st", "--cycles", "3", "--watch", "Main.q"]), 2);
    assert_eq!(run(&["run", "good.st", "--cycles", "many"]), 2);
    assert_eq!(run(&["frobnicate"]), 2);
    assert_eq!(run(&["check", "missing.st"]), 3);
    assert_eq!(run(&["build", "good.st", "-o", "no/such/folder/app"]), 3);
    assert_eq!(run(&["run", "good.st", "--cycles", "1", "--trace", "no/such/t.csv"]), 3);
    assert_eq!(run(&["run", "good.st", "--cycles", "1", "--stimulus", "none.csv"]), 3);
}

/// [E6] Without checks x / 0 and MOD 0 give 0, in all engines; with them they are faults.
#[test]
fn without_checks_division_by_zero_gives_zero() {
    let text = "PROGRAM Main\nVAR n : INT := 7; z : INT; q, r : INT := 1; END_VAR\n\
                n := n + 1;\nq := n / z;\nr := n MOD z;\nEND_PROGRAM\n";
    let f = folder_with(&[("main.st", text)]);
    let p = f.path();
    let flags = ["--virtual-time", "--cycles", "2", "--watch", "Main.n,Main.q,Main.r", "--trace", "-"];
    let expected = "cycle,Main.n,Main.q,Main.r\n1,8,0,0\n2,9,0,0\n";
    for engine in ["interp", "jit"] {
        let args = ["run", "main.st", "--engine", engine];
        assert_eq!(plcc(p, &[&args[..], &["--checks", "none"], &flags].concat()).stdout, expected, "{engine}");
        let checked = plcc(p, &[&args[..], &flags].concat());
        assert!(checked.code == 1 && checked.stderr.contains("error[E0601]"), "{engine}: {}", checked.stderr);
    }
    assert_eq!(plcc(p, &["build", "main.st", "-o", "app", "--checks", "none"]).code, 0);
    assert_eq!(command(&p.join("app"), p, &flags).stdout, expected);
}

#[test]
fn the_linked_program_takes_the_run_flags_and_leaves_no_partial_file() {
    let f = folder_with(&[("good.st", COUNTER), ("in.csv", "cycle,Main.n\n3,40\n")]);
    let done = plcc(f.path(), &["build", "good.st", "-o", "app"]);
    assert_eq!(done.code, 0, "{}", done.stderr);
    let app = f.path().join("app");
    let flags = ["--virtual-time", "--cycles", "4", "--stimulus", "in.csv", "--watch", "main.N", "--trace", "-"];
    let linked = command(&app, f.path(), &flags);
    assert_eq!(linked.stdout, "cycle,main.N\n1,1\n2,2\n3,41\n4,42\n");
    let jit = plcc(f.path(), &[&["run", "good.st"], &flags[..]].concat());
    assert_eq!(linked.stdout, jit.stdout);
    assert_eq!(command(&app, f.path(), &["--engine", "jit"]).code, 2);
    let unlinkable = Path::new(PLCC);
    let done = std::process::Command::new(unlinkable)
        .args(["build", "good.st", "-o", "other"])
        .current_dir(f.path())
        .env("CC", "no-such-compiler")
        .output()
        .expect("plcc starts");
    assert_eq!(done.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&done.stderr).contains("install a C tool chain"));
    let left: Vec<String> = std::fs::read_dir(f.path())
        .expect("the folder")
        .flatten()
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .filter(|n| n.starts_with("other") || n.contains("partial"))
        .collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn a_copied_plcc_alone_builds_a_program() {
    let f = folder_with(&[("good.st", COUNTER)]);
    let copy = f.path().join("my-plcc");
    std::fs::copy(PLCC, &copy).expect("a copy");
    let done = command(&copy, f.path(), &["build", "good.st", "-o", "app"]);
    assert_eq!(done.code, 0, "{}", done.stderr);
    assert_eq!(
        command(&f.path().join("app"), f.path(), &["--virtual-time", "--cycles", "2", "--watch", "Main.n"]).stdout,
        "cycle,Main.n\n1,1\n2,2\n"
    );
}

#[test]
fn new_makes_a_project_that_builds_and_runs() {
    let f = folder_with(&[]);
    assert_eq!(plcc(f.path(), &["new", "blink"]).code, 0);
    assert_eq!(plcc(f.path(), &["new", "blink"]).code, 3);
    let done =
        plcc(f.path(), &["run", "blink/project.toml", "--virtual-time", "--cycles", "120", "--watch", "Main.lamp"]);
    assert_eq!(done.code, 0, "{}", done.stderr);
    let changes: Vec<&str> = done.stdout.lines().filter(|l| l.ends_with("TRUE")).take(1).collect();
    assert_eq!(changes, ["51,TRUE"], "{}", done.stdout);
    assert!(done.stderr.is_empty(), "{}", done.stderr);
    let inside = f.path().join("blink");
    assert_eq!(plcc(&inside, &["build", "project.toml"]).code, 0);
    assert!(inside.join("blink").is_file());
}

#[test]
fn folders_globs_and_several_files() {
    let f = folder_with(&[
        ("src/main.st", "PROGRAM Main\nVAR n : INT; END_VAR\nn := Twice(n + 1);\nEND_PROGRAM\n"),
        ("src/deep/f.ST", "FUNCTION Twice : INT\nVAR_INPUT x : INT; END_VAR\nTwice := 2 * x;\nEND_FUNCTION\n"),
        ("src/notes.md", "not a source"),
    ]);
    for sources in [&["src"][..], &["src/**/*.[sS][tT]"], &["src/main.st", "src/deep/f.ST"]] {
        let args = [&["run"], sources, &["--virtual-time", "--cycles", "3", "--watch", "Main.n"]].concat();
        let done = plcc(f.path(), &args);
        assert_eq!(done.stdout, "cycle,Main.n\n1,2\n2,6\n3,14\n", "{}", done.stderr);
    }
    assert_eq!(plcc(f.path(), &["check", "*.st"]).code, 3);
}

#[test]
fn the_project_file_is_strict_and_helpful() {
    let project = |text: &str| {
        let f = folder_with(&[("main.st", COUNTER), ("project.toml", text)]);
        plcc(f.path(), &["check", "project.toml"])
    };
    assert_eq!(project("[project]\nname = \"a\"\nsources = [\"main.st\"]\n").code, 0);
    let typo = project("[project]\nname = \"a\"\nsources = [\"main.st\"]\nprofil = \"strict\"\n");
    assert_eq!(typo.code, 2);
    assert!(typo.stderr.contains("did you mean `profile`?"), "{}", typo.stderr);
    let missing = project("[project]\nname = \"a\"\nsources = [\"none.st\"]\n");
    assert_eq!(missing.code, 3);
    let broken = project("[project\n");
    assert_eq!(broken.code, 2);
    assert!(broken.stderr.contains("line 1"), "{}", broken.stderr);
    let tasks =
        "[project]\nname = \"a\"\nsources = [\"main.st\"]\n[tasks.slow]\ninterval = \"20ms\"\nprograms = [\"Mein\"]\n";
    assert!(project(tasks).stderr.contains("did you mean `Main`?"));
}

#[test]
fn tasks_of_the_project_file_run_at_their_interval() {
    let f = folder_with(&[
        (
            "main.st",
            "PROGRAM A\nVAR n : INT; END_VAR\nn := n + 1;\nEND_PROGRAM\nPROGRAM B\nVAR n : INT; END_VAR\nn := n + 1;\nEND_PROGRAM\n",
        ),
        (
            "project.toml",
            "[project]\nname = \"a\"\nsources = [\"main.st\"]\n[tasks.fast]\ninterval = \"10ms\"\nprograms = [\"A\"]\n\
             [tasks.slow]\ninterval = \"20ms\"\npriority = 2\nprograms = [\"B\"]\n",
        ),
    ]);
    let done = plcc(f.path(), &["run", "project.toml", "--virtual-time", "--cycles", "4", "--watch", "A.n,B.n"]);
    assert_eq!(done.stdout, "cycle,A.n,B.n\n1,1,1\n2,2,1\n3,3,2\n4,4,2\n", "{}", done.stderr);
}

#[test]
fn a_library_has_its_own_profile() {
    let f = folder_with(&[
        ("main.st", "PROGRAM Main\nVAR n : INT; END_VAR\nn := Lax(2.5);\nEND_PROGRAM\n"),
        ("lib/lax.st", "FUNCTION Lax : INT\nVAR_INPUT x : REAL; END_VAR\nLax := x;\nEND_FUNCTION\n"),
        (
            "project.toml",
            "[project]\nname = \"a\"\nsources = [\"main.st\"]\n[libraries]\nlax = { path = \"lib\", profile = \"codesys\" }\n",
        ),
    ]);
    let done = plcc(f.path(), &["run", "project.toml", "--virtual-time", "--cycles", "1", "--watch", "Main.n"]);
    assert_eq!((done.code, done.stdout.as_str()), (0, "cycle,Main.n\n1,2\n"), "{}", done.stderr);
    let strict = plcc(f.path(), &["check", "main.st", "lib/lax.st"]);
    assert_eq!(strict.code, 1);
    assert!(strict.stderr.contains("--profile codesys"), "{}", strict.stderr);
}

#[test]
fn messages_as_json_and_sarif() {
    let f = folder_with(&[("bad.st", "PROGRAM Main\nVAR level : INT; END_VAR\nlevl := 1;\nEND_PROGRAM\n")]);
    let json = plcc(f.path(), &["check", "bad.st", "--message-format", "json"]);
    let value: serde_json::Value = serde_json::from_str(json.stderr.trim()).expect("one JSON object");
    assert_eq!(value["code"], "E0201");
    assert_eq!(value["primary"]["line"], 3);
    assert_eq!(value["primary"]["column"], 1);
    assert_eq!(value["help"][0], "did you mean `level`?");
    let sarif = plcc(f.path(), &["check", "bad.st", "--message-format", "sarif"]);
    let value: serde_json::Value = serde_json::from_str(&sarif.stderr).expect("a SARIF log");
    assert_eq!(value["version"], "2.1.0");
    assert_eq!(value["runs"][0]["results"][0]["ruleId"], "E0201");
    assert_eq!(value["runs"][0]["results"][0]["locations"][0]["physicalLocation"]["region"]["startLine"], 3);
}

#[test]
fn every_stage_can_be_printed() {
    let tank = project_root().join("examples/tank/project.toml").display().to_string();
    let f = folder_with(&[]);
    for (stage, word) in [
        ("tokens", "END_FUNCTION_BLOCK"),
        ("ast", "TankControl"),
        ("hir", "FUNCTION_BLOCK TankControl"),
        ("mir", "Main"),
        ("clif", "function"),
        ("asm", "ret"),
    ] {
        let done = plcc(f.path(), &["build", &tank, "--emit", stage]);
        assert_eq!(done.code, 0, "{stage}: {}", done.stderr);
        assert!(done.stdout.contains(word), "{stage}: {}", &done.stdout[..done.stdout.len().min(500)]);
    }
}

#[test]
fn other_targets_yield_an_object_and_a_header() {
    let f = folder_with(&[("good.st", COUNTER)]);
    let done = plcc(f.path(), &["build", "good.st", "--target", "aarch64-unknown-linux-gnu", "-o", "app"]);
    assert_eq!(done.code, 0, "{}", done.stderr);
    assert!(done.stderr.contains("app.o"), "{}", done.stderr);
    assert!(f.path().join("app.o").exists() && f.path().join("app.h").exists());
    assert_eq!(plcc(f.path(), &["build", "good.st", "--target", "pdp11-dec-none"]).code, 2);
}

#[test]
fn real_time_runs_stop_on_a_signal_with_a_whole_trace() {
    let f = folder_with(&[("good.st", COUNTER)]);
    let mut child = std::process::Command::new(PLCC)
        .args(["run", "good.st", "--interval", "5ms", "--watch", "Main.n", "--trace", "t.csv"])
        .current_dir(f.path())
        .spawn()
        .expect("plcc starts");
    std::thread::sleep(std::time::Duration::from_millis(1500));
    let pid = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-TERM", &pid]).status().expect("kill runs").success());
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
    let trace = std::fs::read_to_string(f.path().join("t.csv")).expect("the trace");
    assert!(trace.ends_with('\n') && trace.lines().count() > 10, "{trace}");
    for (n, line) in trace.lines().enumerate().skip(1) {
        assert_eq!(line, format!("{n},{n}"));
    }
}

const CHART: &str = "FUNCTION_BLOCK Lane\nVAR_INPUT go : BOOL; END_VAR\nINITIAL_STEP A: END_STEP\nSTEP B: END_STEP\n\
    TRANSITION FROM A TO B := go AND (1 < 2); END_TRANSITION\nTRANSITION FROM B TO A := NOT go; END_TRANSITION\nEND_FUNCTION_BLOCK\n";

#[test]
fn charts_are_drawn_and_active_steps_marked() {
    let trace = "cycle,Main.left.A.X,Main.left.B.X,Main.right.A.X,Main.right.B.X\n1,TRUE,FALSE,TRUE,FALSE\n2,FALSE,TRUE,TRUE,FALSE\n";
    let f = folder_with(&[("lane.st", CHART), ("main.st", COUNTER), ("run.csv", trace)]);
    let graph = |args: &[&str]| plcc(f.path(), &[&["graph", "lane.st", "--sfc"], args].concat());
    let done = graph(&["-o", "lane.svg"]);
    assert_eq!((done.code, done.stdout.as_str()), (0, ""), "{}", done.stderr);
    let text = std::fs::read_to_string(f.path().join("lane.svg")).expect("the drawing");
    assert!(text.starts_with("<svg ") && text.contains(">go AND (1 &lt; 2)</text>"), "{text}");
    assert_eq!(text, graph(&["--pou", "LANE"]).stdout);
    let dots = |args: &[&str]| graph(args).stdout.matches("<circle ").count();
    assert_eq!(dots(&[]), 0);
    // The box of B is filled in cycle 2 of `left`, that of A in `right`.
    let live = |instance: &str| {
        let text = graph(&["--trace", "run.csv", "--cycle", "2", "--instance", instance]).stdout;
        let box_at = text.find("class=\"box live\"").expect("an active step");
        text[box_at..].split("</text>").next().expect("its name").chars().last()
    };
    assert_eq!((live("main.left"), live("Main.right")), (Some('B'), Some('A')));
    let wrong = |args: &[&str], code: i32, part: &str| {
        let done = graph(args);
        assert!(done.code == code && done.stderr.contains(part), "{args:?}: {} {}", done.code, done.stderr);
    };
    wrong(&["--trace", "run.csv", "--cycle", "2"], 2, "choose with --instance: Main.left, Main.right");
    wrong(&["--trace", "run.csv", "--cycle", "3"], 2, "there is no cycle 3; the last one is 2");
    wrong(&["--trace", "run.csv"], 2, "--cycle");
    wrong(&["--trace", "run.csv", "--cycle", "1", "--instance", "Main.middle"], 2, "`Main.middle.A.X`");
    wrong(&["--trace", "no.csv", "--cycle", "1"], 3, "no.csv");
    wrong(&["--pou", "Lame"], 2, "did you mean `Lane`?");
    wrong(&["-o", "no/such/lane.svg"], 3, "lane.svg");
    assert_eq!(plcc(f.path(), &["graph", "main.st", "--sfc"]).code, 2);
    assert_eq!(plcc(f.path(), &["graph", "lane.st"]).code, 2);
}

/// `lanes` simultaneous branches of `length` steps; with `mesh`, neighbours can also go on together.
fn lanes(lanes: usize, length: usize, mesh: bool) -> String {
    let step = |l: usize, s: usize| format!("L{}_{s}", l % lanes);
    let all = |s: usize| (0..lanes).map(|l| step(l, s)).collect::<Vec<_>>().join(", ");
    let mut text = "PROGRAM Main\nVAR_INPUT go : BOOL; END_VAR\nINITIAL_STEP Start: END_STEP\n".to_string();
    let mut link =
        |from: String, to: String| text.push_str(&format!("TRANSITION FROM {from} TO {to} := go; END_TRANSITION\n"));
    link("Start".into(), format!("({})", all(0)));
    link(format!("({})", all(length - 1)), "Start".into());
    for l in 0..lanes {
        for s in 0..length - 1 {
            link(step(l, s), step(l, s + 1));
            if mesh && s % 2 == 1 {
                let pair = |s| format!("({}, {})", step(l, s), step(l + 1, s));
                link(pair(s), pair(s + 1));
            }
        }
    }
    let steps = (0..lanes * length).map(|n| format!("STEP {}: END_STEP\n", step(n / length, n % length)));
    text + &steps.collect::<String>() + "END_PROGRAM\n"
}

#[test]
fn large_charts_are_proved_or_said_to_be_not_proved() {
    let f = folder_with(&[("lanes.st", &lanes(8, 24, false)), ("mesh.st", &lanes(12, 8, true))]);
    let done = plcc(f.path(), &["check", "lanes.st", "--message-format", "short"]);
    assert_eq!((done.code, done.stderr.as_str()), (0, ""));
    let done = plcc(f.path(), &["check", "mesh.st", "--message-format", "short"]);
    let told =
        "mesh.st:3:1: warning[W0480]: the structure of this chart is not proved beyond 50001 markings\n1 warning\n";
    assert_eq!((done.code, done.stderr.as_str()), (0, told));
}

/// `plcc bench`: the report in all forms; a fault is told as by `plcc run`, and nothing is measured.
#[test]
fn bench_reports() {
    let fault = "PROGRAM Main\nVAR n, z : INT; END_VAR\nn := n + 1;\nz := 10 / (5 - n);\nEND_PROGRAM\n";
    let eno = "FUNCTION F : INT\nVAR_INPUT a, b : INT; END_VAR\nF := a / b;\nEND_FUNCTION\n\
               PROGRAM Main\nVAR n, q : INT; ok : BOOL; END_VAR\nn := n + 1;\n\
               q := F(EN := TRUE, a := 10, b := n MOD 3, ENO => ok);\nEND_PROGRAM\n";
    let endless = "PROGRAM Main\nVAR n : INT; END_VAR\nWHILE n = 0 DO\n  ;\nEND_WHILE;\nEND_PROGRAM\n";
    let f = folder_with(&[
        ("count.st", COUNTER),
        ("fault.st", fault),
        ("endless.st", endless),
        ("in.csv", "cycle,Main.n\n3,40\n"),
        ("eno.st", eno),
    ]);
    // Without a path there is neither linker nor valgrind: both are said to be missing.
    let bench = |args: &[&str]| -> Done {
        let mut command = std::process::Command::new(PLCC);
        command.args(["bench", "--cycles", "20"]).args(args).current_dir(f.path()).env("PATH", "");
        command.output().expect("plcc starts").into()
    };
    let done = bench(&["count.st", "--stimulus", "in.csv", "-o", "out"]);
    assert_eq!(done.code, 0, "{}", done.stderr);
    let read = |name: &str| std::fs::read_to_string(f.path().join("out").join(name)).expect(name);
    let text = read("report.md");
    for part in
        ["# Cycle times of count", "## Slow cycles", "`linked` was not measured", "that needs valgrind", "## Method"]
    {
        assert!(text.contains(part), "{part} is missing in\n{text}");
    }
    let json: serde_json::Value = serde_json::from_str(&read("report.json")).expect("JSON");
    let lanes = json["programs"][0]["lanes"].as_array().expect("lanes");
    let names: Vec<&str> = lanes.iter().filter_map(|l| l["name"].as_str()).collect();
    assert_eq!(names, ["interpreter", "jit, opt none", "jit, no checks", "jit"]);
    assert!(lanes.iter().all(|l| l["median_ns"].as_f64().is_some_and(|ns| ns > 0.0)), "{lanes:?}");
    assert!(read("ratios.svg").starts_with("<svg "));
    // Code without checks would not do the same where a fault is caught.
    let done = bench(&["eno.st"]);
    assert!(done.code == 0 && done.stdout.contains("`jit, no checks` was not measured"), "{done:?}");
    let done = bench(&["fault.st"]);
    assert_eq!((done.code, done.stdout.as_str()), (1, ""));
    assert!(done.stderr.contains("--> fault.st:4:") && done.stderr.ends_with("cycle 5\n"), "{}", done.stderr);
    let done = bench(&["endless.st"]);
    assert_eq!(done.code, 1);
    assert!(done.stderr.contains("endless.st:3:"), "{}", done.stderr);
    assert_eq!(bench(&["count.st", "--stimulus", "none.csv"]).code, 3);
    assert_eq!(bench(&["count.st", "--cycles", "0"]).code, 2);
}

#[test]
fn traces_are_drawn() {
    let f = folder_with(&[("good.st", COUNTER)]);
    let run = plcc(f.path(), &["run", "good.st", "--virtual-time", "--cycles", "5", "--trace", "t.csv"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let done = plcc(f.path(), &["trace", "t.csv", "--svg", "t.svg"]);
    assert_eq!((done.code, done.stdout.as_str()), (0, ""), "{}", done.stderr);
    let svg = std::fs::read_to_string(f.path().join("t.svg")).expect("the drawing");
    assert!(svg.starts_with("<svg ") && svg.contains(">Main.n</text>"), "{svg}");
    assert_eq!(plcc(f.path(), &["trace", "t.csv"]).stdout, svg);
    let part = plcc(f.path(), &["trace", "t.csv", "--cycles", "2..4", "--watch", "main.N"]).stdout;
    assert!(part.contains(">4</text>") && !part.contains(">5</text>"), "{part}");
    let wrong = |args: &[&str], code: i32, text: &str| {
        let done = plcc(f.path(), &[&["trace"], args].concat());
        assert!(done.code == code && done.stderr.contains(text), "{args:?}: {} {}", done.code, done.stderr);
    };
    wrong(&["t.csv", "--watch", "Main.m"], 2, "there is no column `Main.m`; did you mean `Main.n`?");
    wrong(&["t.csv", "--cycles", "7.."], 2, "no such cycles");
    wrong(&["t.csv", "--cycles", "seven"], 2, "is not FIRST..LAST");
    wrong(&["good.st"], 2, "no trace");
    wrong(&["none.csv"], 3, "none.csv");
}

/// PLCopen XML among the sources: mixed with text, in folders beside other XML, in project.toml; drawn, and as text.
#[test]
fn plcopen_xml() {
    let var = |name: &str, ty: &str| format!("<variable name=\"{name}\"><type>{ty}</type></variable>");
    let plant = format!(
        "<?xml version=\"1.0\"?>\n<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
         <pou name=\"Main\" pouType=\"program\"><interface><localVars>{}{}</localVars></interface>\n<body><FBD>\n\
         <block localId=\"1\" typeName=\"Twice\" instanceName=\"t\"><position x=\"60\" y=\"20\"/><inputVariables><variable formalParameter=\"v\">\
         <connectionPointIn><connection refLocalId=\"2\"/></connectionPointIn></variable></inputVariables>\
         <outputVariables><variable formalParameter=\"r\"><connectionPointOut/></variable></outputVariables></block>\n\
         <inVariable localId=\"2\"><position x=\"0\" y=\"20\"/><connectionPointOut/><expression>n + 1</expression></inVariable>\n\
         <outVariable localId=\"3\"><position x=\"160\" y=\"20\"/><connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn><expression>n</expression></outVariable>\n\
         </FBD></body></pou></pous></types></project>\n",
        var("n", "<INT/>"),
        var("t", "<derived name=\"Twice\"/>")
    );
    let twice = "FUNCTION_BLOCK Twice\nVAR_INPUT v : INT; END_VAR\nVAR_OUTPUT r : INT; END_VAR\nr := 2 * v;\nEND_FUNCTION_BLOCK\n";
    let f = folder_with(&[
        ("p/plc.xml", &plant),
        ("p/beremiz.xml", "<BeremizRoot xmlns=\"urn:x\"/>"),
        ("p/twice.st", twice),
        ("project.toml", "[project]\nname = \"p\"\nsources = [\"p/*.st\", \"p/plc.xml\"]\n"),
    ]);
    let trace = "cycle,Main.n\n1,2\n2,6\n3,14\n";
    let flags = ["--virtual-time", "--cycles", "3", "--watch", "Main.n"];
    let run = |files: &[&str]| plcc(f.path(), &[&["run"], files, &flags[..]].concat()).stdout;
    assert_eq!(run(&["p/plc.xml", "p/twice.st"]), trace);
    // Other XML files of a folder are none of its sources; named, one is refused.
    assert_eq!(run(&["p"]), trace);
    assert_eq!(run(&["project.toml"]), trace);
    let done = plcc(f.path(), &["check", "p/beremiz.xml"]);
    assert!(done.code == 1 && done.stderr.contains("E0131"), "{}", done.stderr);

    // Line and column of the XML, POU and element.
    let done = plcc(f.path(), &["check", "p/plc.xml", "--message-format", "short"]);
    let before = plant.lines().nth(2).and_then(|l| l.find("derived name=\"")).expect("the type");
    let column = before + "derived name=\"".len() + 1;
    let message = format!("p/plc.xml:3:{column}: error[E0203]: there is no type `Twice` (Main)");
    assert!(done.code == 1 && done.stderr.starts_with(&message), "{}", done.stderr);

    let drawn = plcc(f.path(), &["graph", "p"]);
    assert!(drawn.code == 0 && drawn.stdout.contains(">Twice</text>"), "{}", drawn.stderr);
    assert_eq!(plcc(f.path(), &["graph", "p", "--pou", "Main"]).stdout, drawn.stdout);
    assert_eq!(plcc(f.path(), &["graph", "p", "--sfc"]).code, 2);

    let done = plcc(f.path(), &["convert", "p", "--to", "st", "-o", "main.st"]);
    assert_eq!(done.code, 0, "{}", done.stderr);
    let text = std::fs::read_to_string(f.path().join("main.st")).expect("the text");
    assert!(text.contains("t(v := n + 1);\nn := t.r;\n") && !text.contains("FUNCTION_BLOCK Twice"), "{text}");
    assert_eq!(run(&["main.st", "p/twice.st"]), trace);
    assert_eq!(plcc(f.path(), &["convert", "p/twice.st", "--to", "st"]).code, 2);
    assert_eq!(plcc(f.path(), &["convert", "p", "--to", "c"]).code, 2);
}
