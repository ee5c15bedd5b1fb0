// Tests of the conditioning of a coordinate partitioning: is the choice of rows and columns
// still good, is a projection accurate enough, are fixed pivots still accurate? Single runs
// (partition_internal.h) and batches (batch.c) share them.
//
//     kappa   largest |J_d^-1 J_i|
//     sigma   smallest over largest pivot of J_d; it falls when retained rows become dependent
#ifndef CT_SOLVE_CONSTRAINT_PARTITION_CONDITIONING_H
#define CT_SOLVE_CONSTRAINT_PARTITION_CONDITIONING_H

#include "solve/constraint/solver.h"

#include <float.h>
#include <math.h>

// A new choice of rows and columns is made when kappa has grown by this factor since the last
// choice, or sigma has fallen by it, and when kappa exceeds ct_kappa_largest (section 6.3, item
// 5).
// Default: a loss of one decimal digit, three in all, against the cost of a choice, which makes
// a solver.
// Test: partition_conditioning
static const double ct_kappa_growth = 10;
static const double ct_kappa_largest = 1e3;
// The same for sigma with redundant rows, which can replace retained ones before these are
// nearly dependent. Stages of a step do not satisfy the redundant rows exactly; with nearly
// dependent retained rows their accelerations are wrong.
// Default: the accuracy of stages against the cost of choices. Test: partition_conditioning
static const double ct_redundant_degradation = 2.5;
// Near a singular configuration every choice is ill-conditioned, and may still be so after it.
// There a new choice is made whenever sigma has changed by this factor.
// Default: a good choice soon against the cost of choices. Test: partition_conditioning
static const double ct_sigma_change_near_singular = 1.25;
// Projections stop at this residual [rad, m]. Derived: 450 units of round-off, which is what sums
// of some hundred terms of order one may leave.
static const double ct_position_tolerance = 1e-13;
// The residual of speeds is linear in the speeds, so one correction leaves only its own
// round-off. Above this correction [rad/s, m/s] a second one is made.
// Derived: a correction has an error of about kappa eps <= 1e3 eps of itself; with 1e-4 that is
// 2e-17, less than the round-off of speeds of order one.
static const double ct_small_change = 1e-4;
// Below this sigma the division by small pivots is taken into account.
// Default: a factor of two is not. Test: partition_conditioning
static const double ct_small_pivot = 0.5;
// Limit: Newton iterations of a projection; beyond it the step is repeated with half its length.
enum { CT_MOST_NEWTON = 25 };
// Only dense matrices give sigma, which tells how near a singular configuration is. A solver with a
// fixed order of pivots is used while its strength (solver.h) has changed by less than this factor
// since sigma was computed last.
// Default: a recent sigma against the time of dense factors. Test: partition_conditioning
static const double ct_most_strength_change = 1.5;
// If strength and sigma have changed by the same factor, to ct_same_change, sigma is extrapolated
// by the strength, up to a change by ct_most_extrapolated_change. Default: as above.
// Test: partition_conditioning
static const double ct_same_change = 1.02, ct_most_extrapolated_change = 4;
// The residual check of a solver is omitted while its strength is within this factor of that at
// the last check. Default: the time of checks against pivots that become small. Test:
// redundancy
static const double ct_same_strength = 1.25;
// A further condition for omitting it: the correction of coordinates per residual, in a
// projection, is at most this multiple of that at the last check. Near a singular J_d kappa can
// rise from 1 to 50 within the eight steps between two checks, while no pivot of the solver
// changes as much. Derived: the root of ct_kappa_growth, so that a check comes before kappa has
// grown by that factor.
static const double ct_correction_growth = 3;
// Residual of the equations relative to their largest terms above which the solution is refined.
// Derived: 450 units of round-off, as ct_position_tolerance.
static const double ct_refinement_residual = 1e-13;
// The same, and backward error of a sparse solution, above which dense matrices are used.
// Derived: accelerations then err by less than a tenth of the tolerance 1e-10.
static const double ct_largest_residual = 1e-11;

static inline bool ct_is_within(double ratio, double factor)
{
    return ratio < factor && ratio > 1 / factor;
}

/// Is a new choice of rows and columns needed? is_redundant: there are redundant rows.
static inline bool ct_partition_is_degraded(double kappa, double kappa_chosen, double sigma,
                                            double sigma_chosen, double sigma_best,
                                            bool is_redundant)
{
    const double fall = is_redundant ? ct_redundant_degradation : ct_kappa_growth;
    const bool is_poor = is_redundant && sigma * fall < sigma_best;
    return kappa > ct_kappa_growth * kappa_chosen + 1 || kappa > ct_kappa_largest
        || sigma * fall < sigma_chosen
        || (is_poor && !ct_is_within(sigma / sigma_chosen, ct_sigma_change_near_singular));
}

/// Is the residual `size` of a projection small enough? The tolerance is a few hundred units of
/// round-off. Near a singular configuration it is multiplied by sigma^2, as errors are divided
/// by sigma twice. Round-off of larger mechanisms may exceed it: the iteration also ends when
/// it no longer converges.
static inline bool ct_is_projected(double sigma, double size, double before)
{
    const double wanted = sigma < ct_small_pivot ? ct_position_tolerance * sigma * sigma
                                                 : ct_position_tolerance;
    // Derived: Newton's method squares the residual; below 1e-10 only round-off makes it fall by
    // less than four.
    return size <= wanted || (size < 1e-10 && size > before / 4);
}

/// After the corrections (6.3b) of positions and speeds: are the terms of second order that
/// remain smaller than the round-off of the rows? dq, du: sums of the absolute corrections; u:
/// the largest speed. All derivatives of joint constraints along motions of bodies are bounded
/// by the same lengths; the curvature of other rows along the motion is contained in du. Near a
/// singular configuration the remainder is divided by sigma twice.
static inline bool ct_is_remainder_below_roundoff(double sigma, double dq, double du, double u)
{
    const double least = DBL_EPSILON * (sigma < ct_small_pivot ? sigma * sigma : 1);
    return dq * dq <= least && dq * du <= least * (u > 1 ? u : 1);
}

/// Does Newton's iteration number i (from 0) diverge? A residual that grows far may end in another
/// assembly mode.
static inline bool ct_is_diverging(int i, double size, double before)
{
    // Chosen: growth that large steps may have before they converge
    return i == CT_MOST_NEWTON || !isfinite(size) || size > 1e3 * before;
}

/// Strength of a solver now, and strength and sigma where sigma was last computed by dense
/// matrices.
struct ct_strength {
    double now, at_sigma, sigma_found;
    bool is_alike; // strength and sigma have changed by the same factor
};

/// A solver is accurate while its strength is between low and high (out).
static inline void ct_strength_range(const struct ct_strength *s, double *low, double *high)
{
    const double most = s->is_alike ? ct_most_extrapolated_change : ct_most_strength_change;
    const double least = s->at_sigma / most;
    *low = least > CT_LEAST_STRENGTH ? least : CT_LEAST_STRENGTH;
    *high = s->at_sigma * most;
}

/// Record sigma from dense matrices at the present strength.
static inline void ct_strength_compare(struct ct_strength *s, double sigma)
{
    const double change = s->now / s->at_sigma;
    if (s->at_sigma > 0
        && !ct_is_within(change, ct_same_change)) // otherwise the comparison says nothing
        s->is_alike = ct_is_within(sigma / s->sigma_found / change, ct_same_change);
    s->at_sigma = s->now;
    s->sigma_found = sigma;
}

/// sigma extrapolated by the strength.
static inline double ct_strength_sigma(const struct ct_strength *s)
{
    return s->sigma_found * s->now / s->at_sigma;
}

#endif
