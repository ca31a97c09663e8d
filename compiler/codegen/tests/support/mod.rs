//! What the tests of the engines share: a region of the right alignment, and both engines side by side.

#![allow(dead_code)]

use index_vec::IndexVec;
use plcc_codegen::jit::{self, JitCode};
use plcc_diag::{FileId, Span};
use plcc_mir::build::Builder;
use plcc_mir::interp::Interp;
use plcc_mir::ir::{Base, Func, FuncId, Place, Program, Segment, Source};
use plcc_stdlib::region::HEADER_BYTES;

/// A region as the runtime allocates it: aligned to 64 bytes.
#[derive(Clone)]
pub struct Region {
    lines: Vec<Line>,
    bytes: usize,
}

#[derive(Clone, Copy)]
#[repr(align(64))]
struct Line([u8; 64]);

impl Region {
    pub fn new(bytes: usize) -> Self {
        Self { lines: vec![Line([0xAA; 64]); bytes.div_ceil(64)], bytes }
    }

    pub fn bytes(&mut self) -> &mut [u8] {
        // SAFETY: the lines are plain bytes without padding, and there are enough of them.
        unsafe { std::slice::from_raw_parts_mut(self.lines.as_mut_ptr().cast(), self.bytes) }
    }

    pub fn read<const N: usize>(&mut self, at: u32) -> [u8; N] {
        *self.bytes()[at as usize..].first_chunk().expect("inside the region")
    }

    pub fn write(&mut self, at: u32, bytes: &[u8]) {
        self.bytes()[at as usize..][..bytes.len()].copy_from_slice(bytes);
    }
}

/// Region size of hand-made programs; frames lie in the last quarter.
pub const REGION_BYTES: u32 = 4096;
pub const FRAME_BASE: u32 = 3072;

/// A program of functions, of which the last `tasks` are entries of tasks.
pub fn program(funcs: Vec<Func>, tasks: usize) -> Program {
    let count = funcs.len();
    let program = Program {
        funcs: IndexVec::from_vec(funcs),
        tasks: (count - tasks..count).map(FuncId::from_usize).collect(),
        sources: (0..100u32).map(source).collect(),
        region_bytes: REGION_BYTES,
        frame_base: FRAME_BASE,
        addressable: Vec::new(),
        initial: Vec::new(),
        retain: Vec::new(),
        parts: Vec::new(),
    };
    check(&program);
    program
}

pub fn check(program: &Program) {
    let problems: Vec<String> = plcc_mir::verify::verify(program).iter().map(ToString::to_string).collect();
    assert!(problems.is_empty(), "{problems:#?}\n{}", plcc_mir::print::program(program, None));
}

fn source(n: u32) -> Source {
    let span = Span::new(FileId(0), n, n + 1);
    Source { span, pou: "Main".into(), what: format!("a{n}"), inlined_at: None }
}

pub fn segment(offset: u32, bytes: &[u8]) -> Segment {
    Segment { offset, bytes: bytes.to_vec() }
}

pub fn task(name: &str) -> Builder {
    Builder::new(name, &[], None, false)
}

/// A place of the region behind the header.
pub fn global(at: u32) -> Place {
    Place::new(Base::Region, HEADER_BYTES + at)
}

/// Both engines on the same program, each with a region of its own.
pub struct Engines {
    pub interp: Interp,
    pub jit: JitCode,
    pub left: Region,
    pub right: Region,
    text: String,
}

impl Engines {
    pub fn new(program: &Program) -> Self {
        let region = Region::new(program.region_bytes as usize);
        let mut engines = Self {
            interp: Interp::new(program),
            jit: jit::compile(program).expect("code"),
            left: region.clone(),
            right: region,
            text: plcc_mir::print::program(program, None),
        };
        engines.init(true);
        engines
    }

    pub fn init(&mut self, cold: bool) {
        self.interp.init(self.left.bytes(), cold);
        self.jit.init(self.right.bytes(), cold);
        self.compare("init");
    }

    pub fn write(&mut self, at: u32, bytes: &[u8]) {
        self.left.write(HEADER_BYTES + at, bytes);
        self.right.write(HEADER_BYTES + at, bytes);
    }

    pub fn read<const N: usize>(&mut self, at: u32) -> [u8; N] {
        self.left.read(HEADER_BYTES + at)
    }

    /// Runs both; they must agree in the status and in every byte.
    pub fn scan(&mut self, task: u32, now_ns: i64) -> u32 {
        let status = self.interp.scan(self.left.bytes(), task, now_ns);
        let other = self.jit.scan(self.right.bytes(), task, now_ns);
        self.compare("scan");
        assert_eq!(status, other, "status: interpreter, then JIT\n{}", self.text);
        status
    }

    fn compare(&mut self, after: &str) {
        let (left, right) = (self.left.bytes(), self.right.bytes());
        if let Some(at) = (0..left.len()).find(|n| left[*n] != right[*n]) {
            let (l, r) = (&left[at..][..8.min(left.len() - at)], &right[at..][..8.min(right.len() - at)]);
            panic!("after {after} byte {at} differs: interpreter {l:x?}, JIT {r:x?}\n{}", self.text);
        }
    }
}
