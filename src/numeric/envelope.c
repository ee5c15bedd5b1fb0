// See envelope.h.
#include "numeric/envelope.h"

#include <math.h>

struct ct_envelope ct_envelope_create(struct ct_arena *a, const int *first, int n)
{
    const size_t size = (size_t)n;
    struct ct_envelope e = {
        .n = n, .first = CT_NEWN(a, int, size + 1), .diagonal = CT_NEWN(a, size_t, size + 1)};
    size_t nvalue = 0;
    for (int i = 0; i < n; i++) {
        e.first[i] = first[i];
        nvalue += (size_t)(i - first[i]) + 1;
        e.diagonal[i] = nvalue - 1;
    }
    e.value = CT_NEWN(a, double, nvalue + 1);
    return e;
}

// Row by row; entry (i, j) takes the products of the columns before it, in their order.
int ct_envelope_cholesky(struct ct_envelope *e)
{
    for (int i = 0; i < e->n; i++) {
        double *row = e->value + e->diagonal[i] - (i - e->first[i]);
        for (int j = e->first[i]; j <= i; j++) {
            const int from = e->first[i] > e->first[j] ? e->first[i] : e->first[j];
            const double *a = row + (from - e->first[i]), *b = ct_envelope_at(e, j, from);
            double *entry = row + (j - e->first[i]);
            for (int k = 0; k < j - from; k++)
                *entry -= a[k] * b[k];
            if (j < i)
                *entry /= *ct_envelope_at(e, j, j);
        }
        double *pivot = ct_envelope_at(e, i, i);
        if (!(*pivot > 0) || isinf(*pivot)) // negated comparison: rejects NaN too
            return i;
        *pivot = sqrt(*pivot);
    }
    return e->n;
}
