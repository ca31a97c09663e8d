//! The statement, declaration or condition around a token, and how it is given up.

use super::{Recovery, Refused};
use crate::token::{Tok, Token};
use std::ops::Range;

/// What kind of list a token stands in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Surroundings {
    /// VAR, STRUCT, UNION, TYPE.
    Declarations,
    /// A body in ST, or the associations of a step.
    Statements,
    Il,
    Transition,
    Resource,
    Other,
}

/// Whether statements and declarations end before or behind a token of this kind.
pub(super) fn is_boundary(kind: Tok) -> bool {
    use Tok::*;
    matches!(
        kind,
        Semi | Then
            | Elsif
            | Else
            | If
            | Case
            | CaseOf
            | For
            | Do
            | While
            | Repeat
            | Until
            | Eol
            | Qualifier
            | Var
            | VarConfig
            | VarAccess
            | Struct
            | Union
            | Type
            | BodySt
            | BodyIl
            | BodySfc
            | StartItem
            | StartExpr
            | StartBody
            | StartType
            | StartInit
            | Step
            | Transition
            | Action
    ) || is_end(kind)
}

pub(super) fn is_end(kind: Tok) -> bool {
    use Tok::*;
    matches!(
        kind,
        EndIf
            | EndCase
            | EndFor
            | EndWhile
            | EndRepeat
            | EndProgram
            | EndFunction
            | EndFunctionBlock
            | EndType
            | EndStruct
            | EndUnion
            | EndVar
            | EndStep
            | EndTransition
            | EndAction
            | EndConfiguration
            | EndResource
    )
}

impl Recovery<'_, '_> {
    /// The tokens around `at` between two boundaries.
    pub(super) fn segment(&self, at: usize) -> Range<usize> {
        let before = self.tokens[..at.min(self.tokens.len())].iter().rposition(|t| is_boundary(t.kind));
        let start = before.map_or(0, |b| b + 1);
        let rest = self.tokens.get(at..).unwrap_or(&[]);
        let end = rest.iter().position(|t| is_boundary(t.kind)).map_or(self.tokens.len(), |n| at + n);
        start..end
    }

    /// What identifies a statement: its first byte that was written.
    pub(super) fn place(&self, start: usize) -> u32 {
        self.bytes(start).0
    }

    pub(super) fn surroundings(&self, at: usize) -> Surroundings {
        for t in self.tokens[..at.min(self.tokens.len())].iter().rev() {
            match t.kind {
                Tok::Var | Tok::VarConfig | Tok::VarAccess | Tok::Struct | Tok::Union | Tok::Type => {
                    return Surroundings::Declarations;
                }
                Tok::BodySt | Tok::Step => return Surroundings::Statements,
                Tok::BodyIl => return Surroundings::Il,
                Tok::Transition => return Surroundings::Transition,
                Tok::Resource | Tok::Configuration | Tok::EndResource => return Surroundings::Resource,
                Tok::EndStep | Tok::EndTransition | Tok::BodySfc | Tok::EndAction => return Surroundings::Other,
                _ => {}
            }
        }
        Surroundings::Other
    }

    /// Puts `Bad` in place of the statement or declaration around the refused token.
    pub(super) fn give_up(&mut self, refused: &Refused, segment: &Range<usize>) -> bool {
        let boundary = self.kind(segment.end);
        let before = self.kind(segment.start.wrapping_sub(1));
        if segment.is_empty() {
            return self.drop_boundary(segment.end);
        }
        let only_bad = self.tokens[segment.clone()].iter().all(|t| t.kind == Tok::Bad);
        match self.surroundings(segment.start) {
            Surroundings::Declarations => {
                if only_bad {
                    return self.drop_boundary(segment.end);
                }
                // The names stay known if the mistake lies behind them.
                let colon = self.tokens[segment.clone()].iter().position(|t| t.kind == Tok::Colon);
                let from = match colon {
                    Some(n) if segment.start + n < refused.at => segment.start + n + 1,
                    _ => segment.start,
                };
                self.lose(segment.clone());
                self.replace(from..segment.end, boundary != Tok::Semi);
            }
            Surroundings::Il => {
                let kinds: Vec<Tok> = self.tokens[segment.clone()].iter().take(4).map(|t| t.kind).collect();
                let kept = match kinds.as_slice() {
                    [Tok::IlLabel, Tok::Colon, Tok::IlDefer, Tok::LParen] => 4,
                    [Tok::IlLabel, Tok::Colon, ..] | [Tok::IlDefer, Tok::LParen, ..] => 2,
                    _ => 0,
                };
                if only_bad || segment.len() <= kept {
                    return self.drop_boundary(segment.end);
                }
                self.replace(segment.start + kept..segment.end, false);
            }
            Surroundings::Transition => {
                let opener = self.tokens[..segment.start].iter().rposition(|t| t.kind == Tok::Transition);
                let end = self.tokens[segment.end..].iter().position(|t| t.kind == Tok::EndTransition);
                let (Some(opener), Some(end)) = (opener, end) else { return false };
                if only_bad {
                    return false;
                }
                self.replace(opener + 1..segment.end + end, true);
            }
            Surroundings::Statements if before == Tok::Step => {
                let end = self.tokens[segment.end..].iter().position(|t| t.kind == Tok::EndStep);
                let Some(end) = end else { return false };
                self.replace(segment.start - 1..segment.end + end + 1, true);
            }
            Surroundings::Statements if only_bad => return self.drop_boundary(segment.end),
            Surroundings::Statements => {
                let condition = matches!(boundary, Tok::Then | Tok::Do | Tok::CaseOf) || before == Tok::Until;
                self.replace(segment.clone(), boundary != Tok::Semi && !condition);
            }
            Surroundings::Resource if only_bad => return self.drop_boundary(segment.end),
            Surroundings::Resource => self.replace(segment.clone(), boundary != Tok::Semi),
            Surroundings::Other => {
                if matches!(before, Tok::StartItem | Tok::StartExpr | Tok::StartType | Tok::StartInit) || only_bad {
                    return false;
                }
                self.replace(segment.clone(), boundary != Tok::Semi);
            }
        }
        true
    }

    /// Names in tokens that are given up are not known any more.
    pub(super) fn lose(&mut self, range: Range<usize>) {
        for t in &self.tokens[range] {
            if t.kind == Tok::Id {
                self.report.lose(t.text(self.text));
            }
        }
    }

    /// A mend at `at` that is only a guess: what it makes of the segment, up to the end of its line, is not judged.
    pub(super) fn doubt(&mut self, at: usize, segment: &Range<usize>) {
        let guess = match self.kind(at) {
            Tok::RParen | Tok::RBracket | Tok::Comma | Tok::Bad => true,
            // In the middle of a line something else may be missing.
            Tok::Semi | Tok::Colon => {
                self.tokens.get(at + 1).is_some_and(|t| !t.first && !t.is_inserted() && !is_boundary(t.kind))
            }
            _ => false,
        };
        if !guess {
            return;
        }
        // The mend may have made the segment longer by a token.
        let end = (segment.end + 1).min(self.tokens.len());
        let line = self.tokens[at..end].iter().skip(1).position(|t| t.first).map_or(end, |n| at + 1 + n);
        let (start, _) = self.bytes(segment.start);
        let (_, last) = self.bytes(line.saturating_sub(1));
        self.report.doubt(start, last.max(start));
        if self.surroundings(segment.start) == Surroundings::Declarations {
            self.lose(segment.start..line);
        }
    }

    /// One `Bad` (and a `;`) for many tokens.
    fn replace(&mut self, range: Range<usize>, semicolon: bool) {
        let (start, end) = match (self.tokens.get(range.start), self.tokens.get(range.end.wrapping_sub(1))) {
            (Some(a), Some(b)) if range.start < range.end => (a.start, b.end.max(a.start)),
            _ => {
                let at = self.bytes(range.start).0;
                (at, at)
            }
        };
        let bad = Token { kind: Tok::Bad, first: false, start, end };
        let semi = semicolon.then(|| Token::inserted(Tok::Semi, end));
        self.tokens.splice(range, std::iter::once(bad).chain(semi));
    }

    /// A word between statements does not fit: it is left out, unless the structure of the item hangs on it.
    fn drop_boundary(&mut self, at: usize) -> bool {
        let kind = self.kind(at);
        let structural = is_end(kind)
            || matches!(
                kind,
                Tok::If | Tok::Case | Tok::For | Tok::While | Tok::Repeat | Tok::Struct | Tok::Union | Tok::StartItem
            );
        if structural || at >= self.tokens.len() {
            return false;
        }
        self.tokens.remove(at);
        true
    }
}
