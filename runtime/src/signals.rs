//! SIGINT and SIGTERM: stop after the cycle; a second one ends the process at once.

use std::sync::atomic::{AtomicBool, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);

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
        // A reader of the trace that goes away is an error of a write, not the end of the process.
        libc::signal(libc::SIGPIPE, libc::SIG_IGN);
    }
}

/// Whether somebody asked to stop.
pub fn stop_requested() -> bool {
    STOP.load(Ordering::Relaxed)
}
