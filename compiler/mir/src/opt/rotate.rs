//! The end of a loop's pass moves in front of the test that ends the loop.
//!
//! Then one branch leads back, not a branch out and a jump. What is moved is done once more than needed, when the loop
//! ends: only a few operations on values, which nobody sees. Comes last: it undoes a rule of [`fold`](super::fold), for the
//! sake of registers.
//!
//! ```text
//! b1(v1): ...                              b1(v1): ...
//!     v2 = eq i64 v1, 63                       v2 = eq i64 v1, 63
//!     if v2 then b3 else b2           =>       v3 = add i64 v1, 1
//! b2: v3 = add i64 v1, 1                       if v2 then b3 else b1(v3)
//!     jump b1(v3)
//! ```

use super::rewrite::Constants;
use crate::dominators::Dominators;
use crate::ir::{Args, BlockId, Func, Inst, Term};
use crate::visit;
use plcc_stdlib::prim::{PrimOp, Repr};

/// So many instructions are moved at most.
const MOVED: usize = 8;

/// The pass.
pub fn run(func: &mut Func) {
    let (tree, constants) = (Dominators::new(func), Constants::new(func));
    for &latch in &tree.order {
        let Term::Jump(back) = &func.blocks[latch].term else { continue };
        let (back, [test]) = (back.clone(), &tree.preds[latch][..]) else { continue };
        let test = *test;
        let body = &func.blocks[latch];
        let movable = |inst: &Inst| matches!(inst, Inst::Const { .. } | Inst::Prim { .. });
        let branches = matches!(func.blocks[test].term, Term::Branch { .. });
        if !tree.dominates(back.block, latch)
            || !branches
            || test == latch
            || !body.params.is_empty()
            || body.insts.len() > MOVED
            || !body.insts.iter().all(movable)
        {
            continue;
        }
        let insts = std::mem::take(&mut func.blocks[latch].insts);
        func.blocks[test].insts.extend(insts);
        visit::targets(&mut func.blocks[test].term, &mut |target| {
            if target.block == latch {
                *target = back.clone();
            }
        });
        test_the_next_value(func, &constants, test);
    }
}

/// `x = last` becomes `x + step = last + step`: then the old value of the counter is not needed beside the new one.
fn test_the_next_value(func: &mut Func, constants: &Constants, block: BlockId) {
    let Term::Branch { cond, .. } = &func.blocks[block].term else { return };
    let cond = *cond;
    let insts = &func.blocks[block].insts;
    let Some((x, repr, last)) = insts.iter().find_map(|inst| match inst {
        Inst::Prim { dst, op: PrimOp::Eq, repr, args: Args::Two([x, c]) } if *dst == cond => {
            constants.get(*c).map(|raw| (*x, *repr, raw))
        }
        _ => None,
    }) else {
        return;
    };
    let Some((next, step)) = insts.iter().find_map(|inst| match inst {
        Inst::Prim { dst, op: PrimOp::Add, args: Args::Two([y, c]), .. } if *y == x => {
            constants.get(*c).map(|raw| (*dst, raw))
        }
        _ => None,
    }) else {
        return;
    };
    let (end, test) = (func.values.push(repr), func.values.push(Repr::I8));
    let raw = last.wrapping_add(step) & repr.mask();
    let block = &mut func.blocks[block];
    block.insts.push(Inst::Const { dst: end, raw });
    block.insts.push(Inst::Prim { dst: test, op: PrimOp::Eq, repr, args: Args::Two([next, end]) });
    if let Term::Branch { cond, .. } = &mut block.term {
        *cond = test;
    }
}
