//! Structural reductions: a net with fewer steps that has the same verdicts.
//!
//! Three rules of Petri net theory (Berthelot; Haddad), applied until none fits:
//!
//! - **A step is passed through** (post-agglomeration). A step `p` that is not initial, whose outgoing transitions have no
//!   other preceding step: once `p` is active, each of them can fire at any time and nothing can hinder it, so entering and
//!   leaving are joined. Each entering transition `h` and leaving `f` become `h;f`. Series, alternatives and loops vanish so.
//! - **Equal transitions** (same steps before and behind) are one; the shorter way is kept to be shown.
//! - **Twin steps** (entered and left by the same transitions) are one: what is left of the lanes of a simultaneous branch.
//!
//! A transition that changes nothing stays as it is: it keeps its step from waiting for ever.
//!
//! *Why this is right under the weak rule:* firing `h;f` at once is a run of the chart, so what the reduced net does, the chart
//! can do. The other way round, a run of the chart in which a passed step stays active for a while has a run of the
//! reduced net beside it in which it was left at once: by the weak rule more active steps never disable a transition. A second
//! activation of the passed step becomes one of the step behind it. Passed steps never wait for ever, and which
//! transitions fire somewhere is kept in `covers`. What happens *after* a step was activated while active is not the same,
//! so the caller gives up there.

use super::Chart;
use super::explore::{Work, WorkTransition};
use super::marking::Bits;
use rustc_hash::{FxHashMap, FxHashSet};

/// Reduces the chart.
pub(super) fn reduce(chart: &Chart) -> Work {
    let mut work = Work::plain(chart);
    remove_unlinked(&mut work);
    // First only where nothing grows, then where it grows a little: each growth may open the way for equal transitions.
    let most = 2 * work.transitions.len() + 64;
    for growth in [0, 2, 8, 32] {
        while pass(chart, &mut work, growth, most) {}
    }
    work
}

/// Whether anything changed.
fn pass(chart: &Chart, work: &mut Work, growth: usize, most: usize) -> bool {
    let mut changed = false;
    for &step in &chart.steps {
        if work.transitions.len() < most && pass_through(work, step as u32, growth) {
            changed = true;
        }
    }
    changed |= merge_equal(work);
    changed | merge_twins(chart, work)
}

/// Transitions that need a step to which no link leads can never fire.
fn remove_unlinked(work: &mut Work) {
    let reached = linked(work);
    work.transitions.retain(|t| t.from.iter().all(|&s| reached.has(s as usize)));
}

/// Steps that could be reached if a transition needed its preceding steps to be active at *some* time, not at once: more
/// than those that really can.
pub(super) fn linked(work: &Work) -> Bits {
    let mut reached = work.initial.clone();
    loop {
        let mut grown = false;
        for t in &work.transitions {
            if t.from.iter().all(|&s| reached.has(s as usize)) {
                for &step in &t.to {
                    grown |= !reached.has(step as usize);
                    reached.add(step as usize);
                }
            }
        }
        if !grown {
            return reached;
        }
    }
}

fn pass_through(work: &mut Work, step: u32, growth: usize) -> bool {
    if work.initial.has(step as usize) {
        return false;
    }
    let (mut entering, mut leaving, mut loops) = (Vec::new(), Vec::new(), Vec::new());
    for (index, t) in work.transitions.iter().enumerate() {
        let (from, to) = (t.from.contains(&step), t.to.contains(&step));
        match (from, to) {
            (true, true) if t.is_loop() && t.from.len() == 1 => loops.push(index),
            (true, true) => return false,
            (true, false) if t.from.len() == 1 => leaving.push(index),
            (true, false) => return false,
            (false, true) => entering.push(index),
            (false, false) => {}
        }
    }
    if leaving.is_empty()
        || entering.is_empty()
        || entering.len() * leaving.len() > entering.len() + leaving.len() + growth
    {
        return false;
    }
    let mut joined = Vec::new();
    for &h in &entering {
        for &f in &leaving {
            let Some(both) = join(work, step, h, f, &loops) else { return false };
            joined.push(both);
        }
    }
    let gone: FxHashSet<usize> = entering.into_iter().chain(leaving).chain(loops).collect();
    let mut index = 0;
    work.transitions.retain(|_| {
        index += 1;
        !gone.contains(&(index - 1))
    });
    work.transitions.extend(joined);
    true
}

/// `h;f`, with the loops at the step between them. `None` if it would set a step twice: the exploration has to see that.
fn join(work: &Work, step: u32, h: usize, f: usize, loops: &[usize]) -> Option<WorkTransition> {
    let (h, f) = (&work.transitions[h], &work.transitions[f]);
    let mut to: Vec<u32> = h.to.iter().copied().filter(|&s| s != step).collect();
    if f.to.iter().any(|s| to.contains(s)) {
        return None;
    }
    to.extend(&f.to);
    to.sort_unstable();
    let mut covers = h.covers.clone();
    covers.add_all(&f.covers);
    loops.iter().for_each(|&l| covers.add_all(&work.transitions[l].covers));
    let trace = h.trace.iter().chain(&f.trace).copied().collect();
    let spins = h.spins || f.spins || !loops.is_empty();
    Some(WorkTransition { from: h.from.clone(), to, trace, covers, spins })
}

fn merge_equal(work: &mut Work) -> bool {
    let before = work.transitions.len();
    let mut seen: FxHashMap<(Vec<u32>, Vec<u32>), usize> = FxHashMap::default();
    let mut kept: Vec<WorkTransition> = Vec::new();
    for t in work.transitions.drain(..) {
        match seen.get(&(t.from.clone(), t.to.clone())) {
            None => {
                seen.insert((t.from.clone(), t.to.clone()), kept.len());
                kept.push(t);
            }
            Some(&same) => {
                let other = &mut kept[same];
                other.covers.add_all(&t.covers);
                other.spins |= t.spins;
                if t.trace.len() < other.trace.len() {
                    other.trace = t.trace;
                }
            }
        }
    }
    let changed = kept.len() < before;
    work.transitions = kept;
    changed
}

fn merge_twins(chart: &Chart, work: &mut Work) -> bool {
    let mut around: FxHashMap<u32, (Vec<u32>, Vec<u32>)> = FxHashMap::default();
    for (index, t) in work.transitions.iter().enumerate() {
        t.from.iter().for_each(|&s| around.entry(s).or_default().1.push(index as u32));
        t.to.iter().for_each(|&s| around.entry(s).or_default().0.push(index as u32));
    }
    let mut first: FxHashMap<_, usize> = FxHashMap::default();
    let mut twins = Vec::new();
    for &step in &chart.steps {
        let Some((entering, leaving)) = around.remove(&(step as u32)) else { continue };
        // Steps that nothing leaves any more wait each for its own transitions.
        let lost = if leaving.is_empty() { chart.leaving[step].as_slice() } else { &[] };
        let key = (entering, leaving, work.initial.has(step), lost);
        match first.get(&key) {
            None => {
                first.insert(key, step);
            }
            Some(&other) => twins.push((step, other)),
        }
    }
    for &(step, other) in &twins {
        work.initial.remove(step);
        for t in &mut work.transitions {
            t.from.retain(|&s| s != step as u32);
            t.to.retain(|&s| s != step as u32);
        }
        for twin in &mut work.twin_of {
            if *twin == step {
                *twin = other;
            }
        }
    }
    !twins.is_empty()
}
