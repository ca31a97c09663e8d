//! One message to the user, and the list of them.

use crate::{Code, Severity, Span};

/// A place with a few words that say what is there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// Where.
    pub span: Span,
    /// What is there ("declared here"); may be empty on a primary label.
    pub text: String,
}

/// A mistake or a hint: code, place, cause, help in the words of IEC 61131-3.
///
/// Labels describe, help advises.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// The row of the code table.
    pub code: Code,
    /// What is wrong, one sentence without a full stop.
    pub message: String,
    /// Where it is wrong.
    pub primary: Label,
    /// Other places that explain it, such as a declaration.
    pub secondary: Vec<Label>,
    /// What to do about it.
    pub help: Vec<String>,
}

impl Diagnostic {
    /// A diagnostic with the severity that the code table gives.
    pub fn new(code: Code, span: Span, message: impl Into<String>) -> Self {
        Self {
            code,
            message: message.into(),
            primary: Label { span, text: String::new() },
            secondary: Vec::new(),
            help: Vec::new(),
        }
    }

    /// Words at the primary place.
    #[must_use]
    pub fn label(mut self, text: impl Into<String>) -> Self {
        self.primary.text = text.into();
        self
    }

    /// A second place.
    #[must_use]
    pub fn also(mut self, span: Span, text: impl Into<String>) -> Self {
        self.secondary.push(Label { span, text: text.into() });
        self
    }

    /// Advice.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help.push(text.into());
        self
    }

    /// Advice, if there is any.
    #[must_use]
    pub fn help_if(mut self, text: Option<String>) -> Self {
        self.help.extend(text);
        self
    }

    /// The severity of its code.
    pub fn severity(&self) -> Severity {
        self.code.info().severity
    }
}

/// The list that passes push to.
#[derive(Debug, Clone, Default)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
    errors: usize,
}

impl Diagnostics {
    /// An empty list.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds one message.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.errors += usize::from(diagnostic.severity() == Severity::Error);
        self.list.push(diagnostic);
    }

    /// Keeps only some messages.
    pub fn retain(&mut self, keep: impl FnMut(&Diagnostic) -> bool) {
        self.list.retain(keep);
        self.errors = self.list.iter().filter(|d| d.severity() == Severity::Error).count();
    }

    /// Adds all messages of another list.
    pub fn append(&mut self, other: Diagnostics) {
        self.errors += other.errors;
        self.list.extend(other.list);
    }

    /// How many errors there are.
    pub fn error_count(&self) -> usize {
        self.errors
    }

    /// Whether there is any error, so that no code may be generated.
    pub fn has_errors(&self) -> bool {
        self.errors > 0
    }

    /// All messages in order of position, exact repetitions removed.
    pub fn sorted(&self) -> Vec<&Diagnostic> {
        let mut all: Vec<&Diagnostic> = self.list.iter().collect();
        all.sort_by_key(|d| (d.primary.span.file, d.primary.span.start));
        all.dedup_by(|a, b| a == b);
        all
    }

    /// How many messages there are.
    pub fn count(&self) -> usize {
        self.list.len()
    }

    /// Takes back the messages behind the first `count`: to reword them, or to drop those of a trial.
    pub fn split_off(&mut self, count: usize) -> Vec<Diagnostic> {
        let taken = self.list.split_off(count.min(self.list.len()));
        self.errors -= taken.iter().filter(|d| d.severity() == Severity::Error).count();
        taken
    }

    /// The message found last.
    pub fn last(&self) -> Option<&Diagnostic> {
        self.list.last()
    }

    /// All messages in the order in which they were found.
    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.list.iter()
    }
}
