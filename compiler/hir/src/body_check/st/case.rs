//! CASE: what its labels select, that no two of them overlap, and which values of an enumeration none has (semantics.md \[S3\]).

use super::St;
use crate::body::*;
use crate::expr::*;
use crate::rules;
use crate::types::{Type, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::Elem;
use plcc_syntax::ast;
use std::collections::BTreeMap;

/// So many values that a CASE does not handle are named.
const MISSING_NAMES: usize = 12;

/// The labels of a CASE that do not overlap, by their lower values.
#[derive(Default)]
struct Labels(BTreeMap<i128, (i128, Span)>);

impl Labels {
    /// A label that has one of these values, too.
    fn overlap(&self, low: i128, high: i128) -> Option<Span> {
        let (_, (highest, span)) = self.0.range(..=high).next_back()?;
        (*highest >= low).then_some(*span)
    }
}

impl<'a> St<'_, 'a> {
    pub(super) fn case(
        &mut self,
        selector: &'a ast::Expr,
        arms: &'a [ast::CaseArm],
        otherwise: Option<&'a [ast::Stmt]>,
    ) -> Option<StmtKind> {
        let value = self.c.any_value(selector);
        let elem = self.c.elem_of(value.ty).filter(|e| e.is_integer() || e.is_bits());
        if elem.is_none() && value.ty != Types::ERROR {
            let ty = self.c.cx.type_name(value.ty);
            self.c.report(
                Diagnostic::new(codes::WRONG_OPERAND, selector.span, format!("CASE cannot choose by a {ty}"))
                    .help("the selector is an integer, a bit string or an enumeration"),
            );
        }
        let mut seen = Labels::default();
        let mut checked = Vec::new();
        for arm in arms {
            let mut labels = Vec::new();
            for label in &arm.labels {
                let (range, span) = match label {
                    ast::CaseLabel::One(e) => (self.label(e, value.ty, elem).map(|v| (v, v)), e.span),
                    ast::CaseLabel::Range(a, b) => {
                        let low = self.label(a, value.ty, elem);
                        let high = self.label(b, value.ty, elem);
                        (low.zip(high), a.span.to(b.span))
                    }
                };
                let Some((low, high)) = range else { continue };
                if low > high {
                    self.c.report(
                        Diagnostic::new(codes::CASE_LABEL, span, format!("the range {low}..{high} is empty"))
                            .help("the lower value comes first"),
                    );
                    continue;
                }
                if let Some(first) = seen.overlap(low, high) {
                    self.c.report(
                        Diagnostic::new(codes::CASE_LABEL, span, "this value is covered by an earlier label")
                            .also(first, "here")
                            .help("each value may stand once in a CASE"),
                    );
                    continue;
                }
                seen.0.insert(low, (high, span));
                labels.push((low, high));
            }
            checked.push(CaseArm { labels, body: self.list(&arm.body) });
        }
        let enumeration = match self.c.cx.defs.types.get(value.ty) {
            Type::Enum(id) => Some(*id),
            _ => None,
        };
        if let (Some(id), None) = (enumeration, otherwise) {
            let def = &self.c.cx.defs.enums[id];
            let missing: Vec<&str> = def
                .values
                .iter()
                .filter(|(_, v, _)| seen.overlap(*v, *v).is_none())
                .map(|(n, _, _)| n.as_str())
                .collect();
            if !missing.is_empty() && !self.c.cx.half_read.contains(&selector.span.file) {
                let mut names = missing[..missing.len().min(MISSING_NAMES)].join(", ");
                if missing.len() > MISSING_NAMES {
                    names = format!("{names} and {} other values", missing.len() - MISSING_NAMES);
                }
                let message = format!("CASE does not handle {names} of `{}`", def.name);
                let d = Diagnostic::new(codes::CASE_INCOMPLETE, selector.span, message)
                    .also(def.span, "the enumeration is declared here")
                    .help("add the missing values, or ELSE");
                self.c.report(d);
            }
        }
        let otherwise = otherwise.map(|b| self.list(b)).unwrap_or_default();
        (value.ty != Types::ERROR && elem.is_some()).then_some(StmtKind::Case {
            selector: value,
            arms: checked,
            otherwise,
        })
    }

    /// A label as a number of the selector's type.
    fn label(&mut self, e: &'a ast::Expr, ty: TypeId, elem: Option<Elem>) -> Option<i128> {
        let operand = self.c.operand(e, Some(ty));
        let elem = elem?;
        if let (Operand::Int(v), false) = (&operand, matches!(self.c.cx.defs.types.get(ty), Type::Enum(_))) {
            if !rules::holds(elem, *v) {
                let (low, high) = elem.range().unwrap_or((0, 0));
                self.c.report(
                    Diagnostic::new(codes::CASE_LABEL, e.span, format!("the selector can never be {v}"))
                        .help(format!("it is {}, from {low} to {high}", elem.name())),
                );
                return None;
            }
            return Some(*v);
        }
        let expr = match operand {
            // A bit string is compared by its value, as the selector is.
            Operand::Value { expr, ty: from }
                if self.c.elem_of(from).is_some_and(|e| e.is_integer() || e.is_bits())
                    && !matches!(self.c.cx.defs.types.get(ty), Type::Enum(_))
                    && !matches!(self.c.cx.defs.types.get(from), Type::Enum(_)) =>
            {
                expr
            }
            operand => self.c.coerce(operand, e.span, ty),
        };
        if expr.ty == Types::ERROR {
            return None;
        }
        let elem = self.c.elem_of(expr.ty).unwrap_or(elem);
        match self.c.cx.eval(&expr, crate::consts::Reads::Constants) {
            Ok(raw) => Some(elem.to_i128(raw)),
            Err(why) => {
                self.c.not_constant(why, crate::consts::Reads::Constants);
                None
            }
        }
    }
}
