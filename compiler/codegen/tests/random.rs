//! Random programs from a seed: interpreter and native code must leave the same region, faults and all, and so must the
//! interpreter before and after each pass of the optimiser.
//!
//! `PLCC_SEED=n` runs one program and prints it when it fails; `PLCC_PROGRAMS=n` runs more than usual.

#[path = "../../../tests/src/memory.rs"]
#[allow(dead_code)]
mod memory;
#[path = "../../../tests/src/passes.rs"]
#[allow(dead_code)]
mod passes;
mod support;

use plcc_mir::build::Builder;
use plcc_mir::ir::{Base, BlockId, FuncId, IndexTerm, Place, Program, SourceId, ValueId};
use plcc_stdlib::prim::{PrimOp, Repr};
use plcc_stdlib::region::HEADER_BYTES;
use support::{Engines, FRAME_BASE, program};

const FUNCS: usize = 5;
const FRAME_BYTES: u32 = 64;
/// Globals lie behind the header, up to here.
const GLOBALS_END: u32 = 2048;
const INSTANCE_BYTES: u32 = 64;

struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    fn below(&mut self, n: u64) -> u64 {
        (self.next() >> 20) % n
    }

    fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len() as u64) as usize]
    }

    fn chance(&mut self, percent: u64) -> bool {
        self.below(100) < percent
    }
}

/// What a function looks like to its callers.
#[derive(Clone)]
struct Callee {
    params: Vec<Repr>,
    result: Option<Repr>,
    has_instance: bool,
}

struct Generator<'r> {
    random: &'r mut Random,
    b: Builder,
    has_instance: bool,
    callees: Vec<Callee>,
    /// Values that may be used here.
    pool: Vec<ValueId>,
    loops: u32,
    calls: u32,
}

impl Generator<'_> {
    fn constant(&mut self, repr: Repr) -> ValueId {
        let raw = match (repr, self.random.below(4)) {
            (Repr::F32, _) => {
                let v = [0.0f32, -0.0, 1.0, -2.5, 1e9, 3e38, f32::INFINITY, 0.1][self.random.below(8) as usize];
                u64::from(v.to_bits())
            }
            (Repr::F64, _) => {
                [0.0f64, -0.0, 1.0, -2.5, 1e19, 1e308, f64::NEG_INFINITY, 0.1][self.random.below(8) as usize].to_bits()
            }
            (_, 0) => self.random.below(5),
            (_, 1) => u64::MAX - self.random.below(5),
            (_, 2) => 1 << self.random.below(64),
            _ => self.random.next(),
        };
        self.b.number(repr, raw & repr.mask())
    }

    fn value(&mut self, repr: Repr) -> ValueId {
        let fitting: Vec<ValueId> = self.pool.iter().copied().filter(|v| self.b.repr(*v) == repr).collect();
        if fitting.is_empty() || self.random.chance(15) {
            let v = self.constant(repr);
            self.pool.push(v);
            return v;
        }
        // Recent ones more often.
        let n = fitting.len() as u64;
        let back = self.random.below(n).min(self.random.below(n));
        fitting[(n - 1 - back) as usize]
    }

    fn truth(&mut self) -> ValueId {
        let repr = self.random.pick(&Repr::ALL);
        let ops = if repr.is_int() {
            [PrimOp::Eq, PrimOp::Ne, PrimOp::LtS, PrimOp::LeS, PrimOp::LtU, PrimOp::LeU]
        } else {
            [PrimOp::FEq, PrimOp::FNe, PrimOp::FLt, PrimOp::FLe, PrimOp::FLt, PrimOp::FNe]
        };
        let (x, y) = (self.value(repr), self.value(repr));
        let op = self.random.pick(&ops);
        self.b.op(op, repr, &[x, y])
    }

    /// A NaN may have any sign and payload: made one and the same, so that bytes can be compared.
    fn settle(&mut self, v: ValueId) -> ValueId {
        let repr = self.b.repr(v);
        let nan = match repr {
            Repr::F32 => u64::from(f32::NAN.to_bits()),
            Repr::F64 => f64::NAN.to_bits(),
            _ => return v,
        };
        let nan = self.b.number(repr, nan);
        let is_number = self.b.op(PrimOp::FEq, repr, &[v, v]);
        self.b.op(PrimOp::Select, repr, &[is_number, v, nan])
    }

    fn index(&mut self) -> IndexTerm {
        let repr = self.random.pick(&[Repr::I64, Repr::I64, Repr::I32, Repr::I8]);
        let v = self.value(repr);
        let v = self.b.resize(v, true, Repr::I64);
        let seven = self.b.number(Repr::I64, 7);
        let v = self.b.op(PrimOp::And, Repr::I64, &[v, seven]);
        let low = self.random.pick(&[0i64, 0, 1, -3]);
        let shift = self.b.number(Repr::I64, low as u64);
        let value = self.b.op(PrimOp::Add, Repr::I64, &[v, shift]);
        let stride = self.random.pick(&[1u32, 2, 3, 4, 8, 12, 16, 40]);
        IndexTerm { value, stride, low, high: low + 7 }
    }

    /// A place for so many bytes; no reference into frames, which the callers of a function do not know.
    fn place(&mut self, bytes: u32) -> Place {
        let (base, first, end) = match self.random.below(10) {
            0..5 => (Base::Region, HEADER_BYTES, GLOBALS_END),
            5..7 if self.has_instance => (Base::Instance, 0, INSTANCE_BYTES),
            7..9 => (Base::Frame, 0, FRAME_BYTES),
            _ => {
                let offset = HEADER_BYTES + self.random.below(512) as u32;
                let reference = if self.random.chance(50) {
                    self.b.address_of(Place::new(Base::Region, offset), 0)
                } else {
                    self.b.number(Repr::I32, u64::from(offset))
                };
                (Base::Reference(reference), 0, 512)
            }
        };
        let mut place = Place::new(base, 0);
        let mut size = bytes;
        if self.random.chance(30) {
            for _ in 0..1 + self.random.below(2) {
                let term = self.index();
                if first + size + 7 * term.stride <= end {
                    size += 7 * term.stride;
                    place.offset -= term.low * i64::from(term.stride);
                    place.index.push(term);
                }
            }
        }
        place.offset += i64::from(first) + self.random.below(u64::from(end - first - size) + 1) as i64;
        place
    }

    fn bit_place(&mut self) -> Place {
        let bit = Some(self.random.below(8) as u8);
        Place { bit, ..self.place(1) }
    }

    fn operation(&mut self) {
        use PrimOp::*;
        let repr = self.random.pick(&[Repr::I8, Repr::I16, Repr::I32, Repr::I64, Repr::I64, Repr::F32, Repr::F64]);
        let target = self.random.pick(&Repr::ALL);
        let op = self.random.pick(&[
            Add,
            Sub,
            Mul,
            MulHiS,
            MulHiU,
            DivS,
            DivU,
            RemS,
            RemU,
            Neg,
            And,
            Or,
            Xor,
            Not,
            Shl,
            ShrU,
            ShrS,
            Rotl,
            Rotr,
            MinS,
            MinU,
            MaxS,
            MaxU,
            Eq,
            Ne,
            LtS,
            LeS,
            LtU,
            LeU,
            FAdd,
            FSub,
            FMul,
            FDiv,
            FNeg,
            FAbs,
            FSqrt,
            FCeil,
            FFloor,
            FTrunc,
            FNearest,
            FEq,
            FNe,
            FLt,
            FLe,
            Select,
            FPromote,
            FDemote,
            FBits,
            BitsF,
            Zext(target),
            Sext(target),
            Wrap(target),
            SToF(target),
            UToF(target),
            FToS(target),
            FToU(target),
        ]);
        let kind = match op {
            SToF(_) | UToF(_) => !target.is_int(),
            FToS(_) | FToU(_) => target.is_int(),
            _ => true,
        };
        if !kind || !op.accepts(repr) {
            return;
        }
        let by_constant = matches!(op, DivS | DivU | RemS | RemU) && self.random.chance(50);
        let args: Vec<ValueId> = (0..op.arity())
            .map(|n| match (op, n) {
                (Select, 0) => self.truth(),
                (_, 1) if by_constant => self.constant(repr),
                _ => self.value(op.operand(repr, n)),
            })
            .collect();
        let v = self.b.op(op, repr, &args);
        let v = self.settle(v);
        self.pool.push(v);
    }

    fn memory(&mut self) {
        let repr = self.random.pick(&Repr::ALL);
        match self.random.below(10) {
            0..3 => {
                let place = self.place(repr.bytes());
                let v = self.b.load(repr, place, false);
                let v = self.settle(v);
                self.pool.push(v);
            }
            3..6 => {
                let (place, v) = (self.place(repr.bytes()), self.value(repr));
                self.b.store(place, v);
            }
            6 => {
                let place = self.place(1);
                let v = self.b.load(Repr::I8, place, true);
                self.pool.push(v);
            }
            7 => {
                let (place, other) = (self.bit_place(), self.bit_place());
                let v = self.b.load(Repr::I8, place, false);
                self.b.store(other, v);
            }
            8 => {
                let bytes = 1 + self.random.below(48) as u32;
                let (dst, src) = (self.place(bytes), self.place(bytes));
                self.b.copy(dst, src, bytes);
            }
            _ => {
                let bytes = 1 + self.random.below(48) as u32;
                let dst = self.place(bytes);
                self.b.zero(dst, bytes);
            }
        }
    }

    fn check(&mut self) {
        self.b.set_source(SourceId::from_raw(self.random.below(100) as u32));
        let fault = self.random.pick(&plcc_stdlib::fault::ALL);
        if self.random.chance(40) {
            // Bounds that the value keeps, or just not.
            let term = self.index();
            let (low, high) = self.random.pick(&[(0, 0), (0, 0), (0, 3), (-1, 0), (0, 1), (0, -1), (1, 0)]);
            self.b.check_within(term.value, term.low + low, term.high + high, fault);
        } else if self.random.chance(50) {
            let v = self.value(Repr::I64);
            let (low, high) = self.random.pick(&[(i64::MIN, 100), (-5, i64::MAX), (0, i64::MAX), (-1000, 1 << 40)]);
            self.b.check_within(v, low, high, fault);
        } else {
            let (x, y) = (self.truth(), self.truth());
            let either = self.b.op(PrimOp::Or, Repr::I8, &[x, y]);
            let operands: Vec<ValueId> = (0..self.random.below(4)).map(|_| self.value(Repr::I64)).collect();
            self.b.check_true(either, fault, &operands);
        }
    }

    fn branch(&mut self, depth: u32) {
        let (then, otherwise, join) = (self.b.block(), self.b.block(), self.b.block());
        let repr = self.random.pick(&Repr::ALL);
        let cond = self.truth();
        self.b.branch(cond, then, otherwise);
        let result = self.b.block_param(join, repr);
        for block in [then, otherwise] {
            self.arm(block, join, &[repr], depth);
        }
        self.b.switch_to(join);
        self.pool.push(result);
    }

    fn choice(&mut self, depth: u32) {
        let repr = self.random.pick(&[Repr::I8, Repr::I16, Repr::I32, Repr::I64]);
        let selector = self.value(repr);
        let small = self.b.number(repr, 7);
        let selector = self.b.op(PrimOp::And, repr, &[selector, small]);
        let arms: Vec<BlockId> = (0..1 + self.random.below(7)).map(|_| self.b.block()).collect();
        let (other, join) = (self.b.block(), self.b.block());
        let reprs = [Repr::I64, Repr::F32];
        let results = reprs.map(|r| self.b.block_param(join, r));
        let cases: Vec<(u64, BlockId)> = arms.iter().enumerate().map(|(n, b)| (n as u64, *b)).collect();
        self.b.switch(selector, &cases, other);
        for block in arms.into_iter().chain([other]) {
            self.arm(block, join, &reprs, depth.saturating_sub(1));
        }
        self.b.switch_to(join);
        self.pool.extend(results);
    }

    /// Fills a block that goes on to `join`; what it defines is not visible behind it.
    fn arm(&mut self, block: BlockId, join: BlockId, reprs: &[Repr], depth: u32) {
        let visible = self.pool.len();
        self.b.switch_to(block);
        self.statements(depth);
        let args: Vec<ValueId> = reprs.iter().map(|r| self.value(*r)).collect();
        self.b.jump(join, &args);
        self.pool.truncate(visible);
    }

    fn counted_loop(&mut self, depth: u32) {
        let (head, body, done) = (self.b.block(), self.b.block(), self.b.block());
        // Few kinds, so that values of one kind change places.
        let kinds = [self.random.pick(&Repr::ALL), self.random.pick(&Repr::ALL)];
        let reprs: Vec<Repr> = (0..self.random.below(6)).map(|_| self.random.pick(&kinds)).collect();
        let start: Vec<ValueId> = reprs.iter().map(|r| self.value(*r)).collect();
        // Mostly so short that nothing is left of the loop, sometimes so long that several passes become one.
        let most = if self.loops == 0 && self.random.chance(20) { 40 } else { 4 };
        let count = self.b.number(Repr::I8, 1 + self.random.below(most));
        self.b.jump(head, &[&[count], &start[..]].concat());
        let left = self.b.block_param(head, Repr::I8);
        let carried: Vec<ValueId> = reprs.iter().map(|r| self.b.block_param(head, *r)).collect();
        self.b.switch_to(head);
        self.pool.push(left);
        self.pool.extend(&carried);
        let zero = self.b.number(Repr::I8, 0);
        let more = self.b.op(PrimOp::Ne, Repr::I8, &[left, zero]);
        self.b.branch(more, body, done);
        self.b.switch_to(body);
        let outside = self.pool.len();
        self.loops += 1;
        self.statements(depth);
        self.loops -= 1;
        // Often the carried values in another order: parallel moves with cycles.
        let next: Vec<ValueId> = reprs
            .iter()
            .map(|r| {
                let same: Vec<ValueId> = carried.iter().copied().filter(|v| self.b.repr(*v) == *r).collect();
                if r.is_int() && self.random.chance(40) {
                    let step = self.random.pick(&[1, 1, 2, 5, u64::MAX, u64::MAX - 2, 100]);
                    let step = self.b.number(*r, step);
                    let from = self.random.pick(&same);
                    return self.b.op(PrimOp::Add, *r, &[from, step]);
                }
                if self.random.chance(50) { self.random.pick(&same) } else { self.value(*r) }
            })
            .collect();
        if self.random.chance(50) {
            self.b.poll();
        }
        let one = self.b.number(Repr::I8, 1);
        let fewer = self.b.op(PrimOp::Sub, Repr::I8, &[left, one]);
        self.b.jump(head, &[&[fewer], &next[..]].concat());
        self.pool.truncate(outside);
        self.b.switch_to(done);
    }

    /// Blocks that go to each other at will, with two ways in: a graph that is not made of loops. It ends when its fuel does.
    fn tangle(&mut self) {
        let repr = self.random.pick(&Repr::ALL);
        let blocks: Vec<BlockId> = (0..2 + self.random.below(4)).map(|_| self.b.block()).collect();
        let params: Vec<[ValueId; 2]> =
            blocks.iter().map(|b| [self.b.block_param(*b, Repr::I8), self.b.block_param(*b, repr)]).collect();
        let exit = self.b.block();
        let result = self.b.block_param(exit, repr);
        let outside = self.pool.len();
        let fuel = self.b.number(Repr::I8, 2 + self.random.below(7));
        let (first, second) = (self.b.block(), self.b.block());
        let cond = self.truth();
        self.b.branch(cond, first, second);
        for (n, edge) in [first, second].into_iter().enumerate() {
            self.b.switch_to(edge);
            let value = self.value(repr);
            self.b.jump(blocks[n], &[fuel, value]);
            self.pool.truncate(outside);
        }
        self.loops += 2;
        for (block, [fuel, carried]) in blocks.iter().zip(params) {
            self.b.switch_to(*block);
            self.pool.extend([fuel, carried]);
            self.statements(0);
            let (one, zero) = (self.b.number(Repr::I8, 1), self.b.number(Repr::I8, 0));
            let fewer = self.b.op(PrimOp::Sub, Repr::I8, &[fuel, one]);
            let done = self.b.op(PrimOp::Eq, Repr::I8, &[fuel, zero]);
            let (leave, go) = (self.b.block(), self.b.block());
            self.b.branch(done, leave, go);
            let inside = self.pool.len();
            self.b.switch_to(leave);
            let last = self.value(repr);
            self.b.jump(exit, &[last]);
            self.pool.truncate(inside);
            self.b.switch_to(go);
            if self.random.chance(50) {
                self.b.poll();
            }
            let selector = self.value(Repr::I16);
            let three = self.b.number(Repr::I16, 3);
            let selector = self.b.op(PrimOp::And, Repr::I16, &[selector, three]);
            let edges: Vec<BlockId> = (0..3).map(|_| self.b.block()).collect();
            self.b.switch(selector, &[(0, edges[0]), (2, edges[1])], edges[2]);
            let inside = self.pool.len();
            for edge in edges {
                self.b.switch_to(edge);
                let value = self.value(repr);
                let to = self.random.pick(&blocks);
                self.b.jump(to, &[fewer, value]);
                self.pool.truncate(inside);
            }
            self.pool.truncate(outside);
        }
        self.loops -= 2;
        self.b.switch_to(exit);
        self.pool.push(result);
    }

    fn call(&mut self) {
        if self.calls == 0 || self.loops > 1 || self.callees.is_empty() {
            return;
        }
        self.calls -= 1;
        let n = self.random.below(self.callees.len() as u64);
        let callee = self.callees[n as usize].clone();
        let args: Vec<ValueId> = callee.params.iter().map(|r| self.value(*r)).collect();
        let instance = callee.has_instance.then(|| self.place(INSTANCE_BYTES));
        let id = FuncId::from_usize(n as usize);
        self.b.set_source(SourceId::from_raw(self.random.below(100) as u32));
        // Every byte of a frame is set before it is read: by the caller, as lowering does with arguments.
        self.b.zero(Builder::callee_frame(0), FRAME_BYTES);
        let argument = self.value(Repr::I32);
        self.b.store(Builder::callee_frame(self.random.below(60) as u32), argument);
        let result = if self.random.chance(40) {
            let (result, status) = self.b.call_catching(id, instance, &args, callee.result);
            self.pool.push(status);
            result
        } else {
            self.b.call(id, instance, &args, callee.result)
        };
        self.pool.extend(result);
    }

    fn statements(&mut self, depth: u32) {
        for _ in 0..2 + self.random.below(6) {
            match self.random.below(100) {
                0..50 => self.operation(),
                50..78 => self.memory(),
                78..82 => self.check(),
                82..88 if depth > 0 => self.branch(depth - 1),
                88..91 if depth > 0 => self.choice(depth - 1),
                91..95 if depth > 0 => self.counted_loop(depth - 1),
                95..97 if depth > 0 => self.tangle(),
                _ => self.call(),
            }
        }
    }
}

fn generate(seed: u64) -> Program {
    let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    let mut funcs = Vec::new();
    let mut callees: Vec<Callee> = Vec::new();
    for n in 0..FUNCS + 1 {
        let entry = n == FUNCS;
        let callee = Callee {
            params: (0..if entry { 0 } else { random.below(8) }).map(|_| random.pick(&Repr::ALL)).collect(),
            result: (!entry && random.chance(70)).then(|| random.pick(&Repr::ALL)),
            has_instance: !entry && random.chance(50),
        };
        let name = if entry { "task Main".to_string() } else { format!("F{n}") };
        let b = Builder::new(name, &callee.params, callee.result, callee.has_instance);
        let pool = b.params().to_vec();
        let mut generator = Generator {
            random: &mut random,
            b,
            has_instance: callee.has_instance,
            callees: callees.clone(),
            pool,
            loops: 0,
            calls: if entry { 4 } else { 2 },
        };
        if entry {
            generator.b.zero(Place::new(Base::Frame, 0), FRAME_BYTES);
        }
        generator.statements(3);
        generator.statements(2);
        let result = callee.result.map(|r| generator.value(r));
        generator.b.ret(result);
        funcs.push(generator.b.finish(FRAME_BYTES));
        callees.push(callee);
    }
    // What the constants among the references point into.
    Program { addressable: vec![(HEADER_BYTES, 1024)], ..program(funcs, 1) }
}

/// What lies in the globals before a scan.
fn inputs(random: &mut Random) -> Vec<u8> {
    (HEADER_BYTES..GLOBALS_END).map(|_| (random.next() >> 32) as u8).collect()
}

fn run(seed: u64) -> u32 {
    let program = generate(seed);
    let mut random = Random(seed ^ 0x5DEE_CE66_D001 | 1);
    let mut engines = Engines::new(&program);
    let mut faults = 0;
    for scan in 0..4 {
        engines.write(0, &inputs(&mut random));
        faults += u32::from(engines.scan(0, scan) != 0);
    }
    faults
}

#[test]
fn engines_agree() {
    assert!(FRAME_BASE + FRAME_BYTES * (FUNCS as u32 + 2) <= support::REGION_BYTES);
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    if let Some(seed) = number("PLCC_SEED") {
        run(seed);
        return;
    }
    let programs = number("PLCC_PROGRAMS").unwrap_or(300);
    let mut faults = 0;
    for seed in 1..=programs {
        faults += std::panic::catch_unwind(|| run(seed)).unwrap_or_else(|_| panic!("seed {seed} (PLCC_SEED={seed})"));
    }
    // Both ends of a scan are met.
    assert!(faults > 0 && u64::from(faults) < programs * 4, "{faults} faults");
}

/// Graphs and forms that lowering never makes; what a pass makes of them means the same.
#[test]
fn passes_keep_the_meaning() {
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let (first, last) = match number("PLCC_SEED") {
        Some(seed) => (seed, seed),
        None => (1_000_001, 1_000_000 + number("PLCC_PROGRAMS").unwrap_or(120)),
    };
    for seed in first..=last {
        let program = generate(seed);
        let write = |cycle: usize, mem: &mut [u8]| {
            let mut random = Random((seed << 8 | cycle as u64) ^ 0x5DEE_CE66_D001 | 1);
            mem[HEADER_BYTES as usize..GLOBALS_END as usize].copy_from_slice(&inputs(&mut random));
        };
        let run =
            passes::Run { cycles: 4, inputs: &write, native: false, patience: std::time::Duration::from_secs(60) };
        if let Err(found) = passes::agree(&program, plcc_mir::opt::passes(), &run) {
            panic!("PLCC_SEED={seed}: {found}\n{}", plcc_mir::print::program(&program, None));
        }
    }
}
