// Eight lanes as two halves of four; see native_wide.h. The work array holds the workspace of each
// half, then the inputs and outputs of four lanes.
#include "codegen/native_wide.h"

#include <string.h>

enum { HALF = CT_NATIVE_WIDE_LANES / 2 }; // Definition: lanes of a half

struct ct_native_wide {
    const struct ct_native *four;
    size_t nwork;         // doubles of the workspace of a half
    const uint32_t *slot; // slots of inputs that are read (nslot)
    size_t nslot, ninput; // ninput: one more than the largest slot
    size_t nout;
};

struct ct_native_wide *ct_native_wide_create(struct ct_arena *a, const struct ct_native *four,
                                             const struct ct_listing *l)
{
    struct ct_native_wide *p = CT_NEW(a, struct ct_native_wide);
    uint32_t *slot = CT_NEWN(a, uint32_t, l->nvalue + 1);
    *p = (struct ct_native_wide){
        .four = four, .nwork = ct_native_work(four), .slot = slot, .nout = l->nout};
    for (size_t v = 0; v < l->nvalue; v++)
        if (l->input[v] != CT_VALUE_NONE) {
            slot[p->nslot++] = l->input[v];
            if (l->input[v] >= p->ninput)
                p->ninput = l->input[v] + 1;
        }
    return p;
}

size_t ct_native_wide_work(const struct ct_native_wide *p)
{
    return 2 * p->nwork + HALF * (p->ninput + p->nout);
}

// Copy the inputs of one half to contiguous memory.
static double *take_half(const struct ct_native_wide *p, const double *input, size_t half,
                         double *work)
{
    double *in = work + 2 * p->nwork;
    for (size_t i = 0; i < p->nslot; i++)
        memcpy(in + HALF * (size_t)p->slot[i],
               input + CT_NATIVE_WIDE_LANES * (size_t)p->slot[i] + HALF * half,
               HALF * sizeof *in);
    return in;
}

void ct_native_wide_prepare(const struct ct_native_wide *p, const double *input, double *work)
{
    for (size_t half = 0; half < 2; half++)
        ct_native_prepare(p->four, take_half(p, input, half, work), work + half * p->nwork);
}

void ct_native_wide_eval(const struct ct_native_wide *p, const double *input, double *out,
                         double *work)
{
    double *four = work + 2 * p->nwork + HALF * p->ninput;
    for (size_t half = 0; half < 2; half++) {
        ct_native_eval(p->four, take_half(p, input, half, work), four, work + half * p->nwork);
        for (size_t k = 0; k < p->nout; k++)
            memcpy(out + CT_NATIVE_WIDE_LANES * k + HALF * half, four + HALF * k,
                   HALF * sizeof *out);
    }
}
