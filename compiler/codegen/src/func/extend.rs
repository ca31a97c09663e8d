//! Values of 8 and 16 bits that are extended where they are loaded, so that it is done once and costs nothing.

use super::*;

/// A loaded value of 8 or 16 bits in 64.
#[derive(Debug, Clone, Copy)]
pub(super) enum Extended {
    /// With copies of its sign.
    Signed(Value),
    /// With zeros.
    Zero(Value),
}

/// How a narrow value is extended where that is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Extends {
    /// Nowhere.
    Never,
    /// With its sign, nowhere with zeros; 16 bits only.
    Signed,
    /// With zeros, of 16 bits perhaps with the sign elsewhere.
    Zero,
}

/// By value of 8 or 16 bits: how it is extended. A truth value that is made of others is extended if they are.
pub(super) fn extensions(func: &Func) -> IndexVec<ValueId, Extends> {
    let mut uses: IndexVec<ValueId, Extends> = IndexVec::from_vec(vec![Extends::Never; func.values.len()]);
    for block in func.blocks.iter().rev() {
        if let Term::Switch { value, .. } = &block.term {
            uses[*value] = Extends::Zero;
        }
        for inst in block.insts.iter().rev() {
            match inst {
                Inst::Prim { op: PrimOp::Sext(_), repr: Repr::I16, args, .. } if uses[args[0]] == Extends::Never => {
                    uses[args[0]] = Extends::Signed;
                }
                Inst::Prim { op: PrimOp::Zext(_), repr: Repr::I8 | Repr::I16, args, .. } => {
                    uses[args[0]] = Extends::Zero;
                }
                Inst::Prim { dst, op, repr: Repr::I8, args } if op.is_bitwise() && uses[*dst] == Extends::Zero => {
                    args.iter().for_each(|arg| uses[*arg] = Extends::Zero);
                }
                _ => {}
            }
        }
    }
    uses
}

impl Translator<'_, '_> {
    /// Whether a load extends at once: 16 bits always, 8 if they are extended later.
    pub(super) fn is_loaded_wide(&self, dst: ValueId, place: &Place, normalise: bool) -> bool {
        let plain = place.bit.is_none() && !normalise;
        match self.func.values[dst] {
            Repr::I16 => true,
            Repr::I8 => plain && self.extensions[dst] == Extends::Zero,
            _ => false,
        }
    }

    /// Remembers what a value is in 64 bits; gives it as it is handed on.
    pub(super) fn narrow(&mut self, id: ValueId, extended: Extended) -> Value {
        let (Extended::Signed(wide) | Extended::Zero(wide)) = extended;
        self.extended.insert(id, extended);
        self.b.ins().ireduce(carrier(self.func.values[id]), wide)
    }

    /// AND, OR, XOR of bytes that are there in 64 bits.
    pub(super) fn wide_truth(&mut self, op: PrimOp, repr: Repr, args: &[ValueId]) -> Option<Value> {
        let all = |v: &ValueId| self.extended(*v, PrimOp::Zext(Repr::I64));
        if repr != Repr::I8 || !op.is_bitwise() {
            return None;
        }
        let args: Vec<Value> = args.iter().map(all).collect::<Option<_>>()?;
        Some(prim::emit(&mut self.b, op, Repr::I64, &args))
    }

    /// A value that was loaded as this extension gives it.
    pub(super) fn extended(&self, id: ValueId, op: PrimOp) -> Option<Value> {
        match (self.extended.get(&id).copied(), op) {
            (Some(Extended::Signed(wide)), PrimOp::Sext(_)) | (Some(Extended::Zero(wide)), PrimOp::Zext(_)) => {
                Some(wide)
            }
            _ => None,
        }
    }
}
