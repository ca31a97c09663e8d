//! Elements and attributes: what is looked at, what is skipped.

use super::Reader;
use crate::ast::{Name, Point};
use crate::token::{Tok, word_kind};
use plcc_diag::{Diagnostic, Span, codes};
use roxmltree::{Attribute, Node};

/// Child elements of the name space of their parent, without those that carry no meaning: `addData`, documentation.
pub(super) fn children<'a, 'i>(node: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    let space = node.tag_name().namespace();
    node.children().filter(move |c| {
        let name = c.tag_name();
        let skipped = matches!(name.name(), "addData" | "documentation" | "globalId" | "addDataInfo");
        c.is_element() && name.namespace() == space && !skipped
    })
}

/// Child elements with a name.
pub(super) fn named<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    children(node).filter(move |c| c.tag_name().name() == name)
}

/// The first child element with a name.
pub(super) fn child<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> Option<Node<'a, 'i>> {
    named(node, name).next()
}

/// The text of an attribute; names are compared without name space.
pub(super) fn attribute<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    find(node, name).map(|a| a.value())
}

/// An attribute.
pub(super) fn find<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Attribute<'a, 'i>> {
    node.attributes().find(|a| a.name() == name && a.namespace().is_none())
}

/// Whether a flag is set: `true` or `1`.
pub(super) fn flag(node: Node, name: &str) -> bool {
    attribute(node, name).is_some_and(|v| matches!(v.trim(), "true" | "1"))
}

/// `x` and `y`; 0 where they say nothing.
pub(super) fn point(node: Node) -> Point {
    let number = |name| attribute(node, name).and_then(|v| v.trim().parse::<f64>().ok());
    let finite = |n: Option<f64>| n.filter(|n| n.is_finite()).unwrap_or(0.0);
    Point { x: finite(number("x")), y: finite(number("y")) }
}

impl Reader<'_, '_> {
    /// The place of an attribute's value.
    pub(super) fn value_span(&self, attribute: Attribute) -> Span {
        let range = attribute.range_value();
        Span::new(self.file, range.start as u32, range.end as u32)
    }

    /// An attribute that an element must have; reported if it is missing.
    pub(super) fn required<'a, 'i>(&mut self, node: Node<'a, 'i>, name: &str) -> Option<Attribute<'a, 'i>> {
        let found = find(node, name);
        if found.is_none() {
            let message = format!("<{}> has no attribute `{name}`", node.tag_name().name());
            let span = self.tag(node);
            self.say(Diagnostic::new(codes::XML_MISSING, span, message).help("export the file again, or add it"));
        }
        found
    }

    /// The attribute of an element that names something.
    pub(super) fn name(&mut self, node: Node, attribute: &str) -> Option<Name> {
        let found = self.required(node, attribute)?;
        let span = self.value_span(found);
        self.checked_name(found.value(), span)
    }

    /// A name of IEC 61131-3; reported if it is none.
    pub(super) fn checked_name(&mut self, text: &str, span: Span) -> Option<Name> {
        let name = self.word(text, span)?;
        if word_kind(&name.text) != Tok::Id {
            self.say(
                Diagnostic::new(codes::RESERVED_WORD, span, format!("`{}` is a reserved word", name.text))
                    .help("choose another name"),
            );
            return None;
        }
        Some(name)
    }

    /// As [`Self::name`], where operators are names too: the type of a block.
    pub(super) fn function_name(&mut self, node: Node, attribute: &str) -> Option<Name> {
        let found = self.required(node, attribute)?;
        let span = self.value_span(found);
        self.word(found.value(), span)
    }

    fn word(&mut self, text: &str, span: Span) -> Option<Name> {
        let trimmed = text.trim();
        let mut bytes = trimmed.bytes();
        let well_formed = bytes.next().is_some_and(|b| b.is_ascii_alphabetic() || b == b'_')
            && bytes.all(|b| b.is_ascii_alphanumeric() || b == b'_');
        if !well_formed {
            self.say(
                Diagnostic::new(codes::XML_VALUE, span, format!("`{text}` is not a name of IEC 61131-3"))
                    .help("names consist of the letters A to Z, digits and underlines, and begin with no digit"),
            );
            return None;
        }
        let start = span.start + (text.len() - text.trim_start().len()) as u32;
        let span = match self.text.get(start as usize..start as usize + trimmed.len()) {
            Some(written) if written == trimmed => Span::new(self.file, start, start + trimmed.len() as u32),
            _ => span,
        };
        Some(Name { text: trimmed.into(), span })
    }

    /// An unsigned number in an attribute; reported if it is none.
    pub(super) fn number(&mut self, node: Node, attribute: &str) -> Option<u64> {
        let found = find(node, attribute)?;
        let number = found.value().trim().parse::<u64>();
        if number.is_err() {
            let span = self.value_span(found);
            let message = format!("`{attribute}` is `{}`, not a number", found.value());
            self.say(Diagnostic::new(codes::XML_VALUE, span, message).help("write digits only"));
        }
        number.ok()
    }
}
