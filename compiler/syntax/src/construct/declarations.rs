//! POUs, variables, types, initial values.

use super::{Context, ParenItem};
use crate::ast::*;
use plcc_diag::{Span, codes};
use smol_str::SmolStr;

impl Context<'_> {
    /// A POU; the ACTIONs of its body come with the body.
    #[allow(clippy::too_many_arguments)]
    pub fn pou(
        &self,
        kind: PouKind,
        name: Name,
        result: Option<TypeExpr>,
        sections: Vec<VarSection>,
        (body, actions): (Body, Vec<Action>),
        l: u32,
        r: u32,
    ) -> Pou {
        Pou { kind, name, result, sections, actions, body, span: self.span(l, r) }
    }

    /// `ACTION name:`, or `ACTION first.second:`.
    pub fn action(&self, first: Name, second: Option<Name>, body: Body, l: u32, r: u32) -> Action {
        let (owner, name) = match second {
            Some(name) => (Some(first), name),
            None => (None, first),
        };
        Action { owner, name, body, span: self.span(l, r) }
    }

    /// The section that the keyword in bytes `l..r` opens.
    pub fn section_kind(&self, l: u32, r: u32) -> SectionKind {
        let word = self.slice(l, r).to_ascii_uppercase();
        match crate::blocks::section_meant(&word).unwrap_or("VAR") {
            "VAR_INPUT" => SectionKind::Input,
            "VAR_OUTPUT" => SectionKind::Output,
            "VAR_IN_OUT" => SectionKind::InOut,
            "VAR_EXTERNAL" => SectionKind::External,
            "VAR_GLOBAL" => SectionKind::Global,
            "VAR_TEMP" => SectionKind::Temp,
            _ => SectionKind::Var,
        }
    }

    /// A section.
    pub fn section(
        &self,
        kind: SectionKind,
        qualifiers: Vec<(Qualifier, Span)>,
        vars: Vec<VarDecl>,
        l: u32,
        r: u32,
    ) -> VarSection {
        VarSection { kind, qualifiers, vars, span: self.span(l, r) }
    }

    /// The word in bytes `l..r`.
    pub fn qualifier(&self, l: u32, r: u32) -> (Qualifier, Span) {
        let qualifier = match self.slice(l, r).to_ascii_uppercase().as_str() {
            // The short form was reported.
            "CONSTANT" | "CONST" => Qualifier::Constant,
            "RETAIN" => Qualifier::Retain,
            "NON_RETAIN" => Qualifier::NonRetain,
            "PERSISTENT" => Qualifier::Persistent,
            _ => Qualifier::Access,
        };
        (qualifier, self.span(l, r))
    }

    /// R_EDGE or F_EDGE.
    pub fn edge(&self, l: u32, r: u32) -> (Edge, Span) {
        let rising = self.slice(l, r).eq_ignore_ascii_case("R_EDGE");
        (if rising { Edge::Rising } else { Edge::Falling }, self.span(l, r))
    }

    /// READ_WRITE (or READ_ONLY).
    pub fn is_read_write(&self, l: u32, r: u32) -> bool {
        self.slice(l, r).eq_ignore_ascii_case("READ_WRITE")
    }

    /// A declaration of variables or fields.
    #[allow(clippy::too_many_arguments)]
    pub fn declaration(
        &self,
        names: Vec<Name>,
        at: Option<(SmolStr, Span)>,
        ty: TypeExpr,
        edge: Option<(Edge, Span)>,
        init: Option<Init>,
        l: u32,
    ) -> Box<VarDecl> {
        let end = init.as_ref().map(|i| i.span).or(edge.map(|e| e.1)).unwrap_or(ty.span).end;
        let span = self.span(l, end);
        Box::new(VarDecl { names, path: Vec::new(), at, ty, edge, read_write: None, init, span })
    }

    /// A declaration of VAR_CONFIG.
    pub fn path_declaration(
        &self,
        mut path: Vec<Name>,
        at: Option<(SmolStr, Span)>,
        ty: TypeExpr,
        init: Option<Init>,
        l: u32,
    ) -> Box<VarDecl> {
        let names = vec![path.remove(0)];
        let end = init.as_ref().map_or(ty.span, |i| i.span).end;
        Box::new(VarDecl { names, path, at, ty, edge: None, read_write: None, init, span: self.span(l, end) })
    }

    /// A declaration of VAR_ACCESS.
    #[allow(clippy::too_many_arguments)]
    pub fn access_declaration(
        &self,
        name: Name,
        path: Vec<Name>,
        at: Option<(SmolStr, Span)>,
        ty: TypeExpr,
        read_write: Option<bool>,
        l: u32,
        r: u32,
    ) -> Box<VarDecl> {
        let span = self.span(l, r);
        Box::new(VarDecl { names: vec![name], path, at, ty, edge: None, read_write, init: None, span })
    }

    /// A declaration of TYPE.
    pub fn type_declaration(&self, name: Name, ty: TypeExpr, init: Option<Init>, l: u32) -> Box<TypeDecl> {
        let end = init.as_ref().map_or(ty.span, |i| i.span).end;
        Box::new(TypeDecl { name, ty, init, span: self.span(l, end) })
    }

    fn type_node(&self, kind: TypeExprKind, below: u32, l: u32, r: u32) -> TypeExpr {
        let span = self.span(l, r);
        if self.cut(below + 1, span) {
            return TypeExpr { kind: TypeExprKind::Error, span, depth: 1 };
        }
        TypeExpr { kind, span, depth: below + 1 }
    }

    /// A type whose parts are in `kind`.
    pub fn ty(&self, kind: TypeExprKind, l: u32, r: u32) -> TypeExpr {
        let below = match &kind {
            TypeExprKind::Struct(fields) | TypeExprKind::Union(fields) => {
                fields.iter().map(|f| f.ty.depth).max().unwrap_or(0)
            }
            _ => 0,
        };
        match kind {
            TypeExprKind::Named(name) => match string_width(&name) {
                Some(wide) => self.type_node(TypeExprKind::String { wide, length: None }, 0, l, r),
                None => self.type_node(TypeExprKind::Named(name), 0, l, r),
            },
            kind => self.type_node(kind, below, l, r),
        }
    }

    /// `STRING[20]`.
    pub fn sized_type(&self, name: Name, length: Expr, l: u32, r: u32) -> TypeExpr {
        let Some(wide) = string_width(&name) else {
            self.report(
                codes::UNEXPECTED,
                self.span(name.span.end, r),
                format!("`{}` has no length", name.text),
                "only STRING and WSTRING do; an array is written `ARRAY [0..9] OF INT`",
            );
            return self.ty(TypeExprKind::Error, l, r);
        };
        let depth = length.depth;
        self.type_node(TypeExprKind::String { wide, length: Some(Box::new(length)) }, depth, l, r)
    }

    /// `STRING(20)`, `INT (1..10)`, `INT (A, B)`.
    pub fn paren_type(&self, name: Name, mut items: Vec<ParenItem>, l: u32, r: u32) -> TypeExpr {
        match (string_width(&name), items.pop()) {
            (Some(wide), Some(ParenItem::One(length))) if items.is_empty() => {
                let depth = length.depth;
                self.type_node(TypeExprKind::String { wide, length: Some(Box::new(length)) }, depth, l, r)
            }
            (_, Some(ParenItem::Range(low, high))) if items.is_empty() => {
                let depth = low.depth.max(high.depth);
                let (low, high) = (Box::new(low), Box::new(high));
                self.type_node(TypeExprKind::Subrange { base: name, low, high }, depth, l, r)
            }
            (_, last) => {
                items.extend(last);
                self.enumeration(Some(name), items, l, r)
            }
        }
    }

    /// `(Red, Green := 5) INT`.
    pub fn enumeration(&self, base: Option<Name>, items: Vec<ParenItem>, l: u32, r: u32) -> TypeExpr {
        let mut values = Vec::with_capacity(items.len());
        for item in items {
            let (name, value) = match item {
                ParenItem::One(name) => (name, None),
                ParenItem::Valued(name, value) => (name, Some(value)),
                ParenItem::Range(low, high) => {
                    self.report(
                        codes::UNEXPECTED,
                        low.span.to(high.span),
                        "a range cannot stand here",
                        "a subrange names its base type: `INT (1..10)`",
                    );
                    return self.ty(TypeExprKind::Error, l, r);
                }
            };
            match name.kind {
                ExprKind::Name(name) => values.push(EnumValue { name, value }),
                ExprKind::Error => {}
                _ => {
                    self.report(
                        codes::UNEXPECTED,
                        name.span,
                        "a value of an enumeration is a name",
                        "write `(Red, Green := 5)`",
                    );
                    return self.ty(TypeExprKind::Error, l, r);
                }
            }
        }
        let depth = values.iter().filter_map(|v| v.value.as_ref()).map(|v| v.depth).max().unwrap_or(0);
        self.type_node(TypeExprKind::Enum { base, values }, depth, l, r)
    }

    /// `ARRAY [dims] OF elem`.
    pub fn array_type(&self, dims: Vec<Dim>, elem: TypeExpr, l: u32, r: u32) -> TypeExpr {
        let bounds = dims.iter().map(|d| match d {
            Dim::Range(low, high) => low.depth.max(high.depth),
            Dim::Any(_) => 0,
        });
        let depth = bounds.fold(elem.depth, u32::max);
        self.type_node(TypeExprKind::Array { dims, elem: Box::new(elem) }, depth, l, r)
    }

    /// `REF_TO T`; the words end at `m`.
    pub fn ref_type(&self, m: u32, target: TypeExpr, l: u32, r: u32) -> TypeExpr {
        let word = self.slice(l, m).as_bytes();
        let kind = match (word.get(3), word.first()) {
            (Some(b'_'), _) => RefKind::RefTo,
            (_, Some(b'P' | b'p')) => RefKind::PointerTo,
            _ => RefKind::ReferenceTo,
        };
        let depth = target.depth;
        self.type_node(TypeExprKind::Ref { kind, target: Box::new(target) }, depth, l, r)
    }

    /// An initial value.
    pub fn init(&self, kind: InitKind, l: u32, r: u32) -> Init {
        Init { kind, span: self.span(l, r) }
    }

    /// What stands behind `:=`: one value, or several as in Ed. 2.
    pub fn init_list(&self, mut elems: Vec<InitElem>, l: u32, r: u32) -> Init {
        match elems.pop() {
            Some(InitElem::One(init)) if elems.is_empty() => init,
            last => {
                elems.extend(last);
                self.init(InitKind::Array { bracketed: false, elems }, l, r)
            }
        }
    }

    /// `3(values)`; the count is in bytes `l..m`.
    pub fn repeat(&self, l: u32, m: u32, values: Vec<InitElem>, r: u32) -> InitElem {
        let values = values.into_iter().map(|v| self.elem_init(v, m, r)).collect();
        InitElem::Repeat(self.literal(l, m), values)
    }

    /// An element as a value of its own.
    fn elem_init(&self, elem: InitElem, l: u32, r: u32) -> Init {
        match elem {
            InitElem::One(init) => init,
            repeat => self.init(InitKind::Array { bracketed: false, elems: vec![repeat] }, l, r),
        }
    }

    /// `(a := 1, b := 2, 3)`: what has no name belongs to the array before it, as in Ed. 2.
    pub fn struct_init(
        &self,
        first: (Option<Name>, InitElem),
        more: Vec<(Option<Name>, InitElem)>,
        l: u32,
        r: u32,
    ) -> Init {
        let mut fields: Vec<(Name, Vec<InitElem>)> = Vec::with_capacity(more.len() + 1);
        for (name, elem) in std::iter::once(first).chain(more) {
            match (name, fields.last_mut()) {
                (Some(name), _) => fields.push((name, vec![elem])),
                (None, Some((_, elems))) => elems.push(elem),
                (None, None) => {}
            }
        }
        let fields = fields.into_iter().map(|(name, elems)| {
            let (start, end) = (name.span.end, elems.last().map_or(name.span.end, |e| elem_end(e, r)));
            (name, self.init_list(elems, start, end))
        });
        self.init(InitKind::Struct(fields.collect()), l, r)
    }
}

/// Where an element ends, as far as it is known.
fn elem_end(elem: &InitElem, limit: u32) -> u32 {
    match elem {
        InitElem::One(init) => init.span.end,
        InitElem::Repeat(count, values) => values.last().map_or(count.span.end, |v| v.span.end + 1).min(limit),
    }
}

/// Whether a type's name is WSTRING (true) or STRING (false).
fn string_width(name: &Name) -> Option<bool> {
    match name.text.len() {
        6 if name.text.eq_ignore_ascii_case("STRING") => Some(false),
        7 if name.text.eq_ignore_ascii_case("WSTRING") => Some(true),
        _ => None,
    }
}
