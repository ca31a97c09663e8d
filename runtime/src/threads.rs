//! Several resources in real time: each on a thread of its own, on the same grid (semantics.md \[C3\]).
//!
//! What they share is behind one lock that inherits priorities, held only while values are copied: a resource waits for
//! another at most as long as that takes, never for its tasks.

use crate::clock::{Clock, monotonic_ns};
use crate::edges::Edges;
use crate::engine::Part;
use crate::realtime;
use crate::release::Policy;
use crate::retain::Writer;
use crate::scan::End;
use crate::signals;
use crate::worker::{Halt, Meeting, Worker};
use std::cell::UnsafeCell;
use std::sync::{Mutex, Once, PoisonError};

/// Threads have started by then.
const LEAD_IN_NS: i64 = 20_000_000;

/// A lock whose owner runs with the highest priority of those who wait for it: pthread's PTHREAD_PRIO_INHERIT, which
/// `std::sync::Mutex` does not have.
struct InheritingLock<T> {
    lock: Box<UnsafeCell<libc::pthread_mutex_t>>,
    value: UnsafeCell<T>,
}

// SAFETY: the value is touched only while the lock is held.
unsafe impl<T: Send> Sync for InheritingLock<T> {}

impl<T> InheritingLock<T> {
    fn new(value: T) -> Self {
        let lock = Box::new(UnsafeCell::new(libc::PTHREAD_MUTEX_INITIALIZER));
        // SAFETY: the lock has its final address (boxed), and both are initialised before use. Without the protocol it is a
        // plain lock, which is still right.
        unsafe {
            let mut attributes: libc::pthread_mutexattr_t = std::mem::zeroed();
            libc::pthread_mutexattr_init(&mut attributes);
            libc::pthread_mutexattr_setprotocol(&mut attributes, libc::PTHREAD_PRIO_INHERIT);
            libc::pthread_mutex_init(lock.get(), &attributes);
            libc::pthread_mutexattr_destroy(&mut attributes);
        }
        Self { lock, value: UnsafeCell::new(value) }
    }

    fn with<R>(&self, f: impl FnOnce(&mut T) -> R) -> R {
        struct Unlock<'l>(&'l UnsafeCell<libc::pthread_mutex_t>);
        impl Drop for Unlock<'_> {
            fn drop(&mut self) {
                // SAFETY: this thread holds it.
                unsafe { libc::pthread_mutex_unlock(self.0.get()) };
            }
        }
        // SAFETY: initialised in `new`; a thread never takes it twice, as `f` has no way to it.
        unsafe { libc::pthread_mutex_lock(self.lock.get()) };
        let _unlock = Unlock(&self.lock);
        // SAFETY: the lock is held.
        f(unsafe { &mut *self.value.get() })
    }
}

impl<T> Drop for InheritingLock<T> {
    fn drop(&mut self) {
        // SAFETY: nobody holds it: there is no reference left.
        unsafe { libc::pthread_mutex_destroy(self.lock.get()) };
    }
}

struct Shared<'a, 'm> {
    edges: Edges<'a>,
    home: Part<'m>,
}

impl<'m> Meeting<'m> for &InheritingLock<Shared<'_, 'm>> {
    fn meet<R>(&mut self, f: impl FnOnce(&mut Edges, Option<&mut Part<'m>>) -> R) -> R {
        self.with(|shared| f(&mut shared.edges, Some(&mut shared.home)))
    }
}

/// What a run with threads works on.
pub struct Threads<'a, 'm, 'r> {
    pub edges: Edges<'a>,
    pub home: Part<'m>,
    /// By resource, with its base tick and its part.
    pub workers: Vec<(Worker<'a>, i64, Part<'m>)>,
    pub policy: Policy,
    /// Stop when the scan clock gets here.
    pub until_ns: Option<i64>,
    pub realtime: Option<realtime::Request>,
    /// Of what resources share.
    pub retain: Option<Writer>,
    /// Tells the statistics of one resource, when somebody asked for them.
    pub report: &'r (dyn Fn(&Worker) + Sync),
}

/// Runs all resources to their ends; gives the workers back for the statistics.
pub fn run<'a>(threads: Threads<'a, '_, '_>) -> (End, Vec<Worker<'a>>) {
    let Threads { edges, home, workers, policy, until_ns, realtime, retain, report, .. } = threads;
    let shared = InheritingLock::new(Shared { edges, home });
    let retain = InheritingLock::new(retain);
    let halted: Mutex<Option<Halt>> = Mutex::new(None);
    let refused = Once::new();
    let start_ns = monotonic_ns() + LEAD_IN_NS;
    let workers = std::thread::scope(|scope| {
        let (shared, retain, halted, refused) = (&shared, &retain, &halted, &refused);
        let handles: Vec<_> = workers
            .into_iter()
            .map(|(mut worker, interval_ns, mut part)| {
                scope.spawn(move || {
                    realtime::precise_timers();
                    realtime::touch_stack();
                    if let Some(request) = &realtime
                        && let Err(e) = realtime::enter(request, 0, request.cpu.map(|c| c + worker.resource))
                    {
                        refused.call_once(|| eprintln!("--realtime: {e}; it runs with normal scheduling"));
                    }
                    let mut clock = Clock::on_grid(interval_ns, policy, start_ns);
                    let done = cycles(&mut worker, &mut part, shared, retain, &mut clock, until_ns, report);
                    if let Some((elapsed_ns, ticks)) = clock.end() {
                        worker.end(elapsed_ns, ticks);
                    }
                    if let Err(halt) = done {
                        halted.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(halt);
                        // All resources stop (semantics.md [E4]).
                        signals::request_stop();
                    }
                    worker
                })
            })
            .collect();
        let workers: Vec<Worker> = handles.into_iter().filter_map(|h| h.join().ok()).collect();
        workers
    });
    let end = match halted.into_inner().unwrap_or_else(PoisonError::into_inner) {
        None => End::Stopped,
        Some(Halt::Fault(told)) => End::Fault(told),
        Some(Halt::Driver(told)) => End::Failed(told),
    };
    (end, workers)
}

fn cycles<'m>(
    worker: &mut Worker,
    part: &mut Part<'m>,
    mut shared: &InheritingLock<Shared<'_, 'm>>,
    retain: &InheritingLock<Option<Writer>>,
    clock: &mut Clock,
    until_ns: Option<i64>,
    report: &(dyn Fn(&Worker) + Sync),
) -> Result<(), Halt> {
    let (mut cycle, mut reports) = (1u64, signals::reports_requested());
    loop {
        if signals::stop_requested() {
            return Ok(());
        }
        let tick = clock.wait(cycle, || {
            let asked = signals::reports_requested();
            if asked != std::mem::replace(&mut reports, asked) {
                report(worker);
            }
            signals::stop_requested()
        });
        let Some(tick) = tick else { return Ok(()) };
        if until_ns.is_some_and(|end| tick.now_ns >= end) {
            return Ok(());
        }
        if worker.resource == 0 {
            shared.meet(|edges, _| edges.begin(cycle));
        }
        worker.tick(cycle, tick, part, &mut shared)?;
        worker.finish_cycle(cycle, part);
        shared
            .meet(|edges, home| match home {
                Some(home) => {
                    retain.with(|r| r.iter_mut().for_each(|r| r.capture(home.start(), home.as_slice())));
                    if worker.resource == 0 { edges.end(part, Some(home)) } else { Ok(()) }
                }
                None => Ok(()),
            })
            .map_err(Halt::Driver)?;
        cycle += 1;
    }
}
