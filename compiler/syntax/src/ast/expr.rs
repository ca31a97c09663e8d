//! Expressions.

use super::Name;
use plcc_diag::Span;
use smol_str::SmolStr;

/// How deep an expression, a type or an initialiser may nest: passes over the tree recurse, and a stack is finite.
pub const MAX_DEPTH: u32 = 4000;

/// An expression with its place.
#[derive(Debug, Clone)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where, parentheses included.
    pub span: Span,
    /// Nodes on the longest way to a leaf; at most [`MAX_DEPTH`], the parser reports and cuts deeper ones.
    pub depth: u32,
    /// Stands in parentheses of its own (`(a = b)`), for lints and printing.
    pub parens: bool,
}

/// The forms of an expression.
#[derive(Debug, Clone)]
pub enum ExprKind {
    /// A literal.
    Literal(Literal),
    /// A name alone.
    Name(Name),
    /// `Color#Red`: a value of a named enumeration. (`INT#5` is a literal.)
    Qualified {
        /// The type.
        ty: Name,
        /// The value.
        value: Name,
    },
    /// `%IX0.0`, as written.
    Address(SmolStr),
    /// `a.b`.
    Member(Box<Expr>, Name),
    /// `w.3`, `d.%X31`, `d.%B0`: the text after the dot.
    Part(Box<Expr>, Name),
    /// `a[i, j]`.
    Index(Box<Expr>, Vec<Expr>),
    /// `p^`.
    Deref(Box<Expr>),
    /// `f(...)`, `fb.act(...)`.
    Call(Box<Call>),
    /// `-x`, `+x`, `NOT x`.
    Unary(UnaryOp, Box<Expr>),
    /// `a + b`. The span is that of the operator token.
    Binary(BinaryOp, Span, Box<Expr>, Box<Expr>),
    /// What could not be parsed; reported already.
    Error,
}

/// Prefix operators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum UnaryOp {
    Neg,
    Plus,
    Not,
}

/// Infix operators, by precedence (semantics.md \[S1\]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum BinaryOp {
    Power,
    Mul,
    Div,
    Mod,
    Add,
    Sub,
    Lt,
    Gt,
    Le,
    Ge,
    Eq,
    Ne,
    And,
    AndThen,
    Xor,
    Or,
    OrElse,
}

impl BinaryOp {
    /// As it is written.
    pub fn text(self) -> &'static str {
        use BinaryOp::*;
        match self {
            Power => "**",
            Mul => "*",
            Div => "/",
            Mod => "MOD",
            Add => "+",
            Sub => "-",
            Lt => "<",
            Gt => ">",
            Le => "<=",
            Ge => ">=",
            Eq => "=",
            Ne => "<>",
            And => "AND",
            AndThen => "AND_THEN",
            Xor => "XOR",
            Or => "OR",
            OrElse => "OR_ELSE",
        }
    }

    /// How much it binds (semantics.md \[S1\]); operators of one level group from the left.
    pub fn precedence(self) -> u8 {
        use BinaryOp::*;
        match self {
            Or | OrElse => 1,
            Xor => 2,
            And | AndThen => 3,
            Eq | Ne => 4,
            Lt | Gt | Le | Ge => 5,
            Add | Sub => 6,
            Mul | Div | Mod => 7,
            Power => 8,
        }
    }
}

/// A literal as written: values come from the type at its place (`stdlib::literal`).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Literal {
    /// Which form.
    pub kind: LiteralKind,
    /// `INT` of `INT#5`; an elementary type or the name of a user's subrange or alias.
    pub prefix: Option<Name>,
    /// The rest as written: digits with `_`, `16#FF`, `1d2h`, `'text'` with its quotes.
    /// For durations and dates without the keyword and `#`, which is in `prefix`.
    pub text: SmolStr,
}

/// The forms of a literal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LiteralKind {
    /// `12`, `1_000`.
    Integer,
    /// `16#FF`, `8#17`, `2#1010`.
    Based,
    /// `1.5`, `1e6` (a digit stands after a point).
    Real,
    /// `TRUE`, `FALSE`.
    Bool,
    /// `T#1d2h`, `LTIME#5us`: prefix `T`, `TIME`, `LT`, `LTIME`.
    Duration,
    /// `D#2024-01-31`, `TOD#12:00:00`, `DT#...` and the long forms: prefix tells which.
    Date,
    /// `'text'`.
    String,
    /// `"text"`.
    WString,
    /// `NULL`.
    Null,
}

/// A call in ST, or in IL in formal form.
#[derive(Debug, Clone)]
pub struct Call {
    /// What is called: a name, or a path to an instance or an action.
    pub callee: Expr,
    /// In written order.
    pub args: Vec<Arg>,
    /// From `(` to `)`.
    pub parens: Span,
}

/// One argument.
#[derive(Debug, Clone)]
pub struct Arg {
    /// Which form.
    pub kind: ArgKind,
    /// The whole argument.
    pub span: Span,
}

/// The forms of an argument.
#[derive(Debug, Clone)]
pub enum ArgKind {
    /// `expr`.
    Positional(Expr),
    /// `name := expr`. An empty one (`name :=`) is `None`: it counts as not connected.
    Input(Name, Option<Expr>),
    /// `name => target`, `NOT name => target`; an empty target is `None`.
    Output {
        /// NOT before the name.
        negated: bool,
        /// The output.
        name: Name,
        /// Where it goes.
        target: Option<Expr>,
    },
}
