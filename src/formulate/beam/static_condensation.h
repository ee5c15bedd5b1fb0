// Static condensation: rotations of nodes without inertia and moment as functions of the other
// freedoms.
#ifndef CT_FORMULATE_BEAM_STATIC_CONDENSATION_H
#define CT_FORMULATE_BEAM_STATIC_CONDENSATION_H

#include "formulate/beam/degrees_of_freedom.h"

/// Numerical data for the condensation (static_condensation.c).
struct ct_condensation_numbers {
    // 8 per node; number not fixed; number not condensed, which come first
    int nfreedom, n, nkept;
    const int *freedom;  // by number
    const double *K, *L; // n x n; Cholesky factor of the condensed block
    bool is_balanced; // is_balanced: only linear elements act on them, for all parameter values
};
/// Equilibrium of a condensed rotation r: r + sum by v = 0, v of other freedoms, condensed or not.
struct ct_condensation_term {
    int freedom;
    double by;
};
/// Number of condensed rotations; index of a freedom among them, -1: not condensed; equation of
/// number k.
int ct_condensation_count(const struct ct_flexible *f);
int ct_condensation_number(const struct ct_flexible *f, int freedom);
const struct ct_condensation_term *ct_condensation_equilibrium(const struct ct_flexible *f,
                                                               int k, int *n);
struct ct_condensation *ct_condensation_create(struct ct_build *b,
                                               const struct ct_condensation_numbers *c);
/// Derives values, rates and accelerations of the condensed rotations.
void ct_condensation_values(struct ct_build *b, struct ct_flexible *f);
/// Fills in the condensed rotations for values or rates v of the freedoms (by freedom; in: zero if
/// condensed).
void ct_condensation_extend(struct ct_exs *x, const struct ct_condensation *s, ct_ex *v);
/// Distributes forces on them to the other freedoms (force: by freedom; out: zero if condensed).
void ct_condensation_forces(struct ct_exs *x, const struct ct_condensation *s, ct_ex *force);
/// Number of products of one such pass.
size_t ct_condensation_products(const struct ct_condensation *s);
/// Are stiffness and damping forces on a freedom zero because it is condensed?
bool ct_freedom_is_balanced(const struct ct_flexible *f, int freedom);

#endif
