// What errors of implicit methods mean where they are vibrations much faster than the motion: which part of a speed is slow, and what
// energy a step of Radau takes from the rest. See iteration.h; (8.10), (8.13).
#include "integrate/iteration.h"
#include "numeric/dense.h"

#include <math.h>
#include <string.h>

// Vibrations so many times as fast as the motion are not part of it.
static const double much_faster = 10;

// How fast the motion is for its way: the largest |u|/|q|, without coordinates that are small as the tolerance sees them, and
// of those that have gone further than a unit as after that.  [1/s]
static double pace_of(const struct ct_iteration *it, double small, const double *y)
{
    const double *u = y + it->dae->nq;
    double pace = 0;
    for (int k = 0; k < it->nu; k++) {
        const int i = it->dae->q_of[k];
        const double way = i < 0 ? 1 : ct_smaller(fabs(y[i]), 1);
        pace = ct_larger(pace, (fabs(u[k]) + small) / (way + small));
    }
    return pace;
}

// b (n) = the slow part of u, in its first nu entries.
static void pass_slow(struct ct_iteration *it, const double *u)
{
    const int nu = it->nu, n = it->n;
    double *b = it->b;
    memset(b, 0, (size_t)n * sizeof *b);
    for (int j = 0; j < nu; j++)
        for (int k = 0; k < nu; k++)
            b[k] += it->M[k + nu * j] * u[j];
    ct_lu_solve(b, it->H, it->pivot_slow, n, n, 1, n, false);
}

// How much of speed k is slow.
static double remains(struct ct_iteration *it, int k)
{
    memset(it->off, 0, (size_t)it->nu * sizeof *it->off);
    it->off[k] = 1;
    pass_slow(it, it->off);
    return it->b[k];
}

// Factors that tell what is slower than c; those of up to twice or half of it will do.
static bool factor_slow(struct ct_iteration *it, double c)
{
    if (it->slow > c / 2 && it->slow < 2 * c)
        return true;
    ct_iteration_fill(it, it->H, it->n, c, c * c);
    it->slow = ct_lu(it->H, it->pivot_slow, it->n, it->n) ? c : 0;
    for (int k = 0; k < it->nu && it->slow > 0; k++)
        it->is_slow[k] = remains(it, k) > 0.5;
    return it->slow > 0;
}

// What the slow motion does not feel of speeds: as much as is ample of the largest slow one, in a mass as light as the
// lightest slow one.
static double unfelt_energy(const struct ct_iteration *it, const double *ample)
{
    double light = INFINITY, most = 0;
    for (int k = 0; k < it->nu; k++)
        if (it->is_slow[k]) {
            light = fmin(light, it->M[k + it->nu * k]);
            most = fmax(most, ample[k]);
        }
    return isfinite(light) ? sqrt(light) * most : 0;
}

// x' A x for A (nu x nu).
static double form_of(const double *A, const double *x, int nu)
{
    double sum = 0;
    for (int j = 0; j < nu; j++)
        for (int k = 0; k < nu; k++)
            sum += x[k] * A[k + nu * j] * x[j];
    return sum;
}

// x' M x, and with K, of what is fast of x.
static void measure_fast(struct ct_iteration *it, const double *x, double *mass,
                         double *stiffness)
{
    pass_slow(it, x);
    for (int k = 0; k < it->nu; k++)
        it->off[k] = x[k] - it->b[k];
    *mass = form_of(it->M, it->off, it->nu);
    *stiffness = form_of(it->K, it->off, it->nu);
}

double ct_iteration_lost(struct ct_iteration *it, double gamma, double h, double small,
                         const double *speeds, const double *d, const double *u,
                         double *present)
{
    double heavy = 0, mu, ku, md, kd;
    for (int k = 0; k < it->nu; k++)
        heavy = ct_larger(heavy, it->M[k + it->nu * k]);
    it->energy = ct_larger(it->energy, form_of(it->M, speeds, it->nu) + heavy * small * small);
    measure_fast(it, u, &mu, &ku);
    measure_fast(it, d, &md, &kd);
    const double z2 = (h * h * ku + kd) / (mu + md / (h * h)); // Rayleigh's quotient of both
    *present = 0;
    if (!(z2 > 0))
        return 0;
    const double lost = (mu + z2 / (h * h) * md) * (1 + gamma * gamma / z2) / it->energy;
    *present = lost * (1 + 3600 * (1 + z2 * (0.06 + 0.0025 * z2)) / (z2 * z2 * z2));
    return lost;
}

double ct_iteration_slow_norm(struct ct_iteration *it, const struct ct_tolerance *tolerance,
                              const double *y, const bool *asked, const double *ample,
                              const double *d, const double *u)
{
    const int nu = it->nu;
    double *b = it->b, *slow = it->off;
    const double small = tolerance->atol / tolerance->rtol;
    if (!isfinite(small) || !factor_slow(it, much_faster * pace_of(it, small, y)))
        return INFINITY;
    const double unfelt = unfelt_energy(it, ample);
    pass_slow(it, u);
    for (int k = 0; k < nu; k++) {
        const double borne = fmax(ample[k], unfelt / sqrt(it->M[k + nu * k]));
        slow[k] = asked[k] ? u[k] : hypot(b[k], (u[k] - b[k]) / (borne * it->share[nu + k]));
    }
    return ct_iteration_norm(it, d, slow, nu, 1);
}
