//! Lexical forms.

use super::*;
use plcc_diag::{Diagnostics, FileId};

/// Each token as "Kind text", and the codes that were reported.
fn lexed(text: &str) -> (Vec<String>, Vec<String>) {
    let mut diags = Diagnostics::new();
    let lexed = lex(text, &mut Reporter::new(FileId(0), &mut diags));
    let tokens = lexed.tokens.iter().map(|t| format!("{:?} {}", t.kind, t.text(text))).collect();
    (tokens, diags.iter().map(|d| d.code.to_string()).collect())
}

/// The tokens of a text without mistakes.
fn tokens(text: &str) -> Vec<String> {
    let (tokens, codes) = lexed(text);
    assert!(codes.is_empty(), "{codes:?} in {text}");
    tokens
}

#[test]
fn comments_and_pragmas_vanish() {
    assert_eq!(tokens("a (* x (* y *) z *) b /* (* */ c // d\n{p} e"), ["Id a", "Id b", "Id c", "Id e"]);
    let mut diags = Diagnostics::new();
    let lexed = lex("a {attribute 'x'} b", &mut Reporter::new(FileId(0), &mut diags));
    assert_eq!(lexed.pragmas[0].text, "attribute 'x'");
    assert_eq!((lexed.pragmas[0].span.start, lexed.pragmas[0].span.end), (2, 17));
}

#[test]
fn the_first_token_of_a_line_is_marked() {
    let mut diags = Diagnostics::new();
    let lexed = lex("a b\n (* \n *) c\nd", &mut Reporter::new(FileId(0), &mut diags));
    assert_eq!(lexed.tokens.iter().map(|t| t.first).collect::<Vec<_>>(), [true, false, true, true]);
}

#[test]
fn numbers_and_ranges() {
    assert_eq!(tokens("1..10"), ["Int 1", "DotDot ..", "Int 10"]);
    assert_eq!(
        tokens("1.5 1_000 1e6 1.5E-3 16#FF_00 2#1010"),
        ["Lit 1.5", "Int 1_000", "Lit 1e6", "Lit 1.5E-3", "Lit 16#FF_00", "Lit 2#1010"]
    );
    assert_eq!(
        tokens("w.3 w.%X31 d.%B0"),
        ["Id w", "Dot .", "Int 3", "Id w", "Dot .", "Part %X31", "Id d", "Dot .", "Part %B0"]
    );
    assert_eq!(lexed("5x 0xFF 5ms").1, ["E0110", "E0110", "E0110"]);
}

#[test]
fn typed_literals_are_one_token() {
    assert_eq!(
        tokens("INT#5 INT#-5 BYTE#16#FF REAL#1.5e3 BOOL#TRUE STRING#'a$'b' Color#Red"),
        [
            "Lit INT#5",
            "Lit INT#-5",
            "Lit BYTE#16#FF",
            "Lit REAL#1.5e3",
            "Lit BOOL#TRUE",
            "Lit STRING#'a$'b'",
            "Qualified Color#Red"
        ]
    );
    assert_eq!(lexed("INT#").1, ["E0110"]);
}

#[test]
fn durations_and_dates() {
    assert_eq!(
        tokens("T#1d_2h3.5ms LTIME#-5us t#90m TIME#1s-T#1s"),
        ["Lit T#1d_2h3.5ms", "Lit LTIME#-5us", "Lit t#90m", "Lit TIME#1s", "Minus -", "Lit T#1s"]
    );
    assert_eq!(
        tokens("D#2024-01-31 TOD#12:30:00.25 DATE_AND_TIME#2024-01-31-12:00:00 LD x"),
        ["Lit D#2024-01-31", "Lit TOD#12:30:00.25", "Lit DATE_AND_TIME#2024-01-31-12:00:00", "Id LD", "Id x"]
    );
    let (tokens, codes) = lexed("T#1min30s");
    assert_eq!((tokens, codes), (vec!["Bad T#1min30s".to_string()], vec!["E0110".to_string()]));
}

#[test]
fn strings() {
    assert_eq!(tokens("'a$'b' \"c$\"d\" '' '$$'"), ["Lit 'a$'b'", "Lit \"c$\"d\"", "Lit ''", "Lit '$$'"]);
    assert_eq!(lexed("'abc\nx"), (vec!["Bad 'abc".into(), "Id x".into()], vec!["E0108".into()]));
    assert_eq!(lexed("'abc$\nx").0, ["Bad 'abc$", "Id x"]);
    assert_eq!(lexed("‘abc’;"), (vec!["Bad ‘abc’".into(), "Semi ;".into()], vec!["E0109".into()]));
}

#[test]
fn addresses() {
    let all = ["%IX0.0", "%QW4", "%I*", "%MD8", "%IW2.5.7", "%i0.1", "%QX1"];
    assert_eq!(tokens(&all.join(" ")), all.map(|a| format!("Address {a}")));
    assert_eq!(lexed("a % b").1, ["E0110"]);
}

#[test]
fn words_in_any_case_and_behind_a_dot() {
    assert_eq!(
        tokens("if If IF step x.step x.end_if x.\nEND_IF"),
        [
            "If if",
            "If If",
            "If IF",
            "Id step",
            "Id x",
            "Dot .",
            "Id step",
            "Id x",
            "Dot .",
            "Id end_if",
            "Id x",
            "Dot .",
            "EndIf END_IF"
        ]
    );
}

#[test]
fn signs() {
    assert_eq!(
        tokens(":= => ?= <= >= <> ** .. & ^"),
        ["Assign :=", "Arrow =>", "Attempt ?=", "Rel <=", "Rel >=", "Rel <>", "Op **", "DotDot ..", "Op &", "Caret ^"]
    );
    assert_eq!(lexed("== != && || !").0, ["Eq ==", "Rel !=", "Op &&", "Op ||", "Not !"]);
    // A comment of another language, and two signs of an expression that goes on.
    let comment = lexed("a;\n-- text\nb");
    assert_eq!(
        (comment.0, comment.1),
        (vec!["Id a".to_string(), "Semi ;".into(), "Id b".into()], vec!["E0111".into()])
    );
    assert_eq!(lexed("a\n--b").0, ["Id a", "Minus -", "Minus -", "Id b"]);
    assert_eq!(lexed("a : = b").0, ["Id a", "Assign : =", "Id b"]);
    assert_eq!(lexed("a: :=b").0, ["Id a", "Colon :", "Assign :=", "Id b"]);
}

#[test]
fn what_is_no_text_gives_few_messages() {
    assert_eq!(lexed(&"\0".repeat(10_000)).1, ["E0106"]);
    assert_eq!(lexed("größe").1, ["E0106"]);
    assert!(tokens("\u{feff}a\u{a0}b").len() == 2);
    assert_eq!(lexed(&"'\n".repeat(10_000)).1.len(), 200);
}

#[test]
fn openers_without_end_take_linear_time() {
    for text in ["(* ", "(* (* *) ", "{ ", "/* ", "{ (* "] {
        assert_eq!(lexed(&text.repeat(200_000)).1.len(), 1, "{text}");
    }
}

#[test]
fn operators_called_as_functions_are_names() {
    assert_eq!(tokens("x := AND(a)")[2], "Id AND");
    assert_eq!(tokens("(mod (a, b)")[1], "Id mod");
    assert_eq!(tokens("a XOR (b)")[1], "Op XOR");
    assert_eq!(tokens(") OR(b)")[1], "Op OR");
    assert_eq!(tokens("CASE MOD(a, b) OF")[1], "Id MOD");
    assert_eq!(tokens("TO MOD(a) BY OR(b)")[4..7], ["RParen )", "By BY", "Id OR"]);
    assert_eq!(tokens("x :=\nAND(a)")[2], "Id AND");
    // Operators of IL at the start of their line.
    assert_eq!(tokens("NOT\nAND( a")[1], "Op AND");
    assert_eq!(tokens("AND(\nOR( a")[2], "Op OR");
}
