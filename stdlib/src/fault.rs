//! Faults at run time (semantics.md \[E1\]..\[E4\]).

/// What can go wrong while a program runs. The number is the status word of compiled code and the result of `plc_app_scan`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Fault {
    /// Integer `/` or MOD by zero. Operands: the dividend.
    DivisionByZero = 1,
    /// Operands: index, lower bound, upper bound.
    IndexOutOfBounds = 2,
    /// Operands: value, lower limit, upper limit.
    SubrangeViolation = 3,
    /// Dereference of NULL. No operands.
    NullReference = 4,
    /// A reference outside the addressable part of the region. Operands: the offset, size of the access.
    BadReference = 5,
    /// Shift or rotation by a negative count. Operands: the count.
    NegativeShift = 6,
    /// A FOR statement whose step is 0. No operands.
    ForStepZero = 7,
    /// The task's watchdog expired inside a loop. No operands.
    Deadline = 8,
}

/// Every fault, in order of number.
pub const ALL: [Fault; 8] = [
    Fault::DivisionByZero,
    Fault::IndexOutOfBounds,
    Fault::SubrangeViolation,
    Fault::NullReference,
    Fault::BadReference,
    Fault::NegativeShift,
    Fault::ForStepZero,
    Fault::Deadline,
];

impl Fault {
    /// The fault with this number.
    pub fn from_number(number: u32) -> Option<Fault> {
        ALL.iter().copied().find(|f| *f as u32 == number)
    }

    /// Its number.
    pub fn number(self) -> u32 {
        self as u32
    }

    /// The diagnostic code, `E0601` and following.
    pub fn code(self) -> String {
        format!("E06{:02}", self as u32)
    }

    /// A few words: `division by zero`.
    pub fn title(self) -> &'static str {
        match self {
            Fault::DivisionByZero => "division by zero",
            Fault::IndexOutOfBounds => "index out of bounds",
            Fault::SubrangeViolation => "value outside its subrange",
            Fault::NullReference => "NULL reference",
            Fault::BadReference => "reference outside addressable memory",
            Fault::NegativeShift => "negative shift count",
            Fault::ForStepZero => "FOR step is zero",
            Fault::Deadline => "deadline exceeded",
        }
    }

    /// The offending values in words; `name` is the array, variable or loop that the source table names, or empty.
    pub fn details(self, name: &str, operands: [i64; 3]) -> String {
        let [a, b, c] = operands;
        let of = |what: &str| if name.is_empty() { what.to_string() } else { format!("{what} of `{name}`") };
        match self {
            Fault::DivisionByZero => format!("{a} was divided by 0"),
            Fault::IndexOutOfBounds => format!("{} is {a}, its bounds are {b}..{c}", of("index")),
            Fault::SubrangeViolation => format!("{} is {a}, allowed are {b}..{c}", of("value")),
            Fault::NullReference => format!("{} is NULL", of("reference")),
            Fault::BadReference => format!("{} points to byte {a} ({b} bytes)", of("reference")),
            Fault::NegativeShift => format!("the count is {a}"),
            Fault::ForStepZero => "the loop would never end".to_string(),
            Fault::Deadline => "the execution took longer than its watchdog allows".to_string(),
        }
    }
}
