//! Layout and application to what the runtime must know ([`Image`]), and to the table that `plc_app_var` searches.

use crate::failure::Failure;
use crate::project::Project;
use plcc_codegen::object::Var as TableVar;
use plcc_diag::SourceMap;
use plcc_hir::app::{Application, Resource};
use plcc_hir::{Area, Defs, PouId, Section, Type, TypeId, VarId};
use plcc_mir::ir::Program;
use plcc_mir::layout::{Layout, Slot};
use plcc_runtime::image::{AccessPath, Field, Image, Root, SafeValue, Source, Task, TypeDesc};
use plcc_runtime::path::Resolver;
use plcc_stdlib::elem::Elem;
use rustc_hash::FxHashMap;

/// Builds the image of a resource.
pub fn build(
    defs: &Defs,
    app: &Application,
    layout: &Layout,
    program: &Program,
    project: &Project,
    sources: &SourceMap,
) -> Result<Image, Failure> {
    let resource = &app.resources[0];
    let mut builder = Builder { defs, layout, types: Vec::new(), ids: FxHashMap::default() };
    let roots = builder.roots(resource);
    let area = |a: Area| (layout.area(a).start, layout.area(a).bytes);
    let mut image = Image {
        name: project.name.clone(),
        configuration: app.name.to_string(),
        resource: resource.name.to_string(),
        region_bytes: program.region_bytes,
        types: builder.types,
        roots,
        tasks: resource
            .tasks
            .iter()
            .map(|t| Task {
                name: t.name.to_string(),
                interval_ns: t.interval_ns,
                single: t.single.as_ref().map(|place| layout.address_of(defs, place, 0)),
                priority: t.priority,
                watchdog_ns: t.watchdog_ns,
            })
            .collect(),
        areas: [area(Area::Input), area(Area::Output), area(Area::Memory)],
        retain: program.retain.clone(),
        retain_file: project.retain_file.as_ref().map(|path| path.to_string_lossy().into_owned()),
        files: sources.iter().map(|(_, f)| f.name.clone()).collect(),
        sources: program
            .sources
            .iter()
            .map(|s| {
                let (line, column) = sources.file(s.span.file).line_column(s.span.start);
                Source { file: s.span.file.0, line, column, pou: s.pou.clone(), what: s.what.clone() }
            })
            .collect(),
        safe_state: Vec::new(),
        access: app
            .access
            .iter()
            .map(|a| AccessPath { name: a.name.to_string(), path: a.path.clone(), writable: a.writable })
            .collect(),
    };
    image.safe_state = safe_state(&image, project, layout)?;
    Ok(image)
}

/// `[io.safe_state]`: addresses of %Q and names of variables there.
fn safe_state(image: &Image, project: &Project, layout: &Layout) -> Result<Vec<SafeValue>, Failure> {
    let resolver = Resolver::new(image);
    let wrong = |name: &str, e: String| Failure::usage(format!("[io.safe_state] \"{name}\": {e}"));
    let mut values = Vec::new();
    for (name, text) in &project.safe_state {
        if name.starts_with('%') {
            let (address, width) = plcc_hir::address::parse_with_width(name).map_err(|e| wrong(name, e))?;
            let area = layout.area(address.area);
            if address.area != Area::Output {
                return Err(wrong(name, "only outputs (%Q) have a safe state".into()));
            }
            if address.byte + width.max(1) > area.bytes {
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
                offset: area.start + address.byte,
                bit: address.bit,
                bytes: raw.to_le_bytes()[..elem.bytes() as usize].to_vec(),
            });
        } else {
            let leaf = resolver.leaf(name).map_err(|e| wrong(name, e))?;
            let area = layout.area(Area::Output);
            if !(area.start..area.end()).contains(&leaf.offset) {
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
                TypeDesc::Elem(code) | TypeDesc::Enum { elem: code, .. } => {
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
    layout: &'a Layout,
    types: Vec<TypeDesc>,
    ids: FxHashMap<TypeId, u32>,
}

impl Builder<'_> {
    fn roots(&mut self, resource: &Resource) -> Vec<Root> {
        let mut roots = Vec::new();
        for (index, program) in resource.programs.iter().enumerate() {
            for var in &self.defs.pous[program.pou].vars {
                if let Some(root) = self.root(*var, Some(&program.name), self.layout.program(index)) {
                    roots.push(root);
                }
            }
        }
        for var in &self.defs.globals {
            if let Some(root) = self.root(*var, None, 0) {
                roots.push(root);
            }
        }
        roots
    }

    /// A variable with its absolute place; `None` for those without one (VAR_TEMP, VAR_IN_OUT).
    fn root(&mut self, var: VarId, program: Option<&str>, instance: u32) -> Option<Root> {
        let v = &self.defs.vars[var];
        if v.section == Section::InOut {
            return None;
        }
        let (offset, bit) = self.layout.offset(var, instance)?;
        let name = match program {
            Some(program) => format!("{program}.{}", v.name),
            None => v.name.to_string(),
        };
        let ty = self.ty(v.ty);
        Some(Root { name, offset, bit, ty, constant: v.constant, retain: v.retain })
    }

    fn ty(&mut self, id: TypeId) -> u32 {
        if let Some(index) = self.ids.get(&id) {
            return *index;
        }
        let desc = match self.defs.types.get(id).clone() {
            Type::Elem(elem) | Type::Subrange { base: elem, .. } => TypeDesc::Elem(elem.code()),
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
