//! Variables that a loop reads and writes are values inside it and memory again behind it.
//!
//! A scalar whose place is the same in every pass, which nothing else in the loop touches, is read once before the loop
//! and written once on every way out. Checks and polls inside owe it, so that a fault finds the memory of the statement
//! order. Inner loops come first; what they leave in the loop around them is promoted there.
//!
//! ```text
//! b1: jump b2                          b1: v9 = load i32 sum; jump b2(v9)
//! b2: v1 = load i32 sum                b2(v1): v2 = add i32 v1, v0
//!     v2 = add i32 v1, v0         =>       if v3 then b2(v2) else b3
//!     store i32 sum := v2              b3: store i32 sum := v2
//!     if v3 then b2 else b3
//! ```

use super::alias::{Alias, for_each_access};
use super::loops::{self, Loop};
use super::proven::Proven;
use super::rewrite::{Constants, Replace};
use super::ssa::{Scope, Var, rewrite};
use crate::dominators::Dominators;
use crate::ir::{Func, Inst, Place, Term};
use plcc_stdlib::prim::Repr;
use rustc_hash::FxHashMap;

/// So many integers, and so many reals, become values of one loop.
const PROMOTED: usize = 9;

/// A loop of more instructions is left alone.
const LARGE: usize = 2_000;

/// How a place is used in a loop.
struct Used {
    repr: Repr,
    /// Whole loads and stores of one representation only.
    plain: bool,
    loads: usize,
    stores: usize,
    /// Order of appearance, so that the choice does not depend on hashes.
    order: usize,
}

/// The pass.
pub fn run(func: &mut Func, alias: &Alias) {
    let loops = loops::find(func);
    let tree = Dominators::new(func);
    let proven = Proven::new(func);
    let constants = Constants::new(func);
    let mut replace = Replace::new(func);
    for l in &loops {
        replace.blocks(func, &l.blocks);
        let safe = |place: &Place| proven.is_safe(place, l.preheader, &tree);
        let vars = choose(func, alias, &constants, l, &safe);
        if vars.is_empty() {
            continue;
        }
        let mut initial = Vec::with_capacity(vars.len());
        for var in &vars {
            let dst = func.values.push(var.repr);
            func.blocks[l.preheader].insts.push(Inst::Load { dst, place: var.place.clone(), normalise: false });
            initial.push(dst);
        }
        let scope = Scope { blocks: &l.blocks, preds: &tree.preds, is_loop: true };
        let (params, ends) = rewrite(func, &scope, &vars, &initial, &mut replace);
        if let Term::Jump(target) = &mut func.blocks[l.preheader].term {
            target.args.extend(params.iter().map(|n| initial[*n]));
        }
        for exit in &l.exits {
            let Some(from) = tree.preds[*exit].first() else { continue };
            let now = &ends[from];
            let stores: Vec<Inst> = vars
                .iter()
                .zip(now)
                .filter(|(var, _)| var.owed)
                .filter_map(|(var, value)| value.map(|value| Inst::Store { place: var.place.clone(), value }))
                .collect();
            func.blocks[*exit].insts.splice(0..0, stores);
        }
    }
    replace.apply(func);
}

/// The places of a loop that become values.
fn choose(func: &Func, alias: &Alias, constants: &Constants, l: &Loop, safe: &impl Fn(&Place) -> bool) -> Vec<Var> {
    let insts = || l.blocks.iter().flat_map(|block| &func.blocks[*block].insts);
    if insts().count() > LARGE {
        return Vec::new();
    }
    let mut used: FxHashMap<&Place, Used> = FxHashMap::default();
    let mut calls = false;
    for inst in insts() {
        calls |= matches!(inst, Inst::Call { .. });
        let (place, repr, store, plain) = match inst {
            Inst::Load { dst, place, normalise } => (place, func.values[*dst], false, !normalise),
            Inst::Store { place, value } => (place, func.values[*value], true, true),
            _ => continue,
        };
        if place.bit.is_some() || !safe(place) {
            continue;
        }
        let order = used.len();
        let one = used.entry(place).or_insert(Used { repr, plain: true, loads: 0, stores: 0, order });
        one.plain &= plain && one.repr == repr;
        *(if store { &mut one.stores } else { &mut one.loads }) += 1;
    }
    // A place that is only stored gains too; one that is only loaded needs no store behind. A call may fault, and then all
    // memory must be there.
    used.retain(|_, one| one.plain && (one.stores == 0 || !calls));
    let mut list: Vec<(&Place, Used)> = used.into_iter().collect();
    list.sort_by_key(|(_, one)| (std::cmp::Reverse(one.loads + one.stores), one.order));
    let mut vars = Vec::new();
    let mut count = [0, 0];
    for (place, one) in list {
        let kind = usize::from(!one.repr.is_int());
        if count[kind] >= PROMOTED || !alone(func, alias, constants, l, place, &one) {
            continue;
        }
        count[kind] += 1;
        vars.push(Var { place: place.clone(), repr: one.repr, owed: one.stores > 0 });
    }
    vars
}

/// Whether nothing else in the loop touches the place: reads or writes what is stored, writes what is loaded.
fn alone(func: &Func, alias: &Alias, constants: &Constants, l: &Loop, place: &Place, used: &Used) -> bool {
    let bytes = i64::from(used.repr.bytes());
    let stored = used.stores > 0;
    for inst in l.blocks.iter().flat_map(|block| &func.blocks[*block].insts) {
        match inst {
            Inst::Load { place: other, .. } | Inst::Store { place: other, .. } if other == place => {}
            Inst::Call { .. } => {
                if alias.may_write(func, constants, inst, place, bytes)
                    || stored && alias.may_read(func, constants, inst, place, bytes)
                {
                    return false;
                }
            }
            Inst::Check { exit, .. } | Inst::Poll { exit } => {
                // What it owes already, for an inner loop or a store that was left out, comes later than what this one owes.
                let owes_part = exit.owed.iter().any(|(other, value)| {
                    other != place && alias.overlap(place, bytes, other, i64::from(func.values[*value].bytes()))
                });
                if owes_part {
                    return false;
                }
            }
            _ => {
                let mut touched = false;
                for_each_access(func, constants, inst, &mut |other, other_bytes, write| {
                    touched |= (write || stored) && alias.overlap(place, bytes, other, other_bytes);
                });
                if touched {
                    return false;
                }
            }
        }
    }
    true
}
