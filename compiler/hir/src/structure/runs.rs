//! What the runs through a complete marking graph have in common: what can still happen from a marking, which runs are
//! unavoidable, and the cheapest way to a marking.

use super::explore::{Edge, Graph, Work};
use super::marking::Bits;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Strongly connected components, and what is enabled from each of them on.
pub(super) struct Components {
    /// The component of each marking. Components are numbered so that edges lead to lower numbers.
    pub of: Vec<u32>,
    /// For each component, the transitions enabled in it or in what follows it.
    pub ahead: Vec<Bits>,
    /// For each component, whether no edge leaves it.
    pub bottom: Vec<bool>,
    /// For each component, whether it has an edge to itself.
    pub moves: Vec<bool>,
}

/// The components of a graph that is complete.
pub(super) fn components(graph: &Graph) -> Components {
    let of = tarjan(graph);
    let count = of.iter().max().map_or(0, |&c| c as usize + 1);
    let mut result =
        Components { of, ahead: vec![Bits::default(); count], bottom: vec![true; count], moves: vec![false; count] };
    let mut members: Vec<Vec<u32>> = vec![Vec::new(); count];
    for (marking, &component) in result.of.iter().enumerate() {
        members[component as usize].push(marking as u32);
    }
    for (component, members) in members.into_iter().enumerate() {
        let mut ahead = Bits::default();
        for marking in members {
            for edge in graph.edges(marking as usize) {
                graph.fired(edge).iter().for_each(|&t| ahead.add(t as usize));
                let next = result.of[edge.to as usize] as usize;
                if next == component {
                    result.moves[component] = true;
                } else {
                    result.bottom[component] = false;
                    ahead.add_all(&result.ahead[next]);
                }
            }
        }
        result.ahead[component] = ahead;
    }
    result
}

/// Tarjan's algorithm without recursion: a component gets its number when all that follows it has one.
fn tarjan(graph: &Graph) -> Vec<u32> {
    const NONE: u32 = u32::MAX;
    let count = graph.explored();
    let mut component = vec![NONE; count];
    let mut order = vec![NONE; count];
    let mut low = vec![NONE; count];
    let mut open: Vec<u32> = Vec::new();
    let mut work: Vec<(u32, usize)> = Vec::new();
    let (mut next_order, mut next_component) = (0, 0);
    for start in 0..count {
        if order[start] != NONE {
            continue;
        }
        work.push((start as u32, 0));
        while let Some((marking, edge)) = work.pop() {
            let m = marking as usize;
            if edge == 0 {
                order[m] = next_order;
                low[m] = next_order;
                next_order += 1;
                open.push(marking);
            } else {
                let child = graph.edges(m)[edge - 1].to as usize;
                low[m] = low[m].min(low[child]);
            }
            let mut descend = None;
            for (index, e) in graph.edges(m).iter().enumerate().skip(edge) {
                let to = e.to as usize;
                if order[to] == NONE {
                    descend = Some((index, e.to));
                    break;
                }
                if component[to] == NONE {
                    low[m] = low[m].min(order[to]);
                }
            }
            if let Some((index, to)) = descend {
                work.push((marking, index + 1));
                work.push((to, 0));
                continue;
            }
            if low[m] != order[m] {
                continue;
            }
            while let Some(member) = open.pop() {
                component[member as usize] = next_component;
                if member == marking {
                    break;
                }
            }
            next_component += 1;
        }
    }
    component
}

/// Whether every maximal run comes to an edge or a marking that is `bad`: no run that avoids them goes on for ever or ends.
pub(super) fn unavoidable(
    work: &Work,
    graph: &Graph,
    bad_marking: impl Fn(usize) -> bool,
    bad_edge: impl Fn(&Edge) -> bool,
) -> bool {
    if bad_marking(0) {
        return true;
    }
    // Markings that can be reached without the bad, and how many edges lead to each of them.
    let mut inward: Vec<u32> = vec![0; graph.explored()];
    let mut met = vec![false; graph.explored()];
    let mut todo = vec![0usize];
    met[0] = true;
    while let Some(marking) = todo.pop() {
        let edges = graph.edges(marking);
        if edges.is_empty() {
            return false;
        }
        for edge in edges.iter().filter(|e| !bad_edge(e)) {
            if graph.fired(edge).iter().any(|&t| work.transitions[t as usize].spins) {
                return false;
            }
            let to = edge.to as usize;
            if bad_marking(to) {
                continue;
            }
            inward[to] += 1;
            if !met[to] {
                met[to] = true;
                todo.push(to);
            }
        }
    }
    // What cannot be taken away in topological order lies on or behind a cycle.
    let mut left = met.iter().filter(|&&m| m).count();
    let mut free: Vec<usize> = if inward[0] == 0 { vec![0] } else { Vec::new() };
    while let Some(marking) = free.pop() {
        left -= 1;
        for edge in graph.edges(marking).iter().filter(|e| !bad_edge(e) && !bad_marking(e.to as usize)) {
            let to = edge.to as usize;
            inward[to] -= 1;
            if inward[to] == 0 {
                free.push(to);
            }
        }
    }
    left == 0
}

/// The cheapest ways from the initial marking, counted in fired transitions, that activate no step twice.
pub(super) struct Ways {
    /// Cost of each marking; `u32::MAX` if only ways that activate a step twice lead there.
    pub cost: Vec<u32>,
    came: Vec<Option<(u32, Edge)>>,
}

/// Finds the cheapest ways in what is explored.
pub(super) fn ways(work: &Work, graph: &Graph) -> Ways {
    let mut result = Ways { cost: vec![u32::MAX; graph.markings.len()], came: vec![None; graph.markings.len()] };
    let mut todo = BinaryHeap::new();
    result.cost[0] = 0;
    todo.push(Reverse((0u32, 0u32)));
    while let Some(Reverse((cost, marking))) = todo.pop() {
        if cost > result.cost[marking as usize] || marking as usize >= graph.explored() {
            continue;
        }
        for edge in graph.edges(marking as usize).iter().filter(|e| !e.contact) {
            let further = cost + price(work, graph, edge);
            if further < result.cost[edge.to as usize] {
                result.cost[edge.to as usize] = further;
                result.came[edge.to as usize] = Some((marking, *edge));
                todo.push(Reverse((further, edge.to)));
            }
        }
    }
    result
}

/// How many transitions of the chart an edge fires.
pub(super) fn price(work: &Work, graph: &Graph, edge: &Edge) -> u32 {
    graph.fired(edge).iter().map(|&t| work.transitions[t as usize].trace.len() as u32).sum()
}

impl Ways {
    /// The edges from the initial marking to this one.
    pub fn to(&self, marking: usize) -> Vec<(usize, Edge)> {
        let mut edges = Vec::new();
        let mut at = marking;
        while let Some((from, edge)) = self.came[at] {
            edges.push((from as usize, edge));
            at = from as usize;
        }
        edges.reverse();
        edges
    }
}
