//! What a message says: classes of expectation, never a list of tokens.

use super::segment::Surroundings;
use super::{Recovery, Refused};
use crate::token::{Tok, word_kind};
use plcc_diag::{Diagnostic, codes};

impl Recovery<'_, '_> {
    /// "expected ..., found ...".
    pub(super) fn unexpected(&self, refused: &Refused) -> Diagnostic {
        let (start, end) = self.bytes(refused.at);
        let found = self.found(refused.at);
        let before = self.kind(refused.at.wrapping_sub(1));
        let nameless = refused.wants("name") && refused.expected.len() == 1;
        let message = match expectation(refused) {
            _ if nameless && !matches!(before, Tok::Comma | Tok::Dot) => {
                format!("a name is missing behind {}", before.describe())
            }
            Some(expected) => format!("expected {expected}, found {found}"),
            None => format!("{found} cannot stand here"),
        };
        let mut diagnostic = self.report.at(codes::UNEXPECTED, start, end, message);
        if let Some(help) = self.habit(refused.at) {
            return diagnostic.help(help);
        }
        let segment = self.segment(refused.at);
        let before = &self.tokens[segment.start.min(refused.at)..refused.at];
        let initial = before.iter().any(|t| t.kind == Tok::Assign);
        let next_declares = self.kind(refused.at + 2) == Tok::Colon && before.iter().any(|t| t.kind == Tok::Colon);
        let declares = self.surroundings(refused.at) == Surroundings::Declarations;
        if self.kind(refused.at) == Tok::Comma && declares && (initial || next_declares) {
            diagnostic = diagnostic.help(if initial {
                "components are initialised by name, `(x := 1, y := 2)`, arrays in brackets, `[1, 2]`"
            } else {
                "a declaration ends with `;`"
            });
        } else if self.kind(refused.at) == Tok::Comma && declares {
            diagnostic = diagnostic.help("the values of an enumeration stand in parentheses: `(Red, Green)`");
        }
        let t = self.tokens.get(refused.at);
        let word = t.map_or("", |t| t.text(self.text));
        if !word.is_empty() && word_kind(word).is_reserved() && refused.wants("name") && !refused.wants("IF") {
            diagnostic = diagnostic.help(format!("`{word}` is a reserved word and cannot be a name"));
        }
        diagnostic
    }

    /// What to write for a form of other languages that ends at `at`.
    fn habit(&self, at: usize) -> Option<String> {
        let (t, before) = (*self.tokens.get(at)?, *self.tokens.get(at.checked_sub(1)?)?);
        let text = before.text(self.text);
        match (before.kind, t.kind) {
            (Tok::Int, Tok::Comma) if self.list_in_parens(at) => Some(
                "the elements of an array stand in brackets: `[1, 2]`; components have names: `(x := 1, y := 2)`"
                    .into(),
            ),
            (Tok::Int, Tok::Comma) if before.end == t.start && self.bytes(at + 1).0 == t.end => {
                let fraction = self.tokens.get(at + 1).filter(|t| t.kind == Tok::Int)?.text(self.text);
                Some(format!("the sign of a fraction is the point: `{text}.{fraction}`"))
            }
            (_, Tok::Assign) if self.in_condition(at) => Some("`:=` assigns; two values are compared with `=`".into()),
            (_, Tok::Assign) if self.surroundings(at) == Surroundings::Statements => {
                Some("one statement assigns to one variable; write several".into())
            }
            (_, Tok::Comma) if self.in_condition(at) => Some("conditions are joined with AND or OR".into()),
            (Tok::Caret, Tok::Int | Tok::Lit | Tok::Id | Tok::LParen) => {
                Some("`^` follows a reference; a power is written `x ** y`".into())
            }
            (Tok::Id, Tok::Id)
                if self.kind(at.wrapping_sub(2)) == Tok::For && t.text(self.text).eq_ignore_ascii_case("IN") =>
            {
                Some(format!("write `FOR {text} := first TO last DO`"))
            }
            (Tok::Id, Tok::Semi) if self.kind(self.segment(at).start) == Tok::Program => {
                Some("an instance has a name of its own: `PROGRAM P1 WITH Fast : Main;`".into())
            }
            (Tok::DotDot, Tok::Dot) => Some("`..` has two points".into()),
            (Tok::Int, Tok::Dot) => Some(format!("a point is followed by digits: `{text}.0`")),
            (_, Tok::Dot) if self.kind(at + 1) == Tok::Int && self.bytes(at + 1).0 == t.end => {
                let fraction = self.tokens[at + 1].text(self.text);
                Some(format!("digits stand before the point, too: `0.{fraction}`"))
            }
            (_, Tok::Not) => Some("NOT stands before its operand: `NOT x`".into()),
            (_, Tok::Id) if t.text(self.text).eq_ignore_ascii_case("DIV") => {
                Some("the quotient of integers is `x / y`, without fraction; the remainder `x MOD y`".into())
            }
            (Tok::Id, Tok::Id | Tok::Int | Tok::Lit) if !t.first && self.behind_assign(at) => {
                Some(format!("an operator is missing, or the parentheses of a call: `{text}(...)`"))
            }
            (Tok::Colon, Tok::LBracket) if self.surroundings(at) == Surroundings::Declarations => Some(
                "values of an enumeration stand in parentheses, `(Red, Green)`; arrays are `ARRAY [0..4] OF INT`"
                    .into(),
            ),
            (Tok::RBracket, Tok::LBracket) if self.surroundings(at) == Surroundings::Declarations => {
                Some("all dimensions stand in one pair of brackets: `ARRAY [1..3, 0..1] OF INT`".into())
            }
            (Tok::Array, _) => Some("an array is written `ARRAY [0..4] OF INT`".into()),
            (_, Tok::RBracket | Tok::To | Tok::DotDot) if self.surroundings(at) == Surroundings::Declarations => {
                self.bounds_habit(at)
            }
            (Tok::Address, Tok::Comma) => Some("the parts of an address are separated by `.`: `%QX0.1`".into()),
            (Tok::Id, Tok::LBracket) if self.surroundings(at) == Surroundings::Declarations => {
                Some(format!("an array is declared `{text} : ARRAY [0..4] OF INT`"))
            }
            _ => None,
        }
    }

    /// What to write for bounds that end at `at` and are none: `ARRAY [5]`, `INT [0..9]`, `INT (0 TO 9)`.
    fn bounds_habit(&self, at: usize) -> Option<String> {
        let open = self.opener(at)?;
        let before = self.tokens.get(open.checked_sub(1)?)?;
        let word = before.text(self.text);
        match self.kind(open) {
            _ if before.kind == Tok::Array => Some("an array is written `ARRAY [0..4] OF INT`".into()),
            Tok::LBracket if before.kind == Tok::Id && crate::blocks::is_close(&word.to_ascii_uppercase(), "ARRAY") => {
                Some("did you mean `ARRAY`?".into())
            }
            _ if before.kind == Tok::Id => Some(format!("a subrange is written `{word} (0..100)`")),
            _ => None,
        }
    }

    /// Whether `at` stands in a parenthesis behind the `:=` of a declaration.
    fn list_in_parens(&self, at: usize) -> bool {
        let open = self.opener(at).filter(|open| self.kind(*open) == Tok::LParen);
        open.is_some_and(|open| self.kind(open.wrapping_sub(1)) == Tok::Assign)
            && self.surroundings(at) == Surroundings::Declarations
    }

    /// Whether `at` stands behind the `:=` of a statement.
    fn behind_assign(&self, at: usize) -> bool {
        let start = self.segment(at).start.min(at);
        self.surroundings(at) == Surroundings::Statements
            && self.tokens[start..at].iter().any(|t| t.kind == Tok::Assign)
    }

    /// Whether `at` stands in a condition: behind IF, ELSIF, WHILE or UNTIL, outside of any parenthesis.
    fn in_condition(&self, at: usize) -> bool {
        let start = self.segment(at).start;
        let opener = self.kind(start.wrapping_sub(1));
        let depth = self.tokens[start.min(at)..at].iter().fold(0i32, |n, t| match t.kind {
            Tok::LParen | Tok::LBracket => n + 1,
            Tok::RParen | Tok::RBracket => n - 1,
            _ => n,
        });
        matches!(opener, Tok::If | Tok::Elsif | Tok::While | Tok::Until) && depth == 0
    }

    /// The token `at` as a message names it.
    pub(super) fn found(&self, at: usize) -> String {
        match self.tokens.get(at) {
            None => "the end".into(),
            Some(t) if t.kind == Tok::Bad => t.kind.describe().into(),
            Some(t) if t.is_inserted() => match self.tokens[at..].iter().find(|t| !t.is_inserted()) {
                Some(t) => format!("`{}`", crate::blocks::shorten(t.text(self.text))),
                None => "the end".into(),
            },
            Some(t) => format!("`{}`", crate::blocks::shorten(t.text(self.text))),
        }
    }
}

/// What the grammar would accept, in the words of IEC.
fn expectation(refused: &Refused) -> Option<String> {
    if refused.wants("IF") {
        return Some("a statement".into());
    }
    if refused.wants_type() {
        return Some("a type".into());
    }
    let mut parts: Vec<String> = Vec::new();
    if refused.wants("int") {
        parts.push("an expression".into());
    } else if refused.wants("name") {
        parts.push("a name".into());
    } else if refused.wants("operator") {
        parts.push("an operator".into());
    }
    for word in ["STEP", "THEN", "DO", "TO", "UNTIL", "FROM"] {
        if refused.wants(word) {
            parts.push(word.into());
        }
    }
    if refused.wants("CASE OF") || refused.wants("OF") {
        parts.push("OF".into());
    }
    if refused.wants("end of line") {
        parts.push("the end of the line".into());
    }
    for sign in [":=", ";", ":", ")", "]", ",", ".."] {
        if parts.len() < 3 && refused.wants(sign) {
            parts.push(format!("`{sign}`"));
        }
    }
    if parts.is_empty() {
        let ends = refused.expected.iter().map(|e| e.trim_matches('"')).find(|e| e.starts_with("END_"));
        parts.extend(ends.map(String::from));
    }
    let last = parts.pop()?;
    Some(if parts.is_empty() { last } else { format!("{} or {last}", parts.join(", ")) })
}
