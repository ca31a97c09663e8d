//! Dates, times of day and their components (Ed. 3 table 36): CONCAT_*, SPLIT_*, DAY_OF_WEEK.
//!
//! Days are counted in the Gregorian calendar, also before it was introduced. A year starts in March here, so that the leap
//! day is its last and 400 years are always 146097 days.

use super::*;
use crate::convert::NS_PER_DAY;
use crate::elem::Elem::*;
use crate::fault::Fault;
use crate::ops::{self, Op};
use crate::prim::Repr;

/// The years that 64-bit nanoseconds hold as a whole.
const FULL_YEARS: (i64, i64) = (1678, 2261);
/// From 0000-03-01 to 1970-01-01.
const DAYS_TO_1970: u64 = 719_468;
const NS_PER_MS: u64 = 1_000_000;

/// LINT arithmetic that reads like one: operands are never negative where `/` and `%` stand.
struct Lints<'e>(&'e mut dyn Emit);

impl Lints<'_> {
    fn n(&mut self, n: u64) -> Val {
        self.0.constant(Repr::I64, n)
    }
    fn op(&mut self, op: PrimOp, a: Val, b: Val) -> Val {
        self.0.prim(op, Repr::I64, &[a, b])
    }
    fn add(&mut self, a: Val, b: Val) -> Val {
        self.op(PrimOp::Add, a, b)
    }
    fn sub(&mut self, a: Val, b: Val) -> Val {
        self.op(PrimOp::Sub, a, b)
    }
    fn plus(&mut self, a: Val, n: u64) -> Val {
        let n = self.n(n);
        self.op(PrimOp::Add, a, n)
    }
    fn minus(&mut self, a: Val, n: u64) -> Val {
        let n = self.n(n);
        self.op(PrimOp::Sub, a, n)
    }
    fn times(&mut self, a: Val, n: u64) -> Val {
        let n = self.n(n);
        self.op(PrimOp::Mul, a, n)
    }
    fn over(&mut self, a: Val, n: u64) -> Val {
        let n = self.n(n);
        self.op(PrimOp::DivU, a, n)
    }
    fn rest(&mut self, a: Val, n: u64) -> Val {
        let n = self.n(n);
        self.op(PrimOp::RemU, a, n)
    }
    /// 1 if a < n.
    fn below(&mut self, a: Val, n: u64) -> Val {
        let n = self.n(n);
        let is = self.op(PrimOp::LtU, a, n);
        self.0.prim(PrimOp::Zext(Repr::I64), Repr::I8, &[is])
    }
    /// A value of a subrange: a fault outside.
    fn within(&mut self, v: Val, low: Val, high: Val) {
        let above = self.op(PrimOp::LeS, low, v);
        let below = self.op(PrimOp::LeS, v, high);
        let ok = self.0.prim(PrimOp::And, Repr::I8, &[above, below]);
        self.0.check(ok, Fault::SubrangeViolation, &[v, low, high]);
    }
    fn limited(&mut self, v: Val, low: i64, high: i64) {
        let (low, high) = (self.n(low as u64), self.n(high as u64));
        self.within(v, low, high);
    }
}

/// Nanoseconds at 0:00 of a day; year, month and day are checked.
fn date(c: &mut Lints, [year, month, day]: [Val; 3]) -> Val {
    c.limited(year, FULL_YEARS.0, FULL_YEARS.1);
    c.limited(month, 1, 12);
    let length = days_of_month(c, year, month);
    let one = c.n(1);
    c.within(day, one, length);
    // January and February belong to the year before.
    let early = c.below(month, 3);
    let year = c.sub(year, early);
    let wrapped = c.times(early, 12);
    let month = c.add(month, wrapped);
    let month = c.minus(month, 3);
    // 153 days are five months from March on.
    let days = c.times(month, 153);
    let days = c.plus(days, 2);
    let day_of_year = c.over(days, 5);
    let day_of_year = c.add(day_of_year, day);
    let years = c.times(year, 365);
    let fours = c.over(year, 4);
    let hundreds = c.over(year, 100);
    let four_hundreds = c.over(year, 400);
    let days = c.add(years, fours);
    let days = c.sub(days, hundreds);
    let days = c.add(days, four_hundreds);
    let days = c.add(days, day_of_year);
    let days = c.minus(days, DAYS_TO_1970 + 1);
    c.times(days, NS_PER_DAY as u64)
}

/// 28 to 31.
fn days_of_month(c: &mut Lints, year: Val, month: Val) -> Val {
    // Odd months up to July have 31 days, from August on even ones: bit 3 of the number turns them around.
    let eighth = c.over(month, 8);
    let odd = c.add(month, eighth);
    let odd = c.rest(odd, 2);
    let usual = c.plus(odd, 30);
    let hundred = c.rest(year, 100);
    let hundred = c.below(hundred, 1);
    // A year divisible by 100 is a leap year if it is divisible by 400, that is if year / 100 is divisible by 4.
    let century = c.over(year, 100);
    let number = c.0.prim(PrimOp::Wrap(Repr::I8), Repr::I64, &[hundred]);
    let number = c.0.prim(PrimOp::Select, Repr::I64, &[number, century, year]);
    let number = c.rest(number, 4);
    let leap = c.below(number, 1);
    let february = c.plus(leap, 28);
    let two = c.n(2);
    let is_february = c.op(PrimOp::Eq, month, two);
    c.0.prim(PrimOp::Select, Repr::I64, &[is_february, february, usual])
}

/// Nanoseconds since midnight; hour, minute, second, millisecond are checked.
fn time_of_day(c: &mut Lints, [hour, minute, second, millisecond]: [Val; 4]) -> Val {
    c.limited(hour, 0, 23);
    c.limited(minute, 0, 59);
    c.limited(second, 0, 59);
    c.limited(millisecond, 0, 999);
    let minutes = c.times(hour, 60);
    let minutes = c.add(minutes, minute);
    let seconds = c.times(minutes, 60);
    let seconds = c.add(seconds, second);
    let ms = c.times(seconds, 1000);
    let ms = c.add(ms, millisecond);
    c.times(ms, NS_PER_MS)
}

/// Nanoseconds since midnight, for any instant: the days before 1970 too.
fn since_midnight(c: &mut Lints, instant: Val) -> Val {
    let day = c.n(NS_PER_DAY as u64);
    let rest = c.op(PrimOp::RemS, instant, day);
    let rest = c.add(rest, day);
    c.op(PrimOp::RemU, rest, day)
}

/// Year, month and day of an instant.
fn components(c: &mut Lints, instant: Val) -> [Val; 3] {
    let day = c.n(NS_PER_DAY as u64);
    let zero = c.n(0);
    let days = c.op(PrimOp::DivS, instant, day);
    let rest = c.op(PrimOp::RemS, instant, day);
    let before = c.op(PrimOp::LtS, rest, zero);
    let before = c.0.prim(PrimOp::Zext(Repr::I64), Repr::I8, &[before]);
    let days = c.sub(days, before);
    let days = c.plus(days, DAYS_TO_1970);
    let era = c.over(days, 146_097);
    let day_of_era = c.rest(days, 146_097);
    let leaps = c.over(day_of_era, 1460);
    let centuries = c.over(day_of_era, 36_524);
    let last = c.over(day_of_era, 146_096);
    let plain = c.sub(day_of_era, leaps);
    let plain = c.add(plain, centuries);
    let plain = c.sub(plain, last);
    let year_of_era = c.over(plain, 365);
    let years = c.times(year_of_era, 365);
    let fours = c.over(year_of_era, 4);
    let hundreds = c.over(year_of_era, 100);
    let before = c.add(years, fours);
    let before = c.sub(before, hundreds);
    let day_of_year = c.sub(day_of_era, before);
    let months = c.times(day_of_year, 5);
    let months = c.plus(months, 2);
    let month = c.over(months, 153);
    let start = c.times(month, 153);
    let start = c.plus(start, 2);
    let start = c.over(start, 5);
    let day = c.sub(day_of_year, start);
    let day = c.plus(day, 1);
    // From March on; January and February belong to the next year.
    let late = c.below(month, 10);
    let wrapped = c.times(late, 12);
    let month = c.minus(month, 9);
    let month = c.add(month, wrapped);
    let four_hundreds = c.times(era, 400);
    let year = c.add(four_hundreds, year_of_era);
    let year = c.plus(year, 1);
    let year = c.sub(year, late);
    [year, month, day]
}

/// A component of the time of day: units of `ns`, counted modulo `modulus`.
fn part(args: &[Val], e: &mut dyn Emit, ns: u64, modulus: u64) -> Option<Val> {
    let c = &mut Lints(e);
    let rest = since_midnight(c, args[0]);
    let units = c.over(rest, ns);
    Some(c.rest(units, modulus))
}

const DATE_OUTPUTS: [Output; 3] = [
    Output { name: "YEAR", range: (1677, 2262), formula: |_, a, e| Some(components(&mut Lints(e), a[0])[0]) },
    Output { name: "MONTH", range: (1, 12), formula: |_, a, e| Some(components(&mut Lints(e), a[0])[1]) },
    Output { name: "DAY", range: (1, 31), formula: |_, a, e| Some(components(&mut Lints(e), a[0])[2]) },
];
const TIME_OUTPUTS: [Output; 4] = [
    Output { name: "HOUR", range: (0, 23), formula: |_, a, e| part(a, e, 3_600_000 * NS_PER_MS, 24) },
    Output { name: "MINUTE", range: (0, 59), formula: |_, a, e| part(a, e, 60_000 * NS_PER_MS, 60) },
    Output { name: "SECOND", range: (0, 59), formula: |_, a, e| part(a, e, 1000 * NS_PER_MS, 60) },
    Output { name: "MILLISECOND", range: (0, 999), formula: |_, a, e| part(a, e, NS_PER_MS, 1000) },
];
/// What the long forms give as well.
const FINE_OUTPUTS: [Output; 2] = [
    Output { name: "MICROSECOND", range: (0, 999), formula: |_, a, e| part(a, e, 1000, 1000) },
    Output { name: "NANOSECOND", range: (0, 999), formula: |_, a, e| part(a, e, 1, 1000) },
];

pub(super) fn rows() -> Vec<StdFn> {
    let clause = "Ed. 3 table 36";
    let int = |names: &[&'static str]| names.iter().map(|n| (*n, Type::Integer)).collect::<Vec<_>>();
    let ymd = int(&["YEAR", "MONTH", "DAY"]);
    let hms = int(&["HOUR", "MINUTE", "SECOND", "MILLISECOND"]);
    let both = [ymd.clone(), hms.clone()].concat();
    // All of them are nanoseconds: their sum is that of TIME whatever the types are called.
    let sum = Meaning::Formula(|_, args, e| Some(ops::emit(Op::Add, Time, args, e)));
    let of_date = Meaning::Formula(|_, a, e| Some(date(&mut Lints(e), [a[0], a[1], a[2]])));
    let of_time = Meaning::Formula(|_, a, e| Some(time_of_day(&mut Lints(e), [a[0], a[1], a[2], a[3]])));
    let of_both = Meaning::Formula(|_, a, e| {
        let c = &mut Lints(e);
        let date = date(c, [a[0], a[1], a[2]]);
        let time = time_of_day(c, [a[3], a[4], a[5], a[6]]);
        Some(c.add(date, time))
    });
    let make = |name: &str, params: &[(&'static str, Type)], result, meaning, doc| {
        row(name, clause, Generic::Any, params, meaning, doc).gives(Type::Fixed(result))
    };
    let dated = "The day of these numbers. A fault unless there is such a day from 1678 to 2261.";
    let timed = "The time of day of these numbers: 0..23, 0..59, 0..59, 0..999; others are a fault.";
    let joined = "A date and a time of day together.";
    let mut rows = vec![
        make("CONCAT_DATE", &ymd, Date, of_date, dated),
        make("CONCAT_LDATE", &ymd, Ldate, of_date, dated),
        make("CONCAT_TOD", &hms, Tod, of_time, timed),
        make("CONCAT_LTOD", &hms, Ltod, of_time, timed),
        make("CONCAT_DT", &both, Dt, of_both, "The instant of these numbers; see CONCAT_DATE and CONCAT_TOD."),
        make("CONCAT_LDT", &both, Ldt, of_both, "The instant of these numbers; see CONCAT_DATE and CONCAT_TOD."),
    ];
    for (name, d, tod, dt) in [
        ("CONCAT_DATE_TOD", Date, Tod, Dt),
        ("CONCAT_DATE_LTOD", Date, Ltod, Ldt),
        ("CONCAT_LDATE_TOD", Ldate, Tod, Ldt),
        ("CONCAT_LDATE_LTOD", Ldate, Ltod, Ldt),
    ] {
        rows.push(make(name, &[("IN1", Type::Fixed(d)), ("IN2", Type::Fixed(tod))], dt, sum, joined));
    }
    let (d, t, fine) = (&DATE_OUTPUTS[..], &TIME_OUTPUTS[..], &FINE_OUTPUTS[..]);
    for (name, elem, outputs) in [
        ("SPLIT_DATE", Date, d.to_vec()),
        ("SPLIT_LDATE", Ldate, d.to_vec()),
        ("SPLIT_TOD", Tod, t.to_vec()),
        ("SPLIT_LTOD", Ltod, [t, fine].concat()),
        ("SPLIT_DT", Dt, [d, t].concat()),
        ("SPLIT_LDT", Ldt, [d, t, fine].concat()),
    ] {
        let doc = "The numbers of IN, each fetched with `=>` into an integer variable.";
        let row = row(name, clause, Generic::Any, &[("IN", Type::Fixed(elem))], Meaning::Outputs, doc);
        rows.push(StdFn { outputs, ..row.gives(Type::Nothing) });
    }
    let weekday = Meaning::Formula(|_, args, e| Some(day_of_week(&mut Lints(e), args[0])));
    let row = row(
        "DAY_OF_WEEK",
        clause,
        Generic::Any,
        &[("IN", Type::Fixed(Date))],
        weekday,
        "The day of the week: 0 is Sunday. INT unless the place asks for another integer type.",
    );
    rows.push(row.gives(Type::IntegerOfPlace));
    rows
}

/// 1970-01-01 was a Thursday. Any instant of a day counts for it, also before 1970.
fn day_of_week(c: &mut Lints, date: Val) -> Val {
    let week = c.n(7 * NS_PER_DAY as u64);
    // Inside its week first, then positive: neither sum can overflow.
    let in_week = c.op(PrimOp::RemS, date, week);
    let in_week = c.add(in_week, week);
    let from_sunday = c.plus(in_week, 4 * NS_PER_DAY as u64);
    let in_week = c.op(PrimOp::RemU, from_sunday, week);
    c.over(in_week, NS_PER_DAY as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fold::Folder;

    fn call(name: &str, args: &[i64]) -> Result<i64, [i64; 3]> {
        let mut e = Folder::new();
        let args: Vec<Val> = args.iter().map(|a| e.value(*a as u64)).collect();
        let v = find(name).unwrap().emit(Lint, &args, &mut e).unwrap();
        match e.fault() {
            Some((fault, values)) => {
                assert_eq!(fault, Fault::SubrangeViolation);
                Err(values)
            }
            None => Ok(e.raw(v) as i64),
        }
    }

    fn split(instant: i64) -> [i64; 3] {
        ["YEAR", "MONTH", "DAY"].map(|part| call(&format!("$SPLIT_DT.{part}"), &[instant]).unwrap())
    }

    #[test]
    fn days_of_the_week() {
        let weekday = |ns: i64| call("DAY_OF_WEEK", &[ns]).unwrap();
        assert_eq!(weekday(0), 4, "1970-01-01 was a Thursday");
        assert_eq!([1, 2, 3, 9].map(|d| weekday(d * NS_PER_DAY)), [5, 6, 0, 6]);
        assert_eq!([-1, -4, -5, -7].map(|d| weekday(d * NS_PER_DAY)), [3, 0, 6, 4]);
        assert_eq!(weekday(19753 * NS_PER_DAY), 3, "2024-01-31 was a Wednesday");
        assert_eq!(weekday(-1), 3, "late on 1969-12-31");
        assert!(weekday(i64::MAX) < 7 && weekday(i64::MIN) < 7);
    }

    #[test]
    fn known_days() {
        let day = |y, m, d| call("CONCAT_DATE", &[y, m, d]).map(|ns| ns / NS_PER_DAY);
        assert_eq!(day(1970, 1, 1), Ok(0));
        assert_eq!(day(1969, 12, 31), Ok(-1));
        assert_eq!(day(2000, 2, 29), Ok(11016));
        assert_eq!(day(2024, 1, 31), Ok(19753));
        assert_eq!(day(2100, 3, 1), Ok(47541));
        assert_eq!(day(1900, 2, 29), Err([29, 1, 28]));
        assert_eq!(day(2023, 2, 29), Err([29, 1, 28]));
        assert_eq!(day(2024, 4, 31), Err([31, 1, 30]));
        assert_eq!(day(2024, 13, 1), Err([13, 1, 12]));
        assert_eq!(day(2024, 1, 0), Err([0, 1, 31]));
        assert_eq!(day(0, 1, 1), Err([0, 1678, 2261]));
        assert_eq!(call("CONCAT_TOD", &[23, 59, 59, 999]), Ok(NS_PER_DAY - 1_000_000));
        assert_eq!(call("CONCAT_TOD", &[24, 0, 0, 0]), Err([24, 0, 23]));
        assert_eq!(call("CONCAT_DT", &[1970, 1, 2, 0, 0, 1, 5]), Ok(NS_PER_DAY + 1_005_000_000));
    }

    /// The full years counted day by day beside the formulas: all days around the turns of centuries, else the ends of months.
    #[test]
    fn each_day_there_and_back() {
        let mut at = call("CONCAT_DATE", &[FULL_YEARS.0, 1, 1]).unwrap();
        for year in FULL_YEARS.0..=FULL_YEARS.1 {
            let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
            let lengths = [31, if leap { 29 } else { 28 }, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
            for (month, length) in (1..).zip(lengths) {
                for day in 1..=length {
                    if day > 1 && day < length && (4..96).contains(&(year % 100)) {
                        at += NS_PER_DAY;
                        continue;
                    }
                    assert_eq!(call("CONCAT_DATE", &[year, month, day]), Ok(at));
                    assert_eq!(split(at), [year, month, day]);
                    assert_eq!(split(at + NS_PER_DAY - 1), [year, month, day]);
                    at += NS_PER_DAY;
                }
                assert_eq!(call("CONCAT_DATE", &[year, month, length + 1]), Err([length + 1, 1, length]));
            }
        }
        assert_eq!(split(i64::MAX), [2262, 4, 11]);
        assert_eq!(split(i64::MIN), [1677, 9, 21]);
    }

    #[test]
    fn parts_of_a_day() {
        let parts = |ns| {
            ["HOUR", "MINUTE", "SECOND", "MILLISECOND", "MICROSECOND", "NANOSECOND"]
                .map(|p| call(&format!("$SPLIT_LTOD.{p}"), &[ns]).unwrap())
        };
        assert_eq!(parts(0), [0; 6]);
        assert_eq!(parts(86_399_123_456_789), [23, 59, 59, 123, 456, 789]);
        assert_eq!(parts(-1), [23, 59, 59, 999, 999, 999]);
    }
}
