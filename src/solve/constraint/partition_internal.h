// Coordinate partitioning: declarations shared by its files.
//
//     partition.c          accelerations, multipliers, impulses, by dense matrices
//     partition_choice.c   choice of independent rows and dependent columns
//     partition_solver.c   accelerations by solvers with a fixed order of pivots
//     projection.c         projection onto the constraints
//     partition_rank.c     distance of J from loss of rank
//     partition_inertia.c  inertia of some speeds while others are free
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
/// The same at a trial configuration: kappa and sigma of the motion are kept.
bool ct_partition_factor_only(struct ct_partition *s);
/// S (free x free) = the lower triangle of [B; 1]' M [B; 1], the reduced mass matrix.
void ct_partition_reduce_mass(struct ct_partition *s, const double *M);
/// After ct_partition_accelerate with one degree of freedom: B' M B divided by the sum of its
/// diagonal terms. Cancellation makes it small.  (8.39)
double ct_partition_cancellation(const struct ct_partition *s);
/// Do dense factors cost more than a step?
bool ct_partition_is_large(const struct ct_partition *s);

/// Select the solver for the present rows and columns: a stored one, or a new one.
void ct_partition_select_solver(struct ct_partition *s);
/// May the present solver be used? Near singular configurations only if its strength gives
/// sigma.
bool ct_partition_is_solver_due(const struct ct_partition *s);
/// Were its pivots large enough when it was used last?
bool ct_partition_is_sound(const struct ct_partition *s);
/// Update sigma from the strength if both change by the same factor.
void ct_partition_update_sigma(struct ct_partition *s);
/// Multipliers of all rows by the present solver; false if they are not unique or inaccurate.
bool ct_partition_solver_multipliers(struct ct_partition *s);
/// After a projection, at the evaluator's input: check the present solver, or make one where
/// due.
void ct_partition_check_solver(struct ct_partition *s);

#endif
