//! Selection functions (Ed. 2 table 27).

use super::*;
use crate::ops::{self, Op};
use crate::prim::Repr;

/// The least or greatest of all arguments.
fn fold(op: Op, t: Elem, args: &[Val], e: &mut dyn Emit) -> Option<Val> {
    let (first, rest) = args.split_first()?;
    Some(rest.iter().fold(*first, |best, v| ops::emit(op, t, &[best, *v], e)))
}

/// MUX: K outside of the inputs gives the last one (semantics.md \[N1\]).
fn mux(t: Elem, args: &[Val], e: &mut dyn Emit) -> Option<Val> {
    let (k, inputs) = args.split_first()?;
    let (last, others) = inputs.split_last()?;
    let mut chosen = *last;
    for (n, input) in others.iter().enumerate().rev() {
        let number = e.constant(Repr::I64, n as u64);
        let is = e.prim(PrimOp::Eq, Repr::I64, &[*k, number]);
        chosen = e.prim(PrimOp::Select, t.repr(), &[is, *input, chosen]);
    }
    Some(chosen)
}

/// MUX with the type of K in its name, the first part of its typed forms (Ed. 2 table 27): `MUX_INT`, for `MUX_INT_REAL`.
pub(super) fn mux_by_selector() -> Vec<StdFn> {
    let rows = rows();
    let Some(mux) = rows.iter().find(|r| r.name == "MUX") else { return Vec::new() };
    let integers = crate::elem::ALL.into_iter().filter(|e| e.is_integer());
    let of = |k: Elem| {
        let params = vec![Param { name: "K", ty: Type::Fixed(k) }];
        StdFn { name: format!("MUX_{}", k.name()), params, ..mux.clone() }
    };
    integers.map(of).collect()
}

/// The typed forms of MUX.
pub(super) fn typed_mux() -> Vec<StdFn> {
    mux_by_selector().iter().flat_map(|row| crate::elem::ALL.into_iter().flat_map(|elem| row.typed(elem))).collect()
}

pub(super) fn rows() -> Vec<StdFn> {
    use Generic::*;
    use Type::*;
    let clause = "Ed. 2 table 27";
    let bool = Fixed(Elem::Bool);
    vec![
        row(
            "SEL",
            clause,
            Any,
            &[("G", bool), ("IN0", Var), ("IN1", Var)],
            Meaning::Choose(|t, args, e| Some(e.prim(PrimOp::Select, t.repr(), &[args[0], args[2], args[1]]))),
            "IN0 if G is FALSE, IN1 if it is TRUE.",
        ),
        row(
            "MAX",
            clause,
            Elementary,
            &[],
            Meaning::Formula(|t, a, e| fold(Op::Max, t, a, e)),
            "The greatest argument.",
        )
        .extensible(1, 2),
        row("MIN", clause, Elementary, &[], Meaning::Formula(|t, a, e| fold(Op::Min, t, a, e)), "The least argument.")
            .extensible(1, 2),
        row(
            "LIMIT",
            clause,
            Elementary,
            &[("MN", Var), ("IN", Var), ("MX", Var)],
            Meaning::Formula(|t, args, e| {
                let low = ops::emit(Op::Max, t, &[args[1], args[0]], e);
                Some(ops::emit(Op::Min, t, &[low, args[2]], e))
            }),
            "IN, but at least MN and at most MX.",
        ),
        row(
            "MUX",
            clause,
            Any,
            &[("K", Integer)],
            Meaning::Choose(mux),
            "Input number K, from 0; the last one if K is outside.",
        )
        .extensible(0, 2),
    ]
}
