//! What a compiled application tells the runtime: variables and their types, tasks, retain ranges, sources of faults.
//!
//! In: the driver fills an [`Image`]. Out: bytes ([`Image::encode`]), also for the JIT and the interpreter, so that each
//! run goes the way of a linked program. Names are looked up in [`path`](crate::path).

use serde::{Deserialize, Serialize};
use std::fmt;

/// First bytes of an encoded image.
const MAGIC: [u8; 4] = *b"PLCI";
/// Version of the encoding; changes with every change of the types below.
const VERSION: u32 = 1;

/// Index into [`Image::types`].
pub type TypeIdx = u32;

/// Bits of [`VarRoot::flags`] and [`FieldDesc::flags`].
pub mod flags {
    /// VAR CONSTANT: a stimulus may not set it.
    pub const CONSTANT: u8 = 1;
    /// RETAIN.
    pub const RETAIN: u8 = 2;
    /// VAR_INPUT.
    pub const INPUT: u8 = 4;
    /// VAR_OUTPUT.
    pub const OUTPUT: u8 = 8;
    /// Fields only: `offset` counts from the start of the region, not of the structure (located and external variables).
    pub const ABSOLUTE: u8 = 16;
}

/// A compiled application (one resource, one region).
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Image {
    /// Its name, for messages.
    pub name: String,
    /// Size of the region with its header.
    pub region_bytes: u32,
    /// Structural types.
    pub types: Vec<TypeDesc>,
    /// Where names start: program instances, global variables.
    pub roots: Vec<VarRoot>,
    /// In order of declaration; the index is the number that the engine knows.
    pub tasks: Vec<TaskDesc>,
    /// Byte ranges (offset, length) that a warm start keeps.
    pub retain: Vec<(u32, u32)>,
    /// %I.
    pub inputs: Area,
    /// %Q.
    pub outputs: Area,
    /// %M.
    pub memory: Area,
    /// What `FAULT_SOURCE` counts.
    pub sources: Vec<SourcePos>,
    /// What outputs become after a fault; outputs that are not named become 0.
    pub safe_state: Vec<SafeState>,
}

/// A range of the region.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Area {
    /// Its first byte.
    pub offset: u32,
    /// Its length, bytes; 0 if there is none.
    pub len: u32,
}

/// A type as it lies in memory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum TypeDesc {
    /// An elementary type by its [`code`](plcc_stdlib::elem::Elem::code).
    Elem(u8),
    /// An integer type with limits that a stimulus must keep.
    Subrange {
        /// Code of the base type.
        elem: u8,
        /// Smallest value.
        min: i128,
        /// Greatest value.
        max: i128,
    },
    /// STRING or WSTRING: `capacity` + 1 units.
    String {
        /// WSTRING.
        wide: bool,
        /// Characters.
        capacity: u32,
    },
    /// An array, last index fastest.
    Array {
        /// Lower and upper bound of each dimension.
        dims: Vec<(i64, i64)>,
        /// Of an element.
        elem: TypeIdx,
        /// Bytes from one element to the next.
        stride: u32,
    },
    /// A structure, a function block or a program.
    Struct {
        /// Of the type or POU.
        name: String,
        /// In order of declaration; names that start with `$` are hidden.
        fields: Vec<FieldDesc>,
    },
    /// An enumeration.
    Enum {
        /// Of the type.
        name: String,
        /// Code of the base type.
        elem: u8,
        /// Names and values in order of declaration.
        values: Vec<(String, i64)>,
    },
    /// A reference: 32-bit offset in the region.
    Reference,
}

/// A field of a [`TypeDesc::Struct`].
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FieldDesc {
    /// As declared.
    pub name: String,
    /// Bytes from the start of the structure (of the region with [`flags::ABSOLUTE`]).
    pub offset: u32,
    /// Of the field.
    pub ty: TypeIdx,
    /// Bit of the byte at `offset`, for a BOOL packed in an I/O area.
    pub bit: Option<u8>,
    /// See [`flags`].
    pub flags: u8,
}

/// A program instance or global variable.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct VarRoot {
    /// As declared. It may hold dots (`Main.out` for a located variable of a program).
    pub name: String,
    /// The resource, accepted in front of the name; empty without one.
    pub resource: String,
    /// The configuration, accepted in front of that; empty without one.
    pub configuration: String,
    /// Of the variable.
    pub ty: TypeIdx,
    /// Where in the region.
    pub offset: u32,
    /// Bit of the byte at `offset`, for a BOOL packed in an I/O area.
    pub bit: Option<u8>,
    /// See [`flags`].
    pub flags: u8,
}

/// A task.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TaskDesc {
    /// Its name; empty for that of programs without a task.
    pub name: String,
    /// Period; `None`: every base tick, after the others.
    pub interval_ns: Option<i64>,
    /// SINGLE: runs when this BOOL rises.
    pub single: Option<BoolAt>,
    /// 0 is the highest.
    pub priority: u32,
    /// Longest execution in real time; 0 or less: not watched.
    pub watchdog_ns: i64,
}

/// Where a BOOL lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct BoolAt {
    /// Its byte in the region.
    pub offset: u32,
    /// Its bit, if packed; otherwise any non-zero byte is TRUE.
    pub bit: Option<u8>,
}

/// A row of the source table.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SourcePos {
    /// As given to the compiler.
    pub file: String,
    /// From 1.
    pub line: u32,
    /// From 1.
    pub column: u32,
    /// The POU, `Owner.Action` for an action.
    pub pou: String,
    /// The array, variable or loop that a fault there speaks of; may be empty.
    pub what: String,
}

/// An output's value after a fault.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SafeState {
    /// Where in the region.
    pub offset: u32,
    /// The bit, for a packed BOOL (the value is then bit 0 of `bytes[0]`).
    pub bit: Option<u8>,
    /// The value.
    pub bytes: Vec<u8>,
}

/// Why bytes are no image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ImageError {
    /// They do not start like one.
    NotAnImage,
    /// Another version of plcc made them.
    Version(u32),
    /// They are cut off or damaged.
    Damaged(String),
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ImageError::NotAnImage => f.write_str("this is not an application image"),
            ImageError::Version(v) => write!(f, "the application image has version {v}, this runtime reads {VERSION}"),
            ImageError::Damaged(why) => write!(f, "the application image is damaged: {why}"),
        }
    }
}

impl std::error::Error for ImageError {}

impl Image {
    /// The image as bytes.
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        // Writing plain data into a growing vector has no way to fail.
        bytes.extend(postcard::to_stdvec(self).expect("plain data serialises"));
        bytes
    }

    /// The image that [`encode`](Image::encode) wrote; every offset lies inside the region, every type index exists.
    pub fn decode(bytes: &[u8]) -> Result<Image, ImageError> {
        let rest = bytes.strip_prefix(&MAGIC).ok_or(ImageError::NotAnImage)?;
        let (version, rest) = rest.split_first_chunk::<4>().ok_or(ImageError::NotAnImage)?;
        let version = u32::from_le_bytes(*version);
        if version != VERSION {
            return Err(ImageError::Version(version));
        }
        let image: Image = postcard::from_bytes(rest).map_err(|e| ImageError::Damaged(e.to_string()))?;
        image.validate().map_err(ImageError::Damaged)?;
        Ok(image)
    }

    /// Checks what the rest of the runtime relies on: types exist and refer only to earlier or later ones without a cycle,
    /// and every variable lies inside the region.
    pub fn validate(&self) -> Result<(), String> {
        let mut extents = vec![Extent::Unknown; self.types.len()];
        for root in &self.roots {
            let end = u64::from(root.offset) + self.extent(root.ty, &mut extents, 0)?;
            if end > u64::from(self.region_bytes) {
                return Err(format!("`{}` ends at byte {end} of {}", root.name, self.region_bytes));
            }
        }
        let areas = [self.inputs, self.outputs, self.memory].map(|a| (a.offset, a.len));
        let safe = self.safe_state.iter().map(|s| (s.offset, s.bytes.len() as u32));
        let single = self.tasks.iter().filter_map(|t| t.single).map(|s| (s.offset, 1));
        for (offset, len) in areas.into_iter().chain(safe).chain(single).chain(self.retain.iter().copied()) {
            if u64::from(offset) + u64::from(len) > u64::from(self.region_bytes) {
                return Err(format!("bytes {offset}..+{len} lie outside the region of {}", self.region_bytes));
            }
        }
        Ok(())
    }

    /// Bytes from the start of a value of this type to the end of its last part. Absolute fields are checked and count 0.
    fn extent(&self, ty: TypeIdx, known: &mut [Extent], depth: u32) -> Result<u64, String> {
        let desc = self.types.get(ty as usize).ok_or_else(|| format!("there is no type {ty}"))?;
        match known[ty as usize] {
            Extent::Bytes(n) => return Ok(n),
            // No IEC type nests this deep; the limit keeps damaged bytes from exhausting the stack.
            Extent::Open => return Err(format!("type {ty} contains itself")),
            Extent::Unknown if depth > 1000 => return Err("types are nested too deeply".into()),
            Extent::Unknown => known[ty as usize] = Extent::Open,
        }
        let elem_bytes = |code: u8| {
            let elem = plcc_stdlib::elem::Elem::from_code(code).ok_or_else(|| format!("no elementary type {code}"))?;
            Ok::<u64, String>(u64::from(elem.bytes()))
        };
        let bytes = match desc {
            TypeDesc::Elem(code) | TypeDesc::Subrange { elem: code, .. } => elem_bytes(*code)?,
            TypeDesc::Enum { elem, .. } => elem_bytes(*elem)?,
            TypeDesc::Reference => 4,
            TypeDesc::String { wide, capacity } => (u64::from(*capacity) + 1) * if *wide { 2 } else { 1 },
            TypeDesc::Array { dims, elem, stride } => {
                let one = self.extent(*elem, known, depth + 1)?;
                match element_count(dims) {
                    0 => 0,
                    n => (n - 1).saturating_mul(u64::from(*stride)).saturating_add(one),
                }
            }
            TypeDesc::Struct { fields, .. } => {
                let mut end = 0;
                for field in fields {
                    let field_end = u64::from(field.offset) + self.extent(field.ty, known, depth + 1)?;
                    if field.flags & flags::ABSOLUTE == 0 {
                        end = end.max(field_end);
                    } else if field_end > u64::from(self.region_bytes) {
                        return Err(format!("`{}` lies outside the region", field.name));
                    }
                }
                end
            }
        };
        known[ty as usize] = Extent::Bytes(bytes);
        Ok(bytes)
    }
}

/// What [`Image::extent`] knows of a type.
#[derive(Clone, Copy)]
enum Extent {
    Unknown,
    /// Being computed.
    Open,
    Bytes(u64),
}

/// Number of elements of an array.
pub fn element_count(dims: &[(i64, i64)]) -> u64 {
    dims.iter().fold(1u64, |n, (low, high)| {
        n.saturating_mul(u64::try_from(i128::from(*high) - i128::from(*low) + 1).unwrap_or(0))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_and_back() {
        let image = crate::testing::image();
        assert_eq!(Image::decode(&image.encode()), Ok(image));
    }

    #[test]
    fn damaged_bytes_are_refused() {
        let bytes = crate::testing::image().encode();
        assert_eq!(Image::decode(b"hello"), Err(ImageError::NotAnImage));
        assert_eq!(Image::decode(b"PLCI\x63\0\0\0"), Err(ImageError::Version(99)));
        for len in 8..bytes.len() {
            assert!(matches!(Image::decode(&bytes[..len]), Err(ImageError::Damaged(_))), "cut at {len}");
        }
    }

    #[test]
    fn variables_lie_inside_the_region() {
        let mut image = crate::testing::image();
        image.region_bytes = 70;
        assert!(image.validate().is_err());
        let mut image = crate::testing::image();
        let this = image.types.len() as u32;
        let field = FieldDesc { name: "next".into(), ty: this, ..FieldDesc::default() };
        image.types.push(TypeDesc::Struct { name: "Endless".into(), fields: vec![field] });
        image.roots[0].ty = this;
        assert!(image.validate().unwrap_err().contains("contains itself"));
    }
}
