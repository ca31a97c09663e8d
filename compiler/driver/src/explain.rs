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
        let clause = if func.clause.is_empty() { String::new() } else { format!("\nStandard: IEC 61131-3 {}.\n", func.clause) };
        return Ok(format!("{}\n\n{}\n{clause}", func.signature(), func.doc));
    }
    if let Some(text) = block(&upper) {
        return Ok(format!("Standard function block {upper}, as it is compiled into every project:\n\n{text}\n"));
    }
    let block_names: Vec<String> = block_names();
    let names = plcc_diag::codes::ALL.iter().map(|c| c.info().code).chain(funcs::names()).chain(block_names.iter().map(String::as_str));
    let hint = plcc_hir::similar(&upper, names).map(|n| format!("; did you mean `{n}`?")).unwrap_or_default();
    Err(Failure::usage(format!("nothing is known about `{name}`{hint}")))
}

fn block_names() -> Vec<String> {
    let headers = blocks::sources().iter().flat_map(|(_, text)| text.lines());
    headers.filter_map(|l| l.strip_prefix("FUNCTION_BLOCK ")).map(|n| n.trim().to_string()).collect()
}

/// The text of one block with the comment in front of it.
fn block(name: &str) -> Option<String> {
    for (_, text) in blocks::sources() {
        let lines: Vec<&str> = text.lines().collect();
        let Some(start) = lines.iter().position(|l| l.strip_prefix("FUNCTION_BLOCK ").is_some_and(|n| n.trim() == name)) else {
            continue;
        };
        let end = start + lines[start..].iter().position(|l| *l == "END_FUNCTION_BLOCK")?;
        let comment = lines[..start].iter().rev().take_while(|l| !l.trim().is_empty()).count();
        return Some(lines[start - comment..=end].join("\n"));
    }
    None
}
