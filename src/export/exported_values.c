// Values and a motion for the test program of exported code. See exported.h.
#include "export/exported.h"

#include "solve/evaluator/switch_state.h"
#include "solve/run/run_internal.h"

#include <math.h>
#include <string.h>

static const double *copy(struct ct_arena *a, const double *v, size_t n)
{
    double *c = CT_NEWN(a, double, n + 1);
    if (n)
        memcpy(c, v, n * sizeof *v);
    return c;
}

// Records parameters slightly different from the model's, and all that depend on them. A
// parameter that is zero stays zero.
static void record_parameters(struct ct_exported *w, struct ct_export_state *s)
{
    struct ct_arena *a = w->ctx->model;
    const struct ct_model *m = &w->sim->system->model;
    double *value = CT_NEWN(a, double, m->x->nsym + 1),
           *raw = CT_NEWN(a, double, m->nparameter + 1),
           *all = CT_NEWN(a, double, m->nparameter + 1);
    for (size_t i = 0; i < m->nparameter; i++) {
        const struct ct_parameter *p = &m->parameter[i];
        const bool is_raw = ct_ex_is_const(m->x, p->definition, NULL);
        raw[i] = is_raw ? p->value * (1 + 0.01 * (double)(i % 3)) : 0;
        all[i] = is_raw ? raw[i] : ct_ex_value(m->x, p->definition, value);
        value[ct_ex_node(m->x, p->symbol)->a] = all[i];
    }
    s->raw = raw;
    s->parameter = all;
}

// Records all values at t, y. False if the equations are singular there or the speeds violate
// the constraints; with redundant rows the accelerations are only defined if the constraints
// are satisfied.
static bool record(struct ct_exported *w, double t, const double *y)
{
    struct ct_arena *a = w->ctx->model;
    struct ct_run *r = w->sim->run;
    struct ct_evaluator *m = ct_run_evaluator(r);
    struct ct_partition *s = ct_run_partition(r);
    struct ct_export_state *to = &w->state[w->x.nstate];
    double *value = CT_NEWN(a, double, m->e->nresult + 1);
    // Derived: ten times the tolerance of assembly.
    const double met = 1e-8; // [m, rad]; assembly reaches about 1e-12
    ct_evaluator_set(m, t, y);
    ct_evaluator_constraint(m);
    for (size_t i = 0; i < 2 * m->nrow; i++)
        if (!(fabs(m->constraint.out[i]) <= met))
            return false;
    ct_program_run(&m->constraint, m->input); // switches as evaluated
    *to = (struct ct_export_state){.constraint
                                   = copy(a, m->constraint.out, m->constraint.nout)};
    if (ct_run_results(r, t, y, value) != CT_EVAL_OK)
        return false;
    ct_run_find_multipliers(r);
    to->lam = copy(a, s->lam, m->nrow);
    to->output = value;
    ct_program_run(&w->reaction, m->input);
    to->reaction = copy(a, w->reaction.out, w->reaction.nout);
    ct_program_run(&m->root, m->input);
    to->root = copy(a, m->root.out, m->e->nswitch);
    ct_evaluator_dynamics(m);
    to->motion = copy(a, m->motion.out, m->motion.nout);
    to->a = copy(a, s->a, m->nu);
    to->input = copy(a, m->input, m->ninput);
    record_parameters(w, to);
    w->x.nstate++;
    return true;
}

// The same with switches as the state determines them.
static void record_elsewhere(struct ct_exported *w, const double *y)
{
    struct ct_evaluator *m = ct_run_evaluator(w->sim->run);
    double *side = m->input + m->at_switch;
    const double *before = copy(w->sim->own.scratch, side, m->e->nswitch);
    ct_evaluator_set(m, 0, y);
    ct_switches_start(m, 0, y, NULL, NULL);
    record(w, 0, y);
    if (m->e->nswitch)
        memcpy(side, before, m->e->nswitch * sizeof *side);
}

// Records the start, the start with doubled and with reversed speeds and, for open systems,
// another position. Elastic coordinates keep their values: the accelerations of a bent stiff
// beam are so large that round-off alone would make them differ.
bool ct_exported_record_states(struct ct_exported *w)
{
    const struct ct_evaluator *m = ct_run_evaluator(w->sim->run);
    const double *start = ct_run_state(w->sim->run);
    const size_t ny = m->nq + m->nu + 1;
    double *y = CT_NEWN(w->ctx->model, double, ny), *d = CT_NEWN(w->ctx->model, double, ny);
    if (!record(w, 0, start))
        return ct_error(w->ctx, (struct ct_mark){.file = w->sim->system->model.file},
                        CT_E_SINGULAR, "the equations are singular at the start");
    memcpy(y, start, ny * sizeof *y);
    for (size_t i = 0; i < m->nu; i++) {
        y[m->nq + i] *= 2;
        d[i] = m->e->u[i].beam ? 0 : 0.1 + 0.01 * (double)(i % 10);
    }
    record_elsewhere(w, y);
    for (size_t i = 0; i < m->nu; i++)
        y[m->nq + i] *= -1;
    record_elsewhere(w, y);
    if (m->nrow == 0) {
        ct_evaluator_retract(m, y, d);
        for (size_t i = 0; i < m->nu; i++)
            y[m->nq + i] += d[i];
        record_elsewhere(w, y);
    }
    ct_evaluator_set(ct_run_evaluator(w->sim->run), 0, start);
    return true;
}

// ---- a motion ------------------------------------------------------------------------------

// Limit: of a test program
enum { SAMPLES = 8 };

// A state stepped for the recorded motion, with its own diagnostics.
struct stepper {
    struct ct_ctx *quiet;
    struct ct_data *d;
};

static struct stepper make_stepper(struct ct_exported *w, const struct ct_sim_options *o)
{
    struct stepper s = {.quiet = ct_ctx_create()};
    s.d = s.quiet ? ct_data_create(s.quiet, w->sim->system, o) : NULL;
    return s;
}

static void destroy_stepper(struct stepper *s)
{
    ct_data_destroy(s->d);
    ct_ctx_destroy(s->quiet);
}

// Number k of the sequence q, u, states.
static double value_of(const struct ct_equations *e, const struct ct_data *d, size_t k)
{
    const size_t first_state = e->nq + e->nmotion;
    return k < e->nq       ? ct_data_value(d, CT_COORDINATE, k)
         : k < first_state ? ct_data_value(d, CT_SPEED, k - e->nq)
                           : ct_data_value(d, CT_STATE, k - first_state);
}

// Records q, u at equal intervals (SAMPLES x ny, out), with nstep steps between. False if the
// run fails.
static bool run(const struct ct_equations *e, struct stepper *s, double duration, long nstep,
                double *y)
{
    const size_t ny = e->nq + e->nu;
    bool ok = s->d && ct_data_reset(s->quiet, s->d) && ct_data_set_time(s->quiet, s->d, 0);
    for (size_t i = 0; ok && i < SAMPLES; i++) {
        for (long k = 0; ok && k < nstep; k++)
            ok = ct_data_step(s->quiet, s->d, duration / (double)(SAMPLES * nstep));
        for (size_t k = 0; ok && k < ny; k++) {
            y[i * ny + k] = value_of(e, s->d, k);
            ok = isfinite(y[i * ny + k]);
        }
    }
    ct_ctx_clear(s->quiet);
    return ok;
}

// Largest difference; each number is relative to 1 + the largest of its kind.
static double compare(const double *got, const double *want, size_t ny)
{
    double worst = 0;
    for (size_t k = 0; k < ny; k++) {
        double size = 0, difference = 0;
        for (size_t i = 0; i < SAMPLES; i++) {
            size = fmax(size, fabs(want[i * ny + k]));
            difference = fmax(difference, fabs(got[i * ny + k] - want[i * ny + k]));
        }
        worst = fmax(worst, difference / (1 + size));
    }
    return worst;
}

// Number of steps of the recorded motion: some seconds of computation.
static long count_steps(const struct ct_exported *w)
{
    const struct ct_tape_counts n = w->x.motion->counts;
    // Limit: of operations of a test program
    const double operations
        = (double)(n.multiplications + n.additions + n.divisions) + 8 * (double)n.functions,
        all = 4e6;
    const double steps = fmin(fmax(all / (1 + operations), 128), 2048);
    return (long)steps / SAMPLES;
}

// Records a motion over the model's duration, or a part of it if the steps would be too long
// for the classical Runge-Kutta method of order 4.
void ct_exported_record_motion(struct ct_exported *w)
{
    const struct ct_equations *e = &w->sim->system->equations;
    struct ct_export_motion *r = &w->x.run;
    // Limit: of the error of that method in a test program
    const double wanted = 1e-6; // error of that method
    const size_t ny = e->nq + e->nu, n = SAMPLES * ny + 1;
    double *want = CT_NEWN(w->ctx->model, double, n),
           *got = CT_NEWN(w->sim->own.scratch, double, n);
    double duration = w->sim->run_options.duration > 0 ? w->sim->run_options.duration : 1;
    // each call takes one step
    struct stepper fixed
        = make_stepper(w, &(struct ct_sim_options){.method = "rk4", .step = duration}),
        tight
        // Derived: 1e-4 of the wanted error.
        = make_stepper(w, &(struct ct_sim_options){.method = "dopri5", .tolerance = 1e-10});
    r->nstep = count_steps(w);
    for (int k = 0; k < 12 && !r->nsample && ny; k++, duration /= 4) {
        if (!run(e, &fixed, duration, r->nstep, got) || !run(e, &tight, duration, 1, want))
            continue;
        const double error = compare(got, want, ny);
        if (error > wanted)
            continue;
        r->nsample = SAMPLES;
        r->y = want;
        r->duration = duration;
        // Derived: ten times the error; 1e-9 covers the error of the reference.
        r->tolerance = fmax(10 * error, 1e-9);
    }
    destroy_stepper(&fixed);
    destroy_stepper(&tight);
}
