//! Functions of time and date (Ed. 2 table 30) and the scan clock.

use super::*;
use crate::elem::Elem::*;

fn fixed(name: &str, params: &[(&'static str, Elem)], result: Elem, meaning: Meaning, doc: &'static str) -> StdFn {
    let params: Vec<(&'static str, Type)> = params.iter().map(|(n, e)| (*n, Type::Fixed(*e))).collect();
    row(name, "Ed. 2 table 30", Generic::Any, &params, meaning, doc).gives(Type::Fixed(result))
}

pub(super) fn rows() -> Vec<StdFn> {
    let add = Meaning::Operator(Operator::Add);
    let sub = Meaning::Operator(Operator::Sub);
    let clock = Meaning::Formula(|_, _, e| e.clock());
    let mut rows = vec![
        fixed("TIME", &[], Time, clock, "The scan clock: the same value all through a scan."),
        fixed("LTIME", &[], Ltime, clock, "The scan clock: the same value all through a scan."),
    ];
    for (t, d, tod, dt, l) in [(Time, Date, Tod, Dt, ""), (Ltime, Ldate, Ltod, Ldt, "L")] {
        let name = |text: &str| text.replace('@', l);
        rows.extend([
            fixed(&name("ADD_@TIME"), &[("IN1", t), ("IN2", t)], t, add, "The sum of two durations."),
            fixed(&name("SUB_@TIME"), &[("IN1", t), ("IN2", t)], t, sub, "The difference of two durations."),
            fixed(&name("ADD_@TOD_@TIME"), &[("IN1", tod), ("IN2", t)], tod, add, "A time of day later by IN2."),
            fixed(&name("ADD_@DT_@TIME"), &[("IN1", dt), ("IN2", t)], dt, add, "A date and time later by IN2."),
            fixed(&name("SUB_@TOD_@TIME"), &[("IN1", tod), ("IN2", t)], tod, sub, "A time of day earlier by IN2."),
            fixed(&name("SUB_@DT_@TIME"), &[("IN1", dt), ("IN2", t)], dt, sub, "A date and time earlier by IN2."),
            fixed(&name("SUB_@DATE_@DATE"), &[("IN1", d), ("IN2", d)], t, sub, "The time from IN2 to IN1."),
            fixed(&name("SUB_@TOD_@TOD"), &[("IN1", tod), ("IN2", tod)], t, sub, "The time from IN2 to IN1."),
            fixed(&name("SUB_@DT_@DT"), &[("IN1", dt), ("IN2", dt)], t, sub, "The time from IN2 to IN1."),
        ]);
        rows.push(scaled(&name("MUL_@TIME"), Operator::Mul, t));
        rows.push(scaled(&name("DIV_@TIME"), Operator::Div, t));
    }
    rows.extend(scaling());
    rows
}

/// MULTIME and DIVTIME, as Ed. 2 spells them.
fn scaling() -> [StdFn; 2] {
    [scaled("MULTIME", Operator::Mul, Time), scaled("DIVTIME", Operator::Div, Time)]
}

/// Their typed forms, after the number: `MULTIME_INT`.
pub(super) fn typed_scaling() -> Vec<StdFn> {
    let numbers = || crate::elem::ALL.into_iter().filter(|e| Generic::Num.contains(*e));
    scaling().iter().flat_map(|row| numbers().flat_map(|elem| row.typed(elem)).collect::<Vec<_>>()).collect()
}

/// A duration and a number.
fn scaled(name: &str, op: Operator, t: Elem) -> StdFn {
    let params = [("IN1", Type::Fixed(t)), ("IN2", Type::Var)];
    let doc = match op {
        Operator::Mul => "A duration times a number, to the nearest nanosecond, ties to even.",
        _ => "A duration divided by a number, to the nearest nanosecond, ties to even.",
    };
    row(name, "Ed. 2 table 30", Generic::Num, &params, Meaning::Operator(op), doc).gives(Type::Fixed(t))
}
