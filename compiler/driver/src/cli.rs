//! The command line (the contract is in docs/cli.md).

use clap::{Args, Parser, Subcommand, ValueEnum};
use plcc_runtime::cli::RunFlags;
use std::path::PathBuf;

/// Ahead-of-time compiler for IEC 61131-3.
#[derive(Debug, Parser)]
#[command(name = "plcc", version, about, long_about = None)]
pub struct Cli {
    /// When to colour messages.
    #[arg(long, global = true, value_enum, default_value_t = Color::Auto)]
    pub color: Color,
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// When to colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Color {
    /// On a terminal; NO_COLOR and CLICOLOR_FORCE are honoured.
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

/// The commands.
// Made once per process.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Compile to a native executable, or print a stage.
    Build(BuildArgs),
    /// Compile and run at once.
    Run(Box<RunArgs>),
    /// Measure cycle times: native code beside the interpreter.
    Bench(BenchArgs),
    /// Find mistakes and explain them.
    Check(CheckArgs),
    /// Draw a program: its charts as SVG.
    Graph(GraphArgs),
    /// Write PLCopen XML as text.
    Convert(ConvertArgs),
    /// Show what a retain file holds, or compare it with another one or with a program.
    Retain {
        /// What to do.
        #[command(subcommand)]
        action: RetainAction,
    },
    /// Draw the timing diagram of a trace.
    Trace(TraceArgs),
    /// Explain a diagnostic code, a standard function or a standard function block.
    Explain {
        /// `E0301`, `LIMIT`, `TON`.
        name: String,
    },
    /// Make a small project that builds and runs.
    New {
        /// The folder to make; its last part names the project.
        name: PathBuf,
    },
}

/// What is compiled, and how its sources are read.
#[derive(Debug, Clone, Args)]
pub struct SourceArgs {
    /// project.toml, source files (.st .il .sfc .iec .txt .xml), folders or globs.
    #[arg(required = true, value_name = "project.toml|FILES")]
    pub files: Vec<String>,
    /// How strictly sources are read; the project file decides when this is not given.
    #[arg(long, value_enum)]
    pub profile: Option<ProfileArg>,
    /// Which PROGRAM runs when there are several and no CONFIGURATION.
    #[arg(long, value_name = "NAME")]
    pub program: Option<String>,
    /// How messages are printed.
    #[arg(long, value_enum, default_value_t = MessageFormat::Human)]
    pub message_format: MessageFormat,
}

/// `--profile`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ProfileArg {
    /// The standard's rules.
    Strict,
    /// For existing CODESYS-style libraries.
    Codesys,
}

/// `--message-format`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MessageFormat {
    /// With source lines and help.
    Human,
    /// One line each.
    Short,
    /// One JSON object a line.
    Json,
    /// A SARIF 2.1.0 log.
    Sarif,
}

/// How code is generated.
#[derive(Debug, Clone, Default, Args)]
pub struct CodeArgs {
    /// Safety checks: all, none, or a list of index,division,subrange,pointer,deadline.
    #[arg(long, value_name = "all|none|LIST")]
    pub checks: Option<String>,
    /// Optimisation of the generated code (default: speed; the interpreter, as the reference, runs the plain lowering).
    #[arg(long, value_enum)]
    pub opt: Option<OptArg>,
}

/// `--opt`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum OptArg {
    /// Plain lowering.
    None,
    /// For speed.
    Speed,
}

/// `plcc build`.
#[derive(Debug, Args)]
pub struct BuildArgs {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub sources: SourceArgs,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub code: CodeArgs,
    /// The executable (or object) to write.
    #[arg(short, long, value_name = "APP")]
    pub output: Option<PathBuf>,
    /// What the code runs on; other than this machine yields an object and a header.
    #[arg(long, value_name = "TRIPLE")]
    pub target: Option<String>,
    /// The runtime archive to link with, for other targets.
    #[arg(long, value_name = "ARCHIVE")]
    pub runtime: Option<PathBuf>,
    /// Print or write a stage instead of linking; several with commas.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "STAGE")]
    pub emit: Vec<Stage>,
}

/// `--emit`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum Stage {
    Tokens,
    Ast,
    Hir,
    Mir,
    Clif,
    Asm,
    Obj,
    Header,
}

/// `plcc run`.
#[derive(Debug, Args)]
pub struct RunArgs {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub sources: SourceArgs,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub code: CodeArgs,
    /// What executes the program.
    #[arg(long, value_enum, default_value_t = EngineArg::Jit)]
    pub engine: EngineArg,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub run: RunFlags,
}

/// `--engine`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum EngineArg {
    /// Machine code, compiled in memory.
    Jit,
    /// The reference interpreter.
    Interp,
}

/// `plcc bench`.
#[derive(Debug, Args)]
pub struct BenchArgs {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub sources: SourceArgs,
    /// Safety checks: all, none, or a list of index,division,subrange,pointer,deadline.
    #[arg(long, value_name = "all|none|LIST")]
    pub checks: Option<String>,
    /// Cycles from the start that are measured.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub cycles: u64,
    /// Base tick, as for plcc run.
    #[arg(long, value_name = "TIME", value_parser = plcc_runtime::cli::parse_duration)]
    pub interval: Option<i64>,
    /// Inputs as CSV, as for plcc run.
    #[arg(long, value_name = "FILE")]
    pub stimulus: Option<PathBuf>,
    /// A folder for the report as Markdown, JSON and SVG; without it Markdown goes to standard output.
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// Only run the cycles, between marks that callgrind understands: what plcc starts under valgrind to count instructions.
    #[arg(long, hide = true)]
    pub count_instructions: bool,
}

/// `plcc check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub sources: SourceArgs,
}

/// `plcc convert`.
#[derive(Debug, Args)]
pub struct ConvertArgs {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub sources: SourceArgs,
    /// Into what.
    #[arg(long, value_enum)]
    pub to: ToArg,
    /// The file to write; standard output without it.
    #[arg(short, long, value_name = "out.st")]
    pub output: Option<PathBuf>,
}

/// `--to`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ToArg {
    /// Structured Text; Instruction List and charts keep their text notations.
    St,
}

/// `plcc retain`.
#[derive(Debug, Subcommand)]
pub enum RetainAction {
    /// Every retained variable with its type and value.
    Show {
        /// The retain file.
        file: PathBuf,
    },
    /// The values that differ in another retain file, or what becomes of the values in a program.
    Diff {
        /// The retain file.
        file: PathBuf,
        /// Another retain file; or project.toml, source files, folders or globs.
        #[arg(required = true, value_name = "FILE|project.toml|SOURCES")]
        with: Vec<String>,
    },
}

/// `plcc trace`.
#[derive(Debug, Args)]
pub struct TraceArgs {
    /// The trace, as `--trace` writes it.
    #[arg(value_name = "FILE.csv")]
    pub trace: PathBuf,
    /// The drawing to write; standard output without it.
    #[arg(long, value_name = "out.svg")]
    pub svg: Option<PathBuf>,
    /// Only these columns, in this order.
    #[arg(long, value_name = "A,B,C")]
    pub watch: Option<String>,
    /// Only these cycles.
    #[arg(long, value_name = "FIRST..LAST")]
    pub cycles: Option<String>,
}

/// `plcc graph`.
#[derive(Debug, Args)]
pub struct GraphArgs {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub sources: SourceArgs,
    /// Draw only the Sequential Function Charts, also those of texts.
    #[arg(long)]
    pub sfc: bool,
    /// Only the chart of this POU, with those of its actions, or of one action (POU.ACTION).
    #[arg(long, value_name = "NAME")]
    pub pou: Option<String>,
    /// The file to write; standard output without it.
    #[arg(short, long, value_name = "chart.svg")]
    pub output: Option<PathBuf>,
    /// Mark the active steps of a cycle of this trace (columns Instance.Step.X).
    #[arg(long, value_name = "run.csv")]
    pub trace: Option<PathBuf>,
    /// Which cycle of the trace.
    #[arg(long, value_name = "N", requires = "trace")]
    pub cycle: Option<u64>,
    /// Whose steps, when the trace has several instances of the POU.
    #[arg(long, value_name = "PATH", requires = "trace")]
    pub instance: Option<String>,
}
