// Error of fast modes and numerical dissipation, for implicit methods; see newton_iteration.h and
// theory (8.10), (8.13), (8.21).
//
// The error estimate of a step may consist of vibrations that are much faster than the motion. A
// low-pass filter built from mass, damping and stiffness matrices separates the slow part from the
// fast part. From the fast part follow the energy that a Radau step dissipates and the change of
// the outputs without these vibrations.
#include "integrate/implicit/newton_iteration.h"
#include "numeric/dense.h"

#include <math.h>
#include <string.h>

// The cutoff frequency of the filter, over the rate of the motion (8.10).
// Default: vibrations that are resolved without need against a slow motion that is filtered out.
// Test: vibration_error
static const double cutoff_ratio = 10;

// The rate of the motion: the largest |u|/min(|q|, 1), where coordinates below the absolute
// tolerance do not count.  [1/s]
static double motion_rate(const struct ct_newton_iteration *it, double small, const double *y)
{
    const double *u = y + it->dae->nq;
    double rate = 0;
    for (int k = 0; k < it->nu; k++) {
        const int i = it->dae->q_of[k];
        if (i == CT_MOVES_NOTHING)
            continue;
        const double way = i < 0 ? 1 : ct_smaller(fabs(y[i]), 1);
        rate = ct_larger(rate, (fabs(u[k]) + small) / (way + small));
    }
    return rate;
}

// b (n): its first nu entries become the low-pass filtered u.
static void low_pass(struct ct_newton_iteration *it, const double *u)
{
    const int nu = it->nu, n = it->n;
    double *b = it->b;
    memset(b + nu, 0, (size_t)(n - nu) * sizeof *b);
    ct_newton_iteration_multiply_mass(it, b, u);
    if (it->sparse)
        ct_newton_solve_slow(it->sparse, b);
    else
        ct_lu_solve(b, it->H, it->pivot_slow, n, n, 1, n, false);
}

// The part of a unit change of speed k that passes the low-pass filter.
static double passed_part(struct ct_newton_iteration *it, int k)
{
    memset(it->error_state, 0, (size_t)it->nu * sizeof *it->error_state);
    it->error_state[k] = 1;
    low_pass(it, it->error_state);
    return it->b[k];
}

static bool has_factors(struct ct_newton_iteration *it, double c)
{
    if (it->sparse)
        return ct_newton_factor_slow(it->sparse, c);
    ct_newton_iteration_fill(it, it->H, it->n, c, c * c);
    return ct_lu(it->H, it->pivot_slow, it->n, it->n);
}

static void find_masses(struct ct_newton_iteration *it)
{
    if (it->sparse)
        ct_newton_masses(it->sparse, it->mass);
    for (int k = 0; k < it->nu && !it->sparse; k++)
        it->mass[k] = it->M[k + it->nu * k];
}

static void find_slow_speeds(struct ct_newton_iteration *it)
{
    const double half = 0.5; // Definition: the cutoff, where c^2/(c^2 + omega^2) is one half
    if (it->sparse)
        ct_newton_slow_parts(it->sparse, it->error_state);
    for (int k = 0; k < it->nu; k++)
        it->is_slow[k] = (it->sparse ? it->error_state[k] : passed_part(it, k)) > half;
}

// Factors of the low-pass filter with cutoff frequency c. Those for up to twice or half of c are
// used again.
static bool factor_slow(struct ct_newton_iteration *it, double c)
{
    if (it->slow > c / 2 && it->slow < 2 * c) {
        it->is_band_factor = it->is_band_factor && !has_factors(it, it->slow);
        return !it->is_band_factor;
    }
    it->slow = has_factors(it, c) ? c : 0;
    it->is_band_factor = false;
    find_masses(it);
    if (it->slow > 0)
        find_slow_speeds(it);
    return it->slow > 0;
}

// The square root of a kinetic energy that does not affect the slow motion: that of the smallest
// slow mass at the largest `fast_scale` of slow speeds.
static double negligible_energy(const struct ct_newton_iteration *it, const double *fast_scale)
{
    double light = INFINITY, most = 0;
    for (int k = 0; k < it->nu; k++)
        if (it->is_slow[k]) {
            light = fmin(light, it->mass[k]);
            most = fmax(most, fast_scale[k]);
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

static double mass_form(const struct ct_newton_iteration *it, const double *x)
{
    return it->sparse ? ct_newton_mass_form(it->sparse, x) : form_of(it->M, x, it->nu);
}

// x' M x and x' K x of the fast part of x.
static void fast_forms(struct ct_newton_iteration *it, const double *x, double *mass,
                       double *stiffness)
{
    low_pass(it, x);
    for (int k = 0; k < it->nu; k++)
        it->error_state[k] = x[k] - it->b[k];
    *mass = mass_form(it, it->error_state);
    *stiffness = it->sparse ? ct_newton_stiffness_form(it->sparse, it->error_state)
                            : form_of(it->K, it->error_state, it->nu);
}

void ct_newton_iteration_note_energy(struct ct_newton_iteration *it, double small,
                                     const double *speeds)
{
    it->largest_mass = 0;
    for (int k = 0; k < it->nu; k++)
        it->largest_mass = ct_larger(it->largest_mass, it->mass[k]);
    it->energy
        = ct_larger(it->energy, mass_form(it, speeds) + it->largest_mass * small * small);
}

void ct_newton_iteration_predict_energy(struct ct_newton_iteration *it, double small,
                                        double time, const double *accelerations)
{
    low_pass(it, accelerations);
    memcpy(it->error_state, it->b, (size_t)it->nu * sizeof *it->error_state);
    const double force = mass_form(it, it->error_state); // squared, over a mass
    const double on_the_way = 2 * small * sqrt(it->largest_mass * force),
                 at_the_end = force * time * time;
    it->energy = ct_larger(it->energy, ct_smaller(on_the_way, at_the_end));
}

struct ct_vibration ct_newton_iteration_vibration(struct ct_newton_iteration *it, double gamma,
                                                  double h, const double *d, const double *u)
{
    double mu, ku, md, kd;
    fast_forms(it, u, &mu, &ku);
    fast_forms(it, d, &md, &kd);
    const double z2 = (h * h * ku + kd) / (mu + md / (h * h)); // Rayleigh's quotient of both
    if (!(z2 > 0))
        return (struct ct_vibration){0};
    const double filtered = 1 + gamma * gamma / z2;
    const double dissipation = (mu + z2 / (h * h) * md) * filtered;
    const double times = 1 + 3600 * (1 + z2 * (0.06 + 0.0025 * z2)) / (z2 * z2 * z2);
    return (struct ct_vibration){dissipation, dissipation * times, sqrt(filtered * times)};
}

double ct_newton_iteration_output_change(struct ct_newton_iteration *it,
                                         const struct ct_problem *p,
                                         const struct ct_vibration *v, double t,
                                         const double *y, const double *d, const double *u)
{
    const int nu = it->nu;
    double *positions = it->fast, *speeds = it->fast + nu;
    if (!p->output_change)
        return 0;
    low_pass(it, d);
    for (int k = 0; k < nu; k++)
        positions[k] = v->times * (d[k] - it->b[k]);
    low_pass(it, u);
    for (int k = 0; k < nu; k++)
        speeds[k] = v->times * (u[k] - it->b[k]);
    return p->output_change(p->user, t, y, ct_newton_iteration_states(it, y, positions, speeds),
                            0);
}

double ct_newton_iteration_slow_norm(struct ct_newton_iteration *it, const struct ct_problem *p,
                                     const struct ct_tolerance *tolerance, const double *y,
                                     const double *fast_scale, const double *d, const double *u,
                                     double *slow)
{
    const int nu = it->nu;
    double *b = it->b, *positions = it->fast, *speeds = it->fast + nu;
    const double small = tolerance->atol / tolerance->rtol;
    *slow = INFINITY;
    if (!isfinite(small) || !factor_slow(it, cutoff_ratio * motion_rate(it, small, y)))
        return INFINITY;
    const double negligible = negligible_energy(it, fast_scale);
    low_pass(it, d);
    for (int k = 0; k < nu; k++)
        positions[k] = p->requested_positions[k] ? d[k] : b[k];
    low_pass(it, u);
    for (int k = 0; k < nu; k++) {
        const double scale = fmax(fast_scale[k], negligible / sqrt(it->mass[k]));
        const double fast = (u[k] - b[k]) / (scale * it->inverse_weight[nu + k]);
        speeds[k] = p->requested_speeds[k] ? u[k] : hypot(b[k], fast);
    }
    *slow = ct_newton_iteration_norm(it, positions, speeds, nu, 1);
    return ct_newton_iteration_norm(it, d, speeds, nu, 1);
}

// out (nu) = the fast part of x. out may be x.
static void high_pass(struct ct_newton_iteration *it, double *out, const double *x)
{
    low_pass(it, x);
    for (int k = 0; k < it->nu; k++)
        out[k] = x[k] - it->b[k];
}

// Band-pass filter: x (nu) <- times (1 - S) S^2 x, S the low-pass filter `low_pass`.
static void band_pass(struct ct_newton_iteration *it, double *x, double times)
{
    for (int i = 0; i < 2; i++) {
        low_pass(it, x);
        memcpy(x, it->b, (size_t)it->nu * sizeof *x);
    }
    high_pass(it, x, x);
    for (int k = 0; k < it->nu; k++)
        x[k] *= times;
}

// The part of a predicted displacement at which outputs are evaluated, for a linear extrapolation.
// Derived: its truncation error is 2^-14, its round-off 2^-38 of the extrapolated change.
static const double sample = 0x1p-14;

void ct_newton_iteration_predict_motion(struct ct_newton_iteration *it,
                                        const struct ct_problem *p, double t, const double *y,
                                        const double *a, double *predicted)
{
    const int nu = it->nu;
    const double time = p->duration, *u = y + it->dae->nq;
    double *part = it->fast, scale = 1;
    memset(predicted, 0, 2 * (size_t)nu * sizeof *predicted);
    it->is_band_factor = true;
    if (has_factors(it, 1 / time)) {
        for (int k = 0; k < nu; k++)
            part[k] = time * (u[k] + time * a[k]);
        low_pass(it, part);
        memcpy(predicted, it->b, (size_t)nu * sizeof *predicted);
        low_pass(it, a);
        for (int k = 0; k < nu; k++) {
            predicted[nu + k] = time * it->b[k];
            scale = ct_larger(scale, fabs(predicted[k]));
        }
    }
    for (int k = 0; k < 2 * nu; k++) {
        predicted[k] = isfinite(predicted[k] / scale) ? predicted[k] / scale : 0;
        part[k] = sample * predicted[k];
    }
    if (p->predict_output)
        p->predict_output(p->user, t, y, ct_newton_iteration_states(it, y, part, part + nu),
                          1 / sample);
}

// The largest relative change of states that are outputs, for changes `positions` of positions and
// `speeds` (nu). It is relative to the largest value of each so far, or the one predicted if that
// is larger.
static double output_change_of_states(const struct ct_newton_iteration *it,
                                      const struct ct_problem *p, const struct ct_band *b,
                                      const double *positions, const double *speeds)
{
    const int nu = it->nu;
    double most = 0;
    for (int k = 0; k < nu; k++) {
        const double position = ct_larger(b->largest_position[k], fabs(b->predicted[k])),
                     speed = ct_larger(b->largest_speed[k], fabs(b->predicted[nu + k]));
        if (it->dae->q_of[k] >= 0 && p->requested_positions[k] && positions[k] != 0)
            most = ct_larger(most, fabs(positions[k]) / ct_larger(position, b->least));
        if (p->requested_speeds[k] && speeds[k] != 0)
            most = ct_larger(most, fabs(speeds[k]) / ct_larger(speed, b->least));
    }
    return most;
}

// A vibration with positions and speeds (nu), advanced by a quarter of its period.
static void advance_quarter_period(double *positions, double *speeds, double rate, int nu)
{
    for (int k = 0; k < nu; k++) {
        const double position = positions[k];
        positions[k] = speeds[k] / rate;
        speeds[k] = -rate * position;
    }
}

double ct_newton_iteration_output_change_in_band(struct ct_newton_iteration *it,
                                                 const struct ct_problem *p,
                                                 const struct ct_band *b, double t,
                                                 const double *y, const double *d,
                                                 const double *u)
{
    double *positions = it->fast, *speeds = it->fast + it->nu, change[2];
    if (!isfinite(b->small) || !factor_slow(it, cutoff_ratio * motion_rate(it, b->small, y)))
        return 0;
    high_pass(it, positions, d);
    high_pass(it, speeds, u);
    it->is_band_factor = true;
    if (!has_factors(it, b->rate))
        return 0;
    band_pass(it, positions, b->times);
    band_pass(it, speeds, b->times);
    for (int quarter = 0; quarter < 2; quarter++) {
        const double *e = ct_newton_iteration_states(it, y, positions, speeds);
        change[quarter]
            = ct_larger(output_change_of_states(it, p, b, positions, speeds),
                        p->output_change ? p->output_change(p->user, t, y, e, b->least) : 0);
        advance_quarter_period(positions, speeds, b->rate, it->nu);
    }
    return hypot(change[0], change[1]);
}
