//! References and pointers: what they are taken of, what converts to what, arithmetic in bytes, comparison
//! (semantics.md \[R1\] to \[R3\]); REFERENCE TO, which is followed wherever it is named (\[R5\]); and what lies in the
//! addressable part because of them.
//!
//! A reference is a 32-bit offset, in the typed form a UDINT under another type.

use crate::body::*;
use crate::defs::*;
use crate::expr::*;
use crate::operators::BOOL;
use crate::types::{RefKind, Type, TypeId, Types};
use crate::visit::{self, Visitor};
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::elem::Elem;
use plcc_stdlib::ops::Op;
use plcc_syntax::ast::{self, BinaryOp};

const OFFSET: Elem = Elem::Udint;

impl<'a> Checker<'_, 'a> {
    /// `REF(x)`, `ADR(x)`.
    pub fn reference_to(&mut self, pointer: bool, call: &'a ast::Call, span: Span) -> Operand {
        let [ast::Arg { kind: ast::ArgKind::Positional(e), .. }] = call.args.as_slice() else {
            self.report(
                Diagnostic::new(codes::TOO_MANY_ARGUMENTS, span, "a reference is taken of one variable")
                    .help(if pointer { "write ADR(variable)" } else { "write REF(variable)" }),
            );
            return Operand::Error;
        };
        let Some(place) = self.place(e) else { return Operand::Error };
        let kind = if pointer { RefKind::PointerTo } else { RefKind::RefTo };
        self.reference_of(kind, place, span)
    }

    /// A reference to a place, of a kind.
    fn reference_of(&mut self, kind: RefKind, place: Place, span: Span) -> Operand {
        if !self.addressable(&place, "a reference") {
            return Operand::Error;
        }
        match &place.root {
            Root::Var(var) => {
                let v = &self.cx.defs.vars[*var];
                if v.constant && kind != RefKind::PointerTo {
                    let (name, declared) = (v.name.clone(), v.span);
                    self.report(
                        Diagnostic::new(codes::NO_REFERENCE, span, format!("`{name}` is a CONSTANT"))
                            .also(declared, "declared here")
                            .help("a reference could change it; take the reference of a variable"),
                    );
                    return Operand::Error;
                }
                self.cx.defs.vars[*var].address_taken = true;
            }
            // What a reference points to can be referred to again; the layout sees addresses that are taken.
            Root::Deref(_) | Root::Address(_) => {}
            Root::Temp(_) => {
                self.report(
                    Diagnostic::new(codes::NO_REFERENCE, span, "this value has no address")
                        .help("assign it to a variable and refer to that"),
                );
                return Operand::Error;
            }
        }
        // The address of an array without fixed bounds is that of its first element.
        let target = match self.cx.defs.types.get(place.ty) {
            Type::AnyArray { elem, .. } => *elem,
            // That of a string without fixed capacity is taken as one of the default capacity.
            Type::AnyString { wide } => {
                let (wide, capacity) = (*wide, crate::resolve::DEFAULT_STRING);
                self.cx.defs.types.intern(Type::String { wide, capacity })
            }
            _ => place.ty,
        };
        let ty = self.cx.defs.types.intern(Type::Ref { kind, target });
        Operand::value(ExprKind::RefOf(place), ty, span)
    }

    /// Whether values of a type are followed wherever they are named.
    pub fn is_reference_to(&self, ty: TypeId) -> bool {
        matches!(self.cx.defs.types.get(ty), Type::Ref { kind: RefKind::ReferenceTo, .. })
    }

    /// A place, or what it refers to if it is a REFERENCE TO.
    pub fn followed(&self, mut place: Place) -> Place {
        if let Type::Ref { kind: RefKind::ReferenceTo, target } = *self.cx.defs.types.get(place.ty) {
            place.steps.push(Step::Deref);
            place.ty = target;
        }
        place
    }

    /// A value, or that of what it refers to if it is a REFERENCE TO (the result of a function).
    pub fn followed_value(&mut self, operand: Operand) -> Operand {
        match operand {
            Operand::Value { expr, ty } if self.is_reference_to(ty) => match self.followed_root(expr) {
                Some(place) => self.read_place(place),
                None => Operand::Error,
            },
            operand => operand,
        }
    }

    /// The place to which a value refers; `None` if that was reported.
    pub fn followed_root(&self, reference: Expr) -> Option<Place> {
        let Type::Ref { target, .. } = *self.cx.defs.types.get(reference.ty) else { return None };
        let span = reference.span;
        let place = Place { root: Root::Deref(Box::new(reference)), steps: Vec::new(), ty: target, span };
        (target != Types::ERROR).then_some(place)
    }

    /// Whether a call of this gives a REFERENCE TO: a function of the user's.
    pub fn gives_reference(&mut self, callee: &ast::Expr) -> bool {
        let ast::ExprKind::Name(name) = &callee.kind else { return false };
        let pou = self.cx.pous.get(&crate::cx::fold(&name.text)).copied();
        match pou.and_then(|pou| self.cx.defs.pous[pou].result) {
            Some(result) => {
                let ty = self.type_of_var(result);
                self.is_reference_to(ty)
            }
            None => false,
        }
    }

    /// What binds a REFERENCE TO of type `want`: the variable `e`, what another one refers to, or nothing (NULL, 0).
    pub fn reference_value(&mut self, e: &'a ast::Expr, want: TypeId) -> Expr {
        let Type::Ref { kind, target } = *self.cx.defs.types.get(want) else { return error_expr(e.span) };
        let nothing = |span| Expr { kind: ExprKind::Const(0), ty: want, span };
        let place = match &e.kind {
            ast::ExprKind::Literal(_) => match self.operand(e, None) {
                Operand::Int(0) => return nothing(e.span),
                Operand::Error => return error_expr(e.span),
                Operand::Value { ty, .. } if matches!(self.cx.defs.types.get(ty), Type::Null) => {
                    return nothing(e.span);
                }
                _ => {
                    self.report(
                        Diagnostic::new(codes::NOT_A_VARIABLE, e.span, "a REFERENCE TO refers to a variable")
                            .help("name a variable of its type; assign the value to that first"),
                    );
                    return error_expr(e.span);
                }
            },
            _ => self.place_itself(e),
        };
        let Some(mut place) = place else { return error_expr(e.span) };
        let found = place.ty;
        // What another reference refers to: a copy of that reference, though it be NULL.
        let copied = match (&place.root, place.steps.last()) {
            _ if self.is_reference_to(found) => true,
            (_, Some(Step::Deref)) => {
                place.steps.pop();
                true
            }
            (Root::Deref(_), None) => true,
            _ => false,
        };
        let have = match *self.cx.defs.types.get(found) {
            Type::Ref { kind: RefKind::ReferenceTo, target } => target,
            _ => found,
        };
        if have == Types::ERROR || target == Types::ERROR {
            return error_expr(e.span);
        }
        if have != target && !self.may_stand_for(target, have, e.span) {
            return error_expr(e.span);
        }
        if !copied {
            return match self.reference_of(kind, place, e.span) {
                Operand::Value { expr, .. } => retype(expr, want),
                _ => error_expr(e.span),
            };
        }
        let held = match place.root {
            Root::Deref(reference) if place.steps.is_empty() => *reference,
            root => Expr { kind: ExprKind::Read(Place { root, ty: want, ..place }), ty: want, span: e.span },
        };
        retype(held, want)
    }

    /// Whether a variable may stand where one of another type is referred to, as for a VAR_IN_OUT: a longer string,
    /// an array with other bounds of equal length, each with its warning. Other types are reported.
    fn may_stand_for(&mut self, target: TypeId, have: TypeId, span: Span) -> bool {
        let (want, found) = (self.cx.type_name(target), self.cx.type_name(have));
        let message = format!("this refers to {want}, the variable is {found}");
        let mismatch = Diagnostic::new(codes::TYPE_MISMATCH, span, message)
            .help("a reference is the variable itself: both must have the same type");
        if self.similar_memory(target, have) {
            return self.codesys_only(span, codes::LAX_CONVERSION, mismatch);
        }
        self.report(mismatch);
        false
    }

    /// `__ISVALIDREF(r)`: whether a REFERENCE TO refers to something.
    pub fn is_valid_reference(&mut self, call: &'a ast::Call, span: Span) -> Operand {
        let place = match call.args.as_slice() {
            [ast::Arg { kind: ast::ArgKind::Positional(e), .. }] => match self.place_itself(e) {
                Some(place) => place,
                None => return Operand::Error,
            },
            _ => {
                self.report(
                    Diagnostic::new(codes::TOO_MANY_ARGUMENTS, span, "__ISVALIDREF takes one variable")
                        .help("write __ISVALIDREF(r)"),
                );
                return Operand::Error;
            }
        };
        if !self.is_reference_to(place.ty) {
            let name = self.cx.type_name(place.ty);
            self.report(
                Diagnostic::new(
                    codes::NOT_A_REFERENCE,
                    place.span,
                    format!("__ISVALIDREF takes a REFERENCE TO, {name} is none"),
                )
                .help("a REF_TO or a pointer is compared with NULL: `r <> NULL`"),
            );
            return Operand::Error;
        }
        let at = place.span;
        let ty = Types::elem(OFFSET);
        let held = Expr { ty: place.ty, kind: ExprKind::Read(place), span: at };
        let null = Expr { kind: ExprKind::Const(0), ty, span: at };
        Operand::value(ExprKind::Op(Op::Ne, OFFSET, vec![retype(held, ty), null]), BOOL(), span)
    }

    /// Whether a value of a reference type may stand for another type, or another for it; `None` if neither is a
    /// reference. What converts is the same number under another type.
    pub fn coerce_reference(&mut self, expr: &Expr, from: TypeId, to: TypeId, span: Span) -> Option<Expr> {
        // One that is followed binds a variable, it takes no value: see `reference_value`.
        if self.is_reference_to(from) || self.is_reference_to(to) {
            return None;
        }
        let types = &self.cx.defs.types;
        let pointer = |kind| kind == RefKind::PointerTo;
        let (pointer, elem) = match (types.get(from).clone(), types.get(to).clone()) {
            (Type::Null, Type::Ref { .. }) => return Some(retype(expr.clone(), to)),
            (Type::Ref { target: a, .. }, Type::Ref { target: b, .. }) if a == b => {
                return Some(retype(expr.clone(), to));
            }
            (Type::Ref { kind: a, .. }, Type::Ref { kind: b, .. }) => (pointer(a) && pointer(b), OFFSET),
            (Type::Ref { kind, .. }, _) => (pointer(kind), self.elem_of(to)?),
            (_, Type::Ref { kind, .. }) => (pointer(kind), self.elem_of(from)?),
            _ => return None,
        };
        if !holds_address(elem) {
            return None;
        }
        if !pointer && !self.lax_reference(span, from, to) {
            return Some(error_expr(span));
        }
        let actual = self.elem_of(expr.ty).unwrap_or(OFFSET);
        let is_reference = |ty| matches!(self.cx.defs.types.get(ty), Type::Ref { .. });
        let expr = if is_reference(from) { retype(expr.clone(), Types::elem(OFFSET)) } else { expr.clone() };
        let (source, target) = if is_reference(to) { (actual, OFFSET) } else { (OFFSET, elem) };
        Some(retype(self.with_elem(Expr { ty: Types::elem(source), ..expr }, target, span), to))
    }

    fn lax_reference(&mut self, span: Span, from: TypeId, to: TypeId) -> bool {
        let (from, to) = (self.cx.type_name(from), self.cx.type_name(to));
        let strict = Diagnostic::new(codes::TYPE_MISMATCH, span, format!("this is {from}, but {to} is needed here"))
            .help("a REF_TO keeps its type; POINTER TO converts freely");
        self.codesys_only(span, codes::LAX_CONVERSION, strict)
    }

    /// `p + 4`, `p - q`: bytes. `None` if neither side is a reference.
    pub fn reference_arithmetic(
        &mut self,
        op: BinaryOp,
        a: &Operand,
        b: &Operand,
        sides: [Span; 2],
        span: Span,
    ) -> Option<Operand> {
        let (x, y) = (self.static_type(a), self.static_type(b));
        let reference = |ty: Option<TypeId>| match ty.map(|ty| self.cx.defs.types.get(ty)) {
            Some(Type::Ref { kind, .. }) => Some(*kind == RefKind::PointerTo),
            _ => None,
        };
        let (left, right) = (reference(x), reference(y));
        let (result, prim) = match (op, left, right) {
            (_, None, None) => return None,
            (BinaryOp::Sub, None, Some(_)) => {
                // A number that was an address: the pointer counts as one too.
                let Operand::Value { expr, .. } = b else { return None };
                let ty = Types::elem(OFFSET);
                let number = Operand::Value { expr: retype(expr.clone(), ty), ty };
                return Some(self.binary_operands(op, span, a.clone(), number, sides, span, None));
            }
            (BinaryOp::Add, Some(_), None) => (x, Op::Add),
            (BinaryOp::Add, None, Some(_)) => (y, Op::Add),
            (BinaryOp::Sub, Some(_), None) => (x, Op::Sub),
            (BinaryOp::Sub, Some(_), Some(_)) => (Some(Types::elem(Elem::Dint)), Op::Sub),
            _ => {
                let (ty, side) = if left.is_some() { (x, sides[0]) } else { (y, sides[1]) };
                let help = "to an address bytes can be added or subtracted, and two addresses subtract";
                return Some(self.no_operator(op.text(), ty.unwrap_or(Types::ERROR), side, help));
            }
        };
        let result = result?;
        if left == Some(false) || right == Some(false) {
            let strict = Diagnostic::new(codes::WRONG_OPERAND, span, "a REF_TO is no number")
                .help("only POINTER TO has arithmetic; declare it as POINTER TO");
            if !self.codesys_only(span, codes::LAX_CONVERSION, strict) {
                return Some(Operand::Error);
            }
        }
        let mut args = Vec::with_capacity(2);
        for (operand, side) in [(a, sides[0]), (b, sides[1])] {
            args.push(self.offset_value(op, operand, side)?);
        }
        if args.iter().any(|a| a.ty == Types::ERROR) {
            return Some(Operand::Error);
        }
        let sum = Expr { kind: ExprKind::Op(prim, OFFSET, args), ty: Types::elem(OFFSET), span };
        // A difference may be negative; the bits are the same.
        Some(Operand::Value { expr: retype(sum, result), ty: result })
    }

    /// One side of an address computation, as offset.
    fn offset_value(&mut self, op: BinaryOp, operand: &Operand, side: Span) -> Option<Expr> {
        let number = match operand {
            Operand::Int(v) if (i128::from(i32::MIN)..=i128::from(u32::MAX)).contains(v) => {
                ExprKind::Const(*v as u64 & OFFSET.repr().mask())
            }
            Operand::Int(_) => return Some(self.coerce(operand.clone(), side, Types::elem(OFFSET))),
            Operand::Value { expr, ty } => match self.cx.defs.types.get(*ty) {
                Type::Ref { .. } => return Some(retype(expr.clone(), Types::elem(OFFSET))),
                Type::Error => return Some(error_expr(side)),
                _ => {
                    let elem = self.elem_of(*ty).filter(|e| e.is_integer() || e.is_bits());
                    if elem.is_some() {
                        return Some(self.with_elem(expr.clone(), OFFSET, side));
                    }
                    self.no_operator(op.text(), *ty, side, "only whole bytes can be added to an address");
                    return Some(error_expr(side));
                }
            },
            _ => {
                self.no_operator(
                    op.text(),
                    Types::elem(Elem::Lreal),
                    side,
                    "only whole bytes can be added to an address",
                );
                return Some(error_expr(side));
            }
        };
        Some(Expr { kind: number, ty: Types::elem(OFFSET), span: side })
    }

    /// A comparison with a reference on one side; `None` if there is none. References to one type compare for equality;
    /// pointers to anything, also with numbers that hold an address, and by order.
    pub fn reference_comparison(
        &mut self,
        op: Op,
        a: &Operand,
        b: &Operand,
        sides: [Span; 2],
        span: Span,
    ) -> Option<Operand> {
        let types = &self.cx.defs.types;
        let of = |operand: &Operand| self.static_type(operand).map(|ty| types.get(ty).clone());
        let (x, y) = (of(a), of(b));
        let equality = matches!(op, Op::Eq | Op::Ne);
        let pointer = |kind| kind == RefKind::PointerTo;
        let lax = match (&x, &y) {
            (Some(Type::Null), Some(Type::Null)) => false,
            (Some(Type::Ref { .. }), Some(Type::Null)) | (Some(Type::Null), Some(Type::Ref { .. })) => !equality,
            (Some(Type::Ref { kind: p, target: s }), Some(Type::Ref { kind: q, target: t })) => {
                !(pointer(*p) && pointer(*q)) && (s != t || !equality)
            }
            (Some(Type::Ref { kind, .. }), _) | (_, Some(Type::Ref { kind, .. })) => !pointer(*kind),
            _ => return None,
        };
        let name = |c: &Self, o: &Operand| c.static_type(o).map_or("a number".to_string(), |ty| c.cx.type_name(ty));
        if lax {
            let message = format!("{} cannot compare {} with {}", op_text(op), name(self, a), name(self, b));
            let strict = Diagnostic::new(codes::WRONG_OPERAND, span, message)
                .help("references to one type compare with = and <>; only POINTER TO compares like a number");
            if !self.codesys_only(span, codes::LAX_CONVERSION, strict) {
                return Some(Operand::Error);
            }
        }
        let mut args = Vec::with_capacity(2);
        for (operand, side) in [(a, sides[0]), (b, sides[1])] {
            let arg = match operand {
                Operand::Value { expr, ty } => match self.cx.defs.types.get(*ty) {
                    Type::Ref { .. } | Type::Null => retype(expr.clone(), Types::elem(OFFSET)),
                    _ => match self.elem_of(*ty).filter(|e| holds_address(*e)) {
                        Some(_) => self.with_elem(expr.clone(), OFFSET, side),
                        None => {
                            let help = "a pointer compares with pointers, NULL, and DWORD, LWORD, UDINT, ULINT";
                            return Some(self.no_operator(op_text(op), *ty, side, help));
                        }
                    },
                },
                number => self.coerce(number.clone(), side, Types::elem(OFFSET)),
            };
            args.push(arg);
        }
        if args.iter().any(|a| a.ty == Types::ERROR) {
            return Some(Operand::Error);
        }
        Some(Operand::value(ExprKind::Op(op, OFFSET, args), BOOL(), span))
    }
}

/// Types that a pointer converts to and from (\[R3\]).
fn holds_address(elem: Elem) -> bool {
    matches!(elem, Elem::Dword | Elem::Lword | Elem::Udint | Elem::Ulint)
}

fn op_text(op: Op) -> &'static str {
    match op {
        Op::Eq => "=",
        Op::Ne => "<>",
        Op::Lt => "<",
        Op::Le => "<=",
        Op::Gt => ">",
        _ => ">=",
    }
}

/// Which variables are connected to which VAR_IN_OUTs.
struct Connections<'v>(&'v mut Vec<(VarId, VarId)>);

impl Visitor for Connections<'_> {
    fn call(&mut self, call: &Call) {
        for (param, place) in &call.in_outs {
            if let Root::Var(var) = place.root {
                self.0.push((*param, var));
            }
        }
    }
}

/// The address of a VAR_IN_OUT is that of the variable it stands for: what is connected to one whose address is taken
/// lies in the addressable part too (\[R2\]), through all calls.
pub(crate) fn spread_addresses(defs: &mut Defs) {
    let mut passed: Vec<(VarId, VarId)> = Vec::new();
    for body in &defs.bodies {
        visit::stmts(&body.stmts, &mut Connections(&mut passed));
    }
    let mut by_param: rustc_hash::FxHashMap<VarId, Vec<VarId>> = rustc_hash::FxHashMap::default();
    for (param, var) in passed {
        by_param.entry(param).or_default().push(var);
    }
    let mut work: Vec<VarId> = by_param.keys().copied().filter(|p| defs.vars[*p].address_taken).collect();
    while let Some(param) = work.pop() {
        for var in by_param.get(&param).into_iter().flatten() {
            if !std::mem::replace(&mut defs.vars[*var].address_taken, true) {
                work.push(*var);
            }
        }
    }
}
