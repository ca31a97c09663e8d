//! Functions whose place is laid but that are not built: a call says so instead of "unknown".

use super::*;
use crate::elem::ALL;

const STRINGS: [&str; 9] = ["LEN", "LEFT", "RIGHT", "MID", "CONCAT", "INSERT", "DELETE", "REPLACE", "FIND"];
const OTHERS: [&str; 3] = ["TO_STRING", "TO_WSTRING", "STRING_TO_WSTRING"];

pub(super) fn rows() -> Vec<StdFn> {
    let mut names: Vec<String> = STRINGS.iter().chain(&OTHERS).map(|n| n.to_string()).collect();
    names.push("WSTRING_TO_STRING".into());
    for elem in ALL {
        for string in ["STRING", "WSTRING"] {
            names.push(format!("{}_TO_{string}", elem.name()));
            names.push(format!("{string}_TO_{}", elem.name()));
        }
    }
    names.into_iter().map(|name| row(&name, "", Generic::Any, &[], Meaning::NotYet, "Not implemented yet.")).collect()
}
