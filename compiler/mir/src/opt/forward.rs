//! A load of what was stored or loaded before is that value.
//!
//! Along every way the places are remembered whose value is known, the latest ones only: a value that is kept long costs a
//! register, and its memory is never far. Where ways meet, what all of them know stays. Loops begin with nothing.
//!
//! Inside a block the lengths of strings are known too that were just built or measured: LEN of them is that value.
//!
//! ```text
//! store i8 t.IN := v0
//! v1 = load i8 t.IN          =>    store i8 t.IN := v0
//! if v1 then b1 else b2            if v0 then b1 else b2
//! ```

use super::alias::Alias;
use super::rewrite::{Constants, Replace, writes_memory};
use crate::dominators::Dominators;
use crate::ir::{BlockId, Func, Inst, Place, ValueId};
use index_vec::IndexVec;
use plcc_stdlib::prim::Repr;
use plcc_stdlib::rt::strings::{TextFn, TextFns};

/// So many places are remembered at once.
const KNOWN: usize = 40;

/// So many instructions after its last use a value that is no constant is better read again than kept.
const LIFETIME: u32 = 64;

/// A place whose value is known.
#[derive(Debug, Clone, PartialEq)]
struct Known {
    place: Place,
    repr: Repr,
    value: ValueId,
    /// The value is a truth value, also where memory may hold any byte.
    truth: bool,
    /// When it was last read or written.
    used: u32,
}

/// A string whose length is known.
#[derive(Debug, Clone, PartialEq)]
struct Length {
    place: Place,
    capacity: u64,
    /// Bytes of it in memory, at most.
    bytes: i64,
    value: ValueId,
}

/// The pass.
pub fn run(func: &mut Func, alias: &Alias) {
    let tree = Dominators::new(func);
    let constants = Constants::new(func);
    let mut replace = Replace::new(func);
    let mut clock = 0;
    let mut lengths: Vec<Length> = Vec::new();
    let mut ends: IndexVec<BlockId, Option<Vec<Known>>> = func.blocks.iter().map(|_| None).collect();
    for &block in &tree.order {
        let mut known = start(&tree.preds[block], &ends);
        lengths.clear();
        let insts = std::mem::take(&mut func.blocks[block].insts);
        let mut out = Vec::with_capacity(insts.len());
        for mut inst in insts {
            clock += 1;
            replace.inst(&mut inst);
            if let Inst::Load { dst, place, normalise } = &inst {
                let repr = func.values[*dst];
                let found = known.iter().position(|k| {
                    k.place == *place
                        && k.repr == repr
                        // A byte that was read as a truth value may be another one in memory.
                        && (if *normalise { k.truth } else { !k.truth || place.bit.is_some() })
                        && (clock - k.used < LIFETIME || constants.get(k.value).is_some())
                });
                if let Some(n) = found {
                    let one = Known { used: clock, ..known.remove(n) };
                    replace.set(*dst, one.value);
                    known.push(one);
                    continue;
                }
            }
            if let Some(length) = known_length(&inst, &constants, &lengths)
                && let (Some(dst), _) = inst.results()
            {
                replace.set(dst, length);
                continue;
            }
            forget(func, alias, &constants, &inst, &mut known);
            if writes_memory(&inst) {
                lengths.retain(|l| !alias.may_write(func, &constants, &inst, &l.place, l.bytes));
            }
            if let Some(length) = length_of(&inst, &constants) {
                lengths.push(length);
            }
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

/// What is known at the start of a block.
fn start(preds: &[BlockId], ends: &IndexVec<BlockId, Option<Vec<Known>>>) -> Vec<Known> {
    let Some((first, rest)) = preds.split_first() else { return Vec::new() };
    let Some(mut known) = ends[*first].clone() else { return Vec::new() };
    for pred in rest {
        match &ends[*pred] {
            Some(other) => known.retain(|k| other.iter().any(|o| Known { used: k.used, ..o.clone() } == *k)),
            None => return Vec::new(),
        }
    }
    known
}

/// Forgets what an instruction may change.
fn forget(func: &Func, alias: &Alias, constants: &Constants, inst: &Inst, known: &mut Vec<Known>) {
    // The most frequent case without a detour.
    if let Inst::Store { place, value } = inst {
        let bytes = i64::from(func.values[*value].bytes());
        known.retain(|k| !alias.overlap(&k.place, i64::from(k.repr.bytes()), place, bytes));
    } else if writes_memory(inst) {
        known.retain(|k| !alias.may_write(func, constants, inst, &k.place, i64::from(k.repr.bytes())));
    }
}

/// The length of the string that an instruction builds or measures. LEN tells no more than an INT can hold, so only
/// strings that cannot be longer are known.
fn length_of(inst: &Inst, constants: &Constants) -> Option<Length> {
    let Inst::CallText { dst, func, texts, .. } = inst else { return None };
    let capacity = constants.get(texts[0].capacity).filter(|capacity| *capacity <= i16::MAX as u64)?;
    (func.builds || is_len(func)).then(|| Length {
        place: texts[0].place.clone(),
        capacity,
        bytes: 2 * (capacity as i64 + 1),
        value: *dst,
    })
}

/// What LEN of a string gives whose length is known.
fn known_length(inst: &Inst, constants: &Constants, lengths: &[Length]) -> Option<ValueId> {
    let Inst::CallText { func, texts, .. } = inst else { return None };
    let capacity = constants.get(texts[0].capacity).filter(|_| is_len(func))?;
    let known = lengths.iter().rev().find(|l| l.place == texts[0].place && l.capacity == capacity);
    known.map(|l| l.value)
}

fn is_len(func: &'static TextFn) -> bool {
    [false, true].iter().any(|wide| std::ptr::eq(func, &raw const TextFns::of(*wide).len))
}
