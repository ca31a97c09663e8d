//! MIR to operations of the interpreter.
//!
//! Constants and widenings take no operation: constants lie in registers that are set at entry, and a zero-extended or
//! reinterpreted value is its operand's register. Jumps with arguments become moves that act as if all were done at once.

use super::op::{
    AddressSite, BlockSite, CallSite, CheckSite, Code, FIRST_FREE, FRAME, FuncCode, INSTANCE, Op, PrimSite, REGION,
    Reg, RtSite, SCRATCH, SwitchSite, TextSite,
};
use crate::ir::{Base, BlockId, Cond, Exit, Func, FuncId, Inst, Place, Program, Target, Term, ValueId};
use crate::verify::bottom_up;
use index_vec::IndexVec;
use plcc_stdlib::fault::Fault;
use plcc_stdlib::prim::{PrimOp, Repr};
use rustc_hash::FxHashMap;

/// What the deepest chain of calls needs.
pub struct Depth {
    /// Registers of all functions in the chain.
    pub registers: usize,
    /// Calls that are open at once.
    pub calls: usize,
}

/// Decodes all functions.
pub fn decode(program: &Program) -> (Code, Depth) {
    let files: IndexVec<FuncId, RegisterFile> = program.funcs.iter().map(RegisterFile::new).collect();
    let code: Code =
        program.funcs.iter().zip(&files).map(|(func, file)| Decoder::new(program, func, file, &files).run()).collect();
    let depth = depth(program, &code);
    (code, depth)
}

fn depth(program: &Program, code: &Code) -> Depth {
    let order = bottom_up(program).unwrap_or_else(|id| plcc_diag::bug!("`{}` calls itself", program.funcs[id].name));
    let mut need: IndexVec<FuncId, (usize, usize)> = IndexVec::from_vec(vec![(0, 0); code.len()]);
    for id in order {
        let (mut registers, mut calls) = (0, 0);
        for callee in program.funcs[id].callees() {
            registers = registers.max(need[callee].0);
            calls = calls.max(need[callee].1 + 1);
        }
        need[id] = (registers + code[id].registers as usize, calls);
    }
    let deepest = |pick: fn(&(usize, usize)) -> usize| program.tasks.iter().map(|t| pick(&need[*t])).max().unwrap_or(0);
    Depth { registers: deepest(|n| n.0), calls: deepest(|n| n.1) }
}

/// Which register each value has.
struct RegisterFile {
    of: IndexVec<ValueId, Reg>,
    constants: Vec<u64>,
    registers: u32,
    uses: IndexVec<ValueId, u32>,
}

impl RegisterFile {
    fn new(func: &Func) -> Self {
        #[derive(Clone, Copy)]
        enum Home {
            Own,
            Constant(u64),
            Same(ValueId),
        }
        let mut home: IndexVec<ValueId, Home> = IndexVec::from_vec(vec![Home::Own; func.values.len()]);
        let mut uses: IndexVec<ValueId, u32> = IndexVec::from_vec(vec![0; func.values.len()]);
        for block in &func.blocks {
            for inst in &block.insts {
                inst.for_each_use(|v| uses[v] += 1);
                match inst {
                    Inst::Const { dst, raw } => home[*dst] = Home::Constant(*raw),
                    Inst::Prim { dst, op: PrimOp::Zext(_) | PrimOp::FBits | PrimOp::BitsF, args, .. } => {
                        home[*dst] = Home::Same(args[0]);
                    }
                    _ => {}
                }
            }
            block.term.for_each_use(|v| uses[v] += 1);
        }
        let mut numbers = FxHashMap::default();
        let mut constants = Vec::new();
        for place in &home {
            if let Home::Constant(raw) = place {
                numbers.entry(*raw).or_insert_with(|| {
                    constants.push(*raw);
                    FIRST_FREE + constants.len() as u32 - 1
                });
            }
        }
        let mut registers = FIRST_FREE + constants.len() as u32;
        let mut of: IndexVec<ValueId, Reg> = IndexVec::from_vec(vec![REGION; func.values.len()]);
        for (value, place) in home.iter_enumerated() {
            match place {
                Home::Own => {
                    of[value] = registers;
                    registers += 1;
                }
                Home::Constant(raw) => of[value] = numbers[raw],
                Home::Same(_) => {}
            }
        }
        for (value, place) in home.iter_enumerated() {
            let mut root = place;
            let mut at = value;
            while let Home::Same(next) = root {
                at = *next;
                root = &home[at];
            }
            of[value] = of[at];
        }
        Self { of, constants, registers, uses }
    }
}

/// A target that is known once all blocks are placed.
#[derive(Clone, Copy)]
enum Patch {
    Jump(u32),
    Then(u32),
    Otherwise(u32),
    Case(u32, u32),
    Default(u32),
}

struct Decoder<'a> {
    program: &'a Program,
    func: &'a Func,
    file: &'a RegisterFile,
    files: &'a IndexVec<FuncId, RegisterFile>,
    out: FuncCode,
    /// Where each block starts.
    starts: IndexVec<BlockId, u32>,
    /// References to starts of blocks.
    patches: Vec<(Patch, BlockId)>,
    /// References to moves that come behind the blocks.
    edges: Vec<(Patch, &'a Target)>,
}

impl<'a> Decoder<'a> {
    fn new(
        program: &'a Program,
        func: &'a Func,
        file: &'a RegisterFile,
        files: &'a IndexVec<FuncId, RegisterFile>,
    ) -> Self {
        let out = FuncCode {
            registers: file.registers,
            constants: file.constants.clone(),
            has_instance: func.has_instance,
            frame_bytes: func.frame_bytes,
            ..FuncCode::default()
        };
        let starts = IndexVec::from_vec(vec![0; func.blocks.len()]);
        Self { program, func, file, files, out, starts, patches: Vec::new(), edges: Vec::new() }
    }

    fn run(mut self) -> FuncCode {
        for (id, block) in self.func.blocks.iter_enumerated() {
            self.starts[id] = self.here();
            let fused = self.fused_compare(&block.insts, &block.term);
            let plain = block.insts.len() - usize::from(fused.is_some());
            block.insts[..plain].iter().for_each(|inst| self.inst(inst));
            self.term(&block.term, fused);
        }
        for (patch, target) in std::mem::take(&mut self.edges) {
            let start = self.here();
            self.moves(target);
            self.jump(target.block);
            self.patch(patch, start);
        }
        for (patch, block) in std::mem::take(&mut self.patches) {
            self.patch(patch, self.starts[block]);
        }
        self.out
    }

    fn here(&self) -> u32 {
        self.out.ops.len() as u32
    }

    fn push(&mut self, op: Op) {
        self.out.ops.push(op);
    }

    fn reg(&self, value: ValueId) -> Reg {
        self.file.of[value]
    }

    fn regs(&self, values: &[ValueId]) -> Vec<Reg> {
        values.iter().map(|v| self.reg(*v)).collect()
    }

    /// Base register and offset of a place; `scratch` holds the base if it must be computed.
    fn place(&mut self, place: &Place, scratch: Reg) -> (Reg, i32) {
        let mut base = self.base(place);
        for term in &place.index {
            let value = self.reg(term.value);
            self.push(Op::Index(scratch, base, value, term.stride));
            base = scratch;
        }
        match i32::try_from(place.offset) {
            Ok(offset) => (base, offset),
            Err(_) => {
                self.push(Op::Offset(scratch, base, place.offset as u32, (place.offset >> 32) as u32));
                (scratch, 0)
            }
        }
    }

    fn inst(&mut self, inst: &Inst) {
        match inst {
            Inst::Const { .. } => {}
            Inst::Prim { dst, op, repr, args } => self.prim(*dst, *op, *repr, args),
            Inst::Load { dst, place, normalise } => {
                let dst_repr = self.func.values[*dst];
                let dst = self.reg(*dst);
                let (base, offset) = self.place(place, SCRATCH[0]);
                self.push(match (place.bit, dst_repr.bytes()) {
                    (Some(bit), _) => Op::LoadBit(dst, base, offset, u32::from(bit)),
                    (None, 1) => Op::Load8(dst, base, offset),
                    (None, 2) => Op::Load16(dst, base, offset),
                    (None, 4) => Op::Load32(dst, base, offset),
                    _ => Op::Load64(dst, base, offset),
                });
                if *normalise {
                    self.push(Op::Truth(dst, dst));
                }
            }
            Inst::Store { place, value } => {
                let bytes = self.func.values[*value].bytes();
                let src = self.reg(*value);
                let (base, offset) = self.place(place, SCRATCH[0]);
                self.push(match (place.bit, bytes) {
                    (Some(bit), _) => Op::StoreBit(src, base, offset, u32::from(bit)),
                    (None, 1) => Op::Store8(src, base, offset),
                    (None, 2) => Op::Store16(src, base, offset),
                    (None, 4) => Op::Store32(src, base, offset),
                    _ => Op::Store64(src, base, offset),
                });
            }
            Inst::Copy { dst, src, bytes } => {
                let dst = self.place(dst, SCRATCH[0]);
                let src = self.place(src, SCRATCH[1]);
                self.out.blocks.push(BlockSite { dst, src, bytes: *bytes });
                self.push(Op::Copy(self.out.blocks.len() as u32 - 1));
            }
            Inst::Zero { dst, bytes } => {
                let dst = self.place(dst, SCRATCH[0]);
                self.out.blocks.push(BlockSite { dst, src: (REGION, 0), bytes: *bytes });
                self.push(Op::Zero(self.out.blocks.len() as u32 - 1));
            }
            Inst::AddressOf { dst, place, .. } => {
                let (base, offset) = self.place(place, SCRATCH[0]);
                let dst = self.reg(*dst);
                self.push(Op::Address(dst, base, offset));
            }
            Inst::Call { dst, callee, instance, args, status, exit } => {
                let instance = instance.as_ref().map(|place| self.place(place, SCRATCH[0]));
                let params = &self.program.funcs[*callee].blocks[BlockId::from_usize(0)].params;
                let site = CallSite {
                    callee: *callee,
                    instance,
                    args: args.iter().zip(params).map(|(a, p)| (self.reg(*a), self.files[*callee].of[*p])).collect(),
                    dst: dst.map(|v| self.reg(v)),
                    status: status.map(|v| self.reg(v)),
                    fault_instance: exit.instance.as_ref().map(|place| self.address_site(place)),
                };
                self.out.calls.push(site);
                self.push(Op::Call(self.out.calls.len() as u32 - 1));
            }
            Inst::CallRt { dst, func, args } => {
                let site = RtSite { func, dst: self.reg(*dst), args: self.regs(args) };
                self.out.rt_calls.push(site);
                self.push(Op::CallRt(self.out.rt_calls.len() as u32 - 1));
            }
            Inst::CallText { dst, func, texts, args } => {
                let mut places = Vec::with_capacity(texts.len());
                for (text, scratch) in texts.iter().zip(SCRATCH) {
                    let (base, offset) = self.place(&text.place, scratch);
                    places.push((base, offset, self.reg(text.capacity)));
                }
                let site = TextSite { func, dst: self.reg(*dst), texts: places, args: self.regs(args) };
                self.out.text_calls.push(site);
                self.push(Op::CallText(self.out.text_calls.len() as u32 - 1));
            }
            Inst::Check { cond, fault, operands, exit } => {
                let (low, high) = match cond {
                    Cond::True(_) => (0, 0),
                    Cond::Within { low, high, .. } => (*low, *high),
                };
                let operands = self.regs(operands);
                let site = self.check(*fault, exit, low, high, operands);
                let op = match cond {
                    Cond::True(value) => Op::CheckTrue(self.reg(*value), site),
                    Cond::Within { value, .. } => Op::CheckWithin(self.reg(*value), site),
                };
                self.push(op);
            }
            Inst::Poll { exit } => {
                let site = self.check(Fault::Deadline, exit, 0, 0, Vec::new());
                self.push(Op::Poll(site));
            }
        }
    }

    fn check(&mut self, fault: Fault, exit: &Exit, low: i64, high: i64, operands: Vec<Reg>) -> u32 {
        let instance = exit.instance.as_ref().map(|place| self.address_site(place));
        let owed = exit.owed.iter();
        let owed = owed.map(|(place, value)| {
            (self.address_site(place), self.reg(*value), self.func.values[*value].bytes(), place.bit)
        });
        let owed = owed.collect();
        self.out.checks.push(CheckSite { fault, source: exit.source.raw(), low, high, operands, instance, owed });
        self.out.checks.len() as u32 - 1
    }

    fn address_site(&self, place: &Place) -> AddressSite {
        let terms = place.index.iter().map(|term| (self.reg(term.value), term.stride)).collect();
        AddressSite { base: self.base(place), offset: place.offset, terms }
    }

    fn base(&self, place: &Place) -> Reg {
        match place.base {
            Base::Region => REGION,
            Base::Instance => INSTANCE,
            Base::Frame => FRAME,
            Base::Reference(value) => self.reg(value),
        }
    }

    fn prim(&mut self, dst: ValueId, op: PrimOp, repr: Repr, args: &[ValueId]) {
        let dst = self.reg(dst);
        let regs = self.regs(args);
        match op {
            // The register of the result is that of the operand.
            PrimOp::Zext(_) | PrimOp::FBits | PrimOp::BitsF => {}
            PrimOp::Select => self.push(Op::Select(dst, regs[0], regs[1], regs[2])),
            _ => {
                let second = regs.get(1).copied().unwrap_or(REGION);
                if let Some(make) = Op::of_prim(op, width_independent(op, repr)) {
                    self.push(make(dst, regs[0], second));
                } else {
                    let mut args = [REGION; 3];
                    args[..regs.len()].copy_from_slice(&regs);
                    self.out.prims.push(PrimSite { op, repr, dst, args, count: regs.len() as u8 });
                    self.push(Op::Prim(self.out.prims.len() as u32 - 1));
                }
            }
        }
    }

    /// The last instruction, if it is a comparison that only the branch behind it reads.
    fn fused_compare(&self, insts: &'a [Inst], term: &Term) -> Option<FusedCompare> {
        let (Some(Inst::Prim { dst, op, repr, args }), Term::Branch { cond, .. }) = (insts.last(), term) else {
            return None;
        };
        if dst != cond || self.file.uses[*dst] != 1 {
            return None;
        }
        let make = Op::of_branch(*op, width_independent(*op, *repr))?;
        Some(FusedCompare { make, a: self.reg(args[0]), b: self.reg(args[1]) })
    }

    fn term(&mut self, term: &'a Term, fused: Option<FusedCompare>) {
        match term {
            Term::Jump(target) => {
                self.moves(target);
                self.jump(target.block);
            }
            Term::Branch { cond, then, otherwise } => {
                let at = self.here();
                let op = match fused {
                    Some(compare) => (compare.make)(compare.a, compare.b, 0, 0),
                    None => Op::Branch(self.reg(*cond), 0, 0),
                };
                self.push(op);
                self.edge(Patch::Then(at), then);
                self.edge(Patch::Otherwise(at), otherwise);
            }
            Term::Switch { value, cases, default } => {
                let mut sorted: Vec<&(u64, Target)> = cases.iter().collect();
                sorted.sort_by_key(|(label, _)| *label);
                let site = self.out.switches.len() as u32;
                for (n, (_, target)) in sorted.iter().enumerate() {
                    self.edge(Patch::Case(site, n as u32), target);
                }
                self.edge(Patch::Default(site), default);
                self.out.switches.push(SwitchSite {
                    labels: sorted.iter().map(|(label, _)| *label).collect(),
                    targets: vec![0; sorted.len()],
                    default: 0,
                });
                let value = self.reg(*value);
                self.push(Op::Switch(value, site));
            }
            Term::Return(None) => self.push(Op::Return),
            Term::Return(Some(value)) => {
                let value = self.reg(*value);
                self.push(Op::ReturnValue(value));
            }
        }
    }

    fn jump(&mut self, block: BlockId) {
        self.patches.push((Patch::Jump(self.here()), block));
        self.push(Op::Jump(0));
    }

    fn edge(&mut self, patch: Patch, target: &'a Target) {
        if target.args.is_empty() {
            self.patches.push((patch, target.block));
        } else {
            self.edges.push((patch, target));
        }
    }

    /// Gives the parameters of a block their values, as if all at once.
    fn moves(&mut self, target: &Target) {
        let params = &self.func.blocks[target.block].params;
        let pairs = params.iter().zip(&target.args).map(|(p, a)| (self.reg(*p), self.reg(*a)));
        for (dst, src) in sequential(pairs.collect(), SCRATCH[0]) {
            self.push(Op::Move(dst, src));
        }
    }

    fn patch(&mut self, patch: Patch, to: u32) {
        match patch {
            Patch::Case(site, n) => self.out.switches[site as usize].targets[n as usize] = to,
            Patch::Default(site) => self.out.switches[site as usize].default = to,
            Patch::Jump(at) => self.out.ops[at as usize] = Op::Jump(to),
            Patch::Then(at) => self.out.ops[at as usize].set_targets(Some(to), None),
            Patch::Otherwise(at) => self.out.ops[at as usize].set_targets(None, Some(to)),
        }
    }
}

/// A comparison and a branch in one operation.
struct FusedCompare {
    make: fn(Reg, Reg, u32, u32) -> Op,
    a: Reg,
    b: Reg,
}

/// I64 for operations that mean the same on zero-extended registers of any width.
fn width_independent(op: PrimOp, repr: Repr) -> Repr {
    use PrimOp::*;
    match op {
        And | Or | Xor | Eq | Ne | LtU | LeU | MinU | MaxU | DivU | RemU | ShrU | Wrap(_) => Repr::I64,
        _ => repr,
    }
}

/// Orders moves (to, from) that happen at once so that none overwrites what another still reads.
fn sequential(moves: Vec<(Reg, Reg)>, scratch: Reg) -> Vec<(Reg, Reg)> {
    let mut readers: FxHashMap<Reg, u32> = FxHashMap::default();
    let mut source: FxHashMap<Reg, Reg> = FxHashMap::default();
    for (dst, src) in moves.iter().filter(|(dst, src)| dst != src) {
        *readers.entry(*src).or_default() += 1;
        source.insert(*dst, *src);
    }
    let mut out = Vec::with_capacity(moves.len());
    let free = |reg: &Reg, readers: &FxHashMap<Reg, u32>| readers.get(reg).is_none_or(|n| *n == 0);
    let mut ready: Vec<Reg> = moves.iter().map(|m| m.0).filter(|d| source.contains_key(d)).collect();
    ready.retain(|d| free(d, &readers));
    // Whatever is not reached from a free register lies on a cycle, which one scratch register opens.
    for (start, _) in moves.iter().map(|m| (Some(m.0), ())).chain([(None, ())]) {
        while let Some(dst) = ready.pop() {
            let Some(src) = source.remove(&dst) else { continue };
            out.push((dst, src));
            if let Some(count) = readers.get_mut(&src) {
                *count -= 1;
                if *count == 0 && source.contains_key(&src) {
                    ready.push(src);
                }
            }
        }
        if let Some(dst) = start.filter(|d| source.contains_key(d)) {
            out.push((scratch, dst));
            // Who read `dst` reads the scratch register from now on; on a cycle that is exactly one.
            for from in source.values_mut().filter(|from| **from == dst) {
                *from = scratch;
            }
            readers.insert(dst, 0);
            readers.insert(scratch, 1);
            ready.push(dst);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parallel_moves() {
        let mut seed = 1u64;
        let mut random = move |below: u64| {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 33) % below
        };
        for _ in 0..3000 {
            let count = 1 + random(7) as u32;
            let mut targets: Vec<Reg> = (10..10 + count + 3).collect();
            let moves: Vec<(Reg, Reg)> = (0..count)
                .map(|_| (targets.swap_remove(random(targets.len() as u64) as usize), 10 + random(9) as u32))
                .collect();
            let mut want: Vec<u32> = (0..32).collect();
            for (dst, src) in &moves {
                want[*dst as usize] = *src;
            }
            let mut got: Vec<u32> = (0..32).collect();
            for (dst, src) in sequential(moves.clone(), 0) {
                got[dst as usize] = got[src as usize];
            }
            assert_eq!(want[10..], got[10..], "{moves:?}");
        }
    }
}
