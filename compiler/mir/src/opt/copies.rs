//! What was copied is read where it came from.
//!
//! Along every way the copies are remembered whose two sides have not changed since; also in a loop that changes neither. What then
//! reads the copy reads the original: another copy, a load, a string. A copy that nobody reads any more is left out by others.
//!
//! ```text
//! copy 60 bytes frame+20 := line            copy 60 bytes frame+20 := line
//! v1 = call find(frame+20[60], v0)    =>    v1 = call find(line[60], v0)
//! ```

use super::alias::Alias;
use super::loops::Bodies;
use super::rewrite::{Constants, common, writes_memory};
use crate::dominators::Dominators;
use crate::ir::{BlockId, Func, Inst, Place};
use index_vec::IndexVec;

/// So many copies are remembered at once.
const KNOWN: usize = 16;

/// Two places with the same bytes.
#[derive(Debug, Clone, PartialEq)]
struct Equal {
    copy: Place,
    original: Place,
    bytes: i64,
}

impl Equal {
    /// Where the bytes of a place came from, if all of them lie in the copy.
    fn origin(&self, place: &Place, bytes: i64) -> Option<Place> {
        let at = place.offset - self.copy.offset;
        let inside =
            place.base == self.copy.base && place.index == self.copy.index && at >= 0 && at + bytes <= self.bytes;
        inside.then(|| Place { offset: self.original.offset + at, bit: place.bit, ..self.original.clone() })
    }
}

/// The pass.
pub fn run(func: &mut Func, alias: &Alias) {
    if !func.blocks.iter().flat_map(|b| &b.insts).any(|inst| matches!(inst, Inst::Copy { .. })) {
        return;
    }
    let constants = Constants::new(func);
    let tree = Dominators::new(func);
    let loops = Bodies::new(func, &tree);
    let mut ends: IndexVec<BlockId, Option<Vec<Equal>>> = func.blocks.iter().map(|_| None).collect();
    for &block in &tree.order {
        let ways = loops.known_ways(&tree, block, |pred| ends[pred].is_some());
        let mut known = common(&ways, &ends, |a, b| a == b);
        loops.retain(func, block, &mut known, |inst, k| !changes(func, alias, &constants, inst, k));
        let mut insts = std::mem::take(&mut func.blocks[block].insts);
        for inst in &mut insts {
            redirect(func, alias, &constants, inst, &known);
            if writes_memory(inst) {
                known.retain(|k| !changes(func, alias, &constants, inst, k));
            }
            if let Inst::Copy { dst, src, bytes } = inst
                && !alias.overlap(dst, i64::from(*bytes), src, i64::from(*bytes))
            {
                known.push(Equal { copy: dst.clone(), original: src.clone(), bytes: i64::from(*bytes) });
                if known.len() > KNOWN {
                    known.remove(0);
                }
            }
        }
        func.blocks[block].insts = insts;
        ends[block] = Some(known);
    }
}

/// Whether an instruction may write one of the two sides.
fn changes(func: &Func, alias: &Alias, constants: &Constants, inst: &Inst, k: &Equal) -> bool {
    alias.may_write(func, constants, inst, &k.copy, k.bytes)
        || alias.may_write(func, constants, inst, &k.original, k.bytes)
}

fn redirect(func: &Func, alias: &Alias, constants: &Constants, inst: &mut Inst, known: &[Equal]) {
    let origin = |place: &Place, bytes: i64| known.iter().rev().find_map(|k| k.origin(place, bytes));
    match inst {
        Inst::Load { dst, place, .. } => {
            if let Some(from) = origin(place, i64::from(func.values[*dst].bytes())) {
                *place = from;
            }
        }
        Inst::Copy { src, bytes, .. } => {
            if let Some(from) = origin(src, i64::from(*bytes)) {
                *src = from;
            }
        }
        Inst::CallText { func: body, texts, .. } => {
            let (built, read) = texts.split_at_mut(usize::from(body.builds));
            for (n, text) in read.iter_mut().enumerate() {
                let unit = i64::from(body.unit_bytes(built.len() + n));
                let Some(capacity) = constants.get(text.capacity).map(|n| n as i64) else { continue };
                // Its end is the capacity, whatever lies behind.
                let Some(from) = origin(&text.place, unit * capacity) else { continue };
                // What is built must overlap nothing that is read.
                let apart = built.first().is_none_or(|to| {
                    let room = constants.get(to.capacity).map_or(1 << 32, |n| n as i64 + 1);
                    !alias.overlap(&to.place, i64::from(body.unit_bytes(0)) * room, &from, unit * (capacity + 1))
                });
                if apart {
                    text.place = from;
                }
            }
        }
        _ => {}
    }
}
