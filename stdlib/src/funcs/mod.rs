//! The function table: one row per standard function, by name. Checker, lowering, constant folding and `plcc explain` read it.
//!
//! A row says which parameters there are, what its type variable may stand for, what the result is, and what it means: an
//! operator, a conversion, or a formula over [`Emit`]. Typed names of Ed. 2 (`ADD_INT`) and conversions (`INT_TO_REAL`) are
//! made from the same rows.

mod bits;
mod calendar;
mod convert;
mod numeric;
mod select;
mod strings;
mod time;

use crate::elem::{Elem, Generic};
use crate::emit::{Emit, Val};
use crate::prim::PrimOp;
use std::collections::HashMap;
use std::sync::OnceLock;

pub use strings::TextOp;

/// A standard function.
#[derive(Debug, Clone)]
pub struct StdFn {
    /// Upper case.
    pub name: String,
    /// Where the standard has it.
    pub clause: &'static str,
    /// What it gives, one sentence.
    pub doc: &'static str,
    /// The fixed parameters, in order.
    pub params: Vec<Param>,
    /// Further parameters of the type variable: `IN1, IN2 ...` numbered from `first`.
    pub variadic: Option<Variadic>,
    /// What it gives besides its result, fetched with `=>`.
    pub outputs: Vec<Output>,
    /// What the type variable may stand for.
    pub generic: Generic,
    /// The type variable's value in typed names (`ADD_INT`).
    pub bound: Option<Elem>,
    /// The result.
    pub result: Type,
    /// What it means.
    pub meaning: Meaning,
}

/// A parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Param {
    /// Its formal name.
    pub name: &'static str,
    /// Its type.
    pub ty: Type,
}

/// Any number of further parameters of one type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Variadic {
    /// Number in the first name: `IN1` or `IN0`.
    pub first: usize,
    /// At least so many.
    pub min: usize,
    /// Their type.
    pub ty: Type,
}

/// An output of a function: an integer that any integer variable takes whose type holds all its values.
#[derive(Debug, Clone, Copy)]
pub struct Output {
    /// Its formal name.
    pub name: &'static str,
    /// Least and greatest value.
    pub range: (i64, i64),
    /// Its value, a LINT, over the values of all arguments.
    formula: Formula,
}

/// The type of a parameter or result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Type {
    /// The row's type variable.
    Var,
    /// Always this one.
    Fixed(Elem),
    /// Any integer (or, by value, bit string); handed over as LINT.
    Integer,
    /// An integer type that the place of the call asks for; where nothing does, DINT after rounding (`TRUNC`), else INT
    /// (`DAY_OF_WEEK`, whose formula gives a LINT).
    IntegerOfPlace,
    /// No result: everything is in the outputs.
    Nothing,
    /// A string of any capacity: a WSTRING if TRUE.
    Text(bool),
}

/// What a function means.
#[derive(Debug, Clone, Copy)]
pub enum Meaning {
    /// The operator of this sign, from left to right.
    Operator(Operator),
    /// A comparison; with more than two arguments each neighbouring pair must hold.
    Compare(Operator, Formula),
    /// A shift or rotation (`ops::Op`), value and count.
    Shift(crate::ops::Op),
    /// A conversion of the one argument, whose type the parameter names, to this type.
    Convert(Elem),
    /// A real to an integer after rounding with this operation.
    Integral(PrimOp),
    /// A bit string in BCD to an integer.
    FromBcd(Elem),
    /// An integer to a bit string in BCD.
    ToBcd(Elem),
    /// The argument itself.
    Move,
    /// The argument whose number (from 0) the first one gives. The formula is for elementary types.
    Choose(Formula),
    /// Nothing but outputs.
    Outputs,
    /// An operation on strings.
    Text(TextOp),
    /// Any elementary value or string to a string: a WSTRING if TRUE.
    ToText(bool),
    /// A formula over the values of all arguments; the element is what the type variable stands for.
    Formula(Formula),
}

/// A function body over [`Emit`]. `None`: it has no value where there is no clock (constants).
pub type Formula = fn(Elem, &[Val], &mut dyn Emit) -> Option<Val>;

/// Operators that functions name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Operator {
    Add,
    Sub,
    Mul,
    Div,
    Mod,
    Power,
    And,
    Or,
    Xor,
    Not,
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
}

impl StdFn {
    /// Appends the formula of the row, if it is one.
    pub fn emit(&self, elem: Elem, args: &[Val], e: &mut dyn Emit) -> Option<Val> {
        match self.meaning {
            Meaning::Formula(formula) | Meaning::Choose(formula) | Meaning::Compare(_, formula) => {
                formula(elem, args, e)
            }
            _ => None,
        }
    }

    /// The formal name of argument `n`.
    pub fn param_name(&self, n: usize) -> String {
        match self.params.get(n) {
            Some(p) => p.name.to_string(),
            None => format!("IN{}", self.variadic.map_or(1, |v| v.first) + n - self.params.len()),
        }
    }

    /// The position of a formal name (any case).
    pub fn param_index(&self, name: &str) -> Option<usize> {
        if let Some(i) = self.params.iter().position(|p| p.name.eq_ignore_ascii_case(name)) {
            return Some(i);
        }
        let variadic = self.variadic?;
        let digits = name.get(..2).filter(|p| p.eq_ignore_ascii_case("IN")).map(|_| &name[2..])?;
        let number: usize = digits.parse().ok()?;
        (number >= variadic.first && number - variadic.first < 1024 && digits == number.to_string())
            .then(|| self.params.len() + number - variadic.first)
    }

    /// The output with this name (any case).
    pub fn output(&self, name: &str) -> Option<&Output> {
        self.outputs.iter().find(|o| o.name.eq_ignore_ascii_case(name))
    }

    /// The row that computes an output from the arguments (not callable by name).
    pub fn output_row(&self, output: &Output) -> Option<&'static StdFn> {
        table().get(&format!("${}.{}", self.name, output.name))
    }

    /// The type of argument `n`.
    pub fn param_type(&self, n: usize) -> Option<Type> {
        self.params.get(n).map(|p| p.ty).or(self.variadic.map(|v| v.ty))
    }

    /// The least number of arguments.
    pub fn min_args(&self) -> usize {
        self.params.len() + self.variadic.map_or(0, |v| v.min)
    }

    /// `LIMIT(MN, IN, MX : ANY_ELEMENTARY) : ANY_ELEMENTARY`.
    pub fn signature(&self) -> String {
        let text = |ty| match (ty, self.bound) {
            (Type::Var, Some(elem)) => elem.name().to_string(),
            (Type::Var, None) => self.generic.name().to_string(),
            (Type::Fixed(elem), _) => elem.name().to_string(),
            (Type::Integer, _) => "ANY_INT".into(),
            (Type::IntegerOfPlace, _) => "ANY_INT".into(),
            (Type::Nothing, _) => String::new(),
            (Type::Text(wide), _) => if wide { "WSTRING" } else { "STRING" }.into(),
        };
        let mut params: Vec<String> = self.params.iter().map(|p| format!("{} : {}", p.name, text(p.ty))).collect();
        if let Some(v) = self.variadic {
            let var = text(v.ty);
            params.extend((v.first..v.first + v.min).map(|n| format!("IN{n} : {var}")));
            params.push("...".into());
        }
        params.extend(self.outputs.iter().map(|o| format!("{} => ANY_INT", o.name)));
        let call = format!("{}({})", self.name, params.join(", "));
        if self.result == Type::Nothing { call } else { format!("{call} : {}", text(self.result)) }
    }
}

/// A row of one type variable: `F(IN) : same type`.
fn row(
    name: &str,
    clause: &'static str,
    generic: Generic,
    params: &[(&'static str, Type)],
    meaning: Meaning,
    doc: &'static str,
) -> StdFn {
    StdFn {
        name: name.into(),
        clause,
        doc,
        params: params.iter().map(|(name, ty)| Param { name, ty: *ty }).collect(),
        variadic: None,
        outputs: Vec::new(),
        generic,
        bound: None,
        result: Type::Var,
        meaning,
    }
}

impl StdFn {
    fn gives(mut self, result: Type) -> Self {
        self.result = result;
        self
    }
    fn extensible(mut self, first: usize, min: usize) -> Self {
        self.variadic = Some(Variadic { first, min, ty: Type::Var });
        self
    }
    /// The same row under its typed names, long names of types included (`GT_TIME_OF_DAY`).
    fn typed(&self, elem: Elem) -> Vec<Self> {
        let spellings = convert::spellings(elem).into_iter();
        let typed = |name| Self { name: format!("{}_{name}", self.name), bound: Some(elem), ..self.clone() };
        spellings.map(typed).collect()
    }
}

fn table() -> &'static HashMap<String, StdFn> {
    static TABLE: OnceLock<HashMap<String, StdFn>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let mut table = HashMap::new();
        let generic = numeric::rows().into_iter().chain(select::rows());
        for row in generic {
            // Ed. 2 names the typed form of every overloaded function.
            for elem in crate::elem::ALL {
                if row.generic.contains(elem) {
                    for typed in row.typed(elem) {
                        table.insert(typed.name.clone(), typed);
                    }
                }
            }
            table.insert(row.name.clone(), row);
        }
        let fixed = time::rows()
            .into_iter()
            .chain(calendar::rows())
            .chain(bits::rows())
            .chain(convert::rows())
            .chain(strings::rows());
        for row in fixed.chain(select::typed_mux()).chain(time::typed_scaling()) {
            for output in &row.outputs {
                let name = format!("${}.{}", row.name, output.name);
                let meaning = Meaning::Formula(output.formula);
                let result = Type::Fixed(Elem::Lint);
                table.insert(name.clone(), StdFn { name, meaning, result, outputs: Vec::new(), ..row.clone() });
            }
            table.insert(row.name.clone(), row);
        }
        table
    })
}

/// The function with this name, which is given in upper case.
pub fn find(name: &str) -> Option<&'static StdFn> {
    table().get(name)
}

/// The row that rounds a real inside its own type (not callable by name: `TRUNC` and its kind convert to integers).
pub fn rounding(op: PrimOp) -> Option<&'static StdFn> {
    table().get(match op {
        PrimOp::FTrunc => "$TRUNC",
        PrimOp::FNearest => "$NEAREST",
        PrimOp::FCeil => "$CEIL",
        PrimOp::FFloor => "$FLOOR",
        _ => return None,
    })
}

/// The row that reads the number of a BCD pattern (its type variable) as ULINT; not callable by name.
pub fn from_bcd() -> Option<&'static StdFn> {
    table().get("$FROM_BCD")
}

/// The row that makes a BCD pattern (its type variable) of an ULINT; not callable by name.
pub fn to_bcd() -> Option<&'static StdFn> {
    table().get("$TO_BCD")
}

/// Every name, typed forms included, in no order.
pub fn names() -> impl Iterator<Item = &'static str> {
    table().keys().map(String::as_str).filter(|n| !n.starts_with('$'))
}

#[cfg(test)]
mod standard_names;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_parameters() {
        let limit = find("LIMIT").unwrap();
        assert_eq!(limit.param_index("mx"), Some(2));
        assert_eq!(
            limit.signature(),
            "LIMIT(MN : ANY_ELEMENTARY, IN : ANY_ELEMENTARY, MX : ANY_ELEMENTARY) : ANY_ELEMENTARY"
        );
        let add = find("ADD").unwrap();
        assert_eq!(add.param_index("IN2"), Some(1));
        assert_eq!(add.param_index("IN0"), None);
        assert_eq!(add.param_index("IN02"), None);
        assert_eq!(find("ADD_INT").unwrap().bound, Some(Elem::Int));
        assert!(find("ADD_BOOL").is_none());
        assert_eq!(find("MUX").unwrap().param_index("IN0"), Some(1));
        assert!(matches!(find("INT_TO_REAL").unwrap().meaning, Meaning::Convert(Elem::Real)));
        assert!(find("TIME_OF_DAY_TO_LREAL").is_some());
    }
}
