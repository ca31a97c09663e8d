//! The standard function blocks: ST sources that are compiled with each project.
//!
//! Typed variants (`CTU_DINT`, `TON_LTIME`) are the plain block with its type and limits exchanged, so each body exists once.

use crate::elem::Elem;
use std::sync::LazyLock;

/// A block that is written out in `stdlib/blocks`.
macro_rules! plain {
    ($($name:literal),*) => { [$(($name, include_str!(concat!("../blocks/", $name, ".st")))),*] };
}

/// The source of the blocks that a chart uses and users do not see: all FUNCTION_BLOCKs of this one.
const ACTION_CONTROL: &str = "ACTION_CONTROL";

/// Whether a block that is part of plcc cannot be named by users: their own of this name hides nothing.
pub fn is_internal(name: &str) -> bool {
    name.starts_with("ACTION_")
}

/// Every standard function block: its name and its source, one FUNCTION_BLOCK each, but for the parts of ACTION_CONTROL.
pub fn blocks() -> &'static [(&'static str, &'static str)] {
    static BLOCKS: LazyLock<Vec<(&str, &str)>> = LazyLock::new(|| {
        let plain = plain![
            "SR",
            "RS",
            "SEMA",
            "R_TRIG",
            "F_TRIG",
            "CTU",
            "CTD",
            "CTUD",
            "TON",
            "TOF",
            "TP",
            "RTC",
            // Ed. 2 annex F.
            "HYSTERESIS",
            "LIMITS_ALARM",
            "INTEGRAL",
            "DERIVATIVE",
            "PID",
            "RAMP",
            "LAG1",
            "DELAY",
            "AVERAGE"
        ];
        let action_control = [(ACTION_CONTROL, include_str!("../blocks/ACTION_CONTROL.st"))];
        let variants = plain.iter().flat_map(|(name, source)| {
            let types: &[Elem] = match *name {
                "CTU" | "CTD" | "CTUD" => &[Elem::Int, Elem::Dint, Elem::Lint, Elem::Udint, Elem::Ulint],
                "TON" | "TOF" | "TP" => &[Elem::Time, Elem::Ltime],
                _ => &[],
            };
            types.iter().map(move |t| variant(name, source, *t))
        });
        plain.iter().copied().chain(variants).chain(action_control).collect()
    });
    &BLOCKS
}

/// The block `name` for another counter or duration type.
fn variant(name: &str, source: &str, elem: Elem) -> (&'static str, &'static str) {
    let typed = format!("{name}_{}", elem.name());
    let source = source.replace(&format!("FUNCTION_BLOCK {name}"), &format!("FUNCTION_BLOCK {typed}"));
    let source = match elem.range() {
        Some((min, max)) if elem.is_integer() => source
            .replace(": INT;", &format!(": {};", elem.name()))
            .replace("-32768", &min.to_string())
            .replace("32767", &max.to_string()),
        _ if elem == Elem::Ltime => {
            source.replace(": TIME;", ": LTIME;").replace("TIME()", "LTIME()").replace("T#0s", "LTIME#0s")
        }
        _ => source,
    };
    (typed.leak(), source.leak())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(name: &str) -> &'static str {
        blocks().iter().find(|(n, _)| *n == name).unwrap_or_else(|| panic!("{name}")).1
    }

    #[test]
    fn each_block_declares_its_own_name_once() {
        for (name, source) in blocks() {
            assert_eq!(source.matches(&format!("\nFUNCTION_BLOCK {name}\n")).count(), 1, "{name}");
            assert_eq!(blocks().iter().filter(|(n, _)| n == name).count(), 1, "{name}");
        }
        assert_eq!(blocks().len(), 21 + 3 * 5 + 3 * 2 + 1);
    }

    #[test]
    fn variants_have_their_type_and_limits() {
        let ctud = source("CTUD_LINT");
        assert!(ctud.contains("CV > -9223372036854775808") && ctud.contains("CV < 9223372036854775807"));
        assert!(ctud.contains("PV : LINT;") && !ctud.contains(": INT;"));
        assert!(source("CTD_UDINT").contains("CV > 0 "));
        let ton = source("TON_LTIME");
        assert!(ton.contains("start := LTIME();") && ton.contains("PT : LTIME;") && !ton.contains(" T#"));
    }
}
