//! Where the inputs and outputs of a program lie: in the region of plcc, and in the structs of the C reference.

use plcc::bench::app::Front;
use plcc::bench::lane::Rows;
use plcc_runtime::engine::Region;
use plcc_runtime::image::{Image, TypeDesc};
use plcc_runtime::path::Resolver;
use plcc_stdlib::elem::Elem;
use std::rc::Rc;

/// What a leaf is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// An elementary type.
    Elem(Elem),
    /// A STRING with a capacity.
    Text(usize),
}

/// An elementary variable or array element.
#[derive(Debug, Clone)]
pub struct Leaf {
    /// As in `--watch`.
    pub name: String,
    /// The variable that it is a part of.
    pub variable: String,
    /// What it is.
    pub kind: Kind,
    /// Offset in the region.
    pub region: usize,
    /// Offset in the C struct.
    pub c: usize,
}

impl Leaf {
    fn bytes(&self) -> usize {
        match self.kind {
            Kind::Elem(elem) => elem.bytes() as usize,
            Kind::Text(capacity) => capacity + 1,
        }
    }

    /// The value at a place of memory, in a form in which equal values are equal bytes.
    pub fn value<'m>(&self, memory: &'m Region, at: usize) -> &'m [u8] {
        let bytes = &memory.as_slice()[at..at + self.bytes()];
        match self.kind {
            Kind::Elem(Elem::Bool) if bytes[0] != 0 => &[1],
            Kind::Elem(_) => bytes,
            Kind::Text(_) => &bytes[..bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len())],
        }
    }
}

/// The inputs, or the outputs.
#[derive(Debug, Clone, Default)]
pub struct Side {
    /// In order of declaration.
    pub leaves: Vec<Leaf>,
    /// Size of the C struct.
    pub c_bytes: usize,
}

/// Both.
#[derive(Debug, Clone, Default)]
pub struct Interface {
    /// VAR_INPUT.
    pub inputs: Side,
    /// VAR_OUTPUT.
    pub outputs: Side,
}

impl Interface {
    /// Of the first program.
    pub fn new(front: &Front, image: &Image) -> Self {
        let resolver = Resolver::new(image);
        let [inputs, outputs] = front.interface().map(|names| side(&names, image, &resolver));
        Self { inputs, outputs }
    }

    /// Without inputs, with some variables as outputs.
    pub fn watching(names: &[&str], image: &Image) -> Self {
        let names: Vec<String> = names.iter().map(|n| (*n).to_string()).collect();
        Self { inputs: Side::default(), outputs: side(&names, image, &Resolver::new(image)) }
    }
}

/// C lays variables out in order, each at a multiple of the size of its elements, the whole at a multiple of the largest.
fn side(names: &[String], image: &Image, resolver: &Resolver) -> Side {
    let mut leaves = Vec::new();
    let (mut at, mut largest) = (0usize, 1);
    for variable in names {
        let columns = resolver.columns(variable).unwrap_or_else(|e| panic!("{e}"));
        for (name, leaf) in columns {
            let (kind, align) = match &image.types[leaf.ty as usize] {
                TypeDesc::Elem(code) | TypeDesc::Enum { elem: code, .. } | TypeDesc::Subrange { elem: code, .. } => {
                    let elem = Elem::from_code(*code).unwrap_or_else(|| panic!("{name}: no elementary type"));
                    (Kind::Elem(elem), elem.bytes() as usize)
                }
                TypeDesc::String { wide: false, capacity } => (Kind::Text(*capacity as usize), 1),
                other => panic!("{name}: a {other:?} cannot be an input or output of a benchmark"),
            };
            largest = largest.max(align);
            at = at.next_multiple_of(align);
            let leaf = Leaf { name, variable: variable.clone(), kind, region: leaf.offset as usize, c: at };
            at += leaf.bytes();
            leaves.push(leaf);
        }
    }
    Side { leaves, c_bytes: at.next_multiple_of(largest) }
}

impl Side {
    /// Rows for the C struct, which begins at `offset`.
    pub fn c_rows(&self, offset: usize, values: &[u8]) -> Rows {
        let bytes = self.leaves.last().map_or(0, |l| l.c + l.bytes());
        Rows { offset, bytes, table: Rc::new(self.table(bytes, values, |leaf| leaf.c)) }
    }

    /// Rows for the region; `like` is shared if it is the same.
    pub fn region_rows(&self, image: &Image, values: &[u8], like: &Rows) -> Rows {
        let start = self.leaves.iter().map(|l| l.region).min().unwrap_or(0);
        let end = self.leaves.iter().map(|l| l.region + l.bytes()).max().unwrap_or(0);
        // What lies between the inputs would be overwritten.
        let inside = |at: usize| (start..end).contains(&at);
        let foreign = image.roots.iter().find(|r| {
            inside(r.offset as usize) && !self.leaves.iter().any(|l| l.variable.eq_ignore_ascii_case(&r.name))
        });
        assert!(foreign.is_none(), "{foreign:?} lies between the inputs");
        let table = self.table(end - start, values, |leaf| leaf.region - start);
        let table = if *like.table == table { Rc::clone(&like.table) } else { Rc::new(table) };
        Rows { offset: start, bytes: end - start, table }
    }

    /// Rows of so many bytes with each leaf in its place; `values` has them one behind the other.
    fn table(&self, bytes: usize, values: &[u8], place: impl Fn(&Leaf) -> usize) -> Vec<u8> {
        let packed: usize = self.leaves.iter().map(Leaf::bytes).sum();
        let cycles = values.len() / packed.max(1);
        let mut table = vec![0; bytes * cycles];
        for (row, mut values) in table.chunks_exact_mut(bytes.max(1)).zip(values.chunks_exact(packed.max(1))) {
            for leaf in &self.leaves {
                let (value, rest) = values.split_at(leaf.bytes());
                row[place(leaf)..][..value.len()].copy_from_slice(value);
                values = rest;
            }
        }
        table
    }
}
