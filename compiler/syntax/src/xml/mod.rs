//! PLCopen TC6 XML (2.01, and 1.01 where it differs) to the tree that the text notations give.
//!
//! In: the text of one file. Out: an [`ast::File`], LD and FBD bodies as [`ast::Network`], charts as [`ast::SfcBody`], every
//! other body as its text notation gives it. What is written inside the XML (bodies in ST and IL, types, values,
//! expressions) is read by the parser of the text notations where it stands, so every span is a place in the XML file. Vendor
//! data (`addData`, elements of other name spaces) is skipped. Names, types and the rules of networks are the business of
//! `hir`.

mod chart;
mod graph;
mod instances;
mod interface;
mod nodes;
mod pous;
mod types;
mod view;

use crate::Profile;
use crate::ast;
use crate::report::Reporter;
use nodes::{children, named};
use plcc_diag::{Diagnostic, Diagnostics, FileId, Span, codes};
use roxmltree::{Document, Node, ParsingOptions};
use view::View;

/// Larger files are refused: the tree takes several times the memory of the text.
const MAX_BYTES: usize = 64 << 20;
/// How deep elements may nest; what editors write stays below 40.
const MAX_DEPTH: usize = 200;
/// Elements and texts of a file.
const MAX_NODES: u32 = 3_000_000;
/// Attributes of one element: the XML library compares each with each.
const MAX_ATTRIBUTES: usize = 1000;
/// How the name spaces of PLCopen TC6 begin.
const NAMESPACE: &str = "http://www.plcopen.org/xml/tc6";

/// Reads a PLCopen TC6 XML file. Mistakes are reported and leave error nodes.
pub fn parse_xml(file: FileId, text: &str, profile: Profile, diags: &mut Diagnostics) -> ast::File {
    if text.len() > MAX_BYTES {
        diags.push(
            Diagnostic::new(
                codes::XML_SYNTAX,
                Span::new(file, 0, 0),
                format!("this file has {} MB, plcc reads XML files of up to {}", text.len() >> 20, MAX_BYTES >> 20),
            )
            .help("export the project in several files"),
        );
        return ast::File::default();
    }
    if let Some((at, message)) = too_much(text) {
        let at = at as u32;
        diags.push(
            Diagnostic::new(codes::XML_SYNTAX, Span::new(file, at, at), message)
                .help("no editor writes such PLCopen XML; export the file again"),
        );
        return ast::File::default();
    }
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    let document = match Document::parse_with_options(text, options) {
        Ok(document) => document,
        Err(error) => {
            diags.push(not_well_formed(file, text, &error));
            return ast::File::default();
        }
    };
    let root = document.root_element();
    let mut report = Reporter::new(file, diags);
    if let Err(message) = is_project(root) {
        let tag = view::start_tag(text, root);
        report.push(report.at(codes::NOT_PLCOPEN, tag.start as u32, tag.end as u32, message).help(
            "export the project as PLCopen TC6 XML; its root is <project xmlns=\"http://www.plcopen.org/xml/tc6_0201\">",
        ));
        return ast::File::default();
    }
    let mut reader = Reader {
        file,
        text,
        view: View::new(text),
        profile,
        report,
        out: ast::File::default(),
        names: Vec::new(),
        pou: String::new(),
    };
    reader.project(root);
    let Reader { report, mut out, names, .. } = reader;
    (out.doubtful, out.unnamed) = report.doubtful(text, &names);
    out
}

/// A part of an XML file as the text that it stands for.
pub fn plain_text(xml: &str) -> String {
    view::decode(xml).replace(char::from(crate::lexer::FILLER), "")
}

/// Where elements nest too deep or have too many attributes, found before anything recurses over them or compares them.
/// Comments and CDATA sections are stepped over.
fn too_much(text: &str) -> Option<(usize, String)> {
    let bytes = text.as_bytes();
    let (mut at, mut depth) = (0, 0usize);
    while let Some(next) = bytes[at..].iter().position(|b| *b == b'<') {
        at += next;
        let rest = &text[at..];
        let skip = |end: &str| rest.find(end).map_or(rest.len(), |n| n + end.len());
        at += if rest.starts_with("<!--") {
            skip("-->")
        } else if rest.starts_with("<![CDATA[") {
            skip("]]>")
        } else if rest.starts_with("<?") || rest.starts_with("<!") {
            skip(">")
        } else {
            let tag = view::tag_end(bytes, at) - at;
            if rest.starts_with("</") {
                depth = depth.saturating_sub(1);
            } else if !rest[..tag].ends_with("/>") {
                depth += 1;
            }
            if depth > MAX_DEPTH {
                return Some((at, format!("more than {MAX_DEPTH} elements are open here")));
            }
            if tag > MAX_ATTRIBUTES && rest[..tag].bytes().filter(|b| *b == b'=').nth(MAX_ATTRIBUTES).is_some() {
                return Some((at, format!("this element has more than {MAX_ATTRIBUTES} attributes")));
            }
            tag
        };
    }
    None
}

fn not_well_formed(file: FileId, text: &str, error: &roxmltree::Error) -> Diagnostic {
    let place = error.pos();
    // Lines and columns count from 1, columns in characters.
    let mut start = 0;
    for _ in 1..place.row {
        start += text[start..].find('\n').map_or(0, |n| n + 1);
    }
    let column = text[start..].char_indices().nth((place.col as usize).saturating_sub(1)).map_or(0, |(n, _)| n);
    let at = ((start + column).min(text.len())) as u32;
    let (message, help) = match error {
        roxmltree::Error::DtdDetected => {
            ("a document type declaration is not read".into(), "PLCopen XML has none; remove <!DOCTYPE ...>")
        }
        roxmltree::Error::NodesLimitReached => ("this file has too many elements".into(), "export it in several files"),
        other => {
            // The library repeats the position that the message shows anyway.
            let text = other.to_string().replace(&format!(" at {place}"), "");
            (format!("this is not well-formed XML: {text}"), "export the file again, or look at this place")
        }
    };
    Diagnostic::new(codes::XML_SYNTAX, Span::new(file, at, at), message).help(help)
}

/// Whether the root is that of a PLCopen project; else why not.
fn is_project(root: Node) -> Result<(), String> {
    let name = root.tag_name();
    match name.namespace() {
        Some(space) if space.starts_with(NAMESPACE) && name.name() == "project" => Ok(()),
        Some(space) if space.starts_with(NAMESPACE) => Err(format!("the root is <{}>, not <project>", name.name())),
        Some(space) => Err(format!("<{}> of the name space {space} is no PLCopen project", name.name())),
        None => Err(format!("<{}> without a name space is no PLCopen project", name.name())),
    }
}

/// What reads one file.
struct Reader<'t, 'd> {
    file: FileId,
    text: &'t str,
    view: View,
    profile: Profile,
    report: Reporter<'d>,
    out: ast::File,
    /// Tokens of all texts, to find uses of names that were lost.
    names: Vec<crate::token::Token>,
    /// The POU that is being read, for messages.
    pou: String,
}

impl Reader<'_, '_> {
    fn project(&mut self, project: Node) {
        for part in children(project) {
            match part.tag_name().name() {
                "fileHeader" | "contentHeader" | "documentation" => {}
                "types" => {
                    for data_type in named(part, "dataTypes").flat_map(|types| named(types, "dataType")) {
                        self.data_type(data_type);
                    }
                    for pou in named(part, "pous").flat_map(|pous| named(pous, "pou")) {
                        self.pou(pou);
                    }
                }
                "instances" => {
                    for list in named(part, "configurations") {
                        for configuration in named(list, "configuration") {
                            self.configuration(configuration);
                        }
                    }
                }
                _ => self.unknown(part, "a project"),
            }
        }
    }

    /// The start tag of an element.
    fn tag(&self, node: Node) -> Span {
        let tag = view::start_tag(self.text, node);
        Span::new(self.file, tag.start as u32, tag.end as u32)
    }

    /// An element with all that it holds.
    fn whole(&self, node: Node) -> Span {
        let range = node.range();
        Span::new(self.file, range.start as u32, range.end as u32)
    }

    fn say(&mut self, diagnostic: Diagnostic) {
        self.report.push(diagnostic);
    }

    /// An element that has no meaning where it stands.
    fn unknown(&mut self, node: Node, place: &str) {
        let message = format!("<{}> means nothing in {place}", node.tag_name().name());
        let span = self.tag(node);
        self.say(
            Diagnostic::new(codes::XML_UNKNOWN, span, message)
                .help("plcc reads TC6 XML 2.01 and 1.01; vendors put their own data into <addData>"),
        );
    }

    /// A construct that plcc does not compile.
    fn unsupported(&mut self, node: Node, what: &str, help: &str) {
        let span = self.tag(node);
        self.say(Diagnostic::new(codes::NOT_SUPPORTED, span, format!("{what}: not supported")).help(help));
    }

    /// Names a part of the file for messages.
    fn place(&mut self, node: Node, name: String, text: bool) {
        let span = self.whole(node);
        self.out.places.push(ast::Place { span, name, text });
    }
}
