//! A load of what was stored or loaded before is that value.
//!
//! Along every way the places are remembered whose value is known, the latest ones only: a value that is kept long costs a
//! register, and its memory is never far. Where ways meet, what all of them know stays; if they know different values of a
//! place and it is read right behind, the block gets a parameter. Loops begin with nothing.
//!
//! ```text
//! store i8 t.IN := v0
//! v1 = load i8 t.IN          =>    store i8 t.IN := v0
//! if v1 then b1 else b2            if v0 then b1 else b2
//! ```

use super::alias::Alias;
use super::rewrite::{Constants, Replace, common, writes_memory};
use crate::dominators::Dominators;
use crate::ir::{Block, BlockId, Func, Inst, Place, ValueId};
use crate::visit;
use index_vec::IndexVec;
use plcc_stdlib::prim::Repr;

/// So many places are remembered at once.
const KNOWN: usize = 40;

/// So many instructions after its last use a value that is no constant is better read again than kept.
const LIFETIME: u32 = 64;

/// A place whose value is known.
#[derive(Debug, Clone)]
struct Known {
    place: Place,
    repr: Repr,
    value: ValueId,
    /// The value is a truth value, also where memory may hold any byte.
    truth: bool,
    /// When it was last read or written.
    used: u32,
}

impl Known {
    /// Whether another one says the same.
    fn says(&self, other: &Self) -> bool {
        (self.value, self.repr, self.truth) == (other.value, other.repr, other.truth) && self.place == other.place
    }

    /// Whether a load gives this value.
    fn gives(&self, place: &Place, repr: Repr, normalise: bool) -> bool {
        // A byte that was read as a truth value may be another one in memory.
        let truth = if normalise { self.truth } else { !self.truth || place.bit.is_some() };
        self.place == *place && self.repr == repr && truth
    }
}

/// A place whose value every predecessor knows, each another one.
struct Meeting {
    known: Known,
    /// By predecessor.
    values: Vec<ValueId>,
}

/// The pass.
pub fn run(func: &mut Func, alias: &Alias) {
    let tree = Dominators::new(func);
    let constants = Constants::new(func);
    let mut replace = Replace::new(func);
    let mut clock = 0;
    let mut ends: IndexVec<BlockId, Option<Vec<Known>>> = func.blocks.iter().map(|_| None).collect();
    for &block in &tree.order {
        let preds = &tree.preds[block];
        let mut known = common(preds, &ends, |k, other| k.says(other));
        let mut meetings = meetings(&func.blocks[block], preds, &ends);
        let insts = std::mem::take(&mut func.blocks[block].insts);
        let mut out = Vec::with_capacity(insts.len());
        for mut inst in insts {
            clock += 1;
            replace.inst(&mut inst);
            if let Inst::Load { dst, place, normalise } = &inst {
                let repr = func.values[*dst];
                let fresh = |k: &Known| clock - k.used < LIFETIME;
                let found = known
                    .iter()
                    .position(|k| k.gives(place, repr, *normalise) && (fresh(k) || constants.get(k.value).is_some()));
                if let Some(n) = found {
                    let one = Known { used: clock, ..known.remove(n) };
                    replace.set(*dst, one.value);
                    known.push(one);
                    continue;
                }
                let met = meetings.iter().position(|m| m.known.gives(place, repr, *normalise) && fresh(&m.known));
                if let Some(n) = met {
                    let one = meetings.swap_remove(n);
                    let value = join(func, block, preds, &one.values, repr);
                    replace.set(*dst, value);
                    known.push(Known { value, used: clock, ..one.known });
                    continue;
                }
            }
            forget(func, alias, &constants, &inst, &mut known, |k| k);
            forget(func, alias, &constants, &inst, &mut meetings, |m| &m.known);
            match &inst {
                Inst::Load { dst, place, normalise } => {
                    let truth = *normalise || place.bit.is_some();
                    known.push(Known {
                        place: place.clone(),
                        repr: func.values[*dst],
                        value: *dst,
                        truth,
                        used: clock,
                    });
                }
                Inst::Store { place, value } => {
                    // What is stored as a truth value is one; other bytes are not normalised when they are read back.
                    let truth = place.bit.is_some();
                    known.push(Known {
                        place: place.clone(),
                        repr: func.values[*value],
                        value: *value,
                        truth,
                        used: clock,
                    });
                }
                _ => {}
            }
            if known.len() > KNOWN {
                known.remove(0);
            }
            out.push(inst);
        }
        func.blocks[block].insts = out;
        ends[block] = Some(known);
    }
    replace.apply(func);
}

/// What all ways into a block know, but differently, of places that it reads.
fn meetings(block: &Block, preds: &[BlockId], ends: &IndexVec<BlockId, Option<Vec<Known>>>) -> Vec<Meeting> {
    let Some((first, rest)) = preds.split_first().filter(|(_, rest)| !rest.is_empty()) else { return Vec::new() };
    let Some(known) = &ends[*first] else { return Vec::new() };
    let reads = |place: &Place| {
        block.insts.iter().any(|inst| matches!(inst, Inst::Load { place: other, .. } if other == place))
    };
    let meeting = |k: &Known| {
        let mut values = vec![k.value];
        for pred in rest {
            let same = |o: &&Known| o.place == k.place && o.repr == k.repr && o.truth == k.truth;
            values.push(ends[*pred].as_ref()?.iter().rev().find(same)?.value);
        }
        values.iter().any(|v| *v != k.value).then(|| Meeting { known: k.clone(), values })
    };
    known.iter().filter(|k| reads(&k.place)).filter_map(meeting).collect()
}

/// A new parameter of a block, with its value from each predecessor.
pub(super) fn join(func: &mut Func, block: BlockId, preds: &[BlockId], values: &[ValueId], repr: Repr) -> ValueId {
    let param = func.values.push(repr);
    func.blocks[block].params.push(param);
    for (n, pred) in preds.iter().enumerate() {
        if preds[..n].contains(pred) {
            continue;
        }
        visit::targets(&mut func.blocks[*pred].term, &mut |target| {
            if target.block == block {
                target.args.push(values[n]);
            }
        });
    }
    param
}

/// Forgets what an instruction may change.
fn forget<T>(
    func: &Func,
    alias: &Alias,
    constants: &Constants,
    inst: &Inst,
    list: &mut Vec<T>,
    known: impl Fn(&T) -> &Known,
) {
    // The most frequent case without a detour.
    if let Inst::Store { place, value } = inst {
        let bytes = i64::from(func.values[*value].bytes());
        list.retain(|k| !alias.overlap(&known(k).place, i64::from(known(k).repr.bytes()), place, bytes));
    } else if writes_memory(inst) {
        list.retain(|k| {
            let k = known(k);
            !alias.may_write(func, constants, inst, &k.place, i64::from(k.repr.bytes()))
        });
    }
}
