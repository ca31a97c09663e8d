//! Walks over the operands of instructions: what reads, writes and renames values without knowing each instruction.

use crate::ir::{Base, Cond, Exit, Inst, Place, Target, Term, ValueId};

/// Calls `f` with every value that a place needs.
pub fn place_uses(place: &mut Place, f: &mut impl FnMut(&mut ValueId)) {
    if let Base::Reference(v) = &mut place.base {
        f(v);
    }
    for term in &mut place.index {
        f(&mut term.value);
    }
}

/// The exit of an instruction that has one.
pub fn exit(inst: &mut Inst) -> Option<&mut Exit> {
    match inst {
        Inst::Check { exit, .. } | Inst::Poll { exit } | Inst::Call { exit, .. } => Some(exit),
        _ => None,
    }
}

/// Calls `f` with every place of an instruction, those of its exit too; a call's instance is one.
pub fn places(inst: &mut Inst, f: &mut impl FnMut(&mut Place)) {
    if let Some(exit) = exit(inst) {
        exit.instance.iter_mut().for_each(|place| f(place));
        exit.owed.iter_mut().for_each(|(place, _)| f(place));
    }
    match inst {
        Inst::Load { place, .. } | Inst::Store { place, .. } | Inst::AddressOf { place, .. } => f(place),
        Inst::Copy { dst, src, .. } => {
            f(dst);
            f(src);
        }
        Inst::Zero { dst, .. } => f(dst),
        Inst::Call { instance, .. } => instance.iter_mut().for_each(f),
        Inst::CallText { texts, .. } => texts.iter_mut().for_each(|text| f(&mut text.place)),
        Inst::Const { .. } | Inst::Prim { .. } | Inst::CallRt { .. } | Inst::Check { .. } | Inst::Poll { .. } => {}
    }
}

/// Calls `f` with every value that an instruction reads, those of its places too.
pub fn uses(inst: &mut Inst, f: &mut impl FnMut(&mut ValueId)) {
    places(inst, &mut |place| place_uses(place, f));
    if let Some(exit) = exit(inst) {
        exit.owed.iter_mut().for_each(|(_, value)| f(value));
    }
    match inst {
        Inst::Prim { args, .. } => args.iter_mut().for_each(f),
        Inst::Store { value, .. } => f(value),
        Inst::Call { args, .. } | Inst::CallRt { args, .. } => args.iter_mut().for_each(f),
        Inst::CallText { texts, args, .. } => {
            texts.iter_mut().for_each(|text| f(&mut text.capacity));
            args.iter_mut().for_each(f);
        }
        Inst::Check { cond, operands, .. } => {
            match cond {
                Cond::True(v) | Cond::Within { value: v, .. } => f(v),
            }
            operands.iter_mut().for_each(f);
        }
        Inst::Const { .. }
        | Inst::Load { .. }
        | Inst::Copy { .. }
        | Inst::Zero { .. }
        | Inst::AddressOf { .. }
        | Inst::Poll { .. } => {}
    }
}

/// Calls `f` with every value that an instruction defines.
pub fn defs(inst: &mut Inst, f: &mut impl FnMut(&mut ValueId)) {
    match inst {
        Inst::Const { dst, .. }
        | Inst::Prim { dst, .. }
        | Inst::Load { dst, .. }
        | Inst::AddressOf { dst, .. }
        | Inst::CallRt { dst, .. }
        | Inst::CallText { dst, .. } => f(dst),
        Inst::Call { dst, status, .. } => {
            dst.iter_mut().for_each(&mut *f);
            status.iter_mut().for_each(f);
        }
        Inst::Store { .. } | Inst::Copy { .. } | Inst::Zero { .. } | Inst::Check { .. } | Inst::Poll { .. } => {}
    }
}

/// Calls `f` with every value that a block's end reads, the arguments of its targets too.
pub fn term_uses(term: &mut Term, f: &mut impl FnMut(&mut ValueId)) {
    match term {
        Term::Branch { cond, .. } => f(cond),
        Term::Switch { value, .. } => f(value),
        Term::Return(Some(v)) => f(v),
        Term::Jump(_) | Term::Return(None) => {}
    }
    targets(term, &mut |target| target.args.iter_mut().for_each(&mut *f));
}

/// Calls `f` with every target of a block's end.
pub fn targets(term: &mut Term, f: &mut impl FnMut(&mut Target)) {
    match term {
        Term::Jump(target) => f(target),
        Term::Branch { then, otherwise, .. } => {
            f(then);
            f(otherwise);
        }
        Term::Switch { cases, default, .. } => {
            cases.iter_mut().for_each(|(_, target)| f(target));
            f(default);
        }
        Term::Return(_) => {}
    }
}
