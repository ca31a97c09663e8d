//! An [`Emit`] that computes at once: for constant expressions, and for tests of the formulas.

use crate::emit::{Emit, Val};
use crate::fault::Fault;
use crate::prim::{self, PrimOp, Repr};
use crate::rt::RtFn;

/// Computes what is emitted. After a failed [`Emit::check`] the values that follow mean nothing; the first failure is kept.
#[derive(Debug, Default)]
pub struct Folder {
    values: Vec<u64>,
    fault: Option<(Fault, [i64; 3])>,
}

impl Folder {
    /// Nothing computed yet.
    pub fn new() -> Folder {
        Folder::default()
    }

    /// A register value as an operand.
    pub fn value(&mut self, raw: u64) -> Val {
        self.values.push(raw);
        Val((self.values.len() - 1) as u32)
    }

    /// The register value behind an operand.
    pub fn raw(&self, v: Val) -> u64 {
        self.values.get(v.0 as usize).copied().unwrap_or(0)
    }

    /// The first check that failed, with its offending values.
    pub fn fault(&self) -> Option<(Fault, [i64; 3])> {
        self.fault
    }
}

impl Emit for Folder {
    fn constant(&mut self, repr: Repr, raw: u64) -> Val {
        self.value(raw & repr.mask())
    }

    fn prim(&mut self, op: PrimOp, repr: Repr, args: &[Val]) -> Val {
        debug_assert!(op.accepts(repr) && args.len() == op.arity(), "{op:?} {repr:?} {args:?}");
        let mut raw = [0; 3];
        for (slot, v) in raw.iter_mut().zip(args) {
            *slot = self.raw(*v);
        }
        self.value(prim::eval(op, repr, &raw))
    }

    fn check(&mut self, ok: Val, fault: Fault, operands: &[Val]) {
        if self.raw(ok) & 1 == 1 || self.fault.is_some() {
            return;
        }
        let mut values = [0; 3];
        for (slot, v) in values.iter_mut().zip(operands) {
            *slot = self.raw(*v) as i64;
        }
        self.fault = Some((fault, values));
    }

    fn call(&mut self, f: &'static RtFn, args: &[Val]) -> Val {
        let raw: Vec<u64> = args.iter().map(|v| self.raw(*v)).collect();
        self.value((f.eval)(&raw))
    }

    fn clock(&mut self) -> Option<Val> {
        None
    }
}
