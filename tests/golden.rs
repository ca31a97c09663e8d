//! The golden tests: a case is a source file below `cases/`, what is checked follows from its siblings.
//!
//! ```text
//! name.st          the source; first lines may hold directives:
//!                    //! run: --cycles 6 --interval 10ms --watch Main.x
//!                    //! profile: codesys
//!                    //! exit: 1                 (of the run; 0 is the default)
//!                    //! graph: --cycle 3        (further flags of the drawing)
//! name.stim.csv    the stimulus of the run
//! name.trace.csv   the trace: on the interpreter, in the JIT and of the linked program, all against this one file
//! name.err         standard error of the run, the same in all three
//! name.diag        what `plcc check` prints
//! name.hir, .mir, .ast, .tokens   the print of that stage
//! name.svg         what `plcc graph --sfc` draws
//! ```
//! A source may be PLCopen XML: `name.xml`, with its directives in a processing instruction behind the first line. `name.st` beside it is its
//! twin: the same program in text, whose trace must be the same file.
//! `UPDATE=1` rewrites what exists and makes a missing trace or diag; read it before you commit it.

use libtest_mimic::{Arguments, Failed, Trial};
use plcc_tests::{Done, command, difference, root};
use std::path::{Path, PathBuf};

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");

fn main() {
    let args = Arguments::from_args();
    let cases = root().join("cases");
    let mut sources = Vec::new();
    collect(&cases, &mut sources);
    sources.sort();
    let trials = sources
        .into_iter()
        .map(|path| {
            let name = path.strip_prefix(&cases).unwrap_or(&path);
            // An XML case and its twin in text share their name and their trace.
            let name = if is_xml(&path) { name.to_path_buf() } else { name.with_extension("") };
            let name = name.display().to_string();
            Trial::test(name, move || Case::read(&path).run())
        })
        .collect();
    libtest_mimic::run(&args, trials).exit();
}

fn collect(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            collect(&path, out);
        } else if path.extension().is_some_and(|e| ["st", "il", "sfc", "xml"].iter().any(|x| e == *x)) {
            out.push(path);
        }
    }
}

fn is_xml(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "xml")
}

struct Case {
    /// The source.
    path: PathBuf,
    /// Relative to `cases`, as plcc sees it.
    name: String,
    run: Option<Vec<String>>,
    profile: Option<String>,
    graph: Vec<String>,
    exit: i32,
}

impl Case {
    fn read(path: &Path) -> Self {
        let cases = root().join("cases");
        let mut case = Case {
            path: path.to_path_buf(),
            name: path.strip_prefix(&cases).unwrap_or(path).display().to_string(),
            run: None,
            profile: None,
            graph: Vec::new(),
            exit: 0,
        };
        let bytes = std::fs::read(path).unwrap_or_default();
        // In XML they stand in a processing instruction behind the first line.
        let skipped = if is_xml(path) { 2 } else { 0 };
        for line in String::from_utf8_lossy(&bytes).lines().skip(skipped).take_while(|l| l.starts_with("//!")) {
            let Some((key, value)) = line[3..].trim().split_once(':') else { continue };
            let value = value.trim();
            match key.trim() {
                "run" => case.run = Some(value.split_whitespace().map(str::to_string).collect()),
                "profile" => case.profile = Some(value.to_string()),
                "graph" => case.graph = value.split_whitespace().map(str::to_string).collect(),
                "exit" => case.exit = value.parse().unwrap_or(0),
                other => panic!("{}: unknown directive `{other}`", path.display()),
            }
        }
        case
    }

    fn sibling(&self, extension: &str) -> PathBuf {
        self.path.with_extension(extension)
    }

    fn plcc(&self, args: &[&str]) -> Done {
        command(Path::new(PLCC), &root().join("cases"), args)
    }

    fn with_profile<'a>(&'a self, mut args: Vec<&'a str>) -> Vec<&'a str> {
        if let Some(profile) = &self.profile {
            args.extend(["--profile", profile]);
        }
        args
    }

    fn run(&self) -> Result<(), Failed> {
        let mut checked = false;
        if self.run.is_some() {
            self.traces()?;
            checked = true;
        }
        // What is printed belongs to one of two twins: to the XML.
        let twin = !is_xml(&self.path) && self.sibling("xml").exists();
        if twin {
            return if checked { Ok(()) } else { Err("a twin has a run directive".into()) };
        }
        if self.sibling("diag").exists() || (self.run.is_none() && update() && self.no_stage()) {
            let done = self.plcc(&self.with_profile(vec!["check", &self.name]));
            self.compare("diag", &done.stderr)?;
            checked = true;
        }
        for stage in ["tokens", "ast", "hir", "mir"] {
            if self.sibling(stage).exists() {
                // The lowering is what such a case shows; the optimiser has its own tests.
                let done = self.plcc(&self.with_profile(vec!["build", &self.name, "--emit", stage, "--opt", "none"]));
                self.compare(stage, &done.stdout)?;
                checked = true;
            }
        }
        if self.sibling("svg").exists() || (!self.graph.is_empty() && update()) {
            let flags = self.graph.iter().map(String::as_str);
            let args = ["graph", &self.name, "--sfc"].into_iter().chain(flags).collect();
            let done = self.plcc(&self.with_profile(args));
            if done.code != 0 {
                return Err(format!("graph: exit code {}\n{}", done.code, done.stderr).into());
            }
            self.compare("svg", &done.stdout)?;
            checked = true;
        }
        if checked { Ok(()) } else { Err("nothing is checked: no run directive, no .diag, no stage, no .svg".into()) }
    }

    fn no_stage(&self) -> bool {
        !["tokens", "ast", "hir", "mir"].iter().any(|s| self.sibling(s).exists())
    }

    fn traces(&self) -> Result<(), Failed> {
        let stimulus = self.sibling("stim.csv");
        let mut flags: Vec<String> = self.run.clone().unwrap_or_default();
        flags.push("--virtual-time".into());
        flags.extend(["--trace".into(), "-".into()]);
        if stimulus.exists() {
            flags.extend(["--stimulus".into(), stimulus.display().to_string()]);
        }
        let flags: Vec<&str> = flags.iter().map(String::as_str).collect();
        for engine in ["interp", "jit"] {
            let args = self.with_profile(vec!["run", &self.name, "--engine", engine, "--message-format", "short"]);
            let done = self.plcc(&[args, flags.clone()].concat());
            self.judge(engine, done)?;
        }
        let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
        let app = folder.path().join("app");
        let app_text = app.display().to_string();
        let done = self.plcc(&self.with_profile(vec!["build", &self.name, "-o", &app_text]));
        if !app.exists() {
            return Err(format!("build failed:\n{}", done.stderr).into());
        }
        self.judge("linked", command(&app, &root().join("cases"), &flags))
    }

    /// One engine's run against the expected trace, standard error and exit code.
    fn judge(&self, engine: &str, done: Done) -> Result<(), Failed> {
        let say = |e: Failed| Failed::from(format!("{engine}: {}", e.message().unwrap_or_default()));
        // A run prints its messages after those of the compiler, which the linked program does not have.
        let first = ["error[E06", "warning[W06"].iter().filter_map(|m| done.stderr.find(m)).min();
        let faults = first.map_or("", |at| &done.stderr[at..]).to_string();
        if done.code != self.exit {
            return Err(format!("{engine}: exit code {} instead of {}\n{}", done.code, self.exit, done.stderr).into());
        }
        self.compare("trace.csv", &done.stdout).map_err(say)?;
        if self.exit == 1 || self.sibling("err").exists() {
            self.compare("err", &faults).map_err(say)?;
        }
        Ok(())
    }

    fn compare(&self, extension: &str, got: &str) -> Result<(), Failed> {
        let path = self.sibling(extension);
        let expected = std::fs::read_to_string(&path).unwrap_or_default();
        if update() && expected != got {
            std::fs::write(&path, got).map_err(|e| e.to_string())?;
            return Ok(());
        }
        if !path.exists() {
            return Err(format!("{} is missing; got:\n{got}", path.display()).into());
        }
        match difference(&expected, got) {
            None => Ok(()),
            Some(diff) => Err(format!("{} differs:\n{diff}", path.display()).into()),
        }
    }
}

fn update() -> bool {
    std::env::var_os("UPDATE").is_some_and(|v| v == "1")
}
