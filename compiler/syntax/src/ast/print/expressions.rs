//! Expressions on one line.

use crate::ast::*;

/// Appends `e` to `out`.
pub(super) fn write_expr(out: &mut String, e: &Expr) {
    match &e.kind {
        ExprKind::Literal(literal) => {
            if let Some(prefix) = &literal.prefix {
                out.push_str(&prefix.text);
                out.push('#');
            }
            out.push_str(&literal.text);
        }
        ExprKind::Name(name) => out.push_str(&name.text),
        ExprKind::Qualified { ty, value } => {
            out.push_str(&ty.text);
            out.push('#');
            out.push_str(&value.text);
        }
        ExprKind::Address(text) => out.push_str(text),
        ExprKind::Member(of, name) | ExprKind::Part(of, name) => {
            write_expr(out, of);
            out.push('.');
            out.push_str(&name.text);
        }
        ExprKind::Index(of, indices) => {
            write_expr(out, of);
            out.push('[');
            write_list(out, indices);
            out.push(']');
        }
        ExprKind::Deref(of) => {
            write_expr(out, of);
            out.push('^');
        }
        ExprKind::Call(call) => {
            write_expr(out, &call.callee);
            out.push('(');
            write_args(out, &call.args);
            out.push(')');
        }
        ExprKind::Unary(op, of) => {
            out.push_str(match op {
                UnaryOp::Neg => "-",
                UnaryOp::Plus => "+",
                UnaryOp::Not => "NOT ",
            });
            write_expr(out, of);
        }
        ExprKind::Binary(op, _, a, b) => {
            out.push('(');
            write_expr(out, a);
            out.push(' ');
            out.push_str(op.text());
            out.push(' ');
            write_expr(out, b);
            out.push(')');
        }
        ExprKind::Error => out.push_str("<error>"),
    }
}

/// Arguments separated by commas.
pub(super) fn args(list: &[Arg]) -> String {
    let mut out = String::new();
    write_args(&mut out, list);
    out
}

fn write_args(out: &mut String, list: &[Arg]) {
    for (i, arg) in list.iter().enumerate() {
        if i > 0 {
            out.push_str(", ");
        }
        match &arg.kind {
            ArgKind::Positional(e) => write_expr(out, e),
            ArgKind::Input(name, value) => {
                out.push_str(&name.text);
                out.push_str(" := ");
                value.iter().for_each(|e| write_expr(out, e));
            }
            ArgKind::Output { negated, name, target } => {
                if *negated {
                    out.push_str("NOT ");
                }
                out.push_str(&name.text);
                out.push_str(" => ");
                target.iter().for_each(|e| write_expr(out, e));
            }
        }
    }
}

fn write_list(out: &mut String, list: &[Expr]) {
    for (i, e) in list.iter().enumerate() {
        if i > 0 {
            out.push_str(", ");
        }
        write_expr(out, e);
    }
}
