//! Initial values: initialisers as written, evaluated against their type (semantics.md \[T9\] \[S8\]).

use crate::cx::*;
use crate::defs::*;
use crate::expr::Checker;
use crate::init::Init;
use crate::initial_references::Home;
use crate::types::{Type, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_syntax::ast;
use rustc_hash::FxHashMap;

impl<'a> Cx<'a> {
    /// Evaluates the initial value of a variable, if that has not happened yet. Others may be read while doing so; a cycle is
    /// an error.
    pub fn var_init(&mut self, var: VarId) {
        self.var_type(var);
        match self.var_slots[var].init {
            State::Done(()) => return,
            State::Busy => {
                let (name, span) = (self.defs.vars[var].name.clone(), self.defs.vars[var].span);
                self.push(
                    Diagnostic::new(
                        codes::CYCLIC_VALUE,
                        span,
                        format!("the initial value of `{name}` depends on itself"),
                    )
                    .help("break the cycle: one of these values must be written as a literal"),
                );
                return;
            }
            State::Todo => {}
        }
        self.var_slots[var].init = State::Busy;
        let from_type = match &self.var_slots[var].ty {
            State::Done(init) => init.clone(),
            _ => Init::Default,
        };
        let written = self.var_slots[var].decl.and_then(|(_, init)| init);
        let (ty, section) = (self.defs.vars[var].ty, self.defs.vars[var].section);
        self.defs.vars[var].init = match written {
            Some(init) if section == Section::InOut => {
                self.push(
                    Diagnostic::new(codes::BAD_INITIALISER, init.span, "a VAR_IN_OUT has no initial value")
                        .help("it is the variable that each call connects"),
                );
                Init::Default
            }
            Some(init) => self.initial(init, ty, Home::Variable(var)),
            None => from_type,
        };
        self.var_slots[var].init = State::Done(());
    }

    /// Initial values of all variables.
    pub fn init_all(&mut self) {
        for var in self.defs.vars.indices() {
            self.var_init(var);
        }
        self.settle_references();
    }

    /// An initialiser against the type of what it initialises.
    pub fn initial(&mut self, init: &'a ast::Init, ty: TypeId, home: Home) -> Init {
        if ty == Types::ERROR {
            return Init::Default;
        }
        if let Some(reference) = self.note_reference(init, ty, home) {
            return reference;
        }
        match self.defs.types.get(ty).clone() {
            Type::Array { dims, elem } => self.initial_array(init, ty, &dims, elem, home),
            Type::Struct(_) | Type::Instance(_) => self.initial_fields(init, ty, home),
            _ => match &init.kind {
                ast::InitKind::Expr(e) => Checker::constant(self, home.scope(&self.defs)).const_init(e, ty),
                _ => {
                    self.wrong_form(init, ty);
                    Init::Default
                }
            },
        }
    }

    fn wrong_form(&mut self, init: &ast::Init, ty: TypeId) {
        let name = self.type_name(ty);
        let help = match self.defs.types.get(ty) {
            _ if matches!(init.kind, ast::InitKind::Reference(_)) => "REF= belongs to a REFERENCE TO; write :=",
            Type::Array { .. } => "an array is initialised with a list: [1, 2, 3(0)]",
            Type::Struct(_) | Type::Instance(_) => "components are initialised by name: (a := 1, b := 2)",
            _ => "write one value",
        };
        self.push(
            Diagnostic::new(codes::BAD_INITIALISER, init.span, format!("this cannot initialise {name}")).help(help),
        );
    }

    /// The initial value of another variable, for the whole of an array, a structure or an instance.
    fn copied_init(&mut self, e: &'a ast::Expr, ty: TypeId, home: Home) -> Init {
        let init = Checker::constant(self, home.scope(&self.defs)).const_init(e, ty);
        self.note_copies(&init, e, home);
        init
    }

    /// The type of a component of a structure or instance, by its index.
    fn component_type(&mut self, ty: TypeId, index: usize) -> TypeId {
        match *self.defs.types.get(ty) {
            Type::Struct(id) => self.defs.structs[id].fields[index].ty,
            Type::Instance(pou) => {
                let var = self.defs.pous[pou].vars[index];
                self.var_type(var);
                self.defs.vars[var].ty
            }
            _ => Types::ERROR,
        }
    }

    /// The component that is most likely meant by a name.
    fn similar_component(&self, ty: TypeId, name: &str) -> Option<String> {
        match self.defs.types.get(ty) {
            Type::Struct(id) => similar(name, self.defs.structs[*id].fields.iter().map(|f| f.name.as_str())),
            Type::Instance(pou) => {
                similar(name, self.defs.pous[*pou].vars.iter().map(|v| self.defs.vars[*v].name.as_str()))
            }
            _ => None,
        }
    }

    /// `(speed = 1.0)`: a component that is compared instead of given a value.
    fn compared_component(&mut self, e: &'a ast::Expr, ty: TypeId) -> bool {
        let ast::ExprKind::Binary(ast::BinaryOp::Eq, at, left, _) = &e.kind else { return false };
        let ast::ExprKind::Name(name) = &left.kind else { return false };
        if self.component(ty, &name.text).is_none() {
            return false;
        }
        self.push(
            Diagnostic::new(codes::EQUALS_FOR_ASSIGN, *at, "`=` compares, it gives no value to a component")
                .help(format!("write `{} := ...`", name.text)),
        );
        true
    }

    fn initial_fields(&mut self, init: &'a ast::Init, ty: TypeId, home: Home) -> Init {
        let parts = match &init.kind {
            ast::InitKind::Struct(parts) => parts,
            ast::InitKind::Expr(e) if self.compared_component(e, ty) => return Init::Default,
            ast::InitKind::Expr(e) => return self.copied_init(e, ty, home),
            ast::InitKind::Array { .. } | ast::InitKind::Reference(_) => {
                self.wrong_form(init, ty);
                return Init::Default;
            }
        };
        let mut seen = FxHashMap::default();
        let mut values = Vec::new();
        for (name, value) in parts {
            let Some(index) = self.component(ty, &name.text) else {
                let hint = self.similar_component(ty, &name.text);
                let message = format!("{} has no component `{}`", self.type_name(ty), name.text);
                self.push(
                    Diagnostic::new(codes::UNKNOWN_MEMBER, name.span, message)
                        .help_if(hint.map(|h| format!("did you mean `{h}`?"))),
                );
                continue;
            };
            if let Some(first) = seen.insert(index, name.span) {
                self.push(
                    Diagnostic::new(codes::BAD_INITIALISER, name.span, format!("`{}` is initialised twice", name.text))
                        .also(first, "first here"),
                );
                continue;
            }
            let component = self.component_type(ty, index);
            let value = self.initial(value, component, home);
            values.push((index as u32, value));
        }
        Init::Fields(values)
    }

    /// The first list among initial values for elements that are no arrays.
    fn list_in_list(&self, elems: &[ast::InitElem], elem: TypeId) -> Option<Span> {
        if matches!(self.defs.types.get(elem), Type::Array { .. }) {
            return None;
        }
        elems.iter().find_map(|part| match part {
            ast::InitElem::One(value) if matches!(value.kind, ast::InitKind::Array { .. }) => Some(value.span),
            _ => None,
        })
    }

    fn initial_array(
        &mut self,
        init: &'a ast::Init,
        ty: TypeId,
        dims: &[(i64, i64)],
        elem: TypeId,
        home: Home,
    ) -> Init {
        let count = dims.iter().map(|(l, h)| h - l + 1).product::<i64>() as u32;
        let ast::InitKind::Array { elems, .. } = &init.kind else {
            // One value without brackets for an array of one, as Ed. 2 writes it.
            return match &init.kind {
                ast::InitKind::Expr(e) if matches!(e.kind, ast::ExprKind::Name(_) | ast::ExprKind::Member(..)) => {
                    let ty = self.defs.types.intern(Type::Array { dims: vec![(1, i64::from(count))], elem });
                    self.copied_init(e, ty, home)
                }
                ast::InitKind::Expr(_) if count == 1 => Init::Array(vec![(1, self.initial(init, elem, home))]),
                _ => {
                    self.wrong_form(init, ty);
                    Init::Default
                }
            };
        };
        if dims.len() > 1
            && let Some(list) = self.list_in_list(elems, elem)
        {
            self.push(
                Diagnostic::new(codes::BAD_INITIALISER, list, "a list for each row of an array of several dimensions")
                    .help("its elements stand in one list, the last subscript running fastest: `[1, 2, 3, 4]`"),
            );
            return Init::Default;
        }
        let mut runs: Vec<(u32, Init)> = Vec::new();
        let mut total: u64 = 0;
        let mut push = |runs: &mut Vec<(u32, Init)>, n: u32, value: Init| {
            total += u64::from(n);
            // What is too much is reported below; the list stays small whatever the counts are.
            if total <= u64::from(count) {
                match runs.last_mut() {
                    Some((m, last)) if *last == value => *m += n,
                    _ => runs.push((n, value)),
                }
            }
        };
        for part in elems {
            match part {
                ast::InitElem::One(value) => {
                    let value = self.initial(value, elem, home);
                    push(&mut runs, 1, value);
                }
                ast::InitElem::Repeat(times, values) => {
                    let Some(n) = self.const_integer(times, home.scope(&self.defs)) else { continue };
                    if n < 0 || n > i128::from(u32::MAX) {
                        self.push(
                            Diagnostic::new(codes::BAD_INITIALISER, times.span, format!("{n} is no repetition count"))
                                .help("write how many elements get the values in parentheses"),
                        );
                        continue;
                    }
                    let group: Vec<Init> = values.iter().map(|v| self.initial(v, elem, home)).collect();
                    match group.as_slice() {
                        [] => push(&mut runs, n as u32, Init::Default),
                        [one] => push(&mut runs, n as u32, one.clone()),
                        many => {
                            // More groups than elements change nothing but the count.
                            for _ in 0..n.min(i128::from(count) + 1) {
                                many.iter().for_each(|v| push(&mut runs, 1, v.clone()));
                            }
                        }
                    }
                }
            }
        }
        if total > u64::from(count) {
            self.push(
                Diagnostic::new(
                    codes::BAD_INITIALISER,
                    init.span,
                    format!("{total} initial values for {count} elements"),
                )
                .help("remove the surplus values or make the array larger"),
            );
        }
        Init::Array(runs)
    }
}
