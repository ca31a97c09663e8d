//! The C references: built with the system's `cc`, loaded as shared objects.

use plcc::bench::app::{Shared, code_bytes};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A way to compile C.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Build {
    /// The lane's name.
    pub lane: &'static str,
    /// What runs.
    pub what: &'static str,
    /// The compiler's flags.
    pub flags: &'static [&'static str],
}

/// No contraction of `a * b + c` in any build: it would give other results.
const EXACT: &str = "-ffp-contract=off";

/// What the report refers to.
pub const O2: Build = Build { lane: "C -O2", what: "the C reference, `cc -O2`", flags: &["-O2", EXACT] };
/// A second copy of the same code: what differs between the two is noise.
pub const O2_COPY: &str = "C -O2 (copy)";
/// gcc 12 at -O2 joins 4-byte loads to 8-byte ones right behind 4-byte stores, which stalls; without that.
pub const O2_NO_SLP: Build = Build {
    lane: "C -O2 no SLP",
    what: "the same with `-fno-tree-slp-vectorize`",
    flags: &["-O2", EXACT, "-fno-tree-slp-vectorize"],
};
/// All that the machine has.
pub const O3_NATIVE: Build = Build {
    lane: "C -O3 native",
    what: "the same with `-O3 -march=native -ffp-contract=off`",
    flags: &["-O3", "-march=native", EXACT],
};

/// A compiled reference.
pub struct Reference {
    /// The shared object.
    pub path: PathBuf,
    /// Bytes of machine code.
    pub code_bytes: Option<u64>,
}

/// Where the struct of a program has what.
#[derive(Debug, Clone, Copy)]
pub struct Shape {
    /// Its size.
    pub bytes: usize,
    /// Offset and size of the inputs.
    pub inputs: (usize, usize),
    /// Offset and size of the outputs.
    pub outputs: (usize, usize),
}

/// The compiler's name and version; `None` if there is none.
pub fn compiler() -> Option<String> {
    let output = Command::new("cc").arg("--version").output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout);
    output.status.success().then(|| text.lines().next().unwrap_or("cc").to_string())
}

/// Compiles `programs/<name>.c` into `folder`.
pub fn build(name: &str, build: Build, folder: &Path) -> Result<Reference, String> {
    let programs = Path::new(env!("CARGO_MANIFEST_DIR")).join("programs");
    let stem = format!("{name}{}", build.flags.concat());
    let (object, path) = (folder.join(format!("{stem}.o")), folder.join(format!("{stem}.so")));
    cc(Command::new("cc")
        .args(["-std=c11", "-Wall", "-Wextra", "-fPIC", "-c", "-o"])
        .arg(&object)
        .args(build.flags)
        .arg(programs.join(format!("{name}.c"))))?;
    cc(Command::new("cc").args(["-shared", "-o"]).arg(&path).arg(&object).arg("-lm"))?;
    let bytes = std::fs::read(&object).map_err(|e| e.to_string())?;
    Ok(Reference { path, code_bytes: code_bytes(&bytes) })
}

fn cc(command: &mut Command) -> Result<(), String> {
    let output = command.output().map_err(|e| format!("cannot start cc: {e}"))?;
    let messages = String::from_utf8_lossy(&output.stderr);
    if output.status.success() && messages.is_empty() { Ok(()) } else { Err(format!("cc:\n{messages}")) }
}

impl Reference {
    /// Loads it.
    pub fn load(&self) -> Result<(Shared, Shape), String> {
        // SAFETY: programs/bench.h defines the symbols with these types; the references write to their struct alone.
        let (shared, layout) = unsafe {
            let shared = Shared::load(&self.path, "bench_init", "bench_scan")?;
            let layout = shared.constant::<[u64; 5]>("bench_layout")?;
            (shared, layout.map(|n| n as usize))
        };
        let [bytes, in_at, in_bytes, out_at, out_bytes] = layout;
        Ok((shared, Shape { bytes, inputs: (in_at, in_bytes), outputs: (out_at, out_bytes) }))
    }

    /// Another copy of the same code at other addresses.
    pub fn copy(&self) -> Result<Reference, String> {
        let path = self.path.with_extension("copy.so");
        std::fs::copy(&self.path, &path).map_err(|e| e.to_string())?;
        Ok(Reference { path, code_bytes: self.code_bytes })
    }
}
