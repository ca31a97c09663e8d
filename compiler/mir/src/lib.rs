//! HIR to MIR, memory layout, verifier, printer, and the reference interpreter.

pub mod build;
pub mod ir;
pub mod layout;
pub mod lower;
pub mod visit;
