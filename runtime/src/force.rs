//! Forced variables (`--force A=TRUE,B=3`): they have their values at the edges of the process image, whatever inputs or the
//! program say.

use crate::path::{self, Resolver, split_names};

/// A variable that is held.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Force {
    /// Where in the memory.
    pub offset: u32,
    /// The bit of a packed BOOL.
    pub bit: Option<u8>,
    /// Its value.
    pub bytes: Vec<u8>,
}

/// `NAME=LITERAL,NAME=LITERAL`; commas inside quotes and brackets do not split.
pub fn parse(text: &str, resolver: &Resolver) -> Result<Vec<Force>, String> {
    let mut forces = Vec::new();
    for item in split_values(text) {
        let Some((name, value)) = item.split_once('=') else {
            return Err(format!("--force: `{item}` is not NAME=VALUE"));
        };
        let wrong = |e: String| format!("--force {}: {e}", name.trim());
        let leaf = resolver.leaf(name).map_err(wrong)?;
        if leaf.constant {
            return Err(wrong("it is a CONSTANT".into()));
        }
        let bytes = resolver.bytes(&leaf, value).map_err(wrong)?;
        forces.push(Force { offset: leaf.offset, bit: leaf.bit, bytes });
    }
    Ok(forces)
}

/// Sets those that lie in a part of the memory that starts at `start`.
pub fn apply(forces: &[Force], start: usize, part: &mut [u8]) {
    for force in forces {
        if let Some(at) = (force.offset as usize).checked_sub(start).filter(|at| at + force.bytes.len() <= part.len()) {
            path::write(part, at as u32, force.bit, &force.bytes);
        }
    }
}

fn split_values(text: &str) -> Vec<String> {
    let mut items: Vec<String> = Vec::new();
    let mut open = None;
    for piece in split_names(text) {
        match open.as_mut() {
            // Inside a string: the comma was part of it.
            Some(item) => {
                let item: &mut String = item;
                item.push(',');
                item.push_str(piece);
            }
            None => open = Some(piece.to_string()),
        }
        let even = |item: &str, quote: char| item.matches(quote).count().is_multiple_of(2);
        let whole = |item: &String| even(item, '\'') && even(item, '"');
        if open.as_ref().is_some_and(whole) {
            items.extend(open.take());
        }
    }
    items.extend(open);
    items.retain(|item| !item.is_empty());
    items
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Image, Root, TypeDesc};
    use plcc_stdlib::elem::Elem;

    #[test]
    fn names_and_values() {
        let root = |name: &str, offset, ty| Root { name: name.into(), offset, ty, ..Root::default() };
        let image = Image {
            types: vec![TypeDesc::Elem(Elem::Int.code()), TypeDesc::String { wide: false, capacity: 8 }],
            roots: vec![root("M.n", 64, 0), root("M.s", 66, 1)],
            ..Image::default()
        };
        let resolver = Resolver::new(&image);
        let forces = parse("M.n=-2, M.s='a,b'", &resolver).unwrap();
        let mut part = [7u8; 16];
        apply(&forces, 60, &mut part);
        assert_eq!(part, [7, 7, 7, 7, 0xFE, 0xFF, b'a', b',', b'b', 0, 7, 7, 7, 7, 7, 7]);
        apply(&forces, 65, &mut part);
        assert!(parse("M.n", &resolver).unwrap_err().contains("not NAME=VALUE"));
        assert!(parse("M.x=1", &resolver).is_err());
        assert!(parse("M.n='a'", &resolver).is_err());
    }
}
