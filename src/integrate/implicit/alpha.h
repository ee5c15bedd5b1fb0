// The generalised-alpha family of methods on Lie groups: the step that all members share.  (8.1),
// (8.4)
//
//     r(t1, q1, u1, u1', lam1) = 0,   (1 - alpha_m) a1 + alpha_m a0 = (1 - alpha_f) u1' + alpha_f u0'
//     q1 = q0 (+) h [ u0 + h (1/2 - beta) a0 + h beta a1 ] + J' eta
//     u1 = u0 + h (1 - gamma) a0 + h gamma a1
//
// with Phi(q1) = 0 and, stabilised, v1 = 0; without stabilisation eta = 0. The variable a
// approximates the acceleration at t + (alpha_m - alpha_f) h.
#ifndef CT_INTEGRATE_IMPLICIT_ALPHA_H
#define CT_INTEGRATE_IMPLICIT_ALPHA_H

#include "integrate/stepper.h"

/// Order 2 if gamma = 1/2 + alpha_f - alpha_m.
struct ct_alpha {
    double alpha_m, alpha_f, beta, gamma;
    bool is_stabilised;
    /// Each step starts with a from the equations of motion; for alpha_m = alpha_f = 0, where a is
    /// the acceleration.
    bool starts_anew;
};

void *ct_alpha_create(struct ct_arena *a, const struct ct_method *method,
                      const struct ct_problem *p);
void ct_alpha_restart(void *work);
void ct_alpha_accept(void *work);
enum ct_eval ct_alpha_step(const struct ct_problem *p, double t, double h, const double *y,
                           const double *dy, const struct ct_tolerance *tolerance, double *y1,
                           double *dy1, double *err, void *work,
                           struct ct_integrate_stats *stats);
void ct_alpha_dense(const struct ct_problem *p, double h, double theta, const double *y,
                    const double *y1, void *work, double *out);

// The entries of ct_method that all members share. Step size control as in (8.3).
#define CT_ALPHA_METHOD                                                                        \
    .order = 2, .error_order = 2, .is_implicit = true, .most_growth = 2,                       \
    .kept_range = {0.8, 1.3}, .create = ct_alpha_create, .restart = ct_alpha_restart,          \
    .accept = ct_alpha_accept, .step = ct_alpha_step, .dense = ct_alpha_dense

#endif
