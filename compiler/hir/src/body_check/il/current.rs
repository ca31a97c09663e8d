//! The current result between two instructions: an expression that was not evaluated yet, as long as nothing that stands
//! between its instruction and its use can tell the difference.

use super::Il;
use super::flow::Entry;
use crate::body::*;
use crate::defs::{Defs, Section};
use crate::expr::{Operand, retype};
use crate::types::{Type, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::ops::Op;

/// A result with more operations than this is stored: passes over an expression recurse.
const MAX_OPERATIONS: u32 = 200;

/// The current result.
pub(super) enum Current {
    /// No instruction gave one yet.
    Nothing,
    Value(Value),
    /// The ways to this label bring different ones; its use is an error.
    Torn(usize),
    /// Not known yet, or a mistake that was reported: silent.
    Unknown,
}

/// A result that was not evaluated yet, or is a constant or a temporary.
#[derive(Clone)]
pub(super) struct Value {
    pub operand: Operand,
    /// The instructions that made it.
    pub span: Span,
    /// Operations in the expression.
    pub operations: u32,
}

/// What evaluating an expression can do and needs.
#[derive(Default)]
struct Facts<'e> {
    /// It calls a user's POU, which may write anything.
    calls: bool,
    /// It may end in a fault.
    faults: bool,
    reads: Vec<&'e Place>,
}

/// What a statement that uses the current result writes.
pub(super) enum Touches<'p> {
    Nothing,
    Place(&'p Place),
    Anything,
}

/// What a statement may change.
struct Effect<'s> {
    /// Anything.
    all: bool,
    writes: Vec<&'s Place>,
}

impl Value {
    pub fn new(operand: Operand, span: Span) -> Self {
        Self { operand, span, operations: 0 }
    }

    fn expr(&self) -> Option<&Expr> {
        match &self.operand {
            Operand::Value { expr, .. } => Some(expr),
            _ => None,
        }
    }

    /// Whether it can be evaluated twice as well as stored: a constant, a temporary, a variable.
    fn is_simple(&self) -> bool {
        self.expr().is_none_or(is_simple)
    }

    /// Whether it can be dropped without being evaluated, and evaluated later than it stands.
    fn is_pure(&self) -> bool {
        let facts = self.facts();
        !facts.calls && !facts.faults
    }

    fn facts(&self) -> Facts<'_> {
        let mut facts = Facts::default();
        if let Some(expr) = self.expr() {
            facts.of(expr);
        }
        facts
    }
}

fn is_simple(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Const(_) | ExprKind::String(_) | ExprKind::WString(_) | ExprKind::Temp(_) | ExprKind::Error => true,
        ExprKind::Read(place) => is_plain(place),
        ExprKind::Retype(inner) => is_simple(inner),
        _ => false,
    }
}

/// Whether reaching a place needs no check and reads no other variable.
pub(super) fn is_plain(place: &Place) -> bool {
    let steps = place.steps.iter().all(|s| match s {
        Step::Field(_) | Step::Member(_) | Step::Bit(_) | Step::Part(..) | Step::Flags(_) => true,
        Step::Index(indices, _) => indices.iter().all(|i| matches!(i.kind, ExprKind::Const(_))),
        Step::OpenIndex(..) | Step::Character { .. } | Step::Deref => false,
    });
    steps && !matches!(place.root, Root::Deref(_))
}

impl<'e> Facts<'e> {
    fn of(&mut self, expr: &'e Expr) {
        match &expr.kind {
            ExprKind::Const(_) | ExprKind::String(_) | ExprKind::WString(_) | ExprKind::Temp(_) | ExprKind::Error => {}
            ExprKind::Read(place) => {
                self.reads.push(place);
                self.of_path(place);
            }
            ExprKind::RefOf(place) => self.of_path(place),
            ExprKind::Op(op, elem, args) => {
                let constant = args.get(1).is_some_and(is_constant);
                self.faults |= match op {
                    Op::Div | Op::Mod | Op::TimeDiv => !elem.is_real() && !constant,
                    Op::Shl | Op::Shr | Op::Rol | Op::Ror => !constant,
                    _ => false,
                };
                args.iter().for_each(|a| self.of(a));
            }
            ExprKind::AndThen(a, b) | ExprKind::OrElse(a, b) => {
                self.of(a);
                self.of(b);
            }
            ExprKind::Convert(_, _, inner) | ExprKind::Retype(inner) => self.of(inner),
            ExprKind::RangeCheck { value, .. } => {
                self.faults = true;
                self.of(value);
            }
            ExprKind::Call(call) => {
                self.calls = true;
                call.inputs.iter().for_each(|(_, e)| self.of(e));
                call.in_outs.iter().for_each(|(_, p)| self.reads.push(p));
            }
            // It stores outputs.
            ExprKind::StdCall(_) => self.calls = true,
            ExprKind::Std { args, .. } => {
                self.faults = true;
                args.iter().for_each(|a| self.of(a));
            }
            ExprKind::Text { args, .. } => args.iter().for_each(|a| self.of(a)),
            ExprKind::Choose { selector, choices } => {
                self.of(selector);
                choices.iter().for_each(|c| self.of(c));
            }
        }
    }

    fn of_path(&mut self, place: &'e Place) {
        if let Root::Deref(reference) = &place.root {
            self.faults = true;
            self.of(reference);
        }
        for step in &place.steps {
            match step {
                Step::Deref => self.faults = true,
                Step::Character { index, .. } => {
                    self.faults = true;
                    self.of(index);
                }
                Step::OpenIndex(indices, _) => {
                    self.faults = true;
                    indices.iter().for_each(|i| self.of(&i.value));
                }
                Step::Index(indices, _) => {
                    self.faults |= !indices.iter().all(is_constant);
                    indices.iter().for_each(|i| self.of(i));
                }
                _ => {}
            }
        }
    }
}

fn is_constant(expr: &Expr) -> bool {
    matches!(expr.kind, ExprKind::Const(_))
}

impl<'s> Effect<'s> {
    fn of(stmts: &'s [Stmt]) -> Self {
        let mut effect = Self { all: false, writes: Vec::new() };
        stmts.iter().for_each(|s| effect.add(&s.kind));
        effect
    }

    fn of_kind(kind: &'s StmtKind) -> Self {
        let mut effect = Self { all: false, writes: Vec::new() };
        effect.add(kind);
        effect
    }

    fn add(&mut self, kind: &'s StmtKind) {
        match kind {
            StmtKind::Assign { target, value } => {
                self.evaluates(value);
                self.writes.push(target);
            }
            StmtKind::Eval(value) => self.evaluates(value),
            StmtKind::If { arms, otherwise } => {
                for (cond, body) in arms {
                    self.evaluates(cond);
                    body.iter().for_each(|s| self.add(&s.kind));
                }
                otherwise.iter().for_each(|s| self.add(&s.kind));
            }
            StmtKind::Jump(_, cond) => cond.iter().for_each(|c| self.evaluates(c)),
            StmtKind::Label(_) | StmtKind::Return => {}
            _ => self.all = true,
        }
    }

    fn evaluates(&mut self, value: &'s Expr) {
        let mut facts = Facts::default();
        facts.of(value);
        self.all |= facts.calls;
    }

    /// Whether what the expression gives could be another value behind the statement.
    fn changes(&self, facts: &Facts, defs: &Defs) -> bool {
        let mut reads = facts.reads.iter().filter(|r| !matches!(r.root, Root::Temp(_)));
        reads.any(|read| self.all || self.writes.iter().any(|written| may_overlap(read, written, defs)))
    }
}

/// Whether two places may be one memory: unless they begin at two variables that are surely apart.
fn may_overlap(a: &Place, b: &Place, defs: &Defs) -> bool {
    if matches!(a.root, Root::Temp(_)) || matches!(b.root, Root::Temp(_)) {
        return false;
    }
    match (apart(a, defs), apart(b, defs)) {
        (Some(x), Some(y)) => x == y,
        _ => true,
    }
}

/// The variable in whose memory, and nobody else's, a place lies.
fn apart(place: &Place, defs: &Defs) -> Option<crate::defs::VarId> {
    let Root::Var(var) = &place.root else { return None };
    let follows = place.steps.iter().any(|s| match s {
        Step::Deref => true,
        Step::Member(member) => defs.vars[*member].section == Section::InOut || defs.vars[*member].address.is_some(),
        _ => false,
    });
    let v = &defs.vars[*var];
    let own = !follows && v.section != Section::InOut && v.address.is_none();
    own.then_some(*var)
}

impl Il<'_, '_, '_> {
    /// The current result for an operation that makes a new one of it. `needs` names the operation in messages.
    pub fn take(&mut self, at: Span, needs: &str) -> Option<Value> {
        match std::mem::replace(&mut self.cr, Current::Unknown) {
            Current::Value(value) => match value.operand {
                Operand::Error => None,
                _ => Some(value),
            },
            Current::Unknown => None,
            Current::Nothing => {
                self.c.report(
                    Diagnostic::new(codes::NO_CR, at, format!("{needs} has no current result to work on"))
                        .help("load one before it: `LD x`"),
                );
                None
            }
            Current::Torn(label) => {
                self.report_torn(label, at, needs);
                None
            }
        }
    }

    /// Names the ways to a label on which the current result differs.
    fn report_torn(&mut self, label: usize, at: Span, needs: &str) {
        let name = match self.labels[label].name.as_str() {
            "" => "the end of the transition".to_string(),
            name => format!("label `{name}`"),
        };
        let message = format!("{needs} has no current result to work on: not all ways to {name} bring the same");
        let mut d = Diagnostic::new(codes::TORN_CR, at, message);
        let mut ways = self.labels[label].ways.clone();
        ways.sort_by_key(|w| w.0);
        for (_, from, way) in ways {
            use super::flow::Way;
            let text = match way {
                Way::Nothing => "from here: none".to_string(),
                Way::Int(v) => format!("from here: the number {v}"),
                Way::Real(v) => format!("from here: the number {v}"),
                Way::Typed(ty) => format!("from here: {}", self.c.cx.type_name(ty)),
                Way::Unknown => continue,
            };
            d = d.also(from, text);
        }
        self.c.report(d.help("load it again behind the label, or bring one type on all ways"));
    }

    /// The current result for a statement. Where it is `live` it stays current, and is stored first if it is not simple or
    /// if the statement could change it.
    pub fn use_current(&mut self, live: bool, touches: &Touches, at: Span, needs: &str) -> Option<Value> {
        if !live {
            return self.take(at, needs);
        }
        if let Current::Value(value) = &self.cr {
            let (all, writes) = match touches {
                Touches::Nothing => (false, Vec::new()),
                Touches::Place(place) => (false, vec![*place]),
                Touches::Anything => (true, Vec::new()),
            };
            let changes = Effect { all, writes }.changes(&value.facts(), &self.c.cx.defs);
            if changes || !value.is_simple() {
                self.store_current();
            }
        }
        let value = self.take(at, needs)?;
        self.cr = Current::Value(value.clone());
        Some(value)
    }

    /// Before a target whose path is evaluated before the value: a current result that could notice is stored.
    pub fn before_path(&mut self, target: &Place) {
        if let Current::Value(value) = &self.cr
            && !is_plain(target)
            && !value.is_pure()
        {
            self.store_current();
        }
    }

    /// Puts the current result into a temporary, unless it is a constant or in one already.
    pub fn store_current(&mut self) {
        let Current::Value(value) = std::mem::replace(&mut self.cr, Current::Unknown) else { return };
        let (value, stmt) = self.stored(value);
        if let Some(stmt) = stmt {
            self.emit(stmt.kind, stmt.span);
        }
        self.cr = Current::Value(value);
    }

    /// A value in a temporary, and the assignment to it.
    fn stored(&mut self, value: Value) -> (Value, Option<Stmt>) {
        let Operand::Value { expr, ty } = value.operand else { return (value, None) };
        let stays = matches!(
            expr.kind,
            ExprKind::Const(_) | ExprKind::Temp(_) | ExprKind::Error | ExprKind::String(_) | ExprKind::WString(_)
        );
        if stays || matches!(self.c.cx.defs.types.get(expr.ty), Type::Null | Type::Void | Type::Error) {
            return (Value { operand: Operand::Value { expr, ty }, ..value }, None);
        }
        if matches!(self.c.cx.defs.types.get(expr.ty), Type::AnyArray { .. }) {
            let message = "an ARRAY [*] cannot be kept as current result";
            self.c.report(
                Diagnostic::new(codes::NOT_WRITABLE, value.span, message)
                    .help("its size is that of the call; load its elements"),
            );
            return (Value { operand: Operand::Error, ..value }, None);
        }
        let temp = self.c.temps.push(expr.ty);
        let at = expr.span;
        let (kind, held) = (ExprKind::Temp(temp), expr.ty);
        let stmt = Stmt { kind: assign(temp, held, expr), span: at };
        let operand = Operand::Value { expr: Expr { kind, ty: held, span: at }, ty };
        (Value::new(operand, value.span), Some(stmt))
    }

    /// Stores what waits outside of parentheses where a statement could change it, or could come too early or too late.
    pub fn settle_open(&mut self, kind: &StmtKind) {
        let effect = Effect::of_kind(kind);
        let defs = &self.c.cx.defs;
        let last = self.open.iter().rposition(|v| {
            let facts = v.facts();
            facts.calls || facts.faults || effect.changes(&facts, defs)
        });
        self.store_open(last.map_or(0, |l| l + 1));
    }

    /// Stores the first `count` of what waits, in their order.
    fn store_open(&mut self, count: usize) {
        for n in 0..count {
            let placeholder = Value::new(Operand::Error, self.open[n].span);
            let value = std::mem::replace(&mut self.open[n], placeholder);
            let (value, stmt) = self.stored(value);
            self.out.extend(stmt);
            self.open[n] = value;
        }
    }

    /// The current result is not used any more: what evaluating it does (a call, a fault) is done.
    pub fn drop_current(&mut self, at: Span) {
        let Current::Value(value) = std::mem::replace(&mut self.cr, Current::Unknown) else { return };
        if !value.is_pure()
            && let Operand::Value { .. } = &value.operand
        {
            let expr = self.c.settle(value.operand, value.span);
            if expr.ty != Types::ERROR {
                self.emit(StmtKind::Eval(expr), at);
            }
        }
    }

    /// The current result before a statement that does not use it: stored if the statement could change it and it is `live`,
    /// evaluated if that does something.
    pub fn keep_current(&mut self, live: bool, stmts: &[Stmt], at: Span) {
        let Current::Value(value) = &self.cr else { return };
        if !live {
            return self.drop_current(at);
        }
        if !value.is_pure() || Effect::of(stmts).changes(&value.facts(), &self.c.cx.defs) {
            self.store_current();
        }
    }

    /// A new current result.
    pub fn set_current(&mut self, operand: Operand, span: Span, operations: u32) {
        self.cr = match operand {
            Operand::Error => Current::Unknown,
            operand => Current::Value(Value { operand, span, operations }),
        };
        if operations > MAX_OPERATIONS {
            self.store_current();
        }
    }

    /// The current result as a label finds it, and its temporary. Notes the way, which begins at `at`.
    pub fn bring(&mut self, label: usize, from_above: bool, at: Span) {
        self.note_way(label, from_above, at);
        if !self.labels[label].live {
            return;
        }
        let Entry::Typed(ty) = self.labels[label].entry else { return };
        let Current::Value(value) = std::mem::replace(&mut self.cr, Current::Unknown) else { return };
        let temp = *self.labels[label].temp.get_or_insert_with(|| self.c.temps.push(ty));
        let span = value.span;
        let constant = matches!(value.operand, Operand::Int(_) | Operand::Real(_));
        let kept = constant.then(|| value.clone());
        let expr = match value.operand {
            Operand::Value { .. } => {
                let expr = self.c.settle(value.operand, span);
                // Strings keep their own capacity; the assignment copies.
                if self.c.is_text(ty) { expr } else { retype(expr, ty) }
            }
            constant => self.c.coerce(constant, span, ty),
        };
        if expr.ty == Types::ERROR {
            return;
        }
        if !matches!(expr.kind, ExprKind::Temp(t) if t == temp) {
            self.emit(assign(temp, ty, expr), at);
        }
        // A constant may take another type where control goes on.
        self.cr = Current::Value(kept.unwrap_or_else(|| self.in_temp(temp, ty, span)));
    }

    /// The value of a temporary.
    pub fn in_temp(&self, temp: TempId, ty: TypeId, span: Span) -> Value {
        Value::new(Operand::Value { expr: Expr { kind: ExprKind::Temp(temp), ty, span }, ty }, span)
    }
}

fn assign(temp: TempId, ty: TypeId, value: Expr) -> StmtKind {
    let target = Place { root: Root::Temp(temp), steps: Vec::new(), ty, span: value.span };
    StmtKind::Assign { target, value }
}
