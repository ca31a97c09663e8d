//! Large charts: steps in groups, of which only those are looked at in which something may be active.
//!
//! A group is *awake* for two calls after a step of it was active, or an action of it had something stored: in the first of
//! them action control sees that the step was left. What belongs to a group, stands in one IF. So a call looks at each
//! awake group and once at each that sleeps; without groups it would look at each step. In a chart with few steps the
//! groups would cost more than they save, and there are none.

use super::emit::*;
use super::flags::{Flags, Item};
use crate::body::{Expr, Place, Stmt};
use crate::chart::{Chart, StepId};
use crate::types::Types;
use plcc_diag::Span;
use plcc_stdlib::elem::Elem;
use plcc_stdlib::ops::Op;

/// Up to so many steps a chart has no groups.
const SMALL: usize = 64;
/// Steps of a group, consecutive in the text. For a thousand steps the number of groups and their size are about the same.
const SIZE: usize = 32;
/// The counter of a group in which something is active.
const AWAKE: u64 = 2;

/// The groups of a chart.
pub(super) struct Groups {
    /// For how many calls the group stays awake; empty for a small chart.
    counters: Vec<Place>,
}

/// The group of a step; `None` if there are none, or for something that belongs to several.
pub(super) type Group = Option<usize>;

impl Groups {
    /// Makes the groups of a chart; all are awake at the start.
    pub fn new(w: &mut Writer, chart: &Chart) -> Self {
        if chart.steps.len() <= SMALL {
            return Self { counters: Vec::new() };
        }
        let (ty, span) = (Types::elem(Elem::Usint), chart.span.before());
        let count = chart.steps.len().div_ceil(SIZE);
        let counters = (0..count).map(|n| {
            let var = w.hidden(&format!("g{}", n + 1), ty, span);
            w.c.cx.defs.vars[var].init = crate::init::Init::Scalar(AWAKE);
            // A warm start may find another step active than those for which this counted.
            w.c.cx.defs.vars[var].non_retain = true;
            variable(var, ty, span)
        });
        Self { counters: counters.collect() }
    }

    /// The group of a step.
    pub fn of(&self, step: StepId) -> Group {
        (!self.counters.is_empty()).then(|| step.index() / SIZE)
    }

    /// The group to which all of these steps belong.
    pub fn common(&self, steps: impl IntoIterator<Item = StepId>) -> Group {
        let mut groups = steps.into_iter().map(|s| self.of(s));
        let first = groups.next()??;
        groups.all(|g| g == Some(first)).then_some(first)
    }

    /// Keeps a group awake.
    pub fn wake(&self, group: Group, span: Span, out: &mut Vec<Stmt>) {
        if let Some(counter) = group.map(|g| &self.counters[g]) {
            out.push(assign(counter.clone(), constant(AWAKE, Elem::Usint, span), span));
        }
    }

    /// Counts an awake group down, at the begin of a call.
    pub fn tire(&self, group: Group, span: Span, out: &mut Vec<Stmt>) {
        if let Some(counter) = group.map(|g| &self.counters[g]) {
            let one = constant(1, Elem::Usint, span);
            let less = operation(Op::Sub, Elem::Usint, vec![read(counter.clone()), one], span);
            out.push(assign(counter.clone(), less, span));
        }
    }

    fn is_awake(&self, group: usize, span: Span) -> Expr {
        let counter = &self.counters[group];
        let zero = constant(0, Elem::Usint, span);
        let kind = crate::body::ExprKind::Op(Op::Ne, Elem::Usint, vec![read(counter.clone()), zero]);
        Expr { kind, ty: Types::elem(BOOL), span }
    }
}

/// Statements that belong to groups, in order; neighbours of one group share its IF.
#[derive(Default)]
pub(super) struct Grouped {
    runs: Vec<(Group, Vec<Item>)>,
}

impl Grouped {
    pub fn push(&mut self, group: Group, stmts: impl IntoIterator<Item = Stmt>) {
        self.add(group, None, stmts, Vec::new());
    }

    /// Statements for the case that this flag of those given to `finish` is TRUE.
    pub fn push_flagged(&mut self, group: Group, flag: usize, stmts: Vec<Stmt>, span: Span) {
        self.add(group, Some((flag, span)), stmts, Vec::new());
    }

    /// The same; `quiet` changes nothing while the flag is FALSE, else it does what the statements do.
    pub fn push_either(&mut self, group: Group, flag: usize, stmts: Vec<Stmt>, quiet: Vec<Stmt>, span: Span) {
        self.add(group, Some((flag, span)), stmts, quiet);
    }

    fn add(
        &mut self,
        group: Group,
        flag: Option<(usize, Span)>,
        stmts: impl IntoIterator<Item = Stmt>,
        quiet: Vec<Stmt>,
    ) {
        let item = Item { flag, stmts: stmts.into_iter().collect(), quiet };
        match self.runs.last_mut() {
            Some((last, list)) if *last == group => list.push(item),
            _ => self.runs.push((group, vec![item])),
        }
    }

    pub fn finish(self, groups: &Groups, flags: &Flags, out: &mut Vec<Stmt>) {
        for (group, items) in self.runs {
            let mut stmts = Vec::new();
            flags.skip(items, &mut stmts);
            let Some(first) = stmts.first().map(|s| s.span) else { continue };
            match group {
                Some(group) => out.push(when(groups.is_awake(group, first), stmts, first)),
                None => out.append(&mut stmts),
            }
        }
    }
}
