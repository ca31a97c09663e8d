/* A small plant; see plant.st. */
#include "bench.h"
#include "blocks.h"
#include <math.h>

enum { TANKS = 4, HISTORY = 16 };
enum step { WAITING, FILLING, HEATING, HOLDING, DRAINING };

struct recipe {
    float amount, temperature;
    int64_t hold;
};

static const struct recipe recipes[3] = {
    {250.0f, 60.0f, 500 * MS}, {180.0f, 45.0f, 250 * MS}, {310.0f, 75.0f, 1000 * MS}};

struct alarm {
    bool active, unseen, outside;
    struct ton timer;
};

struct pump {
    bool on, ready, was;
    float seconds;
    uint32_t starts;
    struct tof rest;
};

struct tank {
    float level, temperature, valve, sum;
    enum step step;
    bool heater, horn, before;
    uint16_t batches;
    int turn;
    struct alarm level_alarm, heat_alarm;
    struct pump pumps[2];
    struct ton hold;
    float history[HISTORY], mean;
    int at;
};

struct program {
    struct {
        int16_t level[TANKS], temperature[TANKS], flow[TANKS];
        bool start[TANKS], tripped[2 * TANKS], release, acknowledge;
        int16_t number;
    } in;
    struct {
        float valve[TANKS], mean[TANKS];
        uint16_t batches[TANKS], status[TANKS];
        bool horn;
        int16_t busy;
    } out;
    struct tank tanks[TANKS];
};

static inline float limit(float low, float x, float high) { return x < low ? low : x > high ? high : x; }

static inline float scaled(int16_t raw, float low, float high) { return low + raw * (high - low) / 27648.0f; }

static void alarm(struct alarm *a, float value, float low, float high, float band, int64_t delay, bool acknowledge, int64_t now) {
    if (a->outside)
        a->outside = value < low + band || value > high - band;
    else
        a->outside = value < low || value > high;
    ton(&a->timer, a->outside, delay, now);
    if (a->timer.q && !a->active)
        a->unseen = true;
    a->active = a->timer.q;
    if (acknowledge)
        a->unseen = false;
}

static void pump(struct pump *p, bool request, bool release, bool tripped, int64_t now) {
    tof(&p->rest, p->on, 200 * MS, now);
    p->ready = release && !tripped;
    p->on = request && p->ready && (p->on || !p->rest.q);
    if (p->on) {
        p->seconds += 0.01f;
        if (!p->was)
            p->starts++;
    }
    p->was = p->on;
}

static void tank(struct tank *t, int16_t level, int16_t temperature, int16_t raw_flow, bool start, bool release, bool acknowledge,
                 const bool *tripped, const struct recipe *recipe, int64_t now) {
    t->level = scaled(level, 0.0f, 400.0f);
    t->temperature = scaled(temperature, -20.0f, 150.0f);
    float flow = scaled(raw_flow, 0.0f, 60.0f);
    alarm(&t->level_alarm, t->level, 20.0f, 380.0f, 5.0f, 100 * MS, acknowledge, now);
    alarm(&t->heat_alarm, t->temperature, 0.0f, 95.0f, 2.0f, 300 * MS, acknowledge, now);
    t->horn = t->level_alarm.unseen || t->heat_alarm.unseen;
    switch (t->step) {
    case WAITING:
        if (start && !t->level_alarm.active)
            t->step = FILLING;
        break;
    case FILLING:
        if (t->level >= recipe->amount)
            t->step = HEATING;
        break;
    case HEATING:
        if (t->temperature >= recipe->temperature)
            t->step = HOLDING;
        break;
    case HOLDING:
        if (t->hold.q)
            t->step = DRAINING;
        break;
    case DRAINING:
        if (t->level < 60.0f) {
            t->step = WAITING;
            t->batches++;
        }
        break;
    }
    ton(&t->hold, t->step == HOLDING, recipe->hold, now);
    bool fill = t->step == FILLING;
    if (fill && !t->before)
        t->turn = t->pumps[0].seconds <= t->pumps[1].seconds ? 0 : 1;
    t->before = fill;
    for (int k = 0; k < 2; k++)
        pump(&t->pumps[k], fill && (t->turn == k || !t->pumps[1 - k].ready), release, tripped[k], now);
    if (t->step == HEATING || t->step == HOLDING) {
        if (t->temperature < recipe->temperature - 1.5f)
            t->heater = true;
        else if (t->temperature > recipe->temperature + 1.5f)
            t->heater = false;
    } else {
        t->heater = false;
    }
    float e = (t->step == DRAINING ? 25.0f : 0.0f) - flow;
    t->sum = limit(0.0f, t->sum + e * 0.02f, 100.0f);
    t->valve = limit(0.0f, 1.5f * e + t->sum, 100.0f);
    t->history[t->at] = t->level;
    t->at = (t->at + 1) % HISTORY;
    float mean = 0.0f;
    for (int k = 0; k < HISTORY; k++)
        mean += t->history[k];
    t->mean = mean / 16.0f;
}

static void start(struct program *p) { (void)p; }

static void scan(struct program *p, int64_t now) {
    p->out.horn = false;
    p->out.busy = 0;
    for (int k = 0; k < TANKS; k++) {
        struct tank *t = &p->tanks[k];
        tank(t, p->in.level[k], p->in.temperature[k], p->in.flow[k], p->in.start[k], p->in.release, p->in.acknowledge,
             &p->in.tripped[2 * k], &recipes[(p->in.number + k) % 3], now);
        p->out.valve[k] = t->valve;
        p->out.mean[k] = t->mean;
        p->out.batches[k] = t->batches;
        uint16_t w = 0;
        if (t->pumps[0].on)
            w |= 1;
        if (t->pumps[1].on)
            w |= 2;
        if (t->heater)
            w |= 4;
        if (t->horn)
            w |= 8;
        if (t->step != WAITING)
            w |= 0x100;
        p->out.status[k] = (uint16_t)(w | (uint16_t)lrintf(t->level / 10.0f) << 9);
        p->out.horn |= t->horn;
        if (t->step != WAITING)
            p->out.busy++;
    }
}

BENCH_PROGRAM
