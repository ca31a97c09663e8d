//! The optimiser: passes from MIR to MIR, one file each.
//!
//! In: a verified program as lowering made it. Out: a verified program with the same meaning: after every scan the same
//! bytes in the region (but for the frames, which no one sees), the same fault with the same operands, and at a fault the
//! memory of the statement order. Results of reals are the same to the last bit: nothing is reassociated or contracted.
//!
//! The order is a table, [`passes`]; the tests run the interpreter after each of its rows.

mod algebra;
mod clean;
mod fold;
mod inline;
mod rewrite;

use crate::ir::{Func, Program};

/// A pass.
#[derive(Clone, Copy)]
pub struct Pass {
    /// Its name, as reports show it.
    pub name: &'static str,
    /// Rewrites the program.
    pub run: fn(&mut Program),
}

impl std::fmt::Debug for Pass {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// The passes in their order; a pass may come more than once.
pub fn passes() -> &'static [Pass] {
    &[Pass { name: "tidy", run: |p| each(p, tidy) }, Pass { name: "inline", run: |p| inline::run(p, tidy) }]
}

/// Runs all passes.
pub fn optimise(program: &mut Program) {
    for pass in passes() {
        (pass.run)(program);
        if cfg!(debug_assertions) {
            let problems = crate::verify::verify(program);
            if !problems.is_empty() {
                let list: String = problems.iter().map(|p| format!("{p}\n")).collect();
                plcc_diag::bug!("after the pass `{}`:\n{list}{}", pass.name, crate::print::program(program, None));
            }
        }
    }
}

/// Constants and algebra, then what that left behind.
fn tidy(func: &mut Func) {
    clean::run(func);
    fold::run(func);
    clean::run(func);
}

/// A pass over functions that needs to know nothing of the others.
fn each(program: &mut Program, run: fn(&mut Func)) {
    program.funcs.iter_mut().for_each(run);
}
