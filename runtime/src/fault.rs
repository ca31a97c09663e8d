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
            offset => instance_path(image, offset, &source.pou),
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

/// The path of the instance of a POU that starts at an offset; of a program, its name.
///
/// An instance, its first variable and the program around them may start at one offset: the POU tells which is meant.
fn instance_path(image: &Image, offset: u32, pou: &str) -> Option<String> {
    // `Owner.Action` works on its owner's instance.
    let pou = pou.split('.').next().unwrap_or(pou);
    for root in &image.roots {
        if let Some(path) = inside(image, &root.name, root.offset, root.ty, (offset, pou), 0) {
            return Some(path);
        }
    }
    // Not a function block: the program whose variables start there.
    let first = image.roots.iter().filter(|r| r.offset >= offset && r.name.contains('.')).min_by_key(|r| r.offset)?;
    first.name.split_once('.').map(|(program, _)| program.to_string())
}

fn inside(image: &Image, name: &str, start: u32, ty: u32, wanted: (u32, &str), depth: u32) -> Option<String> {
    let (offset, pou) = wanted;
    if offset < start || depth > 64 {
        return None;
    }
    match image.types.get(ty as usize)? {
        TypeDesc::Struct { fields, name: own } => {
            if start == offset && own.eq_ignore_ascii_case(pou) {
                return Some(name.to_string());
            }
            let field = fields.iter().filter(|f| start + f.offset <= offset).max_by_key(|f| f.offset)?;
            inside(image, &format!("{name}.{}", field.name), start + field.offset, field.ty, wanted, depth + 1)
        }
        TypeDesc::Array { dims, elem, stride } => {
            let mut flat = i64::from((offset - start).checked_div(*stride)?);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Field, Root};

    /// `P1.motors : ARRAY[1..3] OF Motor` at 64, a Motor being a timer `t : TON` at 0 and something behind it.
    fn image() -> Image {
        let field = |name: &str, offset, ty| Field { name: name.into(), offset, ty };
        let root =
            |name: &str, offset, ty| Root { name: name.into(), offset, bit: None, ty, constant: false, retain: false };
        Image {
            types: vec![
                TypeDesc::Elem(0),
                TypeDesc::Struct { name: "TON".into(), fields: vec![field("IN", 0, 0)] },
                TypeDesc::Struct { name: "Motor".into(), fields: vec![field("t", 0, 1), field("x", 8, 0)] },
                TypeDesc::Array { dims: vec![(1, 3)], elem: 2, stride: 16 },
            ],
            roots: vec![root("P1.motors", 64, 3), root("P1.b", 112, 0), root("g", 200, 1)],
            ..Image::default()
        }
    }

    #[test]
    fn the_pou_tells_which_of_several_instances_at_one_place() {
        let image = image();
        let path = |offset, pou| instance_path(&image, offset, pou);
        assert_eq!(path(64, "Main").as_deref(), Some("P1"), "the program itself");
        assert_eq!(path(64, "Motor").as_deref(), Some("P1.motors[1]"));
        assert_eq!(path(64, "TON").as_deref(), Some("P1.motors[1].t"));
        assert_eq!(path(96, "motor.Start").as_deref(), Some("P1.motors[3]"), "an action of it");
        assert_eq!(path(200, "TON").as_deref(), Some("g"));
        assert_eq!(path(500, "TON"), None);
    }
}
