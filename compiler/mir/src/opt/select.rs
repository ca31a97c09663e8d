//! Short branches become selections: both arms are calculated, and what they assign is chosen.
//!
//! An arm qualifies if it is short, can neither fault nor take long, and assigns a few integers at places that are safe to access there ([`Proven`]), or values.
//! The time of such code does not depend on its inputs, and a branch that is missed costs more than the arm. A place that
//! only one arm assigns is read first and written back: no one else sees that. Reals are left to branches, which is what
//! the machine makes of their selection anyway.
//!
//! ```text
//! b0: if v0 then b1 else b2            b0: v2 = load i16 state
//! b1: store i16 state := v1     =>         v3 = select i16 v0, v1, v2
//!     jump b2                              store i16 state := v3
//!                                          jump b2
//! ```

use super::alias::Alias;
use super::proven::Proven;
use crate::dominators::Dominators;
use crate::ir::{Args, BlockId, Func, Inst, Place, Target, Term, ValueId};
use index_vec::IndexVec;
use plcc_stdlib::prim::{PrimOp, Repr};
use rustc_hash::FxHashMap;

/// Operations and loads of both arms together.
const COST: usize = 8;

/// Places that both arms together assign.
const STORES: usize = 3;

/// Values that are chosen.
const CHOICES: usize = 4;

/// The pass.
pub fn run(func: &mut Func, alias: &Alias) {
    // Inner branches first; what they become may make the outer ones short.
    loop {
        super::clean::run(func);
        let mut ways: IndexVec<BlockId, u32> = IndexVec::from_vec(vec![0; func.blocks.len()]);
        for block in &func.blocks {
            block.term.for_each_target(|target| ways[target.block] += 1);
        }
        let (tree, proven) = (Dominators::new(func), Proven::new(func));
        let safe = |place: &Place, at: BlockId| proven.is_safe(place, at, &tree);
        let mut changed = false;
        for id in (0..func.blocks.len()).rev().map(BlockId::from_usize) {
            if let Some(plan) = plan(func, alias, &ways, &safe, id) {
                apply(func, id, plan);
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
}

/// An arm: its block, if it has one, and what it gives to the block where both meet.
struct Arm {
    block: Option<BlockId>,
    args: Vec<ValueId>,
}

/// A branch that becomes selections.
struct Plan {
    cond: ValueId,
    arms: [Arm; 2],
    join: BlockId,
    /// What is assigned: the place, its representation, what each arm assigns.
    stores: Vec<(Place, Repr, [Option<ValueId>; 2])>,
}

fn plan(
    func: &Func,
    alias: &Alias,
    ways: &IndexVec<BlockId, u32>,
    safe: &impl Fn(&Place, BlockId) -> bool,
    id: BlockId,
) -> Option<Plan> {
    let Term::Branch { cond, then, otherwise } = &func.blocks[id].term else { return None };
    let through = |target: &Target| -> Option<Target> {
        let block = &func.blocks[target.block];
        match &block.term {
            Term::Jump(next) if ways[target.block] == 1 && block.params.is_empty() && next.block != target.block => {
                Some(next.clone())
            }
            _ => None,
        }
    };
    let arm = |target: &Target, onward: &Option<Target>, join: BlockId| match onward {
        Some(next) if next.block == join => Some(Arm { block: Some(target.block), args: next.args.clone() }),
        _ if target.block == join => Some(Arm { block: None, args: target.args.clone() }),
        _ => None,
    };
    let (then_on, otherwise_on) = (through(then), through(otherwise));
    let joins = [then_on.as_ref().map(|t| t.block), otherwise_on.as_ref().map(|t| t.block)];
    let joins = [joins[0], joins[1], Some(then.block), Some(otherwise.block)];
    let (join, arms) = joins.into_iter().flatten().find_map(|join| {
        let arms = [arm(then, &then_on, join)?, arm(otherwise, &otherwise_on, join)?];
        Some((join, arms))
    })?;
    if join == id {
        return None;
    }
    let mut stores: Vec<(Place, Repr, [Option<ValueId>; 2])> = Vec::new();
    let mut cost = 0;
    for (n, arm) in arms.iter().enumerate() {
        let Some(block) = arm.block else { continue };
        let mut assigned: Vec<(&Place, i64)> = Vec::new();
        for inst in &func.blocks[block].insts {
            match inst {
                Inst::Const { .. } => {}
                Inst::Prim { op, .. } if is_cheap(*op) => cost += 1,
                Inst::Load { dst, place, .. } if safe(place, id) => {
                    let bytes = i64::from(func.values[*dst].bytes());
                    if assigned.iter().any(|(p, b)| alias.overlap(p, *b, place, bytes)) {
                        return None;
                    }
                    cost += 1;
                }
                Inst::Store { place, value } if place.bit.is_none() && safe(place, id) => {
                    let repr = func.values[*value];
                    let bytes = i64::from(repr.bytes());
                    if !repr.is_int() {
                        return None;
                    }
                    assigned.push((place, bytes));
                    match stores.iter_mut().find(|(p, r, _)| p == place && *r == repr) {
                        Some((_, _, values)) => values[n] = Some(*value),
                        None => {
                            let clash =
                                stores.iter().any(|(p, r, _)| alias.overlap(p, i64::from(r.bytes()), place, bytes));
                            if clash {
                                return None;
                            }
                            let mut values = [None, None];
                            values[n] = Some(*value);
                            stores.push((place.clone(), repr, values));
                        }
                    }
                }
                _ => return None,
            }
        }
    }
    let chosen: Vec<ValueId> =
        arms[0].args.iter().zip(&arms[1].args).filter(|(a, b)| a != b).map(|(a, _)| *a).collect();
    let reals = chosen.iter().any(|v| !func.values[*v].is_int());
    // A place that one arm leaves alone is read and written back.
    let extra = stores.iter().filter(|(_, _, values)| values.contains(&None)).count();
    // Where only one arm assigns, a branch around it costs little and no memory; it stays but for a single value that is
    // there already.
    if extra > 0 && (stores.len() > 1 || cost > 1) {
        return None;
    }
    if reals || stores.len() > STORES || stores.len() + chosen.len() > CHOICES || cost + extra > COST {
        return None;
    }
    Some(Plan { cond: *cond, arms, join, stores })
}

/// Whether an operation costs about as much as a selection.
fn is_cheap(op: PrimOp) -> bool {
    use PrimOp::*;
    !matches!(
        op,
        DivS | DivU
            | RemS
            | RemU
            | FDiv
            | FSqrt
            | FCeil
            | FFloor
            | FTrunc
            | FNearest
            | FToS(_)
            | FToU(_)
            | SToF(_)
            | UToF(_)
    )
}

fn apply(func: &mut Func, id: BlockId, plan: Plan) {
    let mut insts = std::mem::take(&mut func.blocks[id].insts);
    for arm in &plan.arms {
        let Some(block) = arm.block else { continue };
        let body = std::mem::take(&mut func.blocks[block].insts);
        insts.extend(body.into_iter().filter(|inst| !matches!(inst, Inst::Store { .. })));
    }
    let choose = |insts: &mut Vec<Inst>, func: &mut Func, repr: Repr, a: ValueId, b: ValueId| {
        if a == b {
            return a;
        }
        // In its arms the condition is known.
        let known = |value: ValueId, raw: u64, insts: &mut Vec<Inst>, func: &mut Func| {
            if value != plan.cond {
                return value;
            }
            let dst = func.values.push(repr);
            insts.push(Inst::Const { dst, raw });
            dst
        };
        let a = known(a, 1, insts, func);
        let b = known(b, 0, insts, func);
        let dst = func.values.push(repr);
        insts.push(Inst::Prim { dst, op: PrimOp::Select, repr, args: Args::Three([plan.cond, a, b]) });
        dst
    };
    for (place, repr, values) in &plan.stores {
        let mut old = None;
        let mut given = |value: Option<ValueId>, insts: &mut Vec<Inst>, func: &mut Func| {
            value.or(old).unwrap_or_else(|| {
                let dst = func.values.push(*repr);
                insts.push(Inst::Load { dst, place: place.clone(), normalise: false });
                old = Some(dst);
                dst
            })
        };
        let a = given(values[0], &mut insts, func);
        let b = given(values[1], &mut insts, func);
        let value = choose(&mut insts, func, *repr, a, b);
        insts.push(Inst::Store { place: place.clone(), value });
    }
    let mut made: FxHashMap<(ValueId, ValueId), ValueId> = FxHashMap::default();
    let mut args = Vec::with_capacity(plan.arms[0].args.len());
    for (a, b) in plan.arms[0].args.iter().zip(&plan.arms[1].args) {
        let repr = func.values[*a];
        let value = match made.get(&(*a, *b)) {
            Some(value) => *value,
            None => choose(&mut insts, func, repr, *a, *b),
        };
        made.insert((*a, *b), value);
        args.push(value);
    }
    func.blocks[id].insts = insts;
    func.blocks[id].term = Term::Jump(Target { block: plan.join, args });
}
