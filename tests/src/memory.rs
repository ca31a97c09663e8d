//! Memory of test programs: regions, and when two of them count as equal.

/// Sixty-four bytes with the alignment that compiled code expects of a region.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
pub struct Line([u8; 64]);

/// A region of so many bytes, all 0, as lines.
pub fn region(bytes: usize) -> Vec<Line> {
    vec![Line([0; 64]); bytes.div_ceil(64)]
}

/// The bytes of a region.
pub fn bytes_of(lines: &mut [Line]) -> &mut [u8] {
    let (pointer, length) = (lines.as_mut_ptr(), lines.len() * 64);
    // SAFETY: a Line is 64 plain bytes.
    unsafe { std::slice::from_raw_parts_mut(pointer.cast(), length) }
}

/// The first byte in which two memories differ. Sign and payload of a NaN are not defined: words that are NaN in both
/// count as equal.
pub fn difference(a: &[u8], b: &[u8]) -> Option<usize> {
    let mut at = 0;
    while at < a.len() {
        if a[at] == b[at] {
            at += 1;
            continue;
        }
        let nan = |width: usize| {
            let start = at / width * width;
            let word = |m: &[u8]| m.get(start..start + width).map(|w| w.to_vec());
            let is_nan = |w: Option<Vec<u8>>| match w.as_deref() {
                Some([x, y, z, w]) => f32::from_le_bytes([*x, *y, *z, *w]).is_nan(),
                Some(w) if w.len() == 8 => w.try_into().is_ok_and(|w| f64::from_le_bytes(w).is_nan()),
                _ => false,
            };
            (is_nan(word(a)) && is_nan(word(b))).then_some(start + width)
        };
        match nan(4).or_else(|| nan(8)) {
            Some(next) => at = next,
            None => return Some(at),
        }
    }
    None
}

/// The bytes from `at` on, for a message.
pub fn excerpt(mem: &[u8], at: usize) -> String {
    format!("{:02x?}", &mem[at..(at + 8).min(mem.len())])
}
