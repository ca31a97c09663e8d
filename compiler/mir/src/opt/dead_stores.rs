//! A store that another one replaces before anyone can see it is left out; so are copies and clearings.
//!
//! From the end to the start the places are remembered that are written on every way before they are read. A check or poll
//! in between sees them if it fails: it then owes the store that was left out, if both stand in one block, so that nothing
//! else can have happened between them. Frames are seen by nobody who leaves.
//!
//! ```text
//! store i8 Q := v0              check v1 else division by zero, owes Q := v0
//! check v1 else ...       =>    store i8 Q := v2
//! store i8 Q := v2
//! ```

use super::alias::Alias;
use super::rewrite::Constants;
use crate::dominators::Dominators;
use crate::ir::{Base, Block, BlockId, Exit, Func, Inst, Place, ValueId};
use index_vec::IndexVec;

/// So many places are remembered at once.
const REMEMBERED: usize = 40;

/// A store is kept rather than owed by more exits than this.
const EXITS: usize = 4;

/// A place that is written later, on every way.
#[derive(Debug, Clone)]
struct Written {
    place: Place,
    bytes: i64,
    /// The exits on the way there, numbers of instructions of the block.
    exits: Vec<usize>,
}

/// The pass.
pub fn run(func: &mut Func, alias: &Alias) {
    let constants = Constants::new(func);
    let tree = Dominators::new(func);
    let mut starts: IndexVec<BlockId, Option<Vec<Written>>> = func.blocks.iter().map(|_| None).collect();
    for &block in tree.order.iter().rev() {
        let mut written = end(&func.blocks[block], &starts);
        let mut dead = vec![false; func.blocks[block].insts.len()];
        let mut owes: Vec<(usize, Place, ValueId)> = Vec::new();
        for n in (0..dead.len()).rev() {
            let inst = &func.blocks[block].insts[n];
            match inst {
                Inst::Store { place, value } => {
                    let bytes = i64::from(func.values[*value].bytes());
                    let found = written.iter().position(|w| covers(w, place, bytes));
                    let exits = found.map(|k| std::mem::take(&mut written[k].exits)).unwrap_or_default();
                    change(&mut written, |w| alias.may_write(func, &constants, inst, &w.place, w.bytes));
                    if found.is_some() {
                        owes.extend(exits.into_iter().map(|exit| (exit, place.clone(), *value)));
                        dead[n] = true;
                        continue;
                    }
                    if place.bit.is_none() {
                        written.push(Written { place: place.clone(), bytes, exits: Vec::new() });
                    }
                }
                Inst::Zero { dst, bytes } | Inst::Copy { dst, bytes, .. } => {
                    let bytes = i64::from(*bytes);
                    // An exit would have to owe all of it.
                    if cover(&written, dst, bytes) {
                        dead[n] = true;
                        continue;
                    }
                    change(&mut written, |w| alias.may_write(func, &constants, inst, &w.place, w.bytes));
                    written.push(Written { place: dst.clone(), bytes, exits: Vec::new() });
                    // A copy reads before it writes.
                    written.retain(|w| !alias.may_read(func, &constants, inst, &w.place, w.bytes));
                }
                Inst::Check { exit, .. } | Inst::Poll { exit } => {
                    pass_exit(func, alias, exit, n, &mut written);
                }
                Inst::Call { .. } => {
                    // It may fault, and who sees the memory then sees all of it but the frame.
                    written.retain(|w| {
                        w.place.base == Base::Frame && !alias.may_read(func, &constants, inst, &w.place, w.bytes)
                    });
                }
                // The most frequent case without a detour.
                Inst::Load { dst, place, .. } => {
                    let bytes = i64::from(func.values[*dst].bytes());
                    written.retain(|w| !alias.overlap(&w.place, w.bytes, place, bytes));
                }
                Inst::CallText { .. } => {
                    change(&mut written, |w| alias.may_write(func, &constants, inst, &w.place, w.bytes));
                    written.retain(|w| !alias.may_read(func, &constants, inst, &w.place, w.bytes));
                }
                Inst::Const { .. } | Inst::Prim { .. } | Inst::AddressOf { .. } | Inst::CallRt { .. } => {}
            }
            // A place whose parts are made here is another one above.
            let (first, second) = inst.results();
            if (first.is_some() || second.is_some()) && written.iter().any(|w| !is_fixed(&w.place)) {
                written.retain(|w| {
                    let mut made_here = false;
                    w.place.for_each_use(|v| made_here |= first == Some(v) || second == Some(v));
                    !made_here
                });
            }
            if written.len() > REMEMBERED {
                written.remove(0);
            }
        }
        // The same for parameters of the block.
        let params = &func.blocks[block].params;
        written.retain(|w| {
            let mut made_here = false;
            w.place.for_each_use(|v| made_here |= params.contains(&v));
            !made_here && (w.exits.is_empty() || w.place.base == Base::Frame)
        });
        written.iter_mut().for_each(|w| w.exits.clear());
        starts[block] = Some(written);
        for (n, place, value) in owes {
            if let Some(exit) = crate::visit::exit(&mut func.blocks[block].insts[n]) {
                exit.owed.push((place, value));
            }
        }
        let mut n = 0;
        func.blocks[block].insts.retain(|_| {
            n += 1;
            !dead[n - 1]
        });
    }
}

/// Another write in between: an exit behind it would have to know both.
fn change(written: &mut Vec<Written>, touches: impl Fn(&Written) -> bool) {
    written.retain(|w| w.exits.is_empty() || w.place.base == Base::Frame || !touches(w));
}

fn is_fixed(place: &Place) -> bool {
    place.index.is_empty() && !matches!(place.base, Base::Reference(_))
}

/// Whether the later write covers all that is stored here. An exit in between must owe exactly what that writes, else the
/// part that is left would be owed by nobody.
fn covers(written: &Written, place: &Place, bytes: i64) -> bool {
    let w = &written.place;
    if w.base != place.base || w.index != place.index {
        return false;
    }
    let (whole, exact) = (w.offset..w.offset + written.bytes, w.offset == place.offset && written.bytes == bytes);
    if written.exits.is_empty() || w.base == Base::Frame {
        whole.contains(&place.offset) && place.offset + bytes <= whole.end
    } else {
        exact && place.bit.is_none()
    }
}

/// Whether later writes together cover a block.
fn cover(written: &[Written], place: &Place, bytes: i64) -> bool {
    let whole = |w: &&Written| {
        let same = w.place.base == place.base && w.place.index == place.index && w.place.bit.is_none();
        same && (w.exits.is_empty() || w.place.base == Base::Frame)
    };
    let mut at = place.offset;
    while at < place.offset + bytes {
        // The one that reaches furthest of those that go on from here.
        let next =
            written.iter().filter(whole).filter(|w| w.place.offset <= at).map(|w| w.place.offset + w.bytes).max();
        match next.filter(|end| *end > at) {
            Some(end) => at = end,
            None => return false,
        }
    }
    true
}

/// What is written on every way behind a block.
fn end(block: &Block, starts: &IndexVec<BlockId, Option<Vec<Written>>>) -> Vec<Written> {
    let mut targets = Vec::new();
    block.term.for_each_target(|target| targets.push(target.block));
    let Some((first, rest)) = targets.split_first() else { return Vec::new() };
    // Ways backwards are not known yet.
    let Some(mut written) = starts[*first].clone() else { return Vec::new() };
    for target in rest {
        let Some(other) = &starts[*target] else { return Vec::new() };
        written.retain(|w| other.iter().any(|o| o.place == w.place && o.bytes >= w.bytes));
    }
    written
}

/// A fault shows all memory but the frame: the exit would owe what is left out before it. What it owes already comes
/// later in the order of the stores and may replace that.
fn pass_exit(func: &Func, alias: &Alias, exit: &Exit, at: usize, written: &mut Vec<Written>) {
    written.retain_mut(|w| {
        if w.place.base == Base::Frame {
            return true;
        }
        let paid = exit.owed.iter().any(|(place, value)| {
            let bytes = i64::from(func.values[*value].bytes());
            alias.overlap(place, bytes, &w.place, w.bytes)
        });
        w.exits.push(at);
        !paid && w.exits.len() <= EXITS
    });
}
