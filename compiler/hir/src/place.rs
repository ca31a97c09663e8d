//! Names and access paths to places in memory, and who may touch what (semantics.md \[L3\] \[S5\]).

use crate::body::*;
use crate::collect::charts;
use crate::cx::*;
use crate::defs::*;
use crate::expr::*;
use crate::types::{RefKind, Type, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::Elem;
use plcc_syntax::ast;
use smol_str::SmolStr;

/// What a name means where it stands.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Found {
    Var(VarId),
    Action(PouId),
    /// A value of one or several enumerations.
    EnumValue,
    Type,
    Pou(PouId),
    /// Nothing, or something that was reported at its declaration (then silently).
    Missing,
    Reported,
}

impl<'a> Checker<'_, 'a> {
    /// Looks a name up: local, members of the POU, global, enumeration values, types, POUs.
    pub fn lookup(&self, name: &ast::Name) -> Found {
        let key = fold(&name.text);
        if let Some(scope) = self.scope
            && let Some(local) = self.cx.pou_slots[scope].scope.get(&key)
        {
            return match local {
                Local::Var(var) | Local::External(var) => {
                    self.cx.mentioned.borrow_mut().insert(*var);
                    Found::Var(*var)
                }
                Local::Action(action) => Found::Action(*action),
                Local::Missing => Found::Reported,
            };
        }
        if let Some(var) = self.cx.globals.get(&key) {
            return Found::Var(*var);
        }
        if self.cx.enum_values.contains_key(&key) {
            return Found::EnumValue;
        }
        if self.cx.types.contains_key(&key) {
            return Found::Type;
        }
        match self.cx.pous.get(&key) {
            Some(pou) => Found::Pou(*pou),
            None => Found::Missing,
        }
    }

    /// Names of variables that are visible here, for suggestions.
    fn visible_names(&self) -> Vec<&str> {
        let locals = self.scope.map(|s| {
            let vars = self.cx.defs.pous[s].vars.iter();
            vars.map(|v| self.cx.defs.vars[*v].name.as_str()).collect::<Vec<_>>()
        });
        let globals = self.cx.defs.globals.iter().map(|v| self.cx.defs.vars[*v].name.as_str());
        let values = self.cx.defs.enums.iter().flat_map(|e| e.values.iter().map(|(n, _, _)| n.as_str()));
        let words = ["TRUE", "FALSE", "NULL"];
        locals.unwrap_or_default().into_iter().chain(globals).chain(values).chain(words).collect()
    }

    /// Reports a name that means nothing, once per POU.
    pub fn unknown_name(&mut self, name: &ast::Name) {
        if !self.cx.first_report(self.scope, &name.text) {
            return;
        }
        let hint = similar(&name.text, self.visible_names().into_iter());
        let callable = plcc_stdlib::funcs::find(&fold(&name.text)).is_some();
        let hint = hint.filter(|_| crate::habits::foreign_word(&name.text).is_none());
        let help = match hint {
            Some(near) => format!("did you mean `{near}`?"),
            None if let Some(help) = crate::habits::foreign_word(&name.text) => help.into(),
            None if callable => format!("`{}` is a standard function; call it with ( )", name.text),
            None => "declare it in a VAR section".into(),
        };
        self.report(
            Diagnostic::new(codes::UNKNOWN_NAME, name.span, format!("`{}` is not declared", name.text)).help(help),
        );
    }

    /// A path to a variable or a part of one; a REFERENCE TO is followed. Reports what is none.
    pub fn place(&mut self, e: &'a ast::Expr) -> Option<Place> {
        let place = self.place_itself(e)?;
        Some(self.followed(place))
    }

    /// As [`Self::place`], but a REFERENCE TO is the variable that holds the reference.
    pub fn place_itself(&mut self, e: &'a ast::Expr) -> Option<Place> {
        match &e.kind {
            ast::ExprKind::Name(name) => self.var_place(name),
            ast::ExprKind::Member(base, name) => {
                let base = self.place(base)?;
                self.member(base, name, e.span)
            }
            ast::ExprKind::Index(base, indices) => {
                let base = self.place(base)?;
                self.index(base, indices, e.span)
            }
            ast::ExprKind::Part(base, part) => {
                let base = self.place(base)?;
                self.part(base, part, e.span)
            }
            ast::ExprKind::Deref(base) if is_place(base) => {
                let base = self.place_itself(base)?;
                self.deref(base, e.span)
            }
            ast::ExprKind::Deref(base) => self.deref_value(base, e.span),
            ast::ExprKind::Address(text) => self.direct_address(text, e.span),
            ast::ExprKind::Error => None,
            ast::ExprKind::Call(call) if self.gives_reference(&call.callee) => {
                match self.call_itself(call, e.span, None) {
                    Operand::Value { expr, .. } => self.followed_root(expr),
                    _ => None,
                }
            }
            _ => {
                let help = self.no_place_help(e);
                self.report(Diagnostic::new(codes::NOT_A_VARIABLE, e.span, "a variable is needed here").help(help));
                None
            }
        }
    }

    /// What to write for an expression that is no variable.
    fn no_place_help(&mut self, e: &ast::Expr) -> String {
        if let ast::ExprKind::Call(call) = &e.kind
            && let ast::ExprKind::Name(name) = &call.callee.kind
            && let Found::Var(var) = self.lookup(name)
        {
            let ty = self.type_of_var(var);
            match self.cx.defs.types.get(ty) {
                Type::Array { .. } | Type::AnyArray { .. } => return crate::habits::element_help(&name.text),
                Type::Instance(_) => {
                    return format!("call the instance as a statement, then use its outputs: `{}.output`", name.text);
                }
                _ => {}
            }
        }
        "this is an expression; assign it to a variable first".into()
    }

    fn var_place(&mut self, name: &'a ast::Name) -> Option<Place> {
        match self.lookup(name) {
            Found::Var(var) => {
                self.cx.var_type(var);
                if self.cx.defs.vars[var].section == Section::Global {
                    self.note_global(var, name);
                }
                // Inside its POU the name of an edge input means the pulse.
                let var = self.cx.edges.get(&var).map_or(var, |e| e.pulse);
                let ty = self.cx.defs.vars[var].ty;
                if ty == Types::ERROR {
                    return None;
                }
                Some(Place { root: Root::Var(var), steps: Vec::new(), ty, span: name.span })
            }
            Found::Missing => {
                self.unknown_name(name);
                None
            }
            Found::Reported => None,
            // Told where it was called.
            Found::Pou(_) if !self.cx.first_report(self.scope, &format!("pou {}", fold(&name.text))) => None,
            found => {
                let what = match found {
                    Found::Action(_) => "an action",
                    Found::EnumValue => "an enumeration value",
                    Found::Type => "a type",
                    _ => "a POU",
                };
                self.report(
                    Diagnostic::new(
                        codes::NOT_A_VARIABLE,
                        name.span,
                        format!("`{}` is {what}, no variable", name.text),
                    )
                    .help(match found {
                        Found::Pou(pou) if self.cx.defs.pous[pou].kind == PouKind::FunctionBlock => {
                            format!("declare an instance of it: `inst : {};`", name.text)
                        }
                        Found::Pou(pou) if self.cx.defs.pous[pou].kind == PouKind::Program => {
                            "programs share variables as VAR_GLOBAL; a FUNCTION_BLOCK shows its outputs".into()
                        }
                        // It was meant as the result.
                        Found::Pou(pou) if self.scope == Some(pou) => {
                            format!("declare the type of the result: `FUNCTION {} : INT`", name.text)
                        }
                        Found::Pou(_) => format!("call it: `{}(...)`", name.text),
                        Found::Action(_) => format!("call it: `{}();`", name.text),
                        Found::Type => format!("declare a variable of it: `x : {};`", name.text),
                        _ => "a variable is needed here".into(),
                    }),
                );
                None
            }
        }
    }

    /// Globals are visible without VAR_EXTERNAL; in strict a hint says so once per POU (\[S7\]).
    fn note_global(&mut self, var: VarId, name: &ast::Name) {
        let Some(scope) = self.scope else { return };
        if self.codesys(name.span) || self.cx.pou_slots[scope].scope.contains_key(&fold(&name.text)) {
            return;
        }
        if self.cx.first_report(self.scope, &format!("external {}", fold(&name.text))) {
            let span = self.cx.defs.vars[var].span;
            self.report(
                Diagnostic::new(
                    codes::GLOBAL_WITHOUT_EXTERNAL,
                    name.span,
                    format!("global `{}` is used without VAR_EXTERNAL", name.text),
                )
                .also(span, "declared here")
                .help("declare it in a VAR_EXTERNAL section of this POU"),
            );
        }
    }

    fn member(&mut self, mut base: Place, name: &ast::Name, span: Span) -> Option<Place> {
        match self.cx.defs.types.get(base.ty).clone() {
            Type::Error => None,
            Type::Struct(id) => {
                let found = self.cx.component(base.ty, &name.text);
                let def = &self.cx.defs.structs[id];
                let Some(index) = found else {
                    let hint = similar(&name.text, def.fields.iter().map(|f| f.name.as_str()));
                    let d = Diagnostic::new(
                        codes::UNKNOWN_MEMBER,
                        name.span,
                        format!("`{}` has no component `{}`", def.name, name.text),
                    )
                    .also(def.span, "declared here")
                    .help(match hint {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => format!(
                            "its components are {}",
                            list(def.fields.iter().map(|f| f.name.as_str()).filter(|n| !n.starts_with('$')))
                        ),
                    });
                    self.report(d);
                    return None;
                };
                base.ty = def.fields[index].ty;
                base.steps.push(Step::Field(index as u32));
                base.span = span;
                (base.ty != Types::ERROR).then_some(base)
            }
            Type::Instance(pou) => {
                let key = self.pin_name(pou, name);
                let found = self.cx.pou_slots[pou].scope.get(&key).copied();
                let Some(Local::Var(var)) = found else {
                    let names = self.cx.defs.pous[pou].vars.iter().map(|v| &self.cx.defs.vars[*v]);
                    let names = names.filter(|v| matches!(v.section, Section::Input | Section::Output));
                    let names = names.map(|v| v.name.as_str());
                    let help = match similar(&name.text, names.clone()) {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => format!("its inputs and outputs are {}", list(names)),
                    };
                    let def = &self.cx.defs.pous[pou];
                    let mut d = Diagnostic::new(
                        codes::UNKNOWN_MEMBER,
                        name.span,
                        format!("`{}` has no input or output `{}`", def.name, name.text),
                    )
                    .help(help);
                    if !def.builtin {
                        d = d.also(def.span, "declared here");
                    }
                    self.report(d);
                    return None;
                };
                self.cx.var_type(var);
                if self.cx.defs.vars[var].section == Section::InOut && !self.in_out_from_outside(pou, var, name) {
                    return None;
                }
                let v = &self.cx.defs.vars[var];
                if !matches!(v.section, Section::Input | Section::Output | Section::InOut) {
                    let mut d = Diagnostic::new(
                        codes::INNER_VARIABLE,
                        name.span,
                        format!("`{}` is an inner variable of `{}`", v.name, self.cx.defs.pous[pou].name),
                    )
                    .help(match charts::is_step(self.cx, var) {
                        true => "steps are visible inside of their POU only; copy what you need to a VAR_OUTPUT there",
                        false => {
                            "from outside only inputs and outputs of an instance are visible; make it a VAR_OUTPUT"
                        }
                    });
                    if !self.cx.defs.pous[pou].builtin {
                        d = d.also(v.span, "declared here");
                    }
                    self.report(d);
                    return None;
                }
                base.ty = v.ty;
                base.steps.push(Step::Member(var));
                base.span = span;
                (base.ty != Types::ERROR).then_some(base)
            }
            Type::Ref { .. } => {
                let text = "a reference has no components";
                self.report(
                    Diagnostic::new(codes::UNKNOWN_MEMBER, name.span, text)
                        .help(format!("follow it: `^.{}`", name.text)),
                );
                None
            }
            _ => {
                let ty = self.cx.type_name(base.ty);
                let help = match self.cx.defs.types.get(base.ty) {
                    Type::Array { .. } | Type::AnyArray { .. } => {
                        format!("an element has components: `{}[...].{}`", self.place_text(&base), name.text)
                    }
                    Type::Enum(id) => {
                        let values = self.cx.defs.enums[*id].values.iter().map(|(n, _, _)| n.as_str());
                        match similar(&name.text, values.clone()) {
                            Some(near) => format!("did you mean `{near}`?"),
                            None => format!("its values are {}", list(values)),
                        }
                    }
                    _ => "structures, unions and instances of function blocks have components".into(),
                };
                self.report(
                    Diagnostic::new(codes::UNKNOWN_MEMBER, name.span, format!("{ty} has no component `{}`", name.text))
                        .also(base.span, format!("this is {ty}"))
                        .help(help),
                );
                None
            }
        }
    }

    /// The folded name of a parameter. The bistables also take the pins of textbooks, `S`, `R` and `Q`, with a note
    /// (semantics.md \[B1\]).
    pub fn pin_name(&mut self, pou: PouId, name: &ast::Name) -> SmolStr {
        let key = fold(&name.text);
        let def = &self.cx.defs.pous[pou];
        if !def.builtin {
            return key;
        }
        let standard = match (def.name.as_str(), key.as_str()) {
            ("SR", "S") => "S1",
            ("RS", "R") => "R1",
            ("SR" | "RS", "Q") => "Q1",
            _ => return key,
        };
        let message = format!("the standard calls this pin of {} `{standard}`", def.name);
        self.report(Diagnostic::new(codes::TEXTBOOK_PIN, name.span, message).help(format!("write `{standard}`")));
        standard.into()
    }

    fn index(&mut self, mut base: Place, indices: &'a [ast::Expr], span: Span) -> Option<Place> {
        let (dims, elem) = match self.cx.defs.types.get(base.ty).clone() {
            Type::Array { dims, elem } => (dims, elem),
            Type::AnyArray { dims, elem } if dims == indices.len() => {
                return self.open_index(base, elem, indices, span);
            }
            Type::AnyArray { dims, elem } => (vec![(i64::MIN, i64::MAX); dims], elem),
            Type::String { .. } | Type::AnyString { .. } => return self.character(base, indices, span),
            Type::Error => return None,
            _ => {
                let ty = self.cx.type_name(base.ty);
                self.report(
                    Diagnostic::new(codes::NOT_AN_ARRAY, span, format!("{ty} cannot be indexed"))
                        .help("only arrays have elements"),
                );
                return None;
            }
        };
        if indices.len() != dims.len() {
            let ty = self.cx.type_name(base.ty);
            let message = format!("{} subscripts for {} dimensions", indices.len(), dims.len());
            self.report(
                Diagnostic::new(codes::WRONG_SUBSCRIPTS, span, message)
                    .also(base.span, format!("this is {ty}"))
                    .help("write one subscript per dimension, separated by commas in one pair of brackets: `a[1, 2]`"),
            );
            return None;
        }
        let mut list = Vec::new();
        for (e, (low, high)) in indices.iter().zip(&dims) {
            let index = self.subscript(e)?;
            if let ExprKind::Const(raw) = index.kind {
                let v = raw as i64;
                if v < *low || v > *high {
                    let message = format!("index {v} is outside the bounds {low}..{high}");
                    self.report(
                        Diagnostic::new(codes::CONSTANT_INDEX, e.span, message)
                            .also(base.span, "of this array")
                            .help("use an index inside the bounds"),
                    );
                    return None;
                }
            }
            list.push(index);
        }
        let name = self.place_text(&base);
        base.steps.push(Step::Index(list, name));
        base.ty = elem;
        base.span = span;
        (elem != Types::ERROR).then_some(base)
    }

    /// `fb.x` of a VAR_IN_OUT: the variable that the last call connected. Outside of a call it stands for nothing in the
    /// standard; existing libraries read it, so profile codesys follows it (NULL before the first call).
    fn in_out_from_outside(&mut self, pou: PouId, var: VarId, name: &ast::Name) -> bool {
        let (declared, block) = (self.cx.defs.vars[var].span, self.cx.defs.pous[pou].name.clone());
        let strict = Diagnostic::new(
            codes::INNER_VARIABLE,
            name.span,
            format!("`{}` is a VAR_IN_OUT of `{block}`, it exists only during a call", name.text),
        )
        .also(declared, "declared here")
        .help("use the variable that the call connected");
        if !self.codesys_only(name.span, codes::LAX_CONVERSION, strict) {
            return false;
        }
        // What was connected stays reachable: it lies where references may point.
        self.cx.defs.vars[var].address_taken = true;
        true
    }

    /// A subscript as LINT.
    pub fn subscript(&mut self, e: &'a ast::Expr) -> Option<Expr> {
        let index = match self.operand(e, None) {
            operand @ Operand::Int(_) => self.coerce(operand, e.span, Types::elem(Elem::Lint)),
            Operand::Error => return None,
            operand => self.index_value(operand, e.span)?,
        };
        (index.ty != Types::ERROR).then_some(index)
    }

    /// An index as LINT: integers, enumerations' numbers, bit strings by value (warning in strict).
    pub fn index_value(&mut self, operand: Operand, span: Span) -> Option<Expr> {
        let ty = self.static_type(&operand).unwrap_or(Types::elem(Elem::Lreal));
        let expr = self.settle(operand, span);
        match self.elem_of(ty) {
            Some(elem) if elem.is_integer() => {
                // Beyond LINT an index is far outside any bounds: it must not come back as a small number.
                if elem == Elem::Ulint {
                    let limit = Expr { kind: ExprKind::Const(i64::MAX as u64), ty: Types::elem(elem), span };
                    let args = vec![retype(expr, Types::elem(elem)), limit];
                    let low =
                        Expr { kind: ExprKind::Op(plcc_stdlib::ops::Op::Min, elem, args), ty: Types::elem(elem), span };
                    return Some(self.with_elem(low, Elem::Lint, span));
                }
                Some(self.with_elem(expr, Elem::Lint, span))
            }
            Some(elem) if elem.is_bits() => {
                if !self.codesys(span) {
                    self.report(
                        Diagnostic::new(codes::BITS_AS_NUMBER, span, format!("{} is used as an index", elem.name()))
                            .help(format!(
                                "it counts by its value; write {}(...) to say so",
                                crate::rules::conversion_name(elem, crate::rules::as_number(elem))
                            )),
                    );
                }
                let number = crate::rules::as_number(elem);
                let expr = self.with_elem(expr, number, span);
                Some(self.with_elem(expr, Elem::Lint, span))
            }
            _ if ty == Types::ERROR => None,
            _ => {
                let name = self.cx.type_name(ty);
                self.report(
                    Diagnostic::new(codes::TYPE_MISMATCH, span, format!("an index is an integer, this is {name}"))
                        .help("use a variable of type INT or DINT"),
                );
                None
            }
        }
    }

    fn part(&mut self, mut base: Place, part: &ast::Name, span: Span) -> Option<Place> {
        if base.ty == Types::ERROR {
            return None;
        }
        let elem = self.elem_of(base.ty);
        let bits = match elem {
            Some(e) if e.is_bits() => e.bits(),
            Some(e) if e.is_integer() && self.codesys(span) => e.bits(),
            _ => {
                let ty = self.cx.type_name(base.ty);
                let mut d = Diagnostic::new(codes::NO_PARTS, span, format!("{ty} has no bits to access"))
                    .also(base.span, format!("this is {ty}"));
                if elem.is_some_and(Elem::is_integer) {
                    self.cx.codesys_only += 1;
                    d = d.help("only BYTE, WORD, DWORD and LWORD have; convert the integer first");
                } else {
                    d = d.help("only BYTE, WORD, DWORD and LWORD have");
                }
                self.report(d);
                return None;
            }
        };
        let text = part.text.to_ascii_uppercase();
        let (letter, digits) = match text.strip_prefix('%') {
            Some(rest) => rest.split_at(usize::from(rest.starts_with(|c: char| c.is_ascii_alphabetic()))),
            None => ("X", text.as_str()),
        };
        let width = match letter {
            "X" | "" => 1,
            "B" => 8,
            "W" => 16,
            "D" => 32,
            _ => 64,
        };
        let number: u32 = digits.parse().unwrap_or(u32::MAX);
        let count = bits / width;
        if number >= count || (width > 1 && width >= bits) {
            let help = match width {
                _ if width >= bits && width > 1 => "it is not wider than this part".to_string(),
                1 => format!("its bits are 0 to {}", bits - 1),
                _ => format!("its parts of this size are 0 to {}", count - 1),
            };
            let ty = self.cx.type_name(base.ty);
            self.report(
                Diagnostic::new(codes::NO_PARTS, part.span, format!("{ty} has no part `{}`", part.text)).help(help),
            );
            return None;
        }
        let elem = match width {
            1 => Elem::Bool,
            8 => Elem::Byte,
            16 => Elem::Word,
            _ => Elem::Dword,
        };
        base.steps.push(if width == 1 { Step::Bit(number as u8) } else { Step::Part(elem, number as u8) });
        base.ty = Types::elem(elem);
        base.span = span;
        Some(base)
    }

    fn deref(&mut self, mut base: Place, span: Span) -> Option<Place> {
        let Type::Ref { kind, target } = *self.cx.defs.types.get(base.ty) else {
            let ty = self.cx.type_name(base.ty);
            self.report(
                Diagnostic::new(codes::NOT_A_REFERENCE, span, format!("{ty} cannot be followed with ^"))
                    .help("only REF_TO and POINTER TO can"),
            );
            return None;
        };
        if kind == RefKind::ReferenceTo {
            self.report(
                Diagnostic::new(codes::NOT_A_REFERENCE, span, "a REFERENCE TO is not followed with ^")
                    .help("remove the ^: its name is the variable that it refers to"),
            );
            return None;
        }
        if target == Types::ERROR {
            return None;
        }
        base.steps.push(Step::Deref);
        base.ty = target;
        base.span = span;
        Some(base)
    }

    /// `f(x)^`, `(p + 4)^`: follows a reference that an expression gives.
    fn deref_value(&mut self, base: &'a ast::Expr, span: Span) -> Option<Place> {
        let value = self.any_value(base);
        match *self.cx.defs.types.get(value.ty) {
            Type::Ref { target, .. } if target != Types::ERROR => {
                Some(Place { root: Root::Deref(Box::new(value)), steps: Vec::new(), ty: target, span })
            }
            Type::Ref { .. } | Type::Error => None,
            _ => {
                let ty = self.cx.type_name(value.ty);
                self.report(
                    Diagnostic::new(codes::NOT_A_REFERENCE, span, format!("{ty} cannot be followed with ^"))
                        .help("only REF_TO and POINTER TO can"),
                );
                None
            }
        }
    }

    /// `%MW4` used directly: the bit-string type of its size (\[R4\]).
    fn direct_address(&mut self, text: &str, span: Span) -> Option<Place> {
        match crate::address::parse(text) {
            Ok(address) => {
                let elem = match crate::address::width(text) {
                    1 => Elem::Byte,
                    2 => Elem::Word,
                    4 => Elem::Dword,
                    8 => Elem::Lword,
                    _ => Elem::Bool,
                };
                Some(Place { root: Root::Address(address), steps: Vec::new(), ty: Types::elem(elem), span })
            }
            Err(message) => {
                self.report(
                    Diagnostic::new(codes::BAD_ADDRESS, span, format!("`{text}`: {message}"))
                        .help("write %I, %Q or %M, a size X B W D L, and a number: %IX0.0, %QW4, %MD8"),
                );
                None
            }
        }
    }

    /// A place as a user would write it, for messages at run time.
    pub fn place_text(&self, place: &Place) -> String {
        let mut text = match &place.root {
            Root::Var(var) => self.cx.defs.vars[*var].name.to_string(),
            _ => String::new(),
        };
        let mut ty = match &place.root {
            Root::Var(var) => self.cx.defs.vars[*var].ty,
            _ => return text,
        };
        for step in &place.steps {
            match step {
                Step::Field(index) => {
                    let Type::Struct(id) = self.cx.defs.types.get(ty) else { return text };
                    let field = &self.cx.defs.structs[*id].fields[*index as usize];
                    text = format!("{text}.{}", field.name);
                    ty = field.ty;
                }
                Step::Member(var) => {
                    text = format!("{text}.{}", self.cx.defs.vars[*var].name);
                    ty = self.cx.defs.vars[*var].ty;
                }
                Step::Index(..) | Step::OpenIndex(..) => {
                    text.push_str("[...]");
                    match self.cx.defs.types.get(ty) {
                        Type::Array { elem, .. } | Type::AnyArray { elem, .. } => ty = *elem,
                        _ => return text,
                    }
                }
                Step::Character { .. } => text.push_str("[...]"),
                Step::Deref => match self.cx.defs.types.get(ty) {
                    Type::Ref { kind, target } => {
                        if *kind != RefKind::ReferenceTo {
                            text.push('^');
                        }
                        ty = *target;
                    }
                    _ => return text,
                },
                Step::Bit(n) => text = format!("{text}.{n}"),
                Step::Part(elem, n) => text = format!("{text}.%{}{n}", &elem.name()[..1]),
                Step::Flags(_) => text.push_str(".."),
            }
        }
        text
    }

    /// The variable of a plain name, for FOR.
    pub fn plain_var(&self, place: &Place) -> Option<VarId> {
        match (&place.root, place.steps.is_empty()) {
            (Root::Var(var), true) => Some(*var),
            _ => None,
        }
    }

    /// The declared type of a variable, its slot resolved.
    pub fn type_of_var(&mut self, var: VarId) -> TypeId {
        self.cx.var_type(var);
        self.cx.defs.vars[var].ty
    }
}

/// Whether an expression names a place, not a value.
fn is_place(e: &ast::Expr) -> bool {
    use ast::ExprKind::*;
    matches!(e.kind, Name(_) | Member(..) | Index(..) | Part(..) | Deref(_) | Address(_) | Error)
}

/// Names as a message lists them: the first dozen.
fn list<'n>(names: impl Iterator<Item = &'n str> + Clone) -> String {
    let more = if names.clone().nth(12).is_some() { ", ..." } else { "" };
    let first: Vec<&str> = names.take(12).collect();
    if first.is_empty() { "none".into() } else { format!("{}{more}", first.join(", ")) }
}
