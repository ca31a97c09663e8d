//! What instructions read and define, where they lead and whom they call: the questions every analysis asks.

use crate::ir::{Base, Cond, Exit, Func, FuncId, Inst, Place, Target, Term, ValueId};

impl Func {
    /// The functions that it calls, once per call.
    pub fn callees(&self) -> impl Iterator<Item = FuncId> + '_ {
        self.blocks.iter().flat_map(|b| &b.insts).filter_map(|inst| match inst {
            Inst::Call { callee, .. } => Some(*callee),
            _ => None,
        })
    }
}

impl Inst {
    /// The values that it defines: the result, and the status of a call.
    pub fn results(&self) -> (Option<ValueId>, Option<ValueId>) {
        match self {
            Inst::Const { dst, .. }
            | Inst::Prim { dst, .. }
            | Inst::Load { dst, .. }
            | Inst::AddressOf { dst, .. }
            | Inst::CallRt { dst, .. }
            | Inst::CallText { dst, .. } => (Some(*dst), None),
            Inst::Call { dst, status, .. } => (*dst, *status),
            Inst::Store { .. } | Inst::Copy { .. } | Inst::Zero { .. } | Inst::Check { .. } | Inst::Poll { .. } => {
                (None, None)
            }
        }
    }

    /// Calls `visit` for every value that it reads.
    pub fn for_each_use(&self, mut visit: impl FnMut(ValueId)) {
        match self {
            Inst::Const { .. } => {}
            Inst::Poll { exit } => exit.for_each_use(visit),
            Inst::Prim { args, .. } => args.iter().for_each(|v| visit(*v)),
            Inst::Load { place, .. } | Inst::AddressOf { place, .. } | Inst::Zero { dst: place, .. } => {
                place.for_each_use(visit);
            }
            Inst::Store { place, value } => {
                place.for_each_use(&mut visit);
                visit(*value);
            }
            Inst::Copy { dst, src, .. } => {
                dst.for_each_use(&mut visit);
                src.for_each_use(visit);
            }
            Inst::Call { instance, args, exit, .. } => {
                if let Some(place) = instance {
                    place.for_each_use(&mut visit);
                }
                args.iter().for_each(|v| visit(*v));
                exit.for_each_use(visit);
            }
            Inst::CallRt { args, .. } => args.iter().for_each(|v| visit(*v)),
            Inst::CallText { texts, args, .. } => {
                for text in texts {
                    text.place.for_each_use(&mut visit);
                    visit(text.capacity);
                }
                args.iter().for_each(|v| visit(*v));
            }
            Inst::Check { cond, operands, exit, .. } => {
                match cond {
                    Cond::True(value) | Cond::Within { value, .. } => visit(*value),
                }
                operands.iter().for_each(|v| visit(*v));
                exit.for_each_use(visit);
            }
        }
    }
}

impl Exit {
    /// Calls `visit` for every value that it reads.
    pub fn for_each_use(&self, mut visit: impl FnMut(ValueId)) {
        if let Some(place) = &self.instance {
            place.for_each_use(&mut visit);
        }
        for (place, value) in &self.owed {
            place.for_each_use(&mut visit);
            visit(*value);
        }
    }
}

impl Place {
    /// Calls `visit` for every value that it reads.
    pub fn for_each_use(&self, mut visit: impl FnMut(ValueId)) {
        if let Base::Reference(value) = self.base {
            visit(value);
        }
        self.index.iter().for_each(|term| visit(term.value));
    }
}

impl Term {
    /// Calls `visit` for every value that it reads.
    pub fn for_each_use(&self, mut visit: impl FnMut(ValueId)) {
        match self {
            Term::Jump(_) | Term::Return(None) => {}
            Term::Branch { cond: value, .. } | Term::Switch { value, .. } | Term::Return(Some(value)) => visit(*value),
        }
        self.for_each_target(|target| target.args.iter().for_each(|v| visit(*v)));
    }

    /// Calls `visit` for every target, in order; a block may come more than once.
    pub fn for_each_target<'a>(&'a self, mut visit: impl FnMut(&'a Target)) {
        match self {
            Term::Jump(target) => visit(target),
            Term::Branch { then, otherwise, .. } => {
                visit(then);
                visit(otherwise);
            }
            Term::Switch { cases, default, .. } => {
                cases.iter().for_each(|(_, target)| visit(target));
                visit(default);
            }
            Term::Return(_) => {}
        }
    }
}
