//! Every machine operation on every representation and edge value: interpreter and native code against `prim::eval`.

mod support;

use plcc_mir::ir::Func;
use plcc_stdlib::prim::{PrimOp, Repr, eval};
use support::{Engines, global, program, task};

const OUT: u32 = 64;

fn all_ops() -> Vec<PrimOp> {
    use PrimOp::*;
    let mut ops = vec![
        Add, Sub, Mul, MulHiS, MulHiU, DivS, DivU, RemS, RemU, Neg, And, Or, Xor, Not, Shl, ShrU, ShrS, Rotl, Rotr,
        MinS, MinU, MaxS, MaxU, Eq, Ne, LtS, LeS, LtU, LeU, FAdd, FSub, FMul, FDiv, FNeg, FAbs, FSqrt, FCeil, FFloor,
        FTrunc, FNearest, FEq, FNe, FLt, FLe, Select, FPromote, FDemote, FBits, BitsF,
    ];
    for to in Repr::ALL {
        if to.is_int() {
            ops.extend([Zext(to), Sext(to), Wrap(to), FToS(to), FToU(to)]);
        } else {
            ops.extend([SToF(to), UToF(to)]);
        }
    }
    ops
}

fn edges(repr: Repr) -> Vec<u64> {
    if repr.is_int() {
        let high = 1u64 << (repr.bits() - 1);
        let mut list = vec![0, 1, 2, 3, 7, 10, 0x55, high - 1, high, high + 1, u64::MAX, u64::MAX - 1, u64::MAX - 9];
        list.extend([8, 15, 16, 31, 32, 33, 63, 64, 65, 127, 255, 256, 1 << 24 | 1, 1 << 32, 0x7FFF_FFFF, 0x8000_0000]);
        list.extend([(1 << 53) + 1, 0x7FFF_FFBF_FFFF_FFFF, 0x8000_0080_0000_0001, 0xFFFF_FF7F_FFFF_FFFF]);
        list.iter_mut().for_each(|v| *v &= repr.mask());
        list.sort_unstable();
        list.dedup();
        return list;
    }
    let values = [
        0.0,
        0.5,
        1.0,
        1.5,
        2.0,
        2.5,
        3.5,
        0.1,
        0.49999999999999994,
        4.9e-324,
        1e-40,
        1e10,
        1e20,
        1e38,
        1e39,
        1e300,
        126.5,
        127.0,
        127.5,
        128.0,
        255.0,
        255.5,
        256.0,
        32767.0,
        32767.9,
        32768.0,
        65535.0,
        65536.0,
        8388609.0,
        16777217.0,
        2147483520.0,
        2147483647.0,
        2147483648.0,
        4294967295.0,
        4294967296.0,
        4503599627370497.5,
        9007199254740993.0,
        9.223372036854775e18,
        9.223372036854776e18,
        1.844674407370955e19,
        1.8446744073709552e19,
        f64::MAX,
        f64::MIN_POSITIVE,
        f64::INFINITY,
        f64::NAN,
    ];
    let both = values.iter().flat_map(|v| [*v, -*v]);
    let mut list: Vec<u64> =
        both.map(|v| if repr == Repr::F32 { u64::from((v as f32).to_bits()) } else { v.to_bits() }).collect();
    list.sort_unstable();
    list.dedup();
    list
}

/// Operands from memory at 0, 8, 16; the result goes to `OUT`. `known` makes the second operand a constant.
fn func(op: PrimOp, repr: Repr, known: Option<u64>) -> Func {
    let mut b = task(&format!("{op:?} {}", repr.name()));
    let args: Vec<_> = (0..op.arity())
        .map(|n| {
            let operand = op.operand(repr, n);
            match known {
                Some(raw) if n == 1 => b.number(operand, raw),
                _ => b.load(operand, global(8 * n as u32), false),
            }
        })
        .collect();
    let result = b.op(op, repr, &args);
    b.store(global(OUT), result);
    b.ret(None);
    b.finish(0)
}

fn is_nan(repr: Repr, raw: u64) -> bool {
    match repr {
        Repr::F32 => f32::from_bits(raw as u32).is_nan(),
        Repr::F64 => f64::from_bits(raw).is_nan(),
        _ => false,
    }
}

/// Runs one task of both engines and compares the result with `eval`; a computed NaN may be any.
fn check(engines: &mut Engines, task: u32, op: PrimOp, repr: Repr, args: &[u64]) {
    for (n, arg) in args.iter().enumerate() {
        engines.write(8 * n as u32, &arg.to_le_bytes());
    }
    let want = eval(op, repr, args);
    let result = op.result(repr);
    let (left, right) = (engines.left.bytes(), engines.right.bytes());
    engines.interp.scan(left, task, 0);
    engines.jit.scan(right, task, 0);
    let at = plcc_stdlib::region::HEADER_BYTES + OUT;
    let got = [u64::from_le_bytes(engines.left.read(at)), u64::from_le_bytes(engines.right.read(at))];
    let exact = matches!(op, PrimOp::FNeg | PrimOp::FAbs | PrimOp::Select | PrimOp::BitsF | PrimOp::FBits);
    for (who, raw) in ["interpreter", "native code"].iter().zip(got) {
        let raw = raw & result.mask();
        let same = raw == want || (!exact && is_nan(result, want) && is_nan(result, raw));
        assert!(same, "{who}: {op:?} {} on {args:x?} gives {raw:#x}, meant is {want:#x}", repr.name());
    }
}

#[test]
fn operands_in_registers() {
    let cases: Vec<(PrimOp, Repr)> =
        all_ops().into_iter().flat_map(|op| Repr::ALL.map(|r| (op, r))).filter(|(op, r)| op.accepts(*r)).collect();
    let funcs: Vec<Func> = cases.iter().map(|(op, repr)| func(*op, *repr, None)).collect();
    let count = funcs.len();
    let mut engines = Engines::new(&program(funcs, count));
    for (n, (op, repr)) in cases.iter().enumerate() {
        let lists: Vec<Vec<u64>> = (0..3)
            .map(|k| match (*op, k) {
                (PrimOp::Select, 0) => vec![0, 1],
                _ if k < op.arity() => edges(op.operand(*repr, k)),
                _ => vec![0],
            })
            .collect();
        for a in &lists[0] {
            for b in &lists[1] {
                for c in &lists[2] {
                    check(&mut engines, n as u32, *op, *repr, &[*a, *b, *c][..op.arity()]);
                }
            }
        }
    }
}

#[test]
fn second_operand_constant() {
    let mut cases = Vec::new();
    for op in all_ops().into_iter().filter(|op| op.arity() == 2) {
        for repr in Repr::ALL.into_iter().filter(|r| op.accepts(*r)) {
            cases.extend(edges(op.operand(repr, 1)).into_iter().map(|raw| (op, repr, raw)));
        }
    }
    let funcs: Vec<Func> = cases.iter().map(|(op, repr, raw)| func(*op, *repr, Some(*raw))).collect();
    let count = funcs.len();
    let mut engines = Engines::new(&program(funcs, count));
    for (n, (op, repr, raw)) in cases.iter().enumerate() {
        for a in edges(*repr) {
            check(&mut engines, n as u32, *op, *repr, &[a, *raw]);
        }
    }
}

#[test]
fn every_target_knows_every_operation() {
    let cases = all_ops().into_iter().flat_map(|op| Repr::ALL.map(|r| (op, r))).filter(|(op, r)| op.accepts(*r));
    let funcs: Vec<Func> = cases.map(|(op, repr)| func(op, repr, None)).collect();
    let count = funcs.len();
    let program = program(funcs, count);
    for triple in ["x86_64-unknown-linux-gnu", "aarch64-unknown-linux-gnu", "riscv64gc-unknown-linux-gnu"] {
        let options = plcc_codegen::object::ObjectOptions { triple: Some(triple), ..Default::default() };
        plcc_codegen::object::compile(&program, options).expect(triple);
    }
}
