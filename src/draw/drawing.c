// A system as a line drawing: in its initial configuration, at a time, or with the paths of its
// points over a run.
#include "draw/picture.h"

#include "sim/sim.h"

#include <string.h>

struct drawing {
    struct ct_ctx *ctx;
    struct ct_system *system;
    struct ct_sim *sim;
    const struct ct_draw_options *options;
    struct ct_scene scene;
    struct ct_view view;
    struct ct_program program;
    double *value; // at the drawn state
    double *path;  // 3 x npath x nsample
    size_t npath, nposition, nsample;
    struct source { // of a path
        int body;
        size_t at; // index of its position among the values
    } * source;
};

// ---- what leaves paths ---------------------------------------------------------------------

static void add_path(struct drawing *d, int body, size_t at)
{
    d->source[d->npath++] = (struct source){body, at};
}

// Points of moving bodies, the body's own frame where it has none, and both ends of beams.
static void find_paths(struct drawing *d)
{
    const struct ct_model *m = d->scene.model;
    struct ct_arena *a = d->system->own.model;
    bool *has_points = CT_NEWN(a, bool, m->nbody);
    d->source = CT_NEWN(a, struct source, m->nframe + 2 * d->scene.nbeam + 1);
    for (size_t f = 0; f < m->nframe; f++)
        has_points[m->frame[f].body] |= (int)f != m->body[m->frame[f].body].frame;
    for (size_t f = 0; f < m->nframe; f++) {
        const int body = m->frame[f].body;
        if (body > 0 && ((int)f != m->body[body].frame || !has_points[body]))
            add_path(d, body, 12 * f);
    }
    for (size_t i = 0; i < d->scene.nbeam; i++) {
        const struct ct_scene_beam *beam = &d->scene.beam[i];
        add_path(d, beam->body, beam->first);
        add_path(d, beam->body, beam->first + (size_t)3 * (size_t)(beam->npoint - 1));
    }
}

static void keep_positions(struct drawing *d, const double *value)
{
    for (size_t i = 0; i < d->npath && d->nposition < d->nsample; i++)
        memcpy(d->path + 3 * (d->npath * d->nposition + i), value + d->source[i].at,
               3 * sizeof *value);
    d->nposition += d->nposition < d->nsample;
}

// ---- steps, each with a guard --------------------------------------------------------------

static bool make_scene(void *task)
{
    struct drawing *d = task;
    ct_scene_create(d->system->own.model, d->system->equations.build, &d->scene);
    if (!ct_view_choose(&d->view, &d->scene, d->options->view))
        return ct_error(d->ctx, (struct ct_mark){0}, CT_E_USAGE,
                        "there is no view '%s': x, y, z or iso", d->options->view);
    find_paths(d);
    return true;
}

static bool compile(void *task)
{
    struct drawing *d = task;
    struct ct_sim *sim = d->sim;
    struct ct_evaluator *m = ct_run_evaluator(sim->run);
    ct_scene_compile(sim->own.model, &d->scene, m, &d->program);
    d->value = CT_NEWN(sim->own.model, double, d->scene.nvalue + 1);
    if (d->options->trace) {
        d->nsample = sim->run_options.nsample;
        d->path = CT_NEWN(sim->own.model, double, 3 * d->npath * d->nsample + 1);
    }
    ct_evaluator_set(m, 0, ct_run_state(sim->run));
    ct_program_run(&d->program, m->input);
    memcpy(d->value, d->program.out, d->scene.nvalue * sizeof *d->value);
    return true;
}

// Called with the evaluator at a sample. Paths are drawn with the initial configuration, a time
// with the last sample.
static bool at_row(void *user, double t, const double *value, size_t n)
{
    struct drawing *d = user;
    (void)t;
    (void)value;
    (void)n;
    ct_program_run(&d->program, ct_run_evaluator(d->sim->run)->input);
    if (d->options->trace)
        keep_positions(d, d->program.out);
    else
        memcpy(d->value, d->program.out, d->scene.nvalue * sizeof *d->value);
    return true;
}

static bool write(void *task)
{
    struct drawing *d = task;
    struct ct_arena *a = d->system->own.scratch;
    const struct ct_draw_options *o = d->options;
    int *path_body = CT_NEWN(a, int, d->npath + 1);
    for (size_t i = 0; i < d->npath; i++)
        path_body[i] = d->source[i].body;
    const struct ct_picture picture
        = {.scene = &d->scene,
           .value = d->value,
           .title = d->scene.model->name,
           .view = d->view,
           .caption = o->time > 0 ? ct_arena_printf(a, "t = %.6g s", o->time) : NULL,
           .path = d->path,
           .npath = d->npath,
           .nposition = d->nposition,
           .path_body = path_body};
    const bool ok = ct_picture_write(d->ctx, a, &picture, o->path);
    ct_own_next_stage(&d->system->own);
    return ok;
}

static bool run(struct drawing *d)
{
    const struct ct_sim_results results = {.bar = d->options->bar, .row = at_row, .user = d};
    if (!d->options->trace && !(d->options->time > 0))
        return true;
    return ct_sim_run(d->ctx, d->sim, &results);
}

bool ct_system_draw(struct ct_ctx *ctx, struct ct_system *sys,
                    const struct ct_draw_options *options)
{
    struct ct_draw_options given;
    ct_options_take(&given, options, sizeof given);
    struct drawing d = {.ctx = ctx, .system = sys, .options = &given};
    if (!ctx || !sys || !ct_enter(ctx, make_scene, &d))
        return false;
    struct ct_sim_options o = given.run;
    if (given.time > 0) {
        o.until = given.time;
        o.samples = 2; // the start and the time
    }
    d.sim = ct_sim_create(ctx, sys, &o);
    const bool ok = d.sim && ct_enter(ctx, compile, &d) && run(&d) && ct_enter(ctx, write, &d);
    ct_sim_destroy(d.sim);
    return ok;
}
