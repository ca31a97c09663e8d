//! Variables of functions, VAR_TEMPs and temporaries that lie in the frame become values.
//!
//! Of a frame nothing is seen when its function has ended, neither by a fault, but for the outputs that a caller reads. What has its address taken, is part of an
//! aggregate that is copied, or is handed to a callee stays in memory. Stores to a frame that nothing reads are left out.
//!
//! ```text
//! store i16 frame+0 := v0
//! v1 = load i16 frame+0       =>   v2 = add i16 v0, v0
//! v2 = add i16 v1, v0
//! ```

use super::alias::{Alias, for_each_access, span};
use super::rewrite::{Constants, Replace};
use super::ssa::{Scope, Var, rewrite};
use crate::dominators::Dominators;
use crate::ir::{Base, BlockId, Func, Inst, Place};
use crate::visit;
use plcc_stdlib::prim::Repr;
use std::collections::BTreeMap;

/// So many at once: what is kept per block grows with it.
const BATCH: usize = 64;

/// The pass.
pub fn run(func: &mut Func, alias: &Alias) {
    if func.frame_bytes == 0 {
        return;
    }
    let vars = candidates(func, alias);
    for batch in vars.chunks(BATCH) {
        let tree = Dominators::new(func);
        let entry = BlockId::from_raw(0);
        let scope = Scope { blocks: &tree.order, preds: &tree.preds, is_loop: !tree.preds[entry].is_empty() };
        if scope.is_loop {
            // Only programs that no lowering makes jump back to the entry.
            return;
        }
        let mut initial = Vec::new();
        let mut loads = Vec::new();
        for var in batch {
            let dst = func.values.push(var.repr);
            loads.push(Inst::Load { dst, place: var.place.clone(), normalise: false });
            initial.push(dst);
        }
        let mut replace = Replace::new(func);
        rewrite(func, &scope, batch, &initial, &mut replace);
        replace.apply(func);
        func.blocks[entry].insts.splice(0..0, loads);
    }
    unread_stores(func, alias);
}

/// Scalars of the own frame that are accessed as a whole only.
fn candidates(func: &Func, alias: &Alias) -> Vec<Var> {
    let constants = Constants::new(func);
    /// How the bytes from an offset on are used.
    struct Use {
        end: i64,
        repr: Option<Repr>,
    }
    let mut uses: BTreeMap<i64, Use> = BTreeMap::new();
    // Other accesses: ranges in which nothing becomes a value.
    let mut others: Vec<(i64, i64)> = alias.handed_over().to_vec();
    let mut note = |place: &Place, bytes: i64, scalar: Option<Repr>| {
        if place.base != Base::Frame {
            return;
        }
        let (start, end) = span(place, bytes);
        match scalar.filter(|_| place.index.is_empty() && place.bit.is_none()) {
            Some(repr) => {
                let one = uses.entry(start).or_insert(Use { end, repr: Some(repr) });
                if one.repr != Some(repr) {
                    one.repr = None;
                    one.end = one.end.max(end);
                }
            }
            None => others.push((start, end)),
        }
    };
    for inst in func.blocks.iter().flat_map(|b| &b.insts) {
        match inst {
            Inst::Load { dst, place, normalise: false } => {
                note(place, i64::from(func.values[*dst].bytes()), Some(func.values[*dst]));
            }
            Inst::Store { place, value } => {
                note(place, i64::from(func.values[*value].bytes()), Some(func.values[*value]));
            }
            // An address may be used for all that follows.
            Inst::AddressOf { place, bytes, .. } => note(place, i64::from(*bytes).max(1), None),
            Inst::Call { instance: Some(place), .. } => note(place, 1 << 32, None),
            _ => for_each_access(func, &constants, inst, &mut |place, bytes, _| note(place, bytes, None)),
        }
        if let Inst::Check { exit, .. } | Inst::Poll { exit } | Inst::Call { exit, .. } = inst {
            exit.owed.iter().for_each(|(place, v)| note(place, i64::from(func.values[*v].bytes()), None));
        }
    }
    others.sort_unstable();
    let mut reach = i64::MIN;
    // The greatest end among the ranges that start before each.
    let reaches: Vec<(i64, i64)> = others
        .iter()
        .map(|(start, end)| {
            reach = reach.max(*end);
            (*start, reach)
        })
        .collect();
    let list: Vec<(i64, Use)> = uses.into_iter().collect();
    let mut vars = Vec::new();
    let mut before = i64::MIN;
    for (n, (start, used)) in list.iter().enumerate() {
        let apart = before <= *start && list.get(n + 1).is_none_or(|(next, _)| used.end <= *next);
        before = before.max(used.end);
        let behind = reaches.partition_point(|(first, _)| *first < used.end);
        let free = behind == 0 || reaches[behind - 1].1 <= *start;
        if let (Some(repr), true) = (used.repr, apart && free && used.end <= i64::from(func.frame_bytes)) {
            let place = Place { base: Base::Frame, offset: *start, index: Vec::new(), bit: None };
            vars.push(Var { place, repr, owed: false });
        }
    }
    vars
}

/// Stores to places of the own frame that no instruction may read.
fn unread_stores(func: &mut Func, alias: &Alias) {
    let own = i64::from(func.frame_bytes);
    let constants = Constants::new(func);
    let mut read: Vec<(i64, i64)> = alias.handed_over().to_vec();
    for inst in func.blocks.iter().flat_map(|b| &b.insts) {
        let mut note = |place: &Place, bytes: i64| {
            if place.base == Base::Frame {
                read.push(span(place, bytes));
            }
        };
        for_each_access(func, &constants, inst, &mut |place, bytes, write| {
            if !write {
                note(place, bytes);
            }
        });
        match inst {
            Inst::AddressOf { place, .. } if place.base == Base::Frame => return,
            Inst::Call { instance: Some(place), .. } => note(place, 1 << 32),
            _ => {}
        }
    }
    read.sort_unstable();
    let mut reach = i64::MIN;
    for range in &mut read {
        reach = reach.max(range.1);
        range.1 = reach;
    }
    let unread = |place: &Place, bytes: i64| {
        let (start, end) = span(place, bytes);
        let behind = read.partition_point(|(first, _)| *first < end);
        place.base == Base::Frame && end <= own && (behind == 0 || read[behind - 1].1 <= start)
    };
    let values = &func.values;
    for block in &mut func.blocks {
        block.insts.retain_mut(|inst| {
            let mut dead = false;
            match inst {
                Inst::Store { place, value } => dead = unread(place, i64::from(values[*value].bytes())),
                Inst::Zero { dst, bytes } | Inst::Copy { dst, bytes, .. } => dead = unread(dst, i64::from(*bytes)),
                _ => {}
            }
            if let Some(exit) = visit::exit(inst) {
                exit.owed.retain(|(place, _)| place.base != Base::Frame);
            }
            !dead
        });
    }
}
