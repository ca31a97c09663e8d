//! The process image: outputs in their safe state when the program stops on a fault.

use crate::engine::Region;
use crate::image::Image;
use crate::path;

/// %Q.
const OUTPUTS: usize = 1;

/// Sets all outputs to FALSE and 0, then to the values of `[io.safe_state]` (semantics.md \[E4\]).
pub fn safe_state(image: &Image, mem: &mut Region) {
    let (start, bytes) = image.areas[OUTPUTS];
    if let Some(area) = mem.as_mut_slice().get_mut(start as usize..(start + bytes) as usize) {
        area.fill(0);
    }
    for value in &image.safe_state {
        path::write(mem.as_mut_slice(), value.offset, value.bit, &value.bytes);
    }
}
