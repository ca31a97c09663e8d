/* Sixty-four channels of timers and counters; see timers.st. */
#include "bench.h"
#include "blocks.h"

enum { CHANNELS = 64 };

struct program {
    struct {
        bool run[CHANNELS];
    } in;
    struct {
        int64_t elapsed;
        bool on[CHANNELS], off[CHANNELS];
        int16_t count[CHANNELS];
    } out;
    struct {
        struct ton delay;
        struct tof hold;
        struct ctu starts;
    } channel[CHANNELS];
};

static void start(struct program *p) { (void)p; }

static void scan(struct program *p, int64_t now) {
    int64_t elapsed = 0;
    for (int k = 0; k < CHANNELS; k++) {
        struct ton *delay = &p->channel[k].delay;
        struct tof *hold = &p->channel[k].hold;
        struct ctu *starts = &p->channel[k].starts;
        ton(delay, p->in.run[k], 50 * MS, now);
        tof(hold, delay->q, 30 * MS, now);
        ctu(starts, hold->q, starts->q, 10);
        p->out.on[k] = delay->q;
        p->out.off[k] = hold->q;
        p->out.count[k] = starts->cv;
        elapsed += delay->et + hold->et;
    }
    p->out.elapsed = elapsed;
}

BENCH_PROGRAM
