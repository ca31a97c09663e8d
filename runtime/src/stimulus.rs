//! Stimulus CSV: values that are written just before a cycle executes (docs/cli.md, "Stimulus CSV").

use crate::path::{Resolver, write};
use std::io::Read;
use std::path::Path;

/// One value to write.
#[derive(Debug)]
struct Write {
    offset: u32,
    bit: Option<u8>,
    bytes: Vec<u8>,
}

/// All rows, in order of their cycles.
#[derive(Debug, Default)]
pub struct Stimulus {
    rows: Vec<(u64, Vec<Write>)>,
    next: usize,
}

/// Why a stimulus cannot be used: an exit code and what to say.
pub type Problem = (u8, String);

impl Stimulus {
    /// Reads a file (`-` is standard input).
    pub fn read(path: &Path, resolver: &Resolver) -> Result<Self, Problem> {
        let name = path.display().to_string();
        let io = |e: std::io::Error| (3, format!("cannot read stimulus `{name}`: {e}"));
        let mut text = Vec::new();
        if path == Path::new("-") {
            std::io::stdin().lock().read_to_end(&mut text).map_err(io)?;
        } else {
            std::fs::File::open(path).map_err(io)?.read_to_end(&mut text).map_err(io)?;
        }
        let shown = if name == "-" { "<stdin>" } else { &name };
        Self::parse(shown, &text, resolver).map_err(|message| (2, message))
    }

    fn parse(name: &str, text: &[u8], resolver: &Resolver) -> Result<Self, String> {
        // As for sources: UTF-8 and, if that fails, ISO-8859-1 (semantics.md [L1]).
        let text = match std::str::from_utf8(text) {
            Ok(text) => text.to_string(),
            Err(_) => text.iter().map(|b| *b as char).collect(),
        };
        let text = text.trim_start_matches('\u{feff}');
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
        let mut records = reader.records();
        let at = |record: &csv::StringRecord, field: usize| {
            let (line, column) = place(text, record, field);
            format!("{name}:{line}:{column}")
        };
        let Some(header) = records.next() else {
            return Err(format!("{}: the header is missing", format_args!("{name}:1:1")));
        };
        let header = header.map_err(|e| format!("{name}: {e}"))?;
        let first = header.get(0).unwrap_or_default().trim();
        if !first.eq_ignore_ascii_case("cycle") {
            return Err(format!("{}: the first column must be `cycle`, not `{first}`", at(&header, 0)));
        }
        let mut leaves = Vec::new();
        for n in 1..header.len() {
            let path = header.get(n).unwrap_or_default();
            let leaf = resolver.leaf(path).map_err(|e| format!("{}: {e}", at(&header, n)))?;
            if leaf.constant {
                return Err(format!("{}: `{}` is a CONSTANT", at(&header, n), path.trim()));
            }
            if leaves.contains(&leaf) {
                let place = at(&header, n);
                return Err(format!("{place}: `{}` stands in two columns", path.trim()));
            }
            leaves.push(leaf);
        }
        let mut rows: Vec<(u64, Vec<Write>)> = Vec::new();
        for record in records {
            let record = record.map_err(|e| format!("{name}: {e}"))?;
            let cycle_text = record.get(0).unwrap_or_default().trim();
            if cycle_text.is_empty() && record.len() <= 1 {
                continue;
            }
            let cycle: u64 = match cycle_text.parse() {
                Ok(cycle) if cycle > 0 => cycle,
                _ => return Err(format!("{}: `{cycle_text}` is no cycle; they count from 1", at(&record, 0))),
            };
            if let Some((before, _)) = rows.last()
                && *before >= cycle
            {
                return Err(format!(
                    "{}: cycle {cycle} comes after cycle {before}; rows are in rising order",
                    at(&record, 0)
                ));
            }
            if record.len() > leaves.len() + 1 {
                let place = at(&record, leaves.len() + 1);
                return Err(format!("{place}: {} fields, the header has {}", record.len(), leaves.len() + 1));
            }
            let mut writes = Vec::new();
            for (n, leaf) in leaves.iter().enumerate() {
                let cell = record.get(n + 1).unwrap_or_default();
                if cell.trim().is_empty() {
                    continue;
                }
                let bytes = resolver.bytes(leaf, cell).map_err(|e| {
                    format!("{}: {}: {e}", at(&record, n + 1), header.get(n + 1).unwrap_or_default().trim())
                })?;
                writes.push(Write { offset: leaf.offset, bit: leaf.bit, bytes });
            }
            rows.push((cycle, writes));
        }
        Ok(Self { rows, next: 0 })
    }

    /// Writes the values of a cycle.
    pub fn apply(&mut self, cycle: u64, mem: &mut [u8]) {
        while let Some((at, writes)) = self.rows.get(self.next) {
            if *at > cycle {
                break;
            }
            for value in writes {
                write(mem, value.offset, value.bit, &value.bytes);
            }
            self.next += 1;
        }
    }
}

/// Line and column, from 1 and in characters, where a field of a record starts.
fn place(text: &str, record: &csv::StringRecord, field: usize) -> (usize, usize) {
    let start = record.position().map_or(0, |p| p.byte() as usize);
    let rest = text.get(start..).unwrap_or_default();
    // The reader counts blank lines to the record behind them.
    let own = rest.trim_start_matches(['\r', '\n']);
    let before = &text[..text.len() - own.len()];
    let (mut line, mut column) = (1 + before.matches('\n').count(), 1);
    let (mut fields, mut quoted) = (0, false);
    for c in own.chars() {
        if fields == field {
            break;
        }
        column += 1;
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields += 1,
            '\n' => (line, column) = (line + 1, 1),
            _ => {}
        }
    }
    (line, column)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Image, Root, TypeDesc};
    use plcc_stdlib::elem::Elem;

    fn image() -> Image {
        let root = |name: &str, offset, constant| Root {
            name: name.into(),
            offset,
            bit: None,
            ty: 0,
            constant,
            retain: false,
        };
        Image {
            types: vec![TypeDesc::Elem(Elem::Int.code())],
            roots: vec![root("M.a", 64, false), root("M.b", 66, false), root("M.c", 68, true)],
            ..Image::default()
        }
    }

    #[test]
    fn values_stay_until_overwritten() {
        let image = image();
        let resolver = Resolver::new(&image);
        let mut s = Stimulus::parse("s.csv", b"cycle,M.a,M.b\n2,5,\n4,,16#10\n", &resolver).unwrap();
        let mut mem = vec![0; 80];
        let mut seen = Vec::new();
        for cycle in 1..=4 {
            s.apply(cycle, &mut mem);
            seen.push((mem[64], mem[66]));
        }
        assert_eq!(seen, [(0, 0), (5, 0), (5, 0), (5, 16)]);
    }

    #[test]
    fn mistakes_have_a_place() {
        let image = image();
        let resolver = Resolver::new(&image);
        let error = |text: &str| Stimulus::parse("s.csv", text.as_bytes(), &resolver).unwrap_err();
        assert!(error("cycle,M.x\n").starts_with("s.csv:1:7: there is no variable `M.x`"));
        assert!(error("time,M.a\n").starts_with("s.csv:1:1:"));
        assert!(error("cycle,M.a\n1,TRUE\n").starts_with("s.csv:2:3:"));
        assert!(error("cycle,M.a\n1,1\n1,2\n").starts_with("s.csv:3:1: cycle 1 comes after cycle 1"));
        assert!(error("cycle,M.a\n0,1\n").starts_with("s.csv:2:1:"));
        assert!(error("cycle,M.a\n1,1,2\n").starts_with("s.csv:2:5:"));
        assert!(error("\u{feff}cycle,\"M.a\",M.x\r\n").starts_with("s.csv:1:13:"));
        assert!(error("cycle,M.a,M.b\r\n\r\n1,\"5\",x\r\n").starts_with("s.csv:3:7:"));
        assert!(error("cycle,M.a,M.a\n").starts_with("s.csv:1:11: `M.a` stands in two columns"));
        assert!(error("cycle,M.c\n").contains("CONSTANT"));
    }
}
