//! `--emit obj,header`: one object without foreign symbols and a header, driven by a C program (docs/cli.md, "Embedding").

use plcc_tests::{command, project_root};
use std::path::Path;

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");

const HOST: &str = r#"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "tank.h"

int main(void) {
    void *mem = aligned_alloc(64, (plc_app_size() + 63) / 64 * 64);
    const struct plc_var *step = plc_app_var("main.CONTROL.step");
    const struct plc_var *batches = plc_app_var("Main.control.batches");
    if (!mem || !step || !batches || plc_app_var("Main.nothing") || plc_app_task_count() != 1) return 2;
    plc_app_init(mem, 1);
    printf("cycle,Main.control.step,Main.control.batches\n");
    for (int64_t cycle = 1; cycle <= 2000; cycle++) {
        if (plc_app_scan(mem, 0, (cycle - 1) * 10000000) != 0) return 1;
        int16_t s; uint32_t b;
        memcpy(&s, (char *)mem + step->offset, sizeof s);
        memcpy(&b, (char *)mem + batches->offset, sizeof b);
        static const char *names[] = { "Idle", "FillT1", "FillT2", "Heat", "Drain" };
        printf("%d,%s,%u\n", (int)cycle, names[s], b);
    }
    return 0;
}
"#;

#[test]
fn a_c_host_runs_the_tank() {
    let folder = tempfile::tempdir().expect("a folder");
    let p = folder.path();
    let tank = project_root().join("examples/tank/project.toml").display().to_string();
    let built = command(Path::new(PLCC), p, &["build", &tank, "--emit", "obj,header", "-o", "tank"]);
    assert_eq!(built.code, 0, "{}", built.stderr);
    std::fs::write(p.join("host.c"), HOST).expect("the host");
    let compiled = command(Path::new("cc"), p, &["-Wall", "-Werror", "host.c", "tank.o", "-lm", "-o", "host"]);
    assert_eq!(compiled.code, 0, "{}", compiled.stderr);
    let host = command(&p.join("host"), p, &[]);
    assert_eq!(host.code, 0);
    let watch = "Main.control.step,Main.control.batches";
    let run = command(
        Path::new(PLCC),
        p,
        &["run", &tank, "--virtual-time", "--cycles", "2000", "--watch", watch, "--trace", "-", "--engine", "interp"],
    );
    assert_eq!(host.stdout, run.stdout);
}

#[test]
fn the_object_needs_nothing_but_libc() {
    let folder = tempfile::tempdir().expect("a folder");
    let p = folder.path();
    std::fs::write(
        p.join("m.st"),
        "PROGRAM Main\nVAR a, b : ARRAY [1..100] OF LREAL; x : LREAL; END_VAR\na := b;\nx := SIN(x) ** 2.0;\nEND_PROGRAM\n",
    )
    .expect("a source");
    let built = command(Path::new(PLCC), p, &["build", "m.st", "--emit", "obj,header", "-o", "m"]);
    assert_eq!(built.code, 0, "{}", built.stderr);
    let symbols = command(Path::new("nm"), p, &["-u", "m.o"]);
    for name in symbols.stdout.split_whitespace().filter(|w| *w != "U") {
        assert!(["memcpy", "memset", "memmove", "sin", "pow"].contains(&name), "{}", symbols.stdout);
    }
}

const TWO: &str = r#"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "two.h"

static void *mem;

static long long number(const char *path) {
    const struct plc_var *v = plc_app_var(path);
    long long n = 0;
    if (!v) { printf("no %s\n", path); exit(3); }
    memcpy(&n, (char *)mem + v->offset, v->size);
    return v->size == 2 ? (short)n : v->size == 4 ? (int)n : n;
}

int main(void) {
    static const uint32_t resource[] = PLC_APP_TASK_RESOURCE;
    static unsigned char taken[PLC_APP_TAKEN_SIZE];
    mem = aligned_alloc(64, (plc_app_size() + 63) / 64 * 64);
    if (!mem || plc_app_task_count() != 3 || PLC_APP_RESOURCE_COUNT != 3u) return 2;
    plc_app_init(mem, 1);
    printf("cycle,A.P.n,B.P.n,total,A.own,B.own,Seen.n\n");
    for (int cycle = 1; cycle <= 4; cycle++) {
        for (uint32_t task = 0; task < plc_app_task_count(); task++) {
            if (task == 1 && cycle % 2 == 0) continue;
            plc_app_take(mem, resource[task], taken);
            if (plc_app_scan(mem, task, (cycle - 1) * 10000000)) return 1;
            plc_app_give(mem, resource[task], taken);
        }
        printf("%d,%lld,%lld,%lld,%lld,%lld,%lld\n", cycle, number("A.P.n"), number("B.P.n"), number("total"),
               number("A.own"), number("B.own"), number("Seen.n"));
    }
    return 0;
}
"#;

/// The golden case of two resources, driven by C with what the header has.
#[test]
fn a_c_host_runs_several_resources() {
    let folder = tempfile::tempdir().expect("a folder");
    let p = folder.path();
    let source = project_root().join("tests/cases/config/two_resources.st").display().to_string();
    let built = command(Path::new(PLCC), p, &["build", &source, "--emit", "obj,header", "-o", "two"]);
    assert_eq!(built.code, 0, "{}", built.stderr);
    std::fs::write(p.join("host.c"), TWO).expect("the host");
    let compiled =
        command(Path::new("cc"), p, &["-Wall", "-Wextra", "-Werror", "host.c", "two.o", "-lm", "-o", "host"]);
    assert_eq!(compiled.code, 0, "{}", compiled.stderr);
    let host = command(&p.join("host"), p, &[]);
    let watch = "A.P.n,B.P.n,total,A.own,B.own,Seen.n";
    let run = ["run", &source, "--virtual-time", "--cycles", "4", "--watch", watch, "--engine", "interp"];
    assert_eq!((host.code, host.stdout), (0, command(Path::new(PLCC), p, &run).stdout));
}
