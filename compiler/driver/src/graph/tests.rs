//! Tests of the drawing: what is drawn is the chart, and nothing lies over anything else.

use super::chart::{Action, Chart, Step, Transition};
use super::layout::place;
use super::picture::{Picture, Rect, Shape};
use std::collections::BTreeSet;

/// A generator of pseudo-random numbers (xorshift), so that a seed names a chart.
struct Dice(u64);

impl Dice {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % bound
    }
}

fn step(number: usize, dice: &mut Dice) -> Step {
    let action = |dice: &mut Dice| Action {
        qualifier: ["N", "SD"][dice.below(2)].into(),
        name: "valve_4"[..1 + dice.below(7)].into(),
        time: ["", "T#5s"][dice.below(2)].into(),
        indicator: String::new(),
    };
    let actions = (0..dice.below(4)).map(|_| action(dice)).collect();
    Step { name: format!("S{number}"), initial: number == 0, active: false, actions }
}

fn transition(number: usize, from: Vec<usize>, to: Vec<usize>, dice: &mut Dice) -> Transition {
    let condition = ["a", "level >= 80.0 AND NOT (stop OR fault)", "", "x\ny\nz"][dice.below(4)].to_string();
    let priority = (dice.below(5) == 0).then(|| number.to_string());
    Transition { name: Some(format!("t{}", number + 1)), priority, condition, from, to }
}

/// Any links.
fn wild(dice: &mut Dice) -> Chart {
    let count = 1 + dice.below(9);
    let mut chart = Chart { steps: (0..count).map(|s| step(s, dice)).collect(), ..Chart::default() };
    for t in 0..dice.below(count * 2) {
        let mut pick = || {
            let wanted = if dice.below(4) == 0 { 1 + dice.below(3) } else { 1 };
            (0..wanted).map(|_| dice.below(count)).collect::<BTreeSet<_>>().into_iter().collect::<Vec<_>>()
        };
        let (from, to) = (pick(), pick());
        chart.transitions.push(transition(t, from, to, dice));
    }
    chart
}

/// Built as charts are: series, alternatives, lanes, loops, some jumps.
fn built(dice: &mut Dice) -> Chart {
    let mut chart = Chart { steps: vec![step(0, dice)], transitions: vec![transition(0, vec![0], vec![0], dice)] };
    for _ in 0..dice.below(14) {
        let new = chart.steps.len();
        let next = chart.transitions.len();
        let t = dice.below(next);
        let any = dice.below(new);
        let step = step(new, dice);
        chart.steps.push(step);
        match dice.below(5) {
            0 | 1 => {
                let to = std::mem::replace(&mut chart.transitions[t].to, vec![new]);
                chart.transitions.push(transition(next, vec![new], to, dice));
            }
            2 => {
                let (from, to) = (chart.transitions[t].from.clone(), chart.transitions[t].to.clone());
                chart.transitions.push(transition(next, from, vec![new], dice));
                chart.transitions.push(transition(next + 1, vec![new], to, dice));
            }
            3 => {
                let beside = chart.transitions[t].to[0];
                if beside == 0 {
                    chart.steps.pop();
                    continue;
                }
                for transition in &mut chart.transitions {
                    if transition.from.contains(&beside) {
                        transition.from.push(new);
                    }
                    if transition.to.contains(&beside) {
                        transition.to.push(new);
                    }
                }
            }
            _ => {
                chart.transitions.push(transition(next, vec![any], vec![new], dice));
                let back = dice.below(new);
                chart.transitions.push(transition(next + 1, vec![new], vec![back], dice));
            }
        }
    }
    chart
}

fn charts(seeds: u64) -> impl Iterator<Item = (u64, Chart)> {
    (1..=seeds).map(|seed| {
        let mut dice = Dice(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        dice.below(2);
        (seed, if seed % 3 == 0 { wild(&mut dice) } else { built(&mut dice) })
    })
}

fn solid(picture: &Picture) -> Vec<&Shape> {
    picture.shapes.iter().filter(|s| !matches!(s, Shape::Line { .. })).collect()
}

fn lines(picture: &Picture) -> Vec<(Rect, bool)> {
    let line = |s: &Shape| if let Shape::Line { rect, double } = s { Some((*rect, *double)) } else { None };
    picture.shapes.iter().filter_map(line).collect()
}

#[test]
fn nothing_lies_over_anything_else() {
    for (seed, chart) in charts(amount()) {
        let picture = place(&chart);
        let solid = solid(&picture);
        for (i, a) in solid.iter().enumerate() {
            for b in &solid[i + 1..] {
                assert!(!a.rect().overlaps(b.rect()), "seed {seed}: {a:?} over {b:?}\n{chart:#?}");
            }
            for (line, _) in lines(&picture) {
                // A transition has its own line in it. Touching an edge is no crossing.
                let own = matches!(a, Shape::Transition { x, .. } if line.left == *x && line.right == *x);
                let rect = a.rect();
                let crosses = rect.left < line.right.max(line.left + 1)
                    && line.left.min(line.right - 1) < rect.right
                    && rect.top < line.bottom.max(line.top + 1) - i32::from(line.top == line.bottom)
                    && line.top < rect.bottom;
                assert!(own || !crosses, "seed {seed}: line {line:?} through {a:?}\n{chart:#?}");
            }
            let rect = a.rect();
            assert!(rect.left >= 0 && rect.top >= 0 && rect.right <= picture.width && rect.bottom <= picture.height);
        }
    }
}

/// Reads the links back from the lines and arrows.
#[test]
fn what_is_drawn_is_the_chart() {
    for (seed, chart) in charts(amount()) {
        let drawn = links_of(&place(&chart));
        let mut wanted = BTreeSet::new();
        for t in &chart.transitions {
            let name = t.name.clone().expect("a name");
            wanted.extend(t.from.iter().map(|&s| (chart.steps[s].name.clone(), name.clone())));
            wanted.extend(t.to.iter().map(|&s| (name.clone(), chart.steps[s].name.clone())));
        }
        // A jump to a convergence and its arrival say the same link.
        assert_eq!(drawn, wanted, "seed {seed}\n{chart:#?}");
    }
}

/// `RANDOM_CHARTS=20000` for the long run.
fn amount() -> u64 {
    std::env::var("RANDOM_CHARTS").ok().and_then(|n| n.parse().ok()).unwrap_or(300)
}

/// A point from which a way leads down.
type Point = (i32, i32);

fn links_of(picture: &Picture) -> BTreeSet<(String, String)> {
    let name = |head: &str| head.split(' ').next().unwrap_or_default().to_string();
    let mut split: Vec<Rect> = lines(picture).into_iter().filter(|(_, double)| !double).map(|(rect, _)| rect).collect();
    let doubles: Vec<Rect> = lines(picture).into_iter().filter(|(_, double)| *double).map(|(rect, _)| rect).collect();
    // The bar of a transition interrupts its line.
    for shape in &picture.shapes {
        let Shape::Transition { x, y, .. } = shape else { continue };
        let at = split.iter().position(|l| l.left == *x && l.right == *x && l.top < *y && l.bottom > *y);
        let line = split.remove(at.expect("the line of a transition"));
        split.push(Rect { bottom: *y - 2, ..line });
        split.push(Rect { top: *y + 2, ..line });
    }
    let touches = |l: &Rect, p: Point| l.left <= p.0 && p.0 <= l.right && l.top <= p.1 && p.1 <= l.bottom;
    let meet = |a: &Rect, b: &Rect| a.left <= b.right && b.left <= a.right && a.top <= b.bottom && b.top <= a.bottom;
    // All lines that hang together with a point.
    let net = |from: Point| {
        let mut net: Vec<usize> = (0..split.len()).filter(|&i| touches(&split[i], from)).collect();
        let mut next = 0;
        while next < net.len() {
            let more: Vec<usize> =
                (0..split.len()).filter(|i| !net.contains(i) && meet(&split[*i], &split[net[next]])).collect();
            net.extend(more);
            next += 1;
        }
        net
    };
    let ends = |from: Point| {
        let net = net(from);
        let reaches = |p: Point| p == from || net.iter().any(|&i| touches(&split[i], p));
        let mut names = Vec::new();
        let mut into = Vec::new();
        for shape in &picture.shapes {
            match shape {
                Shape::Step { rect, name, .. } if reaches(((rect.left + rect.right) / 2, rect.top)) => {
                    names.push(name.clone())
                }
                Shape::Transition { x, y, head, .. } if reaches((*x, *y - 2)) => names.push(name(head)),
                Shape::Jump { rect, x, to } if reaches((*x, rect.top)) => names.push(to.clone()),
                _ => {}
            }
        }
        for (index, double) in doubles.iter().enumerate() {
            let above = |p: Point| p.1 == double.top && double.left <= p.0 && p.0 <= double.right;
            if above(from) || net.iter().any(|&i| above((split[i].left, split[i].bottom))) {
                into.push(index);
            }
        }
        (names, into)
    };
    // Through double lines, on from everything that begins below them.
    let follow = |from: Point| {
        let (mut names, mut into) = ends(from);
        while let Some(index) = into.pop() {
            let double = doubles[index];
            let below = |x: i32, y: i32| y == double.bottom && double.left <= x && x <= double.right;
            let starts = split.iter().map(|l| (l.left, l.top)).chain(picture.shapes.iter().filter_map(|s| match s {
                Shape::Jump { rect, x, .. } => Some((*x, rect.top)),
                _ => None,
            }));
            for start in starts.filter(|p| below(p.0, p.1)).collect::<BTreeSet<_>>() {
                let (more, further) = ends(start);
                names.extend(more);
                into.extend(further);
            }
        }
        names
    };
    let mut links = BTreeSet::new();
    for shape in &picture.shapes {
        let (from, start) = match shape {
            Shape::Step { rect, name, .. } => (name.clone(), ((rect.left + rect.right) / 2, rect.bottom)),
            Shape::Transition { x, y, head, .. } => (name(head), (*x, *y + 2)),
            Shape::Arrival { rect, x, from } => (from.clone(), (*x, rect.bottom)),
            _ => continue,
        };
        links.extend(follow(start).into_iter().map(|to| (from.clone(), to)));
    }
    links
}

#[test]
fn long_and_wide_charts_are_placed() {
    let mut dice = Dice(5);
    let count = 1500;
    let mut chart = Chart { steps: (0..count).map(|s| step(s, &mut dice)).collect(), ..Chart::default() };
    for t in 0..count {
        chart.transitions.push(transition(t, vec![t], vec![(t + 1) % count], &mut dice));
    }
    assert!(place(&chart).height > 100_000);
    let mut wide = Chart { steps: (0..60).map(|s| step(s, &mut dice)).collect(), ..Chart::default() };
    wide.transitions.push(transition(0, vec![0], (1..60).collect(), &mut dice));
    wide.transitions.push(transition(1, (1..60).collect(), vec![0], &mut dice));
    assert!(place(&wide).width > 5_000);
}
