// Work-precision study: methods x tolerances against a converged reference.
//
//     reference: runs with tight tolerances of different methods that agree, or a file
//     ladder of a method: loose -> tight, each setting run several times  -> a point each
//
// What always holds: settings run one after the other in this thread. A ladder ends when its method
// has used up its share of the time. A setting that fails is a point without an error, not a
// failure of the study.
#include "accuracy/accuracy.h"

#include "base/guard.h"
#include "report/number.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Default: the wanted error, as docs/cli.md says. Test: accuracy
static const double default_error = 1e-6;
// Limit: six methods in about a minute; more if the reference alone takes long.  [s]
static const double share_of_method = 9, share_of_reference = 1;
// Limit: of the time spent on repetitions, which only make measured times less noisy.
enum { REPEATS = 3, MOST_REPEATS = 101 }; // MOST_REPEATS: of short runs
static const double short_times = 0.05;   // Limit: of one setting together  [s]
enum { MOST_PER_DECADE = 10 };            // Limit: tolerances have two digits; with a message
// Limit: fixed steps: number of halvings, from the spacing of samples, but at least this number of
// steps in the run.
static const int most_steps_of_ladder = 7;
static const double least_fixed_steps = 100;
// With a given step: number of powers of ten covered.
enum { DECADES_OF_STEPS = 2 }; // Limit: rows of a table
// Errors that differ by less than this part of themselves are equal. Derived: the table shows two
// digits.
static const double same_error_change = 0.01;

// ---- ladders ------------------------------------------------------------------------------------

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// Median of n > 0 numbers, which are sorted in place; the lower one of both if n is even.
static double median(double *v, int n)
{
    qsort(v, (size_t)n, sizeof *v, compare_doubles);
    return v[(n - 1) / 2];
}

static bool compare_row(void *user, double t, const double *value, size_t n)
{
    struct ct_accuracy *a = user;
    const double *reference = a->reference + a->nrow++ * n;
    (void)t;
    for (size_t i = 0; i < n; i++)
        if (a->scale[i] > 0 && !isnan(reference[i]))
            a->worst = fmax(a->worst, fabs(value[i] - reference[i]) / a->scale[i]);
    return true;
}

// Run one setting several times in place while the time lasts.
static enum ct_ending measure(struct ct_accuracy *a, const struct ct_setting *s, double end)
{
    struct ct_work_precision_point p;
    double seconds[MOST_REPEATS], sum;
    int n = 1;
    const enum ct_ending ending
        = ct_accuracy_start(a, s, end - ct_monotonic_time(), compare_row, &p);
    if (ending == CT_RUN_DONE)
        p.error = a->worst;
    seconds[0] = sum = p.seconds;
    while (ending == CT_RUN_DONE && n < (sum < short_times ? MOST_REPEATS : REPEATS)
           && ct_monotonic_time() + p.seconds < end
           && ct_accuracy_repeat(a, compare_row, &seconds[n]))
        sum += seconds[n++];
    ct_accuracy_end_run(a);
    if (ending == CT_RUN_REFUSED)
        return ending;
    // Definition: [ns]
    p.seconds = round(median(seconds, n) * 1e9) / 1e9; // resolution of the clock
    CT_PUSH(a->own.model, a->point, a->npoint, a->point_cap, p);
    return ending;
}

// Range of tolerances as powers of ten, from loose to tight. The automatic method begins with an
// explicit one.
static void choose_powers(const char *name, int *first, int *last)
{
    const struct ct_method *m = ct_method_find(name);
    const bool is_implicit = m && m->is_implicit, is_low = is_implicit && m->order < 3;
    *first = is_low ? 2 : 4;
    *last = !is_implicit ? 11 : is_low ? 7 : 9;
}

// In the ladder that begins at point[start], do tighter tolerances no longer change the error of a
// beam? The rest is then the error of its elements or formulation.
static bool shows_mesh(const struct ct_accuracy *a, size_t start)
{
    // Limit: number of settings without a change
    enum { SETTINGS = 3 };
    if (!a->variant || a->npoint < start + SETTINGS)
        return false;
    const struct ct_work_precision_point *last = &a->point[a->npoint - 1];
    bool is_same = true;
    for (int i = 1; i < SETTINGS; i++)
        is_same
            = is_same && fabs(last[-i].error - last->error) <= same_error_change * last->error;
    return is_same;
}

// 10^power to two digits: 2.2e-05, and 1e-05 rather than 1.0000000000000001e-05.
static double tolerance_at(double power)
{
    char text[CT_NUMBER_SIZE];
    snprintf(text, sizeof text, "%.1e", pow(10, power));
    return strtod(text, NULL);
}

static bool climb_tolerances(struct ct_accuracy *a, const char *name, double end)
{
    // Layout: the loosest tolerance of a table is 1e-2
    const int loosest_of_fine = 2, n = a->o->per_decade > 0 ? a->o->per_decade : 1;
    int first, last;
    choose_powers(name, &first, &last);
    if (a->o->per_decade > 0)
        first = loosest_of_fine;
    struct ct_setting s = {.method = name, .tolerance = a->o->run.tolerance};
    enum ct_ending ending = CT_RUN_DONE;
    if (s.tolerance > 0)
        return measure(a, &s, end) != CT_RUN_REFUSED;
    const size_t start = a->npoint;
    for (int k = first * n; k <= last * n && (ending == CT_RUN_DONE || ending == CT_RUN_FAILED)
                            && !shows_mesh(a, start);
         k++) {
        s.tolerance = tolerance_at(-(double)k / n);
        ending = measure(a, &s, end);
    }
    return ending != CT_RUN_REFUSED;
}

// v to ten digits: 1e-4 rather than 9.9999999999999991e-05.
static double readable(double v)
{
    char text[CT_NUMBER_SIZE];
    snprintf(text, sizeof text, "%.10g", v);
    return strtod(text, NULL);
}

// Ladder of fixed steps. Default: halvings of the spacing of samples, since steps end at samples.
// With a given step: that one alone, or as many per power of ten as requested.
static bool climb_steps(struct ct_accuracy *a, const char *name, double end)
{
    const double spacing = a->duration / fmax(1, (double)a->nsample - 1);
    const double asked = a->o->run.step, per_decade = a->o->per_decade;
    const double first
        = asked > 0 ? asked : readable(fmin(spacing, a->duration / least_fixed_steps));
    const double ratio = asked > 0 && per_decade > 0 ? pow(10, -1 / per_decade) : 0.5;
    const int n = asked <= 0 ? most_steps_of_ladder : DECADES_OF_STEPS * (int)per_decade + 1;
    struct ct_setting s = {.method = name};
    enum ct_ending ending = CT_RUN_DONE;
    for (int k = 0; k < n && (ending == CT_RUN_DONE || ending == CT_RUN_FAILED); k++) {
        const double step = first * pow(ratio, k);
        s.step = ratio == 0.5 ? step : readable(step);
        ending = measure(a, &s, end);
    }
    return ending != CT_RUN_REFUSED;
}

static bool climb(struct ct_accuracy *a, const char *name)
{
    const double end = ct_monotonic_time()
                     + fmax(share_of_method, share_of_reference * a->reference_seconds);
    const bool is_asked = a->o->run.step > 0 && !(a->o->run.tolerance > 0);
    const bool is_fixed = is_asked || strcmp(name, "rk4") == 0;
    return (is_fixed ? climb_steps : climb_tolerances)(a, name, end)
        || (ct_ctx_hand_over(&a->own, &a->said), false);
}

// method (ct_nmethod + 1, out): the requested methods, once each, in the order of the table of
// methods, the automatic choice first. If listed with others, it counts as one.
static bool choose_methods(struct ct_accuracy *a, const char *text, const char **method, int *n)
{
    static const char usual[] = "dopri5,dop853,rk4,radau5,generalized-alpha", chosen[] = "auto";
    if (!text || strcmp(text, chosen) == 0)
        text = usual;
    const int nname = ct_nmethod + 1;
    const char **names = CT_NEWN(a->own.scratch, const char *, nname);
    bool *is_wanted = CT_NEWN(a->own.scratch, bool, nname + 1), ok = true;
    names[0] = chosen;
    for (int i = 1; i < nname; i++)
        names[i] = ct_methods[i - 1]->name;
    for (const char *next; text; text = next) {
        const size_t length = strcspn(text, ",");
        next = text[length] ? text + length + 1 : NULL;
        const char *name = ct_arena_strndup(a->own.scratch, text, length);
        int i = 0;
        while (i < nname && strcmp(names[i], name) != 0)
            i++;
        if (i == nname)
            ok = ct_error(&a->own, (struct ct_mark){0}, CT_E_USAGE,
                          "this version has no method '%s'%s", name,
                          ct_suggest_or_list(a->own.scratch, name, names, (size_t)nname));
        is_wanted[i] = true;
    }
    *n = 0;
    for (int i = 0; i < nname; i++)
        if (is_wanted[i])
            method[(*n)++] = names[i];
    return ok;
}

// ---- entry points ------------------------------------------------------------------------------

static void choose_best(struct ct_accuracy *a)
{
    if (a->uncertainty > a->wanted)
        return; // an error this small cannot be resolved
    for (size_t i = 0; i < a->npoint; i++)
        if (a->point[i].error <= a->wanted
            && (!a->best || a->point[i].seconds < a->best->seconds))
            a->best = &a->point[i];
}

// Set up the model as simulate would: this reports wrong options and gives the number of samples.
static bool learn_sizes(struct ct_accuracy *a)
{
    const struct ct_simulation *m = &a->system->model.simulation;
    struct ct_sim_options o = a->o->run;
    o.method = "dopri5";
    a->sim = ct_sim_create(&a->own, a->system, &o);
    const bool ok = a->sim != NULL;
    if (ok) {
        a->duration = a->sim->run_options.duration;
        a->nsample = a->sim->run_options.nsample;
    }
    a->said.no_memory = a->own.no_memory;
    ct_accuracy_end_run(a);
    if (ok && !m->has_duration && !(a->duration > 0))
        return ct_error(&a->own, m->mark, CT_E_KEY_MISSING,
                        "there is no end time: 'simulation' needs a 'duration'");
    a->nresult = a->system->equations.nresult;
    a->scale = CT_NEWN(a->own.model, double, a->nresult + 1);
    a->difference = CT_NEWN(a->own.model, struct ct_output_error_estimate, a->nresult + 1);
    return ok;
}

static bool study(struct ct_accuracy *a)
{
    const char **method = CT_NEWN(a->own.model, const char *, ct_nmethod + 1);
    int n;
    if (!choose_methods(a, a->o->run.method, method, &n) || !learn_sizes(a))
        return false;
    if (a->o->reference ? !ct_accuracy_read_reference(a, a->o->reference)
                        : !ct_accuracy_find_reference(a))
        return false;
    const size_t nvariant = a->o->variant ? a->o->nvariant : 1;
    const double all = (double)nvariant * n;
    for (size_t v = 0; v < nvariant; v++) {
        if (a->o->variant) {
            a->variant = &a->o->variant[v];
            a->system = ct_system_borrow(&a->own, a->variant->system);
        }
        for (int i = 0; i < n; i++) {
            ct_progress_update(&a->progress, ((double)v * n + i + 1) / (all + 1));
            if (!climb(a, method[i]))
                return false;
        }
    }
    if (a->uncertainty > a->wanted)
        ct_warning(
            &a->own, (struct ct_mark){0}, CT_E_REFERENCE,
            "the runs for the reference do not agree (%s): they differ by %.2g, so the error "
            "of no run is known better than that",
            a->source, a->uncertainty);
    else if (a->uncertainty > CT_REFERENCE_MARGIN * a->wanted)
        ct_warning(&a->own, (struct ct_mark){0}, CT_E_REFERENCE,
                   "the reference (%s) is known to %.2g only: smaller errors mean nothing",
                   a->source, a->uncertainty);
    choose_best(a);
    return true;
}

static bool has_sense(struct ct_accuracy *a)
{
    const int n = a->o->per_decade;
    if (!(a->wanted > 0 && isfinite(a->wanted)))
        return ct_error(&a->own, (struct ct_mark){0}, CT_E_USAGE,
                        "the wanted error is %g; it must be greater than 0", a->wanted);
    if (n < 0 || n > MOST_PER_DECADE)
        return ct_error(&a->own, (struct ct_mark){0}, CT_E_USAGE,
                        "%d tolerances in a power of ten; at most %d can be tried", n,
                        MOST_PER_DECADE);
    return true;
}

struct create {
    struct ct_ctx *ctx;
    struct ct_accuracy *a;
};

static bool create(void *task)
{
    struct create *c = task;
    struct ct_accuracy *a = c->a;
    ct_own_init(&a->own);
    a->said.model = a->own.model;
    a->system = ct_system_borrow(&a->own, a->system); // all runs share data derived later
    if (a->o->bar) {
        ct_progress_init(&a->progress, a->o->bar, "accuracy");
        ct_progress_update(&a->progress, 0);
    }
    const bool ok = has_sense(a) && study(a);
    ct_progress_finish(&a->progress);
    ct_ctx_hand_over(c->ctx, &a->own);
    return ok;
}

struct ct_accuracy *ct_accuracy_create(struct ct_ctx *ctx, struct ct_system *sys,
                                       const struct ct_accuracy_options *options)
{
    struct ct_accuracy_options o;
    ct_options_take(&o, options, sizeof o);
    if (!ctx || !sys)
        return NULL;
    struct create c = {ctx, calloc(1, sizeof *c.a)};
    if (!c.a) {
        ctx->no_memory = true;
        return NULL;
    }
    c.a->system = sys;
    c.a->o = &o;
    c.a->wanted = c.a->o->error != 0 ? c.a->o->error : default_error;
    const bool ok = ct_enter(ctx, create, &c);
    c.a->o = NULL;
    if (ok)
        return c.a;
    ct_accuracy_destroy(c.a);
    return NULL;
}

void ct_accuracy_destroy(struct ct_accuracy *a)
{
    if (!a)
        return;
    ct_sim_destroy(a->sim);
    ct_own_finish(&a->own);
    free(a);
}

// ---- results -----------------------------------------------------------------------------------

struct output {
    struct ct_ctx *ctx;
    const struct ct_accuracy *a;
    const char *path;
};

static bool write_table(void *task)
{
    const struct output *o = task;
    return ct_work_precision_write(o->ctx, o->path, o->a->point, o->a->npoint);
}

bool ct_accuracy_write(struct ct_ctx *ctx, const struct ct_accuracy *a, const char *path)
{
    if (!ctx || !a)
        return false;
    struct output o = {ctx, a, path};
    return a && ct_enter(ctx, write_table, &o);
}

static struct ct_work_precision_plot plot_of(const struct ct_accuracy *a)
{
    return (struct ct_work_precision_plot){.title = a->system->model.name,
                                           .wanted = a->wanted,
                                           .uncertainty = a->uncertainty,
                                           .best = a->best};
}

void ct_accuracy_print_plot(FILE *out, const struct ct_accuracy *a)
{
    const struct ct_work_precision_plot plot = plot_of(a);
    ct_work_precision_print(out, a->point, a->npoint, &plot);
}

static bool draw_plot(void *task)
{
    const struct output *o = task;
    const struct ct_accuracy *a = o->a;
    const struct ct_work_precision_plot plot = plot_of(a);
    return ct_work_precision_draw(o->ctx, o->path, a->point, a->npoint, &plot);
}

bool ct_accuracy_draw(struct ct_ctx *ctx, const struct ct_accuracy *a, const char *path)
{
    if (!ctx || !a || !path)
        return false;
    struct output o = {ctx, a, path};
    return a && ct_enter(ctx, draw_plot, &o);
}

static void print_setting(const struct ct_work_precision_point *p, FILE *out)
{
    char text[CT_NUMBER_SIZE];
    char name[80];
    ct_work_precision_name(name, sizeof name, p);
    fprintf(out, "method %s, %s %s: error %.2g in %.3g s\n", name,
            p->has_step ? "step" : "tolerance", ct_number_format(text, p->tolerance), p->error,
            p->seconds);
}

static void print_left_out(const struct ct_accuracy *a, FILE *out)
{
    const char *separator = "not compared  ";
    for (size_t i = 0; i < a->nresult; i++)
        if (!(a->scale[i] > 0)) {
            fprintf(out, "%s%s", separator, a->system->equations.result[i].name);
            separator = ", ";
        }
    if (*separator == ',')
        fputs(": not in the reference, or zero but for round-off\n", out);
}

// The cheapest point among those with the least error; NULL if all failed.
static const struct ct_work_precision_point *find_nearest(const struct ct_accuracy *a)
{
    const struct ct_work_precision_point *nearest = NULL;
    double least = INFINITY;
    for (size_t i = 0; i < a->npoint; i++)
        least = fmin(least, a->point[i].error);
    for (size_t i = 0; i < a->npoint; i++)
        if (a->point[i].error <= (1 + same_error_change) * least
            && (!nearest || a->point[i].seconds < nearest->seconds))
            nearest = &a->point[i];
    return nearest;
}

static void print_summary(const void *object, FILE *out)
{
    const struct ct_accuracy *a = object;
    char wanted[CT_NUMBER_SIZE];
    const struct ct_work_precision_point *nearest = find_nearest(a);
    fprintf(out, "reference     %s", a->source);
    if (!isnan(a->uncertainty))
        fprintf(out, ": they differ by %.2g", a->uncertainty);
    fputc('\n', out);
    print_left_out(a, out);
    ct_number_format(wanted, a->wanted);
    if (a->best) {
        fprintf(out, "cheapest      for an error of %s: ", wanted);
        print_setting(a->best, out);
        return;
    }
    fprintf(out, "cheapest      no setting %s an error of %s",
            a->uncertainty > a->wanted ? "can be shown to meet" : "meets", wanted);
    fputs(nearest ? "; the nearest is " : "; every run failed\n", out);
    if (nearest)
        print_setting(nearest, out);
}

void ct_accuracy_print_summary(const struct ct_accuracy *a, FILE *out)
{
    ct_print_to(out, print_summary, a);
}

char *ct_accuracy_summary(const struct ct_accuracy *a)
{
    return ct_print_text(print_summary, a);
}
