//! POUs, their actions and transitions, and bodies.

use super::Reader;
use super::nodes::{attribute, child, children, named};
use crate::ast::*;
use plcc_diag::{Diagnostic, Span, codes};
use roxmltree::Node;
use rustc_hash::FxHashMap;

/// A transition that is written beside the body, and used by its name.
#[derive(Clone)]
pub(super) struct NamedCondition {
    pub name: Name,
    pub condition: Condition,
}

/// What the charts of a POU share.
#[derive(Default)]
pub(super) struct ChartParts {
    /// By name in upper case.
    pub transitions: FxHashMap<String, NamedCondition>,
    /// Actions that are written inside the chart; they follow the POU's own.
    pub inline: Vec<Action>,
    /// Names that are taken, in upper case.
    pub names: Vec<String>,
}

impl Reader<'_, '_> {
    pub(super) fn pou(&mut self, node: Node) {
        let Some(name) = self.name(node, "name") else { return };
        let Some(found) = self.required(node, "pouType") else { return };
        let kind = match found.value().trim() {
            "program" => PouKind::Program,
            "functionBlock" => PouKind::FunctionBlock,
            "function" => PouKind::Function,
            other => {
                let span = self.value_span(found);
                let message = format!("`{other}` is no kind of POU");
                self.say(
                    Diagnostic::new(codes::XML_VALUE, span, message)
                        .help("it is `program`, `functionBlock` or `function`"),
                );
                return;
            }
        };
        self.pou = name.text.to_string();
        self.place(node, name.text.to_string(), false);
        let (sections, result) = self.interface(node);
        let mut actions = Vec::new();
        let mut parts = ChartParts::default();
        for list in named(node, "transitions") {
            for transition in named(list, "transition") {
                self.named_transition(transition, &mut parts);
            }
        }
        for list in named(node, "actions") {
            for action in named(list, "action") {
                let Some(action_name) = self.name(action, "name") else { continue };
                parts.names.push(action_name.text.to_ascii_uppercase());
                self.place(action, format!("{}.{}", name.text, action_name.text), false);
                let body = self.bodies(action, &mut parts, &mut Vec::new());
                actions.push(Action { owner: None, name: action_name, body, span: self.whole(action) });
            }
        }
        let body = self.bodies(node, &mut parts, &mut actions);
        actions.append(&mut parts.inline);
        let span = self.whole(node);
        self.out.items.push(Item::Pou(Pou { kind, name, result, sections, actions, body, span }));
    }

    /// The body of a POU or an action. ACTIONs written in a text go to `actions`.
    fn bodies(&mut self, holder: Node, parts: &mut ChartParts, actions: &mut Vec<Action>) -> Body {
        let empty = Body::St(Vec::new());
        let mut worksheets = named(holder, "body").flat_map(children);
        let Some(first) = worksheets.next() else { return empty };
        if let Some(second) = worksheets.next() {
            self.unsupported(second, "a second worksheet in a body", "put everything into one worksheet");
        }
        self.body(first, parts, actions)
    }

    /// A body by its notation.
    fn body(&mut self, node: Node, parts: &mut ChartParts, actions: &mut Vec<Action>) -> Body {
        match node.tag_name().name() {
            "ST" => self.text(node, false, actions),
            "IL" => self.text(node, true, actions),
            "FBD" => Body::Network(self.network(node, Notation::Fbd)),
            "LD" => Body::Network(self.network(node, Notation::Ld)),
            "SFC" => Body::Sfc(self.chart(node, parts)),
            _ => {
                self.unknown(node, "a body");
                Body::St(Vec::new())
            }
        }
    }

    fn text(&mut self, node: Node, il: bool, actions: &mut Vec<Action>) -> Body {
        let pou = self.pou.clone();
        self.place(node, pou, true);
        let (body, mut inner) = self.text_body(node, il);
        actions.append(&mut inner);
        body
    }

    /// A body that stands inside a chart.
    pub(super) fn inline_body(&mut self, holder: Node, parts: &mut ChartParts) -> Body {
        match children(holder).next() {
            Some(node) => self.body(node, parts, &mut Vec::new()),
            None => Body::St(Vec::new()),
        }
    }

    fn named_transition(&mut self, node: Node, parts: &mut ChartParts) {
        let Some(name) = self.name(node, "name") else { return };
        let place = format!("{}, transition {}", self.pou, name.text);
        self.place(node, place, false);
        let Some(body) = child(node, "body").and_then(|b| children(b).next()) else {
            let message = format!("the transition `{}` has no body", name.text);
            self.say(
                Diagnostic::new(codes::XML_MISSING, name.span, message).help("give it a condition in one notation"),
            );
            return;
        };
        let condition = self.condition_body(body, &name.text);
        let key = name.text.to_ascii_uppercase();
        if let Some(first) = parts.transitions.get(&key) {
            let first = first.name.span;
            self.say(
                Diagnostic::new(
                    codes::DUPLICATE_NAME,
                    name.span,
                    format!("transition `{}` is declared twice", name.text),
                )
                .label("declared again here")
                .also(first, "first declared here")
                .help("remove or rename one of them; names do not differ by case"),
            );
            return;
        }
        parts.transitions.insert(key, NamedCondition { name, condition });
    }

    /// A condition that is written in a notation of its own. `name` is that of the transition, if it has one: the variable or
    /// coil of this name takes the value.
    pub(super) fn condition_body(&mut self, node: Node, name: &str) -> Condition {
        let pou = self.pou.clone();
        let span = self.tag(node);
        let error = || Condition::St(Expr { kind: ExprKind::Error, span, depth: 1, parens: false });
        match node.tag_name().name() {
            "ST" => {
                self.place(node, pou, true);
                Condition::St(self.expression_in(node, "the condition"))
            }
            "IL" => {
                self.place(node, pou, true);
                match self.text_body(node, true).0 {
                    Body::Il(il) => Condition::Il(il),
                    _ => error(),
                }
            }
            "FBD" | "LD" => {
                let notation = if node.tag_name().name() == "LD" { Notation::Ld } else { Notation::Fbd };
                let mut network = self.network(node, notation);
                self.name_condition(&mut network, name, span);
                Condition::Network(Box::new(network))
            }
            "SFC" => {
                self.unsupported(node, "a chart as the condition of a transition", "write it in ST, IL, LD or FBD");
                error()
            }
            _ => {
                self.unknown(node, "a condition");
                error()
            }
        }
    }

    /// Makes the element that takes the value of a transition its condition.
    fn name_condition(&mut self, network: &mut Network, name: &str, span: Span) {
        let takes = |e: &&mut Element| match &e.kind {
            ElementKind::Out { target: Expr { kind: ExprKind::Name(n), .. }, .. }
            | ElementKind::Coil { variable: Expr { kind: ExprKind::Name(n), .. }, .. } => {
                n.text.eq_ignore_ascii_case(name)
            }
            _ => false,
        };
        let Some(element) = network.elements.iter_mut().find(takes) else {
            let message = match name {
                "" => "nothing gives this condition its value".to_string(),
                name => format!("nothing gives the transition `{name}` its value"),
            };
            let help = match name {
                "" => "connect the network to the transition, or write the condition as a named transition".into(),
                name => format!("end the network in a variable or coil `{name}`"),
            };
            return self.say(Diagnostic::new(codes::NO_CONDITION, span, message).help(help));
        };
        if let ElementKind::Out { modifier, .. } | ElementKind::Coil { modifier, .. } = &element.kind {
            let (negated, edge) = (modifier.negated, modifier.edge);
            if let Some(pin) = element.inputs.first_mut() {
                pin.modifier.negated ^= negated;
                pin.modifier.edge = pin.modifier.edge.or(edge);
            }
        }
        element.kind = ElementKind::Condition;
    }

    /// A name for an action that has none.
    pub(super) fn inline_name(&mut self, step: &str, parts: &mut ChartParts) -> String {
        let mut number = 1;
        loop {
            let name = format!("{step}_inline{number}");
            let key = name.to_ascii_uppercase();
            if !parts.names.contains(&key) {
                parts.names.push(key);
                return name;
            }
            number += 1;
        }
    }

    /// A comment's text.
    pub(super) fn comment_text(&self, node: Node) -> String {
        let text = child(node, "content").map(|c| self.plain_text(c)).unwrap_or_default();
        let label = attribute(node, "content").unwrap_or_default();
        if text.trim().is_empty() { label.trim().to_string() } else { text.trim().to_string() }
    }
}
