//! Code in the memory of this process.

use crate::CodegenError;
use crate::module::{Entries, Extras, rt_functions, text_functions};
use crate::target;
use cranelift_jit::{ArenaMemoryProvider, JITBuilder, JITModule};
use plcc_mir::ir::Program;
use std::fmt;

/// `plc_app_init(mem, cold)`.
pub type InitFn = unsafe extern "C" fn(*mut u8, i32);
/// `plc_app_scan(mem, task, now_ns)`.
pub type ScanFn = unsafe extern "C" fn(*mut u8, u32, i64) -> u32;

/// A compiled program; its memory is freed when it is dropped.
pub struct JitCode {
    init: InitFn,
    scan: ScanFn,
    region_bytes: usize,
    task_count: u32,
    /// Owns the code; `None` only while it is dropped.
    module: Option<JITModule>,
}

// SAFETY: the code is immutable once it is there, and the module is not touched before it is dropped.
unsafe impl Send for JitCode {}
// SAFETY: as above; every call works on a region that the caller borrows exclusively.
unsafe impl Sync for JitCode {}

impl fmt::Debug for JitCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("JitCode").field("region_bytes", &self.region_bytes).finish_non_exhaustive()
    }
}

/// Compiles a verified program for this machine.
pub fn compile(program: &Program) -> Result<JitCode, CodegenError> {
    let mut builder = JITBuilder::with_isa(target::host()?, cranelift_module::default_libcall_names());
    for func in rt_functions(program) {
        builder.symbol(func.symbol, (func.address)());
    }
    for func in text_functions(program) {
        builder.symbol(func.symbol, (func.address)());
    }
    // One piece of address space, so that near calls and data references reach.
    let arena = ArenaMemoryProvider::new_with_size(arena_bytes(program))
        .map_err(|e| CodegenError::Module(format!("no memory for code: {e}")))?;
    builder.memory_provider(Box::new(arena));
    let mut module = JITModule::new(builder);
    match finish(&mut module, program) {
        Ok(entries) => {
            let init = module.get_finalized_function(entries.init);
            let scan = module.get_finalized_function(entries.scan);
            // SAFETY: `entry` gave both functions these C signatures, and the module lives as long as the pointers.
            let (init, scan) = unsafe {
                (std::mem::transmute::<*const u8, InitFn>(init), std::mem::transmute::<*const u8, ScanFn>(scan))
            };
            Ok(JitCode {
                init,
                scan,
                region_bytes: program.region_bytes as usize,
                task_count: program.tasks.len() as u32,
                module: Some(module),
            })
        }
        Err(error) => {
            // SAFETY: no pointer into it was given away.
            unsafe { module.free_memory() };
            Err(error)
        }
    }
}

fn finish(module: &mut JITModule, program: &Program) -> Result<Entries, CodegenError> {
    let entries = crate::module::define(module, program, Extras::default())?;
    module.finalize_definitions()?;
    Ok(entries)
}

/// Address space to reserve; what is not used costs nothing.
fn arena_bytes(program: &Program) -> usize {
    let insts: usize = program.funcs.iter().flat_map(|f| &f.blocks).map(|b| b.insts.len() + 4).sum();
    let data: usize = program.initial.iter().map(|s| s.bytes.len() + 64).sum::<usize>() + program.retain.len() * 64;
    (16 << 20) + insts * 512 + program.funcs.len() * 256 + data * 2
}

impl JitCode {
    /// The functions themselves, for a runtime that drives linked programs in the same way. They are valid as long as
    /// `self`; the region must have [`JitCode::region_bytes`] bytes and an alignment of 64.
    pub fn entries(&self) -> (InitFn, ScanFn) {
        (self.init, self.scan)
    }

    /// Bytes of the region.
    pub fn region_bytes(&self) -> usize {
        self.region_bytes
    }

    /// Number of tasks.
    pub fn task_count(&self) -> u32 {
        self.task_count
    }

    /// Sets all variables to their initial values; a warm start (`cold` FALSE) keeps the retain ranges.
    ///
    /// # Panics
    /// If `mem` is shorter than the region.
    pub fn init(&self, mem: &mut [u8], cold: bool) {
        assert!(mem.len() >= self.region_bytes, "region too short");
        // SAFETY: the code writes inside the region only.
        unsafe { (self.init)(mem.as_mut_ptr(), i32::from(cold)) }
    }

    /// Executes a task once at a time of the scan clock. 0, or the number of the fault whose record the header then holds.
    ///
    /// # Panics
    /// If `mem` is shorter than the region.
    pub fn scan(&self, mem: &mut [u8], task: u32, now_ns: i64) -> u32 {
        assert!(mem.len() >= self.region_bytes, "region too short");
        // SAFETY: the code reads and writes inside the region only: all of its places were verified or are checked.
        unsafe { (self.scan)(mem.as_mut_ptr(), task, now_ns) }
    }
}

impl Drop for JitCode {
    fn drop(&mut self) {
        if let Some(module) = self.module.take() {
            // SAFETY: nobody runs the code while `self` is borrowed exclusively, and nobody can call it afterwards.
            unsafe { module.free_memory() }
        }
    }
}
