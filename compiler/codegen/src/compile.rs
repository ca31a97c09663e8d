//! Compiles functions side by side. What comes out does not depend on how the work was shared.

use crate::CodegenError;
use cranelift_codegen::Context;
use cranelift_codegen::control::ControlPlane;
use cranelift_codegen::ir;
use cranelift_codegen::isa::TargetIsa;
use cranelift_frontend::FunctionBuilderContext;
use cranelift_module::{FuncId, ModuleReloc};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Below so many functions threads cost more than they give.
const PARALLEL_FROM: usize = 8;

/// A function to compile.
pub struct Job<'a> {
    /// Its number in the module.
    pub id: FuncId,
    /// Its name, for messages.
    pub name: String,
    /// Makes its CLIF.
    pub build: Box<dyn Fn(&mut FunctionBuilderContext) -> ir::Function + Send + Sync + 'a>,
}

/// A compiled function.
pub struct Compiled {
    pub id: FuncId,
    pub alignment: u64,
    pub code: Vec<u8>,
    pub relocs: Vec<ModuleReloc>,
    /// Assembly text, if it was asked for.
    pub assembly: Option<String>,
}

/// Compiles all jobs; the results come in the order of the jobs.
pub fn compile_all(isa: &dyn TargetIsa, jobs: &[Job], disassemble: bool) -> Result<Vec<Compiled>, CodegenError> {
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<(usize, Result<Compiled, CodegenError>)>> = Mutex::new(Vec::with_capacity(jobs.len()));
    let work = || {
        let mut context = Context::new();
        let mut builder = FunctionBuilderContext::new();
        loop {
            let n = next.fetch_add(1, Ordering::Relaxed);
            let Some(job) = jobs.get(n) else { break };
            let result = compile(isa, job, &mut context, &mut builder, disassemble);
            done.lock().unwrap_or_else(|e| e.into_inner()).push((n, result));
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    if threads > 1 && jobs.len() >= PARALLEL_FROM {
        std::thread::scope(|scope| {
            for _ in 1..threads.min(jobs.len()) {
                scope.spawn(work);
            }
            work();
        });
    } else {
        work();
    }
    let mut results = done.into_inner().unwrap_or_else(|e| e.into_inner());
    results.sort_by_key(|(n, _)| *n);
    results.into_iter().map(|(_, result)| result).collect()
}

fn compile(
    isa: &dyn TargetIsa,
    job: &Job,
    context: &mut Context,
    builder: &mut FunctionBuilderContext,
    disassemble: bool,
) -> Result<Compiled, CodegenError> {
    context.clear();
    context.func = (job.build)(builder);
    context.set_disasm(disassemble);
    if let Err(error) = context.compile(isa, &mut ControlPlane::default()) {
        if let cranelift_codegen::CodegenError::Verifier(problems) = &error.inner {
            plcc_diag::bug!("CLIF of `{}`: {problems}\n{}", job.name, error.func.display());
        }
        return Err(CodegenError::Function { name: job.name.clone(), message: error.inner.to_string() });
    }
    let Some(code) = context.take_compiled_code() else {
        plcc_diag::bug!("`{}` was compiled without code", job.name);
    };
    Ok(Compiled {
        id: job.id,
        alignment: u64::from(code.buffer.alignment),
        code: code.code_buffer().to_vec(),
        relocs: code.buffer.relocs().iter().map(|r| ModuleReloc::from_mach_reloc(r, &context.func, job.id)).collect(),
        assembly: code.vcode,
    })
}
