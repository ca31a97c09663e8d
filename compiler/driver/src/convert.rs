//! `plcc convert FILE.xml --to st`: PLCopen XML as text. What is written are the trees that the compiler runs, after `hir::network`
//! has made statements of networks, so both compile to the same code. Bodies that were text stay as they were written.

use crate::cli::{Color, ConvertArgs};
use crate::failure::Failure;
use crate::pipeline::{self, Parsed};
use crate::project;
use plcc_diag::{Diagnostics, SourceMap, Span};
use plcc_hir::Checked;
use plcc_syntax::ast::{self, Body, Condition, Item, SfcElement};
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Comments that are drawn in networks, by the place of what holds the body.
type Remarks = HashMap<Span, Vec<String>>;

/// Writes the XML files of the command line as text.
pub fn convert(args: &ConvertArgs, color: Color) -> Result<u8, Failure> {
    let crate::cli::ToArg::St = args.to;
    let (project, sources, ids) = pipeline::load(&args.sources)?;
    let mut parsed = pipeline::parse(sources, &ids);
    let remarks = remarks(&parsed);
    let checked = pipeline::check(&mut parsed, &project);
    crate::report(&parsed, Some(&checked), args.sources.message_format, color)?;
    let mut text = String::new();
    for (id, _, builtin, file) in &parsed.files {
        let name = &parsed.sources.file(*id).name;
        if !*builtin && project::is_xml(Path::new(name)) {
            text.push_str(&write(file, name, &parsed.sources, &checked, &remarks));
        }
    }
    if text.is_empty() {
        return Err(Failure::usage("there is no PLCopen XML file to convert"));
    }
    crate::graph::write(&text, args.output.as_deref())?;
    Ok(0)
}

fn remarks(parsed: &Parsed) -> Remarks {
    let mut found = HashMap::new();
    let pous = parsed.files.iter().flat_map(|f| &f.3.items).filter_map(|i| match i {
        Item::Pou(pou) => Some(pou),
        _ => None,
    });
    for pou in pous {
        let bodies = std::iter::once((pou.span, &pou.body)).chain(pou.actions.iter().map(|a| (a.span, &a.body)));
        for (span, body) in bodies {
            let Body::Network(network) = body else { continue };
            let comments = network.elements.iter().filter_map(|e| match &e.kind {
                ast::ElementKind::Comment(text) if !text.is_empty() => Some(text.clone()),
                _ => None,
            });
            found.insert(span, comments.collect());
        }
    }
    found
}

fn write(file: &ast::File, name: &str, sources: &SourceMap, checked: &Checked, remarks: &Remarks) -> String {
    let mut out = format!("// {}, from PLCopen XML\n", Path::new(name).file_name().unwrap_or_default().display());
    for item in &file.items {
        out.push('\n');
        let Item::Pou(pou) = item else {
            out.push_str(&ast::source::item(item, &Words::default()));
            continue;
        };
        let mut pou = pou.clone();
        let mut words = Words {
            names: HashMap::new(),
            types: types(checked, &pou.name.text),
            bodies: Some((file, sources, remarks)),
        };
        words.give_names(&pou);
        evaluate_in_actions(&mut pou, &mut words);
        out.push_str(&ast::source::pou(&pou, &words));
    }
    out
}

/// The types of the hidden variables of a POU.
fn types(checked: &Checked, pou: &str) -> HashMap<String, String> {
    let defs = &checked.defs;
    let Some(pou) = defs.pous.iter().find(|p| p.owner.is_none() && !p.builtin && p.name.eq_ignore_ascii_case(pou))
    else {
        return HashMap::new();
    };
    let vars = pou.vars.iter().map(|v| &defs.vars[*v]).filter(|v| v.is_hidden());
    vars.map(|v| (v.name.to_string(), plcc_hir::type_name(defs, v.ty))).collect()
}

/// What a tree alone does not say (see [`ast::source::Texts`]).
#[derive(Default)]
struct Words<'a> {
    /// Names that users can write, for hidden ones.
    names: HashMap<String, String>,
    /// Types of hidden variables.
    types: HashMap<String, String>,
    /// The file, to find bodies as they were written, and remarks.
    bodies: Option<(&'a ast::File, &'a SourceMap, &'a Remarks)>,
}

impl Words<'_> {
    /// Hidden names become names of their own: `$ADD5` is `_ADD5`.
    fn give_names(&mut self, pou: &ast::Pou) {
        let declared = pou.sections.iter().flat_map(|s| &s.vars).flat_map(|v| &v.names);
        let others = pou.actions.iter().map(|a| &a.name).chain([&pou.name]);
        let all: Vec<&str> = declared.chain(others).map(|n| n.text.as_str()).collect();
        let mut taken: HashSet<String> = all.iter().map(|n| n.to_ascii_uppercase()).collect();
        for name in all.into_iter().filter(|n| n.starts_with('$')) {
            let given = free(&format!("_{}", &name[1..]), &mut taken);
            self.names.insert(name.to_string(), given);
        }
    }
}

/// A name near to `wish` that is not taken.
fn free(wish: &str, taken: &mut HashSet<String>) -> String {
    let mut name = wish.to_string();
    let mut number = 1;
    while !taken.insert(name.to_ascii_uppercase()) {
        number += 1;
        name = format!("{wish}_{number}");
    }
    name
}

impl ast::source::Texts for Words<'_> {
    fn name(&self, name: &str) -> String {
        self.names.get(name).cloned().unwrap_or_else(|| name.to_string())
    }

    fn inferred(&self, variable: &ast::Name) -> String {
        self.types.get(variable.text.as_str()).cloned().unwrap_or_else(|| "BOOL".into())
    }

    fn written(&self, _: Span, body: &Body) -> Option<String> {
        let (file, sources, _) = self.bodies?;
        let inside = match body {
            Body::St(statements) => statements.first()?.span,
            Body::Il(il) => il.span,
            Body::Sfc(_) | Body::Network(_) => return None,
        };
        let holds = |p: &&ast::Place| p.text && p.span.start <= inside.start && inside.end <= p.span.end;
        let place = file.places.iter().find(holds)?;
        let text = plcc_syntax::plain_text(sources.text(place.span)).trim().to_string();
        // It must mean the same between the words of a POU.
        let mut diags = Diagnostics::new();
        let (read, actions) = plcc_syntax::parse_body(place.span.file, &text, Default::default(), &mut diags);
        let same = matches!((&read, body), (Body::St(_), Body::St(_)) | (Body::Il(_), Body::Il(_)));
        (same && actions.is_empty() && !diags.has_errors()).then_some(text)
    }

    fn remarks(&self, holder: Span) -> Vec<String> {
        self.bodies.and_then(|(_, _, remarks)| remarks.get(&holder)).cloned().unwrap_or_default()
    }
}

/// A condition that consists of statements has no form in text: an action of the step before it evaluates them, last of all
/// actions, while all steps before the transition are active.
fn evaluate_in_actions(pou: &mut ast::Pou, words: &mut Words) {
    let mut taken: HashSet<String> = pou
        .sections
        .iter()
        .flat_map(|s| &s.vars)
        .flat_map(|v| &v.names)
        .map(|n| &n.text)
        .chain(pou.actions.iter().map(|a| &a.name.text))
        .map(|n| n.to_ascii_uppercase())
        .chain(words.names.values().map(|n| n.to_ascii_uppercase()))
        .collect();
    let mut flags = Vec::new();
    let mut actions = Vec::new();
    let bodies = std::iter::once(&mut pou.body).chain(pou.actions.iter_mut().map(|a| &mut a.body));
    for body in bodies {
        let Body::Sfc(chart) = body else { continue };
        let mut calls = Vec::new();
        for element in &mut chart.elements {
            let SfcElement::Transition(transition) = element else { continue };
            let span = transition.span;
            let Condition::Steps(statements, value) = &transition.condition else { continue };
            let name = |text: String| ast::Name { text: text.into(), span };
            let read =
                |name: &ast::Name| ast::Expr { kind: ast::ExprKind::Name(name.clone()), span, depth: 1, parens: false };
            let steps = &transition.from;
            let from = steps.first().map_or("Start", |s| s.text.as_str());
            let flag = name(free(&format!("_{from}_left"), &mut taken));
            let action = name(free(&format!("_{from}_evaluate"), &mut taken));
            let mut inside = statements.clone();
            inside.push(ast::Stmt { kind: ast::StmtKind::Assign(read(&flag), value.clone()), span });
            let active = steps.iter().skip(1).map(|step| ast::Expr {
                kind: ast::ExprKind::Member(Box::new(read(step)), name("X".into())),
                span,
                depth: 2,
                parens: false,
            });
            let and = |a: ast::Expr, b: ast::Expr| ast::Expr {
                depth: a.depth.max(b.depth) + 1,
                kind: ast::ExprKind::Binary(ast::BinaryOp::And, span, Box::new(a), Box::new(b)),
                span,
                parens: false,
            };
            if let Some(active) = active.reduce(and) {
                let kind = ast::StmtKind::If { arms: vec![(active, inside)], otherwise: None };
                inside = vec![ast::Stmt { kind, span }];
            }
            calls.push((steps.first().map(|s| s.text.clone()), read(&action)));
            actions.push(ast::Action { owner: None, name: action, body: Body::St(inside), span });
            transition.condition = Condition::St(read(&flag));
            flags.push(flag);
        }
        for (step, action) in calls {
            let same = |s: &ast::Step| step.as_ref().is_some_and(|n| n.eq_ignore_ascii_case(&s.name.text));
            for element in &mut chart.elements {
                if let SfcElement::Step(found) = element
                    && same(found)
                {
                    let span = action.span;
                    found.actions.push(ast::ActionAssociation {
                        action: action.clone(),
                        qualifier: None,
                        time: None,
                        indicators: Vec::new(),
                        span,
                    });
                }
            }
        }
    }
    pou.actions.append(&mut actions);
    if let Some(first) = flags.first() {
        let span = first.span;
        let ty = ast::TypeExprKind::Named(ast::Name { text: "BOOL".into(), span });
        let ty = ast::TypeExpr { kind: ty, span, depth: 1 };
        let decl = ast::VarDecl {
            names: flags,
            path: Vec::new(),
            at: None,
            ty,
            edge: None,
            read_write: None,
            init: None,
            span,
        };
        pou.sections.push(ast::VarSection {
            kind: ast::SectionKind::Var,
            qualifiers: Vec::new(),
            vars: vec![decl],
            span,
        });
    }
}
