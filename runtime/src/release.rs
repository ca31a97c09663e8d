//! When a periodic execution is released: an absolute grid in whole nanoseconds, and what becomes of releases whose time
//! passes while an execution still runs. Pure arithmetic: it knows no clock, so that any delay can be tried.

/// What follows an execution that ran past its next release (`--overrun`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Policy {
    /// The last release that passed is executed at once, late; those before it are skipped.
    #[default]
    Asap,
    /// All releases that passed are skipped; the next execution is punctual again.
    Skip,
}

/// A release that is to be executed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Release {
    /// Its number, from 0.
    pub number: u64,
    /// Its time, counted from release 0: `number * interval`, exactly.
    pub due_ns: i64,
    /// Releases between the last execution and this one that are not executed.
    pub skipped: u64,
    /// Its time has passed already: it is executed at once instead of punctually.
    pub late: bool,
}

/// The grid.
#[derive(Debug, Clone)]
pub struct Grid {
    interval_ns: i64,
    policy: Policy,
    next: u64,
}

impl Grid {
    /// Release n is at n * `interval_ns` (more than 0).
    pub fn new(interval_ns: i64, policy: Policy) -> Self {
        Self { interval_ns: interval_ns.max(1), policy, next: 0 }
    }

    /// The release to execute, when the last execution ended `passed_ns` after release 0. `None` at the end of time.
    ///
    /// A release whose time is exactly `passed_ns` is punctual. The grid never moves: every release is either executed or
    /// counted in [`Release::skipped`] of a later one.
    pub fn next(&mut self, passed_ns: i64) -> Option<Release> {
        let due_ns = i64::try_from(self.next).ok()?.checked_mul(self.interval_ns)?;
        let behind_ns = passed_ns.saturating_sub(due_ns);
        let (skipped, late) = match self.policy {
            _ if behind_ns <= 0 => (0, false),
            Policy::Asap => (behind_ns / self.interval_ns, behind_ns % self.interval_ns != 0),
            Policy::Skip => (behind_ns / self.interval_ns + i64::from(behind_ns % self.interval_ns != 0), false),
        };
        let number = self.next.checked_add(skipped as u64)?;
        let due_ns = due_ns.checked_add(skipped.checked_mul(self.interval_ns)?)?;
        self.next = number.checked_add(1)?;
        Some(Release { number, due_ns, skipped: skipped as u64, late })
    }

    /// The run ends `passed_ns` after release 0: how many releases have passed that were neither executed nor counted.
    pub fn left_over(&self, passed_ns: i64) -> u64 {
        let passed = u64::try_from(passed_ns / self.interval_ns).map_or(0, |n| n + 1);
        passed.saturating_sub(self.next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the policies mean, release by release: `ends` of the executions, to the numbers executed.
    fn model(interval: i64, policy: Policy, durations: &[i64]) -> (Vec<(u64, i64)>, u64) {
        let (mut executed, mut skipped, mut now, mut number) = (Vec::new(), 0u64, 0i64, 0i64);
        for duration in durations {
            match policy {
                Policy::Asap => {
                    while (number + 1) * interval <= now {
                        skipped += 1;
                        number += 1;
                    }
                }
                Policy::Skip => {
                    while number * interval < now {
                        skipped += 1;
                        number += 1;
                    }
                }
            }
            let start = now.max(number * interval);
            executed.push((number as u64, start));
            number += 1;
            now = start + duration;
        }
        (executed, skipped)
    }

    /// 100,000 executions on a simulated clock, most short, some delayed by up to 40 intervals, many ending exactly on the
    /// grid: the numbers, the starts, and executed + skipped = elapsed / interval to the unit.
    #[test]
    fn a_simulated_clock_with_injected_delays_matches_the_model() {
        const RUNS: usize = 100_000;
        for policy in [Policy::Asap, Policy::Skip] {
            for interval in [1i64, 7, 1_000_003, 10_000_000] {
                let mut random = Random(0x2545_F491_4F6C_DD1D ^ interval as u64);
                let durations: Vec<i64> = (0..RUNS)
                    .map(|_| match random.below(10) {
                        0 => random.below(40 * interval as u64) as i64,
                        1 => random.below(12) as i64 * interval,
                        2 => interval + 1,
                        3 => interval - 1,
                        _ => random.below(interval as u64) as i64,
                    })
                    .collect();
                let (expected, expected_skipped) = model(interval, policy, &durations);
                let mut grid = Grid::new(interval, policy);
                let (mut now, mut skipped) = (0i64, 0u64);
                for (n, duration) in durations.iter().enumerate() {
                    let release = grid.next(now).expect("time has not ended");
                    let start = now.max(release.due_ns);
                    assert_eq!((release.number, start), expected[n], "{policy:?} {interval} {n}");
                    assert_eq!(release.due_ns, release.number as i64 * interval);
                    assert_eq!(release.late, start > release.due_ns);
                    skipped += release.skipped;
                    now = start + duration;
                    // Releases 0 up to this one are accounted for, each once.
                    assert_eq!(n as u64 + 1 + skipped, release.number + 1);
                }
                assert_eq!(skipped, expected_skipped);
                // With what has passed at the end, executed and skipped make up all releases.
                assert_eq!(RUNS as u64 + skipped + grid.left_over(now), (now / interval) as u64 + 1);
            }
        }
    }

    #[test]
    fn the_end_of_time_is_no_overflow() {
        let mut grid = Grid::new(i64::MAX / 2, Policy::Asap);
        assert_eq!(grid.next(0).map(|r| r.due_ns), Some(0));
        assert_eq!(grid.next(i64::MAX).map(|r| r.number), Some(2));
        assert_eq!(grid.next(i64::MAX), None);
    }

    /// xorshift64*, so that a failure can be repeated.
    struct Random(u64);

    impl Random {
        fn below(&mut self, limit: u64) -> u64 {
            self.0 ^= self.0 >> 12;
            self.0 ^= self.0 << 25;
            self.0 ^= self.0 >> 27;
            self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) % limit.max(1)
        }
    }
}
