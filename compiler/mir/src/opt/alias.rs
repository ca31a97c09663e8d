//! Which places may be the same memory, and what a call may read and write.
//!
//! Addresses are numbers here: a place in the region covers bytes that its bounds tell; the instances that a function works
//! on are those places that its callers give it; a reference reaches the addressable part and what the program takes the
//! address of (semantics.md \[R2\]). Frames are no one else's unless their address is taken.

use super::rewrite::Constants;
use crate::ir::{Base, Func, FuncId, Inst, Place, Program};
use crate::verify::bottom_up;
use index_vec::IndexVec;
use std::borrow::Cow;

/// More ranges than this are merged: then a set says more than is true, which is safe.
const MAX_RANGES: usize = 48;

/// Bytes of the region: sorted ranges [start, end) that do not touch.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Bytes(Vec<(i64, i64)>);

impl Bytes {
    fn add(&mut self, start: i64, end: i64) {
        if start >= end {
            return;
        }
        let first = self.0.partition_point(|r| r.1 < start);
        let last = self.0.partition_point(|r| r.0 <= end);
        let merged = self.0[first..last].iter().fold((start, end), |m, r| (m.0.min(r.0), m.1.max(r.1)));
        self.0.splice(first..last, [merged]);
        if self.0.len() > MAX_RANGES {
            let gap = |n: &usize| self.0[n + 1].0 - self.0[*n].1;
            if let Some(n) = (0..self.0.len() - 1).min_by_key(gap) {
                let end = self.0.remove(n + 1).1;
                self.0[n].1 = end;
            }
        }
    }

    fn add_all(&mut self, other: &Bytes) {
        other.0.iter().for_each(|(start, end)| self.add(*start, *end));
    }

    fn meets(&self, start: i64, end: i64) -> bool {
        let at = self.0.partition_point(|r| r.1 <= start);
        self.0.get(at).is_some_and(|r| r.0 < end)
    }
}

/// What a function and its callees do to memory that others see.
#[derive(Debug, Clone, Default)]
struct Effects {
    reads: Bytes,
    writes: Bytes,
}

/// The pass that comes first: keeps in the program what references reach. Later passes turn the address of a fixed place
/// into a number, and then no instruction says any more that it is taken.
pub fn keep(program: &mut Program) {
    let escaped = Facts::new(program).escaped.0;
    let range = |(start, end): (i64, i64)| (start.max(0) as u32, (end - start.max(0)).max(0) as u32);
    program.addressable = escaped.into_iter().map(range).collect();
}

/// What is known of a whole program.
#[derive(Debug, Default)]
pub struct Facts {
    /// First bytes of the instances of each function: ranges [first, last].
    instances: IndexVec<FuncId, Vec<(i64, i64)>>,
    effects: IndexVec<FuncId, Effects>,
    /// What references reach.
    escaped: Bytes,
    /// Where frames lie.
    frames: (i64, i64),
    /// Bytes of frames that callers read when the function has ended: its outputs, and results that are no scalars.
    handed_over: Bytes,
}

impl Facts {
    /// Of a verified program.
    pub fn new(program: &Program) -> Self {
        let count = program.funcs.len();
        let mut facts = Facts {
            instances: IndexVec::from_vec(vec![Vec::new(); count]),
            effects: IndexVec::from_vec(vec![Effects::default(); count]),
            escaped: Bytes::default(),
            frames: (i64::from(program.frame_base), i64::from(program.region_bytes).max(i64::from(program.frame_base))),
            handed_over: Bytes::default(),
        };
        for func in &program.funcs {
            facts.handed_over.add_all(&read_of_callees(func));
        }
        let Ok(order) = bottom_up(program) else { return facts };
        for id in order.iter().rev() {
            facts.instances_of_callees(program, *id);
        }
        for (start, length) in &program.addressable {
            facts.escaped.add(i64::from(*start), i64::from(*start) + i64::from(*length));
        }
        for (id, func) in program.funcs.iter_enumerated() {
            for inst in func.blocks.iter().flat_map(|b| &b.insts) {
                if let Inst::AddressOf { place, bytes, .. } = inst {
                    let mut taken = Bytes::default();
                    facts.add_place(&mut taken, id, place, i64::from(*bytes));
                    facts.escaped.add_all(&taken);
                }
            }
        }
        // Of functions that are called; most were inlined by now.
        let mut called: IndexVec<FuncId, bool> = IndexVec::from_vec(vec![false; count]);
        for inst in program.funcs.iter().flat_map(|f| &f.blocks).flat_map(|b| &b.insts) {
            if let Inst::Call { callee, .. } = inst {
                called[*callee] = true;
            }
        }
        for id in order.into_iter().filter(|id| called[*id]) {
            let effects = facts.effects_of(program, id);
            facts.effects[id] = effects;
        }
        facts
    }

    fn instances_of_callees(&mut self, program: &Program, id: FuncId) {
        for inst in program.funcs[id].blocks.iter().flat_map(|b| &b.insts) {
            let Inst::Call { callee, instance: Some(place), .. } = inst else { continue };
            let (low, high) = span(place, 0);
            let starts: Vec<(i64, i64)> = match place.base {
                Base::Region => vec![(low, high)],
                Base::Instance => self.instances[id].iter().map(|(first, last)| (first + low, last + high)).collect(),
                Base::Frame => vec![self.frames],
                Base::Reference(_) => vec![(0, self.frames.1)],
            };
            let list = &mut self.instances[*callee];
            list.extend(starts);
            list.sort_unstable();
            list.dedup();
            if list.len() > MAX_RANGES {
                let all = (list[0].0, list.iter().map(|r| r.1).max().unwrap_or(0));
                *list = vec![all];
            }
        }
    }

    /// Adds the bytes that a place may be.
    fn add_place(&self, to: &mut Bytes, func: FuncId, place: &Place, bytes: i64) {
        let (start, end) = span(place, bytes);
        match place.base {
            Base::Region => to.add(start, end),
            Base::Instance => self.instances[func].iter().for_each(|(low, high)| to.add(low + start, high + end)),
            Base::Frame => to.add(self.frames.0, self.frames.1),
            Base::Reference(_) => to.add_all(&self.escaped),
        }
    }

    fn effects_of(&self, program: &Program, id: FuncId) -> Effects {
        let func = &program.funcs[id];
        let constants = Constants::new(func);
        let mut effects = Effects::default();
        for inst in func.blocks.iter().flat_map(|b| &b.insts) {
            if let Inst::Call { callee, .. } = inst {
                let inner = self.effects[*callee].clone();
                effects.reads.add_all(&inner.reads);
                effects.writes.add_all(&inner.writes);
            }
            for_each_access(func, &constants, inst, &mut |place, bytes, write| {
                if place.base != Base::Frame {
                    self.add_place(if write { &mut effects.writes } else { &mut effects.reads }, id, place, bytes);
                }
            });
        }
        effects
    }
}

/// What a function reads of the frames of its callees, counted from their start.
fn read_of_callees(func: &Func) -> Bytes {
    let own = i64::from(func.frame_bytes);
    let mut read = Bytes::default();
    let mut note = |place: &Place, bytes: i64| {
        let (start, end) = span(place, bytes);
        if place.base == Base::Frame && end > own {
            read.add((start - own).max(0), end - own);
        }
    };
    let constants = Constants::new(func);
    for inst in func.blocks.iter().flat_map(|b| &b.insts) {
        match inst {
            Inst::AddressOf { place, .. } | Inst::Call { instance: Some(place), .. } => note(place, 1 << 32),
            _ => for_each_access(func, &constants, inst, &mut |place, bytes, write| {
                if !write {
                    note(place, bytes);
                }
            }),
        }
    }
    read
}

/// The bytes [start, end) that a place covers, counted from its base.
pub fn span(place: &Place, bytes: i64) -> (i64, i64) {
    let (mut low, mut high) = (place.offset, place.offset.saturating_add(bytes));
    for term in &place.index {
        let stride = i64::from(term.stride);
        low = low.saturating_add(term.low.saturating_mul(stride));
        high = high.saturating_add(term.high.saturating_mul(stride));
    }
    (low, high)
}

/// Two places of one base without the variable parts that both have.
fn without_common_terms<'a>(a: &'a Place, b: &'a Place) -> (Cow<'a, Place>, Cow<'a, Place>) {
    if a.index.is_empty() || b.index.is_empty() {
        return (Cow::Borrowed(a), Cow::Borrowed(b));
    }
    let (mut a, mut b) = (a.clone(), b.clone());
    a.index.retain(|term| {
        let same = b.index.iter().position(|other| (other.value, other.stride) == (term.value, term.stride));
        same.map(|n| b.index.remove(n)).is_none()
    });
    (Cow::Owned(a), Cow::Owned(b))
}

/// Calls `f` with every place that an instruction accesses, how many bytes, and whether it writes them. Calls say only
/// what their arguments say: nothing.
pub fn for_each_access(func: &Func, constants: &Constants, inst: &Inst, f: &mut impl FnMut(&Place, i64, bool)) {
    match inst {
        Inst::Load { dst, place, .. } => f(place, i64::from(func.values[*dst].bytes()), false),
        Inst::Store { place, value } => f(place, i64::from(func.values[*value].bytes()), true),
        Inst::Copy { dst, src, bytes } => {
            f(src, i64::from(*bytes), false);
            f(dst, i64::from(*bytes), true);
        }
        Inst::Zero { dst, bytes } => f(dst, i64::from(*bytes), true),
        Inst::CallText { func: body, texts, .. } => {
            for (n, text) in texts.iter().enumerate() {
                // What the capacity is, may be known only at run time.
                let unit = i64::from(body.unit_bytes(n));
                let bytes = constants.get(text.capacity).map_or(1 << 32, |capacity| unit * (capacity as i64 + 1));
                f(&text.place, bytes, false);
                if n == 0 && body.builds {
                    f(&text.place, bytes, true);
                }
            }
        }
        Inst::Check { .. }
        | Inst::Poll { .. }
        | Inst::Call { .. }
        | Inst::Const { .. }
        | Inst::Prim { .. }
        | Inst::AddressOf { .. }
        | Inst::CallRt { .. } => {}
    }
}

/// The questions that passes over one function ask.
pub struct Alias<'a> {
    facts: &'a Facts,
    id: FuncId,
    frame_bytes: i64,
}

impl<'a> Alias<'a> {
    /// For the function with this number.
    pub fn new(facts: &'a Facts, id: FuncId, func: &Func) -> Self {
        Self { facts, id, frame_bytes: i64::from(func.frame_bytes) }
    }

    /// Bytes of the own frame that callers read afterwards: ranges [start, end).
    pub fn handed_over(&self) -> &[(i64, i64)] {
        &self.facts.handed_over.0
    }

    /// Whether two accesses may touch the same memory.
    pub fn overlap(&self, a: &Place, a_bytes: i64, b: &Place, b_bytes: i64) -> bool {
        if a.base == b.base {
            // What both have in common moves them by the same.
            let (a_rest, b_rest) = without_common_terms(a, b);
            let ((a_start, a_end), (b_start, b_end)) = (span(&a_rest, a_bytes), span(&b_rest, b_bytes));
            let meets = a_start < b_end && b_start < a_end;
            let other_bits =
                a.index == b.index && a.offset == b.offset && a.bit.zip(b.bit).is_some_and(|(a, b)| a != b);
            return meets && !other_bits;
        }
        match (a.base, b.base) {
            (Base::Reference(_), Base::Reference(_)) => true,
            (Base::Reference(_), _) => self.escapes(b, b_bytes),
            (_, Base::Reference(_)) => self.escapes(a, a_bytes),
            (Base::Instance, _) => self.instance_meets(a, a_bytes, b, b_bytes),
            (_, Base::Instance) => self.instance_meets(b, b_bytes, a, a_bytes),
            _ => false,
        }
    }

    fn instance_meets(&self, own: &Place, own_bytes: i64, other: &Place, other_bytes: i64) -> bool {
        let (start, end) = span(own, own_bytes);
        let (other_start, other_end) =
            if other.base == Base::Frame { self.facts.frames } else { span(other, other_bytes) };
        let mut instances = self.facts.instances[self.id].iter();
        instances.any(|(low, high)| low + start < other_end && other_start < high + end)
    }

    /// Whether references reach it.
    pub fn escapes(&self, place: &Place, bytes: i64) -> bool {
        self.meets(&self.facts.escaped, place, bytes)
    }

    fn meets(&self, set: &Bytes, place: &Place, bytes: i64) -> bool {
        let (start, end) = span(place, bytes);
        match place.base {
            Base::Region => set.meets(start, end),
            Base::Instance => {
                self.facts.instances[self.id].iter().any(|(low, high)| set.meets(low + start, high + end))
            }
            Base::Frame => set.meets(self.facts.frames.0, self.facts.frames.1),
            Base::Reference(_) => self.facts.escaped.0.iter().any(|(low, high)| set.meets(*low, *high)),
        }
    }

    /// Whether a place lies, or may lie, in the frame of a callee: there arguments and results are handed over.
    fn in_callee_frame(&self, place: &Place, bytes: i64) -> bool {
        place.base == Base::Frame && span(place, bytes).1 > self.frame_bytes
    }

    /// Whether an instruction may write any of these bytes.
    pub fn may_write(&self, func: &Func, constants: &Constants, inst: &Inst, place: &Place, bytes: i64) -> bool {
        self.may_touch(func, constants, inst, place, bytes, true)
    }

    /// Whether an instruction may read any of these bytes. What an exit shows is not its business.
    pub fn may_read(&self, func: &Func, constants: &Constants, inst: &Inst, place: &Place, bytes: i64) -> bool {
        self.may_touch(func, constants, inst, place, bytes, false)
    }

    fn may_touch(
        &self,
        func: &Func,
        constants: &Constants,
        inst: &Inst,
        place: &Place,
        bytes: i64,
        write: bool,
    ) -> bool {
        if let Inst::Call { callee, .. } = inst {
            let effects = &self.facts.effects[*callee];
            let set = if write { &effects.writes } else { &effects.reads };
            return self.in_callee_frame(place, bytes) || self.meets(set, place, bytes);
        }
        let mut touches = false;
        for_each_access(func, constants, inst, &mut |other, other_bytes, writes| {
            touches |= writes == write && self.overlap(place, bytes, other, other_bytes);
        });
        touches
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_merge_and_stay_few() {
        let mut set = Bytes::default();
        set.add(10, 20);
        set.add(30, 40);
        set.add(20, 25);
        assert_eq!(set.0, [(10, 25), (30, 40)]);
        assert!(set.meets(24, 26) && !set.meets(25, 30) && set.meets(0, 11) && !set.meets(40, 50));
        set.add(5, 50);
        assert_eq!(set.0, [(5, 50)]);
        let mut many = Bytes::default();
        (0..200).for_each(|n| many.add(n * 100, n * 100 + 1 + n % 7));
        assert!(many.0.len() <= MAX_RANGES);
        assert!((0..200).all(|n| many.meets(n * 100, n * 100 + 1)));
    }
}
