/* Eight axes; see il.st. */
#include "bench.h"
#include "blocks.h"

enum { AXES = 8 };

struct axis {
    bool left, right, moving, fault;
    int16_t position, state;
    struct ton late;
};

struct program {
    struct {
        int16_t raw[AXES];
        bool forward[AXES], backward[AXES], ends[AXES], stop;
    } in;
    struct {
        int16_t position[AXES], state[AXES];
        bool left[AXES], right[AXES], fault[AXES];
        int16_t moving;
    } out;
    struct axis axes[AXES];
};

static int16_t scale(int16_t raw, int16_t low, int16_t high) {
    int32_t span = high - low;
    return (int16_t)((int16_t)(raw * span / 27648) + low);
}

static void axis(struct axis *a, bool forward, bool backward, bool ends, bool stop, int16_t raw, int64_t now) {
    a->right = (forward || a->right) && !stop && !a->left && !ends && !a->fault;
    a->left = (backward || a->left) && !stop && !a->right && !a->fault;
    a->moving = a->left || a->right;
    ton(&a->late, a->moving, 400 * MS, now);
    if (a->late.q)
        a->fault = true;
    if (stop)
        a->fault = false;
    a->position = scale(raw, 100, 900);
    if (a->position > 880)
        a->fault = true;
    switch (a->state) {
    case 0:
        if (a->moving)
            a->state = 1;
        break;
    case 1:
        a->state = 2;
        break;
    default:
        if (!a->moving)
            a->state = 0;
        break;
    }
}

static void start(struct program *p) { (void)p; }

static void scan(struct program *p, int64_t now) {
    p->out.moving = 0;
    for (int k = 0; k < AXES; k++) {
        struct axis *a = &p->axes[k];
        axis(a, p->in.forward[k], p->in.backward[k], p->in.ends[k], p->in.stop, p->in.raw[k], now);
        p->out.left[k] = a->left;
        p->out.right[k] = a->right;
        p->out.fault[k] = a->fault;
        p->out.position[k] = a->position;
        p->out.state[k] = a->state;
        if (a->moving)
            p->out.moving++;
    }
}

BENCH_PROGRAM
