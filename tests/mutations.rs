//! Damaged programs: the sources of all cases and examples with words removed, doubled, moved and exchanged between them.
//! None may make the parser, the checker or the lowering panic or hang; what still compiles must pass the verifier. PLCopen XML is
//! damaged by elements and attributes, so that most of it stays well-formed.
//!
//! `MUTATIONS=1000000 cargo test --release -p plcc-tests --test mutations` is the long run; `MUTATION_SEED` is the first seed. A
//! failure names its seed: `MUTATIONS=1 MUTATION_SEED=n` repeats it and prints the source.

use fastrand::Rng;
use plcc_hir::Profile;
use plcc_tests::compile::{diagnose, lower};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// More than any of these small sources needs, on a busy machine too.
const LIMIT: Duration = Duration::from_secs(20);
/// The stack that the driver gives to its pipeline.
const STACK_BYTES: usize = 512 << 20;

fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}

fn sources(folder: &Path, extension: &str, out: &mut Vec<String>) {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut paths: Vec<_> = entries.map(|e| e.expect("an entry").path()).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            sources(&path, extension, out);
        } else if path.extension().is_some_and(|e| e == extension) {
            out.push(std::fs::read_to_string(&path).unwrap_or_default());
        }
    }
}

/// Pieces between which a source is cut: words, and the signs between them.
fn words(text: &str) -> Vec<&str> {
    text.split_inclusive(|c: char| !c.is_alphanumeric() && c != '_').collect()
}

/// Signs and words that a random place seldom has.
const RARE: [&str; 24] = [
    "(* ",
    "*) ",
    "' ",
    "\" ",
    "END_IF ",
    "END_VAR ",
    "^ ",
    "[",
    "] ",
    "( ",
    ") ",
    ":= ",
    "=> ",
    "..",
    "# ",
    "% ",
    "{",
    "} ",
    "9223372036854775808 ",
    "-1 ",
    "T#1d ",
    "REF_TO ",
    "ARRAY [*] OF ",
    "NULL ",
];

/// One to six changes, with pieces of another source.
fn damage(rng: &mut Rng, text: &str, other: &str) -> String {
    let (mut list, others) = (words(text), words(other));
    for _ in 0..rng.usize(1..=6) {
        let (a, b) = (rng.usize(..list.len().max(1)), rng.usize(..list.len().max(1)));
        if list.is_empty() {
            break;
        }
        match rng.u8(..8) {
            0 => drop(list.remove(a)),
            1 => list.insert(a, list[b]),
            2 => list.swap(a, b),
            3 => list[a] = list[b],
            4 => {
                let from = rng.usize(..others.len().max(1));
                let piece = &others[from.min(others.len())..(from + rng.usize(1..12)).min(others.len())];
                list.splice(a..a, piece.iter().copied());
            }
            5 => {
                let end = (a + rng.usize(1..20)).min(list.len());
                list.drain(a..end);
            }
            6 => list.insert(a, RARE[rng.usize(..RARE.len())]),
            _ => {
                if let Some(word) = others.get(rng.usize(..others.len().max(1))) {
                    list[a] = word;
                }
            }
        }
    }
    list.concat()
}

/// Why a source is no good test of robustness any more: the compiler broke on it.
fn problem(text: &str, profile: Profile) -> Option<String> {
    let start = Instant::now();
    let result = catch_unwind(AssertUnwindSafe(|| match diagnose(text, profile) {
        (_, diags, _) if diags.has_errors() => Ok(()),
        (checked, ..) => lower(&checked).map(drop),
    }));
    let time = start.elapsed();
    match result {
        Err(panic) => {
            let said = panic.downcast_ref::<String>().cloned();
            let said = said.or_else(|| panic.downcast_ref::<&str>().map(|s| s.to_string()));
            Some(format!("panic: {}", said.unwrap_or_default()))
        }
        Ok(Err(e)) if e.starts_with("verifier") => Some(e),
        Ok(_) if time > LIMIT => Some(format!("took {time:?}")),
        Ok(_) => None,
    }
}

#[test]
fn no_damage_breaks_the_compiler() {
    let mut corpus = Vec::new();
    let tests = plcc_tests::root();
    sources(&tests.join("cases"), "st", &mut corpus);
    sources(&plcc_tests::project_root().join("examples"), "st", &mut corpus);
    assert!(corpus.len() > 100);
    run(&corpus, damage);
}

#[test]
fn no_damaged_drawing_breaks_the_compiler() {
    let mut corpus = Vec::new();
    sources(&plcc_tests::root().join("cases"), "xml", &mut corpus);
    sources(&plcc_tests::project_root().join("examples"), "xml", &mut corpus);
    assert!(corpus.len() > 30);
    run(&corpus, damage_xml);
}

/// Elements of a drawing that stand on one line, and the values of attributes: where they begin and end.
fn pieces(text: &str, elements: bool) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    if elements {
        let mut at = 0;
        for line in text.split_inclusive('\n') {
            let inner = line.trim();
            // Self-contained lines only: what they begin they close.
            if inner.starts_with('<')
                && inner.matches("</").count() + inner.matches("/>").count()
                    == inner.matches('<').count() - inner.matches("</").count()
            {
                found.push((at, at + line.len()));
            }
            at += line.len();
        }
        let mut from = 0;
        while let Some(start) = text[from..].find("<connection ").map(|n| from + n) {
            let end = text[start..].find("/>").map_or(text.len(), |n| start + n + 2);
            found.push((start, end));
            from = end;
        }
    } else {
        let mut from = 0;
        while let Some(start) = text[from..].find("=\"").map(|n| from + n + 2) {
            let end = text[start..].find('"').map_or(text.len(), |n| start + n);
            found.push((start, end));
            from = end;
        }
        let mut from = 0;
        while let Some(start) = text[from..].find("<expression>").map(|n| from + n + 12) {
            let end = text[start..].find('<').map_or(text.len(), |n| start + n);
            found.push((start, end));
            from = end;
        }
    }
    found
}

/// One to four changes of a PLCopen XML file: elements removed, doubled, moved, values exchanged.
fn damage_xml(rng: &mut Rng, text: &str, other: &str) -> String {
    let mut text = text.to_string();
    for _ in 0..rng.usize(1..=4) {
        let elements = rng.bool();
        let (own, others) = (pieces(&text, elements), pieces(other, elements));
        if own.is_empty() || others.is_empty() {
            break;
        }
        let (start, end) = own[rng.usize(..own.len())];
        let (from, to) = own[rng.usize(..own.len())];
        let (far, far_end) = others[rng.usize(..others.len())];
        match rng.u8(..5) {
            0 if elements => text.replace_range(start..end, ""),
            1 => {
                let piece = text[from..to].to_string();
                text.replace_range(start..if elements { start } else { end }, &piece);
            }
            2 => text.replace_range(start..if elements { start } else { end }, &other[far..far_end]),
            3 if !elements => text.replace_range(start..end, RARE[rng.usize(..RARE.len())].trim_matches(['"', '<'])),
            _ => {
                let number = rng.usize(0..40).to_string();
                if !elements {
                    text.replace_range(start..end, &number);
                }
            }
        }
    }
    text
}

fn run(corpus: &[String], damage: fn(&mut Rng, &str, &str) -> String) {
    let (count, first) = (number("MUTATIONS", 1500), number("MUTATION_SEED", 1));
    let next = AtomicU64::new(first);
    let work = || {
        let mut failures = Vec::new();
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= first + count {
                return failures;
            }
            let mut rng = Rng::with_seed(seed);
            let (a, b) = (rng.usize(..corpus.len()), rng.usize(..corpus.len()));
            let text = damage(&mut rng, &corpus[a], &corpus[b]);
            let profile = if rng.bool() { Profile::Codesys } else { Profile::Strict };
            if let Some(why) = problem(&text, profile) {
                failures.push((seed, why, text));
            }
        }
    };
    let failures: Vec<_> = std::thread::scope(|scope| {
        let spawn =
            |_| std::thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, work).expect("a thread");
        let threads: Vec<_> = (0..2).map(spawn).collect();
        threads.into_iter().flat_map(|t| t.join().expect("a worker")).collect()
    });
    for (seed, why, text) in failures.iter().take(10) {
        println!("seed {seed}: {why}");
        if count <= 10 {
            println!("{text}");
        }
    }
    assert!(failures.is_empty(), "{} of {count} damaged sources broke the compiler", failures.len());
}
