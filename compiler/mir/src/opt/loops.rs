//! Natural loops, with a block in front of each and one on every way out.
//!
//! A loop is a header that dominates the ends of its back-edges, and all blocks on the ways between. Circles with two
//! entries are no loops; passes leave them alone.

use super::rewrite::{to, writes_memory};
use crate::dominators::Dominators;
use crate::ir::{Block, BlockId, Func, Inst, Target, Term};
use crate::visit;
use index_vec::IndexVec;
use rustc_hash::{FxHashMap, FxHashSet};

/// A loop.
#[derive(Debug, Clone)]
pub struct Loop {
    /// Where it is entered.
    pub header: BlockId,
    /// Its blocks in reverse post-order, the header first.
    pub blocks: Vec<BlockId>,
    /// The block in front, which only jumps to the header.
    pub preheader: BlockId,
    /// Where ways out arrive; each comes from one block of the loop.
    pub exits: Vec<BlockId>,
    /// How many loops are around it.
    pub depth: usize,
}

/// Passes over loops look at each instruction as often as there are loops around it. Where that would be more than so many
/// instructions, they find none: loops can be nested hundreds deep.
const WORK: usize = 20_000_000;

/// The loops of a function, inner ones before outer ones. Adds the blocks in front and on the ways out.
pub fn find(func: &mut Func) -> Vec<Loop> {
    let tree = Dominators::new(func);
    let bodies = bodies(&tree);
    let work: usize = bodies.iter().flat_map(|(_, body)| body).map(|block| func.blocks[*block].insts.len() + 1).sum();
    if bodies.is_empty() || work > WORK {
        return Vec::new();
    }
    for (header, body) in &bodies {
        // Blocks that are put in front of other loops jump to these only.
        add_preheader(func, *header, &tree.preds[*header], body);
    }
    for (_, body) in &bodies {
        split_exits(func, body);
    }
    // Blocks that were added may belong to outer loops.
    let tree = Dominators::new(func);
    let bodies = self::bodies(&tree);
    let mut position: IndexVec<BlockId, usize> = IndexVec::from_vec(vec![0; func.blocks.len()]);
    tree.order.iter().enumerate().for_each(|(n, block)| position[*block] = n);
    let mut depth: FxHashMap<BlockId, usize> = FxHashMap::default();
    for (_, body) in &bodies {
        body.iter().for_each(|block| *depth.entry(*block).or_default() += 1);
    }
    let mut loops: Vec<Loop> = bodies
        .into_iter()
        .filter_map(|(header, body)| {
            let mut blocks: Vec<BlockId> = body.iter().copied().collect();
            blocks.sort_by_key(|block| position[*block]);
            let outside = tree.preds[header].iter().copied().find(|pred| !body.contains(pred));
            let mut exits = Vec::new();
            for block in &blocks {
                func.blocks[*block].term.for_each_target(|target| {
                    if !body.contains(&target.block) {
                        exits.push(target.block);
                    }
                });
            }
            // The entry of the function has no block in front.
            Some(Loop { header, depth: depth[&header] - 1, blocks, preheader: outside?, exits })
        })
        .collect();
    loops.sort_by_key(|l| (std::cmp::Reverse(l.depth), position[l.header]));
    loops
}

/// Which blocks each loop has, for passes that follow the ways forwards: what holds in front of a loop and is not changed in it
/// holds in it.
pub struct Bodies(FxHashMap<BlockId, FxHashSet<BlockId>>);

impl Bodies {
    /// Where loops are nested too deep they are not known.
    pub fn new(func: &Func, tree: &Dominators) -> Self {
        let bodies = bodies(tree);
        let work: usize =
            bodies.iter().flat_map(|(_, body)| body).map(|block| func.blocks[*block].insts.len() + 1).sum();
        Self(if work > WORK / 100 { FxHashMap::default() } else { bodies.into_iter().collect() })
    }

    /// The ways into a block that bring what is known: all, or for a loop those from outside. None if a way comes from
    /// elsewhere that had not its turn yet.
    pub fn known_ways(&self, tree: &Dominators, block: BlockId, had_turn: impl Fn(BlockId) -> bool) -> Vec<BlockId> {
        let (known, later): (Vec<BlockId>, Vec<BlockId>) = tree.preds[block].iter().partition(|pred| had_turn(**pred));
        let inside = |pred: &BlockId| self.0.get(&block).is_some_and(|body| body.contains(pred));
        if later.iter().all(inside) { known } else { Vec::new() }
    }

    /// Keeps of what is known in front of a loop with this header what no instruction in it changes.
    pub fn retain<T>(&self, func: &Func, header: BlockId, known: &mut Vec<T>, keeps: impl Fn(&Inst, &T) -> bool) {
        let Some(body) = self.0.get(&header) else { return };
        for inst in body.iter().flat_map(|block| &func.blocks[*block].insts).filter(|inst| writes_memory(inst)) {
            if known.is_empty() {
                return;
            }
            known.retain(|one| keeps(inst, one));
        }
    }
}

/// Headers and blocks of all loops.
fn bodies(tree: &Dominators) -> Vec<(BlockId, FxHashSet<BlockId>)> {
    let mut list: Vec<(BlockId, FxHashSet<BlockId>)> = Vec::new();
    for &header in &tree.order {
        if header.index() == 0 {
            continue;
        }
        let ends: Vec<BlockId> =
            tree.preds[header].iter().copied().filter(|pred| tree.dominates(header, *pred)).collect();
        if ends.is_empty() {
            continue;
        }
        let mut body: FxHashSet<BlockId> = FxHashSet::default();
        body.insert(header);
        let mut work = ends;
        while let Some(block) = work.pop() {
            if body.insert(block) {
                work.extend(tree.preds[block].iter().copied());
            }
        }
        list.push((header, body));
    }
    list
}

fn add_preheader(func: &mut Func, header: BlockId, preds: &[BlockId], body: &FxHashSet<BlockId>) {
    let mut outside: Vec<BlockId> = preds.iter().copied().filter(|id| !body.contains(id)).collect();
    outside.sort_unstable();
    outside.dedup();
    let mut edges: Vec<Target> = Vec::new();
    for id in &outside {
        func.blocks[*id].term.for_each_target(|target| {
            if target.block == header {
                edges.push(target.clone());
            }
        });
    }
    // One way in gives its values at once, so that they stay what they are.
    let (params, onward) = match &edges[..] {
        [only] => (Vec::new(), only.clone()),
        _ => {
            let reprs: Vec<_> = func.blocks[header].params.iter().map(|v| func.values[*v]).collect();
            let params: Vec<_> = reprs.into_iter().map(|repr| func.values.push(repr)).collect();
            (params.clone(), Target { block: header, args: params })
        }
    };
    let without_args = params.is_empty();
    let front = func.blocks.push(Block { params, insts: Vec::new(), term: Term::Jump(onward) });
    for id in outside {
        visit::targets(&mut func.blocks[id].term, &mut |target| {
            if target.block == header {
                target.block = front;
                if without_args {
                    target.args.clear();
                }
            }
        });
    }
}

/// Puts a block on every way out.
fn split_exits(func: &mut Func, body: &FxHashSet<BlockId>) {
    let mut blocks: Vec<BlockId> = body.iter().copied().collect();
    blocks.sort_unstable();
    for id in blocks {
        let mut term = std::mem::replace(&mut func.blocks[id].term, Term::Return(None));
        visit::targets(&mut term, &mut |target| {
            if !body.contains(&target.block) {
                let onward = std::mem::replace(target, to(BlockId::from_raw(0)));
                let block = Block { params: Vec::new(), insts: Vec::new(), term: Term::Jump(onward) };
                *target = to(func.blocks.push(block));
            }
        });
        func.blocks[id].term = term;
    }
}
