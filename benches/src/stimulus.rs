//! Inputs that change from cycle to cycle: the same in every run, with transients and with reals that are not exact.

use crate::interface::{Kind, Leaf};
use plcc_stdlib::elem::Elem;

/// How an input moves. Each element of an array moves on its own.
#[derive(Debug, Clone, Copy)]
pub enum Signal {
    /// A BOOL that changes with this probability a cycle.
    Flips(f64),
    /// A BOOL that is TRUE with this probability.
    Pulses(f64),
    /// A number that is another one in every cycle.
    Noise(f64, f64),
    /// A number that wanders between two bounds by at most the third a cycle.
    Walk(f64, f64, f64),
    /// A number that jumps somewhere between two bounds with a probability of the third a cycle.
    Jumps(f64, f64, f64),
    /// One of some texts, another one with a probability a cycle.
    Texts(&'static [&'static str], f64),
}

/// One input in motion.
#[derive(Debug, Clone)]
struct Moving {
    signal: Signal,
    kind: Kind,
    value: f64,
    text: &'static str,
}

/// The inputs of a program.
pub struct Stimulus {
    random: fastrand::Rng,
    inputs: Vec<Moving>,
}

impl Stimulus {
    /// For the leaves of a program's inputs; `signals` names variables.
    pub fn new(leaves: &[Leaf], signals: &[(&str, Signal)]) -> Self {
        let mut random = fastrand::Rng::with_seed(61131);
        let moving = |leaf: &Leaf| {
            let name = leaf.variable.rsplit('.').next().unwrap_or_default();
            let found = signals.iter().find(|(n, _)| n.eq_ignore_ascii_case(name));
            let signal = found.unwrap_or_else(|| panic!("no signal for the input {name}")).1;
            let value = match signal {
                Signal::Flips(_) => f64::from(u8::from(random.bool())),
                Signal::Pulses(_) => 0.0,
                Signal::Noise(low, high) | Signal::Walk(low, high, _) | Signal::Jumps(low, high, _) => {
                    low + random.f64() * (high - low)
                }
                Signal::Texts(..) => 0.0,
            };
            let text = if let Signal::Texts(texts, _) = signal { texts[0] } else { "" };
            Moving { signal, kind: leaf.kind, value, text }
        };
        let inputs = leaves.iter().map(moving).collect();
        Self { random, inputs }
    }

    /// Appends the values of the next cycle, leaf after leaf, in the bytes of memory.
    fn cycle(&mut self, bytes: &mut Vec<u8>) {
        let Self { random, inputs } = self;
        for input in inputs {
            let p = random.f64();
            match input.signal {
                Signal::Flips(share) if p < share => input.value = 1.0 - input.value,
                Signal::Pulses(share) => input.value = f64::from(u8::from(p < share)),
                Signal::Noise(low, high) => input.value = low + p * (high - low),
                Signal::Walk(low, high, step) => {
                    input.value = (input.value + (2.0 * p - 1.0) * step).clamp(low, high);
                }
                Signal::Jumps(low, high, share) if p < share => input.value = low + random.f64() * (high - low),
                Signal::Texts(texts, share) if p < share => input.text = texts[random.usize(..texts.len())],
                _ => {}
            }
            input.append(bytes);
        }
    }

    /// The values of so many cycles, one after the other.
    pub fn cycles(mut self, count: u64) -> Vec<u8> {
        let mut bytes = Vec::new();
        (0..count).for_each(|_| self.cycle(&mut bytes));
        bytes
    }
}

impl Moving {
    fn append(&self, bytes: &mut Vec<u8>) {
        match self.kind {
            Kind::Text(capacity) => {
                assert!(self.text.len() <= capacity, "`{}` is too long", self.text);
                let end = bytes.len() + capacity + 1;
                bytes.extend(self.text.as_bytes());
                bytes.resize(end, 0);
            }
            Kind::Elem(Elem::Real) => bytes.extend((self.value as f32).to_le_bytes()),
            Kind::Elem(Elem::Lreal) => bytes.extend(self.value.to_le_bytes()),
            Kind::Elem(elem) => {
                bytes.extend(&(self.value.floor() as i64).to_le_bytes()[..elem.bytes() as usize]);
            }
        }
    }
}
