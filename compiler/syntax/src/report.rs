//! Where the passes of this crate put their messages: bounded per file, so that a file which is no source at all does not
//! print a million lines.

use crate::ast::Unnamed;
use crate::token::{Tok, Token};
use plcc_diag::{Code, Diagnostic, Diagnostics, FileId, Span, codes};
use rustc_hash::FxHashSet;

/// Syntax errors of one file that are printed.
const MAX_MESSAGES: usize = 200;

/// The messages of one file.
pub struct Reporter<'d> {
    file: FileId,
    diags: &'d mut Diagnostics,
    left: usize,
    /// Statements and declarations that were mended by a guess.
    doubtful: Vec<Span>,
    /// Names, in upper case, of declarations that could not be read.
    lost: FxHashSet<String>,
    /// Declarations whose name is missing.
    unnamed: usize,
    /// Reserved words, in upper case, that were declared as names.
    reserved: FxHashSet<String>,
}

impl<'d> Reporter<'d> {
    /// For `file`, into `diags`.
    pub fn new(file: FileId, diags: &'d mut Diagnostics) -> Self {
        Self {
            file,
            diags,
            left: MAX_MESSAGES,
            doubtful: Vec::new(),
            lost: FxHashSet::default(),
            unnamed: 0,
            reserved: FxHashSet::default(),
        }
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

    /// Bytes `start..end` were mended by a guess.
    pub fn doubt(&mut self, start: u32, end: u32) {
        self.doubtful.push(self.span(start, end));
    }

    /// A declaration that may have been that of `name` could not be read.
    pub fn lose(&mut self, name: &str) {
        self.lost.insert(name.to_ascii_uppercase());
    }

    /// A reserved word was declared as a name, which was reported: it is one now.
    pub fn take_for_name(&mut self, word: &str) {
        self.reserved.insert(word.to_ascii_uppercase());
    }

    /// Whether a reserved word was declared as a name.
    pub fn is_taken_for_name(&self, word: &str) -> bool {
        !self.reserved.is_empty() && self.reserved.contains(&word.to_ascii_uppercase())
    }

    /// A declaration lacks its name.
    pub fn lose_unnamed(&mut self) {
        self.unnamed += 1;
    }

    /// Whether any message was given.
    pub fn is_used(&self) -> bool {
        self.left < MAX_MESSAGES
    }

    /// Where no further mistakes should be looked for: what was mended by a guess, and the uses of lost names;
    /// and what declarations without a name may have lost.
    pub fn doubtful(self, text: &str, tokens: &[Token]) -> (Vec<Span>, Unnamed) {
        let (mut out, mut unnamed) = (self.doubtful, Unnamed { count: self.unnamed, names: Vec::new() });
        let names = tokens.iter().filter(|t| t.kind == Tok::Id);
        let names = names.map(|t| (t.text(text).to_ascii_uppercase(), Span::new(self.file, t.start, t.end)));
        for (name, span) in names {
            if self.lost.contains(&name) {
                out.push(span);
            }
            if self.unnamed > 0 {
                unnamed.names.push((name.into(), span));
            }
        }
        (out, unnamed)
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
