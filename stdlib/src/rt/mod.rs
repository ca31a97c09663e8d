//! Bodies of standard functions that are too big for a formula. Each is an `extern "C"` function (for native code) and an
//! evaluator over register values (for constants and the interpreter), from one definition.

use crate::prim::Repr;

pub mod math;
pub mod strings;
pub mod time;

/// A pure function on scalars with a native symbol.
#[derive(Debug)]
pub struct RtFn {
    /// The symbol that native code calls.
    pub symbol: &'static str,
    /// Representations of the parameters.
    pub params: &'static [Repr],
    /// Representation of the result.
    pub result: Repr,
    /// Its meaning on register values.
    pub eval: fn(&[u64]) -> u64,
    /// Its address in this process, for the JIT.
    pub address: fn() -> *const u8,
}

/// The function with this symbol.
pub fn find(symbol: &str) -> Option<&'static RtFn> {
    math::ALL.iter().chain(time::ALL).copied().find(|f| f.symbol == symbol)
}
