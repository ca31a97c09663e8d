//! Sequential Function Chart: a chart to plain statements over variables of its POU.
//!
//! # The order of one call (semantics.md \[F2\])
//! At clock `t`, in the order of a PLC's scan, for all networks of the chart together:
//! 1. `.T` of each active step becomes `t` less the clock of the call that activated it \[F6\].
//! 2. Action control decides which actions run \[F8\]; BOOL actions take their value.
//! 3. The bodies of active actions run, in the order of their declaration; in profile codesys before them once more those
//!    that ran in the call before and do not any more \[F10\].
//! 4. The conditions of transitions whose preceding steps are all active are evaluated; the others are not.
//! 5. Of those that hold, the ones that fire are chosen: of transitions that share a preceding step one \[F4\], under the
//!    strong rule only those whose succeeding steps are free \[F5\].
//! 6. All preceding steps of the chosen transitions are cleared, then all succeeding ones set. That acts from the next call on.
//!
//! # What a chart keeps
//! A step is a variable `Name` of its POU: `X`, `T`, and hidden the clock of its activation. Everything else is hidden (its name
//! starts with `$`; for the chart of an ACTION the action's name comes first): for each action with a qualifier other than N
//! its action control, for each transition whether it was chosen. The standard's action control is ST, in
//! `stdlib/blocks/ACTION_CONTROL.st`. Nothing after this knows that there was a chart.
//!
//! # What it costs
//! Per call one test for each action and one store for each BOOL action; one test for each eight steps, then for those four of
//! them and then those one by one of which any is active (`flags`); all else happens for active steps only. If `.T` is read
//! before the transitions are evaluated, steps are looked at twice, else their time is refreshed with their transitions
//! (`late`). Setting and clearing is looked at only in calls in which something fires. In charts with many steps the tests are
//! done for groups of steps first (`groups`).
//!
//! In: the tree of the chart. Out: a [`Body`], and the [`Chart`](crate::chart::Chart) in `Defs`. `build` and `actions` resolve
//! and report; `control` and `evolve` write statements, from the pieces in `emit`.

mod actions;
mod build;
mod control;
mod emit;
mod evolve;
mod flags;
mod groups;
mod late;
mod order;

use crate::body::Body;
use crate::chart::{Chart, Condition};
use crate::collect::charts::field;
use crate::cx::Cx;
use crate::defs::*;
use crate::expr::Checker;
use crate::shape::FLAGS_AT_ONCE;
use emit::*;
use flags::Flags;
use late::Late;
use plcc_diag::{Diagnostic, codes};
use plcc_syntax::ast;

/// Checks the chart that is the body of `pou` in the scope of its POU. Its statements are written when all bodies are checked
/// ([`write_all`]).
pub(crate) fn check<'a>(cx: &mut Cx<'a>, pou: PouId, scope: PouId, body: &'a ast::SfcBody) -> Body {
    if cx.defs.pous[scope].kind == PouKind::Function {
        cx.push(
            Diagnostic::new(codes::CHART_IN_FUNCTION, body.span.before(), "a FUNCTION cannot be a chart")
                .help("it remembers nothing between its calls; make it a FUNCTION_BLOCK"),
        );
        return Body::default();
    }
    let mut labels = 0;
    let mut checker = Checker { cx, scope: Some(scope), temps: Default::default() };
    let Some(chart) = build::build(&mut checker, pou, body, &mut labels) else { return Body::default() };
    let temps = checker.temps;
    cx.defs.charts.push(chart);
    Body { stmts: Vec::new(), temps, labels }
}

/// Writes the statements of all charts.
pub(crate) fn write_all(cx: &mut Cx) {
    let charts = std::mem::take(&mut cx.defs.charts);
    for (chart, late) in charts.iter().zip(late::late(&cx.defs, &charts)) {
        write(cx, chart, &late);
    }
    cx.defs.charts = charts;
}

fn write(cx: &mut Cx, chart: &Chart, late: &Late) {
    let temps = std::mem::take(&mut cx.defs.bodies[chart.pou].temps);
    let prefix = match chart.pou == chart.owner {
        true => "$".to_string(),
        false => format!("${}$", cx.defs.pous[chart.pou].name),
    };
    let mut checker = Checker { cx, scope: Some(chart.owner), temps };
    let mut w = Writer { c: &mut checker, owner: chart.owner, prefix };
    let mut stmts = Vec::new();
    let state = evolve::state(&mut w, chart);
    let mut first = Some(evolve::begin(&mut w, chart, &state, &mut stmts));
    // Where the times of initial steps are refreshed with the transitions, action control can look after it.
    if !chart.networks.iter().all(|network| late[network.initial]) {
        stmts.extend(first.take());
    }
    let groups = groups::Groups::new(&mut w, chart);
    let steps = chart.steps.indices().map(|s| of_step(chart, s, field::X));
    let steps = Flags::new(steps.collect(), chart.steps.len().next_multiple_of(FLAGS_AT_ONCE as usize));
    let chosen = Flags::new(state.chosen.iter().cloned().collect(), chart.transitions.len());
    evolve::times(chart, &state, &groups, &steps, late, &mut stmts);
    let wakes = control::write(&mut w, chart, &groups, first, &mut stmts);
    evolve::evaluate(&mut w, chart, &state, &groups, &steps, late, &mut stmts);
    evolve::fire(chart, &state, &groups, &chosen, &wakes, &mut stmts);
    let temps = checker.temps;
    let body = &mut cx.defs.bodies[chart.pou];
    body.temps = temps;
    body.stmts.append(&mut stmts);
}

/// The condition of a transition in Instruction List: the statements that compute the current result, and the BOOL that it is
/// at their end (\[I3\]). Labels are numbered from `labels` on, temporaries are the checker's.
fn il_condition<'a>(c: &mut Checker<'_, 'a>, labels: &mut u32, il: &'a ast::IlBody) -> Option<Condition> {
    let (stmts, value) = super::il::check_condition(c, il, labels);
    Some(Condition { stmts, value })
}
