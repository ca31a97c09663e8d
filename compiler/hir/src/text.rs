//! Strings: which kinds meet, what an operation on them gives, single characters (semantics.md \[T2\] \[T6\] \[T8\] \[N2\]).

use crate::body::*;
use crate::expr::*;
use crate::resolve::LONGEST_STRING;
use crate::types::{Type as Ty, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::{Elem, Family};
use plcc_stdlib::funcs::{Meaning, StdFn, TextOp, Type};
use plcc_stdlib::ops::Op;
use plcc_stdlib::value::longest_text;
use plcc_syntax::ast;

/// The name of a conversion to the same type from another one: `INT_TO_TIME` beside `STRING_TO_TIME`.
fn same_conversion(func: &StdFn, from: &str) -> Option<String> {
    let (_, to) = func.name.split_once("_TO_").filter(|_| matches!(func.meaning, Meaning::Text(_)))?;
    let name = format!("{from}_TO_{to}");
    plcc_stdlib::funcs::find(&name).map(|_| name)
}

/// What a kind of string is called.
pub(crate) fn keyword(wide: bool) -> &'static str {
    if wide { "WSTRING" } else { "STRING" }
}

/// The type of one character.
fn character_of(wide: bool) -> Elem {
    if wide { Elem::Wchar } else { Elem::Char }
}

impl<'a> Checker<'_, 'a> {
    /// STRING or WSTRING, of a capacity or of any.
    pub fn is_text(&self, ty: TypeId) -> bool {
        self.string_kind(ty).is_some()
    }

    /// Of a STRING or WSTRING: whether it is a WSTRING.
    pub fn string_kind(&self, ty: TypeId) -> Option<bool> {
        match self.cx.defs.types.get(ty) {
            Ty::String { wide, .. } | Ty::AnyString { wide } => Some(*wide),
            _ => None,
        }
    }

    /// The kind of string that a value is, or becomes where a string is needed: a CHAR becomes a STRING (\[T2\]).
    pub fn text_kind(&self, ty: TypeId) -> Option<bool> {
        match self.cx.defs.types.get(ty) {
            Ty::Elem(Elem::Char) => Some(false),
            Ty::Elem(Elem::Wchar) => Some(true),
            _ => self.string_kind(ty),
        }
    }

    /// A value of [`Checker::text_kind`] as a string.
    pub fn as_text(&mut self, expr: Expr, wide: bool) -> Expr {
        if self.is_text(expr.ty) {
            return expr;
        }
        let span = expr.span;
        self.text(TextOp::Write(character_of(wide)), wide, vec![expr], span)
    }

    /// The node of an operation that gives a string or an elementary value; computed at once if its arguments are literals.
    fn text(&mut self, op: TextOp, wide: bool, args: Vec<Expr>, span: Span) -> Expr {
        let ty = self.text_result(op, wide, &args, span);
        let node = Expr { kind: ExprKind::Text { op, wide, args }, ty, span };
        self.cx.folded_text(node)
    }

    fn text_result(&mut self, op: TextOp, wide: bool, args: &[Expr], span: Span) -> TypeId {
        match op {
            TextOp::Len | TextOp::Find => return Types::elem(Elem::Int),
            TextOp::Compare(_) => return Types::elem(Elem::Bool),
            TextOp::Read(elem) => return Types::elem(elem),
            TextOp::Write(elem) => {
                return self.cx.defs.types.intern(Ty::String { wide, capacity: longest_text(elem) });
            }
            _ => {}
        }
        let sum = matches!(op, TextOp::Concat | TextOp::Insert | TextOp::Replace);
        let mut capacity: u64 = 0;
        for arg in args {
            match self.cx.defs.types.get(arg.ty) {
                Ty::String { capacity: c, .. } if sum => capacity += u64::from(*c),
                Ty::String { capacity: c, .. } => capacity = capacity.max(u64::from(*c)),
                Ty::AnyString { .. } => return self.cx.defs.types.intern(Ty::AnyString { wide }),
                _ => {}
            }
        }
        if capacity > u64::from(LONGEST_STRING) {
            let message = format!("the result may have {capacity} characters, {LONGEST_STRING} are kept");
            self.report(
                Diagnostic::new(codes::STRING_CUT, span, message).help("no string is longer; declare shorter ones"),
            );
        }
        let capacity = capacity.min(u64::from(LONGEST_STRING)) as u32;
        self.cx.defs.types.intern(Ty::String { wide, capacity })
    }

    /// `a = b`, `a < b`; at least one side is a string.
    pub fn text_comparison(&mut self, op: Op, operands: [(Expr, TypeId); 2], span: Span) -> Operand {
        let [(a, x), (b, y)] = operands;
        let sides = [a.span, b.span];
        let (Some(kind), Some(other)) = (self.text_kind(x), self.text_kind(y)) else {
            let (text, value) = if self.is_text(x) { (x, y) } else { (y, x) };
            let kind = self.string_kind(text).unwrap_or(false);
            let help = match self.elem_of(value) {
                Some(elem) => format!("convert one side, for example with {}_TO_{}", elem.name(), keyword(kind)),
                None => "only elementary values and strings can be compared".into(),
            };
            return self.cannot_compare(op, x, y, sides, help);
        };
        if kind != other {
            let help = format!("convert one side, for example with {}_TO_{}", keyword(false), keyword(true));
            return self.cannot_compare(op, x, y, sides, help);
        }
        let (a, b) = (self.as_text(a, kind), self.as_text(b, kind));
        let expr = self.text(TextOp::Compare(op), kind, vec![a, b], span);
        let ty = expr.ty;
        Operand::Value { expr, ty }
    }

    fn cannot_compare(&mut self, op: Op, x: TypeId, y: TypeId, sides: [Span; 2], help: String) -> Operand {
        let (left, right) = (self.cx.type_name(x), self.cx.type_name(y));
        self.report(
            Diagnostic::new(
                codes::WRONG_OPERAND,
                sides[1],
                format!("{} cannot compare {left} and {right}", op.symbol()),
            )
            .also(sides[0], format!("this is {left}"))
            .help(help),
        );
        Operand::Error
    }

    /// SEL, MAX, a comparison of several: their meaning for strings, if one of the arguments is a string.
    pub fn selection_of_texts(&self, func: &StdFn, operands: &[(Operand, Span)]) -> Option<TextOp> {
        let texts = operands.iter().any(|(o, _)| self.static_type(o).is_some_and(|ty| self.is_text(ty)));
        match func.meaning {
            _ if !texts || func.bound.is_some() => None,
            Meaning::Compare(op, _) => TextOp::of_comparison(op),
            _ => TextOp::of_selection(&func.name),
        }
    }

    /// A function of strings on checked operands.
    pub fn text_call(
        &mut self,
        func: &'static StdFn,
        op: TextOp,
        operands: Vec<(Operand, Span)>,
        span: Span,
    ) -> Operand {
        let mut kind: Option<(bool, Span)> = None;
        let mut args = Vec::with_capacity(operands.len());
        for (n, (operand, at)) in operands.into_iter().enumerate() {
            let wanted = match func.param_type(n) {
                Some(Type::Integer) => match self.integer_argument(func, operand, at) {
                    Some(arg) => {
                        args.push(arg);
                        continue;
                    }
                    None => return Operand::Error,
                },
                // A value to be converted, or the condition of SEL: it has its type already.
                Some(Type::Fixed(elem)) => {
                    let arg = self.coerce(operand, at, Types::elem(elem));
                    // `MUX_INT_STRING` fixes the type of K; it counts in LINT all the same.
                    args.push(if op == TextOp::Mux { self.with_elem(arg, Elem::Lint, at) } else { arg });
                    continue;
                }
                Some(Type::Text(wide)) => Some(wide),
                _ => None,
            };
            let expr = self.settle(operand, at);
            if expr.ty == Types::ERROR {
                return Operand::Error;
            }
            let Some(own) = self.text_kind(expr.ty) else {
                self.no_text(func, expr.ty, at, wanted.or(kind.map(|k| k.0)).unwrap_or(false));
                return Operand::Error;
            };
            if let Some(wide) = wanted.filter(|wide| *wide != own) {
                let message = format!("{} needs a {}, this is a {}", func.name, keyword(wide), keyword(own));
                let help = same_conversion(func, keyword(own)).map(|name| format!("write {name}(...)"));
                self.report(Diagnostic::new(codes::TYPE_MISMATCH, at, message).help_if(help));
                return Operand::Error;
            }
            if let Some((first, first_at)) = kind.filter(|(first, _)| *first != own) {
                let message = format!("{} cannot combine {} and {}", func.name, keyword(first), keyword(own));
                self.report(
                    Diagnostic::new(codes::WRONG_OPERAND, at, message)
                        .also(first_at, format!("this is a {}", keyword(first)))
                        .help(format!("write {}_TO_{}(...) around one of them", keyword(own), keyword(first))),
                );
                return Operand::Error;
            }
            kind.get_or_insert((own, at));
            args.push(self.as_text(expr, own));
        }
        if args.iter().any(|a| a.ty == Types::ERROR) {
            return Operand::Error;
        }
        let wide = match (func.result, kind) {
            (Type::Text(wide), _) | (_, Some((wide, _))) => wide,
            _ => false,
        };
        let expr = self.text(op, wide, args, span);
        let ty = expr.ty;
        Operand::Value { expr, ty }
    }

    fn no_text(&mut self, func: &StdFn, ty: TypeId, at: Span, wide: bool) {
        let Some(elem) = self.elem_of(ty) else { return self.does_not_take(func, ty, at) };
        let name = self.cx.type_name(ty);
        let help = match same_conversion(func, elem.name()) {
            Some(name) => format!("write {name}(...)"),
            None => format!("convert it: {}_TO_{}(...)", elem.name(), keyword(wide)),
        };
        self.report(
            Diagnostic::new(codes::WRONG_OPERAND, at, format!("{} does not take {name}", func.name)).help(help),
        );
    }

    /// `TO_STRING(x)`.
    pub fn text_of_value(
        &mut self,
        func: &'static StdFn,
        wide: bool,
        (operand, at): (Operand, Span),
        span: Span,
    ) -> Operand {
        let expr = self.settle(operand, at);
        if expr.ty == Types::ERROR {
            return Operand::Error;
        }
        let expr = match (self.string_kind(expr.ty), self.elem_of(expr.ty)) {
            (Some(kind), _) if kind == wide => expr,
            (Some(_), _) => self.text(TextOp::Recode, wide, vec![expr], span),
            (None, Some(elem)) => self.text(TextOp::Write(elem), wide, vec![retype(expr, Types::elem(elem))], span),
            (None, None) => {
                self.does_not_take(func, expr.ty, at);
                return Operand::Error;
            }
        };
        let ty = expr.ty;
        Operand::Value { expr, ty }
    }

    /// `TO_INT('12')`.
    pub fn value_of_text(&mut self, to: Elem, expr: Expr, span: Span) -> Operand {
        let wide = self.string_kind(expr.ty).unwrap_or(false);
        let expr = self.text(TextOp::Read(to), wide, vec![expr], span);
        let ty = expr.ty;
        Operand::Value { expr, ty }
    }

    /// What to write where a string and another type meet.
    pub fn text_help(&self, expr: &Expr, from: TypeId, to: TypeId) -> Option<String> {
        let name = |ty| match (self.string_kind(ty), self.elem_of(ty)) {
            (Some(wide), _) => Some(keyword(wide)),
            (None, Some(elem)) => Some(elem.name()),
            (None, None) => None,
        };
        match (&expr.kind, self.string_kind(to)) {
            (ExprKind::String(_), Some(true)) => return Some("write it in double quotes, as a WSTRING".into()),
            (ExprKind::WString(_), Some(false)) => return Some("write it in single quotes, as a STRING".into()),
            (ExprKind::String(s), None)
                if s.len() == 1 && self.elem_of(to).is_some_and(|e| e.is_integer() || e.is_bits()) =>
            {
                return Some(format!("the code of this character is 16#{:X}", s[0]));
            }
            (ExprKind::String(_) | ExprKind::WString(_), _)
                if self.elem_of(to).is_some_and(|e| e.family() == Family::Char) =>
            {
                return Some("a CHAR is exactly one character".into());
            }
            _ => {}
        }
        Some(format!("write {}_TO_{}(...) to convert it", name(from)?, name(to)?))
    }

    /// `s[i]`: the CHAR at a position from 1; in profile codesys the BYTE at an offset from 0.
    pub fn character(&mut self, mut base: Place, indices: &'a [ast::Expr], span: Span) -> Option<Place> {
        let wide = self.string_kind(base.ty)?;
        let [e] = indices else {
            let name = self.cx.type_name(base.ty);
            self.report(
                Diagnostic::new(codes::WRONG_SUBSCRIPTS, span, format!("{} subscripts for a string", indices.len()))
                    .also(base.span, format!("this is {name}"))
                    .help("one subscript names one character"),
            );
            return None;
        };
        let codesys = self.codesys(span);
        let first = u8::from(!codesys);
        let operand = self.operand(e, None);
        let index = match operand {
            Operand::Int(_) => self.coerce(operand, e.span, Types::elem(Elem::Lint)),
            Operand::Error => return None,
            operand => self.index_value(operand, e.span)?,
        };
        if index.ty == Types::ERROR {
            return None;
        }
        if let (ExprKind::Const(raw), Ty::String { capacity, .. }) = (&index.kind, self.cx.defs.types.get(base.ty)) {
            let (v, last) = (*raw as i64, *capacity);
            if v < i64::from(first) || v > i64::from(last) {
                let message = format!("index {v} is outside the bounds {first}..{last}");
                let help = if codesys {
                    format!("its characters have the indices 0 to {}, a closing 0 may follow", last - 1)
                } else {
                    format!("its characters have the positions 1 to {last}")
                };
                self.report(
                    Diagnostic::new(codes::CONSTANT_INDEX, e.span, message)
                        .also(base.span, "of this string")
                        .help(help),
                );
                return None;
            }
        }
        let name = self.place_text(&base);
        base.steps.push(Step::Character { index: Box::new(index), first, name });
        base.ty = Types::elem(match (codesys, wide) {
            (false, wide) => character_of(wide),
            (true, false) => Elem::Byte,
            (true, true) => Elem::Word,
        });
        base.span = span;
        Some(base)
    }
}
