//! Text to syntax tree. It knows no types and resolves no names.
//!
//! In: the text of one file. Out: an [`ast::File`] and messages; a mistake leaves error nodes and never ends the parse. The way
//! is `lexer` (text to tokens), `blocks` (tokens to balanced items), `grammar` (one item to its tree), with `recover` mending
//! the tokens where the grammar refuses them.

pub mod ast;
mod blocks;
mod construct;
pub mod il_operators;
mod lexer;
mod recover;
mod report;
mod token;
mod xml;

#[allow(missing_docs, clippy::all, unused_imports, unused_parens)]
mod grammar {
    include!(concat!(env!("OUT_DIR"), "/grammar.rs"));
}

use construct::{Context, Parsed};
use plcc_diag::{Diagnostics, FileId};
use report::Reporter;
use token::{Tok, Token};

/// How strictly a source is read (semantics.md \[P1\]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Profile {
    /// The standard.
    #[default]
    Strict,
    /// Existing libraries.
    Codesys,
}

/// Parses a source file. Mistakes are reported and leave error nodes.
pub fn parse_file(file: FileId, text: &str, profile: Profile, diags: &mut Diagnostics) -> ast::File {
    let mut report = Reporter::new(file, diags);
    let lexed = lexer::lex(text, &mut report);
    let slices = blocks::split(text, &lexed, profile, &mut report);
    let cx = Context::new(file, text);
    let mut items = Vec::with_capacity(slices.len());
    for tokens in slices {
        if let Some(Parsed::Item(item)) = recover::parse(&cx, tokens, &mut report) {
            items.push(*item);
        }
    }
    let (doubtful, unnamed) = report.doubtful(text, &lexed.tokens);
    ast::File { items, pragmas: lexed.pragmas, doubtful, unnamed, places: Vec::new() }
}

/// Reads a PLCopen TC6 XML file. Mistakes are reported and leave error nodes.
pub use xml::parse_xml;
/// A part of an XML file as the text that it stands for: without markup, with characters for their references.
pub use xml::plain_text;

/// Parses an expression that stands alone, such as a watch. `None` if it is none; reported then.
pub fn parse_expression(file: FileId, text: &str, diags: &mut Diagnostics) -> Option<ast::Expr> {
    let mut report = Reporter::new(file, diags);
    let mut tokens = lexer::lex(text, &mut report).tokens;
    tokens.insert(0, Token::inserted(Tok::StartExpr, 0));
    match recover::parse(&Context::new(file, text), tokens, &mut report)? {
        Parsed::Expr(e) => Some(*e),
        _ => None,
    }
}

/// Parses a body that stands alone, as in PLCopen XML: the body and the ACTIONs in it. The span of a node counts from the start
/// of `text`.
pub fn parse_body(
    file: FileId,
    text: &str,
    profile: Profile,
    diags: &mut Diagnostics,
) -> (ast::Body, Vec<ast::Action>) {
    let mut report = Reporter::new(file, diags);
    let lexed = lexer::lex(text, &mut report);
    let tokens = blocks::body(text, 0, None, &lexed, profile, &mut report);
    match recover::parse(&Context::new(file, text), tokens, &mut report) {
        Some(Parsed::Body(body)) => *body,
        _ => (ast::Body::St(Vec::new()), Vec::new()),
    }
}

/// A part of a source without its comments and pragmas, for drawings: tokens as written, one blank or line end where there was
/// any space between them.
pub fn without_comments(file: FileId, text: &str) -> String {
    let mut diags = Diagnostics::new();
    let lexed = lexer::lex(text, &mut Reporter::new(file, &mut diags));
    let mut out = String::new();
    let mut end = None;
    for token in &lexed.tokens {
        let start = token.start as usize;
        if let Some(gap) = end.and_then(|end| text.get(end..start)).filter(|gap| !gap.is_empty()) {
            out.push(if gap.contains('\n') { '\n' } else { ' ' });
        }
        let written = token.text(text);
        out.push_str(written);
        end = Some(start + written.len());
    }
    out
}

/// The tokens of a source, one line of text per line of the source, for `--emit tokens`.
pub fn print_tokens(file: FileId, text: &str) -> String {
    let mut diags = Diagnostics::new();
    let mut report = Reporter::new(file, &mut diags);
    let lexed = lexer::lex(text, &mut report);
    let mut out = String::new();
    let (mut line, mut counted) = (1, 0);
    for t in &lexed.tokens {
        if t.first {
            line += text[counted..t.start as usize].matches('\n').count();
            counted = t.start as usize;
            let gap = if out.is_empty() { "" } else { "\n" };
            out.push_str(&format!("{gap}{line}:"));
        }
        let written = t.text(text);
        match t.kind {
            Tok::Id => out.push_str(&format!(" name `{written}`")),
            Tok::Int | Tok::Lit => out.push_str(&format!(" literal `{written}`")),
            Tok::Qualified | Tok::Address | Tok::Part | Tok::Bad => {
                let kind = t.kind.describe().split_once(' ').map_or("", |(_, noun)| noun);
                out.push_str(&format!(" {kind} `{written}`"));
            }
            _ => out.push_str(&format!(" {written}")),
        }
    }
    out.push('\n');
    out
}
