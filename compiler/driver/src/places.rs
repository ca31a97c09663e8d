//! Messages about PLCopen XML say also what users of an editor know: POU and line of its text, or POU, element, local id and
//! position. Line and column of the XML file stand in front as always.

use plcc_diag::{Diagnostics, FileId, SourceMap, Span};
use plcc_hir::Profile;
use plcc_syntax::ast;

/// Adds the names of their places to the messages.
pub fn name(diags: &mut Diagnostics, files: &[(FileId, Profile, bool, ast::File)], sources: &SourceMap) {
    let indices: Vec<(FileId, Index)> =
        files.iter().filter(|f| !f.3.places.is_empty()).map(|f| (f.0, Index::new(&f.3.places))).collect();
    if indices.is_empty() {
        return;
    }
    for mut diagnostic in diags.split_off(0) {
        let span = diagnostic.primary.span;
        let index = indices.iter().find(|(file, _)| *file == span.file);
        if let Some(name) = index.and_then(|(_, index)| index.name(span, sources)) {
            diagnostic.message.push_str(&format!(" ({name})"));
        }
        diags.push(diagnostic);
    }
}

/// The places of a file as a tree: they lie inside or beside each other.
struct Index<'p> {
    /// By their starts, outer ones first.
    places: Vec<&'p ast::Place>,
    /// The place around each.
    outer: Vec<Option<usize>>,
}

impl<'p> Index<'p> {
    fn new(places: &'p [ast::Place]) -> Self {
        let mut places: Vec<&ast::Place> = places.iter().collect();
        places.sort_by_key(|p| (p.span.start, std::cmp::Reverse(p.span.end)));
        let mut outer = Vec::with_capacity(places.len());
        let mut open: Vec<usize> = Vec::new();
        for (index, place) in places.iter().enumerate() {
            while open.pop_if(|o| places[*o].span.end < place.span.end).is_some() {}
            outer.push(open.last().copied());
            open.push(index);
        }
        Self { places, outer }
    }

    /// `Main, line 3`, or `Main, coil ...`.
    fn name(&self, span: Span, sources: &SourceMap) -> Option<String> {
        let mut at = self.places.partition_point(|p| p.span.start <= span.start).checked_sub(1);
        let mut line = String::new();
        while let Some(index) = at {
            let place = self.places[index];
            if span.end <= place.span.end {
                if !place.text {
                    return Some(format!("{}{line}", place.name));
                }
                let file = sources.file(span.file);
                let number = |offset| file.line_column(offset).0;
                let first = number(text_start(place.span, sources));
                line = format!(", line {}", (number(span.start) + 1).saturating_sub(first));
            }
            at = self.outer[index];
        }
        None
    }
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
