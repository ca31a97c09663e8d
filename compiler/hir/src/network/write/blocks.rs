//! Blocks of a network: calls of function block instances and functions, and the operators that functions stand for.

use super::*;

/// Functions that are operators.
const OPERATORS: [(&str, BinaryOp); 14] = [
    ("AND", BinaryOp::And),
    ("OR", BinaryOp::Or),
    ("XOR", BinaryOp::Xor),
    ("ADD", BinaryOp::Add),
    ("SUB", BinaryOp::Sub),
    ("MUL", BinaryOp::Mul),
    ("DIV", BinaryOp::Div),
    ("MOD", BinaryOp::Mod),
    ("GT", BinaryOp::Gt),
    ("GE", BinaryOp::Ge),
    ("EQ", BinaryOp::Eq),
    ("LE", BinaryOp::Le),
    ("LT", BinaryOp::Lt),
    ("NE", BinaryOp::Ne),
];

impl<'n> Writer<'n, '_, '_, '_> {
    /// Values at the inputs of a block, by pin.
    fn arguments(&mut self, index: usize) -> Vec<Option<Expr>> {
        (0..self.at(index).inputs.len()).map(|pin| self.input(index, pin)).collect()
    }

    pub(super) fn function_block(&mut self, index: usize, ty: &Name, instance: &Expr) {
        let element = self.at(index);
        let span = element.span;
        let values = self.arguments(index);
        let mut args = Vec::new();
        let mut writes = Vec::new();
        reads(instance, &mut writes);
        writes.truncate(1);
        let mut in_out: FxHashMap<String, Expr> = FxHashMap::default();
        for (pin, value) in element.inputs.iter().zip(values) {
            let Some(mut value) = value else { continue };
            if is_in_out(element, pin) {
                if let ExprKind::Name(name) = &mut value.kind {
                    name.span = pin.span;
                }
                reads(&value, &mut writes);
                in_out.insert(pin.name.to_ascii_uppercase(), value.clone());
            }
            args.push(input(&pin.name, value, pin.span));
        }
        let eno = element.outputs.iter().position(|p| p.name.eq_ignore_ascii_case("ENO"));
        let eno = eno.map(|pin| Source { element: index, pin }).filter(|s| self.is_used(*s));
        let mut eno_name = None;
        if eno.is_some() {
            let name = self.owner.declare(&format!("{}_ENO", wish(element)), bool_type(span), false, span);
            args.push(output("ENO", variable(&name, span), span));
            eno_name = Some(name);
        }
        let others = self.owner.user.blocks.contains(&ty.text.to_ascii_uppercase());
        let statement = call(instance.clone(), args, span);
        self.push(Stmt { kind: StmtKind::Expr(statement), span }, Writes { names: writes, others });
        if let (Some(source), Some(name)) = (eno, eno_name) {
            let value = variable(&name, span);
            let value = self.changed_output(element, source.pin, value, index);
            self.give(source, value, true);
        }
        let key = print::print_expr(instance).to_ascii_uppercase();
        let again = self.instances.get(&key).is_some_and(|n| *n > 1);
        for (number, pin) in element.outputs.iter().enumerate() {
            let source = Source { element: index, pin: number };
            if Some(source) == eno || !self.is_used(source) {
                continue;
            }
            let mut value = match in_out.get(&pin.name.to_ascii_uppercase()) {
                Some(value) => value.clone(),
                None => member(instance.clone(), &pin.name, span),
            };
            let plain = !pin.modifier.negated && pin.modifier.edge.is_none();
            value = self.changed_output(element, number, value, index);
            if again && self.uses.get(&source).is_some_and(|n| *n > 0) {
                value = self.temporary(source, value, !plain);
            }
            self.give(source, value, !plain);
        }
    }

    pub(super) fn function(&mut self, index: usize, ty: &Name, next: Option<usize>) {
        let element = self.at(index);
        let span = element.span;
        let key = ty.text.to_ascii_uppercase();
        let user = self.owner.user.functions.contains_key(&key);
        let mut values = self.arguments(index);
        self.check_connected(index, &mut values, user);
        let result = result_pin(element, self.owner);
        let en = self.has_en(index);
        let is_eno = |p: &Pin| p.name.eq_ignore_ascii_case("ENO");
        let mut outputs: Vec<(usize, Name)> = Vec::new();
        for (number, pin) in element.outputs.iter().enumerate() {
            let source = Source { element: index, pin: number };
            let wanted = self.is_used(source) || (en && is_eno(pin));
            if Some(number) == result || is_in_out(element, pin) || !wanted {
                continue;
            }
            let declared = self.owner.user.functions.get(&key).and_then(|f| {
                f.outputs.iter().find(|(n, _)| n.eq_ignore_ascii_case(&pin.name)).map(|(_, ty)| ty.kind.clone())
            });
            let kind = match declared {
                Some(kind) => kind,
                None if is_eno(pin) => bool_type(span),
                None => TypeExprKind::Inferred(None),
            };
            let name = self.owner.declare(&format!("{}_{}", wish(element), pin.name), kind, false, span);
            outputs.push((number, name));
        }
        // With EN connected ENO is needed, drawn or not, for what takes the result.
        let mut hidden_eno = None;
        if en && !element.outputs.iter().any(is_eno) {
            hidden_eno = Some(self.owner.declare(&format!("{}_ENO", wish(element)), bool_type(span), false, span));
        }
        let mut in_outs = Vec::new();
        for (pin, value) in element.inputs.iter().zip(&values) {
            if let (true, Some(value)) = (is_in_out(element, pin), value) {
                reads(value, &mut in_outs);
            }
        }
        let effects = !outputs.is_empty() || hidden_eno.is_some() || !in_outs.is_empty();
        let source = result.map(|pin| Source { element: index, pin });
        let plain = |p: usize| !element.outputs[p].modifier.negated && element.outputs[p].modifier.edge.is_none();
        let uses = source.and_then(|s| self.uses.get(&s)).copied().unwrap_or(0);
        let late = source.is_some_and(|s| self.late.contains_key(&s));
        let used = uses > 0 || late;
        // What no one uses is called all the same: its inputs are checked, and it may do something besides.
        let operator = if used { self.as_operator(element, &key, &values, user, effects) } else { None };
        let bare = match operator {
            Some(operator) => operator,
            None => {
                let mut args = self.formal(element, values, !outputs.is_empty() || hidden_eno.is_some());
                for (number, name) in &outputs {
                    args.push(output(&element.outputs[*number].name, variable(name, span), span));
                }
                if let Some(name) = &hidden_eno {
                    args.push(output("ENO", variable(name, span), span));
                }
                call(node(ExprKind::Name(ty.clone()), 0, span), args, span)
            }
        };
        // A user's function may do something besides; it stands alone, or where it is used next.
        let used_next = uses == 1 && !late && !effects && next.is_some_and(|n| self.consumes(n, index));
        match source {
            Some(source) if used => {
                let mut value = bare;
                if effects || (user && !used_next) || (element.order.is_some() && !used_next) {
                    let writes = Writes { names: in_outs, others: user };
                    self.flush(&writes);
                    let function = self.owner.user.functions.get(&key).and_then(|f| f.result.as_ref());
                    let kind = function.map_or(TypeExprKind::Inferred(None), |ty| ty.kind.clone());
                    let name = self.owner.declare(&wish(element), kind, false, span);
                    self.remember(&name, &value);
                    self.out.push(assign(variable(&name, span), value, span));
                    value = variable(&name, span);
                }
                self.give_outputs(index, &outputs, hidden_eno.as_ref());
                let value = self.changed_output(element, source.pin, value, index);
                let is_bool = !plain(source.pin);
                self.give(source, value, is_bool);
            }
            // `NOT(x)` is no statement.
            _ if key == "NOT" => {
                let source = Source { element: index, pin: result.unwrap_or(0) };
                self.flush(&Writes { names: in_outs, others: user });
                self.temporary(source, bare, false);
                self.give_outputs(index, &outputs, hidden_eno.as_ref());
            }
            _ => {
                let statement = Stmt { kind: StmtKind::Expr(bare), span };
                self.push(statement, Writes { names: in_outs, others: user });
                self.give_outputs(index, &outputs, hidden_eno.as_ref());
            }
        }
        // What goes through unchanged.
        for (number, pin) in element.outputs.iter().enumerate() {
            let through = Source { element: index, pin: number };
            if Some(number) != result && is_in_out(element, pin) && self.is_used(through) {
                let input = element.inputs.iter().position(|p| p.name.eq_ignore_ascii_case(&pin.name));
                let value = input.and_then(|input| self.input(index, input)).unwrap_or_else(|| error(span));
                self.give(through, value, false);
            }
        }
    }

    fn give_outputs(&mut self, index: usize, outputs: &[(usize, Name)], hidden_eno: Option<&Name>) {
        let element = self.at(index);
        for (number, name) in outputs {
            let value = variable(name, element.span);
            if element.outputs[*number].name.eq_ignore_ascii_case("ENO") {
                let eno = Source { element: index, pin: ENO };
                self.values.insert(eno, Value { expr: value.clone(), uses: 0, bool: true });
            }
            let value = self.changed_output(element, *number, value, index);
            self.give(Source { element: index, pin: *number }, value, false);
        }
        if let Some(name) = hidden_eno {
            let eno = Source { element: index, pin: ENO };
            self.values.insert(eno, Value { expr: variable(name, element.span), uses: 0, bool: true });
        }
    }

    fn consumes(&self, consumer: usize, source: usize) -> bool {
        self.links.inputs[consumer].iter().flatten().any(|(s, _)| s.element == source)
    }

    /// Inputs of standard functions must be connected, but for those at the end of a list (IN3, IN4 ...).
    fn check_connected(&mut self, index: usize, values: &mut [Option<Expr>], user: bool) {
        if user {
            return;
        }
        let element = self.at(index);
        let numbered = |p: &Pin| {
            let parts = p.name.split_at_checked(2);
            parts.is_some_and(|(word, number)| {
                word.eq_ignore_ascii_case("IN") && !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit())
            })
        };
        let connected = element.inputs.iter().zip(values.iter()).filter(|(p, v)| numbered(p) && v.is_some()).count();
        for (pin, value) in values.iter_mut().enumerate() {
            let drawn = &element.inputs[pin];
            let optional = drawn.name.eq_ignore_ascii_case("EN") || (numbered(drawn) && connected >= 2);
            if value.is_none() && !optional {
                let message = format!("{} is not connected", pin_text(element, pin));
                self.say(codes::UNCONNECTED_PIN, drawn.span, message, "connect a variable, a constant or a block");
                *value = Some(error(drawn.span));
            }
        }
    }

    /// The function as the operator that it is.
    fn as_operator(
        &self,
        element: &'n Element,
        key: &str,
        values: &[Option<Expr>],
        user: bool,
        effects: bool,
    ) -> Option<Expr> {
        if user
            || effects
            || values.iter().any(Option::is_none)
            || element.inputs.iter().any(|p| p.name.eq_ignore_ascii_case("EN"))
        {
            return None;
        }
        let values: Vec<Expr> = values.iter().flatten().cloned().collect();
        let span = element.span;
        match (key, values.as_slice()) {
            ("NOT", [value]) => return Some(not(value.clone(), span)),
            ("MOVE", [value]) => return Some(value.clone()),
            _ => {}
        }
        let (_, op) = OPERATORS.iter().find(|(name, _)| *name == key)?;
        let chained = matches!(op, BinaryOp::And | BinaryOp::Or | BinaryOp::Xor | BinaryOp::Add | BinaryOp::Mul);
        if values.len() < 2 || (values.len() > 2 && !chained) {
            return None;
        }
        values.into_iter().reduce(|a, b| binary(*op, a, b, span))
    }

    /// The arguments by their names; a single one without, unless outputs follow.
    fn formal(&self, element: &'n Element, values: Vec<Option<Expr>>, outputs: bool) -> Vec<Arg> {
        let connected: Vec<(&Pin, Expr)> =
            element.inputs.iter().zip(values).filter_map(|(pin, value)| value.map(|v| (pin, v))).collect();
        let alone = !outputs
            && connected.len() == 1
            && (connected[0].0.name.eq_ignore_ascii_case("IN") || connected[0].0.name.is_empty());
        let nameless = connected.iter().all(|(pin, _)| pin.name.is_empty());
        connected
            .into_iter()
            .map(|(pin, value)| match alone || nameless {
                true => positional(value, pin.span),
                false => input(&pin.name, value, pin.span),
            })
            .collect()
    }
}

fn is_in_out(element: &Element, pin: &Pin) -> bool {
    let same = |list: &[Pin]| list.iter().any(|p| !p.name.is_empty() && p.name.eq_ignore_ascii_case(&pin.name));
    pin.in_out || (same(&element.inputs) && same(&element.outputs))
}
