//! Text to tokens. Never fails and takes linear time: what is no token is reported once and becomes [`Tok::Bad`] or nothing.
//!
//! Comments vanish, pragmas are kept aside. Literals are checked for their form only; their values are read where their type
//! is known.

mod literal;

pub(crate) use literal::{is_date_prefix, is_duration_prefix};

use crate::ast::Pragma;
use crate::report::Reporter;
use crate::token::{Tok, Token, word_kind};
use plcc_diag::codes;

/// Stands for nothing: in the texts of XML files it fills the place that character references took. No XML file holds it.
pub const FILLER: u8 = 0x01;

/// What a text consists of.
#[derive(Debug, Default)]
pub struct Lexed {
    /// In the order of the text.
    pub tokens: Vec<Token>,
    /// In the order of the text.
    pub pragmas: Vec<Pragma>,
    /// A comment that is not closed hides the rest of the text.
    pub rest_is_comment: bool,
}

/// Cuts `text` (at most 4 GiB) into tokens.
pub fn lex(text: &str, report: &mut Reporter) -> Lexed {
    lex_part(text, 0, false, report)
}

/// Cuts the part of an XML file that begins at byte `start` and ends with `text` into tokens. Positions count from the start
/// of `text`; [`FILLER`]s count as blanks.
pub fn lex_xml(text: &str, start: usize, report: &mut Reporter) -> Lexed {
    lex_part(text, start, true, report)
}

fn lex_part(text: &str, start: usize, fillers: bool, report: &mut Reporter) -> Lexed {
    let mut lexer = Lexer {
        text,
        bytes: text.as_bytes(),
        at: start,
        fillers,
        first: true,
        nested_comments: true,
        bad_until: 0,
        out: Lexed { tokens: Vec::with_capacity((text.len() - start) / 4), ..Lexed::default() },
        report,
    };
    while lexer.at < lexer.bytes.len() {
        lexer.step();
    }
    lexer.out
}

struct Lexer<'t, 'r, 'd> {
    text: &'t str,
    bytes: &'t [u8],
    at: usize,
    /// The text is a part of an XML file.
    fillers: bool,
    /// No token on this line yet.
    first: bool,
    /// Off after the first comment that only ends when nesting is not counted.
    nested_comments: bool,
    /// A run of bad characters that was reported reaches to here.
    bad_until: usize,
    out: Lexed,
    report: &'r mut Reporter<'d>,
}

impl Lexer<'_, '_, '_> {
    fn byte(&self, ahead: usize) -> u8 {
        self.bytes.get(self.at + ahead).copied().unwrap_or(0)
    }

    fn push(&mut self, kind: Tok, length: usize) {
        let start = self.at;
        self.at += length;
        self.out.tokens.push(Token { kind, first: self.first, start: start as u32, end: self.at as u32 });
        self.first = false;
    }

    fn step(&mut self) {
        let c = self.byte(0);
        match c {
            b'\n' => {
                self.first = true;
                self.at += 1;
            }
            b' ' | b'\t' | b'\r' | 0x0b | 0x0c => self.at += 1,
            b'a'..=b'z' | b'A'..=b'Z' | b'_' => self.word(),
            b'0'..=b'9' => self.number(),
            b'(' if self.byte(1) == b'*' => self.block_comment(b'(', b')'),
            b'/' if self.byte(1) == b'*' => self.block_comment(b'/', b'/'),
            b'/' if self.byte(1) == b'/' => self.at = self.line_end(),
            b'#' if self.first => self.foreign_comment(1),
            b'-' if self.first && self.byte(1) == b'-' && self.between_statements() => self.foreign_comment(2),
            b'{' => self.pragma(),
            b'\'' | b'"' => self.string(),
            b'%' => self.address(),
            FILLER if self.fillers => self.at += 1,
            _ => self.sign(c),
        }
    }

    fn line_end(&self) -> usize {
        self.bytes[self.at..].iter().position(|b| *b == b'\n').map_or(self.bytes.len(), |n| self.at + n)
    }

    /// End of the identifier that starts here. Letters beyond ASCII are taken along, for [`Self::word`] to report.
    fn word_end(&self, from: usize) -> usize {
        let mut end = from;
        while end < self.bytes.len() {
            let b = self.bytes[end];
            if b.is_ascii_alphanumeric() || b == b'_' {
                end += 1;
            } else if b >= 0x80 {
                match self.text[end..].chars().next() {
                    Some(c) if c.is_alphanumeric() => end += c.len_utf8(),
                    _ => break,
                }
            } else {
                break;
            }
        }
        end
    }

    fn word(&mut self) {
        let end = self.word_end(self.at);
        let word = &self.text[self.at..end];
        if !word.is_ascii() {
            self.report.push(
                self.report
                    .at(
                        codes::BAD_CHARACTER,
                        self.at as u32,
                        end as u32,
                        format!("`{word}` is not a name of IEC 61131-3"),
                    )
                    .help("names consist of the letters A to Z, digits and underlines"),
            );
        }
        if self.bytes.get(end) == Some(&b'#') {
            return self.prefixed(end);
        }
        // Behind a dot every word is a member's name.
        let member =
            self.out.tokens.last().is_some_and(|t| t.kind == Tok::Dot && t.end as usize == self.at && !self.first);
        let kind = if member { Tok::Id } else { word_kind(word) };
        let kind = if kind == Tok::Op && self.is_function_form(end) { Tok::Id } else { kind };
        self.push(kind, end - self.at);
    }

    /// Whether the operator's word that ends at `end` is called as a function (`x := AND(a, b, c)`): a parenthesis
    /// follows, and it stands where an operand must begin. At the start of a line, behind what may end a line of IL, it may
    /// be an operator of IL.
    fn is_function_form(&self, end: usize) -> bool {
        use Tok::*;
        let gap = self.bytes[end..].iter().take_while(|b| matches!(b, b' ' | b'\t')).count();
        let opens = self.bytes.get(end + gap) == Some(&b'(') && self.bytes.get(end + gap + 1) != Some(&b'*');
        let before = self.out.tokens.last().map(|t| t.kind);
        opens
            && match before {
                Some(LParen | Not | Op) => !self.first,
                Some(
                    Assign | By | Case | Comma | DotDot | Elsif | Eq | If | LBracket | Minus | Plus | Rel | Star | To
                    | Until | While,
                ) => true,
                _ => false,
            }
    }

    fn block_comment(&mut self, open: u8, close: u8) {
        let nested = open == b'(' && self.nested_comments;
        let mut depth = 0usize;
        let mut first_end = None;
        let mut i = self.at;
        let mut end = None;
        while i + 1 < self.bytes.len() {
            let pair = (self.bytes[i], self.bytes[i + 1]);
            if pair == (open, b'*') && (nested || i == self.at) {
                depth += 1;
                i += 2;
            } else if pair == (b'*', close) {
                depth -= 1;
                i += 2;
                first_end.get_or_insert(i);
                if depth == 0 {
                    end = Some(i);
                    break;
                }
            } else {
                i += 1;
            }
        }
        let end = end.or_else(|| self.loose_comment(first_end)).unwrap_or_else(|| {
            let (open, close) = if open == b'(' { ("(*", "*)") } else { ("/*", "*/") };
            let mut message = self.report.at(
                codes::UNCLOSED_COMMENT,
                self.at as u32,
                self.at as u32 + 2,
                "this comment is not closed",
            );
            if let Some(end) = first_end {
                self.nested_comments = false;
                message = message
                    .also(self.report.span(end as u32 - 2, end as u32), "this closes a comment inside it")
                    .help(format!("comments nest: each `{open}` inside a comment needs its own `{close}`"));
            } else {
                message = message.help(format!("write `{close}` where the comment ends"));
            }
            self.report.push(message);
            self.out.rest_is_comment = first_end.is_none();
            first_end.unwrap_or(self.bytes.len())
        });
        self.first |= self.bytes[self.at..end].contains(&b'\n');
        self.at = end;
    }

    /// Where an unclosed comment in an XML file ends all the same: editors of PLCopen XML write comments that do not nest,
    /// and one on the last line of a text hides nothing.
    fn loose_comment(&mut self, first_end: Option<usize>) -> Option<usize> {
        if !self.fillers {
            return None;
        }
        let rest = &self.text[self.at..];
        let end = first_end.or_else(|| (!rest.trim_end().contains('\n')).then_some(self.bytes.len()))?;
        self.nested_comments &= first_end.is_none();
        let start = self.at as u32;
        let message = self.report.at(codes::LOOSE_COMMENT, start, start + 2, "this comment is not closed");
        self.report.push(message.help("write `*)` where it ends; comments nest"));
        Some(end)
    }

    fn pragma(&mut self) {
        let start = self.at;
        // Code of another language stands in double braces and has braces of its own.
        let double = self.byte(1) == b'{';
        let twice = double.then(|| self.bytes[start..].windows(2).position(|w| w == b"}}")).flatten();
        let end = match twice.map(|n| n + 1).or_else(|| self.bytes[start..].iter().position(|b| *b == b'}')) {
            Some(n) => start + n + 1,
            None => {
                let end = self.line_end();
                self.report.push(
                    self.report
                        .at(codes::UNCLOSED_COMMENT, start as u32, start as u32 + 1, "this pragma is not closed")
                        .help("write `}` where the pragma ends"),
                );
                // Of several openers without a closer only the first is told.
                self.at = end;
                if self.bytes[start + 1..].contains(&b'{') {
                    self.skip_open_pragmas();
                }
                return;
            }
        };
        let text = self.text[start + 1..end - 1].into();
        let span = self.report.span(start as u32, end as u32);
        self.out.pragmas.push(Pragma { text, span });
        self.first |= self.bytes[start..end].contains(&b'\n');
        self.at = end;
    }

    /// There is no `}` any more: the rest of the text is read once, each further `{` hiding its line.
    fn skip_open_pragmas(&mut self) {
        while self.at < self.bytes.len() {
            if self.byte(0) == b'{' {
                self.at = self.line_end();
            } else {
                self.step();
            }
        }
    }

    fn sign(&mut self, c: u8) {
        let next = self.byte(1);
        let (kind, length) = match (c, next) {
            (b';', _) => (Tok::Semi, 1),
            (b':', b'=') => (Tok::Assign, 2),
            (b':', _) => return self.colon(),
            (b',', _) => (Tok::Comma, 1),
            (b'.', b'.') => (Tok::DotDot, 2),
            (b'.', _) => (Tok::Dot, 1),
            (b'(', _) => (Tok::LParen, 1),
            (b')', _) => (Tok::RParen, 1),
            (b'[', _) => (Tok::LBracket, 1),
            (b']', _) => (Tok::RBracket, 1),
            (b'^', _) => (Tok::Caret, 1),
            (b'?', b'=') => (Tok::Attempt, 2),
            (b'=', b'>') => (Tok::Arrow, 2),
            (b'=', b'=') => return self.foreign(Tok::Eq, 2, "="),
            (b'=', b'<') => return self.foreign(Tok::Rel, 2, "<="),
            (b'=', _) if self.behind_ref() => return self.bind(),
            (b'=', _) => (Tok::Eq, 1),
            (b'<', b'=' | b'>') | (b'>', b'=') => (Tok::Rel, 2),
            (b'<' | b'>', _) => (Tok::Rel, 1),
            (b'!', b'=') => return self.foreign(Tok::Rel, 2, "<>"),
            (b'!', _) => return self.foreign(Tok::Not, 1, "NOT"),
            (b'&', b'&') => return self.foreign(Tok::Op, 2, "AND"),
            (b'&', _) => (Tok::Op, 1),
            (b'|', b'|') => return self.foreign(Tok::Op, 2, "OR"),
            (b'|', _) => return self.foreign(Tok::Op, 1, "OR"),
            (b'*', b'*') => (Tok::Op, 2),
            (b'*', _) => (Tok::Star, 1),
            (b'/', _) => (Tok::Op, 1),
            (b'+', _) => (Tok::Plus, 1),
            (b'-', _) => (Tok::Minus, 1),
            _ => return self.bad_character(),
        };
        self.push(kind, length);
    }

    /// Whether what stands before goes on with no expression.
    fn between_statements(&self) -> bool {
        let Some(last) = self.out.tokens.last() else { return true };
        last.kind == Tok::Semi || last.kind.is_reserved() && !matches!(last.kind, Tok::Op | Tok::Not)
    }

    /// A line that begins as a comment does in another language.
    fn foreign_comment(&mut self, length: usize) {
        let (start, end) = (self.at, self.at + length);
        let message = format!("`{}` begins no comment", &self.text[start..end]);
        self.report.push(
            self.report
                .at(codes::FOREIGN_OPERATOR, start as u32, end as u32, message)
                .help("write `//` for the rest of a line, `(* ... *)` for any text"),
        );
        self.at = self.line_end();
    }

    /// A sign of another language, taken for the one that is meant.
    fn foreign(&mut self, kind: Tok, length: usize, meant: &str) {
        let (start, end) = (self.at as u32, (self.at + length) as u32);
        let written = &self.text[self.at..self.at + length];
        self.report.push(
            self.report
                .at(codes::FOREIGN_OPERATOR, start, end, format!("`{written}` is not an operator of IEC 61131-3"))
                .help(match written {
                    "==" => "write `=` to compare, `:=` to assign".into(),
                    _ => format!("write `{meant}`"),
                }),
        );
        self.push(kind, length);
    }

    /// Whether the `=` here makes `REF=` of the word before it on the line: `REF` directly behind an operand or a type,
    /// where no other name could stand.
    fn behind_ref(&self) -> bool {
        use Tok::*;
        let [.., before, word] = self.out.tokens.as_slice() else { return false };
        let text = &self.text[word.start as usize..word.end as usize];
        word.kind == Id
            && !self.first
            && text.eq_ignore_ascii_case("REF")
            && matches!(before.kind, Id | RBracket | RParen | Caret)
    }

    /// `REF=`, whose `=` is here.
    fn bind(&mut self) {
        self.at += 1;
        if let Some(word) = self.out.tokens.last_mut() {
            word.kind = Tok::Bind;
            word.end = self.at as u32;
        }
        self.first = false;
    }

    /// `:`, or `:=` with a blank inside, which can be nothing else.
    fn colon(&mut self) {
        let rest = self.bytes[self.at + 1..].iter();
        let gap = rest.take_while(|b| matches!(b, b' ' | b'\t')).count();
        let (start, after) = (self.at, self.at + 1 + gap);
        let assign = match (self.bytes.get(after), self.bytes.get(after + 1)) {
            (Some(b'='), next) if next != Some(&b'>') && gap > 0 => Some(after + 1),
            _ => None,
        };
        let message = "`:=` is one sign, without a blank between `:` and `=`";
        let Some(end) = assign else { return self.push(Tok::Colon, 1) };
        self.report.push(self.report.at(codes::SPLIT_ASSIGN, start as u32, end as u32, message).help("write `:=`"));
        self.push(Tok::Assign, end - start);
    }

    fn bad_character(&mut self) {
        let Some(c) = self.text[self.at..].chars().next() else { return };
        if matches!(c, '‘' | '’' | '‚' | '“' | '”' | '„') {
            return self.smart_string(c);
        }
        if c.is_alphabetic() {
            return self.word();
        }
        let length = c.len_utf8();
        // Byte order marks and blanks of other kinds carry no meaning.
        if c == '\u{feff}' || c.is_whitespace() {
            self.at += length;
            return;
        }
        if self.at > self.bad_until || self.at == 0 {
            let shown = if c.is_control() { format!("U+{:04X}", c as u32) } else { format!("`{c}`") };
            let (start, end) = (self.at as u32, (self.at + length) as u32);
            let mut message =
                self.report.at(codes::BAD_CHARACTER, start, end, format!("the character {shown} has no meaning here"));
            if c == '\0' {
                message = message.help("this does not look like a text file");
            }
            if matches!(c, '#' | '$') && self.bytes.get(self.at + 1).is_some_and(u8::is_ascii_hexdigit) {
                message = message.help("a hexadecimal number is written `16#FF`");
            }
            if c == '`' {
                message = message.help("a text stands in single quotes: 'abc'");
            }
            if c == '~' {
                message = message.help("the opposite is written NOT");
            }
            if c == '?' {
                message = message.help("a choice is written with IF, or as SEL(condition, if_false, if_true)");
            }
            self.report.push(message);
            // A text in quotes of another kind is one mistake.
            let rest = if c == '`' { &self.text[self.at + length..] } else { "" };
            let quoted = rest.find(['`', '\n']).filter(|n| rest.as_bytes()[*n] == b'`');
            if let Some(n) = quoted {
                return self.push(Tok::Bad, length + n + 1);
            }
            // A control character was not written by anybody: what stands around it is still what it seems to be.
            if !c.is_control() {
                return self.push(Tok::Bad, length);
            }
        }
        self.at += length;
        self.bad_until = self.at;
    }
}

#[cfg(test)]
mod tests;
