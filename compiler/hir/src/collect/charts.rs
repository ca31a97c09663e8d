//! Declares what a chart brings into its POU: a variable for each step, and the options that its pragmas set.
//!
//! A step is a structure with `X` and `T` (semantics.md \[F6\]), so expressions, watches and traces name its parts like any
//! other; nobody but the chart may write them. Steps of a chart in an ACTION are variables of the ACTION's owner.

use super::{duplicate, new_var};
use crate::chart::{Firing, Trigger};
use crate::cx::*;
use crate::defs::*;
use crate::init::Init;
use crate::types::{Type, TypeId, Types};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::Elem;
use plcc_syntax::ast;

/// Fields of the structure of a step, by their index.
pub(crate) mod field {
    use plcc_stdlib::elem::Elem;

    /// Active.
    pub const X: u32 = crate::defs::StepFlag::FIELD;
    /// It was activated while it was active: the runtime looks for its name.
    pub const TWICE: u32 = 1;
    /// For how long.
    pub const T: u32 = 2;
    /// The clock of the call that activated it.
    pub const START: u32 = 3;
    /// Their names and types. Names that users cannot write are hidden in traces.
    pub const ALL: [(&str, Elem); 4] =
        [("X", Elem::Bool), (plcc_stdlib::chart_flags::STEP, Elem::Bool), ("T", Elem::Time), ("$start", Elem::Time)];
}

/// Options of the charts of a POU (\[F5\]).
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ChartOptions {
    pub firing: Firing,
    pub trigger: Trigger,
}

/// Whether a variable is that of a step.
pub(crate) fn is_step(cx: &Cx, var: VarId) -> bool {
    matches!(cx.defs.types[cx.defs.vars[var].ty], Type::Struct(id) if cx.defs.structs[id].flag.is_some())
}

/// Declares the steps of a body, if it is a chart.
pub(crate) fn declare_steps<'a>(cx: &mut Cx<'a>, owner: PouId, body: &'a ast::Body) {
    let ast::Body::Sfc(chart) = body else { return };
    if cx.defs.pous[owner].kind == PouKind::Function {
        // The body is refused.
        return;
    }
    let steps = chart.elements.iter().filter_map(|e| match e {
        ast::SfcElement::Step(step) => declare_step(cx, owner, step),
        ast::SfcElement::Transition(_) => None,
    });
    let structs: Vec<StructId> = steps.collect();
    for (index, id) in structs.iter().enumerate() {
        cx.defs.structs[*id].flag = Some(StepFlag { index: index as u32, steps: structs.len() as u32 });
    }
}

/// Declares one step; gives the structure of its variable.
fn declare_step<'a>(cx: &mut Cx<'a>, owner: PouId, step: &'a ast::Step) -> Option<StructId> {
    let key = fold(&step.name.text);
    match cx.pou_slots[owner].scope.get(&key).copied() {
        Some(Local::Var(first) | Local::External(first)) => {
            duplicate(cx, "step", &step.name, cx.defs.vars[first].span);
            return None;
        }
        Some(Local::Missing) => return None,
        // See `declare_action`.
        Some(Local::Action(_)) | None => {}
    }
    let (id, ty) = step_type(cx, step.name.span);
    let var = new_var(cx, step.name.text.clone(), step.name.span, Section::Local, Some(owner), None);
    cx.var_slots[var].ty = State::Done(Init::Default);
    cx.var_slots[var].init = State::Done(());
    cx.defs.vars[var].ty = ty;
    if step.initial {
        cx.defs.vars[var].init = Init::Fields(vec![(field::X, Init::Scalar(1))]);
    }
    cx.defs.pous[owner].vars.push(var);
    cx.pou_slots[owner].scope.insert(key, Local::Var(var));
    // A step is used by being there.
    cx.mentioned.borrow_mut().insert(var);
    cx.steps.insert(step, var);
    Some(id)
}

/// A structure for one step.
fn step_type(cx: &mut Cx, span: Span) -> (StructId, TypeId) {
    let make =
        |(name, elem): (&str, Elem)| Field { name: name.into(), ty: Types::elem(elem), init: Init::Default, span };
    let fields = field::ALL.into_iter().map(make).collect();
    // Which of how many is known when all are declared.
    let flag = Some(StepFlag { index: 0, steps: 1 });
    let id = cx.defs.structs.push(StructDef { name: "STEP".into(), union: false, fields, flag, span });
    (id, cx.defs.types.intern(Type::Struct(id)))
}

/// Reads the pragmas between the declarations of a POU and its first step.
pub(super) fn read_options(cx: &mut Cx, id: PouId, pou: &ast::Pou, unit: &Unit) {
    let bodies = std::iter::once(&pou.body).chain(pou.actions.iter().map(|a| &a.body));
    let steps = bodies.filter_map(|b| match b {
        ast::Body::Sfc(chart) => chart.elements.iter().find_map(|e| match e {
            ast::SfcElement::Step(step) => Some(step.span.start),
            ast::SfcElement::Transition(_) => None,
        }),
        _ => None,
    });
    let Some(first_step) = steps.min() else { return };
    let declared = pou.sections.last().map_or(pou.name.span.end, |s| s.span.end);
    let mut options = ChartOptions::default();
    for pragma in &unit.ast.pragmas {
        if !(pou.span.start..pou.span.end).contains(&pragma.span.start) {
            continue;
        }
        let Some((name, value)) = option(&pragma.text) else { continue };
        if !(declared..first_step).contains(&pragma.span.start) {
            cx.push(
                Diagnostic::new(codes::CHART_OPTION, pragma.span, format!("`{name}` has no effect here"))
                    .help("write it between the declarations and the first step of the POU"),
            );
            continue;
        }
        match (name, value.as_str()) {
            ("sfc_firing", "weak") => options.firing = Firing::Weak,
            ("sfc_firing", "strong") => options.firing = Firing::Strong,
            ("sfc_transition", "level") => options.trigger = Trigger::Level,
            ("sfc_transition", "edge") => options.trigger = Trigger::Edge,
            _ => {
                let values = if name == "sfc_firing" { ["weak", "strong"] } else { ["level", "edge"] };
                let near = similar(&value, values.into_iter()).map(|v| v.to_ascii_lowercase());
                cx.push(
                    Diagnostic::new(codes::CHART_OPTION, pragma.span, format!("`{name}` cannot be `{value}`")).help(
                        match near {
                            Some(near) => format!("did you mean `{near}`?"),
                            None => format!("it is `{}` (the default) or `{}`", values[0], values[1]),
                        },
                    ),
                );
            }
        }
    }
    cx.pou_slots[id].chart_options = options;
}

/// Name and value of `sfc_firing := 'strong'`; `None` for other pragmas.
fn option(text: &str) -> Option<(&'static str, String)> {
    let (name, value) = match text.split_once(":=") {
        Some((name, value)) => (name.trim(), value.trim().trim_matches('\'')),
        None => (text.trim(), ""),
    };
    let name = ["sfc_firing", "sfc_transition"].into_iter().find(|n| n.eq_ignore_ascii_case(name))?;
    Some((name, value.to_ascii_lowercase()))
}
