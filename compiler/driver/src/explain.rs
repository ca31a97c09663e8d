//! `plcc explain`: a diagnostic code, a standard function, a standard function block, an operator of Instruction List.

use crate::failure::Failure;
use plcc_hir::specials;
use plcc_stdlib::{blocks, funcs};
use plcc_syntax::il_operators;

/// The page for a name.
pub fn page(name: &str) -> Result<String, Failure> {
    let upper = name.to_ascii_uppercase();
    if let Some(info) = plcc_diag::codes::find(&upper) {
        return Ok(format!("{}: {}\n\n{}", info.code, info.title, info.page));
    }
    // `ADD` is a function and an operator of IL.
    let pages: Vec<String> =
        [function(&upper), special(&upper), block(&upper), operator(&upper)].into_iter().flatten().collect();
    if !pages.is_empty() {
        return Ok(pages.join("\n"));
    }
    let block_names = blocks::blocks().iter().map(|(n, _)| *n);
    let operators = il_operators::OPERATORS.iter().map(|o| o.name);
    let names = plcc_diag::codes::all().map(|c| c.info().code).chain(funcs::names()).chain(block_names);
    let names = names.chain(specials::SPECIALS.iter().map(|row| row.name));
    let names = names.chain(operators).chain(il_operators::INPUT_OPERATORS.iter().map(|o| o.name));
    let hint = plcc_hir::similar(&upper, names).map(|n| format!("; did you mean `{n}`?")).unwrap_or_default();
    Err(Failure::usage(format!("nothing is known about `{name}`{hint}")))
}

fn function(name: &str) -> Option<String> {
    let func = funcs::find(name)?;
    let clause =
        if func.clause.is_empty() { String::new() } else { format!("\nStandard: IEC 61131-3 {}.\n", func.clause) };
    Some(format!("{}\n\n{}\n{clause}", func.signature(), func.doc))
}

fn special(name: &str) -> Option<String> {
    let row = specials::find(name)?;
    let standard = if row.clause.starts_with("Ed.") { "IEC 61131-3 " } else { "no, a form of " };
    Some(format!("{}\n\n{}\n\nStandard: {standard}{}.\n", row.signature, row.doc, row.clause))
}

fn block(name: &str) -> Option<String> {
    let (_, text) = blocks::blocks().iter().find(|(n, _)| *n == name)?;
    Some(format!("Standard function block {name}, as it is compiled into every project:\n\n{}\n", text.trim()))
}

/// An operator of Instruction List, or an input operator, or both.
fn operator(name: &str) -> Option<String> {
    let mut page = String::new();
    if let Some(operator) = il_operators::find(name) {
        page = format!(
            "{name}: operator of Instruction List\n\n{}\n\nOperand: {}.\nCurrent result: {}.\nStandard: IEC 61131-3 {}.\n",
            operator.does, operator.operand, operator.result, operator.clause
        );
    }
    if let Some(input) = il_operators::find_input(name) {
        let gap = if page.is_empty() { "" } else { "\n" };
        page += &format!(
            "{gap}{name}: input operator of Instruction List\n\nStores the current result in the input {name} of an \
             instance and calls it: `{name} t` is `ST t.{name}`, then `CAL t`.\n\nOperand: an instance with that input \
             ({}).\nCurrent result: leaves it as it is.\nStandard: IEC 61131-3 {}.\n",
            input.of,
            il_operators::INPUT_CLAUSE
        );
    }
    (!page.is_empty()).then_some(page)
}
