// Natural modes of the linearised equations: eigenvalues and shapes (section 9.4).
#ifndef CT_ANALYSIS_EIGENVALUES_H
#define CT_ANALYSIS_EIGENVALUES_H

#include "analysis/linearization.h"

/// A motion dq(t) = Re(shape exp(s t)) with s = re + i im and im >= 0: a pair of complex
/// eigenvalues or one real eigenvalue.
struct ct_motion_mode {
    double re, im; // [1/s]
    bool is_rigid; // a rigid-body motion: s = 0
    double *shape; // 2 nu: real parts, then imaginary parts; largest entry 1
};

/// Computes all modes of the reduced equations of l, in ascending order of |s|;
/// of equal |s| the growing mode comes first. The list lives in a. *how describes the method
/// used. Errors: CT_E_SINGULAR if the equations do not determine the motion.
bool ct_modes_solve(struct ct_ctx *ctx, struct ct_arena *a, const struct ct_linear *l,
                    struct ct_motion_mode **mode, size_t *nmode, const char **how);

/// Returns a bound of the round-off in the real parts of the modes of a system [1/s] (theory
/// 9.3), and the largest of their rates |s| in *fastest [1/s].
double ct_modes_roundoff(const struct ct_motion_mode *mode, size_t nmode, double *fastest);

/// Adds the mode of an eigenvalue w2 [1/s^2] of K y = w2 M y, or two modes (growing and
/// decaying) if w2 is negative. The shape is in the first nu entries of `shape` (2 nu). mode
/// must have room for two more.
void ct_mode_add_undamped(struct ct_motion_mode *mode, size_t *nmode, double w2, double *shape,
                          int nu);
/// Sorts modes in the order of ct_modes_solve.
void ct_modes_sort(struct ct_arena *a, struct ct_motion_mode *mode, size_t nmode);

/// Returns the smallest eigenvalue w2 [1/s^2] of (Kr, Mr), both made symmetric and with
/// massless coordinates condensed, and its shape y (nfree, out). It is 0 for a rigid-body
/// motion, and INFINITY if no coordinate moves mass.
double ct_stiffness_least(struct ct_arena *a, const struct ct_linear *l, double *y);

#endif
