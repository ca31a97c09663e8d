//! Several RESOURCEs: which globals each has, and what the code that it runs may use (semantics.md \[C3\]).
//!
//! A VAR_GLOBAL of a RESOURCE exists in that resource only. Resources may have globals of one name; POUs that both run use
//! them by that name, so they must have one type, and each resource works on its own. Those of the CONFIGURATION are shared
//! by value: they hold no references, which mean something in one resource's memory only.

use crate::app::Application;
use crate::body::*;
use crate::cx::*;
use crate::defs::*;
use crate::types::{Type, TypeId, Types};
use crate::visit::{self, Use, Visitor};
use plcc_diag::{Diagnostic, Span, codes};
use rustc_hash::FxHashSet;

/// Checks an application and gives each resource its globals.
pub(crate) fn check(cx: &mut Cx, app: &mut Application) {
    for (first, own) in cx.resource_globals.clone() {
        cx.var_type(first);
        cx.var_type(own);
        let (a, b) = (&cx.defs.vars[first], &cx.defs.vars[own]);
        if a.ty != b.ty && a.ty != Types::ERROR && b.ty != Types::ERROR {
            let message =
                format!("`{}` is {} here and {} in another RESOURCE", b.name, cx.type_name(b.ty), cx.type_name(a.ty));
            let (span, other) = (b.span, a.span);
            cx.push(
                Diagnostic::new(codes::FOREIGN_GLOBAL, span, message)
                    .also(other, "the other one is here")
                    .help("give both the same type, as POUs that both resources run mean either, or another name"),
            );
            continue;
        }
        if let Some(resource) = b.resource.and_then(|n| app.resources.get_mut(n as usize)) {
            resource.globals.push((first, own));
        }
    }
    if app.resources.len() < 2 {
        return;
    }
    for number in 0..app.resources.len() {
        report_foreign(cx, app, number);
    }
    for var in cx.defs.globals.clone() {
        let def = &cx.defs.vars[var];
        if def.resource.is_none() && holds_references(&cx.defs, def.ty) {
            let (span, name) = (def.span, def.name.clone());
            cx.push(
                Diagnostic::new(
                    codes::SHARED_REFERENCE,
                    span,
                    format!("`{name}` is shared by resources and holds a reference"),
                )
                .help("each resource has a memory of its own; declare it in the RESOURCE that uses it"),
            );
        }
    }
}

/// Uses of another resource's globals in all that a resource runs.
fn report_foreign(cx: &mut Cx, app: &Application, number: usize) {
    struct Globals<'a> {
        found: Vec<(VarId, Span)>,
        calls: Vec<PouId>,
        defs: &'a Defs,
    }
    impl Visitor for Globals<'_> {
        fn place(&mut self, place: &Place, _: Use) {
            if let Root::Var(var) = place.root
                && self.defs.vars[var].resource.is_some()
            {
                self.found.push((var, place.span));
            }
        }
        fn call(&mut self, call: &Call) {
            let (Callee::Function(pou) | Callee::Instance(_, pou) | Callee::Action(_, pou)) = call.callee;
            self.calls.push(pou);
        }
    }
    let mut globals = Globals { found: Vec::new(), calls: Vec::new(), defs: &cx.defs };
    let resource = &app.resources[number];
    for program in &resource.programs {
        globals.calls.push(program.pou);
        program.inputs.iter().for_each(|(_, value)| visit::expr(value, &mut globals));
        program.outputs.iter().for_each(|(_, place)| visit::place(place, Use::Written, &mut globals));
    }
    for task in &resource.tasks {
        task.single.iter().for_each(|place| visit::place(place, Use::Read, &mut globals));
    }
    let mut seen = vec![false; cx.defs.pous.len()];
    let mut held = Held::default();
    for &var in cx.defs.globals.iter().filter(|var| cx.defs.vars[**var].resource == Some(number as u32)) {
        held.variable(&cx.defs, var);
    }
    while let Some(pou) = globals.calls.pop() {
        if !std::mem::replace(&mut seen[pou.index()], true) {
            visit::stmts(&cx.defs.bodies[pou].stmts, &mut globals);
            cx.defs.pous[pou].vars.iter().for_each(|var| held.variable(&cx.defs, *var));
            globals.calls.append(&mut held.instances);
        }
    }
    for place in held.references.iter().filter_map(|id| cx.defs.references[*id].as_ref()) {
        visit::place(place, Use::Written, &mut globals);
    }
    let mut told = Vec::new();
    for (var, span) in globals.found {
        if app.has_global(number, var, &cx.defs) || told.contains(&var) {
            continue;
        }
        told.push(var);
        let def = &cx.defs.vars[var];
        let (name, declared, running) = (def.name.clone(), def.span, resource.name.clone());
        let owner =
            def.resource.and_then(|n| app.resources.get(n as usize)).map_or_else(Default::default, |r| r.name.clone());
        cx.push(
            Diagnostic::new(
                codes::FOREIGN_GLOBAL,
                span,
                format!("`{name}` belongs to RESOURCE `{owner}`, this runs in `{running}` too"),
            )
            .also(declared, "declared here")
            .help("declare it in the CONFIGURATION, or one of this name and type in each RESOURCE"),
        );
    }
}

/// What variables hold: references with an initial value, and instances.
#[derive(Default)]
struct Held {
    references: Vec<ReferenceId>,
    instances: Vec<PouId>,
    types: FxHashSet<TypeId>,
}

impl Held {
    fn variable(&mut self, defs: &Defs, var: VarId) {
        defs.vars[var].init.references(&mut self.references);
        self.of_type(defs, defs.vars[var].ty);
    }

    fn of_type(&mut self, defs: &Defs, ty: TypeId) {
        if !self.types.insert(ty) {
            return;
        }
        match &defs.types[ty] {
            Type::Array { elem, .. } => self.of_type(defs, *elem),
            Type::Struct(id) => {
                for field in &defs.structs[*id].fields {
                    field.init.references(&mut self.references);
                    self.of_type(defs, field.ty);
                }
            }
            Type::Instance(pou) => self.instances.push(*pou),
            _ => {}
        }
    }
}

/// Whether a reference that outlives a call lies in a type: one of a VAR_IN_OUT does not.
fn holds_references(defs: &Defs, ty: TypeId) -> bool {
    match &defs.types[ty] {
        Type::Ref { .. } => true,
        Type::Array { elem, .. } => holds_references(defs, *elem),
        Type::Struct(id) => defs.structs[*id].fields.iter().any(|f| holds_references(defs, f.ty)),
        Type::Instance(pou) => {
            let vars = defs.pous[*pou].vars.iter().map(|v| &defs.vars[*v]);
            vars.filter(|v| !matches!(v.section, Section::InOut | Section::Temp)).any(|v| holds_references(defs, v.ty))
        }
        _ => false,
    }
}
