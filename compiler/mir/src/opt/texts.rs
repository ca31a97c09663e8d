//! What is known of strings is not asked again: lengths, and what FIND, LEN and comparisons gave.
//!
//! Along every way the answers are remembered whose strings were not written since. What builds a string tells its length, so
//! that a line which is put together in several statements is not searched for its end each time. Where ways meet that know
//! different lengths of one that is measured somewhere, the block gets a parameter. What a loop does not write stays known
//! in it. LEN tells no more than an INT can hold, so only strings that cannot be longer are known.
//!
//! A text is taken apart by finding a character and leaving out what is in front of it and that itself: so many
//! characters there are for certain, and nobody need look at them again.
//!
//! ```text
//! v2 = call put(line[v0], x[v1], v9)          v2 = call put(line[v0], x[v1], v9)
//! v3 = call len(line[v0])               =>    v4 = call whole(line[v0], v2, v8)
//! v4 = call whole(line[v0], v3, v8)           v5 = call find_unit(x[v1], v6, v7)
//! v5 = call find_unit(x[v1], v6, v7)          v8 = add i64 v7, v5
//! v8 = call skip(x[v1], v7, v5)
//! ```

use super::alias::Alias;
use super::forward::join;
use super::loops::Bodies;
use super::rewrite::{Constants, Replace, writes_memory};
use crate::dominators::Dominators;
use crate::ir::{Args, BlockId, Func, Inst, Place, ValueId};
use index_vec::IndexVec;
use plcc_stdlib::prim::{PrimOp, Repr};
use plcc_stdlib::rt::strings::{TextFn, TextFns};

/// So many answers are remembered at once.
const KNOWN: usize = 24;

/// What a body told of strings.
#[derive(Debug, Clone)]
struct Answer {
    body: &'static TextFn,
    /// Of each string: where, its capacity, bytes in memory.
    texts: Vec<(Place, u64, i64)>,
    /// A constant by its register value.
    args: Vec<Result<u64, ValueId>>,
    value: ValueId,
}

impl Answer {
    /// Whether both answer the same question.
    fn same(&self, other: &Answer) -> bool {
        std::ptr::eq(self.body, other.body) && self.texts == other.texts && self.args == other.args
    }
}

/// The pass.
pub fn run(func: &mut Func, alias: &Alias) {
    let constants = Constants::new(func);
    let insts = || func.blocks.iter().flat_map(|b| &b.insts);
    if !insts().any(|inst| matches!(inst, Inst::CallText { func, .. } if !func.builds)) {
        return;
    }
    let measured: Vec<Answer> =
        insts().filter_map(|inst| answer(inst, &constants)).filter(|one| is_len(one.body)).collect();
    let mut resized: IndexVec<ValueId, Option<ValueId>> = IndexVec::from_vec(vec![None; func.values.len()]);
    for inst in insts() {
        // A position fits an INT.
        if let Inst::Prim {
            dst,
            op: PrimOp::Sext(_) | PrimOp::Zext(_) | PrimOp::Wrap(Repr::I16 | Repr::I32),
            args,
            ..
        } = inst
        {
            resized[*dst] = Some(args[0]);
        }
    }
    let tree = Dominators::new(func);
    let loops = Bodies::new(func, &tree);
    let mut replace = Replace::new(func);
    let mut ends: IndexVec<BlockId, Option<Vec<Answer>>> = func.blocks.iter().map(|_| None).collect();
    for &block in &tree.order {
        let preds = loops.known_ways(&tree, block, |pred| ends[pred].is_some());
        let mut known = preds.first().and_then(|first| ends[*first].clone()).unwrap_or_default();
        known.retain_mut(|one| {
            let values: Option<Vec<ValueId>> = preds
                .iter()
                .map(|pred| ends[*pred].as_ref()?.iter().rev().find(|other| other.same(one)).map(|other| other.value))
                .collect();
            let Some(values) = values else { return false };
            if values.iter().all(|v| *v == one.value) {
                return true;
            }
            if preds.len() < tree.preds[block].len() || !measured.iter().any(|m| m.same(one)) {
                return false;
            }
            one.value = join(func, block, &preds, &values, Repr::I64);
            true
        });
        loops.retain(func, block, &mut known, |inst, one| !changes(func, alias, &constants, inst, one));
        let insts = std::mem::take(&mut func.blocks[block].insts);
        let mut out = Vec::with_capacity(insts.len());
        for mut inst in insts {
            replace.inst(&mut inst);
            let told = answer(&inst, &constants);
            if let (Inst::CallText { dst, func: body, .. }, Some(told)) = (&inst, &told)
                && !body.builds
                && let Some(one) = known.iter().rev().find(|one| one.same(told))
            {
                replace.set(*dst, one.value);
                continue;
            }
            if let Some(sum) = skip_of_found(&inst, &constants, &resized, &known) {
                inst = sum;
            } else if writes_memory(&inst) {
                known.retain(|one| !changes(func, alias, &constants, &inst, one));
            }
            known.extend(told);
            if known.len() > KNOWN {
                known.remove(0);
            }
            out.push(inst);
        }
        func.blocks[block].insts = out;
        ends[block] = Some(known);
    }
    replace.apply(func);
}

/// Whether an instruction may write a string of an answer.
fn changes(func: &Func, alias: &Alias, constants: &Constants, inst: &Inst, one: &Answer) -> bool {
    one.texts.iter().any(|(place, _, bytes)| alias.may_write(func, constants, inst, place, *bytes))
}

/// What an instruction tells of strings of known capacity: a builder, how long one now is.
fn answer(inst: &Inst, constants: &Constants) -> Option<Answer> {
    let Inst::CallText { dst, func: body, texts, args } = inst else { return None };
    let mut strings = Vec::with_capacity(texts.len());
    for (n, text) in texts.iter().enumerate() {
        let capacity = constants.get(text.capacity)?;
        let bytes = i64::from(body.unit_bytes(n)) * (capacity as i64 + 1);
        strings.push((text.place.clone(), capacity, bytes));
    }
    let mut body: &'static TextFn = body;
    let mut args: Vec<Result<u64, ValueId>> = args.iter().map(|v| constants.get(*v).ok_or(*v)).collect();
    if body.builds {
        body = &TextFns::of(body.unit_bytes(0) == 2).len;
        args.clear();
        strings.truncate(1);
    }
    let short = strings.iter().all(|(_, capacity, _)| *capacity <= i16::MAX as u64);
    short.then_some(Answer { body, texts: strings, args, value: *dst })
}

/// `skip` of so many characters as it takes to a character that was found from there: it is there.
fn skip_of_found(
    inst: &Inst,
    constants: &Constants,
    resized: &IndexVec<ValueId, Option<ValueId>>,
    known: &[Answer],
) -> Option<Inst> {
    let asked = answer(inst, constants).filter(|one| is_one_of(one.body, |fns| &fns.skip))?;
    let Inst::CallText { args, .. } = inst else { return None };
    let [start, mut found] = args[..] else { return None };
    while let Some(narrow) = resized.get(found).copied().flatten() {
        found = narrow;
    }
    known.iter().rev().find(|one| {
        let is_find = is_one_of(one.body, |fns| &fns.find_unit);
        is_find && one.value == found && one.texts == asked.texts && one.args.get(1) == asked.args.first()
    })?;
    Some(Inst::Prim { dst: asked.value, op: PrimOp::Add, repr: Repr::I64, args: Args::Two([start, found]) })
}

fn is_len(body: &'static TextFn) -> bool {
    is_one_of(body, |fns| &fns.len)
}

fn is_one_of(body: &'static TextFn, pick: fn(&'static TextFns) -> &'static TextFn) -> bool {
    [false, true].iter().any(|wide| std::ptr::eq(body, pick(TextFns::of(*wide))))
}
