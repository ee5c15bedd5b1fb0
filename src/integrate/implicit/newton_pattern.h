// The symbolic analysis of the sparse Newton matrix, shared by newton_pattern.c and
// newton_sparse.c.
#ifndef CT_INTEGRATE_IMPLICIT_NEWTON_PATTERN_H
#define CT_INTEGRATE_IMPLICIT_NEWTON_PATTERN_H

#include "integrate/implicit/newton_sparse.h"
#include "numeric/factors.h"

// Definition: the matrix is S + x X + (y or z) W; the values of the three parts are stored in turn.
enum { CT_NEWTON_PARTS = 3 };

// Entries are sums of terms +-v[a], -v[a] v[b] and +-v[a] w[b]/2, for the list of values v.
struct ct_newton_copy {
    int target, a;
    double sign;
};
struct ct_newton_product {
    int target, a, b;
};
struct ct_newton_rotation {
    int target, a, speed;
    double half;
};

struct ct_newton_list {
    const int *row, *column;
    const int *start; // of K, C, M, R: entries of row i from start[i] to start[i + 1]
    int first, n;     // among the values
};

struct ct_newton_pattern {
    const struct ct_jacobian_pattern *jacobian_pattern;
    struct ct_newton_list K, C, M, R, D,
        J; // rows of K, C, M, R after nu belong to auxiliary unknowns
    int nu, most_rows, n, nvalue;
    int nauxiliary, first_auxiliary; // unknowns in turn: nu, rows twice or once, auxiliary
    const int *M_start,
        *M_entry; // entries of M by column, with auxiliary unknowns
    bool is_stabilised;
    struct ct_pattern *pattern;
    // diagonal entries after nu: ones of unused constraint rows, for eta and for lam; the -1 of
    // auxiliary unknowns
    int *index;
    struct ct_newton_copy *copy; // those of M first
    struct ct_newton_product *product;
    struct ct_newton_rotation *rotation;
    size_t ncopy, nproduct, nrotation, copy_cap, product_cap, rotation_cap;
};

/// Does a row belong to a speed or an auxiliary unknown, where K has the factor y? Else it belongs
/// to a constraint.
static inline bool ct_newton_pattern_is_force(const struct ct_newton_pattern *p, int row)
{
    return row < p->nu || row >= p->first_auxiliary;
}

/// A (3 nz, out) = S, X, W from the lists v and the speeds w of rotations (or NULL).
void ct_newton_pattern_assemble(const struct ct_newton_pattern *p, double *A, const double *v,
                                const double *w);
/// G (nz, out): the matrix for c and e.
void ct_newton_pattern_form(const struct ct_newton_pattern *p, double *G, const double *A,
                            double c, double e);

#endif
