// The steps that a search for an equilibrium asks for: dense for small systems, sparse for
// large ones.
#ifndef CT_ANALYSIS_EQUILIBRIUM_STEP_H
#define CT_ANALYSIS_EQUILIBRIUM_STEP_H

#include "analysis/equilibrium.h"
#include "analysis/sparse_linearization.h"

struct ct_equilibrium_search {
    struct ct_linear *l;
    const struct ct_equilibrium_method *method;
    double *dq, *dlam; // the step: nu, nrow
    bool is_newton;    // nothing is unstable: the step is that of Newton's method
    double length;     // limit of lengths in a step now [m]
    bool *turns;       // nu: coordinates that are angles
    double *kept_y, *kept_lam, *kept_memory;
    // dense
    double *scale;         // nfree: sizes of the forces that meet in each direction
    double *gross;         // nu: the same of each row
    double *H, *V, *value; // stiffness; its directions against the masses and their values
    double *A, *work;      // nfree x nfree
    int *pivot;
    // sparse
    struct ct_point *p;
    double *b, *x; // nu + nrow
};

struct ct_equilibrium_method {
    void (*reserve)(struct ct_equilibrium_search *s);
    /// Forces and stiffness at the place in l. False if they are not finite or the constraints
    /// are singular.
    bool (*evaluate)(struct ct_equilibrium_search *s);
    /// dq, dlam (out): a step down the forces. False where there is none.
    bool (*find_step)(struct ct_equilibrium_search *s);
    /// dq, dlam (out): Newton's step. False where the stiffness is singular.
    bool (*find_newton_step)(struct ct_equilibrium_search *s);
    /// The slope of the energy along dq: less the work of the forces.
    double (*slope)(const struct ct_equilibrium_search *s);
    /// Nothing but round-off is left of the forces that meet.
    bool (*is_balanced)(struct ct_equilibrium_search *s);
};

extern const struct ct_equilibrium_method ct_equilibrium_dense, ct_equilibrium_sparse;

#endif
