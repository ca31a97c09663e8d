//! Tells a fault: name, place, POU and instance, the offending values, the cycle (semantics.md \[E1\]).

use crate::engine::Part;
use crate::image::{Image, Root, Statement, TypeDesc};
use plcc_stdlib::fault::Fault;
use plcc_stdlib::region;

/// The text for standard error. The part holds the fault record.
pub fn describe(image: &Image, part: &Part, number: u32, task: usize, cycle: u64) -> String {
    let Some(fault) = Fault::from_number(number) else {
        return format!("error[E0600]: the program stopped with the unknown status {number} in cycle {cycle}\n");
    };
    let source = image.sources.get(part.read_u32(region::FAULT_SOURCE) as usize);
    let operands = [0, 1, 2].map(|n| part.read_i64(region::FAULT_OPERANDS + 8 * n));
    let mut out = format!("error[{}]: {}\n", fault.code(), fault.title());
    if let Some(source) = source {
        let file = image.files.get(source.file as usize).map_or("?", String::as_str);
        out.push_str(&format!("  --> {file}:{}:{}\n", source.line, source.column));
        let instance = match part.read_u32(region::FAULT_INSTANCE) {
            0 => None,
            offset => instance_path(image, &source.pou, offset + part.start() as u32),
        };
        match instance {
            Some(path) => out.push_str(&format!("  in {} (instance {path})\n", source.pou)),
            None => out.push_str(&format!("  in {}\n", source.pou)),
        }
        out.push_str(&format!("  {}\n", fault.details(&source.what, operands)));
    }
    if let Some(name) = image.tasks.get(task).map(|t| t.name.as_str()).filter(|n| !n.is_empty()) {
        out.push_str(&format!("  task {name}, "));
    } else {
        out.push_str("  ");
    }
    out.push_str(&format!("cycle {cycle}\n"));
    out
}

/// The statement in which the recorded fault happened, and the instance's offset in the part.
pub fn statement<'i>(image: &'i Image, part: &Part) -> (Option<&'i Statement>, u32) {
    let source = image.sources.get(part.read_u32(region::FAULT_SOURCE) as usize);
    let statement = source.and_then(|s| s.statement).and_then(|n| image.statements.get(n as usize));
    (statement, part.read_u32(region::FAULT_INSTANCE))
}

/// The path of the instance of a POU that starts at an offset. The variables of a program are roots of their own; its name
/// is what stands in front of their dot.
///
/// The first part of an instance starts where the instance does, so the POU decides between them. A function has no
/// instance: the one that called it is told, of those that start there the program, else the outermost.
fn instance_path(image: &Image, pou: &str, offset: u32) -> Option<String> {
    let pou = pou.split('.').next().unwrap_or(pou);
    let full = |root: &Root, path: &str| match root.resource.and_then(|r| image.resources.get(r as usize)) {
        Some(resource) if image.resources.len() > 1 => format!("{}.{path}", resource.name),
        _ => path.to_string(),
    };
    let mut outermost = None;
    for root in &image.roots {
        let mut found = Vec::new();
        inside(image, &root.name, root.offset, root.ty, offset, &mut found);
        if let Some((path, _)) = found.iter().find(|(_, name)| name.eq_ignore_ascii_case(pou)) {
            return Some(full(root, path));
        }
        outermost = outermost.or(found.into_iter().next().map(|(path, _)| full(root, &path)));
    }
    let program = || {
        let own = image.roots.iter().filter(|r| r.offset >= offset && r.name.contains('.') && r.bit.is_none());
        let root = own.min_by_key(|r| r.offset)?;
        root.name.split_once('.').map(|(program, _)| full(root, program))
    };
    let starts_program = image.tasks.iter().flat_map(|t| &t.programs).any(|(start, _)| *start == offset);
    let is_block =
        image.types.iter().any(|t| matches!(t, TypeDesc::Struct { name, .. } if name.eq_ignore_ascii_case(pou)));
    if is_block || !starts_program { outermost.or_else(program) } else { program().or(outermost) }
}

/// Collects the structures that start at `wanted` inside a variable, with the names of their types, outermost first.
fn inside(image: &Image, name: &str, start: u32, ty: u32, wanted: u32, found: &mut Vec<(String, String)>) {
    if wanted < start || found.len() > 64 {
        return;
    }
    match image.types.get(ty as usize) {
        Some(TypeDesc::Struct { fields, name: type_name }) => {
            if start == wanted {
                found.push((name.to_string(), type_name.clone()));
            }
            if let Some(field) = fields.iter().filter(|f| start + f.offset <= wanted).max_by_key(|f| f.offset) {
                inside(image, &format!("{name}.{}", field.name), start + field.offset, field.ty, wanted, found);
            }
        }
        Some(TypeDesc::Array { dims, elem, stride }) if *stride > 0 => {
            let mut flat = i64::from((wanted - start) / stride);
            if flat >= dims.iter().map(|(l, h)| h - l + 1).product() {
                return;
            }
            let at = start + flat as u32 * stride;
            let mut index: Vec<String> = Vec::new();
            for (low, high) in dims.iter().rev() {
                let size = high - low + 1;
                index.push((low + flat % size).to_string());
                flat /= size;
            }
            index.reverse();
            inside(image, &format!("{name}[{}]", index.join(",")), at, *elem, wanted, found);
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Field, Task};
    use plcc_stdlib::elem::Elem;

    /// `Main` at 64: `b : ARRAY [1..2] OF Outer` (16 bytes each), whose first variable is `i : Inner`, then `n : INT`.
    fn image() -> Image {
        let field = |name: &str, offset, ty| Field { name: name.into(), offset, ty };
        let root = |name: &str, offset, ty| Root { name: name.into(), offset, ty, ..Root::default() };
        Image {
            types: vec![
                TypeDesc::Elem(Elem::Int.code()),
                TypeDesc::Struct { name: "Inner".into(), fields: vec![field("x", 0, 0)] },
                TypeDesc::Struct { name: "Outer".into(), fields: vec![field("i", 0, 1), field("n", 8, 0)] },
                TypeDesc::Array { dims: vec![(1, 2)], elem: 2, stride: 16 },
            ],
            roots: vec![root("Main.b", 64, 3), root("Main.n", 96, 0)],
            tasks: vec![Task { programs: vec![(64, 34)], ..Task::default() }],
            ..Image::default()
        }
    }

    #[test]
    fn the_pou_decides_between_an_instance_and_its_first_part() {
        let image = image();
        let path = |pou, offset| instance_path(&image, pou, offset);
        assert_eq!(path("Main", 64).as_deref(), Some("Main"));
        assert_eq!(path("Outer", 64).as_deref(), Some("Main.b[1]"));
        assert_eq!(path("Outer.Act", 80).as_deref(), Some("Main.b[2]"));
        assert_eq!(path("Inner", 80).as_deref(), Some("Main.b[2].i"));
        // A function that the block at 80 called.
        assert_eq!(path("Helper", 80).as_deref(), Some("Main.b[2]"));
    }
}
