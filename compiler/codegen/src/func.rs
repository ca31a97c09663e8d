//! One function of the program to CLIF: blocks one to one, checks as branches to cold blocks.

mod calls;
mod exits;
mod extend;
mod lanes;

pub use calls::{rt_signature, text_signature};

use extend::{Extended, Extends, extensions};

use crate::packs::Packs;
use crate::place::memory;
use crate::prim::{self, carrier, clif_type};
use crate::shape::{Shape, signature};
use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{
    self, AbiParam, BlockArg, ExtFuncData, ExternalName, FuncRef, InstBuilder, Signature, SourceLoc, UserExternalName,
    UserFuncName, Value, types,
};
use cranelift_codegen::isa::{CallConv, TargetFrontendConfig};
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext, Switch};
use index_vec::IndexVec;
use plcc_mir::dominators::Dominators;
use plcc_mir::ir::{
    Base, Block, BlockId, Cond, Exit, Func, FuncId, Inst, Place, Program, Target, Term, TextPlace, ValueId,
};
use plcc_stdlib::fault::Fault;
use plcc_stdlib::prim::{PrimOp, Repr};
use plcc_stdlib::region::{DEADLINE_FLAG, FAULT_CODE, FAULT_INSTANCE, FAULT_OPERANDS, FAULT_SOURCE};
use plcc_stdlib::rt::RtFn;
use plcc_stdlib::rt::strings::TextFn;
use rustc_hash::FxHashMap;

/// Up to so many labels a chain of comparisons beats a jump table.
const CHAIN_LABELS: usize = 4;

/// So many faults share the code that writes the record: a block with thousands of predecessors costs the register
/// allocator quadratic time.
const FAULTS_PER_TAIL: usize = 32;

/// What all functions of a program share while they are translated.
pub struct Env<'a> {
    /// The program.
    pub program: &'a Program,
    /// Calling convention and pointer width.
    pub config: TargetFrontendConfig,
    /// Hidden parameters and results.
    pub shapes: IndexVec<FuncId, Shape>,
    /// The number of each function in the module.
    pub ids: IndexVec<FuncId, cranelift_module::FuncId>,
    /// Whether every machine of this kind has registers of 16 bytes.
    pub vectors: bool,
    /// Number and signature of each body of the standard library that is called, by symbol.
    pub rt: FxHashMap<&'static str, (cranelift_module::FuncId, Signature)>,
}

impl Env<'_> {
    /// The signature of a function of the program.
    pub fn signature(&self, id: FuncId) -> Signature {
        signature(&self.program.funcs[id], self.shapes[id], self.config.default_call_conv)
    }
}

/// Translates a function.
pub fn translate(env: &Env, id: FuncId, context: &mut FunctionBuilderContext) -> ir::Function {
    let name = UserFuncName::user(0, env.ids[id].as_u32());
    let mut out = ir::Function::with_name_signature(name, env.signature(id));
    let func = &env.program.funcs[id];
    let tree = Dominators::new(func);
    let b = FunctionBuilder::new(&mut out, context);
    let packs = if env.vectors { Packs::find(func, &tree) } else { Packs::default() };
    let mut translator = Translator::new(env, func, env.shapes[id], packs, b);
    translator.region_bytes = env.program.part_of_func(id).bytes;
    translator.entry(!tree.preds[BlockId::from_usize(0)].is_empty(), &tree.order);
    for block in &tree.order {
        translator.block(*block);
    }
    translator.finish();
    out
}

/// A call or data reference to another function of the module.
pub fn import(func: &mut ir::Function, id: cranelift_module::FuncId, signature: Signature, colocated: bool) -> FuncRef {
    let signature = func.import_signature(signature);
    let name = func.declare_imported_user_function(UserExternalName { namespace: 0, index: id.as_u32() });
    func.import_function(ExtFuncData { name: ExternalName::user(name), signature, colocated, patchable: false })
}

/// Blocks at the end of the function, where ways meet that leave it.
#[derive(Default)]
struct Tails {
    blocks: Vec<ir::Block>,
    /// Ways into the last one.
    ways: usize,
}

/// The walk over one function.
pub struct Translator<'a, 'f> {
    pub(crate) env: &'a Env<'a>,
    pub(crate) func: &'a Func,
    pub(crate) b: FunctionBuilder<'f>,
    pub(crate) region: Value,
    pub(crate) instance: Option<Value>,
    pub(crate) frame: Option<Value>,
    shape: Shape,
    /// Bytes of the part of the memory that the function works on.
    region_bytes: u32,
    values: IndexVec<ValueId, Option<Value>>,
    /// Register values of constants.
    pub(crate) constants: IndexVec<ValueId, Option<u64>>,
    /// Of integer constants: the block in which their value was made last.
    made_in: IndexVec<ValueId, Option<ir::Block>>,
    /// See [`extend`].
    extensions: IndexVec<ValueId, Extends>,
    /// What is done for several values at once.
    packs: Packs,
    /// Registers full of values, by pack.
    vectors: FxHashMap<usize, Value>,
    /// Registers full of one value.
    fillings: FxHashMap<ValueId, Value>,
    /// Of values of 8 and 16 bits that were loaded, or made of such: the same in 64 bits.
    extended: FxHashMap<ValueId, Extended>,
    blocks: IndexVec<BlockId, Option<ir::Block>>,
    callees: FxHashMap<FuncId, FuncRef>,
    rt_callees: FxHashMap<&'static str, FuncRef>,
    /// Write the fault record and leave; parameters: number, source, three operands.
    fault: Tails,
    /// The same for code that was inlined: the sixth parameter is the instance that the fault names.
    inlined_fault: Tails,
    /// Leave with the status of a callee, the parameter.
    leave: Tails,
}

impl<'a, 'f> Translator<'a, 'f> {
    fn new(env: &'a Env<'a>, func: &'a Func, shape: Shape, packs: Packs, mut b: FunctionBuilder<'f>) -> Self {
        let start = b.create_block();
        b.append_block_params_for_function_params(start);
        b.switch_to_block(start);
        let mut hidden = b.block_params(start).iter().copied();
        let mut next = |there: bool| if there { hidden.next() } else { None };
        let Some(region) = next(true) else { plcc_diag::bug!("a signature without the region") };
        let (instance, frame) = (next(shape.instance), next(shape.frame));
        Self {
            env,
            func,
            region,
            instance,
            frame,
            shape,
            region_bytes: env.program.region_bytes,
            values: IndexVec::from_vec(vec![None; func.values.len()]),
            constants: IndexVec::from_vec(vec![None; func.values.len()]),
            made_in: IndexVec::from_vec(vec![None; func.values.len()]),
            extensions: extensions(func),
            extended: FxHashMap::default(),
            packs,
            vectors: FxHashMap::default(),
            fillings: FxHashMap::default(),
            blocks: IndexVec::from_vec(vec![None; func.blocks.len()]),
            callees: FxHashMap::default(),
            rt_callees: FxHashMap::default(),
            fault: Tails::default(),
            inlined_fault: Tails::default(),
            leave: Tails::default(),
            b,
        }
    }

    /// Makes the blocks. The entry block of the function is ours, so a loop back to block 0 needs a block of its own.
    fn entry(&mut self, entry_is_target: bool, order: &[BlockId]) {
        let Some(start) = self.b.current_block() else { return };
        let args: Vec<Value> = {
            let all = self.b.block_params(start);
            all[all.len() - self.func.params.len()..].to_vec()
        };
        for id in order {
            if id.index() == 0 && !entry_is_target {
                self.blocks[*id] = Some(start);
                for (param, value) in self.func.blocks[*id].params.iter().zip(&args) {
                    self.values[*param] = Some(*value);
                }
                continue;
            }
            let block = self.b.create_block();
            self.blocks[*id] = Some(block);
            for param in &self.func.blocks[*id].params {
                match self.packs.lane(*param) {
                    None => {
                        let value = self.b.append_block_param(block, carrier(self.func.values[*param]));
                        self.values[*param] = Some(value);
                    }
                    Some((number, 0)) => {
                        let value = self.b.append_block_param(block, lanes::vector_type(self.func.values[*param]));
                        self.vectors.insert(number, value);
                    }
                    Some(_) => {}
                }
            }
        }
        if entry_is_target {
            let params = self.func.params.clone();
            let args = args.into_iter().zip(params).map(|(value, repr)| match repr {
                Repr::I16 => self.b.ins().uextend(types::I32, value).into(),
                _ => BlockArg::from(value),
            });
            let args: Vec<BlockArg> = args.collect();
            let first = self.target_block(BlockId::from_usize(0));
            self.b.ins().jump(first, &args);
        }
    }

    fn finish(mut self) {
        self.b.set_srcloc(SourceLoc::default());
        let faults = std::mem::take(&mut self.fault.blocks);
        for block in faults.into_iter().chain(std::mem::take(&mut self.inlined_fault.blocks)) {
            self.fault_body(block);
        }
        for block in std::mem::take(&mut self.leave.blocks) {
            self.leave_body(block);
        }
        self.b.seal_all_blocks();
        self.b.finalize(self.env.config);
    }

    fn defined(&mut self, id: ValueId) -> Value {
        // Integers are made anew in each block: held over many blocks they would lie in memory, for want of registers.
        if let (Some(raw), true) = (self.constants[id], self.func.values[id].is_int()) {
            let here = self.b.current_block();
            if self.made_in[id] != here {
                self.values[id] = Some(prim::constant(&mut self.b, self.func.values[id], raw));
                self.made_in[id] = here;
            }
        }
        let value = self.values[id].or_else(|| self.out_of_lanes(id));
        value.unwrap_or_else(|| plcc_diag::bug!("v{} of `{}` has no value", id.index(), self.func.name))
    }

    /// A value in the type of its representation.
    pub(crate) fn value(&mut self, id: ValueId) -> Value {
        let value = self.defined(id);
        let ty = clif_type(self.func.values[id]);
        if self.b.func.dfg.value_type(value) == ty { value } else { self.b.ins().ireduce(ty, value) }
    }

    /// A value in the type in which it is computed and handed on, see [`carrier`].
    fn carried(&mut self, id: ValueId) -> Value {
        let value = self.defined(id);
        match (self.func.values[id], self.constants[id]) {
            (Repr::I16, Some(raw)) => self.b.ins().iconst(types::I32, i64::from(raw as u16 as i16 as i32 as u32)),
            (Repr::I16, None) if self.b.func.dfg.value_type(value) == types::I16 => {
                self.b.ins().uextend(types::I32, value)
            }
            _ => value,
        }
    }

    /// A value as it is stored: a real constant by its bits, which need no register of a real.
    fn stored(&mut self, id: ValueId) -> Value {
        let bits = match (self.func.values[id], self.constants[id]) {
            (Repr::F32, Some(raw)) => (types::I32, raw),
            (Repr::F64, Some(raw)) => (types::I64, raw),
            _ => return self.value(id),
        };
        self.b.ins().iconst(bits.0, bits.1 as i64)
    }

    fn target_block(&self, id: BlockId) -> ir::Block {
        self.blocks[id].unwrap_or_else(|| plcc_diag::bug!("b{} of `{}` is not reachable", id.index(), self.func.name))
    }

    fn values(&mut self, ids: &[ValueId]) -> Vec<Value> {
        ids.iter().map(|v| self.value(*v)).collect()
    }

    fn args(&mut self, target: &Target) -> Vec<BlockArg> {
        let mut args = Vec::with_capacity(target.args.len());
        for (arg, param) in target.args.iter().zip(&self.func.blocks[target.block].params) {
            match self.packs.lane(*param) {
                None => args.push(self.carried(*arg).into()),
                Some((number, 0)) => args.push(self.given(number, target).into()),
                Some(_) => {}
            }
        }
        args
    }

    fn block(&mut self, id: BlockId) {
        let block: &'a Block = &self.func.blocks[id];
        let here = self.target_block(id);
        if self.b.current_block() != Some(here) {
            self.b.switch_to_block(here);
        }
        for param in &block.params {
            self.fill_if_wanted(*param);
        }
        let mut n = 0;
        while n < block.insts.len() {
            if self.as_pack(id, n) {
                n += 1;
                continue;
            }
            match self.constant_run(&block.insts[n..]) {
                Some(count) => n += count,
                None => {
                    self.inst(&block.insts[n]);
                    n += 1;
                }
            }
        }
        self.b.set_srcloc(SourceLoc::default());
        self.term(&block.term);
    }

    pub(crate) fn inst(&mut self, inst: &'a Inst) {
        self.alone(inst);
        if let (Some(value), _) = inst.results() {
            self.fill_if_wanted(value);
        }
    }

    fn alone(&mut self, inst: &'a Inst) {
        let loc = match inst {
            Inst::Call { exit, .. } | Inst::Check { exit, .. } | Inst::Poll { exit } => {
                SourceLoc::new(exit.source.raw())
            }
            _ => SourceLoc::default(),
        };
        self.b.set_srcloc(loc);
        match inst {
            Inst::Const { dst, raw } => {
                self.constants[*dst] = Some(*raw);
                if !self.func.values[*dst].is_int() {
                    let value = prim::constant(&mut self.b, self.func.values[*dst], *raw);
                    self.values[*dst] = Some(value);
                }
            }
            Inst::Prim { dst, op, repr, args } => {
                let wide =
                    if self.extensions[*dst] == Extends::Zero { self.wide_truth(*op, *repr, args) } else { None };
                let value = match wide {
                    Some(wide) => self.narrow(*dst, Extended::Zero(wide)),
                    None => self.prim(*op, *repr, args),
                };
                self.values[*dst] = Some(value);
            }
            Inst::Load { dst, place, normalise } if self.is_loaded_wide(*dst, place, *normalise) => {
                let signed = self.extensions[*dst] == Extends::Signed;
                let wide = self.load_extended(self.func.values[*dst], place, signed);
                let value = self.narrow(*dst, if signed { Extended::Signed(wide) } else { Extended::Zero(wide) });
                self.values[*dst] = Some(value);
            }
            Inst::Load { dst, place, normalise } => {
                let value = self.load(self.func.values[*dst], place, *normalise);
                self.values[*dst] = Some(value);
            }
            Inst::Store { place, value } => {
                let value = self.stored(*value);
                self.store(place, value);
            }
            Inst::Copy { dst, src, bytes } => self.copy(dst, src, *bytes),
            Inst::Zero { dst, bytes } => self.zero(dst, *bytes),
            Inst::AddressOf { dst, place, .. } => {
                let pointer = self.pointer(place);
                let offset = self.b.ins().isub(pointer, self.region);
                let value = self.b.ins().ireduce(types::I32, offset);
                self.values[*dst] = Some(value);
            }
            Inst::Call { dst, callee, instance, args, status, exit } => {
                self.call(*dst, *callee, instance.as_ref(), args, *status, exit);
            }
            Inst::CallRt { dst, func, args } => {
                let args = self.values(args);
                self.call_rt(*dst, func.symbol, &args);
            }
            Inst::CallText { dst, func, texts, args } => self.call_text(*dst, func, texts, args),
            Inst::Check { cond, fault, operands, exit } => self.check(*cond, *fault, operands, exit),
            Inst::Poll { exit } => {
                // Keeps the load where it is, whatever the code generator's level of optimisation.
                self.b.ins().sequence_point();
                let flag = self.b.ins().load(types::I32, memory(), self.region, DEADLINE_FLAG as i32);
                let (failed, next) = (self.cold_block(), self.b.create_block());
                self.b.ins().brif(flag, failed, &[], next, &[]);
                self.leave_with_fault(failed, Fault::Deadline, exit, &[]);
                self.b.switch_to_block(next);
            }
        }
    }

    fn prim(&mut self, op: PrimOp, repr: Repr, args: &[ValueId]) -> Value {
        let known = |v: ValueId| self.constants[v];
        match (op, repr) {
            // The lower half of the result needs the lower halves of the operands only.
            (PrimOp::Add | PrimOp::Sub | PrimOp::Mul | PrimOp::And | PrimOp::Or | PrimOp::Xor, Repr::I16)
            | (PrimOp::Neg | PrimOp::Not, Repr::I16) => {
                let args: Vec<Value> = args.iter().map(|v| self.carried(*v)).collect();
                prim::emit(&mut self.b, op, Repr::I32, &args)
            }
            (PrimOp::Shl, Repr::I16) if known(args[1]).is_some_and(|count| count < 16) => {
                let (value, count) = (self.carried(args[0]), self.value(args[1]));
                prim::emit(&mut self.b, op, Repr::I32, &[value, count])
            }
            (PrimOp::Select, Repr::I8 | Repr::I16 | Repr::I32 | Repr::I64) => {
                let args = [self.value(args[0]), self.carried(args[1]), self.carried(args[2])];
                prim::emit(&mut self.b, op, repr, &args)
            }
            (PrimOp::Sext(to) | PrimOp::Zext(to), Repr::I8 | Repr::I16) => match self.extended(args[0], op) {
                Some(wide) if to == Repr::I64 => wide,
                Some(wide) => self.b.ins().ireduce(carrier(to), wide),
                None if to == Repr::I16 => {
                    let value = self.value(args[0]);
                    let wide = if let PrimOp::Sext(_) = op { PrimOp::Sext(Repr::I32) } else { PrimOp::Zext(Repr::I32) };
                    prim::emit(&mut self.b, wide, repr, &[value])
                }
                None => {
                    let value = self.value(args[0]);
                    prim::emit(&mut self.b, op, repr, &[value])
                }
            },
            (PrimOp::Wrap(Repr::I16), Repr::I32) => self.value(args[0]),
            (PrimOp::Wrap(Repr::I16), Repr::I64) => {
                let value = self.value(args[0]);
                prim::emit(&mut self.b, PrimOp::Wrap(Repr::I32), repr, &[value])
            }
            _ => {
                let args = self.values(args);
                prim::emit(&mut self.b, op, repr, &args)
            }
        }
    }

    fn cold_block(&mut self) -> ir::Block {
        let block = self.b.create_block();
        self.b.set_cold_block(block);
        block
    }

    fn term(&mut self, term: &Term) {
        match term {
            Term::Jump(target) => {
                let (block, args) = (self.target_block(target.block), self.args(target));
                self.b.ins().jump(block, &args);
            }
            Term::Branch { cond, then, otherwise } => {
                let cond = self.value(*cond);
                let (yes, yes_args) = (self.target_block(then.block), self.args(then));
                let (no, no_args) = (self.target_block(otherwise.block), self.args(otherwise));
                self.b.ins().brif(cond, yes, &yes_args, no, &no_args);
            }
            Term::Switch { value, cases, default } => self.switch(*value, cases, default),
            Term::Return(value) => {
                let mut results = Vec::new();
                if self.shape.status {
                    results.push(self.b.ins().iconst(types::I32, 0));
                }
                results.extend(value.map(|v| self.value(v)));
                self.b.ins().return_(&results);
            }
        }
    }

    fn switch(&mut self, value: ValueId, cases: &[(u64, Target)], default: &Target) {
        let (other, other_args) = (self.target_block(default.block), self.args(default));
        if cases.len() <= CHAIN_LABELS {
            let selector = self.value(value);
            for (label, target) in cases {
                let label = prim::constant(&mut self.b, self.func.values[value], *label);
                let (block, args) = (self.target_block(target.block), self.args(target));
                let next = self.b.create_block();
                let equal = self.b.ins().icmp(IntCC::Equal, selector, label);
                self.b.ins().brif(equal, block, &args, next, &[]);
                self.b.switch_to_block(next);
            }
            self.b.ins().jump(other, &other_args);
            return;
        }
        // A jump table gives no arguments: an edge that has some gets a block.
        let mut switch = Switch::new();
        let mut edges = Vec::new();
        for (label, target) in cases {
            let block = self.edge(target, &mut edges);
            switch.set_entry(u128::from(*label), block);
        }
        let otherwise = self.edge(default, &mut edges);
        let selector = match self.extended(value, PrimOp::Zext(Repr::I32)) {
            Some(wide) => self.b.ins().ireduce(types::I32, wide),
            None => self.value(value),
        };
        switch.emit(&mut self.b, selector, otherwise);
        for (edge, block, args) in edges {
            self.b.switch_to_block(edge);
            self.b.ins().jump(block, &args);
        }
    }

    fn edge(&mut self, target: &Target, edges: &mut Vec<(ir::Block, ir::Block, Vec<BlockArg>)>) -> ir::Block {
        let block = self.target_block(target.block);
        if target.args.is_empty() {
            return block;
        }
        let edge = self.b.create_block();
        edges.push((edge, block, self.args(target)));
        edge
    }
}
