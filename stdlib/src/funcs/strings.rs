//! Functions of strings (Ed. 2 table 29, semantics.md \[N2\]) and conversions from and to them (\[T6\]). Their bodies are in
//! [`rt::strings`](crate::rt::strings).

use super::convert::spellings;
use super::*;
use crate::elem::ALL;
use crate::ops::Op;

/// What an operation on strings does; all strings of one operation are of one kind, but for `Recode`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextOp {
    /// LEN(IN).
    Len,
    /// LEFT(IN, L).
    Left,
    /// RIGHT(IN, L).
    Right,
    /// MID(IN, L, P).
    Mid,
    /// CONCAT(IN1, IN2, ...).
    Concat,
    /// INSERT(IN1, IN2, P).
    Insert,
    /// DELETE(IN, L, P).
    Delete,
    /// REPLACE(IN1, IN2, L, P).
    Replace,
    /// FIND(IN1, IN2).
    Find,
    /// A comparison; every neighbouring pair must hold.
    Compare(Op),
    /// The greatest.
    Max,
    /// The least.
    Min,
    /// LIMIT(MN, IN, MX).
    Limit,
    /// SEL(G, IN0, IN1).
    Sel,
    /// MUX(K, IN0, IN1, ...).
    Mux,
    /// A value of this type as text.
    Write(Elem),
    /// The value of this type with which a text begins.
    Read(Elem),
    /// The same text as the other kind of string.
    Recode,
}

impl TextOp {
    /// Whether it gives a string.
    pub fn builds(self) -> bool {
        !matches!(self, TextOp::Len | TextOp::Find | TextOp::Compare(_) | TextOp::Read(_))
    }

    /// What SEL, MAX and the others of these names mean for strings.
    pub fn of_selection(name: &str) -> Option<TextOp> {
        Some(match name {
            "SEL" => TextOp::Sel,
            "MUX" => TextOp::Mux,
            "MAX" => TextOp::Max,
            "MIN" => TextOp::Min,
            "LIMIT" => TextOp::Limit,
            _ => return None,
        })
    }

    /// The operator that a comparison function names.
    pub fn of_comparison(op: Operator) -> Option<TextOp> {
        Some(TextOp::Compare(match op {
            Operator::Eq => Op::Eq,
            Operator::Ne => Op::Ne,
            Operator::Lt => Op::Lt,
            Operator::Le => Op::Le,
            Operator::Gt => Op::Gt,
            Operator::Ge => Op::Ge,
            _ => return None,
        }))
    }
}

pub(super) fn rows() -> Vec<StdFn> {
    use Type::*;
    let int = Fixed(Elem::Int);
    let function = |name: &str, params: &[(&'static str, Type)], op, doc| {
        row(name, "Ed. 2 table 29", Generic::String, params, Meaning::Text(op), doc)
    };
    let part = [("IN", Var), ("L", Integer)];
    let place = [("IN", Var), ("L", Integer), ("P", Integer)];
    let two = [("IN1", Var), ("IN2", Var)];
    let mut rows = vec![
        function("LEN", &[("IN", Var)], TextOp::Len, "The number of characters, at most 32767.").gives(int),
        function("LEFT", &part, TextOp::Left, "The first L characters."),
        function("RIGHT", &part, TextOp::Right, "The last L characters."),
        function("MID", &place, TextOp::Mid, "L characters from position P on; '' if P is outside."),
        function("CONCAT", &[], TextOp::Concat, "The texts one behind the other.").extensible(1, 2),
        function(
            "INSERT",
            &[("IN1", Var), ("IN2", Var), ("P", Integer)],
            TextOp::Insert,
            "IN1 with IN2 behind its character P, in front if P is 0; IN1 if P is outside.",
        ),
        function("DELETE", &place, TextOp::Delete, "IN without L characters from position P on; IN if P is outside."),
        function(
            "REPLACE",
            &[("IN1", Var), ("IN2", Var), ("L", Integer), ("P", Integer)],
            TextOp::Replace,
            "IN1 with IN2 in place of L characters from position P on; IN1 if P is outside.",
        ),
        function("FIND", &two, TextOp::Find, "The position of the first IN2 in IN1; 0 if there is none, or IN2 is ''.")
            .gives(int),
    ];
    for wide in [false, true] {
        rows.extend(conversions(wide));
        rows.extend(typed_selection(wide));
    }
    rows
}

/// The typed forms of selection and comparison: `MAX_STRING`, `EQ_WSTRING`, `MUX_INT_STRING`.
fn typed_selection(wide: bool) -> Vec<StdFn> {
    let text = if wide { "WSTRING" } else { "STRING" };
    let fixed = |ty| if ty == Type::Var { Type::Text(wide) } else { ty };
    let typed = |row: &StdFn| {
        let op = match row.meaning {
            Meaning::Compare(op, _) => TextOp::of_comparison(op)?,
            // The greatest of one text is that text.
            Meaning::Move => TextOp::Max,
            _ => TextOp::of_selection(row.name.split('_').next()?)?,
        };
        Some(StdFn {
            name: format!("{}_{text}", row.name),
            params: row.params.iter().map(|p| Param { ty: fixed(p.ty), ..*p }).collect(),
            variadic: row.variadic.map(|v| Variadic { ty: fixed(v.ty), ..v }),
            generic: Generic::String,
            result: fixed(row.result),
            meaning: Meaning::Text(op),
            ..row.clone()
        })
    };
    let of_any = |row: &StdFn| matches!(row.generic, Generic::Any | Generic::Elementary);
    let rows = numeric::rows().into_iter().chain(select::rows()).filter(of_any).chain(select::mux_by_selector());
    rows.filter_map(|row| typed(&row)).collect()
}

/// From and to STRING or WSTRING.
fn conversions(wide: bool) -> Vec<StdFn> {
    let clause = "Ed. 2 table 22";
    let (text, other) = if wide { ("WSTRING", "STRING") } else { ("STRING", "WSTRING") };
    let to_text = "IN as text; see semantics T6.";
    let conversion =
        |name: &str, from, to, meaning, doc| row(name, clause, Generic::Any, &[("IN", from)], meaning, doc).gives(to);
    let any =
        row(&format!("TO_{text}"), clause, Generic::Elementary, &[("IN", Type::Var)], Meaning::ToText(wide), to_text);
    let mut rows = vec![any.gives(Type::Text(wide))];
    let recode = Meaning::Text(TextOp::Recode);
    let doc = "The same text; a character that a STRING cannot hold becomes a question mark.";
    rows.push(conversion(&format!("{other}_TO_{text}"), Type::Text(!wide), Type::Text(wide), recode, doc));
    for elem in ALL {
        for name in spellings(elem) {
            let write = Meaning::Text(TextOp::Write(elem));
            let to = format!("{name}_TO_{text}");
            rows.push(conversion(&to, Type::Fixed(elem), Type::Text(wide), write, to_text));
            let read = Meaning::Text(TextOp::Read(elem));
            let doc = "The value with which the text begins, else 0; see semantics T6.";
            let from = format!("{text}_TO_{name}");
            rows.push(conversion(&from, Type::Text(wide), Type::Fixed(elem), read, doc));
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_found() {
        assert_eq!(find("MID").unwrap().signature(), "MID(IN : ANY_STRING, L : ANY_INT, P : ANY_INT) : ANY_STRING");
        assert_eq!(find("CONCAT").unwrap().min_args(), 2);
        assert_eq!(find("TIME_OF_DAY_TO_STRING").unwrap().signature(), "TIME_OF_DAY_TO_STRING(IN : TOD) : STRING");
        assert_eq!(find("WSTRING_TO_STRING").unwrap().signature(), "WSTRING_TO_STRING(IN : WSTRING) : STRING");
        assert!(find("STRING_TO_LREAL").is_some() && find("TO_WSTRING").is_some());
    }
}
