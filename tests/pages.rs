//! The pages behind `plcc explain CODE`: the first example of each page yields exactly its code.

use plcc_diag::codes;
use plcc_tests::command;
use std::path::Path;

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");

/// The first fenced block, its language (`st` or `xml`), and whether it is for profile codesys.
fn example(page: &str) -> Option<(String, &str, bool)> {
    let start = page.find("```st").or_else(|| page.find("```xml"))?;
    let (info, body) = page[start + 3..].split_once('\n')?;
    let language = if info.starts_with("xml") { "xml" } else { "st" };
    Some((body[..body.find("```")?].to_string(), language, info.contains("codesys")))
}

#[test]
fn each_example_yields_exactly_its_code() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut wrong = Vec::new();
    for info in codes::all().map(|c| c.info()) {
        let Some((text, language, codesys)) = example(info.page) else {
            // Faults, the project file, what is not built yet and what takes pages of text (too deep, too many errors,
            // too large a chart) have no example.
            let no_example = ["E0399", "E0507", "E0122", "E0123", "W0480"];
            let exempt = info.code[1..].starts_with("06") || no_example.contains(&info.code);
            if !exempt {
                wrong.push(format!("{}: no example", info.code));
            }
            continue;
        };
        let name = format!("{}.{language}", info.code);
        std::fs::write(folder.path().join(&name), &text).expect("the example is written");
        let mut args = vec!["check", &name, "--message-format", "short"];
        if codesys {
            args.extend(["--profile", "codesys"]);
        }
        let done = command(Path::new(PLCC), folder.path(), &args);
        let found: Vec<&str> = done.stderr.lines().filter_map(|l| l.split_once('[')?.1.split(']').next()).collect();
        if found != [info.code] {
            wrong.push(format!("{}: its example gives {found:?}\n{}", info.code, done.stderr));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn codes_are_unique_and_in_order_of_their_sections() {
    let mut seen = std::collections::HashSet::new();
    for info in codes::all().map(|c| c.info()) {
        assert!(seen.insert(info.code), "{} stands twice", info.code);
        let severity = match info.code.as_bytes()[0] {
            b'E' => codes::Severity::Error,
            b'W' => codes::Severity::Warning,
            _ => codes::Severity::Hint,
        };
        assert_eq!(info.severity, severity, "{}", info.code);
    }
}

#[test]
fn explain_knows_codes_functions_and_blocks() {
    let explain = |name: &str| command(Path::new(PLCC), Path::new("."), &["explain", name]);
    assert!(explain("e0301").stdout.starts_with("E0301: a value has the wrong type"));
    assert!(explain("limit").stdout.starts_with("LIMIT(MN : ANY_ELEMENTARY"));
    assert!(explain("TON").stdout.contains("FUNCTION_BLOCK TON"));
    assert!(explain("E0602").stdout.contains("index"));
    let unknown = explain("LIMITT");
    assert_eq!(unknown.code, 2);
    assert!(unknown.stderr.contains("did you mean `LIMIT`?"), "{}", unknown.stderr);
}

/// `plcc explain` says of each operator of Instruction List what it does to the current result.
#[test]
fn each_operator_of_il_has_a_page() {
    use plcc_syntax::il_operators::{INPUT_OPERATORS, OPERATORS};
    let folder = tempfile::tempdir().expect("a folder");
    let names = OPERATORS.iter().map(|o| (o.name, o.does)).chain(INPUT_OPERATORS.iter().map(|o| (o.name, o.of)));
    for (name, text) in names {
        let done = command(Path::new(PLCC), folder.path(), &["explain", name]);
        assert_eq!(done.code, 0, "{name}: {}", done.stderr);
        assert!(done.stdout.contains("Current result: ") && done.stdout.contains(text), "{name}: {}", done.stdout);
    }
    let done = command(Path::new(PLCC), folder.path(), &["explain", "jpmc"]);
    assert!(done.code == 2 && done.stderr.contains("did you mean `JMPC`?"), "{}", done.stderr);
}
