/* Sixteen PID controllers; see pid.st. */
#include "bench.h"

enum { LOOPS = 16 };
#define MAX_STEP 4.0f

struct tuning {
    float kp, ti, td, tf;
};

struct controller {
    float out, sum, filtered, last;
    bool limited;
};

struct program {
    struct {
        float pv[LOOPS], sp[LOOPS];
        bool manual[LOOPS];
    } in;
    struct {
        float out[LOOPS];
        bool limited[LOOPS];
    } out;
    struct controller loops[LOOPS];
    struct tuning tunings[LOOPS];
};

static inline float limit(float low, float x, float high) { return x < low ? low : x > high ? high : x; }

static void controller(struct controller *c, const struct tuning *t, float sp, float pv, float dt, bool manual, float hand) {
    float e = sp - pv, wanted;
    c->filtered += (pv - c->filtered) * dt / (t->tf + dt);
    float d = (c->filtered - c->last) / dt;
    c->last = c->filtered;
    if (manual) {
        wanted = limit(0.0f, hand, 100.0f);
        c->sum = wanted - t->kp * e;
        c->limited = false;
    } else {
        wanted = t->kp * (e - t->td * d) + c->sum;
        c->limited = wanted < 0.0f || wanted > 100.0f;
        if (!c->limited)
            c->sum += t->kp * e * dt / t->ti;
        wanted = limit(0.0f, wanted, 100.0f);
    }
    c->out += limit(-MAX_STEP, wanted - c->out, MAX_STEP);
}

static void start(struct program *p) {
    static const struct tuning tunings[4] = {
        {2.0f, 5.0f, 0.5f, 0.1f}, {1.2f, 12.0f, 0.5f, 0.1f}, {4.0f, 5.0f, 0.0f, 0.1f}, {2.0f, 0.8f, 0.5f, 0.05f}};
    for (int k = 0; k < LOOPS; k++)
        p->tunings[k] = tunings[k / 4];
}

static void scan(struct program *p, int64_t now) {
    (void)now;
    for (int k = 0; k < LOOPS; k++) {
        struct controller *c = &p->loops[k];
        controller(c, &p->tunings[k], p->in.sp[k], p->in.pv[k], 0.01f, p->in.manual[k], 30.0f);
        p->out.out[k] = c->out;
        p->out.limited[k] = c->limited;
    }
}

BENCH_PROGRAM
