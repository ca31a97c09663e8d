//! Every typing rule between elementary types (semantics.md \[T2\], \[P2\], \[P3\]). Facts come from `stdlib::elem`; the answers here
//! become explicit conversions, so no later stage asks again.

use plcc_stdlib::elem::{Elem, Family};

/// What an implicit conversion costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Implicit {
    /// The same type.
    Same,
    /// Every value is kept.
    Exact,
    /// Allowed, but a large integer may lose digits in a real.
    Rounds,
    /// Only in profile codesys, with a warning.
    CodesysOnly,
    /// An explicit conversion is needed.
    No,
}

/// Whether a value of one elementary type may be used where another is wanted, without a conversion being written.
pub fn implicit(from: Elem, to: Elem) -> Implicit {
    use Family::*;
    if from == to {
        return Implicit::Same;
    }
    let wider = to.bits() > from.bits();
    match (from.family(), to.family()) {
        (Signed, Signed) | (Unsigned, Unsigned) | (Bits, Bits) | (Unsigned, Signed) if wider => Implicit::Exact,
        (Real, Real) if wider => Implicit::Exact,
        (Signed | Unsigned, Real) => {
            // REAL holds 24 bits exactly, LREAL 53.
            let exact = if to == Elem::Real { 16 } else { 32 };
            if from.bits() <= exact { Implicit::Exact } else { Implicit::Rounds }
        }
        (Duration, Duration) | (Date, Date) | (TimeOfDay, TimeOfDay) | (DateTime, DateTime) => {
            if is_long(to) && !is_long(from) { Implicit::Exact } else { Implicit::No }
        }
        (Signed | Unsigned | Bits | Real, Signed | Unsigned | Bits | Real) => Implicit::CodesysOnly,
        _ => Implicit::No,
    }
}

fn is_long(elem: Elem) -> bool {
    matches!(elem, Elem::Ltime | Elem::Ldate | Elem::Ltod | Elem::Ldt)
}

/// The common type of two operands: the one to which the other converts implicitly. In profile codesys also: signed and
/// unsigned of one width meet in the next wider signed, bit strings count as unsigned.
pub fn common(a: Elem, b: Elem, codesys: bool) -> Option<Elem> {
    let free = |i| matches!(i, Implicit::Same | Implicit::Exact | Implicit::Rounds);
    if free(implicit(a, b)) {
        return Some(b);
    }
    if free(implicit(b, a)) {
        return Some(a);
    }
    if !codesys || implicit(a, b) == Implicit::No {
        return None;
    }
    if a.is_real() || b.is_real() {
        return Some(if a == Elem::Lreal || b == Elem::Lreal { Elem::Lreal } else { Elem::Real });
    }
    Some(match (a.is_signed(), b.is_signed()) {
        (true, true) | (false, false) => integer(a.bits().max(b.bits()), a.is_signed()),
        (signed, _) => {
            let (s, u) = if signed { (a, b) } else { (b, a) };
            let bits = if s.bits() > u.bits() { s.bits() } else { (u.bits() * 2).min(64) };
            integer(bits, true)
        }
    })
}

/// The integer type of a width.
pub fn integer(bits: u32, signed: bool) -> Elem {
    match (bits, signed) {
        (8, true) => Elem::Sint,
        (16, true) => Elem::Int,
        (32, true) => Elem::Dint,
        (_, true) => Elem::Lint,
        (8, false) => Elem::Usint,
        (16, false) => Elem::Uint,
        (32, false) => Elem::Udint,
        (_, false) => Elem::Ulint,
    }
}

/// The unsigned integer that a bit string counts as; other types unchanged.
pub fn as_number(elem: Elem) -> Elem {
    if elem.is_bits() { integer(elem.bits(), false) } else { elem }
}

/// The type in which profile codesys computes (\[P3\]): at least 32 bits.
pub fn computed(elem: Elem) -> Elem {
    match elem {
        Elem::Sint | Elem::Int => Elem::Dint,
        Elem::Usint | Elem::Uint => Elem::Udint,
        Elem::Byte | Elem::Word => Elem::Dword,
        other => other,
    }
}

/// The type of an untyped integer where nothing asks for one: the smallest of INT, DINT, LINT, ULINT that holds it (\[T3\]).
pub fn default_integer(value: i128) -> Option<Elem> {
    [Elem::Int, Elem::Dint, Elem::Lint, Elem::Ulint].into_iter().find(|e| holds(*e, value))
}

/// Whether an integer or bit-string type holds a value.
pub fn holds(elem: Elem, value: i128) -> bool {
    elem.range().is_some_and(|(low, high)| (low..=high).contains(&value))
}

/// The name of the conversion function, for help texts: `INT_TO_REAL`.
pub fn conversion_name(from: Elem, to: Elem) -> String {
    format!("{}_TO_{}", from.name(), to.name())
}

#[cfg(test)]
mod tests {
    use super::*;
    use Elem::*;

    #[test]
    fn common_types_of_t2() {
        assert_eq!(common(Int, Dint, false), Some(Dint));
        assert_eq!(common(Usint, Int, false), Some(Int));
        assert_eq!(common(Uint, Int, false), None);
        assert_eq!(common(Uint, Int, true), Some(Dint));
        assert_eq!(common(Ulint, Lint, true), Some(Lint));
        assert_eq!(common(Byte, Word, false), Some(Word));
        assert_eq!(common(Byte, Int, false), None);
        assert_eq!(common(Byte, Int, true), Some(Int));
        assert_eq!(common(Dint, Lreal, false), Some(Lreal));
        assert_eq!(common(Time, Ltime, false), Some(Ltime));
        assert_eq!(common(Time, Int, true), None);
        assert_eq!(common(Bool, Byte, true), None);
    }

    #[test]
    fn wide_integers_round_in_reals() {
        assert_eq!(implicit(Int, Real), Implicit::Exact);
        assert_eq!(implicit(Dint, Real), Implicit::Rounds);
        assert_eq!(implicit(Dint, Lreal), Implicit::Exact);
        assert_eq!(implicit(Lint, Lreal), Implicit::Rounds);
        assert_eq!(implicit(Real, Int), Implicit::CodesysOnly);
        assert_eq!(implicit(Int, Uint), Implicit::CodesysOnly);
    }
}
