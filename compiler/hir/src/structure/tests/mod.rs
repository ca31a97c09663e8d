//! Tests of the structure analysis: typical structures, brute force on random small nets, size.

mod brute;
mod forms;
mod large;
mod random;

use super::*;

/// A net from text: `S1 -t1-> S2, S3; S2 -t2-> S4`. The first step named is the initial one; `> t` without a name.
fn net(text: &str) -> Net {
    let mut net = Net::default();
    let step = |name: &str, net: &mut Net| match net.steps.iter().position(|s| s.name == name) {
        Some(index) => index,
        None => {
            net.steps.push(Step { name: name.into(), initial: net.steps.is_empty() });
            net.steps.len() - 1
        }
    };
    for link in text.split(';').map(str::trim).filter(|link| !link.is_empty()) {
        let (from, rest) = link.split_once(" -").expect("an arrow");
        let (name, to) = rest.split_once("> ").expect("an arrow");
        let name = name.trim_end_matches('-');
        let mut steps = |list: &str| list.split(", ").map(|s| step(s, &mut net)).collect::<Vec<_>>();
        let (from, to) = (steps(from), steps(to));
        net.transitions.push(Transition { name: (!name.is_empty()).then(|| name.into()), from, to });
    }
    net
}

fn report(net: &Net) -> Report {
    analyse(net, Limits::default())
}

fn names(net: &Net, steps: &[usize]) -> Vec<String> {
    steps.iter().map(|&s| net.steps[s].name.clone()).collect()
}
