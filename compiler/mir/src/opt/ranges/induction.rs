//! The loops of a function as far as ranges need them: which values count in even steps, and how deep loops are nested.
//!
//! FOR (`lower::for_loop`) gives a header two parameters, the value and how many passes follow; the second one bounds
//! every other that moves in even steps.

use super::super::fold::Def;
use super::facts::Facts;
use crate::dominators::Dominators;
use crate::ir::{Args, BlockId, Func, Inst, ValueId};
use index_vec::IndexVec;
use plcc_stdlib::prim::PrimOp;
use rustc_hash::FxHashSet;

/// A loop.
#[derive(Debug)]
pub struct Loop {
    /// The loop around it.
    pub parent: Option<usize>,
    /// Its parameters that change by the same step on every way back.
    pub steps: Vec<Step>,
    /// How often the header runs for one entry, at most; `None` if unknown.
    pub passes: Option<u64>,
}

/// A parameter of a header that changes by a constant.
#[derive(Debug)]
pub struct Step {
    /// Which parameter.
    pub param: usize,
    /// By how much, not 0.
    pub step: i64,
    /// It counts down and was seen not to pass 0: it bounds the loop.
    pub counts_down: bool,
    /// No step was seen to wrap, read as signed and as unsigned.
    pub whole: (bool, bool),
    /// Where it ends, if that lies behind its first value.
    pub bound: Option<Bound>,
}

/// The end of a FOR loop whose counter began as `(end - first) / size`, or `(first - end) / size` if it counts down.
#[derive(Debug, Clone, Copy)]
pub struct Bound {
    /// The step that is the counter; it must count down.
    pub counter: usize,
    /// First value.
    pub first: ValueId,
    /// The end.
    pub end: ValueId,
}

/// All loops of a function.
#[derive(Debug)]
pub struct Loops {
    /// In reverse post-order of their headers.
    pub list: Vec<Loop>,
    /// The loop whose header a block is.
    pub of_header: IndexVec<BlockId, Option<usize>>,
    /// The innermost loop around a block.
    pub of_block: IndexVec<BlockId, Option<usize>>,
    /// What steps come back with.
    pub moves: FxHashSet<ValueId>,
    /// A circle with two entries exists, so that not every circle is in the list.
    pub tangled: bool,
}

impl Loops {
    /// Finds them. Each block is visited once per loop that it closes, not once per loop around it.
    pub fn new(func: &Func, tree: &Dominators, facts: &Facts) -> Self {
        let mut position = IndexVec::from_vec(vec![u32::MAX; func.blocks.len()]);
        tree.order.iter().enumerate().for_each(|(n, block)| position[*block] = n as u32);
        let mut loops = Loops {
            list: Vec::new(),
            of_header: IndexVec::from_vec(vec![None; func.blocks.len()]),
            of_block: IndexVec::from_vec(vec![None; func.blocks.len()]),
            moves: FxHashSet::default(),
            tangled: false,
        };
        let mut headers = Vec::new();
        for &block in &tree.order {
            let back = |pred: &BlockId| position[*pred] >= position[block];
            let ends: Vec<BlockId> = tree.preds[block].iter().copied().filter(back).collect();
            if ends.iter().any(|end| !tree.dominates(block, *end)) {
                loops.tangled = true;
            } else if !ends.is_empty() {
                loops.of_header[block] = Some(loops.list.len());
                let steps = steps(func, facts, block, &ends, tree);
                for end in &ends {
                    func.blocks[*end].term.for_each_target(|target| {
                        if target.block == block {
                            loops.moves.extend(steps.iter().map(|step| target.args[step.param]));
                        }
                    });
                }
                loops.list.push(Loop { parent: None, steps, passes: None });
                headers.push((block, ends));
            }
        }
        // Inner loops have later headers. What an inner loop took is skipped over by its header.
        for (n, (header, ends)) in headers.iter().enumerate().rev() {
            let mut work = ends.clone();
            while let Some(block) = work.pop() {
                match loops.of_block[block] {
                    None => {
                        loops.of_block[block] = Some(n);
                        if block != *header {
                            work.extend(tree.preds[block].iter().copied());
                        }
                    }
                    Some(inner) => {
                        let mut outer = inner;
                        while let Some(parent) = loops.list[outer].parent {
                            outer = parent;
                        }
                        if outer != n {
                            loops.list[outer].parent = Some(n);
                            let inner_header = headers[outer].0;
                            work.extend(tree.preds[inner_header].iter().filter(|p| !tree.dominates(inner_header, **p)));
                        }
                    }
                }
            }
            loops.of_block[*header] = Some(n);
        }
        loops
    }

    /// The loops in which polls can be missed: so few passes of nested loops run between two polls that are left.
    ///
    /// `few` passes, as lowering allows itself; a loop that calls keeps its poll, because what it calls may loop too.
    pub fn unpolled(&self, func: &Func, few: u64) -> Vec<bool> {
        let mut polled = vec![false; self.list.len()];
        let mut calls = vec![false; self.list.len()];
        for (block, body) in func.blocks.iter_enumerated() {
            let Some(n) = self.of_block[block] else { continue };
            polled[n] |= body.insts.iter().any(|inst| matches!(inst, Inst::Poll { .. }));
            calls[n] |= body.insts.iter().any(|inst| matches!(inst, Inst::Call { .. }));
        }
        let mut gone = vec![false; self.list.len()];
        if self.tangled {
            return gone;
        }
        // Passes of the loops inside that go by without a poll.
        let mut below = vec![1u64; self.list.len()];
        for n in (0..self.list.len()).rev() {
            let parent = self.list[n].parent;
            if let Some(parent) = parent {
                calls[parent] |= calls[n];
            }
            let own = self.list[n].passes.unwrap_or(u64::MAX).saturating_mul(below[n]);
            if polled[n] && !calls[n] {
                let mut all = own;
                let mut around = parent;
                while let Some(outer) = around.filter(|outer| !polled[*outer]) {
                    all = all.saturating_mul(self.list[outer].passes.unwrap_or(u64::MAX));
                    if all > few {
                        break;
                    }
                    around = self.list[outer].parent;
                }
                if all <= few {
                    (polled[n], gone[n]) = (false, true);
                }
            }
            if let Some(parent) = parent.filter(|_| !polled[n]) {
                below[parent] = below[parent].max(own);
            }
        }
        gone
    }
}

/// The parameters of a header that change by a constant on every way back.
fn steps(func: &Func, facts: &Facts, header: BlockId, ends: &[BlockId], tree: &Dominators) -> Vec<Step> {
    let params = &func.blocks[header].params;
    let mut found = Vec::new();
    for (n, param) in params.iter().enumerate() {
        if !facts.repr(*param).is_int() {
            continue;
        }
        let mut step = None;
        let mut even = true;
        for end in ends {
            func.blocks[*end].term.for_each_target(|target| {
                if target.block == header {
                    let own = step_of(facts, target.args[n], *param);
                    even &= own.is_some() && (step.is_none() || step == own);
                    step = own;
                }
            });
        }
        if let Some(step) = step.filter(|step| even && *step != 0) {
            found.push(Step {
                param: n,
                step,
                counts_down: step < 0 && step > i64::MIN,
                whole: (true, true),
                bound: None,
            });
        }
    }
    // Which end a value has can be seen from the counter, if there is one way in.
    let mut entry = None;
    let mut entries = 0;
    for pred in tree.preds[header].iter().filter(|pred| !ends.contains(pred)) {
        func.blocks[*pred].term.for_each_target(|target| {
            if target.block == header {
                entry = Some(target);
                entries += 1;
            }
        });
    }
    if let (Some(entry), 1) = (entry, entries) {
        let counts: Vec<(usize, (ValueId, ValueId, u64))> = found
            .iter()
            .enumerate()
            .filter(|(_, step)| step.step == -1)
            .filter_map(|(n, step)| Some((n, distance(facts, entry.args[step.param])?)))
            .collect();
        for step in &mut found {
            let first = entry.args[step.param];
            step.bound = counts.iter().find_map(|(counter, (more, less, size))| {
                if step.step.unsigned_abs() > *size {
                    return None;
                }
                let (from, end) = if step.step > 0 { (*less, *more) } else { (*more, *less) };
                (from == first).then_some(Bound { counter: *counter, first, end })
            });
        }
    }
    found
}

/// The constant that was added to `from`.
fn step_of(facts: &Facts, value: ValueId, from: ValueId) -> Option<i64> {
    let Def::Prim(op, repr, Args::Two([x, c])) = facts.def(value) else { return None };
    let constant = |c: ValueId| match facts.def(c) {
        Def::Const(raw) => Some(repr.sign_extend(raw)),
        _ => None,
    };
    match op {
        PrimOp::Add if x == from => constant(c),
        PrimOp::Add if c == from => constant(x),
        PrimOp::Sub if x == from => constant(c)?.checked_neg(),
        _ => None,
    }
}

/// `(a - b) / size` as a, b and size.
fn distance(facts: &Facts, value: ValueId) -> Option<(ValueId, ValueId, u64)> {
    match facts.def(value) {
        Def::Prim(PrimOp::Sub, _, Args::Two([a, b])) => Some((a, b, 1)),
        Def::Prim(op @ (PrimOp::DivU | PrimOp::ShrU), _, Args::Two([x, c])) => {
            let (Def::Prim(PrimOp::Sub, _, Args::Two([a, b])), Def::Const(c)) = (facts.def(x), facts.def(c)) else {
                return None;
            };
            let size = if op == PrimOp::DivU { c } else { 1u64.checked_shl(u32::try_from(c).ok()?)? };
            (size > 0).then_some((a, b, size))
        }
        _ => None,
    }
}
