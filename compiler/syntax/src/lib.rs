//! Text to syntax tree. It knows no types and resolves no names.

pub mod ast;
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profile { Strict, Codesys }
