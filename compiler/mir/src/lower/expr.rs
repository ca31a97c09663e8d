//! Expressions: scalars become values, aggregates are places to copy from or are made in place.

use super::func::FuncLower;
use super::place::{Access, Purpose};
use crate::ir::{Place, ValueId};
use plcc_diag::bug;
use plcc_hir::TypeId;
use plcc_hir::body::{Expr, ExprKind};
use plcc_hir::elem_of;
use plcc_hir::shape::repr;
use plcc_stdlib::convert::convert;
use plcc_stdlib::elem::Elem;
use plcc_stdlib::emit::Val;
use plcc_stdlib::fault::Fault;
use plcc_stdlib::ops;
use plcc_stdlib::prim::{PrimOp, Repr};

impl FuncLower<'_, '_> {
    /// The value of a scalar expression.
    pub fn value(&mut self, expr: &Expr) -> ValueId {
        match &expr.kind {
            ExprKind::Const(raw) => {
                let Some(repr) = repr(self.defs, expr.ty) else { bug!("a constant of {:?}", self.defs.types[expr.ty]) };
                self.b.number(repr, *raw)
            }
            ExprKind::Read(place) => {
                let access = self.place(place);
                self.load(&access)
            }
            ExprKind::Op(op, elem, operands) => {
                let operands: Vec<Val> = operands.iter().map(|e| Val(self.value(e).raw())).collect();
                self.at(expr.span, "");
                ValueId::from_raw(ops::emit(*op, *elem, &operands, &mut self.b).0)
            }
            ExprKind::AndThen(a, b) => self.short_circuit(a, b, true),
            ExprKind::OrElse(a, b) => self.short_circuit(a, b, false),
            ExprKind::Convert(from, to, inner) => {
                let value = self.value(inner);
                self.at(expr.span, "");
                self.converted(*from, *to, value)
            }
            ExprKind::Retype(inner) => self.value(inner),
            ExprKind::RangeCheck { value, low, high, name } => {
                let result = self.value(value);
                if self.cx.checks.subrange {
                    self.at(expr.span, name);
                    self.check_subrange(result, value.ty, *low, *high);
                }
                result
            }
            ExprKind::Call(call) => match self.call(call, None) {
                Some(value) => value,
                None => bug!("the scalar result of a call without one"),
            },
            ExprKind::Std { func, elem, args } => {
                let args: Vec<Val> = args.iter().map(|e| Val(self.value(e).raw())).collect();
                self.at(expr.span, "");
                match func.emit(*elem, &args, &mut self.b) {
                    Some(value) => ValueId::from_raw(value.0),
                    None => bug!("the standard function {} has no formula", func.name),
                }
            }
            ExprKind::StdCall(call) => match self.std_call(call, expr.ty, None) {
                Some(value) => value,
                None => bug!("the scalar result of a standard function without one"),
            },
            ExprKind::Choose { selector, choices } => self.choose_value(selector, choices, expr.ty),
            ExprKind::Text { op, wide, args } => self.text_value(*op, *wide, args, expr),
            ExprKind::RefOf(place) => self.address(place, Purpose::Address),
            ExprKind::Temp(temp) => {
                let access = self.temp(*temp);
                self.load(&access)
            }
            ExprKind::String(_) | ExprKind::WString(_) => bug!("a string as a scalar"),
            ExprKind::Error => bug!("an expression with an error reached MIR"),
        }
    }

    /// The value of another elementary type.
    pub fn converted(&mut self, from: Elem, to: Elem, value: ValueId) -> ValueId {
        match convert(from, to, &mut self.b, Val(value.raw())) {
            Some(value) => ValueId::from_raw(value.0),
            None => bug!("a conversion from {} to {}", from.name(), to.name()),
        }
    }

    /// `a AND_THEN b` (`and`), `a OR_ELSE b`: b is evaluated only if a does not decide.
    fn short_circuit(&mut self, a: &Expr, b: &Expr, and: bool) -> ValueId {
        let (more, decided, join) = (self.b.block(), self.b.block(), self.b.block());
        let result = self.b.block_param(join, Repr::I8);
        let first = self.value(a);
        if and {
            self.b.branch(first, more, decided);
        } else {
            self.b.branch(first, decided, more);
        }
        self.b.switch_to(decided);
        let value = self.b.number(Repr::I8, u64::from(!and));
        self.b.jump(join, &[value]);
        self.b.switch_to(more);
        let second = self.value(b);
        self.b.jump(join, &[second]);
        self.b.switch_to(join);
        result
    }

    fn check_subrange(&mut self, value: ValueId, ty: TypeId, low: i128, high: i128) {
        let Some(elem) = elem_of(self.defs, ty) else { bug!("a subrange of {:?}", self.defs.types[ty]) };
        let wide = self.b.resize(value, elem.is_signed(), Repr::I64);
        if elem.is_signed() || elem.bits() < 64 {
            // Limits outside the type hold for every value.
            let limit = |v: i128| v.clamp(i128::from(i64::MIN), i128::from(i64::MAX)) as i64;
            self.b.check_within(wide, limit(low), limit(high), Fault::SubrangeViolation);
        } else {
            // ULINT, LWORD: an unsigned comparison.
            let limit = |v: i128| v.clamp(0, i128::from(u64::MAX)) as u64;
            let (low, high) = (self.b.number(Repr::I64, limit(low)), self.b.number(Repr::I64, limit(high)));
            let above = self.b.op(PrimOp::LeU, Repr::I64, &[low, wide]);
            let below = self.b.op(PrimOp::LeU, Repr::I64, &[wide, high]);
            let ok = self.b.op(PrimOp::And, Repr::I8, &[above, below]);
            self.b.check_true(ok, Fault::SubrangeViolation, &[wide, low, high]);
        }
    }

    /// Where an aggregate lies that an expression gives, no string. It is to be copied before anything else is evaluated.
    pub fn aggregate(&mut self, expr: &Expr) -> Place {
        match &expr.kind {
            ExprKind::Read(place) => self.place(place).place,
            ExprKind::Temp(temp) => self.temp(*temp).place,
            ExprKind::Retype(inner) => self.aggregate(inner),
            ExprKind::Call(call) => {
                let temp = self.new_temp(expr.ty);
                self.call(call, Some(temp.clone()));
                temp
            }
            ExprKind::StdCall(call) => {
                let temp = Self::plain(self.new_temp(expr.ty), expr.ty);
                self.std_call(call, expr.ty, Some(&temp));
                temp.place
            }
            ExprKind::Choose { selector, choices } => {
                let temp = self.new_temp(expr.ty);
                self.choose_into(selector, choices, temp.clone(), expr.ty);
                temp
            }
            _ => bug!("an aggregate from {:?}", expr.kind),
        }
    }

    /// Stores the aggregate or string that an expression gives.
    pub fn store_aggregate(&mut self, expr: &Expr, to: &Access) {
        match (&expr.kind, self.text_at(to)) {
            // The copy of the result is the last thing that such a call does.
            (ExprKind::Call(call), _) if expr.ty == to.ty && call.outputs.is_empty() && call.eno.is_none() => {
                self.call(call, Some(to.place.clone()));
            }
            (_, Some(to)) => self.text_into(expr, &to),
            (_, None) => {
                let from = self.aggregate(expr);
                self.copy_bytes(to.place.clone(), from, to.ty);
            }
        }
    }

    /// Evaluates an expression for its effect.
    pub fn effect(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Call(call) => {
                self.call(call, None);
            }
            _ if repr(self.defs, expr.ty).is_some() => {
                self.value(expr);
            }
            ExprKind::StdCall(call) if expr.ty == plcc_hir::Types::VOID => {
                self.std_call(call, expr.ty, None);
            }
            _ if self.is_text(expr.ty) => {
                self.text(expr);
            }
            _ => {
                self.aggregate(expr);
            }
        }
    }
}
