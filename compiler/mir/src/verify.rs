//! Is a program well formed? Every pass must leave it so; a problem is a bug of the compiler, never of the user.
//!
//! In: a [`Program`]. Out: a list of [`Problem`]s, empty if all is well: values defined once and before their use on
//! every way, representations of all operands, arguments of jumps and calls, places inside the region, no recursion,
//! frames that fit. The meaning of the code is not its business.

use crate::dominators::Dominators;
use crate::ir::{
    Base, Block, BlockId, Cond, Exit, Func, FuncId, Inst, Place, Program, SourceId, Target, Term, ValueId,
};
use index_vec::IndexVec;
use plcc_stdlib::prim::Repr;
use rustc_hash::FxHashSet;
use std::fmt;

/// What is wrong, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// The function; `None` for the tables of the program.
    pub func: Option<FuncId>,
    /// Its name.
    pub name: String,
    /// Block, and number of the instruction; the number behind the last one is the end of the block.
    pub at: Option<(BlockId, usize)>,
    /// In words.
    pub message: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.func.is_some() {
            write!(f, "`{}`", self.name)?;
        } else {
            write!(f, "program")?;
        }
        if let Some((block, inst)) = self.at {
            write!(f, " b{}:{inst}", block.index())?;
        }
        write!(f, ": {}", self.message)
    }
}

/// Every problem of the program.
pub fn verify(program: &Program) -> Vec<Problem> {
    let mut problems = Vec::new();
    verify_tables(program, &mut problems);
    for id in program.funcs.indices() {
        verify_func(program, id, &mut problems);
    }
    verify_calls(program, &mut problems);
    problems
}

/// Every problem inside one function: what a pass over functions checks after itself.
pub fn verify_func(program: &Program, id: FuncId, problems: &mut Vec<Problem>) {
    let func = &program.funcs[id];
    let mut checker = Checker { program, func, id, at: None, problems };
    if func.blocks.is_empty() {
        checker.report("no entry block");
        return;
    }
    checker.head();
    let Some(defs) = checker.definitions() else { return };
    let tree = Dominators::new(func);
    for (block, body) in func.blocks.iter_enumerated() {
        for (n, inst) in body.insts.iter().enumerate() {
            checker.at = Some((block, n));
            checker.inst(inst);
            inst.for_each_use(|v| checker.visible(v, &defs, &tree));
        }
        checker.at = Some((block, body.insts.len()));
        checker.term(body);
        body.term.for_each_use(|v| checker.visible(v, &defs, &tree));
    }
}

/// Where a value comes from: its block, and 0 for a parameter or 1 + the number of its instruction.
type Defs = IndexVec<ValueId, Option<(BlockId, usize)>>;

struct Checker<'a> {
    program: &'a Program,
    func: &'a Func,
    id: FuncId,
    at: Option<(BlockId, usize)>,
    problems: &'a mut Vec<Problem>,
}

impl Checker<'_> {
    fn report(&mut self, message: impl Into<String>) {
        self.problems.push(Problem {
            func: Some(self.id),
            name: self.func.name.clone(),
            at: self.at,
            message: message.into(),
        });
    }

    fn demand(&mut self, holds: bool, message: impl FnOnce() -> String) {
        if !holds {
            self.report(message());
        }
    }

    fn repr(&self, value: ValueId) -> Option<Repr> {
        self.func.values.get(value).copied()
    }

    fn is(&mut self, value: ValueId, want: Repr, what: &str) {
        match self.repr(value) {
            None => self.report(format!("{what}: no value v{}", value.index())),
            Some(got) => self.demand(got == want, || {
                format!("{what}: v{} is {}, wanted {}", value.index(), got.name(), want.name())
            }),
        }
    }

    fn head(&mut self) {
        let func = self.func;
        self.demand(func.frame_bytes.is_multiple_of(16), || format!("frame of {} bytes", func.frame_bytes));
        let entry = &func.blocks[BlockId::from_usize(0)];
        self.demand(entry.params.len() == func.params.len(), || {
            format!("entry block with {} parameters, function with {}", entry.params.len(), func.params.len())
        });
        for (value, want) in entry.params.iter().zip(&func.params) {
            self.is(*value, *want, "parameter");
        }
    }

    /// `None` if an id is outside the table of values, so that nothing else can be said.
    fn definitions(&mut self) -> Option<Defs> {
        let func = self.func;
        let mut defs: Defs = IndexVec::from_vec(vec![None; func.values.len()]);
        let mut sound = true;
        for (block, body) in func.blocks.iter_enumerated() {
            let params = body.params.iter().map(|v| (*v, 0));
            let results = body.insts.iter().enumerate().flat_map(|(n, inst)| {
                let (first, second) = inst.results();
                first.into_iter().chain(second).map(move |v| (v, n + 1))
            });
            for (value, place) in params.chain(results) {
                self.at = Some((block, place.saturating_sub(1)));
                match defs.get_mut(value) {
                    None => {
                        sound = false;
                        self.report(format!("defines v{}, which has no representation", value.index()));
                    }
                    Some(def @ None) => *def = Some((block, place)),
                    Some(Some(_)) => self.report(format!("v{} is defined twice", value.index())),
                }
            }
        }
        self.at = None;
        sound.then_some(defs)
    }

    fn visible(&mut self, value: ValueId, defs: &Defs, tree: &Dominators) {
        let Some((block, inst)) = self.at else { return };
        match defs.get(value) {
            None => {} // reported with the operand
            Some(None) => self.report(format!("v{} is never defined", value.index())),
            Some(Some((home, place))) => {
                let before = if *home == block {
                    *place <= inst
                } else {
                    !tree.is_reachable(block) || tree.dominates(*home, block)
                };
                self.demand(before, || format!("v{} is not defined on every way that leads here", value.index()));
            }
        }
    }

    fn source(&mut self, source: SourceId) {
        let rows = self.program.sources.len();
        self.demand(source.index() < rows, || format!("no row {} in the source table", source.index()));
    }

    fn exit(&mut self, exit: &Exit) {
        self.source(exit.source);
        if let Some(place) = &exit.instance {
            self.whole(place, 0);
        }
        for (place, value) in &exit.owed {
            self.scalar(*value, place);
        }
    }

    fn inst(&mut self, inst: &Inst) {
        match inst {
            Inst::Const { dst, raw } => {
                if let Some(repr) = self.repr(*dst) {
                    self.demand(*raw & !repr.mask() == 0, || format!("{raw:#x} does not fit {}", repr.name()));
                }
            }
            Inst::Prim { dst, op, repr, args } => {
                self.demand(op.accepts(*repr), || format!("{op:?} is not defined on {}", repr.name()));
                self.demand(op.arity() == args.len(), || format!("{op:?} with {} operands", args.len()));
                for (n, arg) in args.iter().enumerate() {
                    self.is(*arg, op.operand(*repr, n), "operand");
                }
                self.is(*dst, op.result(*repr), "result");
            }
            Inst::Load { dst, place, normalise } => {
                let repr = self.scalar(*dst, place);
                self.demand(!normalise || repr == Some(Repr::I8), || "only a truth value is normalised".into());
                self.demand(!(*normalise && place.bit.is_some()), || "a bit needs no normalising".into());
            }
            Inst::Store { place, value } => {
                self.scalar(*value, place);
            }
            Inst::Copy { dst, src, bytes } => {
                self.whole(dst, *bytes);
                self.whole(src, *bytes);
            }
            Inst::Zero { dst, bytes } => self.whole(dst, *bytes),
            Inst::AddressOf { dst, place, bytes } => {
                self.is(*dst, Repr::I32, "address");
                self.whole(place, *bytes);
            }
            Inst::Call { dst, callee, instance, args, status, exit } => {
                self.exit(exit);
                self.demand(exit.owed.is_empty(), || "a call owes a store".into());
                self.call(*dst, *callee, instance.as_ref(), args);
                if let Some(status) = status {
                    self.is(*status, Repr::I32, "status");
                }
            }
            Inst::CallRt { dst, func, args } => {
                self.demand(args.len() == func.params.len(), || {
                    format!("`{}` with {} arguments", func.symbol, args.len())
                });
                for (arg, want) in args.iter().zip(func.params) {
                    self.is(*arg, *want, func.symbol);
                }
                self.is(*dst, func.result, func.symbol);
            }
            Inst::CallText { dst, func, texts, args } => {
                self.demand(texts.len() == func.texts && args.len() == func.params, || {
                    format!("`{}` with {} strings and {} arguments", func.symbol, texts.len(), args.len())
                });
                for text in texts {
                    self.whole(&text.place, 0);
                    self.is(text.capacity, Repr::I32, "capacity");
                }
                for arg in args {
                    self.is(*arg, Repr::I64, func.symbol);
                }
                self.is(*dst, Repr::I64, func.symbol);
            }
            Inst::Check { cond, operands, exit, .. } => {
                self.exit(exit);
                let own = match cond {
                    Cond::True(value) => {
                        self.is(*value, Repr::I8, "condition");
                        0
                    }
                    Cond::Within { value, low, high } => {
                        self.is(*value, Repr::I64, "checked value");
                        self.demand(low <= high, || format!("no value lies within {low}..{high}"));
                        3
                    }
                };
                self.demand(own + operands.len() <= 3, || "a fault has at most three operands".into());
                for operand in operands {
                    self.is(*operand, Repr::I64, "operand of a fault");
                }
            }
            Inst::Poll { exit } => self.exit(exit),
        }
    }

    fn scalar(&mut self, value: ValueId, place: &Place) -> Option<Repr> {
        let repr = self.repr(value);
        match (repr, place.bit) {
            (None, _) => self.report(format!("no value v{}", value.index())),
            (Some(_), Some(bit)) => {
                self.is(value, Repr::I8, "bit");
                self.demand(bit < 8, || format!("bit {bit} of a byte"));
            }
            (Some(_), None) => {}
        }
        self.place(place, repr.map_or(1, Repr::bytes));
        repr
    }

    fn whole(&mut self, place: &Place, bytes: u32) {
        self.demand(place.bit.is_none(), || "a bit is no aggregate and has no address".into());
        self.place(place, bytes);
    }

    fn place(&mut self, place: &Place, bytes: u32) {
        let (mut first, mut last) = (i128::from(place.offset), i128::from(place.offset));
        for term in &place.index {
            self.is(term.value, Repr::I64, "index");
            self.demand(term.low <= term.high, || format!("no index lies within {}..{}", term.low, term.high));
            first += i128::from(term.low) * i128::from(term.stride);
            last += i128::from(term.high) * i128::from(term.stride);
        }
        let end = last + i128::from(bytes);
        match place.base {
            Base::Region => {
                let size = self.program.region_bytes;
                self.demand(first >= 0 && end <= i128::from(size), || {
                    format!("bytes {first}..{end} are not in the region of {size}")
                });
            }
            Base::Instance => {
                let known = self.func.has_instance;
                self.demand(known, || "a place in the instance of a function without one".into());
                self.demand(first >= 0, || format!("byte {first} of the instance"));
            }
            Base::Frame => self.demand(first >= 0, || format!("byte {first} of the frame")),
            Base::Reference(value) => self.is(value, Repr::I32, "reference"),
        }
    }

    fn call(&mut self, dst: Option<ValueId>, callee: FuncId, instance: Option<&Place>, args: &[ValueId]) {
        let Some(target) = self.program.funcs.get(callee) else {
            self.report(format!("calls f{}, which does not exist", callee.index()));
            return;
        };
        self.demand(instance.is_some() == target.has_instance, || {
            let with = if target.has_instance { "without an" } else { "with an" };
            format!("calls `{}` {with} instance", target.name)
        });
        if let Some(place) = instance {
            self.whole(place, 0);
        }
        self.demand(args.len() == target.params.len(), || {
            format!("calls `{}` with {} of {} arguments", target.name, args.len(), target.params.len())
        });
        for (arg, want) in args.iter().zip(&target.params) {
            self.is(*arg, *want, "argument");
        }
        match (dst, target.result) {
            (Some(dst), Some(want)) => self.is(dst, want, "result"),
            (Some(_), None) => self.report(format!("`{}` has no result", target.name)),
            (None, _) => {}
        }
    }

    fn term(&mut self, block: &Block) {
        match &block.term {
            Term::Jump(target) => self.target(target),
            Term::Branch { cond, then, otherwise } => {
                self.is(*cond, Repr::I8, "condition");
                self.target(then);
                self.target(otherwise);
            }
            Term::Switch { value, cases, default } => {
                let repr = self.repr(*value);
                self.demand(repr.is_some_and(Repr::is_int), || "a choice needs an integer".into());
                let mask = repr.map_or(u64::MAX, Repr::mask);
                let mut seen = FxHashSet::default();
                for (label, target) in cases {
                    self.demand(label & !mask == 0, || format!("label {label:#x} is too wide"));
                    self.demand(seen.insert(*label), || format!("label {label:#x} stands twice"));
                    self.target(target);
                }
                self.target(default);
            }
            Term::Return(value) => match (value, self.func.result) {
                (Some(value), Some(want)) => self.is(*value, want, "result"),
                (None, None) => {}
                (Some(_), None) => self.report("returns a result but has none"),
                (None, Some(_)) => self.report("returns without its result"),
            },
        }
    }

    fn target(&mut self, target: &Target) {
        let Some(block) = self.func.blocks.get(target.block) else {
            self.report(format!("jumps to b{}, which does not exist", target.block.index()));
            return;
        };
        self.demand(block.params.len() == target.args.len(), || {
            format!("b{} takes {} values, got {}", target.block.index(), block.params.len(), target.args.len())
        });
        for (param, arg) in block.params.iter().zip(&target.args) {
            if let Some(want) = self.repr(*param) {
                self.is(*arg, want, "jump");
            }
        }
    }
}

fn verify_tables(program: &Program, problems: &mut Vec<Problem>) {
    let mut report = |message: String| {
        problems.push(Problem { func: None, name: String::new(), at: None, message });
    };
    let size = u64::from(program.region_bytes);
    for segment in &program.initial {
        if u64::from(segment.offset) + segment.bytes.len() as u64 > size {
            report(format!("initial bytes at {} leave the region", segment.offset));
        }
    }
    let mut end = 0;
    for (start, length) in &program.retain {
        if u64::from(*start) < end {
            report(format!("retain range at {start} is not behind the one before"));
        }
        end = u64::from(*start) + u64::from(*length);
        if end > size {
            report(format!("retain range at {start} leaves the region"));
        }
    }
    if !program.frame_base.is_multiple_of(16) {
        report(format!("frames start at {}", program.frame_base));
    }
    for task in &program.tasks {
        match program.funcs.get(*task) {
            None => report(format!("the entry f{} of a task does not exist", task.index())),
            Some(f) if f.has_instance || !f.params.is_empty() || f.result.is_some() => {
                report(format!("`{}` is no entry of a task", f.name));
            }
            Some(_) => {}
        }
    }
}

/// Recursion, and frames behind the end of the region.
fn verify_calls(program: &Program, problems: &mut Vec<Problem>) {
    let mut report = |func: FuncId, message: String| {
        problems.push(Problem { func: Some(func), name: program.funcs[func].name.clone(), at: None, message });
    };
    let order = match bottom_up(program) {
        Ok(order) => order,
        Err(func) => return report(func, "calls itself".into()),
    };
    let mut need: IndexVec<FuncId, u64> = IndexVec::from_vec(vec![0; program.funcs.len()]);
    for id in order {
        let callees = program.funcs[id].callees().filter(|c| c.index() < program.funcs.len());
        let deepest = callees.map(|c| need[c]).max().unwrap_or(0);
        need[id] = u64::from(program.funcs[id].frame_bytes) + deepest;
    }
    for task in program.tasks.iter().filter(|t| t.index() < program.funcs.len()) {
        if need[*task] > 0 && u64::from(program.frame_base) + need[*task] > u64::from(program.region_bytes) {
            report(*task, format!("its frames need {} bytes from {} on", need[*task], program.frame_base));
        }
    }
}

/// The functions, callees before their callers; `Err` names one that calls itself, directly or not.
pub fn bottom_up(program: &Program) -> Result<Vec<FuncId>, FuncId> {
    #[derive(Clone, Copy, PartialEq)]
    enum State {
        New,
        Open,
        Done,
    }
    let callees = |id: FuncId| {
        let list: Vec<FuncId> = program.funcs[id].callees().filter(|c| c.index() < program.funcs.len()).collect();
        list.into_iter()
    };
    let mut state: IndexVec<FuncId, State> = IndexVec::from_vec(vec![State::New; program.funcs.len()]);
    let mut order = Vec::with_capacity(program.funcs.len());
    for root in program.funcs.indices() {
        if state[root] != State::New {
            continue;
        }
        state[root] = State::Open;
        let mut stack = vec![(root, callees(root))];
        while let Some((id, rest)) = stack.last_mut() {
            match rest.next() {
                Some(next) if state[next] == State::New => {
                    state[next] = State::Open;
                    stack.push((next, callees(next)));
                }
                Some(next) if state[next] == State::Open => return Err(next),
                Some(_) => {}
                None => {
                    state[*id] = State::Done;
                    order.push(*id);
                    stack.pop();
                }
            }
        }
    }
    Ok(order)
}

#[cfg(test)]
mod tests;
