//! HIR to MIR: every statement as semantics.md defines it, plainly and in the order of the source.
//!
//! In: checked bodies and the application. Out: the [`Program`] of one resource and its [`Layout`]. Nothing is optimised
//! here: variables stay in memory, only values of expressions and the counters of FOR loops are SSA values.
//!
//! Frames. A function's variables lie in its frame, then come its temporaries; the frame of what it calls starts behind.
//! So a caller writes aggregate arguments straight into the callee's frame, after all arguments are evaluated, and reads
//! outputs and aggregate results from there right after the call, before anything else can be called. Scalar inputs and
//! references of VAR_IN_OUT are parameters. Function blocks take their inputs in the instance.

mod call;
mod expr;
mod for_loop;
mod func;
pub mod init;
mod path;
mod place;
pub mod reach;
mod std_call;
mod stmt;
mod string;
mod tails;
mod task;
mod text;
mod text_ops;

use crate::ir::{FuncId, Program, Source, SourceId};
use crate::layout::{Layout, TooLarge};
use index_vec::IndexVec;
use init::{Constants, Image};
pub use path::of_place;
use plcc_hir::app::Application;
use plcc_hir::{Defs, PouId};
use reach::Reach;
use rustc_hash::FxHashMap;
pub(crate) use task::frame_bytes;

/// Which faults are looked for (`--checks`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Checks {
    /// Array indices. Without: an index outside is moved to the nearest bound.
    pub index: bool,
    /// Divisors and shift counts.
    pub division: bool,
    /// Values of subranges.
    pub subrange: bool,
    /// References. Without: one outside is moved into the addressable part.
    pub pointer: bool,
    /// The watchdog, in loops.
    pub deadline: bool,
}

impl Checks {
    /// The default.
    pub const ALL: Checks = Checks { index: true, division: true, subrange: true, pointer: true, deadline: true };
    /// For benchmarks.
    pub const NONE: Checks = Checks { index: false, division: false, subrange: false, pointer: false, deadline: false };
}

impl Default for Checks {
    fn default() -> Self {
        Self::ALL
    }
}

/// Lowers one resource of an application. With `all` the POUs that its tasks do not reach are lowered too.
pub fn lower(
    defs: &Defs,
    app: &Application,
    resource: usize,
    checks: Checks,
    all: bool,
) -> Result<(Program, Layout), TooLarge> {
    let resource = &app.resources[resource];
    let reach = Reach::new(defs, resource, all);
    let mut layout = Layout::new(defs, resource, &reach)?;
    let funcs: FxHashMap<PouId, FuncId> =
        reach.pous.iter().enumerate().map(|(n, pou)| (*pou, FuncId::from_usize(n))).collect();
    let mut program = Program::default();
    let mut cx = Context {
        defs,
        layout: &layout,
        checks,
        funcs,
        sources: IndexVec::new(),
        constants: Constants::default(),
        longest: text::longest(defs),
        too_large: None,
    };
    for &pou in &reach.pous {
        program.funcs.push(func::lower(&mut cx, pou));
    }
    for (n, task) in resource.tasks.iter().enumerate() {
        let func = task::lower(&mut cx, resource, n, task);
        program.tasks.push(program.funcs.push(func));
    }
    let Context { sources, constants, too_large, .. } = cx;
    if let Some(error) = too_large {
        return Err(error);
    }
    program.sources = sources;
    let mut image = Image::default();
    init::variables(defs, &layout, resource, &mut image);
    layout.close(constants.bytes().len() as u64, task::frame_bytes(&program))?;
    image.write(layout.constants.start, constants.bytes());
    program.initial = image.segments();
    program.region_bytes = layout.region_bytes;
    program.frame_base = layout.frame.start;
    program.addressable = vec![(layout.addressable.start, layout.addressable.bytes)];
    program.retain = layout.retain.clone();
    Ok((program, layout))
}

/// Whether the variables of a resource fit into its region: what can be said without lowering, for `plcc check`.
pub fn fits(defs: &Defs, app: &Application, resource: usize) -> Result<(), TooLarge> {
    let resource = &app.resources[resource];
    let mut layout = Layout::new(defs, resource, &Reach::new(defs, resource, true))?;
    layout.close(0, 0)
}

/// What all functions of a resource share while they are lowered.
struct Context<'a> {
    defs: &'a Defs,
    layout: &'a Layout,
    checks: Checks,
    funcs: FxHashMap<PouId, FuncId>,
    sources: IndexVec<SourceId, Source>,
    constants: Constants,
    /// Capacity of the longest STRING and WSTRING that a variable can have.
    longest: [u32; 2],
    /// The first function whose frame is too large.
    too_large: Option<TooLarge>,
}

#[cfg(test)]
mod tests;
