//! Pragmas in bodies that look like code (semantics.md \[L6\]): sources for compilers that go through C hold statements of C in
//! `{...}`. They are not executed here, so a variable that only they assign stays as it is; the warning names those.

use crate::cx::{Cx, Unit, fold};
use crate::defs::*;
use plcc_diag::{Diagnostic, Span, codes};
use plcc_syntax::ast;
use rustc_hash::{FxHashMap, FxHashSet};

/// The warnings, and the variables that they name. `written` are the variables that bodies write.
pub(crate) fn find(cx: &Cx<'_>, units: &[Unit<'_>], written: &FxHashSet<VarId>) -> (Vec<Diagnostic>, FxHashSet<VarId>) {
    let pous: FxHashMap<Span, PouId> = cx.defs.pous.iter_enumerated().map(|(id, pou)| (pou.span, id)).collect();
    let mut warnings = Vec::new();
    let mut named = FxHashSet::default();
    for unit in units.iter().filter(|u| !u.builtin) {
        for pragma in unit.ast.pragmas.iter().filter(|p| looks_like_code(&p.text)) {
            let owner = unit.ast.items.iter().find_map(|item| owner_of(item, pragma));
            let Some(owner) = owner.and_then(|name| pous.get(&name)) else { continue };
            let pou = cx.defs.pous[*owner].owner.unwrap_or(*owner);
            let unset = mentioned(cx, pou, &pragma.text).filter(|v| !written.contains(v)).collect::<Vec<_>>();
            warnings.push(warning(cx, pragma, &unset));
            named.extend(unset);
        }
    }
    (warnings, named)
}

/// `;`, or `=` that does not belong to `:=`.
fn looks_like_code(text: &str) -> bool {
    let bytes = text.as_bytes();
    let foreign = |at: usize| bytes[at] == b'=' && (at == 0 || bytes[at - 1] != b':');
    bytes.contains(&b';') || (0..bytes.len()).any(foreign)
}

/// Where the POU or action is named in whose body a pragma stands: behind the declarations.
fn owner_of(item: &ast::Item, pragma: &ast::Pragma) -> Option<Span> {
    let at = pragma.span.start;
    match item {
        ast::Item::Pou(pou) => {
            let declared = pou.sections.last().map_or(pou.name.span.end, |s| s.span.end);
            (pou.span.file == pragma.span.file && (declared..pou.span.end).contains(&at)).then_some(pou.name.span)
        }
        ast::Item::Action(action) => (action.name.span.end..action.span.end).contains(&at).then_some(action.name.span),
        _ => None,
    }
}

/// The variables of a POU whose names stand in a text, in the order of their declaration. Inputs come from outside.
fn mentioned<'c>(cx: &'c Cx<'_>, pou: PouId, text: &str) -> impl Iterator<Item = VarId> + 'c {
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let words: FxHashSet<_> = text.split(|c| !is_name(c)).map(fold).collect();
    let vars = cx.defs.pous[pou].vars.iter().copied();
    vars.filter(move |id| {
        let var = &cx.defs.vars[*id];
        let own = matches!(var.section, Section::Local | Section::Temp | Section::Output | Section::Result);
        own && !var.constant && words.contains(&fold(&var.name))
    })
}

fn warning(cx: &Cx<'_>, pragma: &ast::Pragma, unset: &[VarId]) -> Diagnostic {
    let names: Vec<String> = unset.iter().map(|v| format!("`{}`", cx.defs.vars[*v].name)).collect();
    let message = match names.as_slice() {
        [] => "foreign code is not executed".to_string(),
        [one] => format!("foreign code is not executed: {one} stays unset"),
        [all @ .., last] => format!("foreign code is not executed: {} and {last} stay unset", all.join(", ")),
    };
    let mut warning = Diagnostic::new(codes::FOREIGN_CODE, pragma.span, message);
    for id in unset {
        warning = warning.also(cx.defs.vars[*id].span, "nothing else assigns it");
    }
    warning.help("write it in Structured Text, or replace this POU by one of your own")
}

#[cfg(test)]
mod tests {
    use super::looks_like_code;

    #[test]
    fn code_and_attributes() {
        for code in ["x = 1", "f();", "x == 1", "= ", "a := b; c"] {
            assert!(looks_like_code(code), "{code}");
        }
        for attribute in [
            "",
            "attribute 'qualified_only'",
            "attribute 'x' := 'y'",
            "sfc_firing := 'strong'",
            "warning disable C0195",
        ] {
            assert!(!looks_like_code(attribute), "{attribute}");
        }
    }
}
