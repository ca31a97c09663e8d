//! The tree as source text that gives the same tree again: what `plcc convert` writes. `print` shows a tree, this writes a
//! program: parentheses only where the language needs them, declarations in full.
//!
//! Recursion is bounded by the nesting of blocks and by [`MAX_DEPTH`](super::MAX_DEPTH).

use super::*;

/// What a tree alone does not say.
pub trait Texts {
    /// A name as it is to be written.
    fn name(&self, name: &str) -> String;
    /// A type that follows from a value.
    fn inferred(&self, variable: &Name) -> String;
    /// The body as it was written, if that can stand in a text.
    fn written(&self, holder: Span, body: &Body) -> Option<String>;
    /// Remarks to stand in front of a body.
    fn remarks(&self, holder: Span) -> Vec<String>;
}

/// A POU.
pub fn pou(pou: &Pou, texts: &dyn Texts) -> String {
    let mut w = Writer { texts, out: String::new(), indent: 0 };
    w.pou(pou);
    w.out
}

/// Any other item.
pub fn item(item: &Item, texts: &dyn Texts) -> String {
    let mut w = Writer { texts, out: String::new(), indent: 0 };
    match item {
        Item::Pou(pou) => w.pou(pou),
        Item::Types(types) => w.block("TYPE", "END_TYPE", |w| {
            for decl in types {
                let init = decl.init.as_ref().map(|i| w.initial(i)).unwrap_or_default();
                w.type_lines(&format!("{} : ", decl.name.text), &decl.ty, &format!("{init};"));
            }
        }),
        Item::Globals(section) => w.section(section),
        Item::Config(config) => w.configuration(config),
        Item::Action(action) => w.action(action),
    }
    w.out
}

/// An expression on one line.
pub fn expression(e: &Expr) -> String {
    struct Plain;
    impl Texts for Plain {
        fn name(&self, name: &str) -> String {
            name.to_string()
        }
        fn inferred(&self, _: &Name) -> String {
            String::new()
        }
        fn written(&self, _: Span, _: &Body) -> Option<String> {
            None
        }
        fn remarks(&self, _: Span) -> Vec<String> {
            Vec::new()
        }
    }
    Writer { texts: &Plain, out: String::new(), indent: 0 }.expr(e)
}

struct Writer<'t> {
    texts: &'t dyn Texts,
    out: String,
    indent: usize,
}

impl Writer<'_> {
    fn line(&mut self, text: &str) {
        if !text.is_empty() {
            for _ in 0..self.indent {
                self.out.push_str("  ");
            }
            self.out.push_str(text);
        }
        self.out.push('\n');
    }

    fn block(&mut self, head: &str, end: &str, body: impl FnOnce(&mut Self)) {
        self.line(head);
        self.indent += 1;
        body(self);
        self.indent -= 1;
        self.line(end);
    }

    fn name(&self, name: &Name) -> String {
        self.texts.name(&name.text)
    }

    // ---- POUs ----

    fn pou(&mut self, pou: &Pou) {
        let (head, end) = match pou.kind {
            PouKind::Program => ("PROGRAM", "END_PROGRAM"),
            PouKind::FunctionBlock => ("FUNCTION_BLOCK", "END_FUNCTION_BLOCK"),
            PouKind::Function => ("FUNCTION", "END_FUNCTION"),
        };
        let result = pou.result.as_ref().map(|t| format!(" : {}", self.ty(t))).unwrap_or_default();
        self.line(&format!("{head} {}{result}", self.name(&pou.name)));
        for section in &pou.sections {
            self.section(section);
        }
        self.body(pou.span, &pou.body);
        for action in &pou.actions {
            self.action(action);
        }
        self.line(end);
    }

    fn action(&mut self, action: &Action) {
        let name = self.name(&action.name);
        self.block(&format!("ACTION {name}:"), "END_ACTION", |w| w.body(action.span, &action.body));
    }

    fn body(&mut self, holder: Span, body: &Body) {
        for remark in self.texts.remarks(holder) {
            for line in remark.lines() {
                self.line(format!("// {}", line.trim()).trim_end());
            }
        }
        if let Some(text) = self.texts.written(holder, body) {
            // Lines of strings and comments stay as they are.
            self.out.push_str(text.trim_end());
            self.out.push('\n');
            return;
        }
        match body {
            Body::St(statements) => self.statements(statements),
            Body::Il(il) => self.il(il),
            Body::Sfc(chart) => {
                for element in &chart.elements {
                    match element {
                        SfcElement::Step(step) => self.step(step),
                        SfcElement::Transition(transition) => self.transition(transition),
                    }
                }
            }
            Body::Network(_) => self.line("// a network that was not lowered"),
        }
    }

    // ---- Declarations ----

    fn section(&mut self, section: &VarSection) {
        let word = section.kind.keyword();
        if section.vars.is_empty() {
            return;
        }
        let mut head = word.to_string();
        for (qualifier, _) in &section.qualifiers {
            head.push_str(match qualifier {
                Qualifier::Constant => " CONSTANT",
                Qualifier::Retain => " RETAIN",
                Qualifier::NonRetain => " NON_RETAIN",
                Qualifier::Persistent => " PERSISTENT",
                Qualifier::Access => "",
            });
        }
        self.block(&head, "END_VAR", |w| {
            for decl in &section.vars {
                w.declaration(section.kind, decl);
            }
        });
    }

    fn declaration(&mut self, kind: SectionKind, decl: &VarDecl) {
        let names: Vec<String> = decl.names.iter().map(|n| self.name(n)).collect();
        let path: Vec<&str> = decl.path.iter().map(|n| n.text.as_str()).collect();
        let mut head = match kind {
            SectionKind::Access => format!("{} : {}", names.join(", "), path.join(".")),
            SectionKind::Config => {
                let all: Vec<&str> = names.iter().map(String::as_str).chain(path).collect();
                all.join(".")
            }
            _ => names.join(", "),
        };
        if let Some((address, _)) = &decl.at {
            let gap = if head.is_empty() { "" } else { " " };
            head.push_str(&format!("{gap}AT {address}"));
        }
        head.push_str(" : ");
        let mut tail = String::new();
        tail.push_str(match decl.edge {
            Some((Edge::Rising, _)) => " R_EDGE",
            Some((Edge::Falling, _)) => " F_EDGE",
            None => "",
        });
        tail.push_str(match decl.read_write {
            Some(true) => " READ_WRITE",
            Some(false) => " READ_ONLY",
            None => "",
        });
        if let Some(init) = &decl.init {
            tail.push_str(&self.initial(init));
        }
        tail.push(';');
        if let (TypeExprKind::Inferred(_), Some(name)) = (&decl.ty.kind, decl.names.first()) {
            let ty = self.texts.inferred(name);
            return self.line(&format!("{head}{ty}{tail}"));
        }
        self.type_lines(&head, &decl.ty, &tail);
    }

    /// A type between two texts; structures take several lines.
    fn type_lines(&mut self, head: &str, ty: &TypeExpr, tail: &str) {
        let (word, end, fields) = match &ty.kind {
            TypeExprKind::Struct(fields) => ("STRUCT", "END_STRUCT", fields),
            TypeExprKind::Union(fields) => ("UNION", "END_UNION", fields),
            _ => return self.line(&format!("{head}{}{tail}", self.ty(ty))),
        };
        self.block(&format!("{head}{word}"), &format!("{end}{tail}"), |w| {
            for field in fields {
                w.declaration(SectionKind::Var, field);
            }
        });
    }

    /// A type on one line.
    fn ty(&self, ty: &TypeExpr) -> String {
        match &ty.kind {
            TypeExprKind::Named(name) => name.text.to_string(),
            TypeExprKind::String { wide, length } => {
                let word = if *wide { "WSTRING" } else { "STRING" };
                length.as_ref().map_or(word.to_string(), |n| format!("{word}[{}]", self.expr(n)))
            }
            TypeExprKind::Array { dims, elem } => {
                let dims = dims.iter().map(|d| match d {
                    Dim::Range(low, high) => format!("{}..{}", self.expr(low), self.expr(high)),
                    Dim::Any(_) => "*".into(),
                });
                let dims: Vec<String> = dims.collect();
                format!("ARRAY [{}] OF {}", dims.join(", "), self.ty(elem))
            }
            TypeExprKind::Struct(fields) | TypeExprKind::Union(fields) => {
                let (word, end) = match ty.kind {
                    TypeExprKind::Struct(_) => ("STRUCT", "END_STRUCT"),
                    _ => ("UNION", "END_UNION"),
                };
                let mut inner = Writer { texts: self.texts, out: String::new(), indent: 0 };
                for field in fields {
                    inner.declaration(SectionKind::Var, field);
                }
                format!("{word} {} {end}", inner.out.replace('\n', " ").trim_end())
            }
            TypeExprKind::Enum { base, values } => {
                let base = base.as_ref().map_or(String::new(), |b| format!("{} ", b.text));
                let values = values.iter().map(|v| match &v.value {
                    Some(e) => format!("{} := {}", v.name.text, self.expr(e)),
                    None => v.name.text.to_string(),
                });
                format!("{base}({})", values.collect::<Vec<_>>().join(", "))
            }
            TypeExprKind::Subrange { base, low, high } => {
                format!("{} ({}..{})", base.text, self.expr(low), self.expr(high))
            }
            TypeExprKind::Ref { kind, target } => {
                format!("{} {}", kind.keyword(), self.ty(target))
            }
            TypeExprKind::Inferred(_) | TypeExprKind::Error => "?".into(),
        }
    }

    /// What stands behind the type of a declaration.
    fn initial(&self, init: &Init) -> String {
        format!(" {} {}", init.kind.sign(), self.init(init))
    }

    fn init(&self, init: &Init) -> String {
        let list = |elems: &[InitElem]| elems.iter().map(|e| self.elem(e)).collect::<Vec<_>>().join(", ");
        match &init.kind {
            InitKind::Expr(e) | InitKind::Reference(e) => self.expr(e),
            InitKind::Array { elems, .. } => format!("[{}]", list(elems)),
            InitKind::Struct(fields) => {
                let fields = fields.iter().map(|(n, i)| format!("{} := {}", n.text, self.init(i)));
                format!("({})", fields.collect::<Vec<_>>().join(", "))
            }
        }
    }

    fn elem(&self, elem: &InitElem) -> String {
        match elem {
            InitElem::One(init) => self.init(init),
            InitElem::Repeat(count, values) => {
                let values: Vec<String> = values.iter().map(|v| self.init(v)).collect();
                format!("{}({})", self.expr(count), values.join(", "))
            }
        }
    }

    fn configuration(&mut self, config: &Configuration) {
        self.block(&format!("CONFIGURATION {}", config.name.text), "END_CONFIGURATION", |w| {
            // VAR_ACCESS and VAR_CONFIG come behind the resources they speak of.
            let late = |s: &&VarSection| matches!(s.kind, SectionKind::Access | SectionKind::Config);
            config.sections.iter().filter(|s| !late(s)).for_each(|s| w.section(s));
            for resource in &config.resources {
                let name = resource.name.as_ref().map_or("Res", |n| n.text.as_str());
                let on = resource.on.as_ref().map_or("PLC", |n| n.text.as_str());
                w.block(&format!("RESOURCE {name} ON {on}"), "END_RESOURCE", |w| w.resource(resource));
            }
            config.sections.iter().filter(late).for_each(|s| w.section(s));
        });
    }

    fn resource(&mut self, resource: &Resource) {
        for section in &resource.sections {
            self.section(section);
        }
        for task in &resource.tasks {
            let properties = task.properties.iter().map(|(n, e)| format!("{} := {}", n.text, self.expr(e)));
            let properties: Vec<String> = properties.collect();
            self.line(&format!("TASK {}({});", task.name.text, properties.join(", ")));
        }
        for program in &resource.programs {
            let task = program.task.as_ref().map_or(String::new(), |t| format!(" WITH {}", t.text));
            self.line(&format!("PROGRAM {}{task} : {};", program.name.text, program.program.text));
        }
    }

    // ---- Charts ----

    fn step(&mut self, step: &Step) {
        let word = if step.initial { "INITIAL_STEP" } else { "STEP" };
        self.block(&format!("{word} {}:", step.name.text), "END_STEP", |w| {
            for a in &step.actions {
                let mut parts = vec![a.qualifier.as_ref().map_or("N".to_string(), |q| q.text.to_string())];
                parts.extend(a.time.iter().chain(&a.indicators).map(|e| w.expr(e)));
                w.line(&format!("{}({});", w.expr(&a.action), parts.join(", ")));
            }
        });
    }

    fn transition(&mut self, t: &Transition) {
        let side = |names: &[Name]| {
            let names: Vec<&str> = names.iter().map(|n| n.text.as_str()).collect();
            if names.len() == 1 { names[0].to_string() } else { format!("({})", names.join(", ")) }
        };
        let mut head = String::from("TRANSITION");
        if let Some(name) = &t.name {
            head.push_str(&format!(" {}", name.text));
        }
        if let Some(priority) = &t.priority {
            head.push_str(&format!(" (PRIORITY := {})", self.expr(priority)));
        }
        head.push_str(&format!(" FROM {} TO {}", side(&t.from), side(&t.to)));
        match &t.condition {
            Condition::St(e) | Condition::Steps(_, e) => {
                self.line(&format!("{head} := {}; END_TRANSITION", self.expr(e)));
            }
            Condition::Il(il) => self.block(&format!("{head}:"), "END_TRANSITION", |w| w.il(il)),
            Condition::Network(_) => self.line("// a network that was not lowered"),
        }
    }

    // ---- Instruction List ----

    fn il(&mut self, il: &IlBody) {
        for line in &il.lines {
            let label = line.label.as_ref().map_or(String::new(), |l| format!("{}: ", l.text));
            match &line.inst {
                None => self.line(label.trim_end()),
                Some(IlInst::Simple { op, operands }) => {
                    self.line(format!("{label}{} {}", op.text, self.args(operands)).trim_end());
                }
                Some(IlInst::Deferred { op, first, body, .. }) => {
                    let first = first.as_ref().map_or(String::new(), |e| format!(" {}", self.expr(e)));
                    self.block(&format!("{label}{}({first}", op.text), ")", |w| w.il(body));
                }
                Some(IlInst::Call { op, call }) => {
                    self.line(&format!("{label}{} {}({})", op.text, self.expr(&call.callee), self.args(&call.args)));
                }
                Some(IlInst::Function(call)) => {
                    self.line(&format!("{label}{}({})", self.expr(&call.callee), self.args(&call.args)));
                }
                Some(IlInst::Error) => {}
            }
        }
    }

    // ---- Statements ----

    fn statements(&mut self, statements: &[Stmt]) {
        for s in statements {
            self.statement(s);
        }
    }

    fn inner(&mut self, statements: &[Stmt]) {
        self.indent += 1;
        self.statements(statements);
        self.indent -= 1;
    }

    fn statement(&mut self, s: &Stmt) {
        match &s.kind {
            StmtKind::Assign(target, value) => {
                self.line(&format!("{} := {};", self.expr(target), self.expr(value)));
            }
            StmtKind::AssignAttempt(target, value) => {
                self.line(&format!("{} ?= {};", self.expr(target), self.expr(value)));
            }
            StmtKind::Bind(target, value) => {
                self.line(&format!("{} REF= {};", self.expr(target), self.expr(value)));
            }
            StmtKind::Expr(call) => self.line(&format!("{};", self.expr(call))),
            StmtKind::If { arms, otherwise } => {
                for (i, (condition, body)) in arms.iter().enumerate() {
                    let word = if i == 0 { "IF" } else { "ELSIF" };
                    self.line(&format!("{word} {} THEN", self.expr(condition)));
                    self.inner(body);
                }
                self.otherwise(otherwise);
                self.line("END_IF;");
            }
            StmtKind::Case { selector, arms, otherwise } => {
                self.line(&format!("CASE {} OF", self.expr(selector)));
                self.indent += 1;
                for arm in arms {
                    let labels = arm.labels.iter().map(|l| match l {
                        CaseLabel::One(e) => self.expr(e),
                        CaseLabel::Range(low, high) => format!("{}..{}", self.expr(low), self.expr(high)),
                    });
                    let labels: Vec<String> = labels.collect();
                    self.line(&format!("{}:", labels.join(", ")));
                    self.inner(&arm.body);
                }
                self.indent -= 1;
                self.otherwise(otherwise);
                self.line("END_CASE;");
            }
            StmtKind::For { var, from, to, by, body } => {
                let by = by.as_ref().map_or(String::new(), |by| format!(" BY {}", self.expr(by)));
                let (var, from, to) = (self.expr(var), self.expr(from), self.expr(to));
                self.line(&format!("FOR {var} := {from} TO {to}{by} DO"));
                self.inner(body);
                self.line("END_FOR;");
            }
            StmtKind::While(condition, body) => {
                self.line(&format!("WHILE {} DO", self.expr(condition)));
                self.inner(body);
                self.line("END_WHILE;");
            }
            StmtKind::Repeat(body, condition) => {
                self.line("REPEAT");
                self.inner(body);
                self.line(&format!("UNTIL {} END_REPEAT;", self.expr(condition)));
            }
            StmtKind::Exit => self.line("EXIT;"),
            StmtKind::Continue => self.line("CONTINUE;"),
            StmtKind::Return => self.line("RETURN;"),
            StmtKind::Label(name) => self.line(&format!("{}:", name.text)),
            StmtKind::Jump(name) => self.line(&format!("JMP {};", name.text)),
            StmtKind::Empty | StmtKind::Error => self.line(";"),
        }
    }

    fn otherwise(&mut self, otherwise: &Option<Vec<Stmt>>) {
        if let Some(body) = otherwise {
            self.line("ELSE");
            self.inner(body);
        }
    }

    // ---- Expressions ----

    fn args(&self, args: &[Arg]) -> String {
        let args = args.iter().map(|a| match &a.kind {
            ArgKind::Positional(e) => self.expr(e),
            ArgKind::Input(name, e) => {
                format!("{} := {}", name.text, e.as_ref().map_or(String::new(), |e| self.expr(e)))
            }
            ArgKind::Output { negated, name, target } => {
                let not = if *negated { "NOT " } else { "" };
                format!("{not}{} => {}", name.text, target.as_ref().map_or(String::new(), |e| self.expr(e)))
            }
        });
        args.collect::<Vec<_>>().join(", ")
    }

    fn expr(&self, e: &Expr) -> String {
        let text = self.bare(e);
        if e.parens { format!("({text})") } else { text }
    }

    /// An operand, in parentheses if the operator around it binds more than what it consists of.
    fn operand(&self, e: &Expr, weakest: u8) -> String {
        let level = match &e.kind {
            ExprKind::Binary(op, ..) => op.precedence(),
            _ => u8::MAX,
        };
        let text = self.bare(e);
        if e.parens || level < weakest { format!("({text})") } else { text }
    }

    fn bare(&self, e: &Expr) -> String {
        match &e.kind {
            ExprKind::Literal(literal) => match &literal.prefix {
                Some(prefix) => format!("{}#{}", prefix.text, literal.text),
                None => literal.text.to_string(),
            },
            ExprKind::Name(name) => self.name(name),
            ExprKind::Qualified { ty, value } => format!("{}#{}", ty.text, value.text),
            ExprKind::Address(text) => text.to_string(),
            ExprKind::Member(base, name) | ExprKind::Part(base, name) => {
                format!("{}.{}", self.operand(base, u8::MAX), name.text)
            }
            ExprKind::Index(base, indices) => {
                let indices: Vec<String> = indices.iter().map(|i| self.expr(i)).collect();
                format!("{}[{}]", self.operand(base, u8::MAX), indices.join(", "))
            }
            ExprKind::Deref(base) => format!("{}^", self.operand(base, u8::MAX)),
            ExprKind::Call(call) => format!("{}({})", self.expr(&call.callee), self.args(&call.args)),
            ExprKind::Unary(op, inner) => {
                let inner = self.operand(inner, u8::MAX);
                match op {
                    UnaryOp::Neg => format!("-{inner}"),
                    UnaryOp::Plus => format!("+{inner}"),
                    UnaryOp::Not => format!("NOT {inner}"),
                }
            }
            ExprKind::Binary(op, _, a, b) => {
                let level = op.precedence();
                let (a, b) = (self.operand(a, level), self.operand(b, level + 1));
                format!("{a} {} {b}", op.text())
            }
            ExprKind::Error => "?".into(),
        }
    }
}
