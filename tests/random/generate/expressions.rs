//! Expressions: literals, variables, operators, functions, of the type that is asked for.

use super::*;

impl Generator {
    pub(super) fn literal(&mut self, ty: Ty) -> String {
        match ty {
            Ty::Bool => if self.rng.bool() { "TRUE" } else { "FALSE" }.into(),
            Ty::Int { bits, signed } => {
                let max = if signed { (1i128 << (bits - 1)) - 1 } else { (1i128 << bits) - 1 };
                let min = if signed { -(1i128 << (bits - 1)) } else { 0 };
                let value = match self.rng.u32(0..8) {
                    0 => max,
                    1 => min,
                    2 => max - 1,
                    3 if signed => -1,
                    _ => i128::from(self.rng.i64(0..100)),
                };
                format!("{}#{value}", ty.name())
            }
            Ty::Bits(bits) => {
                let mask = if bits == 64 { u64::MAX } else { (1 << bits) - 1 };
                format!("{}#16#{:X}", ty.name(), self.rng.u64(..) & mask)
            }
            Ty::Real | Ty::Lreal => {
                let value = match self.rng.u32(0..8) {
                    0 => "1.0e30".to_string(),
                    1 => "1.0e-30".to_string(),
                    2 => "0.0".to_string(),
                    3 => format!("-{}.5", self.rng.u32(0..1000)),
                    _ => format!("{}.{}", self.rng.u32(0..100), self.rng.u32(0..100)),
                };
                format!("{}#{value}", ty.name())
            }
            Ty::Time => format!("T#{}ms", self.rng.u32(0..200)),
            Ty::Enum => ["Red", "Color#Green", "Blue"][self.rng.usize(0..3)].into(),
            Ty::Small => self.rng.i64(-5..=20).to_string(),
            Ty::Char => format!("CHAR#'{}'", self.characters(1, false)),
            Ty::Text { wide, capacity } => {
                let longest = capacity.unwrap_or(SHORTEST).min(12);
                let length = self.rng.u32(0..=longest);
                let quote = if wide { '"' } else { '\'' };
                format!("{quote}{}{quote}", self.characters(length, wide))
            }
        }
    }

    /// Characters of a literal: few different ones, and beginnings of numbers.
    pub(super) fn characters(&mut self, count: u32, wide: bool) -> String {
        let narrow = ["a", "b", "ab", "1", "7", "-", ".", " ", "e", "x", "$$", "$L", "T#5s"];
        let all: Vec<&str> = narrow.into_iter().chain(if wide { ["€", "$00E4"] } else { ["ä", "$FF"] }).collect();
        let mut text = String::new();
        let mut left = count as usize;
        while left > 0 {
            let next = all[self.rng.usize(0..all.len())];
            let length = if next.starts_with('$') { 1 } else { next.chars().count() };
            if length <= left {
                text.push_str(next);
                left -= length;
            }
        }
        text
    }

    /// A variable of exactly this type.
    pub(super) fn variable(&mut self, ty: Ty) -> Option<String> {
        let list: Vec<String> = self.vars.iter().filter(|v| v.ty.fits(ty)).map(|v| v.text.clone()).collect();
        let array: Vec<_> = self.arrays.iter().filter(|a| a.3.fits(ty)).cloned().collect();
        if !array.is_empty() && self.chance(30) {
            let (name, low, high, _) = array[self.rng.usize(0..array.len())].clone();
            let index = self.index(low, high);
            return Some(format!("{name}[{index}]"));
        }
        if list.is_empty() { None } else { Some(list[self.rng.usize(0..list.len())].clone()) }
    }

    pub(super) fn leaf(&mut self, ty: Ty) -> String {
        let plain = if ty == Ty::Small { Ty::Int { bits: 16, signed: true } } else { ty };
        if self.chance(75)
            && let Some(text) = self.variable(plain)
        {
            return if ty == Ty::Small { format!("LIMIT(-5, {text}, 20)") } else { text };
        }
        self.literal(ty)
    }

    /// An expression of a type.
    pub fn expr(&mut self, ty: Ty, depth: u32) -> String {
        if depth == 0 || self.chance(15) {
            return self.leaf(ty);
        }
        if self.chance(12)
            && let Some(text) = self.call_function(ty, depth)
        {
            return text;
        }
        if self.chance(4)
            && let Some(text) = self.enabled(ty, depth)
        {
            return text;
        }
        let d = depth - 1;
        match ty {
            Ty::Bool => self.bool_expr(d),
            Ty::Int { .. } => self.int_expr(ty, d),
            Ty::Bits(bits) => self.bits_expr(ty, bits, d),
            Ty::Real | Ty::Lreal => self.real_expr(ty, d),
            Ty::Time => match self.rng.u32(0..8) {
                6 | 7 => {
                    let real = if self.rng.bool() { Ty::Real } else { Ty::Lreal };
                    let op = if self.rng.bool() { "*" } else { "/" };
                    format!("({} {op} {})", self.expr(ty, d), self.expr(real, d))
                }
                0 => format!("({} + {})", self.expr(ty, d), self.expr(ty, d)),
                1 => format!("({} - {})", self.expr(ty, d), self.expr(ty, d)),
                2 => format!("({} * {})", self.expr(ty, d), self.expr(Ty::Int { bits: 16, signed: true }, d)),
                3 => format!("({} / INT#3)", self.expr(ty, d)),
                4 => format!("SEL({}, {}, {})", self.expr(Ty::Bool, d), self.expr(ty, d), self.expr(ty, d)),
                _ => format!("DINT_TO_TIME({})", self.expr(Ty::Int { bits: 32, signed: true }, d)),
            },
            Ty::Char => self.char_expr(d),
            Ty::Text { wide, .. } => self.text_expr(ty, wide, d),
            Ty::Enum => match self.rng.u32(0..3) {
                0 => format!("SEL({}, {}, {})", self.expr(Ty::Bool, d), self.leaf(ty), self.leaf(ty)),
                _ => self.leaf(ty),
            },
            Ty::Small => {
                let value = self.expr(Ty::Int { bits: 16, signed: true }, d);
                if self.faults && self.chance(20) {
                    format!("i{}", self.rng.u32(0..3))
                } else {
                    format!("LIMIT(-5, {value}, 20)")
                }
            }
        }
    }

    /// A standard function with EN and ENO; what it does may fail, and is caught.
    pub(super) fn enabled(&mut self, ty: Ty, depth: u32) -> Option<String> {
        let d = depth - 1;
        let eno = self.vars.iter().find(|v| v.write && v.ty == Ty::Bool)?.text.clone();
        let body = match ty {
            Ty::Int { .. } => {
                let name = ["DIV", "MOD", "ADD", "MAX"][self.rng.usize(0..4)];
                format!("{name}(IN2 := {}, IN1 := {}", self.variable(ty)?, self.expr(ty, d))
            }
            Ty::Bits(_) => {
                let name = ["SHL", "ROR"][self.rng.usize(0..2)];
                let count = self.variable(Ty::Int { bits: 16, signed: true })?;
                format!("{name}(N := {count}, IN := {}", self.expr(ty, d))
            }
            Ty::Real | Ty::Lreal => format!("SQRT(IN := {}", self.expr(ty, d)),
            _ => format!("SEL(IN1 := {}, G := {}, IN0 := {}", self.leaf(ty), self.expr(Ty::Bool, d), self.leaf(ty)),
        };
        let en = if self.rng.bool() { format!(", EN := {}", self.expr(Ty::Bool, d)) } else { String::new() };
        Some(format!("{body}{en}, ENO => {eno})"))
    }

    pub(super) fn bool_expr(&mut self, d: u32) -> String {
        match self.rng.u32(0..10) {
            0 => format!("(NOT {})", self.expr(Ty::Bool, d)),
            1..=3 => {
                let op = ["AND", "OR", "XOR", "AND_THEN", "OR_ELSE", "&"][self.rng.usize(0..6)];
                format!("({} {op} {})", self.expr(Ty::Bool, d), self.expr(Ty::Bool, d))
            }
            4..=7 => {
                let ty = loop {
                    let ty = self.pick_type();
                    if matches!(ty, Ty::Int { .. } | Ty::Real | Ty::Lreal | Ty::Time | Ty::Char | Ty::Text { .. }) {
                        break ty;
                    }
                };
                let op = ["<", ">", "<=", ">=", "=", "<>"][self.rng.usize(0..6)];
                format!("({} {op} {})", self.expr(ty, d), self.expr(ty, d))
            }
            8 => {
                let bits = [8, 16, 32][self.rng.usize(0..3)];
                match self.variable(Ty::Bits(bits)) {
                    Some(text) => format!("{text}.{}", self.rng.u32(0..bits)),
                    None => self.leaf(Ty::Bool),
                }
            }
            _ => {
                let op = ["=", "<>"][self.rng.usize(0..2)];
                format!("({} {op} {})", self.expr(Ty::Enum, d), self.expr(Ty::Enum, d))
            }
        }
    }

    pub(super) fn int_expr(&mut self, ty: Ty, d: u32) -> String {
        let name = ty.name();
        if ty == (Ty::Int { bits: 16, signed: true }) && self.chance(20) {
            let text = self.any_text();
            return if self.rng.bool() {
                format!("LEN({})", self.expr(text, d))
            } else {
                format!("FIND({}, {})", self.expr(text, d), self.expr(text, d))
            };
        }
        match self.rng.u32(0..17) {
            16 => {
                let bits = Ty::Bits([8, 16, 32][self.rng.usize(0..3)]);
                format!("{}_BCD_TO_{name}({})", bits.name(), self.expr(bits, d))
            }
            0..=4 => {
                let op = ["+", "-", "*"][self.rng.usize(0..3)];
                format!("({} {op} {})", self.expr(ty, d), self.expr(ty, d))
            }
            5 | 6 => {
                let op = ["/", "MOD"][self.rng.usize(0..2)];
                let variable = if self.faults && self.chance(10) { self.variable(ty) } else { None };
                let divisor = if let Some(text) = variable { text } else { format!("{name}#{}", self.rng.u32(1..9)) };
                format!("({} {op} {divisor})", self.expr(ty, d))
            }
            7 => match ty {
                Ty::Int { signed: true, .. } => format!("(-{})", self.expr(ty, d)),
                _ => self.leaf(ty),
            },
            8 => format!("ABS({})", self.expr(ty, d)),
            9 => format!("MIN({}, {})", self.expr(ty, d), self.expr(ty, d)),
            10 => format!("MAX({}, {}, {})", self.expr(ty, d), self.expr(ty, d), self.leaf(ty)),
            11 => format!("SEL({}, {}, {})", self.expr(Ty::Bool, d), self.expr(ty, d), self.expr(ty, d)),
            12 => {
                let k = self.expr(Ty::Int { bits: 16, signed: true }, 1);
                format!("MUX({k}, {}, {}, {})", self.expr(ty, d), self.leaf(ty), self.leaf(ty))
            }
            _ => {
                let from = loop {
                    let from = self.pick_type();
                    if from != ty && !matches!(from, Ty::Enum) {
                        break from;
                    }
                };
                format!("{}_TO_{name}({})", from.keyword(), self.expr(from, d))
            }
        }
    }

    pub(super) fn any_text(&mut self) -> Ty {
        match self.rng.u32(0..4) {
            0 => Ty::Text { wide: true, capacity: Some(8) },
            _ => Ty::Text { wide: false, capacity: Some(20) },
        }
    }

    pub(super) fn char_expr(&mut self, d: u32) -> String {
        match self.rng.u32(0..6) {
            0 | 1 => {
                let text = Ty::Text { wide: false, capacity: None };
                match self.variable(text) {
                    Some(text) => format!("{text}[{}]", self.index(1, i64::from(SHORTEST))),
                    None => self.leaf(Ty::Char),
                }
            }
            2 => format!("BYTE_TO_CHAR({})", self.expr(Ty::Bits(8), d)),
            3 => format!("STRING_TO_CHAR({})", self.expr(Ty::Text { wide: false, capacity: Some(20) }, d)),
            4 => format!("SEL({}, {}, {})", self.expr(Ty::Bool, d), self.expr(Ty::Char, d), self.leaf(Ty::Char)),
            _ => self.leaf(Ty::Char),
        }
    }

    /// A length or position, mostly near those that matter.
    pub(super) fn position(&mut self, d: u32) -> String {
        match self.rng.u32(0..4) {
            0 => self.expr(Ty::Int { bits: 16, signed: true }, d.min(2)),
            1 => self.expr(Ty::Int { bits: 64, signed: true }, d.min(1)),
            _ => self.rng.i64(-1..9).to_string(),
        }
    }

    pub(super) fn text_expr(&mut self, ty: Ty, wide: bool, d: u32) -> String {
        let keyword = ty.keyword();
        match self.rng.u32(0..16) {
            0..=3 => {
                let mut parts = vec![self.expr(ty, d), self.expr(ty, d)];
                if self.chance(30) {
                    parts.push(self.expr(ty, d));
                }
                if !wide && self.chance(20) {
                    parts.push(self.expr(Ty::Char, d));
                }
                format!("CONCAT({})", parts.join(", "))
            }
            4 => format!("LEFT({}, {})", self.expr(ty, d), self.position(d)),
            5 => format!("RIGHT({}, {})", self.expr(ty, d), self.position(d)),
            6 => format!("MID({}, {}, {})", self.expr(ty, d), self.position(d), self.position(d)),
            7 => format!("INSERT({}, {}, {})", self.expr(ty, d), self.expr(ty, d), self.position(d)),
            8 => format!("DELETE({}, {}, {})", self.expr(ty, d), self.position(d), self.position(d)),
            9 => {
                let (a, b) = (self.expr(ty, d), self.expr(ty, d));
                format!("REPLACE({a}, {b}, {}, {})", self.position(d), self.position(d))
            }
            10 => format!("SEL({}, {}, {})", self.expr(Ty::Bool, d), self.expr(ty, d), self.expr(ty, d)),
            11 => match self.rng.u32(0..3) {
                0 => format!("MAX({}, {}, {})", self.expr(ty, d), self.expr(ty, d), self.leaf(ty)),
                1 => format!("MIN({}, {})", self.expr(ty, d), self.expr(ty, d)),
                _ => format!("LIMIT({}, {}, {})", self.leaf(ty), self.expr(ty, d), self.leaf(ty)),
            },
            12 => {
                let k = self.expr(Ty::Int { bits: 16, signed: true }, 1);
                format!("MUX({k}, {}, {}, {})", self.expr(ty, d), self.leaf(ty), self.leaf(ty))
            }
            13 => {
                let other = Ty::Text { wide: !wide, capacity: Some(8) };
                format!("{}_TO_{keyword}({})", other.keyword(), self.expr(other, d))
            }
            _ => {
                let from = loop {
                    let from = self.pick_type();
                    if !matches!(from, Ty::Enum | Ty::Text { .. }) {
                        break from;
                    }
                };
                let name = if self.rng.bool() { "TO".to_string() } else { format!("{}_TO", from.name()) };
                format!("{name}_{keyword}({})", self.expr(from, d))
            }
        }
    }

    pub(super) fn bits_expr(&mut self, ty: Ty, bits: u32, d: u32) -> String {
        match self.rng.u32(0..10) {
            8 => format!("TO_BIG_ENDIAN({})", self.expr(ty, d)),
            9 => {
                let from = Ty::Int { bits: [8, 16, 32, 64][self.rng.usize(0..4)], signed: self.rng.bool() };
                format!("{}_TO_BCD_{}({})", from.name(), ty.name(), self.expr(from, d))
            }
            0..=2 => {
                let op = ["AND", "OR", "XOR"][self.rng.usize(0..3)];
                format!("({} {op} {})", self.expr(ty, d), self.expr(ty, d))
            }
            3 => format!("(NOT {})", self.expr(ty, d)),
            4 | 5 => {
                let op = ["SHL", "SHR", "ROL", "ROR"][self.rng.usize(0..4)];
                let count = if self.faults && self.chance(10) {
                    format!("i{}", self.rng.u32(0..3))
                } else {
                    self.rng.u32(0..bits + 3).to_string()
                };
                format!("{op}({}, {count})", self.expr(ty, d))
            }
            _ => {
                let from = Ty::Int { bits: [8, 16, 32][self.rng.usize(0..3)], signed: self.rng.bool() };
                format!("{}_TO_{}({})", from.name(), ty.name(), self.expr(from, d))
            }
        }
    }

    pub(super) fn real_expr(&mut self, ty: Ty, d: u32) -> String {
        match self.rng.u32(0..10) {
            0..=4 => {
                let op = ["+", "-", "*", "/"][self.rng.usize(0..4)];
                format!("({} {op} {})", self.expr(ty, d), self.expr(ty, d))
            }
            5 => format!("(-{})", self.expr(ty, d)),
            6 => {
                let f = ["ABS", "SQRT", "SIN", "COS", "EXP", "LN", "ATAN"][self.rng.usize(0..7)];
                format!("{f}({})", self.expr(ty, d))
            }
            7 => format!("LIMIT({}, {}, {})", self.literal(ty), self.expr(ty, d), self.literal(ty)),
            8 if self.chance(50) => {
                let text = self.any_text();
                format!("{}_TO_{}({})", text.keyword(), ty.name(), self.expr(text, d))
            }
            _ => {
                let from = Ty::Int { bits: [8, 16, 32, 64][self.rng.usize(0..4)], signed: self.rng.bool() };
                format!("{}_TO_{}({})", from.name(), ty.name(), self.expr(from, d))
            }
        }
    }

    pub(super) fn call_function(&mut self, ty: Ty, depth: u32) -> Option<String> {
        let fitting: Vec<Function> = self.functions.iter().filter(|f| f.result.fits(ty)).cloned().collect();
        if fitting.is_empty() {
            return None;
        }
        let f = fitting[self.rng.usize(0..fitting.len())].clone();
        let mut args: Vec<String> =
            f.params.iter().enumerate().map(|(n, ty)| format!("p{n} := {}", self.expr(*ty, depth - 1))).collect();
        if self.chance(20) {
            args.pop();
        }
        if f.in_out {
            let dint = Ty::Int { bits: 32, signed: true };
            let var = self.vars.iter().find(|v| v.write && v.ty == dint)?.text.clone();
            args.push(format!("io := {var}"));
        }
        if f.text_in_out {
            let text = Ty::Text { wide: false, capacity: None };
            let all: Vec<String> =
                self.vars.iter().filter(|v| v.write && v.ty.fits(text)).map(|v| v.text.clone()).collect();
            if all.is_empty() {
                return None;
            }
            args.push(format!("text := {}", all[self.rng.usize(0..all.len())]));
        }
        if f.open {
            let all: Vec<String> = self.arrays.iter().filter(|a| a.3 == DINT).map(|a| a.0.clone()).collect();
            if all.is_empty() {
                return None;
            }
            args.push(format!("open := {}", all[self.rng.usize(0..all.len())]));
        }
        if f.output {
            let int = Ty::Int { bits: 16, signed: true };
            if let Some(var) = self.vars.iter().find(|v| v.write && v.ty == int) {
                args.push(format!("o => {}", var.text));
            }
        }
        Some(format!("{}({})", f.name, args.join(", ")))
    }
}
