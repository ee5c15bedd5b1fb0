// Functions shared by one-step methods: linear combinations of stages, compensated summation, the
// error norm, Hermite interpolation.
#ifndef CT_INTEGRATE_STEPPER_H
#define CT_INTEGRATE_STEPPER_H

#include "integrate/problem.h"

/// fmin and fmax without a function call; b where a is NaN.
static inline double ct_smaller(double a, double b)
{
    return a < b ? a : b;
}
static inline double ct_larger(double a, double b)
{
    return a > b ? a : b;
}

/// out (n) = v. States are short: volatile keeps the compiler from calling memcpy, which takes
/// longer than the loop.
static inline void ct_stepper_copy(double *out, const volatile double *v, int n)
{
    for (int i = 0; i < n; i++)
        out[i] = v[i];
}

/// Are all n entries finite? If their sum is finite they are. Else each is tested: zero times
/// infinity is NaN. They are read one by one, as they have just been stored.
static inline bool ct_stepper_finite(const volatile double *x, int n)
{
    double sum = 0, zero = 0;
    for (int i = 0; i < n; i++)
        sum += x[i];
    if (sum - sum == 0)
        return true;
    for (int i = 0; i < n; i++)
        zero += 0 * x[i];
    return zero == 0;
}

/// dy (ny, out) = f(t, y), counted. A derivative that is not finite asks for a smaller step.
enum ct_eval ct_stepper_rhs(const struct ct_problem *p, double t, const double *y, double *dy,
                            struct ct_integrate_stats *stats);

/// out (n) = y + h (a_0 k_0 + ... + a_{s-1} k_{s-1}), k (n x s). y == NULL: without y. out must not
/// overlap y or k.
void ct_stepper_combine(double *restrict out, const double *y, double h, const double *a,
                        const double *k, int s, int n);

/// Compensated summation of steps: the round-off error so far, now (n), and after the last step,
/// next (n). y + now is closer to the exact sum of all steps than y, whose round-off would add up
/// in long runs. Source: higham2002.
struct ct_compensation {
    double *now, *next;
    int n;
};

struct ct_compensation ct_compensation_create(struct ct_arena *a, int n);
/// ct_method.restart and .accept of methods whose workspace begins with a struct ct_compensation.
void ct_compensation_restart(void *work);
void ct_compensation_accept(void *work);

/// ct_stepper_combine for the end of a step from y: with c->now, leaving c->next.
void ct_stepper_advance(double *restrict out, const double *y, double h, const double *a,
                        const double *k, int s, struct ct_compensation *c);

/// ct_method.stiffness_estimate: h |dy1 - dpoint| / |y1 - point| for two points at the end of a
/// step.
double ct_stepper_stiffness_estimate(const struct ct_problem *p, double h, const double *y1,
                                     const double *dy1, const double *point,
                                     const double *dpoint);

/// g->size = the largest |y_i|, |y1_i| of each group. g may be NULL.
void ct_stepper_group(const struct ct_groups *g, int ny, const double *y, const double *y1);

/// Root mean square of e_i / (rtol max(|y_i|, |y1_i|) + atol) over the controlled states; 0 if
/// there are none. e (ny).
double ct_stepper_norm(const struct ct_problem *p, const struct ct_tolerance *tolerance,
                       const double *y, const double *y1, const double *e);

/// Subtracts from the estimated error e (ny) of a step h the round-off of f, problem.roundoff.
void ct_stepper_subtract_roundoff(const struct ct_problem *p, double h, double *e);

/// The error of a step that ends at y1, time t1: the larger of `states`, the norm of the error e
/// (ny) of states, and the error of outputs that follows from e.  (8.6)
static inline double ct_stepper_larger_error(const struct ct_problem *p,
                                             const struct ct_tolerance *tolerance, double t1,
                                             const double *y1, const double *e, double states)
{
    // a step that is refused anyway needs no error of outputs
    if (!p->output_error || !(states <= 1))
        return states;
    return ct_larger(p->output_error(p->user, t1, y1, e, tolerance, states), states);
}

/// The norm of the error e (ny) of states or the error of outputs, whichever is larger.
double ct_stepper_error(const struct ct_problem *p, const struct ct_tolerance *tolerance,
                        double t1, const double *y, const double *y1, const double *e);

/// The estimated error of DOP853 from those of order 5 and 3; source as dop853.c.
double ct_stepper_join(double e5, double e3);

/// Largest |e_i| / (rtol max(|y_i|, |y1_i|) + atol) over the controlled states from `first` on. For
/// quadratures, whose error implicit methods estimate separately. e (ny).
double ct_stepper_largest(const struct ct_problem *p, const struct ct_tolerance *tolerance,
                          int first, const double *y, const double *y1, const double *e);

/// out (n) = the cubic through y and y1 with slopes dy and dy1, at theta of the step h.
/// Error h^4 / 384 |y''''|.
void ct_stepper_hermite(double *restrict out, double theta, double h, const double *y,
                        const double *dy, const double *y1, const double *dy1, int n);

/// The last step, for dense output: method->prepare has been called.
struct ct_stepper_span {
    const struct ct_method *method;
    const struct ct_problem *p;
    double t, h;
    const double *y, *y1;
    void *work;
};

/// out (ny) = state at t + theta h.
void ct_stepper_point(const struct ct_stepper_span *s, double theta, double *out);

#endif
