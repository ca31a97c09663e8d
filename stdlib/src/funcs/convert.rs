//! Conversion functions `A_TO_B`, `TO_B`, `TRUNC_B`, `A_TRUNC_B` (Ed. 2 table 22, Ed. 3 tables 22 to 27).

use super::*;
use crate::elem::ALL;

/// A type's names in conversion functions, long forms included.
pub(super) fn spellings(elem: Elem) -> Vec<&'static str> {
    match elem {
        Elem::Tod => vec!["TOD", "TIME_OF_DAY"],
        Elem::Ltod => vec!["LTOD", "LTIME_OF_DAY"],
        Elem::Dt => vec!["DT", "DATE_AND_TIME"],
        Elem::Ldt => vec!["LDT", "LDATE_AND_TIME"],
        other => vec![other.name()],
    }
}

pub(super) fn rows() -> Vec<StdFn> {
    let clause = "Ed. 2 table 22";
    let mut rows = Vec::new();
    for to in ALL {
        for to_name in spellings(to) {
            let any = [("IN", Type::Var)];
            let doc = "IN as this type; see semantics T6.";
            let general =
                row(&format!("TO_{to_name}"), "Ed. 3 table 22", Generic::Elementary, &any, Meaning::Convert(to), doc);
            rows.push(general.gives(Type::Fixed(to)));
            for from in ALL {
                if !crate::convert::exists(from, to) {
                    continue;
                }
                for from_name in spellings(from) {
                    let param = [("IN", Type::Fixed(from))];
                    let meaning = Meaning::Convert(to);
                    let name = format!("{from_name}_TO_{to_name}");
                    rows.push(row(&name, clause, Generic::Elementary, &param, meaning, doc).gives(Type::Fixed(to)));
                }
            }
        }
        if to.is_integer() {
            let doc = "The integral part of IN, toward zero.";
            let meaning = Meaning::Integral(PrimOp::FTrunc);
            let named = row(&format!("TRUNC_{}", to.name()), clause, Generic::Real, &[("IN", Type::Var)], meaning, doc);
            rows.push(named.gives(Type::Fixed(to)));
            for from in [Elem::Real, Elem::Lreal] {
                let name = format!("{}_TRUNC_{}", from.name(), to.name());
                rows.push(
                    row(&name, clause, Generic::Real, &[("IN", Type::Fixed(from))], meaning, doc)
                        .gives(Type::Fixed(to)),
                );
            }
        }
    }
    rows
}
