//! Layout and application to what the runtime must know ([`Image`]), and to the table that `plc_app_var` searches.

use crate::failure::Failure;
use crate::project::Project;
use plcc_codegen::object::Var as TableVar;
use plcc_diag::SourceMap;
use plcc_hir::app::{Application, Resource};
use plcc_hir::body::Root as PlaceRoot;
use plcc_hir::{Address, Area, Defs, PouId, Section, Type, TypeId, VarId};
use plcc_mir::ir::Program;
use plcc_mir::layout::{Layout, Slot};
use plcc_mir::resources::{Home, Share};
use plcc_runtime::image::{self, AccessPath, Field, Image, Root, SafeValue, Source, Task, TypeDesc};
use plcc_runtime::path::Resolver;
use plcc_stdlib::elem::Elem;
use rustc_hash::FxHashMap;

/// Where everything lies: the layout of each resource, and what they share.
pub struct Memory<'a> {
    pub layouts: &'a [Layout],
    pub home: Option<&'a Home>,
}

impl Memory<'_> {
    /// The area as drivers see it.
    fn area(&self, area: Area) -> (u32, u32) {
        let range = self.home.map_or_else(|| self.layouts[0].area(area), |home| home.areas[area as usize]);
        (range.start, range.bytes)
    }

    /// The offset in all memory of a byte of a resource's part: of shared values the home's.
    fn offset(&self, program: &Program, resource: usize, local: u32) -> u32 {
        let at = program.parts.get(resource).map_or(0, |p| p.start) + local;
        let shares = self.home.map_or(&[][..], |home| &home.shares[resource]);
        let share = shares.iter().find(|s| (s.local..s.local + s.bytes).contains(&at));
        share.map_or(at, |s| s.home + at - s.local)
    }
}

/// Builds the image of an application.
pub fn build(
    defs: &Defs,
    app: &Application,
    memory: &Memory,
    program: &Program,
    project: &Project,
    sources: &SourceMap,
) -> Result<Image, Failure> {
    let layout = &memory.layouts[0];
    let mut builder = Builder { defs, app, memory, program, layout, types: Vec::new(), ids: FxHashMap::default() };
    let roots = builder.roots();
    let (statements, of_source) = crate::statements::of(app, memory.layouts, defs, program, &mut |ty| builder.ty(ty));
    let tasks = builder.tasks(project)?;
    let mut image = Image {
        name: project.name.clone(),
        configuration: app.name.to_string(),
        resources: resources(app, memory, program),
        region_bytes: program.region_bytes,
        home: memory.home.map_or((0, 0), |home| (home.range.start, home.range.bytes)),
        types: builder.types,
        roots,
        tasks,
        areas: [Area::Input, Area::Output, Area::Memory].map(|a| memory.area(a)),
        retain: program.retain.clone(),
        retain_file: project.retain_file.as_ref().map(|path| path.to_string_lossy().into_owned()),
        files: sources.iter().map(|(_, f)| f.name.clone()).collect(),
        sources: program
            .sources
            .iter()
            .zip(of_source)
            .map(|(s, statement)| {
                let (line, column) = sources.file(s.span.file).line_column(s.span.start);
                Source { file: s.span.file.0, line, column, pou: s.pou.clone(), what: s.what.clone(), statement }
            })
            .collect(),
        safe_state: Vec::new(),
        access: app
            .access
            .iter()
            .map(|a| AccessPath { name: a.name.to_string(), path: a.path.clone(), writable: a.writable })
            .collect(),
        statements,
        defaults: project.defaults.clone(),
    };
    image.safe_state = safe_state(&image, project)?;
    Ok(image)
}

fn resources(app: &Application, memory: &Memory, program: &Program) -> Vec<image::Resource> {
    let share = |s: &Share| image::Share { home: s.home, local: s.local, bytes: s.bytes, unit: s.unit };
    let resource = |(n, resource): (usize, &Resource)| {
        let (start, bytes) = program.parts.get(n).map_or((0, program.region_bytes), |p| (p.start, p.bytes));
        let shares = memory.home.map_or_else(Vec::new, |home| home.shares[n].iter().map(share).collect());
        image::Resource { name: resource.name.to_string(), start, bytes, shares }
    };
    app.resources.iter().enumerate().map(resource).collect()
}

/// `[io.safe_state]`: addresses of %Q and names of variables there.
fn safe_state(image: &Image, project: &Project) -> Result<Vec<SafeValue>, Failure> {
    let resolver = Resolver::new(image);
    let wrong = |name: &str, e: String| Failure::usage(format!("[io.safe_state] \"{name}\": {e}"));
    let mut values = Vec::new();
    for (name, text) in &project.safe_state {
        if name.starts_with('%') {
            let (address, width) = plcc_hir::address::parse_with_width(name).map_err(|e| wrong(name, e))?;
            let (start, bytes) = image.areas[address.area as usize];
            if address.area != Area::Output {
                return Err(wrong(name, "only outputs (%Q) have a safe state".into()));
            }
            if address.byte + width.max(1) > bytes {
                return Err(wrong(name, "no variable of the program lies there".into()));
            }
            let elem = match width {
                0 => Elem::Bool,
                1 => Elem::Byte,
                2 => Elem::Word,
                4 => Elem::Dword,
                _ => Elem::Lword,
            };
            let raw = plcc_stdlib::literal::parse(elem, text).map_err(|e| wrong(name, e.to_string()))?;
            values.push(SafeValue {
                offset: start + address.byte,
                bit: address.bit,
                bytes: raw.to_le_bytes()[..elem.bytes() as usize].to_vec(),
            });
        } else {
            let leaf = resolver.leaf(name).map_err(|e| wrong(name, e))?;
            let (start, bytes) = image.areas[Area::Output as usize];
            if !(start..start + bytes).contains(&leaf.offset) {
                return Err(wrong(name, "only variables located in %Q have a safe state".into()));
            }
            let bytes = resolver.bytes(&leaf, text).map_err(|e| wrong(name, e))?;
            values.push(SafeValue { offset: leaf.offset, bit: leaf.bit, bytes });
        }
    }
    Ok(values)
}

/// Every variable of elementary type, for `plc_app_var`; the type number is that of `stdlib::elem`, 0x40 STRING, 0x41
/// WSTRING, 0x42 reference.
pub fn variables(image: &Image) -> Vec<TableVar> {
    let resolver = Resolver::new(image);
    let columns = resolver.all().unwrap_or_default();
    columns
        .into_iter()
        .map(|(path, leaf)| {
            let (size, ty) = match &image.types[leaf.ty as usize] {
                TypeDesc::Elem(code) | TypeDesc::Enum { elem: code, .. } | TypeDesc::Subrange { elem: code, .. } => {
                    (Elem::from_code(*code).map_or(0, Elem::bytes), u16::from(*code))
                }
                TypeDesc::String { wide, capacity } => {
                    if *wide {
                        (2 * (capacity + 1), 0x41)
                    } else {
                        (capacity + 1, 0x40)
                    }
                }
                _ => (4, 0x42),
            };
            // Bits 0..2: the bit of a packed BOOL, bit 3: it is packed, bit 4: CONSTANT.
            let bit = leaf.bit.map_or(0, |b| u16::from(b) | 8);
            TableVar { path, offset: leaf.offset, size, ty, flags: bit | if leaf.constant { 16 } else { 0 } }
        })
        .collect()
}

struct Builder<'a> {
    defs: &'a Defs,
    app: &'a Application,
    memory: &'a Memory<'a>,
    program: &'a Program,
    /// Of the first resource: what lies inside a type is the same in all.
    layout: &'a Layout,
    types: Vec<TypeDesc>,
    ids: FxHashMap<TypeId, u32>,
}

impl Builder<'_> {
    fn roots(&mut self) -> Vec<Root> {
        let mut roots = Vec::new();
        for (number, resource) in self.app.resources.iter().enumerate() {
            for (index, program) in resource.programs.iter().enumerate() {
                for var in &self.defs.pous[program.pou].vars {
                    let instance = self.memory.layouts[number].program(index);
                    roots.extend(self.root(number, *var, Some(&program.name), instance));
                }
            }
        }
        for var in &self.defs.globals {
            let several = self.app.resources.len() > 1;
            if self.defs.vars[*var].resource.is_none() || !several {
                roots.extend(self.root(0, *var, None, 0).map(|root| Root { resource: None, ..root }));
                continue;
            }
            for number in (0..self.app.resources.len()).filter(|n| self.app.has_global(*n, *var, self.defs)) {
                roots.extend(self.root(number, *var, None, 0));
            }
        }
        roots
    }

    /// A variable with its absolute place; `None` for those without one (VAR_TEMP, VAR_IN_OUT).
    fn root(&mut self, number: usize, var: VarId, program: Option<&str>, instance: u32) -> Option<Root> {
        // A global that several resources have is each resource's own.
        let own = self.app.resources[number].globals.iter().find(|(name, _)| *name == var).map_or(var, |(_, own)| *own);
        let v = &self.defs.vars[own];
        if v.section == Section::InOut {
            return None;
        }
        let (local, bit) = match (v.address, self.memory.home) {
            // Its address may differ between resources.
            (Some(address), Some(_)) => {
                (self.memory.layouts[number].area(address.area).start + address.byte, address.bit)
            }
            _ => self.memory.layouts[number].offset(var, instance)?,
        };
        let shared = self.memory.home.and_then(|home| home.globals.iter().find(|(g, _)| *g == var));
        let offset = match shared {
            Some((_, home)) => *home,
            None => self.memory.offset(self.program, number, local),
        };
        let name = match program {
            Some(program) => format!("{program}.{}", v.name),
            None => v.name.to_string(),
        };
        let (constant, retain, ty) = (v.constant, v.retain, v.ty);
        Some(Root { name, offset, bit, ty: self.ty(ty), constant, retain, resource: Some(number as u32) })
    }

    fn tasks(&self, project: &Project) -> Result<Vec<Task>, Failure> {
        let mut tasks = Vec::new();
        for (number, resource) in self.app.resources.iter().enumerate() {
            for (index, task) in resource.tasks.iter().enumerate() {
                let (watchdog_ns, deadline_ns) = project.of_task(&resource.name, &task.name);
                tasks.push(Task {
                    name: task.name.to_string(),
                    interval_ns: task.interval_ns,
                    single: task.single.as_ref().map(|place| {
                        let (local, bit) = self.memory.layouts[number].address_of(self.defs, place, 0);
                        (self.memory.offset(self.program, number, local), bit)
                    }),
                    priority: task.priority,
                    watchdog_ns: watchdog_ns.unwrap_or(task.watchdog_ns),
                    resource: number as u32,
                    deadline_ns: deadline_ns.or(task.deadline_ns),
                    programs: self.instances(number, index),
                    outputs: self.outputs(number, index),
                });
            }
        }
        project.check_tasks(&tasks, &self.app.resources)?;
        Ok(tasks)
    }

    /// The bytes of the program instances of a task, in order, disjoint.
    fn instances(&self, number: usize, task: usize) -> Vec<(u32, u32)> {
        let (layout, start) = (&self.memory.layouts[number], self.program.parts.get(number).map_or(0, |p| p.start));
        let mut ranges: Vec<(u32, u32)> = Vec::new();
        for (n, program) in self.app.resources[number].programs.iter().enumerate().filter(|(_, p)| p.task == task) {
            for &var in &self.defs.pous[program.pou].vars {
                if let Some(Slot::Instance(offset)) = layout.slot(var) {
                    let bytes = layout.shapes.of_var(self.defs, &self.defs.vars[var]).bytes as u32;
                    ranges.push((start + layout.program(n) + offset, bytes));
                }
            }
        }
        ranges.sort_unstable();
        let mut merged: Vec<(u32, u32)> = Vec::new();
        for (start, bytes) in ranges {
            match merged.last_mut() {
                Some((s, b)) if *s + *b == start => *b += bytes,
                _ => merged.push((start, bytes)),
            }
        }
        merged
    }

    /// Outputs that the programs of a task own: their variables in %Q, and those that their connections write.
    fn outputs(&self, number: usize, task: usize) -> Vec<(u32, Option<u8>, u32)> {
        let layout = &self.memory.layouts[number];
        let mut outputs = Vec::new();
        let mut push = |address: Address, ty: TypeId| {
            if address.area == Area::Output {
                let bytes = if address.bit.is_some() { 1 } else { layout.size(self.defs, ty) };
                outputs.push((self.memory.area(Area::Output).0 + address.byte, address.bit, bytes));
            }
        };
        for program in self.app.resources[number].programs.iter().filter(|p| p.task == task) {
            let own = self.defs.pous[program.pou].vars.iter().map(|v| &self.defs.vars[*v]);
            own.filter_map(|v| Some((v.address?, v.ty))).for_each(|(address, ty)| push(address, ty));
            let written = program.located.iter().map(|(_, place)| place);
            for place in written.chain(program.outputs.iter().map(|(_, place)| place)) {
                match place.root {
                    PlaceRoot::Address(address) => push(address, place.ty),
                    PlaceRoot::Var(var) => {
                        let own = self.app.resources[number].globals.iter().find(|(name, _)| *name == var);
                        let def = &self.defs.vars[own.map_or(var, |(_, own)| *own)];
                        def.address.into_iter().for_each(|address| push(address, def.ty));
                    }
                    _ => {}
                }
            }
        }
        outputs.sort_unstable();
        outputs.dedup();
        outputs
    }

    fn ty(&mut self, id: TypeId) -> u32 {
        if let Some(index) = self.ids.get(&id) {
            return *index;
        }
        let desc = match self.defs.types.get(id).clone() {
            Type::Elem(elem) => TypeDesc::Elem(elem.code()),
            Type::Subrange { base, low, high } => TypeDesc::Subrange { elem: base.code(), low, high },
            Type::Enum(id) => {
                let def = &self.defs.enums[id];
                let values = def.values.iter().map(|(n, v, _)| (n.to_string(), *v as i64)).collect();
                TypeDesc::Enum { elem: def.base.code(), values }
            }
            Type::String { wide, capacity } => TypeDesc::String { wide, capacity },
            Type::Array { dims, elem } => {
                let stride = self.layout.size(self.defs, elem);
                TypeDesc::Array { dims, elem: self.ty(elem), stride }
            }
            Type::Struct(id) => {
                let def = &self.defs.structs[id];
                let fields = def.fields.iter().enumerate().map(|(n, f)| Field {
                    name: f.name.to_string(),
                    offset: self.layout.field(id, n as u32),
                    ty: self.ty(f.ty),
                });
                TypeDesc::Struct { name: def.name.to_string(), fields: fields.collect() }
            }
            Type::Instance(pou) => self.instance(pou),
            _ => TypeDesc::Reference,
        };
        let index = self.types.len() as u32;
        self.types.push(desc);
        self.ids.insert(id, index);
        index
    }

    fn instance(&mut self, pou: PouId) -> TypeDesc {
        let def = &self.defs.pous[pou];
        let mut fields = Vec::new();
        for var in &def.vars {
            let v = &self.defs.vars[*var];
            if v.section == Section::InOut {
                continue;
            }
            if let Some(Slot::Instance(offset)) = self.layout.slot(*var) {
                fields.push(Field { name: v.name.to_string(), offset, ty: self.ty(v.ty) });
            }
        }
        TypeDesc::Struct { name: def.name.to_string(), fields }
    }
}
