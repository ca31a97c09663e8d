//! Expressions that must be constant: bounds, labels, initial values, with the messages when they are not.

use crate::body::*;
use crate::consts::{NotConstant, Reads};
use crate::expr::*;
use crate::init::Init;
use crate::types::{Type, TypeId, Types};
use plcc_diag::{Diagnostic, codes};
use plcc_stdlib::fault::Fault;
use plcc_syntax::ast;

impl<'a> Checker<'_, 'a> {
    pub fn not_constant(&mut self, why: NotConstant, reads: Reads) {
        match why {
            NotConstant::Reported => {}
            NotConstant::Varies(span) => self.report(
                Diagnostic::new(codes::NOT_CONSTANT, span, "this is known only at run time, a constant is needed")
                    .help(match reads {
                        Reads::Constants => "use literals and variables declared CONSTANT",
                        Reads::Initials => {
                            "an initial value is computed from literals, constants and other initial values"
                        }
                    }),
            ),
            NotConstant::Faults(span, fault) => {
                let code = match fault {
                    Fault::DivisionByZero => codes::ZERO_DIVISOR,
                    Fault::IndexOutOfBounds => codes::CONSTANT_INDEX,
                    _ => codes::OUT_OF_RANGE,
                };
                self.report(Diagnostic::new(code, span, format!("this constant has no value: {}", fault.title())));
            }
        }
    }

    /// A constant integer (or the number of an enumeration value, or a bit string's).
    pub fn const_integer(&mut self, e: &'a ast::Expr) -> Option<i128> {
        let operand = self.operand(e, None);
        if let Operand::Int(v) = operand {
            return Some(v);
        }
        let expr = self.settle(operand, e.span);
        if expr.ty == Types::ERROR {
            return None;
        }
        let elem = self.elem_of(expr.ty).filter(|e| e.is_integer() || e.is_bits());
        let Some(elem) = elem else {
            let ty = self.cx.type_name(expr.ty);
            self.report(
                Diagnostic::new(codes::TYPE_MISMATCH, e.span, format!("an integer is needed here, this is {ty}"))
                    .help("write a whole number or the name of an integer CONSTANT"),
            );
            return None;
        };
        match self.cx.eval(&expr, Reads::Constants) {
            Ok(raw) => Some(elem.to_i128(raw)),
            Err(why) => {
                self.not_constant(why, Reads::Constants);
                None
            }
        }
    }

    /// A constant expression as the initial value of something of type `ty`.
    pub fn const_init(&mut self, e: &'a ast::Expr, ty: TypeId) -> Init {
        let expr = self.value(e, ty);
        if expr.ty == Types::ERROR {
            return Init::Default;
        }
        if self.is_text(ty) {
            return self.const_text(&expr, ty);
        }
        if self.elem_of(ty).is_none()
            && let ExprKind::Read(place) = &expr.kind
        {
            return match self.cx.initial_of(place, Reads::Initials) {
                Ok(init) => init,
                Err(why) => {
                    self.not_constant(why, Reads::Initials);
                    Init::Default
                }
            };
        }
        match self.cx.eval(&expr, Reads::Initials) {
            Ok(raw) => Init::Scalar(raw),
            Err(why) => {
                self.not_constant(why, Reads::Initials);
                Init::Default
            }
        }
    }

    fn const_text(&mut self, expr: &Expr, ty: TypeId) -> Init {
        match self.cx.eval_units(expr, Reads::Initials) {
            Ok(units) if matches!(self.cx.defs.types.get(ty), Type::String { wide: true, .. }) => {
                Init::WString(self.cut(&units, ty))
            }
            Ok(units) => {
                let characters: Vec<u8> = units.into_iter().map(|unit| unit as u8).collect();
                Init::String(self.cut(&characters, ty))
            }
            Err(why) => {
                self.not_constant(why, Reads::Initials);
                Init::Default
            }
        }
    }

    /// A text cut at the capacity of its variable.
    fn cut<T: Clone>(&self, text: &[T], ty: TypeId) -> Vec<T> {
        match self.cx.defs.types.get(ty) {
            Type::String { capacity, .. } => text[..text.len().min(*capacity as usize)].to_vec(),
            _ => text.to_vec(),
        }
    }
}
