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

/// The row with this code, in any case.
pub fn find(code: &str) -> Option<&'static CodeInfo> {
    ALL.iter().map(|c| c.info()).find(|c| c.code.eq_ignore_ascii_case(code))
}

macro_rules! codes {
    ($($name:ident $code:literal $severity:ident $title:literal $page:literal;)*) => {
        $(
            #[doc = concat!($code, ": ", $title)]
            pub const $name: Code = Code(&CodeInfo {
                code: $code, severity: Severity::$severity, title: $title, page: $page,
            });
        )*
        /// Every row, in order.
        pub const ALL: &[Code] = &[$($name),*];
    };
}

// A page says what is wrong, why it matters, and what to write instead; its first ```st block shows the mistake.
codes! {
    // ---- E01xx: lexical and syntax ----
    UNCLOSED_BLOCK "E0101" Error "a block is not closed" "\
A construct that opens with a keyword (IF, FOR, VAR, PROGRAM ...) closes with its own END word. Here an outer construct ends, or the \
file does, while the inner one is still open.\n\n```st\nPROGRAM Main\nVAR x : INT; END_VAR\nIF x > 0 THEN\n  x := 0;\nEND_PROGRAM\n```\n\n\
Write the missing END word where the block should end.\n";
}
