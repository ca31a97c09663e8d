/* Telegrams; see strings.st. */
#include "bench.h"

struct program {
    struct {
        char telegram[61];
        int16_t shift;
    } in;
    struct {
        char article[21], command[21];
        int32_t weight, total;
        char line[81];
        int16_t length, known, unknown;
    } out;
    char history[4][81];
    int newest;
};

/* The field of a line with a number from 1, at most `size` - 1 characters of it. */
static void field(char *to, size_t size, const char *line, int number) {
    while (--number > 0) {
        line = strchr(line, ';');
        if (!line) {
            *to = 0;
            return;
        }
        line++;
    }
    const char *end = strchr(line, ';');
    size_t length = end ? (size_t)(end - line) : strlen(line);
    if (length > size - 1)
        length = size - 1;
    memcpy(to, line, length);
    to[length] = 0;
}

static int32_t number(const char *text) {
    bool negative = *text == '-';
    int32_t value = 0;
    for (text += negative; *text >= '0' && *text <= '9'; text++)
        value = value * 10 + (*text - '0');
    return negative ? -value : value;
}

/* Appends at `at` what fits below `end`; gives the new end of the string. */
static char *text(char *at, const char *end, const char *from) {
    while (*from && at < end)
        *at++ = *from++;
    *at = 0;
    return at;
}

static char *decimal(char *at, const char *end, int32_t value) {
    char digits[12], *d = digits + sizeof digits;
    uint32_t rest = value < 0 ? 0u - (uint32_t)value : (uint32_t)value;
    *--d = 0;
    do
        *--d = (char)('0' + rest % 10);
    while (rest /= 10);
    if (value < 0)
        *--d = '-';
    return text(at, end, d);
}

static void start(struct program *p) { (void)p; }

static void scan(struct program *p, int64_t now) {
    (void)now;
    char weight[21];
    field(p->out.command, sizeof p->out.command, p->in.telegram, 1);
    field(p->out.article, sizeof p->out.article, p->in.telegram, 2);
    field(weight, sizeof weight, p->in.telegram, 3);
    p->out.weight = number(weight);
    if (!strcmp(p->out.command, "WEIGH")) {
        p->out.total += p->out.weight;
        p->out.known++;
    } else if (!strcmp(p->out.command, "RESET")) {
        p->out.total = 0;
        p->out.known++;
    } else {
        p->out.unknown++;
    }
    char *line = p->out.line, *at = line;
    const char *end = line + sizeof p->out.line - 1;
    at = text(at, end, !strncmp(p->out.article, "AX", 2) ? "alpha" : "#");
    at = decimal(at, end, p->in.shift);
    at = text(at, end, " ");
    at = text(at, end, p->out.article);
    at = text(at, end, ": ");
    at = decimal(at, end, p->out.weight);
    at = text(at, end, " g, total ");
    at = decimal(at, end, p->out.total);
    p->out.length = (int16_t)(at - line);
    if (strcmp(line, p->history[p->newest])) {
        p->newest = (p->newest + 1) % 4;
        strcpy(p->history[p->newest], line);
    }
}

BENCH_PROGRAM
