//! Cycle times of the same programs in the interpreter and in native code, measured in alternating slices of one run.
//!
//! Printed per program: median, 99.9 % and worst cycle of each engine in nanoseconds, and the ratios of medians and of worst
//! cycles. On a shared machine only ratios mean something, and the worst cycle includes what the machine did meanwhile.
//! `cargo test` runs this too, with a few cycles, to keep it alive.

use plcc_hir::Profile;
use plcc_mir::interp::Interp;
use plcc_tests::compile::compile;
use std::time::Instant;

const PROGRAMS: [(&str, &str); 3] = [
    ("logic", include_str!("programs/logic.st")),
    ("loops", include_str!("programs/loops.st")),
    ("timers", include_str!("programs/timers.st")),
];
const TICK_NS: i64 = 10_000_000;

#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Line([u8; 64]);

/// Sorted cycle times.
struct Times(Vec<u64>);

impl Times {
    fn at(&self, share: f64) -> u64 {
        self.0[((self.0.len() - 1) as f64 * share) as usize]
    }
}

/// One engine on its own memory.
struct Lane<'a> {
    memory: Vec<Line>,
    scan: Box<dyn FnMut(&mut [u8], i64) -> u32 + 'a>,
    times: Vec<u64>,
}

impl Lane<'_> {
    fn bytes(memory: &mut [Line]) -> &mut [u8] {
        // SAFETY: a Line is 64 plain bytes.
        unsafe { std::slice::from_raw_parts_mut(memory.as_mut_ptr().cast(), memory.len() * 64) }
    }

    fn slice(&mut self, first: i64, cycles: i64) {
        for cycle in first..first + cycles {
            let memory = Self::bytes(&mut self.memory);
            let start = Instant::now();
            let status = (self.scan)(memory, cycle * TICK_NS);
            self.times.push(start.elapsed().as_nanos() as u64);
            assert_eq!(status, 0, "a benchmark program faulted");
        }
    }
}

fn measure(text: &str, slices: i64, per_slice: i64) -> [Times; 2] {
    let program = compile(text, Profile::Strict).unwrap_or_else(|e| panic!("{e}"));
    let mut interp = Interp::new(&program);
    let code = plcc_codegen::jit::compile(&program).unwrap_or_else(|e| panic!("{e:?}"));
    let region = || vec![Line([0; 64]); (program.region_bytes as usize).div_ceil(64)];
    let (mut a, mut b) = (region(), region());
    interp.init(Lane::bytes(&mut a), true);
    code.init(Lane::bytes(&mut b), true);
    let mut lanes = [
        Lane { memory: a, scan: Box::new(move |m, now| interp.scan(m, 0, now)), times: Vec::new() },
        Lane { memory: b, scan: Box::new(|m, now| code.scan(m, 0, now)), times: Vec::new() },
    ];
    for n in 0..slices {
        lanes.iter_mut().for_each(|lane| lane.slice(n * per_slice, per_slice));
        // The first slice is warm-up.
        if n == 0 {
            lanes.iter_mut().for_each(|lane| lane.times.clear());
        }
    }
    assert_eq!(
        Lane::bytes(&mut lanes[0].memory.clone()),
        Lane::bytes(&mut lanes[1].memory.clone()),
        "engines disagree"
    );
    lanes.map(|mut lane| {
        lane.times.sort_unstable();
        Times(std::mem::take(&mut lane.times))
    })
}

fn main() {
    let quick = !std::env::args().any(|a| a == "--bench");
    let (slices, per_slice) = if quick { (3, 20) } else { (50, 1000) };
    println!(
        "| program | interp median | p99.9 | worst | native median | p99.9 | worst | median ratio | worst ratio |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for (name, text) in PROGRAMS {
        let [a, b] = measure(text, slices, per_slice);
        let ratio = |x: u64, y: u64| x as f64 / y.max(1) as f64;
        println!(
            "| {name} | {} | {} | {} | {} | {} | {} | {:.1} | {:.1} |",
            a.at(0.5),
            a.at(0.999),
            a.at(1.0),
            b.at(0.5),
            b.at(0.999),
            b.at(1.0),
            ratio(a.at(0.5), b.at(0.5)),
            ratio(a.at(1.0), b.at(1.0))
        );
    }
}
