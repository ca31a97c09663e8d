//! What a compiled application tells the runtime: where its variables lie, which tasks it has, where its code comes from.
//!
//! It is bytes even for the engines inside plcc, so that every test goes the way of a linked program.

use serde::{Deserialize, Serialize};

/// First bytes of an encoded image; the digit is the version.
const MAGIC: &[u8; 8] = b"plccimg2";

/// The application.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Image {
    /// Its name.
    pub name: String,
    /// The CONFIGURATION's name; empty without one.
    pub configuration: String,
    /// The resources, in order of declaration; at least one.
    pub resources: Vec<Resource>,
    /// Size of the memory of all resources, bytes. Every offset in the image counts from its start.
    pub region_bytes: u32,
    /// With several resources: the part of the memory that they share, first byte and length.
    pub home: (u32, u32),
    /// Structural types, by index.
    pub types: Vec<TypeDesc>,
    /// Variables by their names in `--watch`.
    pub roots: Vec<Root>,
    /// Tasks, by resource, in order of declaration.
    pub tasks: Vec<Task>,
    /// The areas %I, %Q, %M: first byte and length. With several resources those that they share.
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
    /// Statements in which something can fail; see [`Source::statement`].
    pub statements: Vec<Statement>,
    /// What project.toml says about running; flags win.
    pub defaults: Defaults,
}

/// What is not said by a flag.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Defaults {
    /// `[faults] policy = "restart-task"`.
    pub restart_task: bool,
    /// `[io] driver`, as `--io` takes it.
    pub io: Option<String>,
    /// `[retain] flush`, nanoseconds.
    pub retain_flush_ns: Option<i64>,
}

/// A resource: its part of the memory, and what it shares with others.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Resource {
    /// Empty without CONFIGURATION.
    pub name: String,
    /// First byte of its part of the memory; what compiled code calls its region.
    pub start: u32,
    /// Bytes of it.
    pub bytes: u32,
    /// Configuration globals and areas of which it works on a copy (semantics.md \[C3\]).
    pub shares: Vec<Share>,
}

/// Equal values that lie one behind the other, in the shared part and in a resource's copy.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Share {
    /// First byte in the shared part.
    pub home: u32,
    /// First byte of the copy.
    pub local: u32,
    /// Bytes of all of them.
    pub bytes: u32,
    /// Bytes of one value, which is given back as a whole; 0: single bits are.
    pub unit: u32,
}

/// A type, as memory sees it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum TypeDesc {
    /// An elementary type, by [`Elem::code`](plcc_stdlib::elem::Elem::code).
    Elem(u8),
    /// A subrange of one: values from `low` to `high`.
    Subrange {
        /// The elementary type, by its code.
        elem: u8,
        /// Least value.
        low: i128,
        /// Greatest value.
        high: i128,
    },
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
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
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
    /// Its resource; `None` for what belongs to the configuration.
    pub resource: Option<u32>,
}

/// A task.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
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
    /// Index of its resource.
    pub resource: u32,
    /// The reaction time that it has to keep.
    pub deadline_ns: Option<i64>,
    /// Byte ranges of the instances of its programs: what a restart sets to initial values.
    pub programs: Vec<(u32, u32)>,
    /// Outputs that its programs own: offset, bit, bytes; a restart sets them to their safe values.
    pub outputs: Vec<(u32, Option<u8>, u32)>,
}

/// The variables of a statement.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Statement {
    /// In order of their first mention.
    pub vars: Vec<StatementVar>,
}

/// A variable that a statement mentions.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StatementVar {
    /// As it is written.
    pub name: String,
    /// The offset counts from the instance, not from the start of the resource's part.
    pub in_instance: bool,
    /// Bytes.
    pub offset: u32,
    /// The bit of a packed BOOL.
    pub bit: Option<u8>,
    /// Index of its type.
    pub ty: u32,
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
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
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
    /// Index in `statements`.
    pub statement: Option<u32>,
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
    /// The numbers of the tasks of a resource.
    pub fn tasks_of(&self, resource: usize) -> std::ops::Range<usize> {
        let first = self.tasks.partition_point(|t| (t.resource as usize) < resource);
        let behind = self.tasks.partition_point(|t| t.resource as usize <= resource);
        first..behind
    }

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
        assert_eq!(Image::decode(b"plccimg2\x05"), Err(ImageError::Damaged));
    }
}
