//! Tidies the control-flow graph: what other passes leave behind.
//!
//! - A parameter of a block that gets the same value on every way is that value.
//! - Values that nobody reads are not computed, unread parameters not given.
//! - A jump to a block that only jumps on goes there at once; both ways of a branch to one place are a jump.
//! - A block and its only successor become one, if that has no other predecessor.
//!
//! ```text
//! b0: if v0 then b1 else b2      b0: return v1
//! b1: jump b3(v1)            =>
//! b2: jump b3(v1)
//! b3(v2): return v2
//! ```

use super::rewrite::{Replace, compact, is_pure};
use crate::ir::{Block, BlockId, Func, Inst, Target, Term, ValueId};
use crate::visit;
use index_vec::IndexVec;

/// The pass.
pub fn run(func: &mut Func) {
    let mut first = true;
    loop {
        let mut changed = same_parameters(func);
        let dead = dead_values(func);
        changed |= skip_empty_blocks(func);
        changed |= join_blocks(func);
        if first || changed || dead {
            compact(func);
        }
        if !changed {
            break;
        }
        first = false;
    }
}

/// Parameters that get one value (or themselves) on every way.
fn same_parameters(func: &mut Func) -> bool {
    #[derive(Clone, Copy, PartialEq)]
    enum Incoming {
        Nothing,
        One(ValueId),
        Many,
    }
    let mut replace = Replace::new(func);
    let mut any = false;
    loop {
        let mut incoming: IndexVec<BlockId, Vec<Incoming>> =
            func.blocks.iter().map(|b| vec![Incoming::Nothing; b.params.len()]).collect();
        for block in &func.blocks {
            block.term.for_each_target(|target| {
                let params = &func.blocks[target.block].params;
                for ((seen, arg), param) in incoming[target.block].iter_mut().zip(&target.args).zip(params) {
                    let arg = replace.get(*arg);
                    *seen = match *seen {
                        _ if arg == *param => continue,
                        Incoming::Nothing => Incoming::One(arg),
                        Incoming::One(one) if one == arg => continue,
                        _ => Incoming::Many,
                    };
                }
            });
        }
        let mut drop: IndexVec<BlockId, Vec<bool>> = IndexVec::with_capacity(func.blocks.len());
        let mut changed = false;
        for (id, seen) in incoming.iter_enumerated() {
            let params = &func.blocks[id].params;
            let same = seen.iter().zip(params).map(|(seen, param)| match seen {
                // Not the entry, whose parameters come from outside.
                Incoming::One(one) if id.index() != 0 && replace.get(*one) != *param => {
                    replace.set(*param, *one);
                    true
                }
                _ => false,
            });
            let same: Vec<bool> = same.collect();
            changed |= same.contains(&true);
            drop.push(same);
        }
        if !changed {
            break;
        }
        any = true;
        remove_parameters(func, &drop);
    }
    if any {
        replace.apply(func);
    }
    any
}

/// Leaves out the marked parameters and what jumps give them.
fn remove_parameters(func: &mut Func, drop: &IndexVec<BlockId, Vec<bool>>) {
    for (block, dropped) in func.blocks.iter_mut().zip(drop) {
        retain_unmarked(&mut block.params, dropped);
        visit::targets(&mut block.term, &mut |target| retain_unmarked(&mut target.args, &drop[target.block]));
    }
}

fn retain_unmarked(list: &mut Vec<ValueId>, marked: &[bool]) {
    let mut n = 0;
    list.retain(|_| {
        n += 1;
        !marked[n - 1]
    });
}

/// Pure instructions and parameters whose values nothing with an effect needs; whether there were some.
fn dead_values(func: &mut Func) -> bool {
    /// What a live value makes live.
    #[derive(Clone, Copy)]
    enum Origin {
        None,
        Inst(BlockId, u32),
        Param(BlockId, u32),
    }
    let mut origin: IndexVec<ValueId, Origin> = IndexVec::from_vec(vec![Origin::None; func.values.len()]);
    let mut live: IndexVec<ValueId, bool> = IndexVec::from_vec(vec![false; func.values.len()]);
    let mut work: Vec<ValueId> = Vec::new();
    let mut jumps: IndexVec<BlockId, Vec<BlockId>> = func.blocks.iter().map(|_| Vec::new()).collect();
    for (id, block) in func.blocks.iter_enumerated() {
        for (n, param) in block.params.iter().enumerate() {
            origin[*param] = Origin::Param(id, n as u32);
        }
        for (n, inst) in block.insts.iter().enumerate() {
            if is_pure(inst) {
                if let (Some(dst), _) = inst.results() {
                    origin[dst] = Origin::Inst(id, n as u32);
                }
            } else {
                inst.for_each_use(|v| work.push(v));
            }
        }
        match &block.term {
            Term::Branch { cond: v, .. } | Term::Switch { value: v, .. } | Term::Return(Some(v)) => work.push(*v),
            Term::Jump(_) | Term::Return(None) => {}
        }
        block.term.for_each_target(|target| jumps[target.block].push(id));
    }
    work.extend(func.blocks.first().into_iter().flat_map(|entry| &entry.params));
    while let Some(value) = work.pop() {
        if std::mem::replace(&mut live[value], true) {
            continue;
        }
        match origin[value] {
            Origin::None => {}
            Origin::Inst(block, n) => func.blocks[block].insts[n as usize].for_each_use(|v| work.push(v)),
            Origin::Param(block, n) => {
                for from in &jumps[block] {
                    func.blocks[*from].term.for_each_target(|target| {
                        if target.block == block {
                            work.push(target.args[n as usize]);
                        }
                    });
                }
            }
        }
    }
    let mut any = false;
    let drop: IndexVec<BlockId, Vec<bool>> = func
        .blocks
        .iter()
        .map(|block| {
            let dead: Vec<bool> = block.params.iter().map(|v| !live[*v]).collect();
            any |= dead.contains(&true);
            dead
        })
        .collect();
    if any {
        remove_parameters(func, &drop);
    }
    for block in &mut func.blocks {
        let count = block.insts.len();
        block.insts.retain(|inst| !is_pure(inst) || inst.results().0.is_none_or(|v| live[v]));
        any |= block.insts.len() != count;
    }
    any
}

/// Jumps over blocks that do nothing but jump, and branches whose ways are one.
fn skip_empty_blocks(func: &mut Func) -> bool {
    let mut reads: IndexVec<ValueId, u32> = super::rewrite::use_counts(func);
    let mut changed = false;
    for id in func.blocks.indices() {
        let mut term = std::mem::replace(&mut func.blocks[id].term, Term::Return(None));
        let single = matches!(term, Term::Jump(_));
        visit::targets(&mut term, &mut |target| {
            // As many steps as a chain can have without going round.
            for _ in 0..func.blocks.len() {
                let Some(next) = skipped(func, id, target, &reads) else { break };
                if !single && next.args.len() > target.args.len() {
                    break;
                }
                next.args.iter().for_each(|v| reads[*v] += 1);
                target.args.iter().for_each(|v| reads[*v] -= 1);
                *target = next;
                changed = true;
            }
        });
        if let Term::Branch { then, otherwise, .. } = &term
            && then == otherwise
        {
            term = Term::Jump(then.clone());
            changed = true;
        }
        if let Term::Switch { cases, default, .. } = &mut term {
            let count = cases.len();
            cases.retain(|(_, target)| target != default);
            changed |= cases.len() != count;
            if cases.is_empty() {
                term = Term::Jump(default.clone());
                changed = true;
            }
        }
        func.blocks[id].term = term;
    }
    changed
}

/// Where a jump ends if its target only jumps on; its parameters may then be read nowhere else.
fn skipped(func: &Func, from: BlockId, target: &Target, reads: &IndexVec<ValueId, u32>) -> Option<Target> {
    let block = &func.blocks[target.block];
    if target.block == from || !block.insts.is_empty() {
        return None;
    }
    let Term::Jump(next) = &block.term else { return None };
    if next.block == target.block {
        return None;
    }
    for param in &block.params {
        let here = next.args.iter().filter(|v| *v == param).count();
        if reads[*param] as usize != here {
            return None;
        }
    }
    let pass = |v: &ValueId| match block.params.iter().position(|p| p == v) {
        Some(n) => target.args[n],
        None => *v,
    };
    Some(Target { block: next.block, args: next.args.iter().map(pass).collect() })
}

/// A block that goes only to one that comes only from it.
fn join_blocks(func: &mut Func) -> bool {
    let mut ways: IndexVec<BlockId, u32> = IndexVec::from_vec(vec![0; func.blocks.len()]);
    for block in &func.blocks {
        block.term.for_each_target(|target| ways[target.block] += 1);
    }
    let mut replace = Replace::new(func);
    let mut changed = false;
    for id in func.blocks.indices() {
        while let Term::Jump(target) = &func.blocks[id].term {
            let next = target.block;
            if next == id || next.index() == 0 || ways[next] != 1 {
                break;
            }
            let args = target.args.clone();
            let empty = Block { params: Vec::new(), insts: Vec::new(), term: Term::Jump(super::rewrite::to(next)) };
            let Block { params, insts, term } = std::mem::replace(&mut func.blocks[next], empty);
            for (param, arg) in params.iter().zip(&args) {
                replace.set(*param, *arg);
            }
            // What is left of it is reached from itself only.
            ways[next] = u32::MAX;
            let block = &mut func.blocks[id];
            block.insts.extend::<Vec<Inst>>(insts);
            block.term = term;
            changed = true;
        }
    }
    if changed {
        replace.apply(func);
    }
    changed
}
