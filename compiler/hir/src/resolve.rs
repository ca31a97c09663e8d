//! Types as written to types as known, on demand and in any order. A type that contains itself is reported here (by value)
//! or by `cycles` (through function blocks).

use crate::cx::*;
use crate::defs::*;
use crate::expr::Checker;
use crate::init::Init;
use crate::initial_references::Home;
use crate::types::{RefKind, Type, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::Elem;
use plcc_syntax::ast;
use rustc_hash::FxHashMap;

/// Capacity of a STRING without length (semantics.md \[T8\]).
pub const DEFAULT_STRING: u32 = 80;
/// No string has more characters.
pub const LONGEST_STRING: u32 = 1 << 20;

/// More elements than any region could hold.
const MAX_ELEMENTS: i128 = 1 << 31;

impl<'a> Cx<'a> {
    /// A type as written; `name` names an anonymous structure or enumeration in messages.
    pub fn resolve_type(&mut self, te: &'a ast::TypeExpr, scope: Option<PouId>, name: &str) -> Resolved {
        let key: *const ast::TypeExpr = te;
        if let Some(done) = self.type_cache.get(&key) {
            return done.clone();
        }
        let resolved = self.resolve_new(te, scope, name, None);
        self.type_cache.insert(key, resolved.clone());
        resolved
    }

    fn resolve_new(
        &mut self,
        te: &'a ast::TypeExpr,
        scope: Option<PouId>,
        name: &str,
        slot: Option<usize>,
    ) -> Resolved {
        let plain = |ty| Resolved { ty, init: Init::Default };
        match &te.kind {
            ast::TypeExprKind::Named(name) => self.resolve_named(name, false),
            ast::TypeExprKind::String { wide, length } => {
                let capacity = match length {
                    None => i128::from(DEFAULT_STRING),
                    Some(length) => self.const_integer(length, scope).unwrap_or(i128::from(DEFAULT_STRING)),
                };
                if !(1..=i128::from(LONGEST_STRING)).contains(&capacity) {
                    self.push(
                        Diagnostic::new(
                            codes::BAD_BOUNDS,
                            te.span,
                            format!("a string of {capacity} characters cannot be declared"),
                        )
                        .help("the length of a STRING is 1 to 1048576"),
                    );
                    return Resolved::error();
                }
                plain(self.defs.types.intern(Type::String { wide: *wide, capacity: capacity as u32 }))
            }
            ast::TypeExprKind::Array { dims, elem } => self.resolve_array(te, dims, elem, scope, name),
            ast::TypeExprKind::Struct(fields) => self.resolve_struct(te, fields, false, scope, name, slot),
            ast::TypeExprKind::Union(fields) => self.resolve_struct(te, fields, true, scope, name, slot),
            ast::TypeExprKind::Enum { base, values } => self.resolve_enum(te, base.as_ref(), values, scope, name),
            ast::TypeExprKind::Subrange { base, low, high } => self.resolve_subrange(te, base, low, high, scope),
            ast::TypeExprKind::Ref { kind, target } => {
                let target = match &target.kind {
                    ast::TypeExprKind::Named(name) => self.resolve_named(name, true).ty,
                    _ => self.resolve_type(target, scope, name).ty,
                };
                if *kind == RefKind::ReferenceTo && !self.codesys(te.span) {
                    self.codesys_only += 1;
                    self.push(
                        Diagnostic::new(codes::REFERENCE_TO, te.span, "REFERENCE TO is a form of CODESYS")
                            .help("the standard's form is REF_TO: `r := REF(x);` binds it, `r^` is the variable there"),
                    );
                    return Resolved::error();
                }
                self.reject_reference(target, te.span, "nothing refers to a REFERENCE TO itself");
                plain(self.defs.types.intern(Type::Ref { kind: *kind, target }))
            }
            // The check of the body gives it the type of its value.
            ast::TypeExprKind::Inferred(_) | ast::TypeExprKind::Error => Resolved::error(),
        }
    }

    /// What is followed wherever it is named has no place of its own: no type is made of it.
    fn reject_reference(&mut self, part: TypeId, span: Span, message: &str) {
        if let Type::Ref { kind: RefKind::ReferenceTo, .. } = self.defs.types.get(part) {
            let help = "use REF_TO or POINTER TO, and follow it with ^";
            self.push(Diagnostic::new(codes::BAD_BASE_TYPE, span, message).help(help));
        }
    }

    /// A type by its name; behind a reference an unfinished structure is fine.
    fn resolve_named(&mut self, name: &ast::Name, behind_reference: bool) -> Resolved {
        let plain = |ty| Resolved { ty, init: Init::Default };
        let key = fold(&name.text);
        if self.builtin_files.contains(&name.span.file) {
            if let Some(&pou) = self.pous.get(&crate::collect::internal_name(&key)) {
                return plain(self.defs.types.intern(Type::Instance(pou)));
            }
            if let Some(elem) = Elem::from_name(&key) {
                return plain(Types::elem(elem));
            }
        }
        if let Some(&slot) = self.types.get(&key) {
            return self.resolve_slot(slot, name.span, behind_reference);
        }
        if let Some(&pou) = self.pous.get(&key) {
            if self.defs.pous[pou].kind == PouKind::FunctionBlock {
                return plain(self.defs.types.intern(Type::Instance(pou)));
            }
            // A function is no type: `TIME` stays one even if somebody wrote his own TIME().
            if let Some(elem) = Elem::from_name(&key) {
                return plain(Types::elem(elem));
            }
            let span = self.defs.pous[pou].span;
            self.push(
                Diagnostic::new(codes::UNKNOWN_TYPE, name.span, format!("`{}` is not a type", name.text))
                    .also(span, "it is a POU without instances of its own")
                    .help("only a FUNCTION_BLOCK can be instantiated as a variable"),
            );
            return Resolved::error();
        }
        if let Some(elem) = Elem::from_name(&key) {
            return plain(Types::elem(elem));
        }
        let standard = plcc_stdlib::elem::ALL.iter().map(|e| e.name()).chain(["STRING", "WSTRING"]);
        let pous = self.pous.values().map(|p| &self.defs.pous[*p]).filter(|p| p.kind == PouKind::FunctionBlock);
        let types = self.type_slots.iter().map(|t| t.decl.name.text.as_str());
        let names = types.chain(pous.map(|p| p.name.as_str())).chain(standard);
        let hint = iec_name(&key).map(str::to_string).or_else(|| similar(&name.text, names));
        self.push(Diagnostic::new(codes::UNKNOWN_TYPE, name.span, format!("there is no type `{}`", name.text)).help(
            match hint {
                Some(near) => format!("did you mean `{near}`?"),
                None => "declare it in a TYPE block, or as a FUNCTION_BLOCK".into(),
            },
        ));
        Resolved::error()
    }

    /// The type of a name, without a message if there is none.
    pub fn type_named(&mut self, name: &ast::Name) -> Option<TypeId> {
        let key = fold(&name.text);
        let known = self.types.contains_key(&key) || self.pous.contains_key(&key) || Elem::from_name(&key).is_some();
        known.then(|| self.resolve_named(name, false).ty)
    }

    /// The type that a TYPE declaration makes.
    pub fn resolve_slot(&mut self, slot: usize, at: Span, behind_reference: bool) -> Resolved {
        match &self.type_slots[slot].state {
            State::Done(resolved) => return resolved.clone(),
            State::Todo => {}
            State::Busy => {
                if let (true, Some(ty)) = (behind_reference, self.type_slots[slot].early) {
                    return Resolved { ty, init: Init::Default };
                }
                let name = self.type_slots[slot].decl.name.clone();
                self.push(
                    Diagnostic::new(codes::CYCLIC_TYPE, at, format!("type `{}` contains itself", name.text))
                        .also(name.span, "declared here")
                        .help("break the cycle with REF_TO"),
                );
                return Resolved::error();
            }
        }
        self.type_slots[slot].state = State::Busy;
        let decl = self.type_slots[slot].decl;
        let mut resolved = self.resolve_new(&decl.ty, None, &decl.name.text, Some(slot));
        if let Some(init) = &decl.init {
            resolved.init = self.initial(init, resolved.ty, Home::Outside(None));
        }
        // A cycle that was found below has reported itself; the type stays usable.
        self.type_slots[slot].state = State::Done(resolved.clone());
        resolved
    }

    fn resolve_array(
        &mut self,
        te: &'a ast::TypeExpr,
        dims: &'a [ast::Dim],
        elem: &'a ast::TypeExpr,
        scope: Option<PouId>,
        name: &str,
    ) -> Resolved {
        let elem_span = elem.span;
        let elem = self.resolve_type(elem, scope, name);
        self.reject_reference(elem.ty, elem_span, "an array cannot hold REFERENCE TOs");
        if dims.iter().any(|d| matches!(d, ast::Dim::Any(_))) {
            let ty = self.defs.types.intern(Type::AnyArray { dims: dims.len(), elem: elem.ty });
            return Resolved { ty, init: Init::Default };
        }
        let mut bounds = Vec::new();
        let mut count: i128 = 1;
        for dim in dims {
            let ast::Dim::Range(low, high) = dim else { continue };
            let (Some(l), Some(h)) = (self.const_integer(low, scope), self.const_integer(high, scope)) else {
                return Resolved::error();
            };
            let fits = |v: i128| i64::try_from(v).is_ok();
            if l > h || !fits(l) || !fits(h) {
                self.push(
                    Diagnostic::new(
                        codes::BAD_BOUNDS,
                        low.span.to(high.span),
                        format!("the bounds {l}..{h} make no array"),
                    )
                    .help("the lower bound comes first and is not above the upper one"),
                );
                return Resolved::error();
            }
            count = count.saturating_mul(h - l + 1);
            bounds.push((l as i64, h as i64));
        }
        if count > MAX_ELEMENTS {
            self.push(
                Diagnostic::new(codes::BAD_BOUNDS, te.span, format!("an array of {count} elements is too large"))
                    .help("a resource's memory holds less than 2^31 bytes"),
            );
            return Resolved::error();
        }
        let init = match elem.init {
            Init::Default => Init::Default,
            init => Init::Array(vec![(count as u32, init)]),
        };
        let ty = if elem.ty == Types::ERROR {
            Types::ERROR
        } else {
            self.defs.types.intern(Type::Array { dims: bounds, elem: elem.ty })
        };
        Resolved { ty, init }
    }

    fn resolve_struct(
        &mut self,
        te: &'a ast::TypeExpr,
        decls: &'a [ast::VarDecl],
        union: bool,
        scope: Option<PouId>,
        name: &str,
        slot: Option<usize>,
    ) -> Resolved {
        let id = self.defs.structs.push(StructDef {
            name: name.into(),
            union,
            fields: Vec::new(),
            flag: None,
            span: te.span,
        });
        let ty = self.defs.types.intern(Type::Struct(id));
        if let Some(slot) = slot {
            self.type_slots[slot].early = Some(ty);
        }
        let mut fields: Vec<Field> = Vec::new();
        let mut seen: FxHashMap<_, Span> = FxHashMap::default();
        for decl in decls {
            for field in &decl.names {
                // One that lacks its name is reported, and cannot be named.
                if field.text.is_empty() {
                    continue;
                }
                if let Some(first) = seen.insert(fold(&field.text), field.span) {
                    self.push(
                        Diagnostic::new(
                            codes::DUPLICATE_NAME,
                            field.span,
                            format!("component `{}` is declared twice", field.text),
                        )
                        .also(first, "first declared here")
                        .help("remove or rename one of them; names do not differ by case"),
                    );
                    continue;
                }
                let resolved = self.resolve_type(&decl.ty, scope, &format!("{name}.{}", field.text));
                let init = match &decl.init {
                    Some(init) => self.initial(init, resolved.ty, Home::Outside(scope)),
                    None => resolved.init,
                };
                fields.push(Field { name: field.text.clone(), ty: resolved.ty, init, span: field.span });
            }
        }
        let unnamed = || decls.iter().any(|d| d.names.iter().any(|n| n.text.is_empty()));
        if fields.is_empty() && !unnamed() {
            self.push(
                Diagnostic::new(codes::EMPTY_TYPE, te.span, "a structure without components")
                    .help("declare at least one component"),
            );
        }
        self.defs.structs[id].fields = fields;
        Resolved { ty, init: Init::Default }
    }

    fn resolve_enum(
        &mut self,
        te: &'a ast::TypeExpr,
        base: Option<&'a ast::Name>,
        values: &'a [ast::EnumValue],
        scope: Option<PouId>,
        name: &str,
    ) -> Resolved {
        let base = match base {
            None => Elem::Int,
            Some(base) => match Elem::from_name(&base.text) {
                Some(elem) if elem.is_integer() || elem.is_bits() => elem,
                None if self.pous.contains_key(&fold(&base.text)) || self.types.contains_key(&fold(&base.text)) => {
                    let text = &base.text;
                    self.push(
                        Diagnostic::new(codes::BAD_INITIALISER, te.span, format!("`{text}` takes no values here"))
                            .help(format!("initial values stand behind `:=`: `x : {text} := (a := 1)`")),
                    );
                    return Resolved::error();
                }
                _ => {
                    self.push(
                        Diagnostic::new(
                            codes::BAD_BASE_TYPE,
                            base.span,
                            format!("`{}` cannot be the base of an enumeration", base.text),
                        )
                        .help("take an integer or bit-string type, such as INT or WORD"),
                    );
                    Elem::Int
                }
            },
        };
        let id =
            self.defs.enums.push(EnumDef { name: name.into(), base, values: Vec::new(), default: 0, span: te.span });
        let (low, high) = base.range().unwrap_or((0, 0));
        let mut next: i128 = 0;
        let mut seen: FxHashMap<_, (i128, Span)> = FxHashMap::default();
        for value in values {
            if let Some(written) = &value.value {
                // A later value may be written by an earlier one.
                let own = match &written.kind {
                    ast::ExprKind::Name(name) => seen.get(&fold(&name.text)),
                    _ => None,
                };
                match own {
                    Some((number, _)) => next = *number,
                    None => next = self.const_integer(written, scope).unwrap_or(next),
                }
            }
            let key = fold(&value.name.text);
            if let Some(&(_, first)) = seen.get(&key) {
                self.push(
                    Diagnostic::new(
                        codes::DUPLICATE_NAME,
                        value.name.span,
                        format!("value `{}` is declared twice", value.name.text),
                    )
                    .also(first, "first declared here")
                    .help("remove or rename one of them; names do not differ by case"),
                );
                continue;
            }
            if !(low..=high).contains(&next) {
                self.push(
                    Diagnostic::new(
                        codes::OUT_OF_RANGE,
                        value.name.span,
                        format!("value {next} of `{}` does not fit {}", value.name.text, base.name()),
                    )
                    .help(format!("{} holds {low} to {high}", base.name())),
                );
                next = low;
            }
            self.defs.enums[id].values.push((value.name.text.clone(), next, value.name.span));
            seen.insert(key.clone(), (next, value.name.span));
            self.enum_values.entry(key).or_default().push((id, next));
            next += 1;
        }
        if let Some((_, first, _)) = self.defs.enums[id].values.first() {
            self.defs.enums[id].default = *first;
        }
        Resolved { ty: self.defs.types.intern(Type::Enum(id)), init: Init::Default }
    }

    fn resolve_subrange(
        &mut self,
        te: &'a ast::TypeExpr,
        base: &'a ast::Name,
        low: &'a ast::Expr,
        high: &'a ast::Expr,
        scope: Option<PouId>,
    ) -> Resolved {
        let Some(elem) = Elem::from_name(&base.text).filter(|e| e.is_integer() || e.is_bits()) else {
            self.push(
                Diagnostic::new(
                    codes::BAD_BASE_TYPE,
                    base.span,
                    format!("`{}` cannot be the base of a subrange", base.text),
                )
                .help("take an integer type, such as INT"),
            );
            return Resolved::error();
        };
        let (Some(l), Some(h)) = (self.const_integer(low, scope), self.const_integer(high, scope)) else {
            return Resolved::error();
        };
        let (min, max) = elem.range().unwrap_or((0, 0));
        if l > h || l < min || h > max {
            self.push(
                Diagnostic::new(codes::BAD_BOUNDS, te.span, format!("{l}..{h} is no subrange of {}", elem.name()))
                    .help(format!("{} holds {min} to {max}, the lower limit comes first", elem.name())),
            );
            return Resolved::error();
        }
        Resolved { ty: self.defs.types.intern(Type::Subrange { base: elem, low: l, high: h }), init: Init::Default }
    }

    /// Resolves the type of a variable, if that has not happened yet.
    pub fn var_type(&mut self, var: VarId) {
        match self.var_slots[var].ty {
            State::Done(_) => return,
            State::Busy => {
                let (name, span) = (self.defs.vars[var].name.clone(), self.defs.vars[var].span);
                self.push(
                    Diagnostic::new(codes::CYCLIC_VALUE, span, format!("the type of `{name}` depends on itself"))
                        .help("write the bounds as numbers or other constants"),
                );
                return;
            }
            State::Todo => {}
        }
        self.var_slots[var].ty = State::Busy;
        let mut init = Init::Default;
        if let Some((te, _)) = self.var_slots[var].decl {
            let (owner, name, section) =
                (self.defs.vars[var].owner, self.defs.vars[var].name.clone(), self.defs.vars[var].section);
            let mut resolved = self.resolve_type(te, owner, &name);
            // `STRING` without length as VAR_IN_OUT takes any capacity (semantics.md [S4]).
            if let (Section::InOut, ast::TypeExprKind::String { wide, length: None }) = (section, &te.kind) {
                resolved.ty = self.defs.types.intern(Type::AnyString { wide: *wide });
            }
            match *self.defs.types.get(resolved.ty) {
                Type::AnyArray { dims, .. } if section == Section::InOut => self.declare_bounds(var, dims),
                Type::AnyArray { .. } => {
                    self.push(
                        Diagnostic::new(codes::BAD_BOUNDS, te.span, "only a VAR_IN_OUT may be an ARRAY [*]")
                            .help("write the bounds, or pass the array as VAR_IN_OUT"),
                    );
                    resolved = Resolved::error();
                }
                _ => {}
            }
            self.defs.vars[var].ty = resolved.ty;
            init = resolved.init;
        }
        self.var_slots[var].ty = State::Done(init);
    }

    /// The value of a constant integer expression; a message and `None` if it is none.
    pub fn const_integer(&mut self, e: &'a ast::Expr, scope: Option<PouId>) -> Option<i128> {
        Checker::constant(self, scope).const_integer(e)
    }

    /// Types of all variables, and every TYPE declaration even if nothing uses it.
    pub fn resolve_all(&mut self) {
        for slot in 0..self.type_slots.len() {
            let span = self.type_slots[slot].decl.name.span;
            self.resolve_slot(slot, span, false);
        }
        for var in self.defs.vars.indices() {
            self.var_type(var);
        }
    }

    /// The name of a type whose declaration is `ty`, if it was given one.
    pub fn instance_of(&self, ty: TypeId) -> Option<PouId> {
        match self.defs.types.get(ty) {
            Type::Instance(pou) => Some(*pou),
            _ => None,
        }
    }
}

/// What a type of another language, in upper case, is called in IEC 61131-3.
fn iec_name(foreign: &str) -> Option<&'static str> {
    Some(match foreign {
        "BOOLEAN" => "BOOL",
        "INT8" | "INT8_T" => "SINT",
        "INTEGER" | "SHORT" | "INT16" | "INT16_T" => "INT",
        "LONG" | "INT32" | "INT32_T" => "DINT",
        "INT64" | "INT64_T" => "LINT",
        "UINT8" | "UINT8_T" => "USINT",
        "UINT16" | "UINT16_T" => "UINT",
        "UINT32" | "UINT32_T" => "UDINT",
        "UINT64" | "UINT64_T" => "ULINT",
        "FLOAT" | "SINGLE" | "FLOAT32" => "REAL",
        "DOUBLE" | "FLOAT64" => "LREAL",
        "DATETIME" => "DT",
        "TEXT" => "STRING",
        _ => return None,
    })
}
