//! Passes of a loop over neighbouring elements are done side by side, so that code generation finds in a row what one
//! instruction can do for all of them ([`lanes`](crate::lanes)).
//!
//! Every instruction that differs from pass to pass stands there once for each of so many passes, one after the other; a
//! loop inside goes through its passes for all of them at once. What belongs to one element keeps its order, so that reals
//! stay what they are. This needs: a known number of passes; conditions inside that are the same for all elements; no check,
//! no call; no element that one pass writes and another one touches in the other order; and a fault of the watchdog must
//! find the memory that it found before.
//!
//! ```text
//! b1(v1): v2 = load f64 x[v1]          b1(v1): v2 = load f64 x[v1]
//!     v3 = fmul f64 v2, v0                 v9 = load f64 x[v1]+8
//!     store f64 y[v1] := v3       =>       v3 = fmul f64 v2, v0
//!     v4 = add i64 v1, 1                   v10 = fmul f64 v9, v0
//!     v5 = eq i64 v4, 64                   store f64 y[v1] := v3
//!     if v5 then b2 else b1(v4)            store f64 y[v1]+8 := v10 ...
//! ```

mod look;

use super::alias::Alias;
use super::loops::{self, Loop};
use super::ranges::facts::Facts;
use super::ranges::induction::Loops;
use super::unroll;
use crate::dominators::Dominators;
use crate::ir::{Args, Block, BlockId, Func, Inst, Term, ValueId};
use crate::lanes;
use crate::visit;
use look::Look;
use plcc_stdlib::prim::PrimOp;
use rustc_hash::{FxHashMap, FxHashSet};

/// A loop of more instructions is left alone: its values would be spilled.
const LARGE: usize = 200;

/// Whether a function has a loop and stores an element of a fitting size at all.
pub fn may_help(func: &Func) -> bool {
    let stores = func.blocks.iter().flat_map(|block| &block.insts).any(|inst| match inst {
        Inst::Store { place, value } => !place.index.is_empty() && lanes::count(func.values[*value]).is_some(),
        _ => false,
    });
    stores && super::may_loop(func)
}

/// The pass.
pub fn run(func: &mut Func, alias: &Alias) {
    // Passes that are left over come first; then the loop is looked at again.
    let again = round(func, alias);
    super::tidy(func);
    if again {
        round(func, alias);
        super::tidy(func);
    }
}

/// One look at all loops. Gives whether one of them is to be looked at again.
fn round(func: &mut Func, alias: &Alias) -> bool {
    let loops = loops::find(func);
    let tree = Dominators::new(func);
    let facts = Facts::new(func);
    let counted = Loops::new(func, &tree, &facts);
    let mut plans: Vec<(Plan, &Loop)> = Vec::new();
    let mut taken: FxHashSet<BlockId> = FxHashSet::default();
    for l in &loops {
        let size: usize = l.blocks.iter().map(|b| func.blocks[*b].insts.len()).sum();
        if size > LARGE || l.blocks.iter().any(|block| taken.contains(block)) {
            continue;
        }
        let look = Look { func, alias, tree: &tree, facts: &facts, counted: &counted, l, size };
        if let Some(plan) = look.plan() {
            taken.extend(&l.blocks);
            plans.push((plan, l));
        }
    }
    let mut again = false;
    for (plan, l) in &plans {
        if plan.left_over > 0 {
            let from_outside = |pred: &BlockId| !l.blocks.contains(pred);
            let entries = tree.preds[l.header].iter().copied().filter(from_outside).collect();
            unroll::peel(func, l.header, &l.blocks, plan.test, entries, plan.left_over);
            again = true;
        } else {
            plan.carry_out(func, l);
        }
    }
    again
}

/// How a value differs between passes that are done side by side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// It does not.
    Same,
    /// An I64 that grows by so much from pass to pass.
    Step(i64),
    /// A value of its own, of so many bytes, as [`lanes::operation`] makes them.
    Lanes(u32),
    /// A truth value of its own, from operands of so many bytes.
    Mask(u32),
    /// A value of its own that the loop's end, polls and what stands behind the loop read only.
    Aside,
    /// A parameter of the header that is not counted: polls show it before anything of the pass is stored.
    Before,
}

/// What is done with a loop.
struct Plan {
    /// So many passes side by side.
    times: usize,
    /// So many of the passes in front, alone; then nothing else is done.
    left_over: usize,
    /// The block with the way out.
    test: BlockId,
    kinds: FxHashMap<ValueId, Kind>,
    /// The step of each parameter of the header that is counted.
    steps: FxHashMap<ValueId, i64>,
    /// Polls (block, position) that show what the first of the passes knows; the others show the last.
    early: FxHashSet<(BlockId, usize)>,
}

impl Plan {
    /// The last of the passes keeps the names of the values: what is read behind the loop comes from it.
    fn carry_out(&self, func: &mut Func, l: &Loop) {
        let others = self.times - 1;
        let differs = |value: &ValueId| {
            matches!(self.kinds.get(value), Some(Kind::Step(_) | Kind::Lanes(_) | Kind::Mask(_) | Kind::Aside))
        };
        let params: FxHashMap<BlockId, Vec<ValueId>> =
            l.blocks.iter().map(|block| (*block, func.blocks[*block].params.clone())).collect();
        // The names of a value in the other passes.
        let mut names: FxHashMap<ValueId, Vec<ValueId>> = FxHashMap::default();
        for &block in &l.blocks {
            let mut defined: Vec<ValueId> = func.blocks[block].params.clone();
            defined.extend(func.blocks[block].insts.iter().filter_map(|inst| inst.results().0));
            for value in defined.into_iter().filter(differs) {
                let repr = func.values[value];
                names.insert(value, (0..others).map(|_| func.values.push(repr)).collect());
            }
        }
        let rename = |value: &mut ValueId, lane: usize| {
            if let Some(list) = names.get(value) {
                *value = list[lane];
            }
        };
        for &id in &l.blocks {
            let mut block = std::mem::replace(
                &mut func.blocks[id],
                Block { params: Vec::new(), insts: Vec::new(), term: Term::Return(None) },
            );
            let mut insts = Vec::with_capacity(block.insts.len() * self.times);
            if id == l.header {
                for param in &mut block.params {
                    let Some(step) = self.steps.get(param) else { continue };
                    let repr = func.values[*param];
                    let first = names[param][0];
                    for (n, dst) in names[param].iter().copied().chain([*param]).enumerate().skip(1) {
                        let by = func.values.push(repr);
                        let raw = step.wrapping_mul(n as i64) as u64 & repr.mask();
                        insts.push(Inst::Const { dst: by, raw });
                        insts.push(Inst::Prim { dst, op: PrimOp::Add, repr, args: Args::Two([first, by]) });
                    }
                    *param = first;
                }
            } else {
                let mut params = Vec::with_capacity(block.params.len());
                for param in block.params {
                    params.extend(names.get(&param).into_iter().flatten());
                    params.push(param);
                }
                block.params = params;
            }
            for (at, mut inst) in block.insts.into_iter().enumerate() {
                let copied = match &inst {
                    Inst::Store { .. } => true,
                    _ => inst.results().0.is_some_and(|dst| differs(&dst)),
                };
                if copied {
                    for lane in 0..others {
                        let mut copy = inst.clone();
                        visit::uses(&mut copy, &mut |value| rename(value, lane));
                        visit::defs(&mut copy, &mut |value| rename(value, lane));
                        insts.push(copy);
                    }
                } else if self.early.contains(&(id, at)) {
                    visit::uses(&mut inst, &mut |value| rename(value, 0));
                }
                insts.push(inst);
            }
            block.insts = insts;
            visit::targets(&mut block.term, &mut |target| {
                if target.block == l.header || !l.blocks.contains(&target.block) {
                    return;
                }
                let args = std::mem::take(&mut target.args);
                for (param, arg) in params[&target.block].iter().zip(args) {
                    if names.contains_key(param) {
                        target.args.extend((0..others).map(|lane| {
                            let mut value = arg;
                            rename(&mut value, lane);
                            value
                        }));
                    }
                    target.args.push(arg);
                }
            });
            func.blocks[id] = block;
        }
    }
}
