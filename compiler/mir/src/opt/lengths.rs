//! The length of a string that was just built or measured is known: LEN of it is that value.
//!
//! What is put together in several statements, `line := CONCAT(line, ...)`, is not searched for its end each time. Along every
//! way the strings are remembered whose length is known and that were not written since; where ways meet that know different
//! lengths of one that is measured somewhere, the block gets a parameter. Loops begin with nothing. LEN tells no more than an
//! INT can hold, so only strings that cannot be longer are known.
//!
//! ```text
//! v2 = call put(line[v0], x[v1], v9)          v2 = call put(line[v0], x[v1], v9)
//! v3 = call len(line[v0])               =>    v4 = call whole(line[v0], v2, v8)
//! v4 = call whole(line[v0], v3, v8)
//! ```

use super::alias::Alias;
use super::forward::join;
use super::rewrite::{Constants, Replace, common, writes_memory};
use crate::dominators::Dominators;
use crate::ir::{BlockId, Func, Inst, Place, ValueId};
use index_vec::IndexVec;
use plcc_stdlib::prim::Repr;
use plcc_stdlib::rt::strings::{TextFn, TextFns};

/// So many strings are remembered at once.
const KNOWN: usize = 16;

/// A string whose length is known.
#[derive(Debug, Clone)]
struct Length {
    place: Place,
    capacity: u64,
    /// Bytes of it in memory, at most.
    bytes: i64,
    value: ValueId,
}

impl Length {
    fn is_of(&self, other: &Length) -> bool {
        self.place == other.place && self.capacity == other.capacity && self.bytes == other.bytes
    }
}

/// The pass.
pub fn run(func: &mut Func, alias: &Alias) {
    let constants = Constants::new(func);
    let insts = func.blocks.iter().flat_map(|b| &b.insts);
    let measured: Vec<Length> =
        insts.filter(|inst| measures(inst)).filter_map(|inst| length_of(inst, &constants)).collect();
    if measured.is_empty() {
        return;
    }
    let tree = Dominators::new(func);
    let mut replace = Replace::new(func);
    let mut ends: IndexVec<BlockId, Option<Vec<Length>>> = func.blocks.iter().map(|_| None).collect();
    for &block in &tree.order {
        let preds = &tree.preds[block];
        let mut known = common(preds, &ends, |a, b| a.is_of(b));
        known.retain_mut(|one| {
            let values: Vec<ValueId> = preds
                .iter()
                .filter_map(|pred| ends[*pred].as_ref()?.iter().rev().find(|l| l.is_of(one)).map(|l| l.value))
                .collect();
            if values.iter().all(|v| *v == values[0]) {
                return true;
            }
            if values.len() < preds.len() || !measured.iter().any(|m| m.is_of(one)) {
                return false;
            }
            one.value = join(func, block, preds, &values, Repr::I64);
            true
        });
        let insts = std::mem::take(&mut func.blocks[block].insts);
        let mut out = Vec::with_capacity(insts.len());
        for mut inst in insts {
            replace.inst(&mut inst);
            let length = length_of(&inst, &constants);
            if let (Some(length), true) = (&length, measures(&inst))
                && let Some(one) = known.iter().rev().find(|l| l.is_of(length))
            {
                replace.set(length.value, one.value);
                continue;
            }
            if writes_memory(&inst) {
                known.retain(|l| !alias.may_write(func, &constants, &inst, &l.place, l.bytes));
            }
            if let Some(length) = length {
                known.push(length);
                if known.len() > KNOWN {
                    known.remove(0);
                }
            }
            out.push(inst);
        }
        func.blocks[block].insts = out;
        ends[block] = Some(known);
    }
    replace.apply(func);
}

/// The length of the string that an instruction builds or measures.
fn length_of(inst: &Inst, constants: &Constants) -> Option<Length> {
    let Inst::CallText { dst, func, texts, .. } = inst else { return None };
    let capacity = constants.get(texts[0].capacity).filter(|capacity| *capacity <= i16::MAX as u64)?;
    (func.builds || is_len(func)).then(|| Length {
        place: texts[0].place.clone(),
        capacity,
        bytes: i64::from(func.unit_bytes(0)) * (capacity as i64 + 1),
        value: *dst,
    })
}

fn measures(inst: &Inst) -> bool {
    matches!(inst, Inst::CallText { func, .. } if is_len(func))
}

fn is_len(func: &'static TextFn) -> bool {
    [false, true].iter().any(|wide| std::ptr::eq(func, &raw const TextFns::of(*wide).len))
}
