//! How a formula of the standard is written down once and read by all: [`Emit`].
//!
//! A row of the operator or function table is a function over `&mut dyn Emit`. The MIR builder implements the trait by
//! appending instructions, constant evaluation implements it by computing at once, so folding and execution cannot differ.

use crate::fault::Fault;
use crate::prim::{PrimOp, Repr};
use crate::rt::RtFn;

/// A scalar in the hands of an [`Emit`]: a number that only the implementor can read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Val(pub u32);

/// Where instructions go.
pub trait Emit {
    /// A constant: the low bits of `raw`.
    fn constant(&mut self, repr: Repr, raw: u64) -> Val;

    /// One machine operation; `repr` is the representation of its operands (for `Select` that of the two choices).
    fn prim(&mut self, op: PrimOp, repr: Repr, args: &[Val]) -> Val;

    /// Faults unless `ok` (an I8, 0 or 1) is 1. `operands` (I64) are the offending values, see [`Fault`]; at most three.
    fn check(&mut self, ok: Val, fault: Fault, operands: &[Val]);

    /// A call of a pure body that is too big for a formula.
    fn call(&mut self, f: &'static RtFn, args: &[Val]) -> Val;

    /// The scan clock, I64 nanoseconds. `None` where there is no clock (constants).
    fn clock(&mut self) -> Option<Val>;

    /// Whether safety checks are wanted (`--checks`): rows may then rely on `check` instead of a total formula.
    fn checks_division(&self) -> bool {
        true
    }
}
