//! Random work on strings: the interpreter, native code and a few lines over lists of characters agree.
//!
//! All engines share the lowering, so that they cannot tell when it is wrong: [`Model`] is written from semantics.md \[T8\] \[N2\]
//! and uses nothing of the compiler. The programs take texts apart and put lines together, in a function with a local that often
//! is the rest of an input all the time, as people write it.

use fastrand::Rng;
use plcc_hir::Profile;
use plcc_mir::interp::Interp;
use plcc_tests::compile::{check, lower};
use plcc_tests::memory::{bytes_of, region};
use std::fmt::Write;

/// The strings of the function: its input, the rest of it, two more, its result. Each with its capacity.
const STRINGS: [(&str, usize); 5] = [("line", 12), ("rest", 14), ("a", 5), ("b", 40), ("Work", 20)];
const LINE: usize = 0;
const REST: usize = 1;
const NUMBERS: [&str; 2] = ["m", "n"];
const TEXTS: [&str; 6] = ["a;bb;c", "", ";;", "b1;-12;a;bbbb", "aaaaaaaaaaaa", "1"];

#[derive(Debug, Clone)]
enum Num {
    Const(i16),
    Var(usize),
    Len(Box<Text>),
    Find(Box<Text>, Box<Text>),
    Less(Box<Num>),
}

#[derive(Debug, Clone)]
enum Text {
    Var(usize),
    Const(String),
    Left(Box<Text>, Num),
    Right(Box<Text>, Num),
    Mid(Box<Text>, Num, Num),
    Delete(Box<Text>, Num, Num),
    Insert(Box<Text>, Box<Text>, Num),
    Replace(Box<Text>, Box<Text>, Num, Num),
    Concat(Vec<Text>),
    Write(Num),
}

#[derive(Debug, Clone)]
enum Stmt {
    Set(usize, Text),
    Count(usize, Num),
    If(Text, &'static str, Text, Vec<Stmt>, Vec<Stmt>),
    Loop(u32, Vec<Stmt>),
    Leave,
}

struct Generator {
    rng: Rng,
    loops: u32,
}

impl Generator {
    fn characters(&mut self, most: usize) -> String {
        let length = self.rng.usize(0..=most);
        (0..length).map(|_| ["a", "b", ";", "1", "-"][self.rng.usize(0..5)]).collect()
    }

    fn num(&mut self, depth: u32) -> Num {
        match self.rng.u32(0..if depth == 0 { 5 } else { 9 }) {
            0..=2 => Num::Const(self.rng.i16(-1..8)),
            3 | 4 => Num::Var(self.rng.usize(0..2)),
            5 => Num::Len(Box::new(self.text(depth - 1))),
            6 | 7 => {
                let unit = [";", "b", "1"][self.rng.usize(0..3)].to_string();
                let wanted = if self.rng.u32(0..4) > 0 { Text::Const(unit) } else { self.text(0) };
                Num::Find(Box::new(self.text(depth - 1)), Box::new(wanted))
            }
            _ => Num::Less(Box::new(self.num(depth - 1))),
        }
    }

    fn text(&mut self, depth: u32) -> Text {
        let inner = |g: &mut Self| Box::new(g.text(depth - 1));
        match self.rng.u32(0..if depth == 0 { 6 } else { 16 }) {
            0..=3 => Text::Var([LINE, REST, REST, 2, 3, 4][self.rng.usize(0..6)]),
            4 | 5 => Text::Const(self.characters(4)),
            6 | 7 => Text::Left(inner(self), self.num(depth)),
            8 => Text::Right(inner(self), self.num(depth)),
            9 => Text::Mid(inner(self), self.num(depth), self.num(depth)),
            10 => Text::Delete(inner(self), self.num(depth), self.num(depth)),
            11 => Text::Insert(inner(self), inner(self), self.num(depth)),
            12 => Text::Replace(inner(self), inner(self), self.num(depth), self.num(depth)),
            13 => Text::Write(self.num(depth)),
            _ => Text::Concat((0..self.rng.usize(2..4)).map(|_| self.text(depth - 1)).collect()),
        }
    }

    fn stmts(&mut self, depth: u32) -> Vec<Stmt> {
        (0..self.rng.usize(1..5)).map(|_| self.stmt(depth)).collect()
    }

    fn stmt(&mut self, depth: u32) -> Stmt {
        let var = |n: usize| Box::new(Text::Var(n));
        match self.rng.u32(0..if depth == 0 { 12 } else { 17 }) {
            0..=2 => {
                let count = match self.rng.u32(0..3) {
                    0 => self.num(1),
                    _ => Num::Find(var(REST), Box::new(Text::Const(";".into()))),
                };
                Stmt::Set(REST, Text::Delete(var(REST), count, Num::Const(1)))
            }
            3 => Stmt::Set(REST, Text::Var(LINE)),
            4 => {
                // In one of several programs `rest` is a string like any other.
                let target = if self.rng.u32(0..12) == 0 { REST } else { self.rng.usize(2..5) };
                Stmt::Set(target, self.text(2))
            }
            5 | 6 => {
                let at = Num::Find(var(REST), Box::new(Text::Const(";".into())));
                Stmt::Set(self.rng.usize(2..5), Text::Left(var(REST), Num::Less(Box::new(at))))
            }
            7 | 8 => {
                let target = self.rng.usize(2..5);
                let mut parts = vec![Text::Var(target)];
                parts.extend((0..self.rng.usize(1..4)).map(|_| match self.rng.u32(0..3) {
                    0 => Text::Write(self.num(0)),
                    1 => Text::Const(self.characters(6)),
                    _ => self.text(1),
                }));
                Stmt::Set(target, Text::Concat(parts))
            }
            9 => {
                let target = self.rng.usize(2..5);
                let new = Box::new(self.text(1));
                Stmt::Set(target, Text::Replace(var(target), new, self.num(1), self.num(1)))
            }
            10 | 11 => Stmt::Count(self.rng.usize(0..2), self.num(2)),
            12..=14 => {
                let first = if self.rng.bool() {
                    Text::Left(Box::new(self.text(0)), Num::Const(self.rng.i16(0..4)))
                } else {
                    self.text(1)
                };
                let second = if self.rng.bool() { Text::Const(self.characters(3)) } else { self.text(1) };
                let op = ["=", "<>", "<", ">="][self.rng.usize(0..4)];
                Stmt::If(first, op, second, self.stmts(depth - 1), self.stmts(depth - 1))
            }
            15 if self.loops < 2 => {
                self.loops += 1;
                let body = self.stmts(depth - 1);
                self.loops -= 1;
                Stmt::Loop(self.rng.u32(0..4), body)
            }
            _ => Stmt::Leave,
        }
    }
}

// ---- as text ----

fn number(n: &Num) -> String {
    match n {
        Num::Const(v) => v.to_string(),
        Num::Var(n) => NUMBERS[*n].to_string(),
        Num::Len(t) => format!("LEN({})", string(t)),
        Num::Find(a, b) => format!("FIND({}, {})", string(a), string(b)),
        Num::Less(n) => format!("({} - INT#1)", number(n)),
    }
}

fn string(t: &Text) -> String {
    match t {
        Text::Var(n) => STRINGS[*n].0.to_string(),
        Text::Const(s) => format!("'{s}'"),
        Text::Left(t, l) => format!("LEFT({}, {})", string(t), number(l)),
        Text::Right(t, l) => format!("RIGHT({}, {})", string(t), number(l)),
        Text::Mid(t, l, p) => format!("MID({}, {}, {})", string(t), number(l), number(p)),
        Text::Delete(t, l, p) => format!("DELETE({}, {}, {})", string(t), number(l), number(p)),
        Text::Insert(a, b, p) => format!("INSERT({}, {}, {})", string(a), string(b), number(p)),
        Text::Replace(a, b, l, p) => {
            format!("REPLACE({}, {}, {}, {})", string(a), string(b), number(l), number(p))
        }
        Text::Concat(list) => format!("CONCAT({})", list.iter().map(string).collect::<Vec<_>>().join(", ")),
        Text::Write(n) => format!("INT_TO_STRING({})", number(n)),
    }
}

fn print(list: &[Stmt], depth: usize, out: &mut String) {
    for stmt in list {
        let _ = match stmt {
            Stmt::Set(n, t) => writeln!(out, "{} := {};", STRINGS[*n].0, string(t)),
            Stmt::Count(n, v) => writeln!(out, "{} := {};", NUMBERS[*n], number(v)),
            Stmt::Leave => writeln!(out, "IF m > n THEN RETURN; END_IF;"),
            Stmt::If(a, op, b, yes, no) => {
                let _ = writeln!(out, "IF {} {op} {} THEN", string(a), string(b));
                print(yes, depth, out);
                out.push_str("ELSE\n");
                print(no, depth, out);
                writeln!(out, "END_IF;")
            }
            Stmt::Loop(count, body) => {
                let _ = writeln!(out, "FOR k{depth} := 1 TO {count} DO");
                print(body, depth + 1, out);
                writeln!(out, "END_FOR;")
            }
        };
    }
}

/// The function, called for each text, with what it gives in variables of their own.
fn source(list: &[Stmt]) -> String {
    let mut out = String::from("FUNCTION Work : STRING[20]\nVAR_INPUT line : STRING[12]; END_VAR\nVAR_OUTPUT\n");
    out.push_str(
        "  a : STRING[5]; b : STRING[40]; m, n : INT;\nEND_VAR\nVAR\n  rest : STRING[14]; k0, k1, k2, k3 : INT;\n",
    );
    out.push_str("END_VAR\nrest := line;\n");
    print(list, 0, &mut out);
    out.push_str("END_FUNCTION\nPROGRAM Main\nVAR\n");
    for n in 0..TEXTS.len() {
        let _ = writeln!(out, "  a{n} : STRING[5]; b{n} : STRING[40]; r{n} : STRING[20]; m{n}, n{n} : INT;");
    }
    out.push_str("END_VAR\n");
    for (n, text) in TEXTS.iter().enumerate() {
        let _ = writeln!(out, "r{n} := Work(line := '{text}', a => a{n}, b => b{n}, m => m{n}, n => n{n});");
    }
    out.push_str("END_PROGRAM\n");
    out
}

// ---- the model ----

struct Model {
    strings: [Vec<u8>; 5],
    numbers: [i16; 2],
}

/// The function has ended.
struct Left;

impl Model {
    fn run(list: &[Stmt], line: &str) -> Self {
        let mut model = Model { strings: Default::default(), numbers: [0; 2] };
        model.set(LINE, line.as_bytes().to_vec());
        model.set(REST, model.strings[LINE].clone());
        let _ = model.stmts(list);
        model
    }

    fn set(&mut self, n: usize, mut text: Vec<u8>) {
        text.truncate(STRINGS[n].1);
        self.strings[n] = text;
    }

    fn stmts(&mut self, list: &[Stmt]) -> Result<(), Left> {
        for stmt in list {
            match stmt {
                Stmt::Set(n, t) => self.set(*n, self.text(t)),
                Stmt::Count(n, v) => self.numbers[*n] = self.num(v),
                Stmt::Leave if self.numbers[0] > self.numbers[1] => return Err(Left),
                Stmt::Leave => {}
                Stmt::If(a, op, b, yes, no) => {
                    let order = self.text(a).cmp(&self.text(b));
                    let holds = match *op {
                        "=" => order.is_eq(),
                        "<>" => order.is_ne(),
                        "<" => order.is_lt(),
                        _ => order.is_ge(),
                    };
                    self.stmts(if holds { yes } else { no })?;
                }
                Stmt::Loop(count, body) => (0..*count).try_for_each(|_| self.stmts(body))?,
            }
        }
        Ok(())
    }

    fn num(&self, n: &Num) -> i16 {
        match n {
            Num::Const(v) => *v,
            Num::Var(n) => self.numbers[*n],
            Num::Len(t) => self.text(t).len() as i16,
            Num::Find(a, b) => {
                let (a, b) = (self.text(a), self.text(b));
                let at = if b.is_empty() { None } else { a.windows(b.len()).position(|w| w == b) };
                at.map_or(0, |at| at as i16 + 1)
            }
            Num::Less(n) => self.num(n).wrapping_sub(1),
        }
    }

    /// A length or position; a negative one counts as 0.
    fn count(&self, n: &Num) -> usize {
        self.num(n).max(0) as usize
    }

    /// From position `p` on `l` characters, or what there is; `None` if the position is outside.
    fn part(text: &[u8], l: usize, p: usize) -> Option<(usize, usize)> {
        (1..=text.len()).contains(&p).then(|| (p - 1, (p - 1 + l).min(text.len())))
    }

    fn text(&self, t: &Text) -> Vec<u8> {
        match t {
            Text::Var(n) => self.strings[*n].clone(),
            Text::Const(s) => s.as_bytes().to_vec(),
            Text::Left(t, l) => self.text(t).into_iter().take(self.count(l)).collect(),
            Text::Right(t, l) => {
                let text = self.text(t);
                let skip = text.len().saturating_sub(self.count(l));
                text[skip..].to_vec()
            }
            Text::Mid(t, l, p) => {
                let text = self.text(t);
                Self::part(&text, self.count(l), self.count(p)).map_or(Vec::new(), |(from, to)| text[from..to].to_vec())
            }
            Text::Delete(t, l, p) => self.splice(self.text(t), self.count(l), self.count(p), &[]),
            Text::Replace(a, b, l, p) => self.splice(self.text(a), self.count(l), self.count(p), &self.text(b)),
            Text::Insert(a, b, p) => {
                let (mut text, p) = (self.text(a), self.count(p));
                if p <= text.len() {
                    text.splice(p..p, self.text(b));
                }
                text
            }
            Text::Concat(list) => list.iter().flat_map(|t| self.text(t)).collect(),
            Text::Write(n) => self.num(n).to_string().into_bytes(),
        }
    }

    fn splice(&self, mut text: Vec<u8>, l: usize, p: usize, new: &[u8]) -> Vec<u8> {
        if let Some((from, to)) = Self::part(&text, l, p) {
            text.splice(from..to, new.iter().copied());
        }
        text
    }
}

/// Whether all agree on what the function gives for every text.
fn all_agree(list: &[Stmt], text: &str) -> Result<(), String> {
    let checked = check(text, Profile::Strict)?;
    let (plain, layout) = lower(&checked)?;
    let mut fast = plain.clone();
    plcc_mir::opt::optimise(&mut fast);
    let code = plcc_codegen::jit::compile(&fast).map_err(|e| format!("{e:?}"))?;
    let main = checked.defs.pous.iter().find(|p| p.name == "Main").ok_or("no Main")?;
    let size = fast.region_bytes.max(plain.region_bytes) as usize;
    let mut memories = [region(size), region(size), region(size)];
    let [a, b, c] = memories.each_mut().map(|memory| bytes_of(memory));
    let (mut first, mut second) = (Interp::new(&plain), Interp::new(&fast));
    first.init(&mut a[..plain.region_bytes as usize], true);
    second.init(&mut b[..fast.region_bytes as usize], true);
    code.init(&mut c[..fast.region_bytes as usize], true);
    let models = TEXTS.map(|line| Model::run(list, line));
    for cycle in 1..=2 {
        let faults = [
            first.scan(&mut a[..plain.region_bytes as usize], 0, 0),
            second.scan(&mut b[..fast.region_bytes as usize], 0, 0),
            code.scan(&mut c[..fast.region_bytes as usize], 0, 0),
        ];
        if faults != [0; 3] {
            return Err(format!("cycle {cycle}: faults {faults:?}"));
        }
        for id in &main.vars {
            let name = &checked.defs.vars[*id].name;
            let (kind, number) = name.split_at(1);
            let model = &models[number.parse::<usize>().map_err(|e| e.to_string())?];
            let at = layout.offset(*id, layout.program(0)).ok_or("no place")?.0 as usize;
            for (engine, memory) in [("plain", &*a), ("optimised", &*b), ("native", &*c)] {
                let string = || memory[at..].iter().copied().take_while(|b| *b != 0).collect::<Vec<u8>>();
                let int = || i16::from_le_bytes([memory[at], memory[at + 1]]);
                let (got, want) = match kind {
                    "a" => (string(), model.strings[2].clone()),
                    "b" => (string(), model.strings[3].clone()),
                    "r" => (string(), model.strings[4].clone()),
                    "m" => (int().to_string().into_bytes(), model.numbers[0].to_string().into_bytes()),
                    _ => (int().to_string().into_bytes(), model.numbers[1].to_string().into_bytes()),
                };
                if got != want {
                    let [got, want] = [got, want].map(|text| String::from_utf8_lossy(&text).into_owned());
                    return Err(format!("cycle {cycle}: {name} is '{got}' in {engine} code, not '{want}'"));
                }
            }
        }
    }
    Ok(())
}

#[test]
fn random_texts_agree_with_lists_of_characters() {
    let count = super::setting("RANDOM_TEXTS", 150);
    let first = super::setting("RANDOM_SEED", 1);
    let (mut tails, mut strings) = (0u64, 0u64);
    for seed in first..first + count {
        let mut generator = Generator { rng: Rng::with_seed(seed), loops: 0 };
        let list = generator.stmts(3).into_iter().chain(generator.stmts(2)).collect::<Vec<_>>();
        let text = source(&list);
        if let Err(e) = super::deep(|| all_agree(&list, &text)) {
            panic!("seed {seed}: {e}\n{text}");
        }
        let other = text.lines().any(|l| l.starts_with("rest :=") && l != "rest := line;" && !l.ends_with(", 1);"));
        *(if other { &mut strings } else { &mut tails }) += 1;
    }
    if count >= 100 {
        assert!(tails > count / 4 && strings > count / 40, "`rest` was a tail in {tails}, a string in {strings}");
    }
}
