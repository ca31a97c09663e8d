//! The initial values of references: addresses, known once every variable has its place.
//!
//! In: the layout. Out: four bytes for each reference variable that is initialised, in every instance. References that
//! functions and VAR_TEMPs hold are set when they start afresh: see `func`.

use super::init::Image;
use crate::layout::Layout;
use plcc_diag::bug;
use plcc_hir::app::Resource;
use plcc_hir::body::Place;
use plcc_hir::shape::{extent, in_instance};
use plcc_hir::{Defs, PouId, Type, TypeId, VarId};
use rustc_hash::FxHashMap;

/// Writes the initial references of globals and programs, and of all instances in them.
pub fn write(defs: &Defs, layout: &Layout, resource: &Resource, image: &mut Image) {
    if defs.vars.iter().all(|v| v.refers_to.is_none()) {
        return;
    }
    let mut writer = Writer { defs, layout, image, holds: FxHashMap::default() };
    for &var in &defs.globals {
        writer.variable(var, 0);
    }
    for (n, program) in resource.programs.iter().enumerate() {
        for &var in &defs.pous[program.pou].vars {
            writer.variable(var, layout.program(n));
        }
    }
}

struct Writer<'a> {
    defs: &'a Defs,
    layout: &'a Layout,
    image: &'a mut Image,
    /// Whether a type holds initialised references; instances of most do not.
    holds: FxHashMap<TypeId, bool>,
}

impl Writer<'_> {
    fn variable(&mut self, id: VarId, instance: u32) {
        let var = &self.defs.vars[id];
        if !(in_instance(var) || var.owner.is_none()) || var.section == plcc_hir::Section::InOut {
            return;
        }
        let Some((offset, None)) = self.layout.offset(id, instance) else { return };
        if let Some(place) = &var.refers_to {
            let address = self.address(place, instance);
            self.image.write(offset, &address.to_le_bytes());
        }
        self.value(var.ty, offset);
    }

    /// What lies inside a value at an offset.
    fn value(&mut self, ty: TypeId, offset: u32) {
        if !self.holds_references(ty) {
            return;
        }
        match &self.defs.types[ty] {
            Type::Instance(pou) => self.instance(*pou, offset),
            Type::Array { dims, elem } => {
                let (count, stride) = (dims.iter().map(|d| extent(*d)).product(), self.layout.size(self.defs, *elem));
                for n in 0..count {
                    self.value(*elem, offset + n as u32 * stride);
                }
            }
            Type::Struct(id) => {
                for (n, field) in self.defs.structs[*id].fields.iter().enumerate() {
                    self.value(field.ty, offset + self.layout.field(*id, n as u32));
                }
            }
            _ => {}
        }
    }

    fn instance(&mut self, pou: PouId, offset: u32) {
        for &var in &self.defs.pous[pou].vars {
            self.variable(var, offset);
        }
    }

    fn holds_references(&mut self, ty: TypeId) -> bool {
        if let Some(known) = self.holds.get(&ty) {
            return *known;
        }
        let defs = self.defs;
        let holds = match &defs.types[ty] {
            Type::Array { elem, .. } => self.holds_references(*elem),
            Type::Struct(id) => defs.structs[*id].fields.iter().any(|f| self.holds_references(f.ty)),
            Type::Instance(pou) => defs.pous[*pou].vars.iter().map(|v| &defs.vars[*v]).any(|v| {
                v.refers_to.is_some() || (v.section != plcc_hir::Section::InOut && self.holds_references(v.ty))
            }),
            _ => false,
        };
        self.holds.insert(ty, holds);
        holds
    }

    fn address(&self, place: &Place, instance: u32) -> u32 {
        match self.layout.address_of(self.defs, place, instance) {
            (offset, None) => offset,
            (_, Some(_)) => bug!("a reference to a bit"),
        }
    }
}
