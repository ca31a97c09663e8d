//! The elementary types of IEC 61131-3 (Ed. 3 table 10) and their facts.
//!
//! STRING and WSTRING are not here: they have a capacity and live in memory only.

use crate::prim::Repr;

/// An elementary type that fits a machine register.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
#[allow(missing_docs)]
pub enum Elem {
    Bool,
    Sint,
    Int,
    Dint,
    Lint,
    Usint,
    Uint,
    Udint,
    Ulint,
    Byte,
    Word,
    Dword,
    Lword,
    Real,
    Lreal,
    Time,
    Ltime,
    Date,
    Ldate,
    Tod,
    Ltod,
    Dt,
    Ldt,
    Char,
    Wchar,
}

/// The family of an elementary type: implicit conversions stay inside one, with few exceptions (semantics.md \[T2\]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Family {
    /// BOOL.
    Bool,
    /// SINT INT DINT LINT.
    Signed,
    /// USINT UINT UDINT ULINT.
    Unsigned,
    /// BYTE WORD DWORD LWORD.
    Bits,
    /// REAL LREAL.
    Real,
    /// TIME LTIME.
    Duration,
    /// DATE LDATE.
    Date,
    /// TOD LTOD.
    TimeOfDay,
    /// DT LDT.
    DateTime,
    /// CHAR WCHAR.
    Char,
}

use Elem::*;

/// Every elementary type, in declaration order.
pub const ALL: [Elem; 25] = [
    Bool, Sint, Int, Dint, Lint, Usint, Uint, Udint, Ulint, Byte, Word, Dword, Lword, Real, Lreal, Time, Ltime, Date,
    Ldate, Tod, Ltod, Dt, Ldt, Char, Wchar,
];

impl Elem {
    /// The keyword, upper case.
    pub fn name(self) -> &'static str {
        match self {
            Bool => "BOOL",
            Sint => "SINT",
            Int => "INT",
            Dint => "DINT",
            Lint => "LINT",
            Usint => "USINT",
            Uint => "UINT",
            Udint => "UDINT",
            Ulint => "ULINT",
            Byte => "BYTE",
            Word => "WORD",
            Dword => "DWORD",
            Lword => "LWORD",
            Real => "REAL",
            Lreal => "LREAL",
            Time => "TIME",
            Ltime => "LTIME",
            Date => "DATE",
            Ldate => "LDATE",
            Tod => "TOD",
            Ltod => "LTOD",
            Dt => "DT",
            Ldt => "LDT",
            Char => "CHAR",
            Wchar => "WCHAR",
        }
    }

    /// The type with this name (any case); knows the long names TIME_OF_DAY, LTIME_OF_DAY, DATE_AND_TIME, LDATE_AND_TIME.
    pub fn from_name(name: &str) -> Option<Elem> {
        let long = [("TIME_OF_DAY", Tod), ("LTIME_OF_DAY", Ltod), ("DATE_AND_TIME", Dt), ("LDATE_AND_TIME", Ldt)];
        ALL.iter().map(|e| (e.name(), *e)).chain(long).find(|(n, _)| n.eq_ignore_ascii_case(name)).map(|(_, e)| e)
    }

    /// Its number, for files: see [`Elem::from_code`].
    pub fn code(self) -> u8 {
        self as u8
    }

    /// The type with this number.
    pub fn from_code(code: u8) -> Option<Elem> {
        ALL.get(code as usize).copied()
    }

    /// Its family.
    pub fn family(self) -> Family {
        match self {
            Bool => Family::Bool,
            Sint | Int | Dint | Lint => Family::Signed,
            Usint | Uint | Udint | Ulint => Family::Unsigned,
            Byte | Word | Dword | Lword => Family::Bits,
            Real | Lreal => Family::Real,
            Time | Ltime => Family::Duration,
            Date | Ldate => Family::Date,
            Tod | Ltod => Family::TimeOfDay,
            Dt | Ldt => Family::DateTime,
            Char | Wchar => Family::Char,
        }
    }

    /// How it lies in memory and in registers. Times and dates are signed 64-bit nanoseconds (\[T7\]); BOOL is a byte, 0 or 1.
    pub fn repr(self) -> Repr {
        match self {
            Bool | Sint | Usint | Byte | Char => Repr::I8,
            Int | Uint | Word | Wchar => Repr::I16,
            Dint | Udint | Dword => Repr::I32,
            Lint | Ulint | Lword => Repr::I64,
            Real => Repr::F32,
            Lreal => Repr::F64,
            Time | Ltime | Date | Ldate | Tod | Ltod | Dt | Ldt => Repr::I64,
        }
    }

    /// Bits of information: 1 for BOOL, else the width of the representation.
    pub fn bits(self) -> u32 {
        if self == Bool { 1 } else { self.repr().bytes() * 8 }
    }

    /// Size in memory, bytes.
    pub fn bytes(self) -> u32 {
        self.repr().bytes()
    }

    /// Whether its order and its extension are those of a signed number (integers, times, dates).
    pub fn is_signed(self) -> bool {
        !matches!(self.family(), Family::Bool | Family::Unsigned | Family::Bits | Family::Char)
    }

    /// SINT..LINT, USINT..ULINT.
    pub fn is_integer(self) -> bool {
        matches!(self.family(), Family::Signed | Family::Unsigned)
    }

    /// REAL, LREAL.
    pub fn is_real(self) -> bool {
        self.family() == Family::Real
    }

    /// BYTE..LWORD (not BOOL).
    pub fn is_bits(self) -> bool {
        self.family() == Family::Bits
    }

    /// TIME, LTIME and every date type: stored as 64-bit nanoseconds.
    pub fn is_time_like(self) -> bool {
        matches!(self.family(), Family::Duration | Family::Date | Family::TimeOfDay | Family::DateTime)
    }

    /// Smallest and greatest value of an integer, bit string, time, date or BOOL type; `None` for reals.
    pub fn range(self) -> Option<(i128, i128)> {
        if self.is_real() {
            return None;
        }
        if self == Bool {
            return Some((0, 1));
        }
        let bits = self.bits();
        Some(if self.is_signed() {
            (-(1i128 << (bits - 1)), (1i128 << (bits - 1)) - 1)
        } else {
            (0, (1i128 << bits) - 1)
        })
    }

    /// A register value (zero-extended) as a mathematical integer. Meaningless for reals.
    pub fn to_i128(self, raw: u64) -> i128 {
        if self.is_signed() { i128::from(self.repr().sign_extend(raw)) } else { i128::from(raw) }
    }
}

/// Generic types of the standard (Ed. 3 figure 5), for parameters of standard functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Generic {
    Any,
    Elementary,
    /// ANY_NUM and ANY_DURATION.
    Magnitude,
    Num,
    Int,
    Signed,
    Real,
    /// BOOL and the bit strings.
    Bit,
    /// BYTE to LWORD: the standard's ANY_BIT without BOOL.
    BitString,
    Duration,
    Date,
    /// STRING, WSTRING, CHAR, WCHAR.
    Chars,
    String,
}

impl Generic {
    /// ANY_NUM and so on, for messages.
    pub fn name(self) -> &'static str {
        match self {
            Generic::Any => "ANY",
            Generic::Elementary => "ANY_ELEMENTARY",
            Generic::Magnitude => "ANY_MAGNITUDE",
            Generic::Num => "ANY_NUM",
            Generic::Int => "ANY_INT",
            Generic::Signed => "ANY_SIGNED",
            Generic::Real => "ANY_REAL",
            Generic::Bit | Generic::BitString => "ANY_BIT",
            Generic::Duration => "ANY_DURATION",
            Generic::Date => "ANY_DATE",
            Generic::Chars => "ANY_CHARS",
            Generic::String => "ANY_STRING",
        }
    }

    /// Whether an elementary type belongs to it. (STRING and WSTRING belong to `Any`, `Elementary`, `Chars`, `String`.)
    pub fn contains(self, elem: Elem) -> bool {
        match self {
            Generic::Any | Generic::Elementary => true,
            Generic::Magnitude => elem.is_integer() || elem.is_real() || elem.family() == Family::Duration,
            Generic::Num => elem.is_integer() || elem.is_real(),
            Generic::Int => elem.is_integer(),
            Generic::Signed => elem.family() == Family::Signed,
            Generic::Real => elem.is_real(),
            Generic::Bit => elem == Bool || elem.is_bits(),
            Generic::BitString => elem.is_bits(),
            Generic::Duration => elem.family() == Family::Duration,
            Generic::Date => matches!(elem.family(), Family::Date | Family::TimeOfDay | Family::DateTime),
            Generic::Chars => elem.family() == Family::Char,
            Generic::String => false,
        }
    }
}
