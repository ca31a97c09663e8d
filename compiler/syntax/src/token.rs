//! Tokens and the table of reserved words.
//!
//! A token carries no text: the grammar's actions read it from the source by position. Reserved are only words that open or
//! close a construct of ST or a declaration, and the operators (semantics.md \[L2\]); every other word is [`Tok::Id`] here, and
//! `blocks` turns it into one of the soft kinds where the context leaves no other reading.

use rustc_hash::FxHashMap;
use std::sync::LazyLock;

/// A token with its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Token {
    /// Which.
    pub kind: Tok,
    /// The first on its line.
    pub first: bool,
    /// First byte.
    pub start: u32,
    /// One past the last byte; an inserted token is empty.
    pub end: u32,
}

impl Token {
    /// A token that is not in the text, placed at byte `at`.
    pub fn inserted(kind: Tok, at: u32) -> Self {
        Self { kind, first: false, start: at, end: at }
    }

    /// Whether it was written by nobody.
    pub fn is_inserted(&self) -> bool {
        self.start == self.end
    }

    /// The text under it.
    pub fn text<'t>(&self, source: &'t str) -> &'t str {
        &source[self.start as usize..self.end as usize]
    }
}

macro_rules! tokens {
    ($($(#[$doc:meta])* $name:ident $text:literal;)*) => {
        /// Kinds of token.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum Tok { $($(#[$doc])* $name),* }

        impl Tok {
            /// How a message names a token of this kind: its spelling, or what it is.
            pub fn describe(self) -> &'static str {
                match self { $(Tok::$name => $text),* }
            }
        }
    };
}

tokens! {
    /// An identifier, soft words included.
    Id "a name";
    /// A plain decimal integer.
    Int "a number";
    /// Any other literal, with its prefix.
    Lit "a literal";
    /// `Color#Red`.
    Qualified "an enumeration value";
    /// `%IX0.0`, `%QW4`, `%I*`.
    Address "an address";
    /// `%X3` behind a dot.
    Part "a part access";
    /// Stands for what was reported already.
    Bad "a mistake";
    /// `;`
    Semi "`;`";
    /// `:`
    Colon "`:`";
    /// `,`
    Comma "`,`";
    /// `.`
    Dot "`.`";
    /// `..`
    DotDot "`..`";
    /// `(`
    LParen "`(`";
    /// `)`
    RParen "`)`";
    /// `[`
    LBracket "`[`";
    /// `]`
    RBracket "`]`";
    /// `^`
    Caret "`^`";
    /// `:=`
    Assign "`:=`";
    /// `=>`
    Arrow "`=>`";
    /// `?=`
    Attempt "`?=`";
    /// `REF=`
    Bind "`REF=`";
    /// `=`
    Eq "`=`";
    /// `+`
    Plus "`+`";
    /// `-`
    Minus "`-`";
    /// `*`
    Star "`*`";
    /// `<` `>` `<=` `>=` `<>`
    Rel "a comparison";
    /// `/` `**` `&` MOD AND OR XOR AND_THEN OR_ELSE
    Op "an operator";
    /// NOT
    Not "NOT";
    /// IF
    If "IF";
    /// THEN
    Then "THEN";
    /// ELSIF
    Elsif "ELSIF";
    /// ELSE
    Else "ELSE";
    /// END_IF
    EndIf "END_IF";
    /// CASE
    Case "CASE";
    /// OF of an array type
    Of "OF";
    /// OF of a CASE (soft)
    CaseOf "OF";
    /// END_CASE
    EndCase "END_CASE";
    /// FOR
    For "FOR";
    /// TO
    To "TO";
    /// BY
    By "BY";
    /// DO
    Do "DO";
    /// END_FOR
    EndFor "END_FOR";
    /// WHILE
    While "WHILE";
    /// END_WHILE
    EndWhile "END_WHILE";
    /// REPEAT
    Repeat "REPEAT";
    /// UNTIL
    Until "UNTIL";
    /// END_REPEAT
    EndRepeat "END_REPEAT";
    /// JMP before a label (soft)
    Jmp "JMP";
    /// PROGRAM
    Program "PROGRAM";
    /// END_PROGRAM
    EndProgram "END_PROGRAM";
    /// FUNCTION
    Function "FUNCTION";
    /// END_FUNCTION
    EndFunction "END_FUNCTION";
    /// FUNCTION_BLOCK
    FunctionBlock "FUNCTION_BLOCK";
    /// END_FUNCTION_BLOCK
    EndFunctionBlock "END_FUNCTION_BLOCK";
    /// TYPE
    Type "TYPE";
    /// END_TYPE
    EndType "END_TYPE";
    /// STRUCT
    Struct "STRUCT";
    /// END_STRUCT
    EndStruct "END_STRUCT";
    /// UNION
    Union "UNION";
    /// END_UNION
    EndUnion "END_UNION";
    /// ARRAY
    Array "ARRAY";
    /// VAR and the sections that are written like it
    Var "VAR";
    /// VAR_CONFIG
    VarConfig "VAR_CONFIG";
    /// VAR_ACCESS
    VarAccess "VAR_ACCESS";
    /// END_VAR
    EndVar "END_VAR";
    /// CONSTANT, RETAIN ... behind a section keyword (soft)
    Qualifier "a qualifier";
    /// AT before an address (soft)
    At "AT";
    /// R_EDGE, F_EDGE behind a type (soft)
    Edge "an edge";
    /// REF_TO, POINTER TO, REFERENCE TO (soft)
    RefWord "a reference type";
    /// READ_ONLY, READ_WRITE behind a type (soft)
    Access "READ_ONLY or READ_WRITE";
    /// STEP, INITIAL_STEP (soft)
    Step "STEP";
    /// END_STEP
    EndStep "END_STEP";
    /// TRANSITION (soft)
    Transition "TRANSITION";
    /// FROM (soft)
    From "FROM";
    /// END_TRANSITION
    EndTransition "END_TRANSITION";
    /// ACTION (soft)
    Action "ACTION";
    /// END_ACTION
    EndAction "END_ACTION";
    /// CONFIGURATION (soft)
    Configuration "CONFIGURATION";
    /// END_CONFIGURATION
    EndConfiguration "END_CONFIGURATION";
    /// RESOURCE (soft)
    Resource "RESOURCE";
    /// END_RESOURCE
    EndResource "END_RESOURCE";
    /// ON (soft)
    On "ON";
    /// TASK (soft)
    Task "TASK";
    /// WITH (soft)
    With "WITH";
    /// The label of an IL line
    IlLabel "a label";
    /// The first word of an IL line
    IlOp "an operator";
    /// An IL operator before `(`
    IlDefer "an operator";
    /// A function name before `(` at the start of an IL line
    IlFunction "a function";
    /// The end of an IL line
    Eol "the end of the line";
    /// Before a body in Structured Text
    BodySt "a statement";
    /// Before a body in Instruction List
    BodyIl "an instruction";
    /// Before a body in Sequential Function Chart
    BodySfc "a step";
    /// Before an item of a file
    StartItem "a declaration";
    /// Before an expression alone
    StartExpr "an expression";
    /// Before a body alone
    StartBody "a body";
    /// Before a type alone
    StartType "a type";
    /// Before an initial value alone
    StartInit "an initial value";
}

impl Tok {
    /// A word that is never a name.
    pub fn is_reserved(self) -> bool {
        RESERVED.iter().any(|r| r.1 == self)
    }
}

/// Reserved words in upper case.
const RESERVED: &[(&str, Tok)] = &[
    ("NOT", Tok::Not),
    ("MOD", Tok::Op),
    ("AND", Tok::Op),
    ("OR", Tok::Op),
    ("XOR", Tok::Op),
    ("AND_THEN", Tok::Op),
    ("OR_ELSE", Tok::Op),
    ("TRUE", Tok::Lit),
    ("FALSE", Tok::Lit),
    ("NULL", Tok::Lit),
    ("IF", Tok::If),
    ("THEN", Tok::Then),
    ("ELSIF", Tok::Elsif),
    ("ELSE", Tok::Else),
    ("END_IF", Tok::EndIf),
    ("CASE", Tok::Case),
    ("OF", Tok::Of),
    ("END_CASE", Tok::EndCase),
    ("FOR", Tok::For),
    ("TO", Tok::To),
    ("BY", Tok::By),
    ("DO", Tok::Do),
    ("END_FOR", Tok::EndFor),
    ("WHILE", Tok::While),
    ("END_WHILE", Tok::EndWhile),
    ("REPEAT", Tok::Repeat),
    ("UNTIL", Tok::Until),
    ("END_REPEAT", Tok::EndRepeat),
    ("PROGRAM", Tok::Program),
    ("END_PROGRAM", Tok::EndProgram),
    ("FUNCTION", Tok::Function),
    ("END_FUNCTION", Tok::EndFunction),
    ("FUNCTION_BLOCK", Tok::FunctionBlock),
    ("END_FUNCTION_BLOCK", Tok::EndFunctionBlock),
    ("TYPE", Tok::Type),
    ("END_TYPE", Tok::EndType),
    ("STRUCT", Tok::Struct),
    ("END_STRUCT", Tok::EndStruct),
    ("UNION", Tok::Union),
    ("END_UNION", Tok::EndUnion),
    ("ARRAY", Tok::Array),
    ("VAR", Tok::Var),
    ("VAR_INPUT", Tok::Var),
    ("VAR_OUTPUT", Tok::Var),
    ("VAR_IN_OUT", Tok::Var),
    ("VAR_EXTERNAL", Tok::Var),
    ("VAR_GLOBAL", Tok::Var),
    ("VAR_TEMP", Tok::Var),
    ("VAR_CONFIG", Tok::VarConfig),
    ("VAR_ACCESS", Tok::VarAccess),
    ("END_VAR", Tok::EndVar),
    ("END_STEP", Tok::EndStep),
    ("END_TRANSITION", Tok::EndTransition),
    ("END_ACTION", Tok::EndAction),
    ("END_CONFIGURATION", Tok::EndConfiguration),
    ("END_RESOURCE", Tok::EndResource),
];

static BY_WORD: LazyLock<FxHashMap<&'static [u8], Tok>> =
    LazyLock::new(|| RESERVED.iter().map(|(word, tok)| (word.as_bytes(), *tok)).collect());

/// The kind of a word in any case: reserved, or a name.
pub fn word_kind(word: &str) -> Tok {
    let mut upper = [0u8; 20];
    let Some(slot) = upper.get_mut(..word.len()) else { return Tok::Id };
    slot.copy_from_slice(word.as_bytes());
    slot.make_ascii_uppercase();
    BY_WORD.get(&*slot).copied().unwrap_or(Tok::Id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_in_any_case() {
        assert_eq!(word_kind("End_Function_Block"), Tok::EndFunctionBlock);
        assert_eq!(word_kind("step"), Tok::Id);
        assert_eq!(word_kind("a_very_long_name_that_is_no_word"), Tok::Id);
        assert!(RESERVED.iter().all(|(w, _)| w.len() <= 20));
    }
}
