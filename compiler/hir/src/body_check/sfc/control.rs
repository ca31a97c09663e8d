//! Action control (semantics.md \[F8\]): which actions run in this scan. The meaning of each qualifier is in
//! `stdlib/blocks/ACTION_CONTROL.st`; here are the instances, who feeds them, and when they may rest.

use super::emit::*;
use super::flags::Flags;
use super::groups::{Group, Grouped, Groups};
use crate::body::{Callee, Expr, Place, Stmt};
use crate::chart::{ActionId, ActionKind, Association, Chart, Qualifier, StepId};
use crate::defs::Profile;
use crate::init::Init;
use crate::types::Types;
use index_vec::IndexVec;
use plcc_diag::Span;
use rustc_hash::FxHashSet;

/// By step: flags of the action controls that must be called when it becomes active.
pub(super) type Wakes = IndexVec<StepId, Vec<Place>>;

/// The statements of steps (2) and (3) of the evolution (\[F2\]), in front of them what the first call does. If there are
/// action controls, it is looked at together with them, in the first call and never again.
pub(super) fn write(w: &mut Writer, chart: &Chart, groups: &Groups, first: Option<Stmt>, out: &mut Vec<Stmt>) -> Wakes {
    let mut users: Vec<Vec<User>> = chart.actions.iter().map(|_| Vec::new()).collect();
    for (step, s) in chart.steps.iter_enumerated() {
        for association in &s.associations {
            users[association.action.index()].push(User { step, association });
        }
    }
    let count = users.iter().filter(|users| !is_wire(users)).count();
    let mut controls = Grouped::default();
    let with_controls = first.is_some() && count > 0;
    let mut awake = Awake::new(w, chart, count + usize::from(with_controls));
    if let Some(first) = first {
        let span = first.span;
        if with_controls {
            let (number, flag) = awake.take(&[]);
            controls.push_flagged(None, number, vec![assign(flag, constant(0, BOOL, span), span), first], span);
        } else {
            out.push(first);
        }
    }
    let mut running = Vec::new();
    for (id, users) in chart.actions.indices().zip(&users) {
        running.push(control(w, chart, id, users, groups, &mut awake, &mut controls));
    }
    controls.finish(groups, &awake.flags, out);
    for (action, running) in chart.actions.iter().zip(&running) {
        if let ActionKind::Variable(place) = &action.kind {
            out.push(assign(place.clone(), running.clone(), place.span));
        }
    }
    bodies(w, chart, &users, &running, groups, &mut awake.names, out);
    awake.wakes
}

/// Which action controls must be called. Such a control rests while none of its steps is active, nothing is stored, and the
/// last scan has seen that: then no part of it would change. A step that becomes active wakes it.
struct Awake {
    flags: Flags,
    /// The next one that is free.
    next: usize,
    wakes: Wakes,
    names: Names,
}

/// Names of hidden variables: those of the actions and steps they belong to, so that what a warm start keeps finds them again
/// when the chart was edited.
#[derive(Default)]
struct Names(FxHashSet<String>);

impl Names {
    /// The name, with a number behind it if it was given before.
    fn of(&mut self, text: &str) -> String {
        let plain: String = text.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
        let numbered = (2..).map(|n| format!("{plain}__{n}"));
        let name = std::iter::once(plain.clone()).chain(numbered).find(|name| !self.0.contains(name)).unwrap_or(plain);
        self.0.insert(name.clone());
        name
    }
}

impl Awake {
    fn new(w: &mut Writer, chart: &Chart, controls: usize) -> Self {
        let bytes = Flags::room(controls);
        let mut places = Vec::new();
        if controls > 0 {
            // In the first call all are looked at.
            let init = Init::Array(vec![(controls as u32, Init::Scalar(1))]);
            places = w.flags("awake", bytes, init, chart.span.before());
        }
        let wakes = chart.steps.iter().map(|_| Vec::new()).collect();
        Self { flags: Flags::new(places, bytes), next: 0, wakes, names: Names::default() }
    }

    fn take(&mut self, users: &[User]) -> (usize, Place) {
        let number = self.next;
        self.next += 1;
        let place = self.flags.place(number).clone();
        for user in users {
            self.wakes[user.step].push(place.clone());
        }
        (number, place)
    }
}

/// Not stored, not timed, not reset: the action control of such an action is a wire.
fn is_wire(users: &[User]) -> bool {
    users.iter().all(|u| u.association.qualifier == Qualifier::N)
}

/// A step that acts on the action in question.
struct User<'c> {
    step: StepId,
    association: &'c Association,
}

/// Decides whether an action runs; gives the expression that says so.
fn control(
    w: &mut Writer,
    chart: &Chart,
    id: ActionId,
    users: &[User],
    groups: &Groups,
    awake: &mut Awake,
    out: &mut Grouped,
) -> Expr {
    let span = span_of(chart, users);
    let flags = |q: Qualifier| -> Vec<Expr> {
        users.iter().filter(|u| u.association.qualifier == q).map(|u| active(chart, u.step)).collect()
    };
    if is_wire(users) {
        return any(&flags(Qualifier::N), span);
    }
    let name = awake.names.of(&format!("action {}", chart.actions[id].name));
    let control = w.instance("ACTION_CONTROL", &name, span);
    let reset = any(&flags(Qualifier::R), span);
    let mut body = Vec::new();
    let mut parts = Vec::new();
    let mut stored = vec![w.output(&control, "Stored")];
    for user in users {
        let Some(block) = part(user.association.qualifier) else { continue };
        let part =
            awake.names.of(&format!("{name} {} {}", chart.steps[user.step].name, user.association.qualifier.text()));
        let part = w.instance(block, &part, user.association.span);
        let mut inputs = vec![("X", active(chart, user.step))];
        if matches!(user.association.qualifier, Qualifier::SD | Qualifier::DS | Qualifier::SL) {
            inputs.push(("R", reset.clone()));
            stored.push(w.output(&part, "Stored"));
        }
        inputs.extend(user.association.time.clone().map(|time| ("T", time)));
        body.push(w.call(&part, inputs, user.association.span));
        parts.push(w.output(&part, "Q"));
    }
    let mut inputs = vec![("Parts", any(&parts, span))];
    for (input, qualifier) in [("N", Qualifier::N), ("S", Qualifier::S), ("R", Qualifier::R)] {
        let flags = flags(qualifier);
        if !flags.is_empty() {
            inputs.push((input, any(&flags, span)));
        }
    }
    body.push(w.call(&control, inputs, span));
    let runs = w.output(&control, "Q");
    // While it is awake, it keeps the group of its steps awake, if they are of one.
    let group = group_of(groups, users);
    let (number, awake) = awake.take(users);
    let mut why: Vec<Expr> = users.iter().map(|u| active(chart, u.step)).collect();
    why.push(runs.clone());
    why.append(&mut stored);
    body.push(assign(awake.clone(), any(&why, span), span));
    if group.is_some() {
        let mut wake = Vec::new();
        groups.wake(group, span, &mut wake);
        body.push(when(read(awake), wake, span));
    }
    out.push_flagged(group, number, body, span);
    runs
}

/// The group of all steps that act on an action.
fn group_of(groups: &Groups, users: &[User]) -> Group {
    groups.common(users.iter().map(|u| u.step))
}

/// The part of the action control that a qualifier needs for itself.
fn part(qualifier: Qualifier) -> Option<&'static str> {
    Some(match qualifier {
        Qualifier::N | Qualifier::S | Qualifier::R => return None,
        Qualifier::P | Qualifier::P1 => "ACTION_P1",
        Qualifier::P0 => "ACTION_P0",
        Qualifier::L => "ACTION_L",
        Qualifier::D => "ACTION_D",
        Qualifier::SD => "ACTION_SD",
        Qualifier::DS => "ACTION_DS",
        Qualifier::SL => "ACTION_SL",
    })
}

/// Calls the bodies of active actions, in profile codesys first once more those that ran and do not any more (\[F10\]).
fn bodies(
    w: &mut Writer,
    chart: &Chart,
    users: &[Vec<User>],
    running: &[Expr],
    groups: &Groups,
    names: &mut Names,
    out: &mut Vec<Stmt>,
) {
    let final_scan = w.c.cx.defs.pous[w.owner].profile == Profile::Codesys;
    let (mut last, mut now) = (Grouped::default(), Grouped::default());
    for (id, action) in chart.actions.iter_enumerated() {
        let ActionKind::Block(block) = action.kind else { continue };
        let users = &users[id.index()];
        let (span, group) = (span_of(chart, users), group_of(groups, users));
        let run = || call(Callee::Action(None, block), Vec::new(), span);
        let running = &running[id.index()];
        if !final_scan {
            now.push(group, [when(running.clone(), vec![run()], span)]);
            continue;
        }
        let name = names.of(&format!("action {} ran", action.name));
        let ran: Place = variable(w.hidden(&name, Types::elem(BOOL), span), Types::elem(BOOL), span);
        let ended = all(&[read(ran.clone()), not(running.clone())], span);
        last.push(group, [when(ended, vec![assign(ran.clone(), constant(0, BOOL, span), span), run()], span)]);
        now.push(group, [when(running.clone(), vec![assign(ran, constant(1, BOOL, span), span), run()], span)]);
    }
    let no_flags = Flags::default();
    last.finish(groups, &no_flags, out);
    now.finish(groups, &no_flags, out);
}

/// Where an action is named first.
fn span_of(chart: &Chart, users: &[User]) -> Span {
    users.first().map_or(chart.span.before(), |u| u.association.span)
}
