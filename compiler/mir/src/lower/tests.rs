//! Lowering by running it: small HIR programs through verifier and interpreter. Whole programs are golden tests.

use super::{Checks, lower};
use crate::interp::Interp;
use crate::layout::Layout;
use crate::verify::verify;
use plcc_diag::{FileId, Span};
use plcc_hir::app::{Application, Program, Resource, Task};
use plcc_hir::body::{Body, Call, Callee, CaseArm, Eno, Expr, ExprKind, OutputArg, Place, Root, Step, Stmt, StmtKind};
use plcc_hir::*;
use plcc_stdlib::elem::Elem;
use plcc_stdlib::fault::Fault;
use plcc_stdlib::ops::Op;

const SPAN: Span = Span { file: FileId(0), start: 0, end: 0 };

/// One PROGRAM `Main` and what it needs.
struct Test {
    defs: Defs,
    main: PouId,
}

/// A finished execution.
struct Run {
    layout: Layout,
    region: Vec<u8>,
    fault: u32,
}

impl Test {
    fn new() -> Self {
        let mut test = Self { defs: Defs::default(), main: PouId::from_raw(0) };
        test.main = test.pou("Main", PouKind::Program);
        test
    }

    fn pou(&mut self, name: &str, kind: PouKind) -> PouId {
        self.defs.bodies.push(Body::default());
        self.defs.pous.push(Pou {
            name: name.into(),
            kind,
            owner: None,
            vars: Vec::new(),
            result: None,
            actions: Vec::new(),
            profile: Profile::Strict,
            builtin: false,
            span: SPAN,
        })
    }

    fn var(&mut self, pou: PouId, name: &str, section: Section, ty: TypeId) -> VarId {
        let id = self.defs.vars.push(Var {
            name: name.into(),
            ty,
            section,
            owner: Some(pou),
            constant: false,
            retain: false,
            non_retain: false,
            resource: None,
            address: None,
            open_address: None,
            init: Init::Default,
            address_taken: false,
            span: SPAN,
        });
        self.defs.pous[pou].vars.push(id);
        if section == Section::Result {
            self.defs.pous[pou].result = Some(id);
        }
        id
    }

    fn local(&mut self, name: &str, ty: TypeId) -> VarId {
        self.var(self.main, name, Section::Local, ty)
    }

    fn intern(&mut self, ty: Type) -> TypeId {
        self.defs.types.intern(ty)
    }

    fn place(&self, var: VarId) -> Place {
        Place { root: Root::Var(var), steps: Vec::new(), ty: self.defs.vars[var].ty, span: SPAN }
    }

    fn read(&self, var: VarId) -> Expr {
        read(self.place(var))
    }

    fn assign(&self, var: VarId, value: Expr) -> Stmt {
        assign(self.place(var), value)
    }

    /// var := var + 1
    fn increment(&self, var: VarId) -> Stmt {
        let ty = self.defs.vars[var].ty;
        let Type::Elem(elem) = self.defs.types[ty] else { panic!("an elementary type") };
        let sum = ExprKind::Op(Op::Add, elem, vec![self.read(var), number(elem, 1)]);
        self.assign(var, Expr { kind: sum, ty, span: SPAN })
    }

    fn body(&mut self, pou: PouId, stmts: Vec<Stmt>) {
        self.defs.bodies[pou].stmts = stmts;
    }

    fn run(self, stmts: Vec<Stmt>) -> Run {
        self.run_with(stmts, Checks::ALL)
    }

    fn run_with(mut self, stmts: Vec<Stmt>, checks: Checks) -> Run {
        self.body(self.main, stmts);
        let task =
            Task { name: "".into(), interval_ns: None, single: None, priority: 0, watchdog_ns: 0, deadline_ns: None };
        let main = Program {
            name: "Main".into(),
            pou: self.main,
            task: 0,
            inputs: Vec::new(),
            outputs: Vec::new(),
            located: Vec::new(),
            initial: Vec::new(),
            span: SPAN,
        };
        let resource = Resource { name: "".into(), tasks: vec![task], programs: vec![main], globals: Vec::new() };
        let app = Application { name: "".into(), resources: vec![resource], access: Vec::new() };
        let (program, layout) = lower(&self.defs, &app, 0, checks, false).expect("it fits");
        let problems = verify(&program);
        assert!(problems.is_empty(), "{}\n{}", problems[0], crate::print::program(&program, None));
        let mut interp = Interp::new(&program);
        let mut memory = vec![0u64; interp.region_bytes() / 8 + 1];
        // SAFETY: plain bytes of a longer-lived allocation, exclusively borrowed, with a larger alignment.
        let region = unsafe { std::slice::from_raw_parts_mut(memory.as_mut_ptr().cast::<u8>(), memory.len() * 8) };
        interp.init(region, true);
        let fault = interp.scan(region, 0, 0);
        Run { layout, region: region.to_vec(), fault }
    }
}

impl Run {
    /// A variable of `Main`.
    fn int(&self, var: VarId, elem: Elem) -> i128 {
        let (offset, _) = self.layout.offset(var, self.layout.program(0)).expect("a variable with a place");
        let mut raw = [0; 8];
        let bytes = elem.bytes() as usize;
        raw[..bytes].copy_from_slice(&self.region[offset as usize..][..bytes]);
        elem.to_i128(u64::from_le_bytes(raw))
    }
}

fn read(place: Place) -> Expr {
    Expr { ty: place.ty, kind: ExprKind::Read(place), span: SPAN }
}

fn assign(target: Place, value: Expr) -> Stmt {
    stmt(StmtKind::Assign { target, value })
}

fn stmt(kind: StmtKind) -> Stmt {
    Stmt { kind, span: SPAN }
}

fn number(elem: Elem, value: i128) -> Expr {
    let raw = value as u64 & elem.repr().mask();
    Expr { kind: ExprKind::Const(raw), ty: Types::elem(elem), span: SPAN }
}

fn for_(var: Place, from: Expr, to: Expr, by: Option<Expr>, body: Vec<Stmt>) -> Stmt {
    stmt(StmtKind::For { var, from, to, by, body })
}

/// Passes and final value of `FOR i := from TO to BY by`, with constants or with variables for the bounds.
fn passes(elem: Elem, from: i128, to: i128, by: Option<(Elem, i128)>, constant: bool) -> (i128, i128) {
    let mut test = Test::new();
    let i = test.local("i", Types::elem(elem));
    let n = test.local("n", Types::elem(Elem::Lint));
    let mut stmts = Vec::new();
    let mut bound = |test: &mut Test, name: &str, elem: Elem, value: i128, constant: bool| {
        if constant {
            return number(elem, value);
        }
        let var = test.local(name, Types::elem(elem));
        stmts.push(test.assign(var, number(elem, value)));
        test.read(var)
    };
    let first = bound(&mut test, "a", elem, from, constant);
    let last = bound(&mut test, "b", elem, to, constant);
    // A negative step of an unsigned variable is always a constant.
    let step = by.map(|(ty, by)| bound(&mut test, "s", ty, by, constant || ty != elem));
    let count = test.increment(n);
    stmts.push(for_(test.place(i), first, last, step, vec![count]));
    let run = test.run(stmts);
    assert_eq!(run.fault, 0);
    (run.int(n, Elem::Lint), run.int(i, elem))
}

#[test]
fn for_counts_the_mathematical_range() {
    use Elem::{Int, Lint, Sint, Uint, Ulint, Usint};
    let max = i128::from(i64::MAX);
    // Type, FROM, TO, BY with its type, passes and final value.
    type Row = (Elem, i128, i128, Option<(Elem, i128)>, (i128, i128));
    let rows: &[Row] = &[
        (Int, 1, 10, None, (10, 11)),
        (Int, 10, 1, None, (0, 10)),
        (Int, 3, 3, None, (1, 4)),
        (Int, 1, 10, Some((Int, 3)), (4, 13)),
        (Int, 1, 9, Some((Int, 3)), (3, 10)),
        (Int, 10, 1, Some((Int, -3)), (4, -2)),
        (Int, 1, 10, Some((Int, -1)), (0, 1)),
        (Sint, -128, 127, None, (256, 127)),
        (Sint, 127, -128, Some((Sint, -1)), (256, -128)),
        (Sint, 120, 127, Some((Sint, 5)), (2, 125)),
        (Sint, 127, -128, Some((Sint, -128)), (2, -1)),
        (Sint, -1, -128, Some((Sint, -128)), (1, -1)),
        (Sint, 0, -128, Some((Sint, -128)), (2, -128)),
        (Sint, 0, -1, Some((Sint, -128)), (1, -128)),
        (Usint, 0, 255, None, (256, 255)),
        (Usint, 255, 0, Some((Sint, -1)), (256, 0)),
        (Usint, 255, 0, Some((Sint, -128)), (2, 127)),
        (Usint, 5, 0, Some((Sint, -2)), (3, 1)),
        (Usint, 250, 255, Some((Usint, 200)), (1, 250)),
        (Uint, 65530, 65535, None, (6, 65535)),
        (Lint, max - 2, max, None, (3, max)),
        (Lint, -max - 1, max, Some((Lint, max)), (3, max - 1)),
        (Ulint, (1 << 64) - 2, (1 << 64) - 1, None, (2, (1 << 64) - 1)),
        (Ulint, 0, (1 << 64) - 1, Some((Ulint, 1 << 63)), (2, 1 << 63)),
    ];
    for (elem, from, to, by, expected) in rows {
        for constant in [true, false] {
            let got = passes(*elem, *from, *to, *by, constant);
            assert_eq!(got, *expected, "{} {from}..{to} by {by:?}, constants: {constant}", elem.name());
        }
    }
}

#[test]
fn for_step_zero_is_a_fault() {
    let mut test = Test::new();
    let i = test.local("i", Types::elem(Elem::Int));
    let s = test.local("s", Types::elem(Elem::Int));
    let step = Some(test.read(s));
    let stmts = vec![for_(test.place(i), number(Elem::Int, 1), number(Elem::Int, 3), step, Vec::new())];
    assert_eq!(test.run(stmts).fault, Fault::ForStepZero.number());
}

#[test]
fn a_body_that_writes_the_control_variable_does_not_change_the_count() {
    let mut test = Test::new();
    let i = test.local("i", Types::elem(Elem::Int));
    let n = test.local("n", Types::elem(Elem::Int));
    let body = vec![test.increment(n), test.assign(i, number(Elem::Int, 100))];
    let stmts = vec![for_(test.place(i), number(Elem::Int, 1), number(Elem::Int, 5), None, body)];
    let run = test.run(stmts);
    assert_eq!((run.int(n, Elem::Int), run.int(i, Elem::Int)), (5, 6));
}

#[test]
fn the_control_variable_of_a_subrange_stays_inside() {
    let mut test = Test::new();
    let ty = test.intern(Type::Subrange { base: Elem::Int, low: 0, high: 9 });
    let i = test.local("i", ty);
    let stmts = vec![for_(test.place(i), number(Elem::Int, 0), number(Elem::Int, 9), None, Vec::new())];
    assert_eq!(test.run(stmts).int(i, Elem::Int), 9);
}

#[test]
fn exit_and_continue() {
    let mut test = Test::new();
    let i = test.local("i", Types::elem(Elem::Int));
    let n = test.local("n", Types::elem(Elem::Int));
    let is = |value| Expr {
        kind: ExprKind::Op(Op::Eq, Elem::Int, vec![test.read(i), number(Elem::Int, value)]),
        ty: Types::elem(Elem::Bool),
        span: SPAN,
    };
    let when = |cond, kind| stmt(StmtKind::If { arms: vec![(cond, vec![stmt(kind)])], otherwise: Vec::new() });
    let body = vec![when(is(2), StmtKind::Continue), when(is(5), StmtKind::Exit), test.increment(n)];
    let stmts = vec![for_(test.place(i), number(Elem::Int, 1), number(Elem::Int, 9), None, body)];
    let run = test.run(stmts);
    assert_eq!((run.int(n, Elem::Int), run.int(i, Elem::Int)), (3, 5));
}

#[test]
fn case_takes_values_and_ranges_of_either_sign() {
    for (elem, value, expected) in [
        (Elem::Int, -5, 1),
        (Elem::Int, 7, 2),
        (Elem::Int, -20000, 3),
        (Elem::Int, -101, 3),
        (Elem::Int, -100, 0),
        (Elem::Int, 32767, 4),
        (Elem::Int, 999, 0),
        (Elem::Byte, 255, 4),
        (Elem::Byte, 6, 2),
    ] {
        let mut test = Test::new();
        let x = test.local("x", Types::elem(elem));
        let y = test.local("y", Types::elem(Elem::Int));
        let range = elem.range().map_or(0, |r| r.1);
        let labels = if elem == Elem::Int {
            vec![vec![(-5, -5)], vec![(1, 1), (5, 8)], vec![(-20000, -101)], vec![(1000, range)]]
        } else {
            vec![vec![(1, 1)], vec![(5, 8)], vec![(10, 99)], vec![(100, range)]]
        };
        let arm = |(n, labels): (usize, Vec<(i128, i128)>)| CaseArm {
            labels,
            body: vec![test.assign(y, number(Elem::Int, n as i128 + 1))],
        };
        let arms = labels.into_iter().enumerate().map(arm).collect();
        let case = stmt(StmtKind::Case { selector: test.read(x), arms, otherwise: Vec::new() });
        let stmts = vec![test.assign(x, number(elem, value)), case];
        assert_eq!(test.run(stmts).int(y, Elem::Int), expected, "{value}");
    }
}

/// `a[i] := 7; x := a[i]` with `a : ARRAY [-1..2, 5..6] OF INT` at [i, 6].
fn indexed(i: i128, checks: Checks) -> (i128, u32) {
    let mut test = Test::new();
    let array = test.intern(Type::Array { dims: vec![(-1, 2), (5, 6)], elem: Types::elem(Elem::Int) });
    let a = test.local("a", array);
    let x = test.local("x", Types::elem(Elem::Int));
    let index = test.local("i", Types::elem(Elem::Lint));
    let element = || {
        let indices = vec![test.read(index), number(Elem::Lint, 6)];
        let mut place = test.place(a);
        place.steps.push(Step::Index(indices, "a".into()));
        place.ty = Types::elem(Elem::Int);
        place
    };
    let stmts = vec![
        test.assign(index, number(Elem::Lint, i)),
        assign(element(), number(Elem::Int, 7)),
        test.assign(x, read(element())),
    ];
    let run = test.run_with(stmts, checks);
    (run.int(x, Elem::Int), run.fault)
}

#[test]
fn indices_are_checked() {
    assert_eq!(indexed(-1, Checks::ALL), (7, 0));
    assert_eq!(indexed(2, Checks::ALL), (7, 0));
    assert_eq!(indexed(3, Checks::ALL), (0, Fault::IndexOutOfBounds.number()));
    assert_eq!(indexed(-2, Checks::ALL), (0, Fault::IndexOutOfBounds.number()));
    assert_eq!(indexed(3, Checks::NONE), (7, 0));
}

#[test]
fn bits_and_parts_of_a_word() {
    let mut test = Test::new();
    let d = test.local("d", Types::elem(Elem::Dword));
    let bit = test.local("bit", Types::elem(Elem::Bool));
    let byte = test.local("byte", Types::elem(Elem::Byte));
    let step = |steps: Vec<Step>, ty| Place { steps, ty: Types::elem(ty), ..test.place(d) };
    let stmts = vec![
        test.assign(d, number(Elem::Dword, 0x1234_5678)),
        assign(step(vec![Step::Bit(31)], Elem::Bool), number(Elem::Bool, 1)),
        assign(step(vec![Step::Bit(3)], Elem::Bool), number(Elem::Bool, 0)),
        assign(step(vec![Step::Part(Elem::Byte, 1)], Elem::Byte), number(Elem::Byte, 0xAB)),
        assign(step(vec![Step::Part(Elem::Word, 1), Step::Bit(0)], Elem::Bool), number(Elem::Bool, 1)),
        test.assign(bit, read(step(vec![Step::Bit(28)], Elem::Bool))),
        test.assign(byte, read(step(vec![Step::Part(Elem::Byte, 2)], Elem::Byte))),
    ];
    let run = test.run(stmts);
    assert_eq!(run.int(d, Elem::Dword), 0x9235_AB70);
    assert_eq!((run.int(bit, Elem::Bool), run.int(byte, Elem::Byte)), (1, 0x35));
}

/// F(IN: INT) : INT with an output OUT; `F := IN / 0` when `faulty`, else `F := IN + 1; OUT := IN`.
fn function(test: &mut Test, faulty: bool) -> (PouId, VarId, VarId) {
    let int = Types::elem(Elem::Int);
    let f = test.pou("F", PouKind::Function);
    let input = test.var(f, "IN", Section::Input, int);
    let output = test.var(f, "OUT", Section::Output, int);
    let result = test.var(f, "F", Section::Result, int);
    let (op, operand) = if faulty { (Op::Div, 0) } else { (Op::Add, 1) };
    let value = ExprKind::Op(op, Elem::Int, vec![test.read(input), number(Elem::Int, operand)]);
    let stmts =
        vec![test.assign(output, test.read(input)), test.assign(result, Expr { kind: value, ty: int, span: SPAN })];
    test.body(f, stmts);
    (f, input, output)
}

fn call_of(test: &Test, f: PouId, input: VarId, value: Expr) -> Call {
    let _ = test;
    Call {
        callee: Callee::Function(f),
        inputs: vec![(input, value)],
        in_outs: Vec::new(),
        outputs: Vec::new(),
        en: None,
        eno: None,
        span: SPAN,
    }
}

fn call_expr(call: Call) -> Expr {
    Expr { kind: ExprKind::Call(Box::new(call)), ty: Types::elem(Elem::Int), span: SPAN }
}

#[test]
fn functions_nest_and_give_outputs() {
    let mut test = Test::new();
    let (f, input, output) = function(&mut test, false);
    let x = test.local("x", Types::elem(Elem::Int));
    let y = test.local("y", Types::elem(Elem::Int));
    let inner = call_expr(call_of(&test, f, input, number(Elem::Int, 5)));
    let mut outer = call_of(&test, f, input, inner);
    outer.outputs.push(OutputArg { output, negated: false, convert: None, target: test.place(y) });
    let stmts = vec![test.assign(x, call_expr(outer))];
    let run = test.run(stmts);
    assert_eq!((run.int(x, Elem::Int), run.int(y, Elem::Int)), (7, 6));
}

#[test]
fn eno_catches_a_fault_and_en_skips() {
    for (en, faulty, expected) in [(None, true, (0, 0, 3)), (Some(0), false, (0, 0, 3)), (Some(1), false, (6, 1, 5))] {
        let mut test = Test::new();
        let (f, input, output) = function(&mut test, faulty);
        let x = test.local("x", Types::elem(Elem::Int));
        let y = test.local("y", Types::elem(Elem::Int));
        let ok = test.local("ok", Types::elem(Elem::Bool));
        let mut call = call_of(&test, f, input, number(Elem::Int, 5));
        call.en = en.map(|en| number(Elem::Bool, en));
        call.eno = Some(Eno { target: test.place(ok), negated: false });
        call.outputs.push(OutputArg { output, negated: false, convert: None, target: test.place(y) });
        let stmts = vec![
            test.assign(x, number(Elem::Int, 9)),
            test.assign(y, number(Elem::Int, 3)),
            test.assign(ok, number(Elem::Bool, 1 - expected.1)),
            test.assign(x, call_expr(call)),
        ];
        let run = test.run(stmts);
        assert_eq!(run.fault, 0);
        assert_eq!((run.int(x, Elem::Int), run.int(ok, Elem::Bool), run.int(y, Elem::Int)), expected);
    }
}

#[test]
fn aggregates_pass_through_functions() {
    // G(S: ARRAY [0..2] OF INT) : ARRAY [0..2] OF INT := S with S[1] + 1; b := G(G(a))
    let mut test = Test::new();
    let int = Types::elem(Elem::Int);
    let array = test.intern(Type::Array { dims: vec![(0, 2)], elem: int });
    let g = test.pou("G", PouKind::Function);
    let s = test.var(g, "S", Section::Input, array);
    let result = test.var(g, "G", Section::Result, array);
    let second = |test: &Test, var| {
        let mut place = test.place(var);
        place.steps.push(Step::Index(vec![number(Elem::Lint, 1)], "S".into()));
        place.ty = int;
        place
    };
    let sum = ExprKind::Op(Op::Add, Elem::Int, vec![read(second(&test, s)), number(Elem::Int, 1)]);
    let body =
        vec![assign(second(&test, s), Expr { kind: sum, ty: int, span: SPAN }), test.assign(result, test.read(s))];
    test.body(g, body);
    let a = test.local("a", array);
    let b = test.local("b", array);
    let x = test.local("x", int);
    test.defs.vars[a].init = Init::Array(vec![(3, Init::Scalar(4))]);
    let call = |value| Expr { ty: array, ..call_expr(call_of(&test, g, s, value)) };
    let stmts = vec![test.assign(b, call(call(test.read(a)))), test.assign(x, read(second(&test, b)))];
    let run = test.run(stmts);
    assert_eq!((run.int(x, Elem::Int), run.int(b, Elem::Int), run.int(a, Elem::Int)), (6, 4, 4));
}

#[test]
fn references_reach_only_variables_whose_address_is_taken() {
    for (offset, fault) in [(0, 0), (2, Fault::BadReference.number()), (-2, Fault::BadReference.number())] {
        let mut test = Test::new();
        let int = Types::elem(Elem::Int);
        let pointer = test.intern(Type::Ref { kind: RefKind::PointerTo, target: int });
        let before = test.local("before", int);
        let x = test.local("x", int);
        test.defs.vars[x].address_taken = true;
        let p = test.local("p", pointer);
        let address = Expr { kind: ExprKind::RefOf(test.place(x)), ty: pointer, span: SPAN };
        let moved = ExprKind::Op(Op::Add, Elem::Dint, vec![address, number(Elem::Dint, offset)]);
        let target = Place { root: Root::Deref(Box::new(test.read(p))), steps: Vec::new(), ty: int, span: SPAN };
        let stmts = vec![
            test.assign(before, number(Elem::Int, 1)),
            test.assign(p, Expr { kind: moved, ty: pointer, span: SPAN }),
            assign(target, number(Elem::Int, 42)),
        ];
        let run = test.run(stmts);
        assert_eq!(run.fault, fault);
        assert_eq!(run.int(x, Elem::Int), if fault == 0 { 42 } else { 0 });
    }
    let mut test = Test::new();
    let int = Types::elem(Elem::Int);
    let pointer = test.intern(Type::Ref { kind: RefKind::PointerTo, target: int });
    let p = test.local("p", pointer);
    let target = Place { root: Root::Deref(Box::new(test.read(p))), steps: Vec::new(), ty: int, span: SPAN };
    assert_eq!(test.run(vec![assign(target, number(Elem::Int, 1))]).fault, Fault::NullReference.number());
}

#[test]
fn layout_aligns_and_refuses_what_is_too_large() {
    let mut test = Test::new();
    let a = test.local("a", Types::elem(Elem::Bool));
    let b = test.local("b", Types::elem(Elem::Lreal));
    let c = test.local("c", Types::elem(Elem::Int));
    let run = test.run(Vec::new());
    let start = run.layout.program(0);
    let at = |var| run.layout.offset(var, start).map(|(offset, _)| offset - start);
    assert_eq!((at(a), at(b), at(c)), (Some(0), Some(8), Some(16)));

    let mut test = Test::new();
    let mut ty = Types::elem(Elem::Lreal);
    for _ in 0..5 {
        ty = test.intern(Type::Array { dims: vec![(i64::MIN, i64::MAX)], elem: ty });
    }
    test.local("huge", ty);
    let program = Program {
        name: "Main".into(),
        pou: test.main,
        task: 0,
        inputs: Vec::new(),
        outputs: Vec::new(),
        located: Vec::new(),
        initial: Vec::new(),
        span: SPAN,
    };
    let resource = Resource { programs: vec![program], ..Resource::default() };
    let app = Application { resources: vec![resource], ..Application::default() };
    let error = lower(&test.defs, &app, 0, Checks::ALL, false).expect_err("too large");
    assert_eq!(error.what, "variable `huge`");
    assert_eq!(super::fits(&test.defs, &app, 0), Err(error));
}

#[test]
fn retain_ranges_leave_out_references() {
    let mut test = Test::new();
    let dint = Types::elem(Elem::Dint);
    let reference = test.intern(Type::Ref { kind: RefKind::RefTo, target: dint });
    let field = |name: &str, ty| Field { name: name.into(), ty, init: Init::Default, span: SPAN };
    let id = test.defs.structs.push(StructDef {
        name: "S".into(),
        union: false,
        flag: None,
        fields: vec![field("a", dint), field("r", reference), field("b", dint)],
        span: SPAN,
    });
    let structure = test.intern(Type::Struct(id));
    test.local("plain", dint);
    let s = test.local("s", structure);
    test.defs.vars[s].retain = true;
    let run = test.run(Vec::new());
    let at = run.layout.program(0) + 4;
    assert_eq!(run.layout.retain, [(at, 4), (at + 8, 4)]);
}

#[test]
fn programs_are_split_where_addresses_are_taken() {
    let mut test = Test::new();
    let int = Types::elem(Elem::Int);
    let plain = test.local("plain", int);
    let taken = test.local("taken", int);
    test.defs.vars[taken].address_taken = true;
    let bit = test.local("bit", Types::elem(Elem::Bool));
    test.defs.vars[bit].address = Some(Address { area: Area::Output, byte: 1, bit: Some(3) });
    let instance = |name: &str| Program {
        name: name.into(),
        pou: test.main,
        task: 0,
        inputs: Vec::new(),
        outputs: Vec::new(),
        located: Vec::new(),
        initial: Vec::new(),
        span: SPAN,
    };
    let resource = Resource { programs: vec![instance("A"), instance("B")], ..Resource::default() };
    let app = Application { resources: vec![resource], ..Application::default() };
    let (_, layout) = lower(&test.defs, &app, 0, Checks::ALL, false).expect("it fits");
    let inside = |offset: u32| (layout.addressable.start..layout.addressable.end()).contains(&offset);
    for program in [0, 1] {
        let start = layout.program(program);
        let at = |var| layout.offset(var, start).map(|(offset, _)| offset).expect("a place");
        assert!(!inside(at(plain)) && inside(at(taken)));
    }
    assert_ne!(layout.offset(taken, layout.program(0)), layout.offset(taken, layout.program(1)));
    let area = layout.area(Area::Output);
    assert_eq!((layout.offset(bit, 0), area.bytes), (Some((area.start + 1, Some(3))), 8));
}

#[test]
fn strings_are_cut_at_the_capacity() {
    let mut test = Test::new();
    let of = |test: &mut Test, capacity| test.intern(Type::String { wide: false, capacity });
    let (three, six) = (of(&mut test, 3), of(&mut test, 6));
    let short = test.local("short", three);
    let guard = test.local("guard", Types::elem(Elem::Byte));
    let long = test.local("long", six);
    let again = test.local("again", six);
    test.defs.vars[again].init = Init::String(b"zzzzzz".to_vec());
    let text = Expr { kind: ExprKind::String(b"abcdefgh".to_vec()), ty: of(&mut test, 8), span: SPAN };
    let stmts = vec![
        test.assign(guard, number(Elem::Byte, 0xEE)),
        test.assign(long, text),
        test.assign(short, test.read(long)),
        test.assign(again, test.read(short)),
    ];
    let run = test.run(stmts);
    let bytes = |var, n: usize| {
        let (at, _) = run.layout.offset(var, run.layout.program(0)).expect("a place");
        run.region[at as usize..][..n].to_vec()
    };
    assert_eq!(bytes(long, 7), b"abcdef\0");
    assert_eq!(bytes(short, 4), b"abc\0");
    assert_eq!(bytes(again, 4), b"abc\0");
    assert_eq!(run.int(guard, Elem::Byte), 0xEE);
}
