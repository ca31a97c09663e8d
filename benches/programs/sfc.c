/* The mixers of sfc.st as an engineer would write them in C: one state per lane, timers as clock values. */
#include "bench.h"

enum { MIXERS = 4, LAST = 200 };
enum main_state { READY, PREPARE, DOSING, MIX, REST, DISCHARGE, RINSE_FILL, RINSE_MIX, RINSE_DRAIN };
enum lane_state { COARSE, FINE, SETTLE, DONE };

struct recipe {
    int32_t amount[3];
    int64_t mixing, resting;
    bool rinse;
};

static const struct recipe recipes[3] = {
    {{2000, 1500, 1000}, 300 * MS, 100 * MS, false},
    {{500, 3000, 0}, 500 * MS, 0, true},
    {{1000, 1000, 2500}, 200 * MS, 200 * MS, true},
};

struct mixer {
    bool empty, full, coarse[3], fine[3], agitator, outlet, water, tare;
    bool entered; /* the state is new in this scan */
    bool emptied; /* a batch ended in the last scan */
    int32_t weight[3], content;
    uint32_t batches;
    struct recipe recipe;
    enum main_state state;
    enum lane_state lane[3];
    int64_t since, lane_since[3];
};

struct program {
    struct {
        bool start[MIXERS];
        int16_t number[MIXERS];
    } in;
    struct {
        int32_t content[MIXERS];
        uint32_t batches[MIXERS];
        bool agitator[MIXERS], outlet[MIXERS], water[MIXERS];
        int16_t dosing;
    } out;
    struct mixer mixers[MIXERS];
};

static void enter(struct mixer *m, enum main_state state, int64_t now) {
    m->state = state;
    m->since = now;
    m->entered = true;
}

static void lane(struct mixer *m, int i, int64_t now) {
    enum lane_state next = m->lane[i];
    m->coarse[i] = next == COARSE && (i != 2 || (m->recipe.amount[2] > 0 && m->weight[2] < m->recipe.amount[2] - LAST));
    m->fine[i] = next == FINE;
    switch (next) {
    case COARSE:
        if (i == 2 && m->recipe.amount[2] == 0)
            next = DONE;
        else if (m->weight[i] >= m->recipe.amount[i] - LAST)
            next = FINE;
        break;
    case FINE:
        if (m->weight[i] >= m->recipe.amount[i])
            next = SETTLE;
        break;
    case SETTLE:
        if (now - m->lane_since[i] >= 50 * MS)
            next = DONE;
        break;
    case DONE:
        break;
    }
    if (next != m->lane[i]) {
        m->lane[i] = next;
        m->lane_since[i] = now;
    }
}

static void control(struct mixer *m, bool start, int number, int64_t now) {
    int64_t t = now - m->since;
    bool entered = m->entered;
    m->entered = false;
    m->tare = m->state == PREPARE;
    m->outlet = m->state == DISCHARGE || m->state == RINSE_DRAIN;
    m->water = m->state == RINSE_FILL;
    m->agitator = m->state == MIX || m->state == RINSE_MIX;
    if (m->emptied)
        m->batches++;
    m->emptied = false;
    switch (m->state) {
    case READY:
        if (start)
            enter(m, PREPARE, now);
        break;
    case PREPARE:
        if (entered)
            m->recipe = recipes[number - 1];
        if (t >= 20 * MS) {
            enter(m, DOSING, now);
            for (int i = 0; i < 3; i++) {
                m->lane[i] = COARSE;
                m->lane_since[i] = now;
            }
        }
        break;
    case DOSING:
        if (m->lane[0] == DONE && m->lane[1] == DONE && m->lane[2] == DONE)
            enter(m, MIX, now);
        else
            for (int i = 0; i < 3; i++)
                lane(m, i, now);
        break;
    case MIX:
        if (t >= m->recipe.mixing)
            enter(m, REST, now);
        break;
    case REST:
        if (t >= m->recipe.resting)
            enter(m, DISCHARGE, now);
        break;
    case DISCHARGE:
        if (m->empty) {
            m->emptied = true;
            enter(m, m->recipe.rinse ? RINSE_FILL : READY, now);
        }
        break;
    case RINSE_FILL:
        if (m->full)
            enter(m, RINSE_MIX, now);
        break;
    case RINSE_MIX:
        if (t >= 100 * MS)
            enter(m, RINSE_DRAIN, now);
        break;
    case RINSE_DRAIN:
        if (m->empty)
            enter(m, READY, now);
        break;
    }
}

static void vessel(struct mixer *m) {
    for (int i = 0; i < 3; i++) {
        if (m->tare)
            m->weight[i] = 0;
        int32_t flow = m->coarse[i] ? 70 + 10 * i : m->fine[i] ? 20 : 0;
        m->weight[i] += flow;
        m->content += flow;
    }
    if (m->water)
        m->content += 150;
    if (m->outlet)
        m->content = m->content > 200 ? m->content - 200 : 0;
    m->empty = m->content == 0;
    m->full = m->content >= 1500;
}

static void start(struct program *p) {
    for (int k = 0; k < MIXERS; k++)
        p->mixers[k].empty = true;
}

static void scan(struct program *p, int64_t now) {
    p->out.dosing = 0;
    for (int k = 0; k < MIXERS; k++) {
        struct mixer *m = &p->mixers[k];
        vessel(m);
        control(m, p->in.start[k], p->in.number[k], now);
        p->out.content[k] = m->content;
        p->out.batches[k] = m->batches;
        p->out.agitator[k] = m->agitator;
        p->out.outlet[k] = m->outlet;
        p->out.water[k] = m->water;
        for (int i = 0; i < 3; i++)
            p->out.dosing += m->coarse[i] || m->fine[i];
    }
}

BENCH_PROGRAM
