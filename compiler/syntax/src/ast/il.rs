//! Instruction List.

use super::{Arg, Call, Expr, Name};
use plcc_diag::Span;

/// An IL body, or what stands inside deferred parentheses.
#[derive(Debug, Clone)]
pub struct IlBody {
    /// In order.
    pub lines: Vec<IlLine>,
    /// The whole body.
    pub span: Span,
}

/// One instruction with its label; a label may stand alone.
#[derive(Debug, Clone)]
pub struct IlLine {
    /// `name:`.
    pub label: Option<Name>,
    /// The instruction.
    pub inst: Option<IlInst>,
    /// The whole line.
    pub span: Span,
}

/// The forms of an instruction. Operators are names as written: `hir` decides them by `il_operators`.
#[derive(Debug, Clone)]
pub enum IlInst {
    /// `LD x`, `NOT`, `CALC fb`, `JMP label`, `LIMIT 0, 10`: an operator or a function name with operands.
    Simple {
        /// The operator.
        op: Name,
        /// Its operands, all positional; operators take at most one.
        operands: Vec<Arg>,
    },
    /// `AND( x` ... `)`.
    Deferred {
        /// The operator.
        op: Name,
        /// The operand on the same line, if any.
        first: Option<Expr>,
        /// The lines up to the closing parenthesis.
        body: IlBody,
        /// The closing parenthesis.
        close: Span,
    },
    /// `CAL t(IN := a, Q => b)`.
    Call {
        /// `CAL`, `CALC`, `CALCN`.
        op: Name,
        /// The instance or action with its arguments.
        call: Call,
    },
    /// `LIMIT(MN := 0, IN := x, MX := 10)`: a function in formal form.
    Function(Call),
    /// What could not be parsed; reported already.
    Error,
}
