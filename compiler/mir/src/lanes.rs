//! What a machine with registers of 16 bytes does to several values at once, each as if it were alone.
//!
//! The optimiser puts such work side by side ([`opt`](crate::opt), `jam`), code generation makes one instruction of it. Only
//! what gives the same bits for each lane is listed.

use plcc_stdlib::prim::{PrimOp, Repr};

/// Bytes of such a register.
pub const WIDTH: usize = 16;

/// How many values of a representation lie side by side; `None` if such values are not worked on in lanes.
pub fn count(repr: Repr) -> Option<usize> {
    match repr {
        Repr::F32 | Repr::F64 | Repr::I32 | Repr::I64 => Some(WIDTH / repr.bytes() as usize),
        Repr::I8 | Repr::I16 => None,
    }
}

/// What an operation gives in lanes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gives {
    /// Values of the result's representation.
    Values,
    /// Truth values, as wide as the operands.
    Mask,
}

/// Whether an operation on operands of `repr` is done in lanes, the operands all in lanes or the same for each.
pub fn operation(op: PrimOp, repr: Repr) -> Option<Gives> {
    use PrimOp::*;
    count(repr)?;
    match (op, repr) {
        (FAdd | FSub | FMul | FDiv | FNeg | FAbs | FSqrt, _) | (Add | Sub | And | Or | Xor | Neg | Not, _) => {
            Some(Gives::Values)
        }
        (Mul | MinS | MaxS | MinU | MaxU, Repr::I32) | (Select, _) => Some(Gives::Values),
        (FEq | FNe | FLt | FLe, _) | (Eq | Ne | LtS | LeS, Repr::I32) => Some(Gives::Mask),
        _ => None,
    }
}

/// Whether an operation joins two masks.
pub fn joins_masks(op: PrimOp, repr: Repr) -> bool {
    repr == Repr::I8 && matches!(op, PrimOp::And | PrimOp::Or)
}
