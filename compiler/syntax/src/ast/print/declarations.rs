//! POUs, sections, types, initial values, configurations.

use super::expressions::args;
use super::{Printer, print_expr};
use crate::ast::*;

impl Printer {
    pub(super) fn pou(&mut self, pou: &Pou) {
        let word = match pou.kind {
            PouKind::Program => "PROGRAM",
            PouKind::FunctionBlock => "FUNCTION_BLOCK",
            PouKind::Function => "FUNCTION",
        };
        let result = pou.result.as_ref().map_or(String::new(), |t| format!(" : {}", type_text(t)));
        self.block(&format!("{word} {}{result}", pou.name.text), |p| {
            for section in &pou.sections {
                p.section(section);
            }
            p.body(&pou.body);
            for action in &pou.actions {
                p.action(action);
            }
        });
    }

    pub(super) fn action(&mut self, action: &Action) {
        let owner = action.owner.as_ref().map_or(String::new(), |o| format!("{}.", o.text));
        self.block(&format!("ACTION {owner}{}", action.name.text), |p| p.body(&action.body));
    }

    pub(super) fn section(&mut self, section: &VarSection) {
        let mut head = String::from(section.kind.keyword());
        for (qualifier, _) in &section.qualifiers {
            head.push_str(&format!(" {}", qualifier_text(*qualifier)));
        }
        self.block(&head, |p| p.variables(&section.vars));
    }

    fn variables(&mut self, vars: &[VarDecl]) {
        for var in vars {
            self.variable(var);
        }
    }

    fn variable(&mut self, var: &VarDecl) {
        let mut head = var.names.iter().map(|n| n.text.as_str()).collect::<Vec<_>>().join(", ");
        if !var.path.is_empty() {
            let path: Vec<&str> = var.path.iter().map(|n| n.text.as_str()).collect();
            head.push_str(&format!(" path {}", path.join(".")));
        }
        if let Some((at, _)) = &var.at {
            head.push_str(&format!(" AT {at}"));
        }
        let mut tail = String::new();
        match var.edge {
            Some((Edge::Rising, _)) => tail.push_str(" R_EDGE"),
            Some((Edge::Falling, _)) => tail.push_str(" F_EDGE"),
            None => {}
        }
        match var.read_write {
            Some(true) => tail.push_str(" READ_WRITE"),
            Some(false) => tail.push_str(" READ_ONLY"),
            None => {}
        }
        if let Some(init) = &var.init {
            tail.push_str(&initial_text(init));
        }
        self.typed(&head, &var.ty, &tail);
    }

    pub(super) fn type_decl(&mut self, ty: &TypeDecl) {
        let init = ty.init.as_ref().map_or(String::new(), initial_text);
        self.typed(&ty.name.text, &ty.ty, &init);
    }

    /// `head : type tail`, with the fields of a structure on lines of their own.
    fn typed(&mut self, head: &str, ty: &TypeExpr, tail: &str) {
        let line = format!("{head} : {}{tail}", type_text(ty));
        match &ty.kind {
            TypeExprKind::Struct(fields) | TypeExprKind::Union(fields) => self.block(&line, |p| p.variables(fields)),
            _ => self.line(&line),
        }
    }

    pub(super) fn configuration(&mut self, config: &Configuration) {
        self.block(&format!("CONFIGURATION {}", config.name.text), |p| {
            for section in &config.sections {
                p.section(section);
            }
            for resource in &config.resources {
                p.resource(resource);
            }
        });
    }

    fn resource(&mut self, resource: &Resource) {
        let name = resource.name.as_ref().map_or("without name", |n| n.text.as_str());
        let on = resource.on.as_ref().map_or(String::new(), |n| format!(" ON {}", n.text));
        self.block(&format!("RESOURCE {name}{on}"), |p| {
            for section in &resource.sections {
                p.section(section);
            }
            for task in &resource.tasks {
                let properties: Vec<String> =
                    task.properties.iter().map(|(n, e)| format!("{} := {}", n.text, print_expr(e))).collect();
                p.line(&format!("TASK {}({})", task.name.text, properties.join(", ")));
            }
            for program in &resource.programs {
                p.program(program);
            }
        });
    }

    fn program(&mut self, program: &ProgramDecl) {
        let qualifier = program.qualifier.map_or(String::new(), |(q, _)| format!("{} ", qualifier_text(q)));
        let task = program.task.as_ref().map_or(String::new(), |t| format!(" WITH {}", t.text));
        let (name, ty) = (&program.name.text, &program.program.text);
        let mut parts = Vec::new();
        if !program.args.is_empty() {
            parts.push(args(&program.args));
        }
        parts.extend(program.fb_tasks.iter().map(|(fb, t)| format!("{} WITH {}", print_expr(fb), t.text)));
        self.line(&format!("PROGRAM {qualifier}{name}{task} : {ty}({})", parts.join(", ")));
    }
}

fn qualifier_text(qualifier: Qualifier) -> &'static str {
    match qualifier {
        Qualifier::Constant => "CONSTANT",
        Qualifier::Retain => "RETAIN",
        Qualifier::NonRetain => "NON_RETAIN",
        Qualifier::Persistent => "PERSISTENT",
        Qualifier::Access => "PUBLIC",
    }
}

fn type_text(ty: &TypeExpr) -> String {
    match &ty.kind {
        TypeExprKind::Named(name) => name.text.to_string(),
        TypeExprKind::String { wide, length } => {
            let word = if *wide { "WSTRING" } else { "STRING" };
            length.as_ref().map_or(word.to_string(), |n| format!("{word}[{}]", print_expr(n)))
        }
        TypeExprKind::Array { dims, elem } => {
            let dims: Vec<String> = dims
                .iter()
                .map(|d| match d {
                    Dim::Range(low, high) => format!("{}..{}", print_expr(low), print_expr(high)),
                    Dim::Any(_) => "*".into(),
                })
                .collect();
            format!("ARRAY [{}] OF {}", dims.join(", "), type_text(elem))
        }
        TypeExprKind::Struct(_) => "STRUCT".into(),
        TypeExprKind::Union(_) => "UNION".into(),
        TypeExprKind::Enum { base, values } => {
            let base = base.as_ref().map_or(String::new(), |b| format!("{} ", b.text));
            let values: Vec<String> = values
                .iter()
                .map(|v| match &v.value {
                    Some(e) => format!("{} := {}", v.name.text, print_expr(e)),
                    None => v.name.text.to_string(),
                })
                .collect();
            format!("{base}({})", values.join(", "))
        }
        TypeExprKind::Subrange { base, low, high } => {
            format!("{} ({}..{})", base.text, print_expr(low), print_expr(high))
        }
        TypeExprKind::Ref { kind, target } => {
            format!("{} {}", kind.keyword(), type_text(target))
        }
        TypeExprKind::Inferred(_) => "<inferred>".into(),
        TypeExprKind::Error => "<error>".into(),
    }
}

/// What stands behind the type of a declaration.
fn initial_text(init: &Init) -> String {
    format!(" {} {}", init.kind.sign(), init_text(init))
}

fn init_text(init: &Init) -> String {
    match &init.kind {
        InitKind::Expr(e) | InitKind::Reference(e) => print_expr(e),
        InitKind::Array { elems, .. } => {
            let elems: Vec<String> = elems.iter().map(elem_text).collect();
            format!("[{}]", elems.join(", "))
        }
        InitKind::Struct(fields) => {
            let fields: Vec<String> = fields.iter().map(|(n, i)| format!("{} := {}", n.text, init_text(i))).collect();
            format!("({})", fields.join(", "))
        }
    }
}

fn elem_text(elem: &InitElem) -> String {
    match elem {
        InitElem::One(init) => init_text(init),
        InitElem::Repeat(count, values) => {
            let values: Vec<String> = values.iter().map(init_text).collect();
            format!("{}({})", print_expr(count), values.join(", "))
        }
    }
}
