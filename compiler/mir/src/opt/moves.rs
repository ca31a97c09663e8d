//! Moves of neighbours to neighbours become one.
//!
//! The inputs of a block are copied one by one. Where two or more come from places side by side and go to places side by side,
//! with nothing between that could see the difference, one copy does it with fewer loads and stores.
//!
//! ```text
//! v1 = load i8 Main.ready
//! store i8 station.ready := v1             =>   copy 2 bytes station.ready := Main.ready
//! v2 = load i8 Main.acknowledge
//! store i8 station.acknowledge := v2
//! ```
//!
//! A load that is wider than the stores before it has to wait until they reached the cache: single values are joined only if
//! nothing in the function writes their source.

use super::alias::Alias;
use super::rewrite::{Constants, use_counts, writes_memory};
use crate::ir::{Func, Inst, Place, ValueId};
use index_vec::IndexVec;

/// Longer copies are left alone.
const BYTES: u32 = 16;

/// So many instructions may stand between the first load and the last store.
const REACH: usize = 64;

/// So many instructions of the function are looked at, whether they write a source.
const BUDGET: usize = 2_000_000;

/// What is copied by a load and a store, or by one instruction.
struct Move {
    src: Place,
    dst: Place,
    bytes: u32,
    /// The load, if it is an instruction of its own; whether only the store needs it.
    load: Option<(usize, bool)>,
    /// The instruction that writes.
    store: usize,
}

/// The pass.
pub fn run(func: &mut Func, alias: &Alias) {
    let constants = Constants::new(func);
    let uses = use_counts(func);
    let mut budget = BUDGET;
    for id in func.blocks.indices() {
        let insts = &func.blocks[id].insts;
        let moves = moves(func, insts, &uses);
        let mut joined: Vec<(Vec<usize>, usize, Inst)> = Vec::new();
        let mut rest = moves.as_slice();
        while let Some((first, others)) = rest.split_first() {
            let count = Look { func, alias, constants: &constants, insts }.run_of(first, others, &mut budget);
            if count > 0 {
                let all = &rest[..=count];
                let bytes = all.iter().map(|m| m.bytes).sum();
                let gone = all.iter().flat_map(|m| {
                    let load = m.load.filter(|(_, alone)| *alone).map(|(at, _)| at);
                    load.into_iter().chain([m.store])
                });
                let copy = Inst::Copy { dst: first.dst.clone(), src: first.src.clone(), bytes };
                joined.push((gone.collect(), all[count].store, copy));
            }
            rest = &others[count..];
        }
        if joined.is_empty() {
            continue;
        }
        let mut list: Vec<Option<Inst>> = std::mem::take(&mut func.blocks[id].insts).into_iter().map(Some).collect();
        for (gone, last, copy) in joined {
            gone.into_iter().for_each(|at| list[at] = None);
            list[last] = Some(copy);
        }
        func.blocks[id].insts = list.into_iter().flatten().collect();
    }
}

/// The moves of a block by their stores.
fn moves(func: &Func, insts: &[Inst], uses: &IndexVec<ValueId, u32>) -> Vec<Move> {
    let mut moves = Vec::new();
    for (store, inst) in insts.iter().enumerate() {
        match inst {
            Inst::Copy { dst, src, bytes } if *bytes < BYTES => {
                moves.push(Move { src: src.clone(), dst: dst.clone(), bytes: *bytes, load: None, store });
            }
            Inst::Store { place: dst, value } if dst.bit.is_none() => {
                let first = store.saturating_sub(REACH);
                let load = insts[first..store].iter().rposition(|inst| inst.results().0 == Some(*value));
                let Some(at) = load.map(|at| first + at) else { continue };
                if let Inst::Load { place: src, normalise: false, .. } = &insts[at]
                    && src.bit.is_none()
                {
                    let (src, dst, bytes) = (src.clone(), dst.clone(), func.values[*value].bytes());
                    moves.push(Move { src, dst, bytes, load: Some((at, uses[*value] == 1)), store });
                }
            }
            _ => {}
        }
    }
    moves
}

/// What is asked of a block.
struct Look<'a> {
    func: &'a Func,
    alias: &'a Alias<'a>,
    constants: &'a Constants,
    insts: &'a [Inst],
}

impl Look<'_> {
    /// How many of the next moves go together with one: what saves most.
    fn run_of(&self, first: &Move, others: &[Move], budget: &mut usize) -> usize {
        let mut best = (0, 0);
        let (mut bytes, mut begin) = (first.bytes, first.begin());
        let (mut before, mut kept) = (first.cost(), first.kept());
        let mut single = first.load.is_some();
        let mut members = vec![first.store];
        for (n, next) in others.iter().enumerate() {
            begin = begin.min(next.begin());
            let neighbours = first.src.goes_on(bytes, &next.src) && first.dst.goes_on(bytes, &next.dst);
            if !neighbours || bytes + next.bytes > BYTES || next.store - begin > REACH {
                break;
            }
            bytes += next.bytes;
            (before, kept) = (before + next.cost(), kept + next.kept());
            single |= next.load.is_some();
            members.push(next.store);
            let (src, dst) = ((&first.src, i64::from(bytes)), (&first.dst, i64::from(bytes)));
            if !self.may_wait(src, dst, begin, &members) {
                break;
            }
            let saved = before.saturating_sub(kept + 2 * pieces(bytes));
            if saved > best.1 && !(single && self.is_written(src, budget)) {
                best = (n + 1, saved);
            }
        }
        best.0
    }

    /// Whether the stores can all be done at the last of them, and the loads with them.
    fn may_wait(&self, src: (&Place, i64), dst: (&Place, i64), begin: usize, members: &[usize]) -> bool {
        let (Some(first), Some(last)) = (members.first(), members.last()) else { return false };
        let writes = |inst: &Inst, at: (&Place, i64)| self.alias.may_write(self.func, self.constants, inst, at.0, at.1);
        let reads = |inst: &Inst, at: (&Place, i64)| self.alias.may_read(self.func, self.constants, inst, at.0, at.1);
        let leaves = |inst: &Inst| matches!(inst, Inst::Check { .. } | Inst::Poll { .. } | Inst::Call { .. });
        !self.alias.overlap(src.0, src.1, dst.0, dst.1)
            && (begin..*last).filter(|at| !members.contains(at)).all(|at| {
                let inst = &self.insts[at];
                let seen = at > *first && (leaves(inst) || reads(inst, dst) || writes(inst, dst));
                !seen && !writes(inst, src)
            })
    }

    /// Whether the function may write a place; yes, if that takes too long to find out.
    fn is_written(&self, place: (&Place, i64), budget: &mut usize) -> bool {
        let mut all = self.func.blocks.iter().flat_map(|block| &block.insts);
        all.any(|inst| {
            *budget = budget.saturating_sub(1);
            *budget == 0
                || writes_memory(inst) && self.alias.may_write(self.func, self.constants, inst, place.0, place.1)
        })
    }
}

impl Move {
    fn begin(&self) -> usize {
        self.load.map_or(self.store, |(at, _)| at)
    }

    /// Loads and stores.
    fn cost(&self) -> u32 {
        if self.load.is_some() { 2 } else { 2 * pieces(self.bytes) }
    }

    /// Loads that stay.
    fn kept(&self) -> u32 {
        u32::from(self.load.is_some_and(|(_, alone)| !alone))
    }
}

/// Moves of 8, 4, 2 and 1 bytes.
fn pieces(bytes: u32) -> u32 {
    bytes / 8 + (bytes % 8).count_ones()
}
