//! Random Instruction List: the interpreter, native code and an accumulator machine of a few lines agree.
//!
//! [`Machine`] is written from the standard's description of IL and uses nothing of the compiler: one accumulator, a stack for
//! parentheses, a program counter. Programs have segments behind labels, jumps forwards and backwards between them (with the
//! current result carried over, or not), and a budget of backward jumps, so that each program ends.

use fastrand::Rng;
use plcc_hir::{Init, Profile};
use plcc_mir::interp::Interp;
use plcc_tests::compile::{check, lower};
use plcc_tests::memory::{bytes_of, region};
use std::fmt::Write;

const CYCLES: i64 = 4;
/// Variables of each type.
const VARS: usize = 4;
/// Backward jumps of one cycle.
const BUDGET: i16 = 12;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ty {
    Bool,
    Int,
    Dint,
    Word,
}

const TYPES: [Ty; 4] = [Ty::Bool, Ty::Int, Ty::Dint, Ty::Word];

impl Ty {
    fn name(self) -> &'static str {
        match self {
            Ty::Bool => "BOOL",
            Ty::Int => "INT",
            Ty::Dint => "DINT",
            Ty::Word => "WORD",
        }
    }

    fn letter(self) -> char {
        match self {
            Ty::Bool => 'b',
            Ty::Int => 'i',
            Ty::Dint => 'd',
            Ty::Word => 'w',
        }
    }

    /// A number as this type holds it.
    fn wrap(self, v: i64) -> i64 {
        match self {
            Ty::Bool => v & 1,
            Ty::Int => i64::from(v as i16),
            Ty::Dint => i64::from(v as i32),
            Ty::Word => i64::from(v as u16),
        }
    }

    fn not(self, v: i64) -> i64 {
        match self {
            Ty::Bool => 1 - v,
            _ => self.wrap(!v),
        }
    }
}

#[derive(Debug, Clone, Copy)]
enum Operand {
    Var(Ty, usize),
    Const(Ty, i64),
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum When {
    Always,
    True,
    False,
}

#[derive(Debug, Clone)]
enum Ins {
    Label(usize),
    Load(bool, Operand),
    Store(bool, Ty, usize),
    Set(bool, usize),
    Not,
    /// Operator, negated, operand.
    Op(&'static str, bool, Operand),
    /// Operator, negated, operand behind the parenthesis or LD on the next line, instructions.
    Paren(&'static str, bool, bool, Vec<Ins>),
    Jump(When, usize),
    Return(When),
    /// `MAX x`, `Sum x`: a function of the standard or of the user; the current result is its first argument.
    Call(&'static str, Operand),
    /// The user's function in formal form.
    Formal(Operand, Operand),
    /// Adds to `block.total`: by CAL, CALC or CALCN.
    Block(When, Operand),
    /// The input operator form is `ST`, then `CAL`.
    Total,
}

// ---- generation ----

struct Generator {
    rng: Rng,
    /// The type of the current result behind each label, if it is carried over.
    labels: Vec<Option<Ty>>,
}

impl Generator {
    fn operand(&mut self, ty: Ty) -> Operand {
        if self.rng.u8(..4) > 0 {
            return Operand::Var(ty, self.rng.usize(..VARS));
        }
        let v = match self.rng.u8(..3) {
            0 => self.rng.i64(-3..10),
            1 => self.rng.i64(-40_000..40_000),
            _ => self.rng.i64(i64::from(i32::MIN)..i64::from(i32::MAX)),
        };
        Operand::Const(ty, ty.wrap(v))
    }

    fn ty(&mut self) -> Ty {
        TYPES[self.rng.usize(..4)]
    }

    /// An operator for a current result of this type, and the type that it leaves.
    fn operator(&mut self, ty: Ty) -> (&'static str, bool, Ty) {
        let bits = ["AND", "OR", "XOR", "&"];
        let numbers = ["ADD", "SUB", "MUL", "ADD", "DIV", "MOD"];
        let compare = ["EQ", "NE", "LT", "LE", "GT", "GE"];
        match ty {
            Ty::Bool | Ty::Word if self.rng.u8(..5) > 0 => (bits[self.rng.usize(..4)], self.rng.bool(), ty),
            Ty::Bool | Ty::Word => (compare[self.rng.usize(..2)], false, Ty::Bool),
            Ty::Int | Ty::Dint if self.rng.u8(..3) > 0 => (numbers[self.rng.usize(..6)], false, ty),
            Ty::Int | Ty::Dint => (compare[self.rng.usize(..6)], false, Ty::Bool),
        }
    }

    /// Instructions that leave a current result of type `want`.
    fn value(&mut self, want: Ty, out: &mut Vec<Ins>, depth: u32) {
        let ty = if want == Ty::Bool && self.rng.bool() { self.ty() } else { want };
        let negated = matches!(ty, Ty::Bool | Ty::Word) && self.rng.u8(..4) == 0;
        out.push(Ins::Load(negated, self.operand(ty)));
        let count = self.rng.u32(..4);
        let left = self.chain(ty, count, out, depth);
        if left != want {
            if want == Ty::Bool && left != Ty::Bool {
                out.push(Ins::Op("NE", false, self.operand(left)));
            } else {
                out.push(Ins::Load(false, self.operand(want)));
            }
        }
    }

    /// Some instructions on a current result; gives the type that they leave.
    fn chain(&mut self, mut ty: Ty, count: u32, out: &mut Vec<Ins>, depth: u32) -> Ty {
        for _ in 0..count {
            match self.rng.u8(..12) {
                0 if matches!(ty, Ty::Bool | Ty::Word) => out.push(Ins::Not),
                1 | 2 if depth > 0 => {
                    let (mut op, negated, left) = self.operator(ty);
                    let mut inner = Vec::new();
                    self.value(ty, &mut inner, depth - 1);
                    let makes = |i: &&Ins| !matches!(i, Ins::Store(..) | Ins::Set(..) | Ins::Block(..));
                    let zero = matches!(inner.iter().rfind(makes), Some(Ins::Load(_, Operand::Const(_, 0))));
                    if zero && (op == "DIV" || op == "MOD") {
                        op = "ADD";
                    }
                    if self.rng.u8(..3) == 0 {
                        self.effect(ty, &mut inner, true);
                    }
                    let same_line = matches!(inner[0], Ins::Load(false, _)) && self.rng.bool();
                    out.push(Ins::Paren(op, negated, same_line, inner));
                    ty = left;
                }
                3 if ty == Ty::Int => {
                    let name = ["MAX", "MIN", "Sum"][self.rng.usize(..3)];
                    out.push(Ins::Call(name, self.operand(Ty::Int)));
                }
                4 => self.effect(ty, out, false),
                _ => {
                    let (op, negated, left) = self.operator(ty);
                    let operand = match self.operand(ty) {
                        // A division by the constant 0 is an error at compile time.
                        Operand::Const(ty, 0) if op == "DIV" || op == "MOD" => Operand::Const(ty, 7),
                        // Most variables are 0 for a while; not each program shall end there.
                        Operand::Var(ty, _) if (op == "DIV" || op == "MOD") && self.rng.u8(..8) > 0 => {
                            Operand::Const(ty, 3)
                        }
                        operand => operand,
                    };
                    out.push(Ins::Op(op, negated, operand));
                    ty = left;
                }
            }
        }
        ty
    }

    /// An instruction that leaves the current result.
    fn effect(&mut self, ty: Ty, out: &mut Vec<Ins>, inner: bool) {
        match (ty, self.rng.u8(..6)) {
            (Ty::Bool, 0 | 1) => out.push(Ins::Set(self.rng.bool(), self.rng.usize(..VARS))),
            (Ty::Bool, 2) if !inner => {
                let when = if self.rng.bool() { When::True } else { When::False };
                out.push(Ins::Block(when, self.operand(Ty::Int)));
            }
            (_, 3) if !inner => out.push(Ins::Block(When::Always, self.operand(Ty::Int))),
            (Ty::Bool | Ty::Word, 4) => out.push(Ins::Store(true, ty, self.rng.usize(..VARS))),
            _ => out.push(Ins::Store(false, ty, self.rng.usize(..VARS))),
        }
    }

    /// A jump to a label from a place where the current result is BOOL or of the label's type.
    fn jump(&mut self, from: usize, out: &mut Vec<Ins>) {
        let to = self.rng.usize(..self.labels.len());
        let back = to <= from;
        if back {
            // Each backward jump takes from the budget.
            out.push(Ins::Load(false, Operand::Var(Ty::Int, VARS)));
            out.push(Ins::Op("SUB", false, Operand::Const(Ty::Int, 1)));
            out.push(Ins::Store(false, Ty::Int, VARS));
            out.push(Ins::Op("LT", false, Operand::Const(Ty::Int, 0)));
            out.push(Ins::Return(When::True));
        }
        match self.labels[to] {
            Some(Ty::Bool) | None => {
                self.value(Ty::Bool, out, 1);
                let when = [When::Always, When::True, When::False][self.rng.usize(..3)];
                out.push(Ins::Jump(when, to));
            }
            Some(ty) => {
                self.value(ty, out, 1);
                out.push(Ins::Jump(When::Always, to));
            }
        }
    }

    fn program(&mut self) -> Vec<Ins> {
        let count = self.rng.usize(2..6);
        self.labels = (0..count).map(|_| if self.rng.bool() { Some(self.ty()) } else { None }).collect();
        let mut out =
            vec![Ins::Load(false, Operand::Const(Ty::Int, i64::from(BUDGET))), Ins::Store(false, Ty::Int, VARS)];
        for segment in 0..count {
            // The way from above brings what the label's other ways bring.
            if let Some(ty) = self.labels[segment] {
                self.value(ty, &mut out, 1);
            }
            out.push(Ins::Label(segment));
            let mut ty = match self.labels[segment] {
                Some(ty) => ty,
                None => {
                    let ty = self.ty();
                    self.value(ty, &mut out, 2);
                    ty
                }
            };
            for _ in 0..self.rng.u32(1..5) {
                let count = self.rng.u32(..4);
                ty = self.chain(ty, count, &mut out, 2);
                self.effect(ty, &mut out, false);
                if self.rng.u8(..4) == 0 {
                    ty = Ty::Int;
                    if self.rng.bool() {
                        out.push(Ins::Formal(self.operand(Ty::Int), self.operand(Ty::Int)));
                    } else {
                        out.push(Ins::Total);
                    }
                }
            }
            match self.rng.u8(..4) {
                0 if ty == Ty::Bool => {
                    out.push(Ins::Return(if self.rng.bool() { When::True } else { When::False }));
                }
                0 => {}
                _ => self.jump(segment, &mut out),
            }
        }
        out
    }
}

// ---- text ----

fn operand_text(operand: Operand) -> String {
    match operand {
        Operand::Var(ty, n) => format!("{}{n}", ty.letter()),
        Operand::Const(Ty::Bool, v) => (if v == 1 { "TRUE" } else { "FALSE" }).to_string(),
        Operand::Const(Ty::Word, v) => format!("WORD#16#{v:X}"),
        Operand::Const(ty, v) => format!("{}#{v}", ty.name()),
    }
}

fn suffix(when: When) -> &'static str {
    match when {
        When::Always => "",
        When::True => "C",
        When::False => "CN",
    }
}

fn print(list: &[Ins], out: &mut String) {
    for ins in list {
        let _ = match ins {
            Ins::Label(n) => writeln!(out, "l{n}:"),
            Ins::Load(n, o) => writeln!(out, "{} {}", if *n { "LDN" } else { "LD" }, operand_text(*o)),
            Ins::Store(n, ty, v) => writeln!(out, "{} {}{v}", if *n { "STN" } else { "ST" }, ty.letter()),
            Ins::Set(to, v) => writeln!(out, "{} b{v}", if *to { "S" } else { "R" }),
            Ins::Not => writeln!(out, "NOT"),
            Ins::Op(op, n, o) => writeln!(out, "{op}{} {}", if *n { "N" } else { "" }, operand_text(*o)),
            Ins::Paren(op, n, same_line, inner) => {
                let n = if *n { "N" } else { "" };
                match (&inner[0], same_line) {
                    (Ins::Load(false, o), true) => {
                        let _ = writeln!(out, "{op}{n}( {}", operand_text(*o));
                        print(&inner[1..], out);
                    }
                    _ => {
                        let _ = writeln!(out, "{op}{n}(");
                        print(inner, out);
                    }
                }
                writeln!(out, ")")
            }
            Ins::Jump(w, l) => writeln!(out, "JMP{} l{l}", suffix(*w)),
            Ins::Return(w) => writeln!(out, "RET{}", suffix(*w)),
            Ins::Call(name, o) => writeln!(out, "{name} {}", operand_text(*o)),
            Ins::Formal(a, b) => writeln!(out, "Sum(a := {},\n  b := {})", operand_text(*a), operand_text(*b)),
            Ins::Block(w, o) => writeln!(out, "CAL{} block(\n  amount := {}\n)", suffix(*w), operand_text(*o)),
            Ins::Total => writeln!(out, "LD block.total"),
        };
    }
}

fn source(list: &[Ins]) -> String {
    let mut text = String::from(
        "FUNCTION Sum : INT\nVAR_INPUT a, b : INT; END_VAR\nSum := a + b;\nEND_FUNCTION\n\
         FUNCTION_BLOCK Adder\nVAR_INPUT amount : INT; END_VAR\nVAR_OUTPUT total : INT; END_VAR\n\
         LD total\nADD amount\nST total\nEND_FUNCTION_BLOCK\nPROGRAM Main\nVAR\n  block : Adder; i4 : INT;\n",
    );
    for ty in TYPES {
        let names: Vec<String> = (0..VARS).map(|n| format!("{}{n}", ty.letter())).collect();
        let _ = writeln!(text, "  {} : {};", names.join(", "), ty.name());
    }
    text.push_str("END_VAR\n");
    print(list, &mut text);
    text.push_str("END_PROGRAM\n");
    text
}

// ---- the accumulator machine ----

/// A division by zero.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Fault;

enum Next {
    Go,
    Jump(usize),
    Leave,
}

#[derive(Default)]
struct Machine {
    /// By type, then number.
    vars: [[i64; VARS + 1]; 4],
    total: i64,
    /// The current result; `None` before the first one.
    cr: Option<(Ty, i64)>,
}

impl Machine {
    fn read(&self, operand: Operand) -> (Ty, i64) {
        match operand {
            Operand::Var(ty, n) => (ty, self.vars[ty as usize][n]),
            Operand::Const(ty, v) => (ty, v),
        }
    }

    fn current(&self) -> (Ty, i64) {
        self.cr.expect("a current result")
    }

    fn holds(&self, when: When) -> bool {
        match when {
            When::Always => true,
            When::True => self.current().1 == 1,
            When::False => self.current().1 == 0,
        }
    }

    fn combine(&mut self, op: &str, negated: bool, (_, b): (Ty, i64)) -> Result<(), Fault> {
        let (ty, a) = self.current();
        let b = if negated { ty.not(b) } else { b };
        let truth = |v: bool| (Ty::Bool, i64::from(v));
        self.cr = Some(match op {
            "AND" | "&" => (ty, a & b),
            "OR" => (ty, a | b),
            "XOR" => (ty, a ^ b),
            "ADD" => (ty, ty.wrap(a + b)),
            "SUB" => (ty, ty.wrap(a - b)),
            "MUL" => (ty, ty.wrap(a * b)),
            "DIV" | "MOD" if b == 0 => return Err(Fault),
            "DIV" => (ty, ty.wrap(a / b)),
            "MOD" => (ty, ty.wrap(a % b)),
            "EQ" => truth(a == b),
            "NE" => truth(a != b),
            "LT" => truth(a < b),
            "LE" => truth(a <= b),
            "GT" => truth(a > b),
            "GE" => truth(a >= b),
            other => panic!("{other}"),
        });
        Ok(())
    }

    fn step(&mut self, ins: &Ins) -> Result<Next, Fault> {
        match ins {
            Ins::Label(_) => {}
            Ins::Load(negated, o) => {
                let (ty, v) = self.read(*o);
                self.cr = Some((ty, if *negated { ty.not(v) } else { v }));
            }
            Ins::Store(negated, ty, n) => {
                let (_, v) = self.current();
                self.vars[*ty as usize][*n] = if *negated { ty.not(v) } else { v };
            }
            Ins::Set(to, n) => {
                if self.current().1 == 1 {
                    self.vars[Ty::Bool as usize][*n] = i64::from(*to);
                }
            }
            Ins::Not => {
                let (ty, v) = self.current();
                self.cr = Some((ty, ty.not(v)));
            }
            Ins::Op(op, negated, o) => {
                let right = self.read(*o);
                self.combine(op, *negated, right)?;
            }
            Ins::Paren(op, negated, _, inner) => {
                let left = self.cr;
                self.cr = None;
                for ins in inner {
                    self.step(ins)?;
                }
                let right = self.current();
                self.cr = left;
                self.combine(op, *negated, right)?;
            }
            Ins::Jump(when, label) if self.holds(*when) => return Ok(Next::Jump(*label)),
            Ins::Return(when) if self.holds(*when) => return Ok(Next::Leave),
            Ins::Jump(..) | Ins::Return(_) => {}
            Ins::Call(name, o) => {
                let (a, b) = (self.current().1, self.read(*o).1);
                let v = match *name {
                    "MAX" => a.max(b),
                    "MIN" => a.min(b),
                    _ => Ty::Int.wrap(a + b),
                };
                self.cr = Some((Ty::Int, v));
            }
            Ins::Formal(a, b) => {
                self.cr = Some((Ty::Int, Ty::Int.wrap(self.read(*a).1 + self.read(*b).1)));
            }
            Ins::Block(when, o) => {
                if self.holds(*when) {
                    self.total = Ty::Int.wrap(self.total + self.read(*o).1);
                }
            }
            Ins::Total => self.cr = Some((Ty::Int, self.total)),
        }
        Ok(Next::Go)
    }

    fn cycle(&mut self, list: &[Ins]) -> Result<(), Fault> {
        self.cr = None;
        let mut at = 0;
        while let Some(ins) = list.get(at) {
            at = match self.step(ins)? {
                Next::Go => at + 1,
                Next::Jump(label) => {
                    list.iter().position(|i| matches!(i, Ins::Label(n) if *n == label)).expect("the label")
                }
                Next::Leave => return Ok(()),
            };
        }
        Ok(())
    }
}

// ---- comparison ----

/// The faults of a random program, or how the engines and the machine part.
fn all_agree(list: &[Ins], text: &str) -> Result<bool, String> {
    let checked = check(text, Profile::Strict)?;
    let (program, layout) = lower(&checked)?;
    let code = plcc_codegen::jit::compile(&program).map_err(|e| format!("{e:?}"))?;
    let mut interp = Interp::new(&program);
    let size = program.region_bytes as usize;
    let (mut a, mut b) = (region(size), region(size));
    let (a, b) = (&mut bytes_of(&mut a)[..size], &mut bytes_of(&mut b)[..size]);
    interp.init(a, true);
    code.init(b, true);
    let main = checked.defs.pous.iter().find(|p| p.name == "Main").ok_or("no Main")?;
    let places: Vec<(Ty, usize, usize)> = main
        .vars
        .iter()
        .filter_map(|v| {
            let var = &checked.defs.vars[*v];
            debug_assert!(matches!(var.init, Init::Default));
            let ty = TYPES.into_iter().find(|t| var.name.starts_with(t.letter()) && var.name.len() == 2)?;
            let number: usize = var.name[1..].parse().ok()?;
            Some((ty, number, layout.offset(*v, layout.program(0))?.0 as usize))
        })
        .collect();
    assert_eq!(places.len(), 4 * VARS + 1);
    let mut machine = Machine::default();
    for cycle in 1..=CYCLES {
        let expected = machine.cycle(list);
        let x = interp.scan(a, 0, 0);
        let y = code.scan(b, 0, 0);
        if x != y || (x != 0) != expected.is_err() {
            return Err(format!("cycle {cycle}: interpreter {x}, native code {y}, machine {expected:?}"));
        }
        for (ty, number, at) in &places {
            let want = machine.vars[*ty as usize][*number];
            for (engine, memory) in [("interpreter", &*a), ("native code", &*b)] {
                let raw = |n: usize| memory[*at..*at + n].iter().rev().fold(0u64, |v, b| v << 8 | u64::from(*b));
                let bytes = [1, 2, 4, 2][*ty as usize];
                let got = ty.wrap(raw(bytes) as i64);
                if got != want {
                    return Err(format!("cycle {cycle}: {}{number} is {got} in the {engine}, not {want}", ty.letter()));
                }
            }
        }
        if expected.is_err() {
            return Ok(true);
        }
    }
    Ok(false)
}

/// The text of a random program.
pub fn random_text(seed: u64) -> String {
    let mut generator = Generator { rng: Rng::with_seed(seed), labels: Vec::new() };
    source(&generator.program())
}

#[test]
fn random_il_agrees_with_an_accumulator_machine() {
    let count = super::setting("RANDOM_IL", 250);
    let first = super::setting("RANDOM_SEED", 1);
    let (mut faults, mut finished) = (0u64, 0u64);
    for seed in first..first + count {
        let mut generator = Generator { rng: Rng::with_seed(seed), labels: Vec::new() };
        let list = generator.program();
        let text = source(&list);
        match super::deep(|| all_agree(&list, &text)) {
            Ok(true) => faults += 1,
            Ok(false) => finished += 1,
            Err(e) => panic!("seed {seed}: {e}\n{text}"),
        }
    }
    println!("{finished} IL programs finished, {faults} stopped with the same fault");
    if count >= 200 {
        assert!(finished > count / 4 && faults > 0, "{finished} finished, {faults} faults");
    }
}
