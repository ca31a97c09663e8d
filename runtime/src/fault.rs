//! Tells a fault: name, place, POU and instance, the offending values, the cycle (semantics.md \[E1\]).

use crate::engine::Region;
use crate::image::{Image, TypeDesc};
use plcc_stdlib::fault::Fault;
use plcc_stdlib::region;

/// The text for standard error.
pub fn describe(image: &Image, mem: &Region, number: u32, task: usize, cycle: u64) -> String {
    let Some(fault) = Fault::from_number(number) else {
        return format!("error[E0600]: the program stopped with the unknown status {number} in cycle {cycle}\n");
    };
    let source = image.sources.get(mem.read_u32(region::FAULT_SOURCE) as usize);
    let operands = [0, 1, 2].map(|n| mem.read_i64(region::FAULT_OPERANDS + 8 * n));
    let mut out = format!("error[{}]: {}\n", fault.code(), fault.title());
    if let Some(source) = source {
        let file = image.files.get(source.file as usize).map_or("?", String::as_str);
        out.push_str(&format!("  --> {file}:{}:{}\n", source.line, source.column));
        let instance = match mem.read_u32(region::FAULT_INSTANCE) {
            0 => None,
            offset => instance_path(image, offset),
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

/// The path of the function block instance that starts at an offset; of a program, its name.
fn instance_path(image: &Image, offset: u32) -> Option<String> {
    for root in &image.roots {
        if let Some(path) = inside(image, &root.name, root.offset, root.ty, offset, 0) {
            return Some(path);
        }
    }
    // Not a function block: the program whose variables start there.
    let first = image.roots.iter().filter(|r| r.offset >= offset && r.name.contains('.')).min_by_key(|r| r.offset)?;
    first.name.split_once('.').map(|(program, _)| program.to_string())
}

fn inside(image: &Image, name: &str, start: u32, ty: u32, wanted: u32, depth: u32) -> Option<String> {
    if wanted < start || depth > 64 {
        return None;
    }
    match image.types.get(ty as usize)? {
        TypeDesc::Struct { fields, .. } => {
            if start == wanted {
                return Some(name.to_string());
            }
            let field = fields.iter().filter(|f| start + f.offset <= wanted).max_by_key(|f| f.offset)?;
            inside(image, &format!("{name}.{}", field.name), start + field.offset, field.ty, wanted, depth + 1)
        }
        TypeDesc::Array { dims, elem, stride } => {
            let mut flat = i64::from((wanted - start).checked_div(*stride)?);
            if flat >= dims.iter().map(|(l, h)| h - l + 1).product() {
                return None;
            }
            let at = start + flat as u32 * stride;
            let mut index: Vec<String> = Vec::new();
            for (low, high) in dims.iter().rev() {
                let size = high - low + 1;
                index.push((low + flat % size).to_string());
                flat /= size;
            }
            index.reverse();
            inside(image, &format!("{name}[{}]", index.join(",")), at, *elem, wanted, depth + 1)
        }
        _ => None,
    }
}
