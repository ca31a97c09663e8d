//! The interpreter and the JIT as engines of the runtime.

use plcc_codegen::jit::JitCode;
use plcc_mir::interp::Interp;
use plcc_runtime::engine::{Engine, NativeEngine, Region};

/// The reference interpreter.
pub struct Interpreter(pub Interp);

impl Engine for Interpreter {
    fn init(&mut self, mem: &mut Region, cold: bool) {
        self.0.init(mem.as_mut_slice(), cold);
    }
    fn scan(&mut self, mem: &mut Region, task: u32, now_ns: i64) -> u32 {
        self.0.scan(mem.as_mut_slice(), task, now_ns)
    }
}

/// Machine code in this process: driven by the same entry points as a linked program.
pub struct Jit {
    engine: NativeEngine,
    /// Keeps the code alive.
    _code: JitCode,
}

impl Jit {
    /// Takes the code over.
    pub fn new(code: JitCode) -> Self {
        let (init, scan) = code.entries();
        // SAFETY: both come from one compiled program, and the code lives as long as this engine.
        let engine = unsafe { NativeEngine::new(init, scan) };
        Self { engine, _code: code }
    }
}

impl Engine for Jit {
    fn init(&mut self, mem: &mut Region, cold: bool) {
        self.engine.init(mem, cold);
    }
    fn scan(&mut self, mem: &mut Region, task: u32, now_ns: i64) -> u32 {
        self.engine.scan(mem, task, now_ns)
    }
}
