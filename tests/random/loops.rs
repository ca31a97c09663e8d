//! Random nests of loops over arrays: what the passes over loops live on. Bounds are constants or inputs of the nest, steps
//! go up and down by one or more, counters have every width, are read in the loop, behind it and in the next one, and an
//! index may be out of bounds.

use std::fmt::Write;

const COUNTERS: [(&str, &str); 6] =
    [("i", "INT"), ("j", "INT"), ("k", "DINT"), ("s", "SINT"), ("u", "UINT"), ("b", "USINT")];

struct Nest {
    rng: fastrand::Rng,
    out: String,
    /// Counters of the loops around, which nothing else assigns.
    running: Vec<usize>,
}

/// A program from a seed.
pub fn program(seed: u64) -> String {
    let mut nest = Nest { rng: fastrand::Rng::with_seed(seed), out: String::new(), running: Vec::new() };
    nest.out.push_str(
        "FUNCTION_BLOCK Cell\nVAR_INPUT x : DINT; END_VAR\nVAR_OUTPUT y : DINT; n : INT; END_VAR\n\
         y := (y + x) MOD 1000; n := n + 1; IF n > 5 THEN n := 0; END_IF;\nEND_FUNCTION_BLOCK\n\
         PROGRAM Main\nVAR\n  a : ARRAY [0..15] OF DINT; h : ARRAY [1..12] OF INT; m : ARRAY [0..5, 1..6] OF DINT;\n  \
         q : ARRAY [-2..9] OF REAL; t : ARRAY [0..7] OF BOOL; cells : ARRAY [0..3] OF Cell;\n  \
         sum, d, low, high : DINT; r : REAL; flag : BOOL; cycle, n : INT;\n",
    );
    for (name, ty) in COUNTERS {
        let _ = writeln!(nest.out, "  {name} : {ty};");
    }
    nest.out
        .push_str("END_VAR\ncycle := cycle + 1;\nlow := cycle MOD 3;\nhigh := 3 + cycle MOD 5;\nn := cycle MOD 7;\n");
    for _ in 0..nest.rng.usize(1..4) {
        nest.nest(3);
    }
    nest.out.push_str("END_PROGRAM\n");
    nest.out
}

impl Nest {
    fn chance(&mut self, percent: u32) -> bool {
        self.rng.u32(0..100) < percent
    }

    fn line(&mut self, text: &str) {
        let _ = writeln!(self.out, "{:width$}{text}", "", width = 2 * self.running.len());
    }

    fn nest(&mut self, depth: usize) {
        let free: Vec<usize> = (0..COUNTERS.len()).filter(|n| !self.running.contains(n)).collect();
        let counter = free[self.rng.usize(0..free.len())];
        let name = COUNTERS[counter].0;
        let end = match self.rng.u32(0..10) {
            0..=6 => {
                let (first, last) = (self.bound(counter), self.bound(counter));
                let (by, swap) = self.step(counter);
                let (first, last) = if swap { (last, first) } else { (first, last) };
                self.line(&format!("FOR {name} := {first} TO {last}{by} DO"));
                "END_FOR;"
            }
            7..=8 => {
                let first = self.rng.u32(0..4);
                self.line(&format!("{name} := {first};"));
                let more = if self.chance(30) { " AND sum < 100000" } else { "" };
                let last = self.rng.u32(2..9);
                self.line(&format!("WHILE {name} < {last}{more} DO"));
                self.line(&format!("  {name} := {name} + 1;"));
                "END_WHILE;"
            }
            _ => {
                self.line(&format!("{name} := 0;"));
                self.line("REPEAT");
                let by = self.rng.u32(1..3);
                self.line(&format!("  {name} := {name} + {by};"));
                ""
            }
        };
        self.running.push(counter);
        for _ in 0..self.rng.usize(1..4) {
            if depth > 1 && self.chance(35) {
                self.nest(depth - 1);
            } else {
                self.statement();
            }
        }
        self.running.pop();
        if end.is_empty() {
            let last = self.rng.u32(1..8);
            self.line(&format!("UNTIL {name} >= {last} END_REPEAT;"));
        } else {
            self.line(end);
        }
        if self.chance(40) {
            let read = self.widened(name);
            self.line(&format!("sum := sum + {read};"));
        }
    }

    fn bound(&mut self, counter: usize) -> String {
        let ty = COUNTERS[counter].1;
        match self.rng.u32(0..10) {
            0 if ty == "DINT" => "low".into(),
            1 if ty == "DINT" => "high".into(),
            2 if ty == "INT" => "n".into(),
            3 => format!("DINT_TO_{ty}({})", if self.chance(50) { "low" } else { "high" }).replace("DINT_TO_DINT", ""),
            _ => self.rng.u32(0..10).to_string(),
        }
    }

    /// BY and whether it counts down.
    fn step(&mut self, counter: usize) -> (String, bool) {
        let signed = !COUNTERS[counter].1.starts_with('U');
        match self.rng.u32(0..8) {
            0 => (" BY 2".into(), false),
            1 => (" BY 3".into(), false),
            2 if signed => (" BY -1".into(), true),
            3 if signed => (" BY -2".into(), true),
            _ => (String::new(), false),
        }
    }

    /// A counter as a DINT.
    fn widened(&self, name: &str) -> String {
        let ty = COUNTERS.iter().find(|(n, _)| *n == name).map_or("DINT", |(_, ty)| ty);
        if ty == "DINT" { name.into() } else { format!("{ty}_TO_DINT({name})") }
    }

    fn counter(&mut self) -> String {
        let n = self.running[self.rng.usize(0..self.running.len())];
        COUNTERS[n].0.into()
    }

    /// An index that is in the bounds more often than not.
    fn index(&mut self, low: i64, high: i64) -> String {
        let name = self.counter();
        let wide = self.widened(&name);
        match self.rng.u32(0..10) {
            0 => self.rng.i64(low..=high).to_string(),
            1..=3 => format!("LIMIT({low}, {wide}, {high})"),
            4 => format!("({wide} + {}) MOD {} + {}", self.rng.u32(0..4), high - low + 1, low.max(0)),
            5 => format!("{wide} + {}", low + self.rng.i64(-1..3)),
            6 => format!("{high} - {wide}"),
            _ => name,
        }
    }

    fn operand(&mut self) -> String {
        match self.rng.u32(0..9) {
            0 | 1 => format!("a[{}]", self.index(0, 15)),
            2 => format!("m[{}, {}]", self.index(0, 5), self.index(1, 6)),
            3 => format!("INT_TO_DINT(h[{}])", self.index(1, 12)),
            4 => "sum".into(),
            5 => "d".into(),
            6 => format!("cells[{}].y", self.index(0, 3)),
            7 => self.rng.i64(-9..10).to_string(),
            _ => {
                let name = self.counter();
                self.widened(&name)
            }
        }
    }

    fn value(&mut self) -> String {
        let (x, y) = (self.operand(), self.operand());
        match self.rng.u32(0..8) {
            0 => x,
            1 => format!("{x} - {y}"),
            2 => format!("{x} * {}", self.rng.u32(1..6)),
            3 => format!("{x} / {}", self.rng.u32(2..9)),
            4 => format!("{x} MOD ({y})"),
            5 => format!("MAX({x}, {y})"),
            6 => format!("SEL({x} > {y}, {x}, {y})"),
            _ => format!("{x} + {y}"),
        }
    }

    fn statement(&mut self) {
        let value = self.value();
        let text = match self.rng.u32(0..16) {
            0..=2 => format!("sum := {value};"),
            3 => format!("d := {value};"),
            4..=6 => format!("a[{}] := {value};", self.index(0, 15)),
            7 => format!("m[{}, {}] := {value};", self.index(0, 5), self.index(1, 6)),
            8 => format!("h[{}] := DINT_TO_INT({value});", self.index(1, 12)),
            9 => format!("q[{}] := q[{}] * 0.5 + r;", self.index(-2, 9), self.index(-2, 9)),
            10 => format!("r := r + q[{}];", self.index(-2, 9)),
            11 => format!("t[{}] := {value} > {};", self.index(0, 7), self.operand()),
            12 => {
                format!("IF t[{}] THEN d := d + 1; ELSE a[{}] := {value}; END_IF;", self.index(0, 7), self.index(0, 15))
            }
            13 => format!("cells[{}](x := {value});", self.index(0, 3)),
            14 => format!("IF {value} > {} THEN EXIT; END_IF;", self.rng.u32(20..400)),
            _ => format!("IF {value} = {} THEN CONTINUE; END_IF;", self.rng.u32(0..9)),
        };
        self.line(&text);
    }
}
