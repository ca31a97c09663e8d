//! One walk over checked bodies: every statement, expression, place and call, in the order of the source.

use crate::body::*;

/// What happens to a place where it stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Use {
    /// Its value is read.
    Read,
    /// It is assigned.
    Written,
    /// Its address is taken.
    Referenced,
    /// It is connected to a VAR_IN_OUT.
    Connected,
    /// The instance that lies there is called.
    Called,
}

/// Sees what a body consists of; outer things before what is inside them.
pub trait Visitor {
    /// A statement.
    fn stmt(&mut self, _stmt: &Stmt) {}
    /// An expression.
    fn expr(&mut self, _expr: &Expr) {}
    /// A place.
    fn place(&mut self, _place: &Place, _use: Use) {}
    /// A call, of a statement or in an expression.
    fn call(&mut self, _call: &Call) {}
}

/// Walks over statements.
pub fn stmts(list: &[Stmt], v: &mut impl Visitor) {
    for s in list {
        stmt(s, v);
    }
}

fn stmt(s: &Stmt, v: &mut impl Visitor) {
    v.stmt(s);
    match &s.kind {
        StmtKind::Assign { target, value } => {
            expr(value, v);
            place(target, Use::Written, v);
        }
        StmtKind::Call(inner) => call(inner, v),
        StmtKind::Eval(value) => expr(value, v),
        StmtKind::If { arms, otherwise } => {
            for (cond, body) in arms {
                expr(cond, v);
                stmts(body, v);
            }
            stmts(otherwise, v);
        }
        StmtKind::Case { selector, arms, otherwise } => {
            expr(selector, v);
            arms.iter().for_each(|arm| stmts(&arm.body, v));
            stmts(otherwise, v);
        }
        StmtKind::For { var, from, to, by, body } => {
            [from, to].into_iter().chain(by).for_each(|e| expr(e, v));
            place(var, Use::Written, v);
            stmts(body, v);
        }
        StmtKind::While(cond, body) => {
            expr(cond, v);
            stmts(body, v);
        }
        StmtKind::Repeat(body, cond) => {
            stmts(body, v);
            expr(cond, v);
        }
        StmtKind::Jump(_, cond) => cond.iter().for_each(|e| expr(e, v)),
        StmtKind::Exit | StmtKind::Continue | StmtKind::Return | StmtKind::Label(_) => {}
    }
}

/// Walks over an expression.
pub fn expr(e: &Expr, v: &mut impl Visitor) {
    v.expr(e);
    match &e.kind {
        ExprKind::Read(p) => place(p, Use::Read, v),
        ExprKind::RefOf(p) => place(p, Use::Referenced, v),
        ExprKind::Op(_, _, args) | ExprKind::Std { args, .. } | ExprKind::Text { args, .. } => {
            args.iter().for_each(|a| expr(a, v));
        }
        ExprKind::AndThen(a, b) | ExprKind::OrElse(a, b) => {
            expr(a, v);
            expr(b, v);
        }
        ExprKind::Convert(_, _, inner) | ExprKind::Retype(inner) | ExprKind::RangeCheck { value: inner, .. } => {
            expr(inner, v);
        }
        ExprKind::Call(inner) => call(inner, v),
        ExprKind::StdCall(inner) => {
            inner.en.iter().chain(inner.arguments.iter().map(|(_, e)| e)).for_each(|e| expr(e, v));
            inner.value.iter().chain(inner.outputs.iter().map(|(_, e)| e)).for_each(|e| expr(e, v));
            inner
                .outputs
                .iter()
                .map(|(p, _)| p)
                .chain(inner.eno.iter().map(|e| &e.target))
                .for_each(|p| place(p, Use::Written, v));
        }
        ExprKind::Choose { selector, choices } => {
            expr(selector, v);
            choices.iter().for_each(|e| expr(e, v));
        }
        ExprKind::Const(_) | ExprKind::String(_) | ExprKind::WString(_) | ExprKind::Temp(_) | ExprKind::Error => {}
    }
}

/// Walks over a place that is used like this.
pub fn place(p: &Place, how: Use, v: &mut impl Visitor) {
    v.place(p, how);
    if let Root::Deref(e) = &p.root {
        expr(e, v);
    }
    for step in &p.steps {
        match step {
            Step::Index(indices, _) => indices.iter().for_each(|e| expr(e, v)),
            Step::OpenIndex(indices, _) => {
                for index in indices {
                    expr(&index.value, v);
                    expr(&index.low, v);
                    expr(&index.high, v);
                }
            }
            Step::Character { index, .. } => expr(index, v),
            Step::Field(_) | Step::Member(_) | Step::Deref | Step::Bit(_) | Step::Part(..) | Step::Flags(_) => {}
        }
    }
}

fn call(c: &Call, v: &mut impl Visitor) {
    v.call(c);
    if let Callee::Instance(p, _) | Callee::Action(Some(p), _) = &c.callee {
        place(p, Use::Called, v);
    }
    c.en.iter().for_each(|e| expr(e, v));
    c.inputs.iter().for_each(|(_, e)| expr(e, v));
    c.in_outs.iter().for_each(|(_, p)| place(p, Use::Connected, v));
    c.outputs.iter().for_each(|o| place(&o.target, Use::Written, v));
    c.eno.iter().for_each(|e| place(&e.target, Use::Written, v));
}
