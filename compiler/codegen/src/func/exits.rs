//! Ways that leave the function before its end: checks that fail, the deadline, faults of callees.

use super::*;

impl Translator<'_, '_> {
    pub(super) fn check(&mut self, cond: Cond, fault: Fault, operands: &[ValueId], exit: &Exit) {
        let (failed, next) = (self.cold_block(), self.b.create_block());
        let mut values = Vec::new();
        match cond {
            Cond::True(value) => {
                let value = self.value(value);
                self.b.ins().brif(value, next, &[], failed, &[]);
                // The operands are made there.
                self.b.switch_to_block(failed);
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

    pub(super) fn leave_with_fault(&mut self, block: ir::Block, fault: Fault, exit: &Exit, operands: &[Value]) {
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
    pub(super) fn region_offset(&mut self, place: &Place) -> Value {
        if place.base == Base::Region && place.index.is_empty() {
            return self.b.ins().iconst(types::I32, place.offset);
        }
        let pointer = self.pointer(place);
        let offset = self.b.ins().isub(pointer, self.region);
        self.b.ins().ireduce(types::I32, offset)
    }

    /// The region offset of the own instance; 0 for a function.
    pub(super) fn own_instance(&mut self) -> Value {
        match self.instance {
            Some(instance) => {
                let offset = self.b.ins().isub(instance, self.region);
                self.b.ins().ireduce(types::I32, offset)
            }
            None => self.b.ins().iconst(types::I32, 0),
        }
    }

    pub(super) fn fault_body(&mut self, block: ir::Block) {
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
    pub(super) fn leave_body(&mut self, block: ir::Block) {
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
    pub(super) fn name_instance(&mut self, place: &Place) {
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

    pub(super) fn leave_block(&mut self) -> ir::Block {
        tail(&mut self.b, &mut self.leave, &[types::I32])
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
