//! A sound program, and every mistake in it.

use super::*;
use crate::build::Builder;
use crate::ir::{Args, Exit, IndexTerm, Segment};
use plcc_stdlib::fault::Fault;
use plcc_stdlib::prim::PrimOp;

/// f0: `Limit(I32) -> I32`; f1: the entry of the task, which calls it.
fn sample() -> Program {
    let mut b = Builder::new("Limit", &[Repr::I32], Some(Repr::I32), true);
    let x = b.params()[0];
    let old = b.load(Repr::I32, Place::new(Base::Instance, 4), false);
    let least = b.op(PrimOp::MinS, Repr::I32, &[x, old]);
    b.ret(Some(least));
    let limit = b.finish(16);
    let mut b = Builder::new("task Main", &[], None, false);
    let x = b.load(Repr::I32, Place::new(Base::Region, 64), false);
    let zero = b.number(Repr::I32, 0);
    let positive = b.op(PrimOp::LtS, Repr::I32, &[zero, x]);
    let (then, join) = (b.block(), b.block());
    b.branch(positive, then, join);
    b.switch_to(then);
    let y = b.call(FuncId::from_raw(0), Some(Place::new(Base::Region, 80)), &[x], Some(Repr::I32));
    b.store(Place::new(Base::Region, 64), y.expect("a result"));
    b.jump(join, &[]);
    b.switch_to(join);
    b.ret(None);
    let mut program = Program { region_bytes: 256, frame_base: 128, ..Program::default() };
    program.funcs.push(limit);
    program.tasks.push(program.funcs.push(b.finish(32)));
    program.sources.push(crate::ir::Source {
        span: plcc_diag::Span::new(plcc_diag::FileId(0), 0, 0),
        pou: String::new(),
        what: String::new(),
        inlined_at: None,
    });
    program
}

fn messages(change: impl FnOnce(&mut Program)) -> Vec<String> {
    let mut program = sample();
    change(&mut program);
    verify(&program).iter().map(ToString::to_string).collect()
}

fn v(n: u32) -> ValueId {
    ValueId::from_raw(n)
}

#[test]
fn sound_program() {
    assert_eq!(messages(|_| {}), [""; 0]);
}

#[test]
fn each_mistake_is_found() {
    let main = FuncId::from_raw(1);
    let insts = move |p: &mut Program, inst: Inst| p.funcs[main].blocks[0].insts.push(inst);
    let place = || Place::new(Base::Region, 64);
    let source = SourceId::from_raw(0);
    type Change = Box<dyn FnOnce(&mut Program)>;
    let prim = |op, repr, args| Inst::Prim { dst: v(4), op, repr, args };
    let push = move |inst: Inst| -> Change { Box::new(move |p| insts(p, inst)) };
    let with_value = move |repr: Repr, inst: Inst| -> Change {
        Box::new(move |p| {
            p.funcs[main].values.push(repr);
            insts(p, inst);
        })
    };
    let cases: Vec<(&str, Change)> = vec![
        (
            "bytes 254..258 are not in the region of 256",
            push(Inst::Store { place: Place::new(Base::Region, 254), value: v(0) }),
        ),
        ("instance of a function without one", push(Inst::Store { place: Place::new(Base::Instance, 0), value: v(0) })),
        (
            "byte -1 of the frame",
            push(Inst::Zero { dst: Place { offset: -1, ..Place::new(Base::Frame, 0) }, bytes: 1 }),
        ),
        ("bit: v0 is i32, wanted i8", push(Inst::Store { place: Place { bit: Some(1), ..place() }, value: v(0) })),
        ("bit 8 of a byte", push(Inst::Store { place: Place { bit: Some(8), ..place() }, value: v(2) })),
        ("a bit is no aggregate", push(Inst::Zero { dst: Place { bit: Some(1), ..place() }, bytes: 1 })),
        (
            "index: v0 is i32, wanted i64",
            push(Inst::Zero {
                dst: Place { index: vec![IndexTerm { value: v(0), stride: 1, low: 0, high: 3 }], ..place() },
                bytes: 1,
            }),
        ),
        ("reference: v2 is i8", push(Inst::Zero { dst: Place::new(Base::Reference(v(2)), 0), bytes: 1 })),
        ("v3 is not defined on every way", push(Inst::Store { place: place(), value: v(3) })),
        ("no value v9", push(Inst::Store { place: place(), value: v(9) })),
        ("defines v4, which has no representation", push(Inst::Const { dst: v(4), raw: 0 })),
        ("v0 is defined twice", push(Inst::Const { dst: v(0), raw: 0 })),
        ("0x100 does not fit i8", with_value(Repr::I8, Inst::Const { dst: v(4), raw: 256 })),
        ("FAdd is not defined on i32", with_value(Repr::I32, prim(PrimOp::FAdd, Repr::I32, Args::Two([v(0), v(0)])))),
        ("Add with 1 operands", with_value(Repr::I32, prim(PrimOp::Add, Repr::I32, Args::One([v(0)])))),
        ("operand: v2 is i8, wanted i32", with_value(Repr::I32, prim(PrimOp::Add, Repr::I32, Args::Two([v(0), v(2)])))),
        (
            "operand: v1 is i32, wanted i64",
            with_value(Repr::I32, prim(PrimOp::Shl, Repr::I32, Args::Two([v(0), v(1)]))),
        ),
        ("result: v4 is i32, wanted i8", with_value(Repr::I32, prim(PrimOp::Eq, Repr::I32, Args::Two([v(0), v(0)])))),
        (
            "only a truth value is normalised",
            with_value(Repr::I32, Inst::Load { dst: v(4), place: place(), normalise: true }),
        ),
        ("address: v4 is i64", with_value(Repr::I64, Inst::AddressOf { dst: v(4), place: place(), bytes: 0 })),
        ("no row 7 in the source table", push(Inst::Poll { exit: Exit::at(SourceId::from_raw(7)) })),
        (
            "checked value: v0 is i32",
            push(Inst::Check {
                cond: Cond::Within { value: v(0), low: 0, high: 1 },
                fault: Fault::SubrangeViolation,
                operands: vec![],
                exit: Exit::at(source),
            }),
        ),
        (
            "at most three operands",
            push(Inst::Check {
                cond: Cond::True(v(2)),
                fault: Fault::SubrangeViolation,
                operands: vec![v(0); 4],
                exit: Exit::at(source),
            }),
        ),
        (
            "calls `Limit` without an instance",
            push(Inst::Call {
                dst: None,
                callee: FuncId::from_raw(0),
                instance: None,
                args: vec![v(0)],
                status: None,
                exit: Exit::at(source),
            }),
        ),
        (
            "with 0 of 1 arguments",
            push(Inst::Call {
                dst: None,
                callee: FuncId::from_raw(0),
                instance: Some(place()),
                args: vec![],
                status: None,
                exit: Exit::at(source),
            }),
        ),
        (
            "calls itself",
            push(Inst::Call {
                dst: None,
                callee: main,
                instance: None,
                args: vec![],
                status: None,
                exit: Exit::at(source),
            }),
        ),
        (
            "calls f5, which does not exist",
            push(Inst::Call {
                dst: None,
                callee: FuncId::from_raw(5),
                instance: None,
                args: vec![],
                status: None,
                exit: Exit::at(source),
            }),
        ),
        ("returns a result but has none", Box::new(move |p| p.funcs[main].blocks[2].term = Term::Return(Some(v(0))))),
        (
            "takes 0 values, got 1",
            Box::new(move |p| {
                p.funcs[main].blocks[1].term = Term::Jump(Target { block: BlockId::from_raw(2), args: vec![v(0)] });
            }),
        ),
        (
            "jumps to b9",
            Box::new(move |p| {
                p.funcs[main].blocks[1].term = Term::Jump(Target { block: BlockId::from_raw(9), args: vec![] });
            }),
        ),
        (
            "label 0x1 stands twice",
            Box::new(move |p| {
                let to = || Target { block: BlockId::from_raw(2), args: vec![] };
                p.funcs[main].blocks[1].term =
                    Term::Switch { value: v(0), cases: vec![(1, to()), (1, to())], default: to() };
            }),
        ),
        ("no entry block", Box::new(move |p| p.funcs[main].blocks.clear())),
        ("frame of 17 bytes", Box::new(move |p| p.funcs[main].frame_bytes = 17)),
        ("frames need 136", Box::new(move |p| p.funcs[main].frame_bytes = 120)),
        ("is no entry of a task", Box::new(|p| p.tasks.push(FuncId::from_raw(0)))),
        ("initial bytes at 255", Box::new(|p| p.initial.push(Segment { offset: 255, bytes: vec![0; 2] }))),
        ("retain range at 70 is not behind", Box::new(|p| p.retain = vec![(64, 8), (70, 2)])),
    ];
    for (want, change) in cases {
        let got = messages(change);
        assert!(got.iter().any(|m| m.contains(want)), "`{want}` is not in {got:#?}");
    }
}

#[test]
fn unreachable_blocks_may_use_anything() {
    let got = messages(|p| {
        let block = Block {
            params: vec![],
            insts: vec![Inst::Store { place: Place::new(Base::Region, 64), value: v(3) }],
            term: Term::Return(None),
        };
        p.funcs[FuncId::from_raw(1)].blocks.push(block);
    });
    assert_eq!(got, [""; 0]);
}
