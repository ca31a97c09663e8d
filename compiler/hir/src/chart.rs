//! A Sequential Function Chart, resolved: what the structure analysis, `plcc graph` and the tracing read. The same chart as
//! statements is the body of its POU ([`crate::body_check`] made them; they are what runs).
//!
//! In [`Defs::charts`](crate::Defs::charts) stands one [`Chart`] per SFC body without errors in its structure: every step that
//! a transition names exists, no FROM or TO is empty, each network has exactly one initial step.
//!
//! How a chart moves (semantics.md \[F2\]..\[F7\]), for those who explore it: a transition is *enabled* when all steps of `from`
//! are active, under [`Firing::Strong`] only if also all steps of `to` that are not in `from` are inactive. Of enabled
//! transitions whose conditions hold, [`Chart::rank`] decides between those that share a step of `from`; all that are chosen
//! fire together: first all their `from` are cleared, then all their `to` are set.

use crate::body::{Expr, Place, Stmt};
use crate::defs::{PouId, VarId};
use index_vec::IndexVec;
use plcc_diag::Span;
use smol_str::SmolStr;

index_vec::define_index_type! {
    /// A step of a chart, in the order of the text.
    pub struct StepId = u32;
}
index_vec::define_index_type! {
    /// A transition of a chart, in the order of the text (from left to right).
    pub struct TransitionId = u32;
}
index_vec::define_index_type! {
    /// An action of a chart: ACTION blocks in their order of declaration, then BOOL variables in their order of use.
    pub struct ActionId = u32;
}

/// All networks of one body.
#[derive(Debug, Clone)]
pub struct Chart {
    /// Whose body it is: a PROGRAM, a FUNCTION_BLOCK or an ACTION.
    pub pou: PouId,
    /// The POU whose instance holds the marking: `pou`, or the owner of the ACTION.
    pub owner: PouId,
    /// Steps of all networks.
    pub steps: IndexVec<StepId, Step>,
    /// Transitions of all networks.
    pub transitions: IndexVec<TransitionId, Transition>,
    /// What the steps act on.
    pub actions: IndexVec<ActionId, Action>,
    /// Connected sets of steps (\[F1\]), in the order of their first steps.
    pub networks: Vec<Network>,
    /// Weak or strong (\[F5\]).
    pub firing: Firing,
    /// When a condition counts (\[F5\]).
    pub trigger: Trigger,
    /// The whole body.
    pub span: Span,
}

/// A connected set of steps.
#[derive(Debug, Clone)]
pub struct Network {
    /// In the order of the text.
    pub steps: Vec<StepId>,
    /// Its initial step.
    pub initial: StepId,
}

/// The firing rule (\[F5\]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Firing {
    /// The preceding steps are active.
    #[default]
    Weak,
    /// And the succeeding steps that are not preceding ones are not.
    Strong,
}

/// When the condition of a transition counts (\[F5\]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Trigger {
    /// While it is TRUE.
    #[default]
    Level,
    /// When it is TRUE and was FALSE in the call before.
    Edge,
}

/// A step.
#[derive(Debug, Clone)]
pub struct Step {
    /// As declared.
    pub name: SmolStr,
    /// The variable of its POU that holds `.X` and `.T`: its path in traces is that of the step.
    pub var: VarId,
    /// INITIAL_STEP.
    pub initial: bool,
    /// Index in [`Chart::networks`].
    pub network: usize,
    /// What it acts on, in the order of the text.
    pub associations: Vec<Association>,
    /// What operator modes will ask of it; no notation sets it yet.
    pub supervision: Supervision,
    /// Where its name is declared.
    pub span: Span,
}

/// How long a step may take, and whether a person must confirm it. Times in nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Supervision {
    /// Not left earlier.
    pub min_ns: Option<i64>,
    /// Longer is a disturbance.
    pub max_ns: Option<i64>,
    /// Left only after confirmation.
    pub confirmed: bool,
}

/// `act(L, T#5s)` in a step.
#[derive(Debug, Clone)]
pub struct Association {
    /// On what.
    pub action: ActionId,
    /// How.
    pub qualifier: Qualifier,
    /// The duration of a timed qualifier, a TIME.
    pub time: Option<Expr>,
    /// Where.
    pub span: Span,
}

/// Action qualifiers (\[F8\]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Qualifier {
    N,
    S,
    R,
    L,
    D,
    P,
    P1,
    P0,
    SD,
    DS,
    SL,
}

impl Qualifier {
    /// All, in the order of the standard's table.
    pub const ALL: [Qualifier; 11] = {
        use Qualifier::*;
        [N, R, S, L, D, P, SD, DS, SL, P1, P0]
    };

    /// As it is written.
    pub fn text(self) -> &'static str {
        use Qualifier::*;
        match self {
            N => "N",
            S => "S",
            R => "R",
            L => "L",
            D => "D",
            P => "P",
            P1 => "P1",
            P0 => "P0",
            SD => "SD",
            DS => "DS",
            SL => "SL",
        }
    }

    /// Whether it has a duration.
    pub fn timed(self) -> bool {
        use Qualifier::*;
        matches!(self, L | D | SD | DS | SL)
    }
}

/// An action.
#[derive(Debug, Clone)]
pub struct Action {
    /// Its name, or the variable as a user would write it.
    pub name: String,
    /// What it is.
    pub kind: ActionKind,
}

/// What an action is.
#[derive(Debug, Clone)]
pub enum ActionKind {
    /// An ACTION block.
    Block(PouId),
    /// A BOOL variable.
    Variable(Place),
}

/// A transition.
#[derive(Debug, Clone)]
pub struct Transition {
    /// `TRANSITION name`.
    pub name: Option<SmolStr>,
    /// Preceding steps, each once, at least one.
    pub from: Vec<StepId>,
    /// Succeeding steps, each once, at least one.
    pub to: Vec<StepId>,
    /// `PRIORITY := n`; the lowest number comes first.
    pub priority: Option<i128>,
    /// What must hold.
    pub condition: Condition,
    /// From TRANSITION to END_TRANSITION.
    pub span: Span,
}

/// The condition of a transition.
#[derive(Debug, Clone)]
pub struct Condition {
    /// What comes first (IL).
    pub stmts: Vec<Stmt>,
    /// A BOOL. `ExprKind::Const` if it is the same whatever the program does.
    pub value: Expr,
}

impl Chart {
    /// The step with this variable.
    pub fn step_of(&self, var: VarId) -> Option<StepId> {
        self.steps.position(|s| s.var == var)
    }

    /// A transition as messages name it: by its name, or as `t3`, counted from 1 in the order of the text.
    pub fn transition_name(&self, id: TransitionId) -> String {
        match &self.transitions[id].name {
            Some(name) => name.to_string(),
            None => format!("t{}", id.index() + 1),
        }
    }

    /// Who comes first when two transitions share a preceding step (\[F4\]): those with a PRIORITY by their number, then
    /// those without; among equals the text decides. A lower rank comes first.
    pub fn rank(&self, id: TransitionId) -> impl Ord + use<> {
        let priority = self.transitions[id].priority;
        (priority.is_none(), priority.unwrap_or(0), id)
    }

    /// Sets of transitions between which a choice may be needed: those that share preceding steps, also by way of others.
    /// Each in the order of the text, the sets by their first transitions.
    pub fn choices(&self) -> Vec<Vec<TransitionId>> {
        // Which set a step belongs to: the least transition that is known to take it.
        let mut sets: Vec<Vec<TransitionId>> = Vec::new();
        let mut set_of_step: IndexVec<StepId, Option<usize>> = self.steps.iter().map(|_| None).collect();
        for (id, transition) in self.transitions.iter_enumerated() {
            let mut own = vec![id];
            for step in &transition.from {
                if let Some(set) = set_of_step[*step] {
                    own.append(&mut sets[set]);
                }
            }
            own.sort_unstable();
            own.dedup();
            for member in &own {
                for step in &self.transitions[*member].from {
                    set_of_step[*step] = Some(sets.len());
                }
            }
            sets.push(own);
        }
        sets.retain(|set| !set.is_empty());
        sets.sort();
        sets
    }

    /// The step that all transitions of a set take: while it is not active, none of them is possible.
    pub fn shared(&self, set: &[TransitionId]) -> Option<StepId> {
        let from = |id: &TransitionId| &self.transitions[*id].from;
        let first = set.first()?;
        from(first).iter().copied().find(|s| set.iter().all(|t| from(t).contains(s)))
    }
}
