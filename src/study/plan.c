// See plan.h.
#include "study/plan.h"
#include "base/entry.h"
#include "io/sheet.h"
#include "io/text.h"
#include "report/number.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct ct_mark none = {0};

// ---- reading -------------------------------------------------------------------------------

// Reads a number, a quantity with a unit or a constant expression, as for parameters of a
// model.
static bool read_value(struct ct_ctx *ctx, const char *text, double *value)
{
    static const char model[] = "cotree: 1\nparameters: {value: 0}\n";
    struct ct_model m;
    struct ct_ctx own = {0};
    own.model = ct_arena_create_under(ctx->model);
    own.scratch = ct_arena_create_under(ctx->model);
    const struct ct_set set = {ct_arena_printf(own.model, "value=%s", text)};
    const bool ok = ct_model_parse(&own, "", model, sizeof model - 1, &set, 1, &m);
    if (ok)
        *value = m.parameter[0].value;
    ct_own_finish(&own);
    return ok;
}

static bool wrong(struct ct_ctx *ctx, const struct ct_axis *axis, const char *why)
{
    return ct_error(
        ctx, none, CT_E_USAGE,
        "--vary '%s': %s; wanted is NAME=FROM:TO:N, as r=0.1:0.2:11, or with --sample "
        "NAME=FROM:TO or NAME=normal:MEAN:DEVIATION",
        axis->text, why);
}

static bool read_count(const char *text, long *n)
{
    char *end;
    errno = 0;
    *n = strtol(text, &end, 10);
    return end != text && !*end && !errno && *n >= 1 && *n <= CT_MOST_MEMBERS;
}

// Returns the part of *text up to the next colon. *text becomes the remainder, NULL at the end.
static const char *take_part(struct ct_ctx *ctx, const char **text)
{
    const char *part = *text;
    const size_t n = strcspn(part, ":");
    *text = part[n] ? part + n + 1 : NULL;
    return ct_arena_strndup(ctx->model, part, n);
}

static bool read_numbers(struct ct_ctx *ctx, struct ct_axis *axis, const char *rest)
{
    const char *from = take_part(ctx, &rest);
    if (strcmp(from, "normal") == 0 && rest) {
        axis->kind = CT_AXIS_NORMAL;
        from = take_part(ctx, &rest);
    }
    if (!rest)
        return wrong(ctx, axis, "there is one value only");
    const char *to = take_part(ctx, &rest);
    const char *const text[] = {from, to};
    double *const value[] = {&axis->from, &axis->to};
    for (int i = 0; i < 2; i++)
        if (!read_value(ctx, text[i], value[i]))
            return wrong(ctx, axis,
                         ct_arena_printf(ctx->model, "'%s' is no constant value", text[i]));
    if (axis->kind == CT_AXIS_NORMAL && (rest || !(axis->to >= 0)))
        return wrong(ctx, axis,
                     rest ? "there is something behind it"
                          : "the deviation must not be negative");
    if (rest && !read_count(rest, &axis->n))
        return wrong(ctx, axis,
                     ct_arena_printf(ctx->model, "N is '%s', not an integer from 1 to %d", rest,
                                     CT_MOST_MEMBERS));
    return true;
}

// option: the command-line option that gives the axis.
static bool find_parameter(struct ct_ctx *ctx, const struct ct_model *m,
                           const struct ct_axis *axis, struct ct_mark at, const char *option)
{
    if (ct_names_get(&m->parameter_index, axis->name) >= 0)
        return true;
    const char **names = CT_NEWN(ctx->model, const char *, m->nparameter + 1);
    for (size_t i = 0; i < m->nparameter; i++)
        names[i] = m->parameter[i].name;
    return ct_error(ctx, at, CT_E_USAGE, "%s '%s': the model has no parameter '%s'%s", option,
                    axis->text, axis->name,
                    ct_suggest_or_list(ctx->model, axis->name, names, m->nparameter));
}

static bool read_axis(struct ct_ctx *ctx, const struct ct_model *m, struct ct_plan *s, size_t i)
{
    struct ct_axis *axis = &s->axis[i];
    const char *equals = strchr(axis->text, '=');
    if (!equals || equals == axis->text)
        return wrong(ctx, axis, "there is no NAME=");
    axis->name = ct_arena_strndup(ctx->model, axis->text, (size_t)(equals - axis->text));
    for (size_t k = 0; k < i; k++)
        if (s->axis[k].name && strcmp(s->axis[k].name, axis->name) == 0)
            return wrong(ctx, axis, "the parameter varies already");
    if (!find_parameter(ctx, m, axis, none, "--vary") || !read_numbers(ctx, axis, equals + 1))
        return false;
    if (s->is_sampled || axis->n)
        return true;
    return wrong(ctx, axis,
                 axis->kind == CT_AXIS_NORMAL ? "a distribution needs --sample"
                                              : "without --sample it needs N");
}

static bool count_members(struct ct_ctx *ctx, struct ct_plan *s, long sample)
{
    double n = 1;
    for (size_t i = 0; i < s->naxis; i++)
        n *= (double)s->axis[i].n;
    if (s->is_sampled)
        n = (double)sample;
    if (n > CT_MOST_MEMBERS)
        return ct_error(ctx, none, CT_E_USAGE,
                        "the study has %.6g members; at most %d are possible", n,
                        CT_MOST_MEMBERS);
    s->nall = s->nmember = (long)n;
    return true;
}

bool ct_plan_read(struct ct_ctx *ctx, const struct ct_model *m, const char *const *vary,
                  size_t n, long sample, uint64_t seed, struct ct_plan *out)
{
    *out = (struct ct_plan){.naxis = n, .is_sampled = sample > 0, .seed = seed};
    out->axis = CT_NEWN(ctx->model, struct ct_axis, n + 1);
    bool ok = n > 0
           || ct_error(ctx, none, CT_E_USAGE,
                       "nothing varies: --vary NAME=FROM:TO:N or --members FILE.csv is needed");
    for (size_t i = 0; i < n; i++) {
        out->axis[i].text = vary[i];
        ok &= read_axis(ctx, m, out, i);
    }
    return ok && count_members(ctx, out, sample);
}

// ---- members from a file -------------------------------------------------------------------

static bool read_sheet(struct ct_ctx *ctx, const char *path, struct ct_sheet *sheet)
{
    // Limit: with a message
    const size_t most = (size_t)1 << 30;
    char *text;
    size_t n;
    errno = 0;
    const enum ct_text_result e = ct_text_read(ctx->scratch, path, most, &text, &n);
    if (e != CT_TEXT_OK)
        return ct_error(ctx, none, CT_E_FILE, "cannot read the members '%s': %s", path,
                        e == CT_TEXT_TOO_BIG ? "the file is too big" : strerror(errno));
    return ct_sheet_parse(ctx, ctx->scratch, path, text, n, sheet);
}

static bool read_column(struct ct_ctx *ctx, const struct ct_model *m, const struct ct_sheet *t,
                        struct ct_plan *s, size_t i)
{
    struct ct_axis *axis = &s->axis[i];
    double *value = CT_NEWN(ctx->model, double, s->nall);
    *axis = (struct ct_axis){
        .name = ct_arena_strdup(ctx->model, t->field[i]),
        .text = ct_arena_strdup(ctx->model, s->file),
        .kind = CT_AXIS_LIST,
        .value = value,
        .n = s->nall,
    };
    for (size_t k = 0; k < i; k++)
        if (strcmp(s->axis[k].name, axis->name) == 0)
            return ct_error(ctx, t->mark[i], CT_E_USAGE, "there are two columns '%s'",
                            axis->name);
    if (!find_parameter(ctx, m, axis, t->mark[i], "--members"))
        return false;
    for (long k = 0; k < s->nall; k++) {
        const size_t at = (size_t)(k + 1) * t->ncolumn + i;
        const char *field = t->field[at];
        char *end;
        value[k] = strtod(field, &end); // the locale is "C"
        const bool is_number = end != field && !*end;
        if ((!is_number && !read_value(ctx, field, &value[k])) || !isfinite(value[k]))
            return ct_error(ctx, t->mark[at], CT_E_TABLE_DATA,
                            "'%.60s' is no constant, finite value of the parameter '%s'", field,
                            axis->name);
    }
    return true;
}

bool ct_plan_read_members(struct ct_ctx *ctx, const struct ct_model *m, const char *path,
                          struct ct_plan *out)
{
    struct ct_sheet t = {0};
    *out = (struct ct_plan){.file = ct_arena_strdup(ctx->model, path)};
    if (!read_sheet(ctx, path, &t))
        return false;
    if (t.nrow < 2 || t.nrow - 1 > CT_MOST_MEMBERS)
        return ct_error(ctx, (struct ct_mark){.file = out->file}, CT_E_USAGE,
                        "--members needs a first row of parameters and from 1 to %d rows of "
                        "values below it; there are %zu rows",
                        CT_MOST_MEMBERS, t.nrow);
    out->naxis = t.ncolumn;
    out->nall = out->nmember = (long)t.nrow - 1;
    out->axis = CT_NEWN(ctx->model, struct ct_axis, t.ncolumn + 1);
    bool ok = true;
    for (size_t i = 0; i < t.ncolumn && ok; i++)
        ok = read_column(ctx, m, &t, out, i);
    return ok;
}

bool ct_plan_choose(struct ct_ctx *ctx, const struct ct_model *m, const char *members,
                    const char *const *vary, size_t n, long sample, uint64_t seed,
                    struct ct_plan *out)
{
    if (!members)
        return ct_plan_read(ctx, m, vary, n, sample, seed, out);
    if (n || sample > 0)
        return ct_error(ctx, none, CT_E_USAGE,
                        "the members come either from a file or from --vary: --members goes "
                        "without --vary and --sample");
    return ct_plan_read_members(ctx, m, members, out);
}

const char **ct_plan_settings(struct ct_arena *a, const struct ct_plan *s, const double *value,
                              const char *const *set, size_t *n)
{
    const char **all = CT_NEWN(a, const char *, *n + s->naxis + 1);
    for (size_t i = 0; i < *n; i++)
        all[i] = set[i];
    for (size_t i = 0; i < s->naxis; i++) {
        char text[CT_NUMBER_SIZE];
        all[(*n)++]
            = ct_arena_printf(a, "%s=%s", s->axis[i].name, ct_number_format(text, value[i]));
    }
    return all;
}

// ---- shards --------------------------------------------------------------------------------

bool ct_plan_take_shard(struct ct_ctx *ctx, struct ct_plan *s, long shard, long nshard)
{
    if (shard == 0 && nshard == 0)
        return true;
    if (!(shard >= 1 && shard <= nshard))
        return ct_error(ctx, none, CT_E_USAGE,
                        "there is no shard %ld/%ld: wanted is I/N with I from 1 to N", shard,
                        nshard);
    s->shard = shard;
    s->nshard = nshard;
    s->nmember = s->nall >= shard ? (s->nall - shard) / nshard + 1 : 0;
    return true;
}

long ct_plan_number(const struct ct_plan *s, long member)
{
    return s->nshard ? s->shard + member * s->nshard : member + 1;
}

// ---- values --------------------------------------------------------------------------------

// Random number k (from 0) of the sequence with this seed, in [0, 1).
static double random_number(uint64_t seed, uint64_t k)
{
    uint64_t z = seed + (k + 1) * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return (double)(z >> 11) / 9007199254740992.0;
}

static double sampled(const struct ct_plan *s, long member, size_t i)
{
    const struct ct_axis *axis = &s->axis[i];
    const uint64_t k = 2 * ((uint64_t)member * s->naxis + i);
    const double u1 = random_number(s->seed, k), u2 = random_number(s->seed, k + 1);
    if (axis->kind == CT_AXIS_RANGE)
        return axis->from + u1 * (axis->to - axis->from);
    return axis->from + axis->to * sqrt(-2 * log(1 - u1)) * cos(2 * acos(-1) * u2);
}

double ct_plan_value(const struct ct_plan *s, long local, size_t i)
{
    long member = ct_plan_number(s, local) - 1;
    const struct ct_axis *axis = &s->axis[i];
    if (s->is_sampled)
        return sampled(s, member, i);
    if (axis->kind == CT_AXIS_LIST)
        return axis->value[member];
    for (size_t k = s->naxis - 1; k > i; k--)
        member /= s->axis[k].n;
    const long place = member % axis->n;
    if (place == 0)
        return axis->from;
    if (place == axis->n - 1)
        return axis->to;
    return axis->from + (axis->to - axis->from) * (double)place / (double)(axis->n - 1);
}
