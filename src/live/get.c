// Quantities at a state, computed on demand. See live.h.
#include "live/live.h"

#include "formulate/kinematics/kinematics.h"
#include "solve/run/run_internal.h"

#include <math.h>
#include <string.h>

bool ct_data_accelerate(struct ct_data *d)
{
    struct ct_run *r = d->sim.run;
    if (d->known & CT_KNOWS_ACCELERATION)
        return true;
    ct_data_enter(d);
    if (ct_partition_accelerate_at(r->s, ct_run_time_before_event(r, d->t), d->y) != CT_EVAL_OK)
        return ct_error(&d->sim.own, (struct ct_mark){.file = d->sim.system->model.file},
                        CT_E_SINGULAR, "the accelerations at t = %.9g cannot be found", d->t);
    // M, Q and J of the evaluator may belong to an earlier state
    d->known = (d->known & ~(unsigned)CT_KNOWS_MOTION) | CT_KNOWS_ACCELERATION;
    return true;
}

static bool find_multipliers(struct ct_data *d)
{
    if (d->known & CT_KNOWS_MULTIPLIERS)
        return true;
    if (!ct_data_accelerate(d))
        return false;
    ct_run_find_multipliers(d->sim.run);
    d->known |= CT_KNOWS_MULTIPLIERS;
    return true;
}

bool ct_data_find_outputs(struct ct_data *d)
{
    struct ct_run *r = d->sim.run;
    if (d->known & CT_KNOWS_OUTPUTS)
        return true;
    if (!ct_data_accelerate(d) || (r->has_lam_results && !find_multipliers(d)))
        return false;
    ct_program_run(&r->m->result, r->m->input);
    memcpy(d->value, r->m->result.out, r->e->nresult * sizeof *d->value);
    d->known |= CT_KNOWS_OUTPUTS;
    return true;
}

// Compiles a program when it is first needed.
static void compile(struct ct_data *d, const ct_ex *out, size_t n, struct ct_program *p)
{
    struct ct_evaluator *m = ct_run_evaluator(d->sim.run);
    ct_evaluator_add_program(d->sim.own.model, m, m->e->x, out, n, p);
}

static bool find_energy(struct ct_data *d)
{
    struct ct_evaluator *m = ct_run_evaluator(d->sim.run);
    if (d->known & CT_KNOWS_ENERGY)
        return true;
    ct_data_enter(d);
    if (!d->has_strain) {
        const ct_ex parts[] = {m->e->kinetic, m->e->potential, m->e->strain};
        compile(d, parts, COUNT(parts), &d->strain);
        d->has_strain = true;
    }
    ct_program_run(&d->strain, m->input);
    memcpy(d->energy, d->strain.out, 3 * sizeof *d->energy);
    d->energy[3] = d->y[d->ny - 1];
    d->energy[4] = d->energy[0] + d->energy[1] + d->energy[2] - d->energy[3];
    d->known |= CT_KNOWS_ENERGY;
    return true;
}

static void find_motion(struct ct_data *d)
{
    struct ct_evaluator *m = ct_run_evaluator(d->sim.run);
    if (d->known & CT_KNOWS_MOTION)
        return;
    ct_data_enter(d);
    ct_evaluator_dynamics(m);
    ct_evaluator_fill_mass(m, d->M, d->nu);
    for (size_t i = 0; i < d->nrow; i++)
        for (size_t k = 0; k < d->nu; k++)
            d->J[i * d->nu + k] = m->J[i + d->nrow * k];
    d->known |= CT_KNOWS_MOTION;
}

struct answer {
    struct ct_ctx *ctx;
    struct ct_data *d;
    enum ct_quantity quantity;
    const double *value;
    size_t rows, columns;
};

static bool give(struct answer *a, const double *value, size_t rows, size_t columns)
{
    a->value = value;
    a->rows = rows;
    a->columns = columns;
    return true;
}

static bool find(struct answer *a)
{
    struct ct_data *d = a->d;
    struct ct_evaluator *m = ct_run_evaluator(d->sim.run);
    const struct ct_partition *s = ct_run_partition(d->sim.run);
    switch (a->quantity) {
    case CT_Q_M:
        find_motion(d);
        return give(a, d->M, d->nu, d->nu);
    case CT_Q_FORCE:
        find_motion(d);
        return give(a, m->Q, d->nu, 1);
    case CT_Q_J:
        find_motion(d);
        return give(a, d->J, d->nrow, d->nu);
    case CT_Q_GAMMA:
        find_motion(d);
        return give(a, m->gam, d->nrow, 1);
    case CT_Q_RATE:
        find_motion(d);
        return give(a, m->rate, d->nq, 1);
    case CT_Q_PHI:
        ct_data_constrain(d);
        return give(a, m->phi, d->nrow, 1);
    case CT_Q_PHI_RATE:
        ct_data_constrain(d);
        return give(a, m->v, d->nrow, 1);
    case CT_Q_ACCELERATION:
        return ct_data_accelerate(d) && give(a, s->a, d->nu, 1);
    case CT_Q_MULTIPLIERS:
        return find_multipliers(d) && give(a, s->lam, d->nrow, 1);
    case CT_Q_OUTPUTS:
        return ct_data_find_outputs(d) && give(a, d->value, m->e->nresult, 1);
    case CT_Q_ENERGY:
        return find_energy(d) && give(a, d->energy, COUNT(d->energy), 1);
    case CT_Q_COORDINATES:
        ct_data_enter(d);
        return give(a, d->y, d->nq, 1);
    case CT_Q_SPEEDS:
        return give(a, d->y + d->nq, d->nu, 1);
    case CT_Q_STATES:
        ct_data_enter(d);
        return give(a, d->y + d->nq + d->nu, m->e->nstate, 1);
    case CT_Q_STATE_RATES:
        return ct_data_accelerate(d) && give(a, s->a + d->nu, m->e->nstate, 1);
    }
    return ct_error(a->ctx, (struct ct_mark){0}, CT_E_VALUE, "there is no quantity %d",
                    (int)a->quantity);
}

static bool answer(void *task)
{
    struct answer *a = task;
    const bool ok = find(a);
    ct_ctx_hand_over(a->ctx, &a->d->sim.own);
    return ok;
}

const double *ct_data_get(struct ct_ctx *ctx, struct ct_data *data, enum ct_quantity quantity,
                          size_t *rows, size_t *columns)
{
    struct answer a = {.ctx = ctx, .d = data, .quantity = quantity};
    const bool is_known
        = data && quantity == CT_Q_ACCELERATION && (data->known & CT_KNOWS_ACCELERATION);
    const bool ok = is_known ? give(&a, ct_run_partition(data->sim.run)->a, data->nu, 1)
                             : ctx && data && ct_enter_plainly(ctx, answer, &a);
    if (rows)
        *rows = ok ? a.rows : 0;
    if (columns)
        *columns = ok ? a.columns : 0;
    return ok ? a.value : NULL;
}

// ---- single values -------------------------------------------------------------------------

static bool find_silently(void *task)
{
    struct answer *a = task;
    const bool ok
        = a->quantity == CT_Q_OUTPUTS ? ct_data_find_outputs(a->d) : find_multipliers(a->d);
    // the caller learns of a failure by NaN
    a->d->sim.own.ndiagnostic = a->d->sim.own.nerror = 0;
    return ok;
}

// Computes a quantity of a const state. Results are cached in it, which does not change its
// value.
static bool know(const struct ct_data *data, enum ct_quantity quantity)
{
    union {
        const struct ct_data *given;
        struct ct_data *data;
    } u = {data};
    struct answer a = {.d = u.data, .quantity = quantity};
    return ct_enter_plainly(&u.data->sim.own, find_silently, &a);
}

double ct_data_value(const struct ct_data *data, enum ct_kind kind, size_t i)
{
    if (!data || i >= ct_system_count(data->origin, kind))
        return NAN;
    const struct ct_model *m = &data->sim.system->model;
    switch (kind) {
    case CT_PARAMETER:
    case CT_INPUT:
        return m->parameter[ct_item_parameter(m, kind, i)].value;
    case CT_COORDINATE:
        return data->y[i];
    case CT_SPEED:
        return data->y[data->nq + i];
    case CT_MULTIPLIER:
        return know(data, CT_Q_MULTIPLIERS) ? ct_run_partition(data->sim.run)->lam[i] : NAN;
    case CT_OUTPUT:
        return know(data, CT_Q_OUTPUTS) ? data->value[i] : NAN;
    case CT_STATE:
        return data->y[data->nq + data->nu + i];
    case CT_FRAME:
    case CT_COMPONENT:
        break;
    }
    return NAN;
}

// ---- frames --------------------------------------------------------------------------------

// Compiles the program for R (row by row) and p of each frame.
static void compile_frames(struct ct_data *d)
{
    struct ct_build *b = d->sim.system->equations.build;
    const size_t n = d->sim.system->model.nframe;
    ct_ex *out = CT_NEWN(d->sim.own.scratch, ct_ex, 12 * n + 1);
    for (size_t i = 0; i < n; i++) {
        const int node = b->topology->node_of_frame[i];
        const ct_ex33 R = ct_node_rotation(b, node);
        const ct_ex3 p = ct_node_position(b, node);
        for (int k = 0; k < 9; k++)
            out[12 * i + (size_t)k] = R.e[k / 3 + 3 * (k % 3)];
        for (int k = 0; k < 3; k++)
            out[12 * i + 9 + (size_t)k] = p.e[k];
    }
    compile(d, out, 12 * n, &d->frames);
    d->has_frames = true;
}

struct posing {
    struct ct_ctx *ctx;
    struct ct_data *d;
    size_t frame;
    double *R, *p;
};

static bool pose(void *task)
{
    const struct posing *s = task;
    struct ct_data *d = s->d;
    if (s->frame >= d->sim.system->model.nframe)
        return ct_error(s->ctx, (struct ct_mark){0}, CT_E_VALUE,
                        "there is no frame %zu, but %zu of them", s->frame,
                        d->sim.system->model.nframe);
    if (!d->has_frames)
        compile_frames(d);
    if (!(d->known & CT_KNOWS_FRAMES)) {
        ct_data_enter(d);
        ct_program_run(&d->frames, ct_run_evaluator(d->sim.run)->input);
        d->known |= CT_KNOWS_FRAMES;
    }
    memcpy(s->R, d->frames.out + 12 * s->frame, 9 * sizeof *s->R);
    memcpy(s->p, d->frames.out + 12 * s->frame + 9, 3 * sizeof *s->p);
    return true;
}

bool ct_data_pose(struct ct_ctx *ctx, struct ct_data *data, size_t frame, double R[9],
                  double p[3])
{
    struct posing s = {ctx, data, frame, R, p};
    return ctx && data && R && p && ct_enter_plainly(ctx, pose, &s);
}
