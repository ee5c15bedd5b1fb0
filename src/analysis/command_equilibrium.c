// Analysis `equilibrium`: an equilibrium of a system, its outputs and its stability.
#include "analysis/configuration.h"

#include "analysis/eigenvalues.h"
#include "report/columns.h"

#include <float.h>
#include <math.h>
#include <string.h>

struct ct_equilibrium {
    struct ct_ctx own;
    struct ct_system *system;
    struct ct_configuration at;
    double *value;    // of the outputs
    double stiffness; // smallest eigenvalue of K y = w2 M y [1/s^2]
    double growth;    // largest real part of an eigenvalue [1/s]
    double doubt;     // error bound of `growth` from round-off [1/s]
    double fastest;   // largest eigenvalue [1/s]
    // coordinate with the largest entry in the direction of least stiffness
    const char *softest;
};

// ---- finding the equilibrium ---------------------------------------------------------------

// Decides about stability from the lowest modes, with sparse matrices.
static bool judge_large(struct ct_equilibrium *q, bool *applies)
{
    // Limit: number of modes computed to find rigid-body motions.
    enum { COUNT_OF_MODES = 6 };
    struct ct_arena *a = q->own.model;
    struct ct_motion_mode *mode;
    size_t n;
    const char *how;
    if (!ct_sparse_modes(&q->own, a, q->at.l, COUNT_OF_MODES, &mode, &n, &how, applies))
        return false;
    if (!*applies || !n)
        return true;
    q->stiffness = INFINITY;
    q->growth = -INFINITY;
    for (size_t i = 0; i < n; i++) {
        const double w2 = mode[i].im * mode[i].im - mode[i].re * mode[i].re;
        q->growth = fmax(q->growth, mode[i].re);
        if (w2 >= q->stiffness)
            continue;
        q->stiffness = w2;
        q->softest = ct_linear_coordinate(
            q->at.e, a, ct_linear_largest_entry(mode[i].shape, NULL, q->at.l->nu));
    }
    return true;
}

static bool judge(struct ct_equilibrium *q)
{
    struct ct_arena *a = q->own.model;
    const struct ct_linear *l = q->at.l;
    struct ct_motion_mode *mode;
    size_t n;
    const char *how;
    double *y = CT_NEWN(a, double, l->nfree + 1), *dq = CT_NEWN(a, double, l->nu + 1);
    q->stiffness = q->at.e->nstate ? INFINITY : ct_stiffness_least(a, l, y);
    ct_linear_expand(l, dq, y);
    q->softest = l->nu
                   ? ct_linear_coordinate(q->at.e, a, ct_linear_largest_entry(dq, NULL, l->nu))
                   : "";
    q->growth = -INFINITY;
    if (!l->nfree)
        return true;
    if (!ct_modes_solve(&q->own, a, l, &mode, &n, &how))
        return false;
    for (size_t i = 0; i < n; i++)
        q->growth = fmax(q->growth, mode[i].re);
    q->doubt = ct_modes_roundoff(mode, n, &q->fastest);
    return true;
}

static void watch_bending(struct ct_equilibrium *q, struct ct_evaluator *m)
{
    struct ct_slope_report *report
        = CT_NEWN(q->own.model, struct ct_slope_report, m->e->nbent_beam + 1);
    for (size_t i = 0; i < m->e->nbent_beam; i++)
        report[i].passed_at = -1;
    if (m->e->nbent_beam) {
        ct_program_run(&m->validity, m->input);
        ct_slope_monitor(report, m, 0);
    }
    ct_slope_warn(&q->own, m->e, report);
}

static bool find(void *task)
{
    struct ct_equilibrium *q = task;
    bool is_judged = false;
    q->system = ct_system_borrow(&q->own, q->system);
    q->at.about = "equilibrium";
    q->at.may_be_large = true;
    if (!ct_configuration_find(&q->own, q->system, NULL, &q->at)
        || (q->at.is_large && !judge_large(q, &is_judged)))
        return false;
    if (q->at.is_large && !is_judged) { // the system has dampers or redundant rows
        q->at.may_be_large = false;
        if (!ct_configuration_find(&q->own, q->system, NULL, &q->at))
            return false;
    }
    struct ct_evaluator *m = q->at.l->m;
    const size_t n = q->at.e->nresult;
    memcpy(m->input + m->at_a, q->at.l->a, m->nu * sizeof *m->input);
    memcpy(m->input + m->at_lam, q->at.l->lam, m->nrow * sizeof *m->input);
    ct_memory_start(m);
    ct_program_run(&m->result, m->input);
    q->value = CT_NEWN(q->own.model, double, n + 1);
    for (size_t i = 0; i < n; i++)
        q->value[i] = m->result.out[i] + 0.0; // + 0.0 turns -0 into 0
    watch_bending(q, m);
    return is_judged || judge(q);
}

struct ct_equilibrium *ct_equilibrium_create(struct ct_ctx *ctx, struct ct_system *sys,
                                             const struct ct_equilibrium_options *options)
{
    if (!ctx || !sys)
        return NULL;
    struct ct_equilibrium *q = ct_own_alloc(ctx, sizeof *q);
    if (!q)
        return NULL;
    q->system = sys;
    struct ct_equilibrium_options o;
    ct_options_take(&o, options, sizeof o);
    q->at.hold_drivers = o.hold_drivers;
    return ct_analysis_find(ctx, q, &q->own, &q->at, find);
}

void ct_equilibrium_destroy(struct ct_equilibrium *q)
{
    if (q)
        ct_analysis_free(q, &q->own, &q->at);
}

// ---- results -------------------------------------------------------------------------------

double ct_equilibrium_value(const struct ct_equilibrium *q, const char *column)
{
    if (!q || !column)
        return NAN;
    for (size_t i = 0; i < q->at.e->nresult; i++)
        if (strcmp(q->at.e->result[i].name, column) == 0)
            return q->value[i];
    return NAN;
}

bool ct_equilibrium_is_stable(const struct ct_equilibrium *q)
{
    if (!q)
        return false;
    return !(q->growth > q->doubt);
}

struct output {
    struct ct_ctx *ctx;
    const struct ct_equilibrium *q;
    const char *path;
};

static bool write_row(void *task)
{
    const struct output *o = task;
    const struct ct_equations *e = o->q->at.e;
    struct ct_columns table;
    ct_columns_init(&table, o->ctx->model, "t", CT_COLUMN_NUMBER);
    ct_columns_number(&table, 0, 0);
    for (size_t i = 0; i < e->nresult; i++) {
        const size_t c = ct_columns_add(&table, e->result[i].name, CT_COLUMN_NUMBER);
        ct_columns_number(&table, c, o->q->value[i]);
    }
    return ct_columns_write(o->ctx, &table, o->path);
}

bool ct_equilibrium_write(struct ct_ctx *ctx, const struct ct_equilibrium *q, const char *path)
{
    if (!ctx || !q)
        return false;
    struct output o = {ctx, q, path};
    return q && ct_enter(ctx, write_row, &o);
}

static void print_summary(const void *object, FILE *out)
{
    const struct ct_equilibrium *q = object;
    ct_configuration_print(&q->at, out);
    fprintf(out, "balance       the last step moved coordinates by %.2g\n",
            q->at.equilibrium.last_step);
    if (!q->at.is_large && !q->at.l->nfree) {
        fputs("stability     nothing is free to move\n", out);
        return;
    }
    fprintf(out, "stability     %s",
            q->growth > q->doubt ? "unstable"
            : q->at.e->nstate    ? (q->growth < -q->doubt ? "stable" : "neutral")
            : q->stiffness > 0   ? "stable"
            : q->stiffness < 0   ? "held by forces without potential alone"
                                 : "neutral");
    if (isfinite(q->stiffness))
        fprintf(out, ": least stiffness against mass %.9g 1/s^2, '%s' moves most", q->stiffness,
                q->softest);
    if (q->growth > q->doubt)
        fprintf(out, "; motions grow as exp(%.4g t)", q->growth);
    else if (q->growth > 0)
        fprintf(out,
                "; a growth below %.1g 1/s would not be told from round-off, as rates go up to "
                "%.2g 1/s",
                q->doubt, q->fastest);
    fputc('\n', out);
}

void ct_equilibrium_print_summary(const struct ct_equilibrium *q, FILE *out)
{
    ct_print_to(out, print_summary, q);
}

char *ct_equilibrium_summary(const struct ct_equilibrium *q)
{
    return ct_print_text(print_summary, q);
}
