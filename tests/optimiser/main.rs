//! What single passes of the optimiser achieve, on small programs: how much of a kind of instruction is left. That the
//! programs still mean the same is tested for each of them as well.

mod arrange;
mod divide;
mod lanes;
mod ranges;
mod unroll;

use plcc_hir::Profile;
use plcc_mir::ir::{Inst, Program};
use plcc_mir::opt::passes;
use plcc_tests::compile::compile;
use plcc_tests::passes::{Run, agree};

/// A program of these declarations and statements behind all passes, which keep its meaning.
fn optimised(declarations: &str, body: &str) -> Program {
    optimised_with("", declarations, body)
}

/// The same with POUs and types in front.
fn optimised_with(before: &str, declarations: &str, body: &str) -> Program {
    let text = format!("{before}PROGRAM Main\nVAR\n{declarations}\nEND_VAR\n{body}\nEND_PROGRAM\n");
    let mut program = compile(&text, Profile::Strict).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let run = Run { cycles: 4, inputs: &|_, _| {}, native: true, patience: std::time::Duration::from_secs(60) };
    agree(&program, passes(), &run).unwrap_or_else(|e| panic!("{e}\n{text}"));
    passes().iter().for_each(|pass| (pass.run)(&mut program));
    program
}

/// How many instructions of a kind are left.
fn count(program: &Program, kind: impl Fn(&Inst) -> bool) -> usize {
    program.funcs.iter().flat_map(|f| &f.blocks).flat_map(|b| &b.insts).filter(|inst| kind(inst)).count()
}
