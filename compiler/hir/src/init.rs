//! Initial values, evaluated.

use crate::defs::ReferenceId;

/// An initial value. What it leaves out has the default of its type (semantics.md \[T9\]): 0, FALSE, '', the first
/// enumeration value, the lower bound of a subrange without 0, NULL; for a structure or function block the initial values
/// of its declaration.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Init {
    /// The type's default.
    #[default]
    Default,
    /// Register value of an elementary type, enumeration or subrange.
    Scalar(u64),
    /// STRING characters (Latin-1), without the 0.
    String(Vec<u8>),
    /// WSTRING units, without the 0.
    WString(Vec<u16>),
    /// A reference: to what is known when all declarations are, where that lies when they are laid out.
    Reference(ReferenceId),
    /// An array's elements from the first on, as runs; all dimensions flattened.
    Array(Vec<(u32, Init)>),
    /// Components of a structure (index of the field) or of an instance (index in `Pou::vars`) that differ from their own.
    Fields(Vec<(u32, Init)>),
}

impl Init {
    /// All references in it, without those that its type has by itself.
    pub fn references(&self, found: &mut Vec<ReferenceId>) {
        match self {
            Init::Reference(id) => found.push(*id),
            Init::Array(runs) => runs.iter().for_each(|(_, item)| item.references(found)),
            Init::Fields(list) => list.iter().for_each(|(_, item)| item.references(found)),
            Init::Default | Init::Scalar(_) | Init::String(_) | Init::WString(_) => {}
        }
    }
}
