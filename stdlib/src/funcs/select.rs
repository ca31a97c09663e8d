//! Selection functions (Ed. 3 table 32).

use super::{IN1_IN2, Ret, Sem, StdFn, Ty, param, row};
use crate::elem::{Elem, Generic};
use crate::emit::{Emit, Val};
use crate::ops::{self, Op};
use crate::prim::{PrimOp, Repr};

const T32: &str = "IEC 61131-3 Ed. 3, 6.6.2.5.6, table 32";

pub(super) static ROWS: &[StdFn] = &[
    row(
        "SEL",
        T32,
        &[param("G", Ty::Fixed(Elem::Bool)), param("IN0", Ty::Var), param("IN1", Ty::Var)],
        Ret::Var,
        Sem::Op(Op::Sel),
    )
    .over(Generic::Any),
    row("MAX", T32, IN1_IN2, Ret::Var, Sem::Op(Op::Max)).over(Generic::Elementary).extensible(),
    row("MIN", T32, IN1_IN2, Ret::Var, Sem::Op(Op::Min)).over(Generic::Elementary).extensible(),
    row(
        "LIMIT",
        T32,
        &[param("MN", Ty::Var), param("IN", Ty::Var), param("MX", Ty::Var)],
        Ret::Var,
        Sem::Formula(|e, elem, args| {
            let low = ops::emit(Op::Max, elem, &[args[1], args[0]], e);
            ops::emit(Op::Min, elem, &[low, args[2]], e)
        }),
    )
    .over(Generic::Elementary),
    row("MUX", T32, &[param("K", Ty::Int), param("IN0", Ty::Var), param("IN1", Ty::Var)], Ret::Var, Sem::Formula(mux))
        .over(Generic::Any)
        .extensible(),
];

/// Input number K, counted from 0; the last one if there is no such input.
fn mux(e: &mut dyn Emit, elem: Elem, args: &[Val]) -> Val {
    let (k, inputs) = (args[0], &args[1..]);
    let last = inputs.len() - 1;
    let mut chosen = inputs[last];
    for (n, input) in inputs[..last].iter().enumerate() {
        let number = e.constant(Repr::I64, n as u64);
        let is_it = e.prim(PrimOp::Eq, Repr::I64, &[k, number]);
        chosen = e.prim(PrimOp::Select, elem.repr(), &[is_it, *input, chosen]);
    }
    chosen
}
