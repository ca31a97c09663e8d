//! The optimiser: passes from MIR to MIR, one file each.
//!
//! In: a verified program as lowering made it. Out: a verified program with the same meaning: after every scan the same
//! bytes in the region (but for the frames, which no one sees), the same fault with the same operands, and at a fault the
//! memory of the statement order. Results of reals are the same to the last bit: nothing is reassociated or contracted.
//!
//! The order is a table, [`passes`]; the tests run the interpreter after each of its rows.

mod aggregates;
mod algebra;
mod alias;
mod appends;
mod clean;
mod copies;
mod dead_stores;
mod divide;
mod early;
mod fold;
mod forward;
mod frames;
mod hoist;
mod in_place;
mod induction;
mod inline;
mod jam;
mod loops;
mod moves;
mod promote;
mod proven;
mod ranges;
mod reload;
mod rewrite;
mod rotate;
mod scale;
mod select;
mod ssa;
mod texts;
mod unroll;

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
    const TIDY: Pass = Pass { name: "tidy", run: |p| each(p, tidy) };
    const FOLD: Pass = Pass { name: "fold", run: |p| each(p, fold_and_clean) };
    const FRAMES: Pass = Pass { name: "frames", run: |p| with_facts(p, frames::run) };
    const FORWARD: Pass = Pass { name: "forward", run: |p| with_facts(p, forward::run) };
    const COPIES: Pass = Pass { name: "copies", run: |p| with_facts(p, copies::run) };
    // Both ask the same facts, which neither changes.
    const TEXTS: Pass = Pass { name: "texts", run: |p| with_facts_where(p, has_texts, in_place_and_texts) };
    const DEAD_STORES: Pass = Pass { name: "dead_stores", run: |p| with_facts(p, dead_stores::run) };
    const SELECT: Pass = Pass { name: "select", run: |p| with_facts(p, select::run) };
    const HOIST: Pass = Pass { name: "hoist", run: |p| with_facts(p, hoist::run) };
    const RANGES: Pass = Pass { name: "ranges", run: |p| each(p, ranges::run) };
    const INDUCTION: Pass = Pass { name: "induction", run: |p| each(p, induction::run) };
    // What loops leave behind: functions without loops have seen it before.
    const LOOP_FOLD: Pass = Pass { name: "fold", run: |p| each_with_loops(p, |f, _| fold_and_clean(f)) };
    const LOOP_FORWARD: Pass = Pass { name: "forward", run: |p| each_with_loops(p, forward::run) };
    const JAM: Pass = Pass { name: "jam", run: |p| with_facts_where(p, jam::may_help, jam::run) };
    const LOOP_DEAD_STORES: Pass = Pass { name: "dead_stores", run: |p| each_with_loops(p, dead_stores::run) };
    #[rustfmt::skip]
    const PASSES: &[Pass] = &[
        Pass { name: "references", run: alias::keep },
        TIDY,
        Pass { name: "inline", run: |p| inline::run(p, tidy) },
        Pass { name: "aggregates", run: |p| each(p, aggregates::run) },
        FRAMES, TIDY, FORWARD, FOLD, COPIES, DEAD_STORES,
        TEXTS,
        Pass { name: "appends", run: |p| each(p, appends::run) },
        SELECT, FOLD, FORWARD, DEAD_STORES, FRAMES, TIDY,
        RANGES, FOLD,
        Pass { name: "promote", run: |p| with_facts(p, promote::run) }, LOOP_FOLD, LOOP_FORWARD, LOOP_FOLD,
        RANGES, FOLD, HOIST, LOOP_FORWARD, LOOP_DEAD_STORES, LOOP_FOLD,
        // Counters first: of a loop that was repeated they are not seen any more.
        SELECT, FOLD, INDUCTION, FOLD,
        // Of small nests only the outer loops are left after the next row.
        JAM,
        Pass { name: "unroll", run: |p| each(p, unroll::run) }, LOOP_FOLD, FORWARD, COPIES, TEXTS, DEAD_STORES, FOLD,
        JAM,
        Pass { name: "late_ranges", run: |p| each(p, ranges::run_late) }, FOLD,
        Pass { name: "divide", run: |p| each(p, divide::run) },
        Pass { name: "scale", run: |p| each(p, scale::run) }, FOLD, INDUCTION, LOOP_FOLD, HOIST,
        Pass { name: "arrange", run: |p| with_facts(p, arrange) },
        Pass { name: "rotate", run: |p| each(p, rotate::run) },
        Pass { name: "clean", run: |p| each(p, clean::run) },
    ];
    PASSES
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

/// Constants and algebra, in front of which and behind which the graph is tidied.
fn tidy(func: &mut Func) {
    clean::run(func);
    fold_and_clean(func);
}

/// The same for a graph that is tidy already.
fn fold_and_clean(func: &mut Func) {
    fold::run(func);
    clean::run(func);
}

/// A pass over functions that asks what may be the same memory.
fn with_facts(program: &mut Program, run: fn(&mut Func, &alias::Alias)) {
    with_facts_where(program, |_| true, run);
}

/// The same over functions that have loops.
fn each_with_loops(program: &mut Program, run: fn(&mut Func, &alias::Alias)) {
    with_facts_where(program, may_loop, run);
}

fn with_facts_where(program: &mut Program, wanted: fn(&Func) -> bool, run: fn(&mut Func, &alias::Alias)) {
    if !program.funcs.iter().any(wanted) {
        return;
    }
    let facts = alias::Facts::new(program);
    for (id, func) in program.funcs.iter_mut().enumerate().filter(|(_, func)| wanted(func)) {
        let alias = alias::Alias::new(&facts, crate::ir::FuncId::from_usize(id), func);
        run(func, &alias);
    }
}

/// However blocks are numbered, every circle has a jump to a number that is not greater; in a tidy graph only circles have.
fn may_loop(func: &Func) -> bool {
    func.blocks.iter_enumerated().any(|(id, block)| {
        let mut back = false;
        block.term.for_each_target(|target| back |= target.block <= id);
        back
    })
}

/// The last that is asked about memory: where what is done stands best for the machine.
fn arrange(func: &mut Func, alias: &alias::Alias) {
    if may_loop(func) {
        reload::run(func, alias);
    }
    moves::run(func, alias);
    early::run(func, alias);
}

/// Results are built in place, then what is known of strings is not asked again.
fn in_place_and_texts(func: &mut Func, alias: &alias::Alias) {
    in_place::run(func, alias);
    texts::run(func, alias);
}

/// Whether a function builds, copies or reads aggregates or strings.
fn has_texts(func: &Func) -> bool {
    use crate::ir::Inst;
    let insts = || func.blocks.iter().flat_map(|b| &b.insts);
    insts().any(|inst| matches!(inst, Inst::CallText { .. } | Inst::Copy { .. }))
}

/// A pass over functions that needs to know nothing of the others.
fn each(program: &mut Program, run: fn(&mut Func)) {
    program.funcs.iter_mut().for_each(run);
}
