//! The watchdog: a thread that sets the deadline flag of the region when one execution takes longer than its task may.
//!
//! The scan loop stores one atomic and swaps it back per execution; the thread looks at it every few milliseconds. The flag
//! is polled by compiled code at the back-edges of loops, so an endless loop becomes a fault inside it (semantics.md
//! \[E3\]).
//!
//! Who may set the flag is agreed by the state word, so that a late flag never hits the next execution: the thread claims
//! the running execution by exchanging its word for [`EXPIRED`], and [`Watchdog::stop`] sees the claim and waits for the
//! flag before it clears it.

use crate::clock::monotonic_ns;
use crate::image::Task;
use plcc_stdlib::region::DEADLINE_FLAG;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicU32, AtomicU64, Ordering};
use std::time::Duration;

/// The shortest and the longest time between two looks.
const LOOK_EVERY: (Duration, Duration) = (Duration::from_micros(500), Duration::from_millis(10));

/// No execution runs. Otherwise the state is `number << 16 | task + 1`, the number unlike those before.
const IDLE: u64 = 0;
/// The running execution took too long, and its flag is set or about to be.
const EXPIRED: u64 = u64::MAX;

#[derive(Debug)]
struct Shared {
    /// `IDLE`, `EXPIRED`, or the execution that runs.
    state: AtomicU64,
    /// By task; 0 or less is not watched.
    limits_ns: Vec<i64>,
    /// The flag in the region.
    flag: AtomicPtr<u32>,
    done: AtomicBool,
}

/// Guards executions on one region.
#[derive(Debug)]
pub struct Watchdog {
    shared: Arc<Shared>,
    /// Counts executions.
    number: u64,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Watchdog {
    /// Starts the thread, unless no task is watched. `ready` is called on it first.
    ///
    /// # Safety
    /// `region` must point to a region that lives longer than this value.
    pub unsafe fn new(region: *mut u8, tasks: &[Task], ready: impl FnOnce() + Send + 'static) -> std::io::Result<Self> {
        // SAFETY: the header lies inside every region.
        let flag = unsafe { region.add(DEADLINE_FLAG as usize) }.cast::<u32>();
        let limits_ns: Vec<i64> = tasks.iter().map(|t| t.watchdog_ns).collect();
        let shortest = limits_ns.iter().filter(|ns| **ns > 0).min().map(|ns| Duration::from_nanos(*ns as u64));
        let shared = Arc::new(Shared {
            state: AtomicU64::new(IDLE),
            limits_ns,
            flag: AtomicPtr::new(flag),
            done: AtomicBool::new(false),
        });
        let thread = match shortest {
            None => None,
            Some(limit) => {
                let own = Arc::clone(&shared);
                let look = (limit / 4).clamp(LOOK_EVERY.0, LOOK_EVERY.1);
                Some(std::thread::Builder::new().name("watchdog".into()).spawn(move || {
                    ready();
                    watch(&own, look);
                })?)
            }
        };
        Ok(Self { shared, number: 0, thread })
    }

    /// An execution of a task starts.
    pub fn start(&mut self, task: usize) {
        self.number += 1;
        self.shared.state.store(self.number << 16 | (task as u64 + 1) & 0xFFFF, Ordering::Relaxed);
    }

    /// It ended. Whether its deadline had passed.
    pub fn stop(&self) -> bool {
        let expired = self.shared.state.swap(IDLE, Ordering::Acquire) == EXPIRED;
        if expired {
            let flag = flag(&self.shared);
            while flag.swap(0, Ordering::Relaxed) == 0 {
                std::thread::yield_now();
            }
        }
        expired
    }
}

impl Drop for Watchdog {
    fn drop(&mut self) {
        self.shared.done.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            let _ = thread.join();
        }
    }
}

fn flag(shared: &Shared) -> &AtomicU32 {
    // SAFETY: `new` was promised that the region outlives the watchdog; the header is aligned to 64 bytes.
    unsafe { AtomicU32::from_ptr(shared.flag.load(Ordering::Relaxed)) }
}

fn watch(shared: &Shared, look: Duration) {
    let (mut seen, mut since) = (IDLE, 0);
    while !shared.done.load(Ordering::Relaxed) {
        let state = shared.state.load(Ordering::Relaxed);
        if state == IDLE || state == EXPIRED {
            seen = state;
        } else if state != seen {
            // The start is seen up to one look late, never early.
            (seen, since) = (state, monotonic_ns());
        } else {
            let limit = shared.limits_ns.get(((state & 0xFFFF) as usize).wrapping_sub(1)).copied().unwrap_or(0);
            let late = limit > 0 && monotonic_ns() - since >= limit;
            let claim = || shared.state.compare_exchange(state, EXPIRED, Ordering::Release, Ordering::Relaxed).is_ok();
            if late && claim() {
                flag(shared).store(1, Ordering::Relaxed);
            }
        }
        std::thread::park_timeout(look);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Region;
    use std::time::Instant;

    fn task(watchdog_ms: i64) -> Task {
        Task { watchdog_ns: watchdog_ms * 1_000_000, ..Task::default() }
    }

    /// Spins until the flag is set or a time is over; how long it took.
    fn spin(shared: &Shared, longest: Duration) -> Duration {
        let start = Instant::now();
        while flag(shared).load(Ordering::Relaxed) == 0 && start.elapsed() < longest {
            std::hint::spin_loop();
        }
        start.elapsed()
    }

    #[test]
    fn flags_a_long_execution_and_spares_the_next_one() {
        let mut mem = Region::new(64);
        // SAFETY: declared before the watchdog, dropped after it.
        let mut dog = unsafe { Watchdog::new(mem.as_mut_ptr(), &[task(0), task(20)], || ()) }.unwrap();
        dog.start(1);
        let took = spin(&dog.shared, Duration::from_secs(10));
        assert!(took >= Duration::from_millis(20) && took < Duration::from_secs(9), "{took:?}");
        assert!(dog.stop());
        dog.start(1);
        assert_eq!(flag(&dog.shared).load(Ordering::Relaxed), 0);
        assert!(!dog.stop());
    }

    #[test]
    fn a_task_without_a_watchdog_runs_as_long_as_it_likes() {
        let mut mem = Region::new(64);
        // SAFETY: as above.
        let mut dog = unsafe { Watchdog::new(mem.as_mut_ptr(), &[task(0), task(5)], || ()) }.unwrap();
        dog.start(0);
        assert!(spin(&dog.shared, Duration::from_millis(60)) >= Duration::from_millis(60));
        assert!(!dog.stop());
    }

    #[test]
    fn many_short_executions_together_are_not_late() {
        let mut mem = Region::new(64);
        // SAFETY: as above.
        let mut dog = unsafe { Watchdog::new(mem.as_mut_ptr(), &[task(2000)], || ()) }.unwrap();
        let start = Instant::now();
        while start.elapsed() < Duration::from_millis(60) {
            dog.start(0);
            assert!(!dog.stop());
        }
        assert_eq!(flag(&dog.shared).load(Ordering::Relaxed), 0);
    }
}
