//! Initial values to bytes: the image of a cold start, and the initial data of function variables.
//!
//! In: `hir::Init`, layout. Out: bytes at offsets. An initial value is complete; what it leaves out has the default of its
//! type (semantics.md \[T9\]). References are offsets in the region; what they refer to has its place there, also variables of
//! functions, as their address is taken.

use crate::ir::Segment;
use crate::layout::{Layout, Slot};
use plcc_diag::bug;
use plcc_hir::app::Resource;
use plcc_hir::elem_of;
use plcc_hir::{Defs, Init, ReferenceId, Section, StepFlag, Type, TypeId, Var, VarId};
use std::collections::BTreeMap;

/// The register value with which a scalar starts; `None` for what is no scalar.
pub fn scalar(defs: &Defs, ty: TypeId, init: &Init) -> Option<u64> {
    let raw = match (init, &defs.types[ty]) {
        (Init::Scalar(raw), _) => *raw,
        (_, Type::Elem(_) | Type::Ref { .. } | Type::Null) => 0,
        (_, Type::Enum(id)) => defs.enums[*id].default as u64,
        (_, Type::Subrange { low, high, .. }) => {
            if *low > 0 || *high < 0 {
                *low as u64
            } else {
                0
            }
        }
        _ => return None,
    };
    // Negative numbers come sign-extended, registers are zero-extended.
    let mask = elem_of(defs, ty).map_or(u64::from(u32::MAX), |e| e.repr().mask());
    Some(raw & mask)
}

/// Where a value lies and whose it is.
#[derive(Debug, Clone, Copy)]
pub struct Home {
    /// The offset of the value in the region.
    pub at: u32,
    /// That of the instance to whose variables its references refer, where these are no global ones.
    pub instance: u32,
}

impl Home {
    fn plus(self, offset: u32) -> Self {
        Self { at: self.at + offset, ..self }
    }
}

/// Bytes of a value in memory.
pub fn bytes(defs: &Defs, layout: &Layout, ty: TypeId, init: &Init, home: Home) -> Vec<u8> {
    let mut out = vec![0; layout.size(defs, ty) as usize];
    write(defs, layout, ty, init, home, &mut out);
    out
}

/// The offset of what a reference refers to, 0 for NULL.
pub fn address(defs: &Defs, layout: &Layout, id: ReferenceId, home: Home) -> u32 {
    let Some(place) = &defs.references[id] else { return 0 };
    match layout.address_of(defs, place, home.instance) {
        (offset, None) => offset,
        (_, Some(_)) => bug!("a reference to a bit"),
    }
}

/// Writes a value into bytes that are 0.
fn write(defs: &Defs, layout: &Layout, ty: TypeId, init: &Init, home: Home, out: &mut [u8]) {
    if layout.shapes.init_is_zero(defs, ty, init) {
        return;
    }
    if let Init::Reference(id) = init {
        out.copy_from_slice(&address(defs, layout, *id, home).to_le_bytes());
        return;
    }
    if let Some(raw) = scalar(defs, ty, init) {
        let size = out.len();
        out.copy_from_slice(&raw.to_le_bytes()[..size]);
        return;
    }
    match (&defs.types[ty], init) {
        (Type::String { .. }, Init::String(text)) => {
            // The last byte stays 0.
            let n = text.len().min(out.len() - 1);
            out[..n].copy_from_slice(&text[..n]);
        }
        (Type::String { .. }, Init::WString(text)) => {
            let capacity = out.len() / 2 - 1;
            for (unit, to) in text.iter().take(capacity).zip(out.chunks_exact_mut(2)) {
                to.copy_from_slice(&unit.to_le_bytes());
            }
        }
        (Type::Array { elem, .. }, _) => write_array(defs, layout, *elem, init, home, out),
        (Type::Struct(id), _) => {
            let def = &defs.structs[*id];
            let mut field = |n: usize, init: &Init| {
                let ty = def.fields[n].ty;
                let offset = layout.field(*id, n as u32);
                let at = offset as usize;
                let to = &mut out[at..at + layout.size(defs, ty) as usize];
                if def.union {
                    to.fill(0);
                }
                write(defs, layout, ty, init, home.plus(offset), to);
            };
            if def.union {
                // The fields share their bytes: one value counts, that which is written last, else the first one's own.
                match fields(init).last() {
                    Some((n, init)) => field(*n as usize, init),
                    None => {
                        let own = def.fields.iter().position(|f| !layout.shapes.init_is_zero(defs, f.ty, &f.init));
                        if let Some(n) = own {
                            field(n, &def.fields[n].init);
                        }
                    }
                }
            } else {
                let own = explicit(init, def.fields.len());
                for (n, own) in own.into_iter().enumerate() {
                    field(n, own.unwrap_or(&def.fields[n].init));
                }
            }
        }
        (Type::Instance(pou), _) => {
            let vars = &defs.pous[*pou].vars;
            for (&id, explicit) in vars.iter().zip(explicit(init, vars.len())) {
                let var = &defs.vars[id];
                let (Some(Slot::Instance(at)), false) = (layout.slot(id), var.section == Section::InOut) else {
                    continue;
                };
                let home = match explicit {
                    // What stands at the declaration of the instance is said about the variables around it.
                    Some(_) => home.plus(at),
                    None => Home { at: home.at + at, instance: home.at },
                };
                let at = at as usize;
                if let Some(flag) = flag(defs, layout, var) {
                    out[at + flag as usize] = 1;
                    continue;
                }
                let to = &mut out[at..at + layout.size(defs, var.ty) as usize];
                write(defs, layout, var.ty, explicit.unwrap_or(&var.init), home, to);
            }
        }
        _ => bug!("an initial value {init:?} for {:?}", defs.types[ty]),
    }
}

/// The values that are given for the components, by their index; `None` where there is none.
fn explicit(init: &Init, count: usize) -> Vec<Option<&Init>> {
    let mut given = vec![None; count];
    for (n, value) in fields(init) {
        given[*n as usize] = Some(value);
    }
    given
}

/// Of an initial step: how far behind its first byte its flag lies. Nothing else of a step has an initial value, and the flag
/// lies outside of its variable ([`StepFlag`]).
fn flag(defs: &Defs, layout: &Layout, var: &Var) -> Option<u32> {
    match &defs.types[var.ty] {
        Type::Struct(id) if defs.structs[*id].flag.is_some() && !fields(&var.init).is_empty() => {
            Some(layout.field(*id, StepFlag::FIELD))
        }
        _ => None,
    }
}

fn fields(init: &Init) -> &[(u32, Init)] {
    match init {
        Init::Fields(list) => list,
        _ => &[],
    }
}

fn write_array(defs: &Defs, layout: &Layout, elem: TypeId, init: &Init, home: Home, out: &mut [u8]) {
    let size = layout.size(defs, elem) as usize;
    // References to variables of an instance are others in each element.
    let alike = !layout.shapes.of(defs, elem).references;
    let mut offset = 0;
    if size == 0 {
        return;
    }
    let runs: &[(u32, Init)] = if let Init::Array(runs) = init { runs } else { &[] };
    let mut rest = out;
    let rest_of_array = [(u32::MAX, Init::Default)];
    for (count, item) in runs.iter().chain(&rest_of_array) {
        let bytes = (*count as usize).saturating_mul(size).min(rest.len());
        let (run, behind) = rest.split_at_mut(bytes);
        rest = behind;
        let start = offset;
        offset += run.len() as u32;
        if run.is_empty() || layout.shapes.init_is_zero(defs, elem, item) {
            continue;
        }
        if !alike {
            for (n, to) in run.chunks_exact_mut(size).enumerate() {
                write(defs, layout, elem, item, home.plus(start + (n * size) as u32), to);
            }
            continue;
        }
        let (first, others) = run.split_at_mut(size);
        write(defs, layout, elem, item, home, first);
        others.chunks_exact_mut(size).for_each(|to| to.copy_from_slice(first));
    }
}

/// Bytes of the region that are not 0, sparse.
#[derive(Debug, Default)]
pub struct Image {
    pages: BTreeMap<u32, Box<[u8; PAGE]>>,
}

const PAGE: usize = 4096;
/// Inside so many bytes, and between two runs no further apart, zeros are kept.
const CHUNK: usize = 64;

impl Image {
    /// Writes bytes; what was there is replaced.
    pub fn write(&mut self, mut offset: u32, mut bytes: &[u8]) {
        while !bytes.is_empty() {
            let (page, at) = (offset / PAGE as u32, offset as usize % PAGE);
            let n = bytes.len().min(PAGE - at);
            let (here, behind) = bytes.split_at(n);
            if here.iter().any(|b| *b != 0) || self.pages.contains_key(&page) {
                let page = self.pages.entry(page).or_insert_with(|| Box::new([0; PAGE]));
                page[at..at + n].copy_from_slice(here);
            }
            offset += n as u32;
            bytes = behind;
        }
    }

    /// Sets a bit.
    pub fn set_bit(&mut self, offset: u32, bit: u8) {
        let (page, at) = (offset / PAGE as u32, offset as usize % PAGE);
        self.pages.entry(page).or_insert_with(|| Box::new([0; PAGE]))[at] |= 1 << bit;
    }

    /// The bytes as segments in rising order; short gaps of zeros are kept inside.
    pub fn segments(&self) -> Vec<Segment> {
        let mut segments: Vec<Segment> = Vec::new();
        for (page, bytes) in &self.pages {
            let start = page * PAGE as u32;
            for chunk in (0..PAGE).step_by(CHUNK) {
                let bytes = &bytes[chunk..chunk + CHUNK];
                let Some(first) = bytes.iter().position(|b| *b != 0) else { continue };
                let last = bytes.iter().rposition(|b| *b != 0).unwrap_or(first);
                let offset = start + (chunk + first) as u32;
                match segments.last_mut() {
                    Some(open) if offset - (open.offset + open.bytes.len() as u32) <= CHUNK as u32 => {
                        open.bytes.resize((offset - open.offset) as usize, 0);
                        open.bytes.extend_from_slice(&bytes[first..=last]);
                    }
                    _ => segments.push(Segment { offset, bytes: bytes[first..=last].to_vec() }),
                }
            }
        }
        segments
    }
}

/// Writes the initial values of all variables that have a place in the region.
pub fn variables(defs: &Defs, layout: &Layout, resource: &Resource, image: &mut Image) {
    let mut writer = Writer { defs, layout, image };
    for &var in &defs.globals {
        writer.variable(var, 0);
    }
    // Located variables of function blocks exist once, not in each instance.
    for (id, var) in defs.vars.iter_enumerated() {
        if var.owner.is_some() && var.address.is_some() {
            writer.variable(id, 0);
        }
    }
    for (n, program) in resource.programs.iter().enumerate() {
        for &var in &defs.pous[program.pou].vars {
            if defs.vars[var].address.is_none() {
                writer.variable(var, layout.program(n));
            }
        }
        for (path, init) in &program.initial {
            writer.at_path(path, layout.program(n), init);
        }
    }
}

struct Writer<'a> {
    defs: &'a Defs,
    layout: &'a Layout,
    image: &'a mut Image,
}

impl Writer<'_> {
    /// A value of its own for a variable inside an instance.
    fn at_path(&mut self, path: &[VarId], mut instance: u32, init: &Init) {
        for (n, &id) in path.iter().enumerate() {
            let Some((offset, None)) = self.layout.offset(id, instance) else { return };
            if n + 1 == path.len() {
                let ty = self.defs.vars[id].ty;
                // VAR_CONFIG refers to global variables only.
                let home = Home { at: offset, instance };
                self.image.write(offset, &bytes(self.defs, self.layout, ty, init, home));
            }
            instance = offset;
        }
    }

    fn variable(&mut self, id: VarId, instance: u32) {
        let var = &self.defs.vars[id];
        // A located variable without a value of its own leaves the bytes to the others at its address.
        let zero = self.layout.shapes.init_is_zero(self.defs, var.ty, &var.init);
        if zero || matches!(var.section, Section::InOut | Section::Temp) {
            return;
        }
        match self.layout.offset(id, instance) {
            Some((offset, Some(bit))) => self.image.set_bit(offset, bit),
            Some((offset, None)) => match flag(self.defs, self.layout, var) {
                Some(flag) => self.image.write(offset + flag, &[1]),
                None => {
                    let home = Home { at: offset, instance };
                    self.image.write(offset, &bytes(self.defs, self.layout, var.ty, &var.init, home));
                }
            },
            None => {}
        }
    }
}

/// Initial data of function variables, each content once.
#[derive(Debug, Default)]
pub struct Constants {
    bytes: Vec<u8>,
    places: rustc_hash::FxHashMap<Vec<u8>, u32>,
}

impl Constants {
    /// The place of these bytes, from the first constant on.
    pub fn place(&mut self, bytes: Vec<u8>) -> u64 {
        if let Some(at) = self.places.get(&bytes) {
            return u64::from(*at);
        }
        let at = self.bytes.len().next_multiple_of(8);
        self.bytes.resize(at, 0);
        self.bytes.extend_from_slice(&bytes);
        self.places.insert(bytes, at as u32);
        at as u64
    }

    /// All of them.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_skip_zeros_and_keep_short_gaps() {
        let mut image = Image::default();
        image.write(10, &[1, 0, 2]);
        image.write(5000, &[3]);
        image.write(4096 * 3 - 1, &[4, 5]);
        image.write(10, &[0]);
        let segments = image.segments();
        let expected = [(12, vec![2]), (5000, vec![3]), (4096 * 3 - 1, vec![4, 5])];
        assert_eq!(segments.iter().map(|s| (s.offset, s.bytes.clone())).collect::<Vec<_>>(), expected);
    }

    #[test]
    fn equal_constants_share_their_place() {
        let mut constants = Constants::default();
        assert_eq!(constants.place(vec![1, 2, 3]), 0);
        assert_eq!(constants.place(vec![4]), 8);
        assert_eq!(constants.place(vec![1, 2, 3]), 0);
        assert_eq!(constants.bytes().len(), 9);
    }
}
