//! The body of one POU: entry, variables that start afresh, temporaries, exit.
//!
//! The entry block is filled last: only then it is known which local variables the body uses, and the others need no
//! initial value. Outputs and the result always get theirs, because callers read them.

use super::place::Access;
use super::{Context, init};
use crate::build::Builder;
use crate::ir::{Base, BlockId, Func, Place, Source};
use crate::layout::{MAX_REGION_BYTES, Slot, TooLarge};
use index_vec::IndexVec;
use plcc_diag::{Span, bug};
use plcc_hir::body::{Root, TempId};
use plcc_hir::shape::repr;
use plcc_hir::{Body, Defs, Init, PouId, PouKind, Section, Type, TypeId, VarId};
use plcc_stdlib::prim::Repr;
use rustc_hash::{FxHashMap, FxHashSet};

/// Lowers the body of a POU.
pub(super) fn lower(cx: &mut Context<'_>, pou: PouId) -> Func {
    let defs = cx.defs;
    let def = &defs.pous[pou];
    let variables = def.owner.unwrap_or(pou);
    let function = def.kind == PouKind::Function;
    let params = if function { parameters(defs, pou) } else { Vec::new() };
    let reprs: Vec<Repr> = params.iter().map(|(_, repr)| *repr).collect();
    let name = match def.owner {
        Some(owner) => format!("{}.{}", defs.pous[owner].name, def.name),
        None => def.name.to_string(),
    };
    let result = def.result.filter(|_| function);
    let result_repr = result.and_then(|r| repr(defs, defs.vars[r].ty));
    let builder = Builder::new(name.clone(), &reprs, result_repr, !function);
    let body = &defs.bodies[pou];
    let frame_bytes = cx.layout.frame_bytes(variables);
    let mut f = FuncLower::new(cx, builder, name, Some(body), frame_bytes);
    if function {
        f.tails = super::tails::of_function(defs, pou);
    }
    let (entry, start, exit) = (BlockId::from_raw(0), f.b.block(), f.b.block());
    f.exit = exit;
    for (n, (var, _)) in params.iter().enumerate() {
        let value = f.b.params()[n];
        let place = f.own_place(*var);
        f.b.store(place, value);
    }
    f.b.switch_to(start);
    f.stmts(&body.stmts);
    if let Some(last) = body.stmts.last() {
        f.at(last.span, "");
    }
    f.b.jump(exit, &[]);
    f.b.switch_to(exit);
    let value = match (result, result_repr) {
        (Some(var), Some(repr)) => {
            let place = f.own_place(var);
            let normalise = matches!(place.base, Base::Region);
            Some(f.b.load(repr, place, normalise && f.is_bool(defs.vars[var].ty)))
        }
        _ => None,
    };
    f.b.ret(value);
    f.b.switch_to(entry);
    f.start_afresh(variables, function);
    f.b.jump(start, &[]);
    f.finish()
}

/// Scalar inputs and VAR_IN_OUTs of a function, in order of declaration: its parameters.
pub(super) fn parameters(defs: &Defs, function: PouId) -> Vec<(VarId, Repr)> {
    let of_var = |id: &VarId| {
        let var = &defs.vars[*id];
        match var.section {
            Section::Input => repr(defs, var.ty).map(|r| (*id, r)),
            // A string without length brings its capacity along.
            Section::InOut if matches!(defs.types[var.ty], Type::AnyString { .. }) => Some((*id, Repr::I64)),
            Section::InOut => Some((*id, Repr::I32)),
            _ => None,
        }
    };
    defs.pous[function].vars.iter().filter_map(of_var).collect()
}

/// A loop that is open.
#[derive(Debug, Clone, Copy)]
pub(super) struct Loop {
    /// Where EXIT goes.
    pub exit: BlockId,
    /// Where CONTINUE goes.
    pub next: BlockId,
    /// The most passes of this loop between two polls, all enclosing loops without a poll counted in.
    pub unpolled_passes: u64,
}

/// A jump target.
#[derive(Debug, Clone, Copy)]
pub(super) struct Label {
    pub block: BlockId,
    /// It was passed: a jump to it goes backwards.
    pub placed: bool,
}

/// A function that is being lowered.
pub(super) struct FuncLower<'c, 'a> {
    pub cx: &'c mut Context<'a>,
    pub defs: &'a Defs,
    pub b: Builder,
    pub exit: BlockId,
    pub loops: Vec<Loop>,
    pub labels: FxHashMap<u32, Label>,
    name: String,
    body: Option<&'a Body>,
    /// Size of the frame so far.
    frame_bytes: u64,
    temps: IndexVec<TempId, Option<u32>>,
    /// Memory for strings that an expression makes.
    pub text_temps: super::text::Temps,
    /// Strings that are lowered as a part of another one.
    pub(super) tails: FxHashMap<VarId, super::tails::Tail>,
    /// Variables in the frame (or in the static place of one whose address is taken) that the body uses.
    used: FxHashSet<VarId>,
    names: FxHashMap<(Base, u32), String>,
    /// The last row of the source table is of this function.
    has_source: bool,
}

impl<'c, 'a> FuncLower<'c, 'a> {
    /// `frame_bytes`: what its variables take.
    pub fn new(
        cx: &'c mut Context<'a>,
        mut b: Builder,
        name: String,
        body: Option<&'a Body>,
        frame_bytes: u32,
    ) -> Self {
        b.set_checks_division(cx.checks.division);
        Self {
            defs: cx.defs,
            cx,
            b,
            exit: BlockId::from_raw(0),
            loops: Vec::new(),
            labels: FxHashMap::default(),
            name,
            body,
            frame_bytes: u64::from(frame_bytes),
            temps: body.map(|b| b.temps.iter().map(|_| None).collect()).unwrap_or_default(),
            text_temps: super::text::Temps::default(),
            tails: FxHashMap::default(),
            used: FxHashSet::default(),
            names: FxHashMap::default(),
            has_source: false,
        }
    }

    /// The function.
    pub fn finish(self) -> Func {
        if self.frame_bytes > MAX_REGION_BYTES && self.cx.too_large.is_none() {
            let what = format!("the temporaries of `{}`", self.name);
            self.cx.too_large = Some(TooLarge { what, bytes: self.frame_bytes, span: None });
        }
        let mut func = self.b.finish(self.frame_bytes.min(MAX_REGION_BYTES) as u32);
        func.names = self.names.into_iter().map(|((base, at), name)| (base, at, name)).collect();
        func.names.sort();
        func
    }

    /// What follows comes from here; `what` is the variable that a fault speaks of.
    pub fn at(&mut self, span: Span, what: &str) {
        let sources = &mut self.cx.sources;
        if let (true, Some(last)) = (self.has_source, sources.last()) {
            if last.span == span && last.what == what {
                return;
            }
            // Most places neither check nor call: their rows are not kept.
            if !self.b.source_used() {
                sources.pop();
            }
        }
        let row = Source { span, pou: self.name.clone(), what: what.to_string(), inlined_at: None };
        let id = sources.push(row);
        self.b.set_source(id);
        self.has_source = true;
    }

    // ---- memory of the function ----

    /// The place of a variable of this function, VAR_TEMPs of the owner included, and of its instance.
    pub fn own_place(&mut self, id: VarId) -> Place {
        let var = &self.defs.vars[id];
        let place = match self.cx.layout.slot(id) {
            Some(Slot::Region(offset, bit)) => Place { bit, ..Place::new(Base::Region, offset) },
            Some(Slot::Instance(offset)) => Place::new(Base::Instance, offset),
            Some(Slot::Frame(offset)) => Place::new(Base::Frame, offset),
            None => bug!("variable {} of {:?} has no place", var.name, var.owner),
        };
        self.used.insert(id);
        self.name_place(&place, || var.name.to_string());
        place
    }

    /// Remembers what a place is called, for the printer.
    pub fn name_place(&mut self, place: &Place, name: impl FnOnce() -> String) {
        let fixed = place.index.is_empty() && !matches!(place.base, Base::Reference(_));
        if let (true, Ok(at)) = (fixed, u32::try_from(place.offset)) {
            self.names.entry((place.base, at)).or_insert_with(name);
        }
    }

    /// The type of a temporary of the body.
    pub fn temp_type(&self, temp: TempId) -> TypeId {
        match self.body {
            Some(body) => body.temps[temp],
            None => bug!("a temporary outside a body"),
        }
    }

    /// Where a temporary of the body lies. A string of any capacity has room for the longest one.
    pub fn temp(&mut self, temp: TempId) -> Access {
        let ty = self.temp_type(temp);
        let longest = match self.defs.types[ty] {
            Type::AnyString { wide } => Some((self.cx.longest[usize::from(wide)], if wide { 2 } else { 1 })),
            _ => None,
        };
        let place = match (self.temps[temp], longest) {
            (Some(offset), _) => Place::new(Base::Frame, offset),
            (None, Some((capacity, unit))) => self.frame_room((u64::from(capacity) + 1) * unit, unit),
            (None, None) => self.new_temp(ty),
        };
        self.temps[temp] = u32::try_from(place.offset).ok();
        let capacity = longest.map(|(capacity, _)| self.b.number(Repr::I32, u64::from(capacity)));
        let mut access = Self::plain(place, ty);
        access.capacity = capacity;
        access
    }

    /// A new temporary in the frame.
    pub fn new_temp(&mut self, ty: TypeId) -> Place {
        let shape = self.cx.layout.shapes.of(self.defs, ty);
        self.frame_room(shape.bytes, shape.align)
    }

    /// More room in the frame.
    pub fn frame_room(&mut self, bytes: u64, align: u64) -> Place {
        let offset = self.frame_bytes.next_multiple_of(align);
        self.frame_bytes = offset.saturating_add(bytes).min(1 << 62);
        let offset = offset.min(MAX_REGION_BYTES) as u32;
        let place = Place::new(Base::Frame, offset);
        self.name_place(&place, || format!("${offset}"));
        place
    }

    /// Variables that start with their initial value at each call (semantics.md \[S4\]).
    fn start_afresh(&mut self, variables: PouId, function: bool) {
        self.use_what_is_referred_to(variables);
        for &id in &self.defs.pous[variables].vars {
            let var = &self.defs.vars[id];
            let fresh = match var.section {
                Section::Output | Section::Result => function,
                Section::Local => function && self.used.contains(&id),
                Section::Temp => self.used.contains(&id),
                Section::Input | Section::InOut | Section::Global => false,
            };
            if fresh && var.address.is_none() {
                let place = self.own_place(id);
                self.store_init(place, var.ty, &var.init);
            }
        }
    }

    /// What a used variable initially refers to is used, too.
    fn use_what_is_referred_to(&mut self, variables: PouId) {
        let defs = self.defs;
        let mut referring = Vec::new();
        for &id in &defs.pous[variables].vars {
            let mut found = Vec::new();
            defs.vars[id].init.references(&mut found);
            if !found.is_empty() {
                referring.push((id, found));
            }
        }
        // One may refer to another that refers to a third.
        while let Some(n) = referring.iter().position(|(id, _)| self.used.contains(id)) {
            for reference in referring.swap_remove(n).1 {
                self.used.extend(defs.references[reference].as_ref().and_then(|place| match place.root {
                    Root::Var(var) => Some(var),
                    _ => None,
                }));
            }
        }
    }

    /// Writes an initial value into memory.
    pub fn store_init(&mut self, place: Place, ty: TypeId, init: &Init) {
        if let Some(repr) = repr(self.defs, ty) {
            let value = self.init_value(repr, ty, init);
            self.b.store(place, value);
            return;
        }
        let bytes = self.cx.layout.size(self.defs, ty);
        if self.cx.layout.shapes.init_is_zero(self.defs, ty, init) {
            self.b.zero(place, bytes);
            return;
        }
        let data = init::bytes(self.defs, self.cx.layout, ty, init, Self::home(&place));
        let constant = self.constant_place(data);
        self.b.copy(place, constant, bytes);
    }

    /// Where a variable of this function lies, for the references in it.
    fn home(place: &Place) -> init::Home {
        // What is in a frame holds no instance that refers to its own variables.
        let at = if matches!(place.base, Base::Region) { place.offset as u32 } else { 0 };
        init::Home { at, instance: at }
    }

    /// The initial value of a scalar.
    pub fn init_value(&mut self, repr: Repr, ty: TypeId, init: &Init) -> crate::ir::ValueId {
        if let Init::Reference(id) = init {
            let home = init::Home { at: 0, instance: 0 };
            let address = init::address(self.defs, self.cx.layout, *id, home);
            return self.b.number(repr, u64::from(address));
        }
        match init::scalar(self.defs, ty, init) {
            Some(raw) => self.b.number(repr, raw),
            None => bug!("an initial value {init:?} for a scalar"),
        }
    }

    /// Whether a type is BOOL.
    pub fn is_bool(&self, ty: TypeId) -> bool {
        plcc_hir::elem_of(self.defs, ty) == Some(plcc_stdlib::elem::Elem::Bool)
    }
}
