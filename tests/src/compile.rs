//! The compiler as a library: a source text to MIR, without the driver. A text that begins with `<` is PLCopen XML.

use plcc_diag::{Diagnostics, SourceMap};
use plcc_hir::{Checked, Profile, Selection, Unit};
use plcc_mir::ir::Program;
use plcc_mir::layout::Layout;
use plcc_mir::lower::Checks;
use plcc_syntax::ast;
use std::sync::OnceLock;

/// Messages of errors, one line each.
fn errors(diags: &Diagnostics, sources: &SourceMap) -> String {
    let list = diags.sorted();
    let errors = list.iter().filter(|d| d.severity() == plcc_diag::Severity::Error);
    errors.map(|d| format!("{}: {}: {}\n", sources.position(d.primary.span), d.code, d.message)).collect()
}

/// Reads and checks one source in a profile; `Err` has its errors.
pub fn check(text: &str, profile: Profile) -> Result<Checked, String> {
    let (checked, diags, sources) = read(text, profile);
    if diags.has_errors() { Err(errors(&diags, &sources)) } else { Ok(checked) }
}

/// All messages that `plcc check` has for one source in a profile, and the texts they point into.
pub fn diagnose(text: &str, profile: Profile) -> (Checked, Diagnostics, SourceMap) {
    let (checked, mut diags, sources) = read(text, profile);
    plcc_hir::chart_structure::check(&checked.defs, &mut diags);
    (checked, diags, sources)
}

/// Without the analysis of charts: what gets stuck can be run, too.
fn read(text: &str, profile: Profile) -> (Checked, Diagnostics, SourceMap) {
    let mut sources = SourceMap::new();
    let mut diags = Diagnostics::new();
    // The standard blocks come first and have the same numbers each time.
    let standard: Vec<_> = plcc_stdlib::blocks::blocks().iter().map(|(n, t)| sources.add_builtin(*n, *t)).collect();
    static PARSED: OnceLock<Vec<ast::File>> = OnceLock::new();
    let blocks = plcc_stdlib::blocks::blocks().iter().zip(&standard);
    let parsed = PARSED.get_or_init(|| {
        blocks.map(|((_, t), id)| plcc_syntax::parse_file(*id, t, Profile::Strict, &mut Diagnostics::new())).collect()
    });
    let id = sources.add("program.st", text);
    let parse = if text.starts_with('<') { plcc_syntax::parse_xml } else { plcc_syntax::parse_file };
    let mut program = parse(id, text, profile, &mut diags);
    plcc_hir::network::lower(&mut [&mut program], &mut diags);
    let builtin = standard.iter().zip(parsed);
    let mut units: Vec<Unit> =
        builtin.map(|(file, ast)| Unit { file: *file, ast, profile: Profile::Strict, builtin: true }).collect();
    units.push(Unit { file: id, ast: &program, profile, builtin: false });
    let checked = plcc_hir::check(&units, &Selection::default(), &mut diags);
    (checked, diags, sources)
}

/// A source with one PROGRAM or a CONFIGURATION to verified MIR.
pub fn compile(text: &str, profile: Profile) -> Result<Program, String> {
    compile_with_layout(text, profile).map(|(_, program, _)| program)
}

/// The same, with what tells where its variables lie.
pub fn compile_with_layout(text: &str, profile: Profile) -> Result<(Checked, Program, Layout), String> {
    let checked = check(text, profile)?;
    let (program, layout) = lower(&checked)?;
    Ok((checked, program, layout))
}

/// A checked source to verified MIR and its layout.
pub fn lower(checked: &Checked) -> Result<(Program, Layout), String> {
    let app = checked.app.as_ref().ok_or("there is no PROGRAM")?;
    let (program, layout) =
        plcc_mir::lower::lower(&checked.defs, app, 0, Checks::ALL, false).map_err(|e| format!("{e:?}"))?;
    let problems = plcc_mir::verify::verify(&program);
    if problems.is_empty() { Ok((program, layout)) } else { Err(format!("verifier: {problems:?}")) }
}
