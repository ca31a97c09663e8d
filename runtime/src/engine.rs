//! What executes a program: the interpreter, code in memory, or the linked code of this program.

/// A resource's memory, aligned to 64 bytes.
#[derive(Debug)]
pub struct Region {
    lines: Vec<Line>,
    bytes: usize,
}

#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
struct Line([u8; 64]);

impl Region {
    /// Zeroed memory.
    pub fn new(bytes: usize) -> Self {
        Self { lines: vec![Line([0; 64]); bytes.div_ceil(64)], bytes }
    }

    /// All of it.
    pub fn as_slice(&self) -> &[u8] {
        // SAFETY: lines are plain bytes, and there are at least `bytes` of them.
        unsafe { std::slice::from_raw_parts(self.lines.as_ptr().cast(), self.bytes) }
    }

    /// All of it.
    pub fn as_mut_slice(&mut self) -> &mut [u8] {
        // SAFETY: as above, borrowed exclusively.
        unsafe { std::slice::from_raw_parts_mut(self.lines.as_mut_ptr().cast(), self.bytes) }
    }

    /// Its first byte.
    pub fn as_mut_ptr(&mut self) -> *mut u8 {
        self.lines.as_mut_ptr().cast()
    }

    /// A little-endian `u32` of the header.
    pub fn read_u32(&self, offset: u32) -> u32 {
        let at = offset as usize;
        u32::from_le_bytes(self.as_slice()[at..at + 4].try_into().unwrap_or_default())
    }

    /// A little-endian `i64` of the header.
    pub fn read_i64(&self, offset: u32) -> i64 {
        let at = offset as usize;
        i64::from_le_bytes(self.as_slice()[at..at + 8].try_into().unwrap_or_default())
    }
}

/// Executes tasks on a region.
pub trait Engine {
    /// Sets initial values; a warm start (`cold` FALSE) keeps retained ones.
    fn init(&mut self, mem: &mut Region, cold: bool);

    /// Executes a task once at a time of the scan clock. 0, or the number of the fault whose record the header then holds.
    fn scan(&mut self, mem: &mut Region, task: u32, now_ns: i64) -> u32;
}

impl<E: Engine + ?Sized> Engine for Box<E> {
    fn init(&mut self, mem: &mut Region, cold: bool) {
        (**self).init(mem, cold);
    }
    fn scan(&mut self, mem: &mut Region, task: u32, now_ns: i64) -> u32 {
        (**self).scan(mem, task, now_ns)
    }
}

/// `plc_app_init(mem, cold)`.
pub type InitFn = unsafe extern "C" fn(*mut u8, i32);
/// `plc_app_scan(mem, task, now_ns)`.
pub type ScanFn = unsafe extern "C" fn(*mut u8, u32, i64) -> u32;

/// Compiled code behind the entry points of docs/cli.md, "Embedding".
#[derive(Debug, Clone, Copy)]
pub struct NativeEngine {
    init: InitFn,
    scan: ScanFn,
}

impl NativeEngine {
    /// An engine over two entry points.
    ///
    /// # Safety
    /// Both must be those of one compiled program, and stay valid; regions given to the engine must have the size that its
    /// image names.
    pub unsafe fn new(init: InitFn, scan: ScanFn) -> Self {
        Self { init, scan }
    }
}

impl Engine for NativeEngine {
    fn init(&mut self, mem: &mut Region, cold: bool) {
        // SAFETY: see `new`.
        unsafe { (self.init)(mem.as_mut_ptr(), i32::from(cold)) }
    }

    fn scan(&mut self, mem: &mut Region, task: u32, now_ns: i64) -> u32 {
        // SAFETY: see `new`.
        unsafe { (self.scan)(mem.as_mut_ptr(), task, now_ns) }
    }
}
