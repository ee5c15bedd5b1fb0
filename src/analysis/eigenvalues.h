// Natural motions of linearised equations: eigenvalues and shapes.  (section 9.4)
#ifndef CT_ANALYSIS_EIGENVALUES_H
#define CT_ANALYSIS_EIGENVALUES_H

#include "analysis/linearization.h"

/// A motion dq(t) = Re(shape exp(s t)), s = re + i im, im >= 0: a pair of eigenvalues or a real
/// one.
struct ct_motion_mode {
    double re, im; // [1/s]
    bool is_rigid; // nothing resists: s = 0
    double *shape; // 2 nu: real parts, then imaginary parts; the largest entry is 1
};

/// All modes of the reduced equations of l by |s|, of equal ones the growing one first. The
/// list lives in a. How they were found: *how. Errors: CT_E_SINGULAR when the equations
/// determine no motion.
bool ct_modes_solve(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_linear *l,
                    struct ct_motion_mode **mode, size_t *nmode, const char **how);

/// What round-off may leave of a real part among all the modes of a system [1/s] (theory 9.3),
/// and the largest of their rates.
double ct_modes_roundoff(const struct ct_motion_mode *mode, size_t nmode, double *fastest);

/// The modes of an eigenvalue w2 [1/s^2] of K y = w2 M y with the shape in the real part of
/// `shape` (2 nu): one, or of a negative w2 two. mode has room for them.
void ct_mode_add_undamped(struct ct_motion_mode *mode, size_t *nmode, double w2, double *shape,
                          int nu);
/// In the order of ct_modes_solve.
void ct_modes_sort(struct ct_arena *a, struct ct_motion_mode *mode, size_t nmode);

/// The smallest eigenvalue w2 [1/s^2] of (Kr, Mr), both made symmetric, massless coordinates
/// condensed, and its shape y (nfree, out). 0 for a rigid-body motion. INFINITY without
/// freedoms that move mass.
double ct_stiffness_least(struct ct_arena *a, const struct ct_linear *l, double *y);

#endif
