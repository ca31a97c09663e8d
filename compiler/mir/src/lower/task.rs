//! The entry of a task: its program instances in order of declaration, each between the copies of its connections
//! (semantics.md \[C1\]). Also the size of the frames, which is that of the longest chain of calls of any task.

use super::Context;
use super::func::FuncLower;
use super::place::Access;
use crate::build::Builder;
use crate::ir::{Base, Func, FuncId, Inst, Place, Program};
use crate::layout::shape::repr;
use index_vec::IndexVec;
use plcc_hir::app::{self, Resource};
use plcc_hir::{Types, VarId};

/// Lowers the entry of task number `index`.
pub(super) fn lower(cx: &mut Context<'_>, resource: &Resource, index: usize, task: &app::Task) -> Func {
    let name = if task.name.is_empty() { "task".to_string() } else { format!("task {}", task.name) };
    let builder = Builder::new(name.clone(), &[], None, false);
    let mut f = FuncLower::new(cx, builder, name, None, 0);
    for (n, program) in resource.programs.iter().enumerate().filter(|(_, p)| p.task == index) {
        f.program(program, f.cx.layout.program(n));
    }
    f.b.ret(None);
    f.finish()
}

impl FuncLower<'_, '_> {
    /// One execution of the program instance at `start`.
    fn program(&mut self, program: &app::Program, start: u32) {
        let instance = Self::plain(Place::new(Base::Region, start), Types::VOID);
        for (var, value) in &program.inputs {
            if repr(self.defs, value.ty).is_some() {
                let value = self.value(value);
                let to = self.program_variable(&instance, *var);
                self.store(&to, value);
            } else {
                let to = self.program_variable(&instance, *var);
                self.aggregate_into(value, to.place);
            }
        }
        let func = self.func(program.pou);
        self.at(program.span, "");
        self.b.call(func, Some(instance.place.clone()), &[], None);
        for (var, target) in &program.outputs {
            let from = self.program_variable(&instance, *var);
            if repr(self.defs, from.ty).is_some() {
                let value = self.load(&from);
                let to = self.place(target);
                self.store(&to, value);
            } else {
                let to = self.place(target);
                let bytes = self.cx.layout.size(self.defs, from.ty);
                self.b.copy(to.place, from.place, bytes);
            }
        }
    }

    fn program_variable(&mut self, instance: &Access, var: VarId) -> Access {
        self.member(instance, var)
    }
}

/// Bytes of the longest chain of frames that a task can need. There is no recursion (HIR).
pub(super) fn frame_bytes(program: &Program) -> u64 {
    let mut depth: IndexVec<FuncId, Option<u64>> = program.funcs.iter().map(|_| None).collect();
    // A function is visited when it is met and again behind all it calls.
    let mut work: Vec<(FuncId, bool)> = program.funcs.indices().map(|f| (f, false)).collect();
    while let Some((id, callees_done)) = work.pop() {
        if depth[id].is_some() {
            continue;
        }
        let func = &program.funcs[id];
        if callees_done {
            let longest = callees(func).filter_map(|c| depth[c]).max().unwrap_or(0);
            depth[id] = Some(u64::from(func.frame_bytes).saturating_add(longest));
        } else {
            work.push((id, true));
            work.extend(callees(func).filter(|c| depth[*c].is_none()).map(|c| (c, false)));
        }
    }
    depth.iter().flatten().copied().max().unwrap_or(0)
}

fn callees(func: &Func) -> impl Iterator<Item = FuncId> + '_ {
    func.blocks.iter().flat_map(|block| &block.insts).filter_map(|inst| match inst {
        Inst::Call { callee, .. } => Some(*callee),
        _ => None,
    })
}
