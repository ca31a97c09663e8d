/* Fifty filling stations; see states.st. */
#include "bench.h"

enum { STATIONS = 50 };
enum phase { IDLE, FETCH, CLAMP, FILL, TOP, RELEASE, EJECT, FAILED };

struct station {
    enum phase phase;
    bool feed, clamp, valve, eject;
    int16_t ticks;
    uint16_t parts, rejects;
    int32_t filled;
};

struct program {
    struct {
        bool part[STATIONS], clamped[STATIONS];
        int16_t flow[STATIONS];
        bool ready, acknowledge;
    } in;
    struct {
        uint16_t parts, rejects, busy;
        bool valves[STATIONS];
        int32_t filled[STATIONS];
    } out;
    struct station stations[STATIONS];
};

static void station(struct station *s, bool part, bool clamped, bool ready, bool acknowledge, int16_t flow) {
    s->ticks++;
    switch (s->phase) {
    case IDLE:
        s->feed = s->eject = false;
        if (part && ready) {
            s->phase = FETCH;
            s->ticks = 0;
        }
        break;
    case FETCH:
        s->feed = true;
        if (s->ticks > 3) {
            s->phase = CLAMP;
            s->ticks = 0;
        }
        break;
    case CLAMP:
        s->feed = false;
        s->clamp = true;
        if (clamped) {
            s->phase = FILL;
            s->ticks = 0;
            s->filled = 0;
        } else if (s->ticks > 20) {
            s->phase = FAILED;
        }
        break;
    case FILL:
        s->valve = true;
        s->filled += flow;
        if (s->filled >= 900) {
            s->phase = TOP;
            s->ticks = 0;
        } else if (s->ticks > 40) {
            s->phase = FAILED;
        }
        break;
    case TOP:
        s->valve = s->ticks % 2 == 0;
        if (s->valve)
            s->filled += flow / 4;
        if (s->filled >= 1000) {
            s->valve = false;
            s->phase = RELEASE;
            s->ticks = 0;
        }
        break;
    case RELEASE:
        s->clamp = false;
        if (s->ticks >= 2) {
            s->phase = EJECT;
            s->ticks = 0;
        }
        break;
    case EJECT:
        s->eject = true;
        if (!part) {
            s->parts++;
            s->phase = IDLE;
        }
        break;
    case FAILED:
        s->valve = s->clamp = false;
        if (acknowledge) {
            s->rejects++;
            s->phase = EJECT;
        }
        break;
    }
}

static void start(struct program *p) { (void)p; }

static void scan(struct program *p, int64_t now) {
    (void)now;
    uint16_t parts = 0, rejects = 0, busy = 0;
    for (int k = 0; k < STATIONS; k++) {
        struct station *s = &p->stations[k];
        station(s, p->in.part[k], p->in.clamped[k], p->in.ready, p->in.acknowledge, p->in.flow[k]);
        parts += s->parts;
        rejects += s->rejects;
        if (s->phase != IDLE)
            busy++;
        p->out.valves[k] = s->valve;
        p->out.filled[k] = s->filled;
    }
    p->out.parts = parts;
    p->out.rejects = rejects;
    p->out.busy = busy;
}

BENCH_PROGRAM
