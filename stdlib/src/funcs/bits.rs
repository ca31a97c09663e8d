//! Bit string functions (Ed. 3 tables 30 and 31).

use super::{IN, IN1_IN2, Param, Ret, Sem, StdFn, Ty, param, row};
use crate::elem::Generic;
use crate::ops::Op;

const SHIFTS: &str = "IEC 61131-3 Ed. 3, 6.6.2.5.5, table 30";
const LOGIC: &str = "IEC 61131-3 Ed. 3, 6.6.2.5.5, table 31";

/// The count is any integer; a negative one is a fault.
const IN_N: &[Param] = &[param("IN", Ty::Var), param("N", Ty::Int)];

const fn shift(name: &'static str, op: Op) -> StdFn {
    row(name, SHIFTS, IN_N, Ret::Var, Sem::Op(op)).over(Generic::Bit)
}

const fn logic(name: &'static str, op: Op) -> StdFn {
    row(name, LOGIC, IN1_IN2, Ret::Var, Sem::Op(op)).over(Generic::Bit).extensible()
}

pub(super) static ROWS: &[StdFn] = &[
    shift("SHL", Op::Shl),
    shift("SHR", Op::Shr),
    shift("ROL", Op::Rol),
    shift("ROR", Op::Ror),
    logic("AND", Op::And),
    logic("OR", Op::Or),
    logic("XOR", Op::Xor),
    row("NOT", LOGIC, IN, Ret::Var, Sem::Op(Op::Not)).over(Generic::Bit),
];
