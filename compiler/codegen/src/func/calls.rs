//! Calls: of functions of the program, with what they hand on when they fault, and of bodies of the standard library.

use super::*;

impl<'a> Translator<'a, '_> {
    pub(super) fn call(
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

    pub(super) fn call_rt(&mut self, dst: ValueId, symbol: &'static str, args: &[Value]) {
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

    pub(super) fn call_text(&mut self, dst: ValueId, func: &'static TextFn, texts: &[TextPlace], args: &[ValueId]) {
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
