//! Which element is evaluated when. See the parent module for the rules.
//!
//! Nothing here recurses: drawings may be chains of any length.

use super::links::Links;
use plcc_syntax::ast::*;
use rustc_hash::FxHashSet;

/// Loops that are broken by the rules; what a drawing has more of is broken where the walk meets it.
const MAX_LOOPS: usize = 500;

/// The elements in the order of their evaluation; comments, rails and connectors are not among them.
pub(super) fn order(network: &Network, links: &Links) -> Vec<usize> {
    let elements = &network.elements;
    let deps: Vec<Vec<usize>> = links
        .inputs
        .iter()
        .map(|pins| {
            let mut seen = FxHashSet::default();
            let sources = pins.iter().flatten().map(|(s, _)| s.element);
            sources.filter(|s| is_evaluated(&elements[*s]) && seen.insert(*s)).collect()
        })
        .collect();
    let broken = break_loops(elements, &deps);
    let networks = networks(elements, &deps);
    let mut roots: Vec<usize> = (0..elements.len()).filter(|i| is_evaluated(&elements[*i])).collect();
    roots.sort_by(|a, b| {
        let (left, right) = (&elements[*a], &elements[*b]);
        let by_order = match (left.order, right.order) {
            (Some(x), Some(y)) => x.cmp(&y),
            (Some(_), None) => std::cmp::Ordering::Less,
            (None, Some(_)) => std::cmp::Ordering::Greater,
            (None, None) => {
                let (x, y) = (networks[*a], networks[*b]);
                acts(right).cmp(&acts(left)).then(x.0.total_cmp(&y.0)).then(x.1.total_cmp(&y.1)).then(x.2.cmp(&y.2))
            }
        };
        let (p, q) = (left.position, right.position);
        by_order.then(p.y.total_cmp(&q.y)).then(p.x.total_cmp(&q.x)).then(a.cmp(b))
    });
    let mut walk =
        Walk { elements, deps: &deps, broken: &broken, state: vec![State::New; elements.len()], out: Vec::new() };
    for root in roots {
        walk.from(root);
    }
    walk.out
}

fn is_evaluated(element: &Element) -> bool {
    !matches!(
        element.kind,
        ElementKind::Comment(_)
            | ElementKind::LeftRail
            | ElementKind::RightRail
            | ElementKind::Connector(_)
            | ElementKind::Continuation(_)
    )
}

/// Does something besides giving a value.
fn acts(element: &Element) -> bool {
    match &element.kind {
        ElementKind::Contact { .. } | ElementKind::In { .. } | ElementKind::Block { instance: None, .. } => false,
        ElementKind::InOut { .. } => !element.inputs.iter().all(|p| p.connections.is_empty()),
        _ => true,
    }
}

/// For each element top and left of its network, and a number of the network.
fn networks(elements: &[Element], deps: &[Vec<usize>]) -> Vec<(f64, f64, usize)> {
    let mut parent: Vec<usize> = (0..elements.len()).collect();
    fn root(parent: &mut [usize], mut at: usize) -> usize {
        while parent[at] != at {
            parent[at] = parent[parent[at]];
            at = parent[at];
        }
        at
    }
    for (element, sources) in deps.iter().enumerate() {
        for source in sources {
            let (a, b) = (root(&mut parent, element), root(&mut parent, *source));
            parent[a.max(b)] = a.min(b);
        }
    }
    let mut corner: Vec<(f64, f64)> = vec![(f64::INFINITY, f64::INFINITY); elements.len()];
    for (index, element) in elements.iter().enumerate() {
        let (at, p) = (root(&mut parent, index), element.position);
        if (p.y, p.x) < corner[at] {
            corner[at] = (p.y, p.x);
        }
    }
    (0..elements.len())
        .map(|index| {
            let at = root(&mut parent, index);
            (corner[at].0, corner[at].1, at)
        })
        .collect()
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    New,
    Open,
    Done,
}

/// Depth first, sources before consumers.
struct Walk<'n> {
    elements: &'n [Element],
    deps: &'n [Vec<usize>],
    broken: &'n FxHashSet<(usize, usize)>,
    state: Vec<State>,
    out: Vec<usize>,
}

impl Walk<'_> {
    fn from(&mut self, root: usize) {
        if self.state[root] != State::New {
            return;
        }
        let limit = self.elements[root].order;
        self.state[root] = State::Open;
        let mut stack = vec![(root, 0)];
        while let Some((element, next)) = stack.last_mut() {
            let Some(&source) = self.deps[*element].get(*next) else {
                self.state[*element] = State::Done;
                self.out.push(*element);
                stack.pop();
                continue;
            };
            *next += 1;
            let broken = self.broken.contains(&(source, *element));
            // What is numbered comes when its number comes: read before, it gives the value of the cycle before.
            let later = matches!((self.elements[source].order, limit), (Some(own), Some(limit)) if own > limit);
            if self.state[source] == State::New && !broken && !later {
                self.state[source] = State::Open;
                stack.push((source, 0));
            }
        }
    }
}

/// The connections (source, consumer) that loops are broken at.
fn break_loops(elements: &[Element], deps: &[Vec<usize>]) -> FxHashSet<(usize, usize)> {
    let mut broken = FxHashSet::default();
    let mut open: Vec<Vec<usize>> = components((0..elements.len()).collect(), deps, &broken);
    let mut loops = 0;
    while let Some(members) = open.pop() {
        loops += 1;
        // Where all blocks are numbered, the numbers decide.
        let unnumbered =
            |i: &&usize| matches!(elements[**i].kind, ElementKind::Block { .. }) && elements[**i].order.is_none();
        let has_blocks = members.iter().any(|i| matches!(elements[*i].kind, ElementKind::Block { .. }));
        if loops > MAX_LOOPS || (has_blocks && !members.iter().any(|i| unnumbered(&i))) {
            continue;
        }
        let rank = |i: usize| match &elements[i].kind {
            ElementKind::Block { instance: Some(_), .. } => 2,
            ElementKind::InOut { .. } => 1,
            _ => 0,
        };
        let last = members.iter().copied().max_by(|a, b| {
            let (p, q) = (elements[*a].position, elements[*b].position);
            rank(*a).cmp(&rank(*b)).then(p.x.total_cmp(&q.x)).then(p.y.total_cmp(&q.y)).then(a.cmp(b))
        });
        let Some(last) = last else { continue };
        for member in &members {
            if deps[*member].contains(&last) {
                broken.insert((last, *member));
            }
        }
        open.extend(components(members, deps, &broken));
    }
    broken
}

/// The loops among some elements: sets in which each element leads to each other (Tarjan, without recursion).
fn components(members: Vec<usize>, deps: &[Vec<usize>], broken: &FxHashSet<(usize, usize)>) -> Vec<Vec<usize>> {
    let position: rustc_hash::FxHashMap<usize, usize> = members.iter().enumerate().map(|(p, m)| (*m, p)).collect();
    const NONE: usize = usize::MAX;
    let mut index = vec![NONE; members.len()];
    let mut low = vec![0; members.len()];
    let mut on_stack = vec![false; members.len()];
    let (mut stack, mut found, mut count) = (Vec::new(), Vec::new(), 0);
    for start in 0..members.len() {
        if index[start] != NONE {
            continue;
        }
        let mut work = vec![(start, 0usize)];
        while let Some(&mut (at, ref mut next)) = work.last_mut() {
            if *next == 0 && index[at] == NONE {
                (index[at], low[at]) = (count, count);
                count += 1;
                stack.push(at);
                on_stack[at] = true;
            }
            let source = deps[members[at]].get(*next).copied();
            *next += 1;
            let Some(source) = source else {
                work.pop();
                if let Some(&(outer, _)) = work.last() {
                    low[outer] = low[outer].min(low[at]);
                }
                if low[at] == index[at] {
                    let mut set = Vec::new();
                    while let Some(member) = stack.pop() {
                        on_stack[member] = false;
                        set.push(members[member]);
                        if member == at {
                            break;
                        }
                    }
                    let own = set[0];
                    let itself = set.len() == 1 && deps[own].contains(&own) && !broken.contains(&(own, own));
                    if set.len() > 1 || itself {
                        found.push(set);
                    }
                }
                continue;
            };
            if broken.contains(&(source, members[at])) {
                continue;
            }
            let Some(&to) = position.get(&source) else { continue };
            if index[to] == NONE {
                work.push((to, 0));
            } else if on_stack[to] {
                low[at] = low[at].min(index[to]);
            }
        }
    }
    found
}
