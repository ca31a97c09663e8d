//! The watchdog: a thread that sets the deadline flag of the region when one execution takes longer than its task may.
//!
//! The scan loop only stores two atomics per execution; the thread looks at them every few milliseconds. The flag is polled
//! by compiled code at the back-edges of loops, so an endless loop becomes a fault inside it (semantics.md \[E3\]).

use crate::clock::monotonic_ns;
use plcc_stdlib::region::DEADLINE_FLAG;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicPtr, AtomicU32, AtomicU64, Ordering};
use std::time::Duration;

/// How often the thread looks.
const LOOK_EVERY: Duration = Duration::from_millis(5);

#[derive(Debug)]
struct Shared {
    /// Counts executions: odd while one runs.
    sequence: AtomicU64,
    /// Longest execution of the running task.
    limit_ns: AtomicI64,
    /// The flag in the region.
    flag: AtomicPtr<u32>,
    done: AtomicBool,
}

/// Guards executions on one region.
#[derive(Debug)]
pub struct Watchdog {
    shared: Arc<Shared>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Watchdog {
    /// Starts the thread.
    ///
    /// # Safety
    /// `region` must point to a region that lives longer than this value.
    pub unsafe fn new(region: *mut u8) -> std::io::Result<Self> {
        // SAFETY: the header lies inside every region.
        let flag = unsafe { region.add(DEADLINE_FLAG as usize) }.cast::<u32>();
        let shared = Arc::new(Shared {
            sequence: AtomicU64::new(0),
            limit_ns: AtomicI64::new(i64::MAX),
            flag: AtomicPtr::new(flag),
            done: AtomicBool::new(false),
        });
        let own = Arc::clone(&shared);
        let thread = std::thread::Builder::new().name("watchdog".into()).spawn(move || watch(&own))?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// An execution starts.
    pub fn start(&self, limit_ns: i64) {
        self.shared.limit_ns.store(limit_ns, Ordering::Relaxed);
        self.shared.sequence.fetch_add(1, Ordering::Release);
    }

    /// It ended: a flag that came too late does not hit the next one.
    pub fn stop(&self) {
        self.shared.sequence.fetch_add(1, Ordering::Release);
        flag(&self.shared).store(0, Ordering::Relaxed);
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

fn watch(shared: &Shared) {
    let (mut seen, mut since) = (0, 0);
    while !shared.done.load(Ordering::Relaxed) {
        let sequence = shared.sequence.load(Ordering::Acquire);
        if sequence != seen {
            // The start is seen up to one look late, never early.
            (seen, since) = (sequence, monotonic_ns());
        } else if sequence % 2 == 1 && monotonic_ns() - since >= shared.limit_ns.load(Ordering::Relaxed) {
            flag(shared).store(1, Ordering::Relaxed);
            // The execution may have ended meanwhile: then the flag would hit an innocent one.
            if shared.sequence.load(Ordering::Acquire) != sequence {
                flag(shared).store(0, Ordering::Relaxed);
            }
        }
        std::thread::park_timeout(LOOK_EVERY);
    }
}
