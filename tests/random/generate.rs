//! Random well-typed programs as ST text, from a seed.
//!
//! Every name is declared, every operand has the type that strict asks for; what may happen at run time is not avoided but
//! kept rare: an index may be out of bounds, a divisor 0, a subrange violated. Loops are bounded by construction.

mod expressions;

use std::fmt::Write;

/// Scalar types that the generator uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ty {
    Bool,
    Int {
        bits: u32,
        signed: bool,
    },
    Bits(u32),
    Real,
    Lreal,
    Time,
    /// `Color`
    Enum,
    /// `Small`: INT (-5..20)
    Small,
    Char,
    /// STRING or WSTRING; without capacity: a VAR_IN_OUT of any.
    Text {
        wide: bool,
        capacity: Option<u32>,
    },
}

const DINT: Ty = Ty::Int { bits: 32, signed: true };

const TYPES: [Ty; 23] = [
    Ty::Bool,
    Ty::Bool,
    Ty::Int { bits: 8, signed: true },
    Ty::Int { bits: 16, signed: true },
    Ty::Int { bits: 16, signed: true },
    Ty::Int { bits: 32, signed: true },
    Ty::Int { bits: 64, signed: true },
    Ty::Int { bits: 8, signed: false },
    Ty::Int { bits: 16, signed: false },
    Ty::Int { bits: 32, signed: false },
    Ty::Int { bits: 64, signed: false },
    Ty::Bits(8),
    Ty::Bits(16),
    Ty::Bits(32),
    Ty::Real,
    Ty::Lreal,
    Ty::Time,
    Ty::Enum,
    Ty::Char,
    Ty::Text { wide: false, capacity: Some(5) },
    Ty::Text { wide: false, capacity: Some(20) },
    Ty::Text { wide: false, capacity: Some(150) },
    Ty::Text { wide: true, capacity: Some(8) },
];

/// The shortest capacity in `TYPES`.
const SHORTEST: u32 = 5;

impl Ty {
    fn name(self) -> &'static str {
        match self {
            Ty::Bool => "BOOL",
            Ty::Int { bits: 8, signed: true } => "SINT",
            Ty::Int { bits: 16, signed: true } => "INT",
            Ty::Int { bits: 32, signed: true } => "DINT",
            Ty::Int { signed: true, .. } => "LINT",
            Ty::Int { bits: 8, .. } => "USINT",
            Ty::Int { bits: 16, .. } => "UINT",
            Ty::Int { bits: 32, .. } => "UDINT",
            Ty::Int { .. } => "ULINT",
            Ty::Bits(8) => "BYTE",
            Ty::Bits(16) => "WORD",
            Ty::Bits(32) => "DWORD",
            Ty::Bits(_) => "LWORD",
            Ty::Real => "REAL",
            Ty::Lreal => "LREAL",
            Ty::Time => "TIME",
            Ty::Enum => "Color",
            Ty::Small => "Small",
            Ty::Char => "CHAR",
            Ty::Text { wide: true, .. } => "WSTRING[8]",
            Ty::Text { capacity: None, .. } => "STRING",
            Ty::Text { capacity: Some(5), .. } => "STRING[5]",
            Ty::Text { capacity: Some(20), .. } => "STRING[20]",
            Ty::Text { .. } => "STRING[150]",
        }
    }

    /// As in the names of conversions.
    fn keyword(self) -> &'static str {
        match self {
            Ty::Text { wide, .. } => {
                if wide {
                    "WSTRING"
                } else {
                    "STRING"
                }
            }
            other => other.name(),
        }
    }

    /// Whether a value of this type can stand where one of the other is wanted: strings of any capacity.
    fn fits(self, wanted: Ty) -> bool {
        match (self, wanted) {
            (Ty::Text { wide: a, .. }, Ty::Text { wide: b, .. }) => a == b,
            _ => self == wanted,
        }
    }
}

/// A variable that can be read and perhaps written.
#[derive(Debug, Clone)]
struct Var {
    /// As written: `x`, `a[2]`, `s.f`.
    text: String,
    ty: Ty,
    write: bool,
}

/// A function that earlier text declared.
#[derive(Debug, Clone)]
struct Function {
    name: String,
    params: Vec<Ty>,
    result: Ty,
    /// Has a VAR_IN_OUT of type DINT.
    in_out: bool,
    /// Has a VAR_OUTPUT of type INT.
    output: bool,
    /// Has a VAR_IN_OUT STRING of any capacity.
    text_in_out: bool,
    /// Has a VAR_IN_OUT ARRAY [*] OF DINT.
    open: bool,
}

/// A function block that earlier text declared.
#[derive(Debug, Clone)]
struct Block {
    name: String,
    inputs: Vec<(String, Ty)>,
    outputs: Vec<(String, Ty)>,
    action: bool,
}

pub struct Generator {
    rng: fastrand::Rng,
    out: String,
    /// Prefix of all names of this program, so that several fit into one source.
    prefix: String,
    functions: Vec<Function>,
    blocks: Vec<Block>,
    vars: Vec<Var>,
    instances: Vec<(String, Block)>,
    arrays: Vec<(String, i64, i64, Ty)>,
    /// References and the types of their targets.
    references: Vec<(String, Ty)>,
    /// The input of this function that `rest` was at the beginning, and its type.
    tail: Option<(String, Ty)>,
    loops: u32,
    loop_vars: Vec<String>,
    free_loop_vars: Vec<String>,
    indent: usize,
    /// Whether faults are to be possible.
    faults: bool,
    /// Most programs are short: much of what two statements can do to each other, in little time. One in seventeen is long,
    /// so that with and without the optimiser (every second seed) both run such.
    deep: bool,
}

/// One program named `{prefix}Main` with its functions and blocks.
pub fn program(seed: u64, prefix: &str, faults: bool) -> String {
    let mut g = Generator {
        rng: fastrand::Rng::with_seed(seed),
        out: String::new(),
        prefix: prefix.to_string(),
        functions: Vec::new(),
        blocks: Vec::new(),
        vars: Vec::new(),
        instances: Vec::new(),
        arrays: Vec::new(),
        references: Vec::new(),
        tail: None,
        loops: 0,
        loop_vars: Vec::new(),
        free_loop_vars: Vec::new(),
        indent: 1,
        faults,
        deep: seed.is_multiple_of(17),
    };
    for n in 0..g.rng.usize(0..4) {
        g.function(n);
    }
    for n in 0..g.rng.usize(0..3) {
        g.block(n);
    }
    g.main();
    g.out
}

/// Declarations that all programs of a source share.
pub const SHARED: &str = "\
TYPE
  Color : (Red, Green := 5, Blue);
  Small : INT (-5..20);
  Pair : STRUCT a : INT := 3; b : DINT; c : BOOL; r : REAL := 0.5; n : STRING[5] := 'pair'; END_STRUCT;
  Nest : STRUCT p : Pair := (a := 9); m : ARRAY [1..2] OF Pair; END_STRUCT;
END_TYPE
";

impl Generator {
    fn chance(&mut self, percent: u32) -> bool {
        self.rng.u32(0..100) < percent
    }

    fn pick_type(&mut self) -> Ty {
        TYPES[self.rng.usize(0..TYPES.len())]
    }

    fn line(&mut self, text: &str) {
        let _ = writeln!(self.out, "{:width$}{text}", "", width = self.indent * 2);
    }

    /// Starts the scope of a POU: its own variables only.
    fn scope(&mut self) {
        self.vars.clear();
        self.instances.clear();
        self.arrays.clear();
        self.references.clear();
        self.tail = None;
        self.loop_vars.clear();
        self.free_loop_vars.clear();
    }

    fn declare(&mut self, section: &str, names: &str, count: usize, write: bool) -> Vec<(String, Ty)> {
        let mut made = Vec::new();
        if count == 0 {
            return made;
        }
        self.line(section);
        for n in 0..count {
            let ty = if write && self.chance(6) { Ty::Small } else { self.pick_type() };
            let name = format!("{names}{n}");
            let init = if self.chance(40) { format!(" := {}", self.literal(ty)) } else { String::new() };
            let edge = match (section, ty, self.rng.u32(0..4)) {
                ("VAR_INPUT RETAIN", Ty::Bool, 0) => " R_EDGE",
                ("VAR_INPUT RETAIN", Ty::Bool, 1) => " F_EDGE",
                _ => "",
            };
            self.line(&format!("  {name} : {}{edge}{init};", ty.name()));
            self.vars.push(Var { text: name.clone(), ty, write });
            made.push((name, ty));
        }
        self.line("END_VAR");
        made
    }

    /// Locals of every POU: scalars, arrays, a structure, loop counters.
    fn locals(&mut self, blocks: bool) {
        let count = self.rng.usize(2..7);
        self.declare("VAR", "v", count, true);
        self.line("VAR");
        for n in 0..self.rng.usize(0..3) {
            let ty = self.pick_type();
            let low = self.rng.i64(-3..3);
            let high = low + self.rng.i64(1..6);
            let values: Vec<String> = (0..3).map(|_| self.literal(ty)).collect();
            let init = match self.rng.u32(0..3) {
                0 => format!(" := [{}, 2({})]", values[0], values[1]),
                1 => format!(" := [{}]", values[2]),
                _ => String::new(),
            };
            let fits = high - low + 1 >= 3;
            let init = if fits { init } else { String::new() };
            self.line(&format!("  arr{n} : ARRAY [{low}..{high}] OF {}{init};", ty.name()));
            self.arrays.push((format!("arr{n}"), low, high, ty));
        }
        if self.chance(30) {
            self.line("  mat : ARRAY [0..2, 1..4] OF DINT;");
            for text in ["mat[1, 2]", "mat[0, 4]", "mat[2, 1]"] {
                self.vars.push(Var { text: text.into(), ty: Ty::Int { bits: 32, signed: true }, write: true });
            }
        }
        if self.chance(50) {
            self.line("  s : Pair; t : Pair := (a := 7, c := TRUE);");
            for s in ["s", "t"] {
                for (f, ty) in [
                    ("a", Ty::Int { bits: 16, signed: true }),
                    ("b", Ty::Int { bits: 32, signed: true }),
                    ("c", Ty::Bool),
                    ("r", Ty::Real),
                    ("n", Ty::Text { wide: false, capacity: Some(5) }),
                ] {
                    self.vars.push(Var { text: format!("{s}.{f}"), ty, write: true });
                }
            }
        }
        if self.chance(30) {
            self.line("  nest : Nest;");
            for (path, ty) in [
                ("p.a", Ty::Int { bits: 16, signed: true }),
                ("m[2].b", DINT),
                ("m[1].r", Ty::Real),
                ("m[2].n", Ty::Text { wide: false, capacity: Some(5) }),
            ] {
                self.vars.push(Var { text: format!("nest.{path}"), ty, write: true });
            }
        }
        if self.chance(50) {
            let low = self.rng.i64(-2..2);
            let high = low + self.rng.i64(1..4);
            self.line(&format!("  dints : ARRAY [{low}..{high}] OF DINT;"));
            self.arrays.push(("dints".into(), low, high, DINT));
        }
        self.references();
        for n in 0..3 {
            self.line(&format!("  i{n} : INT;"));
            self.vars.push(Var { text: format!("i{n}"), ty: Ty::Int { bits: 16, signed: true }, write: false });
            self.free_loop_vars.push(format!("i{n}"));
        }
        if blocks {
            for n in 0..self.rng.usize(0..3) {
                if self.blocks.is_empty() {
                    break;
                }
                let block = self.blocks[self.rng.usize(0..self.blocks.len())].clone();
                let name = format!("fb{n}");
                self.line(&format!("  {name} : {};", block.name));
                self.instance(name, block);
            }
            if self.chance(30) && !self.blocks.is_empty() {
                let block = self.blocks[self.rng.usize(0..self.blocks.len())].clone();
                self.line(&format!("  fbs : ARRAY [1..3] OF {};", block.name));
                self.instance("fbs[1]".into(), block.clone());
                self.instance("fbs[3]".into(), block);
            }
            for n in 0..self.rng.usize(0..3) {
                let block = standard_block(self.rng.usize(0..STANDARD));
                let name = format!("std{n}");
                self.line(&format!("  {name} : {};", block.name));
                self.instance(name, block);
            }
        }
        self.line("END_VAR");
    }

    /// References to variables that stand before them, initialised; pointers to arrays.
    fn references(&mut self) {
        for n in 0..self.rng.usize(0..3) {
            let targets = self.targets(None);
            if targets.is_empty() {
                break;
            }
            let (target, ty) = targets[self.rng.usize(0..targets.len())].clone();
            let name = format!("ref{n}");
            self.line(&format!("  {name} : REF_TO {} := REF({target});", ty.name()));
            self.references.push((name, ty));
        }
        // They become variables last, so that none refers to what another one refers to.
        for (name, ty) in self.references.clone() {
            self.vars.push(Var { text: format!("{name}^"), ty, write: true });
        }
        if let (Some((name, low, high, ty)), true) = (self.arrays.first().cloned(), self.chance(30)) {
            self.line(&format!("  ptr : POINTER TO ARRAY [{low}..{high}] OF {} := ADR({name});", ty.name()));
            self.arrays.push(("ptr^".into(), low, high, ty));
        }
    }

    /// Variables of this POU to which a reference can point, of one type or of any.
    fn targets(&self, wanted: Option<Ty>) -> Vec<(String, Ty)> {
        let stays = |v: &&Var| {
            let own = ["v", "s.", "t.", "nest.", "mat["].iter().any(|start| v.text.starts_with(start));
            own && v.write && v.ty != Ty::Small && !v.text.contains('^') && wanted.is_none_or(|ty| ty == v.ty)
        };
        self.vars.iter().filter(stays).map(|v| (v.text.clone(), v.ty)).collect()
    }

    fn instance(&mut self, name: String, block: Block) {
        for (output, ty) in &block.outputs {
            self.vars.push(Var { text: format!("{name}.{output}"), ty: *ty, write: false });
        }
        self.instances.push((name, block));
    }

    fn function(&mut self, n: usize) {
        self.scope();
        let name = format!("{}Fn{n}", self.prefix);
        let result = self.pick_type();
        self.indent = 0;
        self.line(&format!("FUNCTION {name} : {}", result.name()));
        self.indent = 1;
        let count = self.rng.usize(1..4);
        let inputs = self.declare("VAR_INPUT", "p", count, false);
        let text = inputs.iter().find(|(_, ty)| matches!(ty, Ty::Text { .. })).cloned();
        let params = inputs.into_iter().map(|(_, ty)| ty).collect();
        let in_out = self.chance(30);
        let output = self.chance(30);
        if in_out {
            self.line("VAR_IN_OUT io : DINT; END_VAR");
            self.vars.push(Var { text: "io".into(), ty: Ty::Int { bits: 32, signed: true }, write: true });
        }
        let text_in_out = self.chance(40);
        if text_in_out {
            self.line("VAR_IN_OUT text : STRING; END_VAR");
            self.vars.push(Var { text: "text".into(), ty: Ty::Text { wide: false, capacity: None }, write: true });
        }
        let open = self.chance(30);
        if open {
            self.line("VAR_IN_OUT open : ARRAY [*] OF DINT; END_VAR");
            for text in ["open[LOWER_BOUND(open, 1)]", "open[UPPER_BOUND(open, 1)]"] {
                self.vars.push(Var { text: text.into(), ty: DINT, write: true });
            }
            if self.faults && self.chance(20) {
                self.vars.push(Var { text: "open[2]".into(), ty: DINT, write: false });
            }
        }
        if output {
            self.line("VAR_OUTPUT o : INT := 4; END_VAR");
            self.vars.push(Var { text: "o".into(), ty: Ty::Int { bits: 16, signed: true }, write: true });
        }
        self.locals(false);
        if let Some((input, ty)) = text.filter(|_| self.chance(60)) {
            self.line(&format!("VAR rest : {}; END_VAR", ty.name()));
            if self.chance(10) {
                self.statements(2);
            }
            self.line(&format!("rest := {input};"));
            self.vars.push(Var { text: "rest".into(), ty, write: false });
            self.tail = Some((input, ty));
        }
        self.statements(3);
        let value = self.expr(result, 2);
        self.line(&format!("{name} := {value};"));
        self.indent = 0;
        self.line("END_FUNCTION");
        self.functions.push(Function { name, params, result, in_out, output, text_in_out, open });
    }

    fn block(&mut self, n: usize) {
        self.scope();
        let name = format!("{}Fb{n}", self.prefix);
        self.indent = 0;
        self.line(&format!("FUNCTION_BLOCK {name}"));
        self.indent = 1;
        let inputs = self.rng.usize(1..4);
        // Only function blocks have edges, and functions nothing to retain: the word tells them apart.
        let inputs = self.declare("VAR_INPUT RETAIN", "p", inputs, false);
        let outputs = self.rng.usize(1..4);
        let outputs = self.declare("VAR_OUTPUT", "q", outputs, true);
        let outputs: Vec<(String, Ty)> = outputs.into_iter().collect();
        if self.chance(30) {
            self.line("VAR_TEMP tmp : DINT; END_VAR");
            self.vars.push(Var { text: "tmp".into(), ty: Ty::Int { bits: 32, signed: true }, write: true });
        }
        self.locals(true);
        self.statements(if self.deep { 4 } else { 2 });
        let action = self.chance(30);
        if action {
            self.line("ACTION act :");
            self.statements(2);
            self.line("END_ACTION");
        }
        self.indent = 0;
        self.line("END_FUNCTION_BLOCK");
        self.blocks.push(Block { name, inputs, outputs, action });
    }

    fn main(&mut self) {
        self.scope();
        self.indent = 0;
        let name = format!("{}Main", self.prefix);
        self.line(&format!("PROGRAM {name}"));
        self.indent = 1;
        self.locals(true);
        self.line("VAR cycle : DINT; END_VAR");
        self.vars.push(Var { text: "cycle".into(), ty: Ty::Int { bits: 32, signed: true }, write: false });
        self.line("cycle := cycle + 1;");
        self.statements(if self.deep { 6 } else { 3 });
        self.indent = 0;
        self.line("END_PROGRAM");
    }

    fn statements(&mut self, depth: u32) {
        for _ in 0..self.rng.u32(1..5) {
            self.statement(depth);
        }
    }

    fn writable(&mut self) -> Option<Var> {
        let list: Vec<Var> = self.vars.iter().filter(|v| v.write).cloned().collect();
        if list.is_empty() { None } else { Some(list[self.rng.usize(0..list.len())].clone()) }
    }

    fn statement(&mut self, depth: u32) {
        let kind = if depth == 0 { self.rng.u32(0..50) } else { self.rng.u32(0..100) };
        match kind {
            0..=29 => self.assign(),
            30..=39 => self.array_assign(),
            40..=49 => self.call_block(),
            50..=64 => {
                let cond = self.expr(Ty::Bool, 3);
                self.line(&format!("IF {cond} THEN"));
                self.nested(depth);
                if self.chance(40) {
                    let cond = self.expr(Ty::Bool, 2);
                    self.line(&format!("ELSIF {cond} THEN"));
                    self.nested(depth);
                }
                if self.chance(50) {
                    self.line("ELSE");
                    self.nested(depth);
                }
                self.line("END_IF;");
            }
            65..=74 => self.case(depth),
            75..=86 => self.for_loop(depth),
            87..=92 if self.loops < 2 => self.while_loop(depth),
            93..=95 if self.loops > 0 => {
                let cond = self.expr(Ty::Bool, 2);
                let word = if self.chance(50) { "EXIT" } else { "CONTINUE" };
                self.line(&format!("IF {cond} THEN {word}; END_IF;"));
            }
            96 if self.loops == 0 => {
                let cond = self.expr(Ty::Bool, 2);
                self.line(&format!("IF {cond} THEN RETURN; END_IF;"));
            }
            _ => self.assign(),
        }
    }

    fn nested(&mut self, depth: u32) {
        self.indent += 1;
        self.statements(depth - 1);
        self.indent -= 1;
    }

    /// A string that becomes shorter from its front, and what is read of it.
    fn take_apart(&mut self, input: &str, ty: Ty) {
        let Ty::Text { wide, .. } = ty else { return };
        let quote = if wide { '"' } else { '\'' };
        let unit = format!("{quote}{}{quote}", ["a", "b", "1", " "][self.rng.usize(0..4)]);
        let text = match self.rng.u32(0..20) {
            0..=3 => format!("rest := DELETE(rest, {}, 1);", self.position(1)),
            4..=8 => format!("rest := DELETE(rest, FIND(rest, {unit}), 1);"),
            9 | 10 => format!("rest := {input};"),
            11 => format!("rest := DELETE(rest, {}, {});", self.position(0), self.position(0)),
            kind => {
                let Some(var) = self.writable() else { return };
                match (var.ty, kind) {
                    (Ty::Text { wide: other, .. }, 12..=15) if other == wide => {
                        format!("{} := LEFT(rest, FIND(rest, {unit}) - 1);", var.text)
                    }
                    (Ty::Text { wide: other, .. }, _) if other == wide => format!("{} := rest;", var.text),
                    (Ty::Int { bits: 16, signed: true }, 12..=15) => format!("{} := LEN(rest);", var.text),
                    (Ty::Bool, _) => format!("{} := LEFT(rest, 2) = {};", var.text, self.literal(ty)),
                    _ => return,
                }
            }
        };
        self.line(&text);
    }

    /// A string that is built from what it was.
    fn put_together(&mut self, var: &Var) {
        let (name, ty) = (&var.text, var.ty);
        let text = match self.rng.u32(0..12) {
            0..=2 => format!("{name} := CONCAT({name}, {});", self.literal(ty)),
            3..=5 => format!("{name} := CONCAT({name}, {}, {});", self.literal(ty), self.expr(ty, 1)),
            6 | 7 => {
                let number = self.expr(DINT, 1);
                format!("{name} := CONCAT({name}, DINT_TO_{}({number}), {});", ty.keyword(), self.literal(ty))
            }
            8..=10 => {
                let new = self.expr(ty, 1);
                format!("{name} := REPLACE({name}, {new}, {}, {});", self.position(1), self.position(1))
            }
            _ => format!(
                "IF LEFT({name}, {}) = {} THEN {name} := {}; END_IF;",
                self.rng.u32(0..4),
                self.literal(ty),
                self.literal(ty)
            ),
        };
        self.line(&text);
    }

    fn assign(&mut self) {
        if self.vars.iter().any(|v| v.text == "s.a") && self.chance(8) {
            let text = match self.rng.u32(0..4) {
                0 => "s := t;".into(),
                1 => "t := s;".into(),
                2 => format!("s := SEL({}, s, t);", self.expr(Ty::Bool, 2)),
                _ => format!("t := MUX({}, s, t, s);", self.expr(Ty::Int { bits: 16, signed: true }, 2)),
            };
            self.line(&text);
            return;
        }
        if !self.references.is_empty() && self.chance(8) {
            let (name, ty) = self.references[self.rng.usize(0..self.references.len())].clone();
            let same: Vec<String> = self.references.iter().filter(|r| r.1 == ty).map(|r| r.0.clone()).collect();
            let targets = self.targets(Some(ty));
            let text = match self.rng.u32(0..20) {
                0 if self.faults => format!("{name} := NULL;"),
                1..=6 => format!("{name} ?= {};", same[self.rng.usize(0..same.len())]),
                _ if targets.is_empty() => return,
                _ => format!("{name} := REF({});", targets[self.rng.usize(0..targets.len())].0),
            };
            self.line(&text);
            return;
        }
        if let (Some((input, ty)), true) = (self.tail.clone(), self.chance(25)) {
            self.take_apart(&input, ty);
            return;
        }
        let Some(var) = self.writable() else { return };
        if let (Ty::Text { .. }, true) = (var.ty, self.chance(25)) {
            self.put_together(&var);
            return;
        }
        if let (Ty::Bits(bits), true) = (var.ty, self.chance(20)) {
            let value = self.expr(Ty::Bool, 2);
            let bit = self.rng.u32(0..bits);
            self.line(&format!("{}.{bit} := {value};", var.text));
            return;
        }
        if let (Ty::Text { wide: false, capacity }, true) = (var.ty, self.chance(20)) {
            let index = self.index(1, i64::from(capacity.unwrap_or(SHORTEST)));
            let value = self.expr(Ty::Char, 2);
            self.line(&format!("{}[{index}] := {value};", var.text));
            return;
        }
        let value = self.expr(var.ty, 4);
        self.line(&format!("{} := {value};", var.text));
    }

    fn index(&mut self, low: i64, high: i64) -> String {
        match self.rng.u32(0..10) {
            0..=4 => self.rng.i64(low..=high).to_string(),
            5..=7 => {
                let value = self.expr(Ty::Int { bits: 16, signed: true }, 1);
                format!("LIMIT({low}, {value}, {high})")
            }
            // Sometimes outside.
            _ if self.faults => format!("i{}", self.rng.u32(0..3)),
            _ => self.rng.i64(low..=high).to_string(),
        }
    }

    fn array_assign(&mut self) {
        if self.arrays.is_empty() {
            return self.assign();
        }
        let (name, low, high, ty) = self.arrays[self.rng.usize(0..self.arrays.len())].clone();
        let index = self.index(low, high);
        let value = self.expr(ty, 3);
        self.line(&format!("{name}[{index}] := {value};"));
    }

    fn call_block(&mut self) {
        if self.instances.is_empty() {
            return self.assign();
        }
        let (name, block) = self.instances[self.rng.usize(0..self.instances.len())].clone();
        if block.action && self.chance(30) {
            self.line(&format!("{name}.act();"));
            return;
        }
        let mut args = Vec::new();
        for (input, ty) in &block.inputs {
            if self.chance(80) {
                args.push(format!("{input} := {}", self.expr(*ty, 2)));
            }
        }
        for (output, ty) in &block.outputs {
            let targets: Vec<String> =
                self.vars.iter().filter(|v| v.write && ty.fits(v.ty)).map(|v| v.text.clone()).collect();
            if !targets.is_empty() && self.chance(25) {
                let not = if *ty == Ty::Bool && self.chance(30) { "NOT " } else { "" };
                args.push(format!("{not}{output} => {}", targets[self.rng.usize(0..targets.len())]));
            }
        }
        self.line(&format!("{name}({});", args.join(", ")));
    }

    fn case(&mut self, depth: u32) {
        if self.chance(25) {
            let value = self.expr(Ty::Enum, 1);
            self.line(&format!("CASE {value} OF"));
            for label in ["Red", "Green, Blue"] {
                self.line(&format!("{label}:"));
                self.nested(depth);
            }
            self.line("END_CASE;");
            return;
        }
        let value = self.expr(Ty::Int { bits: 16, signed: true }, 2);
        self.line(&format!("CASE {value} OF"));
        let mut next = self.rng.i64(-4..2);
        for _ in 0..self.rng.u32(1..6) {
            let label = if self.chance(30) {
                let high = next + self.rng.i64(1..20);
                let text = format!("{next}..{high}");
                next = high;
                text
            } else {
                next.to_string()
            };
            next += self.rng.i64(1..4);
            self.line(&format!("{label}:"));
            self.nested(depth);
        }
        if self.chance(60) {
            self.line("ELSE");
            self.nested(depth);
        }
        self.line("END_CASE;");
    }

    fn for_loop(&mut self, depth: u32) {
        let Some(var) = self.free_loop_vars.pop() else { return self.assign() };
        let from = self.rng.i64(-4..5);
        // Sometimes long: what is done with loops depends on their passes.
        let longest = if self.loops == 0 && self.chance(15) { 40 } else { 7 };
        let to = from + self.rng.i64(-4..longest);
        let by = match self.rng.u32(0..5) {
            0 => " BY 2".to_string(),
            1 => " BY -1".to_string(),
            2 if self.faults && self.chance(20) => format!(" BY i{}", self.rng.u32(0..3)),
            _ => String::new(),
        };
        self.line(&format!("FOR {var} := {from} TO {to}{by} DO"));
        self.loop_vars.push(var.clone());
        self.loops += 1;
        self.nested(depth);
        self.loops -= 1;
        self.loop_vars.pop();
        self.line("END_FOR;");
        self.free_loop_vars.push(var);
    }

    fn while_loop(&mut self, depth: u32) {
        let Some(var) = self.free_loop_vars.pop() else { return self.assign() };
        let count = self.rng.u32(1..6);
        self.line(&format!("{var} := 0;"));
        self.loops += 1;
        if self.rng.bool() {
            let cond = self.expr(Ty::Bool, 2);
            self.line(&format!("WHILE {var} < {count} AND ({cond}) DO"));
            self.line(&format!("  {var} := {var} + 1;"));
            self.nested(depth);
            self.line("END_WHILE;");
        } else {
            let cond = self.expr(Ty::Bool, 2);
            self.line("REPEAT");
            self.line(&format!("  {var} := {var} + 1;"));
            self.nested(depth);
            self.line(&format!("UNTIL {var} >= {count} OR ({cond}) END_REPEAT;"));
        }
        self.loops -= 1;
        self.free_loop_vars.push(var);
    }
}

const STANDARD: usize = 12;

fn standard_block(n: usize) -> Block {
    let bool = Ty::Bool;
    let int = Ty::Int { bits: 16, signed: true };
    let real = Ty::Real;
    let names = |list: &[(&str, Ty)]| list.iter().map(|(n, t)| (n.to_string(), *t)).collect();
    type Parameters = Vec<(String, Ty)>;
    let (name, inputs, outputs): (&str, Parameters, Parameters) = match n {
        0 => ("TON", names(&[("IN", bool), ("PT", Ty::Time)]), names(&[("Q", bool), ("ET", Ty::Time)])),
        1 => ("TOF", names(&[("IN", bool), ("PT", Ty::Time)]), names(&[("Q", bool), ("ET", Ty::Time)])),
        2 => ("TP", names(&[("IN", bool), ("PT", Ty::Time)]), names(&[("Q", bool), ("ET", Ty::Time)])),
        3 => ("CTU", names(&[("CU", bool), ("R", bool), ("PV", int)]), names(&[("Q", bool), ("CV", int)])),
        4 => ("CTD", names(&[("CD", bool), ("LD", bool), ("PV", int)]), names(&[("Q", bool), ("CV", int)])),
        5 => ("R_TRIG", names(&[("CLK", bool)]), names(&[("Q", bool)])),
        6 => ("F_TRIG", names(&[("CLK", bool)]), names(&[("Q", bool)])),
        7 => ("LIMITS_ALARM", names(&[("H", real), ("X", real), ("EPS", real)]), names(&[("Q", bool), ("QL", bool)])),
        8 => ("AVERAGE", names(&[("RUN", bool), ("XIN", real), ("N", int)]), names(&[("XOUT", real)])),
        9 => ("LAG1", names(&[("XIN", real), ("TAU", Ty::Time), ("CYCLE", Ty::Time)]), names(&[("XOUT", real)])),
        10 => ("SEMA", names(&[("CLAIM", bool), ("RELEASE", bool)]), names(&[("BUSY", bool)])),
        _ => ("SR", names(&[("S1", bool), ("R", bool)]), names(&[("Q1", bool)])),
    };
    Block { name: name.into(), inputs, outputs, action: false }
}
