//! The lanes of a program, and the proof that they all do the same.

use crate::compile_time;
use crate::interface::{Interface, Leaf, Side};
use crate::programs::Program;
use crate::reference::{self, Build, O2_COPY, Reference};
use crate::stimulus::Stimulus;
use plcc::bench::app::{Back, Front};
use plcc::bench::lane::{Cycle, Lane, OneTask, Rows};
use plcc::bench::report::LaneAbout;
use plcc::cli::OptArg;
use plcc_hir::Profile;
use std::path::Path;
use std::rc::Rc;

/// The scan interval.
pub const INTERVAL_NS: i64 = 10_000_000;

/// The reference interpreter on the plain lowering.
pub const INTERP: &str = "interpreter";
/// The interpreter on optimised MIR.
pub const INTERP_SPEED: &str = "interpreter, opt";
/// Native code of the plain lowering.
pub const JIT_NONE: &str = "jit, opt none";
/// What users run.
pub const JIT: &str = "jit";
/// Without checks.
pub const JIT_UNCHECKED: &str = "jit, no checks";
/// Without checks and without the optimiser.
pub const JIT_NONE_UNCHECKED: &str = "jit, opt none, no checks";
/// The code of a linked program.
pub const LINKED: &str = "linked";

/// All lanes in the order of the report.
pub const ABOUT: [LaneAbout; 11] = [
    LaneAbout { name: INTERP, what: "the reference interpreter on the plain lowering (`--engine interp --opt none`)" },
    LaneAbout { name: INTERP_SPEED, what: "the same on optimised MIR (`--opt speed`)" },
    LaneAbout { name: JIT_NONE_UNCHECKED, what: "machine code in memory, `--opt none --checks none`" },
    LaneAbout { name: JIT_NONE, what: "machine code in memory, `--opt none`, every check on" },
    LaneAbout { name: JIT_UNCHECKED, what: "machine code in memory, `--opt speed --checks none`" },
    LaneAbout { name: JIT, what: "machine code in memory, `--opt speed`, every check on: what `plcc run` does" },
    LaneAbout {
        name: LINKED,
        what: "the object code and runtime of `plcc build` (base instruction set), as a shared object",
    },
    LaneAbout { name: reference::O2.lane, what: reference::O2.what },
    LaneAbout { name: O2_COPY, what: "a second copy of that code: the noise bar" },
    LaneAbout { name: reference::O2_NO_SLP.lane, what: reference::O2_NO_SLP.what },
    LaneAbout { name: reference::O3_NATIVE.lane, what: reference::O3_NATIVE.what },
];

/// Which lanes are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choice {
    /// For a report.
    All,
    /// To see that they agree: interpreter, native code of both levels, C at -O2; linked if asked.
    Few {
        /// With the linked code.
        linked: bool,
    },
    /// Those whose instructions are counted: what an emulator without the newest vector instructions can run.
    Counted,
}

/// A lane with where its outputs lie and how large its code is.
pub struct Prepared {
    /// The lane.
    pub lane: Lane<'static>,
    /// Offsets of the outputs are those of the C struct, which begins there; else those of the region.
    outputs: Option<usize>,
    /// Bytes of machine code.
    pub code_bytes: Option<u64>,
    /// Operations of the interpreter in a cycle, mean.
    pub operations: Option<f64>,
}

/// A program with its lanes.
pub struct Lanes {
    /// What can run.
    pub lanes: Vec<Prepared>,
    outputs: Side,
    /// CPU milliseconds of the compiler's stages, `--opt speed`, every check on.
    pub compile_ms: Vec<(&'static str, f64)>,
    /// CPU milliseconds of the passes of the optimiser.
    pub passes_ms: Vec<(&'static str, f64)>,
    /// Lines of source.
    pub lines: usize,
}

impl Lanes {
    /// Compiles everything. `rows` is how many cycles the inputs go on without a repeat.
    pub fn new(program: &Program, choice: Choice, rows: u64, folder: &Path) -> Result<Self, String> {
        let front = Front::new(program.sources, Profile::Strict)?;
        let speed = front.compile("all", OptArg::Speed)?;
        let interface = Interface::new(&front, speed.image());
        let values = Stimulus::new(&interface.inputs.leaves, program.signals).cycles(rows);
        let like = interface.inputs.c_rows(0, &values);
        let of = |back: &Back| interface.inputs.region_rows(back.image(), &values, &like);
        let jit = speed.jit().0;
        let mut out = Self {
            lanes: Vec::new(),
            outputs: interface.outputs.clone(),
            compile_ms: Vec::new(),
            passes_ms: Vec::new(),
            lines: program.sources.iter().map(|(_, text)| text.lines().count()).sum(),
        };
        let none = front.compile("all", OptArg::None)?;
        if choice != Choice::Counted {
            out.ours(INTERP, none.interpreter(), &none, of(&none));
            out.ours(INTERP_SPEED, speed.interpreter(), &speed, of(&speed));
        }
        if choice == Choice::All {
            out.passes_ms = none.passes_ms();
            out.compile_ms = compile_time::to_jit(program.sources, 5)?;
            for (prepared, back) in out.lanes.iter_mut().zip([&none, &speed]) {
                prepared.operations = Some(operations(back, of(back), rows.min(COUNTED)));
            }
            let back = front.compile("none", OptArg::None)?;
            out.ours(JIT_NONE_UNCHECKED, back.jit().0, &back, of(&back));
        }
        out.ours(JIT_NONE, none.jit().0, &none, of(&none));
        let unchecked = front.compile("none", OptArg::Speed)?;
        out.ours(JIT_UNCHECKED, unchecked.jit().0, &unchecked, of(&unchecked));
        out.ours(JIT, jit, &speed, of(&speed));
        if choice == Choice::All || choice == (Choice::Few { linked: true }) {
            let linked = speed.linked(&folder.join(format!("{}-plcc.so", program.name)))?;
            out.ours(LINKED, linked, &speed, of(&speed));
        }
        out.references(program, choice, &interface, &values, &like, folder)?;
        Ok(out)
    }

    /// A program without inputs and without a reference, whose `Main.total` is compared.
    pub fn without_reference(name: &str, text: &str) -> Result<Self, String> {
        let front = Front::new(&[(name, text)], Profile::Strict)?;
        let none = front.compile("all", OptArg::None)?;
        let speed = front.compile("all", OptArg::Speed)?;
        let jit = speed.jit().0;
        let mut out = Self {
            lanes: Vec::new(),
            outputs: Interface::watching(&["Main.total"], speed.image()).outputs,
            compile_ms: compile_time::to_jit(&[(name, text)], 1)?,
            passes_ms: Vec::new(),
            lines: text.lines().count(),
        };
        let rows = Rows { offset: 0, bytes: 0, table: Rc::default() };
        out.ours(INTERP, none.interpreter(), &none, rows.clone());
        out.ours(JIT_NONE, none.jit().0, &none, rows.clone());
        out.ours(JIT, jit, &speed, rows);
        Ok(out)
    }

    fn references(
        &mut self,
        program: &Program,
        choice: Choice,
        interface: &Interface,
        values: &[u8],
        like: &Rows,
        folder: &Path,
    ) -> Result<(), String> {
        if reference::compiler().is_none() {
            return Ok(());
        }
        let builds: &[Build] = match choice {
            Choice::All => &[reference::O2, reference::O2_NO_SLP, reference::O3_NATIVE],
            Choice::Few { .. } | Choice::Counted => &[reference::O2],
        };
        for build in builds {
            let built = reference::build(program.name, *build, folder)?;
            self.reference(build.lane, &built, interface, values, like)?;
            if *build == reference::O2 && choice == Choice::All {
                self.reference(O2_COPY, &built.copy()?, interface, values, like)?;
            }
        }
        Ok(())
    }

    fn reference(
        &mut self,
        lane: &'static str,
        built: &Reference,
        interface: &Interface,
        values: &[u8],
        like: &Rows,
    ) -> Result<(), String> {
        let (engine, shape) = built.load()?;
        let declared = [interface.inputs.c_bytes, interface.outputs.c_bytes];
        if [shape.inputs.1, shape.outputs.1] != declared {
            return Err(format!("{lane}: `in` and `out` have {shape:?}, the ST program has {declared:?} bytes"));
        }
        let mut rows = interface.inputs.c_rows(shape.inputs.0, values);
        rows.table = like.table.clone();
        let subject = Box::new(OneTask::new(engine, shape.bytes, rows, INTERVAL_NS));
        let lane = Lane { name: lane, subject };
        self.lanes.push(Prepared {
            lane,
            outputs: Some(shape.outputs.0),
            code_bytes: built.code_bytes,
            operations: None,
        });
        Ok(())
    }

    fn ours<E: plcc_runtime::engine::Engine + 'static>(
        &mut self,
        name: &'static str,
        engine: E,
        back: &Back,
        rows: Rows,
    ) {
        let native = ![INTERP, INTERP_SPEED].contains(&name);
        let code_bytes = native.then(|| plcc::bench::app::code_bytes(&back.object())).flatten();
        let subject = Box::new(OneTask::new(engine, back.region_bytes(), rows, INTERVAL_NS));
        self.lanes.push(Prepared { lane: Lane { name, subject }, outputs: None, code_bytes, operations: None });
    }

    /// Runs all lanes for some cycles and compares every output after each of them; gives a checksum of all of it, and how many
    /// outputs ever had more than one value.
    pub fn compare(&mut self, cycles: u64) -> Result<(u64, usize), String> {
        self.lanes.iter_mut().for_each(|p| p.lane.subject.restart());
        let mut checksum = 0xcbf2_9ce4_8422_2325u64;
        let mut first: Vec<Vec<u8>> = Vec::new();
        let mut moved = vec![false; self.outputs.leaves.len()];
        for cycle in 0..cycles {
            for prepared in &mut self.lanes {
                let status = prepared.lane.subject.run(cycle, 1);
                if status != 0 {
                    return Err(format!("{}: fault {status} in cycle {cycle}", prepared.lane.name));
                }
            }
            for (n, leaf) in self.outputs.leaves.iter().enumerate() {
                let mut values = self.lanes.iter().map(|p| (p.lane.name, p.output(leaf)));
                let Some((name, value)) = values.next() else { continue };
                if let Some((other, wrong)) = values.find(|(_, v)| *v != value) {
                    return Err(format!(
                        "cycle {cycle}: {} is {value:?} in `{name}` and {wrong:?} in `{other}`",
                        leaf.name
                    ));
                }
                for byte in value {
                    checksum = (checksum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
                }
                match first.get(n) {
                    Some(before) => moved[n] |= before != value,
                    None => first.push(value.to_vec()),
                }
            }
        }
        Ok((checksum, moved.iter().filter(|m| **m).count()))
    }

    /// How many outputs there are.
    pub fn output_count(&self) -> usize {
        self.outputs.leaves.len()
    }
}

/// Operations are counted in so many cycles.
const COUNTED: u64 = 1000;

/// Operations of the interpreter in a cycle, mean.
fn operations(back: &Back, rows: Rows, cycles: u64) -> f64 {
    let (engine, count) = back.counting_interpreter();
    let mut subject = OneTask::new(engine, back.region_bytes(), rows, INTERVAL_NS);
    subject.restart();
    assert_eq!(subject.run(0, cycles), 0, "a benchmark program faulted");
    count.load(std::sync::atomic::Ordering::Relaxed) as f64 / cycles as f64
}

impl Prepared {
    fn output(&self, leaf: &Leaf) -> &[u8] {
        let at = self.outputs.map_or(leaf.region, |start| start + leaf.c);
        leaf.value(self.lane.subject.memory(), at)
    }
}
