//! Which sources there are and how they are read: files, folders, globs, project.toml.

use crate::cli::{ProfileArg, SourceArgs};
use crate::failure::Failure;
use plcc_hir::{Profile, Selection, TaskSelection};
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
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Io {
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
        let duration = |key: &str, text: &Option<String>| match text {
            None => Ok(None),
            Some(text) => plcc_runtime::cli::parse_duration(text)
                .map(Some)
                .map_err(|e| Failure::usage(format!("{}: [tasks.{name}] {key}: {e}", path.display()))),
        };
        project.selection.tasks.push(TaskSelection {
            interval_ns: duration("interval", &task.interval)?,
            watchdog_ns: duration("watchdog", &task.watchdog)?,
            priority: task.priority,
            programs: task.programs,
            name,
        });
    }
    project.safe_state = file.io.safe_state.into_iter().collect();
    project.retain_file = file.retain.file;
    Ok(project)
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
