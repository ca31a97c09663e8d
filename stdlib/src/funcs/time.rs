//! Functions of time and date (Ed. 2 table 30) and the scan clock.

use super::*;
use crate::convert::NS_PER_DAY;
use crate::elem::Elem::*;
use crate::ops::{self, Op};
use crate::prim::Repr;

fn fixed(name: &str, params: &[(&'static str, Elem)], result: Elem, meaning: Meaning, doc: &'static str) -> StdFn {
    let params: Vec<(&'static str, Type)> = params.iter().map(|(n, e)| (*n, Type::Fixed(*e))).collect();
    row(name, "Ed. 2 table 30", Generic::Any, &params, meaning, doc).gives(Type::Fixed(result))
}

pub(super) fn rows() -> Vec<StdFn> {
    let add = Meaning::Operator(Operator::Add);
    let sub = Meaning::Operator(Operator::Sub);
    // Dates and times are nanoseconds: their sum is that of TIME whatever the types are called.
    let sum = Meaning::Formula(|_, args, e| Some(ops::emit(Op::Add, Time, args, e)));
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
            fixed(
                &name("CONCAT_@DATE_@TOD"),
                &[("IN1", d), ("IN2", tod)],
                dt,
                sum,
                "A date and a time of day together.",
            ),
        ]);
        let scaled = |name: String, op, doc| {
            let params = [("IN1", Type::Fixed(t)), ("IN2", Type::Var)];
            row(&name, "Ed. 2 table 30", Generic::Num, &params, Meaning::Operator(op), doc).gives(Type::Fixed(t))
        };
        let mul = "A duration times a number, to the nearest nanosecond, ties to even.";
        let div = "A duration divided by a number, to the nearest nanosecond, ties to even.";
        rows.push(scaled(name("MUL@TIME"), Operator::Mul, mul));
        rows.push(scaled(name("MUL_@TIME"), Operator::Mul, mul));
        rows.push(scaled(name("DIV@TIME"), Operator::Div, div));
        rows.push(scaled(name("DIV_@TIME"), Operator::Div, div));
    }
    let weekday = Meaning::Formula(|_, args, e| Some(day_of_week(args[0], e)));
    rows.push(fixed("DAY_OF_WEEK", &[("IN", Date)], Int, weekday, "The day of the week: 0 is Sunday."));
    rows
}

/// 1970-01-01 was a Thursday. Any instant of a day counts for it, also before 1970.
fn day_of_week(date: Val, e: &mut dyn Emit) -> Val {
    let r = Repr::I64;
    let day = e.constant(r, NS_PER_DAY as u64);
    let week = e.constant(r, 7 * NS_PER_DAY as u64);
    let thursday = e.constant(r, 4 * NS_PER_DAY as u64);
    // Inside its week first, then positive: neither sum can overflow.
    let in_week = e.prim(PrimOp::RemS, r, &[date, week]);
    let in_week = e.prim(PrimOp::Add, r, &[in_week, week]);
    let from_sunday = e.prim(PrimOp::Add, r, &[in_week, thursday]);
    let in_week = e.prim(PrimOp::RemU, r, &[from_sunday, week]);
    let number = e.prim(PrimOp::DivU, r, &[in_week, day]);
    e.prim(PrimOp::Wrap(Repr::I16), r, &[number])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fold::Folder;

    #[test]
    fn days_of_the_week() {
        let weekday = |ns: i64| {
            let mut e = Folder::new();
            let date = e.value(ns as u64);
            let v = find("DAY_OF_WEEK").unwrap().emit(Date, &[date], &mut e).unwrap();
            e.raw(v)
        };
        assert_eq!(weekday(0), 4, "1970-01-01 was a Thursday");
        assert_eq!([1, 2, 3, 9].map(|d| weekday(d * NS_PER_DAY)), [5, 6, 0, 6]);
        assert_eq!([-1, -4, -5, -7].map(|d| weekday(d * NS_PER_DAY)), [3, 0, 6, 4]);
        assert_eq!(weekday(19753 * NS_PER_DAY), 3, "2024-01-31 was a Wednesday");
        assert_eq!(weekday(-1), 3, "late on 1969-12-31");
        assert!(weekday(i64::MAX) < 7 && weekday(i64::MIN) < 7);
    }
}
