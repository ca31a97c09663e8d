//! Bodies in Ladder Diagram and Function Block Diagram: elements, pins and connections as they are drawn.

use super::Reader;
use super::nodes::{attribute, child, children, find, flag, named, point};
use crate::ast::*;
use plcc_diag::{Diagnostic, Span, codes};
use roxmltree::Node;

impl Reader<'_, '_> {
    /// An `LD` or `FBD`.
    pub(super) fn network(&mut self, node: Node, notation: Notation) -> Network {
        let elements = children(node).filter_map(|n| self.element(n)).collect();
        Network { notation, elements, span: self.whole(node) }
    }

    /// Something drawn; `None` for what means nothing or could not be read.
    pub(super) fn element(&mut self, node: Node) -> Option<Element> {
        let tag = node.tag_name().name();
        if matches!(tag, "vendorElement" | "error") {
            return None;
        }
        let kind = self.element_kind(node, tag)?;
        self.required(node, "localId")?;
        let id = self.number(node, "localId")?;
        let order = self.number(node, "executionOrderId").filter(|n| *n > 0);
        let size = |name| attribute(node, name).and_then(|v| v.trim().parse::<f64>().ok()).unwrap_or(0.0);
        let element = Element {
            id,
            position: child(node, "position").map(point).unwrap_or_default(),
            size: Point { x: size("width"), y: size("height") },
            order,
            inputs: self.inputs(node, &kind),
            outputs: self.outputs(node, &kind),
            span: self.tag(node),
            kind,
        };
        let name = format!("{}, {}", self.pou, element.describe());
        self.place(node, name, false);
        Some(element)
    }

    fn element_kind(&mut self, node: Node, tag: &str) -> Option<ElementKind> {
        Some(match tag {
            "leftPowerRail" => ElementKind::LeftRail,
            "rightPowerRail" => ElementKind::RightRail,
            "contact" => {
                ElementKind::Contact { variable: self.variable_in(node, "variable")?, modifier: self.modifier(node) }
            }
            "coil" => {
                ElementKind::Coil { variable: self.variable_in(node, "variable")?, modifier: self.modifier(node) }
            }
            "block" => {
                let ty = self.function_name(node, "typeName")?;
                let named = attribute(node, "instanceName").is_some_and(|n| !n.trim().is_empty());
                let instance = if named { self.expression_of(node, "instanceName", "the instance") } else { None };
                ElementKind::Block { ty, instance }
            }
            "inVariable" => {
                ElementKind::In { value: self.variable_in(node, "expression")?, modifier: self.modifier(node) }
            }
            "outVariable" => {
                ElementKind::Out { target: self.variable_in(node, "expression")?, modifier: self.modifier(node) }
            }
            "inOutVariable" => ElementKind::InOut {
                variable: self.variable_in(node, "expression")?,
                negated_in: flag(node, "negatedIn"),
                negated_out: flag(node, "negatedOut"),
            },
            "connector" => ElementKind::Connector(self.link(node, "name")?),
            "continuation" => ElementKind::Continuation(self.link(node, "name")?),
            "label" => ElementKind::Label(self.name(node, "label")?),
            "jump" => ElementKind::Jump(self.name(node, "label")?),
            "return" => ElementKind::Return,
            "comment" => ElementKind::Comment(self.comment_text(node)),
            "actionBlock"
            | "macroStep"
            | "step"
            | "transition"
            | "jumpStep"
            | "selectionDivergence"
            | "selectionConvergence"
            | "simultaneousDivergence"
            | "simultaneousConvergence" => {
                self.unsupported(node, "an element of a chart in LD or FBD", "draw it in a body of its own, in SFC");
                return None;
            }
            _ => {
                self.unknown(node, "a drawing");
                return None;
            }
        })
    }

    /// The name that ties a connector to its continuations: any text.
    fn link(&mut self, node: Node, attribute: &str) -> Option<Name> {
        let found = self.required(node, attribute)?;
        Some(Name { text: found.value().trim().into(), span: self.value_span(found) })
    }

    /// The variable or expression of an element.
    fn variable_in(&mut self, node: Node, tag: &'static str) -> Option<Expr> {
        let Some(holder) = child(node, tag) else {
            let span = self.tag(node);
            let message = format!("<{}> has no <{tag}>", node.tag_name().name());
            self.say(Diagnostic::new(codes::XML_MISSING, span, message).help("name a variable"));
            return None;
        };
        Some(self.expression_in(holder, "this element"))
    }

    /// `negated`, `edge`, `storage`.
    fn modifier(&mut self, node: Node) -> Modifier {
        let edge = match attribute(node, "edge") {
            Some("rising") => Some(Edge::Rising),
            Some("falling") => Some(Edge::Falling),
            _ => None,
        };
        let storage = match attribute(node, "storage") {
            Some("set") => Some(Storage::Set),
            Some("reset") => Some(Storage::Reset),
            _ => None,
        };
        for (name, values) in [("edge", "`none`, `rising` or `falling`"), ("storage", "`none`, `set` or `reset`")] {
            let Some(found) = find(node, name) else { continue };
            let known = matches!(found.value().trim(), "" | "none" | "rising" | "falling" | "set" | "reset");
            if !known {
                let span = self.value_span(found);
                let message = format!("`{name}` is `{}`", found.value());
                self.say(Diagnostic::new(codes::XML_VALUE, span, message).help(format!("it is {values}")));
            }
        }
        Modifier { negated: flag(node, "negated"), edge, storage }
    }

    fn inputs(&mut self, node: Node, kind: &ElementKind) -> Vec<Pin> {
        if !matches!(kind, ElementKind::Block { .. }) {
            return named(node, "connectionPointIn").map(|p| self.pin_in(p, None)).collect();
        }
        let mut pins = Vec::new();
        for (list, in_out) in [("inputVariables", false), ("inOutVariables", true)] {
            for variable in named(node, list).flat_map(|l| named(l, "variable")) {
                let point = child(variable, "connectionPointIn");
                let mut pin = match point {
                    Some(point) => self.pin_in(point, Some(variable)),
                    None => self.pin(variable, Some(variable)),
                };
                pin.in_out = in_out;
                pins.push(pin);
            }
        }
        pins
    }

    fn outputs(&mut self, node: Node, kind: &ElementKind) -> Vec<Pin> {
        if !matches!(kind, ElementKind::Block { .. }) {
            return named(node, "connectionPointOut").map(|p| self.pin(p, Some(p))).collect();
        }
        let mut pins = Vec::new();
        for (list, in_out) in [("inOutVariables", true), ("outputVariables", false)] {
            for variable in named(node, list).flat_map(|l| named(l, "variable")) {
                let Some(point_out) = child(variable, "connectionPointOut") else { continue };
                let mut pin = self.pin(variable, Some(variable));
                pin.at = child(point_out, "relPosition").map(point).unwrap_or_default();
                pin.in_out = in_out;
                pin.operand = self.operand(point_out);
                pins.push(pin);
            }
        }
        pins
    }

    /// A pin without its connections; `owner` carries name and modifiers.
    fn pin(&mut self, node: Node, owner: Option<Node>) -> Pin {
        let owner = owner.unwrap_or(node);
        Pin {
            name: attribute(owner, "formalParameter").unwrap_or_default().trim().into(),
            at: child(node, "relPosition").map(point).unwrap_or_default(),
            modifier: self.modifier(owner),
            in_out: false,
            connections: Vec::new(),
            operand: None,
            span: self.tag(owner),
        }
    }

    /// A pin where connections end.
    pub(super) fn pin_in(&mut self, point_in: Node, owner: Option<Node>) -> Pin {
        let mut pin = self.pin(point_in, owner);
        pin.connections = named(point_in, "connection").filter_map(|c| self.connection(c)).collect();
        pin.operand = self.operand(point_in);
        pin
    }

    /// An expression at a pin, instead of a connection.
    fn operand(&mut self, point: Node) -> Option<Expr> {
        let holder = child(point, "expression").filter(|e| !self.plain_text(*e).trim().is_empty())?;
        Some(self.expression_in(holder, "this pin"))
    }

    pub(super) fn connection(&mut self, node: Node) -> Option<Connection> {
        self.required(node, "refLocalId")?;
        let from = self.number(node, "refLocalId")?;
        let pin = attribute(node, "formalParameter").map(str::trim).filter(|p| !p.is_empty());
        let span: Span = self.tag(node);
        Some(Connection { from, pin: pin.map(Into::into), path: named(node, "position").map(point).collect(), span })
    }
}
