//! A lint: STN where R was meant.

use super::lines::{Line, What};
use crate::expr::Checker;
use plcc_diag::{Diagnostic, Span, codes};
use plcc_syntax::ast;
use plcc_syntax::ast::print::print_expr;
use rustc_hash::FxHashMap;

/// `STN x` where `R x` was meant: x is set with S elsewhere, or the same current result is used with S or R.
pub(super) fn warn(c: &mut Checker, lines: &[Line]) {
    let mut set: FxHashMap<String, Span> = FxHashMap::default();
    for line in lines {
        if let What::Set { to: true, operand } = &line.what {
            set.entry(text_of(operand)).or_insert(line.span);
        }
    }
    let mut group = 0..0;
    for (n, line) in lines.iter().enumerate() {
        if !group.contains(&n) {
            let same = lines[n..].iter().take_while(|l| matches!(l.what, What::Store { .. } | What::Set { .. }));
            group = n..n + same.count().max(1);
        }
        let What::Store { negated: true, operand, .. } = &line.what else { continue };
        let beside = lines[group.clone()].iter().find(|l| matches!(l.what, What::Set { .. })).map(|l| l.span);
        let Some(other) = set.get(&text_of(operand)).copied().or(beside) else { continue };
        let name = print_expr(operand);
        c.report(
            Diagnostic::new(
                codes::STN_FOR_RESET,
                line.span,
                format!("`STN {name}` stores in each pass, also when the current result is FALSE"),
            )
            .also(other, "S and R act only when it is TRUE")
            .help(format!("to reset it on this condition write `R {name}`")),
        );
    }
}

fn text_of(operand: &ast::Expr) -> String {
    print_expr(operand).to_ascii_uppercase()
}
