//! What is known of each value at one point of a function: where it was defined, and which conditions hold here.
//!
//! Conditions are assumed and taken back in the order of a stack, as a walk over the dominator tree needs it. A condition
//! also says something of what its operands were made of: `x + 1 <= 9` of `x`.

use super::super::fold::{Def, Defs};
use super::interval::{Interval, apply, assume};
use crate::ir::{Args, Base, Func, Inst, Place, ValueId};
use index_vec::IndexVec;
use plcc_stdlib::prim::{PrimOp, Repr};
use plcc_stdlib::region::HEADER_BYTES;

/// So many operations are looked back through for one condition.
const BACK: usize = 48;
/// So deep is the tree of operations that one question looks through.
const DEEP: u32 = 4;
/// And so deep where the question is asked of every instruction.
const NEAR: u32 = 1;

/// The knowledge at the current point.
pub struct Facts {
    defs: Defs,
    reprs: IndexVec<ValueId, Repr>,
    now: IndexVec<ValueId, Interval>,
    log: Vec<(ValueId, Interval)>,
}

impl Facts {
    /// Nothing is known but what instructions are.
    pub fn new(func: &Func) -> Self {
        let mut defs = IndexVec::from_vec(vec![Def::Other; func.values.len()]);
        for inst in func.blocks.iter().flat_map(|b| &b.insts) {
            match inst {
                Inst::Const { dst, raw } => defs[*dst] = Def::Const(*raw),
                Inst::Prim { dst, op, repr, args } => defs[*dst] = Def::Prim(*op, *repr, *args),
                _ => {}
            }
        }
        let now = func.values.iter().map(|repr| Interval::full(*repr)).collect();
        Self { defs, reprs: func.values.clone(), now, log: Vec::new() }
    }

    /// The instruction of a value.
    pub fn def(&self, value: ValueId) -> Def {
        self.defs[value]
    }

    /// The representation of a value.
    pub fn repr(&self, value: ValueId) -> Repr {
        self.reprs[value]
    }

    /// A value comes into being: what it is, whatever was known of it in an earlier walk.
    pub fn define(&mut self, value: ValueId, interval: Interval) {
        self.now[value] = interval;
    }

    /// What an instruction gives.
    pub fn result(&mut self, inst: &Inst) -> Option<(ValueId, Interval)> {
        Some(match inst {
            Inst::Const { dst, raw } => {
                let repr = self.reprs[*dst];
                (*dst, if repr.is_int() { Interval::one(repr, *raw) } else { Interval::full(repr) })
            }
            Inst::Prim { dst, op, repr, args } => (*dst, self.prim(*op, *repr, *args, 1)),
            Inst::Load { dst, place, normalise } if *normalise || place.bit.is_some() => (*dst, Interval::truth()),
            Inst::AddressOf { dst, place, .. } => (*dst, self.address(place)),
            _ => return None,
        })
    }

    /// The region offset of a place: known within the region itself, else behind the header at least.
    fn address(&self, place: &Place) -> Interval {
        let full = Interval::full(Repr::I32);
        let least = i128::from(HEADER_BYTES);
        let (mut low, mut high) = (least, i128::from(u32::MAX));
        if place.base == Base::Region {
            (low, high) = (place.offset.into(), place.offset.into());
            for term in &place.index {
                low += i128::from(term.low) * i128::from(term.stride);
                high += i128::from(term.high) * i128::from(term.stride);
            }
            // Never one value: as a constant it would hide that the address is taken, and later passes (`alias::Facts`) would
            // not know that references reach this place.
            high = high.max(low + 1);
        }
        match (u64::try_from(low), u64::try_from(high)) {
            (Ok(low), Ok(high)) => Interval::between_unsigned(Repr::I32, low, high).unwrap_or(full),
            _ => full,
        }
    }

    // ---- questions ----

    /// What a value can be here.
    pub fn range(&mut self, value: ValueId) -> Interval {
        self.look(value, DEEP)
    }

    /// The same, with less effort.
    pub fn near(&mut self, value: ValueId) -> Interval {
        self.look(value, NEAR)
    }

    /// Whether a condition can be TRUE (or FALSE) here.
    pub fn can_be(&mut self, cond: ValueId, truth: bool) -> bool {
        let range = self.range(cond);
        if truth { range.unsigned.1 > 0 } else { range.unsigned.0 == 0 }
    }

    /// What was noted of a value, without a look at what it was made of.
    pub fn noted(&self, value: ValueId) -> Interval {
        self.now[value]
    }

    fn look(&mut self, value: ValueId, depth: u32) -> Interval {
        let noted = self.now[value];
        if depth == 0 || noted.single().is_some() || !self.reprs[value].is_int() {
            return noted;
        }
        let Def::Prim(op, repr, args) = self.defs[value] else { return noted };
        let again = self.prim(op, repr, args, depth - 1);
        noted.and(again, self.reprs[value]).unwrap_or(noted)
    }

    /// What an operation gives on operands as they are known here.
    fn prim(&mut self, op: PrimOp, repr: Repr, args: Args, depth: u32) -> Interval {
        match args {
            Args::One([a]) => {
                let a = self.look(a, depth);
                apply(op, repr, &[a])
            }
            Args::Two([a, b]) => {
                let operands = [self.look(a, depth), self.look(b, depth)];
                apply(op, repr, &operands)
            }
            Args::Three([c, a, b]) => {
                let cond = self.look(c, depth);
                // Each choice under its condition: `SEL(x < 9, 0, x + 1)`.
                let mut choice = |value: ValueId, truth: bool| {
                    if depth == 0 || !repr.is_int() {
                        return Some(self.now[value]);
                    }
                    let mark = self.mark();
                    let possible = self.assume(c, truth);
                    let range = self.look(value, depth);
                    self.back_to(mark);
                    possible.then_some(range)
                };
                match (choice(a, true), choice(b, false)) {
                    (Some(a), Some(b)) => apply(op, repr, &[cond, a, b]),
                    (Some(one), None) | (None, Some(one)) => one,
                    (None, None) => Interval::full(repr),
                }
            }
        }
    }

    // ---- assumptions ----

    /// Where the stack of assumptions stands.
    pub fn mark(&self) -> usize {
        self.log.len()
    }

    /// Takes back what was assumed since.
    pub fn back_to(&mut self, mark: usize) {
        while self.log.len() > mark {
            if let Some((value, before)) = self.log.pop() {
                self.now[value] = before;
            }
        }
    }

    /// From here on a condition is TRUE (not 0) or FALSE (0). Gives FALSE if that cannot be.
    pub fn assume(&mut self, cond: ValueId, truth: bool) -> bool {
        let repr = self.reprs[cond];
        let noted = self.now[cond];
        let wanted =
            if truth { noted.without(Interval::one(repr, 0), repr) } else { noted.and(Interval::one(repr, 0), repr) };
        wanted.is_some_and(|wanted| self.narrow(cond, wanted))
    }

    /// From here on a value lies in an interval. Gives FALSE if that cannot be.
    pub fn narrow(&mut self, value: ValueId, to: Interval) -> bool {
        let mut work = vec![(value, to)];
        let mut steps = 0;
        while let Some((value, to)) = work.pop() {
            let repr = self.reprs[value];
            steps += 1;
            if steps > BACK || !repr.is_int() {
                continue;
            }
            let noted = self.now[value];
            let Some(left) = noted.and(to, repr) else { return false };
            if left == noted && steps > 1 {
                continue;
            }
            if left != noted {
                self.log.push((value, noted));
                self.now[value] = left;
            }
            if let Def::Prim(op, repr, args) = self.defs[value]
                && !self.operands(op, repr, args, left, &mut work)
            {
                return false;
            }
        }
        true
    }

    /// What a result says of its operands. FALSE if it cannot be.
    fn operands(
        &mut self,
        op: PrimOp,
        repr: Repr,
        args: Args,
        result: Interval,
        work: &mut Vec<(ValueId, Interval)>,
    ) -> bool {
        use PrimOp::*;
        if !repr.is_int() {
            return true;
        }
        match args {
            Args::One([x]) => {
                let from = self.reprs[x];
                let noted = self.now[x];
                let operand = match op {
                    Sext(_) => Interval::between_signed(from, result.signed.0, result.signed.1),
                    Zext(_) => Interval::between_unsigned(from, result.unsigned.0, result.unsigned.1),
                    // Only where nothing is cut off.
                    Wrap(to) => {
                        let whole = Interval::full(to);
                        let (s, u) = (noted.signed, noted.unsigned);
                        if whole.signed.0 <= s.0 && s.1 <= whole.signed.1 {
                            Interval::between_signed(from, result.signed.0, result.signed.1)
                        } else if u.1 <= whole.unsigned.1 {
                            Interval::between_unsigned(from, result.unsigned.0, result.unsigned.1)
                        } else {
                            return true;
                        }
                    }
                    Neg | Not => Some(apply(op, repr, &[result])),
                    _ => return true,
                };
                let Some(operand) = operand else { return false };
                work.push((x, operand));
            }
            Args::Two([x, y]) => {
                let (a, b) = (self.now[x], self.now[y]);
                match op {
                    Add => {
                        work.push((x, apply(Sub, repr, &[result, b])));
                        work.push((y, apply(Sub, repr, &[result, a])));
                    }
                    Sub => {
                        work.push((x, apply(Add, repr, &[result, b])));
                        work.push((y, apply(Sub, repr, &[a, result])));
                    }
                    Eq | Ne | LtS | LeS | LtU | LeU => {
                        let Some(raw) = result.single() else { return true };
                        let Some((a, b)) = assume(op, raw != 0, repr, a, b) else { return false };
                        work.push((x, a));
                        work.push((y, b));
                    }
                    And | Or | Xor if repr == Repr::I8 && Interval::truth().contains(a.or(b)) => {
                        let one = |truth: bool| Interval::one(Repr::I8, truth.into());
                        match (op, result.single(), a.single(), b.single()) {
                            (And, Some(1), ..) | (Or, Some(0), ..) => {
                                let truth = op == And;
                                work.push((x, one(truth)));
                                work.push((y, one(truth)));
                            }
                            // One operand is known and does not decide: the other does.
                            (And, Some(0), Some(1), _) | (Or, Some(1), Some(0), _) => work.push((y, result)),
                            (And, Some(0), _, Some(1)) | (Or, Some(1), _, Some(0)) => work.push((x, result)),
                            (Xor, Some(raw), Some(known), _) => work.push((y, one(raw != known))),
                            (Xor, Some(raw), _, Some(known)) => work.push((x, one(raw != known))),
                            _ => {}
                        }
                    }
                    _ => {}
                }
            }
            Args::Three([c, a, b]) => {
                let (x, y) = (self.now[a], self.now[b]);
                // A result that one choice cannot give is the other.
                if y.and(result, repr).is_none() {
                    work.push((a, result));
                    let Some(set) = self.now[c].without(Interval::one(Repr::I8, 0), Repr::I8) else { return false };
                    work.push((c, set));
                } else if x.and(result, repr).is_none() {
                    work.push((b, result));
                    work.push((c, Interval::one(Repr::I8, 0)));
                }
            }
        }
        true
    }
}
