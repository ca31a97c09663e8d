//! The marking graph of a net, as far as a limit allows.

use super::marking::{Bits, Marking, Markings};
use super::{Chart, Rule};

/// A transition of the net that is explored. In a reduced net it stands for a sequence of the chart's transitions.
#[derive(Debug, Clone)]
pub(super) struct WorkTransition {
    /// Preceding steps, sorted.
    pub from: Vec<u32>,
    /// Succeeding steps, sorted.
    pub to: Vec<u32>,
    /// The chart's transitions that it fires, in order.
    pub trace: Vec<u32>,
    /// All transitions of the chart that can fire where this one does: its own and those of other ways that were merged.
    pub covers: Bits,
    /// The sequence passes a step at which the chart may go round for ever.
    pub spins: bool,
}

impl WorkTransition {
    /// It changes nothing: a self-loop \[F7\].
    pub fn is_loop(&self) -> bool {
        self.from == self.to
    }

    fn enabled(&self, marking: Marking, rule: Rule) -> bool {
        marking.has_all(&self.from)
            && (rule == Rule::Weak || !self.to.iter().any(|s| marking.has(*s as usize) && !self.from.contains(s)))
    }

    /// Firing it alone sets a step that is active and stays so.
    pub fn contact(&self, marking: Marking) -> Option<usize> {
        self.to.iter().find(|s| marking.has(**s as usize) && !self.from.contains(s)).map(|&s| s as usize)
    }

    fn shares_preceding(&self, other: &Self) -> bool {
        self.from.iter().any(|s| other.from.contains(s))
    }

    fn shared_succeeding(&self, other: &Self) -> Option<usize> {
        self.to.iter().find(|s| other.to.contains(s)).map(|&s| s as usize)
    }
}

/// A net to explore. Steps keep the numbers that they have in the chart.
#[derive(Debug)]
pub(super) struct Work {
    /// One more than the highest step.
    pub steps: usize,
    pub initial: Bits,
    pub transitions: Vec<WorkTransition>,
    /// For each step the step that stands for it: itself, or its twin in another lane.
    pub twin_of: Vec<usize>,
}

impl Work {
    /// The chart as it stands.
    pub fn plain(chart: &Chart) -> Self {
        let sorted = |steps: &[usize]| {
            let mut steps: Vec<u32> = steps.iter().map(|&s| s as u32).collect();
            steps.sort_unstable();
            steps
        };
        let transitions = chart
            .transitions
            .iter()
            .map(|&index| WorkTransition {
                from: sorted(&chart.net.transitions[index].from),
                to: sorted(&chart.net.transitions[index].to),
                trace: vec![index as u32],
                covers: std::iter::once(index).collect(),
                spins: false,
            })
            .collect();
        let steps = chart.net.steps.len();
        Self { steps, initial: chart.initial.clone(), transitions, twin_of: (0..steps).collect() }
    }
}

/// One call of the chart.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub to: u32,
    /// A transition, or beyond them a set of [`Graph::sets`].
    fired: u32,
    /// A step is activated twice.
    pub contact: bool,
}

/// The marking graph.
#[derive(Debug)]
pub(super) struct Graph {
    pub markings: Markings,
    edges: Vec<Edge>,
    /// Where the edges of each explored marking begin, and a last entry.
    first: Vec<u32>,
    sets: Vec<Vec<u32>>,
    transitions: usize,
    /// All markings were explored.
    pub complete: bool,
}

impl Graph {
    /// Markings whose edges are known; the first one is the initial marking.
    pub fn explored(&self) -> usize {
        self.first.len() - 1
    }

    pub fn edges(&self, marking: usize) -> &[Edge] {
        &self.edges[self.first[marking] as usize..self.first[marking + 1] as usize]
    }

    /// What fires on an edge.
    pub fn fired(&self, edge: &Edge) -> Vec<u32> {
        match (edge.fired as usize).checked_sub(self.transitions) {
            None => vec![edge.fired],
            Some(set) => self.sets[set].clone(),
        }
    }

    pub fn any_contact(&self) -> bool {
        self.edges.iter().any(|e| e.contact)
    }
}

/// Sets of transitions tried in one marking; more than that is not explored.
const MAX_SETS: usize = 4096;
/// Edges kept for each marking of the limit.
const EDGES_PER_MARKING: usize = 32;

/// How exact the marking graph is where a step can be activated while active.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sets {
    /// All sets of transitions that can fire together are tried.
    All,
    /// Single firings only: enough to see that it happens, and for charts in which it does not.
    Single,
}

/// Explores breadth first until everything or `limit` markings are known.
pub(super) fn explore(work: &Work, rule: Rule, sets: Sets, limit: usize) -> Graph {
    let mut graph = Graph {
        markings: Markings::new(work.steps),
        edges: Vec::new(),
        first: vec![0],
        sets: Vec::new(),
        transitions: work.transitions.len(),
        complete: true,
    };
    let start = graph.markings.fit(&work.initial);
    graph.markings.number(&start);
    let by_step = candidates(work);
    let mut next = 0;
    while next < graph.markings.len() {
        if graph.markings.len() > limit || graph.edges.len() > limit * EDGES_PER_MARKING {
            graph.complete = false;
            break;
        }
        let marking = graph.markings.get(next);
        let enabled: Vec<u32> = marking
            .iter()
            .flat_map(|step| by_step[step].iter().copied())
            .filter(|&t| work.transitions[t as usize].enabled(marking, rule))
            .collect();
        expand(work, rule, sets, &mut graph, next, &enabled);
        graph.first.push(graph.edges.len() as u32);
        next += 1;
    }
    graph
}

/// For each step the transitions of which it is the first preceding one.
fn candidates(work: &Work) -> Vec<Vec<u32>> {
    let mut by_step = vec![Vec::new(); work.steps];
    for (index, transition) in work.transitions.iter().enumerate() {
        by_step[transition.from[0] as usize].push(index as u32);
    }
    by_step
}

fn expand(work: &Work, rule: Rule, wanted: Sets, graph: &mut Graph, from: usize, enabled: &[u32]) {
    let transition = |t: &u32| &work.transitions[*t as usize];
    for t in enabled {
        let contact = transition(t).contact(graph.markings.get(from)).is_some();
        fire(work, graph, from, &[*t], *t, contact);
    }
    let marking = graph.markings.get(from);
    let all_sets = match rule {
        Rule::Weak => enabled.iter().any(|t| transition(t).contact(marking).is_some()),
        Rule::Strong => pairs(work, enabled).any(|(a, b)| a.shared_succeeding(b).is_some()),
    };
    if !all_sets || wanted == Sets::Single {
        // The single firings come to the same; only what two set together is to be seen here.
        let together = enabled.iter().enumerate().find_map(|(i, a)| {
            let partner = enabled[i + 1..].iter().find(|b| {
                !transition(a).shares_preceding(transition(b))
                    && transition(a).shared_succeeding(transition(b)).is_some()
            });
            partner.map(|b| vec![*a, *b])
        });
        if let Some(set) = together {
            fire_set(work, graph, from, set);
        }
        return;
    }
    let mut sets: Vec<Vec<u32>> = vec![Vec::new()];
    for t in enabled {
        for index in 0..sets.len() {
            if sets[index].iter().any(|u| transition(u).shares_preceding(transition(t))) {
                continue;
            }
            if sets.len() >= MAX_SETS {
                graph.complete = false;
                break;
            }
            let mut set = sets[index].clone();
            set.push(*t);
            sets.push(set);
        }
    }
    for set in sets.into_iter().filter(|set| set.len() > 1) {
        fire_set(work, graph, from, set);
    }
}

fn pairs<'w>(work: &'w Work, enabled: &[u32]) -> impl Iterator<Item = (&'w WorkTransition, &'w WorkTransition)> {
    enabled.iter().enumerate().flat_map(move |(i, &a)| {
        let a = &work.transitions[a as usize];
        enabled[i + 1..]
            .iter()
            .map(|&b| &work.transitions[b as usize])
            .filter(|b| !a.shares_preceding(b))
            .map(move |b| (a, b))
    })
}

fn fire_set(work: &Work, graph: &mut Graph, from: usize, set: Vec<u32>) {
    let contact = twice(work, graph.markings.get(from), &set).is_some();
    let label = (graph.transitions + graph.sets.len()) as u32;
    fire(work, graph, from, &set, label, contact);
    graph.sets.push(set);
}

fn fire(work: &Work, graph: &mut Graph, from: usize, set: &[u32], fired: u32, contact: bool) {
    let mut next: Bits = graph.markings.get(from).iter().collect();
    for &t in set {
        work.transitions[t as usize].from.iter().for_each(|&s| next.remove(s as usize));
    }
    for &t in set {
        work.transitions[t as usize].to.iter().for_each(|&s| next.add(s as usize));
    }
    let next = graph.markings.fit(&next);
    let to = graph.markings.number(&next) as u32;
    graph.edges.push(Edge { to, fired, contact });
}

/// The step that a call activates twice, and the transition that does it.
pub(super) fn twice(work: &Work, marking: Marking, set: &[u32]) -> Option<(usize, u32)> {
    let cleared = |step: u32| set.iter().any(|&t| work.transitions[t as usize].from.contains(&step));
    for (position, &t) in set.iter().enumerate() {
        for &step in &work.transitions[t as usize].to {
            let stays = marking.has(step as usize) && !cleared(step);
            let again = set[..position].iter().any(|&u| work.transitions[u as usize].to.contains(&step));
            if stays || again {
                return Some((step as usize, t));
            }
        }
    }
    None
}
