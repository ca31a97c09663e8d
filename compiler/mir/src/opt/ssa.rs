//! Turns places into values over some blocks: the tool of [`frames`](super::frames) and [`promote`](super::promote).
//!
//! In: a function, the blocks, the places, each accessed there by whole loads and stores of one representation only, and
//! by nothing else. Out: the same function in which loads are the values that were stored last; where ways meet, blocks
//! have a parameter for each place that is still read. What is done at the borders is the caller's business: it gives the
//! values at the entry and gets those at the exits.

use super::rewrite::Replace;
use crate::ir::{Base, BlockId, Func, Inst, Place, ValueId};
use crate::visit;
use index_vec::IndexVec;
use plcc_stdlib::prim::Repr;
use rustc_hash::{FxHashMap, FxHashSet};

/// A place that becomes a value.
#[derive(Debug, Clone)]
pub struct Var {
    /// Where.
    pub place: Place,
    /// Its representation.
    pub repr: Repr,
    /// Stores stay to be done: exits and the end owe them.
    pub owed: bool,
}

/// The blocks.
pub struct Scope<'a> {
    /// In reverse post-order, the entry first: the only one that is reached from outside.
    pub blocks: &'a [BlockId],
    /// Predecessors of all blocks of the function.
    pub preds: &'a IndexVec<BlockId, Vec<BlockId>>,
    /// There are ways from the blocks back to the entry.
    pub is_loop: bool,
}

/// The values at the end of each block, by place; `None` where the place is not read any more.
pub type Ends = FxHashMap<BlockId, Vec<Option<ValueId>>>;

/// Rewrites the blocks. `initial` gives the value of each place at the entry: for a loop the callers pass them as further
/// arguments of every jump from outside, in the order of the list that is returned; else they are there already. Returns
/// which places the entry has parameters for, and the values at the ends of the blocks. What became of loads goes into
/// `replace`, which the caller applies.
pub fn rewrite(
    func: &mut Func,
    scope: &Scope,
    vars: &[Var],
    initial: &[ValueId],
    replace: &mut Replace,
) -> (Vec<usize>, Ends) {
    let inside: FxHashSet<BlockId> = scope.blocks.iter().copied().collect();
    let numbers: FxHashMap<Place, usize> = vars.iter().enumerate().map(|(n, v)| (v.place.clone(), n)).collect();
    let live = live_in(func, scope, vars, &numbers, &inside);
    let entry = scope.blocks[0];
    let mut params: FxHashMap<BlockId, Vec<(usize, ValueId)>> = FxHashMap::default();
    for &block in scope.blocks {
        let joins = if block == entry { scope.is_loop } else { scope.preds[block].len() > 1 };
        if joins {
            let mut list = Vec::new();
            for (n, var) in vars.iter().enumerate().filter(|(n, _)| live[*n].contains(&block)) {
                let value = func.values.push(var.repr);
                func.blocks[block].params.push(value);
                list.push((n, value));
            }
            params.insert(block, list);
        }
    }
    let mut ends: Ends = FxHashMap::default();
    for &block in scope.blocks {
        let mut now: Vec<Option<ValueId>> = match params.get(&block) {
            Some(list) => {
                let mut now = vec![None; vars.len()];
                list.iter().for_each(|(n, value)| now[*n] = Some(*value));
                now
            }
            None if block == entry => initial.iter().map(|v| Some(*v)).collect(),
            None => ends[&scope.preds[block][0]].clone(),
        };
        let insts = std::mem::take(&mut func.blocks[block].insts);
        let mut out = Vec::with_capacity(insts.len());
        for mut inst in insts {
            replace.inst(&mut inst);
            match &inst {
                Inst::Load { dst, place, .. } if numbers.contains_key(place) => {
                    let value = now[numbers[place]];
                    let value = value.unwrap_or_else(|| plcc_diag::bug!("a place is read that nothing gave a value"));
                    replace.set(*dst, value);
                    continue;
                }
                Inst::Store { place, value } if numbers.contains_key(place) => {
                    now[numbers[place]] = Some(*value);
                    continue;
                }
                _ => {}
            }
            if let Inst::Check { exit, .. } | Inst::Poll { exit } = &mut inst {
                // Before what it owes already: that happened later.
                let due = vars.iter().zip(&now).filter(|(var, _)| var.owed && var.place.base != Base::Frame);
                let due: Vec<_> = due.filter_map(|(var, v)| v.map(|v| (var.place.clone(), v))).collect();
                exit.owed.splice(0..0, due);
            }
            out.push(inst);
        }
        func.blocks[block].insts = out;
        ends.insert(block, now);
    }
    for &block in scope.blocks {
        let mut term = std::mem::replace(&mut func.blocks[block].term, crate::ir::Term::Return(None));
        visit::targets(&mut term, &mut |target| {
            let Some(list) = params.get(&target.block) else { return };
            for (n, _) in list {
                let value = ends[&block][*n].unwrap_or_else(|| plcc_diag::bug!("a way without the value of a place"));
                target.args.push(value);
            }
        });
        func.blocks[block].term = term;
    }
    for now in ends.values_mut() {
        now.iter_mut().flatten().for_each(|v| *v = replace.get(*v));
    }
    (params.get(&entry).map_or_else(Vec::new, |list| list.iter().map(|(n, _)| *n).collect()), ends)
}

/// For each place the blocks at whose start its value is still read: before it is stored, by an exit that owes it, or
/// behind the blocks.
fn live_in(
    func: &Func,
    scope: &Scope,
    vars: &[Var],
    numbers: &FxHashMap<Place, usize>,
    inside: &FxHashSet<BlockId>,
) -> Vec<FxHashSet<BlockId>> {
    let mut live: Vec<FxHashSet<BlockId>> = vec![FxHashSet::default(); vars.len()];
    let mut stores: Vec<FxHashSet<BlockId>> = vec![FxHashSet::default(); vars.len()];
    let mut work: Vec<(usize, BlockId)> = Vec::new();
    for &block in scope.blocks {
        let mut stored = vec![false; vars.len()];
        for inst in &func.blocks[block].insts {
            match inst {
                Inst::Load { place, .. } => {
                    if let Some(n) = numbers.get(place).filter(|n| !stored[**n]) {
                        work.push((*n, block));
                    }
                }
                Inst::Store { place, .. } => {
                    if let Some(n) = numbers.get(place) {
                        stored[*n] = true;
                        stores[*n].insert(block);
                    }
                }
                Inst::Check { .. } | Inst::Poll { .. } => {
                    work.extend((0..vars.len()).filter(|n| vars[*n].owed && !stored[*n]).map(|n| (n, block)));
                }
                _ => {}
            }
        }
        let mut leaves = false;
        func.blocks[block].term.for_each_target(|target| leaves |= !inside.contains(&target.block));
        if leaves {
            work.extend((0..vars.len()).filter(|n| vars[*n].owed && !stored[*n]).map(|n| (n, block)));
        }
    }
    let entry = scope.blocks[0];
    while let Some((n, block)) = work.pop() {
        if !live[n].insert(block) {
            continue;
        }
        for pred in &scope.preds[block] {
            // From outside only the entry is reached, and there the value is given.
            if (block != entry || scope.is_loop) && inside.contains(pred) && !stores[n].contains(pred) {
                work.push((n, *pred));
            }
        }
    }
    live
}
