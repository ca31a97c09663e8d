//! `plcc retain`: what a retain file holds, and what would become of it.

use crate::cli::{CodeArgs, Color, MessageFormat, RetainAction, SourceArgs};
use crate::failure::Failure;
use crate::{nothing_to_run, pipeline, report};
use plcc_runtime::retain;
use std::io::{Read, Write};
use std::path::Path;

/// Does it.
pub fn retain(action: &RetainAction, color: Color) -> Result<u8, Failure> {
    let text = match action {
        RetainAction::Show { file } => retain::show(file),
        RetainAction::Diff { file, with } => match with.as_slice() {
            [other] if is_retain_file(other) => retain::compare_values(file, Path::new(other)),
            sources => return compare(file, sources, color),
        },
    };
    print(&text.map_err(failure)?);
    Ok(0)
}

fn failure((code, message): retain::Problem) -> Failure {
    Failure { code, message }
}

/// A reader that went away does not matter.
fn print(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}

fn is_retain_file(path: &str) -> bool {
    let mut head = [0; retain::MAGIC.len()];
    std::fs::File::open(path).and_then(|mut f| f.read_exact(&mut head)).is_ok() && head == *retain::MAGIC
}

fn compare(file: &Path, sources: &[String], color: Color) -> Result<u8, Failure> {
    let args =
        SourceArgs { files: sources.to_vec(), profile: None, program: None, message_format: MessageFormat::Human };
    let (project, sources, ids) = pipeline::load(&args)?;
    let mut parsed = pipeline::parse(sources, &ids);
    let checked = pipeline::check(&mut parsed, &project);
    report(&parsed, Some(&checked), args.message_format, color)?;
    let app = checked.app.as_ref().ok_or_else(nothing_to_run)?;
    let compiled = pipeline::compile(&checked, app, &project, &parsed, &CodeArgs::default(), false)?;
    print(&retain::compare_program(file, &compiled.image).map_err(failure)?);
    Ok(0)
}
