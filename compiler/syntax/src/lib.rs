//! Text to syntax tree. It knows no types and resolves no names.

pub mod ast;
