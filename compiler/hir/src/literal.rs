//! Literals: their text against the type that their prefix or place gives (semantics.md \[L4\] \[L5\] \[T3\]). How text is read stands
//! in `stdlib::literal`, once for sources, stimulus and trace.

use crate::body::*;
use crate::expr::*;
use crate::types::{Type, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::{Elem, Family};
use plcc_stdlib::literal::{self as text, LiteralError, Nul};
use plcc_syntax::ast::{Literal, LiteralKind, Name};
use std::borrow::Cow;

impl Checker<'_, '_> {
    pub fn literal(&mut self, literal: &Literal, span: Span, want: Option<TypeId>) -> Operand {
        let typed = match &literal.prefix {
            None => None,
            Some(prefix) => match self.literal_type(prefix) {
                Some(ty) => Some(ty),
                None => return Operand::Error,
            },
        };
        match literal.kind {
            LiteralKind::Bool => {
                let raw = u64::from(literal.text.eq_ignore_ascii_case("TRUE"));
                let operand = Operand::value(ExprKind::Const(raw), Types::elem(Elem::Bool), span);
                self.typed(operand, typed, span)
            }
            LiteralKind::Null => {
                let ty = self.cx.defs.types.intern(Type::Null);
                Operand::value(ExprKind::Const(0), ty, span)
            }
            LiteralKind::Integer | LiteralKind::Based => match text::integer(&literal.text) {
                Ok(v) => self.typed(Operand::Int(v), typed, span),
                Err(e) => self.bad(&e, span),
            },
            LiteralKind::Real => match text::real(Elem::Lreal, &literal.text) {
                Ok(raw) => self.typed(Operand::Real(f64::from_bits(raw)), typed, span),
                Err(e) => self.bad(&e, span),
            },
            LiteralKind::Duration | LiteralKind::Date => {
                let Some(elem) = typed.and_then(|t| self.elem_of(t)) else { return Operand::Error };
                match text::parse(elem, &literal.text) {
                    Ok(raw) => Operand::value(ExprKind::Const(raw), Types::elem(elem), span),
                    Err(e) => self.bad(&e, span),
                }
            }
            LiteralKind::String | LiteralKind::WString => self.string(literal, typed, span, want),
        }
    }

    /// The type that a prefix names: elementary, or a user's alias, subrange or enumeration base.
    fn literal_type(&mut self, prefix: &Name) -> Option<TypeId> {
        let short = match prefix.text.to_ascii_uppercase().as_str() {
            "T" => Some(Elem::Time),
            "LT" => Some(Elem::Ltime),
            "D" => Some(Elem::Date),
            "LD" => Some(Elem::Ldate),
            _ => Elem::from_name(&prefix.text),
        };
        if let Some(elem) = short {
            return Some(Types::elem(elem));
        }
        if let Some(&slot) = self.cx.types.get(&crate::cx::fold(&prefix.text)) {
            let ty = self.cx.resolve_slot(slot, prefix.span, false).ty;
            return (ty != Types::ERROR).then_some(ty);
        }
        if prefix.text.eq_ignore_ascii_case("STRING") || prefix.text.eq_ignore_ascii_case("WSTRING") {
            return Some(
                self.cx
                    .defs
                    .types
                    .intern(Type::String { wide: prefix.text.len() == 7, capacity: crate::resolve::DEFAULT_STRING }),
            );
        }
        self.report(
            Diagnostic::new(codes::UNKNOWN_TYPE, prefix.span, format!("there is no type `{}`", prefix.text))
                .help("a typed literal names an elementary type: INT#5, BYTE#16#FF"),
        );
        None
    }

    /// `INT#5` is an INT whatever its place asks for.
    fn typed(&mut self, operand: Operand, ty: Option<TypeId>, span: Span) -> Operand {
        let Some(ty) = ty else { return operand };
        // `BOOL#TRUE` and the like need no conversion; `INT#TRUE` is a mismatch like any other.
        let expr = self.coerce(operand, span, ty);
        if expr.ty == Types::ERROR { Operand::Error } else { Operand::Value { expr, ty } }
    }

    fn bad(&mut self, error: &LiteralError, span: Span) -> Operand {
        self.report(Diagnostic::new(codes::LITERAL_VALUE, span, error.to_string()).help_if(error.help()));
        Operand::Error
    }

    /// The text of a STRING in characters that it can hold: profile codesys takes `?` for others, with a warning.
    fn latin1<'t>(&mut self, text: &'t str, span: Span) -> Cow<'t, str> {
        let Some(other) = text.chars().find(|c| u32::from(*c) > 0xFF).filter(|_| self.codesys(span)) else {
            return Cow::Borrowed(text);
        };
        let message = format!("a STRING cannot hold `{other}`, only Latin-1; `?` stands in its place");
        self.report(Diagnostic::new(codes::LAX_CONVERSION, span, message).help("write it in \"...\", a WSTRING"));
        Cow::Owned(question_marks(text))
    }

    fn string(&mut self, literal: &Literal, typed: Option<TypeId>, span: Span, want: Option<TypeId>) -> Operand {
        let wide = literal.kind == LiteralKind::WString;
        let nul = if self.codesys(span) { Nul::Ends } else { Nul::Error };
        let place = typed.or(want).and_then(|t| self.elem_of(t)).filter(|e| e.family() == Family::Char);
        let (units, kind) = if wide {
            match text::wstring(&literal.text, nul) {
                Ok(s) => (s.clone(), ExprKind::WString(s)),
                Err(e) => {
                    self.cx.codesys_only += usize::from(text::wstring(&literal.text, Nul::Ends).is_ok());
                    return self.bad(&e, span);
                }
            }
        } else {
            let latin1 = self.latin1(&literal.text, span);
            match text::string(&latin1, nul) {
                Ok(s) => (s.iter().map(|b| u16::from(*b)).collect(), ExprKind::String(s)),
                Err(e) => {
                    let lax = text::string(&question_marks(&literal.text), Nul::Ends);
                    self.cx.codesys_only += usize::from(lax.is_ok());
                    return self.bad(&e, span);
                }
            }
        };
        if let (Some(elem), [one]) = (place, units.as_slice()) {
            return Operand::value(ExprKind::Const(u64::from(*one)), Types::elem(elem), span);
        }
        let ty = self.cx.defs.types.intern(Type::String { wide, capacity: (units.len() as u32).max(1) });
        Operand::value(kind, ty, span)
    }
}

/// The text with `?` for each character that a STRING cannot hold.
fn question_marks(text: &str) -> String {
    text.chars().map(|c| if u32::from(c) > 0xFF { '?' } else { c }).collect()
}
