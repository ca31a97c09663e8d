//! Instruction List (semantics.md \[I1\]..\[I3\]): a body to the same typed statements that ST becomes.
//!
//! The current result (CR) is no variable. `current` keeps it as a typed expression that was not evaluated yet, so that
//! `LD a`, `AND b`, `ST x` becomes `x := a AND b`, exactly what ST gives. It is stored in a temporary only where it is used
//! twice, where a statement could change what it reads, and where ways meet at a label.
//!
//! Stages: `lines` reads the instructions by the table of operators, `flow` finds where the current result is used, which
//! type its place asks for, and which type each label has; `instructions` and `calls` check and translate one instruction
//! after the other, `words` puts the messages of the expression checker into the terms of IL.

mod calls;
mod current;
mod flow;
mod instructions;
mod lines;
mod stn;
mod words;

use crate::body::*;
use crate::cx::Cx;
use crate::defs::PouId;
use crate::expr::{Checker, Operand, error_expr};
use crate::types::Types;
use current::{Current, Value};
use flow::{Entry, Way};
use lines::Line;
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::Elem;
use plcc_syntax::ast;

/// Checks the body of a POU or action in the scope of its POU.
pub(crate) fn check<'a>(cx: &mut Cx<'a>, scope: PouId, body: &'a ast::IlBody) -> Body {
    let mut checker = Checker { cx, scope: Some(scope), temps: Default::default() };
    let mut labels = 0;
    let (stmts, _) = translate(&mut checker, body, &mut labels, false);
    Body { stmts, temps: checker.temps, labels }
}

/// Checks the instructions of a transition: the statements to run, and the condition, which is the current result at their
/// end (\[I3\]). RET ends the instructions, not the POU. Labels are numbered on from `labels`; temporaries go to the
/// checker's.
pub(crate) fn check_condition<'a>(
    checker: &mut Checker<'_, 'a>,
    body: &'a ast::IlBody,
    labels: &mut u32,
) -> (Vec<Stmt>, Expr) {
    let (stmts, condition) = translate(checker, body, labels, true);
    (stmts, condition.unwrap_or_else(|| error_expr(body.span)))
}

/// A label of the body.
#[derive(Debug)]
struct Label {
    id: LabelId,
    /// As it is written; empty for the end of a transition.
    name: String,
    at: Span,
    /// A jump names it.
    used: bool,
    /// The current result is used behind it.
    live: bool,
    /// The type that the place asks for that uses the current result.
    want: Option<crate::types::TypeId>,
    /// What the current result is behind it.
    entry: Entry,
    /// The ways to it: the number of their line (twice that, and 1 more for the way from above), where they begin, what
    /// they bring.
    ways: Vec<(usize, Span, Way)>,
    /// How often `entry` changed.
    changes: u32,
    temp: Option<TempId>,
}

/// The translation of one body, in one round.
struct Il<'k, 'c, 'a> {
    c: &'k mut Checker<'c, 'a>,
    labels: Vec<Label>,
    /// Where the instructions of a transition end.
    end: Option<usize>,
    out: Vec<Stmt>,
    cr: Current,
    /// Results that wait outside of the open parentheses.
    open: Vec<Value>,
    /// Whether control comes here.
    reachable: bool,
    /// The first instruction there was reported.
    told_unreachable: bool,
    /// Behind the last instruction.
    body_end: Span,
    /// Where `out` ended when control did; what follows is dropped.
    dead_from: usize,
    /// The number of the instruction, not counting those in parentheses.
    at_line: usize,
    /// Labels to which ways were noted.
    touched: Vec<usize>,
}

fn translate<'a>(
    c: &mut Checker<'_, 'a>,
    body: &'a ast::IlBody,
    labels: &mut u32,
    condition: bool,
) -> (Vec<Stmt>, Option<Expr>) {
    let (mut lines, names) = lines::read(c, body);
    let mut list: Vec<Label> = Vec::with_capacity(names.len() + 1);
    let label = |n: usize, name: String, at, used| Label {
        id: LabelId::from_raw(*labels + n as u32),
        name,
        at,
        used,
        live: false,
        want: None,
        entry: Entry::Unknown,
        ways: Vec::new(),
        changes: 0,
        temp: None,
    };
    for (n, found) in names.into_iter().enumerate() {
        list.push(label(n, found.name, found.at, found.used));
    }
    let end = condition.then_some(list.len());
    if condition {
        let at = body.span.after();
        list.push(Label {
            live: true,
            want: Some(Types::elem(Elem::Bool)),
            ..label(list.len(), String::new(), at, false)
        });
    }
    *labels += list.len() as u32;
    flow::find_uses(&mut lines, &mut list, condition);
    let mut il = Il {
        c,
        labels: list,
        end,
        out: Vec::new(),
        cr: Current::Nothing,
        open: Vec::new(),
        reachable: true,
        told_unreachable: false,
        body_end: body.span.after(),
        dead_from: 0,
        at_line: 0,
        touched: Vec::new(),
    };
    il.find_entries(&lines);
    let condition = il.round(&lines);
    (il.out, condition)
}

impl<'a> Il<'_, '_, 'a> {
    /// Translates all lines with what is known of the labels. Gives the condition of a transition.
    fn round(&mut self, lines: &[Line<'a>]) -> Option<Expr> {
        self.out.clear();
        self.open.clear();
        self.cr = Current::Nothing;
        self.reachable = true;
        for label in &mut self.labels {
            label.temp = None;
        }
        self.lines(lines);
        let Some(end) = self.end else {
            self.drop_current(self.body_end);
            self.drop_unreachable();
            return None;
        };
        let at = self.labels[end].at;
        // Without a RET the instructions simply end.
        if self.labels[end].used {
            self.enter_label(end, at);
        }
        self.drop_unreachable();
        Some(self.condition_at_end(at))
    }

    /// The current result as the condition of a transition.
    fn condition_at_end(&mut self, at: Span) -> Expr {
        let Some(value) = self.take(at, "the end of a transition") else { return error_expr(at) };
        if let (Operand::Value { ty, .. }, at) = (&value.operand, value.span)
            && self.c.elem_of(*ty) != Some(Elem::Bool)
            && *ty != Types::ERROR
        {
            let name = self.c.cx.type_name(*ty);
            let message = format!("the current result is {name} at the end of this transition, it must be BOOL");
            self.c.report(Diagnostic::new(codes::CR_TYPE, at, message).help("compare it: `NE 0`"));
            return error_expr(at);
        }
        self.c.coerce(value.operand, value.span, Types::elem(Elem::Bool))
    }

    /// A statement, with what waits stored first where the statement could change it.
    fn emit(&mut self, kind: StmtKind, span: Span) {
        self.settle_open(&kind);
        self.out.push(Stmt { kind, span });
    }
}
