// Convergence test of the simplified Newton iteration: has it met the tolerance, come to round-off,
// or diverged? See newton_iteration.h.
//
// The test of the convergence rate is that of Hairer and Wanner (1996), IV.8, key hairer1996. Tests
// for round-off are added, as neither more corrections nor shorter steps would help there.
#include "integrate/implicit/newton_iteration.h"
#include "numeric/dense.h"

#include <float.h>
#include <string.h>

// A correction up to this many times the measured effect of round-off counts as round-off: the
// round-off of stages adds up, and a single measurement may find too little. Default: steps refused
// for round-off against errors accepted. Test: implicit
static const double roundoff_margin = 8;

void ct_newton_iteration_start(struct ct_newton_iteration *it)
{
    const double tail = ct_larger(it->tail, DBL_EPSILON);
    it->count = 0;
    it->rate = 0;
    // the value of the last step to the power 3/4, RADAU5 has 4/5; not used where iterations go
    // down to round-off
    it->tail = it->runs_to_roundoff ? 1 : sqrt(tail * sqrt(tail));
}

void ct_newton_iteration_continue(struct ct_newton_iteration *it)
{
    it->count = 1; // the last correction is known, its rate is not wanted
    it->kappa = 0;
    it->kappa_for = NAN; // in this step only
}

// A pseudo-random number in [1, 2) or (-2, -1] for each k. A regular pattern would miss some modes.
static double pseudo_random(unsigned k)
{
    const double odd = 0x1p-24; // Definition: scales an integer of 24 bits to [0, 1)
    k = (k + 1) * 2654435769u;  // 2^32 over the golden ratio
    k = (k ^ k >> 15) * 2246822519u;
    k = (k ^ k >> 13) * 3266489917u;
    return (k & 1 ? 1 : -1) * (1 + odd * (k >> 8));
}

// r (nu), rows (m x 2), out: residuals of motion and of constraints at q, with the speeds at the
// start of the step and the accelerations and multipliers of the derivatives.
static bool find_residuals(struct ct_newton_iteration *it, const double *q, double *r,
                           double *rows)
{
    const struct ct_roundoff_probe *p = &it->probe;
    const double *u = it->y + it->dae->nq;
    return it->dae->residual(it->dae->user, it->t, q, u, p->a, p->lam, r, rows, rows + it->m)
        == CT_EVAL_OK;
}

// p->r (nu), p->phi (m) = round-off errors of residuals and constraints. They are evaluated at
// positions that differ by a few round-off errors d; what differs from the linear change K d and J
// d is round-off. here (nu) is overwritten.
static bool perturb_residuals(struct ct_newton_iteration *it, double *here)
{
    const int nu = it->nu, m = it->m;
    const struct ct_dae *dae = it->dae;
    const struct ct_roundoff_probe *p = &it->probe;
    for (int k = 0; k < nu; k++) {
        const double at = dae->q_of[k] < 0 ? dae->scale : it->y[dae->q_of[k]];
        const double place = copysign(ct_larger(fabs(at), dae->scale), at);
        p->d[k] = dae->q_of[k] == CT_MOVES_NOTHING
                    ? 0
                    : pseudo_random((unsigned)k) * ct_position_roundoff * DBL_EPSILON * place;
    }
    ct_newton_iteration_move(dae, it->y, p->d, p->q);
    if (!find_residuals(it, it->y, here, p->phi) || !find_residuals(it, p->q, p->r, p->rows))
        return false;
    for (int k = 0; k < nu; k++)
        p->r[k] = here[k] - p->r[k];
    for (int i = 0; i < m; i++)
        p->phi[i] -= p->rows[i];
    if (it->sparse) {
        ct_newton_add_stiffness(it->sparse, p->r, 1, p->d);
        ct_newton_add_rows(it->sparse, p->phi, 1, p->d);
    }
    for (int j = 0; j < nu && !it->sparse; j++) {
        ct_vector_add(p->r, p->d[j], it->K + nu * j, (size_t)nu);
        ct_vector_add(p->phi, p->d[j], it->J + m * j, (size_t)m);
    }
    return true;
}

const double *ct_newton_iteration_roundoff(struct ct_newton_iteration *it)
{
    const int nu = it->nu, m = it->m;
    const struct ct_roundoff_probe *p = &it->probe;
    double *d = it->roundoff, *u = d + nu, *eta = p->rows;
    if (it->has_roundoff)
        return d;
    it->has_roundoff = true;
    if (!perturb_residuals(it, d)) {
        memset(d, 0, 2 * (size_t)nu * sizeof *d);
    } else {
        ct_newton_iteration_solve(it, d, eta, eta + m, p->r, p->phi, p->zero);
        ct_newton_iteration_add_constraint_force(it, u, d, -1, eta, nu,
                                                 m); // eta is zero in the index-3 form
        for (int k = 0; k < nu; k++)
            u[k] *= it->c;
    }
    return d;
}

// Are all entries of d (nu x n) within `most`? State variables of the model, whose units are not
// known, do not count.
static bool is_within(const struct ct_newton_iteration *it, const double *d, int n, double most)
{
    const int nmotion = it->nu - it->dae->nstate;
    for (int k = 0; k < n; k++)
        for (int i = 0; i < nmotion; i++)
            if (!(fabs(d[i + k * it->nu]) <= most))
                return false;
    return true;
}

// In an iteration down to round-off the ratio of the second to the first correction is not yet a
// convergence rate, since the first one is mostly the error of the prediction. In closed loops the
// second one may be as large as the first, and the third a thousandth of it.
static bool is_too_early(const struct ct_newton_iteration *it)
{
    return it->runs_to_roundoff && it->count == 2;
}

// The convergence rate, where a correction is `rate` times the one before. It is the geometric mean
// of the last two, since they often alternate. In an iteration down to round-off the largest one
// counts, without the first.
static void update_rate(struct ct_newton_iteration *it, double rate)
{
    it->slowest = it->count > 3 ? ct_larger(rate, it->slowest) : rate;
    it->rate = it->count > 2 ? sqrt(rate * it->rate) : rate;
    const double counts = it->runs_to_roundoff ? it->slowest : it->rate;
    it->tail = counts < 1 ? counts / (1 - counts) : INFINITY;
}

// Is a correction of this size and convergence rate mere round-off?
static bool is_roundoff(const struct ct_newton_iteration *it, double rate, double size)
{
    return rate >= 1 && !is_too_early(it) && size <= it->roundoff_size;
}

// Has the iteration stalled at a correction that round-off of the forces explains? Stiff forces at
// large positions, as in a beam of many elements, have such round-off, and shorter steps hardly
// reduce it.
static bool is_force_roundoff(struct ct_newton_iteration *it, double rate, double size,
                              bool has_speeds)
{
    if (rate < 1 || it->runs_to_roundoff)
        return false;
    const double *noise = ct_newton_iteration_roundoff(it);
    const double *u = has_speeds ? noise + it->nu : NULL;
    return size <= roundoff_margin * ct_newton_iteration_norm(it, noise, u, it->nu, 1);
}

// Are all corrections below half a unit round-off of the largest position and speed? What is left
// is round-off of the constraints, which neither more corrections nor shorter steps reduce.
static bool is_below_roundoff(const struct ct_newton_iteration *it, double size,
                              const double *d, const double *u, int n)
{
    return it->m && u && !it->runs_to_roundoff && it->kappa > 0 && size <= it->roundoff_size
        && is_within(it, d, n, it->roundoff_position)
        && is_within(it, u, n, it->roundoff_speed);
}

// In an iteration down to round-off: is this correction small enough to accept where it stalls or
// reaches the limit?
static bool is_stalled_at_roundoff(const struct ct_newton_iteration *it, double size)
{
    return it->runs_to_roundoff && size <= it->roundoff_size;
}

enum ct_convergence ct_newton_iteration_test_convergence(struct ct_newton_iteration *it,
                                                         double size, const double *d,
                                                         const double *u, int k)
{
    if (!isfinite(size))
        return CT_DIVERGED;
    if (it->count++ > 0) {
        const double rate = size / it->size;
        if (is_roundoff(it, rate, size)
            || (rate >= 1 && !is_too_early(it) && is_within(it, d, k, it->least))
            || is_below_roundoff(it, size, d, u, k)
            || is_force_roundoff(it, rate, size, u != NULL))
            return CT_CONVERGED;
        update_rate(it, rate);
        if (it->rate >= 1 && it->count > 3)
            return is_stalled_at_roundoff(it, size) ? CT_CONVERGED : CT_DIVERGED;
    }
    it->size = size;
    if (size <= it->kappa || (it->tail * size <= it->kappa && !is_too_early(it)))
        return CT_CONVERGED;
    if (it->count < it->most)
        return CT_ITERATING;
    return is_stalled_at_roundoff(it, size) ? CT_CONVERGED : CT_DIVERGED;
}

bool ct_newton_iteration_can_refresh(struct ct_newton_iteration *it)
{
    it->tail = 1;
    it->has_tangent = false;
    return !it->is_new;
}
