//! Arguments of standard functions: which goes to which parameter, EN, ENO and outputs (semantics.md \[S4\] \[S6\]).

use crate::body::*;
use crate::cx::similar;
use crate::expr::*;
use crate::rules;
use crate::types::{Type as Ty, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::Elem;
use plcc_stdlib::funcs::{Output, StdFn, Type};
use plcc_syntax::ast;

/// The arguments of a call, each at its place.
#[derive(Default)]
pub(crate) struct Placed<'a> {
    /// By position of the parameter.
    pub args: Vec<Option<&'a ast::Expr>>,
    pub en: Option<Expr>,
    pub eno: Option<Eno>,
    /// Outputs that are fetched.
    pub outputs: Vec<(Place, Output)>,
}

impl<'a> Checker<'_, 'a> {
    /// Brings arguments into the order of the parameters.
    pub fn place_arguments(&mut self, func: &'static StdFn, call: &'a ast::Call) -> Option<Placed<'a>> {
        let mut placed = Placed::default();
        let mut fine = true;
        let positional = call.args.iter().any(|a| matches!(a.kind, ast::ArgKind::Positional(_)));
        let named = call.args.iter().find(|a| !matches!(a.kind, ast::ArgKind::Positional(_)));
        if let (true, Some(named)) = (positional, named) {
            self.report(
                Diagnostic::new(codes::MIXED_ARGUMENTS, named.span, "arguments with and without names are mixed")
                    .help("write all arguments as `name := value`, or none"),
            );
            return None;
        }
        for (n, arg) in call.args.iter().enumerate() {
            match &arg.kind {
                ast::ArgKind::Positional(e) => {
                    if func.param_type(n).is_none() {
                        let message = format!("{} arguments for {}", call.args.len(), func.name);
                        self.report(
                            Diagnostic::new(codes::TOO_MANY_ARGUMENTS, arg.span, message)
                                .help(format!("it is {}", func.signature())),
                        );
                        return None;
                    }
                    placed.args.push(Some(e));
                }
                ast::ArgKind::Input(name, value) => {
                    if name.text.eq_ignore_ascii_case("EN") {
                        placed.en = value.as_ref().map(|e| self.condition(e));
                        fine &= placed.en.as_ref().is_none_or(|e| e.ty != Types::ERROR);
                        continue;
                    }
                    if name.text.eq_ignore_ascii_case("ENO") || func.output(&name.text).is_some() {
                        self.wrong_direction(name, &name.text.to_ascii_uppercase(), true);
                        fine = false;
                        continue;
                    }
                    let Some(index) = func.param_index(&name.text) else {
                        let names: Vec<String> = (0..func.min_args()).map(|n| func.param_name(n)).collect();
                        let hint = similar(&name.text, names.iter().map(String::as_str));
                        let message = format!("{} has no parameter `{}`", func.name, name.text);
                        self.report(Diagnostic::new(codes::UNKNOWN_PARAMETER, name.span, message).help(match hint {
                            Some(near) => format!("did you mean `{near}`?"),
                            None => format!("it is {}", func.signature()),
                        }));
                        fine = false;
                        continue;
                    };
                    if placed.args.len() <= index {
                        placed.args.resize(index + 1, None);
                    }
                    if placed.args[index].is_some() {
                        self.report(
                            Diagnostic::new(
                                codes::DUPLICATE_ARGUMENT,
                                name.span,
                                format!("parameter `{}` is given twice", name.text),
                            )
                            .help("remove one of them"),
                        );
                        fine = false;
                        continue;
                    }
                    placed.args[index] = value.as_ref();
                }
                ast::ArgKind::Output { negated, name, target } => {
                    if name.text.eq_ignore_ascii_case("ENO") {
                        match self.eno_target(*negated, target.as_ref()) {
                            Some(target) => placed.eno = target,
                            None => fine = false,
                        }
                        continue;
                    }
                    let Some(output) = func.output(&name.text).copied().filter(|_| !negated) else {
                        self.no_such_output(func, name);
                        fine = false;
                        continue;
                    };
                    let Some(target) = target else { continue };
                    match self.output_target(func, output, target) {
                        Some(place) => placed.outputs.push((place, output)),
                        None => fine = false,
                    }
                }
            }
        }
        if fine {
            let missing =
                (0..func.min_args().max(placed.args.len())).find(|n| placed.args.get(*n).is_none_or(|a| a.is_none()));
            if let Some(n) = missing {
                let message = format!("argument `{}` of {} is missing", func.param_name(n), func.name);
                self.report(
                    Diagnostic::new(codes::MISSING_ARGUMENT, call.parens, message)
                        .help(format!("it is {}", func.signature())),
                );
                return None;
            }
        }
        fine.then_some(placed)
    }

    fn no_such_output(&mut self, func: &StdFn, name: &ast::Name) {
        let hint = similar(&name.text, func.outputs.iter().map(|o| o.name).chain(["ENO"]));
        let (message, help) = if func.param_index(&name.text).is_some() {
            (format!("`{}` is an input", name.text), format!("give it a value with `{} := value`", name.text))
        } else {
            let help = match hint {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("it is {}", func.signature()),
            };
            (format!("{} has no output `{}`", func.name, name.text), help)
        };
        self.report(Diagnostic::new(codes::UNKNOWN_PARAMETER, name.span, message).help(help));
    }

    /// The arguments into temporaries, in written order, and the function over those.
    pub fn call_in_steps(
        &mut self,
        func: &'static StdFn,
        placed: Placed<'a>,
        mut operands: Vec<(Operand, Span)>,
        span: Span,
        want: Option<TypeId>,
    ) -> Operand {
        let mut arguments = Vec::new();
        for (operand, at) in &mut operands {
            let Operand::Value { expr, .. } = operand else { continue };
            if matches!(expr.kind, ExprKind::Const(_) | ExprKind::String(_) | ExprKind::WString(_)) {
                continue;
            }
            // A string of any capacity stays the variable that it is: no temporary has its capacity.
            if matches!(self.cx.defs.types.get(expr.ty), Ty::AnyString { .. }) {
                continue;
            }
            let temp = self.temps.push(expr.ty);
            let read = Expr { kind: ExprKind::Temp(temp), ty: expr.ty, span: *at };
            arguments.push((temp, std::mem::replace(expr, read)));
        }
        arguments.sort_by_key(|(_, e)| e.span.start);
        let Some(outputs) = self.fetched(func, placed.outputs, &operands) else { return Operand::Error };
        let (value, ty) = if func.result == Type::Nothing {
            (None, Types::VOID)
        } else {
            let result = self.apply(func, operands, span, want);
            let (expr, ty) = match result {
                Operand::Error => return Operand::Error,
                Operand::Value { expr, ty } => (expr, ty),
                constant => {
                    let expr = match want {
                        Some(want) => self.coerce(constant, span, want),
                        None => self.settle(constant, span),
                    };
                    let ty = expr.ty;
                    (expr, ty)
                }
            };
            if expr.ty == Types::ERROR {
                return Operand::Error;
            }
            (Some(expr), ty)
        };
        let computed = value.as_ref().map_or(Types::VOID, |v| v.ty);
        let call = StdCall { en: placed.en, arguments, value, outputs, eno: placed.eno };
        Operand::Value { expr: Expr { kind: ExprKind::StdCall(Box::new(call)), ty: computed, span }, ty }
    }

    /// The values of outputs, as their targets take them.
    fn fetched(
        &mut self,
        func: &'static StdFn,
        outputs: Vec<(Place, Output)>,
        operands: &[(Operand, Span)],
    ) -> Option<Vec<(Place, Expr)>> {
        let mut args = Vec::new();
        for (n, (operand, at)) in operands.iter().enumerate() {
            if outputs.is_empty() {
                break;
            }
            let Some(Type::Fixed(elem)) = func.param_type(n) else { return None };
            let arg = self.coerce(operand.clone(), *at, Types::elem(elem));
            if arg.ty == Types::ERROR {
                return None;
            }
            args.push(arg);
        }
        let mut fetched = Vec::new();
        for (target, output) in outputs {
            let row = func.output_row(&output)?;
            let kind = ExprKind::Std { func: row, elem: Elem::Lint, args: args.clone() };
            let value = Expr { kind, ty: Types::elem(Elem::Lint), span: target.span };
            let elem = self.elem_of(target.ty)?;
            let value = self.with_elem(value, elem, target.span);
            fetched.push((target.clone(), retype(value, target.ty)));
        }
        Some(fetched)
    }

    /// `YEAR => variable`: an integer whose type holds every value of the output.
    fn output_target(&mut self, func: &StdFn, output: Output, target: &'a ast::Expr) -> Option<Place> {
        let place = self.place(target)?;
        let (low, high) = output.range;
        let holds = match self.cx.defs.types.get(place.ty) {
            Ty::Elem(elem) if elem.is_integer() => {
                rules::holds(*elem, i128::from(low)) && rules::holds(*elem, i128::from(high))
            }
            _ => false,
        };
        if !holds {
            let name = self.cx.type_name(place.ty);
            let message = format!("{} of {} is {low} to {high}, this variable is {name}", output.name, func.name);
            self.report(
                Diagnostic::new(codes::TYPE_MISMATCH, target.span, message)
                    .help("fetch it with a variable of an integer type that holds these values"),
            );
            return None;
        }
        self.check_writable(&place).then_some(place)
    }
}
