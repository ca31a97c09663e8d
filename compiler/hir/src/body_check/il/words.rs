//! Messages of the expression checker in the terms of IL: at the instruction, about the current result.

use super::Il;
use super::current::Value;
use super::lines::{Line, What};
use crate::expr::Operand;
use plcc_diag::{Span, codes};
use plcc_syntax::ast::BinaryOp;

/// What an operation works on, for messages.
pub(super) struct Sides {
    cr: (Span, String),
    /// An operand, or the variable that is stored to.
    other: Option<(Span, String)>,
}

/// What an operator needs on both sides.
pub(super) fn needs(op: BinaryOp) -> &'static str {
    match op {
        BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => "BOOL or a bit string",
        BinaryOp::Mod => "an integer",
        BinaryOp::Eq | BinaryOp::Ne => "an elementary value",
        BinaryOp::Lt | BinaryOp::Gt | BinaryOp::Le | BinaryOp::Ge => "a value with an order",
        _ => "a number or a duration",
    }
}

impl Il<'_, '_, '_> {
    pub fn sides(&self, cr: &Value, other: Option<(Span, String)>) -> Sides {
        Sides { cr: (cr.span, self.name_of(&cr.operand)), other }
    }

    /// The type of an operand for messages.
    pub fn name_of(&self, operand: &Operand) -> String {
        match operand {
            Operand::Int(v) => format!("the number {v}"),
            Operand::Real(v) => format!("the number {v}"),
            Operand::Value { ty, .. } => self.c.cx.type_name(*ty),
            Operand::Error => "?".to_string(),
        }
    }

    /// Rewords the messages from number `first` on, which a check in the line gave.
    pub fn reword(&mut self, first: usize, line: &Line, sides: &Sides, needs: &str) {
        let joint = sides.cr.0.to(line.span);
        for mut d in self.c.cx.diags.split_off(first) {
            let at = d.primary.span;
            let lax = d.code == codes::LAX_CONVERSION;
            let wrong = lax || d.code == codes::WRONG_OPERAND || d.code == codes::TYPE_MISMATCH;
            let about_operand = sides.other.as_ref().is_some_and(|o| o.0 == at);
            // Operations of the current result lie in its instructions, above this line.
            let about_cr = !about_operand && at != line.span && at != joint && within(at, sides.cr.0);
            if at == joint || wrong && about_cr {
                d.primary.span = line.span;
            }
            if wrong {
                let name = &line.name;
                let cr = &sides.cr.1;
                d.message = match &sides.other {
                    Some((_, other)) if about_operand => format!("this operand is {other}; {name} needs {needs}"),
                    Some((_, other)) if matches!(line.what, What::Store { .. }) => {
                        format!("the current result is {cr} here, but {other}")
                    }
                    _ if about_cr => format!("the current result is {cr} here; {name} needs {needs}"),
                    Some((_, other)) => format!("{name} cannot combine the current result, {cr}, with {other}"),
                    None => format!("the current result is {cr} here; {name} needs {needs}"),
                };
                if !about_operand {
                    d.code = if lax { d.code } else { codes::CR_TYPE };
                    d.secondary.clear();
                    d.secondary.push(plcc_diag::Label { span: sides.cr.0, text: format!("it is {cr} from here") });
                }
                d.help.retain(|h| !h.starts_with("it needs"));
                for help in &mut d.help {
                    *help = in_il(help);
                }
            }
            self.c.report(d);
        }
    }
}

/// Advice that was written for an expression.
fn in_il(help: &str) -> String {
    let call = help.strip_prefix("write ").map(|h| h.strip_suffix(" to convert it").unwrap_or(h));
    if let Some(name) = call.and_then(|h| h.strip_suffix("(...)")) {
        return format!("the function {name} converts the current result: `{name}` on a line of its own");
    }
    if help.starts_with("compare it: ") {
        return "compare it: `NE 0`".to_string();
    }
    help.to_string()
}

fn within(inner: Span, outer: Span) -> bool {
    inner.file == outer.file && inner.start >= outer.start && inner.end <= outer.end
}
