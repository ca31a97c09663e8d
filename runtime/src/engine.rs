//! What executes tasks, and the memory it works on.

use std::alloc::{Layout, alloc_zeroed, dealloc, handle_alloc_error};
use std::ptr::NonNull;
use std::slice;

/// Alignment of a region.
pub const REGION_ALIGN: usize = 64;

/// Executes the tasks of an application: machine code or an interpreter.
pub trait Engine {
    /// Sets initial values; a warm start (`cold` false) leaves the retain ranges alone.
    fn init(&mut self, mem: &mut Region, cold: bool);
    /// Executes a task once at the scan clock `now_ns`. 0, or the number of a [`Fault`](plcc_stdlib::fault::Fault) whose
    /// details stand in the header of the region.
    fn scan(&mut self, mem: &mut Region, task: u32, now_ns: i64) -> u32;
}

/// `plc_app_init` of compiled code.
pub type InitFn = unsafe extern "C" fn(mem: *mut u8, cold: i32);
/// `plc_app_scan` of compiled code.
pub type ScanFn = unsafe extern "C" fn(mem: *mut u8, task: u32, now_ns: i64) -> u32;

/// Machine code behind the C entry points: JIT and linked program alike.
#[derive(Debug)]
pub struct NativeEngine {
    init: InitFn,
    scan: ScanFn,
}

impl NativeEngine {
    /// # Safety
    /// The functions must be `plc_app_init` and `plc_app_scan` of one application, stay loaded as long as the engine lives,
    /// and be called with regions of at least `plc_app_size()` bytes only.
    pub unsafe fn new(init: InitFn, scan: ScanFn) -> NativeEngine {
        NativeEngine { init, scan }
    }
}

impl Engine for NativeEngine {
    fn init(&mut self, mem: &mut Region, cold: bool) {
        // SAFETY: promised to `new`; compiled code stays inside the region.
        unsafe { (self.init)(mem.as_mut_ptr(), i32::from(cold)) }
    }

    fn scan(&mut self, mem: &mut Region, task: u32, now_ns: i64) -> u32 {
        // SAFETY: as above.
        unsafe { (self.scan)(mem.as_mut_ptr(), task, now_ns) }
    }
}

/// The memory of a resource: zeroed at first, aligned to 64 bytes, at a fixed address.
///
/// The watchdog writes one word of it from its own thread (see [`watchdog`](crate::watchdog)), always atomically; code
/// that polls the word reads it through the pointer.
#[derive(Debug)]
pub struct Region {
    start: NonNull<u8>,
    layout: Layout,
}

// SAFETY: a region owns its memory.
unsafe impl Send for Region {}

impl Region {
    /// At least a header, `bytes` long.
    pub fn new(bytes: u32) -> Region {
        let size = (bytes.max(plcc_stdlib::region::HEADER_BYTES) as usize).next_multiple_of(REGION_ALIGN);
        let layout = Layout::from_size_align(size, REGION_ALIGN).expect("a region is smaller than the address space");
        // SAFETY: the size is not 0.
        let start = NonNull::new(unsafe { alloc_zeroed(layout) }).unwrap_or_else(|| handle_alloc_error(layout));
        Region { start, layout }
    }

    /// Its size, bytes: a multiple of 64.
    pub fn len(&self) -> usize {
        self.layout.size()
    }

    /// Never: a region has at least its header.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Its first byte.
    pub fn as_ptr(&self) -> *const u8 {
        self.start.as_ptr()
    }

    /// Its first byte.
    pub fn as_mut_ptr(&mut self) -> *mut u8 {
        self.start.as_ptr()
    }

    /// Its bytes.
    pub fn as_slice(&self) -> &[u8] {
        // SAFETY: the memory is initialised and owned.
        unsafe { slice::from_raw_parts(self.start.as_ptr(), self.layout.size()) }
    }

    /// Its bytes.
    pub fn as_mut_slice(&mut self) -> &mut [u8] {
        // SAFETY: as above, and `self` is borrowed exclusively.
        unsafe { slice::from_raw_parts_mut(self.start.as_ptr(), self.layout.size()) }
    }

    /// `N` bytes at `offset`, which must lie inside.
    pub fn read<const N: usize>(&self, offset: u32) -> [u8; N] {
        let at = offset as usize;
        self.as_slice()[at..at + N].try_into().expect("N bytes")
    }
}

impl Drop for Region {
    fn drop(&mut self) {
        // SAFETY: allocated with this layout in `new`.
        unsafe { dealloc(self.start.as_ptr(), self.layout) }
    }
}
