//! Ladder Diagram and Function Block Diagram: what was drawn. Elements with their pins; connections stand at the pins that
//! they end in and name where they begin, as in PLCopen TC6 XML. `hir::network` gives them an order.

use super::{Edge, Expr, Name};
use plcc_diag::Span;
use smol_str::SmolStr;

/// A body in Ladder Diagram or Function Block Diagram, or the part of a chart that feeds the condition of a transition.
#[derive(Debug, Clone)]
pub struct Network {
    /// Which rules hold.
    pub notation: Notation,
    /// In the order of the file.
    pub elements: Vec<Element>,
    /// The whole body.
    pub span: Span,
}

/// The notation of a network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Notation {
    /// Function Block Diagram.
    Fbd,
    /// Ladder Diagram: several connections into one pin are OR-ed.
    Ld,
}

/// Something drawn.
#[derive(Debug, Clone)]
pub struct Element {
    /// `localId`, which connections name.
    pub id: u64,
    /// What it is.
    pub kind: ElementKind,
    /// Its upper left corner.
    pub position: Point,
    /// Width and height; zero where the file says nothing.
    pub size: Point,
    /// `executionOrderId`, if it is given and not 0.
    pub order: Option<u64>,
    /// Where connections end, in the order of the file. Contacts, coils, variables and the like have one without a name.
    pub inputs: Vec<Pin>,
    /// Where connections begin.
    pub outputs: Vec<Pin>,
    /// Its start tag.
    pub span: Span,
}

/// A place in the drawing, in the units of the file; y grows downwards.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Point {
    /// To the right.
    pub x: f64,
    /// Downwards.
    pub y: f64,
}

/// The kinds of element.
#[derive(Debug, Clone)]
pub enum ElementKind {
    /// The left power rail, always TRUE.
    LeftRail,
    /// The right power rail, which takes anything.
    RightRail,
    /// Passes power while its variable is TRUE (or FALSE, or has an edge).
    Contact {
        /// A BOOL.
        variable: Expr,
        /// How it is read.
        modifier: Modifier,
    },
    /// Gives power to its variable.
    Coil {
        /// A BOOL.
        variable: Expr,
        /// How it is written.
        modifier: Modifier,
    },
    /// A function, or with an instance a function block.
    Block {
        /// `typeName`.
        ty: Name,
        /// `instanceName`.
        instance: Option<Expr>,
    },
    /// A variable or expression that is read.
    In {
        /// What is read.
        value: Expr,
        /// How it is read.
        modifier: Modifier,
    },
    /// A variable that is written.
    Out {
        /// What is written.
        target: Expr,
        /// How it is written.
        modifier: Modifier,
    },
    /// A variable that is written, then read.
    InOut {
        /// The variable.
        variable: Expr,
        /// `negatedIn`.
        negated_in: bool,
        /// `negatedOut`.
        negated_out: bool,
    },
    /// The end of a line that goes on at a continuation of the same name.
    Connector(Name),
    /// Where it goes on.
    Continuation(Name),
    /// A jump target.
    Label(Name),
    /// A jump while its input is TRUE.
    Jump(Name),
    /// Leaves the POU while its input is TRUE.
    Return,
    /// The condition of a transition, which takes one BOOL.
    Condition,
    /// A remark.
    Comment(String),
}

/// How a value is changed where it is read or written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Modifier {
    /// Inverted.
    pub negated: bool,
    /// Only TRUE at an edge.
    pub edge: Option<Edge>,
    /// Written only while it is TRUE.
    pub storage: Option<Storage>,
}

/// What a set or reset coil does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    /// Writes TRUE.
    Set,
    /// Writes FALSE.
    Reset,
}

/// An input or output of an element.
#[derive(Debug, Clone)]
pub struct Pin {
    /// `formalParameter`; empty where there is none.
    pub name: SmolStr,
    /// Where on the element, from its upper left corner.
    pub at: Point,
    /// How the value is changed on its way.
    pub modifier: Modifier,
    /// It stands among the `inOutVariables`.
    pub in_out: bool,
    /// What leads here; outputs have none.
    pub connections: Vec<Connection>,
    /// What stands at the pin itself: at an input the value, at an output the variable that takes it.
    pub operand: Option<Expr>,
    /// Where it is written.
    pub span: Span,
}

/// A line, from the element where it begins.
#[derive(Debug, Clone)]
pub struct Connection {
    /// `refLocalId` of the element where it begins.
    pub from: u64,
    /// The output's name, if it is given.
    pub pin: Option<SmolStr>,
    /// Its corners, from the end to the beginning.
    pub path: Vec<Point>,
    /// Where it is written.
    pub span: Span,
}

impl Element {
    /// How messages name it: kind and name, local id and position.
    pub fn describe(&self) -> String {
        let kind = match &self.kind {
            ElementKind::LeftRail => "left power rail".into(),
            ElementKind::RightRail => "right power rail".into(),
            ElementKind::Contact { variable, .. } => format!("contact `{}`", super::source::expression(variable)),
            ElementKind::Coil { variable, .. } => format!("coil `{}`", super::source::expression(variable)),
            ElementKind::Block { ty, instance: None } => format!("block `{}`", ty.text),
            ElementKind::Block { ty, instance: Some(i) } => {
                format!("block `{}` ({})", super::source::expression(i), ty.text)
            }
            ElementKind::In { value: e, .. }
            | ElementKind::Out { target: e, .. }
            | ElementKind::InOut { variable: e, .. } => format!("variable `{}`", super::source::expression(e)),
            ElementKind::Connector(name) => format!("connector `{}`", name.text),
            ElementKind::Continuation(name) => format!("continuation `{}`", name.text),
            ElementKind::Label(name) => format!("label `{}`", name.text),
            ElementKind::Jump(name) => format!("jump to `{}`", name.text),
            ElementKind::Return => "return".into(),
            ElementKind::Condition => "condition".into(),
            ElementKind::Comment(_) => "comment".into(),
        };
        format!("{kind}, local id {} at ({}, {})", self.id, self.position.x, self.position.y)
    }
}
