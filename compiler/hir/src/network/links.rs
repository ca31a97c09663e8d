//! Which output each connection begins at.

use super::Owner;
use plcc_diag::{Diagnostic, Diagnostics, Span, codes};
use plcc_syntax::ast::*;
use rustc_hash::{FxHashMap, FxHashSet};

/// An output that a value comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Source {
    /// Index of the element.
    pub element: usize,
    /// Index of the output of a block; 0 for what has one.
    pub pin: usize,
}

/// A network with its connections resolved.
pub(super) struct Links {
    /// For each element and each of its inputs: where its values come from, and where the connection is written.
    pub inputs: Vec<Vec<Vec<(Source, Span)>>>,
}

/// Resolves the connections of a network; what is wrong is reported and left out.
pub(super) fn resolve(network: &Network, owner: &Owner, diags: &mut Diagnostics) -> Links {
    let mut by_id: FxHashMap<u64, usize> = FxHashMap::default();
    let mut connectors: FxHashMap<String, usize> = FxHashMap::default();
    for (index, element) in network.elements.iter().enumerate() {
        if let Some(&first) = by_id.get(&element.id) {
            diags.push(
                Diagnostic::new(
                    codes::DUPLICATE_ID,
                    element.span,
                    format!("local id {} stands twice in this body", element.id),
                )
                .also(network.elements[first].span, "first used here")
                .help("connections name elements by it; give each element its own"),
            );
            continue;
        }
        by_id.insert(element.id, index);
        if let ElementKind::Connector(name) = &element.kind
            && let Some(first) = connectors.insert(name.text.to_ascii_uppercase(), index)
        {
            diags.push(
                Diagnostic::new(
                    codes::UNKNOWN_CONNECTOR,
                    element.span,
                    format!("there are two connectors `{}`", name.text),
                )
                .also(network.elements[first].span, "the first one is here")
                .help("a continuation belongs to one connector; rename one"),
            );
        }
    }
    let mut resolver = Resolver { network, owner, by_id, connectors, diags };
    let inputs = network.elements.iter().map(|element| {
        let pins = element.inputs.iter();
        pins.map(|pin| pin.connections.iter().flat_map(|c| resolver.sources(c)).collect()).collect()
    });
    Links { inputs: inputs.collect() }
}

struct Resolver<'n, 'o, 'u, 'd> {
    network: &'n Network,
    owner: &'o Owner<'u>,
    by_id: FxHashMap<u64, usize>,
    connectors: FxHashMap<String, usize>,
    diags: &'d mut Diagnostics,
}

impl Resolver<'_, '_, '_, '_> {
    /// The outputs that a connection brings values from: several only by way of a connector in LD.
    fn sources(&mut self, connection: &Connection) -> Vec<(Source, Span)> {
        let mut found = Vec::new();
        let mut seen = FxHashSet::default();
        let mut open = vec![connection];
        let span = connection.span;
        while let Some(connection) = open.pop() {
            let Some(&index) = self.by_id.get(&connection.from) else {
                self.say(
                    codes::DANGLING_CONNECTION,
                    connection.span,
                    format!("there is no element with local id {}", connection.from),
                    "draw this connection again",
                );
                continue;
            };
            let element = &self.network.elements[index];
            match &element.kind {
                ElementKind::Block { .. } => {
                    let pin = self.output(element, connection);
                    found.extend(pin.map(|pin| (Source { element: index, pin }, span)));
                }
                ElementKind::LeftRail
                | ElementKind::Contact { .. }
                | ElementKind::Coil { .. }
                | ElementKind::In { .. }
                | ElementKind::InOut { .. } => found.push((Source { element: index, pin: 0 }, span)),
                ElementKind::Continuation(name) => {
                    let key = name.text.to_ascii_uppercase();
                    let Some(&connector) = self.connectors.get(&key) else {
                        self.say(
                            codes::UNKNOWN_CONNECTOR,
                            element.span,
                            format!("there is no connector `{}`", name.text),
                            "a continuation goes on where a connector of the same name ended",
                        );
                        continue;
                    };
                    if !seen.insert(connector) {
                        self.say(
                            codes::ENDLESS_LOOP,
                            element.span,
                            format!("the connector `{}` leads to itself", name.text),
                            "connect it to a variable or a block",
                        );
                        continue;
                    }
                    let before = open.len();
                    open.extend(self.network.elements[connector].inputs.iter().flat_map(|p| &p.connections));
                    if open.len() == before {
                        let span = self.network.elements[connector].span;
                        let message = format!("the connector `{}` is not connected", name.text);
                        self.say(codes::UNCONNECTED_PIN, span, message, "connect it");
                    }
                }
                ElementKind::RightRail
                | ElementKind::Out { .. }
                | ElementKind::Connector(_)
                | ElementKind::Label(_)
                | ElementKind::Jump(_)
                | ElementKind::Return
                | ElementKind::Condition
                | ElementKind::Comment(_) => {
                    let message = format!("this connection begins at {}, which has no output", element.describe());
                    self.say(codes::DANGLING_CONNECTION, connection.span, message, "draw this connection again");
                }
            }
        }
        found
    }

    /// The output of a block where a connection begins.
    fn output(&mut self, element: &Element, connection: &Connection) -> Option<usize> {
        let outputs = &element.outputs;
        let named = |name: &str| outputs.iter().position(|p| p.name.eq_ignore_ascii_case(name));
        let found = match &connection.pin {
            Some(name) => named(name).or_else(|| self.result_pin(element, name)),
            None if outputs.len() == 1 => Some(0),
            None => named("").or_else(|| at_its_place(element, connection)),
        };
        if found.is_none() {
            let message = match &connection.pin {
                Some(name) => format!("{} has no output `{name}`", element.describe()),
                None => format!("this connection does not say at which output of {} it begins", element.describe()),
            };
            let names: Vec<String> = outputs.iter().map(|p| format!("`{}`", p.name)).collect();
            let help = match names.is_empty() {
                true => "it has none".to_string(),
                false => format!("its outputs are {}", names.join(", ")),
            };
            self.say(codes::UNKNOWN_PIN, connection.span, message, &help);
        }
        found
    }

    /// The result of a function may be called OUT, like the function, or nothing.
    fn result_pin(&self, element: &Element, name: &str) -> Option<usize> {
        let ElementKind::Block { ty, instance: None } = &element.kind else { return None };
        let means_result = name.eq_ignore_ascii_case("OUT") || name.eq_ignore_ascii_case(&ty.text);
        means_result.then(|| result_pin(element, self.owner)).flatten()
    }

    fn say(&mut self, code: plcc_diag::Code, span: Span, message: String, help: &str) {
        self.diags.push(Diagnostic::new(code, span, message).help(help));
    }
}

/// Which output of a block of a function is the result.
pub(super) fn result_pin(element: &Element, owner: &Owner) -> Option<usize> {
    let ElementKind::Block { ty, instance: None } = &element.kind else { return None };
    let function = owner.user.functions.get(&ty.text.to_ascii_uppercase());
    let declared = |name: &str| function.is_some_and(|f| f.outputs.iter().any(|(n, _)| n.eq_ignore_ascii_case(name)));
    element.outputs.iter().position(|pin| {
        let plain =
            pin.name.is_empty() || pin.name.eq_ignore_ascii_case("OUT") || pin.name.eq_ignore_ascii_case(&ty.text);
        plain && !pin.in_out && !declared(&pin.name)
    })
}

/// The output that lies where the line begins.
fn at_its_place(element: &Element, connection: &Connection) -> Option<usize> {
    let begin = connection.path.last()?;
    let near = |a: f64, b: f64| (a - b).abs() < 0.5;
    element
        .outputs
        .iter()
        .position(|pin| near(element.position.x + pin.at.x, begin.x) && near(element.position.y + pin.at.y, begin.y))
}
