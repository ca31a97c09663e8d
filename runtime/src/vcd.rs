//! VCD waveforms (`--vcd`; IEEE 1364 chapter 18): the variables of the trace, each value when it changes, time in ns.
//!
//! BOOL is a wire of one bit, integers, bit strings and enumerations are vectors of their width, reals are reals; times and
//! dates are integers in nanoseconds; strings are the string variables that waveform viewers know.

use crate::image::{Image, TypeDesc};
use crate::path::{Leaf, Resolver, raw};
use plcc_stdlib::elem::Elem;
use std::fmt::Write as _;
use std::io::{BufWriter, Write};
use std::path::Path;

/// A waveform file.
pub struct Vcd {
    signals: Vec<Signal>,
    out: BufWriter<Box<dyn Write + Send>>,
    line: String,
    cell: String,
    /// Time of the last stamp.
    last_ns: i64,
    started: bool,
}

#[derive(Debug)]
struct Signal {
    leaf: Leaf,
    id: String,
    /// `None` is a string.
    elem: Option<Elem>,
    last: u64,
    last_text: String,
}

impl std::fmt::Debug for Vcd {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Vcd").field("signals", &self.signals.len()).finish_non_exhaustive()
    }
}

impl Vcd {
    /// Opens the file and writes its declarations.
    pub fn open(path: &Path, image: &Image, columns: Vec<(String, Leaf)>) -> Result<Self, String> {
        let out = crate::trace::create(path, "waveform")?;
        Self::start(out, image, columns).map_err(|e| crate::trace::failure(&e, "waveform"))
    }

    fn start(out: Box<dyn Write + Send>, image: &Image, columns: Vec<(String, Leaf)>) -> std::io::Result<Self> {
        let mut out = BufWriter::with_capacity(1 << 16, out);
        writeln!(out, "$timescale 1 ns $end")?;
        let mut scopes: Vec<String> = Vec::new();
        let mut signals = Vec::with_capacity(columns.len());
        for (n, (name, leaf)) in columns.into_iter().enumerate() {
            let elem = match image.types.get(leaf.ty as usize) {
                Some(
                    TypeDesc::Elem(code) | TypeDesc::Enum { elem: code, .. } | TypeDesc::Subrange { elem: code, .. },
                ) => Elem::from_code(*code),
                Some(TypeDesc::String { .. }) => None,
                _ => Some(Elem::Dword),
            };
            // Instances are scopes. An index in brackets would be read as a bit of a vector.
            let mut path: Vec<String> =
                name.split('.').map(|p| p.replace('[', "(").replace(']', ")").replace(' ', "")).collect();
            let own = path.pop().unwrap_or_default();
            let common = scopes.iter().zip(&path).take_while(|(a, b)| a == b).count();
            for _ in common..scopes.len() {
                writeln!(out, "$upscope $end")?;
            }
            for scope in &path[common..] {
                writeln!(out, "$scope module {scope} $end")?;
            }
            scopes = path;
            let id = identifier(n);
            match elem {
                None => writeln!(out, "$var string 1 {id} {own} $end")?,
                Some(e) if e.is_real() => writeln!(out, "$var real 64 {id} {own} $end")?,
                Some(e) => writeln!(out, "$var wire {} {id} {own} $end", e.bits())?,
            }
            signals.push(Signal { leaf, id, elem, last: 0, last_text: String::new() });
        }
        for _ in &scopes {
            writeln!(out, "$upscope $end")?;
        }
        writeln!(out, "$enddefinitions $end")?;
        Ok(Self { signals, out, line: String::new(), cell: String::new(), last_ns: 0, started: false })
    }

    /// The values after a cycle at a time of the scan clock.
    pub fn row(&mut self, now_ns: i64, resolver: &Resolver, mem: &[u8]) -> Result<(), String> {
        self.line.clear();
        for signal in &mut self.signals {
            match signal.elem {
                Some(elem) => {
                    let value = raw(mem, &signal.leaf, elem);
                    if self.started && value == signal.last {
                        continue;
                    }
                    signal.last = value;
                    scalar(&mut self.line, elem, value, &signal.id);
                }
                None => {
                    self.cell.clear();
                    resolver.write(&signal.leaf, mem, &mut self.cell);
                    if self.started && self.cell == signal.last_text {
                        continue;
                    }
                    signal.last_text.clone_from(&self.cell);
                    string(&mut self.line, &self.cell, &signal.id);
                }
            }
        }
        let done = if !self.started {
            self.started = true;
            write!(self.out, "#{now_ns}\n$dumpvars\n{}$end\n", self.line)
        } else if self.line.is_empty() {
            Ok(())
        } else {
            write!(self.out, "#{now_ns}\n{}", self.line)
        };
        self.last_ns = now_ns;
        done.map_err(|e| crate::trace::failure(&e, "waveform"))
    }

    /// The end of the last cycle, so that a viewer shows all of it, and what is buffered.
    pub fn finish(&mut self, interval_ns: i64) -> Result<(), String> {
        let end = self.last_ns.saturating_add(interval_ns);
        let stamp = if self.started { writeln!(self.out, "#{end}") } else { Ok(()) };
        stamp.and_then(|()| self.out.flush()).map_err(|e| crate::trace::failure(&e, "waveform"))
    }
}

/// A value change of everything but strings.
fn scalar(line: &mut String, elem: Elem, value: u64, id: &str) {
    // Writing to a String does not fail.
    let _ = match elem {
        Elem::Bool => writeln!(line, "{value}{id}"),
        Elem::Real => writeln!(line, "r{:?} {id}", f32::from_bits(value as u32)),
        Elem::Lreal => writeln!(line, "r{:?} {id}", f64::from_bits(value)),
        _ => writeln!(line, "b{value:b} {id}"),
    };
}

/// A value change of a string: without its quotes, and blanks escaped as viewers expect.
fn string(line: &mut String, literal: &str, id: &str) {
    let mut characters = literal.chars();
    // The trace's text has a quote at both ends.
    characters.next();
    characters.next_back();
    line.push('s');
    for c in characters {
        match c {
            ' ' => line.push_str("\\x20"),
            '\\' => line.push_str("\\\\"),
            c => line.push(c),
        }
    }
    let _ = writeln!(line, " {id}");
}

/// Short names of printable characters: `!`, `"`, ... `~`, `!!`, ...
fn identifier(mut n: usize) -> String {
    let mut id = String::new();
    loop {
        id.push((b'!' + (n % 94) as u8) as char);
        n /= 94;
        if n == 0 {
            return id;
        }
        n -= 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Root;
    use std::collections::HashSet;

    #[test]
    fn identifiers_differ() {
        let ids: HashSet<String> = (0..20_000).map(identifier).collect();
        assert_eq!(ids.len(), 20_000);
    }

    #[test]
    fn values_stand_where_they_change() {
        let path = std::env::temp_dir().join(format!("plcc-vcd-{}", std::process::id()));
        let root = |name: &str, offset, ty| Root { name: name.into(), offset, ty, ..Root::default() };
        let image = Image {
            types: vec![
                TypeDesc::Elem(Elem::Bool.code()),
                TypeDesc::Elem(Elem::Sint.code()),
                TypeDesc::Elem(Elem::Lreal.code()),
                TypeDesc::String { wide: false, capacity: 7 },
                TypeDesc::Array { dims: vec![(1, 1)], elem: 1, stride: 1 },
            ],
            roots: vec![root("M.on", 0, 0), root("M.a", 1, 4), root("r", 8, 2), root("s", 16, 3)],
            ..Image::default()
        };
        let resolver = Resolver::new(&image);
        let mut vcd = Vcd::open(&path, &image, resolver.all().unwrap()).unwrap();
        let mut mem = vec![0; 32];
        vcd.row(0, &resolver, &mem).unwrap();
        vcd.row(10, &resolver, &mem).unwrap();
        (mem[0], mem[1]) = (7, 0xFE);
        mem[8..16].copy_from_slice(&0.5f64.to_le_bytes());
        mem[16..19].copy_from_slice(b"a b");
        vcd.row(20, &resolver, &mem).unwrap();
        vcd.finish(10).unwrap();
        assert_eq!(
            std::fs::read_to_string(&path).unwrap(),
            "$timescale 1 ns $end\n\
             $scope module M $end\n$var wire 1 ! on $end\n$var wire 8 \" a(1) $end\n$upscope $end\n\
             $var real 64 # r $end\n$var string 1 $ s $end\n$enddefinitions $end\n\
             #0\n$dumpvars\n0!\nb0 \"\nr0.0 #\ns $\n$end\n\
             #20\n1!\nb11111110 \"\nr0.5 #\nsa\\x20b $\n#30\n"
        );
        let _ = std::fs::remove_file(path);
    }
}
