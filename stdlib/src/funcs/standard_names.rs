//! The names of all functions that the standard has, table by table, written down beside the rows: a test says which is missing.
//!
//! Ed. 2 is IEC 61131-3:2003 tables 22 to 31, Ed. 3 is 61131-3:2013 tables 22 to 39. REF, `?=` and the bounds of arrays are no
//! functions of values and no rows.

use super::find;

const SIGNED: [&str; 4] = ["SINT", "INT", "DINT", "LINT"];
const UNSIGNED: [&str; 4] = ["USINT", "UINT", "UDINT", "ULINT"];
const REALS: [&str; 2] = ["REAL", "LREAL"];
const BITS: [&str; 4] = ["BYTE", "WORD", "DWORD", "LWORD"];
const DATES: [&str; 6] = ["DATE", "LDATE", "TOD", "LTOD", "DT", "LDT"];
const LONG_NAMES: [&str; 4] = ["TIME_OF_DAY", "DATE_AND_TIME", "LTIME_OF_DAY", "LDATE_AND_TIME"];

fn integers() -> Vec<&'static str> {
    [SIGNED, UNSIGNED].concat()
}

fn numbers() -> Vec<&'static str> {
    [&integers()[..], &REALS].concat()
}

fn bits() -> Vec<&'static str> {
    [&["BOOL"], &BITS[..]].concat()
}

fn durations() -> Vec<&'static str> {
    vec!["TIME", "LTIME"]
}

/// Without strings and characters, which have less to do.
fn elementary() -> Vec<&'static str> {
    [numbers(), bits(), durations(), DATES.to_vec(), LONG_NAMES.to_vec()].concat()
}

fn texts() -> [&'static str; 2] {
    ["STRING", "WSTRING"]
}

/// A name and its typed forms.
fn typed(out: &mut Vec<String>, names: &[&str], types: &[&str]) {
    for name in names {
        out.push(name.to_string());
        out.extend(types.iter().map(|t| format!("{name}_{t}")));
    }
}

fn numeric(out: &mut Vec<String>) {
    // Ed. 2 tables 23 and 24, Ed. 3 tables 28 and 29.
    typed(out, &["ABS"], &numbers());
    typed(out, &["SQRT", "LN", "LOG", "EXP", "SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN", "ATAN2"], &REALS);
    typed(out, &["ADD", "SUB"], &[numbers(), durations()].concat());
    typed(out, &["MUL", "DIV"], &numbers());
    typed(out, &["MOD"], &integers());
    typed(out, &["EXPT"], &REALS);
}

fn bit_strings(out: &mut Vec<String>) {
    // Ed. 2 tables 25 and 26, Ed. 3 tables 30 and 31.
    typed(out, &["SHL", "SHR", "ROL", "ROR"], &BITS);
    typed(out, &["AND", "OR", "XOR", "NOT"], &bits());
}

fn selection(out: &mut Vec<String>) {
    // Ed. 2 tables 27 and 28, Ed. 3 tables 32 and 33. The typed form of MUX names two types.
    let selected = [&elementary()[..], &texts()].concat();
    typed(out, &["SEL", "MAX", "MIN", "LIMIT", "GT", "GE", "EQ", "LE", "LT", "NE", "MOVE"], &selected);
    out.push("MUX".into());
    for k in integers() {
        out.extend(selected.iter().map(|t| format!("MUX_{k}_{t}")));
    }
}

fn strings(out: &mut Vec<String>) {
    // Ed. 2 table 29, Ed. 3 tables 27 and 34.
    let names = "LEN LEFT RIGHT MID CONCAT INSERT DELETE REPLACE FIND STRING_TO_WSTRING WSTRING_TO_STRING \
                 STRING_TO_CHAR CHAR_TO_STRING WSTRING_TO_WCHAR WCHAR_TO_WSTRING CHAR_TO_WCHAR WCHAR_TO_CHAR";
    out.extend(names.split(' ').map(str::to_string));
    for text in texts() {
        out.push(format!("TO_{text}"));
        for elem in elementary() {
            out.push(format!("{elem}_TO_{text}"));
            out.push(format!("{text}_TO_{elem}"));
        }
    }
}

fn times(out: &mut Vec<String>) {
    // Ed. 2 table 30, Ed. 3 tables 35 and 36.
    let both =
        |name: &str| [name.to_string(), name.replace("TIME", "LTIME").replace("TOD", "LTOD").replace("DT", "LDT")];
    for name in ["ADD_TIME", "ADD_TOD_TIME", "ADD_DT_TIME", "SUB_TIME", "SUB_TOD_TIME", "SUB_TOD_TOD", "SUB_DT_TIME"] {
        out.extend(both(name));
    }
    out.extend(both("SUB_DT_DT"));
    let others = [
        "SUB_DATE_DATE SUB_LDATE_LDATE MULTIME DIVTIME MUL_TIME DIV_TIME MUL_LTIME DIV_LTIME",
        "CONCAT_DATE_TOD CONCAT_DATE_LTOD CONCAT_LDATE_TOD CONCAT_LDATE_LTOD",
        "CONCAT_DATE CONCAT_LDATE CONCAT_TOD CONCAT_LTOD CONCAT_DT CONCAT_LDT",
        "SPLIT_DATE SPLIT_LDATE SPLIT_TOD SPLIT_LTOD SPLIT_DT SPLIT_LDT DAY_OF_WEEK",
        "DATE_AND_TIME_TO_TIME_OF_DAY DATE_AND_TIME_TO_DATE DT_TO_TOD DT_TO_DATE",
        "LTIME_TO_TIME TIME_TO_LTIME LDT_TO_DT LDT_TO_DATE LDT_TO_LTOD LDT_TO_TOD",
        "DT_TO_LDT DT_TO_LTOD LTOD_TO_TOD TOD_TO_LTOD",
    ];
    out.extend(others.iter().flat_map(|line| line.split(' ')).map(str::to_string));
}

fn conversions(out: &mut Vec<String>) {
    // Ed. 2 table 22, Ed. 3 tables 22 to 25.
    let plain = [numbers(), bits()].concat();
    for to in &plain {
        out.push(format!("TO_{to}"));
        out.extend(plain.iter().map(|from| format!("{from}_TO_{to}")));
    }
    for to in integers() {
        out.push(format!("TRUNC_{to}"));
        out.extend(REALS.iter().map(|from| format!("{from}_TRUNC_{to}")));
        out.extend(BITS.iter().map(|from| format!("{from}_BCD_TO_{to}")));
        out.extend(BITS.iter().map(|bits| format!("{to}_TO_BCD_{bits}")));
        out.push(format!("BCD_TO_{to}"));
        out.push(format!("{to}_TO_BCD"));
    }
    out.extend(BITS.iter().map(|bits| format!("TO_BCD_{bits}")));
    out.push("TRUNC".into());
}

fn others(out: &mut Vec<String>) {
    // Ed. 3 tables 37 and 39.
    let names = "TO_BIG_ENDIAN TO_LITTLE_ENDIAN FROM_BIG_ENDIAN FROM_LITTLE_ENDIAN IS_VALID IS_VALID_BCD";
    out.extend(names.split(' ').map(str::to_string));
}

#[test]
fn none_is_missing() {
    let mut names = Vec::new();
    numeric(&mut names);
    bit_strings(&mut names);
    selection(&mut names);
    strings(&mut names);
    times(&mut names);
    conversions(&mut names);
    others(&mut names);
    let missing: Vec<&String> = names.iter().filter(|n| find(n).is_none()).collect();
    assert!(missing.is_empty(), "{} of {} names have no row: {missing:?}", missing.len(), names.len());
}

#[test]
fn each_row_says_where_it_comes_from_and_what_it_does() {
    for name in super::names() {
        let row = find(name).expect("a row by its name");
        assert_eq!(row.name, name);
        assert!(!row.clause.is_empty() && row.doc.ends_with('.'), "{name}");
        assert!(row.signature().starts_with(&format!("{name}(")), "{name}");
    }
}
