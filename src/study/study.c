// Parameter studies: runs the members in SIMD batches on all cores and writes a row for each.
//
//     file -> text -> [ worker: system, assembly, run, batch ] x threads -> rows in order -> FILE
//
// Parameters are inputs of the generated programs. For each member the parsed text of the file
// is read again with the member's values. The reader therefore checks every member, and initial
// values and `simulation` may depend on what varies. Then the values are copied into the
// worker's own system, whose equations stay. A member runs in one of three ways:
//
//     in a lane   the usual way: one lane of a SIMD batch; see solve/batch/batch.h
//     alone       if a batch does not support the method, or has given up the member
//     derived     with equations of its own, if a value determines their form: in ct_exs.decided
//
// What always holds: a row depends only on its member, not on threads, lanes or order. Workers
// share only constants and, under a lock, the rows.
#include "study/study.h"

#include "base/guard.h"
#include "io/text.h"
#include "solve/batch/batch.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const struct ct_mark none = {0};
// Limit: of a model, with a message; of threads.
enum { MOST_TEXT = 64 << 20, MOST_THREADS = 1024 };

// ---- preparation ---------------------------------------------------------------------------

// Marks the parameters that change with the axes, directly or through definitions.
static bool *find_changing(struct ct_study *s, const struct ct_model *m)
{
    bool *changes = CT_NEWN(s->own.scratch, bool, m->nparameter + 1);
    for (size_t i = 0; i < s->plan.naxis; i++)
        changes[ct_names_get(&m->parameter_index, s->plan.axis[i].name)] = true;
    for (size_t i = 0; i < m->nparameter; i++) // a definition uses only parameters before it
        for (size_t k = ct_ex_walk(m->x, &m->parameter[i].definition, 1); k-- > 0;) {
            const struct ct_sym *sym = ct_ex_symbol(m->x, (ct_ex){m->x->stack[k]});
            changes[i] |= sym && sym->kind == CT_SYM_PARAM && changes[sym->index];
        }
    return changes;
}

// Does a parameter that varies determine the form of the equations?
static void find_deciding(struct ct_study *s)
{
    const struct ct_model *m = &s->system->model;
    const unsigned char *const decided[]
        = {m->decided, s->system->equations.x->decided, s->system->start_equations.x->decided,
           s->system->held_equations.x ? s->system->held_equations.x->decided : NULL,
           s->system->moving_equations.x ? s->system->moving_equations.x->decided : NULL};
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
    const char **output = CT_NEWN(a, const char *, system->noutput + 1);
    for (size_t i = 0; i < system->noutput; i++)
        output[i] = ct_arena_strdup(a, system->output[i]);
    s->system_options.output = output;
    s->system_options.tree = copy_text(a, system->tree);
    s->run = o->run;
    s->run.method = copy_text(a, o->run.method);
    s->run.backend = copy_text(a, o->run.backend);
    s->run.solver = NULL; // batches have their own solvers
}

static bool read_text(struct ct_study *s, const struct ct_study_options *options)
{
    if (options->text) {
        s->ntext = options->ntext;
        s->text = ct_arena_strndup(s->own.model, options->text, s->ntext);
        return true;
    }
    const enum ct_text_result e
        = ct_text_read(s->own.model, s->path, MOST_TEXT, &s->text, &s->ntext);
    return e == CT_TEXT_OK
        || ct_error(&s->own, none, CT_E_FILE, "cannot read '%s'%s", s->path,
                    e == CT_TEXT_TOO_BIG ? ": it is too big" : "");
}

// Finds the method, back end and end time for the values of the file, and whether members can
// run in batches.
static bool choose_way(struct ct_study *s, const struct ct_study_options *o)
{
    struct ct_sim *probe = CT_NEW(s->own.model, struct ct_sim);
    probe->own = s->own;
    const bool ok = ct_sim_prepare(probe, s->system, &s->run);
    s->own = probe->own; // with its diagnostics
    if (!ok)
        return false;
    const struct ct_simulation *m = &s->system->model.simulation;
    if (!m->has_duration && !(s->run.until > 0))
        return ct_error(&s->own, m->mark, CT_E_KEY_MISSING,
                        "there is no end time: 'simulation' needs a 'duration'");
    s->method = probe->run_options.method->name;
    s->tolerance = probe->tolerance;
    s->backend = ct_run_evaluator(probe->run)->backend;
    s->alone_by = o->lanes == 1 ? "as requested" : ct_sim_refuses_batch(probe);
    if (s->is_derived)
        s->alone_by = ct_arena_printf(s->own.model, "the equations depend on the value of '%s'",
                                      s->derived_by);
    s->lanes = s->alone_by ? 1 : o->lanes > CT_LANES ? CT_BATCH_GROUPS * CT_LANES : CT_LANES;
    if (o->lanes != 0 && o->lanes != 1 && o->lanes != CT_LANES
        && o->lanes != CT_BATCH_GROUPS * CT_LANES)
        return ct_error(&s->own, none, CT_E_USAGE,
                        "there are no %ld lanes; there are 1, %d and %d", o->lanes, CT_LANES,
                        CT_BATCH_GROUPS * CT_LANES);
    return true;
}

static int count_threads(const struct ct_study *s, long wanted)
{
    const long most = (s->plan.nmember + s->lanes - 1) / s->lanes;
    long n = wanted > 0 ? wanted : sysconf(_SC_NPROCESSORS_ONLN);
    n = n > 0 ? n : 1;
    n = n < most ? n : most > 0 ? most : 1;
    return (int)(n < MOST_THREADS ? n : MOST_THREADS);
}

static bool prepare(struct ct_study *s, const struct ct_study_options *o)
{
    struct ct_model file;
    const struct ct_system_options *so = &s->system_options;
    struct ct_set *set = CT_NEWN(s->own.model, struct ct_set, so->nset + 1);
    for (size_t i = 0; i < so->nset; i++)
        set[i].text = so->set[i];
    if (!read_text(s, o) || !ct_yaml_parse(&s->own, s->path, s->text, s->ntext, &s->root)
        || !ct_model_resolve(&s->own, s->path, s->root, set, so->nset, &file)
        || !ct_plan_choose(&s->own, &file, o->members, o->vary, o->nvary, o->sample, o->seed,
                           &s->plan)
        || !ct_study_read_takes(s, o->take, o->ntake)
        || !ct_plan_take_shard(&s->own, &s->plan, o->shard, o->shards))
        return false;
    s->base = CT_NEWN(s->own.model, double, s->plan.naxis);
    for (size_t i = 0; i < s->plan.naxis; i++)
        s->base[i]
            = file.parameter[ct_names_get(&file.parameter_index, s->plan.axis[i].name)].value;
    s->system = ct_study_load_system(&s->own, s);
    if (!s->system)
        return false;
    find_deciding(s);
    if (!choose_way(s, o))
        return false;
    s->threads = count_threads(s, o->threads);
    s->varied = CT_NEWN(s->own.model, double, s->plan.naxis + 1);
    s->row = calloc((size_t)s->plan.nmember + 1, sizeof *s->row);
    if (!s->row)
        s->own.no_memory = true;
    return s->row;
}

struct create {
    struct ct_study *s;
    const char *path;
    const struct ct_system_options *system;
    const struct ct_study_options *options;
};

static bool create(void *task)
{
    const struct create *c = task;
    pthread_mutex_init(&c->s->rows, NULL);
    take_options(c->s, c->path, c->system, c->options);
    return prepare(c->s, c->options);
}

struct ct_study *ct_study_create(struct ct_ctx *ctx, const char *path,
                                 const struct ct_system_options *system,
                                 const struct ct_study_options *options)
{
    struct ct_system_options so;
    struct ct_study_options o;
    ct_options_take(&so, system, sizeof so);
    ct_options_take(&o, options, sizeof o);
    if (!ctx || !path)
        return NULL;
    struct create c = {ct_own_alloc(ctx, sizeof *c.s), path, &so, &o};
    if (!c.s)
        return NULL;
    if (ct_own_enter(ctx, &c.s->own, create, &c))
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
    pthread_mutex_destroy(&s->rows);
    ct_own_finish(&s->own);
    free(s);
}

// ---- the run -------------------------------------------------------------------------------

static bool run_all(struct ct_study *s)
{
    const struct ct_study_results *r = s->results;
    const double start = ct_monotonic_time();
    if (s->has_run)
        return ct_error(&s->own, none, CT_E_USAGE, "the sweep is over already");
    s->has_run = true;
    if (r->path && !s->system->equations.nresult)
        ct_warning(&s->own, (struct ct_mark){.file = s->path}, 0,
                   "the model lists no 'outputs': only what varies is written");
    if (r->path && !ct_study_open(s))
        return false;
    if (r->bar)
        ct_progress_init(&s->progress, r->bar, "sweep");
    s->sink.flushed = start;
    ct_study_write_rows(s); // rows after those taken over
    ct_study_run_members(s);
    ct_progress_finish(&s->progress);
    if (ct_guard_is_interrupted() && s->written < s->plan.nmember)
        return false;
    s->seconds = ct_monotonic_time() - start;
    s->own.no_memory |= s->no_memory;
    return ct_study_close(s, !s->no_memory && !s->sink.has_failed
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

// Reports which rows exist and how to resume.
static bool report_interrupt(void *data)
{
    struct task *t = data;
    struct ct_study *s = t->s;
    ct_progress_finish(&s->progress);
    ct_csv_abandon(&s->sink.csv);
    ct_outfile_discard(&s->sink.whole); // writing it would take longer than an interruption may
    const char *partial = s->sink.is_by_row ? s->sink.csv.file.partial : NULL;
    const bool goes_on = partial && s->sink.suffix == CT_SUFFIX_CSV;
    ct_error(&s->own, none, CT_E_INTERRUPTED, "interrupted after %ld of %ld rows%s%s%s%s",
             s->written, s->plan.nmember, partial ? ", which are in '" : "",
             partial ? partial : "", partial ? "'" : "",
             goes_on ? "; the same command with --resume goes on"
                     : "; only a sweep into a .csv file can be resumed");
    ct_ctx_hand_over(t->ctx, &s->own);
    return false;
}

bool ct_study_run(struct ct_ctx *ctx, struct ct_study *s,
                  const struct ct_study_results *results)
{
    struct ct_study_results all;
    ct_options_take(&all, results, sizeof all);
    struct task t = {ctx, s};
    if (!ctx || !s)
        return false;
    s->results = &all;
    s->caller = ctx;
    const bool ok = ct_enter(ctx, run_and_report, &t);
    if (!ok && ctx->was_interrupted && s->results->path)
        ct_enter_uninterrupted(ctx, report_interrupt, &t);
    if (!ok) { // out of memory: they are still open
        ct_csv_abandon(&s->sink.csv);
        ct_outfile_abandon(&s->sink.whole);
    }
    s->results = NULL;
    s->caller = NULL;
    return ok;
}

long ct_study_count(const struct ct_study *s)
{
    if (!s)
        return 0;
    return s->plan.nmember;
}

long ct_study_failed(const struct ct_study *s)
{
    if (!s)
        return 0;
    return s->nfailed;
}
