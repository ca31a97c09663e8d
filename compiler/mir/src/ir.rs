//! The mid-level form: a control-flow graph of typed instructions over one flat memory region.
//!
//! Scalars are SSA values with block parameters; memory is touched only through [`Place`]s, which stay symbolic until code
//! generation; checks are instructions of their own with a source position. It knows no notation, no types of the user and
//! no machine.

use index_vec::IndexVec;
use plcc_diag::Span;
use plcc_stdlib::fault::Fault;
use plcc_stdlib::prim::{PrimOp, Repr};
use plcc_stdlib::rt::RtFn;
use plcc_stdlib::rt::strings::TextFn;
use std::sync::Arc;

index_vec::define_index_type! {
    /// A function of the program.
    pub struct FuncId = u32;
}
index_vec::define_index_type! {
    /// A basic block of a function; block 0 is the entry.
    pub struct BlockId = u32;
}
index_vec::define_index_type! {
    /// An SSA value of a function.
    pub struct ValueId = u32;
}
index_vec::define_index_type! {
    /// A row of the source table.
    pub struct SourceId = u32;
}

/// The most passes of nested loops between two [`Inst::Poll`]s.
pub const UNPOLLED_PASSES: u64 = 4096;

/// All code of one resource, or of several that were joined ([`resources`](crate::resources)).
#[derive(Debug, Clone, Default)]
pub struct Program {
    /// Bodies of POUs, then one entry per task.
    pub funcs: IndexVec<FuncId, Func>,
    /// The entry of each task, in order: no parameters, no instance.
    pub tasks: Vec<FuncId>,
    /// Where checks and calls come from.
    pub sources: IndexVec<SourceId, Source>,
    /// Size of the region, bytes.
    pub region_bytes: u32,
    /// Where the frames of a task start.
    pub frame_base: u32,
    /// What references reach, ranges (start, length): the addressable part; the optimiser adds what it finds the address
    /// taken of, before it changes anything.
    pub addressable: Vec<(u32, u32)>,
    /// What is not 0 at a cold start.
    pub initial: Vec<Segment>,
    /// Byte ranges (start, length) that a warm start keeps; sorted, disjoint.
    pub retain: Vec<(u32, u32)>,
    /// Several resources joined: the part of each, in order. Empty for one resource, whose part is the region.
    pub parts: Vec<Part>,
}

/// What one resource has of a joined program. Its code counts region offsets from the part's start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// First byte in the memory of all resources.
    pub start: u32,
    /// Bytes; a multiple of 64.
    pub bytes: u32,
    /// Where the frames of its tasks start, from the part's start.
    pub frame_base: u32,
    /// Number of its first function.
    pub first_func: FuncId,
    /// Number of its first task.
    pub first_task: usize,
    /// Its first row of the source table.
    pub first_source: SourceId,
}

impl Program {
    /// The part in which a task runs.
    pub fn part_of_task(&self, task: usize) -> Part {
        self.parts.iter().rfind(|p| p.first_task <= task).copied().unwrap_or_else(|| self.whole())
    }

    /// The part in which a function runs.
    pub fn part_of_func(&self, func: FuncId) -> Part {
        self.parts.iter().rfind(|p| p.first_func <= func).copied().unwrap_or_else(|| self.whole())
    }

    fn whole(&self) -> Part {
        let (bytes, frame_base) = (self.region_bytes, self.frame_base);
        let (first_func, first_source) = (FuncId::from_usize(0), SourceId::from_usize(0));
        Part { start: 0, bytes, frame_base, first_func, first_task: 0, first_source }
    }
}

/// Bytes of the region at a cold start.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Segment {
    /// Where in the region.
    pub offset: u32,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// A row of the source table.
#[derive(Debug, Clone)]
pub struct Source {
    /// Where.
    pub span: Span,
    /// The POU.
    pub pou: String,
    /// The array or variable that a fault speaks of; may be empty.
    pub what: String,
    /// The call into which this code was inlined.
    pub inlined_at: Option<SourceId>,
}

/// A function: the body of a POU or the entry of a task.
#[derive(Debug, Clone, Default)]
pub struct Func {
    /// The POU, `Owner.Action`, or `task Name`.
    pub name: String,
    /// Scalar inputs and VAR_IN_OUT references of a FUNCTION, in order; parameters of the entry block.
    pub params: Vec<Repr>,
    /// The scalar result.
    pub result: Option<Repr>,
    /// Whether it works on an instance ([`Base::Instance`]).
    pub has_instance: bool,
    /// Its own frame, bytes, a multiple of 16; a callee's frame starts behind it.
    pub frame_bytes: u32,
    /// The representation of each value.
    pub values: IndexVec<ValueId, Repr>,
    /// The blocks, entry first.
    pub blocks: IndexVec<BlockId, Block>,
    /// Names of memory for the printer: (base, first byte, path), sorted.
    pub names: Vec<(Base, u32, String)>,
}

/// A basic block.
#[derive(Debug, Clone)]
pub struct Block {
    /// Values that every jump to it gives.
    pub params: Vec<ValueId>,
    /// In order.
    pub insts: Vec<Inst>,
    /// How it ends.
    pub term: Term,
}

/// An instruction.
#[derive(Debug, Clone)]
pub enum Inst {
    /// A constant: register value of `dst`'s representation.
    Const {
        /// Result.
        dst: ValueId,
        /// Zero-extended bits.
        raw: u64,
    },
    /// A machine operation.
    Prim {
        /// Result.
        dst: ValueId,
        /// Which.
        op: PrimOp,
        /// Representation of the operands.
        repr: Repr,
        /// One to three operands.
        args: Args,
    },
    /// Reads a scalar. A BOOL in memory may be any byte: see [`Place::bit`] and `normalise`.
    Load {
        /// Result.
        dst: ValueId,
        /// Where.
        place: Place,
        /// A truth value from memory that references, unions or overlapping addresses may reach: any non-zero byte is 1.
        normalise: bool,
    },
    /// Writes a scalar.
    Store {
        /// Where.
        place: Place,
        /// What.
        value: ValueId,
    },
    /// Copies an aggregate; source and target may overlap.
    Copy {
        /// Where to.
        dst: Place,
        /// Where from.
        src: Place,
        /// How much.
        bytes: u32,
    },
    /// Sets bytes to 0.
    Zero {
        /// Where.
        dst: Place,
        /// How much.
        bytes: u32,
    },
    /// The region offset (I32) of a place.
    AddressOf {
        /// Result.
        dst: ValueId,
        /// Of what; without a bit.
        place: Place,
        /// How far a reference to it reaches from there, bytes; 0 if no further than the addressable part.
        bytes: u32,
    },
    /// Calls a function of the program. A fault in it leaves this function too, unless `status` catches it.
    Call {
        /// The scalar result. Undefined (0) if a fault was caught.
        dst: Option<ValueId>,
        /// The function.
        callee: FuncId,
        /// Its instance, if it works on one.
        instance: Option<Place>,
        /// One per parameter.
        args: Vec<ValueId>,
        /// I32: the fault number, 0 if none. A `Deadline` is never caught.
        status: Option<ValueId>,
        /// Where, and for whom: an instance that it names stands for that of a callee without one. It owes nothing.
        exit: Exit,
    },
    /// Calls a pure body of the standard library.
    CallRt {
        /// Result.
        dst: ValueId,
        /// Which.
        func: &'static RtFn,
        /// One per parameter.
        args: Vec<ValueId>,
    },
    /// Calls a body of the standard library that works on strings in memory. It reads and writes those strings only; one
    /// that it builds overlaps no other.
    CallText {
        /// Result, I64: of a builder the new length.
        dst: ValueId,
        /// Which.
        func: &'static TextFn,
        /// The strings; a builder writes the first.
        texts: Vec<TextPlace>,
        /// The other parameters, I64.
        args: Vec<ValueId>,
    },
    /// Leaves the function (and its callers) with a fault unless a condition holds.
    Check {
        /// What must hold.
        cond: Cond,
        /// Which fault else.
        fault: Fault,
        /// Offending values, I64; for `Within` the value and its limits are added in front.
        operands: Vec<ValueId>,
        /// Where, and what is to be done before.
        exit: Exit,
    },
    /// At the back-edge of a loop without a small known trip count: leaves with `Deadline` if the watchdog expired.
    Poll {
        /// Where, and what is to be done before.
        exit: Exit,
    },
}

/// How a check, a poll or a call leaves the function with a fault.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Exit {
    /// Where it stands.
    pub source: SourceId,
    /// The instance that the fault names, if it is not the function's own: that of code that was inlined.
    pub instance: Option<Box<Place>>,
    /// Stores that are due before, in order. Lowering makes none; the optimiser holds variables in values and owes their
    /// memory, which a fault must find as if each store had been done in its place (semantics.md \[E1\]).
    pub owed: Vec<(Place, ValueId)>,
}

impl Exit {
    /// An exit of code that was not inlined and owes nothing.
    pub fn at(source: SourceId) -> Self {
        Self { source, instance: None, owed: Vec::new() }
    }
}

/// What a check demands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cond {
    /// An I8 truth value is 1.
    True(ValueId),
    /// low <= value <= high for a signed I64 value.
    Within {
        /// The value.
        value: ValueId,
        /// Lower limit.
        low: i64,
        /// Upper limit.
        high: i64,
    },
}

/// One to three operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Args {
    /// Of a unary operation.
    One([ValueId; 1]),
    /// Of a binary operation.
    Two([ValueId; 2]),
    /// Of `Select`.
    Three([ValueId; 3]),
}

impl std::ops::Deref for Args {
    type Target = [ValueId];
    fn deref(&self) -> &[ValueId] {
        match self {
            Args::One(a) => a,
            Args::Two(a) => a,
            Args::Three(a) => a,
        }
    }
}

impl std::ops::DerefMut for Args {
    fn deref_mut(&mut self) -> &mut [ValueId] {
        match self {
            Args::One(a) => a,
            Args::Two(a) => a,
            Args::Three(a) => a,
        }
    }
}

/// How a block ends.
#[derive(Debug, Clone)]
pub enum Term {
    /// Goes on elsewhere.
    Jump(Target),
    /// On an I8 truth value.
    Branch {
        /// 1: `then`, 0: `otherwise`.
        cond: ValueId,
        /// Taken on 1.
        then: Target,
        /// Taken on 0.
        otherwise: Target,
    },
    /// On an integer.
    Switch {
        /// Of any integer representation.
        value: ValueId,
        /// Register values, all different.
        cases: Vec<(u64, Target)>,
        /// Any other value.
        default: Target,
    },
    /// Leaves the function, with its result if it has one.
    Return(Option<ValueId>),
}

/// A jump target with the values of its parameters.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Target {
    /// Which block.
    pub block: BlockId,
    /// One per parameter.
    pub args: Vec<ValueId>,
}

/// Where a place starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Base {
    /// The region's first byte: globals, located variables, instances of programs, constants.
    Region,
    /// The instance the function works on.
    Instance,
    /// The function's frame; offsets from `frame_bytes` on lie in the frame of the next callee.
    Frame,
    /// A region offset (I32) that a reference holds; checked before.
    Reference(ValueId),
}

/// A place in memory: base + offset + sum of index * stride. Two places with the same base overlap only if these sums can
/// meet, so that aliasing is answered by arithmetic on the bounds and not by pointers.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Place {
    /// Where it starts.
    pub base: Base,
    /// Constant part, bytes; `- low * stride` of each index is in it, so it may be negative while the sum is not.
    pub offset: i64,
    /// Variable parts; each index was checked to lie in its bounds.
    pub index: Vec<IndexTerm>,
    /// One bit of the byte that lies here (a packed BOOL); the value is an I8 truth value.
    pub bit: Option<u8>,
}

/// A string in memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextPlace {
    /// Its first character.
    pub place: Place,
    /// Characters that it can hold, I32; the closing 0 lies behind them.
    pub capacity: ValueId,
    /// The bytes in front of the first 0 of a constant.
    pub constant: Option<Arc<[u8]>>,
}

/// A variable part of a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct IndexTerm {
    /// The index, I64.
    pub value: ValueId,
    /// Bytes from one element to the next.
    pub stride: u32,
    /// Smallest value of the index.
    pub low: i64,
    /// Greatest value of the index.
    pub high: i64,
}

impl Place {
    /// Whether another place lies so many bytes behind this one; neither is a bit.
    pub fn goes_on(&self, bytes: u32, next: &Place) -> bool {
        let terms = self.index.iter().zip(&next.index);
        self.base == next.base
            && self.offset + i64::from(bytes) == next.offset
            && self.index.len() == next.index.len()
            && terms.into_iter().all(|(a, b)| (a.value, a.stride) == (b.value, b.stride))
            && self.bit.is_none()
            && next.bit.is_none()
    }

    /// A place at a constant offset.
    pub fn new(base: Base, offset: u32) -> Self {
        Self { base, offset: i64::from(offset), index: Vec::new(), bit: None }
    }

    /// The same place, some bytes further.
    #[must_use]
    pub fn plus(mut self, bytes: u32) -> Self {
        self.offset += i64::from(bytes);
        self
    }
}
