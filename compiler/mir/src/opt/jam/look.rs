//! What a loop must be like for its passes to be done side by side.
//!
//! Each value of the loop gets a [`Kind`]; what reads it must fit. Then the passes are counted, and accesses to memory
//! compared with each other.

use super::super::alias::Alias;
use super::super::fold::Def;
use super::super::loops::Loop;
use super::super::ranges::facts::Facts;
use super::super::ranges::induction::Loops;
use super::super::unroll;
use super::{Kind, Plan};
use crate::dominators::Dominators;
use crate::ir::{Base, BlockId, Func, IndexTerm, Inst, Place, Term, ValueId};
use crate::lanes::{self, Gives};
use plcc_stdlib::prim::{PrimOp, Repr};
use rustc_hash::{FxHashMap, FxHashSet};

/// So many accesses to memory are compared with each other at most.
const ACCESSES: usize = 48;
/// A straight body from so many instructions on is a chain: two registers are worked on, so that one need not wait.
const CHAIN: usize = 24;
/// Instructions that may stand in front for passes that are left over.
const LEFT_OVER: usize = 64;

/// An access to memory.
struct Access<'a> {
    block: BlockId,
    at: usize,
    place: &'a Place,
    bytes: u32,
    store: bool,
    /// Whether it goes on from pass to pass, by its size.
    moves: bool,
}

/// A look at one loop.
pub struct Look<'a> {
    pub func: &'a Func,
    pub alias: &'a Alias<'a>,
    pub tree: &'a Dominators,
    pub facts: &'a Facts,
    pub counted: &'a Loops,
    pub l: &'a Loop,
    /// Instructions of the loop.
    pub size: usize,
}

impl<'a> Look<'a> {
    /// What is to be done with it, if anything.
    pub fn plan(&self) -> Option<Plan> {
        let number = self.counted.of_header[self.l.header]?;
        let inside = |block: BlockId| self.l.blocks.contains(&block);
        if self.l.header.index() == 0 || self.counted.tangled || !self.insts_fit() {
            return None;
        }
        // One way out and one way back, behind everything else.
        let mut out = Vec::new();
        for block in &self.l.blocks {
            self.func.blocks[*block].term.for_each_target(|target| {
                if !inside(target.block) {
                    out.push(*block);
                }
            });
        }
        let ([test], [latch]) = (&out[..], &self.ends()[..]) else { return None };
        let (test, latch) = (*test, *latch);
        let at_the_end =
            test == latch || (self.tree.preds[latch][..] == [test] && self.func.blocks[latch].params.is_empty());
        let Term::Branch { cond, then, otherwise } = &self.func.blocks[test].term else { return None };
        let onward = if inside(then.block) { then.block } else { otherwise.block };
        let own = [test, latch].iter().all(|block| self.counted.of_block[*block] == Some(number));
        if !at_the_end || !own || self.counted.of_block[onward] != Some(number) {
            return None;
        }
        let mut steps = FxHashMap::default();
        for step in &self.counted.list[number].steps {
            steps.insert(self.func.blocks[self.l.header].params[step.param], step.step);
        }
        let kinds = self.kinds(&steps)?;
        let bytes = self.judge(&kinds, test, *cond)?;
        // Behind the test the next pass begins: only counters may move there.
        if test != latch {
            let moves = |inst: &Inst| match inst {
                Inst::Const { .. } | Inst::Poll { .. } => true,
                Inst::Prim { dst, .. } => !matches!(kinds.get(dst), Some(Kind::Lanes(_) | Kind::Mask(_))),
                _ => false,
            };
            if !self.func.blocks[latch].insts.iter().all(moves) {
                return None;
            }
        }
        let passes = unroll::count(self.func, self.facts, self.counted, number, (self.l.header, test), self.tree)?;
        let width = lanes::WIDTH as u64 / u64::from(bytes);
        let nested = self.l.blocks.iter().any(|block| self.counted.of_block[*block] != Some(number));
        let chain = nested || self.size >= CHAIN;
        let (times, left_over) = match passes {
            _ if chain && passes % (2 * width) == 0 => (2 * width, 0),
            _ if passes < 2 * width && passes != width => return None,
            _ => (width, passes % width),
        };
        let early = self.polls(&kinds)?;
        self.order_is_kept(&kinds, number, times as usize)?;
        let polls = self.insts().any(|(_, _, inst)| matches!(inst, Inst::Poll { .. }));
        if left_over > 0 && (polls || self.size * left_over as usize > LEFT_OVER) {
            return None;
        }
        Some(Plan { times: times as usize, left_over: left_over as usize, test, kinds, steps, early })
    }

    fn insts(&self) -> impl Iterator<Item = (BlockId, usize, &'a Inst)> + '_ {
        let func = self.func;
        self.l
            .blocks
            .iter()
            .flat_map(move |block| func.blocks[*block].insts.iter().enumerate().map(|(at, inst)| (*block, at, inst)))
    }

    /// Whether the loop has no instruction that is done once for each pass whatever it gives, and stores something.
    fn insts_fit(&self) -> bool {
        let mut stores = false;
        for (_, _, inst) in self.insts() {
            match inst {
                Inst::Const { .. } | Inst::Prim { .. } | Inst::Load { .. } | Inst::Poll { .. } => {}
                Inst::Store { .. } => stores = true,
                _ => return false,
            }
        }
        stores
    }

    /// Where passes end.
    fn ends(&self) -> Vec<BlockId> {
        let preds = self.tree.preds[self.l.header].iter().copied();
        preds.filter(|pred| self.l.blocks.contains(pred)).collect()
    }

    /// What each value of the loop is; `None` if one of them does not fit.
    fn kinds(&self, steps: &FxHashMap<ValueId, i64>) -> Option<FxHashMap<ValueId, Kind>> {
        let mut kinds: FxHashMap<ValueId, Kind> = FxHashMap::default();
        for param in &self.func.blocks[self.l.header].params {
            let kind = match steps.get(param) {
                Some(step) if self.func.values[*param] == Repr::I64 => Kind::Step(*step),
                Some(_) => Kind::Aside,
                None => Kind::Before,
            };
            kinds.insert(*param, kind);
        }
        for (_, _, inst) in self.insts() {
            if let (Some(dst), _) = inst.results() {
                kinds.insert(dst, Kind::Same);
            }
        }
        let inner = self.l.blocks.iter().filter(|block| **block != self.l.header);
        for param in inner.flat_map(|block| &self.func.blocks[*block].params) {
            kinds.insert(*param, Kind::Same);
        }
        // What is the same is taken back where it is not, until nothing changes.
        loop {
            let mut changed = false;
            for &block in &self.l.blocks {
                for inst in &self.func.blocks[block].insts {
                    let (Some(dst), _) = inst.results() else { continue };
                    let kind = self.result(inst, &kinds)?;
                    changed |= kinds.insert(dst, kind) != Some(kind);
                }
                let mut fits = true;
                self.func.blocks[block].term.for_each_target(|target| {
                    if target.block == self.l.header || !self.l.blocks.contains(&target.block) {
                        return;
                    }
                    for (arg, param) in target.args.iter().zip(&self.func.blocks[target.block].params) {
                        match kinds.get(arg).copied().unwrap_or(Kind::Same) {
                            Kind::Same => {}
                            kind @ Kind::Lanes(_) => {
                                let old = kinds.insert(*param, kind);
                                changed |= old != Some(kind);
                                fits &= old == Some(Kind::Same) || old == Some(kind);
                            }
                            _ => fits = false,
                        }
                    }
                });
                if !fits {
                    return None;
                }
            }
            if !changed {
                return Some(kinds);
            }
        }
    }

    /// Whether a value comes from outside of the loop, or is a constant.
    fn is_fixed(&self, value: ValueId, kinds: &FxHashMap<ValueId, Kind>) -> bool {
        !kinds.contains_key(&value) || matches!(self.facts.def(value), Def::Const(_))
    }

    fn result(&self, inst: &Inst, kinds: &FxHashMap<ValueId, Kind>) -> Option<Kind> {
        let kind = |value: ValueId| kinds.get(&value).copied().unwrap_or(Kind::Same);
        match inst {
            Inst::Load { dst, place, normalise } => match self.moves(place, kinds)? {
                0 => Some(Kind::Same),
                by => {
                    let repr = self.func.values[*dst];
                    let bytes = repr.bytes();
                    let fits = lanes::count(repr).is_some() && by == i64::from(bytes) && !normalise;
                    (fits && place.bit.is_none()).then_some(Kind::Lanes(bytes))
                }
            },
            Inst::Prim { op, repr, args, .. } => {
                let of: Vec<Kind> = args.iter().map(|v| kind(*v)).collect();
                if of.iter().all(|kind| *kind == Kind::Same) {
                    return Some(Kind::Same);
                }
                if of.contains(&Kind::Before) {
                    return None;
                }
                if !of.iter().any(|kind| matches!(kind, Kind::Lanes(_) | Kind::Mask(_))) {
                    return Some(self.step(*op, *repr, args, &of, kinds).unwrap_or(Kind::Aside));
                }
                let value = |kind: &Kind| matches!(kind, Kind::Same | Kind::Lanes(_));
                match *op {
                    PrimOp::Select => {
                        let Kind::Mask(bytes) = of[0] else { return None };
                        let fits = lanes::operation(*op, *repr).is_some() && repr.bytes() == bytes;
                        (fits && of[1..].iter().all(value)).then_some(Kind::Lanes(bytes))
                    }
                    _ if lanes::joins_masks(*op, *repr) => {
                        (of[0] == of[1] && matches!(of[0], Kind::Mask(_))).then_some(of[0])
                    }
                    _ => match lanes::operation(*op, *repr)? {
                        _ if !of.iter().all(value) => None,
                        Gives::Values => Some(Kind::Lanes(repr.bytes())),
                        Gives::Mask => Some(Kind::Mask(repr.bytes())),
                    },
                }
            }
            _ => Some(Kind::Same),
        }
    }

    /// An operation on what grows in even steps.
    fn step(
        &self,
        op: PrimOp,
        repr: Repr,
        args: &[ValueId],
        of: &[Kind],
        kinds: &FxHashMap<ValueId, Kind>,
    ) -> Option<Kind> {
        if repr != Repr::I64 {
            return None;
        }
        let constant = |value: ValueId| match self.facts.def(value) {
            Def::Const(raw) => Some(raw as i64),
            _ => None,
        };
        let by = match (op, of) {
            (PrimOp::Add, [Kind::Step(a), Kind::Step(b)]) => a.checked_add(*b)?,
            (PrimOp::Add | PrimOp::Sub, [Kind::Step(a), Kind::Same]) if self.is_fixed(args[1], kinds) => *a,
            (PrimOp::Add, [Kind::Same, Kind::Step(b)]) if self.is_fixed(args[0], kinds) => *b,
            (PrimOp::Mul, [Kind::Step(a), Kind::Same]) => a.checked_mul(constant(args[1])?)?,
            (PrimOp::Mul, [Kind::Same, Kind::Step(b)]) => b.checked_mul(constant(args[0])?)?,
            (PrimOp::Shl, [Kind::Step(a), Kind::Same]) => {
                a.checked_mul(1 << constant(args[1]).filter(|bits| (0..32).contains(bits))?)?
            }
            _ => return None,
        };
        Some(Kind::Step(by))
    }

    /// By how many bytes a place goes on from pass to pass; `None` if that is not known.
    fn moves(&self, place: &Place, kinds: &FxHashMap<ValueId, Kind>) -> Option<i64> {
        if let Base::Reference(value) = place.base
            && !self.is_fixed(value, kinds)
        {
            return None;
        }
        place.index.iter().try_fold(0i64, |sum, term| match kinds.get(&term.value) {
            None | Some(Kind::Same) => Some(sum),
            Some(Kind::Step(by)) => sum.checked_add(by.checked_mul(i64::from(term.stride))?),
            Some(_) => None,
        })
    }

    /// Whether all that reads a value may do so; gives the size of the elements.
    fn judge(&self, kinds: &FxHashMap<ValueId, Kind>, test: BlockId, cond: ValueId) -> Option<u32> {
        let kind = |value: ValueId| kinds.get(&value).copied().unwrap_or(Kind::Same);
        let mut size = None;
        let mut works = false;
        let mut same_size = |bytes: u32| *size.get_or_insert(bytes) == bytes;
        for (_, _, inst) in self.insts() {
            match inst {
                Inst::Store { place, value } => {
                    let repr = self.func.values[*value];
                    let fits = lanes::count(repr).is_some() && place.bit.is_none();
                    let value = matches!(kind(*value), Kind::Same | Kind::Lanes(_));
                    let goes_on = self.moves(place, kinds)? == i64::from(repr.bytes());
                    if !fits || !value || !goes_on || !same_size(repr.bytes()) {
                        return None;
                    }
                }
                Inst::Prim { dst, .. } | Inst::Load { dst, .. } => match kind(*dst) {
                    Kind::Lanes(bytes) | Kind::Mask(bytes) => {
                        works |= matches!(inst, Inst::Prim { .. });
                        if !same_size(bytes) {
                            return None;
                        }
                    }
                    _ => {}
                },
                _ => {}
            }
        }
        // Ways inside are the same for all; the way out is the last one's.
        let fits = self.l.blocks.iter().all(|block| match &self.func.blocks[*block].term {
            Term::Branch { .. } if *block == test => !matches!(kind(cond), Kind::Lanes(_) | Kind::Mask(_)),
            Term::Branch { cond: value, .. } | Term::Switch { value, .. } => kind(*value) == Kind::Same,
            Term::Jump(_) => true,
            Term::Return(_) => false,
        });
        (fits && works && !self.read_behind(kinds)).then_some(size?)
    }

    /// Whether a parameter of the header that is not counted is read anywhere but by polls and at the end of the pass.
    fn read_behind(&self, kinds: &FxHashMap<ValueId, Kind>) -> bool {
        let before = |value: ValueId| kinds.get(&value) == Some(&Kind::Before);
        if !kinds.values().any(|kind| *kind == Kind::Before) {
            return false;
        }
        let mut read = false;
        for (id, block) in self.func.blocks.iter_enumerated() {
            let inside = self.l.blocks.contains(&id);
            for inst in block.insts.iter().filter(|inst| !inside || !matches!(inst, Inst::Poll { .. })) {
                inst.for_each_use(|value| read |= before(value));
            }
            block.term.for_each_use(|value| read |= before(value));
        }
        read
    }

    /// The polls that show the first pass; `None` if there is one that stands between stores.
    fn polls(&self, kinds: &FxHashMap<ValueId, Kind>) -> Option<FxHashSet<(BlockId, usize)>> {
        let mut early = FxHashSet::default();
        let stores: Vec<(BlockId, usize)> =
            self.insts().filter(|(_, _, inst)| matches!(inst, Inst::Store { .. })).map(|(b, at, _)| (b, at)).collect();
        for (block, at, inst) in self.insts() {
            if !matches!(inst, Inst::Poll { .. }) {
                continue;
            }
            if !stores.iter().any(|store| self.leads_to(*store, (block, at))) {
                early.insert((block, at));
                continue;
            }
            let mut before = false;
            inst.for_each_use(|value| before |= kinds.get(&value) == Some(&Kind::Before));
            if before || stores.iter().any(|store| self.leads_to((block, at), *store)) {
                return None;
            }
        }
        Some(early)
    }

    /// Whether one instruction can come before another in one pass.
    fn leads_to(&self, from: (BlockId, usize), to: (BlockId, usize)) -> bool {
        if from.0 == to.0 && from.1 < to.1 {
            return true;
        }
        let mut seen: FxHashSet<BlockId> = FxHashSet::default();
        let mut work = vec![from.0];
        while let Some(block) = work.pop() {
            self.func.blocks[block].term.for_each_target(|target| {
                let next = target.block;
                if next != self.l.header && self.l.blocks.contains(&next) && seen.insert(next) {
                    work.push(next);
                }
            });
        }
        seen.contains(&to.0)
    }

    /// Whether no element that one of `times` passes stores is touched by another one of them in the other order.
    fn order_is_kept(&self, kinds: &FxHashMap<ValueId, Kind>, number: usize, times: usize) -> Option<()> {
        let mut list: Vec<Access<'a>> = Vec::new();
        for (block, at, inst) in self.insts() {
            let (place, bytes, store) = match inst {
                Inst::Load { dst, place, .. } => (place, self.func.values[*dst].bytes(), false),
                Inst::Store { place, value } => (place, self.func.values[*value].bytes(), true),
                _ => continue,
            };
            let moves = self.moves(place, kinds)? != 0;
            list.push(Access { block, at, place, bytes, store, moves });
        }
        if list.len() > ACCESSES {
            return None;
        }
        let kept = |(n, store): (usize, &Access)| {
            !store.store
                || list
                    .iter()
                    .enumerate()
                    .all(|(m, other)| (other.store && m < n) || self.pair_is_kept(store, other, kinds, number, times))
        };
        list.iter().enumerate().all(kept).then_some(())
    }

    fn pair_is_kept(
        &self,
        store: &Access,
        other: &Access,
        kinds: &FxHashMap<ValueId, Kind>,
        number: usize,
        times: usize,
    ) -> bool {
        // All that they touch in so many passes.
        let bytes = |access: &Access| i64::from(access.bytes) * if access.moves { times as i64 } else { 1 };
        let (a, b) = (self.window(store, kinds, times, 0), self.window(other, kinds, times, 1));
        if !self.alias.overlap(&a, bytes(store), &b, bytes(other)) {
            return true;
        }
        let terms =
            |place: &Place| -> Vec<(ValueId, u32)> { place.index.iter().map(|t| (t.value, t.stride)).collect() };
        let (a, b) = (store.place, other.place);
        let fixed = |term: &IndexTerm| {
            matches!(kinds.get(&term.value), Some(Kind::Step(_))) || self.is_fixed(term.value, kinds)
        };
        if a.base != b.base || terms(a) != terms(b) || !a.index.iter().all(fixed) || store.bytes != other.bytes {
            return false;
        }
        let size = i64::from(store.bytes);
        let Some(distance) = b.offset.checked_sub(a.offset) else { return false };
        if distance == 0 {
            // Each pass its own element.
            return other.moves;
        }
        if !other.moves || distance % size != 0 {
            return false;
        }
        // Which of the two belongs to the earlier pass must stand first.
        let straight = store.block == other.block && self.counted.of_block[store.block] == Some(number);
        straight && if distance > 0 { other.at < store.at } else { store.at < other.at }
    }

    /// The place of an access in the first of the passes. Indices that change inside get a name that no other place has.
    fn window(&self, access: &Access, kinds: &FxHashMap<ValueId, Kind>, times: usize, side: usize) -> Place {
        let mut place = access.place.clone();
        for term in &mut place.index {
            match kinds.get(&term.value) {
                Some(Kind::Step(by)) => {
                    // The last of the passes is still within the bounds.
                    let far = by.saturating_mul(times as i64 - 1);
                    if far > 0 {
                        term.high = term.high.saturating_sub(far).max(term.low);
                    } else {
                        term.low = term.low.saturating_sub(far).min(term.high);
                    }
                }
                _ if self.is_fixed(term.value, kinds) => {}
                _ => term.value = ValueId::from_usize(self.func.values.len() + side),
            }
        }
        place
    }
}
