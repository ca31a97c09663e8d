//! Where a mistake of syntax makes further messages doubtful: one mistake, one message.

use crate::cx::Unit;
use plcc_diag::{Code, Diagnostics, Span, codes};
use plcc_syntax::ast::Unnamed;
use smol_str::SmolStr;

/// The doubtful places of all files.
pub(crate) struct Doubtful {
    /// In order of their starts; each with the greatest end up to it in its file.
    places: Vec<(Span, u32)>,
}

impl Doubtful {
    /// What the parser says of these files.
    pub fn of(units: &[Unit]) -> Self {
        let mut spans: Vec<Span> = units.iter().flat_map(|u| &u.ast.doubtful).copied().collect();
        spans.sort();
        let mut places: Vec<(Span, u32)> = Vec::with_capacity(spans.len());
        for span in spans {
            let before = places.last().filter(|(s, _)| s.file == span.file).map_or(0, |(_, end)| *end);
            places.push((span, span.end.max(before)));
        }
        Self { places }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Whether one has a byte in common with `span`; an empty one counts at the end of a place, too.
    pub fn touches(&self, span: Span) -> bool {
        let point = u32::from(span.start == span.end);
        let before = self.places.partition_point(|(s, _)| (s.file, s.start) < (span.file, span.end + point));
        let Some((last, end)) = before.checked_sub(1).map(|i| self.places[i]) else { return false };
        last.file == span.file && end + point > span.start
    }
}

/// Behind declarations without a name: as many names as they are, which are used and not declared, are taken for theirs, and
/// their uses are no further mistakes.
pub(crate) fn find_unnamed(units: &[Unit], diags: &mut Diagnostics) {
    for unit in units {
        let Unnamed { count, names } = &unit.ast.unnamed;
        let name_at = |span: Span| {
            let n = names.binary_search_by_key(&(span.start, span.end), |(_, s)| (s.start, s.end)).ok();
            n.filter(|_| span.file == unit.file).map(|n| &names[n].0)
        };
        let mut undeclared: Vec<(Span, &SmolStr)> = diags
            .iter()
            .filter(|d| UNDECLARED.contains(&d.code))
            .filter_map(|d| Some((d.primary.span, name_at(d.primary.span)?)))
            .collect();
        undeclared.sort_by_key(|(span, _)| *span);
        let mut meant: Vec<SmolStr> = Vec::new();
        for (_, name) in undeclared {
            if meant.len() < *count && !meant.contains(name) {
                meant.push(name.clone());
            }
        }
        diags.retain(|d| {
            !UNDECLARED.contains(&d.code) || !name_at(d.primary.span).is_some_and(|name| meant.contains(name))
        });
    }
}

/// What is said of a name that is not declared, or means something else.
const UNDECLARED: &[Code] = &[
    codes::UNKNOWN_NAME,
    codes::UNKNOWN_TYPE,
    codes::UNKNOWN_MEMBER,
    codes::UNKNOWN_FUNCTION,
    codes::UNKNOWN_PARAMETER,
    codes::NOT_A_VARIABLE,
    codes::NOT_CALLABLE,
];

#[cfg(test)]
mod tests {
    use super::*;
    use plcc_diag::FileId;

    #[test]
    fn places_and_spans() {
        let (a, b) = (FileId(1), FileId(2));
        let ast = plcc_syntax::ast::File {
            doubtful: vec![Span::new(a, 30, 40), Span::new(a, 5, 20), Span::new(a, 7, 9)],
            ..Default::default()
        };
        let unit = Unit { file: a, ast: &ast, profile: crate::Profile::Strict, builtin: false };
        let doubtful = Doubtful::of(&[unit]);
        let touches = |file, start, end| doubtful.touches(Span::new(file, start, end));
        assert!(touches(a, 15, 16) && touches(a, 0, 6) && touches(a, 0, 50) && touches(a, 39, 41));
        assert!(touches(a, 20, 20) && touches(a, 5, 5));
        assert!(!touches(a, 20, 30) && !touches(a, 0, 5) && !touches(a, 40, 41) && !touches(a, 21, 21));
        assert!(!touches(b, 7, 8) && !touches(FileId(0), 7, 8));
    }
}
