//! Texts inside the XML, as the parser of the text notations can read them where they stand.
//!
//! The view is a copy of the file. Where a text is read, its markup becomes blanks and its character references the
//! characters they stand for, byte for byte in the same place: the characters stand at the end of the bytes that the
//! reference took, in front of them [`FILLER`]s, which the lexer skips. So a position in the view is one in the file.

use super::Reader;
use super::nodes::find;
use crate::ast::{Action, Body, Expr, ExprKind, IlBody, Init, TypeExpr};
use crate::construct::{Context, Parsed};
use crate::lexer::{self, FILLER, Lexed};
use crate::token::{Tok, Token};
use crate::{blocks, recover};
use plcc_diag::{Diagnostic, Span, codes};
use roxmltree::Node;
use std::ops::Range;

/// The copy of the file.
pub(super) struct View {
    text: String,
}

impl View {
    pub fn new(text: &str) -> Self {
        Self { text: text.to_string() }
    }

    /// Makes a part readable: an attribute's value, or the content of an element.
    fn open(&mut self, range: Range<usize>) {
        let decoded = decode(&self.text[range.clone()]);
        debug_assert_eq!(decoded.len(), range.len());
        if decoded.len() == range.len() {
            self.text.replace_range(range, &decoded);
        }
    }
}

/// One past the `>` of the tag that begins at `at`; quotes are stepped over.
pub(super) fn tag_end(bytes: &[u8], at: usize) -> usize {
    let mut quote = None;
    for (i, &b) in bytes.iter().enumerate().skip(at) {
        match (quote, b) {
            (None, b'"' | b'\'') => quote = Some(b),
            (None, b'>') => return i + 1,
            (Some(q), _) if q == b => quote = None,
            _ => {}
        }
    }
    bytes.len()
}

/// Where the start tag of an element stands.
pub(super) fn start_tag(text: &str, node: Node) -> Range<usize> {
    let start = node.range().start;
    start..tag_end(text.as_bytes(), start)
}

/// Between the start tag and the end tag of an element.
fn content(text: &str, node: Node) -> Range<usize> {
    let (range, tag) = (node.range(), start_tag(text, node));
    match text[tag.end..range.end.max(tag.end)].rfind("</") {
        Some(end) => tag.end..tag.end + end,
        None => tag.end..tag.end,
    }
}

/// A well-formed part of an XML file with blanks for markup and characters for their references, of the same length.
pub(super) fn decode(raw: &str) -> String {
    let mut out = String::with_capacity(raw.len());
    let mut rest = raw;
    while let Some(c) = rest.chars().next() {
        let skip = |end: &str| rest.find(end).map_or(rest.len(), |n| n + end.len());
        match c {
            '<' if rest.starts_with("<![CDATA[") => {
                let end = skip("]]>");
                let inner_end = if rest[..end].ends_with("]]>") { end - 3 } else { end };
                fill(&mut out, &rest[..9]);
                out.push_str(&rest[9..inner_end]);
                fill(&mut out, &rest[inner_end..end]);
                rest = &rest[end..];
            }
            '<' => {
                let end = if rest.starts_with("<!--") {
                    skip("-->")
                } else if rest.starts_with("<?") {
                    skip("?>")
                } else {
                    tag_end(rest.as_bytes(), 0)
                };
                // Paragraphs and breaks end lines, which comments of the kind `//` and IL need.
                let tag = &rest[..end];
                let breaks = tag.starts_with("<br") || tag.contains(":br") || ends_paragraph(tag);
                blank(&mut out, tag, breaks);
                rest = &rest[end..];
            }
            '&' => {
                // References that touch make one word, as `&lt;&gt;` does: fillers first, then all characters.
                let mut characters = String::new();
                let mut length = 0;
                while let Some((character, bytes)) = reference(&rest[length..]) {
                    characters.push(character);
                    length += bytes;
                }
                if length == 0 {
                    out.push('&');
                    length = 1;
                } else {
                    out.extend(std::iter::repeat_n(char::from(FILLER), length - characters.len()));
                    out.push_str(&characters);
                }
                rest = &rest[length..];
            }
            c => {
                out.push(c);
                rest = &rest[c.len_utf8()..];
            }
        }
    }
    out
}

fn ends_paragraph(tag: &str) -> bool {
    ["p", "div", "li", "pre"].iter().any(|name| {
        let end = tag.strip_prefix("</").map(|t| t.trim_end_matches('>').trim_end());
        end.is_some_and(|t| t.rsplit(':').next() == Some(name))
    })
}

fn fill(out: &mut String, bytes: &str) {
    out.extend(std::iter::repeat_n(char::from(FILLER), bytes.len()));
}

/// Blanks of the same length that keep the ends of lines; a last one of their own if `breaks`.
fn blank(out: &mut String, markup: &str, breaks: bool) {
    let last = markup.len() - 1;
    for (i, b) in markup.bytes().enumerate() {
        out.push(match b {
            b'\n' => '\n',
            _ if breaks && i == last => '\n',
            _ => ' ',
        });
    }
}

/// The character that a reference stands for, and how many bytes it takes.
fn reference(text: &str) -> Option<(char, usize)> {
    let body = text.strip_prefix('&')?;
    // The longest is `&#x0010FFFF;`, leading zeros aside.
    let end = body.bytes().take(64).position(|b| b == b';')?;
    let name = &body[..end];
    let character = match name {
        "lt" => '<',
        "gt" => '>',
        "amp" => '&',
        "quot" => '"',
        "apos" => '\'',
        _ => {
            let digits = name.strip_prefix('#')?;
            let code = match digits.strip_prefix('x') {
                Some(hex) => u32::from_str_radix(hex, 16).ok()?,
                None => digits.parse().ok()?,
            };
            char::from_u32(code)?
        }
    };
    Some((character, end + 2))
}

impl Reader<'_, '_> {
    /// The content of an element as text, decoded.
    pub(super) fn plain_text(&self, node: Node) -> String {
        decode(&self.text[content(self.text, node)]).replace(char::from(FILLER), "")
    }

    /// The content of an element without the blanks around it.
    pub(super) fn content_span(&self, node: Node) -> Span {
        let range = content(self.text, node);
        let inner = &self.text[range.clone()];
        let start = range.start + (inner.len() - inner.trim_start().len());
        let end = range.end - (inner.len() - inner.trim_end().len());
        Span::new(self.file, start as u32, end.max(start) as u32)
    }

    /// The tokens of a part of the file.
    fn lex(&mut self, range: Range<usize>) -> Lexed {
        self.view.open(range.clone());
        let mut lexed = lexer::lex_xml(&self.view.text[..range.end], range.start, &mut self.report);
        self.names.extend(lexed.tokens.iter().filter(|t| t.kind == Tok::Id));
        self.out.pragmas.append(&mut lexed.pragmas);
        lexed
    }

    fn parse(&mut self, tokens: Vec<Token>, end: usize) -> Option<Parsed> {
        let text = &self.view.text[..end];
        recover::parse(&Context::new(self.file, text), tokens, &mut self.report)
    }

    fn start(&self, kind: Tok, range: &Range<usize>, mut tokens: Vec<Token>) -> Vec<Token> {
        tokens.insert(0, Token::inserted(kind, range.start as u32));
        tokens
    }

    /// The expression in an element; `what` names it in messages.
    pub(super) fn expression_in(&mut self, node: Node, what: &str) -> Expr {
        let range = content(self.text, node);
        let place = self.tag(node);
        self.expression(range, place, what)
    }

    /// The expression in an attribute.
    pub(super) fn expression_of(&mut self, node: Node, attribute: &str, what: &str) -> Option<Expr> {
        let found = find(node, attribute)?;
        let place = self.value_span(found);
        Some(self.expression(found.range_value(), place, what))
    }

    fn expression(&mut self, range: Range<usize>, place: Span, what: &str) -> Expr {
        let mut lexed = self.lex(range.clone());
        // What transitions and vendors write around an expression.
        if lexed.tokens.first().is_some_and(|t| t.kind == Tok::Assign) {
            lexed.tokens.remove(0);
        }
        while lexed.tokens.last().is_some_and(|t| t.kind == Tok::Semi) {
            lexed.tokens.pop();
        }
        let error = Expr { kind: ExprKind::Error, span: place, depth: 1, parens: false };
        if lexed.tokens.is_empty() {
            self.say(
                Diagnostic::new(codes::MISSING_OPERAND, place, format!("{what} is empty"))
                    .help("write a variable or an expression"),
            );
            return error;
        }
        let tokens = self.start(Tok::StartExpr, &range, lexed.tokens);
        match self.parse(tokens, range.end) {
            Some(Parsed::Expr(e)) => *e,
            _ => error,
        }
    }

    /// The type that an attribute names.
    pub(super) fn type_of(&mut self, node: Node, attribute: &str) -> Option<TypeExpr> {
        let found = self.required(node, attribute)?;
        let range = found.range_value();
        let lexed = self.lex(range.clone());
        let tokens = self.start(Tok::StartType, &range, lexed.tokens);
        match self.parse(tokens, range.end)? {
            Parsed::Type(ty) => Some(*ty),
            _ => None,
        }
    }

    /// The initial value in an attribute.
    pub(super) fn init_of(&mut self, node: Node, attribute: &str) -> Option<Init> {
        let found = self.required(node, attribute)?;
        let range = found.range_value();
        let lexed = self.lex(range.clone());
        let tokens = self.start(Tok::StartInit, &range, lexed.tokens);
        match self.parse(tokens, range.end)? {
            Parsed::Init(init) => Some(*init),
            _ => None,
        }
    }

    /// The body in Structured Text or Instruction List in an element, and the ACTIONs in it.
    pub(super) fn text_body(&mut self, node: Node, il: bool) -> (Body, Vec<Action>) {
        let range = content(self.text, node);
        let lexed = self.lex(range.clone());
        let language = if il { Tok::BodyIl } else { Tok::BodySt };
        let (text, start) = (&self.view.text[..range.end], range.start as u32);
        let tokens = blocks::body(text, start, Some(language), &lexed, self.profile, &mut self.report);
        let span = self.content_span(node);
        let parsed = self.parse(tokens, range.end);
        let (mut body, actions) = match parsed {
            Some(Parsed::Body(body)) => *body,
            _ if il => (Body::Il(IlBody { lines: Vec::new(), span }), Vec::new()),
            _ => (Body::St(Vec::new()), Vec::new()),
        };
        if let Body::Il(il) = &mut body {
            il.span = span;
        }
        (body, actions)
    }
}

#[cfg(test)]
mod tests {
    use super::decode;

    /// `~` stands for a filler.
    fn shown(raw: &str) -> String {
        let decoded = decode(raw);
        assert_eq!(decoded.len(), raw.len());
        decoded.replace('\x01', "~")
    }

    #[test]
    fn references_stay_in_their_place() {
        assert_eq!(shown("a &lt;= b"), "a ~~~<= b");
        assert_eq!(shown("a &lt;&gt; b"), "a ~~~~~~<> b");
        assert_eq!(shown("'&#228;&amp;'"), "'~~~~~~~~ä&'");
        assert_eq!(shown("a & b"), "a & b");
    }

    #[test]
    fn markup_becomes_blanks() {
        assert_eq!(shown("<p>x</p>\n<p>y</p>"), "   x   \n\n   y   \n");
        assert_eq!(shown("<x:p a='>'>q</x:p>"), "           q     \n");
        assert_eq!(shown("<![CDATA[a < b]]>"), "~~~~~~~~~a < b~~~");
        assert_eq!(shown("a<!-- ö -->b"), "a           b");
    }
}
