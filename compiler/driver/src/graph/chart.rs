//! A chart as it is drawn: names and texts, and which of its parts follow which.

/// A chart.
#[derive(Debug, Clone, Default)]
pub struct Chart {
    /// Steps, in the order of the text.
    pub steps: Vec<Step>,
    /// Transitions, in the order of the text.
    pub transitions: Vec<Transition>,
}

/// A step.
#[derive(Debug, Clone, Default)]
pub struct Step {
    /// Its name.
    pub name: String,
    /// INITIAL_STEP.
    pub initial: bool,
    /// In the cycle that is shown.
    pub active: bool,
    /// Its action blocks.
    pub actions: Vec<Action>,
}

/// An action block: qualifier, name, time, indicator, empty where there is none.
#[derive(Debug, Clone, Default)]
pub struct Action {
    /// `N` where none is written.
    pub qualifier: String,
    /// The action or the BOOL variable.
    pub name: String,
    /// `T#5s`.
    pub time: String,
    /// Indicator variables.
    pub indicator: String,
}

/// A transition. Steps are indices into [`Chart::steps`].
#[derive(Debug, Clone, Default)]
pub struct Transition {
    /// If it has a name.
    pub name: Option<String>,
    /// `PRIORITY := n`.
    pub priority: Option<String>,
    /// The condition, as written.
    pub condition: String,
    /// Preceding steps.
    pub from: Vec<usize>,
    /// Succeeding steps.
    pub to: Vec<usize>,
}

impl Transition {
    /// What a reference to it says when no line leads there.
    pub fn label(&self, number: usize) -> String {
        self.name.clone().unwrap_or_else(|| format!("t{}", number + 1))
    }
}
