//! The code as text, for `--emit clif` and `--emit asm`.

use crate::compile::compile_all;
use crate::module::{Extras, declare};
use crate::{CodegenError, target};
use cranelift_frontend::FunctionBuilderContext;
use cranelift_object::{ObjectBuilder, ObjectModule};
use plcc_mir::ir::Program;
use std::fmt::Write;

fn module(triple: Option<&str>) -> Result<ObjectModule, CodegenError> {
    let isa = target::object(triple)?;
    Ok(ObjectModule::new(ObjectBuilder::new(isa, "plcc", cranelift_module::default_libcall_names())?))
}

/// All functions in Cranelift's intermediate form. Calls name their callee by the number behind `u0:`, which is that of
/// the heading.
pub fn emit_clif(program: &Program, triple: Option<&str>) -> Result<String, CodegenError> {
    let mut module = module(triple)?;
    let declared = declare(&mut module, program, Extras::default())?;
    let mut context = FunctionBuilderContext::new();
    let mut text = String::new();
    for job in declared.jobs() {
        let func = (job.build)(&mut context);
        let _ = writeln!(text, "; u0:{} {}\n{}", job.id.as_u32(), job.name, func.display());
    }
    Ok(text)
}

/// All functions as the machine code of the target, before linking.
pub fn emit_asm(program: &Program, triple: Option<&str>) -> Result<String, CodegenError> {
    let mut module = module(triple)?;
    let declared = declare(&mut module, program, Extras::default())?;
    let jobs = declared.jobs();
    let compiled = compile_all(cranelift_module::Module::isa(&module), &jobs, true)?;
    let mut text = String::new();
    for (job, func) in jobs.iter().zip(&compiled) {
        let _ = writeln!(
            text,
            "; u0:{} {} ({} bytes)\n{}",
            job.id.as_u32(),
            job.name,
            func.code.len(),
            func.assembly.as_deref().unwrap_or_default()
        );
    }
    Ok(text)
}
