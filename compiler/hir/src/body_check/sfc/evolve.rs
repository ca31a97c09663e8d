//! The transitions of a chart: which conditions are evaluated, which transition is chosen, what it changes.
//! Steps (4), (5) and (6) of the evolution (semantics.md \[F2\]).

use super::control::Wakes;
use super::emit::*;
use super::flags::Flags;
use super::groups::{Grouped, Groups};
use super::late::Late;
use super::order::{self, Set};
use crate::body::{Expr, Place, Stmt, TempId};
use crate::chart::{Chart, Firing, StepId, TransitionId, Trigger};
use crate::collect::charts::field;
use crate::types::Types;
use index_vec::IndexVec;
use plcc_diag::Span;
use plcc_stdlib::elem::Elem;
use plcc_stdlib::ops::Op;
use rustc_hash::FxHashSet;
use std::collections::BTreeMap;

/// What the evolution of a chart keeps beside its steps.
pub(super) struct State {
    /// The clock of this call.
    pub now: TempId,
    /// Some transition fires in this call.
    pub fires: TempId,
    /// By transition: it fires in this call. FALSE between calls; only a call that a fault ended (and ENO caught) can leave
    /// a TRUE, in transitions that the next call evaluates again, because the fault did not change the marking.
    pub chosen: IndexVec<TransitionId, Place>,
    /// With [`Trigger::Edge`]: the number of this call, and by transition the number of the call in which a TRUE counts.
    pub edges: Option<(Place, IndexVec<TransitionId, Place>)>,
    /// A step was activated while it was active; the runtime takes it back. `None` where that cannot be.
    pub merged: Option<Place>,
}

/// Steps (4) and (5), and what is late of step (1).
pub(super) fn evaluate(
    w: &mut Writer,
    chart: &Chart,
    state: &State,
    groups: &Groups,
    steps: &Flags,
    late: &Late,
    out: &mut Vec<Stmt>,
) {
    let sets = order::sets(&w.c.cx.defs, chart);
    let shared: FxHashSet<StepId> = sets.iter().filter_map(|set| set.shared).collect();
    // Steps without transitions of their own, where their neighbours are.
    let mut others = chart.steps.indices().filter(|step| late[*step] && !shared.contains(step)).peekable();
    let mut grouped = Grouped::default();
    let refresh_only = |step: StepId, grouped: &mut Grouped| {
        let body = refresh(chart, state, step, groups);
        grouped.push_flagged(groups.of(step), step.index(), body, chart.steps[step].span);
    };
    for Set { transitions, shared } in sets {
        while let Some(step) = others.next_if(|other| shared.is_some_and(|step| *other < step)) {
            refresh_only(step, &mut grouped);
        }
        let mut body = Vec::new();
        if let Some(step) = shared.filter(|step| late[*step]) {
            body = refresh(chart, state, step, groups);
        }
        for id in &transitions {
            condition(w, chart, state, *id, shared, &mut body);
        }
        choose(w, chart, state, &transitions, &mut body);
        match (shared, transitions.first()) {
            (Some(step), Some(first)) => {
                grouped.push_flagged(groups.of(step), step.index(), body, chart.transitions[*first].span);
            }
            _ => grouped.push(None, body),
        }
    }
    others.for_each(|step| refresh_only(step, &mut grouped));
    grouped.finish(groups, steps, out);
}

/// (4) Evaluates a condition if all preceding steps are active: `chosen` then says whether it counts. The step `known` is
/// active where this stands.
fn condition(
    w: &mut Writer,
    chart: &Chart,
    state: &State,
    id: TransitionId,
    known: Option<StepId>,
    out: &mut Vec<Stmt>,
) {
    let transition = &chart.transitions[id];
    let span = transition.span;
    let mut body = transition.condition.stmts.clone();
    let value = transition.condition.value.clone();
    match &state.edges {
        None => body.push(assign(state.chosen[id].clone(), value, span)),
        Some((calls, counts)) => {
            let holds = w.temp(BOOL);
            body.push(assign_temp(holds, value, span));
            let holds = read_temp(holds, BOOL, span);
            let due = counts[id].clone();
            let rose = equal(Elem::Lint, read(due.clone()), read(calls.clone()));
            body.push(assign(state.chosen[id].clone(), all(&[holds.clone(), rose], span), span));
            // FALSE now: a TRUE in the next call counts.
            let next = operation(Op::Add, Elem::Lint, vec![read(calls.clone()), constant(1, Elem::Lint, span)], span);
            body.push(when(not(holds), vec![assign(due, next, span)], span));
        }
    }
    let others = transition.from.iter().filter(|s| Some(**s) != known);
    let others: Vec<Expr> = others.map(|s| active(chart, *s)).collect();
    match others.as_slice() {
        [] => out.append(&mut body),
        _ => out.push(when(all(&others, span), body, span)),
    }
}

/// (5) The choice (\[F4\] \[F5\]): of the transitions of `set` whose conditions count, those that fire. This is the one place
/// that decides; operator modes will ask here whether the automatic decides at all.
fn choose(w: &mut Writer, chart: &Chart, state: &State, set: &[TransitionId], out: &mut Vec<Stmt>) {
    if chart.firing == Firing::Strong {
        for id in set {
            let transition = &chart.transitions[*id];
            let others = transition.to.iter().filter(|s| !transition.from.contains(s));
            let free: Vec<Expr> = others.map(|s| not(active(chart, *s))).collect();
            if !free.is_empty() {
                narrow(state, *id, all(&free, transition.span), transition.span, out);
            }
        }
    }
    one_per_step(w, chart, state, set, out);
    let Some(first) = set.first() else { return };
    let span = chart.transitions[*first].span;
    let mut fires: Vec<Expr> = vec![read_temp(state.fires, BOOL, span)];
    fires.extend(set.iter().map(|t| read(state.chosen[*t].clone())));
    out.push(assign_temp(state.fires, any(&fires, span), span));
}

/// A step that several transitions take goes to the first of them by rank (\[F4\]): whoever is chosen, takes its steps away
/// from those that come later.
fn one_per_step(w: &mut Writer, chart: &Chart, state: &State, set: &[TransitionId], out: &mut Vec<Stmt>) {
    let mut takers: BTreeMap<StepId, usize> = BTreeMap::new();
    for step in set.iter().flat_map(|t| &chart.transitions[*t].from) {
        *takers.entry(*step).or_default() += 1;
    }
    let mut free: BTreeMap<StepId, TempId> = BTreeMap::new();
    for (step, _) in takers.into_iter().filter(|(_, count)| *count > 1) {
        let span = chart.steps[step].span;
        let temp = w.temp(BOOL);
        out.push(assign_temp(temp, constant(1, BOOL, span), span));
        free.insert(step, temp);
    }
    let mut ranked = set.to_vec();
    ranked.sort_by_key(|id| chart.rank(*id));
    for id in ranked {
        let transition = &chart.transitions[id];
        let span = transition.span;
        let shared: Vec<TempId> = transition.from.iter().filter_map(|s| free.get(s).copied()).collect();
        if shared.is_empty() {
            continue;
        }
        let all_free: Vec<Expr> = shared.iter().map(|t| read_temp(*t, BOOL, span)).collect();
        narrow(state, id, all(&all_free, span), span, out);
        for temp in shared {
            let left = all(&[read_temp(temp, BOOL, span), not(read(state.chosen[id].clone()))], span);
            out.push(assign_temp(temp, left, span));
        }
    }
}

/// `chosen := chosen AND also`.
fn narrow(state: &State, id: TransitionId, also: Expr, span: Span, out: &mut Vec<Stmt>) {
    let chosen = &state.chosen[id];
    out.push(assign(chosen.clone(), all(&[read(chosen.clone()), also], span), span));
}

/// (6) Clears all preceding steps of the chosen transitions, then sets all succeeding ones.
pub(super) fn fire(chart: &Chart, state: &State, groups: &Groups, chosen: &Flags, wakes: &Wakes, out: &mut Vec<Stmt>) {
    let (mut clear, mut set) = (Grouped::default(), Grouped::default());
    for (id, transition) in chart.transitions.iter_enumerated() {
        let span = transition.span;
        // What is chosen, has active steps: the group of any of them is awake.
        let group = transition.from.first().and_then(|s| groups.of(*s));
        let off = transition.from.iter().map(|s| assign(of_step(chart, *s, field::X), constant(0, BOOL, span), span));
        clear.push_flagged(group, id.index(), off.collect(), span);
        let on = succeed(chart, state, groups, wakes, id, None);
        // A processor cannot know which of several transitions fires. It need not, where no jump depends on it.
        let woken: usize = transition.to.iter().map(|step| wakes[*step].len()).sum();
        let grouped = group.is_some() || transition.to.iter().any(|step| groups.of(*step).is_some());
        let short = !grouped && transition.to.len() <= 1 && woken <= 2;
        let quiet = if short { succeed(chart, state, groups, wakes, id, Some(&state.chosen[id])) } else { Vec::new() };
        set.push_either(group, id.index(), on, quiet, span);
    }
    let mut body = Vec::new();
    clear.finish(groups, chosen, &mut body);
    set.finish(groups, chosen, &mut body);
    let span = chart.span.before();
    out.push(when(read_temp(state.fires, BOOL, span), body, span));
}

/// Sets the succeeding steps of a transition and takes back that it was chosen; with `only_if` without a jump, and nothing
/// changes while that flag is FALSE.
fn succeed(
    chart: &Chart,
    state: &State,
    groups: &Groups,
    wakes: &Wakes,
    id: TransitionId,
    only_if: Option<&Place>,
) -> Vec<Stmt> {
    let span = chart.transitions[id].span;
    let mut out = Vec::new();
    for step in &chart.transitions[id].to {
        activate(chart, state, *step, only_if, span, &mut out);
        groups.wake(groups.of(*step), span, &mut out);
        out.extend(wakes[*step].iter().map(|awake| raise(awake.clone(), only_if, span)));
    }
    out.push(assign(state.chosen[id].clone(), constant(0, BOOL, span), span));
    out
}

/// A step becomes active: its time starts (\[F6\]).
fn activate(chart: &Chart, state: &State, step: StepId, only_if: Option<&Place>, span: Span, out: &mut Vec<Stmt>) {
    if let Some(merged) = &state.merged {
        let tell = [of_step(chart, step, field::TWICE), merged.clone()];
        let tell = tell.map(|place| assign(place, constant(1, BOOL, span), span));
        let mut twice: Vec<Expr> = only_if.map(|flag| read(flag.clone())).into_iter().collect();
        twice.push(active(chart, step));
        out.push(when(all(&twice, span), tell.to_vec(), span));
    }
    out.push(raise(of_step(chart, step, field::X), only_if, span));
    let now = read_temp(state.now, Elem::Time, span);
    for (part, value) in [(field::T, constant(0, Elem::Time, span)), (field::START, now)] {
        let place = of_step(chart, step, part);
        let value = match only_if {
            Some(flag) => operation(Op::Sel, Elem::Time, vec![read(flag.clone()), read(place.clone()), value], span),
            None => value,
        };
        out.push(assign(place, value, span));
    }
}

/// A BOOL becomes TRUE; with `only_if` if that is.
fn raise(place: Place, only_if: Option<&Place>, span: Span) -> Stmt {
    let value = match only_if {
        Some(flag) => any(&[read(place.clone()), read(flag.clone())], span),
        None => constant(1, BOOL, span),
    };
    assign(place, value, span)
}

/// The variables of this part.
pub(super) fn state(w: &mut Writer, chart: &Chart) -> State {
    let (now, fires) = (w.temp(Elem::Time), w.temp(BOOL));
    let mut each = |name: &str, elem: Elem| -> IndexVec<TransitionId, Place> {
        let ty = Types::elem(elem);
        let list = chart.transitions.iter_enumerated();
        list.map(|(id, t)| variable(w.hidden(&format!("t{}{name}", id.index() + 1), ty, t.span), ty, t.span)).collect()
    };
    let chosen = each("chosen", BOOL);
    let edges = (chart.trigger == Trigger::Edge).then(|| each("due", Elem::Lint));
    let edges = edges.map(|due| {
        let ty = Types::elem(Elem::Lint);
        (variable(w.hidden("calls", ty, chart.span), ty, chart.span.before()), due)
    });
    // Where every transition leads from one step to one, each network has one active step for ever.
    let sequential = chart.transitions.iter().all(|t| t.from.len() == 1 && t.to.len() == 1);
    let merged = (!sequential).then(|| {
        let ty = Types::elem(BOOL);
        variable(w.hidden(plcc_stdlib::chart_flags::CHART, ty, chart.span), ty, chart.span.before())
    });
    State { now, fires, chosen, edges, merged }
}

/// What comes before step (1). Gives what the first call does: the time of the initial steps starts (\[F6\]).
pub(super) fn begin(w: &mut Writer, chart: &Chart, state: &State, out: &mut Vec<Stmt>) -> Stmt {
    let (ty, span) = (Types::elem(BOOL), chart.span.before());
    let time = Types::elem(Elem::Time);
    let Some(clock) = plcc_stdlib::funcs::find("TIME") else { plcc_diag::bug!("there is no TIME()") };
    let kind = crate::body::ExprKind::Std { func: clock, elem: Elem::Time, args: Vec::new() };
    out.push(assign_temp(state.now, Expr { kind, ty: time, span }, span));
    out.push(assign_temp(state.fires, constant(0, BOOL, span), span));
    if let Some((calls, _)) = &state.edges {
        let next = operation(Op::Add, Elem::Lint, vec![read(calls.clone()), constant(1, Elem::Lint, span)], span);
        out.push(assign(calls.clone(), next, span));
    }
    let started = variable(w.hidden("started", ty, span), ty, span);
    let initial = chart.networks.iter().map(|n| n.initial);
    let now = || read_temp(state.now, Elem::Time, span);
    let mut first = vec![assign(started.clone(), constant(1, BOOL, span), span)];
    first.extend(initial.map(|s| assign(of_step(chart, s, field::START), now(), span)));
    when(not(read(started)), first, span)
}

/// (1) Refreshes the times of active steps, but of those that are late.
pub(super) fn times(chart: &Chart, state: &State, groups: &Groups, steps: &Flags, late: &Late, out: &mut Vec<Stmt>) {
    let mut grouped = Grouped::default();
    let mut last = None;
    for (id, step) in chart.steps.iter_enumerated() {
        let (span, group) = (step.span, groups.of(id));
        if last != group {
            let mut tired = Vec::new();
            groups.tire(group, span, &mut tired);
            grouped.push(group, tired);
            last = group;
        }
        if !late[id] {
            grouped.push_flagged(group, id.index(), refresh(chart, state, id, groups), span);
        }
    }
    grouped.finish(groups, steps, out);
}

/// What step (1) does for an active step.
fn refresh(chart: &Chart, state: &State, id: StepId, groups: &Groups) -> Vec<Stmt> {
    let span = chart.steps[id].span;
    let now = read_temp(state.now, Elem::Time, span);
    let since = operation(Op::Sub, Elem::Time, vec![now, read(of_step(chart, id, field::START))], span);
    let mut out = vec![assign(of_step(chart, id, field::T), since, span)];
    groups.wake(groups.of(id), span, &mut out);
    out
}
