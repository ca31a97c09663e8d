//! Expressions.

use super::Context;
use crate::ast::*;
use crate::lexer::{FILLER, is_date_prefix, is_duration_prefix};
use plcc_diag::Span;
use smol_str::SmolStr;

impl Context<'_> {
    /// A node whose deepest child has depth `below`.
    fn expr(&self, kind: ExprKind, below: u32, l: u32, r: u32) -> Expr {
        let span = self.span(l, r);
        if self.cut(below + 1, span) {
            return Expr { kind: ExprKind::Error, span, depth: 1, parens: false };
        }
        Expr { kind, span, depth: below + 1, parens: false }
    }

    /// What was reported already.
    pub fn bad(&self, l: u32, r: u32) -> Expr {
        self.expr(ExprKind::Error, 0, l, r)
    }

    /// A name alone.
    pub fn name_expr(&self, name: Name) -> Expr {
        Expr { span: name.span, kind: ExprKind::Name(name), depth: 1, parens: false }
    }

    /// An address in an expression.
    pub fn address_expr(&self, l: u32, r: u32) -> Expr {
        self.expr(ExprKind::Address(self.slice(l, r).into()), 0, l, r)
    }

    /// A literal with or without prefix.
    pub fn literal(&self, l: u32, r: u32) -> Expr {
        let text = self.slice(l, r);
        let plain = |kind, text: &str| Literal { kind, prefix: None, text: text.into() };
        let literal = match text.find('#') {
            Some(hash) if !text.as_bytes()[0].is_ascii_digit() && !matches!(text.as_bytes()[0], b'\'' | b'"') => {
                let (prefix, rest) = (&text[..hash], &text[hash + 1..]);
                let kind = if is_duration_prefix(prefix) {
                    LiteralKind::Duration
                } else if is_date_prefix(prefix) {
                    LiteralKind::Date
                } else {
                    plain_kind(rest.trim_start_matches(['+', '-']))
                };
                let name = self.name(l, l + hash as u32);
                Literal { kind, prefix: Some(name), text: rest.into() }
            }
            _ if text.as_bytes().contains(&FILLER) => plain(plain_kind(text), &text.replace(char::from(FILLER), "")),
            _ => plain(plain_kind(text), text),
        };
        self.expr(ExprKind::Literal(literal), 0, l, r)
    }

    /// `Color#Red`.
    pub fn qualified(&self, l: u32, r: u32) -> Expr {
        let hash = l + self.slice(l, r).find('#').unwrap_or(0) as u32;
        let kind = ExprKind::Qualified { ty: self.name(l, hash), value: self.name(hash + 1, r) };
        self.expr(kind, 0, l, r)
    }

    /// `(e)`.
    pub fn parens(&self, e: Expr, l: u32, r: u32) -> Expr {
        Expr { span: self.span(l, r), parens: true, ..e }
    }

    /// `e.n`.
    pub fn member(&self, e: Expr, n: Name, l: u32, r: u32) -> Expr {
        let depth = e.depth;
        self.expr(ExprKind::Member(Box::new(e), n), depth, l, r)
    }

    /// `e.3`, `e.%X3`; the text starts at `m`.
    pub fn part(&self, e: Expr, m: u32, l: u32, r: u32) -> Expr {
        let depth = e.depth;
        self.expr(ExprKind::Part(Box::new(e), self.name(m, r)), depth, l, r)
    }

    /// `e[i, j]`.
    pub fn index(&self, e: Expr, i: Vec<Expr>, l: u32, r: u32) -> Expr {
        let depth = i.iter().map(|x| x.depth).fold(e.depth, u32::max);
        self.expr(ExprKind::Index(Box::new(e), i), depth, l, r)
    }

    /// `e^`.
    pub fn deref(&self, e: Expr, l: u32, r: u32) -> Expr {
        let depth = e.depth;
        self.expr(ExprKind::Deref(Box::new(e)), depth, l, r)
    }

    /// `callee(args)`; the parenthesis opens at `m`.
    pub fn call(&self, callee: Expr, args: Vec<Arg>, m: u32, l: u32, r: u32) -> Expr {
        let depth = args.iter().map(arg_depth).fold(callee.depth, u32::max);
        let parens = self.span(m, r);
        self.expr(ExprKind::Call(Box::new(Call { callee, args, parens })), depth, l, r)
    }

    /// One argument.
    pub fn arg(&self, kind: ArgKind, l: u32, r: u32) -> Arg {
        Arg { kind, span: self.span(l, r) }
    }

    /// `-e`, `NOT e`.
    pub fn unary(&self, op: UnaryOp, e: Expr, l: u32, r: u32) -> Expr {
        let depth = e.depth;
        self.expr(ExprKind::Unary(op, Box::new(e)), depth, l, r)
    }

    /// `left op right`, where `left` may end in operators that bind less than the one in bytes `l..r`: those stay above it.
    pub fn binary(&self, left: Expr, l: u32, r: u32, right: Expr) -> Expr {
        let op = binary_op(self.slice(l, r));
        self.attach(left, op, self.span(l, r), right)
    }

    /// Goes down the right edge of `left` at most once per level of precedence.
    fn attach(&self, left: Expr, op: BinaryOp, at: Span, right: Expr) -> Expr {
        match left {
            Expr { kind: ExprKind::Binary(outer, outer_at, a, b), parens: false, .. }
                if outer.precedence() < op.precedence() =>
            {
                let b = self.attach(*b, op, at, right);
                self.binary_node(outer, outer_at, *a, b)
            }
            left => self.binary_node(op, at, left, right),
        }
    }

    fn binary_node(&self, op: BinaryOp, at: Span, a: Expr, b: Expr) -> Expr {
        let (depth, l, r) = (a.depth.max(b.depth), a.span.start, b.span.end);
        self.expr(ExprKind::Binary(op, at, Box::new(a), Box::new(b)), depth, l, r)
    }
}

fn arg_depth(arg: &Arg) -> u32 {
    match &arg.kind {
        ArgKind::Positional(e) | ArgKind::Input(_, Some(e)) | ArgKind::Output { target: Some(e), .. } => e.depth,
        ArgKind::Input(_, None) | ArgKind::Output { target: None, .. } => 0,
    }
}

fn plain_kind(text: &str) -> LiteralKind {
    let is = |word: &str| text.eq_ignore_ascii_case(word);
    match text.as_bytes().first() {
        Some(b'\'') => LiteralKind::String,
        Some(b'"') => LiteralKind::WString,
        Some(b'0'..=b'9') if text.contains('#') => LiteralKind::Based,
        Some(b'0'..=b'9') if text.contains(['.', 'e', 'E']) => LiteralKind::Real,
        _ if is("TRUE") || is("FALSE") => LiteralKind::Bool,
        _ if is("NULL") => LiteralKind::Null,
        _ => LiteralKind::Integer,
    }
}

/// The operator that is written (or meant by a foreign sign that was reported).
fn binary_op(text: &str) -> BinaryOp {
    use BinaryOp::*;
    match text {
        "=" | "==" => Eq,
        "+" => Add,
        "-" => Sub,
        "*" => Mul,
        "/" => Div,
        "**" => Power,
        "<" => Lt,
        ">" => Gt,
        "<=" | "=<" => Le,
        ">=" | "=>" => Ge,
        "<>" | "!=" => Ne,
        "&" | "&&" => And,
        "|" | "||" => Or,
        _ => match SmolStr::new(text.to_ascii_uppercase()).as_str() {
            "MOD" => Mod,
            "AND" => And,
            "AND_THEN" => AndThen,
            "XOR" => Xor,
            "OR_ELSE" => OrElse,
            _ => Or,
        },
    }
}
