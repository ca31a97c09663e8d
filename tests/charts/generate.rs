//! Random charts as data, and as text.

use crate::model::*;
use std::fmt::Write;

/// Inputs that conditions read.
pub const INPUTS: usize = 6;
const QUALIFIERS: [&str; 16] = ["N", "N", "N", "S", "S", "R", "R", "R", "L", "D", "P", "P1", "P0", "SD", "DS", "SL"];
const MS: Time = 1_000_000;

/// How a chart stands in its program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// It is the body of a PROGRAM.
    Program,
    /// The body of a function block that is not called in every scan.
    Block,
    /// An ACTION that is not called in every scan.
    Action,
}

/// A random chart.
pub fn chart(random: &mut fastrand::Rng) -> (Chart, Form) {
    let mut chart = Chart { strong: random.u8(..4) == 0, edge: random.u8(..5) == 0, ..Chart::default() };
    let networks = 1 + usize::from(random.u8(..4) == 0);
    // Large charts are compiled in another way.
    let least_steps = if random.u8(..12) == 0 { random.usize(60..120) } else { 0 };
    let mut count = 0;
    while count < networks || chart.steps.len() < least_steps {
        count += 1;
        match random.u8(..5) {
            0 | 1 => network(&mut chart, random),
            _ => structured(&mut chart, random),
        }
    }
    let actions = random.usize(1..6) + chart.steps.len() / 10;
    chart.actions = (0..actions).map(|_| if random.bool() { ActionKind::Block } else { ActionKind::Flag }).collect();
    for step in &mut chart.steps {
        for _ in 0..random.usize(..4) {
            let qualifier = QUALIFIERS[random.usize(..QUALIFIERS.len())];
            let duration = match qualifier {
                "L" | "D" | "SD" | "DS" | "SL" if random.u8(..5) == 0 => Duration::Input,
                "L" | "D" | "SD" | "DS" | "SL" => Duration::Fixed(random.i64(0..9) * 5 * MS),
                _ => Duration::None,
            };
            step.associations.push(Association { action: random.usize(..actions), qualifier, duration });
        }
    }
    let steps = chart.steps.len();
    let flags: Vec<usize> = (0..actions).filter(|a| chart.actions[*a] == ActionKind::Flag).collect();
    for transition in &mut chart.transitions {
        let any = condition(random, steps, &flags, 2);
        // Most transitions become possible sooner or later: a chart that is stuck shows nothing.
        transition.condition = match random.u8(..4) {
            0 => any,
            1 => Condition::Input(random.usize(..INPUTS)),
            _ => Condition::Or(Box::new(Condition::Input(random.usize(..INPUTS))), Box::new(any)),
        };
    }
    priorities(&mut chart, random);
    let form = [Form::Program, Form::Block, Form::Action][random.usize(..3)];
    (chart, form)
}

/// A connected set of steps, the first of them initial.
fn network(chart: &mut Chart, random: &mut fastrand::Rng) {
    let first = chart.steps.len();
    let count = random.usize(1..8);
    for n in 0..count {
        chart.steps.push(Step { initial: n == 0, associations: Vec::new() });
    }
    let some = |random: &mut fastrand::Rng| -> Vec<usize> {
        let wanted = [1, 1, 1, 1, 2, 2, 3][random.usize(..7)].min(count);
        let mut all: Vec<usize> = (first..first + count).collect();
        random.shuffle(&mut all);
        all.truncate(wanted);
        all
    };
    let mut transitions = Vec::new();
    // A way to each step, from one that comes before it, then others.
    for step in first + 1..first + count {
        transitions.push((vec![random.usize(first..step)], vec![step]));
    }
    for _ in 0..random.usize(..count + 3) {
        transitions.push((some(random), some(random)));
    }
    // Several that start together: join successors into one transition now and then.
    if transitions.len() > 2 && random.bool() {
        let (_, more) = transitions[random.usize(..transitions.len())].clone();
        let into = random.usize(..transitions.len());
        for step in more {
            if !transitions[into].1.contains(&step) {
                transitions[into].1.push(step);
            }
        }
    }
    random.shuffle(&mut transitions);
    let never = Condition::Const(false);
    chart.transitions.extend(transitions.into_iter().map(|(from, to)| Transition {
        from,
        to,
        priority: None,
        condition: never.clone(),
    }));
}

/// A network as engineers draw it: sequences, alternatives and simultaneous branches that are properly nested, and a way back
/// to the start; now and then with transitions that do not belong there.
fn structured(chart: &mut Chart, random: &mut fastrand::Rng) {
    let first = chart.steps.len();
    let mut net = Net { next: first, transitions: Vec::new(), random };
    let start = vec![net.step()];
    let (entry, exit) = net.sequence(2);
    net.connect(&start, &entry);
    net.connect(&exit, &start);
    for _ in 0..net.random.usize(..3) {
        if net.random.bool() {
            let step = |net: &mut Net| vec![net.random.usize(first..net.next)];
            let (from, to) = (step(&mut net), step(&mut net));
            net.connect(&from, &to);
        }
    }
    let Net { next, mut transitions, .. } = net;
    random.shuffle(&mut transitions);
    for n in first..next {
        chart.steps.push(Step { initial: n == first, associations: Vec::new() });
    }
    chart.transitions.append(&mut transitions);
}

struct Net<'r> {
    next: usize,
    transitions: Vec<Transition>,
    random: &'r mut fastrand::Rng,
}

/// The steps with which a part begins, and those with which it ends.
type Ends = (Vec<usize>, Vec<usize>);

impl Net<'_> {
    fn step(&mut self) -> usize {
        self.next += 1;
        self.next - 1
    }

    fn connect(&mut self, from: &[usize], to: &[usize]) {
        let condition = Condition::Const(false);
        self.transitions.push(Transition { from: from.to_vec(), to: to.to_vec(), priority: None, condition });
    }

    fn sequence(&mut self, depth: u32) -> Ends {
        let (entry, mut exit) = self.part(depth);
        for _ in 0..self.random.usize(..3) {
            let (next, end) = self.part(depth);
            self.connect(&exit, &next);
            if self.random.u8(..4) == 0 {
                self.connect(&end, &next);
            }
            exit = end;
        }
        (entry, exit)
    }

    fn part(&mut self, depth: u32) -> Ends {
        match self.random.u8(..if depth == 0 { 1 } else { 4 }) {
            0 | 1 => {
                let step = self.step();
                (vec![step], vec![step])
            }
            2 => {
                let (begin, end) = (self.step(), self.step());
                for _ in 0..self.random.usize(2..4) {
                    let (entry, exit) = self.sequence(depth - 1);
                    self.connect(&[begin], &entry);
                    self.connect(&exit, &[end]);
                }
                (vec![begin], vec![end])
            }
            _ => {
                let branches: Vec<Ends> = (0..self.random.usize(2..4)).map(|_| self.sequence(depth - 1)).collect();
                let entry = branches.iter().flat_map(|b| b.0.clone()).collect();
                (entry, branches.iter().flat_map(|b| b.1.clone()).collect())
            }
        }
    }
}

fn condition(random: &mut fastrand::Rng, steps: usize, flags: &[usize], depth: u32) -> Condition {
    match random.u8(..if depth == 0 { 9 } else { 12 }) {
        0..=4 => Condition::Input(random.usize(..INPUTS)),
        5 => Condition::Const(random.u8(..12) != 0),
        6 => Condition::Active(random.usize(..steps)),
        7 => match flags {
            [] => Condition::Input(0),
            _ => Condition::Flag(flags[random.usize(..flags.len())]),
        },
        8 => Condition::Reached(random.usize(..steps), random.i64(0..8) * 7 * MS),
        9 => Condition::Not(Box::new(condition(random, steps, flags, depth - 1))),
        n => {
            let (a, b) = (condition(random, steps, flags, depth - 1), condition(random, steps, flags, depth - 1));
            let (a, b) = (Box::new(a), Box::new(b));
            if n == 10 { Condition::And(a, b) } else { Condition::Or(a, b) }
        }
    }
}

/// Some transitions get numbers; those that share a step get different ones.
fn priorities(chart: &mut Chart, random: &mut fastrand::Rng) {
    let mut numbers: Vec<u32> = (1..=chart.transitions.len() as u32 * 2).collect();
    random.shuffle(&mut numbers);
    for (transition, number) in chart.transitions.iter_mut().zip(numbers) {
        transition.priority = random.bool().then_some(number);
    }
}

/// The declarations of a chart named `prefix`, with a PROGRAM `<prefix>Main`.
pub fn text(chart: &Chart, form: Form, prefix: &str, random: &mut fastrand::Rng) -> String {
    let mut t = String::new();
    let vars = variables(chart);
    let body = body(chart, random);
    let blocks = blocks(chart);
    let options = options(chart);
    match form {
        Form::Program => {
            let _ = write!(t, "PROGRAM {prefix}Main\n{vars}{options}{}END_PROGRAM\n", mixed(body, blocks, random));
        }
        Form::Block => {
            let _ = write!(
                t,
                "FUNCTION_BLOCK {prefix}Seq\n{vars}{options}{}END_FUNCTION_BLOCK\n\
                 PROGRAM {prefix}Main\nVAR\n  s : {prefix}Seq;\nEND_VAR\n  IF en THEN s(); END_IF;\nEND_PROGRAM\n",
                mixed(body, blocks, random)
            );
        }
        Form::Action => {
            let _ = write!(
                t,
                "PROGRAM {prefix}Main\n{vars}{options}  IF en THEN Sub(); END_IF;\nACTION Sub:\n{}END_ACTION\n{}\
                 END_PROGRAM\n",
                body.concat(),
                blocks.concat()
            );
        }
    }
    t
}

fn options(chart: &Chart) -> String {
    let mut options = String::new();
    if chart.strong {
        options.push_str("{sfc_firing := 'strong'}\n");
    }
    if chart.edge {
        options.push_str("{sfc_transition := 'edge'}\n");
    }
    options
}

fn variables(chart: &Chart) -> String {
    let mut t = "VAR\n  log : ULINT;\n".to_string();
    for (n, kind) in chart.actions.iter().enumerate() {
        let _ = match kind {
            ActionKind::Block => writeln!(t, "  n{n} : ULINT;"),
            ActionKind::Flag => writeln!(t, "  a{n} : BOOL;"),
        };
    }
    t.push_str("END_VAR\n");
    t
}

/// Action blocks stand in any order with the rest, but their own order counts.
fn mixed(mut body: Vec<String>, blocks: Vec<String>, random: &mut fastrand::Rng) -> String {
    let mut at = 0;
    for block in blocks {
        at = random.usize(at..=body.len());
        body.insert(at, block);
        at += 1;
    }
    body.concat()
}

fn blocks(chart: &Chart) -> Vec<String> {
    let all = chart.actions.iter().enumerate().filter(|(_, kind)| **kind == ActionKind::Block);
    all.map(|(n, _)| format!("ACTION a{n}:\n  n{n} := n{n} + 1;\n  log := log * 31 + {};\nEND_ACTION\n", n + 1))
        .collect()
}

/// Steps and transitions, each on its own; the transitions in their order, the steps anywhere.
fn body(chart: &Chart, random: &mut fastrand::Rng) -> Vec<String> {
    let mut parts: Vec<String> = chart.transitions.iter().map(transition).collect();
    let mut at = 0;
    for (n, step) in chart.steps.iter().enumerate() {
        at = random.usize(at..=parts.len());
        parts.insert(at, step_text(n, step));
        at += 1;
    }
    parts
}

fn step_text(n: usize, step: &Step) -> String {
    let mut t = format!("{}STEP S{n}:\n", if step.initial { "INITIAL_" } else { "" });
    for a in &step.associations {
        let name = format!("a{}", a.action);
        let _ = match (a.qualifier, a.duration) {
            ("N", _) => writeln!(t, "  {name};"),
            (q, Duration::None) => writeln!(t, "  {name}({q});"),
            (q, Duration::Fixed(time)) => writeln!(t, "  {name}({q}, T#{}ms);", time / MS),
            (q, Duration::Input) => writeln!(t, "  {name}({q}, tv);"),
        };
    }
    t.push_str("END_STEP\n");
    t
}

fn transition(t: &Transition) -> String {
    let side = |steps: &[usize]| match steps {
        [one] => format!("S{one}"),
        many => format!("({})", many.iter().map(|s| format!("S{s}")).collect::<Vec<_>>().join(", ")),
    };
    let priority = t.priority.map(|n| format!("(PRIORITY := {n}) ")).unwrap_or_default();
    format!(
        "TRANSITION {priority}FROM {} TO {} := {}; END_TRANSITION\n",
        side(&t.from),
        side(&t.to),
        condition_text(&t.condition)
    )
}

fn condition_text(c: &Condition) -> String {
    match c {
        Condition::Const(value) => if *value { "TRUE" } else { "FALSE" }.into(),
        Condition::Input(n) => format!("c{n}"),
        Condition::Active(s) => format!("S{s}.X"),
        Condition::Reached(s, time) => format!("S{s}.T >= T#{}ms", time / MS),
        Condition::Flag(a) => format!("a{a}"),
        Condition::Not(c) => format!("NOT ({})", condition_text(c)),
        Condition::And(a, b) => format!("({} AND {})", condition_text(a), condition_text(b)),
        Condition::Or(a, b) => format!("({} OR {})", condition_text(a), condition_text(b)),
    }
}

/// Globals that change in each scan, by a generator whose state starts at `seed`, and the program that changes them.
pub fn stimulus_text(seed: u32) -> String {
    let mut t = format!("VAR_GLOBAL\n  x : UDINT := {seed};\n  tv : TIME;\n  en : BOOL;\n");
    for n in 0..INPUTS {
        let _ = writeln!(t, "  c{n} : BOOL;");
    }
    t.push_str("END_VAR\nPROGRAM Stimulus\n  x := x * 1664525 + 1013904223;\n");
    for n in 0..INPUTS {
        let _ = writeln!(t, "  c{n} := (x / {}) MOD {} = 0;", 1u32 << (8 + 3 * n), 2 + n % 3);
    }
    t.push_str("  tv := UDINT_TO_TIME(((x / 67108864) MOD 6) * 10);\n  en := (x / 1024) MOD 8 > 1;\nEND_PROGRAM\n");
    t
}

/// The same as numbers.
pub struct Stimulus {
    x: u32,
}

impl Stimulus {
    pub fn new(seed: u32) -> Self {
        Self { x: seed }
    }

    /// The inputs of the next scan, and whether blocks and actions are called in it.
    pub fn next(&mut self, now: Time) -> (Inputs, bool) {
        self.x = self.x.wrapping_mul(1664525).wrapping_add(1013904223);
        let x = self.x;
        let bits = (0..INPUTS).map(|n| (x / (1u32 << (8 + 3 * n))).is_multiple_of(2 + n as u32 % 3)).collect();
        let duration = i64::from((x / 67108864) % 6) * 10 * MS;
        (Inputs { now, bits, duration }, (x / 1024) % 8 > 1)
    }
}
