//! The one expression checker: an expression as written and the type its place asks for, to a typed expression.
//!
//! Literals have no type of their own (semantics.md \[T3\]): [`Operand`] carries them exactly until their place or the other
//! operand gives one. Operators are in `operators`, places in `place`, calls in `call`, literals in `literal`.

use crate::body::*;
use crate::cx::*;
use crate::defs::*;
use crate::init::Init;
use crate::place::Found;
use crate::rules::{self, Implicit};
use crate::types::{RefKind, Type, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::{Elem, Family};
use plcc_stdlib::ops::Op;
use plcc_syntax::ast;

/// Checks expressions in the scope of one POU (or of none, for types and globals).
pub(crate) struct Checker<'c, 'a> {
    pub cx: &'c mut Cx<'a>,
    /// Whose names are visible; for an action its owner.
    pub scope: Option<PouId>,
    /// What a body adds; empty for constants.
    pub temps: index_vec::IndexVec<TempId, TypeId>,
}

/// A checked operand before its place gave it a type.
#[derive(Debug, Clone)]
pub(crate) enum Operand {
    /// An integer constant without type.
    Int(i128),
    /// A real constant without type.
    Real(f64),
    /// A typed value. `ty` is its static type; in profile codesys the expression may be computed wider (\[P3\]).
    Value { expr: Expr, ty: TypeId },
    /// Reported already.
    Error,
}

impl Operand {
    pub fn value(kind: ExprKind, ty: TypeId, span: Span) -> Self {
        Operand::Value { expr: Expr { kind, ty, span }, ty }
    }
}

pub(crate) fn error_expr(span: Span) -> Expr {
    Expr { kind: ExprKind::Error, ty: Types::ERROR, span }
}

impl<'c, 'a> Checker<'c, 'a> {
    /// A checker for a constant: a bound, an initial value.
    pub fn constant(cx: &'c mut Cx<'a>, scope: Option<PouId>) -> Self {
        Self { cx, scope, temps: Default::default() }
    }

    pub fn codesys(&self, span: Span) -> bool {
        self.cx.codesys(span)
    }

    pub fn report(&mut self, diagnostic: Diagnostic) {
        self.cx.push(diagnostic);
    }

    /// Reports what strict refuses and codesys accepts: an error there, the warning `lax` here. Whether to go on.
    pub fn codesys_only(&mut self, span: Span, lax: plcc_diag::Code, strict: Diagnostic) -> bool {
        if self.codesys(span) {
            self.report(Diagnostic { code: lax, help: Vec::new(), ..strict });
            return true;
        }
        self.cx.codesys_only += 1;
        self.report(strict);
        false
    }

    pub fn elem_of(&self, ty: TypeId) -> Option<Elem> {
        self.cx.elem_of(ty)
    }

    /// An expression where `want` is the type of its place. A REFERENCE TO is bound to the variable that it names.
    pub fn value(&mut self, e: &'a ast::Expr, want: TypeId) -> Expr {
        if self.is_reference_to(want) {
            return self.reference_value(e, want);
        }
        let operand = self.operand(e, Some(want));
        self.coerce(operand, e.span, want)
    }

    /// An expression where nothing gives a type.
    pub fn any_value(&mut self, e: &'a ast::Expr) -> Expr {
        let operand = self.operand(e, None);
        self.settle(operand, e.span)
    }

    /// A condition.
    pub fn condition(&mut self, e: &'a ast::Expr) -> Expr {
        self.value(e, Types::elem(Elem::Bool))
    }

    /// Gives an operand its own type: that of a value, or the default of an untyped constant.
    pub fn settle(&mut self, operand: Operand, span: Span) -> Expr {
        match operand {
            Operand::Int(v) => match rules::default_integer(v) {
                Some(elem) => self.coerce(Operand::Int(v), span, Types::elem(elem)),
                None => {
                    self.report(
                        Diagnostic::new(codes::OUT_OF_RANGE, span, format!("{v} fits no integer type"))
                            .help("LINT holds -2^63 to 2^63-1, ULINT 0 to 2^64-1"),
                    );
                    error_expr(span)
                }
            },
            Operand::Real(_) => self.coerce(operand, span, Types::elem(Elem::Lreal)),
            Operand::Value { expr, ty } => self.narrow(expr, ty),
            Operand::Error => error_expr(span),
        }
    }

    /// Cuts a value that profile codesys computed wider back to its static type.
    fn narrow(&mut self, expr: Expr, ty: TypeId) -> Expr {
        if expr.ty == ty {
            return expr;
        }
        match (self.elem_of(expr.ty), self.elem_of(ty)) {
            (Some(from), Some(to)) if from != to => {
                let span = expr.span;
                Expr { kind: ExprKind::Convert(from, to, Box::new(expr)), ty, span }
            }
            _ => retype(expr, ty),
        }
    }

    /// The type an operand brings along.
    pub fn static_type(&self, operand: &Operand) -> Option<TypeId> {
        match operand {
            Operand::Value { ty, .. } => Some(*ty),
            _ => None,
        }
    }

    /// Converts an operand to the type of its place, or says why that cannot be.
    pub fn coerce(&mut self, operand: Operand, span: Span, target: TypeId) -> Expr {
        let (expr, ty) = match operand {
            Operand::Error => return error_expr(span),
            _ if target == Types::ERROR => return error_expr(span),
            Operand::Int(v) => return self.coerce_int(v, span, target),
            Operand::Real(v) => return self.coerce_real(v, span, target),
            Operand::Value { expr, ty } => (expr, ty),
        };
        if ty == Types::ERROR || expr.ty == Types::ERROR {
            return error_expr(span);
        }
        if ty == target {
            return self.narrow(expr, ty);
        }
        if let Some(expr) = self.coerce_reference(&expr, ty, target, span) {
            return expr;
        }
        let types = &self.cx.defs.types;
        match (types.get(ty).clone(), types.get(target).clone()) {
            (Type::Void, _) => {
                self.report(
                    Diagnostic::new(codes::NO_VALUE, span, "this call gives no value")
                        .help("the function has no result type; call it as a statement"),
                );
                error_expr(span)
            }
            (Type::Enum(_), _) | (_, Type::Enum(_)) => self.mismatch(expr, ty, target),
            (_, Type::String { wide, .. } | Type::AnyString { wide }) if self.text_kind(ty) == Some(wide) => {
                let expr = self.as_text(expr, wide);
                self.check_string_fits(&expr, target);
                expr
            }
            (Type::Array { dims: a, elem: x }, Type::Array { dims: b, elem: y }) if x == y => {
                let count = |d: &[(i64, i64)]| d.iter().map(|(l, h)| h - l + 1).product::<i64>();
                if count(&a) != count(&b) {
                    return self.mismatch(expr, ty, target);
                }
                let strict = self.mismatch_text(span, ty, target).help("declare both with the same bounds");
                if self.codesys_only(span, codes::LAX_CONVERSION, strict) {
                    return retype(expr, target);
                }
                error_expr(span)
            }
            (_, to) => match (self.elem_of(ty), self.elem_of(target)) {
                (Some(from), Some(elem)) => {
                    let expr = self.convert(expr, from, elem, ty, target, span);
                    match to {
                        Type::Subrange { low, high, .. } => self.narrowed_to(expr, ty, low, high, target, span),
                        _ => expr,
                    }
                }
                _ => self.mismatch(expr, ty, target),
            },
        }
    }

    fn check_string_fits(&mut self, expr: &Expr, target: TypeId) {
        let length = match &expr.kind {
            ExprKind::String(s) => s.len(),
            ExprKind::WString(s) => s.len(),
            _ => return,
        };
        if let Type::String { capacity, wide } = self.cx.defs.types.get(target)
            && length > *capacity as usize
        {
            let message = format!("this text has {length} characters, only {capacity} fit");
            let wide = *wide;
            self.report(
                Diagnostic::new(codes::STRING_CUT, expr.span, message).help(format!(
                    "declare the variable as {}[{length}] or shorten the text",
                    crate::text::keyword(wide)
                )),
            );
        }
    }

    fn convert(&mut self, expr: Expr, from: Elem, to: Elem, ty: TypeId, target: TypeId, span: Span) -> Expr {
        let actual = self.elem_of(expr.ty).unwrap_or(from);
        let how = rules::implicit(from, to);
        match how {
            Implicit::Same => {}
            Implicit::Exact => self.warn_wraps_first(&expr, from, to, span),
            Implicit::Rounds => {
                self.loses_precision(from, to, span);
            }
            Implicit::CodesysOnly if self.returns_to_bits(from, to, span) => {}
            Implicit::CodesysOnly => {
                let help = conversion_help(from, to);
                let strict = self.mismatch_text(span, ty, target).help(help);
                if !self.codesys_only(span, codes::LAX_CONVERSION, strict) {
                    return error_expr(span);
                }
            }
            Implicit::No => return self.mismatch(expr, ty, target),
        }
        let base = Types::elem(to);
        let expr = if actual == to {
            retype(expr, base)
        } else {
            let constant = match expr.kind {
                ExprKind::Const(raw) => crate::consts::convert(actual, to, raw),
                _ => None,
            };
            let kind = match constant {
                Some(raw) => ExprKind::Const(raw),
                None => ExprKind::Convert(actual, to, Box::new(expr)),
            };
            Expr { kind, ty: base, span }
        };
        retype(expr, target_unless_subrange(&self.cx.defs, target, base))
    }

    /// An integer beside or into a real that does not hold all its values (\[T2\]).
    pub fn loses_precision(&mut self, from: Elem, to: Elem, span: Span) {
        let message = format!("{} cannot hold every {} exactly", to.name(), from.name());
        self.report(
            Diagnostic::new(codes::LOSES_PRECISION, span, message).help(format!(
                "write {}(...) to say that this is meant, or use LREAL",
                rules::conversion_name(from, to)
            )),
        );
    }

    /// Each operation is done at its own type (\[T1\]): a wider target comes too late.
    fn warn_wraps_first(&mut self, expr: &Expr, from: Elem, to: Elem, span: Span) {
        if !(from.is_integer() || from.is_bits()) || self.codesys(span) {
            return;
        }
        if let ExprKind::Op(Op::Add | Op::Sub | Op::Mul | Op::Shl, _, args) = &expr.kind
            && !args.iter().all(|a| matches!(a.kind, ExprKind::Const(_)))
        {
            let message =
                format!("this is computed in {} and wraps there before it becomes {}", from.name(), to.name());
            self.report(
                Diagnostic::new(codes::WRAPS_FIRST, span, message)
                    .help(format!("convert an operand first, for example with {}", rules::conversion_name(from, to))),
            );
        }
    }

    fn narrowed_to(&mut self, expr: Expr, from: TypeId, low: i128, high: i128, target: TypeId, span: Span) -> Expr {
        if let Type::Subrange { low: l, high: h, .. } = self.cx.defs.types.get(from)
            && *l >= low
            && *h <= high
        {
            return retype(expr, target);
        }
        if let (ExprKind::Const(raw), Some(elem)) = (&expr.kind, self.elem_of(expr.ty)) {
            let v = elem.to_i128(*raw);
            if v < low || v > high {
                return self.outside(v, span, target, low, high);
            }
            return retype(expr, target);
        }
        if expr.ty == Types::ERROR {
            return expr;
        }
        let kind = ExprKind::RangeCheck { value: Box::new(expr), low, high, name: String::new() };
        Expr { kind, ty: target, span }
    }

    fn outside(&mut self, v: i128, span: Span, target: TypeId, low: i128, high: i128) -> Expr {
        let name = self.cx.type_name(target);
        self.report(
            Diagnostic::new(codes::OUT_OF_RANGE, span, format!("{v} does not fit {name}"))
                .help(format!("allowed are {low} to {high}")),
        );
        error_expr(span)
    }

    /// Whether a bit string was counted as an integer within `span`, with a warning there, and the result goes back
    /// into a bit string of that width: `w := w + 1` is one deviation from strict and gets one warning.
    fn returns_to_bits(&self, from: Elem, to: Elem, span: Span) -> bool {
        from.is_integer()
            && to.is_bits()
            && from.bits() == to.bits()
            && self.codesys(span)
            && self.cx.diags.last().is_some_and(|d| {
                let inner = d.primary.span;
                d.code == codes::LAX_CONVERSION
                    && inner.file == span.file
                    && inner != span
                    && (span.start..span.end).contains(&inner.start)
            })
    }

    fn mismatch_text(&self, span: Span, from: TypeId, to: TypeId) -> Diagnostic {
        let (from, to) = (self.cx.type_name(from), self.cx.type_name(to));
        Diagnostic::new(codes::TYPE_MISMATCH, span, format!("this is {from}, but {to} is needed here"))
    }

    /// Reports that one type cannot stand for another and names the conversion, if there is one.
    pub fn mismatch(&mut self, expr: Expr, from: TypeId, to: TypeId) -> Expr {
        let span = expr.span;
        let mut d = self.mismatch_text(span, from, to);
        let types = &self.cx.defs.types;
        match (types.get(from), types.get(to)) {
            (Type::Elem(a), Type::Elem(b)) => d = d.help(conversion_help(*a, *b)),
            (Type::String { .. }, Type::Enum(id)) => {
                let names = self.value_names(*id);
                d = d.help(format!("a value of an enumeration stands without quotes: {names}"));
            }
            _ if self.is_text(from) || self.is_text(to) => d = d.help_if(self.text_help(&expr, from, to)),
            (Type::Enum(_), Type::Enum(_)) => d = d.help("values of different enumerations do not mix"),
            (Type::Enum(_), Type::Elem(b)) => {
                d = d.help(format!("an enumeration is no number; TO_{}(...) converts it", b.name()));
            }
            (Type::Elem(_), Type::Enum(id)) => {
                d = d.help(format!("use one of its values: {}", self.value_names(*id)));
            }
            (Type::Null, _) => {
                d = d.help(
                    "only a REF_TO or POINTER TO can be NULL; `r REF= NULL` lets a REFERENCE TO refer to nothing",
                );
            }
            (_, Type::Ref { kind: RefKind::ReferenceTo, .. }) => {
                d = d.help("a REFERENCE TO is given a variable of the type that it refers to");
            }
            (_, Type::Ref { kind, target }) => {
                let of = if *kind == RefKind::PointerTo { "ADR" } else { "REF" };
                d = d.help(match &expr.kind {
                    ExprKind::Read(place) if from == *target => {
                        format!("`{of}({})` is the place of the variable", self.place_text(place))
                    }
                    _ => format!("{} is given {of}(variable), or NULL", kind.keyword()),
                });
            }
            (Type::Ref { target, .. }, _) if *target == to => {
                let held = if let ExprKind::Read(place) = &expr.kind { self.place_text(place) } else { "r".into() };
                d = d.help(format!("`{held}^` is the variable to which it refers"));
            }
            (_, Type::Instance(pou)) => {
                let of = &self.cx.defs.pous[*pou];
                d = d.help(format!("an instance of {} is called, it takes no value: `name(input := value)`", of.name));
            }
            (Type::Array { .. }, _) => d = d.help("an element of an array is written with its index: `a[1]`"),
            (_, Type::Array { .. }) => d = d.help("the elements are assigned one by one, for example in a FOR"),
            (_, Type::Struct(_)) => d = d.help("the components are assigned one by one: `s.a := 1;`"),
            (Type::Struct(_), _) => d = d.help("a component is written with a point: `s.a`"),
            (Type::Instance(pou), _) => {
                let outputs: Vec<&str> = self.cx.defs.pous[*pou]
                    .vars
                    .iter()
                    .map(|v| &self.cx.defs.vars[*v])
                    .filter(|v| v.section == Section::Output)
                    .map(|v| v.name.as_str())
                    .collect();
                if let Some(first) = outputs.first() {
                    d = d.help(format!("an instance has no value; use an output, such as `.{first}`"));
                }
            }
            _ => {}
        }
        self.report(d);
        error_expr(span)
    }

    /// The first values of an enumeration.
    fn value_names(&self, id: EnumId) -> String {
        let names: Vec<&str> = self.cx.defs.enums[id].values.iter().take(6).map(|(n, _, _)| n.as_str()).collect();
        names.join(", ")
    }

    fn coerce_int(&mut self, v: i128, span: Span, target: TypeId) -> Expr {
        let constant = |raw, ty| Expr { kind: ExprKind::Const(raw), ty, span };
        if let Type::Enum(id) = *self.cx.defs.types.get(target) {
            if self.codesys(span) && self.cx.defs.enums[id].values.iter().any(|(_, n, _)| *n == v) {
                return constant(v as u64 & self.cx.defs.enums[id].base.repr().mask(), target);
            }
            let number = constant(0, Types::elem(Elem::Int));
            return self.mismatch(number, Types::elem(Elem::Int), target);
        }
        let Some(elem) = self.elem_of(target) else {
            if let Type::Ref { kind: RefKind::PointerTo, .. } = self.cx.defs.types.get(target)
                && let Ok(offset) = u32::try_from(v)
            {
                return constant(u64::from(offset), target);
            }
            let ty = Types::elem(rules::default_integer(v).unwrap_or(Elem::Lint));
            return self.mismatch(constant(0, ty), ty, target);
        };
        if let Type::Subrange { low, high, .. } = *self.cx.defs.types.get(target)
            && !(low..=high).contains(&v)
        {
            return self.outside(v, span, target, low, high);
        }
        match elem.family() {
            Family::Real => constant(real_bits(elem, v as f64), target),
            Family::Bool | Family::Signed | Family::Unsigned | Family::Bits => {
                let (low, high) = elem.range().unwrap_or((0, 0));
                if !(low..=high).contains(&v) {
                    // What fits the width as the other sign: a bit pattern, in profile codesys.
                    let pattern = elem != Elem::Bool && v >= -(1i128 << (elem.bits() - 1)) && v < 1i128 << elem.bits();
                    if !(pattern && self.codesys(span)) {
                        return self.outside(v, span, target, low, high);
                    }
                    let message = format!("{v} does not fit {}, its bits are taken", elem.name());
                    self.report(Diagnostic::new(codes::LAX_CONVERSION, span, message));
                }
                constant(v as u64 & elem.repr().mask(), target)
            }
            _ => {
                let name = self.cx.type_name(target);
                let message = format!("the number {v} is no {name}");
                let help = match elem.family() {
                    Family::Duration => format!("write a duration: T#{v}ms, T#{v}s"),
                    Family::Date => "write a date: D#2024-01-31".into(),
                    Family::TimeOfDay => "write a time of day: TOD#13:05:00".into(),
                    Family::DateTime => "write a date and time: DT#2024-01-31-13:05:00".into(),
                    _ => "write a character in quotes".into(),
                };
                self.report(Diagnostic::new(codes::TYPE_MISMATCH, span, message).help(help));
                error_expr(span)
            }
        }
    }

    fn coerce_real(&mut self, v: f64, span: Span, target: TypeId) -> Expr {
        match self.elem_of(target) {
            Some(elem) if elem.is_real() => {
                if elem == Elem::Real && v.is_finite() && (v as f32).is_infinite() {
                    self.report(
                        Diagnostic::new(codes::OUT_OF_RANGE, span, format!("{v:e} does not fit REAL"))
                            .help("REAL reaches 3.4e38; use LREAL"),
                    );
                    return error_expr(span);
                }
                Expr { kind: ExprKind::Const(real_bits(elem, v)), ty: target, span }
            }
            Some(elem) if elem.is_integer() && v.fract() == 0.0 && !self.codesys(span) => {
                self.cx.codesys_only += 1;
                let message = format!("this is a real literal, but {} is needed here", elem.name());
                let help = format!("write the number without its fraction: `{v}`");
                self.report(Diagnostic::new(codes::TYPE_MISMATCH, span, message).help(help));
                error_expr(span)
            }
            _ => {
                let ty = Types::elem(Elem::Lreal);
                let expr = Expr { kind: ExprKind::Const(v.to_bits()), ty, span };
                self.coerce(Operand::Value { expr, ty }, span, target)
            }
        }
    }

    /// An expression; `want` is the type its place asks for, which literals and overloaded functions follow.
    pub fn operand(&mut self, e: &'a ast::Expr, want: Option<TypeId>) -> Operand {
        match &e.kind {
            ast::ExprKind::Literal(literal) => self.literal(literal, e.span, want),
            ast::ExprKind::Name(name) => self.name_operand(name, e, want),
            ast::ExprKind::Qualified { ty, value } => self.qualified(ty, value, e.span),
            ast::ExprKind::Member(base, member) => match self.enum_member(base, member, e.span) {
                Some(operand) => operand,
                None => self.read(e),
            },
            ast::ExprKind::Address(_)
            | ast::ExprKind::Part(..)
            | ast::ExprKind::Index(..)
            | ast::ExprKind::Deref(_) => self.read(e),
            ast::ExprKind::Call(call) => self.call_operand(call, e.span, want),
            ast::ExprKind::Unary(op, operand) => self.unary(*op, operand, e.span, want),
            ast::ExprKind::Binary(op, at, left, right) => self.binary(*op, *at, left, right, e.span, want),
            ast::ExprKind::Error => Operand::Error,
        }
    }

    /// The value of a place.
    fn read(&mut self, e: &'a ast::Expr) -> Operand {
        match self.place(e) {
            Some(place) => self.read_place(place),
            None => Operand::Error,
        }
    }

    pub fn read_place(&mut self, place: Place) -> Operand {
        if let (Root::Var(var), true) = (&place.root, place.steps.is_empty())
            && self.cx.defs.vars[*var].constant
            && self.elem_of(place.ty).is_some()
        {
            self.cx.var_init(*var);
            let raw = match &self.cx.defs.vars[*var].init {
                Init::Scalar(raw) => *raw,
                _ => crate::consts::default_scalar(&self.cx.defs, place.ty),
            };
            return Operand::value(ExprKind::Const(raw), place.ty, place.span);
        }
        let (ty, span) = (place.ty, place.span);
        Operand::value(ExprKind::Read(place), ty, span)
    }

    /// `Color#Red`.
    fn qualified(&mut self, ty: &ast::Name, value: &ast::Name, span: Span) -> Operand {
        let Some(&slot) = self.cx.types.get(&fold(&ty.text)) else {
            let hint = similar(&ty.text, self.cx.type_slots.iter().map(|t| t.decl.name.text.as_str()));
            self.report(
                Diagnostic::new(codes::UNKNOWN_TYPE, ty.span, format!("there is no type `{}`", ty.text))
                    .help_if(hint.map(|h| format!("did you mean `{h}`?"))),
            );
            return Operand::Error;
        };
        let resolved = self.cx.resolve_slot(slot, ty.span, false);
        self.value_of_enum(resolved.ty, value, span)
    }

    fn value_of_enum(&mut self, ty: TypeId, value: &ast::Name, span: Span) -> Operand {
        let Type::Enum(id) = *self.cx.defs.types.get(ty) else {
            if ty != Types::ERROR {
                let name = self.cx.type_name(ty);
                self.report(
                    Diagnostic::new(codes::UNKNOWN_MEMBER, span, format!("`{name}` is no enumeration"))
                        .help("only an enumeration has named values"),
                );
            }
            return Operand::Error;
        };
        let def = &self.cx.defs.enums[id];
        match self.cx.enum_value(id, &value.text) {
            Some(number) => Operand::value(ExprKind::Const(number as u64 & def.base.repr().mask()), ty, span),
            None => {
                let hint = similar(&value.text, def.values.iter().map(|(n, _, _)| n.as_str()));
                let d = Diagnostic::new(
                    codes::UNKNOWN_MEMBER,
                    value.span,
                    format!("`{}` has no value `{}`", def.name, value.text),
                )
                .also(def.span, "declared here")
                .help_if(hint.map(|h| format!("did you mean `{h}`?")));
                self.report(d);
                Operand::Error
            }
        }
    }

    /// `Color.Red`, where `Color` names a type and no variable.
    fn enum_member(&mut self, base: &'a ast::Expr, member: &ast::Name, span: Span) -> Option<Operand> {
        let ast::ExprKind::Name(name) = &base.kind else { return None };
        if !matches!(self.lookup(name), Found::Type) {
            return None;
        }
        Some(self.qualified(name, member, span))
    }

    fn name_operand(&mut self, name: &'a ast::Name, e: &'a ast::Expr, want: Option<TypeId>) -> Operand {
        match self.lookup(name) {
            Found::EnumValue => {
                let values = self.cx.enum_values.get(&fold(&name.text)).cloned().unwrap_or_default();
                let wanted = want.and_then(|w| match self.cx.defs.types.get(w) {
                    Type::Enum(id) => values.iter().find(|(e, _)| e == id),
                    _ => None,
                });
                match (wanted, values.as_slice()) {
                    (Some((id, number)), _) | (None, [(id, number)]) => {
                        let ty = self.cx.defs.types.intern(Type::Enum(*id));
                        let mask = self.cx.defs.enums[*id].base.repr().mask();
                        Operand::value(ExprKind::Const(*number as u64 & mask), ty, name.span)
                    }
                    _ if !self.cx.first_report(self.scope, &format!("value {}", name.text)) => Operand::Error,
                    _ => {
                        let names: Vec<String> = values
                            .iter()
                            .map(|(id, _)| format!("{}#{}", self.cx.defs.enums[*id].name, name.text))
                            .collect();
                        self.report(
                            Diagnostic::new(
                                codes::AMBIGUOUS_NAME,
                                name.span,
                                format!("several enumerations have a value `{}`", name.text),
                            )
                            .help(format!("write {}", names.join(" or "))),
                        );
                        Operand::Error
                    }
                }
            }
            _ => self.read(e),
        }
    }
}

/// The bits of a real constant.
pub(crate) fn real_bits(elem: Elem, v: f64) -> u64 {
    if elem == Elem::Real { u64::from((v as f32).to_bits()) } else { v.to_bits() }
}

/// The same value under another type.
pub(crate) fn retype(expr: Expr, ty: TypeId) -> Expr {
    if expr.ty == ty {
        return expr;
    }
    let span = expr.span;
    match expr.kind {
        ExprKind::Const(_) | ExprKind::Error => Expr { ty, ..expr },
        _ => Expr { kind: ExprKind::Retype(Box::new(expr)), ty, span },
    }
}

fn target_unless_subrange(defs: &Defs, target: TypeId, base: TypeId) -> TypeId {
    if matches!(defs.types.get(target), Type::Subrange { .. }) { base } else { target }
}

/// What to write to get from one elementary type to another.
pub(crate) fn conversion_help(from: Elem, to: Elem) -> String {
    let to_bool = to == Elem::Bool && (from.is_integer() || from.is_bits());
    match () {
        () if to_bool => "compare it: `x <> 0`".into(),
        () if from == Elem::Bool && to.is_integer() => format!("write BOOL_TO_{}(...)", to.name()),
        () => format!("write {}(...) to convert it", rules::conversion_name(from, to)),
    }
}
