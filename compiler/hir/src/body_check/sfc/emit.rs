//! Small pieces of the typed form, from which the evolution of a chart is written.

use crate::body::*;
use crate::chart::{Chart, StepId};
use crate::collect::{charts::field, internal_name, new_var};
use crate::cx::State;
use crate::defs::*;
use crate::expr::Checker;
use crate::init::Init;
use crate::types::{Type, TypeId, Types};
use plcc_diag::{Span, bug};
use plcc_stdlib::elem::Elem;
use plcc_stdlib::ops::Op;

pub(super) const BOOL: Elem = Elem::Bool;

/// Writes statements for one chart.
pub(super) struct Writer<'w, 'c, 'a> {
    pub c: &'w mut Checker<'c, 'a>,
    /// The POU whose instance holds the variables.
    pub owner: PouId,
    /// In front of the names of hidden variables: `$`, for the chart of an ACTION its name and `$` behind it.
    pub prefix: String,
}

impl Writer<'_, '_, '_> {
    /// A hidden variable in the instance.
    pub fn hidden(&mut self, name: &str, ty: TypeId, span: Span) -> VarId {
        let name = format!("{}{name}", self.prefix);
        let var = new_var(self.c.cx, name.into(), span, Section::Local, Some(self.owner), None);
        self.c.cx.var_slots[var].ty = State::Done(Init::Default);
        self.c.cx.var_slots[var].init = State::Done(());
        self.c.cx.defs.vars[var].ty = ty;
        self.c.cx.defs.pous[self.owner].vars.push(var);
        var
    }

    /// Hidden BOOLs that lie side by side; a warm start does not keep them.
    pub fn flags(&mut self, name: &str, count: usize, init: Init, span: Span) -> Vec<Place> {
        let elem = Types::elem(BOOL);
        let ty = self.c.cx.defs.types.intern(Type::Array { dims: vec![(0, count as i64 - 1)], elem });
        let var = self.hidden(name, ty, span);
        self.c.cx.defs.vars[var].init = init;
        self.c.cx.defs.vars[var].non_retain = true;
        let text = self.c.cx.defs.vars[var].name.to_string();
        let flag = |n: usize| Place {
            steps: vec![Step::Index(vec![constant(n as u64, Elem::Lint, span)], text.clone())],
            ty: elem,
            ..variable(var, ty, span)
        };
        (0..count).map(flag).collect()
    }

    /// A temporary.
    pub fn temp(&mut self, elem: Elem) -> TempId {
        self.c.temps.push(Types::elem(elem))
    }

    /// A hidden instance of a block that charts use.
    pub fn instance(&mut self, block: &str, name: &str, span: Span) -> Block {
        let Some(&pou) = self.c.cx.pous.get(&internal_name(block)) else { bug!("there is no block {block}") };
        let ty = self.c.cx.defs.types.intern(Type::Instance(pou));
        let place = variable(self.hidden(name, ty, span), ty, span);
        Block { pou, place }
    }

    /// A parameter of a block, and its type.
    fn parameter(&self, block: &Block, name: &str) -> (VarId, TypeId) {
        let vars = &self.c.cx.defs.vars;
        let found = self.c.cx.defs.pous[block.pou].vars.iter().find(|v| vars[**v].name == name);
        match found {
            Some(var) => (*var, vars[*var].ty),
            None => bug!("{} has no {name}", self.c.cx.defs.pous[block.pou].name),
        }
    }

    /// A call of a block with its inputs.
    pub fn call(&self, block: &Block, inputs: Vec<(&str, Expr)>, span: Span) -> Stmt {
        let inputs = inputs.into_iter().map(|(name, value)| (self.parameter(block, name).0, value)).collect();
        call(Callee::Instance(block.place.clone(), block.pou), inputs, span)
    }

    /// An output of a block.
    pub fn output(&self, block: &Block, name: &str) -> Expr {
        let (var, ty) = self.parameter(block, name);
        let mut place = block.place.clone();
        place.steps.push(Step::Member(var));
        place.ty = ty;
        read(place)
    }
}

/// A hidden instance.
#[derive(Debug, Clone)]
pub(super) struct Block {
    pou: PouId,
    place: Place,
}

pub(super) fn variable(var: VarId, ty: TypeId, span: Span) -> Place {
    Place { root: Root::Var(var), steps: Vec::new(), ty, span }
}

/// A part of a step.
pub(super) fn of_step(chart: &Chart, step: StepId, part: u32) -> Place {
    let step = &chart.steps[step];
    let (_, elem) = field::ALL[part as usize];
    Place { root: Root::Var(step.var), steps: vec![Step::Field(part)], ty: Types::elem(elem), span: step.span }
}

/// The flag of a step.
pub(super) fn active(chart: &Chart, step: StepId) -> Expr {
    read(of_step(chart, step, field::X))
}

pub(super) fn read(place: Place) -> Expr {
    Expr { ty: place.ty, span: place.span, kind: ExprKind::Read(place) }
}

pub(super) fn read_temp(temp: TempId, elem: Elem, span: Span) -> Expr {
    Expr { kind: ExprKind::Temp(temp), ty: Types::elem(elem), span }
}

pub(super) fn constant(raw: u64, elem: Elem, span: Span) -> Expr {
    Expr { kind: ExprKind::Const(raw), ty: Types::elem(elem), span }
}

/// An operation whose result has the type of its operands.
pub(super) fn operation(op: Op, elem: Elem, args: Vec<Expr>, span: Span) -> Expr {
    Expr { kind: ExprKind::Op(op, elem, args), ty: Types::elem(elem), span }
}

pub(super) fn equal(elem: Elem, a: Expr, b: Expr) -> Expr {
    let span = a.span;
    Expr { kind: ExprKind::Op(Op::Eq, elem, vec![a, b]), ty: Types::elem(BOOL), span }
}

pub(super) fn not(value: Expr) -> Expr {
    let span = value.span;
    operation(Op::Not, BOOL, vec![value], span)
}

/// All of them, as a tree of small depth. FALSE for none.
pub(super) fn any(values: &[Expr], span: Span) -> Expr {
    tree(Op::Or, values).unwrap_or_else(|| constant(0, BOOL, span))
}

/// All of them, as a tree of small depth. TRUE for none.
pub(super) fn all(values: &[Expr], span: Span) -> Expr {
    tree(Op::And, values).unwrap_or_else(|| constant(1, BOOL, span))
}

fn tree(op: Op, values: &[Expr]) -> Option<Expr> {
    match values {
        [] => None,
        [one] => Some(one.clone()),
        _ => {
            let (a, b) = values.split_at(values.len() / 2);
            let (a, b) = (tree(op, a)?, tree(op, b)?);
            let span = a.span;
            Some(operation(op, BOOL, vec![a, b], span))
        }
    }
}

pub(super) fn stmt(kind: StmtKind, span: Span) -> Stmt {
    Stmt { kind, span }
}

pub(super) fn assign(target: Place, value: Expr, span: Span) -> Stmt {
    stmt(StmtKind::Assign { target, value }, span)
}

pub(super) fn assign_temp(temp: TempId, value: Expr, span: Span) -> Stmt {
    let target = Place { root: Root::Temp(temp), steps: Vec::new(), ty: value.ty, span };
    assign(target, value, span)
}

pub(super) fn when(cond: Expr, body: Vec<Stmt>, span: Span) -> Stmt {
    stmt(StmtKind::If { arms: vec![(cond, body)], otherwise: Vec::new() }, span)
}

pub(super) fn call(callee: Callee, inputs: Vec<(VarId, Expr)>, span: Span) -> Stmt {
    let call = Call { callee, inputs, in_outs: Vec::new(), outputs: Vec::new(), en: None, eno: None, span };
    stmt(StmtKind::Call(Box::new(call)), span)
}
