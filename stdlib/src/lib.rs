//! What the standard fixes, as data: elementary types, values and their text, the operator table, the function table,
//! the standard function blocks. The compiler, all engines and the runtime read it; it reads nothing of theirs.

pub mod blocks;
pub mod chart_flags;
pub mod convert;
pub mod elem;
pub mod emit;
pub mod fault;
pub mod fold;
pub mod funcs;
pub mod literal;
pub mod ops;
pub mod prim;
pub mod region;
pub mod rt;
pub mod value;
