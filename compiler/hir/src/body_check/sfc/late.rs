//! Which steps may have their `.T` refreshed together with the evaluation of their transitions.
//!
//! By \[F2\] times come first: actions and conditions read them. A step whose time nothing reads before its own transitions are
//! evaluated, may be refreshed there, and is looked at once in a call instead of twice. It makes no difference as long as no
//! fault in between can be caught by an ENO (\[E4\]): a task that stopped or was reset does not show the time any more.

use crate::body::{Call, Callee, Place, Root, Step as PlaceStep};
use crate::chart::{ActionKind, Chart, StepId, TransitionId};
use crate::collect::charts::field;
use crate::defs::{Defs, PouId, VarId};
use crate::visit::{self, Use, Visitor};
use index_vec::IndexVec;
use rustc_hash::{FxHashMap, FxHashSet};

/// By step: nothing reads its `.T` before the conditions for which it stands ([`Chart::shared`]).
pub(super) type Late = IndexVec<StepId, bool>;

/// For all charts, whose conditions and actions are checked; their own bodies are not written yet.
pub(super) fn late(defs: &Defs, charts: &[Chart]) -> Vec<Late> {
    let mut caught = Caught(false);
    defs.bodies.iter().for_each(|body| visit::stmts(&body.stmts, &mut caught));
    charts.iter().for_each(|chart| visit_conditions(chart, |_| true, &mut caught));
    if caught.0 {
        return charts.iter().map(|chart| chart.steps.iter().map(|_| false).collect()).collect();
    }
    let by_pou: FxHashMap<PouId, &Chart> = charts.iter().map(|c| (c.pou, c)).collect();
    charts.iter().map(|chart| of_chart(defs, &by_pou, chart)).collect()
}

fn of_chart(defs: &Defs, charts: &FxHashMap<PouId, &Chart>, chart: &Chart) -> Late {
    let mut actions = Reads::default();
    visit_associations(chart, &mut actions);
    let mut unknown = actions.follow(defs, charts);
    let mut early = actions.times;
    for set in chart.choices() {
        let mut reads = Reads::default();
        visit_conditions(chart, |id| set.contains(&id), &mut reads);
        unknown |= reads.follow(defs, charts);
        // The step that stands for the set is refreshed in front of its conditions.
        if let Some(own) = chart.shared(&set) {
            reads.times.remove(&chart.steps[own].var);
        }
        early.extend(reads.times);
    }
    chart.steps.iter().map(|step| !unknown && !early.contains(&step.var)).collect()
}

fn visit_conditions(chart: &Chart, of: impl Fn(TransitionId) -> bool, v: &mut impl Visitor) {
    for (id, transition) in chart.transitions.iter_enumerated() {
        if of(id) {
            visit::stmts(&transition.condition.stmts, v);
            visit::expr(&transition.condition.value, v);
        }
    }
}

/// The times of associations, and the bodies of actions as calls.
fn visit_associations(chart: &Chart, reads: &mut Reads) {
    for association in chart.steps.iter().flat_map(|s| &s.associations) {
        association.time.iter().for_each(|time| visit::expr(time, reads));
    }
    for action in &chart.actions {
        match &action.kind {
            ActionKind::Block(pou) => reads.called.push(*pou),
            ActionKind::Variable(place) => visit::place(place, Use::Written, reads),
        }
    }
}

/// A call with ENO.
struct Caught(bool);

impl Visitor for Caught {
    fn call(&mut self, call: &Call) {
        self.0 |= call.eno.is_some();
    }
}

/// What statements read of steps.
#[derive(Default)]
struct Reads {
    /// Steps whose time (or more of them) is read.
    times: FxHashSet<VarId>,
    /// A reference is followed.
    references: bool,
    called: Vec<PouId>,
}

impl Reads {
    /// Adds what called POUs read; tells whether there may be more than that, through references.
    fn follow(&mut self, defs: &Defs, charts: &FxHashMap<PouId, &Chart>) -> bool {
        let mut seen: FxHashSet<PouId> = FxHashSet::default();
        while let Some(pou) = self.called.pop() {
            if !seen.insert(pou) {
                continue;
            }
            visit::stmts(&defs.bodies[pou].stmts, self);
            if let Some(chart) = charts.get(&pou) {
                visit_conditions(chart, |_| true, self);
                visit_associations(chart, self);
            }
        }
        self.references
    }
}

impl Visitor for Reads {
    fn place(&mut self, place: &Place, how: Use) {
        self.references |= matches!(place.root, Root::Deref(_))
            || how == Use::Referenced
            || place.steps.iter().any(|s| matches!(s, PlaceStep::Deref));
        // The variable of which a component is read.
        let mut var = match place.root {
            Root::Var(var) => Some(var),
            _ => None,
        };
        for step in &place.steps {
            match step {
                PlaceStep::Member(member) => var = Some(*member),
                // Of other structures it does no harm.
                PlaceStep::Field(field::T) => self.times.extend(var),
                _ => {}
            }
        }
    }

    fn call(&mut self, call: &Call) {
        self.called.push(match &call.callee {
            Callee::Function(pou) | Callee::Instance(_, pou) | Callee::Action(_, pou) => *pou,
        });
    }
}
