// States of a system: creation, values, time and steps. See live.h.
#include "live/live.h"

#include "analysis/linearization.h"
#include "numeric/dense.h"
#include "solve/run/run_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct ct_mark none = {0};

// ---- creation ------------------------------------------------------------------------------

static const char *keep(struct ct_arena *a, const char *text)
{
    return text ? ct_arena_strdup(a, text) : NULL;
}

// Chooses a method whose steps have few stages, because the steps of the caller are short.
static void choose_method(struct ct_data *d)
{
    const char *model = d->sim.system->model.simulation.method;
    const bool is_open = !d->options.method || strcmp(d->options.method, "auto") == 0;
    if (is_open && (d->options.method || strcmp(model, "auto") == 0))
        d->options.method = "dopri5";
}

static bool assemble(struct ct_data *d)
{
    struct ct_sim *sim = &d->sim;
    return d->assembly ? ct_assembly_find(d->assembly, &sim->start)
                       : ct_system_assemble(&sim->own, sim->system, &sim->start);
}

static void take_state(struct ct_data *d)
{
    memcpy(d->y, ct_advance_state(d->advance), d->ny * sizeof *d->y);
    d->known = 0;
    d->is_moved = false;
}

static bool start(struct ct_data *d)
{
    d->t = 0;
    d->is_start = true;
    ct_sim_warn_of_singular_start(&d->sim);
    if (!ct_advance_start(d->advance, 0, ct_advance_state(d->advance), true))
        return false;
    take_state(d);
    return true;
}

static bool prepare(struct ct_data *d)
{
    struct ct_sim *sim = &d->sim;
    struct ct_arena *a = sim->own.model;
    struct ct_system *s = sim->system = ct_system_borrow(&sim->own, d->origin);
    struct ct_equations *e = &s->equations;
    d->options.method = keep(a, d->options.method);
    d->options.backend = keep(a, d->options.backend);
    d->options.solver = keep(a, d->options.solver);
    choose_method(d);
    if (!ct_sim_resolve(sim, &d->options))
        return false;
    ct_formulate_dynamics(e);
    if (sim->run_options.method->is_implicit)
        ct_formulate_residual(e);
    if (!s->held_equations.build)
        d->assembly = ct_assembly_create(&sim->own, a, &s->model, &s->start_equations);
    d->is_own = CT_NEWN(a, bool, s->model.nparameter + 1);
    if (!assemble(d)) {
        ct_note_misaligned_joint(&sim->own, a, &s->model);
        return false;
    }
    sim->run = ct_run_prepare(&sim->own, a, &s->model, e);
    if (!ct_sim_choose_solver(sim, d->options.solver) || !ct_run_begin(sim->run, &sim->start)
        || !ct_sim_has_solver(sim) || !ct_sim_choose_backend(sim, d->options.backend))
        return false;
    d->nq = e->nq;
    d->nu = e->nmotion;
    d->nrow = e->nrow;
    d->ny = e->nq + e->nu + 1;
    d->y = CT_NEWN(a, double, d->ny);
    d->M = CT_NEWN(a, double, d->nu * d->nu + 1);
    d->J = CT_NEWN(a, double, d->nrow * d->nu + 1);
    d->value = CT_NEWN(a, double, e->nresult + 1);
    d->advance = ct_advance_create(a, sim->run, &sim->run_options);
    return start(d);
}

static bool create(void *task)
{
    return prepare(task);
}

static struct ct_data *make(struct ct_ctx *ctx, struct ct_system *origin,
                            const struct ct_sim_options *options)
{
    struct ct_data *d = ct_own_alloc(ctx, sizeof *d);
    if (!d)
        return NULL;
    d->origin = origin;
    ct_options_take(&d->options, options, sizeof d->options);
    if (ct_own_enter(ctx, &d->sim.own, create, d))
        return d;
    ct_data_destroy(d);
    return NULL;
}

struct ct_data *ct_data_create(struct ct_ctx *ctx, const struct ct_system *sys,
                               const struct ct_sim_options *options)
{
    union { // removes const: make only copies the system
        const struct ct_system *given;
        struct ct_system *system;
    } u = {sys};
    return ctx && sys ? make(ctx, u.system, options) : NULL;
}

void ct_data_destroy(struct ct_data *data)
{
    if (data)
        ct_own_finish(&data->sim.own);
    free(data);
}

static void take_values(struct ct_data *to, const struct ct_data *from)
{
    struct ct_model *m = &to->sim.system->model;
    const struct ct_model *f = &from->sim.system->model;
    for (size_t i = 0; i < m->nparameter; i++)
        m->parameter[i].value = f->parameter[i].value;
    memcpy(m->value, f->value, (m->nparameter + 1) * sizeof *m->value);
    memcpy(to->is_own, from->is_own, m->nparameter * sizeof *to->is_own);
}

struct copying {
    struct ct_data *to;
    const struct ct_data *from;
};

static bool copy_state(void *task)
{
    const struct copying *c = task;
    struct ct_data *to = c->to;
    const struct ct_data *from = c->from;
    struct ct_evaluator *m = ct_run_evaluator(to->sim.run);
    take_values(to, from);
    memcpy(m->input, ct_run_evaluator(from->sim.run)->input, m->ninput * sizeof *m->input);
    ct_evaluator_prepare(m);
    memcpy(to->y, from->y, to->ny * sizeof *to->y);
    to->t = from->t;
    to->is_start = from->is_start;
    to->known = 0;
    to->is_moved = from->is_moved;
    // chooses rows and columns of the partitioning for this state
    if (!to->is_moved && to->nrow) {
        ct_evaluator_set(m, to->t, to->y);
        ct_evaluator_constraint(m);
        if (!ct_partition_choose(ct_run_partition(to->sim.run)))
            return false;
    }
    if (!to->is_moved && !ct_advance_start(to->advance, to->t, to->y, to->is_start))
        return false;
    ct_advance_set_next_step(to->advance, ct_advance_next_step(from->advance));
    return true;
}

// Runs work on a state and passes its diagnostics on.
struct task {
    struct ct_ctx *ctx;
    struct ct_data *d;
    bool (*work)(void *task);
    void *argument;
};

static bool run_task(void *task)
{
    const struct task *t = task;
    const bool ok = t->work(t->argument);
    ct_ctx_hand_over(t->ctx, &t->d->sim.own);
    return ok;
}

static bool enter(struct ct_ctx *ctx, struct ct_data *d, bool (*work)(void *task),
                  void *argument)
{
    struct task t = {ctx, d, work, argument};
    return ct_enter_plainly(ctx, run_task, &t);
}

struct ct_data *ct_data_clone(struct ct_ctx *ctx, const struct ct_data *data)
{
    if (!ctx || !data)
        return NULL;
    struct ct_data *d = make(ctx, data->origin, &data->options);
    struct copying c = {d, data};
    if (!d || enter(ctx, d, copy_state, &c))
        return d;
    ct_data_destroy(d);
    return NULL;
}

static bool reset(void *task)
{
    struct ct_data *d = task;
    const size_t ninput = ct_run_evaluator(d->sim.run)->ninput;
    double *before = CT_NEWN(d->sim.own.scratch, double, ninput);
    memcpy(before, ct_run_evaluator(d->sim.run)->input, ninput * sizeof *before);
    if (assemble(d) && ct_run_restart(d->sim.run, &d->sim.start))
        return start(d);
    memcpy(ct_run_evaluator(d->sim.run)->input, before, ninput * sizeof *before);
    ct_evaluator_prepare(ct_run_evaluator(d->sim.run));
    d->is_moved = true; // the state is no longer where the run is
    d->known = 0;
    return false;
}

bool ct_data_reset(struct ct_ctx *ctx, struct ct_data *data)
{
    return ctx && data && enter(ctx, data, reset, data);
}

// ---- values --------------------------------------------------------------------------------

struct setting {
    struct ct_ctx *ctx;
    struct ct_data *d;
    enum ct_kind kind;
    const double *value;
    size_t n;
    const char *name; // of one value; NULL: all
};

static bool take_parameter(struct setting *s, size_t i, double value)
{
    struct ct_model *m = &s->d->sim.system->model;
    struct ct_parameter *p = &m->parameter[i];
    if (p->value == value)
        return true;
    if (!isfinite(value))
        return ct_error(s->ctx, none, CT_E_VALUE,
                        "the parameter '%s' would be no finite number", p->name);
    if (p->is_played)
        return ct_error(s->ctx, none, CT_E_DECIDES,
                        "a file plays the input '%s'; load the system without it to set values",
                        p->name);
    if (ct_item_has_decided(s->d->origin, i))
        return ct_error(s->ctx, none, CT_E_DECIDES,
                        "the value of '%s' has decided about the equations; load the system "
                        "anew with '%s' set",
                        p->name, p->name);
    p->value = m->value[ct_ex_node(m->x, p->symbol)->a] = value;
    return true;
}

// Updates the parameters that are defined by others and not set themselves.
static bool derive(struct setting *s)
{
    struct ct_model *m = &s->d->sim.system->model;
    for (size_t i = 0; i < m->nparameter; i++)
        if (!s->d->is_own[i] && !ct_ex_is_const(m->x, m->parameter[i].definition, NULL)
            && !take_parameter(s, i, ct_ex_value(m->x, m->parameter[i].definition, m->value)))
            return false;
    return true;
}

// Sets parameters; restores all of them if one cannot be set.
static bool set_parameters(struct setting *s, size_t one)
{
    struct ct_data *d = s->d;
    struct ct_model *m = &d->sim.system->model;
    struct ct_evaluator *machine = ct_run_evaluator(d->sim.run);
    double *before = machine->input + 1; // the present parameters
    bool ok = true;
    for (size_t i = 0; ok && i < s->n; i++) {
        const size_t k = ct_item_parameter(m, s->kind, s->name ? one : i);
        d->is_own[k] |= m->parameter[k].value != s->value[i];
        ok = take_parameter(s, k, s->value[i]);
    }
    ok = ok && derive(s);
    for (size_t i = 0; i < m->nparameter; i++) {
        struct ct_parameter *p = &m->parameter[i];
        if (ok)
            before[i] = p->value;
        else
            p->value = m->value[ct_ex_node(m->x, p->symbol)->a] = before[i];
    }
    if (ok)
        ct_evaluator_prepare(machine);
    return ok;
}

static bool refuse_kind(struct setting *s)
{
    static const char *const names[]
        = {"parameters", "inputs",  "coordinates", "speeds",    "multipliers",
           "states",     "outputs", "frames",      "components"};
    return ct_error(s->ctx, none, CT_E_KIND, "%s cannot be set",
                    s->kind <= CT_COMPONENT ? names[s->kind] : "such things");
}

static bool set(void *task)
{
    struct setting *s = task;
    struct ct_data *d = s->d;
    if (s->kind > CT_SPEED && s->kind != CT_STATE)
        return refuse_kind(s);
    const size_t count = ct_system_count(d->origin, s->kind);
    long one = 0;
    if (s->name && (one = ct_system_find(d->origin, s->kind, s->name)) < 0) {
        const char **names = CT_NEWN(d->sim.own.scratch, const char *, count + 1);
        for (size_t i = 0; i < count; i++) {
            struct ct_item item;
            ct_system_item(d->origin, s->kind, i, &item);
            names[i] = item.name;
        }
        return ct_error(s->ctx, none, CT_E_NO_SUCH, "there is no '%s' to set%s", s->name,
                        ct_suggest_or_list(s->ctx->model, s->name, names, count));
    }
    if (!s->name && s->n != count)
        return ct_error(s->ctx, none, CT_E_VALUE, "%zu values are given, and there are %zu",
                        s->n, count);
    for (size_t i = 0; i < s->n; i++)
        if (!isfinite(s->value[i]))
            return ct_error(s->ctx, none, CT_E_VALUE, "value %zu is no finite number", i + 1);
    if (s->kind == CT_PARAMETER || s->kind == CT_INPUT) {
        if (!set_parameters(s, (size_t)one))
            return false;
        d->is_changed = true;
        d->known = 0;
        return true;
    }
    const size_t first = s->kind == CT_COORDINATE ? 0
                       : s->kind == CT_SPEED      ? d->nq
                                                  : d->nq + d->nu;
    double *y = d->y + first + one;
    d->is_moved |= memcmp(y, s->value, s->n * sizeof *y) != 0;
    memcpy(y, s->value, s->n * sizeof *y);
    d->known = d->is_moved ? 0 : d->known;
    return true;
}

bool ct_data_set(struct ct_ctx *ctx, struct ct_data *data, enum ct_kind kind,
                 const double *value, size_t n)
{
    struct setting s = {ctx, data, kind, value, n, NULL};
    return ctx && data && (value || !n) && enter(ctx, data, set, &s);
}

bool ct_data_set_one(struct ct_ctx *ctx, struct ct_data *data, enum ct_kind kind,
                     const char *name, double value)
{
    struct setting s = {ctx, data, kind, &value, 1, name};
    return ctx && data && name && enter(ctx, data, set, &s);
}

static bool set_time(void *task)
{
    const struct setting *s = task;
    if (!isfinite(*s->value))
        return ct_error(s->ctx, none, CT_E_VALUE, "the time is no finite number");
    s->d->is_moved |= s->d->t != *s->value;
    s->d->known = s->d->is_moved ? 0 : s->d->known;
    s->d->t = *s->value;
    return true;
}

bool ct_data_set_time(struct ct_ctx *ctx, struct ct_data *data, double t)
{
    struct setting s = {.ctx = ctx, .d = data, .value = &t};
    return ctx && data && enter(ctx, data, set_time, &s);
}

double ct_data_time(const struct ct_data *data)
{
    return data ? data->t : NAN;
}

// ---- moving the run to the state -----------------------------------------------------------

bool ct_data_enter(struct ct_data *d)
{
    struct ct_evaluator *m = ct_run_evaluator(d->sim.run);
    if (!d->is_moved) {
        ct_evaluator_set(m, ct_run_time_before_event(d->sim.run, d->t), d->y);
        return true;
    }
    ct_evaluator_normalise(m, d->y);
    ct_evaluator_set(m, d->t, d->y);
    ct_switches_start(m, d->t, d->y, NULL, NULL);
    ct_memory_update(m);
    d->known = 0;
    return true;
}

void ct_data_constrain(struct ct_data *d)
{
    if (d->known & CT_KNOWS_CONSTRAINT)
        return;
    ct_data_enter(d);
    ct_evaluator_constraint(ct_run_evaluator(d->sim.run));
    d->known |= CT_KNOWS_CONSTRAINT;
}

static bool report_open(struct ct_data *d)
{
    const struct ct_evaluator *m = ct_run_evaluator(d->sim.run);
    const struct ct_equations *e = &d->sim.system->equations;
    size_t worst = 0;
    ct_data_constrain(d);
    for (size_t i = 0; i < m->nrow; i++)
        if (!(fabs(m->phi[i]) <= fabs(m->phi[worst])))
            worst = i;
    const int joint = e->row[worst].joint;
    ct_error(
        &d->sim.own,
        joint < 0 ? (struct ct_mark){.file = d->sim.system->model.file}
                  : d->sim.system->model.joint[joint].mark,
        CT_E_OFF,
        "the state at t = %.9g cannot be assembled: the constraint '%s' is off by %.3g, and "
        "no configuration near it satisfies all constraints",
        d->t, e->row[worst].name, m->phi[worst]);
    for (size_t i = 0; i < m->nrow; i++)
        if (i != worst && fabs(m->phi[i]) > 0.1 * fabs(m->phi[worst]))
            ct_note(&d->sim.own, none, "'%s' is off by %.3g", e->row[i].name, m->phi[i]);
    return false;
}

static bool close_loops(struct ct_data *d)
{
    struct ct_evaluator *m = ct_run_evaluator(d->sim.run);
    if (!d->linear)
        d->linear = ct_linear_create(&d->sim.own, d->sim.own.model, m);
    ct_evaluator_normalise(m, d->y);
    memcpy(d->linear->y, d->y, d->ny * sizeof *d->y);
    d->linear->t = d->t;
    d->is_moved = true;
    d->known = 0;
    if (!ct_linear_close(d->linear))
        return report_open(d);
    memcpy(d->y, d->linear->y, d->ny * sizeof *d->y);
    return true;
}

static bool assemble_state(void *task)
{
    return close_loops(task);
}

bool ct_data_assemble(struct ct_ctx *ctx, struct ct_data *data)
{
    return ctx && data && enter(ctx, data, assemble_state, data);
}

// ---- steps ---------------------------------------------------------------------------------

// Does the state violate the constraints? Projection satisfies them to ct_position_tolerance,
// relative to their scale, which is stricter than the accuracy of outputs.
static bool is_off(struct ct_data *d)
{
    const struct ct_evaluator *m = ct_run_evaluator(d->sim.run);
    if (!m->nrow)
        return false;
    ct_data_constrain(d);
    const double most = fmax(d->sim.tolerance, ct_position_tolerance);
    return !(ct_vector_largest(m->phi, m->nrow) <= most
             && ct_vector_largest(m->v, m->nrow) <= most);
}

// Moves the run to a state that the caller has set, directly or by new parameters.
static bool put(struct ct_data *d)
{
    struct ct_evaluator *m = ct_run_evaluator(d->sim.run);
    const bool was_off = is_off(d);
    if (was_off && !close_loops(d))
        return false;
    if (!d->is_moved && d->is_changed && !ct_advance_refresh(d->advance, d->t))
        return false;
    d->is_changed = false;
    if (!d->is_moved)
        return true;
    ct_data_enter(d);
    if (m->nrow) {
        ct_evaluator_constraint(m);
        if (!ct_partition_choose(ct_run_partition(d->sim.run)))
            return false;
    }
    if (!ct_advance_start(d->advance, d->t, d->y, false))
        return false;
    take_state(d);
    d->is_start = false;
    return true;
}

struct stride {
    struct ct_ctx *ctx;
    struct ct_data *d;
    double dt;
};

static bool step(void *task)
{
    const struct stride *s = task;
    struct ct_data *d = s->d;
    if (!(s->dt >= 0) || !isfinite(d->t + s->dt))
        return ct_error(s->ctx, none, CT_E_VALUE, "a step of %g s cannot be taken", s->dt);
    if (!put(d))
        return false;
    if (d->t + s->dt == d->t)
        return true;
    struct ct_ctx *said;
    double t;
    const bool ok = ct_advance_to(d->advance, d->t, d->t + s->dt, &t, &said);
    if (!ok) { // as for runs: notes follow the error
        ct_ctx_hand_over(s->ctx, said);
        t = t > d->t ? t : d->t;
    }
    d->t = t;
    d->is_start = false;
    take_state(d);
    return ok;
}

bool ct_data_step(struct ct_ctx *ctx, struct ct_data *data, double dt)
{
    struct stride s = {ctx, data, dt};
    return ctx && data && enter(ctx, data, step, &s);
}
