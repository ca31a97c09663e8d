/* Signal conditioning of eight channels; see signals.st. */
#include "bench.h"
#include <math.h>

enum { CHANNELS = 8, POINTS = 16, RING = 32 };

struct average {
    float ring[RING], y;
    int at;
};

struct lag {
    float y;
    bool running;
    int64_t last;
};

struct totaliser {
    float rest;
    uint32_t total;
};

struct statistics {
    float low, high, mean, deviation, m2;
    int32_t n;
};

struct channel {
    float one, two, y;
    bool high;
    struct average average;
    struct lag lag;
    float ramp;
    struct totaliser sum;
    struct statistics quality;
};

struct program {
    struct {
        float raw[CHANNELS];
        bool reset;
    } in;
    struct {
        float y[CHANNELS], flow[CHANNELS], deviation[CHANNELS];
        uint32_t total[CHANNELS];
        int16_t high;
    } out;
    struct channel channels[CHANNELS];
};

static const float xs[POINTS] = {0.0f,  4.0f,  9.0f,  15.0f, 22.0f, 28.0f, 33.0f, 40.0f,
                                 48.0f, 55.0f, 61.0f, 70.0f, 78.0f, 85.0f, 93.0f, 100.0f};
static const float ys[POINTS] = {0.0f,  2.5f,  6.1f,  11.0f, 17.9f, 25.2f, 32.0f, 40.3f,
                                 50.0f, 58.8f, 66.1f, 75.0f, 82.7f, 88.9f, 95.4f, 100.0f};

static inline float min(float a, float b) { return a < b ? a : b; }
static inline float max(float a, float b) { return a > b ? a : b; }
static inline float median3(float a, float b, float c) { return max(min(a, b), min(max(a, b), c)); }
static inline float dead_band(float x, float width) { return x > width ? x - width : x < -width ? x + width : 0.0f; }

static float interpolated(float x, const float *xs, const float *ys) {
    if (x <= xs[0])
        return ys[0];
    if (x >= xs[POINTS - 1])
        return ys[POINTS - 1];
    int low = 0, high = POINTS - 1;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (x < xs[middle])
            high = middle;
        else
            low = middle;
    }
    return ys[low] + (x - xs[low]) * (ys[high] - ys[low]) / (xs[high] - xs[low]);
}

static void average(struct average *a, float x, int size) {
    int n = size < 1 ? 1 : size > RING ? RING : size;
    a->ring[a->at] = x;
    a->at = (a->at + 1) % n;
    float y = 0.0f;
    for (int k = 0; k < n; k++)
        y += a->ring[k];
    a->y = y / (float)n;
}

/* A time in milliseconds, with its fraction. */
static inline float milliseconds(int64_t ns) { return (float)((double)ns / 1e6); }

static void lag(struct lag *l, float x, int64_t t, int64_t now) {
    if (!l->running || t <= 0) {
        l->running = true;
        l->y = x;
    } else {
        float dt = milliseconds(now - l->last);
        l->y += (x - l->y) * dt / (milliseconds(t) + dt);
    }
    l->last = now;
}

static inline float ramp(float y, float target, float up, float down) {
    if (y < target)
        return min(y + up, target);
    if (y > target)
        return max(y - down, target);
    return y;
}

static void totaliser(struct totaliser *t, float flow, bool reset) {
    if (reset) {
        t->total = 0;
        t->rest = 0.0f;
    }
    t->rest += flow * 0.01f;
    while (t->rest >= 1.0f) {
        t->rest -= 1.0f;
        t->total++;
    }
}

static void statistics(struct statistics *s, float x, bool reset) {
    if (reset || s->n == 0) {
        s->n = 0;
        s->low = s->high = x;
        s->mean = s->m2 = 0.0f;
    }
    s->n++;
    s->low = min(s->low, x);
    s->high = max(s->high, x);
    float d = x - s->mean;
    s->mean += d / (float)s->n;
    s->m2 += d * (x - s->mean);
    s->deviation = sqrtf(s->m2 / (float)s->n);
}

static void start(struct program *p) { (void)p; }

static void scan(struct program *p, int64_t now) {
    p->out.high = 0;
    for (int k = 0; k < CHANNELS; k++) {
        struct channel *c = &p->channels[k];
        float raw = p->in.raw[k];
        float x = median3(raw, c->one, c->two);
        c->two = c->one;
        c->one = raw;
        x = interpolated(x, xs, ys);
        average(&c->average, x, 8 + 2 * k);
        lag(&c->lag, c->average.y, 250 * MS, now);
        c->ramp = ramp(c->ramp, c->lag.y, 1.5f, 0.5f);
        c->y = 50.0f + dead_band(c->ramp - 50.0f, 2.0f);
        c->high = c->high ? c->y > 70.0f : c->y > 80.0f;
        float flow = sqrtf(max(c->y, 0.0f)) * 3.25f;
        totaliser(&c->sum, flow, p->in.reset);
        statistics(&c->quality, c->y, p->in.reset);
        p->out.y[k] = c->y;
        p->out.flow[k] = flow;
        p->out.deviation[k] = c->quality.deviation;
        p->out.total[k] = c->sum.total;
        if (c->high)
            p->out.high++;
    }
}

BENCH_PROGRAM
