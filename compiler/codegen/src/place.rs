//! Places to addresses; loads, stores, copies.

use crate::func::Translator;
use crate::prim::clif_type;
use cranelift_codegen::ir::{Endianness, InstBuilder, MemFlagsData, Type, Value, types};
use plcc_mir::ir::{Base, IndexTerm, Place};
use plcc_stdlib::prim::Repr;

/// Blocks of at most so many bytes are copied or cleared by single moves.
const INLINE_BYTES: u32 = 64;

/// Larger blocks are copied through vector registers. What was just written field by field comes out of smaller ones sooner.
const VECTORS_FROM: u32 = 32;

/// The flags of every access to the region: little-endian on every target, inside the region, any alignment.
pub fn memory() -> MemFlagsData {
    MemFlagsData::new().with_notrap().with_endianness(Endianness::Little)
}

impl Translator<'_, '_> {
    /// Base address and constant offset.
    pub fn address(&mut self, place: &Place) -> (Value, i32) {
        let mut base = match place.base {
            Base::Region => self.region,
            Base::Instance => self.instance.unwrap_or_else(|| plcc_diag::bug!("no instance in `{}`", self.func.name)),
            Base::Frame => self.frame.unwrap_or_else(|| plcc_diag::bug!("no frame in `{}`", self.func.name)),
            Base::Reference(value) => {
                let value = self.value(value);
                let offset = self.b.ins().uextend(types::I64, value);
                self.b.ins().iadd(self.region, offset)
            }
        };
        for term in &place.index {
            let step = self.step(term);
            base = self.b.ins().iadd(base, step);
        }
        match i32::try_from(place.offset) {
            Ok(offset) => (base, offset),
            Err(_) => {
                let offset = self.b.ins().iconst(types::I64, place.offset);
                (self.b.ins().iadd(base, offset), 0)
            }
        }
    }

    /// The address in one value.
    pub fn pointer(&mut self, place: &Place) -> Value {
        let (base, offset) = self.address(place);
        if offset == 0 { base } else { self.b.ins().iadd_imm_s(base, i64::from(offset)) }
    }

    /// A shift, where it is one: machines have addresses with a scaled index.
    fn step(&mut self, term: &IndexTerm) -> Value {
        let value = self.value(term.value);
        if term.stride == 1 {
            value
        } else if term.stride.is_power_of_two() {
            self.b.ins().ishl_imm_u(value, i64::from(term.stride.trailing_zeros()))
        } else {
            self.b.ins().imul_imm_u(value, i64::from(term.stride))
        }
    }

    /// Reads a scalar.
    pub fn load(&mut self, repr: Repr, place: &Place, normalise: bool) -> Value {
        let (base, offset) = self.address(place);
        let value = self.b.ins().load(clif_type(repr), memory(), base, offset);
        match place.bit {
            Some(bit) => {
                let low = if bit == 0 { value } else { self.b.ins().ushr_imm_u(value, i64::from(bit)) };
                self.b.ins().band_imm_u(low, 1)
            }
            None if normalise => self.b.ins().icmp_imm_u(cranelift_codegen::ir::condcodes::IntCC::NotEqual, value, 0),
            None => value,
        }
    }

    /// Reads 8 bits or 16 into 64.
    pub fn load_extended(&mut self, repr: Repr, place: &Place, signed: bool) -> Value {
        let (base, offset) = self.address(place);
        match (repr, signed) {
            (Repr::I8, _) => self.b.ins().uload8(types::I64, memory(), base, offset),
            (_, true) => self.b.ins().sload16(types::I64, memory(), base, offset),
            (_, false) => self.b.ins().uload16(types::I64, memory(), base, offset),
        }
    }

    /// Writes a scalar.
    pub fn store(&mut self, place: &Place, value: Value) {
        let (base, offset) = self.address(place);
        let value = match place.bit {
            Some(bit) => {
                let old = self.b.ins().load(types::I8, memory(), base, offset);
                let kept = self.b.ins().band_imm_u(old, i64::from(!(1u8 << bit)));
                let new = if bit == 0 { value } else { self.b.ins().ishl_imm_u(value, i64::from(bit)) };
                self.b.ins().bor(kept, new)
            }
            None => value,
        };
        self.b.ins().store(memory(), value, base, offset);
    }

    /// Copies; the ranges may overlap, so all is read before anything is written.
    pub fn copy(&mut self, dst: &Place, src: &Place, bytes: u32) {
        if bytes > INLINE_BYTES {
            let (to, from) = (self.pointer(dst), self.pointer(src));
            let count = self.b.ins().iconst(types::I64, i64::from(bytes));
            return self.b.call_memmove(self.env.config, to, from, count);
        }
        let (to, to_offset) = self.address(dst);
        let (from, from_offset) = self.address(src);
        let mut parts = Vec::new();
        for (at, ty) in chunks(bytes, self.env.vectors && bytes >= VECTORS_FROM) {
            let from = self.plus(from, from_offset, at);
            parts.push((at, self.b.ins().load(ty, memory(), from.0, from.1)));
        }
        for (at, value) in parts {
            let to = self.plus(to, to_offset, at);
            self.b.ins().store(memory(), value, to.0, to.1);
        }
    }

    /// Clears.
    pub fn zero(&mut self, dst: &Place, bytes: u32) {
        if bytes > INLINE_BYTES {
            let to = self.pointer(dst);
            let zero = self.b.ins().iconst(types::I8, 0);
            let count = self.b.ins().iconst(types::I64, i64::from(bytes));
            return self.b.call_memset(self.env.config, to, zero, count);
        }
        let (to, to_offset) = self.address(dst);
        for (at, ty) in chunks(bytes, self.env.vectors) {
            let zero = if ty.is_vector() {
                let zeros = self.b.func.dfg.constants.insert([0; 16][..].into());
                self.b.ins().vconst(ty, zeros)
            } else {
                self.b.ins().iconst(ty, 0)
            };
            let to = self.plus(to, to_offset, at);
            self.b.ins().store(memory(), zero, to.0, to.1);
        }
    }

    /// `at` bytes further; the sum may leave the range of an immediate.
    fn plus(&mut self, base: Value, offset: i32, at: i32) -> (Value, i32) {
        match offset.checked_add(at) {
            Some(offset) => (base, offset),
            None => (self.b.ins().iadd_imm_s(base, i64::from(offset) + i64::from(at)), 0),
        }
    }
}

/// Cuts a block into moves, great ones first.
fn chunks(bytes: u32, vectors: bool) -> Vec<(i32, Type)> {
    let mut parts = Vec::new();
    let mut at = 0;
    let vector = vectors.then_some((16, types::I8X16));
    let scalars = [(8, types::I64), (4, types::I32), (2, types::I16), (1, types::I8)];
    for (size, ty) in vector.into_iter().chain(scalars) {
        while bytes - at >= size {
            parts.push((at as i32, ty));
            at += size;
        }
    }
    parts
}
