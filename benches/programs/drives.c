/* A conveyor line of sixteen drives; see drives.st. */
#include "bench.h"
#include "blocks.h"

struct program {
    struct inputs {
        bool enable, stop, reset;
        bool press[16], tripped[16], feedback[16];
    } in;
    struct outputs {
        bool running[16], warning[16], fault[16], service[16];
    } out;
    bool edge01, edge02, edge03, edge04, edge05, edge06, edge07, edge08,
        edge09, edge10, edge11, edge12, edge13, edge14, edge15, edge16;
    bool wanted01, wanted02, wanted03, wanted04, wanted05, wanted06, wanted07, wanted08,
        wanted09, wanted10, wanted11, wanted12, wanted13, wanted14, wanted15, wanted16;
    struct ton delay01, delay02, delay03, delay04, delay05, delay06, delay07, delay08,
        delay09, delay10, delay11, delay12, delay13, delay14, delay15, delay16;
    struct tof hold01, hold02, hold03, hold04, hold05, hold06, hold07, hold08,
        hold09, hold10, hold11, hold12, hold13, hold14, hold15, hold16;
    struct tp horn01, horn02, horn03, horn04, horn05, horn06, horn07, horn08,
        horn09, horn10, horn11, horn12, horn13, horn14, horn15, horn16;
    struct ton missing01, missing02, missing03, missing04, missing05, missing06, missing07, missing08,
        missing09, missing10, missing11, missing12, missing13, missing14, missing15, missing16;
    struct ctu starts01, starts02, starts03, starts04, starts05, starts06, starts07, starts08,
        starts09, starts10, starts11, starts12, starts13, starts14, starts15, starts16;
};

static void start(struct program *p) { (void)p; }

static void scan(struct program *p, int64_t now) {
    const struct inputs *in = &p->in;
    struct outputs *out = &p->out;
    bool edge;
    /* Drive 01 */
    edge = rising(&p->edge01, in->press[0]);
    p->wanted01 = (edge && !in->stop) || (!(in->stop || in->tripped[0]) && p->wanted01);
    ton(&p->delay01, p->wanted01 && in->enable, 80 * MS, now);
    tof(&p->hold01, p->delay01.q, 60 * MS, now);
    tp(&p->horn01, edge, 160 * MS, now);
    ton(&p->missing01, p->hold01.q && !in->feedback[0], 700 * MS, now);
    ctu(&p->starts01, p->hold01.q, in->reset, 5);
    out->running[0] = p->hold01.q && !p->missing01.q;
    out->warning[0] = p->horn01.q;
    out->fault[0] = p->missing01.q || in->tripped[0];
    out->service[0] = p->starts01.q;
    /* Drive 02 */
    edge = rising(&p->edge02, in->press[1]);
    p->wanted02 = (edge && !in->stop) || (!(in->stop || in->tripped[1]) && p->wanted02);
    ton(&p->delay02, p->wanted02 && out->running[0], 120 * MS, now);
    tof(&p->hold02, p->delay02.q, 20 * MS, now);
    tp(&p->horn02, edge, 240 * MS, now);
    ton(&p->missing02, p->hold02.q && !in->feedback[1], 400 * MS, now);
    ctu(&p->starts02, p->hold02.q, in->reset, 6);
    out->running[1] = p->hold02.q && !p->missing02.q;
    out->warning[1] = p->horn02.q;
    out->fault[1] = p->missing02.q || in->tripped[1];
    out->service[1] = p->starts02.q;
    /* Drive 03 */
    edge = rising(&p->edge03, in->press[2]);
    p->wanted03 = (edge && !in->stop) || (!(in->stop || in->tripped[2]) && p->wanted03);
    ton(&p->delay03, p->wanted03 && out->running[1], 40 * MS, now);
    tof(&p->hold03, p->delay03.q, 100 * MS, now);
    tp(&p->horn03, edge, 80 * MS, now);
    ton(&p->missing03, p->hold03.q && !in->feedback[2], 900 * MS, now);
    ctu(&p->starts03, p->hold03.q, in->reset, 7);
    out->running[2] = p->hold03.q && !p->missing03.q;
    out->warning[2] = p->horn03.q;
    out->fault[2] = p->missing03.q || in->tripped[2];
    out->service[2] = p->starts03.q;
    /* Drive 04 */
    edge = rising(&p->edge04, in->press[3]);
    p->wanted04 = (edge && !in->stop) || (!(in->stop || in->tripped[3]) && p->wanted04);
    ton(&p->delay04, p->wanted04 && out->running[2], 50 * MS, now);
    tof(&p->hold04, p->delay04.q, 30 * MS, now);
    tp(&p->horn04, edge, 100 * MS, now);
    ton(&p->missing04, p->hold04.q && !in->feedback[3], 500 * MS, now);
    ctu(&p->starts04, p->hold04.q, in->reset, 8);
    out->running[3] = p->hold04.q && !p->missing04.q;
    out->warning[3] = p->horn04.q;
    out->fault[3] = p->missing04.q || in->tripped[3];
    out->service[3] = p->starts04.q;
    /* Drive 05 */
    edge = rising(&p->edge05, in->press[4]);
    p->wanted05 = (edge && !in->stop) || (!(in->stop || in->tripped[4]) && p->wanted05);
    ton(&p->delay05, p->wanted05 && out->running[3], 80 * MS, now);
    tof(&p->hold05, p->delay05.q, 60 * MS, now);
    tp(&p->horn05, edge, 160 * MS, now);
    ton(&p->missing05, p->hold05.q && !in->feedback[4], 700 * MS, now);
    ctu(&p->starts05, p->hold05.q, in->reset, 9);
    out->running[4] = p->hold05.q && !p->missing05.q;
    out->warning[4] = p->horn05.q;
    out->fault[4] = p->missing05.q || in->tripped[4];
    out->service[4] = p->starts05.q;
    /* Drive 06 */
    edge = rising(&p->edge06, in->press[5]);
    p->wanted06 = (edge && !in->stop) || (!(in->stop || in->tripped[5]) && p->wanted06);
    ton(&p->delay06, p->wanted06 && out->running[4], 120 * MS, now);
    tof(&p->hold06, p->delay06.q, 20 * MS, now);
    tp(&p->horn06, edge, 240 * MS, now);
    ton(&p->missing06, p->hold06.q && !in->feedback[5], 400 * MS, now);
    ctu(&p->starts06, p->hold06.q, in->reset, 10);
    out->running[5] = p->hold06.q && !p->missing06.q;
    out->warning[5] = p->horn06.q;
    out->fault[5] = p->missing06.q || in->tripped[5];
    out->service[5] = p->starts06.q;
    /* Drive 07 */
    edge = rising(&p->edge07, in->press[6]);
    p->wanted07 = (edge && !in->stop) || (!(in->stop || in->tripped[6]) && p->wanted07);
    ton(&p->delay07, p->wanted07 && out->running[5], 40 * MS, now);
    tof(&p->hold07, p->delay07.q, 100 * MS, now);
    tp(&p->horn07, edge, 80 * MS, now);
    ton(&p->missing07, p->hold07.q && !in->feedback[6], 900 * MS, now);
    ctu(&p->starts07, p->hold07.q, in->reset, 11);
    out->running[6] = p->hold07.q && !p->missing07.q;
    out->warning[6] = p->horn07.q;
    out->fault[6] = p->missing07.q || in->tripped[6];
    out->service[6] = p->starts07.q;
    /* Drive 08 */
    edge = rising(&p->edge08, in->press[7]);
    p->wanted08 = (edge && !in->stop) || (!(in->stop || in->tripped[7]) && p->wanted08);
    ton(&p->delay08, p->wanted08 && out->running[6], 50 * MS, now);
    tof(&p->hold08, p->delay08.q, 30 * MS, now);
    tp(&p->horn08, edge, 100 * MS, now);
    ton(&p->missing08, p->hold08.q && !in->feedback[7], 500 * MS, now);
    ctu(&p->starts08, p->hold08.q, in->reset, 12);
    out->running[7] = p->hold08.q && !p->missing08.q;
    out->warning[7] = p->horn08.q;
    out->fault[7] = p->missing08.q || in->tripped[7];
    out->service[7] = p->starts08.q;
    /* Drive 09 */
    edge = rising(&p->edge09, in->press[8]);
    p->wanted09 = (edge && !in->stop) || (!(in->stop || in->tripped[8]) && p->wanted09);
    ton(&p->delay09, p->wanted09 && out->running[7], 80 * MS, now);
    tof(&p->hold09, p->delay09.q, 60 * MS, now);
    tp(&p->horn09, edge, 160 * MS, now);
    ton(&p->missing09, p->hold09.q && !in->feedback[8], 700 * MS, now);
    ctu(&p->starts09, p->hold09.q, in->reset, 13);
    out->running[8] = p->hold09.q && !p->missing09.q;
    out->warning[8] = p->horn09.q;
    out->fault[8] = p->missing09.q || in->tripped[8];
    out->service[8] = p->starts09.q;
    /* Drive 10 */
    edge = rising(&p->edge10, in->press[9]);
    p->wanted10 = (edge && !in->stop) || (!(in->stop || in->tripped[9]) && p->wanted10);
    ton(&p->delay10, p->wanted10 && out->running[8], 120 * MS, now);
    tof(&p->hold10, p->delay10.q, 20 * MS, now);
    tp(&p->horn10, edge, 240 * MS, now);
    ton(&p->missing10, p->hold10.q && !in->feedback[9], 400 * MS, now);
    ctu(&p->starts10, p->hold10.q, in->reset, 14);
    out->running[9] = p->hold10.q && !p->missing10.q;
    out->warning[9] = p->horn10.q;
    out->fault[9] = p->missing10.q || in->tripped[9];
    out->service[9] = p->starts10.q;
    /* Drive 11 */
    edge = rising(&p->edge11, in->press[10]);
    p->wanted11 = (edge && !in->stop) || (!(in->stop || in->tripped[10]) && p->wanted11);
    ton(&p->delay11, p->wanted11 && out->running[9], 40 * MS, now);
    tof(&p->hold11, p->delay11.q, 100 * MS, now);
    tp(&p->horn11, edge, 80 * MS, now);
    ton(&p->missing11, p->hold11.q && !in->feedback[10], 900 * MS, now);
    ctu(&p->starts11, p->hold11.q, in->reset, 15);
    out->running[10] = p->hold11.q && !p->missing11.q;
    out->warning[10] = p->horn11.q;
    out->fault[10] = p->missing11.q || in->tripped[10];
    out->service[10] = p->starts11.q;
    /* Drive 12 */
    edge = rising(&p->edge12, in->press[11]);
    p->wanted12 = (edge && !in->stop) || (!(in->stop || in->tripped[11]) && p->wanted12);
    ton(&p->delay12, p->wanted12 && out->running[10], 50 * MS, now);
    tof(&p->hold12, p->delay12.q, 30 * MS, now);
    tp(&p->horn12, edge, 100 * MS, now);
    ton(&p->missing12, p->hold12.q && !in->feedback[11], 500 * MS, now);
    ctu(&p->starts12, p->hold12.q, in->reset, 16);
    out->running[11] = p->hold12.q && !p->missing12.q;
    out->warning[11] = p->horn12.q;
    out->fault[11] = p->missing12.q || in->tripped[11];
    out->service[11] = p->starts12.q;
    /* Drive 13 */
    edge = rising(&p->edge13, in->press[12]);
    p->wanted13 = (edge && !in->stop) || (!(in->stop || in->tripped[12]) && p->wanted13);
    ton(&p->delay13, p->wanted13 && out->running[11], 80 * MS, now);
    tof(&p->hold13, p->delay13.q, 60 * MS, now);
    tp(&p->horn13, edge, 160 * MS, now);
    ton(&p->missing13, p->hold13.q && !in->feedback[12], 700 * MS, now);
    ctu(&p->starts13, p->hold13.q, in->reset, 17);
    out->running[12] = p->hold13.q && !p->missing13.q;
    out->warning[12] = p->horn13.q;
    out->fault[12] = p->missing13.q || in->tripped[12];
    out->service[12] = p->starts13.q;
    /* Drive 14 */
    edge = rising(&p->edge14, in->press[13]);
    p->wanted14 = (edge && !in->stop) || (!(in->stop || in->tripped[13]) && p->wanted14);
    ton(&p->delay14, p->wanted14 && out->running[12], 120 * MS, now);
    tof(&p->hold14, p->delay14.q, 20 * MS, now);
    tp(&p->horn14, edge, 240 * MS, now);
    ton(&p->missing14, p->hold14.q && !in->feedback[13], 400 * MS, now);
    ctu(&p->starts14, p->hold14.q, in->reset, 18);
    out->running[13] = p->hold14.q && !p->missing14.q;
    out->warning[13] = p->horn14.q;
    out->fault[13] = p->missing14.q || in->tripped[13];
    out->service[13] = p->starts14.q;
    /* Drive 15 */
    edge = rising(&p->edge15, in->press[14]);
    p->wanted15 = (edge && !in->stop) || (!(in->stop || in->tripped[14]) && p->wanted15);
    ton(&p->delay15, p->wanted15 && out->running[13], 40 * MS, now);
    tof(&p->hold15, p->delay15.q, 100 * MS, now);
    tp(&p->horn15, edge, 80 * MS, now);
    ton(&p->missing15, p->hold15.q && !in->feedback[14], 900 * MS, now);
    ctu(&p->starts15, p->hold15.q, in->reset, 19);
    out->running[14] = p->hold15.q && !p->missing15.q;
    out->warning[14] = p->horn15.q;
    out->fault[14] = p->missing15.q || in->tripped[14];
    out->service[14] = p->starts15.q;
    /* Drive 16 */
    edge = rising(&p->edge16, in->press[15]);
    p->wanted16 = (edge && !in->stop) || (!(in->stop || in->tripped[15]) && p->wanted16);
    ton(&p->delay16, p->wanted16 && out->running[14], 50 * MS, now);
    tof(&p->hold16, p->delay16.q, 30 * MS, now);
    tp(&p->horn16, edge, 100 * MS, now);
    ton(&p->missing16, p->hold16.q && !in->feedback[15], 500 * MS, now);
    ctu(&p->starts16, p->hold16.q, in->reset, 20);
    out->running[15] = p->hold16.q && !p->missing16.q;
    out->warning[15] = p->horn16.q;
    out->fault[15] = p->missing16.q || in->tripped[15];
    out->service[15] = p->starts16.q;
}

BENCH_PROGRAM
