//! Statements, instructions and the parts of a chart.

use super::{CaseItem, Context, SfcItem};
use crate::ast::*;
use crate::il_operators::{self, Meaning};
use plcc_diag::{Span, codes};

/// Qualifiers whose second part is a duration.
const TIMED: &[&str] = &["L", "D", "SD", "DS", "SL"];

impl Context<'_> {
    /// A statement.
    pub fn stmt(&self, kind: StmtKind, l: u32, r: u32) -> Box<Stmt> {
        Box::new(Stmt { kind, span: self.span(l, r) })
    }

    /// An expression as a statement: a call, one of the words EXIT, CONTINUE, RETURN (which are names elsewhere), or `x = 1`.
    pub fn expression_statement(&self, e: Expr, l: u32, r: u32) -> Box<Stmt> {
        let kind = match e.kind {
            ExprKind::Error => StmtKind::Error,
            ExprKind::Name(ref name) => match jump_word(&name.text) {
                Some(kind) => kind,
                None => StmtKind::Expr(e),
            },
            ExprKind::Binary(BinaryOp::Eq, at, target, value) if !e.parens && is_place(&target) => {
                if self.slice(at.start, at.end) == "=" {
                    self.report(
                        codes::EQUALS_FOR_ASSIGN,
                        at,
                        "`=` compares, it does not assign",
                        format!("write `{} := ...`", self.slice(target.span.start, target.span.end)),
                    );
                }
                StmtKind::Assign(*target, *value)
            }
            _ => StmtKind::Expr(e),
        };
        self.stmt(kind, l, r)
    }

    /// IF with its branches.
    pub fn if_stmt(
        &self,
        condition: Expr,
        then: Vec<Stmt>,
        elsifs: Vec<(Expr, Vec<Stmt>)>,
        otherwise: Option<Vec<Stmt>>,
        l: u32,
        r: u32,
    ) -> Box<Stmt> {
        let mut arms = Vec::with_capacity(1 + elsifs.len());
        arms.push((condition, then));
        arms.extend(elsifs);
        self.stmt(StmtKind::If { arms, otherwise }, l, r)
    }

    /// CASE; its flat list is grouped by labels.
    pub fn case_stmt(
        &self,
        selector: Expr,
        items: Vec<CaseItem>,
        otherwise: Option<Vec<Stmt>>,
        l: u32,
        r: u32,
    ) -> Box<Stmt> {
        let mut arms: Vec<CaseArm> = Vec::new();
        let mut reported = false;
        for item in items {
            match (item, arms.last_mut()) {
                (CaseItem::Labels(labels, span), _) => arms.push(CaseArm { labels, body: Vec::new(), span }),
                (CaseItem::Statement(s), Some(arm)) => arm.body.push(*s),
                (CaseItem::Statement(s), None) => {
                    if !reported && !matches!(s.kind, StmtKind::Empty | StmtKind::Error) {
                        reported = true;
                        self.report(
                            codes::UNEXPECTED,
                            s.span,
                            "a statement stands before the first label of this CASE",
                            "write the values for which it is meant: `1:` or `1, 3..5:`",
                        );
                    }
                }
            }
        }
        self.stmt(StmtKind::Case { selector, arms, otherwise }, l, r)
    }

    /// FOR whose head (bytes `m..n`) was given up.
    pub fn bad_for(&self, m: u32, n: u32, body: Vec<Stmt>, l: u32, r: u32) -> Box<Stmt> {
        let bad = || self.bad(m, n);
        self.stmt(StmtKind::For { var: bad(), from: bad(), to: bad(), by: None, body }, l, r)
    }

    /// A line of IL.
    pub fn il_line(&self, label: Option<Name>, inst: Option<IlInst>, l: u32, r: u32) -> Box<IlLine> {
        Box::new(IlLine { label, inst, span: self.span(l, r) })
    }

    /// An operator with operands; `CAL fb(...)` is a call.
    pub fn il_simple(&self, op: Name, mut operands: Vec<Expr>) -> Box<IlInst> {
        let calls = il_operators::find(&op.text).is_some_and(|o| matches!(o.meaning, Meaning::Call(_)));
        if calls
            && operands.len() == 1
            && let Some(operand) = operands.pop()
        {
            match operand.kind {
                ExprKind::Call(call) => return Box::new(IlInst::Call { op, call: *call }),
                kind => operands.push(Expr { kind, ..operand }),
            }
        }
        let positional = |e: Expr| Arg { span: e.span, kind: ArgKind::Positional(e) };
        Box::new(IlInst::Simple { op, operands: operands.into_iter().map(positional).collect() })
    }

    /// `AND( first` lines `)`; the closing parenthesis is in bytes `c..d`.
    pub fn il_deferred(&self, op: Name, first: Option<Expr>, body: Option<IlBody>, c: u32, d: u32) -> Box<IlInst> {
        let body = body.unwrap_or_else(|| IlBody { lines: Vec::new(), span: self.span(c, c) });
        Box::new(IlInst::Deferred { op, first, body, close: self.span(c, d) })
    }

    /// A function in formal form; its parentheses are bytes `m..n`.
    pub fn il_function(&self, name: Name, args: Vec<Arg>, m: u32, n: u32) -> Box<IlInst> {
        let callee = Expr { span: name.span, kind: ExprKind::Name(name), depth: 1, parens: false };
        Box::new(IlInst::Function(Call { callee, args, parens: self.span(m, n) }))
    }

    /// A step; its keyword ends at `m`.
    pub fn step(&self, m: u32, name: Name, actions: Vec<ActionAssociation>, l: u32, r: u32) -> SfcItem {
        let initial = self.slice(l, m).eq_ignore_ascii_case("INITIAL_STEP");
        SfcItem::Element(Box::new(SfcElement::Step(Step { initial, name, actions, span: self.span(l, r) })))
    }

    /// One more action association, written as an expression: `act`, `act()`, `act(L, T#5s, indicator)`.
    pub fn association(&self, mut list: Vec<ActionAssociation>, e: Expr, l: u32, r: u32) -> Vec<ActionAssociation> {
        let span = self.span(l, r);
        let plain = |action| ActionAssociation { action, qualifier: None, time: None, indicators: Vec::new(), span };
        let call = match e.kind {
            ExprKind::Error => return list,
            ExprKind::Call(call) if !e.parens => *call,
            _ => return push_association(list, plain(e)),
        };
        let mut association = plain(call.callee);
        for (i, arg) in call.args.into_iter().enumerate() {
            let ArgKind::Positional(value) = arg.kind else {
                self.bad_association(arg.span, "an action association has no named parts");
                return list;
            };
            match (i, value.kind) {
                (0, ExprKind::Name(name)) => association.qualifier = Some(name),
                (0, ExprKind::Error) => {}
                (0, _) => {
                    self.bad_association(value.span, "an action qualifier is expected here");
                    return list;
                }
                (1, kind) if takes_time(association.qualifier.as_ref(), &kind) => {
                    association.time = Some(Expr { kind, ..value });
                }
                (_, kind) => association.indicators.push(Expr { kind, ..value }),
            }
        }
        list.push(association);
        list
    }

    fn bad_association(&self, span: Span, message: &str) {
        self.report(codes::BAD_ASSOCIATION, span, message, "write for example `act(N);` or `act(L, T#5s, done);`");
    }

    /// `(PRIORITY := e)`.
    pub fn priority(&self, name: Name, e: Expr) -> Expr {
        if !name.text.eq_ignore_ascii_case("PRIORITY") {
            self.report(
                codes::UNEXPECTED,
                name.span,
                format!("`{}` is not a property of a transition", name.text),
                "write `(PRIORITY := 1)`",
            );
        }
        e
    }

    /// A transition.
    #[allow(clippy::too_many_arguments)]
    pub fn transition(
        &self,
        name: Option<Name>,
        priority: Option<Expr>,
        from: Vec<Name>,
        to: Vec<Name>,
        condition: Condition,
        l: u32,
        r: u32,
    ) -> SfcItem {
        let span = self.span(l, r);
        let transition = Transition { name, priority, from, to, condition, span };
        SfcItem::Element(Box::new(SfcElement::Transition(transition)))
    }
}

fn push_association(mut list: Vec<ActionAssociation>, a: ActionAssociation) -> Vec<ActionAssociation> {
    list.push(a);
    list
}

/// The statement that a word alone makes.
fn jump_word(word: &str) -> Option<StmtKind> {
    let is = |w: &str| word.eq_ignore_ascii_case(w);
    Some(match word.len() {
        4 if is("EXIT") => StmtKind::Exit,
        8 if is("CONTINUE") => StmtKind::Continue,
        6 if is("RETURN") => StmtKind::Return,
        _ => return None,
    })
}

fn is_place(e: &Expr) -> bool {
    use ExprKind::*;
    matches!(e.kind, Name(_) | Address(_) | Member(..) | Part(..) | Index(..) | Deref(_) | Error)
}

fn takes_time(qualifier: Option<&Name>, kind: &ExprKind) -> bool {
    let timed = qualifier.is_some_and(|q| TIMED.iter().any(|t| t.eq_ignore_ascii_case(&q.text)));
    timed || matches!(kind, ExprKind::Literal(Literal { kind: LiteralKind::Duration, .. }))
}

/// A chart and the ACTIONs that stand in it.
pub fn sfc_body(items: Vec<SfcItem>, span: Span) -> (Body, Vec<Action>) {
    let (mut elements, mut actions) = (Vec::new(), Vec::new());
    for item in items {
        match item {
            SfcItem::Element(e) => elements.push(*e),
            SfcItem::Action(a) => actions.push(*a),
        }
    }
    (Body::Sfc(SfcBody { elements, span }), actions)
}
