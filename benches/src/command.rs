//! Running programs, and building one with plcc.

use std::path::Path;
use std::process::{Command, Stdio};

/// What a program printed and how it ended.
#[derive(Debug)]
pub struct Done {
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
    /// The exit code; -1 if it did not start or a signal ended it.
    pub code: i32,
}

/// Runs a program in a folder.
pub fn run(program: &str, folder: &Path, args: &[&str]) -> Done {
    let output = Command::new(program).args(args).current_dir(folder).stdin(Stdio::null()).output();
    match output {
        Ok(output) => Done {
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
            code: output.status.code().unwrap_or(-1),
        },
        Err(e) => Done { stdout: String::new(), stderr: e.to_string(), code: -1 },
    }
}

/// Builds the executable of a source, as `plcc build` does.
pub fn build(source: &str, output: &Path) -> Result<(), String> {
    let file = output.with_extension("st");
    std::fs::write(&file, source).map_err(|e| e.to_string())?;
    let (file, output) = (file.display().to_string(), output.display().to_string());
    let args = ["plcc", "build", &file, "-o", &output];
    let cli = <plcc::cli::Cli as clap::Parser>::try_parse_from(args).map_err(|e| e.to_string())?;
    match plcc::execute(cli) {
        0 => Ok(()),
        code => Err(format!("plcc build: exit code {code}")),
    }
}
