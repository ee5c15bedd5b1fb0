// See recording.h.
#include "html/recording.h"

#include "solve/run/run_internal.h"

#include <string.h>

enum { MOST_ROWS = 4001 }; // Limit: a screen has fewer columns of pixels

void ct_recording_create(struct ct_recording *r, struct ct_system *sys,
                         struct ct_terms_recording *terms)
{
    *r = (struct ct_recording){.stride = 1, .ncolumn = sys->equations.nresult, .terms = terms};
    ct_animation_create(sys->own.model, sys->equations.build, CT_ANIMATION_FORCES,
                        &r->animation);
}

// Measures the loops at some samples only, since singular values cost more than a sample.
static void measure_loops(struct ct_recording *r, double t, bool is_last)
{
    enum { MOST_MEASURED = 501 }; // Limit: of the page
    struct ct_arena *a = r->sim->own.model;
    const size_t n = 1 + r->loops.nloop, nrow = 1 + (r->nsample - 1) / r->stride;
    const size_t stride = 1 + (nrow - 1) / MOST_MEASURED;
    if (!r->loops.nloop || ((r->nrow - 1) % stride && !is_last))
        return;
    double *near = CT_NEWN(a, double, n);
    ct_loops_measure(&r->loops, near);
    CT_PUSH(a, r->near_time, r->nnear, r->near_time_cap, t);
    size_t at = (r->nnear - 1) * n;
    for (size_t k = 0; k < n; k++)
        CT_PUSH(a, r->near, at, r->near_cap, near[k]);
}

static void keep(struct ct_recording *r, double t, const double *value, bool is_last)
{
    struct ct_arena *a = r->sim->own.model;
    CT_PUSH(a, r->time, r->nrow, r->time_cap, t);
    size_t n = (r->nrow - 1) * r->ncolumn;
    for (size_t k = 0; k < r->ncolumn; k++)
        CT_PUSH(a, r->value, n, r->value_cap, value[k]);
    if (r->animation.values.uses_multipliers)
        ct_run_find_multipliers(r->sim->run);
    ct_animation_keep(&r->animation, ct_run_evaluator(r->sim->run), t);
    measure_loops(r, t, is_last);
    ct_terms_keep(a, r->terms, r->sim->run, r->nrow - 1, is_last);
}

static bool at_row(void *user, double t, const double *value, size_t n)
{
    struct ct_recording *r = user;
    (void)n;
    const bool is_last = r->seen + 1 == r->nsample;
    if (r->seen++ % r->stride == 0 || is_last)
        keep(r, t, value, is_last);
    return true;
}

// Records the start of a system without an end time.
static bool look_at_start(void *task)
{
    struct ct_recording *r = task;
    struct ct_sim *sim = r->sim;
    struct ct_evaluator *m = ct_run_evaluator(sim->run);
    const size_t n = r->animation.scene.nvalue;
    ct_animation_compile(sim->own.model, &r->animation, m);
    r->first = CT_NEWN(sim->own.model, double, n + 1);
    ct_evaluator_set(m, 0, ct_run_state(sim->run));
    ct_program_run(&r->animation.values.program, m->input);
    memcpy(r->first, r->animation.values.program.out, n * sizeof *r->first);
    r->nsample = sim->run_options.nsample;
    r->stride = r->nsample > MOST_ROWS ? (r->nsample + MOST_ROWS - 3) / (MOST_ROWS - 1) : 1;
    ct_loops_create(sim->own.model, sim, &r->loops);
    ct_terms_compile(sim->own.model, r->terms, sim->run, 1 + (r->nsample - 1) / r->stride);
    return true;
}

static bool keep_start(void *task)
{
    struct ct_recording *r = task;
    double *value = CT_NEWN(r->sim->own.model, double, r->ncolumn + 1);
    ct_run_results(r->sim->run, 0, ct_run_state(r->sim->run),
                   value); // the evaluator is at this sample
    keep(r, 0, value, true);
    return true;
}

bool ct_recording_run(struct ct_ctx *ctx, struct ct_recording *r, struct ct_sim *sim,
                      FILE *progress)
{
    r->sim = sim;
    if (!ct_enter(ctx, look_at_start, r))
        return false;
    if (!(sim->run_options.duration > 0))
        return ct_enter(ctx, keep_start, r);
    const struct ct_sim_results results = {.bar = progress, .row = at_row, .user = r};
    return ct_sim_run(ctx, sim, &results);
}
