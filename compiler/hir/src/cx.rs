//! What all passes over the declarations share: the name tables, what is still to be resolved, and the list of messages.

use crate::collect::charts::ChartOptions;
use crate::defs::*;
use crate::init::Init;
use crate::initial_references::{Home, Noted};
use crate::types::{Type, TypeId, Types};
use index_vec::IndexVec;
use plcc_diag::{Diagnostic, Diagnostics, FileId, Span};
use plcc_stdlib::elem::Elem;
use plcc_syntax::ast;
use rustc_hash::{FxHashMap, FxHashSet};
use smol_str::SmolStr;

/// One parsed source file.
#[derive(Debug)]
pub struct Unit<'a> {
    /// Which file.
    pub file: FileId,
    /// Its tree.
    pub ast: &'a ast::File,
    /// The profile it is read in (semantics.md \[P1\]).
    pub profile: Profile,
    /// Part of plcc: the standard function blocks.
    pub builtin: bool,
}

/// A name as IEC compares it: any case.
pub(crate) fn fold(name: &str) -> SmolStr {
    if name.bytes().any(|b| b.is_ascii_lowercase()) { name.to_ascii_uppercase().into() } else { name.into() }
}

/// A type with the initial value that its declaration gives.
#[derive(Debug, Clone)]
pub(crate) struct Resolved {
    pub ty: TypeId,
    pub init: Init,
}

impl Resolved {
    pub fn error() -> Self {
        Self { ty: Types::ERROR, init: Init::Default }
    }
}

/// How far something that is resolved on demand has come.
#[derive(Debug, Clone)]
pub(crate) enum State<T> {
    Todo,
    Busy,
    Done(T),
}

pub(crate) struct TypeSlot<'a> {
    pub decl: &'a ast::TypeDecl,
    /// The id that references may use while the fields are being resolved.
    pub early: Option<TypeId>,
    pub state: State<Resolved>,
}

pub(crate) struct VarSlot<'a> {
    /// `None` for variables that no declaration writes (a function's result).
    pub decl: Option<(&'a ast::TypeExpr, Option<&'a ast::Init>)>,
    pub ty: State<Init>,
    pub init: State<()>,
}

/// What a name means inside a POU.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Local {
    Var(VarId),
    /// VAR_EXTERNAL, followed to its global.
    External(VarId),
    /// VAR_EXTERNAL without a global; reported at its declaration.
    Missing,
    Action(PouId),
}

pub(crate) struct PouSlot<'a> {
    pub scope: FxHashMap<SmolStr, Local>,
    pub body: Option<&'a ast::Body>,
    /// How its charts move, by its pragmas.
    pub chart_options: ChartOptions,
}

pub(crate) struct Cx<'a> {
    pub defs: Defs,
    pub diags: Diagnostics,
    pub files: FxHashMap<FileId, Profile>,
    /// Files that are part of plcc: their names mean what plcc declares, whatever the user declares.
    pub builtin_files: FxHashSet<FileId>,
    pub globals: FxHashMap<SmolStr, VarId>,
    /// VAR_GLOBALs of a RESOURCE whose name an earlier RESOURCE has too: that one's, which the name means in bodies, and
    /// the own.
    pub resource_globals: Vec<(VarId, VarId)>,
    pub pous: FxHashMap<SmolStr, PouId>,
    pub types: FxHashMap<SmolStr, usize>,
    pub type_slots: Vec<TypeSlot<'a>>,
    /// Values of all enumerations by name.
    pub enum_values: FxHashMap<SmolStr, Vec<(EnumId, i128)>>,
    /// Initialisers of references, for `Defs::references`.
    pub noted: IndexVec<ReferenceId, Noted<'a>>,
    /// Those that also are part of what another initial value copies.
    pub copied_references: Vec<(ReferenceId, &'a ast::Expr, Home)>,
    pub var_slots: IndexVec<VarId, VarSlot<'a>>,
    pub pou_slots: IndexVec<PouId, PouSlot<'a>>,
    /// Where the components of a structure and the variables of an instance stand, by name.
    components: FxHashMap<TypeId, FxHashMap<SmolStr, usize>>,
    /// Types written once and used by several names (`a, b : (Red, Green)`).
    pub type_cache: FxHashMap<*const ast::TypeExpr, Resolved>,
    /// The hidden bounds of parameters that are ARRAY [*].
    pub open_bounds: FxHashMap<VarId, Vec<[VarId; 2]>>,
    /// Errors that the codesys profile would not have: for the closing note of \[P1\].
    pub codesys_only: usize,
    /// Variables that some name in a body or a constant expression means.
    pub mentioned: std::cell::RefCell<FxHashSet<VarId>>,
    /// Inputs declared R_EDGE or F_EDGE.
    pub edges: FxHashMap<VarId, crate::edges::EdgeInput>,
    /// The variables of steps; a step whose name was declared before has none.
    pub steps: FxHashMap<*const ast::Step, VarId>,
    /// Files with mistakes of syntax: what is not there may only not have been read.
    pub half_read: FxHashSet<FileId>,
    /// Names that were reported as unknown, by POU: one message each.
    reported: FxHashSet<(Option<PouId>, SmolStr)>,
    /// The same in order, for trials.
    reported_order: Vec<(Option<PouId>, SmolStr)>,
}

/// Where a trial began (see [`Cx::trial`]).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Trial {
    diags: usize,
    codesys_only: usize,
    reported: usize,
}

impl<'a> Cx<'a> {
    pub fn new(units: &[Unit<'a>]) -> Self {
        Self {
            defs: Defs::default(),
            diags: Diagnostics::new(),
            files: units.iter().map(|u| (u.file, u.profile)).collect(),
            builtin_files: units.iter().filter(|u| u.builtin).map(|u| u.file).collect(),
            globals: FxHashMap::default(),
            resource_globals: Vec::new(),
            pous: FxHashMap::default(),
            types: FxHashMap::default(),
            type_slots: Vec::new(),
            enum_values: FxHashMap::default(),
            noted: IndexVec::new(),
            copied_references: Vec::new(),
            var_slots: IndexVec::new(),
            pou_slots: IndexVec::new(),
            components: FxHashMap::default(),
            type_cache: FxHashMap::default(),
            open_bounds: FxHashMap::default(),
            codesys_only: 0,
            mentioned: Default::default(),
            edges: FxHashMap::default(),
            steps: FxHashMap::default(),
            half_read: FxHashSet::default(),
            reported: FxHashSet::default(),
            reported_order: Vec::new(),
        }
    }

    pub fn codesys(&self, span: Span) -> bool {
        self.files.get(&span.file) == Some(&Profile::Codesys)
    }

    /// Whether something about a name is reported for the first time in a POU.
    pub fn first_report(&mut self, scope: Option<PouId>, name: &str) -> bool {
        let key = (scope, fold(name));
        let new = self.reported.insert(key.clone());
        if new {
            self.reported_order.push(key);
        }
        new
    }

    /// Begins a trial: what is checked from here on only to learn a type, and is checked again.
    pub fn trial(&self) -> Trial {
        Trial { diags: self.diags.count(), codesys_only: self.codesys_only, reported: self.reported_order.len() }
    }

    /// Drops the messages of a trial.
    pub fn undo(&mut self, trial: Trial) {
        self.diags.split_off(trial.diags);
        self.codesys_only = trial.codesys_only;
        for key in self.reported_order.drain(trial.reported..) {
            self.reported.remove(&key);
        }
    }

    /// Whether a declaration gives the variable a value.
    pub fn has_initialiser(&self, var: VarId) -> bool {
        self.var_slots[var].decl.is_some_and(|(_, init)| init.is_some())
    }

    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.diags.push(diagnostic);
    }

    /// The index of a component of a structure, or of a variable of an instance in `Pou::vars`.
    pub fn component(&mut self, ty: TypeId, name: &str) -> Option<usize> {
        if !self.components.contains_key(&ty) {
            let names: FxHashMap<SmolStr, usize> = match self.defs.types.get(ty) {
                Type::Struct(id) => {
                    let fields = self.defs.structs[*id].fields.iter().enumerate();
                    fields.map(|(n, field)| (fold(&field.name), n)).collect()
                }
                Type::Instance(pou) => {
                    let vars = self.defs.pous[*pou].vars.iter().enumerate();
                    vars.map(|(n, var)| (fold(&self.defs.vars[*var].name), n)).collect()
                }
                _ => return None,
            };
            // A structure that is still being resolved has none yet.
            if names.is_empty() {
                return None;
            }
            self.components.insert(ty, names);
        }
        self.components[&ty].get(&fold(name)).copied()
    }

    /// The number of a value of an enumeration.
    pub fn enum_value(&self, id: EnumId, name: &str) -> Option<i128> {
        let named = self.enum_values.get(&fold(name))?;
        named.iter().find(|(of, _)| *of == id).map(|(_, number)| *number)
    }

    /// The ACTION of a POU, also one that shares its name with a step.
    pub fn action_named(&self, pou: PouId, name: &str) -> Option<PouId> {
        let pous = &self.defs.pous;
        pous[pou].actions.iter().copied().find(|a| pous[*a].name.eq_ignore_ascii_case(name))
    }

    /// The name of a type in messages.
    pub fn type_name(&self, ty: TypeId) -> String {
        type_name(&self.defs, ty)
    }

    /// The elementary type that holds the values of a type: itself, an enumeration's or a subrange's base.
    pub fn elem_of(&self, ty: TypeId) -> Option<Elem> {
        elem_of(&self.defs, ty)
    }
}

/// The elementary type that holds the values of a type: itself, an enumeration's or a subrange's base.
pub fn elem_of(defs: &Defs, ty: TypeId) -> Option<Elem> {
    match defs.types.get(ty) {
        Type::Elem(e) => Some(*e),
        Type::Enum(id) => Some(defs.enums[*id].base),
        Type::Subrange { base, .. } => Some(*base),
        _ => None,
    }
}

/// The name of a type as a user would write it.
pub fn type_name(defs: &Defs, ty: TypeId) -> String {
    let wide = |w: bool| if w { "WSTRING" } else { "STRING" };
    match defs.types.get(ty) {
        Type::Error => "?".into(),
        Type::Void => "no value".into(),
        Type::Null => "NULL".into(),
        Type::Elem(e) => e.name().into(),
        Type::String { wide: w, capacity } => format!("{}[{capacity}]", wide(*w)),
        Type::AnyString { wide: w } => wide(*w).into(),
        Type::Array { dims, elem } => {
            let dims: Vec<String> = dims.iter().map(|(l, h)| format!("{l}..{h}")).collect();
            format!("ARRAY [{}] OF {}", dims.join(", "), type_name(defs, *elem))
        }
        Type::AnyArray { dims, elem } => {
            format!("ARRAY [{}] OF {}", vec!["*"; *dims].join(", "), type_name(defs, *elem))
        }
        Type::Struct(id) => defs.structs[*id].name.to_string(),
        Type::Enum(id) => defs.enums[*id].name.to_string(),
        Type::Subrange { base, low, high } => format!("{} ({low}..{high})", base.name()),
        Type::Instance(pou) => defs.pous[*pou].name.to_string(),
        Type::Ref { kind, target } => format!("{} {}", kind.keyword(), type_name(defs, *target)),
    }
}

/// The candidate that a user most likely meant, if one is near enough.
pub fn similar<'n>(wanted: &str, names: impl Iterator<Item = &'n str>) -> Option<String> {
    let wanted = wanted.to_ascii_uppercase();
    let limit = (wanted.chars().count() / 3).max(1);
    names
        .filter(|n| !n.starts_with('$'))
        .map(|n| (strsim::osa_distance(&wanted, &n.to_ascii_uppercase()), n))
        .filter(|(d, n)| *d <= limit && *d < n.chars().count())
        // Of equally near ones that which begins alike.
        .min_by_key(|(d, n)| (*d, !n.get(..1).is_some_and(|c| wanted.starts_with(&c.to_ascii_uppercase())), *n))
        .map(|(_, n)| n.to_string())
}
