//! Copies of aggregates, and of strings, which may differ in capacity (semantics.md \[T8\]).
//!
//! A string ends at its first 0, so copying as many characters as both can hold and writing a 0 behind them cuts at the
//! capacity, whatever the lengths are; no loop looks for the end.

use super::func::FuncLower;
use crate::ir::{Base, Place};
use plcc_hir::{Type, TypeId};
use plcc_stdlib::prim::Repr;

impl FuncLower<'_, '_> {
    /// Copies a value that is no scalar.
    pub fn copy_value(&mut self, to: Place, to_type: TypeId, from: Place, from_type: TypeId) {
        let types = &self.defs.types;
        if let (Type::String { wide, capacity: room }, Type::String { capacity, .. }) =
            (&types[to_type], &types[from_type])
        {
            let (repr, size) = if *wide { (Repr::I16, 2) } else { (Repr::I8, 1) };
            // A capacity whose bytes do not fit was refused with its variable.
            let bytes = (*room.min(capacity)).saturating_mul(size);
            self.b.copy(to.clone(), from, bytes);
            let end = self.b.number(repr, 0);
            self.b.store(to.plus(bytes), end);
            return;
        }
        let bytes = self.cx.layout.size(self.defs, to_type);
        self.b.copy(to, from, bytes);
    }

    /// The place of a string constant: its bytes and an end.
    pub fn string_constant(&mut self, mut bytes: Vec<u8>, unit_bytes: usize) -> Place {
        bytes.resize(bytes.len() + unit_bytes, 0);
        self.constant_place(bytes)
    }

    /// The place of constant bytes in the region.
    pub fn constant_place(&mut self, bytes: Vec<u8>) -> Place {
        let at = self.cx.constants.place(bytes) + u64::from(self.cx.layout.constants.start);
        // Too many constants are reported when the layout is closed.
        Place::new(Base::Region, u32::try_from(at).unwrap_or(u32::MAX))
    }
}
