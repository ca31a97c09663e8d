//! Names of variables (`Main.t.Q`, `Main.a[3]`, `Res.P1.x`) to places in the region, and values there to text and back.

use crate::image::{Image, TypeDesc};
use plcc_stdlib::elem::Elem;
use plcc_stdlib::value::{self, Kind, Value};
use std::fmt::Write;

/// More columns than anybody reads; a bound for arrays of arrays.
pub const MAX_COLUMNS: usize = 1_000_000;

/// A variable of elementary, enumeration or string type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Leaf {
    /// Where in the region.
    pub offset: u32,
    /// The bit of a packed BOOL.
    pub bit: Option<u8>,
    /// Index of its type.
    pub ty: u32,
    /// CONSTANT.
    pub constant: bool,
}

/// A number inside brackets, or a name behind a dot.
#[derive(Debug, PartialEq, Eq)]
enum Part<'p> {
    Name(&'p str),
    Index(Vec<i64>),
}

fn parts(path: &str) -> Result<Vec<Part<'_>>, String> {
    let mut parts = Vec::new();
    let mut rest = path.trim();
    loop {
        let end = rest.find(['.', '[']).unwrap_or(rest.len());
        let name = rest[..end].trim();
        if name.is_empty() {
            return Err(format!("`{path}` is no name of a variable"));
        }
        parts.push(Part::Name(name));
        rest = &rest[end..];
        while let Some(inner) = rest.strip_prefix('[') {
            let close = inner.find(']').ok_or_else(|| format!("`{path}`: a `]` is missing"))?;
            let numbers: Result<Vec<i64>, _> = inner[..close].split(',').map(|n| n.trim().parse()).collect();
            parts.push(Part::Index(numbers.map_err(|_| format!("`{path}`: an index must be a number"))?));
            rest = &inner[close + 1..];
        }
        match rest.strip_prefix('.') {
            Some(more) => rest = more,
            None if rest.is_empty() => return Ok(parts),
            None => return Err(format!("`{path}` is no name of a variable")),
        }
    }
}

/// Finds names in an image.
#[derive(Debug)]
pub struct Resolver<'i> {
    image: &'i Image,
    /// Roots by upper-case name: one, or one for each resource that has it.
    roots: std::collections::HashMap<String, Vec<usize>>,
}

impl<'i> Resolver<'i> {
    /// For one image.
    pub fn new(image: &'i Image) -> Self {
        let mut roots: std::collections::HashMap<String, Vec<usize>> = std::collections::HashMap::new();
        for (n, root) in image.roots.iter().enumerate() {
            roots.entry(root.name.to_ascii_uppercase()).or_default().push(n);
        }
        Self { image, roots }
    }

    /// Only to turn values into text: it knows no names.
    pub(crate) fn types_only(image: &'i Image) -> Self {
        Self { image, roots: std::collections::HashMap::new() }
    }

    /// The columns that a name stands for: itself, or one per element of an aggregate, in order of declaration.
    pub fn columns(&self, path: &str) -> Result<Vec<(String, Leaf)>, String> {
        let mut out = Vec::new();
        match self.find(path) {
            Ok(found) => self.expand(path.trim(), &found, &mut out)?,
            Err(error) => {
                // A program's name stands for all its variables.
                let (resource, rest) = self.strip(path.trim());
                let prefix = format!("{}.", rest.to_ascii_uppercase());
                let own = self.image.roots.iter().filter(|r| {
                    r.name.to_ascii_uppercase().starts_with(&prefix)
                        && self.belongs(r, resource)
                        && !r.name.contains('$')
                });
                let mut resources = Vec::new();
                for root in own {
                    resources.push(root.resource);
                    let name = format!("{}.{}", path.trim(), &root.name[prefix.len()..]);
                    self.expand(&name, &self.root_leaf(root), &mut out)?;
                }
                resources.dedup();
                if resources.len() > 1 {
                    return Err(self.ambiguous(path, resources.into_iter()));
                }
                if out.is_empty() {
                    return Err(error);
                }
            }
        }
        Ok(out)
    }

    /// Every variable of the application.
    pub fn all(&self) -> Result<Vec<(String, Leaf)>, String> {
        let mut out = Vec::new();
        for root in self.image.roots.iter().filter(|r| !r.name.contains('$')) {
            self.expand(&self.full_name(root), &self.root_leaf(root), &mut out)?;
        }
        Ok(out)
    }

    /// The shortest name that means this root alone.
    fn full_name(&self, root: &crate::image::Root) -> String {
        let alone = self.roots.get(&root.name.to_ascii_uppercase()).is_none_or(|same| same.len() < 2);
        match root.resource.and_then(|r| self.image.resources.get(r as usize)) {
            Some(resource) if !alone => format!("{}.{}", resource.name, root.name),
            _ => root.name.clone(),
        }
    }

    /// Whether a root can be meant behind the name of a resource.
    fn belongs(&self, root: &crate::image::Root, resource: Option<u32>) -> bool {
        resource.is_none() || root.resource.is_none() || root.resource == resource
    }

    fn ambiguous(&self, path: &str, resources: impl Iterator<Item = Option<u32>>) -> String {
        let path = path.trim();
        let name = |r: Option<u32>| match r.and_then(|r| self.image.resources.get(r as usize)) {
            Some(resource) => format!("{}.{path}", resource.name),
            None => format!("{}.{path}", self.image.configuration),
        };
        format!("`{path}` is ambiguous; write {}", resources.map(name).collect::<Vec<_>>().join(" or "))
    }

    /// Every leaf, hidden ones too.
    pub(crate) fn every_leaf(&self) -> Result<Vec<(String, Leaf)>, String> {
        let mut out = Vec::new();
        for root in &self.image.roots {
            self.expand_with(&self.full_name(root), &self.root_leaf(root), true, &mut out)?;
        }
        Ok(out)
    }

    /// One variable, which must not be an aggregate.
    pub fn leaf(&self, path: &str) -> Result<Leaf, String> {
        let found = self.find(path)?;
        match self.image.types.get(found.ty as usize) {
            Some(TypeDesc::Array { .. } | TypeDesc::Struct { .. }) => {
                Err(format!("`{}` is an aggregate; name its elements", path.trim()))
            }
            _ => Ok(found),
        }
    }

    fn root_leaf(&self, root: &crate::image::Root) -> Leaf {
        Leaf { offset: root.offset, bit: root.bit, ty: root.ty, constant: root.constant }
    }

    /// The resource that stands in front of a name, if one does, and the name without it and the configuration.
    fn strip<'p>(&self, path: &'p str) -> (Option<u32>, &'p str) {
        let mut rest = path;
        let mut front = |wanted: &str| match rest.split_once('.') {
            Some((first, more)) if !wanted.is_empty() && first.eq_ignore_ascii_case(wanted) => {
                rest = more;
                true
            }
            _ => false,
        };
        front(&self.image.configuration);
        let resource = self.image.resources.iter().position(|r| front(&r.name));
        (resource.map(|r| r as u32), rest)
    }

    fn find(&self, path: &str) -> Result<Leaf, String> {
        let path = path.trim();
        // A name as it is wins over the same name behind a prefix.
        match self.find_exact(path, None) {
            Ok(found) => Ok(found),
            Err(error) => {
                let (resource, stripped) = self.strip(path);
                if let Some(found) = self.find_access(stripped) {
                    return found;
                }
                if stripped.len() == path.len() { Err(error) } else { self.find_exact(stripped, resource) }
            }
        }
    }

    /// A path that starts with a name of VAR_ACCESS.
    fn find_access(&self, path: &str) -> Option<Result<Leaf, String>> {
        let end = path.find(['.', '[']).unwrap_or(path.len());
        let access = self.image.access.iter().find(|a| a.name.eq_ignore_ascii_case(&path[..end]))?;
        let target = format!("{}{}", access.path, &path[end..]);
        let (resource, target) = match access.path.contains('.') {
            true => self.strip(&target),
            false => (None, target.as_str()),
        };
        let found = self.find_exact(target, resource);
        Some(found.map(|leaf| Leaf { constant: leaf.constant || !access.writable, ..leaf }))
    }

    fn find_exact(&self, path: &str, resource: Option<u32>) -> Result<Leaf, String> {
        let parts = parts(path)?;
        let name = |n: usize| match parts.get(n) {
            Some(Part::Name(name)) => Some(name.to_ascii_uppercase()),
            _ => None,
        };
        // A program's variables are roots of two names.
        let double = name(0).zip(name(1)).map(|(a, b)| format!("{a}.{b}"));
        let found = |key: Option<String>| -> Vec<usize> {
            let all = key.and_then(|k| self.roots.get(&k)).map(Vec::as_slice).unwrap_or_default();
            all.iter().copied().filter(|n| self.belongs(&self.image.roots[*n], resource)).collect()
        };
        let (mut candidates, mut used) = (found(double), 2);
        if candidates.is_empty() {
            (candidates, used) = (found(name(0)), 1);
        }
        let root = match candidates.as_slice() {
            [] => return Err(self.unknown(path)),
            [one] => *one,
            several => {
                // Behind a resource's name its own variable hides that of the configuration.
                let own = several.iter().find(|n| resource.is_some() && self.image.roots[**n].resource == resource);
                match own {
                    Some(own) => *own,
                    None => return Err(self.ambiguous(path, several.iter().map(|n| self.image.roots[*n].resource))),
                }
            }
        };
        let mut leaf = self.root_leaf(&self.image.roots[root]);
        for part in &parts[used..] {
            self.step(path, part, &mut leaf)?;
        }
        Ok(leaf)
    }

    fn unknown(&self, path: &str) -> String {
        let visible = self.image.roots.iter().map(|r| r.name.as_str()).filter(|n| !n.contains('$'));
        format!("there is no variable `{path}`{}", hint(path, visible))
    }

    fn step(&self, path: &str, part: &Part, leaf: &mut Leaf) -> Result<(), String> {
        match (self.image.types.get(leaf.ty as usize), part) {
            (Some(TypeDesc::Struct { fields, name }), Part::Name(wanted)) => {
                let Some(field) = fields.iter().find(|f| f.name.eq_ignore_ascii_case(wanted)) else {
                    let visible = fields.iter().map(|f| f.name.as_str()).filter(|n| !n.contains('$'));
                    return Err(format!("`{path}`: {name} has no `{wanted}`{}", hint(wanted, visible)));
                };
                leaf.offset += field.offset;
                leaf.ty = field.ty;
                Ok(())
            }
            (Some(TypeDesc::Array { dims, elem, stride }), Part::Index(index)) => {
                if index.len() != dims.len() {
                    return Err(format!("`{path}`: {} indices for {} dimensions", index.len(), dims.len()));
                }
                let mut flat: i64 = 0;
                for (i, (low, high)) in index.iter().zip(dims) {
                    if i < low || i > high {
                        return Err(format!("`{path}`: index {i} is outside {low}..{high}"));
                    }
                    flat = flat * (high - low + 1) + (i - low);
                }
                leaf.offset += flat as u32 * stride;
                leaf.ty = *elem;
                Ok(())
            }
            (_, Part::Name(wanted)) => Err(format!("`{path}`: there is no `{wanted}`")),
            (_, Part::Index(_)) => Err(format!("`{path}` is no array")),
        }
    }

    fn expand(&self, name: &str, leaf: &Leaf, out: &mut Vec<(String, Leaf)>) -> Result<(), String> {
        self.expand_with(name, leaf, false, out)
    }

    fn expand_with(&self, name: &str, leaf: &Leaf, hidden: bool, out: &mut Vec<(String, Leaf)>) -> Result<(), String> {
        if out.len() >= MAX_COLUMNS {
            return Err(format!("`{name}` makes more than {MAX_COLUMNS} columns; watch single elements"));
        }
        match self.image.types.get(leaf.ty as usize) {
            Some(TypeDesc::Struct { fields, .. }) => {
                for field in fields.iter().filter(|f| hidden || !f.name.contains('$')) {
                    let inner = Leaf { offset: leaf.offset + field.offset, ty: field.ty, ..leaf.clone() };
                    self.expand_with(&format!("{name}.{}", field.name), &inner, hidden, out)?;
                }
            }
            Some(TypeDesc::Array { dims, elem, stride }) => {
                let count: i64 = dims.iter().map(|(l, h)| h - l + 1).product();
                let mut index: Vec<i64> = dims.iter().map(|(l, _)| *l).collect();
                for n in 0..count {
                    let text: Vec<String> = index.iter().map(i64::to_string).collect();
                    let inner = Leaf { offset: leaf.offset + n as u32 * stride, ty: *elem, ..leaf.clone() };
                    self.expand_with(&format!("{name}[{}]", text.join(",")), &inner, hidden, out)?;
                    for (i, (low, high)) in index.iter_mut().zip(dims).rev() {
                        *i += 1;
                        if *i <= *high {
                            break;
                        }
                        *i = *low;
                    }
                }
            }
            _ => out.push((name.to_string(), leaf.clone())),
        }
        Ok(())
    }

    /// The value of a leaf as the trace shows it.
    pub fn text(&self, leaf: &Leaf, mem: &[u8]) -> String {
        let mut out = String::new();
        self.write(leaf, mem, &mut out);
        out
    }

    /// Appends the value of a leaf as the trace shows it.
    pub fn write(&self, leaf: &Leaf, mem: &[u8], out: &mut String) {
        let at = leaf.offset as usize;
        // Writing to a String does not fail.
        let _ = match self.image.types.get(leaf.ty as usize) {
            Some(TypeDesc::Elem(code) | TypeDesc::Subrange { elem: code, .. }) => {
                let elem = Elem::from_code(*code).unwrap_or(Elem::Lword);
                value::write_scalar(out, elem, raw(mem, leaf, elem))
            }
            Some(TypeDesc::Enum { elem, values }) => {
                let elem = Elem::from_code(*elem).unwrap_or(Elem::Int);
                let number = elem.to_i128(raw(mem, leaf, elem));
                match values.iter().find(|(_, v)| i128::from(*v) == number) {
                    Some((name, _)) => out.write_str(name),
                    None => write!(out, "{number}"),
                }
            }
            Some(TypeDesc::String { wide: false, capacity }) => {
                let text = mem.get(at..at + *capacity as usize).unwrap_or_default();
                let end = text.iter().position(|b| *b == 0).unwrap_or(text.len());
                value::write_string(out, &text[..end])
            }
            Some(TypeDesc::String { wide: true, capacity }) => {
                let bytes = mem.get(at..at + 2 * *capacity as usize).unwrap_or_default();
                let units: Vec<u16> = bytes.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
                let end = units.iter().position(|u| *u == 0).unwrap_or(units.len());
                value::write_wstring(out, &units[..end])
            }
            _ => value::write_scalar(out, Elem::Dword, raw(mem, leaf, Elem::Dword)),
        };
    }

    /// A literal's text as bytes for a leaf (one byte, 0 or 1, for a bit).
    pub fn bytes(&self, leaf: &Leaf, text: &str) -> Result<Vec<u8>, String> {
        let text = text.trim();
        match self.image.types.get(leaf.ty as usize) {
            Some(ty @ (TypeDesc::Elem(code) | TypeDesc::Subrange { elem: code, .. })) => {
                let elem = Elem::from_code(*code).unwrap_or(Elem::Lword);
                match Kind::Elem(elem).parse(text).map_err(|e| e.to_string())? {
                    Value::Scalar { raw, .. } => match ty {
                        TypeDesc::Subrange { low, high, .. } if !(*low..=*high).contains(&elem.to_i128(raw)) => {
                            Err(format!("`{text}` is outside {low}..{high}"))
                        }
                        _ => Ok(raw.to_le_bytes()[..elem.bytes() as usize].to_vec()),
                    },
                    _ => Err(format!("`{text}` is no {}", elem.name())),
                }
            }
            Some(TypeDesc::Enum { elem, values }) => {
                let elem = Elem::from_code(*elem).unwrap_or(Elem::Int);
                let name = text.rsplit('#').next().unwrap_or(text);
                match values.iter().find(|(n, _)| n.eq_ignore_ascii_case(name)) {
                    Some((_, v)) => Ok(v.to_le_bytes()[..elem.bytes() as usize].to_vec()),
                    None => {
                        let names: Vec<&str> = values.iter().map(|(n, _)| n.as_str()).collect();
                        let hint = hint(name, names.iter().copied());
                        Err(format!("`{text}` is none of {}{hint}", names.join(", ")))
                    }
                }
            }
            Some(TypeDesc::String { wide: false, capacity }) => {
                let Value::String(mut bytes) = Kind::String.parse(text).map_err(|e| e.to_string())? else {
                    return Err(format!("`{text}` is no STRING"));
                };
                bytes.truncate(*capacity as usize);
                bytes.push(0);
                Ok(bytes)
            }
            Some(TypeDesc::String { wide: true, capacity }) => {
                let Value::WString(mut units) = Kind::WString.parse(text).map_err(|e| e.to_string())? else {
                    return Err(format!("`{text}` is no WSTRING"));
                };
                units.truncate(*capacity as usize);
                units.push(0);
                Ok(units.iter().flat_map(|u| u.to_le_bytes()).collect())
            }
            _ => Err("a reference cannot be set".into()),
        }
    }
}

/// The register value of an elementary variable.
pub(crate) fn raw(mem: &[u8], leaf: &Leaf, elem: Elem) -> u64 {
    let at = leaf.offset as usize;
    let mut bytes = [0; 8];
    let width = elem.bytes() as usize;
    if let Some(source) = mem.get(at..at + width) {
        bytes[..width].copy_from_slice(source);
    }
    let value = u64::from_le_bytes(bytes);
    match (leaf.bit, elem) {
        (Some(bit), _) => value >> bit & 1,
        (None, Elem::Bool) => u64::from(value != 0),
        _ => value,
    }
}

/// Writes the bytes of a value; of a bit only that bit.
pub fn write(mem: &mut [u8], offset: u32, bit: Option<u8>, bytes: &[u8]) {
    let at = offset as usize;
    match bit {
        Some(bit) => {
            if let (Some(byte), Some(value)) = (mem.get_mut(at), bytes.first()) {
                *byte = *byte & !(1 << bit) | (value & 1) << bit;
            }
        }
        None => {
            if let Some(target) = mem.get_mut(at..at + bytes.len()) {
                target.copy_from_slice(bytes);
            }
        }
    }
}

/// `; did you mean ...?` when a name is close to the wrong one, else nothing.
fn hint<'n>(wrong: &str, names: impl Iterator<Item = &'n str>) -> String {
    let upper = wrong.to_ascii_uppercase();
    let close = names.map(|name| (distance(&upper, &name.to_ascii_uppercase()), name));
    let near = close.filter(|(d, name)| *d <= (upper.len() / 4).max(1) && *d < name.len()).min_by_key(|(d, _)| *d);
    near.map_or(String::new(), |(_, name)| format!("; did you mean `{name}`?"))
}

/// Edit distance, for suggestions.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut corner = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let cost = corner + usize::from(x != *y);
            corner = row[j + 1];
            row[j + 1] = cost.min(row[j] + 1).min(corner + 1);
        }
    }
    row[b.len()]
}

/// `--watch A,B[1,2],C`: commas inside brackets do not split.
pub fn split_names(text: &str) -> Vec<&str> {
    let (mut depth, mut start, mut names) = (0i32, 0, Vec::new());
    for (at, c) in text.char_indices() {
        match c {
            '[' => depth += 1,
            ']' => depth -= 1,
            ',' if depth <= 0 => {
                names.push(text[start..at].trim());
                start = at + 1;
            }
            _ => {}
        }
    }
    names.push(text[start..].trim());
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Field, Resource, Root};

    fn image() -> Image {
        let int = TypeDesc::Elem(Elem::Int.code());
        let percent = TypeDesc::Subrange { elem: Elem::Int.code(), low: 0, high: 100 };
        let matrix = TypeDesc::Array { dims: vec![(1, 2), (0, 1)], elem: 0, stride: 2 };
        let field = |name: &str, offset, ty| Field { name: name.into(), offset, ty };
        let block = TypeDesc::Struct { name: "Fb".into(), fields: vec![field("m", 8, 1), field("n", 0, 0)] };
        let root = |name: &str, offset, ty, bit| Root { name: name.into(), offset, bit, ty, ..Root::default() };
        Image {
            configuration: "Conf".into(),
            resources: vec![Resource { name: "Res".into(), ..Resource::default() }],
            types: vec![int, matrix, block, TypeDesc::Elem(Elem::Bool.code()), percent],
            roots: vec![root("P1.fb", 64, 2, None), root("g", 100, 0, None), root("P1.lamp", 90, 3, Some(3))],
            ..Image::default()
        }
    }

    #[test]
    fn finds_names_in_any_case_and_with_prefixes() {
        let image = image();
        let r = Resolver::new(&image);
        for path in ["P1.fb.m[2,1]", "p1.FB.M[2, 1]", "Res.P1.fb.m[2,1]", "Conf.Res.P1.fb.m[2,1]"] {
            assert_eq!(r.leaf(path).map(|l| l.offset), Ok(64 + 8 + 6), "{path}");
        }
        assert_eq!(r.leaf("Res.g").map(|l| l.offset), Ok(100));
        assert!(r.leaf("P1.fb.m[3,0]").unwrap_err().contains("outside 1..2"));
        assert!(r.leaf("P1.lamb").unwrap_err().contains("did you mean `P1.lamp`"));
        assert_eq!(hint("Sped", ["n", "speed"].into_iter()), "; did you mean `speed`?");
        assert_eq!(hint("x", ["n"].into_iter()), "");
        assert!(!r.leaf("P1.fb.xyz").unwrap_err().contains("did you mean"));
        assert!(r.leaf("P1.fb").unwrap_err().contains("aggregate"));
    }

    /// Both resources have a program P1 and a global g, and the configuration has a global c.
    #[test]
    fn several_resources_need_their_names_where_a_short_one_is_ambiguous() {
        let root = |name: &str, offset, resource| Root { name: name.into(), offset, resource, ..Root::default() };
        let resource = |name: &str| Resource { name: name.into(), ..Resource::default() };
        let image = Image {
            configuration: "Conf".into(),
            resources: vec![resource("A"), resource("B")],
            types: vec![TypeDesc::Elem(Elem::Int.code())],
            roots: vec![
                root("P1.x", 64, Some(0)),
                root("g", 70, Some(0)),
                root("P1.x", 164, Some(1)),
                root("P2.x", 166, Some(1)),
                root("g", 170, Some(1)),
                root("c", 200, None),
            ],
            ..Image::default()
        };
        let r = Resolver::new(&image);
        let at = |path: &str| r.leaf(path).map(|l| l.offset);
        assert_eq!((at("A.P1.x"), at("conf.b.p1.x"), at("P2.x")), (Ok(64), Ok(164), Ok(166)));
        assert_eq!(
            (at("A.g"), at("B.g"), at("c"), at("A.c"), at("Conf.c")),
            (Ok(70), Ok(170), Ok(200), Ok(200), Ok(200))
        );
        assert_eq!(at("P1.x"), Err("`P1.x` is ambiguous; write A.P1.x or B.P1.x".into()));
        assert_eq!(at("g"), Err("`g` is ambiguous; write A.g or B.g".into()));
        assert!(r.columns("P1").unwrap_err().contains("ambiguous"));
        assert_eq!(r.columns("B.P1").unwrap().len(), 1);
        let all: Vec<String> = r.all().unwrap().into_iter().map(|c| c.0).collect();
        assert_eq!(all, ["A.P1.x", "A.g", "B.P1.x", "P2.x", "B.g", "c"]);
    }

    #[test]
    fn aggregates_expand_in_order_of_declaration() {
        let image = image();
        let r = Resolver::new(&image);
        let names = |p| r.columns(p).unwrap().into_iter().map(|c| c.0).collect::<Vec<_>>();
        assert_eq!(names("p1.fb"), ["p1.fb.m[1,0]", "p1.fb.m[1,1]", "p1.fb.m[2,0]", "p1.fb.m[2,1]", "p1.fb.n"]);
        assert_eq!(names("P1").len(), 6);
        assert_eq!(split_names("a[1,2], b ,c"), ["a[1,2]", "b", "c"]);
    }

    #[test]
    fn bits_are_read_and_written_alone() {
        let image = image();
        let r = Resolver::new(&image);
        let leaf = r.leaf("P1.lamp").unwrap();
        let mut mem = vec![0xF0; 128];
        assert_eq!(r.text(&leaf, &mem), "FALSE");
        let bytes = r.bytes(&leaf, "TRUE").unwrap();
        write(&mut mem, leaf.offset, leaf.bit, &bytes);
        assert_eq!((mem[90], r.text(&leaf, &mem).as_str()), (0xF8, "TRUE"));
        assert!(r.bytes(&r.leaf("g").unwrap(), "T#5s").is_err());
        assert_eq!(r.bytes(&r.leaf("g").unwrap(), "INT#-2"), Ok(vec![0xFE, 0xFF]));
        let percent = Leaf { ty: 4, ..r.leaf("g").unwrap() };
        assert_eq!(r.bytes(&percent, "100"), Ok(vec![100, 0]));
        assert_eq!(r.bytes(&percent, "-1"), Err("`-1` is outside 0..100".into()));
    }
}
