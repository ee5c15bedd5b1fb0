// One step in all lanes at once: see batch.h. Steps are those of integrate/driver.c, derivative and
// projection those of run.c and projection.c, so that the result of a lane is that of a single run,
// to round-off.
#include "integrate/stepper.h"
#include "solve/batch/batch_event_location.h"
#include "solve/batch/batch_take.h"
#include "solve/singular/singular.h"

#include <limits.h>
#include <math.h>
#include <string.h>
// The run is stiff if h times the rate of the fastest motion exceeds the first value in so many
// steps, with fewer than so many other steps between. Values of the program DOPRI5 for the stage
// before the last.
// Definition: boundary of stability of DOPRI5 on the negative real axis, key hairer1996
static const double stiff_step = 3.25;
// Definition: of that test, key hairer1996
enum { MOST_STIFF = 15, FEW_OTHERS = 6 };
// Limit: beyond it the member is run alone
enum { MOST_STEPS = 100000000 };

// ---- projection, as in projection.c -------------------------------------------------------------

static void normalise(struct ct_batch *s, vec *y, set lanes)
{
    for (int l = 0; l < W && s->has_quaternion; l++)
        if (ct_has_lane(lanes, l)) {
            ct_lane_take(s->one_y, y, l, (size_t)s->nq);
            ct_evaluator_normalise(s->m, s->one_y);
            ct_lane_put(y, l, s->one_y, (size_t)s->nq);
        }
}

// Records, for lanes whose sigma was just computed by matrices, the strength of their solvers at
// the same state.
static void compare_solvers(struct ct_batch *s, vec t, const vec *y, set lanes)
{
    const vec sigma = s->sigma;
    for (size_t k = 0; k < s->nsolver; k++)
        if (lanes & s->solver[k]->lanes)
            evaluate_closing(s, s->solver[k], t, y, lanes & s->solver[k]->lanes);
    s->sigma = sigma;
    for (int l = 0; l < W; l++)
        if (ct_has_lane(lanes, l))
            ct_lane_compare(s, l);
}

static void renew(struct ct_batch *s, vec t, const vec *y, set lanes)
{
    for (int l = 0; l < W && s->rank; l++)
        if (ct_has_lane(lanes, l)
            && ct_partition_is_degraded(s->kappa[l], s->lane[l].kappa_chosen, s->sigma[l],
                                        s->lane[l].sigma_chosen, s->lane[l].sigma_best,
                                        s->rank < s->nrow))
            ct_lane_renew(s, l, t[l], y);
}

// Projects y of the lanes in `wanted` onto the constraints at t. Returns those that succeeded; some
// may be given up.
static set project(struct ct_batch *s, vec t, vec *y, set wanted)
{
    normalise(s, y, wanted);
    if (!s->nrow || !wanted)
        return wanted;
    const set done = project_by_solvers(s, t, y, &wanted), rest = wanted & ~done;
    for (int l = 0; l < W && rest; l++)
        if (ct_has_lane(rest, l) && !ct_lane_project(s, l, t[l], y))
            wanted &= ~(1u << l);
    if (rest & wanted)
        compare_solvers(s, t, y, rest & wanted);
    set_input(s, t, y);
    check_solvers(s, wanted);
    renew(s, t, y, wanted);
    return wanted;
}

// ---- the derivative, as in run.c ----------------------------------------------------------------

// dy without the power (which some solvers give) at the input, (t, y): by solvers where they are
// sound, else by matrices, one lane at a time. Only finite values.
static set solve(struct ct_batch *s, vec t, const vec *y, vec *dy, set wanted)
{
    const set done = solve_by_solvers(s, dy, wanted), rest = wanted & ~done;
    set found = 0;
    for (int l = 0; l < W && rest; l++)
        if (ct_has_lane(rest, l) && ct_lane_solve(s, l, t[l], y, dy))
            found |= 1u << l;
    if (found)
        compare_solvers(s, t, y, found);
    return done | found;
}

// Multipliers into the input, for the power of motions and for outputs. Solvers give those of the
// retained rows.
static void find_multipliers(struct ct_batch *s, vec t, const vec *y, const vec *dy, set wanted)
{
    const int n = s->nu + s->rank;
    set rest = wanted;
    for (size_t k = 0; k < s->nsolver && s->rank == s->nrow; k++) {
        struct ct_lane_solver *f = s->solver[k];
        const set here = wanted & f->lanes & ~ct_batch_lanes_without_solver(s);
        if (!here)
            continue;
        ct_lane_run(&f->checked, s->input);
        const set good
            = here & set_of(weigh_left(s, f, f->checked.out + 2 * n) <= ct_largest_residual);
        put(s->input + s->m->at_lam, f->checked.out + s->nu, s->rank, good);
        rest &= ~good;
    }
    for (int l = 0; l < W && rest; l++)
        if (ct_has_lane(rest, l))
            ct_lane_multipliers(s, l, t[l], y, dy);
}

// dy = f(t, y). Returns the lanes of `wanted` that have one; without constraints it need not be
// finite.
static set derive(struct ct_batch *s, vec t, const vec *y, vec *dy, set wanted)
{
    const int nu = s->nu, nq = s->nq;
    const bool with_power = s->has_power && !s->solver_has_power;
    set_input(s, t, y);
    s->count.evaluations++;
    if (s->is_solved) {
        ct_lane_run(&s->motion, s->input);
        copy(dy, s->motion.out + nu, nq);
        copy(dy + nq, s->motion.out, nu);
        dy[s->ny - 1] = (vec){0};
    } else {
        wanted = solve(s, t, y, dy, wanted);
    }
    if (with_power) {
        copy(s->input + s->m->at_a, dy + nq, nu);
        if (s->needs_lam)
            find_multipliers(s, t, y, dy, wanted);
        ct_lane_run(&s->power, s->input);
        dy[s->ny - 1] = s->power.out[0];
    }
    return wanted;
}

// ---- a try --------------------------------------------------------------------------------------

// The same for `few` states from i on: known where this is called, so that their sums stay in
// registers.
static inline void combine_few(const struct ct_batch *s, vec *out, const vec *y,
                               const struct ct_lane_sum *b, int i, int few)
{
    // Definition: stages of DOPRI5
    enum { MOST = 6 };
    const double *k = (const double *)(s->k + i);
    const vec h = s->h;
    vec sum[MOST] = {{0}};
    for (int j = 0; j < b->n; j++)
        for (int l = 0; l < few; l++)
            sum[l] += b->a[j] * *(const vec *)(k + b->at[j] + (size_t)(W * l));
    for (int l = 0; l < few; l++)
        out[i + l] = y ? y[i + l] + h * sum[l] : h * sum[l];
}

// out (ny) = y + h sum_j a_j k_j, y NULL: without. A few states at a time: coefficients and places
// are read once for them, and their sums do not wait for each other.
static void combine(const struct ct_batch *s, vec *out, const vec *y,
                    const struct ct_lane_sum *b)
{
    int i = 0;
    for (; s->ny - i >= 9; i += 6)
        combine_few(s, out, y, b, i, 6);
    switch (s->ny - i) {
    case 8:
        combine_few(s, out, y, b, i, 4);
        combine_few(s, out, y, b, i + 4, 4);
        break;
    case 7:
        combine_few(s, out, y, b, i, 4);
        combine_few(s, out, y, b, i + 4, 3);
        break;
    case 6:
        combine_few(s, out, y, b, i, 6);
        break;
    case 5:
        combine_few(s, out, y, b, i, 5);
        break;
    case 4:
        combine_few(s, out, y, b, i, 4);
        break;
    case 3:
        combine_few(s, out, y, b, i, 3);
        break;
    default:
        for (; i < s->ny; i++)
            combine_few(s, out, y, b, i, 1);
    }
}

// 1/(what the error of each state may be), as in ct_stepper_norm.
static void find_weights(struct ct_batch *s)
{
    const struct ct_groups *g = s->groups;
    for (int i = 0; g && i < g->n; i++)
        s->group_size[i] = (vec){0};
    for (int i = 0; g && i < s->ny; i++)
        if (g->of[i] >= 0) {
            vec *size = &s->group_size[g->of[i]];
            *size = larger(larger(*size, s->y[i]), s->y1[i]);
        }
    for (int i = 0; i < s->ny; i++) {
        const vec size = g && g->of[i] >= 0 ? s->group_size[g->of[i]]
                                            : larger(magnitude(s->y[i]), s->y1[i]);
        s->weight[i] = 1 / (s->rtol * size + s->atol);
    }
}

// Root mean square of e against the tolerance.
static vec norm(const struct ct_batch *s, const vec *e)
{
    const int n = s->has_power ? s->ny : s->ny - 1; // the work has the accuracy of the states
    vec sum = {0};
    for (int i = 0; i < n; i++) {
        const vec part = e[i] * s->weight[i];
        sum += part * part;
    }
    for (int l = 0; l < W; l++)
        sum[l] = n ? sqrt(sum[l] / n) : 0;
    return sum;
}

// Outputs of a kind at (t, y), in these lanes, as ct_controlled_outputs_at.
static const vec *outputs(struct ct_batch *s, enum ct_output_kind kind, vec t, const vec *y,
                          set lanes)
{
    struct ct_lane_outputs *o = &s->output[kind];
    vec *dy = s->dend, *a = s->input + s->m->at_a, *lam = s->input + s->m->at_lam;
    if (kind == CT_OUTPUTS_OF_SOLUTIONS) {
        const set found = derive(s, t, y, dy, lanes);
        for (int k = 0; k < s->nu; k++)
            a[k] = choose(mask_of(found), dy[s->nq + k], all_lanes(NAN));
        for (int i = 0; i < s->nrow; i++)
            lam[i] = all_lanes(NAN);
        if (o->needs_lam)
            find_multipliers(s, t, y, dy, found);
    } else {
        set_input(s, t, y);
    }
    ct_lane_run(&o->program, s->input);
    return o->program.out;
}

// The error of this lane's outputs, as in output_error.c, from values off (n) at y + e. probed:
// values for the measurement of round-off, if it is made now.
static double judge_lane(struct ct_batch *s, enum ct_output_kind kind, int l, const vec *off,
                         bool is_probed)
{
    struct ct_lane_outputs *o = &s->output[kind];
    struct ct_output_error_record *r = &s->lane[l].outputs[kind];
    const struct ct_tolerance states = {s->rtol[l], s->atol[l]};
    const struct ct_tolerance tolerance = ct_controlled_outputs_tolerance(kind, &states);
    ct_lane_take(o->one_at, o->at, l, r->n);
    ct_lane_take(o->one_off, off, l, r->n);
    if (is_probed)
        ct_lane_take(o->one_probed, o->probed, l, r->n);
    else
        r->without_measurement--;
    if (ct_output_error_limits_step(r, o->one_at, o->one_off, &tolerance, s->joint[l]))
        ct_lane_find_constrained_outputs(s, kind, l, &tolerance);
    return ct_output_error_evaluate(r, o->one_at, is_probed ? o->one_probed : o->one_at,
                                    o->one_off, &tolerance, s->joint[l]);
}

// Errors of outputs by errors e of the states at the end of the step, in these lanes: as
// ct_output_error_of_step.
static void judge_outputs(struct ct_batch *s, enum ct_output_kind kind, const vec *e, set lanes)
{
    struct ct_lane_outputs *o = &s->output[kind];
    const int n = (int)o->program.nout;
    const vec t = s->t + s->h;
    vec *y = s->end;
    set probing = 0, again = 0;
    for (int l = 0; l < W; l++)
        if (ct_has_lane(lanes, l) && s->lane[l].outputs[kind].without_measurement == 0)
            probing |= 1u << l;
    copy(o->at, outputs(s, kind, t, s->y1, lanes), n);
    for (int i = 0; i < s->ny && probing; i++)
        y[i] = s->y1[i] + ct_output_error_perturbation(i) * s->y1[i];
    if (probing)
        copy(o->probed, outputs(s, kind, t, y, probing), n);
    for (int i = 0; i < s->ny; i++)
        y[i] = s->y1[i] + e[i];
    const vec *off = outputs(s, kind, t, y, lanes);
    for (int l = 0; l < W; l++) {
        struct ct_lane *lane = &s->lane[l];
        if (!ct_has_lane(lanes, l))
            continue;
        const bool is_probed = ct_has_lane(probing, l);
        const double error = judge_lane(s, kind, l, off, is_probed);
        if (is_probed || error <= 1) {
            lane->error = fmax(lane->error, error);
        } else { // no step is rejected for its round-off
            lane->outputs[kind].skip = lane->outputs[kind].without_measurement = 0;
            again |= 1u << l;
        }
    }
    if (again)
        judge_outputs(s, kind, e, again);
}

// As ct_stepper_join.
static vec join(vec e5, vec e3)
{
    const vec part = e3 / (10 * e5), square = 1 + part * part;
    vec root = {0};
    for (int l = 0; l < W; l++)
        root[l] = sqrt(square[l]);
    return choose(e5 > 0, e5 / root, e5);
}

// Lanes of `wanted` whose outputs of this kind are evaluated now; the error of the others is
// extrapolated.
static set find_due(struct ct_batch *s, enum ct_output_kind kind, set wanted)
{
    set due = 0;
    for (int l = 0; l < W && s->output[kind].program.nout; l++) {
        struct ct_lane *lane = &s->lane[l];
        if (!ct_has_lane(wanted, l) || !(s->joint[l] <= 1))
            continue;
        if (ct_output_error_is_due(&lane->outputs[kind]))
            due |= 1u << l;
        else
            lane->error = fmax(lane->error,
                               ct_output_error_extrapolated(&lane->outputs[kind], s->joint[l]));
    }
    return due;
}

static void estimate(struct ct_batch *s, set wanted)
{
    vec *e = s->point;
    combine(s, e, NULL, &s->error);
    find_weights(s);
    const vec size = norm(s, e);
    s->joint = size;
    if (s->third.n) {
        combine(s, s->end, s->y, &s->third);
        for (int i = 0; i < s->ny; i++)
            s->end[i] = s->y1[i] - s->end[i];
        s->joint = join(size, norm(s, s->end));
    }
    const vec part = choose(size > 0, s->joint / size, all_lanes(1));
    for (int l = 0; l < W; l++)
        s->lane[l].error = s->joint[l];
    for (int i = 0; i < s->ny; i++)
        e[i] *= part;
    for (int kind = 0; kind < CT_OUTPUT_KINDS; kind++) {
        const set due = find_due(s, kind, wanted);
        if (due)
            judge_outputs(s, kind, e, due);
    }
}

// Ends of the stages at t + C h; the last one is the end of the step, y1 with dy1. That is not
// evaluated where its error does not depend on it and a projection follows.
static set take_stages(struct ct_batch *s, set wanted)
{
    const struct ct_tableau *b = s->method->tableau;
    const int n = s->ny, last = b->stages - 1;
    const bool is_last_wanted = b->nerror > last || !s->nrow;
    copy(s->k, s->dy, n);
    for (int stage = 1; stage <= last && wanted; stage++) {
        vec *to = stage == last ? s->y1 : stage + 1 == last ? s->late : s->point;
        combine(s, to, s->y, &s->stage[stage]);
        if (stage < last || is_last_wanted)
            wanted = derive(s, s->t + b->C[stage] * s->h, to, s->k + n * stage, wanted);
    }
    copy(s->dy1, s->k + n * last, n);
    return wanted;
}

// Projects the end of the step: end, dend = y1, dy1 on the constraints.
static set project_end(struct ct_batch *s, vec t, set wanted)
{
    const int n = s->ny;
    copy(s->end, s->y1, n);
    if (!wanted || (!s->nrow && !s->has_quaternion)) {
        copy(s->dend, s->dy1, n);
        return wanted;
    }
    wanted = project(s, t, s->end, wanted);
    return derive(s, t, s->end, s->dend, wanted) & finite(s->dend, s->ny);
}

// ---- step control, as in driver_step_size.c -----------------------------------------------------

static void plan(struct ct_batch *s, int l)
{
    struct ct_lane *lane = &s->lane[l];
    if (lane->events.whole > 0) {
        ct_lane_plan_again(s, l);
        return;
    }
    const double stop = ct_lane_stop(lane), rest = stop - s->t[l];
    const double longest = fmin(fmin(lane->control.h, lane->longest), rest);
    const double h = ct_step_control_fit(
        rest, ct_input_sampling_limit_step(&lane->events.input_sampling, s->method, s->t[l],
                                           longest, lane->tolerance.rtol));
    const bool is_landing = h >= rest;
    s->h[l] = lane->h = h;
    lane->end = is_landing ? stop : s->t[l] + h;
    if ((!is_landing && ct_step_control_is_below_roundoff(h, s->t[l], lane->t1))
        || lane->steps >= MOST_STEPS)
        ct_lane_give_up(s, l);
}

static void adapt(struct ct_batch *s, set tried, set wanted)
{
    for (int l = 0; l < W; l++) {
        struct ct_lane *lane = &s->lane[l];
        if (ct_has_lane(wanted, l)) {
            ct_step_control_accept(&lane->control, s->method, lane->h, lane->error);
            for (int kind = 0; kind < CT_OUTPUT_KINDS; kind++)
                ct_output_error_accept_sizes(&lane->outputs[kind]);
        } else if (ct_has_lane(tried, l)) {
            ct_step_control_refuse(&lane->control, s->method, s->h[l], lane->error);
            lane->events.whole = 0;
            s->count.rejected++;
        }
    }
}

// The stage before the last and the end of the step are at the same time: their difference shows
// the fastest motions, as in DOPRI5 by Hairer, Norsett and Wanner (1993), IV.2 of the second
// volume, key hairer1996. A stiff member is run alone, with a change of method.
static void detect_stiffness(struct ct_batch *s, set wanted)
{
    const int n = s->ny - 1; // nothing depends on the work
    const vec *late = s->k + (s->method->tableau->stages - 2) * s->ny;
    vec rates = {0}, states = {0};
    for (int i = 0; i < n; i++) {
        rates += (s->dend[i] - late[i]) * (s->dend[i] - late[i]);
        states += (s->end[i] - s->late[i]) * (s->end[i] - s->late[i]);
    }
    const set is_fast
        = set_of((states > 0) & (s->h * s->h * rates > stiff_step * stiff_step * states));
    for (int l = 0; l < W; l++) {
        struct ct_lane *lane = &s->lane[l];
        if (!ct_has_lane(wanted, l) || !lane->is_watched)
            continue;
        if (ct_has_lane(is_fast, l)) {
            lane->nother = 0;
            if (++lane->nstiff >= MOST_STIFF)
                ct_lane_give_up(s, l);
        } else if (lane->nstiff && ++lane->nother >= FEW_OTHERS) {
            lane->nstiff = lane->nother = 0;
        }
    }
}

// ---- what is taken over the step ----------------------------------------------------------------

// Further stages and corrections of the interpolant, for a step whose end is projected. Returns the
// lanes that succeeded.
static set prepare_dense(struct ct_batch *s, set wanted)
{
    const struct ct_dense_tableau *d = s->method->dense_tableau;
    const int n = s->ny, first = s->method->tableau->stages;
    copy(s->k + n * (first - 1), s->dend, n);
    for (int i = first; i < d->stages && wanted; i++) {
        combine(s, s->point, s->y, &s->take.stage[i]);
        wanted = derive(s, s->t + d->C[i - first] * s->h, s->point, s->k + n * i, wanted);
    }
    for (int j = 0; j < CT_DENSE_CORRECTIONS; j++)
        combine(s, s->take.F + n * j, NULL, &s->take.correction[j]);
    return wanted;
}

// The functions over the run at (t, y).
static void evaluate_takes(struct ct_batch *s, vec t, const vec *y, set lanes)
{
    struct ct_lane_takes *k = &s->take;
    if (k->needs_accelerations) {
        const set found = derive(s, t, y, k->dy, lanes);
        vec *a = s->input + s->m->at_a;
        for (int i = 0; i < s->nu; i++)
            a[i] = choose(mask_of(found), k->dy[s->nq + i], all_lanes(NAN));
        for (int i = 0; i < s->nrow; i++)
            s->input[s->m->at_lam + (size_t)i] = all_lanes(NAN);
        if (k->needs_lam)
            find_multipliers(s, t, y, k->dy, found);
    } else {
        set_input(s, t, y);
    }
    ct_lane_run(&k->program, s->input);
}

// Scans the accepted steps of these lanes, which end at `end`. A lane for which this fails is given
// up.
static void take_over_step(struct ct_batch *s, vec end, set wanted)
{
    set begun = 0, lost = 0;
    vec t;
    for (int l = 0; l < W && s->take.n; l++)
        if (ct_has_lane(wanted, l) && s->lane[l].state == CT_LANE_RUNNING) {
            ct_take_scan_step(s->take.scan[l], s->t[l], end[l]);
            begun |= 1u << l;
        }
    t = end;
    if (!ask_scans(s, begun, &t))
        return;
    lost = begun & ~prepare_dense(s, begun);
    for (set asked; (asked = ask_scans(s, begun & ~lost, &t)) != 0;) {
        interpolate_step(s, choose(end > s->t, (t - s->t) / (end - s->t), all_lanes(0)),
                         s->point);
        evaluate_takes(s, t, s->point, asked);
        lost |= answer_scans(s, asked);
    }
    for (int l = 0; l < W; l++)
        if (ct_has_lane(lost, l))
            ct_lane_give_up(s, l);
}

// ---- after a try --------------------------------------------------------------------------------

// Lanes in which a followed angle turns too fast for steps of this length.
static void give_up_fast(struct ct_batch *s, const vec *memory, set wanted)
{
    for (size_t i = 0; i < s->e->nmemory; i++) {
        const bool is_half = s->e->memory[i].kind == CT_MEMORY_QUATERNION;
        for (int l = 0; l < W && ct_memory_limits_steps(&s->e->memory[i]); l++) {
            const double turn = (is_half ? 2 : 1) * fabs(s->memory.out[i][l] - memory[i][l]);
            if (ct_has_lane(wanted, l) && turn > ct_lane_most_turn)
                ct_lane_give_up(s, l);
        }
    }
}

// Memories follow the motion to y at t where wanted.
static void follow(struct ct_batch *s, vec t, const vec *y, set wanted)
{
    const struct ct_equations *e = s->e;
    vec *memory = s->input + s->m->at_memory;
    if (!e->nmemory)
        return;
    set_input(s, t, y);
    ct_lane_run(&s->memory, s->input);
    give_up_fast(s, memory, wanted);
    for (size_t i = 0; i < e->nmemory; i++) {
        if (ct_memory_is_updated(&e->memory[i]))
            put(&memory[i], &s->memory.out[i], 1, wanted);
        if (e->memory[i].kind != CT_MEMORY_QUATERNION || e->memory[i].index != 3)
            continue;
        vec square = {0}, *last = &memory[i];
        for (int k = -3; k <= 0; k++)
            square += last[k] * last[k];
        for (int l = 0; l < W; l++) {
            const double length = sqrt(square[l]);
            for (int k = -3; k <= 0 && length > 0 && ct_has_lane(wanted, l); k++)
                last[k][l] /= length;
        }
    }
}

// Small pivots are tested after every step; a member that comes near a singular configuration is
// run alone.
static void predict_singular(struct ct_batch *s, vec t, const vec *y, set wanted)
{
    if (!s->rank)
        return;
    // with a single row sigma is always 1, but the strength of the solver falls
    vec pivot = s->sigma;
    if (s->rank == 1)
        pivot = s->strength * larger(all_lanes(1), s->kappa);
    s->pivot_most = choose(mask_of(wanted), larger(s->pivot_most, pivot), s->pivot_most);
    s->near_singular = set_of(pivot < CT_SINGULAR_PIVOT * s->pivot_most);
    for (int l = 0; l < W; l++) {
        struct ct_lane *lane = &s->lane[l];
        if (!ct_has_lane(wanted, l))
            continue;
        const double before = lane->pivot_last, dt = t[l] - lane->pivot_time;
        const bool is_sought = ct_has_lane(s->near_singular, l) || lane->has_units;
        const double now = is_sought ? ct_lane_pivot(s, l, t[l], y) : INFINITY;
        lane->pivot_last = now;
        lane->pivot_time = t[l];
        if (isfinite(before) && before > now && dt > 0
            && dt * now / (before - now) <= CT_STEPS_NEAR_SINGULAR * lane->control.h)
            ct_lane_give_up(s, l);
    }
}

// As in driver.c.
static void count_turns(struct ct_batch *s, set wanted)
{
    vec dq = {0}, q = {0}, du = {0}, u = {0};
    for (int i = 0; i < s->nq; i++) {
        dq += (s->end[i] - s->y[i]) * (s->end[i] - s->y[i]);
        q += (s->end[i] - s->start[i]) * (s->end[i] - s->start[i]);
    }
    for (int i = s->nq; i < s->nq + s->nu; i++) {
        du += (s->end[i] - s->y[i]) * (s->end[i] - s->y[i]);
        u += s->end[i] * s->end[i];
    }
    for (int l = 0; l < W; l++) {
        struct ct_lane *lane = &s->lane[l];
        if (!ct_has_lane(wanted, l) || !(lane->least_rtol > 0)
            || !ct_periodic_tolerance_add(&lane->periodic, lane->end, dq[l], q[l], du[l], u[l]))
            continue;
        const struct ct_tolerance tolerance = ct_periodic_tolerance_find(
            &lane->periodic, lane->tolerance.rtol, lane->tolerance.atol, lane->least_rtol);
        s->rtol[l] = tolerance.rtol;
        s->atol[l] = tolerance.atol;
    }
}

static void commit(struct ct_batch *s, set wanted)
{
    count_turns(s, wanted);
    for (int l = 0; l < W; l++)
        if (s->lane[l].state != CT_LANE_RUNNING)
            wanted &= ~(1u << l);
    put(s->y, s->end, s->ny, wanted);
    put(s->dy, s->dend, s->ny, wanted);
    put(s->g0, s->g, s->nroot, wanted);
    for (int l = 0; l < W; l++) {
        struct ct_lane *lane = &s->lane[l];
        if (!ct_has_lane(wanted, l))
            continue;
        s->t[l] = lane->end;
        lane->steps++;
        s->count.steps++;
        ct_lane_pass(s, l);
        if (lane->end >= lane->t1 && lane->state == CT_LANE_RUNNING)
            lane->state = CT_LANE_ARRIVED;
    }
}

// Lanes whose error is small enough. The error of a step that is rejected for another reason has no
// meaning.
static set accept(struct ct_batch *s, set wanted)
{
    const set is_finite = finite(s->y1, s->ny);
    for (int l = 0; l < W; l++) {
        struct ct_lane *lane = &s->lane[l];
        if (!ct_has_lane(wanted & is_finite, l) || !isfinite(lane->error)) {
            wanted &= ~(1u << l);
            lane->error = 0;
        } else if (lane->error > 1) {
            wanted &= ~(1u << l);
        }
    }
    return wanted;
}

// the thread sanitizer is not ready when the clone is chosen
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)      \
    && !defined(__SANITIZE_THREAD__)
__attribute__((target_clones("avx2", "default"), flatten))
#endif
static void
step(struct ct_batch *s)
{
    set tried = 0, again;
    vec end = s->t;
    s->whose = -1; // runs may have been started since
    for (int l = 0; l < W; l++) {
        struct ct_lane *lane = &s->lane[l];
        if (lane->state == CT_LANE_RUNNING)
            plan(s, l);
        if (lane->state != CT_LANE_RUNNING)
            continue;
        tried |= 1u << l;
        end[l] = lane->end;
    }
    set wanted = take_stages(s, tried);
    estimate(s, wanted);
    wanted = accept(s, wanted);
    wanted = project_end(s, end, wanted);
    wanted = locate_events(s, end, wanted, &again);
    follow(s, end, s->end, wanted);
    adapt(s, tried & ~again, wanted);
    predict_singular(s, end, s->end, wanted);
    detect_stiffness(s, wanted);
    take_over_step(s, end, wanted);
    commit(s, wanted);
}

// Clones of a function are exported whatever its visibility, unless it is static.
void ct_batch_step(struct ct_batch *s)
{
    step(s);
}
