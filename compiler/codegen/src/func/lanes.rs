//! Packs to instructions on registers of 16 bytes.

use super::*;
use crate::packs::{Operand, Pack, Work};
use cranelift_codegen::ir::condcodes::FloatCC;
use cranelift_codegen::ir::{Endianness, MemFlagsData, Type};
use plcc_mir::lanes::WIDTH;

/// The type of a register full of values.
pub(super) fn vector_type(repr: Repr) -> Type {
    match repr {
        Repr::I8 => types::I8X16,
        Repr::I16 => types::I16X8,
        Repr::I32 => types::I32X4,
        Repr::I64 => types::I64X2,
        Repr::F32 => types::F32X4,
        Repr::F64 => types::F64X2,
    }
}

impl<'a> Translator<'a, '_> {
    /// Translates the pack of an instruction that is in one, at its last instruction; whether there is one.
    pub(super) fn as_pack(&mut self, block: BlockId, at: usize) -> bool {
        let Some((number, last)) = self.packs.at(block, at) else { return false };
        if last {
            self.b.set_srcloc(SourceLoc::default());
            let pack = self.packs.pack(number).clone();
            if let Some(value) = self.pack(&pack) {
                self.vectors.insert(number, value);
            }
        }
        true
    }

    fn pack(&mut self, pack: &Pack) -> Option<Value> {
        match &pack.work {
            Work::Load(place) => {
                let (base, offset) = self.address(place);
                Some(self.b.ins().load(vector_type(pack.repr), memory(), base, offset))
            }
            Work::Store(place) => {
                let value = self.lanes_of(&pack.operands[0], pack.repr);
                let (base, offset) = self.address(place);
                self.b.ins().store(memory(), value, base, offset);
                None
            }
            Work::Prim(op, repr) => {
                let args: Vec<Value> = pack.operands.iter().map(|operand| self.lanes_of(operand, *repr)).collect();
                Some(self.prim_in_lanes(*op, *repr, &args))
            }
            Work::Params(..) => None,
        }
    }

    /// What a jump gives to parameters that are a pack.
    pub(super) fn given(&mut self, number: usize, target: &Target) -> Value {
        let pack = self.packs.pack(number);
        let (Work::Params(_, first), repr, count) = (&pack.work, pack.repr, pack.values.len()) else {
            plcc_diag::bug!("pack {number} of `{}` is not one of parameters", self.func.name)
        };
        let args = &target.args[*first..first + count];
        let operand = match self.packs.lane(args[0]) {
            Some((given, 0)) if self.packs.pack(given).values == args => Operand::Pack(given),
            _ if args.iter().all(|arg| *arg == args[0]) => Operand::Same(args[0]),
            _ => Operand::Constants(args.iter().filter_map(|arg| self.constants[*arg]).collect()),
        };
        self.lanes_of(&operand, repr)
    }

    fn lanes_of(&mut self, operand: &Operand, repr: Repr) -> Value {
        match operand {
            Operand::Pack(number) => match self.vectors.get(number) {
                Some(value) => *value,
                None => plcc_diag::bug!("pack {number} of `{}` has no value", self.func.name),
            },
            Operand::Same(value) => self.filled(*value),
            Operand::Constants(raws) => self.constant_lanes(repr, raws),
        }
    }

    fn constant_lanes(&mut self, repr: Repr, raws: &[u64]) -> Value {
        let bytes: Vec<u8> = raws.iter().flat_map(|raw| raw.to_le_bytes()[..repr.bytes() as usize].to_vec()).collect();
        let constant = self.b.func.dfg.constants.insert(bytes[..].into());
        self.b.ins().vconst(vector_type(repr), constant)
    }

    /// A register full of one value.
    fn filled(&mut self, id: ValueId) -> Value {
        match self.fillings.get(&id) {
            Some(value) => *value,
            None => self.fill(id),
        }
    }

    fn fill(&mut self, id: ValueId) -> Value {
        let repr = self.func.values[id];
        if let Some(raw) = self.constants[id] {
            return self.constant_lanes(repr, &vec![raw; WIDTH / repr.bytes() as usize]);
        }
        let value = self.value(id);
        self.b.ins().splat(vector_type(repr), value)
    }

    /// Fills a register with a value where it is made, so that loops find it done.
    pub(super) fn fill_if_wanted(&mut self, id: ValueId) {
        if self.packs.fills(id) && self.packs.lane(id).is_none() {
            let value = self.fill(id);
            self.fillings.insert(id, value);
        }
    }

    /// One value out of a register.
    pub(super) fn out_of_lanes(&mut self, id: ValueId) -> Option<Value> {
        let (number, lane) = self.packs.lane(id)?;
        let vector = *self.vectors.get(&number)?;
        Some(self.b.ins().extractlane(vector, lane as u8))
    }

    /// As [`prim::emit`] for each lane. Truth values are all ones or all zeros.
    fn prim_in_lanes(&mut self, op: PrimOp, repr: Repr, args: &[Value]) -> Value {
        use PrimOp::*;
        let (x, y) = (args[0], args.get(1).copied().unwrap_or(args[0]));
        let b = &mut self.b;
        match op {
            MinS => b.ins().smin(x, y),
            MaxS => b.ins().smax(x, y),
            MinU => b.ins().umin(x, y),
            MaxU => b.ins().umax(x, y),
            FEq => b.ins().fcmp(FloatCC::Equal, x, y),
            FNe => b.ins().fcmp(FloatCC::NotEqual, x, y),
            FLt => b.ins().fcmp(FloatCC::LessThan, x, y),
            FLe => b.ins().fcmp(FloatCC::LessThanOrEqual, x, y),
            Select => {
                let ty = vector_type(repr);
                let same = b.func.dfg.value_type(x) == ty;
                let flags = MemFlagsData::new().with_endianness(Endianness::Little);
                let mask = if same { x } else { b.ins().bitcast(ty, flags, x) };
                b.ins().bitselect(mask, y, args[2])
            }
            _ => prim::emit(b, op, repr, args),
        }
    }
}
