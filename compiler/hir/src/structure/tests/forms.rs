//! Typical structures, right and wrong. The names uncertain, partially stuck and totally stuck are those of the training
//! literature on step sequences; what must be found is worked out by hand.

use super::*;

/// Each finding as `kind certain? steps` and the path with where it ends.
fn told(text: &str) -> Vec<(Kind, bool, Vec<String>)> {
    let net = net(text);
    let report = report(&net);
    assert_eq!(report.proof, Proof::Complete, "{text}");
    report.findings.iter().map(|f| (f.kind, f.certain, names(&net, &f.steps))).collect()
}

fn first_help(text: &str) -> String {
    let net = net(text);
    let report = report(&net);
    text::describe(&net, report.findings.first().expect("a finding"))
        .help
        .first()
        .expect("a path")
        .trim_start_matches("firing path: ")
        .to_string()
}

fn expect(text: &str, kind: Kind, certain: bool, steps: &[&str]) {
    let found = told(text);
    let steps: Vec<String> = steps.iter().map(|s| s.to_string()).collect();
    assert_eq!(found, [(kind, certain, steps)], "{text}");
}

#[test]
fn correct_charts_have_no_findings() {
    for text in [
        "A -> B; B -> C; C -> A",
        // alternatives, joined again, with a loop and a skip
        "A -> B; A -> C; B -> D; C -> D; D -> B; D -> A; A -> D",
        // simultaneous branches of different length
        "A -> B, C; B -> D; D, C -> E; E -> A",
        // an alternative inside a lane, and a loop inside a lane
        "A -> B, C; B -> D; B -> E; D -> F; E -> F; C -> G; G -> C; F, G -> A",
        // nested
        "A -> B, C; B -> D, E; D, E -> F; F, C -> A",
        // finished: end steps only [F9]
        "A -> B, C; B -> D; C -> E",
        // a self-loop that restarts a step [F7]
        "A -> B; B -> B; B -> A",
        // a step that is its own chart
        "A -> A",
        // two lanes that exchange a handshake
        "A -> B, C; B, C -> D, E; D -> F; F, E -> A",
        // both lanes may leave, together or by alternatives that fit together
        "A -> B, C; B, C -> D; B, C -> E; D -> A; E -> A",
    ] {
        assert_eq!(told(text), [], "{text}");
    }
}

#[test]
fn a_step_without_a_way_to_it_is_never_reached() {
    expect("A -> B; B -> A; X -> B", Kind::NeverReached, true, &["X"]);
    // A loop that can never become active.
    expect("A -> B; B -> A; X -> Y; Y -> X; Y -> B", Kind::NeverReached, true, &["X", "Y"]);
}

/// Alternatives closed by a convergence: whichever is chosen, the other never comes.
#[test]
fn alternatives_joined_as_if_simultaneous_are_totally_stuck() {
    let text = "S1 -t1-> S2; S1 -t2-> S3; S2, S3 -t3-> S4; S4 -t4-> S1";
    expect(text, Kind::TotallyStuck, true, &["S2"]);
    assert_eq!(first_help(text), "S1 -t1-> S2: now transition `t3` waits for `S3`, which nothing can activate");
}

/// The uncertain structure: an alternative inside a lane leads past the convergence.
#[test]
fn a_way_out_of_a_lane_leaves_the_others_waiting() {
    let text = "S1 -t1-> S2, S3; S3 -t2-> S4; S3 -t3-> S5; S2, S4 -t4-> S6; S5 -t5-> S7; S6 -t6-> S1; S7 -t7-> S7E";
    expect(text, Kind::TotallyStuck, false, &["S2"]);
    assert_eq!(
        first_help(text),
        "S1 -t1-> S2, S3 -t3-> S2, S5: now transition `t4` waits for `S4`, which nothing can activate"
    );
}

/// The same, back to the start: the second round activates the lane that is still active.
#[test]
fn a_jump_out_of_a_lane_to_the_start_activates_the_others_twice() {
    let text = "S1 -t1-> S2, S3; S3 -t2-> S1; S2, S3 -t3-> S4; S4 -t4-> S1";
    let net = net(text);
    let report = report(&net);
    let f = &report.findings[0];
    assert_eq!((f.kind, f.certain, names(&net, &f.steps)), (Kind::ActivatedTwice, false, vec!["S2".to_string()]));
    let cause = f.cause.as_ref().expect("a cause");
    assert_eq!((cause.transition, names(&net, &cause.left), cause.bypassed), (1, vec!["S2".to_string()], Some(2)));
    let text = text::describe(&net, f);
    assert_eq!(text.message, "transition `t2` bypasses the convergence of transition `t3`: `S2` stays active");
    assert_eq!(
        text.help[..2],
        [
            "firing path: S1 -t1-> S2, S3 -t2-> S1, S2 -t1-> S2, S3: now transition `t1` has activated `S2`, which was still active",
            "so step `S2` can be activated while it is active"
        ]
    );
    assert_eq!(report.findings.len(), 1);
}

/// A lane that goes round and is never left, while the convergence waits for its last step.
#[test]
fn a_lane_that_is_never_left_is_partially_stuck() {
    let text = "S1 -t1-> S2, S3; S3 -t2-> S4; S4 -t3-> S3; S3, S5 -t4-> S6; S4, S6 -t5-> S7; S2, S7 -t6-> S1";
    // S5 has no way to it, t4 is a consequence of that, S6 and S7 too; S2 waits for S7.
    let found = told(text);
    assert!(found.contains(&(Kind::PartiallyStuck, true, vec!["S2".into()])), "{found:?}");
    assert!(found.iter().any(|f| f.0 == Kind::NeverReached && f.2.contains(&"S5".into())), "{found:?}");
    assert_eq!(first_help(text), "S1 -t1-> S2, S3: now transition `t6` waits for `S7`, which nothing can activate");
}

/// Simultaneous branches closed as if they were alternatives: the step behind is activated by each lane.
#[test]
fn simultaneous_branches_joined_as_if_alternative() {
    let text = "S1 -t1-> S2, S3; S2 -t2-> S4; S3 -t3-> S4; S4 -t4-> S1";
    let found = told(text);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!((found[0].0, found[0].1, found[0].2[0].as_str()), (Kind::ActivatedTwice, true, "S4"));
    assert_eq!(
        first_help(text),
        "S1 -t1-> S2, S3 -t2-> S3, S4 -t3-> S4: now transition `t3` has activated `S4`, which was still active"
    );
}

/// Both lanes can be left by themselves, and nothing brings them together.
#[test]
fn a_convergence_of_steps_that_are_never_active_together_never_fires() {
    let text = "S1 -t1-> S2; S1 -t2-> S3; S2, S3 -t3-> S4; S4 -t4-> S1; S2 -t5-> S1; S3 -t6-> S1";
    expect(text, Kind::NeverFires, true, &["S4"]);
}

/// Contact by the weak rule; by the strong one the transition waits and the chart is safe.
#[test]
fn the_strong_rule_takes_a_pipeline() {
    let mut pipeline = net("P1 -feed-> P1, P2; P2, P1 -take-> P1");
    assert_eq!(report(&pipeline).findings[0].kind, Kind::ActivatedTwice);
    pipeline.rule = Rule::Strong;
    let kinds: Vec<Kind> = report(&pipeline).findings.iter().map(|f| f.kind).collect();
    assert_eq!(kinds, [Kind::RulesDiffer]);
}

/// The strong rule looks at the marking before anything fires: two transitions may still activate a step in one call.
#[test]
fn by_the_strong_rule_two_transitions_can_meet_in_one_call() {
    let mut both = net("S1 -t1-> S2, S3; S2 -t2-> S4; S3 -t3-> S4; S4 -t4-> S1");
    both.rule = Rule::Strong;
    let report = report(&both);
    let finding = report.findings.iter().find(|f| f.kind == Kind::ActivatedTwice).expect("found");
    assert_eq!(
        text::describe(&both, finding).help[0],
        "firing path: S1 -t1-> S2, S3 -t2+t3-> S4: now transition `t2` and transition `t3` have activated `S4` in the same call"
    );
    assert!(!finding.certain);
}

#[test]
fn networks_are_analysed_each_for_itself() {
    let mut two = net("A -> B; B -> A; X -> Y; Y -> X; Z -> X");
    two.steps[2].initial = true;
    assert_eq!(networks(&two).len(), 2);
    let report = report(&two);
    assert_eq!(report.findings.len(), 1);
    assert_eq!(names(&two, &report.findings[0].steps), ["Z"]);
}
