//! Which POUs the code of a resource reaches, and which addresses (`%MW4`) its bodies use directly.
//!
//! In: checked bodies. Out: [`Reach`]. The layout needs it before any body is lowered.

use plcc_hir::app::Resource;
use plcc_hir::body::{Call, Callee, Place, Root};
use plcc_hir::visit::{self, Use, Visitor};
use plcc_hir::{Address, Defs, PouId, PouKind, TypeId};

/// What the code of a resource reaches.
#[derive(Debug, Clone, Default)]
pub struct Reach {
    /// POUs with a body that is called; actions among them.
    pub pous: Vec<PouId>,
    /// Addresses that expressions use directly.
    pub addresses: Vec<DirectAddress>,
    seen: Vec<bool>,
}

/// An address in an expression.
#[derive(Debug, Clone, Copy)]
pub struct DirectAddress {
    /// Where.
    pub address: Address,
    /// The type under which it is used.
    pub ty: TypeId,
    /// `ADR(%MW4)`.
    pub taken: bool,
}

impl Reach {
    /// Everything that the tasks of a resource reach; with `all` also every POU of the user's.
    pub fn new(defs: &Defs, resource: &Resource, all: bool) -> Self {
        let mut reach = Self { seen: vec![false; defs.pous.len()], ..Self::default() };
        for program in &resource.programs {
            reach.pou(program.pou);
            program.inputs.iter().for_each(|(_, value)| visit::expr(value, &mut reach));
            program.located.iter().for_each(|(_, place)| visit::place(place, Use::Written, &mut reach));
            program.outputs.iter().for_each(|(_, place)| visit::place(place, Use::Written, &mut reach));
        }
        for task in &resource.tasks {
            task.single.iter().for_each(|place| visit::place(place, Use::Read, &mut reach));
        }
        if all {
            defs.pous.iter_enumerated().filter(|(_, pou)| !pou.builtin).for_each(|(id, _)| reach.pou(id));
        }
        // The list grows while it is walked.
        let mut next = 0;
        while let Some(&id) = reach.pous.get(next) {
            next += 1;
            if let Some(owner) = defs.pous[id].owner {
                debug_assert!(defs.pous[id].kind == PouKind::Action);
                // The frame of an action starts with its owner's VAR_TEMPs.
                reach.pou(owner);
            }
            visit::stmts(&defs.bodies[id].stmts, &mut reach);
        }
        reach
    }

    fn pou(&mut self, id: PouId) {
        if !std::mem::replace(&mut self.seen[id.index()], true) {
            self.pous.push(id);
        }
    }
}

impl Visitor for Reach {
    fn place(&mut self, place: &Place, how: Use) {
        // The type of the innermost thing bounds the access from below; steps into an address stay inside it.
        if let Root::Address(address) = place.root {
            self.addresses.push(DirectAddress { address, ty: place.ty, taken: how == Use::Referenced });
        }
    }

    fn call(&mut self, call: &Call) {
        let (Callee::Function(pou) | Callee::Instance(_, pou) | Callee::Action(_, pou)) = call.callee;
        self.pou(pou);
    }
}
