//! `plcc build`: an executable, an object with header, or the print of a stage.

use crate::cli::{BuildArgs, Color, Stage};
use crate::failure::Failure;
use crate::pipeline::{self, Compiled, Parsed};
use crate::project::Project;
use crate::{link, nothing_to_run, report};
use plcc_codegen::header;
use plcc_codegen::object::{self, ObjectOptions};
use plcc_diag::bug;
use plcc_runtime::image::Image;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Does it.
pub fn build(args: &BuildArgs, color: Color) -> Result<u8, Failure> {
    let (project, sources, ids) = pipeline::load(&args.sources)?;
    let mut parsed = pipeline::parse(sources, &ids);
    if args.emit.contains(&Stage::Tokens) {
        print_tokens(&parsed)?;
    }
    if args.emit.contains(&Stage::Ast) {
        let trees = parsed.files.iter().filter(|f| !f.2).map(|f| plcc_syntax::ast::print::print(&f.3));
        output(&trees.collect::<String>())?;
    }
    let only_text = |s: &Stage| matches!(s, Stage::Tokens | Stage::Ast);
    if !args.emit.is_empty() && args.emit.iter().all(only_text) {
        report(&parsed, None, args.sources.message_format, color)?;
        return Ok(0);
    }
    let checked = pipeline::check(&mut parsed, &project);
    if args.emit.contains(&Stage::Hir) {
        let mut text = plcc_hir::print::print(&checked.defs);
        if let Some(app) = &checked.app {
            text.push('\n');
            text.push_str(&plcc_hir::print::print_application(app, &checked.defs));
        }
        output(&text)?;
    }
    report(&parsed, Some(&checked), args.sources.message_format, color)?;
    if !args.emit.is_empty() && args.emit.iter().all(|s| only_text(s) || *s == Stage::Hir) {
        return Ok(0);
    }
    let app = checked.app.as_ref().ok_or_else(nothing_to_run)?;
    // A print shows every POU, an executable holds what its tasks reach.
    let prints_code = args.emit.iter().any(|s| matches!(s, Stage::Mir | Stage::Clif | Stage::Asm));
    let compiled = pipeline::compile(&checked, app, &project, &parsed, &args.code, prints_code)?;
    let target = args.target.as_deref().or(project.build.target.as_deref()).filter(|t| *t != link::HOST);
    for stage in &args.emit {
        match stage {
            Stage::Mir => output(&plcc_mir::print::program(&compiled.program, None))?,
            Stage::Clif => output(&text(plcc_codegen::text::emit_clif(&compiled.program, target)))?,
            Stage::Asm => output(&text(plcc_codegen::text::emit_asm(&compiled.program, target)))?,
            _ => {}
        }
    }
    let path = output_path(args, &project);
    if args.emit.is_empty() {
        return link(args, &compiled, &path, target);
    }
    if args.emit.contains(&Stage::Obj) {
        write_object(&compiled, &path, target)?;
    }
    if args.emit.contains(&Stage::Header) {
        write_header(&compiled, &path)?;
    }
    Ok(0)
}

fn print_tokens(parsed: &Parsed) -> Result<(), Failure> {
    for (file, _, builtin, _) in &parsed.files {
        if !builtin {
            output(&plcc_syntax::print_tokens(*file, &parsed.sources.file(*file).text))?;
        }
    }
    Ok(())
}

/// Text to standard output; a reader that goes away is no error.
pub fn output(text: &str) -> Result<(), Failure> {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::device(format!("standard output: {e}"))),
        _ => Ok(()),
    }
}

fn text(result: Result<String, plcc_codegen::CodegenError>) -> String {
    result.unwrap_or_else(|e| bug!("the code generator refused: {e:?}"))
}

/// `-o`, `[build] output`, or the project's name in the current folder.
fn output_path(args: &BuildArgs, project: &Project) -> PathBuf {
    args.output.clone().or_else(|| project.build.output.clone()).unwrap_or_else(|| PathBuf::from(&project.name))
}

fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    match path.extension() {
        Some(e) if e == "o" || e == "h" => path.with_extension(suffix),
        _ => PathBuf::from(format!("{}.{suffix}", path.display())),
    }
}

fn link(args: &BuildArgs, compiled: &Compiled, path: &Path, target: Option<&str>) -> Result<u8, Failure> {
    if let (Some(target), None) = (target, &args.runtime) {
        write_object(compiled, path, Some(target))?;
        write_header(compiled, path)?;
        eprintln!(
            "note: for {target} plcc writes the object {} and the header {}; link them there, or give --runtime ARCHIVE",
            with_suffix(path, "o").display(),
            with_suffix(path, "h").display()
        );
        return Ok(0);
    }
    let image = compiled.image.encode();
    let options = ObjectOptions { triple: target, image: Some(&image), vars: None };
    let object = object::compile(&compiled.program, options).map_err(refused)?;
    link::executable(&object, args.runtime.as_deref(), path)?;
    Ok(0)
}

/// A target that Cranelift does not know is the user's mistake, everything else ours.
fn refused(error: plcc_codegen::CodegenError) -> Failure {
    match error {
        plcc_codegen::CodegenError::Target(message) => Failure::usage(message),
        other => bug!("the code generator refused: {other:?}"),
    }
}

fn write_object(compiled: &Compiled, path: &Path, target: Option<&str>) -> Result<(), Failure> {
    let vars = crate::image::variables(&compiled.image);
    let options = ObjectOptions { triple: target, image: None, vars: Some(&vars) };
    let object = object::compile(&compiled.program, options).map_err(refused)?;
    link::write_file(&with_suffix(path, "o"), &object)
}

fn write_header(compiled: &Compiled, path: &Path) -> Result<(), Failure> {
    let header_path = with_suffix(path, "h");
    let name = header_path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let tasks: Vec<&str> = compiled.image.tasks.iter().map(|t| t.name.as_str()).collect();
    let text = header::header(
        &name,
        compiled.program.region_bytes,
        &tasks,
        &compiled.program.retain,
        &resources(&compiled.image),
    );
    link::write_file(&header_path, text.as_bytes())
}

fn resources(image: &Image) -> Vec<header::Resource> {
    let resource = |(n, r): (usize, &plcc_runtime::image::Resource)| header::Resource {
        name: r.name.clone(),
        start: r.start,
        tasks: image.tasks_of(n).len() as u32,
        shares: r.shares.iter().map(|s| [s.home, s.local, s.bytes, s.unit]).collect(),
    };
    image.resources.iter().enumerate().map(resource).collect()
}
