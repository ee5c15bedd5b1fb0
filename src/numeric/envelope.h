// Cholesky factors of sparse symmetric matrices within their envelope.
//
//     row i   (i, first_i) ... (i, i)     nothing before the first entry of a row becomes nonzero
//
// Source: George and Liu (1981), key george1981.
#ifndef CT_NUMERIC_ENVELOPE_H
#define CT_NUMERIC_ENVELOPE_H

#include "base/arena.h"

/// The lower triangle of a matrix (n x n).
struct ct_envelope {
    int n, *first;    // (n) column of the first entry of a row
    size_t *diagonal; // (n) place of the entry on the diagonal
    double *value;    // by rows
};

/// The zero matrix with this envelope, 0 <= first[i] <= i; it lives in a.
struct ct_envelope ct_envelope_create(struct ct_arena *a, const int *first, int n);

/// Entry (i, j) with first_i <= j <= i.
static inline double *ct_envelope_at(const struct ct_envelope *e, int i, int j)
{
    return &e->value[e->diagonal[i] - (size_t)(i - j)];
}

/// Cholesky A = L L' in place, up to the first pivot that is not positive, which is kept instead
/// of its root. Returns the number of pivots before it, n if all are positive.
int ct_envelope_cholesky(struct ct_envelope *e);

#endif
