//! Input that nobody meant: each gives a diagnostic and the right exit code, in bounded time, without a panic.

use plcc_tests::{Done, command};
use std::path::Path;

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");

fn check(text: &[u8]) -> Done {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("x.st"), text).expect("the input");
    command(Path::new(PLCC), folder.path(), &["check", "x.st", "--message-format", "short"])
}

fn program(body: &str) -> String {
    format!("PROGRAM Main\nVAR x : INT; b : BOOL; END_VAR\n{body}\nEND_PROGRAM\n")
}

/// One message with this code at this line, and nothing else.
fn one(text: &str, code: &str, line: u32) {
    let done = check(text.as_bytes());
    assert_eq!(done.code, 1, "{}", done.stderr);
    let messages: Vec<&str> = done.stderr.lines().filter(|l| l.contains("[E")).collect();
    assert_eq!(messages.len(), 1, "{}", done.stderr);
    let start = format!("x.st:{line}:");
    assert!(messages[0].starts_with(&start) && messages[0].contains(code), "{}", done.stderr);
}

#[test]
fn binary_junk() {
    let mut seed = 0x2545_F491_4F6C_DD1Du64;
    for size in [1usize, 10, 1000, 100_000] {
        let junk: Vec<u8> = (0..size)
            .map(|_| {
                seed ^= seed << 13;
                seed ^= seed >> 7;
                seed ^= seed << 17;
                seed as u8
            })
            .collect();
        let done = check(&junk);
        assert!(
            done.code == 1 || done.code == 0,
            "size {size}: exit {} {}",
            done.code,
            &done.stderr[..done.stderr.len().min(400)]
        );
    }
}

#[test]
fn deep_nesting() {
    one(&program(&format!("x := {}1{};", "(".repeat(10_000), ")".repeat(10_000))), "E0122", 3);
    one(&program(&format!("x := {}1;", "(".repeat(100_000))), "E0122", 3);
    one(&program(&format!("b := {}b;", "NOT ".repeat(100_000))), "E0122", 3);
    one(&program(&format!("x := {}1;", "x + ".repeat(100_000))), "E0122", 3);
    one(&program(&format!("{}x := 1;{}", "IF b THEN ".repeat(5000), " END_IF;".repeat(5000))), "E0122", 3);
    let types = format!("PROGRAM Main\nVAR x : {}INT; END_VAR\nEND_PROGRAM\n", "ARRAY [1..2] OF ".repeat(10_000));
    one(&types, "E0122", 2);
    // A long chain that a program generator may write is no mistake.
    assert_eq!(check(program(&format!("x := {}1;", "x + ".repeat(3000))).as_bytes()).code, 0);
}

#[test]
fn unterminated_comment_and_string() {
    one(&program("x := 1; (* never closed"), "E0107", 3);
    one(&program("x := 1; (* outer (* inner *)\nx := 2;"), "E0107", 3);
    one("PROGRAM Main\nVAR s : STRING := 'never closed;\nx : INT; END_VAR\nx := 1;\nEND_PROGRAM\n", "E0108", 2);
}

#[test]
fn a_stray_nul_costs_one_message() {
    one("PROGRAM Main\u{0}\u{0}\nVAR x : INT; END_VAR\nx := 1;\nEND_PROGRAM\n", "E0106", 1);
}

#[test]
fn sources_that_are_not_utf8_are_latin1() {
    let text: Vec<u8> = program("x := 1; (* gr\u{f6}\u{df}e *)").chars().map(|c| c as u8).collect();
    assert!(std::str::from_utf8(&text).is_err());
    let done = check(&text);
    assert_eq!(done.code, 0, "{}", done.stderr);
    assert_eq!(check(program("x := 1; (* größe *)").as_bytes()).code, 0);
}

#[test]
fn cycles() {
    one(
        "TYPE A : STRUCT b : B; END_STRUCT; B : STRUCT a : A; END_STRUCT; END_TYPE\nPROGRAM Main\nVAR x : A; END_VAR\nEND_PROGRAM\n",
        "E0304",
        1,
    );
    one(
        "FUNCTION_BLOCK F\nVAR g : G; END_VAR\nEND_FUNCTION_BLOCK\nFUNCTION_BLOCK G\nVAR f : ARRAY [1..2] OF F; END_VAR\nEND_FUNCTION_BLOCK\n",
        "E0304",
        5,
    );
    one("TYPE A : B; B : A; END_TYPE\nPROGRAM Main\nVAR x : A; END_VAR\nEND_PROGRAM\n", "E0304", 1);
    one("VAR_GLOBAL CONSTANT\na : INT := b;\nb : INT := a;\nEND_VAR\nPROGRAM Main\nEND_PROGRAM\n", "E0305", 2);
}

#[test]
fn an_error_does_not_harm_what_follows() {
    let text = "PROGRAM Main\nVAR x : INT; END_VAR\nIF x > 0 THEN\n  x := 1;\nEND_PROGRAM\nFUNCTION F : INT\nVAR_INPUT a : INT; END_VAR\nF := a + c;\nEND_FUNCTION\n";
    let done = check(text.as_bytes());
    let places: Vec<&str> = done.stderr.lines().filter_map(|l| l.split(": ").next()).collect();
    assert_eq!(&places[..2], ["x.st:3:1", "x.st:8:10"], "{}", done.stderr);
    assert!(done.stderr.contains("2 errors"), "{}", done.stderr);
}

#[test]
fn an_empty_file_and_a_folder() {
    assert_eq!(check(b"").code, 0);
    assert_eq!(check(b"\xEF\xBB\xBFPROGRAM Main\nEND_PROGRAM\n").code, 0);
    let folder = tempfile::tempdir().expect("a folder");
    let done = command(Path::new(PLCC), folder.path(), &["check", "."]);
    assert_eq!(done.code, 3, "{}", done.stderr);
    std::fs::create_dir(folder.path().join("out")).expect("a folder");
    std::fs::write(folder.path().join("m.st"), program("x := 1;")).expect("a source");
    let done = command(Path::new(PLCC), folder.path(), &["build", "m.st", "-o", "out"]);
    assert_eq!(done.code, 3, "{}", done.stderr);
}

/// Nothing is looked for from each POU to the end of the file: empty ones, and lists of parameters that do not end.
#[test]
fn many_small_units() {
    let empty: String = (0..60_000).map(|n| format!("FUNCTION_BLOCK F{n}\nEND_FUNCTION_BLOCK\n")).collect();
    let done = check(empty.as_bytes());
    assert_eq!(done.code, 0, "{}", &done.stderr[..done.stderr.len().min(400)]);
    assert_eq!(check("FUNCTION F(\n".repeat(60_000).as_bytes()).code, 1);
}

/// Components, values and labels are not looked for one by one.
#[test]
fn many_components_and_labels() {
    let list = |f: &dyn Fn(usize) -> String| (0..20_000).map(f).collect::<String>();
    let fields = list(&|n| format!("f{n} : INT;\n"));
    let uses = list(&|n| format!("s.f{n} := {};\n", n % 100));
    let values = list(&|n| format!(", f{n} := 1"));
    let labels = list(&|n| format!("{n}: x := 1;\n"));
    let text = format!(
        "TYPE S : STRUCT g : INT;\n{fields}END_STRUCT; END_TYPE\nPROGRAM Main\nVAR s : S := (g := 1{values}); x : DINT; END_VAR\n\
         {uses}CASE x OF\n{labels}END_CASE;\nEND_PROGRAM\n"
    );
    let done = check(text.as_bytes());
    assert_eq!(done.code, 0, "{}", &done.stderr[..done.stderr.len().min(400)]);
}

/// 8 MB here, to be quick without optimisation; the time grows with the size and nothing else.
#[test]
fn a_large_file() {
    let text = program(&"x := x + 1; (* padding of a line that makes this file large *)\n".repeat(130_000));
    let done = check(text.as_bytes());
    assert_eq!(done.code, 0, "{}", &done.stderr[..done.stderr.len().min(400)]);
}
