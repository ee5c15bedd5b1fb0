// Symbolic solvers in lanes: accelerations, projections and checks of the solvers; see
// partition_solver.c for a single run. Included by batch_step.c.
#ifndef CT_SOLVE_BATCH_BATCH_SOLVER_H
#define CT_SOLVE_BATCH_BATCH_SOLVER_H

#include "solve/batch/batch_vector.h"

static inline void set_input(struct ct_batch *s, vec t, const vec *y)
{
    s->input[0] = choose(t < s->before, t, s->before);
    copy(s->input + s->m->at_q, y, s->nq + s->nu);
    s->input[s->m->at_work] = y[s->nq + s->nu];
}

// ---- accelerations ------------------------------------------------------------------------------

// Strengths from pivots in the lanes `here`. Returns the lanes whose solver is sound.
static inline mask judge_pivots(struct ct_batch *s, const struct ct_solver_code *c,
                                const vec *pivot, set here)
{
    vec least = all_lanes(1);
    for (size_t i = 0; i < c->npivot; i++)
        least = smaller(least, pivot[i] * c->scale[i]);
    const mask is_here = mask_of(here);
    const mask is_sound = is_here & (least > s->low) & (least < s->high);
    s->strength = choose(is_here, least, s->strength);
    s->sigma = choose(is_sound & (s->slope > 0), s->slope * least, s->sigma);
    return is_sound;
}

// q', u' into dy by the solvers of lanes in `wanted`, and the power if they have it. Returns the
// lanes whose solver is sound.
static inline set solve_by_solvers(struct ct_batch *s, vec *dy, set wanted)
{
    const set able = wanted & ~ct_batch_lanes_without_solver(s);
    set done = 0;
    for (size_t f = 0; f < s->nsolver; f++) {
        struct ct_lane_solver *form = s->solver[f];
        const struct ct_solver_code *c = &form->code;
        const set here = able & form->lanes;
        if (!here)
            continue;
        ct_lane_run(&form->solved, s->input);
        const vec *a = form->solved.out, *rate = a + s->nu, *inertia = rate + s->nq,
                  *pivot = inertia + c->nfree, *power = pivot + c->npivot;
        mask is_sound = mask_of(here) & is_finite(a, s->nu + s->nq);
        for (size_t i = 0; i < c->nfree; i++)
            is_sound &= inertia[i] > 0;
        const set good = set_of(is_sound & judge_pivots(s, c, pivot, here));
        if (good == wanted || !done) { // results of other lanes are not used, or computed later
            copy(dy, rate, s->nq);
            copy(dy + s->nq, a, s->nu);
            dy[s->ny - 1] = c->has_power ? *power : (vec){0};
        } else {
            put(dy, rate, s->nq, good);
            put(dy + s->nq, a, s->nu, good);
            put(dy + s->ny - 1, power, c->has_power, good);
        }
        done |= good;
    }
    return done;
}

// ---- are they still good? -----------------------------------------------------------------------

// Largest of r (nu + rank) against the largest terms of the equations; infinite where it is not
// finite.
static inline vec weigh_left(const struct ct_batch *s, const struct ct_lane_solver *f,
                             const vec *r)
{
    const int nu = s->nu, rank = s->rank;
    const vec *a = f->checked.out, *Q = a + 3 * (nu + rank), *gam = Q + nu;
    vec accelerations = {0}, forces = {0}, rates = {0}, r0 = {0}, r1 = {0};
    for (int i = 0; i < nu; i++) {
        accelerations = larger(accelerations, a[i]);
        forces = larger(forces, Q[i]);
        r0 = larger(r0, r[i]);
    }
    for (int i = 0; i < rank; i++) {
        rates = larger(rates, gam[i]);
        r1 = larger(r1, r[nu + i]);
    }
    forces = larger(forces, f->code.M_size * accelerations);
    rates = larger(rates, f->code.J_size * accelerations);
    const vec left = larger(choose(r0 > 0, r0 / forces, all_lanes(0)),
                            choose(r1 > 0, r1 / rates, all_lanes(0)));
    return choose(mask_of(finite(r, nu + rank)), left, all_lanes(INFINITY));
}

// After a projection, at the input.
static inline void check_solvers(struct ct_batch *s, set wanted)
{
    const int n = s->nu + s->rank;
    for (size_t k = 0; k < s->nsolver; k++) {
        struct ct_lane_solver *f = s->solver[k];
        const set here = wanted & f->lanes & ~(s->near_singular & ~s->alike);
        if (!here)
            continue;
        ct_lane_run(&f->checked, s->input);
        const vec *out = f->checked.out, *B = out + 3 * n + s->nu + s->rank;
        const set is_strong = set_of(s->strength > CT_LEAST_STRENGTH);
        const set is_plain
            = set_of(weigh_left(s, f, out + n) <= ct_refinement_residual) & is_strong;
        const set is_known
            = set_of(weigh_left(s, f, out + 2 * n) <= ct_largest_residual) & is_strong;
        vec kappa = {0};
        for (size_t i = 0; i < f->code.nB; i++)
            kappa = larger(kappa, B[i]);
        s->needs_refinement = (s->needs_refinement & ~here) | (here & ~is_plain);
        s->kappa = choose(mask_of(here & is_known), kappa, s->kappa);
    }
}

// ---- projection ---------------------------------------------------------------------------------

// Phi, v and corrections by the solver. Returns the lanes of `here` where it is sound.
static inline set evaluate_closing(struct ct_batch *s, struct ct_lane_solver *f, vec t,
                                   const vec *y, set here)
{
    set_input(s, t, y);
    ct_lane_run(&f->closing, s->input);
    const vec *pivot = f->closing.out + 2 * (s->nrow + s->nu) + f->code.nshift;
    return set_of(judge_pivots(s, &f->code, pivot, here));
}

// y (+) dq in these lanes.
static inline void add_positions(struct ct_batch *s, vec *y, const vec *dq, set lanes)
{
    const mask m = mask_of(lanes);
    for (int k = 0; k < (int)s->e->nmotion && !s->has_quaternion; k++) {
        vec *q = &y[s->coordinate_of[k]];
        *q = choose(m, *q + dq[k], *q);
    }
    for (int l = 0; l < W && s->has_quaternion; l++) {
        if (!ct_has_lane(lanes, l))
            continue;
        ct_lane_take(s->one_dy, dq, l, (size_t)s->nu);
        ct_lane_take(s->one_y, y, l, (size_t)s->nq);
        ct_evaluator_retract(s->m, s->one_y, s->one_dy);
        ct_lane_put(y, l, s->one_y, (size_t)s->nq);
    }
}

static inline void add_speeds(struct ct_batch *s, vec *y, const vec *du, set lanes)
{
    const mask m = mask_of(lanes);
    for (int k = 0; k < s->nu; k++)
        y[s->nq + k] = choose(m, y[s->nq + k] + du[k], y[s->nq + k]);
}

// Lanes whose correction of speeds is so large that its round-off matters; else one correction is
// enough, since v is linear in u.
static inline set large_speeds(const struct ct_batch *s, const vec *du)
{
    vec most = {0};
    for (int k = 0; k < s->nu; k++)
        most = larger(most, du[k]);
    return set_of(most > ct_small_change);
}

// Next step of a Newton iteration in each active lane: converged, diverged (removed from `wanted`),
// or another correction. Returns the lanes with another correction.
static inline set judge(const struct ct_batch *s, const vec *phi, int i, vec *before,
                        set active, set *wanted)
{
    vec size = {0};
    for (int k = 0; k < s->nrow; k++)
        size = larger(size, phi[k]);
    size = choose(mask_of(finite(phi, s->nrow)), size, all_lanes(INFINITY));
    for (int l = 0; l < W; l++) {
        if (!ct_has_lane(active, l))
            continue;
        const double scale = s->lane[l].scale;
        const bool is_closed
            = ct_is_projected(s->sigma[l], size[l] / scale, (*before)[l] / scale);
        if (is_closed || ct_is_diverging(i, size[l], (*before)[l]))
            active &= ~(1u << l);
        if (!is_closed && !ct_has_lane(active, l))
            *wanted &= ~(1u << l);
    }
    *before = size;
    return active;
}

// Projects the lanes of `formed` onto the constraints by the solver. Returns the converged ones;
// the others continue by matrices, or are removed from `wanted` if they diverge.
static inline set project_by_solver(struct ct_batch *s, struct ct_lane_solver *f, vec t, vec *y,
                                    set formed, set *wanted)
{
    const vec *dq = f->closing.out + 2 * s->nrow, *du = dq + s->nu;
    vec before = all_lanes(INFINITY);
    set active = formed, arrived = 0, again = 0;
    for (int i = 0; active; i++) {
        const set sound = evaluate_closing(s, f, t, y, active);
        active = judge(s, f->closing.out, i, &before, sound, wanted);
        const set now = sound & ~active & *wanted; // no step is left to take
        add_positions(s, y, dq, active);
        add_speeds(s, y, du, now);
        again |= now & large_speeds(s, du);
        arrived |= now;
    }
    if (!again)
        return arrived;
    const set done = evaluate_closing(s, f, t, y, again);
    add_speeds(s, y, du, done);
    return (arrived & ~again) | done;
}

static inline set project_by_solvers(struct ct_batch *s, vec t, vec *y, set *wanted)
{
    const set able
        = *wanted & ~ct_batch_lanes_without_solver(s) & set_of(s->kappa <= ct_kappa_largest);
    set done = 0;
    for (size_t k = 0; k < s->nsolver; k++)
        if (able & s->solver[k]->lanes)
            done
                |= project_by_solver(s, s->solver[k], t, y, able & s->solver[k]->lanes, wanted);
    return done;
}

#endif
