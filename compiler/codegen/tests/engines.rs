//! Hand-made programs on both engines: every byte of the region must agree, and the results are known.

mod support;

use plcc_mir::build::Builder;
use plcc_mir::ir::{Base, BlockId, FuncId, IndexTerm, Place, SourceId, ValueId};
use plcc_stdlib::emit::{Emit, Val};
use plcc_stdlib::fault::Fault;
use plcc_stdlib::prim::{PrimOp, Repr};
use plcc_stdlib::region::{CLOCK_NS, FAULT_CODE, HEADER_BYTES};
use plcc_stdlib::rt::RtFn;
use support::{Engines, FRAME_BASE, check, global, program, segment, task};

fn func(n: u32) -> FuncId {
    FuncId::from_raw(n)
}

fn indexed(at: i64, terms: &[(ValueId, u32, i64, i64)]) -> Place {
    let index = terms.iter().map(|&(value, stride, low, high)| IndexTerm { value, stride, low, high }).collect();
    Place { base: Base::Region, offset: i64::from(HEADER_BYTES) + at, index, bit: None }
}

fn bit(at: u32, bit: u8) -> Place {
    Place { bit: Some(bit), ..global(at) }
}

/// FOR i := 0 TO n - 1 with the body given; `carried` are the other values of the loop.
fn count_up(
    b: &mut Builder,
    n: ValueId,
    start: &[ValueId],
    body: impl FnOnce(&mut Builder, ValueId, &[ValueId]) -> Vec<ValueId>,
) -> Vec<ValueId> {
    let (head, inside, done) = (b.block(), b.block(), b.block());
    let i = b.block_param(head, Repr::I64);
    let carried: Vec<ValueId> = start.iter().map(|v| b.block_param(head, b.repr(*v))).collect();
    let zero = b.number(Repr::I64, 0);
    b.jump(head, &[&[zero], start].concat());
    b.switch_to(head);
    let more = b.op(PrimOp::LtS, Repr::I64, &[i, n]);
    b.branch(more, inside, done);
    b.switch_to(inside);
    let next = body(b, i, &carried);
    let one = b.number(Repr::I64, 1);
    let i = b.op(PrimOp::Add, Repr::I64, &[i, one]);
    b.jump(head, &[&[i], &next[..]].concat());
    b.switch_to(done);
    carried
}

#[test]
fn loops_swap_their_values() {
    let mut b = task("fibonacci");
    let n = b.load(Repr::I64, global(0), false);
    let (x, y) = (b.number(Repr::I64, 0), b.number(Repr::I64, 1));
    let pair = count_up(&mut b, n, &[x, y], |b, _, v| vec![v[1], b.op(PrimOp::Add, Repr::I64, &[v[0], v[1]])]);
    b.store(global(8), pair[0]);
    // Pure exchange: two registers in a cycle.
    let (p, q, r) = (b.number(Repr::I32, 1), b.number(Repr::I32, 2), b.number(Repr::I32, 3));
    let turned = count_up(&mut b, n, &[p, q, r], |_, _, v| vec![v[1], v[2], v[0]]);
    for (k, v) in turned.iter().enumerate() {
        b.store(global(16 + 4 * k as u32), *v);
    }
    b.ret(None);
    let mut engines = Engines::new(&program(vec![b.finish(0)], 1));
    for (n, fibonacci, turned) in [(0u64, 0u64, [1u32, 2, 3]), (1, 1, [2, 3, 1]), (50, 12586269025, [3, 1, 2])] {
        engines.write(0, &n.to_le_bytes());
        assert_eq!(engines.scan(0, 0), 0);
        assert_eq!(u64::from_le_bytes(engines.read(8)), fibonacci);
        for (k, want) in turned.iter().enumerate() {
            assert_eq!(u32::from_le_bytes(engines.read(16 + 4 * k as u32)), *want);
        }
    }
}

#[test]
fn entry_block_as_target() {
    // The entry counts the global up and goes back to itself until it is 5.
    let mut b = task("again");
    let entry = BlockId::from_raw(0);
    let done = b.block();
    let old = b.load(Repr::I16, global(0), false);
    let one = b.number(Repr::I16, 1);
    let new = b.op(PrimOp::Add, Repr::I16, &[old, one]);
    b.store(global(0), new);
    let five = b.number(Repr::I16, 5);
    let less = b.op(PrimOp::LtS, Repr::I16, &[new, five]);
    b.branch(less, entry, done);
    b.switch_to(done);
    b.ret(None);
    let mut engines = Engines::new(&program(vec![b.finish(0)], 1));
    assert_eq!(engines.scan(0, 0), 0);
    assert_eq!(u16::from_le_bytes(engines.read(0)), 5);
}

/// f0(x: I32): x * 2 + instance.i32[0], counts calls in instance.i16[4], keeps x in its frame.
fn doubling() -> plcc_mir::ir::Func {
    let mut b = Builder::new("Double", &[Repr::I32], Some(Repr::I32), true);
    let x = b.params()[0];
    b.store(Place::new(Base::Frame, 4), x);
    let add = b.load(Repr::I32, Place::new(Base::Instance, 0), false);
    let count = b.load(Repr::I16, Place::new(Base::Instance, 4), false);
    let one = b.number(Repr::I16, 1);
    let count = b.op(PrimOp::Add, Repr::I16, &[count, one]);
    b.store(Place::new(Base::Instance, 4), count);
    let again = b.load(Repr::I32, Place::new(Base::Frame, 4), false);
    let sum = b.op(PrimOp::Add, Repr::I32, &[again, x]);
    let sum = b.op(PrimOp::Add, Repr::I32, &[sum, add]);
    b.ret(Some(sum));
    b.finish(16)
}

#[test]
fn calls_with_instances_and_frames() {
    // The caller's frame variable at 0 must survive the callee's at 4 of its own frame.
    let mut b = Builder::new("Middle", &[Repr::I32, Repr::F64], Some(Repr::F64), false);
    let (x, y) = (b.params()[0], b.params()[1]);
    b.store(Place::new(Base::Frame, 0), x);
    let first = b.call(func(0), Some(global(100)), &[x], Some(Repr::I32)).expect("a result");
    let kept = b.load(Repr::I32, Place::new(Base::Frame, 0), false);
    let second = b.call(func(0), Some(global(108)), &[kept], Some(Repr::I32)).expect("a result");
    let sum = b.op(PrimOp::Add, Repr::I32, &[first, second]);
    let real = b.op(PrimOp::SToF(Repr::F64), Repr::I32, &[sum]);
    let product = b.op(PrimOp::FMul, Repr::F64, &[real, y]);
    b.ret(Some(product));
    let middle = b.finish(48);
    let mut b = task("task Main");
    let x = b.load(Repr::I32, global(0), false);
    let half = b.number(Repr::F64, 0.5f64.to_bits());
    let result = b.call(func(1), None, &[x, half], Some(Repr::F64)).expect("a result");
    b.store(global(8), result);
    b.ret(None);
    let mut engines = Engines::new(&program(vec![doubling(), middle, b.finish(32)], 1));
    engines.write(0, &21i32.to_le_bytes());
    engines.write(100, &1i32.to_le_bytes());
    engines.write(108, &(-5i32).to_le_bytes());
    assert_eq!(engines.scan(0, 77), 0);
    assert_eq!(f64::from_le_bytes(engines.read(8)), 40.0);
    assert_eq!((i16::from_le_bytes(engines.read(104)), i16::from_le_bytes(engines.read(112))), (1, 1));
    // Frames: task 32 bytes, Middle 48, Double 16.
    let at = FRAME_BASE - HEADER_BYTES;
    assert_eq!(i32::from_le_bytes(engines.read(at + 32)), 21);
    assert_eq!(i32::from_le_bytes(engines.read(at + 32 + 48 + 4)), 21);
    assert_eq!(engines.left.read::<8>(CLOCK_NS), 77i64.to_le_bytes());
}

/// A function block that divides 100 by its argument after a check, and marks its way in its instance.
fn dividing(source: u32) -> plcc_mir::ir::Func {
    let mut b = Builder::new("Divide", &[Repr::I64], Some(Repr::I64), true);
    let x = b.params()[0];
    let one = b.number(Repr::I8, 1);
    b.store(Place::new(Base::Instance, 0), one);
    b.set_source(SourceId::from_raw(source));
    let zero = b.number(Repr::I64, 0);
    let ok = b.op(PrimOp::Ne, Repr::I64, &[x, zero]);
    let hundred = b.number(Repr::I64, 100);
    b.check_true(ok, Fault::DivisionByZero, &[hundred]);
    b.store(Place::new(Base::Instance, 1), one);
    let q = b.op(PrimOp::DivS, Repr::I64, &[hundred, x]);
    b.ret(Some(q));
    b.finish(0)
}

#[test]
fn uncaught_fault_leaves_all_callers() {
    let mut b = Builder::new("Middle", &[Repr::I64], Some(Repr::I64), false);
    let x = b.params()[0];
    let r = b.call(func(0), Some(global(32)), &[x], Some(Repr::I64)).expect("a result");
    let seven = b.number(Repr::I8, 7);
    b.store(global(41), seven);
    b.ret(Some(r));
    let middle = b.finish(0);
    let mut b = task("task Main");
    let x = b.load(Repr::I64, global(0), false);
    let r = b.call(func(1), None, &[x], Some(Repr::I64)).expect("a result");
    b.store(global(8), r);
    b.ret(None);
    let mut engines = Engines::new(&program(vec![dividing(42), middle, b.finish(0)], 1));
    engines.write(0, &(-3i64).to_le_bytes());
    assert_eq!(engines.scan(0, 0), 0);
    assert_eq!(i64::from_le_bytes(engines.read(8)), -33);
    engines.write(0, &0i64.to_le_bytes());
    engines.write(41, &[0]);
    engines.write(33, &[0]);
    assert_eq!(engines.scan(0, 5), Fault::DivisionByZero.number());
    assert_eq!(i64::from_le_bytes(engines.read(8)), -33, "the result was not stored");
    assert_eq!((engines.read(32), engines.read(33), engines.read(41)), ([1], [0], [0]));
    let header = engines.left.bytes()[..64].to_vec();
    let word = |at: usize| u32::from_le_bytes(*header[at..].first_chunk().expect("a word"));
    let long = |at: usize| i64::from_le_bytes(*header[at..].first_chunk().expect("a long word"));
    assert_eq!((word(4), word(16), word(20)), (1, 42, HEADER_BYTES + 32));
    assert_eq!((long(8), long(24), long(32), long(40)), (5, 100, 0, 0));
    // The next scan starts without a fault.
    engines.write(0, &4i64.to_le_bytes());
    assert_eq!(engines.scan(0, 0), 0);
    assert_eq!(engines.left.read::<4>(FAULT_CODE), [0; 4]);
    assert_eq!(i64::from_le_bytes(engines.read(8)), 25);
}

#[test]
fn caught_fault_sets_the_status() {
    let mut b = Builder::new("Middle", &[Repr::I64], Some(Repr::I64), false);
    let x = b.params()[0];
    let r = b.call(func(0), Some(global(32)), &[x], Some(Repr::I64)).expect("a result");
    b.ret(Some(r));
    let middle = b.finish(0);
    let mut b = task("task Main");
    let x = b.load(Repr::I64, global(0), false);
    let (r, status) = b.call_catching(func(1), None, &[x], Some(Repr::I64));
    b.store(global(8), r.expect("a result"));
    b.store(global(16), status);
    b.ret(None);
    let mut engines = Engines::new(&program(vec![dividing(3), middle, b.finish(0)], 1));
    for (x, result, status) in [(0i64, 0i64, 1u32), (10, 10, 0), (0, 0, 1)] {
        engines.write(0, &x.to_le_bytes());
        assert_eq!(engines.scan(0, 0), 0);
        assert_eq!(i64::from_le_bytes(engines.read(8)), result);
        assert_eq!(u32::from_le_bytes(engines.read(16)), status);
        assert_eq!(engines.left.read::<4>(FAULT_CODE), [0; 4]);
    }
}

#[test]
fn deadline_is_never_caught() {
    let mut b = Builder::new("Spin", &[], None, false);
    b.set_source(SourceId::from_raw(9));
    let head = b.block();
    b.jump(head, &[]);
    b.switch_to(head);
    let n = b.load(Repr::I32, global(0), false);
    let one = b.number(Repr::I32, 1);
    let n = b.op(PrimOp::Add, Repr::I32, &[n, one]);
    b.store(global(0), n);
    b.poll();
    b.jump(head, &[]);
    let spin = b.finish(0);
    let mut b = task("task Main");
    let (_, status) = b.call_catching(func(0), None, &[], None);
    b.store(global(8), status);
    b.ret(None);
    let program = program(vec![spin, b.finish(0)], 1);
    let mut engines = Engines::new(&program);
    engines.left.write(0, &1u32.to_le_bytes());
    engines.right.write(0, &1u32.to_le_bytes());
    assert_eq!(engines.scan(0, 0), Fault::Deadline.number());
    assert_eq!(u32::from_le_bytes(engines.read(0)), 1);
    assert_eq!(u32::from_le_bytes(engines.read(8)), 0, "nothing runs after the call");
    assert_eq!(engines.left.read::<4>(16), 9u32.to_le_bytes());

    // The flag comes from another thread while the loop runs.
    for interp in [true, false] {
        engines.init(true);
        let region = if interp { &mut engines.left } else { &mut engines.right };
        let flag = region.bytes().as_mut_ptr() as usize;
        std::thread::scope(|scope| {
            scope.spawn(move || {
                std::thread::sleep(std::time::Duration::from_millis(20));
                // SAFETY: the flag lies in a region that outlives the scope; the engines read it atomically.
                unsafe { std::sync::atomic::AtomicU32::from_ptr(flag as *mut u32) }
                    .store(1, std::sync::atomic::Ordering::Relaxed);
            });
            let status = if interp {
                engines.interp.scan(engines.left.bytes(), 0, 0)
            } else {
                engines.jit.scan(engines.right.bytes(), 0, 0)
            };
            assert_eq!(status, Fault::Deadline.number());
        });
    }
}

#[test]
fn index_check_reports_value_and_bounds() {
    // a: ARRAY[-3..4] OF INT at 16, a[i] := a[i] + 1
    let mut b = task("task Main");
    b.set_source(SourceId::from_raw(8));
    let i = b.load(Repr::I16, global(0), false);
    let i = b.op(PrimOp::Sext(Repr::I64), Repr::I16, &[i]);
    b.check_within(i, -3, 4, Fault::IndexOutOfBounds);
    let place = indexed(16 + 3 * 2, &[(i, 2, -3, 4)]);
    let old = b.load(Repr::I16, place.clone(), false);
    let one = b.number(Repr::I16, 1);
    let new = b.op(PrimOp::Add, Repr::I16, &[old, one]);
    b.store(place, new);
    b.ret(None);
    let mut engines = Engines::new(&program(vec![b.finish(0)], 1));
    for i in -3i16..=4 {
        engines.write(0, &i.to_le_bytes());
        assert_eq!(engines.scan(0, 0), 0);
        assert_eq!(i16::from_le_bytes(engines.read((16 + (i + 3) * 2) as u32)), 1);
    }
    for i in [-4i16, 5, i16::MAX, i16::MIN] {
        engines.write(0, &i.to_le_bytes());
        assert_eq!(engines.scan(0, 0), Fault::IndexOutOfBounds.number());
        let operands: Vec<i64> = (0..3).map(|n| i64::from_le_bytes(engines.left.read(24 + 8 * n))).collect();
        assert_eq!(operands, [i64::from(i), -3, 4]);
    }
    let extreme = [(i64::MIN, i64::MAX), (i64::MIN, 0), (0, i64::MAX), (i64::MAX, i64::MAX), (-1, -1)];
    for (low, high) in extreme {
        let mut b = task("task Main");
        let i = b.load(Repr::I64, global(0), false);
        b.check_within(i, low, high, Fault::SubrangeViolation);
        b.ret(None);
        let mut engines = Engines::new(&program(vec![b.finish(0)], 1));
        for i in [i64::MIN, i64::MIN + 1, -2, -1, 0, 1, i64::MAX - 1, i64::MAX] {
            engines.write(0, &i.to_le_bytes());
            let want = if (low..=high).contains(&i) { 0 } else { Fault::SubrangeViolation.number() };
            assert_eq!(engines.scan(0, 0), want, "{i} in {low}..{high}");
        }
    }
}

#[test]
fn places_of_several_indices_and_strides() {
    // m: ARRAY[1..3, -1..2] OF STRUCT 12 bytes, with a field at 4: m[i, j].f := i * 10 + j
    let mut b = task("task Main");
    let three = b.number(Repr::I64, 3);
    count_up(&mut b, three, &[], |b, i, _| {
        let one = b.number(Repr::I64, 1);
        let i = b.op(PrimOp::Add, Repr::I64, &[i, one]);
        let four = b.number(Repr::I64, 4);
        count_up(b, four, &[], |b, j, _| {
            let j = b.op(PrimOp::Sub, Repr::I64, &[j, one]);
            let ten = b.number(Repr::I64, 10);
            let v = b.op(PrimOp::Mul, Repr::I64, &[i, ten]);
            let v = b.op(PrimOp::Add, Repr::I64, &[v, j]);
            let v = b.op(PrimOp::Wrap(Repr::I32), Repr::I64, &[v]);
            let at = 4 - 48 + 12;
            b.store(indexed(at, &[(i, 48, 1, 3), (j, 12, -1, 2)]), v);
            vec![]
        });
        vec![]
    });
    b.ret(None);
    let mut engines = Engines::new(&program(vec![b.finish(0)], 1));
    assert_eq!(engines.scan(0, 0), 0);
    for i in 1..=3i32 {
        for j in -1..=2i32 {
            let at = (i - 1) * 48 + (j + 1) * 12 + 4;
            assert_eq!(i32::from_le_bytes(engines.read(at as u32)), i * 10 + j);
        }
    }
}

#[test]
fn lower_bounds_far_away() {
    // ARRAY[3000000000..3000000003] OF LINT: the constant part does not fit 32 bits.
    let low = 3_000_000_000i64;
    let mut b = task("task Main");
    let i = b.load(Repr::I64, global(0), false);
    b.check_within(i, low, low + 3, Fault::IndexOutOfBounds);
    b.store(indexed(64 - low * 8, &[(i, 8, low, low + 3)]), i);
    let address = b.address_of(indexed(64 - low * 8, &[(i, 8, low, low + 3)]), 0);
    b.store(global(8), address);
    b.ret(None);
    let mut engines = Engines::new(&program(vec![b.finish(0)], 1));
    engines.write(0, &(low + 2).to_le_bytes());
    assert_eq!(engines.scan(0, 0), 0);
    assert_eq!(i64::from_le_bytes(engines.read(80)), low + 2);
    assert_eq!(u32::from_le_bytes(engines.read(8)), HEADER_BYTES + 80);
}

#[test]
fn bits_and_truth_values() {
    let mut b = task("task Main");
    let dirty = b.load(Repr::I8, global(0), true);
    b.store(global(1), dirty);
    let x = b.load(Repr::I8, bit(2, 7), false);
    let y = b.load(Repr::I8, bit(2, 0), false);
    b.store(bit(3, 0), x);
    b.store(bit(3, 7), y);
    let not = b.not(x);
    b.store(bit(3, 4), not);
    b.store(global(4), x);
    b.ret(None);
    let mut engines = Engines::new(&program(vec![b.finish(0)], 1));
    for (dirty, bits, truth, after) in [(0x80u8, 0x80u8, 1u8, 0x6Fu8), (0, 0x01, 0, 0xFE), (2, 0, 1, 0x7E)] {
        engines.write(0, &[dirty, 0, bits, 0xFF]);
        assert_eq!(engines.scan(0, 0), 0);
        assert_eq!(engines.read(1), [truth]);
        assert_eq!(engines.read(3), [after]);
        assert_eq!(engines.read(4), [bits >> 7]);
    }
}

#[test]
fn copies_overlap() {
    for bytes in [1u32, 2, 3, 7, 8, 9, 15, 24, 31, 63, 64, 65, 100, 300] {
        for (from, to) in [(400u32, 401u32), (401, 400), (400, 407), (407, 400), (400, 432), (400, 1000), (400, 400)] {
            let mut b = task("task Main");
            b.copy(global(to), global(from), bytes);
            b.ret(None);
            let mut engines = Engines::new(&program(vec![b.finish(0)], 1));
            let mut want: Vec<u8> = (0..2000u32).map(|n| (n * 7 + n / 256) as u8).collect();
            engines.write(0, &want);
            assert_eq!(engines.scan(0, 0), 0);
            want.copy_within(from as usize..(from + bytes) as usize, to as usize);
            assert_eq!(&engines.left.bytes()[64..2064], &want[..], "{bytes} bytes from {from} to {to}");
        }
    }
}

#[test]
fn zero_clears_exactly() {
    for bytes in [1u32, 3, 8, 17, 63, 64, 65, 500] {
        let mut b = task("task Main");
        b.zero(global(101), bytes);
        b.ret(None);
        let mut engines = Engines::new(&program(vec![b.finish(0)], 1));
        engines.write(0, &[0xEE; 1000]);
        assert_eq!(engines.scan(0, 0), 0);
        let got = engines.left.bytes()[64..1064].to_vec();
        assert!((0..1000).all(|n| (got[n] == 0) == (101..101 + bytes as usize).contains(&n)), "{bytes}");
    }
}

#[test]
fn references() {
    // p := REF(a[2]); p^ := p^ + 1, through an unaligned one too; an aggregate copied through references.
    for offset in [16u32, 17] {
        let mut b = task("task Main");
        let p = b.address_of(global(offset), 0);
        b.store(global(0), p);
        let p = b.load(Repr::I32, global(0), false);
        let place = Place::new(Base::Reference(p), 4);
        let old = b.load(Repr::F32, place.clone(), false);
        let one = b.number(Repr::F32, u64::from(1f32.to_bits()));
        let new = b.op(PrimOp::FAdd, Repr::F32, &[old, one]);
        b.store(place.clone(), new);
        b.copy(global(200), Place::new(Base::Reference(p), 0), 80);
        b.zero(Place::new(Base::Reference(p), 8), 3);
        let again = b.address_of(place, 0);
        b.store(global(4), again);
        b.ret(None);
        let mut engines = Engines::new(&program(vec![b.finish(0)], 1));
        engines.write(0, &[0x41; 300]);
        let before = f32::from_le_bytes([0x41; 4]);
        assert_eq!(engines.scan(0, 0), 0);
        assert_eq!(f32::from_le_bytes(engines.read(offset + 4)), before + 1.0);
        assert_eq!(f32::from_le_bytes(engines.read(204)), before + 1.0);
        assert_eq!(engines.read(offset + 8), [0, 0, 0, 0x41]);
        assert_eq!(u32::from_le_bytes(engines.read(4)), HEADER_BYTES + offset + 4);
    }
}

#[test]
fn choices() {
    let sparse = [0u64, 1, 2, 3, 4, 5, 100, 101, 0x8000, 0xFFFF];
    for labels in [&sparse[..1], &sparse[..3], &sparse[..6], &sparse[..]] {
        let mut b = task("task Main");
        let x = b.load(Repr::I16, global(0), false);
        let arms: Vec<(u64, BlockId)> = labels.iter().map(|l| (*l, b.block())).collect();
        let (other, join) = (b.block(), b.block());
        let result = b.block_param(join, Repr::I32);
        b.switch(x, &arms, other);
        for (n, (_, arm)) in arms.iter().enumerate() {
            b.switch_to(*arm);
            let n = b.number(Repr::I32, n as u64 + 1);
            b.jump(join, &[n]);
        }
        b.switch_to(other);
        let none = b.number(Repr::I32, 0);
        b.jump(join, &[none]);
        b.switch_to(join);
        b.store(global(4), result);
        b.ret(None);
        let mut engines = Engines::new(&program(vec![b.finish(0)], 1));
        for x in [0u16, 1, 2, 3, 4, 5, 6, 99, 100, 101, 102, 0x7FFF, 0x8000, 0x8001, 0xFFFE, 0xFFFF] {
            engines.write(0, &x.to_le_bytes());
            assert_eq!(engines.scan(0, 0), 0);
            let want = labels.iter().position(|l| *l == u64::from(x)).map_or(0, |n| n as u32 + 1);
            assert_eq!(u32::from_le_bytes(engines.read(4)), want, "{x} of {labels:?}");
        }
    }
}

#[test]
fn choice_with_arguments() {
    use plcc_mir::ir::{Target, Term};
    for count in [2u64, 9] {
        let mut b = task("task Main");
        let x = b.load(Repr::I8, global(0), false);
        let join = b.block();
        let result = b.block_param(join, Repr::I8);
        let numbers: Vec<ValueId> = (0..=count).map(|n| b.number(Repr::I8, 50 + n)).collect();
        b.jump(join, &[x]);
        b.switch_to(join);
        b.store(global(1), result);
        b.ret(None);
        let mut func = b.finish(0);
        let target = |v: ValueId| Target { block: BlockId::from_raw(1), args: vec![v] };
        // Values keep their numbers in a function without unreachable blocks and with definitions in order.
        func.blocks[0].term = Term::Switch {
            value: x,
            cases: (0..count).map(|n| (n * 3, target(numbers_after(&func, n)))).collect(),
            default: target(x),
        };
        assert_eq!(numbers.len(), count as usize + 1);
        let mut engines = Engines::new(&program(vec![func], 1));
        for x in 0..30u8 {
            engines.write(0, &[x]);
            assert_eq!(engines.scan(0, 0), 0);
            let hit = x % 3 == 0 && u64::from(x) < count * 3;
            assert_eq!(engines.read(1), [if hit { 50 + x / 3 } else { x }]);
        }
    }
}

/// The value of the constant 50 + n.
fn numbers_after(func: &plcc_mir::ir::Func, n: u64) -> ValueId {
    let found = func.blocks.iter().flat_map(|b| &b.insts).find_map(|inst| match inst {
        plcc_mir::ir::Inst::Const { dst, raw } if *raw == 50 + n => Some(*dst),
        _ => None,
    });
    found.expect("the constant")
}

#[test]
fn standard_library_bodies() {
    let mut b = task("task Main");
    let x = b.load(Repr::F32, global(0), false);
    let y = b.load(Repr::F64, global(8), false);
    let sin = plcc_stdlib::rt::find("sinf").expect("sinf");
    let pow = plcc_stdlib::rt::find("pow").expect("pow");
    let s = call_rt(&mut b, sin, &[x]);
    let p = call_rt(&mut b, pow, &[y, y]);
    b.store(global(16), s);
    b.store(global(24), p);
    b.ret(None);
    let mut engines = Engines::new(&program(vec![b.finish(0)], 1));
    for v in [0.0f64, 0.5, -1.0, 2.75, 1e6] {
        engines.write(0, &(v as f32).to_le_bytes());
        engines.write(8, &v.to_le_bytes());
        assert_eq!(engines.scan(0, 0), 0);
        assert!((f32::from_le_bytes(engines.read(16)) - (v as f32).sin()).abs() < 1e-6);
    }
    engines.write(8, &2.0f64.to_le_bytes());
    engines.scan(0, 0);
    assert_eq!(f64::from_le_bytes(engines.read(24)), 4.0);
}

fn call_rt(b: &mut Builder, f: &'static RtFn, args: &[ValueId]) -> ValueId {
    let args: Vec<Val> = args.iter().map(|v| Val(v.raw())).collect();
    ValueId::from_raw(Emit::call(b, f, &args).0)
}

#[test]
fn cold_and_warm_start() {
    let mut b = task("task Main");
    b.zero(global(0), 200);
    b.ret(None);
    let mut program = program(vec![b.finish(0)], 1);
    program.initial = vec![segment(64, &[1; 20]), segment(100, &[2; 8]), segment(130, &[3])];
    program.retain = vec![(70, 4), (80, 30), (120, 8)];
    check(&program);
    let mut engines = Engines::new(&program);
    let cold = engines.left.bytes().to_vec();
    for (n, byte) in cold.iter().enumerate() {
        let want = match n {
            64..84 => 1,
            100..108 => 2,
            130 => 3,
            _ => 0,
        };
        assert_eq!(*byte, want, "byte {n}");
    }
    engines.left.bytes().fill(9);
    engines.right.bytes().fill(9);
    engines.init(false);
    let warm = engines.left.bytes().to_vec();
    for n in 0..warm.len() {
        let kept = program.retain.iter().any(|(start, length)| (*start..start + length).contains(&(n as u32)));
        assert_eq!(warm[n], if kept { 9 } else { cold[n] }, "byte {n}");
    }
    engines.init(true);
    assert_eq!(engines.left.bytes(), &cold[..]);
}

#[test]
fn unknown_task_does_nothing() {
    let mut b = task("task Main");
    let one = b.number(Repr::I8, 1);
    b.store(global(0), one);
    b.ret(None);
    let mut engines = Engines::new(&program(vec![b.finish(0)], 1));
    assert_eq!(engines.scan(1, 99), 0);
    assert_eq!(engines.scan(u32::MAX, 99), 0);
    assert!(engines.left.bytes().iter().all(|b| *b == 0));
    let mut engines = Engines::new(&program(vec![], 0));
    assert_eq!(engines.scan(0, 1), 0);
}
