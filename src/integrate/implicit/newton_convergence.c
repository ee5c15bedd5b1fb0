// Convergence of Newton's method: when an iteration has come near enough, or to round-off; see newton_iteration.h. The rules of convergence are those of Hairer and
// Wanner (1996), IV.8, key hairer1996.
#include "integrate/implicit/newton_iteration.h"
#include "numeric/dense.h"

#include <float.h>
#include <string.h>

// The first corrections come from a guess and may grow; not so much, though.
static const double hopeless = 100;
// Corrections that are to go on after convergence do until they are this much smaller.
static const double further = 1e-6;
// After convergence corrections that are not halved have come to round-off.
static const double halved = 0.5;
// So much of what is seen of round-off errors may come together in a correction: stages add up three times as much, and no two looks are
// alike.
static const double together = 8;

void ct_newton_iteration_start(struct ct_newton_iteration *it)
{
    const double tail = ct_larger(it->tail, DBL_EPSILON);
    it->count = 0;
    it->is_further = false;
    it->rate = 0;
    // the last step's, trusted less and less; not where there is no tolerance that says how far off it may be
    it->tail = it->is_finest ? 1 : sqrt(tail * sqrt(tail));
}

void ct_newton_iteration_continue(struct ct_newton_iteration *it)
{
    it->count = 1; // the last correction is known, its rate is not wanted
    it->is_further = true;
    it->kappa *= further;
    it->kappa_for = NAN; // in this step only
}

// Between 1 and 2 or -2 and -1 by chance, another for each k: a pattern would miss some motions.
static double toss(unsigned k)
{
    const double odd = 0x1p-24;
    k = (k + 1) * 2654435769u; // 2^32 over the golden ratio
    k = (k ^ k >> 15) * 2246822519u;
    k = (k ^ k >> 13) * 3266489917u;
    return (k & 1 ? 1 : -1) * (1 + odd * (k >> 8));
}

// At q and speeds of the step's start: forces into r (nu), constraints into rows (m x 2); no accelerations, no multipliers.
static bool find_forces(struct ct_newton_iteration *it, const double *q, double *r,
                        double *rows)
{
    const struct ct_roundoff_probe *p = &it->probe;
    const double *u = it->y + it->dae->nq;
    return it->dae->residual(it->dae->user, it->t, q, u, p->zero, p->zero, r, rows,
                             rows + it->m)
        == CT_EVAL_OK;
}

// p->r (nu), p->phi (m) = the round-off of forces and of constraints, and what that of places makes of them: by how much those at places
// that cannot be told from these, d away, are not what K and J say. here (nu) is overwritten.
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
                    : toss((unsigned)k) * ct_position_roundoff * DBL_EPSILON * place;
    }
    ct_newton_iteration_move(dae, it->y, p->d, p->q);
    if (!find_forces(it, it->y, here, p->phi) || !find_forces(it, p->q, p->r, p->rows))
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

// Of the states of the model, whose size may be any, nothing is asked. d (nu x n)
static bool is_within(const struct ct_newton_iteration *it, const double *d, int n, double most)
{
    const int nmotion = it->nu - it->dae->nstate;
    for (int k = 0; k < n; k++)
        for (int i = 0; i < nmotion; i++)
            if (!(fabs(d[i + k * it->nu]) <= most))
                return false;
    return true;
}

// Followed down to round-off, the second correction against the first says nothing yet, which is an error of the prediction
// and in places above all: of angles of several turns in loops the second is as large and the third a thousandth of it, of a tumbling body,
// with old derivatives, the second is a thousandth and the third, of speeds, a tenth of that.
static bool is_too_early(const struct ct_newton_iteration *it)
{
    return it->is_finest && it->count == 2;
}

// A correction is `rate` times the one before. Two in turn are often uneven, so their mean says whether they converge. Followed
// down to round-off the slowest one says what is left, but for the first, which says nothing.
static void take_rate(struct ct_newton_iteration *it, double rate)
{
    it->slowest = it->count > 3 ? ct_larger(rate, it->slowest) : rate;
    it->rate = it->count > 2 ? sqrt(rate * it->rate) : rate;
    const double counts = it->is_finest ? it->slowest : it->rate;
    it->tail = counts < 1 ? counts / (1 - counts) : INFINITY;
}

// Does a correction of this size, at this rate to the one before, show only round-off?
static bool is_roundoff(const struct ct_newton_iteration *it, double rate, double size)
{
    if (it->is_further && rate >= halved && size <= 1)
        return true;
    return rate >= 1 && !is_too_early(it) && size <= it->roundoff_size;
}

// Nor does one that a round-off of the forces may be the reason of, where corrections shrink no more: stiff forces of places that
// are large beside their own motion, as of a beam of many elements, are known no better, and in shorter steps hardly so.
static bool is_roundoff_noise(struct ct_newton_iteration *it, double rate, double size,
                              bool has_speeds)
{
    const bool has_stalled
        = rate >= 1
       || (rate >= halved && it->count > 2 && !ct_newton_iteration_is_slow(it->rate));
    if (!has_stalled || it->is_finest)
        return false;
    const double *noise = ct_newton_iteration_roundoff(it);
    const double *u = has_speeds ? noise + it->nu : NULL;
    return size <= together * ct_newton_iteration_norm(it, noise, u, it->nu, 1);
}

// Half a round-off of the largest place moves no place as large, and what is left of the constraints comes back in others,
// halved perhaps from one correction to the next: neither more of them nor shorter steps make it less.
static bool is_below_roundoff(const struct ct_newton_iteration *it, double size,
                              const double *d, const double *u, int n)
{
    return it->m && u && !it->is_finest && !it->is_further && size <= it->roundoff_size
        && is_within(it, d, n, it->roundoff_position)
        && is_within(it, u, n, it->roundoff_speed);
}

// Small enough where corrections followed down to round-off shrink no more or have been many.
static bool is_fine(const struct ct_newton_iteration *it, double size)
{
    return it->is_finest && size <= it->roundoff_size;
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
            || is_roundoff_noise(it, rate, size, u != NULL))
            return CT_CONVERGED;
        take_rate(it, rate);
        if (rate >= hopeless)
            return CT_DIVERGED;
        if (it->rate >= 1 && it->count > 3)
            return is_fine(it, size) ? CT_CONVERGED : CT_DIVERGED;
    }
    it->size = size;
    if (size <= it->kappa || (it->tail * size <= it->kappa && !is_too_early(it)))
        return CT_CONVERGED;
    if (it->count < it->most)
        return CT_ITERATING;
    return is_fine(it, size) ? CT_CONVERGED : CT_DIVERGED;
}

bool ct_newton_iteration_can_refresh(struct ct_newton_iteration *it)
{
    it->tail = 1;
    it->has_tangent = false;
    return !it->is_new;
}
