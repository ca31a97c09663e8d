//! Instruction List: how a body is recognised, and its lines, which end where the text's lines do.

use super::{Blocks, Construct};
use crate::il_operators;
use crate::token::{Tok, Token};
use plcc_diag::codes;

/// How far the end of an argument list is looked for.
const MAX_LOOK: usize = 5000;

fn is_operator(word: &str) -> bool {
    il_operators::find(word).is_some()
}

fn is_call(word: &str) -> bool {
    il_operators::find(word).is_some_and(|o| matches!(o.meaning, il_operators::Meaning::Call(_)))
}

impl Blocks<'_, '_> {
    /// Whether the body that begins here is in Instruction List.
    pub(super) fn il_here(&self) -> bool {
        let mut i = 0;
        while self.peek(i).kind == Tok::Id && self.peek(i + 1).kind == Tok::Colon && i < MAX_LOOK {
            i += 2;
        }
        self.il_line_at(i)
    }

    /// Whether the token `i` ahead begins an instruction and not a statement.
    fn il_line_at(&self, i: usize) -> bool {
        let (word, next) = (self.peek(i), self.peek(i + 1));
        if !matches!(word.kind, Tok::Id | Tok::Op | Tok::Not) {
            return false;
        }
        let operator = is_operator(word.text(self.text)) || word.kind == Tok::Op;
        let alone = next.first || Construct::closed_by(next.kind).is_some();
        match next.kind {
            // A function without operands: the next line tells.
            _ if alone => operator || word.kind == Tok::Id && self.operator_at(i + 1),
            Tok::LParen => {
                let Some(end) = self.closing_paren(i + 1) else { return false };
                let after = self.peek(end + 1);
                let ends = after.first || Construct::closed_by(after.kind).is_some();
                ends && (operator || self.operator_at(end + 1))
            }
            Tok::Id | Tok::Int | Tok::Lit | Tok::Qualified | Tok::Address | Tok::Minus | Tok::Bad => {
                let mut end = i + 1;
                while !self.peek(end).first && Construct::closed_by(self.peek(end).kind).is_none() && end < MAX_LOOK {
                    if matches!(self.peek(end).kind, Tok::Semi | Tok::Assign) {
                        // `LD a;` is no statement either; JMP is one of ST, too.
                        if self.peek(end).kind == Tok::Semi {
                            return operator && end == i + 2 && !self.is(i, "JMP");
                        }
                        // `CAL t(IN := x)` has its `:=` in parentheses.
                        return is_call(word.text(self.text));
                    }
                    end += 1;
                }
                next.kind != Tok::Minus && operator || self.operator_at(end)
            }
            _ => false,
        }
    }

    fn operator_at(&self, i: usize) -> bool {
        let (t, next) = (self.peek(i), self.peek(i + 1));
        matches!(t.kind, Tok::Id | Tok::Op | Tok::Not)
            && is_operator(t.text(self.text))
            && !matches!(next.kind, Tok::Assign | Tok::Arrow | Tok::Dot | Tok::LBracket | Tok::Semi)
            // `NOT Q => x` in a list of parameters.
            && !(t.kind == Tok::Not && self.peek(i + 2).kind == Tok::Arrow)
    }

    /// Where the parenthesis that opens `i` ahead closes.
    fn closing_paren(&self, i: usize) -> Option<usize> {
        let mut depth = 0;
        for j in i..i + MAX_LOOK {
            match self.peek(j).kind {
                Tok::LParen => depth += 1,
                Tok::RParen => {
                    depth -= 1;
                    if depth == 0 {
                        return Some(j);
                    }
                }
                Tok::Semi | Tok::StartItem => return None,
                _ => {}
            }
        }
        None
    }

    /// One line of IL, up to the end of the line.
    pub(super) fn il_line(&mut self) {
        if self.action_here() {
            return self.statement_token();
        }
        if self.peek(0).kind == Tok::Id && self.peek(1).kind == Tok::Colon {
            self.take(Tok::IlLabel);
            self.take(Tok::Colon);
            if self.line_ends() {
                return self.insert(Tok::Eol);
            }
        }
        let (mut deferred, mut closes) = (false, false);
        if matches!(self.peek(0).kind, Tok::Id | Tok::Op | Tok::Not) {
            deferred = self.il_operator();
        } else {
            // `)` closes a deferred operation. Anything else is taken so that the grammar has something to report.
            let kind = self.peek(0).kind;
            closes = kind == Tok::RParen;
            self.take(kind);
        }
        if deferred {
            let kind = self.peek(0).kind;
            self.take(kind);
        }
        let mut depth = 0u32;
        while self.at < self.tokens.len() {
            let t = self.peek(0);
            if Construct::closed_by(t.kind).is_some() || self.item_here().is_some() {
                break;
            }
            if t.first && (depth == 0 || self.operator_at(0)) {
                break;
            }
            match t.kind {
                Tok::Semi if depth == 0 && self.peek(1).first => {
                    self.semicolon(t);
                    continue;
                }
                Tok::LParen => depth += 1,
                // `OR r )`: closes the parenthesis in which this line stands.
                Tok::RParen if depth == 0 && !deferred && !closes => break,
                Tok::RParen => depth = depth.saturating_sub(1),
                _ => {}
            }
            self.take(t.kind);
        }
        self.insert(Tok::Eol);
    }

    /// A `;` behind an instruction: left out.
    fn semicolon(&mut self, t: Token) {
        self.at += 1;
        if !std::mem::replace(&mut self.told_semicolon, true) {
            self.report.push(
                self.report
                    .at(codes::UNEXPECTED, t.start, t.end, "an instruction of IL ends with its line, not with `;`")
                    .help("remove the `;` here and behind the other instructions"),
            );
        }
    }

    fn line_ends(&self) -> bool {
        let t = self.peek(0);
        t.first || Construct::closed_by(t.kind).is_some()
    }

    /// Emits the first word of an instruction; whether it opens a deferred operation with the `(` that follows.
    fn il_operator(&mut self) -> bool {
        let t = self.peek(0);
        let next = self.peek(1);
        let text = t.text(self.text);
        let mut length = 1;
        let mut end = t.end;
        if text == "&" && self.is(1, "N") && next.start == t.end {
            length = 2;
            end = next.end;
        }
        let word = &self.text[t.start as usize..end as usize];
        let open = self.peek(length).kind == Tok::LParen && !self.peek(length).first;
        // `ADD(IN1 := a, IN2 := b)`: an operator's name is also that of a function.
        let formal = open && self.peek(length + 1).kind == Tok::Id && self.peek(length + 2).kind == Tok::Assign;
        let kind = match open {
            true if formal => Tok::IlFunction,
            true if il_operators::find(word).is_some_and(|o| o.is_deferred()) => Tok::IlDefer,
            true if !is_operator(word) => Tok::IlFunction,
            _ => Tok::IlOp,
        };
        self.at += length;
        self.emit(Token { kind, end, ..t });
        kind == Tok::IlDefer
    }
}
