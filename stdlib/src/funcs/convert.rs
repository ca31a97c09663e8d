//! Conversion functions between scalars (Ed. 3 tables 22 to 27): rows made from the table of conversions.

use super::{Param, Ret, Sem, StdFn, Ty, param, row};
use crate::convert;
use crate::elem::{self, Elem, Generic};
use crate::emit::{Emit, Val};
use crate::prim::PrimOp;

/// How a real becomes integral.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rounding {
    /// TRUNC.
    TowardZero,
    /// ROUND: ties to even.
    Nearest,
    /// CEIL.
    Up,
    /// FLOOR.
    Down,
}

impl Rounding {
    const ALL: [(Rounding, &str); 4] = [
        (Rounding::TowardZero, "TRUNC"),
        (Rounding::Nearest, "ROUND"),
        (Rounding::Up, "CEIL"),
        (Rounding::Down, "FLOOR"),
    ];

    fn prim(self) -> PrimOp {
        match self {
            Rounding::TowardZero => PrimOp::FTrunc,
            Rounding::Nearest => PrimOp::FNearest,
            Rounding::Up => PrimOp::FCeil,
            Rounding::Down => PrimOp::FFloor,
        }
    }
}

/// A real rounded, then as an integer (saturating) if `to` is given.
pub(super) fn round(how: Rounding, from: Elem, to: Option<Elem>, e: &mut dyn Emit, v: Val) -> Option<Val> {
    if !from.is_real() {
        return None;
    }
    let integral = match (how, to) {
        // The conversion goes toward zero itself.
        (Rounding::TowardZero, Some(_)) => v,
        _ => e.prim(how.prim(), from.repr(), &[v]),
    };
    match to {
        Some(to) => convert::trunc(from, to, e, integral),
        None => Some(integral),
    }
}

const CLAUSE: &str = "IEC 61131-3 Ed. 3, 6.6.2.5.2, table 22";

/// None is written out.
pub(super) static ROWS: &[StdFn] = &[];

/// `A_TO_B`, `TO_B`, `A_TRUNC_B`, `TRUNC_B` and its kin.
pub(super) fn generate() -> impl Iterator<Item = StdFn> {
    elem::ALL.into_iter().flat_map(|to| {
        let explicit = elem::ALL.into_iter().filter(move |from| *from != to && convert::exists(*from, to));
        let explicit = explicit.flat_map(move |from| {
            let pairs = names(from).flat_map(move |f| names(to).map(move |t| (f, t)));
            pairs.map(move |(f, t)| one(format!("{f}_TO_{t}"), Some(from), to, Sem::Convert(from, to)))
        });
        let overloaded = names(to).map(move |t| one(format!("TO_{t}"), None, to, Sem::ConvertTo(to)));
        let roundings = Rounding::ALL.into_iter().filter(move |_| to.is_integer()).flat_map(move |(how, name)| {
            let sem = Sem::Round(how, Some(to));
            let t = to.name();
            let typed =
                [Elem::Real, Elem::Lreal].map(|from| one(format!("{}_{name}_{t}", from.name()), Some(from), to, sem));
            typed.into_iter().chain([StdFn { var: Some(Generic::Real), ..one(format!("{name}_{t}"), None, to, sem) }])
        });
        explicit.chain(overloaded).chain(roundings)
    })
}

/// A row with one input IN; `from` is its type, or `None` for the type variable.
fn one(name: String, from: Option<Elem>, to: Elem, sem: Sem) -> StdFn {
    let params: Vec<Param> = vec![param("IN", from.map_or(Ty::Var, Ty::Fixed))];
    let made = row(name.leak(), CLAUSE, params.leak(), Ret::Fixed(to), sem);
    StdFn { bound: from, var: from.is_none().then_some(Generic::Elementary), ..made }
}

/// The type's keyword, and the long one where there are two.
fn names(elem: Elem) -> impl Iterator<Item = &'static str> + Clone {
    let long = match elem {
        Elem::Tod => Some("TIME_OF_DAY"),
        Elem::Ltod => Some("LTIME_OF_DAY"),
        Elem::Dt => Some("DATE_AND_TIME"),
        Elem::Ldt => Some("LDATE_AND_TIME"),
        _ => None,
    };
    [elem.name()].into_iter().chain(long)
}
