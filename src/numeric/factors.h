// Factors of sparse matrices that share one pattern, real and complex: a named wrapper of KLU for what is factored often.
//
//     pattern   compressed columns, rows sorted, and an order of rows and columns: found once
//     factors   pivots and numbers of one matrix; the next one keeps the pivots while they are sound
//
// What always holds: where pivots are kept nothing is allocated, nor by solving. What the library allocates goes with the
// arena. Where it is not available no pattern has an order, and then nothing else of this is called.
// Source: Davis and Palamadai Natarajan (2010), key davis2010.
#ifndef CT_NUMERIC_FACTORS_H
#define CT_NUMERIC_FACTORS_H

#include "base/arena.h"

#include <stdbool.h>

/// An operation of sparse factors, and of a sum over a list, takes so many of full ones: measured where both take as long, with beams
/// of 2 to 8 elements, closed loops of them and a platform, of 16 to 40 equations.
#define CT_SPARSE_OPERATION_COST 1.25

struct ct_pattern {
    int n, nz;
    int *start, *row; // of columns (n + 1); (nz)
    double operations,
        fill; // of real factors: multiplications and additions, entries. After ct_pattern_order, or as estimated
    struct ct_pattern_order *order; // NULL: none
};

/// n x n, from nentry places (row[k], column[k]), of which some may be the same; place[k] (out): that of each among the nz.
struct ct_pattern *ct_pattern_create(struct ct_arena *a, int n, const int *row,
                                     const int *column, int nentry, int *place);
/// first (n, out): the nodes of a graph (its edges a pattern) in an order by which elimination adds few edges; what factors with
/// pivots on the diagonal take in that order. False where the library is not available.
bool ct_pattern_minimum_degree(struct ct_pattern *graph, int *first);
/// Rows and columns in the order `first` (n), pivots on or next to the diagonal; what factors of a matrix like this one (nz) take. False if
/// it is singular, or where the library is not available.
bool ct_pattern_order(struct ct_arena *a, struct ct_pattern *p, double *value, int *first);

struct ct_factors;

/// Room for the factors of a matrix of an ordered pattern.
struct ct_factors *ct_factors_create(struct ct_arena *a, const struct ct_pattern *p,
                                     bool is_complex);
/// Factor the matrix of these values, (nz) or as many pairs. The first time, and where those of before are no longer sound, pivots are
/// sought anew, which allocates. False if it is singular.
bool ct_factors_compute(struct ct_factors *f, double *value);
/// x (n numbers or pairs, in: right-hand side, out: solution).
void ct_factors_solve(struct ct_factors *f, double *x);
/// z (nz, out): for each entry (i, j) of the pattern the entry (j, i) of the inverse, of real factors. Allocates where pivots were
/// sought anew since the last time.
void ct_factors_inverse(struct ct_factors *f, double *z);
/// How often pivots were sought.
long ct_factors_npivoting(const struct ct_factors *f);

#endif
