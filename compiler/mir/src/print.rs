//! MIR as text, for `--emit mir` and for bug reports.
//!
//! In: a program or a function. Out: text that follows the source: memory by its name in the program, checks in words,
//! one block after the other. The same program gives the same text.

use crate::ir::{
    Base, BlockId, Cond, Exit, Func, FuncId, Inst, Place, Program, Source, SourceId, Target, Term, ValueId,
};
use std::fmt::Write;

/// Says where a row of the source table lies, e. g. `main.st:4:7`; `None` leaves it out.
pub type Position<'a> = &'a dyn Fn(&Source) -> Option<String>;

/// The whole program.
pub fn program(program: &Program, position: Option<Position>) -> String {
    let mut out = String::new();
    let tasks: Vec<String> = program.tasks.iter().map(|t| callee(program, *t)).collect();
    let _ = writeln!(out, "region {} bytes, frames from {}", program.region_bytes, program.frame_base);
    let _ = writeln!(out, "tasks: {}", if tasks.is_empty() { "none".into() } else { tasks.join(", ") });
    for part in &program.parts {
        let _ = writeln!(out, "part at {}: {} bytes, frames from {}", part.start, part.bytes, part.frame_base);
    }
    for segment in &program.initial {
        let _ = write!(out, "initial {}:", segment.offset);
        for byte in segment.bytes.iter().take(32) {
            let _ = write!(out, " {byte:02x}");
        }
        let more = segment.bytes.len().saturating_sub(32);
        let _ = if more > 0 { writeln!(out, " and {more} more") } else { writeln!(out) };
    }
    for (start, length) in &program.retain {
        let _ = writeln!(out, "retain {start}: {length} bytes");
    }
    for id in program.funcs.indices() {
        out.push('\n');
        out.push_str(&func(program, id, position));
    }
    out
}

/// One function.
pub fn func(program: &Program, id: FuncId, position: Option<Position>) -> String {
    let func = &program.funcs[id];
    let mut printer = Printer { program, func, position, out: String::new() };
    printer.head(id);
    for block in func.blocks.indices() {
        printer.block(block);
    }
    printer.out
}

struct Printer<'a> {
    program: &'a Program,
    func: &'a Func,
    position: Option<Position<'a>>,
    out: String,
}

impl Printer<'_> {
    fn head(&mut self, id: FuncId) {
        let func = self.func;
        let params: Vec<&str> = func.params.iter().map(|r| r.name()).collect();
        let _ = write!(self.out, "func f{} `{}` ({})", id.index(), func.name, params.join(", "));
        if let Some(result) = func.result {
            let _ = write!(self.out, " -> {}", result.name());
        }
        if func.has_instance {
            self.out.push_str(", instance");
        }
        if func.frame_bytes > 0 {
            let _ = write!(self.out, ", frame {} bytes", func.frame_bytes);
        }
        self.out.push('\n');
    }

    fn block(&mut self, id: BlockId) {
        let block = &self.func.blocks[id];
        let params: Vec<String> = block.params.iter().map(|p| format!("{}: {}", value(*p), self.repr(*p))).collect();
        let _ = write!(self.out, "b{}", id.index());
        if !params.is_empty() {
            let _ = write!(self.out, "({})", params.join(", "));
        }
        self.out.push_str(":\n");
        for inst in &block.insts {
            let text = self.inst(inst);
            let at = match inst {
                Inst::Call { exit, .. } | Inst::Check { exit, .. } | Inst::Poll { exit } => self.at(exit.source),
                _ => None,
            };
            let _ = match at {
                Some(at) => writeln!(self.out, "    {text:<60} ; {at}"),
                None => writeln!(self.out, "    {text}"),
            };
        }
        let text = self.term(&block.term);
        let _ = writeln!(self.out, "    {text}");
    }

    fn repr(&self, v: ValueId) -> &'static str {
        self.func.values.get(v).map_or("?", |r| r.name())
    }

    fn at(&self, source: SourceId) -> Option<String> {
        let mut row = self.program.sources.get(source)?;
        let position = self.position?;
        let mut text = position(row)?;
        // The table is a forest; its length bounds the walk even if a pass made a circle.
        for _ in 0..self.program.sources.len() {
            let Some(outer) = row.inlined_at.and_then(|id| self.program.sources.get(id)) else { break };
            if let Some(place) = position(outer) {
                let _ = write!(text, " in the call at {place}");
            }
            row = outer;
        }
        Some(text)
    }

    fn inst(&self, inst: &Inst) -> String {
        match inst {
            Inst::Const { dst, raw } => format!("{} = {} {}", value(*dst), self.repr(*dst), self.constant(*dst, *raw)),
            Inst::Prim { dst, op, repr, args } => {
                format!("{} = {} {} {}", value(*dst), op_name(&format!("{op:?}")), repr.name(), values(args))
            }
            Inst::Load { dst, place, normalise } => {
                let how = if *normalise { " as truth value" } else { "" };
                format!("{} = load {} {}{how}", value(*dst), self.repr(*dst), self.place(place))
            }
            Inst::Store { place, value: v } => {
                format!("store {} {} := {}", self.repr(*v), self.place(place), value(*v))
            }
            Inst::Copy { dst, src, bytes } => {
                format!("copy {bytes} bytes {} := {}", self.place(dst), self.place(src))
            }
            Inst::Zero { dst, bytes } => format!("zero {bytes} bytes {}", self.place(dst)),
            Inst::AddressOf { dst, place, .. } => format!("{} = address of {}", value(*dst), self.place(place)),
            Inst::Call { dst, callee: f, instance, args, status, exit } => {
                let mut text = match dst {
                    Some(dst) => format!("{} = ", value(*dst)),
                    None => String::new(),
                };
                let _ = write!(text, "call {}({})", callee(self.program, *f), values(args));
                if let Some(place) = instance {
                    let _ = write!(text, " on {}", self.place(place));
                }
                if let Some(status) = status {
                    let _ = write!(text, " catching {}", value(*status));
                }
                text + &self.exit(exit)
            }
            Inst::CallRt { dst, func, args } => format!("{} = call {}({})", value(*dst), func.symbol, values(args)),
            Inst::CallText { dst, func, texts, args } => {
                let mut list: Vec<String> =
                    texts.iter().map(|t| format!("{}[{}]", self.place(&t.place), value(t.capacity))).collect();
                list.extend(args.iter().map(|v| value(*v)));
                format!("{} = call {}({})", value(*dst), func.symbol, list.join(", "))
            }
            Inst::Check { cond, fault, operands, exit } => {
                let cond = match cond {
                    Cond::True(v) => value(*v),
                    Cond::Within { value: v, low, high } => format!("{low} <= {} <= {high}", value(*v)),
                };
                let mut text = format!("check {cond} else {}", fault.title());
                if let Some(what) = self.program.sources.get(exit.source).map(|s| &s.what).filter(|w| !w.is_empty()) {
                    let _ = write!(text, " of `{what}`");
                }
                if !operands.is_empty() {
                    let _ = write!(text, " ({})", values(operands));
                }
                text + &self.exit(exit)
            }
            Inst::Poll { exit } => format!("poll deadline{}", self.exit(exit)),
        }
    }

    /// What an exit says besides its position.
    fn exit(&self, exit: &Exit) -> String {
        let mut text = String::new();
        if let Some(place) = &exit.instance {
            let _ = write!(text, " in {}", self.place(place));
        }
        for (place, v) in &exit.owed {
            let _ = write!(text, ", owes {} := {}", self.place(place), value(*v));
        }
        text
    }

    fn term(&self, term: &Term) -> String {
        match term {
            Term::Jump(to) => format!("jump {}", target(to)),
            Term::Branch { cond, then, otherwise } => {
                format!("if {} then {} else {}", value(*cond), target(then), target(otherwise))
            }
            Term::Switch { value: v, cases, default } => {
                let mut text = format!("case {}", value(*v));
                for (label, to) in cases {
                    let _ = write!(text, ", {}: {}", self.constant(*v, *label), target(to));
                }
                let _ = write!(text, ", else {}", target(default));
                text
            }
            Term::Return(Some(v)) => format!("return {}", value(*v)),
            Term::Return(None) => "return".into(),
        }
    }

    /// A register value as a number: signed for integers, because the types of the source are gone.
    fn constant(&self, v: ValueId, raw: u64) -> String {
        use plcc_stdlib::prim::Repr;
        match self.func.values.get(v) {
            Some(Repr::F32) => format!("{:?}", f32::from_bits(raw as u32)),
            Some(Repr::F64) => format!("{:?}", f64::from_bits(raw)),
            Some(repr) => repr.sign_extend(raw).to_string(),
            None => raw.to_string(),
        }
    }

    fn place(&self, place: &Place) -> String {
        // The lowest byte that the place can reach names it: index terms carry `- low * stride` in the offset.
        let first = place
            .index
            .iter()
            .fold(i128::from(place.offset), |at, term| at + i128::from(term.low) * i128::from(term.stride));
        let (mut text, rest) = match place.base {
            Base::Reference(v) => (format!("{}^", value(v)), first),
            base => self.name(base, first),
        };
        for term in &place.index {
            let _ = write!(text, "[{}]", value(term.value));
        }
        if rest != 0 {
            let _ = write!(text, "{rest:+}");
        }
        if let Some(bit) = place.bit {
            let _ = write!(text, ".%X{bit}");
        }
        text
    }

    /// The name of the memory at a byte, and how far behind its start the byte lies.
    fn name(&self, base: Base, at: i128) -> (String, i128) {
        let names = &self.func.names;
        let behind = names.partition_point(|(b, first, _)| (*b, i128::from(*first)) <= (base, at));
        match behind.checked_sub(1).map(|n| &names[n]) {
            Some((b, first, path)) if *b == base => (path.clone(), at - i128::from(*first)),
            _ => {
                let word = match base {
                    Base::Region => "region",
                    Base::Instance => "instance",
                    _ => "frame",
                };
                (format!("{word}{at:+}"), 0)
            }
        }
    }
}

fn value(v: ValueId) -> String {
    format!("v{}", v.index())
}

fn values(list: &[ValueId]) -> String {
    list.iter().map(|v| value(*v)).collect::<Vec<_>>().join(", ")
}

fn target(target: &Target) -> String {
    let args = if target.args.is_empty() { String::new() } else { format!("({})", values(&target.args)) };
    format!("b{}{args}", target.block.index())
}

fn callee(program: &Program, id: FuncId) -> String {
    match program.funcs.get(id) {
        Some(func) => format!("f{} `{}`", id.index(), func.name),
        None => format!("f{} (missing)", id.index()),
    }
}

/// `DivS` as `div_s`, `Zext(I32)` as `zext_i32`, `FAdd` as `fadd`.
fn op_name(debug: &str) -> String {
    let mut name = String::new();
    let chars: Vec<char> = debug.chars().filter(|c| *c != ')').collect();
    for (n, c) in chars.iter().enumerate() {
        let lower_before = n > 0 && chars[n - 1].is_ascii_lowercase();
        match c {
            '(' => name.push('_'),
            c if c.is_ascii_uppercase() => {
                if lower_before {
                    name.push('_');
                }
                name.push(c.to_ascii_lowercase());
            }
            c => name.push(*c),
        }
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::Builder;
    use crate::ir::IndexTerm;
    use plcc_diag::{FileId, Span};
    use plcc_stdlib::fault::Fault;
    use plcc_stdlib::prim::{PrimOp, Repr};

    #[test]
    fn names_checks_and_calls() {
        let mut b = Builder::new("Main", &[Repr::I16], Some(Repr::I16), true);
        let x = b.params()[0];
        let i = b.op(PrimOp::Sext(Repr::I64), Repr::I16, &[x]);
        b.check_within(i, 1, 4, Fault::IndexOutOfBounds);
        let index = vec![IndexTerm { value: i, stride: 2, low: 1, high: 4 }];
        let element = Place { base: Base::Region, offset: 62, index, bit: None };
        let old = b.load(Repr::I16, element.clone(), false);
        let half = b.number(Repr::F32, u64::from(0.5f32.to_bits()));
        b.store(Place::new(Base::Instance, 4), half);
        b.store(Place { bit: Some(3), ..Place::new(Base::Region, 90) }, half);
        b.store(Place::new(Base::Frame, 8), old);
        let less = b.op(PrimOp::LtS, Repr::I16, &[old, x]);
        let (status, _) = (b.call_catching(FuncId::from_raw(0), Some(element), &[x], None).1, ());
        b.poll();
        let (then, join) = (b.block(), b.block());
        b.branch(less, then, join);
        b.switch_to(then);
        b.switch(status, &[(1, join), (u64::from(u32::MAX), join)], then);
        b.switch_to(join);
        b.ret(Some(old));
        let mut func = b.finish(16);
        func.names = vec![
            (Base::Region, 64, "Main.a".into()),
            (Base::Region, 88, "flags".into()),
            (Base::Instance, 0, "t".into()),
        ];
        let mut program = Program { region_bytes: 256, frame_base: 128, retain: vec![(64, 8)], ..Program::default() };
        program.tasks.push(program.funcs.push(func));
        let source = |what: &str, inlined_at| Source {
            span: Span::new(FileId(0), 7, 9),
            pou: "Main".into(),
            what: what.into(),
            inlined_at,
        };
        program.sources.push(source("a", Some(SourceId::from_raw(1))));
        program.sources.push(source("", None));
        let position = |s: &Source| Some(format!("main.st:{}", s.span.start));
        let want = "\
region 256 bytes, frames from 128
tasks: f0 `Main`
retain 64: 8 bytes

func f0 `Main` (i16) -> i16, instance, frame 16 bytes
b0(v0: i16):
    v1 = sext_i64 i16 v0
    check 1 <= v1 <= 4 else index out of bounds of `a`           ; main.st:7 in the call at main.st:7
    v2 = load i16 Main.a[v1]
    v3 = f32 0.5
    store f32 t+4 := v3
    store f32 flags+2.%X3 := v3
    store i16 frame+8 := v2
    v4 = lt_s i16 v2, v0
    call f0 `Main`(v0) on Main.a[v1] catching v5                 ; main.st:7 in the call at main.st:7
    poll deadline                                                ; main.st:7 in the call at main.st:7
    if v4 then b1 else b2
b1:
    case v5, 1: b2, -1: b2, else b1
b2:
    return v2
";
        let got = super::program(&program, Some(&position));
        assert_eq!(got, want, "\n{got}");
    }
}
