// Sparse LU of many matrices with one sparsity pattern, real or complex: a named wrapper of KLU.
//
//     pattern   compressed columns, rows sorted, with a fill-reducing order: analysed once
//     factors   L, U and pivots of one matrix; the next matrix is refactored with the same pivots
//               while the pivot growth is acceptable, else pivots are searched again
//
// What always holds: refactoring with the same pivots and solving allocate nothing. What KLU
// allocates is freed with the arena. Without KLU no pattern has an order, and factors are not used.
// Source: Davis and Palamadai Natarajan (2010), key davis2010.
#ifndef CT_NUMERIC_FACTORS_H
#define CT_NUMERIC_FACTORS_H

#include "base/arena.h"

#include <stdbool.h>

/// Cost of an operation on sparse factors (indirect addressing) in operations on dense ones. Only a
/// choice between two exact solvers depends on it. Measured at equal run times, 16 to 40 equations.
/// Derived: from that measurement.
#define CT_SPARSE_OPERATION_COST 1.25

struct ct_pattern {
    int n, nz;
    int *start, *row; // of columns (n + 1); (nz)
    double operations,
        // of real factors: multiplications and additions, entries. After ct_pattern_order, or as
        // estimated
        fill;
    struct ct_pattern_order *order; // NULL: none
};

/// Pattern (n x n) of nentry entries (row[k], column[k]), duplicates allowed. place[k] (out): index
/// of entry k among the nz stored ones.
struct ct_pattern *ct_pattern_create(struct ct_arena *a, int n, const int *row,
                                     const int *column, int nentry, int *place);
/// Approximate minimum degree order of a graph given as a pattern: first (n, out). Sets operations
/// and fill of a factorisation with diagonal pivots in that order. False without KLU.
bool ct_pattern_minimum_degree(struct ct_pattern *graph, int *first);
/// Analyse rows and columns in the order `first` (n), with pivots on or near the diagonal. Sets
/// operations and fill by factoring one matrix (nz values). False if it is singular, or without
/// KLU.
bool ct_pattern_order(struct ct_arena *a, struct ct_pattern *p, double *value, int *first);

struct ct_factors;

/// Room for the factors of a matrix of an ordered pattern.
struct ct_factors *ct_factors_create(struct ct_arena *a, const struct ct_pattern *p,
                                     bool is_complex);
/// Factor the matrix of these values, nz numbers or (re, im) pairs. The first time, and when the
/// growth with the old pivots is too large, pivots are chosen, which allocates: those of the diagonal, or searched ones
/// where growth is too large with these. False if singular.
bool ct_factors_compute(struct ct_factors *f, double *value);
/// x (n numbers or pairs, in: right-hand side, out: solution).
void ct_factors_solve(struct ct_factors *f, double *x);
/// z (nz, out): entry (j, i) of the inverse for each entry (i, j) of the pattern; real factors
/// only. Allocates if pivots were searched since the last call.
void ct_factors_inverse(struct ct_factors *f, double *z);
/// Entries of the last factors.
double ct_factors_fill(const struct ct_factors *f);
/// How often pivots were chosen.
long ct_factors_npivoting(const struct ct_factors *f);

#endif
