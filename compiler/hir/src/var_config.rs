//! VAR_CONFIG and VAR_ACCESS: what a CONFIGURATION says about variables inside program instances (semantics.md \[C1\] \[R4\]).
//!
//! A variable declared `AT %I*`, `%Q*` or `%M*` gets its address for each instance of its own from VAR_CONFIG. As all
//! instances share their code, it stays a variable of the instance; its program copies it from %I and %M before each
//! execution, and to %Q and %M after it.

use crate::app::{Access, Application, Program, VarPath};
use crate::body::*;
use crate::cx::*;
use crate::defs::*;
use crate::expr::Checker;
use crate::initial_references::Home;
use crate::types::{Type, Types};
use plcc_diag::{Diagnostic, codes};
use plcc_syntax::ast;

/// Applies the VAR_CONFIG and VAR_ACCESS sections of a CONFIGURATION.
pub(crate) fn apply<'a>(cx: &mut Cx<'a>, config: &'a ast::Configuration, app: &mut Application) {
    let resources = config.resources.iter().flat_map(|r| &r.sections);
    for section in config.sections.iter().chain(resources) {
        for decl in &section.vars {
            match section.kind {
                ast::SectionKind::Config => configure(cx, decl, app),
                ast::SectionKind::Access => access(cx, decl, app),
                _ => {}
            }
        }
    }
    cx.settle_references();
}

/// Reports variables whose address was left open and which no VAR_CONFIG placed.
pub(crate) fn report_open(cx: &mut Cx, app: &Application) {
    let mut open = Vec::new();
    for program in app.resources.iter().flat_map(|r| &r.programs) {
        let given: Vec<&VarPath> = program.located.iter().map(|(path, _)| path).collect();
        open_variables(&cx.defs, program.pou, &mut Vec::new(), &mut |path| {
            if !given.contains(&path) {
                open.push((program.name.clone(), path.clone()));
            }
        });
    }
    for (program, path) in open {
        let names: Vec<String> = path.iter().map(|v| cx.defs.vars[*v].name.to_string()).collect();
        let Some(span) = path.last().map(|v| cx.defs.vars[*v].span) else { continue };
        cx.push(
            Diagnostic::new(codes::OPEN_ADDRESS, span, format!("`{program}.{}` has no address", names.join(".")))
                .help("give it one in VAR_CONFIG: `Resource.Program.variable AT %IX0.0 : BOOL;`"),
        );
    }
}

/// Variables with an open address in an instance of a POU, instances inside it included. Containment has no cycles.
fn open_variables(defs: &Defs, pou: PouId, path: &mut VarPath, found: &mut impl FnMut(&VarPath)) {
    for &var in &defs.pous[pou].vars {
        let def = &defs.vars[var];
        path.push(var);
        match defs.types.get(def.ty) {
            _ if def.open_address.is_some() => found(path),
            Type::Instance(inner) if def.section != Section::InOut => open_variables(defs, *inner, path, found),
            _ => {}
        }
        path.pop();
    }
}

/// `Res.P1.fb.x AT %IX0.0 : BOOL := TRUE;`
fn configure<'a>(cx: &mut Cx<'a>, decl: &'a ast::VarDecl, app: &mut Application) {
    let Some((program, path)) = instance_variable(cx, decl.names.iter().chain(&decl.path), app) else { return };
    let Some(&var) = path.last() else { return };
    if !same_type(cx, decl, var) {
        return;
    }
    let ty = cx.defs.vars[var].ty;
    if let Some(init) = &decl.init {
        let init = cx.initial(init, ty, Home::Outside(None));
        program_of(app, program).initial.push((path.clone(), init));
    }
    let Some((text, span)) = decl.at.as_ref().filter(|(text, _)| !text.is_empty()) else { return };
    let address = match crate::address::parse(text) {
        Ok(address) => address,
        Err(message) => return cx.push(Diagnostic::new(codes::BAD_ADDRESS, *span, format!("`{text}`: {message}"))),
    };
    let Some(area) = cx.defs.vars[var].open_address else {
        let (name, declared) = (cx.defs.vars[var].name.clone(), cx.defs.vars[var].span);
        return cx.push(
            Diagnostic::new(codes::BAD_ADDRESS, *span, format!("the address of `{name}` was not left open"))
                .also(declared, "declared here")
                .help("declare it AT %I*, %Q* or %M* to give each instance its own address"),
        );
    };
    if area != address.area {
        let declared = cx.defs.vars[var].span;
        return cx.push(
            Diagnostic::new(
                codes::BAD_ADDRESS,
                *span,
                format!("`{text}` lies in another area than the declaration says"),
            )
            .also(declared, "declared here"),
        );
    }
    let bits = cx.elem_of(ty).map(|e| if e == plcc_stdlib::elem::Elem::Bool { 1 } else { e.bits() });
    let width = crate::address::width(text) * 8;
    if bits.is_some_and(|bits| bits != width.max(1)) {
        let name = cx.type_name(ty);
        return cx.push(
            Diagnostic::new(codes::BAD_ADDRESS, *span, format!("`{text}` has another size than {name}"))
                .help("X is one bit, B 8, W 16, D 32, L 64 bits"),
        );
    }
    let place = Place { root: Root::Address(address), steps: Vec::new(), ty, span: *span };
    program_of(app, program).located.push((path, place));
}

/// `NAME : Res.P1.x : INT READ_ONLY;`
fn access<'a>(cx: &mut Cx<'a>, decl: &'a ast::VarDecl, app: &mut Application) {
    let Some(name) = decl.names.first() else { return };
    if let Some(first) = app.access.iter().find(|a| a.name.eq_ignore_ascii_case(&name.text)) {
        let first = first.span;
        return cx.push(
            Diagnostic::new(codes::DUPLICATE_NAME, name.span, format!("access path `{}` is declared twice", name.text))
                .also(first, "first declared here"),
        );
    }
    let mut text = String::new();
    if let Some((address, _)) = &decl.at {
        text.push_str(address);
    } else if let [one] = decl.path.as_slice()
        && let Some(&var) = cx.globals.get(&fold(&one.text))
    {
        if !same_type(cx, decl, var) {
            return;
        }
        text.push_str(&cx.defs.vars[var].name);
    } else {
        let Some((program, path)) = instance_variable(cx, decl.path.iter(), app) else { return };
        if path.last().is_some_and(|var| !same_type(cx, decl, *var)) {
            return;
        }
        if app.resources.len() > 1 {
            text.push_str(&app.resources[program.0].name);
            text.push('.');
        }
        text.push_str(&app.resources[program.0].programs[program.1].name);
        for var in path {
            text.push('.');
            text.push_str(&cx.defs.vars[var].name);
        }
    }
    app.access.push(Access {
        name: name.text.clone(),
        path: text,
        writable: decl.read_write == Some(true),
        span: name.span,
    });
}

/// A program instance: its resource and its number there.
type ProgramId = (usize, usize);

fn program_of(app: &mut Application, id: ProgramId) -> &mut Program {
    &mut app.resources[id.0].programs[id.1]
}

/// The variable that a path from the configuration inwards names; messages are given.
fn instance_variable<'n>(
    cx: &mut Cx,
    mut names: impl Iterator<Item = &'n ast::Name>,
    app: &Application,
) -> Option<(ProgramId, VarPath)> {
    let unknown = |cx: &mut Cx, name: &ast::Name, what: &str, hint: Option<String>| {
        cx.push(
            Diagnostic::new(codes::UNKNOWN_PATH, name.span, format!("there is no {what} `{}`", name.text))
                .help_if(hint.map(|h| format!("did you mean `{h}`?"))),
        );
    };
    let mut name = names.next()?;
    let resource = app.resources.iter().position(|r| r.name.eq_ignore_ascii_case(&name.text));
    if resource.is_some() {
        let whole = name;
        name = match names.next() {
            Some(name) => name,
            None => {
                unknown(cx, whole, "variable", None);
                return None;
            }
        };
    }
    let programs = || {
        let all = app.resources.iter().enumerate();
        all.filter(|(n, _)| resource.is_none_or(|r| r == *n))
            .flat_map(|(r, def)| def.programs.iter().enumerate().map(move |(p, def)| ((r, p), def)))
    };
    let Some((id, program)) = programs().find(|(_, p)| p.name.eq_ignore_ascii_case(&name.text)) else {
        let hint = similar(&name.text, programs().map(|(_, p)| p.name.as_str()));
        unknown(cx, name, "program instance", hint);
        return None;
    };
    let mut pou = program.pou;
    let mut path = VarPath::new();
    for name in names {
        let Some(Local::Var(var)) = cx.pou_slots[pou].scope.get(&fold(&name.text)).copied() else {
            let vars = cx.defs.pous[pou].vars.iter().map(|v| cx.defs.vars[*v].name.clone()).collect::<Vec<_>>();
            let hint = similar(&name.text, vars.iter().map(|n| n.as_str()));
            unknown(cx, name, &format!("variable of `{}`", cx.defs.pous[pou].name.clone()), hint);
            return None;
        };
        cx.var_type(var);
        path.push(var);
        if let Type::Instance(inner) = cx.defs.types.get(cx.defs.vars[var].ty) {
            pou = *inner;
        }
    }
    if path.is_empty() {
        unknown(cx, name, "variable", None);
        return None;
    }
    Some((id, path))
}

/// The type of such a declaration repeats that of the variable.
fn same_type<'a>(cx: &mut Cx<'a>, decl: &'a ast::VarDecl, var: VarId) -> bool {
    let resolved = cx.resolve_type(&decl.ty, None, "VAR_CONFIG").ty;
    cx.var_type(var);
    let ty = cx.defs.vars[var].ty;
    if resolved == Types::ERROR || ty == Types::ERROR {
        return false;
    }
    if resolved == ty {
        return true;
    }
    let (have, want, declared) = (cx.type_name(resolved), cx.type_name(ty), cx.defs.vars[var].span);
    cx.push(
        Diagnostic::new(codes::TYPE_MISMATCH, decl.ty.span, format!("this says {have}, the variable is {want}"))
            .also(declared, "declared here")
            .help("repeat the type of its declaration"),
    );
    false
}

/// `SINGLE := go`: a BOOL that has one address.
pub(crate) fn single<'a>(cx: &mut Cx<'a>, value: &'a ast::Expr) -> Option<Place> {
    let mut c = Checker::constant(cx, None);
    let place = c.place(value)?;
    let fixed = matches!(place.root, Root::Address(_))
        || matches!(place.root, Root::Var(var) if c.cx.defs.vars[var].section == Section::Global)
            && place.steps.iter().all(|step| match step {
                Step::Field(_) => true,
                Step::Index(indices, _) => indices.iter().all(|i| matches!(i.kind, ExprKind::Const(_))),
                _ => false,
            });
    if fixed && c.elem_of(place.ty) == Some(plcc_stdlib::elem::Elem::Bool) {
        return Some(place);
    }
    c.report(
        Diagnostic::new(codes::BAD_TASK, value.span, "SINGLE needs a BOOL that is global or an address")
            .help("the task runs when it rises: declare it in VAR_GLOBAL, or write %IX0.0"),
    );
    None
}
