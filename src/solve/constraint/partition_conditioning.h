// Conditioning of a coordinate partitioning, when it is good enough: what runs alone
// (partition_internal.h) and runs side by side (batch.c) judge alike.
//
//     kappa   largest |J_d^-1 J_i|       sigma   smallest pivot of J_d against its largest: falls when kept rows depend
#ifndef CT_SOLVE_CONSTRAINT_PARTITION_CONDITIONING_H
#define CT_SOLVE_CONSTRAINT_PARTITION_CONDITIONING_H

#include "solve/constraint/solver.h"

#include <float.h>
#include <math.h>

// Choose anew when the dependent part has become this much worse than when it was chosen (section
// 6.3, item 5).
static const double ct_kappa_growth = 10;
static const double ct_kappa_largest = 1e3;
// Where rows are redundant others can do for those that are kept, so they are exchanged before they
// become nearly dependent: beside that stages, which lie off the rows that are left out, see
// another field.
static const double ct_redundant_degradation = 2.5;
// Beside a singular configuration all choices are poor, this one may stay so behind it: there
// another one is due with each such change of sigma.
static const double ct_poor_change = 1.25;
// Projections stop here: a few round-off errors of coordinates of order one.
static const double ct_position_tolerance = 1e-13;
// v is linear in u: one correction is enough but for its own round-off, which counts from here on
// [rad/s, m/s].
static const double ct_small_change = 1e-4;
// Pivots smaller than this against the largest enlarge what is left over noticeably.
static const double ct_small_pivot = 0.5;
enum { CT_MOST_NEWTON = 25 };
// A form is used while its strength has changed by less than such a factor since sigma, which tells
// how near a singular configuration is, was found by dense matrices.
static const double ct_most_change = 1.5;
// Where strength and sigma have fallen alike, up to so much, strength stands for sigma for longer.
static const double ct_alike = 1.02, ct_most_change_alike = 4;
// Pivots count as those of before while their strength is within this factor of what it was.
static const double ct_same_strength = 1.25;
// And while projections move coordinates by no more, for what they close, than so many times as
// much as at the last check: kappa can rise from 1 to 50 within the eight steps between two checks,
// as J_d comes to where it is singular, while no pivot of the form does.
static const double ct_correction_growth = 3;
// What may be left of the equations against their terms: beyond the first a refinement is made,
// beyond the second the form is not used.
static const double ct_left_plain = 1e-13, ct_left_most = 1e-11;

static inline bool ct_is_within(double ratio, double factor)
{
    return ratio < factor && ratio > 1 / factor;
}

/// Is another choice of rows or columns due? is_redundant: there are rows that are not kept.
static inline bool ct_partition_is_degraded(double kappa, double kappa_chosen, double sigma,
                                            double sigma_chosen, double sigma_best,
                                            bool is_redundant)
{
    const double fall = is_redundant ? ct_redundant_degradation : ct_kappa_growth;
    const bool is_poor = is_redundant && sigma * fall < sigma_best;
    return kappa > ct_kappa_growth * kappa_chosen + 1 || kappa > ct_kappa_largest
        || sigma * fall < sigma_chosen
        || (is_poor && !ct_is_within(sigma / sigma_chosen, ct_poor_change));
}

/// What is near enough in a projection: a few round-off errors, divided twice by the smallest pivot
/// near a singular configuration. Round-off keeps larger mechanisms from it: stop when nothing is
/// gained any more.
static inline bool ct_is_projected(double sigma, double size, double before)
{
    const double wanted = sigma < ct_small_pivot ? ct_position_tolerance * sigma * sigma
                                                 : ct_position_tolerance;
    return size <= wanted || (size < 1e-10 && size > before / 4);
}

/// After corrections (6.3b) of positions and speeds, dq and du the sums of their sizes, u the
/// largest speed: is what they leave, terms of second order, below a round-off of what rows are
/// sums of? Derivatives of rows of joints along motions of bodies are bounded by the same lengths
/// in all orders; what other rows bend along the motion is a part of du. Beside a singular
/// configuration what is left is divided by sigma twice.
static inline bool ct_is_remainder_below_roundoff(double sigma, double dq, double du, double u)
{
    const double least = DBL_EPSILON * (sigma < ct_small_pivot ? sigma * sigma : 1);
    return dq * dq <= least && dq * du <= least * (u > 1 ? u : 1);
}

/// Newton's iteration number i (from 0) leads nowhere.
static inline bool ct_is_diverging(int i, double size, double before)
{
    return i == CT_MOST_NEWTON || !isfinite(size) || size > 1e3 * before;
}

/// Strength of a form, and sigma beside it where that was last found by matrices.
struct ct_strength {
    double now, at_sigma, sigma_found;
    bool is_alike; // strength and sigma have changed alike
};

/// The form is sound while its strength is between the two.
static inline void ct_strength_range(const struct ct_strength *s, double *low, double *high)
{
    const double most = s->is_alike ? ct_most_change_alike : ct_most_change;
    const double least = s->at_sigma / most;
    *low = least > ct_solver_least_strength ? least : ct_solver_least_strength;
    *high = s->at_sigma * most;
}

/// sigma has been found by matrices where the form has this strength.
static inline void ct_strength_compare(struct ct_strength *s, double sigma)
{
    const double change = s->now / s->at_sigma;
    if (s->at_sigma > 0 && !ct_is_within(change, ct_alike)) // else there is nothing to learn
        s->is_alike = ct_is_within(sigma / s->sigma_found / change, ct_alike);
    s->at_sigma = s->now;
    s->sigma_found = sigma;
}

/// sigma as the strength shows it.
static inline double ct_strength_sigma(const struct ct_strength *s)
{
    return s->sigma_found * s->now / s->at_sigma;
}

#endif
