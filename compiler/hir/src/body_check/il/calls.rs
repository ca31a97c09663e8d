//! Calls: of instances and actions by CAL and by input operators, of functions by their names (semantics.md \[I2\]).

use super::Il;
use super::current::{Current, Touches, Value};
use super::lines::Line;
use crate::arguments::Arguments;
use crate::body::*;
use crate::call::Target;
use crate::defs::{PouKind, Section, VarId};
use crate::expr::Operand;
use crate::std_call::wanted_of_argument;
use crate::types::Types;
use plcc_diag::{Diagnostic, Span, codes};
use plcc_stdlib::funcs::{Meaning, StdFn};
use plcc_syntax::ast;
use plcc_syntax::ast::print::print_expr;
use plcc_syntax::il_operators::When;

impl<'a> Il<'_, '_, 'a> {
    pub fn call(&mut self, line: &Line<'a>, when: When, callee: &'a ast::Expr, args: &'a [ast::Arg]) {
        // The condition is evaluated before the arguments.
        let cond = match when {
            When::Always => None,
            _ => match self.truth(line, when, &Touches::Anything) {
                Some(cond) => Some(cond),
                None => {
                    self.callee_call(line, callee, args);
                    return;
                }
            },
        };
        let Some(call) = self.callee_call(line, callee, args) else { return };
        let call = Stmt { kind: StmtKind::Call(Box::new(call)), span: line.span };
        match cond {
            Some(cond) => {
                self.emit(StmtKind::If { arms: vec![(cond, vec![call])], otherwise: Vec::new() }, line.span);
            }
            None => {
                self.keep_current(line.live, std::slice::from_ref(&call), line.span);
                self.emit(call.kind, call.span);
            }
        }
    }

    fn callee_call(&mut self, line: &Line, callee: &'a ast::Expr, args: &'a [ast::Arg]) -> Option<Call> {
        match self.c.callee(callee) {
            Target::User(target, pou) if self.c.cx.defs.pous[pou].kind != PouKind::Function => {
                self.c.user_call(target, pou, Arguments { first: None, args, at: callee.span }, line.span)
            }
            Target::User(..) | Target::Standard(_) | Target::Special(_) => {
                let text = print_expr(callee);
                self.c.report(
                    Diagnostic::new(codes::NOT_CALLABLE, callee.span, format!("`{text}` is a function"))
                        .help(format!("a function is an operator itself: `LD x`, then `{text}`; CAL calls instances")),
                );
                None
            }
            Target::Reported => {
                self.c.check_arguments_alone(args);
                None
            }
        }
    }

    /// `IN t`: the current result goes into the input, and the instance is called.
    pub fn input(&mut self, line: &Line<'a>, input: VarId, operand: &'a ast::Expr, pin: &'a ast::Name) {
        let Some(instance) = self.c.place(operand) else { return };
        if let Some(pou) = self.c.cx.instance_of(instance.ty) {
            // A textbook's name of the pin gets its note.
            self.c.pin_name(pou, pin);
        }
        self.before_path(&instance);
        let Some(value) = self.use_current(line.live, &Touches::Anything, line.span, &line.name) else { return };
        let ty = self.c.type_of_var(input);
        let first = self.c.cx.diags.count();
        let sides = self.sides(&value, None);
        let call = self.c.input_call(instance, input, (value.operand, value.span), line.span);
        let needs = self.c.cx.type_name(ty);
        self.reword(first, line, &sides, &needs);
        if let Some(call) = call {
            self.emit(StmtKind::Call(Box::new(call)), line.span);
        }
    }

    /// A function by its name; the current result is its first argument.
    pub fn function(&mut self, line: &Line<'a>, name: &'a ast::Name, args: &'a [ast::Arg], takes: bool) {
        if takes && self.brings_all(name, args) {
            self.drop_current(line.span);
            self.cr = Current::Unknown;
            return;
        }
        let first = match takes {
            true => self.take(line.span, &name.text),
            false => {
                self.drop_current(line.span);
                None
            }
        };
        if takes && first.is_none() {
            self.c.check_arguments_alone(args);
            return;
        }
        let span = first.as_ref().map_or(line.span, |f| f.span.to(line.span));
        let operations = first.as_ref().map_or(0, |f| f.operations) + 1 + args.len() as u32;
        let result = match self.c.named_callee(name) {
            Target::Standard(func) => self.standard(line, func, first, args),
            Target::User(callee, pou) => {
                let sides = first.as_ref().map(|f| self.sides(f, None));
                let count = self.c.cx.diags.count();
                let given = Arguments { first: first.map(|f| (f.operand, f.span)), args, at: name.span };
                let call = self.c.user_call(callee, pou, given, line.span);
                if let Some(sides) = sides {
                    self.reword(count, line, &sides, "another type for its first argument");
                }
                self.result_of(call, pou, line.span)
            }
            Target::Special(_) | Target::Reported => Operand::Error,
        };
        self.set_result(result, span, operations, line.span);
    }

    /// `INT_TO_REAL i`: all arguments stand behind the name, as if the current result were none. Reports it.
    fn brings_all(&mut self, name: &'a ast::Name, args: &'a [ast::Arg]) -> bool {
        let trial = self.c.cx.trial();
        let target = self.c.named_callee(name);
        self.c.cx.undo(trial);
        let parameters = match target {
            Target::Standard(func) if func.param_type(func.min_args()).is_none() => func.min_args(),
            Target::User(_, pou) => {
                let vars = self.c.cx.defs.pous[pou].vars.iter().map(|v| self.c.cx.defs.vars[*v].section);
                vars.filter(|s| matches!(s, Section::Input | Section::InOut)).count()
            }
            _ => return false,
        };
        let Some(ast::ArgKind::Positional(first)) = args.first().map(|a| &a.kind) else { return false };
        if args.len() != parameters {
            return false;
        }
        let rest: Vec<String> = args[1..].iter().map(print_arg).collect();
        let rest = if rest.is_empty() { String::new() } else { format!(" {}", rest.join(", ")) };
        let message = format!("{} arguments for {}, the current result among them", args.len() + 1, name.text);
        self.c.report(Diagnostic::new(codes::TOO_MANY_ARGUMENTS, first.span, message).help(format!(
            "the current result is the first argument: write `LD {}`, then `{}{rest}`",
            print_expr(first),
            name.text
        )));
        true
    }

    fn result_of(&mut self, call: Option<Call>, pou: crate::defs::PouId, span: Span) -> Operand {
        let Some(call) = call else { return Operand::Error };
        let ty = match self.c.cx.defs.pous[pou].result {
            Some(var) => self.c.type_of_var(var),
            None => Types::VOID,
        };
        self.c.followed_value(Operand::value(ExprKind::Call(Box::new(call)), ty, span))
    }

    /// What a function gave; one without a result leaves none.
    fn set_result(&mut self, result: Operand, span: Span, operations: u32, at: Span) {
        match result {
            Operand::Value { expr, ty } if ty == Types::VOID => {
                let kind = match expr.kind {
                    ExprKind::Call(call) => StmtKind::Call(call),
                    _ => StmtKind::Eval(expr),
                };
                self.emit(kind, at);
                self.cr = Current::Nothing;
            }
            result => self.set_current(result, span, operations),
        }
    }

    fn standard(
        &mut self,
        line: &Line<'a>,
        func: &'static StdFn,
        first: Option<Value>,
        args: &'a [ast::Arg],
    ) -> Operand {
        if matches!(func.meaning, Meaning::Outputs) {
            self.c.report(
                Diagnostic::new(codes::NO_VALUE, line.span, format!("{} gives no value, only outputs", func.name))
                    .help(format!("use the formal form: it is {}", func.signature())),
            );
            return Operand::Error;
        }
        let taken = usize::from(first.is_some());
        let given = args.len() + taken;
        if given > func.min_args() && func.param_type(given - 1).is_none() {
            let message = format!("{given} arguments for {}, the current result among them", func.name);
            let at = args.last().map_or(line.span, |a| a.span);
            let help = format!("it is {}", func.signature());
            self.c.report(Diagnostic::new(codes::TOO_MANY_ARGUMENTS, at, message).help(help));
            return Operand::Error;
        }
        if given < func.min_args() {
            let message = format!("argument `{}` of {} is missing", func.param_name(given), func.name);
            self.c.report(
                Diagnostic::new(codes::MISSING_ARGUMENT, line.span, message)
                    .help(format!("it is {}; the current result is the first argument", func.signature())),
            );
            return Operand::Error;
        }
        let sides = first.as_ref().map(|f| self.sides(f, None));
        let mut operands: Vec<(Operand, Span)> = first.into_iter().map(|f| (f.operand, f.span)).collect();
        for (n, arg) in args.iter().enumerate() {
            let ast::ArgKind::Positional(e) = &arg.kind else { return Operand::Error };
            let want = wanted_of_argument(func, n + taken, line.want);
            operands.push((self.c.operand(e, want), e.span));
        }
        if operands.iter().any(|(o, _)| matches!(o, Operand::Error)) {
            return Operand::Error;
        }
        let count = self.c.cx.diags.count();
        let result = self.c.apply(func, operands, line.span, line.want);
        if let Some(sides) = sides {
            self.reword(count, line, &sides, &format!("other arguments: {}", func.signature()));
        }
        result
    }

    /// A function in formal form: all arguments are named.
    pub fn formal(&mut self, line: &Line<'a>, call: &'a ast::Call) {
        self.drop_current(line.span);
        let result = self.c.call_operand(call, line.span, line.want);
        self.set_result(result, line.span, 1 + call.args.len() as u32, line.span);
    }
}

fn print_arg(arg: &ast::Arg) -> String {
    match &arg.kind {
        ast::ArgKind::Positional(e) => print_expr(e),
        ast::ArgKind::Input(..) | ast::ArgKind::Output { .. } => String::new(),
    }
}
