//! What compiles but is probably not meant so: variables nobody uses or writes, results and outputs nobody assigns,
//! statements nothing reaches, an instance that is called twice.
//!
//! In: checked bodies of files without errors (a mistake hides uses, so there would be warnings about nothing). The
//! warnings that belong to one expression or statement are given where that is checked.

use crate::body::*;
use crate::cx::{Cx, Unit};
use crate::defs::*;
use crate::foreign_code;
use crate::init::Init;
use crate::types::{Type, TypeId};
use crate::visit::{self, Use, Visitor};
use plcc_diag::{Code, Diagnostic, FileId, Severity, Span, codes};
use rustc_hash::{FxHashMap, FxHashSet};

/// Warns about the POUs of the user's files.
pub(crate) fn run(cx: &mut Cx, units: &[Unit]) {
    let errors = cx.diags.iter().filter(|d| d.severity() == Severity::Error);
    let mut broken: FxHashSet<FileId> = errors.map(|d| d.primary.span.file).collect();
    broken.extend(&cx.half_read);
    let uses = Uses::of(&cx.defs);
    // One mistake, one message: what foreign code should have written is told there.
    let (mut found, explained) = foreign_code::find(cx, units, &uses.written);
    found.retain(|d| !broken.contains(&d.primary.span.file));
    for (id, pou) in cx.defs.pous.iter_enumerated() {
        if pou.builtin || broken.contains(&pou.span.file) {
            continue;
        }
        let lint = Lint { cx, uses: &uses, explained: &explained };
        lint.variables(id, &mut found);
        if let Some(body) = cx.defs.bodies.get(id) {
            unreachable(&body.stmts, &mut found);
            Calls { cx, out: &mut found }.list(&body.stmts, &mut Way::default());
        }
    }
    found.into_iter().for_each(|d| cx.push(d));
}

/// Which variables all bodies read and write.
#[derive(Default)]
struct Uses {
    read: FxHashSet<VarId>,
    written: FxHashSet<VarId>,
}

impl Uses {
    fn of(defs: &Defs) -> Self {
        let mut uses = Self::default();
        defs.bodies.iter().for_each(|body| visit::stmts(&body.stmts, &mut uses));
        uses
    }
}

impl Visitor for Uses {
    fn place(&mut self, place: &Place, how: Use) {
        let Root::Var(var) = place.root else { return };
        // Whatever is called, referred to or connected may be written there; behind a reference another variable is.
        let followed = place.steps.iter().any(|step| matches!(step, Step::Deref));
        let uses = if how == Use::Read || followed { &mut self.read } else { &mut self.written };
        uses.insert(var);
    }

    fn call(&mut self, call: &Call) {
        self.written.extend(call.inputs.iter().map(|(var, _)| *var));
    }
}

struct Lint<'c, 'a> {
    cx: &'c Cx<'a>,
    uses: &'c Uses,
    /// Variables that another message tells about.
    explained: &'c FxHashSet<VarId>,
}

impl Lint<'_, '_> {
    fn variables(&self, pou: PouId, out: &mut Vec<Diagnostic>) {
        for &id in &self.cx.defs.pous[pou].vars {
            let var = &self.cx.defs.vars[id];
            // What a notation adds (a step) has no declaration.
            if self.cx.var_slots[id].decl.is_none() || self.explained.contains(&id) {
                continue;
            }
            if let Some(warning) = self.variable(pou, id, var) {
                out.push(warning);
            }
        }
    }

    fn variable(&self, pou: PouId, id: VarId, var: &Var) -> Option<Diagnostic> {
        let mentioned = self.cx.mentioned.borrow().contains(&id);
        let written = self.uses.written.contains(&id);
        let warn = |code: Code, message: String| Some(Diagnostic::new(code, var.span, message));
        let name = &var.name;
        match var.section {
            Section::Local | Section::Temp if !mentioned => {
                // An instance may be there for its outputs, which a trace or a panel reads: but nobody calls it.
                warn(codes::UNUSED_VARIABLE, format!("`{name}` is never used"))
                    .map(|d| d.help("remove the declaration, or write what it was meant for"))
            }
            // What only SIZEOF and its like name is not read.
            Section::Local | Section::Temp
                if !written && self.uses.read.contains(&id) && self.needs_a_writer(id, var) =>
            {
                warn(codes::NEVER_WRITTEN, format!("`{name}` is read, but nothing ever writes it"))
                    .map(|d| d.help("assign it, declare it CONSTANT or VAR_INPUT, or give it an address (AT %I..)"))
            }
            Section::Output if !written && self.needs_a_writer(id, var) && self.has_body(pou) => {
                warn(codes::NEVER_WRITTEN, format!("nothing ever writes the output `{name}`"))
                    .map(|d| d.help("assign it in the body, or remove it"))
            }
            Section::Result if !written => {
                warn(codes::NO_RESULT, format!("the function `{name}` never assigns its result"))
                    .map(|d| d.help(format!("assign it by the function's name: `{name} := ...;`")))
            }
            _ => None,
        }
    }

    /// A POU without statements is an interface that somebody else fills.
    fn has_body(&self, pou: PouId) -> bool {
        self.cx.defs.bodies.get(pou).is_some_and(|body| !body.stmts.is_empty())
    }

    /// Whether a variable that nobody writes is suspicious: one with a place of its own and no value written for it.
    fn needs_a_writer(&self, id: VarId, var: &Var) -> bool {
        let instance = matches!(self.cx.defs.types.get(var.ty), Type::Instance(_) | Type::Error);
        !(var.constant
            || var.address.is_some()
            || var.open_address.is_some()
            || var.address_taken
            || instance
            || var.init != Init::Default
            || self.has_values(var.ty)
            || self.cx.has_initialiser(id))
    }

    /// Whether a type gives its variables initial values of its own.
    fn has_values(&self, ty: TypeId) -> bool {
        match self.cx.defs.types.get(ty) {
            Type::Struct(id) => {
                let fields = &self.cx.defs.structs[*id].fields;
                fields.iter().any(|f| f.init != Init::Default || self.has_values(f.ty))
            }
            Type::Array { elem, .. } => self.has_values(*elem),
            _ => false,
        }
    }
}

/// Statements behind one that never goes on.
fn unreachable(list: &[Stmt], out: &mut Vec<Diagnostic>) {
    for (n, stmt) in list.iter().enumerate() {
        if let (Some(why), Some(next)) = (leaves(stmt), list.get(n + 1))
            && !matches!(next.kind, StmtKind::Label(_))
        {
            out.push(
                Diagnostic::new(codes::UNREACHABLE, next.span, "this statement is never reached")
                    .also(stmt.span, why)
                    .help("remove it, or make what stands before it conditional"),
            );
            return;
        }
        match &stmt.kind {
            StmtKind::If { arms, otherwise } => {
                arms.iter().for_each(|(_, body)| unreachable(body, out));
                unreachable(otherwise, out);
            }
            StmtKind::Case { arms, otherwise, .. } => {
                arms.iter().for_each(|arm| unreachable(&arm.body, out));
                unreachable(otherwise, out);
            }
            StmtKind::For { body, .. } | StmtKind::While(_, body) | StmtKind::Repeat(body, _) => {
                unreachable(body, out);
            }
            _ => {}
        }
    }
}

/// What makes control leave at a statement, whatever the conditions are.
fn leaves(stmt: &Stmt) -> Option<&'static str> {
    match &stmt.kind {
        StmtKind::Return => Some("this leaves the POU"),
        StmtKind::Exit => Some("this leaves the loop"),
        StmtKind::Continue => Some("this goes to the next pass"),
        StmtKind::Jump(_, None) => Some("this jumps elsewhere"),
        StmtKind::While(cond, body) if matches!(cond.kind, ExprKind::Const(1)) && !exits(body) => {
            Some("this loop never ends")
        }
        _ => None,
    }
}

/// Whether a loop's body can leave the loop.
fn exits(body: &[Stmt]) -> bool {
    body.iter().any(|stmt| match &stmt.kind {
        StmtKind::Exit | StmtKind::Return | StmtKind::Jump(..) => true,
        StmtKind::If { arms, otherwise } => arms.iter().any(|(_, b)| exits(b)) || exits(otherwise),
        StmtKind::Case { arms, otherwise, .. } => arms.iter().any(|a| exits(&a.body)) || exits(otherwise),
        // An EXIT in there leaves that loop only; a RETURN is rare enough to be generous.
        StmtKind::For { body, .. } | StmtKind::While(_, body) | StmtKind::Repeat(body, _) => exits(body),
        _ => false,
    })
}

/// Calls of function block instances on one way through a body.
struct Calls<'c, 'a, 'o> {
    cx: &'c Cx<'a>,
    out: &'o mut Vec<Diagnostic>,
}

/// Where an instance was called.
struct Called {
    /// The instance.
    path: String,
    /// The one input to which the call gives a value.
    only: Option<VarId>,
    span: Span,
}

impl Called {
    /// Whether two calls of an instance are two places. `PT t`, then `IN t` in IL are not: each gives another input its value.
    fn clashes(&self, other: &Self) -> bool {
        self.only.is_none() || other.only.is_none() || self.only == other.only
    }
}

/// The calls on a way through a body, in their order.
#[derive(Default)]
struct Way {
    calls: Vec<Called>,
    /// Where the calls of an instance stand in `calls`.
    by_path: FxHashMap<String, Vec<usize>>,
    /// Those before do not meet what follows.
    from: usize,
}

impl Way {
    fn push(&mut self, call: Called) {
        self.by_path.entry(call.path.clone()).or_default().push(self.calls.len());
        self.calls.push(call);
    }

    /// The first call that is another place of the same instance.
    fn first_clash(&self, call: &Called) -> Option<&Called> {
        let same = self.by_path.get(&call.path)?.iter().filter(|n| **n >= self.from).map(|n| &self.calls[*n]);
        same.into_iter().find(|c| c.clashes(call))
    }

    /// Takes the calls from a length on; gives those that may have been made when the way goes on.
    fn cut(&mut self, length: usize) -> Vec<Called> {
        let gone = self.from.clamp(length, self.calls.len()) - length;
        let cut = self.calls.split_off(length);
        for call in &cut {
            if let Some(places) = self.by_path.get_mut(&call.path) {
                places.retain(|n| *n < length);
            }
        }
        cut.into_iter().skip(gone).collect()
    }
}

impl Calls<'_, '_, '_> {
    fn list(&mut self, list: &[Stmt], called: &mut Way) {
        for stmt in list {
            match &stmt.kind {
                StmtKind::Call(call) => self.call(call, called),
                StmtKind::If { arms, otherwise } => {
                    let bodies = arms.iter().map(|(_, body)| body.as_slice()).chain([otherwise.as_slice()]);
                    self.branches(bodies, called);
                }
                StmtKind::Case { arms, otherwise, .. } => {
                    let bodies = arms.iter().map(|arm| arm.body.as_slice()).chain([otherwise.as_slice()]);
                    self.branches(bodies, called);
                }
                StmtKind::For { body, .. } | StmtKind::While(_, body) | StmtKind::Repeat(body, _) => {
                    self.list(body, called);
                }
                // A way that leaves here does not meet what follows.
                StmtKind::Return | StmtKind::Exit | StmtKind::Continue | StmtKind::Label(_) | StmtKind::Jump(..) => {
                    called.from = called.calls.len();
                }
                StmtKind::Assign { .. } | StmtKind::Eval(_) => {}
            }
        }
    }

    /// Of several branches one is taken: each starts with what was called before, and what any of them called may have
    /// been called afterwards.
    fn branches<'b>(&mut self, bodies: impl Iterator<Item = &'b [Stmt]>, called: &mut Way) {
        let (before, from) = (called.calls.len(), called.from);
        let mut found = Vec::new();
        for body in bodies {
            self.list(body, called);
            found.extend(called.cut(before));
            called.from = from;
        }
        found.into_iter().for_each(|call| called.push(call));
    }

    fn call(&mut self, call: &Call, called: &mut Way) {
        let Callee::Instance(place, _) = &call.callee else { return };
        // `t(IN := FALSE)` resets a timer before its call proper: all values are constants.
        let reset = !call.inputs.is_empty() && call.inputs.iter().all(|(_, e)| matches!(e.kind, ExprKind::Const(_)));
        let name = |var: VarId| self.cx.defs.vars[var].name.to_string();
        let Some(path) = place.fixed(name).filter(|_| !reset) else { return };
        let only = match (call.inputs.as_slice(), call.outputs.is_empty()) {
            ([(input, _)], true) => Some(*input),
            _ => None,
        };
        let here = Called { path, only, span: call.span };
        match called.first_clash(&here) {
            Some(first) => self.out.push(
                Diagnostic::new(
                    codes::CALLED_TWICE,
                    call.span,
                    format!("the instance `{}` is called twice in one cycle", here.path),
                )
                .also(first.span, "first called here")
                .help("timers, counters and edges then see two calls per cycle; use an instance for each place"),
            ),
            None => called.push(here),
        }
    }
}
