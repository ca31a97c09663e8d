//! Charts whose marking graphs are too large to be built.

use super::*;

/// `lanes` simultaneous branches of `length` steps, `inside` says how a lane is built.
fn lanes(lanes: usize, length: usize, inside: impl Fn(usize, usize) -> Vec<(usize, usize)>) -> Net {
    let mut net = Net::default();
    let mut step = |name: String, initial| {
        net.steps.push(Step { name, initial });
        net.steps.len() - 1
    };
    let start = step("Start".into(), true);
    let done = step("Done".into(), false);
    let at: Vec<Vec<usize>> =
        (0..lanes).map(|l| (0..length).map(|s| step(format!("L{l}_{s}"), false)).collect()).collect();
    let mut link = |name: String, from: Vec<usize>, to: Vec<usize>| {
        net.transitions.push(Transition { name: Some(name), from, to });
    };
    link("go".into(), vec![start], at.iter().map(|lane| lane[0]).collect());
    for (l, lane) in at.iter().enumerate() {
        for (from, to) in inside(l, length) {
            link(format!("t{l}_{from}_{to}"), vec![lane[from]], vec![lane[to]]);
        }
    }
    link("join".into(), at.iter().map(|lane| lane[length - 1]).collect(), vec![done]);
    link("again".into(), vec![done], vec![start]);
    net
}

fn line(_lane: usize, length: usize) -> Vec<(usize, usize)> {
    (0..length - 1).map(|s| (s, s + 1)).collect()
}

/// Steps with skips and loops: no lane is series-parallel.
fn tangled(_lane: usize, length: usize) -> Vec<(usize, usize)> {
    let mut links = line(0, length);
    links.extend((0..length - 3).map(|s| (s, s + 2)));
    links.extend((2..length - 1).map(|s| (s, s - 2)));
    links
}

/// 10^8 markings if searched plainly; with a line of 118 steps in front it is a chart of 200.
#[test]
fn eight_lanes_of_ten_steps_are_proved() {
    let mut net = lanes(8, 10, line);
    let again = net.transitions.len() - 1;
    for i in 0..118 {
        let new = net.steps.len();
        net.steps.push(Step { name: format!("M{i}"), initial: false });
        let to = std::mem::replace(&mut net.transitions[again].to, vec![new]);
        net.transitions.push(Transition { name: None, from: vec![new], to });
    }
    assert_eq!(net.steps.len(), 200);
    assert_eq!(report(&net), Report { findings: vec![], proof: Proof::Complete });
    let net = lanes(8, 10, tangled);
    assert_eq!(report(&net), Report { findings: vec![], proof: Proof::Complete });
}

#[test]
fn a_jump_out_of_one_of_eight_lanes_is_found() {
    let mut net = lanes(8, 10, line);
    let from = net.steps.iter().position(|s| s.name == "L3_4").expect("a step");
    net.transitions.push(Transition { name: Some("out".into()), from: vec![from], to: vec![0] });
    let report = report(&net);
    let finding = &report.findings[0];
    assert_eq!(finding.kind, Kind::ActivatedTwice);
    assert_eq!(net.transitions[finding.cause.as_ref().expect("a cause").transition].name.as_deref(), Some("out"));
    // go, four steps of lane 3, out, go
    assert_eq!(finding.path.firings.len(), 7, "{}", text::path(&net, &finding.path));
}

#[test]
fn a_lane_with_an_alternative_past_the_convergence_is_found() {
    let mut net = lanes(8, 10, line);
    let from = net.steps.iter().position(|s| s.name == "L3_4").expect("a step");
    net.steps.push(Step { name: "Off".into(), initial: false });
    let off = net.steps.len() - 1;
    net.transitions.push(Transition { name: Some("out".into()), from: vec![from], to: vec![off] });
    let report = report(&net);
    assert_eq!(report.proof, Proof::Complete);
    let [finding] = report.findings.as_slice() else { panic!("{report:?}") };
    assert_eq!((finding.kind, finding.certain), (Kind::TotallyStuck, false));
    assert_eq!(names(&net, &finding.missing), ["L3_9"]);
}

/// Lanes that all take two of a ring of steps cannot be reduced: the limit is told.
#[test]
fn what_is_too_large_is_said_to_be_not_proved() {
    let mut net = lanes(12, 8, line);
    let at = |l: usize, s: usize| 2 + (l % 12) * 8 + s;
    // Neighbours go on together at every second step: a mesh of convergences.
    for l in 0..12 {
        for s in (1..6).step_by(2) {
            let (a, b) = (at(l, s), at(l + 1, s));
            net.transitions.push(Transition { name: None, from: vec![a, b], to: vec![a + 1, b + 1] });
        }
    }
    let report = report(&net);
    assert!(matches!(report.proof, Proof::Bounded { markings } if markings > 10_000), "{:?}", report.proof);
    assert_eq!(report.findings, []);
}

/// Fourteen lanes that all lead to one step: in most markings thousands of sets of transitions can fire.
#[test]
fn a_wide_unsafe_chart_is_told_in_bounded_time() {
    let mut net = lanes(14, 4, line);
    let join = net.transitions.iter().position(|t| t.name.as_deref() == Some("join")).expect("the convergence");
    let last = std::mem::take(&mut net.transitions[join].from);
    net.transitions.remove(join);
    for step in last {
        net.transitions.push(Transition { name: None, from: vec![step], to: vec![1] });
    }
    let report = report(&net);
    assert_eq!(report.findings.len(), 1, "{report:?}");
    assert_eq!(report.findings[0].kind, Kind::ActivatedTwice);
    assert!(report.findings[0].path.firings.len() < 12);
}
