//! Functions whose place is laid but that are not built: a call says so instead of "unknown".

use super::*;
use crate::elem::ALL;

const OTHERS: [&str; 11] = [
    "SPLIT_DATE",
    "SPLIT_TOD",
    "SPLIT_DT",
    "CONCAT_DATE",
    "CONCAT_TOD",
    "CONCAT_DT",
    "IS_VALID_BCD",
    "TO_BIG_ENDIAN",
    "TO_LITTLE_ENDIAN",
    "FROM_BIG_ENDIAN",
    "FROM_LITTLE_ENDIAN",
];

pub(super) fn rows() -> Vec<StdFn> {
    let mut names: Vec<String> = OTHERS.iter().map(|n| n.to_string()).collect();
    for elem in ALL {
        if elem.is_bits() {
            for number in ALL.iter().filter(|e| e.is_integer()) {
                names.push(format!("{}_BCD_TO_{}", elem.name(), number.name()));
                names.push(format!("{}_TO_BCD_{}", number.name(), elem.name()));
            }
        }
    }
    names.into_iter().map(|name| row(&name, "", Generic::Any, &[], Meaning::NotYet, "Not implemented yet.")).collect()
}
