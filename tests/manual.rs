//! The user's manual tells the truth: its examples compile, its mistakes give the messages it says, its tables are what runs.
//!
//! A fenced block of `docs/manual/*.md` is one of
//!
//! ```text
//! st                    checks without any error
//! st error=E0301        gives exactly this message
//! st warning=W0342      the same for a warning or hint: nothing else may be said
//! st run=6              runs 6 cycles of 10 ms (or `interval=1s`) on interpreter and JIT; the next block has the values
//! st fault=E0602        runs, and stops within 10 cycles with this fault, on interpreter and JIT
//! st codesys            in that profile; goes with the others
//! xml                   a PLCopen project; goes with the others
//! trace                 values behind a `run`: one line per variable of Main, one column per cycle
//! text, sh, toml, csv   not checked here: pictures, commands, files
//! ```
//! A source that does not begin with the word of a declaration is the inside of `PROGRAM Main ... END_PROGRAM`. In a `trace` a
//! line `> name` is input; TRUE and FALSE are `#` and `_`, a duration is its number of milliseconds.

use plcc_diag::{Severity, codes};
use plcc_hir::{Profile, specials};
use plcc_stdlib::funcs::{self, StdFn};
use plcc_stdlib::{blocks, elem};
use plcc_tests::compile::diagnose;
use plcc_tests::{command, difference, project_root};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");

fn folder() -> PathBuf {
    project_root().join("docs/manual")
}

/// Name and text of each page.
fn pages() -> Vec<(String, String)> {
    let mut pages: Vec<(String, String)> = std::fs::read_dir(folder())
        .expect("docs/manual")
        .flatten()
        .filter(|e| e.path().extension().is_some_and(|x| x == "md"))
        .map(|e| (e.file_name().display().to_string(), std::fs::read_to_string(e.path()).expect("a page")))
        .collect();
    pages.sort();
    pages
}

/// A fenced block.
struct Block {
    /// `types.md:12`.
    place: String,
    /// What stands behind the opening fence.
    info: Vec<String>,
    text: String,
}

fn blocks_of(page: &str, text: &str) -> Vec<Block> {
    let mut out: Vec<Block> = Vec::new();
    let mut open = false;
    for (n, line) in text.lines().enumerate() {
        if let Some(info) = line.strip_prefix("```") {
            if !open {
                let info = info.split_whitespace().map(str::to_string).collect();
                out.push(Block { place: format!("docs/manual/{page}:{}", n + 1), info, text: String::new() });
            }
            open = !open;
        } else if open && let Some(block) = out.last_mut() {
            block.text.push_str(line);
            block.text.push('\n');
        }
    }
    assert!(!open, "{page}: a fence is not closed");
    out
}

/// What is to be done with a source.
#[derive(Default)]
struct Task {
    codesys: bool,
    error: Option<String>,
    warning: Option<String>,
    fault: Option<String>,
    cycles: Option<usize>,
    interval: String,
}

impl Task {
    fn of(info: &[String]) -> Result<Self, String> {
        let mut task = Task { interval: "10ms".into(), ..Task::default() };
        for word in info {
            match word.split_once('=') {
                None if word == "codesys" => task.codesys = true,
                Some(("error", code)) => task.error = Some(code.into()),
                Some(("warning", code)) => task.warning = Some(code.into()),
                Some(("fault", code)) => task.fault = Some(code.into()),
                Some(("run", cycles)) => task.cycles = Some(cycles.parse().map_err(|e| format!("{word}: {e}"))?),
                Some(("interval", interval)) => task.interval = interval.into(),
                _ => return Err(format!("`{word}` is unknown")),
            }
        }
        Ok(task)
    }

    fn profile(&self) -> Profile {
        if self.codesys { Profile::Codesys } else { Profile::Strict }
    }
}

/// The block as a source file.
fn source(text: &str) -> String {
    let words = ["PROGRAM", "FUNCTION", "FUNCTION_BLOCK", "TYPE", "VAR_GLOBAL", "CONFIGURATION"];
    let code = text.lines().find(|l| !l.trim().is_empty() && !l.starts_with("//")).unwrap_or_default();
    let first = code.split_whitespace().next().unwrap_or_default();
    if words.contains(&first) { text.to_string() } else { format!("PROGRAM Main\n{text}END_PROGRAM\n") }
}

/// The name and the text of the file that a block stands for.
fn file(block: &Block) -> (&'static str, String) {
    match block.info.first().is_some_and(|kind| kind == "xml") {
        true => ("main.xml", block.text.clone()),
        false => ("main.st", source(&block.text)),
    }
}

/// Compiles a block and compares the messages.
fn check(block: &Block, task: &Task) -> Result<(), String> {
    let (_, text) = file(block);
    let (_, diags, sources) = diagnose(&text, task.profile());
    let list = diags.sorted();
    let shown: String =
        list.iter().map(|d| format!("    {}: {}: {}\n", sources.position(d.primary.span), d.code, d.message)).collect();
    let all: Vec<&str> = list.iter().map(|d| d.code.info().code).collect();
    let ok = match (&task.error, &task.warning) {
        (Some(code), _) | (_, Some(code)) => all == [code.as_str()],
        // A few lines of an example leave things unused, and codesys forms warn by their nature.
        _ => !list.iter().any(|d| d.severity() == Severity::Error),
    };
    let right_kind = |code: &Option<String>, want: bool| {
        let is_error = |c: &String| codes::find(c).is_some_and(|i| i.severity == Severity::Error);
        code.as_ref().is_none_or(|c| is_error(c) == want)
    };
    if !ok {
        return Err(format!("the messages are\n{shown}"));
    }
    if !right_kind(&task.error, true) || !right_kind(&task.warning, false) {
        return Err("`error=` or `warning=` does not fit the code".into());
    }
    Ok(())
}

/// A line of a `trace` block.
struct Row {
    name: String,
    input: bool,
    values: Vec<String>,
}

fn rows(text: &str) -> Vec<Row> {
    let line = |line: &str| {
        let (input, line) = match line.strip_prefix('>') {
            Some(rest) => (true, rest),
            None => (false, line),
        };
        let mut words = line.split_whitespace().map(str::to_string);
        let name = words.next()?;
        Some(Row { name, input, values: words.collect() })
    };
    text.lines().filter_map(line).filter(|r| r.name != "cycle").collect()
}

/// A value of the manual for a value of the trace: as short as it is there.
fn short(value: &str) -> String {
    match value {
        "TRUE" => "#".into(),
        "FALSE" => "_".into(),
        _ => match value.strip_prefix("T#").map(plcc_stdlib::literal::duration) {
            Some(Ok(ns)) if ns % 1_000_000 == 0 => (ns / 1_000_000).to_string(),
            _ => value.to_string(),
        },
    }
}

/// Runs a block on both engines of plcc and compares the rows.
fn run(block: &Block, task: &Task, cycles: usize, trace: &str) -> Result<(), String> {
    let rows = rows(trace);
    if rows.is_empty() {
        return Err("the trace is empty".into());
    }
    if let Some(row) = rows.iter().find(|r| r.values.len() != cycles) {
        return Err(format!("{} has {} values for {cycles} cycles", row.name, row.values.len()));
    }
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let (name, text) = file(block);
    std::fs::write(folder.path().join(name), text).map_err(|e| e.to_string())?;
    let inputs: Vec<&Row> = rows.iter().filter(|r| r.input).collect();
    let mut stimulus = format!("cycle{}\n", inputs.iter().map(|r| format!(",Main.{}", r.name)).collect::<String>());
    for n in 0..cycles {
        let long = |v: &str| match v {
            "#" => "TRUE".to_string(),
            "_" => "FALSE".to_string(),
            other => other.to_string(),
        };
        let values: String = inputs.iter().map(|r| format!(",{}", long(&r.values[n]))).collect();
        stimulus.push_str(&format!("{}{values}\n", n + 1));
    }
    std::fs::write(folder.path().join("in.csv"), stimulus).map_err(|e| e.to_string())?;
    let watch: Vec<String> = rows.iter().map(|r| format!("Main.{}", r.name)).collect();
    for engine in ["interp", "jit"] {
        let (watch, cycles) = (watch.join(","), cycles.to_string());
        let mut args = vec!["run", name, "--engine", engine, "--virtual-time", "--interval", &task.interval];
        args.extend(["--cycles", &cycles, "--watch", &watch, "--trace", "-"]);
        if !inputs.is_empty() {
            args.extend(["--stimulus", "in.csv"]);
        }
        if task.codesys {
            args.extend(["--profile", "codesys"]);
        }
        let done = command(Path::new(PLCC), folder.path(), &args);
        if done.code != 0 {
            return Err(format!("{engine}: exit code {}\n{}", done.code, done.stderr));
        }
        for (n, line) in done.stdout.lines().skip(1).enumerate() {
            for (row, value) in rows.iter().zip(line.split(',').skip(1)) {
                let want = &row.values[n];
                if *want != short(value) && want != value {
                    return Err(format!("{engine}, cycle {}: {} is {value}, not {want}", n + 1, row.name));
                }
            }
        }
    }
    Ok(())
}

/// Runs a block that stops with a fault.
fn stops(block: &Block, task: &Task, code: &str) -> Result<(), String> {
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let (name, text) = file(block);
    std::fs::write(folder.path().join(name), text).map_err(|e| e.to_string())?;
    for engine in ["interp", "jit"] {
        let mut args = vec!["run", name, "--engine", engine, "--virtual-time", "--cycles", "10"];
        if task.codesys {
            args.extend(["--profile", "codesys"]);
        }
        let done = command(Path::new(PLCC), folder.path(), &args);
        if done.code != 1 || !done.stderr.contains(&format!("error[{code}]")) {
            return Err(format!("{engine}: exit code {}\n{}", done.code, done.stderr));
        }
    }
    Ok(())
}

/// All blocks of a page.
fn judge(page: &str, text: &str) -> Vec<String> {
    let all = blocks_of(page, text);
    let mut wrong = Vec::new();
    let mut n = 0;
    while n < all.len() {
        let block = &all[n];
        n += 1;
        let result = match block.info.split_first().map(|(kind, rest)| (kind.as_str(), rest)) {
            Some(("st" | "xml", rest)) => Task::of(rest).and_then(|task| {
                check(block, &task)?;
                if let Some(code) = &task.fault {
                    return stops(block, &task, code);
                }
                let Some(cycles) = task.cycles else { return Ok(()) };
                let trace = all.get(n).filter(|b| b.info == ["trace"]).ok_or("a `trace` must follow")?;
                n += 1;
                run(block, &task, cycles, &trace.text)
            }),
            Some(("text" | "sh" | "toml" | "csv", [])) => Ok(()),
            Some(("trace", _)) => Err("no `run=` before this trace".into()),
            _ => Err("a block of an unknown kind".into()),
        };
        if let Err(message) = result {
            wrong.push(format!("{}: {message}", block.place));
        }
    }
    wrong
}

#[test]
fn the_examples_do_what_the_manual_says() {
    let pages = pages();
    assert!(pages.len() > 10, "{} pages", pages.len());
    let wrong: Vec<String> = pages.iter().flat_map(|(name, text)| judge(name, text)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Links lead somewhere, codes exist, each page is in the table of contents.
#[test]
fn links_and_codes_exist() {
    let mut wrong = Vec::new();
    let pages = pages();
    let contents = &pages.iter().find(|(n, _)| n == "README.md").expect("a table of contents").1;
    for (name, text) in &pages {
        if name != "README.md" && !contents.contains(&format!("]({name})")) {
            wrong.push(format!("README.md does not link to {name}"));
        }
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let path = link.split('#').next().unwrap_or_default();
            if !link.contains("://") && !folder().join(path).exists() {
                wrong.push(format!("{name}: {link} does not exist"));
            }
        }
        let words = text.split(|c: char| !c.is_ascii_alphanumeric());
        for word in words.filter(|w| w.len() == 5 && ["E0", "W0", "H0"].contains(&&w[..2])) {
            if word[1..].bytes().all(|b| b.is_ascii_digit()) && codes::find(word).is_none() {
                wrong.push(format!("{name}: there is no code {word}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn update() -> bool {
    std::env::var_os("UPDATE").is_some_and(|v| v == "1")
}

/// Compares a page that is made from the tables of plcc with the one that is committed; `UPDATE=1` writes it.
fn judge_generated(name: &str, page: &str) {
    let path = folder().join(name);
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    if update() && committed != page {
        std::fs::write(&path, page).expect("the page is written");
        return;
    }
    if let Some(diff) = difference(&committed, page) {
        panic!("docs/manual/{name} is not what plcc's tables say; UPDATE=1 writes it\n{diff}");
    }
}

#[test]
fn the_list_of_functions_is_that_of_the_compiler() {
    let mut page = String::from(
        "# List of standard functions\n\n\
         This page is made from the compiler's own table. `plcc explain NAME` prints a row. What the functions have in common stands\n\
         in [Standard functions](functions.md), what conversions do in [Conversions](conversions.md).\n",
    );
    let mut by_clause: BTreeMap<&str, Vec<&StdFn>> = BTreeMap::new();
    for row in funcs::names().filter_map(funcs::find).filter(|f| f.bound.is_none() && !is_conversion(&f.name)) {
        by_clause.entry(row.clause).or_default().push(row);
    }
    for (clause, mut rows) in by_clause {
        rows.sort_by(|a, b| a.name.cmp(&b.name));
        page.push_str(&format!("\n## {clause}\n\n| function | gives |\n|---|---|\n"));
        rows.iter().for_each(|f| page.push_str(&format!("| `{}` | {} |\n", f.signature(), f.doc)));
    }
    page.push_str("\n## Functions of variables and types\n\n| function | gives |\n|---|---|\n");
    specials::SPECIALS.iter().for_each(|row| page.push_str(&format!("| `{}` | {} |\n", row.signature, row.doc)));
    page.push_str(&conversions());
    judge_generated("functions_list.md", &page);
}

/// `INT_TO_REAL`, `TO_INT`, `TRUNC_INT`, but not `TO_BIG_ENDIAN`.
fn is_conversion(name: &str) -> bool {
    let word = |w| name.starts_with(w) || name.contains(&format!("_{w}"));
    (word("TO_") || word("TRUNC_")) && !name.ends_with("_ENDIAN")
}

/// Which `A_TO_B` there are.
fn conversions() -> String {
    let names: Vec<&str> = elem::ALL.iter().map(|e| e.name()).chain(["STRING", "WSTRING"]).collect();
    let mut out = String::from(
        "\n## Conversions\n\nThe function `A_TO_B` exists where the line of A has a mark below B; `TO_B` takes all of them.\n\n| A |",
    );
    names.iter().for_each(|n| out.push_str(&format!(" {n} |")));
    out.push_str(&format!("\n|---|{}\n", "---|".repeat(names.len())));
    for from in &names {
        out.push_str(&format!("| **{from}** |"));
        for to in &names {
            let mark = if funcs::find(&format!("{from}_TO_{to}")).is_some() { "x" } else { " " };
            out.push_str(&format!(" {mark} |"));
        }
        out.push('\n');
    }
    let others = |part: &str| {
        let mut names: Vec<&str> = funcs::names().filter(|n| n.contains(part) && is_conversion(n)).collect();
        names.sort_unstable();
        names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ")
    };
    out.push_str(&format!("\nTruncation: {}.\n\nBCD: {}.\n", others("TRUNC_"), others("BCD_")));
    out
}

#[test]
fn the_list_of_blocks_is_that_of_the_compiler() {
    let mut page = String::from(
        "# List of standard function blocks\n\n\
         This page is made from the compiler's own texts. `plcc explain NAME` prints the whole block in ST. What they do in time stands\n\
         in [Standard function blocks](blocks.md).\n\n| block | inputs | outputs |\n|---|---|---|\n",
    );
    // Those with `$` in their names serve the compiler.
    let public =
        blocks::blocks().iter().filter(|(name, _)| name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_'));
    for (name, text) in public.filter(|(n, _)| *n != "ACTION_CONTROL") {
        page.push_str(&format!("| `{name}` | {} | {} |\n", section(text, "VAR_INPUT"), section(text, "VAR_OUTPUT")));
    }
    judge_generated("blocks_list.md", &page);
}

/// The declarations of a section on one line.
fn section(text: &str, word: &str) -> String {
    let body = text.split(word).nth(1).and_then(|rest| rest.split("END_VAR").next()).unwrap_or_default();
    let declarations = body.lines().filter_map(|l| l.split(';').next()).map(str::trim).filter(|l| l.contains(':'));
    declarations.map(|d| format!("`{d}`")).collect::<Vec<_>>().join(", ")
}

#[test]
fn the_list_of_messages_is_that_of_the_compiler() {
    let mut page = String::from(
        "# List of messages\n\n\
         This page is made from the compiler's own table. `plcc explain CODE` prints what a message means, an example and what to do.\n\
         E is an error, W a warning, H a hint. How messages are read stands in [Messages](diagnostics.md).\n\n\
         | code | means |\n|---|---|\n",
    );
    let mut all: Vec<_> = codes::all().map(|c| c.info()).collect();
    all.sort_by_key(|i| (i.code[1..].to_string(), i.code));
    all.iter().for_each(|i| page.push_str(&format!("| {} | {} |\n", i.code, i.title)));
    judge_generated("diagnostics_list.md", &page);
}
