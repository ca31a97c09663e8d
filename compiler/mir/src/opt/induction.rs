//! Counters of loops in the width of addresses, and one counter instead of two.
//!
//! FOR keeps its variable in the width of its type beside the number of passes that are left (see `lower::for_loop`). Where
//! the bounds show that the variable cannot leave its type, it is counted in 64 bits, so that an index needs no extension;
//! the end is found by comparing it with its last value, and the number of passes goes. A product of the counter and a
//! constant, the offset of an element, becomes a counter of its own.
//!
//! ```text
//! b1(v1: i16, v2: i16):                    b1(v9: i64):
//!     v3 = sext_i64 i16 v1                     v4 = load i16 a[v9]
//!     v4 = load i16 a[v3]            =>        v5 = eq i64 v9, 63
//!     v5 = eq i16 v2, 0                        if v5 then b3 else b2
//!     if v5 then b3 else b2                b2: v8 = add i64 v9, 1
//! b2: v6 = add i16 v1, 1                       jump b1(v8)
//!     v7 = add i16 v2, -1
//!     jump b1(v6, v7)
//! ```

use super::loops::{self, Loop};
use super::rewrite::{Constants, Replace};
use crate::dominators::Dominators;
use crate::ir::{Args, Block, BlockId, Func, Inst, Term, ValueId};
use crate::visit;
use index_vec::IndexVec;
use plcc_stdlib::prim::{PrimOp, Repr};
use rustc_hash::{FxHashMap, FxHashSet};

/// Products that become counters of one loop.
const PRODUCTS: usize = 4;

/// How far up a guard is looked for.
const GUARD: usize = 8;

/// The pass.
pub fn run(func: &mut Func) {
    let loops = loops::find(func);
    if loops.is_empty() {
        return;
    }
    let tree = Dominators::new(func);
    for phase in [widen, products] {
        let mut values = Values::new(func);
        for l in &loops {
            values.enter(func, l);
            phase(func, &tree, l, &mut values);
        }
        values.replace.apply(func);
    }
}

/// What is known of values. Of a loop it is brought up to date when the loop's turn comes, so that no loop costs a look at
/// the whole function.
struct Values {
    /// What each is made of, where that is an operation.
    prims: IndexVec<ValueId, Option<(PrimOp, Repr, Args)>>,
    constants: Constants,
    /// Blocks that read a value, as it was at first.
    readers: IndexVec<ValueId, Vec<BlockId>>,
    /// Done in loops that had their turn, not yet elsewhere.
    replace: Replace,
}

impl Values {
    fn new(func: &Func) -> Self {
        let mut values = Self {
            prims: IndexVec::from_vec(vec![None; func.values.len()]),
            constants: Constants::new(func),
            readers: IndexVec::from_vec(vec![Vec::new(); func.values.len()]),
            replace: Replace::new(func),
        };
        for (id, block) in func.blocks.iter_enumerated() {
            values.note(block);
            let mut reads = |v: ValueId| {
                if values.readers[v].last() != Some(&id) {
                    values.readers[v].push(id);
                }
            };
            block.insts.iter().for_each(|inst| inst.for_each_use(&mut reads));
            block.term.for_each_use(&mut reads);
        }
        values
    }

    fn note(&mut self, block: &Block) {
        for inst in &block.insts {
            match inst {
                Inst::Prim { dst, op, repr, args } => {
                    while self.prims.len() <= dst.index() {
                        self.prims.push(None);
                    }
                    self.prims[*dst] = Some((*op, *repr, *args));
                }
                Inst::Const { dst, raw } => self.constants.note(*dst, *raw),
                _ => {}
            }
        }
    }

    fn enter(&mut self, func: &mut Func, l: &Loop) {
        self.replace.blocks(func, &l.blocks);
        self.replace.blocks(func, &[l.preheader]);
        l.blocks.iter().chain([&l.preheader]).for_each(|block| self.note(&func.blocks[*block]));
    }

    fn prim(&self, value: ValueId) -> Option<(PrimOp, Repr, Args)> {
        let (op, repr, mut args) = self.prims.get(value).copied().flatten()?;
        args.iter_mut().for_each(|v| *v = self.replace.get(*v));
        Some((op, repr, args))
    }
}

/// The only block of a loop that jumps back.
fn latch(tree: &Dominators, l: &Loop) -> Option<BlockId> {
    let inside: FxHashSet<BlockId> = l.blocks.iter().copied().collect();
    let mut backs = tree.preds[l.header].iter().copied().filter(|p| inside.contains(p));
    let latch = backs.next()?;
    backs.next().is_none().then_some(latch)
}

/// What a block gives to the parameters of another.
fn args_to(func: &Func, from: BlockId, to: BlockId) -> Option<Vec<ValueId>> {
    let mut found = None;
    func.blocks[from].term.for_each_target(|t| {
        if t.block == to {
            found = Some(t.args.clone());
        }
    });
    found
}

/// A parameter of the header to which each pass adds a constant.
#[derive(Debug, Clone, Copy)]
struct Counter {
    param: usize,
    value: ValueId,
    first: ValueId,
    repr: Repr,
    step: i64,
}

fn counters(func: &Func, l: &Loop, latch: BlockId, values: &Values) -> Vec<Counter> {
    let (Some(first), Some(next)) = (args_to(func, l.preheader, l.header), args_to(func, latch, l.header)) else {
        return Vec::new();
    };
    let mut list = Vec::new();
    for (param, value) in func.blocks[l.header].params.iter().enumerate() {
        let repr = func.values[*value];
        let Some((PrimOp::Add, _, Args::Two([x, c]))) = values.prim(next[param]) else { continue };
        if let (true, Some(raw)) = (x == *value, values.constants.get(c)) {
            list.push(Counter { param, value: *value, first: first[param], repr, step: repr.sign_extend(raw) });
        }
    }
    list
}

/// The last value of a counter.
enum Last {
    /// As the mathematical number.
    Constant(i64),
    /// Of the counter's representation.
    Value(ValueId),
}

fn widen(func: &mut Func, tree: &Dominators, l: &Loop, values: &mut Values) {
    let Some(latch) = latch(tree, l) else { return };
    let counters = counters(func, l, latch, values);
    // The number of passes left, and the test that ends the loop.
    let Some((rest, test)) = counters.iter().find_map(|c| {
        let test = (c.step == -1).then(|| end_test(func, tree, l, latch, c.value, values)).flatten();
        test.map(|test| (*c, test))
    }) else {
        return;
    };
    for counter in counters.iter().filter(|c| c.param != rest.param && c.repr == rest.repr) {
        let Some((last, signed, unsigned)) = last_value(func, tree, l, counter, &rest, values) else {
            continue;
        };
        let wide = match counter.repr {
            Repr::I64 => None,
            _ => wide_counter(func, l, latch, counter, (signed, unsigned), values),
        };
        if let (Last::Constant(last), [exit]) = (&last, &l.exits[..])
            && leads_to(func, test.0, *exit)
        {
            // Everywhere where the counter was read, or its extension.
            let mut readers = values.readers.get(counter.value).cloned().unwrap_or_default();
            for value in wide.iter().flat_map(|(_, _, extended)| extended) {
                readers.extend(values.readers.get(*value).into_iter().flatten());
            }
            let inside: FxHashSet<BlockId> = l.blocks.iter().copied().collect();
            readers.retain(|block| !inside.contains(block));
            readers.sort_unstable();
            readers.dedup();
            values.replace.blocks(func, &readers);
            let value = wide.as_ref().map_or(counter.value, |(_, narrow, _)| *narrow);
            known_behind(func, &readers, *exit, value, counter.repr, *last as u64 & counter.repr.mask());
            if let Some((wide, ..)) = wide {
                known_behind(func, &readers, *exit, wide, Repr::I64, *last as u64);
            }
        }
        return match (last, wide) {
            (Last::Constant(last), Some((wide, ..))) => replace_test(func, test, Repr::I64, wide, last as u64),
            (Last::Constant(last), None) => replace_test(func, test, counter.repr, counter.value, last as u64),
            (Last::Value(last), wide) => {
                let value = wide.map_or(counter.value, |(_, narrow, _)| narrow);
                set_test(func, test, counter.repr, value, last);
            }
        };
    }
}

fn leads_to(func: &Func, from: BlockId, to: BlockId) -> bool {
    let mut leads = false;
    func.blocks[from].term.for_each_target(|target| leads |= target.block == to);
    leads
}

/// Behind the only exit of a loop, taken in the last pass, the counter has its last value.
fn known_behind(func: &mut Func, readers: &[BlockId], exit: BlockId, value: ValueId, repr: Repr, raw: u64) {
    let dst = func.values.push(repr);
    let mut used = false;
    let mut rename = |v: &mut ValueId| {
        if *v == value {
            *v = dst;
            used = true;
        }
    };
    for id in readers {
        let block = &mut func.blocks[*id];
        block.insts.iter_mut().for_each(|inst| visit::uses(inst, &mut rename));
        visit::term_uses(&mut block.term, &mut rename);
    }
    if used {
        func.blocks[exit].insts.insert(0, Inst::Const { dst, raw });
    }
}

/// Where `rest = 0` is tested, if that ends the loop: block and instruction.
fn end_test(
    func: &Func,
    tree: &Dominators,
    l: &Loop,
    latch: BlockId,
    rest: ValueId,
    values: &Values,
) -> Option<(BlockId, usize)> {
    for &block in &l.blocks {
        let Term::Branch { cond, then, .. } = &func.blocks[block].term else { continue };
        let Some((PrimOp::Eq, _, Args::Two([x, zero]))) = values.prim(*cond) else { continue };
        if x != rest || values.constants.get(zero) != Some(0) || l.blocks.contains(&then.block) {
            continue;
        }
        let at = func.blocks[block].insts.iter().position(|inst| inst.results().0 == Some(*cond));
        return at.filter(|_| tree.dominates(block, latch)).map(|n| (block, n));
    }
    None
}

/// The last value, and whether all values are the same numbers read as signed and as unsigned.
fn last_value(
    func: &Func,
    tree: &Dominators,
    l: &Loop,
    counter: &Counter,
    rest: &Counter,
    values: &Values,
) -> Option<(Last, bool, bool)> {
    let repr = counter.repr;
    if let (Some(first), Some(passes)) = (values.constants.get(counter.first), values.constants.get(rest.first)) {
        let most = i128::from(passes);
        let limit = |first: i128| first + most * i128::from(counter.step);
        let (min, max) = (-(1i128 << (repr.bits() - 1)), (1i128 << (repr.bits() - 1)) - 1);
        let from = i128::from(repr.sign_extend(first));
        let signed = (min..=max).contains(&limit(from));
        let unsigned = (0..=i128::from(repr.mask())).contains(&limit(i128::from(first)));
        // The mathematical number as the extension that is used gives it.
        let last = if signed { limit(from) } else { limit(i128::from(first)) };
        return (signed || unsigned).then_some((
            Last::Constant(last as i64),
            signed,
            unsigned && (!signed || from >= 0),
        ));
    }
    let Some((PrimOp::Sub, _, Args::Two([a, b]))) = values.prim(rest.first) else { return None };
    let (low, high, last) = match counter.step {
        1 if b == counter.first => (b, a, a),
        -1 if a == counter.first => (b, a, b),
        _ => return None,
    };
    // Before the loop stands `low <= high`, in the order that the type has.
    let mut at = l.preheader;
    for _ in 0..GUARD {
        let above = tree.idom[at]?;
        if let Term::Branch { cond, then, otherwise } = &func.blocks[above].term
            && tree.dominates(then.block, l.preheader)
            && then.block != otherwise.block
            && tree.preds[then.block].len() == 1
            && let Some((op @ (PrimOp::LeS | PrimOp::LeU), _, Args::Two([x, y]))) = values.prim(*cond)
            && (x, y) == (low, high)
        {
            return Some((Last::Value(last), op == PrimOp::LeS, op == PrimOp::LeU));
        }
        at = above;
    }
    None
}

/// Counts in 64 bits if something in the loop extends the counter; gives that counter, its low part, and what it stands for.
fn wide_counter(
    func: &mut Func,
    l: &Loop,
    latch: BlockId,
    counter: &Counter,
    (signed, unsigned): (bool, bool),
    values: &mut Values,
) -> Option<(ValueId, ValueId, Vec<ValueId>)> {
    let extension = |op: PrimOp| match op {
        PrimOp::Sext(Repr::I64) => signed,
        PrimOp::Zext(Repr::I64) => unsigned,
        _ => false,
    };
    let mut extended: Vec<ValueId> = Vec::new();
    let mut ops: Vec<PrimOp> = Vec::new();
    for &block in &l.blocks {
        for inst in &func.blocks[block].insts {
            if let Inst::Prim { dst, op, args, .. } = inst
                && args[0] == counter.value
                && extension(*op)
            {
                extended.push(*dst);
                ops.push(*op);
            }
        }
    }
    let op = *ops.first()?;
    if ops.iter().any(|other| *other != op) && !(signed && unsigned) {
        return None;
    }
    let wide = func.values.push(Repr::I64);
    func.blocks[l.header].params.push(wide);
    let first = func.values.push(Repr::I64);
    let args = Args::One([counter.first]);
    func.blocks[l.preheader].insts.push(Inst::Prim { dst: first, op, repr: counter.repr, args });
    add_arg(func, l.preheader, l.header, first);
    step(func, l, latch, wide, counter.step);
    // The counter itself is the low part: no operation.
    let narrow = func.values.push(counter.repr);
    let inst = Inst::Prim { dst: narrow, op: PrimOp::Wrap(counter.repr), repr: Repr::I64, args: Args::One([wide]) };
    extended.iter().for_each(|value| values.replace.set(*value, wide));
    values.replace.set(counter.value, narrow);
    for &block in &l.blocks {
        func.blocks[block].insts.retain(|inst| inst.results().0.is_none_or(|v| !extended.contains(&v)));
    }
    values.replace.blocks(func, &l.blocks);
    func.blocks[l.header].insts.insert(0, inst);
    // The old parameter stays until nobody reads it; its own step reads what took its place.
    Some((wide, narrow, extended))
}

/// Adds the step to a new counter at the end of the pass.
fn step(func: &mut Func, l: &Loop, latch: BlockId, counter: ValueId, step: i64) {
    let by = func.values.push(Repr::I64);
    let next = func.values.push(Repr::I64);
    let args = Args::Two([counter, by]);
    func.blocks[latch].insts.push(Inst::Const { dst: by, raw: step as u64 });
    func.blocks[latch].insts.push(Inst::Prim { dst: next, op: PrimOp::Add, repr: Repr::I64, args });
    add_arg(func, latch, l.header, next);
}

fn add_arg(func: &mut Func, from: BlockId, to: BlockId, value: ValueId) {
    visit::targets(&mut func.blocks[from].term, &mut |target| {
        if target.block == to {
            target.args.push(value);
        }
    });
}

fn replace_test(func: &mut Func, (block, n): (BlockId, usize), repr: Repr, value: ValueId, last: u64) {
    let end = func.values.push(repr);
    // In front of its test, whose place has moved if the header got an instruction.
    let n = test_position(func, block, n);
    func.blocks[block].insts.insert(n, Inst::Const { dst: end, raw: last & repr.mask() });
    set_test_at(func, block, n + 1, repr, value, end);
}

fn set_test(func: &mut Func, (block, n): (BlockId, usize), repr: Repr, value: ValueId, last: ValueId) {
    let n = test_position(func, block, n);
    set_test_at(func, block, n, repr, value, last);
}

/// The test is what the branch reads.
fn test_position(func: &Func, block: BlockId, n: usize) -> usize {
    let Term::Branch { cond, .. } = &func.blocks[block].term else { return n };
    func.blocks[block].insts.iter().position(|inst| inst.results().0 == Some(*cond)).unwrap_or(n)
}

fn set_test_at(func: &mut Func, block: BlockId, n: usize, repr: Repr, value: ValueId, last: ValueId) {
    if let Inst::Prim { op, repr: old, args, .. } = &mut func.blocks[block].insts[n] {
        (*op, *old, *args) = (PrimOp::Eq, repr, Args::Two([value, last]));
    }
}

/// Products of a 64-bit counter and a constant.
fn products(func: &mut Func, tree: &Dominators, l: &Loop, values: &mut Values) {
    let Some(latch) = latch(tree, l) else { return };
    let counters = counters(func, l, latch, values);
    let mut found: FxHashMap<(ValueId, u64), Vec<ValueId>> = FxHashMap::default();
    let mut order: Vec<(Counter, u64)> = Vec::new();
    for &block in &l.blocks {
        for inst in &func.blocks[block].insts {
            let Inst::Prim { dst, op, repr: Repr::I64, args: Args::Two([x, c]) } = inst else { continue };
            let Some(counter) = counters.iter().find(|k| k.value == *x && k.repr == Repr::I64) else { continue };
            let factor = match (op, values.constants.get(*c)) {
                (PrimOp::Mul, Some(factor)) => factor,
                // The machine's addresses shift by up to 3.
                (PrimOp::Shl, Some(bits @ 4..=62)) => 1 << bits,
                _ => continue,
            };
            let list = found.entry((*x, factor)).or_default();
            if list.is_empty() {
                order.push((*counter, factor));
            }
            list.push(*dst);
        }
    }
    for (counter, factor) in order.into_iter().take(PRODUCTS) {
        let product = func.values.push(Repr::I64);
        func.blocks[l.header].params.push(product);
        let by = func.values.push(Repr::I64);
        let first = func.values.push(Repr::I64);
        let args = Args::Two([counter.first, by]);
        let front = &mut func.blocks[l.preheader].insts;
        front.push(Inst::Const { dst: by, raw: factor });
        front.push(Inst::Prim { dst: first, op: PrimOp::Mul, repr: Repr::I64, args });
        add_arg(func, l.preheader, l.header, first);
        step(func, l, latch, product, counter.step.wrapping_mul(factor as i64));
        let old = &found[&(counter.value, factor)];
        old.iter().for_each(|value| values.replace.set(*value, product));
        for &block in &l.blocks {
            func.blocks[block].insts.retain(|inst| inst.results().0.is_none_or(|v| !old.contains(&v)));
        }
    }
    values.replace.blocks(func, &l.blocks);
}
