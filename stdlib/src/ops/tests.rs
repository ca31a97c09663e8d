//! Values by the rules of semantics.md \[T1\], \[T4\], \[T5\], \[T7\], \[E2\], \[E6\].

use super::*;
use crate::elem;
use crate::fold::Folder;
use crate::rt::RtFn;
use Elem::*;

fn run(op: Op, elem: Elem, args: &[u64]) -> (u64, Option<(Fault, [i64; 3])>) {
    let mut e = Folder::new();
    let vals: Vec<Val> = args.iter().map(|a| e.value(*a)).collect();
    let v = emit(op, elem, &vals, &mut e);
    (e.raw(v), e.fault())
}

/// Signed operands of an integer type in, mathematical value of the result out.
fn int(op: Op, elem: Elem, a: i64, b: i64) -> i128 {
    let (raw, fault) = run(op, elem, &[a as u64 & elem.repr().mask(), b as u64 & elem.repr().mask()]);
    assert_eq!(fault, None);
    elem.to_i128(raw)
}

#[test]
fn integers_wrap_in_their_own_type() {
    assert_eq!(int(Op::Add, Sint, 127, 1), -128);
    assert_eq!(int(Op::Add, Uint, 65535, 1), 0);
    assert_eq!(int(Op::Mul, Int, 300, 300), 24464);
    assert_eq!(int(Op::Sub, Usint, 0, 1), 255);
    assert_eq!(int(Op::Div, Int, -7, 2), -3);
    assert_eq!(int(Op::Mod, Int, -7, 2), -1);
    assert_eq!(int(Op::Mod, Int, 7, -2), 1);
    assert_eq!(int(Op::Div, Dint, i32::MIN.into(), -1), i128::from(i32::MIN));
    assert_eq!(int(Op::Mod, Lint, i64::MIN, -1), 0);
    assert_eq!(int(Op::Div, Udint, -1, 2), i128::from(u32::MAX / 2));
    assert_eq!(int(Op::Min, Sint, -1, 1), -1);
    assert_eq!(int(Op::Min, Byte, -1, 1), 1);
    assert_eq!(int(Op::Max, Time, -1, 1), 1);
    assert_eq!(run(Op::Abs, Sint, &[0x80]).0, 0x80);
    assert_eq!(run(Op::Abs, Int, &[0xFFFB]).0, 5);
    assert_eq!(run(Op::Abs, Uint, &[0xFFFB]).0, 0xFFFB);
    assert_eq!(run(Op::Not, Bool, &[1]).0, 0);
    assert_eq!(run(Op::Not, Byte, &[0x0F]).0, 0xF0);
}

#[test]
fn division_by_zero_is_a_fault_with_its_dividend() {
    assert_eq!(run(Op::Div, Int, &[0xFFF9, 0]).1, Some((Fault::DivisionByZero, [-7, 0, 0])));
    assert_eq!(run(Op::Mod, Uint, &[0xFFF9, 0]).1, Some((Fault::DivisionByZero, [0xFFF9, 0, 0])));
    assert_eq!(run(Op::TimeDiv, Sint, &[5, 0]).1, Some((Fault::DivisionByZero, [5, 0, 0])));
    assert_eq!(run(Op::Div, Real, &[0, 0]).1, None, "reals have no fault");
}

#[test]
fn without_checks_division_by_zero_gives_zero() {
    /// A folder that wants no checks and refuses a zero divisor, as a machine would.
    struct Unchecked(Folder);
    impl Emit for Unchecked {
        fn constant(&mut self, repr: Repr, raw: u64) -> Val {
            self.0.constant(repr, raw)
        }
        fn prim(&mut self, op: PrimOp, repr: Repr, args: &[Val]) -> Val {
            if matches!(op, PrimOp::DivS | PrimOp::DivU | PrimOp::RemS | PrimOp::RemU) {
                assert_ne!(self.0.raw(args[1]), 0, "the divisor of {op:?}");
            }
            self.0.prim(op, repr, args)
        }
        fn check(&mut self, _: Val, fault: Fault, _: &[Val]) {
            panic!("{fault:?}");
        }
        fn call(&mut self, f: &'static RtFn, args: &[Val]) -> Val {
            self.0.call(f, args)
        }
        fn clock(&mut self) -> Option<Val> {
            None
        }
        fn checks_division(&self) -> bool {
            false
        }
    }
    for (op, elem) in [(Op::Div, Int), (Op::Mod, Int), (Op::Div, Ulint), (Op::Mod, Usint), (Op::TimeDiv, Int)] {
        for (b, is_zero) in [(0, true), (7, false)] {
            let mut e = Unchecked(Folder::new());
            let args = [e.0.value(100), e.0.value(b)];
            let v = emit(op, elem, &args, &mut e);
            assert_eq!(e.0.raw(v) == 0, is_zero, "{op:?} {elem:?}");
        }
    }
}

#[test]
fn what_may_fault_is_what_checks() {
    for op in ALL {
        for elem in elem::ALL.into_iter().filter(|elem| accepts(op, *elem)) {
            // Zero divisors and negative counts, whichever operand it is.
            let faults = [0, u64::MAX].iter().any(|raw| {
                let args: Vec<u64> = (0..op.arity()).map(|n| raw & op.operand(elem, n).mask()).collect();
                run(op, elem, &args).1.is_some()
            });
            assert_eq!(faults, may_fault(op, elem), "{op:?} {elem:?}");
        }
    }
}

#[test]
fn comparisons_order_by_type() {
    for (elem, less) in [(Sint, true), (Usint, false), (Byte, false), (Time, true), (Dt, true)] {
        let minus_one = elem.repr().mask();
        for (op, want) in
            [(Op::Lt, less), (Op::Le, less), (Op::Gt, !less), (Op::Ge, !less), (Op::Eq, false), (Op::Ne, true)]
        {
            assert_eq!(run(op, elem, &[minus_one, 1]).0, u64::from(want), "{op:?} {elem:?}");
        }
    }
    let nan = f64::NAN.to_bits();
    for op in [Op::Lt, Op::Le, Op::Gt, Op::Ge, Op::Eq] {
        assert_eq!(run(op, Lreal, &[nan, 0]).0, 0, "{op:?}");
    }
    assert_eq!(run(Op::Ne, Lreal, &[nan, nan]).0, 1);
    assert_eq!(run(Op::Max, Lreal, &[1f64.to_bits(), 2f64.to_bits()]).0, 2f64.to_bits());
    assert_eq!(run(Op::Min, Lreal, &[1f64.to_bits(), 2f64.to_bits()]).0, 1f64.to_bits());
    assert_eq!(run(Op::Sel, Int, &[0, 10, 20]).0, 10);
    assert_eq!(run(Op::Sel, Int, &[1, 10, 20]).0, 20);
}

#[test]
fn shifts_check_their_count() {
    assert_eq!(run(Op::Shl, Byte, &[0x81, 1]), (0x02, None));
    assert_eq!(run(Op::Shr, Word, &[0x8000, 15]), (1, None));
    assert_eq!(run(Op::Shr, Word, &[0x8000, 16]), (0, None));
    assert_eq!(run(Op::Shr, Int, &[0x8000, 15]), (1, None), "fills with zeros also in profile codesys");
    assert_eq!(run(Op::Rol, Byte, &[0x81, 9]), (0x03, None));
    assert_eq!(run(Op::Ror, Dword, &[1, 1]), (0x8000_0000, None));
    assert_eq!(run(Op::Shl, Byte, &[1, -3i64 as u64]).1, Some((Fault::NegativeShift, [-3, 0, 0])));
}

#[test]
fn durations_scale_to_the_nearest_nanosecond() {
    let div = |t: i64, d: i64| run(Op::TimeDiv, Lint, &[t as u64, d as u64]).0 as i64;
    assert_eq!(div(10, 4), 2, "2.5 to even");
    assert_eq!(div(14, 4), 4, "3.5 to even");
    assert_eq!(div(-10, 4), -2);
    assert_eq!(div(-14, 4), -4);
    assert_eq!(div(11, 4), 3);
    assert_eq!(div(9, -4), -2);
    assert_eq!(div(i64::MIN, -1), i64::MIN, "wraps");
    assert_eq!(div(i64::MIN, i64::MIN), 1);
    assert_eq!(div(i64::MAX, i64::MIN), -1);
    assert_eq!(run(Op::TimeDiv, Ulint, &[i64::MAX as u64, u64::MAX]).0, 0);
    assert_eq!(run(Op::TimeDiv, Sint, &[100, 0xFE]).0 as i64, -50);
    assert_eq!(run(Op::TimeMul, Usint, &[100, 0xFE]).0, 25_400);
    assert_eq!(run(Op::TimeMul, Sint, &[100, 0xFE]).0 as i64, -200);
    let real = |op, t: i64, x: f32| run(op, Real, &[t as u64, u64::from(x.to_bits())]).0 as i64;
    assert_eq!(real(Op::TimeMul, 5, 0.5), 2);
    assert_eq!(real(Op::TimeMul, 1_000_000_000, 1.5), 1_500_000_000);
    assert_eq!(real(Op::TimeDiv, 7, 2.0), 4);
    assert_eq!(real(Op::TimeDiv, 7, 0.0), i64::MAX);
    assert_eq!(real(Op::TimeDiv, 0, 0.0), 0);
}

#[test]
fn powers() {
    let p = |a: f64, b: f64| f64::from_bits(run(Op::Power, Lreal, &[a.to_bits(), b.to_bits()]).0);
    assert_eq!(p(0.0, 0.0), 1.0);
    assert_eq!(p(2.0, -2.0), 0.25);
    let s = run(Op::Power, Real, &[u64::from(3f32.to_bits()), u64::from(2f32.to_bits())]).0;
    assert_eq!(s, u64::from(9f32.to_bits()));
}

#[test]
fn mixed_forms_of_time_arithmetic() {
    let f = |op, l, r| time_forms(op, l, r).map(|f| f.result);
    assert_eq!(f(Op::Add, Time, Time), Some(Time));
    assert_eq!(f(Op::Add, Time, Ltime), Some(Ltime));
    assert_eq!(f(Op::Add, Dt, Time), Some(Dt));
    assert_eq!(f(Op::Add, Dt, Ltime), Some(Ldt));
    assert_eq!(f(Op::Sub, Tod, Time), Some(Tod));
    assert_eq!(f(Op::Sub, Date, Date), Some(Time));
    assert_eq!(f(Op::Sub, Ldt, Dt), Some(Ltime));
    assert_eq!(f(Op::Sub, Tod, Tod), Some(Time));
    assert_eq!(f(Op::Mul, Time, Int), Some(Time));
    assert_eq!(f(Op::Div, Ltime, Real), Some(Ltime));
    for (op, l, r) in
        [(Op::Add, Date, Time), (Op::Add, Date, Date), (Op::Mul, Time, Time), (Op::Sub, Date, Tod), (Op::Sub, Time, Dt)]
    {
        assert_eq!(f(op, l, r), None, "{op:?} {l:?} {r:?}");
    }
}

#[test]
fn every_accepted_form_is_well_typed() {
    // `Folder::prim` asserts that each operation is defined for its operands.
    for op in ALL {
        for elem in elem::ALL.into_iter().filter(|t| accepts(op, *t)) {
            let args = vec![1u64; op.arity()];
            let (raw, _) = run(op, elem, &args);
            assert_eq!(raw & !op.result(elem).mask(), 0, "{op:?} {elem:?}");
        }
    }
}
