//! Places as text: names of memory for the printer, and of references for fault messages.

use super::place::constant;
use plcc_hir::body::{Expr, ExprKind, Place, Root, Step};
use plcc_hir::{Defs, RefKind, Type, TypeId, Types};
use std::fmt::Write;

/// The first `steps` steps of a place: `m.axis[3].speed`, `p^.next`; an index that is no constant is `..`.
pub fn of_place(defs: &Defs, place: &Place, steps: usize) -> String {
    let (mut text, mut ty) = match &place.root {
        Root::Var(id) => (defs.vars[*id].name.to_string(), Some(defs.vars[*id].ty)),
        Root::Deref(reference) => {
            let sign = if is_followed(defs, Some(reference.ty)) { "" } else { "^" };
            (format!("{}{sign}", of_expr(defs, reference)), target(defs, Some(reference.ty)))
        }
        Root::Temp(temp) => (format!("${}", temp.raw()), None),
        Root::Address(address) => (format!("%{:?}{}", address.area, address.byte), None),
    };
    for step in &place.steps[..steps] {
        ty = append(defs, &mut text, ty, step);
    }
    text
}

/// A reference: the place from which it is read, else nothing.
pub(super) fn of_expr(defs: &Defs, expr: &Expr) -> String {
    match &expr.kind {
        ExprKind::Read(place) => of_place(defs, place, place.steps.len()),
        ExprKind::Retype(inner) => of_expr(defs, inner),
        _ => String::new(),
    }
}

fn target(defs: &Defs, ty: Option<TypeId>) -> Option<TypeId> {
    match ty.map(|ty| &defs.types[ty]) {
        Some(Type::Ref { target, .. }) => Some(*target),
        _ => None,
    }
}

/// Whether it is a REFERENCE TO, which has no `^` in the source.
fn is_followed(defs: &Defs, ty: Option<TypeId>) -> bool {
    ty.is_some_and(|ty| matches!(defs.types[ty], Type::Ref { kind: RefKind::ReferenceTo, .. }))
}

fn append(defs: &Defs, text: &mut String, ty: Option<TypeId>, step: &Step) -> Option<TypeId> {
    match step {
        Step::Field(n) => match ty.map(|ty| &defs.types[ty]) {
            Some(Type::Struct(id)) => {
                let field = &defs.structs[*id].fields[*n as usize];
                text.push('.');
                text.push_str(&field.name);
                Some(field.ty)
            }
            _ => None,
        },
        Step::Member(id) => {
            text.push('.');
            text.push_str(&defs.vars[*id].name);
            Some(defs.vars[*id].ty)
        }
        Step::Index(..) | Step::OpenIndex(..) => {
            let number = |e: &Expr| constant(e).map_or("..".to_string(), |raw| (raw as i64).to_string());
            let list: Vec<String> = match step {
                Step::OpenIndex(indices, _) => indices.iter().map(|i| number(&i.value)).collect(),
                Step::Index(indices, _) => indices.iter().map(number).collect(),
                _ => Vec::new(),
            };
            // Writing to a String cannot fail.
            let _ = write!(text, "[{}]", list.join(","));
            match ty.map(|ty| &defs.types[ty]) {
                Some(Type::Array { elem, .. } | Type::AnyArray { elem, .. }) => Some(*elem),
                _ => None,
            }
        }
        Step::Character { index, .. } => {
            let number = constant(index).map_or("..".to_string(), |raw| (raw as i64).to_string());
            // As above.
            let _ = write!(text, "[{number}]");
            None
        }
        Step::Deref => {
            if !is_followed(defs, ty) {
                text.push('^');
            }
            target(defs, ty)
        }
        Step::Bit(n) => {
            let _ = write!(text, ".{n}");
            None
        }
        Step::Flags(word) => {
            text.push_str("..");
            Some(Types::elem(*word))
        }
        Step::Part(elem, n) => {
            let _ = write!(text, ".%{}{n}", &elem.name()[..1]);
            Some(Types::elem(*elem))
        }
    }
}
