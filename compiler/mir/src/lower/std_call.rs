//! Standard functions beyond a formula: EN, ENO and outputs (semantics.md \[S6\] \[E4\]), and the choice between aggregates.
//!
//! Order: EN, the arguments, the function, the outputs, ENO. A check that fails inside the function goes to the path
//! without a result; faults of the arguments stay faults.

use super::func::FuncLower;
use super::place::Access;
use crate::ir::{Place, ValueId};
use plcc_hir::body::{Eno, Expr, StdCall};
use plcc_hir::shape::repr;
use plcc_hir::{Init, TypeId};
use plcc_stdlib::prim::Repr;

impl FuncLower<'_, '_> {
    /// A call. Its scalar result is given back; an aggregate one is written to `into`.
    pub fn std_call(&mut self, call: &StdCall, ty: TypeId, into: Option<&Access>) -> Option<ValueId> {
        let scalar = repr(self.defs, ty);
        let (join, without) = (self.b.block(), self.b.block());
        let eno = self.b.block_param(join, Repr::I8);
        let joined = scalar.map(|repr| self.b.block_param(join, repr));
        if let Some(en) = &call.en {
            let run = self.b.block();
            let enabled = self.value(en);
            self.b.branch(enabled, run, without);
            self.b.switch_to(run);
        }
        for (temp, argument) in &call.arguments {
            let place = self.temp(*temp).place;
            match repr(self.defs, argument.ty) {
                Some(_) => {
                    let value = self.value(argument);
                    self.b.store(place, value);
                }
                None => self.store_aggregate(argument, &Self::plain(place, argument.ty)),
            }
        }
        let outer = if call.eno.is_some() { Some(self.b.set_catch(Some(without))) } else { None };
        let value = match (&call.value, into) {
            (Some(value), Some(to)) => {
                self.store_aggregate(value, to);
                None
            }
            (Some(value), None) if scalar.is_some() => Some(self.value(value)),
            (Some(value), None) => {
                self.effect(value);
                None
            }
            (None, _) => None,
        };
        let outputs: Vec<ValueId> = call.outputs.iter().map(|(_, e)| self.value(e)).collect();
        if let Some(outer) = outer {
            self.b.set_catch(outer);
        }
        for ((target, _), value) in call.outputs.iter().zip(outputs) {
            let to = self.place(target);
            self.store(&to, value);
        }
        let one = self.b.number(Repr::I8, 1);
        let args: Vec<ValueId> = std::iter::once(one).chain(value).collect();
        self.b.jump(join, &args);

        self.b.switch_to(without);
        let mut args = vec![self.b.number(Repr::I8, 0)];
        match (scalar, into) {
            (Some(repr), _) => args.push(self.init_value(repr, ty, &Init::Default)),
            (None, Some(to)) => self.store_nothing(to),
            (None, None) => {}
        }
        self.b.jump(join, &args);

        self.b.switch_to(join);
        if let Some(Eno { target, negated }) = &call.eno {
            let eno = if *negated { self.b.not(eno) } else { eno };
            let access = self.place(target);
            self.store(&access, eno);
        }
        joined
    }

    /// The default of an aggregate or string.
    fn store_nothing(&mut self, to: &Access) {
        match self.text_at(to) {
            Some(text) => self.clear_text(&text),
            None => self.store_init(to.place.clone(), to.ty, &Init::Default),
        }
    }

    /// The chosen one of scalars.
    pub fn choose_value(&mut self, selector: &Expr, choices: &[Expr], ty: TypeId) -> ValueId {
        let selector = self.value(selector);
        let values: Vec<ValueId> = choices.iter().map(|e| self.value(e)).collect();
        let join = self.b.block();
        let Some(repr) = repr(self.defs, ty) else { plcc_diag::bug!("an aggregate as a scalar choice") };
        let chosen = self.b.block_param(join, repr);
        self.each_choice(selector, choices.len(), |f, n| f.b.jump(join, &[values[n]]));
        self.b.switch_to(join);
        chosen
    }

    /// Writes the chosen one of aggregates of one type.
    pub fn choose_into(&mut self, selector: &Expr, choices: &[Expr], to: Place, ty: TypeId) {
        let selector = self.value(selector);
        let mut places = Vec::with_capacity(choices.len());
        for (n, choice) in choices.iter().enumerate() {
            let mut place = self.aggregate(choice);
            // What is evaluated later may change it.
            if choices[n + 1..].iter().any(Expr::calls) {
                let temp = self.new_temp(choice.ty);
                self.copy_bytes(temp.clone(), place, choice.ty);
                place = temp;
            }
            places.push(place);
        }
        let join = self.b.block();
        self.each_choice(selector, choices.len(), |f, n| {
            f.copy_bytes(to.clone(), places[n].clone(), ty);
            f.b.jump(join, &[]);
        });
        self.b.switch_to(join);
    }

    /// One path per choice; the last one also for selectors outside.
    fn each_choice(&mut self, selector: ValueId, count: usize, mut path: impl FnMut(&mut Self, usize)) {
        let blocks: Vec<_> = (0..count).map(|_| self.b.block()).collect();
        let cases: Vec<_> = blocks.iter().enumerate().map(|(n, block)| (n as u64, *block)).collect();
        self.b.switch(selector, &cases[..count - 1], blocks[count - 1]);
        for (n, block) in blocks.into_iter().enumerate() {
            self.b.switch_to(block);
            path(self, n);
        }
    }
}
