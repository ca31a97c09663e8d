//! FOR (semantics.md \[S2\]).
//!
//! A hidden counter holds how many passes follow the current one. It is worked out over the mathematical range in unsigned
//! arithmetic of the variable's width: `to - from` of a range that is not empty fits there, whatever the sign of the type,
//! so that nothing overflows and the loop ends, also at the type's limit.
//!
//! ```text
//!        range empty? ----------------> empty: var := from ----.
//!            |                                                 |
//!   pass(value, rest): var := value; body                      |
//!            |                                                 |
//!   next: rest = 0? --yes--> last: var := value + step or value +--> exit
//!            | no                                              |
//!   again: poll; pass(value + step, rest - 1)       EXIT ------'
//! ```

use super::func::{FuncLower, Loop};
use super::place::{Access, constant};
use crate::ir::{UNPOLLED_PASSES, ValueId};
use plcc_diag::{Span, bug};
use plcc_hir::Type;
use plcc_hir::body::{Expr, Place, Stmt, StmtKind};
use plcc_hir::elem_of;
use plcc_stdlib::elem::Elem;
use plcc_stdlib::fault::Fault;
use plcc_stdlib::prim::{PrimOp, Repr};

/// The step.
#[derive(Clone, Copy)]
enum Step {
    /// A constant that is not 0.
    Constant(i128),
    /// Known at run time: whether it is negative (`None`: an unsigned type).
    Runtime { down: Option<ValueId> },
}

impl FuncLower<'_, '_> {
    /// A FOR statement.
    pub fn for_(&mut self, span: Span, var: &Place, from: &Expr, to: &Expr, by: Option<&Expr>, body: &[Stmt]) {
        let Some(ty) = elem_of(self.defs, var.ty) else { bug!("FOR over {:?}", self.defs.types[var.ty]) };
        let repr = ty.repr();
        let variable = self.place(var);
        let first = self.value(from);
        let end = self.value(to);
        let (step, step_value) = self.step_value(span, ty, by);
        let passes = constant_passes(ty, from, to, step);

        let (enter, pass) = (self.b.block(), self.b.block());
        let value = self.b.block_param(pass, repr);
        let rest = self.b.block_param(pass, repr);
        let (next, last, again) = (self.b.block(), self.b.block(), self.b.block());
        let (empty, exit) = (self.b.block(), self.b.block());

        match passes {
            Some(0) => self.b.jump(empty, &[]),
            Some(_) => self.b.jump(enter, &[]),
            None => {
                let some = self.not_empty(ty, first, end, step);
                self.b.branch(some, enter, empty);
            }
        }
        self.b.switch_to(enter);
        let following = match passes {
            // At most 2^64 passes, so that one less fits.
            Some(n) => self.b.number(repr, n.saturating_sub(1) as u64),
            None => self.following_passes(repr, first, end, step, step_value),
        };
        self.b.jump(pass, &[first, following]);

        self.b.switch_to(pass);
        self.store(&variable, value);
        let unpolled_passes = self.unpolled_passes(passes, body);
        self.loop_body(body, Loop { exit, next, unpolled_passes: unpolled_passes.unwrap_or(1) });
        self.b.jump(next, &[]);

        self.b.switch_to(next);
        let zero = self.b.number(repr, 0);
        let done = self.b.op(PrimOp::Eq, repr, &[rest, zero]);
        self.b.branch(done, last, again);

        self.b.switch_to(again);
        if unpolled_passes.is_none() {
            self.poll(span);
        }
        let following = self.b.op(PrimOp::Add, repr, &[value, step_value]);
        let one = self.b.number(repr, 1);
        let fewer = self.b.op(PrimOp::Sub, repr, &[rest, one]);
        self.b.jump(pass, &[following, fewer]);

        self.b.switch_to(last);
        self.store_final(&variable, var, ty, value, step, step_value);
        self.b.jump(exit, &[]);

        self.b.switch_to(empty);
        self.store(&variable, first);
        self.b.jump(exit, &[]);
        self.b.switch_to(exit);
    }

    /// The step and its register value at the width of the variable.
    fn step_value(&mut self, span: Span, ty: Elem, by: Option<&Expr>) -> (Step, ValueId) {
        let repr = ty.repr();
        let Some(by) = by else { return (Step::Constant(1), self.b.number(repr, 1)) };
        let Some(step_type) = elem_of(self.defs, by.ty) else { bug!("a FOR step of {:?}", self.defs.types[by.ty]) };
        if let Some(raw) = constant(by) {
            let step = step_type.to_i128(raw);
            if step != 0 {
                return (Step::Constant(step), self.b.number(repr, step as u64));
            }
        }
        let value = self.value(by);
        let zero = self.b.number(repr, 0);
        let ok = self.b.op(PrimOp::Ne, repr, &[value, zero]);
        self.at(span, "");
        self.b.check_true(ok, Fault::ForStepZero, &[]);
        let down = step_type.is_signed().then(|| self.b.op(PrimOp::LtS, repr, &[value, zero]));
        (Step::Runtime { down }, value)
    }

    /// Whether there is a first pass.
    fn not_empty(&mut self, ty: Elem, from: ValueId, to: ValueId, step: Step) -> ValueId {
        let le = if ty.is_signed() { PrimOp::LeS } else { PrimOp::LeU };
        let repr = ty.repr();
        match step {
            Step::Constant(n) if n < 0 => self.b.op(le, repr, &[to, from]),
            Step::Constant(_) | Step::Runtime { down: None } => self.b.op(le, repr, &[from, to]),
            Step::Runtime { down: Some(down) } => {
                let rising = self.b.op(le, repr, &[from, to]);
                let falling = self.b.op(le, repr, &[to, from]);
                self.b.op(PrimOp::Select, Repr::I8, &[down, falling, rising])
            }
        }
    }

    /// How many passes follow the first one: the distance by the size of the step, unsigned.
    fn following_passes(&mut self, repr: Repr, from: ValueId, to: ValueId, step: Step, value: ValueId) -> ValueId {
        let rising = |f: &mut Self| f.b.op(PrimOp::Sub, repr, &[to, from]);
        let falling = |f: &mut Self| f.b.op(PrimOp::Sub, repr, &[from, to]);
        match step {
            Step::Constant(n) => {
                let distance = if n < 0 { falling(self) } else { rising(self) };
                if n.unsigned_abs() == 1 {
                    return distance;
                }
                let size = self.b.number(repr, n.unsigned_abs() as u64);
                self.b.op(PrimOp::DivU, repr, &[distance, size])
            }
            Step::Runtime { down: None } => {
                let distance = rising(self);
                self.b.op(PrimOp::DivU, repr, &[distance, value])
            }
            Step::Runtime { down: Some(down) } => {
                let (up, fall) = (rising(self), falling(self));
                let distance = self.b.op(PrimOp::Select, repr, &[down, fall, up]);
                // The most negative step is its own size, read as unsigned.
                let negative = self.b.op(PrimOp::Neg, repr, &[value]);
                let size = self.b.op(PrimOp::Select, repr, &[down, negative, value]);
                self.b.op(PrimOp::DivU, repr, &[distance, size])
            }
        }
    }

    /// After a full run: one step past the last value if that fits, else the last.
    fn store_final(&mut self, to: &Access, var: &Place, ty: Elem, last: ValueId, step: Step, step_value: ValueId) {
        let repr = ty.repr();
        let less = if ty.is_signed() { PrimOp::LtS } else { PrimOp::LtU };
        let past = self.b.op(PrimOp::Add, repr, &[last, step_value]);
        // A sum that wrapped lies on the other side of the last value.
        let mut fits = match step {
            Step::Constant(n) if n < 0 => self.b.op(less, repr, &[past, last]),
            Step::Constant(_) | Step::Runtime { down: None } => self.b.op(less, repr, &[last, past]),
            Step::Runtime { down: Some(down) } => {
                let rose = self.b.op(less, repr, &[last, past]);
                let fell = self.b.op(less, repr, &[past, last]);
                self.b.op(PrimOp::Select, Repr::I8, &[down, fell, rose])
            }
        };
        if let Type::Subrange { low, high, .. } = self.defs.types[var.ty] {
            let inside = self.in_range(past, repr, low as u64 & repr.mask(), high as u64 & repr.mask());
            fits = self.b.op(PrimOp::And, Repr::I8, &[fits, inside]);
        }
        let value = self.b.op(PrimOp::Select, repr, &[fits, past, last]);
        self.store(to, value);
    }

    /// The passes of this loop and those around it between two polls, if they are few enough to do without one: the trip
    /// count is a constant and nothing is called that might loop itself.
    fn unpolled_passes(&self, passes: Option<u128>, body: &[Stmt]) -> Option<u64> {
        let around = self.loops.last().map_or(1, |l| l.unpolled_passes);
        let passes = u64::try_from(passes?).ok()?.max(1).checked_mul(around)?;
        (passes <= UNPOLLED_PASSES && !body_calls(body)).then_some(passes)
    }
}

/// The trip count, if all bounds are constants.
fn constant_passes(ty: Elem, from: &Expr, to: &Expr, step: Step) -> Option<u128> {
    let Step::Constant(step) = step else { return None };
    let (from, to) = (ty.to_i128(constant(from)?), ty.to_i128(constant(to)?));
    let distance = if step > 0 { to - from } else { from - to };
    Some(if distance < 0 { 0 } else { distance.unsigned_abs() / step.unsigned_abs() + 1 })
}

/// Whether statements may call a user's POU.
fn body_calls(body: &[Stmt]) -> bool {
    body.iter().any(|stmt| match &stmt.kind {
        StmtKind::Call(_) => true,
        StmtKind::Assign { target, value } => target.calls() || value.calls(),
        StmtKind::Eval(value) => value.calls(),
        StmtKind::If { arms, otherwise } => {
            arms.iter().any(|(cond, body)| cond.calls() || body_calls(body)) || body_calls(otherwise)
        }
        StmtKind::Case { selector, arms, otherwise } => {
            selector.calls() || arms.iter().any(|arm| body_calls(&arm.body)) || body_calls(otherwise)
        }
        StmtKind::For { from, to, by, body, .. } => {
            from.calls() || to.calls() || by.as_ref().is_some_and(Expr::calls) || body_calls(body)
        }
        StmtKind::While(cond, body) | StmtKind::Repeat(body, cond) => cond.calls() || body_calls(body),
        StmtKind::Jump(_, cond) => cond.as_ref().is_some_and(Expr::calls),
        StmtKind::Exit | StmtKind::Continue | StmtKind::Return | StmtKind::Label(_) => false,
    })
}
