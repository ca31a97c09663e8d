//! Functions that take a variable or a type and not its value: no rows of the function table, the checker computes them.
//! One row each; `plcc explain` and the manual print it.

/// Which.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Special {
    /// `REF(x)`, `ADR(x)`.
    Reference { pointer: bool },
    /// `SIZEOF(x)`, of a variable or a type.
    SizeOf,
    /// `LOWER_BOUND(a, 1)`, `UPPER_BOUND(a, 1)`.
    Bound { upper: bool },
    /// `__ISVALIDREF(r)`.
    IsValidRef,
}

/// A row.
#[derive(Debug)]
pub struct SpecialFn {
    /// In upper case.
    pub name: &'static str,
    /// What it takes and gives.
    pub signature: &'static str,
    /// What it is for.
    pub doc: &'static str,
    /// Where it comes from.
    pub clause: &'static str,
    pub(crate) special: Special,
}

/// All of them.
pub const SPECIALS: &[SpecialFn] = &[
    SpecialFn {
        name: "REF",
        signature: "REF(variable) : REF_TO its type",
        doc: "The reference to a variable, an element or a component; not to a bit, a CONSTANT or the result of a call.",
        clause: "Ed. 3 6.4.4.10",
        special: Special::Reference { pointer: false },
    },
    SpecialFn {
        name: "ADR",
        signature: "ADR(variable) : POINTER TO its type",
        doc: "The same as a pointer, which has arithmetic in bytes and converts to and from DWORD, LWORD, UDINT and ULINT.",
        clause: "CODESYS",
        special: Special::Reference { pointer: true },
    },
    SpecialFn {
        name: "SIZEOF",
        signature: "SIZEOF(variable or type) : a constant",
        doc: "The size in bytes; of a STRING[n] n + 1, of TIME and dates 8, of a reference 4.",
        clause: "CODESYS",
        special: Special::SizeOf,
    },
    SpecialFn {
        name: "LOWER_BOUND",
        signature: "LOWER_BOUND(array, dimension) : DINT",
        doc: "The lower bound of a dimension, from 1; of an ARRAY [*] that of the array of this call, else a constant.",
        clause: "Ed. 3 6.5.3",
        special: Special::Bound { upper: false },
    },
    SpecialFn {
        name: "UPPER_BOUND",
        signature: "UPPER_BOUND(array, dimension) : DINT",
        doc: "The upper bound of a dimension, from 1; of an ARRAY [*] that of the array of this call, else a constant.",
        clause: "Ed. 3 6.5.3",
        special: Special::Bound { upper: true },
    },
    SpecialFn {
        name: "__ISVALIDREF",
        signature: "__ISVALIDREF(reference) : BOOL",
        doc: "Whether a REFERENCE TO refers to a variable (profile codesys).",
        clause: "CODESYS",
        special: Special::IsValidRef,
    },
];

/// The row of a name in upper case.
pub fn find(name: &str) -> Option<&'static SpecialFn> {
    SPECIALS.iter().find(|row| row.name == name)
}
