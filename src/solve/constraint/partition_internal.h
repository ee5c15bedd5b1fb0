// Coordinate partitioning: declarations that its files share.
//
//     partition.c                   accelerations, multipliers, impulses, by dense matrices
//     partition_choice.c            choice of independent rows and dependent columns
//     partition_solver.c            accelerations by solvers with a fixed order of pivots
//     projection.c                  projection onto the constraints
//     partition_rank.c              how near J is to losing rank
//     singularity_test_function.c   whether J has lost rank between two states
//     partition_inertia.c           inertia of some speeds while others are free to follow
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
/// The same in a configuration that need not be on the motion: kappa and sigma are kept.
bool ct_partition_factor_only(struct ct_partition *s);
/// S (free x free) = the lower triangle of [B; 1]' M [B; 1], the reduced mass matrix.
void ct_partition_reduce_mass(struct ct_partition *s, const double *M);
/// After ct_partition_accelerate with one degree of freedom: B' M B divided by the sum of its
/// diagonal terms. It is small if terms cancel.  (8.39)
double ct_partition_cancellation(const struct ct_partition *s);
/// Is the system so large that dense factors cost more than a step?
bool ct_partition_is_large(const struct ct_partition *s);

/// Select the solver for the present rows and columns: a kept one, or a new one.
void ct_partition_select_solver(struct ct_partition *s);
/// May the present solver be tried? Near singular configurations only if its strength gives sigma.
bool ct_partition_is_solver_due(const struct ct_partition *s);
/// Were its pivots sound when it was used last?
bool ct_partition_is_sound(const struct ct_partition *s);
/// Update sigma from the strength, if the two change alike.
void ct_partition_update_sigma(struct ct_partition *s);
/// Multipliers of all rows by the present solver; false if they are not unique or it is not sound.
bool ct_partition_solver_multipliers(struct ct_partition *s);
/// After a projection, at the evaluator's input: check the present solver, or make one that is due.
void ct_partition_check_solver(struct ct_partition *s);

#endif
