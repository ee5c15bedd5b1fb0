// Parameter studies: members run in lanes and on all cores, a row for each.
//
//     file -> text -> [ worker: system, assembly, run, lanes ] x threads -> rows in order -> FILE
//
// Parameters are inputs of the generated programs. A member is read again from the parsed text of the file with
// its values, so that whatever the reader refuses is refused here too, and so that initial values and `simulation`
// may depend on what varies; then its values go into the worker's own system, whose equations stay. Three ways:
//
//     in lanes    the usual one; see solve/lanes.h
//     alone       where lanes cannot be: other methods, switches, tables, what a lane has given up
//     derived     a system for each member, where a value decides about the equations: in ct_exs.decided
//
// What always holds: what a row says depends on its member alone, not on threads, lanes or order; workers share
// only what is constant and, one at a time, the rows.
#include "api.h"
#include "plan.h"

#include "io/text.h"
#include "io/yaml.h"
#include "report/json.h"
#include "report/number.h"
#include "report/progress.h"
#include "solve/lanes.h"

#ifdef _OPENMP
#include <omp.h>
#endif

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const struct ct_mark none = {0};
static const double seconds_between_flushes = 0.5; // what an interruption may cost at most
enum { MOST_TEXT = 64 << 20, MOST_THREADS = 1024, MOST_SHOWN = 10 };

struct row {
    enum { PENDING, DONE, FAILED, RESUMED, RESUMED_FAILED } state;
    int code;      // of the first error
    double *value; // nresult, until it is written
    char *message;
};

struct ct_study {
    struct ct_ctx own;
    const char *path;
    char *text; // of the model file
    size_t ntext;
    const struct ct_node *root;              // the same, parsed
    struct ct_system_options system_options; // with strings in own.model
    struct ct_sim_options run;
    struct ct_plan plan;
    double *base;             // what the file says of its axes
    struct ct_system *system; // with the values of the file; that of the first worker
    bool is_derived;          // each member needs equations of its own
    const char *derived_by;   // the parameter that is why
    const char *alone_by;     // why no member is in lanes; NULL: they are
    int threads, lanes;
    const char *method, *backend;
    double tolerance;
    const struct ct_study_results *results;
    struct ct_result_sink {
        bool is_json, is_open, has_failed;
        struct ct_csv csv;
        struct ct_outfile json;
        double flushed;
    } sink;
    struct ct_progress progress;
    struct row *row;
    double *varied;                                       // values of a row  (naxis)
    long next, written, ndone, nfailed, nresumed, nalone; // next: member to run
    long steps, rejected;
    bool is_stopped, no_memory, has_run;
    double seconds;
};

// One thread's own.
struct worker {
    struct ct_study *s;
    struct ct_system *system;
    struct ct_ctx member_ctx; // what the reader says about a member
    struct ct_sim sim;        // its run is the companion of the lanes
    struct ct_assembly *assembly;
    struct ct_lanes *lanes;
    long member[CT_LANES];
    double *value; // results of a member  (nresult)
};

// ---- rows ---------------------------------------------------------------------------------------------

static const char **column_names(struct ct_study *s, size_t *n)
{
    const struct ct_equations *e = &s->system->equations;
    const char **name = CT_NEWN(s->own.model, const char *, s->plan.naxis + e->nresult + 2);
    *n = 0;
    name[(*n)++] = "run";
    for (size_t i = 0; i < s->plan.naxis; i++)
        name[(*n)++] = s->plan.axis[i].name;
    for (size_t i = 0; i < e->nresult; i++)
        name[(*n)++] = e->result[i].name;
    name[(*n)++] = "status";
    return name;
}

static bool write_row(struct ct_study *s, long member, const double *value)
{
    struct ct_csv *w = &s->sink.csv;
    const size_t n = s->system->equations.nresult;
    ct_csv_number(w, (double)(member + 1));
    for (size_t i = 0; i < s->plan.naxis; i++)
        ct_csv_number(w, ct_plan_value(&s->plan, member, i));
    for (size_t i = 0; i < n; i++)
        if (value)
            ct_csv_number(w, value[i]);
        else
            ct_csv_text(w, "");
    ct_csv_number(w, value ? 0 : 1);
    if (!ct_csv_end_row(&s->own, w))
        return false;
    const double now = ct_clock();
    if (now - s->sink.flushed < seconds_between_flushes)
        return true;
    s->sink.flushed = now;
    return ct_outfile_flush(&s->own, &w->file);
}

static bool give_row(struct ct_study *s, long member, const struct row *row)
{
    const struct ct_study_results *r = s->results;
    if (!r->row)
        return true;
    for (size_t i = 0; i < s->plan.naxis; i++)
        s->varied[i] = ct_plan_value(&s->plan, member, i);
    return r->row(r->user, member + 1, s->varied, row->value, row->message);
}

// Rows that are complete from the first on go out; the rest waits for them.
static void write_rows(struct ct_study *s)
{
    for (; s->written < s->plan.nmember && !s->is_stopped; s->written++) {
        struct row *row = &s->row[s->written];
        if (row->state == PENDING)
            return;
        if (row->state == RESUMED || row->state == RESUMED_FAILED)
            continue;
        const bool is_csv = s->sink.is_open && !s->sink.is_json;
        if (is_csv && !write_row(s, s->written, row->value))
            s->is_stopped = s->sink.has_failed = true;
        else if (!give_row(s, s->written, row))
            s->is_stopped = true;
        if (!s->sink.is_json) {
            free(row->value);
            row->value = NULL;
        }
    }
}

// FILE:LINE:COLUMN: TEXT [CODE] of the first error, on the heap.
static char *message_of(const struct ct_ctx *ctx, int *code)
{
    for (size_t i = 0; i < ctx->ndiagnostic; i++) {
        const struct ct_diagnostic *d = &ctx->diagnostic[i];
        if (d->severity != CT_SEVERITY_ERROR)
            continue;
        const size_t n = strlen(d->text) + (d->mark.file ? strlen(d->mark.file) : 0) + 64;
        char *text = malloc(n);
        *code = (int)d->code;
        if (text && d->mark.file)
            snprintf(text, n, "%s:%d:%d: %s [E%03d]", d->mark.file, d->mark.line + 1,
                     d->mark.column + 1, d->text, *code);
        else if (text)
            snprintf(text, n, "%s [E%03d]", d->text, *code);
        return text;
    }
    *code = CT_E_MEMORY;
    return strdup("out of memory");
}

static double *copy_values(const double *value, size_t n)
{
    double *copy = malloc((n + 1) * sizeof *copy);
    if (copy)
        memcpy(copy, value, n * sizeof *copy);
    return copy;
}

// A member is over; value NULL: it failed with the errors in ctx.
static void record(struct ct_study *s, long member, const double *value,
                   const struct ct_ctx *ctx)
{
    struct row row = {.state = value ? DONE : FAILED};
    if (value)
        row.value = copy_values(value, s->system->equations.nresult);
    else
        row.message = message_of(ctx, &row.code);
#ifdef _OPENMP
#pragma omp critical(ct_study_rows)
#endif
    {
        s->no_memory |= value ? !row.value : !row.message;
        if (value && !row.value)
            row.state = PENDING;
        s->row[member] = row;
        s->ndone++;
        s->nfailed += !value;
        write_rows(s);
        ct_progress_update(&s->progress, (double)s->ndone / (double)s->plan.nmember);
    }
}

// The next member, or -1 when there is none.
static long take_member(struct ct_study *s)
{
    long member = -1;
#ifdef _OPENMP
#pragma omp critical(ct_study_rows)
#endif
    {
        while (s->next < s->plan.nmember && s->row[s->next].state != PENDING)
            s->next++;
        if (s->next < s->plan.nmember && !s->is_stopped && !s->no_memory)
            member = s->next++;
    }
    return member;
}

static void count_steps(struct ct_study *s, long steps, long rejected, long alone)
{
#ifdef _OPENMP
#pragma omp critical(ct_study_rows)
#endif
    {
        s->steps += steps;
        s->rejected += rejected;
        s->nalone += alone;
    }
}

static void lose_memory(struct ct_study *s)
{
#ifdef _OPENMP
#pragma omp critical(ct_study_rows)
#endif
    s->no_memory = true;
}

// ---- a member -----------------------------------------------------------------------------------------

// The texts NAME=VALUE of a member behind those of the command line; member -1: what the file says.
static const char **member_set(const struct ct_study *s, struct ct_arena *a, long member,
                               size_t *n)
{
    const struct ct_system_options *o = &s->system_options;
    const char **set = CT_NEWN(a, const char *, o->nset + s->plan.naxis + 1);
    *n = 0;
    for (size_t i = 0; i < o->nset; i++)
        set[(*n)++] = o->set[i];
    for (size_t i = 0; i < s->plan.naxis; i++) {
        char text[CT_NUMBER_SIZE];
        const double value = member < 0 ? s->base[i] : ct_plan_value(&s->plan, member, i);
        set[(*n)++]
            = ct_arena_printf(a, "%s=%s", s->plan.axis[i].name, ct_number_format(text, value));
    }
    return set;
}

// The worker's system takes the values of the member as read by the reader, `simulation` included.
static void take_values(struct ct_model *to, const struct ct_model *from)
{
    const struct ct_simulation *m = &from->simulation;
    for (size_t i = 0; i < to->nparameter; i++)
        to->parameter[i].value = from->parameter[i].value;
    memcpy(to->value, from->value, (to->nparameter + 1) * sizeof *to->value); // t is the first
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

// As `simulate` does it, without samples on the way where steps do not end on them.
static void run_alone(struct ct_study *s, long member, struct ct_ctx *ctx,
                      struct ct_system *system)
{
    struct ct_sim_options o = s->run;
    if (system && !(o.step > 0) && !(system->model.simulation.step > 0))
        o.samples = 2;
    struct ct_sim *sim = ct_sim_create(ctx, system, &o);
    const bool ok = ct_sim_run(ctx, sim, NULL);
    record(s, member, ok ? sim->report.final : NULL, ctx);
    if (sim)
        count_steps(s, sim->report.stats.steps, sim->report.stats.rejected_steps, 1);
    ct_sim_destroy(sim);
}

// The worker's system has the values of the member.
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
    struct ct_system *system = ct_system_load(ctx, s->path, &o);
    run_alone(s, member, ctx, system);
    ct_system_destroy(system);
    ct_ctx_destroy(ctx);
}

// ---- members in lanes ---------------------------------------------------------------------------------

static void forget_errors(struct ct_ctx *ctx)
{
    ctx->ndiagnostic = ctx->nerror = 0;
}

static bool start_member(struct worker *w)
{
    struct ct_start start;
    return ct_assembly_find(w->assembly, &start) && ct_run_restart(w->sim.run, &start)
        && ct_sim_resolve(&w->sim, &w->s->run);
}

// Put the next member that lanes can take into one; false when there are no more.
static bool fill_lane(struct worker *w, int lane)
{
    struct ct_study *s = w->s;
    for (long member; (member = take_member(s)) >= 0;) {
        if (!set_member(w, member)) {
            record(s, member, NULL, &w->member_ctx);
        } else if (!start_member(w)) {
            record(s, member, NULL, &w->sim.own);
            forget_errors(&w->sim.own);
        } else if (ct_lanes_load(w->lanes, lane, &w->sim.run_options)) {
            w->member[lane] = member;
            return true;
        } else {
            run_own(w, member);
        }
    }
    return false;
}

static void empty_lane(struct worker *w, int lane)
{
    const long member = w->member[lane];
    const bool has_arrived = ct_lanes_state(w->lanes, lane) == CT_LANE_ARRIVED;
    if (has_arrived && ct_lanes_results(w->lanes, lane, w->value)) {
        record(w->s, member, w->value, NULL);
    } else { // it is known to be readable
        forget_errors(&w->sim.own);
        if (set_member(w, member))
            run_own(w, member);
    }
    ct_lanes_free(w->lanes, lane);
}

static void run_lanes(struct worker *w)
{
    struct ct_sim *sim = &w->sim;
    w->assembly = ct_assembly_create(&sim->own, sim->own.model, &w->system->model,
                                     &w->system->start_equations);
    w->lanes = ct_lanes_create(sim->own.model, &w->system->equations, sim->run);
    // at the file's own values, which the system still has: the same in each worker
    if (start_member(w))
        ct_lanes_unroll(sim->own.model, w->lanes);
    forget_errors(&sim->own);
    w->value = CT_NEWN(sim->own.model, double, w->system->equations.nresult + 1);
    for (;;) {
        bool is_running = false;
        for (int l = 0; l < CT_LANES; l++) {
            const enum ct_lane_state state = ct_lanes_state(w->lanes, l);
            if (state != CT_LANE_RUNNING && state != CT_LANE_IDLE)
                empty_lane(w, l);
            is_running |= state == CT_LANE_RUNNING || fill_lane(w, l);
        }
        if (!is_running)
            break;
        ct_lanes_step(w->lanes);
    }
    const struct ct_lanes_count count = ct_lanes_count(w->lanes);
    count_steps(w->s, count.steps, count.rejected, 0);
}

// ---- workers ------------------------------------------------------------------------------------------

// With what varies as numbers, so that all members order their parameters alike.
static struct ct_system *load(struct ct_ctx *ctx, const struct ct_study *s)
{
    struct ct_system_options o = s->system_options;
    o.set = member_set(s, ctx->model, -1, &o.nset);
    return ct_system_load(ctx, s->path, &o);
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
    if (!w->system) // text and options are those of the first, which could be loaded
        w->system = load(&w->sim.own, s);
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
            record(s, member, NULL, &w->member_ctx);
    return true;
}

// A worker that cannot start leaves its members to the others; the first one's system is there already.
static void run_worker(struct ct_study *s, int thread)
{
    struct worker w = {.s = s, .system = thread == 0 ? s->system : NULL};
    struct ct_ctx *ctx = ct_ctx_create();
    if (!ctx || (!ct_enter(ctx, work, &w) && (thread == 0 || ctx->no_memory)))
        lose_memory(s);
    ct_ctx_destroy(ctx);
    ct_own_finish(&w.sim.own);
    ct_own_finish(&w.member_ctx);
    if (thread > 0)
        ct_system_destroy(w.system);
}

static void run_workers(struct ct_study *s)
{
#ifdef _OPENMP
#pragma omp parallel num_threads(s->threads)
    run_worker(s, omp_get_thread_num());
#else
    run_worker(s, 0);
#endif
}

static int count_threads(const struct ct_study *s, long wanted)
{
#ifdef _OPENMP
    const long most = (s->plan.nmember + s->lanes - 1) / s->lanes;
    long n = wanted > 0 ? wanted : omp_get_max_threads();
    n = n < most ? n : most;
    return (int)(n < MOST_THREADS ? n : MOST_THREADS);
#else
    (void)s;
    (void)wanted;
    return 1;
#endif
}

// ---- preparation --------------------------------------------------------------------------------------

// Parameters that change with the axes, directly or through definitions.
static bool *find_changing(struct ct_study *s, const struct ct_model *m)
{
    bool *changes = CT_NEWN(s->own.scratch, bool, m->nparameter + 1);
    for (size_t i = 0; i < s->plan.naxis; i++)
        changes[ct_names_get(&m->parameter_index, s->plan.axis[i].name)] = true;
    for (size_t i = 0; i < m->nparameter; i++) // a definition uses those before it
        for (size_t k = ct_ex_walk(m->x, &m->parameter[i].definition, 1); k-- > 0;) {
            const struct ct_sym *sym = ct_ex_symbol(m->x, (ct_ex){m->x->stack[k]});
            changes[i] |= sym && sym->kind == CT_SYM_PARAM && changes[sym->index];
        }
    return changes;
}

// Does one of them decide about the equations?
static void find_deciding(struct ct_study *s)
{
    const struct ct_model *m = &s->system->model;
    const unsigned char *const decided[]
        = {m->decided, s->system->equations.x->decided, s->system->start_equations.x->decided,
           s->system->held_equations.x ? s->system->held_equations.x->decided : NULL};
    const bool *changes = find_changing(s, m);
    for (size_t i = 0; i < m->nparameter && !s->is_derived; i++)
        for (size_t k = 0; k < COUNT(decided); k++)
            if (changes[i] && decided[k]
                && decided[k][ct_ex_node(m->x, m->parameter[i].symbol)->a]) {
                s->is_derived = true;
                s->derived_by = m->parameter[i].name;
            }
}

static const char *copy_text(struct ct_arena *a, const char *text)
{
    return text ? ct_arena_strdup(a, text) : NULL;
}

static void take_options(struct ct_study *s, const char *path,
                         const struct ct_system_options *system,
                         const struct ct_study_options *o)
{
    struct ct_arena *a = s->own.model;
    const char **set = CT_NEWN(a, const char *, system->nset + 1);
    for (size_t i = 0; i < system->nset; i++)
        set[i] = ct_arena_strdup(a, system->set[i]);
    s->path = ct_arena_strdup(a, path);
    s->system_options = *system;
    s->system_options.set = set;
    s->system_options.tree = copy_text(a, system->tree);
    s->run = o->run;
    s->run.method = copy_text(a, o->run.method);
    s->run.backend = copy_text(a, o->run.backend);
}

static bool read_text(struct ct_study *s)
{
    const enum ct_text_result e
        = ct_text_read(s->own.model, s->path, MOST_TEXT, &s->text, &s->ntext);
    return e == CT_TEXT_OK
        || ct_error(&s->own, none, CT_E_FILE, "cannot read '%s'%s", s->path,
                    e == CT_TEXT_TOO_BIG ? ": it is too big" : "");
}

// Method, back end and end time of the file's own values, and whether lanes are possible.
static bool choose_way(struct ct_study *s, const struct ct_study_options *o)
{
    struct ct_sim *probe = CT_NEW(s->own.model, struct ct_sim);
    probe->own = s->own;
    const bool ok = ct_sim_prepare(probe, s->system, &s->run);
    s->own = probe->own; // with what it says
    if (!ok)
        return false;
    const struct ct_simulation *m = &s->system->model.simulation;
    if (!m->has_duration && !(s->run.until > 0))
        return ct_error(&s->own, m->mark, CT_E_KEY_MISSING,
                        "there is no end time: 'simulation' needs a 'duration'");
    s->method = probe->run_options.method->name;
    s->tolerance = probe->tolerance;
    s->backend = ct_run_machine(probe->run)->backend;
    s->alone_by = o->lanes == 1 ? "as asked"
                : s->system->held_equations.build
                    ? "beams start in equilibrium"
                    : ct_lanes_refusal(&s->system->equations, &probe->run_options);
    if (s->is_derived)
        s->alone_by = ct_arena_printf(s->own.model, "the equations depend on the value of '%s'",
                                      s->derived_by);
    s->lanes = s->alone_by ? 1 : CT_LANES;
    if (o->lanes != 0 && o->lanes != 1 && o->lanes != CT_LANES)
        return ct_error(&s->own, none, CT_E_USAGE, "there are no %ld lanes; there are 1 and %d",
                        o->lanes, CT_LANES);
    return true;
}

static bool prepare(struct ct_study *s, const struct ct_study_options *o)
{
    struct ct_model file;
    const struct ct_system_options *so = &s->system_options;
    struct ct_set *set = CT_NEWN(s->own.model, struct ct_set, so->nset + 1);
    for (size_t i = 0; i < so->nset; i++)
        set[i].text = so->set[i];
    if (!read_text(s) || !ct_yaml_parse(&s->own, s->path, s->text, s->ntext, &s->root)
        || !ct_model_resolve(&s->own, s->path, s->root, set, so->nset, &file)
        || !ct_plan_read(&s->own, &file, o->vary, o->nvary, o->sample, o->seed, &s->plan))
        return false;
    s->base = CT_NEWN(s->own.model, double, s->plan.naxis);
    for (size_t i = 0; i < s->plan.naxis; i++)
        s->base[i]
            = file.parameter[ct_names_get(&file.parameter_index, s->plan.axis[i].name)].value;
    s->system = load(&s->own, s);
    if (!s->system)
        return false;
    find_deciding(s);
    if (!choose_way(s, o))
        return false;
    s->threads = count_threads(s, o->threads);
    s->varied = CT_NEWN(s->own.model, double, s->plan.naxis + 1);
    s->row = calloc((size_t)s->plan.nmember, sizeof *s->row);
    if (!s->row)
        s->own.no_memory = true;
    return s->row;
}

struct create {
    struct ct_ctx *ctx;
    struct ct_study *s;
    const char *path;
    const struct ct_system_options *system;
    const struct ct_study_options *options;
};

static bool create(void *task)
{
    struct create *c = task;
    ct_own_init(&c->s->own);
    take_options(c->s, c->path, c->system, c->options);
    const bool ok = prepare(c->s, c->options);
    c->ctx->no_memory |= c->s->own.no_memory;
    ct_ctx_hand_over(c->ctx, &c->s->own);
    return ok;
}

struct ct_study *ct_study_create(struct ct_ctx *ctx, const char *path,
                                 const struct ct_system_options *system,
                                 const struct ct_study_options *options)
{
    static const struct ct_system_options standard;
    struct create c = {ctx, calloc(1, sizeof *c.s), path, system ? system : &standard, options};
    if (!c.s) {
        ctx->no_memory = true;
        return NULL;
    }
    if (ct_enter(ctx, create, &c))
        return c.s;
    ct_study_destroy(c.s);
    return NULL;
}

void ct_study_destroy(struct ct_study *s)
{
    if (!s)
        return;
    for (long i = 0; s->row && i < s->plan.nmember; i++) {
        free(s->row[i].value);
        free(s->row[i].message);
    }
    free(s->row);
    ct_system_destroy(s->system);
    ct_own_finish(&s->own);
    free(s);
}

// ---- the file -----------------------------------------------------------------------------------------

static bool has_suffix(const char *path, const char *suffix)
{
    const size_t n = strlen(path), k = strlen(suffix);
    return n >= k && strcmp(path + n - k, suffix) == 0;
}

// What the file begins with, on the heap.
static char *header_text(struct ct_study *s)
{
    char *text = NULL;
    size_t size, n;
    const char **name = column_names(s, &n);
    struct ct_csv w = {.ncolumn = n};
    w.file.stream = open_memstream(&text, &size);
    if (!w.file.stream)
        return NULL;
    for (size_t i = 0; i < n; i++)
        ct_csv_text(&w, name[i]);
    fputc('\n', w.file.stream);
    return fclose(w.file.stream) == 0 ? text : NULL;
}

// Is this the row of the member, and how did that end? -1: it is not.
static int read_status(const struct ct_study *s, long member, const char *line)
{
    char text[CT_NUMBER_SIZE];
    size_t n = strlen(ct_number_format(text, (double)(member + 1)));
    if (strncmp(line, text, n) != 0)
        return -1;
    line += n;
    for (size_t i = 0; i < s->plan.naxis; i++) {
        ct_number_format(text, ct_plan_value(&s->plan, member, i));
        n = strlen(text);
        if (*line++ != ',' || strncmp(line, text, n) != 0)
            return -1;
        line += n;
    }
    size_t fields = 0;
    for (const char *p = line; *p; p++)
        fields += *p == ',';
    const char *last = strrchr(line, ',');
    const bool is_row = *line == ',' && fields == s->system->equations.nresult + 1
                     && (strcmp(last, ",0\n") == 0 || strcmp(last, ",1\n") == 0);
    return is_row ? last[1] == '1' : -1;
}

static bool not_resumable(struct ct_study *s, const char *path, const char *why)
{
    return ct_error(&s->own, none, CT_E_USAGE,
                    "cannot resume from '%s': %s; without --resume the sweep starts anew", path,
                    why);
}

// Take over whole rows of a file; *kept (out): bytes of them.
static bool read_rows(struct ct_study *s, FILE *in, const char *path, long *kept)
{
    char *line = NULL, *header = header_text(s);
    size_t size = 0;
    ssize_t n = getline(&line, &size, in);
    bool ok = true;
    *kept = 0;
    if (n > 0 && line[n - 1] == '\n') {
        ok = (header && strcmp(line, header) == 0)
          || not_resumable(s, path, "its columns are others");
        *kept = n;
    }
    for (long i = 0; ok && *kept && (n = getline(&line, &size, in)) > 0; i++) {
        if (line[n - 1] != '\n')
            break; // cut off in the middle
        const int status = i < s->plan.nmember ? read_status(s, i, line) : -1;
        ok = status >= 0
          || not_resumable(
                 s, path,
                 ct_arena_printf(s->own.model, "row %ld is not one of this sweep", i + 1));
        if (!ok)
            break;
        s->row[i].state = status ? RESUMED_FAILED : RESUMED;
        s->ndone++;
        s->nresumed++;
        s->nfailed += status;
        *kept += n;
    }
    free(line);
    free(header);
    return ok;
}

static bool is_newer(const struct stat *a, const struct stat *b)
{
    return a->st_mtim.tv_sec != b->st_mtim.tv_sec ? a->st_mtim.tv_sec > b->st_mtim.tv_sec
                                                  : a->st_mtim.tv_nsec > b->st_mtim.tv_nsec;
}

// Go on at the end of the rows that a partial file has; if there is none, *found is false.
static bool resume(struct ct_study *s, const char *path, bool *found)
{
    struct ct_outfile *o = &s->sink.csv.file;
    struct stat model, rows;
    const char *partial = ct_arena_printf(s->own.model, "%s.partial", path);
    size_t n;
    long kept;
    *found = stat(partial, &rows) == 0 && S_ISREG(rows.st_mode);
    if (!*found)
        return true;
    if (stat(s->path, &model) == 0 && is_newer(&model, &rows))
        return not_resumable(s, partial, "the model has changed since");
    FILE *stream = fopen(partial, "r+");
    if (!stream)
        return not_resumable(s, partial, "it cannot be opened");
    column_names(s, &n);
    s->sink.csv = (struct ct_csv){.ncolumn = n};
    *o = (struct ct_outfile){stream, ct_arena_strdup(s->own.model, path), partial};
    if (!read_rows(s, stream, partial, &kept))
        return false;
    if (kept == 0) { // not even the header is there
        fclose(stream);
        o->stream = NULL;
        *found = false;
        return true;
    }
    return (fseek(stream, kept, SEEK_SET) == 0 && ftruncate(fileno(stream), kept) == 0)
        || not_resumable(s, partial, "it cannot be written");
}

// A file that is complete is what an interrupted sweep would have become.
static bool is_complete(struct ct_study *s, const char *path)
{
    struct stat model, rows;
    long kept;
    FILE *in = stat(path, &rows) == 0 && S_ISREG(rows.st_mode) ? fopen(path, "r") : NULL;
    if (!in)
        return false;
    const size_t before = s->own.ndiagnostic, errors = s->own.nerror;
    bool ok = read_rows(s, in, path, &kept) && s->nresumed == s->plan.nmember
           && !(stat(s->path, &model) == 0 && is_newer(&model, &rows));
    fclose(in);
    s->own.ndiagnostic = before;
    s->own.nerror = errors;
    if (ok)
        return true;
    for (long i = 0; i < s->plan.nmember; i++)
        s->row[i].state = PENDING;
    s->ndone = s->nresumed = s->nfailed = 0;
    return false;
}

static bool open_sink(struct ct_study *s, const struct ct_study_results *r)
{
    size_t n;
    const char **name = column_names(s, &n), *path = r->path;
    bool found = false;
    s->sink.is_json = has_suffix(path, ".json");
    if (r->resume && (s->sink.is_json || strcmp(path, "-") == 0))
        return ct_error(&s->own, none, CT_E_USAGE,
                        "only a sweep into a CSV file can be resumed");
    if (s->sink.is_json) {
        s->sink.is_open = ct_outfile_open(&s->own, &s->sink.json, path);
        return s->sink.is_open;
    }
    if (r->resume && is_complete(s, path))
        return true;
    if (r->resume && !resume(s, path, &found))
        return false;
    s->sink.is_open
        = found
       || ct_csv_open(&s->own, &s->sink.csv, strcmp(path, "-") == 0 ? NULL : path, name, n);
    return s->sink.is_open;
}

// An object of columns; null where a member failed.
static void write_columns(struct ct_study *s)
{
    const long n = s->plan.nmember;
    size_t ncolumn;
    const char **name = column_names(s, &ncolumn);
    struct ct_json j;
    ct_json_init(&j, s->sink.json.stream);
    ct_json_object(&j, NULL);
    double *column = CT_NEWN(s->own.scratch, double, n);
    for (size_t c = 0; c < ncolumn; c++) {
        for (long i = 0; i < n; i++) {
            const double *value = s->row[i].value;
            column[i] = c == 0             ? (double)(i + 1)
                      : c <= s->plan.naxis ? ct_plan_value(&s->plan, i, c - 1)
                      : c + 1 == ncolumn   ? s->row[i].state == FAILED
                      : value              ? value[c - 1 - s->plan.naxis]
                                           : NAN;
        }
        ct_json_numbers(&j, name[c], column, (size_t)n);
    }
    ct_json_end(&j);
}

static bool close_sink(struct ct_study *s, bool ok)
{
    struct ct_result_sink *k = &s->sink;
    if (!k->is_open)
        return ok;
    if (ok && k->is_json)
        write_columns(s);
    if (ok)
        ok = k->is_json ? ct_outfile_close(&s->own, &k->json) : ct_csv_close(&s->own, &k->csv);
    ct_csv_abandon(&k->csv);
    ct_outfile_abandon(&k->json);
    return ok;
}

// ---- the run ------------------------------------------------------------------------------------------

static bool run_all(struct ct_study *s)
{
    const struct ct_study_results *r = s->results;
    const double start = ct_clock();
    if (s->has_run)
        return ct_error(&s->own, none, CT_E_USAGE, "the sweep is over already");
    s->has_run = true;
    if (r->path && !s->system->equations.nresult)
        ct_warning(&s->own, (struct ct_mark){.file = s->path}, 0,
                   "the model lists no 'outputs': only what varies is written");
    if (r->path && !open_sink(s, r))
        return false;
    if (r->progress)
        ct_progress_init(&s->progress, r->progress, "sweep");
    s->sink.flushed = start;
    write_rows(s); // past those taken over
    run_workers(s);
    ct_progress_finish(&s->progress);
    s->seconds = ct_clock() - start;
    s->own.no_memory |= s->no_memory;
    return close_sink(s, !s->no_memory && !s->sink.has_failed
                             && (s->written == s->plan.nmember || s->is_stopped));
}

struct task {
    struct ct_ctx *ctx;
    struct ct_study *s;
};

static bool run_and_report(void *data)
{
    struct task *t = data;
    const bool ok = run_all(t->s);
    t->ctx->no_memory |= t->s->own.no_memory;
    ct_ctx_hand_over(t->ctx, &t->s->own);
    return ok;
}

bool ct_study_run(struct ct_ctx *ctx, struct ct_study *s,
                  const struct ct_study_results *results)
{
    static const struct ct_study_results nowhere;
    struct task t = {ctx, s};
    if (!s)
        return false;
    s->results = results ? results : &nowhere;
    const bool ok = ct_enter(ctx, run_and_report, &t);
    if (!ok) { // without memory they are still open
        ct_csv_abandon(&s->sink.csv);
        ct_outfile_abandon(&s->sink.json);
    }
    s->results = NULL;
    return ok;
}

long ct_study_count(const struct ct_study *s)
{
    return s->plan.nmember;
}

long ct_study_failed(const struct ct_study *s)
{
    return s->nfailed;
}

// ---- summaries ----------------------------------------------------------------------------------------

static void write_axes(struct ct_json *j, const struct ct_plan *plan)
{
    ct_json_array(j, "vary");
    for (size_t i = 0; i < plan->naxis; i++) {
        const struct ct_axis *axis = &plan->axis[i];
        const bool is_normal = axis->kind == CT_AXIS_NORMAL;
        ct_json_object(j, NULL);
        ct_json_text(j, "parameter", axis->name);
        ct_json_text(j, "kind", is_normal ? "normal" : plan->is_sampled ? "uniform" : "grid");
        ct_json_number(j, is_normal ? "mean" : "from", axis->from);
        ct_json_number(j, is_normal ? "deviation" : "to", axis->to);
        if (!plan->is_sampled)
            ct_json_integer(j, "count", axis->n);
        ct_json_end(j);
    }
    ct_json_end(j);
    if (plan->is_sampled)
        ct_json_integer(j, "seed", (long long)plan->seed);
}

static void write_failures(struct ct_json *j, const struct ct_study *s)
{
    ct_json_array(j, "failures");
    for (long i = 0; i < s->plan.nmember; i++) {
        const struct row *row = &s->row[i];
        if (row->state != FAILED && row->state != RESUMED_FAILED)
            continue;
        ct_json_object(j, NULL);
        ct_json_integer(j, "run", i + 1);
        if (row->code)
            ct_json_integer(j, "code", row->code);
        ct_json_text(j, "message", row->message);
        ct_json_end(j);
    }
    ct_json_end(j);
}

static void write_summary(FILE *out, const struct ct_study *s)
{
    struct ct_json j;
    ct_json_init(&j, out);
    ct_json_object(&j, NULL);
    ct_json_text(&j, "model", s->system->model.name);
    ct_json_integer(&j, "members", s->plan.nmember);
    ct_json_integer(&j, "done", s->ndone - s->nfailed);
    ct_json_integer(&j, "failed", s->nfailed);
    ct_json_integer(&j, "resumed", s->nresumed);
    write_axes(&j, &s->plan);
    ct_json_text(&j, "method", s->method);
    ct_json_number(&j, "tolerance", s->tolerance);
    ct_json_text(&j, "backend", s->backend);
    ct_json_integer(&j, "lanes", s->lanes);
    ct_json_text(&j, "alone_because", s->alone_by);
    ct_json_integer(&j, "alone", s->nalone);
    ct_json_integer(&j, "threads", s->threads);
    ct_json_integer(&j, "steps", s->steps);
    ct_json_integer(&j, "rejected_steps", s->rejected);
    ct_json_object(&j, "seconds");
    ct_json_number(&j, "read", s->system->read);
    ct_json_number(&j, "generate", s->system->generate);
    ct_json_number(&j, "run", s->seconds);
    ct_json_end(&j);
    write_failures(&j, s);
    ct_json_end(&j);
}

struct summary {
    struct ct_ctx *ctx;
    const struct ct_study *s;
    const char *path;
};

static bool write_file(void *task)
{
    const struct summary *w = task;
    struct ct_outfile file;
    if (!ct_outfile_open(w->ctx, &file, strcmp(w->path, "-") == 0 ? NULL : w->path))
        return false;
    write_summary(file.stream, w->s);
    return ct_outfile_close(w->ctx, &file);
}

bool ct_study_write_summary(struct ct_ctx *ctx, const struct ct_study *s, const char *path)
{
    struct summary w = {ctx, s, path};
    return s && ct_enter(ctx, write_file, &w);
}

static void print_failures(FILE *out, const struct ct_study *s)
{
    int shown = 0;
    for (long i = 0; i < s->plan.nmember && shown < MOST_SHOWN; i++)
        if (s->row[i].state == FAILED) {
            fprintf(out, "failed       run %ld: %s\n", i + 1, s->row[i].message);
            shown++;
        }
    if (shown == MOST_SHOWN && s->nfailed > shown)
        fprintf(out, "failed       %ld in all; --summary FILE.json lists them\n", s->nfailed);
}

void ct_study_print_summary(const struct ct_study *s, FILE *out)
{
    fprintf(out, "%s: %ld members, %ld failed", s->system->model.name, s->plan.nmember,
            s->nfailed);
    if (s->nresumed)
        fprintf(out, ", %ld taken over", s->nresumed);
    fprintf(out, "\nmethod       %s, tolerance %g\n", s->method, s->tolerance);
    fprintf(out, "work         %ld steps, %ld rejected (%s)\n", s->steps, s->rejected,
            s->backend);
    fprintf(out, "lanes        %d in each of %d threads", s->lanes, s->threads);
    if (s->alone_by)
        fprintf(out, ": %s", s->alone_by);
    else if (s->nalone)
        fprintf(out, "; %ld members were run alone", s->nalone);
    fprintf(out, "\nseconds      read %.3g, generate %.3g, run %.3g\n", s->system->read,
            s->system->generate, s->seconds);
    print_failures(out, s);
}
