//! Instructions by the table of operators: which operator, which operand, which label. Reports what is none.

use crate::body::Place;
use crate::call::Target;
use crate::cx::{fold, similar};
use crate::defs::{PouKind, Section, VarId};
use crate::expr::Checker;
use crate::types::TypeId;
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::funcs::StdFn;
use plcc_syntax::ast::print::print_expr;
use plcc_syntax::ast::{self, BinaryOp, ExprKind};
use plcc_syntax::il_operators::{self, Meaning, Operator, When};
use rustc_hash::{FxHashMap, FxHashSet};
use smol_str::SmolStr;

/// An instruction.
pub(super) struct Line<'a> {
    /// The label in front of it, by number.
    pub label: Option<usize>,
    pub what: What<'a>,
    /// The operator as messages name it.
    pub name: SmolStr,
    /// The operator's place.
    pub op: Span,
    /// From the operator to the end of its operands.
    pub span: Span,
    /// The current result is used behind it (`flow`).
    pub live: bool,
    /// The type that the next place asks for which uses the current result (`flow`).
    pub want: Option<TypeId>,
}

/// What an instruction does.
pub(super) enum What<'a> {
    /// A label alone.
    Nothing,
    /// A mistake that was reported.
    Bad,
    Load {
        negated: bool,
        operand: &'a ast::Expr,
    },
    Store {
        negated: bool,
        operand: &'a ast::Expr,
        /// The variable's type, if it is a variable.
        ty: Option<TypeId>,
    },
    Set {
        to: bool,
        operand: &'a ast::Expr,
    },
    Not,
    Binary {
        op: BinaryOp,
        negated: bool,
        operand: &'a ast::Expr,
    },
    Deferred {
        op: BinaryOp,
        negated: bool,
        inner: Vec<Line<'a>>,
        close: Span,
    },
    Jump {
        when: When,
        /// `None` if there is no such label; reported.
        target: Option<usize>,
    },
    Return(When),
    Call {
        when: When,
        callee: &'a ast::Expr,
        args: &'a [ast::Arg],
    },
    /// Stores the current result in an input of an instance and calls it.
    Input {
        input: VarId,
        operand: &'a ast::Expr,
        pin: &'a ast::Name,
    },
    /// A function by its name: the current result is the first argument, if it takes any.
    Function {
        name: &'a ast::Name,
        args: &'a [ast::Arg],
        takes: bool,
        /// The type it asks of the current result.
        wants: FirstArgument,
    },
    /// A function in formal form.
    Formal(&'a ast::Call),
}

/// The type that a function asks of its first argument.
#[derive(Debug, Clone, Copy)]
pub(super) enum FirstArgument {
    /// This one, or any.
    Fixed(Option<TypeId>),
    /// What the place of its own result asks for.
    AsResult,
}

/// A label as it is written.
pub(super) struct Found {
    pub name: String,
    pub at: Span,
    pub used: bool,
}

/// Reads the instructions of a body.
pub(super) fn read<'a>(c: &mut Checker<'_, 'a>, body: &'a ast::IlBody) -> (Vec<Line<'a>>, Vec<Found>) {
    let mut reader =
        Reader { c, labels: Vec::new(), by_name: FxHashMap::default(), inner_labels: FxHashMap::default() };
    reader.declare(body);
    reader.declare_inner(body);
    let lines = reader.lines(body, false);
    reader.unused_labels();
    reader.labels_in_parentheses();
    let labels = reader.labels;
    super::stn::warn(c, &lines);
    (lines, labels)
}

struct Reader<'k, 'c, 'a> {
    c: &'k mut Checker<'c, 'a>,
    labels: Vec<Found>,
    by_name: FxHashMap<SmolStr, usize>,
    /// Labels inside of parentheses, where no jump may lead, and whether one does.
    inner_labels: FxHashMap<SmolStr, (Span, bool)>,
}

impl<'a> Reader<'_, '_, 'a> {
    fn declare(&mut self, body: &'a ast::IlBody) {
        for name in body.lines.iter().filter_map(|l| l.label.as_ref()) {
            if let Some(&first) = self.by_name.get(&fold(&name.text)) {
                let first = self.labels[first].at;
                self.c.report(
                    Diagnostic::new(
                        codes::DUPLICATE_NAME,
                        name.span,
                        format!("label `{}` is declared twice", name.text),
                    )
                    .also(first, "first declared here")
                    .help("a label stands once in a body"),
                );
                continue;
            }
            self.by_name.insert(fold(&name.text), self.labels.len());
            self.labels.push(Found { name: name.text.to_string(), at: name.span, used: false });
        }
    }

    fn declare_inner(&mut self, body: &'a ast::IlBody) {
        for line in &body.lines {
            let Some(ast::IlInst::Deferred { body, .. }) = &line.inst else { continue };
            for name in body.lines.iter().filter_map(|l| l.label.as_ref()) {
                self.inner_labels.insert(fold(&name.text), (name.span, false));
            }
            self.declare_inner(body);
        }
    }

    /// Labels in parentheses to which no jump leads: a jump has its own message.
    fn labels_in_parentheses(&mut self) {
        let alone = self.inner_labels.values().filter(|(_, told)| !told).map(|(at, _)| *at);
        for at in alone.collect::<Vec<Span>>() {
            self.c.report(
                Diagnostic::new(codes::PARENTHESIS_LABEL, at, "a label stands inside of a parenthesis")
                    .help("no jump may lead into a parenthesis or out of it; put the label before it"),
            );
        }
    }

    fn similar_function(&self, name: &str) -> Option<String> {
        let pous = self.c.cx.pous.iter().filter(|(_, p)| self.c.cx.defs.pous[**p].kind == PouKind::Function);
        let mut names: Vec<&str> = pous.map(|(n, _)| n.as_str()).collect();
        for name in plcc_stdlib::funcs::names() {
            names.push(name);
        }
        similar(name, names.into_iter())
    }

    fn unused_labels(&mut self) {
        let unused: Vec<Span> = self.labels.iter().filter(|l| !l.used).map(|l| l.at).collect();
        for span in unused {
            self.c.report(Diagnostic::new(codes::UNUSED_LABEL, span, "no jump leads to this label").help("remove it"));
        }
    }

    fn lines(&mut self, body: &'a ast::IlBody, inner: bool) -> Vec<Line<'a>> {
        let mut lines = Vec::with_capacity(body.lines.len());
        let mut seen = FxHashSet::default();
        for line in &body.lines {
            let mut label = match &line.label {
                Some(name) if !inner => self.by_name.get(&fold(&name.text)).copied(),
                _ => None,
            };
            // Of two labels of one name the first counts.
            if label.is_some_and(|l| line.label.as_ref().is_some_and(|n| n.span != self.labels[l].at)) {
                label = None;
            }
            label = label.filter(|l| seen.insert(*l));
            let (name, op, span) = match &line.inst {
                None | Some(ast::IlInst::Error) => (SmolStr::default(), line.span, line.span),
                Some(ast::IlInst::Function(call)) => {
                    let name = match &call.callee.kind {
                        ExprKind::Name(name) => fold(&name.text),
                        _ => SmolStr::default(),
                    };
                    (name, call.callee.span, call.callee.span.to(call.parens))
                }
                Some(
                    ast::IlInst::Simple { op, .. } | ast::IlInst::Deferred { op, .. } | ast::IlInst::Call { op, .. },
                ) => {
                    let end = Span { end: line.span.end, ..op.span };
                    (fold(&op.text), op.span, end)
                }
            };
            let what = match &line.inst {
                None => What::Nothing,
                Some(inst) => self.instruction(inst, inner),
            };
            lines.push(Line { label, what, name, op, span, live: false, want: None });
        }
        lines
    }

    fn instruction(&mut self, inst: &'a ast::IlInst, inner: bool) -> What<'a> {
        match inst {
            ast::IlInst::Error => What::Bad,
            ast::IlInst::Simple { op, operands } => self.simple(op, operands, inner),
            ast::IlInst::Deferred { op, first, body, close } => self.deferred(op, first.as_ref(), body, *close),
            ast::IlInst::Call { op, call } => match il_operators::find(&op.text).map(|o| o.meaning) {
                Some(Meaning::Call(when)) => What::Call { when, callee: &call.callee, args: &call.args },
                _ => What::Bad,
            },
            ast::IlInst::Function(call) => self.formal(call),
        }
    }

    fn deferred(
        &mut self,
        op: &'a ast::Name,
        first: Option<&'a ast::Expr>,
        body: &'a ast::IlBody,
        close: Span,
    ) -> What<'a> {
        let Some(Meaning::Binary { op: meaning, negated }) = il_operators::find(&op.text).map(|o| o.meaning) else {
            return What::Bad;
        };
        let mut inner = Vec::with_capacity(body.lines.len() + 1);
        if let Some(operand) = first {
            let what =
                if self.is_operand(operand, &op.text) { What::Load { negated: false, operand } } else { What::Bad };
            let (name, at) = ("LD".into(), operand.span);
            inner.push(Line { label: None, what, name, op: at, span: at, live: false, want: None });
        }
        inner.extend(self.lines(body, true));
        if inner.is_empty() {
            self.c.report(
                Diagnostic::new(codes::MISSING_IL_OPERAND, op.span.to(close), "there is nothing in this parenthesis")
                    .help(format!("write an operand behind `{}(`, or `LD` on the next line", op.text)),
            );
            return What::Bad;
        }
        What::Deferred { op: meaning, negated, inner, close }
    }

    fn simple(&mut self, op: &'a ast::Name, operands: &'a [ast::Arg], inner: bool) -> What<'a> {
        if let [operand] = operands
            && let Some(operand) = positional(operand)
            && let Some(input) = self.input_operator(op, operand)
        {
            return input;
        }
        match il_operators::find(&op.text) {
            Some(operator) => self.operator(operator, op, operands, inner),
            None => self.function(op, operands, inner),
        }
    }

    /// `IN t`, `S rs`: the operand is an instance with that input.
    fn input_operator(&mut self, op: &'a ast::Name, operand: &'a ast::Expr) -> Option<What<'a>> {
        il_operators::find_input(&op.text)?;
        let place = self.quiet_place(operand)?;
        let pou = self.c.cx.instance_of(place.ty)?;
        let trial = self.c.cx.trial();
        let key = self.c.pin_name(pou, op);
        self.c.cx.undo(trial);
        let vars = self.c.cx.defs.pous[pou].vars.iter().copied();
        let mut inputs = vars.filter(|v| self.c.cx.defs.vars[*v].section == Section::Input);
        let input = inputs.find(|v| fold(&self.c.cx.defs.vars[*v].name) == key);
        if let Some(input) = input {
            return Some(What::Input { input, operand, pin: op });
        }
        if il_operators::find(&op.text).is_some() {
            return None;
        }
        let def = &self.c.cx.defs.pous[pou];
        let inputs = def.vars.iter().map(|v| &self.c.cx.defs.vars[*v]).filter(|v| v.section == Section::Input);
        let inputs: Vec<String> = inputs.map(|v| v.name.to_string()).collect();
        let message = format!("`{}` has no input `{}`", def.name, op.text);
        self.c.report(
            Diagnostic::new(codes::UNKNOWN_PARAMETER, op.span, message)
                .also(operand.span, "this is an instance")
                .help(format!("its inputs are {}", inputs.join(", "))),
        );
        Some(What::Bad)
    }

    /// The place that an operand names, without messages.
    fn quiet_place(&mut self, e: &'a ast::Expr) -> Option<Place> {
        let trial = self.c.cx.trial();
        let place = self.c.place(e);
        self.c.cx.undo(trial);
        place
    }

    fn operator(
        &mut self,
        operator: &'static Operator,
        op: &'a ast::Name,
        operands: &'a [ast::Arg],
        inner: bool,
    ) -> What<'a> {
        if let (Meaning::Jump(_) | Meaning::Return(_), true) = (operator.meaning, inner) {
            self.c.report(
                Diagnostic::new(
                    codes::PARENTHESIS_LABEL,
                    op.span,
                    format!("{} cannot stand inside of a parenthesis", operator.name),
                )
                .help("no jump may lead into a parenthesis or out of it; close it first"),
            );
            return What::Bad;
        }
        let operand = match (operator.meaning, operands) {
            (Meaning::Not, []) => return What::Not,
            (Meaning::Return(when), []) => return What::Return(when),
            (Meaning::Not | Meaning::Return(_), [first, ..]) => {
                self.c.report(
                    Diagnostic::new(
                        codes::TOO_MANY_OPERANDS,
                        first.span,
                        format!("{} stands without an operand", operator.name),
                    )
                    .help(match operator.meaning {
                        Meaning::Not => "it negates the current result; LDN loads a negated operand",
                        _ => "it leaves the POU; a function gives the value that was stored under its name",
                    }),
                );
                return What::Bad;
            }
            (_, []) => {
                self.missing_operand(operator, op);
                return What::Bad;
            }
            (_, [operand]) => operand,
            (_, [first, second, ..]) => {
                let message = format!("{} takes one operand", operator.name);
                let help = match (operator.meaning, positional(first), positional(second)) {
                    (Meaning::Binary { .. }, Some(a), Some(b)) => {
                        let (a, b) = (print_expr(a), print_expr(b));
                        format!("the current result is its other one: write `LD {a}`, then `{} {b}`", operator.name)
                    }
                    _ => "write one instruction per line".to_string(),
                };
                self.c.report(Diagnostic::new(codes::TOO_MANY_OPERANDS, second.span, message).help(help));
                return What::Bad;
            }
        };
        let Some(operand) = positional(operand) else { return What::Bad };
        if matches!(operand.kind, ExprKind::Error) {
            return What::Bad;
        }
        match operator.meaning {
            Meaning::Jump(when) => self.jump(when, op, operand),
            Meaning::Call(when) => What::Call { when, callee: operand, args: &[] },
            _ if !self.is_operand(operand, operator.name) => What::Bad,
            Meaning::Load { negated } => What::Load { negated, operand },
            Meaning::Store { negated } => What::Store { negated, operand, ty: self.quiet_place(operand).map(|p| p.ty) },
            Meaning::Set(to) => What::Set { to, operand },
            Meaning::Binary { op, negated } => What::Binary { op, negated, operand },
            Meaning::Not | Meaning::Return(_) => What::Bad,
        }
    }

    fn missing_operand(&mut self, operator: &Operator, op: &ast::Name) {
        self.c.report(
            Diagnostic::new(codes::MISSING_IL_OPERAND, op.span, format!("{} needs an operand", operator.name))
                .help(format!("behind it stands {}", operator.operand)),
        );
    }

    /// Whether an expression can be an operand: a variable or a constant. Reports it if not.
    fn is_operand(&mut self, e: &'a ast::Expr, operator: &str) -> bool {
        let fine = match &e.kind {
            ExprKind::Unary(ast::UnaryOp::Neg | ast::UnaryOp::Plus, inner) => {
                matches!(inner.kind, ExprKind::Literal(_))
            }
            ExprKind::Unary(..) | ExprKind::Binary(..) | ExprKind::Call(_) => false,
            _ => true,
        };
        if fine {
            return true;
        }
        let help = match &e.kind {
            ExprKind::Call(_) => "a function is an operator of its own, on its own line".to_string(),
            ExprKind::Unary(ast::UnaryOp::Not, _) => match il_operators::find(&format!("{operator}N")) {
                Some(negated) => format!("write `{}`", negated.name),
                None => "put `NOT` on a line of its own".to_string(),
            },
            ExprKind::Binary(op, ..) => format!("`{}` is an instruction of its own, on its own line", op.text()),
            _ => "load and negate it on lines of their own".to_string(),
        };
        self.c.report(
            Diagnostic::new(codes::EXPRESSION_OPERAND, e.span, "an operand of IL is a variable or a constant")
                .help(help),
        );
        false
    }

    fn jump(&mut self, when: When, op: &'a ast::Name, operand: &'a ast::Expr) -> What<'a> {
        let ExprKind::Name(name) = &operand.kind else {
            self.c.report(
                Diagnostic::new(codes::UNKNOWN_LABEL, operand.span, format!("{} needs the name of a label", op.text))
                    .help("write the label's name; it stands with `:` in front of an instruction"),
            );
            return What::Jump { when, target: None };
        };
        let key = fold(&name.text);
        if let Some(&label) = self.by_name.get(&key) {
            self.labels[label].used = true;
            return What::Jump { when, target: Some(label) };
        }
        if let Some((at, told)) = self.inner_labels.get_mut(&key) {
            *told = true;
            let at = *at;
            self.c.report(
                Diagnostic::new(codes::PARENTHESIS_JUMP, name.span, "this jump leads into a parenthesis")
                    .also(at, "the label")
                    .help("a parenthesis is evaluated as a whole; put the label before it"),
            );
            return What::Jump { when, target: None };
        }
        let hint = similar(&name.text, self.labels.iter().map(|l| l.name.as_str()));
        self.c.report(
            Diagnostic::new(codes::UNKNOWN_LABEL, name.span, format!("there is no label `{}`", name.text)).help(
                match hint {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => {
                        format!("a label stands in front of an instruction of the same body: `{}: LD x`", name.text)
                    }
                },
            ),
        );
        What::Jump { when, target: None }
    }

    /// An instruction whose first word is no operator.
    fn function(&mut self, name: &'a ast::Name, args: &'a [ast::Arg], inner: bool) -> What<'a> {
        let trial = self.c.cx.trial();
        let target = self.c.named_callee(name);
        self.c.cx.undo(trial);
        match target {
            Target::User(_, pou) if self.c.cx.defs.pous[pou].kind == PouKind::Function => {
                let vars = self.c.cx.defs.pous[pou].vars.clone();
                let is_input =
                    |c: &Checker, v: &VarId| matches!(c.cx.defs.vars[*v].section, Section::Input | Section::InOut);
                let first = vars.into_iter().find(|v| is_input(self.c, v));
                let wants = FirstArgument::Fixed(first.map(|v| self.c.type_of_var(v)));
                What::Function { name, args, takes: first.is_some(), wants }
            }
            Target::User(..) => {
                self.not_an_operator(name);
                What::Bad
            }
            Target::Standard(func) => {
                What::Function { name, args, takes: func.param_type(0).is_some(), wants: first_argument(func) }
            }
            Target::Special(_) => {
                self.c.report(
                    Diagnostic::new(codes::UNKNOWN_OPERATOR, name.span, format!("{} takes a variable", name.text))
                        .help(format!("write `{}(variable)`", name.text)),
                );
                What::Bad
            }
            Target::Reported => self.unknown_operator(name, args, inner),
        }
    }

    fn formal(&mut self, call: &'a ast::Call) -> What<'a> {
        let ExprKind::Name(name) = &call.callee.kind else { return What::Bad };
        let trial = self.c.cx.trial();
        let target = self.c.named_callee(name);
        self.c.cx.undo(trial);
        match target {
            Target::User(_, pou) if self.c.cx.defs.pous[pou].kind != PouKind::Function => {
                self.not_an_operator(name);
                What::Bad
            }
            _ => What::Formal(call),
        }
    }

    /// `t(IN := a)` for `CAL t(IN := a)`.
    fn not_an_operator(&mut self, name: &ast::Name) {
        self.c.report(
            Diagnostic::new(codes::UNKNOWN_OPERATOR, name.span, format!("`{}` is no operator", name.text))
                .help(format!("an instance or an action is called with CAL: `CAL {}`", name.text)),
        );
    }

    fn unknown_operator(&mut self, name: &'a ast::Name, args: &'a [ast::Arg], inner: bool) -> What<'a> {
        // An operator of that kind is meant, such as JMPC by JPMC; what it does to the labels is not reported again.
        let operators = il_operators::OPERATORS.iter().map(|o| o.name);
        let meant = similar(&name.text, operators).filter(|_| name.text.chars().count() > 1);
        let hint = meant.clone().or_else(|| self.similar_function(&name.text));
        let input = il_operators::find_input(&name.text);
        let help = match (input, hint) {
            (Some(input), _) => {
                format!("`{}` is an input operator: behind it stands an instance of {}", input.name, input.of)
            }
            (None, Some(near)) => format!("did you mean `{near}`?"),
            (None, None) => "an instruction begins with an operator or the name of a function".to_string(),
        };
        self.c.report(
            Diagnostic::new(codes::UNKNOWN_OPERATOR, name.span, format!("there is no operator `{}`", name.text))
                .help(help),
        );
        match (input, meant.as_deref().and_then(il_operators::find)) {
            (None, Some(operator)) if matches!(operator.meaning, Meaning::Jump(_)) => {
                let trial = self.c.cx.trial();
                let what = self.operator(operator, name, args, inner);
                self.c.cx.undo(trial);
                what
            }
            _ => What::Bad,
        }
    }
}

fn positional(arg: &ast::Arg) -> Option<&ast::Expr> {
    match &arg.kind {
        ast::ArgKind::Positional(e) => Some(e),
        ast::ArgKind::Input(..) | ast::ArgKind::Output { .. } => None,
    }
}

/// The type that a standard function asks of its first argument.
fn first_argument(func: &StdFn) -> FirstArgument {
    use crate::types::Types;
    use plcc_stdlib::funcs::Type;
    match (func.param_type(0), func.bound, func.result) {
        (Some(Type::Fixed(elem)), ..) | (Some(Type::Var), Some(elem), _) => {
            FirstArgument::Fixed(Some(Types::elem(elem)))
        }
        (Some(Type::Var), None, Type::Var) => FirstArgument::AsResult,
        _ => FirstArgument::Fixed(None),
    }
}
