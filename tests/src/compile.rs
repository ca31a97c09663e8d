//! The compiler as a library: a source text to MIR, without the driver.

use plcc_diag::{Diagnostics, SourceMap};
use plcc_hir::{Checked, Profile, Selection, Unit};
use plcc_mir::ir::Program;
use plcc_mir::layout::Layout;
use plcc_mir::lower::Checks;

/// Messages of errors, one line each.
fn errors(diags: &Diagnostics, sources: &SourceMap) -> String {
    let list = diags.sorted();
    let errors = list.iter().filter(|d| d.severity() == plcc_diag::Severity::Error);
    errors.map(|d| format!("{}: {}: {}\n", sources.position(d.primary.span), d.code, d.message)).collect()
}

/// Reads and checks one source in a profile; `Err` has its errors.
pub fn check(text: &str, profile: Profile) -> Result<Checked, String> {
    let (checked, diags, sources) = diagnose(text, profile);
    if diags.has_errors() { Err(errors(&diags, &sources)) } else { Ok(checked) }
}

/// Reads and checks one source in a profile, with all messages and the texts they point into.
pub fn diagnose(text: &str, profile: Profile) -> (Checked, Diagnostics, SourceMap) {
    let mut sources = SourceMap::new();
    let mut diags = Diagnostics::new();
    let mut files = Vec::new();
    for (name, text) in plcc_stdlib::blocks::blocks() {
        let id = sources.add_builtin(*name, *text);
        files.push((id, Profile::Strict, true, plcc_syntax::parse_file(id, text, Profile::Strict, &mut diags)));
    }
    let id = sources.add("program.st", text);
    files.push((id, profile, false, plcc_syntax::parse_file(id, text, profile, &mut diags)));
    let units: Vec<Unit> = files
        .iter()
        .map(|(file, profile, builtin, ast)| Unit { file: *file, ast, profile: *profile, builtin: *builtin })
        .collect();
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
