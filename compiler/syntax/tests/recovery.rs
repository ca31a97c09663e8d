//! Mistakes: each gives exactly one message, at its line, and what stands around it is read as if it were not there.

use plcc_diag::{Diagnostics, Severity, SourceMap};
use plcc_syntax::{Profile, ast, parse_file};

/// Parses in profile strict: the messages as "line code", and the printed tree.
fn parse(source: &str) -> (Vec<String>, String) {
    let mut map = SourceMap::new();
    let id = map.add("t.st", source);
    let mut diags = Diagnostics::new();
    let file = parse_file(id, source, Profile::Strict, &mut diags);
    let messages = diags
        .sorted()
        .iter()
        .filter(|d| d.severity() != Severity::Hint)
        .map(|d| format!("{} {}", map.file(id).line_column(d.primary.span.start).0, d.code))
        .collect();
    (messages, ast::print::print(&file))
}

/// `body` in a program from line 2 on, and a second program behind it that must survive.
fn check(body: &str, expected: &[&str]) -> String {
    let source = format!("PROGRAM Main\n{body}\nEND_PROGRAM\nPROGRAM After\nsurvived := 1;\nEND_PROGRAM\n");
    let (messages, tree) = parse(&source);
    assert_eq!(messages, expected, "in\n{body}\ntree\n{tree}");
    assert!(tree.contains("PROGRAM After"), "the next program is lost behind\n{body}\n{tree}");
    assert!(tree.contains("survived := 1"), "the next body is lost behind\n{body}\n{tree}");
    tree
}

#[test]
fn missing_end_words() {
    let tree = check("IF a THEN\n  x := 1;", &["2 E0101"]);
    assert!(tree.contains("assign x := 1"), "{tree}");
    check("FOR i := 1 TO 3 DO\n  x := 1;\n", &["2 E0101"]);
    check("REPEAT\n x := 1;\n", &["2 E0101"]);
    check("CASE x OF\n 1: y := 1;\n", &["2 E0101"]);
    check("VAR\n x : INT;\nx := 1;", &["2 E0101"]);
    check("VAR\n x : INT;\nIF x > 0 THEN x := 1; END_IF;", &["2 E0101"]);
    check("VAR_INPUT\n x : INT;\nVAR_OUTPUT\n y : INT;\nEND_VAR\ny := x;", &["2 E0101"]);
    // The branch belongs to the outer IF.
    check("IF a THEN\n FOR i := 1 TO 3 DO\n  x := 1;\nELSE\n x := 2;\nEND_IF;", &["3 E0101"]);
    // Several at one place are one message.
    check("IF a THEN\n FOR i := 1 TO 3 DO\n  x := 1;", &["3 E0101"]);
}

#[test]
fn indentation_names_the_right_opener() {
    check("IF a THEN\n  IF b THEN\n    x := 1;\n  y := 2;\nEND_IF;\nz := 3;", &["3 E0101"]);
    check("IF a THEN\n  IF b THEN\n    IF c THEN\n      x := 1;\n  END_IF;\nEND_IF;\nz := 3;", &["4 E0101"]);
}

#[test]
fn missing_end_of_a_pou() {
    let (messages, tree) = parse("PROGRAM A\nx := 1;\nFUNCTION f : INT\nf := 1;\nEND_FUNCTION\n");
    assert_eq!(messages, ["1 E0101"]);
    assert!(tree.contains("assign x := 1") && tree.contains("FUNCTION f : INT"), "{tree}");
    assert_eq!(parse("PROGRAM A\nIF a THEN\n x := 1;\n").0, ["2 E0101"]);
    assert_eq!(parse("TYPE T : INT;\nPROGRAM A\nEND_PROGRAM\n").0, ["1 E0101"]);
}

#[test]
fn end_words_too_many_or_wrong() {
    assert_eq!(parse("PROGRAM A\nEND_PROGRAM\nEND_PROGRAM\n").0, ["3 E0102"]);
    check("x := 1;\nEND_IF;\ny := 2;", &["3 E0102"]);
    check("IF a THEN\n x := 1;\nEND_WHILE;\ny := 2;", &["4 E0103"]);
    assert_eq!(parse("PROGRAM A\nx := 1;\nEND_FUNCTION\nPROGRAM B\nEND_PROGRAM\n").0, ["3 E0103"]);
    check("IF a THEN x := 1; END-IF;", &["2 E0104"]);
    check("IF a THEN x := 1; END IF;", &["2 E0104"]);
    check("IF a THEN\n x := 1;\nENDIF;\ny := 1;", &["4 E0104"]);
}

#[test]
fn else_if() {
    let tree = check("IF a THEN x := 1;\nELSE IF b THEN x := 2;\nEND_IF;\ny := 3;", &["3 E0105"]);
    assert!(tree.contains("assign y := 3"), "{tree}");
    // With an END_IF of its own it is legal.
    check("IF a THEN x := 1;\nELSE IF b THEN x := 2; END_IF;\nEND_IF;", &[]);
    check("IF a THEN x := 1; ELSE x := 2;\nELSE x := 3; END_IF;", &["3 E0117"]);
    check("IF a THEN x := 1; ELSE x := 2;\nELSIF b THEN x := 3; END_IF;", &["3 E0117"]);
}

#[test]
fn missing_semicolons() {
    let tree = check("x := 1\ny := 2;\nfb(a := 1)\nz := 3", &["2 E0114", "4 E0114", "5 E0114"]);
    for kept in ["assign x := 1", "assign y := 2", "call fb(a := 1)", "assign z := 3"] {
        assert!(tree.contains(kept), "{kept} is not in\n{tree}");
    }
    check("IF a THEN x := 1 END_IF;", &["2 E0114"]);
    let tree = check("VAR\n a : INT\n b : INT;\nEND_VAR", &["3 E0114"]);
    assert!(tree.contains("a : INT") && tree.contains("b : INT"), "{tree}");
    check("RETURN\nx := 1;", &["2 E0114"]);
}

#[test]
fn missing_words() {
    let tree = check("IF a > b\n  x := 1;\nEND_IF;\ny := 2;", &["2 E0115"]);
    assert!(tree.contains("IF (a > b)") && tree.contains("assign x := 1"), "{tree}");
    check("IF a > b x := 1; END_IF;", &["2 E0115"]);
    check("IF a DO x := 1; END_IF;", &["2 E0115"]);
    check("WHILE a > b\n x := 1;\nEND_WHILE;", &["2 E0115"]);
    check("FOR i := 1 TO 10\n x := 1;\nEND_FOR;", &["2 E0115"]);
    check("FOR i := 1 10 DO x := 1; END_FOR;", &["2 E0115"]);
    check("CASE x\n 1: y := 1;\nEND_CASE;", &["2 E0115"]);
    check("REPEAT x := 1;\nEND_REPEAT;", &["3 E0115"]);
    check("VAR\n a INT;\n b : INT;\nEND_VAR", &["3 E0115"]);
    check("VAR\n a : ARRAY[1..3] INT;\nEND_VAR", &["3 E0115"]);
    assert_eq!(parse("FUNCTION f INT\nf := 1;\nEND_FUNCTION\n").0, ["1 E0115"]);
}

#[test]
fn misspelled_words() {
    let tree = check("IF a THNE x := 1; END_IF;", &["2 E0125"]);
    assert!(tree.contains("IF a\n      assign x := 1"), "{tree}");
    check("IF a THEN\n x := 1;\nESLE\n x := 2;\nEND_IF;", &["4 E0125"]);
    check("IF a THEN\n x := 1;\nEDN_IF;\ny := 1;", &["4 E0125"]);
    check("VAR_INPTU\n x : INT;\nEND_VAR\ny := 1;", &["2 E0125"]);
    check("IF a\n then1 := 1;\nEND_IF;", &["2 E0115"]);
    check("FOR i := 1 TO 5 OD x := 1; END_FOR;", &["2 E0125"]);
    // A variable's own name is no mistake.
    check("thne := 1;\nesle := 2;", &[]);
}

#[test]
fn missing_parentheses() {
    let tree = check("x := (a + b;\ny := 1;", &["2 E0115"]);
    assert!(tree.contains("assign x := (a + b)"), "{tree}");
    check("fb(a := 1, b := 2;\ny := 1;", &["2 E0115"]);
    check("fb(a := 1\ny := 1;", &["2 E0115"]);
    check("fb(a := 1\n   b := 2);", &["2 E0115"]);
    check("IF (a > b THEN x := 1; END_IF;", &["2 E0115"]);
    check("x := a[1;\ny := 1;", &["2 E0115"]);
    check("x := a + b);\ny := 1;", &["2 E0117"]);
}

#[test]
fn missing_operands() {
    check("x := ;\ny := a + ;\nz := a * * b;", &["2 E0116", "3 E0116", "4 E0116"]);
    check("IF THEN x := 1; END_IF;", &["2 E0116"]);
    let tree = check("x :=\ny := 2;", &["2 E0116"]);
    assert!(tree.contains("assign y := 2"), "{tree}");
    check("VAR\n a : ;\n b := 5;\n c;\n d : INT := ;\nEND_VAR", &["3 E0116", "4 E0116", "5 E0116", "6 E0116"]);
}

#[test]
fn signs_of_other_languages() {
    check("IF a == b && c != d || e THEN\n x = 1;\nEND_IF;", &["2 E0111", "2 E0111", "2 E0111", "2 E0111", "3 E0113"]);
    check("x : = 1;", &["2 E0112"]);
    check("VAR\n b : BOOL: :=TRUE;\n c : INT = 5;\nEND_VAR", &["3 E0112", "4 E0113"]);
    check("FOR i = 1 TO 5 DO x := i; END_FOR;", &["2 E0113"]);
    check("IF a => b THEN x := 1; END_IF;", &["2 E0111"]);
    check("t := T#1min30s;\nu := 5ms;\nv := 0xFF;", &["2 E0110", "3 E0110", "4 E0110"]);
    check("s := ‘abc’;\nt := “abc”;", &["2 E0109", "3 E0109"]);
    check("s := 'abc;\nx := 1;", &["2 E0108"]);
    check("x := 1 @ 2;\ny := 1;", &["2 E0106"]);
}

#[test]
fn unexpected_tokens() {
    let tree = check("x := 1 2;\ny := a b c;\nz := 3;", &["2 E0117", "3 E0117"]);
    assert!(tree.contains("assign z := 3"), "{tree}");
    check("x := := 5;", &["2 E0117"]);
    check("x := type + 1;", &["2 E0118"]);
    check("VAR\n for : INT;\n y : INT 5;\nEND_VAR", &["3 E0118", "4 E0117"]);
    check("x := 1;\nVAR y : INT; END_VAR\ny := 2;", &["3 E0120"]);
    check("CASE x OF\n y := 1;\n 1: z := 2;\nEND_CASE;", &["3 E0117"]);
}

#[test]
fn names_stay_known_behind_a_faulty_type() {
    let tree = check("VAR\n a, b : INT 5 6;\n c : INT;\nEND_VAR", &["3 E0117"]);
    assert!(tree.contains("a, b : <error>") && tree.contains("c : INT"), "{tree}");
}

#[test]
fn text_outside_of_declarations() {
    assert_eq!(parse("hello world\nx := 1;\nPROGRAM A\nEND_PROGRAM\n").0, ["1 E0119"]);
    assert_eq!(parse("PROGRAMM A\nx := 1;\nEND_PROGRAM\nPROGRAM B\nEND_PROGRAM\n").0, ["1 E0119"]);
    assert_eq!(parse("INTERFACE I\nMETHOD m\nEND_METHOD\nEND_INTERFACE\nPROGRAM B\nEND_PROGRAM\n").0, ["1 E0121"]);
    check("METHOD m\nx := 1;\nEND_METHOD\ny := 1;", &["2 E0121"]);
}

#[test]
fn comments_that_do_not_close() {
    assert_eq!(parse("PROGRAM A\nx := 1; (* abc\ny := 2;\nEND_PROGRAM\n").0, ["2 E0107"]);
    let (messages, tree) = parse("PROGRAM A\n(* a (* b *)\ny := 2;\nEND_PROGRAM\n(* c *)\n");
    assert_eq!(messages, ["2 E0107"]);
    assert!(tree.contains("assign y := 2"), "{tree}");
}

#[test]
fn charts() {
    let chart = |lines: &str| format!("INITIAL_STEP S1: a(N); END_STEP\n{lines}\nSTEP S2: END_STEP");
    check(&chart("TRANSITION FROM S1 TO S2 := x; END_TRANSITION"), &[]);
    check(&chart("TRANSITION FROM S1 TO S2 := x END_TRANSITION"), &["3 E0114"]);
    check(&chart("TRANSITION FROM S1 TO S2 = x; END_TRANSITION"), &["3 E0113"]);
    check(&chart("TRANSITION FROM S1 TO S2 : x > 3; END_TRANSITION"), &["3 E0115"]);
    check(&chart("TRANSITION FROM S1 S2 := x; END_TRANSITION"), &["3 E0115"]);
    check(&chart("STEP S3: a(N);\nTRANSITION FROM S1 TO S2 := x; END_TRANSITION"), &["3 E0101"]);
    check(&chart("STEP S3: a(N); b(1 + 2); END_STEP"), &["3 E0124"]);
    let tree = check(&chart("TRANSITION FROM 5 TO S2 := x; END_TRANSITION"), &["3 E0117"]);
    assert!(tree.contains("STEP S2"), "{tree}");
}

#[test]
fn instruction_lists() {
    check("LD a b\nST x", &["2 E0117"]);
    check("LD a\nAND( b\nOR c\nST d", &["5 E0115"]);
    let tree = check("LD a\nCAL fb(x := 1\nLD y\nST z", &["3 E0115"]);
    assert!(tree.contains("LD y") && tree.contains("ST z"), "{tree}");
}

#[test]
fn configurations() {
    let (messages, tree) = parse(
        "CONFIGURATION C\nRESOURCE R ON PLC\nTASK T(INTERVAL := T#10ms)\nPROGRAM P WITH T : Main;\nPROGRAM Q WITH T Main;\n\
         END_RESOURCE\nEND_CONFIGURATION\n",
    );
    assert_eq!(messages, ["3 E0114", "5 E0115"]);
    assert!(tree.contains("PROGRAM P WITH T : Main()") && tree.contains("PROGRAM Q WITH T : Main()"), "{tree}");
    assert_eq!(parse("CONFIGURATION C\nRESOURCE R ON PLC\nPROGRAM P : Main;\nEND_CONFIGURATION\n").0, ["2 E0101"]);
}

#[test]
fn the_pages_of_the_syntax_codes_show_their_mistake() {
    let mut checked = 0;
    for code in plcc_diag::codes::all() {
        let info = code.info();
        let Some(example) = info.page.split("```st\n").nth(1).and_then(|p| p.split("```").next()) else { continue };
        if !["E01", "H01"].contains(&&info.code[..3]) {
            continue;
        }
        let mut diags = Diagnostics::new();
        parse_file(plcc_diag::FileId(0), example, Profile::Strict, &mut diags);
        let found: Vec<_> = diags.iter().map(|d| d.code.to_string()).collect();
        assert_eq!(found, [info.code], "{example}");
        checked += 1;
    }
    assert!(checked > 20, "{checked}");
}

#[test]
fn the_optional_semicolon_is_one_hint() {
    let hints = |profile| {
        let mut diags = Diagnostics::new();
        let source = "PROGRAM A\nIF a THEN x := 1; END_IF\nIF b THEN x := 1; END_IF\nEND_PROGRAM\n";
        parse_file(plcc_diag::FileId(0), source, profile, &mut diags);
        diags.iter().map(|d| d.code.to_string()).collect::<Vec<_>>()
    };
    assert_eq!(hints(Profile::Strict), ["H0101"]);
    assert!(hints(Profile::Codesys).is_empty());
}
