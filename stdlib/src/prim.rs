//! The operator table: machine operations on scalars, each with its meaning ([`eval`]).
//!
//! Constant folding, the interpreter and the tests call [`eval`]; the code generator is its only second reading.
//! Operations never trap: what IEC calls a fault is checked before, by explicit checks.

mod eval;

pub use eval::eval;

/// How a scalar lies in a register. In a `u64` register the bits above the width are 0 (F32: its bit pattern).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs)]
pub enum Repr {
    I8,
    I16,
    I32,
    I64,
    F32,
    F64,
}

impl Repr {
    /// Every representation.
    pub const ALL: [Repr; 6] = [Repr::I8, Repr::I16, Repr::I32, Repr::I64, Repr::F32, Repr::F64];

    /// Size and alignment in memory.
    pub fn bytes(self) -> u32 {
        match self {
            Repr::I8 => 1,
            Repr::I16 => 2,
            Repr::I32 | Repr::F32 => 4,
            Repr::I64 | Repr::F64 => 8,
        }
    }

    /// Width, bits.
    pub fn bits(self) -> u32 {
        self.bytes() * 8
    }

    /// I8..I64.
    pub fn is_int(self) -> bool {
        !matches!(self, Repr::F32 | Repr::F64)
    }

    /// All bits of the width set.
    pub fn mask(self) -> u64 {
        if self.bits() == 64 { u64::MAX } else { (1 << self.bits()) - 1 }
    }

    /// The register value as a signed number.
    pub fn sign_extend(self, raw: u64) -> i64 {
        let shift = 64 - self.bits();
        ((raw << shift) as i64) >> shift
    }

    /// `i8`..`f64`.
    pub fn name(self) -> &'static str {
        match self {
            Repr::I8 => "i8",
            Repr::I16 => "i16",
            Repr::I32 => "i32",
            Repr::I64 => "i64",
            Repr::F32 => "f32",
            Repr::F64 => "f64",
        }
    }
}

/// A machine operation. `S` is signed, `U` unsigned; `F` works on F32 and F64, all others on I8..I64.
/// Truth values are I8, 0 or 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PrimOp {
    /// Wraps.
    Add,
    /// Wraps.
    Sub,
    /// Wraps.
    Mul,
    /// The upper half of the product of two signed numbers of twice the width; I64.
    MulHiS,
    /// The upper half of the product of two unsigned numbers of twice the width; I64.
    MulHiU,
    /// Toward zero; `MIN / -1 = MIN`. The divisor is not 0 (a check stands before it); `eval` gives 0.
    DivS,
    /// The divisor is not 0; `eval` gives 0.
    DivU,
    /// Sign of the dividend; `MIN MOD -1 = 0`. The divisor is not 0; `eval` gives 0.
    RemS,
    /// The divisor is not 0; `eval` gives 0.
    RemU,
    /// Two's complement, `-MIN = MIN`.
    Neg,
    /// Bitwise.
    And,
    /// Bitwise.
    Or,
    /// Bitwise.
    Xor,
    /// Bitwise; NOT of a truth value is `Xor` with 1.
    Not,
    /// Second operand: I64, taken as unsigned; the width or more gives 0.
    Shl,
    /// Fills with zeros. Second operand as for `Shl`.
    ShrU,
    /// Fills with the sign; the width or more gives 0 or -1.
    ShrS,
    /// Second operand: I64, modulo the width.
    Rotl,
    /// Second operand: I64, modulo the width.
    Rotr,
    /// Minimum, signed.
    MinS,
    /// Minimum, unsigned.
    MinU,
    /// Maximum, signed.
    MaxS,
    /// Maximum, unsigned.
    MaxU,
    /// Equal; integers.
    Eq,
    /// Not equal; integers.
    Ne,
    /// Less, signed.
    LtS,
    /// Less or equal, signed.
    LeS,
    /// Less, unsigned.
    LtU,
    /// Less or equal, unsigned.
    LeU,
    /// IEEE 754, nearest even. Sign and payload of a NaN are not defined; the trace writes `nan` for all.
    FAdd,
    /// See `FAdd`.
    FSub,
    /// See `FAdd`.
    FMul,
    /// See `FAdd`; never a fault.
    FDiv,
    /// Flips the sign bit.
    FNeg,
    /// Clears the sign bit.
    FAbs,
    /// Correctly rounded.
    FSqrt,
    /// To an integral value, up.
    FCeil,
    /// To an integral value, down.
    FFloor,
    /// To an integral value, toward zero.
    FTrunc,
    /// To an integral value, nearest, ties to even.
    FNearest,
    /// Equal; FALSE if one is NaN.
    FEq,
    /// Not equal; TRUE if one is NaN.
    FNe,
    /// Less; FALSE if one is NaN.
    FLt,
    /// Less or equal; FALSE if one is NaN.
    FLe,
    /// `Select(c: I8, a, b)`: a if the truth value c, 0 or 1, is 1, else b. Any representation.
    Select,
    /// Zero-extends to the wider representation given.
    Zext(Repr),
    /// Sign-extends to the wider representation given.
    Sext(Repr),
    /// Keeps the low bits.
    Wrap(Repr),
    /// F32 to F64, exact.
    FPromote,
    /// F64 to F32, nearest even.
    FDemote,
    /// Signed integer to the real representation given, nearest even.
    SToF(Repr),
    /// Unsigned integer to the real representation given, nearest even.
    UToF(Repr),
    /// Real to signed integer: toward zero, saturates, NaN gives 0. Nearest is `FNearest` before it.
    FToS(Repr),
    /// Real to unsigned integer: toward zero, saturates, NaN gives 0.
    FToU(Repr),
    /// The bits of a real as an integer of its width.
    FBits,
    /// An I32 or I64 as the real with these bits.
    BitsF,
}

impl PrimOp {
    /// How many operands it takes.
    pub fn arity(self) -> usize {
        use PrimOp::*;
        match self {
            Neg | Not | FNeg | FAbs | FSqrt | FCeil | FFloor | FTrunc | FNearest | Zext(_) | Sext(_) | Wrap(_)
            | FPromote | FDemote | SToF(_) | UToF(_) | FToS(_) | FToU(_) | FBits | BitsF => 1,
            Select => 3,
            _ => 2,
        }
    }

    /// The representation of its result for operands of `repr`.
    pub fn result(self, repr: Repr) -> Repr {
        use PrimOp::*;
        match self {
            Eq | Ne | LtS | LeS | LtU | LeU | FEq | FNe | FLt | FLe => Repr::I8,
            Zext(r) | Sext(r) | Wrap(r) | SToF(r) | UToF(r) | FToS(r) | FToU(r) => r,
            FPromote => Repr::F64,
            FDemote => Repr::F32,
            FBits => {
                if repr == Repr::F32 {
                    Repr::I32
                } else {
                    Repr::I64
                }
            }
            BitsF => {
                if repr == Repr::I32 {
                    Repr::F32
                } else {
                    Repr::F64
                }
            }
            _ => repr,
        }
    }

    /// The representation of operand `n` for an operation on `repr`.
    pub fn operand(self, repr: Repr, n: usize) -> Repr {
        use PrimOp::*;
        match (self, n) {
            (Shl | ShrU | ShrS | Rotl | Rotr, 1) => Repr::I64,
            (Select, 0) => Repr::I8,
            _ => repr,
        }
    }

    /// AND, OR, XOR: each bit of the result depends on the same bit of the operands.
    pub fn is_bitwise(self) -> bool {
        matches!(self, PrimOp::And | PrimOp::Or | PrimOp::Xor)
    }

    /// Whether it is defined on `repr`.
    pub fn accepts(self, repr: Repr) -> bool {
        use PrimOp::*;
        match self {
            Select => true,
            FAdd | FSub | FMul | FDiv | FNeg | FAbs | FSqrt | FCeil | FFloor | FTrunc | FNearest | FEq | FNe | FLt
            | FLe | FToS(_) | FToU(_) | FBits => !repr.is_int(),
            FPromote => repr == Repr::F32,
            FDemote => repr == Repr::F64,
            BitsF => matches!(repr, Repr::I32 | Repr::I64),
            MulHiS | MulHiU => repr == Repr::I64,
            Zext(to) | Sext(to) => repr.is_int() && to.is_int() && to.bytes() > repr.bytes(),
            Wrap(to) => repr.is_int() && to.is_int() && to.bytes() < repr.bytes(),
            _ => repr.is_int(),
        }
    }
}
