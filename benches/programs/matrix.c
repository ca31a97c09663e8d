/* Matrices of double; see matrix.st. */
#include "bench.h"
#include <math.h>

enum { N = 16 };

struct program {
    struct {
        double u[N];
    } in;
    struct {
        double y[N], trace, norm;
    } out;
    double a[N][N], b[N][N], c[N][N];
    bool ready;
};

static void start(struct program *p) { (void)p; }

static void make_coupling(struct program *p) {
    p->ready = true;
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            p->b[i][j] = 1.0 / (i + j + 1);
}

static void scan(struct program *p, int64_t now) {
    (void)now;
    if (!p->ready)
        make_coupling(p);
    const double *u = p->in.u;
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            p->a[i][j] = p->a[i][j] * 0.9 + u[i] * 0.1 - u[j] * 0.05;
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            double sum = 0.0;
            for (int k = 0; k < N; k++)
                sum += p->a[i][k] * p->b[k][j];
            p->c[i][j] = sum;
        }
    }
    p->out.trace = p->out.norm = 0.0;
    for (int i = 0; i < N; i++) {
        p->out.trace += p->c[i][i];
        double y = 0.0;
        for (int j = 0; j < N; j++)
            y += p->c[i][j] * u[j];
        p->out.y[i] = y;
        if (fabs(y) > p->out.norm)
            p->out.norm = fabs(y);
    }
}

BENCH_PROGRAM
