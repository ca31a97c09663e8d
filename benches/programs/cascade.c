/* Six cascades of two PID loops; see cascade.st. */
#include "bench.h"

#define DT 0.02f

struct loop {
    float out, sum, last;
};

struct program {
    struct inputs {
        float sp[12], pv[12];
    } in;
    struct {
        float out[12];
    } out;
    struct loop steam, feed, level, reflux, reboil, drum, tower, cooler, mixer, dryer, kiln, mill;
};

static inline float limit(float low, float x, float high) { return x < low ? low : x > high ? high : x; }

static inline void loop(struct loop *l, float sp, float pv, float kp, float ti, float td, float low, float high) {
    float e = sp - pv;
    float p = kp * e;
    l->sum = limit(low, l->sum + p * DT / ti, high);
    l->out = limit(low, p + l->sum - kp * td * (pv - l->last) / DT, high);
    l->last = pv;
}

static void start(struct program *p) { (void)p; }

static void scan(struct program *p, int64_t now) {
    (void)now;
    const struct inputs *in = &p->in;
    loop(&p->steam, in->sp[0], in->pv[0], 2.0f, 5.0f, 0.2f, 0.0f, 100.0f);
    p->out.out[0] = p->steam.out;
    loop(&p->feed, p->steam.out, in->pv[1], 1.5f, 8.0f, 0.1f, 0.0f, 100.0f);
    p->out.out[1] = p->feed.out;
    loop(&p->level, in->sp[2], in->pv[2], 4.0f, 20.0f, 0.0f, 0.0f, 100.0f);
    p->out.out[2] = p->level.out;
    loop(&p->reflux, p->level.out, in->pv[3], 0.8f, 3.0f, 0.3f, 0.0f, 100.0f);
    p->out.out[3] = p->reflux.out;
    loop(&p->reboil, in->sp[4], in->pv[4], 1.1f, 6.0f, 0.2f, 0.0f, 100.0f);
    p->out.out[4] = p->reboil.out;
    loop(&p->drum, p->reboil.out, in->pv[5], 3.0f, 15.0f, 0.0f, 0.0f, 100.0f);
    p->out.out[5] = p->drum.out;
    loop(&p->tower, in->sp[6], in->pv[6], 0.6f, 4.0f, 0.5f, 0.0f, 100.0f);
    p->out.out[6] = p->tower.out;
    loop(&p->cooler, p->tower.out, in->pv[7], 2.2f, 9.0f, 0.1f, 0.0f, 100.0f);
    p->out.out[7] = p->cooler.out;
    loop(&p->mixer, in->sp[8], in->pv[8], 1.9f, 7.0f, 0.2f, 0.0f, 100.0f);
    p->out.out[8] = p->mixer.out;
    loop(&p->dryer, p->mixer.out, in->pv[9], 0.9f, 12.0f, 0.4f, 0.0f, 100.0f);
    p->out.out[9] = p->dryer.out;
    loop(&p->kiln, in->sp[10], in->pv[10], 1.3f, 30.0f, 0.6f, 0.0f, 100.0f);
    p->out.out[10] = p->kiln.out;
    loop(&p->mill, p->kiln.out, in->pv[11], 2.6f, 2.5f, 0.0f, 0.0f, 100.0f);
    p->out.out[11] = p->mill.out;
}

BENCH_PROGRAM
