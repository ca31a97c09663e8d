//! The byte ranges that a warm start keeps (semantics.md \[S7\]).
//!
//! RETAIN variables of programs and globals, and inside instances of function blocks those that the block declares so; an
//! instance that is RETAIN itself keeps all its variables but those that the block declares NON_RETAIN. References are never
//! kept.

use super::Layout;
use plcc_hir::app::Resource;
use plcc_hir::{Defs, Section, Type, TypeId, VarId};

/// The ranges (start, length), sorted, disjoint and not adjacent.
pub(super) fn ranges(defs: &Defs, layout: &Layout, resource: &Resource) -> Vec<(u32, u32)> {
    let mut walk = Walk { defs, layout, ranges: Vec::new() };
    for &var in &defs.globals {
        walk.variable(var, 0, false);
    }
    for (n, program) in resource.programs.iter().enumerate() {
        for &var in &defs.pous[program.pou].vars {
            walk.variable(var, layout.program(n), false);
        }
    }
    let mut sorted = walk.ranges;
    sorted.sort_unstable();
    let mut merged: Vec<(u32, u32)> = Vec::new();
    for (start, bytes) in sorted {
        match merged.last_mut() {
            Some((s, b)) if start <= *s + *b => *b = (*b).max(start + bytes - *s),
            _ => merged.push((start, bytes)),
        }
    }
    merged
}

struct Walk<'a> {
    defs: &'a Defs,
    layout: &'a Layout,
    ranges: Vec<(u32, u32)>,
}

impl Walk<'_> {
    /// A variable of the instance at `base`; `all`: the instance is RETAIN.
    fn variable(&mut self, id: VarId, base: u32, all: bool) {
        let var = &self.defs.vars[id];
        // What says NON_RETAIN is not kept in an instance that is RETAIN either.
        if matches!(var.section, Section::InOut | Section::Temp) || var.constant || var.non_retain {
            return;
        }
        let all = all || var.retain;
        match self.layout.offset(id, base) {
            Some((offset, Some(_bit))) if all => self.push(offset, 1),
            Some((offset, None)) => self.value(var.ty, offset, all),
            _ => {}
        }
    }

    /// A value at `offset`: `all` of it, or what is declared RETAIN inside.
    fn value(&mut self, ty: TypeId, offset: u32, all: bool) {
        let shape = self.layout.shapes.of(self.defs, ty);
        if !all && !shape.retain {
            return;
        }
        if all && !shape.references && !shape.non_retain {
            self.push(offset, shape.bytes as u32);
            return;
        }
        match &self.defs.types[ty] {
            Type::Array { elem, .. } => {
                let stride = self.layout.size(self.defs, *elem);
                let count = (shape.bytes as u32).checked_div(stride).unwrap_or(0);
                for n in 0..count {
                    self.value(*elem, offset + n * stride, all);
                }
            }
            Type::Struct(id) => {
                for (n, field) in self.defs.structs[*id].fields.iter().enumerate() {
                    self.value(field.ty, offset + self.layout.field(*id, n as u32), all);
                }
            }
            Type::Instance(id) => {
                for &var in &self.defs.pous[*id].vars {
                    self.variable(var, offset, all);
                }
            }
            _ => {}
        }
    }

    fn push(&mut self, start: u32, bytes: u32) {
        match self.ranges.last_mut() {
            Some((s, b)) if *s + *b == start => *b += bytes,
            _ if bytes > 0 => self.ranges.push((start, bytes)),
            _ => {}
        }
    }
}
