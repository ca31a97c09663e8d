//! From a marking graph to findings.

use super::explore::{Graph, Work, twice};
use super::marking::Bits;
use super::runs::{Components, Ways, components, price, unavoidable, ways};
use super::{Cause, Chart, Finding, Kind, Path, Proof, Report, Rule};
use rustc_hash::FxHashMap;

/// All findings, from a graph that is complete. A reduced net must not activate a step twice.
pub(super) fn complete(chart: &Chart, work: &Work, graph: &Graph, rule: Rule) -> Report {
    let view = View { chart, work, graph, rule, ways: ways(work, graph) };
    let parts = components(graph);
    let alive = view.covered(&parts.ahead[parts.of[0] as usize]);
    let mut findings = Vec::new();
    findings.extend(view.activated_twice(true));
    findings.extend(view.waiting(&parts, &alive));
    never(chart, &alive, &mut findings, |transition| view.way_to_most(transition));
    Report { findings, proof: Proof::Complete }
}

/// What was met before the limit, and what follows from the links alone.
pub(super) fn bounded(chart: &Chart, work: &Work, graph: &Graph) -> Report {
    let view = View { chart, work, graph, rule: Rule::Weak, ways: ways(work, graph) };
    let mut findings = Vec::new();
    findings.extend(view.activated_twice(false));
    findings.extend(view.standstill());
    let linked = super::reduce::linked(&Work::plain(chart));
    let alive =
        chart.transitions.iter().copied().filter(|&t| chart.net.transitions[t].from.iter().all(|&s| linked.has(s)));
    never(chart, &alive.collect(), &mut findings, |_| Path::default());
    Report { findings, proof: Proof::Bounded { markings: graph.markings.len() } }
}

/// Steps that are never active and transitions that never fire, given those that do.
fn never(chart: &Chart, alive: &Bits, findings: &mut Vec<Finding>, way: impl Fn(usize) -> Path) {
    let mut reached = chart.initial.clone();
    for t in alive.iter() {
        chart.net.transitions[t].to.iter().for_each(|&s| reached.add(s));
    }
    let dead: Vec<usize> = chart.transitions.iter().copied().filter(|&t| !alive.has(t)).collect();
    let ready = |t: usize, reached: &Bits| chart.net.transitions[t].from.iter().all(|&s| reached.has(s));
    let roots: Vec<usize> = dead.iter().copied().filter(|&t| ready(t, &reached)).collect();
    let told =
        |t: usize| findings.iter().any(|f| f.certain && f.transitions.contains(&t) && f.kind != Kind::ActivatedTwice);
    let untold: Vec<usize> = roots.iter().copied().filter(|&t| !told(t)).collect();
    // What those transitions would reach is a consequence.
    let mut explained = reached.clone();
    roots.iter().for_each(|&t| chart.net.transitions[t].to.iter().for_each(|&s| explained.add(s)));
    loop {
        let more: Vec<usize> = dead
            .iter()
            .filter(|&&t| ready(t, &explained))
            .flat_map(|&t| chart.net.transitions[t].to.iter().copied())
            .filter(|&s| !explained.has(s))
            .collect();
        if more.is_empty() {
            break;
        }
        more.into_iter().for_each(|s| explained.add(s));
    }
    for t in untold {
        findings.push(Finding {
            kind: Kind::NeverFires,
            certain: true,
            steps: chart.net.transitions[t].to.iter().copied().filter(|&s| !reached.has(s)).collect(),
            transitions: vec![t],
            missing: Vec::new(),
            cause: None,
            path: way(t),
        });
    }
    let unlinked: Vec<usize> = chart.steps.iter().copied().filter(|&s| !explained.has(s)).collect();
    for steps in linked_groups(chart, &unlinked) {
        let entering = |s: usize| chart.entering[s].iter().copied();
        findings.push(Finding {
            kind: Kind::NeverReached,
            certain: true,
            transitions: steps.iter().flat_map(|&s| entering(s)).collect(),
            steps,
            missing: Vec::new(),
            cause: None,
            path: Path::default(),
        });
    }
}

/// Steps that a transition links directly, in groups.
fn linked_groups(chart: &Chart, steps: &[usize]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for &step in steps {
        let near: Bits = chart.leaving[step]
            .iter()
            .chain(&chart.entering[step])
            .flat_map(|&t| chart.net.transitions[t].from.iter().chain(&chart.net.transitions[t].to).copied())
            .collect();
        let (mut joined, rest): (Vec<_>, Vec<_>) = groups.into_iter().partition(|g| g.iter().any(|&s| near.has(s)));
        joined.push(vec![step]);
        groups = rest;
        let mut group: Vec<usize> = joined.concat();
        group.sort_unstable();
        groups.push(group);
    }
    groups.sort();
    groups
}

struct View<'a> {
    chart: &'a Chart<'a>,
    work: &'a Work,
    graph: &'a Graph,
    rule: Rule,
    ways: Ways,
}

impl View<'_> {
    /// The chart's transitions that some of these can fire.
    fn covered(&self, transitions: &Bits) -> Bits {
        let mut covered = Bits::default();
        transitions.iter().for_each(|t| covered.add_all(&self.work.transitions[t].covers));
        covered
    }

    fn is_reduced(&self) -> bool {
        self.work.transitions.len() != self.chart.transitions.len()
            || self.work.twin_of.iter().enumerate().any(|(step, &twin)| step != twin)
    }

    fn clean(&self, marking: usize) -> bool {
        self.ways.cost[marking] != u32::MAX
    }

    // ---- a step activated while active ----

    fn activated_twice(&self, complete: bool) -> Option<Finding> {
        // The cheapest; of these one in which a single transition fires.
        let mut best: Option<((u32, usize), usize, super::explore::Edge)> = None;
        let mut steps = Bits::default();
        for marking in (0..self.graph.explored()).filter(|&m| self.clean(m)) {
            for edge in self.graph.edges(marking).iter().filter(|e| e.contact) {
                let fired = self.graph.fired(edge);
                let cost = (self.ways.cost[marking] + price(self.work, self.graph, edge), fired.len());
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, marking, *edge));
                }
                if let Some((step, _)) = twice(self.work, self.graph.markings.get(marking), &fired) {
                    steps.add(step);
                }
            }
        }
        let (_, marking, edge) = best?;
        let mut calls = self.calls(&self.ways.to(marking));
        calls.extend(self.fired_calls(&edge));
        let run = Run::of(self.chart, self.rule, &calls)?;
        let run = if self.is_reduced() { run.shortened_to_contact() } else { run };
        let (first, by) = run.contact?;
        steps.remove(first);
        Some(Finding {
            kind: Kind::ActivatedTwice,
            certain: complete && !self.is_reduced() && unavoidable(self.work, self.graph, |_| false, |e| e.contact),
            steps: std::iter::once(first).chain(steps.iter()).collect(),
            transitions: vec![by],
            missing: Vec::new(),
            cause: self.cause(&run),
            path: run.path(),
        })
    }

    // ---- waiting steps ----

    /// Whether a step that is active waits for ever, given what can still be enabled.
    fn waits(&self, step: usize, ahead: &Bits) -> bool {
        !self.chart.is_end(step)
            && !ahead.iter().any(|t| self.work.transitions[t].from.binary_search(&(step as u32)).is_ok())
    }

    fn waiting(&self, parts: &Components, alive: &Bits) -> Vec<Finding> {
        // Steps that wait, of each component.
        let mut leaves: Vec<Bits> = Vec::with_capacity(parts.ahead.len());
        for ahead in &parts.ahead {
            let mut left = Bits::default();
            for t in ahead.iter() {
                self.work.transitions[t].from.iter().for_each(|&s| left.add(s as usize));
            }
            leaves.push(left);
        }
        let mut first: FxHashMap<usize, usize> = FxHashMap::default();
        let mut standstill = Bits::default();
        let mut stuck = vec![false; self.graph.explored()];
        for (marking, stuck) in stuck.iter_mut().enumerate() {
            let part = parts.of[marking] as usize;
            for step in self.graph.markings.get(marking).iter() {
                if self.chart.is_end(step) || leaves[part].has(step) {
                    continue;
                }
                *stuck = true;
                if parts.bottom[part] && !parts.moves[part] {
                    standstill.add(step);
                }
                if !self.clean(marking) {
                    continue;
                }
                let least = first.entry(step).or_insert(marking);
                if self.ways.cost[marking] < self.ways.cost[*least] {
                    *least = marking;
                }
            }
        }
        if first.is_empty() {
            return Vec::new();
        }
        let always = unavoidable(self.work, self.graph, |m| stuck[m], |_| false);
        let mut steps: Vec<usize> = first.keys().copied().collect();
        steps.sort_unstable();
        let (still, going): (Vec<usize>, Vec<usize>) = steps.into_iter().partition(|&s| standstill.has(s));
        let totally = self.waiting_together(&still).into_iter().map(|group| (Kind::TotallyStuck, group));
        let partially = self.waiting_together(&going).into_iter().map(|group| (Kind::PartiallyStuck, group));
        let mut findings = Vec::new();
        for (kind, group) in totally.chain(partially) {
            let marking = group.iter().map(|s| first[s]).min_by_key(|&m| (self.ways.cost[m], m)).unwrap_or(0);
            let ahead = &parts.ahead[parts.of[marking] as usize];
            findings.extend(self.stuck(kind, marking, ahead, &group, |t| always || !alive.has(t)));
        }
        findings
    }

    /// Waiting steps that share a transition are one trouble.
    fn waiting_together(&self, steps: &[usize]) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for &step in steps {
            let shares =
                |other: &usize| self.chart.leaving[step].iter().any(|t| self.chart.leaving[*other].contains(t));
            let (joined, rest): (Vec<_>, Vec<_>) = groups.into_iter().partition(|g: &Vec<usize>| g.iter().any(shares));
            groups = rest;
            groups.push(joined.into_iter().flatten().chain([step]).collect());
        }
        groups
    }

    /// The finding for steps of `group` that wait for ever in `marking`; `ahead` is what can still be enabled there.
    fn stuck(
        &self,
        kind: Kind,
        marking: usize,
        ahead: &Bits,
        group: &[usize],
        hopeless: impl Fn(usize) -> bool,
    ) -> Option<Finding> {
        let here: Bits = self.graph.markings.get(marking).iter().collect();
        let waiting: Vec<usize> = group.iter().copied().filter(|&s| here.has(s) && self.waits(s, ahead)).collect();
        let run = Run::of(self.chart, self.rule, &self.calls(&self.ways.to(marking)))?;
        if run.contact.is_some() {
            return None;
        }
        let all = run.markings.last()?.clone();
        let run = if self.is_reduced() { run.shortened_to_waiting(&waiting) } else { run };
        let cause = self.cause(&run);
        let now = run.markings.last()?.clone();
        // Twins wait beside the steps that stand for them.
        let mut steps: Vec<usize> = self
            .chart
            .steps
            .iter()
            .copied()
            .filter(|&s| waiting.contains(&self.work.twin_of[s]) && now.has(s))
            .collect();
        steps.sort_unstable();
        let mut transitions: Vec<usize> = steps.iter().flat_map(|&s| self.chart.leaving[s].iter().copied()).collect();
        transitions.sort_unstable();
        transitions.dedup();
        let coming = self.covered(ahead);
        let lost = |s: usize| !all.has(s) && !self.chart.entering[s].iter().any(|&t| coming.has(t));
        let missing = transitions
            .iter()
            .map(|&t| self.chart.net.transitions[t].from.iter().copied().filter(|&s| lost(s)).collect::<Vec<_>>())
            .find(|lost| !lost.is_empty());
        Some(Finding {
            kind,
            certain: transitions.iter().all(|&t| hopeless(t)),
            missing: missing.unwrap_or_default(),
            cause,
            steps,
            transitions,
            path: run.path(),
        })
    }

    /// A marking met on the way from which nothing goes on.
    fn standstill(&self) -> Vec<Finding> {
        let dead = |m: usize| self.clean(m) && self.graph.edges(m).is_empty();
        let mut found: Vec<Finding> = Vec::new();
        let mut markings: Vec<usize> = (0..self.graph.explored()).filter(|&m| dead(m)).collect();
        markings.sort_by_key(|&m| (self.ways.cost[m], m));
        let nothing = Bits::default();
        for marking in markings {
            let steps: Vec<usize> =
                self.graph.markings.get(marking).iter().filter(|&s| !self.chart.is_end(s)).collect();
            if steps.is_empty() || found.iter().any(|f| f.steps.iter().any(|s| steps.contains(s))) {
                continue;
            }
            found.extend(self.stuck(Kind::TotallyStuck, marking, &nothing, &steps, |_| false));
        }
        found
    }

    // ---- causes and ways ----

    /// The transition of a run that left steps active that a normal marking, reached or on the way, does without.
    fn cause(&self, run: &Run) -> Option<Cause> {
        let normal: Vec<Bits> =
            (0..self.graph.explored()).filter(|&m| self.clean(m)).map(|m| self.expanded(m)).collect();
        for (index, call) in run.calls.iter().enumerate() {
            let (before, after) = (&run.markings[index], &run.markings[index + 1]);
            let set: Bits = call.iter().flat_map(|&t| self.chart.net.transitions[t].to.iter().copied()).collect();
            let least = normal
                .iter()
                .chain(&run.markings[..=index])
                .filter(|normal| after.strictly_covers(normal))
                .map(|normal| after.iter().filter(|&s| !normal.has(s)).collect::<Vec<usize>>())
                .filter(|left| left.iter().all(|&s| before.has(s) && !set.has(s)))
                .min_by_key(Vec::len);
            let Some(left) = least else { continue };
            let transition = *call.last()?;
            let lane = &self.chart.net.transitions[transition].from;
            let bypassed = self.chart.transitions.iter().copied().find(|&t| {
                let from = &self.chart.net.transitions[t].from;
                t != transition && from.len() > 1 && from.iter().any(|s| lane.contains(s))
            });
            return Some(Cause { transition, left, bypassed });
        }
        None
    }

    /// A marking with the twins of its steps.
    fn expanded(&self, marking: usize) -> Bits {
        let marking = self.graph.markings.get(marking);
        self.chart.steps.iter().copied().filter(|&s| marking.has(self.work.twin_of[s])).collect()
    }

    /// The way to the marking that has most of the preceding steps of a transition.
    fn way_to_most(&self, transition: usize) -> Path {
        let wanted = &self.chart.net.transitions[transition].from;
        let has = |m: usize| {
            let marking = self.graph.markings.get(m);
            wanted.iter().filter(|&&s| marking.has(self.work.twin_of[s])).count()
        };
        let best = (0..self.graph.explored())
            .filter(|&m| self.clean(m))
            .min_by_key(|&m| (std::cmp::Reverse(has(m)), self.ways.cost[m], m));
        let way = best.map(|m| self.calls(&self.ways.to(m))).unwrap_or_default();
        Run::of(self.chart, self.rule, &way).map(Run::path).unwrap_or_default()
    }

    fn calls(&self, edges: &[(usize, super::explore::Edge)]) -> Vec<Vec<usize>> {
        edges.iter().flat_map(|(_, edge)| self.fired_calls(edge)).collect()
    }

    /// An edge as calls of the chart.
    fn fired_calls(&self, edge: &super::explore::Edge) -> Vec<Vec<usize>> {
        let fired = self.graph.fired(edge);
        let traces: Vec<&Vec<u32>> = fired.iter().map(|&t| &self.work.transitions[t as usize].trace).collect();
        if traces.iter().all(|trace| trace.len() == 1) {
            return vec![traces.iter().map(|trace| trace[0] as usize).collect()];
        }
        traces.into_iter().flatten().map(|&t| vec![t as usize]).collect()
    }
}

/// A run of the chart itself, up to its end or to the first step that is activated twice.
struct Run<'a> {
    chart: &'a Chart<'a>,
    rule: Rule,
    calls: Vec<Vec<usize>>,
    markings: Vec<Bits>,
    /// The step that the last call activates twice, and the transition that does so.
    contact: Option<(usize, usize)>,
}

impl<'a> Run<'a> {
    /// `None` if the calls are no run.
    fn of(chart: &'a Chart<'a>, rule: Rule, calls: &[Vec<usize>]) -> Option<Self> {
        let mut run = Self { chart, rule, calls: Vec::new(), markings: vec![chart.initial.clone()], contact: None };
        for call in calls {
            if run.contact.is_some() {
                break;
            }
            run.fire(call)?;
        }
        Some(run)
    }

    fn fire(&mut self, call: &[usize]) -> Option<()> {
        let now = self.markings.last()?.clone();
        let transitions = || call.iter().map(|&t| (t, &self.chart.net.transitions[t]));
        for (_, transition) in transitions() {
            let ready = transition.from.iter().all(|&s| now.has(s));
            let free = transition.to.iter().all(|s| !now.has(*s) || transition.from.contains(s));
            if !ready || (self.rule == Rule::Strong && !free) {
                return None;
            }
        }
        let mut next = now;
        transitions().for_each(|(_, transition)| transition.from.iter().for_each(|&s| next.remove(s)));
        for (t, transition) in transitions() {
            for &step in &transition.to {
                if next.has(step) {
                    self.contact = self.contact.or(Some((step, t)));
                }
                next.add(step);
            }
        }
        self.calls.push(call.to_vec());
        self.markings.push(next);
        Some(())
    }

    fn without(&self, position: usize) -> Option<Self> {
        let mut calls = self.calls.clone();
        calls.remove(position);
        Self::of(self.chart, self.rule, &calls)
    }

    /// Leaves out calls that are not needed to activate a step twice. Behind a left-out call it may be another step.
    fn shortened_to_contact(mut self) -> Self {
        for position in (0..self.calls.len()).rev() {
            if position >= self.calls.len() {
                continue;
            }
            match self.without(position) {
                Some(shorter) if shorter.contact.is_some() => self = shorter,
                _ => {}
            }
        }
        self
    }

    /// Leaves out calls of other lanes that would come by themselves: the only transition behind a step.
    fn shortened_to_waiting(mut self, waiting: &[usize]) -> Self {
        for position in (0..self.calls.len()).rev() {
            let Some(&[t]) = self.calls.get(position).map(Vec::as_slice) else { continue };
            let transition = &self.chart.net.transitions[t];
            let by_itself = matches!(transition.from.as_slice(), [s] if self.chart.leaving[*s] == [t]);
            if !by_itself {
                continue;
            }
            let Some(shorter) = self.without(position) else { continue };
            if shorter.contact.is_none() && shorter.markings.last().is_some_and(|m| waiting.iter().all(|&s| m.has(s))) {
                self = shorter;
            }
        }
        self
    }

    fn path(self) -> Path {
        Path { markings: self.markings.iter().map(|m| m.iter().collect()).collect(), firings: self.calls }
    }
}
