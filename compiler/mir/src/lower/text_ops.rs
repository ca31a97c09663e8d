//! Operations on strings (semantics.md \[T8\] \[N2\]): their arguments, what builds a string in a place, what gives a value.
//! Short constants stand in the code; the rest is done by the bodies in `stdlib::rt::strings`.

use super::func::FuncLower;
use super::place::Access;
use super::text::{Capacity, Text, disjoint, same};
use crate::ir::{Base, Place, TextPlace, ValueId};
use crate::short_text::{SHORT_BYTES, words};
use plcc_diag::bug;
use plcc_hir::Type;
use plcc_hir::body::{Expr, ExprKind};
use plcc_stdlib::elem::Elem;
use plcc_stdlib::funcs::TextOp;
use plcc_stdlib::ops::Op;
use plcc_stdlib::prim::{PrimOp, Repr};
use plcc_stdlib::rt::strings::{TextFn, TextFns};

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
        let mut end = end;
        for piece in pieces {
            end = Some(match piece {
                Piece::Text(text) => self.put(to, text, end),
                Piece::Number(value, elem) => self.write(to, end, *value, *elem),
            });
        }
    }

    /// Puts a string behind the first characters of another, none if `end` is; gives the new length.
    fn put(&mut self, to: &Text, text: &Text, end: Option<ValueId>) -> ValueId {
        let unit = to.unit_bytes();
        let fits = |bytes: &[u8]| to.known().is_some_and(|capacity| bytes.len() as u32 / unit <= capacity);
        match &text.constant {
            Some(bytes) if end.is_none() && bytes.len() as u32 + unit <= SHORT_BYTES && fits(bytes) => {
                self.store_bytes(&to.place, &[bytes, &[0, 0][..unit as usize]].concat());
                self.b.number(Repr::I64, u64::from(bytes.len() as u32 / unit))
            }
            _ => {
                let start = end.unwrap_or_else(|| self.b.number(Repr::I64, 0));
                self.call_text(&TextFns::of(to.wide).put, &[to, text], &[start])
            }
        }
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
        if let Some(value) = self.tail_value(op, args).or_else(|| self.starts_with(op, args)) {
            return value;
        }
        let operands = self.operands(args);
        self.at(expr.span, "");
        match op {
            TextOp::Len => {
                let length = self.call_text(&fns.len, &operands.refs(), &[]);
                self.b.resize(length, true, Elem::Int.repr())
            }
            TextOp::Find => {
                let position = match single_unit(&args[1]) {
                    Some(unit) => {
                        let (unit, start) = (self.b.number(Repr::I64, unit), self.b.number(Repr::I64, 0));
                        self.call_text(&fns.find_unit, &[&operands.texts[0]], &[unit, start])
                    }
                    None => self.call_text(&fns.find, &operands.refs(), &[]),
                };
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

    /// LEN of a tail, and FIND of one character in it.
    fn tail_value(&mut self, op: TextOp, args: &[Expr]) -> Option<ValueId> {
        let value = match (op, args) {
            (TextOp::Len, [text]) => {
                let (source, skipped) = self.tail_of(text)?;
                let most = self.b.number(Repr::I64, i64::MAX as u64);
                let end = self.call_text(&TextFns::of(source.wide).skip, &[&source], &[skipped, most]);
                self.b.op(PrimOp::Sub, Repr::I64, &[end, skipped])
            }
            (TextOp::Find, [text, wanted]) => {
                let unit = single_unit(wanted)?;
                let (source, skipped) = self.tail_of(text)?;
                let unit = self.b.number(Repr::I64, unit);
                self.call_text(&TextFns::of(source.wide).find_unit, &[&source], &[unit, skipped])
            }
            _ => return None,
        };
        Some(self.b.resize(value, true, Elem::Int.repr()))
    }

    /// `LEFT(s, n) = 'constant'`: nothing need be built for that.
    fn starts_with(&mut self, op: TextOp, args: &[Expr]) -> Option<ValueId> {
        let (TextOp::Compare(op @ (Op::Eq | Op::Ne)), [a, b]) = (op, args) else { return None };
        let is_constant = |e: &Expr| matches!(e.kind, ExprKind::String(_) | ExprKind::WString(_));
        let (left, constant) = if is_constant(b) { (a, b) } else { (b, a) };
        let ExprKind::Text { op: TextOp::Left, args, .. } = &left.kind else { return None };
        let [text @ Expr { kind: ExprKind::Read(place), .. }, Expr { kind: ExprKind::Const(count), .. }] =
            args.as_slice()
        else {
            return None;
        };
        if !matches!(self.defs.types[text.ty], Type::String { .. }) || self.is_tail(place) {
            return None;
        }
        let count = usize::try_from(*count as i64).ok().filter(|_| is_constant(constant))?;
        let constant = self.text(constant);
        let units = constant.constant.as_ref()?.len() / constant.unit_bytes() as usize;
        // If the part is longer, the whole string must be the constant.
        if units == 0 || units > count || constant.constant.as_ref()?.len() as u32 + 2 > SHORT_BYTES {
            return None;
        }
        let text = self.text(text);
        let equal = self.equals_constant(&text, &constant, units == count)?;
        Some(if op == Op::Eq { equal } else { self.b.not(equal) })
    }

    fn compare(&mut self, op: Op, a: &Text, b: &Text) -> ValueId {
        if let Op::Eq | Op::Ne = op
            && let Some(equal) = self.equals_constant(a, b, false).or_else(|| self.equals_constant(b, a, false))
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

    /// Whether a string is a short constant, or begins with it: the bytes are compared at once.
    fn equals_constant(&mut self, text: &Text, constant: &Text, begins: bool) -> Option<ValueId> {
        let (bytes, unit) = (constant.constant.clone()?, text.unit_bytes());
        let room = text.known()? * unit;
        if bytes.len() as u32 > room {
            return Some(self.b.number(Repr::I8, 0));
        }
        // A string that is full ends there.
        let end: &[u8] = if begins || bytes.len() as u32 == room { &[] } else { &[0, 0][..unit as usize] };
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
                self.write(to, None, operands.values[0], elem);
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

    /// Writes the text of a value behind the first characters of a string, none if `end` is; gives the new length.
    fn write(&mut self, to: &Text, end: Option<ValueId>, value: ValueId, elem: Elem) -> ValueId {
        let fns = TextFns::of(to.wide);
        let start = end.unwrap_or_else(|| self.b.number(Repr::I64, 0));
        if elem.is_integer() && elem != Elem::Ulint {
            let value = self.b.resize(value, elem.is_signed(), Repr::I64);
            return self.call_text(&fns.whole, &[to], &[start, value]);
        }
        let raw = self.register_of(value);
        let code = self.b.number(Repr::I64, u64::from(elem.code()));
        self.call_text(&fns.write, &[to], &[start, raw, code])
    }

    /// Writes the text of a value into a string.
    pub fn write_text(&mut self, value: ValueId, elem: Elem, to: &Access) {
        let Some(to) = self.text_at(to) else { bug!("{:?} is no string", self.defs.types[to.ty]) };
        self.build(TextOp::Write(elem), &Operands { texts: Vec::new(), values: vec![value] }, &to);
    }

    pub(super) fn call_text(&mut self, f: &'static TextFn, texts: &[&Text], values: &[ValueId]) -> ValueId {
        let place = |text: &&Text| TextPlace {
            place: text.place.clone(),
            capacity: self.capacity(text),
            constant: text.constant.clone(),
        };
        let places: Vec<TextPlace> = texts.iter().map(place).collect();
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

/// The one character of a constant that has no other.
fn single_unit(constant: &Expr) -> Option<u64> {
    let units: Vec<u64> = match &constant.kind {
        ExprKind::String(s) => s.iter().take(2).map(|unit| u64::from(*unit)).collect(),
        ExprKind::WString(s) => s.iter().take(2).map(|unit| u64::from(*unit)).collect(),
        _ => return None,
    };
    match units.as_slice() {
        [0, ..] | [] => None,
        [unit] | [unit, 0] => Some(*unit),
        _ => None,
    }
}
