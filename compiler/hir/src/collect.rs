//! Declares every name: POUs, actions, types, variables. In: all syntax trees. Out: name tables and open slots in [`Cx`].
//! Types and initial values are resolved afterwards, on demand (`resolve`, `initial`).

pub(crate) mod charts;

use crate::cx::*;
use crate::defs::*;
use crate::init::Init;
use crate::types::{Type, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::Elem;
use plcc_syntax::ast;
use smol_str::SmolStr;

/// The POU behind an item with a tree, for the passes that follow.
pub(crate) fn collect<'a>(cx: &mut Cx<'a>, units: &[Unit<'a>]) {
    // Types and POUs first: variables name them, files and POUs stand in any order (semantics.md [L3]).
    let mut pous: Vec<(PouId, &'a ast::Pou)> = Vec::new();
    let mut late_actions = Vec::new();
    for unit in units {
        for item in &unit.ast.items {
            match item {
                ast::Item::Types(decls) => decls.iter().for_each(|d| declare_type(cx, d)),
                ast::Item::Pou(pou) => pous.push((declare_pou(cx, pou, unit), pou)),
                ast::Item::Action(action) => late_actions.push(action),
                ast::Item::Globals(_) | ast::Item::Config(_) => {}
            }
        }
    }
    for unit in units {
        for item in &unit.ast.items {
            match item {
                ast::Item::Globals(section) => declare_globals(cx, section, None),
                ast::Item::Config(config) => {
                    config.sections.iter().for_each(|s| declare_globals(cx, s, None));
                    for (n, resource) in config.resources.iter().enumerate() {
                        resource.sections.iter().for_each(|s| declare_globals(cx, s, Some(n as u32)));
                    }
                }
                _ => {}
            }
        }
    }
    for (id, pou) in pous {
        declare_vars(cx, id, pou);
        charts::declare_steps(cx, id, &pou.body);
        for action in &pou.actions {
            declare_action(cx, id, action);
        }
    }
    for action in late_actions {
        let owner = action.owner.as_ref().and_then(|o| cx.pous.get(&fold(&o.text)).copied());
        match owner {
            Some(owner) => declare_action(cx, owner, action),
            None => cx.push(
                Diagnostic::new(codes::ACTION_WITHOUT_POU, action.name.span, "this ACTION belongs to no POU")
                    .help("write it inside its PROGRAM or FUNCTION_BLOCK, after the body"),
            ),
        }
    }
}

fn duplicate(cx: &mut Cx, what: &str, name: &ast::Name, first: Span) {
    cx.push(
        Diagnostic::new(codes::DUPLICATE_NAME, name.span, format!("{what} `{}` is declared twice", name.text))
            .label("declared again here")
            .also(first, "first declared here")
            .help("remove or rename one of them; names do not differ by case"),
    );
}

fn declare_type<'a>(cx: &mut Cx<'a>, decl: &'a ast::TypeDecl) {
    let key = fold(&decl.name.text);
    // One that lacks its name cannot be found by it; so below.
    if key.is_empty() {
        cx.type_slots.push(TypeSlot { decl, early: None, state: State::Todo });
        return;
    }
    if let Some(&slot) = cx.types.get(&key) {
        return duplicate(cx, "type", &decl.name, cx.type_slots[slot].decl.name.span);
    }
    if Elem::from_name(&key).is_some() {
        cx.push(
            Diagnostic::new(
                codes::DUPLICATE_NAME,
                decl.name.span,
                format!("`{}` is the name of an elementary type", decl.name.text),
            )
            .help("choose another name for this type"),
        );
        return;
    }
    cx.types.insert(key, cx.type_slots.len());
    cx.type_slots.push(TypeSlot { decl, early: None, state: State::Todo });
}

fn declare_pou<'a>(cx: &mut Cx<'a>, pou: &'a ast::Pou, unit: &Unit<'a>) -> PouId {
    let kind = match pou.kind {
        ast::PouKind::Program => PouKind::Program,
        ast::PouKind::FunctionBlock => PouKind::FunctionBlock,
        ast::PouKind::Function => PouKind::Function,
    };
    let key = fold(&pou.name.text);
    let id = new_pou(cx, &pou.name, kind, unit.builtin, Some(&pou.body), pou.span);
    charts::read_options(cx, id, pou, unit);
    if key.is_empty() {
        return id;
    }
    if unit.builtin {
        // A name that no user can hide, and for some blocks the only one.
        cx.pous.insert(internal_name(&key), id);
        if plcc_stdlib::blocks::is_internal(&key) {
            return id;
        }
    }
    match cx.pous.get(&key).copied() {
        Some(first) if !cx.defs.pous[first].builtin => {
            duplicate(cx, "POU", &pou.name, cx.defs.pous[first].span);
        }
        Some(_) => {
            cx.push(
                Diagnostic::new(
                    codes::HIDES_STANDARD,
                    pou.name.span,
                    format!("`{}` hides the standard function block of this name", pou.name.text),
                )
                .help("all sources of this project now use this one"),
            );
            cx.pous.insert(key, id);
        }
        None => {
            if let Some(&slot) = cx.types.get(&key) {
                duplicate(cx, "name", &pou.name, cx.type_slots[slot].decl.name.span);
            }
            if !unit.builtin && plcc_stdlib::funcs::find(&key).is_some() {
                cx.push(
                    Diagnostic::new(
                        codes::HIDES_STANDARD,
                        pou.name.span,
                        format!("`{}` hides the standard function of this name", pou.name.text),
                    )
                    .help("all sources of this project now use this one"),
                );
            }
            cx.pous.insert(key, id);
        }
    }
    id
}

/// The key of a block that is part of plcc, which users can neither name nor hide.
pub(crate) fn internal_name(name: &str) -> SmolStr {
    format!("${name}").into()
}

fn new_pou<'a>(
    cx: &mut Cx<'a>,
    name: &ast::Name,
    kind: PouKind,
    builtin: bool,
    body: Option<&'a ast::Body>,
    span: Span,
) -> PouId {
    let profile = if cx.codesys(span) { Profile::Codesys } else { Profile::Strict };
    let id = cx.defs.pous.push(Pou {
        name: name.text.clone(),
        kind,
        owner: None,
        vars: Vec::new(),
        result: None,
        actions: Vec::new(),
        profile,
        builtin,
        span: name.span,
    });
    cx.pou_slots.push(PouSlot { scope: Default::default(), body, chart_options: Default::default() });
    id
}

fn declare_action<'a>(cx: &mut Cx<'a>, owner: PouId, action: &'a ast::Action) {
    let builtin = cx.defs.pous[owner].builtin;
    if cx.defs.pous[owner].kind == PouKind::Function {
        cx.push(
            Diagnostic::new(codes::ACTION_WITHOUT_POU, action.name.span, "a FUNCTION has no actions")
                .help("only PROGRAM and FUNCTION_BLOCK have ACTIONs"),
        );
        return;
    }
    let id = new_pou(cx, &action.name, PouKind::Action, builtin, Some(&action.body), action.span);
    cx.defs.pous[id].owner = Some(owner);
    cx.defs.pous[id].profile = cx.defs.pous[owner].profile;
    cx.defs.pous[owner].actions.push(id);
    let key = fold(&action.name.text);
    charts::declare_steps(cx, owner, &action.body);
    let first = match cx.pou_slots[owner].scope.get(&key) {
        Some(Local::Action(first)) => Some(cx.defs.pous[*first].span),
        // A step and the action that it runs may share their name; the name alone means the step.
        Some(Local::Var(var)) if charts::is_step(cx, *var) => return,
        Some(Local::Var(var) | Local::External(var)) => Some(cx.defs.vars[*var].span),
        Some(Local::Missing) | None => None,
    };
    match first {
        Some(first) => duplicate(cx, "name", &action.name, first),
        None => {
            cx.pou_slots[owner].scope.insert(key, Local::Action(id));
        }
    }
}

/// Opens a variable; its type and initial value are resolved later.
pub(crate) fn new_var<'a>(
    cx: &mut Cx<'a>,
    name: SmolStr,
    span: Span,
    section: Section,
    owner: Option<PouId>,
    decl: Option<(&'a ast::TypeExpr, Option<&'a ast::Init>)>,
) -> VarId {
    let id = cx.defs.vars.push(Var {
        name,
        ty: Types::ERROR,
        section,
        owner,
        constant: false,
        retain: false,
        non_retain: false,
        resource: None,
        address: None,
        open_address: None,
        init: Init::Default,
        address_taken: false,
        span,
    });
    cx.var_slots.push(VarSlot { decl, ty: State::Todo, init: State::Todo });
    id
}

fn qualify(cx: &mut Cx, var: VarId, section: &ast::VarSection) {
    for (qualifier, _) in &section.qualifiers {
        match qualifier {
            ast::Qualifier::Constant => cx.defs.vars[var].constant = true,
            ast::Qualifier::Retain | ast::Qualifier::Persistent => cx.defs.vars[var].retain = true,
            ast::Qualifier::NonRetain => cx.defs.vars[var].non_retain = true,
            ast::Qualifier::Access => {}
        }
    }
}

fn locate(cx: &mut Cx, var: VarId, decl: &ast::VarDecl) {
    let Some((text, span)) = &decl.at else { return };
    // It has no text where the address was reported.
    if text.is_empty() {
        return;
    }
    if let Some(area) = crate::address::open(text) {
        cx.defs.vars[var].open_address = Some(area);
        return;
    }
    match crate::address::parse(text) {
        Ok(address) => cx.defs.vars[var].address = Some(address),
        Err(message) => cx.push(
            Diagnostic::new(codes::BAD_ADDRESS, *span, format!("`{text}`: {message}"))
                .help("write %I, %Q or %M, a size X B W D L, and a number: %IX0.0, %QW4, %MD8"),
        ),
    }
}

/// VAR_GLOBALs; `resource` is the number of the RESOURCE whose they are.
fn declare_globals<'a>(cx: &mut Cx<'a>, section: &'a ast::VarSection, resource: Option<u32>) {
    match section.kind {
        ast::SectionKind::Global => {}
        // Read by `config`.
        ast::SectionKind::Config | ast::SectionKind::Access => return,
        _ => {
            cx.push(
                Diagnostic::new(codes::MISPLACED_SECTION, section.span.before(), "only VAR_GLOBAL may stand here")
                    .help("other variables are declared inside a PROGRAM, FUNCTION_BLOCK or FUNCTION"),
            );
            return;
        }
    }
    for decl in &section.vars {
        for name in &decl.names {
            let key = fold(&name.text);
            if key.is_empty() {
                continue;
            }
            // Each RESOURCE may have a global of a name: there the name means its own.
            let first = cx.globals.get(&key).copied();
            let taken = first.filter(|first| {
                let same_name =
                    std::iter::once(*first).chain(cx.resource_globals.iter().filter(|g| g.0 == *first).map(|g| g.1));
                resource.is_none()
                    || same_name.into_iter().any(|v| [None, resource].contains(&cx.defs.vars[v].resource))
            });
            if let Some(first) = taken {
                duplicate(cx, "global variable", name, cx.defs.vars[first].span);
                continue;
            }
            let var =
                new_var(cx, name.text.clone(), name.span, Section::Global, None, Some((&decl.ty, decl.init.as_ref())));
            qualify(cx, var, section);
            locate(cx, var, decl);
            cx.defs.vars[var].resource = resource;
            match first {
                Some(first) => cx.resource_globals.push((first, var)),
                None => {
                    cx.defs.globals.push(var);
                    cx.globals.insert(key, var);
                }
            }
        }
    }
}

fn declare_vars<'a>(cx: &mut Cx<'a>, id: PouId, pou: &'a ast::Pou) {
    if pou.kind == ast::PouKind::Function
        && let Some(result) = &pou.result
    {
        let name = pou.name.text.clone();
        let var = new_var(cx, name.clone(), pou.name.span, Section::Result, Some(id), Some((result, None)));
        cx.defs.pous[id].result = Some(var);
        cx.defs.pous[id].vars.push(var);
        cx.pou_slots[id].scope.insert(fold(&name), Local::Var(var));
    }
    for section in &pou.sections {
        let place = match section.kind {
            ast::SectionKind::Var => Section::Local,
            ast::SectionKind::Temp => Section::Temp,
            ast::SectionKind::Input => Section::Input,
            ast::SectionKind::Output => Section::Output,
            ast::SectionKind::InOut => Section::InOut,
            ast::SectionKind::External => {
                section.vars.iter().for_each(|d| declare_external(cx, id, d));
                continue;
            }
            // CODESYS sources and some PROGRAMs declare globals inside a POU; the standard allows VAR_ACCESS in programs.
            ast::SectionKind::Global if pou.kind == ast::PouKind::Program => {
                declare_globals(cx, section, None);
                continue;
            }
            ast::SectionKind::Global | ast::SectionKind::Config | ast::SectionKind::Access => {
                cx.push(
                    Diagnostic::new(
                        codes::MISPLACED_SECTION,
                        section.span.before(),
                        "this section cannot stand in a POU",
                    )
                    .help("VAR_GLOBAL, VAR_CONFIG and VAR_ACCESS belong to a CONFIGURATION or the top level of a file"),
                );
                continue;
            }
        };
        for decl in &section.vars {
            for name in &decl.names {
                declare_var(cx, id, section, place, decl, name);
            }
        }
    }
}

fn declare_var<'a>(
    cx: &mut Cx<'a>,
    id: PouId,
    section: &'a ast::VarSection,
    place: Section,
    decl: &'a ast::VarDecl,
    name: &'a ast::Name,
) {
    let key = fold(&name.text);
    if key.is_empty() {
        return;
    }
    if let Some(&first) = cx.pou_slots[id].scope.get(&key) {
        if let Local::Var(var) = first {
            doubt_type(cx, var, &decl.ty);
        }
        let first = match &first {
            Local::Var(var) | Local::External(var) => cx.defs.vars[*var].span,
            Local::Action(pou) => cx.defs.pous[*pou].span,
            Local::Missing => name.span,
        };
        return duplicate(cx, "variable", name, first);
    }
    let var = new_var(cx, name.text.clone(), name.span, place, Some(id), Some((&decl.ty, decl.init.as_ref())));
    qualify(cx, var, section);
    locate(cx, var, decl);
    let instances = matches!(cx.defs.pous[id].kind, PouKind::Program | PouKind::FunctionBlock);
    if cx.defs.vars[var].open_address.is_some() && instances && matches!(place, Section::Local) {
        // VAR_CONFIG gives each instance its own address.
    } else if decl.at.is_some() && !matches!(place, Section::Local) {
        cx.push(
            Diagnostic::new(codes::BAD_ADDRESS, decl.span, "only VAR and VAR_GLOBAL may be located with AT")
                .help("declare the variable in VAR, or as VAR_GLOBAL"),
        );
        cx.defs.vars[var].address = None;
    } else if decl.at.is_some() && cx.defs.pous[id].kind != PouKind::Program {
        cx.push(
            Diagnostic::new(
                codes::BAD_ADDRESS,
                decl.span,
                "only PROGRAMs and VAR_GLOBAL may hold located variables: each instance would share the address",
            )
            .help("declare it as VAR_GLOBAL and use it with VAR_EXTERNAL, or AT %I*, %Q*, %M* with an address in VAR_CONFIG"),
        );
        cx.defs.vars[var].address = None;
    }
    cx.defs.pous[id].vars.push(var);
    if let Some((edge, span)) = decl.edge {
        crate::edges::declare(cx, var, edge, span);
    }
    cx.pou_slots[id].scope.insert(key, Local::Var(var));
}

/// A second declaration with another type: which one is meant is not known, so no use of the variable is judged by its type.
fn doubt_type(cx: &mut Cx, var: VarId, second: &ast::TypeExpr) {
    let name = |ty: &ast::TypeExpr| match &ty.kind {
        ast::TypeExprKind::Named(name) => Some(fold(&name.text)),
        _ => None,
    };
    let first = cx.var_slots[var].decl.and_then(|(ty, _)| name(ty));
    if first.is_none() || first != name(second) {
        cx.var_slots[var].ty = State::Done(Init::Default);
    }
}

fn declare_external<'a>(cx: &mut Cx<'a>, id: PouId, decl: &'a ast::VarDecl) {
    for name in &decl.names {
        let key = fold(&name.text);
        let local = match cx.globals.get(&key).copied() {
            Some(global) => {
                let declared = cx.resolve_type(&decl.ty, None, &name.text).ty;
                cx.var_type(global);
                let actual = cx.defs.vars[global].ty;
                let same = declared == actual || declared == Types::ERROR || actual == Types::ERROR;
                if !same && !open_string(cx, declared, actual) {
                    let message = format!(
                        "VAR_EXTERNAL `{}` is {}, its VAR_GLOBAL is {}",
                        name.text,
                        cx.type_name(declared),
                        cx.type_name(actual)
                    );
                    let first = cx.defs.vars[global].span;
                    cx.push(
                        Diagnostic::new(codes::EXTERNAL_MISMATCH, decl.ty.span, message)
                            .also(first, "the global variable is declared here")
                            .help("declare it with the same type"),
                    );
                    Local::Missing
                } else {
                    Local::External(global)
                }
            }
            None => {
                let hint = similar(&name.text, cx.globals.keys().map(SmolStr::as_str));
                cx.push(
                    Diagnostic::new(
                        codes::EXTERNAL_MISSING,
                        name.span,
                        format!("there is no VAR_GLOBAL `{}`", name.text),
                    )
                    .help(match hint {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => "declare it in a VAR_GLOBAL section".into(),
                    }),
                );
                Local::Missing
            }
        };
        if cx.pou_slots[id].scope.insert(key, local).is_some() {
            duplicate(cx, "variable", name, name.span);
        }
    }
}

/// `STRING` in VAR_EXTERNAL stands for the capacity of the global.
fn open_string(cx: &Cx, declared: crate::types::TypeId, actual: crate::types::TypeId) -> bool {
    matches!(
        (cx.defs.types.get(declared), cx.defs.types.get(actual)),
        (Type::String { wide: a, .. }, Type::String { wide: b, .. }) if a == b
    )
}
