//! END words: what they close, and what is missing or too much.

use super::{Blocks, Construct, Frame, Phase, is_close};
use crate::token::{Tok, Token, word_kind};
use plcc_diag::codes;

/// How far a misplaced END word looks for the right one.
const MAX_LOOK: usize = 5000;
/// How many outer constructs one message lists.
const MAX_LISTED: usize = 5;

impl Blocks<'_, '_> {
    /// An END word of `length` tokens (more than one when it is misspelled) that closes a `block`.
    pub(super) fn end_word(&mut self, block: Construct, length: usize) {
        let t = self.peek(0);
        if let Some(i) = self.stack.iter().rposition(|f| f.block == block) {
            self.close_above(i + 1, t);
            return self.close_top(length);
        }
        match self.top() {
            Some(top) if top.is_statement() && block.is_statement() && !self.closer_ahead(top) => {
                self.wrong_end(t, self.stack.len() - 1);
                self.close_top(length);
            }
            Some(_) if block.is_pou() && self.stack[0].block.is_pou() => {
                self.wrong_end(t, 0);
                self.close_above(1, t);
                self.close_top(length);
            }
            _ => {
                if !self.lost {
                    let word = block.end().describe();
                    let (start, end) = (t.start, self.peek(length - 1).end);
                    self.report.push(
                        self.report
                            .at(codes::STRAY_END, start, end, format!("{word} closes nothing"))
                            .help("remove it, or write the word that opens the construct"),
                    );
                }
                self.lost = self.stack.is_empty();
                self.at += length;
                if self.peek(0).kind == Tok::Semi {
                    self.at += 1;
                }
            }
        }
    }

    /// Whether the innermost construct, a `block`, has its END word further on.
    fn closer_ahead(&self, block: Construct) -> bool {
        self.closers_ahead(block, 1)
    }

    /// Whether `depth` constructs of the kind `block` have their END words further on.
    pub(super) fn closers_ahead(&self, block: Construct, mut depth: usize) -> bool {
        for t in self.tokens[self.at + 1..].iter().take(MAX_LOOK) {
            if Construct::statement(t.kind) == Some(block) {
                depth += 1;
            } else if t.kind == block.end() {
                depth -= 1;
                if depth == 0 {
                    return true;
                }
            } else if Construct::closed_by(t.kind).is_some_and(|b| !b.is_statement()) {
                return false;
            }
        }
        false
    }

    fn wrong_end(&mut self, t: Token, frame: usize) {
        let Frame { block, opener, .. } = self.stack[frame];
        let (written, right) = (t.text(self.text), block.end().describe());
        let name = opener.text(self.text).to_ascii_uppercase();
        self.report.push(
            self.report
                .at(codes::WRONG_END, t.start, t.end, format!("{name} is closed by `{written}`"))
                .also(self.report.span(opener.start, opener.end), "opened here")
                .help(format!("write `{right}`")),
        );
    }

    /// Closes the innermost construct with the next `length` tokens.
    fn close_top(&mut self, length: usize) {
        let Some(frame) = self.stack.last().copied() else { return };
        let t = self.peek(0);
        self.before_end();
        self.at += length;
        let end = self.tokens[..self.at].last().map_or(t.end, |t| t.end);
        self.emit(Token { kind: frame.block.end(), end, ..t });
        self.stack.pop();
        self.note_shift(&frame, t);
        self.after_end(frame.block, end);
    }

    /// What an END word needs before it.
    fn before_end(&mut self) {
        let Some(frame) = self.stack.last() else { return };
        if frame.phase == Phase::Head && (frame.block.is_pou() || frame.block == Construct::Action) {
            self.insert(Tok::BodySt);
        }
    }

    /// The `;` behind an END word.
    fn after_end(&mut self, block: Construct, end: u32) {
        let next = self.peek(0).kind;
        if block.is_statement() {
            if next != Tok::Semi {
                self.bare_ends.extend(self.out.last());
                self.emit(Token::inserted(Tok::Semi, end));
            }
        } else if matches!(block, Construct::Struct | Construct::Union) {
            if !matches!(next, Tok::Semi | Tok::Assign) {
                self.emit(Token::inserted(Tok::Semi, end));
            }
        } else if next == Tok::Semi {
            self.at += 1;
        }
        if self.stack.is_empty() {
            let item = std::mem::take(&mut self.out);
            self.items.push(item);
        }
    }

    /// Remembers what the indentation of the END word `t` of `frame` says: does it belong to an outer construct?
    fn note_shift(&mut self, frame: &Frame, t: Token) {
        if let Some(behind) = frame.behind_else
            && let Some(outer) = self.stack.last_mut()
        {
            outer.else_if.get_or_insert((behind, frame.opener));
        }
        let (Some(own), Some(end)) = (frame.indent, self.indent(t)) else { return };
        if end >= own || !frame.block.is_statement() {
            return;
        }
        let same = |f: &&mut Frame| f.block == frame.block && f.indent == Some(end);
        if let Some(outer) = self.stack.iter_mut().rev().take_while(|f| f.block.is_statement()).find(same) {
            outer.suspect.get_or_insert(frame.suspect.unwrap_or((frame.opener, t)));
        }
    }

    /// Reports the constructs from `from` on as not closed where `t` stands, and closes them.
    pub(super) fn close_above(&mut self, from: usize, t: Token) {
        if self.stack.len() <= from {
            return;
        }
        // Behind a comment that swallowed the rest of the file nothing more can be said.
        if !(self.rest_is_comment && t.is_inserted()) {
            self.report_unclosed(from, t);
        }
        while self.stack.len() > from {
            let frame = self.stack[self.stack.len() - 1];
            self.before_end();
            match frame.block {
                // What stands behind it may not have been meant for it.
                Construct::Struct | Construct::Union => self.lose_declared(frame.opener),
                Construct::Repeat if !frame.has_else => {
                    self.insert(Tok::Until);
                    self.insert(Tok::Bad);
                }
                Construct::Case if !frame.has_of => self.insert(Tok::CaseOf),
                _ => {}
            }
            self.insert(frame.block.end());
            self.stack.pop();
            if frame.block.is_statement() || matches!(frame.block, Construct::Struct | Construct::Union) {
                self.insert(Tok::Semi);
            } else if self.stack.is_empty() {
                let item = std::mem::take(&mut self.out);
                self.items.push(item);
            }
        }
    }

    /// The names that are declared behind a token are not known any more.
    fn lose_declared(&mut self, opener: Token) {
        let from = self.out.iter().rposition(|t| t.start <= opener.start).unwrap_or(0);
        for pair in self.out[from..].windows(2) {
            if pair[0].kind == Tok::Id && pair[1].kind == Tok::Colon {
                self.report.lose(pair[0].text(self.text));
            }
        }
    }

    /// One message for all constructs from `from` on: they lack their END words at one place.
    fn report_unclosed(&mut self, from: usize, t: Token) {
        let open: Vec<Frame> = self.stack[from..].iter().rev().copied().collect();
        let Some(frame) = open.first() else { return };
        let mut ends: Vec<&str> = open.iter().take(MAX_LISTED).map(|f| f.block.end().describe()).collect();
        if open.len() > MAX_LISTED {
            ends.push("...");
        }
        let (ends, are) = (ends.join(", "), if ends.len() > 1 { "are" } else { "is" });
        if let Some((behind, opener)) = frame.else_if.or(frame.behind_else.map(|e| (e, frame.opener))) {
            self.report.push(
                self.report
                    .at(codes::ELSE_IF, behind.start, opener.end, "ELSE IF opens a second IF, which is not closed")
                    .also(self.report.span(t.start, t.end), format!("{ends} {are} missing before this"))
                    .help("write `ELSIF` for a further condition of the same IF"),
            );
            return;
        }
        let (opener, ended) = match frame.suspect {
            Some((opener, end)) => (opener, end),
            None => (frame.opener, t),
        };
        let name = opener.text(self.text).to_ascii_uppercase();
        let there = if ended.is_inserted() {
            "the file ends here".to_string()
        } else if frame.suspect.is_some() {
            format!("by its indentation this `{}` belongs to an outer {name}", ended.text(self.text))
        } else {
            format!("`{}` stands here before {}", ended.text(self.text), frame.block.end().describe())
        };
        let mut message = self
            .report
            .at(codes::UNCLOSED_BLOCK, opener.start, opener.end, format!("{name} opened here is not closed"))
            .also(self.report.span(ended.start, ended.end), there);
        for outer in open.iter().take(MAX_LISTED).skip(1) {
            let name = outer.opener.text(self.text).to_ascii_uppercase();
            let span = self.report.span(outer.opener.start, outer.opener.end);
            message = message.also(span, format!("this {name} is not closed either"));
        }
        self.report.push(message.help(format!("{ends} {are} missing")));
    }

    /// A word alone as a statement, one letter away from the END word of an open construct.
    pub(super) fn misspelled_end(&mut self, t: Token) -> bool {
        let next = self.peek(1);
        let text = t.text(self.text);
        if !(next.first || matches!(next.kind, Tok::Semi | Tok::StartItem)) || !(5..20).contains(&text.len()) {
            return false;
        }
        let upper = text.to_ascii_uppercase();
        // A slip of the hand, or the END word cut short: END_CONFIG.
        let means = |end: &str| is_close(&upper, end) || upper.len() > 6 && end.starts_with(&upper);
        let open = self.stack.iter().rev().map(|f| f.block).find(|b| means(b.end().describe()));
        let Some(block) = open else { return false };
        let meant = block.end().describe();
        self.report.push(
            self.report
                .at(codes::MISSPELLED, t.start, t.end, format!("`{text}` is no END word"))
                .help(format!("did you mean `{meant}`?")),
        );
        self.end_word(block, 1);
        true
    }

    /// END words in two parts (`END-IF`, `END IF`) or without underline (`ENDIF`): reported and taken for what they mean.
    pub(super) fn split_end(&mut self) -> bool {
        let t = self.peek(0);
        let text = t.text(self.text);
        if !text.get(..3).is_some_and(|t| t.eq_ignore_ascii_case("END")) {
            return false;
        }
        let (length, block) = if text.len() == 3 {
            let dash = self.peek(1).kind == Tok::Minus && self.peek(1).start == t.end;
            let word = self.peek(if dash { 2 } else { 1 });
            let near = if dash { word.start == self.peek(1).end } else { !word.first };
            (if dash { 3 } else { 2 }, opened_by(word.text(self.text)).filter(|_| near))
        } else {
            let next = self.peek(1);
            let alone = next.first || matches!(next.kind, Tok::Semi);
            (1, opened_by(&text[3..]).filter(|_| alone && (t.first || self.at_statement())))
        };
        let Some(block) = block else { return false };
        let end = self.peek(length - 1).end;
        let (written, right) = (&self.text[t.start as usize..end as usize], block.end().describe());
        self.report.push(
            self.report
                .at(codes::SPLIT_END, t.start, end, format!("`{written}` is not an END word"))
                .help(format!("write `{right}`")),
        );
        self.end_word(block, length);
        true
    }
}

/// The construct that a word opens.
fn opened_by(word: &str) -> Option<Construct> {
    if word.len() < 2 || word.len() > 14 || !word.is_ascii() {
        return None;
    }
    let closing = word_kind(&format!("END_{word}"));
    Construct::closed_by(closing)
}
