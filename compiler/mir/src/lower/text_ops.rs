//! Operations on strings (semantics.md \[T8\] \[N2\]): their arguments, what builds a string in a place, what gives a value.
//! Short constants stand in the code; the rest is done by the bodies in `stdlib::rt::strings`.

use super::func::FuncLower;
use super::place::Access;
use super::text::{Capacity, Text, disjoint, same};
use crate::ir::{Base, IndexTerm, Place, TextPlace, ValueId};
use plcc_diag::bug;
use plcc_hir::body::{Expr, ExprKind};
use plcc_stdlib::elem::Elem;
use plcc_stdlib::funcs::TextOp;
use plcc_stdlib::ops::Op;
use plcc_stdlib::prim::{PrimOp, Repr};
use plcc_stdlib::rt::strings::{TextFn, TextFns};

/// Constants of at most so many bytes, the closing 0 with them, stand in the code.
const SHORT_BYTES: u32 = 16;

/// What CONCAT joins.
#[derive(Debug)]
pub(super) enum Piece {
    Text(Text),
    /// The text of a value.
    Number(ValueId, Elem),
}

pub(super) fn texts(pieces: &[Piece]) -> impl Iterator<Item = &Text> {
    pieces.iter().filter_map(|piece| match piece {
        Piece::Text(text) => Some(text),
        Piece::Number(..) => None,
    })
}

/// The evaluated arguments of an operation.
#[derive(Debug, Default)]
pub(super) struct Operands {
    pub texts: Vec<Text>,
    pub values: Vec<ValueId>,
}

impl Operands {
    fn refs(&self) -> Vec<&Text> {
        self.texts.iter().collect()
    }
}

impl FuncLower<'_, '_> {
    /// `s := CONCAT(s, ...)`: the others go behind what is there. FALSE if that is not what it is.
    pub(super) fn append(&mut self, pieces: &[Piece], to: &Text) -> bool {
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
    pub(super) fn concat(&mut self, pieces: &[Piece], to: &Text, end: Option<ValueId>) {
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
    pub(super) fn pieces(&mut self, args: &[Expr]) -> Vec<Piece> {
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
    pub(super) fn operands(&mut self, args: &[Expr]) -> Operands {
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
    pub(super) fn chosen(&mut self, op: TextOp, operands: &Operands) -> Option<Text> {
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
    pub(super) fn build(&mut self, op: TextOp, operands: &Operands, to: &Text) {
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

    pub(super) fn call_text(&mut self, f: &'static TextFn, texts: &[&Text], values: &[ValueId]) -> ValueId {
        let places: Vec<TextPlace> =
            texts.iter().map(|text| TextPlace { place: text.place.clone(), capacity: self.capacity(text) }).collect();
        self.b.call_text(f, &places, values)
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
