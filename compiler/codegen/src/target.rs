//! What code is generated for: the triple, the flags, the instruction set.
//!
//! The optimiser in front of this crate is the only one: Cranelift selects instructions and allocates registers.

use crate::CodegenError;
use cranelift_codegen::isa::{self, OwnedTargetIsa};
use cranelift_codegen::settings::{self, Configurable};
use plcc_stdlib::prim::Repr;

/// The machine we run on, with all that its processor offers.
pub fn host() -> Result<OwnedTargetIsa, CodegenError> {
    let builder = cranelift_native::builder().map_err(|why| CodegenError::Target(why.to_string()))?;
    builder.finish(flags(false)).map_err(|e| CodegenError::Target(e.to_string()))
}

/// A machine by its triple, `None` for the kind we run on, with the base instruction set of its architecture, so that
/// the object runs on every machine of that kind.
pub fn object(triple: Option<&str>) -> Result<OwnedTargetIsa, CodegenError> {
    let unknown = |why: String| CodegenError::Target(why);
    let triple = match triple {
        Some(text) => text.parse().map_err(|e| unknown(format!("`{text}` is no target: {e}")))?,
        None => cranelift_native::builder().map_err(|why| unknown(why.into()))?.triple().clone(),
    };
    let name = format!("{triple}");
    let builder = isa::lookup(triple).map_err(|e| unknown(format!("target `{name}`: {e}")))?;
    let isa = builder.finish(flags(true)).map_err(|e| unknown(e.to_string()))?;
    if isa.pointer_bits() != 64 {
        return Err(unknown(format!("target `{name}` is not a 64-bit machine")));
    }
    Ok(isa)
}

fn flags(position_independent: bool) -> settings::Flags {
    let mut flags = settings::builder();
    let mut set = |name: &str, value: &str| {
        if let Err(e) = flags.set(name, value) {
            plcc_diag::bug!("code generator flag {name}={value}: {e}");
        }
    };
    set("opt_level", "none");
    set("regalloc_algorithm", "backtracking");
    set("is_pic", if position_independent { "true" } else { "false" });
    set("use_colocated_libcalls", "false");
    // The selector of a CASE is the program's own value; there is nobody to hide it from.
    set("enable_table_access_spectre_mitigation", "false");
    set("enable_verifier", if cfg!(debug_assertions) { "true" } else { "false" });
    settings::Flags::new(flags)
}

/// How an integer narrower than a register must be extended when it is given to code of another compiler; register values
/// are unsigned to them.
pub fn c_extension(isa: &dyn isa::TargetIsa, repr: Repr) -> cranelift_codegen::ir::ArgumentExtension {
    use cranelift_codegen::ir::ArgumentExtension::{None, Sext, Uext};
    match repr {
        Repr::I8 | Repr::I16 => Uext,
        // RISC-V keeps every 32-bit integer sign-extended, unsigned ones too.
        Repr::I32 if isa.name() == "riscv64" => Sext,
        _ => None,
    }
}
