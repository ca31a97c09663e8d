//! How a command ends early: an exit code of docs/cli.md and one line for standard error.

use std::fmt::Display;
use std::path::Path;

/// A command that cannot go on. Mistakes in sources are no failures, they are diagnostics.
#[derive(Debug)]
pub struct Failure {
    /// 1 errors in the sources (already printed), 2 wrong usage, 3 file or device, 70 a bug.
    pub code: u8,
    /// What to say; empty if everything was said.
    pub message: String,
}

impl Failure {
    /// The sources have errors, which were printed.
    pub fn sources() -> Self {
        Self { code: 1, message: String::new() }
    }

    /// Wrong usage or configuration.
    pub fn usage(message: impl Into<String>) -> Self {
        Self { code: 2, message: message.into() }
    }

    /// A file or device.
    pub fn io(what: &str, path: &Path, error: impl Display) -> Self {
        Self { code: 3, message: format!("cannot {what} `{}`: {error}", path.display()) }
    }

    /// A file or device, in other words.
    pub fn device(message: impl Into<String>) -> Self {
        Self { code: 3, message: message.into() }
    }
}
