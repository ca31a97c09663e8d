//! What IEC 61131-3 has for names and forms of other languages: the help for them.

/// What IEC 61131-3 has for a function of another language, by its folded name.
pub fn foreign_function(name: &str) -> Option<&'static str> {
    Some(match name {
        "POW" | "POWER" => "a power is written `x ** y` or EXPT(x, y)",
        "SQR" | "SQUARE" => "a square is written `x * x`, a square root SQRT(x)",
        "STRLEN" | "LENGTH" => "the length of a text is LEN(s)",
        "SUBSTR" | "SUBSTRING" => "a part of a text is MID(s, length, position), LEFT or RIGHT",
        "CEILING" => "the next greater integer is CEIL(x)",
        "FABS" => "the absolute value is ABS(x)",
        "PRINT" | "PRINTF" | "PUTS" | "WRITELN" | "ECHO" => {
            "a program prints nothing; `--watch` and `--trace` show variables"
        }
        _ => return None,
    })
}

/// What IEC 61131-3 has for a word of another language.
pub fn foreign_word(word: &str) -> Option<&'static str> {
    Some(match word.to_ascii_uppercase().as_str() {
        "BREAK" => "a branch of a CASE ends before the next value; EXIT leaves a loop",
        "DEFAULT" | "OTHERS" | "OTHERWISE" => "all other values of a CASE stand behind ELSE, without `:`",
        "NIL" | "NULLPTR" | "NONE" => "a reference to nothing is NULL",
        "RETURN" | "RESULT" => "a function gives its value by its name: `Name := value;`",
        "THIS" | "SELF" => "inside a POU its variables are named alone",
        word => {
            let digits = word.strip_prefix("TIME").or(word.strip_prefix('T'))?;
            let unit = digits.trim_start_matches(|c: char| c.is_ascii_digit());
            let duration = unit.len() < digits.len() && matches!(unit, "D" | "H" | "M" | "S" | "MS" | "US" | "NS");
            return duration.then_some("a duration is written with `#`: `T#5s`");
        }
    })
}

/// For an array that is written like a call.
pub fn element_help(array: &str) -> String {
    format!("an element of an array is written `{array}[...]`")
}
