//! Finds instructions in a row that do the same to neighbours, so that one instruction on a register of 16 bytes does all.
//!
//! In: a function, in which the optimiser put such work side by side (`mir::opt`, `jam`). Out: packs, in which each value has
//! a lane. Nothing is moved: the members of a pack stand one after the other. Loads and stores are packs if they touch
//! neighbours in memory, operations if their operands are packs, the same value for all, or constants; parameters of a block
//! if all that is given to them is. A pack of which single values are needed where it is made is none, and neither are packs
//! without an operation and a store: plain moves may meet what was just stored in pieces.

use index_vec::IndexVec;
use plcc_mir::dominators::Dominators;
use plcc_mir::ir::{Block, BlockId, Func, Inst, Place, Term, ValueId};
use plcc_mir::lanes;
use plcc_stdlib::prim::{PrimOp, Repr};
use rustc_hash::{FxHashMap, FxHashSet};

/// Rounds until nothing changes; if more are needed, there are no packs.
const ROUNDS: usize = 12;

/// What the lanes of an operand are.
#[derive(Debug, Clone)]
pub enum Operand {
    /// A pack, by its number.
    Pack(usize),
    /// The same value in each.
    Same(ValueId),
    /// Constants, their register values.
    Constants(Vec<u64>),
}

/// What a pack does.
#[derive(Debug, Clone)]
pub enum Work {
    /// Reads neighbours, the first of them here.
    Load(Place),
    /// An operation on this representation.
    Prim(PrimOp, Repr),
    /// Writes neighbours, the first of them here.
    Store(Place),
    /// Parameters of a block from this one on.
    Params(BlockId, usize),
}

/// Instructions, or parameters of a block, that are done as one.
#[derive(Debug, Clone)]
pub struct Pack {
    /// What it does.
    pub work: Work,
    /// The operands.
    pub operands: Vec<Operand>,
    /// The representation of its values; that of the operands of a comparison, whose results are masks of their width.
    pub repr: Repr,
    /// Its values; none of a store.
    pub values: Vec<ValueId>,
    /// Whether its values are truth values.
    mask: bool,
    block: BlockId,
    alive: bool,
}

/// The packs of a function.
#[derive(Debug, Default)]
pub struct Packs {
    list: Vec<Pack>,
    /// Pack and lane of each value that has one.
    of_value: FxHashMap<ValueId, (usize, usize)>,
    /// The pack of each instruction that has one, and whether it is the last of it.
    of_inst: FxHashMap<(BlockId, usize), (usize, bool)>,
    /// The values that fill a register.
    filling: FxHashSet<ValueId>,
}

impl Packs {
    /// Of a function for a machine that has such registers.
    pub fn find(func: &Func, tree: &Dominators) -> Self {
        let has_stores = tree.order.iter().any(|block| {
            let insts = &func.blocks[*block].insts;
            (0..insts.len()).any(|at| stores(func, insts, at).is_some())
        });
        if !has_stores {
            return Self::default();
        }
        let mut search = Search::new(func);
        for block in &tree.order {
            search.block(*block);
        }
        search.params_fit();
        search.settle(tree);
        search.done()
    }

    /// The pack and the lane of a value.
    pub fn lane(&self, value: ValueId) -> Option<(usize, usize)> {
        self.of_value.get(&value).copied()
    }

    /// The pack of an instruction, and whether it is its last one.
    pub fn at(&self, block: BlockId, at: usize) -> Option<(usize, bool)> {
        self.of_inst.get(&(block, at)).copied()
    }

    /// A pack.
    pub fn pack(&self, number: usize) -> &Pack {
        &self.list[number]
    }

    /// Whether a value fills a register somewhere.
    pub fn fills(&self, value: ValueId) -> bool {
        self.filling.contains(&value)
    }
}

/// The positions of so many instructions from one on, but for constants between them.
fn in_a_row(insts: &[Inst], at: usize, count: usize) -> Option<Vec<usize>> {
    let rest = (at..insts.len()).filter(|n| !matches!(insts[*n], Inst::Const { .. }));
    let list: Vec<usize> = rest.take(count).collect();
    (list.len() == count).then_some(list)
}

/// The positions of stores to neighbours that fill a register.
fn stores(func: &Func, insts: &[Inst], at: usize) -> Option<Vec<usize>> {
    let Inst::Store { place: first, value } = &insts[at] else { return None };
    let repr = func.values[*value];
    let list = in_a_row(insts, at, lanes::count(repr)?)?;
    let fits = list.iter().enumerate().all(|(lane, n)| match &insts[*n] {
        Inst::Store { place, value } => func.values[*value] == repr && first.goes_on(lane as u32 * repr.bytes(), place),
        _ => false,
    });
    fits.then_some(list)
}

struct Search<'a> {
    func: &'a Func,
    constants: IndexVec<ValueId, Option<u64>>,
    /// Block and number of each parameter.
    params: FxHashMap<ValueId, (BlockId, usize)>,
    packs: Packs,
}

impl<'a> Search<'a> {
    fn new(func: &'a Func) -> Self {
        let mut constants = IndexVec::from_vec(vec![None; func.values.len()]);
        let mut params = FxHashMap::default();
        for (id, block) in func.blocks.iter_enumerated() {
            for inst in &block.insts {
                if let Inst::Const { dst, raw } = inst {
                    constants[*dst] = Some(*raw);
                }
            }
            // The parameters of the function come as they are.
            if id.index() > 0 {
                params.extend(block.params.iter().enumerate().map(|(n, param)| (*param, (id, n))));
            }
        }
        Self { func, constants, params, packs: Packs::default() }
    }

    fn block(&mut self, id: BlockId) {
        let insts = &self.func.blocks[id].insts;
        let mut at = 0;
        while at < insts.len() {
            at = match self.pack_at(id, insts, at) {
                Some(next) => next,
                None => at + 1,
            };
        }
    }

    /// Makes a pack of an instruction and those behind it; gives what comes next.
    fn pack_at(&mut self, id: BlockId, insts: &[Inst], at: usize) -> Option<usize> {
        let func = self.func;
        let (list, work, operands, repr, mask) = match &insts[at] {
            Inst::Store { place, value } => {
                let list = stores(func, insts, at)?;
                let values: Vec<ValueId> = list.iter().filter_map(|n| stored(&insts[*n])).collect();
                if values.iter().all(|value| self.constants[*value].is_some()) {
                    return None;
                }
                let operand = self.operand(&values)?;
                (list, Work::Store(place.clone()), vec![operand], func.values[*value], false)
            }
            Inst::Load { dst, place: first, .. } => {
                let repr = func.values[*dst];
                let list = in_a_row(insts, at, lanes::count(repr)?)?;
                let fits = list.iter().enumerate().all(|(lane, n)| match &insts[*n] {
                    Inst::Load { dst, place, normalise: false } => {
                        func.values[*dst] == repr && first.goes_on(lane as u32 * repr.bytes(), place)
                    }
                    _ => false,
                });
                if !fits {
                    return None;
                }
                (list, Work::Load(first.clone()), Vec::new(), repr, false)
            }
            Inst::Prim { .. } => self.prims(insts, at)?,
            _ => return None,
        };
        let number = self.packs.list.len();
        let values: Vec<ValueId> = list.iter().filter_map(|n| insts[*n].results().0).collect();
        let last = *list.last()?;
        for n in list {
            self.packs.of_inst.insert((id, n), (number, n == last));
        }
        self.add(Pack { work, operands, repr, values, mask, block: id, alive: true });
        Some(last + 1)
    }

    fn add(&mut self, pack: Pack) {
        let number = self.packs.list.len();
        for (lane, value) in pack.values.iter().enumerate() {
            self.packs.of_value.insert(*value, (number, lane));
        }
        self.packs.list.push(pack);
    }

    #[allow(clippy::type_complexity)]
    fn prims(&mut self, insts: &[Inst], at: usize) -> Option<(Vec<usize>, Work, Vec<Operand>, Repr, bool)> {
        let Inst::Prim { op, repr, args, .. } = &insts[at] else { return None };
        let joined = args.first().and_then(|arg| self.packs.of_value.get(arg)).map(|(pack, _)| *pack);
        // Truth values are as wide as what was compared.
        let width = if lanes::joins_masks(*op, *repr) { self.packs.list[joined?].repr } else { *repr };
        let masks_join = width != *repr;
        let gives = if masks_join { lanes::Gives::Mask } else { lanes::operation(*op, *repr)? };
        let list = in_a_row(insts, at, lanes::count(width)?)?;
        let mut columns: Vec<Vec<ValueId>> = vec![Vec::with_capacity(list.len()); args.len()];
        for n in &list {
            let Inst::Prim { op: other, repr: other_repr, args: own, .. } = &insts[*n] else { return None };
            if (other, other_repr) != (op, repr) {
                return None;
            }
            let lane = columns[0].len();
            let swapped = lane > 0
                && commutes(*op)
                && !(self.goes_on(&columns[0], own[0]) && self.goes_on(&columns[1], own[1]))
                && self.goes_on(&columns[0], own[1])
                && self.goes_on(&columns[1], own[0]);
            for (n, column) in columns.iter_mut().enumerate() {
                column.push(own[if swapped { 1 - n } else { n }]);
            }
        }
        let operands: Vec<Operand> = columns.iter().map(|column| self.operand(column)).collect::<Option<_>>()?;
        let packs: Vec<usize> = operands
            .iter()
            .filter_map(|operand| match operand {
                Operand::Pack(number) => Some(*number),
                _ => None,
            })
            .collect();
        let is_mask = |operand: &Operand| match operand {
            Operand::Pack(number) => self.packs.list[*number].mask,
            _ => false,
        };
        // Masks meet masks and choose; nothing else reads them.
        let fits = match op {
            PrimOp::Select => is_mask(&operands[0]) && !operands[1..].iter().any(is_mask),
            _ if masks_join => operands.iter().all(is_mask),
            _ => !operands.iter().any(is_mask),
        };
        let same_width = packs.iter().all(|number| self.packs.list[*number].repr.bytes() == width.bytes());
        if packs.is_empty() || !fits || !same_width {
            return None;
        }
        Some((list, Work::Prim(*op, *repr), operands, width, gives == lanes::Gives::Mask))
    }

    /// Whether a value can be the next one of an operand.
    fn goes_on(&self, column: &[ValueId], value: ValueId) -> bool {
        let first = column[0];
        let lane = column.len();
        if first == value || self.constants[first].is_some() && self.constants[value].is_some() {
            return true;
        }
        let of = |value: ValueId| self.packs.of_value.get(&value).copied();
        let params = |value: ValueId| self.params.get(&value).copied();
        match (of(first), of(value)) {
            (Some((pack, 0)), Some((other, n))) => pack == other && n == lane,
            (None, None) => match (params(first), params(value)) {
                (Some((block, n)), Some((other, m))) => block == other && m == n + lane,
                _ => false,
            },
            _ => false,
        }
    }

    fn operand(&mut self, values: &[ValueId]) -> Option<Operand> {
        let first = values[0];
        if values.iter().all(|value| *value == first) {
            return Some(Operand::Same(first));
        }
        if let Some((pack, 0)) = self.packs.of_value.get(&first) {
            let pack = *pack;
            return (self.packs.list[pack].values == values).then_some(Operand::Pack(pack));
        }
        if let Some(raws) = values.iter().map(|value| self.constants[*value]).collect::<Option<Vec<u64>>>() {
            return Some(Operand::Constants(raws));
        }
        // Parameters in a row are taken for a pack; what is given to them is looked at later.
        let (block, n) = *self.params.get(&first)?;
        let repr = self.func.values[first];
        let params = self.func.blocks[block].params.get(n..n + values.len())?;
        let free = params.iter().all(|param| !self.packs.of_value.contains_key(param));
        if params != values || !free || lanes::count(repr) != Some(values.len()) {
            return None;
        }
        let work = Work::Params(block, n);
        let number = self.packs.list.len();
        let values = values.to_vec();
        self.add(Pack { work, operands: Vec::new(), repr, values, mask: false, block, alive: true });
        Some(Operand::Pack(number))
    }

    /// Adds what is given to parameters to their operands. What is given may be parameters in a row again.
    fn params_fit(&mut self) {
        let mut number = 0;
        while number < self.packs.list.len() {
            if let Work::Params(block, n) = self.packs.list[number].work {
                let count = self.packs.list[number].values.len();
                let mut given: Vec<Vec<ValueId>> = Vec::new();
                for other in &self.func.blocks {
                    other.term.for_each_target(|target| {
                        if target.block == block {
                            given.push(target.args[n..n + count].to_vec());
                        }
                    });
                }
                for values in given {
                    match self.operand(&values) {
                        Some(operand) => self.packs.list[number].operands.push(operand),
                        None => self.packs.list[number].alive = false,
                    }
                }
            }
            number += 1;
        }
    }

    /// Takes packs back until all that are left fit together.
    fn settle(&mut self, tree: &Dominators) {
        for _ in 0..ROUNDS {
            let mut changed = self.drop_operands();
            for block in tree.order.iter().rev() {
                changed |= self.drop_read(*block);
            }
            if !changed && !self.drop_useless() {
                return;
            }
        }
        self.packs.list.iter_mut().for_each(|pack| pack.alive = false);
    }

    fn drop_operands(&mut self) -> bool {
        let mut changed = false;
        for number in 0..self.packs.list.len() {
            let pack = &self.packs.list[number];
            let dead = |operand: &Operand| matches!(operand, Operand::Pack(other) if !self.packs.list[*other].alive);
            if pack.alive && pack.operands.iter().any(dead) {
                self.packs.list[number].alive = false;
                changed = true;
            }
        }
        changed
    }

    /// Drops packs of which a block needs single values: such as are made there, and masks.
    fn drop_read(&mut self, id: BlockId) -> bool {
        let block: &Block = &self.func.blocks[id];
        let mut changed = false;
        let packs = &mut self.packs;
        let mut read = |list: &mut Vec<Pack>, value: ValueId, at_the_end: bool| {
            if let Some((number, _)) = packs.of_value.get(&value) {
                let pack = &mut list[*number];
                if pack.alive && (pack.mask || pack.block == id && !at_the_end) {
                    pack.alive = false;
                    changed = true;
                }
            }
        };
        let mut list = std::mem::take(&mut packs.list);
        match &block.term {
            Term::Branch { cond: value, .. } | Term::Switch { value, .. } | Term::Return(Some(value)) => {
                read(&mut list, *value, false);
            }
            Term::Jump(_) | Term::Return(None) => {}
        }
        block.term.for_each_target(|target| {
            for (arg, param) in target.args.iter().zip(&self.func.blocks[target.block].params) {
                let packed = packs.of_value.get(param).is_some_and(|(number, _)| list[*number].alive);
                if !packed {
                    read(&mut list, *arg, true);
                }
            }
        });
        for (at, inst) in block.insts.iter().enumerate().rev() {
            if packs.of_inst.get(&(id, at)).is_some_and(|(number, _)| list[*number].alive) {
                continue;
            }
            // What a poll owes is taken out of its register when it leaves.
            let at_the_end = matches!(inst, Inst::Poll { .. });
            inst.for_each_use(|value| read(&mut list, value, at_the_end));
        }
        packs.list = list;
        changed
    }

    /// Drops packs that are connected with no operation or no store.
    fn drop_useless(&mut self) -> bool {
        let list = &mut self.packs.list;
        let mut group: Vec<usize> = (0..list.len()).collect();
        fn root(group: &mut [usize], mut n: usize) -> usize {
            while group[n] != n {
                group[n] = group[group[n]];
                n = group[n];
            }
            n
        }
        for (number, pack) in list.iter().enumerate().filter(|(_, pack)| pack.alive) {
            for operand in &pack.operands {
                if let Operand::Pack(other) = operand {
                    let (a, b) = (root(&mut group, number), root(&mut group, *other));
                    group[a] = b;
                }
            }
        }
        let (mut works, mut stores) = (vec![false; list.len()], vec![false; list.len()]);
        for (number, pack) in list.iter().enumerate().filter(|(_, pack)| pack.alive) {
            let at = root(&mut group, number);
            works[at] |= matches!(pack.work, Work::Prim(..));
            stores[at] |= matches!(pack.work, Work::Store(_));
        }
        let mut changed = false;
        for (number, pack) in list.iter_mut().enumerate() {
            let at = root(&mut group, number);
            if pack.alive && !(works[at] && stores[at]) {
                pack.alive = false;
                changed = true;
            }
        }
        changed
    }

    fn done(self) -> Packs {
        let mut packs = self.packs;
        let list = &packs.list;
        packs.of_value.retain(|_, (number, _)| list[*number].alive);
        packs.of_inst.retain(|_, (number, _)| list[*number].alive);
        for operand in list.iter().filter(|pack| pack.alive).flat_map(|pack| &pack.operands) {
            if let Operand::Same(value) = operand {
                packs.filling.insert(*value);
            }
        }
        packs
    }
}

fn stored(inst: &Inst) -> Option<ValueId> {
    match inst {
        Inst::Store { value, .. } => Some(*value),
        _ => None,
    }
}

fn commutes(op: PrimOp) -> bool {
    use PrimOp::*;
    matches!(op, Add | Mul | And | Or | Xor | FAdd | FMul | Eq | Ne | FEq | FNe | MinS | MaxS | MinU | MaxU)
}
