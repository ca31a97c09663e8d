//! Statements of Structured Text.

use super::{Expr, Name};
use plcc_diag::Span;

/// A statement with its place.
#[derive(Debug, Clone)]
pub struct Stmt {
    /// What it is.
    pub kind: StmtKind,
    /// From its first token to its END word or last token, without the `;`.
    pub span: Span,
}

/// The forms of a statement.
#[derive(Debug, Clone)]
pub enum StmtKind {
    /// `a := b`.
    Assign(Expr, Expr),
    /// `r ?= s`.
    AssignAttempt(Expr, Expr),
    /// `r REF= x`.
    Bind(Expr, Expr),
    /// `fb(...)`, `f(...)`; anything else here is an error that `hir` reports ("has no effect").
    Expr(Expr),
    /// IF.
    If {
        /// IF and ELSIF with their conditions.
        arms: Vec<(Expr, Vec<Stmt>)>,
        /// ELSE.
        otherwise: Option<Vec<Stmt>>,
    },
    /// CASE.
    Case {
        /// Between CASE and OF.
        selector: Expr,
        /// In order.
        arms: Vec<CaseArm>,
        /// ELSE.
        otherwise: Option<Vec<Stmt>>,
    },
    /// FOR.
    For {
        /// The control variable.
        var: Expr,
        /// First value.
        from: Expr,
        /// Last value.
        to: Expr,
        /// Step.
        by: Option<Expr>,
        /// Between DO and END_FOR.
        body: Vec<Stmt>,
    },
    /// WHILE.
    While(Expr, Vec<Stmt>),
    /// REPEAT.
    Repeat(Vec<Stmt>, Expr),
    /// EXIT.
    Exit,
    /// CONTINUE.
    Continue,
    /// RETURN.
    Return,
    /// `label:` (a CODESYS form).
    Label(Name),
    /// `JMP label` (a CODESYS form).
    Jump(Name),
    /// `;` alone.
    Empty,
    /// What could not be parsed; reported already.
    Error,
}

/// `1, 3..5, Red : statements`.
#[derive(Debug, Clone)]
pub struct CaseArm {
    /// Its labels.
    pub labels: Vec<CaseLabel>,
    /// Its statements.
    pub body: Vec<Stmt>,
    /// From the first label to the colon.
    pub span: Span,
}

/// One label.
#[derive(Debug, Clone)]
pub enum CaseLabel {
    /// A constant.
    One(Expr),
    /// A range.
    Range(Expr, Expr),
}
