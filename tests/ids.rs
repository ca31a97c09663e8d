//! Every id of docs/semantics.md has a golden case that names it, `[F8]`, in its first lines, and a place in the user's manual.

use plcc_tests::{project_root, root};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Lines of a case in which it says what it is about.
const FIRST_LINES: usize = 12;

/// Ids that a golden case cannot show, with the test that does and names them.
const ELSEWHERE: &[(&str, &str)] = &[
    // `--checks` belongs to the compiler, a case has run flags only.
    ("E6", "tests/command_line.rs"),
];

/// Ids whose feature is not built yet, with the issue that builds it. An id that gets a case leaves this list.
const NOT_BUILT: &[(&str, &str)] = &[];

/// Ids in a text, `[T1]`.
fn ids_in(text: &str) -> BTreeSet<String> {
    let inside = text.split('[').skip(1).filter_map(|rest| rest.split(']').next());
    inside.filter(|id| is_id(id)).map(str::to_string).collect()
}

fn is_id(text: &str) -> bool {
    let (letter, number) = text.split_at_checked(1).unwrap_or_default();
    letter.bytes().all(|b| b.is_ascii_uppercase())
        && !number.is_empty()
        && number.len() < 3
        && number.bytes().all(|b| b.is_ascii_digit())
}

/// The ids that semantics.md gives: each begins an item.
fn defined() -> BTreeSet<String> {
    let text = std::fs::read_to_string(project_root().join("docs/semantics.md")).expect("semantics.md");
    let items = text.lines().filter_map(|l| l.strip_prefix("- [")?.split(']').next());
    items.filter(|id| is_id(id)).map(str::to_string).collect()
}

/// Ids by what names them, for all files with one of these extensions below a folder.
fn named(folder: &Path, extensions: &[&str], lines: usize, out: &mut BTreeMap<String, String>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            named(&path, extensions, lines, out);
        } else if path.extension().is_some_and(|e| extensions.iter().any(|x| e == *x)) {
            let bytes = std::fs::read(&path).unwrap_or_default();
            let text = String::from_utf8_lossy(&bytes);
            let first: String = text.lines().take(lines).map(|l| format!("{l}\n")).collect();
            out.extend(ids_in(&first).into_iter().map(|id| (id, path.display().to_string())));
        }
    }
}

fn cases() -> BTreeMap<String, String> {
    let mut out = BTreeMap::new();
    named(&root().join("cases"), &["st", "il", "sfc", "xml"], FIRST_LINES, &mut out);
    out
}

fn not_built(id: &str) -> bool {
    NOT_BUILT.iter().any(|(n, _)| *n == id)
}

#[test]
fn each_id_has_a_golden_case() {
    let (defined, cases) = (defined(), cases());
    assert!(defined.len() > 50, "{defined:?}");
    let mut wrong = Vec::new();
    for id in &defined {
        let elsewhere = ELSEWHERE.iter().find(|(n, _)| n == id);
        if let Some((_, file)) = elsewhere {
            let text = std::fs::read_to_string(project_root().join(file)).unwrap_or_default();
            if !ids_in(&text).contains(id) {
                wrong.push(format!("{file} does not name [{id}]"));
            }
        }
        match (cases.get(id), not_built(id)) {
            (None, false) if elsewhere.is_none() => wrong.push(format!("[{id}] has no golden case")),
            (Some(case), true) => wrong.push(format!("[{id}] has a case, {case}: take it off NOT_BUILT")),
            _ => {}
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn each_id_stands_in_the_manual() {
    let mut manual = BTreeMap::new();
    named(&project_root().join("docs/manual"), &["md"], usize::MAX, &mut manual);
    let missing: Vec<String> = defined().into_iter().filter(|id| !not_built(id) && !manual.contains_key(id)).collect();
    assert!(missing.is_empty(), "no page of docs/manual names {missing:?}");
}

/// No list and no comment names an id that semantics.md does not have.
#[test]
fn only_defined_ids_are_named() {
    let defined = defined();
    let mut wrong = Vec::new();
    let mut named_ids = cases();
    named(&project_root().join("docs/manual"), &["md"], usize::MAX, &mut named_ids);
    for (id, file) in named_ids {
        if !defined.contains(&id) {
            wrong.push(format!("{file} names [{id}]"));
        }
    }
    for (id, _) in ELSEWHERE.iter().chain(NOT_BUILT) {
        if !defined.contains(*id) {
            wrong.push(format!("a list in this test names [{id}]"));
        }
    }
    assert!(wrong.is_empty(), "semantics.md does not have:\n{}", wrong.join("\n"));
}
