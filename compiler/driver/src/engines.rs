//! The interpreter and the JIT as engines of the runtime.

use plcc_codegen::jit::JitCode;
use plcc_mir::interp::Interp;
use plcc_mir::ir::Program;
use plcc_runtime::engine::{Engine, NativeEngine, Part, Region};
use std::sync::Arc;

/// The reference interpreter.
pub struct Interpreter(pub Interp);

impl Engine for Interpreter {
    fn init(&mut self, mem: &mut Region, cold: bool) {
        self.0.init(mem.as_mut_slice(), cold);
    }
    fn scan(&mut self, part: &mut Part, task: u32, now_ns: i64) -> u32 {
        self.0.scan_part(part.as_mut_slice(), task, now_ns)
    }
}

impl Interpreter {
    /// One for each resource.
    pub fn engines(program: &Program, resources: usize) -> Vec<Box<dyn Engine>> {
        let engine = |_| -> Box<dyn Engine> { Box::new(Interpreter(Interp::new(program))) };
        (0..resources).map(engine).collect()
    }
}

/// Machine code in this process: driven by the same entry points as a linked program.
pub struct Jit {
    engine: NativeEngine,
    /// Keeps the code alive.
    _code: Arc<JitCode>,
}

impl Jit {
    /// For an application of one resource.
    pub fn new(code: JitCode) -> Self {
        Self::over(Arc::new(code))
    }

    fn over(code: Arc<JitCode>) -> Self {
        let (init, scan) = code.entries();
        // SAFETY: both come from one compiled program, and the code lives as long as any engine.
        let engine = unsafe { NativeEngine::new(init, scan) };
        Self { engine, _code: code }
    }

    /// One for each resource, over the same code.
    pub fn engines(code: JitCode, resources: usize) -> Vec<Box<dyn Engine>> {
        let code = Arc::new(code);
        let engine = |_| -> Box<dyn Engine> { Box::new(Self::over(Arc::clone(&code))) };
        (0..resources).map(engine).collect()
    }
}

impl Engine for Jit {
    fn init(&mut self, mem: &mut Region, cold: bool) {
        self.engine.init(mem, cold);
    }
    fn scan(&mut self, part: &mut Part, task: u32, now_ns: i64) -> u32 {
        self.engine.scan(part, task, now_ns)
    }
}
