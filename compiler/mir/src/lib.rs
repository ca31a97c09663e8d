//! HIR to MIR, memory layout, verifier, printer, and the reference interpreter.

pub mod build;
pub mod dominators;
pub mod interp;
pub mod ir;
pub mod lanes;
pub mod layout;
pub mod lower;
mod operands;
pub mod opt;
pub mod print;
pub mod resources;
mod short_text;
pub mod verify;
pub mod visit;
