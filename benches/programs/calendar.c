/* Calendar functions; see calendar.st. */
#include "bench.h"
#include <math.h>

enum { CLOCKS = 4, SWITCHES = 16 };

struct moment {
    int year, month, day, hour, minute, second, weekday, day_of_year;
};

struct program {
    struct {
        int64_t clocks[CLOCKS];
    } in;
    struct {
        int32_t day_number[CLOCKS];
        double sun[CLOCKS];
        int16_t year[CLOCKS], week[CLOCKS], day_of_year[CLOCKS], minute[CLOCKS];
        bool summer[CLOCKS], holiday[CLOCKS], leap[CLOCKS];
        uint16_t channel[CLOCKS];
    } out;
};

static const struct {
    int16_t on, off;
    uint8_t days;
} switches[SWITCHES] = {
    {360, 1080, 0x3E}, {420, 600, 0x7F},   {0, 300, 0x41},    {1200, 1439, 0x3E}, {480, 720, 0x02},  {480, 720, 0x04},
    {480, 720, 0x08},  {480, 720, 0x10},   {780, 1020, 0x02}, {780, 1020, 0x04},  {780, 1020, 0x08}, {780, 1020, 0x10},
    {100, 200, 0x01},  {300, 900, 0x40},   {660, 661, 0x7F},  {1320, 1380, 0x20},
};

static inline bool leap_year(int year) { return (year % 4 == 0 && year % 100 != 0) || year % 400 == 0; }

/* Days since 1970-01-01. */
static int day_number(int year, int month, int day) {
    int y = month <= 2 ? year - 1 : year;
    int era = y / 400;
    int yoe = y - era * 400;
    int doy = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    return era * 146097 + yoe * 365 + yoe / 4 - yoe / 100 + doy - 719468;
}

static struct moment split(int64_t seconds) {
    struct moment m;
    int days = (int)(seconds / 86400), rest = (int)(seconds % 86400);
    m.hour = rest / 3600;
    m.minute = rest / 60 % 60;
    m.second = rest % 60;
    m.weekday = (days + 4) % 7;
    int z = days + 719468;
    int era = z / 146097;
    int doe = z - era * 146097;
    int yoe = (doe - doe / 1460 + doe / 36524 - doe / 146096) / 365;
    int doy = doe - (365 * yoe + yoe / 4 - yoe / 100);
    int mp = (5 * doy + 2) / 153;
    m.day = doy - (153 * mp + 2) / 5 + 1;
    m.month = mp < 10 ? mp + 3 : mp - 9;
    m.year = yoe + era * 400 + (m.month <= 2);
    m.day_of_year = days - day_number(m.year, 1, 1) + 1;
    return m;
}

static int iso_week(const struct moment *m) {
    int weekday = (m->weekday + 6) % 7;
    int week = (m->day_of_year - 1 - weekday + 10) / 7;
    if (week < 1) {
        int last = (day_number(m->year - 1, 12, 31) + 3) % 7;
        return last == 3 || (last == 4 && leap_year(m->year - 1)) ? 53 : 52;
    }
    if (week == 53 && (day_number(m->year, 12, 31) + 3) % 7 < 3)
        return 1;
    return week;
}

static int easter(int year) {
    int a = year % 19, b = year / 100, c = year % 100;
    int d = b / 4, e = b % 4, f = (b + 8) / 25, g = (b - f + 1) / 3;
    int h = (19 * a + b - d - g + 15) % 30;
    int i = c / 4, k = c % 4;
    int l = (32 + 2 * e + 2 * i - h - k) % 7;
    int m = (a + 11 * h + 22 * l) / 451;
    int n = h + l - 7 * m + 114;
    return day_number(year, n / 31, n % 31 + 1);
}

/* Day number of the last Sunday of a month with 31 days. */
static int last_sunday(int year, int month) {
    int d = day_number(year, month, 31);
    return d - (d + 4) % 7;
}

static bool is_holiday(const struct moment *m, int from_easter) {
    switch (from_easter) {
    case -2:
    case 1:
    case 39:
    case 50:
        return true;
    }
    switch (m->month) {
    case 1:
    case 5:
        return m->day == 1;
    case 10:
        return m->day == 3;
    case 12:
        return m->day == 25 || m->day == 26;
    }
    return false;
}

static void start(struct program *p) { (void)p; }

static void scan(struct program *p, int64_t clock) {
    (void)clock;
    for (int k = 0; k < CLOCKS; k++) {
        struct moment m = split(p->in.clocks[k]);
        int today = day_number(m.year, m.month, m.day);
        bool holiday = is_holiday(&m, today - easter(m.year));
        int now = m.hour * 60 + m.minute;
        uint16_t w = 0;
        for (int j = 0; j < SWITCHES; j++)
            if (now >= switches[j].on && now < switches[j].off && (switches[j].days >> m.weekday & 1) && !holiday)
                w |= (uint16_t)(1 << j);
        p->out.day_number[k] = today;
        p->out.year[k] = (int16_t)m.year;
        p->out.day_of_year[k] = (int16_t)m.day_of_year;
        p->out.week[k] = (int16_t)iso_week(&m);
        p->out.leap[k] = leap_year(m.year);
        p->out.holiday[k] = holiday;
        p->out.summer[k] = today >= last_sunday(m.year, 3) && today < last_sunday(m.year, 10);
        p->out.minute[k] = (int16_t)now;
        p->out.channel[k] = w;
        double angle = 6.283185307179586 * (m.day_of_year - 81) / 365.25;
        double declination = 0.409279709 * sin(angle);
        double hour = 0.2617993877991494 * ((m.hour - 12) + m.minute / 60.0);
        p->out.sun[k] = sin(declination) * 0.76604444 + cos(declination) * 0.64278761 * cos(hour);
    }
}

BENCH_PROGRAM
