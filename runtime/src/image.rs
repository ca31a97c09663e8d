//! What a compiled application tells the runtime: where its variables lie, which tasks it has, where its code comes from.
//!
//! It is bytes even for the engines inside plcc, so that every test goes the way of a linked program.

use serde::{Deserialize, Serialize};

/// First bytes of an encoded image; the digit is the version.
const MAGIC: &[u8; 8] = b"plccimg1";

/// The application.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Image {
    /// Its name.
    pub name: String,
    /// The CONFIGURATION's name; empty without one.
    pub configuration: String,
    /// The RESOURCE's name; empty without one.
    pub resource: String,
    /// Size of the memory region, bytes.
    pub region_bytes: u32,
    /// Structural types, by index.
    pub types: Vec<TypeDesc>,
    /// Variables by their names in `--watch`.
    pub roots: Vec<Root>,
    /// Tasks, in order of declaration.
    pub tasks: Vec<Task>,
    /// The areas %I, %Q, %M: first byte and length.
    pub areas: [(u32, u32); 3],
    /// Byte ranges that a warm start keeps.
    pub retain: Vec<(u32, u32)>,
    /// Where their values live when `--retain` does not say it.
    pub retain_file: Option<String>,
    /// Names of source files.
    pub files: Vec<String>,
    /// Where checks come from; a fault names a row.
    pub sources: Vec<Source>,
    /// Values that outputs take when the program stops on a fault, besides 0.
    pub safe_state: Vec<SafeValue>,
    /// VAR_ACCESS: other names of variables.
    pub access: Vec<AccessPath>,
}

/// A type, as memory sees it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum TypeDesc {
    /// An elementary type, by [`Elem::code`](plcc_stdlib::elem::Elem::code).
    Elem(u8),
    /// An enumeration.
    Enum {
        /// The elementary type of its values.
        elem: u8,
        /// Names and numbers.
        values: Vec<(String, i64)>,
    },
    /// STRING or WSTRING: `capacity` characters and a 0.
    String {
        /// WSTRING.
        wide: bool,
        /// Characters.
        capacity: u32,
    },
    /// Elements one after the other, last dimension fastest.
    Array {
        /// Bounds.
        dims: Vec<(i64, i64)>,
        /// Index of the element type.
        elem: u32,
        /// Bytes from one element to the next.
        stride: u32,
    },
    /// A structure or an instance of a function block.
    Struct {
        /// Its name.
        name: String,
        /// In order of declaration.
        fields: Vec<Field>,
    },
    /// A reference: a region offset.
    Reference,
}

/// A component.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// Bytes from the start of the structure.
    pub offset: u32,
    /// Index of its type.
    pub ty: u32,
}

/// A variable with a name of its own: `Main.x`, or a global.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Root {
    /// As in `--watch`, without configuration and resource.
    pub name: String,
    /// Where in the region.
    pub offset: u32,
    /// The bit of a packed BOOL.
    pub bit: Option<u8>,
    /// Index of its type.
    pub ty: u32,
    /// CONSTANT: a stimulus may not set it.
    pub constant: bool,
    /// RETAIN.
    pub retain: bool,
}

/// A task.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Task {
    /// Empty for the task of programs without one.
    pub name: String,
    /// `None`: every base tick, after the others.
    pub interval_ns: Option<i64>,
    /// SINGLE: the BOOL that releases the task when it rises, as a byte of the region and a bit of it.
    pub single: Option<(u32, Option<u8>)>,
    /// 0 is the highest.
    pub priority: u32,
    /// Longest execution.
    pub watchdog_ns: i64,
}

/// A name that VAR_ACCESS gives to a variable.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct AccessPath {
    /// The name.
    pub name: String,
    /// The variable's path.
    pub path: String,
    /// READ_WRITE; else it may only be watched.
    pub writable: bool,
}

/// A place in a source.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// Index in `files`.
    pub file: u32,
    /// From 1.
    pub line: u32,
    /// From 1, in characters.
    pub column: u32,
    /// The POU.
    pub pou: String,
    /// The array or variable; may be empty.
    pub what: String,
}

/// A value for the safe state.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SafeValue {
    /// Where in the region.
    pub offset: u32,
    /// The bit of a packed BOOL.
    pub bit: Option<u8>,
    /// The bytes; one, 0 or 1, for a bit.
    pub bytes: Vec<u8>,
}

/// Why bytes are no image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ImageError {
    /// They start with something else, or with another version.
    NotAnImage,
    /// They are damaged.
    Damaged,
}

impl Image {
    /// As bytes.
    pub fn encode(&self) -> Vec<u8> {
        // Plain data always serialises.
        let mut bytes = MAGIC.to_vec();
        bytes.extend(postcard::to_stdvec(self).unwrap_or_default());
        bytes
    }

    /// From bytes.
    pub fn decode(bytes: &[u8]) -> Result<Self, ImageError> {
        let rest = bytes.strip_prefix(MAGIC).ok_or(ImageError::NotAnImage)?;
        postcard::from_bytes(rest).map_err(|_| ImageError::Damaged)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn survives_encoding() {
        let image = Image { name: "x".into(), region_bytes: 64, types: vec![TypeDesc::Elem(2)], ..Image::default() };
        assert_eq!(Image::decode(&image.encode()), Ok(image));
        assert_eq!(Image::decode(b"nonsense"), Err(ImageError::NotAnImage));
        assert_eq!(Image::decode(b"plccimg1\x05"), Err(ImageError::Damaged));
    }
}
