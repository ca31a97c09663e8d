//! Data types and initial values.

use super::Reader;
use super::nodes::{attribute, child, children, find, flag, named};
use crate::ast::*;
use plcc_diag::{Diagnostic, codes};
use roxmltree::Node;

impl Reader<'_, '_> {
    /// `dataType`: one TYPE declaration.
    pub(super) fn data_type(&mut self, node: Node) {
        let Some(name) = self.name(node, "name") else { return };
        let ty = match child(node, "baseType") {
            Some(base) => self.ty(base),
            None => self.missing(node, "baseType"),
        };
        let init = child(node, "initialValue").and_then(|i| self.initial_value(i, &ty));
        let span = self.whole(node);
        self.out.items.push(Item::Types(vec![TypeDecl { name, ty, init, span }]));
    }

    fn missing(&mut self, node: Node, what: &str) -> TypeExpr {
        let span = self.tag(node);
        let message = format!("<{}> has no <{what}>", node.tag_name().name());
        self.say(Diagnostic::new(codes::XML_MISSING, span, message).help("export the file again, or add it"));
        TypeExpr { kind: TypeExprKind::Error, span, depth: 1 }
    }

    /// What stands in `type`, `baseType`, `returnType`.
    pub(super) fn ty(&mut self, holder: Node) -> TypeExpr {
        match children(holder).next() {
            Some(node) => self.type_node(node),
            None => self.missing(holder, "type"),
        }
    }

    fn type_node(&mut self, node: Node) -> TypeExpr {
        let span = self.tag(node);
        let error = TypeExpr { kind: TypeExprKind::Error, span, depth: 1 };
        let tag = node.tag_name().name();
        let mut depth = 0;
        let kind = match tag {
            "string" | "wstring" | "STRING" | "WSTRING" => {
                let length = self.expression_of(node, "length", "the length").map(Box::new);
                TypeExprKind::String { wide: tag.eq_ignore_ascii_case("wstring"), length }
            }
            "derived" => return self.type_of(node, "name").unwrap_or(error),
            "array" => {
                let dims = named(node, "dimension").filter_map(|d| self.dimension(d)).collect();
                let Some(base) = child(node, "baseType") else { return self.missing(node, "baseType") };
                let elem = self.ty(base);
                depth = elem.depth;
                TypeExprKind::Array { dims, elem: Box::new(elem) }
            }
            "struct" | "union" => {
                let fields: Vec<VarDecl> = named(node, "variable").filter_map(|v| self.variable(v)).collect();
                depth = fields.iter().map(|f| f.ty.depth).max().unwrap_or(0);
                match tag {
                    "struct" => TypeExprKind::Struct(fields),
                    _ => TypeExprKind::Union(fields),
                }
            }
            "enum" => {
                let values = named(node, "values").flat_map(|v| named(v, "value"));
                let values = values.filter_map(|v| {
                    let name = self.name(v, "name")?;
                    let value = match attribute(v, "value").is_some_and(|t| !t.trim().is_empty()) {
                        true => self.expression_of(v, "value", "the value"),
                        false => None,
                    };
                    Some(EnumValue { name, value })
                });
                let values = values.collect();
                let base = child(node, "baseType").map(|b| self.ty(b)).and_then(|t| match t.kind {
                    TypeExprKind::Named(name) => Some(name),
                    _ => None,
                });
                TypeExprKind::Enum { base, values }
            }
            "subrangeSigned" | "subrangeUnsigned" => {
                let range = child(node, "range").and_then(|r| self.bounds(r));
                let base = child(node, "baseType").map(|b| self.ty(b).kind);
                match (range, base) {
                    (Some((low, high)), Some(TypeExprKind::Named(base))) => {
                        TypeExprKind::Subrange { base, low: Box::new(low), high: Box::new(high) }
                    }
                    (Some(_), _) => return self.missing(node, "baseType"),
                    (None, _) => return self.missing(node, "range"),
                }
            }
            "pointer" => {
                let Some(base) = child(node, "baseType") else { return self.missing(node, "baseType") };
                let target = self.ty(base);
                depth = target.depth;
                TypeExprKind::Ref { kind: RefKind::PointerTo, target: Box::new(target) }
            }
            name if name.bytes().all(|b| b.is_ascii_uppercase() || b == b'_') => {
                TypeExprKind::Named(Name { text: name.into(), span })
            }
            _ => {
                self.unknown(node, "a type");
                return error;
            }
        };
        TypeExpr { kind, span, depth: depth + 1 }
    }

    fn dimension(&mut self, node: Node) -> Option<Dim> {
        self.bounds(node).map(|(low, high)| Dim::Range(low, high))
    }

    /// `lower` and `upper`.
    fn bounds(&mut self, node: Node) -> Option<(Expr, Expr)> {
        self.required(node, "lower")?;
        self.required(node, "upper")?;
        let low = self.expression_of(node, "lower", "the lower bound")?;
        let high = self.expression_of(node, "upper", "the upper bound")?;
        Some((low, high))
    }

    /// `variable` of an interface or a structure.
    pub(super) fn variable(&mut self, node: Node) -> Option<VarDecl> {
        let name = self.name(node, "name")?;
        let ty = match child(node, "type") {
            Some(ty) => self.ty(ty),
            None => self.missing(node, "type"),
        };
        let at = find(node, "address").filter(|a| !a.value().trim().is_empty());
        let at = at.map(|a| (a.value().trim().into(), self.value_span(a)));
        let init = child(node, "initialValue").and_then(|i| self.initial_value(i, &ty));
        let edge = match attribute(node, "edge") {
            Some("rising") => Some((Edge::Rising, self.tag(node))),
            Some("falling") => Some((Edge::Falling, self.tag(node))),
            _ => None,
        };
        let span = self.whole(node);
        Some(VarDecl { names: vec![name], path: Vec::new(), at, ty, edge, read_write: None, init, span })
    }

    /// `initialValue`.
    pub(super) fn initial_value(&mut self, holder: Node, ty: &TypeExpr) -> Option<Init> {
        let node = children(holder).next()?;
        self.value(node, Some(ty))
    }

    /// One of the forms of a value; `ty` is the type of its place where that is known.
    fn value(&mut self, node: Node, ty: Option<&TypeExpr>) -> Option<Init> {
        let span = self.tag(node);
        match node.tag_name().name() {
            "simpleValue" => {
                let text = attribute(node, "value").unwrap_or_default().trim();
                match ty.map(|t| &t.kind) {
                    // Editors leave out the quotes of strings.
                    Some(TypeExprKind::String { wide, .. }) if !text.starts_with(['\'', '"']) => {
                        Some(self.quoted(node, text, *wide))
                    }
                    _ if text.is_empty() => None,
                    _ => self.init_of(node, "value"),
                }
            }
            "arrayValue" => {
                let elem = match ty.map(|t| &t.kind) {
                    Some(TypeExprKind::Array { elem, .. }) => Some(&**elem),
                    _ => None,
                };
                let mut elems = Vec::new();
                for value in named(node, "value") {
                    let inner = children(value).next().and_then(|v| self.value(v, elem));
                    let repeated = attribute(value, "repetitionValue").is_some_and(|v| !v.trim().is_empty());
                    match (repeated, inner) {
                        (true, inner) => {
                            let count = self.expression_of(value, "repetitionValue", "the repetition")?;
                            elems.push(InitElem::Repeat(count, inner.into_iter().collect()));
                        }
                        (false, Some(inner)) => elems.push(InitElem::One(inner)),
                        (false, None) => {}
                    }
                }
                Some(Init { kind: InitKind::Array { bracketed: true, elems }, span })
            }
            "structValue" => {
                let mut fields = Vec::new();
                for value in named(node, "value") {
                    let Some(member) = self.name(value, "member") else { continue };
                    let inner = children(value).next().and_then(|v| self.value(v, None));
                    fields.extend(inner.map(|i| (member, i)));
                }
                Some(Init { kind: InitKind::Struct(fields), span })
            }
            _ => {
                self.unknown(node, "a value");
                None
            }
        }
    }

    /// A string that was written without quotes.
    fn quoted(&mut self, node: Node, text: &str, wide: bool) -> Init {
        let span = find(node, "value").map_or(self.tag(node), |a| self.value_span(a));
        let quote = if wide { '"' } else { '\'' };
        let mut written = String::from(quote);
        for c in text.chars() {
            match c {
                '$' => written.push_str("$$"),
                c if c == quote => written.extend(['$', c]),
                c => written.push(c),
            }
        }
        written.push(quote);
        let kind = if wide { LiteralKind::WString } else { LiteralKind::String };
        let literal = Literal { kind, prefix: None, text: written.into() };
        let expr = Expr { kind: ExprKind::Literal(literal), span, depth: 1, parens: false };
        Init { kind: InitKind::Expr(expr), span }
    }

    /// The qualifiers of a list of variables.
    pub(super) fn qualifiers(&mut self, list: Node) -> Vec<(Qualifier, plcc_diag::Span)> {
        let span = self.tag(list);
        let known = [
            ("constant", Qualifier::Constant),
            ("retain", Qualifier::Retain),
            ("nonretain", Qualifier::NonRetain),
            ("persistent", Qualifier::Persistent),
        ];
        known.into_iter().filter(|(name, _)| flag(list, name)).map(|(_, q)| (q, span)).collect()
    }
}
