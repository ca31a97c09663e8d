//! No input makes the parser panic, overflow its stack or take long: deep nesting, openers without end, and programs damaged at
//! random (the seed is fixed, so a failure repeats).

use plcc_diag::{Diagnostics, FileId};
use plcc_syntax::{Profile, ast, parse_file, print_tokens};
use std::time::{Duration, Instant};

/// Runs `f` with the stack that the driver gives to its pipeline.
fn with_large_stack(f: impl FnOnce() + Send + 'static) {
    std::thread::Builder::new().stack_size(512 << 20).spawn(f).unwrap().join().unwrap();
}

/// Parses and prints; the codes of the errors.
fn codes(source: &str) -> Vec<String> {
    let mut diags = Diagnostics::new();
    let file = parse_file(FileId(0), source, Profile::Codesys, &mut diags);
    ast::print::print(&file);
    for d in diags.iter() {
        for label in std::iter::once(&d.primary).chain(&d.secondary) {
            let (start, end) = (label.span.start as usize, label.span.end as usize);
            assert!(source.get(start..end).is_some(), "{} has no text at {start}..{end}", d.code);
        }
    }
    diags.iter().map(|d| d.code.to_string()).collect()
}

fn program(body: &str) -> String {
    format!("PROGRAM A\n{body}\nEND_PROGRAM\nPROGRAM B\ny := 1 + ;\nEND_PROGRAM\n")
}

#[test]
fn deep_nesting_is_one_message() {
    with_large_stack(|| {
        let n = 100_000;
        let nested = |open: &str, inner: &str, close: &str, n: usize| {
            program(&format!("x := {}{inner}{};", open.repeat(n), close.repeat(n)))
        };
        for (source, what) in [
            (nested("(", "1", ")", 10_000), "parentheses"),
            (nested("(", "1", ")", n), "more parentheses"),
            (nested("(", "1", "", n), "parentheses that do not close"),
            (nested("f(", "1", ")", n), "calls"),
            (nested("a[", "1", "]", n), "indices"),
            (nested("NOT ", "a", "", n), "NOT"),
            (nested("-", "a", "", n), "minus"),
            (nested("1+", "1", "", n), "sums"),
            (nested("", "a", ".b", n), "members"),
            (nested("", "a", "^", n), "dereferences"),
            (program(&format!("{}x := 1;{}", "IF a THEN ".repeat(n), "END_IF;".repeat(n))), "IF"),
            (program(&format!("VAR x : {}INT; END_VAR", "ARRAY[1..2] OF ".repeat(n))), "arrays"),
            (program(&format!("VAR x : {}INT; END_VAR", "POINTER TO ".repeat(n))), "pointers"),
            (program(&format!("VAR x : INT := {}1{}; END_VAR", "[".repeat(n), "]".repeat(n))), "initial values"),
            (program(&format!("VAR x : INT := {}1{}; END_VAR", "(a := ".repeat(n), ")".repeat(n))), "structures"),
            (program(&format!("LD a\n{}{}ST x", "AND( b\n".repeat(n), ")\n".repeat(n))), "deferred operations"),
            (program(&format!("VAR x : {}INT;{} END_VAR", "STRUCT a : ".repeat(n), "END_STRUCT;".repeat(n))), "STRUCT"),
        ] {
            // The second one is that of the next program, which is still read.
            assert_eq!(codes(&source), ["E0122", "E0116"], "{what}");
        }
    });
}

#[test]
fn nesting_within_the_limits_is_fine() {
    with_large_stack(|| {
        let body = format!("x := {}1{};\ny := 1{};", "(".repeat(900), ")".repeat(900), " + 1".repeat(3900));
        assert_eq!(codes(&program(&body)), ["E0116"]);
    });
}

#[test]
fn long_and_hopeless_inputs_take_bounded_time() {
    let n = 20_000;
    let inputs = [
        program(&"x := 1\n".repeat(n)),
        program(&"x := 5 5;\n".repeat(n)),
        program(&"x := ;\n".repeat(n)),
        program(&"a ".repeat(n)),
        program(&"f(a b c ".repeat(n)),
        program(&"ELSE ".repeat(n)),
        program(&"ACTION a :\n".repeat(n)),
        program(&"STEP a :\n".repeat(n)),
        program(&"INITIAL_STEP S : END_STEP TRANSITION FROM ".repeat(n)),
        program(&format!("IF a THEN x := 1; {}", "ELSE IF b THEN x := 2;\n".repeat(n))),
        program(&format!("VAR\n{}", "x := 5;\n".repeat(n))),
        program(&"IF a THEN ".repeat(n)),
        "PROGRAM A\n".repeat(n),
        "END_IF\n".repeat(n),
        "METHOD a\n".repeat(n),
        "FUNCTION f ".repeat(n),
        "LD x ".repeat(n),
        "PROGRAM A LD x ".repeat(n),
        "(* ".repeat(n),
        "\0\u{1}ü".repeat(n),
    ];
    for source in inputs {
        let start = Instant::now();
        let found = codes(&source).len();
        let (time, head) = (start.elapsed(), &source[..source.len().min(40)]);
        assert!((1..=201).contains(&found), "{found} messages for {head}");
        assert!(time < Duration::from_secs(20), "{time:?} for {head}");
    }
}

const SAMPLES: &[&str] = &[
    "PROGRAM Main\nVAR CONSTANT N : INT := 5; END_VAR\nVAR x, y : INT; t : TON := (PT := T#5s); a : ARRAY[1..3] OF INT := [3(0)];\n\
     s : STRING[20] := 'abc'; p : POINTER TO INT; END_VAR\nIF x > 0 AND NOT (y = 3) THEN\n  x := x + 1;\nELSIF y < 3 THEN\n  \
     y := 2;\nELSE\n  ;\nEND_IF;\nCASE x OF\n 1, 3..5: y := 1;\n N: ;\nELSE\n  y := 3;\nEND_CASE\nFOR x := 1 TO 10 BY 2 DO\n  \
     t(IN := TRUE, Q => b);\n  EXIT;\nEND_FOR\nREPEAT\n  x := x - a[1];\nUNTIL x < 0\nEND_REPEAT;\np^ := w.3;\nEND_PROGRAM\n",
    "TYPE E : (A, B := 5) INT := A; S : STRUCT q : INT; END_STRUCT; R : INT(1..5); END_TYPE\nVAR_GLOBAL g AT %QX0.0 : BOOL; \
     END_VAR\nPROGRAM C\nVAR b : BOOL; END_VAR\nINITIAL_STEP S1: b(N); act(L, T#5s, b); END_STEP\nTRANSITION FROM S1 TO S2 := b; \
     END_TRANSITION\nSTEP S2: END_STEP\nTRANSITION t2 (PRIORITY := 2) FROM (S2, S1) TO S1 :\n LD b\n AND( b\n OR c\n )\n\
     END_TRANSITION\nACTION act: b := FALSE; END_ACTION\nEND_PROGRAM\n",
    "FUNCTION f : INT\nVAR_INPUT r : INT; END_VAR\n LD r\n ADD 5\nl1: MUL 3\n CAL t(IN := x,\n   PT := T#5s)\n LIMIT(MN := 0, \
     IN := r)\n JMPC l1\n &N b\n ST f\nEND_FUNCTION\n{attribute 'x'}\nCONFIGURATION C (* c (* d *) *)\n VAR_GLOBAL g : INT; \
     END_VAR\n RESOURCE R ON PLC\n  TASK T(INTERVAL := T#10ms, PRIORITY := 1);\n  PROGRAM P1 WITH T : Main(in := g, fb WITH T);\n \
     END_RESOURCE\n VAR_ACCESS a : R.P1.x : INT READ_WRITE; END_VAR\n VAR_CONFIG R.P1.x AT %IX1.0 : BOOL := TRUE; END_VAR\n\
     END_CONFIGURATION\n",
];

/// A small generator of numbers (xorshift), the same on every machine.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n.max(1) as u64) as usize
    }
}

/// `text` with one piece removed, doubled, swapped or replaced.
fn damage(text: &str, random: &mut Random) -> String {
    if random.below(4) == 0 {
        // A byte; what is no UTF-8 any more is read as the driver reads it.
        let mut bytes = text.as_bytes().to_vec();
        let at = random.below(bytes.len());
        match random.below(3) {
            0 => drop(bytes.remove(at)),
            1 => bytes.insert(at, random.below(256) as u8),
            _ => bytes[at] = random.below(256) as u8,
        }
        return String::from_utf8(bytes).unwrap_or_else(|e| e.into_bytes().iter().map(|b| *b as char).collect());
    }
    let mut words: Vec<&str> = text.split_inclusive([' ', '\n', '(', ')', ';', ':', ',', '.']).collect();
    let (a, b) = (random.below(words.len()), random.below(words.len()));
    match random.below(4) {
        0 => drop(words.remove(a)),
        1 => words.insert(a, words[b]),
        2 => words.swap(a, b),
        _ => words[a] = words[b],
    }
    words.concat()
}

#[test]
fn damaged_programs() {
    with_large_stack(|| {
        let mut random = Random(0x9E37_79B9_7F4A_7C15);
        let start = Instant::now();
        for round in 0..4000 {
            let mut text = SAMPLES[random.below(SAMPLES.len())].to_string();
            for _ in 0..=random.below(4) {
                text = damage(&text, &mut random);
                if text.is_empty() {
                    break;
                }
            }
            let found = codes(&text).len();
            assert!(found < 40, "{found} messages in round {round}:\n{text}");
            print_tokens(FileId(0), &text);
        }
        assert!(start.elapsed() < Duration::from_secs(120), "{:?}", start.elapsed());
    });
}

#[test]
fn samples_are_sound() {
    for sample in SAMPLES {
        assert_eq!(codes(sample), [""; 0], "{sample}");
    }
}
