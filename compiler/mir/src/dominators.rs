//! The order of blocks and who dominates whom.
//!
//! In: a function. Out: reverse post-order, predecessors, immediate dominators. Near-linear (semi-NCA with path
//! compression), and without recursion, because the blocks of a POU may be many and form one long chain.

use crate::ir::{Block, BlockId, Func};
use index_vec::IndexVec;

/// The dominator tree of the reachable blocks of a function.
#[derive(Debug, Clone)]
pub struct Dominators {
    /// Reachable blocks in reverse post-order; the entry is first.
    pub order: Vec<BlockId>,
    /// Immediate dominator; `None` for the entry and for unreachable blocks.
    pub idom: IndexVec<BlockId, Option<BlockId>>,
    /// Predecessors among the reachable blocks, one entry per edge.
    pub preds: IndexVec<BlockId, Vec<BlockId>>,
    /// First and last number of the subtree of a block; `(1, 0)` for an unreachable one.
    span: IndexVec<BlockId, (u32, u32)>,
}

const NONE: u32 = u32::MAX;

/// The reachable blocks in reverse post-order; the entry is first.
pub fn reverse_postorder(func: &Func) -> Vec<BlockId> {
    let mut order = Walk::new(func).postorder;
    order.reverse();
    order
}

impl Dominators {
    /// Computes them. Targets outside the function are ignored (the verifier reports them).
    pub fn new(func: &Func) -> Self {
        let count = func.blocks.len();
        let walk = Walk::new(func);
        let mut preds: IndexVec<BlockId, Vec<BlockId>> = IndexVec::from_vec(vec![Vec::new(); count]);
        for &block in &walk.preorder {
            for &next in &successors(&func.blocks[block], count) {
                preds[next].push(block);
            }
        }
        let idom_number = semi_nca(&walk, &preds);
        let mut idom = IndexVec::from_vec(vec![None; count]);
        for (number, &block) in walk.preorder.iter().enumerate().skip(1) {
            idom[block] = Some(walk.preorder[idom_number[number] as usize]);
        }
        let span = subtree_spans(&walk, &idom_number, count);
        let mut order = walk.postorder;
        order.reverse();
        Self { order, idom, preds, span }
    }

    /// Whether every way from the entry to `b` leads through `a`; a block dominates itself. FALSE for unreachable blocks.
    pub fn dominates(&self, a: BlockId, b: BlockId) -> bool {
        let ((first, last), (at, end)) = (self.span[a], self.span[b]);
        at <= end && first <= at && at <= last
    }

    /// Whether the entry leads to it.
    pub fn is_reachable(&self, block: BlockId) -> bool {
        self.span[block].0 <= self.span[block].1
    }
}

fn successors(block: &Block, count: usize) -> Vec<BlockId> {
    let mut list = Vec::new();
    block.term.for_each_target(|t| {
        if t.block.index() < count {
            list.push(t.block);
        }
    });
    list
}

/// A depth-first walk from the entry.
struct Walk {
    preorder: Vec<BlockId>,
    postorder: Vec<BlockId>,
    /// Number in `preorder`.
    number: IndexVec<BlockId, u32>,
    /// Number of the parent in the spanning tree.
    parent: Vec<u32>,
}

impl Walk {
    fn new(func: &Func) -> Self {
        let count = func.blocks.len();
        let mut walk = Walk {
            preorder: Vec::with_capacity(count),
            postorder: Vec::with_capacity(count),
            number: IndexVec::from_vec(vec![NONE; count]),
            parent: Vec::with_capacity(count),
        };
        if count == 0 {
            return walk;
        }
        let entry = BlockId::from_usize(0);
        let mut stack = vec![(entry, successors(&func.blocks[entry], count).into_iter().rev().collect::<Vec<_>>())];
        walk.enter(entry, 0);
        while let Some((block, rest)) = stack.last_mut() {
            let (block, next) = (*block, rest.pop());
            match next {
                Some(next) if walk.number[next] == NONE => {
                    walk.enter(next, walk.number[block]);
                    let mut rest = successors(&func.blocks[next], count);
                    rest.reverse();
                    stack.push((next, rest));
                }
                Some(_) => {}
                None => {
                    walk.postorder.push(block);
                    stack.pop();
                }
            }
        }
        walk
    }

    fn enter(&mut self, block: BlockId, parent: u32) {
        self.number[block] = self.preorder.len() as u32;
        self.preorder.push(block);
        self.parent.push(parent);
    }
}

/// The number of the immediate dominator of each block, by number.
fn semi_nca(walk: &Walk, preds: &IndexVec<BlockId, Vec<BlockId>>) -> Vec<u32> {
    let count = walk.preorder.len();
    let mut semi: Vec<u32> = (0..count as u32).collect();
    let mut label = semi.clone();
    let mut ancestor = vec![NONE; count];
    let mut path = Vec::new();
    for v in (1..count).rev() {
        for pred in &preds[walk.preorder[v]] {
            let u = walk.number[*pred] as usize;
            let best = if ancestor[u] == NONE {
                u
            } else {
                compress(u, &mut ancestor, &mut label, &semi, &mut path);
                label[u] as usize
            };
            semi[v] = semi[v].min(semi[best]);
        }
        ancestor[v] = walk.parent[v];
    }
    let mut idom = walk.parent.clone();
    for v in 1..count {
        while idom[v] > semi[v] {
            idom[v] = idom[idom[v] as usize];
        }
    }
    idom
}

/// Points `v` at the root of its forest and leaves in `label[v]` the vertex of smallest `semi` on the way.
fn compress(v: usize, ancestor: &mut [u32], label: &mut [u32], semi: &[u32], path: &mut Vec<usize>) {
    path.clear();
    let mut at = v;
    while ancestor[ancestor[at] as usize] != NONE {
        path.push(at);
        at = ancestor[at] as usize;
    }
    while let Some(at) = path.pop() {
        let above = ancestor[at] as usize;
        if semi[label[above] as usize] < semi[label[at] as usize] {
            label[at] = label[above];
        }
        ancestor[at] = ancestor[above];
    }
}

/// Numbers the dominator tree so that a subtree is an interval.
fn subtree_spans(walk: &Walk, idom: &[u32], blocks: usize) -> IndexVec<BlockId, (u32, u32)> {
    let count = walk.preorder.len();
    let mut size = vec![1u32; count];
    for v in (1..count).rev() {
        size[idom[v] as usize] += size[v];
    }
    // A dominator has a smaller number than what it dominates, so one pass downwards hands out the intervals.
    let mut next_free = vec![1u32; count];
    let mut first = vec![0u32; count];
    let mut spans = IndexVec::from_vec(vec![(1, 0); blocks]);
    for v in 0..count {
        if v > 0 {
            let above = idom[v] as usize;
            first[v] = next_free[above];
            next_free[above] += size[v];
        }
        next_free[v] = first[v] + 1;
        spans[walk.preorder[v]] = (first[v], first[v] + size[v] - 1);
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::{Target, Term, ValueId};

    /// A function whose block `n` goes to `edges[n]`.
    fn graph(edges: &[&[u32]]) -> Func {
        let target = |b: u32| Target { block: BlockId::from_raw(b), args: Vec::new() };
        let blocks = edges
            .iter()
            .map(|to| Block {
                params: Vec::new(),
                insts: Vec::new(),
                term: match to {
                    [] => Term::Return(None),
                    [one] => Term::Jump(target(*one)),
                    [first, rest @ ..] => Term::Switch {
                        value: ValueId::from_raw(0),
                        cases: rest.iter().enumerate().map(|(n, b)| (n as u64, target(*b))).collect(),
                        default: target(*first),
                    },
                },
            })
            .collect();
        Func {
            name: String::new(),
            params: Vec::new(),
            result: None,
            has_instance: false,
            frame_bytes: 0,
            values: IndexVec::new(),
            blocks,
            names: Vec::new(),
        }
    }

    /// By definition: `a` dominates `b` if `b` is not reached when `a` is taken away.
    fn dominates_slowly(edges: &[&[u32]], a: u32, b: u32) -> bool {
        let reach = |without: Option<u32>| {
            let mut seen = vec![false; edges.len()];
            let mut work = if without == Some(0) { vec![] } else { vec![0] };
            while let Some(n) = work.pop() {
                if !std::mem::replace(&mut seen[n as usize], true) {
                    work.extend(edges[n as usize].iter().copied().filter(|t| Some(*t) != without));
                }
            }
            seen
        };
        reach(None)[a as usize] && reach(None)[b as usize] && (a == b || !reach(Some(a))[b as usize])
    }

    #[test]
    fn agrees_with_the_definition() {
        let mut seed = 7u64;
        let mut random = |below: u32| {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            ((seed >> 33) as u32) % below
        };
        for round in 0..300 {
            let count = 1 + round % 12;
            let edges: Vec<Vec<u32>> = (0..count).map(|_| (0..random(4)).map(|_| random(count)).collect()).collect();
            let edges: Vec<&[u32]> = edges.iter().map(Vec::as_slice).collect();
            let tree = Dominators::new(&graph(&edges));
            for a in 0..count {
                for b in 0..count {
                    let (x, y) = (BlockId::from_raw(a), BlockId::from_raw(b));
                    assert_eq!(tree.dominates(x, y), dominates_slowly(&edges, a, b), "{a} over {b} in {edges:?}");
                }
            }
        }
    }

    #[test]
    fn a_long_chain_of_exits_is_fast() {
        // Block n goes to n + 1 or to the common exit.
        let count = 200_000u32;
        let edges: Vec<Vec<u32>> =
            (0..count).map(|n| if n + 1 < count { vec![n + 1, count - 1] } else { vec![] }).collect();
        let edges: Vec<&[u32]> = edges.iter().map(Vec::as_slice).collect();
        let tree = Dominators::new(&graph(&edges));
        assert_eq!(tree.idom[BlockId::from_raw(count - 1)], Some(BlockId::from_raw(0)));
        assert!(tree.dominates(BlockId::from_raw(5), BlockId::from_raw(count - 2)));
    }
}
