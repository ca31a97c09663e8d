//! The operators of Instruction List, one row each: where a body is told from ST, where an instruction is checked, and in
//! `plcc explain JMPC` the same row is read.

use crate::ast::BinaryOp;

/// An operator with its modifiers: `JMPC` is a row of its own.
#[derive(Debug)]
pub struct Operator {
    /// Upper case.
    pub name: &'static str,
    /// What it means.
    pub meaning: Meaning,
    /// What may stand behind it.
    pub operand: &'static str,
    /// What it does, and which types it takes.
    pub does: &'static str,
    /// What becomes of the current result.
    pub result: &'static str,
    /// Where the standard has it.
    pub clause: &'static str,
}

/// What an operator means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meaning {
    /// `LD`.
    Load {
        /// `LDN`.
        negated: bool,
    },
    /// `ST`.
    Store {
        /// `STN`.
        negated: bool,
    },
    /// `S` (TRUE), `R` (FALSE).
    Set(bool),
    /// `NOT`.
    Not,
    /// `AND`, `ADD`, `EQ`, ...; takes a parenthesis.
    Binary {
        /// Between the current result and the operand.
        op: BinaryOp,
        /// `ANDN`: the operand, or what the parenthesis gives, is negated.
        negated: bool,
    },
    /// `JMP`.
    Jump(When),
    /// `CAL`.
    Call(When),
    /// `RET`.
    Return(When),
}

/// Modifiers C and CN.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// Without a modifier.
    Always,
    /// C: the current result is TRUE.
    True,
    /// CN: the current result is FALSE.
    False,
}

/// An input operator: stores the current result in that input of the instance and calls it.
#[derive(Debug)]
pub struct InputOperator {
    /// Upper case.
    pub name: &'static str,
    /// The standard function blocks that have it.
    pub of: &'static str,
}

/// The operator of a name, in any case.
pub fn find(name: &str) -> Option<&'static Operator> {
    OPERATORS.iter().find(|o| o.name.eq_ignore_ascii_case(name))
}

/// The input operator of a name, in any case.
pub fn find_input(name: &str) -> Option<&'static InputOperator> {
    INPUT_OPERATORS.iter().find(|o| o.name.eq_ignore_ascii_case(name))
}

impl Operator {
    /// Whether a parenthesis may open behind it.
    pub fn is_deferred(&self) -> bool {
        matches!(self.meaning, Meaning::Binary { .. })
    }
}

const TABLE: &str = "Ed. 2 table 52";
const VALUE: &str = "a variable or a constant";
const DEFERRED: &str = "a variable, a constant, or `(` and instructions up to `)`";
const LEAVES: &str = "leaves it as it is";
const BITWISE: &str = "becomes the combination, in the wider type of both";
const SUM: &str = "becomes the result, in the common type of both";
const TRUTH: &str = "becomes BOOL: TRUE where that holds";

const fn load(name: &'static str, negated: bool, does: &'static str, result: &'static str) -> Operator {
    Operator { name, meaning: Meaning::Load { negated }, operand: VALUE, does, result, clause: TABLE }
}

const fn store(name: &'static str, negated: bool, does: &'static str) -> Operator {
    Operator { name, meaning: Meaning::Store { negated }, operand: "a variable", does, result: LEAVES, clause: TABLE }
}

const fn set(name: &'static str, to: bool, does: &'static str) -> Operator {
    let operand = "a BOOL variable";
    Operator { name, meaning: Meaning::Set(to), operand, does, result: LEAVES, clause: TABLE }
}

const fn binary(name: &'static str, op: BinaryOp, does: &'static str, result: &'static str) -> Operator {
    Operator { name, meaning: Meaning::Binary { op, negated: false }, operand: DEFERRED, does, result, clause: TABLE }
}

const fn negated(name: &'static str, op: BinaryOp, does: &'static str) -> Operator {
    let result = BITWISE;
    Operator { name, meaning: Meaning::Binary { op, negated: true }, operand: DEFERRED, does, result, clause: TABLE }
}

const fn jump(name: &'static str, when: When, does: &'static str, result: &'static str) -> Operator {
    let operand = "a label of the same body, outside of parentheses";
    Operator { name, meaning: Meaning::Jump(when), operand, does, result, clause: TABLE }
}

const fn call(name: &'static str, when: When, does: &'static str) -> Operator {
    let operand = "an instance of a function block with its arguments, `t(IN := a, PT := T#5s, Q => b)`, or an action";
    Operator { name, meaning: Meaning::Call(when), operand, does, result: LEAVES, clause: TABLE }
}

const fn ret(name: &'static str, when: When, does: &'static str) -> Operator {
    let result = "leaves it as it is where the body goes on";
    Operator { name, meaning: Meaning::Return(when), operand: "nothing", does, result, clause: TABLE }
}

/// All of them, in the order of the standard. `)` closes what a deferred operator opened.
pub const OPERATORS: &[Operator] = &[
    load("LD", false, "Loads the operand, of any type.", "becomes the operand, with its type"),
    load("LDN", true, "Loads the negated operand, BOOL or a bit string.", "becomes NOT operand, with its type"),
    store("ST", false, "Stores the current result. It has the variable's type or one that converts to it by itself."),
    store(
        "STN",
        true,
        "Stores NOT of the current result, BOOL or a bit string, each time. Use R to reset on a condition.",
    ),
    set(
        "S",
        true,
        "Sets the variable to TRUE if the current result, a BOOL, is TRUE; else leaves the variable alone. \
        With an instance that has an input S: stores the current result there and calls it.",
    ),
    set(
        "R",
        false,
        "Resets the variable to FALSE if the current result, a BOOL, is TRUE; else leaves the variable alone. \
        With an instance that has an input R: stores the current result there and calls it.",
    ),
    binary("AND", BinaryOp::And, "AND of the operand and the current result; both are BOOL, or bit strings.", BITWISE),
    negated("ANDN", BinaryOp::And, "AND of the negated operand (or parenthesis) and the current result."),
    binary("&", BinaryOp::And, "The same as AND.", BITWISE),
    negated("&N", BinaryOp::And, "The same as ANDN."),
    binary("OR", BinaryOp::Or, "OR of the operand and the current result; both are BOOL, or bit strings.", BITWISE),
    negated("ORN", BinaryOp::Or, "OR of the negated operand (or parenthesis) and the current result."),
    binary("XOR", BinaryOp::Xor, "XOR of the operand and the current result; both are BOOL, or bit strings.", BITWISE),
    negated("XORN", BinaryOp::Xor, "XOR of the negated operand (or parenthesis) and the current result."),
    Operator {
        name: "NOT",
        meaning: Meaning::Not,
        operand: "nothing",
        does: "Negates the current result, BOOL or a bit string.",
        result: "becomes its negation",
        clause: TABLE,
    },
    binary("ADD", BinaryOp::Add, "Adds the operand; numbers, durations, or a date or time of day and a duration.", SUM),
    binary("SUB", BinaryOp::Sub, "Subtracts the operand; types as for ADD, and dates of one kind.", SUM),
    binary("MUL", BinaryOp::Mul, "Multiplies by the operand; numbers, or a duration and a number.", SUM),
    binary("DIV", BinaryOp::Div, "Divides by the operand; numbers, or a duration by a number. Integers truncate.", SUM),
    binary("MOD", BinaryOp::Mod, "Remainder of the division by the operand; integers.", SUM),
    binary("GT", BinaryOp::Gt, "Whether the current result is greater than the operand.", TRUTH),
    binary("GE", BinaryOp::Ge, "Whether the current result is greater than or equal to the operand.", TRUTH),
    binary("EQ", BinaryOp::Eq, "Whether the current result equals the operand.", TRUTH),
    binary("NE", BinaryOp::Ne, "Whether the current result differs from the operand.", TRUTH),
    binary("LE", BinaryOp::Le, "Whether the current result is less than or equal to the operand.", TRUTH),
    binary("LT", BinaryOp::Lt, "Whether the current result is less than the operand.", TRUTH),
    jump(
        "JMP",
        When::Always,
        "Goes on at the label, always.",
        "is what the label finds; all ways to a label bring one type",
    ),
    jump(
        "JMPC",
        When::True,
        "Goes on at the label if the current result, a BOOL, is TRUE.",
        "leaves it as it is, also for the label",
    ),
    jump(
        "JMPCN",
        When::False,
        "Goes on at the label if the current result, a BOOL, is FALSE.",
        "leaves it as it is, also for the label",
    ),
    call("CAL", When::Always, "Calls an instance of a function block or an action, always."),
    call(
        "CALC",
        When::True,
        "Calls an instance of a function block or an action if the current result, a BOOL, is TRUE.",
    ),
    call(
        "CALCN",
        When::False,
        "Calls an instance of a function block or an action if the current result, a BOOL, is FALSE.",
    ),
    ret("RET", When::Always, "Leaves the POU, always."),
    ret("RETC", When::True, "Leaves the POU if the current result, a BOOL, is TRUE."),
    ret("RETCN", When::False, "Leaves the POU if the current result, a BOOL, is FALSE."),
];

/// Where the standard has the input operators.
pub const INPUT_CLAUSE: &str = "Ed. 2 table 54";

/// Input operators (semantics.md \[I2\]). `S`, `R` and `LD` are also operators of their own: the operand decides.
pub const INPUT_OPERATORS: &[InputOperator] = &[
    InputOperator { name: "S1", of: "SR" },
    InputOperator { name: "R1", of: "RS" },
    InputOperator { name: "S", of: "RS" },
    InputOperator { name: "R", of: "SR, CTU, CTUD" },
    InputOperator { name: "CLK", of: "R_TRIG, F_TRIG" },
    InputOperator { name: "CU", of: "CTU, CTUD" },
    InputOperator { name: "CD", of: "CTD, CTUD" },
    InputOperator { name: "LD", of: "CTD, CTUD" },
    InputOperator { name: "PV", of: "CTU, CTD, CTUD" },
    InputOperator { name: "IN", of: "TP, TON, TOF" },
    InputOperator { name: "PT", of: "TP, TON, TOF" },
];
