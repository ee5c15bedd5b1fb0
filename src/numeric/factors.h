// Sparse LU of many matrices with one sparsity pattern, real or complex: a named wrapper of KLU.
//
//     pattern   compressed columns, rows sorted, with a fill-reducing order: analysed once
//     factors   L, U and pivots of one matrix; the next matrix is refactored with the same pivots
//               while the pivot growth is acceptable, else new pivots are searched for
//
// What always holds: refactoring with the same pivots and solving do not allocate. Memory allocated
// by KLU is freed with the arena. Without KLU no pattern gets an order, and factors are not used.
// Source: Davis and Palamadai Natarajan (2010), key davis2010.
#ifndef CT_NUMERIC_FACTORS_H
#define CT_NUMERIC_FACTORS_H

#include "base/arena.h"

#include <stdbool.h>

/// Cost of an operation on sparse factors (indirect addressing) relative to one on dense factors.
/// It only decides between two exact solvers. Derived: measured ratio of operations at equal run
/// time, for 16 to 40 equations.
#define CT_SPARSE_OPERATION_COST 1.25

struct ct_pattern {
    int n, nz;
    int *start, *row; // of columns (n + 1); (nz)
    double operations,
        // of real factors: multiplications and additions; number of entries. Known after
        // ct_pattern_order; before, an estimate
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
/// Factor the matrix with these values: nz numbers or (re, im) pairs. Pivots are chosen at the
/// first call and whenever growth with the old pivots is too large; this allocates. Diagonal pivots
/// are tried first, threshold partial pivoting if their growth is too large. False if singular.
bool ct_factors_compute(struct ct_factors *f, double *value);
/// x (n numbers or pairs, in: right-hand side, out: solution).
void ct_factors_solve(struct ct_factors *f, double *x);
/// z (nz, out): entry (j, i) of the inverse for each entry (i, j) of the pattern; real factors
/// only. Allocates if new pivots were chosen since the last call.
void ct_factors_inverse(struct ct_factors *f, double *z);
/// Number of entries of the last factors.
double ct_factors_fill(const struct ct_factors *f);
/// Number of times pivots were chosen.
long ct_factors_npivoting(const struct ct_factors *f);

#endif
