//! Where an access is safe that the program does not do there.
//!
//! A load may be done earlier or on another way than written if it cannot leave the memory of its array. At a fixed place
//! that is certain; with an index it is where an access with the same index, within the same bounds, was done before on
//! every way: that one stood behind its check.

use crate::dominators::Dominators;
use crate::ir::{Base, BlockId, Func, Inst, Place, ValueId};
use rustc_hash::FxHashMap;

/// Accesses by the values of their indices.
pub struct Proven {
    /// Block, bounds.
    accesses: FxHashMap<ValueId, Vec<(BlockId, i64, i64)>>,
}

/// More are not remembered of one value.
const KEPT: usize = 8;

impl Proven {
    /// Of a function as it is now; what changes later must not move accesses to fewer ways.
    pub fn new(func: &Func) -> Self {
        let mut accesses: FxHashMap<ValueId, Vec<(BlockId, i64, i64)>> = FxHashMap::default();
        for (id, block) in func.blocks.iter_enumerated() {
            for inst in &block.insts {
                let (Inst::Load { place, .. } | Inst::Store { place, .. }) = inst else { continue };
                for term in &place.index {
                    let list = accesses.entry(term.value).or_default();
                    let fact = (id, term.low, term.high);
                    if list.len() < KEPT && !list.contains(&fact) {
                        list.push(fact);
                    }
                }
            }
        }
        Self { accesses }
    }

    /// Whether a load of the place is safe at the end of a block and in all that it dominates.
    pub fn is_safe(&self, place: &Place, block: BlockId, tree: &Dominators) -> bool {
        !matches!(place.base, Base::Reference(_))
            && place.index.iter().all(|term| {
                self.accesses.get(&term.value).is_some_and(|list| {
                    list.iter()
                        .any(|(at, low, high)| term.low <= *low && *high <= term.high && tree.dominates(*at, block))
                })
            })
    }
}
