//! SIGINT and SIGTERM: stop after the cycle; a second one ends the process at once. SIGUSR1 asks for the statistics.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);

/// How often somebody asked for the statistics.
static REPORTS: AtomicU32 = AtomicU32::new(0);

extern "C" fn on_report(_: libc::c_int) {
    REPORTS.fetch_add(1, Ordering::Relaxed);
}

extern "C" fn on_signal(signal: libc::c_int) {
    if STOP.swap(true, Ordering::Relaxed) {
        // SAFETY: both calls are async-signal-safe.
        unsafe {
            libc::signal(signal, libc::SIG_DFL);
            libc::raise(signal);
        }
    }
}

/// Catches the signals.
pub fn install() {
    // SAFETY: the handler only touches an atomic. Without SA_RESTART a sleeping scan loop wakes up.
    unsafe {
        let mut action: libc::sigaction = std::mem::zeroed();
        let handler: extern "C" fn(libc::c_int) = on_signal;
        action.sa_sigaction = handler as *const () as usize;
        libc::sigemptyset(&mut action.sa_mask);
        for signal in [libc::SIGINT, libc::SIGTERM] {
            libc::sigaction(signal, &action, std::ptr::null_mut());
        }
        let handler: extern "C" fn(libc::c_int) = on_report;
        action.sa_sigaction = handler as *const () as usize;
        libc::sigaction(libc::SIGUSR1, &action, std::ptr::null_mut());
        // A reader of the trace that goes away is an error of a write, not the end of the process.
        libc::signal(libc::SIGPIPE, libc::SIG_IGN);
    }
}

/// Whether somebody asked to stop.
pub fn stop_requested() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// Ends the run as a signal would.
pub fn request_stop() {
    STOP.store(true, Ordering::Relaxed);
}

/// Rises with every request for the statistics.
pub fn reports_requested() -> u32 {
    REPORTS.load(Ordering::Relaxed)
}
