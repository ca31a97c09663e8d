//! Parses the tokens of one item; where the grammar refuses one, says why in words and mends the tokens.
//!
//! A mend is the smallest change that lets the parse go on: a missing `;`, `)` or THEN is inserted, a missing operand becomes
//! [`Tok::Bad`], and only when nothing of that kind fits, the statement or declaration around the place becomes `Bad` as a
//! whole. Then the item is parsed again: an item is short and mistakes are few, and the parser proper stays free of error
//! productions. One statement yields one message, whatever else follows from it.

mod mend;
mod segment;
mod words;

use crate::construct::{Context, Parsed};
use crate::grammar::StartParser;
use crate::report::Reporter;
use crate::token::{Tok, Token};
use lalrpop_util::ParseError;
use plcc_diag::codes;
use std::cell::Cell;

/// Messages about one item.
const MAX_MESSAGES: usize = 100;
/// Tokens that may be read for one item in all its rounds.
const MAX_WORK: usize = 10_000_000;
/// Attempts to mend one statement before its item is given up.
const MAX_ATTEMPTS: usize = 8;

/// Parses one item, as far as possible.
pub fn parse(cx: &Context, tokens: Vec<Token>, report: &mut Reporter) -> Option<Parsed> {
    let parser = StartParser::new();
    let mut recovery = Recovery { text: cx.source(), tokens, report, seen: Vec::new(), messages: 0 };
    let mut work = 0;
    let mut last_resort = false;
    loop {
        let refused = match recovery.attempt(&parser, cx) {
            Ok(parsed) => {
                for message in cx.take_messages() {
                    recovery.report.push(message);
                }
                return Some(parsed);
            }
            Err(refused) => refused,
        };
        cx.take_messages();
        work += refused.at + 1;
        // Nobody would read what comes of it.
        if last_resort || recovery.report.is_full() {
            recovery.lose(0..recovery.tokens.len());
            return None;
        }
        let spent = recovery.messages >= MAX_MESSAGES || work > MAX_WORK;
        if spent {
            recovery.say_enough(&refused);
        }
        if spent || !recovery.mend(&refused) {
            last_resort = true;
            if !recovery.cut_body() {
                recovery.lose(0..recovery.tokens.len());
                return None;
            }
        }
    }
}

/// Where the grammar stopped.
#[derive(Debug)]
struct Refused {
    /// Index of the token that does not fit; the number of tokens at their end.
    at: usize,
    /// What would fit, as the grammar names its terminals.
    expected: Vec<String>,
}

impl Refused {
    fn wants(&self, terminal: &str) -> bool {
        self.expected.iter().any(|e| e.trim_matches('"') == terminal)
    }

    /// An operand is missing, and not a whole statement.
    fn wants_operand(&self) -> bool {
        self.wants("int") && self.wants("NOT") && !self.wants("IF")
    }

    fn wants_type(&self) -> bool {
        self.wants("ARRAY")
    }
}

struct Recovery<'a, 'd> {
    text: &'a str,
    tokens: Vec<Token>,
    report: &'a mut Reporter<'d>,
    /// Statements (by their first byte) with the number of attempts.
    seen: Vec<(u32, usize)>,
    messages: usize,
}

impl Recovery<'_, '_> {
    fn attempt(&self, parser: &StartParser, cx: &Context) -> Result<Parsed, Refused> {
        let read = Cell::new(0usize);
        let tokens = self.tokens.iter().map(|t| {
            read.set(read.get() + 1);
            (t.start, t.kind, t.end)
        });
        parser.parse(cx, tokens).map_err(|e| match e {
            ParseError::UnrecognizedToken { expected, .. } => Refused { at: read.get() - 1, expected },
            ParseError::UnrecognizedEof { expected, .. } => Refused { at: self.tokens.len(), expected },
            _ => Refused { at: read.get().saturating_sub(1), expected: Vec::new() },
        })
    }

    /// Changes the tokens so that the next round gets further; `false` if the item cannot be saved.
    fn mend(&mut self, refused: &Refused) -> bool {
        let segment = self.segment(refused.at);
        if let Some(t) = self.tokens.get_mut(refused.at)
            && t.kind != Tok::Id
            && refused.wants("name")
            && self.report.is_taken_for_name(t.text(self.text))
        {
            t.kind = Tok::Id;
            return true;
        }
        let place = self.place(segment.start);
        // What the lexer has told needs no second message.
        let told = self.kind(refused.at) == Tok::Bad
            || self.kind(refused.at.wrapping_sub(1)) == Tok::Bad
            || self.tokens.get(refused.at).is_some_and(|t| t.kind == Tok::Eq && t.text(self.text) == "==");
        let attempts = match self.seen.iter_mut().find(|s| s.0 == place) {
            Some(s) => {
                s.1 += 1;
                s.1
            }
            None => {
                self.seen.push((place, 0));
                0
            }
        };
        if attempts > MAX_ATTEMPTS {
            return false;
        }
        if attempts < 3
            && let Some(message) = self.insert_missing(refused, &segment)
        {
            if attempts == 0 && !told {
                self.say(message);
            }
            self.doubt(refused.at, &segment);
            return true;
        }
        if attempts == 0 && !told {
            let message = self.unexpected(refused);
            self.say(message);
        }
        self.give_up(refused, &segment)
    }

    fn say(&mut self, message: plcc_diag::Diagnostic) {
        self.messages += 1;
        self.report.push(message);
    }

    fn say_enough(&mut self, refused: &Refused) {
        let (start, end) = self.bytes(refused.at);
        self.report.push(
            self.report
                .at(codes::TOO_MANY_ERRORS, start, end, "too many syntax errors in this declaration")
                .label("what follows here in it is not read")
                .help("correct the messages above and compile again"),
        );
    }

    /// The bytes of the token `at`; behind the last one if there is none.
    fn bytes(&self, at: usize) -> (u32, u32) {
        match (self.tokens.get(at), self.tokens.last()) {
            (Some(t), _) => (t.start, t.end),
            (None, Some(t)) => (t.end, t.end),
            (None, None) => (0, 0),
        }
    }

    fn kind(&self, at: usize) -> Tok {
        self.tokens.get(at).map_or(Tok::StartItem, |t| t.kind)
    }

    /// The last resort: the item without its body.
    fn cut_body(&mut self) -> bool {
        let marker = self.tokens.iter().position(|t| matches!(t.kind, Tok::BodySt | Tok::BodyIl | Tok::BodySfc));
        let (Some(marker), Some(end)) = (marker, self.tokens.last().copied()) else { return false };
        self.tokens[marker].kind = Tok::BodySt;
        self.tokens.truncate(marker + 1);
        self.tokens.push(end);
        true
    }
}
