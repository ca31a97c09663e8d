//! Every machine operation in CLIF: the only second reading of [`eval`](plcc_stdlib::prim::eval).
//!
//! All are total, as there: no division traps, no shift count is too great, every real has an integer.

use cranelift_codegen::ir::condcodes::{FloatCC, IntCC};
use cranelift_codegen::ir::{InstBuilder, InstructionData, MemFlagsData, Opcode, Type, Value, types};
use cranelift_frontend::FunctionBuilder;
use plcc_stdlib::prim::{PrimOp, Repr};

/// The CLIF type of a representation.
pub fn clif_type(repr: Repr) -> Type {
    match repr {
        Repr::I8 => types::I8,
        Repr::I16 => types::I16,
        Repr::I32 => types::I32,
        Repr::I64 => types::I64,
        Repr::F32 => types::F32,
        Repr::F64 => types::F64,
    }
}

/// The type in which values are computed and handed on from block to block. Operations on 16 bits with a constant have a
/// prefix that x86-64 decodes slowly, and none of three operands; so these have 32, the upper half of which means nothing.
pub fn carrier(repr: Repr) -> Type {
    if repr == Repr::I16 { types::I32 } else { clif_type(repr) }
}

/// A constant: the register value `raw` of a representation.
pub fn constant(b: &mut FunctionBuilder, repr: Repr, raw: u64) -> Value {
    use cranelift_codegen::ir::immediates::{Ieee32, Ieee64};
    match repr {
        Repr::F32 => b.ins().f32const(Ieee32::with_bits(raw as u32)),
        Repr::F64 => b.ins().f64const(Ieee64::with_bits(raw)),
        _ => b.ins().iconst(clif_type(repr), raw as i64),
    }
}

/// Appends `op` on operands of `repr`; may end the block and begin another one.
pub fn emit(b: &mut FunctionBuilder, op: PrimOp, repr: Repr, args: &[Value]) -> Value {
    use PrimOp::*;
    let x = args[0];
    let y = args.get(1).copied().unwrap_or(x);
    match op {
        Add => b.ins().iadd(x, y),
        Sub => b.ins().isub(x, y),
        Mul => b.ins().imul(x, y),
        MulHiS => b.ins().smulhi(x, y),
        MulHiU => b.ins().umulhi(x, y),
        DivS | DivU | RemS | RemU => division(b, op, repr, x, y),
        Neg => b.ins().ineg(x),
        And => b.ins().band(x, y),
        Or => b.ins().bor(x, y),
        Xor => b.ins().bxor(x, y),
        Not => b.ins().bnot(x),
        Shl | ShrU | ShrS => shift(b, op, repr, x, y),
        Rotl => b.ins().rotl(x, y),
        Rotr => b.ins().rotr(x, y),
        MinS => choose(b, IntCC::SignedLessThan, x, y),
        MinU => choose(b, IntCC::UnsignedLessThan, x, y),
        MaxS => choose(b, IntCC::SignedGreaterThan, x, y),
        MaxU => choose(b, IntCC::UnsignedGreaterThan, x, y),
        Eq => b.ins().icmp(IntCC::Equal, x, y),
        Ne => b.ins().icmp(IntCC::NotEqual, x, y),
        LtS => b.ins().icmp(IntCC::SignedLessThan, x, y),
        LeS => b.ins().icmp(IntCC::SignedLessThanOrEqual, x, y),
        LtU => b.ins().icmp(IntCC::UnsignedLessThan, x, y),
        LeU => b.ins().icmp(IntCC::UnsignedLessThanOrEqual, x, y),
        FAdd => b.ins().fadd(x, y),
        FSub => b.ins().fsub(x, y),
        FMul => b.ins().fmul(x, y),
        FDiv => b.ins().fdiv(x, y),
        FNeg => b.ins().fneg(x),
        FAbs => b.ins().fabs(x),
        FSqrt => b.ins().sqrt(x),
        FCeil => b.ins().ceil(x),
        FFloor => b.ins().floor(x),
        FTrunc => b.ins().trunc(x),
        FNearest => b.ins().nearest(x),
        FEq => b.ins().fcmp(FloatCC::Equal, x, y),
        FNe => b.ins().fcmp(FloatCC::NotEqual, x, y),
        FLt => b.ins().fcmp(FloatCC::LessThan, x, y),
        FLe => b.ins().fcmp(FloatCC::LessThanOrEqual, x, y),
        Select => b.ins().select(x, y, args[2]),
        Zext(to) => b.ins().uextend(clif_type(to), x),
        Sext(to) => b.ins().sextend(clif_type(to), x),
        Wrap(to) => b.ins().ireduce(clif_type(to), x),
        FPromote => b.ins().fpromote(types::F64, x),
        FDemote => b.ins().fdemote(types::F32, x),
        SToF(to) => {
            let x = if repr.bytes() < 4 { b.ins().sextend(types::I32, x) } else { x };
            b.ins().fcvt_from_sint(clif_type(to), x)
        }
        UToF(to) => match repr {
            Repr::I8 | Repr::I16 => {
                let x = b.ins().uextend(types::I32, x);
                b.ins().fcvt_from_sint(clif_type(to), x)
            }
            Repr::I32 => {
                let x = b.ins().uextend(types::I64, x);
                b.ins().fcvt_from_sint(clif_type(to), x)
            }
            _ => b.ins().fcvt_from_uint(clif_type(to), x),
        },
        FToS(to) => to_signed(b, to, x),
        FToU(to) => to_unsigned(b, to, x),
        FBits => {
            let to = if repr == Repr::F32 { types::I32 } else { types::I64 };
            b.ins().bitcast(to, MemFlagsData::new(), x)
        }
        BitsF => {
            let to = if repr == Repr::I32 { types::F32 } else { types::F64 };
            b.ins().bitcast(to, MemFlagsData::new(), x)
        }
    }
}

/// The bits of an integer constant.
fn known(b: &FunctionBuilder, value: Value) -> Option<u64> {
    let inst = b.func.dfg.value_def(value).inst()?;
    match b.func.dfg.insts[inst] {
        InstructionData::UnaryImm { opcode: Opcode::Iconst, imm } => Some(imm.bits() as u64),
        _ => None,
    }
}

fn choose(b: &mut FunctionBuilder, cc: IntCC, x: Value, y: Value) -> Value {
    let first = b.ins().icmp(cc, x, y);
    b.ins().select(first, x, y)
}

/// The machine's division traps on 0 and on MIN / -1; both go a way of their own, which the branch predictor learns.
fn division(b: &mut FunctionBuilder, op: PrimOp, repr: Repr, x: Value, y: Value) -> Value {
    let signed = matches!(op, PrimOp::DivS | PrimOp::RemS);
    let machine = |b: &mut FunctionBuilder| match op {
        PrimOp::DivS => b.ins().sdiv(x, y),
        PrimOp::DivU => b.ins().udiv(x, y),
        PrimOp::RemS => b.ins().srem(x, y),
        _ => b.ins().urem(x, y),
    };
    let ty = clif_type(repr);
    match known(b, y).map(|raw| raw & repr.mask()) {
        Some(0) => return b.ins().iconst(ty, 0),
        Some(raw) if !signed || raw != repr.mask() => return machine(b),
        _ => {}
    }
    let (plain, special, done) = (b.create_block(), b.create_block(), b.create_block());
    let result = b.append_block_param(done, ty);
    b.set_cold_block(special);
    if signed {
        // 0 and -1 are the divisors for which divisor + 1 is at most 1, unsigned.
        let above = b.ins().iadd_imm_u(y, 1);
        let is_special = b.ins().icmp_imm_u(IntCC::UnsignedLessThanOrEqual, above, 1);
        b.ins().brif(is_special, special, &[], plain, &[]);
    } else {
        b.ins().brif(y, plain, &[], special, &[]);
    }
    b.switch_to_block(plain);
    let quotient = machine(b);
    b.ins().jump(done, &[quotient.into()]);
    b.switch_to_block(special);
    let zero = b.ins().iconst(ty, 0);
    let value = if op == PrimOp::DivS {
        let negated = b.ins().ineg(x);
        b.ins().select(y, negated, zero)
    } else {
        zero
    };
    b.ins().jump(done, &[value.into()]);
    b.switch_to_block(done);
    result
}

/// The machine takes the count modulo the width.
fn shift(b: &mut FunctionBuilder, op: PrimOp, repr: Repr, x: Value, count: Value) -> Value {
    let width = u64::from(repr.bits());
    let machine = |b: &mut FunctionBuilder, count: Value| match op {
        PrimOp::Shl => b.ins().ishl(x, count),
        PrimOp::ShrU => b.ins().ushr(x, count),
        _ => b.ins().sshr(x, count),
    };
    let fits = match known(b, count) {
        Some(raw) if raw < width => return machine(b, count),
        Some(_) if op != PrimOp::ShrS => return b.ins().iconst(clif_type(repr), 0),
        _ => b.ins().icmp_imm_u(IntCC::UnsignedLessThan, count, width as i64),
    };
    if op == PrimOp::ShrS {
        let most = b.ins().iconst(types::I64, width as i64 - 1);
        let count = b.ins().select(fits, count, most);
        machine(b, count)
    } else {
        let shifted = machine(b, count);
        let zero = b.ins().iconst(clif_type(repr), 0);
        b.ins().select(fits, shifted, zero)
    }
}

fn to_signed(b: &mut FunctionBuilder, to: Repr, x: Value) -> Value {
    if to.bytes() >= 4 {
        return b.ins().fcvt_to_sint_sat(clif_type(to), x);
    }
    let wide = b.ins().fcvt_to_sint_sat(types::I32, x);
    let limit = 1i64 << (to.bits() - 1);
    let most = b.ins().iconst(types::I32, limit - 1);
    let least = b.ins().iconst(types::I32, i64::from(-limit as i32 as u32));
    let low = choose(b, IntCC::SignedLessThan, wide, most);
    let both = choose(b, IntCC::SignedGreaterThan, low, least);
    b.ins().ireduce(clif_type(to), both)
}

fn to_unsigned(b: &mut FunctionBuilder, to: Repr, x: Value) -> Value {
    if to.bytes() >= 4 {
        return b.ins().fcvt_to_uint_sat(clif_type(to), x);
    }
    let wide = b.ins().fcvt_to_uint_sat(types::I32, x);
    let most = b.ins().iconst(types::I32, to.mask() as i64);
    let low = choose(b, IntCC::UnsignedLessThan, wide, most);
    b.ins().ireduce(clif_type(to), low)
}
