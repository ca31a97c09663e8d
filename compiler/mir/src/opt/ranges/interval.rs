//! What is known of an integer: the interval of its signed reading and that of its unsigned one.
//!
//! In: intervals of operands. Out: an interval that holds every result of the operation ([`eval`] says which they are).
//! Where a value was defined and which branches lead to it is not the business of this file.

use plcc_stdlib::prim::{PrimOp, Repr, eval};

/// An integer of some width lies in both intervals. They are not empty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Interval {
    /// Read as signed, both ends included.
    pub signed: (i64, i64),
    /// Read as unsigned, both ends included.
    pub unsigned: (u64, u64),
}

type Wide = (i128, i128);

fn signed_limits(repr: Repr) -> Wide {
    let half = 1i128 << (repr.bits() - 1);
    (-half, half - 1)
}

fn unsigned_limits(repr: Repr) -> Wide {
    (0, i128::from(repr.mask()))
}

fn meet(a: Wide, b: Wide) -> Wide {
    (a.0.max(b.0), a.1.min(b.1))
}

/// An interval of mathematical values as a register with these limits holds them, if they do not lie on both sides of a
/// wrap.
fn wrapped(values: Wide, limits: Wide) -> Wide {
    let size = limits.1 - limits.0 + 1;
    let turn = (values.0 - limits.0).div_euclid(size);
    if values.0 <= values.1 && turn == (values.1 - limits.0).div_euclid(size) {
        (values.0 - turn * size, values.1 - turn * size)
    } else {
        limits
    }
}

impl Interval {
    /// Any value of a representation; for reals it says nothing.
    pub fn full(repr: Repr) -> Self {
        if !repr.is_int() {
            return Self { signed: (i64::MIN, i64::MAX), unsigned: (0, u64::MAX) };
        }
        let (low, high) = signed_limits(repr);
        Self { signed: (low as i64, high as i64), unsigned: (0, repr.mask()) }
    }

    /// One register value.
    pub fn one(repr: Repr, raw: u64) -> Self {
        let signed = repr.sign_extend(raw);
        Self { signed: (signed, signed), unsigned: (raw, raw) }
    }

    /// Signed values between these, both included.
    pub fn between_signed(repr: Repr, low: i64, high: i64) -> Option<Self> {
        Self::new(repr, (low.into(), high.into()), unsigned_limits(repr))
    }

    /// Unsigned values between these, both included.
    pub fn between_unsigned(repr: Repr, low: u64, high: u64) -> Option<Self> {
        Self::new(repr, signed_limits(repr), (low.into(), high.into()))
    }

    /// A truth value.
    pub fn truth() -> Self {
        Self { signed: (0, 1), unsigned: (0, 1) }
    }

    fn decided(truth: Option<bool>) -> Self {
        truth.map_or(Self::truth(), |t| Self::one(Repr::I8, t.into()))
    }

    /// Both intervals at once, each cut by what the other says; `None` if nothing is left.
    fn new(repr: Repr, signed: Wide, unsigned: Wide) -> Option<Self> {
        let (limits, size) = (signed_limits(repr), 1i128 << repr.bits());
        let mut signed = meet(signed, limits);
        let mut unsigned = meet(unsigned, unsigned_limits(repr));
        for _ in 0..2 {
            if unsigned.1 <= limits.1 {
                signed = meet(signed, unsigned);
            } else if unsigned.0 > limits.1 {
                signed = meet(signed, (unsigned.0 - size, unsigned.1 - size));
            }
            if signed.0 >= 0 {
                unsigned = meet(unsigned, signed);
            } else if signed.1 < 0 {
                unsigned = meet(unsigned, (signed.0 + size, signed.1 + size));
            }
            if signed.0 > signed.1 || unsigned.0 > unsigned.1 {
                return None;
            }
        }
        Some(Self { signed: (signed.0 as i64, signed.1 as i64), unsigned: (unsigned.0 as u64, unsigned.1 as u64) })
    }

    /// From two intervals of which each holds every value.
    fn both(repr: Repr, signed: Wide, unsigned: Wide) -> Self {
        Self::new(repr, signed, unsigned).unwrap_or_else(|| Self::full(repr))
    }

    fn wide_signed(self) -> Wide {
        (self.signed.0.into(), self.signed.1.into())
    }

    fn wide_unsigned(self) -> Wide {
        (self.unsigned.0.into(), self.unsigned.1.into())
    }

    /// Its only value.
    pub fn single(self) -> Option<u64> {
        (self.unsigned.0 == self.unsigned.1).then_some(self.unsigned.0)
    }

    /// What lies in both; `None` if nothing does.
    pub fn and(self, other: Self, repr: Repr) -> Option<Self> {
        Self::new(
            repr,
            meet(self.wide_signed(), other.wide_signed()),
            meet(self.wide_unsigned(), other.wide_unsigned()),
        )
    }

    /// What lies in one of them, and what lies between.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            signed: (self.signed.0.min(other.signed.0), self.signed.1.max(other.signed.1)),
            unsigned: (self.unsigned.0.min(other.unsigned.0), self.unsigned.1.max(other.unsigned.1)),
        }
    }

    /// Whether all of `other` lies in it.
    pub fn contains(self, other: Self) -> bool {
        self.or(other) == self
    }

    /// At least `other`, with every end that moved moved on to the next of some numbers (sorted), so that it cannot move
    /// often; without numbers to the limit.
    #[must_use]
    pub fn widened(self, other: Self, stops: &[i64], repr: Repr) -> Self {
        let full = Self::full(repr);
        let below = |new: i64| stops[..stops.partition_point(|stop| *stop <= new)].last().copied();
        let above = |new: i64| stops.get(stops.partition_point(|stop| *stop < new)).copied();
        let signed = |old: Self, new: Self| {
            let low = below(new.signed.0).unwrap_or(full.signed.0).max(full.signed.0);
            let high = above(new.signed.1).unwrap_or(full.signed.1).min(full.signed.1);
            (
                if new.signed.0 < old.signed.0 { low } else { old.signed.0 },
                if new.signed.1 > old.signed.1 { high } else { old.signed.1 },
            )
        };
        let unsigned = |old: Self, new: Self| {
            let stop = |stop: Option<i64>| stop.and_then(|stop| u64::try_from(stop).ok());
            let low = stop(i64::try_from(new.unsigned.0).ok().and_then(below)).unwrap_or(0);
            let most = full.signed.1 as u64;
            // A signed number that grows and never becomes negative stops at the greatest one.
            let limit = if new.unsigned.1 <= most { most } else { full.unsigned.1 };
            let high = stop(i64::try_from(new.unsigned.1).ok().and_then(above)).map_or(limit, |stop| stop.min(limit));
            (
                if new.unsigned.0 < old.unsigned.0 { low } else { old.unsigned.0 },
                if new.unsigned.1 > old.unsigned.1 { high } else { old.unsigned.1 },
            )
        };
        Self { signed: signed(self, other), unsigned: unsigned(self, other) }
    }

    /// Whether no value is negative.
    pub fn not_negative(self) -> bool {
        self.signed.0 >= 0
    }

    /// The values that `first + step * k` takes for `k` up to `passes`, if none of them wraps.
    pub fn progression(first: Self, step: i64, passes: u64, repr: Repr) -> Option<Self> {
        let way = i128::from(step).checked_mul(i128::from(passes))?;
        let (back, forth) = (way.min(0), way.max(0));
        let reach = |values: Wide, limits: Wide| {
            let all = (values.0 + back, values.1 + forth);
            (all.0 >= limits.0 && all.1 <= limits.1).then_some(all)
        };
        let signed = reach(first.wide_signed(), signed_limits(repr));
        let unsigned = reach(first.wide_unsigned(), unsigned_limits(repr));
        if signed.is_none() && unsigned.is_none() {
            return None;
        }
        Self::new(repr, signed.unwrap_or(signed_limits(repr)), unsigned.unwrap_or(unsigned_limits(repr)))
    }
}

/// The smallest number of the form `2^n - 1` that is not less.
fn ones(n: u64) -> u64 {
    if n == 0 { 0 } else { u64::MAX >> n.leading_zeros() }
}

/// The results of a comparison, if it is decided.
pub fn compare(op: PrimOp, a: Interval, b: Interval) -> Option<bool> {
    let (s, u) = ((a.signed, b.signed), (a.unsigned, b.unsigned));
    let apart = s.0.1 < s.1.0 || s.1.1 < s.0.0 || u.0.1 < u.1.0 || u.1.1 < u.0.0;
    let same = a.single().is_some() && a.single() == b.single();
    let choose = |yes: bool, no: bool| if yes { Some(true) } else { no.then_some(false) };
    match op {
        PrimOp::Eq => choose(same, apart),
        PrimOp::Ne => choose(apart, same),
        PrimOp::LtS => choose(s.0.1 < s.1.0, s.0.0 >= s.1.1),
        PrimOp::LeS => choose(s.0.1 <= s.1.0, s.0.0 > s.1.1),
        PrimOp::LtU => choose(u.0.1 < u.1.0, u.0.0 >= u.1.1),
        PrimOp::LeU => choose(u.0.1 <= u.1.0, u.0.0 > u.1.1),
        _ => None,
    }
}

/// The results of an operation on operands of `repr` in these intervals (of `Select`: condition and choices).
pub fn apply(op: PrimOp, repr: Repr, args: &[Interval]) -> Interval {
    use PrimOp::*;
    let result = op.result(repr);
    if !repr.is_int() || !result.is_int() {
        return match op {
            FEq | FNe | FLt | FLe => Interval::truth(),
            Select if repr.is_int() => args[1].or(args[2]),
            _ => Interval::full(result),
        };
    }
    let singles: Vec<u64> = args.iter().filter_map(|a| a.single()).collect();
    if singles.len() == args.len() {
        return Interval::one(result, eval(op, repr, &singles));
    }
    match *args {
        [a] => unary(op, repr, a),
        [a, b] => binary(op, repr, a, b),
        [c, a, b] => match (c.single(), c.unsigned.0) {
            (Some(0), _) => b,
            (_, 1..) => a,
            _ => a.or(b),
        },
        _ => Interval::full(result),
    }
}

fn unary(op: PrimOp, repr: Repr, a: Interval) -> Interval {
    use PrimOp::*;
    let (s, u) = (a.wide_signed(), a.wide_unsigned());
    match op {
        Neg => both_wrapped(repr, (-s.1, -s.0), (-u.1, -u.0)),
        Not => both_wrapped(repr, (-1 - s.1, -1 - s.0), (-1 - u.1, -1 - u.0)),
        Zext(to) => Interval::both(to, signed_limits(to), u),
        Sext(to) => Interval::both(to, s, unsigned_limits(to)),
        Wrap(to) => {
            let by_signed = both_wrapped(to, s, s);
            let by_unsigned = both_wrapped(to, u, u);
            by_signed.and(by_unsigned, to).unwrap_or(by_signed)
        }
        _ => Interval::full(op.result(repr)),
    }
}

/// From mathematical intervals of which each holds every result before it wraps.
fn both_wrapped(repr: Repr, signed: Wide, unsigned: Wide) -> Interval {
    Interval::both(repr, wrapped(signed, signed_limits(repr)), wrapped(unsigned, unsigned_limits(repr)))
}

fn binary(op: PrimOp, repr: Repr, a: Interval, b: Interval) -> Interval {
    use PrimOp::*;
    let full = Interval::full(repr);
    let (s, t) = (a.wide_signed(), b.wide_signed());
    let (u, v) = (a.wide_unsigned(), b.wide_unsigned());
    let unsigned = |low: u64, high: u64| Interval::between_unsigned(repr, low, high).unwrap_or(full);
    let signed = |low: i128, high: i128| Interval::both(repr, (low, high), unsigned_limits(repr));
    let (au, bu) = (a.unsigned, b.unsigned);
    match op {
        Add => both_wrapped(repr, (s.0 + t.0, s.1 + t.1), (u.0 + v.0, u.1 + v.1)),
        Sub => both_wrapped(repr, (s.0 - t.1, s.1 - t.0), (u.0 - v.1, u.1 - v.0)),
        Mul => {
            let ends = [s.0 * t.0, s.0 * t.1, s.1 * t.0, s.1 * t.1];
            let products = (*ends.iter().min().unwrap_or(&0), *ends.iter().max().unwrap_or(&0));
            // Only the greatest product of two 64-bit numbers can be too wide.
            let unsigned =
                u.1.checked_mul(v.1)
                    .map_or(unsigned_limits(repr), |high| wrapped((u.0 * v.0, high), unsigned_limits(repr)));
            Interval::both(repr, wrapped(products, signed_limits(repr)), unsigned)
        }
        MulHiS => {
            let ends = [s.0 * t.0, s.0 * t.1, s.1 * t.0, s.1 * t.1];
            signed(*ends.iter().min().unwrap_or(&0) >> repr.bits(), *ends.iter().max().unwrap_or(&0) >> repr.bits())
        }
        MulHiU => {
            let high = |a: u64, b: u64| ((u128::from(a) * u128::from(b)) >> repr.bits()) as u64;
            unsigned(high(au.0, bu.0), high(au.1, bu.1))
        }
        DivU => unsigned(if bu.0 == 0 { 0 } else { au.0 / bu.1 }, au.1 / bu.0.max(1)),
        RemU if bu.0 > au.1 => a,
        RemU => unsigned(0, au.1.min(bu.1.saturating_sub(1))),
        DivS if t.0 > 0 => {
            signed(if s.0 >= 0 { s.0 / t.1 } else { s.0 / t.0 }, if s.1 >= 0 { s.1 / t.0 } else { s.1 / t.1 })
        }
        DivS => {
            let size = s.0.abs().max(s.1.abs());
            // The smallest number by -1 is itself.
            if s.0 == signed_limits(repr).0 { full } else { signed(-size, size) }
        }
        RemS if s.0 >= 0 && t.0 > s.1 => a,
        RemS => {
            let size = (t.0.abs().max(t.1.abs()) - 1).max(0);
            signed(s.0.min(0).max(-size), s.1.max(0).min(size))
        }
        And => unsigned(0, au.1.min(bu.1)),
        Or => unsigned(au.0.max(bu.0), ones(au.1 | bu.1)),
        Xor => unsigned(0, ones(au.1 | bu.1)),
        Shl => {
            let bits = u64::from(repr.bits());
            if bu.1 >= bits {
                return full;
            }
            let factors = (1i128 << bu.0, 1i128 << bu.1);
            let ends = [s.0 * factors.0, s.0 * factors.1, s.1 * factors.0, s.1 * factors.1];
            let products = (*ends.iter().min().unwrap_or(&0), *ends.iter().max().unwrap_or(&0));
            both_wrapped(repr, products, (u.0 * factors.0, u.1 * factors.1))
        }
        ShrU => {
            let shift = |n: u64, by: u64| if by >= u64::from(repr.bits()) { 0 } else { n >> by };
            unsigned(shift(au.0, bu.1), shift(au.1, bu.0))
        }
        ShrS => {
            let shift = |n: i128, by: u64| n >> by.min(63);
            signed(shift(s.0, bu.0).min(shift(s.0, bu.1)), shift(s.1, bu.0).max(shift(s.1, bu.1)))
        }
        MinS => Interval::both(repr, (s.0.min(t.0), s.1.min(t.1)), a.or(b).wide_unsigned()),
        MaxS => Interval::both(repr, (s.0.max(t.0), s.1.max(t.1)), a.or(b).wide_unsigned()),
        MinU => Interval::both(repr, a.or(b).wide_signed(), (u.0.min(v.0), u.1.min(v.1))),
        MaxU => Interval::both(repr, a.or(b).wide_signed(), (u.0.max(v.0), u.1.max(v.1))),
        Eq | Ne | LtS | LeS | LtU | LeU => Interval::decided(compare(op, a, b)),
        _ => Interval::full(op.result(repr)),
    }
}

/// What is left of `a` and of `b` if a comparison of them has this result; `None` if it cannot have it.
pub fn assume(op: PrimOp, truth: bool, repr: Repr, a: Interval, b: Interval) -> Option<(Interval, Interval)> {
    use PrimOp::*;
    let (op, a, b, swapped) = match (op, truth) {
        (Eq | LtS | LeS | LtU | LeU, true) | (Ne, true) => (op, a, b, false),
        (Eq, false) => (Ne, a, b, false),
        (Ne, false) => (Eq, a, b, false),
        (LtS, false) => (LeS, b, a, true),
        (LeS, false) => (LtS, b, a, true),
        (LtU, false) => (LeU, b, a, true),
        (LeU, false) => (LtU, b, a, true),
        _ => return Some((a, b)),
    };
    let (s, t) = (a.wide_signed(), b.wide_signed());
    let (u, v) = (a.wide_unsigned(), b.wide_unsigned());
    let (a, b) = match op {
        Eq => {
            let same = a.and(b, repr)?;
            (same, same)
        }
        Ne => (a.without(b, repr)?, b.without(a, repr)?),
        LtS | LeS => {
            let gap = i128::from(op == LtS);
            let least = (t.0.max(s.0 + gap), t.1);
            (Interval::new(repr, (s.0, s.1.min(t.1 - gap)), u)?, Interval::new(repr, least, v)?)
        }
        _ => {
            let gap = i128::from(op == LtU);
            let least = (v.0.max(u.0 + gap), v.1);
            (Interval::new(repr, s, (u.0, u.1.min(v.1 - gap)))?, Interval::new(repr, t, least)?)
        }
    };
    Some(if swapped { (b, a) } else { (a, b) })
}

impl Interval {
    /// Without the only value of another, if that is an end.
    pub fn without(self, other: Self, repr: Repr) -> Option<Self> {
        let Some(raw) = other.single() else { return Some(self) };
        let (mut signed, mut unsigned) = (self.wide_signed(), self.wide_unsigned());
        let (s, u) = (i128::from(other.signed.0), i128::from(raw));
        signed.0 += i128::from(signed.0 == s);
        signed.1 -= i128::from(signed.1 == s);
        unsigned.0 += i128::from(unsigned.0 == u);
        unsigned.1 -= i128::from(unsigned.1 == u);
        Self::new(repr, signed, unsigned)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use PrimOp::*;

    /// Every interval that two numbers of eight bits and a reading give, thinned out by a seed.
    fn intervals(count: usize, seed: &mut u64) -> Vec<Interval> {
        let mut random = || {
            *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let small = (*seed >> 32) as u8;
            // Ends of the range come often.
            [0, 1, 127, 128, 255, small, small, small][(*seed >> 60) as usize % 8]
        };
        let mut list = vec![Interval::full(Repr::I8), Interval::truth()];
        while list.len() < count {
            let (x, y) = (random(), random());
            let made = if random() % 2 == 0 {
                Interval::between_unsigned(Repr::I8, x.min(y).into(), x.max(y).into())
            } else {
                let (x, y) = (i64::from(x as i8), i64::from(y as i8));
                Interval::between_signed(Repr::I8, x.min(y), x.max(y))
            };
            list.extend(made);
        }
        list
    }

    fn holds(interval: Interval, repr: Repr, raw: u64) -> bool {
        let signed = repr.sign_extend(raw);
        (interval.unsigned.0..=interval.unsigned.1).contains(&raw)
            && (interval.signed.0..=interval.signed.1).contains(&signed)
    }

    fn members(interval: Interval) -> Vec<u64> {
        (0..256).filter(|raw| holds(interval, Repr::I8, *raw)).collect()
    }

    #[test]
    fn every_result_lies_inside() {
        let mut seed = 3;
        let list = intervals(16, &mut seed);
        let counts: Vec<Interval> = [(0, 0), (0, 3), (2, 7), (6, 9), (8, 8), (1, u64::MAX)]
            .iter()
            .filter_map(|(low, high)| Interval::between_unsigned(Repr::I64, *low, *high))
            .collect();
        for op in [Neg, Not, Zext(Repr::I16), Sext(Repr::I16), Zext(Repr::I64), Sext(Repr::I32)] {
            for a in &list {
                let made = apply(op, Repr::I8, &[*a]);
                for x in members(*a) {
                    assert!(
                        holds(made, op.result(Repr::I8), eval(op, Repr::I8, &[x])),
                        "{op:?} {x} of {a:?}: {made:?}"
                    );
                }
            }
        }
        for op in [
            Add, Sub, Mul, DivS, DivU, RemS, RemU, And, Or, Xor, Shl, ShrU, ShrS, Rotl, Rotr, MinS, MinU, MaxS, MaxU,
            Eq, Ne, LtS, LeS, LtU, LeU,
        ] {
            let right = if op.operand(Repr::I8, 1) == Repr::I64 { &counts } else { &list };
            for a in &list {
                for b in right {
                    let made = apply(op, Repr::I8, &[*a, *b]);
                    let others: Vec<u64> = if std::ptr::eq(right, &list) {
                        members(*b)
                    } else {
                        (0..12).chain([u64::MAX]).filter(|n| holds(*b, Repr::I64, *n)).collect()
                    };
                    for x in members(*a).into_iter().step_by(7).chain([a.unsigned.0, a.unsigned.1]) {
                        for y in others.iter().copied().step_by(11).chain([b.unsigned.0, b.unsigned.1]) {
                            let result = eval(op, Repr::I8, &[x, y]);
                            let inputs = holds(*a, Repr::I8, x) && holds(*b, op.operand(Repr::I8, 1), y);
                            assert!(
                                !inputs || holds(made, op.result(Repr::I8), result),
                                "{op:?} {x} {y} = {result} of {a:?} {b:?}: {made:?}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn cutting_keeps_the_low_bits() {
        for (low, high) in [(-5, 5), (250, 260), (0, 100), (-300, -257), (256, 300), (-129, -128), (65530, 65540)] {
            let a = Interval::between_signed(Repr::I32, low, high).expect("not empty");
            let made = apply(Wrap(Repr::I8), Repr::I32, &[a]);
            for x in low..=high {
                assert!(holds(made, Repr::I8, x as u64 & 255), "{x} of {low}..{high}: {made:?}");
            }
        }
    }

    #[test]
    fn assumptions_keep_what_fits() {
        let mut seed = 5;
        let list = intervals(20, &mut seed);
        for op in [Eq, Ne, LtS, LeS, LtU, LeU] {
            for truth in [true, false] {
                for a in &list {
                    for b in &list {
                        let left = assume(op, truth, Repr::I8, *a, *b);
                        for x in members(*a).into_iter().step_by(5).chain([a.unsigned.0, a.unsigned.1]) {
                            for y in members(*b).into_iter().step_by(7).chain([b.unsigned.0, b.unsigned.1]) {
                                if holds(*a, Repr::I8, x)
                                    && holds(*b, Repr::I8, y)
                                    && (eval(op, Repr::I8, &[x, y]) == 1) == truth
                                {
                                    let (p, q) = left.expect("it happens");
                                    assert!(holds(p, Repr::I8, x) && holds(q, Repr::I8, y), "{op:?} {truth} {x} {y}");
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn typical_results_are_exact() {
        let of = |low, high| Interval::between_signed(Repr::I16, low, high).expect("not empty");
        let one = |n: i64| of(n, n);
        assert_eq!(apply(Add, Repr::I16, &[of(1, 9), one(-1)]), of(0, 8));
        assert_eq!(apply(Mul, Repr::I16, &[of(0, 3), one(4)]), of(0, 12));
        assert_eq!(apply(RemS, Repr::I16, &[Interval::full(Repr::I16), one(10)]), of(-9, 9));
        assert_eq!(apply(RemU, Repr::I16, &[Interval::full(Repr::I16), one(10)]), of(0, 9));
        assert_eq!(apply(And, Repr::I16, &[Interval::full(Repr::I16), one(7)]), of(0, 7));
        assert_eq!(apply(ShrU, Repr::I8, &[Interval::full(Repr::I8), Interval::one(Repr::I64, 4)]).unsigned, (0, 15));
        assert_eq!(assume(LtS, false, Repr::I16, of(-5, 5), one(0)), Some((of(0, 5), one(0))));
        assert_eq!(assume(Ne, true, Repr::I16, of(0, 5), one(0)), Some((of(1, 5), one(0))));
        assert_eq!(assume(Eq, true, Repr::I16, of(0, 5), one(6)), None);
        assert_eq!(Interval::progression(one(1), 2, 4, Repr::I16), Some(of(1, 9)));
        assert_eq!(Interval::progression(of(32760, 32767), 1, 1, Repr::I16).map(|i| i.unsigned), Some((32760, 32768)));
        assert_eq!(Interval::progression(Interval::full(Repr::I16), 1, 1, Repr::I16), None);
    }
}
