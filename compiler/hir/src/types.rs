//! Resolved types, interned: two types are equal if and only if their [`TypeId`]s are.

use crate::{EnumId, PouId, StructId};
use plcc_stdlib::elem::Elem;
pub use plcc_syntax::ast::RefKind;
use rustc_hash::FxHashMap;

index_vec::define_index_type! {
    /// An interned type.
    pub struct TypeId = u32;
}

/// What a type is.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Type {
    /// A mistake that was reported; compatible with everything.
    Error,
    /// No value (a function without result).
    Void,
    /// The type of `NULL`.
    Null,
    /// An elementary type.
    Elem(Elem),
    /// `STRING[n]`, `WSTRING[n]`: `capacity` characters and a 0 behind them (semantics.md \[T8\]).
    String {
        /// WSTRING.
        wide: bool,
        /// Characters.
        capacity: u32,
    },
    /// `STRING` without length as VAR_IN_OUT: any capacity (\[S4\]).
    AnyString {
        /// WSTRING.
        wide: bool,
    },
    /// `ARRAY [low..high, ...] OF elem`, last dimension varies fastest.
    Array {
        /// Bounds of each dimension, both inclusive.
        dims: Vec<(i64, i64)>,
        /// The element type.
        elem: TypeId,
    },
    /// `ARRAY [*, ...] OF elem` as a parameter.
    AnyArray {
        /// How many dimensions.
        dims: usize,
        /// The element type.
        elem: TypeId,
    },
    /// A structure or union.
    Struct(StructId),
    /// An enumeration.
    Enum(EnumId),
    /// `INT (low..high)`; without a declared name of its own.
    Subrange {
        /// The base type.
        base: Elem,
        /// Lower limit.
        low: i128,
        /// Upper limit.
        high: i128,
    },
    /// An instance of a function block (or of a program, in configurations).
    Instance(PouId),
    /// A reference, 32-bit offset into the region (\[R1\]).
    Ref {
        /// REF_TO, POINTER TO (with arithmetic) or REFERENCE TO (followed wherever it is named, \[R5\]).
        kind: RefKind,
        /// What it points to.
        target: TypeId,
    },
}

/// The interner.
#[derive(Debug, Clone)]
pub struct Types {
    list: index_vec::IndexVec<TypeId, Type>,
    ids: FxHashMap<Type, TypeId>,
}

impl Default for Types {
    fn default() -> Self {
        let mut types = Self { list: index_vec::IndexVec::new(), ids: FxHashMap::default() };
        types.intern(Type::Error);
        types.intern(Type::Void);
        for elem in plcc_stdlib::elem::ALL {
            types.intern(Type::Elem(elem));
        }
        types
    }
}

impl Types {
    /// The type of what was reported already.
    pub const ERROR: TypeId = TypeId { _raw: 0 };
    /// No value.
    pub const VOID: TypeId = TypeId { _raw: 1 };

    /// The id of a type.
    pub fn intern(&mut self, ty: Type) -> TypeId {
        if let Some(&id) = self.ids.get(&ty) {
            return id;
        }
        let id = self.list.push(ty.clone());
        self.ids.insert(ty, id);
        id
    }

    /// What a type is.
    pub fn get(&self, id: TypeId) -> &Type {
        &self.list[id]
    }

    /// The id of an elementary type.
    pub fn elem(elem: Elem) -> TypeId {
        TypeId::from_raw(2 + u32::from(elem.code()))
    }
}

impl std::ops::Index<TypeId> for Types {
    type Output = Type;
    fn index(&self, id: TypeId) -> &Type {
        &self.list[id]
    }
}
