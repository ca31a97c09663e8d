/* What a C reference shows to the bench: where its inputs and outputs lie, and the same two entry points that a compiled
   application has. A program file defines `struct program` with the members `in` and `out`, `start` (initial values in zeroed
   memory) and `scan` (one cycle at a time of the scan clock, nanoseconds), and ends with BENCH_PROGRAM.
   `in` and `out` have the VAR_INPUTs and VAR_OUTPUTs of the ST program in its order: BOOL is bool, INT int16_t, REAL float,
   TIME int64_t (nanoseconds), STRING[n] char[n + 1]. */
#ifndef BENCH_H
#define BENCH_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define MS ((int64_t)1000000)

#define BENCH_PROGRAM                                                                                                          \
    const uint64_t bench_layout[5] = {sizeof(struct program), offsetof(struct program, in), sizeof(((struct program *)0)->in), \
                                      offsetof(struct program, out), sizeof(((struct program *)0)->out)};                      \
    void bench_init(struct program *p, int cold) {                                                                             \
        (void)cold;                                                                                                            \
        memset(p, 0, sizeof *p);                                                                                               \
        start(p);                                                                                                              \
    }                                                                                                                          \
    uint32_t bench_scan(struct program *p, uint32_t task, int64_t now) {                                                       \
        (void)task;                                                                                                            \
        scan(p, now);                                                                                                          \
        return 0;                                                                                                              \
    }
#endif
