//! Calls of standard functions: overloading by the row of the function table (semantics.md \[T3\] \[N1\] \[S4\]).

use crate::body::*;
use crate::consts::{NotConstant, Reads};
use crate::expr::*;
use crate::rules::{self, Implicit};
use crate::types::{Type as Ty, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::{Elem, Generic};
use plcc_stdlib::funcs::{Meaning, Operator, StdFn, Type};
use plcc_stdlib::ops::Op;
use plcc_syntax::ast::{self, BinaryOp, UnaryOp};

fn binary_of(op: Operator) -> Option<BinaryOp> {
    Some(match op {
        Operator::Add => BinaryOp::Add,
        Operator::Sub => BinaryOp::Sub,
        Operator::Mul => BinaryOp::Mul,
        Operator::Div => BinaryOp::Div,
        Operator::Mod => BinaryOp::Mod,
        Operator::Power => BinaryOp::Power,
        Operator::And => BinaryOp::And,
        Operator::Or => BinaryOp::Or,
        Operator::Xor => BinaryOp::Xor,
        Operator::Eq => BinaryOp::Eq,
        Operator::Ne => BinaryOp::Ne,
        Operator::Lt => BinaryOp::Lt,
        Operator::Le => BinaryOp::Le,
        Operator::Gt => BinaryOp::Gt,
        Operator::Ge => BinaryOp::Ge,
        Operator::Not => return None,
    })
}

/// The type that argument `n` is asked for, where the place of the call asks for `want`: that reaches only arguments of the
/// type variable.
pub(crate) fn wanted_of_argument(func: &StdFn, n: usize, want: Option<TypeId>) -> Option<TypeId> {
    match (func.param_type(n), func.bound, func.result) {
        (Some(Type::Fixed(elem)), ..) | (Some(Type::Var), Some(elem), _) => Some(Types::elem(elem)),
        (Some(Type::Var), None, Type::Var) => want,
        (Some(Type::Var), None, Type::Fixed(elem))
            if matches!(func.meaning, Meaning::Formula(_)) && elem != Elem::Bool =>
        {
            want
        }
        _ => None,
    }
}

impl<'a> Checker<'_, 'a> {
    pub fn standard_call(
        &mut self,
        func: &'static StdFn,
        call: &'a ast::Call,
        span: Span,
        want: Option<TypeId>,
    ) -> Operand {
        let Some(placed) = self.place_arguments(func, call) else { return Operand::Error };
        let mut operands = Vec::with_capacity(placed.args.len());
        for (n, e) in placed.args.iter().enumerate() {
            let Some(e) = e else { return Operand::Error };
            operands.push((self.operand(e, wanted_of_argument(func, n, want)), e.span));
        }
        if operands.iter().any(|(o, _)| matches!(o, Operand::Error)) {
            return Operand::Error;
        }
        // Named arguments may stand in another order than the parameters: then calls in them are made as written.
        let reordered = !operands.is_sorted_by_key(|(_, at)| at.start)
            && operands.iter().any(|(o, _)| matches!(o, Operand::Value { expr, .. } if expr.calls()));
        if placed.en.is_none() && placed.eno.is_none() && func.outputs.is_empty() && !reordered {
            return self.apply(func, operands, span, want);
        }
        self.call_in_steps(func, placed, operands, span, want)
    }

    /// The meaning of the row on checked operands. Also how IL applies a function to its current result.
    pub fn apply(
        &mut self,
        func: &'static StdFn,
        mut operands: Vec<(Operand, Span)>,
        span: Span,
        want: Option<TypeId>,
    ) -> Operand {
        // A typed name fixes its variable; fixed parameters have their own type.
        for (n, (operand, at)) in operands.iter_mut().enumerate() {
            let elem = match func.param_type(n) {
                Some(Type::Fixed(elem)) => elem,
                Some(Type::Var) => match func.bound {
                    Some(elem) => elem,
                    None => continue,
                },
                _ => continue,
            };
            let expr = self.coerce(std::mem::replace(operand, Operand::Error), *at, Types::elem(elem));
            if expr.ty == Types::ERROR {
                return Operand::Error;
            }
            let ty = expr.ty;
            *operand = Operand::Value { expr, ty };
        }
        match func.meaning {
            Meaning::Operator(Operator::Not) => {
                let (operand, at) = operands.remove(0);
                self.unary_operand(UnaryOp::Not, operand, at, span, want)
            }
            Meaning::Operator(op) => self.fold_operator(op, operands, span, want),
            Meaning::Compare(op, _) if operands.len() == 2 => self.fold_operator(op, operands, span, want),
            Meaning::Move => operands.remove(0).0,
            Meaning::Convert(to) => self.conversion(func, to, operands.remove(0), span),
            Meaning::FromBcd(number) => self.number_of_bcd(func, number, operands.remove(0), span),
            Meaning::ToBcd(bits) => self.bcd_of_number(func, bits, operands.remove(0), span),
            Meaning::Shift(op) => self.shift(func, op, operands, span, want),
            Meaning::Integral(_) => self.integral(func, operands.remove(0), span, want),
            Meaning::Formula(_) | Meaning::Choose(_) | Meaning::Compare(..) => self.formula(func, operands, span, want),
            Meaning::Text(op) => self.text_call(func, op, operands, span),
            Meaning::ToText(wide) => self.text_of_value(func, wide, operands.remove(0), span),
            // A function without result goes another way.
            Meaning::Outputs => Operand::Error,
        }
    }

    fn fold_operator(
        &mut self,
        op: Operator,
        operands: Vec<(Operand, Span)>,
        span: Span,
        want: Option<TypeId>,
    ) -> Operand {
        let Some(op) = binary_of(op) else { return Operand::Error };
        let mut operands = operands.into_iter();
        let Some((mut sum, mut left)) = operands.next() else { return Operand::Error };
        for (next, right) in operands {
            sum = self.binary_operands(op, span, sum, next, [left, right], span, want);
            left = left.to(right);
        }
        sum
    }

    fn conversion(&mut self, func: &'static StdFn, to: Elem, (operand, at): (Operand, Span), span: Span) -> Operand {
        let target = Types::elem(to);
        let expr = match operand {
            // `TO_REAL(1)`: an untyped constant has a type of its own here.
            Operand::Int(_) | Operand::Real(_) => self.settle(operand, at),
            Operand::Value { expr, ty } => match self.elem_of(ty) {
                None if self.is_text(ty) => return self.value_of_text(to, expr, span),
                Some(_) => self.settle(Operand::Value { expr, ty }, at),
                None => return self.no_conversion(func, ty, at),
            },
            Operand::Error => return Operand::Error,
        };
        let Some(elem) = self.elem_of(expr.ty) else { return Operand::Error };
        if elem == to {
            return Operand::Value { expr: retype(expr, target), ty: target };
        }
        if !plcc_stdlib::convert::exists(elem, to) {
            let ty = expr.ty;
            return self.no_conversion(func, ty, at);
        }
        let expr = Expr { span, ..self.with_elem(expr, to, span) };
        Operand::Value { expr, ty: target }
    }

    fn no_conversion(&mut self, func: &StdFn, ty: TypeId, at: Span) -> Operand {
        let name = self.cx.type_name(ty);
        self.report(
            Diagnostic::new(codes::TYPE_MISMATCH, at, format!("{} cannot convert {name}", func.name))
                .help("it converts elementary values"),
        );
        Operand::Error
    }

    /// An integer argument as LINT (`N`, `K`), bit strings by value.
    pub fn integer_argument(&mut self, func: &StdFn, operand: Operand, at: Span) -> Option<Expr> {
        let expr = match operand {
            Operand::Int(_) => self.coerce(operand, at, Types::elem(Elem::Lint)),
            operand => self.settle(operand, at),
        };
        match self.elem_of(expr.ty) {
            Some(Elem::Lint) => Some(retype(expr, Types::elem(Elem::Lint))),
            // Beyond LINT every count means the same: more than any width.
            Some(Elem::Ulint | Elem::Lword) => {
                let elem = Elem::Ulint;
                let limit = Expr { kind: ExprKind::Const(i64::MAX as u64), ty: Types::elem(elem), span: at };
                let args = vec![retype(expr, Types::elem(elem)), limit];
                let low = Expr { kind: ExprKind::Op(Op::Min, elem, args), ty: Types::elem(elem), span: at };
                Some(self.with_elem(low, Elem::Lint, at))
            }
            Some(elem) if elem.is_integer() => Some(self.with_elem(expr, Elem::Lint, at)),
            Some(elem) if elem.is_bits() => {
                if !self.codesys(at) {
                    self.report(
                        Diagnostic::new(codes::BITS_AS_NUMBER, at, format!("{} is used as a number", elem.name()))
                            .help(format!("write {}(...)", rules::conversion_name(elem, rules::as_number(elem)))),
                    );
                }
                let expr = self.with_elem(expr, rules::as_number(elem), at);
                Some(self.with_elem(expr, Elem::Lint, at))
            }
            _ if expr.ty == Types::ERROR => None,
            _ => {
                let name = self.cx.type_name(expr.ty);
                self.report(Diagnostic::new(
                    codes::TYPE_MISMATCH,
                    at,
                    format!("{} needs an integer here, this is {name}", func.name),
                ));
                None
            }
        }
    }

    fn shift(
        &mut self,
        func: &'static StdFn,
        op: Op,
        mut operands: Vec<(Operand, Span)>,
        span: Span,
        want: Option<TypeId>,
    ) -> Operand {
        let (count, count_at) = operands.remove(1);
        let (value, at) = operands.remove(0);
        let Some(count) = self.integer_argument(func, count, count_at) else { return Operand::Error };
        if let ExprKind::Const(raw) = count.kind
            && (raw as i64) < 0
        {
            self.report(
                Diagnostic::new(codes::OUT_OF_RANGE, count_at, "a shift count is not negative")
                    .help("shift in the other direction"),
            );
            return Operand::Error;
        }
        let (expr, ty) = match value {
            Operand::Value { expr, ty } => (expr, ty),
            constant => {
                let place = want.filter(|w| self.elem_of(*w).is_some_and(Elem::is_bits));
                let elem = match &constant {
                    Operand::Int(v) => {
                        [Elem::Byte, Elem::Word, Elem::Dword, Elem::Lword].into_iter().find(|e| rules::holds(*e, *v))
                    }
                    _ => None,
                };
                let ty = place.unwrap_or(Types::elem(elem.unwrap_or(Elem::Lword)));
                (self.coerce(constant, at, ty), ty)
            }
        };
        if expr.ty == Types::ERROR {
            return Operand::Error;
        }
        let elem = match self.elem_of(ty) {
            Some(elem) if elem.is_bits() => elem,
            Some(elem) if elem.is_integer() => {
                let name = self.cx.type_name(ty);
                let strict = Diagnostic::new(codes::WRONG_OPERAND, at, format!("{} does not take {name}", func.name))
                    .help(format!(
                        "convert it, for example with {}",
                        rules::conversion_name(elem, crate::operators::bits_of(elem))
                    ));
                if !self.codesys_only(span, codes::LAX_CONVERSION, strict) {
                    return Operand::Error;
                }
                elem
            }
            _ => {
                let name = self.cx.type_name(ty);
                self.report(
                    Diagnostic::new(codes::WRONG_OPERAND, at, format!("{} does not take {name}", func.name))
                        .help("it shifts bit strings: BYTE, WORD, DWORD, LWORD"),
                );
                return Operand::Error;
            }
        };
        // The result has the operand's type and is cut to it. Narrow signed integers are shifted right in 32 bits, so that the
        // zeros come in above them (\[P2\] \[P3\]); the other operations are the same at the type's own width.
        let expr = self.settle(Operand::Value { expr, ty }, at);
        let done = if op == Op::Shr && elem.is_signed() { self.width(elem, span) } else { elem };
        let bits = crate::operators::bits_of(done);
        let expr = retype(self.with_elem(expr, done, at), Types::elem(bits));
        let shifted = Expr { kind: ExprKind::Op(op, bits, vec![expr, count]), ty: Types::elem(bits), span };
        let expr = self.with_elem(retype(shifted, Types::elem(done)), elem, span);
        Operand::Value { expr, ty: Types::elem(elem) }
    }

    /// TRUNC and its kind: rounds in the real type, then an exact conversion.
    fn integral(
        &mut self,
        func: &'static StdFn,
        (operand, at): (Operand, Span),
        span: Span,
        want: Option<TypeId>,
    ) -> Operand {
        let to = match func.result {
            Type::Fixed(elem) => elem,
            _ => want.and_then(|w| self.elem_of(w)).filter(|e| e.is_integer()).unwrap_or(Elem::Dint),
        };
        let expr = self.settle(operand, at);
        match self.elem_of(expr.ty) {
            Some(elem) if elem.is_real() => {
                let rounded = match func.meaning {
                    Meaning::Integral(op) => round_row(op),
                    _ => None,
                };
                let Some(rounded) = rounded else { return Operand::Error };
                let ty = Types::elem(elem);
                let kind = ExprKind::Std { func: rounded, elem, args: vec![retype(expr, ty)] };
                let rounded = Expr { kind, ty, span };
                Operand::value(ExprKind::Convert(elem, to, Box::new(rounded)), Types::elem(to), span)
            }
            _ if expr.ty == Types::ERROR => Operand::Error,
            _ => {
                let name = self.cx.type_name(expr.ty);
                let strict =
                    Diagnostic::new(codes::TYPE_MISMATCH, at, format!("{} needs a REAL, this is {name}", func.name));
                if self.elem_of(expr.ty).is_some_and(Elem::is_integer)
                    && self.codesys_only(at, codes::LAX_CONVERSION, strict.clone())
                {
                    let expr = self.with_elem(expr, to, span);
                    return Operand::Value { expr, ty: Types::elem(to) };
                }
                if !self.elem_of(expr.ty).is_some_and(Elem::is_integer) {
                    self.report(strict);
                }
                Operand::Error
            }
        }
    }

    /// A formula: finds what the type variable stands for, converts the arguments, builds the node.
    fn formula(
        &mut self,
        func: &'static StdFn,
        operands: Vec<(Operand, Span)>,
        span: Span,
        want: Option<TypeId>,
    ) -> Operand {
        if let Some(op) = self.selection_of_texts(func, &operands) {
            return self.text_call(func, op, operands, span);
        }
        let is_var = |n: usize| func.param_type(n) == Some(Type::Var);
        let vars: Vec<&(Operand, Span)> =
            operands.iter().enumerate().filter(|(n, _)| is_var(*n)).map(|(_, o)| o).collect();
        let var = match func.bound {
            Some(elem) => Some(Types::elem(elem)),
            None if vars.is_empty() => Some(Types::elem(Elem::Lint)),
            None => self.type_variable(func, &vars, span, want),
        };
        let Some(var) = var else { return Operand::Error };
        let Some(elem) = self.elem_of(var) else {
            return self.choose(func, operands, var, span);
        };
        let mut args = Vec::with_capacity(operands.len());
        for (n, (operand, at)) in operands.into_iter().enumerate() {
            let arg = match func.param_type(n) {
                Some(Type::Integer) => match self.integer_argument(func, operand, at) {
                    Some(arg) => arg,
                    None => return Operand::Error,
                },
                Some(Type::Fixed(elem)) => {
                    let arg = self.coerce(operand, at, Types::elem(elem));
                    // `MUX_INT_REAL` fixes the type of K; its formula counts in LINT all the same.
                    let counts = matches!(func.meaning, Meaning::Choose(_)) && elem.is_integer();
                    if counts { self.with_elem(arg, Elem::Lint, at) } else { arg }
                }
                _ => self.coerce(operand, at, var),
            };
            if arg.ty == Types::ERROR {
                return Operand::Error;
            }
            args.push(arg);
        }
        if args.iter().all(|a| matches!(a.kind, ExprKind::Const(_))) {
            // What would fault with constants is a mistake (semantics.md \[E2\]).
            let call = Expr { kind: ExprKind::Std { func, elem, args: args.clone() }, ty: var, span };
            if let Err(why @ NotConstant::Faults(..)) = self.cx.eval(&call, Reads::Constants) {
                self.not_constant(why, Reads::Constants);
                return Operand::Error;
            }
        }
        let ty = match func.result {
            Type::Fixed(elem) => Types::elem(elem),
            Type::IntegerOfPlace => {
                let place = want.and_then(|w| self.elem_of(w)).filter(|e| e.is_integer()).unwrap_or(Elem::Int);
                let number = Expr { kind: ExprKind::Std { func, elem, args }, ty: Types::elem(Elem::Lint), span };
                return Operand::Value { expr: self.with_elem(number, place, span), ty: Types::elem(place) };
            }
            _ => var,
        };
        Operand::value(ExprKind::Std { func, elem, args }, ty, span)
    }

    /// SEL and MUX of what fits no register of the operator table: structures, arrays, references.
    fn choose(&mut self, func: &StdFn, mut operands: Vec<(Operand, Span)>, var: TypeId, span: Span) -> Operand {
        let (selector, at) = operands.remove(0);
        let selector = match func.param_type(0) {
            Some(Type::Fixed(elem)) => {
                let truth = self.coerce(selector, at, Types::elem(elem));
                self.with_elem(truth, Elem::Lint, at)
            }
            _ => match self.integer_argument(func, selector, at) {
                Some(number) => number,
                None => return Operand::Error,
            },
        };
        let choices: Vec<Expr> = operands.into_iter().map(|(o, at)| self.coerce(o, at, var)).collect();
        if selector.ty == Types::ERROR || choices.iter().any(|c| c.ty == Types::ERROR) {
            return Operand::Error;
        }
        Operand::value(ExprKind::Choose { selector: Box::new(selector), choices }, var, span)
    }

    /// What the type variable stands for: the common type of the typed arguments, else what the place asks for.
    fn type_variable(
        &mut self,
        func: &'static StdFn,
        vars: &[&(Operand, Span)],
        span: Span,
        want: Option<TypeId>,
    ) -> Option<TypeId> {
        let codesys = self.codesys(span);
        let mut common: Option<TypeId> = None;
        let mut real_literal = false;
        for (operand, at) in vars.iter().copied() {
            let ty = match operand {
                Operand::Value { ty, .. } => *ty,
                Operand::Real(_) => {
                    real_literal = true;
                    continue;
                }
                _ => continue,
            };
            common = match common {
                None => Some(ty),
                Some(before) if before == ty => Some(before),
                // Aggregates and references: the others are assigned to the type of the first.
                Some(before) if self.chooses(func, before) && self.chooses(func, ty) => {
                    Some(if *self.cx.defs.types.get(before) == Ty::Null { ty } else { before })
                }
                Some(before) => {
                    let plain = |c: &Self, t| match c.cx.defs.types.get(t) {
                        Ty::Elem(e) | Ty::Subrange { base: e, .. } => Some(*e),
                        _ => None,
                    };
                    match plain(self, before).zip(plain(self, ty)).and_then(|(a, b)| rules::common(a, b, codesys)) {
                        Some(elem) => Some(Types::elem(elem)),
                        None => {
                            let (a, b) = (self.cx.type_name(before), self.cx.type_name(ty));
                            let message = format!("{} cannot combine {a} and {b}", func.name);
                            self.report(
                                Diagnostic::new(codes::WRONG_OPERAND, *at, message)
                                    .help("convert one of them so that both have one type"),
                            );
                            return None;
                        }
                    }
                }
            };
        }
        let place = want.filter(|w| {
            let elem = self.elem_of(*w);
            elem.is_some_and(|e| self.belongs(func.generic, e) && (!real_literal || e.is_real()))
        });
        let ty = match common {
            Some(ty) => match self.cx.defs.types.get(ty) {
                Ty::Subrange { base, .. } => Types::elem(*base),
                _ => ty,
            },
            // Only untyped constants.
            None if real_literal => place.unwrap_or(Types::elem(Elem::Lreal)),
            None => match place {
                Some(place) => place,
                None if func.generic == Generic::Real => Types::elem(Elem::Lreal),
                None if func.generic == Generic::BitString => {
                    let bits = [Elem::Byte, Elem::Word, Elem::Dword, Elem::Lword];
                    let holds =
                        |e: &Elem| vars.iter().all(|(o, _)| !matches!(o, Operand::Int(v) if !rules::holds(*e, *v)));
                    Types::elem(bits.into_iter().find(holds).unwrap_or(Elem::Lword))
                }
                None => {
                    let largest = vars.iter().filter_map(|(o, _)| match o {
                        Operand::Int(v) => rules::default_integer(*v),
                        _ => None,
                    });
                    Types::elem(largest.max_by_key(|e| (e.bits(), !e.is_signed())).unwrap_or(Elem::Int))
                }
            },
        };
        let Some(elem) = self.elem_of(ty) else {
            return self.var_of_other_type(func, ty, vars, span);
        };
        // A real literal beside integers makes the call real.
        if real_literal && elem.is_integer() {
            return Some(
                place.filter(|p| self.elem_of(*p).is_some_and(Elem::is_real)).unwrap_or(Types::elem(Elem::Lreal)),
            );
        }
        if self.belongs(func.generic, elem) {
            return Some(ty);
        }
        // ANY_REAL takes integers by the implicit conversion.
        if func.generic == Generic::Real && (elem.is_integer() || (codesys && elem.is_bits())) {
            let real = want.and_then(|w| self.elem_of(w)).filter(|e| e.is_real());
            let exact = if elem.bits() <= 16 { Elem::Real } else { Elem::Lreal };
            let real = match real {
                Some(Elem::Lreal) => Elem::Lreal,
                Some(Elem::Real) if rules::implicit(elem, Elem::Real) == Implicit::Exact => Elem::Real,
                _ => exact,
            };
            return Some(Types::elem(real));
        }
        if codesys && func.generic == Generic::BitString && elem.is_integer() {
            return Some(Types::elem(crate::operators::bits_of(elem)));
        }
        if codesys && func.generic == Generic::Num && elem.is_bits() {
            return Some(Types::elem(rules::as_number(elem)));
        }
        self.does_not_take(func, ty, vars.first().map_or(span, |v| v.1));
        None
    }

    pub fn does_not_take(&mut self, func: &StdFn, ty: TypeId, at: Span) {
        if ty == Types::ERROR {
            return;
        }
        let name = self.cx.type_name(ty);
        self.report(
            Diagnostic::new(codes::WRONG_OPERAND, at, format!("{} does not take {name}", func.name))
                .help(format!("it is {}", func.signature())),
        );
    }

    fn belongs(&self, generic: Generic, elem: Elem) -> bool {
        generic.contains(elem)
    }

    /// Whether SEL and MUX may choose between values of a type that is not elementary.
    fn chooses(&self, func: &StdFn, ty: TypeId) -> bool {
        matches!(func.meaning, Meaning::Choose(_))
            && matches!(self.cx.defs.types.get(ty), Ty::Struct(_) | Ty::Array { .. } | Ty::Ref { .. } | Ty::Null)
    }

    /// The type variable of SEL and MUX as a structure, array and so on.
    fn var_of_other_type(&mut self, func: &StdFn, ty: TypeId, vars: &[&(Operand, Span)], span: Span) -> Option<TypeId> {
        if ty == Types::ERROR {
            return None;
        }
        if self.chooses(func, ty) {
            return Some(ty);
        }
        if matches!(self.cx.defs.types.get(ty), Ty::AnyArray { .. }) {
            let what = format!("{} of {}", func.name, self.cx.type_name(ty));
            self.not_yet(span, &what);
            return None;
        }
        self.does_not_take(func, ty, vars.first().map_or(span, |v| v.1));
        None
    }
}

/// The row that rounds a real inside its own type.
fn round_row(op: plcc_stdlib::prim::PrimOp) -> Option<&'static StdFn> {
    plcc_stdlib::funcs::rounding(op)
}
