//! What may not contain or call itself: function blocks by value, and any chain of calls (semantics.md \[E5\]).

use crate::body::*;
use crate::cx::Cx;
use crate::defs::*;
use crate::types::{Type, TypeId, Types};
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
    for stmt in stmts {
        match &stmt.kind {
            StmtKind::Assign { target, value } => {
                in_place(target, out);
                in_expr(value, out);
            }
            StmtKind::Call(call) => in_call(call, out),
            StmtKind::Eval(e) => in_expr(e, out),
            StmtKind::If { arms, otherwise } => {
                for (cond, body) in arms {
                    in_expr(cond, out);
                    calls_of(body, out);
                }
                calls_of(otherwise, out);
            }
            StmtKind::Case { selector, arms, otherwise } => {
                in_expr(selector, out);
                arms.iter().for_each(|a| calls_of(&a.body, out));
                calls_of(otherwise, out);
            }
            StmtKind::For { var, from, to, by, body } => {
                in_place(var, out);
                [from, to].into_iter().chain(by).for_each(|e| in_expr(e, out));
                calls_of(body, out);
            }
            StmtKind::While(cond, body) | StmtKind::Repeat(body, cond) => {
                in_expr(cond, out);
                calls_of(body, out);
            }
            StmtKind::Jump(_, Some(cond)) => in_expr(cond, out),
            StmtKind::Exit | StmtKind::Continue | StmtKind::Return | StmtKind::Label(_) | StmtKind::Jump(_, None) => {}
        }
    }
}

fn in_call(call: &Call, out: &mut Vec<(PouId, Span)>) {
    match &call.callee {
        Callee::Function(pou) => out.push((*pou, call.span)),
        Callee::Instance(place, pou) => {
            in_place(place, out);
            out.push((*pou, call.span));
        }
        Callee::Action(place, pou) => {
            place.iter().for_each(|p| in_place(p, out));
            out.push((*pou, call.span));
        }
    }
    call.inputs.iter().for_each(|(_, e)| in_expr(e, out));
    call.in_outs.iter().for_each(|(_, p)| in_place(p, out));
    call.outputs.iter().for_each(|o| in_place(&o.target, out));
    call.en.iter().for_each(|e| in_expr(e, out));
    call.eno.iter().for_each(|p| in_place(p, out));
}

fn in_place(place: &Place, out: &mut Vec<(PouId, Span)>) {
    if let Root::Deref(e) = &place.root {
        in_expr(e, out);
    }
    for step in &place.steps {
        if let Step::Index(indices, _) = step {
            indices.iter().for_each(|e| in_expr(e, out));
        }
    }
}

fn in_expr(e: &Expr, out: &mut Vec<(PouId, Span)>) {
    match &e.kind {
        ExprKind::Read(place) | ExprKind::RefOf(place) => in_place(place, out),
        ExprKind::Op(_, _, args) | ExprKind::Std { args, .. } => args.iter().for_each(|a| in_expr(a, out)),
        ExprKind::AndThen(a, b) | ExprKind::OrElse(a, b) => {
            in_expr(a, out);
            in_expr(b, out);
        }
        ExprKind::Convert(_, _, inner) | ExprKind::Retype(inner) => in_expr(inner, out),
        ExprKind::RangeCheck { value, .. } => in_expr(value, out),
        ExprKind::Call(call) => in_call(call, out),
        ExprKind::StdCall(call) => {
            call.en.iter().chain(call.arguments.iter().map(|(_, e)| e)).for_each(|e| in_expr(e, out));
            call.outputs.iter().map(|(place, _)| place).chain(&call.eno).for_each(|p| in_place(p, out));
        }
        ExprKind::Choose { selector, choices } => {
            in_expr(selector, out);
            choices.iter().for_each(|e| in_expr(e, out));
        }
        ExprKind::Const(_) | ExprKind::String(_) | ExprKind::WString(_) | ExprKind::Temp(_) | ExprKind::Error => {}
    }
}
