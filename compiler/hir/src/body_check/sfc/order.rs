//! In which order sets of transitions are evaluated: that of the text, or where nobody can tell that of their steps, so that
//! more flags are looked at at once (`flags`).

use crate::body::{Expr, ExprKind, Place, Root, Step as PlaceStep};
use crate::chart::{Chart, StepId, TransitionId};
use crate::defs::{Defs, Section};
use plcc_stdlib::ops;

/// Transitions between which is chosen, and the step that stands for them.
pub(super) struct Set {
    pub transitions: Vec<TransitionId>,
    pub shared: Option<StepId>,
}

/// All sets of transitions.
pub(super) fn sets(defs: &Defs, chart: &Chart) -> Vec<Set> {
    let set = |transitions: Vec<TransitionId>| Set { shared: chart.shared(&transitions), transitions };
    let mut sets: Vec<Set> = chart.choices().into_iter().map(set).collect();
    // Neighbours that neither change anything nor fault may change places.
    let movable = |set: &Set| set.shared.is_some() && set.transitions.iter().all(|t| is_silent(defs, chart, *t));
    for run in sets.chunk_by_mut(|a, b| movable(a) && movable(b)) {
        run.sort_by_key(|set| set.shared);
    }
    sets
}

/// Whether a condition only reads, and cannot fault.
fn is_silent(defs: &Defs, chart: &Chart, id: TransitionId) -> bool {
    let condition = &chart.transitions[id].condition;
    condition.stmts.is_empty() && silent(defs, &condition.value)
}

fn silent(defs: &Defs, expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Const(_) | ExprKind::Temp(_) => true,
        ExprKind::Read(place) => plain(defs, place),
        ExprKind::Op(op, elem, args) => !ops::may_fault(*op, *elem) && args.iter().all(|a| silent(defs, a)),
        ExprKind::AndThen(a, b) | ExprKind::OrElse(a, b) => silent(defs, a) && silent(defs, b),
        ExprKind::Convert(_, _, inner) | ExprKind::Retype(inner) => silent(defs, inner),
        _ => false,
    }
}

/// Components only, so that nothing is checked on the way.
fn plain(defs: &Defs, place: &Place) -> bool {
    matches!(place.root, Root::Var(_) | Root::Address(_))
        && place.steps.iter().all(|step| match step {
            PlaceStep::Index(indices, _) => indices.iter().all(|i| matches!(i.kind, ExprKind::Const(_))),
            PlaceStep::Member(var) => defs.vars[*var].section != Section::InOut,
            step => matches!(step, PlaceStep::Field(_) | PlaceStep::Bit(_) | PlaceStep::Part(..)),
        })
}
