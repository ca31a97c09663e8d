//! Everything that is declared: POUs, variables, structures, enumerations, by typed ids.

use crate::body::{Body, Place};
use crate::chart::Chart;
use crate::init::Init;
use crate::types::{TypeId, Types};
use index_vec::IndexVec;
use plcc_diag::Span;
use plcc_stdlib::elem::Elem;
use smol_str::SmolStr;

pub use plcc_syntax::Profile;

index_vec::define_index_type! {
    /// A PROGRAM, FUNCTION_BLOCK, FUNCTION or ACTION.
    pub struct PouId = u32;
}
index_vec::define_index_type! {
    /// A variable of a POU, or a global one.
    pub struct VarId = u32;
}
index_vec::define_index_type! {
    /// A STRUCT or UNION.
    pub struct StructId = u32;
}
index_vec::define_index_type! {
    /// An enumeration.
    pub struct EnumId = u32;
}
index_vec::define_index_type! {
    /// A reference that has an initial value.
    pub struct ReferenceId = u32;
}

/// All declarations of one compilation.
#[derive(Debug, Clone, Default)]
pub struct Defs {
    /// The type interner.
    pub types: Types,
    /// POUs, actions among them.
    pub pous: IndexVec<PouId, Pou>,
    /// Variables of all POUs and globals.
    pub vars: IndexVec<VarId, Var>,
    /// Structures and unions.
    pub structs: IndexVec<StructId, StructDef>,
    /// Enumerations.
    pub enums: IndexVec<EnumId, EnumDef>,
    /// To what references refer initially: a variable, then components and constant indices; `None` is NULL. A variable that
    /// is not global is one of the instance whose declaration says so; what a TYPE says refers to globals only.
    pub references: IndexVec<ReferenceId, Option<Place>>,
    /// VAR_GLOBALs, in order of declaration, constants too.
    pub globals: Vec<VarId>,
    /// Checked bodies, by POU.
    pub bodies: IndexVec<PouId, Body>,
    /// Charts of the bodies in Sequential Function Chart, without those that are wrong in their structure.
    pub charts: Vec<Chart>,
}

/// Kinds of POU.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PouKind {
    /// PROGRAM.
    Program,
    /// FUNCTION_BLOCK.
    FunctionBlock,
    /// FUNCTION.
    Function,
    /// ACTION; works on the instance of its owner.
    Action,
}

/// A POU.
#[derive(Debug, Clone)]
pub struct Pou {
    /// As declared; an action's name without its owner's.
    pub name: SmolStr,
    /// Which.
    pub kind: PouKind,
    /// The POU an action belongs to: its body works on the owner's instance.
    pub owner: Option<PouId>,
    /// Own variables in order of declaration (parameters first is *not* guaranteed); VAR_EXTERNALs are not among them,
    /// they resolve to the global. An action has none, its names are the owner's.
    pub vars: Vec<VarId>,
    /// A function's result variable (it is in `vars`); `None` without result.
    pub result: Option<VarId>,
    /// Its actions.
    pub actions: Vec<PouId>,
    /// The profile of its file.
    pub profile: Profile,
    /// A standard function block that is part of plcc.
    pub builtin: bool,
    /// Where its name is declared.
    pub span: Span,
}

/// Where a variable is declared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Section {
    /// VAR.
    Local,
    /// VAR_TEMP: starts afresh at each call.
    Temp,
    /// VAR_INPUT.
    Input,
    /// VAR_OUTPUT.
    Output,
    /// VAR_IN_OUT: holds a reference (I32 region offset).
    InOut,
    /// VAR_GLOBAL.
    Global,
    /// A function's result.
    Result,
}

/// A variable.
#[derive(Debug, Clone)]
pub struct Var {
    /// As declared. Hidden variables that a notation needs (a step's timer) start with `$`.
    pub name: SmolStr,
    /// Its type.
    pub ty: TypeId,
    /// Where it is declared.
    pub section: Section,
    /// The POU; `None` for globals.
    pub owner: Option<PouId>,
    /// CONSTANT: has no memory of its own need, but is laid out all the same so that it can be watched.
    pub constant: bool,
    /// RETAIN or PERSISTENT.
    pub retain: bool,
    /// NON_RETAIN: not kept in an instance that is RETAIN either.
    pub non_retain: bool,
    /// A VAR_GLOBAL of a RESOURCE: its number in the CONFIGURATION.
    pub resource: Option<u32>,
    /// `AT %..`.
    pub address: Option<Address>,
    /// `AT %I*`: the area; each instance gets its address from VAR_CONFIG.
    pub open_address: Option<Area>,
    /// The initial value; complete, with the type's own where none is written.
    pub init: Init,
    /// `REF(x)`, `ADR(x)` occurs: lies in the addressable part of the region (semantics.md \[R2\]).
    pub address_taken: bool,
    /// Where its name is declared.
    pub span: Span,
}

impl Var {
    /// Whether a notation added it; users cannot name it.
    pub fn is_hidden(&self) -> bool {
        self.name.starts_with('$')
    }
}

/// The three areas of located variables.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Area {
    /// %I
    Input,
    /// %Q
    Output,
    /// %M
    Memory,
}

/// A located variable's place (semantics.md \[R4\]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Address {
    /// Which area.
    pub area: Area,
    /// First byte in the area.
    pub byte: u32,
    /// `%X`: which bit of that byte.
    pub bit: Option<u8>,
}

/// A STRUCT or UNION.
#[derive(Debug, Clone)]
pub struct StructDef {
    /// Its name; for an anonymous one what declares it.
    pub name: SmolStr,
    /// UNION: all fields lie at offset 0.
    pub union: bool,
    /// In order of declaration.
    pub fields: Vec<Field>,
    /// It is the type of a step: its [flag](StepFlag::FIELD) lies beside those of the other steps of its chart.
    pub flag: Option<StepFlag>,
    /// Where.
    pub span: Span,
}

/// Where the flag of a step lies. The variables of the steps of one chart stand side by side in their instance; behind the last
/// one stand the flags of all, a byte each, so that a chart looks at several of them at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StepFlag {
    /// Which step of the chart, from 0.
    pub index: u32,
    /// How many the chart has.
    pub steps: u32,
}

impl StepFlag {
    /// The field of the structure of a step that is its flag.
    pub const FIELD: u32 = 0;
}

/// A component of a structure.
#[derive(Debug, Clone)]
pub struct Field {
    /// Its name.
    pub name: SmolStr,
    /// Its type.
    pub ty: TypeId,
    /// Its initial value.
    pub init: Init,
    /// Where.
    pub span: Span,
}

/// An enumeration.
#[derive(Debug, Clone)]
pub struct EnumDef {
    /// Its name; for an anonymous one what declares it.
    pub name: SmolStr,
    /// How its values lie in memory.
    pub base: Elem,
    /// Names and numbers, in order of declaration.
    pub values: Vec<(SmolStr, i128, Span)>,
    /// Its initial value.
    pub default: i128,
    /// Where.
    pub span: Span,
}
