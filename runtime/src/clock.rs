//! Time of the scan loop: virtual (exact, without waiting) or real (an absolute grid, so that nothing drifts).

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
        /// Nanoseconds.
        interval_ns: i64,
        /// When cycle 1 was released.
        start_ns: i64,
        /// The release of the next cycle, counted from 0.
        next: u64,
    },
}

/// The start of a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tick {
    /// The scan clock.
    pub now_ns: i64,
    /// Releases, this one included, whose time had come while the cycle before was still running; 0 for a punctual tick.
    pub late: u64,
}

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
    pub fn new(virtual_time: bool, interval_ns: i64) -> Self {
        if virtual_time {
            Clock::Virtual { interval_ns }
        } else {
            Clock::Real { interval_ns, start_ns: monotonic_ns(), next: 0 }
        }
    }

    /// Waits for the release of a cycle (from 1). `stop` is asked after each wake-up; `None` then, and at the end of time.
    pub fn wait(&mut self, cycle: u64, stop: impl Fn() -> bool) -> Option<Tick> {
        match self {
            Clock::Virtual { interval_ns } => {
                let now_ns = i64::try_from(cycle - 1).ok()?.checked_mul(*interval_ns)?;
                Some(Tick { now_ns, late: 0 })
            }
            Clock::Real { interval_ns, start_ns, next } => {
                let passed = monotonic_ns() - *start_ns;
                let mut at = i64::try_from(*next).ok()?.checked_mul(*interval_ns)?;
                let mut late = 0;
                if *next > 0 && passed >= at {
                    // Keep the grid: of the releases that have passed only the last is made up for.
                    let missed = (passed - at) / *interval_ns;
                    late = missed as u64 + 1;
                    *next += missed as u64;
                    at += missed * *interval_ns;
                }
                let due = start_ns.checked_add(at)?;
                while monotonic_ns() < due {
                    if stop() {
                        return None;
                    }
                    sleep_until(due);
                }
                *next += 1;
                Some(Tick { now_ns: at, late })
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
        let mut clock = Clock::new(true, 7);
        assert_eq!(clock.wait(1, || true), Some(Tick { now_ns: 0, late: 0 }));
        assert_eq!(clock.wait(4, || true), Some(Tick { now_ns: 21, late: 0 }));
        assert_eq!(clock.wait(u64::MAX, || true), None);
    }

    #[test]
    fn real_time_keeps_its_grid_and_tells_what_it_missed() {
        let ms = 1_000_000;
        let mut clock = Clock::new(false, 40 * ms);
        assert_eq!(clock.wait(1, || false), Some(Tick { now_ns: 0, late: 0 }));
        std::thread::sleep(Duration::from_millis(90));
        let tick = clock.wait(2, || false).unwrap();
        // At least the releases at 40 and 80 ms have passed; a busy machine may add some.
        assert!(tick.late >= 2 && tick.now_ns == 40 * ms * tick.late as i64, "{tick:?}");
        assert_eq!(clock.wait(3, || true), None);
    }
}
