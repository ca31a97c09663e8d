//! Strings (semantics.md \[T8\]): where the string of an expression lies, and copies; operations are in `text_ops`.
//!
//! A string is a place with a capacity. One that an operation gives is built where it is to go, if that place overlaps no
//! operand for certain; else in a temporary of the frame, from which it is copied. Bodies are in `stdlib::rt::strings`.

use super::func::FuncLower;
use super::place::Access;
use super::text_ops::texts;
use crate::ir::{Base, Place, ValueId};
use plcc_diag::bug;
use plcc_hir::body::{Expr, ExprKind};
use plcc_hir::visit::{self, Visitor};
use plcc_hir::{Defs, Type, TypeId};
use plcc_stdlib::funcs::TextOp;
use plcc_stdlib::prim::{PrimOp, Repr};
use plcc_stdlib::rt::strings::TextFns;
use plcc_stdlib::value::longest_text;
use std::sync::Arc;

/// Strings of at most so many bytes are copied by their capacity, without looking for their end.
const INLINE_BYTES: u32 = 128;

/// No operation gives a longer string.
const LONGEST: u32 = 1 << 20;

/// A string in memory.
#[derive(Debug, Clone)]
pub(super) struct Text {
    pub place: Place,
    pub wide: bool,
    pub(super) capacity: Capacity,
    /// Nothing but this expression knows it: a constant, or a temporary.
    pub(super) own: bool,
    /// What lies behind its end is left over from something else. A program can look there (by subscript, UNION or pointer),
    /// so that it must not get into a variable: what a temporary held before depends on where frames lie.
    pub(super) left_over: bool,
    /// One of several that SEL and its kind chose at run time, maybe of the own frame.
    pub(super) chosen: bool,
    /// The bytes in front of the first 0 of a constant.
    pub(super) constant: Option<Arc<[u8]>>,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Capacity {
    Known(u32),
    /// Known at run time only, I32.
    Carried(ValueId),
}

impl Text {
    /// A variable.
    pub(super) fn at(place: Place, wide: bool, capacity: Capacity) -> Self {
        Self { place, wide, capacity, own: false, left_over: false, chosen: false, constant: None }
    }

    /// The capacity, if it is fixed.
    pub fn known(&self) -> Option<u32> {
        match self.capacity {
            Capacity::Known(n) => Some(n),
            Capacity::Carried(_) => None,
        }
    }

    /// Bytes of one character.
    pub fn unit_bytes(&self) -> u32 {
        if self.wide { 2 } else { 1 }
    }

    /// Bytes that it takes, the closing 0 included.
    pub(super) fn bytes(&self) -> Option<u64> {
        self.known().map(|n| (u64::from(n) + 1) * u64::from(self.unit_bytes()))
    }
}

/// Memory for strings that expressions make; a statement uses again what the one before has left.
#[derive(Debug, Default)]
pub(super) struct Temps {
    /// Place, bytes, whether it is in use.
    rooms: Vec<(Place, u64, bool)>,
}

impl Temps {
    /// What was taken is free again.
    pub fn release(&mut self) {
        self.rooms.iter_mut().for_each(|room| room.2 = false);
    }

    fn take(&mut self, bytes: u64) -> Option<Place> {
        let free = self.rooms.iter_mut().filter(|(_, size, used)| !used && *size >= bytes);
        let (place, _, used) = free.min_by_key(|(_, size, _)| *size)?;
        *used = true;
        Some(place.clone())
    }
}

/// The capacity of the longest STRING and WSTRING that a variable can have, or a literal where a temporary of a body
/// holds strings of any capacity.
pub(super) fn longest(defs: &Defs) -> [u32; 2] {
    let mut found = [0; 2];
    for body in &defs.bodies {
        if body.temps.iter().any(|ty| matches!(defs.types[*ty], Type::AnyString { .. })) {
            visit::stmts(&body.stmts, &mut Literals(&mut found));
        }
    }
    let fields = defs.structs.iter().flat_map(|s| s.fields.iter().map(|f| f.ty));
    for mut ty in defs.vars.iter().map(|v| v.ty).chain(fields) {
        loop {
            match &defs.types[ty] {
                Type::Array { elem, .. } | Type::Ref { target: elem, .. } => ty = *elem,
                Type::String { wide, capacity } => {
                    let longest = &mut found[usize::from(*wide)];
                    *longest = (*longest).max(*capacity);
                    break;
                }
                _ => break,
            }
        }
    }
    found
}

/// The longest literals of a body.
struct Literals<'f>(&'f mut [u32; 2]);

impl Visitor for Literals<'_> {
    fn expr(&mut self, expr: &Expr) {
        let (wide, length) = match &expr.kind {
            ExprKind::String(s) => (false, s.len()),
            ExprKind::WString(s) => (true, s.len()),
            _ => return,
        };
        let longest = &mut self.0[usize::from(wide)];
        *longest = (*longest).max(length as u32);
    }
}

impl FuncLower<'_, '_> {
    /// Whether values of a type are strings.
    pub fn is_text(&self, ty: TypeId) -> bool {
        matches!(self.defs.types[ty], Type::String { .. } | Type::AnyString { .. })
    }

    /// The string that lies there; `None` if something else does.
    pub fn text_at(&self, access: &Access) -> Option<Text> {
        let (wide, capacity) = match self.defs.types[access.ty] {
            Type::String { wide, capacity } => (wide, Capacity::Known(capacity)),
            Type::AnyString { wide } => match access.capacity {
                Some(capacity) => (wide, Capacity::Carried(capacity)),
                None => bug!("a string without a capacity"),
            },
            _ => return None,
        };
        Some(Text::at(access.place.clone(), wide, capacity))
    }

    /// The inverse of [`FuncLower::text_at`], for a type of strings.
    fn access(&mut self, text: &Text, ty: TypeId) -> Access {
        let mut access = Self::plain(text.place.clone(), ty);
        access.capacity = Some(self.capacity(text));
        access
    }

    /// Makes a string empty.
    pub fn clear_text(&mut self, text: &Text) {
        let end = self.b.number(unit_repr(text.wide), 0);
        self.b.store(text.place.clone(), end);
    }

    /// Where the string of an expression lies. Whatever calls a POU afterwards may change it.
    pub fn text(&mut self, expr: &Expr) -> Text {
        match &expr.kind {
            ExprKind::Read(place) => {
                if let Some(tail) = self.tail_of(expr) {
                    let temp = self.text_temp(tail.0.wide, self.bound(expr));
                    self.build_tail(&temp, &tail, None);
                    return temp;
                }
                let access = self.place(place);
                self.text_at(&access).unwrap_or_else(|| bug!("a string from {:?}", self.defs.types[expr.ty]))
            }
            ExprKind::Temp(temp) => {
                let access = self.temp(*temp);
                let text = self.text_at(&access);
                let text = text.unwrap_or_else(|| bug!("a string from {:?}", self.defs.types[expr.ty]));
                Text { left_over: true, ..text }
            }
            ExprKind::Retype(inner) => self.text(inner),
            ExprKind::String(s) => self.constant_text(s.clone(), false),
            ExprKind::WString(s) => self.constant_text(s.iter().flat_map(|unit| unit.to_le_bytes()).collect(), true),
            ExprKind::Call(call) => {
                let (wide, capacity) = self.string_type(expr.ty);
                let temp = self.text_temp(wide, capacity);
                self.call(call, Some(temp.place.clone()));
                // The whole variable was copied.
                Text { left_over: false, ..temp }
            }
            ExprKind::StdCall(call) => {
                let temp = self.text_temp(self.string_type(expr.ty).0, self.bound(expr));
                let to = self.access(&temp, expr.ty);
                self.std_call(call, expr.ty, Some(&to));
                temp
            }
            ExprKind::Text { op: TextOp::Concat, wide, args } => {
                let pieces = self.pieces(args);
                let temp = self.text_temp(*wide, self.bound(expr));
                self.concat(&pieces, &temp, None);
                temp
            }
            ExprKind::Text { op, wide, args } => {
                if let Some(tail) = self.left_of_tail(*op, args) {
                    let temp = self.text_temp(*wide, self.bound(expr));
                    self.build_tail(&temp, &tail.0, Some(tail.1));
                    return temp;
                }
                let operands = self.operands(args);
                match self.chosen(*op, &operands) {
                    Some(text) => text,
                    None => {
                        let temp = self.text_temp(*wide, self.bound(expr));
                        self.build(*op, &operands, &temp);
                        temp
                    }
                }
            }
            _ => bug!("a string from {:?}", expr.kind),
        }
    }

    /// The same, but nothing that is evaluated afterwards changes it.
    pub fn lasting_text(&mut self, expr: &Expr) -> Text {
        let text = self.text(expr);
        if text.own {
            return text;
        }
        let temp = self.text_temp(text.wide, self.bound(expr));
        self.copy_text(&temp, &text);
        temp
    }

    /// Stores the string that an expression gives.
    pub fn text_into(&mut self, expr: &Expr, to: &Text) {
        if let Some(tail) = self.tail_of(expr) {
            return self.build_tail(to, &tail, None);
        }
        let ExprKind::Text { op, wide, args } = &expr.kind else {
            let from = self.text(expr);
            return self.copy_text(to, &from);
        };
        if *op == TextOp::Concat {
            let pieces = self.pieces(args);
            if texts(&pieces).all(|text| disjoint(to, text)) {
                self.concat(&pieces, to, None);
            } else if !self.append(&pieces, to) {
                self.aside(expr, *wide, to, |s, temp| s.concat(&pieces, temp, None));
            }
            return;
        }
        if let Some((tail, length)) = self.left_of_tail(*op, args) {
            return self.build_tail(to, &tail, Some(length));
        }
        let operands = self.operands(args);
        if let Some(from) = self.chosen(*op, &operands) {
            return self.copy_text(to, &from);
        }
        if let (TextOp::Replace, [first, new]) = (op, operands.texts.as_slice())
            && same(first, to)
            && disjoint(to, new)
        {
            self.call_text(&TextFns::of(*wide).change, &[to, new], &operands.values);
            return;
        }
        // What gives a part of a string may be built over that string itself.
        let part = matches!(op, TextOp::Left | TextOp::Right | TextOp::Mid | TextOp::Delete);
        if operands.texts.iter().all(|text| disjoint(to, text) || part && same(to, text)) {
            self.build(*op, &operands, to);
        } else {
            self.aside(expr, *wide, to, |s, temp| s.build(*op, &operands, temp));
        }
    }

    /// LEFT of a tail: it, and how many characters.
    fn left_of_tail(&mut self, op: TextOp, args: &[Expr]) -> Option<((Text, ValueId), ValueId)> {
        let [text, length] = args else { return None };
        let tail = if op == TextOp::Left { self.tail_of(text) } else { None }?;
        Some((tail, self.value(length)))
    }

    /// Builds the string of an expression in a temporary and copies it.
    fn aside(&mut self, expr: &Expr, wide: bool, to: &Text, build: impl FnOnce(&mut Self, &Text)) {
        // Every result is cut at its end, so what does not fit there need not be made.
        let temp = self.text_temp(wide, self.bound(expr).min(to.known().unwrap_or(LONGEST)));
        build(self, &temp);
        self.copy_text(to, &temp);
    }

    /// Copies a string to where nothing is defined yet; the two do not overlap. What is left over there from something else
    /// must not be seen behind the string's end.
    pub fn copy_text_whole(&mut self, to: &Text, from: &Text) {
        if self.block_bytes(to, from) != to.bytes().map(|n| n as u32 - to.unit_bytes())
            && let Some(bytes) = to.bytes()
        {
            self.b.zero(to.place.clone(), bytes as u32);
        }
        self.copy_text(to, from);
    }

    /// Bytes of characters that are copied without a look for the string's end; `None` if it must be looked for.
    fn block_bytes(&self, to: &Text, from: &Text) -> Option<u32> {
        let bytes = to.known()?.min(from.known()?).checked_mul(to.unit_bytes())?;
        (bytes <= INLINE_BYTES && !from.left_over).then_some(bytes)
    }

    /// Copies a string and cuts it at the capacity. The two may be the same or overlap.
    pub fn copy_text(&mut self, to: &Text, from: &Text) {
        if same(to, from) {
            return;
        }
        if let Some(bytes) = self.block_bytes(to, from) {
            // It ends at its first 0, wherever that is: all characters that both can hold, and a 0 behind them.
            self.b.copy(to.place.clone(), from.place.clone(), bytes);
            let end = self.b.number(unit_repr(to.wide), 0);
            return self.b.store(to.place.clone().plus(bytes), end);
        }
        let start = self.b.number(Repr::I64, 0);
        self.call_text(&TextFns::of(to.wide).put, &[to, from], &[start]);
    }

    /// A string of the frame that lasts to the end of the statement.
    fn text_temp(&mut self, wide: bool, capacity: u32) -> Text {
        let unit = if wide { 2 } else { 1 };
        let bytes = (u64::from(capacity) + 1) * unit;
        let place = self.text_temps.take(bytes).unwrap_or_else(|| {
            let place = self.frame_room(bytes, unit);
            self.text_temps.rooms.push((place.clone(), bytes, true));
            place
        });
        Text {
            place,
            wide,
            capacity: Capacity::Known(capacity),
            own: true,
            left_over: true,
            chosen: false,
            constant: None,
        }
    }

    /// A constant in memory.
    fn constant_text(&mut self, bytes: Vec<u8>, wide: bool) -> Text {
        let unit = if wide { 2 } else { 1 };
        let end = bytes.chunks(unit).position(|unit| unit.iter().all(|byte| *byte == 0));
        let shown: Arc<[u8]> = bytes[..end.map_or(bytes.len(), |n| n * unit)].into();
        let capacity = Capacity::Known((bytes.len() / unit) as u32);
        let place = self.string_constant(bytes, unit);
        Text { place, wide, capacity, own: true, left_over: false, chosen: false, constant: Some(shown) }
    }

    fn string_type(&self, ty: TypeId) -> (bool, u32) {
        match self.defs.types[ty] {
            Type::String { wide, capacity } => (wide, capacity),
            Type::AnyString { wide } => (wide, self.cx.longest[usize::from(wide)]),
            _ => bug!("{:?} as a string", self.defs.types[ty]),
        }
    }

    /// The most characters that an expression can give.
    fn bound(&self, expr: &Expr) -> u32 {
        match &expr.kind {
            ExprKind::Retype(inner) => self.bound(inner),
            ExprKind::StdCall(call) if matches!(self.defs.types[expr.ty], Type::AnyString { .. }) => {
                call.value.as_ref().map_or(0, |value| self.bound(value))
            }
            ExprKind::Text { op: TextOp::Write(elem), .. } => longest_text(*elem),
            ExprKind::Text { op, args, .. } => {
                let bounds = args.iter().filter(|a| self.is_text(a.ty)).map(|a| self.bound(a));
                let bound = match op {
                    TextOp::Concat | TextOp::Insert | TextOp::Replace => {
                        bounds.fold(0, |sum: u32, bound| sum.saturating_add(bound))
                    }
                    _ => bounds.max().unwrap_or(0),
                };
                bound.min(LONGEST)
            }
            _ => self.string_type(expr.ty).1,
        }
    }

    /// The capacity of a string, I32.
    pub fn capacity(&mut self, text: &Text) -> ValueId {
        match text.capacity {
            Capacity::Known(n) => self.b.number(Repr::I32, u64::from(n)),
            Capacity::Carried(value) => value,
        }
    }

    pub(super) fn offset_of(&mut self, text: &Text) -> ValueId {
        match (text.place.base, text.place.offset, text.place.index.is_empty()) {
            (Base::Reference(value), 0, true) => value,
            _ => {
                let units = text.known().map_or(0, |capacity| capacity.saturating_add(1));
                self.b.address_of(text.place.clone(), units.saturating_mul(text.unit_bytes()))
            }
        }
    }

    /// A reference to a string with its capacity above it, as a VAR_IN_OUT of any capacity holds it.
    pub fn packed(&mut self, text: &Text) -> ValueId {
        let (at, capacity) = (self.offset_of(text), self.capacity(text));
        let at = self.b.resize(at, false, Repr::I64);
        let capacity = self.b.resize(capacity, false, Repr::I64);
        let bits = self.b.number(Repr::I64, 32);
        let above = self.b.op(PrimOp::Shl, Repr::I64, &[capacity, bits]);
        self.b.op(PrimOp::Or, Repr::I64, &[above, at])
    }
}

/// Whether two are the same string.
pub(super) fn same(a: &Text, b: &Text) -> bool {
    a.place == b.place && a.known().is_some() && a.known() == b.known()
}

pub(super) fn unit_repr(wide: bool) -> Repr {
    if wide { Repr::I16 } else { Repr::I8 }
}

/// Whether two strings share no byte for certain. The own frame is apart from everything else: what lies in it has no address
/// that anyone else could hold while this function runs.
pub(super) fn disjoint(to: &Text, from: &Text) -> bool {
    if from.own {
        return true;
    }
    if from.chosen {
        return false;
    }
    if (to.place.base == Base::Frame) != (from.place.base == Base::Frame) {
        return true;
    }
    if to.place.base != from.place.base {
        return false;
    }
    match (extent(to), extent(from)) {
        (Some(a), Some(b)) => a.1 <= b.0 || b.1 <= a.0,
        _ => false,
    }
}

/// The bytes behind its base that a string can take: first, and behind the last.
fn extent(text: &Text) -> Option<(i128, i128)> {
    let bytes = i128::from(text.bytes()?);
    let (mut first, mut last) = (i128::from(text.place.offset), i128::from(text.place.offset));
    for term in &text.place.index {
        first += i128::from(term.low) * i128::from(term.stride);
        last += i128::from(term.high) * i128::from(term.stride);
    }
    Some((first, last + bytes))
}
