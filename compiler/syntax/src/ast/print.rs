//! The tree as indented text, for `--emit ast`: one line per declaration, statement, instruction or step; expressions stand on
//! their line with a parenthesis for each operator, so that precedence can be seen.
//!
//! Recursion is bounded by the nesting of blocks and by [`MAX_DEPTH`](super::MAX_DEPTH).

mod declarations;
mod expressions;

use super::*;

/// A file as indented text.
pub fn print(file: &File) -> String {
    let mut printer = Printer { out: String::new(), indent: 0 };
    for item in &file.items {
        printer.item(item);
    }
    printer.out
}

/// An expression on one line.
pub fn print_expr(e: &Expr) -> String {
    let mut out = String::new();
    expressions::write_expr(&mut out, e);
    out
}

struct Printer {
    out: String,
    indent: usize,
}

impl Printer {
    fn line(&mut self, text: &str) {
        for _ in 0..self.indent {
            self.out.push_str("  ");
        }
        self.out.push_str(text);
        self.out.push('\n');
    }

    /// `head`, and what `body` prints one step further in.
    fn block(&mut self, head: &str, body: impl FnOnce(&mut Self)) {
        self.line(head);
        self.indent += 1;
        body(self);
        self.indent -= 1;
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::Pou(pou) => self.pou(pou),
            Item::Types(types) => self.block("TYPE", |p| {
                for ty in types {
                    p.type_decl(ty);
                }
            }),
            Item::Globals(section) => self.section(section),
            Item::Config(config) => self.configuration(config),
            Item::Action(action) => self.action(action),
        }
    }

    fn body(&mut self, body: &Body) {
        match body {
            Body::St(statements) => self.block("body ST", |p| p.statements(statements)),
            Body::Il(il) => self.block("body IL", |p| p.il(il)),
            Body::Sfc(sfc) => self.block("body SFC", |p| {
                for element in &sfc.elements {
                    match element {
                        SfcElement::Step(step) => p.step(step),
                        SfcElement::Transition(transition) => p.transition(transition),
                    }
                }
            }),
            Body::Network(network) => self.network("body", network),
        }
    }

    /// Elements on a line each, with what their inputs are connected to.
    fn network(&mut self, head: &str, network: &Network) {
        let notation = match network.notation {
            Notation::Fbd => "FBD",
            Notation::Ld => "LD",
        };
        self.block(&format!("{head} {notation}"), |p| {
            for element in &network.elements {
                let order = element.order.map_or(String::new(), |n| format!(", order {n}"));
                let own = match &element.kind {
                    ElementKind::Contact { modifier: m, .. }
                    | ElementKind::Coil { modifier: m, .. }
                    | ElementKind::In { modifier: m, .. }
                    | ElementKind::Out { modifier: m, .. } => modifier(*m),
                    _ => String::new(),
                };
                p.block(&format!("{}{order}{own}", element.describe()), |p| {
                    for pin in &element.inputs {
                        let sources = pin.connections.iter().map(|c| match &c.pin {
                            Some(name) => format!("{}.{name}", c.from),
                            None => c.from.to_string(),
                        });
                        let operand = pin.operand.iter().map(print_expr);
                        let sources: Vec<String> = sources.chain(operand).collect();
                        p.line(&format!("in `{}`{} from {}", pin.name, modifier(pin.modifier), sources.join(", ")));
                    }
                    for pin in element.outputs.iter().filter(|p| !p.name.is_empty()) {
                        let to = pin.operand.as_ref().map_or(String::new(), |e| format!(" to {}", print_expr(e)));
                        p.line(&format!("out `{}`{}{to}", pin.name, modifier(pin.modifier)));
                    }
                });
            }
        });
    }

    fn statements(&mut self, statements: &[Stmt]) {
        for s in statements {
            self.statement(s);
        }
    }

    fn statement(&mut self, s: &Stmt) {
        let e = print_expr;
        match &s.kind {
            StmtKind::Assign(target, value) => self.line(&format!("assign {} := {}", e(target), e(value))),
            StmtKind::Bind(target, value) => self.line(&format!("bind {} REF= {}", e(target), e(value))),
            StmtKind::AssignAttempt(target, value) => self.line(&format!("attempt {} ?= {}", e(target), e(value))),
            StmtKind::Expr(call) => self.line(&format!("call {}", e(call))),
            StmtKind::If { arms, otherwise } => {
                for (i, (condition, body)) in arms.iter().enumerate() {
                    let word = if i == 0 { "IF" } else { "ELSIF" };
                    self.block(&format!("{word} {}", e(condition)), |p| p.statements(body));
                }
                self.otherwise(otherwise);
            }
            StmtKind::Case { selector, arms, otherwise } => {
                self.block(&format!("CASE {}", e(selector)), |p| {
                    for arm in arms {
                        let labels: Vec<String> = arm.labels.iter().map(case_label).collect();
                        p.block(&format!("{}:", labels.join(", ")), |p| p.statements(&arm.body));
                    }
                    p.otherwise(otherwise);
                });
            }
            StmtKind::For { var, from, to, by, body } => {
                let by = by.as_ref().map_or(String::new(), |by| format!(" BY {}", e(by)));
                let head = format!("FOR {} := {} TO {}{by}", e(var), e(from), e(to));
                self.block(&head, |p| p.statements(body));
            }
            StmtKind::While(condition, body) => {
                self.block(&format!("WHILE {}", e(condition)), |p| p.statements(body));
            }
            StmtKind::Repeat(body, condition) => {
                self.block("REPEAT", |p| p.statements(body));
                self.line(&format!("UNTIL {}", e(condition)));
            }
            StmtKind::Exit => self.line("EXIT"),
            StmtKind::Continue => self.line("CONTINUE"),
            StmtKind::Return => self.line("RETURN"),
            StmtKind::Label(name) => self.line(&format!("label {}:", name.text)),
            StmtKind::Jump(name) => self.line(&format!("JMP {}", name.text)),
            StmtKind::Empty => self.line("empty"),
            StmtKind::Error => self.line("error"),
        }
    }

    fn otherwise(&mut self, otherwise: &Option<Vec<Stmt>>) {
        if let Some(body) = otherwise {
            self.block("ELSE", |p| p.statements(body));
        }
    }

    fn il(&mut self, il: &IlBody) {
        for line in &il.lines {
            let label = line.label.as_ref().map_or(String::new(), |l| format!("{}: ", l.text));
            match &line.inst {
                None => self.line(label.trim_end()),
                Some(inst) => self.instruction(&label, inst),
            }
        }
    }

    fn instruction(&mut self, label: &str, inst: &IlInst) {
        match inst {
            IlInst::Simple { op, operands } => {
                self.line(format!("{label}{} {}", op.text, expressions::args(operands)).trim_end());
            }
            IlInst::Deferred { op, first, body, .. } => {
                let first = first.as_ref().map_or(String::new(), print_expr);
                self.block(&format!("{label}{}( {first}", op.text), |p| p.il(body));
                self.line(")");
            }
            IlInst::Call { op, call } => {
                self.line(&format!(
                    "{label}{} {}({})",
                    op.text,
                    print_expr(&call.callee),
                    expressions::args(&call.args)
                ));
            }
            IlInst::Function(call) => {
                self.line(&format!("{label}{}({})", print_expr(&call.callee), expressions::args(&call.args)));
            }
            IlInst::Error => self.line(&format!("{label}error")),
        }
    }

    fn step(&mut self, step: &Step) {
        let word = if step.initial { "INITIAL_STEP" } else { "STEP" };
        self.block(&format!("{word} {}", step.name.text), |p| {
            for a in &step.actions {
                let mut parts = vec![a.qualifier.as_ref().map_or("N".to_string(), |q| q.text.to_string())];
                parts.extend(a.time.iter().chain(&a.indicators).map(print_expr));
                p.line(&format!("action {}({})", print_expr(&a.action), parts.join(", ")));
            }
        });
    }

    fn transition(&mut self, t: &Transition) {
        let names = |list: &[Name]| list.iter().map(|n| n.text.as_str()).collect::<Vec<_>>().join(", ");
        let mut head = String::from("TRANSITION");
        if let Some(name) = &t.name {
            head.push_str(&format!(" {}", name.text));
        }
        if let Some(priority) = &t.priority {
            head.push_str(&format!(" priority {}", print_expr(priority)));
        }
        head.push_str(&format!(" from {} to {}", names(&t.from), names(&t.to)));
        match &t.condition {
            Condition::St(e) => self.line(&format!("{head} when {}", print_expr(e))),
            Condition::Il(il) => self.block(&format!("{head} when IL"), |p| p.il(il)),
            Condition::Network(network) => self.network(&format!("{head} when"), network),
            Condition::Steps(statements, value) => self.block(&format!("{head} when"), |p| {
                p.statements(statements);
                p.line(&print_expr(value));
            }),
        }
    }
}

fn modifier(modifier: Modifier) -> String {
    let mut text = String::new();
    if modifier.negated {
        text.push_str(" negated");
    }
    text.push_str(match modifier.edge {
        Some(Edge::Rising) => " rising",
        Some(Edge::Falling) => " falling",
        None => "",
    });
    text.push_str(match modifier.storage {
        Some(Storage::Set) => " set",
        Some(Storage::Reset) => " reset",
        None => "",
    });
    text
}

fn case_label(label: &CaseLabel) -> String {
    match label {
        CaseLabel::One(e) => print_expr(e),
        CaseLabel::Range(low, high) => format!("{}..{}", print_expr(low), print_expr(high)),
    }
}
