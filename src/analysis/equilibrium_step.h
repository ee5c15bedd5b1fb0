// Interface of the steps in a search for equilibrium, with a dense version for small systems
// and a sparse one for large systems.
#ifndef CT_ANALYSIS_EQUILIBRIUM_STEP_H
#define CT_ANALYSIS_EQUILIBRIUM_STEP_H

#include "analysis/equilibrium.h"
#include "analysis/sparse_linearization.h"

/// Longest rotation in one step [rad].
/// Default: shorter steps are more steps; longer ones may jump to another equilibrium.
/// Test: equilibria
static const double ct_largest_rotation_step = 0.2;

/// Which coordinates are angles? (nu)
bool *ct_equilibrium_turns(const struct ct_linear *l);
/// Reports that no equilibrium is found because speed k goes on to move. Returns false.
bool ct_equilibrium_report_missing(const struct ct_linear *l, int k);

struct ct_equilibrium_search {
    struct ct_linear *l;
    const struct ct_equilibrium_method *method;
    double *dq, *dlam;           // the step: nu, nrow
    bool is_newton;              // no direction is unstable: the step is Newton's
    double length;               // present limit of translation in a step [m]
    bool *turns;                 // nu: is the coordinate an angle?
    struct ct_kept_state before; // the step
    // dense
    double *scale; // nfree: magnitude of the terms that each force sums
    double *gross; // nu: the same for each row of the full equations
    // stiffness; its eigenvectors in the metric of the mass matrix; eigenvalues
    double *H, *V, *value;
    double *A, *work; // nfree x nfree
    int *pivot;
    // sparse
    struct ct_point *p;
    double *b, *x; // nu + nrow
};

struct ct_equilibrium_method {
    void (*reserve)(struct ct_equilibrium_search *s);
    /// Evaluates forces and stiffness at the position in l. False if they are not finite or the
    /// constraints are singular.
    bool (*evaluate)(struct ct_equilibrium_search *s);
    /// dq, dlam (out): a step that descends the potential. False if there is none.
    bool (*find_step)(struct ct_equilibrium_search *s);
    /// dq, dlam (out): Newton's step. False if the stiffness is singular.
    bool (*find_newton_step)(struct ct_equilibrium_search *s);
    /// The derivative of the potential along dq: minus the work of the forces.
    double (*slope)(const struct ct_equilibrium_search *s);
    /// Are the remaining forces round-off of their terms?
    bool (*is_balanced)(struct ct_equilibrium_search *s);
};

extern const struct ct_equilibrium_method ct_equilibrium_dense, ct_equilibrium_sparse;

#endif
