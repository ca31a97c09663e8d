//! The structure analysis beside the model: what it rules out never happens in a run.

use crate::model::{Chart, Model};
use plcc_hir::structure::{self, Kind, Limits, Net, Proof, Report, Rule, Step, Transition};

/// The chart without conditions and actions.
fn net(chart: &Chart) -> Net {
    let step = |(n, s): (usize, &crate::model::Step)| Step { name: format!("S{n}"), initial: s.initial };
    let transition = |t: &crate::model::Transition| Transition { name: None, from: t.from.clone(), to: t.to.clone() };
    Net {
        steps: chart.steps.iter().enumerate().map(step).collect(),
        transitions: chart.transitions.iter().map(transition).collect(),
        rule: if chart.strong { Rule::Strong } else { Rule::Weak },
    }
}

/// What is said about a chart, and what of it is ruled out.
pub struct Ruled {
    report: Report,
    /// For each step, whether a transition leaves it.
    leaves: Vec<bool>,
    /// What was never reported, per network.
    networks: Vec<Vec<usize>>,
}

impl Ruled {
    /// Analyses a chart.
    pub fn new(chart: &Chart) -> Self {
        let net = net(chart);
        let leaves = (0..net.steps.len()).map(|s| net.transitions.iter().any(|t| t.from.contains(&s))).collect();
        Self { report: structure::analyse(&net, Limits::default()), leaves, networks: structure::networks(&net) }
    }

    /// Whether `plcc` compiles it.
    pub fn compiles(&self) -> bool {
        !self.report.findings.iter().any(|f| f.certain)
    }

    /// Whether everything was looked at.
    pub fn complete(&self) -> bool {
        self.report.proof == Proof::Complete
    }

    /// What a marking of a run contradicts.
    pub fn contradiction(&self, chart: &Chart, model: &Model) -> Option<String> {
        let active = |s: &usize| model.x[*s];
        let enabled = |t: &crate::model::Transition| {
            t.from.iter().all(active) && !(chart.strong && t.to.iter().any(|s| active(s) && !t.from.contains(s)))
        };
        for finding in &self.report.findings {
            match finding.kind {
                Kind::NeverReached if finding.steps.iter().any(active) => return Some(format!("reached: {finding:?}")),
                Kind::NeverFires if finding.transitions.iter().any(|&t| enabled(&chart.transitions[t])) => {
                    return Some(format!("enabled: {finding:?}"));
                }
                _ => {}
            }
        }
        if !self.complete() {
            return None;
        }
        for network in &self.networks {
            let told = |kinds: &[Kind]| {
                self.report
                    .findings
                    .iter()
                    .any(|f| kinds.contains(&f.kind) && f.steps.iter().any(|s| network.contains(s)))
            };
            let own = || chart.transitions.iter().filter(|t| network.contains(&t.from[0]));
            let meets =
                |t: &&crate::model::Transition| enabled(t) && t.to.iter().any(|s| active(s) && !t.from.contains(s));
            let twice = told(&[Kind::ActivatedTwice]);
            if !twice && own().any(|t| meets(&t)) {
                return Some("a step can be activated while it is active, and that was not reported".into());
            }
            let stands = !own().any(enabled);
            let waits = network.iter().any(|s| active(s) && self.leaves[*s]);
            if !twice && stands && waits && !told(&[Kind::TotallyStuck]) {
                return Some("the chart stands still, and that was not reported".into());
            }
        }
        None
    }
}
