//! The texts that are compiled.

use crate::{FileId, Span};
use std::sync::Arc;

/// One source text with its name and line table.
#[derive(Debug, Clone)]
pub struct SourceFile {
    /// The name as the user gave it (a path, or `<name>` for embedded sources).
    pub name: String,
    /// The text. Sources that are not UTF-8 were read as ISO-8859-1 (semantics.md \[L1\]).
    pub text: Arc<str>,
    /// Part of plcc itself (a standard function block), not the user's.
    pub builtin: bool,
    line_starts: Vec<u32>,
}

impl SourceFile {
    /// Line and column (both from 1; the column counts characters) of a byte offset.
    pub fn line_column(&self, offset: u32) -> (u32, u32) {
        let offset = offset.min(self.text.len() as u32);
        let line = self.line_starts.partition_point(|&s| s <= offset) - 1;
        let start = self.line_starts[line] as usize;
        let mut end = offset as usize;
        while !self.text.is_char_boundary(end) {
            end -= 1;
        }
        let column = self.text[start..end].chars().count() as u32 + 1;
        (line as u32 + 1, column)
    }

    /// The bytes of a line (from 0), its line end included.
    pub fn line_range(&self, line: usize) -> Option<std::ops::Range<usize>> {
        let start = *self.line_starts.get(line)? as usize;
        let end = self.line_starts.get(line + 1).map_or(self.text.len(), |e| *e as usize);
        Some(start..end)
    }

    /// How many lines there are.
    pub fn line_count(&self) -> usize {
        self.line_starts.len()
    }
}

/// All sources of one compilation, by [`FileId`].
#[derive(Debug, Clone, Default)]
pub struct SourceMap {
    files: Vec<SourceFile>,
}

impl SourceMap {
    /// An empty map.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a text of the user.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<Arc<str>>) -> FileId {
        self.push(name.into(), text.into(), false)
    }

    /// Adds a text that is part of plcc.
    pub fn add_builtin(&mut self, name: impl Into<String>, text: impl Into<Arc<str>>) -> FileId {
        self.push(name.into(), text.into(), true)
    }

    fn push(&mut self, name: String, text: Arc<str>, builtin: bool) -> FileId {
        let line_starts = std::iter::once(0)
            .chain(text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i as u32 + 1))
            .collect();
        self.files.push(SourceFile { name, text, builtin, line_starts });
        FileId(self.files.len() as u32 - 1)
    }

    /// The file with this id.
    pub fn file(&self, id: FileId) -> &SourceFile {
        &self.files[id.0 as usize]
    }

    /// All files with their ids, in the order in which they were added.
    pub fn iter(&self) -> impl Iterator<Item = (FileId, &SourceFile)> {
        self.files.iter().enumerate().map(|(i, f)| (FileId(i as u32), f))
    }

    /// The text under a span.
    pub fn text(&self, span: Span) -> &str {
        self.file(span.file).text.get(span.start as usize..span.end as usize).unwrap_or("")
    }

    /// `file:line:column` of the start of a span.
    pub fn position(&self, span: Span) -> String {
        let file = self.file(span.file);
        let (line, column) = file.line_column(span.start);
        format!("{}:{line}:{column}", file.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters() {
        let mut map = SourceMap::new();
        let id = map.add("a.st", "x\näb := 1;\n");
        assert_eq!(map.file(id).line_column(0), (1, 1));
        assert_eq!(map.file(id).line_column(4), (2, 2));
        assert_eq!(map.position(Span::new(id, 4, 5)), "a.st:2:2");
        assert_eq!(map.file(id).line_column(999), (3, 1));
    }
}
