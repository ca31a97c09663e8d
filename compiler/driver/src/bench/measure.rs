//! Measures lanes interleaved in one run: batches of cycles for the typical cycle, single cycles for the worst.
//!
//! All lanes run the same cycles with the same inputs, a slice of one after the same slice of the other, so that what the
//! machine does meanwhile hits all of them.

use crate::bench::lane::Lane;
use crate::bench::stats::Sorted;
use crate::bench::ticks::{self, Scale};

/// How much is measured.
#[derive(Debug, Clone, Copy)]
pub struct Plan {
    /// Batches a lane.
    pub samples: usize,
    /// How long a batch of the fastest lane takes, nanoseconds.
    pub sample_ns: f64,
    /// Cycles from the start on until the inputs repeat; batches stay within them. A processor remembers how branches went:
    /// in a plant no thousand cycles come twice.
    pub stimulus: u64,
    /// The first of them, which are timed each on its own.
    pub cycles: u64,
    /// How often each of them is timed on its own.
    pub repeats: usize,
}

impl Plan {
    /// For a report.
    pub const FULL: Plan = Plan { samples: 300, sample_ns: 30_000.0, stimulus: 40_000, cycles: 1000, repeats: 25 };
    /// For a first look.
    pub const QUICK: Plan = Plan { samples: 100, sample_ns: 20_000.0, stimulus: 20_000, cycles: 500, repeats: 6 };
    /// To see that everything runs.
    pub const SMOKE: Plan = Plan { samples: 2, sample_ns: 1_000.0, stimulus: 40, cycles: 40, repeats: 1 };
}

/// Times of a lane, nanoseconds.
#[derive(Debug, Clone, Default)]
pub struct Times {
    /// Mean cycle of each batch.
    pub batches: Sorted,
    /// Every cycle that was timed alone.
    pub singles: Sorted,
    /// Of each cycle the least of its repeats: what it takes when nothing disturbs it.
    pub floors: Sorted,
}

/// What was measured, and with which batches.
#[derive(Debug)]
pub struct Measured {
    /// By lane.
    pub times: Vec<Times>,
    /// Cycles a batch.
    pub batch: u64,
}

/// A lane that faulted: its name, the fault's number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Faulted(pub &'static str, pub u32);

/// Cycles of one lane before the next lane has its turn.
pub const SLICE: u64 = 100;
/// Batches that only warm up.
const WARM_UP: usize = 3;

/// Measures them.
pub fn measure(lanes: &mut [Lane], plan: &Plan, scale: Scale) -> Result<Measured, Faulted> {
    let cycle_ns = probe(lanes, plan, scale)?;
    let fastest = cycle_ns.iter().copied().fold(f64::INFINITY, f64::min);
    let batch = ((plan.sample_ns / fastest.max(0.1)) as u64).clamp(1, plan.cycles);
    let pieces: Vec<u64> = cycle_ns.iter().map(|ns| piece(batch, *ns / fastest)).collect();
    let batches = batches(lanes, plan, scale, batch, &pieces)?;
    let singles = singles(lanes, plan, scale)?;
    let times = batches.into_iter().zip(singles).map(|(batches, runs)| {
        let floors = (0..plan.cycles as usize)
            .map(|cycle| runs.iter().map(|run| run[cycle]).fold(f64::INFINITY, f64::min))
            .collect();
        Times {
            batches: Sorted::new(batches),
            singles: Sorted::new(runs.into_iter().flatten().collect()),
            floors: Sorted::new(floors),
        }
    });
    Ok(Measured { times: times.collect(), batch })
}

fn run(lane: &mut Lane, first: u64, count: u64) -> Result<(), Faulted> {
    match lane.subject.run(first, count) {
        0 => Ok(()),
        number => Err(Faulted(lane.name, number)),
    }
}

/// About what a cycle of each lane takes.
fn probe(lanes: &mut [Lane], plan: &Plan, scale: Scale) -> Result<Vec<f64>, Faulted> {
    let cycles = plan.cycles.min(64);
    let mut times = Vec::with_capacity(lanes.len());
    for lane in lanes {
        let mut fastest = f64::INFINITY;
        for _ in 0..3 {
            lane.subject.restart();
            let start = ticks::now();
            run(lane, 0, cycles)?;
            fastest = fastest.min(scale.between(start, ticks::now()) / cycles as f64);
        }
        times.push(fastest);
    }
    Ok(times)
}

/// Cycles that are timed together in a lane that is so many times slower than the fastest. A batch of the interpreter would
/// take so long that the machine interrupts every one of them; native lanes are timed alike.
fn piece(batch: u64, slower: f64) -> u64 {
    if slower < 8.0 { batch } else { ((batch as f64 / slower) as u64).max(1) }
}

/// By lane, the mean cycle of each piece.
fn batches(
    lanes: &mut [Lane],
    plan: &Plan,
    scale: Scale,
    batch: u64,
    pieces: &[u64],
) -> Result<Vec<Vec<f64>>, Faulted> {
    let mut times: Vec<Vec<f64>> = lanes.iter().map(|_| Vec::with_capacity(plan.samples)).collect();
    lanes.iter_mut().for_each(|lane| lane.subject.restart());
    let mut first = 0;
    for round in 0..plan.samples + WARM_UP {
        if first + batch > plan.stimulus {
            lanes.iter_mut().for_each(|lane| lane.subject.restart());
            first = 0;
        }
        for ((lane, piece), times) in lanes.iter_mut().zip(pieces).zip(&mut times) {
            let mut at = first;
            while at < first + batch {
                let count = (*piece).min(first + batch - at);
                let start = ticks::now();
                run(lane, at, count)?;
                let ns = scale.between(start, ticks::now());
                if round >= WARM_UP {
                    times.push(ns / count as f64);
                }
                at += count;
            }
        }
        first += batch;
    }
    Ok(times)
}

/// By lane and repeat, every cycle.
fn singles(lanes: &mut [Lane], plan: &Plan, scale: Scale) -> Result<Vec<Vec<Vec<f64>>>, Faulted> {
    let mut times: Vec<Vec<Vec<f64>>> = lanes.iter().map(|_| Vec::with_capacity(plan.repeats)).collect();
    for repeat in 0..plan.repeats as u64 {
        lanes.iter_mut().for_each(|lane| lane.subject.restart());
        times.iter_mut().for_each(|runs| runs.push(Vec::with_capacity(plan.cycles as usize)));
        // The first cycle of a slice finds cold caches: not the same one in each repeat.
        let mut end = 1 + repeat * 37 % SLICE;
        let mut first = 0;
        while first < plan.cycles {
            end = end.min(plan.cycles);
            for (lane, runs) in lanes.iter_mut().zip(&mut times) {
                if let Some(run) = runs.last_mut() {
                    slice(lane, first, end, scale, run)?;
                }
            }
            first = end;
            end += SLICE;
        }
    }
    Ok(times)
}

fn slice(lane: &mut Lane, first: u64, end: u64, scale: Scale, times: &mut Vec<f64>) -> Result<(), Faulted> {
    for cycle in first..end {
        lane.subject.feed(cycle);
        let start = ticks::now();
        let status = lane.subject.execute(cycle);
        times.push(scale.between(start, ticks::now()));
        if status != 0 {
            return Err(Faulted(lane.name, status));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::lane::Cycle;
    use plcc_runtime::engine::Region;
    use std::cell::RefCell;
    use std::rc::Rc;

    /// Records what it was asked.
    struct Recorder {
        region: Region,
        next: Rc<RefCell<Vec<u64>>>,
        fault_at: u64,
    }

    impl Cycle for Recorder {
        fn restart(&mut self) {
            self.next.borrow_mut().push(0);
        }
        fn feed(&mut self, cycle: u64) {
            let mut next = self.next.borrow_mut();
            let last = next.last_mut().unwrap();
            assert_eq!(*last, cycle, "cycles come in order");
            *last += 1;
        }
        fn execute(&mut self, cycle: u64) -> u32 {
            if cycle == self.fault_at { 7 } else { 0 }
        }
        fn memory(&self) -> &Region {
            &self.region
        }
    }

    fn lane(fault_at: u64) -> (Lane<'static>, Rc<RefCell<Vec<u64>>>) {
        let next = Rc::default();
        let subject = Recorder { region: Region::new(64), next: Rc::clone(&next), fault_at };
        (Lane { name: "x", subject: Box::new(subject) }, next)
    }

    #[test]
    fn every_lane_sees_the_same_cycles_in_order_and_within_the_plan() {
        let plan = Plan { samples: 9, sample_ns: 1e9, stimulus: 250, cycles: 250, repeats: 3 };
        let scale = Scale { ns: 1.0, overhead: 0 };
        let ((a, seen_a), (b, seen_b)) = (lane(u64::MAX), lane(u64::MAX));
        let measured = measure(&mut [a, b], &plan, scale).unwrap();
        assert_eq!(measured.batch, 250);
        assert_eq!(*seen_a.borrow(), *seen_b.borrow());
        assert!(seen_a.borrow().iter().all(|n| *n <= 250));
        let restarts_with_all = seen_a.borrow().iter().filter(|n| **n == 250).count();
        assert_eq!(restarts_with_all, 9 + WARM_UP + 3);
        assert_eq!(measured.times.len(), 2);
    }

    #[test]
    fn a_fault_ends_it_with_the_lane_and_its_number() {
        let (a, _) = lane(30);
        assert_eq!(measure(&mut [a], &Plan::SMOKE, Scale { ns: 1.0, overhead: 0 }).unwrap_err(), Faulted("x", 7));
    }
}
