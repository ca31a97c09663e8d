//! A small application for unit tests.

use crate::image::*;
use plcc_stdlib::elem::Elem;

/// Offsets of the variables of [`image`].
pub mod at {
    pub const MAIN: u32 = 64;
    pub const X: u32 = 64;
    pub const GO: u32 = 66;
    pub const COLOR: u32 = 67;
    pub const T: u32 = 72;
    pub const A: u32 = 96;
    pub const M: u32 = 104;
    pub const NAME: u32 = 116;
    pub const WORD: u32 = 124;
    pub const PERCENT: u32 = 126;
    pub const G: u32 = 128;
    pub const LIMIT: u32 = 132;
    pub const OUT: u32 = 136;
    pub const IN: u32 = 140;
}

/// `PROGRAM Main`, three globals, one task `Fast`.
pub fn image() -> Image {
    let elem = |e: Elem| TypeDesc::Elem(e.code());
    let field = |name: &str, offset, ty| FieldDesc { name: name.into(), offset, ty, bit: None, flags: 0 };
    let types = vec![
        elem(Elem::Int),
        elem(Elem::Bool),
        elem(Elem::Time),
        TypeDesc::Struct {
            name: "TON".into(),
            fields: vec![
                FieldDesc { flags: flags::INPUT, ..field("IN", 0, 1) },
                FieldDesc { flags: flags::OUTPUT, ..field("Q", 1, 1) },
                FieldDesc { flags: flags::OUTPUT, ..field("ET", 8, 2) },
                field("$edge", 16, 1),
            ],
        },
        TypeDesc::Array { dims: vec![(1, 3)], elem: 0, stride: 2 },
        TypeDesc::Array { dims: vec![(0, 1), (-1, 1)], elem: 0, stride: 2 },
        TypeDesc::String { wide: false, capacity: 7 },
        TypeDesc::Enum {
            name: "Color".into(),
            elem: Elem::Sint.code(),
            values: vec![("Red".into(), 0), ("Green".into(), 5), ("Blue".into(), -1)],
        },
        TypeDesc::Struct {
            name: "Main".into(),
            fields: vec![
                field("x", at::X - at::MAIN, 0),
                field("go", at::GO - at::MAIN, 1),
                field("c", at::COLOR - at::MAIN, 7),
                field("t", at::T - at::MAIN, 3),
                field("a", at::A - at::MAIN, 4),
                field("m", at::M - at::MAIN, 5),
                field("name", at::NAME - at::MAIN, 6),
                field("w", at::WORD - at::MAIN, 9),
                field("percent", at::PERCENT - at::MAIN, 10),
                FieldDesc { bit: Some(3), flags: flags::ABSOLUTE, ..field("out", at::OUT, 1) },
            ],
        },
        elem(Elem::Word),
        TypeDesc::Subrange { elem: Elem::Sint.code(), min: 0, max: 100 },
        elem(Elem::Dint),
    ];
    let root = |name: &str, resource: &str, ty, offset, flags| VarRoot {
        name: name.into(),
        resource: resource.into(),
        configuration: "Conf".into(),
        ty,
        offset,
        bit: None,
        flags,
    };
    Image {
        name: "test".into(),
        region_bytes: 192,
        types,
        roots: vec![
            root("Main", "Res", 8, at::MAIN, 0),
            root("g", "", 11, at::G, flags::RETAIN),
            root("limit", "", 11, at::LIMIT, flags::CONSTANT),
            root("$hidden", "", 11, at::LIMIT, 0),
        ],
        tasks: vec![TaskDesc { name: "Fast".into(), watchdog_ns: 1_000_000_000, ..TaskDesc::default() }],
        retain: vec![(at::G, 4)],
        inputs: Area { offset: at::IN, len: 4 },
        outputs: Area { offset: at::OUT, len: 4 },
        memory: Area::default(),
        sources: vec![SourcePos {
            file: "main.st".into(),
            line: 7,
            column: 3,
            pou: "Main".into(),
            what: "a".into(),
        }],
        safe_state: vec![SafeState { offset: at::OUT, bit: Some(1), bytes: vec![1] }],
    }
}
