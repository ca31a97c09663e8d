//! Constants, algebra and value numbering, over the dominator tree.
//!
//! - An operation on constants is its result ([`eval`] says which); `x + 0` is `x`, `NOT (a < b)` is `b <= a`.
//! - An operation that was done before on every way is not done again, if that was not long ago: a value that is kept long
//!   costs more than its recalculation.
//! - In the part that a branch leads to, its condition is known; a check that passed need not be repeated.
//! - A place at the address of another is that other; constant parts of an index move into the offset.
//!
//! ```text
//! v2 = add i16 v0, v1          v2 = add i16 v0, v1
//! v3 = add i16 v1, v0     =>   if v4 then b1 else b2
//! v5 = xor i8 v4, 1
//! if v5 then b2 else b1
//! ```

use super::algebra::{Simpler, simplify};
use super::rewrite::Replace;
use crate::dominators::Dominators;
use crate::ir::{Args, Base, BlockId, Cond, Func, Inst, Place, Target, Term, ValueId};
use crate::visit;
use index_vec::IndexVec;
use plcc_stdlib::prim::{PrimOp, Repr};
use rustc_hash::FxHashMap;

/// So many instructions after its last use a value is not worth a register any more.
const LIFETIME: u32 = 200;

/// What is known of a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Def {
    /// A parameter, or made by an instruction that says nothing of it.
    Other,
    /// Its register value.
    Const(u64),
    /// An operation.
    Prim(PrimOp, Repr, Args),
    /// A truth value that was read from memory or stands for one.
    Truth,
}

/// The table of what is known of values.
pub type Defs = IndexVec<ValueId, Def>;

/// What makes two instructions the same.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Key {
    Const(Repr, u64),
    Prim(PrimOp, Repr, Args),
    Address(Place),
    Rt(&'static str, Vec<ValueId>),
    Within(ValueId, i64, i64),
}

/// The pass.
pub fn run(func: &mut Func) {
    let tree = Dominators::new(func);
    let mut folder = Folder {
        replace: Replace::new(func),
        defs: IndexVec::from_vec(vec![Def::Other; func.values.len()]),
        addresses: FxHashMap::default(),
        seen: FxHashMap::default(),
        known: FxHashMap::default(),
        tree,
        func,
        block: BlockId::from_raw(0),
        clock: 0,
        out: Vec::new(),
    };
    folder.run();
}

struct Folder<'a> {
    func: &'a mut Func,
    tree: Dominators,
    replace: Replace,
    defs: Defs,
    /// The places whose addresses values are, and how many bytes a reference to them reaches.
    addresses: FxHashMap<ValueId, (Place, u32)>,
    /// Where an instruction was done, which value it gave, and when that was last used.
    seen: FxHashMap<Key, (BlockId, ValueId, u32)>,
    /// From which blocks on a truth value is known.
    known: FxHashMap<ValueId, Vec<(BlockId, bool)>>,
    block: BlockId,
    clock: u32,
    /// The instructions of the block so far.
    out: Vec<Inst>,
}

impl Folder<'_> {
    fn run(&mut self) {
        for block in self.tree.order.clone() {
            self.block = block;
            self.enter(block);
            for inst in std::mem::take(&mut self.func.blocks[block].insts) {
                self.clock += 1;
                self.inst(inst);
            }
            let mut term = std::mem::replace(&mut self.func.blocks[block].term, Term::Return(None));
            visit::term_uses(&mut term, &mut |v| *v = self.replace.get(*v));
            let term = self.term(term);
            self.func.blocks[block].insts = std::mem::take(&mut self.out);
            self.func.blocks[block].term = term;
        }
        // Arguments of jumps backwards were met before what they became.
        self.replace.apply(self.func);
    }

    /// What the only way into a block says of its condition.
    fn enter(&mut self, block: BlockId) {
        let [pred] = self.tree.preds[block][..] else { return };
        if let Term::Branch { cond, then, otherwise } = &self.func.blocks[pred].term
            && then.block != otherwise.block
        {
            self.learn(*cond, then.block == block);
        }
    }

    /// A truth value is known from this block on.
    fn learn(&mut self, cond: ValueId, truth: bool) {
        let cond = self.replace.get(cond);
        self.known.entry(cond).or_default().push((self.block, truth));
        // What follows from a conjunction that holds, or a disjunction that does not.
        if let Def::Prim(op, Repr::I8, Args::Two([a, b])) = self.defs[cond] {
            match (op, truth) {
                (PrimOp::And, true) | (PrimOp::Or, false) if self.is_truth(a) && self.is_truth(b) => {
                    self.learn(a, truth);
                    self.learn(b, truth);
                }
                (PrimOp::Xor, _) if self.defs[b] == Def::Const(1) && self.is_truth(a) => self.learn(a, !truth),
                _ => {}
            }
        }
    }

    fn truth_of(&self, value: ValueId) -> Option<bool> {
        if let Def::Const(raw) = self.defs[value] {
            return Some(raw != 0);
        }
        let facts = self.known.get(&value)?;
        facts.iter().rev().find(|(block, _)| self.tree.dominates(*block, self.block)).map(|(_, truth)| *truth)
    }

    fn is_truth(&self, value: ValueId) -> bool {
        super::algebra::is_truth(&self.defs, value)
    }

    fn inst(&mut self, mut inst: Inst) {
        self.replace.inst(&mut inst);
        visit::places(&mut inst, &mut |place| self.place(place));
        match &mut inst {
            Inst::Const { dst, raw } => {
                let (dst, raw) = (*dst, *raw);
                self.defs[dst] = Def::Const(raw);
                self.once(dst, Key::Const(self.func.values[dst], raw), inst);
            }
            Inst::Prim { dst, op, repr, args } => {
                let (dst, op, repr, args) = (*dst, *op, *repr, *args);
                self.prim(dst, op, repr, args);
            }
            Inst::AddressOf { dst, place, bytes } => {
                let (dst, key) = (*dst, Key::Address(place.clone()));
                self.addresses.insert(dst, (place.clone(), *bytes));
                self.once(dst, key, inst);
            }
            Inst::CallRt { dst, func, args } => {
                let constants: Option<Vec<u64>> = args.iter().map(|v| self.constant(*v)).collect();
                if let Some(constants) = constants {
                    let (dst, raw) = (*dst, (func.eval)(&constants));
                    return self.constant_at(dst, raw);
                }
                let (dst, key) = (*dst, Key::Rt(func.symbol, args.clone()));
                self.once(dst, key, inst);
            }
            Inst::Load { dst, normalise, place } => {
                if *normalise || place.bit.is_some() {
                    self.defs[*dst] = Def::Truth;
                }
                self.out.push(inst);
            }
            Inst::Check { cond, .. } => {
                let cond = *cond;
                if !self.holds(cond) {
                    self.out.push(inst);
                    match cond {
                        Cond::True(value) => self.learn(value, true),
                        Cond::Within { value, low, high } => {
                            self.seen.insert(Key::Within(value, low, high), (self.block, value, self.clock));
                        }
                    }
                }
            }
            _ => self.out.push(inst),
        }
    }

    fn constant(&self, value: ValueId) -> Option<u64> {
        match self.defs[value] {
            Def::Const(raw) => Some(raw),
            _ => None,
        }
    }

    /// Whether what a check demands is known to hold.
    fn holds(&self, cond: Cond) -> bool {
        match cond {
            Cond::True(value) => self.truth_of(value) == Some(true),
            Cond::Within { value, low, high } => {
                if let Def::Const(raw) = self.defs[value] {
                    return (low..=high).contains(&(raw as i64));
                }
                let passed = self.seen.get(&Key::Within(value, low, high));
                passed.is_some_and(|(block, ..)| self.tree.dominates(*block, self.block))
            }
        }
    }

    /// Adds an instruction unless it was done before on every way here.
    fn once(&mut self, dst: ValueId, key: Key, inst: Inst) {
        let cheap = matches!(key, Key::Const(..));
        if let Some((block, value, used)) = self.seen.get_mut(&key) {
            let recent = *block == self.block || cheap || self.clock - *used < LIFETIME;
            if recent && self.tree.dominates(*block, self.block) {
                *used = self.clock;
                let value = *value;
                return self.replace.set(dst, value);
            }
        }
        self.seen.insert(key, (self.block, dst, self.clock));
        self.out.push(inst);
    }

    fn constant_at(&mut self, dst: ValueId, raw: u64) {
        self.defs[dst] = Def::Const(raw);
        let key = Key::Const(self.func.values[dst], raw);
        self.once(dst, key, Inst::Const { dst, raw });
    }

    /// A constant, for what an operation becomes.
    fn number(&mut self, repr: Repr, raw: u64) -> ValueId {
        let dst = self.func.values.push(repr);
        self.defs.push(Def::Other);
        self.constant_at(dst, raw);
        self.replace.get(dst)
    }

    /// A truth value as a number.
    fn widened(&mut self, repr: Repr, truth: ValueId) -> ValueId {
        if repr == Repr::I8 {
            return truth;
        }
        self.part(PrimOp::Zext(repr), Repr::I8, repr, Args::One([truth]))
    }

    /// An operation on values of `repr`, for what another one becomes.
    fn part(&mut self, op: PrimOp, repr: Repr, result: Repr, args: Args) -> ValueId {
        let dst = self.func.values.push(result);
        self.defs.push(Def::Other);
        self.prim(dst, op, repr, args);
        self.replace.get(dst)
    }

    fn prim(&mut self, dst: ValueId, op: PrimOp, repr: Repr, args: Args) {
        let mut now = (op, repr, args);
        // Each step is simpler than the one before; the bound is for a mistake in a rule.
        for _ in 0..8 {
            if let (PrimOp::Select, Args::Three([c, a, b])) = (now.0, now.2)
                && let Some(truth) = self.truth_of(c)
            {
                return self.replace.set(dst, if truth { a } else { b });
            }
            match simplify(now.0, now.1, now.2, &self.defs) {
                None => break,
                Some(Simpler::Const(raw)) => return self.constant_at(dst, raw),
                Some(Simpler::Value(value)) => return self.replace.set(dst, value),
                Some(Simpler::Prim(op, repr, args)) => now = (op, repr, args),
                Some(Simpler::WithConst(op, repr, a, (c_repr, raw))) => {
                    let c = self.number(c_repr, raw);
                    now = (op, repr, Args::Two([a, c]));
                }
                Some(Simpler::Masked(op, repr, x, mask)) => {
                    let (mask, zero) = (self.number(repr, mask), self.number(repr, 0));
                    let bits = self.part(PrimOp::And, repr, repr, Args::Two([x, mask]));
                    now = (op, repr, Args::Two([bits, zero]));
                }
                Some(Simpler::WithTruth(op, repr, a, truth)) => {
                    let c = self.widened(repr, truth);
                    now = (op, repr, Args::Two([a, c]));
                }
            }
        }
        let (op, repr, args) = now;
        self.defs[dst] = Def::Prim(op, repr, args);
        self.once(dst, Key::Prim(op, repr, args), Inst::Prim { dst, op, repr, args });
    }

    /// Constant parts of a place move into its offset; the place at an address is the place itself.
    fn place(&self, place: &mut Place) {
        while let Base::Reference(value) = place.base {
            let Some((target, bytes)) = self.addresses.get(&value) else { break };
            if !within(place, i64::from(*bytes)) {
                break;
            }
            place.base = target.base;
            place.offset += target.offset;
            let inner = std::mem::replace(&mut place.index, target.index.clone());
            place.index.extend(inner);
        }
        if let Base::Reference(value) = place.base
            && let Def::Const(raw) = self.defs[value]
        {
            place.base = Base::Region;
            place.offset += raw as i64;
        }
        let offset = &mut place.offset;
        place.index.retain_mut(|term| {
            for _ in 0..4 {
                match self.defs[term.value] {
                    // Outside of its bounds only behind a check that fails.
                    Def::Const(raw) if !(term.low..=term.high).contains(&(raw as i64)) => return true,
                    Def::Const(raw) => {
                        *offset = offset.wrapping_add((raw as i64).wrapping_mul(i64::from(term.stride)));
                        return false;
                    }
                    Def::Prim(PrimOp::Add, Repr::I64, Args::Two([x, c])) => {
                        let Def::Const(c) = self.defs[c] else { return true };
                        let c = c as i64;
                        let (Some(low), Some(high)) = (term.low.checked_sub(c), term.high.checked_sub(c)) else {
                            return true;
                        };
                        let Some(moved) = c.checked_mul(i64::from(term.stride)).filter(|m| m.abs() < 1 << 40) else {
                            return true;
                        };
                        *offset += moved;
                        (term.value, term.low, term.high) = (x, low, high);
                    }
                    _ => return true,
                }
            }
            true
        });
    }

    fn term(&mut self, term: Term) -> Term {
        match term {
            Term::Branch { mut cond, mut then, mut otherwise } => {
                if let Some(truth) = self.truth_of(cond) {
                    return Term::Jump(if truth { then } else { otherwise });
                }
                while let Def::Prim(PrimOp::Xor, Repr::I8, Args::Two([x, one])) = self.defs[cond]
                    && self.defs[one] == Def::Const(1)
                {
                    cond = x;
                    std::mem::swap(&mut then, &mut otherwise);
                }
                Term::Branch { cond, then, otherwise }
            }
            Term::Switch { value, cases, default } => {
                let Def::Const(raw) = self.defs[value] else { return Term::Switch { value, cases, default } };
                let found: Option<Target> = cases.into_iter().find(|(label, _)| *label == raw).map(|(_, to)| to);
                Term::Jump(found.unwrap_or(default))
            }
            other => other,
        }
    }
}

/// Whether a place behind a reference begins in the bytes that the reference reaches. The bounds of an array that is open
/// become those: its index was checked against the actual ones.
fn within(place: &mut Place, bytes: i64) -> bool {
    if let [term] = &mut place.index[..]
        && term.low == 0
        && term.stride > 0
        && place.offset >= 0
        && place.offset < bytes
    {
        term.high = term.high.min((bytes - 1 - place.offset) / i64::from(term.stride));
    }
    let (start, end) = super::alias::span(place, 0);
    start >= 0 && end <= bytes
}
