//! Which sources there are and how they are read: files, folders, globs, project.toml.

use crate::cli::{ProfileArg, SourceArgs};
use crate::failure::Failure;
use plcc_hir::app::Resource;
use plcc_hir::{Profile, Selection, TaskSelection};
use plcc_runtime::image::{Defaults, Task};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Extensions of text sources.
const TEXT: [&str; 5] = ["st", "il", "sfc", "iec", "txt"];

/// Everything that the command line and project.toml say.
#[derive(Debug, Default)]
pub struct Project {
    /// The sources in order, each once.
    pub sources: Vec<(PathBuf, Profile)>,
    /// What is to run.
    pub selection: Selection,
    /// `[project] name`, or the first file's stem.
    pub name: String,
    /// `[build]`.
    pub build: Build,
    /// `[io.safe_state]`: address or variable, and its literal.
    pub safe_state: Vec<(String, String)>,
    /// `[retain] file`.
    pub retain_file: Option<PathBuf>,
    /// What the program does where no flag says it: `[runtime]`, `[io] driver`, `[retain] flush`.
    pub defaults: Defaults,
    /// `[runtime]` watchdog and deadline of all tasks.
    pub all_tasks: TaskTimes,
    /// `[runtime.tasks.NAME]`.
    pub by_task: Vec<(String, TaskTimes)>,
}

/// Longest execution and reaction time of a task, nanoseconds.
#[derive(Debug, Clone, Copy, Default)]
pub struct TaskTimes {
    watchdog_ns: Option<i64>,
    deadline_ns: Option<i64>,
}

impl Project {
    /// What `[runtime]` says of a task: watchdog and deadline, nanoseconds.
    pub fn of_task(&self, resource: &str, task: &str) -> (Option<i64>, Option<i64>) {
        let long = format!("{resource}.{task}");
        let is = |name: &str| name.eq_ignore_ascii_case(task) || name.eq_ignore_ascii_case(&long);
        let own = self.by_task.iter().find(|(name, _)| is(name)).map_or_else(TaskTimes::default, |(_, times)| *times);
        (own.watchdog_ns.or(self.all_tasks.watchdog_ns), own.deadline_ns.or(self.all_tasks.deadline_ns))
    }

    /// Whether `[runtime.tasks]` names tasks that exist.
    pub fn check_tasks(&self, tasks: &[Task], resources: &[Resource]) -> Result<(), Failure> {
        let long = |t: &Task| format!("{}.{}", resources[t.resource as usize].name, t.name);
        for (name, _) in &self.by_task {
            if !tasks.iter().any(|t| name.eq_ignore_ascii_case(&t.name) || name.eq_ignore_ascii_case(&long(t))) {
                let hint = plcc_hir::similar(name, tasks.iter().map(|t| t.name.as_str()));
                let hint = hint.map(|h| format!("; did you mean `{h}`?")).unwrap_or_default();
                return Err(Failure::usage(format!("[runtime.tasks.{name}]: there is no task `{name}`{hint}")));
            }
        }
        Ok(())
    }
}

/// `[build]`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Build {
    /// Target triple.
    pub target: Option<String>,
    /// Name of the executable.
    pub output: Option<PathBuf>,
    /// Safety checks.
    pub checks: Option<ChecksTable>,
}

/// `checks = { index = true, ... }`.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct ChecksTable {
    pub index: Option<bool>,
    pub division: Option<bool>,
    pub subrange: Option<bool>,
    pub pointer: Option<bool>,
    pub deadline: Option<bool>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    project: Section,
    #[serde(default)]
    libraries: BTreeMap<String, Library>,
    #[serde(default)]
    build: Build,
    #[serde(default)]
    tasks: toml::Table,
    #[serde(default)]
    retain: Retain,
    #[serde(default)]
    io: Io,
    #[serde(default)]
    runtime: Runtime,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Runtime {
    on_fault: Option<OnFaultArg>,
    watchdog: Option<String>,
    deadline: Option<String>,
    #[serde(default)]
    tasks: BTreeMap<String, RuntimeTask>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum OnFaultArg {
    Stop,
    RestartTask,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct RuntimeTask {
    watchdog: Option<String>,
    deadline: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Section {
    name: String,
    #[serde(default)]
    #[allow(dead_code)]
    version: Option<String>,
    sources: Vec<String>,
    #[serde(default)]
    profile: Option<ProfileArg>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Library {
    path: PathBuf,
    #[serde(default)]
    profile: Option<ProfileArg>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Retain {
    file: Option<PathBuf>,
    flush: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Io {
    driver: Option<String>,
    #[serde(default)]
    safe_state: BTreeMap<String, String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TaskTable {
    interval: Option<String>,
    #[serde(default)]
    priority: u32,
    watchdog: Option<String>,
    deadline: Option<String>,
    programs: Vec<String>,
}

fn profile(arg: Option<ProfileArg>) -> Profile {
    match arg {
        Some(ProfileArg::Codesys) => Profile::Codesys,
        _ => Profile::Strict,
    }
}

/// Reads what the command line names.
pub fn load(args: &SourceArgs) -> Result<Project, Failure> {
    let mut project = match args.files.as_slice() {
        [one] if one.ends_with(".toml") => from_file(Path::new(one), args.profile)?,
        files => {
            let mut project = Project::default();
            for file in files {
                if file.ends_with(".toml") {
                    return Err(Failure::usage("give either one project.toml or source files, not both"));
                }
                add_sources(&mut project, Path::new(""), file, profile(args.profile))?;
            }
            project.name = project
                .sources
                .first()
                .and_then(|(p, _)| p.file_stem())
                .map_or("app".into(), |s| s.to_string_lossy().into_owned());
            project
        }
    };
    if let Some(program) = &args.program {
        if !project.selection.tasks.is_empty() {
            return Err(Failure::usage("--program cannot be combined with [tasks] of project.toml"));
        }
        project.selection.program = Some(program.clone());
    }
    Ok(project)
}

fn from_file(path: &Path, flag: Option<ProfileArg>) -> Result<Project, Failure> {
    let text = std::fs::read_to_string(path).map_err(|e| Failure::io("read", path, e))?;
    let file: File = toml::from_str(&text).map_err(|e| bad_toml(path, &e))?;
    let root = path.parent().map(Path::to_path_buf).unwrap_or_default();
    let mut project = Project { name: file.project.name, build: file.build, ..Project::default() };
    for pattern in &file.project.sources {
        // The flag speaks of the user's sources; a library keeps the profile it was written for.
        add_sources(&mut project, &root, pattern, profile(flag.or(file.project.profile)))?;
    }
    for (name, library) in &file.libraries {
        let folder = root.join(&library.path);
        if !folder.exists() {
            return Err(Failure::device(format!("library `{name}`: there is no `{}`", folder.display())));
        }
        add_sources(&mut project, &root, &library.path.to_string_lossy(), profile(library.profile))?;
    }
    for (name, table) in file.tasks {
        let task: TaskTable = table.try_into().map_err(|e: toml::de::Error| bad_toml(path, &e))?;
        let duration = |key: &str, text: &Option<String>| duration(path, &format!("[tasks.{name}] {key}"), text);
        project.selection.tasks.push(TaskSelection {
            interval_ns: duration("interval", &task.interval)?,
            watchdog_ns: duration("watchdog", &task.watchdog)?,
            deadline_ns: duration("deadline", &task.deadline)?,
            priority: task.priority,
            programs: task.programs,
            name,
        });
    }
    project.safe_state = file.io.safe_state.into_iter().collect();
    project.retain_file = file.retain.file;
    project.defaults = Defaults {
        restart_task: matches!(file.runtime.on_fault, Some(OnFaultArg::RestartTask)),
        io: file.io.driver,
        retain_flush_ns: duration(path, "[retain] flush", &file.retain.flush)?,
    };
    let times = |place: &str, watchdog: &Option<String>, deadline: &Option<String>| {
        Ok::<_, Failure>(TaskTimes {
            watchdog_ns: duration(path, &format!("{place} watchdog"), watchdog)?,
            deadline_ns: duration(path, &format!("{place} deadline"), deadline)?,
        })
    };
    project.all_tasks = times("[runtime]", &file.runtime.watchdog, &file.runtime.deadline)?;
    for (name, task) in &file.runtime.tasks {
        let times = times(&format!("[runtime.tasks.{name}]"), &task.watchdog, &task.deadline)?;
        project.by_task.push((name.clone(), times));
    }
    Ok(project)
}

fn duration(path: &Path, place: &str, text: &Option<String>) -> Result<Option<i64>, Failure> {
    let parsed = text.as_deref().map(plcc_runtime::cli::parse_duration).transpose();
    parsed.map_err(|e| Failure::usage(format!("{}: {place}: {e}", path.display())))
}

/// toml's message with its line, and what was probably meant by an unknown key.
fn bad_toml(path: &Path, error: &toml::de::Error) -> Failure {
    let mut message = format!("{}: {}", path.display(), error.to_string().trim_end());
    let plain = error.message().to_string();
    if plain.starts_with("unknown field") {
        let mut names = plain.split('`').skip(1).step_by(2);
        if let Some(wrong) = names.next() {
            let candidates: Vec<&str> = names.collect();
            if let Some(near) = plcc_hir::similar(wrong, candidates.into_iter()) {
                message.push_str(&format!("\nhelp: did you mean `{near}`?"));
            }
        }
    }
    Failure::usage(message)
}

fn add_sources(project: &mut Project, root: &Path, pattern: &str, profile: Profile) -> Result<(), Failure> {
    let path = root.join(pattern);
    let found: Vec<PathBuf> = if path.is_dir() {
        folder(&path)?
    } else if path.exists() {
        vec![path]
    } else if pattern.contains(['*', '?', '[']) {
        let text = path.to_string_lossy();
        let paths = glob::glob(&text).map_err(|e| Failure::usage(format!("`{pattern}`: {e}")))?;
        let mut found: Vec<PathBuf> = paths.filter_map(Result::ok).filter(|p| p.is_file()).collect();
        found.sort();
        if found.is_empty() {
            return Err(Failure::device(format!("no file matches `{text}`")));
        }
        found
    } else {
        return Err(Failure::device(format!("there is no file `{}`", path.display())));
    };
    for path in found {
        if !project.sources.iter().any(|(p, _)| *p == path) {
            project.sources.push((path, profile));
        }
    }
    Ok(())
}

/// All sources below a folder, in order of name.
fn folder(path: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut found = Vec::new();
    let mut open = vec![path.to_path_buf()];
    while let Some(folder) = open.pop() {
        let entries = std::fs::read_dir(&folder).map_err(|e| Failure::io("read folder", &folder, e))?;
        for entry in entries.filter_map(Result::ok) {
            let path = entry.path();
            // A link to a folder above would have no end.
            if path.is_dir() && !path.is_symlink() {
                open.push(path);
            } else if path.extension().is_some_and(|e| TEXT.iter().any(|t| e.eq_ignore_ascii_case(t)))
                || (is_xml(&path) && is_plcopen(&path))
            {
                found.push(path);
            }
        }
    }
    if found.is_empty() {
        return Err(Failure::device(format!(
            "no sources ({} .xml) in `{}`",
            TEXT.map(|t| format!(".{t}")).join(" "),
            path.display()
        )));
    }
    found.sort();
    Ok(found)
}

/// Whether a source is PLCopen XML, by its name.
pub fn is_xml(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("xml"))
}

/// Whether an XML file of a folder is a PLCopen project: others live beside it.
fn is_plcopen(path: &Path) -> bool {
    let mut start = vec![0; 4096];
    let read = std::fs::File::open(path).and_then(|mut f| std::io::Read::read(&mut f, &mut start)).unwrap_or(0);
    String::from_utf8_lossy(&start[..read]).contains("plcopen.org/xml/tc6")
}

/// The text of an XML file that is not UTF-8: UTF-16, or the ISO-8859-1 that its declaration names.
fn xml_text(path: &Path, bytes: Vec<u8>) -> Result<String, Failure> {
    let units = |read: fn([u8; 2]) -> u16| bytes[2..].chunks_exact(2).map(|b| read([b[0], b[1]])).collect::<Vec<u16>>();
    let wide = match bytes.get(..2) {
        Some([0xff, 0xfe]) => Some(units(u16::from_le_bytes)),
        Some([0xfe, 0xff]) => Some(units(u16::from_be_bytes)),
        _ => None,
    };
    if let Some(text) = wide.and_then(|units| String::from_utf16(&units).ok()) {
        return Ok(text);
    }
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(200)]).to_ascii_lowercase();
    let declaration = head.split("?>").next().unwrap_or_default();
    if ["iso-8859-1", "latin1", "latin-1", "windows-1252", "us-ascii"].iter().any(|e| declaration.contains(e)) {
        return Ok(bytes.iter().map(|b| *b as char).collect());
    }
    let good = std::str::from_utf8(&bytes).map_or_else(|e| e.valid_up_to(), str::len);
    let line = bytes[..good].iter().filter(|b| **b == b'\n').count() + 1;
    let line_start = bytes[..good].iter().rposition(|b| *b == b'\n').map_or(0, |n| n + 1);
    let column = String::from_utf8_lossy(&bytes[line_start..good]).chars().count() + 1;
    let message = format!(
        "{}:{line}:{column}: error[{}]: this is not UTF-8, and the file names no other encoding",
        path.display(),
        plcc_diag::codes::XML_SYNTAX
    );
    Err(Failure { code: 1, message })
}

/// A source's text: UTF-8 or, if that fails, ISO-8859-1 (semantics.md \[L1\]).
pub fn read_source(path: &Path) -> Result<String, Failure> {
    let bytes = std::fs::read(path).map_err(|e| Failure::io("read", path, e))?;
    if bytes.len() > u32::MAX as usize / 2 {
        return Err(Failure::device(format!("`{}` is larger than 2 GB", path.display())));
    }
    let text = match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(e) if is_xml(path) => xml_text(path, e.into_bytes())?,
        Err(e) => e.into_bytes().iter().map(|b| *b as char).collect(),
    };
    Ok(match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_string(),
        None => text,
    })
}
