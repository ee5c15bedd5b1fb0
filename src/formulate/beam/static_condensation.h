// Rotations of nodes without inertia and moment follow the other freedoms by static condensation.
#ifndef CT_FORMULATE_BEAM_STATIC_CONDENSATION_H
#define CT_FORMULATE_BEAM_STATIC_CONDENSATION_H

#include "formulate/beam/degrees_of_freedom.h"

/// Numbers of freedoms that follow (static_condensation.c).
struct ct_condensation_numbers {
    int nfreedom, n, nkept; // 8 per node; not fixed; of these those that do not follow, first
    const int *freedom;     // by number
    const double *K, *L;    // n x n; Cholesky factor of the block of those that follow
    bool
        is_balanced; // nothing but linear elements acts on them, now and whatever parameters are
};
/// One that follows satisfies r + sum by v = 0, v of other freedoms, whether these follow or not.
struct ct_condensation_term {
    int freedom;
    double by;
};
/// How many follow; the number of one, -1: it does not; the sum of number k.
int ct_condensation_count(const struct ct_flexible *f);
int ct_condensation_number(const struct ct_flexible *f, int freedom);
const struct ct_condensation_term *ct_condensation_law(const struct ct_flexible *f, int k,
                                                       int *n);
struct ct_condensation *ct_condensation_create(struct ct_build *b,
                                               const struct ct_condensation_numbers *c);
/// Values, rates and accelerations of the freedoms that follow.
void ct_condensation_values(struct ct_build *b, struct ct_flexible *f);
/// What they do while the freedoms, or their rates, are v (by freedom; in: zero where one follows).
void ct_condensation_extend(struct ct_exs *x, const struct ct_condensation *s, ct_ex *v);
/// Forces on them, handed to the others (force: by freedom; out: zero where one follows).
void ct_condensation_forces(struct ct_exs *x, const struct ct_condensation *s, ct_ex *force);
/// Products that this takes.
size_t ct_condensation_products(const struct ct_condensation *s);
/// Do stiffness and damping leave no force on a freedom, since it follows?
bool ct_freedom_is_balanced(const struct ct_flexible *f, int freedom);

#endif
