//! The structure analysis of the charts of a program, as diagnostics (semantics.md \[G2\]).
//!
//! In: the resolved charts. Out: messages. What is found and when it is certain stands in [`crate::structure`].

use crate::chart::{Chart, Firing, StepId, TransitionId};
use crate::defs::Defs;
use crate::structure::{self, Finding, Kind, Limits, Net, Proof, Rule, Step, Transition};
use plcc_diag::{Code, Diagnostic, Diagnostics, Span, codes};

/// Analyses every chart. It is not part of [`crate::check`]: what a chart does is defined also where its structure is wrong,
/// and tests want to see it.
pub fn check(defs: &Defs, diags: &mut Diagnostics) {
    defs.charts.iter().flat_map(messages).for_each(|message| diags.push(message));
}

/// A chart without its actions and conditions: steps and transitions keep their numbers.
pub fn net(chart: &Chart) -> Net {
    let numbers = |steps: &[StepId]| steps.iter().map(|s| s.index()).collect();
    let step = |step: &crate::chart::Step| Step { name: step.name.to_string(), initial: step.initial };
    let transition = |t: &crate::chart::Transition| Transition {
        name: t.name.as_ref().map(|name| name.to_string()),
        from: numbers(&t.from),
        to: numbers(&t.to),
    };
    Net {
        steps: chart.steps.iter().map(step).collect(),
        transitions: chart.transitions.iter().map(transition).collect(),
        rule: match chart.firing {
            Firing::Weak => Rule::Weak,
            Firing::Strong => Rule::Strong,
        },
    }
}

fn messages(chart: &Chart) -> Vec<Diagnostic> {
    let net = net(chart);
    let report = structure::analyse(&net, Limits::default());
    let mut messages: Vec<Diagnostic> = report.findings.iter().map(|f| message(chart, &net, f)).collect();
    let Proof::Bounded { markings } = report.proof else { return messages };
    let unsafe_step = report.findings.iter().position(|f| f.kind == Kind::ActivatedTwice);
    match unsafe_step {
        // Then that is the reason, and it goes away with it.
        Some(at) => messages[at].help.push("the rest of this chart is analysed when that is mended".into()),
        None => messages.push(not_proved(chart, markings)),
    }
    messages
}

fn message(chart: &Chart, net: &Net, finding: &Finding) -> Diagnostic {
    let text = structure::text::describe(net, finding);
    let step = |s: usize| chart.steps[StepId::from_usize(s)].span;
    let transition = |t: usize| head(chart.transitions[TransitionId::from_usize(t)].span);
    let code = code(finding);
    let mut message = match (finding.kind, &finding.cause) {
        (Kind::NeverReached, _) => {
            let mut message = Diagnostic::new(code, step(finding.steps[0]), text.message);
            for &also in finding.steps.iter().skip(1).take(MORE_LABELS) {
                message = message.also(step(also), "and this one");
            }
            message
        }
        (Kind::NeverFires, _) => Diagnostic::new(code, transition(finding.transitions[0]), text.message),
        (Kind::TotallyStuck | Kind::PartiallyStuck, cause) => {
            let mut message = Diagnostic::new(code, step(finding.steps[0]), text.message).label("waits here");
            for &t in finding.transitions.iter().take(MORE_LABELS) {
                message = message.also(transition(t), "for this transition");
            }
            match cause {
                Some(cause) => message.also(transition(cause.transition), "after this one"),
                None => message,
            }
        }
        (Kind::ActivatedTwice, Some(cause)) if code == codes::LEAVES_BRANCH => {
            Diagnostic::new(code, transition(cause.transition), text.message)
                .label("jumps out of a simultaneous branch here")
                .also(step(finding.steps[0]), "this step is still active")
                .also(transition(finding.transitions[0]), "when it is activated here")
        }
        (Kind::ActivatedTwice | Kind::RulesDiffer, _) => Diagnostic::new(code, step(finding.steps[0]), text.message)
            .also(transition(finding.transitions[0]), "activated here while it is active"),
    };
    message.help.extend(text.help);
    message
}

/// Labels beside the first one, of many places of one kind.
const MORE_LABELS: usize = 4;

fn code(finding: &Finding) -> Code {
    match (finding.kind, finding.certain) {
        (Kind::NeverReached, _) => codes::NEVER_REACHED,
        (Kind::NeverFires, _) => codes::NEVER_FIRES,
        (Kind::TotallyStuck, true) => codes::TOTALLY_STUCK,
        (Kind::TotallyStuck, false) => codes::CAN_BE_STUCK,
        (Kind::PartiallyStuck, true) => codes::PARTIALLY_STUCK,
        (Kind::PartiallyStuck, false) => codes::CAN_BE_PARTIALLY_STUCK,
        (Kind::ActivatedTwice, true) => codes::ACTIVATED_TWICE,
        (Kind::ActivatedTwice, false) if finding.cause.is_some() => codes::LEAVES_BRANCH,
        (Kind::ActivatedTwice, false) => codes::CAN_BE_ACTIVATED_TWICE,
        (Kind::RulesDiffer, _) => codes::RULES_DIFFER,
    }
}

fn not_proved(chart: &Chart, markings: usize) -> Diagnostic {
    let message = format!("the structure of this chart is not proved beyond {markings} markings");
    Diagnostic::new(codes::NOT_PROVED, chart.span.before(), message)
        .help("what is reported is right, but there may be more: steps that wait for ever or are activated twice")
        .help("lanes that meet only where they begin and end are easy to prove; move separate sequences to charts of their own")
}

/// The word TRANSITION of a transition.
fn head(span: Span) -> Span {
    Span::new(span.file, span.start, span.end.min(span.start + "TRANSITION".len() as u32))
}
