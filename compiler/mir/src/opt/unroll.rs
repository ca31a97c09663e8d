//! Short loops of a known number of passes become straight code; longer ones with a small body do several passes in one.
//!
//! A loop is known if it has one way out, taken or not by values that move in even steps from constants: a FOR loop
//! without EXIT. The passes stay in their order; only what is known of the test between them goes, and polls but the last.
//!
//! ```text
//! b0: v0 = i16 2                        b0: store i16 a := 0
//!     v1 = i16 0                            store i16 a+2 := 1
//!     jump b1(v1, v0)                       store i16 a+4 := 2
//! b1(v2, v3): store i16 a[v2] := v2    =>
//!     if v3 = 0 then b3 else b2
//! b2: jump b1(v2 + 1, v3 - 1)
//! ```

use super::fold::Def;
use super::ranges::facts::Facts;
use super::ranges::induction::Loops;
use crate::dominators::Dominators;
use crate::ir::{Block, BlockId, Func, Inst, Target, Term, ValueId};
use crate::visit;
use plcc_stdlib::prim::eval;
use rustc_hash::FxHashMap;

/// A loop of at most so many passes can go altogether,
const FULL_PASSES: u64 = 16;
/// if so many instructions come of it.
const FULL_SIZE: usize = 160;
/// A body of at most so many instructions is done four times in one pass,
const FOUR_TIMES: usize = 16;
/// of so many twice.
const TWICE: usize = 32;
/// Loops of more passes than can be counted here are left alone.
const COUNTED: u64 = 4096;
/// Instructions that a function may grow by, besides its own size.
const GROWTH: usize = 1000;

/// The pass.
pub fn run(func: &mut Func) {
    let size: usize = func.blocks.iter().map(|b| b.insts.len()).sum();
    let mut budget = size + GROWTH;
    // What is around a loop that went may go next; what was repeated once is not repeated again.
    for round in 0..2 {
        let plans = plans(func, round == 0);
        let mut gone = false;
        for plan in plans {
            let cost = plan.size * (plan.copies() - 1);
            if cost <= budget {
                budget -= cost;
                gone |= plan.full();
                plan.carry_out(func);
            }
        }
        if !gone {
            break;
        }
        super::tidy(func);
    }
}

/// What is done with a loop.
struct Plan {
    header: BlockId,
    /// In reverse post-order, the header first.
    blocks: Vec<BlockId>,
    size: usize,
    /// The block with the way out.
    test: BlockId,
    /// Where the loop is entered from.
    entries: Vec<BlockId>,
    /// Passes in front of the loop.
    before: usize,
    /// Passes in one of the loop; 0: nothing of it is left, all passes stand in front.
    repeated: usize,
}

fn plans(func: &Func, partly: bool) -> Vec<Plan> {
    let tree = Dominators::new(func);
    let facts = Facts::new(func);
    let loops = Loops::new(func, &tree, &facts);
    let mut inner = vec![true; loops.list.len()];
    loops.list.iter().filter_map(|l| l.parent).for_each(|parent| inner[parent] = false);
    let mut blocks: Vec<Vec<BlockId>> = vec![Vec::new(); loops.list.len()];
    let mut headers = vec![None; loops.list.len()];
    for block in &tree.order {
        if let Some(n) = loops.of_block[*block] {
            blocks[n].push(*block);
        }
        if let Some(n) = loops.of_header[*block] {
            headers[n] = Some(*block);
        }
    }
    let mut plans = Vec::new();
    for (n, blocks) in blocks.into_iter().enumerate() {
        let Some(header) = headers[n].filter(|_| inner[n]) else { continue };
        let size: usize = blocks.iter().map(|b| func.blocks[*b].insts.len()).sum();
        if size > FULL_SIZE || header.index() == 0 {
            continue;
        }
        if let Some(test) = only_exit(func, &loops, n, &blocks)
            && tree.preds[header].iter().all(|pred| loops.of_block[*pred] != Some(n) || tree.dominates(test, *pred))
            && !blocks.iter().flat_map(|b| &func.blocks[*b].insts).any(|inst| matches!(inst, Inst::Call { .. }))
            && let Some(passes) = count(func, &facts, &loops, n, (header, test), &tree)
        {
            let full = passes <= FULL_PASSES && size * passes as usize <= FULL_SIZE;
            let times = match size {
                _ if full => 0,
                0..=FOUR_TIMES => 4,
                _ if size <= TWICE => 2,
                _ => continue,
            };
            if !full && (!partly || passes < 2 * times) {
                continue;
            }
            let before = if full { passes } else { passes % times };
            let from_outside = |pred: &BlockId| loops.of_block[*pred] != Some(n);
            let entries = tree.preds[header].iter().copied().filter(from_outside).collect();
            plans.push(Plan { header, blocks, size, test, entries, before: before as usize, repeated: times as usize });
        }
    }
    plans
}

/// The block with the only way out of a loop, a branch.
fn only_exit(func: &Func, loops: &Loops, n: usize, blocks: &[BlockId]) -> Option<BlockId> {
    let mut exits = Vec::new();
    for block in blocks {
        func.blocks[*block].term.for_each_target(|target| {
            if loops.of_block[target.block] != Some(n) {
                exits.push(*block);
            }
        });
    }
    match exits[..] {
        [test] if matches!(func.blocks[test].term, Term::Branch { .. }) => Some(test),
        _ => None,
    }
}

/// Puts so many passes of a loop in front of it. The blocks are in reverse post-order, the header first; there are no polls.
pub fn peel(func: &mut Func, header: BlockId, blocks: &[BlockId], test: BlockId, entries: Vec<BlockId>, passes: usize) {
    let plan = Plan { header, blocks: blocks.to_vec(), size: 0, test, entries, before: passes, repeated: 1 };
    plan.carry_out(func);
}

/// How often the header runs for one entry.
pub fn count(
    func: &Func,
    facts: &Facts,
    loops: &Loops,
    n: usize,
    (header, test): (BlockId, BlockId),
    tree: &Dominators,
) -> Option<u64> {
    let Term::Branch { cond, then, .. } = &func.blocks[test].term else { return None };
    let leaves_on = loops.of_block[then.block] != Some(n);
    let params = &func.blocks[header].params;
    // What moves in even steps from one constant.
    let mut moving: FxHashMap<ValueId, (u64, i64)> = FxHashMap::default();
    for step in &loops.list[n].steps {
        let mut first = None;
        let mut same = true;
        for pred in tree.preds[header].iter().filter(|pred| loops.of_block[**pred] != Some(n)) {
            func.blocks[*pred].term.for_each_target(|target| {
                if target.block == header {
                    let raw = match facts.def(target.args[step.param]) {
                        Def::Const(raw) => Some(raw),
                        _ => None,
                    };
                    same &= raw.is_some() && (first.is_none() || first == raw);
                    first = raw;
                }
            });
        }
        if let Some(first) = first.filter(|_| same) {
            moving.insert(params[step.param], (first, step.step));
        }
    }
    for pass in 0..COUNTED {
        let known = |value: ValueId| {
            let (first, step) = moving.get(&value)?;
            Some(first.wrapping_add((*step as u64).wrapping_mul(pass)) & facts.repr(value).mask())
        };
        if (value(facts, *cond, &known, 4)? != 0) == leaves_on {
            return Some(pass + 1);
        }
    }
    None
}

/// A value from those that are known.
fn value(facts: &Facts, of: ValueId, known: &impl Fn(ValueId) -> Option<u64>, depth: u32) -> Option<u64> {
    if let Some(raw) = known(of) {
        return Some(raw);
    }
    match facts.def(of) {
        Def::Const(raw) => Some(raw),
        Def::Prim(op, repr, args) if depth > 0 => {
            let mut raws = [0; 3];
            for (raw, arg) in raws.iter_mut().zip(args.iter()) {
                *raw = value(facts, *arg, known, depth - 1)?;
            }
            Some(eval(op, repr, &raws[..args.len()]))
        }
        _ => None,
    }
}

impl Plan {
    /// How many times the body stands there.
    fn copies(&self) -> usize {
        self.before + self.repeated
    }

    /// Whether nothing of the loop is left.
    fn full(&self) -> bool {
        self.repeated == 0
    }

    /// Puts copies in front of the loop's own blocks, which are the last pass: what is used behind the loop comes from it.
    fn carry_out(&self, func: &mut Func) {
        let copies = self.copies();
        let numbers: FxHashMap<BlockId, usize> = self.blocks.iter().enumerate().map(|(n, b)| (*b, n)).collect();
        let inside = |target: &Target| numbers.contains_key(&target.block);
        // Block n of copy k.
        let start = func.blocks.len();
        let block = |copy: usize, n: usize| {
            if copy == copies - 1 { self.blocks[n] } else { BlockId::from_usize(start + copy * self.blocks.len() + n) }
        };
        for copy in 0..copies - 1 {
            let mut renamed: FxHashMap<ValueId, ValueId> = FxHashMap::default();
            // Definitions first: a use may stand in a block before that of its definition.
            let mut bodies: Vec<Block> = self.blocks.iter().map(|b| func.blocks[*b].clone()).collect();
            for body in &mut bodies {
                // A poll for each round of the loop, or one for a loop that is gone.
                let keeps_poll = if self.full() { copy + 2 == copies } else { false };
                body.insts.retain(|inst| keeps_poll || !matches!(inst, Inst::Poll { .. }));
                let mut define = |v: &mut ValueId| {
                    let fresh = func.values.push(func.values[*v]);
                    renamed.insert(*v, fresh);
                    *v = fresh;
                };
                body.params.iter_mut().for_each(&mut define);
                body.insts.iter_mut().for_each(|inst| visit::defs(inst, &mut define));
            }
            let rename = |v: &mut ValueId| *v = renamed.get(v).copied().unwrap_or(*v);
            for (mut body, id) in bodies.into_iter().zip(&self.blocks) {
                body.insts.iter_mut().for_each(|inst| visit::uses(inst, &mut |v| rename(v)));
                if *id == self.test
                    && let Term::Branch { then, otherwise, .. } = body.term
                {
                    // Not the last pass.
                    body.term = Term::Jump(if inside(&then) { then } else { otherwise });
                }
                visit::term_uses(&mut body.term, &mut |v| rename(v));
                visit::targets(&mut body.term, &mut |target| {
                    if target.block == self.header {
                        target.block = block(copy + 1, 0);
                    } else if let Some(n) = numbers.get(&target.block) {
                        target.block = block(copy, *n);
                    }
                });
                func.blocks.push(body);
            }
        }
        // The last pass: out of it for good, or back to the first one of the loop.
        if self.full() {
            let term = std::mem::replace(&mut func.blocks[self.test].term, Term::Return(None));
            func.blocks[self.test].term = match term {
                Term::Branch { then, otherwise, .. } => Term::Jump(if inside(&then) { otherwise } else { then }),
                other => other,
            };
        } else {
            for id in &self.blocks {
                visit::targets(&mut func.blocks[*id].term, &mut |target| {
                    if target.block == self.header {
                        target.block = block(self.before, 0);
                    }
                });
            }
        }
        // All that came into the loop comes into the first copy.
        for id in &self.entries {
            visit::targets(&mut func.blocks[*id].term, &mut |target| {
                if target.block == self.header {
                    target.block = block(0, 0);
                }
            });
        }
    }
}
