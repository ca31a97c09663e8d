//! Builds the runtime archive that travels inside plcc: every program that `plcc build` makes is linked with it.
//!
//! A nested cargo call with its own target folder and the workspace's lock file, so that plain `cargo build` of plcc is all
//! that a user needs.

use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let manifest = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR"));
    let root = manifest.join("../..");
    for input in ["runtime/src", "runtime/Cargo.toml", "stdlib/src", "stdlib/blocks", "stdlib/Cargo.toml", "Cargo.lock"]
    {
        println!("cargo::rerun-if-changed={}", root.join(input).display());
    }
    let target_dir = out.join("runtime");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let target = std::env::var("TARGET").expect("cargo sets TARGET");
    let mut command = Command::new(cargo);
    command
        .current_dir(&root)
        .args(["rustc", "--package", "plcc-runtime", "--lib", "--crate-type", "staticlib", "--profile", "runtime"])
        .args(["--locked", "--target", &target, "--target-dir"])
        .arg(&target_dir);
    // What the outer call is about (clippy, coverage, its own profile) is not about the archive.
    for name in ["RUSTC_WORKSPACE_WRAPPER", "RUSTC_WRAPPER", "CARGO_ENCODED_RUSTFLAGS", "RUSTFLAGS", "CARGO_TARGET_DIR"]
    {
        command.env_remove(name);
    }
    let status = command.status().expect("cargo runs");
    assert!(status.success(), "building the runtime archive failed");
    let archive = target_dir.join(&target).join("runtime/libplcc_runtime.a");
    copy(&archive, &out.join("libplcc_runtime.a"));
    println!("cargo::rustc-env=PLCC_HOST={target}");
}

fn copy(from: &Path, to: &Path) {
    if let Err(e) = std::fs::copy(from, to) {
        panic!("the runtime archive is not where cargo should have put it ({}): {e}", from.display());
    }
}
