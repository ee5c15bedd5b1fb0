// Analysis `buckling`: critical factors of a growing load, and the frequencies under that load.
#include "analysis/configuration.h"
#include "base/pi.h"

#include "analysis/buckling.h"
#include "analysis/eigenvalues.h"
#include "report/columns.h"
#include "analysis/model_variant.h"

#include <math.h>
#include <string.h>

// Default: number of factors that are listed (docs/cli.md). Test: analyses.
enum { STANDARD_COUNT = 10 };
enum { LEVELS = 21 }; // Layout: number of load levels of the curve

struct ct_buckling {
    struct ct_ctx own;
    struct ct_system *system;
    struct ct_configuration at; // the configuration with load factor 0
    struct ct_model *variant;
    struct ct_equations equations;
    const char *load;
    size_t count, input; // input: index of the load factor among the evaluator's inputs
    struct ct_buckling_list list;
    double *y0, *lam0, *memory0; // equilibrium at factor 0: state, multipliers, memory
};

// ---- finding the factors -------------------------------------------------------------------

static void start_again(struct ct_buckling *s)
{
    struct ct_linear *l = s->at.l;
    memcpy(l->y, s->y0, (l->m->nq + l->m->nu + 1) * sizeof *l->y);
    memcpy(l->lam, s->lam0, l->m->nrow * sizeof *l->lam);
    memcpy(l->m->input + l->m->at_memory, s->memory0, l->m->e->nmemory * sizeof *s->memory0);
    l->m->input[s->input] = 0;
    ct_evaluator_prepare(l->m);
}

static void keep_start(struct ct_buckling *s)
{
    const struct ct_linear *l = s->at.l;
    const size_t ny = l->m->nq + l->m->nu + 1, nm = l->m->e->nmemory;
    s->y0 = CT_NEWN(s->own.model, double, ny);
    s->lam0 = CT_NEWN(s->own.model, double, l->m->nrow + 1);
    s->memory0 = CT_NEWN(s->own.model, double, nm + 1);
    memcpy(s->lam0, l->lam, l->m->nrow * sizeof *s->lam0);
    memcpy(s->y0, l->y, ny * sizeof *s->y0);
    memcpy(s->memory0, l->m->input + l->m->at_memory, nm * sizeof *s->memory0);
}

static bool find(void *task)
{
    struct ct_buckling *s = task;
    size_t parameter;
    if (!s->load)
        return ct_error(&s->own, (struct ct_mark){0}, CT_E_USAGE, "which load is to grow?");
    if (s->system->model.nstate)
        return ct_error(
            &s->own, s->system->model.state[0].mark, CT_E_OF_STATES,
            "buckling is a question of stiffness alone, and this model has the state "
            "'%s': where a controlled structure gives way show 'modes' and "
            "'linearize' about an equilibrium under load",
            s->system->model.state[0].name);
    s->system = ct_system_borrow(&s->own, s->system);
    s->variant = ct_variant_create(&s->own, &s->system->model, 1);
    if (!ct_variant_load(&s->own, s->variant, s->load, &parameter)
        || !ct_equations_like(&s->own, s->variant, &s->system->equations, false, &s->equations))
        return false;
    s->variant->parameter[parameter].value = 0;
    s->input = 1 + parameter;
    s->at.model = s->variant;
    s->at.equations = &s->equations;
    s->at.about = "equilibrium";
    s->at.may_be_large = true;
    if (!ct_configuration_find(&s->own, s->system, NULL, &s->at))
        return false;
    bool applies;
    keep_start(s);
    if (!ct_buckling_find(s->at.l, s->input, s->count, &s->list, &applies))
        return false;
    if (applies)
        return true;
    s->variant->parameter[parameter].value = 0;
    if (!ct_configuration_find_full(&s->own, s->system, NULL, &s->at))
        return false;
    keep_start(s);
    return ct_buckling_find(s->at.l, s->input, s->count, &s->list, &applies);
}

struct ct_buckling *ct_buckling_create(struct ct_ctx *ctx, struct ct_system *sys,
                                       const struct ct_buckling_options *options)
{
    if (!ctx || !sys)
        return NULL;
    struct ct_buckling *s = ct_own_alloc(ctx, sizeof *s);
    if (!s)
        return NULL;
    s->system = sys;
    struct ct_buckling_options o;
    ct_options_take(&o, options, sizeof o);
    s->load = o.load;
    s->count = o.count > 0 ? (size_t)o.count : STANDARD_COUNT;
    s->at.hold_drivers = o.hold_drivers;
    return ct_analysis_find(ctx, s, &s->own, &s->at, find);
}

void ct_buckling_destroy(struct ct_buckling *s)
{
    if (s)
        ct_analysis_free(s, &s->own, &s->at);
}

size_t ct_buckling_count(const struct ct_buckling *s)
{
    if (!s)
        return 0;
    return s->list.n;
}

double ct_buckling_factor(const struct ct_buckling *s, size_t i)
{
    if (!s)
        return NAN;
    return i < s->list.n ? s->list.factor[i].factor : NAN;
}

// ---- tables ---------------------------------------------------------------------------------

struct output {
    struct ct_ctx *ctx;
    struct ct_buckling *s;
    const char *path;
    long count;
};

static bool write_factors(void *task)
{
    const struct output *o = task;
    const struct ct_buckling_list *list = &o->s->list;
    struct ct_columns t;
    ct_columns_init(&t, o->ctx->model, "mode", CT_COLUMN_INTEGER);
    const size_t factor = ct_columns_add(&t, "load_factor", CT_COLUMN_NUMBER);
    for (size_t i = 0; i < list->n; i++) {
        ct_columns_number(&t, 0, (double)(i + 1));
        ct_columns_number(&t, factor, list->factor[i].factor);
    }
    return ct_columns_write(o->ctx, &t, o->path);
}

bool ct_buckling_write(struct ct_ctx *ctx, struct ct_buckling *s, const char *path)
{
    if (!ctx || !s)
        return false;
    struct output o = {ctx, s, path, 0};
    return s && ct_enter(ctx, write_factors, &o);
}

// Frequency in Hz; negative for a motion that grows without oscillating.
static double signed_frequency(const struct ct_motion_mode *m)
{
    const double size = hypot(m->re, m->im) / (2 * CT_PI);
    return m->im == 0 && m->re > 0 ? -size : size;
}

// One row: the lowest frequencies at the present load factor. Fields stay empty where there are
// fewer.
static bool add_level(struct ct_ctx *ctx, struct ct_buckling *s, struct ct_columns *t,
                      long count)
{
    struct ct_linear *l = s->at.l;
    struct ct_motion_mode *mode;
    size_t n;
    const char *how;
    (void)ctx;
    bool applies = true;
    if (s->at.is_large
            ? !ct_sparse_modes(&s->own, s->own.model, l, (size_t)count + 2, &mode, &n, &how,
                               &applies)
                  || !applies
            : !ct_linear_rest(l) || !ct_modes_solve(&s->own, s->own.model, l, &mode, &n, &how))
        return false;
    ct_columns_number(t, 0, l->m->input[s->input]);
    size_t k = 0;
    for (size_t i = 0; i < n && k < (size_t)count; i++)
        // of the pair exp(s t), exp(-s t) only the growing one is listed
        if (mode[i].im > 0 || mode[i].re >= 0)
            ct_columns_number(t, ++k, signed_frequency(&mode[i]));
    while (k < (size_t)count)
        ct_columns_number(t, ++k, NAN);
    return true;
}

static bool write_curve(void *task)
{
    const struct output *o = task;
    struct ct_buckling *s = o->s;
    struct ct_arena *a = o->ctx->model;
    struct ct_columns t;
    bool ok = true;
    ct_columns_init(&t, a, "load_factor", CT_COLUMN_NUMBER);
    for (long k = 1; k <= o->count; k++)
        ct_columns_add(&t, ct_arena_printf(a, "frequency_hz_%ld", k), CT_COLUMN_NUMBER);
    start_again(s);
    for (int i = 0; i < LEVELS && ok; i++) {
        const double factor = s->list.factor[0].factor * i / (LEVELS - 1);
        if (!ct_buckling_load(s->at.l, s->input, factor) && i + 1 < LEVELS)
            break; // the path ends here
        ok = add_level(o->ctx, s, &t, o->count);
    }
    ct_ctx_hand_over(o->ctx, &s->own);
    return ok && ct_columns_write(o->ctx, &t, o->path);
}

bool ct_buckling_write_curve(struct ct_ctx *ctx, struct ct_buckling *s, const char *path,
                             long count)
{
    if (!ctx || !s)
        return false;
    struct output o = {ctx, s, path, count > 0 ? count : 3};
    return s && ct_enter(ctx, write_curve, &o);
}

static void print_summary(const void *object, FILE *out)
{
    const struct ct_buckling *s = object;
    const struct ct_buckling_list *list = &s->list;
    size_t exact = 0;
    ct_configuration_print(&s->at, out);
    while (exact < list->n && list->factor[exact].is_exact)
        exact++;
    if (!list->has_potential)
        fputs("load          has no potential: factors are those of the linear problem, and\n"
              "              flutter may come before; see 'cotree modes' of the loaded model\n",
              out);
    else if (exact == list->n)
        fputs("factors       refined on the path of equilibria\n", out);
    else
        fprintf(out,
                "factors       the first %zu refined on the path of equilibria, then linear "
                "estimates\n",
                exact);
    const struct ct_buckling_factor *f = &list->factor[0];
    fprintf(out, "first         %.9g", f->factor);
    if (f->linear > 0 && f->is_exact)
        fprintf(out, "; %.9g by the linear problem", f->linear);
    fputs(f->is_limit ? "; the path of equilibria ends there\n" : "\n", out);
}

void ct_buckling_print_summary(const struct ct_buckling *s, FILE *out)
{
    ct_print_to(out, print_summary, s);
}

char *ct_buckling_summary(const struct ct_buckling *s)
{
    return ct_print_text(print_summary, s);
}
