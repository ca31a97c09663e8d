//! The code table: one row per cause. Numbers by phase: E01xx syntax, E02xx names, E03xx types and calls, E04xx IL and SFC,
//! E05xx configuration and project, E06xx run time; W likewise for warnings, H for hints.

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// A hint on style or on another reading; changes nothing.
    Hint,
    /// Compiles, but is probably not meant so.
    Warning,
    /// No code is generated.
    Error,
}

/// A row of the table.
#[derive(Debug)]
pub struct CodeInfo {
    /// `E0301`.
    pub code: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// A few words, for lists.
    pub title: &'static str,
    /// The page behind `plcc explain`. Its first fenced block is a complete source that yields exactly this code
    /// (a test compiles it); codes of the run time and of the driver have none.
    pub page: &'static str,
}

/// A reference to a row.
#[derive(Clone, Copy)]
pub struct Code(&'static CodeInfo);

impl Code {
    /// The row.
    pub fn info(self) -> &'static CodeInfo {
        self.0
    }
}

impl PartialEq for Code {
    fn eq(&self, other: &Self) -> bool {
        self.0.code == other.0.code
    }
}
impl Eq for Code {}
impl std::fmt::Debug for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.0.code)
    }
}
impl std::fmt::Display for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.0.code)
    }
}

macro_rules! codes {
    ($($name:ident $code:literal $severity:ident $title:literal $page:literal;)*) => {
        $(
            #[doc = concat!($code, ": ", $title)]
            pub const $name: Code = Code(&CodeInfo {
                code: $code, severity: Severity::$severity, title: $title, page: $page,
            });
        )*
        /// The rows of this table, in order.
        pub(super) const ROWS: &[Code] = &[$($name),*];
    };
}

// A page says what is wrong, why it matters, and what to write instead; its first ```st block shows the mistake.

mod configuration;
mod il;
mod names;
mod networks;
mod runtime;
mod sfc;
mod syntax;
mod types;
mod xml;

pub use configuration::*;
pub use il::*;
pub use names::*;
pub use networks::*;
pub use runtime::*;
pub use sfc::*;
pub use syntax::*;
pub use types::*;
pub use xml::*;

/// Every row, by phase.
pub fn all() -> impl Iterator<Item = Code> {
    let tables = [
        syntax::ROWS,
        xml::ROWS,
        names::ROWS,
        types::ROWS,
        networks::ROWS,
        sfc::ROWS,
        il::ROWS,
        configuration::ROWS,
        runtime::ROWS,
    ];
    tables.into_iter().flatten().copied()
}

/// The row with this code, in any case.
pub fn find(code: &str) -> Option<&'static CodeInfo> {
    all().map(Code::info).find(|c| c.code.eq_ignore_ascii_case(code))
}
