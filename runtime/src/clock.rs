//! Time of the scan loop: virtual (exact, without waiting) or real (an absolute grid, so that nothing drifts).

use crate::release::{Grid, Policy};

/// Where cycles come from.
#[derive(Debug)]
pub enum Clock {
    /// Cycle n is at (n-1) * interval.
    Virtual {
        /// Nanoseconds.
        interval_ns: i64,
    },
    /// The same grid on CLOCK_MONOTONIC.
    Real {
        /// The releases.
        grid: Grid,
        /// When cycle 1 was released; known when it is waited for, unless several resources share it.
        start_ns: Option<i64>,
    },
}

/// The start of a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tick {
    /// The scan clock: the time of the release.
    pub now_ns: i64,
    /// Releases before this one that were skipped because their time passed while a cycle still ran.
    pub skipped: u64,
    /// The release itself is late: its time had passed, too.
    pub late: bool,
    /// When it woke up, CLOCK_MONOTONIC; 0 in virtual time.
    pub woken_ns: i64,
    /// When it should have, CLOCK_MONOTONIC; 0 in virtual time.
    pub release_ns: i64,
}

impl Tick {
    /// A punctual one, of virtual time.
    pub fn at(now_ns: i64) -> Self {
        Self { now_ns, skipped: 0, late: false, woken_ns: 0, release_ns: 0 }
    }
}

/// So often a long sleep looks whether it should stop: a signal may interrupt another thread than this one.
const LOOK_EVERY_NS: i64 = 200_000_000;

/// CLOCK_MONOTONIC in nanoseconds.
pub fn monotonic_ns() -> i64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `time` is valid for writing; the clock exists on every Linux and BSD.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &mut time) };
    time.tv_sec * 1_000_000_000 + time.tv_nsec
}

/// Sleeps until a time of CLOCK_MONOTONIC; a signal ends the sleep early.
fn sleep_until(ns: i64) {
    let time = libc::timespec { tv_sec: (ns / 1_000_000_000) as _, tv_nsec: (ns % 1_000_000_000) as _ };
    // SAFETY: `time` is a valid timespec, and no remainder is asked for.
    unsafe { libc::clock_nanosleep(libc::CLOCK_MONOTONIC, libc::TIMER_ABSTIME, &time, std::ptr::null_mut()) };
}

impl Clock {
    /// A clock that ticks every `interval_ns`.
    pub fn new(virtual_time: bool, interval_ns: i64, policy: Policy) -> Self {
        if virtual_time {
            Clock::Virtual { interval_ns }
        } else {
            Clock::Real { grid: Grid::new(interval_ns, policy), start_ns: None }
        }
    }

    /// A real one whose release 0 is at a time of CLOCK_MONOTONIC.
    pub fn on_grid(interval_ns: i64, policy: Policy, start_ns: i64) -> Self {
        Clock::Real { grid: Grid::new(interval_ns, policy), start_ns: Some(start_ns) }
    }

    /// The run has ended: how long it was, from the first release on, and how many releases have passed since the last
    /// cycle. `None` in virtual time.
    pub fn end(&self) -> Option<(i64, u64)> {
        match self {
            Clock::Real { grid, start_ns: Some(start_ns) } => {
                let elapsed = (monotonic_ns() - start_ns).max(0);
                Some((elapsed, grid.left_over(elapsed)))
            }
            _ => None,
        }
    }

    /// Waits for the release of a cycle (from 1). `stop` is asked after each wake-up; `None` then, and at the end of time.
    pub fn wait(&mut self, cycle: u64, mut stop: impl FnMut() -> bool) -> Option<Tick> {
        match self {
            Clock::Virtual { interval_ns } => Some(Tick::at(i64::try_from(cycle - 1).ok()?.checked_mul(*interval_ns)?)),
            Clock::Real { grid, start_ns } => {
                let mut now = monotonic_ns();
                let start = *start_ns.get_or_insert(now);
                let release = grid.next(now - start)?;
                let release_ns = start.checked_add(release.due_ns)?;
                while now < release_ns {
                    if stop() {
                        return None;
                    }
                    sleep_until(release_ns.min(now.saturating_add(LOOK_EVERY_NS)));
                    now = monotonic_ns();
                }
                let (skipped, late) = (release.skipped, release.late);
                Some(Tick { now_ns: release.due_ns, skipped, late, woken_ns: now, release_ns })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn virtual_time_is_exact() {
        let mut clock = Clock::new(true, 7, Policy::Asap);
        assert_eq!(clock.wait(1, || true), Some(Tick::at(0)));
        assert_eq!(clock.wait(4, || true), Some(Tick::at(21)));
        assert_eq!(clock.wait(u64::MAX, || true), None);
    }

    #[test]
    fn real_time_keeps_its_grid_and_tells_what_it_missed() {
        let ms = 1_000_000;
        let mut clock = Clock::new(false, 40 * ms, Policy::Asap);
        let first = clock.wait(1, || false).unwrap();
        assert_eq!((first.now_ns, first.skipped, first.late), (0, 0, false));
        std::thread::sleep(Duration::from_millis(90));
        let tick = clock.wait(2, || false).unwrap();
        // At least the releases at 40 and 80 ms have passed; a busy machine may add some.
        assert!(tick.skipped >= 1 && tick.late && tick.now_ns == 40 * ms * (tick.skipped as i64 + 1), "{tick:?}");
        assert!(tick.woken_ns > tick.release_ns);
        assert_eq!(clock.wait(3, || true), None);
    }
}
