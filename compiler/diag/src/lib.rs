//! Spans, the source map, diagnostics and the table of diagnostic codes.
//!
//! A user's mistake is a value of [`Diagnostic`] pushed to [`Diagnostics`], never an `Err`: a pass reports, returns its
//! output with error nodes and goes on. Rendering (text, JSON, SARIF) is the driver's business.

pub mod codes;
mod diagnostic;
mod source;
mod span;

pub use codes::{Code, CodeInfo, Severity};
pub use diagnostic::{Diagnostic, Diagnostics, Label};
pub use source::{SourceFile, SourceMap};
pub use span::{FileId, Span};

/// Reports a bug in plcc itself (exit code 70), never a mistake of the user.
#[macro_export]
macro_rules! bug {
    ($($arg:tt)*) => {
        panic!("plcc bug: {}", format_args!($($arg)*))
    };
}
