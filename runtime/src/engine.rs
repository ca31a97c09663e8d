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
}

/// Exclusive use of a part of a region: the memory of one resource, or what resources share.
#[derive(Debug)]
pub struct Part<'m> {
    whole: *mut u8,
    start: usize,
    bytes: usize,
    region: std::marker::PhantomData<&'m mut [u8]>,
}

// SAFETY: like the `&mut [u8]` that it stands for.
unsafe impl Send for Part<'_> {}

impl Part<'_> {
    /// Its bytes.
    pub fn as_slice(&self) -> &[u8] {
        // SAFETY: inside the region (see `Region::parts`), which nobody else uses there.
        unsafe { std::slice::from_raw_parts(self.whole.add(self.start), self.bytes) }
    }

    /// Its bytes.
    pub fn as_mut_slice(&mut self) -> &mut [u8] {
        // SAFETY: as above.
        unsafe { std::slice::from_raw_parts_mut(self.whole.add(self.start), self.bytes) }
    }

    /// Its first byte in the region.
    pub fn start(&self) -> usize {
        self.start
    }

    /// Its first byte in memory.
    pub fn as_mut_ptr(&mut self) -> *mut u8 {
        // SAFETY: inside the region.
        unsafe { self.whole.add(self.start) }
    }

    /// The first byte of the whole region.
    pub fn whole(&mut self) -> *mut u8 {
        self.whole
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

impl Region {
    /// All of it as one part: that of an application of one resource.
    pub fn whole(&mut self) -> Part<'_> {
        Part { whole: self.as_mut_ptr(), start: 0, bytes: self.bytes, region: std::marker::PhantomData }
    }

    /// Parts of it (first byte, length), which must be disjoint.
    ///
    /// # Panics
    /// If they are not, or do not lie inside.
    pub fn parts<const N: usize>(&mut self, ranges: [(u32, u32); N]) -> [Part<'_>; N] {
        let whole = self.as_mut_ptr();
        for (n, (start, bytes)) in ranges.iter().enumerate() {
            assert!(*start as usize + *bytes as usize <= self.bytes, "a part outside of the region");
            let apart = |other: &(u32, u32)| start + bytes <= other.0 || other.0 + other.1 <= *start;
            assert!(ranges[..n].iter().all(apart), "parts of the region overlap");
        }
        ranges.map(|(start, bytes)| Part {
            whole,
            start: start as usize,
            bytes: bytes as usize,
            region: std::marker::PhantomData,
        })
    }

    /// As [`Region::parts`], any number.
    pub fn split(&mut self, ranges: &[(u32, u32)]) -> Vec<Part<'_>> {
        let mut sorted = ranges.to_vec();
        sorted.sort_unstable();
        assert!(sorted.windows(2).all(|w| w[0].0 + w[0].1 <= w[1].0), "parts of the region overlap");
        let whole = self.as_mut_ptr();
        let part = |(start, bytes): &(u32, u32)| {
            assert!(*start as usize + *bytes as usize <= self.bytes, "a part outside of the region");
            Part { whole, start: *start as usize, bytes: *bytes as usize, region: std::marker::PhantomData }
        };
        ranges.iter().map(part).collect()
    }
}

/// Executes tasks. Each resource has an engine of its own, which may run on a thread of its own.
pub trait Engine: Send {
    /// Sets initial values of all resources; a warm start (`cold` FALSE) keeps retained ones.
    fn init(&mut self, mem: &mut Region, cold: bool);

    /// Executes a task (its number in the image) once, on the part of its resource, at a time of the scan clock. 0, or the
    /// number of the fault whose record the part's header then holds.
    fn scan(&mut self, part: &mut Part, task: u32, now_ns: i64) -> u32;
}

impl<E: Engine + ?Sized> Engine for Box<E> {
    fn init(&mut self, mem: &mut Region, cold: bool) {
        (**self).init(mem, cold);
    }
    fn scan(&mut self, part: &mut Part, task: u32, now_ns: i64) -> u32 {
        (**self).scan(part, task, now_ns)
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

    fn scan(&mut self, part: &mut Part, task: u32, now_ns: i64) -> u32 {
        // SAFETY: see `new`; the code of a task stays in the part of its resource.
        unsafe { (self.scan)(part.whole(), task, now_ns) }
    }
}
