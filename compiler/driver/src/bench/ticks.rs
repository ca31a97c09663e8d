//! Time in ticks of the processor where it has a counter for them (x86-64), else in nanoseconds of the monotonic clock.

use std::time::{Duration, Instant};

/// Reads the counter behind everything that came before.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub fn now() -> u64 {
    use std::arch::x86_64::{_mm_lfence, _rdtsc};
    // SAFETY: both instructions belong to the base instruction set.
    unsafe {
        _mm_lfence();
        let ticks = _rdtsc();
        _mm_lfence();
        ticks
    }
}

/// Reads the clock.
#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
pub fn now() -> u64 {
    use std::sync::OnceLock;
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_nanos() as u64
}

/// What a tick is, and what reading the counter takes.
#[derive(Debug, Clone, Copy)]
pub struct Scale {
    /// Nanoseconds a tick.
    pub ns: f64,
    /// Ticks between two reads with nothing between them: the least seen.
    pub overhead: u64,
}

impl Scale {
    /// Compares the counter with the monotonic clock for 30 ms.
    pub fn calibrate() -> Self {
        let (start, first) = (Instant::now(), now());
        while start.elapsed() < Duration::from_millis(30) {
            std::hint::spin_loop();
        }
        let (passed, last) = (start.elapsed(), now());
        let ns = passed.as_nanos() as f64 / (last - first).max(1) as f64;
        let overhead = (0..1000).map(|_| 0u64.wrapping_sub(now()).wrapping_add(now())).min().unwrap_or(0);
        Self { ns, overhead }
    }

    /// Nanoseconds between two reads, less what reading takes.
    pub fn between(&self, first: u64, last: u64) -> f64 {
        last.saturating_sub(first).saturating_sub(self.overhead) as f64 * self.ns
    }
}
