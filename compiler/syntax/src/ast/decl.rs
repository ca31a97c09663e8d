//! Declarations: POUs, variables, types, initialisers.

use super::{Expr, IlBody, Name, Network, SfcBody, Stmt};
use plcc_diag::Span;
use smol_str::SmolStr;

/// A program organisation unit.
#[derive(Debug, Clone)]
pub struct Pou {
    /// Which.
    pub kind: PouKind,
    /// Its name.
    pub name: Name,
    /// The result type of a FUNCTION; `None` if it has none (or it is missing, which `hir` judges).
    pub result: Option<TypeExpr>,
    /// Variable sections in order.
    pub sections: Vec<VarSection>,
    /// ACTION blocks that stand in it (in SFC bodies too: they are collected here).
    pub actions: Vec<Action>,
    /// The body.
    pub body: Body,
    /// From the opening to the END word.
    pub span: Span,
}

/// Kinds of POU.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum PouKind {
    Program,
    FunctionBlock,
    Function,
}

/// `ACTION name : ... END_ACTION`.
#[derive(Debug, Clone)]
pub struct Action {
    /// `Pou` of `ACTION Pou.Name`.
    pub owner: Option<Name>,
    /// Its name.
    pub name: Name,
    /// Its body.
    pub body: Body,
    /// From ACTION to END_ACTION.
    pub span: Span,
}

/// A body in one of the notations.
#[derive(Debug, Clone)]
pub enum Body {
    /// Structured Text; also the empty body.
    St(Vec<Stmt>),
    /// Instruction List.
    Il(IlBody),
    /// Sequential Function Chart.
    Sfc(SfcBody),
    /// Ladder Diagram or Function Block Diagram; `hir::network` makes Structured Text of it before anything is checked.
    Network(Network),
}

/// `VAR ... END_VAR`.
#[derive(Debug, Clone)]
pub struct VarSection {
    /// Which.
    pub kind: SectionKind,
    /// CONSTANT, RETAIN ... behind the keyword.
    pub qualifiers: Vec<(Qualifier, Span)>,
    /// The declarations.
    pub vars: Vec<VarDecl>,
    /// From VAR to END_VAR.
    pub span: Span,
}

/// Kinds of variable section.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum SectionKind {
    Var,
    Input,
    Output,
    InOut,
    External,
    Global,
    Temp,
    /// VAR_CONFIG; its declarations name instance paths.
    Config,
    /// VAR_ACCESS; its declarations name what they give access to.
    Access,
}

impl SectionKind {
    /// The keyword that opens it.
    pub fn keyword(self) -> &'static str {
        match self {
            SectionKind::Var => "VAR",
            SectionKind::Input => "VAR_INPUT",
            SectionKind::Output => "VAR_OUTPUT",
            SectionKind::InOut => "VAR_IN_OUT",
            SectionKind::External => "VAR_EXTERNAL",
            SectionKind::Global => "VAR_GLOBAL",
            SectionKind::Temp => "VAR_TEMP",
            SectionKind::Config => "VAR_CONFIG",
            SectionKind::Access => "VAR_ACCESS",
        }
    }
}

/// Words behind a section keyword.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Qualifier {
    Constant,
    Retain,
    NonRetain,
    Persistent,
    /// PUBLIC PRIVATE PROTECTED INTERNAL: read, without meaning here.
    Access,
}

/// `a, b AT %QX0.0 : BOOL R_EDGE := TRUE;`
#[derive(Debug, Clone)]
pub struct VarDecl {
    /// What is declared. In VAR_CONFIG and VAR_ACCESS the first name may be followed by a path.
    pub names: Vec<Name>,
    /// VAR_CONFIG: the path behind the first name (`Res.P1.x`: names `Res`, path `P1`, `x`).
    /// VAR_ACCESS: the path to which access is given.
    pub path: Vec<Name>,
    /// The address after AT, as written.
    pub at: Option<(SmolStr, Span)>,
    /// The type.
    pub ty: TypeExpr,
    /// R_EDGE or F_EDGE.
    pub edge: Option<(Edge, Span)>,
    /// READ_WRITE or READ_ONLY of VAR_ACCESS.
    pub read_write: Option<bool>,
    /// The initial value.
    pub init: Option<Init>,
    /// The whole declaration.
    pub span: Span,
}

/// Edge declarations of inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Edge {
    Rising,
    Falling,
}

/// `Name : type := init;` in a TYPE block.
#[derive(Debug, Clone)]
pub struct TypeDecl {
    /// Its name.
    pub name: Name,
    /// What it is.
    pub ty: TypeExpr,
    /// The type's own initial value.
    pub init: Option<Init>,
    /// The whole declaration.
    pub span: Span,
}

/// A type as written.
#[derive(Debug, Clone)]
pub struct TypeExpr {
    /// What it is.
    pub kind: TypeExprKind,
    /// Where.
    pub span: Span,
    /// See [`Expr::depth`](super::Expr).
    pub depth: u32,
}

/// The forms of a type.
#[derive(Debug, Clone)]
pub enum TypeExprKind {
    /// An elementary type, a user's type or a function block.
    Named(Name),
    /// `STRING`, `STRING[20]`, `WSTRING(20)`.
    String {
        /// WSTRING.
        wide: bool,
        /// The capacity.
        length: Option<Box<Expr>>,
    },
    /// `ARRAY [1..3, 0..n] OF T`.
    Array {
        /// One per dimension.
        dims: Vec<Dim>,
        /// The element type.
        elem: Box<TypeExpr>,
    },
    /// `STRUCT ... END_STRUCT`.
    Struct(Vec<VarDecl>),
    /// `UNION ... END_UNION`.
    Union(Vec<VarDecl>),
    /// `(Red, Green := 5)`, `INT (A, B)`, `(A, B) INT`.
    Enum {
        /// The base type.
        base: Option<Name>,
        /// The values in order.
        values: Vec<EnumValue>,
    },
    /// `INT (1..10)`.
    Subrange {
        /// The base type.
        base: Name,
        /// Lower bound.
        low: Box<Expr>,
        /// Upper bound.
        high: Box<Expr>,
    },
    /// `REF_TO T`, `POINTER TO T`, `REFERENCE TO T`.
    Ref {
        /// Which word.
        kind: RefKind,
        /// The target type.
        target: Box<TypeExpr>,
    },
    /// That of the expression, or of the first value that is assigned: what `hir::network` declares for a connection.
    Inferred(Option<Box<Expr>>),
    /// What could not be parsed; reported already.
    Error,
}

/// Words that make a reference type.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum RefKind {
    RefTo,
    PointerTo,
    ReferenceTo,
}

impl RefKind {
    /// The words before the target type.
    pub fn keyword(self) -> &'static str {
        match self {
            RefKind::RefTo => "REF_TO",
            RefKind::PointerTo => "POINTER TO",
            RefKind::ReferenceTo => "REFERENCE TO",
        }
    }
}

/// One dimension of an array.
#[derive(Debug, Clone)]
pub enum Dim {
    /// `1..10`.
    Range(Expr, Expr),
    /// `*`.
    Any(Span),
}

/// A value of an enumeration.
#[derive(Debug, Clone)]
pub struct EnumValue {
    /// Its name.
    pub name: Name,
    /// Its number, if written.
    pub value: Option<Expr>,
}

/// An initial value as written.
#[derive(Debug, Clone)]
pub struct Init {
    /// Which form.
    pub kind: InitKind,
    /// Where.
    pub span: Span,
}

/// The forms of an initial value.
#[derive(Debug, Clone)]
pub enum InitKind {
    /// `expr`.
    Expr(Expr),
    /// `REF= variable`, of a REFERENCE TO.
    Reference(Expr),
    /// `[3(0), 2(1, 2), 7]`; without brackets as in Ed. 2 (`bracketed` is then false).
    Array {
        /// Whether it stood in brackets.
        bracketed: bool,
        /// The elements in order.
        elems: Vec<InitElem>,
    },
    /// `(a := 1, b := [1, 2])`, for structures and function block instances.
    Struct(Vec<(Name, Init)>),
}

impl InitKind {
    /// What stands before it in a declaration.
    pub fn sign(&self) -> &'static str {
        if matches!(self, InitKind::Reference(_)) { "REF=" } else { ":=" }
    }
}

/// One element, or several equal groups, of an array initialiser.
#[derive(Debug, Clone)]
pub enum InitElem {
    /// A value.
    One(Init),
    /// `count(values)`; `count()` leaves that many elements at their default.
    Repeat(Expr, Vec<Init>),
}
