//! The driver: command line, project file, pipeline, rendering, linking. Among the compiler's crates only this one reads
//! files, prints, or ends the process.

/// The passes make and drop many small vectors; this allocator takes less of their time than the system's.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

pub mod bench;
mod build;
pub mod cli;
mod convert;
mod engines;
mod explain;
mod failure;
mod graph;
mod image;
mod link;
mod new;
mod pipeline;
mod places;
mod project;
mod render;
mod retain;
mod statements;
mod timing;

use clap::Parser;
use cli::{Cli, Color, Command, MessageFormat, SourceArgs};
use failure::Failure;
use pipeline::Parsed;
use plcc_diag::Diagnostics;
use plcc_hir::Checked;
use std::process::ExitCode;

/// The passes recurse over expressions of bounded depth (`ast::MAX_DEPTH`); this is enough for all of them. Only touched
/// pages cost memory.
const STACK_BYTES: usize = 512 << 20;

/// The whole program: reads the command line, works, gives the exit code.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    std::panic::set_hook(Box::new(|info| {
        eprintln!("plcc has a bug: {info}");
        eprintln!("please report it with the sources that led here");
    }));
    let work = std::thread::Builder::new().stack_size(STACK_BYTES).spawn(move || execute(cli));
    match work.map(std::thread::JoinHandle::join) {
        Ok(Ok(code)) => ExitCode::from(code),
        Ok(Err(_)) => ExitCode::from(70),
        Err(e) => {
            eprintln!("plcc: cannot start a thread: {e}");
            ExitCode::from(3)
        }
    }
}

/// Does what the command line says; the result is the exit code.
pub fn execute(cli: Cli) -> u8 {
    let color = cli.color;
    let result = match cli.command {
        Command::Build(args) => build::build(&args, color),
        Command::Run(args) => run(&args, color),
        Command::Bench(args) => bench::command::bench(&args, color),
        Command::Check(args) => check(&args.sources, color),
        Command::Graph(args) => graph::graph(&args, color),
        Command::Convert(args) => convert::convert(&args, color),
        Command::Retain { action } => retain::retain(&action, color),
        Command::Trace(args) => timing::trace(&args),
        Command::Explain { name } => explain::page(&name).map(|page| {
            print!("{page}");
            0
        }),
        Command::New { name } => new::create(&name).map(|()| 0),
    };
    match result {
        Ok(code) => code,
        Err(failure) => {
            if !failure.message.is_empty() {
                eprintln!("plcc: {}", failure.message);
            }
            failure.code
        }
    }
}

fn check(args: &SourceArgs, color: Color) -> Result<u8, Failure> {
    let (project, sources, ids) = pipeline::load(args)?;
    let mut parsed = pipeline::parse(sources, &ids);
    let checked = pipeline::check(&mut parsed, &project);
    report(&parsed, Some(&checked), args.message_format, color)?;
    pipeline::fits(&checked, &parsed)?;
    if args.message_format == MessageFormat::Human && parsed.diags.iter().next().is_none() {
        eprintln!("no mistakes found");
    }
    Ok(0)
}

fn run(args: &cli::RunArgs, color: Color) -> Result<u8, Failure> {
    let (project, sources, ids) = pipeline::load(&args.sources)?;
    let mut parsed = pipeline::parse(sources, &ids);
    let checked = pipeline::check(&mut parsed, &project);
    report(&parsed, Some(&checked), args.sources.message_format, color)?;
    let app = checked.app.as_ref().ok_or_else(nothing_to_run)?;
    let mut code = args.code.clone();
    if args.engine == cli::EngineArg::Interp {
        code.opt = code.opt.or(Some(cli::OptArg::None));
    }
    let compiled = pipeline::compile(&checked, app, &project, &parsed, &code, false)?;
    let resources = compiled.image.resources.len();
    let mut engines = match args.engine {
        cli::EngineArg::Interp => engines::Interpreter::engines(&compiled.program, resources),
        cli::EngineArg::Jit => {
            let code = plcc_codegen::jit::compile(&compiled.program)
                .unwrap_or_else(|e| plcc_diag::bug!("the code generator refused: {e:?}"));
            engines::Jit::engines(code, resources)
        }
    };
    Ok(plcc_runtime::run::run(&compiled.image, &mut engines, &args.run))
}

fn nothing_to_run() -> Failure {
    Failure::usage("there is no PROGRAM to run; `plcc check` is enough for a library")
}

/// Prints all messages; an error ends the command.
fn report(parsed: &Parsed, checked: Option<&Checked>, format: MessageFormat, color: Color) -> Result<(), Failure> {
    let diags: &Diagnostics = &parsed.diags;
    render::print(diags, &parsed.sources, format, color);
    if !diags.has_errors() {
        return Ok(());
    }
    let only_strict = checked.is_some_and(|c| c.codesys_only > 0 && c.codesys_only == diags.error_count());
    if only_strict && matches!(format, MessageFormat::Human | MessageFormat::Short) {
        eprintln!(
            "note: profile codesys accepts all of this, with warnings: use --profile codesys, or profile = \"codesys\" in project.toml"
        );
    }
    Err(Failure::sources())
}
