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
        /// Releases that had passed before the cycle could start.
        overruns: u64,
        /// The release of the next cycle, counted from 0.
        next: u64,
    },
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
            Clock::Real { interval_ns, start_ns: monotonic_ns(), overruns: 0, next: 0 }
        }
    }

    /// Waits for the release of a cycle (from 1) and gives the scan clock. `stop` is asked after each wake-up; `None` then.
    pub fn wait(&mut self, cycle: u64, stop: impl Fn() -> bool) -> Option<i64> {
        match self {
            Clock::Virtual { interval_ns } => Some((cycle as i64 - 1).saturating_mul(*interval_ns)),
            Clock::Real { interval_ns, start_ns, overruns, next } => {
                let now = monotonic_ns();
                let due = *start_ns + (*next as i64).saturating_mul(*interval_ns);
                if now >= due + *interval_ns {
                    // Keep the grid: releases that have passed are counted and left out.
                    let missed = ((now - due) / *interval_ns) as u64;
                    *overruns += missed;
                    *next += missed;
                }
                let at = (*next as i64).saturating_mul(*interval_ns);
                while monotonic_ns() < *start_ns + at {
                    if stop() {
                        return None;
                    }
                    sleep_until(*start_ns + at);
                }
                *next += 1;
                Some(at)
            }
        }
    }

    /// Releases that were left out because a cycle took too long.
    pub fn overruns(&self) -> u64 {
        match self {
            Clock::Virtual { .. } => 0,
            Clock::Real { overruns, .. } => *overruns,
        }
    }
}
