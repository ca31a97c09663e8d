//! Instruction List is as good as ST: the same logic written in both gives the same MIR, up to names of temporaries and places
//! in the source.

use plcc_hir::Profile;
use plcc_tests::{compile::compile, difference};

/// Declarations (of a function block), the body in IL, the body in ST.
const PAIRS: &[(&str, &str, &str, &str)] = &[
    (
        "a chain of Boolean operators",
        "VAR_INPUT a, b, c, d : BOOL; END_VAR VAR_OUTPUT x : BOOL; END_VAR",
        "LD a\nANDN b\nOR c\nXOR d\nNOT\nST x",
        "x := NOT ((((a AND NOT b) OR c) XOR d));",
    ),
    (
        "nested parentheses",
        "VAR_INPUT a, b, c, d : BOOL; END_VAR VAR_OUTPUT x : BOOL; END_VAR",
        "LD a\nAND( b\nORN(\nLD c\nAND d\n)\n)\nSTN x",
        "x := NOT (a AND (b OR NOT (c AND d)));",
    ),
    (
        "bit strings",
        "VAR_INPUT w, m : WORD; END_VAR VAR_OUTPUT x : WORD; high : BYTE; END_VAR",
        "LD w\nAND 16#0FF0\nXORN m\nST x\nLD x.%B1\nST high",
        "x := (w AND 16#0FF0) XOR NOT m; high := x.%B1;",
    ),
    (
        "arithmetic with constants",
        "VAR_INPUT i, j : INT; END_VAR VAR_OUTPUT k : DINT; r : REAL; END_VAR",
        "LD i\nADD 3\nMUL( j\nSUB i\n)\nST k\nLD i\nDIV 2.0\nST r",
        "k := (i + 3) * (j - i); r := i / 2.0;",
    ),
    (
        "comparison",
        "VAR_INPUT i, low, high : INT; END_VAR VAR_OUTPUT inside : BOOL; END_VAR",
        "LD i\nGE low\nAND( i\nLE high\n)\nST inside",
        "inside := (i >= low) AND (i <= high);",
    ),
    (
        "set and reset",
        "VAR_INPUT a, b : BOOL; END_VAR VAR_OUTPUT x : BOOL; END_VAR",
        "LD a\nANDN b\nS x\nLD b\nR x",
        "IF a AND NOT b THEN x := TRUE; END_IF; IF b THEN x := FALSE; END_IF;",
    ),
    (
        "one condition for two variables",
        "VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT x, y : BOOL; END_VAR",
        "LD a\nS x\nR y",
        "IF a THEN x := TRUE; END_IF; IF a THEN y := FALSE; END_IF;",
    ),
    (
        "a variable stored twice",
        "VAR_INPUT i : INT; END_VAR VAR_OUTPUT j, k : INT; END_VAR",
        "LD i\nST j\nST k",
        "j := i; k := i;",
    ),
    (
        "a timer",
        "VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT q : BOOL; END_VAR VAR t : TON; END_VAR",
        "CAL t(IN := a, PT := T#5s)\nLD t.Q\nAND a\nST q",
        "t(IN := a, PT := T#5s); q := t.Q AND a;",
    ),
    (
        "a timer by input operators",
        "VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT q : BOOL; END_VAR VAR t : TON; END_VAR",
        "LD T#5s\nPT t\nLD a\nIN t\nLD t.Q\nST q",
        "t(PT := T#5s); t(IN := a); q := t.Q;",
    ),
    (
        "a conditional call",
        "VAR_INPUT a, b : BOOL; END_VAR VAR t : TON; END_VAR",
        "LD a\nOR b\nCALC t(IN := TRUE, PT := T#1s)\nLD a\nCALCN t(IN := FALSE)",
        "IF a OR b THEN t(IN := TRUE, PT := T#1s); END_IF; IF NOT a THEN t(IN := FALSE); END_IF;",
    ),
    (
        "a conditional return",
        "VAR_INPUT a : BOOL; i : INT; END_VAR VAR_OUTPUT j : INT; END_VAR",
        "LD a\nRETC\nLD i\nADD 1\nST j",
        "IF a THEN RETURN; END_IF; j := i + 1;",
    ),
    (
        "functions",
        "VAR_INPUT i : INT; END_VAR VAR_OUTPUT j, k : INT; END_VAR",
        "LD i\nLIMIT 3, 100\nADD 1\nST j\nLD i\nTwice\nSUB j\nST k",
        "j := LIMIT(i, 3, 100) + 1; k := Twice(i) - j;",
    ),
    (
        "arrays and structures",
        "VAR_INPUT n : INT; END_VAR VAR a : ARRAY [0..9] OF INT; p, q : Point; END_VAR",
        "LD a[n]\nADD p.x\nST a[3]\nLD p\nST q\nLD q.y\nST a[n]",
        "a[3] := a[n] + p.x; q := p; a[n] := q.y;",
    ),
    (
        "a jump",
        "VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT i : INT; END_VAR",
        "LD i\nADD 1\nST i\nLD a\nJMP over\nover: LD i\nST i\nLD i\nST i",
        "i := i + 1; JMP over; over: i := i; i := i;",
    ),
];

/// The function of the block in MIR text.
fn mir(declarations: &str, body: &str) -> String {
    let text = format!(
        "TYPE Point : STRUCT x, y : INT; END_STRUCT; END_TYPE\n\
         FUNCTION Twice : INT VAR_INPUT n : INT; END_VAR Twice := n + n; END_FUNCTION\n\
         FUNCTION_BLOCK Logic {declarations}\n{body}\nEND_FUNCTION_BLOCK\n\
         PROGRAM Main VAR logic : Logic; END_VAR logic(); END_PROGRAM\n"
    );
    let program = compile(&text, Profile::Strict).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let id = program.funcs.iter_enumerated().find(|(_, f)| f.name == "Logic").expect("the block").0;
    plcc_mir::print::func(&program, id, None)
}

#[test]
fn il_and_st_give_the_same_mir() {
    let mut wrong = String::new();
    for (name, declarations, il, st) in PAIRS {
        let (il, st) = (mir(declarations, il), mir(declarations, st));
        if let Some(diff) = difference(&st, &il) {
            wrong.push_str(&format!("{name} (ST is expected, IL is what was got):\n{diff}\n"));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}
