//! What an instruction becomes when the intervals of its operands are known.

use super::super::fold::Def;
use super::facts::Facts;
use super::interval::{Interval, compare};
use crate::ir::{Args, Cond, Inst, Place, ValueId};
use crate::visit;
use plcc_stdlib::prim::{PrimOp, Repr};

/// What takes the place of an instruction.
pub enum Improved {
    /// It stays.
    Same,
    /// Another one.
    By(Inst),
    /// Nothing: a check that cannot fail.
    Nothing,
    /// Its result is a value that was there before.
    Value(ValueId, ValueId),
}

/// Makes an instruction simpler where its operands allow it; `result` is what is known of what it defines.
pub fn improve(facts: &mut Facts, inst: &Inst, result: Option<(ValueId, Interval)>) -> Improved {
    if let Inst::Prim { dst, op, repr, args } = inst {
        let single = result.filter(|_| op.result(*repr).is_int()).and_then(|(_, interval)| interval.single());
        return match single {
            Some(raw) => Improved::By(Inst::Const { dst: *dst, raw }),
            None => prim(facts, *dst, *op, *repr, *args),
        };
    }
    if let Inst::Check { cond, .. } = inst
        && holds(facts, *cond)
    {
        return Improved::Nothing;
    }
    let mut inst = inst.clone();
    let mut changed = false;
    visit::places(&mut inst, &mut |place| changed |= constant_indices(facts, place));
    if changed { Improved::By(inst) } else { Improved::Same }
}

fn holds(facts: &mut Facts, cond: Cond) -> bool {
    match cond {
        Cond::True(value) => facts.range(value).unsigned.0 > 0,
        Cond::Within { value, low, high } => {
            let range = facts.range(value);
            low <= range.signed.0 && range.signed.1 <= high
        }
    }
}

/// An index with one value moves into the offset.
fn constant_indices(facts: &mut Facts, place: &mut Place) -> bool {
    let before = place.index.len();
    let offset = &mut place.offset;
    place.index.retain(|term| {
        let Some(raw) = facts.range(term.value).single() else { return true };
        let value = raw as i64;
        if !(term.low..=term.high).contains(&value) {
            return true;
        }
        *offset += value * i64::from(term.stride);
        false
    });
    place.index.len() != before
}

fn constant(dst: ValueId, truth: bool) -> Improved {
    Improved::By(Inst::Const { dst, raw: truth.into() })
}

/// What a constant (not 0) was added to, the constant, and whether the sum did not wrap as signed and as unsigned.
fn sum_of(facts: &mut Facts, value: ValueId) -> Option<(ValueId, i64, (bool, bool))> {
    let Def::Prim(PrimOp::Add, repr, Args::Two([x, c])) = facts.def(value) else { return None };
    let Def::Const(raw) = facts.def(c) else { return None };
    let (base, full) = (facts.near(x), Interval::full(repr));
    let step = repr.sign_extend(raw);
    let inside = |end: i64| (full.signed.0..=full.signed.1).contains(&end);
    let ends = (base.signed.0.checked_add(step), base.signed.1.checked_add(step));
    let signed = matches!(ends, (Some(low), Some(high)) if inside(low) && inside(high));
    let unsigned = base.unsigned.1.checked_add(raw).is_some_and(|high| high <= full.unsigned.1);
    (step != 0).then_some((x, step, (signed, unsigned)))
}

fn prim(facts: &mut Facts, dst: ValueId, op: PrimOp, repr: Repr, args: Args) -> Improved {
    use PrimOp::*;
    if !repr.is_int() && op != Select {
        return Improved::Same;
    }
    let by = |op: PrimOp| Improved::By(Inst::Prim { dst, op, repr, args });
    match args {
        Args::One([x]) => match op {
            Sext(to) | Zext(to) => {
                let range = facts.near(x);
                // What was cut off was only a copy of the sign, or nothing.
                if let Def::Prim(Wrap(_), from, Args::One([whole])) = facts.def(x)
                    && from == to
                {
                    let (limits, before) = (Interval::full(repr), facts.near(whole));
                    let fits = match op {
                        Sext(_) => limits.signed.0 <= before.signed.0 && before.signed.1 <= limits.signed.1,
                        _ => before.unsigned.1 <= limits.unsigned.1,
                    };
                    if fits {
                        return Improved::Value(dst, whole);
                    }
                }
                if matches!(op, Sext(_)) && range.not_negative() { by(Zext(to)) } else { Improved::Same }
            }
            _ => Improved::Same,
        },
        Args::Two([x, y]) => {
            let (a, b) = (facts.near(x), facts.near(y));
            let both = a.not_negative() && b.not_negative();
            let decided = |op: PrimOp| compare(op, a, b);
            let one_of = |first: Option<bool>, if_true: ValueId, if_false: ValueId| match first {
                Some(true) => Improved::Value(dst, if_true),
                Some(false) => Improved::Value(dst, if_false),
                None => Improved::Same,
            };
            match op {
                DivS if both => by(DivU),
                RemS | RemU if both || op == RemU => {
                    if a.unsigned.1 < b.unsigned.0 {
                        Improved::Value(dst, x)
                    } else if op == RemS {
                        by(RemU)
                    } else {
                        Improved::Same
                    }
                }
                ShrS if a.not_negative() => by(ShrU),
                MinS => one_of(decided(LeS), x, y),
                MaxS => one_of(decided(LeS), y, x),
                MinU => one_of(decided(LeU), x, y),
                MaxU => one_of(decided(LeU), y, x),
                And => match b.single() {
                    Some(mask) if mask.wrapping_add(1) & mask == 0 && a.unsigned.1 <= mask => Improved::Value(dst, x),
                    _ => Improved::Same,
                },
                // A sum that did not wrap, with what was added to.
                LtS | LeS | LtU | LeU => {
                    let (sum, part) = (sum_of(facts, x), sum_of(facts, y));
                    let signed = matches!(op, LtS | LeS);
                    let greater = |step: Option<(ValueId, i64, (bool, bool))>, of: ValueId| {
                        let (_, step, whole) = step.filter(|(base, ..)| *base == of)?;
                        (if signed { whole.0 } else { whole.1 && step > 0 }).then_some(step > 0)
                    };
                    match (greater(sum, y), greater(part, x)) {
                        (Some(greater), _) => constant(dst, !greater),
                        (_, Some(greater)) => constant(dst, greater),
                        _ => Improved::Same,
                    }
                }
                // A truth value compared with one.
                Ne if repr == Repr::I8 && b.single() == Some(0) && a.unsigned.1 <= 1 => Improved::Value(dst, x),
                Eq if repr == Repr::I8 && b.single() == Some(1) && a.unsigned.1 <= 1 => Improved::Value(dst, x),
                _ => Improved::Same,
            }
        }
        Args::Three([c, a, b]) => {
            let cond = facts.near(c);
            match (cond.single(), cond.unsigned.0) {
                (Some(0), _) => Improved::Value(dst, b),
                (_, 1..) => Improved::Value(dst, a),
                _ => Improved::Same,
            }
        }
    }
}
