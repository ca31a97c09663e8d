//! Arithmetic with durations, times of day and dates (semantics.md \[T7\]).

use crate::body::*;
use crate::expr::*;
use crate::types::Types;
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::{Elem, Family};
use plcc_stdlib::ops::Op;
use plcc_syntax::ast::BinaryOp;

impl Checker<'_, '_> {
    /// Durations and dates (semantics.md \[T7\]): sums and differences of nanoseconds, products with numbers.
    #[allow(clippy::too_many_arguments)]
    pub fn time_arithmetic(
        &mut self,
        op: BinaryOp,
        a: Operand,
        b: Operand,
        ea: Option<Elem>,
        eb: Option<Elem>,
        sides: [Span; 2],
        span: Span,
    ) -> Operand {
        use Family::*;
        let family = |e: Option<Elem>| e.map(Elem::family);
        let long = |e: Option<Elem>| matches!(e, Some(Elem::Ltime | Elem::Ldate | Elem::Ltod | Elem::Ldt));
        let time = |long: bool| if long { Elem::Ltime } else { Elem::Time };
        let number = |e: Option<Elem>| e.is_none_or(|e| e.is_integer() || e.is_real());
        let result = match (op, family(ea), family(eb)) {
            (BinaryOp::Add | BinaryOp::Sub, Some(Duration), Some(Duration)) => Some(time(long(ea) || long(eb))),
            (BinaryOp::Add | BinaryOp::Sub, Some(TimeOfDay | DateTime), Some(Duration)) => ea,
            (BinaryOp::Sub, Some(x @ (Date | TimeOfDay | DateTime)), Some(y)) if x == y => {
                Some(time(long(ea) || long(eb)))
            }
            (BinaryOp::Mul, Some(Duration), _) if number(eb) => {
                return self.scale(Op::TimeMul, a, b, ea, eb, sides, span);
            }
            (BinaryOp::Mul, _, Some(Duration)) if number(ea) => {
                return self.scale(Op::TimeMul, b, a, eb, ea, [sides[1], sides[0]], span);
            }
            (BinaryOp::Div, Some(Duration), _) if number(eb) => {
                return self.scale(Op::TimeDiv, a, b, ea, eb, sides, span);
            }
            _ => None,
        };
        let Some(result) = result else {
            let name = |c: &Checker, o: &Operand| match o {
                Operand::Value { ty, .. } => c.cx.type_name(*ty),
                _ => "a number".into(),
            };
            let message = format!("{} cannot combine {} and {}", op.text(), name(self, &a), name(self, &b));
            self.report(Diagnostic::new(codes::WRONG_OPERAND, span, message).help(
                "durations add to durations, times of day and dates with time; dates of one kind subtract; \
                 a duration may be multiplied and divided by a number",
            ));
            return Operand::Error;
        };
        let prim = if op == BinaryOp::Add { Op::Add } else { Op::Sub };
        let a = self.settle(a, sides[0]);
        let b = self.settle(b, sides[1]);
        // All of them are nanoseconds in 64 bits: the operation is that of TIME.
        let args = vec![retype(a, Types::elem(Elem::Time)), retype(b, Types::elem(Elem::Time))];
        let sum = Expr { kind: ExprKind::Op(prim, Elem::Time, args), ty: Types::elem(Elem::Time), span };
        let ty = Types::elem(result);
        Operand::Value { expr: retype(sum, ty), ty }
    }

    #[allow(clippy::too_many_arguments)]
    fn scale(
        &mut self,
        op: Op,
        time: Operand,
        factor: Operand,
        time_elem: Option<Elem>,
        factor_elem: Option<Elem>,
        sides: [Span; 2],
        span: Span,
    ) -> Operand {
        let ty = Types::elem(time_elem.unwrap_or(Elem::Time));
        let time = self.settle(time, sides[0]);
        let factor = self.settle(factor, sides[1]);
        // Whole numbers are widened to 64 bits, reals to LREAL: one formula for each.
        let by = match factor_elem.or(self.elem_of(factor.ty)) {
            Some(e) if e.is_real() => Elem::Lreal,
            Some(Elem::Ulint) => Elem::Ulint,
            _ => Elem::Lint,
        };
        if op == Op::TimeDiv && by != Elem::Lreal && matches!(factor.kind, ExprKind::Const(0)) {
            return self.zero_divisor(sides[1]);
        }
        let factor = self.with_elem(factor, by, sides[1]);
        Operand::value(ExprKind::Op(op, by, vec![time, factor]), ty, span)
    }
}
