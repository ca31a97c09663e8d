//! Conversions between integers and BCD (semantics.md \[T6\]): the digits are the business of the function table, here the
//! argument becomes a bit string or ULINT and the result the integer that is named.

use crate::body::*;
use crate::expr::*;
use crate::rules;
use crate::types::Types;
use plcc_diag::Span;
use plcc_stdlib::elem::Elem;
use plcc_stdlib::funcs::{self, StdFn};
use plcc_stdlib::ops::Op;

impl Checker<'_, '_> {
    /// `BCD_TO_INT`, `WORD_BCD_TO_UINT`. An untyped constant is the smallest bit string that holds it.
    pub fn number_of_bcd(
        &mut self,
        func: &'static StdFn,
        number: Elem,
        (operand, at): (Operand, Span),
        span: Span,
    ) -> Operand {
        let pattern = match operand {
            Operand::Int(v) => {
                let fits = [Elem::Byte, Elem::Word, Elem::Dword, Elem::Lword].into_iter().find(|e| rules::holds(*e, v));
                self.coerce(operand, at, Types::elem(fits.unwrap_or(Elem::Lword)))
            }
            operand => self.settle(operand, at),
        };
        let bits = match self.elem_of(pattern.ty) {
            Some(elem) if elem.is_bits() => elem,
            _ => {
                self.does_not_take(func, pattern.ty, at);
                return Operand::Error;
            }
        };
        let Some(row) = funcs::from_bcd() else { return Operand::Error };
        let kind = ExprKind::Std { func: row, elem: bits, args: vec![retype(pattern, Types::elem(bits))] };
        let value = Expr { kind, ty: Types::elem(Elem::Ulint), span };
        let ty = Types::elem(number);
        Operand::Value { expr: self.with_elem(value, number, span), ty }
    }

    /// `TO_BCD_WORD`, `UINT_TO_BCD_WORD`.
    pub fn bcd_of_number(
        &mut self,
        func: &'static StdFn,
        bits: Elem,
        (operand, at): (Operand, Span),
        span: Span,
    ) -> Operand {
        let number = self.settle(operand, at);
        let number = match self.elem_of(number.ty) {
            Some(Elem::Ulint) => retype(number, Types::elem(Elem::Ulint)),
            Some(elem) if elem.is_integer() => {
                // Negative numbers are 0.
                let ty = Types::elem(Elem::Lint);
                let zero = Expr { kind: ExprKind::Const(0), ty, span: at };
                let args = vec![self.with_elem(number, Elem::Lint, at), zero];
                let positive = Expr { kind: ExprKind::Op(Op::Max, Elem::Lint, args), ty, span: at };
                self.with_elem(positive, Elem::Ulint, at)
            }
            _ => {
                self.does_not_take(func, number.ty, at);
                return Operand::Error;
            }
        };
        let Some(row) = funcs::to_bcd() else { return Operand::Error };
        Operand::value(ExprKind::Std { func: row, elem: bits, args: vec![number] }, Types::elem(bits), span)
    }
}
