//! One function of the program to CLIF: blocks one to one, checks as branches to cold blocks.

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
    let mut translator = Translator::new(env, func, env.shapes[id], b);
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
    fn new(env: &'a Env<'a>, func: &'a Func, shape: Shape, mut b: FunctionBuilder<'f>) -> Self {
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
                let value = self.b.append_block_param(block, carrier(self.func.values[*param]));
                self.values[*param] = Some(value);
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

    fn defined(&self, id: ValueId) -> Value {
        self.values[id].unwrap_or_else(|| plcc_diag::bug!("v{} of `{}` has no value", id.index(), self.func.name))
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
        target.args.iter().map(|v| self.carried(*v).into()).collect()
    }

    fn block(&mut self, id: BlockId) {
        let block: &'a Block = &self.func.blocks[id];
        let here = self.target_block(id);
        if self.b.current_block() != Some(here) {
            self.b.switch_to_block(here);
        }
        let mut n = 0;
        while n < block.insts.len() {
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
                let value = prim::constant(&mut self.b, self.func.values[*dst], *raw);
                self.values[*dst] = Some(value);
            }
            Inst::Prim { dst, op, repr, args } => {
                let value = self.prim(*op, *repr, args);
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
            (PrimOp::Select, Repr::I16) => {
                let args = [self.value(args[0]), self.carried(args[1]), self.carried(args[2])];
                prim::emit(&mut self.b, op, Repr::I32, &args)
            }
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

    fn check(&mut self, cond: Cond, fault: Fault, operands: &[ValueId], exit: &Exit) {
        let (failed, next) = (self.cold_block(), self.b.create_block());
        let mut values = Vec::new();
        match cond {
            Cond::True(value) => {
                let value = self.value(value);
                self.b.ins().brif(value, next, &[], failed, &[]);
            }
            Cond::Within { value, low, high } => {
                let value = self.value(value);
                let outside = self.outside(value, low, high);
                self.b.ins().brif(outside, failed, &[], next, &[]);
                self.b.switch_to_block(failed);
                values.push(value);
                values.push(self.b.ins().iconst(types::I64, low));
                values.push(self.b.ins().iconst(types::I64, high));
            }
        }
        values.extend(self.values(operands));
        self.leave_with_fault(failed, fault, exit, &values);
        self.b.switch_to_block(next);
    }

    /// One unsigned comparison for both limits.
    fn outside(&mut self, value: Value, low: i64, high: i64) -> Value {
        if low > high {
            return self.b.ins().iconst(types::I8, 1);
        }
        let above = if low == 0 { value } else { self.b.ins().iadd_imm_s(value, low.wrapping_neg()) };
        let span = self.b.ins().iconst(types::I64, high.wrapping_sub(low));
        self.b.ins().icmp(IntCC::UnsignedGreaterThan, above, span)
    }

    fn leave_with_fault(&mut self, block: ir::Block, fault: Fault, exit: &Exit, operands: &[Value]) {
        let params = [types::I32, types::I32, types::I64, types::I64, types::I64, types::I32];
        let tail = match exit.instance {
            None => tail(&mut self.b, &mut self.fault, &params[..5]),
            Some(_) => tail(&mut self.b, &mut self.inlined_fault, &params),
        };
        if self.b.current_block() != Some(block) {
            self.b.switch_to_block(block);
        }
        for (place, value) in &exit.owed {
            let value = self.value(*value);
            self.store(place, value);
        }
        let source = exit.source;
        let mut args: Vec<BlockArg> = vec![
            self.b.ins().iconst(types::I32, i64::from(fault.number())).into(),
            self.b.ins().iconst(types::I32, i64::from(source.raw())).into(),
        ];
        for n in 0..3 {
            let operand = operands.get(n).copied().unwrap_or_else(|| self.b.ins().iconst(types::I64, 0));
            args.push(operand.into());
        }
        if let Some(place) = &exit.instance {
            args.push(self.region_offset(place).into());
        }
        self.b.ins().jump(tail, &args);
    }

    /// The region offset of a place, I32.
    fn region_offset(&mut self, place: &Place) -> Value {
        if place.base == Base::Region && place.index.is_empty() {
            return self.b.ins().iconst(types::I32, place.offset);
        }
        let pointer = self.pointer(place);
        let offset = self.b.ins().isub(pointer, self.region);
        self.b.ins().ireduce(types::I32, offset)
    }

    /// The region offset of the own instance; 0 for a function.
    fn own_instance(&mut self) -> Value {
        match self.instance {
            Some(instance) => {
                let offset = self.b.ins().isub(instance, self.region);
                self.b.ins().ireduce(types::I32, offset)
            }
            None => self.b.ins().iconst(types::I32, 0),
        }
    }

    fn fault_body(&mut self, block: ir::Block) {
        self.b.switch_to_block(block);
        let params = self.b.block_params(block).to_vec();
        let instance = params.get(5).copied().unwrap_or_else(|| self.own_instance());
        let region = self.region;
        let mut write = |at: u32, value: Value| {
            self.b.ins().store(memory(), value, region, at as i32);
        };
        write(FAULT_CODE, params[0]);
        write(FAULT_SOURCE, params[1]);
        write(FAULT_INSTANCE, instance);
        for (n, operand) in params[2..5].iter().enumerate() {
            write(FAULT_OPERANDS + 8 * n as u32, *operand);
        }
        self.return_with_status(params[0]);
    }

    /// Passes on the fault of a callee. A function without an instance faults on behalf of the one that called it.
    fn leave_body(&mut self, block: ir::Block) {
        self.b.switch_to_block(block);
        let params = self.b.block_params(block).to_vec();
        if self.instance.is_some() {
            let named = self.b.ins().load(types::I32, memory(), self.region, FAULT_INSTANCE as i32);
            let own = self.own_instance();
            let instance = self.b.ins().select(named, named, own);
            self.b.ins().store(memory(), instance, self.region, FAULT_INSTANCE as i32);
        }
        self.return_with_status(params[0]);
    }

    /// The same where code was inlined: its instance stands for that of a callee without one.
    fn name_instance(&mut self, place: &Place) {
        let named = self.b.ins().load(types::I32, memory(), self.region, FAULT_INSTANCE as i32);
        let inlined = self.region_offset(place);
        let instance = self.b.ins().select(named, named, inlined);
        self.b.ins().store(memory(), instance, self.region, FAULT_INSTANCE as i32);
    }

    fn return_with_status(&mut self, status: Value) {
        let mut results = vec![status];
        if let Some(repr) = self.func.result {
            results.push(prim::constant(&mut self.b, repr, 0));
        }
        self.b.ins().return_(&results);
    }

    fn leave_block(&mut self) -> ir::Block {
        tail(&mut self.b, &mut self.leave, &[types::I32])
    }

    fn call(
        &mut self,
        dst: Option<ValueId>,
        callee: FuncId,
        instance: Option<&Place>,
        args: &[ValueId],
        status: Option<ValueId>,
        exit: &Exit,
    ) {
        let shape = self.env.shapes[callee];
        let mut values = vec![self.region];
        if let Some(place) = instance {
            values.push(self.pointer(place));
        }
        if shape.frame {
            let Some(frame) = self.frame else { plcc_diag::bug!("no frame in `{}`", self.func.name) };
            let own = i64::from(self.func.frame_bytes);
            values.push(if own == 0 { frame } else { self.b.ins().iadd_imm_u(frame, own) });
        }
        values.extend(self.values(args));
        let reference = match self.callees.get(&callee) {
            Some(reference) => *reference,
            None => {
                let reference = import(self.b.func, self.env.ids[callee], self.env.signature(callee), true);
                self.callees.insert(callee, reference);
                reference
            }
        };
        let inst = self.b.ins().call(reference, &values);
        let results = self.b.inst_results(inst).to_vec();
        if let (Some(dst), Some(value)) = (dst, results.get(usize::from(shape.status))) {
            self.values[dst] = Some(*value);
        }
        match status {
            None if shape.status => {
                let (leave, next) = (self.leave_block(), self.b.create_block());
                match &exit.instance {
                    Some(place) if !self.env.program.funcs[callee].has_instance => {
                        let naming = self.cold_block();
                        self.b.ins().brif(results[0], naming, &[], next, &[]);
                        self.b.switch_to_block(naming);
                        self.name_instance(place);
                        self.b.ins().jump(leave, &[results[0].into()]);
                    }
                    _ => {
                        self.b.ins().brif(results[0], leave, &[results[0].into()], next, &[]);
                    }
                }
                self.b.switch_to_block(next);
            }
            None => {}
            Some(status) if shape.status => {
                self.values[status] = Some(results[0]);
                self.catch(results[0], shape);
            }
            Some(status) => self.values[status] = Some(self.b.ins().iconst(types::I32, 0)),
        }
    }

    /// Clears the fault code that a callee left behind, unless it is the deadline.
    fn catch(&mut self, status: Value, shape: Shape) {
        let (caught, next) = (self.cold_block(), self.b.create_block());
        self.b.ins().brif(status, caught, &[], next, &[]);
        self.b.switch_to_block(caught);
        if shape.deadline {
            let (leave, go_on) = (self.leave_block(), self.cold_block());
            let number = i64::from(Fault::Deadline.number());
            let is_deadline = self.b.ins().icmp_imm_u(IntCC::Equal, status, number);
            self.b.ins().brif(is_deadline, leave, &[status.into()], go_on, &[]);
            self.b.switch_to_block(go_on);
        }
        let zero = self.b.ins().iconst(types::I32, 0);
        self.b.ins().store(memory(), zero, self.region, FAULT_CODE as i32);
        self.b.ins().jump(next, &[]);
        self.b.switch_to_block(next);
    }

    fn call_rt(&mut self, dst: ValueId, symbol: &'static str, args: &[Value]) {
        let reference = match self.rt_callees.get(symbol) {
            Some(reference) => *reference,
            None => {
                let Some((id, signature)) = self.env.rt.get(symbol) else {
                    plcc_diag::bug!("`{symbol}` was not declared")
                };
                let reference = import(self.b.func, *id, signature.clone(), false);
                self.rt_callees.insert(symbol, reference);
                reference
            }
        };
        let inst = self.b.ins().call(reference, args);
        self.values[dst] = Some(self.b.inst_results(inst)[0]);
    }

    fn call_text(&mut self, dst: ValueId, func: &'static TextFn, texts: &[TextPlace], args: &[ValueId]) {
        let size = self.b.ins().iconst(types::I32, i64::from(self.region_bytes));
        let mut values = vec![self.region, size];
        for text in texts {
            values.push(self.packed(text));
        }
        values.extend(self.values(args));
        self.call_rt(dst, func.symbol, &values);
    }

    /// A string as `Text::pack` makes it: the capacity above the region offset.
    fn packed(&mut self, text: &TextPlace) -> Value {
        let capacity = self.value(text.capacity);
        let known = self.constant(capacity).map(|capacity| (capacity & 0xFFFF_FFFF) << 32);
        let fixed = text.place.base == Base::Region && text.place.index.is_empty();
        if let (true, Some(capacity)) = (fixed, known) {
            return self.b.ins().iconst(types::I64, capacity | text.place.offset);
        }
        let pointer = self.pointer(&text.place);
        let offset = self.b.ins().isub(pointer, self.region);
        let above = match known {
            Some(capacity) => self.b.ins().iconst(types::I64, capacity),
            None => {
                let wide = self.b.ins().uextend(types::I64, capacity);
                self.b.ins().ishl_imm_u(wide, 32)
            }
        };
        self.b.ins().bor(above, offset)
    }

    /// The number that a value is, if that stands where it is made.
    fn constant(&self, value: Value) -> Option<i64> {
        let inst = self.b.func.dfg.value_def(value).inst()?;
        match self.b.func.dfg.insts[inst] {
            ir::InstructionData::UnaryImm { opcode: ir::Opcode::Iconst, imm } => Some(imm.bits()),
            _ => None,
        }
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
        let selector = self.value(value);
        let (other, other_args) = (self.target_block(default.block), self.args(default));
        if cases.len() <= CHAIN_LABELS {
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

/// The tail for one more way.
fn tail(b: &mut FunctionBuilder, tails: &mut Tails, params: &[ir::Type]) -> ir::Block {
    tails.ways += 1;
    match tails.blocks.last() {
        Some(block) if tails.ways <= FAULTS_PER_TAIL => *block,
        _ => {
            let block = b.create_block();
            b.set_cold_block(block);
            for ty in params {
                b.append_block_param(block, *ty);
            }
            tails.blocks.push(block);
            tails.ways = 1;
            block
        }
    }
}

/// The signature of a body of the standard library that works on strings.
pub fn text_signature(func: &TextFn, isa: &dyn cranelift_codegen::isa::TargetIsa, call_conv: CallConv) -> Signature {
    let mut signature = Signature::new(call_conv);
    signature.params.push(AbiParam::new(types::I64));
    let extension = crate::target::c_extension(isa, Repr::I32);
    signature.params.push(AbiParam { extension, ..AbiParam::new(types::I32) });
    signature.params.extend(std::iter::repeat_n(AbiParam::new(types::I64), func.texts + func.params));
    signature.returns.push(AbiParam::new(types::I64));
    signature
}

/// The signature of a body of the standard library.
pub fn rt_signature(func: &RtFn, isa: &dyn cranelift_codegen::isa::TargetIsa, call_conv: CallConv) -> Signature {
    let param =
        |repr: Repr| AbiParam { extension: crate::target::c_extension(isa, repr), ..AbiParam::new(clif_type(repr)) };
    let mut signature = Signature::new(call_conv);
    signature.params.extend(func.params.iter().map(|r| param(*r)));
    signature.returns.push(AbiParam::new(clif_type(func.result)));
    signature
}
