/* Four channels of a low-pass with 64 taps; see fir.st. */
#include "bench.h"
#include <math.h>

enum { TAPS = 64 };

static const float taps[TAPS] = {
    -0.0001013f, 0.0003161f, 0.0007409f, 0.0011019f, 0.0012783f, 0.0011184f, 0.0004965f, -0.0006062f,
    -0.0020289f, -0.0034067f, -0.0042237f, -0.0039498f, -0.0022350f, 0.0008958f, 0.0049193f, 0.0088259f,
    0.0113027f, 0.0110691f, 0.0072966f, 0.0000000f, -0.0097234f, -0.0197089f, -0.0270371f, -0.0286110f,
    -0.0218831f, -0.0055649f, 0.0198672f, 0.0520198f, 0.0868565f, 0.1193698f, 0.1445191f, 0.1582304f,
    0.1582304f, 0.1445191f, 0.1193698f, 0.0868565f, 0.0520198f, 0.0198672f, -0.0055649f, -0.0218831f,
    -0.0286110f, -0.0270371f, -0.0197089f, -0.0097234f, 0.0000000f, 0.0072966f, 0.0110691f, 0.0113027f,
    0.0088259f, 0.0049193f, 0.0008958f, -0.0022350f, -0.0039498f, -0.0042237f, -0.0034067f, -0.0020289f,
    -0.0006062f, 0.0004965f, 0.0011184f, 0.0012783f, 0.0011019f, 0.0007409f, 0.0003161f, -0.0001013f};

struct fir {
    float ring[TAPS];
    int newest;
};

struct program {
    struct {
        float x[4];
    } in;
    struct {
        float y[4], peak;
    } out;
    struct fir channels[4];
};

static float fir(struct fir *f, float x) {
    f->ring[f->newest] = x;
    int at = f->newest;
    float sum = 0.0f;
    for (int k = 0; k < TAPS; k++) {
        sum += taps[k] * f->ring[at];
        if (--at < 0)
            at = TAPS - 1;
    }
    if (++f->newest >= TAPS)
        f->newest = 0;
    return sum;
}

static void start(struct program *p) { (void)p; }

static void scan(struct program *p, int64_t now) {
    (void)now;
    for (int k = 0; k < 4; k++) {
        p->out.y[k] = fir(&p->channels[k], p->in.x[k]);
        if (fabsf(p->out.y[k]) > p->out.peak)
            p->out.peak = fabsf(p->out.y[k]);
    }
    p->out.peak *= 0.999f;
}

BENCH_PROGRAM
