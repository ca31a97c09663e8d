//! Tokens of a file to slices of tokens, one per item, that the grammar can read.
//!
//! Every construct of IEC 61131-3 has its own END word. A stack of openers uses that: where an END word or a new POU closes an
//! outer construct first, the inner one is reported with both positions and its END word inserted, so that a broken POU never
//! damages the next. On the way each body is classified (ST, IL, SFC) and gets a marker in front, soft words become tokens of
//! their own where they mean something, and the `;` that END_IF may leave out is inserted. What stands between the words of a
//! construct is left to the grammar.

mod bodies;
mod braces;
mod declarations;
mod ends;
mod il;
mod outside;

pub(crate) use declarations::section_meant;

use crate::Profile;
use crate::ast::Pragma;
use crate::lexer::Lexed;
use crate::report::Reporter;
use crate::token::{Tok, Token};
use plcc_diag::codes;

/// How deep constructs may nest: passes over the tree recurse.
const MAX_BLOCKS: usize = 200;
/// How deep parentheses and brackets may nest.
const MAX_PARENS: u32 = 1000;
/// How often a file is searched for what explains a mistake.
const MAX_LOOKS: u32 = 200;

/// The items of a file. Each slice starts with `StartItem` and is balanced.
pub fn split(text: &str, lexed: &Lexed, profile: Profile, report: &mut Reporter) -> Vec<Vec<Token>> {
    let mut blocks = Blocks::new(text, lexed, profile, report);
    while blocks.at < lexed.tokens.len() {
        blocks.step();
    }
    blocks.end_of_file();
    blocks.items
}

/// A body that stands alone: one slice that starts with `StartBody`.
///
/// `start` is where it begins in `text`, `language` its marker if that is known.
pub fn body(
    text: &str,
    start: u32,
    language: Option<Tok>,
    lexed: &Lexed,
    profile: Profile,
    report: &mut Reporter,
) -> Vec<Token> {
    let mut blocks = Blocks::new(text, lexed, profile, report);
    blocks.start = start;
    // A POU around it keeps every rule in one place; its words are no tokens of the text.
    let opener = Token::inserted(Tok::Program, start);
    blocks.stack.push(Frame::new(Construct::Program, opener, None, None));
    blocks.out.push(Token::inserted(Tok::StartBody, start));
    match language {
        Some(Tok::BodyIl) => blocks.start_body_as(Phase::Il, Tok::BodyIl),
        Some(_) => blocks.start_body_as(Phase::St, Tok::BodySt),
        None => blocks.start_body(),
    }
    while blocks.at < lexed.tokens.len() && !blocks.stack.is_empty() {
        blocks.step();
    }
    if blocks.stack.len() > 1 {
        blocks.close_above(1, blocks.peek(0));
    }
    blocks.hint_semicolons();
    blocks.out
}

/// Constructs with an END word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Construct {
    Program,
    Function,
    FunctionBlock,
    Type,
    Configuration,
    Resource,
    Action,
    Step,
    Transition,
    Var,
    Struct,
    Union,
    If,
    Case,
    For,
    While,
    Repeat,
}

impl Construct {
    /// Its END word.
    fn end(self) -> Tok {
        match self {
            Construct::Program => Tok::EndProgram,
            Construct::Function => Tok::EndFunction,
            Construct::FunctionBlock => Tok::EndFunctionBlock,
            Construct::Type => Tok::EndType,
            Construct::Configuration => Tok::EndConfiguration,
            Construct::Resource => Tok::EndResource,
            Construct::Action => Tok::EndAction,
            Construct::Step => Tok::EndStep,
            Construct::Transition => Tok::EndTransition,
            Construct::Var => Tok::EndVar,
            Construct::Struct => Tok::EndStruct,
            Construct::Union => Tok::EndUnion,
            Construct::If => Tok::EndIf,
            Construct::Case => Tok::EndCase,
            Construct::For => Tok::EndFor,
            Construct::While => Tok::EndWhile,
            Construct::Repeat => Tok::EndRepeat,
        }
    }

    /// What the END word `kind` closes.
    fn closed_by(kind: Tok) -> Option<Construct> {
        Some(match kind {
            Tok::EndProgram => Construct::Program,
            Tok::EndFunction => Construct::Function,
            Tok::EndFunctionBlock => Construct::FunctionBlock,
            Tok::EndType => Construct::Type,
            Tok::EndConfiguration => Construct::Configuration,
            Tok::EndResource => Construct::Resource,
            Tok::EndAction => Construct::Action,
            Tok::EndStep => Construct::Step,
            Tok::EndTransition => Construct::Transition,
            Tok::EndVar => Construct::Var,
            Tok::EndStruct => Construct::Struct,
            Tok::EndUnion => Construct::Union,
            Tok::EndIf => Construct::If,
            Tok::EndCase => Construct::Case,
            Tok::EndFor => Construct::For,
            Tok::EndWhile => Construct::While,
            Tok::EndRepeat => Construct::Repeat,
            _ => return None,
        })
    }

    /// The statement that the word `kind` opens.
    fn statement(kind: Tok) -> Option<Construct> {
        Some(match kind {
            Tok::If => Construct::If,
            Tok::Case => Construct::Case,
            Tok::For => Construct::For,
            Tok::While => Construct::While,
            Tok::Repeat => Construct::Repeat,
            _ => return None,
        })
    }

    fn is_statement(self) -> bool {
        matches!(self, Construct::If | Construct::Case | Construct::For | Construct::While | Construct::Repeat)
    }

    fn is_pou(self) -> bool {
        matches!(self, Construct::Program | Construct::Function | Construct::FunctionBlock)
    }
}

/// What a construct consists of at this place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    /// Before the body, or a construct without one.
    Head,
    /// Structured Text.
    St,
    /// Instruction List.
    Il,
    /// Sequential Function Chart.
    Sfc,
}

/// An open construct.
#[derive(Debug, Clone, Copy)]
struct Frame {
    block: Construct,
    opener: Token,
    phase: Phase,
    /// Blanks before the opener, if it is the first on its line.
    indent: Option<u32>,
    /// IF, CASE: has an ELSE. REPEAT: has its UNTIL. CASE: see `has_of`.
    has_else: bool,
    /// CASE: has its OF.
    has_of: bool,
    /// Its statements stand in braces, which was reported.
    braced: bool,
    /// This IF stands directly behind an ELSE on the same line.
    behind_else: Option<Token>,
    /// An inner IF behind ELSE took this one's END word, perhaps.
    else_if: Option<(Token, Token)>,
    /// By its indentation this inner opener lacks the END word: opener, and the END word that it took.
    suspect: Option<(Token, Token)>,
}

impl Frame {
    fn new(block: Construct, opener: Token, indent: Option<u32>, behind_else: Option<Token>) -> Self {
        let (phase, has_else, has_of, braced) = (Phase::Head, false, false, false);
        Self { block, opener, phase, indent, has_else, has_of, braced, behind_else, else_if: None, suspect: None }
    }
}

struct Blocks<'a, 'd> {
    text: &'a str,
    tokens: &'a [Token],
    pragmas: &'a [Pragma],
    /// Those that lie before the next token.
    pragmas_read: usize,
    /// See [`Lexed`].
    rest_is_comment: bool,
    /// Where the source begins in the text.
    start: u32,
    /// The next token.
    at: usize,
    profile: Profile,
    report: &'a mut Reporter<'d>,
    stack: Vec<Frame>,
    /// The item that is being made.
    out: Vec<Token>,
    items: Vec<Vec<Token>>,
    /// Open parentheses and brackets of the statement.
    parens: u32,
    /// Between items, behind something that was reported.
    lost: bool,
    /// Index of an END_VAR at or behind `at`, when it was last looked for.
    next_end_var: usize,
    /// END words of statements without `;`.
    bare_ends: Vec<Token>,
    /// A `;` behind an instruction of IL was reported: once per file.
    told_semicolon: bool,
    /// BEGINs that were reported and whose END may follow.
    begun: u32,
    /// How often the file may still be searched for what explains a mistake.
    looks: u32,
}

impl<'a, 'd> Blocks<'a, 'd> {
    fn new(text: &'a str, lexed: &'a Lexed, profile: Profile, report: &'a mut Reporter<'d>) -> Self {
        Self {
            text,
            tokens: &lexed.tokens,
            pragmas: &lexed.pragmas,
            pragmas_read: 0,
            rest_is_comment: lexed.rest_is_comment,
            start: 0,
            at: 0,
            profile,
            report,
            stack: Vec::new(),
            out: Vec::new(),
            items: Vec::new(),
            parens: 0,
            lost: false,
            next_end_var: 0,
            bare_ends: Vec::new(),
            told_semicolon: false,
            begun: 0,
            looks: MAX_LOOKS,
        }
    }

    /// The token `ahead` of the next; at the end of the file one of a kind that fits nowhere.
    fn peek(&self, ahead: usize) -> Token {
        match self.tokens.get(self.at + ahead) {
            Some(t) => *t,
            None => {
                let end = self.text.len() as u32;
                Token { kind: Tok::StartItem, first: true, start: end, end }
            }
        }
    }

    /// Whether the token `ahead` is the soft word `word` (in upper case).
    fn is(&self, ahead: usize, word: &str) -> bool {
        let t = self.peek(ahead);
        t.kind == Tok::Id && (t.end - t.start) as usize == word.len() && t.text(self.text).eq_ignore_ascii_case(word)
    }

    /// The kind of the last token that was emitted.
    fn last(&self) -> Tok {
        self.out.last().map_or(Tok::StartItem, |t| t.kind)
    }

    /// Where the last token of the source before the next one ends.
    fn previous_end(&self) -> u32 {
        self.tokens[..self.at].last().map_or(self.start, |t| t.end)
    }

    /// Emits the next token as a token of `kind`.
    fn take(&mut self, kind: Tok) {
        let t = self.peek(0);
        self.at += 1;
        self.emit(Token { kind, ..t });
    }

    /// Emits a token that is not in the source, behind the last one that is.
    fn insert(&mut self, kind: Tok) {
        let at = self.previous_end();
        self.emit(Token::inserted(kind, at));
    }

    /// All tokens pass here: what nests too deeply in parentheses is cut out.
    fn emit(&mut self, t: Token) {
        match t.kind {
            // Of several `;` in a row one is enough.
            Tok::Semi if self.last() == Tok::Semi => return,
            Tok::LParen | Tok::LBracket => {
                self.parens += 1;
                if self.parens > MAX_PARENS {
                    if self.parens == MAX_PARENS + 1 {
                        self.cut_parens(t);
                    }
                    return;
                }
            }
            Tok::RParen | Tok::RBracket => {
                let depth = self.parens;
                self.parens = depth.saturating_sub(1);
                if depth > MAX_PARENS {
                    return;
                }
            }
            Tok::Id | Tok::Int | Tok::Lit | Tok::Comma | Tok::Dot | Tok::Op | Tok::Rel | Tok::Not => {
                if self.parens > MAX_PARENS {
                    return;
                }
            }
            kind => {
                if ends_parens(kind) {
                    self.parens = 0;
                } else if self.parens > MAX_PARENS {
                    return;
                }
            }
        }
        self.out.push(t);
    }

    fn cut_parens(&mut self, t: Token) {
        self.report.push(
            self.report
                .at(
                    codes::NESTED_TOO_DEEPLY,
                    t.start,
                    t.end,
                    format!("more than {MAX_PARENS} parentheses are open here"),
                )
                .help("divide the expression into several statements"),
        );
        if !matches!(self.last(), Tok::Id | Tok::RParen | Tok::RBracket | Tok::Caret) {
            self.out.push(Token { kind: Tok::Bad, ..t });
        }
    }

    fn step(&mut self) {
        if !self.pragmas.is_empty() && self.braces() {
            return;
        }
        let t = self.peek(0);
        if let Some(block) = Construct::closed_by(t.kind) {
            return self.end_word(block, 1);
        }
        if t.kind == Tok::Id && self.split_end() {
            return;
        }
        if let Some(block) = self.item_here() {
            return self.open_item(block);
        }
        let Some(top) = self.stack.last() else { return self.between_items() };
        match (top.block, top.phase) {
            (Construct::Var | Construct::Struct | Construct::Union | Construct::Type, _) => self.declaration_token(),
            (Construct::Configuration | Construct::Resource, _) => self.resource_token(),
            (Construct::Step, _) => self.step_token(),
            (Construct::Transition, Phase::Head) => self.transition_token(),
            (_, Phase::Il) => self.il_line(),
            (_, Phase::Sfc) => self.chart_token(),
            (Construct::Program | Construct::Function | Construct::FunctionBlock | Construct::Action, Phase::Head) => {
                self.head_token()
            }
            _ => self.statement_token(),
        }
    }

    /// The item that the next token opens, wherever it stands.
    fn item_here(&self) -> Option<Construct> {
        let t = self.peek(0);
        let block = match t.kind {
            Tok::Program => Construct::Program,
            Tok::Function => Construct::Function,
            Tok::FunctionBlock => Construct::FunctionBlock,
            Tok::Type => Construct::Type,
            Tok::Id if t.first && self.is(0, "CONFIGURATION") => Construct::Configuration,
            _ => return None,
        };
        // As the name of something it is a mistake that the grammar reports better.
        if self.peek(1).kind != Tok::Id && !self.stack.is_empty() && !matches!(self.peek(1).kind, Tok::Var) {
            return None;
        }
        if matches!(self.peek(2).kind, Tok::Colon | Tok::Id) || self.peek(1).kind != Tok::Id {
            // `PROGRAM P1 WITH T : Main` and `PROGRAM P1 : Main` in a RESOURCE declare an instance.
            let declares = self.peek(2).kind == Tok::Colon || self.is(2, "WITH") || self.is(3, "WITH");
            let resource = matches!(self.top(), Some(Construct::Resource | Construct::Configuration));
            if block == Construct::Program && resource && (declares || self.peek(3).kind == Tok::Colon) {
                return None;
            }
        }
        if self.peek(1).kind != Tok::Id && block == Construct::Configuration {
            return None;
        }
        Some(block)
    }

    fn top(&self) -> Option<Construct> {
        self.stack.last().map(|f| f.block)
    }

    /// Opens an item at the level of the file, closing whatever is open.
    fn open_item(&mut self, block: Construct) {
        if !self.stack.is_empty() {
            self.close_above(0, self.peek(0));
        }
        let t = self.peek(0);
        let kind = if block == Construct::Configuration { Tok::Configuration } else { t.kind };
        self.begin_item();
        if self.function_block_in_two_words() {
            self.at += 1;
            self.open(Construct::FunctionBlock, Tok::FunctionBlock);
            return self.pou_head(Construct::FunctionBlock);
        }
        if block.is_pou() && self.peek(1).kind == t.kind && !self.peek(1).first {
            let message = format!("{} stands twice", kind.describe());
            self.report.push(self.report.at(codes::UNEXPECTED, t.start, t.end, message).help("remove one of them"));
            self.at += 1;
        }
        self.open(block, kind);
        if block.is_pou() {
            self.pou_head(block);
        }
    }

    /// `FUNCTION BLOCK Motor`: reported.
    fn function_block_in_two_words(&mut self) -> bool {
        let (t, next) = (self.peek(0), self.peek(1));
        if t.kind != Tok::Function || !self.is(1, "BLOCK") || self.peek(2).kind != Tok::Id || self.peek(2).first {
            return false;
        }
        let message = "FUNCTION_BLOCK is one word";
        self.report.push(self.report.at(codes::MISSPELLED, t.start, next.end, message).help("write `FUNCTION_BLOCK`"));
        true
    }

    fn begin_item(&mut self) {
        self.lost = false;
        let start = self.peek(0).start;
        self.out = vec![Token::inserted(Tok::StartItem, start)];
    }

    /// Opens a construct with the next token, which is emitted as `kind`.
    fn open(&mut self, block: Construct, kind: Tok) {
        let opener = self.peek(0);
        if self.stack.len() >= MAX_BLOCKS {
            return self.skip_block(opener);
        }
        let behind_else = match (block, self.out.last()) {
            (Construct::If, Some(t)) if t.kind == Tok::Else && !opener.first => Some(*t),
            _ => None,
        };
        let indent = self.indent(opener);
        self.stack.push(Frame::new(block, opener, indent, behind_else));
        self.take(kind);
    }

    /// Blanks before `t`, if nothing else stands there.
    fn indent(&self, t: Token) -> Option<u32> {
        if !t.first {
            return None;
        }
        let before = &self.text.as_bytes()[..t.start as usize];
        let blanks = before.iter().rev().take_while(|b| matches!(b, b' ' | b'\t')).count();
        match before.len().checked_sub(blanks + 1).map(|i| before[i]) {
            None | Some(b'\n') => Some(blanks as u32),
            Some(_) => None,
        }
    }

    /// Leaves out a construct that nests too deeply, up to its END word.
    fn skip_block(&mut self, opener: Token) {
        self.report.push(
            self.report
                .at(
                    codes::NESTED_TOO_DEEPLY,
                    opener.start,
                    opener.end,
                    format!("blocks nest more than {MAX_BLOCKS} deep here"),
                )
                .help("move inner blocks to a function or function block"),
        );
        let mut depth = 0usize;
        while self.at < self.tokens.len() {
            let kind = self.peek(0).kind;
            if Construct::statement(kind).is_some() || matches!(kind, Tok::Struct | Tok::Union) {
                depth += 1;
            } else if let Some(block) = Construct::closed_by(kind) {
                if !block.is_statement() && !matches!(block, Construct::Struct | Construct::Union) {
                    break;
                }
                depth -= 1;
                if depth == 0 {
                    self.at += 1;
                    break;
                }
            } else if matches!(kind, Tok::Program | Tok::Function | Tok::FunctionBlock) {
                break;
            }
            self.at += 1;
        }
        self.insert(Tok::Bad);
        if self.peek(0).kind != Tok::Semi {
            self.insert(Tok::Semi);
        }
    }

    fn end_of_file(&mut self) {
        if !self.stack.is_empty() {
            self.close_above(0, self.peek(0));
        }
        self.hint_semicolons();
    }

    /// One hint for all END words of the file that lack the `;` of the standard.
    fn hint_semicolons(&mut self) {
        if self.profile == Profile::Strict && !self.bare_ends.is_empty() && !self.report.is_used() {
            let t = self.bare_ends[0];
            let more = match self.bare_ends.len() - 1 {
                0 => String::new(),
                1 => " (and once more in this file)".into(),
                n => format!(" (and {n} more times in this file)"),
            };
            let word = t.kind.describe();
            self.report.push(
                self.report
                    .at(codes::OPTIONAL_SEMICOLON, t.end, t.end, format!("no `;` behind {word}{more}"))
                    .help("the standard asks for it; other tools may refuse this"),
            );
        }
    }
}

/// Signs and words that cannot stand inside parentheses.
fn ends_parens(kind: Tok) -> bool {
    matches!(
        kind,
        Tok::Semi
            | Tok::If
            | Tok::Then
            | Tok::Elsif
            | Tok::Else
            | Tok::Case
            | Tok::CaseOf
            | Tok::For
            | Tok::Do
            | Tok::While
            | Tok::Repeat
            | Tok::Until
            | Tok::Var
            | Tok::Step
            | Tok::Transition
            | Tok::Action
            | Tok::IlOp
            | Tok::IlLabel
            | Tok::BodySt
            | Tok::BodyIl
            | Tok::BodySfc
    ) || Construct::closed_by(kind).is_some()
}

/// Whether two words in upper case differ by one inserted, removed, replaced or swapped letter.
pub(crate) fn is_close(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    if a.len().abs_diff(b.len()) > 1 || a.len() < 3 {
        return false;
    }
    let same = a.iter().zip(b).take_while(|(x, y)| x == y).count();
    let (x, y) = (&a[same..], &b[same..]);
    match a.len().cmp(&b.len()) {
        std::cmp::Ordering::Less => x == &y[1..],
        std::cmp::Ordering::Greater => &x[1..] == y,
        std::cmp::Ordering::Equal => {
            x.is_empty() || x[1..] == y[1..] || (x.len() >= 2 && x[0] == y[1] && x[1] == y[0] && x[2..] == y[2..])
        }
    }
}

/// A text as a message shows it.
pub(crate) fn shorten(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((i, _)) => format!("{}...", &text[..i]),
        None => text.to_string(),
    }
}
