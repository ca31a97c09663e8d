//! Bodies in ST and SFC: their constructs, and where they end.

use super::{Blocks, Construct, Phase, is_close};
use crate::token::{Tok, Token};
use plcc_diag::codes;

impl Blocks<'_, '_> {
    /// Classifies the body that begins here and puts its marker in front.
    pub(super) fn start_body(&mut self) {
        let (phase, marker) = if self.chart_here() {
            (Phase::Sfc, Tok::BodySfc)
        } else if self.il_here() {
            (Phase::Il, Tok::BodyIl)
        } else {
            (Phase::St, Tok::BodySt)
        };
        self.start_body_as(phase, marker);
    }

    /// Begins a body in a language that is known.
    pub(super) fn start_body_as(&mut self, phase: Phase, marker: Tok) {
        let start = self.peek(0).start;
        self.emit(Token::inserted(marker, start));
        if let Some(frame) = self.stack.last_mut() {
            frame.phase = phase;
        }
    }

    /// Whether a chart begins here, perhaps with its ACTIONs.
    fn chart_here(&self) -> bool {
        if self.step_here() || self.transition_here() {
            return true;
        }
        // Steps may come behind the ACTIONs of a POU, once per POU.
        if !self.action_here() || !self.top().is_some_and(Construct::is_pou) {
            return false;
        }
        let rest = self.tokens[self.at..].iter().enumerate();
        let body = rest.take_while(|(_, t)| {
            let opens = matches!(t.kind, Tok::Program | Tok::Function | Tok::FunctionBlock);
            !opens && !Construct::closed_by(t.kind).is_some_and(Construct::is_pou)
        });
        // Those inside an ACTION are its own.
        let mut in_action = false;
        for (i, t) in body {
            match t.kind {
                Tok::EndAction => in_action = false,
                Tok::Id if t.first && self.is(i, "ACTION") => in_action = true,
                Tok::Id if t.first && !in_action && self.is(i, "INITIAL_STEP") => return true,
                _ => {}
            }
        }
        false
    }

    /// `STEP name :`, `INITIAL_STEP name :`.
    fn step_here(&self) -> bool {
        (self.is(0, "INITIAL_STEP") || self.is(0, "STEP"))
            && self.peek(1).kind == Tok::Id
            && (self.peek(2).kind == Tok::Colon || self.is(0, "INITIAL_STEP") || !self.peek(1).first)
    }

    fn transition_here(&self) -> bool {
        if !self.is(0, "TRANSITION") {
            return false;
        }
        match self.peek(1).kind {
            // TO: the grammar takes it, a missing FROM is reported with the steps.
            Tok::Id | Tok::To => true,
            Tok::LParen => self.is(2, "PRIORITY") && self.peek(3).kind == Tok::Assign,
            _ => false,
        }
    }

    /// A token of a chart, outside of its steps.
    pub(super) fn chart_token(&mut self) {
        let t = self.peek(0);
        if t.kind != Tok::Id {
            return self.take(t.kind);
        }
        if self.step_here() {
            self.open(Construct::Step, Tok::Step);
            if self.peek(0).kind == Tok::Id {
                self.take(Tok::Id);
            }
        } else if self.transition_here() {
            self.open(Construct::Transition, Tok::Transition);
        } else if self.action_here() {
            self.next_action();
        } else if !self.unsupported() {
            self.take(Tok::Id);
        }
    }

    /// Opens an ACTION inside a POU, or behind an ACTION that is not closed.
    fn next_action(&mut self) {
        let keep = match self.stack.first() {
            Some(f) if f.block.is_pou() => 1,
            _ => 0,
        };
        self.close_above(keep, self.peek(0));
        if keep == 0 {
            self.begin_item();
        } else if self.stack.len() == 1 && self.stack[0].phase == Phase::Head {
            self.insert(Tok::BodySt);
            self.stack[0].phase = Phase::St;
        }
        self.open_action();
    }

    /// A token of a STEP.
    pub(super) fn step_token(&mut self) {
        let t = self.peek(0);
        let between = matches!(self.last(), Tok::Semi | Tok::Colon | Tok::Id) && t.first;
        if between && (self.step_here() || self.transition_here() || self.action_here()) {
            return self.close_above(self.stack.len() - 1, t);
        }
        self.take(t.kind);
    }

    /// A token of a TRANSITION before its condition.
    pub(super) fn transition_token(&mut self) {
        let t = self.peek(0);
        let begun = self.last() != Tok::Transition;
        if t.first && begun && (self.step_here() || self.transition_here() || self.action_here()) {
            return self.close_above(self.stack.len() - 1, t);
        }
        match t.kind {
            Tok::Id if self.is(0, "FROM") && matches!(self.last(), Tok::Transition | Tok::Id | Tok::RParen) => {
                self.take(Tok::From);
            }
            // The `:=` of the priority stands in parentheses.
            Tok::Assign if self.parens == 0 => {
                self.take(Tok::Assign);
                self.set_phase(Phase::St);
            }
            Tok::Colon => {
                self.at += 1;
                if self.il_here() {
                    self.emit(t);
                    let start = self.peek(0).start;
                    self.emit(Token::inserted(Tok::BodyIl, start));
                    return self.set_phase(Phase::Il);
                }
                self.report.push(
                    self.report
                        .at(codes::MISSING_WORD, t.start, t.end, "`:=` is missing before this condition")
                        .help("`:` stands before a condition in Instruction List, `:=` before an expression"),
                );
                self.emit(Token { kind: Tok::Assign, ..t });
                self.set_phase(Phase::St);
            }
            kind => self.take(kind),
        }
    }

    fn set_phase(&mut self, phase: Phase) {
        if let Some(frame) = self.stack.last_mut() {
            frame.phase = phase;
        }
    }

    /// Whether a statement may begin with the next token.
    pub(super) fn at_statement(&self) -> bool {
        use Tok::*;
        matches!(self.last(), Semi | Then | Do | CaseOf | Else | Repeat | BodySt | Colon)
    }

    /// A token of a body in Structured Text, or of a transition's condition.
    pub(super) fn statement_token(&mut self) {
        let t = self.peek(0);
        // Only REPEAT may stand directly behind itself.
        let word = Construct::statement(t.kind).is_some_and(|b| b != Construct::Repeat)
            || matches!(t.kind, Tok::Then | Tok::Elsif | Tok::Else | Tok::Do | Tok::Of | Tok::Until);
        if word && self.peek(1).kind == t.kind {
            let message = format!("{} stands twice", t.kind.describe());
            self.report.push(self.report.at(codes::UNEXPECTED, t.start, t.end, message).help("remove one of them"));
            self.at += 1;
            return;
        }
        // A statement on the next line: the condition behind UNTIL has ended, and END_REPEAT is missing.
        if Construct::statement(t.kind).is_some() && t.first && self.behind_until() {
            return self.close_above(self.stack.len() - 1, t);
        }
        match t.kind {
            Tok::Id => return self.name_in_statement(t),
            Tok::Else => self.branch(t, |f| matches!(f.block, Construct::If | Construct::Case)),
            Tok::Elsif => self.branch(t, |f| f.block == Construct::If),
            // The condition ends here, and with it the loop.
            Tok::Semi if self.top() == Some(Construct::Repeat) && self.stack.last().is_some_and(|f| f.has_else) => {
                self.take(Tok::Semi);
                while self.peek(0).kind == Tok::Semi {
                    self.at += 1;
                }
                let next = self.peek(0);
                let ends = next.kind == Tok::EndRepeat
                    || next.kind == Tok::Id && (self.split_end() || self.misspelled_end(next));
                if !ends {
                    self.close_above(self.stack.len() - 1, next);
                }
                return;
            }
            Tok::Until => {
                self.missing_repeat(t);
                self.branch(t, |f| f.block == Construct::Repeat);
            }
            Tok::Of => {
                if let Some(frame) = self.stack.last_mut()
                    && frame.block == Construct::Case
                    && !frame.has_of
                {
                    frame.has_of = true;
                    return self.take(Tok::CaseOf);
                }
                self.missing_opener(Tok::Of);
                if let Some(frame) = self.stack.last_mut()
                    && frame.block == Construct::Case
                    && !frame.has_of
                {
                    frame.has_of = true;
                    return self.take(Tok::CaseOf);
                }
            }
            Tok::Var | Tok::VarConfig | Tok::VarAccess => return self.late_section(t),
            // `MOD(a, b, ENO => ok);`: an operator's word as the function that begins a statement.
            Tok::Op if self.at_statement() && self.peek(1).kind == Tok::LParen => {
                let word = t.text(self.text).starts_with(|c: char| c.is_ascii_alphabetic());
                return self.take(if word { Tok::Id } else { Tok::Op });
            }
            Tok::Then | Tok::Do => self.missing_opener(t.kind),
            kind => {
                if kind == Tok::Case && self.at_statement() && self.labels_case() {
                    let message = "CASE stands once, before all of its values";
                    self.report.push(
                        self.report.at(codes::UNEXPECTED, t.start, t.end, message).help("write the value alone: `1:`"),
                    );
                    self.at += 1;
                    return;
                }
                if self.head_of_c() {
                    return;
                }
                if let Some(block) = Construct::statement(kind) {
                    // A condition of a transition has no statements.
                    return self.open(block, kind);
                }
            }
        }
        self.take(t.kind);
    }

    /// Whether the CASE that comes next stands before a value of the CASE that is open, as other languages write it.
    fn labels_case(&self) -> bool {
        let ends = |k: Tok| matches!(k, Tok::Colon | Tok::Semi | Tok::Of | Tok::Assign | Tok::EndCase | Tok::StartItem);
        let open = self.stack.last().is_some_and(|f| f.block == Construct::Case && f.has_of);
        open && (1..).map(|n| self.peek(n).kind).find(|k| ends(*k)) == Some(Tok::Colon)
    }

    /// Whether the condition behind an UNTIL is being read.
    fn behind_until(&self) -> bool {
        self.stack.last().is_some_and(|f| f.block == Construct::Repeat && f.has_else) && self.last() != Tok::Until
    }

    /// BEGIN and END, which other languages put around statements: reported once, and left out.
    fn begin_or_end(&mut self, t: Token) -> bool {
        let next = self.peek(1);
        let alone = next.first || matches!(next.kind, Tok::Semi | Tok::StartItem);
        if self.is(0, "BEGIN") && alone {
            let message = "no BEGIN stands before statements";
            self.report.push(
                self.report
                    .at(codes::UNEXPECTED, t.start, t.end, message)
                    .help("remove BEGIN and its END; END_IF, END_FOR and the like end a construct"),
            );
            self.begun += 1;
        } else if self.is(0, "END") && alone && self.begun > 0 {
            self.begun -= 1;
        } else {
            return false;
        }
        self.at += 1;
        if self.peek(0).kind == Tok::Semi {
            self.at += 1;
        }
        true
    }

    fn name_in_statement(&mut self, t: Token) {
        if self.at_statement() && self.begin_or_end(t) {
            return;
        }
        if t.first || self.at_statement() {
            if self.action_here() {
                return self.next_action();
            }
            if self.is(0, "JMP") && self.peek(1).kind == Tok::Id && !self.peek(1).first {
                return self.take(Tok::Jmp);
            }
            if self.is(0, "GOTO") && self.peek(1).kind == Tok::Id && !self.peek(1).first {
                self.report.push(
                    self.report.at(codes::MISSPELLED, t.start, t.end, "a jump is not written GOTO").help("write `JMP`"),
                );
                return self.take(Tok::Jmp);
            }
            let chart = self.top() == Some(Construct::Transition) && (self.step_here() || self.transition_here());
            if chart {
                return self.close_above(self.stack.len() - 1, t);
            }
            if self.at_statement() && (self.unsupported() || self.misspelled_end(t) || self.misspelled_opener(t)) {
                return;
            }
        }
        self.take(Tok::Id);
    }

    /// THEN, DO or OF comes next: the statement must have begun with its word, which is inserted if its END word is there.
    fn missing_opener(&mut self, word: Tok) {
        use Tok::*;
        let ends = |k: Tok| matches!(k, Semi | Then | Do | CaseOf | Else | Repeat | BodySt | Colon);
        let start = self.out.iter().rposition(|t| ends(t.kind)).map_or(0, |i| i + 1);
        let Some(first) = self.out.get(start).copied() else { return };
        let segment = &self.out[start..];
        let opens = |t: &Token| matches!(t.kind, If | Elsif | For | While | Case | Until);
        if segment.iter().any(opens) || first.is_inserted() || self.looks == 0 {
            return;
        }
        let (kind, block) = match word {
            Then => (If, Construct::If),
            Of => (Case, Construct::Case),
            _ if segment.iter().any(|t| t.kind == Assign) => (For, Construct::For),
            _ => (While, Construct::While),
        };
        // There must be one END word more than those that the open constructs need.
        self.looks -= 1;
        let open = self.stack.iter().rev().take_while(|f| f.block.is_statement()).filter(|f| f.block == block).count();
        if !self.closers_ahead(block, open + 1) {
            return;
        }
        let message = format!("{} is missing before this", kind.describe());
        let help = format!("write `{}`", kind.describe());
        self.report.push(self.report.at(codes::MISSING_WORD, first.start, first.end, message).help(help));
        self.stack.push(super::Frame::new(block, first, None, None));
        self.out.insert(start, Token::inserted(kind, first.start));
    }

    /// UNTIL comes next, and END_REPEAT behind it, but no REPEAT is open: where it belongs is not known, it is inserted here.
    fn missing_repeat(&mut self, t: Token) {
        let open = self.stack.iter().rev().take_while(|f| f.block.is_statement());
        if open.into_iter().any(|f| f.block == Construct::Repeat && !f.has_else)
            || self.looks == 0
            || !self.at_statement()
        {
            return;
        }
        self.looks -= 1;
        if !self.closers_ahead(Construct::Repeat, 1) {
            return;
        }
        self.report.push(
            self.report
                .at(codes::MISSING_WORD, t.start, t.end, "REPEAT is missing before this UNTIL")
                .help("write `REPEAT` before the statements of the loop"),
        );
        self.stack.push(super::Frame::new(Construct::Repeat, t, None, None));
        self.insert(Tok::Repeat);
    }

    /// A word one letter away from one that opens a statement (or is ELSIF), before something that cannot follow a name.
    fn misspelled_opener(&mut self, t: Token) -> bool {
        use Tok::*;
        let next = self.peek(1);
        let text = t.text(self.text);
        if !matches!(next.kind, Id | Int | Lit | Qualified | Not | LParen) || text.len() > 7 {
            return false;
        }
        let upper = text.to_ascii_uppercase();
        let words = [(If, Then), (For, To), (While, Do), (Case, Of), (Repeat, Until), (Elsif, Then)];
        let close = words.into_iter().find(|(word, _)| is_close(&upper, word.describe()));
        let Some((word, partner)) = close.or((upper == "SWITCH").then_some((Case, Of))) else { return false };
        // `name(...)` is a call and `name` on a line of its own a statement without `;`, unless the partner word follows.
        let until = |t: &&Token| word == Repeat || t.kind != Semi;
        let mut rest = self.tokens[self.at + 1..].iter().take_while(until);
        let stop = |k: Tok| k == partner || Construct::statement(k).is_some() || Construct::closed_by(k).is_some();
        if rest.find(|t| stop(t.kind)).is_none_or(|t| t.kind != partner) {
            return false;
        }
        let meant = word.describe();
        let message = format!("`{text}` cannot begin a statement here");
        self.report
            .push(self.report.at(codes::MISSPELLED, t.start, t.end, message).help(format!("did you mean `{meant}`?")));
        match Construct::statement(word) {
            Some(block) => self.open(block, word),
            None => {
                self.branch(t, |f| f.block == Construct::If);
                self.take(word);
            }
        }
        true
    }

    /// ELSE, ELSIF or UNTIL: constructs inside the one that it belongs to are not closed.
    fn branch(&mut self, t: Token, fits: impl Fn(&super::Frame) -> bool) {
        let statements = self.stack.iter().rev().take_while(|f| f.block.is_statement()).count();
        let first = self.stack.len() - statements;
        let owner = self.stack[first..].iter().rposition(|f| fits(f) && !f.has_else);
        if let Some(owner) = owner {
            self.close_above(first + owner + 1, t);
            if t.kind != Tok::Elsif
                && let Some(frame) = self.stack.last_mut()
            {
                frame.has_else = true;
            }
        }
    }

    /// A section of variables behind the first statement: reported and left out.
    fn late_section(&mut self, t: Token) {
        let word = t.text(self.text).to_ascii_uppercase();
        self.report.push(
            self.report
                .at(codes::DECLARATION_IN_BODY, t.start, t.end, format!("{word} stands behind the first statement"))
                .help("all sections of variables stand before the body"),
        );
        while self.at < self.tokens.len() {
            let t = self.peek(0);
            let kind = t.kind;
            if kind == Tok::Id {
                self.report.lose(t.text(self.text));
            }
            if kind == Tok::EndVar {
                self.at += 1;
                if self.peek(0).kind == Tok::Semi {
                    self.at += 1;
                }
                return;
            }
            if Construct::closed_by(kind).is_some_and(|b| b.is_pou() || b.is_statement()) {
                return;
            }
            self.at += 1;
        }
    }
}
