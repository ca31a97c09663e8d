//! MIR to machine code with Cranelift: in memory ([`jit`]) or as an object file ([`object`]).
//!
//! In: a verified and optimised `mir::Program`. Out: code that leaves the same bytes in the region as the interpreter.
//! Linking, files and messages to the user are the driver's business.

mod compile;
mod constants;
mod entry;
mod func;
pub mod header;
pub mod jit;
mod module;
pub mod object;
mod packs;
mod place;
mod prim;
mod shape;
pub mod target;
pub mod text;

use std::fmt;

/// Why there is no code. None of these is a mistake in the sources.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CodegenError {
    /// The target is unknown or not supported.
    Target(String),
    /// A function exceeds what the code generator can do (size, number of values).
    Function {
        /// Its name.
        name: String,
        /// Why.
        message: String,
    },
    /// The module could not be put together: memory for code, the format of the object.
    Module(String),
}

impl fmt::Display for CodegenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CodegenError::Target(why) => write!(f, "{why}"),
            CodegenError::Function { name, message } => write!(f, "no code for `{name}`: {message}"),
            CodegenError::Module(why) => write!(f, "{why}"),
        }
    }
}

impl std::error::Error for CodegenError {}

impl From<cranelift_module::ModuleError> for CodegenError {
    fn from(error: cranelift_module::ModuleError) -> Self {
        CodegenError::Module(error.to_string())
    }
}
