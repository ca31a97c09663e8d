//! The entry of a task: its program instances in order of declaration, each between the copies of its connections
//! (semantics.md \[C1\]). Also the size of the frames, which is that of the longest chain of calls of any task.

use super::Context;
use super::func::FuncLower;
use super::place::Access;
use crate::build::Builder;
use crate::ir::{Base, Func, FuncId, Place, Program};
use crate::verify::bottom_up;
use index_vec::IndexVec;
use plcc_diag::bug;
use plcc_hir::app::{self, Resource, VarPath};
use plcc_hir::body::{Place as HirPlace, Root};
use plcc_hir::shape::repr;
use plcc_hir::{Area, Types, VarId};

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
                self.store_aggregate(value, &to);
            }
        }
        for (path, address) in program.located.iter().filter(|(_, at)| area(at) != Area::Output) {
            let from = self.place(address);
            let to = self.inside(&instance, path);
            self.copy_scalar_or_all(&from, &to);
        }
        let func = self.func(program.pou);
        self.at(program.span, "");
        self.b.call(func, Some(instance.place.clone()), &[], None);
        for (var, target) in &program.outputs {
            let from = self.program_variable(&instance, *var);
            let to = self.place(target);
            self.copy_scalar_or_all(&from, &to);
        }
        for (path, address) in program.located.iter().filter(|(_, at)| area(at) != Area::Input) {
            let from = self.inside(&instance, path);
            let to = self.place(address);
            self.copy_scalar_or_all(&from, &to);
        }
    }

    fn program_variable(&mut self, instance: &Access, var: VarId) -> Access {
        self.member(instance, var)
    }

    /// A variable inside a program instance.
    fn inside(&mut self, instance: &Access, path: &VarPath) -> Access {
        path.iter().fold(instance.clone(), |outer, var| self.member(&outer, *var))
    }

    fn copy_scalar_or_all(&mut self, from: &Access, to: &Access) {
        if repr(self.defs, from.ty).is_some() {
            let value = self.load(from);
            return self.store(to, value);
        }
        self.copy_aggregate(to, from);
    }
}

/// The area of an address.
fn area(place: &HirPlace) -> Area {
    match place.root {
        Root::Address(address) => address.area,
        _ => bug!("VAR_CONFIG locates at {:?}", place.root),
    }
}

/// Bytes of the longest chain of frames that a task can need.
pub(crate) fn frame_bytes(program: &Program) -> u64 {
    let order = match bottom_up(program) {
        Ok(order) => order,
        Err(id) => bug!("`{}` calls itself", program.funcs[id].name),
    };
    let mut need: IndexVec<FuncId, u64> = program.funcs.iter().map(|_| 0).collect();
    for id in order {
        let func = &program.funcs[id];
        let deepest = func.callees().map(|c| need[c]).max().unwrap_or(0);
        need[id] = deepest.saturating_add(u64::from(func.frame_bytes));
    }
    need.iter().copied().max().unwrap_or(0)
}
