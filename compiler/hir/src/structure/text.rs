//! Findings as sentences in the words of the standard.

use super::{Finding, Kind, Net, Path, Rule};

/// What to tell about a finding.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Text {
    /// What is wrong, without a full stop.
    pub message: String,
    /// How the chart gets there and what it waits for, then advice; in the order to be shown.
    pub help: Vec<String>,
}

/// Markings and calls shown of a long path: so many in front, so many behind.
const SHOWN: (usize, usize) = (4, 8);
/// Active steps shown of a marking.
const SHOWN_STEPS: usize = 8;

/// The sentences for a finding.
pub fn describe(net: &Net, finding: &Finding) -> Text {
    let words = Words { net, finding };
    let mut help = Vec::new();
    help.extend(words.way().map(|way| format!("firing path: {way}")));
    // Where a jump is the only reason, it is the mistake and the rest its consequence.
    let message = match (words.cause(), finding.kind) {
        (Some(cause), Kind::ActivatedTwice) if !finding.certain => {
            help.push(format!("so {}", words.message()));
            cause
        }
        (cause, _) => {
            help.extend(cause);
            words.message()
        }
    };
    help.extend(words.advice());
    Text { message, help }
}

/// `S1 -t1-> S2, S3 -> S2, S5`: the active steps, and between them what fired; a transition without a name is a bare arrow.
pub fn path(net: &Net, path: &Path) -> String {
    let count = path.markings.len();
    let (front, behind) = SHOWN;
    let mut text = String::new();
    let mut gap = false;
    for (index, marking) in path.markings.iter().enumerate() {
        if index >= front && index + behind < count {
            if !gap {
                text.push_str(&format!(" ... ({} more) ...", count - front - behind));
            }
            gap = true;
            continue;
        }
        if index > 0 {
            text.push_str(&arrow(net, &path.firings[index - 1]));
        }
        let mut steps: Vec<&str> = marking.iter().map(|&s| net.steps[s].name.as_str()).collect();
        let hidden = steps.len().saturating_sub(SHOWN_STEPS);
        steps.truncate(SHOWN_STEPS);
        text.push_str(&steps.join(", "));
        if hidden > 0 {
            text.push_str(&format!(" and {hidden} more"));
        }
    }
    text
}

fn arrow(net: &Net, fired: &[usize]) -> String {
    let names: Vec<&str> = fired.iter().filter_map(|&t| net.transitions[t].name.as_deref()).collect();
    match names.is_empty() {
        true => " -> ".into(),
        false => format!(" -{}-> ", names.join("+")),
    }
}

struct Words<'a> {
    net: &'a Net,
    finding: &'a Finding,
}

impl Words<'_> {
    fn message(&self) -> String {
        let (steps, several) = (self.steps(&self.finding.steps), self.finding.steps.len() > 1);
        let first = self.finding.steps.first().map(|&s| self.steps(&[s])).unwrap_or_default();
        let can = if self.finding.certain { "" } else { "can " };
        match self.finding.kind {
            Kind::NeverReached if several => format!("steps {steps} are never reached"),
            Kind::NeverReached => format!("step {steps} is never reached"),
            Kind::NeverFires => format!("{} can never fire", self.transition(self.finding.transitions[0])),
            Kind::TotallyStuck | Kind::PartiallyStuck => {
                let (step, wait) = if several { ("steps", "wait") } else { ("step", "waits") };
                let wait = if self.finding.certain { wait.into() } else { format!("{can}wait") };
                let rest = match self.finding.kind {
                    Kind::TotallyStuck => "and the chart stands still",
                    _ => "while other steps go on",
                };
                format!("{step} {steps} {wait} for ever {rest}")
            }
            Kind::ActivatedTwice if self.finding.certain => format!("step {first} is activated while it is active"),
            Kind::ActivatedTwice => format!("step {first} can be activated while it is active"),
            Kind::RulesDiffer => {
                format!("only the strong firing rule keeps step {first} from being activated while it is active")
            }
        }
    }

    /// The path and where it ends.
    fn way(&self) -> Option<String> {
        if self.finding.path.markings.is_empty() {
            return None;
        }
        let way = path(self.net, &self.finding.path);
        let end = match self.finding.kind {
            Kind::NeverReached => return None,
            Kind::NeverFires => {
                let t = self.finding.transitions[0];
                let now = self.finding.path.markings.last()?;
                let from = &self.net.transitions[t].from;
                let missing: Vec<usize> = from.iter().copied().filter(|s| !now.contains(s)).collect();
                match missing.is_empty() {
                    true => format!("{} waits until its succeeding steps are inactive", self.transition(t)),
                    false => format!(
                        "{} waits for {}, which {} never active together with {}",
                        self.transition(t),
                        self.steps(&missing),
                        if missing.len() > 1 { "are" } else { "is" },
                        self.steps(&from.iter().copied().filter(|s| now.contains(s)).collect::<Vec<_>>()),
                    ),
                }
            }
            Kind::TotallyStuck | Kind::PartiallyStuck => self.waits()?,
            Kind::ActivatedTwice | Kind::RulesDiffer => self.twice()?,
        };
        Some(format!("{way}: now {end}"))
    }

    fn twice(&self) -> Option<String> {
        let step = *self.finding.steps.first()?;
        let fired = self.finding.path.firings.last()?;
        let by: Vec<usize> = fired.iter().copied().filter(|&t| self.net.transitions[t].to.contains(&step)).collect();
        Some(match by.as_slice() {
            [first, second, ..] => format!(
                "{} and {} have activated {} in the same call",
                self.transition(*first),
                self.transition(*second),
                self.steps(&[step])
            ),
            _ => format!(
                "{} has activated {}, which was still active",
                self.transition(*self.finding.transitions.first()?),
                self.steps(&[step])
            ),
        })
    }

    fn waits(&self) -> Option<String> {
        let now = self.finding.path.markings.last()?;
        let inactive = |t: usize| -> Vec<usize> {
            self.net.transitions[t].from.iter().copied().filter(|s| !now.contains(s)).collect()
        };
        let missing = &self.finding.missing;
        let concerns = |t: &&usize| missing.is_empty() || inactive(**t).iter().any(|s| missing.contains(s));
        let t = *self.finding.transitions.iter().find(concerns)?;
        let waits = self.transition(t);
        if inactive(t).is_empty() {
            return Some(format!("{waits} waits until its succeeding steps are inactive, which they never are"));
        }
        if missing.is_empty() {
            let steps = self.steps(&inactive(t));
            return Some(format!("{waits} waits for {steps}, never active at the right time any more"));
        }
        Some(format!("{waits} waits for {}, which nothing can activate", self.steps(missing)))
    }

    fn cause(&self) -> Option<String> {
        let cause = self.finding.cause.as_ref()?;
        let what = match cause.bypassed {
            Some(convergence) => format!("bypasses the convergence of {}", self.transition(convergence)),
            None => "jumps out of a simultaneous branch".into(),
        };
        let stay = if cause.left.len() > 1 { "stay" } else { "stays" };
        Some(format!("{} {what}: {} {stay} active", self.transition(cause.transition), self.steps(&cause.left)))
    }

    fn advice(&self) -> Vec<String> {
        let mut advice = Vec::new();
        match self.finding.kind {
            Kind::NeverReached if self.finding.transitions.is_empty() => {
                advice.push("no transition has it as succeeding step (TO)".into());
            }
            Kind::NeverReached => {
                advice.push("each transition that leads there has a preceding step that is never active".into());
            }
            Kind::NeverFires => {
                if !self.finding.steps.is_empty() {
                    let are = if self.finding.steps.len() > 1 { "are" } else { "is" };
                    advice.push(format!("so {} {are} never reached", self.steps(&self.finding.steps)));
                }
                advice.push(
                    "alternative branches are joined by one transition each, FROM (a, b) joins simultaneous ones"
                        .into(),
                );
            }
            Kind::TotallyStuck | Kind::PartiallyStuck => {
                if !self.finding.certain {
                    advice.push("whether it comes to that depends on the conditions only".into());
                }
            }
            Kind::ActivatedTwice => {
                let others = &self.finding.steps[1..];
                if !others.is_empty() {
                    advice.push(format!("the same can happen to {}", self.steps(others)));
                }
                advice.push(
                    "simultaneous branches are joined by one transition with all their last steps behind FROM".into(),
                );
                if self.net.rule == Rule::Weak {
                    advice.push(
                        "here the firing rules differ: with {sfc_firing := 'strong'} the transition would wait".into(),
                    );
                }
            }
            Kind::RulesDiffer => {
                advice.push("a chart that needs no strong rule runs the same on every controller".into());
            }
        }
        advice
    }

    fn steps(&self, steps: &[usize]) -> String {
        list(steps.iter().map(|&s| self.net.steps[s].name.as_str()))
    }

    fn transition(&self, t: usize) -> String {
        let transition = &self.net.transitions[t];
        match &transition.name {
            Some(name) => format!("transition `{name}`"),
            None => format!("the transition from {} to {}", self.steps(&transition.from), self.steps(&transition.to)),
        }
    }
}

/// `` `a`, `b` and `c` ``; of many the first ones.
fn list<'n>(names: impl ExactSizeIterator<Item = &'n str>) -> String {
    let count = names.len();
    let mut quoted: Vec<String> = names.take(SHOWN_STEPS).map(|name| format!("`{name}`")).collect();
    if count > SHOWN_STEPS {
        quoted.push(format!("{} more", count - SHOWN_STEPS));
    }
    match quoted.pop() {
        Some(last) if !quoted.is_empty() => format!("{} and {last}", quoted.join(", ")),
        Some(last) => last,
        None => String::new(),
    }
}
