//! Stores of constants that lie side by side, as one: a call of a function block with constant inputs writes them all.

use crate::func::Translator;
use crate::place::memory;
use cranelift_codegen::ir::{InstBuilder, types};
use plcc_mir::ir::{Inst, Place, ValueId};

/// Bytes of a vector register.
const WIDTH: usize = 16;

impl<'a> Translator<'a, '_> {
    /// Translates the stores with which a list of instructions begins, if they fill a register, with the constants between
    /// them; gives how many instructions that were.
    pub(crate) fn constant_run(&mut self, insts: &'a [Inst]) -> Option<usize> {
        let Inst::Store { place: first, .. } = insts.first()? else { return None };
        let (bytes, end) = self.run_of(first, insts)?;
        for inst in insts[..end].iter().filter(|inst| matches!(inst, Inst::Const { .. })) {
            self.inst(inst);
        }
        let (base, offset) = self.address(first);
        let value = if bytes.len() == WIDTH {
            let constant = self.b.func.dfg.constants.insert(bytes.into());
            self.b.ins().vconst(types::I8X16, constant)
        } else {
            let ty = match bytes.len() {
                2 => types::I16,
                4 => types::I32,
                _ => types::I64,
            };
            let raw = bytes.iter().rev().fold(0, |raw, byte| raw << 8 | i64::from(*byte));
            self.b.ins().iconst(ty, raw)
        };
        self.b.ins().store(memory(), value, base, offset);
        Some(end)
    }

    /// The bytes of the widest run of two stores or more from the first instruction on, and how many instructions that are.
    fn run_of(&self, first: &Place, insts: &[Inst]) -> Option<(Vec<u8>, usize)> {
        let mut bytes = Vec::with_capacity(WIDTH);
        let mut made: Vec<(ValueId, u64)> = Vec::new();
        let mut stores = 0;
        let mut widest = None;
        for (n, inst) in insts.iter().enumerate() {
            match inst {
                Inst::Const { dst, raw } => made.push((*dst, *raw)),
                Inst::Store { place, value } if first.goes_on(bytes.len() as u32, place) => {
                    let new = made.iter().find(|(v, _)| v == value).map(|(_, raw)| *raw);
                    let Some(raw) = new.or(self.constants[*value]) else { break };
                    bytes.extend(&raw.to_le_bytes()[..self.func.values[*value].bytes() as usize]);
                    stores += 1;
                    match bytes.len() {
                        2 | 4 | 8 if stores > 1 => widest = Some((bytes.len(), n + 1)),
                        WIDTH if self.env.vectors => {
                            widest = Some((WIDTH, n + 1));
                            break;
                        }
                        WIDTH.. => break,
                        _ => {}
                    }
                }
                _ => break,
            }
        }
        let (length, end) = widest?;
        bytes.truncate(length);
        Some((bytes, end))
    }
}
