//! Transcendental functions: those of the C library's libm, in single and in double precision.
//!
//! The interpreter, the JIT and a linked program call the same symbols, so they give the same bits. Rust's own methods are
//! not used: what they call is not promised.

use super::RtFn;
use crate::prim::Repr;

macro_rules! libm {
    ($($repr:ident $row:ident $name:ident ($($arg:ident),+): $doc:literal;)*) => {
        mod c {
            unsafe extern "C" {
                $(pub safe fn $name($($arg: libm!(@ty $repr)),+) -> libm!(@ty $repr);)*
            }
        }
        $(
            #[doc = $doc]
            pub static $row: RtFn = RtFn {
                symbol: stringify!($name),
                params: &[$(libm!(@repr $repr $arg)),+],
                result: Repr::$repr,
                eval: |args| {
                    let mut args = args.iter().copied();
                    $(let $arg = <libm!(@ty $repr)>::from_bits(args.next().unwrap_or(0) as _);)+
                    u64::from(c::$name($($arg),+).to_bits())
                },
                address: || c::$name as *const u8,
            };
        )*
        /// Every row.
        pub static ALL: &[&RtFn] = &[$(&$row),*];
    };
    (@ty F32) => { f32 };
    (@ty F64) => { f64 };
    (@repr $repr:ident $arg:ident) => { Repr::$repr };
}

libm! {
    F32 SIN_F32 sinf(x): "SIN in single precision.";
    F64 SIN_F64 sin(x): "SIN.";
    F32 COS_F32 cosf(x): "COS in single precision.";
    F64 COS_F64 cos(x): "COS.";
    F32 TAN_F32 tanf(x): "TAN in single precision.";
    F64 TAN_F64 tan(x): "TAN.";
    F32 ASIN_F32 asinf(x): "ASIN in single precision.";
    F64 ASIN_F64 asin(x): "ASIN.";
    F32 ACOS_F32 acosf(x): "ACOS in single precision.";
    F64 ACOS_F64 acos(x): "ACOS.";
    F32 ATAN_F32 atanf(x): "ATAN in single precision.";
    F64 ATAN_F64 atan(x): "ATAN.";
    F32 ATAN2_F32 atan2f(y, x): "ATAN2(Y, X) in single precision.";
    F64 ATAN2_F64 atan2(y, x): "ATAN2(Y, X).";
    F32 EXP_F32 expf(x): "EXP in single precision.";
    F64 EXP_F64 exp(x): "EXP.";
    F32 LN_F32 logf(x): "LN in single precision.";
    F64 LN_F64 log(x): "LN.";
    F32 LOG_F32 log10f(x): "LOG in single precision.";
    F64 LOG_F64 log10(x): "LOG.";
    F32 POW_F32 powf(x, y): "EXPT in single precision.";
    F64 POW_F64 pow(x, y): "EXPT.";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_both_precisions() {
        let f = |row: &RtFn, args: &[f64]| {
            f64::from_bits((row.eval)(&args.iter().map(|x| x.to_bits()).collect::<Vec<_>>()))
        };
        let s = |row: &RtFn, args: &[f32]| {
            f32::from_bits((row.eval)(&args.iter().map(|x| u64::from(x.to_bits())).collect::<Vec<_>>()) as u32)
        };
        assert_eq!(f(&SIN_F64, &[0.0]), 0.0);
        assert_eq!(f(&COS_F64, &[0.0]), 1.0);
        assert_eq!(f(&LN_F64, &[1.0]), 0.0);
        assert_eq!(f(&LOG_F64, &[1000.0]), 3.0);
        assert_eq!(f(&EXP_F64, &[1.0]), std::f64::consts::E);
        assert_eq!(f(&ATAN2_F64, &[1.0, -1.0]), 3.0 * std::f64::consts::FRAC_PI_4);
        assert_eq!(f(&POW_F64, &[0.0, 0.0]), 1.0);
        assert_eq!(f(&POW_F64, &[2.0, 10.0]), 1024.0);
        assert_eq!(s(&POW_F32, &[2.0, -1.0]), 0.5);
        assert_eq!(s(&ATAN_F32, &[1.0]), std::f32::consts::FRAC_PI_4);
        assert!(f(&ASIN_F64, &[2.0]).is_nan());
        assert!(s(&LN_F32, &[-1.0]).is_nan());
    }

    #[test]
    fn rows_are_consistent() {
        for row in ALL {
            let single = row.symbol.ends_with('f') && row.symbol != "erf";
            let repr = if single { Repr::F32 } else { Repr::F64 };
            assert_eq!(row.result, repr, "{}", row.symbol);
            assert!(row.params.iter().all(|p| *p == repr), "{}", row.symbol);
            assert!(!(row.address)().is_null());
            // A caller's mistake gives a number, not a panic.
            (row.eval)(&[]);
        }
    }
}
