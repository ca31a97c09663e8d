//! Indices of elements that are not 1, 2, 4 or 8 bytes long are multiplied once, not at each access.
//!
//! Addresses of machines scale an index by these sizes; every other size takes a multiplication. As a value of its own it
//! is shared by the accesses to one element and leaves loops. Comes late: other passes compare places by their indices.
//!
//! ```text
//! v2 = load i16 tanks[v1]+4            v3 = mul i64 v1, 24
//! store i16 tanks[v1]+6 := v2     =>   v2 = load i16 tanks{v3}+4
//!                                      store i16 tanks{v3}+6 := v2
//! ```

use crate::ir::{Args, Func, IndexTerm, Inst, ValueId};
use crate::visit;
use plcc_stdlib::prim::{PrimOp, Repr};
use rustc_hash::FxHashMap;

/// The pass.
pub fn run(func: &mut Func) {
    for id in func.blocks.indices() {
        let insts = std::mem::take(&mut func.blocks[id].insts);
        let mut out = Vec::with_capacity(insts.len());
        let mut made: FxHashMap<(ValueId, u32), ValueId> = FxHashMap::default();
        for mut inst in insts {
            // What only a fault needs is calculated only then.
            if visit::exit(&mut inst).is_none() {
                let mut before = Vec::new();
                visit::places(&mut inst, &mut |place| {
                    for term in &mut place.index {
                        scale(term, &mut made, &mut func.values, &mut before);
                    }
                });
                out.append(&mut before);
            }
            out.push(inst);
        }
        func.blocks[id].insts = out;
    }
}

fn scale(
    term: &mut IndexTerm,
    made: &mut FxHashMap<(ValueId, u32), ValueId>,
    values: &mut index_vec::IndexVec<ValueId, Repr>,
    before: &mut Vec<Inst>,
) {
    let stride = i64::from(term.stride);
    if matches!(stride, 0 | 1 | 2 | 4 | 8) {
        return;
    }
    let (Some(low), Some(high)) = (term.low.checked_mul(stride), term.high.checked_mul(stride)) else { return };
    let value = *made.entry((term.value, term.stride)).or_insert_with(|| {
        let factor = values.push(Repr::I64);
        before.push(Inst::Const { dst: factor, raw: stride as u64 });
        let dst = values.push(Repr::I64);
        let args = Args::Two([term.value, factor]);
        before.push(Inst::Prim { dst, op: PrimOp::Mul, repr: Repr::I64, args });
        dst
    });
    *term = IndexTerm { value, stride: 1, low, high };
}
