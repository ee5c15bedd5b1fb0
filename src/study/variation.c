// Runs an analysis for each member of a plan. A row has `run`, the parameters, then the columns
// of the analysis. Each member is a system of its own.
#include "study/study.h"

#include "base/guard.h"
#include "report/columns.h"
#include "report/number.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct ct_mark none = {0};

struct variation {
    struct ct_ctx own, *member_ctx;
    const char *path, *out;
    const struct ct_system_options *system;
    const struct ct_vary_options *o;
    struct ct_plan plan;
    struct ct_columns table;
    size_t ncolumn; // of the analysis; 0: not known yet
    long member;    // the member whose rows are written
    long nfailed;
};

// ---- rows ----------------------------------------------------------------------------------

static const char *const mode_columns[] = {"mode", "frequency_hz", "omega_rad_s", "damping"};

// Name of column c of the analysis; NULL beyond the last one.
static const char *column_name(const struct variation *v, const struct ct_system *sys, size_t c)
{
    if (v->o->analysis == CT_VARY_MODES)
        return c < COUNT(mode_columns) ? mode_columns[c] : NULL;
    return c == 0 ? "t" : ct_system_column(sys, c - 1);
}

static void begin_row(struct variation *v, long member)
{
    ct_columns_number(&v->table, 0, (double)(member + 1));
    for (size_t i = 0; i < v->plan.naxis; i++)
        ct_columns_number(&v->table, i + 1, ct_plan_value(&v->plan, member, i));
}

static void put(struct variation *v, size_t column, double value)
{
    ct_columns_number(&v->table, v->plan.naxis + 1 + column, value);
}

static void put_failed(struct variation *v, long member)
{
    begin_row(v, member);
    for (size_t c = 0; c < v->ncolumn; c++)
        put(v, c, NAN);
}

// Finds the columns from the first member that can be analysed; all members have the same.
static bool find_columns(struct variation *v, const struct ct_system *sys)
{
    const size_t first = v->plan.naxis + 1;
    const char *name;
    size_t c = 0;
    for (; (name = column_name(v, sys, c)); c++)
        if (v->ncolumn == 0)
            ct_columns_add(&v->table, ct_arena_strdup(v->own.model, name),
                           c == 0 && v->o->analysis == CT_VARY_MODES ? CT_COLUMN_INTEGER
                                                                     : CT_COLUMN_NUMBER);
        else if (c >= v->ncolumn || strcmp(v->table.column[first + c].name, name) != 0)
            break;
    if (v->ncolumn == 0) {
        v->ncolumn = c;
        for (long i = 0; i < v->member; i++) // the members that failed before it
            put_failed(v, i);
    }
    return (!name && c == v->ncolumn)
        || ct_error(&v->own, none, CT_E_USAGE,
                    "run %ld has other columns than those before: what varies decides which "
                    "outputs there are",
                    v->member + 1);
}

// ---- analyses ------------------------------------------------------------------------------

static bool find_modes(struct variation *v, struct ct_ctx *ctx, struct ct_system *sys)
{
    struct ct_modes *modes = ct_modes_create(ctx, sys, &v->o->modes);
    for (size_t i = 0; i < ct_modes_count(modes); i++) {
        const struct ct_mode_info m = ct_modes_info(modes, i);
        begin_row(v, v->member);
        put(v, 0, (double)(i + 1));
        put(v, 1, m.frequency_hz);
        put(v, 2, m.omega);
        put(v, 3, m.damping);
    }
    ct_modes_destroy(modes);
    return modes;
}

static bool find_equilibrium(struct variation *v, struct ct_ctx *ctx, struct ct_system *sys)
{
    struct ct_equilibrium *q = ct_equilibrium_create(ctx, sys, &v->o->equilibrium);
    if (!q)
        return false;
    begin_row(v, v->member);
    put(v, 0, 0);
    for (size_t c = 1; c < v->ncolumn; c++)
        put(v, c, ct_equilibrium_value(q, ct_system_column(sys, c - 1)));
    ct_equilibrium_destroy(q);
    return true;
}

// The samples of a member are kept until all are there, so that a member that fails has none.
struct samples {
    size_t ncolumn;
    double *value; // (n x ncolumn)
    size_t n, cap;
    struct ct_arena *a;
};

static bool take_sample(void *user, double t, const double *value, size_t n)
{
    struct samples *s = user;
    CT_PUSH(s->a, s->value, s->n, s->cap, t);
    for (size_t i = 0; i < n; i++)
        CT_PUSH(s->a, s->value, s->n, s->cap, value[i]);
    return true;
}

static bool follow(struct variation *v, struct ct_ctx *ctx, struct ct_system *sys)
{
    struct samples s = {.ncolumn = v->ncolumn, .a = ctx->model};
    const struct ct_sim_results results = {.row = take_sample, .user = &s};
    struct ct_sim *sim = ct_sim_create(ctx, sys, &v->o->run);
    const bool ok = sim && ct_sim_follow(ctx, sim, &results);
    for (size_t i = 0; ok && i + v->ncolumn <= s.n; i += v->ncolumn) {
        begin_row(v, v->member);
        for (size_t c = 0; c < v->ncolumn; c++)
            put(v, c, s.value[i + c]);
    }
    ct_sim_destroy(sim);
    return ok;
}

// ---- members -------------------------------------------------------------------------------

// "l = 0.5, m = 2"
static const char *values_text(const struct variation *v)
{
    const char *text = "";
    for (size_t i = 0; i < v->plan.naxis; i++) {
        char number[CT_NUMBER_SIZE];
        ct_number_format(number, ct_plan_value(&v->plan, v->member, i));
        text = ct_arena_printf(v->own.model, "%s%s%s = %s", text, i ? ", " : "",
                               v->plan.axis[i].name, number);
    }
    return text;
}

// Reports as a warning why a member has no results. The others continue.
static void report_failure(struct variation *v, struct ct_ctx *own)
{
    // Layout: of messages
    enum { MOST_TOLD = 10 };
    struct ct_diagnostic d = {.message = "out of memory", .code = CT_E_MEMORY};
    for (size_t i = 0; ct_ctx_diagnostic(own, i, &d) && d.severity != CT_SEVERITY_ERROR;)
        i++;
    if (++v->nfailed > MOST_TOLD)
        return;
    const struct ct_mark mark = {.file = v->path,
                                 .line = d.line ? (int)d.line - 1 : 0,
                                 .column = d.column ? (int)d.column - 1 : 0};
    ct_warning(&v->own, d.line ? mark : none, CT_E_VARIED, "run %ld (%s) fails: %s [E%03d]",
               v->member + 1, values_text(v), d.message, d.code);
}

static struct ct_system *load(struct variation *v, struct ct_ctx *ctx)
{
    struct ct_system_options o = *v->system;
    double *value = CT_NEWN(ctx->model, double, v->plan.naxis + 1);
    for (size_t i = 0; i < v->plan.naxis; i++)
        value[i] = ct_plan_value(&v->plan, v->member, i);
    o.set = ct_plan_settings(ctx->model, &v->plan, value, v->system->set, &o.nset);
    return ct_system_load(ctx, v->path, &o);
}

static bool run_member(struct variation *v, struct ct_ctx *own)
{
    static bool (*const analyses[])(struct variation *, struct ct_ctx *, struct ct_system *)
        = {[CT_VARY_MODES] = find_modes,
           [CT_VARY_EQUILIBRIUM] = find_equilibrium,
           [CT_VARY_DRIVEN] = follow};
    struct ct_system *sys = load(v, own);
    const bool has_columns = sys && find_columns(v, sys);
    const bool ok = has_columns && analyses[v->o->analysis](v, own, sys);
    ct_system_destroy(sys);
    if (ok)
        return true;
    const bool ends = own->was_interrupted || ct_ctx_fault(own) == CT_FAULT_OPTION;
    if (ends)
        ct_ctx_hand_over(&v->own, own);
    if (ends || (sys && !has_columns))
        return false;
    report_failure(v, own);
    return true;
}

static bool run_members(struct variation *v)
{
    struct ct_progress bar = {0};
    bool ok = true;
    if (v->o->bar)
        ct_progress_init(&bar, v->o->bar, "vary");
    for (v->member = 0; ok && v->member < v->plan.nmember; v->member++) {
        const long before = v->nfailed;
        v->member_ctx = ct_ctx_create();
        if (!v->member_ctx)
            ct_guard_raise();
        ok = run_member(v, v->member_ctx);
        ct_ctx_destroy(v->member_ctx);
        v->member_ctx = NULL;
        if (ok && v->nfailed > before && v->ncolumn)
            put_failed(v, v->member);
        ct_progress_update(&bar, (double)(v->member + 1) / (double)v->plan.nmember);
    }
    ct_progress_finish(&bar);
    return ok;
}

static bool vary(void *task)
{
    struct variation *v = task;
    const struct ct_vary_options *o = v->o;
    struct ct_model m;
    struct ct_set *set = CT_NEWN(v->own.model, struct ct_set, v->system->nset + 1);
    for (size_t i = 0; i < v->system->nset; i++)
        set[i].text = v->system->set[i];
    if (!ct_model_read(&v->own, v->path, set, v->system->nset, &m)
        || !ct_plan_choose(&v->own, &m, o->members, o->vary, o->nvary, o->sample, o->seed,
                           &v->plan))
        return false;
    v->own.ndiagnostic = 0; // discards the warnings of the file, which each member repeats
    ct_columns_init(&v->table, v->own.model, "run", CT_COLUMN_INTEGER);
    for (size_t i = 0; i < v->plan.naxis; i++)
        ct_columns_add(&v->table, v->plan.axis[i].name, CT_COLUMN_NUMBER);
    if (!run_members(v))
        return false;
    if (v->nfailed == v->plan.nmember)
        return ct_error(&v->own, none, CT_E_VARIED, "all %ld runs fail: nothing is written",
                        v->nfailed);
    return ct_columns_write(&v->own, &v->table, v->out);
}

bool ct_vary(struct ct_ctx *ctx, const char *path, const struct ct_system_options *system,
             const struct ct_vary_options *options, const char *out)
{
    struct ct_system_options so;
    struct ct_vary_options o;
    ct_options_take(&so, system, sizeof so);
    ct_options_take(&o, options, sizeof o);
    if (!ctx || !path)
        return false;
    struct variation *v = ct_own_alloc(ctx, sizeof *v);
    if (!v)
        return false;
    *v = (struct variation){.path = path, .out = out, .system = &so, .o = &o};
    const bool ok = ct_own_enter(ctx, &v->own, vary, v);
    ct_ctx_destroy(v->member_ctx);
    ct_own_finish(&v->own);
    free(v);
    return ok;
}
