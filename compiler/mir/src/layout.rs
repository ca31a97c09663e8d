//! Lays out every variable of a resource in one flat memory region.
//!
//! In: declarations, the resource, and which POUs its code reaches. Out: [`Layout`], the offset of every variable,
//! instance, I/O area and retain range. Initial values are not its business: see `lower::init`.
//!
//! ```text
//! header | %I | %Q | %M | globals | program instances | addressable part | constants | frames
//! ```
//! An area with a variable whose address is taken lies in the addressable part. Constants (initial data of function
//! locals) follow the variables, and frames come last, because both are known only when the code is: no offset of a
//! variable depends on them.
//!
//! A PROGRAM with variables whose address is taken is split (semantics.md \[R2\]): these lie in the addressable part, at
//! the same distance from the first byte for each instance, so that the body reaches both with constant offsets.

mod fixed;
mod retain;

use crate::lower::reach::Reach;
use index_vec::IndexVec;
use plcc_diag::Span;
use plcc_hir::app::Resource;
use plcc_hir::elem_of;
use plcc_hir::shape::{Shape, Shapes, address_taken, in_instance};
use plcc_hir::{Area, Defs, PouId, PouKind, Section, StructId, Type, TypeId, Var, VarId};
use plcc_stdlib::elem::Elem;
use plcc_stdlib::region::HEADER_BYTES;
use rustc_hash::FxHashMap;

/// Largest region, bytes.
pub const MAX_REGION_BYTES: u64 = 1 << 31;

/// The variables of an application do not fit into the region (diagnostic E0312).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TooLarge {
    /// The variable with which it happened, or what else it is.
    pub what: String,
    /// Bytes needed up to there; at least so many.
    pub bytes: u64,
    /// Its declaration.
    pub span: Option<Span>,
}

/// Where a variable lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slot {
    /// In the region; a bit of that byte for a packed BOOL.
    Region(u32, Option<u8>),
    /// In each instance of its POU, from the instance's first byte on.
    Instance(u32),
    /// In the frame of its function; a VAR_TEMP: in that of the body that uses it.
    Frame(u32),
}

/// A value at an address: of a variable `AT`, or used directly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Unit {
    /// Index of the area.
    pub area: usize,
    /// First byte in the area.
    pub byte: u32,
    /// Bytes of one value; 0 for a bit.
    pub bytes: u32,
    /// How many values lie one behind the other.
    pub count: u32,
}

/// A range of the region.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Range {
    /// First byte.
    pub start: u32,
    /// Bytes.
    pub bytes: u32,
}

impl Range {
    /// One past the last byte.
    pub fn end(self) -> u32 {
        self.start + self.bytes
    }
}

/// The offset of every variable.
#[derive(Debug, Clone, Default)]
pub struct Layout {
    /// Sizes of types and offsets of components.
    pub shapes: Shapes,
    /// By variable; `None` for those that nothing reaches.
    slots: IndexVec<VarId, Option<Slot>>,
    /// Bytes of the frame of a function, or of the VAR_TEMPs of a POU.
    frames: IndexVec<PouId, u32>,
    /// Function blocks of which an instance lies in the addressable part.
    exposed: IndexVec<PouId, bool>,
    /// First byte of each program instance of the resource.
    programs: Vec<u32>,
    areas: [Range; 3],
    /// What is located or used directly, as the program reads and writes it.
    pub units: Vec<Unit>,
    /// The part of the region that references may reach.
    pub addressable: Range,
    /// Bytes may be read under another type than they were written: by a reference, a union, an overlapping address.
    pub aliasing: bool,
    /// Where constants start; how many bytes they take is known when the code is.
    pub constants: Range,
    /// The frames of tasks.
    pub frame: Range,
    /// Size of the region.
    pub region_bytes: u32,
    /// Byte ranges (start, length) that a warm start keeps; sorted, disjoint.
    pub retain: Vec<(u32, u32)>,
}

impl Layout {
    /// Lays out the variables of a resource. Constants and frames are added with [`Layout::close`].
    pub(crate) fn new(defs: &Defs, resource: &Resource, reach: &Reach) -> Result<Self, TooLarge> {
        let mut placer = Placer {
            defs,
            layout: Layout {
                shapes: Shapes::new(defs),
                slots: defs.vars.iter().map(|_| None).collect(),
                frames: defs.pous.iter().map(|_| 0).collect(),
                exposed: defs.pous.iter().map(|_| false).collect(),
                programs: vec![0; resource.programs.len()],
                ..Layout::default()
            },
            cursor: u64::from(HEADER_BYTES),
            statics: Vec::new(),
        };
        placer.frames(reach)?;
        let located = placer.areas(reach)?;
        placer.place_areas(&located, false)?;
        placer.globals(false)?;
        let split = placer.programs(resource)?;
        placer.align(16)?;
        let start = placer.offset();
        placer.place_areas(&located, true)?;
        placer.globals(true)?;
        placer.split_programs(&split)?;
        placer.statics()?;
        placer.layout.addressable = Range { start, bytes: placer.offset() - start };
        placer.located(&located);
        placer.align(16)?;
        let mut layout = placer.layout;
        layout.units.clone_from(&located.units);
        layout.constants = Range { start: placer.cursor as u32, bytes: 0 };
        layout.aliasing = layout.addressable.bytes > 0
            || defs.structs.iter().any(|s| s.union)
            || located.vars.iter().any(|v| overlaps(defs, &defs.vars[*v]));
        layout.expose(defs);
        layout.retain = retain::ranges(defs, &layout, resource);
        Ok(layout)
    }

    /// Adds the constants and the frames.
    pub(crate) fn close(&mut self, constant_bytes: u64, frame_bytes: u64) -> Result<(), TooLarge> {
        let check = |bytes: u64, what: &str| {
            if bytes > MAX_REGION_BYTES {
                Err(TooLarge { what: what.to_string(), bytes, span: None })
            } else {
                Ok(bytes as u32)
            }
        };
        let frame = u64::from(self.constants.start) + constant_bytes.next_multiple_of(16);
        self.frame.start = check(frame, "the initial values of function variables")?;
        self.constants.bytes = constant_bytes as u32;
        self.region_bytes = check(frame + frame_bytes, "the variables of functions")?;
        self.frame.bytes = frame_bytes as u32;
        Ok(())
    }

    // ---- queries ----

    /// Where a variable lies; `None` if no code that was laid out reaches it.
    pub fn slot(&self, var: VarId) -> Option<Slot> {
        self.slots[var]
    }

    /// The region offset (and bit) of a variable; for one of a POU, `instance` is the offset of its instance. `None` for
    /// variables in frames.
    pub fn offset(&self, var: VarId, instance: u32) -> Option<(u32, Option<u8>)> {
        match self.slots[var]? {
            Slot::Region(offset, bit) => Some((offset, bit)),
            Slot::Instance(offset) => Some((instance + offset, None)),
            Slot::Frame(_) => None,
        }
    }

    /// First byte of a program instance (index in [`Resource::programs`]).
    pub fn program(&self, index: usize) -> u32 {
        self.programs[index]
    }

    /// An area of located variables; it ends behind the last byte that is used, rounded up to 8.
    pub fn area(&self, area: Area) -> Range {
        self.areas[area as usize]
    }

    /// Size of a type in bytes. (Of a type that is only pointed to it may exceed any region: it saturates.)
    pub fn size(&self, defs: &Defs, ty: TypeId) -> u32 {
        u32::try_from(self.shapes.of(defs, ty).bytes).unwrap_or(u32::MAX)
    }

    /// The offset of a field of a structure.
    pub fn field(&self, id: StructId, index: u32) -> u32 {
        u32::try_from(self.shapes.field(id, index)).unwrap_or(u32::MAX)
    }

    /// Bytes of the frame that a function's variables take, or the VAR_TEMPs of a POU.
    pub(crate) fn frame_bytes(&self, pou: PouId) -> u32 {
        self.frames[pou]
    }

    /// Whether an instance of this function block lies in the addressable part.
    pub fn exposed(&self, pou: PouId) -> bool {
        self.exposed[pou]
    }

    /// Whether a variable, with its outermost variable, lies in the addressable part by itself: its address is taken, or
    /// that of a variable in an instance that it contains.
    pub fn is_addressable(&self, defs: &Defs, var: VarId) -> bool {
        let var = &defs.vars[var];
        address_taken(var) || (var.section != Section::InOut && self.shapes.of(defs, var.ty).address_taken)
    }

    /// Marks the function blocks of which an instance lies in the addressable part.
    fn expose(&mut self, defs: &Defs) {
        let mut structs: IndexVec<StructId, bool> = defs.structs.iter().map(|_| false).collect();
        let mut work: Vec<TypeId> =
            defs.vars.indices().filter(|v| self.is_addressable(defs, *v)).map(|v| defs.vars[v].ty).collect();
        while let Some(ty) = work.pop() {
            match &defs.types[ty] {
                Type::Array { elem, .. } => work.push(*elem),
                Type::Struct(id) if !std::mem::replace(&mut structs[*id], true) => {
                    work.extend(defs.structs[*id].fields.iter().map(|f| f.ty));
                }
                Type::Instance(id) if !std::mem::replace(&mut self.exposed[*id], true) => {
                    work.extend(
                        defs.pous[*id].vars.iter().map(|v| &defs.vars[*v]).filter(|v| in_instance(v)).map(|v| v.ty),
                    );
                }
                _ => {}
            }
        }
    }
}

/// Whether a located variable may show bytes as BOOL that others at its address wrote as numbers.
fn overlaps(defs: &Defs, var: &Var) -> bool {
    let scalar = elem_of(defs, var.ty);
    var.address.is_some_and(|a| a.bit.is_none()) && (scalar.is_none() || scalar == Some(Elem::Bool))
}

/// The located variables.
struct Located {
    vars: Vec<VarId>,
    /// Bytes and whether an address in it is taken, by area.
    extents: [(u64, bool); 3],
    units: Vec<Unit>,
}

/// A PROGRAM with instances, of which some variables lie in the addressable part.
struct Split {
    pou: PouId,
    instances: u64,
    /// First byte of the first instance; from one to the next.
    start: u64,
    stride: u64,
    addressable_bytes: u64,
}

struct Placer<'a> {
    defs: &'a Defs,
    layout: Layout,
    cursor: u64,
    /// Variables of functions and VAR_TEMPs whose address is taken: without recursion one place is enough.
    statics: Vec<VarId>,
}

impl Placer<'_> {
    fn too_large(&self, var: VarId, bytes: u64) -> TooLarge {
        let var = &self.defs.vars[var];
        TooLarge { what: format!("variable `{}`", var.name), bytes, span: Some(var.span) }
    }

    fn offset(&self) -> u32 {
        self.cursor as u32
    }

    fn align(&mut self, to: u64) -> Result<(), TooLarge> {
        self.cursor = self.cursor.next_multiple_of(to);
        if self.cursor > MAX_REGION_BYTES {
            return Err(TooLarge { what: "the application".to_string(), bytes: self.cursor, span: None });
        }
        Ok(())
    }

    /// Places a variable at the cursor.
    fn place(&mut self, var: VarId) -> Result<(), TooLarge> {
        let shape = self.layout.shapes.of_var(self.defs, &self.defs.vars[var]);
        let start = self.cursor.next_multiple_of(shape.align);
        if start + shape.bytes > MAX_REGION_BYTES {
            return Err(self.too_large(var, start + shape.bytes));
        }
        self.cursor = start + shape.bytes;
        self.layout.slots[var] = Some(Slot::Region(start as u32, None));
        Ok(())
    }

    /// Variables of functions and VAR_TEMPs.
    fn frames(&mut self, reach: &Reach) -> Result<(), TooLarge> {
        for &pou in &reach.pous {
            let mut frame = Shape::default();
            for &id in &self.defs.pous[pou].vars {
                let var = &self.defs.vars[id];
                let function = self.defs.pous[pou].kind == PouKind::Function;
                if (!function && var.section != Section::Temp) || var.address.is_some() {
                    continue;
                }
                if self.layout.is_addressable(self.defs, id) {
                    self.statics.push(id);
                    continue;
                }
                let offset = frame.push(self.layout.shapes.of_var(self.defs, var));
                if frame.bytes > MAX_REGION_BYTES {
                    return Err(self.too_large(id, frame.bytes));
                }
                self.layout.slots[id] = Some(Slot::Frame(offset as u32));
            }
            self.layout.frames[pou] = frame.bytes as u32;
        }
        Ok(())
    }

    /// Located variables and how far the areas reach.
    fn areas(&mut self, reach: &Reach) -> Result<Located, TooLarge> {
        let vars: Vec<VarId> = self.defs.vars.indices().filter(|v| self.defs.vars[*v].address.is_some()).collect();
        let mut extents = [(0, false); 3];
        let declared = vars.iter().filter_map(|id| {
            let var = &self.defs.vars[*id];
            let bytes = self.layout.shapes.of(self.defs, var.ty).bytes;
            var.address.map(|a| (a, bytes, self.layout.is_addressable(self.defs, *id), Some(*id), var.ty))
        });
        let mut units = Vec::new();
        let direct = reach
            .addresses
            .iter()
            .map(|a| (a.address, self.layout.shapes.of(self.defs, a.ty).bytes, a.taken, None, a.ty));
        for (address, bytes, taken, var, ty) in declared.chain(direct) {
            let bytes = if address.bit.is_some() { 1 } else { bytes };
            let end = u64::from(address.byte) + bytes;
            if end > MAX_REGION_BYTES {
                return Err(match var {
                    Some(var) => self.too_large(var, end),
                    None => TooLarge { what: "a directly used address".to_string(), bytes: end, span: None },
                });
            }
            let area = address.area as usize;
            if address.bit.is_some() {
                units.push(Unit { area, byte: address.byte, bytes: 0, count: 1 });
            } else {
                self.units_of(area, address.byte, ty, &mut units);
            }
            let extent = &mut extents[area];
            extent.0 = extent.0.max(end.next_multiple_of(8));
            extent.1 |= taken;
        }
        units.sort_unstable();
        units.dedup();
        Ok(Located { vars, extents, units })
    }

    /// The values that a located variable consists of.
    fn units_of(&self, area: usize, byte: u32, ty: TypeId, units: &mut Vec<Unit>) {
        crate::resources::values(self.defs, &self.layout.shapes, ty, byte, &mut |byte, bytes, count| {
            units.push(Unit { area, byte, bytes, count });
        });
    }

    fn place_areas(&mut self, located: &Located, addressable: bool) -> Result<(), TooLarge> {
        for (n, (bytes, taken)) in located.extents.iter().enumerate() {
            if *taken == addressable {
                self.align(8)?;
                let start = self.offset();
                self.cursor += bytes;
                self.align(8)?;
                self.layout.areas[n] = Range { start, bytes: *bytes as u32 };
            }
        }
        Ok(())
    }

    /// Slots of located variables: the areas have their places.
    fn located(&mut self, located: &Located) {
        for &var in &located.vars {
            if let Some(address) = self.defs.vars[var].address {
                let start = self.layout.areas[address.area as usize].start;
                self.layout.slots[var] = Some(Slot::Region(start + address.byte, address.bit));
            }
        }
    }

    fn globals(&mut self, addressable: bool) -> Result<(), TooLarge> {
        let defs = self.defs;
        for &var in &defs.globals {
            if defs.vars[var].address.is_none() && self.layout.is_addressable(defs, var) == addressable {
                self.place(var)?;
            }
        }
        Ok(())
    }

    /// Instances of programs, and the slots of the variables of all POUs that have instances.
    fn programs(&mut self, resource: &Resource) -> Result<Vec<Split>, TooLarge> {
        let mut splits: Vec<Split> = Vec::new();
        let mut by_pou: FxHashMap<PouId, Vec<usize>> = FxHashMap::default();
        for (n, program) in resource.programs.iter().enumerate() {
            by_pou.entry(program.pou).or_default().push(n);
        }
        for (pou, def) in self.defs.pous.iter_enumerated() {
            match def.kind {
                PouKind::FunctionBlock => {
                    for &var in &def.vars {
                        if let Some(offset) = self.layout.shapes.member(var) {
                            // A size over 2^32 stops where the instance is placed.
                            self.layout.slots[var] = Some(Slot::Instance(u32::try_from(offset).unwrap_or(u32::MAX)));
                        }
                    }
                }
                PouKind::Program => splits.push(self.program_slots(pou)?),
                PouKind::Function | PouKind::Action => {}
            }
        }
        // In the order of the first instance of each.
        splits.sort_by_key(|s| by_pou.get(&s.pou).map_or(usize::MAX, |list| list[0]));
        for split in &mut splits {
            let Some(list) = by_pou.get(&split.pou) else { continue };
            self.align(16)?;
            split.start = self.cursor;
            split.instances = list.len() as u64;
            for (k, n) in list.iter().enumerate() {
                self.layout.programs[*n] = (split.start + k as u64 * split.stride) as u32;
                self.cursor += split.stride;
                if self.cursor > MAX_REGION_BYTES {
                    let program = &resource.programs[*n];
                    let what = format!("program `{}`", program.name);
                    return Err(TooLarge { what, bytes: self.cursor, span: Some(program.span) });
                }
            }
        }
        Ok(splits)
    }

    /// Offsets in an instance; those in the addressable part count from its start there until it has a place.
    fn program_slots(&mut self, pou: PouId) -> Result<Split, TooLarge> {
        let mut parts = [Shape::default(), Shape::default()];
        for &id in &self.defs.pous[pou].vars {
            let var = &self.defs.vars[id];
            if in_instance(var) {
                let part = &mut parts[usize::from(self.layout.is_addressable(self.defs, id))];
                let offset = part.push(self.layout.shapes.of_var(self.defs, var));
                if part.bytes > MAX_REGION_BYTES {
                    return Err(self.too_large(id, part.bytes));
                }
                self.layout.slots[id] = Some(Slot::Instance(offset as u32));
            }
        }
        let stride = parts[0].bytes.max(parts[1].bytes).max(1).next_multiple_of(16);
        Ok(Split { pou, instances: 0, start: 0, stride, addressable_bytes: parts[1].bytes })
    }

    /// The addressable parts of program instances. A PROGRAM without an instance (a library that is only checked) gets
    /// its variables one behind the other.
    fn split_programs(&mut self, splits: &[Split]) -> Result<(), TooLarge> {
        for split in splits.iter().filter(|s| s.addressable_bytes > 0) {
            let distance = if split.instances > 0 {
                self.align(16)?;
                let distance = self.cursor - split.start;
                self.cursor += split.stride * (split.instances - 1) + split.addressable_bytes;
                self.align(1)?;
                distance
            } else {
                split.stride
            };
            for &id in &self.defs.pous[split.pou].vars {
                let moves = in_instance(&self.defs.vars[id]) && self.layout.is_addressable(self.defs, id);
                if let (true, Some(Slot::Instance(offset))) = (moves, &mut self.layout.slots[id]) {
                    *offset += distance as u32;
                }
            }
        }
        Ok(())
    }

    fn statics(&mut self) -> Result<(), TooLarge> {
        for var in std::mem::take(&mut self.statics) {
            self.place(var)?;
        }
        Ok(())
    }
}
