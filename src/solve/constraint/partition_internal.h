// Coordinate partitioning from inside: what its files share.
//
//     partition.c           accelerations, multipliers and speeds after jumps, by dense matrices
//     partition_choice.c    independent rows and dependent columns
//     partition_solver.c      the same in closed form, where that is sound
//     projection.c   onto the constraints
//     partition_rank.c     how near J is to losing rank
//     singularity_test_function.c      whether it has lost rank between two places
//     partition_inertia.c   what inertia some speeds have where others are free to follow
#ifndef CT_SOLVE_CONSTRAINT_PARTITION_INTERNAL_H
#define CT_SOLVE_CONSTRAINT_PARTITION_INTERNAL_H

#include "solve/constraint/partition.h"

static inline double *ct_partition_J(const struct ct_partition *s, int row, int column)
{
    return &s->m->J[(size_t)row + s->m->nrow * (size_t)column];
}

static inline bool ct_partition_has_redundant_rows(const struct ct_partition *s)
{
    return s->rank < (int)s->m->nrow;
}

/// LU of J_d and B = -J_d^-1 J_i (rank x free); false if J_d is singular.
bool ct_partition_factor(struct ct_partition *s);
/// The same at a place that need not be one of the motion: kappa and sigma of that stay.
bool ct_partition_factor_only(struct ct_partition *s);
/// S (free x free) = B' M B with the unit columns of the independent speeds, its lower triangle.
void ct_partition_reduce_mass(struct ct_partition *s, const double *M);
/// After ct_partition_accelerate with one freedom: B' M B against what its terms add up to before
/// motions that constraints forbid cancel.  (8.39)
double ct_partition_cancellation(const struct ct_partition *s);
/// Dense factors of larger systems cost more than a step does.
bool ct_partition_is_large(const struct ct_partition *s);

/// The form for the rows and columns of now: one from before, or a new one.
void ct_partition_select_solver(struct ct_partition *s);
/// Can the form of now be tried? Beside singular configurations only where it tells how near they
/// are.
bool ct_partition_is_solver_due(const struct ct_partition *s);
/// Were its pivots sound where it was used last?
bool ct_partition_is_sound(const struct ct_partition *s);
/// sigma from their strength, where that stands for it.
void ct_partition_update_sigma(struct ct_partition *s);
/// Multipliers of all rows by the form of now, where they are unique.
bool ct_partition_solver_multipliers(struct ct_partition *s);
/// After a projection, at the evaluator's input: checks the form of now, or makes one that is due.
void ct_partition_check_solver(struct ct_partition *s);

#endif
