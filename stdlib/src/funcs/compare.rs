//! Comparison functions (Ed. 3 table 33).

use super::{IN1_IN2, Ret, Sem, StdFn, both, row};
use crate::elem::{Elem, Generic};
use crate::emit::{Emit, Val};
use crate::ops::{self, Op};

const T33: &str = "IEC 61131-3 Ed. 3, 6.6.2.5.7, table 33";

const fn comparison(name: &'static str, op: Op) -> StdFn {
    row(name, T33, IN1_IN2, Ret::Fixed(Elem::Bool), Sem::Op(op)).over(Generic::Elementary)
}

pub(super) static ROWS: &[StdFn] = &[
    comparison("GT", Op::Gt).extensible(),
    comparison("GE", Op::Ge).extensible(),
    comparison("EQ", Op::Eq).extensible(),
    comparison("LE", Op::Le).extensible(),
    comparison("LT", Op::Lt).extensible(),
    comparison("NE", Op::Ne),
];

/// `GT(a, b, c)` is `a > b AND b > c`.
pub(super) fn chain(op: Op, elem: Elem, args: &[Val], e: &mut dyn Emit) -> Option<Val> {
    let mut result = None;
    for pair in args.windows(2) {
        let holds = ops::emit(op, elem, pair, e);
        result = Some(match result {
            Some(before) => both(e, before, holds),
            None => holds,
        });
    }
    result
}
