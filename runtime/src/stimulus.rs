//! Stimulus CSV: values that are written just before a cycle executes (docs/cli.md, "Stimulus CSV").

use crate::path::{Resolver, write};
use std::io::Read;
use std::path::Path;

/// One value to write.
#[derive(Debug, Clone)]
struct Write {
    offset: u32,
    bit: Option<u8>,
    bytes: Vec<u8>,
}

/// All rows, in order of their cycles.
#[derive(Debug, Clone, Default)]
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
        // As sources: UTF-8 or, if it is not, Latin-1 (semantics.md \[L1\]).
        let text = String::from_utf8(text).unwrap_or_else(|e| e.into_bytes().into_iter().map(char::from).collect());
        Self::parse(shown, text.trim_start_matches('\u{feff}'), resolver).map_err(|message| (2, message))
    }

    fn parse(name: &str, text: &str, resolver: &Resolver) -> Result<Self, String> {
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
        let mut records = reader.records();
        let place = |record: &csv::StringRecord, field: usize| {
            let (line, column) = place(text, record.position().map_or(0, |p| p.byte() as usize), field);
            format!("{name}:{line}:{column}")
        };
        let Some(header) = records.next() else { return Err(format!("{name}:1:1: the header is missing")) };
        let header = header.map_err(|e| format!("{name}: {e}"))?;
        let first = header.get(0).unwrap_or_default().trim();
        if !first.eq_ignore_ascii_case("cycle") {
            return Err(format!("{}: the first column must be `cycle`, not `{first}`", place(&header, 0)));
        }
        let mut leaves = Vec::new();
        let mut named = std::collections::HashSet::new();
        for n in 1..header.len() {
            let path = header.get(n).unwrap_or_default();
            let leaf = resolver.leaf(path).map_err(|e| format!("{}: {e}", place(&header, n)))?;
            if leaf.constant {
                return Err(format!("{}: `{}` is a CONSTANT", place(&header, n), path.trim()));
            }
            if !named.insert((leaf.offset, leaf.bit)) {
                return Err(format!("{}: `{}` stands in two columns", place(&header, n), path.trim()));
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
                _ => return Err(format!("{}: `{cycle_text}` is no cycle; they count from 1", place(&record, 0))),
            };
            if let Some((before, _)) = rows.last()
                && *before >= cycle
            {
                return Err(format!(
                    "{}: cycle {cycle} comes after cycle {before}; rows are in rising order",
                    place(&record, 0)
                ));
            }
            if record.len() > leaves.len() + 1 {
                let place = place(&record, leaves.len() + 1);
                return Err(format!("{place}: {} fields, the header has {}", record.len(), leaves.len() + 1));
            }
            let mut writes = Vec::new();
            for (n, leaf) in leaves.iter().enumerate() {
                let text = record.get(n + 1).unwrap_or_default();
                if text.trim().is_empty() {
                    continue;
                }
                let bytes = resolver.bytes(leaf, text).map_err(|e| {
                    format!("{}: {}: {e}", place(&record, n + 1), header.get(n + 1).unwrap_or_default().trim())
                })?;
                writes.push(Write { offset: leaf.offset, bit: leaf.bit, bytes });
            }
            rows.push((cycle, writes));
        }
        Ok(Self { rows, next: 0 })
    }

    /// Makes all offsets count from the start of an area; the error is the number of the first byte outside.
    pub fn move_into(&mut self, start: u32, bytes: u32) -> Result<(), String> {
        for value in self.rows.iter_mut().flat_map(|(_, row)| row) {
            let inside = value.offset.checked_sub(start).filter(|at| at + value.bytes.len() as u32 <= bytes);
            value.offset = inside.ok_or_else(|| format!("a variable at byte {}", value.offset))?;
        }
        Ok(())
    }

    /// Back to the first row.
    pub fn rewind(&mut self) {
        self.next = 0;
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

/// Line and column, from 1, where a field of the record that starts at or after a byte begins; quoted fields (RFC 4180) may
/// hold commas and line ends.
fn place(text: &str, start: usize, field: usize) -> (usize, usize) {
    let rest = &text[start.min(text.len())..];
    let start = text.len() - rest.trim_start_matches(['\r', '\n']).len();
    let mut at = start;
    let (mut fields, mut quoted) = (0, false);
    for (n, c) in text[start..].char_indices() {
        if fields == field {
            break;
        }
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields += 1,
            _ => {}
        }
        at = start + n + c.len_utf8();
    }
    let line_start = text[..at].rfind('\n').map_or(0, |n| n + 1);
    (1 + text[..at].matches('\n').count(), 1 + text[line_start..at].chars().count())
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
            ..Root::default()
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
        let mut s = Stimulus::parse("s.csv", "cycle,M.a,M.b\n2,5,\n4,,16#10\n", &resolver).unwrap();
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
        let error = |text: &str| Stimulus::parse("s.csv", text, &resolver).unwrap_err();
        assert!(error("cycle,M.x\n").starts_with("s.csv:1:7: there is no variable `M.x`"));
        assert!(error("time,M.a\n").starts_with("s.csv:1:1:"));
        assert!(error("cycle,M.a\n1,TRUE\n").starts_with("s.csv:2:3:"));
        assert!(error("cycle,M.a\n1,1\n1,2\n").starts_with("s.csv:3:1: cycle 1 comes after cycle 1"));
        assert!(error("cycle,M.a\n0,1\n").starts_with("s.csv:2:1:"));
        assert!(error("cycle,M.a\n1,1,2\n").starts_with("s.csv:2:5:"));
        assert!(error("cycle,M.a,m.A\n").starts_with("s.csv:1:11: `m.A` stands in two columns"));
        assert!(error("cycle,M.c\n").contains("CONSTANT"));
        // Quotes, blank lines and line ends inside quotes count as they stand in the file.
        assert!(error("cycle,M.a,M.b\n1,\"5\",x\n").starts_with("s.csv:2:7:"));
        assert!(error("cycle,M.a\r\n\r\n1,1\r\n\r\n2,x\r\n").starts_with("s.csv:5:3:"));
        assert!(error("cycle,M.a,M.b\n1,\"\n5\",x\n").starts_with("s.csv:3:4:"));
        assert!(error("").starts_with("s.csv:1:1:"));
    }
}
