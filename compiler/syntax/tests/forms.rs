//! Legal forms of the language and the trees they give.

use plcc_diag::{Diagnostics, FileId};
use plcc_syntax::{Profile, ast, parse_body, parse_expression, parse_file, print_tokens};

fn file(source: &str) -> ast::File {
    let mut diags = Diagnostics::new();
    let file = parse_file(FileId(0), source, Profile::Codesys, &mut diags);
    let messages: Vec<_> =
        diags.iter().map(|d| format!("{} at {}: {}", d.code, d.primary.span.start, d.message)).collect();
    assert!(messages.is_empty(), "{messages:#?} in\n{source}");
    file
}

fn tree(source: &str) -> String {
    ast::print::print(&file(source))
}

/// The statements of a program with `body`.
fn body(body: &str) -> Vec<String> {
    let tree = tree(&format!("PROGRAM Main\n{body}\nEND_PROGRAM\n"));
    let lines = tree.lines().skip(2);
    lines.map(|l| l.strip_prefix("    ").unwrap_or(l).to_string()).collect()
}

/// The declarations of a VAR section.
fn vars(declarations: &str) -> Vec<String> {
    let tree = tree(&format!("PROGRAM Main\nVAR {declarations} END_VAR\nEND_PROGRAM\n"));
    let lines = tree.lines().skip(2).take_while(|l| l.starts_with("    "));
    lines.map(|l| l[4..].to_string()).collect()
}

fn expr(text: &str) -> String {
    let mut diags = Diagnostics::new();
    let e = parse_expression(FileId(0), text, &mut diags).expect(text);
    assert_eq!(diags.error_count(), 0, "{text}");
    ast::print::print_expr(&e)
}

#[test]
fn precedence() {
    assert_eq!(expr("a OR b XOR c AND d"), "(a OR (b XOR (c AND d)))");
    assert_eq!(expr("a AND b OR c"), "((a AND b) OR c)");
    assert_eq!(expr("a = b AND c < d + e * f ** g"), "((a = b) AND (c < (d + (e * (f ** g)))))");
    assert_eq!(expr("a - b - c"), "((a - b) - c)");
    assert_eq!(expr("a ** b ** c"), "((a ** b) ** c)");
    assert_eq!(expr("-a ** b"), "(-a ** b)");
    assert_eq!(expr("NOT a = b"), "(NOT a = b)");
    assert_eq!(expr("(a + b) * c"), "((a + b) * c)");
    assert_eq!(expr("a + b * c - d"), "((a + (b * c)) - d)");
    assert_eq!(expr("a < b = c"), "((a < b) = c)");
    assert_eq!(expr("a & b OR_ELSE c AND_THEN d"), "((a AND b) OR_ELSE (c AND_THEN d))");
    assert_eq!(expr("a MOD b / c"), "((a MOD b) / c)");
}

#[test]
fn operands() {
    assert_eq!(expr("a.b[1, i + 1]^.c.3"), "a.b[1, (i + 1)]^.c.3");
    assert_eq!(expr("d.%X31 + d.%B0"), "(d.%X31 + d.%B0)");
    assert_eq!(expr("f(a, b := 1, c => d, NOT e => g, h :=, i =>)"), "f(a, b := 1, c => d, NOT e => g, h := , i => )");
    assert_eq!(expr("f() + fb.act(NOT x)"), "(f() + fb.act(NOT x))");
    assert_eq!(expr("%IX0.0 AND Color#Red = T#1s"), "(%IX0.0 AND (Color#Red = T#1s))");
    assert_eq!(expr("(p)^ + INT#-5"), "(p^ + INT#-5)");
}

#[test]
fn literals_are_split() {
    let literal = |text: &str| {
        let mut diags = Diagnostics::new();
        match parse_expression(FileId(0), text, &mut diags).map(|e| e.kind) {
            Some(ast::ExprKind::Literal(l)) => (l.kind, l.prefix.map(|p| p.text.to_string()), l.text.to_string()),
            other => panic!("{text}: {other:?}"),
        }
    };
    use ast::LiteralKind::*;
    let prefix = |p: &str| Some(p.to_string());
    assert_eq!(literal("12"), (Integer, None, "12".into()));
    assert_eq!(literal("16#FF"), (Based, None, "16#FF".into()));
    assert_eq!(literal("1e6"), (Real, None, "1e6".into()));
    assert_eq!(literal("BYTE#16#FF"), (Based, prefix("BYTE"), "16#FF".into()));
    assert_eq!(literal("REAL#-1.5"), (Real, prefix("REAL"), "-1.5".into()));
    assert_eq!(literal("BOOL#1"), (Integer, prefix("BOOL"), "1".into()));
    assert_eq!(literal("true"), (Bool, None, "true".into()));
    assert_eq!(literal("LT#1d2h"), (Duration, prefix("LT"), "1d2h".into()));
    assert_eq!(literal("D#2024-01-31"), (Date, prefix("D"), "2024-01-31".into()));
    assert_eq!(literal("'a#b'"), (String, None, "'a#b'".into()));
    assert_eq!(literal("WSTRING#\"x\""), (WString, prefix("WSTRING"), "\"x\"".into()));
    assert_eq!(literal("NULL"), (Null, None, "NULL".into()));
}

#[test]
fn statements() {
    assert_eq!(
        body("IF a THEN ; ELSIF b THEN x := 1; ELSE END_IF"),
        ["IF a", "  empty", "ELSIF b", "  assign x := 1", "ELSE"]
    );
    assert_eq!(
        body("CASE x OF 1, 3..5: y := 1; Red: Color#Blue: z := 2; w := 3; ELSE v := 4; END_CASE;"),
        [
            "CASE x",
            "  1, 3..5:",
            "    assign y := 1",
            "  Red:",
            "  Color#Blue:",
            "    assign z := 2",
            "    assign w := 3",
            "  ELSE",
            "    assign v := 4"
        ]
    );
    assert_eq!(
        body("FOR i := 1 TO n - 1 BY 2 DO EXIT; CONTINUE; END_FOR"),
        ["FOR i := 1 TO (n - 1) BY 2", "  EXIT", "  CONTINUE"]
    );
    assert_eq!(
        body("WHILE a DO END_WHILE REPEAT UNTIL b; END_REPEAT RETURN;"),
        ["WHILE a", "REPEAT", "UNTIL b", "RETURN"]
    );
    assert_eq!(
        body("r ?= s; fb(); p^.x := 1; lbl: JMP lbl;"),
        ["attempt r ?= s", "call fb()", "assign p^.x := 1", "label lbl:", "JMP lbl"]
    );
    // `REF=` only where no name could stand: otherwise REF is one.
    assert_eq!(
        body("r REF= s; a[1] ref = p^; x := ref=3 AND ref = 4; f(ref=1);"),
        ["bind r REF= s", "bind a[1] REF= p^", "assign x := ((ref = 3) AND (ref = 4))", "call f((ref = 1))"]
    );
}

#[test]
fn soft_words_are_names() {
    for word in [
        "r",
        "s",
        "n",
        "ld",
        "step",
        "action",
        "on",
        "with",
        "from",
        "task",
        "single",
        "interval",
        "priority",
        "resource",
        "configuration",
        "transition",
        "constant",
        "retain",
        "at",
        "jmp",
        "int",
        "real",
        "exit",
        "return",
        "method",
        "end",
        "initial_step",
        "read_only",
        "r_edge",
        "pointer",
        "ref_to",
        "ref",
        "string",
        "class",
    ] {
        let source = format!(
            "PROGRAM Main\nVAR {word} : INT; a, {word} : BOOL; END_VAR\n{word} := {word} + fb.{word};\n\
             fb({word} := {word});\nIF {word} THEN {word}.{word} := 1; END_IF;\n{word}(1);\nEND_PROGRAM\n"
        );
        let tree = tree(&source);
        assert!(tree.contains(&format!("assign {word} := ({word} + fb.{word})")), "{tree}");
        assert!(tree.contains(&format!("call {word}(1)")), "{tree}");
    }
}

#[test]
fn variables() {
    assert_eq!(
        vars("a, b : INT := 5; c AT %QX0.0 : BOOL; AT %IW3 : WORD;"),
        ["a, b : INT := 5", "c AT %QX0.0 : BOOL", " AT %IW3 : WORD"]
    );
    assert_eq!(vars("a : BOOL R_EDGE; b : BOOL F_EDGE := TRUE;"), ["a : BOOL R_EDGE", "b : BOOL F_EDGE := TRUE"]);
    assert_eq!(
        vars("a : STRING; b : STRING[20] := 'x'; c : WSTRING(n);"),
        ["a : STRING", "b : STRING[20] := 'x'", "c : WSTRING[n]"]
    );
    assert_eq!(
        vars("a : ARRAY[1..3, 0..n - 1] OF ARRAY[*] OF INT; p : POINTER TO REF_TO REFERENCE TO T;"),
        ["a : ARRAY [1..3, 0..(n - 1)] OF ARRAY [*] OF INT", "p : POINTER TO REF_TO REFERENCE TO T"]
    );
    assert_eq!(
        vars("r : REFERENCE TO INT REF= x; s : REFERENCE TO ARRAY[1..2] OF STRING(9) ref = a.b;"),
        ["r : REFERENCE TO INT REF= x", "s : REFERENCE TO ARRAY [1..2] OF STRING[9] REF= a.b"]
    );
    assert_eq!(
        vars("a : INT (1..10); b : (x, y := 5) INT; c : INT (x, y);"),
        ["a : INT (1..10)", "b : INT (x, y := 5)", "c : INT (x, y)"]
    );
    assert_eq!(
        vars("a : STRUCT x : INT; y : STRUCT z : INT; END_STRUCT END_STRUCT;"),
        ["a : STRUCT", "  x : INT", "  y : STRUCT"]
            .map(String::from)
            .into_iter()
            .chain(["    z : INT".to_string()])
            .take(4)
            .collect::<Vec<_>>()
    );
}

#[test]
fn initial_values() {
    assert_eq!(vars("a : T := [3(0), 2(1, 2), 7];"), ["a : T := [3(0), 2(1, 2), 7]"]);
    assert_eq!(vars("a : T := 1, 2(0), 3;"), ["a : T := [1, 2(0), 3]"]);
    assert_eq!(vars("a : T := 3(0);"), ["a : T := [3(0)]"]);
    assert_eq!(
        vars("a : T := (x := 1, y := [1, 2], z := (u := 'a'));"),
        ["a : T := (x := 1, y := [1, 2], z := (u := 'a'))"]
    );
    assert_eq!(vars("a : T := (x := 1, 2, 3, y := 4);"), ["a : T := (x := [1, 2, 3], y := 4)"]);
    assert_eq!(vars("a : T := [2((x := 1)), (x := 2)];"), ["a : T := [2((x := 1)), (x := 2)]"]);
    assert_eq!(vars("a : T := 2(3(0)), (1 + 2) * 3;"), ["a : T := [2([3(0)]), ((1 + 2) * 3)]"]);
    assert_eq!(vars("t : TON := (PT := T#5s); e : E := E#Red;"), ["t : TON := (PT := T#5s)", "e : E := E#Red"]);
}

#[test]
fn sections_and_pous() {
    let text = tree(
        "FUNCTION_BLOCK F\nVAR_INPUT CONSTANT a : INT; END_VAR\nVAR RETAIN CONSTANT b : INT; END_VAR;\nVAR_TEMP END_VAR\n\
         VAR PERSISTENT c : INT; END_VAR END_FUNCTION_BLOCK\nFUNCTION g : ARRAY[1..2] OF INT VAR_INPUT END_VAR x := 1; \
         END_FUNCTION\nFUNCTION h y := 1; END_FUNCTION\nFUNCTION k : STRING[5] z := 'a'; END_FUNCTION\n\
         VAR_GLOBAL CONSTANT n : INT := 5; END_VAR\n",
    );
    for line in [
        "  VAR_INPUT CONSTANT",
        "  VAR RETAIN CONSTANT",
        "  VAR PERSISTENT",
        "FUNCTION g : ARRAY [1..2] OF INT",
        "FUNCTION h",
        "FUNCTION k : STRING[5]",
        "    assign z := 'a'",
        "VAR_GLOBAL CONSTANT",
    ] {
        assert!(text.lines().any(|l| l == line), "{line} is not in\n{text}");
    }
}

#[test]
fn types() {
    let text = tree(
        "TYPE\n Color : (Red, Green := 5);\n Small : SINT (-5..5) := 1;\n Point : STRUCT x, y : REAL := 1.0; END_STRUCT\n\
         U : UNION w : WORD; b : ARRAY[0..1] OF BYTE; END_UNION;\n Alias : Point := (x := 2.0);\nEND_TYPE",
    );
    assert_eq!(
        text,
        "TYPE\n  Color : (Red, Green := 5)\n  Small : SINT (-5..5) := 1\n  Point : STRUCT\n    x, y : REAL := 1.0\n  U : UNION\n\
         \u{20}   w : WORD\n    b : ARRAY [0..1] OF BYTE\n  Alias : Point := (x := 2.0)\n"
    );
}

#[test]
fn actions() {
    let text = tree(
        "FUNCTION_BLOCK F\nx := 1;\nACTION a : y := 2; END_ACTION\nACTION b : LD y\nST x\nEND_ACTION\nEND_FUNCTION_BLOCK\n\
         ACTION F.c :\nz := 3;\nEND_ACTION\nACTION d\nz := 4;\nEND_ACTION\n",
    );
    assert!(
        text.contains(
            "  ACTION a\n    body ST\n      assign y := 2\n  ACTION b\n    body IL\n      LD y\n      ST x\n"
        ),
        "{text}"
    );
    assert!(text.contains("\nACTION F.c\n") && text.contains("\nACTION d\n"), "{text}");
}

#[test]
fn instruction_lists() {
    let text = body(
        "start: LD %IX0.0 (* c *)\nANDN b\nAND( c\n OR( d\n  XOR e\n )\n)\nOR(\nLD f\n)\n&N g\nNOT\nST fb.IN\n\
         CAL t(IN := a,\n  PT := T#5s,\n  Q => b)\nCALC fb\nlabel2:\nLIMIT 0, 10\nMUX(K := 1,\n IN0 := a)\nJMPCN start\nS q\nRET",
    );
    assert_eq!(
        text,
        [
            "start: LD %IX0.0",
            "ANDN b",
            "AND( c",
            "  OR( d",
            "    XOR e",
            "  )",
            ")",
            "OR( ",
            "  LD f",
            ")",
            "&N g",
            "NOT",
            "ST fb.IN",
            "CAL t(IN := a, PT := T#5s, Q => b)",
            "CALC fb",
            "label2:",
            "LIMIT 0, 10",
            "MUX(K := 1, IN0 := a)",
            "JMPCN start",
            "S q",
            "RET"
        ]
    );
}

#[test]
fn a_parenthesis_may_close_on_the_line_of_its_last_instruction() {
    let closed = ["LD a", "AND( b", "  OR c", ")", "ST x"];
    for text in ["LD a\nAND( b\nOR c\n)\nST x", "LD a\nAND( b\nOR c )\nST x", "LD a\nAND(b\n\nOR c)\n\nST x"] {
        assert_eq!(body(text), closed, "{text}");
    }
    assert_eq!(body("LD a\nOR( b )\nST x"), ["LD a", "OR( b", ")", "ST x"]);
    assert_eq!(body("ADD(IN1 := a, IN2 := b)\nST x"), ["ADD(IN1 := a, IN2 := b)", "ST x"]);
}

#[test]
fn bodies_are_told_apart() {
    let kind =
        |text: &str| tree(&format!("PROGRAM Main\n{text}\nEND_PROGRAM\n")).lines().nth(1).map(|l| l.trim().to_string());
    for il in [
        "Read_inputs\nST x",
        "LD x",
        "l1:\nLD x\nST y",
        "LDN x",
        "CAL fb(IN := 1)\nLD x",
        "NOT",
        "RET",
        "l: ST y",
        "AND x",
        "LIMIT(MN := 0)\nST x",
    ] {
        assert_eq!(kind(il).as_deref(), Some("body IL"), "{il}");
    }
    for st in
        ["ld := 5;", "s(x := 1);", "r.x := 2;", "LD(1);", "l: x := 5;", "JMP l;", "", "x := 1;", "st[1] := 2;", "ret;"]
    {
        assert_eq!(kind(st).as_deref(), Some("body ST"), "{st}");
    }
    for sfc in ["INITIAL_STEP S: END_STEP", "ACTION a: x := 1; END_ACTION\nINITIAL_STEP S: END_STEP"] {
        assert_eq!(kind(sfc).as_deref(), Some("body SFC"), "{sfc}");
    }
}

#[test]
fn charts() {
    let text = body(
        "INITIAL_STEP S1: a; b(); c(N); d(L, T#5s, x, y); e(SD, t1); f.g(R, x); END_STEP\n\
         TRANSITION FROM S1 TO S2 := x > 5; END_TRANSITION;\n\
         TRANSITION t (PRIORITY := 2) FROM (S1, S2) TO (S3, S4) := TRUE; END_TRANSITION\n\
         ACTION a: x := 1; END_ACTION\nSTEP S2: END_STEP\nTRANSITION FROM S2 TO S1 :\n LD x\n AND y\nEND_TRANSITION\n\
         STEP S3: END_STEP\nSTEP S4: END_STEP",
    );
    assert_eq!(
        text[..11],
        [
            "INITIAL_STEP S1",
            "  action a(N)",
            "  action b(N)",
            "  action c(N)",
            "  action d(L, T#5s, x, y)",
            "  action e(SD, t1)",
            "  action f.g(R, x)",
            "TRANSITION from S1 to S2 when (x > 5)",
            "TRANSITION t priority 2 from S1, S2 to S3, S4 when TRUE",
            "STEP S2",
            "TRANSITION from S2 to S1 when IL",
        ]
    );
    assert!(text.iter().any(|l| l.contains("ACTION a")), "{text:?}");
}

#[test]
fn configurations() {
    let text = tree(
        "CONFIGURATION Conf\nVAR_GLOBAL g : INT; END_VAR\nRESOURCE Res ON PLC\nVAR_GLOBAL h : INT; END_VAR\n\
         TASK T1(INTERVAL := T#10ms, PRIORITY := 1);\nTASK T2(SINGLE := g, PRIORITY := 0);\n\
         PROGRAM RETAIN P1 WITH T1 : Main(in := g, out => h, fb WITH T2);\nPROGRAM P2 : Main;\nEND_RESOURCE\n\
         VAR_ACCESS a : Res.P1.x : INT READ_WRITE; b : Res.%IX1.0 : BOOL; c : Res.P1.y : INT READ_ONLY; END_VAR\n\
         VAR_CONFIG Res.P1.q AT %QX1.0 : BOOL; Res.P1.k : INT := 5; END_VAR\nEND_CONFIGURATION\n\
         CONFIGURATION Two\nTASK T(INTERVAL := T#1s);\nPROGRAM P WITH T : Main;\nEND_CONFIGURATION\n",
    );
    for line in [
        "  RESOURCE Res ON PLC",
        "    TASK T1(INTERVAL := T#10ms, PRIORITY := 1)",
        "    PROGRAM RETAIN P1 WITH T1 : Main(in := g, out => h, fb WITH T2)",
        "    PROGRAM P2 : Main()",
        "    a path Res.P1.x : INT READ_WRITE",
        "    b path Res AT %IX1.0 : BOOL",
        "    Res path P1.q AT %QX1.0 : BOOL",
        "    Res path P1.k : INT := 5",
        "  RESOURCE without name",
        "    PROGRAM P WITH T : Main()",
    ] {
        assert!(text.lines().any(|l| l == line), "{line} is not in\n{text}");
    }
}

#[test]
fn spans_are_those_of_the_text() {
    let source =
        "PROGRAM Main\nVAR a : INT   ; b : (x, y) ; END_VAR\nIF a THEN x := 1 ; END_IF\nEND_PROGRAM  (* c *)\n";
    let file = file(source);
    let text = |s: plcc_diag::Span| &source[s.start as usize..s.end as usize];
    let ast::Item::Pou(pou) = &file.items[0] else { panic!() };
    assert_eq!(text(pou.span), source.split("  (*").next().unwrap());
    assert_eq!(text(pou.sections[0].vars[0].span), "a : INT");
    assert_eq!(text(pou.sections[0].vars[1].ty.span), "(x, y)");
    let ast::Body::St(statements) = &pou.body else { panic!() };
    assert_eq!(text(statements[0].span), "IF a THEN x := 1 ; END_IF");
    let ast::StmtKind::If { arms, .. } = &statements[0].kind else { panic!() };
    assert_eq!(text(arms[0].1[0].span), "x := 1");
}

#[test]
fn bodies_alone() {
    let mut diags = Diagnostics::new();
    let mut parse = |text: &str| parse_body(FileId(0), text, Profile::Strict, &mut diags).0;
    assert!(matches!(parse("x := 1;\nIF a THEN y := 2; END_IF;"), ast::Body::St(s) if s.len() == 2));
    assert!(matches!(parse("LD x\nST y"), ast::Body::Il(il) if il.lines.len() == 2));
    assert!(matches!(parse("INITIAL_STEP S: END_STEP"), ast::Body::Sfc(_)));
    assert!(matches!(parse(""), ast::Body::St(s) if s.is_empty()));
    assert_eq!(diags.error_count(), 0);
}

#[test]
fn tokens_are_printed_by_line() {
    let text = print_tokens(FileId(0), "x := 5;\n\n(* c *) IF %IX0.0\n");
    assert_eq!(text, "1: name `x` := literal `5` ;\n3: IF address `%IX0.0`\n");
}
