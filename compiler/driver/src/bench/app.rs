//! A program for the lanes: compiled with the pipeline of `plcc build`, with the CPU time of each stage.

use crate::cli::{CodeArgs, OptArg};
use crate::engines::{Interpreter, Jit};
use crate::failure::Failure;
use crate::link;
use crate::pipeline::{self, Compiled, Parsed};
use crate::project::Project;
use libloading::Library;
use plcc_codegen::object::{self, ObjectOptions};
use plcc_diag::SourceMap;
use plcc_hir::{Checked, Profile, Section};
use plcc_mir::interp::Interp;
use plcc_mir::ir::Program;
use plcc_runtime::engine::{Engine, InitFn, NativeEngine, Part, Region, ScanFn};
use plcc_runtime::image::Image;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// CPU time of this process, milliseconds.
pub fn cpu_ms() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `time` is valid for writing.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut time) };
    time.tv_sec as f64 * 1e3 + time.tv_nsec as f64 / 1e6
}

/// A value and the CPU milliseconds that it took.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = cpu_ms();
    let value = work();
    (value, cpu_ms() - start)
}

/// Checked sources.
pub struct Front {
    pub(crate) parsed: Parsed,
    pub(crate) checked: Checked,
    pub(crate) project: Project,
    /// CPU milliseconds of parsing (the standard function blocks with it) and checking.
    pub cpu_ms: [f64; 2],
}

impl Front {
    /// Texts with their names, as one application; the error is what `plcc check` would say.
    pub fn new(texts: &[(&str, &str)], profile: Profile) -> Result<Self, String> {
        let mut sources = SourceMap::new();
        let ids: Vec<_> = texts.iter().map(|(name, text)| (sources.add(*name, *text), profile)).collect();
        let project = Project { name: "bench".into(), ..Project::default() };
        let front = Self::check(sources, &ids, project);
        if front.parsed.diags.has_errors() {
            let list = front.parsed.diags.sorted();
            let errors = list.iter().filter(|d| d.severity() == plcc_diag::Severity::Error);
            let place = |d: &plcc_diag::Diagnostic| front.parsed.sources.position(d.primary.span);
            return Err(errors.map(|d| format!("{}: {}: {}\n", place(d), d.code, d.message)).collect());
        }
        Ok(front)
    }

    pub(crate) fn check(sources: SourceMap, ids: &[(plcc_diag::FileId, Profile)], project: Project) -> Self {
        let (mut parsed, parse_ms) = timed(|| pipeline::parse(sources, ids));
        let (checked, check_ms) = timed(|| pipeline::check(&mut parsed, &project));
        Self { parsed, checked, project, cpu_ms: [parse_ms, check_ms] }
    }

    /// Code for the checks (`all`, `none` or a list) and the optimisation of the command line.
    pub fn compile(&self, checks: &str, opt: OptArg) -> Result<Back, String> {
        self.back(&CodeArgs { checks: Some(checks.into()), opt: Some(opt) }, false).map_err(|e| e.message)
    }

    /// Code for every POU, whether a task reaches it or not.
    pub fn compile_library(&self) -> Result<Back, String> {
        self.back(&CodeArgs { checks: None, opt: Some(OptArg::Speed) }, true).map_err(|e| e.message)
    }

    pub(crate) fn back(&self, code: &CodeArgs, all: bool) -> Result<Back, Failure> {
        let app = self.checked.app.as_ref().ok_or_else(crate::nothing_to_run)?;
        let (compiled, cpu_ms) =
            timed(|| pipeline::compile(&self.checked, app, &self.project, &self.parsed, code, all));
        Ok(Back { compiled: compiled?, cpu_ms })
    }

    /// The names (as in `--watch`) of the VAR_INPUTs and the VAR_OUTPUTs of the first program, in order of declaration.
    pub fn interface(&self) -> [Vec<String>; 2] {
        let program = self.checked.app.as_ref().and_then(|app| app.resources.first()?.programs.first());
        [Section::Input, Section::Output].map(|section| {
            let Some(program) = program else { return Vec::new() };
            let vars = self.checked.defs.pous[program.pou].vars.iter().map(|v| &self.checked.defs.vars[*v]);
            vars.filter(|v| v.section == section).map(|v| format!("{}.{}", program.name, v.name)).collect()
        })
    }
}

/// MIR and image.
pub struct Back {
    pub(crate) compiled: Compiled,
    /// CPU milliseconds of lowering, optimising and the image.
    pub cpu_ms: f64,
}

impl Back {
    /// The program.
    pub fn program(&self) -> &Program {
        &self.compiled.program
    }

    /// What the runtime knows of it.
    pub fn image(&self) -> &Image {
        &self.compiled.image
    }

    /// Whether some call catches the faults in it (EN/ENO).
    pub fn catches_faults(&self) -> bool {
        let insts = self.program().funcs.iter().flat_map(|f| &f.blocks).flat_map(|b| &b.insts);
        insts.into_iter().any(|inst| matches!(inst, plcc_mir::ir::Inst::Call { status: Some(_), .. }))
    }

    /// Bytes of its memory.
    pub fn region_bytes(&self) -> usize {
        self.compiled.program.region_bytes as usize
    }

    /// The reference interpreter.
    pub fn interpreter(&self) -> impl Engine + use<> {
        Interpreter(Interp::new(&self.compiled.program))
    }

    /// The reference interpreter, which adds up how many operations it executes.
    pub fn counting_interpreter(&self) -> (impl Engine + use<>, Arc<AtomicU64>) {
        let operations = Arc::new(AtomicU64::new(0));
        (Counting { interp: Interp::new(&self.compiled.program), operations: Arc::clone(&operations) }, operations)
    }

    /// CPU milliseconds of each pass of the optimiser over a program of the plain lowering, in the order of their first run.
    pub fn passes_ms(&self) -> Vec<(&'static str, f64)> {
        let mut program = self.compiled.program.clone();
        let mut passes: Vec<(&'static str, f64)> = Vec::new();
        for pass in plcc_mir::opt::passes() {
            let ms = timed(|| (pass.run)(&mut program)).1;
            match passes.iter_mut().find(|(name, _)| *name == pass.name) {
                Some((_, sum)) => *sum += ms,
                None => passes.push((pass.name, ms)),
            }
        }
        passes
    }

    /// Code in memory, and the CPU milliseconds to make it.
    pub fn jit(&self) -> (impl Engine + use<>, f64) {
        let (code, ms) = timed(|| plcc_codegen::jit::compile(&self.compiled.program));
        (Jit::new(code.unwrap_or_else(|e| plcc_diag::bug!("the code generator refused: {e:?}"))), ms)
    }

    /// The object code that a linked program has, with the entry points alone.
    pub fn object(&self) -> Vec<u8> {
        object::compile(&self.compiled.program, ObjectOptions::default())
            .unwrap_or_else(|e| plcc_diag::bug!("the code generator refused: {e:?}"))
    }

    /// The code of a linked program: object code and the runtime's library, linked to a shared object at `path` and loaded.
    pub fn linked(&self, path: &Path) -> Result<Shared, String> {
        link::shared(&self.object(), path).map_err(|e| e.message)?;
        // SAFETY: the object has no initialisers but those of the runtime archive, and these entry points.
        unsafe { Shared::load(path, "plc_app_init", "plc_app_scan") }
    }
}

struct Counting {
    interp: Interp,
    operations: Arc<AtomicU64>,
}

impl Engine for Counting {
    fn init(&mut self, mem: &mut Region, cold: bool) {
        self.interp.init(mem.as_mut_slice(), cold);
    }
    fn scan(&mut self, part: &mut Part, task: u32, now_ns: i64) -> u32 {
        let (status, operations) = self.interp.scan_counted(part.as_mut_slice(), task, now_ns);
        self.operations.fetch_add(operations, Ordering::Relaxed);
        status
    }
}

/// A program in a shared object.
pub struct Shared {
    engine: NativeEngine,
    library: Library,
}

impl Shared {
    /// Loads it.
    ///
    /// # Safety
    /// The symbols must be functions of the types [`InitFn`] and [`ScanFn`] that stay within the memory they are given.
    pub unsafe fn load(path: &Path, init: &str, scan: &str) -> Result<Self, String> {
        let failed = |e: libloading::Error| format!("cannot load {}: {e}", path.display());
        // SAFETY: promised above; the library lives as long as the engine.
        unsafe {
            let library = Library::new(path).map_err(failed)?;
            let engine = NativeEngine::new(
                *library.get::<InitFn>(init.as_bytes()).map_err(failed)?,
                *library.get::<ScanFn>(scan.as_bytes()).map_err(failed)?,
            );
            Ok(Self { engine, library })
        }
    }

    /// A constant of it.
    ///
    /// # Safety
    /// There must be one of this name and type.
    pub unsafe fn constant<T: Copy>(&self, name: &str) -> Result<T, String> {
        // SAFETY: promised above.
        unsafe { self.library.get::<*const T>(name.as_bytes()).map(|at| **at).map_err(|e| e.to_string()) }
    }
}

impl Engine for Shared {
    fn init(&mut self, mem: &mut Region, cold: bool) {
        self.engine.init(mem, cold);
    }
    fn scan(&mut self, part: &mut Part, task: u32, now_ns: i64) -> u32 {
        self.engine.scan(part, task, now_ns)
    }
}

/// Bytes of machine code in an object file; `None` if it is not one.
pub fn code_bytes(object: &[u8]) -> Option<u64> {
    use ::object::{Object, ObjectSection, SectionKind};
    let file = ::object::File::parse(object).ok()?;
    Some(file.sections().filter(|s| s.kind() == SectionKind::Text).map(|s| s.size()).sum())
}
