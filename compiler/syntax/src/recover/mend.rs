//! The mends that keep a statement: what is missing is inserted, what is plainly meant otherwise is replaced.

use super::segment::{Surroundings, is_boundary, is_end};
use super::{Recovery, Refused};
use crate::blocks::is_close;
use crate::token::{Tok, Token};
use plcc_diag::{Code, Diagnostic, codes};
use std::ops::Range;

/// A call has no more tokens in its parentheses: each is looked at where one of its signs is wrong.
const MOST_ARGUMENT_TOKENS: usize = 500;

impl Recovery<'_, '_> {
    /// Mends the place if the cause is plain; the message says what it was.
    pub(super) fn insert_missing(&mut self, refused: &Refused, segment: &Range<usize>) -> Option<Diagnostic> {
        self.wrong_sign(refused)
            .or_else(|| self.doubled(refused))
            .or_else(|| self.foreign_sign(refused, segment))
            .or_else(|| self.value_on_next_line(refused, segment))
            .or_else(|| self.reserved_word(refused))
            .or_else(|| self.branch_word(refused, segment))
            .or_else(|| self.block_word(refused, segment))
            .or_else(|| self.nameless(refused, segment))
            .or_else(|| self.type_on_next_line(refused, segment))
            .or_else(|| self.case_label(refused, segment))
            .or_else(|| self.colon(refused, segment))
            .or_else(|| self.operand(refused))
            .or_else(|| self.closing(refused, segment))
            .or_else(|| self.too_much(refused))
            .or_else(|| self.opening(refused, segment))
            .or_else(|| self.semicolon(refused))
    }

    fn missing(&self, code: Code, at: usize, message: impl Into<String>) -> Diagnostic {
        let end = self.end_before(at);
        self.report.at(code, end, end, message)
    }

    /// Where the token before `at` ends.
    fn end_before(&self, at: usize) -> u32 {
        at.checked_sub(1).and_then(|i| self.tokens.get(i)).map_or(0, |t| t.end)
    }

    fn insert(&mut self, at: usize, kind: Tok) {
        let end = self.end_before(at);
        self.tokens.insert(at, Token::inserted(kind, end));
    }

    fn begins_line(&self, at: usize) -> bool {
        self.tokens.get(at).is_none_or(|t| t.first || t.is_inserted())
    }

    /// `=` for `:=`, `=>` for `>=`, a second `:=`.
    fn wrong_sign(&mut self, refused: &Refused) -> Option<Diagnostic> {
        let at = refused.at;
        let (start, end) = self.bytes(at);
        match self.kind(at) {
            Tok::To if refused.wants(":=") => {
                let first = self.tokens[..at].iter().rposition(|t| t.kind == Tok::For)? + 1;
                let eq = first + self.tokens[first..at].iter().position(|t| t.kind == Tok::Eq)?;
                self.tokens[eq].kind = Tok::Assign;
                let (start, end) = self.bytes(eq);
                let message = self.report.at(codes::EQUALS_FOR_ASSIGN, start, end, "`=` compares, it does not assign");
                Some(message.help("write `:=`"))
            }
            Tok::Eq if refused.wants(":=") => {
                self.tokens[at].kind = Tok::Assign;
                let message = self.report.at(codes::EQUALS_FOR_ASSIGN, start, end, "`=` compares, it does not assign");
                Some(message.help("write `:=`"))
            }
            Tok::Arrow if refused.wants("relation") => {
                self.tokens[at].kind = Tok::Rel;
                let message =
                    self.report.at(codes::FOREIGN_OPERATOR, start, end, "`=>` connects an output, it does not compare");
                Some(message.help("greater or equal is written `>=`"))
            }
            Tok::Assign
                if self.kind(at.wrapping_sub(1)) == Tok::Colon && !self.lacks_type(at) && !self.begins_line(at) =>
            {
                let colon = self.tokens.remove(at - 1);
                let message = self.report.at(codes::SPLIT_ASSIGN, colon.start, end, "one `:` too many before `:=`");
                Some(message.help("write `:=`"))
            }
            Tok::Colon if self.kind(at + 1) == Tok::Assign && !self.begins_line(at + 1) => {
                let (_, end) = self.bytes(at + 1);
                self.tokens.remove(at);
                let message = self.report.at(codes::SPLIT_ASSIGN, start, end, "one `:` too many before `:=`");
                Some(message.help("write `:=`"))
            }
            Tok::Assign if self.kind(at.wrapping_sub(1)) == Tok::Assign => {
                self.tokens.remove(at);
                let message = self.report.at(codes::UNEXPECTED, start, end, "`:=` stands twice");
                Some(message.help("remove one"))
            }
            _ => None,
        }
    }

    /// `ELSE:`, `ARRAY [1:5]`, `ARRAY [5]`, `AT QX0.1`: what other languages write.
    fn foreign_sign(&mut self, refused: &Refused, segment: &Range<usize>) -> Option<Diagnostic> {
        let at = refused.at;
        let t = *self.tokens.get(at)?;
        let before = self.kind(at.wrapping_sub(1));
        let returns = at == segment.start + 1 && before == Tok::Id && !t.first && refused.wants(";") && {
            self.tokens[at - 1].text(self.text).eq_ignore_ascii_case("RETURN")
        };
        match t.kind {
            kind if returns && (is_operand_start(kind) || kind == Tok::LParen) => {
                let end = self.bytes(segment.end - 1).1;
                self.tokens.drain(at..segment.end);
                let message = self.report.at(codes::UNEXPECTED, t.start, end, "RETURN takes no value");
                Some(message.help("a function gives its value by its name: `Name := value; RETURN;`"))
            }
            Tok::Colon if refused.wants(":=") && self.opener(at).is_some() && before == Tok::Id => {
                self.tokens[at].kind = Tok::Assign;
                let message = self.report.at(codes::UNEXPECTED, t.start, t.end, "`:` gives no value");
                Some(message.help("write `:=`"))
            }
            Tok::Colon if before == Tok::Else => {
                self.tokens.remove(at);
                let message = self.report.at(codes::UNEXPECTED, t.start, t.end, "no `:` stands behind ELSE");
                Some(message.help("remove it"))
            }
            Tok::Colon if refused.wants("..") && !refused.wants(":") => {
                self.tokens[at].kind = Tok::DotDot;
                let message = self.report.at(codes::UNEXPECTED, t.start, t.end, "bounds are not separated by `:`");
                Some(message.help("write `..`: `ARRAY [1..5] OF INT`"))
            }
            Tok::RBracket if refused.wants("..") && before == Tok::Int => {
                let count = self.tokens[at - 1];
                let text = count.text(self.text);
                self.insert(at, Tok::DotDot);
                self.tokens.insert(at + 1, count);
                let message = self.report.at(
                    codes::UNEXPECTED,
                    count.start,
                    count.end,
                    "an array has a lower and an upper bound",
                );
                let last = text.parse::<u64>().ok().and_then(|n| n.checked_sub(1));
                let bounds = last.map_or(String::new(), |last| format!("`[0..{last}]` or "));
                Some(message.help(format!("write {bounds}`[1..{text}]`")))
            }
            Tok::Id if t.text(self.text).eq_ignore_ascii_case("AT") && refused.wants(":") => {
                let colon = self.tokens[at..segment.end].iter().position(|t| t.kind == Tok::Colon)? + at;
                let (start, end) = (self.bytes(at + 1).0, self.bytes(colon - 1).1);
                if colon == at + 1 || self.surroundings(at) != Surroundings::Declarations {
                    return None;
                }
                let text = &self.text[start as usize..end as usize];
                let message = self.report.at(codes::BAD_ADDRESS, start, end, format!("`{text}` is no address"));
                self.tokens.drain(at..colon);
                Some(message.help("an address begins with `%`: `AT %QX0.1`"))
            }
            _ => None,
        }
    }

    /// Whether the `:` before the token `at` is that of a declaration, and its type is missing.
    fn lacks_type(&self, at: usize) -> bool {
        let start = self.segment(at).start;
        let colons = self.tokens[start.min(at)..at].iter().filter(|t| t.kind == Tok::Colon).count();
        self.surroundings(at) == Surroundings::Declarations && colons == 1
    }

    /// A word or sign that is written twice on a line.
    fn doubled(&mut self, refused: &Refused) -> Option<Diagnostic> {
        use Tok::*;
        let at = refused.at;
        let (t, before) = (*self.tokens.get(at)?, *self.tokens.get(at.checked_sub(1)?)?);
        let kind =
            matches!(t.kind, Id | Int | Lit | Qualified | Colon | CaseOf | Of | To | By | Then | Do | Until | At);
        let text = t.text(self.text);
        // `value value + 1` lacks its `:=`, `counter Counter` its `:`.
        if t.kind == Id && !matches!(self.kind(at + 1), Assign | Colon | Comma | LParen | RParen | RBracket) {
            return None;
        }
        if !kind || t.first || t.is_inserted() || !text.eq_ignore_ascii_case(before.text(self.text)) {
            return None;
        }
        self.tokens.remove(at);
        let message = self.report.at(codes::UNEXPECTED, t.start, t.end, format!("`{text}` stands twice"));
        Some(message.help("remove one of them"))
    }

    /// `x :=` at the end of a line and `y := 1;` on the next: the value of x is missing, not the `;`.
    fn value_on_next_line(&mut self, refused: &Refused, segment: &Range<usize>) -> Option<Diagnostic> {
        if self.kind(refused.at) != Tok::Assign || self.surroundings(refused.at) != Surroundings::Statements {
            return None;
        }
        let line = self.tokens[segment.start..refused.at].iter().rposition(|t| t.first)? + segment.start;
        let before = self.kind(line.checked_sub(1).filter(|i| *i > segment.start)?);
        if !is_operator(before) {
            return None;
        }
        let message = self.missing(codes::MISSING_OPERAND, line, "an expression is missing here");
        self.insert(line, Tok::Bad);
        self.insert(line + 1, Tok::Semi);
        Some(message.help("this line ends before its expression does"))
    }

    /// A reserved word used like a variable.
    fn reserved_word(&mut self, refused: &Refused) -> Option<Diagnostic> {
        use Tok::*;
        let t = *self.tokens.get(refused.at)?;
        let word = matches!(t.kind, Type | Program | Function | FunctionBlock | Array | Struct | Union | Var);
        if !word || !refused.wants("name") || self.surroundings(refused.at) == Surroundings::Declarations {
            return None;
        }
        self.tokens[refused.at].kind = Tok::Id;
        let text = t.text(self.text);
        let message = self.report.at(codes::RESERVED_WORD, t.start, t.end, format!("`{text}` is a reserved word"));
        Some(message.help("choose another name"))
    }

    /// A second ELSE, ELSIF behind ELSE, REPEAT without UNTIL.
    fn branch_word(&mut self, refused: &Refused, segment: &Range<usize>) -> Option<Diagnostic> {
        let at = refused.at;
        let (start, end) = self.bytes(at);
        match self.kind(at) {
            Tok::Else | Tok::Elsif if !refused.wants(";") || refused.wants("IF") => {
                let word = self.kind(at).describe();
                let stop = if self.kind(at) == Tok::Elsif {
                    let then = self.tokens[at..].iter().position(|t| t.kind == Tok::Then)?;
                    at + then
                } else {
                    at
                };
                self.tokens.drain(at..=stop);
                let message =
                    self.report.at(codes::UNEXPECTED, start, end, format!("{word} does not belong to an open IF here"));
                Some(message.help("an IF has any number of ELSIF and then at most one ELSE"))
            }
            // An expression alone before END_REPEAT was meant as the condition.
            Tok::EndRepeat if refused.wants(";") && segment.start < at => {
                if self.tokens[segment.start..at].iter().any(|t| t.kind == Tok::Assign) {
                    return None;
                }
                let (start, end) = self.bytes(segment.start);
                self.tokens.insert(segment.start, Token::inserted(Tok::Until, start));
                let message = self.report.at(codes::MISSING_WORD, start, end, "UNTIL is missing before this condition");
                Some(message.help("write `UNTIL condition END_REPEAT`"))
            }
            Tok::EndRepeat if refused.wants("UNTIL") => {
                let message = self.report.at(codes::MISSING_WORD, start, end, "UNTIL is missing in this REPEAT");
                self.insert(at, Tok::Until);
                self.insert(at + 1, Tok::Bad);
                Some(message.help("write `UNTIL condition END_REPEAT`"))
            }
            _ => None,
        }
    }

    /// THEN, DO, OF.
    fn block_word(&mut self, refused: &Refused, segment: &Range<usize>) -> Option<Diagnostic> {
        let at = refused.at;
        let (kind, of) =
            [("THEN", Tok::Then, "IF or ELSIF"), ("DO", Tok::Do, "FOR or WHILE"), ("CASE OF", Tok::CaseOf, "CASE")]
                .into_iter()
                .find_map(|(name, kind, of)| refused.wants(name).then_some((kind, of)))?;
        let word = kind.describe();
        let (start, end) = self.bytes(at);
        let help = format!("write `{word}`");
        if matches!(self.kind(at), Tok::Then | Tok::Do | Tok::Of | Tok::CaseOf) {
            let message = format!("{of} needs {word} here, not `{}`", self.tokens[at].text(self.text));
            self.tokens[at].kind = kind;
            return Some(self.report.at(codes::MISSING_WORD, start, end, message).help(help));
        }
        if self.misspelled(at, word) {
            self.tokens[at].kind = kind;
            return Some(self.no_such_word(at, word));
        }
        if self.kind(at) == Tok::Colon && self.begins_line(at + 1) {
            self.tokens[at].kind = kind;
            let message = self.report.at(codes::MISSING_WORD, start, end, format!("{of} needs {word} here, not `:`"));
            return Some(message.help(help));
        }
        if self.kind(at) == Tok::Semi && self.kind(at + 1) == kind {
            self.tokens.remove(at);
            let message = self.report.at(codes::UNEXPECTED, start, end, format!("`;` does not belong before {word}"));
            return Some(message.help("remove it"));
        }
        // When the word does follow on this line, something before it is wrong.
        let follows = self.kind(segment.end) == kind;
        if follows && !self.tokens[at..=segment.end].iter().any(|t| t.first) {
            return None;
        }
        let message = self.missing(codes::MISSING_WORD, at, format!("{word} is missing behind this")).help(help);
        self.insert(at, kind);
        Some(message)
    }

    /// Whether the token `at` is one letter away from `word` and begins no statement.
    fn misspelled(&self, at: usize, word: &str) -> bool {
        let Some(t) = self.tokens.get(at).filter(|t| t.kind == Tok::Id) else { return false };
        if matches!(self.kind(at + 1), Tok::Assign | Tok::Dot | Tok::LBracket | Tok::LParen | Tok::Caret) {
            return false;
        }
        let upper = t.text(self.text).to_ascii_uppercase();
        is_close(&upper, word) || word.len() == 2 && upper.chars().rev().eq(word.chars())
    }

    fn no_such_word(&self, at: usize, meant: &str) -> Diagnostic {
        let t = self.tokens[at];
        let message = format!("{meant} is expected here, not `{}`", t.text(self.text));
        self.report.at(codes::MISSPELLED, t.start, t.end, message).help(format!("did you mean `{meant}`?"))
    }

    /// A declaration that begins with its `:`.
    fn nameless(&mut self, refused: &Refused, segment: &Range<usize>) -> Option<Diagnostic> {
        let at = refused.at;
        let declares = self.surroundings(at) == Surroundings::Declarations && at == segment.start;
        if !declares || self.kind(at) != Tok::Colon || segment.is_empty() {
            return None;
        }
        let (start, end) = self.bytes(at);
        let message = self.report.at(codes::UNEXPECTED, start, end, "a name is missing before `:`");
        self.report.lose_unnamed();
        self.insert(at, Tok::Id);
        Some(message.help("a declaration is written `name : type;`"))
    }

    /// `Mode : (Idle, Run)` without `;` before `Motor : STRUCT`: the next name was read as part of the type.
    fn type_on_next_line(&mut self, refused: &Refused, segment: &Range<usize>) -> Option<Diagnostic> {
        let at = refused.at;
        let name = at.checked_sub(1).filter(|i| *i > segment.start)?;
        let declares = self.surroundings(at) == Surroundings::Declarations;
        let colon_before = self.tokens[segment.start..name].iter().any(|t| t.kind == Tok::Colon);
        let begins = self.kind(name) == Tok::Id && self.tokens[name].first;
        if !(declares && colon_before && begins && matches!(self.kind(at), Tok::Colon | Tok::Comma)) {
            return None;
        }
        let message = self.missing(codes::MISSING_SEMICOLON, name, "`;` expected after this declaration");
        self.insert(name, Tok::Semi);
        Some(message.help("write `;`"))
    }

    /// The `:` behind the values of a CASE branch: they stand alone on their line.
    fn case_label(&mut self, refused: &Refused, segment: &Range<usize>) -> Option<Diagnostic> {
        let at = refused.at;
        let values = self.tokens.get(segment.start..at).filter(|v| !v.is_empty())?;
        let plain = |k| matches!(k, Tok::Id | Tok::Int | Tok::Lit | Tok::Qualified | Tok::DotDot | Tok::Comma);
        let alone = self.begins_line(segment.start) && self.begins_line(at) && values.iter().all(|t| plain(t.kind));
        if !alone || !refused.wants(":") || !self.in_case(segment.start) {
            return None;
        }
        let message = self.missing(codes::MISSING_WORD, at, "`:` is missing behind this CASE label");
        self.insert(at, Tok::Colon);
        Some(message.help("write `:`"))
    }

    /// Whether the innermost open statement around `at` is a CASE.
    fn in_case(&self, at: usize) -> bool {
        let mut depth = 0usize;
        for t in self.tokens[..at.min(self.tokens.len())].iter().rev() {
            match t.kind {
                Tok::EndIf | Tok::EndFor | Tok::EndWhile | Tok::EndRepeat | Tok::EndCase => depth += 1,
                Tok::BodySt => return false,
                Tok::If | Tok::For | Tok::While | Tok::Repeat | Tok::Case if depth > 0 => depth -= 1,
                Tok::Case => return true,
                Tok::If | Tok::For | Tok::While | Tok::Repeat => return false,
                _ => {}
            }
        }
        false
    }

    /// `:` and the type in a declaration, `:` behind a label or the name of a step.
    fn colon(&mut self, refused: &Refused, segment: &Range<usize>) -> Option<Diagnostic> {
        let at = refused.at;
        let kind = self.kind(at);
        if refused.wants_type() && (is_boundary(kind) || matches!(kind, Tok::Assign | Tok::Comma | Tok::RParen)) {
            let message = self.missing(codes::MISSING_OPERAND, at, "a type is missing here");
            let gap = self.text.get(self.end_before(at) as usize..self.bytes(at).0 as usize);
            let braces = gap.filter(|gap| gap.contains('{'));
            // The values that were meant are not known.
            let words = braces.unwrap_or("").split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'));
            words.filter(|word| !word.is_empty()).for_each(|word| self.report.lose(word));
            self.insert(at, Tok::Bad);
            return Some(message.help(match braces {
                Some(_) => "braces hold pragmas; the values of an enumeration stand in parentheses: `(Red, Green)`",
                None => "write for example `: INT`",
            }));
        }
        if refused.wants("OF") && matches!(kind, Tok::Id | Tok::Array | Tok::RefWord | Tok::LParen | Tok::Struct) {
            let message = self.missing(codes::MISSING_WORD, at, "OF is missing before the type of the elements");
            self.insert(at, Tok::Of);
            return Some(message.help("an array is written `ARRAY [1..3] OF INT`"));
        }
        let has_to = self.tokens[segment.clone()].iter().any(|t| t.kind == Tok::To);
        let word = self.tokens.get(at).map_or("", |t| t.text(self.text));
        if kind == Tok::Id && refused.wants("TO") && word.eq_ignore_ascii_case("DOWNTO") {
            let (start, end) = self.bytes(at);
            self.tokens[at].kind = Tok::To;
            let message = self.report.at(codes::UNEXPECTED, start, end, "FOR has no DOWNTO");
            return Some(message.help("write `FOR i := 10 TO 1 BY -1 DO`"));
        }
        if kind == Tok::Id && refused.wants("BY") && word.eq_ignore_ascii_case("STEP") {
            let (start, end) = self.bytes(at);
            self.tokens[at].kind = Tok::By;
            let message = self.report.at(codes::MISSPELLED, start, end, "the step of a FOR stands behind BY");
            return Some(message.help("write `BY`"));
        }
        if refused.wants("TO") && !has_to && (is_operand_start(kind) || kind == Tok::LParen) {
            let message = self.missing(codes::MISSING_WORD, at, "TO is missing here");
            self.insert(at, Tok::To);
            return Some(message.help("write `TO`"));
        }
        if !refused.wants(":") {
            return None;
        }
        let declaration = self.surroundings(at) == Surroundings::Declarations;
        let first = self.kind(segment.start);
        match kind {
            Tok::Semi | Tok::Assign if declaration => {
                let name = self.tokens[segment.start].text(self.text).to_string();
                let message = self.missing(codes::MISSING_OPERAND, at, format!("the type of `{name}` is missing"));
                self.insert(at, Tok::Colon);
                self.insert(at + 1, Tok::Bad);
                Some(message.help(format!("write for example `{name} : INT`")))
            }
            Tok::Id | Tok::Array | Tok::RefWord | Tok::Struct | Tok::Union | Tok::LParen if declaration => {
                let message = self.missing(codes::MISSING_WORD, at, "`:` is missing before the type");
                self.insert(at, Tok::Colon);
                Some(message.help("a declaration is written `name : type;`"))
            }
            Tok::Id if !refused.wants(";") || matches!(first, Tok::Int | Tok::Lit | Tok::Qualified) => {
                let message = self.missing(codes::MISSING_WORD, at, "`:` is missing here");
                self.insert(at, Tok::Colon);
                Some(message)
            }
            _ => None,
        }
    }

    /// An expression.
    fn operand(&mut self, refused: &Refused) -> Option<Diagnostic> {
        use Tok::*;
        let at = refused.at;
        let kind = self.kind(at);
        let nothing = is_boundary(kind)
            || matches!(kind, RParen | RBracket | Comma | Rel | Op | Eq | Star | DotDot | To | By)
            || at >= self.tokens.len();
        if !refused.wants_operand() || !nothing {
            return None;
        }
        let value = matches!(kind, Comma | RParen) && self.in_enumeration(at);
        if value {
            self.report.lose_unnamed();
        }
        let message = match (self.kind(at.wrapping_sub(1)), kind) {
            _ if value => "a value of the enumeration is missing here".to_string(),
            (_, Then) | (While, Do) => "a condition is missing here".to_string(),
            (before, _) if is_operator(before) => {
                let sign = self.tokens[at - 1].text(self.text);
                format!("an expression is missing behind `{sign}`")
            }
            _ => "an expression is missing here".to_string(),
        };
        let message = self.missing(codes::MISSING_OPERAND, at, message);
        let braces = self.text.get(self.end_before(at) as usize..self.bytes(at).0 as usize);
        let step = match braces {
            Some(gap) if gap.contains('{') => Some(
                "braces hold pragmas; values of components stand in `(x := 1, y := 2)`, of arrays in `[1, 2]`".into(),
            ),
            _ => self.step_habit(at),
        };
        self.insert(at, Bad);
        if let Some(help) = step {
            return Some(message.help(help));
        }
        Some(message.help(if value {
            "write a name, or remove a `,`"
        } else {
            "write a literal, a variable or a call there"
        }))
    }

    /// What to write for `i++` and `i += 1`, whose second sign is the one at or before `at`.
    fn step_habit(&self, at: usize) -> Option<String> {
        let arrow = self.tokens.get(at).is_some_and(|t| t.text(self.text) == ">");
        if arrow && self.kind(at.wrapping_sub(1)) == Tok::Minus && self.bytes(at).0 == self.end_before(at) {
            return Some("a component is written with a point: `m.speed`, behind a reference `p^.speed`".into());
        }
        let signs = |k| matches!(k, Tok::Plus | Tok::Minus | Tok::Star | Tok::Op);
        let [name, first, second] =
            if self.kind(at) == Tok::Eq { [2, 1, 0] } else { [3, 2, 1] }.map(|n| at.checked_sub(n));
        let [name, first, second] = [name?, first?, second?].map(|n| self.tokens.get(n).copied());
        let (name, first, second) = (name?, first?, second?);
        let pair = first.kind == second.kind && matches!(first.kind, Tok::Plus | Tok::Minus) || second.kind == Tok::Eq;
        if name.kind != Tok::Id || !signs(first.kind) || !pair || first.end != second.start {
            return None;
        }
        let (name, sign) = (name.text(self.text), first.text(self.text));
        Some(format!("write `{name} := {name} {sign} {}`", if second.kind == Tok::Eq { "..." } else { "1" }))
    }

    /// Whether `at` stands between the values of an enumeration: in the parenthesis behind the `:` of a declaration.
    fn in_enumeration(&self, at: usize) -> bool {
        let open = self.opener(at).filter(|open| self.kind(*open) == Tok::LParen);
        open.is_some_and(|open| self.kind(open.wrapping_sub(1)) == Tok::Colon)
            && self.surroundings(at) == Surroundings::Declarations
    }

    /// `)`, `]`, and the `,` between two arguments.
    fn closing(&mut self, refused: &Refused, segment: &Range<usize>) -> Option<Diagnostic> {
        let at = refused.at;
        let kind = self.kind(at);
        let (close, sign) = match (refused.wants(")"), refused.wants("]")) {
            (true, _) => (Tok::RParen, ")"),
            (_, true) => (Tok::RBracket, "]"),
            _ => return None,
        };
        if kind == Tok::Semi && refused.wants(",") && self.semicolons_in_call(at) {
            let (start, end) = self.bytes(at);
            let message = self.report.at(codes::UNEXPECTED, start, end, "`;` does not separate arguments");
            return Some(message.help("write `,`"));
        }
        let closes_later = self.closes_later(at..segment.end);
        if refused.wants(",") && closes_later && is_operand_start(kind) {
            let message = self.missing(codes::MISSING_WORD, at, "`,` is missing here");
            self.insert(at, Tok::Comma);
            return Some(message.help("arguments and elements are separated by `,`"));
        }
        let ends = is_boundary(kind)
            || self.begins_line(at)
            || matches!(kind, Tok::RBracket | Tok::RParen | Tok::Assign | Tok::DotDot | Tok::To | Tok::By | Tok::Of);
        if !ends || closes_later && kind != Tok::RBracket && kind != Tok::RParen {
            return None;
        }
        let mut message = self.missing(codes::MISSING_WORD, at, format!("`{sign}` is missing here"));
        if let Some(open) = self.opener(at) {
            let t = self.tokens[open];
            message = message.also(self.report.span(t.start, t.end), "opened here");
            let matching = if t.kind == Tok::LParen { Tok::RParen } else { Tok::RBracket };
            if matching != close {
                return None;
            }
        }
        if matches!(kind, Tok::RBracket | Tok::RParen) {
            // A closing sign of the other kind: taken for the right one if that one does not follow.
            self.tokens[at].kind = close;
        } else {
            self.insert(at, close);
            if self.kind(at.wrapping_sub(1)) == Tok::Eol {
                self.insert(at + 1, Tok::Eol);
            }
        }
        Some(message.help(format!("write `{sign}`")))
    }

    /// Whether the call whose parenthesis is open at the `;` at `at` goes on behind it: then `,` is meant by this `;` and
    /// those that follow.
    fn semicolons_in_call(&mut self, at: usize) -> bool {
        let call = |k| matches!(k, Tok::Id | Tok::Caret | Tok::RBracket);
        if self.surroundings(at) != Surroundings::Statements
            || self.opener(at).is_none_or(|open| open == 0 || !call(self.kind(open - 1)))
        {
            return false;
        }
        let mut depth = 0;
        let mut signs = vec![at];
        for (n, t) in self.tokens.iter().enumerate().skip(at + 1).take(MOST_ARGUMENT_TOKENS) {
            match t.kind {
                Tok::LParen => depth += 1,
                Tok::RParen if depth == 0 => {
                    for sign in signs {
                        self.tokens[sign].kind = Tok::Comma;
                    }
                    return true;
                }
                Tok::RParen => depth -= 1,
                Tok::Semi if depth == 0 => signs.push(n),
                kind if is_boundary(kind) => return false,
                _ => {}
            }
        }
        false
    }

    /// Whether more parentheses close than open in `range`.
    fn closes_later(&self, range: Range<usize>) -> bool {
        let mut depth = 0i32;
        for t in &self.tokens[range.start.min(range.end)..range.end] {
            match t.kind {
                Tok::LParen | Tok::LBracket => depth += 1,
                Tok::RParen | Tok::RBracket => depth -= 1,
                _ => {}
            }
            if depth < 0 {
                return true;
            }
        }
        false
    }

    /// The parenthesis or bracket that is open before `at`.
    pub(super) fn opener(&self, at: usize) -> Option<usize> {
        let mut depth = 0;
        for (i, t) in self.tokens[..at.min(self.tokens.len())].iter().enumerate().rev() {
            match t.kind {
                Tok::RParen | Tok::RBracket => depth += 1,
                Tok::LParen | Tok::LBracket if depth == 0 => return Some(i),
                Tok::LParen | Tok::LBracket => depth -= 1,
                Tok::Semi => return None,
                _ => {}
            }
        }
        None
    }

    /// A `)` or `]` that nothing opens.
    fn too_much(&mut self, refused: &Refused) -> Option<Diagnostic> {
        let at = refused.at;
        if !matches!(self.kind(at), Tok::RParen | Tok::RBracket) || self.opener(at).is_some() {
            return None;
        }
        let t = self.tokens.remove(at);
        let message = format!("`{}` closes nothing", t.text(self.text));
        Some(self.report.at(codes::UNEXPECTED, t.start, t.end, message).help("remove it, or write what opens it"))
    }

    /// The `(` of a call: `edge CLK := pulse);`.
    fn opening(&mut self, refused: &Refused, segment: &Range<usize>) -> Option<Diagnostic> {
        let at = refused.at;
        let call = self.kind(at) == Tok::Id && !self.tokens[at].first && self.kind(at.wrapping_sub(1)) == Tok::Id;
        if !call || self.surroundings(at) != Surroundings::Statements || !self.closes_later(at..segment.end) {
            return None;
        }
        let name = self.tokens[at - 1].text(self.text);
        let message = self.missing(codes::MISSING_WORD, at, format!("`(` is missing behind `{name}`"));
        self.insert(at, Tok::LParen);
        Some(message.help("write `(`"))
    }

    /// The `;` behind a statement or declaration.
    fn semicolon(&mut self, refused: &Refused) -> Option<Diagnostic> {
        let at = refused.at;
        if !refused.wants(";") {
            return None;
        }
        let kind = self.kind(at);
        let next = self.kind(at + 1);
        // `ESLE` on a line of its own looks like a statement without `;`.
        if at > 0 && self.segment(at).start == at - 1 && self.misspelled(at - 1, "ELSE") {
            self.tokens[at - 1].kind = Tok::Else;
            return Some(self.no_such_word(at - 1, "ELSE"));
        }
        let new_statement = kind == Tok::Id
            && matches!(next, Tok::Assign | Tok::LParen | Tok::Dot | Tok::LBracket | Tok::Colon | Tok::Caret);
        let declaration = matches!(self.surroundings(at), Surroundings::Declarations | Surroundings::Resource);
        let new_statement = new_statement && (!declaration || next == Tok::Colon);
        let ends = is_end(kind)
            || is_boundary(kind) && !matches!(kind, Tok::Then | Tok::Do | Tok::CaseOf | Tok::Qualifier)
            || kind == Tok::Jmp
            || self.begins_line(at) && !is_operator(kind)
            || new_statement;
        if !ends {
            return None;
        }
        let what = if declaration { "declaration" } else { "statement" };
        let message =
            self.missing(codes::MISSING_SEMICOLON, at, format!("`;` expected after this {what}")).help("write `;`");
        self.insert(at, Tok::Semi);
        Some(message)
    }
}

fn is_operator(kind: Tok) -> bool {
    use Tok::*;
    matches!(kind, Assign | Attempt | Bind | Eq | Plus | Minus | Star | Rel | Op | Not | Arrow)
}

fn is_operand_start(kind: Tok) -> bool {
    use Tok::*;
    matches!(kind, Id | Int | Lit | Qualified | Address | Not | Bad)
}
