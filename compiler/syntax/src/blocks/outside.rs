//! What stands between the items of a file, and constructs that plcc does not have.

use super::{Blocks, Construct, is_close, shorten};
use crate::token::{Tok, Token};
use plcc_diag::codes;

impl Blocks<'_, '_> {
    /// Between the items of a file.
    pub(super) fn between_items(&mut self) {
        let t = self.peek(0);
        match t.kind {
            Tok::Semi => self.at += 1,
            // A section of a POU whose head could not be read.
            Tok::Var if self.lost && !t.text(self.text).eq_ignore_ascii_case("VAR_GLOBAL") => self.outside(t),
            Tok::Var | Tok::VarConfig | Tok::VarAccess => {
                self.begin_item();
                self.open_section();
            }
            Tok::Id if self.action_here() => {
                self.begin_item();
                self.open_action();
            }
            Tok::Id if self.unsupported() => {}
            // Reported by the lexer.
            Tok::Bad => {
                self.lost = true;
                self.at += 1;
            }
            _ => self.outside(t),
        }
    }

    /// Something that cannot stand between items; what follows belongs to the same mistake.
    fn outside(&mut self, t: Token) {
        self.at += 1;
        if t.kind == Tok::Id {
            self.report.lose(t.text(self.text));
        }
        if std::mem::replace(&mut self.lost, true) {
            return;
        }
        let text = t.text(self.text);
        let message = if matches!(self.peek(0).kind, Tok::Assign | Tok::LParen | Tok::Dot | Tok::LBracket)
            || Construct::statement(t.kind).is_some()
        {
            "a statement stands outside of any POU".to_string()
        } else {
            format!("`{}` stands outside of any declaration", shorten(text))
        };
        let help = match closest_item(text) {
            Some(word) => format!("did you mean `{word}`?"),
            None => "a file consists of PROGRAM, FUNCTION, FUNCTION_BLOCK, TYPE, VAR_GLOBAL and CONFIGURATION".into(),
        };
        self.report.push(self.report.at(codes::OUTSIDE_POU, t.start, t.end, message).help(help));
    }

    /// Words of object orientation: reported and left out up to their END word.
    pub(super) fn unsupported(&mut self) -> bool {
        const WORDS: &[&str] = &["CLASS", "INTERFACE", "METHOD", "PROPERTY", "NAMESPACE"];
        let t = self.peek(0);
        let Some(word) = WORDS.iter().find(|w| self.is(0, w)) else { return false };
        if !t.first || !matches!(self.peek(1).kind, Tok::Id) || self.peek(1).first {
            return false;
        }
        self.report.push(
            self.report
                .at(codes::NOT_SUPPORTED, t.start, t.end, format!("{word} is not supported"))
                .help("plcc compiles IEC 61131-3 without object orientation: use function blocks with actions"),
        );
        let end = format!("END_{word}");
        // Up to the END word, if there is one before the POU around it ends.
        let mut ahead = 1;
        while self.at + ahead < self.tokens.len() && !self.is(ahead, &end) {
            if Construct::closed_by(self.peek(ahead).kind).is_some_and(Construct::is_pou) && !self.stack.is_empty() {
                break;
            }
            ahead += 1;
        }
        self.at = (self.at + ahead + usize::from(self.is(ahead, &end))).min(self.tokens.len());
        true
    }
}

/// The item word that a misspelled one means.
fn closest_item(word: &str) -> Option<&'static str> {
    const WORDS: &[&str] = &["PROGRAM", "FUNCTION", "FUNCTION_BLOCK", "TYPE", "VAR_GLOBAL", "CONFIGURATION", "ACTION"];
    let upper = word.to_ascii_uppercase();
    WORDS.iter().copied().find(|w| is_close(&upper, w))
}
