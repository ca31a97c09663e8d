//! To what references refer initially (semantics.md \[S8\]).
//!
//! An initialiser of a reference is only noted while declarations are resolved, and looked at when all of them are: a type
//! may refer to variables of that same type (`next : REF_TO Node := REF(first)`), and whatever is referred to needs no
//! value for that.

use crate::body::*;
use crate::consts::{NotConstant, Reads};
use crate::cx::*;
use crate::defs::*;
use crate::expr::Checker;
use crate::init::Init;
use crate::types::{RefKind, Type, TypeId};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::fault::Fault;
use plcc_syntax::ast;

/// Whose initial value it is.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Home {
    /// A variable's own.
    Variable(VarId),
    /// That of every variable of a type, or one that VAR_CONFIG gives from outside: it sees the names of a POU if the type
    /// stands in one.
    Outside(Option<PouId>),
}

impl Home {
    /// Whose names it sees.
    pub fn scope(self, defs: &Defs) -> Option<PouId> {
        match self {
            Home::Variable(var) => defs.vars[var].owner,
            Home::Outside(scope) => scope,
        }
    }
}

/// An initialiser of a reference.
#[derive(Debug)]
pub(crate) struct Noted<'a> {
    written: &'a ast::Expr,
    ty: TypeId,
    home: Home,
    settled: State<()>,
}

impl<'a> Cx<'a> {
    /// Notes the initialiser of a reference; `None` if it does not have the form of one. `REF=` belongs to REFERENCE TO.
    pub fn note_reference(&mut self, init: &'a ast::Init, ty: TypeId, home: Home) -> Option<Init> {
        let Type::Ref { kind, .. } = *self.defs.types.get(ty) else { return None };
        let written = match &init.kind {
            ast::InitKind::Expr(e) => e,
            ast::InitKind::Reference(e) if kind == RefKind::ReferenceTo => e,
            _ => return None,
        };
        self.noted.push(Noted { written, ty, home, settled: State::Todo });
        Some(Init::Reference(self.defs.references.push(None)))
    }

    /// Notes references that are part of what is copied from the variable `e`.
    pub fn note_copies(&mut self, init: &Init, e: &'a ast::Expr, home: Home) {
        let mut found = Vec::new();
        init.references(&mut found);
        self.copied_references.extend(found.into_iter().map(|id| (id, e, home)));
    }

    /// Finds to what all noted references refer.
    pub fn settle_references(&mut self) {
        for id in self.defs.references.indices() {
            self.settle_reference(id);
        }
        for (id, e, home) in std::mem::take(&mut self.copied_references) {
            let Some(place) = self.defs.references[id].clone() else { continue };
            let scope = home.scope(&self.defs);
            let mut c = Checker::constant(self, scope);
            // Behind a point another instance may begin, and what it refers to lies in that one.
            let global = matches!(place.root, Root::Var(var) if c.cx.defs.vars[var].section == Section::Global);
            if !(global || matches!(e.kind, ast::ExprKind::Name(_)) && c.stays_in_place(&place, home)) {
                let ty = c.cx.noted[id].ty;
                c.not_initial(e.span, ty, home);
            }
        }
    }

    fn settle_reference(&mut self, id: ReferenceId) {
        let Noted { written, ty, home, ref settled } = self.noted[id];
        match settled {
            State::Done(()) => return,
            State::Busy => {
                return self.push(
                    Diagnostic::new(codes::CYCLIC_VALUE, written.span, "this initial value depends on itself")
                        .help("break the cycle: one of these references must be initialised with REF or ADR"),
                );
            }
            State::Todo => {}
        }
        self.noted[id].settled = State::Busy;
        let scope = home.scope(&self.defs);
        self.defs.references[id] = Checker::constant(self, scope).initial_reference(written, ty, home);
        self.noted[id].settled = State::Done(());
    }
}

impl<'a> Checker<'_, 'a> {
    /// To what a reference refers initially; `None` for NULL. Messages are given.
    fn initial_reference(&mut self, e: &'a ast::Expr, ty: TypeId, home: Home) -> Option<Place> {
        let mut expr = self.value(e, ty);
        while let ExprKind::Retype(inner) | ExprKind::Convert(_, _, inner) = expr.kind {
            expr = *inner;
        }
        let at = match expr.kind {
            ExprKind::Const(0) | ExprKind::Error => return None,
            ExprKind::RefOf(place) => match self.fixed(place) {
                Ok(place) if self.stays_in_place(&place, home) => return Some(place),
                Ok(place) => place.span,
                Err(NotConstant::Varies(span)) => span,
                Err(why) => {
                    self.not_constant(why, Reads::Initials);
                    return None;
                }
            },
            ExprKind::Read(place) => match self.initially_there(&place) {
                Some(None) => return None,
                Some(Some(target)) if self.stays_in_place(&target, home) => return Some(target),
                _ => e.span,
            },
            _ => e.span,
        };
        self.not_initial(at, ty, home);
        None
    }

    fn not_initial(&mut self, at: Span, ty: TypeId, home: Home) {
        let how = if self.is_reference_to(ty) { "" } else { "REF or ADR of " };
        let null = if self.is_reference_to(ty) { "" } else { "with NULL, " };
        let help = match home {
            Home::Outside(_) => format!(
                "what a type says holds for all its variables: {how}a global variable; each of them can have its own: \
                 `v : T := (r := ...)`"
            ),
            Home::Variable(var) if !self.sees_its_pou(var) => {
                format!(
                    "what starts anew with each call is initialised with {how}a global variable, {null}or not at all"
                )
            }
            Home::Variable(_) => format!(
                "a reference is initialised with {how}a global variable or one of the same POU, {null}or not at all"
            ),
        };
        let message = "this is known only at run time, a constant is needed";
        self.report(Diagnostic::new(codes::NOT_CONSTANT, at, message).help(help));
    }

    /// A place with its indices computed. Else why there is none.
    fn fixed(&mut self, mut place: Place) -> Result<Place, NotConstant> {
        let Root::Var(root) = place.root else { return Err(NotConstant::Varies(place.span)) };
        let mut ty = self.cx.defs.vars[root].ty;
        for step in &mut place.steps {
            ty = match (step, self.cx.defs.types.get(ty).clone()) {
                (Step::Index(indices, _), Type::Array { dims, elem }) => {
                    for (index, (low, high)) in indices.iter_mut().zip(dims) {
                        let raw = self.cx.eval(index, Reads::Initials)?;
                        if !(low..=high).contains(&(raw as i64)) {
                            return Err(NotConstant::Faults(index.span, Fault::IndexOutOfBounds));
                        }
                        index.kind = ExprKind::Const(raw);
                    }
                    elem
                }
                (Step::Field(n), Type::Struct(id)) => self.cx.defs.structs[id].fields[*n as usize].ty,
                (Step::Member(var), _) => self.cx.defs.vars[*var].ty,
                _ => return Err(NotConstant::Varies(place.span)),
            };
        }
        Ok(place)
    }

    /// To what the reference in a place refers initially, as its own declaration says: a place of the same instance or a
    /// global one. `None` if that is not known.
    fn initially_there(&mut self, place: &Place) -> Option<Option<Place>> {
        // What an instance inside refers to lies in that instance.
        if place.steps.iter().any(|step| matches!(step, Step::Member(_))) {
            return None;
        }
        match self.cx.initial_of(place, Reads::Initials).ok()? {
            Init::Default => Some(None),
            Init::Reference(id) => {
                self.cx.settle_reference(id);
                Some(self.cx.defs.references[id].clone())
            }
            _ => None,
        }
    }

    /// Whether the address of a place is the same as long as that for which it is an initial value exists.
    fn stays_in_place(&self, place: &Place, home: Home) -> bool {
        let Root::Var(var) = place.root else { return false };
        let stays = match (self.cx.defs.vars[var].section, home) {
            (Section::Global, _) => true,
            (Section::Temp | Section::InOut, _) | (_, Home::Outside(_)) => false,
            (_, Home::Variable(of)) => self.sees_its_pou(of),
        };
        let fixed =
            |step: &Step| !matches!(step, Step::Member(var) if self.cx.defs.vars[*var].section == Section::InOut);
        stays && place.steps.iter().all(fixed)
    }

    /// Whether the variables of its POU exist when a variable gets its initial value, and as long as it exists.
    fn sees_its_pou(&self, var: VarId) -> bool {
        let var = &self.cx.defs.vars[var];
        let function = var.owner.is_some_and(|pou| self.cx.defs.pous[pou].kind == PouKind::Function);
        match var.section {
            Section::Temp | Section::InOut => false,
            // It is the caller who gives an input its value, before the function starts.
            Section::Input => !function,
            Section::Local | Section::Output | Section::Global | Section::Result => true,
        }
    }
}
