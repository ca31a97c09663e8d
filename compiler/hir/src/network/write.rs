//! The statements of a network, element by element in their order.
//!
//! A value that is used once stands as an expression where it is used; one that is used several times, and is more than a
//! name, goes to a temporary. Expressions that wait for their use are taken into temporaries before a statement that writes
//! what they read (`flush`): so every value is that of the time at which its element was evaluated. Blocks have a file of
//! their own.

mod blocks;

use super::Owner;
use super::expr::*;
use super::links::{Links, Source, resolve, result_pin};
use super::order::order;
use plcc_diag::{Code, Diagnostic, Diagnostics, Span, codes};
use plcc_syntax::ast::*;
use rustc_hash::FxHashMap;

/// Deeper expressions are divided: passes over the tree recurse, and no one could read them.
const MAX_EXPR_DEPTH: u32 = 60;

/// The statements of a network, and the value of its condition if it has one.
pub(super) fn statements(network: &Network, owner: &mut Owner, diags: &mut Diagnostics) -> (Vec<Stmt>, Option<Expr>) {
    let errors = diags.error_count();
    let links = resolve(network, owner, diags);
    let order = order(network, &links);
    let mut position = vec![usize::MAX; network.elements.len()];
    for (place, element) in order.iter().enumerate() {
        position[*element] = place;
    }
    let mut instances: FxHashMap<String, usize> = FxHashMap::default();
    for element in &network.elements {
        if let ElementKind::Block { instance: Some(instance), .. } = &element.kind {
            *instances.entry(print::print_expr(instance).to_ascii_uppercase()).or_default() += 1;
        }
    }
    let mut writer = Writer {
        network,
        links: &links,
        owner,
        diags,
        position,
        instances,
        uses: FxHashMap::default(),
        late: FxHashMap::default(),
        values: FxHashMap::default(),
        likes: FxHashMap::default(),
        readers: FxHashMap::default(),
        out: Vec::new(),
        condition: None,
        lost: None,
    };
    writer.count_uses();
    for (place, element) in order.iter().enumerate() {
        writer.element(*element, order.get(place + 1).copied());
    }
    let Writer { out, condition, lost, diags, .. } = writer;
    // A value that is missing without a word would change what the program does.
    if let Some(span) = lost.filter(|_| diags.error_count() == errors) {
        diags.push(
            Diagnostic::new(codes::UNCONNECTED_PIN, span, "no value comes over this connection")
                .help("draw this connection again"),
        );
    }
    (out, condition)
}

/// A value that was computed.
struct Value {
    expr: Expr,
    /// Consumers that still come.
    uses: usize,
    bool: bool,
}

struct Writer<'n, 'o, 'u, 'd> {
    network: &'n Network,
    links: &'n Links,
    owner: &'o mut Owner<'u>,
    diags: &'d mut Diagnostics,
    /// When each element is evaluated.
    position: Vec<usize>,
    /// How many blocks each instance has.
    instances: FxHashMap<String, usize>,
    /// How often each output is used after its evaluation.
    uses: FxHashMap<Source, usize>,
    /// Outputs that are used before their evaluation, with the variable that brings them to the next cycle, if one is needed.
    late: FxHashMap<Source, Option<Name>>,
    values: FxHashMap<Source, Value>,
    /// What has the type of each temporary, where there are loops; `None` if only the loop itself has.
    likes: FxHashMap<smol_str::SmolStr, Option<Expr>>,
    /// Values that wait, by what they read.
    readers: FxHashMap<String, Vec<Source>>,
    out: Vec<Stmt>,
    condition: Option<Expr>,
    /// Where a value is missing.
    lost: Option<Span>,
}

/// What a statement writes.
struct Writes {
    names: Vec<String>,
    /// It calls something that may write any variable that is not the POU's own.
    others: bool,
}

impl<'n> Writer<'n, '_, '_, '_> {
    fn say(&mut self, code: Code, span: Span, message: String, help: &str) {
        self.diags.push(Diagnostic::new(code, span, message).help(help));
    }

    fn at(&self, element: usize) -> &'n Element {
        &self.network.elements[element]
    }

    fn count_uses(&mut self) {
        let mut late = Vec::new();
        for (consumer, pins) in self.links.inputs.iter().enumerate() {
            // Nothing takes the power of the right rail.
            let place = self.position[consumer];
            if place == usize::MAX {
                continue;
            }
            for (source, span) in pins.iter().flatten() {
                let from = self.position[source.element];
                if from != usize::MAX && from >= place {
                    late.push((*source, *span));
                } else {
                    *self.uses.entry(*source).or_default() += 1;
                }
            }
        }
        for (element, drawn) in self.network.elements.iter().enumerate() {
            for pin in drawn.outputs.iter().enumerate().filter(|(_, p)| p.operand.is_some()).map(|(n, _)| n) {
                *self.uses.entry(Source { element, pin }).or_default() += 1;
            }
        }
        for (source, span) in late {
            self.read_late(source, span);
        }
    }

    /// The variables that stand at the outputs of a block take their values.
    fn assign_operands(&mut self, index: usize) {
        let element = self.at(index);
        let function = matches!(element.kind, ElementKind::Block { instance: None, .. });
        for (pin, output) in element.outputs.iter().enumerate() {
            let Some(target) = &output.operand else { continue };
            let source = Source { element: index, pin };
            let Some(value) = self.values.get_mut(&source) else {
                self.missing(output.span);
                continue;
            };
            value.uses = value.uses.saturating_sub(1);
            let value = value.expr.clone();
            let guarded = function && self.has_en(index) && !output.name.eq_ignore_ascii_case("ENO");
            let eno = Source { element: index, pin: ENO };
            let guard = self.values.get(&eno).filter(|_| guarded).map(|v| v.expr.clone());
            self.store(target, value, Modifier::default(), index, guard);
        }
    }

    /// An output that is used before it is evaluated: its value is that of the cycle before.
    fn read_late(&mut self, source: Source, span: Span) {
        let element = self.at(source.element);
        // A variable in a loop says itself what it is.
        if !matches!(element.kind, ElementKind::InOut { .. }) {
            let message = format!("the value of {} that comes here is that of the cycle before", element.describe());
            self.diags.push(
                Diagnostic::new(codes::LOOP_BROKEN, span, message)
                    .help("give executionOrderIds, or lead the loop through a variable, if another order is meant"),
            );
        }
        if self.late.contains_key(&source) {
            return;
        }
        let stored = match &element.kind {
            ElementKind::Block { instance: Some(_), .. } => {
                !self.output_name(element, source.pin).is_some_and(|n| n.eq_ignore_ascii_case("ENO"))
            }
            ElementKind::InOut { .. } => true,
            _ => false,
        };
        let mut name = None;
        if !stored {
            if !self.owner.memory {
                self.no_memory(element.span, "a loop of connections");
            }
            let ty = match &element.kind {
                ElementKind::Block { ty, .. } => {
                    let function = self.owner.user.functions.get(&ty.text.to_ascii_uppercase());
                    let result = function.and_then(|f| f.result.as_ref());
                    result.map_or(TypeExprKind::Inferred(None), |ty| ty.kind.clone())
                }
                _ => bool_type(element.span),
            };
            name = Some(self.owner.declare(&format!("{}_before", wish(element)), ty, true, element.span));
        }
        self.late.insert(source, name);
    }

    fn no_memory(&mut self, span: Span, what: &str) {
        let message = format!("{what} needs a memory, and a FUNCTION has none");
        self.say(codes::NO_MEMORY, span, message, "make the POU a FUNCTION_BLOCK");
    }

    fn output_name(&self, element: &'n Element, pin: usize) -> Option<&'n str> {
        element.outputs.get(pin).map(|p| p.name.as_str())
    }

    // ---- Values ----

    /// The value at an output, for one of its consumers.
    fn take(&mut self, source: Source, consumer: usize, span: Span) -> Expr {
        let element = self.at(source.element);
        if matches!(element.kind, ElementKind::LeftRail) {
            return constant(true, span);
        }
        if self.position[source.element] >= self.position[consumer] {
            return match self.late.get(&source) {
                Some(Some(name)) => variable(name, span),
                Some(None) => self.stored(element, source.pin, span),
                None => self.missing(span),
            };
        }
        let Some(value) = self.values.get_mut(&source) else { return self.missing(span) };
        value.uses = value.uses.saturating_sub(1);
        value.expr.clone()
    }

    /// A value that is not there; what is wrong was told, or will be at the end.
    fn missing(&mut self, span: Span) -> Expr {
        self.lost.get_or_insert(span);
        error(span)
    }

    /// An output that is a variable anyway.
    fn stored(&self, element: &'n Element, pin: usize, span: Span) -> Expr {
        match &element.kind {
            ElementKind::Block { instance: Some(instance), .. } => {
                let name = self.output_name(element, pin).unwrap_or_default();
                let value = member(instance.clone(), name, span);
                match element.outputs.get(pin) {
                    Some(pin) if pin.modifier.negated => not(value, span),
                    _ => value,
                }
            }
            ElementKind::InOut { variable, negated_out: true, .. } => not(variable.clone(), span),
            ElementKind::InOut { variable, .. } => variable.clone(),
            _ => error(span),
        }
    }

    /// Gives an output its value.
    fn give(&mut self, source: Source, expr: Expr, is_bool: bool) {
        let mut expr = expr;
        if let Some(Some(name)) = self.late.get(&source).cloned() {
            let span = expr.span;
            self.type_late(&name, &expr);
            let target = variable(&name, span);
            self.push(assign(target.clone(), expr, span), Writes { names: vec![], others: false });
            expr = target;
        }
        let uses = self.uses.get(&source).copied().unwrap_or(0);
        if uses == 0 {
            return;
        }
        if (uses > 1 && !is_simple(&expr)) || expr.depth > MAX_EXPR_DEPTH {
            expr = self.temporary(source, expr, is_bool);
        }
        let mut names = Vec::new();
        reads(&expr, &mut names);
        names.sort();
        names.dedup();
        for name in names {
            self.readers.entry(name).or_default().push(source);
        }
        self.values.insert(source, Value { expr, uses, bool: is_bool });
    }

    /// The type of a variable that brings a value to the next cycle is that of the value, without itself.
    fn type_late(&mut self, name: &Name, value: &Expr) {
        let kept = self.owner.declared.kept.iter().position(|d| d.names[0].text == name.text);
        let Some(kept) = kept.filter(|k| matches!(self.owner.declared.kept[*k].ty.kind, TypeExprKind::Inferred(None)))
        else {
            return;
        };
        self.owner.declared.kept[kept].ty.kind = match self.without_late(value) {
            Some(like) => TypeExprKind::Inferred(Some(Box::new(like))),
            None => bool_type(name.span),
        };
    }

    /// An expression of the same type without values of the cycle before; `None` if it has no others.
    fn without_late(&self, e: &Expr) -> Option<Expr> {
        match &e.kind {
            ExprKind::Name(name) => {
                if let Some(like) = self.likes.get(&name.text) {
                    return like.clone();
                }
                let late = self.late.values().flatten().any(|l| l.text == name.text);
                (!late).then(|| e.clone())
            }
            ExprKind::Binary(op, at, a, b) => {
                let (a, b) = (self.without_late(a), self.without_late(b));
                let either = a.clone().or(b.clone())?;
                let compares = matches!(
                    op,
                    BinaryOp::Eq | BinaryOp::Ne | BinaryOp::Lt | BinaryOp::Le | BinaryOp::Gt | BinaryOp::Ge
                );
                match (a, b) {
                    (Some(a), Some(b)) => Some(binary(*op, a, b, *at)),
                    _ if compares => Some(binary(*op, either.clone(), either, *at)),
                    _ => Some(either),
                }
            }
            ExprKind::Unary(op, inner) => {
                let inner = self.without_late(inner)?;
                let depth = inner.depth;
                Some(node(ExprKind::Unary(*op, Box::new(inner)), depth, e.span))
            }
            ExprKind::Call(found) => {
                let value = |arg: &Arg| match &arg.kind {
                    ArgKind::Positional(e) | ArgKind::Input(_, Some(e)) => self.without_late(e),
                    _ => None,
                };
                let control = |arg: &Arg| matches!(&arg.kind, ArgKind::Input(n, _) if ["EN", "G", "K"].iter().any(|c| n.text.eq_ignore_ascii_case(c)));
                let other = found.args.iter().filter(|a| !control(a)).find_map(value)?;
                let args = found.args.iter().filter(|a| !matches!(a.kind, ArgKind::Output { .. })).map(|arg| {
                    let value = value(arg).unwrap_or_else(|| match control(arg) {
                        true => constant(true, arg.span),
                        false => other.clone(),
                    });
                    match &arg.kind {
                        ArgKind::Input(name, _) => input(&name.text, value, arg.span),
                        _ => positional(value, arg.span),
                    }
                });
                Some(call(found.callee.clone(), args.collect(), e.span))
            }
            _ => Some(e.clone()),
        }
    }

    /// Keeps a value in a variable of its own.
    fn temporary(&mut self, source: Source, expr: Expr, is_bool: bool) -> Expr {
        let element = self.at(source.element);
        let span = element.span;
        let ty = if is_bool { bool_type(span) } else { TypeExprKind::Inferred(None) };
        let name = self.owner.declare(&wish(element), ty, false, span);
        self.remember(&name, &expr);
        // Nothing that waits reads it.
        self.out.push(assign(variable(&name, span), expr, span));
        variable(&name, span)
    }

    /// Of what type a temporary is, if a loop may ask.
    fn remember(&mut self, name: &Name, value: &Expr) {
        if !self.late.is_empty() {
            let like = self.without_late(value);
            self.likes.insert(name.text.clone(), like);
        }
    }

    /// Takes the values that wait and read what is written into temporaries.
    fn flush(&mut self, writes: &Writes) {
        let mut hit: Vec<Source> = Vec::new();
        if writes.others || writes.names.iter().any(|n| n == "%") {
            let locals = &self.owner.locals;
            let anything = writes.names.iter().any(|n| n == "%");
            let foreign = |name: &str| anything || (!locals.contains(name) && !name.starts_with('$'));
            let names: Vec<String> = self.readers.keys().filter(|n| foreign(n)).cloned().collect();
            hit.extend(names.iter().filter_map(|n| self.readers.remove(n)).flatten());
        }
        for name in writes.names.iter().filter(|n| !n.starts_with('$')) {
            hit.extend(self.readers.remove(name).into_iter().flatten());
            // A located variable, or one behind a reference, may be any.
            hit.extend(self.readers.remove("%").into_iter().flatten());
        }
        self.keep(hit);
    }

    /// Takes all values that wait into temporaries: control may go another way from here on.
    fn flush_all(&mut self) {
        let waiting = std::mem::take(&mut self.readers).into_values().flatten().collect();
        self.keep(waiting);
    }

    fn keep(&mut self, mut sources: Vec<Source>) {
        sources.sort_by_key(|s| (self.position[s.element], s.pin));
        sources.dedup();
        for source in sources {
            let Some(value) = self.values.get(&source) else { continue };
            if value.uses == 0 {
                continue;
            }
            let (expr, uses, is_bool) = (value.expr.clone(), value.uses, value.bool);
            if matches!(&expr.kind, ExprKind::Name(n) if n.text.starts_with('$')) {
                continue;
            }
            let expr = self.temporary(source, expr, is_bool);
            self.values.insert(source, Value { expr, uses, bool: is_bool });
        }
    }

    fn push(&mut self, statement: Stmt, writes: Writes) {
        self.flush(&writes);
        self.out.push(statement);
    }

    // ---- Inputs ----

    /// The value at an input: `None` if nothing is connected.
    fn input(&mut self, element: usize, pin: usize) -> Option<Expr> {
        let drawn = self.at(element);
        let found = drawn.inputs.get(pin)?;
        let sources = self.links.inputs[element].get(pin).map(Vec::as_slice).unwrap_or_default();
        let span = drawn.span;
        let mut values: Vec<Expr> = sources.iter().map(|(s, at)| self.take(*s, element, *at)).collect();
        values.extend(found.operand.clone());
        if values.len() > 1 && self.network.notation == Notation::Fbd {
            let mut places = sources.iter().map(|(_, at)| *at);
            let (first, second) = (places.next().unwrap_or(span), places.next().unwrap_or(span));
            let message = format!("{} connections end in {}", values.len(), pin_text(drawn, pin));
            self.diags.push(
                Diagnostic::new(codes::SEVERAL_SOURCES, second, message)
                    .also(first, "the first one is here")
                    .help("connect one value; a block OR or AND takes several"),
            );
            return Some(error(span));
        }
        if values.is_empty() {
            // A connection that was reported counts as one.
            return (!found.connections.is_empty()).then(|| self.missing(span));
        }
        // A value stands where it is used: messages name the pin, and arguments have the order of the pins.
        let value = Expr { span: found.span, ..or(values, span)? };
        Some(Expr { span: found.span, ..self.modified(value, found.modifier, element) })
    }

    /// An input that must be connected.
    fn needed(&mut self, element: usize, pin: usize) -> Expr {
        if let Some(value) = self.input(element, pin) {
            return value;
        }
        let drawn = self.at(element);
        let on_rung = self.network.notation == Notation::Ld
            && matches!(
                drawn.kind,
                ElementKind::Contact { .. } | ElementKind::Coil { .. } | ElementKind::Jump(_) | ElementKind::Return
            );
        if on_rung {
            let message = "nothing leads from the left power rail to this element".to_string();
            self.say(codes::NO_POWER_RAIL, drawn.span, message, "begin the rung at the left power rail");
        } else {
            let span = drawn.inputs.get(pin).map_or(drawn.span, |p| p.span);
            let message = format!("{} is not connected", pin_text(drawn, pin));
            self.say(codes::UNCONNECTED_PIN, span, message, "connect it");
        }
        error(drawn.span)
    }

    /// A value as a negation or an edge changes it.
    fn modified(&mut self, value: Expr, modifier: Modifier, element: usize) -> Expr {
        let span = self.at(element).span;
        let value = if modifier.negated { not(value, span) } else { value };
        let Some(edge) = modifier.edge else { return value };
        if !self.owner.memory {
            self.no_memory(span, "an edge");
            return error(span);
        }
        let block = match edge {
            Edge::Rising => "R_TRIG",
            Edge::Falling => "F_TRIG",
        };
        let ty = TypeExprKind::Named(Name { text: block.into(), span });
        let id = self.at(element).id;
        let name = self.owner.declare(&format!("{block}{id}"), ty, true, span);
        let statement = call(variable(&name, span), vec![input("CLK", value, span)], span);
        self.push(Stmt { kind: StmtKind::Expr(statement), span }, Writes { names: vec![], others: false });
        member(variable(&name, span), "Q", span)
    }

    // ---- Elements ----

    fn element(&mut self, index: usize, next: Option<usize>) {
        let element = self.at(index);
        let span = element.span;
        let own = Source { element: index, pin: 0 };
        match &element.kind {
            ElementKind::In { value, modifier } => {
                let value = self.modified(value.clone(), *modifier, index);
                self.give(own, value, modifier.negated || modifier.edge.is_some());
            }
            ElementKind::Contact { variable, modifier } => {
                let power = self.needed(index, 0);
                let state = self.modified(variable.clone(), *modifier, index);
                let value = and(power, state, span);
                self.give(own, value, true);
            }
            ElementKind::Coil { variable, modifier } => {
                let mut power = self.needed(index, 0);
                if self.uses.get(&own).is_some_and(|n| *n > 0) && !is_simple(&power) {
                    power = self.temporary(own, power, true);
                }
                self.give(own, power.clone(), true);
                self.store(variable, power, *modifier, index, None);
            }
            // Left over in many drawings; it changes nothing.
            ElementKind::Out { .. }
                if element.inputs.iter().all(|p| p.connections.is_empty() && p.operand.is_none()) =>
            {
                self.say(
                    codes::IDLE_ELEMENT,
                    span,
                    "nothing is connected to this variable, it takes no value".into(),
                    "connect it, or remove it",
                );
            }
            ElementKind::Out { target, modifier } => {
                let guard = self.guard(index);
                let value = self.needed(index, 0);
                self.store(target, value, *modifier, index, guard);
            }
            ElementKind::InOut { variable, negated_in, negated_out } => {
                let guard = self.guard(index);
                if let Some(value) = self.input(index, 0) {
                    let modifier = Modifier { negated: *negated_in, ..Modifier::default() };
                    self.store(variable, value, modifier, index, guard);
                }
                let value = if *negated_out { not(variable.clone(), span) } else { variable.clone() };
                self.give(own, value, *negated_out);
            }
            ElementKind::Block { ty, instance: Some(instance) } => {
                self.function_block(index, ty, instance);
                self.assign_operands(index);
            }
            ElementKind::Block { ty, instance: None } => {
                self.function(index, ty, next);
                self.assign_operands(index);
            }
            ElementKind::Label(name) => {
                self.flush_all();
                self.out.push(Stmt { kind: StmtKind::Label(name.clone()), span });
            }
            ElementKind::Jump(name) => self.go(index, StmtKind::Jump(name.clone())),
            ElementKind::Return => self.go(index, StmtKind::Return),
            ElementKind::Condition => self.condition = Some(self.needed(index, 0)),
            ElementKind::LeftRail
            | ElementKind::RightRail
            | ElementKind::Connector(_)
            | ElementKind::Continuation(_)
            | ElementKind::Comment(_) => {}
        }
    }

    /// A jump or return while the input is TRUE.
    fn go(&mut self, index: usize, kind: StmtKind) {
        let condition = self.needed(index, 0);
        self.flush_all();
        let span = self.at(index).span;
        self.out.push(only_if(condition, Stmt { kind, span }));
    }

    /// Writes a variable.
    fn store(&mut self, target: &Expr, value: Expr, modifier: Modifier, index: usize, guard: Option<Expr>) {
        let span = self.at(index).span;
        let value = self.modified(value, modifier, index);
        let mut names = Vec::new();
        reads(target, &mut names);
        names.truncate(1);
        let statement = match modifier.storage {
            None => assign(target.clone(), value, span),
            Some(Storage::Set) => only_if(value, assign(target.clone(), constant(true, span), span)),
            Some(Storage::Reset) => only_if(value, assign(target.clone(), constant(false, span), span)),
        };
        let statement = match guard {
            Some(guard) => only_if(guard, statement),
            None => statement,
        };
        self.push(statement, Writes { names, others: false });
    }

    /// ENO of the function with EN whose value a variable takes: with EN FALSE it takes none.
    fn guard(&mut self, index: usize) -> Option<Expr> {
        let [(source, _)] = self.links.inputs[index].first()?.as_slice() else { return None };
        let element = self.at(source.element);
        if self.output_name(element, source.pin).is_some_and(|n| n.eq_ignore_ascii_case("ENO")) {
            return None;
        }
        let before = self.position[source.element] < self.position[index];
        if !before || !matches!(element.kind, ElementKind::Block { instance: None, .. }) || !self.has_en(source.element)
        {
            return None;
        }
        let eno = Source { element: source.element, pin: ENO };
        self.values.get(&eno).map(|v| v.expr.clone())
    }

    /// Whether the input EN is connected.
    fn has_en(&self, index: usize) -> bool {
        let pins = self.at(index).inputs.iter();
        let mut en = pins.filter(|p| p.name.eq_ignore_ascii_case("EN"));
        en.any(|p| !p.connections.is_empty() || p.operand.is_some())
    }

    fn is_used(&self, source: Source) -> bool {
        self.uses.get(&source).is_some_and(|n| *n > 0) || self.late.contains_key(&source)
    }

    fn changed_output(&mut self, element: &'n Element, pin: usize, value: Expr, index: usize) -> Expr {
        match element.outputs.get(pin) {
            Some(pin) => self.modified(value, Modifier { storage: None, ..pin.modifier }, index),
            None => value,
        }
    }
}

/// The pin that stands for ENO in [`Writer::values`], whether it is drawn or not.
const ENO: usize = usize::MAX;

fn bool_type(span: Span) -> TypeExprKind {
    TypeExprKind::Named(Name { text: "BOOL".into(), span })
}

/// Not worth a variable of its own.
fn is_simple(e: &Expr) -> bool {
    match &e.kind {
        ExprKind::Literal(_) | ExprKind::Name(_) | ExprKind::Qualified { .. } | ExprKind::Address(_) => true,
        ExprKind::Member(base, _) => is_simple(base),
        ExprKind::Unary(UnaryOp::Not, inner) => is_simple(inner),
        ExprKind::Unary(_, inner) => matches!(inner.kind, ExprKind::Literal(_)),
        _ => false,
    }
}

/// How messages name an input.
fn pin_text(element: &Element, pin: usize) -> String {
    match element.inputs.get(pin) {
        Some(found) if !found.name.is_empty() => format!("the input `{}` of this block", found.name),
        _ => "this element".into(),
    }
}

/// What a variable for the value of an element is called.
fn wish(element: &Element) -> String {
    let word = match &element.kind {
        ElementKind::Block { ty, .. } => ty.text.as_str(),
        ElementKind::Contact { .. } | ElementKind::Coil { .. } => "Rung",
        _ => "Value",
    };
    format!("{word}{}", element.id)
}
