//! What the grammar's actions call: nodes from the positions of their tokens. Keeps the depth of expressions and types within
//! [`MAX_DEPTH`], orders flat operator lists by precedence, and judges the few forms that the grammar takes more widely than
//! the language (`x = 1;` as a statement, `INT[3]`).
//!
//! Messages wait in the context until the parse that made them succeeds.

mod configuration;
mod declarations;
mod expressions;
mod statements;

pub use configuration::resource;
pub use statements::sfc_body;

use crate::ast::*;
use plcc_diag::{Code, Diagnostic, FileId, Span, codes};
use smol_str::SmolStr;
use std::cell::{Cell, RefCell};

/// What the parse of one slice of tokens yields.
#[derive(Debug)]
pub enum Parsed {
    /// Behind `StartItem`.
    Item(Box<Item>),
    /// Behind `StartExpr`.
    Expr(Box<Expr>),
    /// Behind `StartBody`: the body and the ACTIONs in it.
    Body(Box<(Body, Vec<Action>)>),
    /// Behind `StartType`.
    Type(Box<TypeExpr>),
    /// Behind `StartInit`.
    Init(Box<Init>),
}

/// What stands in the parentheses of a type: a length, the bounds of a subrange or values of an enumeration.
#[derive(Debug)]
pub enum ParenItem {
    /// `e`.
    One(Expr),
    /// `e .. e`.
    Range(Expr, Expr),
    /// `name := e`.
    Valued(Expr, Expr),
}

/// What stands between CASE and END_CASE, flat.
#[derive(Debug)]
pub enum CaseItem {
    /// `1, 2..3:`.
    Labels(Vec<CaseLabel>, Span),
    /// A statement of the last labels.
    Statement(Box<Stmt>),
}

/// What stands in a chart, flat.
#[derive(Debug)]
pub enum SfcItem {
    /// A step or a transition.
    Element(Box<SfcElement>),
    /// An ACTION among them.
    Action(Box<Action>),
}

/// What stands in a CONFIGURATION or RESOURCE, flat.
#[derive(Debug)]
pub enum ResourceItem {
    /// VAR_GLOBAL, VAR_ACCESS, VAR_CONFIG.
    Section(Box<VarSection>),
    /// A TASK.
    Task(Box<TaskDecl>),
    /// A program instance.
    Program(Box<ProgramDecl>),
    /// A RESOURCE.
    Resource(Box<Resource>),
}

/// What all actions of one parse share.
pub struct Context<'t> {
    file: FileId,
    text: &'t str,
    pending: RefCell<Vec<Diagnostic>>,
    /// The last node that was too deep.
    too_deep: Cell<Option<Span>>,
}

impl<'t> Context<'t> {
    /// For one slice of tokens of `text`.
    pub fn new(file: FileId, text: &'t str) -> Self {
        Self { file, text, pending: RefCell::default(), too_deep: Cell::new(None) }
    }

    /// The messages since the last call.
    pub fn take_messages(&self) -> Vec<Diagnostic> {
        self.too_deep.set(None);
        self.pending.take()
    }

    /// The whole source text.
    pub fn source(&self) -> &'t str {
        self.text
    }

    /// Bytes `l..r`. Behind an optional part that is not there `r` is the start of the next token: blanks are cut off.
    pub fn span(&self, l: u32, r: u32) -> Span {
        let blanks = self.slice(l, r).bytes().rev().take_while(u8::is_ascii_whitespace).count() as u32;
        Span::new(self.file, l, r.max(l) - blanks)
    }

    fn slice(&self, l: u32, r: u32) -> &'t str {
        &self.text[l as usize..r.max(l) as usize]
    }

    fn report(&self, code: Code, span: Span, message: impl Into<String>, help: impl Into<String>) {
        self.pending.borrow_mut().push(Diagnostic::new(code, span, message).help(help));
    }

    /// A name.
    pub fn name(&self, l: u32, r: u32) -> Name {
        Name { text: self.slice(l, r).into(), span: self.span(l, r) }
    }

    /// `%...` as written.
    pub fn address(&self, l: u32, r: u32) -> (SmolStr, Span) {
        (self.slice(l, r).into(), self.span(l, r))
    }

    /// Whether a node of `depth` must be cut; the first one of a place is reported.
    fn cut(&self, depth: u32, span: Span) -> bool {
        if depth <= MAX_DEPTH {
            return false;
        }
        let known = self.too_deep.replace(Some(span));
        if !known.is_some_and(|k| k.start < span.end && span.start < k.end) {
            self.report(
                codes::NESTED_TOO_DEEPLY,
                span,
                format!("this nests more than {MAX_DEPTH} operations"),
                "divide it into several statements",
            );
        }
        true
    }
}

/// `list` with `item` at its end.
pub fn push<T>(mut list: Vec<T>, item: T) -> Vec<T> {
    list.push(item);
    list
}

/// `list` with `item`, if there is one, at its end.
pub fn push_some<T>(mut list: Vec<T>, item: Option<T>) -> Vec<T> {
    list.extend(item);
    list
}
