//! The shape of a chart: what encloses what.
//!
//! Steps and transitions are the nodes of one graph. A node *dominates* what can be reached through it only. What has one way
//! to it continues a line; what has several, and is dominated by the node where they part, is where branches meet
//! again. Links backwards, and across branches, are neither: they are drawn as jumps.

use super::chart::Chart;

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
        let reached = self.backwards_finished(root);
        let base = self.order.iter().filter(|&&o| o != usize::MAX).count();
        for (position, &node) in reached.iter().enumerate() {
            self.root[node] = root;
            self.order[node] = base + position;
        }
        self.parent[root] = root;
        // Cooper, Harvey, Kennedy: refine until nothing changes.
        loop {
            let mut changed = false;
            for &node in &reached[1..] {
                let known = |p: &&Node| self.root[**p] == root && self.parent[**p] != usize::MAX;
                let mut preds = self.pred[node].iter().filter(known);
                let Some(&first) = preds.next() else { continue };
                let nearest = preds.fold(first, |a, &b| self.meet(a, b));
                changed |= self.parent[node] != nearest;
                self.parent[node] = nearest;
            }
            if !changed {
                return;
            }
        }
    }

    /// The nodes in reverse order of the end of a depth-first walk; branches keep their order from left to right.
    fn backwards_finished(&mut self, root: Node) -> Vec<Node> {
        let mut done = Vec::new();
        let mut work = vec![(root, 0)];
        let mut met = std::collections::HashSet::from([root]);
        while let Some((node, skip)) = work.pop() {
            // From right to left, so that the reverse goes from left to right.
            let next = self.succ[node].iter().rev().enumerate().skip(skip);
            let fresh = next.map(|(i, &n)| (i, n)).find(|(_, n)| self.root[*n] == usize::MAX && !met.contains(n));
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

    /// Whether all ways from the root to `node` lead through `by` (a node dominates itself).
    pub fn dominates(&self, by: Node, mut node: Node) -> bool {
        if self.root[by] != self.root[node] {
            return false;
        }
        while self.order[node] > self.order[by] {
            node = self.parent[node];
        }
        node == by
    }

    /// Whether both are drawn from the same root.
    pub fn same_root(&self, a: Node, b: Node) -> bool {
        self.root[a] == self.root[b]
    }

    /// Whether `node` continues the line of `from`: every other way to it comes back from behind it, or from another root. A
    /// convergence never does, it has a double line in front.
    pub fn continues(&self, from: Node, node: Node) -> bool {
        self.parent[node] == from
            && (node < self.steps || self.pred[node].len() == 1)
            && node != self.root[node]
            && self.pred[node].iter().all(|&p| p == from || self.dominates(node, p) || !self.same_root(p, node))
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
