//! The optimiser: random ST and IL programs mean the same before and after every pass. A program that does not is made small
//! and printed.

use super::{deep, generate, il, lanes, loops, setting, shared_out, source};
use plcc_hir::Profile;
use plcc_mir::ir::{Inst, Program};
use plcc_mir::opt::{Pass, passes};
use plcc_stdlib::fault::Fault;
use plcc_stdlib::prim::{PrimOp, Repr};
use plcc_stdlib::region::DEADLINE_FLAG;
use plcc_tests::compile::compile;
use plcc_tests::passes::{Disagreement, Run, agree, statuses};
use plcc_tests::reduce::reduce;
use std::time::Duration;

const RUN: Run = Run { cycles: 8, inputs: &|_, _| {}, native: true, patience: Duration::from_secs(60) };

/// How many cycles faulted, or which pass is wrong; `None` if the text does not compile.
fn outcome(text: &str, passes: &[Pass], run: &Run) -> Option<Result<usize, Disagreement>> {
    let program = compile(text, Profile::Strict).ok()?;
    Some(agree(&program, passes, run))
}

/// Whether it ended with faults; stops with the smallest text that shows the same wrong pass.
pub fn judge(seed: u64, text: &str) -> bool {
    match outcome(text, passes(), &RUN) {
        None => panic!("seed {seed} does not compile\n{text}"),
        Some(Ok(faults)) => faults > 0,
        Some(Err(found)) => panic!("seed {seed}, {found}\n{}", minimal(text, passes(), &found)),
    }
}

/// The smallest text in which the same pass goes wrong.
fn minimal(text: &str, passes: &[Pass], found: &Disagreement) -> String {
    let run = Run { native: found.pass == "native code", patience: Duration::from_millis(500), ..RUN };
    reduce(text, |text| matches!(outcome(text, passes, &run), Some(Err(other)) if other.pass == found.pass))
}

#[test]
fn passes_keep_the_meaning() {
    let (count, first) = (setting("RANDOM_PASSES", 80), setting("RANDOM_SEED", 1) + 3_000_000);
    let faults = shared_out(first..first + count, |seed| judge(seed, &source(&generate::program(seed, "", true))));
    let faults = faults.iter().filter(|f| **f).count() as u64;
    println!("{count} programs, {faults} of them with a fault");
    assert!(count < 60 || (faults > 0 && faults < count * 3 / 4), "{faults} faults");
}

/// Few of a few hundred may not compile: an index that is a constant out of bounds is an error.
#[test]
fn passes_keep_the_meaning_of_loops() {
    let (count, first) = (setting("RANDOM_PASSES", 80) * 2, setting("RANDOM_SEED", 1) + 4_000_000);
    let outcomes = shared_out(first..first + count, |seed| {
        let text = loops::program(seed);
        outcome(&text, passes(), &RUN).map(|result| match result {
            Ok(faults) => faults > 0,
            Err(found) => panic!("seed {seed}, {found}\n{}", minimal(&text, passes(), &found)),
        })
    });
    let ran = outcomes.iter().flatten().count() as u64;
    let faults = outcomes.iter().flatten().filter(|f| **f).count() as u64;
    println!("{ran} of {count} nests of loops, {faults} of them with a fault");
    assert!(ran > count / 2, "{ran} of {count} compile");
    assert!(count < 60 || (faults > 0 && faults < ran), "{faults} faults");
}

#[test]
fn passes_keep_the_meaning_of_neighbours() {
    let (count, first) = (setting("RANDOM_PASSES", 80), setting("RANDOM_SEED", 1) + 5_000_000);
    let jams = shared_out(first..first + count, |seed| {
        let text = lanes::program(seed);
        let mut program = compile(&text, Profile::Strict).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{text}"));
        match agree(&program, passes(), &Run { cycles: 3, ..RUN }) {
            Ok(faults) => assert!(faults == 0, "seed {seed} stops with a fault\n{text}"),
            Err(found) => panic!("seed {seed}, {found}\n{}", minimal(&text, passes(), &found)),
        }
        // Whether one of the rows with that name had something to do.
        let mut jammed = false;
        for pass in passes() {
            let size = |p: &Program| p.funcs.iter().flat_map(|f| &f.blocks).map(|b| b.insts.len()).sum::<usize>();
            let before = size(&program);
            (pass.run)(&mut program);
            jammed |= pass.name == "jam" && size(&program) > before;
        }
        jammed
    });
    let jams = jams.iter().filter(|jammed| **jammed).count() as u64;
    println!("{jams} of {count} programs have passes side by side");
    assert!(count < 60 || jams > count / 5, "{jams} of {count}");
}

#[test]
fn passes_keep_the_meaning_of_il() {
    let (count, first) = (setting("RANDOM_PASSES", 80) / 2, setting("RANDOM_SEED", 1) + 3_000_000);
    shared_out(first..first + count, |seed| judge(seed, &il::random_text(seed)));
}

/// The test tests: a wrong pass is found, named, and shown with a program of a few lines.
#[test]
fn a_wrong_pass_is_found_and_its_program_made_small() {
    fn wrong(program: &mut Program) {
        for inst in program.funcs.iter_mut().flat_map(|f| &mut f.blocks).flat_map(|b| &mut b.insts) {
            if let Inst::Prim { op: op @ PrimOp::MaxS, repr: Repr::I16, .. } = inst {
                *op = PrimOp::MinS;
            }
        }
    }
    let list = [&passes()[..1], &[Pass { name: "wrong", run: wrong }]].concat();
    deep(|| {
        let text = (1..).map(|seed| source(&generate::program(seed, "", false)));
        let failing = text.filter_map(|text| match outcome(&text, &list, &Run { native: false, ..RUN }) {
            Some(Err(found)) => Some((text, found)),
            _ => None,
        });
        let (text, found) = failing.take(5).min_by_key(|(text, _)| text.len()).expect("programs with MAX of INT");
        assert_eq!(found.pass, "pass 1 `wrong`");
        let small = minimal(&text, &list, &found);
        assert!(small.contains("MAX(") || small.contains("LIMIT("), "{small}");
        assert!(small.lines().count() < 25, "{small}");
        let again = outcome(&small, &list, &Run { native: false, ..RUN });
        assert!(matches!(again, Some(Err(again)) if again.pass == found.pass), "{small}");
    });
}

/// What a reduced text is: nothing in it can be missed.
#[test]
fn reduction_keeps_what_the_question_needs() {
    let text = "a\nIF x THEN\n  b\n  WHILE y DO\n    c\n  END_WHILE;\nELSE\n  d\nEND_IF;\ne\n";
    // A text counts only if its frames are whole, as a compiler would see it.
    let whole = |t: &str, open: &str, close: &str| t.contains(open) == t.contains(close);
    let fails = |t: &str| t.contains('c') && whole(t, "IF x", "END_IF") && whole(t, "WHILE y", "END_WHILE");
    assert_eq!(reduce(text, fails), "    c\n");
    assert_eq!(reduce(text, |t| fails(t) && t.contains("WHILE")), "  WHILE y DO\n    c\n  END_WHILE;\n");
    assert_eq!(reduce(text, |_| false), text);
}

/// However they are nested and whatever is known of the loops around them, endless loops are caught: the watchdog's flag is
/// set before the cycle, so that the first poll leaves. Without a poll the test does not end.
#[test]
fn endless_loops_stay_caught() {
    let loops = [
        "WHILE TRUE DO x := x + 1; END_WHILE;",
        "WHILE TRUE DO FOR i := 1 TO 3 DO a[i] := x; END_FOR; END_WHILE;",
        "FOR i := 1 TO 3 DO WHILE x >= 0 DO x := x MOD 7; END_WHILE; END_FOR;",
        "REPEAT FOR i := 1 TO 3 DO FOR j := 1 TO 3 DO a[j] := i; END_FOR; END_FOR; UNTIL FALSE END_REPEAT;",
        "FOR i := 1 TO 2 DO FOR j := 1 TO 2 DO REPEAT x := 0; UNTIL x > 0 END_REPEAT; END_FOR; END_FOR;",
        "WHILE TRUE DO END_WHILE;",
        "WHILE TRUE DO WHILE x < 5 DO x := x + 1; END_WHILE; x := 0; END_WHILE;",
        "FOR i := 1 TO 3 DO x := spin(x); END_FOR;",
    ];
    for body in loops {
        let text = format!(
            "FUNCTION spin : DINT VAR_INPUT n : DINT; END_VAR VAR k : DINT; END_VAR\n\
             WHILE k <= n OR k > n DO k := k + 1; END_WHILE;\nspin := k;\nEND_FUNCTION\n\
             PROGRAM Main VAR x : DINT; i, j : INT; a : ARRAY [1..3] OF DINT; END_VAR\n{body}\nEND_PROGRAM\n"
        );
        let mut program = compile(&text, Profile::Strict).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let set = |_: usize, mem: &mut [u8]| mem[DEADLINE_FLAG as usize] = 1;
        // Which poll leaves may change, and with it the memory; that one does may not.
        for (row, pass) in passes().iter().enumerate() {
            (pass.run)(&mut program);
            let run = Run { cycles: 1, inputs: &set, native: row + 1 == passes().len(), ..RUN };
            assert_eq!(statuses(&program, &run), [Fault::Deadline.number()], "{}\n{text}", pass.name);
        }
    }
}
