// Inertia that is left to some speeds while others are free to follow; see partition_internal.h.
#include "solve/constraint/partition_internal.h"

#include <math.h>

// Order of elimination (f, out) of the independent speeds: those that follow come first.
static void order(const struct ct_partition *s, const bool *follows, int f, int *place)
{
    int n = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < f; i++)
            if (follows[s->independent[i]] == !pass)
                place[n++] = i;
}

bool ct_partition_inertias(struct ct_partition *s, const bool *follows, double *left)
{
    const int f = (int)s->m->nu - s->rank;
    double *const S = s->S;
    for (size_t k = 0; k < s->m->nu; k++)
        left[k] = NAN;
    if (s->rank && !ct_partition_factor(s))
        return false;
    ct_partition_reduce_mass(s, s->m->M);
    for (int j = 0; j < f; j++)
        for (int i = 0; i < j; i++)
            S[i + f * j] = S[j + f * i];
    order(s, follows, f, s->iwork);
    for (int k = 0; k < f; k++) {
        const int p = s->iwork[k];
        const double pivot = S[p + f * p];
        if (!follows[s->independent[p]])
            left[s->independent[p]] = pivot;
        if (!(pivot > 0))
            return true;
        for (int j = k + 1; j < f; j++) {
            const int c = s->iwork[j];
            const double part = S[p + f * c] / pivot;
            for (int i = k + 1; i < f; i++)
                S[s->iwork[i] + f * c] -= S[s->iwork[i] + f * p] * part;
        }
    }
    return true;
}
