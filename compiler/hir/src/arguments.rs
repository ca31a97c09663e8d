//! Arguments of a user's POU: by name and by position, EN and ENO, what fits a parameter, what an output goes to
//! (semantics.md \[S4\] \[S5\] \[S6\]).

use crate::body::*;
use crate::cx::*;
use crate::defs::*;
use crate::expr::*;
use crate::place::Found;
use crate::rules::{self, Implicit};
use crate::types::{Type, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::Elem;
use plcc_syntax::ast::{self, BinaryOp};
use rustc_hash::FxHashMap;
use smol_str::SmolStr;

/// What a call of a user's POU is given.
pub(crate) struct Arguments<'a> {
    /// The value for the first parameter: the current result of IL.
    pub first: Option<(Operand, Span)>,
    /// The others as written.
    pub args: &'a [ast::Arg],
    /// The name of the callee, for messages.
    pub at: Span,
}

impl<'a> Arguments<'a> {
    pub fn of(call: &'a ast::Call) -> Self {
        Self { first: None, args: &call.args, at: call.callee.span }
    }
}

impl<'a> Checker<'_, 'a> {
    /// Parameters of a POU as a call sees them.
    fn parameters(&self, pou: PouId, section: &[Section]) -> Vec<VarId> {
        let vars = self.cx.defs.pous[pou].vars.iter().copied();
        vars.filter(|v| section.contains(&self.cx.defs.vars[*v].section) && !self.cx.defs.vars[*v].is_hidden())
            .collect()
    }

    /// A call of a user's POU.
    pub fn user_call(&mut self, callee: Callee, pou: PouId, call: Arguments<'a>, span: Span) -> Option<Call> {
        let mut out =
            Call { callee, inputs: Vec::new(), in_outs: Vec::new(), outputs: Vec::new(), en: None, eno: None, span };
        let (mut fine, mut unknown) = (true, false);
        if self.cx.defs.pous[pou].kind == PouKind::Action {
            if let Some(arg) = call.args.first() {
                self.report(
                    Diagnostic::new(codes::UNKNOWN_PARAMETER, arg.span, "an action has no parameters")
                        .help("it works on the variables of its POU"),
                );
                fine = false;
            }
            return fine.then_some(out);
        }
        let positional = call.args.iter().find(|a| matches!(a.kind, ast::ArgKind::Positional(_)));
        let named = call.args.iter().find(|a| !matches!(a.kind, ast::ArgKind::Positional(_)));
        if let (Some(p), Some(n)) = (positional, named) {
            self.report(
                Diagnostic::new(codes::MIXED_ARGUMENTS, p.span, "arguments with and without names are mixed")
                    .also(n.span, "this one has a name")
                    .help("write all arguments as `name := value`, or none"),
            );
            return None;
        }
        let mut given: FxHashMap<VarId, Span> = FxHashMap::default();
        let by_order = self.parameters(pou, &[Section::Input, Section::InOut]);
        let mut next = by_order.into_iter();
        let given_count = call.args.len() + usize::from(call.first.is_some());
        if let Some((value, at)) = call.first {
            let Some(param) = next.next() else {
                self.too_many(pou, given_count, at);
                return None;
            };
            given.insert(param, at);
            fine &= self.pass_value(param, value, at, &mut out);
        }
        for arg in call.args {
            match &arg.kind {
                ast::ArgKind::Positional(e) => {
                    if let Some((name, at)) = self.equals_for_assign(pou, e) {
                        self.report(
                            Diagnostic::new(
                                codes::EQUALS_FOR_ASSIGN,
                                at,
                                "`=` compares, it gives no value to an input",
                            )
                            .help(format!("write `{name} := ...`")),
                        );
                        fine = false;
                        continue;
                    }
                    let Some(param) = next.next() else {
                        self.too_many(pou, given_count, arg.span);
                        return None;
                    };
                    given.insert(param, arg.span);
                    fine &= self.pass(param, e, &mut out);
                }
                ast::ArgKind::Input(name, value) => {
                    let special = self.en_eno(pou, name);
                    match (special, value) {
                        (Some(true), Some(e)) => {
                            out.en = Some(self.condition(e));
                            continue;
                        }
                        (Some(_), None) => continue,
                        (Some(false), _) => {
                            self.wrong_direction(name, "ENO", true);
                            fine = false;
                            continue;
                        }
                        (None, _) => {}
                    }
                    if let Some(output) = value.as_ref().and_then(|e| self.output_turned_around(pou, name, e)) {
                        let (message, help) = (
                            format!("`{output}` is an output of the callee"),
                            format!("an output is fetched with `=>`, its name first: `{output} => {}`", name.text),
                        );
                        self.report(Diagnostic::new(codes::WRONG_DIRECTION, arg.span, message).help(help));
                        fine = false;
                        continue;
                    }
                    let Some(param) = self.parameter(pou, name, &mut given) else {
                        if let Some(e) = value {
                            self.operand(e, None);
                        }
                        unknown = true;
                        continue;
                    };
                    let section = self.cx.defs.vars[param].section;
                    if section == Section::Output || section == Section::Result {
                        self.wrong_direction(name, &name.text, true);
                        fine = false;
                        continue;
                    }
                    match value {
                        Some(e) => fine &= self.pass(param, e, &mut out),
                        None => {
                            given.remove(&param);
                        }
                    }
                }
                ast::ArgKind::Output { negated, name, target } => {
                    if self.en_eno(pou, name) == Some(false) {
                        match self.eno_target(*negated, target.as_ref()) {
                            Some(target) => out.eno = target,
                            None => fine = false,
                        }
                        continue;
                    }
                    let Some(param) = self.parameter(pou, name, &mut given) else {
                        if let Some(e) = target {
                            self.operand(e, None);
                        }
                        unknown = true;
                        continue;
                    };
                    match self.cx.defs.vars[param].section {
                        Section::Output | Section::Result => {}
                        _ => {
                            self.wrong_direction(name, &name.text, false);
                            fine = false;
                            continue;
                        }
                    }
                    if let Some(target) = target {
                        match self.fetch(param, *negated, target) {
                            Some(output) => out.outputs.push(output),
                            None => fine = false,
                        }
                    }
                }
            }
        }
        // A name that is no parameter's may have been meant for what is missing.
        fine &= unknown || self.all_in_outs_given(pou, &given, call.at);
        (fine && !unknown).then_some(out)
    }

    /// The parameter in `parameter = value`, where that compares nothing, and the place of the `=`.
    fn equals_for_assign(&self, pou: PouId, e: &ast::Expr) -> Option<(SmolStr, Span)> {
        let ast::ExprKind::Binary(BinaryOp::Eq, at, left, _) = &e.kind else { return None };
        let ast::ExprKind::Name(name) = &left.kind else { return None };
        let known = self.cx.pou_slots[pou].scope.contains_key(&fold(&name.text));
        (known && matches!(self.lookup(name), Found::Missing)).then(|| (name.text.clone(), *at))
    }

    /// The output that `variable := output` was meant to fetch: `name` is no parameter but a variable here, `value` the
    /// other way round.
    fn output_turned_around(&self, pou: PouId, name: &ast::Name, value: &ast::Expr) -> Option<SmolStr> {
        let ast::ExprKind::Name(output) = &value.kind else { return None };
        let scope = &self.cx.pou_slots[pou].scope;
        let Some(Local::Var(var)) = scope.get(&fold(&output.text)) else { return None };
        let fetched = self.cx.defs.vars[*var].section == Section::Output
            && !scope.contains_key(&fold(&name.text))
            && matches!(self.lookup(name), Found::Var(_))
            && matches!(self.lookup(output), Found::Missing);
        fetched.then(|| self.cx.defs.vars[*var].name.clone())
    }

    /// `Some(true)` for EN, `Some(false)` for ENO, unless the POU declares a parameter of that name.
    fn en_eno(&self, pou: PouId, name: &ast::Name) -> Option<bool> {
        let key = fold(&name.text);
        if self.cx.pou_slots[pou].scope.contains_key(&key) {
            return None;
        }
        match key.as_str() {
            "EN" => Some(true),
            "ENO" => Some(false),
            _ => None,
        }
    }

    /// The variable behind `ENO =>`, if one is written; `None` after a mistake.
    pub fn eno_target(&mut self, negated: bool, target: Option<&'a ast::Expr>) -> Option<Option<Eno>> {
        let Some(target) = target else { return Some(None) };
        let place = self.place(target)?;
        if self.elem_of(place.ty) != Some(Elem::Bool) {
            let message = format!("ENO is BOOL, this variable is {}", self.cx.type_name(place.ty));
            self.report(
                Diagnostic::new(codes::TYPE_MISMATCH, target.span, message).help("fetch it with a BOOL variable"),
            );
            return None;
        }
        self.check_writable(&place).then_some(Some(Eno { target: place, negated }))
    }

    pub fn wrong_direction(&mut self, name: &ast::Name, what: &str, is_output: bool) {
        let (message, help) = if is_output {
            (format!("`{what}` is an output"), format!("fetch it with `{what} => variable`"))
        } else {
            (format!("`{what}` is an input"), format!("give it a value with `{what} := value`"))
        };
        self.report(Diagnostic::new(codes::WRONG_DIRECTION, name.span, message).help(help));
    }

    fn too_many(&mut self, pou: PouId, count: usize, span: Span) {
        let params = self.parameters(pou, &[Section::Input, Section::InOut]);
        let names: Vec<&str> = params.iter().map(|v| self.cx.defs.vars[*v].name.as_str()).collect();
        let name = self.cx.defs.pous[pou].name.clone();
        let parameters = if names.len() == 1 { "parameter" } else { "parameters" };
        let message = format!("{count} arguments for the {} {parameters} of `{name}`", names.len());
        let help = if names.is_empty() { "it has none".into() } else { format!("it takes {}", names.join(", ")) };
        self.report(Diagnostic::new(codes::TOO_MANY_ARGUMENTS, span, message).help(help));
    }

    fn parameter(&mut self, pou: PouId, name: &ast::Name, given: &mut FxHashMap<VarId, Span>) -> Option<VarId> {
        let key = self.pin_name(pou, name);
        let found = match self.cx.pou_slots[pou].scope.get(&key) {
            Some(Local::Var(var)) => Some(*var),
            _ => None,
        };
        let is_parameter = |c: &Self, v: VarId| {
            matches!(c.cx.defs.vars[v].section, Section::Input | Section::Output | Section::InOut | Section::Result)
        };
        match found.filter(|v| is_parameter(self, *v)) {
            Some(param) => {
                if let Some(first) = given.insert(param, name.span) {
                    self.report(
                        Diagnostic::new(
                            codes::DUPLICATE_ARGUMENT,
                            name.span,
                            format!("parameter `{}` is given twice", name.text),
                        )
                        .also(first, "first given here")
                        .help("remove one of them"),
                    );
                    return None;
                }
                Some(param)
            }
            None => {
                let params = self.parameters(pou, &[Section::Input, Section::Output, Section::InOut]);
                let names = params.iter().map(|v| self.cx.defs.vars[*v].name.as_str());
                let hint = similar(&name.text, names.clone());
                let def = &self.cx.defs.pous[pou];
                let help = match (hint, found) {
                    (Some(near), _) => format!("did you mean `{near}`?"),
                    (None, Some(_)) => "it is an inner variable and cannot be given from outside".into(),
                    (None, None) => format!("its parameters are {}", names.collect::<Vec<_>>().join(", ")),
                };
                let mut d = Diagnostic::new(
                    codes::UNKNOWN_PARAMETER,
                    name.span,
                    format!("`{}` has no parameter `{}`", def.name, name.text),
                )
                .help(help);
                if !def.builtin {
                    d = d.also(def.span, "declared here");
                }
                self.report(d);
                None
            }
        }
    }

    /// One argument for an input or VAR_IN_OUT.
    fn pass(&mut self, param: VarId, e: &'a ast::Expr, out: &mut Call) -> bool {
        let ty = self.type_of_var(param);
        if self.cx.defs.vars[param].section == Section::InOut {
            let place = if self.is_reference_to(ty) { self.place_itself(e) } else { self.place(e) };
            let Some(place) = place else { return false };
            if !self.in_out_fits(param, ty, &place) || !self.check_writable(&place) {
                return false;
            }
            if !self.addressable(&place, "a VAR_IN_OUT") {
                return false;
            }
            let passed = self.pass_bounds(param, &place, out);
            out.in_outs.push((param, place));
            return passed;
        }
        let value = match self.is_reference_to(ty) {
            true => Operand::Value { expr: self.value(e, ty), ty },
            false => self.operand(e, Some(ty)),
        };
        self.pass_value(param, value, e.span, out)
    }

    /// A value for an input.
    fn pass_value(&mut self, param: VarId, value: Operand, at: Span, out: &mut Call) -> bool {
        let ty = self.type_of_var(param);
        if self.cx.defs.vars[param].section == Section::InOut {
            let name = self.cx.defs.vars[param].name.clone();
            self.report(
                Diagnostic::new(codes::NOT_A_VARIABLE, at, format!("VAR_IN_OUT `{name}` needs a variable"))
                    .help("a value cannot be changed; use the formal form and name a variable"),
            );
            return false;
        }
        let value = self.coerce(value, at, ty);
        if value.ty == Types::ERROR {
            return false;
        }
        out.inputs.push((param, value));
        true
    }

    /// A call of an instance that gives one input a value: an input operator of IL. `at` is the instance's name.
    pub fn input_call(&mut self, instance: Place, input: VarId, value: (Operand, Span), span: Span) -> Option<Call> {
        let pou = self.cx.instance_of(instance.ty)?;
        let at = instance.span;
        let callee = Callee::Instance(instance, pou);
        let mut out =
            Call { callee, inputs: Vec::new(), in_outs: Vec::new(), outputs: Vec::new(), en: None, eno: None, span };
        let fine = self.pass_value(input, value.0, value.1, &mut out);
        let given = FxHashMap::from_iter([(input, at)]);
        (self.all_in_outs_given(pou, &given, at) && fine).then_some(out)
    }

    /// A VAR_IN_OUT takes a variable of equal type; with open capacity or bounds any (\[S4\]).
    fn in_out_fits(&mut self, param: VarId, ty: TypeId, place: &Place) -> bool {
        if ty == Types::ERROR || place.ty == Types::ERROR {
            return false;
        }
        if ty == place.ty {
            return true;
        }
        let types = &self.cx.defs.types;
        match (types.get(ty).clone(), types.get(place.ty).clone()) {
            (Type::AnyString { wide: a }, Type::String { wide: b, .. } | Type::AnyString { wide: b }) if a == b => {
                return true;
            }
            (Type::AnyArray { dims, elem }, Type::Array { dims: d, elem: e }) if dims == d.len() && elem == e => {
                return true;
            }
            _ => {}
        }
        let lax = self.similar_memory(ty, place.ty);
        let (want, have) = (self.cx.type_name(ty), self.cx.type_name(place.ty));
        let (name, span) = (self.cx.defs.vars[param].name.clone(), self.cx.defs.vars[param].span);
        let d = Diagnostic::new(
            codes::IN_OUT_MISMATCH,
            place.span,
            format!("VAR_IN_OUT `{name}` is {want}, this variable is {have}"),
        )
        .also(span, "the parameter is declared here")
        .help(if self.is_text(ty) && self.text_kind(ty) == self.text_kind(place.ty) {
            "declare both with the same length, or the parameter as STRING without length, which takes any"
        } else {
            "a VAR_IN_OUT is the variable itself: both must have the same type"
        });
        if lax {
            return self.codesys_only(place.span, codes::LAX_CONVERSION, d);
        }
        self.report(d);
        false
    }

    /// Whether a variable of type `have` can be used as one of type `want` in its memory (\[S4\] \[P2\], with a warning):
    /// a longer string, an array with other bounds of equal length.
    pub fn similar_memory(&self, want: TypeId, have: TypeId) -> bool {
        let types = &self.cx.defs.types;
        match (types.get(want), types.get(have)) {
            (Type::String { wide: a, capacity: m }, Type::String { wide: b, capacity: n }) => a == b && n >= m,
            (Type::Array { dims: a, elem: x }, Type::Array { dims: b, elem: y }) => {
                let count = |d: &[(i64, i64)]| d.iter().map(|(l, h)| h - l + 1).product::<i64>();
                x == y && count(a) == count(b)
            }
            _ => false,
        }
    }

    /// `output => target`.
    fn fetch(&mut self, param: VarId, negated: bool, target: &'a ast::Expr) -> Option<OutputArg> {
        let ty = self.type_of_var(param);
        let place = if self.is_reference_to(ty) { self.place_itself(target) } else { self.place(target) }?;
        if !self.check_writable(&place) || ty == Types::ERROR {
            return None;
        }
        if negated && self.elem_of(ty) != Some(Elem::Bool) {
            let name = self.cx.type_name(ty);
            self.report(Diagnostic::new(
                codes::WRONG_OPERAND,
                target.span,
                format!("NOT needs a BOOL output, this is {name}"),
            ));
            return None;
        }
        let convert = if ty == place.ty {
            None
        } else {
            match (self.elem_of(ty), self.elem_of(place.ty)) {
                (Some(from), Some(to)) if !self.is_enum(ty) && !self.is_enum(place.ty) => {
                    match rules::implicit(from, to) {
                        Implicit::Same => None,
                        Implicit::Exact | Implicit::Rounds => Some((from, to)),
                        how => {
                            let (have, want) = (self.cx.type_name(ty), self.cx.type_name(place.ty));
                            let d = Diagnostic::new(
                                codes::TYPE_MISMATCH,
                                target.span,
                                format!("the output is {have}, this variable is {want}"),
                            )
                            .help(conversion_help(from, to));
                            if how == Implicit::No {
                                self.report(d);
                                return None;
                            }
                            if !self.codesys_only(target.span, codes::LAX_CONVERSION, d) {
                                return None;
                            }
                            Some((from, to))
                        }
                    }
                }
                _ => {
                    // A string, or a single character, goes to a string of its kind.
                    let kind = self.text_kind(ty);
                    if kind.is_none() || kind != self.string_kind(place.ty) {
                        let (have, want) = (self.cx.type_name(ty), self.cx.type_name(place.ty));
                        let followed = self.is_reference_to(ty).then_some("read it behind the call, `instance.output`");
                        self.report(
                            Diagnostic::new(
                                codes::TYPE_MISMATCH,
                                target.span,
                                format!("the output is {have}, this variable is {want}"),
                            )
                            .help_if(followed.map(String::from)),
                        );
                        return None;
                    }
                    None
                }
            }
        };
        Some(OutputArg { output: param, negated, convert, target: place })
    }

    fn is_enum(&self, ty: TypeId) -> bool {
        matches!(self.cx.defs.types.get(ty), Type::Enum(_))
    }

    fn all_in_outs_given(&mut self, pou: PouId, given: &FxHashMap<VarId, Span>, at: Span) -> bool {
        let missing: Vec<VarId> =
            self.parameters(pou, &[Section::InOut]).into_iter().filter(|v| !given.contains_key(v)).collect();
        for param in &missing {
            let (name, span) = (self.cx.defs.vars[*param].name.clone(), self.cx.defs.vars[*param].span);
            self.report(
                Diagnostic::new(codes::MISSING_IN_OUT, at, format!("VAR_IN_OUT `{name}` is not connected"))
                    .also(span, "declared here")
                    .help(format!("give it a variable in every call: `{name} := variable`")),
            );
        }
        missing.is_empty()
    }
}
