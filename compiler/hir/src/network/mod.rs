//! Ladder Diagram and Function Block Diagram to Structured Text, before names and types are looked at.
//!
//! In: the trees of all files, with networks as they were drawn. Out: the same trees, where each network has become
//! statements that the checker of Structured Text reads, and that `plcc convert` prints. So there is one checker, and what
//! users read is what runs. The statements carry the places of the elements they come from.
//!
//! `links` resolves connections, `order` says which element is evaluated when, `write` makes the statements, `expr` their
//! parts. What a network needs besides its POU's variables is declared in the POU: `VAR_TEMP`s for values that are used several
//! times, `R_TRIG` and `F_TRIG` instances for edges, variables for values that a loop brings to the next cycle. Their names
//! begin with `$`, their types are those of the values (`TypeExprKind::Inferred`) where the drawing does not say them.
//!
//! # The order of evaluation (semantics.md \[X1\])
//! An element is evaluated once in a cycle, after what it is connected to, and all its consumers get that value. Elements with
//! an `executionOrderId` come first, in the order of these numbers. Others follow by networks (sets of connected elements,
//! power rails aside) from top to bottom, in a network the elements that do something (blocks of function blocks, coils,
//! variables that are written, jumps) from top to bottom, then from left to right.
//!
//! A connection that leads back gives the value of the cycle before (at first the initial value), and a hint says so. A loop
//! without `executionOrderId`s is broken behind a function block if there is one in it, whose outputs are variables anyway,
//! else behind its rightmost element.

mod expr;
mod links;
mod order;
mod write;

use plcc_diag::{Diagnostics, Span};
use plcc_syntax::ast::{self, Body, Condition, Item, SfcElement};
use rustc_hash::{FxHashMap, FxHashSet};

/// Replaces the networks of all files by statements.
pub fn lower(files: &mut [&mut ast::File], diags: &mut Diagnostics) {
    let drawn = |file: &ast::File| file.items.iter().any(|i| matches!(i, Item::Pou(pou) if has_networks(pou)));
    if !files.iter().any(|f| drawn(f)) {
        return;
    }
    let pous = UserPous::of(files);
    for file in files {
        for item in &mut file.items {
            if let Item::Pou(pou) = item
                && has_networks(pou)
            {
                lower_pou(pou, &pous, diags);
            }
        }
    }
}

/// What users declare, as far as the meaning of a block depends on it. Names are in upper case.
struct UserPous {
    functions: FxHashMap<String, UserFunction>,
    blocks: FxHashSet<String>,
}

struct UserFunction {
    /// VAR_OUTPUTs with their types.
    outputs: Vec<(String, ast::TypeExpr)>,
    result: Option<ast::TypeExpr>,
}

impl UserPous {
    fn of(files: &[&mut ast::File]) -> Self {
        let mut found = UserPous { functions: FxHashMap::default(), blocks: FxHashSet::default() };
        for item in files.iter().flat_map(|f| &f.items) {
            let Item::Pou(pou) = item else { continue };
            let key = pou.name.text.to_ascii_uppercase();
            match pou.kind {
                ast::PouKind::Function => {
                    let sections = pou.sections.iter().filter(|s| s.kind == ast::SectionKind::Output);
                    let outputs = sections.flat_map(|s| &s.vars);
                    let outputs =
                        outputs.flat_map(|v| v.names.iter().map(|n| (n.text.to_ascii_uppercase(), v.ty.clone())));
                    let function = UserFunction { outputs: outputs.collect(), result: pou.result.clone() };
                    found.functions.insert(key, function);
                }
                ast::PouKind::FunctionBlock => {
                    found.blocks.insert(key);
                }
                ast::PouKind::Program => {}
            }
        }
        found
    }
}

fn has_networks(pou: &ast::Pou) -> bool {
    let bodies = std::iter::once(&pou.body).chain(pou.actions.iter().map(|a| &a.body));
    bodies.into_iter().any(|body| match body {
        Body::Network(_) => true,
        Body::Sfc(chart) => chart
            .elements
            .iter()
            .any(|e| matches!(e, SfcElement::Transition(ast::Transition { condition: Condition::Network(_), .. }))),
        Body::St(_) | Body::Il(_) => false,
    })
}

fn lower_pou(pou: &mut ast::Pou, user: &UserPous, diags: &mut Diagnostics) {
    let declared = pou.sections.iter().filter(|s| s.kind != ast::SectionKind::External);
    let locals = declared.flat_map(|s| &s.vars).flat_map(|v| &v.names).map(|n| n.text.to_ascii_uppercase());
    let mut owner = Owner {
        user,
        memory: pou.kind != ast::PouKind::Function,
        locals: locals.collect(),
        declared: Declared::default(),
        taken: FxHashSet::default(),
    };
    let bodies = std::iter::once(&mut pou.body).chain(pou.actions.iter_mut().map(|a| &mut a.body));
    for body in bodies {
        match body {
            Body::Network(network) => {
                let (statements, _) = write::statements(network, &mut owner, diags);
                *body = Body::St(statements);
            }
            Body::Sfc(chart) => {
                for element in &mut chart.elements {
                    let SfcElement::Transition(transition) = element else { continue };
                    let Condition::Network(network) = &transition.condition else { continue };
                    let (statements, value) = write::statements(network, &mut owner, diags);
                    let value = value.unwrap_or_else(|| expr::error(transition.span));
                    transition.condition = match statements.is_empty() {
                        true => Condition::St(value),
                        false => Condition::Steps(statements, value),
                    };
                }
            }
            Body::St(_) | Body::Il(_) => {}
        }
    }
    let span = pou.name.span.after();
    let Declared { temps, kept } = owner.declared;
    for (kind, vars) in [(ast::SectionKind::Var, kept), (ast::SectionKind::Temp, temps)] {
        if !vars.is_empty() {
            pou.sections.push(ast::VarSection { kind, qualifiers: Vec::new(), vars, span });
        }
    }
}

/// The POU that a network belongs to.
struct Owner<'u> {
    user: &'u UserPous,
    /// It remembers variables from one call to the next.
    memory: bool,
    /// Its own variables, in upper case.
    locals: FxHashSet<String>,
    declared: Declared,
    /// Names that were given, without their `$`.
    taken: FxHashSet<String>,
}

/// What its networks need.
#[derive(Default)]
struct Declared {
    temps: Vec<ast::VarDecl>,
    kept: Vec<ast::VarDecl>,
}

impl Owner<'_> {
    /// A name that nothing else has, near to `wish`.
    fn fresh(&mut self, wish: &str) -> smol_str::SmolStr {
        let mut name = format!("${wish}");
        let mut number = 1;
        while !self.taken.insert(name.to_ascii_uppercase()) {
            number += 1;
            name = format!("${wish}_{number}");
        }
        name.into()
    }

    /// Declares a variable; `kept` from one cycle to the next, else for one.
    fn declare(&mut self, wish: &str, ty: ast::TypeExprKind, kept: bool, span: Span) -> ast::Name {
        let name = ast::Name { text: self.fresh(wish), span };
        let decl = ast::VarDecl {
            names: vec![name.clone()],
            path: Vec::new(),
            at: None,
            ty: ast::TypeExpr { kind: ty, span, depth: 1 },
            edge: None,
            read_write: None,
            init: None,
            span,
        };
        match kept {
            true => self.declared.kept.push(decl),
            false => self.declared.temps.push(decl),
        }
        name
    }
}
