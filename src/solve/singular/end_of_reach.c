// Limit of reach: does a driven motion lead to a time from which on the constraints have no
// solution?
//
// The motion either crosses a singular configuration ahead or ends in it. It ends if no
// configuration after it satisfies the constraints: then the minimum of the sum of their
// squares is positive and grows with time. The minimum is computed at two times by the
// Levenberg-Marquardt method, starting from the extrapolated configuration. If the singular
// configuration can be crossed the minimum is 0.
//
// Source: Nocedal and Wright (2006), Numerical Optimization, 10.3, for the method.
#include "solve/constraint/partition_internal.h"
#include "solve/singular/rank_monitor_internal.h"

#include "numeric/dense.h"
#include "solve/evaluator/switch_state.h"

#include <float.h>
#include <math.h>
#include <string.h>

struct search {
    struct ct_rank_monitor *w;
    size_t ny;
    double t;
    double *y, *next; // (ny)
    double *H, *g;    // J' J + mu 1  (nu x nu), J' phi, and then the step  (nu)
};

// Half the sum of squares of phi at y. J is evaluated there, too.
static double half_sum_of_squares(const struct search *s, const double *y)
{
    const struct ct_evaluator *m = s->w->m;
    double sum = 0;
    ct_evaluator_set(s->w->m, s->t, y);
    ct_evaluator_constraint(s->w->m);
    for (size_t i = 0; i < m->nrow; i++)
        sum += m->phi[i] * m->phi[i] / 2;
    return sum;
}

// H = J' J, g = J' phi; returns the norm of g relative to those of its factors.
static double find_gradient(const struct search *s)
{
    const struct ct_evaluator *m = s->w->m;
    const int nu = (int)m->nu, nrow = (int)m->nrow;
    ct_matrix_multiply_transposed(s->H, m->J, m->J, nu, nrow, nu);
    ct_matrix_multiply_transposed(s->g, m->J, m->phi, nu, nrow, 1);
    double trace = 0, phi = 0;
    for (int i = 0; i < nu; i++)
        trace += s->H[i + nu * i];
    for (int i = 0; i < nrow; i++)
        phi += m->phi[i] * m->phi[i];
    return trace * phi > 0 ? sqrt(ct_vector_dot(s->g, s->g, (size_t)nu) / (trace * phi)) : 0;
}

// Move s->y to the nearest local minimum of the sum of squares. size (out): the root of that
// sum. False if none is found.
static bool find_least(struct search *s, double *size)
{
    // Limit: iterations of the search; beyond them an end of the motion is not detected
    enum { MOST = 100 };
    // the root of the unit round-off: relative accuracy of the position of a minimum
    const double flat = sqrt(DBL_EPSILON);
    const struct ct_evaluator *m = s->w->m;
    const size_t nu = m->nu;
    // Limit: initial damping; it is adapted at each step
    double mu = 1e-3, now = half_sum_of_squares(s, s->y);
    for (int i = 0; i < MOST && isfinite(now); i++) {
        *size = sqrt(2 * now);
        if (*size <= DBL_EPSILON * s->w->s->scale || find_gradient(s) <= flat)
            return true;
        for (size_t k = 0; k < nu; k++)
            s->H[k + nu * k] += mu;
        if (!ct_cholesky(s->H, (int)nu, (int)nu))
            return false;
        ct_cholesky_solve(s->g, s->H, (int)nu, (int)nu, 1, (int)nu);
        for (size_t k = 0; k < nu; k++)
            s->g[k] = -s->g[k];
        memcpy(s->next, s->y, s->ny * sizeof *s->y);
        ct_evaluator_retract(s->w->m, s->next, s->g);
        const double then = half_sum_of_squares(s, s->next);
        if (then < now) {
            memcpy(s->y, s->next, s->ny * sizeof *s->y);
            now = then;
            mu /= 10;
        } else {
            half_sum_of_squares(s, s->y);
            mu *= 10;
        }
    }
    return false;
}

// The least residual of the constraints at t + dt, near the configuration extrapolated from y
// at t with its speeds. False if it is not found.
static bool least_residual_after(struct search *s, double t, const double *y, double dt,
                                 double *size)
{
    const struct ct_evaluator *m = s->w->m;
    s->t = t + dt;
    memcpy(s->y, y, s->ny * sizeof *y);
    for (size_t k = 0; k < m->nu; k++)
        s->g[k] = dt * y[m->nq + k];
    ct_evaluator_retract(s->w->m, s->y, s->g);
    return find_least(s, size);
}

bool ct_singular_ends_motion(void *user, double t, const double *y, double in)
{
    struct ct_rank_monitor *w = user;
    struct ct_arena *a = w->s->arena;
    const size_t nu = w->m->nu, ny = w->m->nq + nu + 1;
    // Derived: the tolerance of assembly;
    const double closed = 1e-9; // residuals after steps are far below
    double once, twice;
    if (t + 3 * in >= *w->pending || ct_partition_is_large(w->s))
        return false; // an event may change the motion
    struct search s = {.w = w,
                       .ny = ny,
                       .y = CT_NEWN(a, double, ny),
                       .next = CT_NEWN(a, double, ny),
                       .H = CT_NEWN(a, double, nu *nu + 1),
                       .g = CT_NEWN(a, double, nu + 1)};
    // the residual grows in proportion to the time after t + in
    const bool is_found = least_residual_after(&s, t, y, 2 * in, &once)
                       && least_residual_after(&s, t, y, 3 * in, &twice);
    ct_evaluator_set(w->m, ct_rank_monitor_time(w, t), y);
    ct_evaluator_constraint(w->m);
    return is_found && once > closed * w->s->scale && twice > 1.5 * once;
}
