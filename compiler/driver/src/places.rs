//! Messages about PLCopen XML say also what users of an editor know: POU and line of its text, or POU, element, local id and
//! position. Line and column of the XML file stand in front as always.

use plcc_diag::{Diagnostics, FileId, SourceMap, Span};
use plcc_hir::Profile;
use plcc_syntax::ast;

/// Adds the names of their places to the messages.
pub fn name(diags: &mut Diagnostics, files: &[(FileId, Profile, bool, ast::File)], sources: &SourceMap) {
    if files.iter().all(|f| f.3.places.is_empty()) {
        return;
    }
    for mut diagnostic in diags.split_off(0) {
        let span = diagnostic.primary.span;
        let file = files.iter().find(|f| f.0 == span.file);
        if let Some(name) = file.and_then(|f| place(&f.3.places, span, sources)) {
            diagnostic.message.push_str(&format!(" ({name})"));
        }
        diags.push(diagnostic);
    }
}

/// `Main, line 3`, or `Main, coil ...`.
fn place(places: &[ast::Place], span: Span, sources: &SourceMap) -> Option<String> {
    let holds = |p: &&ast::Place| p.span.start <= span.start && span.end <= p.span.end;
    let name = &places.iter().rev().find(|p| !p.text && holds(p))?.name;
    let Some(text) = places.iter().rev().find(|p| p.text && holds(p)) else { return Some(name.clone()) };
    let file = sources.file(span.file);
    let line = |offset| file.line_column(offset).0;
    Some(format!("{name}, line {}", line(span.start) - line(text_start(text.span, sources)) + 1))
}

/// Where the text of a body begins: behind the markup in front of it.
fn text_start(span: Span, sources: &SourceMap) -> u32 {
    let text = sources.text(span);
    let mut at = 0;
    loop {
        let rest = &text[at..];
        let blank = rest.len() - rest.trim_start_matches([' ', '\t']).len();
        if let Some(inner) = rest[blank..].strip_prefix("<![CDATA[") {
            return span.start + (text.len() - inner.len()) as u32;
        }
        match rest.trim_start() {
            tag if tag.starts_with('<') => match tag.find('>') {
                Some(end) => at = text.len() - tag.len() + end + 1,
                None => return span.start,
            },
            _ => return span.start + at as u32,
        }
    }
}
