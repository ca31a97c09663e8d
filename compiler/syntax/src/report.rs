//! Where the passes of this crate put their messages: bounded per file, so that a file which is no source at all does not
//! print a million lines.

use plcc_diag::{Code, Diagnostic, Diagnostics, FileId, Span, codes};

/// Syntax errors of one file that are printed.
const MAX_MESSAGES: usize = 200;

/// The messages of one file.
pub struct Reporter<'d> {
    file: FileId,
    diags: &'d mut Diagnostics,
    left: usize,
}

impl<'d> Reporter<'d> {
    /// For `file`, into `diags`.
    pub fn new(file: FileId, diags: &'d mut Diagnostics) -> Self {
        Self { file, diags, left: MAX_MESSAGES }
    }

    /// Bytes `start..end` of the file.
    pub fn span(&self, start: u32, end: u32) -> Span {
        Span::new(self.file, start, end)
    }

    /// A message about bytes `start..end`, to be completed and given to [`push`](Self::push).
    pub fn at(&self, code: Code, start: u32, end: u32, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(code, self.span(start, end), message)
    }

    /// Whether further messages are dropped.
    pub fn is_full(&self) -> bool {
        self.left == 0
    }

    /// Adds a message, unless the file has had its share.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        match self.left {
            0 => return,
            1 => self.diags.push(
                Diagnostic::new(codes::TOO_MANY_ERRORS, diagnostic.primary.span, "too many syntax errors in this file")
                    .label("what follows here was read, but not judged")
                    .help("correct the messages above and compile again"),
            ),
            _ => self.diags.push(diagnostic),
        }
        self.left -= 1;
    }
}
