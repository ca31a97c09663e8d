//! Edge inputs (Ed. 3 table 14, semantics.md \[S7\] \[B2\]): a VAR_INPUT `x : BOOL R_EDGE` works as if an R_TRIG that is fed by
//! the input stood at the start of the body, and F_EDGE as an F_TRIG.
//!
//! Each such input gets two hidden variables: the memory of the trigger and its output, the pulse. Inside the POU the name
//! of the input means the pulse, from outside the input. The trigger runs first in each execution of the body, in whatever
//! notation that is written: so edges are between calls, and a call with EN FALSE is none.

use crate::body::*;
use crate::collect::new_var;
use crate::cx::*;
use crate::defs::*;
use crate::init::Init;
use crate::types::Types;
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::Elem;
use plcc_stdlib::ops::Op;
use plcc_syntax::ast::Edge;

/// What belongs to an edge input.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeInput {
    edge: Edge,
    /// What the trigger remembers.
    memory: VarId,
    /// TRUE in the call that saw the edge.
    pub pulse: VarId,
    /// The word R_EDGE or F_EDGE.
    span: Span,
}

/// Adds the hidden variables of an input that is declared with an edge.
pub(crate) fn declare(cx: &mut Cx<'_>, input: VarId, edge: Edge, span: Span) {
    let Some(owner) = cx.defs.vars[input].owner else { return };
    let stateful = matches!(cx.defs.pous[owner].kind, PouKind::FunctionBlock | PouKind::Program);
    if cx.defs.vars[input].section != Section::Input || !stateful {
        let message = format!("only a VAR_INPUT of a FUNCTION_BLOCK or PROGRAM can be {}", word(edge));
        let help = format!("use an instance of {} instead", trigger(edge));
        return cx.push(Diagnostic::new(codes::BAD_EDGE, span, message).help(help));
    }
    let memory = hidden(cx, input, "memory");
    let pulse = hidden(cx, input, "edge");
    cx.edges.insert(input, EdgeInput { edge, memory, pulse, span });
}

/// Reports edge inputs that are not BOOL; types are known by now.
pub(crate) fn check_types(cx: &mut Cx<'_>) {
    let mut inputs: Vec<VarId> = cx.edges.keys().copied().collect();
    inputs.sort();
    for input in inputs {
        let ty = cx.defs.vars[input].ty;
        if ty == Types::ERROR || cx.elem_of(ty) == Some(Elem::Bool) {
            continue;
        }
        let Some(EdgeInput { edge, span, .. }) = cx.edges.remove(&input) else { continue };
        let message = format!("{} needs a BOOL, `{}` is {}", word(edge), cx.defs.vars[input].name, cx.type_name(ty));
        cx.push(Diagnostic::new(codes::BAD_EDGE, span, message).help("declare the input as BOOL"));
    }
}

/// The triggers of a POU, to stand in front of its body.
pub(crate) fn triggers(cx: &Cx<'_>, pou: PouId) -> Vec<Stmt> {
    if cx.edges.is_empty() {
        return Vec::new();
    }
    let inputs = cx.defs.pous[pou].vars.iter().filter_map(|v| cx.edges.get(v).map(|e| (*v, *e)));
    inputs.flat_map(|(input, edge)| trigger_statements(input, edge)).collect()
}

/// `pulse := level AND NOT memory; memory := level;` where the level of F_EDGE is `NOT input`.
fn trigger_statements(input: VarId, EdgeInput { edge, memory, pulse, span }: EdgeInput) -> [Stmt; 2] {
    let ty = Types::elem(Elem::Bool);
    let place = |var| Place { root: Root::Var(var), steps: Vec::new(), ty, span };
    let read = |var| Expr { kind: ExprKind::Read(place(var)), ty, span };
    let op = |op, args| Expr { kind: ExprKind::Op(op, Elem::Bool, args), ty, span };
    let assign = |var, value| Stmt { kind: StmtKind::Assign { target: place(var), value }, span };
    let level = || match edge {
        Edge::Rising => read(input),
        Edge::Falling => op(Op::Not, vec![read(input)]),
    };
    let fresh = op(Op::Not, vec![read(memory)]);
    [assign(pulse, op(Op::And, vec![level(), fresh])), assign(memory, level())]
}

fn hidden(cx: &mut Cx<'_>, input: VarId, what: &str) -> VarId {
    let Var { name, owner, retain, span, .. } = cx.defs.vars[input].clone();
    let var = new_var(cx, format!("${name} {what}").into(), span, Section::Local, owner, None);
    cx.defs.vars[var].ty = Types::elem(Elem::Bool);
    cx.defs.vars[var].retain = retain;
    cx.var_slots[var].ty = State::Done(Init::Default);
    if let Some(owner) = owner {
        cx.defs.pous[owner].vars.push(var);
    }
    var
}

/// The word of the declaration.
pub(crate) fn word(edge: Edge) -> &'static str {
    match edge {
        Edge::Rising => "R_EDGE",
        Edge::Falling => "F_EDGE",
    }
}

fn trigger(edge: Edge) -> &'static str {
    match edge {
        Edge::Rising => "R_TRIG",
        Edge::Falling => "F_TRIG",
    }
}
