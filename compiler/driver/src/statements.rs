//! Which variables the statement around a check mentions: what `--history` shows when it fails.
//!
//! In: checked bodies, layouts, the source table. Out: the statements in which something can fail, and for each row of the
//! table its statement. A statement's variables are those of its own expressions, not of the statements inside it; what
//! lies in the frame of a function is gone when a fault is told and is left out.

use plcc_diag::{FileId, Span};
use plcc_hir::app::Application;
use plcc_hir::body::{ExprKind, Place, Root, Step, Stmt};
use plcc_hir::visit::{self, Use, Visitor};
use plcc_hir::{Defs, Type, TypeId};
use plcc_mir::ir::Program;
use plcc_mir::layout::{Layout, Slot};
use plcc_runtime::image::{Statement, StatementVar};
use rustc_hash::FxHashMap;

/// A position in a source, to sort by.
type At = (FileId, u32);

#[derive(Default)]
struct Found {
    statements: Vec<Span>,
    places: Vec<Place>,
}

impl Visitor for Found {
    fn stmt(&mut self, stmt: &Stmt) {
        self.statements.push(stmt.span);
    }
    fn place(&mut self, place: &Place, _: Use) {
        self.places.push(place.clone());
    }
}

/// The statements, and for each row of the source table the number of its statement. `ty` gives a type's number.
pub fn of(
    app: &Application,
    layouts: &[Layout],
    defs: &Defs,
    program: &Program,
    ty: &mut dyn FnMut(TypeId) -> u32,
) -> (Vec<Statement>, Vec<Option<u32>>) {
    let mut found = Found::default();
    for (pou, body) in defs.bodies.iter_enumerated().filter(|(pou, _)| !defs.pous[*pou].builtin) {
        let _ = pou;
        visit::stmts(&body.stmts, &mut found);
    }
    let mut index = Innermost::new(found.statements);
    let places = found.places.iter().map(|p| (p.span.file, p.span.start)).collect();
    let of_place = index.find(places);
    let mut mentioned: FxHashMap<usize, Vec<&Place>> = FxHashMap::default();
    for (place, statement) in found.places.iter().zip(of_place) {
        if let Some(statement) = statement {
            mentioned.entry(statement).or_default().push(place);
        }
    }
    let rows = program.sources.iter().map(|s| (s.span.file, s.span.start)).collect();
    let of_row = index.find(rows);
    let mut statements = Vec::new();
    let mut numbers: FxHashMap<(usize, usize), u32> = FxHashMap::default();
    let mut of_source = Vec::with_capacity(of_row.len());
    for (row, statement) in of_row.into_iter().enumerate() {
        let resource = program.parts.iter().rposition(|p| p.first_source.index() <= row).unwrap_or(0);
        of_source.push(statement.map(|statement| {
            *numbers.entry((resource, statement)).or_insert_with(|| {
                let places = mentioned.get(&statement).map(Vec::as_slice).unwrap_or_default();
                let defs = &*app.defs_of(resource, defs);
                statements.push(Statement { vars: variables(defs, &layouts[resource], places, ty) });
                statements.len() as u32 - 1
            })
        }));
    }
    (statements, of_source)
}

fn variables(defs: &Defs, layout: &Layout, places: &[&Place], ty: &mut dyn FnMut(TypeId) -> u32) -> Vec<StatementVar> {
    let mut vars: Vec<StatementVar> = Vec::new();
    for place in places {
        let Root::Var(var) = place.root else { continue };
        // As far as it is fixed: a bit or a character is shown with what it is of.
        let fixed = place.steps.iter().take_while(|s| match s {
            Step::Field(_) | Step::Member(_) => true,
            Step::Index(indices, _) => indices.iter().all(|i| matches!(i.kind, ExprKind::Const(_))),
            _ => false,
        });
        let mut shown = Place { steps: fixed.cloned().collect(), ..(*place).clone() };
        let behind = &place.steps[shown.steps.len()..];
        if behind.iter().any(|s| !matches!(s, Step::Bit(_) | Step::Part(..) | Step::Character { .. })) {
            continue;
        }
        if !behind.is_empty() {
            let Some(whole) = type_of(defs, &shown) else { continue };
            shown.ty = whole;
        }
        let scalar = plcc_hir::elem_of(defs, shown.ty).is_some() || matches!(defs.types[shown.ty], Type::String { .. });
        let in_instance = match layout.slot(var) {
            Some(Slot::Instance(_)) => true,
            Some(Slot::Region(..)) => false,
            Some(Slot::Frame(_)) | None => continue,
        };
        if !scalar || defs.vars[var].section == plcc_hir::Section::InOut || defs.vars[var].is_hidden() {
            continue;
        }
        let name = plcc_mir::lower::of_place(defs, &shown, shown.steps.len());
        if vars.iter().any(|v| v.name == name) {
            continue;
        }
        let (offset, bit) = layout.address_of(defs, &shown, 0);
        vars.push(StatementVar { name, in_instance, offset, bit, ty: ty(shown.ty) });
    }
    vars
}

/// The type of a place that has fixed steps only.
fn type_of(defs: &Defs, place: &Place) -> Option<TypeId> {
    let Root::Var(root) = place.root else { return None };
    let mut ty = defs.vars[root].ty;
    for step in &place.steps {
        ty = match (step, &defs.types[ty]) {
            (Step::Field(n), Type::Struct(id)) => defs.structs[*id].fields[*n as usize].ty,
            (Step::Member(var), _) => defs.vars[*var].ty,
            (Step::Index(..), Type::Array { elem, .. }) => *elem,
            _ => return None,
        };
    }
    Some(ty)
}

/// Finds the innermost statement around positions.
struct Innermost {
    /// By start, outer before inner.
    spans: Vec<Span>,
}

impl Innermost {
    fn new(mut spans: Vec<Span>) -> Self {
        spans.sort_unstable_by_key(|s| (s.file, s.start, u32::MAX - s.end));
        spans.dedup();
        Self { spans }
    }

    /// One sweep over both, sorted.
    fn find(&mut self, positions: Vec<At>) -> Vec<Option<usize>> {
        let mut order: Vec<usize> = (0..positions.len()).collect();
        order.sort_unstable_by_key(|n| positions[*n]);
        let mut found = vec![None; positions.len()];
        let (mut next, mut open): (usize, Vec<usize>) = (0, Vec::new());
        for n in order {
            let at = positions[n];
            while let Some(span) = self.spans.get(next).filter(|s| (s.file, s.start) <= at) {
                let _ = span;
                open.push(next);
                next += 1;
            }
            // Spans nest, so what has ended lies on top or is not asked for again.
            while open.last().is_some_and(|top| (self.spans[*top].file, self.spans[*top].end) <= at) {
                open.pop();
            }
            found[n] = open.last().copied();
        }
        found
    }
}
