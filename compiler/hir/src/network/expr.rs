//! The parts of statements.

use plcc_diag::Span;
use plcc_syntax::ast::*;

pub(super) fn node(kind: ExprKind, depth: u32, span: Span) -> Expr {
    Expr { kind, span, depth: depth + 1, parens: false }
}

/// What was reported.
pub(super) fn error(span: Span) -> Expr {
    node(ExprKind::Error, 0, span)
}

pub(super) fn variable(name: &Name, span: Span) -> Expr {
    node(ExprKind::Name(Name { text: name.text.clone(), span }), 0, span)
}

pub(super) fn constant(value: bool, span: Span) -> Expr {
    let text = if value { "TRUE" } else { "FALSE" };
    node(ExprKind::Literal(Literal { kind: LiteralKind::Bool, prefix: None, text: text.into() }), 0, span)
}

pub(super) fn is_true(e: &Expr) -> bool {
    matches!(&e.kind, ExprKind::Literal(l) if l.kind == LiteralKind::Bool && l.prefix.is_none() && l.text == "TRUE")
}

pub(super) fn member(base: Expr, name: &str, span: Span) -> Expr {
    let depth = base.depth;
    let member = Name { text: name.into(), span };
    node(ExprKind::Member(Box::new(base), member), depth, span)
}

/// NOT, without doubling it.
pub(super) fn not(e: Expr, span: Span) -> Expr {
    match e.kind {
        ExprKind::Unary(UnaryOp::Not, inner) => *inner,
        _ => {
            let depth = e.depth;
            node(ExprKind::Unary(UnaryOp::Not, Box::new(e)), depth, span)
        }
    }
}

pub(super) fn binary(op: BinaryOp, a: Expr, b: Expr, span: Span) -> Expr {
    let depth = a.depth.max(b.depth);
    node(ExprKind::Binary(op, span, Box::new(a), Box::new(b)), depth, span)
}

/// Power through two elements one after the other.
pub(super) fn and(a: Expr, b: Expr, span: Span) -> Expr {
    if is_true(&a) { b } else { binary(BinaryOp::And, a, b, span) }
}

/// Power from several lines.
pub(super) fn or(list: Vec<Expr>, span: Span) -> Option<Expr> {
    if let Some(on) = list.iter().find(|e| is_true(e)) {
        return Some(on.clone());
    }
    list.into_iter().reduce(|a, b| binary(BinaryOp::Or, a, b, span))
}

pub(super) fn call(callee: Expr, args: Vec<Arg>, span: Span) -> Expr {
    let depths = args.iter().map(|a| match &a.kind {
        ArgKind::Positional(e) | ArgKind::Input(_, Some(e)) | ArgKind::Output { target: Some(e), .. } => e.depth,
        ArgKind::Input(_, None) | ArgKind::Output { target: None, .. } => 0,
    });
    let depth = depths.fold(callee.depth, u32::max);
    node(ExprKind::Call(Box::new(Call { callee, args, parens: span })), depth, span)
}

pub(super) fn positional(e: Expr, span: Span) -> Arg {
    Arg { kind: ArgKind::Positional(e), span }
}

pub(super) fn input(name: &str, e: Expr, span: Span) -> Arg {
    Arg { kind: ArgKind::Input(Name { text: name.into(), span }, Some(e)), span }
}

pub(super) fn output(name: &str, target: Expr, span: Span) -> Arg {
    let name = Name { text: name.into(), span };
    Arg { kind: ArgKind::Output { negated: false, name, target: Some(target) }, span }
}

pub(super) fn assign(target: Expr, value: Expr, span: Span) -> Stmt {
    Stmt { kind: StmtKind::Assign(target, value), span }
}

pub(super) fn only_if(condition: Expr, statement: Stmt) -> Stmt {
    let span = statement.span;
    if is_true(&condition) {
        return statement;
    }
    Stmt { kind: StmtKind::If { arms: vec![(condition, vec![statement])], otherwise: None }, span }
}

/// The names that an expression reads, in upper case: of a path the first; `%` for addresses.
pub(super) fn reads(e: &Expr, out: &mut Vec<String>) {
    // Bounded by `MAX_DEPTH`.
    match &e.kind {
        ExprKind::Name(name) => out.push(name.text.to_ascii_uppercase()),
        ExprKind::Address(_) => out.push("%".into()),
        ExprKind::Member(base, _) | ExprKind::Part(base, _) | ExprKind::Unary(_, base) => reads(base, out),
        ExprKind::Deref(base) => {
            // What a reference reaches may be anything.
            out.push("%".into());
            reads(base, out);
        }
        ExprKind::Index(base, indices) => {
            reads(base, out);
            indices.iter().for_each(|i| reads(i, out));
        }
        ExprKind::Binary(_, _, a, b) => {
            reads(a, out);
            reads(b, out);
        }
        ExprKind::Call(call) => {
            for arg in &call.args {
                match &arg.kind {
                    ArgKind::Positional(e) | ArgKind::Input(_, Some(e)) => reads(e, out),
                    ArgKind::Output { target: Some(e), .. } => reads(e, out),
                    ArgKind::Input(_, None) | ArgKind::Output { target: None, .. } => {}
                }
            }
        }
        ExprKind::Literal(_) | ExprKind::Qualified { .. } | ExprKind::Error => {}
    }
}
