//! The typed form as text (`--emit hir`): ST-like, every conversion and type written out.

use crate::app::Application;
use crate::body::*;
use crate::cx::type_name;
use crate::defs::*;
use crate::init::Init;
use crate::types::TypeId;
use std::fmt::Write;

/// All POUs of the user with their variables and bodies.
pub fn print(defs: &Defs) -> String {
    let mut p = Printer { defs, out: String::new(), indent: 0 };
    for def in &defs.structs {
        p.line(&format!("{} {}", if def.union { "UNION" } else { "STRUCT" }, def.name));
        for f in &def.fields {
            p.line(&format!("  {} : {}{}", f.name, type_name(defs, f.ty), p.init(&f.init)));
        }
    }
    for def in &defs.enums {
        let values: Vec<String> = def.values.iter().map(|(n, v, _)| format!("{n} := {v}")).collect();
        p.line(&format!("ENUM {} : {} ({})", def.name, def.base.name(), values.join(", ")));
    }
    for var in &defs.globals {
        p.variable("VAR_GLOBAL", *var);
    }
    for (id, pou) in defs.pous.iter_enumerated() {
        if !pou.builtin {
            p.pou(id, pou);
        }
    }
    p.out
}

/// Tasks and program instances.
pub fn print_application(app: &Application, defs: &Defs) -> String {
    let mut out = String::new();
    for resource in &app.resources {
        let _ = writeln!(out, "RESOURCE {}", if resource.name.is_empty() { "(single)" } else { &resource.name });
        for (i, task) in resource.tasks.iter().enumerate() {
            let interval = task.interval_ns.map_or("every tick".into(), |ns| format!("every {ns} ns"));
            let _ = writeln!(out, "  TASK {} : {interval}, priority {}", task.name, task.priority);
            for program in resource.programs.iter().filter(|p| p.task == i) {
                let _ = writeln!(out, "    PROGRAM {} : {}", program.name, defs.pous[program.pou].name);
            }
        }
    }
    out
}

struct Printer<'d> {
    defs: &'d Defs,
    out: String,
    indent: usize,
}

impl Printer<'_> {
    fn line(&mut self, text: &str) {
        let _ = writeln!(self.out, "{:width$}{text}", "", width = self.indent * 2);
    }

    fn init(&self, init: &Init) -> String {
        match init {
            Init::Default => String::new(),
            other => format!(" := {}", self.init_text(other)),
        }
    }

    fn init_text(&self, init: &Init) -> String {
        match init {
            Init::Default => "default".into(),
            Init::Scalar(raw) => format!("{raw:#x}"),
            Init::String(s) => format!("{:?}", String::from_utf8_lossy(s)),
            Init::WString(s) => format!("{:?}", String::from_utf16_lossy(s)),
            Init::Reference(id) => match &self.defs.references[*id] {
                Some(place) => format!("ref({})", self.place(place)),
                None => "null".into(),
            },
            Init::Array(runs) => {
                let runs: Vec<String> = runs.iter().map(|(n, v)| format!("{n}({})", self.init_text(v))).collect();
                format!("[{}]", runs.join(", "))
            }
            Init::Fields(fields) => {
                let fields: Vec<String> =
                    fields.iter().map(|(i, v)| format!("#{i} := {}", self.init_text(v))).collect();
                format!("({})", fields.join(", "))
            }
        }
    }

    fn variable(&mut self, section: &str, var: VarId) {
        let v = &self.defs.vars[var];
        let flags = [(v.constant, " CONSTANT"), (v.retain, " RETAIN")];
        let flags: String = flags.iter().filter(|(on, _)| *on).map(|(_, t)| *t).collect();
        let ty = type_name(self.defs, v.ty);
        self.line(&format!("{section}{flags} {} : {ty}{}", v.name, self.init(&v.init)));
    }

    fn pou(&mut self, id: PouId, pou: &Pou) {
        let kind = match pou.kind {
            PouKind::Program => "PROGRAM",
            PouKind::FunctionBlock => "FUNCTION_BLOCK",
            PouKind::Function => "FUNCTION",
            PouKind::Action => "ACTION",
        };
        let owner = pou.owner.map(|o| format!("{}.", self.defs.pous[o].name)).unwrap_or_default();
        self.line("");
        self.line(&format!("{kind} {owner}{}", pou.name));
        self.indent += 1;
        for var in &pou.vars {
            let section = match self.defs.vars[*var].section {
                Section::Local => "VAR",
                Section::Temp => "VAR_TEMP",
                Section::Input => "VAR_INPUT",
                Section::Output => "VAR_OUTPUT",
                Section::InOut => "VAR_IN_OUT",
                Section::Global => "VAR_GLOBAL",
                Section::Result => "RESULT",
            };
            self.variable(section, *var);
        }
        let body = &self.defs.bodies[id];
        for (temp, ty) in body.temps.iter_enumerated() {
            self.line(&format!("TEMP t{} : {}", temp.index(), type_name(self.defs, *ty)));
        }
        self.list(&body.stmts);
        self.indent -= 1;
    }

    fn list(&mut self, stmts: &[Stmt]) {
        stmts.iter().for_each(|s| self.stmt(s));
    }

    fn nested(&mut self, stmts: &[Stmt]) {
        self.indent += 1;
        self.list(stmts);
        self.indent -= 1;
    }

    fn stmt(&mut self, stmt: &Stmt) {
        match &stmt.kind {
            StmtKind::Assign { target, value } => {
                let line = format!("{} := {}", self.place(target), self.expr(value));
                self.line(&line);
            }
            StmtKind::Call(call) => {
                let line = self.call(call);
                self.line(&line);
            }
            StmtKind::Eval(e) => {
                let line = self.expr(e);
                self.line(&line);
            }
            StmtKind::If { arms, otherwise } => {
                for (i, (cond, body)) in arms.iter().enumerate() {
                    let line = format!("{} {} THEN", if i == 0 { "IF" } else { "ELSIF" }, self.expr(cond));
                    self.line(&line);
                    self.nested(body);
                }
                if !otherwise.is_empty() {
                    self.line("ELSE");
                    self.nested(otherwise);
                }
                self.line("END_IF");
            }
            StmtKind::Case { selector, arms, otherwise } => {
                let line = format!("CASE {} OF", self.expr(selector));
                self.line(&line);
                for arm in arms {
                    let labels: Vec<String> = arm
                        .labels
                        .iter()
                        .map(|(l, h)| if l == h { l.to_string() } else { format!("{l}..{h}") })
                        .collect();
                    self.line(&format!("{}:", labels.join(", ")));
                    self.nested(&arm.body);
                }
                if !otherwise.is_empty() {
                    self.line("ELSE");
                    self.nested(otherwise);
                }
                self.line("END_CASE");
            }
            StmtKind::For { var, from, to, by, body } => {
                let by = by.as_ref().map(|b| format!(" BY {}", self.expr(b))).unwrap_or_default();
                let line = format!("FOR {} := {} TO {}{by} DO", self.place(var), self.expr(from), self.expr(to));
                self.line(&line);
                self.nested(body);
                self.line("END_FOR");
            }
            StmtKind::While(cond, body) => {
                let line = format!("WHILE {} DO", self.expr(cond));
                self.line(&line);
                self.nested(body);
                self.line("END_WHILE");
            }
            StmtKind::Repeat(body, until) => {
                self.line("REPEAT");
                self.nested(body);
                let line = format!("UNTIL {} END_REPEAT", self.expr(until));
                self.line(&line);
            }
            StmtKind::Exit => self.line("EXIT"),
            StmtKind::Continue => self.line("CONTINUE"),
            StmtKind::Return => self.line("RETURN"),
            StmtKind::Label(label) => self.line(&format!("L{}:", label.index())),
            StmtKind::Jump(label, cond) => {
                let cond = cond.as_ref().map(|c| format!(" IF {}", self.expr(c))).unwrap_or_default();
                self.line(&format!("JMP L{}{cond}", label.index()));
            }
        }
    }

    fn ty(&self, ty: TypeId) -> String {
        type_name(self.defs, ty)
    }

    fn expr(&self, e: &Expr) -> String {
        match &e.kind {
            ExprKind::Const(raw) => self.constant(*raw, e.ty),
            ExprKind::String(s) => format!("'{}'", s.iter().map(|b| *b as char).collect::<String>()),
            ExprKind::WString(s) => format!("\"{}\"", String::from_utf16_lossy(s)),
            ExprKind::Read(place) => self.place(place),
            ExprKind::Op(op, elem, args) => {
                let name = format!("{op:?}").to_uppercase();
                format!("{name}_{}({})", elem.name(), self.args(args))
            }
            ExprKind::AndThen(a, b) => format!("({} AND_THEN {})", self.expr(a), self.expr(b)),
            ExprKind::OrElse(a, b) => format!("({} OR_ELSE {})", self.expr(a), self.expr(b)),
            ExprKind::Convert(from, to, inner) => format!("{}_TO_{}({})", from.name(), to.name(), self.expr(inner)),
            ExprKind::Retype(inner) => self.expr(inner),
            ExprKind::RangeCheck { value, low, high, .. } => format!("CHECK({}, {low}..{high})", self.expr(value)),
            ExprKind::Call(call) => self.call(call),
            ExprKind::Std { func, elem, args } => format!("{}<{}>({})", func.name, elem.name(), self.args(args)),
            ExprKind::StdCall(call) => self.std_call(call),
            ExprKind::Choose { selector, choices } => {
                format!("CHOOSE({}: {})", self.expr(selector), self.args(choices))
            }
            ExprKind::Text { op, wide, args } => {
                let name = format!("{op:?}").to_uppercase();
                format!("{name}_{}({})", if *wide { "WSTRING" } else { "STRING" }, self.args(args))
            }
            ExprKind::RefOf(place) => format!("REF({})", self.place(place)),
            ExprKind::Temp(temp) => format!("t{}", temp.index()),
            ExprKind::Error => "?".into(),
        }
    }

    fn constant(&self, raw: u64, ty: TypeId) -> String {
        if let crate::types::Type::Enum(id) = self.defs.types.get(ty) {
            let def = &self.defs.enums[*id];
            let number = def.base.to_i128(raw);
            if let Some((name, _, _)) = def.values.iter().find(|(_, v, _)| *v == number) {
                return format!("{}#{name}", def.name);
            }
        }
        match crate::cx::elem_of(self.defs, ty) {
            Some(elem) => plcc_stdlib::value::Value::Scalar { elem, raw }.to_string(),
            None => format!("{}#{raw}", self.ty(ty)),
        }
    }

    fn args(&self, args: &[Expr]) -> String {
        args.iter().map(|a| self.expr(a)).collect::<Vec<_>>().join(", ")
    }

    fn call(&self, call: &Call) -> String {
        let name = |pou: PouId| self.defs.pous[pou].name.clone();
        let callee = match &call.callee {
            Callee::Function(pou) => name(*pou).to_string(),
            Callee::Instance(place, pou) => format!("{}:{}", self.place(place), name(*pou)),
            Callee::Action(Some(place), pou) => format!("{}.{}", self.place(place), name(*pou)),
            Callee::Action(None, pou) => name(*pou).to_string(),
        };
        let var = |v: VarId| self.defs.vars[v].name.clone();
        let mut parts: Vec<String> = Vec::new();
        parts.extend(call.en.iter().map(|e| format!("EN := {}", self.expr(e))));
        parts.extend(call.inputs.iter().map(|(v, e)| format!("{} := {}", var(*v), self.expr(e))));
        parts.extend(call.in_outs.iter().map(|(v, p)| format!("{} := REF({})", var(*v), self.place(p))));
        parts.extend(call.outputs.iter().map(|o| {
            let not = if o.negated { "NOT " } else { "" };
            let convert = o.convert.map(|(a, b)| format!("{}_TO_{} ", a.name(), b.name())).unwrap_or_default();
            format!("{not}{} => {convert}{}", var(o.output), self.place(&o.target))
        }));
        parts.extend(
            call.eno.iter().map(|e| format!("{}ENO => {}", if e.negated { "NOT " } else { "" }, self.place(&e.target))),
        );
        format!("{callee}({})", parts.join(", "))
    }

    /// `[EN := e; t0 := a; t1 := b] DIV_INT(t0, t1) [ENO => ok]`.
    fn std_call(&self, call: &StdCall) -> String {
        let mut before: Vec<String> = Vec::new();
        before.extend(call.en.iter().map(|e| format!("EN := {}", self.expr(e))));
        before.extend(call.arguments.iter().map(|(t, e)| format!("t{} := {}", t.index(), self.expr(e))));
        let mut after: Vec<String> = Vec::new();
        after.extend(call.outputs.iter().map(|(p, e)| format!("{} => {}", self.expr(e), self.place(p))));
        after.extend(
            call.eno.iter().map(|e| format!("{}ENO => {}", if e.negated { "NOT " } else { "" }, self.place(&e.target))),
        );
        let value = call.value.as_ref().map(|v| self.expr(v)).unwrap_or_default();
        format!("[{}] {value} [{}]", before.join("; "), after.join("; "))
    }

    fn place(&self, place: &Place) -> String {
        let mut text = match &place.root {
            Root::Var(var) => self.defs.vars[*var].name.to_string(),
            Root::Temp(temp) => format!("t{}", temp.index()),
            Root::Deref(e) => format!("{}^", self.expr(e)),
            Root::Address(a) => {
                let area = match a.area {
                    Area::Input => 'I',
                    Area::Output => 'Q',
                    Area::Memory => 'M',
                };
                match a.bit {
                    Some(bit) => format!("%{area}X{}.{bit}", a.byte),
                    None => format!("%{area}B{}:{}", a.byte, self.ty(place.ty)),
                }
            }
        };
        for step in &place.steps {
            match step {
                Step::Field(index) => {
                    let _ = write!(text, ".#{index}");
                }
                Step::Member(var) => {
                    let _ = write!(text, ".{}", self.defs.vars[*var].name);
                }
                Step::OpenIndex(indices, _) => {
                    let values: Vec<String> = indices.iter().map(|i| self.expr(&i.value)).collect();
                    let _ = write!(text, "[{}]", values.join(", "));
                }
                Step::Index(indices, _) => {
                    let _ = write!(text, "[{}]", self.args(indices));
                }
                Step::Character { index, first, .. } => {
                    let _ = write!(text, "[{} from {first}]", self.expr(index));
                }
                Step::Deref => text.push('^'),
                Step::Bit(n) => {
                    let _ = write!(text, ".{n}");
                }
                Step::Part(elem, n) => {
                    let _ = write!(text, ".%{}{n}", &elem.name()[..1]);
                }
                Step::Flags(word) => {
                    let _ = write!(text, "..{}", word.name());
                }
            }
        }
        text
    }
}
