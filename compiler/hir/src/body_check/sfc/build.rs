//! The tree of a chart to a [`Chart`]: names of steps and actions, networks, priorities, conditions; each mistake reported.

use super::{actions, il_condition};
use crate::PouId;
use crate::chart::*;
use crate::cx::*;
use crate::expr::Checker;
use index_vec::IndexVec;
use plcc_diag::{Diagnostic, Span, codes};
use plcc_syntax::ast;
use rustc_hash::FxHashMap;
use smol_str::SmolStr;

/// Builds the chart of `pou`; `None` if its structure is wrong.
pub(super) fn build<'a>(
    c: &mut Checker<'_, 'a>,
    pou: PouId,
    body: &'a ast::SfcBody,
    labels: &mut u32,
) -> Option<Chart> {
    let owner = c.cx.defs.pous[pou].owner.unwrap_or(pou);
    let options = c.cx.pou_slots[owner].chart_options;
    let mut builder = Builder {
        c,
        labels,
        chart: Chart {
            pou,
            owner,
            steps: IndexVec::new(),
            transitions: IndexVec::new(),
            actions: IndexVec::new(),
            networks: Vec::new(),
            firing: options.firing,
            trigger: options.trigger,
            span: body.span,
        },
        names: FxHashMap::default(),
        sound: true,
    };
    builder.steps(body);
    builder.associations(body);
    builder.transitions(body);
    builder.networks();
    builder.priorities();
    let Builder { chart, sound, .. } = builder;
    sound.then_some(chart)
}

struct Builder<'b, 'c, 'a> {
    c: &'b mut Checker<'c, 'a>,
    labels: &'b mut u32,
    chart: Chart,
    /// Steps by folded name.
    names: FxHashMap<SmolStr, StepId>,
    /// Nothing was wrong.
    sound: bool,
}

impl<'a> Builder<'_, '_, 'a> {
    fn wrong(&mut self, diagnostic: Diagnostic) {
        self.c.report(diagnostic);
        self.sound = false;
    }

    fn steps(&mut self, body: &'a ast::SfcBody) {
        for step in steps_of(body) {
            let pointer: *const ast::Step = step;
            let Some(&var) = self.c.cx.steps.get(&pointer) else {
                // Declared twice; reported there, and transitions that name it need no further message.
                self.sound = false;
                self.c.cx.first_report(self.c.scope, &format!("step {}", fold(&step.name.text)));
                continue;
            };
            let id = self.chart.steps.push(Step {
                name: step.name.text.clone(),
                var,
                initial: step.initial,
                network: 0,
                associations: Vec::new(),
                supervision: Supervision::default(),
                span: step.name.span,
            });
            self.names.insert(fold(&step.name.text), id);
        }
    }

    fn associations(&mut self, body: &'a ast::SfcBody) {
        let mut resolver = actions::Resolver::new(self.c, self.chart.owner);
        for step in steps_of(body) {
            let mut list = Vec::new();
            for association in &step.actions {
                list.extend(resolver.association(association));
            }
            if let Some(id) = self.names.get(&fold(&step.name.text)) {
                self.chart.steps[*id].associations = list;
            }
        }
        let (actions, fine) = resolver.finish(&mut self.chart.steps);
        self.chart.actions = actions;
        self.sound &= fine;
    }

    fn transitions(&mut self, body: &'a ast::SfcBody) {
        let mut names: FxHashMap<SmolStr, Span> = FxHashMap::default();
        for element in &body.elements {
            let ast::SfcElement::Transition(transition) = element else { continue };
            if let Some(name) = &transition.name
                && let Some(first) = names.insert(fold(&name.text), name.span)
            {
                self.wrong(
                    Diagnostic::new(
                        codes::DUPLICATE_NAME,
                        name.span,
                        format!("transition `{}` is declared twice", name.text),
                    )
                    .label("declared again here")
                    .also(first, "first declared here")
                    .help("remove or rename one of them; names do not differ by case"),
                );
            }
            // What the parser could not read, it has reported.
            let unread =
                matches!(&transition.condition, ast::Condition::St(e) if matches!(e.kind, ast::ExprKind::Error));
            if unread && transition.from.is_empty() && transition.to.is_empty() {
                self.sound = false;
                continue;
            }
            let from = self.side(transition, &transition.from, "FROM");
            let to = self.side(transition, &transition.to, "TO");
            let priority = transition.priority.as_ref().and_then(|e| {
                let number = self.c.const_integer(e);
                self.sound &= number.is_some();
                number
            });
            let condition = match &transition.condition {
                ast::Condition::St(e) => Some(Condition { stmts: Vec::new(), value: self.c.condition(e) }),
                ast::Condition::Il(il) => il_condition(self.c, self.labels, il),
                ast::Condition::Steps(statements, value) => {
                    let stmts = crate::body_check::st::check_part(self.c, statements, self.labels);
                    Some(Condition { stmts, value: self.c.condition(value) })
                }
                ast::Condition::Network(network) => {
                    plcc_diag::bug!("a network that was not lowered: {:?}", network.span)
                }
            };
            let condition = condition.filter(|c| c.value.ty != crate::Types::ERROR);
            let (Some(from), Some(to), Some(condition)) = (from, to, condition) else {
                self.sound = false;
                continue;
            };
            let name = transition.name.as_ref().map(|n| n.text.clone());
            self.chart.transitions.push(Transition { name, from, to, priority, condition, span: transition.span });
        }
    }

    /// The steps of FROM or TO.
    fn side(&mut self, transition: &ast::Transition, names: &[ast::Name], word: &str) -> Option<Vec<StepId>> {
        if names.is_empty() {
            let message = format!("this transition has no {word}");
            let help = match word {
                "FROM" => "write FROM and the step, or in ( ) the steps, that it leaves",
                _ => "write TO and the step, or in ( ) the steps, that it activates",
            };
            self.wrong(Diagnostic::new(codes::TRANSITION_WITHOUT_STEPS, head(transition.span), message).help(help));
            return None;
        }
        let mut steps = Vec::new();
        let mut fine = true;
        for name in names {
            let Some(&step) = self.names.get(&fold(&name.text)) else {
                fine = false;
                self.unknown_step(name);
                continue;
            };
            if steps.contains(&step) {
                let message = format!("`{}` stands twice behind this {word}", name.text);
                self.wrong(Diagnostic::new(codes::STEP_TWICE, name.span, message).help("remove one of them"));
                continue;
            }
            steps.push(step);
        }
        fine.then_some(steps)
    }

    fn unknown_step(&mut self, name: &ast::Name) {
        self.sound = false;
        if !self.c.cx.first_report(self.c.scope, &format!("step {}", fold(&name.text))) {
            return;
        }
        let near = similar(&name.text, self.chart.steps.iter().map(|s| s.name.as_str()));
        self.c.report(
            Diagnostic::new(codes::UNKNOWN_STEP, name.span, format!("there is no step `{}` in this chart", name.text))
                .help(match near {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => "declare it: `STEP name: ... END_STEP`".into(),
                }),
        );
    }

    /// Connected sets of steps, each with its one initial step. Only where all transitions are known: a wrong name would
    /// cut a network in two and give a second message.
    fn networks(&mut self) {
        if !self.sound {
            return;
        }
        let mut of: Vec<usize> = (0..self.chart.steps.len()).collect();
        fn root(of: &mut [usize], mut at: usize) -> usize {
            while of[at] != at {
                of[at] = of[of[at]];
                at = of[at];
            }
            at
        }
        for transition in &self.chart.transitions {
            let mut ends = transition.from.iter().chain(&transition.to).map(|s| s.index());
            let Some(first) = ends.next() else { continue };
            for other in ends {
                let (a, b) = (root(&mut of, first), root(&mut of, other));
                of[a.max(b)] = a.min(b);
            }
        }
        let mut members: Vec<Vec<StepId>> = Vec::new();
        let mut number: FxHashMap<usize, usize> = FxHashMap::default();
        for step in self.chart.steps.indices() {
            let network = *number.entry(root(&mut of, step.index())).or_insert(members.len());
            if network == members.len() {
                members.push(Vec::new());
            }
            members[network].push(step);
            self.chart.steps[step].network = network;
        }
        for steps in members {
            self.network(steps);
        }
    }

    fn network(&mut self, steps: Vec<StepId>) {
        let chart = &self.chart;
        let mut initial = steps.iter().copied().filter(|s| chart.steps[*s].initial);
        match (initial.next(), initial.next()) {
            (Some(initial), None) => self.chart.networks.push(Network { steps, initial }),
            (Some(first), Some(second)) => {
                let (first, second) = (&chart.steps[first], &chart.steps[second]);
                let message = format!("`{}` and `{}` are initial steps of the same network", first.name, second.name);
                let d = Diagnostic::new(codes::SEVERAL_INITIAL_STEPS, second.span, message)
                    .also(first.span, "the first one is here")
                    .help("a network starts with one INITIAL_STEP; make the others STEPs");
                self.wrong(d);
            }
            (None, _) => {
                let Some(first) = steps.first().map(|s| &chart.steps[*s]) else { return };
                let message = match steps.len() {
                    1 => format!("no transition leads to step `{}`, and it is no initial step", first.name),
                    n => format!("the network of `{}` and {} more has no initial step", first.name, steps_word(n - 1)),
                };
                let d = Diagnostic::new(codes::NO_INITIAL_STEP, first.span, message)
                    .help("write INITIAL_STEP for the step that is active at the start");
                self.wrong(d);
            }
        }
    }

    /// Equal explicit priorities of transitions that share a preceding step (\[F4\]).
    fn priorities(&mut self) {
        let mut found: FxHashMap<(StepId, i128), TransitionId> = FxHashMap::default();
        let mut pairs = Vec::new();
        for (id, transition) in self.chart.transitions.iter_enumerated() {
            let Some(priority) = transition.priority else { continue };
            for step in &transition.from {
                let first = *found.entry((*step, priority)).or_insert(id);
                if first != id && !pairs.iter().any(|(_, second, _)| *second == id) {
                    pairs.push((first, id, *step));
                }
            }
        }
        for (first, second, step) in pairs {
            let transitions = &self.chart.transitions;
            let message = format!(
                "two transitions from `{}` have PRIORITY {}",
                self.chart.steps[step].name,
                transitions[second].priority.unwrap_or(0)
            );
            let d = Diagnostic::new(codes::EQUAL_PRIORITIES, head(transitions[second].span), message)
                .also(head(transitions[first].span), "the other one is here")
                .help("give them different numbers; the lowest comes first");
            self.wrong(d);
        }
    }
}

fn steps_of(body: &ast::SfcBody) -> impl Iterator<Item = &ast::Step> {
    body.elements.iter().filter_map(|e| match e {
        ast::SfcElement::Step(step) => Some(step),
        ast::SfcElement::Transition(_) => None,
    })
}

fn steps_word(n: usize) -> String {
    if n == 1 { "1 step".into() } else { format!("{n} steps") }
}

/// The word TRANSITION of a transition.
fn head(span: Span) -> Span {
    Span::new(span.file, span.start, span.end.min(span.start + "TRANSITION".len() as u32))
}
