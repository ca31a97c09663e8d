//! Strings (semantics.md \[T8\] \[N2\]): where the string of an expression lies, and the operations on them.
//!
//! A string is a place with a capacity. One that an operation gives is built where it is to go, if that place overlaps no
//! operand for certain; else in a temporary of the frame, from which it is copied. Bodies are in `stdlib::rt::strings`.

use super::func::FuncLower;
use super::place::Access;
use crate::ir::{Base, IndexTerm, Place, TextPlace, ValueId};
use plcc_diag::bug;
use plcc_hir::body::{Expr, ExprKind};
use plcc_hir::visit::{self, Visitor};
use plcc_hir::{Defs, Type, TypeId};
use plcc_stdlib::elem::Elem;
use plcc_stdlib::funcs::TextOp;
use plcc_stdlib::ops::Op;
use plcc_stdlib::prim::{PrimOp, Repr};
use plcc_stdlib::rt::strings::{TextFn, TextFns};
use plcc_stdlib::value::longest_text;
use std::rc::Rc;

/// Strings of at most so many bytes are copied by their capacity, without looking for their end.
const INLINE_BYTES: u32 = 128;

/// Constants of at most so many bytes, the closing 0 with them, stand in the code.
const SHORT_BYTES: u32 = 16;

/// No operation gives a longer string.
const LONGEST: u32 = 1 << 20;

/// A string in memory.
#[derive(Debug, Clone)]
pub(super) struct Text {
    pub place: Place,
    pub wide: bool,
    capacity: Capacity,
    /// Nothing but this expression knows it: a constant, or a temporary.
    own: bool,
    /// What lies behind its end is left over from something else. A program can look there (by subscript, UNION or pointer),
    /// so that it must not get into a variable: what a temporary held before depends on where frames lie.
    left_over: bool,
    /// One of several that SEL and its kind chose at run time, maybe of the own frame.
    chosen: bool,
    /// The bytes in front of the first 0 of a constant.
    constant: Option<Rc<[u8]>>,
}

#[derive(Debug, Clone, Copy)]
enum Capacity {
    Known(u32),
    /// Known at run time only, I32.
    Carried(ValueId),
}

impl Text {
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
    fn bytes(&self) -> Option<u64> {
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
        Some(Text {
            place: access.place.clone(),
            wide,
            capacity,
            own: false,
            left_over: false,
            chosen: false,
            constant: None,
        })
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
        let operands = self.operands(args);
        if let Some(from) = self.chosen(*op, &operands) {
            return self.copy_text(to, &from);
        }
        // What gives a part of a string may be built over that string itself.
        let part = matches!(op, TextOp::Left | TextOp::Right | TextOp::Mid | TextOp::Delete);
        if operands.texts.iter().all(|text| disjoint(to, text) || part && same(to, text)) {
            self.build(*op, &operands, to);
        } else {
            self.aside(expr, *wide, to, |s, temp| s.build(*op, &operands, temp));
        }
    }

    /// Builds the string of an expression in a temporary and copies it.
    fn aside(&mut self, expr: &Expr, wide: bool, to: &Text, build: impl FnOnce(&mut Self, &Text)) {
        // Every result is cut at its end, so what does not fit there need not be made.
        let temp = self.text_temp(wide, self.bound(expr).min(to.known().unwrap_or(LONGEST)));
        build(self, &temp);
        self.copy_text(to, &temp);
    }

    /// `s := CONCAT(s, ...)`: the others go behind what is there. FALSE if that is not what it is.
    fn append(&mut self, pieces: &[Piece], to: &Text) -> bool {
        let Some((Piece::Text(first), rest)) = pieces.split_first() else { return false };
        // LEN tells no greater length.
        let short = to.known().is_some_and(|capacity| capacity <= i16::MAX as u32);
        if !same(first, to) || !short || !texts(rest).all(|text| disjoint(to, text)) {
            return false;
        }
        let end = self.call_text(&TextFns::of(to.wide).len, &[to], &[]);
        self.concat(rest, to, Some(end));
        true
    }

    /// Puts pieces one behind the other, behind the first `end` characters of a string (which has them).
    fn concat(&mut self, pieces: &[Piece], to: &Text, end: Option<ValueId>) {
        let fns = TextFns::of(to.wide);
        let mut end = end;
        for piece in pieces {
            end = Some(match piece {
                Piece::Text(text) => self.put(to, text, end),
                Piece::Number(value, elem) => {
                    let raw = self.register_of(*value);
                    let code = self.b.number(Repr::I64, u64::from(elem.code()));
                    let start = end.unwrap_or_else(|| self.b.number(Repr::I64, 0));
                    self.call_text(&fns.write, &[to], &[start, raw, code])
                }
            });
        }
    }

    /// Puts a string behind the first characters of another, none if `end` is; gives the new length.
    fn put(&mut self, to: &Text, text: &Text, end: Option<ValueId>) -> ValueId {
        let unit = to.unit_bytes();
        let short = text.constant.clone().filter(|bytes| bytes.len() as u32 + unit <= SHORT_BYTES);
        let fits = |bytes: &[u8]| to.known()?.checked_sub(bytes.len() as u32 / unit);
        let Some((bytes, last)) = short.and_then(|bytes| Some((bytes.clone(), fits(&bytes)?))) else {
            let start = end.unwrap_or_else(|| self.b.number(Repr::I64, 0));
            return self.call_text(&TextFns::of(to.wide).put, &[to, text], &[start]);
        };
        let length = u64::from(bytes.len() as u32 / unit);
        let closed = [&bytes, &[0, 0][..unit as usize]].concat();
        let Some(end) = end else {
            self.store_bytes(&to.place, &closed);
            return self.b.number(Repr::I64, length);
        };
        // Few are cut: the characters are in the code.
        let limit = self.b.number(Repr::I64, u64::from(last));
        let whole = self.b.op(PrimOp::LeS, Repr::I64, &[end, limit]);
        let (fit, cut, done) = (self.b.block(), self.b.block(), self.b.block());
        let result = self.b.block_param(done, Repr::I64);
        self.b.branch(whole, fit, cut);
        self.b.switch_to(fit);
        let mut place = to.place.clone();
        place.index.push(IndexTerm { value: end, stride: unit, low: 0, high: i64::from(last) });
        self.store_bytes(&place, &closed);
        let length = self.b.number(Repr::I64, length);
        let sum = self.b.op(PrimOp::Add, Repr::I64, &[end, length]);
        self.b.jump(done, &[sum]);
        self.b.switch_to(cut);
        let sum = self.call_text(&TextFns::of(to.wide).put, &[to, text], &[end]);
        self.b.jump(done, &[sum]);
        self.b.switch_to(done);
        result
    }

    fn store_bytes(&mut self, place: &Place, bytes: &[u8]) {
        for (at, repr, raw) in words(bytes) {
            let value = self.b.number(repr, raw);
            self.b.store(place.clone().plus(at), value);
        }
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

    /// An operation on strings that gives an elementary value.
    pub fn text_value(&mut self, op: TextOp, wide: bool, args: &[Expr], expr: &Expr) -> ValueId {
        let fns = TextFns::of(wide);
        let operands = self.operands(args);
        self.at(expr.span, "");
        match op {
            TextOp::Len => {
                let length = self.call_text(&fns.len, &operands.refs(), &[]);
                self.b.resize(length, true, Elem::Int.repr())
            }
            TextOp::Find => {
                let position = self.call_text(&fns.find, &operands.refs(), &[]);
                self.b.resize(position, true, Elem::Int.repr())
            }
            TextOp::Read(elem) => {
                let code = self.b.number(Repr::I64, u64::from(elem.code()));
                let raw = self.call_text(&fns.read, &operands.refs(), &[code]);
                self.of_register(raw, elem)
            }
            TextOp::Compare(op) => {
                let mut all: Option<ValueId> = None;
                for pair in operands.texts.windows(2) {
                    let holds = self.compare(op, &pair[0], &pair[1]);
                    all = Some(match all {
                        Some(before) => self.b.op(PrimOp::And, Repr::I8, &[before, holds]),
                        None => holds,
                    });
                }
                all.unwrap_or_else(|| bug!("a comparison of one"))
            }
            _ => bug!("{op:?} as a scalar"),
        }
    }

    fn compare(&mut self, op: Op, a: &Text, b: &Text) -> ValueId {
        if let Op::Eq | Op::Ne = op
            && let Some(equal) = self.equals_constant(a, b).or_else(|| self.equals_constant(b, a))
        {
            return if op == Op::Eq { equal } else { self.b.not(equal) };
        }
        let order = self.call_text(&TextFns::of(a.wide).compare, &[a, b], &[]);
        let zero = self.b.number(Repr::I64, 0);
        let (prim, sides) = match op {
            Op::Eq => (PrimOp::Eq, [order, zero]),
            Op::Ne => (PrimOp::Ne, [order, zero]),
            Op::Lt => (PrimOp::LtS, [order, zero]),
            Op::Le => (PrimOp::LeS, [order, zero]),
            Op::Gt => (PrimOp::LtS, [zero, order]),
            _ => (PrimOp::LeS, [zero, order]),
        };
        self.b.op(prim, Repr::I64, &sides)
    }

    /// Whether a string is a short constant: its bytes are compared at once.
    fn equals_constant(&mut self, text: &Text, constant: &Text) -> Option<ValueId> {
        let (bytes, unit) = (constant.constant.clone()?, text.unit_bytes());
        let room = text.known()? * unit;
        if bytes.len() as u32 > room {
            return Some(self.b.number(Repr::I8, 0));
        }
        // A string that is full ends there.
        let end: &[u8] = if bytes.len() as u32 == room { &[] } else { &[0, 0][..unit as usize] };
        let bytes = [&bytes, end].concat();
        if bytes.len() as u32 > SHORT_BYTES {
            return None;
        }
        let mut all = None;
        for (at, repr, raw) in words(&bytes) {
            let there = self.b.load(repr, text.place.clone().plus(at), false);
            let wanted = self.b.number(repr, raw);
            let same = self.b.op(PrimOp::Eq, repr, &[there, wanted]);
            all = Some(match all {
                Some(before) => self.b.op(PrimOp::And, Repr::I8, &[before, same]),
                None => same,
            });
        }
        Some(all.unwrap_or_else(|| self.b.number(Repr::I8, 1)))
    }

    /// What CONCAT joins, evaluated; a value that becomes text is written where it is to go.
    fn pieces(&mut self, args: &[Expr]) -> Vec<Piece> {
        let mut pieces = Vec::with_capacity(args.len());
        for (n, arg) in args.iter().enumerate() {
            pieces.push(match &arg.kind {
                ExprKind::Text { op: TextOp::Write(elem), args: value, .. } => {
                    Piece::Number(self.value(&value[0]), *elem)
                }
                _ => Piece::Text(self.operand(arg, &args[n + 1..])),
            });
        }
        pieces
    }

    /// A string that is an argument, copied if a later argument's call could change it.
    fn operand(&mut self, arg: &Expr, later: &[Expr]) -> Text {
        if later.iter().any(Expr::calls) { self.lasting_text(arg) } else { self.text(arg) }
    }

    /// All arguments, from left to right; a string that a later argument's call could change is copied.
    fn operands(&mut self, args: &[Expr]) -> Operands {
        let mut operands = Operands::default();
        for (n, arg) in args.iter().enumerate() {
            if !self.is_text(arg.ty) {
                operands.values.push(self.value(arg));
                continue;
            }
            let text = self.operand(arg, &args[n + 1..]);
            operands.texts.push(text);
        }
        operands
    }

    /// The argument that a selection gives; `None` for what builds a new string.
    fn chosen(&mut self, op: TextOp, operands: &Operands) -> Option<Text> {
        let texts = &operands.texts;
        match (op, texts.as_slice(), operands.values.as_slice()) {
            (TextOp::Sel, [a, b], [second]) => Some(self.select(*second, b, a)),
            (TextOp::Mux, [others @ .., last], [k]) => {
                let mut chosen = last.clone();
                for (n, text) in others.iter().enumerate().rev() {
                    let number = self.b.number(Repr::I64, n as u64);
                    let this = self.b.op(PrimOp::Eq, Repr::I64, &[*k, number]);
                    chosen = self.select(this, text, &chosen);
                }
                Some(chosen)
            }
            (TextOp::Limit, [low, value, high], _) => {
                let value = self.better(Op::Lt, value, low);
                Some(self.better(Op::Gt, &value, high))
            }
            (TextOp::Max | TextOp::Min, [first, rest @ ..], _) => {
                let beyond = if op == TextOp::Max { Op::Lt } else { Op::Gt };
                Some(rest.iter().fold(first.clone(), |best, text| self.better(beyond, &best, text)))
            }
            _ => None,
        }
    }

    /// `other` if `best op other`, else `best`.
    fn better(&mut self, op: Op, best: &Text, other: &Text) -> Text {
        let take = self.compare(op, best, other);
        self.select(take, other, best)
    }

    /// One of two strings, by reference.
    fn select(&mut self, cond: ValueId, yes: &Text, no: &Text) -> Text {
        let (a, b) = (self.offset_of(yes), self.offset_of(no));
        let at = self.b.op(PrimOp::Select, Repr::I32, &[cond, a, b]);
        let (a, b) = (self.capacity(yes), self.capacity(no));
        let capacity = self.b.op(PrimOp::Select, Repr::I32, &[cond, a, b]);
        Text {
            place: Place::new(Base::Reference(at), 0),
            wide: yes.wide,
            capacity: Capacity::Carried(capacity),
            own: yes.own && no.own,
            left_over: yes.left_over || no.left_over,
            chosen: true,
            constant: None,
        }
    }

    /// Builds a string in a place that overlaps no operand.
    fn build(&mut self, op: TextOp, operands: &Operands, to: &Text) {
        let fns = TextFns::of(to.wide);
        let f = match op {
            TextOp::Write(elem) => {
                let raw = self.register_of(operands.values[0]);
                let code = self.b.number(Repr::I64, u64::from(elem.code()));
                let start = self.b.number(Repr::I64, 0);
                self.call_text(&fns.write, &[to], &[start, raw, code]);
                return;
            }
            TextOp::Left => &fns.left,
            TextOp::Right => &fns.right,
            TextOp::Mid => &fns.mid,
            TextOp::Insert => &fns.insert,
            TextOp::Delete => &fns.delete,
            TextOp::Replace => &fns.replace,
            TextOp::Recode => &fns.recode,
            _ => bug!("{op:?} builds no string"),
        };
        let texts: Vec<&Text> = std::iter::once(to).chain(&operands.texts).collect();
        self.call_text(f, &texts, &operands.values);
    }

    /// Writes the text of a value into a string.
    pub fn write_text(&mut self, value: ValueId, elem: Elem, to: &Access) {
        let Some(to) = self.text_at(to) else { bug!("{:?} is no string", self.defs.types[to.ty]) };
        self.build(TextOp::Write(elem), &Operands { texts: Vec::new(), values: vec![value] }, &to);
    }

    fn call_text(&mut self, f: &'static TextFn, texts: &[&Text], values: &[ValueId]) -> ValueId {
        let places: Vec<TextPlace> =
            texts.iter().map(|text| TextPlace { place: text.place.clone(), capacity: self.capacity(text) }).collect();
        self.b.call_text(f, &places, values)
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
        let shown: Rc<[u8]> = bytes[..end.map_or(bytes.len(), |n| n * unit)].into();
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

    fn offset_of(&mut self, text: &Text) -> ValueId {
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

    /// A value as a register holds it, zero-extended.
    fn register_of(&mut self, value: ValueId) -> ValueId {
        let value = match self.b.repr(value) {
            repr @ (Repr::F32 | Repr::F64) => self.b.op(PrimOp::FBits, repr, &[value]),
            _ => value,
        };
        self.b.resize(value, false, Repr::I64)
    }

    /// The value that a register holds.
    fn of_register(&mut self, raw: ValueId, elem: Elem) -> ValueId {
        match elem.repr() {
            Repr::F64 => self.b.op(PrimOp::BitsF, Repr::I64, &[raw]),
            Repr::F32 => {
                let bits = self.b.resize(raw, false, Repr::I32);
                self.b.op(PrimOp::BitsF, Repr::I32, &[bits])
            }
            repr => self.b.resize(raw, false, repr),
        }
    }
}

/// What CONCAT joins.
#[derive(Debug)]
enum Piece {
    Text(Text),
    /// The text of a value.
    Number(ValueId, Elem),
}

fn texts(pieces: &[Piece]) -> impl Iterator<Item = &Text> {
    pieces.iter().filter_map(|piece| match piece {
        Piece::Text(text) => Some(text),
        Piece::Number(..) => None,
    })
}

/// Bytes cut into words, great ones first: offset, representation and register value.
fn words(bytes: &[u8]) -> Vec<(u32, Repr, u64)> {
    let mut words = Vec::new();
    let mut at = 0;
    for repr in [Repr::I64, Repr::I32, Repr::I16, Repr::I8] {
        while let Some(word) = bytes[at..].get(..repr.bytes() as usize) {
            let raw = word.iter().rev().fold(0, |raw, byte| raw << 8 | u64::from(*byte));
            words.push((at as u32, repr, raw));
            at += word.len();
        }
    }
    words
}

/// Whether two are the same string.
fn same(a: &Text, b: &Text) -> bool {
    a.place == b.place && a.known().is_some() && a.known() == b.known()
}

/// The evaluated arguments of an operation.
#[derive(Debug, Default)]
struct Operands {
    texts: Vec<Text>,
    values: Vec<ValueId>,
}

impl Operands {
    fn refs(&self) -> Vec<&Text> {
        self.texts.iter().collect()
    }
}

fn unit_repr(wide: bool) -> Repr {
    if wide { Repr::I16 } else { Repr::I8 }
}

/// Whether two strings share no byte for certain. The own frame is apart from everything else: what lies in it has no address
/// that anyone else could hold while this function runs.
fn disjoint(to: &Text, from: &Text) -> bool {
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
