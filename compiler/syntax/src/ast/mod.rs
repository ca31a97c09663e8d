//! The syntax tree of all notations. It says what was written and where; it knows no types and resolves no names.

// Nodes are built once and then only matched: patterns without boxes are worth more than their size.
#![allow(clippy::large_enum_variant)]

pub mod config;
pub mod decl;
pub mod expr;
pub mod il;
pub mod network;
pub mod print;
pub mod sfc;
pub mod source;
pub mod st;

pub use config::*;
pub use decl::*;
pub use expr::*;
pub use il::*;
pub use network::*;
pub use sfc::*;
pub use st::*;

use plcc_diag::Span;
use smol_str::SmolStr;

/// An identifier as written; its folding is `hir::collect`'s business.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Name {
    /// As written.
    pub text: SmolStr,
    /// Where.
    pub span: Span,
}

/// A pragma `{...}`; the text is what stands between the braces.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pragma {
    /// Between the braces, untrimmed.
    pub text: SmolStr,
    /// With the braces.
    pub span: Span,
}

/// What one source file holds, in the order of the text.
#[derive(Debug, Clone, Default)]
pub struct File {
    /// POUs, types, globals, configurations.
    pub items: Vec<Item>,
    /// All pragmas of the file, in order; they may stand between any two tokens.
    pub pragmas: Vec<Pragma>,
    /// Behind a mistake of syntax: statements that were mended by a guess, and uses of names whose declaration could not be
    /// read. A further message about them would not be a further mistake.
    pub doubtful: Vec<Span>,
    /// Behind declarations that lack their names.
    pub unnamed: Unnamed,
    /// Parts of a PLCopen XML file and how messages name them; inner ones behind the outer ones that hold them.
    pub places: Vec<Place>,
}

/// Declarations without a name: what is used and not declared may be meant by them.
#[derive(Debug, Clone, Default)]
pub struct Unnamed {
    /// How many.
    pub count: usize,
    /// If there are any, all names of the file in its order, in upper case.
    pub names: Vec<(SmolStr, Span)>,
}

/// A part of a PLCopen XML file that users know by another name than its line.
#[derive(Debug, Clone)]
pub struct Place {
    /// Where in the file.
    pub span: Span,
    /// `Main`, or `Main: coil ...`.
    pub name: String,
    /// It is a text, whose lines count from its start.
    pub text: bool,
}

/// A top-level declaration.
#[derive(Debug, Clone)]
pub enum Item {
    /// PROGRAM, FUNCTION_BLOCK, FUNCTION.
    Pou(Pou),
    /// TYPE ... END_TYPE.
    Types(Vec<TypeDecl>),
    /// VAR_GLOBAL (or VAR_CONFIG, VAR_ACCESS) outside of any configuration.
    Globals(VarSection),
    /// CONFIGURATION.
    Config(Configuration),
    /// An ACTION that stands outside its POU (`ACTION Pou.Name`), a CODESYS habit.
    Action(Action),
}
