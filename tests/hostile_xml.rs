//! PLCopen XML that nobody drew: each gives a diagnostic and the right exit code, in bounded time and memory, without a panic.

use plcc_tests::{Done, command};
use std::fmt::Write;
use std::path::Path;

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");

fn check(bytes: &[u8]) -> Done {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("x.xml"), bytes).expect("the input");
    command(Path::new(PLCC), folder.path(), &["check", "x.xml", "--message-format", "short"])
}

/// An error with this code, and no code beyond.
fn refused(bytes: &[u8], code: &str) {
    let done = check(bytes);
    let start = &done.stderr[..done.stderr.len().min(600)];
    assert_eq!(done.code, 1, "{start}");
    assert!(done.stderr.contains(&format!("error[{code}]")), "{start}");
}

fn accepted(text: &str) {
    let done = check(text.as_bytes());
    assert_eq!(done.code, 0, "{}", &done.stderr[..done.stderr.len().min(600)]);
}

/// A project of one program with inputs `a`, `b` and outputs `q`, `n`.
fn project(body: &str) -> String {
    let var = |name: &str, ty: &str| format!("<variable name=\"{name}\"><type><{ty}/></type></variable>");
    format!(
        "<?xml version=\"1.0\"?>\n<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><types><pous>\n\
         <pou name=\"Main\" pouType=\"program\"><interface><inputVars>{}{}</inputVars><outputVars>{}{}</outputVars></interface>\n\
         <body>{body}</body></pou></pous></types></project>\n",
        var("a", "BOOL"),
        var("b", "BOOL"),
        var("q", "BOOL"),
        var("n", "INT")
    )
}

fn from(id: usize) -> String {
    format!("<connectionPointIn><connection refLocalId=\"{id}\"/></connectionPointIn>")
}

#[test]
fn entity_bombs() {
    let mut text = String::from("<?xml version=\"1.0\"?>\n<!DOCTYPE lolz [<!ENTITY l0 \"lol\">");
    for n in 1..20 {
        write!(text, "<!ENTITY l{n} \"{}\">", format!("&l{};", n - 1).repeat(10)).expect("text");
    }
    text += "]>\n<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\">&l19;</project>";
    refused(text.as_bytes(), "E0130");
    // An external entity is not fetched.
    let external = "<!DOCTYPE x [<!ENTITY e SYSTEM \"file:///etc/passwd\">]>\n<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\">&e;</project>";
    refused(external.as_bytes(), "E0130");
    refused(project("<ST>n := &undefined;;</ST>").as_bytes(), "E0130");
}

#[test]
fn large_files() {
    // Over the limit: refused before anything is built.
    let mut large = project("").into_bytes();
    large.resize(100 << 20, b' ');
    refused(&large, "E0130");
    // Large, but a project: an ST body of 2 MB and comments around it.
    let statements = "q := a AND b;\n".repeat(20_000);
    let padding = format!("<!--{}-->", " ".repeat(4 << 20));
    accepted(&(padding + &project(&format!("<ST>{statements}</ST>")).replace("<?xml version=\"1.0\"?>\n", "")));
}

#[test]
fn deep_nesting() {
    for depth in [250, 100_000, 1_000_000] {
        let text = format!(
            "<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\">{}{}</project>",
            "<types>".repeat(depth),
            "</types>".repeat(depth)
        );
        refused(text.as_bytes(), "E0130");
    }
    refused("<a>".repeat(1_000_000).as_bytes(), "E0130");
    // More attributes than an XML library can compare, more elements than memory should hold.
    let attributes: String = (0..200_000).map(|n| format!(" a{n}=''")).collect();
    refused(format!("<a{attributes}/>").as_bytes(), "E0130");
    refused(format!("<a>{}</a>", "<b/>".repeat(3_500_000)).as_bytes(), "E0130");
    // What looks like tags in texts is none.
    accepted(&project(&format!("<ST><![CDATA[(* {} *)]]></ST>", "<a>".repeat(1000))));
    refused(project(&format!("<ST>n := {}1{};</ST>", "(".repeat(10_000), ")".repeat(10_000))).as_bytes(), "E0122");
}

#[test]
fn broken_encodings() {
    let mut text = project("<ST>q := a; (* x *)</ST>").into_bytes();
    let at = text.windows(5).position(|w| w == b"(* x ").expect("the comment") + 3;
    text[at] = 0xff;
    refused(&text, "E0130");
    // Declared, it is read.
    let mut latin = b"<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>".to_vec();
    latin.extend(text.split(|b| *b == b'\n').skip(1).collect::<Vec<_>>().join(&b'\n'));
    assert_eq!(check(&latin).code, 0);
    let wide: Vec<u8> =
        [0xff, 0xfe].into_iter().chain(project("<ST>q := a;</ST>").encode_utf16().flat_map(u16::to_le_bytes)).collect();
    assert_eq!(check(&wide).code, 0);
    refused(&[], "E0130");
    refused(b"\xef\xbb\xbf", "E0130");
    refused(b"<\0\0\0\0>", "E0130");
    refused("<project".as_bytes(), "E0130");
    refused("<project a='".as_bytes(), "E0130");
    refused(project("<ST>\u{1}</ST>").as_bytes(), "E0130");
}

#[test]
fn wrong_name_spaces() {
    refused(b"<project/>", "E0131");
    refused(b"<project xmlns=\"urn:x\"/>", "E0131");
    refused(b"<pous xmlns=\"http://www.plcopen.org/xml/tc6_0201\"/>", "E0131");
    refused(b"<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><x:types/></project>", "E0130");
    // Vendors' elements are skipped, also among the standard's.
    accepted(&project(
        "<ST>q := a;</ST><v:CFC xmlns:v=\"urn:vendor\"><v:ST/></v:CFC><addData><data name=\"x\" handleUnknown=\"discard\"><y/></data></addData>",
    ));
}

#[test]
fn references_that_lead_nowhere_or_in_circles() {
    let block = |id: usize, source: usize| {
        format!(
            "<block localId=\"{id}\" typeName=\"NOT\"><inputVariables><variable formalParameter=\"IN\">{}</variable></inputVariables>\
             <outputVariables><variable formalParameter=\"OUT\"><connectionPointOut/></variable></outputVariables></block>",
            from(source)
        )
    };
    let out = |id: usize, source: usize| {
        format!("<outVariable localId=\"{id}\">{}<expression>q</expression></outVariable>", from(source))
    };
    refused(project(&format!("<FBD>{}</FBD>", out(1, 99))).as_bytes(), "E0411");
    refused(project(&format!("<FBD>{}{}</FBD>", out(1, 2), out(2, 1))).as_bytes(), "E0411");
    refused(
        project("<FBD><inVariable localId=\"-1\"><expression>a</expression></inVariable></FBD>").as_bytes(),
        "E0133",
    );
    refused(project("<FBD><inVariable><expression>a</expression></inVariable></FBD>").as_bytes(), "E0132");
    refused(
        project("<FBD><inVariable localId=\"99999999999999999999999\"><expression>a</expression></inVariable></FBD>")
            .as_bytes(),
        "E0133",
    );
    // A ring of 2,000 blocks, a chain of 20,000 and 2,000 loops of two: long, but drawings.
    let ring: String = (1..=2000).map(|n| block(n, n % 2000 + 1)).collect();
    accepted(&project(&format!("<FBD>{ring}{}</FBD>", out(5000, 1))));
    let chain: String = (2..20_000).map(|n| block(n, n - 1)).collect();
    accepted(&project(&format!(
        "<FBD><inVariable localId=\"1\"><expression>a</expression></inVariable>{chain}{}</FBD>",
        out(50_000, 19_999)
    )));
    let loops: String = (0..2000).flat_map(|n| [block(2 * n + 1, 2 * n + 2), block(2 * n + 2, 2 * n + 1)]).collect();
    accepted(&project(&format!("<FBD>{loops}</FBD>")));
    // A connector that nothing leads to.
    let open = "<connector localId=\"1\" name=\"c\"><connectionPointIn/></connector><continuation localId=\"2\" name=\"c\"><connectionPointOut/></continuation>";
    refused(project(&format!("<FBD>{open}{}</FBD>", out(3, 2))).as_bytes(), "E0413");
    // Connectors in a circle.
    let link = |id: usize, name: usize| {
        format!(
            "<connector localId=\"{id}\" name=\"c{name}\">{}</connector><continuation localId=\"{}\" name=\"c{}\"><connectionPointOut/></continuation>",
            from(id + 1),
            id + 1,
            (name + 1) % 1000
        )
    };
    let circle: String = (0..1000).map(|n| link(2 * n + 1, n)).collect();
    refused(project(&format!("<FBD>{circle}{}</FBD>", out(9000, 2))).as_bytes(), "E0418");
}

#[test]
fn names_of_pins_beyond_ascii() {
    // The second byte lies inside a letter.
    for name in ["a\u{e9}b", "\u{e9}", "IN\u{663}", "I\u{301}N2"] {
        let pins = format!(
            "<variable formalParameter=\"IN1\">{0}</variable><variable formalParameter=\"{name}\">{0}</variable>\
             <variable formalParameter=\"{name}x\"><connectionPointIn/></variable>",
            from(1)
        );
        let body = format!(
            "<FBD><inVariable localId=\"1\"><connectionPointOut/><expression>a</expression></inVariable>\
             <block localId=\"2\" typeName=\"AND\"><inputVariables>{pins}</inputVariables><outputVariables>\
             <variable formalParameter=\"OUT\"><connectionPointOut/></variable></outputVariables></block>\
             <outVariable localId=\"3\">{}<expression>q</expression></outVariable></FBD>",
            from(2)
        );
        refused(project(&body).as_bytes(), "E0413");
    }
}

#[test]
fn ids_that_stand_twice() {
    let input = "<inVariable localId=\"1\"><connectionPointOut/><expression>a</expression></inVariable>";
    refused(project(&format!("<FBD>{}</FBD>", input.repeat(3))).as_bytes(), "E0410");
    let step = "<step localId=\"1\" name=\"S\" initialStep=\"true\"><connectionPointOut/></step>";
    refused(project(&format!("<SFC>{}</SFC>", step.repeat(2))).as_bytes(), "E0410");
}

#[test]
fn rungs_of_many_lines_that_meet() {
    // Each contact takes all contacts of the column before: a number of ways that no one can write down.
    let mut body = String::from("<LD><leftPowerRail localId=\"1\"><connectionPointOut/></leftPowerRail>");
    let columns = 40;
    for column in 0..columns {
        for row in 0..8 {
            let sources: String = match column {
                0 => "<connection refLocalId=\"1\"/>".into(),
                _ => (0..8).map(|r| format!("<connection refLocalId=\"{}\"/>", 10 + (column - 1) * 8 + r)).collect(),
            };
            let id = 10 + column * 8 + row;
            write!(
                body,
                "<contact localId=\"{id}\"><connectionPointIn>{sources}</connectionPointIn><connectionPointOut/><variable>{}</variable></contact>",
                if row % 2 == 0 { "a" } else { "b" }
            )
            .expect("text");
        }
    }
    write!(body, "<coil localId=\"9999\">{}<variable>q</variable></coil></LD>", from(10 + (columns - 1) * 8))
        .expect("text");
    accepted(&project(&body));
}

#[test]
fn charts_with_circles_of_divergences() {
    let div = |id: usize, source: usize| {
        format!(
            "<selectionDivergence localId=\"{id}\">{}<connectionPointOut formalParameter=\"\"/></selectionDivergence>",
            from(source)
        )
    };
    let body = format!(
        "<SFC><step localId=\"1\" name=\"S\" initialStep=\"true\"><connectionPointOut/></step>{}{}\
         <transition localId=\"4\">{}<connectionPointOut/><condition><inline><ST>a</ST></inline></condition></transition></SFC>",
        div(2, 3),
        div(3, 2),
        from(3)
    );
    refused(project(&body).as_bytes(), "E0433");
}
