//! `ARRAY [*]` as VAR_IN_OUT: an array of any bounds, which each call passes along (semantics.md \[S4\]).
//!
//! The bounds are hidden inputs of the POU, two DINTs per dimension; an actual ARRAY [*] hands on its own.

use crate::body::*;
use crate::collect::new_var;
use crate::cx::*;
use crate::defs::*;
use crate::expr::*;
use crate::types::{Type, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::Elem;
use plcc_syntax::ast;

impl Cx<'_> {
    /// Declares the bounds of a parameter that is an ARRAY [*].
    pub fn declare_bounds(&mut self, array: VarId, dims: usize) {
        let (name, owner, span) = {
            let var = &self.defs.vars[array];
            (var.name.clone(), var.owner, var.span)
        };
        let Some(owner) = owner else { return };
        let mut bounds = Vec::with_capacity(dims);
        for dim in 1..=dims {
            bounds.push(["low", "high"].map(|which| {
                let hidden = format!("${which}{dim}.{name}").into();
                let var = new_var(self, hidden, span, Section::Input, Some(owner), None);
                self.defs.vars[var].ty = Types::elem(Elem::Dint);
                self.var_slots[var].ty = State::Done(crate::init::Init::Default);
                self.defs.pous[owner].vars.push(var);
                var
            }));
        }
        self.open_bounds.insert(array, bounds);
    }
}

impl<'a> Checker<'_, 'a> {
    /// The variables that hold the bounds of an ARRAY [*] of this POU, lower and upper by dimension.
    pub fn open_bounds(&mut self, place: &Place) -> Option<Vec<[VarId; 2]>> {
        if let (Root::Var(var), true) = (&place.root, place.steps.is_empty()) {
            return self.cx.open_bounds.get(var).cloned();
        }
        // From outside (`fb.a`) nobody knows what is connected.
        self.report(
            Diagnostic::new(codes::NOT_AN_ARRAY, place.span, "an ARRAY [*] can be used in its own POU only")
                .help("the bounds are those of the last call; use the array that was connected"),
        );
        None
    }

    /// A variable of this POU as a place.
    pub fn plain_place(&mut self, var: VarId, span: Span) -> Place {
        let ty = self.type_of_var(var);
        Place { root: Root::Var(var), steps: Vec::new(), ty, span }
    }

    /// `a[i, j]` of an ARRAY [*].
    pub fn open_index(&mut self, mut base: Place, elem: TypeId, indices: &'a [ast::Expr], span: Span) -> Option<Place> {
        let bounds = self.open_bounds(&base)?;
        let mut list = Vec::new();
        for (e, [low, high]) in indices.iter().zip(bounds) {
            let value = self.subscript(e)?;
            let bound = |c: &mut Self, var| {
                let place = c.plain_place(var, e.span);
                let read = Expr { kind: ExprKind::Read(place), ty: Types::elem(Elem::Dint), span: e.span };
                c.with_elem(read, Elem::Lint, e.span)
            };
            let (low, high) = (bound(self, low), bound(self, high));
            list.push(OpenIndex { value, low, high });
        }
        let name = self.place_text(&base);
        base.steps.push(Step::OpenIndex(list, name));
        base.ty = elem;
        base.span = span;
        Some(base)
    }

    /// Passes the bounds of what is connected to a parameter that is an ARRAY [*].
    pub fn pass_bounds(&mut self, param: VarId, place: &Place, out: &mut Call) -> bool {
        let Some(hidden) = self.cx.open_bounds.get(&param).cloned() else { return true };
        let span = place.span;
        let values: Vec<[Expr; 2]> = match self.cx.defs.types.get(place.ty).clone() {
            Type::Array { dims, .. } => {
                let constant = |v: i64| Expr {
                    kind: ExprKind::Const(v as u64 & Elem::Dint.repr().mask()),
                    ty: Types::elem(Elem::Dint),
                    span,
                };
                if let Some((low, high)) = dims.iter().find(|(l, h)| i32::try_from(*l).and(i32::try_from(*h)).is_err())
                {
                    let message = format!("the bounds {low}..{high} are no DINTs");
                    self.report(
                        Diagnostic::new(codes::IN_OUT_MISMATCH, span, message)
                            .help("an ARRAY [*] takes arrays whose bounds are DINTs"),
                    );
                    return false;
                }
                dims.iter().map(|(low, high)| [constant(*low), constant(*high)]).collect()
            }
            _ => {
                let Some(own) = self.open_bounds(place) else { return false };
                own.into_iter()
                    .map(|pair| {
                        pair.map(|var| {
                            let place = self.plain_place(var, span);
                            Expr { kind: ExprKind::Read(place), ty: Types::elem(Elem::Dint), span }
                        })
                    })
                    .collect()
            }
        };
        for (vars, values) in hidden.into_iter().zip(values) {
            out.inputs.extend(vars.into_iter().zip(values));
        }
        true
    }
}
