//! The pipeline: one line per arrow, from sources to an engine or an executable. docs/architecture.md has the same as a table.

use crate::cli::{CodeArgs, OptArg, SourceArgs};
use crate::failure::Failure;
use crate::project::{self, Project};
use plcc_diag::{Diagnostics, FileId, SourceMap};
use plcc_hir::{Application, Checked, Profile, Unit};
use plcc_mir::ir;
use plcc_mir::lower::Checks;
use plcc_runtime::image::Image;
use plcc_syntax::ast;

/// Sources with their trees.
pub struct Parsed {
    /// All texts.
    pub sources: SourceMap,
    /// The user's files and the standard function blocks, in order.
    pub files: Vec<(FileId, Profile, bool, ast::File)>,
    /// Mistakes so far.
    pub diags: Diagnostics,
}

/// A program that can be run or linked.
pub struct Compiled {
    /// Code.
    pub program: ir::Program,
    /// What the runtime must know.
    pub image: Image,
}

/// Project, texts, and the profile of each of the user's files.
pub type Loaded = (Project, SourceMap, Vec<(FileId, Profile)>);

/// load: project and paths to texts.
pub fn load(args: &SourceArgs) -> Result<Loaded, Failure> {
    let project = project::load(args)?;
    let mut sources = SourceMap::new();
    let mut ids = Vec::new();
    for (path, profile) in &project.sources {
        let text = project::read_source(path)?;
        ids.push((sources.add(path.display().to_string(), text), *profile));
    }
    Ok((project, sources, ids))
}

/// lex, blocks, parse, or xml: texts to trees.
pub fn parse(mut sources: SourceMap, ids: &[(FileId, Profile)]) -> Parsed {
    let mut diags = Diagnostics::new();
    let mut files = Vec::new();
    for (name, text) in plcc_stdlib::blocks::blocks() {
        let id = sources.add_builtin(format!("<{name}>"), *text);
        files.push((id, Profile::Strict, true, plcc_syntax::parse_file(id, text, Profile::Strict, &mut diags)));
    }
    for (id, profile) in ids {
        let text = sources.file(*id).text.clone();
        let parse = match project::is_xml(std::path::Path::new(&sources.file(*id).name)) {
            true => plcc_syntax::parse_xml,
            false => plcc_syntax::parse_file,
        };
        files.push((*id, *profile, false, parse(*id, &text, *profile, &mut diags)));
    }
    Parsed { sources, files, diags }
}

/// networks, collect, check, configure: trees to the typed form.
pub fn check(parsed: &mut Parsed, project: &Project) -> Checked {
    let mut trees: Vec<&mut ast::File> = parsed.files.iter_mut().map(|f| &mut f.3).collect();
    plcc_hir::network::lower(&mut trees, &mut parsed.diags);
    let units: Vec<Unit> = parsed
        .files
        .iter()
        .map(|(file, profile, builtin, ast)| Unit { file: *file, ast, profile: *profile, builtin: *builtin })
        .collect();
    let checked = plcc_hir::check(&units, &project.selection, &mut parsed.diags);
    plcc_hir::chart_structure::check(&checked.defs, &mut parsed.diags);
    crate::places::name(&mut parsed.diags, &parsed.files, &parsed.sources);
    checked
}

/// layout, lower, verify, optimise of each resource, join, image: the typed form to MIR and what the runtime needs.
pub fn compile(
    checked: &Checked,
    app: &Application,
    project: &Project,
    parsed: &Parsed,
    code: &CodeArgs,
    all: bool,
) -> Result<Compiled, Failure> {
    let checks = checks(project, code)?;
    let mut resources = Vec::new();
    for number in 0..app.resources.len() {
        let defs = app.defs_of(number, &checked.defs);
        let (mut program, layout) =
            plcc_mir::lower::lower(&defs, app, number, checks, all).map_err(|e| too_large(e, &parsed.sources))?;
        let problems = plcc_mir::verify::verify(&program);
        if !problems.is_empty() {
            plcc_diag::bug!(
                "the verifier found:\n{}\n{}",
                problems.iter().map(|p| format!("{p:?}\n")).collect::<String>(),
                plcc_mir::print::program(&program, None)
            );
        }
        if code.opt != Some(OptArg::None) {
            plcc_mir::opt::optimise(&mut program);
        }
        resources.push((program, layout));
    }
    let (program, layouts, home) =
        plcc_mir::resources::join(&checked.defs, app, resources).map_err(|e| too_large(e, &parsed.sources))?;
    let memory = crate::image::Memory { layouts: &layouts, home: home.as_ref() };
    let image = crate::image::build(&checked.defs, app, &memory, &program, project, &parsed.sources)?;
    Ok(Compiled { program, image })
}

/// Whether the variables fit into memory, for `check`, which generates no code.
pub fn fits(checked: &Checked, parsed: &Parsed) -> Result<(), Failure> {
    match &checked.app {
        Some(app) => (0..app.resources.len()).try_for_each(|number| {
            let defs = app.defs_of(number, &checked.defs);
            plcc_mir::lower::fits(&defs, app, number).map_err(|e| too_large(e, &parsed.sources))
        }),
        None => Ok(()),
    }
}

/// The variables do not fit: the one mistake that shows only after checking.
fn too_large(error: plcc_mir::layout::TooLarge, sources: &SourceMap) -> Failure {
    let place = error.span.map(|s| format!("{}: ", sources.position(s))).unwrap_or_default();
    let message = format!(
        "{place}error[{}]: {} needs {} bytes, a resource has less than {}",
        plcc_diag::codes::TOO_LARGE,
        error.what,
        error.bytes,
        plcc_mir::layout::MAX_REGION_BYTES
    );
    Failure { code: 1, message }
}

/// `--checks`, else `[build] checks`, else all.
fn checks(project: &Project, code: &CodeArgs) -> Result<Checks, Failure> {
    let mut checks = Checks::ALL;
    if let Some(table) = &project.build.checks {
        checks.index = table.index.unwrap_or(true);
        checks.division = table.division.unwrap_or(true);
        checks.subrange = table.subrange.unwrap_or(true);
        checks.pointer = table.pointer.unwrap_or(true);
        checks.deadline = table.deadline.unwrap_or(true);
    }
    match code.checks.as_deref() {
        None => {}
        Some("all") => checks = Checks::ALL,
        Some("none") => checks = Checks::NONE,
        Some(list) => {
            checks = Checks::NONE;
            for name in list.split(',') {
                match name.trim() {
                    "index" => checks.index = true,
                    "division" => checks.division = true,
                    "subrange" => checks.subrange = true,
                    "pointer" => checks.pointer = true,
                    "deadline" => checks.deadline = true,
                    other => {
                        let names = ["index", "division", "subrange", "pointer", "deadline", "all", "none"];
                        let hint = plcc_hir::similar(other, names.into_iter());
                        let hint = hint.map(|h| format!("; did you mean `{h}`?")).unwrap_or_default();
                        return Err(Failure::usage(format!("--checks: there is no check `{other}`{hint}")));
                    }
                }
            }
        }
    }
    Ok(checks)
}
