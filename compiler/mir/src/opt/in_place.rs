//! What is built in the frame and then copied is built where the copy goes.
//!
//! The result of a function that was inlined is such: a string or structure in the frame, cleared or copied as a whole, changed,
//! and copied to its target at the end. If on every way between the whole write and the copy nobody looks at the target or
//! leaves with a fault, and nobody reads the frame's bytes behind the copy, then the target takes their place.
//!
//! ```text
//! zero 21 bytes frame+0                      zero 21 bytes Main.name
//! v1 = call left(frame+0[v0], line[v0], v2)  =>   v1 = call left(Main.name[v0], line[v0], v2)
//! copy 21 bytes Main.name := frame+0
//! ```

use super::alias::{Alias, for_each_access, span};
use super::rewrite::Constants;
use crate::dominators::Dominators;
use crate::ir::{Base, BlockId, Func, Inst, Place, Term};
use crate::visit;
use rustc_hash::FxHashSet;
use std::cell::Cell;

/// So many blocks are looked at on the way back from a copy, and as many behind it.
const BLOCKS: usize = 64;

/// And so many instructions in both directions together.
const INSTS: usize = 2000;

/// A copy of bytes of the frame to a fixed place.
struct Move {
    block: BlockId,
    inst: usize,
    from: Place,
    to: Place,
    bytes: i64,
}

/// The pass.
pub fn run(func: &mut Func, alias: &Alias) {
    let mut moves = Vec::new();
    for (block, body) in func.blocks.iter_enumerated() {
        for (inst, one) in body.insts.iter().enumerate() {
            let Inst::Copy { dst, src, bytes } = one else { continue };
            let fixed = dst.index.is_empty() && !matches!(dst.base, Base::Reference(_));
            let bytes = i64::from(*bytes);
            if src.base == Base::Frame
                && src.index.is_empty()
                && fixed
                && !alias.overlap(dst, bytes, src, bytes)
                && !alias.escapes(src, bytes)
            {
                moves.push(Move { block, inst, from: src.clone(), to: dst.clone(), bytes });
            }
        }
    }
    if moves.is_empty() {
        return;
    }
    let (tree, constants) = (Dominators::new(func), Constants::new(func));
    let mut done: FxHashSet<(BlockId, usize)> = FxHashSet::default();
    for one in moves {
        let left = Cell::new(INSTS);
        let look = Look { func, alias, constants: &constants, tree: &tree, done: &done, one: &one, left };
        let Some(accesses) = look.accesses().filter(|_| look.is_dead_behind()) else { continue };
        for (block, inst) in accesses {
            visit::places(&mut func.blocks[block].insts[inst], &mut |place| {
                let (start, end) = (one.from.offset, one.from.offset + one.bytes);
                if place.base == Base::Frame && place.index.is_empty() && (start..end).contains(&place.offset) {
                    *place = Place { offset: one.to.offset + place.offset - start, base: one.to.base, ..place.clone() };
                }
            });
        }
        done.insert((one.block, one.inst));
    }
    for (block, body) in func.blocks.iter_mut_enumerated() {
        let mut n = 0;
        body.insts.retain(|_| {
            n += 1;
            !done.contains(&(block, n - 1))
        });
    }
}

/// What an instruction is for the bytes in the frame.
enum Role {
    /// It has nothing to do with them.
    None,
    /// It writes all of them.
    Whole,
    /// It reads or writes some of them.
    Part,
    /// It looks at the target, may leave, or does what could not be done there.
    Obstacle,
}

struct Look<'a> {
    func: &'a Func,
    alias: &'a Alias<'a>,
    constants: &'a Constants,
    tree: &'a Dominators,
    /// Copies that are not done any more.
    done: &'a FxHashSet<(BlockId, usize)>,
    one: &'a Move,
    /// Instructions that may still be looked at.
    left: Cell<usize>,
}

impl Look<'_> {
    /// Counts one more instruction; `None` if these are too many.
    fn step(&self) -> Option<()> {
        self.left.set(self.left.get().checked_sub(1)?);
        Some(())
    }

    /// All accesses to the bytes between their whole writes and the copy; `None` if the target cannot take their place.
    fn accesses(&self) -> Option<Vec<(BlockId, usize)>> {
        let mut found = Vec::new();
        let mut seen = FxHashSet::default();
        let mut work = Vec::new();
        if !self.back(self.one.block, self.one.inst, &mut found)? {
            work.extend_from_slice(self.before(self.one.block)?);
        }
        while let Some(block) = work.pop() {
            if !seen.insert(block) {
                continue;
            }
            if block == self.one.block || seen.len() > BLOCKS {
                return None;
            }
            if !self.back(block, self.func.blocks[block].insts.len(), &mut found)? {
                work.extend_from_slice(self.before(block)?);
            }
        }
        // From there every way leads to the copy.
        let mut closed = true;
        for block in &seen {
            self.func.blocks[*block].term.for_each_target(|target| {
                closed &= target.block == self.one.block || seen.contains(&target.block);
            });
        }
        closed.then_some(found)
    }

    /// The blocks in front of one that is not the first.
    fn before(&self, block: BlockId) -> Option<&[BlockId]> {
        let preds = &self.tree.preds[block];
        (block.index() != 0 && !preds.is_empty()).then_some(preds)
    }

    /// Goes back in a block from an instruction on; whether the bytes were written as a whole.
    fn back(&self, block: BlockId, end: usize, found: &mut Vec<(BlockId, usize)>) -> Option<bool> {
        for n in (0..end).rev().filter(|n| !self.done.contains(&(block, *n))) {
            self.step()?;
            match self.role(&self.func.blocks[block].insts[n]) {
                Role::None => {}
                Role::Part => found.push((block, n)),
                Role::Whole => {
                    found.push((block, n));
                    return Some(true);
                }
                Role::Obstacle => return None,
            }
        }
        Some(false)
    }

    fn role(&self, inst: &Inst) -> Role {
        let Move { from, to, bytes, .. } = self.one;
        match inst {
            Inst::Const { .. } | Inst::Prim { .. } | Inst::CallRt { .. } => return Role::None,
            Inst::Check { .. } | Inst::Poll { .. } if to.base != Base::Frame => return Role::Obstacle,
            Inst::Call { .. } | Inst::AddressOf { place: Place { base: Base::Frame, .. }, .. } => {
                return Role::Obstacle;
            }
            Inst::Zero { dst, bytes: all } | Inst::Copy { dst, bytes: all, .. }
                if dst == from && i64::from(*all) == *bytes && !self.touches(inst, to, true) =>
            {
                let reads = matches!(inst, Inst::Copy { .. }) && self.reads(inst, from);
                return if reads || self.reads(inst, to) { Role::Obstacle } else { Role::Whole };
            }
            _ => {}
        }
        if self.touches(inst, to, true) || self.reads(inst, to) {
            return Role::Obstacle;
        }
        let mut role = Role::None;
        for_each_access(self.func, self.constants, inst, &mut |place, size, _| {
            if !self.alias.overlap(place, size, from, *bytes) {
                return;
            }
            let inside = place.base == Base::Frame
                && place.index.is_empty()
                && place.bit.is_none()
                && from.offset <= place.offset
                && place.offset + size <= from.offset + bytes;
            if !inside {
                role = Role::Obstacle;
            } else if !matches!(role, Role::Obstacle) {
                role = Role::Part;
            }
        });
        role
    }

    fn reads(&self, inst: &Inst, place: &Place) -> bool {
        self.touches(inst, place, false)
    }

    fn touches(&self, inst: &Inst, place: &Place, write: bool) -> bool {
        let (alias, bytes) = (self.alias, self.one.bytes);
        if write {
            alias.may_write(self.func, self.constants, inst, place, bytes)
        } else {
            alias.may_read(self.func, self.constants, inst, place, bytes)
        }
    }

    /// Whether nobody reads the bytes behind the copy before they are written as a whole.
    fn is_dead_behind(&self) -> bool {
        let start = &self.func.blocks[self.one.block];
        let mut seen = FxHashSet::default();
        let mut work = Vec::new();
        match self.ahead(self.one.block, self.one.inst + 1) {
            Some(true) => return true,
            Some(false) => start.term.for_each_target(|target| work.push(target.block)),
            None => return false,
        }
        while let Some(block) = work.pop() {
            if !seen.insert(block) {
                continue;
            }
            match self.ahead(block, 0).filter(|_| seen.len() <= BLOCKS) {
                Some(true) => {}
                Some(false) => self.func.blocks[block].term.for_each_target(|target| work.push(target.block)),
                None => return false,
            }
        }
        true
    }

    /// Goes on in a block: whether they are written as a whole; `None` if they may be read.
    fn ahead(&self, block: BlockId, first: usize) -> Option<bool> {
        let (from, block) = (&self.one.from, (block, &self.func.blocks[block]));
        let (start, end) = span(from, self.one.bytes);
        for (n, inst) in block.1.insts.iter().enumerate().skip(first) {
            if self.done.contains(&(block.0, n)) {
                continue;
            }
            self.step()?;
            if self.reads(inst, from) {
                return None;
            }
            if let Inst::Zero { dst, bytes } | Inst::Copy { dst, bytes, .. } = inst
                && dst.base == Base::Frame
                && dst.index.is_empty()
                && dst.offset <= start
                && end <= dst.offset + i64::from(*bytes)
            {
                return Some(true);
            }
        }
        let seen_by_callers = self.alias.handed_over().iter().any(|(first, last)| *first < end && start < *last);
        let leaves = matches!(block.1.term, Term::Return(_));
        if leaves && seen_by_callers { None } else { Some(false) }
    }
}
