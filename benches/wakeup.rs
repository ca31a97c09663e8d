//! How punctual a cycle is: the wake-up latency of a linked program beside a bare C loop around clock_nanosleep, in
//! alternating slices of one run, and what a cycle of an empty program costs.
//!
//! The C loop runs twice in each round. Where its two copies differ more than the bounds, the machine is too noisy to tell
//! anything, and the report says so.
//!
//! `cargo bench -p plcc-benches --bench wakeup [-- --rounds 20 --cycles 1000]`; with --realtime the program and the C loop
//! both run with SCHED_FIFO. Under `cargo test` it runs a few cycles, to see that it works.

use plcc_benches::command::{Done, run};
use std::collections::BTreeMap;
use std::path::Path;

/// A cycle of the loop that all are measured against.
const INTERVAL_NS: u64 = 1_000_000;
/// Bounds of the ratios of p50 and p99.
const BOUNDS: [f64; 2] = [1.15, 1.6];

const LOOP: &str = r#"
#define _GNU_SOURCE
#include <sched.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <time.h>

static int64_t latency[1 << 20];

int main(int argc, char **argv) {
    long cycles = atol(argv[1]), interval = atol(argv[2]);
    struct sched_param param = { .sched_priority = 60 };
    if (argc > 3) {
        mlockall(MCL_CURRENT | MCL_FUTURE);
        sched_setscheduler(0, SCHED_FIFO, &param);
    }
    prctl(PR_SET_TIMERSLACK, 1);
    struct timespec next, now;
    clock_gettime(CLOCK_MONOTONIC, &next);
    for (long n = 0; n < cycles && n < 1 << 20; n++) {
        while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, NULL)) {}
        clock_gettime(CLOCK_MONOTONIC, &now);
        latency[n] = (now.tv_sec - next.tv_sec) * 1000000000LL + now.tv_nsec - next.tv_nsec;
        /* The grid stays; releases that have passed are skipped, as the program does. */
        do {
            next.tv_nsec += interval;
            while (next.tv_nsec >= 1000000000L) { next.tv_nsec -= 1000000000L; next.tv_sec++; }
        } while (now.tv_sec > next.tv_sec || (now.tv_sec == next.tv_sec && now.tv_nsec > next.tv_nsec));
    }
    for (long n = 0; n < cycles && n < 1 << 20; n++) printf("%lld\n", (long long)latency[n]);
    return 0;
}
"#;

const EMPTY: &str = "PROGRAM Main\nEND_PROGRAM\n";

/// Latencies and how often each.
type Counts = BTreeMap<u64, u64>;

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let number = |name: &str| {
        let at = args.iter().position(|a| a == name)?;
        args.get(at + 1)?.parse::<u64>().ok()
    };
    let quick = !args.iter().any(|a| a == "--bench");
    let rounds = number("--rounds").unwrap_or(if quick { 1 } else { 20 });
    let cycles = number("--cycles").unwrap_or(if quick { 30 } else { 1000 });
    let realtime = args.iter().any(|a| a == "--realtime");
    let folder = tempfile::tempdir().expect("a folder");
    if let Err(e) = prepare(folder.path()) {
        println!("wakeup: {e}");
        return;
    }
    latencies(folder.path(), rounds, cycles, realtime);
    if !quick {
        cost(folder.path());
    }
}

fn prepare(folder: &Path) -> Result<(), String> {
    std::fs::write(folder.join("loop.c"), LOOP).map_err(|e| e.to_string())?;
    let built = run("cc", folder, &["-O2", "loop.c", "-o", "loop"]);
    if built.code != 0 {
        return Err(format!("no C compiler: {}", built.stderr));
    }
    plcc_benches::command::build(EMPTY, &folder.join("empty"))
}

fn latencies(folder: &Path, rounds: u64, cycles: u64, realtime: bool) {
    let (cycles_text, interval) = (cycles.to_string(), INTERVAL_NS.to_string());
    let reference = || {
        let mut args = vec![cycles_text.as_str(), &interval];
        args.extend(realtime.then_some("realtime"));
        let done = run("./loop", folder, &args);
        done.stdout.lines().filter_map(|l| l.parse::<u64>().ok()).collect::<Vec<_>>()
    };
    let ours = || {
        let mut args = vec!["--cycles", &cycles_text, "--interval", "1ms", "--overrun", "skip", "--stats", "json"];
        args.extend(realtime.then_some("--realtime"));
        let done: Done = run("./empty", folder, &args);
        assert_eq!(done.code, 0, "{}", done.stderr);
        histogram(&done.stdout)
    };
    let (mut first, mut second, mut program) = (Counts::new(), Counts::new(), Counts::new());
    for round in 0..rounds {
        let into = |to: &mut Counts| reference().into_iter().for_each(|ns| *to.entry(ns).or_default() += 1);
        // The order turns, so that none is always behind the same one.
        match round % 3 {
            0 => {
                into(&mut first);
                add(&mut program, ours());
                into(&mut second);
            }
            1 => {
                into(&mut second);
                into(&mut first);
                add(&mut program, ours());
            }
            _ => {
                add(&mut program, ours());
                into(&mut second);
                into(&mut first);
            }
        }
    }
    println!(
        "wake-up latency [ns], {rounds} rounds of {cycles} cycles of 1 ms{}",
        if realtime { ", SCHED_FIFO" } else { "" }
    );
    println!("{:<14}{:>10}{:>10}{:>10}{:>10}{:>10}", "", "p50", "p90", "p99", "p99.9", "max");
    for (name, counts) in [("C loop", &first), ("C loop again", &second), ("plcc", &program)] {
        print!("{name:<14}");
        for q in [0.5, 0.9, 0.99, 0.999, 1.0] {
            print!("{:>10}", quantile(counts, q));
        }
        println!();
    }
    let ratio = |a: &Counts, b: &Counts, q| quantile(a, q) as f64 / quantile(b, q).max(1) as f64;
    let noise = [0.5, 0.99].map(|q| ratio(&first, &second, q).max(ratio(&second, &first, q)));
    let mut both = first;
    add(&mut both, second.into_iter().collect());
    let found = [0.5, 0.99].map(|q| ratio(&program, &both, q));
    for (n, name) in ["p50", "p99"].iter().enumerate() {
        let bound = BOUNDS[n];
        let verdict = match (noise[n] > bound, found[n] <= bound) {
            (true, _) => "too noisy to tell",
            (false, true) => "within the bound",
            (false, false) => "NOT within the bound",
        };
        println!("{name}: plcc / C {:.2}, bound {bound}, C / C {:.2}: {verdict}", found[n], noise[n]);
    }
}

fn histogram(json: &str) -> Vec<(u64, u64)> {
    let value: serde_json::Value = serde_json::from_str(json).expect("--stats json");
    let pairs = value["tasks"][0]["wake_up"]["histogram"].as_array().expect("a histogram");
    pairs.iter().filter_map(|p| Some((p[0].as_u64()?, p[1].as_u64()?))).collect()
}

fn add(to: &mut Counts, pairs: Vec<(u64, u64)>) {
    pairs.into_iter().for_each(|(ns, count)| *to.entry(ns).or_default() += count);
}

fn quantile(counts: &Counts, q: f64) -> u64 {
    let total: u64 = counts.values().sum();
    let wanted = ((total as f64 * q).ceil() as u64).max(1);
    let mut seen = 0;
    for (ns, count) in counts {
        seen += count;
        if seen >= wanted {
            return *ns;
        }
    }
    0
}

/// Instructions, allocations and page faults of a cycle of the empty program, as differences between runs of different length.
fn cost(folder: &Path) {
    let few = 1_000;
    for (name, flags) in [
        ("real time", vec!["--interval", "100us"]),
        ("virtual time", vec!["--virtual-time"]),
        ("real time, --stats", vec!["--interval", "100us", "--stats"]),
    ] {
        let measure = |tool: &str, cycles: u64, word: &str| {
            let text = cycles.to_string();
            let file = "--callgrind-out-file=/dev/null";
            let mut args = vec![tool];
            args.extend((tool == "--tool=callgrind").then_some(file));
            args.extend(["./empty", "--cycles", &text]);
            args.extend(&flags);
            let done = run("valgrind", folder, &args);
            let line = done.stderr.lines().find(|l| l.contains(word))?.to_string();
            let number = line[line.find(word)? + word.len()..]
                .trim_start_matches([' ', ':'])
                .split([' ', '\n'])
                .next()?
                .replace(',', "");
            number.parse::<u64>().ok()
        };
        let per = |tool, word| {
            let (a, b) = (measure(tool, few, word)?, measure(tool, 11 * few, word)?);
            Some((b as f64 - a as f64) / (10 * few) as f64)
        };
        let instructions = per("--tool=callgrind", "Collected");
        let allocations = per("--tool=memcheck", "total heap usage");
        let shown = |n: Option<f64>| n.map_or("not measured (valgrind)".into(), |n| format!("{n:.3}"));
        println!(
            "empty program, {name}: {} instructions, {} allocations a cycle",
            shown(instructions),
            shown(allocations)
        );
    }
    let done = run("./empty", folder, &["--cycles", "20000", "--interval", "100us", "--stats", "json"]);
    let value: serde_json::Value = serde_json::from_str(&done.stdout).expect("--stats json");
    println!("empty program, 20,000 cycles: {} page faults behind the 16th", value["page_faults"]);
}
