//! One instruction after the other: what it makes of the current result, and which statement it becomes.

use super::Il;
use super::current::{Current, Touches, Value};
use super::flow::Entry;
use super::lines::{Line, What};
use super::words::needs;
use crate::body::*;
use crate::expr::Operand;
use crate::types::{Type, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::Elem;
use plcc_syntax::ast::{self, BinaryOp, UnaryOp};
use plcc_syntax::il_operators::When;

impl<'a> Il<'_, '_, 'a> {
    /// Translates instructions in order.
    pub fn lines(&mut self, lines: &[Line<'a>]) {
        let inner = !self.open.is_empty();
        for (n, line) in lines.iter().enumerate() {
            if !inner {
                self.at_line = n;
            }
            if let Some(label) = line.label {
                self.enter_label(label, line.span);
            }
            let instruction = !matches!(line.what, What::Nothing);
            if instruction && !self.reachable && !std::mem::replace(&mut self.told_unreachable, true) {
                self.c.report(
                    Diagnostic::new(codes::UNREACHABLE_INSTRUCTION, line.span, "this instruction is never reached")
                        .help("put a label in front of it that a jump names, or remove it"),
                );
            }
            self.line(line);
        }
    }

    pub fn line(&mut self, line: &Line<'a>) {
        match &line.what {
            What::Nothing => {}
            What::Bad => {
                self.drop_current(line.span);
                self.cr = Current::Unknown;
            }
            What::Load { negated, operand } => self.load(line, *negated, operand),
            What::Store { negated, operand, .. } => self.store(line, *negated, operand),
            What::Set { to, operand } => self.set(line, *to, operand),
            What::Not => self.not(line),
            What::Binary { op, negated, operand } => self.binary(line, *op, *negated, operand),
            What::Deferred { op, negated, inner, close } => self.deferred(line, *op, *negated, inner, *close),
            What::Jump { when, target } => self.jump(line, *when, *target),
            What::Return(when) => self.ret(line, *when),
            What::Call { when, callee, args } => self.call(line, *when, callee, args),
            What::Input { input, operand, pin } => self.input(line, *input, operand, pin),
            What::Function { name, args, takes, .. } => self.function(line, name, args, *takes),
            What::Formal(call) => self.formal(line, call),
        }
    }

    // ---- labels ----

    pub fn enter_label(&mut self, label: usize, at: Span) {
        self.drop_unreachable();
        if self.reachable {
            self.bring_from_above(label);
            if !self.labels[label].live {
                self.drop_current(at);
            }
        }
        self.reachable |= self.labels[label].used;
        self.dead_from = self.out.len();
        let id = self.labels[label].id;
        self.out.push(Stmt { kind: StmtKind::Label(id), span: at });
        self.cr = self.at_label(label);
    }

    /// The way from the instruction above a label.
    pub fn bring_from_above(&mut self, label: usize) {
        let from = match &self.cr {
            Current::Value(value) => value.span,
            _ => self.labels[label].at,
        };
        self.bring(label, true, from);
    }

    /// The current result behind a label.
    pub fn at_label(&mut self, label: usize) -> Current {
        match self.labels[label].entry {
            _ if !self.labels[label].live => Current::Unknown,
            Entry::Unknown => Current::Unknown,
            Entry::Torn => Current::Torn(label),
            Entry::Typed(ty) => {
                let temp = *self.labels[label].temp.get_or_insert_with(|| self.c.temps.push(ty));
                Current::Value(self.in_temp(temp, ty, self.labels[label].at))
            }
        }
    }

    /// Drops the statements that control does not reach.
    pub fn drop_unreachable(&mut self) {
        if !self.reachable {
            self.out.truncate(self.dead_from);
        }
    }

    /// Control goes elsewhere, always; what follows without a label is never reached.
    fn leave(&mut self) {
        if self.reachable {
            self.reachable = false;
            self.told_unreachable = false;
            self.dead_from = self.out.len();
        }
        self.cr = Current::Unknown;
    }

    // ---- values ----

    fn load(&mut self, line: &Line<'a>, negated: bool, operand: &'a ast::Expr) {
        self.drop_current(line.span);
        let value = self.operand(operand, line.want, &line.name);
        let value = if negated { self.negated(value, operand.span, line) } else { value };
        self.set_current(value, line.span, u32::from(negated));
    }

    /// The value of an operand.
    fn operand(&mut self, e: &'a ast::Expr, want: Option<TypeId>, operator: &str) -> Operand {
        let operand = self.c.operand(e, want);
        let Operand::Value { ty, .. } = &operand else { return operand };
        let Type::Instance(pou) = *self.c.cx.defs.types.get(*ty) else { return operand };
        let def = &self.c.cx.defs.pous[pou];
        let outputs = def.vars.iter().map(|v| &self.c.cx.defs.vars[*v]);
        let output = outputs.filter(|v| v.section == crate::defs::Section::Output).map(|v| v.name.clone()).next();
        let message = format!("{operator} needs a value; this is an instance of `{}`", def.name);
        let d = Diagnostic::new(codes::TYPE_MISMATCH, e.span, message)
            .help_if(output.map(|o| format!("name one of its outputs, such as `.{o}`; CAL calls it")));
        self.c.report(d);
        Operand::Error
    }

    fn negated(&mut self, value: Operand, at: Span, line: &Line) -> Operand {
        let first = self.c.cx.diags.count();
        let name = self.name_of(&value);
        let shown = Value::new(value.clone(), at);
        let result = self.c.unary_operand(UnaryOp::Not, value, at, at, line.want);
        let sides = self.sides(&shown, Some((at, name)));
        self.reword(first, line, &sides, needs(BinaryOp::And));
        result
    }

    fn not(&mut self, line: &Line<'a>) {
        let Some(value) = self.take(line.span, &line.name) else { return };
        let span = value.span.to(line.span);
        let operations = value.operations + 1;
        let result = self.complement(line, value);
        self.set_current(result, span, operations);
    }

    /// NOT of the current result.
    fn complement(&mut self, line: &Line, value: Value) -> Operand {
        let first = self.c.cx.diags.count();
        let sides = self.sides(&value, None);
        let result = self.c.unary_operand(UnaryOp::Not, value.operand, value.span, line.span, line.want);
        self.reword(first, line, &sides, needs(BinaryOp::And));
        result
    }

    fn binary(&mut self, line: &Line<'a>, op: BinaryOp, negated: bool, operand: &'a ast::Expr) {
        let left = self.take(line.span, &line.name);
        let compares = needs(op) == needs(BinaryOp::Eq) || needs(op) == needs(BinaryOp::Lt);
        let want = match &left {
            // The operand of a comparison may name a value of the current result's enumeration.
            Some(left) if compares => self.c.static_type(&left.operand),
            _ => line.want,
        };
        let right = self.operand(operand, want, &line.name);
        let right = if negated { self.negated(right, operand.span, line) } else { right };
        let Some(left) = left else { return };
        self.combine(line, op, left, Value { operations: u32::from(negated), ..Value::new(right, operand.span) });
    }

    fn combine(&mut self, line: &Line, op: BinaryOp, left: Value, right: Value) {
        let first = self.c.cx.diags.count();
        let operations = left.operations + right.operations + 1;
        let sides = self.sides(&left, Some((right.span, self.name_of(&right.operand))));
        let span = left.span.to(line.span);
        let spans = [left.span, right.span];
        let result = self.c.binary_operands(op, line.op, left.operand, right.operand, spans, line.span, line.want);
        self.reword(first, line, &sides, needs(op));
        self.set_current(result, span, operations);
    }

    fn deferred(&mut self, line: &Line<'a>, op: BinaryOp, negated: bool, inner: &[Line<'a>], close: Span) {
        let left = self.take(line.op, &line.name);
        let known = left.is_some();
        // A mistake to the left does not hide those in the parenthesis.
        self.open.push(left.unwrap_or_else(|| Value::new(Operand::Int(0), line.op)));
        self.cr = Current::Nothing;
        self.lines(inner);
        let right = self.take(close, "`)`");
        let left = self.open.pop();
        let (Some(left), Some(right), true) = (left, right, known) else {
            self.cr = Current::Unknown;
            return;
        };
        let right = match negated {
            true => {
                let operations = right.operations + 1;
                let span = right.span;
                Value { operand: self.negated(right.operand, span, line), span, operations }
            }
            false => right,
        };
        self.combine(line, op, left, right);
    }

    // ---- stores ----

    fn store(&mut self, line: &Line<'a>, negated: bool, operand: &'a ast::Expr) {
        let Some(place) = self.c.place(operand) else {
            self.take_or_keep(line);
            return;
        };
        let writable = self.c.check_writable(&place);
        self.before_path(&place);
        let Some(value) = self.use_current(line.live, &Touches::Place(&place), line.span, &line.name) else { return };
        let span = value.span.to(line.span);
        let (ty, target) = (place.ty, (operand.span, self.c.cx.type_name(place.ty)));
        let sides = self.sides(&value, Some((target.0, format!("`{}` is {}", self.c.place_text(&place), target.1))));
        let value = match negated {
            true => Value { operand: self.complement(line, value.clone()), ..value },
            false => value,
        };
        let first = self.c.cx.diags.count();
        let needed = format!("{} to store it here", target.1);
        let mut value = self.c.coerce(value.operand, span, ty);
        self.reword(first, line, &sides, &needed);
        value.span = line.span;
        self.c.name_range_check(&mut value, &place);
        if value.ty == Types::ERROR || !writable || !self.c.assignable(&place) {
            return;
        }
        self.emit(StmtKind::Assign { target: place, value }, line.span);
    }

    /// The current result behind an instruction whose operand is a mistake.
    fn take_or_keep(&mut self, line: &Line) {
        if let Some(value) = self.take(line.span, &line.name) {
            self.cr = Current::Value(value);
        }
    }

    fn set(&mut self, line: &Line<'a>, to: bool, operand: &'a ast::Expr) {
        let bool_ty = Types::elem(Elem::Bool);
        let Some(place) = self.c.place(operand) else {
            self.take_or_keep(line);
            return;
        };
        let writable = self.c.check_writable(&place);
        if self.c.elem_of(place.ty) != Some(Elem::Bool) {
            let name = self.c.cx.type_name(place.ty);
            let message = format!("this operand is {name}; {} needs a BOOL variable", line.name);
            let help = match self.c.cx.defs.types.get(place.ty) {
                Type::Instance(_) => format!("it has no input `{}`; CAL calls it", line.name),
                _ => "S and R set and reset BOOL variables; ST stores other values".to_string(),
            };
            self.c.report(Diagnostic::new(codes::WRONG_OPERAND, operand.span, message).help(help));
            self.take_or_keep(line);
            return;
        }
        let Some(cond) = self.truth(line, When::True, &Touches::Place(&place)) else { return };
        if !writable {
            return;
        }
        let value = Expr { kind: ExprKind::Const(u64::from(to)), ty: bool_ty, span: line.span };
        let body = vec![Stmt { kind: StmtKind::Assign { target: place, value }, span: line.span }];
        self.emit(StmtKind::If { arms: vec![(cond, body)], otherwise: Vec::new() }, line.span);
    }

    // ---- conditions ----

    /// The current result as a condition; negated for the modifier CN. `touches` is what the conditional statement
    /// writes.
    pub fn truth(&mut self, line: &Line, when: When, touches: &Touches) -> Option<Expr> {
        let bool_ty = Types::elem(Elem::Bool);
        let value = self.use_current(line.live, touches, line.span, &line.name)?;
        let first = self.c.cx.diags.count();
        let sides = self.sides(&value, None);
        let negated = match when {
            When::False if self.c.static_type(&value.operand).is_none_or(|t| self.c.elem_of(t) == Some(Elem::Bool)) => {
                self.c.unary_operand(UnaryOp::Not, value.operand, value.span, line.span, Some(bool_ty))
            }
            _ => value.operand,
        };
        let cond = self.c.coerce(negated, value.span, bool_ty);
        self.reword(first, line, &sides, "BOOL");
        if cond.ty == Types::ERROR {
            self.cr = Current::Unknown;
            return None;
        }
        Some(cond)
    }

    fn jump(&mut self, line: &Line<'a>, when: When, target: Option<usize>) {
        let Some(target) = target else {
            match when {
                When::Always => self.leave_after_mistake(line),
                _ => self.take_or_keep(line),
            }
            return;
        };
        if when == When::Always {
            return self.jump_always(line, target);
        }
        self.jump_if(line, when, target);
    }

    /// A jump to nowhere: what follows is not called unreachable as well.
    fn leave_after_mistake(&mut self, line: &Line) {
        self.drop_current(line.span);
        self.cr = Current::Unknown;
    }

    fn jump_always(&mut self, line: &Line, target: usize) {
        if self.reachable {
            self.bring(target, false, line.span);
        }
        if !self.labels[target].live {
            self.drop_current(line.span);
        }
        let id = self.labels[target].id;
        self.emit(StmtKind::Jump(id, None), line.span);
        self.leave();
    }

    fn jump_if(&mut self, line: &Line, when: When, target: usize) {
        if self.reachable && matches!(self.cr, Current::Value(_)) {
            self.bring(target, false, line.span);
        }
        // What the jump leads to may write anything, but the current result of that way is stored already.
        let Some(cond) = self.truth(line, when, &Touches::Nothing) else { return };
        let id = self.labels[target].id;
        self.emit(StmtKind::Jump(id, Some(cond)), line.span);
    }

    fn ret(&mut self, line: &Line<'a>, when: When) {
        if let Some(end) = self.end {
            self.labels[end].used = true;
            return match when {
                When::Always => self.jump_always(line, end),
                _ => self.jump_if(line, when, end),
            };
        }
        let leave = Stmt { kind: StmtKind::Return, span: line.span };
        if when == When::Always {
            self.drop_current(line.span);
            self.emit(leave.kind, leave.span);
            return self.leave();
        }
        let Some(cond) = self.truth(line, when, &Touches::Nothing) else { return };
        self.emit(StmtKind::If { arms: vec![(cond, vec![leave])], otherwise: Vec::new() }, line.span);
    }
}
