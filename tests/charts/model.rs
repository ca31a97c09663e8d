//! What a Sequential Function Chart means: semantics.md \[F2\]..\[F8\] \[F10\] and the standard's action control, written as an
//! interpreter of plain data. It shares nothing with the compiler and is meant to be read beside those texts.

use std::collections::HashSet;

/// Nanoseconds.
pub type Time = i64;

/// A chart as data.
#[derive(Debug, Clone, Default)]
pub struct Chart {
    pub steps: Vec<Step>,
    /// In the order of the text.
    pub transitions: Vec<Transition>,
    /// In the order of their declaration.
    pub actions: Vec<ActionKind>,
    pub strong: bool,
    pub edge: bool,
    pub final_scan: bool,
}

#[derive(Debug, Clone, Default)]
pub struct Step {
    pub initial: bool,
    pub associations: Vec<Association>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActionKind {
    /// An ACTION block that counts its runs.
    Block,
    /// A BOOL variable.
    Flag,
}

#[derive(Debug, Clone)]
pub struct Association {
    pub action: usize,
    pub qualifier: &'static str,
    pub duration: Duration,
}

#[derive(Debug, Clone, Copy)]
pub enum Duration {
    None,
    Fixed(Time),
    /// A variable that changes from scan to scan.
    Input,
}

#[derive(Debug, Clone)]
pub struct Transition {
    pub from: Vec<usize>,
    pub to: Vec<usize>,
    pub priority: Option<u32>,
    pub condition: Condition,
}

#[derive(Debug, Clone)]
pub enum Condition {
    Const(bool),
    Input(usize),
    Active(usize),
    /// `.T >= time`
    Reached(usize, Time),
    /// The flag of an action that is a BOOL variable.
    Flag(usize),
    Not(Box<Condition>),
    And(Box<Condition>, Box<Condition>),
    Or(Box<Condition>, Box<Condition>),
}

/// What is fed in from outside in one scan.
#[derive(Debug, Clone)]
pub struct Inputs {
    pub now: Time,
    pub bits: Vec<bool>,
    pub duration: Time,
}

/// A chart at work.
#[derive(Debug, Clone)]
pub struct Model<'c> {
    chart: &'c Chart,
    pub x: Vec<bool>,
    pub t: Vec<Time>,
    activated: Vec<Time>,
    called: bool,
    /// Flags of the actions.
    pub flags: Vec<bool>,
    /// How often each body ran.
    pub runs: Vec<u64>,
    /// A sum that depends on the order of the runs.
    pub log: u64,
    /// S of each action.
    stored: Vec<bool>,
    /// Actions that ran in the call before.
    ran: Vec<bool>,
    associations: Vec<Vec<AssociationState>>,
    /// Conditions as they were in the call before, if they were evaluated then.
    before: Vec<Option<bool>>,
}

#[derive(Debug, Clone, Default)]
struct AssociationState {
    x_before: bool,
    stored: bool,
    /// Since when the timer's input has been TRUE.
    since: Option<Time>,
}

impl AssociationState {
    /// An on-delay timer.
    fn ton(&mut self, input: bool, now: Time, duration: Time) -> bool {
        if !input {
            self.since = None;
            return false;
        }
        now - *self.since.get_or_insert(now) >= duration
    }
}

impl<'c> Model<'c> {
    pub fn new(chart: &'c Chart) -> Self {
        let steps = chart.steps.len();
        let actions = chart.actions.len();
        Model {
            chart,
            x: chart.steps.iter().map(|s| s.initial).collect(),
            t: vec![0; steps],
            activated: vec![0; steps],
            called: false,
            flags: vec![false; actions],
            runs: vec![0; actions],
            log: 0,
            stored: vec![false; actions],
            ran: vec![false; actions],
            associations: chart.steps.iter().map(|s| vec![Default::default(); s.associations.len()]).collect(),
            before: vec![None; chart.transitions.len()],
        }
    }

    /// One call.
    pub fn call(&mut self, inputs: &Inputs) {
        self.refresh_times(inputs.now);
        let active = self.action_control(inputs);
        self.run(&active);
        self.evolve(inputs);
    }

    /// (1) \[F6\].
    fn refresh_times(&mut self, now: Time) {
        for s in 0..self.x.len() {
            if !self.called && self.chart.steps[s].initial {
                self.activated[s] = now;
            }
            if self.x[s] {
                self.t[s] = now - self.activated[s];
            }
        }
        self.called = true;
    }

    /// (2) \[F8\]: which actions are active.
    fn action_control(&mut self, inputs: &Inputs) -> Vec<bool> {
        let chart = self.chart;
        let of = |action: usize| {
            let all = chart.steps.iter().enumerate();
            all.flat_map(move |(s, step)| {
                let list = step.associations.iter().enumerate();
                list.filter(move |(_, a)| a.action == action).map(move |(n, a)| (s, n, a))
            })
        };
        let mut active = Vec::new();
        for action in 0..chart.actions.len() {
            let reset = of(action).any(|(s, _, a)| a.qualifier == "R" && self.x[s]);
            let mut runs = false;
            for (s, n, a) in of(action) {
                let x = self.x[s];
                let state = &mut self.associations[s][n];
                let duration = match a.duration {
                    Duration::None => 0,
                    Duration::Fixed(time) => time,
                    Duration::Input => inputs.duration,
                };
                runs |= match a.qualifier {
                    "N" => x,
                    "R" => false,
                    "S" => {
                        self.stored[action] |= x;
                        false
                    }
                    "P" | "P1" => x && !state.x_before,
                    "P0" => !x && state.x_before,
                    "L" => !state.ton(x, inputs.now, duration) && x,
                    "D" => state.ton(x, inputs.now, duration),
                    "SD" => {
                        state.stored = (state.stored || x) && !reset;
                        let stored = state.stored;
                        state.ton(stored, inputs.now, duration)
                    }
                    "DS" => {
                        if state.ton(x && !reset, inputs.now, duration) {
                            state.stored = true;
                        }
                        state.stored &= !reset;
                        state.stored
                    }
                    "SL" => {
                        state.stored = (state.stored || x) && !reset;
                        let stored = state.stored;
                        !state.ton(stored, inputs.now, duration) && stored
                    }
                    other => panic!("qualifier {other}"),
                };
                self.associations[s][n].x_before = x;
            }
            self.stored[action] &= !reset;
            active.push(!reset && (runs || self.stored[action]));
        }
        for (action, kind) in chart.actions.iter().enumerate() {
            if *kind == ActionKind::Flag && of(action).next().is_some() {
                self.flags[action] = active[action];
            }
        }
        active
    }

    /// (3) \[F10\].
    fn run(&mut self, active: &[bool]) {
        let blocks: Vec<usize> = (0..active.len()).filter(|a| self.chart.actions[*a] == ActionKind::Block).collect();
        let ended = blocks.iter().copied().filter(|a| self.chart.final_scan && self.ran[*a] && !active[*a]);
        let now = blocks.iter().copied().filter(|a| active[*a]);
        for action in ended.chain(now).collect::<Vec<_>>() {
            self.runs[action] += 1;
            self.log = self.log.wrapping_mul(31).wrapping_add(action as u64 + 1);
        }
        self.ran = active.to_vec();
    }

    /// (4) to (6) \[F4\] \[F5\] \[F7\].
    fn evolve(&mut self, inputs: &Inputs) {
        let chart = self.chart;
        let mut order: Vec<usize> = (0..chart.transitions.len()).collect();
        // Those without a priority come last; the text decides among equals (the sort is stable).
        order.sort_by_key(|t| chart.transitions[*t].priority.unwrap_or(u32::MAX));
        let values: Vec<Option<bool>> = chart
            .transitions
            .iter()
            .map(|t| t.from.iter().all(|s| self.x[*s]).then(|| self.holds(&t.condition, inputs)))
            .collect();
        let mut taken: HashSet<usize> = HashSet::new();
        let mut fired = Vec::new();
        for t in order {
            let transition = &chart.transitions[t];
            let counts = match values[t] {
                Some(true) => !chart.edge || self.before[t] == Some(false),
                _ => false,
            };
            let free = |s: &usize| transition.from.contains(s) || !self.x[*s];
            if !counts || (chart.strong && !transition.to.iter().all(free)) {
                continue;
            }
            if transition.from.iter().any(|s| taken.contains(s)) {
                continue;
            }
            taken.extend(&transition.from);
            fired.push(transition);
        }
        self.before = values;
        for transition in &fired {
            transition.from.iter().for_each(|s| self.x[*s] = false);
        }
        for transition in &fired {
            for s in &transition.to {
                self.x[*s] = true;
                self.t[*s] = 0;
                self.activated[*s] = inputs.now;
            }
        }
    }

    fn holds(&self, condition: &Condition, inputs: &Inputs) -> bool {
        match condition {
            Condition::Const(value) => *value,
            Condition::Input(n) => inputs.bits[*n],
            Condition::Active(s) => self.x[*s],
            Condition::Reached(s, time) => self.t[*s] >= *time,
            Condition::Flag(action) => self.flags[*action],
            Condition::Not(c) => !self.holds(c, inputs),
            Condition::And(a, b) => self.holds(a, inputs) && self.holds(b, inputs),
            Condition::Or(a, b) => self.holds(a, inputs) || self.holds(b, inputs),
        }
    }
}
