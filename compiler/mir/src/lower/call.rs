//! Calls of functions, function block instances and actions (semantics.md \[S4\], \[S6\], \[E4\]).
//!
//! Order: EN, the instance, the arguments as they are written, then all stores, the call, the outputs, ENO.

use super::func::{FuncLower, parameters};
use super::place::{Access, Purpose};
use super::text::Text;
use crate::build::Builder;
use crate::ir::{Base, BlockId, Place, ValueId};
use crate::layout::Slot;
use plcc_diag::bug;
use plcc_hir::body::{self, Call, Callee, Eno, Expr};
use plcc_hir::shape::repr;
use plcc_hir::{Init, PouId, PouKind, Section, Type, TypeId, VarId, elem_of};
use plcc_stdlib::prim::{PrimOp, Repr};
use rustc_hash::FxHashMap;

/// An argument as it is written.
enum Written<'a> {
    Input(VarId, &'a Expr),
    InOut(VarId, &'a body::Place),
}

impl Written<'_> {
    /// Where it starts in its source.
    fn start(&self) -> u32 {
        match self {
            Written::Input(_, e) => e.span.start,
            Written::InOut(_, p) => p.span.start,
        }
    }

    fn calls(&self) -> bool {
        match self {
            Written::Input(_, e) => e.calls(),
            Written::InOut(_, p) => p.calls(),
        }
    }
}

/// An argument that was evaluated and is not stored yet.
enum Argument {
    Scalar(VarId, ValueId),
    Aggregate(VarId, Place, TypeId),
    Text(VarId, Text),
}

/// What is called.
struct Target {
    pou: PouId,
    /// `None` for a function.
    instance: Option<Access>,
}

impl FuncLower<'_, '_> {
    /// A call. Its scalar result is given back; an aggregate one is copied to `into`, if that is given.
    pub fn call(&mut self, call: &Call, into: Option<Place>) -> Option<ValueId> {
        let into = into.as_ref();
        if call.en.is_none() && call.eno.is_none() {
            let target = self.target(call);
            let value = self.invoke(call, &target, false).0;
            self.results(call, &target, into);
            return value;
        }
        let result = self.result_of(call);
        let scalar = result.and_then(|ty| repr(self.defs, ty));
        let join = self.b.block();
        let eno = self.b.block_param(join, Repr::I8);
        let joined = scalar.map(|repr| self.b.block_param(join, repr));
        if let Some(en) = &call.en {
            let (run, skip) = (self.b.block(), self.b.block());
            let enabled = self.value(en);
            self.b.branch(enabled, run, skip);
            self.b.switch_to(skip);
            self.jump_without_result(join, result, into);
            self.b.switch_to(run);
        }
        let target = self.target(call);
        let (value, status) = self.invoke(call, &target, call.eno.is_some());
        if let Some(status) = status {
            let (good, bad) = (self.b.block(), self.b.block());
            let none = self.b.number(Repr::I32, 0);
            let ok = self.b.op(PrimOp::Eq, Repr::I32, &[status, none]);
            self.b.branch(ok, good, bad);
            self.b.switch_to(bad);
            self.jump_without_result(join, result, into);
            self.b.switch_to(good);
        }
        self.results(call, &target, into);
        let one = self.b.number(Repr::I8, 1);
        let args: Vec<ValueId> = std::iter::once(one).chain(value).collect();
        self.b.jump(join, &args);
        self.b.switch_to(join);
        if let Some(Eno { target, negated }) = &call.eno {
            let eno = if *negated { self.b.not(eno) } else { eno };
            let access = self.place(target);
            self.store(&access, eno);
        }
        joined
    }

    /// ENO FALSE, and the default of the result's type.
    fn jump_without_result(&mut self, join: BlockId, result: Option<TypeId>, into: Option<&Place>) {
        let mut args = vec![self.b.number(Repr::I8, 0)];
        if let Some(ty) = result {
            match (repr(self.defs, ty), into) {
                (Some(repr), _) => args.push(self.init_value(repr, ty, &Init::Default)),
                (None, Some(place)) => self.store_init(place.clone(), ty, &Init::Default),
                (None, None) => {}
            }
        }
        self.b.jump(join, &args);
    }

    /// The type of a function's result.
    fn result_of(&self, call: &Call) -> Option<TypeId> {
        match call.callee {
            Callee::Function(pou) => self.defs.pous[pou].result.map(|var| self.defs.vars[var].ty),
            Callee::Instance(..) | Callee::Action(..) => None,
        }
    }

    fn target(&mut self, call: &Call) -> Target {
        match &call.callee {
            Callee::Function(pou) => Target { pou: *pou, instance: None },
            Callee::Instance(place, pou) | Callee::Action(Some(place), pou) => {
                Target { pou: *pou, instance: Some(self.place(place)) }
            }
            Callee::Action(None, pou) => {
                Target { pou: *pou, instance: Some(Self::plain(Place::new(Base::Instance, 0), plcc_hir::Types::VOID)) }
            }
        }
    }

    /// The arguments and the call. Gives the scalar result and, with `catch`, the fault number.
    fn invoke(&mut self, call: &Call, target: &Target, catch: bool) -> (Option<ValueId>, Option<ValueId>) {
        let arguments = self.arguments(call, target);
        let scalars = self.store_arguments(target, arguments);
        let func = self.func(target.pou);
        let result = self.result_of(call).and_then(|ty| repr(self.defs, ty));
        let instance = target.instance.as_ref().map(|i| i.place.clone());
        self.at(call.span, "");
        if catch {
            let (value, status) = self.b.call_catching(func, instance, &scalars, result);
            (value, Some(status))
        } else {
            (self.b.call(func, instance, &scalars, result), None)
        }
    }

    /// The function of a POU.
    pub fn func(&self, pou: PouId) -> crate::ir::FuncId {
        match self.cx.funcs.get(&pou) {
            Some(func) => *func,
            None => bug!("{} is called but was not reached", self.defs.pous[pou].name),
        }
    }

    /// Evaluates all arguments, as they are written.
    fn arguments(&mut self, call: &Call, target: &Target) -> Vec<Argument> {
        let inputs = call.inputs.iter().map(|(var, e)| Written::Input(*var, e));
        let in_outs = call.in_outs.iter().map(|(var, p)| Written::InOut(*var, p));
        let mut written: Vec<Written<'_>> = inputs.chain(in_outs).collect();
        written.sort_by_key(Written::start);
        let mut arguments = Vec::with_capacity(written.len());
        for (n, argument) in written.iter().enumerate() {
            arguments.push(match argument {
                Written::InOut(var, place) => Argument::Scalar(*var, self.reference(*var, place)),
                Written::Input(var, e) if repr(self.defs, e.ty).is_some() => Argument::Scalar(*var, self.value(e)),
                Written::Input(var, e) => {
                    // What is evaluated later may change it, and so may the store of another argument in the instance.
                    let stored_with_others = target.instance.is_some() && written.len() > 1;
                    let keep = stored_with_others || written[n + 1..].iter().any(Written::calls);
                    if self.is_text(e.ty) {
                        let text = if keep { self.lasting_text(e) } else { self.text(e) };
                        arguments.push(Argument::Text(*var, text));
                        continue;
                    }
                    let mut place = self.aggregate(e);
                    if keep {
                        let temp = self.new_temp(e.ty);
                        self.copy_bytes(temp.clone(), place, e.ty);
                        place = temp;
                    }
                    Argument::Aggregate(*var, place, e.ty)
                }
            });
        }
        arguments
    }

    /// What a VAR_IN_OUT holds: the reference, with the capacity above it if the parameter is a string of any.
    fn reference(&mut self, var: VarId, place: &body::Place) -> ValueId {
        if !matches!(self.defs.types[self.defs.vars[var].ty], Type::AnyString { .. }) {
            return self.address(place, Purpose::Access);
        }
        let access = self.place(place);
        match self.text_at(&access) {
            Some(text) => self.packed(&text),
            None => bug!("{:?} for a VAR_IN_OUT STRING", self.defs.types[access.ty]),
        }
    }

    /// Stores arguments where the callee looks for them; gives the values of a function's parameters.
    fn store_arguments(&mut self, target: &Target, arguments: Vec<Argument>) -> Vec<ValueId> {
        let function = target.instance.is_none();
        let mut values: FxHashMap<VarId, ValueId> = FxHashMap::default();
        let mut stored: Vec<VarId> = Vec::new();
        for argument in arguments {
            match argument {
                Argument::Scalar(var, value) if function => {
                    values.insert(var, value);
                }
                Argument::Scalar(var, value) => {
                    let slot = self.parameter(target, var);
                    self.store(&slot, value);
                }
                Argument::Aggregate(var, from, ty) => {
                    let to = self.parameter(target, var);
                    self.copy_bytes(to.place, from, ty);
                    stored.push(var);
                }
                Argument::Text(var, from) => {
                    let to = self.parameter(target, var);
                    match self.text_at(&to) {
                        Some(to) if matches!(to.place.base, Base::Frame) => self.copy_text_whole(&to, &from),
                        Some(to) => self.copy_text(&to, &from),
                        None => {}
                    }
                    stored.push(var);
                }
            }
        }
        if !function {
            return Vec::new();
        }
        // Omitted inputs take their initial value.
        let defs = self.defs;
        for &id in &defs.pous[target.pou].vars {
            let var = &defs.vars[id];
            if var.section == Section::Input && repr(defs, var.ty).is_none() && !stored.contains(&id) {
                let to = self.parameter(target, id).place;
                self.store_init(to, var.ty, &var.init);
            }
        }
        let mut scalars = Vec::new();
        for (id, repr) in parameters(defs, target.pou) {
            let var = &defs.vars[id];
            scalars.push(match values.get(&id) {
                Some(value) => *value,
                None if var.section == Section::InOut => bug!("VAR_IN_OUT {} is not connected", var.name),
                None => self.init_value(repr, var.ty, &var.init),
            });
        }
        scalars
    }

    /// Where a variable of the callee lies; for a VAR_IN_OUT its reference.
    fn parameter(&mut self, target: &Target, id: VarId) -> Access {
        match &target.instance {
            // The own instance may be that of a PROGRAM, whose variables have offsets too.
            Some(instance) => self.member_slot(instance, id),
            None => {
                let var = &self.defs.vars[id];
                debug_assert!(var.owner.is_some_and(|p| self.defs.pous[p].kind == PouKind::Function));
                let place = match self.cx.layout.slot(id) {
                    Some(Slot::Frame(offset)) => Builder::callee_frame(offset),
                    Some(Slot::Region(offset, bit)) => Place { bit, ..Place::new(Base::Region, offset) },
                    slot => bug!("a function's variable {} lies at {slot:?}", var.name),
                };
                Self::maybe_any_byte(place, var.ty)
            }
        }
    }

    /// Fetches the result and the outputs. All are read before a target is resolved, as that may call again.
    fn results(&mut self, call: &Call, target: &Target, into: Option<&Place>) {
        if let (Callee::Function(pou), Some(to)) = (&call.callee, into) {
            let Some(result) = self.defs.pous[*pou].result else { bug!("the result of a function without one") };
            let from = self.parameter(target, result);
            self.copy_bytes(to.clone(), from.place, from.ty);
        }
        let keep = call.outputs.iter().any(|o| o.target.calls());
        let mut fetched = Vec::with_capacity(call.outputs.len());
        for output in &call.outputs {
            let from = match &target.instance {
                Some(instance) => self.member(instance, output.output),
                None => self.parameter(target, output.output),
            };
            if repr(self.defs, from.ty).is_some() {
                let mut value = self.load(&from);
                if let Some((a, b)) = output.convert {
                    self.at(output.target.span, "");
                    value = self.converted(a, b, value);
                }
                if output.negated {
                    value = self.b.not(value);
                }
                fetched.push(Argument::Scalar(output.output, value));
                continue;
            }
            let mut place = from.place;
            if keep {
                let temp = self.new_temp(from.ty);
                self.copy_bytes(temp.clone(), place, from.ty);
                place = temp;
            }
            fetched.push(Argument::Aggregate(output.output, place, from.ty));
        }
        for (output, value) in call.outputs.iter().zip(fetched) {
            let to = self.place(&output.target);
            match value {
                Argument::Scalar(_, value) if self.is_text(to.ty) => {
                    let ty = self.defs.vars[output.output].ty;
                    let Some(elem) = elem_of(self.defs, ty) else { bug!("{:?} as text", self.defs.types[ty]) };
                    self.write_text(value, elem, &to);
                }
                Argument::Scalar(_, value) => self.store(&to, value),
                Argument::Aggregate(_, from, ty) => self.copy_aggregate(&to, &Self::plain(from, ty)),
                Argument::Text(..) => bug!("an output is fetched as a place"),
            }
        }
    }
}
