//! Random small nets: the analysis, plain and reduced, agrees with brute force.

use super::brute::{Verdict, verdict};
use super::*;
use std::collections::BTreeSet;

/// A generator of pseudo-random numbers (xorshift), so that a seed names a net.
struct Dice(u64);

impl Dice {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % bound
    }
}

/// Links thrown at random: mostly wrong charts.
fn wild(dice: &mut Dice) -> Net {
    let count = 2 + dice.below(7);
    let mut net = Net::default();
    for s in 0..count {
        net.steps.push(Step { name: format!("S{s}"), initial: s == 0 });
    }
    for t in 0..1 + dice.below(count + 3) {
        let mut pick = |most: usize| {
            let wanted = if dice.below(3) == 0 { 1 + dice.below(most) } else { 1 };
            (0..wanted).map(|_| dice.below(count)).collect::<BTreeSet<_>>().into_iter().collect::<Vec<_>>()
        };
        let (from, to) = (pick(3), pick(3));
        net.transitions.push(Transition { name: Some(format!("t{t}")), from, to });
    }
    net
}

/// A well-built chart with up to three links changed: nearly right ones.
fn nearly(dice: &mut Dice) -> Net {
    let mut net = Net { steps: vec![Step { name: "S0".into(), initial: true }], ..Net::default() };
    net.transitions.push(Transition { name: Some("t0".into()), from: vec![0], to: vec![0] });
    while net.steps.len() < 3 + dice.below(7) {
        grow(&mut net, dice);
    }
    for _ in 0..dice.below(4) {
        let (t, step) = (dice.below(net.transitions.len()), dice.below(net.steps.len()));
        let transition = &mut net.transitions[t];
        let side = if dice.below(2) == 0 { &mut transition.from } else { &mut transition.to };
        let place = dice.below(side.len());
        if !side.contains(&step) {
            side[place] = step;
        }
    }
    net
}

fn grow(net: &mut Net, dice: &mut Dice) {
    let new = net.steps.len();
    net.steps.push(Step { name: format!("S{new}"), initial: false });
    let t = dice.below(net.transitions.len());
    let name = |net: &Net| Some(format!("t{}", net.transitions.len()));
    match dice.below(4) {
        // in series: the transition leads to the new step, another one on from there
        0 => {
            let to = std::mem::replace(&mut net.transitions[t].to, vec![new]);
            net.transitions.push(Transition { name: name(net), from: vec![new], to });
        }
        // beside a step: an alternative way to what follows it
        1 => {
            let (from, to) = (net.transitions[t].from.clone(), net.transitions[t].to.clone());
            net.transitions.push(Transition { name: name(net), from, to: vec![new] });
            net.transitions.push(Transition { name: name(net), from: vec![new], to });
        }
        // a further lane beside the steps that a transition leads to
        2 => {
            let step = net.transitions[t].to[0];
            for transition in &mut net.transitions {
                if transition.from.contains(&step) {
                    transition.from.push(new);
                }
                if transition.to.contains(&step) {
                    transition.to.push(new);
                }
            }
            if net.steps[step].initial {
                net.steps[new].initial = true;
            }
        }
        // a loop at a step
        _ => {
            let step = dice.below(new);
            net.transitions.push(Transition { name: name(net), from: vec![step], to: vec![new] });
            net.transitions.push(Transition { name: name(net), from: vec![new], to: vec![step] });
        }
    }
}

/// What the findings say, in the form of the brute force verdict.
fn said(net: &Net, report: &Report, reduced: bool) -> Result<(), String> {
    let rule = net.rule;
    let Some(truth) = verdict(net, rule, 250) else { return Ok(()) };
    for finding in &report.findings {
        replay(net, finding)?;
        one(net, finding, &truth, reduced, report.proof)?;
    }
    all(net, report, &truth)
}

/// Every path is a run, and ends where the finding says.
fn replay(net: &Net, finding: &Finding) -> Result<(), String> {
    let path = &finding.path;
    if path.markings.is_empty() {
        return Ok(());
    }
    // A finding that the rules differ shows a run by the weak one.
    let strong = net.rule == Rule::Strong && finding.kind != Kind::RulesDiffer;
    for (i, fired) in path.firings.iter().enumerate() {
        let (before, after) = (&path.markings[i], &path.markings[i + 1]);
        let mut now: BTreeSet<usize> = before.iter().copied().collect();
        for &t in fired {
            let transition = &net.transitions[t];
            if strong && transition.to.iter().any(|s| before.contains(s) && !transition.from.contains(s)) {
                return Err("the path breaks the strong rule".into());
            }
            for s in &transition.from {
                if !now.remove(s) {
                    return Err(format!("the path is no run: {path:?}"));
                }
            }
        }
        let mut twice = None;
        for &t in fired {
            for &s in &net.transitions[t].to {
                if !now.insert(s) {
                    twice = Some(s);
                }
            }
        }
        if now.into_iter().collect::<Vec<_>>() != *after {
            return Err(format!("the path has a wrong marking: {path:?}"));
        }
        let last = i + 1 == path.firings.len();
        let contact = matches!(finding.kind, Kind::ActivatedTwice | Kind::RulesDiffer);
        if twice.is_some() != (last && contact) {
            return Err(format!("{:?}: a step is activated twice at the wrong place: {path:?}", finding.kind));
        }
    }
    Ok(())
}

/// What one finding says is true.
fn one(net: &Net, finding: &Finding, truth: &Verdict, reduced: bool, proof: Proof) -> Result<(), String> {
    let fine = match finding.kind {
        Kind::NeverReached => finding.steps.iter().all(|s| truth.never_reached.contains(s)),
        Kind::NeverFires => truth.never_enabled.contains(&finding.transitions[0]),
        Kind::TotallyStuck | Kind::PartiallyStuck => {
            let dead = finding.transitions.iter().all(|t| truth.never_enabled.contains(t));
            let length: usize = finding.path.firings.iter().map(Vec::len).sum();
            let known = finding.steps.iter().all(|s| truth.waiting.contains_key(s));
            let least = finding.steps.iter().filter_map(|s| truth.waiting.get(s)).min();
            known
                && (finding.certain == (dead || truth.always_stuck) || proof != Proof::Complete && !finding.certain)
                && (reduced || least == Some(&length))
                && (finding.kind == Kind::PartiallyStuck || finding.steps.iter().any(|s| truth.standstill.contains(s)))
        }
        Kind::ActivatedTwice => {
            let length: usize = finding.path.firings.iter().map(Vec::len).sum();
            (finding.certain == truth.always_twice || reduced && !finding.certain)
                && truth.twice.is_some_and(|least| least == length || reduced && least <= length)
        }
        Kind::RulesDiffer => net.rule == Rule::Strong,
    };
    if fine { Ok(()) } else { Err(format!("false: {finding:?}\n{truth:?}")) }
}

/// Nothing is missing.
fn all(net: &Net, report: &Report, truth: &Verdict) -> Result<(), String> {
    let of = |kinds: &[Kind]| report.findings.iter().filter(|f| kinds.contains(&f.kind)).collect::<Vec<_>>();
    if truth.twice.is_some() != (of(&[Kind::ActivatedTwice]).len() == 1) {
        return Err(format!("a step activated twice: {truth:?}"));
    }
    if report.proof != Proof::Complete {
        return if truth.twice.is_some() { Ok(()) } else { Err("not proved".into()) };
    }
    // Each waiting step is in a finding, or waits beside one for the same transition.
    let stuck = of(&[Kind::TotallyStuck, Kind::PartiallyStuck]);
    let leaving = |s: usize| (0..net.transitions.len()).filter(move |&t| net.transitions[t].from.contains(&s));
    for &step in truth.waiting.keys() {
        let mut group: BTreeSet<usize> = leaving(step).collect();
        loop {
            let wider: BTreeSet<usize> = truth
                .waiting
                .keys()
                .filter(|&&s| leaving(s).any(|t| group.contains(&t)))
                .flat_map(|&s| leaving(s))
                .collect();
            if wider == group {
                break;
            }
            group = wider;
        }
        if !stuck.iter().any(|f| f.transitions.iter().any(|t| group.contains(t))) {
            return Err(format!("S{step} waits for ever: {truth:?}"));
        }
    }
    let totally = stuck.iter().any(|f| f.kind == Kind::TotallyStuck);
    if truth.waiting.keys().any(|s| truth.standstill.contains(s)) != totally {
        return Err(format!("totally or partially stuck: {truth:?}"));
    }
    // Each transition that never fires with reached steps in front is told; each step never reached is told or a consequence.
    let told: BTreeSet<usize> = report
        .findings
        .iter()
        .filter(|f| f.certain && f.kind != Kind::ActivatedTwice && f.kind != Kind::NeverReached)
        .flat_map(|f| f.transitions.clone())
        .collect();
    let dead = truth
        .never_enabled
        .iter()
        .filter(|&&t| net.transitions[t].from.iter().all(|s| !truth.never_reached.contains(s)));
    let untold: Vec<_> = dead.clone().filter(|t| !told.contains(t)).collect();
    if !untold.is_empty() {
        return Err(format!("never fires: {untold:?} {truth:?}"));
    }
    let unreached: BTreeSet<usize> = of(&[Kind::NeverReached]).iter().flat_map(|f| f.steps.clone()).collect();
    let mut explained: BTreeSet<usize> = dead.flat_map(|&t| net.transitions[t].to.clone()).collect();
    for _ in 0..net.steps.len() {
        for t in &net.transitions {
            if t.from.iter().all(|s| !truth.never_reached.contains(s) || explained.contains(s)) {
                explained.extend(&t.to);
            }
        }
    }
    let all: BTreeSet<usize> = unreached.union(&explained).copied().collect();
    if !truth.never_reached.is_subset(&all) || unreached.iter().any(|s| explained.contains(s)) {
        return Err(format!("never reached: {unreached:?} {truth:?}"));
    }
    Ok(())
}

fn written(net: &Net) -> String {
    let link = |t: &Transition| {
        format!(
            "{} -{}-> {}",
            names(net, &t.from).join(", "),
            t.name.clone().unwrap_or_default(),
            names(net, &t.to).join(", ")
        )
    };
    format!("{:?} {}", net.rule, net.transitions.iter().map(link).collect::<Vec<_>>().join("; "))
}

fn check(seeds: u64) {
    let mut problems = Vec::new();
    for seed in 1..=seeds {
        let mut dice = Dice(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        dice.below(2);
        let mut net = if seed % 2 == 0 { wild(&mut dice) } else { nearly(&mut dice) };
        // Networks are judged one by one; brute force takes the chart as one.
        let parts = networks(&net);
        if parts.len() > 1 {
            continue;
        }
        if dice.below(4) == 0 {
            net.rule = Rule::Strong;
        }
        let plain = analyse(&net, Limits::default());
        let reduced = analyse(&net, Limits { plain: 0, reduced: 50_000 });
        for (report, by_reduction) in [(plain, false), (reduced, true)] {
            if let Err(problem) = said(&net, &report, by_reduction) {
                problems.push(format!("seed {seed}, reduced {by_reduction}: {problem}\n{}", written(&net)));
            }
            report.findings.iter().for_each(|f| assert!(!text::describe(&net, f).message.is_empty()));
        }
    }
    assert!(
        problems.is_empty(),
        "{} wrong, the first:\n{}",
        problems.len(),
        problems[..problems.len().min(3)].join("\n\n")
    );
}

/// `RANDOM_NETS=1000000` for the long run.
#[test]
fn the_analysis_agrees_with_brute_force() {
    check(std::env::var("RANDOM_NETS").ok().and_then(|n| n.parse().ok()).unwrap_or(800));
}
