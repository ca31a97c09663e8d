//! The verdicts by brute force: all markings, all sets of transitions, straight from the definitions in the module's comment.

use super::*;
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// What is to be found.
#[derive(Debug, PartialEq, Eq, Default)]
pub struct Verdict {
    pub never_reached: BTreeSet<usize>,
    pub never_enabled: BTreeSet<usize>,
    /// Waiting steps of markings that are reached without a step activated twice, and the fewest firings to the first.
    pub waiting: BTreeMap<usize, usize>,
    /// Steps that wait in a standstill.
    pub standstill: BTreeSet<usize>,
    /// Every maximal run comes to a marking with a waiting step.
    pub always_stuck: bool,
    /// Firings up to the first step activated twice (fewest).
    pub twice: Option<usize>,
    /// Every maximal run activates a step twice.
    pub always_twice: bool,
}

struct Call {
    to: u32,
    fired: Vec<usize>,
    twice: bool,
}

/// `None` if there are more than `limit` markings.
pub fn verdict(net: &Net, rule: Rule, limit: usize) -> Option<Verdict> {
    let mask = |steps: &[usize]| steps.iter().fold(0u32, |m, s| m | 1 << s);
    let start = (0..net.steps.len()).filter(|&s| net.steps[s].initial).fold(0u32, |m, s| m | 1 << s);
    let from: Vec<u32> = net.transitions.iter().map(|t| mask(&t.from)).collect();
    let to: Vec<u32> = net.transitions.iter().map(|t| mask(&t.to)).collect();
    let mut calls: BTreeMap<u32, Vec<Call>> = BTreeMap::new();
    let mut todo = vec![start];
    while let Some(marking) = todo.pop() {
        if calls.contains_key(&marking) {
            continue;
        }
        if calls.len() >= limit {
            return None;
        }
        let enabled: Vec<usize> = (0..from.len())
            .filter(|&t| marking & from[t] == from[t] && (rule == Rule::Weak || marking & to[t] & !from[t] == 0))
            .collect();
        let mut found = Vec::new();
        for choice in 1u32..1 << enabled.len() {
            let set: Vec<usize> = (0..enabled.len()).filter(|i| choice >> i & 1 == 1).map(|i| enabled[i]).collect();
            let (mut cleared, mut conflict) = (0, false);
            for &t in &set {
                conflict |= cleared & from[t] != 0;
                cleared |= from[t];
            }
            if conflict {
                continue;
            }
            let (mut next, mut twice) = (marking & !cleared, false);
            for &t in &set {
                twice |= next & to[t] != 0;
                next |= to[t];
            }
            found.push(Call { to: next, fired: set, twice });
            todo.push(next);
        }
        calls.insert(marking, found);
    }
    Some(judge(net, start, &from, &calls))
}

fn judge(net: &Net, start: u32, from: &[u32], calls: &BTreeMap<u32, Vec<Call>>) -> Verdict {
    let mut verdict = Verdict::default();
    let reached = calls.keys().fold(0, |all, m| all | m);
    let fires =
        |marking: u32| reach(marking, calls).iter().flat_map(|m| &calls[m]).flat_map(|c| c.fired.clone()).collect();
    let live: BTreeSet<usize> = fires(start);
    verdict.never_reached = (0..net.steps.len()).filter(|s| reached >> s & 1 == 0).collect();
    verdict.never_enabled = (0..from.len()).filter(|t| !live.contains(t)).collect();
    // Steps that wait for ever.
    let leaves = |s: usize| (0..from.len()).filter(move |&t| from[t] >> s & 1 == 1);
    let mut stuck: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for &marking in calls.keys() {
        let ahead: BTreeSet<usize> = fires(marking);
        let waits =
            |s: &usize| marking >> s & 1 == 1 && leaves(*s).next().is_some() && !leaves(*s).any(|t| ahead.contains(&t));
        let waiting: Vec<usize> = (0..net.steps.len()).filter(waits).collect();
        if calls[&marking].is_empty() {
            verdict.standstill.extend(&waiting);
        }
        if !waiting.is_empty() {
            stuck.insert(marking, waiting);
        }
    }
    // Fewest firings on runs that activate no step twice.
    let mut cost: BTreeMap<u32, usize> = BTreeMap::from([(start, 0)]);
    let mut queue = VecDeque::from([start]);
    while let Some(marking) = queue.pop_front() {
        for call in &calls[&marking] {
            let further = cost[&marking] + call.fired.len();
            if call.twice {
                verdict.twice = Some(verdict.twice.map_or(further, |least| least.min(further)));
            } else if cost.get(&call.to).is_none_or(|&c| further < c) {
                cost.insert(call.to, further);
                queue.push_back(call.to);
            }
        }
    }
    for (marking, steps) in &stuck {
        if let Some(&c) = cost.get(marking) {
            for &step in steps {
                let least = verdict.waiting.entry(step).or_insert(c);
                *least = (*least).min(c);
            }
        }
    }
    verdict.always_stuck = !escapes(start, calls, &|m| stuck.contains_key(&m), &|_| false);
    verdict.always_twice = !escapes(start, calls, &|_| false, &|c| c.twice);
    verdict
}

fn reach(start: u32, calls: &BTreeMap<u32, Vec<Call>>) -> BTreeSet<u32> {
    let mut met = BTreeSet::new();
    let mut todo = vec![start];
    while let Some(marking) = todo.pop() {
        if met.insert(marking) {
            todo.extend(calls[&marking].iter().map(|c| c.to));
        }
    }
    met
}

/// Whether a maximal run avoids the bad: the greatest set of good markings that end there or have a good successor in it.
fn escapes(
    start: u32,
    calls: &BTreeMap<u32, Vec<Call>>,
    bad_marking: &dyn Fn(u32) -> bool,
    bad_call: &dyn Fn(&Call) -> bool,
) -> bool {
    let mut good: BTreeSet<u32> = calls.keys().copied().filter(|&m| !bad_marking(m)).collect();
    loop {
        let keeps = |m: &u32| calls[m].is_empty() || calls[m].iter().any(|c| !bad_call(c) && good.contains(&c.to));
        let next: BTreeSet<u32> = good.iter().copied().filter(keeps).collect();
        if next == good {
            return good.contains(&start);
        }
        good = next;
    }
}
