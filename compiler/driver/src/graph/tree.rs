//! The shape of a chart: what encloses what.
//!
//! Steps and transitions are the nodes of one graph. Links to what must have been active before are *backwards* and become
//! jumps. On what is left, a node *dominates* what can be reached through it only. What has one way to it continues a line;
//! what has several, and is dominated by the node where they part, is where branches meet again.

use super::chart::Chart;
use std::collections::{BTreeMap, HashSet, VecDeque};

/// Nodes: first the steps, then the transitions.
pub type Node = usize;

/// The graph with its dominators.
#[derive(Debug)]
pub struct Tree {
    steps: usize,
    succ: Vec<Vec<Node>>,
    pred: Vec<Vec<Node>>,
    /// Nodes at which a drawing begins: the initial steps, and what nothing leads to from there.
    pub roots: Vec<Node>,
    /// The root from which a node is drawn.
    root: Vec<Node>,
    /// The nearest dominator; a root's is itself.
    parent: Vec<Node>,
    /// Position in an order in which links that are not jumps lead forward.
    order: Vec<usize>,
    /// What must have been active before a node.
    back: Vec<Nodes>,
}

/// A set of nodes, as bits.
#[derive(Debug, Clone, Default)]
struct Nodes(Vec<u64>);

impl Nodes {
    fn has(&self, node: Node) -> bool {
        self.0.get(node / 64).is_some_and(|word| word >> (node % 64) & 1 == 1)
    }

    /// These, those, and one more.
    fn join(&mut self, others: &Nodes, node: Node) {
        self.0.resize(self.0.len().max(others.0.len()).max(node / 64 + 1), 0);
        for (word, more) in self.0.iter_mut().zip(&others.0) {
            *word |= more;
        }
        self.0[node / 64] |= 1 << (node % 64);
    }
}

impl Tree {
    /// Of a chart.
    pub fn new(chart: &Chart) -> Self {
        let steps = chart.steps.len();
        let count = steps + chart.transitions.len();
        let mut tree = Self {
            steps,
            succ: vec![Vec::new(); count],
            pred: vec![Vec::new(); count],
            roots: Vec::new(),
            root: vec![usize::MAX; count],
            parent: vec![usize::MAX; count],
            order: vec![usize::MAX; count],
            back: vec![Nodes::default(); count],
        };
        // From left to right as they are chosen: explicit priorities first (semantics.md [F4]).
        let mut ranked: Vec<usize> = (0..chart.transitions.len()).collect();
        let rank = |t: &usize| match chart.transitions[*t].priority.as_ref().and_then(|p| p.parse::<i128>().ok()) {
            Some(number) => (false, number, *t),
            None => (true, 0, *t),
        };
        ranked.sort_by_key(rank);
        for t in ranked {
            for &s in &chart.transitions[t].from {
                tree.link(s, steps + t);
            }
            for &s in &chart.transitions[t].to {
                tree.link(steps + t, s);
            }
        }
        let initial = (0..steps).filter(|&s| chart.steps[s].initial);
        let begins = (0..count).filter(|&n| tree.pred[n].is_empty());
        let candidates: Vec<Node> = initial.chain(begins).chain(0..count).collect();
        for node in candidates {
            if tree.root[node] == usize::MAX {
                tree.roots.push(node);
                tree.grow(node);
            }
        }
        tree
    }

    fn link(&mut self, from: Node, to: Node) {
        if !self.succ[from].contains(&to) {
            self.succ[from].push(to);
            self.pred[to].push(from);
        }
    }

    /// Everything from a root on that no root before it reaches.
    fn grow(&mut self, root: Node) {
        let before = self.causes(root);
        for (&node, before) in &before {
            self.root[node] = root;
            self.back[node] = before.clone();
        }
        let reached = self.backwards_finished(root);
        let base = self.order.iter().filter(|&&o| o != usize::MAX).count();
        for (position, &node) in reached.iter().enumerate() {
            self.order[node] = base + position;
        }
        // Without links back every node comes after all its ways, so one round is enough.
        self.parent[root] = root;
        for &node in &reached[1..] {
            let preds: Vec<Node> = self.pred[node].iter().copied().filter(|&p| self.forward(p, node)).collect();
            self.parent[node] = preds.into_iter().reduce(|a, b| self.meet(a, b)).unwrap_or(root);
        }
    }

    /// What must have been active before each node that is reached from a root: for a step what led to the transition that
    /// activates it first, for a transition what led to all its steps.
    fn causes(&self, root: Node) -> BTreeMap<Node, Nodes> {
        let mut causes: BTreeMap<Node, Nodes> = BTreeMap::new();
        let mut todo = VecDeque::from([(root, Nodes::default())]);
        // Convergences that still wait for a step; if it never comes, they are taken as they are.
        let mut waiting: Vec<Node> = Vec::new();
        loop {
            let Some((node, own)) = todo.pop_front() else {
                let Some(position) = waiting.iter().position(|t| !causes.contains_key(t)) else { return causes };
                let node = waiting.swap_remove(position);
                todo.push_back((node, self.behind(node, &causes)));
                continue;
            };
            if causes.contains_key(&node) {
                continue;
            }
            causes.insert(node, own);
            for &next in &self.succ[node] {
                if self.root[next] != usize::MAX || causes.contains_key(&next) {
                    continue;
                }
                if self.step(next).is_some() {
                    let mut own = Nodes::default();
                    own.join(&causes[&node], node);
                    todo.push_back((next, own));
                } else if self.pred[next].iter().all(|p| causes.contains_key(p)) {
                    todo.push_back((next, self.behind(next, &causes)));
                } else {
                    waiting.push(next);
                }
            }
        }
    }

    /// The causes of a transition, as far as its steps are known.
    fn behind(&self, transition: Node, causes: &BTreeMap<Node, Nodes>) -> Nodes {
        let mut all = Nodes::default();
        for &step in &self.pred[transition] {
            if let Some(own) = causes.get(&step) {
                all.join(own, step);
            }
        }
        all
    }

    /// Whether a link leads on, not back, and stays with its root.
    pub fn forward(&self, from: Node, to: Node) -> bool {
        self.same_root(from, to) && self.order[from] < self.order[to] && !self.back[from].has(to)
    }

    /// The nodes in reverse order of the end of a depth-first walk; branches keep their order from left to right.
    fn backwards_finished(&mut self, root: Node) -> Vec<Node> {
        let mut done = Vec::new();
        let mut work = vec![(root, 0)];
        let mut met = HashSet::from([root]);
        while let Some((node, skip)) = work.pop() {
            // From right to left, so that the reverse goes from left to right.
            let next = self.succ[node].iter().rev().enumerate().skip(skip);
            let fresh = next
                .map(|(i, &n)| (i, n))
                .find(|(_, n)| self.root[*n] == root && !met.contains(n) && *n != node && !self.back[node].has(*n));
            match fresh {
                Some((index, next)) => {
                    met.insert(next);
                    work.push((node, index + 1));
                    work.push((next, 0));
                }
                None => done.push(node),
            }
        }
        done.reverse();
        done
    }

    fn meet(&self, mut a: Node, mut b: Node) -> Node {
        while a != b {
            while self.order[a] > self.order[b] {
                a = self.parent[a];
            }
            while self.order[b] > self.order[a] {
                b = self.parent[b];
            }
        }
        a
    }

    /// The step of a node, if it is one.
    pub fn step(&self, node: Node) -> Option<usize> {
        (node < self.steps).then_some(node)
    }

    /// The transition of a node that is no step.
    pub fn transition(&self, node: Node) -> usize {
        node - self.steps
    }

    /// What follows, from left to right.
    pub fn succ(&self, node: Node) -> &[Node] {
        &self.succ[node]
    }

    /// What precedes.
    pub fn pred(&self, node: Node) -> &[Node] {
        &self.pred[node]
    }

    /// Whether both are drawn from the same root.
    fn same_root(&self, a: Node, b: Node) -> bool {
        self.root[a] == self.root[b]
    }

    /// Whether `node` continues the line of `from`: every other way to it comes back from behind it, or from another root. A
    /// convergence never does, it has a double line in front.
    pub fn continues(&self, from: Node, node: Node) -> bool {
        self.parent[node] == from
            && (node < self.steps || self.pred[node].len() == 1)
            && node != self.root[node]
            && self.pred[node].iter().all(|&p| p == from || !self.forward(p, node))
    }

    /// Where branches that part at `node` meet again, in order.
    pub fn joins(&self, node: Node) -> Vec<Node> {
        let mut joins: Vec<Node> = (0..self.parent.len())
            .filter(|&n| n != node && self.parent[n] == node && !self.continues(node, n))
            .collect();
        joins.sort_by_key(|&n| self.order[n]);
        joins
    }
}
