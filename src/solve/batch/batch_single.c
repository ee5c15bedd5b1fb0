// One lane as a run alone, by the functions of partition.h: see batch_internal.h.
#include "solve/batch/batch_internal.h"
#include "solve/run/run_internal.h"
#include "integrate/stepper.h"

#include <math.h>
#include <string.h>

void ct_lane_give_up(struct ct_batch *s, int l)
{
    s->lane[l].state = CT_LANE_GIVEN_UP;
}

static void take_choice(struct ct_batch *s, int l, double t, const vec *y)
{
    const struct ct_lane *lane = &s->lane[l];
    struct ct_partition *partition = s->partition;
    const size_t rank = (size_t)s->rank, n = (size_t)s->nu;
    s->run->pending = lane->events.pending;
    ct_lane_take(s->one_y, y, l, (size_t)s->ny);
    ct_evaluator_set(s->m, ct_run_time_before_event(s->run, t), s->one_y);
    partition->rank = s->rank;
    partition->scale = lane->scale;
    partition->has_units = lane->has_units;
    memcpy(partition->unit, lane->unit, (size_t)s->nrow * sizeof *partition->unit);
    partition->least_cancellation
        = 0; // whatever a run alone has left: bits depend on the member only
    memcpy(partition->row, lane->row, (size_t)s->nrow * sizeof *partition->row);
    memcpy(partition->dependent, lane->dependent, rank * sizeof *partition->dependent);
    memcpy(partition->independent, lane->independent,
           (n - rank) * sizeof *partition->independent);
    partition->kappa = s->kappa[l];
    partition->sigma = s->sigma[l];
    partition->kappa_chosen = lane->kappa_chosen;
    partition->sigma_chosen = lane->sigma_chosen;
    partition->sigma_best = lane->sigma_best;
}

void ct_lane_load_run_whole(struct ct_batch *s, int l, double t, const vec *y)
{
    ct_lane_take(s->m->input, s->input, l, s->m->ninput);
    ct_evaluator_prepare(s->m);
    s->whose = l;
    take_choice(s, l, t, y);
}

void ct_lane_load_run(struct ct_batch *s, int l, double t, const vec *y)
{
    const size_t at = s->m->at_memory;
    if (s->whose == l) {
        ct_lane_take(s->m->input + at, s->input + at, l, s->e->nmemory);
    } else {
        ct_lane_take(s->m->input, s->input, l, s->m->ninput);
        ct_evaluator_prepare_dynamics(s->m);
        s->whose = l;
    }
    take_choice(s, l, t, y);
}

static void keep_measures(struct ct_batch *s, int l)
{
    s->kappa[l] = s->partition->kappa;
    s->sigma[l] = s->partition->sigma;
}

bool ct_lane_solve(struct ct_batch *s, int l, double t, const vec *y, vec *dy)
{
    ct_lane_load_run(s, l, t, y);
    if (ct_partition_solve(s->partition) != CT_EVAL_OK
        || !ct_stepper_finite(s->partition->a, s->nu) || !ct_stepper_finite(s->m->rate, s->nq))
        return false;
    keep_measures(s, l);
    ct_lane_put(dy, l, s->m->rate, (size_t)s->nq);
    ct_lane_put(dy + s->nq, l, s->partition->a, (size_t)s->nu);
    dy[s->ny - 1][l] = 0;
    if (s->solver_has_power) { // else it is computed in lanes
        ct_program_run(&s->m->power, s->m->input);
        dy[s->ny - 1][l] = s->m->power.out[0];
    }
    return true;
}

bool ct_lane_project(struct ct_batch *s, int l, double t, vec *y)
{
    const long switches = s->partition->switches;
    ct_lane_load_run(s, l, t, y);
    if (ct_partition_project(s->partition, ct_run_time_before_event(s->run, t), s->one_y)
        != CT_EVAL_OK)
        return false;
    keep_measures(s, l);
    ct_lane_put(y, l, s->one_y, (size_t)s->ny);
    if (s->partition->switches != switches && !ct_lane_choose(s, l))
        ct_lane_give_up(s, l);
    return true;
}

void ct_lane_renew(struct ct_batch *s, int l, double t, const vec *y)
{
    ct_lane_load_run(s, l, t, y);
    ct_evaluator_constraint(s->m);
    if (!ct_partition_choose(s->partition) || !ct_lane_choose(s, l))
        ct_lane_give_up(s, l);
}

double ct_lane_pivot(struct ct_batch *s, int l, double t, const vec *y)
{
    ct_lane_load_run(s, l, t, y);
    ct_evaluator_constraint(s->m);
    return ct_partition_pivot(s->partition);
}

void ct_lane_find_constrained_outputs(struct ct_batch *s, enum ct_output_kind kind, int l,
                                      const struct ct_tolerance *tolerance)
{
    const double t = s->t[l] + s->h[l];
    struct ct_constrained_output *p
        = ct_output_error_constrained(ct_run_output_error(s->run), kind);
    ct_lane_load_run_whole(s, l, t, s->y1);
    ct_constrained_output_find(p, &s->lane[l].outputs[kind].constrained,
                               ct_run_time_before_event(s->run, t), s->one_y, tolerance);
}

void ct_lane_multipliers(struct ct_batch *s, int l, double t, const vec *y, const vec *dy)
{
    ct_lane_load_run(s, l, t, y);
    ct_lane_take(s->partition->a, dy + s->nq, l, (size_t)s->nu);
    ct_partition_multipliers(s->partition);
    ct_lane_put(s->input + s->m->at_lam, l, s->partition->lam, (size_t)s->nrow);
}

void ct_lane_compare(struct ct_batch *s, int l)
{
    struct ct_strength *strength = &s->lane[l].strength;
    double low, high;
    strength->now = s->strength[l];
    ct_strength_compare(strength, s->sigma[l]);
    ct_strength_range(strength, &low, &high);
    s->low[l] = low;
    s->high[l] = high;
    s->slope[l] = strength->is_alike ? strength->sigma_found / strength->at_sigma : 0;
    s->alike = (s->alike & ~(1u << l)) | (unsigned)strength->is_alike << l;
}
