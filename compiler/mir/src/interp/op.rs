//! The operations of the interpreter: what a function becomes once it is decoded.

use crate::ir::FuncId;
use index_vec::IndexVec;
use plcc_stdlib::fault::Fault;
use plcc_stdlib::prim::{PrimOp, Repr};
use plcc_stdlib::rt::RtFn;
use plcc_stdlib::rt::strings::TextFn;

/// Number of a register, counted from the first of the running function.
pub type Reg = u32;

/// Always 0: the base of places in the region.
pub const REGION: Reg = 0;
/// Region offset of the instance.
pub const INSTANCE: Reg = 1;
/// Region offset of the frame.
pub const FRAME: Reg = 2;
/// Scratch registers for addresses, as many as an operation may need; the first also breaks cycles of parallel moves.
pub const SCRATCH: [Reg; MAX_TEXTS] = [3, 4, 5];
/// Constants start here, values follow.
pub const FIRST_FREE: Reg = 6;
/// So many strings a body of the standard library takes at most.
pub const MAX_TEXTS: usize = 3;

/// Lists the machine operations that have an operation of their own, so that [`eval`](plcc_stdlib::prim::eval) is compiled
/// for constant `op` and `repr`. Their meaning stays there. Calls `$use!` with the list.
macro_rules! specialised {
    ($use:ident) => {
        $use! {
            binary {
                AddI8 Add I8, AddI16 Add I16, AddI32 Add I32, AddI64 Add I64,
                SubI8 Sub I8, SubI16 Sub I16, SubI32 Sub I32, SubI64 Sub I64,
                MulI16 Mul I16, MulI32 Mul I32, MulI64 Mul I64,
                DivSI16 DivS I16, DivSI32 DivS I32, DivSI64 DivS I64, DivU DivU I64,
                RemSI16 RemS I16, RemSI32 RemS I32, RemSI64 RemS I64, RemU RemU I64,
                And And I64, Or Or I64, Xor Xor I64,
                ShlI8 Shl I8, ShlI16 Shl I16, ShlI32 Shl I32, ShlI64 Shl I64, ShrU ShrU I64,
                MinSI16 MinS I16, MinSI32 MinS I32, MinSI64 MinS I64, MinU MinU I64,
                MaxSI16 MaxS I16, MaxSI32 MaxS I32, MaxSI64 MaxS I64, MaxU MaxU I64,
                FAdd32 FAdd F32, FSub32 FSub F32, FMul32 FMul F32, FDiv32 FDiv F32,
                FAdd64 FAdd F64, FSub64 FSub F64, FMul64 FMul F64, FDiv64 FDiv F64,
            }
            compare {
                Eq BrEq Eq I64, Ne BrNe Ne I64, LtU BrLtU LtU I64, LeU BrLeU LeU I64,
                LtSI8 BrLtSI8 LtS I8, LtSI16 BrLtSI16 LtS I16, LtSI32 BrLtSI32 LtS I32, LtSI64 BrLtSI64 LtS I64,
                LeSI8 BrLeSI8 LeS I8, LeSI16 BrLeSI16 LeS I16, LeSI32 BrLeSI32 LeS I32, LeSI64 BrLeSI64 LeS I64,
                FEq32 BrFEq32 FEq F32, FNe32 BrFNe32 FNe F32, FLt32 BrFLt32 FLt F32, FLe32 BrFLe32 FLe F32,
                FEq64 BrFEq64 FEq F64, FNe64 BrFNe64 FNe F64, FLt64 BrFLt64 FLt F64, FLe64 BrFLe64 FLe F64,
            }
            unary {
                NegI16 Neg I16, NegI32 Neg I32, NegI64 Neg I64,
                NotI8 Not I8, NotI16 Not I16, NotI32 Not I32, NotI64 Not I64,
                SextI8I16 Sext(I16) I8, SextI8I32 Sext(I32) I8, SextI8I64 Sext(I64) I8,
                SextI16I32 Sext(I32) I16, SextI16I64 Sext(I64) I16, SextI32I64 Sext(I64) I32,
                WrapI8 Wrap(I8) I64, WrapI16 Wrap(I16) I64, WrapI32 Wrap(I32) I64,
                FNeg32 FNeg F32, FNeg64 FNeg F64, FAbs32 FAbs F32, FAbs64 FAbs F64,
                FPromote FPromote F32, FDemote FDemote F64,
                I16ToF32 SToF(F32) I16, I32ToF32 SToF(F32) I32, I32ToF64 SToF(F64) I32, I64ToF64 SToF(F64) I64,
            }
        }
    };
}
pub(super) use specialised;

macro_rules! define_op {
    (
        binary { $($b:ident $bop:ident $brepr:ident,)* }
        compare { $($c:ident $br:ident $cop:ident $crepr:ident,)* }
        unary { $($u:ident $uop:ident $(($uto:ident))? $urepr:ident,)* }
    ) => {
        /// An operation. Targets are numbers of operations in the same function.
        #[derive(Debug, Clone, Copy)]
        pub enum Op {
            $($b(Reg, Reg, Reg),)*
            $($c(Reg, Reg, Reg),)*
            $($br(Reg, Reg, u32, u32),)*
            $($u(Reg, Reg),)*
            /// `dst, a, b, c`: a ? b : c.
            Select(Reg, Reg, Reg, Reg),
            /// Any other machine operation, by number of its [`PrimSite`].
            Prim(u32),
            /// `dst, src`.
            Move(Reg, Reg),
            /// `dst, src`: 1 if any bit is set.
            Truth(Reg, Reg),
            /// `dst, base, offset`.
            Load8(Reg, Reg, i32),
            Load16(Reg, Reg, i32),
            Load32(Reg, Reg, i32),
            Load64(Reg, Reg, i32),
            /// `dst, base, offset, bit`.
            LoadBit(Reg, Reg, i32, u32),
            /// `src, base, offset`.
            Store8(Reg, Reg, i32),
            Store16(Reg, Reg, i32),
            Store32(Reg, Reg, i32),
            Store64(Reg, Reg, i32),
            /// `src, base, offset, bit`.
            StoreBit(Reg, Reg, i32, u32),
            /// `dst, base, value, stride`: base + value * stride.
            Index(Reg, Reg, Reg, u32),
            /// `dst, base, low half, high half`: base + constant.
            Offset(Reg, Reg, u32, u32),
            /// `dst, base, offset`: a region offset as I32.
            Address(Reg, Reg, i32),
            /// By number of the [`BlockSite`].
            Copy(u32),
            Zero(u32),
            /// By number of the [`CallSite`].
            Call(u32),
            /// By number of the [`RtSite`].
            CallRt(u32),
            /// By number of the [`TextSite`].
            CallText(u32),
            /// `value, CheckSite`.
            CheckTrue(Reg, u32),
            CheckWithin(Reg, u32),
            /// By number of the [`CheckSite`].
            Poll(u32),
            Jump(u32),
            /// `cond, then, otherwise`.
            Branch(Reg, u32, u32),
            /// `value`, number of the [`SwitchSite`].
            Switch(Reg, u32),
            Return,
            ReturnValue(Reg),
        }

        impl Op {
            /// The operation for a machine operation, made of result and operands (`b` is not used by unary ones).
            pub fn of_prim(op: PrimOp, repr: Repr) -> Option<fn(Reg, Reg, Reg) -> Op> {
                Some(match (op, repr) {
                    $((PrimOp::$bop, Repr::$brepr) => Op::$b,)*
                    $((PrimOp::$cop, Repr::$crepr) => Op::$c,)*
                    $((PrimOp::$uop $((Repr::$uto))?, Repr::$urepr) => |dst, a, _| Op::$u(dst, a),)*
                    _ => return None,
                })
            }

            /// Sets one or both targets of a branch.
            pub fn set_targets(&mut self, new_then: Option<u32>, new_otherwise: Option<u32>) {
                match self {
                    $(Op::$br(_, _, then, otherwise))|* | Op::Branch(_, then, otherwise) => {
                        *then = new_then.unwrap_or(*then);
                        *otherwise = new_otherwise.unwrap_or(*otherwise);
                    }
                    _ => {}
                }
            }

            /// The branch `(a, b, then, otherwise)` on a comparison.
            pub fn of_branch(op: PrimOp, repr: Repr) -> Option<fn(Reg, Reg, u32, u32) -> Op> {
                Some(match (op, repr) {
                    $((PrimOp::$cop, Repr::$crepr) => Op::$br,)*
                    _ => return None,
                })
            }
        }
    };
}
specialised!(define_op);

/// A machine operation without an operation of its own.
#[derive(Debug, Clone, Copy)]
pub struct PrimSite {
    pub op: PrimOp,
    pub repr: Repr,
    pub dst: Reg,
    pub args: [Reg; 3],
    pub count: u8,
}

/// A copy, or a range of zeros (`src` is not used).
#[derive(Debug, Clone, Copy)]
pub struct BlockSite {
    pub dst: (Reg, i32),
    pub src: (Reg, i32),
    pub bytes: u32,
}

/// A call.
#[derive(Debug, Clone)]
pub struct CallSite {
    pub callee: FuncId,
    /// Base and offset.
    pub instance: Option<(Reg, i32)>,
    /// Register here, register there.
    pub args: Vec<(Reg, Reg)>,
    pub dst: Option<Reg>,
    pub status: Option<Reg>,
    /// The instance that a fault of a callee without one names, if it is not that of the function.
    pub fault_instance: Option<AddressSite>,
}

/// A call of the standard library.
#[derive(Debug, Clone)]
pub struct RtSite {
    pub func: &'static RtFn,
    pub dst: Reg,
    pub args: Vec<Reg>,
}

/// A call of the standard library on strings.
#[derive(Debug, Clone)]
pub struct TextSite {
    pub func: &'static TextFn,
    pub dst: Reg,
    /// Base, offset, capacity.
    pub texts: Vec<(Reg, i32, Reg)>,
    pub args: Vec<Reg>,
}

/// A check, or a poll.
#[derive(Debug, Clone)]
pub struct CheckSite {
    pub fault: Fault,
    pub source: u32,
    /// Limits of `CheckWithin`.
    pub low: i64,
    pub high: i64,
    /// Operands of the fault, from registers.
    pub operands: Vec<Reg>,
    /// The instance that the fault names, if it is not the function's own.
    pub instance: Option<AddressSite>,
    /// Stores that are due before: where, from which register, how many bytes, which bit.
    pub owed: Vec<(AddressSite, Reg, u32, Option<u8>)>,
}

/// A place as only a fault needs it: base, constant part, registers with their strides.
#[derive(Debug, Clone)]
pub struct AddressSite {
    pub base: Reg,
    pub offset: i64,
    pub terms: Vec<(Reg, u32)>,
}

/// A choice: labels sorted, then their targets.
#[derive(Debug, Clone)]
pub struct SwitchSite {
    pub labels: Vec<u64>,
    pub targets: Vec<u32>,
    pub default: u32,
}

/// A decoded function.
#[derive(Debug, Clone, Default)]
pub struct FuncCode {
    pub ops: Vec<Op>,
    /// Registers in all.
    pub registers: u32,
    /// What registers from [`FIRST_FREE`] on hold at entry.
    pub constants: Vec<u64>,
    pub has_instance: bool,
    pub frame_bytes: u32,
    pub prims: Vec<PrimSite>,
    pub blocks: Vec<BlockSite>,
    pub calls: Vec<CallSite>,
    pub rt_calls: Vec<RtSite>,
    pub text_calls: Vec<TextSite>,
    pub checks: Vec<CheckSite>,
    pub switches: Vec<SwitchSite>,
}

/// All functions.
pub type Code = IndexVec<FuncId, FuncCode>;
