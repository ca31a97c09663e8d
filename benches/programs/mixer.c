/* The batch mixer of examples/mixer as an engineer would write it in C: one state per lane, timers as clock values, and the same
   simulated plant. Times itself over as many scans as its argument says and prints median, 99.9 % and worst in nanoseconds,
   less what reading the clock takes. */
#define _POSIX_C_SOURCE 199309L
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum main_state { READY, PREPARE, DOSING, MIX, REST, DISCHARGE, RINSE_FILL, RINSE_MIX, RINSE_DRAIN };
enum lane_state { COARSE, FINE, SETTLE, DONE };

static const struct recipe {
    int32_t amount[3];
    int64_t mixing, resting;
    bool rinse;
} recipes[3] = {
    {{2000, 1500, 1000}, 300000000, 100000000, false},
    {{500, 3000, 0}, 500000000, 0, true},
    {{1000, 1000, 2500}, 200000000, 200000000, true},
};

static struct {
    bool start, empty, full, coarse[3], fine[3], agitator, outlet, water, tare;
    int number;
    int32_t weight[3], content;
    uint32_t batches;
    struct recipe recipe;
    enum main_state state;
    enum lane_state lane[3];
    int64_t since, lane_since[3];
} m = {.start = true, .empty = true, .number = 1};

static void enter(enum main_state state, int64_t now) {
    m.state = state;
    m.since = now;
}

static void lane(int i, int64_t now) {
    enum lane_state next = m.lane[i];
    m.coarse[i] = next == COARSE && (i != 2 || (m.recipe.amount[2] > 0 && m.weight[2] < m.recipe.amount[2] - 200));
    m.fine[i] = next == FINE;
    switch (next) {
    case COARSE:
        if (i == 2 && m.recipe.amount[2] == 0)
            next = DONE;
        else if (m.weight[i] >= m.recipe.amount[i] - 200)
            next = FINE;
        break;
    case FINE:
        if (m.weight[i] >= m.recipe.amount[i])
            next = SETTLE;
        break;
    case SETTLE:
        if (now - m.lane_since[i] >= 50000000)
            next = DONE;
        break;
    case DONE:
        break;
    }
    if (next != m.lane[i]) {
        m.lane[i] = next;
        m.lane_since[i] = now;
    }
}

static void control(int64_t now) {
    int64_t t = now - m.since;
    m.tare = m.state == PREPARE;
    m.outlet = m.state == DISCHARGE || m.state == RINSE_DRAIN;
    m.water = m.state == RINSE_FILL;
    m.agitator = m.state == MIX || m.state == RINSE_MIX;
    switch (m.state) {
    case READY:
        if (m.start) {
            m.recipe = recipes[m.number - 1];
            enter(PREPARE, now);
        }
        break;
    case PREPARE:
        if (t >= 20000000) {
            enter(DOSING, now);
            for (int i = 0; i < 3; i++) {
                m.lane[i] = COARSE;
                m.lane_since[i] = now;
            }
        }
        break;
    case DOSING:
        if (m.lane[0] == DONE && m.lane[1] == DONE && m.lane[2] == DONE)
            enter(MIX, now);
        else
            for (int i = 0; i < 3; i++)
                lane(i, now);
        break;
    case MIX:
        if (t >= m.recipe.mixing)
            enter(REST, now);
        break;
    case REST:
        if (t >= m.recipe.resting)
            enter(DISCHARGE, now);
        break;
    case DISCHARGE:
        if (m.empty) {
            m.batches++;
            enter(m.recipe.rinse ? RINSE_FILL : READY, now);
        }
        break;
    case RINSE_FILL:
        if (m.full)
            enter(RINSE_MIX, now);
        break;
    case RINSE_MIX:
        if (t >= 100000000)
            enter(RINSE_DRAIN, now);
        break;
    case RINSE_DRAIN:
        if (m.empty)
            enter(READY, now);
        break;
    }
}

static void plant(void) {
    for (int i = 0; i < 3; i++) {
        if (m.tare)
            m.weight[i] = 0;
        int32_t flow = m.coarse[i] ? 70 + 10 * i : m.fine[i] ? 20 : 0;
        m.weight[i] += flow;
        m.content += flow;
    }
    if (m.water)
        m.content += 150;
    if (m.outlet)
        m.content = m.content > 200 ? m.content - 200 : 0;
    m.empty = m.content == 0;
    m.full = m.content >= 1500;
}

static int64_t clock_ns(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static int by_value(const void *a, const void *b) {
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv) {
    long scans = argc > 1 ? atol(argv[1]) : 1000;
    int64_t *times = malloc(sizeof *times * (size_t)scans);
    if (scans < 1 || !times)
        return 1;
    for (long n = 0; n < scans; n++) {
        int64_t start = clock_ns();
        times[n] = clock_ns() - start;
    }
    qsort(times, (size_t)scans, sizeof *times, by_value);
    int64_t less = times[scans / 2];
    for (long n = 0; n < scans; n++) {
        int64_t start = clock_ns();
        plant();
        control((int64_t)n * 10000000);
        times[n] = clock_ns() - start - less;
    }
    qsort(times, (size_t)scans, sizeof *times, by_value);
    printf("median %lld, p99.9 %lld, worst %lld ns (%u batches)\n", (long long)times[scans / 2],
           (long long)times[(scans - 1) * 999 / 1000], (long long)times[scans - 1], m.batches);
    free(times);
    return 0;
}
