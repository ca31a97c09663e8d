//! Statements in braces and the head of FOR, as C writes them. `{ ... }` is a pragma here: what stands in it is not read, so
//! the construct around it has neither statements nor its words. One message says so, and the construct is closed.

use super::{Blocks, Construct};
use crate::token::{Tok, Token};
use plcc_diag::codes;

impl Blocks<'_, '_> {
    /// Braces with statements come next, where IF, WHILE or FOR expects THEN or DO, or behind the ELSE of such an IF.
    pub(super) fn braces(&mut self) -> bool {
        let Some((start, end)) = self.code_here() else { return false };
        let Some(frame) = self.stack.last().copied() else { return false };
        let word = match frame.block {
            Construct::If => Tok::Then,
            Construct::While | Construct::For => Tok::Do,
            _ => return false,
        };
        use Tok::*;
        let parts = |t: &&Token| matches!(t.kind, If | Elsif | While | For | Then | Do | Else | Semi);
        match self.out.iter().rfind(parts).map(|t| t.kind) {
            Some(If | Elsif | While | For) if self.peek(0).kind != word && self.last() != frame.opener.kind => {
                if !frame.braced {
                    self.tell_braces(start, end, frame.block);
                }
                self.insert(word);
            }
            Some(Else) if self.last() == Else && frame.braced => {}
            _ => return false,
        }
        self.pragmas_read += 1;
        if let Some(frame) = self.stack.last_mut() {
            frame.braced = true;
        }
        self.behind_braces(frame.block);
        true
    }

    /// The first pragma between the last token and the next one, if it holds statements: its bytes.
    fn code_here(&mut self) -> Option<(u32, u32)> {
        let (from, to) = (self.previous_end(), self.peek(0).start);
        while self.pragmas.get(self.pragmas_read).is_some_and(|p| p.span.start < from) {
            self.pragmas_read += 1;
        }
        let pragma = self.pragmas.get(self.pragmas_read)?;
        (pragma.span.start < to && pragma.text.contains(';')).then_some((pragma.span.start, pragma.span.end))
    }

    fn tell_braces(&mut self, start: u32, end: u32, block: Construct) {
        let help = match block {
            Construct::If => "write the statements without braces: `IF ... THEN` before them, `END_IF;` behind them",
            Construct::While => {
                "write the statements without braces: `WHILE ... DO` before them, `END_WHILE;` behind them"
            }
            _ => "write the statements without braces: `FOR ... DO` before them, `END_FOR;` behind them",
        };
        let end = end.min(self.line_end(start));
        self.report.push(
            self.report.at(codes::UNEXPECTED, start, end, "braces hold no statements, they are a pragma").help(help),
        );
    }

    /// Where the line with byte `at` ends.
    fn line_end(&self, at: u32) -> u32 {
        let rest = &self.text[at as usize..];
        at + rest.find(['\r', '\n']).unwrap_or(rest.len()) as u32
    }

    /// What follows braces: a further branch, the END word, or something that has nothing to do with the construct.
    fn behind_braces(&mut self, block: Construct) {
        let next = self.peek(0);
        if block == Construct::If && next.kind == Tok::Else && self.peek(1).kind == Tok::If {
            self.at += 2;
            let end = self.previous_end();
            return self.emit(Token { kind: Tok::Elsif, end, ..next });
        }
        if block == Construct::If && matches!(next.kind, Tok::Else | Tok::Elsif) || next.kind == block.end() {
            return;
        }
        if !self.has_its_end(block) {
            self.close_here(block);
        }
    }

    /// Whether all open constructs of this kind have their END words further on.
    fn has_its_end(&mut self, block: Construct) -> bool {
        if self.looks == 0 {
            return false;
        }
        self.looks -= 1;
        let open = self.stack.iter().rev().take_while(|f| f.block.is_statement()).filter(|f| f.block == block).count();
        let next = self.peek(0).kind;
        next == block.end() || self.closers_ahead(block, open + usize::from(Construct::statement(next) == Some(block)))
    }

    fn close_here(&mut self, block: Construct) {
        self.insert(block.end());
        self.stack.pop();
        self.insert(Tok::Semi);
    }

    /// `FOR (i := 0; i < 10; i++)`: reported, and read as a FOR whose bounds are not known.
    pub(super) fn head_of_c(&mut self) -> bool {
        if self.peek(0).kind != Tok::For || self.peek(1).kind != Tok::LParen {
            return false;
        }
        let Some(length) = self.head_length() else { return false };
        let (variable, open, close) = (self.peek(2), self.peek(1), self.peek(length - 1));
        let end = close.end.min(self.line_end(open.start));
        self.report.push(
            self.report
                .at(codes::UNEXPECTED, open.start, end, "this is the head of a loop in C")
                .help("write the first and the last value: `FOR i := 0 TO 9 DO`"),
        );
        self.open(Construct::For, Tok::For);
        if self.top() != Some(Construct::For) {
            return true;
        }
        let assigned = variable.kind == Tok::Id && matches!(self.peek(2).kind, Tok::Assign | Tok::Eq);
        self.emit(if assigned { variable } else { Token { kind: Tok::Bad, ..open } });
        self.at += length - 1;
        for kind in [Tok::Assign, Tok::Bad, Tok::To, Tok::Bad] {
            self.insert(kind);
        }
        if let Some(frame) = self.stack.last_mut() {
            frame.braced = true;
        }
        // Without braces and DO the one statement behind it is meant.
        if self.peek(0).kind != Tok::Do && self.code_here().is_none() {
            self.insert(Tok::Do);
            if !self.has_its_end(Construct::For) {
                self.close_here(Construct::For);
            }
        }
        true
    }

    /// The tokens from FOR to the `)` of its head, if there are two `;` in it.
    fn head_length(&self) -> Option<usize> {
        let (mut depth, mut parts) = (0, 0);
        for ahead in 1.. {
            match self.peek(ahead).kind {
                Tok::LParen => depth += 1,
                Tok::RParen => depth -= 1,
                Tok::Semi => parts += 1,
                Tok::StartItem => return None,
                kind if Construct::statement(kind).is_some() || Construct::closed_by(kind).is_some() => return None,
                _ => {}
            }
            if depth == 0 || parts > 2 {
                return (parts == 2).then_some(ahead + 1);
            }
        }
        None
    }
}
