//! `plcc explain`: a diagnostic code, a standard function, a standard function block.

use crate::failure::Failure;
use plcc_stdlib::{blocks, funcs};

/// The page for a name.
pub fn page(name: &str) -> Result<String, Failure> {
    let upper = name.to_ascii_uppercase();
    if let Some(info) = plcc_diag::codes::find(&upper) {
        return Ok(format!("{}: {}\n\n{}", info.code, info.title, info.page));
    }
    if let Some(func) = funcs::find(&upper) {
        let clause =
            if func.clause.is_empty() { String::new() } else { format!("\nStandard: IEC 61131-3 {}.\n", func.clause) };
        return Ok(format!("{}\n\n{}\n{clause}", func.signature(), func.doc));
    }
    if let Some(text) = block(&upper) {
        return Ok(format!("Standard function block {upper}, as it is compiled into every project:\n\n{text}\n"));
    }
    let block_names = blocks::blocks().iter().map(|(n, _)| *n);
    let names = plcc_diag::codes::ALL.iter().map(|c| c.info().code).chain(funcs::names()).chain(block_names);
    let hint = plcc_hir::similar(&upper, names).map(|n| format!("; did you mean `{n}`?")).unwrap_or_default();
    Err(Failure::usage(format!("nothing is known about `{name}`{hint}")))
}

/// The text of a standard function block.
fn block(name: &str) -> Option<&'static str> {
    blocks::blocks().iter().find(|(n, _)| *n == name).map(|(_, text)| text.trim())
}
