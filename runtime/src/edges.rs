//! The edges of the process image: what happens before and after each execution of a task. Inputs come in, outputs go out,
//! forced variables take their values, and with several resources the values that they share are copied to and fro.
//!
//! With several resources %I, %Q, %M and the configuration's globals live in the *home*, a part of the memory of its own
//! (semantics.md \[C3\]). An execution works on a copy taken at its start; at its end each value that it changed is given
//! back as a whole, so that none is ever torn and the last writer wins.

use crate::engine::Part;
use crate::force::{self, Force};
use crate::image::{Image, Resource, Share};
use crate::io::IoDriver;
use crate::path;

const INPUTS: usize = 0;
const OUTPUTS: usize = 1;

/// What all resources use together.
pub struct Edges<'a> {
    image: &'a Image,
    driver: Box<dyn IoDriver>,
    forces: Vec<Force>,
    /// A fault: outputs are in their safe state and stay there.
    stopped: bool,
}

/// What a resource's shared values were when the running execution took them.
#[derive(Debug, Default)]
pub struct Taken {
    bytes: Vec<u8>,
}

impl Taken {
    /// Room for a resource.
    pub fn new(resource: &Resource) -> Self {
        Self { bytes: vec![0; resource.shares.iter().map(|s| s.bytes as usize).sum()] }
    }
}

impl<'a> Edges<'a> {
    /// Around one application.
    pub fn new(image: &'a Image, driver: Box<dyn IoDriver>, forces: Vec<Force>) -> Self {
        Self { image, driver, forces, stopped: false }
    }

    /// Tells the driver that a cycle begins.
    pub fn begin(&mut self, cycle: u64) {
        self.driver.begin(cycle);
    }

    /// Inputs as they are now, for variables that release tasks.
    pub fn inputs<'m>(&mut self, part: &mut Part<'m>, home: Option<&mut Part<'m>>) -> Result<(), String> {
        let place = home.unwrap_or(part);
        let start = place.start();
        let inputs = area(self.image, INPUTS, start, place.as_mut_slice());
        self.driver.read(inputs)?;
        force::apply(&self.forces, start, place.as_mut_slice());
        Ok(())
    }

    /// Before an execution.
    pub fn before<'m>(
        &mut self,
        resource: &Resource,
        part: &mut Part<'m>,
        mut home: Option<&mut Part<'m>>,
        taken: &mut Taken,
    ) -> Result<(), String> {
        self.inputs(part, home.as_deref_mut())?;
        if let Some(home) = home {
            take(resource, part, home, taken);
            force::apply(&self.forces, part.start(), part.as_mut_slice());
        }
        Ok(())
    }

    /// After an execution.
    pub fn after<'m>(
        &mut self,
        resource: &Resource,
        part: &mut Part<'m>,
        home: Option<&mut Part<'m>>,
        taken: &Taken,
    ) -> Result<(), String> {
        if self.stopped {
            return Ok(());
        }
        if !self.forces.is_empty() {
            force::apply(&self.forces, part.start(), part.as_mut_slice());
        }
        let place = match home {
            Some(home) => {
                give(resource, part, home, taken);
                force::apply(&self.forces, home.start(), home.as_mut_slice());
                home
            }
            None => part,
        };
        let start = place.start();
        self.driver.write(area(self.image, OUTPUTS, start, place.as_mut_slice()))
    }

    /// A cycle has ended.
    pub fn end<'m>(&mut self, part: &mut Part<'m>, home: Option<&mut Part<'m>>) -> Result<(), String> {
        let place = home.unwrap_or(part);
        let start = place.start();
        self.driver.end(area(self.image, OUTPUTS, start, place.as_mut_slice()))
    }

    /// A fault stopped the program: all outputs FALSE and 0, then the values of `[io.safe_state]`, given out at once and for
    /// good (semantics.md \[E4\]).
    pub fn safe_state<'m>(&mut self, part: &mut Part<'m>, home: Option<&mut Part<'m>>) -> Result<(), String> {
        self.stopped = true;
        let place = home.unwrap_or(part);
        let start = place.start();
        area(self.image, OUTPUTS, start, place.as_mut_slice()).fill(0);
        for value in &self.image.safe_state {
            path::write(place.as_mut_slice(), value.offset - start as u32, value.bit, &value.bytes);
        }
        let outputs = area(self.image, OUTPUTS, start, place.as_mut_slice());
        self.driver.write(outputs)?;
        self.driver.end(outputs)
    }

    /// The outputs of a task that starts again: their safe values, in the copy and, through it, outside.
    pub fn safe_outputs<'m>(
        &mut self,
        task: usize,
        part: &mut Part<'m>,
        home: Option<&mut Part<'m>>,
    ) -> Result<(), String> {
        let place = home.unwrap_or(part);
        let start = place.start() as u32;
        for (offset, bit, bytes) in &self.image.tasks[task].outputs {
            let zeros = [0; 8];
            let mut rest = *bytes;
            while rest > 0 {
                let n = rest.min(8);
                path::write(place.as_mut_slice(), offset - start + (bytes - rest), *bit, &zeros[..n as usize]);
                rest -= n;
            }
            let inside = |at: &u32| (*offset..offset + bytes).contains(at);
            for value in self.image.safe_state.iter().filter(|v| inside(&v.offset) && (bit.is_none() || v.bit == *bit))
            {
                path::write(place.as_mut_slice(), value.offset - start, value.bit, &value.bytes);
            }
        }
        let start = place.start();
        self.driver.write(area(self.image, OUTPUTS, start, place.as_mut_slice()))
    }
}

/// An area in the part that starts at `start`; empty if it does not lie there.
fn area<'p>(image: &Image, which: usize, start: usize, part: &'p mut [u8]) -> &'p mut [u8] {
    let (first, bytes) = image.areas[which];
    let range = (first as usize).checked_sub(start).map(|at| at..at + bytes as usize);
    range.and_then(|range| part.get_mut(range)).unwrap_or_default()
}

fn take(resource: &Resource, part: &mut Part, home: &Part, taken: &mut Taken) {
    let (part_start, home_start) = (part.start(), home.start());
    let (to, from) = (part.as_mut_slice(), home.as_slice());
    let mut at = 0;
    for share in &resource.shares {
        let bytes = share.bytes as usize;
        let source = &from[share.home as usize - home_start..][..bytes];
        to[share.local as usize - part_start..][..bytes].copy_from_slice(source);
        taken.bytes[at..at + bytes].copy_from_slice(source);
        at += bytes;
    }
}

fn give(resource: &Resource, part: &Part, home: &mut Part, taken: &Taken) {
    let (part_start, home_start) = (part.start(), home.start());
    let (from, to) = (part.as_slice(), home.as_mut_slice());
    let mut at = 0;
    for share in &resource.shares {
        let bytes = share.bytes as usize;
        let now = &from[share.local as usize - part_start..][..bytes];
        let before = &taken.bytes[at..at + bytes];
        at += bytes;
        if now != before {
            give_changed(share, now, before, &mut to[share.home as usize - home_start..][..bytes]);
        }
    }
}

fn give_changed(share: &Share, now: &[u8], before: &[u8], to: &mut [u8]) {
    if share.unit == 0 {
        for ((now, before), to) in now.iter().zip(before).zip(to) {
            let changed = now ^ before;
            *to = *to & !changed | now & changed;
        }
        return;
    }
    let unit = share.unit as usize;
    for ((now, before), to) in now.chunks(unit).zip(before.chunks(unit)).zip(to.chunks_mut(unit)) {
        if now != before {
            to.copy_from_slice(now);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Region;
    use crate::io::Nothing;

    /// Two resources of 16 bytes, the home behind them: a byte of bits and two values of four bytes.
    fn image() -> Image {
        let shares = |local| {
            vec![Share { home: 32, local, bytes: 1, unit: 0 }, Share { home: 36, local: local + 4, bytes: 8, unit: 4 }]
        };
        let resource = |start| Resource { start, bytes: 16, shares: shares(start), ..Resource::default() };
        Image {
            resources: vec![resource(0), resource(16)],
            region_bytes: 48,
            home: (32, 16),
            areas: [(32, 0), (32, 1), (33, 0)],
            ..Image::default()
        }
    }

    #[test]
    fn what_changed_is_given_back_and_nothing_else() {
        let image = image();
        let mut region = Region::new(48);
        let [mut a, mut b, mut home] = region.parts([(0, 16), (16, 16), (32, 16)]);
        let mut edges = Edges::new(&image, Box::new(Nothing), Vec::new());
        let (ra, rb) = (&image.resources[0], &image.resources[1]);
        let (mut ta, mut tb) = (Taken::new(ra), Taken::new(rb));
        // Both execute at the same time.
        edges.before(ra, &mut a, Some(&mut home), &mut ta).unwrap();
        edges.before(rb, &mut b, Some(&mut home), &mut tb).unwrap();
        a.as_mut_slice()[0] = 0b01;
        a.as_mut_slice()[4..8].copy_from_slice(&[1, 2, 3, 4]);
        b.as_mut_slice()[0] = 0b10;
        b.as_mut_slice()[8..12].copy_from_slice(&[5, 6, 7, 8]);
        edges.after(ra, &mut a, Some(&mut home), &ta).unwrap();
        edges.after(rb, &mut b, Some(&mut home), &tb).unwrap();
        assert_eq!(home.as_slice()[..12], [0b11, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8]);
        // The last writer wins with the whole value.
        edges.before(ra, &mut a, Some(&mut home), &mut ta).unwrap();
        edges.before(rb, &mut b, Some(&mut home), &mut tb).unwrap();
        a.as_mut_slice()[4] = 9;
        b.as_mut_slice()[5] = 9;
        edges.after(ra, &mut a, Some(&mut home), &ta).unwrap();
        edges.after(rb, &mut b, Some(&mut home), &tb).unwrap();
        assert_eq!(home.as_slice()[4..8], [1, 9, 3, 4]);
        // After a fault nobody changes outputs any more.
        edges.safe_state(&mut a, Some(&mut home)).unwrap();
        edges.after(rb, &mut b, Some(&mut home), &tb).unwrap();
        assert_eq!(home.as_slice()[0], 0);
    }
}
