//! Rows by name, arguments by position, values by hand (semantics.md \[N1\], \[T6\]).

use super::*;
use crate::fold::Folder;
use Elem::*;

fn call(name: &str, elem: Elem, args: &[u64]) -> u64 {
    let f = find(name).unwrap_or_else(|| panic!("{name}"));
    let mut e = Folder::new();
    let args: Vec<Val> = args.iter().map(|a| e.value(*a)).collect();
    let v = f.emit(elem, &args, &mut e).unwrap_or_else(|| panic!("{name}"));
    assert_eq!(e.raw(v) & !f.result_elem(elem).repr().mask(), 0);
    e.raw(v)
}
fn r(x: f32) -> u64 {
    u64::from(x.to_bits())
}

#[test]
fn names_in_any_case() {
    assert_eq!(find("limit").unwrap().name, "LIMIT");
    assert_eq!(find("Int_To_Real").unwrap().name, "INT_TO_REAL");
    assert!(find("").is_none() && find("INT_TO_").is_none() && find("INT_TO_INT").is_none());
    assert!(find("ääääääää").is_none() && find(&"X".repeat(500)).is_none());
    for name in ["ADD_INT", "GT_REAL", "AND_WORD", "SEL_TIME", "ADD_TIME", "TO_LREAL", "TRUNC_INT", "REAL_TRUNC_INT"] {
        assert!(find(name).is_some(), "{name}");
    }
    assert!(find("TIME_TO_DATE").is_none() && find("AND_REAL").is_none() && find("SIN_INT").is_none());
    assert_eq!(find("DATE_AND_TIME_TO_TIME_OF_DAY").unwrap().result, Ret::Fixed(Tod));
}

#[test]
fn each_name_once() {
    let mut names: Vec<_> = all().map(|f| f.name).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count);
    assert!(all().all(|f| find(f.name).is_some_and(|g| std::ptr::eq(f, g))));
}

#[test]
fn parameters_count_on() {
    let add = find("ADD").unwrap();
    assert_eq!(add.param(0).unwrap().0, "IN1");
    assert_eq!(add.param(4).unwrap().0, "IN5");
    assert_eq!((add.position("in2"), add.position("IN12"), add.position("IN0")), (Some(1), Some(11), None));
    let mux = find("MUX").unwrap();
    assert_eq!(mux.param(3).unwrap().0, "IN2");
    assert_eq!((mux.position("K"), mux.position("IN0"), mux.position("IN7")), (Some(0), Some(1), Some(8)));
    let sub = find("SUB").unwrap();
    assert!(sub.param(2).is_none() && sub.position("IN3").is_none());
    assert!(add.position("INX").is_none() && add.position("IN03").is_none() && add.position("ü").is_none());
}

#[test]
fn values() {
    assert_eq!(call("ADD", Int, &[1, 2, 3]), 6);
    assert_eq!(call("MUL_REAL", Bool, &[r(1.5), r(2.0)]), r(3.0), "the typed form knows its type");
    assert_eq!(call("LIMIT", Int, &[0, 0xFFFF, 10]), 0);
    assert_eq!(call("LIMIT", Uint, &[0, 0xFFFF, 10]), 10);
    assert_eq!(call("MAX", Sint, &[1, 0xFF, 3, 2]), 3);
    for (k, want) in [(0u64, 10), (1, 11), (2, 12), (3, 12), (u64::MAX, 12)] {
        assert_eq!(call("MUX", Int, &[k, 10, 11, 12]), want, "K = {k}");
    }
    assert_eq!(call("GT", Int, &[3, 2, 1]), 1);
    assert_eq!(call("GT", Int, &[3, 2, 2]), 0);
    assert_eq!(call("GT", Int, &[2, 3, 1]), 0);
    assert_eq!(call("SEL", Real, &[1, r(1.0), r(2.0)]), r(2.0));
    assert_eq!(call("SHL", Word, &[1, 15]), 0x8000);
    assert_eq!(call("NOT", Bool, &[0]), 1);
    assert_eq!(call("XOR", Byte, &[1, 3, 4]), 6);
    assert_eq!(call("EXPT", Real, &[r(2.0), r(3.0)]), r(8.0));
    assert_eq!(call("SQRT", Real, &[r(9.0)]), r(3.0));
    assert_eq!(call("LOG", Real, &[r(100.0)]), r(2.0));
    assert_eq!(call("MOVE", Dt, &[7]), 7);
    assert_eq!(call("MULTIME", Int, &[10, 0xFFFF]) as i64, -10);
}

#[test]
fn rounding_takes_its_type_from_the_place() {
    let x = r(-2.5);
    assert_eq!(call("TRUNC", Real, &[x]), 0xFFFF_FFFE);
    assert_eq!(call("REAL_TRUNC_INT", Real, &[x]), 0xFFFE);
    assert_eq!(call("TRUNC_SINT", Real, &[x]), 0xFE);
    assert_eq!(call("ROUND", Real, &[x]), r(-2.0));
    assert_eq!(call("CEIL", Real, &[x]), r(-2.0));
    assert_eq!(call("FLOOR", Real, &[x]), r(-3.0));
    let floor = find("FLOOR").unwrap().for_place(Real, Int).unwrap();
    assert_eq!((floor.name, floor.result), ("REAL_FLOOR_INT", Ret::Fixed(Int)));
    assert_eq!(call(floor.name, Real, &[x]), 0xFFFD);
    assert_eq!(call("REAL_ROUND_INT", Real, &[r(3.5)]), 4);
    assert_eq!(call("REAL_CEIL_USINT", Real, &[r(1e9)]), 255);
    assert!(find("TRUNC").unwrap().for_place(Real, Word).is_none());
    assert!(find("ABS").unwrap().for_place(Real, Int).is_none());
}

#[test]
fn conversions_by_name() {
    assert_eq!(call("INT_TO_REAL", Bool, &[0xFFFF]), r(-1.0));
    assert_eq!(call("TO_INT", Real, &[r(2.5)]), 2);
    assert_eq!(call("TO_TIME", Dint, &[5]), 5_000_000);
    assert!(!find("TO_DATE").unwrap().accepts(Time));
    assert!(find("TO_DATE").unwrap().accepts(Dt));
}

#[test]
fn dates() {
    let day = crate::convert::NS_PER_DAY;
    assert_eq!(call("DAY_OF_WEEK", Date, &[0]), 4, "1970-01-01 was a Thursday");
    assert_eq!(call("DAY_OF_WEEK", Date, &[(3 * day) as u64]), 0);
    assert_eq!(call("DAY_OF_WEEK", Date, &[(-5 * day) as u64]), 6);
    assert_eq!(call("CONCAT_DATE_TOD", Date, &[day as u64, 5]), day as u64 + 5);
    assert_eq!(call("IS_VALID", Real, &[r(f32::NAN)]), 0);
    assert_eq!(call("IS_VALID", Real, &[r(f32::NEG_INFINITY)]), 0);
    assert_eq!(call("IS_VALID", Lreal, &[1f64.to_bits()]), 1);
}

#[test]
fn the_clock_is_no_constant() {
    assert!(find("TIME").unwrap().emit(Bool, &[], &mut Folder::new()).is_none());
}

#[test]
fn every_row_is_well_typed() {
    // `Folder::prim` asserts that each operation is defined for its operands.
    for f in all() {
        for elem in crate::elem::ALL {
            if (f.var.is_some() && !f.accepts(elem)) || matches!(f.sem, Sem::Clock) {
                continue;
            }
            call(f.name, elem, &vec![1; f.params.len()]);
        }
    }
}
