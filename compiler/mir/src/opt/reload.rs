//! What a loop would keep in the stack, for want of registers, is read where it is needed.
//!
//! A variable that a loop only reads is loaded before it and held ([`promote`](super::promote), [`hoist`](super::hoist)). If
//! the loop holds more values than a machine has registers, the register allocator moves some of them to the stack and back
//! in every pass. Such a variable lies in memory already: each block that needs it loads it from there.
//!
//! ```text
//! b1: v1 = load i8 ready; jump b2            b1: jump b2
//! b2: ...; store i8 station.ready := v1  =>  b2: ...; v3 = load i8 ready; store i8 station.ready := v3
//! b3: if v1 then b4 else b5                  b3: v4 = load i8 ready; if v4 then b4 else b5
//! ```

use super::alias::Alias;
use super::loops::{self, Loop};
use super::rewrite::{Constants, writes_memory};
use crate::dominators::Dominators;
use crate::ir::{Base, BlockId, Func, Inst, ValueId};
use crate::visit;
use index_vec::IndexVec;
use rustc_hash::{FxHashMap, FxHashSet};

/// So many integers are held without hesitation: the registers of x86-64 less those of the stack, the memory and what a
/// statement needs meanwhile.
const HELD: usize = 10;

/// A loop of more instructions is left alone: what it holds is in memory anyway.
const LARGE: usize = 3_000;

/// So many blocks may lie between a load and the loop.
const BETWEEN: usize = 32;

/// The pass.
pub fn run(func: &mut Func, alias: &Alias) {
    let loops = loops::find(func);
    let headers: FxHashSet<BlockId> = loops.iter().map(|l| l.header).collect();
    // Around an inner loop a load in each pass of it would cost more.
    let innermost = |l: &Loop| l.blocks.iter().all(|block| *block == l.header || !headers.contains(block));
    let size = |l: &Loop| l.blocks.iter().map(|block| func.blocks[*block].insts.len()).sum::<usize>();
    let may_be_crowded = |l: &&Loop| l.blocks.len() > 1 && innermost(l) && size(l) <= LARGE;
    let crowded: Vec<&Loop> = loops.iter().filter(may_be_crowded).collect();
    if crowded.is_empty() {
        return;
    }
    let constants = Constants::new(func);
    let mut made_in: IndexVec<ValueId, Option<BlockId>> = IndexVec::from_vec(vec![None; func.values.len()]);
    let mut loads: FxHashMap<ValueId, Inst> = FxHashMap::default();
    for (id, block) in func.blocks.iter_enumerated() {
        block.params.iter().for_each(|param| made_in[*param] = Some(id));
        for inst in &block.insts {
            let (first, second) = inst.results();
            first.into_iter().chain(second).for_each(|value| made_in[value] = Some(id));
            if let Inst::Load { dst, place, .. } = inst
                && place.index.is_empty()
                && !matches!(place.base, Base::Reference(_))
            {
                loads.insert(*dst, inst.clone());
            }
        }
    }
    // Loads add no blocks.
    let mut tree = None;
    for l in crowded {
        let (held, outside) = held(func, l, &made_in, &constants);
        let many = held.saturating_sub(HELD);
        if many == 0 {
            continue;
        }
        let writers: Vec<&Inst> =
            l.blocks.iter().flat_map(|b| &func.blocks[*b].insts).filter(|inst| writes_memory(inst)).collect();
        let tree = tree.get_or_insert_with(|| Dominators::new(func));
        let unchanged = |value: &ValueId| match (loads.get(value), made_in[*value]) {
            (Some(Inst::Load { dst, place, .. }), Some(home)) => {
                let bytes = i64::from(func.values[*dst].bytes());
                let writes = |w: &Inst| writes_memory(w) && alias.may_write(func, &constants, w, place, bytes);
                !writers.iter().any(|w| writes(w)) && holds_until(func, tree, (home, *dst), l.preheader, &writes)
            }
            _ => false,
        };
        let chosen: Vec<ValueId> = outside.into_iter().filter(unchanged).take(many).collect();
        for value in chosen {
            l.blocks.iter().for_each(|block| load_in(func, *block, value, &loads[&value]));
        }
    }
}

/// Whether memory still has what was loaded at the end of a block: nothing wrote it on any way there from the load.
fn holds_until(
    func: &Func,
    tree: &Dominators,
    (home, value): (BlockId, ValueId),
    end: BlockId,
    writes: &impl Fn(&Inst) -> bool,
) -> bool {
    let mut seen: FxHashSet<BlockId> = FxHashSet::from_iter([end]);
    let mut work = vec![end];
    while let Some(id) = work.pop() {
        let insts = &func.blocks[id].insts;
        let first = if id == home {
            insts.iter().position(|inst| inst.results().0 == Some(value)).map_or(0, |at| at + 1)
        } else {
            work.extend(tree.preds[id].iter().filter(|pred| seen.insert(**pred)));
            0
        };
        if seen.len() > BETWEEN || insts[first..].iter().any(writes) {
            return false;
        }
    }
    true
}

/// How many integers a loop holds from block to block, and which of them were made outside, in the order of their first use.
fn held(
    func: &Func,
    l: &Loop,
    made_in: &IndexVec<ValueId, Option<BlockId>>,
    constants: &Constants,
) -> (usize, Vec<ValueId>) {
    let inside: FxHashSet<BlockId> = l.blocks.iter().copied().collect();
    let mut all: FxHashSet<ValueId> = func.blocks[l.header].params.iter().copied().collect();
    let mut outside = Vec::new();
    for id in &l.blocks {
        let block = &func.blocks[*id];
        let mut note = |value: ValueId| {
            let here = made_in.get(value).copied().flatten();
            if here != Some(*id) && constants.get(value).is_none() && all.insert(value) {
                outside.extend(here.filter(|home| !inside.contains(home)).map(|_| value));
            }
        };
        block.insts.iter().for_each(|inst| inst.for_each_use(&mut note));
        block.term.for_each_use(&mut note);
    }
    let integers = |value: &ValueId| func.values[*value].is_int();
    outside.retain(integers);
    (all.iter().filter(|value| integers(value)).count(), outside)
}

/// Loads a value once more in a block that reads it, in front of its first reader.
fn load_in(func: &mut Func, id: BlockId, value: ValueId, load: &Inst) {
    let block = &mut func.blocks[id];
    let reads = |inst: &Inst| {
        let mut found = false;
        inst.for_each_use(|v| found |= v == value);
        found
    };
    let first = block.insts.iter().position(reads).unwrap_or(block.insts.len());
    let mut in_term = false;
    block.term.for_each_use(|v| in_term |= v == value);
    if first == block.insts.len() && !in_term {
        return;
    }
    let fresh = func.values.push(func.values[value]);
    let rename = &mut |v: &mut ValueId| {
        if *v == value {
            *v = fresh;
        }
    };
    block.insts[first..].iter_mut().for_each(|inst| visit::uses(inst, rename));
    visit::term_uses(&mut block.term, rename);
    let mut again = load.clone();
    visit::defs(&mut again, &mut |dst| *dst = fresh);
    block.insts.insert(first, again);
}
