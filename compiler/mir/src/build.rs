//! Builds a function block by block: what lowering, tests and passes use instead of pushing instructions by hand.
//!
//! In: calls in the order of execution. Out: a [`Func`] without unreachable blocks. The builder keeps representations
//! straight (an instruction on operands of the wrong kind is a bug of plcc and stops at once); what a source means is not
//! its business. Through [`Emit`] the rows of the operator and function tables append to the current block.

use crate::ir::{
    Args, Base, Block, BlockId, Cond, Exit, Func, FuncId, Inst, Place, SourceId, Target, Term, TextPlace, ValueId,
};
use crate::visit;
use index_vec::IndexVec;
use plcc_diag::bug;
use plcc_stdlib::emit::{Emit, Val};
use plcc_stdlib::fault::Fault;
use plcc_stdlib::prim::{PrimOp, Repr};
use plcc_stdlib::region;
use plcc_stdlib::rt::RtFn;
use plcc_stdlib::rt::strings::TextFn;

/// Added to the offset of a place in a callee's frame until the own frame's size is known.
const CALLEE_FRAME: i64 = 1 << 40;

/// A block that is being filled.
#[derive(Debug, Default)]
struct OpenBlock {
    params: Vec<ValueId>,
    insts: Vec<Inst>,
    term: Option<Term>,
}

/// A function that is being built.
#[derive(Debug)]
pub struct Builder {
    name: String,
    params: Vec<ValueId>,
    result: Option<Repr>,
    has_instance: bool,
    values: IndexVec<ValueId, Repr>,
    blocks: IndexVec<BlockId, OpenBlock>,
    current: Option<BlockId>,
    source: SourceId,
    source_used: bool,
    checks_division: bool,
    /// Where failed checks go instead of faulting.
    catch: Option<BlockId>,
}

impl Builder {
    /// A function with its entry block, which is the current one.
    pub fn new(name: impl Into<String>, params: &[Repr], result: Option<Repr>, has_instance: bool) -> Self {
        let mut builder = Self {
            name: name.into(),
            params: Vec::new(),
            result,
            has_instance,
            values: IndexVec::new(),
            blocks: IndexVec::new(),
            current: None,
            source: SourceId::from_raw(0),
            source_used: false,
            checks_division: true,
            catch: None,
        };
        let entry = builder.block();
        builder.params = params.iter().map(|r| builder.block_param(entry, *r)).collect();
        builder.switch_to(entry);
        builder
    }

    /// Values of the parameters.
    pub fn params(&self) -> &[ValueId] {
        &self.params
    }

    /// The representation of a value.
    pub fn repr(&self, value: ValueId) -> Repr {
        self.values[value]
    }

    /// Whether rows check divisors and shift counts (`--checks`); they do unless told otherwise.
    pub fn set_checks_division(&mut self, on: bool) {
        self.checks_division = on;
    }

    /// Where checks that fail go from now on, a block without parameters; `None`: they fault. Gives what was set before.
    pub fn set_catch(&mut self, catch: Option<BlockId>) -> Option<BlockId> {
        std::mem::replace(&mut self.catch, catch)
    }

    /// Where the checks, calls and polls that follow come from.
    pub fn set_source(&mut self, source: SourceId) {
        self.source = source;
        self.source_used = false;
    }

    /// Whether anything came from there yet.
    pub fn source_used(&self) -> bool {
        self.source_used
    }

    fn exit(&mut self) -> Exit {
        self.source_used = true;
        Exit::at(self.source)
    }

    // ---- blocks ----

    /// A new empty block.
    pub fn block(&mut self) -> BlockId {
        self.blocks.push(OpenBlock::default())
    }

    /// One more parameter of a block.
    pub fn block_param(&mut self, block: BlockId, repr: Repr) -> ValueId {
        let value = self.values.push(repr);
        self.blocks[block].params.push(value);
        value
    }

    /// What follows goes into this block.
    pub fn switch_to(&mut self, block: BlockId) {
        self.current = Some(block);
    }

    /// Whether the current block has no end yet. What is appended without one is unreachable and will be dropped.
    pub fn is_open(&self) -> bool {
        self.current.is_some()
    }

    fn current(&mut self) -> &mut OpenBlock {
        let block = match self.current {
            Some(block) => block,
            None => {
                let block = self.block();
                self.switch_to(block);
                block
            }
        };
        &mut self.blocks[block]
    }

    fn push(&mut self, inst: Inst) {
        self.current().insts.push(inst);
    }

    fn end(&mut self, term: Term) {
        let block = self.current();
        if block.term.is_some() {
            bug!("a block of {} ends twice", self.name);
        }
        block.term = Some(term);
        self.current = None;
    }

    fn target(&self, block: BlockId, args: &[ValueId]) -> Target {
        Target { block, args: args.to_vec() }
    }

    /// Ends the block: goes on elsewhere.
    pub fn jump(&mut self, block: BlockId, args: &[ValueId]) {
        let target = self.target(block, args);
        self.end(Term::Jump(target));
    }

    /// Ends the block: to `then` if the truth value is 1, else to `otherwise`; both without parameters.
    pub fn branch(&mut self, cond: ValueId, then: BlockId, otherwise: BlockId) {
        self.expect(cond, Repr::I8);
        let (then, otherwise) = (self.target(then, &[]), self.target(otherwise, &[]));
        self.end(Term::Branch { cond, then, otherwise });
    }

    /// Ends the block: by register value; all targets without parameters.
    pub fn switch(&mut self, value: ValueId, cases: &[(u64, BlockId)], default: BlockId) {
        let cases = cases.iter().map(|(raw, block)| (*raw, self.target(*block, &[]))).collect();
        let default = self.target(default, &[]);
        self.end(Term::Switch { value, cases, default });
    }

    /// Ends the block: leaves the function.
    pub fn ret(&mut self, value: Option<ValueId>) {
        if value.map(|v| self.values[v]) != self.result {
            bug!("{} returns another representation than it declares", self.name);
        }
        self.end(Term::Return(value));
    }

    // ---- values ----

    fn expect(&self, value: ValueId, repr: Repr) {
        if self.values[value] != repr {
            bug!("{}: v{} is {:?}, needed is {repr:?}", self.name, value.raw(), self.values[value]);
        }
    }

    /// A constant: the low bits of `raw`.
    pub fn number(&mut self, repr: Repr, raw: u64) -> ValueId {
        let dst = self.values.push(repr);
        self.push(Inst::Const { dst, raw: raw & repr.mask() });
        dst
    }

    /// A machine operation on operands of `repr` (for `Select`: of the two choices).
    pub fn op(&mut self, op: PrimOp, repr: Repr, operands: &[ValueId]) -> ValueId {
        if !op.accepts(repr) || operands.len() != op.arity() {
            bug!("{}: {op:?} on {} {repr:?}", self.name, operands.len());
        }
        for (n, operand) in operands.iter().enumerate() {
            self.expect(*operand, op.operand(repr, n));
        }
        let args = match *operands {
            [a] => Args::One([a]),
            [a, b] => Args::Two([a, b]),
            [a, b, c] => Args::Three([a, b, c]),
            _ => bug!("{op:?} has {} operands", operands.len()),
        };
        let dst = self.values.push(op.result(repr));
        self.push(Inst::Prim { dst, op, repr, args });
        dst
    }

    /// NOT of a truth value.
    pub fn not(&mut self, truth: ValueId) -> ValueId {
        let one = self.number(Repr::I8, 1);
        self.op(PrimOp::Xor, Repr::I8, &[truth, one])
    }

    /// Extends or cuts an integer to another width; the same value if it has it already.
    pub fn resize(&mut self, value: ValueId, signed: bool, to: Repr) -> ValueId {
        let from = self.values[value];
        if from == to {
            value
        } else if from.bytes() > to.bytes() {
            self.op(PrimOp::Wrap(to), from, &[value])
        } else {
            self.op(if signed { PrimOp::Sext(to) } else { PrimOp::Zext(to) }, from, &[value])
        }
    }

    // ---- memory ----

    /// A place in the frame of the function that is called next, from the first byte of that frame.
    pub fn callee_frame(offset: u32) -> Place {
        Place { base: Base::Frame, offset: CALLEE_FRAME + i64::from(offset), index: Vec::new(), bit: None }
    }

    /// Reads a scalar; `normalise`: see [`Inst::Load`].
    pub fn load(&mut self, repr: Repr, place: Place, normalise: bool) -> ValueId {
        let dst = self.values.push(repr);
        self.push(Inst::Load { dst, place, normalise });
        dst
    }

    /// Writes a scalar.
    pub fn store(&mut self, place: Place, value: ValueId) {
        self.push(Inst::Store { place, value });
    }

    /// Copies bytes; nothing if there are none.
    pub fn copy(&mut self, dst: Place, src: Place, bytes: u32) {
        if bytes > 0 && dst != src {
            self.push(Inst::Copy { dst, src, bytes });
        }
    }

    /// Clears bytes; nothing if there are none.
    pub fn zero(&mut self, dst: Place, bytes: u32) {
        if bytes > 0 {
            self.push(Inst::Zero { dst, bytes });
        }
    }

    /// The region offset of a place, I32; a reference to it reaches so many bytes (see [`Inst::AddressOf`]).
    pub fn address_of(&mut self, place: Place, bytes: u32) -> ValueId {
        let dst = self.values.push(Repr::I32);
        self.push(Inst::AddressOf { dst, place, bytes });
        dst
    }

    // ---- calls and checks ----

    /// Calls a function; gives its scalar result.
    pub fn call(
        &mut self,
        callee: FuncId,
        instance: Option<Place>,
        args: &[ValueId],
        result: Option<Repr>,
    ) -> Option<ValueId> {
        let dst = result.map(|repr| self.values.push(repr));
        let exit = self.exit();
        self.push(Inst::Call { dst, callee, instance, args: args.to_vec(), status: None, exit });
        dst
    }

    /// Calls a function and catches its faults; gives its scalar result and the fault number (I32, 0 if none).
    pub fn call_catching(
        &mut self,
        callee: FuncId,
        instance: Option<Place>,
        args: &[ValueId],
        result: Option<Repr>,
    ) -> (Option<ValueId>, ValueId) {
        let dst = result.map(|repr| self.values.push(repr));
        let status = self.values.push(Repr::I32);
        let exit = self.exit();
        self.push(Inst::Call { dst, callee, instance, args: args.to_vec(), status: Some(status), exit });
        (dst, status)
    }

    /// Calls a body that works on strings; gives its result, an I64.
    pub fn call_text(&mut self, func: &'static TextFn, texts: &[TextPlace], args: &[ValueId]) -> ValueId {
        texts.iter().for_each(|text| self.expect(text.capacity, Repr::I32));
        args.iter().for_each(|arg| self.expect(*arg, Repr::I64));
        let dst = self.values.push(Repr::I64);
        self.push(Inst::CallText { dst, func, texts: texts.to_vec(), args: args.to_vec() });
        dst
    }

    /// Faults unless a truth value is 1.
    pub fn check_true(&mut self, ok: ValueId, fault: Fault, operands: &[ValueId]) {
        self.expect(ok, Repr::I8);
        self.check(Cond::True(ok), fault, operands);
    }

    /// Faults unless `low <= value <= high` for an I64; value and limits become the fault's operands.
    pub fn check_within(&mut self, value: ValueId, low: i64, high: i64, fault: Fault) {
        self.expect(value, Repr::I64);
        self.check(Cond::Within { value, low, high }, fault, &[]);
    }

    fn check(&mut self, cond: Cond, fault: Fault, operands: &[ValueId]) {
        for operand in operands {
            self.expect(*operand, Repr::I64);
        }
        let Some(catch) = self.catch else {
            let exit = self.exit();
            return self.push(Inst::Check { cond, fault, operands: operands.to_vec(), exit });
        };
        let ok = match cond {
            Cond::True(ok) => ok,
            Cond::Within { value, low, high } => {
                let (low, high) = (self.number(Repr::I64, low as u64), self.number(Repr::I64, high as u64));
                let above = self.op(PrimOp::LeS, Repr::I64, &[low, value]);
                let below = self.op(PrimOp::LeS, Repr::I64, &[value, high]);
                self.op(PrimOp::And, Repr::I8, &[above, below])
            }
        };
        let next = self.block();
        self.branch(ok, next, catch);
        self.switch_to(next);
    }

    /// Looks at the watchdog.
    pub fn poll(&mut self) {
        let exit = self.exit();
        self.push(Inst::Poll { exit });
    }

    // ---- the end ----

    /// The function. `frame_bytes` is the size of its own variables and temporaries; it is rounded up to 16.
    pub fn finish(mut self, frame_bytes: u32) -> Func {
        let frame_bytes = frame_bytes.next_multiple_of(16);
        let order = self.reachable();
        let mut new_block: IndexVec<BlockId, Option<BlockId>> = self.blocks.iter().map(|_| None).collect();
        for (n, old) in order.iter().enumerate() {
            new_block[*old] = Some(BlockId::from_usize(n));
        }
        let mut rename = Rename { old: &self.values, new: IndexVec::new(), map: vec![None; self.values.len()] };
        let mut blocks: IndexVec<BlockId, Block> = IndexVec::with_capacity(order.len());
        // Definitions first: with loops a use may stand in a block before that of its definition.
        for old in &order {
            let mut open = std::mem::take(&mut self.blocks[*old]);
            open.params.iter_mut().for_each(|v| rename.define(v));
            open.insts.iter_mut().for_each(|inst| visit::defs(inst, &mut |v| rename.define(v)));
            let Some(term) = open.term else { bug!("a block of {} has no end", self.name) };
            blocks.push(Block { params: open.params, insts: open.insts, term });
        }
        for block in &mut blocks {
            for inst in &mut block.insts {
                visit::uses(inst, &mut |v| rename.used(v, &self.name));
                visit::places(inst, &mut |place| {
                    if place.base == Base::Frame && place.offset >= CALLEE_FRAME / 2 {
                        place.offset += i64::from(frame_bytes) - CALLEE_FRAME;
                    }
                });
            }
            visit::term_uses(&mut block.term, &mut |v| rename.used(v, &self.name));
            visit::targets(&mut block.term, &mut |target| {
                target.block = new_block[target.block].unwrap_or_else(|| bug!("a reachable block was dropped"));
            });
        }
        Func {
            params: self.params.iter().map(|v| self.values[*v]).collect(),
            name: self.name,
            result: self.result,
            has_instance: self.has_instance,
            frame_bytes,
            values: rename.new,
            blocks,
            names: Vec::new(),
        }
    }

    /// Blocks that the entry reaches, in order of creation (which follows the source).
    fn reachable(&mut self) -> Vec<BlockId> {
        let mut seen = vec![false; self.blocks.len()];
        let mut work = vec![BlockId::from_raw(0)];
        seen[0] = true;
        while let Some(block) = work.pop() {
            let Some(term) = &mut self.blocks[block].term else { continue };
            visit::targets(term, &mut |target| {
                if !std::mem::replace(&mut seen[target.block.index()], true) {
                    work.push(target.block);
                }
            });
        }
        (0..self.blocks.len()).filter(|n| seen[*n]).map(BlockId::from_usize).collect()
    }
}

/// Numbers the values of the blocks that stay without gaps.
struct Rename<'a> {
    old: &'a IndexVec<ValueId, Repr>,
    new: IndexVec<ValueId, Repr>,
    map: Vec<Option<ValueId>>,
}

impl Rename<'_> {
    fn define(&mut self, value: &mut ValueId) {
        let new = self.new.push(self.old[*value]);
        self.map[value.index()] = Some(new);
        *value = new;
    }

    fn used(&self, value: &mut ValueId, func: &str) {
        *value = self.map[value.index()].unwrap_or_else(|| bug!("{func} uses a value that nothing defines"));
    }
}

impl Emit for Builder {
    fn constant(&mut self, repr: Repr, raw: u64) -> Val {
        Val(self.number(repr, raw).raw())
    }

    fn prim(&mut self, op: PrimOp, repr: Repr, args: &[Val]) -> Val {
        let args: Vec<ValueId> = args.iter().map(|v| ValueId::from_raw(v.0)).collect();
        Val(self.op(op, repr, &args).raw())
    }

    /// With `--checks` without division neither divisors nor shift counts are looked at: both operations are total.
    fn check(&mut self, ok: Val, fault: Fault, operands: &[Val]) {
        if !self.checks_division && matches!(fault, Fault::DivisionByZero | Fault::NegativeShift) {
            return;
        }
        let operands: Vec<ValueId> = operands.iter().map(|v| ValueId::from_raw(v.0)).collect();
        self.check_true(ValueId::from_raw(ok.0), fault, &operands);
    }

    fn call(&mut self, f: &'static RtFn, args: &[Val]) -> Val {
        let args: Vec<ValueId> = args.iter().map(|v| ValueId::from_raw(v.0)).collect();
        let dst = self.values.push(f.result);
        self.push(Inst::CallRt { dst, func: f, args });
        Val(dst.raw())
    }

    fn clock(&mut self) -> Option<Val> {
        Some(Val(self.load(Repr::I64, Place::new(Base::Region, region::CLOCK_NS), false).raw()))
    }

    fn checks_division(&self) -> bool {
        self.checks_division
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drops_unreachable_blocks_and_renumbers() {
        let mut b = Builder::new("f", &[Repr::I32], Some(Repr::I32), false);
        let x = b.params()[0];
        let dead = b.block();
        let live = b.block();
        b.jump(live, &[]);
        b.switch_to(dead);
        let zero = b.number(Repr::I32, 0);
        b.ret(Some(zero));
        b.switch_to(live);
        let y = b.op(PrimOp::Add, Repr::I32, &[x, x]);
        b.ret(Some(y));
        let after_return = b.number(Repr::I8, 1);
        assert_eq!(after_return.raw(), 3);
        let func = b.finish(0);
        assert_eq!(func.blocks.len(), 2);
        assert_eq!(func.values.raw, [Repr::I32, Repr::I32]);
        assert!(matches!(func.blocks[1].term, Term::Return(Some(v)) if v.raw() == 1));
    }

    #[test]
    fn places_in_the_callee_frame_lie_behind_the_own_one() {
        let mut b = Builder::new("f", &[], None, false);
        let one = b.number(Repr::I16, 1);
        b.store(Place::new(Base::Frame, 4), one);
        b.store(Builder::callee_frame(8), one);
        b.ret(None);
        let func = b.finish(20);
        assert_eq!(func.frame_bytes, 32);
        let offsets: Vec<i64> = func.blocks[0]
            .insts
            .iter()
            .filter_map(|i| if let Inst::Store { place, .. } = i { Some(place.offset) } else { None })
            .collect();
        assert_eq!(offsets, [4, 40]);
    }
}
