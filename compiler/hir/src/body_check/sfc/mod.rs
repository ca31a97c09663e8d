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
//! Per call one test of a flag for each step and for each set of rival transitions, one test for each action, and one store
//! for each BOOL action; all else happens for active steps only. Setting and clearing is looked at only in calls in which
//! something fires. In charts with many steps the tests are done for groups of steps first (`groups`).
//!
//! In: the tree of the chart. Out: a [`Body`], and the [`Chart`](crate::chart::Chart) in `Defs`. `build` and `actions` resolve
//! and report; `control` and `evolve` write statements, from the pieces in `emit`.

mod actions;
mod build;
mod control;
mod emit;
mod evolve;
mod groups;

use crate::body::Body;
use crate::chart::Condition;
use crate::cx::Cx;
use crate::defs::*;
use crate::expr::Checker;
use emit::*;
use plcc_diag::{Diagnostic, codes};
use plcc_syntax::ast;

/// Checks the chart that is the body of `pou` in the scope of its POU.
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
    let prefix = match pou == scope {
        true => "$".to_string(),
        false => format!("${}$", checker.cx.defs.pous[pou].name),
    };
    let mut w = Writer { c: &mut checker, owner: scope, prefix };
    let mut stmts = Vec::new();
    let state = evolve::state(&mut w, &chart);
    evolve::begin(&mut w, &chart, &state, &mut stmts);
    let groups = groups::Groups::new(&mut w, &chart);
    evolve::times(&chart, &state, &groups, &mut stmts);
    control::write(&mut w, &chart, &groups, &mut stmts);
    evolve::evaluate(&mut w, &chart, &state, &groups, &mut stmts);
    evolve::fire(&chart, &state, &groups, &mut stmts);
    let temps = checker.temps;
    cx.defs.charts.push(chart);
    Body { stmts, temps, labels }
}

/// The condition of a transition in Instruction List: the statements that compute the current result, and the BOOL that it is
/// at their end (\[I3\]). Labels are numbered from `labels` on, temporaries are the checker's.
fn il_condition<'a>(c: &mut Checker<'_, 'a>, labels: &mut u32, il: &'a ast::IlBody) -> Option<Condition> {
    let (stmts, value) = super::il::check_condition(c, il, labels);
    Some(Condition { stmts, value })
}
