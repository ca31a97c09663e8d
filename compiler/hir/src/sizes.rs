//! `SIZEOF`, `LOWER_BOUND`, `UPPER_BOUND` (semantics.md \[T3\] \[T8\] \[R1\]).

use crate::body::*;
use crate::cx::*;
use crate::defs::*;
use crate::expr::*;
use crate::place::Found;
use crate::shape::Shapes;
use crate::types::{Type, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::Elem;
use plcc_syntax::ast;
use rustc_hash::FxHashSet;

impl<'a> Checker<'_, 'a> {
    /// Bytes of a variable or type: an untyped constant.
    pub fn size_of(&mut self, call: &'a ast::Call, span: Span) -> Operand {
        let [ast::Arg { kind: ast::ArgKind::Positional(e), .. }] = call.args.as_slice() else {
            self.report(
                Diagnostic::new(codes::TOO_MANY_ARGUMENTS, span, "SIZEOF takes one variable or type")
                    .help("write SIZEOF(variable)"),
            );
            return Operand::Error;
        };
        let ty = match self.type_by_name(e) {
            Some(ty) => ty,
            None => match self.place(e) {
                Some(place) => place.ty,
                None => return Operand::Error,
            },
        };
        self.cx.resolve_inside(ty, &mut FxHashSet::default());
        if ty == Types::ERROR {
            return Operand::Error;
        }
        if matches!(self.cx.defs.types.get(ty), Type::AnyArray { .. } | Type::AnyString { .. }) {
            let name = self.cx.type_name(ty);
            self.report(
                Diagnostic::new(codes::WRONG_OPERAND, e.span, format!("the size of {name} depends on the call"))
                    .help("for an array use UPPER_BOUND and LOWER_BOUND, for a string LEN"),
            );
            return Operand::Error;
        }
        Operand::Int(i128::from(Shapes::size_of(&self.cx.defs, ty)))
    }

    /// The type that a plain name means, where no variable hides it.
    fn type_by_name(&mut self, e: &'a ast::Expr) -> Option<TypeId> {
        let ast::ExprKind::Name(name) = &e.kind else { return None };
        match self.lookup(name) {
            Found::Type | Found::Missing => {}
            Found::Pou(pou) if self.cx.defs.pous[pou].kind == PouKind::FunctionBlock => {}
            _ => return None,
        }
        let wide = match fold(&name.text).as_str() {
            "STRING" => false,
            "WSTRING" => true,
            _ => return self.cx.type_named(name),
        };
        Some(self.cx.defs.types.intern(Type::String { wide, capacity: crate::resolve::DEFAULT_STRING }))
    }

    /// A bound of an array: a constant, or what the caller of an ARRAY [*] passes.
    pub fn bound(&mut self, upper: bool, call: &'a ast::Call, span: Span) -> Operand {
        let name = if upper { "UPPER_BOUND" } else { "LOWER_BOUND" };
        let Some((array, dim)) = bound_arguments(call) else {
            self.report(
                Diagnostic::new(codes::TOO_MANY_ARGUMENTS, span, format!("{name} takes an array and a dimension"))
                    .help(format!("write {name}(array, 1)")),
            );
            return Operand::Error;
        };
        let Some(place) = self.place(array) else { return Operand::Error };
        let dims = match self.cx.defs.types.get(place.ty) {
            Type::Array { dims, .. } => dims.len(),
            Type::AnyArray { dims, .. } => *dims,
            Type::Error => return Operand::Error,
            _ => {
                let ty = self.cx.type_name(place.ty);
                self.report(
                    Diagnostic::new(codes::NOT_AN_ARRAY, array.span, format!("{ty} has no bounds"))
                        .help("only arrays have bounds"),
                );
                return Operand::Error;
            }
        };
        let Some(number) = self.const_integer(dim) else { return Operand::Error };
        if !(1..=dims as i128).contains(&number) {
            self.report(
                Diagnostic::new(codes::OUT_OF_RANGE, dim.span, format!("dimension {number} of an array of {dims}"))
                    .help("dimensions count from 1"),
            );
            return Operand::Error;
        }
        let at = (number - 1) as usize;
        if let Type::Array { dims, .. } = self.cx.defs.types.get(place.ty) {
            let (low, high) = dims[at];
            return Operand::Int(i128::from(if upper { high } else { low }));
        }
        match self.open_bounds(&place) {
            Some(bounds) => {
                let var = bounds[at][usize::from(upper)];
                Operand::value(ExprKind::Read(self.plain_place(var, span)), Types::elem(Elem::Dint), span)
            }
            None => Operand::Error,
        }
    }
}

/// Positional, or by the names of the standard: `ARR` and `DIM`.
fn bound_arguments(call: &ast::Call) -> Option<(&ast::Expr, &ast::Expr)> {
    let named = |arg: &'_ ast::Arg, wanted: &str| match &arg.kind {
        ast::ArgKind::Positional(_) => true,
        ast::ArgKind::Input(name, Some(_)) => name.text.eq_ignore_ascii_case(wanted),
        _ => false,
    };
    let [first, second] = call.args.as_slice() else { return None };
    let (array, dim) = match (named(first, "ARR") && named(second, "DIM"), named(second, "ARR") && named(first, "DIM"))
    {
        (true, _) => (first, second),
        (_, true) => (second, first),
        _ => return None,
    };
    match (&array.kind, &dim.kind) {
        (
            ast::ArgKind::Positional(array) | ast::ArgKind::Input(_, Some(array)),
            ast::ArgKind::Positional(dim) | ast::ArgKind::Input(_, Some(dim)),
        ) => Some((array, dim)),
        _ => None,
    }
}

impl Cx<'_> {
    /// Resolves the types of everything that lies inside a type.
    fn resolve_inside(&mut self, ty: TypeId, seen: &mut FxHashSet<TypeId>) {
        if !seen.insert(ty) {
            return;
        }
        match self.defs.types.get(ty).clone() {
            Type::Array { elem, .. } => self.resolve_inside(elem, seen),
            Type::Struct(id) => {
                let fields: Vec<TypeId> = self.defs.structs[id].fields.iter().map(|f| f.ty).collect();
                fields.into_iter().for_each(|ty| self.resolve_inside(ty, seen));
            }
            Type::Instance(pou) => {
                for var in self.defs.pous[pou].vars.clone() {
                    self.var_type(var);
                    if self.defs.vars[var].section != Section::InOut {
                        self.resolve_inside(self.defs.vars[var].ty, seen);
                    }
                }
            }
            _ => {}
        }
    }
}
