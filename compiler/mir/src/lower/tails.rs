//! Strings of a function that are what is left of one of its inputs: `rest := line; ... rest := DELETE(rest, n, 1)`.
//!
//! Texts are taken apart like this everywhere, and to move what is left to the front each time would be to copy the text
//! once for every part. Such a variable is lowered as a number, how many characters of the input lie in front of it; there is
//! no string in its place, which nobody can see: a local variable of a function, whose address nobody takes and of which
//! no single character is accessed.

use super::func::FuncLower;
use super::text::{Capacity, Text};
use crate::ir::{Place, ValueId};
use plcc_hir::body::{self, Call, Expr, ExprKind, Root, Stmt, StmtKind};
use plcc_hir::visit::{self, Use, Visitor};
use plcc_hir::{Body, Defs, PouId, Section, Type, VarId};
use plcc_stdlib::funcs::TextOp;
use plcc_stdlib::prim::Repr;
use plcc_stdlib::rt::strings::TextFns;
use rustc_hash::{FxHashMap, FxHashSet};

/// What a tail is the tail of, and the place in the frame for how many characters lie in front of it, an I64.
#[derive(Debug, Clone)]
pub(super) struct Tail {
    source: VarId,
    skipped: Option<Place>,
}

/// The variables of a function that are lowered as tails.
pub(super) fn of_function(defs: &Defs, function: PouId) -> FxHashMap<VarId, Tail> {
    let body = &defs.bodies[function];
    // Few are assigned a whole variable at the outermost level, and only these need a closer look.
    let assigned: FxHashSet<VarId> = body.stmts.iter().filter_map(begins).collect();
    let locals = defs.pous[function].vars.iter().filter(|id| {
        let var = &defs.vars[**id];
        assigned.contains(id)
            && var.section == Section::Local
            && !var.address_taken
            && var.address.is_none()
            && capacity(defs, **id).is_some()
    });
    let mut found = FxHashMap::default();
    for &local in locals {
        if let Some(source) = source(defs, body, local) {
            found.insert(local, Tail { source, skipped: None });
        }
    }
    found
}

/// The variable that a statement makes another one.
fn begins(stmt: &Stmt) -> Option<VarId> {
    match &stmt.kind {
        StmtKind::Assign { target: body::Place { root: Root::Var(var), steps, .. }, value } if steps.is_empty() => {
            variable(value).map(|_| *var)
        }
        _ => None,
    }
}

/// Kind and capacity of a string of fixed capacity whose length an INT tells.
fn capacity(defs: &Defs, var: VarId) -> Option<(bool, u32)> {
    match defs.types[defs.vars[var].ty] {
        Type::String { wide, capacity } if capacity <= i16::MAX as u32 => Some((wide, capacity)),
        _ => None,
    }
}

/// The input whose tail a variable is all the time.
fn source(defs: &Defs, body: &Body, local: VarId) -> Option<VarId> {
    // A jump could pass the first assignment.
    if body.labels > 0 {
        return None;
    }
    let mut uses = Uses { of: local, other: 0, known: 0 };
    let first = body.stmts.iter().find(|stmt| {
        visit::stmts(std::slice::from_ref(*stmt), &mut uses);
        uses.other > 0
    })?;
    let StmtKind::Assign { target, value } = &first.kind else { return None };
    let source = variable(value).filter(|_| is_whole(target, local))?;
    let (wide, room) = capacity(defs, local)?;
    let input = &defs.vars[source];
    let fits = capacity(defs, source).is_some_and(|(w, n)| w == wide && n <= room);
    if !fits || input.section != Section::Input || input.owner != defs.vars[local].owner || input.address_taken {
        return None;
    }
    let mut uses = Uses { of: local, other: 0, known: 0 };
    visit::stmts(&body.stmts, &mut uses);
    let mut steps = Steps { local, source, known: 0, input_changes: false };
    visit::stmts(&body.stmts, &mut steps);
    (uses.other == uses.known + steps.known && !steps.input_changes).then_some(source)
}

/// The variable that an expression reads whole.
fn variable(expr: &Expr) -> Option<VarId> {
    match &expr.kind {
        ExprKind::Read(body::Place { root: Root::Var(var), steps, .. }) if steps.is_empty() => Some(*var),
        _ => None,
    }
}

fn is_whole(place: &body::Place, var: VarId) -> bool {
    matches!(place.root, Root::Var(root) if root == var) && place.steps.is_empty()
}

/// The statement by which a tail becomes shorter: how many characters go.
fn shorter(value: &Expr, local: VarId) -> Option<&Expr> {
    match &value.kind {
        ExprKind::Text { op: TextOp::Delete, args, .. } => match args.as_slice() {
            [text, count, Expr { kind: ExprKind::Const(1), .. }] if variable(text) == Some(local) => Some(count),
            _ => None,
        },
        _ => None,
    }
}

/// How often a variable stands somewhere, and how often where its string is read only.
struct Uses {
    of: VarId,
    other: usize,
    known: usize,
}

impl Uses {
    fn reads(&mut self, expr: &Expr) {
        self.known += usize::from(variable(expr) == Some(self.of));
    }
}

impl Visitor for Uses {
    fn place(&mut self, place: &body::Place, _: Use) {
        self.other += usize::from(matches!(place.root, Root::Var(var) if var == self.of));
    }

    fn expr(&mut self, expr: &Expr) {
        if let ExprKind::Text { args, .. } = &expr.kind {
            args.iter().for_each(|arg| self.reads(arg));
        }
    }

    fn stmt(&mut self, stmt: &Stmt) {
        if let StmtKind::Assign { value, .. } = &stmt.kind {
            self.reads(value);
        }
    }

    fn call(&mut self, call: &Call) {
        call.inputs.iter().for_each(|(_, value)| self.reads(value));
    }
}

/// How often a variable is assigned as a tail, and whether its source is changed.
struct Steps {
    local: VarId,
    source: VarId,
    known: usize,
    input_changes: bool,
}

impl Visitor for Steps {
    fn place(&mut self, place: &body::Place, how: Use) {
        let is_source = matches!(place.root, Root::Var(var) if var == self.source);
        self.input_changes |= is_source && how != Use::Read;
    }

    fn stmt(&mut self, stmt: &Stmt) {
        if let StmtKind::Assign { target, value } = &stmt.kind
            && is_whole(target, self.local)
            && (variable(value) == Some(self.source) || shorter(value, self.local).is_some())
        {
            self.known += 1;
        }
    }
}

impl FuncLower<'_, '_> {
    /// What a place is the tail of: the input, and the place of how many characters lie in front.
    pub(super) fn tail(&mut self, place: &body::Place) -> Option<(Text, Place)> {
        let Root::Var(var) = place.root else { return None };
        let tail = self.tails.get(&var)?.clone();
        let skipped = match tail.skipped {
            Some(place) => place,
            None => {
                let place = self.frame_room(8, 8);
                self.tails.insert(var, Tail { skipped: Some(place.clone()), ..tail });
                place
            }
        };
        let (wide, n) = capacity(self.defs, tail.source)?;
        let place = self.own_place(tail.source);
        Some((Text::at(place, wide, Capacity::Known(n)), skipped))
    }

    /// Whether a place is a tail.
    pub(super) fn is_tail(&self, place: &body::Place) -> bool {
        matches!(place.root, Root::Var(var) if self.tails.contains_key(&var))
    }

    /// The same for an expression that reads one, and the number.
    pub(super) fn tail_of(&mut self, expr: &Expr) -> Option<(Text, ValueId)> {
        let ExprKind::Read(place) = &expr.kind else { return None };
        let (source, skipped) = self.tail(place)?;
        let skipped = self.b.load(Repr::I64, skipped, false);
        Some((source, skipped))
    }

    /// An assignment to a tail. FALSE if the target is none.
    pub(super) fn assign_tail(&mut self, target: &body::Place, value: &Expr) -> bool {
        let (Root::Var(local), Some((source, skipped))) = (&target.root, self.tail(target)) else { return false };
        let number = match shorter(value, *local) {
            Some(count) => {
                let count = self.value(count);
                let before = self.b.load(Repr::I64, skipped.clone(), false);
                self.call_text(&TextFns::of(source.wide).skip, &[&source], &[before, count])
            }
            None => self.b.number(Repr::I64, 0),
        };
        self.b.store(skipped, number);
        true
    }

    /// Builds at most `length` characters of a tail.
    pub(super) fn build_tail(&mut self, to: &Text, (source, skipped): &(Text, ValueId), length: Option<ValueId>) {
        let length = length.unwrap_or_else(|| self.b.number(Repr::I64, i64::MAX as u64));
        self.call_text(&TextFns::of(to.wide).tail, &[to, source], &[*skipped, length]);
    }
}
