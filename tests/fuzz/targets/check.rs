//! Any bytes: the compiler gives messages or verified MIR, it never panics. The last byte chooses the profile, so that a
//! source with its line feed at the end is a seed as it is.
#![no_main]

use libfuzzer_sys::fuzz_target;
use plcc_hir::Profile;
use plcc_tests::compile::{diagnose, lower};

fuzz_target!(|data: &[u8]| {
    let Some((last, rest)) = data.split_last() else { return };
    let profile = if last % 2 == 0 { Profile::Strict } else { Profile::Codesys };
    // As the driver reads files: UTF-8 or, if that fails, ISO-8859-1 (semantics.md [L1]).
    let text = match std::str::from_utf8(rest) {
        Ok(text) => text.to_string(),
        Err(_) => rest.iter().map(|byte| *byte as char).collect(),
    };
    let (checked, diags, _) = diagnose(&text, profile);
    if diags.has_errors() {
        return;
    }
    if let Err(e) = lower(&checked) {
        assert!(!e.starts_with("verifier"), "{e}");
    }
});
