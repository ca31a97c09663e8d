//! Statements: assignments, branches, jumps. FOR has a module of its own.

use super::func::{FuncLower, Label, Loop};
use crate::ir::{BlockId, ValueId};
use plcc_diag::{Span, bug};
use plcc_hir::body::{CaseArm, Expr, LabelId, Place, Stmt, StmtKind};
use plcc_hir::elem_of;
use plcc_hir::shape::repr;
use plcc_stdlib::prim::{PrimOp, Repr};

/// A range of CASE labels with at most so many values becomes single values.
const SHORT_RANGE: i128 = 16;

impl FuncLower<'_, '_> {
    /// Statements in order. What stands behind an EXIT or RETURN is lowered too and dropped with its blocks: a label may
    /// stand there.
    pub fn stmts(&mut self, stmts: &[Stmt]) {
        for stmt in stmts {
            self.stmt(stmt);
        }
    }

    fn stmt(&mut self, stmt: &Stmt) {
        // No string of the statement around is needed any more: conditions and bounds are values.
        self.text_temps.release();
        match &stmt.kind {
            StmtKind::Assign { target, value } => self.assign(target, value),
            StmtKind::Call(call) => {
                self.call(call, None);
            }
            StmtKind::Eval(value) => self.effect(value),
            StmtKind::If { arms, otherwise } => self.if_(arms, otherwise),
            StmtKind::Case { selector, arms, otherwise } => self.case(selector, arms, otherwise),
            StmtKind::For { var, from, to, by, body } => self.for_(stmt.span, var, from, to, by.as_ref(), body),
            StmtKind::While(cond, body) => self.while_(stmt.span, cond, body),
            StmtKind::Repeat(body, cond) => self.repeat(stmt.span, body, cond),
            StmtKind::Exit => {
                let exit = self.innermost().exit;
                self.b.jump(exit, &[]);
            }
            StmtKind::Continue => {
                let next = self.innermost().next;
                self.b.jump(next, &[]);
            }
            StmtKind::Return => {
                let exit = self.exit;
                self.b.jump(exit, &[]);
            }
            StmtKind::Label(label) => {
                let block = self.label(*label).block;
                self.b.jump(block, &[]);
                self.b.switch_to(block);
                self.labels.insert(label.raw(), Label { block, placed: true });
            }
            StmtKind::Jump(label, cond) => self.jump(stmt.span, *label, cond.as_ref()),
        }
    }

    fn innermost(&self) -> Loop {
        match self.loops.last() {
            Some(inner) => *inner,
            None => bug!("EXIT or CONTINUE outside a loop"),
        }
    }

    /// Left to right: the checks of the target come before the value.
    fn assign(&mut self, target: &Place, value: &Expr) {
        if self.assign_tail(target, value) {
            return;
        }
        let to = self.place(target);
        if repr(self.defs, target.ty).is_some() {
            let value = self.value(value);
            self.store(&to, value);
        } else {
            self.store_aggregate(value, &to);
        }
    }

    fn if_(&mut self, arms: &[(Expr, Vec<Stmt>)], otherwise: &[Stmt]) {
        let join = self.b.block();
        for (cond, body) in arms {
            let (then, next) = (self.b.block(), self.b.block());
            let cond = self.value(cond);
            self.b.branch(cond, then, next);
            self.b.switch_to(then);
            self.stmts(body);
            self.b.jump(join, &[]);
            self.b.switch_to(next);
        }
        self.stmts(otherwise);
        self.b.jump(join, &[]);
        self.b.switch_to(join);
    }

    /// Labels do not overlap, so their order does not matter: single values in a switch, long ranges behind it.
    fn case(&mut self, selector: &Expr, arms: &[CaseArm], otherwise: &[Stmt]) {
        let Some(elem) = elem_of(self.defs, selector.ty) else { bug!("a CASE of {:?}", self.defs.types[selector.ty]) };
        let (repr, (min, max)) = (elem.repr(), elem.range().unwrap_or((0, 0)));
        let value = self.value(selector);
        let (join, ranges) = (self.b.block(), self.b.block());
        let bodies: Vec<BlockId> = arms.iter().map(|_| self.b.block()).collect();
        let raw = |n: i128| (n as u64) & repr.mask();
        let mut singles = Vec::new();
        let mut long = Vec::new();
        for (arm, body) in arms.iter().zip(&bodies) {
            for (low, high) in arm.labels.iter().map(|(low, high)| (*low.max(&min), *high.min(&max))) {
                if high.saturating_sub(low) < SHORT_RANGE {
                    singles.extend((low..=high).map(|n| (raw(n), *body)));
                } else {
                    long.push((low, high, *body));
                }
            }
        }
        if singles.is_empty() {
            self.b.jump(ranges, &[]);
        } else {
            self.b.switch(value, &singles, ranges);
        }
        self.b.switch_to(ranges);
        for (low, high, body) in long {
            let next = self.b.block();
            let inside = self.in_range(value, repr, raw(low), raw(high));
            self.b.branch(inside, body, next);
            self.b.switch_to(next);
        }
        self.stmts(otherwise);
        self.b.jump(join, &[]);
        for (arm, body) in arms.iter().zip(bodies) {
            self.b.switch_to(body);
            self.stmts(&arm.body);
            self.b.jump(join, &[]);
        }
        self.b.switch_to(join);
    }

    /// low <= value <= high for register values of one integer type, signed or not: one unsigned comparison of distances.
    pub fn in_range(&mut self, value: ValueId, repr: Repr, low: u64, high: u64) -> ValueId {
        let start = self.b.number(repr, low);
        let distance = self.b.op(PrimOp::Sub, repr, &[value, start]);
        let extent = self.b.number(repr, high.wrapping_sub(low));
        self.b.op(PrimOp::LeU, repr, &[distance, extent])
    }

    fn while_(&mut self, span: Span, cond: &Expr, body: &[Stmt]) {
        let (head, pass, next, exit) = (self.b.block(), self.b.block(), self.b.block(), self.b.block());
        self.b.jump(head, &[]);
        self.b.switch_to(head);
        let cond = self.value(cond);
        self.b.branch(cond, pass, exit);
        self.b.switch_to(pass);
        self.loop_body(body, Loop { exit, next, unpolled_passes: 1 });
        self.b.jump(next, &[]);
        self.b.switch_to(next);
        self.poll(span);
        self.b.jump(head, &[]);
        self.b.switch_to(exit);
    }

    fn repeat(&mut self, span: Span, body: &[Stmt], until: &Expr) {
        let (head, next, again, exit) = (self.b.block(), self.b.block(), self.b.block(), self.b.block());
        self.b.jump(head, &[]);
        self.b.switch_to(head);
        self.loop_body(body, Loop { exit, next, unpolled_passes: 1 });
        self.b.jump(next, &[]);
        self.b.switch_to(next);
        let until = self.value(until);
        self.b.branch(until, exit, again);
        self.b.switch_to(again);
        self.poll(span);
        self.b.jump(head, &[]);
        self.b.switch_to(exit);
    }

    /// The statements of a loop.
    pub fn loop_body(&mut self, body: &[Stmt], blocks: Loop) {
        self.loops.push(blocks);
        self.stmts(body);
        self.loops.pop();
    }

    /// At a back-edge.
    pub fn poll(&mut self, span: Span) {
        if self.cx.checks.deadline {
            self.at(span, "");
            self.b.poll();
        }
    }

    fn label(&mut self, label: LabelId) -> Label {
        let b = &mut self.b;
        *self.labels.entry(label.raw()).or_insert_with(|| Label { block: b.block(), placed: false })
    }

    fn jump(&mut self, span: Span, label: LabelId, cond: Option<&Expr>) {
        let Label { block, placed: backwards } = self.label(label);
        let stay = cond.map(|cond| {
            let (go, stay) = (self.b.block(), self.b.block());
            let cond = self.value(cond);
            self.b.branch(cond, go, stay);
            self.b.switch_to(go);
            stay
        });
        if backwards {
            self.poll(span);
        }
        self.b.jump(block, &[]);
        if let Some(stay) = stay {
            self.b.switch_to(stay);
        }
    }
}
