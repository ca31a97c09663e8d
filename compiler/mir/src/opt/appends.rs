//! A short constant is appended to a string by stores: its characters stand in the code. Only if it must be cut, which
//! is rare, the body is called.
//!
//! ```text
//!                                        v3 = le_s i64 v1, v2
//!                                        if v3 then b1 else b2
//!                                  b1:   store i16 line[v1] := 'g', 0
//! v4 = call put(line[v0], 'g', v1)   =>  jump b3(v1 + 1)
//!                                  b2:   v5 = call put(line[v0], 'g', v1)
//!                                        jump b3(v5)
//!                                  b3(v4):
//! ```

use super::rewrite::{Constants, to};
use crate::ir::{Args, Block, BlockId, Func, IndexTerm, Inst, Place, Target, Term, TextPlace, ValueId};
use crate::short_text::{SHORT_BYTES, words};
use plcc_stdlib::prim::{PrimOp, Repr};
use plcc_stdlib::rt::strings::TextFns;

/// The pass.
pub fn run(func: &mut Func) {
    let constants = Constants::new(func);
    for block in func.blocks.indices() {
        // From the end to the start: what was split off is done.
        for n in (0..func.blocks[block].insts.len()).rev() {
            if let Some(append) = append(&func.blocks[block].insts[n], &constants) {
                split(func, block, n, append);
            }
        }
    }
}

/// A constant that goes behind the first characters of a string.
struct Append {
    /// Its bytes, and a 0.
    bytes: Vec<u8>,
    unit: u32,
    /// The most characters in front of it so that it need not be cut.
    last: i64,
    to: Place,
    end: ValueId,
}

fn append(inst: &Inst, constants: &Constants) -> Option<Append> {
    let Inst::CallText { func, texts, args, .. } = inst else { return None };
    if ![false, true].iter().any(|wide| std::ptr::eq(*func, &raw const TextFns::of(*wide).put)) {
        return None;
    }
    let ([target, TextPlace { constant: Some(bytes), .. }], [end]) = (texts.as_slice(), args.as_slice()) else {
        return None;
    };
    let (unit, capacity) = (func.unit_bytes(0), constants.get(target.capacity)?);
    let length = bytes.len() as u32 / unit;
    let last = capacity.checked_sub(u64::from(length))?;
    if bytes.len() as u32 + unit > SHORT_BYTES || constants.get(*end).is_some() {
        return None;
    }
    let bytes = [bytes, &[0, 0][..unit as usize]].concat();
    Some(Append { bytes, unit, last: last as i64, to: target.place.clone(), end: *end })
}

/// Puts the two ways in place of the call, which is instruction `n` of the block.
fn split(func: &mut Func, block: BlockId, n: usize, append: Append) {
    let Some(Inst::CallText { dst: result, .. }) = func.blocks[block].insts.get(n) else { return };
    let result = *result;
    let behind = func.blocks[block].insts.split_off(n + 1);
    let Some(mut call) = func.blocks[block].insts.pop() else { return };
    let [fit, cut, done] = [0, 1, 2].map(|n| BlockId::from_usize(func.blocks.len() + n));
    let term = std::mem::replace(&mut func.blocks[block].term, Term::Return(None));
    let number = |func: &mut Func, raw: u64, to: &mut Vec<Inst>, repr: Repr| {
        let dst = func.values.push(repr);
        to.push(Inst::Const { dst, raw });
        dst
    };
    let mut front = std::mem::take(&mut func.blocks[block].insts);
    let limit = number(func, append.last as u64, &mut front, Repr::I64);
    let whole = func.values.push(Repr::I8);
    let args = Args::Two([append.end, limit]);
    front.push(Inst::Prim { dst: whole, op: PrimOp::LeS, repr: Repr::I64, args });
    func.blocks[block].insts = front;
    func.blocks[block].term = Term::Branch { cond: whole, then: to(fit), otherwise: to(cut) };

    let mut stores = Vec::new();
    let mut place = append.to;
    place.index.push(IndexTerm { value: append.end, stride: append.unit, low: 0, high: append.last });
    for (at, repr, raw) in words(&append.bytes) {
        let value = number(func, raw, &mut stores, repr);
        stores.push(Inst::Store { place: place.clone().plus(at), value });
    }
    let length = append.bytes.len() as u64 / u64::from(append.unit) - 1;
    let length = number(func, length, &mut stores, Repr::I64);
    let sum = func.values.push(Repr::I64);
    let args = Args::Two([append.end, length]);
    stores.push(Inst::Prim { dst: sum, op: PrimOp::Add, repr: Repr::I64, args });
    let goto = |value| Term::Jump(Target { block: done, args: vec![value] });
    func.blocks.push(Block { params: Vec::new(), insts: stores, term: goto(sum) });

    let shortened = func.values.push(Repr::I64);
    if let Inst::CallText { dst, .. } = &mut call {
        *dst = shortened;
    }
    func.blocks.push(Block { params: Vec::new(), insts: vec![call], term: goto(shortened) });
    func.blocks.push(Block { params: vec![result], insts: behind, term });
}
