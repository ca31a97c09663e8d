//! Inputs from a stimulus file, outputs into a trace file, for %I and %Q alone (docs/cli.md, "I/O drivers").

use super::IoDriver;
use crate::image::Image;
use crate::path::{Leaf, Resolver};
use crate::stimulus::Stimulus;
use crate::trace;
use std::io::{BufWriter, Write};
use std::path::Path;

/// `csv:IN.csv,OUT.csv`; either may be empty.
pub struct Csv {
    inputs: Option<Stimulus>,
    /// The cycle whose inputs were not read yet.
    cycle: u64,
    outputs: Option<Outputs>,
}

struct Outputs {
    /// Offsets count from the start of %Q.
    columns: Vec<Leaf>,
    image: Image,
    out: BufWriter<Box<dyn Write + Send>>,
    line: String,
    /// One value before it is quoted; both keep their memory.
    cell: String,
}

impl Csv {
    pub fn open(files: &str, image: &Image, resolver: &Resolver) -> Result<Self, (u8, String)> {
        let (input, output) = files.split_once(',').unwrap_or((files, ""));
        if input.is_empty() && output.is_empty() {
            return Err((2, "--io csv: needs a file: csv:IN.csv,OUT.csv".into()));
        }
        let [(in_start, in_bytes), (out_start, out_bytes), _] = image.areas;
        let inputs = match input {
            "" => None,
            path => {
                let mut stimulus = Stimulus::read(Path::new(path), resolver)?;
                stimulus.move_into(in_start, in_bytes).map_err(|e| (2, format!("{path}: {e} is no input (%I)")))?;
                Some(stimulus)
            }
        };
        let outputs = match output {
            "" => None,
            path => {
                let inside = |leaf: &Leaf| (out_start..out_start + out_bytes).contains(&leaf.offset);
                let columns: Vec<(String, Leaf)> =
                    resolver.all().map_err(|e| (2, e))?.into_iter().filter(|(_, leaf)| inside(leaf)).collect();
                let mut out = Outputs {
                    columns: columns.iter().map(|(_, l)| Leaf { offset: l.offset - out_start, ..l.clone() }).collect(),
                    image: Image { types: image.types.clone(), ..Image::default() },
                    out: BufWriter::with_capacity(
                        1 << 16,
                        trace::create(Path::new(path), "outputs").map_err(|e| (3, e))?,
                    ),
                    line: "cycle".into(),
                    cell: String::new(),
                };
                for (name, _) in &columns {
                    out.line.push(',');
                    trace::field(&mut out.line, name);
                }
                out.end_line().map_err(|e| (3, e))?;
                Some(out)
            }
        };
        Ok(Self { inputs, cycle: 1, outputs })
    }
}

impl IoDriver for Csv {
    fn begin(&mut self, cycle: u64) {
        self.cycle = cycle;
    }

    fn read(&mut self, inputs: &mut [u8]) -> Result<(), String> {
        if let Some(stimulus) = &mut self.inputs {
            stimulus.apply(self.cycle, inputs);
        }
        Ok(())
    }

    fn write(&mut self, _: &[u8]) -> Result<(), String> {
        Ok(())
    }

    fn end(&mut self, outputs: &[u8]) -> Result<(), String> {
        let cycle = self.cycle;
        self.outputs.as_mut().map_or(Ok(()), |out| out.row(cycle, outputs))
    }
}

impl Outputs {
    fn row(&mut self, cycle: u64, outputs: &[u8]) -> Result<(), String> {
        use std::fmt::Write as _;
        // Writing to a String does not fail.
        let _ = write!(self.line, "{cycle}");
        let resolver = Resolver::types_only(&self.image);
        for leaf in &self.columns {
            self.line.push(',');
            self.cell.clear();
            resolver.write(leaf, outputs, &mut self.cell);
            trace::field(&mut self.line, &self.cell);
        }
        self.end_line()
    }

    fn end_line(&mut self) -> Result<(), String> {
        self.line.push('\n');
        let done = self.out.write_all(self.line.as_bytes());
        self.line.clear();
        done.map_err(|e| trace::failure(&e, "outputs"))
    }
}
