//! The process image from outside: the drivers.

use crate::{Plant, signal};

const INVERT: &str = "PROGRAM Main\nVAR a AT %IW0 : INT; go AT %IX2.0 : BOOL; b AT %QW0 : INT; lamp AT %QX2.1 : BOOL; END_VAR\n\
    b := -a;\nlamp := NOT go;\nEND_PROGRAM\n";

#[test]
fn the_csv_driver_reads_inputs_and_writes_outputs() {
    let plant = Plant::new(&[("m.st", INVERT), ("in.csv", "cycle,Main.a,Main.go\n1,5,\n3,,TRUE\n")]);
    plant.build("m.st", "m");
    for (program, args) in
        [("linked", vec![]), ("jit", vec!["run", "m.st"]), ("interp", vec!["run", "m.st", "--engine", "interp"])]
    {
        let flags = ["--io", "csv:in.csv,out.csv", "--virtual-time", "--cycles", "4"];
        let done = match args.as_slice() {
            [] => plant.run("m", &flags),
            args => plant.plcc(&[args, &flags[..]].concat()),
        };
        assert_eq!(done.code, 0, "{program}: {}", done.stderr);
        let expected = "cycle,Main.b,Main.lamp\n1,-5,TRUE\n2,-5,TRUE\n3,-5,FALSE\n4,-5,FALSE\n";
        assert_eq!(plant.read("out.csv"), expected, "{program}");
    }
    let wrong = |io: &str| plant.run("m", &["--io", io, "--virtual-time", "--cycles", "1"]);
    plant.write("bad.csv", "cycle,Main.b\n1,5\n");
    for (io, code, text) in [
        ("csv:bad.csv", 2, "no input"),
        ("csv:none.csv", 3, "none.csv"),
        ("csv:", 2, "needs a file"),
        ("modbus:1", 2, "there is no driver `modbus`"),
        ("shm:a/b", 2, "without slashes"),
    ] {
        let done = wrong(io);
        assert!(done.code == code && done.stderr.contains(text), "{io}: {} {}", done.code, done.stderr);
    }
}

/// A client in C that knows docs/cli.md only: it writes inputs, waits until the outputs follow, forces an output bit.
const CLIENT: &str = r#"
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

static uint8_t *base;
static uint32_t at(int n) { uint32_t v; memcpy(&v, base + n, 4); return v; }

static void put(const void *inputs, uint32_t bytes) {
    uint32_t *sequence = (uint32_t *)(base + at(16));
    __atomic_store_n(sequence, *sequence + 1, __ATOMIC_RELAXED);
    __atomic_thread_fence(__ATOMIC_RELEASE);
    memcpy(base + at(16) + 8, inputs, bytes);
    __atomic_store_n(sequence, *sequence + 1, __ATOMIC_RELEASE);
}

static int get(void *outputs, uint32_t bytes) {
    uint32_t *sequence = (uint32_t *)(base + at(20));
    uint32_t before = __atomic_load_n(sequence, __ATOMIC_ACQUIRE);
    if (before % 2) return 0;
    memcpy(outputs, base + at(20) + 8, bytes);
    __atomic_thread_fence(__ATOMIC_ACQUIRE);
    return __atomic_load_n(sequence, __ATOMIC_RELAXED) == before;
}

static void nap(void) { struct timespec t = { 0, 1000000 }; nanosleep(&t, 0); }

int main(int argc, char **argv) {
    int fd = -1, n;
    for (n = 0; n < 5000 && fd < 0; n++) { fd = shm_open(argv[argc - 1], O_RDWR, 0); if (fd < 0) nap(); }
    if (fd < 0) return 2;
    base = MAP_FAILED;
    for (n = 0; n < 5000; n++) {
        off_t size = lseek(fd, 0, SEEK_END);
        if (size > 0 && base == MAP_FAILED) base = mmap(0, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
        if (base != MAP_FAILED && !memcmp(base, "plccshm1", 8) && at(32) == 1) break;
        nap();
    }
    if (base == MAP_FAILED || at(8) != 8 || at(12) != 8) return 3;
    for (int16_t a = 1; a <= 200; a++) {
        uint8_t in[8] = { 0 }, out[8];
        memcpy(in, &a, 2);
        in[2] = a % 2;
        put(in, 8);
        for (n = 0; ; n++) {
            int16_t b;
            if (n > 20000) return 4;
            if (get(out, 8)) {
                memcpy(&b, out, 2);
                /* Never a mixture of two cycles. */
                if (((out[2] >> 1) & 1) == ((-b) & 1) && b != 0) return 5;
                if (b == -a) break;
            }
            nap();
        }
    }
    /* Force lamp: bit 1 of byte 2 of %Q. */
    base[at(28) + 8 + 2] = 2;
    base[at(28) + 2] = 2;
    uint8_t even[8] = { 201, 0, 1 }, out[8];
    put(even, 8);
    for (n = 0; n < 20000; n++) { if (get(out, 8) && (int8_t)out[0] == (int8_t)-201 && (out[2] & 2)) break; nap(); }
    base[at(28) + 2] = 0;
    printf("%s\n", n < 20000 ? "all followed" : "not forced");
    return n < 20000 ? 0 : 6;
}
"#;

#[test]
fn another_process_works_with_the_image_through_shared_memory() {
    let plant = Plant::new(&[("m.st", INVERT), ("client.c", CLIENT)]);
    plant.build("m.st", "m");
    let compiled = plcc_tests::command(
        std::path::Path::new("cc"),
        plant.folder.path(),
        &["-O1", "-Wall", "client.c", "-lrt", "-o", "client"],
    );
    assert_eq!(compiled.code, 0, "{}", compiled.stderr);
    let name = format!("plcc-test-{}", std::process::id());
    let program = plant.start("m", &["--io", &format!("shm:{name}"), "--interval", "1ms"]);
    let client = plant.run("client", &[&format!("/{name}")]);
    signal(&program, "-TERM");
    let done = program.wait_with_output().expect("it ends");
    let _ = std::fs::remove_file(format!("/dev/shm/{name}"));
    assert_eq!((client.code, client.stdout.as_str()), (0, "all followed\n"), "{}", client.stderr);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
}
