/* Sorted readings; see sort.st. */
#include "bench.h"

struct program {
    struct {
        int16_t reading[64];
    } in;
    struct {
        int16_t low, middle, high, spread, smooth;
        int32_t mean;
    } out;
    int16_t window[9];
    int next;
};

static void sort(int16_t *a, int count) {
    for (int i = 1; i < count; i++) {
        int16_t key = a[i];
        int j = i - 1;
        while (j >= 0 && a[j] > key) {
            a[j + 1] = a[j];
            j--;
        }
        a[j + 1] = key;
    }
}

static void start(struct program *p) { (void)p; }

static void scan(struct program *p, int64_t now) {
    (void)now;
    int16_t list[64], nine[9];
    memcpy(list, p->in.reading, sizeof list);
    sort(list, 64);
    p->out.low = list[0];
    p->out.middle = list[32];
    p->out.high = list[63];
    p->out.spread = list[57] - list[6];
    int32_t sum = 0;
    for (int i = 6; i <= 57; i++)
        sum += list[i];
    p->out.mean = sum / 52;
    p->window[p->next] = p->in.reading[0];
    p->next = (p->next + 1) % 9;
    memcpy(nine, p->window, sizeof nine);
    sort(nine, 9);
    p->out.smooth = nine[4];
}

BENCH_PROGRAM
