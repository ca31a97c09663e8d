//! Bodies in Sequential Function Chart: the graph of steps, transitions, divergences and convergences becomes the chart that
//! the text notation gives, each transition with the steps that it leaves and those that it activates.

use super::Reader;
use super::nodes::{attribute, child, children, find, flag, named, point};
use super::pous::ChartParts;
use crate::ast::*;
use plcc_diag::{Diagnostic, Span, codes};
use roxmltree::Node;
use rustc_hash::{FxHashMap, FxHashSet};

/// What stands in a chart.
enum Kind {
    Step(Name),
    Jump(Name),
    Transition,
    SelectionDivergence,
    SelectionConvergence,
    SimultaneousDivergence,
    SimultaneousConvergence,
}

impl Kind {
    fn name(&self) -> &'static str {
        match self {
            Kind::Step(_) => "a step",
            Kind::Jump(_) => "a jump",
            Kind::Transition => "a transition",
            Kind::SelectionDivergence => "a selection divergence",
            Kind::SelectionConvergence => "a selection convergence",
            Kind::SimultaneousDivergence => "a simultaneous divergence",
            Kind::SimultaneousConvergence => "a simultaneous convergence",
        }
    }
}

struct Part<'a, 'i> {
    node: Node<'a, 'i>,
    kind: Kind,
    /// What leads here.
    from: Vec<Connection>,
    span: Span,
}

/// The parts of a chart by their local ids.
struct Graph<'a, 'i> {
    parts: Vec<(u64, Part<'a, 'i>)>,
    by_id: FxHashMap<u64, usize>,
    /// What each part leads to.
    to: Vec<Vec<usize>>,
    /// Elements of networks that feed conditions.
    networks: FxHashMap<u64, Element>,
    /// Connectors among them, by name in upper case.
    connectors: FxHashMap<String, Vec<u64>>,
    /// What the transitions may still take in steps and elements: each lists its own.
    left: usize,
}

/// Steps and elements that the transitions of one chart list together.
const MAX_LISTED: usize = 300_000;

impl Reader<'_, '_> {
    /// An `SFC`.
    pub(super) fn chart(&mut self, node: Node, parts: &mut ChartParts) -> SfcBody {
        let span = self.whole(node);
        let mut graph = self.graph(node);
        let actions = self.action_blocks(node, &graph, parts);
        let mut elements = Vec::new();
        for (id, part) in &graph.parts {
            let Kind::Step(name) = &part.kind else { continue };
            let initial = flag(part.node, "initialStep");
            let actions = actions.get(id).cloned().unwrap_or_default();
            let span = self.whole(part.node);
            elements.push(SfcElement::Step(Step { initial, name: name.clone(), actions, span }));
        }
        // From left to right decides between transitions without a priority [F4].
        let mut transitions: Vec<usize> =
            (0..graph.parts.len()).filter(|i| matches!(graph.parts[*i].1.kind, Kind::Transition)).collect();
        let place = |i: &usize| child(graph.parts[*i].1.node, "position").map(point).unwrap_or_default();
        transitions.sort_by(|a, b| {
            let (a, b) = (place(a), place(b));
            a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
        });
        for index in transitions {
            let transition = self.transition(index, &mut graph, parts);
            elements.push(SfcElement::Transition(transition));
        }
        SfcBody { elements, span }
    }

    fn graph<'a, 'i>(&mut self, body: Node<'a, 'i>) -> Graph<'a, 'i> {
        let mut graph = Graph {
            parts: Vec::new(),
            by_id: FxHashMap::default(),
            to: Vec::new(),
            networks: FxHashMap::default(),
            connectors: FxHashMap::default(),
            left: MAX_LISTED,
        };
        let mut spans: FxHashMap<u64, Span> = FxHashMap::default();
        for node in children(body) {
            let tag = node.tag_name().name();
            let kind = match tag {
                "step" => match self.name(node, "name") {
                    Some(name) => Kind::Step(name),
                    None => continue,
                },
                "jumpStep" => match self.name(node, "targetName") {
                    Some(name) => Kind::Jump(name),
                    None => continue,
                },
                "transition" => Kind::Transition,
                "selectionDivergence" => Kind::SelectionDivergence,
                "selectionConvergence" => Kind::SelectionConvergence,
                "simultaneousDivergence" => Kind::SimultaneousDivergence,
                "simultaneousConvergence" => Kind::SimultaneousConvergence,
                "actionBlock" => continue,
                "macroStep" => {
                    self.unsupported(node, "a macro step", "put its chart in its place");
                    continue;
                }
                _ => {
                    if let Some(element) = self.element(node) {
                        self.unique(element.id, element.span, &mut spans);
                        if let ElementKind::Connector(name) = &element.kind {
                            graph.connectors.entry(name.text.to_ascii_uppercase()).or_default().push(element.id);
                        }
                        graph.networks.insert(element.id, element);
                    }
                    continue;
                }
            };
            if self.required(node, "localId").is_none() {
                continue;
            }
            let Some(id) = self.number(node, "localId") else { continue };
            let span = self.tag(node);
            self.unique(id, span, &mut spans);
            let name = match &kind {
                Kind::Step(name) => format!("step `{}`", name.text),
                Kind::Jump(name) => format!("jump to `{}`", name.text),
                kind => kind.name().split_once(' ').map_or("", |(_, n)| n).to_string(),
            };
            let at = child(node, "position").map(point).unwrap_or_default();
            let place = format!("{}, {name}, local id {id} at ({}, {})", self.pou, at.x, at.y);
            self.place(node, place, false);
            let points = named(node, "connectionPointIn").flat_map(|p| named(p, "connection"));
            let from = points.filter_map(|c| self.connection(c)).collect();
            graph.by_id.entry(id).or_insert(graph.parts.len());
            graph.parts.push((id, Part { node, kind, from, span }));
        }
        graph.to = vec![Vec::new(); graph.parts.len()];
        for index in 0..graph.parts.len() {
            for connection in &graph.parts[index].1.from {
                match graph.by_id.get(&connection.from) {
                    Some(&source) => graph.to[source].push(index),
                    None => self.dangling(connection.from, connection.span),
                }
            }
        }
        graph
    }

    fn unique(&mut self, id: u64, span: Span, spans: &mut FxHashMap<u64, Span>) {
        if let Some(first) = spans.insert(id, span) {
            self.say(
                Diagnostic::new(codes::DUPLICATE_ID, span, format!("local id {id} stands twice in this body"))
                    .also(first, "first used here")
                    .help("connections name elements by it; give each element its own"),
            );
        }
    }

    fn dangling(&mut self, id: u64, span: Span) {
        self.say(
            Diagnostic::new(codes::DANGLING_CONNECTION, span, format!("there is no element with local id {id}"))
                .help("draw this connection again"),
        );
    }

    fn misplaced(&mut self, span: Span, message: String, help: &str) {
        self.say(Diagnostic::new(codes::CHART_GRAPH, span, message).help(help));
    }

    fn transition(&mut self, index: usize, graph: &mut Graph, parts: &mut ChartParts) -> Transition {
        let (from, to) = match graph.left {
            0 => (Vec::new(), Vec::new()),
            _ => (self.preceding(index, graph), self.succeeding(index, graph)),
        };
        if graph.left > 0 && from.len() + to.len() >= graph.left {
            self.too_large(graph.parts[index].1.span);
        }
        graph.left -= (from.len() + to.len()).min(graph.left);
        let (node, span) = (graph.parts[index].1.node, graph.parts[index].1.span);
        let priority = attribute(node, "priority").is_some_and(|p| !matches!(p.trim(), "" | "0"));
        let priority = if priority { self.expression_of(node, "priority", "the priority") } else { None };
        let error = Condition::St(Expr { kind: ExprKind::Error, span, depth: 1, parens: false });
        let Some(holder) = child(node, "condition") else {
            self.say(
                Diagnostic::new(codes::XML_MISSING, span, "this transition has no condition")
                    .help("give it one; TRUE if it always holds"),
            );
            return Transition { name: None, priority, from, to, condition: error, span };
        };
        let negated = flag(holder, "negated");
        let mut condition = error;
        // 1.01 has the connection here, 2.01 a connection point around it.
        let mut connections = Vec::new();
        for part in children(holder) {
            match part.tag_name().name() {
                "connectionPointIn" => {
                    connections.extend(named(part, "connection").filter_map(|c| self.connection(c)));
                }
                "connection" => connections.extend(self.connection(part)),
                "inline" => match children(part).next() {
                    Some(body) => {
                        condition = self.condition_body(body, attribute(part, "name").unwrap_or_default().trim());
                    }
                    None => {
                        let span = self.tag(part);
                        self.say(
                            Diagnostic::new(codes::MISSING_OPERAND, span, "the condition is empty")
                                .help("write an expression; TRUE if it always holds"),
                        );
                    }
                },
                "reference" => {
                    let Some(wanted) = self.name(part, "name") else { continue };
                    match parts.transitions.get(&wanted.text.to_ascii_uppercase()) {
                        // Several transitions may use it, so its name is not theirs.
                        Some(found) => condition = found.condition.clone(),
                        // A BOOL variable serves too.
                        None => {
                            let span = wanted.span;
                            let kind = ExprKind::Name(wanted);
                            condition = Condition::St(Expr { kind, span, depth: 1, parens: false });
                        }
                    }
                }
                _ => self.unknown(part, "a condition"),
            }
        }
        if !connections.is_empty() {
            condition = Condition::Network(Box::new(self.condition_network(span, connections, negated, graph)));
        } else if negated && let Condition::St(inner) = condition {
            let (span, depth) = (inner.span, inner.depth + 1);
            let kind = ExprKind::Unary(UnaryOp::Not, Box::new(inner));
            condition = Condition::St(Expr { kind, span, depth, parens: false });
        }
        Transition { name: None, priority, from, to, condition, span }
    }

    /// The elements that a condition depends on, with the condition itself.
    fn condition_network(
        &mut self,
        span: Span,
        connections: Vec<Connection>,
        negated: bool,
        graph: &mut Graph,
    ) -> Network {
        let mut wanted: Vec<u64> = connections.iter().map(|c| c.from).collect();
        let mut seen = FxHashSet::default();
        let mut elements = Vec::new();
        while let Some(id) = wanted.pop() {
            if !seen.insert(id) {
                continue;
            }
            // What is not there is reported with the other rules of networks.
            let Some(element) = graph.networks.get(&id) else { continue };
            wanted.extend(element.inputs.iter().flat_map(|p| &p.connections).map(|c| c.from));
            if let ElementKind::Continuation(name) = &element.kind {
                wanted.extend(graph.connectors.get(&name.text.to_ascii_uppercase()).into_iter().flatten());
            }
            elements.push(element.clone());
            if elements.len() > graph.left {
                self.too_large(span);
                break;
            }
        }
        graph.left -= elements.len().min(graph.left);
        elements.sort_by_key(|e| e.span.start);
        let pin = Pin {
            name: Default::default(),
            at: Point::default(),
            modifier: Modifier { negated, ..Modifier::default() },
            in_out: false,
            connections,
            operand: None,
            span,
        };
        let id = elements.iter().map(|e| e.id).max().unwrap_or(0).saturating_add(1);
        elements.push(Element {
            id,
            kind: ElementKind::Condition,
            position: Point::default(),
            size: Point::default(),
            order: None,
            inputs: vec![pin],
            outputs: Vec::new(),
            span,
        });
        Network { notation: Notation::Ld, elements, span }
    }

    fn too_large(&mut self, span: Span) {
        let message = format!("the transitions of this chart list more than {MAX_LISTED} steps and elements");
        self.misplaced(span, message, "divide the chart");
    }

    /// The steps before a transition.
    fn preceding(&mut self, transition: usize, graph: &Graph) -> Vec<Name> {
        let mut steps = Vec::new();
        let mut seen = FxHashSet::default();
        let mut open = vec![transition];
        while let Some(index) = open.pop() {
            for connection in graph.parts[index].1.from.iter().rev() {
                let Some(&source) = graph.by_id.get(&connection.from) else { continue };
                if !seen.insert(source) {
                    continue;
                }
                match &graph.parts[source].1.kind {
                    Kind::Step(name) => steps.push((source, name.clone())),
                    Kind::SelectionDivergence | Kind::SimultaneousConvergence => open.push(source),
                    other => {
                        let message = format!("{} cannot lead to a transition", other.name());
                        self.misplaced(connection.span, message, "a step stands before each transition");
                    }
                }
            }
        }
        if steps.len() > 1 && graph.parts[transition].1.from.len() > 1 {
            let message = "several steps lead to this transition without a simultaneous convergence".to_string();
            let help = "draw a simultaneous convergence, if all of them must be active";
            self.misplaced(graph.parts[transition].1.span, message, help);
        }
        steps.sort_by_key(|(index, _)| *index);
        steps.into_iter().map(|(_, name)| name).collect()
    }

    /// The steps behind a transition.
    fn succeeding(&mut self, transition: usize, graph: &Graph) -> Vec<Name> {
        let mut steps = Vec::new();
        let mut seen = FxHashSet::default();
        let mut open = vec![transition];
        while let Some(index) = open.pop() {
            let simultaneous = matches!(graph.parts[index].1.kind, Kind::SimultaneousDivergence);
            if graph.to[index].len() > 1 && !simultaneous {
                let message = format!("{} leads to several places", graph.parts[index].1.kind.name());
                let help = "draw a simultaneous divergence behind the transition, if all of them are meant";
                self.misplaced(graph.parts[index].1.span, message, help);
            }
            for &next in graph.to[index].iter().rev() {
                if !seen.insert(next) {
                    continue;
                }
                match &graph.parts[next].1.kind {
                    Kind::Step(name) | Kind::Jump(name) => steps.push((next, name.clone())),
                    Kind::SelectionConvergence | Kind::SimultaneousDivergence => open.push(next),
                    other => {
                        let message = format!("a transition cannot lead to {}", other.name());
                        self.misplaced(graph.parts[next].1.span, message, "a step or a jump stands behind each");
                    }
                }
            }
        }
        steps.sort_by_key(|(index, _)| *index);
        steps.into_iter().map(|(_, name)| name).collect()
    }

    /// The associations of the action blocks, by the local id of their step.
    fn action_blocks(
        &mut self,
        body: Node,
        graph: &Graph,
        parts: &mut ChartParts,
    ) -> FxHashMap<u64, Vec<ActionAssociation>> {
        let mut found: FxHashMap<u64, Vec<ActionAssociation>> = FxHashMap::default();
        // Inline actions run in the order of their steps [F2].
        let mut blocks: Vec<(usize, u64, Node)> = Vec::new();
        for node in named(body, "actionBlock") {
            let points = named(node, "connectionPointIn").flat_map(|p| named(p, "connection"));
            let connections: Vec<Connection> = points.filter_map(|c| self.connection(c)).collect();
            let span = self.tag(node);
            if connections.is_empty() {
                self.misplaced(span, "this action block belongs to no step".into(), "connect it to a step");
            }
            for connection in connections {
                match graph.by_id.get(&connection.from) {
                    Some(&index) if matches!(graph.parts[index].1.kind, Kind::Step(_)) => {
                        blocks.push((index, connection.from, node));
                    }
                    Some(&index) => {
                        let message = format!("{} has no actions", graph.parts[index].1.kind.name());
                        self.misplaced(connection.span, message, "connect the action block to a step");
                    }
                    None => self.dangling(connection.from, connection.span),
                }
            }
        }
        blocks.sort_by_key(|(index, _, _)| *index);
        for (index, id, node) in blocks {
            let Kind::Step(step) = &graph.parts[index].1.kind else { continue };
            for action in named(node, "action") {
                let association = self.association(action, &step.text, parts);
                found.entry(id).or_default().extend(association);
            }
        }
        found
    }

    fn association(&mut self, node: Node, step: &str, parts: &mut ChartParts) -> Option<ActionAssociation> {
        let span = self.tag(node);
        let qualifier = find(node, "qualifier").filter(|q| !q.value().trim().is_empty());
        let qualifier = qualifier.map(|q| Name { text: q.value().trim().into(), span: self.value_span(q) });
        let timed = attribute(node, "duration").is_some_and(|d| !d.trim().is_empty());
        let time = if timed { self.expression_of(node, "duration", "the duration") } else { None };
        let indicator = attribute(node, "indicator").is_some_and(|i| !i.trim().is_empty());
        let indicator = if indicator { self.expression_of(node, "indicator", "the indicator") } else { None };
        let action = if let Some(reference) = child(node, "reference") {
            self.required(reference, "name")?;
            self.expression_of(reference, "name", "the action")?
        } else if let Some(inline) = child(node, "inline") {
            let name = self.inline_name(step, parts);
            let tag = self.tag(inline);
            let place = format!("{}, action of step {step}", self.pou);
            self.place(inline, place, false);
            let body = self.inline_body(inline, parts);
            let name = Name { text: name.into(), span: tag };
            let whole = self.whole(inline);
            parts.inline.push(Action { owner: None, name: name.clone(), body, span: whole });
            Expr { kind: ExprKind::Name(name), span: tag, depth: 1, parens: false }
        } else {
            self.say(
                Diagnostic::new(codes::XML_MISSING, span, "this action says nothing")
                    .help("name an action or a BOOL variable, or write what it does"),
            );
            return None;
        };
        Some(ActionAssociation { action, qualifier, time, indicators: indicator.into_iter().collect(), span })
    }
}
