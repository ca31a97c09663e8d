//! What is the same in every pass of a loop is calculated before it.
//!
//! Operations on values from outside; loads that nothing in the loop writes, where they are safe before it ([`Proven`]).
//! Not more than some values leave a loop: each takes a register through all of it.
//!
//! ```text
//! b1: ...; jump b2                    b1: ...; v1 = load f32 gain; jump b2
//! b2: v1 = load f32 gain         =>   b2: v2 = fmul f32 v1, v0
//!     v2 = fmul f32 v1, v0
//! ```

use super::alias::Alias;
use super::loops;
use super::proven::Proven;
use super::rewrite::{Constants, writes_memory};
use crate::dominators::Dominators;
use crate::ir::{Func, Inst, ValueId};
use rustc_hash::FxHashSet;

/// So many values leave a loop, constants not counted.
const HOISTED: usize = 12;

/// A loop of more instructions is left alone: its values would be spilled.
const LARGE: usize = 3_000;

/// The pass.
pub fn run(func: &mut Func, alias: &Alias) {
    let loops = loops::find(func);
    let tree = Dominators::new(func);
    let proven = Proven::new(func);
    let constants = Constants::new(func);
    for l in &loops {
        let size: usize = l.blocks.iter().map(|b| func.blocks[*b].insts.len()).sum();
        if size > LARGE {
            continue;
        }
        let mut made_inside: FxHashSet<ValueId> = FxHashSet::default();
        let mut writers: Vec<Inst> = Vec::new();
        for block in &l.blocks {
            let block = &func.blocks[*block];
            made_inside.extend(&block.params);
            for inst in &block.insts {
                let (first, second) = inst.results();
                made_inside.extend(first.into_iter().chain(second));
                if writes_memory(inst) {
                    writers.push(inst.clone());
                }
            }
        }
        let mut hoisted = 0;
        for &block in &l.blocks {
            let insts = std::mem::take(&mut func.blocks[block].insts);
            let mut stay = Vec::with_capacity(insts.len());
            for inst in insts {
                let is_constant = matches!(inst, Inst::Const { .. });
                let mut outside = true;
                inst.for_each_use(|v| outside &= !made_inside.contains(&v));
                let may_move = match &inst {
                    Inst::Const { .. } | Inst::Prim { .. } | Inst::AddressOf { .. } | Inst::CallRt { .. } => true,
                    Inst::Load { dst, place, .. } => {
                        let bytes = i64::from(func.values[*dst].bytes());
                        let safe = proven.is_safe(place, l.preheader, &tree);
                        safe && !writers.iter().any(|w| alias.may_write(func, &constants, w, place, bytes))
                    }
                    _ => false,
                };
                if outside && may_move && (is_constant || hoisted < HOISTED) {
                    hoisted += usize::from(!is_constant);
                    if let (Some(dst), _) = inst.results() {
                        made_inside.remove(&dst);
                    }
                    func.blocks[l.preheader].insts.push(inst);
                } else {
                    stay.push(inst);
                }
            }
            func.blocks[block].insts = stay;
        }
    }
}
