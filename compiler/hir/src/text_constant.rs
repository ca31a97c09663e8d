//! Constant strings: computed by the bodies that run at run time, on a small region of their own.

use crate::body::*;
use crate::consts::{NotConstant, Reads};
use crate::cx::Cx;
use crate::init::Init;
use crate::types::Type;
use plcc_stdlib::funcs::TextOp;
use plcc_stdlib::ops::Op;
use plcc_stdlib::rt::strings::{Text, TextFn, TextFns};
use plcc_stdlib::value::longest_text;

/// The value of an operation.
pub(crate) enum Value {
    /// A register value.
    Scalar(u64),
    /// Code units.
    Text(Vec<u16>),
}

impl Cx<'_> {
    /// An operation whose arguments are all literals as a literal, any other as it is.
    pub fn folded_text(&mut self, node: Expr) -> Expr {
        let ExprKind::Text { op, wide, args } = &node.kind else { return node };
        let literal = |e: &Expr| matches!(e.kind, ExprKind::String(_) | ExprKind::WString(_) | ExprKind::Const(_));
        if !args.iter().all(literal) {
            return node;
        }
        let (op, wide, args) = (*op, *wide, args.clone());
        match self.eval_text(op, wide, &args, Reads::Constants) {
            Ok(Value::Scalar(raw)) => Expr { kind: ExprKind::Const(raw), ..node },
            Ok(Value::Text(units)) => {
                let ty = self.defs.types.intern(Type::String { wide, capacity: (units.len() as u32).max(1) });
                let kind = if wide {
                    ExprKind::WString(units)
                } else {
                    ExprKind::String(units.into_iter().map(|u| u as u8).collect())
                };
                Expr { kind, ty, span: node.span }
            }
            Err(_) => node,
        }
    }

    /// The code units of a constant string.
    pub fn eval_units(&mut self, e: &Expr, reads: Reads) -> Result<Vec<u16>, NotConstant> {
        let widened = |s: &[u8]| s.iter().map(|c| u16::from(*c)).collect();
        let varies = Err(NotConstant::Varies(e.span));
        match &e.kind {
            ExprKind::Error => Err(NotConstant::Reported),
            ExprKind::String(s) => Ok(widened(s)),
            ExprKind::WString(s) => Ok(s.clone()),
            ExprKind::Retype(inner) => self.eval_units(inner, reads),
            ExprKind::Read(place) => match self.initial_of(place, reads)? {
                Init::String(s) => Ok(widened(&s)),
                Init::WString(s) => Ok(s),
                Init::Default => Ok(Vec::new()),
                _ => varies,
            },
            ExprKind::Text { op, wide, args } => match self.eval_text(*op, *wide, args, reads)? {
                Value::Text(units) => Ok(units),
                Value::Scalar(_) => varies,
            },
            _ => varies,
        }
    }

    /// The value of an operation on strings.
    pub fn eval_text(&mut self, op: TextOp, wide: bool, args: &[Expr], reads: Reads) -> Result<Value, NotConstant> {
        let source_wide = if op == TextOp::Recode { !wide } else { wide };
        let mut region = Region { wide: source_wide, mem: Vec::new() };
        let (mut texts, mut numbers) = (Vec::new(), Vec::new());
        for arg in args {
            match self.defs.types.get(arg.ty) {
                Type::String { .. } | Type::AnyString { .. } => {
                    let units = self.eval_units(arg, reads)?;
                    texts.push(region.place(&units));
                }
                _ => numbers.push(self.eval(arg, reads)?),
            }
        }
        let fns = TextFns::of(wide);
        let all: u32 = texts.iter().map(|t| t.capacity).sum();
        Ok(match op {
            TextOp::Len => Value::Scalar((fns.len.eval)(&mut region.mem, &texts, &[])),
            TextOp::Find => Value::Scalar((fns.find.eval)(&mut region.mem, &texts, &[])),
            TextOp::Read(elem) => Value::Scalar((fns.read.eval)(&mut region.mem, &texts, &[u64::from(elem.code())])),
            TextOp::Compare(op) => {
                let all = texts.windows(2).all(|pair| holds(op, region.order(pair[0], pair[1])));
                Value::Scalar(u64::from(all))
            }
            TextOp::Left => region.built(&fns.left, all, &texts, &numbers),
            TextOp::Right => region.built(&fns.right, all, &texts, &numbers),
            TextOp::Mid => region.built(&fns.mid, all, &texts, &numbers),
            TextOp::Insert => region.built(&fns.insert, all, &texts, &numbers),
            TextOp::Delete => region.built(&fns.delete, all, &texts, &numbers),
            TextOp::Replace => region.built(&fns.replace, all, &texts, &numbers),
            TextOp::Recode => {
                region.wide = wide;
                region.built(&fns.recode, all, &texts, &numbers)
            }
            TextOp::Write(elem) => {
                let raw = numbers.first().copied().unwrap_or(0);
                region.built(&fns.write, longest_text(elem), &texts, &[0, raw, u64::from(elem.code())])
            }
            TextOp::Concat => Value::Text(texts.iter().flat_map(|t| region.units(*t)).collect()),
            TextOp::Max | TextOp::Min | TextOp::Limit | TextOp::Sel | TextOp::Mux => {
                let first = numbers.first().copied().unwrap_or(0);
                match region.chosen(op, &texts, first) {
                    Some(text) => Value::Text(region.units(text)),
                    None => Value::Text(Vec::new()),
                }
            }
        })
    }
}

/// What a comparison says of the order of two strings.
fn holds(op: Op, order: i64) -> bool {
    match op {
        Op::Eq => order == 0,
        Op::Ne => order != 0,
        Op::Lt => order < 0,
        Op::Le => order <= 0,
        Op::Gt => order > 0,
        _ => order >= 0,
    }
}

/// Strings one behind the other.
struct Region {
    wide: bool,
    mem: Vec<u8>,
}

impl Region {
    fn unit_bytes(&self) -> usize {
        if self.wide { 2 } else { 1 }
    }

    fn place(&mut self, units: &[u16]) -> Text {
        let at = self.mem.len() as u32;
        let bytes = self.unit_bytes();
        for unit in units.iter().chain(&[0]) {
            self.mem.extend(&unit.to_le_bytes()[..bytes]);
        }
        Text { at, capacity: units.len() as u32 }
    }

    fn units(&self, text: Text) -> Vec<u16> {
        let unit = |bytes: &[u8]| u16::from_le_bytes([bytes[0], bytes.get(1).copied().unwrap_or(0)]);
        let units = self.mem[text.at as usize..].chunks_exact(self.unit_bytes()).map(unit);
        units.take(text.capacity as usize).take_while(|unit| *unit != 0).collect()
    }

    fn built(&mut self, f: &TextFn, capacity: u32, texts: &[Text], numbers: &[u64]) -> Value {
        let room = self.place(&vec![0; capacity as usize]);
        let all: Vec<Text> = std::iter::once(room).chain(texts.iter().copied()).collect();
        (f.eval)(&mut self.mem, &all, numbers);
        Value::Text(self.units(room))
    }

    fn order(&mut self, a: Text, b: Text) -> i64 {
        (TextFns::of(self.wide).compare.eval)(&mut self.mem, &[a, b], &[]) as i64
    }

    /// The argument that a selection gives.
    fn chosen(&mut self, op: TextOp, texts: &[Text], number: u64) -> Option<Text> {
        let mut best = |op: TextOp, a: Text, b: Text| {
            let order = self.order(a, b);
            let second = if op == TextOp::Max { order < 0 } else { order > 0 };
            if second { b } else { a }
        };
        match (op, texts) {
            (TextOp::Sel, [a, b]) => Some(if number & 1 == 1 { *b } else { *a }),
            (TextOp::Mux, _) => texts.get(number.min(u64::from(u32::MAX)) as usize).or(texts.last()).copied(),
            (TextOp::Limit, [low, value, high]) => {
                let value = best(TextOp::Max, *value, *low);
                Some(best(TextOp::Min, value, *high))
            }
            _ => texts.iter().copied().reduce(|a, b| best(op, a, b)),
        }
    }
}
