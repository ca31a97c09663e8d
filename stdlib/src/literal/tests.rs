//! Forms and mistakes of semantics.md \[L4\], \[L5\].

use super::LiteralError::*;
use super::*;
use Elem::*;

fn ok(elem: Elem, text: &str) -> i128 {
    elem.to_i128(parse(elem, text).unwrap_or_else(|e| panic!("{text}: {e}")))
}
fn err(elem: Elem, text: &str) -> LiteralError {
    parse(elem, text).expect_err(text)
}

#[test]
fn integers() {
    assert_eq!(ok(Int, "1_000"), 1000);
    assert_eq!(ok(Int, "-32768"), -32768);
    assert_eq!(ok(Byte, "16#fF"), 255);
    assert_eq!(ok(Usint, "2#1111_0000"), 0xF0);
    assert_eq!(ok(Dint, "8#17"), 15);
    assert_eq!(ok(Ulint, "18446744073709551615"), u64::MAX.into());
    assert_eq!(ok(Int, "-16#10"), -16);
    assert_eq!(err(Sint, "200"), OutOfRange { elem: Sint, min: -128, max: 127 });
    assert_eq!(err(Int, "16#FFFF"), OutOfRange { elem: Int, min: -32768, max: 32767 });
    assert_eq!(err(Usint, "-1"), OutOfRange { elem: Usint, min: 0, max: 255 });
    assert_eq!(err(Int, "2#102"), BadDigit { at: 4, base: 2 });
    assert_eq!(err(Int, "1x"), BadDigit { at: 1, base: 10 });
    assert_eq!(err(Int, "7#1"), BadBase { at: 0 });
    assert_eq!(err(Int, "1__0"), Underscore { at: 1 });
    assert_eq!(err(Int, "1_"), Underscore { at: 1 });
    assert_eq!(err(Int, "_1"), Underscore { at: 0 });
    assert!(matches!(err(Int, ""), Malformed { .. }));
    assert!(matches!(err(Int, "16#"), Malformed { .. }));
    assert!(matches!(err(Lint, &"9".repeat(100_000)), OutOfRange { .. }));
    assert!(matches!(err(Int, "ü"), BadDigit { .. }));
}

#[test]
fn booleans() {
    assert_eq!((ok(Bool, "TRUE"), ok(Bool, "false"), ok(Bool, "1"), ok(Bool, "0"), ok(Bool, "2#1")), (1, 0, 1, 0, 1));
    assert!(matches!(err(Bool, "2"), OutOfRange { .. }));
    assert!(matches!(err(Bool, "yes"), Malformed { .. }));
}

#[test]
fn reals_are_rounded_once() {
    let r = |t: &str| f32::from_bits(parse(Real, t).unwrap() as u32);
    let l = |t: &str| f64::from_bits(parse(Lreal, t).unwrap());
    assert_eq!(r("0.1"), 0.1);
    assert_eq!(l("1_000.5e-3"), 1.0005);
    assert_eq!(l("-0.0").to_bits(), (-0.0f64).to_bits());
    assert_eq!(r("1E3"), 1000.0);
    assert_eq!(l("12"), 12.0);
    assert_eq!(r("16#FF"), 255.0);
    // Just above halfway between two REALs, but exactly halfway after a detour over LREAL.
    assert_eq!(r("1.00000005960464477540"), 1.0000001);
    assert_eq!(l("1e-400"), 0.0);
    assert_eq!(err(Real, "1e39"), TooLarge { elem: Real });
    assert_eq!(err(Lreal, "1e999"), TooLarge { elem: Lreal });
    for bad in ["", ".", "1.", ".5", "1e", "1e+", "nan", "inf", "1.5.2", "0x1", "1_.5", "--1"] {
        assert!(parse(Lreal, bad).is_err(), "{bad}");
    }
}

#[test]
fn durations() {
    const S: i128 = 1_000_000_000;
    assert_eq!(ok(Time, "1d2h3m4s5ms6us7ns"), 93_784 * S + 5_006_007);
    assert_eq!(ok(Time, "90m"), 5400 * S);
    assert_eq!(ok(Time, "-1s500ms"), -1_500_000_000);
    assert_eq!(ok(Time, "1.5S"), 1_500_000_000);
    assert_eq!(ok(Time, "1d_2h_30m"), 95_400 * S);
    assert_eq!(ok(Ltime, "5us_10ns"), 5010);
    assert_eq!(ok(Time, "0.1d"), 8640 * S);
    assert_eq!(ok(Time, "0.5ns"), 0, "ties to even");
    assert_eq!(ok(Time, "1.5ns"), 2);
    assert_eq!(ok(Time, "0.50000000000000000000000000001ns"), 1);
    assert_eq!(ok(Time, "1_0s"), 10 * S);
    assert_eq!(ok(Time, "-106751d23h47m16s854ms775us808ns"), i64::MIN.into());
    assert_eq!(err(Time, "1s2d"), UnitOrder { at: 3 });
    assert_eq!(err(Time, "1s2s"), UnitOrder { at: 3 });
    assert_eq!(err(Time, "1d25h"), UnitOverflow { at: 2, limit: 24 });
    assert_eq!(err(Time, "1.5h3m"), FractionNotLast { at: 0 });
    assert_eq!(err(Time, "1min30s"), UnknownUnit { unit: "min".into(), at: 1 });
    assert_eq!(err(Time, "1min30s").help().unwrap(), "write `m`");
    assert_eq!(err(Time, "5"), UnknownUnit { unit: "".into(), at: 1 });
    assert_eq!(err(Time, "200000d"), TooLarge { elem: Time });
    assert!(matches!(err(Time, &format!("{}s", "9".repeat(1000))), TooLarge { .. }));
    for bad in ["", "-", "s", "1s_", "_1s", "1s ", "1.s", "1 s", "1µs"] {
        assert!(parse(Time, bad).is_err(), "{bad}");
    }
}

#[test]
fn dates() {
    const DAY: i128 = NS_PER_DAY as i128;
    use crate::convert::NS_PER_DAY;
    assert_eq!(ok(Date, "1970-01-01"), 0);
    assert_eq!(ok(Date, "2024-01-31"), 19753 * DAY);
    assert_eq!(ok(Date, "2000-02-29"), 11016 * DAY);
    assert_eq!(ok(Date, "1969-12-31"), -DAY);
    assert_eq!(ok(Tod, "13:05:00"), 47_100_000_000_000);
    assert_eq!(ok(Tod, "13:05:00.25"), 47_100_250_000_000);
    assert_eq!(ok(Tod, "13:05"), 47_100_000_000_000);
    assert_eq!(ok(Dt, "1970-01-02-00:00:01"), DAY + 1_000_000_000);
    assert_eq!(err(Date, "2023-02-29"), BadField { field: "day", at: 8, range: (1, 28) });
    assert_eq!(err(Date, "1900-02-29"), BadField { field: "day", at: 8, range: (1, 28) });
    assert_eq!(err(Date, "2023-13-01"), BadField { field: "month", at: 5, range: (1, 12) });
    assert_eq!(err(Tod, "24:00:00"), BadField { field: "hour", at: 0, range: (0, 23) });
    assert_eq!(err(Date, "2300-01-01"), TooLarge { elem: Date });
    for bad in ["", "2024", "2024-01", "2024-01-01x", "-1-1", "2024-01-31-1:2:3"] {
        assert!(parse(Date, bad).is_err(), "{bad}");
    }
    for bad in ["", "12", "12:", "12:00:00.", "12:00:00.5x"] {
        assert!(parse(Tod, bad).is_err(), "{bad}");
    }
    for days in [-100_000, -719_468, -1, 0, 59, 60, 789, 11_016, 100_000] {
        let (y, m, d) = civil_from_days(days);
        if y > 1677 && y < 2262 {
            assert_eq!(ok(Date, &format!("{y}-{m}-{d}")), i128::from(days) * DAY);
        }
    }
}

#[test]
fn strings() {
    let s = |t: &str| string(t, Nul::Error);
    assert_eq!(s("'aä'").unwrap(), [0x61, 0xE4]);
    assert_eq!(s("'$$$'$\"$l$N$p$R$t$41'").unwrap(), b"$'\"\n\n\x0C\r\tA");
    assert_eq!(s("''").unwrap(), b"");
    assert_eq!(s("'€'"), Err(NotLatin1 { found: '€', at: 1 }));
    assert_eq!(s("'a$00b'"), Err(NulCharacter { at: 2 }));
    assert_eq!(string("'a$00b'", Nul::Ends).unwrap(), b"a");
    for bad in ["", "'", "'a", "a", "'$'", "'$4'", "'$x'", "'a'b'", "\"a\""] {
        assert!(s(bad).is_err(), "{bad}");
    }
    let w = |t: &str| wstring(t, Nul::Error);
    assert_eq!(w("\"a€$0041$20AC'\"").unwrap(), [0x61, 0x20AC, 0x41, 0x20AC, 0x27]);
    assert_eq!(w("\"😀\"").unwrap(), [0xD83D, 0xDE00]);
    assert!(w("\"$41\"").is_err());
    assert_eq!(ok(Char, "'A'"), 65);
    assert_eq!(ok(Wchar, "\"€\""), 0x20AC);
    assert_eq!(err(Char, "'AB'"), NotOneCharacter);
}
