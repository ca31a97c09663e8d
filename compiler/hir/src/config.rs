//! CONFIGURATION, or the single PROGRAM without one, to the [`Application`] that is to run (semantics.md \[C1\] \[C2\]).

use crate::app::*;
use crate::body::Place;
use crate::cx::*;
use crate::defs::*;
use crate::expr::{Checker, conversion_help};
use crate::rules::{self, Implicit};
use crate::types::{Type, TypeId, Types};
use plcc_diag::{Diagnostic, FileId, Span, codes};
use plcc_stdlib::elem::Elem;
use plcc_syntax::ast;

/// One second: what a task may take when nothing else is said (\[E3\]).
pub const DEFAULT_WATCHDOG_NS: i64 = 1_000_000_000;

/// What the command line says about programs and tasks.
#[derive(Debug, Clone, Default)]
pub struct Selection {
    /// `--program NAME`.
    pub program: Option<String>,
    /// `[tasks]` of project.toml: name, interval, priority, watchdog, programs; in order of the file.
    pub tasks: Vec<TaskSelection>,
}

/// A task of project.toml.
#[derive(Debug, Clone)]
pub struct TaskSelection {
    /// Its name.
    pub name: String,
    /// Period, nanoseconds.
    pub interval_ns: Option<i64>,
    /// 0 is the highest.
    pub priority: u32,
    /// Longest execution, nanoseconds.
    pub watchdog_ns: Option<i64>,
    /// The reaction time that it has to keep, nanoseconds.
    pub deadline_ns: Option<i64>,
    /// Names of PROGRAMs.
    pub programs: Vec<String>,
}

/// Builds the application; `None` after an error, or if there is nothing to run (a library).
pub(crate) fn configure<'a>(cx: &mut Cx<'a>, units: &[Unit<'a>], selection: &Selection) -> Option<Application> {
    let mut configs = units.iter().flat_map(|u| &u.ast.items).filter_map(|i| match i {
        ast::Item::Config(c) => Some(c),
        _ => None,
    });
    if let Some(config) = configs.next() {
        if let Some(second) = configs.next() {
            cx.push(
                Diagnostic::new(codes::SEVERAL_CONFIGURATIONS, second.name.span, "there is a second CONFIGURATION")
                    .also(config.name.span, "the first one is here")
                    .help("a project has one CONFIGURATION"),
            );
            return None;
        }
        if !selection.tasks.is_empty() {
            cx.push(
                Diagnostic::new(
                    codes::TASKS_TWICE,
                    config.name.span,
                    "tasks are declared in this CONFIGURATION and in [tasks] of project.toml",
                )
                .help("remove one of them; the CONFIGURATION is the standard's way"),
            );
            return None;
        }
        return configuration(cx, config);
    }
    without_configuration(cx, selection)
}

fn without_configuration(cx: &mut Cx, selection: &Selection) -> Option<Application> {
    let programs: Vec<PouId> = cx.defs.pous.indices().filter(|p| cx.defs.pous[*p].kind == PouKind::Program).collect();
    let find =
        |cx: &Cx, name: &str| programs.iter().copied().find(|p| cx.defs.pous[*p].name.eq_ignore_ascii_case(name));
    let nowhere = Span::new(FileId(0), 0, 0);
    let instance = |cx: &Cx, pou: PouId, task: usize| Program {
        name: cx.defs.pous[pou].name.clone(),
        pou,
        task,
        inputs: Vec::new(),
        outputs: Vec::new(),
        located: Vec::new(),
        initial: Vec::new(),
        span: cx.defs.pous[pou].span,
    };
    let unknown = |cx: &mut Cx, name: &str| {
        let hint = similar(name, programs.iter().map(|p| cx.defs.pous[*p].name.as_str()));
        cx.push(
            Diagnostic::new(codes::UNKNOWN_PROGRAM, nowhere, format!("there is no PROGRAM `{name}`"))
                .help_if(hint.map(|h| format!("did you mean `{h}`?"))),
        );
    };
    let mut resource = Resource::default();
    if !selection.tasks.is_empty() {
        for task in &selection.tasks {
            resource.tasks.push(Task {
                name: task.name.as_str().into(),
                interval_ns: task.interval_ns,
                single: None,
                priority: task.priority,
                watchdog_ns: task.watchdog_ns.unwrap_or(DEFAULT_WATCHDOG_NS),
                deadline_ns: task.deadline_ns,
            });
            for name in &task.programs {
                match find(cx, name) {
                    Some(pou) => resource.programs.push(instance(cx, pou, resource.tasks.len() - 1)),
                    None => unknown(cx, name),
                }
            }
        }
    } else {
        let pou = match (&selection.program, programs.as_slice()) {
            (Some(name), _) => match find(cx, name) {
                Some(pou) => pou,
                None => {
                    unknown(cx, name);
                    return None;
                }
            },
            (None, [one]) => *one,
            (None, []) => return None,
            (None, [first, second, ..]) => {
                let names: Vec<&str> = programs.iter().map(|p| cx.defs.pous[*p].name.as_str()).collect();
                let d = Diagnostic::new(
                    codes::SEVERAL_PROGRAMS,
                    cx.defs.pous[*second].span,
                    format!("there are {} PROGRAMs and no CONFIGURATION", names.len()),
                )
                .also(cx.defs.pous[*first].span, "the first one is here")
                .help(format!("choose one with --program NAME ({}), or write a CONFIGURATION", names.join(", ")));
                cx.push(d);
                return None;
            }
        };
        resource.tasks.push(free_task());
        resource.programs.push(instance(cx, pou, 0));
    }
    let app = Application { name: Default::default(), resources: vec![resource], access: Vec::new() };
    crate::var_config::report_open(cx, &app);
    Some(app)
}

/// The task of programs without one: runs last in every base tick.
fn free_task() -> Task {
    Task {
        name: Default::default(),
        interval_ns: None,
        single: None,
        priority: u32::MAX,
        watchdog_ns: DEFAULT_WATCHDOG_NS,
        deadline_ns: None,
    }
}

fn configuration<'a>(cx: &mut Cx<'a>, config: &'a ast::Configuration) -> Option<Application> {
    let mut app = Application { name: config.name.text.clone(), resources: Vec::new(), access: Vec::new() };
    for decl in &config.resources {
        let resource = resource(cx, decl);
        if let (Some(name), true) =
            (&decl.name, app.resources.iter().any(|r| r.name.eq_ignore_ascii_case(&resource.name)))
        {
            cx.push(Diagnostic::new(
                codes::DUPLICATE_NAME,
                name.span,
                format!("resource `{}` is declared twice", name.text),
            ));
            return None;
        }
        app.resources.push(resource);
    }
    crate::resources::check(cx, &mut app);
    crate::var_config::apply(cx, config, &mut app);
    crate::var_config::report_open(cx, &app);
    let half_read = cx.half_read.contains(&config.name.span.file);
    if config.resources.iter().all(|r| r.programs.is_empty()) && !half_read {
        cx.push(
            Diagnostic::new(codes::NO_PROGRAM, config.name.span, "this CONFIGURATION runs no program")
                .help("add `PROGRAM P1 WITH Task1 : Main;`"),
        );
        return None;
    }
    Some(app)
}

fn resource<'a>(cx: &mut Cx<'a>, decl: &'a ast::Resource) -> Resource {
    let mut resource = Resource {
        name: decl.name.as_ref().map(|n| n.text.clone()).unwrap_or_default(),
        tasks: Vec::new(),
        programs: Vec::new(),
        globals: Vec::new(),
    };
    for task in &decl.tasks {
        let checked = self::task(cx, task);
        if resource.tasks.iter().any(|t| t.name.eq_ignore_ascii_case(&checked.name)) {
            cx.push(Diagnostic::new(
                codes::DUPLICATE_NAME,
                task.name.span,
                format!("task `{}` is declared twice", task.name.text),
            ));
            continue;
        }
        resource.tasks.push(checked);
    }
    let mut free = None;
    for program in &decl.programs {
        let task = match &program.task {
            Some(name) => {
                let found = resource.tasks.iter().position(|t| t.name.eq_ignore_ascii_case(&name.text));
                let Some(found) = found else {
                    let hint = similar(&name.text, resource.tasks.iter().map(|t| t.name.as_str()));
                    let help = match hint {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => format!("declare it: `TASK {}(INTERVAL := T#10ms, PRIORITY := 1);`", name.text),
                    };
                    cx.push(
                        Diagnostic::new(codes::UNKNOWN_TASK, name.span, format!("there is no TASK `{}`", name.text))
                            .help(help),
                    );
                    continue;
                };
                found
            }
            None => *free.get_or_insert_with(|| {
                resource.tasks.push(free_task());
                resource.tasks.len() - 1
            }),
        };
        if let Some(program) = self::program(cx, program, task) {
            if let Some(first) = resource.programs.iter().find(|p| p.name.eq_ignore_ascii_case(&program.name)) {
                let first = first.span;
                cx.push(
                    Diagnostic::new(
                        codes::DUPLICATE_NAME,
                        program.span,
                        format!("program instance `{}` is declared twice", program.name),
                    )
                    .also(first, "first declared here"),
                );
                continue;
            }
            resource.programs.push(program);
        }
    }
    resource
}

fn task<'a>(cx: &mut Cx<'a>, decl: &'a ast::TaskDecl) -> Task {
    let mut task = Task {
        name: decl.name.text.clone(),
        interval_ns: None,
        single: None,
        priority: 0,
        watchdog_ns: DEFAULT_WATCHDOG_NS,
        deadline_ns: None,
    };
    for (name, value) in &decl.properties {
        match name.text.to_ascii_uppercase().as_str() {
            "INTERVAL" => {
                let mut c = Checker::constant(cx, None);
                let expr = c.value(value, Types::elem(Elem::Time));
                if expr.ty == Types::ERROR {
                    continue;
                }
                match c.cx.eval(&expr, crate::consts::Reads::Constants) {
                    Ok(raw) if (raw as i64) > 0 => task.interval_ns = Some(raw as i64),
                    Ok(0) => {}
                    Ok(_) => c.report(Diagnostic::new(codes::BAD_TASK, value.span, "an INTERVAL is not negative")),
                    Err(why) => c.not_constant(why, crate::consts::Reads::Constants),
                }
            }
            "PRIORITY" => match Checker::constant(cx, None).const_integer(value) {
                Some(p) if (0..=i128::from(u32::MAX - 1)).contains(&p) => task.priority = p as u32,
                Some(_) => cx.push(
                    Diagnostic::new(codes::BAD_TASK, value.span, "a PRIORITY is 0 or greater").help("0 is the highest"),
                ),
                None => {}
            },
            "SINGLE" => task.single = crate::var_config::single(cx, value),
            _ => {
                let hint = similar(&name.text, ["INTERVAL", "PRIORITY", "SINGLE"].into_iter());
                cx.push(
                    Diagnostic::new(codes::BAD_TASK, name.span, format!("a TASK has no property `{}`", name.text))
                        .help(
                            hint.map_or("it has INTERVAL, PRIORITY and SINGLE".into(), |h| {
                                format!("did you mean `{h}`?")
                            }),
                        ),
                );
            }
        }
    }
    task
}

fn program<'a>(cx: &mut Cx<'a>, decl: &'a ast::ProgramDecl, task: usize) -> Option<Program> {
    let pou = match cx.pous.get(&fold(&decl.program.text)) {
        Some(pou) if cx.defs.pous[*pou].kind == PouKind::Program => *pou,
        _ => {
            let programs = cx.defs.pous.iter().filter(|p| p.kind == PouKind::Program);
            let hint = similar(&decl.program.text, programs.map(|p| p.name.as_str()));
            cx.push(
                Diagnostic::new(
                    codes::UNKNOWN_PROGRAM,
                    decl.program.span,
                    format!("there is no PROGRAM `{}`", decl.program.text),
                )
                .help_if(hint.map(|h| format!("did you mean `{h}`?"))),
            );
            return None;
        }
    };
    if let Some((fb, _)) = decl.fb_tasks.first() {
        cx.push(Diagnostic::new(
            codes::NOT_YET,
            fb.span,
            "a task for a function block instance is not implemented yet",
        ));
    }
    let mut program = Program {
        name: decl.name.text.clone(),
        pou,
        task,
        inputs: Vec::new(),
        outputs: Vec::new(),
        located: Vec::new(),
        initial: Vec::new(),
        span: decl.name.span,
    };
    for arg in &decl.args {
        connection(cx, pou, arg, &mut program);
    }
    Some(program)
}

/// `in := g`, `out => h`: copied before and after each execution.
fn connection<'a>(cx: &mut Cx<'a>, pou: PouId, arg: &'a ast::Arg, program: &mut Program) {
    let (name, is_output) = match &arg.kind {
        ast::ArgKind::Positional(_) => {
            cx.push(
                Diagnostic::new(codes::UNKNOWN_PARAMETER, arg.span, "connections of a program have names")
                    .help("write `input := variable` or `output => variable`"),
            );
            return;
        }
        ast::ArgKind::Input(name, _) => (name, false),
        ast::ArgKind::Output { name, .. } => (name, true),
    };
    let found = match cx.pou_slots[pou].scope.get(&fold(&name.text)) {
        Some(Local::Var(var)) => Some(*var),
        _ => None,
    };
    let wanted = if is_output { Section::Output } else { Section::Input };
    let Some(var) = found.filter(|v| cx.defs.vars[*v].section == wanted) else {
        if !is_output && found.is_some_and(|v| cx.defs.vars[v].section == Section::Output) {
            let help = format!("fetch it with `{} => variable`", name.text);
            let message = format!("`{}` is an output", name.text);
            cx.push(Diagnostic::new(codes::WRONG_DIRECTION, name.span, message).help(help));
            return;
        }
        let names = cx.defs.pous[pou].vars.iter().map(|v| &cx.defs.vars[*v]).filter(|v| v.section == wanted);
        let hint = similar(&name.text, names.map(|v| v.name.as_str()));
        let what = if is_output { "output" } else { "input" };
        let message = format!("`{}` has no {what} `{}`", cx.defs.pous[pou].name, name.text);
        cx.push(
            Diagnostic::new(codes::UNKNOWN_PARAMETER, name.span, message)
                .help_if(hint.map(|h| format!("did you mean `{h}`?"))),
        );
        return;
    };
    cx.var_type(var);
    let ty = cx.defs.vars[var].ty;
    match &arg.kind {
        ast::ArgKind::Input(_, Some(e)) => {
            let value = Checker::constant(cx, None).value(e, ty);
            if value.ty != Types::ERROR {
                program.inputs.push((var, value));
            }
        }
        ast::ArgKind::Output { target: Some(e), .. } => {
            let mut c = Checker::constant(cx, None);
            let Some(place) = c.place(e) else { return };
            if c.check_writable(&place) && output_fits(c.cx, ty, &place) {
                program.outputs.push((var, place));
            }
        }
        _ => {}
    }
}

/// An output goes to a variable of its own type; there is no place for a conversion in a connection.
fn output_fits(cx: &mut Cx, ty: TypeId, place: &Place) -> bool {
    if ty == place.ty || ty == Types::ERROR {
        return ty != Types::ERROR;
    }
    let same = match (cx.elem_of(ty), cx.elem_of(place.ty)) {
        (Some(a), Some(b)) => {
            rules::implicit(a, b) == Implicit::Same && !matches!(cx.defs.types.get(ty), Type::Enum(_))
        }
        _ => false,
    };
    if same {
        return true;
    }
    let mut d = Diagnostic::new(
        codes::TYPE_MISMATCH,
        place.span,
        format!("the output is {}, this variable is {}", cx.type_name(ty), cx.type_name(place.ty)),
    );
    if let (Some(a), Some(b)) = (cx.elem_of(ty), cx.elem_of(place.ty)) {
        d = d.help(conversion_help(a, b));
    }
    cx.push(d);
    false
}
