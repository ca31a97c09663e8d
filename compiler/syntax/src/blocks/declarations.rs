//! Heads of POUs, sections of variables, types, resources: where their soft words and ends are.

use super::{Blocks, Construct, Phase, is_close};
use crate::token::{Tok, Token};
use plcc_diag::codes;

/// Words that may stand behind a section keyword.
const QUALIFIERS: &[&str] =
    &["CONSTANT", "RETAIN", "NON_RETAIN", "PERSISTENT", "PUBLIC", "PRIVATE", "PROTECTED", "INTERNAL"];

/// Words that open a section of variables.
const SECTIONS: &[&str] = &["VAR_INPUT", "VAR_OUTPUT", "VAR_IN_OUT", "VAR_EXTERNAL", "VAR_GLOBAL", "VAR_TEMP"];

/// The section of variables that a word in upper case names or means: misspelt, cut short, or in two words. A parenthesis
/// stands for a list of parameters.
pub(crate) fn section_meant(word: &str) -> Option<&'static str> {
    let word = word.split_ascii_whitespace().collect::<Vec<_>>().join("_");
    let alias = match word.as_str() {
        "VAR_IN" | "(" => Some("VAR_INPUT"),
        "VAR_OUT" => Some("VAR_OUTPUT"),
        "VAR_INOUT" => Some("VAR_IN_OUT"),
        _ => None,
    };
    let mut words = SECTIONS.iter().copied();
    alias.or_else(|| words.clone().find(|s| word == *s)).or_else(|| words.find(|s| is_close(&word, s)))
}

/// A list of parameters behind a name is not longer: each is looked for from its POU on.
const MOST_PARAMETER_TOKENS: usize = 1000;

impl Blocks<'_, '_> {
    /// What stands between the keyword of a POU and its first section.
    pub(super) fn pou_head(&mut self, block: Construct) {
        match self.peek(0) {
            t if t.kind == Tok::Id => self.take(Tok::Id),
            t if t.kind == Tok::Colon || t.first => self.missing_name(block),
            _ => return,
        }
        for word in ["EXTENDS", "IMPLEMENTS"] {
            let t = self.peek(0);
            if self.is(0, word) && self.peek(1).kind == Tok::Id {
                self.report.push(
                    self.report
                        .at(codes::NOT_SUPPORTED, t.start, t.end, format!("{word} is not supported"))
                        .help("plcc compiles IEC 61131-3 without object orientation"),
                );
                self.at += 2;
                while self.peek(0).kind == Tok::Comma && self.peek(1).kind == Tok::Id {
                    self.at += 2;
                }
            }
        }
        let parameters = self.parameters_behind_name();
        if block != Construct::Function && self.peek(0).kind == Tok::Colon && !self.peek(1).first {
            let (t, end) = (self.peek(0), self.peek(1).end);
            let word = self.stack.last().map_or("", |f| f.opener.kind.describe());
            if let Some(name) = self.out.last().filter(|t| t.kind == Tok::Id) {
                self.report.lose(name.text(self.text));
            }
            self.report.push(
                self.report
                    .at(codes::UNEXPECTED, t.start, end, format!("a {word} has no result type"))
                    .help("declare a VAR_OUTPUT, or make it a FUNCTION"),
            );
            self.at += 2;
        }
        if block == Construct::Function {
            let (t, next) = (self.peek(0), self.peek(1));
            let type_alone = t.kind == Tok::Id && !t.first && (next.first || next.kind == Tok::Var);
            if t.kind == Tok::Id && !t.first && next.kind == Tok::Colon {
                self.drop_word(t, format!("`{}` does not belong behind the name", t.text(self.text)));
            }
            if self.peek(0).kind == Tok::Colon {
                self.take(Tok::Colon);
                while self.peek(0).kind == Tok::Colon {
                    self.drop_word(self.peek(0), "`:` stands twice".into());
                }
                self.result_type();
            } else if type_alone {
                let name = t.text(self.text);
                self.report.push(
                    self.report
                        .at(codes::MISSING_WORD, t.start, t.start, "`:` is missing before the result type")
                        .help(format!("write `: {name}`")),
                );
                self.insert(Tok::Colon);
                self.result_type();
            } else if let Some(name) = self.resultless() {
                let at = self.previous_end();
                self.report.push(
                    self.report
                        .at(codes::MISSING_OPERAND, at, at, format!("the type of the result of `{name}` is missing"))
                        .help(format!("its body assigns one: write for example `FUNCTION {name} : INT`")),
                );
                self.insert(Tok::Colon);
                self.insert(Tok::Bad);
            }
        }
        self.junk_behind_name();
        if self.peek(0).kind == Tok::Semi {
            self.at += 1;
        }
        self.out.extend(parameters);
    }

    /// The name of the FUNCTION whose head ends here, if its body assigns to it.
    fn resultless(&mut self) -> Option<String> {
        let name = self.out.last().filter(|t| t.kind == Tok::Id)?.text(self.text);
        if self.looks == 0 {
            return None;
        }
        self.looks -= 1;
        let body =
            self.tokens[self.at..].iter().take_while(|t| !Construct::closed_by(t.kind).is_some_and(Construct::is_pou));
        let mut pairs = body.clone().zip(body.skip(1));
        let assigned = |(t, next): (&Token, &Token)| {
            t.kind == Tok::Id && next.kind == Tok::Assign && t.text(self.text).eq_ignore_ascii_case(name)
        };
        pairs.any(assigned).then(|| name.to_string())
    }

    /// `FUNCTION Add(a : INT, b : INT) : INT`: reported; the tokens of the VAR_INPUT that it means.
    fn parameters_behind_name(&mut self) -> Vec<Token> {
        let open = self.peek(0);
        if open.kind != Tok::LParen {
            return Vec::new();
        }
        let mut list = self.tokens[self.at..].iter().take(MOST_PARAMETER_TOKENS);
        let end = list.position(|t| t.kind == Tok::RParen || t.kind == Tok::Semi);
        let Some(close) = end.filter(|n| self.peek(*n).kind == Tok::RParen) else {
            return Vec::new();
        };
        let end = self.peek(close);
        self.report.push(
            self.report
                .at(codes::UNEXPECTED, open.start, end.end, "parameters do not stand behind the name")
                .help("declare them in a section: `VAR_INPUT a : INT; END_VAR`"),
        );
        let mut out = vec![Token { kind: Tok::Var, ..open }];
        let mut typed = false;
        for t in &self.tokens[self.at + 1..self.at + close] {
            typed |= t.kind == Tok::Colon;
            // `a, b : INT, c : REAL`: behind a type the `,` ends a declaration.
            let ends = typed && t.kind == Tok::Comma;
            typed &= !ends;
            out.push(Token { kind: if ends { Tok::Semi } else { t.kind }, ..*t });
        }
        if close > 1 {
            out.push(Token::inserted(Tok::Semi, end.start));
        }
        out.push(Token { kind: Tok::EndVar, ..end });
        self.at += close + 1;
        out
    }

    /// A POU without its name: reported, and declared without.
    fn missing_name(&mut self, block: Construct) {
        let at = self.previous_end();
        let word = self.last().describe();
        let example = if block == Construct::Program { "Main" } else { "Motor" };
        self.report.push(
            self.report
                .at(codes::UNEXPECTED, at, at, format!("a name is missing behind {word}"))
                .help(format!("write for example `{word} {example}`")),
        );
        self.report.lose_unnamed();
        self.insert(Tok::Id);
    }

    /// Leaves the next token out.
    fn drop_word(&mut self, t: Token, message: String) {
        self.report.push(self.report.at(codes::UNEXPECTED, t.start, t.end, message).help("remove it"));
        self.at += 1;
    }

    /// A further word on the line of a POU's name.
    fn junk_behind_name(&mut self) {
        let (t, next) = (self.peek(0), self.peek(1));
        if t.kind != Tok::Id || t.first || !(next.first || next.kind == Tok::Var) {
            return;
        }
        self.drop_word(t, format!("`{}` does not belong behind the name", t.text(self.text)));
    }

    /// Emits the tokens of one type, as far as the body could be mistaken for its continuation.
    fn result_type(&mut self) {
        loop {
            let t = self.peek(0);
            if self.reference_word() {
                continue;
            }
            match t.kind {
                Tok::Array => {
                    while !matches!(self.peek(0).kind, Tok::Of | Tok::Semi | Tok::Var | Tok::StartItem) {
                        let kind = self.peek(0).kind;
                        self.take(kind);
                    }
                    if self.peek(0).kind != Tok::Of {
                        return;
                    }
                    self.take(Tok::Of);
                }
                Tok::Id => {
                    self.take(Tok::Id);
                    let length = self.peek(0).kind;
                    if matches!(length, Tok::LBracket | Tok::LParen) && !self.peek(0).first {
                        while !matches!(
                            self.peek(0).kind,
                            Tok::RBracket | Tok::RParen | Tok::Semi | Tok::Var | Tok::StartItem
                        ) {
                            let kind = self.peek(0).kind;
                            self.take(kind);
                        }
                        if matches!(self.peek(0).kind, Tok::RBracket | Tok::RParen) {
                            let kind = self.peek(0).kind;
                            self.take(kind);
                        }
                    }
                    return;
                }
                _ => return,
            }
        }
    }

    /// `REF_TO`, `POINTER TO`, `REFERENCE TO` before a type: one token.
    fn reference_word(&mut self) -> bool {
        let t = self.peek(0);
        if t.kind != Tok::Id {
            return false;
        }
        let two_words = self.peek(1).kind == Tok::To && (self.is(0, "POINTER") || self.is(0, "REFERENCE"));
        if two_words {
            let end = self.peek(1).end;
            self.at += 2;
            self.emit(Token { kind: Tok::RefWord, end, ..t });
        } else if self.is(0, "REF_TO") && matches!(self.peek(1).kind, Tok::Id | Tok::Array | Tok::LParen | Tok::Struct)
        {
            self.take(Tok::RefWord);
        }
        self.last() == Tok::RefWord && self.at > 0 && self.tokens[self.at - 1].start >= t.start
    }

    /// Between the head of a POU or ACTION and its body.
    pub(super) fn head_token(&mut self) {
        let t = self.peek(0);
        match t.kind {
            Tok::Var | Tok::VarConfig | Tok::VarAccess if self.top() != Some(Construct::Action) => self.open_section(),
            Tok::Id if self.unsupported() => {}
            Tok::Id if self.misspelled_section(t) || self.headless_section(t) => {}
            _ => self.start_body(),
        }
    }

    /// A word one letter away from a section keyword, before something that looks like a declaration.
    fn misspelled_section(&mut self, t: Token) -> bool {
        let upper = t.text(self.text).to_ascii_uppercase();
        if let Some(qualifier) = upper.strip_prefix("VAR_").filter(|q| QUALIFIERS.contains(q) && t.first) {
            self.report.push(
                self.report
                    .at(codes::MISSPELLED, t.start, t.end, format!("`{upper}` is no section of variables"))
                    .help(format!("write `VAR {qualifier}`, two words")),
            );
            self.open(Construct::Var, Tok::Var);
            let at = t.end;
            let start = at - qualifier.len() as u32;
            self.emit(Token { kind: Tok::Qualifier, first: false, start, end: at });
            return true;
        }
        let declares = self.peek(1).kind == Tok::Id
            && (matches!(self.peek(2).kind, Tok::Colon | Tok::Comma) || self.peek(2).kind == Tok::Id);
        let text = t.text(self.text);
        if !declares || !t.first || text.len() > 13 {
            return false;
        }
        let upper = text.to_ascii_uppercase();
        if upper == "CONST" {
            self.report.push(
                self.report
                    .at(codes::MISSPELLED, t.start, t.end, format!("`{text}` is no section of variables"))
                    .help("write `VAR CONSTANT` before the constants and END_VAR behind them"),
            );
            self.open(Construct::Var, Tok::Var);
            self.emit(Token { kind: Tok::Qualifier, ..t });
            return true;
        }
        let Some(meant) = section_meant(&upper) else { return false };
        self.report.push(
            self.report
                .at(codes::MISSPELLED, t.start, t.end, format!("`{text}` is no section of variables"))
                .help(format!("did you mean `{meant}`?")),
        );
        self.open(Construct::Var, Tok::Var);
        true
    }

    /// Declarations up to an END_VAR whose VAR is missing.
    fn headless_section(&mut self, t: Token) -> bool {
        let qualifier = QUALIFIERS.iter().any(|q| self.is(0, q)) && self.peek(1).first;
        let declares =
            self.peek(1).kind == Tok::Colon && matches!(self.peek(2).kind, Tok::Id | Tok::Array | Tok::Struct);
        if !t.first || !(declares || qualifier) || self.looks == 0 {
            return false;
        }
        self.looks -= 1;
        let statement = |t: &Token| {
            matches!(t.kind, Tok::EndVar | Tok::Var)
                || Construct::statement(t.kind).is_some()
                || Construct::closed_by(t.kind).is_some_and(Construct::is_pou)
        };
        if self.tokens[self.at..].iter().find(|t| statement(t)).is_none_or(|t| t.kind != Tok::EndVar) {
            return false;
        }
        self.report.push(
            self.report
                .at(codes::MISSING_WORD, t.start, t.end, "VAR is missing before this declaration")
                .help("write VAR, VAR_INPUT, VAR_OUTPUT ... before the variables"),
        );
        // Which section it was is not known: nothing is said about uses of its names.
        let names = self.tokens[self.at..].iter().take_while(|t| t.kind != Tok::EndVar);
        names.filter(|t| t.kind == Tok::Id).for_each(|t| self.report.lose(t.text(self.text)));
        let inserted = Token::inserted(Tok::Var, t.start);
        self.stack.push(super::Frame::new(Construct::Var, inserted, None, None));
        self.emit(inserted);
        while QUALIFIERS.iter().any(|q| self.is(0, q)) && self.peek(1).kind != Tok::Colon {
            self.take(Tok::Qualifier);
        }
        true
    }

    /// Opens a section of variables.
    pub(super) fn open_section(&mut self) {
        let (t, next) = (self.peek(0), self.peek(1));
        let kind = t.kind;
        self.open(Construct::Var, kind);
        // `VAR INPUT a : INT;`
        let words = &self.text[t.start as usize..next.end as usize];
        let whole = words.split_ascii_whitespace().count() == 2 && next.kind == Tok::Id && !next.first;
        if let Some(meant) = section_meant(&words.to_ascii_uppercase()).filter(|_| whole)
            && self.peek(1).kind == Tok::Id
        {
            let message = format!("`{words}` is no section of variables");
            self.report.push(
                self.report
                    .at(codes::MISSPELLED, t.start, next.end, message)
                    .help(format!("write `{meant}`, one word")),
            );
            if let Some(var) = self.out.last_mut() {
                var.end = next.end;
            }
            self.at += 1;
        }
        while self.peek(0).kind == Tok::Id
            && QUALIFIERS.iter().any(|q| self.is(0, q))
            && !matches!(self.peek(1).kind, Tok::Colon | Tok::Comma | Tok::Dot)
            && !self.is(1, "AT")
        {
            self.take(Tok::Qualifier);
        }
        if self.is(0, "CONST") && self.peek(1).kind == Tok::Id {
            let t = self.peek(0);
            self.report.push(
                self.report
                    .at(codes::MISSPELLED, t.start, t.end, "constants are not declared with CONST")
                    .help("write `VAR CONSTANT`"),
            );
            self.take(Tok::Qualifier);
        }
    }

    /// Whether a declaration begins with the next token.
    fn at_declaration(&self) -> bool {
        use Tok::*;
        matches!(self.last(), Semi | Var | VarConfig | VarAccess | Qualifier | Struct | Union | Type)
    }

    /// A token of VAR, STRUCT, UNION or TYPE.
    pub(super) fn declaration_token(&mut self) {
        let t = self.peek(0);
        let start = self.at_declaration();
        let in_pou = self.top() == Some(Construct::Var) && self.stack.len() > 1;
        match t.kind {
            Tok::Struct if start && self.peek(1).kind == Tok::Id && self.peek(2).kind == Tok::Id => {
                return self.struct_before_name(t);
            }
            Tok::Struct => return self.open(Construct::Struct, Tok::Struct),
            Tok::Union => return self.open(Construct::Union, Tok::Union),
            Tok::Var | Tok::VarConfig | Tok::VarAccess if !self.names_something() => {
                // The next section begins before this one has ended.
                let var =
                    self.stack.iter().rposition(|f| matches!(f.block, Construct::Var | Construct::Type)).unwrap_or(0);
                return self.close_above(var, t);
            }
            Tok::Id if start && in_pou && self.body_begins() => return self.close_above(self.stack.len() - 1, t),
            Tok::Id if self.reference_word() => return,
            Tok::Id if self.headless_structure(t) => return,
            Tok::Semi if self.values_apart(t) => return,
            Tok::Id => {
                let kind = self.soft_word();
                return self.take(kind);
            }
            _ => {}
        }
        let in_list = self.top() == Some(Construct::Var) && self.last() == Tok::Comma && self.parens == 0;
        if self.names_something() && (start || in_list) {
            self.reserved_name(t);
            return self.take(Tok::Id);
        }
        if in_pou && Construct::statement(t.kind).is_some() {
            return self.close_above(self.stack.len() - 1, t);
        }
        self.take(t.kind);
    }

    /// `STRUCT Point x : INT;`, as C writes it, for `Point : STRUCT x : INT;`.
    fn struct_before_name(&mut self, t: Token) {
        let name = self.peek(1);
        let text = name.text(self.text);
        self.report.push(
            self.report
                .at(codes::UNEXPECTED, t.start, name.end, "the name of a structure stands before STRUCT")
                .help(format!("write `{text} : STRUCT`")),
        );
        self.emit(name);
        self.insert(Tok::Colon);
        self.open(Construct::Struct, Tok::Struct);
        self.at += 1;
    }

    /// `Point : x : INT; y : INT; END_STRUCT;`: reported, and STRUCT inserted.
    fn headless_structure(&mut self, t: Token) -> bool {
        let components = self.last() == Tok::Colon && t.first && self.peek(1).kind == Tok::Colon;
        if !components || self.top() != Some(Construct::Type) || self.looks == 0 {
            return false;
        }
        self.looks -= 1;
        let stop = |t: &&Token| Construct::closed_by(t.kind).is_some() || matches!(t.kind, Tok::Struct | Tok::Union);
        if self.tokens[self.at..].iter().find(stop).is_none_or(|t| t.kind != Tok::EndStruct) {
            return false;
        }
        let at = self.previous_end();
        self.report.push(
            self.report
                .at(codes::MISSING_WORD, at, at, "STRUCT is missing before these components")
                .help("write `name : STRUCT`"),
        );
        let inserted = Token::inserted(Tok::Struct, at);
        self.stack.push(super::Frame::new(Construct::Struct, inserted, None, None));
        self.emit(inserted);
        true
    }

    /// A `;` between the values of an enumeration: reported once, and read as `,`.
    fn values_apart(&mut self, t: Token) -> bool {
        let more = self.peek(1).kind == Tok::Id && matches!(self.peek(2).kind, Tok::Semi | Tok::Comma | Tok::RParen);
        if self.parens == 0 || !more {
            return false;
        }
        let mut list = self.out.iter().rev().take_while(|t| t.kind != Tok::LParen);
        if !list.any(|t| t.kind == Tok::Comma && t.text(self.text) == ";") {
            self.report.push(
                self.report
                    .at(codes::UNEXPECTED, t.start, t.end, "`;` does not separate the values of an enumeration")
                    .help("write `,`"),
            );
        }
        self.take(Tok::Comma);
        true
    }

    /// Whether the next token, a reserved word, stands where only a name can.
    fn names_something(&self) -> bool {
        self.peek(0).kind.is_reserved() && matches!(self.peek(1).kind, Tok::Colon | Tok::Comma)
    }

    /// A reserved word that stands for a name.
    pub(super) fn reserved_name(&mut self, t: Token) {
        let word = t.text(self.text);
        self.report.take_for_name(word);
        self.report.push(
            self.report
                .at(codes::RESERVED_WORD, t.start, t.end, format!("`{word}` is a reserved word"))
                .help("choose another name"),
        );
    }

    /// Whether the name where a declaration should begin belongs to a statement instead, END_VAR being forgotten.
    fn body_begins(&mut self) -> bool {
        let next = self.peek(1).kind;
        let statement = match next {
            Tok::Assign | Tok::LParen | Tok::LBracket | Tok::Caret => true,
            Tok::Dot => self.stack.last().is_some_and(|f| f.opener.kind == Tok::Var),
            _ => false,
        };
        if !statement {
            return false;
        }
        // An END_VAR further on shows that it is a faulty declaration.
        if self.next_end_var < self.at {
            let stop = |t: &Token| {
                matches!(t.kind, Tok::EndVar | Tok::Var) || Construct::closed_by(t.kind).is_some_and(Construct::is_pou)
            };
            self.next_end_var = self.tokens[self.at..].iter().position(stop).map_or(self.tokens.len(), |n| self.at + n);
        }
        self.tokens.get(self.next_end_var).is_none_or(|t| t.kind != Tok::EndVar)
    }

    /// The kind of the next token, a name, in a declaration.
    fn soft_word(&self) -> Tok {
        let next = self.peek(1).kind;
        if self.is(0, "AT") && matches!(next, Tok::Address | Tok::Bad) {
            return Tok::At;
        }
        if self.last() == Tok::Id && (self.is(0, "R_EDGE") || self.is(0, "F_EDGE")) {
            return Tok::Edge;
        }
        if matches!(self.last(), Tok::Id | Tok::RBracket | Tok::RParen)
            && (self.is(0, "READ_ONLY") || self.is(0, "READ_WRITE"))
        {
            return Tok::Access;
        }
        Tok::Id
    }

    /// A token of CONFIGURATION or RESOURCE.
    pub(super) fn resource_token(&mut self) {
        let t = self.peek(0);
        match t.kind {
            Tok::Var | Tok::VarConfig | Tok::VarAccess => return self.open_section(),
            Tok::Id => {}
            kind => return self.take(kind),
        }
        if t.first && self.misspelled_end(t) {
            return;
        }
        let name_follows = self.peek(1).kind == Tok::Id && !self.peek(1).first;
        let kind = match self.last() {
            Tok::Program if name_follows && QUALIFIERS.iter().any(|q| self.is(0, q)) && !self.is(1, "WITH") => {
                Tok::Qualifier
            }
            Tok::Id if self.is(0, "ON") && self.peek(1).kind == Tok::Id => Tok::On,
            Tok::Id | Tok::RBracket | Tok::RParen if self.is(0, "WITH") => Tok::With,
            Tok::Program | Tok::On | Tok::With | Tok::Task | Tok::Resource | Tok::Configuration => Tok::Id,
            _ if name_follows && self.is(0, "RESOURCE") => {
                if self.top() == Some(Construct::Resource) {
                    self.close_above(self.stack.len() - 1, t);
                }
                return self.open(Construct::Resource, Tok::Resource);
            }
            _ if name_follows && self.is(0, "TASK") => Tok::Task,
            _ => Tok::Id,
        };
        self.take(kind);
    }

    /// Whether the next tokens open an ACTION: two names side by side, which nothing else can be.
    pub(super) fn action_here(&self) -> bool {
        self.is(0, "ACTION") && self.peek(1).kind == Tok::Id && !self.peek(1).first
    }

    /// Opens an ACTION and reads its head.
    pub(super) fn open_action(&mut self) {
        self.open(Construct::Action, Tok::Action);
        self.take(Tok::Id);
        if self.peek(0).kind == Tok::Dot && self.peek(1).kind == Tok::Id {
            self.take(Tok::Dot);
            self.take(Tok::Id);
        }
        if self.peek(0).kind == Tok::Colon {
            self.take(Tok::Colon);
        } else {
            // Without a colon the name ends with its line.
            self.insert(Tok::Colon);
        }
        if let Some(frame) = self.stack.last_mut() {
            frame.phase = Phase::Head;
        }
    }
}
