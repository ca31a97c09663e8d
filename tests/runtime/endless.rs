//! Twenty shapes of endless loop: each is caught by the watchdog, in every engine, with a line of the loop, and its output is
//! safe. That it is caught within its deadline and 50 ms is measured by hand (`TIMES=1`): a test machine promises no time.

use crate::Plant;

/// A shape: what stands in front of the PROGRAM, its variables, its body, and the lines (of the body, from 1) that the fault
/// may name; with a block in front, of that text.
struct Shape {
    name: &'static str,
    front: &'static str,
    vars: &'static str,
    body: &'static str,
    lines: &'static [u32],
    in_front: bool,
}

const fn shape(name: &'static str, vars: &'static str, body: &'static str, lines: &'static [u32]) -> Shape {
    Shape { name, front: "", vars, body, lines, in_front: false }
}

const fn block(
    name: &'static str,
    front: &'static str,
    vars: &'static str,
    body: &'static str,
    lines: &'static [u32],
) -> Shape {
    Shape { name, front, vars, body, lines, in_front: true }
}

const SHAPES: [Shape; 20] = [
    shape("while_true", "", "WHILE TRUE DO\n;\nEND_WHILE;", &[1, 2, 3]),
    shape("while_condition", "n : INT;", "WHILE n < 10 DO\nn := n MOD 5;\nEND_WHILE;", &[1, 2, 3]),
    shape("repeat_false", "", "REPEAT\n;\nUNTIL FALSE END_REPEAT;", &[1, 2, 3]),
    shape("repeat_condition", "n : UINT;", "REPEAT\nn := n + 2;\nUNTIL n = 7 END_REPEAT;", &[1, 2, 3]),
    shape(
        "for_nested",
        "i, j, k : DINT; n : LINT;",
        "FOR i := 0 TO 2000000000 DO\nFOR j := 0 TO 2000000000 DO\nFOR k := 0 TO 2000000000 DO\nn := n + 1;\nEND_FOR;\nEND_FOR;\nEND_FOR;",
        &[1, 2, 3, 4, 5, 6, 7],
    ),
    shape("for_long", "i : LINT; n : LINT;", "FOR i := 0 TO 9000000000000000000 DO\nn := n + i;\nEND_FOR;", &[1, 2, 3]),
    shape("for_empty_body", "i : LINT;", "FOR i := 0 TO 9000000000000000000 DO\n;\nEND_FOR;", &[1, 2, 3]),
    shape("while_in_for", "i : INT;", "FOR i := 1 TO 3 DO\nWHILE TRUE DO\n;\nEND_WHILE;\nEND_FOR;", &[2, 3, 4]),
    shape(
        "for_in_while",
        "i, n : INT;",
        "WHILE n <> -1 DO\nFOR i := 1 TO 3 DO\nn := i;\nEND_FOR;\nEND_WHILE;",
        &[1, 2, 3, 4, 5],
    ),
    shape(
        "repeat_in_repeat",
        "",
        "REPEAT\nREPEAT\n;\nUNTIL TRUE END_REPEAT;\nUNTIL FALSE END_REPEAT;",
        &[1, 2, 3, 4, 5],
    ),
    shape("continue_always", "n : INT;", "WHILE n = 0 DO\nCONTINUE;\nEND_WHILE;", &[1, 2, 3]),
    shape("exit_never", "n : INT;", "WHILE TRUE DO\nIF n > 0 THEN\nEXIT;\nEND_IF;\nEND_WHILE;", &[1, 2, 3, 4, 5]),
    shape(
        "condition_global",
        "a : ARRAY [0..3] OF BOOL; i : INT;",
        "WHILE NOT a[i] DO\ni := (i + 1) MOD 4;\nEND_WHILE;",
        &[1, 2, 3],
    ),
    shape(
        "case_in_loop",
        "s : INT;",
        "REPEAT\nCASE s OF\n0: s := 1;\n1: s := 0;\nEND_CASE;\nUNTIL s > 1 END_REPEAT;",
        &[1, 2, 3, 4, 5, 6],
    ),
    shape("strings_in_loop", "t : STRING[20];", "WHILE LEN(t) < 30 DO\nt := CONCAT(t, 'x');\nEND_WHILE;", &[1, 2, 3]),
    shape("il_jump_back", "n : INT;", "LD lamp\nagain: LD n\nADD 1\nST n\nJMP again", &[2, 3, 4, 5]),
    shape("il_conditional_jump", "n : INT;", "LD n\nback: LD n\nEQ 0\nJMPC back", &[2, 3, 4]),
    block(
        "in_function_block",
        "FUNCTION_BLOCK Spin\nVAR n : DINT; END_VAR\nWHILE n >= 0 DO\nn := (n + 1) MOD 1000;\nEND_WHILE;\nEND_FUNCTION_BLOCK\n",
        "s : Spin;",
        "s();",
        &[3, 4, 5],
    ),
    block(
        "in_action",
        "FUNCTION_BLOCK Spin\nVAR n : DINT; END_VAR\nturn();\nACTION turn :\nREPEAT\nn := 0;\nUNTIL n > 0 END_REPEAT;\nEND_ACTION\nEND_FUNCTION_BLOCK\n",
        "s : Spin;",
        "s();",
        &[5, 6, 7],
    ),
    block(
        "in_function",
        "FUNCTION Spin : DINT\nVAR_INPUT a : DINT; END_VAR\nWHILE a = 0 DO\nSpin := Spin + 1;\nEND_WHILE;\nEND_FUNCTION\n",
        "n : DINT;",
        "n := Spin(0);",
        &[3, 4, 5],
    ),
];

impl Shape {
    /// The first cycle is harmless and sets the output.
    fn source(&self) -> (String, u32) {
        let il = self.name.starts_with("il_");
        let guard = if il {
            "LD started\nJMPC go\nS lamp\nLDN started\nST started\nRET\ngo: "
        } else {
            "IF NOT started THEN\nstarted := TRUE;\nlamp := TRUE;\nRETURN;\nEND_IF;\n"
        };
        // LD started is FALSE in the first cycle: the lamp needs TRUE.
        let guard = if il { "LD started\nJMPC go\nLD TRUE\nST started\nST lamp\nRET\ngo:\n" } else { guard };
        let head = format!(
            "{}PROGRAM Main\nVAR started : BOOL; lamp AT %QX0.0 : BOOL; {} END_VAR\n{guard}",
            self.front, self.vars
        );
        let first = head.lines().count() as u32;
        (format!("{head}{}\nEND_PROGRAM\n", self.body), if self.in_front { 0 } else { first })
    }
}

#[test]
fn twenty_shapes_of_endless_loop_are_caught_with_a_line_of_the_loop() {
    let failures = std::sync::Mutex::new(Vec::new());
    // Most of the time is spent in waiting and linking.
    std::thread::scope(|scope| {
        for shapes in SHAPES.chunks(SHAPES.len() / 4) {
            let failures = &failures;
            scope
                .spawn(move || shapes.iter().for_each(|shape| failures.lock().expect("no panic").extend(check(shape))));
        }
    });
    let failures = failures.into_inner().expect("no panic");
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n"));
}

/// What is wrong with the runs of a shape.
fn check(shape: &Shape) -> Vec<String> {
    let plant = Plant::new(&[]);
    let (text, first) = shape.source();
    plant.write("m.st", &text);
    plant.build("m.st", "m");
    let allowed: Vec<String> = shape.lines.iter().map(|line| format!("--> m.st:{}:", first + line)).collect();
    let mut failures = Vec::new();
    let mut judge = |what: &str, done: plcc_tests::Done| {
        let line = allowed.iter().any(|line| done.stderr.contains(line));
        let outputs = plant.read("out.csv");
        if done.code != 1 || !done.stderr.contains("E0608") || !line || outputs != "cycle,Main.lamp\n1,TRUE\n2,FALSE\n"
        {
            failures
                .push(format!("{} {what}: exit code {}\n{}\n{outputs}\n{text}", shape.name, done.code, done.stderr));
        }
    };
    let flags = ["--watchdog", "60ms", "--cycles", "5", "--io", "csv:,out.csv"];
    let start = std::time::Instant::now();
    let done = plant.run("m", &flags);
    if std::env::var_os("TIMES").is_some() {
        // With the start of the process and the first cycle: an upper bound of what the watchdog took.
        eprintln!("{}: {} ms with a watchdog of 60 ms", shape.name, start.elapsed().as_millis());
    }
    judge("linked", done);
    judge("linked, virtual time", plant.run("m", &[&flags[..], &["--virtual-time"]].concat()));
    for engine in ["jit", "interp"] {
        judge(engine, plant.plcc(&[&["run", "m.st", "--engine", engine, "--virtual-time"], &flags[..]].concat()));
    }
    failures
}
