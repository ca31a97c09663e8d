//! What the operating system can do for punctual cycles (`--realtime`): SCHED_FIFO, locked memory, a CPU of its own. What
//! is not permitted is said once, and the program runs with normal scheduling.

use std::io;

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Request {
    /// SCHED_FIFO priority of the cycle, 1 to 98; the watchdog gets one more, so that it can end a loop.
    pub priority: i32,
    /// The CPU for the first resource; each further one gets the next.
    pub cpu: Option<usize>,
}

/// `60`, `60,2`. 60 is the default: above the interrupt threads of the kernel, which have 50.
pub fn parse(text: &str) -> Result<Request, String> {
    let (priority, cpu) = match text.split_once(',') {
        Some((priority, cpu)) => (priority, Some(cpu)),
        None => (text, None),
    };
    let priority = priority.trim().parse().ok().filter(|p| (1..=98).contains(p));
    let priority = priority.ok_or_else(|| format!("`{text}`: a priority is 1 to 98"))?;
    let cpu = cpu.map(|c| c.trim().parse().map_err(|_| format!("`{text}`: a CPU is a number from 0")));
    Ok(Request { priority, cpu: cpu.transpose()? })
}

/// Memory stays in RAM. Once, when all that a cycle uses is there.
pub fn lock_memory() -> Result<(), String> {
    // SAFETY: `limit` is valid for writing; without the call it stays 0.
    let unlimited = unsafe {
        let mut limit: libc::rlimit = std::mem::zeroed();
        libc::getrlimit(libc::RLIMIT_MEMLOCK, &mut limit);
        limit.rlim_cur == libc::RLIM_INFINITY
    };
    // Pages are locked when they are touched: the large stacks of threads that never use them cost nothing. With a limit
    // memory that comes later is not locked, lest an allocation fail.
    let future = if unlimited { libc::MCL_FUTURE } else { 0 };
    // SAFETY: the call takes flags only.
    let done = unsafe { libc::mlockall(libc::MCL_CURRENT | libc::MCL_ONFAULT | future) };
    told(done, "lock its memory (mlockall; CAP_IPC_LOCK or LimitMEMLOCK=infinity)")
}

/// Gives the calling thread a priority and, if one is asked for, a CPU. All that failed, in words.
pub fn enter(request: &Request, offset: i32, cpu: Option<usize>) -> Result<(), String> {
    let param = libc::sched_param { sched_priority: (request.priority + offset).clamp(1, 99) };
    // SAFETY: `param` is valid for the call; 0 is this thread.
    let fifo = unsafe { libc::sched_setscheduler(0, libc::SCHED_FIFO, &param) };
    let fifo = told(fifo, "run with SCHED_FIFO (CAP_SYS_NICE or LimitRTPRIO=99)");
    let pinned = match cpu {
        None => Ok(()),
        Some(cpu) if cpu < libc::CPU_SETSIZE as usize => {
            // SAFETY: a zeroed set is an empty one, `cpu` is inside it, and 0 is this thread.
            let done = unsafe {
                let mut set: libc::cpu_set_t = std::mem::zeroed();
                libc::CPU_SET(cpu, &mut set);
                libc::sched_setaffinity(0, size_of::<libc::cpu_set_t>(), &set)
            };
            told(done, &format!("run on CPU {cpu}"))
        }
        Some(cpu) => Err(format!("run on CPU {cpu}: there is none")),
    };
    match (fifo, pinned) {
        (Ok(()), Ok(())) => Ok(()),
        (Err(a), Err(b)) => Err(format!("{a}; {b}")),
        (Err(e), _) | (_, Err(e)) => Err(e),
    }
}

/// Without SCHED_FIFO the kernel may be up to 50 us late on purpose; this thread does not want that.
pub fn precise_timers() {
    // SAFETY: sets a number of the calling thread.
    unsafe { libc::prctl(libc::PR_SET_TIMERSLACK, 1) };
}

/// Page faults of the calling thread so far.
pub fn page_faults() -> u64 {
    // SAFETY: `usage` is valid for writing; without the call it stays 0.
    let usage = unsafe {
        let mut usage: libc::rusage = std::mem::zeroed();
        libc::getrusage(libc::RUSAGE_THREAD, &mut usage);
        usage
    };
    (usage.ru_minflt + usage.ru_majflt) as u64
}

/// Touches the pages of the stack that a cycle may use, so that none faults later.
#[inline(never)]
pub fn touch_stack() {
    let mut pages = [0u8; 128 * 1024];
    for at in (0..pages.len()).step_by(4096) {
        // SAFETY: inside the array; volatile so that it is really written.
        unsafe { std::ptr::write_volatile(&mut pages[at], 1) };
    }
}

fn told(done: libc::c_int, what: &str) -> Result<(), String> {
    if done == 0 { Ok(()) } else { Err(format!("it may not {what}: {}", io::Error::last_os_error())) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests() {
        assert_eq!(parse("60"), Ok(Request { priority: 60, cpu: None }));
        assert_eq!(parse("1,3"), Ok(Request { priority: 1, cpu: Some(3) }));
        assert!(parse("99").is_err());
        assert!(parse("0").is_err());
        assert!(parse("5,x").is_err());
    }
}
