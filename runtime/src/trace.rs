//! Trace CSV: one row per executed cycle, values as they are after it (docs/cli.md, "Trace CSV").

use crate::path::{Leaf, Resolver, split_names};
use std::io::{BufWriter, ErrorKind, Write};
use std::path::Path;

/// What is written where.
pub struct Trace {
    columns: Vec<(String, Leaf)>,
    out: BufWriter<Box<dyn Write + Send>>,
    line: String,
    /// One value before it is quoted; both buffers keep their memory.
    cell: String,
    live: bool,
}

impl std::fmt::Debug for Trace {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Trace").field("columns", &self.columns.len()).finish_non_exhaustive()
    }
}

/// The columns of `--watch`, or all variables.
pub fn columns(watch: Option<&str>, resolver: &Resolver) -> Result<Vec<(String, Leaf)>, String> {
    let Some(watch) = watch else { return resolver.all() };
    let mut columns = Vec::new();
    for name in split_names(watch) {
        if name.is_empty() {
            return Err("--watch: a name is empty".into());
        }
        columns.extend(resolver.columns(name).map_err(|e| format!("--watch: {e}"))?);
    }
    Ok(columns)
}

impl Trace {
    /// Opens the file (`-` is standard output) and writes the header.
    pub fn open(path: &Path, columns: Vec<(String, Leaf)>) -> Result<Self, String> {
        let out = create(path, "trace")?;
        let mut trace = Self {
            columns,
            out: BufWriter::with_capacity(1 << 16, out),
            line: String::new(),
            cell: String::new(),
            live: path == Path::new("-"),
        };
        trace.line.push_str("cycle");
        for (name, _) in &trace.columns {
            trace.line.push(',');
            field(&mut trace.line, name);
        }
        trace.end_line()?;
        Ok(trace)
    }

    /// One row.
    pub fn row(&mut self, cycle: u64, resolver: &Resolver, mem: &[u8]) -> Result<(), String> {
        use std::fmt::Write as _;
        let _ = write!(self.line, "{cycle}");
        for (_, leaf) in &self.columns {
            self.line.push(',');
            self.cell.clear();
            resolver.write(leaf, mem, &mut self.cell);
            field(&mut self.line, &self.cell);
        }
        self.end_line()
    }

    fn end_line(&mut self) -> Result<(), String> {
        self.line.push('\n');
        let done = self.out.write_all(self.line.as_bytes());
        self.line.clear();
        tolerate(done)
    }

    /// Whether rows go to standard output, where somebody may be waiting for them.
    pub fn is_live(&self) -> bool {
        self.live
    }

    /// What is buffered, at the end or before a fault is told.
    pub fn flush(&mut self) -> Result<(), String> {
        tolerate(self.out.flush())
    }
}

/// Opens a file for results, `-` is standard output.
pub(crate) fn create(path: &Path, what: &str) -> Result<Box<dyn Write + Send>, String> {
    if path == Path::new("-") {
        return Ok(Box::new(std::io::stdout()));
    }
    match std::fs::File::create(path) {
        Ok(file) => Ok(Box::new(file)),
        Err(e) => Err(format!("cannot write {what} `{}`: {e}", path.display())),
    }
}

/// What to say of a failed write; nothing of a reader that went away, which ends the run quietly.
pub(crate) fn failure(e: &std::io::Error, what: &str) -> String {
    if e.kind() == ErrorKind::BrokenPipe { String::new() } else { format!("cannot write the {what}: {e}") }
}

fn tolerate(done: std::io::Result<()>) -> Result<(), String> {
    done.map_err(|e| failure(&e, "trace"))
}

/// A field as in RFC 4180.
pub(crate) fn field(line: &mut String, text: &str) {
    if text.contains([',', '"', '\n', '\r']) {
        line.push('"');
        line.push_str(&text.replace('"', "\"\""));
        line.push('"');
    } else {
        line.push_str(text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_quoted_where_they_must_be() {
        let quoted = |text: &str| {
            let mut line = String::new();
            field(&mut line, text);
            line
        };
        assert_eq!(quoted("T#5s"), "T#5s");
        assert_eq!(quoted("Main.m[1,2]"), "\"Main.m[1,2]\"");
        assert_eq!(quoted("'say \"x\"'"), "\"'say \"\"x\"\"'\"");
    }

    #[test]
    fn a_reader_that_went_away_is_no_mistake() {
        assert_eq!(tolerate(Err(ErrorKind::BrokenPipe.into())), Err(String::new()));
        assert!(tolerate(Err(ErrorKind::StorageFull.into())).unwrap_err().contains("cannot write the trace"));
    }
}
