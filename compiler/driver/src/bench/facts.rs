//! What a report says of the machine and of the method.

use crate::bench::measure::{self, Plan};
use crate::bench::ticks::Scale;

/// The machine, one fact a line, with its load as it is now.
pub fn machine() -> Vec<String> {
    let cpus = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |name: &str| {
        let line = cpus.lines().find(|l| l.starts_with(name))?;
        line.split_once(':').map(|(_, value)| value.trim().to_string())
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let virtual_machine = field("flags").is_some_and(|f| f.split(' ').any(|f| f == "hypervisor"));
    vec![
        format!(
            "processor: {}, {cores} cores{}",
            field("model name").unwrap_or_else(|| std::env::consts::ARCH.into()),
            if virtual_machine { ", in a virtual machine" } else { "" }
        ),
        load("before"),
    ]
}

/// The load of the machine, as a fact.
pub fn load(when: &str) -> String {
    let text = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    format!("load {when} (1, 5, 15 minutes): {}", text.split(' ').take(3).collect::<Vec<_>>().join(" "))
}

/// What is measured and how, one fact a line.
pub fn method(plan: &Plan, scale: Scale) -> Vec<String> {
    let Plan { samples, sample_ns, stimulus, cycles, repeats } = plan;
    vec![
        format!("Every lane runs the same cycles from its initial values with the same inputs, on memory of its own. Inputs change in every cycle and repeat only after {stimulus} cycles, so that no processor knows from the last time how branches go; they are copied into the memory of the lane, as from a process image."),
        format!("Before anything is timed, all lanes run the first {cycles} cycles, and every output is compared after each of them, byte for byte."),
        format!("*Typical cycle*: batches of cycles, with copying the inputs, as many as take the fastest lane {:.0} us; {samples} batches a lane, a batch of one lane after the same batch of the other, so that what the machine does meanwhile hits all. A batch gives its mean cycle, the batches give the median. Lanes that are 8 times slower and more (interpreters) are timed in shorter pieces of the same batch, or every batch would be interrupted.", sample_ns / 1000.0),
        format!("*Slow cycles*: each of these first cycles on its own, {repeats} times from the start, {} cycles of one lane and then of the next; without copying the inputs, less the {} ticks ({:.1} ns) that reading the counter takes. Cycles near that time are uncertain by some nanoseconds. A lane finds caches that others have used at the start of its turn; where turns begin differs in each repeat.", measure::SLICE, scale.overhead, scale.overhead as f64 * scale.ns),
        "What is the program's own (*undisturbed*) is separated from what the machine did (interrupts, other processes, the hypervisor) by taking of each cycle the least of its repeats. The longest cycle seen is shown, too; on a machine that does other things it says little.".into(),
        "Two copies of the same code at other addresses show how far two equal programs are apart: differences below that mean nothing.".into(),
    ]
}
