//! Where the current result is used, which type its place asks for, and what it is where ways meet.

use super::current::Current;
use super::lines::{FirstArgument, Line, What};
use super::{Il, Label};
use crate::expr::Operand;
use crate::types::{Type, TypeId, Types};
use plcc_diag::Span;
use plcc_stdlib::elem::Elem;
use plcc_syntax::ast::BinaryOp;
use plcc_syntax::il_operators::When;
use std::collections::VecDeque;

/// What the current result is behind a label.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Entry {
    /// Not known yet: the ways that were seen depend on jumps further down.
    Unknown,
    /// A value of this type.
    Typed(TypeId),
    /// A way brings none, or another type: its use is an error.
    Torn,
}

/// What one way to a label brings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Way {
    /// No current result.
    Nothing,
    /// An integer constant without type.
    Int(i128),
    /// A real constant without type.
    Real(f64),
    Typed(TypeId),
    /// Not known yet, or a mistake that was reported.
    Unknown,
}

/// Whether an operator compares: its operands do not take the type of its place.
fn compares(op: BinaryOp) -> bool {
    use BinaryOp::*;
    matches!(op, Lt | Gt | Le | Ge | Eq | Ne)
}

/// Fills in `live` and `want` of lines and labels. `at_end`: the current result at the end is the condition of a transition.
pub(super) fn find_uses(lines: &mut [Line], labels: &mut [Label], at_end: bool) {
    // A backward jump makes a label live whose line was passed already: again, until nothing changes.
    while pass(lines, labels, at_end) {}
    let want = at_end.then_some(Types::elem(Elem::Bool));
    find_wants(lines, labels, want);
}

/// One pass from the last line to the first; whether a label changed.
fn pass(lines: &mut [Line], labels: &mut [Label], at_end: bool) -> bool {
    let mut changed = false;
    let mut live = at_end;
    for line in lines.iter_mut().rev() {
        line.live = match &line.what {
            What::Jump { when: When::Always, .. } | What::Return(When::Always) => false,
            _ => live,
        };
        live = match &mut line.what {
            What::Nothing => live,
            What::Bad | What::Load { .. } | What::Formal(_) | What::Function { takes: false, .. } => false,
            What::Call { when: When::Always, .. } => live,
            What::Jump { when: When::Always, target } => target.is_some_and(|l| labels[l].live),
            What::Return(When::Always) => at_end,
            What::Deferred { inner, .. } => {
                // Inside of a parenthesis there are no labels; what it gives is used.
                pass(inner, labels, true);
                true
            }
            What::Store { .. }
            | What::Set { .. }
            | What::Not
            | What::Binary { .. }
            | What::Jump { .. }
            | What::Return(_)
            | What::Call { .. }
            | What::Input { .. }
            | What::Function { takes: true, .. } => true,
        };
        if let Some(label) = line.label {
            changed |= labels[label].live != live;
            labels[label].live = live;
        }
    }
    changed
}

/// The type that the place asks for: that of the variable which stores it, BOOL for a condition; as far as ST would hand it
/// down to the operands.
fn find_wants(lines: &mut [Line], labels: &mut [Label], at_end: Option<TypeId>) {
    let bool_ty = Some(Types::elem(Elem::Bool));
    let mut want = at_end;
    for line in lines.iter_mut().rev() {
        line.want = want;
        want = match &mut line.what {
            What::Bad | What::Load { .. } | What::Formal(_) | What::Return(When::Always) => None,
            What::Jump { when: When::Always, .. } | What::Function { takes: false, .. } => None,
            What::Nothing | What::Not | What::Call { when: When::Always, .. } => want,
            What::Store { ty, .. } => *ty,
            What::Set { .. } | What::Jump { .. } | What::Return(_) | What::Call { .. } => bool_ty,
            What::Input { .. } => None,
            What::Binary { op, .. } => want.filter(|_| !compares(*op)),
            What::Deferred { op, inner, .. } => {
                let inside = want.filter(|_| !compares(*op));
                find_wants(inner, &mut [], inside);
                inside
            }
            What::Function { wants: FirstArgument::Fixed(ty), .. } => *ty,
            What::Function { wants: FirstArgument::AsResult, .. } => want,
        };
        if let Some(label) = line.label.and_then(|l| labels.get_mut(l)) {
            label.want = want;
        }
    }
}

/// After so many changes of its type a label has none: constants and types on a circle of jumps.
const MAX_CHANGES: u32 = 8;

impl<'a> Il<'_, '_, 'a> {
    /// Finds the type of the current result at each label by trial, from label to label along the jumps. What the trial
    /// reports and emits is dropped.
    pub fn find_entries(&mut self, lines: &[Line<'a>]) {
        if !self.labels.iter().any(|l| l.live) {
            return;
        }
        let trial = self.c.cx.trial();
        let temps = self.c.temps.len();
        // The line of each label; the end of a transition has none.
        let mut starts: Vec<Option<usize>> = vec![None; self.labels.len()];
        for (n, line) in lines.iter().enumerate() {
            if let Some(label) = line.label {
                starts[label] = Some(n);
            }
        }
        let mut seen = vec![false; self.labels.len()];
        // Where the current result is not used its type need not be known; a label for live ones waits for its first way.
        let mut queue: VecDeque<(Option<usize>, usize)> = VecDeque::from([(None, 0)]);
        for (label, start) in starts.iter().enumerate() {
            let (Some(start), true, false) = (start, self.labels[label].used, self.labels[label].live) else {
                continue;
            };
            seen[label] = true;
            queue.push_back((Some(label), *start));
        }
        while let Some((label, start)) = queue.pop_front() {
            self.walk(lines, label, start);
            for label in std::mem::take(&mut self.touched) {
                // What comes behind a mistake is visited too: its labels have other ways.
                let new = self.labels[label].live && self.update(label) || !seen[label];
                seen[label] = true;
                if let (true, Some(start)) = (new, starts[label]) {
                    queue.push_back((Some(label), start));
                }
            }
        }
        self.c.cx.undo(trial);
        self.c.temps.truncate(temps);
    }

    /// Translates from a label (or the start) to the next label or to where control leaves.
    fn walk(&mut self, lines: &[Line<'a>], label: Option<usize>, start: usize) {
        self.out.clear();
        self.dead_from = 0;
        self.reachable = true;
        self.told_unreachable = true;
        self.cr = match label {
            None => Current::Nothing,
            Some(label) => self.at_label(label),
        };
        for (n, line) in lines.iter().enumerate().skip(start) {
            self.at_line = n;
            if let Some(next) = line.label.filter(|_| n > start || label.is_none()) {
                return self.bring_from_above(next);
            }
            self.line(line);
            if !self.reachable {
                return;
            }
        }
        self.at_line = lines.len();
        if let Some(end) = self.end {
            self.bring_from_above(end);
        }
    }

    /// Whether the ways to a label make something else of it now.
    fn update(&mut self, label: usize) -> bool {
        let mut entry = self.merge(label);
        if entry == self.labels[label].entry {
            return false;
        }
        self.labels[label].changes += 1;
        if self.labels[label].changes > MAX_CHANGES {
            entry = Entry::Torn;
        }
        let changed = entry != self.labels[label].entry;
        self.labels[label].entry = entry;
        changed
    }

    /// Notes a way to a label.
    pub fn note_way(&mut self, label: usize, from_above: bool, at: Span) {
        self.touched.push(label);
        let key = self.at_line * 2 + usize::from(from_above);
        let way = self.way();
        let ways = &mut self.labels[label].ways;
        match ways.iter_mut().find(|w| w.0 == key) {
            Some(known) => *known = (key, at, way),
            None => ways.push((key, at, way)),
        }
    }

    /// What the current result brings along a way that begins here.
    pub fn way(&self) -> Way {
        match &self.cr {
            Current::Nothing | Current::Torn(_) => Way::Nothing,
            Current::Unknown => Way::Unknown,
            Current::Value(value) => match &value.operand {
                Operand::Int(v) => Way::Int(*v),
                Operand::Real(v) => Way::Real(*v),
                Operand::Value { ty, .. } => Way::Typed(*ty),
                Operand::Error => Way::Unknown,
            },
        }
    }

    /// What the ways to a label make of the current result there.
    pub fn merge(&mut self, label: usize) -> Entry {
        let ways: Vec<Way> = self.labels[label].ways.iter().map(|(_, _, w)| *w).collect();
        if ways.contains(&Way::Nothing) {
            return Entry::Torn;
        }
        let mut common: Option<TypeId> = None;
        for way in &ways {
            let Way::Typed(ty) = way else { continue };
            common = match common {
                None => Some(*ty),
                Some(known) => match self.one_type(known, *ty) {
                    Some(ty) => Some(ty),
                    None => return Entry::Torn,
                },
            };
        }
        let constants: Vec<Operand> = ways
            .iter()
            .filter_map(|w| match w {
                Way::Int(v) => Some(Operand::Int(*v)),
                Way::Real(v) => Some(Operand::Real(*v)),
                _ => None,
            })
            .collect();
        let at = self.labels[label].at;
        match common {
            Some(ty) if constants.iter().all(|c| self.fits(c, at, ty)) => Entry::Typed(ty),
            Some(_) => Entry::Torn,
            None if constants.is_empty() => Entry::Unknown,
            None => Entry::Typed(self.type_of_constants(&constants, at, self.labels[label].want)),
        }
    }

    /// The type that two ways agree in, if they do.
    fn one_type(&mut self, a: TypeId, b: TypeId) -> Option<TypeId> {
        if a == b {
            return Some(a);
        }
        let types = &self.c.cx.defs.types;
        let base = |ty: TypeId| match types.get(ty) {
            Type::Subrange { base, .. } => Types::elem(*base),
            _ => ty,
        };
        match (types.get(a), types.get(b)) {
            _ if base(a) == base(b) => Some(base(a)),
            (Type::String { wide: x, capacity: m }, Type::String { wide: y, capacity: n }) if x == y => {
                Some(if m >= n { a } else { b })
            }
            // Room for any is room for this one.
            (Type::AnyString { wide: x }, Type::String { wide: y, .. }) if x == y => Some(a),
            (Type::String { wide: x, .. }, Type::AnyString { wide: y }) if x == y => Some(b),
            (Type::Null, Type::Ref { .. }) => Some(b),
            (Type::Ref { .. }, Type::Null) => Some(a),
            _ => None,
        }
    }

    fn fits(&mut self, constant: &Operand, at: Span, ty: TypeId) -> bool {
        let trial = self.c.cx.trial();
        let expr = self.c.coerce(constant.clone(), at, ty);
        self.c.cx.undo(trial);
        expr.ty != Types::ERROR
    }

    /// Constants only: the type that their place asks for if it holds all of them, else the smallest one that does
    /// (semantics.md \[T3\]).
    fn type_of_constants(&mut self, constants: &[Operand], at: Span, want: Option<TypeId>) -> TypeId {
        let candidates = [Elem::Int, Elem::Dint, Elem::Lint, Elem::Ulint, Elem::Lreal].map(Types::elem);
        let real = constants.iter().any(|c| matches!(c, Operand::Real(_)));
        let candidates = if real { &candidates[4..] } else { &candidates[..] };
        let mut all = want.into_iter().chain(candidates.iter().copied());
        let found = all.find(|ty| constants.iter().all(|c| self.fits(c, at, *ty)));
        found.unwrap_or(Types::elem(Elem::Lreal))
    }
}
