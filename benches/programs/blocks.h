/* The standard function blocks as they are written by hand in C. Times are nanoseconds of the scan clock, PT is more than 0. */
#ifndef BLOCKS_H
#define BLOCKS_H
#include <stdbool.h>
#include <stdint.h>

struct ton {
    bool q, running;
    int64_t et, start;
};

static inline void ton(struct ton *t, bool in, int64_t pt, int64_t now) {
    if (!in) {
        t->running = t->q = false;
        t->et = 0;
        return;
    }
    if (!t->running) {
        t->running = true;
        t->start = now;
    }
    t->et = now - t->start;
    t->q = t->et >= pt;
    if (t->q)
        t->et = pt;
}

struct tof {
    bool q, in;
    int64_t et, start;
};

static inline void tof(struct tof *t, bool in, int64_t pt, int64_t now) {
    if (in) {
        t->in = t->q = true;
        t->et = 0;
        return;
    }
    if (t->in) {
        t->in = false;
        t->start = now;
    }
    if (t->q) {
        t->et = now - t->start;
        if (t->et >= pt) {
            t->q = false;
            t->et = pt;
        }
    }
}

struct tp {
    bool q, in;
    int64_t et, start;
};

static inline void tp(struct tp *t, bool in, int64_t pt, int64_t now) {
    if (t->q && now - t->start >= pt)
        t->q = false;
    if (in && !t->in && !t->q) {
        t->q = true;
        t->start = now;
    }
    t->in = in;
    t->et = t->q ? now - t->start : in ? pt : 0;
}

struct ctu {
    bool q, cu;
    int16_t cv;
};

static inline void ctu(struct ctu *c, bool cu, bool r, int16_t pv) {
    if (r)
        c->cv = 0;
    else if (cu && !c->cu && c->cv < INT16_MAX)
        c->cv++;
    c->cu = cu;
    c->q = c->cv >= pv;
}

static inline bool rising(bool *memory, bool clk) {
    bool q = clk && !*memory;
    *memory = clk;
    return q;
}
#endif
