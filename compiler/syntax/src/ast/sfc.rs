//! Sequential Function Chart as text.

use super::{Expr, IlBody, Name, Network, Stmt};
use plcc_diag::Span;

/// A chart. ACTION blocks stand in the POU's `actions`.
#[derive(Debug, Clone)]
pub struct SfcBody {
    /// Steps and transitions in order.
    pub elements: Vec<SfcElement>,
    /// The whole body.
    pub span: Span,
}

/// A part of a chart.
#[derive(Debug, Clone)]
pub enum SfcElement {
    /// STEP, INITIAL_STEP.
    Step(Step),
    /// TRANSITION.
    Transition(Transition),
}

/// A step.
#[derive(Debug, Clone)]
pub struct Step {
    /// INITIAL_STEP.
    pub initial: bool,
    /// Its name.
    pub name: Name,
    /// Its action associations.
    pub actions: Vec<ActionAssociation>,
    /// From STEP to END_STEP.
    pub span: Span,
}

/// `act(L, T#5s, ind1);`.
#[derive(Debug, Clone)]
pub struct ActionAssociation {
    /// The action or a BOOL variable.
    pub action: Expr,
    /// The qualifier as written; `None` means N.
    pub qualifier: Option<Name>,
    /// The duration of a timed qualifier.
    pub time: Option<Expr>,
    /// Indicator variables.
    pub indicators: Vec<Expr>,
    /// The whole association.
    pub span: Span,
}

/// A transition.
#[derive(Debug, Clone)]
pub struct Transition {
    /// Its name.
    pub name: Option<Name>,
    /// `PRIORITY := n`.
    pub priority: Option<Expr>,
    /// FROM; empty if the words are missing.
    pub from: Vec<Name>,
    /// TO.
    pub to: Vec<Name>,
    /// What must hold.
    pub condition: Condition,
    /// From TRANSITION to END_TRANSITION.
    pub span: Span,
}

/// The condition of a transition.
#[derive(Debug, Clone)]
pub enum Condition {
    /// `:= expr;`
    St(Expr),
    /// `: instructions`.
    Il(IlBody),
    /// A network that ends in an element [`Condition`](super::ElementKind::Condition), or in a variable or coil with the
    /// transition's name.
    Network(Box<Network>),
    /// What `hir::network` makes of it: statements, then the value.
    Steps(Vec<Stmt>, Expr),
}
