//! Intervals of integers: removes checks that cannot fail, decides comparisons, takes polls out of short loops.
//!
//! A walk over the dominator tree knows for each value an interval (`interval`), and at each point which conditions hold:
//! those of branches and cases on the way, and of checks that passed (`facts`). Parameters of loops begin with what comes
//! in and grow until nothing changes; a FOR counter bounds what moves with it at once (`induction`). Then two more walks
//! make the intervals narrower again, and the last one rewrites (`improve`).
//!
//! ```text
//! b1: v0 = i16 0                             b1: v0 = i16 0
//!     v1 = i16 9                                 v1 = i16 9
//!     jump b2(v0, v1)                            jump b2(v0, v1)
//! b2(v2, v3):                                b2(v2, v3):
//!     v4 = sext_i64 i16 v2              =>       v4 = zext_i64 i16 v2
//!     check 0 <= v4 <= 9
//!     store i32 a[v4] := v5                      store i32 a[v4] := v5
//!     if v3 = 0 then b4 else b3                  if v3 = 0 then b4 else b3
//! b3: poll
//!     jump b2(v2 + 1, v3 - 1)                b3: jump b2(v2 + 1, v3 - 1)
//! ```
//!
//! The walks are near-linear: their number is bounded, and each looks only a few operations back from a condition.

pub(super) mod facts;
mod improve;
pub(super) mod induction;
mod interval;

use super::fold::Def;
use super::rewrite::Replace;
use crate::dominators::Dominators;
use crate::ir::{BlockId, Cond, Func, Inst, Target, Term, UNPOLLED_PASSES, ValueId};
use facts::Facts;
use improve::Improved;
use index_vec::IndexVec;
use induction::{Loops, Step};
use interval::{Interval, compare};
use plcc_stdlib::prim::PrimOp::{self, LeS, LeU, LtS, LtU};
use plcc_stdlib::prim::Repr;
use rustc_hash::FxHashMap;

/// Walks in which intervals may grow before parameters of loops are given up.
const GROWING: usize = 16;
/// How often the interval of a parameter is met exactly before its ends jump to the constants of comparisons.
const EXACT: u8 = 2;
/// How often it grows before its ends go to their limits.
const STOPS: u8 = 5;
/// Walks that make intervals narrower.
const SHRINKING: usize = 2;

/// The pass.
pub fn run(func: &mut Func) {
    if func.values.iter().any(|repr| repr.is_int()) {
        Walker::new(func).run(UNPOLLED_PASSES);
    }
}

/// The pass when loops do several passes in one, so that their number tells nothing of polls: those in loops stay.
pub fn run_late(func: &mut Func) {
    if func.values.iter().any(|repr| repr.is_int()) {
        Walker::new(func).run(0);
    }
}

/// What a walk is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    /// Intervals of parameters grow until they hold all that comes back.
    Grow,
    /// They become what really comes back.
    Shrink,
    /// The code is rewritten.
    Rewrite,
}

struct Walker<'a> {
    func: &'a mut Func,
    tree: Dominators,
    children: IndexVec<BlockId, Vec<BlockId>>,
    position: IndexVec<BlockId, u32>,
    facts: Facts,
    loops: Loops,
    /// Comparisons by what they compare.
    comparisons: FxHashMap<(PrimOp, ValueId, ValueId), Vec<(BlockId, ValueId)>>,
    /// Where loops may end: constants that something is compared with, and their neighbours; sorted.
    stops: Vec<i64>,
    mode: Mode,
    changed: bool,
    /// Growing took too long: parameters that get something back are unknown.
    given_up: bool,
    /// A walk has seen what really comes back.
    settled: bool,
    reached: IndexVec<BlockId, bool>,
    /// What the value of a choice is on the ways to a block.
    chosen: IndexVec<BlockId, Option<Interval>>,
    /// By ways back.
    reached_back: IndexVec<BlockId, bool>,
    /// What comes in on ways forward, this walk.
    fore: IndexVec<ValueId, Option<Interval>>,
    /// What came back in the walk before; while growing also what was added for safety.
    back: IndexVec<ValueId, Option<Interval>>,
    next_back: IndexVec<ValueId, Option<Interval>>,
    /// What the header of a loop took its parameters for, this walk.
    taken: IndexVec<ValueId, Interval>,
    /// Parameters of which the header knows without what comes back.
    covered: IndexVec<ValueId, bool>,
    growth: IndexVec<ValueId, u8>,
    /// Loops whose polls go.
    unpolled: Vec<bool>,
    replace: Replace,
}

/// A step of the walk over the dominator tree.
enum Visit {
    Enter(BlockId),
    /// Takes back what was assumed in a subtree.
    Leave(usize),
}

impl<'a> Walker<'a> {
    fn new(func: &'a mut Func) -> Self {
        let tree = Dominators::new(func);
        let facts = Facts::new(func);
        let loops = Loops::new(func, &tree, &facts);
        let (blocks, values) = (func.blocks.len(), func.values.len());
        let mut children = IndexVec::from_vec(vec![Vec::new(); blocks]);
        let mut position = IndexVec::from_vec(vec![u32::MAX; blocks]);
        for (n, block) in tree.order.iter().enumerate() {
            position[*block] = n as u32;
            if let Some(above) = tree.idom[*block] {
                // In reverse post-order, so that the ways forward into a block are walked before it.
                children[above].push(*block);
            }
        }
        let mut comparisons: FxHashMap<_, Vec<_>> = FxHashMap::default();
        for (block, body) in func.blocks.iter_enumerated() {
            for inst in &body.insts {
                if let Inst::Prim { dst, op: op @ (LeS | LeU | LtS | LtU), args, .. } = inst {
                    comparisons.entry((*op, args[0], args[1])).or_default().push((block, *dst));
                }
            }
        }
        Self {
            replace: Replace::new(func),
            children,
            position,
            loops,
            comparisons,
            stops: stops(func, &facts),
            mode: Mode::Grow,
            changed: false,
            given_up: false,
            settled: false,
            reached: IndexVec::from_vec(vec![false; blocks]),
            chosen: IndexVec::from_vec(vec![None; blocks]),
            reached_back: IndexVec::from_vec(vec![false; blocks]),
            fore: IndexVec::from_vec(vec![None; values]),
            back: IndexVec::from_vec(vec![None; values]),
            next_back: IndexVec::from_vec(vec![None; values]),
            taken: func.values.iter().map(|repr| Interval::full(*repr)).collect(),
            covered: IndexVec::from_vec(vec![false; values]),
            growth: IndexVec::from_vec(vec![0; values]),
            unpolled: Vec::new(),
            facts,
            tree,
            func,
        }
    }

    /// Loops of up to `unpolled` passes need no poll.
    fn run(mut self, unpolled: u64) {
        let circles = !self.loops.list.is_empty() || self.loops.tangled;
        if circles {
            let mut walks = 0;
            loop {
                self.changed = false;
                self.walk();
                if !self.changed {
                    break;
                }
                walks += 1;
                self.given_up |= walks == GROWING;
            }
            for _ in 0..SHRINKING {
                self.mode = Mode::Shrink;
                self.next_back.iter_mut().for_each(|r| *r = None);
                self.loops.list.iter_mut().flat_map(|l| &mut l.steps).for_each(|step| step.whole = (true, true));
                self.walk();
                std::mem::swap(&mut self.back, &mut self.next_back);
                self.settled = true;
                self.count_passes();
            }
        }
        self.unpolled = self.loops.unpolled(self.func, unpolled);
        self.mode = Mode::Rewrite;
        self.walk();
        self.replace.apply(self.func);
    }

    // ---- the walk ----

    fn walk(&mut self) {
        self.reached.iter_mut().for_each(|r| *r = false);
        self.fore.iter_mut().for_each(|r| *r = None);
        let entry = BlockId::from_usize(0);
        self.reached[entry] = true;
        for (n, back) in self.reached_back.iter().enumerate() {
            self.reached[BlockId::from_usize(n)] |= *back;
        }
        let mut stack = vec![Visit::Enter(entry)];
        while let Some(visit) = stack.pop() {
            match visit {
                Visit::Leave(mark) => self.facts.back_to(mark),
                Visit::Enter(block) => {
                    stack.push(Visit::Leave(self.facts.mark()));
                    // What is not reached does not run, nor what it dominates.
                    if self.reached[block] && self.enter(block) {
                        self.body(block);
                        stack.extend(self.children[block].iter().rev().map(|child| Visit::Enter(*child)));
                    }
                }
            }
        }
    }

    /// Parameters and the condition of the only way in. FALSE if that never holds.
    fn enter(&mut self, block: BlockId) -> bool {
        if block.index() == 0 {
            for param in self.func.blocks[block].params.clone() {
                self.facts.define(param, Interval::full(self.func.values[param]));
            }
            // A way back to the entry tells nothing that matters.
            return true;
        }
        if !self.condition(block) {
            return false;
        }
        let params = self.func.blocks[block].params.clone();
        for param in &params {
            let repr = self.func.values[*param];
            let comes = match (self.fore[*param], self.back[*param]) {
                (Some(x), Some(y)) => x.or(y),
                (Some(x), None) | (None, Some(x)) => x,
                (None, None) => Interval::full(repr),
            };
            let unknown = self.given_up && self.mode == Mode::Grow && self.has_ways_back(block);
            if unknown {
                // What comes back is not known in full, and shrinking starts from here.
                self.back[*param] = Some(Interval::full(repr));
            }
            self.taken[*param] = if unknown { Interval::full(repr) } else { comes };
            self.covered[*param] = false;
        }
        if let Some(n) = self.loops.of_header[block] {
            self.count(block, n, &params);
        }
        for param in params {
            self.facts.define(param, self.taken[param]);
        }
        true
    }

    fn has_ways_back(&self, block: BlockId) -> bool {
        self.tree.preds[block].iter().any(|pred| self.position[*pred] >= self.position[block])
    }

    /// Assumes what the only block in front says.
    fn condition(&mut self, block: BlockId) -> bool {
        let Some((first, others)) = self.tree.preds[block].split_first() else { return true };
        if others.iter().any(|other| other != first) {
            return true;
        }
        match &self.func.blocks[*first].term {
            Term::Branch { cond, then, otherwise } if then.block != otherwise.block => {
                self.facts.assume(*cond, then.block == block)
            }
            Term::Switch { value, .. } => self.chosen[block].is_some_and(|choice| self.facts.narrow(*value, choice)),
            _ => true,
        }
    }

    /// What a loop's parameters are by its counters.
    fn count(&mut self, header: BlockId, n: usize, params: &[ValueId]) {
        let steps = &self.loops.list[n].steps;
        let counts = steps.iter().filter(|step| step.counts_down);
        let by_counter = counts.filter_map(|step| passes_back(step, self.fore[params[step.param]]?)).min();
        let by_range = self.loops.list[n].passes.map(|passes| passes - 1).filter(|_| self.settled);
        let back = [by_counter, by_range].into_iter().flatten().min();
        for step in steps {
            let param = params[step.param];
            let repr = self.func.values[param];
            let Some(first) = self.fore[param] else { continue };
            let mut known = back.and_then(|back| Interval::progression(first, step.step, back, repr));
            let mut add = |more: Option<Interval>| {
                known = match (known, more) {
                    (Some(x), Some(y)) => x.and(y, repr),
                    (x, y) => x.or(y),
                }
            };
            if step.counts_down {
                add(Interval::between_unsigned(repr, 0, first.unsigned.1));
            }
            if let Some(bound) = step.bound.filter(|bound| steps[bound.counter].counts_down) {
                let (low, high) = if step.step > 0 { (bound.first, bound.end) } else { (bound.end, bound.first) };
                let (from, to) = (self.facts.range(low), self.facts.range(high));
                if self.known(header, LeS, low, high) || compare(LeS, from, to) == Some(true) {
                    add(Interval::between_signed(repr, from.signed.0, to.signed.1));
                }
                if self.known(header, LeU, low, high) || compare(LeU, from, to) == Some(true) {
                    add(Interval::between_unsigned(repr, from.unsigned.0, to.unsigned.1));
                }
            }
            let Some(known) = known else { continue };
            self.taken[param] = match self.settled {
                true => self.taken[param].and(known, repr).unwrap_or(known),
                false => known,
            };
            self.covered[param] = true;
        }
    }

    /// Whether a comparison that was made on the way to a block holds there.
    fn known(&self, at: BlockId, op: PrimOp, low: ValueId, high: ValueId) -> bool {
        let strict = if op == LeS { LtS } else { LtU };
        [((op, low, high), 1), ((strict, low, high), 1), ((strict, high, low), 0)].iter().any(|(key, truth)| {
            let made = self.comparisons.get(key).into_iter().flatten();
            // The last ones stand just in front.
            let mut made = made.rev().take(8).filter(|(block, _)| self.tree.dominates(*block, at));
            made.any(|(_, value)| self.facts.noted(*value).single() == Some(*truth))
        })
    }

    fn body(&mut self, block: BlockId) {
        let insts = std::mem::take(&mut self.func.blocks[block].insts);
        let rewrites = self.mode == Mode::Rewrite;
        let mut out = Vec::with_capacity(if rewrites { insts.len() } else { 0 });
        if rewrites {
            self.constant_parameters(block, &mut out);
        }
        for inst in &insts {
            let result = self.facts.result(inst);
            if rewrites {
                self.rewrite(block, inst, result, &mut out);
            }
            if let Some((dst, interval)) = result {
                self.facts.define(dst, interval);
            } else {
                let (first, second) = inst.results();
                for dst in first.into_iter().chain(second) {
                    self.facts.define(dst, Interval::full(self.func.values[dst]));
                }
            }
            match inst {
                // Behind a check that cannot pass nothing runs: what is said of it does not matter.
                Inst::Check { cond: Cond::True(cond), .. } => {
                    self.facts.assume(*cond, true);
                }
                Inst::Check { cond: Cond::Within { value, low, high }, .. } => {
                    if let Some(within) = Interval::between_signed(Repr::I64, *low, *high) {
                        self.facts.narrow(*value, within);
                    }
                }
                _ => {}
            }
        }
        self.func.blocks[block].insts = if rewrites { out } else { insts };
        let term = std::mem::replace(&mut self.func.blocks[block].term, Term::Return(None));
        let term = self.ways(block, term);
        self.func.blocks[block].term = term;
    }

    // ---- ways ----

    /// Follows the ways out of a block that can be taken; gives its end, rewritten if this is the time for it.
    fn ways(&mut self, block: BlockId, term: Term) -> Term {
        match term {
            Term::Jump(target) => {
                self.way(block, &target);
                Term::Jump(target)
            }
            Term::Branch { cond, then, otherwise } => {
                let mut possible = [false; 2];
                for (n, target) in [(0, &otherwise), (1, &then)] {
                    let mark = self.facts.mark();
                    possible[n] = self.facts.can_be(cond, n == 1) && self.facts.assume(cond, n == 1);
                    if possible[n] {
                        self.way(block, target);
                    }
                    self.facts.back_to(mark);
                }
                match possible {
                    [true, false] if self.mode == Mode::Rewrite => Term::Jump(otherwise),
                    [false, true] if self.mode == Mode::Rewrite => Term::Jump(then),
                    _ => Term::Branch { cond, then, otherwise },
                }
            }
            Term::Switch { value, mut cases, mut default } => {
                let range = self.facts.range(value);
                let repr = self.func.values[value];
                let rest = rest(range, repr, &cases);
                cases.iter().map(|(_, target)| target).chain([&default]).for_each(|to| self.chosen[to.block] = None);
                cases.retain(|(label, target)| {
                    let one = range.and(Interval::one(repr, *label), repr);
                    self.choice(block, value, one, target) || self.mode != Mode::Rewrite
                });
                let possible = self.choice(block, value, rest, &default);
                if self.mode == Mode::Rewrite {
                    if !possible && let Some((_, last)) = cases.pop() {
                        default = last;
                    }
                    if cases.is_empty() {
                        return Term::Jump(default);
                    }
                }
                Term::Switch { value, cases, default }
            }
            Term::Return(value) => Term::Return(value),
        }
    }

    /// A way out of a choice; FALSE if it cannot be taken.
    fn choice(&mut self, from: BlockId, value: ValueId, choice: Option<Interval>, target: &Target) -> bool {
        let Some(choice) = choice else { return false };
        let mark = self.facts.mark();
        let possible = self.facts.narrow(value, choice);
        if possible {
            self.way(from, target);
            self.chosen[target.block] = Some(self.chosen[target.block].map_or(choice, |other| other.or(choice)));
        }
        self.facts.back_to(mark);
        possible
    }

    /// A way that can be taken, under its condition.
    fn way(&mut self, from: BlockId, target: &Target) {
        let back = self.position[target.block] <= self.position[from];
        if !back {
            self.reached[target.block] = true;
        } else if !self.reached_back[target.block] {
            self.reached_back[target.block] = true;
            // A circle that is entered in its middle.
            self.changed |= !self.reached[target.block];
        }
        let in_loop = self.loops.of_header[target.block].filter(|_| back);
        for n in 0..target.args.len() {
            let param = self.func.blocks[target.block].params[n];
            let came = self.facts.near(target.args[n]);
            if !back {
                self.fore[param] = Some(self.fore[param].map_or(came, |other| other.or(came)));
                continue;
            }
            if let Some(n_loop) = in_loop {
                self.step(n_loop, n, param);
            }
            match self.mode {
                Mode::Grow if !self.covered[param] => self.grow(param, came),
                Mode::Shrink => {
                    self.next_back[param] = Some(self.next_back[param].map_or(came, |other| other.or(came)));
                }
                Mode::Grow | Mode::Rewrite => {}
            }
        }
    }

    fn grow(&mut self, param: ValueId, came: Interval) {
        let taken = self.taken[param];
        if taken.contains(came) {
            return;
        }
        self.changed = true;
        self.growth[param] = self.growth[param].saturating_add(1);
        let all = if self.growth[param] <= EXACT {
            taken.or(came)
        } else {
            let stops: &[i64] = if self.growth[param] <= STOPS { &self.stops } else { &[0] };
            taken.widened(came, stops, self.func.values[param])
        };
        self.back[param] = Some(self.back[param].map_or(all, |before| before.or(all)));
    }

    /// Does the step of a parameter hold what it promises, at the end of a pass?
    fn step(&mut self, n: usize, param_number: usize, param: ValueId) {
        let repr = self.func.values[param];
        let Some(at) = self.loops.list[n].steps.iter().position(|step| step.param == param_number) else { return };
        let here = self.facts.range(param);
        let step = &mut self.loops.list[n].steps[at];
        if step.counts_down && here.unsigned.0 < step.step.unsigned_abs() {
            step.counts_down = false;
            self.changed = true;
        }
        if self.mode == Mode::Shrink {
            let whole = Interval::full(repr);
            let moved = |end: i128| end + i128::from(step.step);
            let (s, u) = (here.signed, here.unsigned);
            let fits = |low: i128, high: i128, limits: (i128, i128)| moved(low) >= limits.0 && moved(high) <= limits.1;
            step.whole.0 &= fits(s.0.into(), s.1.into(), (whole.signed.0.into(), whole.signed.1.into()));
            step.whole.1 &= fits(u.0.into(), u.1.into(), (0, whole.unsigned.1.into()));
        }
    }

    /// How often the header of each loop runs, after a walk that saw what its parameters really are.
    fn count_passes(&mut self) {
        for header in self.tree.order.clone() {
            let Some(n) = self.loops.of_header[header] else { continue };
            let params = &self.func.blocks[header].params;
            let mut least: Option<u64> = None;
            for step in &self.loops.list[n].steps {
                let taken = self.taken[params[step.param]];
                let size = step.step.unsigned_abs();
                let by_counter = self.fore[params[step.param]]
                    .filter(|_| step.counts_down)
                    .and_then(|first| passes_back(step, first));
                // Steps that never wrap lie apart between the ends.
                let signed = step.whole.0.then(|| taken.signed.1.wrapping_sub(taken.signed.0) as u64 / size);
                let unsigned = step.whole.1.then(|| (taken.unsigned.1 - taken.unsigned.0) / size);
                least = [least, by_counter, signed, unsigned].into_iter().flatten().min();
            }
            let reached = self.reached[header];
            self.loops.list[n].passes = least.filter(|_| reached).map(|back| back.saturating_add(1));
        }
    }

    // ---- rewriting ----

    /// A parameter with one value is a constant.
    fn constant_parameters(&mut self, block: BlockId, out: &mut Vec<Inst>) {
        if block.index() == 0 {
            return;
        }
        for param in self.func.blocks[block].params.clone() {
            let repr = self.func.values[param];
            if repr.is_int()
                && let Some(raw) = self.taken[param].single()
            {
                let dst = self.func.values.push(repr);
                out.push(Inst::Const { dst, raw });
                self.replace.set(param, dst);
            }
        }
    }

    fn rewrite(&mut self, block: BlockId, inst: &Inst, result: Option<(ValueId, Interval)>, out: &mut Vec<Inst>) {
        if let Inst::Poll { .. } = inst {
            let unpolled = match self.loops.of_block[block] {
                Some(n) => self.unpolled[n],
                // Not in a circle at all.
                None => !self.loops.tangled,
            };
            if unpolled {
                return;
            }
        }
        // What moves a parameter on stays: later walks know loops by it.
        let moves = |dst: ValueId| self.loops.moves.contains(&dst);
        if matches!(inst, Inst::Prim { dst, .. } if moves(*dst)) {
            out.push(inst.clone());
            return;
        }
        match improve::improve(&mut self.facts, inst, result) {
            Improved::Same => out.push(inst.clone()),
            Improved::By(inst) => out.push(inst),
            Improved::Nothing => {}
            Improved::Value(old, new) => self.replace.set(old, new),
        }
    }
}

/// Constants that something is compared with, and their neighbours.
fn stops(func: &Func, facts: &Facts) -> Vec<i64> {
    let mut stops = vec![0];
    for inst in func.blocks.iter().flat_map(|b| &b.insts) {
        if let Inst::Prim { op: LeS | LeU | LtS | LtU | PrimOp::Eq | PrimOp::Ne, repr, args, .. } = inst {
            for arg in args.iter() {
                if let Def::Const(raw) = facts.def(*arg) {
                    let number = repr.sign_extend(raw);
                    stops.extend([number.saturating_sub(1), number, number.saturating_add(1)]);
                }
            }
        }
    }
    stops.sort_unstable();
    stops.dedup();
    stops
}

/// How often a counter lets its loop go back.
fn passes_back(step: &Step, first: Interval) -> Option<u64> {
    first.unsigned.1.checked_div(step.step.unsigned_abs())
}

/// What is left of a choice when no label fits; only labels at the ends count.
fn rest(range: Interval, repr: Repr, cases: &[(u64, Target)]) -> Option<Interval> {
    let mut labels: Vec<u64> = cases.iter().map(|(label, _)| *label).collect();
    let mut left = range;
    for signed in [false, true] {
        labels.sort_unstable_by_key(|label| if signed { repr.sign_extend(*label) as u64 ^ 1 << 63 } else { *label });
        for label in labels.iter().chain(labels.iter().rev()) {
            left = left.without(Interval::one(repr, *label), repr)?;
        }
    }
    Some(left)
}
