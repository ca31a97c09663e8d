//! Structure analysis of Sequential Function Charts at compile time (semantics.md \[G2\]).
//!
//! In: a [`Net`], which is a chart without its actions and conditions. Out: a [`Report`] of what is wrong with it whatever
//! the notation was; [`text`] makes sentences of it. Names, spans and diagnostics are the business of the caller.
//!
//! # What is analysed
//! A *marking* is a set of active steps. One call of the chart takes it from a marking `M` to the next \[F2\]:
//!
//! 1. Enabled are the transitions whose preceding steps are all in `M`; by the strong rule \[F5\] also only those whose
//!    succeeding steps, the preceding ones aside, are not in `M`.
//! 2. The environment chooses which conditions are TRUE. They are **free Booleans**: any subset of the enabled transitions
//!    may be offered in any call. (Constant conditions are not looked at: a TRUE or FALSE written for a trial changes no
//!    verdict.)
//! 3. Of the offered transitions that share a preceding step one is chosen \[F4\]. Since the environment may offer that one
//!    alone, priorities do not change what can happen: the sets that can fire are exactly the sets of enabled transitions
//!    without a common preceding step. That is why a [`Net`] has no priorities.
//! 4. `M' = (M - preceding steps of all that fire) + succeeding steps of all that fire`: first all clear, then all set.
//!
//! Transitions fire **at once**, not interleaved, and the difference is seen: with `{A, B}` active, `A -> B` and
//! `B -> C` fired together give `{B, C}` and nothing is lost, one after the other `B` is activated while active. The analysis
//! uses the marking graph of simultaneous firing. It need not build all of it:
//!
//! - A call *activates a step twice* if it sets a step that stays active, or two of its transitions set the same step.
//! - In a marking in which no single enabled transition does that (weak rule), every set that can fire may be fired
//!   one by one with the same result, because no fired transition can clear what another has set. There single firings are
//!   enough. (Strong rule: in a marking in which no two transitions that can fire together set the same step.)
//! - In the other markings all sets are tried.
//!
//! Consequences that the code relies on: a chart that never activates a step twice has the same markings with simultaneous,
//! interleaved, weak and strong firing. So the weak rule is tried first, a chart that is safe under it needs no second
//! analysis, and *the rules differ exactly where a step could be activated while active*.
//!
//! # What "certain" means
//! Conditions that stay FALSE for ever stop any chart; nothing would be certain. So runs are *maximal*: a chart that can fire
//! some transition does at last fire one. A finding is **certain** (an error) if it holds in every maximal run, or if it says
//! that something happens in none:
//!
//! | finding | is | certain |
//! |---|---|---|
//! | never reached | a step that is in no reachable marking | always |
//! | never fires | a transition that no marking enables, though each of its preceding steps is reached and left by another way | always |
//! | stuck | a marking with a *waiting* step: active, not an end step, none of its transitions ever enabled from here on. Totally, if the chart can come to a standstill so; partially, if the others go on without ever helping it | if none of its transitions is ever enabled in any marking, or if every maximal run gets stuck |
//! | activated while active | a call that activates a step twice | if every maximal run does it |
//!
//! Where only some runs lead to the trouble the conditions decide: a warning. A marking of end steps only (no outgoing
//! transition) is finished \[F9\]; an end step beside a waiting one does not help. Trouble that lies behind a step activated
//! while active is a consequence and not reported beside it. If the run that leads to trouble passes a marking that is a normal
//! marking plus left-over steps, the transition that made it is named as the cause: it jumps out of a simultaneous branch, or
//! bypasses its convergence.
//!
//! # Size
//! The marking graph is built as it stands up to [`Limits::plain`] markings. Then the net is reduced ([`reduce`]): lanes of a
//! simultaneous branch shrink to a step, however they are built inside, and what is left is explored up to [`Limits::reduced`].
//! The reduction keeps every verdict but one: whether activating a step twice is certain is then not asked (a warning). If even
//! that is too much, only what was met on the way and what follows from the links alone is reported, and [`Report::proof`]
//! says so. Firing paths are shortest in the plain graph; behind a reduction they are firing paths without needless detours.

mod explore;
mod findings;
mod marking;
mod reduce;
mod runs;
pub mod text;

#[cfg(test)]
mod tests;

use explore::Sets;
use marking::Bits;

/// How many steps have to be inactive for a transition to fire (semantics.md \[F5\]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rule {
    /// All preceding steps active.
    #[default]
    Weak,
    /// Also all succeeding steps inactive.
    Strong,
}

/// A step.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Step {
    /// Its name, for [`text`].
    pub name: String,
    /// INITIAL_STEP.
    pub initial: bool,
}

/// A transition. Steps are indices into [`Net::steps`], each at most once in a list; lists are not empty.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Transition {
    /// Its name, for [`text`]; most have none.
    pub name: Option<String>,
    /// Preceding steps (FROM).
    pub from: Vec<usize>,
    /// Succeeding steps (TO).
    pub to: Vec<usize>,
}

/// A chart as the analysis sees it: which steps follow which. It may consist of several networks.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Net {
    /// The steps; those without an outgoing transition are end steps \[F9\].
    pub steps: Vec<Step>,
    /// The transitions, in any order.
    pub transitions: Vec<Transition>,
    /// The firing rule that the chart runs by.
    pub rule: Rule,
}

/// How far the analysis goes.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Markings of the chart as it stands.
    pub plain: usize,
    /// Markings of the reduced chart.
    pub reduced: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { plain: 10_000, reduced: 50_000 }
    }
}

/// What is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// [`Finding::steps`] are never active.
    NeverReached,
    /// The transition is never enabled, though its preceding steps are reached and left by other ways.
    NeverFires,
    /// [`Finding::steps`] wait for ever and the chart stands still.
    TotallyStuck,
    /// [`Finding::steps`] wait for ever while others go on.
    PartiallyStuck,
    /// [`Finding::steps`] are activated while active. The first of them by the last firing of the path.
    ActivatedTwice,
    /// The strong rule keeps the transition from activating a step that is active; the weak one would let it. Only reported
    /// for charts that run by the strong rule.
    RulesDiffer,
}

/// One thing that is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// What.
    pub kind: Kind,
    /// Whether it holds whatever the conditions do.
    pub certain: bool,
    /// The steps concerned, see [`Kind`].
    pub steps: Vec<usize>,
    /// The transitions concerned: those that wait, or those that activate the step.
    pub transitions: Vec<usize>,
    /// Inactive preceding steps of `transitions` that a waiting step misses. Empty if they never are active *together*.
    pub missing: Vec<usize>,
    /// The transition that left others behind, and who stays active behind it.
    pub cause: Option<Cause>,
    /// How the chart gets there; empty for what never happens.
    pub path: Path,
}

/// A jump out of a simultaneous branch.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cause {
    /// The transition that leaves the branch.
    pub transition: usize,
    /// The steps that stay active behind it.
    pub left: Vec<usize>,
    /// The convergence that it bypasses, if it leaves a step in front of one.
    pub bypassed: Option<usize>,
}

/// A run: the markings and, between each two of them, the transitions that fire in one call.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Path {
    /// One more than `firings`; empty if there is no path to show.
    pub markings: Vec<Vec<usize>>,
    /// What fires in each call, almost always one transition.
    pub firings: Vec<Vec<usize>>,
}

/// How much of the chart was seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Proof {
    /// All of it: what is not reported does not happen.
    Complete,
    /// The given number of markings; others were not visited.
    Bounded {
        /// Markings visited.
        markings: usize,
    },
}

/// What the analysis says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Report {
    /// What is wrong.
    pub findings: Vec<Finding>,
    /// Whether that is all.
    pub proof: Proof,
}

/// Analyses every network of the chart that has an initial step (the others are the caller's to report).
pub fn analyse(net: &Net, limits: Limits) -> Report {
    let mut report = Report { findings: Vec::new(), proof: Proof::Complete };
    for part in networks(net) {
        if !part.iter().any(|&s| net.steps[s].initial) {
            continue;
        }
        let own = analyse_network(net, &part, limits);
        report.findings.extend(own.findings);
        report.proof = match (report.proof, own.proof) {
            (Proof::Complete, proof) | (proof, Proof::Complete) => proof,
            (Proof::Bounded { markings: a }, Proof::Bounded { markings: b }) => Proof::Bounded { markings: a + b },
        };
    }
    report
}

/// The networks of a chart, each as its steps in order: steps that some transition links belong together \[F1\].
pub fn networks(net: &Net) -> Vec<Vec<usize>> {
    let mut leader: Vec<usize> = (0..net.steps.len()).collect();
    fn find(leader: &mut [usize], mut step: usize) -> usize {
        while leader[step] != step {
            leader[step] = leader[leader[step]];
            step = leader[step];
        }
        step
    }
    for transition in &net.transitions {
        let mut linked = transition.from.iter().chain(&transition.to);
        let Some(&first) = linked.next() else { continue };
        for &other in linked {
            let (a, b) = (find(&mut leader, first), find(&mut leader, other));
            leader[a.max(b)] = a.min(b);
        }
    }
    let mut parts: Vec<Vec<usize>> = vec![Vec::new(); net.steps.len()];
    for step in 0..net.steps.len() {
        let first = find(&mut leader, step);
        parts[first].push(step);
    }
    parts.retain(|part| !part.is_empty());
    parts
}

fn analyse_network(net: &Net, part: &[usize], limits: Limits) -> Report {
    let chart = Chart::new(net, part);
    let weak = analyse_by(&chart, Rule::Weak, limits);
    let unsafe_or_unknown =
        weak.proof != Proof::Complete || weak.findings.iter().any(|f| f.kind == Kind::ActivatedTwice);
    if net.rule == Rule::Weak || !unsafe_or_unknown {
        return weak;
    }
    let mut strong = analyse_by(&chart, Rule::Strong, limits);
    let differ = weak.findings.into_iter().find(|f| f.kind == Kind::ActivatedTwice);
    strong.findings.extend(differ.map(|f| Finding { kind: Kind::RulesDiffer, certain: false, ..f }));
    strong
}

fn analyse_by(chart: &Chart, rule: Rule, limits: Limits) -> Report {
    let plain = explore::Work::plain(chart);
    let graph = explore::explore(&plain, rule, Sets::All, limits.plain);
    if graph.complete {
        return findings::complete(chart, &plain, &graph, rule);
    }
    // The reductions keep what the weak rule can do, not what the strong one forbids.
    if rule == Rule::Strong {
        let graph = explore::explore(&plain, rule, Sets::All, limits.reduced);
        return match graph.complete {
            true => findings::complete(chart, &plain, &graph, rule),
            false => findings::bounded(chart, &plain, &graph),
        };
    }
    let reduced = reduce::reduce(chart);
    let graph = explore::explore(&reduced, rule, Sets::Single, limits.reduced);
    match graph.complete && !graph.any_contact() {
        true => findings::complete(chart, &reduced, &graph, rule),
        false => findings::bounded(chart, &reduced, &graph),
    }
}

/// One network, with what is asked of it all the time.
struct Chart<'a> {
    net: &'a Net,
    /// Its steps, in order.
    steps: Vec<usize>,
    /// Its transitions (those of other networks would be never enabled, but counted), in order.
    transitions: Vec<usize>,
    /// For each step of the whole net: transitions that leave it.
    leaving: Vec<Vec<usize>>,
    /// For each step of the whole net: transitions that enter it.
    entering: Vec<Vec<usize>>,
    initial: Bits,
}

impl<'a> Chart<'a> {
    fn new(net: &'a Net, part: &[usize]) -> Self {
        let mut leaving = vec![Vec::new(); net.steps.len()];
        let mut entering = vec![Vec::new(); net.steps.len()];
        let inside: Bits = part.iter().copied().collect();
        let mut transitions = Vec::new();
        for (index, transition) in net.transitions.iter().enumerate() {
            if !transition.from.iter().chain(&transition.to).any(|&s| inside.has(s)) {
                continue;
            }
            transitions.push(index);
            transition.from.iter().for_each(|&s| leaving[s].push(index));
            transition.to.iter().for_each(|&s| entering[s].push(index));
        }
        let initial = part.iter().copied().filter(|&s| net.steps[s].initial).collect();
        Self { net, steps: part.to_vec(), transitions, leaving, entering, initial }
    }

    fn is_end(&self, step: usize) -> bool {
        self.leaving[step].is_empty()
    }
}
