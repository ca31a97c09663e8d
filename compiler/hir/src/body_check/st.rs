//! Structured Text statements (semantics.md \[S1\]..\[S3\]).

use crate::body::*;
use crate::cx::*;
use crate::defs::*;
use crate::expr::*;
use crate::place::Found;
use crate::rules;
use crate::types::{Type, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::Elem;
use plcc_stdlib::ops::Op;
use plcc_syntax::ast;
use rustc_hash::{FxHashMap, FxHashSet};

mod case;

/// Checks a body in the scope of its POU.
pub(crate) fn check<'a>(cx: &mut Cx<'a>, scope: PouId, stmts: &'a [ast::Stmt]) -> Body {
    let mut st = St {
        c: Checker { cx, scope: Some(scope), temps: Default::default() },
        loops: Vec::new(),
        labels: FxHashMap::default(),
        outer: FxHashSet::default(),
        inner: FxHashSet::default(),
        label_count: 0,
    };
    st.declare_labels(stmts);
    let stmts = st.list(stmts);
    st.check_labels();
    Body { stmts, temps: st.c.temps, labels: st.label_count }
}

/// Checks statements that stand before the condition of a transition; labels are numbered from `labels` on.
pub(crate) fn check_part<'a>(c: &mut Checker<'_, 'a>, stmts: &'a [ast::Stmt], labels: &mut u32) -> Vec<Stmt> {
    let mut st = St {
        c: Checker { cx: &mut *c.cx, scope: c.scope, temps: std::mem::take(&mut c.temps) },
        loops: Vec::new(),
        labels: FxHashMap::default(),
        outer: FxHashSet::default(),
        inner: FxHashSet::default(),
        label_count: *labels,
    };
    st.declare_labels(stmts);
    let stmts = st.list(stmts);
    st.check_labels();
    *labels = st.label_count;
    c.temps = st.c.temps;
    stmts
}

/// A loop around the statement that is being checked.
struct Loop {
    /// The control variable of a FOR, and where it is named.
    var: Option<(VarId, Span)>,
    /// Where CONTINUE goes if the loop is not its own form (a FOR in its WHILE form).
    continue_to: Option<LabelId>,
}

struct Label {
    id: LabelId,
    declared: Option<Span>,
    used: Option<Span>,
}

struct St<'c, 'a> {
    c: Checker<'c, 'a>,
    loops: Vec<Loop>,
    labels: FxHashMap<smol_str::SmolStr, Label>,
    /// Where labels stand at the outermost level, and the names of others, which were reported.
    outer: FxHashSet<Span>,
    inner: FxHashSet<smol_str::SmolStr>,
    label_count: u32,
}

impl<'a> St<'_, 'a> {
    fn list(&mut self, stmts: &'a [ast::Stmt]) -> Vec<Stmt> {
        let mut out = Vec::with_capacity(stmts.len());
        for stmt in stmts {
            self.stmt(stmt, &mut out);
        }
        out
    }

    fn stmt(&mut self, stmt: &'a ast::Stmt, out: &mut Vec<Stmt>) {
        let span = stmt.span;
        let kind = match &stmt.kind {
            ast::StmtKind::Assign(target, value) => self.assign(target, value),
            ast::StmtKind::AssignAttempt(target, value) => self.attempt(target, value, span),
            ast::StmtKind::Bind(target, value) => self.bind(target, value, span),
            ast::StmtKind::Expr(e) => self.expr_statement(e),
            ast::StmtKind::If { arms, otherwise } => {
                let arms = arms.iter().map(|(cond, body)| (self.c.condition(cond), self.list(body))).collect();
                let otherwise = otherwise.as_deref().map(|b| self.list(b)).unwrap_or_default();
                Some(StmtKind::If { arms, otherwise })
            }
            ast::StmtKind::Case { selector, arms, otherwise } => self.case(selector, arms, otherwise.as_deref()),
            ast::StmtKind::For { var, from, to, by, body } => {
                return self.for_loop(var, from, to, by.as_ref(), body, span, out);
            }
            ast::StmtKind::While(cond, body) => {
                let cond = self.c.condition(cond);
                let body = self.looped(None, None, body);
                Some(StmtKind::While(cond, body))
            }
            ast::StmtKind::Repeat(body, until) => {
                let body = self.looped(None, None, body);
                let until = self.c.condition(until);
                Some(StmtKind::Repeat(body, until))
            }
            ast::StmtKind::Exit => self.in_loop("EXIT", span).then_some(StmtKind::Exit),
            ast::StmtKind::Continue => {
                if !self.in_loop("CONTINUE", span) {
                    None
                } else {
                    match self.loops.last().and_then(|l| l.continue_to) {
                        Some(label) => Some(StmtKind::Jump(label, None)),
                        None => Some(StmtKind::Continue),
                    }
                }
            }
            ast::StmtKind::Return => Some(StmtKind::Return),
            ast::StmtKind::Label(name) => self.label_here(name),
            ast::StmtKind::Jump(name) => self.jump(name),
            ast::StmtKind::Empty | ast::StmtKind::Error => None,
        };
        out.extend(kind.map(|kind| Stmt { kind, span }));
    }

    fn in_loop(&mut self, word: &str, span: Span) -> bool {
        if self.loops.is_empty() {
            self.c.report(
                Diagnostic::new(codes::OUTSIDE_LOOP, span, format!("{word} stands outside of any loop"))
                    .help("it belongs inside FOR, WHILE or REPEAT"),
            );
        }
        !self.loops.is_empty()
    }

    fn looped(&mut self, var: Option<(VarId, Span)>, continue_to: Option<LabelId>, body: &'a [ast::Stmt]) -> Vec<Stmt> {
        self.loops.push(Loop { var, continue_to });
        let body = self.list(body);
        self.loops.pop();
        body
    }

    fn assign(&mut self, target: &'a ast::Expr, value: &'a ast::Expr) -> Option<StmtKind> {
        if let Some(var) = self.untyped(target) {
            let value = self.c.any_value(value);
            self.c.cx.defs.vars[var].ty = value.ty;
            let place = self.target(target)?;
            return (value.ty != Types::ERROR).then_some(StmtKind::Assign { target: place, value });
        }
        let Some(place) = self.target(target) else {
            // Mistakes in the value are worth their own message.
            self.c.operand(value, None);
            return None;
        };
        let writable = self.c.check_writable(&place) && self.not_a_control_variable(&place);
        let mut value = self.c.value(value, place.ty);
        self.c.name_range_check(&mut value, &place);
        if value.ty == Types::ERROR || !writable || !self.c.assignable(&place) {
            return None;
        }
        Some(StmtKind::Assign { target: place, value })
    }

    /// The variable that a network declared for a value, if this is the first one that it takes.
    fn untyped(&self, target: &ast::Expr) -> Option<VarId> {
        let ast::ExprKind::Name(name) = &target.kind else { return None };
        if !name.text.starts_with('$') {
            return None;
        }
        let Found::Var(var) = self.c.lookup(name) else { return None };
        let (ty, _) = self.c.cx.var_slots[var].decl?;
        let inferred = matches!(ty.kind, ast::TypeExprKind::Inferred(_));
        (inferred && self.c.cx.defs.vars[var].ty == Types::ERROR).then_some(var)
    }

    /// `r ?= s`: the reference if it is one to the target's type, else NULL (\[R1\]). Without inheritance the types decide.
    fn attempt(&mut self, target: &'a ast::Expr, value: &'a ast::Expr, span: Span) -> Option<StmtKind> {
        let place = self.target(target);
        let mut value = self.c.any_value(value);
        let place = place?;
        let types = &self.c.cx.defs.types;
        let (to, from) = match (types.get(place.ty), types.get(value.ty)) {
            (_, Type::Error) => return None,
            (Type::Ref { target: to, .. }, Type::Ref { target: from, .. }) => (*to, *from),
            (Type::Ref { target: to, .. }, Type::Null) => (*to, *to),
            (to, _) => {
                let wrong = if matches!(to, Type::Ref { .. }) { value.ty } else { place.ty };
                let name = self.c.cx.type_name(wrong);
                self.c.report(
                    Diagnostic::new(codes::NOT_A_REFERENCE, span, format!("?= takes references, {name} is none"))
                        .help("write := for other values"),
                );
                return None;
            }
        };
        if !self.c.check_writable(&place) {
            return None;
        }
        if to != from {
            let (want, have) = (self.c.cx.type_name(to), self.c.cx.type_name(from));
            self.c.report(
                Diagnostic::new(codes::ATTEMPT_FAILS, span, format!("a reference to {have} is never one to {want}"))
                    .help("this assigns NULL; function blocks do not inherit here"),
            );
            value = Expr { kind: ExprKind::Const(0), ty: place.ty, span: value.span };
        }
        let value = crate::expr::retype(value, place.ty);
        Some(StmtKind::Assign { target: place, value })
    }

    /// `r REF= x`: what a REFERENCE TO refers to (\[R5\]).
    fn bind(&mut self, target: &'a ast::Expr, value: &'a ast::Expr, span: Span) -> Option<StmtKind> {
        let Some(place) = self.c.place_itself(target) else {
            self.c.operand(value, None);
            return None;
        };
        if !self.c.is_reference_to(place.ty) {
            let name = self.c.cx.type_name(place.ty);
            let help = match self.c.cx.defs.types.get(place.ty) {
                Type::Ref { .. } => "write `:= REF(...)` or `:= ADR(...)`",
                _ => "write `:=` to assign a value, or declare it as REFERENCE TO",
            };
            self.c.report(
                Diagnostic::new(codes::NOT_A_REFERENCE, span, format!("REF= binds a REFERENCE TO, {name} is none"))
                    .help(help),
            );
            return None;
        }
        let writable = self.c.check_writable(&place);
        let value = self.c.value(value, place.ty);
        (writable && value.ty != Types::ERROR).then_some(StmtKind::Assign { target: place, value })
    }

    /// The target of an assignment: a function assigns its result by its own name.
    fn target(&mut self, e: &'a ast::Expr) -> Option<Place> {
        self.c.place(e)
    }

    /// Assigning to a FOR variable inside its loop: an error in strict (\[S2\]).
    fn not_a_control_variable(&mut self, place: &Place) -> bool {
        let Some(var) = self.c.plain_var(place) else { return true };
        let Some((_, span)) = self.loops.iter().filter_map(|l| l.var).find(|(v, _)| *v == var) else { return true };
        let name = self.c.cx.defs.vars[var].name.clone();
        let strict = Diagnostic::new(
            codes::CONTROL_VARIABLE,
            place.span,
            format!("`{name}` is the control variable of this FOR and cannot be assigned in it"),
        )
        .also(span, "the loop counts with it here")
        .help("use EXIT to leave the loop, CONTINUE to skip a pass, or a WHILE loop");
        self.c.codesys_only(place.span, codes::LAX_CONTROL_VARIABLE, strict)
    }

    fn expr_statement(&mut self, e: &'a ast::Expr) -> Option<StmtKind> {
        match &e.kind {
            ast::ExprKind::Call(call) => {
                let kind = self.c.call_statement(call, e.span);
                if let Some(StmtKind::Call(call)) = &kind {
                    for output in &call.outputs {
                        self.not_a_control_variable(&output.target);
                    }
                }
                kind
            }
            // `act;` or `fb;`: without parentheses.
            ast::ExprKind::Name(name) => {
                let help = match self.c.lookup(name) {
                    Found::Action(_) | Found::Pou(_) => format!("a call needs parentheses: `{}();`", name.text),
                    Found::Var(var) if self.c.cx.instance_of(self.c.cx.defs.vars[var].ty).is_some() => {
                        format!("a call needs parentheses: `{}();`", name.text)
                    }
                    Found::Missing => {
                        self.c.unknown_name(name);
                        return None;
                    }
                    _ => format!("to assign a value write `{} := ...;`", name.text),
                };
                self.no_effect(e.span, help)
            }
            ast::ExprKind::Binary(ast::BinaryOp::Eq, at, ..) => {
                self.c.report(
                    Diagnostic::new(codes::NO_EFFECT, *at, "`=` compares; this statement has no effect")
                        .help("an assignment is written `:=`"),
                );
                None
            }
            ast::ExprKind::Error => None,
            _ => self.no_effect(e.span, "a statement assigns, calls or controls".into()),
        }
    }

    fn no_effect(&mut self, span: Span, help: String) -> Option<StmtKind> {
        self.c.report(Diagnostic::new(codes::NO_EFFECT, span, "this statement has no effect").help(help));
        None
    }

    #[allow(clippy::too_many_arguments)]
    fn for_loop(
        &mut self,
        var: &'a ast::Expr,
        from: &'a ast::Expr,
        to: &'a ast::Expr,
        by: Option<&'a ast::Expr>,
        body: &'a [ast::Stmt],
        span: Span,
        out: &mut Vec<Stmt>,
    ) {
        let place = self.c.place(var);
        let counter = place.as_ref().and_then(|p| self.c.plain_var(p));
        let elem = place.as_ref().and_then(|p| self.c.elem_of(p.ty));
        let int = elem.filter(|e| e.is_integer() || (e.is_bits() && self.c.codesys(span)));
        if let Some(place) = &place {
            if int.is_none() && place.ty != Types::ERROR {
                let ty = self.c.cx.type_name(place.ty);
                self.c.report(
                    Diagnostic::new(
                        codes::WRONG_OPERAND,
                        var.span,
                        format!("FOR counts with an integer, this is {ty}"),
                    )
                    .help("declare the control variable as INT or DINT"),
                );
            }
            self.c.check_writable(place);
            if let Some((_, outer)) = self.loops.iter().filter_map(|l| l.var).find(|(v, _)| Some(*v) == counter) {
                self.c.report(
                    Diagnostic::new(
                        codes::SHARED_CONTROL_VARIABLE,
                        var.span,
                        "this FOR counts with the control variable of an outer one",
                    )
                    .also(outer, "the outer loop counts with it here")
                    .help("use a variable of its own for each loop"),
                );
            }
        }
        // Bounds are values of the variable's base type; the check of a subrange happens where it is stored.
        let ty = int.map_or(Types::ERROR, Types::elem);
        let from = self.c.value(from, ty);
        let to = self.c.value(to, ty);
        let by = by.map(|e| (self.step(e, int), e.span));
        if let Some((Some(step), span)) = &by
            && matches!(step.kind, ExprKind::Const(0))
        {
            self.c.report(
                Diagnostic::new(codes::ZERO_STEP, *span, "a FOR with step 0 never ends").help("write BY 1 or BY -1"),
            );
        }
        let while_form = self.c.codesys(span) && counter.is_some_and(|v| self.assigns(body, v));
        let continue_to = while_form.then(|| self.new_label());
        let body = self.looped(counter.map(|v| (v, var.span)), continue_to, body);
        let (Some(place), Some(elem)) = (place, int) else { return };
        let bad = |e: &Expr| e.ty == Types::ERROR;
        if bad(&from) || bad(&to) || by.as_ref().is_some_and(|(b, _)| b.as_ref().is_none_or(bad)) {
            return;
        }
        let by = by.and_then(|(b, _)| b);
        match continue_to {
            None => out.push(Stmt { kind: StmtKind::For { var: place, from, to, by, body }, span }),
            Some(next) => self.while_form(place, elem, from, to, by, body, next, span, out),
        }
    }

    /// The step of a FOR: for an unsigned variable a negative constant has the signed type of its width.
    fn step(&mut self, e: &'a ast::Expr, elem: Option<Elem>) -> Option<Expr> {
        let elem = elem?;
        let operand = self.c.operand(e, Some(Types::elem(elem)));
        let ty = match operand {
            Operand::Int(v) if v < 0 && !elem.is_signed() => rules::integer(elem.bits(), true),
            _ => elem,
        };
        Some(self.c.coerce(operand, e.span, Types::elem(ty)))
    }

    /// A FOR whose variable its body assigns, in profile codesys: counts like the WHILE loop it abbreviates (\[P2\]).
    #[allow(clippy::too_many_arguments)]
    fn while_form(
        &mut self,
        var: Place,
        elem: Elem,
        from: Expr,
        to: Expr,
        by: Option<Expr>,
        body: Vec<Stmt>,
        next: LabelId,
        span: Span,
        out: &mut Vec<Stmt>,
    ) {
        let ty = Types::elem(elem);
        let bool_ty = Types::elem(Elem::Bool);
        let temp = |c: &mut Checker| c.temps.push(ty);
        let place = |t: TempId| Place { root: Root::Temp(t), steps: Vec::new(), ty, span };
        let read = |t: TempId| Expr { kind: ExprKind::Temp(t), ty, span };
        let stmt = |kind| Stmt { kind, span };
        let expr = |op, args, ty| Expr { kind: ExprKind::Op(op, elem, args), ty, span };
        let number = rules::as_number(elem);
        let compare = |op, args: Vec<Expr>| {
            let args = args.into_iter().map(|a| retype(a, Types::elem(number))).collect();
            Expr { kind: ExprKind::Op(op, number, args), ty: bool_ty, span }
        };
        let current = Expr { kind: ExprKind::Read(var.clone()), ty: var.ty, span };
        let current = retype(current, ty);
        let end = temp(&mut self.c);
        let negative = by.as_ref().is_some_and(|b| match b.kind {
            ExprKind::Const(raw) => self.c.elem_of(b.ty).unwrap_or(elem).to_i128(raw) < 0,
            _ => false,
        });
        let constant = by.as_ref().is_none_or(|b| matches!(b.kind, ExprKind::Const(_)));
        let step_temp = temp(&mut self.c);
        let one = Expr { kind: ExprKind::Const(1), ty, span };
        out.push(stmt(StmtKind::Assign { target: var.clone(), value: retype(from, var.ty) }));
        out.push(stmt(StmtKind::Assign { target: place(end), value: to }));
        out.push(stmt(StmtKind::Assign { target: place(step_temp), value: retype(by.unwrap_or(one), ty) }));
        let up = compare(Op::Le, vec![current.clone(), read(end)]);
        let down = compare(Op::Ge, vec![current.clone(), read(end)]);
        let cond = match (constant, negative) {
            (true, true) => down,
            (true, false) => up,
            (false, _) => {
                let zero = Expr { kind: ExprKind::Const(0), ty, span };
                let rising = compare(Op::Ge, vec![read(step_temp), zero.clone()]);
                let falling = compare(Op::Lt, vec![read(step_temp), zero]);
                let both =
                    |a: Expr, b: Expr| Expr { kind: ExprKind::AndThen(Box::new(a), Box::new(b)), ty: bool_ty, span };
                Expr {
                    kind: ExprKind::OrElse(Box::new(both(rising, up)), Box::new(both(falling, down))),
                    ty: bool_ty,
                    span,
                }
            }
        };
        let mut body = body;
        body.push(stmt(StmtKind::Label(next)));
        let sum =
            expr(Op::Add, vec![retype(current, Types::elem(number)), retype(read(step_temp), Types::elem(number))], ty);
        let sum = Expr {
            kind: match sum.kind {
                ExprKind::Op(op, _, args) => ExprKind::Op(op, number, args),
                k => k,
            },
            ..sum
        };
        body.push(stmt(StmtKind::Assign { target: var.clone(), value: retype(sum, var.ty) }));
        out.push(stmt(StmtKind::While(cond, body)));
    }

    /// Whether statements assign a variable directly.
    fn assigns(&self, stmts: &[ast::Stmt], var: VarId) -> bool {
        let is = |e: &ast::Expr| match &e.kind {
            ast::ExprKind::Name(name) => matches!(self.c.lookup(name), Found::Var(v) if v == var),
            _ => false,
        };
        stmts.iter().any(|s| match &s.kind {
            ast::StmtKind::Assign(target, _) | ast::StmtKind::AssignAttempt(target, _) => is(target),
            ast::StmtKind::Expr(ast::Expr { kind: ast::ExprKind::Call(call), .. }) => {
                call.args.iter().any(|a| matches!(&a.kind, ast::ArgKind::Output { target: Some(t), .. } if is(t)))
            }
            ast::StmtKind::If { arms, otherwise } => {
                arms.iter().any(|(_, b)| self.assigns(b, var))
                    || otherwise.as_deref().is_some_and(|b| self.assigns(b, var))
            }
            ast::StmtKind::Case { arms, otherwise, .. } => {
                arms.iter().any(|a| self.assigns(&a.body, var))
                    || otherwise.as_deref().is_some_and(|b| self.assigns(b, var))
            }
            ast::StmtKind::For { body, .. } | ast::StmtKind::While(_, body) | ast::StmtKind::Repeat(body, _) => {
                self.assigns(body, var)
            }
            _ => false,
        })
    }

    fn new_label(&mut self) -> LabelId {
        self.label_count += 1;
        LabelId::from_raw(self.label_count - 1)
    }

    /// Labels may be jumped to before they are written.
    fn declare_labels(&mut self, stmts: &'a [ast::Stmt]) {
        for stmt in stmts {
            let ast::StmtKind::Label(name) = &stmt.kind else { continue };
            let id = self.new_label();
            self.outer.insert(name.span);
            let label = Label { id, declared: Some(name.span), used: None };
            if let Some(first) = self.labels.insert(fold(&name.text), label) {
                self.c.report(
                    Diagnostic::new(
                        codes::DUPLICATE_NAME,
                        name.span,
                        format!("label `{}` is declared twice", name.text),
                    )
                    .also(first.declared.unwrap_or(name.span), "first declared here"),
                );
            }
        }
    }

    /// A label where it stands. One inside another statement is none: nothing could be said about the way to it.
    fn label_here(&mut self, name: &'a ast::Name) -> Option<StmtKind> {
        let label = self.labels.get(&fold(&name.text)).filter(|l| l.declared == Some(name.span));
        if let Some(label) = label {
            return Some(StmtKind::Label(label.id));
        }
        // One that is declared twice was reported; behind a mistake of syntax it may be the label of a CASE.
        let half_read = self.c.cx.half_read.contains(&name.span.file);
        if !self.outer.contains(&name.span) && !half_read {
            self.inner.insert(fold(&name.text));
            self.c.report(
                Diagnostic::new(
                    codes::UNKNOWN_LABEL,
                    name.span,
                    format!("the label `{}` stands inside another statement", name.text),
                )
                .help("a label stands at the outermost level of a body; jumps out of statements lead to it"),
            );
        }
        None
    }

    fn jump(&mut self, name: &'a ast::Name) -> Option<StmtKind> {
        match self.labels.get_mut(&fold(&name.text)) {
            Some(label) => {
                label.used = Some(name.span);
                Some(StmtKind::Jump(label.id, None))
            }
            None if self.inner.contains(&fold(&name.text)) => None,
            None => {
                let hint = similar(&name.text, self.labels.keys().map(|k| k.as_str()));
                self.c.report(
                    Diagnostic::new(codes::UNKNOWN_LABEL, name.span, format!("there is no label `{}`", name.text))
                        .help(match hint {
                            Some(near) => format!("did you mean `{near}`?"),
                            None => "a label stands at the outermost level of the same body: `name:`".into(),
                        }),
                );
                None
            }
        }
    }

    fn check_labels(&mut self) {
        let unused: Vec<Span> = self.labels.values().filter(|l| l.used.is_none()).filter_map(|l| l.declared).collect();
        for span in unused {
            self.c.report(Diagnostic::new(codes::UNUSED_LABEL, span, "no jump leads to this label").help("remove it"));
        }
    }
}
