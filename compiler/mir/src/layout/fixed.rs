//! Addresses that are known when the layout is: of references that are initialised, of the variable that releases a task.

use super::Layout;
use plcc_diag::bug;
use plcc_hir::body::{ExprKind, Place, Root, Step};
use plcc_hir::shape::extent;
use plcc_hir::{Defs, Type};

impl Layout {
    /// Where a place lies that has components and constant indices only: its offset, and a bit of that byte. `instance` is the
    /// offset of the instance whose variable it is.
    pub fn address_of(&self, defs: &Defs, place: &Place, instance: u32) -> (u32, Option<u8>) {
        let (root, mut ty) = match place.root {
            Root::Var(root) => (self.offset(root, instance), defs.vars[root].ty),
            Root::Address(at) => (Some((self.area(at.area).start + at.byte, at.bit)), place.ty),
            _ => bug!("a fixed address of {:?}", place.root),
        };
        let Some((mut offset, bit)) = root else { bug!("{:?} has no address", place.root) };
        for step in &place.steps {
            match (step, &defs.types[ty]) {
                (Step::Field(n), Type::Struct(id)) => {
                    offset += self.field(*id, *n);
                    ty = defs.structs[*id].fields[*n as usize].ty;
                }
                (Step::Member(member), _) => {
                    let Some((inside, _)) = self.offset(*member, offset) else { bug!("a member without place") };
                    offset = inside;
                    ty = defs.vars[*member].ty;
                }
                (Step::Index(indices, _), Type::Array { dims, elem }) => {
                    let mut flat = 0i64;
                    for (index, dim) in indices.iter().zip(dims) {
                        let ExprKind::Const(raw) = index.kind else { bug!("a fixed address with a variable index") };
                        flat = flat * extent(*dim) as i64 + (raw as i64 - dim.0);
                    }
                    offset += flat as u32 * self.size(defs, *elem);
                    ty = *elem;
                }
                (step, ty) => bug!("a fixed address through {step:?} of {ty:?}"),
            }
        }
        (offset, bit)
    }
}
