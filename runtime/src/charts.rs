//! Tells when a step of a chart was activated while it was active: two tokens became one (semantics.md \[G2\], what the
//! structure analysis could not exclude).
//!
//! The compiled chart raises a hidden flag in the step and one in its instance. Here they are looked at after each cycle, the
//! ones of the instances first, and taken back. Each step is told once: what happens again is no news.

use crate::image::{Image, TypeDesc};
use crate::path::Resolver;
use plcc_stdlib::chart_flags::{CHART, STEP};

/// The flags of all charts of a resource.
#[derive(Debug, Default)]
pub struct Charts {
    /// Flags of charts.
    raised: Vec<usize>,
    /// Flags of steps and the names of the steps; those that were told are taken out.
    steps: Vec<(usize, String)>,
}

impl Charts {
    /// Finds the flags in a part of the memory (first byte, length); their places count from its start.
    pub fn new(image: &Image, resolver: &Resolver, (start, bytes): (u32, u32)) -> Self {
        let mut charts = Self::default();
        let step =
            |ty: &TypeDesc| matches!(ty, TypeDesc::Struct { fields, .. } if fields.iter().any(|f| f.name == STEP));
        if !image.types.iter().any(step) {
            return charts;
        }
        for (name, leaf) in resolver.every_leaf().unwrap_or_default() {
            let Some(at) = leaf.offset.checked_sub(start).filter(|at| *at < bytes) else { continue };
            if let Some(step) = name.strip_suffix(STEP).and_then(|step| step.strip_suffix('.')) {
                charts.steps.push((at as usize, step.to_string()));
            } else if name.strip_suffix(CHART).is_some_and(|rest| rest.ends_with('$')) {
                charts.raised.push(at as usize);
            }
        }
        charts
    }

    /// Messages about steps that were activated twice in this cycle for the first time.
    pub fn check(&mut self, cycle: u64, memory: &mut [u8]) -> String {
        let mut any = false;
        for &flag in &self.raised {
            any |= std::mem::replace(&mut memory[flag], 0) != 0;
        }
        let mut text = String::new();
        if !any {
            return text;
        }
        self.steps.retain(|(flag, name)| {
            if memory[*flag] == 0 {
                return true;
            }
            text +=
                &format!("warning[W0609]: a step was activated while it was active\n  step {name}\n  cycle {cycle}\n");
            false
        });
        text
    }
}
