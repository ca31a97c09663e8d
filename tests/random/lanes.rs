//! Random loops over neighbouring elements, as the pass `jam` and the packs of code generation want them, and almost so:
//! elements of every size, sizes that fill no register, windows that overlap, products of matrices, filters over channels,
//! conditions that are the same for all elements and such that are not. Reals begin with zeros of both signs, infinities,
//! denormals and what makes NaN, or stay tame; a NaN has no sign that one may rely on, so only tame ones are negated.

use std::fmt::Write;

struct Lanes {
    rng: fastrand::Rng,
    out: String,
    ty: &'static str,
    tame: bool,
    /// Elements of a row of the matrices.
    row: u32,
    /// Rows.
    rows: u32,
    /// Elements of the arrays.
    length: u32,
}

/// A program from a seed.
pub fn program(seed: u64) -> String {
    let mut rng = fastrand::Rng::with_seed(seed);
    let ty = ["REAL", "LREAL", "LREAL", "REAL", "DINT", "LINT", "DWORD"][rng.usize(0..7)];
    let (tame, row, rows, length) = (rng.bool(), rng.u32(3..14), rng.u32(2..6), rng.u32(8..38));
    let mut lanes = Lanes { rng, out: String::new(), ty, tame, row, rows, length };
    lanes.declarations();
    for _ in 0..lanes.rng.usize(1..4) {
        match lanes.rng.u32(0..8) {
            0..=3 => lanes.map(),
            4 | 5 => lanes.product(),
            6 => lanes.channels(),
            _ => lanes.grid(),
        }
    }
    lanes.out.push_str("END_PROGRAM\n");
    lanes.out
}

impl Lanes {
    fn real(&self) -> bool {
        self.ty.ends_with("REAL")
    }

    fn bits(&self) -> bool {
        self.ty == "DWORD"
    }

    fn declarations(&mut self) {
        let (ty, row, rows, length) = (self.ty, self.row, self.rows, self.length);
        let counter = ["INT", "LINT", "LINT"][self.rng.usize(0..3)];
        let _ = write!(
            self.out,
            "PROGRAM Main\nVAR\n  x, y, z : ARRAY [0..{length}] OF {ty};\n  \
             m, n, p : ARRAY [0..{}, 0..{}] OF {ty};\n  q : ARRAY [0..{}, 0..{}] OF {ty};\n  \
             a, b, s : {ty};\n  cycle, i, j, k : {counter};\n  flag : BOOL;\n  seed : DINT := {};\n",
            rows - 1,
            row - 1,
            row - 1,
            row - 1,
            self.rng.u32(1..1000)
        );
        let value = match (self.real(), self.bits(), self.tame) {
            (true, _, true) => format!("DINT_TO_{ty}(seed MOD 200) / 128.0"),
            (true, ..) => "c[seed MOD 12]".to_string(),
            (_, true, _) => "DINT_TO_DWORD(seed)".to_string(),
            _ => format!("DINT_TO_{ty}(seed MOD 2000 - 1000)").replace("DINT_TO_DINT", ""),
        };
        let wild = self.real() && !self.tame;
        if wild {
            let _ = writeln!(self.out, "  c : ARRAY [0..11] OF {ty};");
        }
        self.out.push_str("END_VAR\ncycle := cycle + 1;\nflag := cycle MOD 3 = 1;\nIF cycle = 1 THEN\n");
        if wild {
            let (tiny, huge) = if ty == "REAL" { ("1.0E-39", "3.0E38") } else { ("4.0E-310", "1.0E308") };
            let _ = write!(
                self.out,
                "  c[0] := 0.0; c[1] := -0.0; c[2] := {tiny}; c[3] := 0.0 - c[2]; c[4] := {huge}; c[4] := c[4] * 10.0;\n  \
                 c[5] := 0.0 - c[4]; c[6] := c[4] - c[4]; c[7] := 1.5; c[8] := -2.25; c[9] := {huge}; c[10] := 0.1; c[11] := 3.0;\n"
            );
        }
        let next = "seed := (seed * 1103 + 12345) MOD 30011;";
        let _ = write!(
            self.out,
            "  FOR i := 0 TO {length} DO {next} x[i] := {value}; {next} y[i] := {value}; END_FOR;\n  \
             FOR i := 0 TO {} DO FOR j := 0 TO {} DO {next} m[i, j] := {value}; {next} n[i, j] := {value}; END_FOR; END_FOR;\n  \
             FOR i := 0 TO {} DO FOR j := 0 TO {} DO {next} q[i, j] := {value}; END_FOR; END_FOR;\n  \
             {next} a := {value}; {next} b := {value};\nEND_IF;\n",
            rows - 1,
            row - 1,
            row - 1,
            row - 1
        );
    }

    fn constant(&mut self) -> String {
        if self.real() {
            ["0.5", "-0.25", "0.125", "0.1", "1.0"][self.rng.usize(0..5)].into()
        } else if self.bits() {
            ["16#FF00FF", "16#70F0F0F0", "1"][self.rng.usize(0..3)].into()
        } else {
            self.rng.i32(-9..10).to_string()
        }
    }

    /// An operand at the counters of the loops around: `i` a row, `j` an element.
    fn operand(&mut self, elements: &[String]) -> String {
        match self.rng.u32(0..10) {
            0 => "a".into(),
            1 => "b".into(),
            2 => self.constant(),
            _ => elements[self.rng.usize(0..elements.len())].clone(),
        }
    }

    fn value(&mut self, elements: &[String], depth: u32) -> String {
        if depth == 0 {
            return self.operand(elements);
        }
        let (x, y) = (self.value(elements, depth - 1), self.operand(elements));
        let constant = self.constant();
        if self.bits() {
            return match self.rng.u32(0..5) {
                0 => format!("({x} AND {y})"),
                1 => format!("({x} OR {y})"),
                2 => format!("(NOT {x})"),
                _ => format!("({x} XOR {y})"),
            };
        }
        match self.rng.u32(0..12) {
            0 | 1 => format!("({x} + {y})"),
            2 => format!("({x} - {y})"),
            3 | 4 => format!("({x} * {constant})"),
            5 if !self.tame || !self.real() => format!("({x} * {y})"),
            6 if !self.tame && self.real() => format!("({x} / {y})"),
            6 if self.real() => format!("({x} / 3.0)"),
            7 => format!("MAX({x}, {y})"),
            8 => format!("MIN({x}, {y})"),
            9 => format!("SEL({x} < {y}, {y}, {x})"),
            10 if self.tame => format!("ABS({x})"),
            10 => format!("SEL({x} = {y} OR {x} > {constant}, {y}, {x})"),
            11 if self.tame => format!("(-{x})"),
            _ => format!("({x} * {constant} + {y})"),
        }
    }

    /// The same, and tame values stay so.
    fn result(&mut self, elements: &[String]) -> String {
        let depth = self.rng.u32(1..4);
        let value = self.value(elements, depth);
        if self.tame && self.real() { format!("LIMIT(-9.0, {value}, 9.0)") } else { value }
    }

    /// FOR over arrays, at distances of up to three elements.
    fn map(&mut self) {
        let (low, high) = (self.rng.u32(2..4), self.length - self.rng.u32(3..5));
        let near = |rng: &mut fastrand::Rng| ["i", "i", "i", "i", "i + 1", "i - 1", "i + 3", "i - 2"][rng.usize(0..8)];
        let _ = writeln!(self.out, "FOR i := {low} TO {high} DO");
        for _ in 0..self.rng.usize(1..4) {
            let mut elements = vec!["x[i]".to_string(), "y[i]".to_string()];
            for array in ["x", "y", "z"] {
                elements.push(format!("{array}[{}]", near(&mut self.rng)));
            }
            let target = ["x", "y", "z"][self.rng.usize(0..3)];
            let at = near(&mut self.rng);
            let value = self.result(&elements);
            let _ = match self.rng.u32(0..12) {
                0 => writeln!(self.out, "  IF flag THEN {target}[{at}] := {value}; END_IF;"),
                1 if !self.bits() => writeln!(self.out, "  IF x[i] > y[i] THEN {target}[{at}] := {value}; END_IF;"),
                2 => writeln!(self.out, "  s := {value};"),
                _ => writeln!(self.out, "  {target}[{at}] := {value};"),
            };
        }
        self.out.push_str("END_FOR;\n");
    }

    fn product(&mut self) {
        let (rows, row) = (self.rows - 1, self.row - 1);
        let (times, plus) = if self.bits() { ("AND", "XOR") } else { ("*", "+") };
        let inner = ["m[i, k]", "n[i, k]", "q[k, k]", "p[i, k]"][self.rng.usize(0..4)];
        let term = if self.rng.u32(0..6) == 0 { "q[j, k]" } else { "q[k, j]" };
        let mut start = self.constant();
        if self.rng.u32(0..3) == 0 {
            start = "p[i, j]".into();
        }
        let more = if self.rng.u32(0..4) == 0 { "n[i, j] := s;\n" } else { "" };
        let scale = if self.tame && self.real() { " * 0.01" } else { "" };
        let _ = write!(
            self.out,
            "FOR i := 0 TO {rows} DO\n  FOR j := 0 TO {row} DO\n    s := {start};\n    FOR k := 0 TO {row} DO\n      \
             s := s {plus} {inner} {times} {term}{scale};\n    END_FOR;\n    p[i, j] := s;\n    {more}  END_FOR;\nEND_FOR;\n"
        );
    }

    /// A filter over several channels: the taps of each are far from each other.
    fn channels(&mut self) {
        let (rows, row) = (self.rows - 1, self.row - 1);
        let (times, plus) = if self.bits() { ("AND", "XOR") } else { ("*", "+") };
        let scale = if self.tame && self.real() { " * 0.01" } else { "" };
        let back = if self.rng.bool() { "    m[i, j] := s;\n" } else { "" };
        let _ = write!(
            self.out,
            "FOR j := 0 TO {row} DO\n  s := x[j MOD 8];\n  FOR i := 0 TO {rows} DO\n    s := s {plus} m[i, j] {times} y[i]{scale};\n{back}  \
             END_FOR;\n  p[0, j] := s;\nEND_FOR;\n"
        );
    }

    fn grid(&mut self) {
        let (rows, row) = (self.rows - 1, self.row - 2);
        let near = ["m[i - 1, j]", "m[i, j + 1]", "m[i, j - 1]", "m[i - 1, j + 1]", "n[i, j]", "q[j, j]", "q[i, j]"];
        let mut elements = vec!["m[i, j]".to_string(), "n[i, j]".to_string()];
        for _ in 0..2 {
            elements.push(near[self.rng.usize(0..near.len())].into());
        }
        let rows = rows.min(self.row - 1);
        let value = self.result(&elements);
        let target = ["m[i, j]", "m[i, j]", "p[i, j]", "m[i - 1, j]"][self.rng.usize(0..4)];
        let _ = write!(
            self.out,
            "FOR i := 1 TO {rows} DO\n  FOR j := 1 TO {row} DO\n    {target} := {value};\n  END_FOR;\nEND_FOR;\n"
        );
    }
}
