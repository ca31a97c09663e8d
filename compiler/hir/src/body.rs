//! The one body form: typed, resolved statements. All notations end here; nothing after it knows which it was.

use crate::defs::{PouId, VarId};
use crate::types::TypeId;
use plcc_diag::Span;
use plcc_stdlib::elem::Elem;
use plcc_stdlib::funcs::{StdFn, TextOp};
use plcc_stdlib::ops::Op;

index_vec::define_index_type! {
    /// A temporary of a body (IL's current result); lives for one call.
    pub struct TempId = u32;
}
index_vec::define_index_type! {
    /// A jump target of a body.
    pub struct LabelId = u32;
}

/// A checked body.
#[derive(Debug, Clone, Default)]
pub struct Body {
    /// In order.
    pub stmts: Vec<Stmt>,
    /// Types of the temporaries.
    pub temps: index_vec::IndexVec<TempId, TypeId>,
    /// How many labels there are.
    pub labels: u32,
}

/// A statement with its place.
#[derive(Debug, Clone)]
pub struct Stmt {
    /// What it is.
    pub kind: StmtKind,
    /// Where.
    pub span: Span,
}

/// The forms of a statement.
// A loop's bounds are large; statements stand in vectors that are walked once, boxes would only add a hop.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Clone)]
pub enum StmtKind {
    /// `target := value`; both of the same type after conversion (strings may differ in capacity).
    Assign {
        /// Where to.
        target: Place,
        /// The value.
        value: Expr,
    },
    /// A call for its effect; a function's result is dropped.
    Call(Box<Call>),
    /// An expression for its effect (a standard function called as a statement).
    Eval(Expr),
    /// Conditions are BOOL.
    If {
        /// IF and ELSIF.
        arms: Vec<(Expr, Vec<Stmt>)>,
        /// ELSE.
        otherwise: Vec<Stmt>,
    },
    /// The selector is an integer, bit string or enumeration; labels are values of its type and do not overlap.
    Case {
        /// What decides.
        selector: Expr,
        /// In order.
        arms: Vec<CaseArm>,
        /// ELSE.
        otherwise: Vec<Stmt>,
    },
    /// Counts as semantics.md \[S2\] says: all bounds evaluated once, hidden trip count.
    For {
        /// The control variable, an integer.
        var: Place,
        /// First value, of the variable's type.
        from: Expr,
        /// Last value, of the variable's type.
        to: Expr,
        /// Step, of the variable's type (a signed constant where it can be): `None` is 1. For an unsigned variable a
        /// negative constant step has the signed type of the same width.
        by: Option<Expr>,
        /// The loop.
        body: Vec<Stmt>,
    },
    /// WHILE.
    While(Expr, Vec<Stmt>),
    /// REPEAT ... UNTIL.
    Repeat(Vec<Stmt>, Expr),
    /// Leaves the innermost loop.
    Exit,
    /// Goes to the next pass of the innermost loop.
    Continue,
    /// Leaves the POU.
    Return,
    /// A jump target.
    Label(LabelId),
    /// A jump, if the condition holds; it may go backwards, then it is a loop.
    Jump(LabelId, Option<Expr>),
}

/// An arm of a CASE.
#[derive(Debug, Clone)]
pub struct CaseArm {
    /// Values from..to, both inclusive, as mathematical integers of the selector's type.
    pub labels: Vec<(i128, i128)>,
    /// Its statements.
    pub body: Vec<Stmt>,
}

/// A typed expression.
#[derive(Debug, Clone)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Its type.
    pub ty: TypeId,
    /// Where.
    pub span: Span,
}

impl Expr {
    /// Whether evaluating it may change variables: it calls a user's POU, or stores an output or ENO.
    pub fn calls(&self) -> bool {
        match &self.kind {
            ExprKind::Call(_) => true,
            ExprKind::Read(place) | ExprKind::RefOf(place) => place.calls(),
            ExprKind::Op(_, _, list) | ExprKind::Std { args: list, .. } | ExprKind::Text { args: list, .. } => {
                list.iter().any(Expr::calls)
            }
            ExprKind::AndThen(a, b) | ExprKind::OrElse(a, b) => a.calls() || b.calls(),
            ExprKind::Convert(_, _, inner) | ExprKind::Retype(inner) | ExprKind::RangeCheck { value: inner, .. } => {
                inner.calls()
            }
            ExprKind::StdCall(call) => {
                call.eno.is_some()
                    || !call.outputs.is_empty()
                    || call.en.iter().chain(call.arguments.iter().map(|(_, e)| e)).any(Expr::calls)
            }
            ExprKind::Choose { selector, choices } => selector.calls() || choices.iter().any(Expr::calls),
            ExprKind::Const(_) | ExprKind::String(_) | ExprKind::WString(_) | ExprKind::Temp(_) | ExprKind::Error => {
                false
            }
        }
    }
}

impl Place {
    /// As [`Expr::calls`], for its indices and references.
    pub fn calls(&self) -> bool {
        let root = matches!(&self.root, Root::Deref(reference) if reference.calls());
        root || self.steps.iter().any(|step| match step {
            Step::Index(indices, _) => indices.iter().any(Expr::calls),
            // The bounds are variables.
            Step::OpenIndex(indices, _) => indices.iter().any(|i| i.value.calls()),
            Step::Character { index, .. } => index.calls(),
            Step::Field(_) | Step::Member(_) | Step::Deref | Step::Bit(_) | Step::Part(..) | Step::Flags(_) => false,
        })
    }
}

/// The forms of an expression. Conversions are explicit: operands have exactly the type that an operation takes.
#[derive(Debug, Clone)]
pub enum ExprKind {
    /// Register value of an elementary type, enumeration, subrange or NULL (0).
    Const(u64),
    /// A STRING constant, Latin-1.
    String(Vec<u8>),
    /// A WSTRING constant.
    WString(Vec<u16>),
    /// The value of a variable; of an aggregate too.
    Read(Place),
    /// An operator; `elem` is the type of its operands as `stdlib::ops` counts it.
    Op(Op, Elem, Vec<Expr>),
    /// `a AND_THEN b`.
    AndThen(Box<Expr>, Box<Expr>),
    /// `a OR_ELSE b`.
    OrElse(Box<Expr>, Box<Expr>),
    /// A conversion between elementary types (`stdlib::convert`): enumerations and subranges as their base.
    Convert(Elem, Elem, Box<Expr>),
    /// The same bits under another type: enumeration and its base, alias, subrange to base.
    Retype(Box<Expr>),
    /// Faults unless low <= value <= high: assignment to a subrange; the text names the variable.
    RangeCheck {
        /// The value, an integer.
        value: Box<Expr>,
        /// Lower limit.
        low: i128,
        /// Upper limit.
        high: i128,
        /// The variable's name.
        name: String,
    },
    /// A user's function; its result.
    Call(Box<Call>),
    /// A standard function; the type variable of its row is bound to `elem`.
    Std {
        /// The row.
        func: &'static StdFn,
        /// What its type variable stands for (any elementary type if it has none).
        elem: Elem,
        /// Values of all parameters, in order.
        args: Vec<Expr>,
    },
    /// A standard function with EN, ENO or outputs.
    StdCall(Box<StdCall>),
    /// Choice number `selector` (a LINT, from 0), the last one if it is outside; all choices are evaluated. For what fits no
    /// formula: aggregates (strings may differ in capacity) and references.
    Choose {
        /// Which.
        selector: Box<Expr>,
        /// At least one.
        choices: Vec<Expr>,
    },
    /// An operation on strings or between values and text. Arguments are strings of one kind (of any capacity), LINTs for
    /// lengths and positions, BOOL for SEL.
    Text {
        /// Which.
        op: TextOp,
        /// On WSTRINGs. Of a conversion between the kinds: the result.
        wide: bool,
        /// In the order of the function's parameters.
        args: Vec<Expr>,
    },
    /// `REF(x)`, `ADR(x)`: an I32 region offset.
    RefOf(Place),
    /// A temporary.
    Temp(TempId),
    /// A mistake that was reported; never reaches MIR.
    Error,
}

/// A resolved place in memory: a root and steps into it.
#[derive(Debug, Clone)]
pub struct Place {
    /// Where it starts.
    pub root: Root,
    /// From the root inwards.
    pub steps: Vec<Step>,
    /// The type of what lies there.
    pub ty: TypeId,
    /// Where.
    pub span: Span,
}

/// Where a place starts.
#[derive(Debug, Clone)]
pub enum Root {
    /// A variable of the own POU (an action: of its owner) or a global one. A VAR_IN_OUT is followed to its variable.
    Var(VarId),
    /// A temporary of the body.
    Temp(TempId),
    /// What a reference points to; checked for NULL and bounds.
    Deref(Box<Expr>),
    /// `%MW4` used directly.
    Address(crate::defs::Address),
}

impl Place {
    /// The place as text if it is the same whenever it is reached: no variable index, no reference. `name` gives the text of a
    /// variable.
    pub fn fixed(&self, name: impl Fn(VarId) -> String) -> Option<String> {
        let mut text = match &self.root {
            Root::Var(var) => name(*var),
            Root::Address(address) => match address.bit {
                Some(bit) => format!("%{:?} byte {} bit {bit}", address.area, address.byte),
                None => format!("%{:?} byte {}", address.area, address.byte),
            },
            Root::Temp(_) | Root::Deref(_) => return None,
        };
        for step in &self.steps {
            text += &match step {
                Step::Field(n) => format!(".#{n}"),
                Step::Member(var) => format!(".{}", name(*var)),
                Step::Bit(n) => format!(".%X{n}"),
                Step::Part(elem, n) => format!(".{}{n}", elem.name()),
                Step::Index(indices, _) => {
                    let constant = |e: &Expr| match e.kind {
                        ExprKind::Const(raw) => Some((raw as i64).to_string()),
                        _ => None,
                    };
                    format!("[{}]", indices.iter().map(constant).collect::<Option<Vec<_>>>()?.join(","))
                }
                Step::Deref | Step::OpenIndex(..) | Step::Character { .. } | Step::Flags(_) => return None,
            };
        }
        Some(text)
    }
}

/// One step into a place.
#[derive(Debug, Clone)]
pub enum Step {
    /// A component of a structure: index of the field.
    Field(u32),
    /// A variable of a function block instance.
    Member(VarId),
    /// Elements, one index (LINT) per dimension; the text is the array's name for fault messages.
    Index(Vec<Expr>, String),
    /// Elements of an ARRAY [*]: an index and the actual bounds per dimension; the text is the array's name.
    OpenIndex(Vec<OpenIndex>, String),
    /// One character of a string; checked against its capacity.
    Character {
        /// Position, a LINT.
        index: Box<Expr>,
        /// The position of the first character: 1, in profile codesys 0 (there the closing 0 can be reached too).
        first: u8,
        /// The string's name for fault messages.
        name: String,
    },
    /// Follows a reference that lies here.
    Deref,
    /// Bit n of an integer or bit string.
    Bit(u8),
    /// Byte, word or double word n of a wider bit string: the elementary type and its number.
    Part(Elem, u8),
    /// From a BOOL on those that lie side by side, as one bit string of this type: not 0 if one of them is TRUE. Only charts
    /// look at their flags so.
    Flags(Elem),
}

/// A subscript of an array whose bounds its caller knows; all LINT.
#[derive(Debug, Clone)]
pub struct OpenIndex {
    /// The index.
    pub value: Expr,
    /// The actual lower bound.
    pub low: Expr,
    /// The actual upper bound.
    pub high: Expr,
}

/// A call of a user's POU.
#[derive(Debug, Clone)]
pub struct Call {
    /// What is called.
    pub callee: Callee,
    /// Values of inputs in written order; converted. A function's omitted inputs are missing and take their initial value.
    pub inputs: Vec<(VarId, Expr)>,
    /// Variables for VAR_IN_OUT.
    pub in_outs: Vec<(VarId, Place)>,
    /// Outputs that are fetched after the call.
    pub outputs: Vec<OutputArg>,
    /// EN: FALSE skips the call (semantics.md \[S6\]).
    pub en: Option<Expr>,
    /// ENO: catches faults of the call (\[E4\]).
    pub eno: Option<Eno>,
    /// Where.
    pub span: Span,
}

/// A call of a standard function that is more than a value. The arguments are evaluated into temporaries first, so that only
/// what the function itself does stands in `value` and `outputs`: that is what ENO catches (semantics.md \[S6\] \[E4\]).
#[derive(Debug, Clone)]
pub struct StdCall {
    /// EN: FALSE skips the rest; the value is its type's default, outputs keep theirs.
    pub en: Option<Expr>,
    /// Arguments, in written order.
    pub arguments: Vec<(TempId, Expr)>,
    /// The result over the temporaries; `None` if the function gives none.
    pub value: Option<Expr>,
    /// What is stored after the call: values over the temporaries, of the types of their targets.
    pub outputs: Vec<(Place, Expr)>,
    /// ENO: catches faults of the function.
    pub eno: Option<Eno>,
}

/// `ENO => target`.
#[derive(Debug, Clone)]
pub struct Eno {
    /// The BOOL variable.
    pub target: Place,
    /// `NOT ENO => target`.
    pub negated: bool,
}

/// What is called.
#[derive(Debug, Clone)]
pub enum Callee {
    /// A function.
    Function(PouId),
    /// An instance of a function block.
    Instance(Place, PouId),
    /// An action: of the instance, or (`None`) of the own one.
    Action(Option<Place>, PouId),
}

/// `name => target`.
#[derive(Debug, Clone)]
pub struct OutputArg {
    /// The output (or the result) of the callee.
    pub output: VarId,
    /// NOT before the name; BOOL only.
    pub negated: bool,
    /// The conversion from the output's elementary type to the target's; a CHAR also goes to a STRING.
    pub convert: Option<(Elem, Elem)>,
    /// Where it goes.
    pub target: Place,
}
