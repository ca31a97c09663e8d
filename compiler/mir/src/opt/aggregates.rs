//! Small aggregates are copied part by part, as the program accesses them.
//!
//! A copy of all bytes hides values: what was just stored in a field is read back through memory, in other pieces than it
//! was written, which machines do slowly. Copied field by field, the fields are values that other passes see through, and
//! temporaries of structures vanish. Which parts there are, the loads and stores of the function tell; copies hand them on
//! to each other. Strings are copied as a whole.
//!
//! ```text
//! copy 8 bytes frame+0 := recipe          v1 = load f32 recipe; v2 = load f32 recipe+4
//! v0 = load f32 frame+4               =>  store f32 frame+0 := v1; store f32 frame+4 := v2
//!                                         v0 = load f32 frame+4
//! ```

use crate::ir::{Base, Func, IndexTerm, Inst, Place};
use plcc_stdlib::prim::Repr;
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeMap;

/// Larger aggregates are copied as they are.
const BYTES: u32 = 64;

/// So many parts at most.
const PARTS: usize = 16;

/// More single bytes than these are copied together.
const BYTES_APART: usize = 2;

/// How often parts are handed on from copy to copy.
const ROUNDS: usize = 3;

/// What places have in common that differ in their constant offsets only.
type Root = (Base, Vec<IndexTerm>);

/// Parts by their first byte: end and representation.
type Parts = BTreeMap<i64, (i64, Repr)>;

/// The pass.
pub fn run(func: &mut Func) {
    let mut seen = Seen::default();
    let mut copies: Vec<(Place, Option<Place>, u32)> = Vec::new();
    for inst in func.blocks.iter().flat_map(|b| &b.insts) {
        match inst {
            Inst::Copy { dst, src, bytes } if *bytes <= BYTES => {
                copies.push((dst.clone(), Some(src.clone()), *bytes));
            }
            Inst::Zero { dst, bytes } if *bytes <= BYTES => copies.push((dst.clone(), None, *bytes)),
            Inst::Load { dst, place, .. } => seen.access(place, func.values[*dst]),
            Inst::Store { place, value } => seen.access(place, func.values[*value]),
            Inst::CallText { texts, .. } => texts.iter().for_each(|text| seen.text(&text.place)),
            _ => {}
        }
    }
    if copies.is_empty() {
        return;
    }
    for _ in 0..ROUNDS {
        for (dst, src, bytes) in &copies {
            let Some(src) = src else { continue };
            let there = seen.parts(src, *bytes);
            let here = seen.parts(dst, *bytes);
            seen.hand_on(dst, &there);
            seen.hand_on(src, &here);
            seen.hand_on_texts(src, dst, *bytes);
            seen.hand_on_texts(dst, src, *bytes);
        }
    }
    for id in func.blocks.indices() {
        let insts = std::mem::take(&mut func.blocks[id].insts);
        let mut out = Vec::with_capacity(insts.len());
        for inst in insts {
            match &inst {
                Inst::Copy { dst, src, bytes } if *bytes <= BYTES => match seen.plan(dst, Some(src), *bytes) {
                    Some(parts) => {
                        let mut stores = Vec::with_capacity(parts.len());
                        for (at, repr) in parts {
                            let value = func.values.push(repr);
                            out.push(Inst::Load { dst: value, place: moved(src, at), normalise: false });
                            stores.push(Inst::Store { place: moved(dst, at), value });
                        }
                        out.append(&mut stores);
                    }
                    None => out.push(inst),
                },
                Inst::Zero { dst, bytes } if *bytes <= BYTES => match seen.plan(dst, None, *bytes) {
                    Some(parts) => {
                        for (at, repr) in parts {
                            let value = func.values.push(repr);
                            out.push(Inst::Const { dst: value, raw: 0 });
                            out.push(Inst::Store { place: moved(dst, at), value });
                        }
                    }
                    None => out.push(inst),
                },
                _ => out.push(inst),
            }
        }
        func.blocks[id].insts = out;
    }
}

fn moved(place: &Place, by: i64) -> Place {
    Place { offset: place.offset + by, ..place.clone() }
}

/// How memory is accessed.
#[derive(Default)]
struct Seen {
    scalars: FxHashMap<Root, Parts>,
    /// Roots where accesses overlap in part: there nothing is known.
    confused: FxHashSet<(Root, i64)>,
    /// First bytes of strings.
    texts: FxHashMap<Root, Vec<i64>>,
}

impl Seen {
    fn access(&mut self, place: &Place, repr: Repr) {
        if place.bit.is_some() {
            return;
        }
        self.add((place.base, place.index.clone()), place.offset, repr);
        // An element of an array: all elements, seen from the array.
        if let Some((term, outer)) = place.index.split_last() {
            let count = term.high.saturating_sub(term.low).saturating_add(1);
            if count <= PARTS as i64 {
                let root = (place.base, outer.to_vec());
                for n in term.low..=term.high {
                    self.add(root.clone(), place.offset + n * i64::from(term.stride), repr);
                }
            }
        }
    }

    fn add(&mut self, root: Root, at: i64, repr: Repr) {
        let end = at + i64::from(repr.bytes());
        let parts = self.scalars.entry(root.clone()).or_default();
        match parts.get(&at) {
            Some((other, _)) if *other == end => return,
            _ => {}
        }
        let before = parts.range(..end).next_back().map(|(start, (e, _))| (*start, *e));
        match before {
            Some((start, e)) if e > at => {
                self.confused.insert((root, start.min(at)));
            }
            _ => {
                parts.insert(at, (end, repr));
            }
        }
    }

    fn text(&mut self, place: &Place) {
        let list = self.texts.entry((place.base, place.index.clone())).or_default();
        if !list.contains(&place.offset) {
            list.push(place.offset);
        }
    }

    /// The parts of some bytes, counted from the place.
    fn parts(&self, place: &Place, bytes: u32) -> Vec<(i64, Repr)> {
        let root = (place.base, place.index.clone());
        let (start, end) = (place.offset, place.offset + i64::from(bytes));
        let Some(parts) = self.scalars.get(&root) else { return Vec::new() };
        let inside = parts.range(start..end).filter(|(_, (e, _))| *e <= end);
        inside.map(|(at, (_, repr))| (at - start, *repr)).collect()
    }

    fn hand_on(&mut self, place: &Place, parts: &[(i64, Repr)]) {
        for (at, repr) in parts {
            self.add((place.base, place.index.clone()), place.offset + at, *repr);
        }
    }

    /// Strings that are copied are strings.
    fn hand_on_texts(&mut self, from: &Place, to: &Place, bytes: u32) {
        let range = from.offset..from.offset + i64::from(bytes);
        let Some(there) = self.texts.get(&(from.base, from.index.clone())) else { return };
        let new: Vec<i64> =
            there.iter().filter(|at| range.contains(at)).map(|at| at - from.offset + to.offset).collect();
        let here = self.texts.entry((to.base, to.index.clone())).or_default();
        for at in new {
            if !here.contains(&at) {
                here.push(at);
            }
        }
    }

    /// Whether a string lies there, or accesses of different sizes meet.
    fn is_whole(&self, place: &Place, bytes: u32) -> bool {
        let root = (place.base, place.index.clone());
        let range = place.offset..place.offset + i64::from(bytes);
        let text = self.texts.get(&root).is_some_and(|list| list.iter().any(|at| range.contains(at)));
        text || self.confused.iter().any(|(r, at)| *r == root && range.contains(at))
    }

    /// How to copy: every part, gaps in pieces as large as their place allows.
    fn plan(&self, dst: &Place, src: Option<&Place>, bytes: u32) -> Option<Vec<(i64, Repr)>> {
        if self.is_whole(dst, bytes) || src.is_some_and(|src| self.is_whole(src, bytes)) {
            return None;
        }
        let mut known: Parts = BTreeMap::new();
        for (at, repr) in self.parts(dst, bytes).into_iter().chain(src.map_or(Vec::new(), |src| self.parts(src, bytes)))
        {
            let end = at + i64::from(repr.bytes());
            match known.range(..end).next_back() {
                Some((start, (e, _))) if *e > at && (*start, *e) != (at, end) => return None,
                _ => {
                    known.insert(at, (end, repr));
                }
            }
        }
        if known.is_empty() {
            return None;
        }
        let mut plan = Vec::new();
        let mut at = 0;
        for (start, (end, repr)) in known {
            gap(&mut plan, at, start);
            plan.push((start, repr));
            at = end;
        }
        gap(&mut plan, at, i64::from(bytes));
        // Single bytes would fill the registers and save little: each is soon read again.
        if plan.len() > BYTES_APART && plan.iter().all(|(_, repr)| *repr == Repr::I8) {
            return None;
        }
        (plan.len() <= PARTS).then_some(plan)
    }
}

/// Covers bytes that nobody accesses by themselves.
fn gap(plan: &mut Vec<(i64, Repr)>, mut at: i64, end: i64) {
    while at < end {
        let fits = |r: &&Repr| at % i64::from(r.bytes()) == 0 && at + i64::from(r.bytes()) <= end;
        let repr = [Repr::I64, Repr::I32, Repr::I16].iter().find(fits).copied().unwrap_or(Repr::I8);
        plan.push((at, repr));
        at += i64::from(repr.bytes());
    }
}
