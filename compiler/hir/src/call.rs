//! What a call calls: POUs, actions, standard functions, and the forms that look like calls; arguments are in `arguments`
//! (semantics.md \[S4\]).

use crate::arguments::Arguments;
use crate::body::*;
use crate::cx::*;
use crate::defs::*;
use crate::expr::*;
use crate::place::Found;
use crate::specials::{self, Special};
use crate::types::{Type, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_syntax::ast;

/// What a callee turned out to be.
pub(crate) enum Target {
    /// A user's function, instance or action.
    User(Callee, PouId),
    /// A standard function by its folded name.
    Standard(&'static plcc_stdlib::funcs::StdFn),
    /// `REF`, `ADR`, `SIZEOF` and what else is no function of values.
    Special(Special),
    Reported,
}

impl<'a> Checker<'_, 'a> {
    /// A call as an operand: it must give a value. A REFERENCE TO is followed.
    pub fn call_operand(&mut self, call: &'a ast::Call, span: Span, want: Option<TypeId>) -> Operand {
        let value = self.call_itself(call, span, want);
        self.followed_value(value)
    }

    /// As [`Self::call_operand`], but a REFERENCE TO is the reference.
    pub fn call_itself(&mut self, call: &'a ast::Call, span: Span, want: Option<TypeId>) -> Operand {
        match self.callee(&call.callee) {
            Target::Reported => {
                self.check_arguments_alone(&call.args);
                Operand::Error
            }
            Target::Standard(func) => self.standard_call(func, call, span, want),
            Target::Special(special) => self.special_call(special, call, span),
            Target::User(callee, pou) => {
                let result = self.cx.defs.pous[pou].result;
                let is_function = matches!(callee, Callee::Function(_));
                let arguments = Arguments::of(call);
                let Some(checked) = self.user_call(callee, pou, arguments, span) else { return Operand::Error };
                if !is_function {
                    let name = self.cx.defs.pous[pou].name.clone();
                    self.report(
                        Diagnostic::new(codes::NO_VALUE, span, format!("a call of `{name}` gives no value"))
                            .help("call it as a statement, then use its outputs"),
                    );
                    return Operand::Error;
                }
                let ty = match result {
                    Some(var) => self.type_of_var(var),
                    None => Types::VOID,
                };
                if ty == Types::ERROR {
                    return Operand::Error;
                }
                Operand::value(ExprKind::Call(Box::new(checked)), ty, span)
            }
        }
    }

    /// A call as a statement.
    pub fn call_statement(&mut self, call: &'a ast::Call, span: Span) -> Option<StmtKind> {
        match self.callee(&call.callee) {
            Target::Reported => {
                self.check_arguments_alone(&call.args);
                None
            }
            Target::Standard(func) => match self.standard_call(func, call, span, None) {
                Operand::Error => None,
                operand => {
                    let expr = self.settle(operand, span);
                    Some(StmtKind::Eval(expr))
                }
            },
            Target::Special(special) => {
                self.special_call(special, call, span);
                None
            }
            Target::User(callee, pou) => {
                self.user_call(callee, pou, Arguments::of(call), span).map(|c| StmtKind::Call(Box::new(c)))
            }
        }
    }

    /// Errors inside the arguments of a call that cannot be resolved are still worth a message.
    pub fn check_arguments_alone(&mut self, args: &'a [ast::Arg]) {
        for arg in args {
            match &arg.kind {
                ast::ArgKind::Positional(e) | ast::ArgKind::Input(_, Some(e)) => {
                    self.operand(e, None);
                }
                ast::ArgKind::Output { target: Some(e), .. } => {
                    self.place(e);
                }
                _ => {}
            }
        }
    }

    /// What an expression in call position names.
    pub fn callee(&mut self, callee: &'a ast::Expr) -> Target {
        match &callee.kind {
            ast::ExprKind::Name(name) => self.named_callee(name),
            ast::ExprKind::Member(base, name) => self.member_callee(base, name, callee),
            ast::ExprKind::Index(..) | ast::ExprKind::Deref(_) => match self.place(callee) {
                Some(place) => self.instance_callee(place),
                None => Target::Reported,
            },
            ast::ExprKind::Error => Target::Reported,
            _ => {
                self.report(
                    Diagnostic::new(codes::NOT_CALLABLE, callee.span, "this cannot be called")
                        .help("a call names a function, an instance of a function block or an action"),
                );
                Target::Reported
            }
        }
    }

    /// In call position the search goes on to something callable (\[L3\]).
    pub fn named_callee(&mut self, name: &'a ast::Name) -> Target {
        let found = self.lookup(name);
        let key = fold(&name.text);
        match found {
            Found::Var(var) => {
                let ty = self.type_of_var(var);
                let place = self.followed(Place { root: Root::Var(var), steps: Vec::new(), ty, span: name.span });
                if self.cx.instance_of(place.ty).is_some() {
                    return self.instance_callee(place);
                }
                if let Some(scope) = self.scope
                    && let Some(action) = self.cx.action_named(scope, &key)
                {
                    return Target::User(Callee::Action(None, action), action);
                }
                let callable = match self.cx.pous.get(&key) {
                    Some(pou) => self.cx.defs.pous[*pou].kind == PouKind::Function,
                    None => plcc_stdlib::funcs::find(&key).is_some(),
                };
                if ty == Types::ERROR && !callable {
                    return Target::Reported;
                }
            }
            Found::Action(action) => return Target::User(Callee::Action(None, action), action),
            Found::Reported => return Target::Reported,
            _ => {}
        }
        // A standard block calls standard functions, whatever users call theirs.
        let builtin = self.cx.builtin_files.contains(&name.span.file);
        if let Some(&pou) = self.cx.pous.get(&key)
            && !builtin
        {
            let kind = self.cx.defs.pous[pou].kind;
            return match kind {
                PouKind::Function => Target::User(Callee::Function(pou), pou),
                _ if !self.cx.first_report(self.scope, &format!("pou {key}")) => Target::Reported,
                kind => {
                    let what = if kind == PouKind::Program { "a PROGRAM" } else { "a FUNCTION_BLOCK" };
                    self.report(
                        Diagnostic::new(codes::NOT_CALLABLE, name.span, format!("`{}` is {what}", name.text)).help(
                            match kind {
                                PouKind::Program => "programs are run by tasks; they cannot be called".to_string(),
                                _ => format!("declare an instance, `inst : {};`, and call that", name.text),
                            },
                        ),
                    );
                    Target::Reported
                }
            };
        }
        if let Some(row) = specials::find(&key) {
            return Target::Special(row.special);
        }
        if let Some(func) = plcc_stdlib::funcs::find(&key) {
            return Target::Standard(func);
        }
        if let Found::Var(var) = found {
            let id = self.cx.defs.vars[var].ty;
            let ty = self.cx.type_name(id);
            let help = match self.cx.defs.types.get(id) {
                Type::Array { .. } | Type::AnyArray { .. } => crate::habits::element_help(&name.text),
                _ => "only functions, instances of function blocks and actions can be called".into(),
            };
            self.report(
                Diagnostic::new(codes::NOT_CALLABLE, name.span, format!("`{}` is a variable of type {ty}", name.text))
                    .help(help),
            );
            return Target::Reported;
        }
        if !self.cx.first_report(self.scope, &name.text) {
            return Target::Reported;
        }
        let pous = self.cx.pous.iter().filter(|(_, p)| self.cx.defs.pous[**p].kind == PouKind::Function);
        let mut names: Vec<&str> = pous.map(|(n, _)| n.as_str()).collect();
        for name in plcc_stdlib::funcs::names().chain(specials::SPECIALS.iter().map(|row| row.name)) {
            names.push(name);
        }
        if let Some(scope) = self.scope {
            names.extend(self.cx.pou_slots[scope].scope.keys().map(|k| k.as_str()));
        }
        let hint = similar(&name.text, names.into_iter());
        self.report(
            Diagnostic::new(
                codes::UNKNOWN_FUNCTION,
                name.span,
                format!("there is no function or instance `{}`", name.text),
            )
            .help_if(
                crate::habits::foreign_function(&key)
                    .map(String::from)
                    .or(hint.map(|h| format!("did you mean `{h}`?"))),
            ),
        );
        Target::Reported
    }

    fn instance_callee(&mut self, place: Place) -> Target {
        match *self.cx.defs.types.get(place.ty) {
            Type::Instance(pou) => Target::User(Callee::Instance(place, pou), pou),
            Type::Error => Target::Reported,
            _ => {
                let ty = self.cx.type_name(place.ty);
                self.report(
                    Diagnostic::new(codes::NOT_CALLABLE, place.span, format!("{ty} cannot be called"))
                        .help("only functions, instances of function blocks and actions can be called"),
                );
                Target::Reported
            }
        }
    }

    /// `fb.act()` or `fb.inner()`.
    fn member_callee(&mut self, base: &'a ast::Expr, name: &'a ast::Name, whole: &'a ast::Expr) -> Target {
        let Some(instance) = self.place(base) else { return Target::Reported };
        if let Some(pou) = self.cx.instance_of(instance.ty)
            && let Some(action) = self.cx.action_named(pou, &name.text)
        {
            return Target::User(Callee::Action(Some(instance), action), action);
        }
        match self.place(whole) {
            Some(place) => self.instance_callee(place),
            None => Target::Reported,
        }
    }

    fn special_call(&mut self, special: Special, call: &'a ast::Call, span: Span) -> Operand {
        match special {
            Special::Reference { pointer } => self.reference_to(pointer, call, span),
            Special::SizeOf => self.size_of(call, span),
            Special::IsValidRef => self.is_valid_reference(call, span),
            Special::Bound { upper } => self.bound(upper, call, span),
        }
    }
}
