//! Comparisons: of numbers, times, enumerations, references, strings.

use crate::body::*;
use crate::expr::*;
use crate::operators::{BOOL, Exact, exact};
use crate::rules;
use crate::types::{Type, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::Elem;
use plcc_stdlib::ops::Op;
use plcc_syntax::ast::BinaryOp;

impl Checker<'_, '_> {
    pub fn comparison(
        &mut self,
        op: BinaryOp,
        at: Span,
        a: Operand,
        b: Operand,
        sides: [Span; 2],
        span: Span,
    ) -> Operand {
        let prim = match op {
            BinaryOp::Lt => Op::Lt,
            BinaryOp::Gt => Op::Gt,
            BinaryOp::Le => Op::Le,
            BinaryOp::Ge => Op::Ge,
            BinaryOp::Eq => Op::Eq,
            _ => Op::Ne,
        };
        let equality = matches!(prim, Op::Eq | Op::Ne);
        if let (Some(x), Some(y)) = (exact(&a), exact(&b)) {
            let order = match (x, y) {
                (Exact::Int(x), Exact::Int(y)) => Some(x.cmp(&y)),
                (x, y) => x.real().partial_cmp(&y.real()),
            };
            let holds = order.is_some_and(|o| match op {
                BinaryOp::Lt => o.is_lt(),
                BinaryOp::Gt => o.is_gt(),
                BinaryOp::Le => o.is_le(),
                BinaryOp::Ge => o.is_ge(),
                BinaryOp::Eq => o.is_eq(),
                _ => o.is_ne(),
            });
            return Operand::value(ExprKind::Const(u64::from(holds)), BOOL(), span);
        }
        let (x, y) = (self.static_type(&a), self.static_type(&b));
        if x == Some(Types::ERROR) || y == Some(Types::ERROR) {
            return Operand::Error;
        }
        if let Some(result) = self.reference_comparison(prim, &a, &b, sides, span) {
            return result;
        }
        if let (Some(x), Some(y)) = (x, y)
            && let Some(result) = self.special_comparison(prim, &a, &b, x, y, span)
        {
            return result;
        }
        let codesys = self.codesys(span);
        let mut elems = [None, None];
        for (i, ty) in [x, y].into_iter().enumerate() {
            let Some(ty) = ty else { continue };
            let enumeration = matches!(self.cx.defs.types.get(ty), Type::Enum(_));
            match self.elem_of(ty) {
                Some(_) if enumeration => {
                    // The other side is no value of this enumeration: a constant or another type.
                    let (x, y) = (x.unwrap_or(Types::elem(Elem::Int)), y.unwrap_or(Types::elem(Elem::Int)));
                    return self.no_common(op.text(), x, y, sides, span);
                }
                Some(Elem::Bool) if !equality && i == 0 && is_comparison(&a) => {
                    let help = "a comparison gives BOOL; write both and join them: `1 < x AND x < 5`";
                    return self.no_operator(op.text(), ty, sides[i], help);
                }
                Some(Elem::Bool) if !equality => {
                    return self.no_operator(op.text(), ty, sides[i], "BOOL has no order; use = or <>");
                }
                Some(elem) if elem.is_bits() && !equality => {
                    let number = rules::as_number(elem);
                    let strict = self
                        .wrong_operand(op.text(), ty, sides[i], "a bit string has no order")
                        .help(format!("convert it with {}", rules::conversion_name(elem, number)));
                    if !self.codesys_only(span, codes::LAX_CONVERSION, strict) {
                        return Operand::Error;
                    }
                    elems[i] = Some(number);
                }
                Some(elem) => elems[i] = Some(elem),
                None if self.is_text(ty) => {
                    let help = "a text is compared with a text: write the number in quotes, or TO_STRING(...)";
                    return self.no_operator(op.text(), ty, sides[i], help);
                }
                None => return self.no_operator(op.text(), ty, sides[i], "only elementary values can be compared"),
            }
        }
        let common = match (elems[0], elems[1]) {
            (Some(x), Some(y)) => rules::common(x, y, codesys),
            (Some(x), None) => Some(self.beside_constant(x, &b, None, codesys)),
            (None, Some(y)) => Some(self.beside_constant(y, &a, None, codesys)),
            (None, None) => None,
        };
        let Some(common) = common else {
            return self.no_common(op.text(), x.unwrap_or(Types::ERROR), y.unwrap_or(Types::ERROR), sides, span);
        };
        let (untyped_a, untyped_b) = (x.is_none(), y.is_none());
        let mut a = self.operand_as(a, sides[0], common);
        let mut b = self.operand_as(b, sides[1], common);
        if a.ty == Types::ERROR || b.ty == Types::ERROR {
            return Operand::Error;
        }
        // Profile codesys may have computed one side wider: compare there.
        let wide = match (self.elem_of(a.ty), self.elem_of(b.ty)) {
            (Some(x), Some(y)) if x != y => {
                if x.bits() >= y.bits() {
                    x
                } else {
                    y
                }
            }
            (Some(x), _) => x,
            _ => common,
        };
        a = self.with_elem(a, wide, sides[0]);
        b = self.with_elem(b, wide, sides[1]);
        if equality && wide.is_real() {
            let zero = |e: &Expr, untyped: bool| untyped && matches!(e.kind, ExprKind::Const(0));
            if !zero(&a, untyped_a) && !zero(&b, untyped_b) {
                self.report(
                    Diagnostic::new(codes::REAL_EQUALITY, at, format!("{} compares reals for equality", op.text()))
                        .help("rounding makes this unreliable; compare the distance: ABS(a - b) < limit"),
                );
            }
        }
        Operand::value(ExprKind::Op(prim, wide, vec![a, b]), BOOL(), span)
    }

    /// Comparisons of what is not a plain elementary type: enumerations, strings.
    fn special_comparison(
        &mut self,
        op: Op,
        a: &Operand,
        b: &Operand,
        x: TypeId,
        y: TypeId,
        span: Span,
    ) -> Option<Operand> {
        let pair = |a: &Operand, b: &Operand| match (a, b) {
            (Operand::Value { expr: a, .. }, Operand::Value { expr: b, .. }) => Some((a.clone(), b.clone())),
            _ => None,
        };
        let types = &self.cx.defs.types;
        let elem = match (types.get(x), types.get(y)) {
            (Type::Enum(i), Type::Enum(j)) if i == j => self.cx.defs.enums[*i].base,
            _ if self.is_text(x) || self.is_text(y) => {
                let (a, b) = pair(a, b)?;
                return Some(self.text_comparison(op, [(a, x), (b, y)], span));
            }
            _ => return None,
        };
        let (a, b) = pair(a, b)?;
        let ty = Types::elem(elem);
        let args = vec![retype(a, ty), retype(b, ty)];
        Some(Operand::value(ExprKind::Op(op, elem, args), BOOL(), span))
    }
}

fn is_comparison(operand: &Operand) -> bool {
    let Operand::Value { expr, .. } = operand else { return false };
    matches!(&expr.kind, ExprKind::Op(Op::Lt | Op::Le | Op::Gt | Op::Ge | Op::Eq | Op::Ne, ..))
}
