//! Which POUs the code of a resource reaches, and which addresses (`%MW4`) its bodies use directly.
//!
//! In: checked bodies. Out: [`Reach`]. The layout needs it before any body is lowered.

use plcc_hir::app::Resource;
use plcc_hir::body::{Call, Callee, Expr, ExprKind, Place, Root, Step, Stmt, StmtKind};
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
            program.inputs.iter().for_each(|(_, value)| reach.expr(value));
            program.outputs.iter().for_each(|(_, place)| reach.place(place, false));
        }
        for task in &resource.tasks {
            task.single.iter().for_each(|place| reach.place(place, false));
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
            reach.stmts(&defs.bodies[id].stmts);
        }
        reach
    }

    fn pou(&mut self, id: PouId) {
        if !std::mem::replace(&mut self.seen[id.index()], true) {
            self.pous.push(id);
        }
    }

    fn stmts(&mut self, stmts: &[Stmt]) {
        for stmt in stmts {
            self.stmt(stmt);
        }
    }

    fn stmt(&mut self, stmt: &Stmt) {
        match &stmt.kind {
            StmtKind::Assign { target, value } => {
                self.place(target, false);
                self.expr(value);
            }
            StmtKind::Call(call) => self.call(call),
            StmtKind::Eval(value) => self.expr(value),
            StmtKind::If { arms, otherwise } => {
                for (cond, body) in arms {
                    self.expr(cond);
                    self.stmts(body);
                }
                self.stmts(otherwise);
            }
            StmtKind::Case { selector, arms, otherwise } => {
                self.expr(selector);
                arms.iter().for_each(|arm| self.stmts(&arm.body));
                self.stmts(otherwise);
            }
            StmtKind::For { var, from, to, by, body } => {
                self.place(var, false);
                self.expr(from);
                self.expr(to);
                by.iter().for_each(|e| self.expr(e));
                self.stmts(body);
            }
            StmtKind::While(cond, body) | StmtKind::Repeat(body, cond) => {
                self.expr(cond);
                self.stmts(body);
            }
            StmtKind::Jump(_, cond) => cond.iter().for_each(|e| self.expr(e)),
            StmtKind::Exit | StmtKind::Continue | StmtKind::Return | StmtKind::Label(_) => {}
        }
    }

    fn expr(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Read(place) => self.place(place, false),
            ExprKind::RefOf(place) => self.place(place, true),
            ExprKind::Op(_, _, operands) => operands.iter().for_each(|e| self.expr(e)),
            ExprKind::AndThen(a, b) | ExprKind::OrElse(a, b) => {
                self.expr(a);
                self.expr(b);
            }
            ExprKind::Convert(_, _, e) | ExprKind::Retype(e) | ExprKind::RangeCheck { value: e, .. } => self.expr(e),
            ExprKind::Call(call) => self.call(call),
            ExprKind::Std { args, .. } => args.iter().for_each(|e| self.expr(e)),
            ExprKind::StdCall(call) => {
                call.en.iter().chain(call.arguments.iter().map(|(_, e)| e)).for_each(|e| self.expr(e));
                call.outputs.iter().map(|(place, _)| place).chain(&call.eno).for_each(|p| self.place(p, false));
            }
            ExprKind::Choose { selector, choices } => {
                self.expr(selector);
                choices.iter().for_each(|e| self.expr(e));
            }
            ExprKind::Const(_) | ExprKind::String(_) | ExprKind::WString(_) | ExprKind::Temp(_) | ExprKind::Error => {}
        }
    }

    fn place(&mut self, place: &Place, taken: bool) {
        match &place.root {
            // The type of the innermost thing bounds the access from below; steps into an address stay inside it.
            Root::Address(address) => {
                self.addresses.push(DirectAddress { address: *address, ty: place.ty, taken });
            }
            Root::Deref(reference) => self.expr(reference),
            Root::Var(_) | Root::Temp(_) => {}
        }
        for step in &place.steps {
            if let Step::Index(indices, _) = step {
                indices.iter().for_each(|e| self.expr(e));
            }
        }
    }

    fn call(&mut self, call: &Call) {
        match &call.callee {
            Callee::Function(pou) | Callee::Action(None, pou) => self.pou(*pou),
            Callee::Instance(place, pou) | Callee::Action(Some(place), pou) => {
                self.place(place, false);
                self.pou(*pou);
            }
        }
        call.inputs.iter().for_each(|(_, e)| self.expr(e));
        call.in_outs.iter().for_each(|(_, place)| self.place(place, false));
        call.outputs.iter().for_each(|out| self.place(&out.target, false));
        call.en.iter().for_each(|e| self.expr(e));
        call.eno.iter().for_each(|place| self.place(place, false));
    }
}
