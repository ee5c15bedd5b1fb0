// See output_error.h.
#include "solve/output_error/output_error.h"

#include "integrate/stepper.h"

#include <float.h>
#include <math.h>
#include <string.h>

// The ratio is the error of outputs over the error of states, both in their tolerances. At a ratio
// of at most CT_NEGLIGIBLE_RATIO the error of outputs is not estimated in the next STEPS_BETWEEN
// steps.
// Default: time of estimates against errors in between. Test: output_error
enum { STEPS_BETWEEN = 7 };
// If the ratio changes by at most this fraction between two estimates, it is used for twice as
// many steps as before, up to MOST_BETWEEN. For outputs of accelerations an estimate costs two
// evaluations, and the ratio may change more. Default: time of estimates against errors in
// between.
// Test: output_error
static const double steady_change[CT_OUTPUT_KINDS] = {0.02, 0.5};
enum { MOST_BETWEEN = 15 }; // Default: as above. Test: output_error
// Steps without an estimate after one with an error of outputs of at most CT_NEGLIGIBLE_RATIO of
// the tolerance.
static const int fewest_between[CT_OUTPUT_KINDS] = {0, 3};
// Estimates without a new measurement of round-off, after one in which it did not matter. An error
// that would reject a step has it measured at once. Default: time of measurements against steps
// that round-off makes too short. Test: output_error
enum { MEASUREMENTS_BETWEEN = 15 };
// Errors of states below this, in tolerances, do not give a ratio: the step size is still growing.
// Default: steps that are too short against accurate ones. Test: output_error
static const double least_state_error = 0.02;
// An output is controlled if it is larger than this many of its round-off errors, that is, has
// six correct digits; its error in a step need not be below `step_roundoff_errors` of them. These
// are more than the CT_FEWEST_ROUNDOFF_ERRORS of an output, since the estimate of a step contains
// the round-off of all its stages.
// Default: outputs that are only round-off against small ones; steps against the last digits.
// Test: output_error
const double ct_output_error_least_size = 1e6;
static const double step_roundoff_errors = 16;

// Outputs of one kind.
struct group {
    struct ct_controlled_outputs outputs;
    struct ct_constrained_output *constrained_output; // NULL: there is none
    struct ct_output_sensitivity *sensitivity;
    int *result; // (n) index among the results of the equations
    struct ct_output_error_record record;
    double *at, *probed, *off; // (n) g at y, at y changed slightly, and at y + e
    double *expected;          // (n) expected largest values
    double *shown;             // (n) their largest values at samples
};

struct ct_output_error {
    struct group group[CT_OUTPUT_KINDS];
    size_t n; // of groups that are not empty
    size_t ny;
    double *y;           // (ny) workspace
    const double *shown; // of each result, its largest value at samples so far
};

bool ct_output_error_is_check(const struct ct_equations *e, size_t i)
{
    return e->result[i].value.id == e->total.id;
}

bool ct_output_error_needs_accelerations(const struct ct_equations *e, size_t i)
{
    const ct_ex v = e->result[i].value;
    const unsigned known = 1u << CT_SYM_TIME | 1u << CT_SYM_PARAM | 1u << CT_SYM_Q
                         | 1u << CT_SYM_U | 1u << CT_SYM_WORK;
    return ct_ex_kinds(e->x, v) & ~known;
}

bool ct_output_error_find_requested(struct ct_arena *a, const struct ct_equations *e,
                                    const bool **speeds, const bool **places)
{
    bool *u = CT_NEWN(a, bool, e->nu + 1), *q = CT_NEWN(a, bool, e->nu + 1);
    for (size_t k = 0; k < e->nu; k++) // a rotation has no coordinate of its own
        q[k] = e->u[k].q < 0;
    for (size_t i = 0; i < e->nresult; i++) {
        const unsigned id = e->result[i].value.id;
        if (ct_output_error_needs_accelerations(e, i))
            return false;
        for (size_t k = 0; k < e->nu; k++) {
            u[k] |= id == e->u[k].symbol.id;
            q[k] |= e->u[k].q >= 0 && id == e->q[e->u[k].q].symbol.id;
        }
    }
    *speeds = u;
    *places = q;
    return true;
}

// The outputs of this kind; false if there is none.
static bool create_group(struct ct_arena *a, struct ct_partition *s, enum ct_output_kind kind,
                         long *evaluations, struct group *p)
{
    const struct ct_equations *e = s->m->e;
    ct_ex *g = CT_NEWN(a, ct_ex, e->nresult + 1);
    size_t n = 0;
    *p = (struct group){.result = CT_NEWN(a, int, e->nresult + 1)};
    for (size_t i = 0; i < e->nresult; i++)
        if (ct_controlled_outputs_kind(e, e->result[i].value) == kind) {
            p->result[n] = (int)i;
            g[n++] = e->result[i].value;
        }
    if (!n)
        return false;
    ct_controlled_outputs_create(a, s, kind, g, n, evaluations, &p->outputs);
    p->record = ct_output_error_record(a, kind, n);
    p->at = CT_NEWN(a, double, n);
    p->probed = CT_NEWN(a, double, n);
    p->off = CT_NEWN(a, double, n);
    p->expected = CT_NEWN(a, double, n);
    p->shown = CT_NEWN(a, double, n);
    p->constrained_output = ct_constrained_output_create(a, &p->outputs, g);
    ct_constrained_output_clear(p->constrained_output, &p->record.constrained, false);
    p->sensitivity = ct_output_sensitivity_create(a, &p->outputs, p->constrained_output,
                                                  &p->record.constrained);
    return true;
}

struct ct_output_error *ct_output_error_create(struct ct_arena *a, struct ct_partition *s,
                                               const double *shown, long *evaluations)
{
    struct ct_output_error *p = CT_NEW(a, struct ct_output_error);
    *p = (struct ct_output_error){.ny = s->m->nq + s->m->nu + 1, .shown = shown};
    for (int kind = 0; kind < CT_OUTPUT_KINDS; kind++)
        p->n += create_group(a, s, kind, evaluations, &p->group[p->n]);
    p->y = CT_NEWN(a, double, p->ny);
    return p->n ? p : NULL;
}

const struct ct_controlled_outputs *ct_output_error_outputs(const struct ct_output_error *p,
                                                            enum ct_output_kind kind)
{
    for (size_t i = 0; p && i < p->n; i++)
        if (p->group[i].outputs.kind == kind)
            return &p->group[i].outputs;
    return NULL;
}

struct ct_constrained_output *ct_output_error_constrained(const struct ct_output_error *p,
                                                          enum ct_output_kind kind)
{
    for (size_t i = 0; p && i < p->n; i++)
        if (p->group[i].outputs.kind == kind)
            return p->group[i].constrained_output;
    return NULL;
}

// ---- record of the outputs of a run -------------------------------------------------------------

struct ct_output_error_record ct_output_error_record(struct ct_arena *a,
                                                     enum ct_output_kind kind, size_t n)
{
    return (struct ct_output_error_record){.n = n,
                                           .kind = kind,
                                           .largest = CT_NEWN(a, double, n),
                                           .last = CT_NEWN(a, double, n),
                                           .constrained = ct_constrained_output_record(a, n)};
}

void ct_output_error_clear(struct ct_output_error_record *r)
{
    if (r->n)
        memset(r->largest, 0, r->n * sizeof *r->largest);
    r->skip = r->between = r->without_measurement = 0;
    r->ratio = 0;
    r->has_last = false;
}

bool ct_output_error_is_due(struct ct_output_error_record *r)
{
    if (r->skip == 0)
        return true;
    r->skip--;
    return false;
}

double ct_output_error_extrapolated(const struct ct_output_error_record *r, double states)
{
    return r->ratio > CT_NEGLIGIBLE_RATIO ? r->ratio * states : 0;
}

// After an estimate: plan the number of steps that use the ratio of both errors.
static void plan_checks(struct ct_output_error_record *r, double error, double states)
{
    const double before = r->ratio, ratio = states >= least_state_error ? error / states : 0;
    const bool is_steady = fabs(ratio - before) <= steady_change[r->kind] * before;
    r->ratio = ratio;
    if (states >= least_state_error && ratio <= CT_NEGLIGIBLE_RATIO)
        r->between = STEPS_BETWEEN;
    else
        r->between = is_steady && ratio > 0       ? 2 * r->between + 1
                   : error <= CT_NEGLIGIBLE_RATIO ? fewest_between[r->kind]
                                                  : 0;
    r->between = r->between < MOST_BETWEEN ? r->between : MOST_BETWEEN;
    r->skip = r->between;
}

// Round-off of an output, from its values at a state and at the perturbed one.
static double roundoff_of(double at, double probed)
{
    return fabs(probed - at) * (DBL_EPSILON / CT_PERTURBATION);
}

double ct_output_error_evaluate(struct ct_output_error_record *r, const double *at,
                                const double *probed, const double *off,
                                const struct ct_tolerance *tolerance, double states)
{
    double sum = 0;
    size_t n = 0;
    bool is_roundoff_significant = false;
    r->has_last = true;
    for (size_t i = 0; i < r->n; i++) {
        const double roundoff = roundoff_of(at[i], probed[i]);
        r->last[i] = fabs(at[i]);
        if (r->constrained.is_found[i])
            continue;
        const double size = ct_larger(r->last[i], r->largest[i]);
        const double wanted = tolerance->rtol * size + tolerance->atol;
        is_roundoff_significant |= !(size >= ct_output_error_least_size * roundoff)
                                || !(wanted >= step_roundoff_errors * roundoff);
        if (!(size >= ct_output_error_least_size * roundoff)
            || (r->sensitive && ct_output_sensitivity_is_sensitive(r->sensitive, i)))
            continue;
        const double part
            = (off[i] - at[i]) / ct_larger(step_roundoff_errors * roundoff, wanted);
        sum += part * part;
        n++;
    }
    const double error = n && isfinite(sum) ? sqrt(sum / (double)n) : 0;
    if (probed != at)
        r->without_measurement = is_roundoff_significant ? 0 : MEASUREMENTS_BETWEEN;
    plan_checks(r, error, states);
    return error;
}

bool ct_output_error_limits_step(const struct ct_output_error_record *r, const double *at,
                                 const double *off, const struct ct_tolerance *tolerance,
                                 double states)
{
    const double least = CT_NEGLIGIBLE_RATIO * ct_smaller(states, 1);
    bool any = false;
    for (size_t i = 0; i < r->n; i++) {
        const double size = ct_larger(fabs(at[i]), r->largest[i]);
        const double wanted = tolerance->rtol * size + tolerance->atol;
        any |= !r->constrained.is_settled[i] && fabs(off[i] - at[i]) > least * wanted;
    }
    return any;
}

void ct_output_error_accept_sizes(struct ct_output_error_record *r)
{
    if (!r->has_last)
        return;
    for (size_t i = 0; i < r->n; i++)
        r->largest[i] = ct_larger(r->last[i], r->largest[i]);
    r->has_last = false;
}

// ---- a run alone --------------------------------------------------------------------------------

void ct_output_error_start(struct ct_output_error *p, const struct ct_method *method)
{
    for (size_t i = 0; i < p->n; i++) {
        ct_output_error_clear(&p->group[i].record);
        ct_constrained_output_clear(p->group[i].constrained_output,
                                    &p->group[i].record.constrained,
                                    method->violates_velocity_constraints);
        ct_output_sensitivity_start(p->group[i].sensitivity);
    }
}

// g->at = outputs at y.
static void find_at(struct group *g, double t, const double *y)
{
    memcpy(g->at, ct_controlled_outputs_at(&g->outputs, t, y), g->record.n * sizeof *g->at);
}

// g at y + e.
static const double *evaluate_perturbed(struct ct_output_error *p, struct group *g, double t,
                                        const double *y, const double *e)
{
    for (size_t i = 0; i < p->ny; i++)
        p->y[i] = y[i] + e[i];
    return ct_controlled_outputs_at(&g->outputs, t, p->y);
}

// g->probed = outputs at states that differ from y by little more than round-off.
static void perturb_by_roundoff(struct ct_output_error *p, struct group *g, double t,
                                const double *y)
{
    for (size_t i = 0; i < p->ny; i++)
        p->y[i] = y[i] + ct_output_error_perturbation((int)i) * y[i];
    memcpy(g->probed, ct_controlled_outputs_at(&g->outputs, t, p->y),
           g->record.n * sizeof *g->probed);
}

// g at y + e, after the test for constrained outputs if one might limit the step.
static const double *find_error(struct ct_output_error *p, struct group *g, double t,
                                const double *y, const double *e,
                                const struct ct_tolerance *tolerance, double states)
{
    const double *off = evaluate_perturbed(p, g, t, y, e);
    if (!ct_output_error_limits_step(&g->record, g->at, off, tolerance, states))
        return off;
    memcpy(g->off, off, g->record.n * sizeof *off);
    ct_constrained_output_find(g->constrained_output, &g->record.constrained, t, y, tolerance);
    return g->off;
}

static double check(struct ct_output_error *p, struct group *g, double t, const double *y,
                    const double *e, const struct ct_tolerance *tolerance, double states)
{
    struct ct_output_error_record *r = &g->record;
    const bool is_probed = r->without_measurement == 0;
    find_at(g, t, y);
    if (is_probed)
        perturb_by_roundoff(p, g, t, y);
    else
        r->without_measurement--;
    const double *off = find_error(p, g, t, y, e, tolerance, states),
                 *probed = is_probed ? g->probed : g->at;
    const double error = ct_output_error_evaluate(r, g->at, probed, off, tolerance, states);
    if (is_probed || error <= 1)
        return error;
    r->skip = r->without_measurement = 0; // no step is rejected because of round-off
    return check(p, g, t, y, e, tolerance, states);
}

double ct_output_error_of_step(struct ct_output_error *p, double t, const double *y,
                               const double *e, const struct ct_tolerance *tolerance,
                               double states, bool is_implicit)
{
    double most = 0;
    for (size_t i = 0; i < p->n; i++) {
        struct group *g = &p->group[i];
        const struct ct_tolerance own
            = ct_controlled_outputs_tolerance(g->outputs.kind, tolerance);
        if (is_implicit && g->outputs.kind == CT_OUTPUTS_OF_SOLUTIONS)
            continue;
        g->record.sensitive = is_implicit ? g->sensitivity : NULL;
        const double error = ct_output_error_is_due(&g->record)
                               ? check(p, g, t, y, e, &own, states)
                               : ct_output_error_extrapolated(&g->record, states);
        most = ct_larger(error, most);
    }
    return most;
}

// The same of a group.
static double change_of(struct ct_output_error *p, struct group *g, double t, const double *y,
                        const double *e, double least)
{
    double most = 0;
    find_at(g, t, y);
    perturb_by_roundoff(p, g, t, y);
    const double *off = evaluate_perturbed(p, g, t, y, e);
    for (size_t i = 0; i < g->record.n; i++) {
        const double change = fabs(off[i] - g->at[i]),
                     size = ct_larger(fabs(g->at[i]), g->record.largest[i]),
                     to_come = least > 0 ? ct_larger(g->expected[i], least) : 0;
        if (g->record.constrained.is_found[i]
            || (least > 0 && ct_output_sensitivity_is_sensitive(g->sensitivity, i)))
            continue;
        if (change > 0
            && size >= ct_output_error_least_size * roundoff_of(g->at[i], g->probed[i]))
            most = ct_larger(most, change / ct_larger(size, to_come));
    }
    return most;
}

double ct_output_error_of_change(struct ct_output_error *p, double t, const double *y,
                                 const double *e, double least)
{
    double most = 0;
    for (size_t i = 0; i < p->n; i++)
        most = ct_larger(change_of(p, &p->group[i], t, y, e, least), most);
    return most;
}

void ct_output_error_expect_size(struct ct_output_error *p, double t, const double *y,
                                 const double *change, double times)
{
    for (size_t k = 0; k < p->n; k++) {
        struct group *g = &p->group[k];
        find_at(g, t, y);
        const double *off = evaluate_perturbed(p, g, t, y, change);
        for (size_t i = 0; i < g->record.n; i++)
            g->expected[i] = times * fabs(off[i] - g->at[i]);
    }
}

void ct_output_error_accept(struct ct_output_error *p)
{
    for (size_t i = 0; i < p->n; i++)
        ct_output_error_accept_sizes(&p->group[i].record);
}

// ---- outputs that are sensitive to errors of states ---------------------------------------------

// Outputs of accelerations do not reject a step whose error of states, in tolerances, is less than
// this. Such a step is a third, the fourth root, of what states ask for. Still shorter steps do not
// damp vibrations that earlier steps have excited, and would have to resolve them.
// Default: accelerations as accurate as states against runs that do not end.
// Test: energy_flexible_four_bar.
static const double least_rejected_error = 1e-2;

double ct_output_error_of_sensitive(struct ct_output_error *p, double t, const double *y,
                                    const double *e, const struct ct_tolerance *tolerance,
                                    double states)
{
    double most = 0;
    for (size_t i = 0; i < p->n; i++) {
        struct group *g = &p->group[i];
        if (g->outputs.kind == CT_OUTPUTS_OF_SOLUTIONS && !(states >= least_rejected_error))
            continue;
        const struct ct_tolerance own
            = ct_controlled_outputs_tolerance(g->outputs.kind, tolerance);
        for (size_t k = 0; k < g->record.n; k++)
            g->shown[k] = p->shown[g->result[k]];
        most = ct_larger(ct_output_sensitivity_error(g->sensitivity, t, y, e, g->shown, &own),
                         most);
    }
    return most;
}

bool ct_output_error_has_sensitive(struct ct_output_error *p, double t, const double *y,
                                   const struct ct_tolerance *tolerance)
{
    bool any = false;
    for (size_t i = 0; i < p->n; i++) { // whatever a run before has found
        ct_constrained_output_clear(p->group[i].constrained_output,
                                    &p->group[i].record.constrained, false);
        any |= ct_output_sensitivity_any(p->group[i].sensitivity, t, y, tolerance);
    }
    return any;
}

int ct_output_error_roundoff_limit(struct ct_output_error *p, double t, const double *y,
                                   double wanted, double small, double *part)
{
    int limited = -1;
    for (size_t k = 0; k < p->n; k++) {
        const struct group *g = &p->group[k];
        double own;
        for (size_t i = 0; i < g->record.n; i++)
            g->shown[i] = ct_larger(p->shown[g->result[i]], g->record.largest[i]);
        const int i = ct_output_sensitivity_roundoff_limit(g->sensitivity, t, y, g->shown,
                                                           wanted, small, &own);
        if (i >= 0 && (limited < 0 || own > *part)) {
            *part = own;
            limited = g->result[i];
        }
    }
    return limited;
}
