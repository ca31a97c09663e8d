//! The associations of steps: which action, which qualifier, for how long.

use crate::PouId;
use crate::body::{Place, Root};
use crate::chart::*;
use crate::cx::*;
use crate::expr::Checker;
use crate::place::Found;
use crate::types::Types;
use index_vec::IndexVec;
use plcc_diag::{Diagnostic, codes};
use plcc_stdlib::elem::Elem;
use plcc_syntax::ast;
use rustc_hash::FxHashMap;

/// What tells actions apart: associations with the same one are OR-ed.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Key {
    Block(PouId),
    /// A place as text: one that does not change while the program runs.
    Variable(String),
}

/// Finds the actions of a chart.
pub(super) struct Resolver<'b, 'c, 'a> {
    c: &'b mut Checker<'c, 'a>,
    owner: PouId,
    /// In the order of their first use.
    actions: IndexVec<ActionId, Action>,
    known: FxHashMap<Key, ActionId>,
    fine: bool,
}

impl<'b, 'c, 'a> Resolver<'b, 'c, 'a> {
    pub fn new(c: &'b mut Checker<'c, 'a>, owner: PouId) -> Self {
        Self { c, owner, actions: IndexVec::new(), known: FxHashMap::default(), fine: true }
    }

    /// One association; reports what is wrong with it.
    pub fn association(&mut self, a: &'a ast::ActionAssociation) -> Option<Association> {
        let action = self.action(&a.action);
        let qualifier = self.qualifier(a);
        let time = qualifier.and_then(|q| self.duration(a, q));
        for indicator in &a.indicators {
            self.c.place(indicator);
        }
        let (Some(action), Some(qualifier), Some(time)) = (action, qualifier, time) else {
            self.fine = false;
            return None;
        };
        Some(Association { action, qualifier, time, span: a.span })
    }

    /// The actions in their final order, in which blocks come first as they are declared; associations are renumbered.
    /// Also whether nothing was wrong.
    pub fn finish(self, steps: &mut IndexVec<StepId, Step>) -> (IndexVec<ActionId, Action>, bool) {
        let declared = &self.c.cx.defs.pous[self.owner].actions;
        let mut order: Vec<ActionId> = self.actions.indices().collect();
        order.sort_by_key(|id| match self.actions[*id].kind {
            ActionKind::Block(pou) => declared.iter().position(|a| *a == pou).unwrap_or(usize::MAX),
            ActionKind::Variable(_) => usize::MAX,
        });
        let mut new: IndexVec<ActionId, ActionId> = order.clone().into();
        for (position, id) in order.iter().enumerate() {
            new[*id] = ActionId::from_usize(position);
        }
        for association in steps.iter_mut().flat_map(|s| &mut s.associations) {
            association.action = new[association.action];
        }
        (order.into_iter().map(|id| self.actions[id].clone()).collect(), self.fine)
    }

    fn action(&mut self, e: &'a ast::Expr) -> Option<ActionId> {
        if let ast::ExprKind::Name(name) = &e.kind
            && let Some(block) = self.c.cx.action_named(self.owner, &name.text)
        {
            let action = Action { name: name.text.to_string(), kind: ActionKind::Block(block) };
            return Some(self.intern(Key::Block(block), action));
        }
        let place = self.variable(e)?;
        let Some(key) = place.fixed(|var| format!("{var:?}")) else {
            self.c.report(
                Diagnostic::new(codes::NOT_AN_ACTION, e.span, "which variable this action is can change at run time")
                    .help("name one BOOL variable, or set it in an ACTION block"),
            );
            return None;
        };
        let name = match &place.root {
            Root::Address(_) => key.clone(),
            _ => self.c.place_text(&place),
        };
        Some(self.intern(Key::Variable(key), Action { name, kind: ActionKind::Variable(place) }))
    }

    fn intern(&mut self, key: Key, action: Action) -> ActionId {
        *self.known.entry(key).or_insert_with(|| self.actions.push(action))
    }

    /// A BOOL variable that may be written.
    fn variable(&mut self, e: &'a ast::Expr) -> Option<Place> {
        if let ast::ExprKind::Name(name) = &e.kind {
            match self.c.lookup(name) {
                Found::Var(_) => {}
                Found::Reported => return None,
                _ => {
                    self.no_action(name);
                    return None;
                }
            }
        }
        let place = self.c.place(e)?;
        if self.c.elem_of(place.ty) != Some(Elem::Bool) {
            let ty = self.c.cx.type_name(place.ty);
            let text = self.c.place_text(&place);
            self.c.report(
                Diagnostic::new(
                    codes::NOT_AN_ACTION,
                    e.span,
                    format!("`{text}` is {ty}, an action is an ACTION block or a BOOL variable"),
                )
                .help("put what is to be done into an ACTION block and name that"),
            );
            return None;
        }
        self.c.check_writable(&place).then_some(place)
    }

    fn no_action(&mut self, name: &ast::Name) {
        if !self.c.cx.first_report(self.c.scope, &format!("action {}", fold(&name.text))) {
            return;
        }
        let defs = &self.c.cx.defs;
        let pou = &defs.pous[self.owner];
        let blocks = pou.actions.iter().map(|a| defs.pous[*a].name.as_str());
        let globals = defs.globals.iter();
        let flags = pou.vars.iter().chain(globals).map(|v| &defs.vars[*v]);
        let flags = flags.filter(|v| v.ty == Types::elem(Elem::Bool)).map(|v| v.name.as_str());
        let near = similar(&name.text, blocks.chain(flags));
        self.c.report(
            Diagnostic::new(
                codes::NOT_AN_ACTION,
                name.span,
                format!("`{}` is neither an ACTION of this POU nor a BOOL variable", name.text),
            )
            .help(match near {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("write the block `ACTION {}: ... END_ACTION`, or declare a BOOL", name.text),
            }),
        );
    }

    fn qualifier(&mut self, a: &ast::ActionAssociation) -> Option<Qualifier> {
        let Some(name) = &a.qualifier else { return Some(Qualifier::N) };
        let found = Qualifier::ALL.into_iter().find(|q| q.text().eq_ignore_ascii_case(&name.text));
        if found.is_none() {
            let near = meant(&name.text);
            self.c.report(
                Diagnostic::new(
                    codes::UNKNOWN_QUALIFIER,
                    name.span,
                    format!("there is no action qualifier `{}`", name.text),
                )
                .help(match near {
                    Some(near) => format!("did you mean `{}`?", near.text()),
                    None => "the qualifiers are N, S, R, L, D, P, P1, P0, SD, DS and SL".into(),
                }),
            );
        }
        found
    }

    /// The duration; the inner `None` for a qualifier without one.
    fn duration(&mut self, a: &'a ast::ActionAssociation, qualifier: Qualifier) -> Option<Option<crate::body::Expr>> {
        match &a.time {
            Some(e) if qualifier.timed() => {
                let value = self.c.value(e, Types::elem(Elem::Time));
                (value.ty != Types::ERROR).then_some(Some(value))
            }
            None if !qualifier.timed() => Some(None),
            Some(e) => {
                let message = format!("the qualifier {} has no duration", qualifier.text());
                self.c.report(
                    Diagnostic::new(codes::ACTION_TIME, e.span, message)
                        .help("remove it; L, D, SD, DS and SL have one"),
                );
                None
            }
            None => {
                let message = format!("the qualifier {} needs a duration", qualifier.text());
                let span = a.qualifier.as_ref().map_or(a.span, |q| q.span);
                self.c.report(
                    Diagnostic::new(codes::ACTION_TIME, span, message)
                        .help(format!("write it behind the qualifier: `({}, T#5s)`", qualifier.text())),
                );
                None
            }
        }
    }
}

/// The qualifier that was meant, if that can be told: the same letters in another order.
fn meant(text: &str) -> Option<Qualifier> {
    let letters = |text: &str| {
        let mut letters = text.to_ascii_uppercase().into_bytes();
        letters.sort_unstable();
        letters
    };
    Qualifier::ALL.into_iter().find(|q| letters(q.text()) == letters(text))
}
