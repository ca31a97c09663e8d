//! The function table: one row per standard function (Ed. 3 tables 22 to 36), read by checker, lowering and `plcc explain`.
//!
//! In: a name in any case. Out: a [`StdFn`] that tells its parameters, which of them share one type, its result, and its
//! meaning as a formula over [`Emit`]. Which types may be converted into a parameter is left to the compiler's typing rules.
//!
//! Rows that differ only in a type (`ADD_INT`, `INT_TO_REAL`, `TO_REAL`) are generated from one description.

mod bits;
mod compare;
mod convert;
mod numeric;
mod select;
mod time;

use crate::elem::{Elem, Generic};
use crate::emit::{Emit, Val};
use crate::ops::{self, Op};
use crate::prim::{PrimOp, Repr};
use std::borrow::Cow;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::LazyLock;

pub use convert::Rounding;

/// A row of the table.
#[derive(Debug)]
pub struct StdFn {
    /// Upper case.
    pub name: &'static str,
    /// Where the standard defines it.
    pub clause: &'static str,
    /// In order.
    pub params: &'static [Param],
    /// Whether the last parameter may be repeated; its name then counts on: IN2, IN3, ...
    pub extensible: bool,
    /// What the one type variable ([`Ty::Var`]) may stand for; `None` if there is no variable.
    pub var: Option<Generic>,
    /// The type of the result.
    pub result: Ret,
    /// The meaning.
    pub sem: Sem,
    /// The type that a typed form (`ADD_INT`) puts for the variable of its row.
    bound: Option<Elem>,
}

/// A parameter, always an input.
#[derive(Debug, Clone, Copy)]
pub struct Param {
    /// `IN1`, `MN`.
    pub name: &'static str,
    /// What it takes.
    pub ty: Ty,
}

/// The type of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ty {
    /// The type variable of the row: the same type for all such parameters.
    Var,
    /// Exactly this type.
    Fixed(Elem),
    /// Any integer; the argument is converted to LINT.
    Int,
    /// Any number; the argument is converted to the type of the variable.
    Num,
}

/// The type of a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ret {
    /// That of the type variable.
    Var,
    /// Exactly this type.
    Fixed(Elem),
    /// The integer type of the place where the call stands (see [`StdFn::for_place`]). Where the place is no integer:
    /// `alone`, or if that is `None` the type of the variable.
    Place {
        /// The type without such a place.
        alone: Option<Elem>,
    },
}

/// What a row means.
#[derive(Debug, Clone, Copy)]
pub enum Sem {
    /// An operator; with more than two arguments from left to right, a comparison of each with the next. A checker may treat
    /// the call like the operator, with its mixed forms of time arithmetic.
    Op(Op),
    /// `A_TO_B`.
    Convert(Elem, Elem),
    /// `TO_B`, from the type variable.
    ConvertTo(Elem),
    /// A real to an integer type; to its own type if `None`.
    Round(Rounding, Option<Elem>),
    /// The scan clock.
    Clock,
    /// A formula over the type variable's type and the arguments.
    Formula(fn(&mut dyn Emit, Elem, &[Val]) -> Val),
}

impl StdFn {
    /// Name and type of argument `n`, counted from 0; `None` past the last.
    pub fn param(&self, n: usize) -> Option<(Cow<'static, str>, Ty)> {
        if let Some(p) = self.params.get(n) {
            return Some((p.name.into(), p.ty));
        }
        let last = self.params.last().filter(|_| self.extensible)?;
        let (stem, first) = split_number(last.name);
        Some((format!("{stem}{}", first + n - (self.params.len() - 1)).into(), last.ty))
    }

    /// The position of a formal parameter, in any case: `IN3` of ADD is 2.
    pub fn position(&self, name: &str) -> Option<usize> {
        if let Some(n) = self.params.iter().position(|p| p.name.eq_ignore_ascii_case(name)) {
            return Some(n);
        }
        let last = self.params.last().filter(|_| self.extensible)?;
        let (stem, first) = split_number(last.name);
        let (head, digits) = name.split_at_checked(stem.len())?;
        let plain = digits.len() <= 9 && !digits.starts_with('0') && digits.bytes().all(|b| b.is_ascii_digit());
        if !head.eq_ignore_ascii_case(stem) || !plain {
            return None;
        }
        let n: usize = digits.parse().ok()?;
        (n > first).then(|| n - first + self.params.len() - 1)
    }

    /// Whether the type variable may stand for `elem`.
    pub fn accepts(&self, elem: Elem) -> bool {
        self.var.is_some_and(|g| g.contains(elem))
            && match self.sem {
                Sem::Op(op) => ops::accepts(op, elem),
                Sem::ConvertTo(to) => crate::convert::exists(elem, to),
                _ => true,
            }
    }

    /// The type of the result when the variable stands for `elem` (ignored in rows without one).
    pub fn result_elem(&self, elem: Elem) -> Elem {
        match self.result {
            Ret::Var => self.bound.unwrap_or(elem),
            Ret::Fixed(t) => t,
            Ret::Place { alone } => alone.unwrap_or(self.bound.unwrap_or(elem)),
        }
    }

    /// For TRUNC, ROUND, CEIL, FLOOR of a `from` in a place of integer type `to`: the row that gives this type.
    pub fn for_place(&self, from: Elem, to: Elem) -> Option<&'static StdFn> {
        match self.result {
            Ret::Place { .. } => find(&format!("{}_{}_{}", from.name(), self.name, to.name())),
            _ => None,
        }
    }

    /// The value of a call: `args` for all parameters in order, already of their types; `elem` is what the variable stands
    /// for. `None` where the scan clock is asked for and there is none, or if `elem` is not accepted.
    pub fn emit(&self, elem: Elem, args: &[Val], e: &mut dyn Emit) -> Option<Val> {
        let elem = self.bound.unwrap_or(elem);
        let first = args.first().copied();
        Some(match self.sem {
            Sem::Op(op) if op.is_comparison() => compare::chain(op, elem, args, e)?,
            Sem::Op(op) if self.extensible => {
                let (first, rest) = args.split_first()?;
                rest.iter().fold(*first, |acc, v| ops::emit(op, elem, &[acc, *v], e))
            }
            Sem::Op(op) => ops::emit(op, elem, args, e),
            Sem::Convert(from, to) => crate::convert::convert(from, to, e, first?)?,
            Sem::ConvertTo(to) => crate::convert::convert(elem, to, e, first?)?,
            Sem::Round(rounding, to) => convert::round(rounding, elem, to, e, first?)?,
            Sem::Clock => e.clock()?,
            Sem::Formula(f) => f(e, elem, args),
        })
    }
}

/// `IN12` as `IN` and 12.
fn split_number(name: &str) -> (&str, usize) {
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    (stem, name[stem.len()..].parse().unwrap_or(0))
}

/// The row with this name, in any case.
pub fn find(name: &str) -> Option<&'static StdFn> {
    let mut buffer = [0u8; LONGEST_NAME];
    let upper = buffer.get_mut(..name.len())?;
    upper.copy_from_slice(name.as_bytes());
    upper.make_ascii_uppercase();
    TABLE.by_name.get(std::str::from_utf8(upper).ok()?).copied()
}

/// Every row, the ones with the plain names first.
pub fn all() -> impl Iterator<Item = &'static StdFn> {
    TABLE.rows.iter().copied()
}

/// No row has a longer name.
const LONGEST_NAME: usize = 40;

struct Table {
    rows: Vec<&'static StdFn>,
    by_name: HashMap<&'static str, &'static StdFn>,
}

static TABLE: LazyLock<Table> = LazyLock::new(|| {
    let groups = [numeric::ROWS, bits::ROWS, select::ROWS, compare::ROWS, time::ROWS, convert::ROWS];
    let plain: Vec<&'static StdFn> = groups.into_iter().flatten().collect();
    let typed = plain.iter().flat_map(|row| {
        let types = crate::elem::ALL.into_iter().filter(|t| row.accepts(*t));
        types.map(|t| typed(row, t))
    });
    let generated = typed.chain(convert::generate()).map(|row| &*Box::leak(Box::new(row)));
    let mut table = Table { rows: plain.clone(), by_name: plain.iter().map(|r| (r.name, *r)).collect() };
    for row in generated {
        debug_assert!(row.name.len() <= LONGEST_NAME, "{}", row.name);
        // A name that is written out wins over one that is made (`ADD_TIME`).
        if let Entry::Vacant(free) = table.by_name.entry(row.name) {
            free.insert(row);
            table.rows.push(row);
        }
    }
    table
});

/// `ADD_INT` from `ADD`.
fn typed(row: &StdFn, elem: Elem) -> StdFn {
    let fix = |p: &Param| match p.ty {
        Ty::Var => Param { ty: Ty::Fixed(elem), ..*p },
        _ => *p,
    };
    StdFn {
        name: format!("{}_{}", row.name, elem.name()).leak(),
        clause: row.clause,
        params: row.params.iter().map(fix).collect::<Vec<_>>().leak(),
        extensible: row.extensible,
        var: None,
        result: if row.result == Ret::Var { Ret::Fixed(elem) } else { row.result },
        sem: row.sem,
        bound: Some(elem),
    }
}

// ---- how rows are written ----

const fn row(name: &'static str, clause: &'static str, params: &'static [Param], result: Ret, sem: Sem) -> StdFn {
    StdFn { name, clause, params, extensible: false, var: None, result, sem, bound: None }
}

impl StdFn {
    /// The type variable stands for any of these.
    const fn over(self, generic: Generic) -> StdFn {
        StdFn { var: Some(generic), ..self }
    }

    /// The last parameter may be repeated.
    const fn extensible(self) -> StdFn {
        StdFn { extensible: true, ..self }
    }
}

const fn param(name: &'static str, ty: Ty) -> Param {
    Param { name, ty }
}

const IN: &[Param] = &[param("IN", Ty::Var)];
const IN1_IN2: &[Param] = &[param("IN1", Ty::Var), param("IN2", Ty::Var)];

/// The one of two library rows that fits the real type.
fn call_real(
    e: &mut dyn Emit,
    elem: Elem,
    args: &[Val],
    single: &'static crate::rt::RtFn,
    double: &'static crate::rt::RtFn,
) -> Val {
    e.call(if elem.repr() == Repr::F32 { single } else { double }, args)
}

/// AND of two truth values.
fn both(e: &mut dyn Emit, a: Val, b: Val) -> Val {
    e.prim(PrimOp::And, Repr::I8, &[a, b])
}

#[cfg(test)]
mod tests;
