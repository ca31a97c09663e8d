//! Unary and binary operators: which type an operation is done in, and exact arithmetic on untyped constants.

use crate::body::*;
use crate::defs::*;
use crate::expr::*;
use crate::rules;
use crate::types::{Type, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::{Elem, Family};
use plcc_stdlib::ops::Op;
use plcc_syntax::ast::{self, BinaryOp, UnaryOp};

pub(crate) const BOOL: fn() -> TypeId = || Types::elem(Elem::Bool);

impl<'a> Checker<'_, 'a> {
    pub fn unary(&mut self, op: UnaryOp, operand: &'a ast::Expr, span: Span, want: Option<TypeId>) -> Operand {
        let inner = self.operand(operand, want);
        self.unary_operand(op, inner, operand.span, span, want)
    }

    /// A prefix operator on a checked operand, which stands at `at`.
    pub fn unary_operand(
        &mut self,
        op: UnaryOp,
        inner: Operand,
        at: Span,
        span: Span,
        want: Option<TypeId>,
    ) -> Operand {
        match op {
            UnaryOp::Plus => inner,
            UnaryOp::Neg => self.negate(inner, span),
            UnaryOp::Not => self.complement(inner, at, span, want),
        }
    }

    fn negate(&mut self, operand: Operand, span: Span) -> Operand {
        match operand {
            Operand::Int(v) => Operand::Int(-v),
            Operand::Real(v) => Operand::Real(-v),
            Operand::Error => Operand::Error,
            Operand::Value { expr, ty } => {
                let Some(elem) = self.elem_of(ty).filter(|e| *e != Elem::Bool) else {
                    return self.no_operator("-", ty, span, "it needs a number or a duration");
                };
                let signed = match elem.family() {
                    Family::Signed | Family::Real | Family::Duration => elem,
                    Family::Unsigned | Family::Bits => {
                        let name = self.cx.type_name(ty);
                        let strict =
                            Diagnostic::new(codes::WRONG_OPERAND, span, format!("the negative of {name} is no {name}"))
                                .help(format!(
                                    "convert it to a signed type first, for example with {}",
                                    rules::conversion_name(elem, rules::integer((elem.bits() * 2).min(64), true))
                                ));
                        if !self.codesys_only(span, codes::LAX_CONVERSION, strict) {
                            return Operand::Error;
                        }
                        rules::integer((elem.bits() * 2).min(64), true)
                    }
                    _ => return self.no_operator("-", ty, span, "it needs a number or a duration"),
                };
                let wide = self.width(signed, span);
                let arg = self.with_elem(expr, wide, span);
                let kind = ExprKind::Op(Op::Neg, wide, vec![arg]);
                let static_ty = if signed == elem { base_type(&self.cx.defs, ty) } else { Types::elem(signed) };
                Operand::Value { expr: Expr { kind, ty: Types::elem(wide), span }, ty: static_ty }
            }
        }
    }

    fn complement(&mut self, inner: Operand, at: Span, span: Span, want: Option<TypeId>) -> Operand {
        let (expr, ty) = match inner {
            Operand::Error => return Operand::Error,
            Operand::Value { expr, ty } => (expr, ty),
            Operand::Int(_) | Operand::Real(_) => {
                let place = want.filter(|w| self.elem_of(*w).is_some_and(|e| e == Elem::Bool || e.is_bits()));
                let expr = match (place, &inner) {
                    (Some(place), Operand::Int(_)) => self.coerce(inner, at, place),
                    (None, Operand::Int(0 | 1)) => self.coerce(inner, at, BOOL()),
                    _ => {
                        let help = "it needs BOOL or a bit string, such as WORD#16#FF";
                        return self.no_operator("NOT", Types::elem(Elem::Int), span, help);
                    }
                };
                let ty = expr.ty;
                (expr, ty)
            }
        };
        if ty == Types::ERROR {
            return Operand::Error;
        }
        match self.elem_of(ty) {
            Some(elem) if elem == Elem::Bool || elem.is_bits() => {
                let wide = self.width(elem, span);
                let arg = self.with_elem(expr, wide, span);
                let kind = ExprKind::Op(Op::Not, wide, vec![arg]);
                Operand::Value { expr: Expr { kind, ty: Types::elem(wide), span }, ty: base_type(&self.cx.defs, ty) }
            }
            Some(elem) if elem.is_integer() => {
                let strict = self.wrong_operand("NOT", ty, span, "it needs BOOL or a bit string");
                if !self.codesys_only(span, codes::LAX_CONVERSION, strict) {
                    return Operand::Error;
                }
                let wide = self.width(elem, span);
                let arg = self.with_elem(expr, wide, span);
                let kind = ExprKind::Op(
                    Op::Xor,
                    bits_of(wide),
                    vec![
                        retype(arg, Types::elem(bits_of(wide))),
                        Expr { kind: ExprKind::Const(wide.repr().mask()), ty: Types::elem(bits_of(wide)), span },
                    ],
                );
                let expr = retype(Expr { kind, ty: Types::elem(bits_of(wide)), span }, Types::elem(wide));
                Operand::Value { expr, ty: base_type(&self.cx.defs, ty) }
            }
            _ => self.no_operator("NOT", ty, span, "it needs BOOL or a bit string"),
        }
    }

    pub fn wrong_operand(&self, op: &str, ty: TypeId, span: Span, help: &str) -> Diagnostic {
        let name = self.cx.type_name(ty);
        Diagnostic::new(codes::WRONG_OPERAND, span, format!("{op} does not take {name}")).help(help)
    }

    pub fn no_operator(&mut self, op: &str, ty: TypeId, span: Span, help: &str) -> Operand {
        if ty != Types::ERROR {
            let help = if self.is_text(ty) && op == "+" { "CONCAT(...) joins texts" } else { help };
            let d = self.wrong_operand(op, ty, span, help);
            self.report(d);
        }
        Operand::Error
    }

    /// The type in which an operation is done: its own, or at least 32 bits in profile codesys.
    pub fn width(&self, elem: Elem, span: Span) -> Elem {
        if self.codesys(span) { rules::computed(elem) } else { elem }
    }

    /// An expression of elementary type as another one, without judging whether that is allowed.
    pub fn with_elem(&mut self, expr: Expr, elem: Elem, span: Span) -> Expr {
        let ty = Types::elem(elem);
        match self.elem_of(expr.ty) {
            None => expr,
            Some(from) if from == elem => retype(expr, ty),
            Some(from) => {
                if let ExprKind::Const(raw) = expr.kind
                    && let Some(raw) = crate::consts::convert(from, elem, raw)
                {
                    return Expr { kind: ExprKind::Const(raw), ty, span };
                }
                Expr { kind: ExprKind::Convert(from, elem, Box::new(expr)), ty, span }
            }
        }
    }

    pub fn binary(
        &mut self,
        op: BinaryOp,
        at: Span,
        left: &'a ast::Expr,
        right: &'a ast::Expr,
        span: Span,
        want: Option<TypeId>,
    ) -> Operand {
        use BinaryOp::*;
        let inner_want = match op {
            Lt | Gt | Le | Ge | Eq | Ne => None,
            AndThen | OrElse => Some(BOOL()),
            _ => want,
        };
        let a = self.operand(left, inner_want);
        // The second operand of a comparison may name a value of the first one's enumeration.
        let other = match op {
            Lt | Gt | Le | Ge | Eq | Ne => self.static_type(&a),
            _ => inner_want,
        };
        let b = self.operand(right, other);
        let sides = [left.span, right.span];
        self.binary_operands(op, at, a, b, sides, span, want)
    }

    #[allow(clippy::too_many_arguments)]
    pub fn binary_operands(
        &mut self,
        op: BinaryOp,
        at: Span,
        a: Operand,
        b: Operand,
        sides: [Span; 2],
        span: Span,
        want: Option<TypeId>,
    ) -> Operand {
        use BinaryOp::*;
        if matches!(a, Operand::Error) || matches!(b, Operand::Error) {
            return Operand::Error;
        }
        match op {
            And | Or | Xor => self.bitwise(op, a, b, sides, span, want),
            AndThen | OrElse => {
                let a = self.coerce(a, sides[0], BOOL());
                let b = self.coerce(b, sides[1], BOOL());
                let kind = match op {
                    AndThen => ExprKind::AndThen(Box::new(a), Box::new(b)),
                    _ => ExprKind::OrElse(Box::new(a), Box::new(b)),
                };
                Operand::value(kind, BOOL(), span)
            }
            Lt | Gt | Le | Ge | Eq | Ne => self.comparison(op, at, a, b, sides, span),
            Add | Sub | Mul | Div | Mod => self.arithmetic(op, at, a, b, sides, span, want),
            Power => self.power(a, b, sides, span, want),
        }
    }

    fn bitwise(
        &mut self,
        op: BinaryOp,
        a: Operand,
        b: Operand,
        sides: [Span; 2],
        span: Span,
        want: Option<TypeId>,
    ) -> Operand {
        let prim = match op {
            BinaryOp::And => Op::And,
            BinaryOp::Or => Op::Or,
            _ => Op::Xor,
        };
        let (x, y) = match (&a, &b) {
            (Operand::Int(x), Operand::Int(y)) => {
                return Operand::Int(match op {
                    BinaryOp::And => x & y,
                    BinaryOp::Or => x | y,
                    _ => x ^ y,
                });
            }
            (Operand::Value { ty, .. }, Operand::Int(_) | Operand::Real(_)) => (*ty, *ty),
            (Operand::Int(_) | Operand::Real(_), Operand::Value { ty, .. }) => (*ty, *ty),
            (Operand::Value { ty: x, .. }, Operand::Value { ty: y, .. }) => (*x, *y),
            _ => (want.unwrap_or(Types::elem(Elem::Lreal)), Types::elem(Elem::Lreal)),
        };
        if x == Types::ERROR || y == Types::ERROR {
            return Operand::Error;
        }
        let (Some(ex), Some(ey)) = (self.elem_of(x), self.elem_of(y)) else {
            let bad = if self.elem_of(x).is_none() { x } else { y };
            return self.no_operator(op.text(), bad, span, "it needs BOOL or bit strings on both sides");
        };
        let logical = |e: Elem| e == Elem::Bool || e.is_bits();
        if !logical(ex) || !logical(ey) {
            let (bad, at) = if logical(ex) { (y, sides[1]) } else { (x, sides[0]) };
            let bad_elem = if logical(ex) { ey } else { ex };
            let mut d = self.wrong_operand(op.text(), bad, at, "it needs BOOL or a bit string on both sides");
            if bad_elem.is_integer() {
                d = d.help(format!(
                    "convert it, for example with {}",
                    rules::conversion_name(bad_elem, bits_of(bad_elem))
                ));
            }
            let both_numbers = |e: Elem| e.is_integer() || e.is_bits();
            if !(both_numbers(ex) && both_numbers(ey)) {
                self.report(d);
                return Operand::Error;
            }
            if !self.codesys_only(span, codes::LAX_CONVERSION, d) {
                return Operand::Error;
            }
        }
        let common =
            if (ex == Elem::Bool) != (ey == Elem::Bool) { None } else { rules::common(ex, ey, self.codesys(span)) };
        let Some(common) = common else { return self.no_common(op.text(), x, y, sides, span) };
        // Integers (codesys) are combined as the bit strings of their width and stay what they are.
        let work = bits_of(common);
        let a = self.operand_as(a, sides[0], common);
        let b = self.operand_as(b, sides[1], common);
        if a.ty == Types::ERROR || b.ty == Types::ERROR {
            return Operand::Error;
        }
        let wide = self.width(common, span);
        let work = if wide == common { work } else { bits_of(wide) };
        let a = self.with_elem(a, wide, sides[0]);
        let b = self.with_elem(b, wide, sides[1]);
        let kind = ExprKind::Op(prim, work, vec![retype(a, Types::elem(work)), retype(b, Types::elem(work))]);
        let expr = retype(Expr { kind, ty: Types::elem(work), span }, Types::elem(wide));
        Operand::Value { expr, ty: Types::elem(common) }
    }

    /// An operand for an operation in `common`: constants must fit, values convert as the profile allows; what profile
    /// codesys computed wider stays wide.
    pub fn operand_as(&mut self, operand: Operand, span: Span, common: Elem) -> Expr {
        match operand {
            Operand::Value { expr, .. } => {
                let actual = self.elem_of(expr.ty).unwrap_or(common);
                if self.codesys(span) && actual.bits() > common.bits() && actual.is_integer() == common.is_integer() {
                    return expr;
                }
                // `common` was chosen so that this conversion is legal.
                self.with_elem(expr, common, span)
            }
            constant => self.coerce(constant, span, Types::elem(common)),
        }
    }

    pub fn no_common(&mut self, op: &str, x: TypeId, y: TypeId, sides: [Span; 2], span: Span) -> Operand {
        let (nx, ny) = (self.cx.type_name(x), self.cx.type_name(y));
        let mut d = Diagnostic::new(codes::WRONG_OPERAND, span, format!("{op} cannot combine {nx} and {ny}"))
            .also(sides[0], format!("this is {nx}"))
            .also(sides[1], format!("this is {ny}"));
        if let (Some(a), Some(b)) = (self.elem_of(x), self.elem_of(y)) {
            let enums = [x, y].iter().any(|t| matches!(self.cx.defs.types.get(*t), Type::Enum(_)));
            if !enums {
                d = d.help(conversion_help(a, b));
            }
            if a.is_integer() && b.is_integer() || a.is_bits() != b.is_bits() {
                self.cx.codesys_only += 1;
            }
        }
        self.report(d);
        Operand::Error
    }

    #[allow(clippy::too_many_arguments)]
    fn arithmetic(
        &mut self,
        op: BinaryOp,
        at: Span,
        a: Operand,
        b: Operand,
        sides: [Span; 2],
        span: Span,
        want: Option<TypeId>,
    ) -> Operand {
        if let (Some(x), Some(y)) = (exact(&a), exact(&b)) {
            return self.exact_arithmetic(op, x, y, at, span);
        }
        if let Some(result) = self.reference_arithmetic(op, &a, &b, sides, span) {
            return result;
        }
        let (ea, eb) = match self.arithmetic_elems(op, &a, &b, sides, span) {
            Some(elems) => elems,
            None => return Operand::Error,
        };
        if [ea, eb].into_iter().flatten().any(|e| e.is_time_like()) {
            return self.time_arithmetic(op, a, b, ea, eb, sides, span);
        }
        let codesys = self.codesys(span);
        let common = match (ea, eb) {
            (Some(x), Some(y)) => rules::common(x, y, codesys),
            (Some(x), None) => Some(self.beside_constant(x, &b, want, codesys)),
            (None, Some(y)) => Some(self.beside_constant(y, &a, want, codesys)),
            (None, None) => None,
        };
        let Some(common) = common else {
            let (x, y) = (self.static_type(&a), self.static_type(&b));
            return self.no_common(op.text(), x.unwrap_or(Types::ERROR), y.unwrap_or(Types::ERROR), sides, span);
        };
        if op == BinaryOp::Mod && common.is_real() {
            return self.no_operator("MOD", Types::elem(common), span, "it needs integers");
        }
        for (operand, side) in [(&a, sides[0]), (&b, sides[1])] {
            if let Operand::Value { ty, .. } = operand
                && let Some(from) = self.elem_of(*ty)
                && rules::implicit(from, common) == rules::Implicit::Rounds
                && !matches!(operand, Operand::Value { expr, .. } if matches!(expr.kind, ExprKind::Const(_)))
            {
                self.loses_precision(from, common, side);
            }
        }
        let wide = self.width(common, span);
        let a = self.operand_as(a, sides[0], common);
        let b = self.operand_as(b, sides[1], common);
        if a.ty == Types::ERROR || b.ty == Types::ERROR {
            return Operand::Error;
        }
        let a = self.with_elem(a, wide, sides[0]);
        let b = self.with_elem(b, wide, sides[1]);
        let prim = match op {
            BinaryOp::Add => Op::Add,
            BinaryOp::Sub => Op::Sub,
            BinaryOp::Mul => Op::Mul,
            BinaryOp::Div => Op::Div,
            _ => Op::Mod,
        };
        if matches!(prim, Op::Div | Op::Mod) && wide.is_integer() && matches!(b.kind, ExprKind::Const(0)) {
            return self.zero_divisor(sides[1]);
        }
        Operand::Value {
            expr: Expr { kind: ExprKind::Op(prim, wide, vec![a, b]), ty: Types::elem(wide), span },
            ty: Types::elem(common),
        }
    }

    pub fn zero_divisor(&mut self, span: Span) -> Operand {
        self.report(
            Diagnostic::new(codes::ZERO_DIVISOR, span, "division by the constant 0")
                .help("the divisor must not be 0; for REAL write 0.0 to get an infinity"),
        );
        Operand::Error
    }

    /// The numeric types of both operands (`None` for an untyped constant); bit strings count as unsigned in codesys.
    fn arithmetic_elems(
        &mut self,
        op: BinaryOp,
        a: &Operand,
        b: &Operand,
        sides: [Span; 2],
        span: Span,
    ) -> Option<(Option<Elem>, Option<Elem>)> {
        let mut elems = [None, None];
        for (i, operand) in [a, b].into_iter().enumerate() {
            let Operand::Value { ty, .. } = operand else { continue };
            if *ty == Types::ERROR {
                return None;
            }
            let enumeration = matches!(self.cx.defs.types.get(*ty), Type::Enum(_));
            let elem = self.elem_of(*ty).filter(|e| *e != Elem::Bool && e.family() != Family::Char && !enumeration);
            match elem {
                None => {
                    self.no_operator(op.text(), *ty, sides[i], "it needs numbers");
                    return None;
                }
                Some(elem) if elem.is_bits() => {
                    let number = rules::as_number(elem);
                    let strict = self
                        .wrong_operand(op.text(), *ty, sides[i], "a bit string is no number")
                        .help(format!("convert it with {}", rules::conversion_name(elem, number)));
                    if !self.codesys_only(span, codes::LAX_CONVERSION, strict) {
                        return None;
                    }
                    elems[i] = Some(number);
                }
                other => elems[i] = other,
            }
        }
        Some((elems[0], elems[1]))
    }

    /// The type of an operation between a value and an untyped constant. Profile codesys widens it for a constant that does not fit.
    pub fn beside_constant(&mut self, elem: Elem, constant: &Operand, want: Option<TypeId>, codesys: bool) -> Elem {
        match constant {
            // A real literal makes the operation real: as the place asks, else LREAL.
            Operand::Real(_) if !elem.is_real() => match want.and_then(|w| self.elem_of(w)) {
                Some(Elem::Real) => Elem::Real,
                _ => Elem::Lreal,
            },
            Operand::Int(v) if elem.is_integer() && !rules::holds(elem, *v) => {
                let own = rules::default_integer(*v).unwrap_or(Elem::Lint);
                let wider = rules::common(elem, own, true).unwrap_or(elem);
                if codesys {
                    return wider;
                }
                self.cx.codesys_only += usize::from(rules::holds(wider, *v));
                elem
            }
            _ => elem,
        }
    }

    fn exact_arithmetic(&mut self, op: BinaryOp, a: Exact, b: Exact, at: Span, span: Span) -> Operand {
        let (x, y) = match (a, b) {
            (Exact::Int(x), Exact::Int(y)) => {
                let result = match op {
                    BinaryOp::Add => x.checked_add(y),
                    BinaryOp::Sub => x.checked_sub(y),
                    BinaryOp::Mul => x.checked_mul(y),
                    _ if y == 0 => return self.zero_divisor(span),
                    BinaryOp::Div => x.checked_div(y),
                    _ => x.checked_rem(y),
                };
                return match result {
                    Some(v) => Operand::Int(v),
                    None => {
                        self.report(
                            Diagnostic::new(codes::OUT_OF_RANGE, span, "this constant is too large")
                                .help("the largest integer type is ULINT, up to 2^64-1"),
                        );
                        Operand::Error
                    }
                };
            }
            (a, b) => (a.real(), b.real()),
        };
        Operand::Real(match op {
            BinaryOp::Add => x + y,
            BinaryOp::Sub => x - y,
            BinaryOp::Mul => x * y,
            BinaryOp::Div => x / y,
            _ => return self.no_operator("MOD", Types::elem(Elem::Lreal), at, "it needs integers"),
        })
    }

    /// A feature whose place is laid but that is not built.
    pub fn not_yet(&mut self, span: Span, what: &str) -> Operand {
        self.report(Diagnostic::new(codes::NOT_YET, span, format!("{what} is not implemented yet")));
        Operand::Error
    }

    /// `**`: the real base's type; an integer base becomes REAL (up to 16 bit) or LREAL (\[T5\]).
    fn power(&mut self, a: Operand, b: Operand, sides: [Span; 2], span: Span, want: Option<TypeId>) -> Operand {
        if let (Some(x), Some(y)) = (exact(&a), exact(&b)) {
            return Operand::Real(x.real().powf(y.real()));
        }
        let Some((ea, _)) = self.arithmetic_elems(BinaryOp::Power, &a, &b, sides, span) else { return Operand::Error };
        let base = match (ea, want.and_then(|w| self.elem_of(w))) {
            (Some(e), _) if e.is_real() => e,
            (Some(e), _) if e.is_integer() => {
                if e.bits() <= 16 {
                    Elem::Real
                } else {
                    Elem::Lreal
                }
            }
            (None, Some(Elem::Real)) => Elem::Real,
            (None, _) => Elem::Lreal,
            (Some(e), _) => return self.no_operator("**", Types::elem(e), sides[0], "it needs numbers"),
        };
        let a = self.settle(a, sides[0]);
        let b = self.settle(b, sides[1]);
        if self.elem_of(b.ty).is_some_and(|e| e.is_time_like()) {
            return self.no_operator("**", b.ty, sides[1], "it needs numbers");
        }
        if a.ty == Types::ERROR || b.ty == Types::ERROR {
            return Operand::Error;
        }
        let a = self.with_elem(a, base, sides[0]);
        let b = self.with_elem(b, base, sides[1]);
        Operand::value(ExprKind::Op(Op::Power, base, vec![a, b]), Types::elem(base), span)
    }
}

/// An untyped constant.
#[derive(Clone, Copy)]
pub(crate) enum Exact {
    Int(i128),
    Real(f64),
}

impl Exact {
    pub fn real(self) -> f64 {
        match self {
            Exact::Int(v) => v as f64,
            Exact::Real(v) => v,
        }
    }
}

pub(crate) fn exact(operand: &Operand) -> Option<Exact> {
    match operand {
        Operand::Int(v) => Some(Exact::Int(*v)),
        Operand::Real(v) => Some(Exact::Real(*v)),
        _ => None,
    }
}

/// The bit string of an integer's width; bit strings and BOOL unchanged.
pub(crate) fn bits_of(elem: Elem) -> Elem {
    if !elem.is_integer() {
        return elem;
    }
    match elem.bits() {
        8 => Elem::Byte,
        16 => Elem::Word,
        32 => Elem::Dword,
        _ => Elem::Lword,
    }
}

/// The static type of an operation's result: a subrange's base, other types unchanged.
fn base_type(defs: &Defs, ty: TypeId) -> TypeId {
    match defs.types.get(ty) {
        Type::Subrange { base, .. } => Types::elem(*base),
        _ => ty,
    }
}
