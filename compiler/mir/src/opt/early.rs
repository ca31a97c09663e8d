//! What decides how a block ends is calculated as early as possible in it.
//!
//! A processor that guessed a jump wrong has to start again as soon as it knows better: what stands between would only delay
//! that. Loads stay behind what may write their place, and behind checks and calls.
//!
//! ```text
//! b1: store i8 station.part := v1            b1: v2 = load i16 station.phase
//!     v2 = load i16 station.phase      =>        store i8 station.part := v1
//!     case v2, ...                               case v2, ...
//! ```

use super::alias::Alias;
use super::rewrite::{Constants, is_pure, writes_memory};
use crate::ir::{Func, Inst, Place, Term, ValueId};
use rustc_hash::FxHashSet;

/// What is made of more loads than these stays where it is.
const LOADS: usize = 16;

/// The pass.
pub fn run(func: &mut Func, alias: &Alias) {
    let constants = Constants::new(func);
    for id in func.blocks.indices() {
        let block = &func.blocks[id];
        let decides = match block.term {
            Term::Branch { cond, .. } => cond,
            Term::Switch { value, .. } => value,
            Term::Jump(_) | Term::Return(_) => continue,
        };
        let Some((slice, first)) = slice(func, alias, &constants, &block.insts, decides) else { continue };
        let mut insts = std::mem::take(&mut func.blocks[id].insts);
        let behind = insts.split_off(first).into_iter().zip(first..);
        let (moved, stay): (Vec<_>, Vec<_>) = behind.partition(|(_, at)| slice.contains(at));
        insts.extend(moved.into_iter().chain(stay).map(|(inst, _)| inst));
        func.blocks[id].insts = insts;
    }
}

/// The instructions of a block of which a value is made, and in front of which instruction all of them can stand.
fn slice(
    func: &Func,
    alias: &Alias,
    constants: &Constants,
    insts: &[Inst],
    value: ValueId,
) -> Option<(FxHashSet<usize>, usize)> {
    let mut wanted: FxHashSet<ValueId> = FxHashSet::from_iter([value]);
    let mut slice = FxHashSet::default();
    let mut loads: Vec<(&Place, i64)> = Vec::new();
    for (n, inst) in insts.iter().enumerate().rev() {
        let made = inst.results().0.is_some_and(|dst| wanted.contains(&dst));
        if made && is_pure(inst) {
            inst.for_each_use(|v| {
                wanted.insert(v);
            });
            slice.insert(n);
            if let Inst::Load { dst, place, .. } = inst {
                loads.push((place, i64::from(func.values[*dst].bytes())));
            }
            continue;
        }
        let writes = writes_memory(inst)
            && loads.iter().any(|(place, bytes)| alias.may_write(func, constants, inst, place, *bytes));
        let barrier = made
            || writes
            || loads.len() > LOADS
            || matches!(inst, Inst::Check { .. } | Inst::Poll { .. } | Inst::Call { .. });
        if barrier {
            // What of it stands in front stays there.
            slice.retain(|at| *at > n);
            return worth(insts, &slice).then_some((slice, n + 1));
        }
    }
    worth(insts, &slice).then_some((slice, 0))
}

/// What is in registers already is there in time: counters of loops stay where they are.
fn worth(insts: &[Inst], slice: &FxHashSet<usize>) -> bool {
    slice.iter().any(|at| matches!(insts[*at], Inst::Load { .. }))
}
