//! HIR to MIR, memory layout, verifier, printer, and the reference interpreter.

pub mod ir;
