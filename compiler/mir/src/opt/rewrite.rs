//! Tools of the passes: replacing values, where values come from, compaction.

use crate::dominators::reverse_postorder;
use crate::ir::{BlockId, Func, Inst, Target, ValueId};
use crate::visit;
use index_vec::IndexVec;

/// Values that stand for others; chains are followed.
#[derive(Debug, Clone)]
pub struct Replace {
    by: IndexVec<ValueId, ValueId>,
}

impl Replace {
    /// Nothing is replaced yet.
    pub fn new(func: &Func) -> Self {
        Self { by: func.values.indices().collect() }
    }

    /// From now on `old` is `new`.
    pub fn set(&mut self, old: ValueId, new: ValueId) {
        self.grow(old);
        let new = self.get(new);
        debug_assert_ne!(old, new, "a value replaced by itself");
        self.by[old] = new;
    }

    /// What a value is.
    pub fn get(&self, value: ValueId) -> ValueId {
        let mut at = value;
        while let Some(next) = self.by.get(at) {
            if *next == at {
                break;
            }
            at = *next;
        }
        at
    }

    /// Knows values that were made after it.
    fn grow(&mut self, value: ValueId) {
        while self.by.len() <= value.index() {
            let own = ValueId::from_usize(self.by.len());
            self.by.push(own);
        }
    }

    /// Replaces the operands of an instruction.
    pub fn inst(&self, inst: &mut Inst) {
        visit::uses(inst, &mut |v| *v = self.get(*v));
    }

    /// Replaces in some blocks.
    pub fn blocks(&self, func: &mut Func, blocks: &[BlockId]) {
        for id in blocks {
            let block = &mut func.blocks[*id];
            block.insts.iter_mut().for_each(|inst| self.inst(inst));
            visit::term_uses(&mut block.term, &mut |v| *v = self.get(*v));
        }
    }

    /// Replaces everywhere.
    pub fn apply(&self, func: &mut Func) {
        for block in &mut func.blocks {
            block.insts.iter_mut().for_each(|inst| self.inst(inst));
            visit::term_uses(&mut block.term, &mut |v| *v = self.get(*v));
        }
    }
}

/// How often each value is read.
pub fn use_counts(func: &Func) -> IndexVec<ValueId, u32> {
    let mut counts: IndexVec<ValueId, u32> = IndexVec::from_vec(vec![0; func.values.len()]);
    for block in &func.blocks {
        block.insts.iter().for_each(|inst| inst.for_each_use(|v| counts[v] += 1));
        block.term.for_each_use(|v| counts[v] += 1);
    }
    counts
}

/// Whether an instruction may be left out when nobody reads its results: it writes no memory and cannot fault.
pub fn is_pure(inst: &Inst) -> bool {
    matches!(
        inst,
        Inst::Const { .. } | Inst::Prim { .. } | Inst::Load { .. } | Inst::AddressOf { .. } | Inst::CallRt { .. }
    )
}

/// Whether an instruction may write memory that others see; what a fault owes is not its business.
pub fn writes_memory(inst: &Inst) -> bool {
    matches!(
        inst,
        Inst::Store { .. } | Inst::Copy { .. } | Inst::Zero { .. } | Inst::Call { .. } | Inst::CallText { .. }
    )
}

/// The register values of those values that are constants.
pub struct Constants(IndexVec<ValueId, Option<u64>>);

impl Constants {
    /// Of a function as it is now.
    pub fn new(func: &Func) -> Self {
        let mut raws = IndexVec::from_vec(vec![None; func.values.len()]);
        for inst in func.blocks.iter().flat_map(|b| &b.insts) {
            if let Inst::Const { dst, raw } = inst {
                raws[*dst] = Some(*raw);
            }
        }
        Self(raws)
    }

    /// Another one, which was made since.
    pub fn note(&mut self, value: ValueId, raw: u64) {
        while self.0.len() <= value.index() {
            self.0.push(None);
        }
        self.0[value] = Some(raw);
    }

    /// The register value, if it is one.
    pub fn get(&self, value: ValueId) -> Option<u64> {
        self.0.get(value).copied().flatten()
    }
}

/// Leaves out blocks that the entry does not reach, puts the others into reverse post-order and numbers blocks and values
/// without gaps.
pub fn compact(func: &mut Func) {
    let order = reverse_postorder(func);
    let mut number: IndexVec<BlockId, Option<BlockId>> = IndexVec::from_vec(vec![None; func.blocks.len()]);
    for (n, block) in order.iter().enumerate() {
        number[*block] = Some(BlockId::from_usize(n));
    }
    let mut old: Vec<Option<crate::ir::Block>> = std::mem::take(&mut func.blocks).into_iter().map(Some).collect();
    func.blocks = order.iter().filter_map(|block| old[block.index()].take()).collect();
    let mut values = IndexVec::new();
    let mut new: IndexVec<ValueId, Option<ValueId>> = IndexVec::from_vec(vec![None; func.values.len()]);
    for block in &mut func.blocks {
        let mut define = |v: &mut ValueId| {
            let fresh = values.push(func.values[*v]);
            new[*v] = Some(fresh);
            *v = fresh;
        };
        block.params.iter_mut().for_each(&mut define);
        block.insts.iter_mut().for_each(|inst| visit::defs(inst, &mut define));
    }
    let name = &func.name;
    let renumber = |v: &mut ValueId| match new[*v] {
        Some(fresh) => *v = fresh,
        None => plcc_diag::bug!("`{name}`: v{} is read but not defined", v.index()),
    };
    for block in &mut func.blocks {
        block.insts.iter_mut().for_each(|inst| visit::uses(inst, &mut |v| renumber(v)));
        visit::term_uses(&mut block.term, &mut |v| renumber(v));
        visit::targets(&mut block.term, &mut |target| {
            target.block = number[target.block].unwrap_or_else(|| plcc_diag::bug!("a reachable block was dropped"));
        });
    }
    func.values = values;
}

/// What holds at the end of all predecessors of a block; nothing where one of them had not its turn yet, a way backwards.
pub fn common<T: Clone>(
    preds: &[BlockId],
    ends: &IndexVec<BlockId, Option<Vec<T>>>,
    same: impl Fn(&T, &T) -> bool,
) -> Vec<T> {
    let Some((first, rest)) = preds.split_first() else { return Vec::new() };
    let Some(mut facts) = ends[*first].clone() else { return Vec::new() };
    for pred in rest {
        match &ends[*pred] {
            Some(other) => facts.retain(|fact| other.iter().any(|o| same(fact, o))),
            None => return Vec::new(),
        }
    }
    facts
}

/// A jump without arguments.
pub fn to(block: BlockId) -> Target {
    Target { block, args: Vec::new() }
}
