// Members of a study: each thread is a worker with a system of its own. See study.h.
#include "study/study.h"

#include "base/guard.h"
#include "solve/batch/batch.h"

#include <stdlib.h>
#include <string.h>

// The data of one thread.
struct worker {
    struct ct_study *s;
    struct ct_system *system;
    struct ct_ctx member_ctx; // diagnostics of the reader about a member
    struct ct_sim sim;        // its run also serves the lanes
    struct ct_assembly *assembly;
    struct ct_batch *group[CT_BATCH_GROUPS]; // batches, stepped in turn
    int ngroup;
    long member[CT_BATCH_GROUPS][CT_LANES];
    double *value; // results of a member  (nresult)
};

// ---- what workers share --------------------------------------------------------------------

// Takes the next member; -1 if there is none.
static long take_member(struct ct_study *s)
{
    long member = -1;
    pthread_mutex_lock(&s->rows);
    while (s->next < s->plan.nmember && s->row[s->next].state != CT_ROW_PENDING)
        s->next++;
    if (s->next < s->plan.nmember && !s->is_stopped && !s->no_memory
        && !ct_guard_is_interrupted())
        member = s->next++;
    pthread_mutex_unlock(&s->rows);
    return member;
}

static void count_steps(struct ct_study *s, long steps, long rejected, long alone)
{
    pthread_mutex_lock(&s->rows);
    s->steps += steps;
    s->rejected += rejected;
    s->nalone += alone;
    pthread_mutex_unlock(&s->rows);
}

static void lose_memory(struct ct_study *s)
{
    pthread_mutex_lock(&s->rows);
    s->no_memory = true;
    pthread_mutex_unlock(&s->rows);
}

// ---- a member ------------------------------------------------------------------------------

// The texts NAME=VALUE of a member after those of the command line. member -1: the values of
// the file.
static const char **member_set(const struct ct_study *s, struct ct_arena *a, long member,
                               size_t *n)
{
    const struct ct_system_options *o = &s->system_options;
    double *value = CT_NEWN(a, double, s->plan.naxis + 1);
    for (size_t i = 0; i < s->plan.naxis; i++)
        value[i] = member < 0 ? s->base[i] : ct_plan_value(&s->plan, member, i);
    *n = o->nset;
    return ct_plan_settings(a, &s->plan, value, o->set, n);
}

// Copies the values of a member, as read by the reader, into the worker's system, `simulation`
// included.
static void take_values(struct ct_model *to, const struct ct_model *from)
{
    const struct ct_simulation *m = &from->simulation;
    for (size_t i = 0; i < to->nparameter; i++)
        to->parameter[i].value = from->parameter[i].value;
    // the first value is t
    memcpy(to->value, from->value, (to->nparameter + 1) * sizeof *to->value);
    to->simulation.duration = m->duration;
    to->simulation.samples = m->samples;
    to->simulation.interval = m->interval;
    to->simulation.rtol = m->rtol;
    to->simulation.atol = m->atol;
    to->simulation.step = m->step;
}

static bool set_member(struct worker *w, long member)
{
    struct ct_study *s = w->s;
    struct ct_ctx *ctx = &w->member_ctx;
    ct_own_finish(ctx);
    *ctx = (struct ct_ctx){0};
    ct_own_init(ctx);
    size_t n;
    const char **text = member_set(s, ctx->model, member, &n);
    struct ct_set *set = CT_NEWN(ctx->model, struct ct_set, n + 1);
    for (size_t i = 0; i < n; i++)
        set[i].text = text[i];
    struct ct_model model;
    if (!ct_model_resolve(ctx, s->path, s->root, set, n, &model))
        return false;
    take_values(&w->system->model, &model);
    return true;
}

// Runs a member as `simulate` does, but without intermediate samples if steps do not end at
// them.
static void run_alone(struct ct_study *s, long member, struct ct_ctx *ctx,
                      struct ct_system *system)
{
    struct ct_sim_options o = s->run;
    if (system && !(o.step > 0) && !(system->model.simulation.step > 0))
        o.samples = 2;
    struct ct_sim *sim = ct_sim_create(ctx, system, &o);
    if (!sim) {
        ct_study_record(s, member, NULL, ctx);
        return;
    }
    sim->run_options.take = s->take;
    sim->run_options.ntake = s->ntake;
    const bool ok = ct_sim_run(ctx, sim, NULL);
    ct_study_record(s, member, ok ? sim->report.final : NULL, ctx);
    count_steps(s, sim->report.stats.steps, sim->report.stats.rejected_steps, 1);
    ct_sim_destroy(sim);
}

// Runs a member in the worker's system, which has its values.
static void run_own(struct worker *w, long member)
{
    struct ct_ctx *ctx = ct_ctx_create();
    if (!ctx) {
        lose_memory(w->s);
        return;
    }
    run_alone(w->s, member, ctx, w->system);
    ct_ctx_destroy(ctx);
}

static void run_derived(struct worker *w, long member)
{
    struct ct_study *s = w->s;
    struct ct_ctx *ctx = ct_ctx_create();
    if (!ctx) {
        lose_memory(s);
        return;
    }
    struct ct_system_options o = s->system_options;
    o.set = member_set(s, ctx->model, member, &o.nset);
    struct ct_system *system = ct_system_load_text(ctx, s->text, s->ntext, s->path, &o);
    run_alone(s, member, ctx, system);
    ct_system_destroy(system);
    ct_ctx_destroy(ctx);
}

// ---- members in lanes ----------------------------------------------------------------------

static void forget_errors(struct ct_ctx *ctx)
{
    ctx->ndiagnostic = ctx->nerror = 0;
}

static bool start_member(struct worker *w)
{
    struct ct_initial_state start;
    return ct_assembly_find(w->assembly, &start) && ct_run_restart(w->sim.run, &start)
        && ct_sim_resolve(&w->sim, &w->s->run);
}

// Puts the next member that a batch can run into a lane. False if there are no more members.
static bool fill_lane(struct worker *w, int group, int lane)
{
    struct ct_study *s = w->s;
    for (long member; (member = take_member(s)) >= 0;) {
        if (!set_member(w, member)) {
            ct_study_record(s, member, NULL, &w->member_ctx);
        } else if (!start_member(w)) {
            ct_study_record(s, member, NULL, &w->sim.own);
            forget_errors(&w->sim.own);
        } else if (ct_batch_load(w->group[group], lane, &w->sim.run_options)) {
            w->member[group][lane] = member;
            return true;
        } else {
            forget_errors(&w->sim.own);
            run_own(w, member);
        }
    }
    return false;
}

static void empty_lane(struct worker *w, int group, int lane)
{
    const long member = w->member[group][lane];
    struct ct_batch *lanes = w->group[group];
    const bool has_arrived = ct_batch_state(lanes, lane) == CT_LANE_ARRIVED;
    if (has_arrived && ct_batch_results(lanes, lane, w->value)) {
        ct_study_record(w->s, member, w->value, &w->sim.own);
    } else { // the file was read before
        forget_errors(&w->sim.own);
        if (set_member(w, member))
            run_own(w, member);
    }
    ct_batch_free(lanes, lane);
}

static void create_groups(struct worker *w)
{
    struct ct_sim *sim = &w->sim;
    w->ngroup = w->s->lanes / CT_LANES;
    for (int g = 0; g < w->ngroup; g++)
        w->group[g]
            = ct_batch_create(sim->own.model, &w->system->equations, sim->run, w->s->ntake);
    // compiled with the file's own values, so that all workers have the same programs
    if (start_member(w))
        for (int g = 0; g < w->ngroup; g++)
            ct_batch_begin(w->group[g]);
    forget_errors(&sim->own);
}

// Tries a step in all lanes of a batch. False: all lanes are empty, and no members are left.
static bool step_group(struct worker *w, int group)
{
    bool is_running = false;
    for (int l = 0; l < CT_LANES; l++) {
        const enum ct_lane_state state = ct_batch_state(w->group[group], l);
        if (state != CT_LANE_RUNNING && state != CT_LANE_IDLE)
            empty_lane(w, group, l);
        is_running |= state == CT_LANE_RUNNING || fill_lane(w, group, l);
    }
    if (is_running)
        ct_batch_step(w->group[group]);
    return is_running;
}

static void run_lanes(struct worker *w)
{
    struct ct_sim *sim = &w->sim;
    w->assembly = ct_assembly_create(&sim->own, sim->own.model, &w->system->model,
                                     &w->system->start_equations);
    create_groups(w);
    w->value = CT_NEWN(sim->own.model, double, w->system->equations.nresult + 1);
    for (bool is_running = true; is_running && !ct_guard_is_interrupted();) {
        is_running = false;
        for (int g = 0; g < w->ngroup; g++)
            is_running |= step_group(w, g);
    }
    for (int g = 0; g < w->ngroup; g++) {
        const struct ct_batch_counts count = ct_batch_counts(w->group[g]);
        count_steps(w->s, count.steps, count.rejected, 0);
    }
}

// ---- workers -------------------------------------------------------------------------------

// Loads the system with the varied parameters as numbers, so that all members have the same
// order of parameters.
struct ct_system *ct_study_load_system(struct ct_ctx *ctx, const struct ct_study *s)
{
    struct ct_system_options o = s->system_options;
    o.set = member_set(s, ctx->model, -1, &o.nset);
    struct ct_system *system = ct_system_load_text(ctx, s->text, s->ntext, s->path, &o);
    if (system)
        system->is_private = true; // later derivations are shared by all members
    return system;
}

static bool work(void *task)
{
    struct worker *w = task;
    struct ct_study *s = w->s;
    if (s->is_derived) {
        for (long member; (member = take_member(s)) >= 0;)
            run_derived(w, member);
        return true;
    }
    ct_own_init(&w->member_ctx);
    ct_own_init(&w->sim.own);
    w->sim.take = s->take;
    w->sim.ntake = s->ntake;
    if (!w->system) // text and options are those with which the first worker was loaded
        w->system = ct_study_load_system(&w->sim.own, s);
    if (!w->system || !ct_sim_prepare(&w->sim, w->system, &s->run))
        return false;
    if (!s->alone_by) {
        run_lanes(w);
        return true;
    }
    for (long member; (member = take_member(s)) >= 0;)
        if (set_member(w, member))
            run_own(w, member);
        else
            ct_study_record(s, member, NULL, &w->member_ctx);
    return true;
}

// Runs one worker. A worker that cannot start leaves its members to the others. The first
// worker has its system already.
static void run_worker(struct ct_study *s, bool is_first)
{
    struct worker w = {.s = s, .system = is_first ? s->system : NULL};
    struct ct_ctx *ctx = ct_ctx_create();
    if (ctx)
        ctx->cancelled = &s->caller->is_cancelled;
    if (!ctx
        || (!ct_enter(ctx, work, &w) && !ctx->was_interrupted && (is_first || ctx->no_memory)))
        lose_memory(s);
    ct_ctx_destroy(ctx);
    ct_own_finish(&w.sim.own);
    ct_own_finish(&w.member_ctx);
    if (!is_first)
        ct_system_destroy(w.system);
}

static void *run_other_worker(void *study)
{
    run_worker(study, false);
    return NULL;
}

// Threads are created for each sweep, so that a process may fork between two sweeps.
void ct_study_run_members(struct ct_study *s)
{
    pthread_t *thread = calloc((size_t)s->threads, sizeof *thread);
    int n = 1; // this thread is the first worker
    while (thread && n < s->threads
           && pthread_create(&thread[n], NULL, run_other_worker, s) == 0)
        n++;
    run_worker(s, true);
    for (int i = 1; i < n; i++)
        pthread_join(thread[i], NULL);
    free(thread);
}
