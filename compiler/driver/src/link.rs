//! Object code and runtime archive to an executable, with the system's C compiler as linker.

use crate::failure::Failure;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The runtime for this machine; see build.rs.
static RUNTIME: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/libplcc_runtime.a"));

/// The triple of the embedded runtime.
pub const HOST: &str = env!("PLCC_HOST");

/// A folder for intermediate files that goes away in any case.
struct Scratch(PathBuf);

impl Scratch {
    fn new() -> Result<Self, Failure> {
        let base = std::env::temp_dir();
        for n in 0..1000u32 {
            let path = base.join(format!("plcc-{}-{n}", std::process::id()));
            match std::fs::create_dir(&path) {
                Ok(()) => return Ok(Self(path)),
                Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => {}
                Err(e) => return Err(Failure::io("make folder", &path, e)),
            }
        }
        Err(Failure::io("make a folder in", &base, "too many of them exist"))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Links an object that has `main` with the runtime; `runtime` replaces the embedded archive.
///
/// The output appears whole or not at all.
pub fn executable(object: &[u8], runtime: Option<&Path>, output: &Path) -> Result<(), Failure> {
    whole(output, |partial| link_to(object, runtime, &[], partial))
}

/// Links an object with the entry points alone and what it needs of the runtime to a shared object.
///
/// The output appears whole or not at all.
pub fn shared(object: &[u8], output: &Path) -> Result<(), Failure> {
    whole(output, |partial| link_to(object, None, &["-shared"], partial))
}

fn whole(output: &Path, link: impl FnOnce(&Path) -> Result<(), Failure>) -> Result<(), Failure> {
    // What cannot be written is said before the linker says it in its own words.
    let partial = partial_name(output);
    std::fs::write(&partial, b"").map_err(|e| Failure::io("write", output, e))?;
    let result =
        link(&partial).and_then(|()| std::fs::rename(&partial, output).map_err(|e| Failure::io("write", output, e)));
    if result.is_err() {
        let _ = std::fs::remove_file(&partial);
    }
    result
}

fn partial_name(output: &Path) -> PathBuf {
    let name = output.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    output.with_file_name(format!(".{name}.{}.partial", std::process::id()))
}

fn link_to(object: &[u8], runtime: Option<&Path>, flags: &[&str], output: &Path) -> Result<(), Failure> {
    let scratch = Scratch::new()?;
    let object_path = scratch.0.join("app.o");
    std::fs::write(&object_path, object).map_err(|e| Failure::io("write", &object_path, e))?;
    let archive = match runtime {
        Some(path) => path.to_path_buf(),
        None => {
            let path = scratch.0.join("libplcc_runtime.a");
            std::fs::write(&path, RUNTIME).map_err(|e| Failure::io("write", &path, e))?;
            path
        }
    };
    let linker = std::env::var("CC").ok().filter(|c| !c.is_empty()).unwrap_or_else(|| "cc".into());
    let done = Command::new(&linker)
        .arg(&object_path)
        .arg(&archive)
        .args(flags)
        .args(["-Wl,--gc-sections", "-Wl,--strip-debug", "-lm", "-lpthread", "-ldl", "-o"])
        .arg(output)
        .output();
    match done {
        Ok(done) if done.status.success() => Ok(()),
        Ok(done) => {
            let text = String::from_utf8_lossy(&done.stderr);
            Err(Failure::device(format!("linking with `{linker}` failed:\n{}", text.trim_end())))
        }
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Err(Failure::device(format!(
            "there is no linker `{linker}` on this machine\n\
             help: install a C tool chain (Debian, Ubuntu: apt install gcc; Fedora: dnf install gcc), set CC, \
             or write the object alone with --emit obj,header"
        ))),
        Err(e) => Err(Failure::device(format!("cannot start `{linker}`: {e}"))),
    }
}

/// Writes a file whole or not at all.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let partial = partial_name(path);
    let result = std::fs::write(&partial, bytes).and_then(|()| std::fs::rename(&partial, path));
    result.map_err(|e| {
        let _ = std::fs::remove_file(&partial);
        Failure::io("write", path, e)
    })
}
