//! Constant evaluation: the formulas of the operator and function tables, computed at once. What the engines execute and what
//! is folded here is the same text, so they cannot differ.

use crate::body::*;
use crate::cx::Cx;
use crate::defs::*;
use crate::init::Init;
use crate::text_constant::Value;
use crate::types::{Type, TypeId};
use plcc_diag::Span;
use plcc_stdlib::elem::Elem;
use plcc_stdlib::emit::Val;
use plcc_stdlib::fault::Fault;
use plcc_stdlib::fold::Folder;
use plcc_stdlib::{convert as conversions, ops};

/// Why an expression has no constant value.
#[derive(Debug, Clone)]
pub(crate) enum NotConstant {
    /// Something in it is known only at run time.
    Varies(Span),
    /// Computing it faults.
    Faults(Span, Fault),
    /// Reported already.
    Reported,
}

/// Which variables a constant expression may read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Reads {
    /// CONSTANTs only: bounds, labels.
    Constants,
    /// Initial values of any variable: initialisers (semantics.md \[S8\]).
    Initials,
}

/// Computes one formula on constant operands.
fn fold(args: &[u64], formula: impl FnOnce(&mut Folder, &[Val]) -> Option<Val>) -> Result<u64, Option<Fault>> {
    let mut folder = Folder::new();
    let vals: Vec<Val> = args.iter().map(|a| folder.value(*a)).collect();
    let result = formula(&mut folder, &vals);
    match (folder.fault(), result) {
        (Some((fault, _)), _) => Err(Some(fault)),
        (None, Some(v)) => Ok(folder.raw(v)),
        (None, None) => Err(None),
    }
}

/// A constant converted from one elementary type to another.
pub(crate) fn convert(from: Elem, to: Elem, raw: u64) -> Option<u64> {
    fold(&[raw], |e, v| conversions::convert(from, to, e, v[0])).ok()
}

impl Cx<'_> {
    /// The register value of an expression.
    pub fn eval(&mut self, e: &Expr, reads: Reads) -> Result<u64, NotConstant> {
        let formula = |r: Result<u64, Option<Fault>>| {
            r.map_err(|fault| match fault {
                Some(fault) => NotConstant::Faults(e.span, fault),
                None => NotConstant::Varies(e.span),
            })
        };
        match &e.kind {
            ExprKind::Const(raw) => Ok(*raw),
            ExprKind::Error => Err(NotConstant::Reported),
            ExprKind::Retype(inner) => self.eval(inner, reads),
            ExprKind::Convert(from, to, inner) => {
                let raw = self.eval(inner, reads)?;
                formula(fold(&[raw], |f, v| conversions::convert(*from, *to, f, v[0])))
            }
            ExprKind::Op(op, elem, args) => {
                let args = args.iter().map(|a| self.eval(a, reads)).collect::<Result<Vec<_>, _>>()?;
                formula(fold(&args, |f, v| Some(ops::emit(*op, *elem, v, f))))
            }
            ExprKind::Std { func, elem, args } => {
                let args = args.iter().map(|a| self.eval(a, reads)).collect::<Result<Vec<_>, _>>()?;
                formula(fold(&args, |f, v| func.emit(*elem, v, f)))
            }
            ExprKind::Text { op, wide, args } => match self.eval_text(*op, *wide, args, reads)? {
                Value::Scalar(raw) => Ok(raw),
                Value::Text(_) => Err(NotConstant::Varies(e.span)),
            },
            ExprKind::AndThen(a, b) => {
                if self.eval(a, reads)? == 0 {
                    Ok(0)
                } else {
                    self.eval(b, reads)
                }
            }
            ExprKind::OrElse(a, b) => {
                if self.eval(a, reads)? != 0 {
                    Ok(1)
                } else {
                    self.eval(b, reads)
                }
            }
            ExprKind::RangeCheck { value, low, high, .. } => {
                let raw = self.eval(value, reads)?;
                let v = self.elem_of(value.ty).unwrap_or(Elem::Lint).to_i128(raw);
                if v < *low || v > *high {
                    return Err(NotConstant::Faults(e.span, Fault::SubrangeViolation));
                }
                Ok(raw)
            }
            ExprKind::Read(place) => match self.initial_of(place, reads)? {
                Init::Scalar(raw) => Ok(raw),
                Init::Default => Ok(default_scalar(&self.defs, place.ty)),
                _ => Err(NotConstant::Varies(e.span)),
            },
            _ => Err(NotConstant::Varies(e.span)),
        }
    }

    /// The initial value of a place.
    pub fn initial_of(&mut self, place: &Place, reads: Reads) -> Result<Init, NotConstant> {
        let varies = NotConstant::Varies(place.span);
        let Root::Var(var) = place.root else { return Err(varies) };
        if reads == Reads::Constants && !self.defs.vars[var].constant {
            return Err(varies);
        }
        self.var_init(var);
        let mut init = self.defs.vars[var].init.clone();
        let mut ty = self.defs.vars[var].ty;
        for step in &place.steps {
            match (step, self.defs.types.get(ty).clone()) {
                (Step::Field(index), Type::Struct(id)) => {
                    let field = &self.defs.structs[id].fields[*index as usize];
                    init = field_init(&init, *index).unwrap_or_else(|| field.init.clone());
                    ty = field.ty;
                }
                (Step::Member(member), Type::Instance(pou)) => {
                    let index = self.defs.pous[pou].vars.iter().position(|v| v == member);
                    self.var_init(*member);
                    let own = self.defs.vars[*member].init.clone();
                    init = index.and_then(|i| field_init(&init, i as u32)).unwrap_or(own);
                    ty = self.defs.vars[*member].ty;
                }
                (Step::Index(indices, _), Type::Array { dims, elem }) => {
                    let mut flat: i64 = 0;
                    for (index, (low, high)) in indices.iter().zip(&dims) {
                        let v = self.eval(index, reads)? as i64;
                        if v < *low || v > *high {
                            return Err(NotConstant::Faults(index.span, Fault::IndexOutOfBounds));
                        }
                        flat = flat * (high - low + 1) + (v - low);
                    }
                    init = element_init(&init, flat as u64);
                    ty = elem;
                }
                (Step::Character { index, first, .. }, Type::String { capacity, .. }) => {
                    let v = self.eval(index, reads)? as i64;
                    let low = i64::from(*first);
                    if v < low || v > i64::from(capacity) {
                        return Err(NotConstant::Faults(index.span, Fault::IndexOutOfBounds));
                    }
                    let at = (v - low) as usize;
                    let unit = match &init {
                        Init::String(s) => s.get(at).map(|c| u64::from(*c)),
                        Init::WString(s) => s.get(at).map(|c| u64::from(*c)),
                        _ => None,
                    };
                    init = Init::Scalar(unit.unwrap_or(0));
                    // A step behind it goes into its bits.
                    ty = crate::types::Types::VOID;
                }
                _ => return Err(varies),
            }
        }
        Ok(init)
    }
}

fn field_init(init: &Init, index: u32) -> Option<Init> {
    match init {
        Init::Fields(fields) => fields.iter().find(|(i, _)| *i == index).map(|(_, v)| v.clone()),
        _ => None,
    }
}

fn element_init(init: &Init, mut index: u64) -> Init {
    if let Init::Array(runs) = init {
        for (count, value) in runs {
            if index < u64::from(*count) {
                return value.clone();
            }
            index -= u64::from(*count);
        }
    }
    Init::Default
}

/// The default of a scalar type (semantics.md \[T9\]): 0, the first enumeration value, the lower limit of a subrange without 0.
pub fn default_scalar(defs: &Defs, ty: TypeId) -> u64 {
    match defs.types.get(ty) {
        Type::Enum(id) => {
            let def = &defs.enums[*id];
            def.default as u64 & def.base.repr().mask()
        }
        Type::Subrange { base, low, high } if *low > 0 || *high < 0 => *low as u64 & base.repr().mask(),
        _ => 0,
    }
}
