//! The shape of every type in memory: size, alignment, offsets of components, and what kinds of things lie inside.
//!
//! In: declarations. Out: [`Shapes`]. Where variables lie is the business of the layout. Structures and function block
//! instances have natural alignment, components in order of declaration, and sizes that are multiples of their alignment.
//! Sizes are 64-bit and saturate, so that no declaration can overflow them; the layout refuses what is too large.

use crate::cx::elem_of;
use crate::{Defs, Init, PouId, PouKind, Section, StepFlag, StructId, Type, TypeId, Var, VarId};
use index_vec::IndexVec;
use plcc_stdlib::elem::Elem;
use plcc_stdlib::prim::Repr;

/// So many flags of steps are looked at at once; the bytes behind those of the last steps of a chart are 0.
pub const FLAGS_AT_ONCE: u64 = 8;

/// No type is taken to be larger; the sum of two such sizes still fits.
const HUGE: u64 = 1 << 60;

/// What memory a value of a type takes and what lies in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// Size, a multiple of `align`.
    pub bytes: u64,
    /// Alignment, 1, 2, 4 or 8.
    pub align: u64,
    /// A variable inside has its address taken in the body of its function block.
    pub address_taken: bool,
    /// A reference lies inside.
    pub references: bool,
    /// A variable inside is RETAIN by its own declaration.
    pub retain: bool,
    /// A variable inside is NON_RETAIN by its own declaration.
    pub non_retain: bool,
    /// The default initial value is not all zero bytes.
    pub initialised: bool,
}

/// Nothing.
impl Default for Shape {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Shape {
    /// Nothing.
    pub const EMPTY: Shape = Shape {
        bytes: 0,
        align: 1,
        address_taken: false,
        references: false,
        retain: false,
        non_retain: false,
        initialised: false,
    };

    fn scalar(bytes: u32) -> Self {
        Self { bytes: u64::from(bytes), align: u64::from(bytes), ..Self::EMPTY }
    }

    /// Appends a component; gives its offset.
    pub fn push(&mut self, part: Shape) -> u64 {
        let offset = self.bytes.next_multiple_of(part.align);
        self.bytes = (offset + part.bytes).min(HUGE);
        self.merge(part);
        offset
    }

    fn merge(&mut self, part: Shape) {
        self.align = self.align.max(part.align);
        self.address_taken |= part.address_taken;
        self.references |= part.references;
        self.retain |= part.retain;
        self.non_retain |= part.non_retain;
    }

    fn padded(mut self) -> Self {
        self.bytes = self.bytes.next_multiple_of(self.align);
        self
    }
}

/// Shapes of structures and instances; those of other types follow from them.
#[derive(Debug, Clone, Default)]
pub struct Shapes {
    structs: IndexVec<StructId, Option<(Shape, Vec<u64>)>>,
    instances: IndexVec<PouId, Option<Shape>>,
    members: IndexVec<VarId, Option<u64>>,
}

/// Whether a variable lies in the instance of its POU: not in a frame, not at a fixed address.
pub fn in_instance(var: &Var) -> bool {
    matches!(var.section, Section::Input | Section::Output | Section::InOut | Section::Local) && var.address.is_none()
}

/// Whether the variable itself has its address taken (that of a VAR_IN_OUT is that of the variable it stands for).
pub fn address_taken(var: &Var) -> bool {
    var.address_taken && var.section != Section::InOut
}

/// The representation of a scalar, references too; `None` for aggregates, strings and no value.
pub fn repr(defs: &Defs, ty: TypeId) -> Option<Repr> {
    match &defs.types[ty] {
        Type::Ref { .. } | Type::Null => Some(Repr::I32),
        _ => elem_of(defs, ty).map(Elem::repr),
    }
}

impl Shapes {
    /// The shapes of all structures and POUs.
    pub fn new(defs: &Defs) -> Self {
        let mut shapes = Self {
            structs: defs.structs.iter().map(|_| None).collect(),
            instances: defs.pous.iter().map(|_| None).collect(),
            members: defs.vars.iter().map(|_| None).collect(),
        };
        for id in defs.structs.indices() {
            shapes.structure(defs, id);
        }
        for id in defs.pous.indices() {
            shapes.instance(defs, id);
        }
        shapes
    }

    /// The size of one type in bytes, while declarations are still being resolved: what lies inside `ty` must be.
    pub fn size_of(defs: &Defs, ty: TypeId) -> u64 {
        let mut shapes = Self {
            structs: defs.structs.iter().map(|_| None).collect(),
            instances: defs.pous.iter().map(|_| None).collect(),
            members: defs.vars.iter().map(|_| None).collect(),
        };
        shapes.work_out(defs, ty).bytes
    }

    /// The shape of a type.
    pub fn of(&self, defs: &Defs, ty: TypeId) -> Shape {
        match &defs.types[ty] {
            Type::Struct(id) => self.structs[*id].as_ref().map_or(Shape::EMPTY, |s| s.0),
            Type::Instance(id) => self.instances[*id].unwrap_or(Shape::EMPTY),
            Type::Array { dims, elem } => array(dims, self.of(defs, *elem)),
            _ => simple(defs, ty),
        }
    }

    /// The offset of a field of a structure.
    pub fn field(&self, id: StructId, index: u32) -> u64 {
        self.structs[id].as_ref().map_or(0, |s| s.1[index as usize])
    }

    /// The offset of a variable in an instance of its function block.
    pub fn member(&self, var: VarId) -> Option<u64> {
        self.members[var]
    }

    /// Whether an initial value is all zero bytes.
    pub fn init_is_zero(&self, defs: &Defs, ty: TypeId, init: &Init) -> bool {
        match init {
            Init::Default => !self.of(defs, ty).initialised,
            Init::Scalar(raw) => *raw == 0,
            Init::Reference(id) => defs.references[*id].is_none(),
            Init::String(s) => s.iter().all(|c| *c == 0),
            Init::WString(s) => s.iter().all(|c| *c == 0),
            Init::Array(runs) => {
                let Type::Array { elem, .. } = &defs.types[ty] else { return false };
                !self.of(defs, *elem).initialised && runs.iter().all(|(_, item)| self.init_is_zero(defs, *elem, item))
            }
            Init::Fields(_) => false,
        }
    }

    /// As [`Shapes::of`], working out structures and instances on the way. Containment has no cycles (HIR).
    fn work_out(&mut self, defs: &Defs, ty: TypeId) -> Shape {
        match &defs.types[ty] {
            Type::Struct(id) => self.structure(defs, *id),
            Type::Instance(id) => self.instance(defs, *id),
            Type::Array { dims, elem } => array(dims, self.work_out(defs, *elem)),
            _ => simple(defs, ty),
        }
    }

    fn structure(&mut self, defs: &Defs, id: StructId) -> Shape {
        if let Some((shape, _)) = &self.structs[id] {
            return *shape;
        }
        // A structure that contains itself is an error that may not have been cut yet.
        self.structs[id] = Some((Shape::EMPTY, Vec::new()));
        let def = &defs.structs[id];
        let mut shape = Shape::EMPTY;
        let mut offsets = Vec::with_capacity(def.fields.len());
        for (n, field) in def.fields.iter().enumerate() {
            let part = self.work_out(defs, field.ty);
            if def.flag.is_some() && n == StepFlag::FIELD as usize {
                // Where it lies is known when the size of the rest is.
                offsets.push(0);
                shape.merge(part);
            } else if def.union {
                shape.bytes = shape.bytes.max(part.bytes);
                shape.merge(part);
                offsets.push(0);
            } else {
                offsets.push(shape.push(part));
            }
            shape.initialised |= !self.init_is_zero(defs, field.ty, &field.init);
        }
        let mut shape = shape.padded();
        if let Some(flag) = def.flag {
            let (index, steps) = (u64::from(flag.index), u64::from(flag.steps));
            offsets[StepFlag::FIELD as usize] = (steps - index) * shape.bytes + index;
            if index + 1 == steps {
                // Room for all of them, and words of flags end in it.
                shape.bytes += steps.next_multiple_of(FLAGS_AT_ONCE);
            }
        }
        self.structs[id] = Some((shape, offsets));
        shape
    }

    fn instance(&mut self, defs: &Defs, id: PouId) -> Shape {
        if let Some(shape) = self.instances[id] {
            return shape;
        }
        self.instances[id] = Some(Shape::EMPTY);
        let mut shape = Shape::EMPTY;
        if matches!(defs.pous[id].kind, PouKind::FunctionBlock | PouKind::Program) {
            for &id in &defs.pous[id].vars {
                let var = &defs.vars[id];
                if in_instance(var) {
                    let part = self.stored(defs, var);
                    self.members[id] = Some(shape.push(part));
                    shape.address_taken |= address_taken(var);
                    shape.retain |= var.retain;
                    shape.non_retain |= var.non_retain;
                    shape.initialised |= var.section != Section::InOut && !self.init_is_zero(defs, var.ty, &var.init);
                }
            }
        }
        let shape = shape.padded();
        self.instances[id] = Some(shape);
        shape
    }

    /// What a variable takes where it is declared: a VAR_IN_OUT holds a reference.
    fn stored(&mut self, defs: &Defs, var: &Var) -> Shape {
        if var.section == Section::InOut { in_out(defs, var.ty) } else { self.work_out(defs, var.ty) }
    }

    /// The shape of a variable where it is declared.
    pub fn of_var(&self, defs: &Defs, var: &Var) -> Shape {
        if var.section == Section::InOut { in_out(defs, var.ty) } else { self.of(defs, var.ty) }
    }
}

const IN_OUT: Shape = Shape { bytes: 4, align: 4, references: true, ..Shape::EMPTY };

/// The reference that a VAR_IN_OUT holds; for a string of any capacity (\[S4\]) that capacity lies behind it.
fn in_out(defs: &Defs, ty: TypeId) -> Shape {
    let bytes = if matches!(defs.types[ty], Type::AnyString { .. }) { 8 } else { IN_OUT.bytes };
    Shape { bytes, ..IN_OUT }
}

fn simple(defs: &Defs, ty: TypeId) -> Shape {
    match &defs.types[ty] {
        Type::Elem(elem) => Shape::scalar(elem.bytes()),
        Type::Subrange { base, low, high } => {
            Shape { initialised: *low > 0 || *high < 0, ..Shape::scalar(base.bytes()) }
        }
        Type::Enum(id) => {
            let def = &defs.enums[*id];
            Shape { initialised: def.default != 0, ..Shape::scalar(def.base.bytes()) }
        }
        Type::String { wide: false, capacity } => Shape { bytes: u64::from(*capacity) + 1, ..Shape::EMPTY },
        Type::String { wide: true, capacity } => {
            Shape { bytes: 2 * (u64::from(*capacity) + 1), align: 2, ..Shape::EMPTY }
        }
        Type::Ref { .. } | Type::Null => Shape { references: true, ..Shape::scalar(4) },
        Type::AnyString { .. } | Type::AnyArray { .. } => IN_OUT,
        Type::Error | Type::Void | Type::Array { .. } | Type::Struct(_) | Type::Instance(_) => Shape::EMPTY,
    }
}

fn array(dims: &[(i64, i64)], elem: Shape) -> Shape {
    let bytes = dims.iter().fold(elem.bytes, |bytes, dim| bytes.saturating_mul(extent(*dim)).min(HUGE));
    Shape { bytes, ..elem }
}

/// How many values a dimension has.
pub fn extent((low, high): (i64, i64)) -> u64 {
    if high < low { 0 } else { high.abs_diff(low).saturating_add(1) }
}
