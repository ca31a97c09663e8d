//! Several resources as one program: their parts of the memory side by side, and behind them the *home* of what they share.
//!
//! In: the program and layout of each resource, optimised or not. Out: one [`Program`] whose tasks run in the parts, and
//! [`Home`], from which the runtime copies before and after each execution (semantics.md \[C3\]). One resource stays as it
//! is.
//!
//! ```text
//! part of resource 0 | part of resource 1 | ... | home: %I | %Q | %M | globals of the CONFIGURATION
//! ```

use crate::ir::{FuncId, Part, Program, Segment, SourceId};
use crate::layout::{Layout, MAX_REGION_BYTES, Range, TooLarge};
use crate::lower::init::Image;
use crate::visit;
use plcc_hir::app::Application;
use plcc_hir::shape::{Shapes, extent};
use plcc_hir::{Area, Defs, Section, Type, TypeId, VarId};

/// Parts start at multiples of a cache line.
const ALIGN: u32 = 64;

/// What resources share.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Home {
    /// Where, in the memory of all.
    pub range: Range,
    /// %I, %Q, %M, in the memory of all.
    pub areas: [Range; 3],
    /// Where each shared global lives, in the memory of all.
    pub globals: Vec<(VarId, u32)>,
    /// What each resource copies.
    pub shares: Vec<Vec<Share>>,
}

/// Equal values one behind the other, in the home and in a resource's part. Offsets are of the memory of all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Share {
    /// First byte in the home.
    pub home: u32,
    /// First byte of the copy.
    pub local: u32,
    /// Bytes of all of them.
    pub bytes: u32,
    /// Bytes of one; 0: the bytes hold bits, each a value.
    pub unit: u32,
}

/// Joins the resources of an application.
pub fn join(
    defs: &Defs,
    app: &Application,
    mut resources: Vec<(Program, Layout)>,
) -> Result<(Program, Vec<Layout>, Option<Home>), TooLarge> {
    if resources.len() == 1 {
        let (program, layout) = resources.remove(0);
        return Ok((program, vec![layout], None));
    }
    let mut joined = Program::default();
    let mut layouts = Vec::new();
    let mut images = Vec::new();
    let mut kept = Vec::new();
    for (program, layout) in resources {
        let start = joined.region_bytes;
        images.push((start, program.initial.clone()));
        kept.extend(program.retain.iter().map(|(at, bytes)| (start + at, *bytes)));
        append(&mut joined, program)?;
        layouts.push(layout);
    }
    let mut home = Home { range: Range { start: joined.region_bytes, bytes: 0 }, ..Home::default() };
    home.place(defs, &layouts)?;
    let starts: Vec<u32> = joined.parts.iter().map(|p| p.start).collect();
    for (layout, start) in layouts.iter().zip(&starts) {
        let shares = home.shares_of(defs, layout, *start);
        home.shares.push(shares);
    }
    joined.region_bytes = size(u64::from(home.range.start) + u64::from(home.range.bytes), "what resources share")?;
    joined.initial.extend(home.initial(&images));
    joined.retain = home.retain(kept);
    debug_assert_eq!(app.resources.len(), layouts.len());
    Ok((joined, layouts, Some(home)))
}

fn size(bytes: u64, what: &str) -> Result<u32, TooLarge> {
    if bytes > MAX_REGION_BYTES {
        return Err(TooLarge { what: what.into(), bytes, span: None });
    }
    Ok(bytes as u32)
}

/// Adds a resource behind the others.
fn append(joined: &mut Program, mut program: Program) -> Result<(), TooLarge> {
    let start = joined.region_bytes;
    let (funcs, sources) = (joined.funcs.len() as u32, joined.sources.len() as u32);
    let bytes = program.region_bytes.next_multiple_of(ALIGN);
    joined.region_bytes = size(u64::from(start) + u64::from(bytes), "the application")?;
    joined.parts.push(Part {
        start,
        bytes,
        frame_base: program.frame_base,
        first_func: FuncId::from_raw(funcs),
        first_task: joined.tasks.len(),
        first_source: SourceId::from_raw(sources),
    });
    let func = |id: FuncId| FuncId::from_raw(id.raw() + funcs);
    let source = |id: SourceId| SourceId::from_raw(id.raw() + sources);
    for inst in program.funcs.iter_mut().flat_map(|f| &mut f.blocks).flat_map(|b| &mut b.insts) {
        if let crate::ir::Inst::Call { callee, .. } = inst {
            *callee = func(*callee);
        }
        if let Some(exit) = visit::exit(inst) {
            exit.source = source(exit.source);
        }
    }
    for row in &mut program.sources {
        row.inlined_at = row.inlined_at.map(source);
    }
    joined.tasks.extend(program.tasks.iter().map(|t| func(*t)));
    joined.funcs.extend(program.funcs);
    joined.sources.extend(program.sources);
    let moved = program.initial.into_iter().map(|s| Segment { offset: s.offset + start, ..s });
    joined.initial.extend(moved);
    Ok(())
}

impl Home {
    /// Places areas and globals.
    fn place(&mut self, defs: &Defs, layouts: &[Layout]) -> Result<(), TooLarge> {
        let mut at = u64::from(self.range.start);
        for (n, area) in [Area::Input, Area::Output, Area::Memory].into_iter().enumerate() {
            let bytes = layouts.iter().map(|l| l.area(area).bytes).max().unwrap_or(0);
            self.areas[n] = Range { start: size(at, "what resources share")?, bytes };
            at += u64::from(bytes).next_multiple_of(8);
        }
        for &var in defs.globals.iter().filter(|v| is_shared(defs, **v)) {
            self.globals.push((var, size(at, "what resources share")?));
            at += layouts[0].shapes.of(defs, defs.vars[var].ty).bytes.next_multiple_of(8);
        }
        self.range.bytes = (size(at, "what resources share")? - self.range.start).next_multiple_of(ALIGN);
        Ok(())
    }

    fn shares_of(&self, defs: &Defs, layout: &Layout, start: u32) -> Vec<Share> {
        let mut shares: Vec<Share> = Vec::new();
        let mut push = |share: Share| match shares.last_mut() {
            // Runs are compared as a whole first, so long ones are cheap.
            Some(last)
                if last.unit == share.unit
                    && last.home + last.bytes == share.home
                    && last.local + last.bytes == share.local =>
            {
                last.bytes += share.bytes;
            }
            _ => shares.push(share),
        };
        for unit in &layout.units {
            let area = [Area::Input, Area::Output, Area::Memory][unit.area];
            let (home, local) = (self.areas[unit.area].start + unit.byte, start + layout.area(area).start + unit.byte);
            push(Share { home, local, bytes: (unit.bytes * unit.count).max(1), unit: unit.bytes });
        }
        for (var, home) in &self.globals {
            let Some((offset, None)) = layout.offset(*var, 0) else { continue };
            values(defs, &layout.shapes, defs.vars[*var].ty, 0, &mut |at, bytes, count| {
                push(Share { home: home + at, local: start + offset + at, bytes: bytes * count, unit: bytes });
            });
        }
        shares
    }

    /// The bytes of a cold start: those of the copies. At one address several resources may give initial values.
    fn initial(&self, images: &[(u32, Vec<Segment>)]) -> Vec<Segment> {
        let mut image = Image::default();
        let mut bytes = vec![0u8; self.range.bytes as usize];
        for ((start, segments), shares) in images.iter().zip(&self.shares) {
            for share in shares {
                let local = share.local - start;
                for segment in segments {
                    let (first, behind) = (segment.offset, segment.offset + segment.bytes.len() as u32);
                    let (low, high) = (first.max(local), behind.min(local + share.bytes));
                    for at in low..high {
                        let to = (share.home + at - local - self.range.start) as usize;
                        bytes[to] |= segment.bytes[(at - first) as usize];
                    }
                }
            }
        }
        image.write(self.range.start, &bytes);
        image.segments()
    }

    /// What a warm start keeps: of shared values the home's.
    fn retain(&self, kept: Vec<(u32, u32)>) -> Vec<(u32, u32)> {
        let mut shared: Vec<Share> = self.shares.iter().flatten().copied().collect();
        shared.sort_unstable_by_key(|s| s.local);
        let mut ranges = Vec::new();
        for (start, bytes) in kept {
            let mut at = start;
            let end = start + bytes;
            let first = shared.partition_point(|s| s.local + s.bytes <= start);
            for share in shared[first..].iter().take_while(|s| s.local < end) {
                let (low, high) = (share.local.max(start), (share.local + share.bytes).min(end));
                if low > at {
                    ranges.push((at, low - at));
                }
                ranges.push((share.home + low - share.local, high - low));
                at = at.max(high);
            }
            if at < end {
                ranges.push((at, end - at));
            }
        }
        ranges.sort_unstable();
        let mut merged: Vec<(u32, u32)> = Vec::new();
        for (start, bytes) in ranges {
            match merged.last_mut() {
                Some((s, b)) if start <= *s + *b => *b = (*b).max(start + bytes - *s),
                _ => merged.push((start, bytes)),
            }
        }
        merged
    }
}

/// Globals of the CONFIGURATION that are variables and have no address.
fn is_shared(defs: &Defs, var: VarId) -> bool {
    let def = &defs.vars[var];
    def.section == Section::Global && def.resource.is_none() && !def.constant && def.address.is_none()
}

/// Calls `f` for the values that a variable at `at` consists of: first byte, bytes of one, how many in a row. A union is one
/// value; references are none.
pub(crate) fn values(defs: &Defs, shapes: &Shapes, ty: TypeId, at: u32, f: &mut impl FnMut(u32, u32, u32)) {
    let bytes = shapes.of(defs, ty).bytes as u32;
    match &defs.types[ty] {
        Type::Ref { .. } | Type::Null | Type::AnyString { .. } | Type::AnyArray { .. } => {}
        Type::Array { dims, elem } => {
            let count = dims.iter().map(|d| extent(*d)).product::<u64>() as u32;
            let stride = shapes.of(defs, *elem).bytes as u32;
            let plain = !matches!(
                &defs.types[*elem],
                Type::Array { .. } | Type::Struct(_) | Type::Instance(_) | Type::Ref { .. }
            );
            if plain {
                if stride > 0 && count > 0 {
                    f(at, stride, count);
                }
                return;
            }
            for n in 0..count {
                values(defs, shapes, *elem, at + n * stride, f);
            }
        }
        Type::Struct(id) if !defs.structs[*id].union => {
            for (n, field) in defs.structs[*id].fields.iter().enumerate() {
                values(defs, shapes, field.ty, at + shapes.field(*id, n as u32) as u32, f);
            }
        }
        Type::Instance(pou) => {
            for &var in &defs.pous[*pou].vars {
                let def = &defs.vars[var];
                if let (Some(offset), false) = (shapes.member(var), def.section == Section::InOut) {
                    values(defs, shapes, def.ty, at + offset as u32, f);
                }
            }
        }
        _ if bytes > 0 => f(at, bytes, 1),
        _ => {}
    }
}
