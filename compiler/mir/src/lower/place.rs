//! Places: from a root inwards, with the checks of indices and references on the way.
//!
//! Out: an [`Access`], which is read and written here too, because bits and parts of a word are read and written through
//! the whole word. The checks of a place are done where the place stands in the source, from left to right.

use super::func::FuncLower;
use super::path;
use crate::ir::{Base, IndexTerm, Place, ValueId};
use crate::layout::MAX_REGION_BYTES;
use plcc_diag::bug;
use plcc_hir::body::{self, Expr, ExprKind, OpenIndex, Root, Step};
use plcc_hir::elem_of;
use plcc_hir::shape::{address_taken, extent, repr};
use plcc_hir::{PouKind, Type, TypeId, Types, VarId};
use plcc_stdlib::elem::Elem;
use plcc_stdlib::fault::Fault;
use plcc_stdlib::prim::{PrimOp, Repr};

/// Offsets of indices beyond this are moved into the index, so that no sum of a place can overflow.
const FAR: i64 = 1 << 40;

/// What a place is resolved for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// It is read or written: a reference must reach all of it.
    Access,
    /// Only its address is taken: a reference must point into the addressable part (or just behind it).
    Address,
}

/// A resolved place.
#[derive(Debug, Clone)]
pub(super) struct Access {
    /// Where.
    pub place: Place,
    /// What lies there; with a `part` the type of that.
    pub ty: TypeId,
    /// A bit or part of a word that lies there.
    part: Option<Part>,
    /// A BOOL that lies there may be any byte.
    normalise: bool,
    /// Names the reference that was followed last, and was not checked yet for the size of the access.
    unchecked: Option<String>,
    /// Of a string without fixed capacity: the capacity (I32) that came with its reference.
    pub capacity: Option<ValueId>,
}

/// A bit or part of a word.
#[derive(Debug, Clone, Copy)]
struct Part {
    word: Elem,
    /// Its lowest bit.
    shift: u32,
    /// Its type; BOOL for a bit.
    elem: Elem,
}

impl FuncLower<'_, '_> {
    /// Resolves a place that is read or written.
    pub fn place(&mut self, place: &body::Place) -> Access {
        self.resolve(place, Purpose::Access)
    }

    /// Resolves a place.
    pub fn resolve(&mut self, place: &body::Place, purpose: Purpose) -> Access {
        let mut access = self.root(place);
        for (n, step) in place.steps.iter().enumerate() {
            self.step(&mut access, place, n, step);
        }
        let bytes = match (purpose, access.part) {
            (Purpose::Address, _) => 0,
            (Purpose::Access, Some(part)) => part.word.bytes(),
            // The capacity came with the reference; at least the closing 0 is there.
            (Purpose::Access, None) if access.capacity.is_some() => 1,
            (Purpose::Access, None) => self.cx.layout.size(self.defs, access.ty),
        };
        self.check_reference(&mut access, place, bytes);
        if !place.steps.is_empty() {
            let defs = self.defs;
            self.name_place(&access.place, || path::of_place(defs, place, place.steps.len()));
        }
        access
    }

    /// The access to a variable of this function, its instance, or a global one.
    pub fn variable(&mut self, id: VarId) -> Access {
        let var = &self.defs.vars[id];
        let place = self.own_place(id);
        let of_exposed_block = var
            .owner
            .is_some_and(|pou| self.defs.pous[pou].kind == PouKind::FunctionBlock && self.cx.layout.exposed(pou));
        let normalise = self.cx.layout.is_addressable(self.defs, id)
            || var.address.is_some_and(|a| a.bit.is_none())
            || (place.base == Base::Instance && of_exposed_block);
        self.follow_in_out(Access { place, ty: var.ty, part: None, normalise, unchecked: None, capacity: None }, id)
    }

    /// The access to a variable of the instance at a place.
    pub fn member(&mut self, instance: &Access, id: VarId) -> Access {
        let member = self.member_slot(instance, id);
        self.follow_in_out(member, id)
    }

    /// The access to what an instance holds for a variable: for a VAR_IN_OUT its reference.
    pub fn member_slot(&mut self, instance: &Access, id: VarId) -> Access {
        use crate::layout::Slot;
        let var = &self.defs.vars[id];
        let mut access = Access { ty: var.ty, ..instance.clone() };
        match self.cx.layout.slot(id) {
            Some(Slot::Instance(offset)) => access.place = access.place.plus(offset),
            Some(Slot::Region(offset, bit)) => {
                access.place = Place { bit, ..Place::new(Base::Region, offset) };
                access.unchecked = None;
                access.normalise = bit.is_none();
            }
            _ => bug!("variable {} is no part of an instance", var.name),
        }
        access.normalise |= address_taken(var);
        access
    }

    /// A VAR_IN_OUT stands for the variable whose reference it holds; the caller checked that.
    fn follow_in_out(&mut self, mut access: Access, id: VarId) -> Access {
        if self.defs.vars[id].section == plcc_hir::Section::InOut {
            let reference = self.b.load(Repr::I32, access.place.clone(), false);
            access.capacity = self.carried_capacity(&access);
            access.place = Place::new(Base::Reference(reference), 0);
            access.normalise = true;
            access.unchecked = None;
        }
        access
    }

    /// The capacity behind the reference that a VAR_IN_OUT holds, if it is a string of any.
    fn carried_capacity(&mut self, slot: &Access) -> Option<ValueId> {
        let carries = matches!(self.defs.types[slot.ty], Type::AnyString { .. });
        carries.then(|| self.b.load(Repr::I32, slot.place.clone().plus(Repr::I32.bytes()), false))
    }

    fn root(&mut self, place: &body::Place) -> Access {
        match &place.root {
            Root::Var(id) => self.variable(*id),
            Root::Temp(temp) => self.temp(*temp),
            Root::Deref(reference) => {
                let value = self.value(reference);
                let name = path::of_expr(self.defs, reference);
                let Type::Ref { target, .. } = self.defs.types[reference.ty] else {
                    bug!("a dereference of {:?}", self.defs.types[reference.ty])
                };
                self.follow(value, target, name, place)
            }
            Root::Address(address) => {
                let start = self.cx.layout.area(address.area).start;
                let place_in_region = Place { bit: address.bit, ..Place::new(Base::Region, start + address.byte) };
                // With steps behind it its own type does not matter: see `step`.
                Access {
                    place: place_in_region,
                    ty: place.ty,
                    part: None,
                    normalise: true,
                    unchecked: None,
                    capacity: None,
                }
            }
        }
    }

    /// What a reference points to; its bounds are checked when the size of the access is known.
    fn follow(&mut self, reference: ValueId, target: TypeId, name: String, place: &body::Place) -> Access {
        if self.cx.checks.pointer {
            let null = self.b.number(Repr::I32, 0);
            let ok = self.b.op(PrimOp::Ne, Repr::I32, &[reference, null]);
            self.at(place.span, &name);
            self.b.check_true(ok, Fault::NullReference, &[]);
        }
        let place = Place::new(Base::Reference(reference), 0);
        Access { place, ty: target, part: None, normalise: true, unchecked: Some(name), capacity: None }
    }

    fn step(&mut self, access: &mut Access, place: &body::Place, n: usize, step: &Step) {
        match step {
            Step::Field(index) => {
                let Type::Struct(id) = self.defs.types[access.ty] else { bug!("a field of {:?}", access.ty) };
                let def = &self.defs.structs[id];
                access.place.offset += i64::from(self.cx.layout.field(id, *index));
                access.ty = def.fields[*index as usize].ty;
                access.normalise |= def.union || self.cx.layout.aliasing;
            }
            Step::Member(id) => {
                if self.defs.vars[*id].section == plcc_hir::Section::InOut {
                    // From outside of the call: the reference of the last one, NULL before the first.
                    let mut slot = self.member_slot(access, *id);
                    self.check_reference(&mut slot, place, Repr::I32.bytes());
                    let reference = self.b.load(Repr::I32, slot.place.clone(), false);
                    let name = path::of_place(self.defs, place, n + 1);
                    let capacity = self.carried_capacity(&slot);
                    *access = Access { capacity, ..self.follow(reference, slot.ty, name, place) };
                } else {
                    *access = self.member(access, *id);
                }
            }
            Step::Index(indices, name) => self.index(access, indices, name),
            Step::OpenIndex(indices, name) => self.open_index(access, indices, name),
            Step::Character { index, first, name } => self.character(access, index, *first, name),
            Step::Deref => {
                let Type::Ref { target, .. } = self.defs.types[access.ty] else {
                    bug!("a dereference of {:?}", access.ty)
                };
                self.check_reference(access, place, Repr::I32.bytes());
                let reference = self.b.load(Repr::I32, access.place.clone(), false);
                let name = path::of_place(self.defs, place, n);
                *access = self.follow(reference, target, name, place);
            }
            Step::Bit(bit) => self.part(access, place, n, Elem::Bool, u32::from(*bit)),
            Step::Flags(word) => {
                access.ty = Types::elem(*word);
                access.normalise = false;
            }
            Step::Part(elem, number) => self.part(access, place, n, *elem, u32::from(*number) * elem.bits()),
        }
    }

    fn part(&mut self, access: &mut Access, place: &body::Place, n: usize, to: Elem, shift: u32) {
        if n == 0 && matches!(place.root, Root::Address(_)) {
            // The place has the type of the part. The region is little-endian: the part lies at its own address.
            access.place.offset += i64::from(shift / 8);
            access.place.bit = (to == Elem::Bool).then_some((shift % 8) as u8);
            access.ty = Types::elem(to);
            return;
        }
        let (word, outer) = match (access.part, elem_of(self.defs, access.ty)) {
            (Some(part), _) => (part.word, part.shift),
            (None, Some(word)) => (word, 0),
            (None, None) => bug!("a part of {:?}", self.defs.types[access.ty]),
        };
        access.part = Some(Part { word, shift: outer + shift, elem: to });
        access.ty = Types::elem(to);
    }

    fn index(&mut self, access: &mut Access, indices: &[Expr], name: &str) {
        let Type::Array { dims, elem } = &self.defs.types[access.ty] else {
            bug!("an index into {:?}", self.defs.types[access.ty])
        };
        let mut strides = vec![self.cx.layout.shapes.of(self.defs, *elem).bytes; dims.len()];
        for n in (1..dims.len()).rev() {
            strides[n - 1] = strides[n].saturating_mul(extent(dims[n]));
        }
        for ((index, &(low, high)), stride) in indices.iter().zip(dims).zip(strides) {
            // Only an array that no variable can have is that large.
            let stride = u32::try_from(stride).unwrap_or(u32::MAX);
            if let Some(raw) = constant(index) {
                let index = raw as i64;
                if (low..=high).contains(&index) {
                    access.place.offset =
                        access.place.offset.wrapping_add(index.wrapping_sub(low).wrapping_mul(i64::from(stride)));
                    continue;
                }
            }
            let mut value = self.value(index);
            if self.cx.checks.index {
                self.at(index.span, name);
                self.b.check_within(value, low, high, Fault::IndexOutOfBounds);
            } else {
                let (l, h) = (self.b.number(Repr::I64, low as u64), self.b.number(Repr::I64, high as u64));
                value = self.b.op(PrimOp::MaxS, Repr::I64, &[value, l]);
                value = self.b.op(PrimOp::MinS, Repr::I64, &[value, h]);
            }
            let base = low.checked_mul(i64::from(stride)).filter(|b| (-FAR..=FAR).contains(b));
            let (term, base) = match base {
                Some(base) => (IndexTerm { value, stride, low, high }, base),
                None => {
                    let l = self.b.number(Repr::I64, low as u64);
                    let value = self.b.op(PrimOp::Sub, Repr::I64, &[value, l]);
                    (IndexTerm { value, stride, low: 0, high: high.wrapping_sub(low) }, 0)
                }
            };
            access.place.offset -= base;
            access.place.index.push(term);
        }
        access.ty = *elem;
        access.normalise |= self.cx.layout.aliasing;
    }

    /// Indices into an array whose bounds are values: the elements are counted through all dimensions.
    fn open_index(&mut self, access: &mut Access, indices: &[OpenIndex], name: &str) {
        let Type::AnyArray { elem, .. } = self.defs.types[access.ty] else {
            bug!("an open index into {:?}", self.defs.types[access.ty])
        };
        let mut flat: Option<ValueId> = None;
        for index in indices {
            let mut value = self.value(&index.value);
            let (low, high) = (self.value(&index.low), self.value(&index.high));
            if self.cx.checks.index {
                let from = self.b.op(PrimOp::LeS, Repr::I64, &[low, value]);
                let to = self.b.op(PrimOp::LeS, Repr::I64, &[value, high]);
                let ok = self.b.op(PrimOp::And, Repr::I8, &[from, to]);
                self.at(index.value.span, name);
                self.b.check_true(ok, Fault::IndexOutOfBounds, &[value, low, high]);
            } else {
                value = self.b.op(PrimOp::MaxS, Repr::I64, &[value, low]);
                value = self.b.op(PrimOp::MinS, Repr::I64, &[value, high]);
            }
            let mut number = self.b.op(PrimOp::Sub, Repr::I64, &[value, low]);
            if let Some(outer) = flat {
                let one = self.b.number(Repr::I64, 1);
                let span = self.b.op(PrimOp::Sub, Repr::I64, &[high, low]);
                let count = self.b.op(PrimOp::Add, Repr::I64, &[span, one]);
                let rows = self.b.op(PrimOp::Mul, Repr::I64, &[outer, count]);
                number = self.b.op(PrimOp::Add, Repr::I64, &[rows, number]);
            }
            flat = Some(number);
        }
        let Some(value) = flat else { bug!("an open array without dimensions") };
        let bytes = self.cx.layout.shapes.of(self.defs, elem).bytes.max(1);
        let stride = u32::try_from(bytes).unwrap_or(u32::MAX);
        // However large the actual array is, it lies in the region.
        let high = (MAX_REGION_BYTES / u64::from(stride)) as i64;
        access.place.index.push(IndexTerm { value, stride, low: 0, high });
        access.ty = elem;
        access.normalise |= self.cx.layout.aliasing;
    }

    /// One character: a unit of a string, up to the last that its capacity has, counted from `first`.
    fn character(&mut self, access: &mut Access, index: &Expr, first: u8, name: &str) {
        let Some(text) = self.text_at(access) else { bug!("a character of {:?}", self.defs.types[access.ty]) };
        let stride = text.unit_bytes();
        let low = i64::from(first);
        let fixed = text.known().map(i64::from);
        access.ty = Types::elem(match (first, stride) {
            (0, 1) => Elem::Byte,
            (0, _) => Elem::Word,
            (_, 1) => Elem::Char,
            _ => Elem::Wchar,
        });
        access.capacity = None;
        if let (Some(raw), Some(last)) = (constant(index), fixed)
            && (low..=last).contains(&(raw as i64))
        {
            access.place.offset += (raw as i64 - low) * i64::from(stride);
            return;
        }
        let mut value = self.value(index);
        let capacity = self.capacity(&text);
        let last = self.b.resize(capacity, false, Repr::I64);
        if self.cx.checks.index {
            self.at(index.span, name);
            match fixed {
                Some(high) => self.b.check_within(value, low, high, Fault::IndexOutOfBounds),
                None => {
                    let start = self.b.number(Repr::I64, low as u64);
                    let from = self.b.op(PrimOp::LeS, Repr::I64, &[start, value]);
                    let to = self.b.op(PrimOp::LeS, Repr::I64, &[value, last]);
                    let ok = self.b.op(PrimOp::And, Repr::I8, &[from, to]);
                    self.b.check_true(ok, Fault::IndexOutOfBounds, &[value, start, last]);
                }
            }
        } else {
            let start = self.b.number(Repr::I64, low as u64);
            value = self.b.op(PrimOp::MinS, Repr::I64, &[value, last]);
            value = self.b.op(PrimOp::MaxS, Repr::I64, &[value, start]);
        }
        let high = fixed.unwrap_or(i64::from(self.cx.longest[usize::from(text.wide)]));
        access.place.offset -= low * i64::from(stride);
        access.place.index.push(IndexTerm { value, stride, low, high });
    }

    /// Checks that a reference that was followed reaches an access of this size: all of it lies in the addressable part.
    fn check_reference(&mut self, access: &mut Access, place: &body::Place, bytes: u32) {
        let (Some(name), Base::Reference(reference)) = (access.unchecked.take(), access.place.base) else { return };
        // The address of the access itself, not of the whole target.
        let mut address = self.b.resize(reference, false, Repr::I64);
        if access.place.offset != 0 {
            let offset = self.b.number(Repr::I64, access.place.offset as u64);
            address = self.b.op(PrimOp::Add, Repr::I64, &[address, offset]);
        }
        for term in &access.place.index {
            let stride = self.b.number(Repr::I64, u64::from(term.stride));
            let bytes = self.b.op(PrimOp::Mul, Repr::I64, &[term.value, stride]);
            address = self.b.op(PrimOp::Add, Repr::I64, &[address, bytes]);
        }
        let part = self.cx.layout.addressable;
        let start = self.b.number(Repr::I64, u64::from(part.start));
        let distance = self.b.op(PrimOp::Sub, Repr::I64, &[address, start]);
        if self.cx.checks.pointer || bytes > part.bytes {
            let ok = if bytes > part.bytes {
                self.b.number(Repr::I8, 0)
            } else {
                let last = self.b.number(Repr::I64, u64::from(part.bytes - bytes));
                self.b.op(PrimOp::LeU, Repr::I64, &[distance, last])
            };
            let size = self.b.number(Repr::I64, u64::from(bytes));
            self.at(place.span, &name);
            self.b.check_true(ok, Fault::BadReference, &[address, size]);
        } else {
            let last = self.b.number(Repr::I64, u64::from(part.bytes - bytes));
            let distance = self.b.op(PrimOp::MinU, Repr::I64, &[distance, last]);
            let inside = self.b.op(PrimOp::Add, Repr::I64, &[start, distance]);
            let inside = self.b.resize(inside, false, Repr::I32);
            access.place = Place { bit: access.place.bit, ..Place::new(Base::Reference(inside), 0) };
        }
    }

    // ---- reading and writing scalars ----

    /// Reads the scalar that lies there.
    pub fn load(&mut self, access: &Access) -> ValueId {
        let Some(part) = access.part else {
            let Some(repr) = repr(self.defs, access.ty) else { bug!("a load of {:?}", self.defs.types[access.ty]) };
            let normalise = access.normalise && access.place.bit.is_none() && self.is_bool(access.ty);
            return self.b.load(repr, access.place.clone(), normalise);
        };
        let word = part.word.repr();
        let mut value = self.b.load(word, access.place.clone(), false);
        if part.shift > 0 {
            let shift = self.b.number(Repr::I64, u64::from(part.shift));
            value = self.b.op(PrimOp::ShrU, word, &[value, shift]);
        }
        value = self.b.resize(value, false, part.elem.repr());
        if part.elem == Elem::Bool {
            let one = self.b.number(Repr::I8, 1);
            value = self.b.op(PrimOp::And, Repr::I8, &[value, one]);
        }
        value
    }

    /// Writes a scalar there.
    pub fn store(&mut self, access: &Access, value: ValueId) {
        let Some(part) = access.part else {
            self.b.store(access.place.clone(), value);
            return;
        };
        let word = part.word.repr();
        let mask = if part.elem == Elem::Bool { 1 } else { part.elem.repr().mask() };
        let old = self.b.load(word, access.place.clone(), false);
        let keep = self.b.number(word, !(mask << part.shift));
        let rest = self.b.op(PrimOp::And, word, &[old, keep]);
        let mut new = self.b.resize(value, false, word);
        if part.shift > 0 {
            let shift = self.b.number(Repr::I64, u64::from(part.shift));
            new = self.b.op(PrimOp::Shl, word, &[new, shift]);
        }
        let new = self.b.op(PrimOp::Or, word, &[rest, new]);
        self.b.store(access.place.clone(), new);
    }

    /// The region offset of a variable that is given to a VAR_IN_OUT or to `REF`.
    pub fn address(&mut self, place: &body::Place, purpose: Purpose) -> ValueId {
        let access = self.resolve(place, purpose);
        if access.part.is_some() || access.place.bit.is_some() {
            bug!("the address of a bit or part");
        }
        // A reference that is passed on as it is.
        if let (Base::Reference(value), 0, true) =
            (access.place.base, access.place.offset, access.place.index.is_empty())
        {
            return value;
        }
        // A reference that is kept goes through its checks; what is handed to a VAR_IN_OUT reaches all of the variable.
        let bytes = match purpose {
            Purpose::Address => 0,
            Purpose::Access => self.cx.layout.size(self.defs, access.ty),
        };
        self.b.address_of(access.place, bytes)
    }

    /// An access to a variable of a callee: in the addressable part a BOOL may be any byte.
    pub fn maybe_any_byte(place: Place, ty: TypeId) -> Access {
        let normalise = place.base == Base::Region;
        Access { normalise, ..Self::plain(place, ty) }
    }

    /// An access to a scalar or aggregate of the function's own making.
    pub fn plain(place: Place, ty: TypeId) -> Access {
        Access { place, ty, part: None, normalise: false, unchecked: None, capacity: None }
    }
}

/// The value of a constant expression.
pub(super) fn constant(expr: &Expr) -> Option<u64> {
    match &expr.kind {
        ExprKind::Const(raw) => Some(*raw),
        ExprKind::Retype(inner) => constant(inner),
        _ => None,
    }
}
