// Inertia of some speeds while others are free: pivots of B' M B after elimination of the
// others. See partition.h.
#include "solve/constraint/partition_internal.h"

#include <math.h>

// Order of elimination (f, out) of the independent speeds: free ones first.
static void find_order(const struct ct_partition *s, const bool *follows, int f, int *order)
{
    int n = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < f; i++)
            if (follows[s->independent[i]] == !pass)
                order[n++] = i;
}

bool ct_partition_inertias(struct ct_partition *s, const bool *follows, double *inertia)
{
    const int f = (int)s->m->nu - s->rank;
    double *const S = s->S;
    for (size_t k = 0; k < s->m->nu; k++)
        inertia[k] = NAN;
    if (s->rank && !ct_partition_factor(s))
        return false;
    ct_partition_reduce_mass(s, ct_partition_mass(s));
    for (int j = 0; j < f; j++)
        for (int i = 0; i < j; i++)
            S[i + f * j] = S[j + f * i];
    find_order(s, follows, f, s->iwork);
    for (int k = 0; k < f; k++) {
        const int p = s->iwork[k];
        const double pivot = S[p + f * p];
        if (!follows[s->independent[p]])
            inertia[s->independent[p]] = pivot;
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
