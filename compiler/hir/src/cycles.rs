//! What may not contain or call itself: function blocks by value, and any chain of calls (semantics.md \[E5\]).

use crate::body::*;
use crate::cx::Cx;
use crate::defs::*;
use crate::types::{Type, TypeId, Types};
use crate::visit::{self, Visitor};
use plcc_diag::{Diagnostic, Span, codes};
use rustc_hash::FxHashMap;

/// Reports function blocks that contain themselves and cuts each cycle, so that later passes may recurse over instances.
pub(crate) fn containment(cx: &mut Cx) {
    let edges = |cx: &Cx, pou: PouId| -> Vec<(PouId, VarId)> {
        let vars = cx.defs.pous[pou].vars.iter().copied();
        let by_value = vars.filter(|v| cx.defs.vars[*v].section != Section::InOut);
        by_value.flat_map(|v| contained(&cx.defs, cx.defs.vars[v].ty).into_iter().map(move |p| (p, v))).collect()
    };
    let mut done: FxHashMap<PouId, bool> = FxHashMap::default();
    for root in cx.defs.pous.indices() {
        // An explicit stack: chains of blocks may be long.
        if done.contains_key(&root) {
            continue;
        }
        done.insert(root, false);
        let mut stack = vec![(root, edges(cx, root), 0)];
        while let Some((pou, list, next)) = stack.last_mut() {
            let Some(&(child, var)) = list.get(*next) else {
                done.insert(*pou, true);
                stack.pop();
                continue;
            };
            *next += 1;
            match done.get(&child) {
                Some(true) => {}
                Some(false) => {
                    let (name, span) = (cx.defs.pous[child].name.clone(), cx.defs.pous[child].span);
                    cx.push(
                        Diagnostic::new(
                            codes::CYCLIC_TYPE,
                            cx.defs.vars[var].span,
                            format!("function block `{name}` would contain itself"),
                        )
                        .also(span, "declared here")
                        .help("break the cycle with VAR_IN_OUT or REF_TO"),
                    );
                    cx.defs.vars[var].ty = Types::ERROR;
                }
                None => {
                    done.insert(child, false);
                    let children = edges(cx, child);
                    stack.push((child, children, 0));
                }
            }
        }
    }
}

/// The function blocks that a type holds by value.
fn contained(defs: &Defs, ty: TypeId) -> Vec<PouId> {
    match defs.types.get(ty) {
        Type::Instance(pou) => vec![*pou],
        Type::Array { elem, .. } => contained(defs, *elem),
        Type::Struct(id) => defs.structs[*id].fields.iter().flat_map(|f| contained(defs, f.ty)).collect(),
        _ => Vec::new(),
    }
}

/// Reports recursion through any chain of POUs.
pub(crate) fn recursion(cx: &mut Cx) {
    let calls: Vec<Vec<(PouId, Span)>> = cx
        .defs
        .pous
        .indices()
        .map(|p| {
            let mut found = Vec::new();
            if let Some(body) = cx.defs.bodies.get(p) {
                calls_of(&body.stmts, &mut found);
            }
            found
        })
        .collect();
    let mut state: Vec<u8> = vec![0; calls.len()];
    let mut reported = Vec::new();
    for root in 0..calls.len() {
        if state[root] != 0 {
            continue;
        }
        state[root] = 1;
        let mut stack = vec![(root, 0usize)];
        while let Some((pou, next)) = stack.last_mut() {
            let pou = *pou;
            let Some(&(callee, span)) = calls[pou].get(*next) else {
                state[pou] = 2;
                stack.pop();
                continue;
            };
            *next += 1;
            let callee = callee.index();
            match state[callee] {
                0 => {
                    state[callee] = 1;
                    stack.push((callee, 0));
                }
                1 => {
                    let start = stack.iter().position(|(p, _)| *p == callee).unwrap_or(0);
                    let chain: Vec<usize> = stack[start..].iter().map(|(p, _)| *p).chain([callee]).collect();
                    reported.push((chain, span));
                }
                _ => {}
            }
        }
    }
    for (chain, span) in reported {
        let names: Vec<String> = chain.iter().map(|p| format!("`{}`", cx.defs.pous[PouId::from(*p)].name)).collect();
        cx.push(
            Diagnostic::new(codes::RECURSION, span, format!("recursion: {}", names.join(" calls ")))
                .help("IEC 61131-3 forbids recursion, memory and time must be bounded; use a loop"),
        );
    }
}

/// Every call in a list of statements.
pub fn calls_of(stmts: &[Stmt], out: &mut Vec<(PouId, Span)>) {
    struct Calls<'v>(&'v mut Vec<(PouId, Span)>);
    impl Visitor for Calls<'_> {
        fn call(&mut self, call: &Call) {
            let (Callee::Function(pou) | Callee::Instance(_, pou) | Callee::Action(_, pou)) = call.callee;
            self.0.push((pou, call.span));
        }
    }
    visit::stmts(stmts, &mut Calls(out));
}
