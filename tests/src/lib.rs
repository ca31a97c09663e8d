//! What the test programs share: running plcc, comparing texts, comparing programs before and after each pass.

pub mod compile;
pub mod memory;
pub mod passes;
pub mod reduce;

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// The folder of this package.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// The top folder of the project.
pub fn project_root() -> PathBuf {
    root().parent().expect("tests lies in the project").to_path_buf()
}

/// What a command printed and how it ended.
#[derive(Debug)]
pub struct Done {
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
    /// The exit code; -1 after a signal.
    pub code: i32,
}

impl From<Output> for Done {
    fn from(output: Output) -> Self {
        Done {
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
            code: output.status.code().unwrap_or(-1),
        }
    }
}

/// A call of the program `exe` in a folder.
pub fn command(exe: &Path, folder: &Path, args: &[&str]) -> Done {
    Command::new(exe)
        .args(args)
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .stdin(Stdio::null())
        .output()
        .unwrap_or_else(|e| panic!("cannot start {}: {e}", exe.display()))
        .into()
}

/// The lines in which two texts differ, for a failure message; `None` if they are equal.
pub fn difference(expected: &str, got: &str) -> Option<String> {
    if expected == got {
        return None;
    }
    let diff = similar::TextDiff::from_lines(expected, got);
    Some(diff.unified_diff().context_radius(3).header("expected", "got").to_string())
}
