//! Copies of aggregates, and constants in memory.

use super::func::FuncLower;
use super::place::Access;
use crate::ir::{Base, Place};
use plcc_hir::TypeId;

impl FuncLower<'_, '_> {
    /// Copies a value that is no scalar to one of the same type, or a string to one of any capacity.
    pub fn copy_aggregate(&mut self, to: &Access, from: &Access) {
        match (self.text_at(to), self.text_at(from)) {
            (Some(to), Some(from)) => self.copy_text(&to, &from),
            _ => self.copy_bytes(to.place.clone(), from.place.clone(), to.ty),
        }
    }

    /// Copies a value of a type whole.
    pub fn copy_bytes(&mut self, to: Place, from: Place, ty: TypeId) {
        let bytes = self.cx.layout.size(self.defs, ty);
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
