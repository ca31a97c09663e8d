//! Puts the bodies of function blocks and functions where they are called, from the callees upwards.
//!
//! A callee's instance becomes the place it is called on, so that the variables of instances at fixed places are fixed
//! places too, which is what all later passes live on. Its frame becomes a part of the caller's, one for each callee, so that
//! what lies there has one type each. A call that catches faults stays a call. What no task reaches any more is left out of the program.
//!
//! ```text
//! call f1 `TON`() on t     =>     v9 = load i8 t.IN
//!                                 ...
//! ```

use super::rewrite::to;
use crate::ir::{Base, Block, BlockId, Exit, Func, FuncId, Inst, Place, Program, Term, ValueId};
use crate::verify::bottom_up;
use crate::visit;
use index_vec::IndexVec;
use rustc_hash::FxHashMap;

/// Callees up to this size are always put in, in instructions.
const SMALL: usize = 40;
/// Up to this size they are put in while the caller is not [`LARGE`].
const MEDIUM: usize = 250;
/// Callers stop growing by medium callees here.
const LARGE: usize = 6_000;
/// Nothing grows beyond this: the code generator's time per instruction rises with the size of a function.
const HUGE: usize = 20_000;
/// A callee that is called once.
const ONCE: usize = 10_000;
/// Frames beyond this stay where they are, so that the region grows little.
const FRAME_BYTES: u32 = 1 << 16;

/// Marks places in the frame of the next callee while the caller's own frame still grows.
const CALLEE_FRAME: i64 = 1 << 40;

/// The pass; `tidy` simplifies a function before its size is looked at.
pub fn run(program: &mut Program, tidy: fn(&mut Func)) {
    let Ok(order) = bottom_up(program) else { return };
    let reached_before = reached(program, &program.tasks);
    let mut sites: IndexVec<FuncId, usize> = IndexVec::from_vec(vec![0; program.funcs.len()]);
    for func in &program.funcs {
        func.callees().for_each(|callee| sites[callee] += 1);
    }
    for id in order {
        let mut func = std::mem::take(&mut program.funcs[id]);
        let inlined = Caller::new(&mut func, program, &sites).run();
        if inlined {
            tidy(&mut func);
        }
        program.funcs[id] = func;
    }
    prune(program, &reached_before);
    let frames = crate::lower::frame_bytes(program);
    program.region_bytes = program.frame_base + frames as u32;
}

/// Instructions of a function, a block's end counted as one.
fn size(func: &Func) -> usize {
    // A constant that goes behind a string becomes stores and a branch.
    let of = |inst: &Inst| match inst {
        Inst::CallText { texts, .. } if texts.iter().any(|text| text.constant.is_some()) => 12,
        _ => 1,
    };
    func.blocks.iter().map(|b| b.insts.iter().map(of).sum::<usize>() + 1).sum()
}

/// Leaves out what tasks reached before and do not reach any more. (A print shows also what they never reached.)
fn prune(program: &mut Program, reached_before: &IndexVec<FuncId, bool>) {
    let mut roots: Vec<FuncId> = program.tasks.clone();
    roots.extend(reached_before.iter_enumerated().filter(|(_, was)| !**was).map(|(id, _)| id));
    let keep = reached(program, &roots);
    let mut number: IndexVec<FuncId, Option<FuncId>> = IndexVec::with_capacity(keep.len());
    let mut count = 0;
    for kept in &keep {
        number.push(kept.then(|| FuncId::from_usize(count)));
        count += usize::from(*kept);
    }
    let renumber = |id: &mut FuncId| {
        *id = number[*id].unwrap_or_else(|| plcc_diag::bug!("a function that is called was left out"));
    };
    let old = std::mem::take(&mut program.funcs);
    program.funcs = old.into_iter().zip(&keep).filter(|(_, kept)| **kept).map(|(func, _)| func).collect();
    for inst in program.funcs.iter_mut().flat_map(|f| &mut f.blocks).flat_map(|b| &mut b.insts) {
        if let Inst::Call { callee, .. } = inst {
            renumber(callee);
        }
    }
    program.tasks.iter_mut().for_each(renumber);
}

/// The functions that some others reach by calls.
fn reached(program: &Program, roots: &[FuncId]) -> IndexVec<FuncId, bool> {
    let mut seen: IndexVec<FuncId, bool> = IndexVec::from_vec(vec![false; program.funcs.len()]);
    let mut work = roots.to_vec();
    while let Some(id) = work.pop() {
        if !std::mem::replace(&mut seen[id], true) {
            work.extend(program.funcs[id].callees());
        }
    }
    seen
}

/// A function whose calls are replaced.
struct Caller<'a> {
    func: &'a mut Func,
    program: &'a Program,
    sites: &'a IndexVec<FuncId, usize>,
    /// Its own frame, before anything was put in.
    own_frame: u32,
    frame_bytes: u32,
    /// Where the frames of callees lie whose bodies are put in.
    frames: FxHashMap<FuncId, u32>,
    size: usize,
    /// Names of memory that bodies brought along.
    names: Vec<(Base, u32, String)>,
}

impl<'a> Caller<'a> {
    fn new(func: &'a mut Func, program: &'a Program, sites: &'a IndexVec<FuncId, usize>) -> Self {
        let (own_frame, size) = (func.frame_bytes, size(func));
        Self {
            func,
            program,
            sites,
            own_frame,
            frame_bytes: own_frame,
            frames: FxHashMap::default(),
            size,
            names: Vec::new(),
        }
    }

    /// Whether anything was put in.
    fn run(mut self) -> bool {
        let chosen = self.choose();
        if chosen.iter().flatten().next().is_none() {
            return false;
        }
        self.split_callee_frames(&chosen);
        for (block, calls) in chosen.into_iter().enumerate() {
            // From the last to the first, so that the numbers of those before stay.
            for n in calls.into_iter().rev() {
                self.splice(BlockId::from_usize(block), n);
            }
        }
        let frame = i64::from(self.frame_bytes);
        self.func.frame_bytes = self.frame_bytes;
        for inst in self.func.blocks.iter_mut().flat_map(|b| &mut b.insts) {
            visit::places(inst, &mut |place| {
                if place.base == Base::Frame && place.offset >= CALLEE_FRAME / 2 {
                    place.offset += frame - CALLEE_FRAME;
                }
            });
        }
        self.func.names.append(&mut self.names);
        self.func.names.sort_by_key(|(base, at, _)| (*base, *at));
        self.func.names.dedup_by(|a, b| (a.0, a.1) == (b.0, b.1));
        true
    }

    /// The calls to replace: by block, the numbers of the instructions.
    fn choose(&mut self) -> Vec<Vec<usize>> {
        let tied = self.callee_frames_are_tied();
        let mut chosen = Vec::with_capacity(self.func.blocks.len());
        for block in &self.func.blocks {
            let mut calls = Vec::new();
            for (n, inst) in block.insts.iter().enumerate() {
                let Inst::Call { callee, status: None, .. } = inst else { continue };
                let target = &self.program.funcs[*callee];
                let callee_size = size(target);
                let fits = if self.sites[*callee] == 1 {
                    callee_size <= ONCE
                } else {
                    callee_size <= SMALL || (callee_size <= MEDIUM && self.size <= LARGE)
                };
                let frame = target.frame_bytes == 0 || (tied && target.frame_bytes <= FRAME_BYTES);
                if fits && frame && self.size + callee_size <= HUGE {
                    if !self.frames.contains_key(callee) {
                        self.frames.insert(*callee, self.frame_bytes);
                        self.frame_bytes += target.frame_bytes;
                    }
                    calls.push(n);
                    self.size += callee_size;
                }
            }
            chosen.push(calls);
        }
        chosen
    }

    /// Whether every place in the frame of a callee stands in the block of its call: arguments that are written before it,
    /// results that are read behind it. Lowering makes no others but where faults are caught.
    fn callee_frames_are_tied(&mut self) -> bool {
        let own_frame = i64::from(self.own_frame);
        let mut tied = true;
        for block in &mut self.func.blocks {
            let calls: Vec<usize> = positions_of_calls(block);
            for (n, inst) in block.insts.iter_mut().enumerate() {
                for_each_access(inst, &mut |place, write| {
                    if place.base == Base::Frame && place.offset >= own_frame {
                        tied &= call_of(&calls, n, write).is_some();
                    }
                });
            }
        }
        tied
    }

    /// Places in the frames of callees that stay calls are marked; those of the others lie where the body's frame will.
    fn split_callee_frames(&mut self, chosen: &[Vec<usize>]) {
        let own_frame = i64::from(self.own_frame);
        for (block, chosen) in self.func.blocks.iter_mut().zip(chosen) {
            let calls: Vec<usize> = positions_of_calls(block);
            let callees: FxHashMap<usize, FuncId> = calls
                .iter()
                .filter_map(|n| match &block.insts[*n] {
                    Inst::Call { callee, .. } => Some((*n, *callee)),
                    _ => None,
                })
                .collect();
            for (n, inst) in block.insts.iter_mut().enumerate() {
                for_each_access(inst, &mut |place, write| {
                    if place.base == Base::Frame && place.offset >= own_frame {
                        let call = call_of(&calls, n, write).filter(|call| chosen.contains(call));
                        let frame = call.and_then(|call| self.frames.get(&callees[&call]));
                        place.offset += frame.map_or(CALLEE_FRAME, |start| i64::from(*start)) - own_frame;
                    }
                });
            }
        }
    }

    /// Puts the body in place of the call that is instruction `n` of a block.
    fn splice(&mut self, block: BlockId, n: usize) {
        let behind = self.func.blocks[block].insts.split_off(n + 1);
        let Some(Inst::Call { dst, callee, instance, args, exit, .. }) = self.func.blocks[block].insts.pop() else {
            plcc_diag::bug!("no call at b{}:{n}", block.index());
        };
        let frame_start = self.frames.get(&callee).copied().unwrap_or(self.own_frame);
        let callee = &self.program.funcs[callee];
        let first_value = self.func.values.len();
        let first_block = self.func.blocks.len();
        self.func.values.extend(callee.values.iter().copied());
        let end = BlockId::from_usize(first_block + callee.blocks.len());
        let instance = instance.as_ref();
        let map = Map { first_value, first_block, end, frame_start, callee, instance, exit: &exit };
        for body in &callee.blocks {
            self.func.blocks.push(map.block(body));
        }
        let term = Term::Jump(crate::ir::Target { block: BlockId::from_usize(first_block), args });
        let term = std::mem::replace(&mut self.func.blocks[block].term, term);
        self.func.blocks.push(Block { params: dst.into_iter().collect(), insts: behind, term });
        self.name_places(callee, instance);
    }

    /// What the callee's memory is called here.
    fn name_places(&mut self, callee: &Func, instance: Option<&Place>) {
        let Some(place) = instance.filter(|p| p.index.is_empty() && !matches!(p.base, Base::Reference(_))) else {
            return;
        };
        let Ok(start) = u32::try_from(place.offset) else { return };
        let names = &self.func.names;
        let own = names.binary_search_by_key(&(place.base, start), |(base, at, _)| (*base, *at));
        // A task has no name for its programs; they have.
        let own = own.ok().map_or_else(|| callee.name.clone(), |n| names[n].2.clone());
        let inner = callee.names.iter().filter(|(base, ..)| *base == Base::Instance);
        let inner: Vec<_> = inner.map(|(_, at, name)| (place.base, start + at, format!("{own}.{name}"))).collect();
        self.names.extend(inner);
    }
}

/// The positions of the calls of a block.
fn positions_of_calls(block: &Block) -> Vec<usize> {
    let calls = block.insts.iter().enumerate().filter(|(_, inst)| matches!(inst, Inst::Call { .. }));
    calls.map(|(n, _)| n).collect()
}

/// The call to whose frame an access at position `n` belongs: what is written is for the next call, what is read is of the
/// last one.
fn call_of(calls: &[usize], n: usize, write: bool) -> Option<usize> {
    let behind = calls.partition_point(|call| *call < n);
    if write { calls.get(behind).copied() } else { behind.checked_sub(1).map(|k| calls[k]) }
}

/// Calls `f` with every place that an instruction accesses, and whether it is written. An address is taken for an
/// argument, and an instance in the callee's frame would be one.
fn for_each_access(inst: &mut Inst, f: &mut impl FnMut(&mut Place, bool)) {
    match inst {
        Inst::Load { place, .. } => f(place, false),
        Inst::Store { place, .. } | Inst::Zero { dst: place, .. } | Inst::AddressOf { place, .. } => f(place, true),
        Inst::Copy { dst, src, .. } => {
            f(dst, true);
            f(src, false);
        }
        Inst::Call { instance, .. } => instance.iter_mut().for_each(|place| f(place, true)),
        Inst::CallText { func, texts, .. } => {
            for (n, text) in texts.iter_mut().enumerate() {
                f(&mut text.place, n == 0 && func.builds);
            }
        }
        Inst::Const { .. } | Inst::Prim { .. } | Inst::CallRt { .. } | Inst::Check { .. } | Inst::Poll { .. } => {}
    }
}

/// From the callee's numbers and places to the caller's.
struct Map<'a> {
    first_value: usize,
    first_block: usize,
    /// Where returns go.
    end: BlockId,
    /// Where its frame lies now.
    frame_start: u32,
    callee: &'a Func,
    instance: Option<&'a Place>,
    /// Of the call.
    exit: &'a Exit,
}

impl Map<'_> {
    fn block(&self, body: &Block) -> Block {
        let mut block = body.clone();
        block.params.iter_mut().for_each(|v| self.value(v));
        for inst in &mut block.insts {
            visit::defs(inst, &mut |v| self.value(v));
            visit::uses(inst, &mut |v| self.value(v));
            visit::places(inst, &mut |place| self.place(place));
            if let Some(exit) = visit::exit(inst)
                && exit.instance.is_none()
            {
                exit.instance = match self.instance {
                    Some(place) if self.callee.has_instance => Some(Box::new(place.clone())),
                    _ => self.exit.instance.clone(),
                };
            }
        }
        visit::term_uses(&mut block.term, &mut |v| self.value(v));
        visit::targets(&mut block.term, &mut |target| {
            target.block = BlockId::from_usize(self.first_block + target.block.index());
        });
        if let Term::Return(value) = block.term {
            block.term = Term::Jump(crate::ir::Target { args: value.into_iter().collect(), ..to(self.end) });
        }
        block
    }

    fn value(&self, value: &mut ValueId) {
        *value = ValueId::from_usize(self.first_value + value.index());
    }

    fn place(&self, place: &mut Place) {
        match (place.base, self.instance) {
            (Base::Instance, Some(instance)) => {
                let inner = std::mem::replace(place, instance.clone());
                place.offset += inner.offset;
                place.index.extend(inner.index);
                place.bit = inner.bit;
            }
            (Base::Frame, _) => {
                let frame = i64::from(self.callee.frame_bytes);
                place.offset += if place.offset >= frame { CALLEE_FRAME - frame } else { i64::from(self.frame_start) };
            }
            _ => {}
        }
    }
}
