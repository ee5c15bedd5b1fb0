// Speed against error: methods x tolerances against a converged reference.
//
//     reference: tight runs of different methods that agree, or a file
//     ladder of a method: loose -> tight, each setting run several times  -> a point each
//
// What always holds: settings run one after the other in this thread; a ladder ends when its method has used
// up its share of the time; a setting that fails is a point without an error, not a failure of the whole.
#include "api.h"

#include "base/guard.h"
#include "expr/unit.h"
#include "io/sheet.h"
#include "io/text.h"
#include "report/precision.h"
#include "report/progress.h"
#include "solve/quad.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double standard_error = 1e-6;
// Six methods within about a minute; more where already the reference takes long.  [s]
static const double share_of_method = 9, share_of_reference = 1, reference_limit = 20,
                    quad_limit = 10;
enum { REPEATS = 3, MOST_REPEATS = 15 }; // the latter of short ones
static const double short_times = 0.05;  // of one setting together  [s]
// Runs that agree to this need no third one to judge.
static const double good_agreement = 1e-8;
// A reference should be better than the error that is asked about by this factor.
static const double reference_margin = 0.1;
// Steps of fixed length: as many halvings, from the spacing of samples but at least so many in the run.
static const int most_steps_of_ladder = 7;
static const double least_fixed_steps = 100;
// Errors that differ by this part of themselves are the same.
static const double same_error = 0.01;
// Times of samples in a file are matched to this part of the run.
static const double same_time = 1e-9;

enum { NREFERENCE = 4 };

struct ct_accuracy {
    struct ct_ctx own;
    struct ct_ctx said; // what single runs say
    struct ct_system *system;
    const struct ct_accuracy_options *o; // while it works
    const struct ct_accuracy_variant
        *variant;       // of the system that runs; NULL: there is one only
    struct ct_sim *sim; // the one that runs
    struct ct_progress progress;
    const char *name;
    double wanted;
    double duration;
    size_t nsample, nresult, nrow; // nrow: rows of the run so far
    double *store;                 // nsample x nresult: where the run goes; NULL: nowhere
    double *reference;             // nsample x nresult; NaN: not known
    double *scale;                 // (nresult) largest |reference|; 0: not compared
    double *deviation;             // (nresult) to spare
    double worst;                  // error of the run so far
    const char *source;            // of the reference
    double uncertainty;            // NaN: not known
    double reference_seconds;
    struct ct_precision_point *point;
    size_t npoint, point_cap;
    const struct ct_precision_point *best;
};

enum ending { DONE, FAILED, LATE, REFUSED }; // REFUSED: the options are wrong

// How one run is made: a method with a tolerance or a step.
struct setting {
    const char *method;
    double tolerance, step; // one of them
    double rtol;            // > 0: tolerance of the steps, whatever simulate makes of one
};

// ---- one run -----------------------------------------------------------------------------------------

static bool keep_row(void *user, double t, const double *value, size_t n)
{
    struct ct_accuracy *a = user;
    (void)t;
    memcpy(a->store + a->nrow++ * n, value, n * sizeof *value);
    return true;
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

static void end_run(struct ct_accuracy *a)
{
    const bool no_memory = a->said.no_memory;
    ct_sim_destroy(a->sim);
    a->sim = NULL;
    if (no_memory)
        ct_guard_raise();
}

// a->sim as s says, else NULL with what there is to say in a->said.
static bool start_run(struct ct_accuracy *a, const struct setting *s)
{
    struct ct_sim_options o = a->o->run;
    o.method = s->method;
    o.tolerance = s->tolerance;
    o.absolute = 0;
    o.step = s->step;
    a->said.ndiagnostic = a->said.nerror = 0;
    a->sim = ct_sim_create(&a->said, a->system, &o);
    if (!a->sim)
        return false;
    a->sim->run_options.step = s->step; // not the one of the model
    if (s->rtol > 0) {
        a->sim->run_options.rtol = s->rtol;
        a->sim->run_options.atol = s->rtol / 100;
    }
    return true;
}

static enum ending run_once(struct ct_accuracy *a, const struct setting *s, double limit,
                            bool (*row)(void *, double, const double *, size_t),
                            struct ct_precision_point *p)
{
    *p = (struct ct_precision_point){.method = s->method,
                                     .elements = a->variant ? a->variant->elements : 0,
                                     .formulation = a->variant ? a->variant->formulation : NULL,
                                     .tolerance = s->step > 0 ? s->step : s->tolerance,
                                     .has_step = s->step > 0,
                                     .error = NAN};
    enum ending ending = FAILED;
    if (start_run(a, s)) {
        a->nrow = 0;
        a->worst = 0;
        a->sim->deadline = ct_clock() + limit;
        const struct ct_sim_results results = {.row = row, .user = a};
        if (ct_sim_run(&a->said, a->sim, &results))
            ending = a->sim->is_late ? LATE : DONE;
        p->seconds = a->sim->integrate;
        p->steps = a->sim->report.stats.steps;
        p->evaluations = a->sim->report.stats.evaluations;
    } else if (ct_ctx_fault(&a->said) == CT_FAULT_OPTION) {
        ending = REFUSED;
    }
    end_run(a);
    return ending;
}

// ---- the reference: runs that agree --------------------------------------------------------------------

struct candidate {
    const char *method;
    double rtol;
    double *row; // nsample x nresult; NULL: did not come to its end
};

// Largest |y - x| / max |x| over the columns that are more than rounding; scale (nresult, out): max |x|,
// 0 for those that are not.
static double compare_runs(const struct ct_accuracy *a, const double *x, const double *y,
                           double *scale)
{
    const size_t n = a->nresult;
    double *deviation = a->deviation, largest = 0, worst = 0;
    for (size_t i = 0; i < n; i++) {
        scale[i] = deviation[i] = 0;
        for (size_t k = 0; k < a->nsample; k++) {
            if (isnan(x[k * n + i]))
                continue;
            scale[i] = fmax(scale[i], fabs(x[k * n + i]));
            deviation[i] = fmax(deviation[i], fabs(y[k * n + i] - x[k * n + i]));
        }
        largest = fmax(largest, scale[i]);
    }
    for (size_t i = 0; i < n; i++) {
        if (ct_is_rounding(scale[i], deviation[i], largest))
            scale[i] = 0;
        else
            worst = fmax(worst, deviation[i] / scale[i]);
    }
    return worst;
}

static bool run_candidate(struct ct_accuracy *a, struct candidate *c)
{
    struct ct_precision_point p;
    const struct setting s = {.method = c->method, .tolerance = 1, .rtol = c->rtol};
    a->store = CT_NEWN(a->own.model, double, a->nsample * a->nresult + 1);
    const enum ending ending = run_once(a, &s, reference_limit, keep_row, &p);
    if (ending == DONE) {
        c->row = a->store;
        a->reference_seconds = fmax(a->reference_seconds, p.seconds);
    } else {
        ct_ctx_hand_over(&a->own, &a->said); // forgotten if another one does better
    }
    return ending != REFUSED;
}

// The pair of runs that are nearest to each other; the first of them is the reference.
static void choose_pair(struct ct_accuracy *a, const struct candidate *c, int n)
{
    double *scale = CT_NEWN(a->own.model, double, a->nresult + 1);
    for (int i = 0; i < n; i++)
        for (int j = i + 1; j < n; j++) {
            if (!c[i].row || !c[j].row)
                continue;
            const double distance = compare_runs(a, c[i].row, c[j].row, scale);
            if (distance >= a->uncertainty)
                continue;
            a->uncertainty = distance;
            a->reference = c[i].row;
            memcpy(a->scale, scale, a->nresult * sizeof *scale);
            const bool is_other = strcmp(c[i].method, c[j].method) != 0;
            a->source
                = ct_arena_printf(a->own.model, "%s, checked with %s", c[i].method,
                                  is_other ? c[j].method : "itself at another tolerance alone");
        }
}

// No two came to their end: one alone must do.
static void choose_single(struct ct_accuracy *a, const struct candidate *c, int n)
{
    for (int i = 0; i < n && !a->reference; i++)
        if (c[i].row) {
            a->reference = c[i].row;
            compare_runs(a, a->reference, a->reference, a->scale);
            a->source = ct_arena_printf(
                a->own.model, "%s alone: no other method came to its end", c[i].method);
        }
}

// ---- the reference in quadruple precision --------------------------------------------------------------

static bool is_in_time(void *user)
{
    const double *end = user;
    return ct_clock() < *end;
}

// Two runs with different steps; the first is the reference if they agree better than runs in double precision do, and
// with those as well as they among each other.
static void run_quad(struct ct_accuracy *a)
{
    const double tolerance[2] = {1e-26, 1e-22};
    const double as_runs_agree = 100; // times the distance of runs in double precision
    const double double_rounding = 1e-15;
    double *row[2], *scale = CT_NEWN(a->own.model, double, a->nresult + 1);
    struct ct_sim_options o = a->o->run;
    o.method = "dop853";
    a->said.ndiagnostic = a->said.nerror = 0;
    a->sim = ct_sim_create(&a->said, a->system, &o);
    bool ok = a->sim && ct_quad_can_run(ct_run_machine(a->sim->run));
    double end = ct_clock() + quad_limit;
    for (int i = 0; i < 2 && ok; i++) {
        row[i] = CT_NEWN(a->own.model, double, a->nsample * a->nresult + 1);
        ok = ct_quad_run(a->own.model, ct_run_machine(a->sim->run), ct_run_state(a->sim->run),
                         a->duration, a->nsample, tolerance[i], is_in_time, &end, row[i]);
    }
    end_run(a);
    if (!ok)
        return;
    const double own = compare_runs(a, row[0], row[1], scale);
    if (own > a->uncertainty)
        return;
    const double distance = compare_runs(a, row[0], a->reference, scale);
    if (distance > as_runs_agree * (a->uncertainty + double_rounding))
        return;
    a->reference = row[0];
    memcpy(a->scale, scale, a->nresult * sizeof *scale);
    a->source = ct_arena_printf(a->own.model,
                                "quadruple precision (from %s it differs by %.2g), checked "
                                "with another tolerance",
                                a->source, distance);
    a->uncertainty = fmax(own, double_rounding);
}

static bool find_reference(struct ct_accuracy *a)
{
    // None is a setting of the table. Loops lose digits below 1e-13; the last
    // one is for mechanisms that no second method gets through.
    struct candidate open[NREFERENCE] = {{"dop853", 2e-14, NULL},
                                         {"dopri5", 7e-14, NULL},
                                         {"radau5", 5e-13, NULL},
                                         {"dop853", 3e-13, NULL}};
    struct candidate loops[NREFERENCE] = {{"dop853", 3e-13, NULL},
                                          {"dopri5", 3e-13, NULL},
                                          {"radau5", 5e-13, NULL},
                                          {"dop853", 1.5e-12, NULL}};
    struct candidate *c = a->system->equations.nrow ? loops : open;
    a->uncertainty = INFINITY;
    for (int i = 0; i < NREFERENCE; i++) {
        if (i > 1 && a->uncertainty <= (i < NREFERENCE - 1 ? good_agreement : DBL_MAX))
            continue;
        if (!run_candidate(a, &c[i]))
            return false;
        choose_pair(a, c, i + 1);
    }
    if (!a->reference)
        choose_single(a, c, NREFERENCE);
    if (!a->reference)
        return ct_error(
            &a->own, (struct ct_mark){0}, CT_E_REFERENCE,
            "no reference: neither %s, %s nor %s comes to its end at a tight "
            "tolerance within %g s; give one with --reference, or an earlier --until",
            c[0].method, c[1].method, c[2].method, reference_limit);
    a->own.ndiagnostic = a->own.nerror = 0;
    if (isinf(a->uncertainty))
        a->uncertainty = NAN;
    else
        run_quad(a);
    return true;
}

// ---- the reference: a file ------------------------------------------------------------------------------

static bool read_sheet(struct ct_accuracy *a, const char *path, struct ct_sheet *sheet)
{
    const size_t max_bytes = (size_t)1 << 30;
    char *text;
    size_t n;
    switch (ct_text_read(a->own.scratch, path, max_bytes, &text, &n)) {
    case CT_TEXT_UNREADABLE:
        return ct_error(&a->own, (struct ct_mark){0}, CT_E_TABLE,
                        "cannot read the reference '%s': %s", path, strerror(errno));
    case CT_TEXT_TOO_BIG:
        return ct_error(&a->own, (struct ct_mark){0}, CT_E_TABLE,
                        "the reference '%s' is larger than %zu MiB", path, max_bytes >> 20);
    case CT_TEXT_OK:
        break;
    }
    return ct_sheet_parse(&a->own, a->own.scratch, path, text, n, sheet);
}

static bool read_field(struct ct_accuracy *a, const struct ct_sheet *sheet, size_t k, double *v)
{
    const char *text = sheet->field[k];
    const double sign = *text == '-' ? -1 : 1;
    const char *digits = text + (*text == '-' || *text == '+');
    const size_t n = ct_number_parse(digits, v);
    *v *= sign;
    return (n && !digits[n] && isfinite(*v))
        || ct_error(&a->own, sheet->mark[k], CT_E_TABLE_DATA, "'%s' is not a finite number",
                    text);
}

// The column of that name, or ncolumn.
static size_t find_column(const struct ct_sheet *sheet, const char *name)
{
    size_t c = 0;
    while (c < sheet->ncolumn && strcmp(sheet->field[c], name) != 0)
        c++;
    return c;
}

// of (nresult, out): where results stand in the file.
static bool find_columns(struct ct_accuracy *a, const struct ct_sheet *sheet, size_t *time,
                         size_t *of)
{
    size_t found = 0;
    *time = sheet->nrow ? find_column(sheet, "t") : 0;
    for (size_t i = 0; sheet->nrow && i < a->nresult; i++) {
        of[i] = find_column(sheet, a->system->equations.result[i].name);
        found += of[i] < sheet->ncolumn;
    }
    const struct ct_mark mark = {.file = sheet->file};
    if (!sheet->nrow || *time == sheet->ncolumn)
        return ct_error(&a->own, mark, CT_E_TABLE, "the reference has no column 't'");
    if (!found)
        return ct_error(&a->own, mark, CT_E_TABLE,
                        "the reference has no column that the model has; it should have '%s'%s",
                        a->nresult ? a->system->equations.result[0].name : "",
                        a->nresult > 1 ? " or another output" : "");
    return true;
}

// The sample at time t, or nsample.
static size_t find_sample(const struct ct_accuracy *a, double t)
{
    if (a->nsample < 2 || !(a->duration > 0))
        return fabs(t) <= same_time * a->duration ? 0 : a->nsample;
    const double k = round(t / a->duration * (double)(a->nsample - 1));
    if (!(k >= 0 && k < (double)a->nsample))
        return a->nsample;
    const double at = a->duration * k / (double)(a->nsample - 1);
    return fabs(t - at) <= same_time * a->duration ? (size_t)k : a->nsample;
}

static bool fill_reference(struct ct_accuracy *a, const struct ct_sheet *sheet, size_t time,
                           const size_t *of)
{
    const size_t n = a->nresult;
    size_t matched = 0;
    for (size_t r = 1; r < sheet->nrow; r++) {
        double t;
        if (!read_field(a, sheet, r * sheet->ncolumn + time, &t))
            return false;
        const size_t k = find_sample(a, t);
        if (k == a->nsample)
            continue;
        matched++;
        for (size_t i = 0; i < n; i++)
            if (of[i] < sheet->ncolumn
                && !read_field(a, sheet, r * sheet->ncolumn + of[i], &a->reference[k * n + i]))
                return false;
    }
    a->source = ct_arena_printf(a->own.model, "%s, at %zu of %zu samples", sheet->file, matched,
                                a->nsample);
    return matched
        || ct_error(&a->own, (struct ct_mark){.file = sheet->file}, CT_E_TABLE_DATA,
                    "the reference has no row at the time of a sample");
}

static bool read_reference(struct ct_accuracy *a, const char *path)
{
    struct ct_sheet sheet = {0};
    size_t time, *of = CT_NEWN(a->own.scratch, size_t, a->nresult + 1);
    if (!read_sheet(a, path, &sheet) || !find_columns(a, &sheet, &time, of))
        return false;
    a->reference = CT_NEWN(a->own.model, double, a->nsample * a->nresult + 1);
    for (size_t i = 0; i < a->nsample * a->nresult; i++)
        a->reference[i] = NAN;
    if (!fill_reference(a, &sheet, time, of))
        return false;
    compare_runs(a, a->reference, a->reference, a->scale);
    a->uncertainty = NAN;
    return true;
}

// ---- ladders ---------------------------------------------------------------------------------------------

static double median(const double *v, int n)
{
    if (n < 3)
        return n == 2 ? fmin(v[0], v[1]) : v[0];
    return fmax(fmin(v[0], v[1]), fmin(fmax(v[0], v[1]), v[2]));
}

// One setting, several times while the time lasts.
static enum ending measure(struct ct_accuracy *a, const struct setting *s, double end)
{
    struct ct_precision_point p, again;
    double seconds[MOST_REPEATS], sum;
    int n = 1;
    const enum ending ending = run_once(a, s, end - ct_clock(), compare_row, &p);
    if (ending == REFUSED)
        return ending;
    if (ending == DONE)
        p.error = a->worst;
    seconds[0] = sum = p.seconds;
    while (ending == DONE && n < (sum < short_times ? MOST_REPEATS : REPEATS)
           && ct_clock() + p.seconds < end
           && run_once(a, s, INFINITY, compare_row, &again) == DONE)
        sum += seconds[n++] = again.seconds;
    p.seconds = round(median(seconds, n) * 1e9) / 1e9; // what the clock resolves
    CT_PUSH(a->own.model, a->point, a->npoint, a->point_cap, p);
    return ending;
}

// Powers of ten from loose to tight.
static void choose_powers(const struct ct_method *m, int *first, int *last)
{
    *first = m->is_implicit && m->order < 3 ? 2 : 4;
    *last = !m->is_implicit ? 11 : m->order < 3 ? 7 : 9;
}

// Of the ladder that begins at point[start]: tighter tolerances do not change the error of a beam any more, it is that of its
// elements or formulation.
static bool shows_mesh(const struct ct_accuracy *a, size_t start)
{
    enum { SETTINGS = 3 };
    if (!a->variant || a->npoint < start + SETTINGS)
        return false;
    const struct ct_precision_point *last = &a->point[a->npoint - 1];
    bool is_same = true;
    for (int i = 1; i < SETTINGS; i++)
        is_same = is_same && fabs(last[-i].error - last->error) <= same_error * last->error;
    return is_same;
}

static bool climb_tolerances(struct ct_accuracy *a, const struct ct_method *m, double end)
{
    static const double power[]
        = {1, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11};
    int first, last;
    choose_powers(m, &first, &last);
    struct setting s = {.method = m->name, .tolerance = a->o->run.tolerance};
    enum ending ending = DONE;
    if (s.tolerance > 0)
        return measure(a, &s, end) != REFUSED;
    const size_t start = a->npoint;
    for (int k = first;
         k <= last && (ending == DONE || ending == FAILED) && !shows_mesh(a, start); k++) {
        s.tolerance = power[k];
        ending = measure(a, &s, end);
    }
    return ending != REFUSED;
}

// Ten digits of v: 1e-4, not 9.9999999999999991e-05.
static double readable(double v)
{
    char text[CT_PRECISION_NUMBER_SIZE];
    snprintf(text, sizeof text, "%.10g", v);
    return strtod(text, NULL);
}

// Steps end on samples, so longer ones than their spacing make no difference.
static bool climb_steps(struct ct_accuracy *a, const struct ct_method *m, double end)
{
    const double spacing = a->duration / fmax(1, (double)a->nsample - 1);
    struct setting s = {.method = m->name, .step = a->o->run.step};
    enum ending ending = DONE;
    if (s.step > 0)
        return measure(a, &s, end) != REFUSED;
    s.step = readable(fmin(spacing, a->duration / least_fixed_steps));
    for (int k = 0; k < most_steps_of_ladder && (ending == DONE || ending == FAILED); k++) {
        ending = measure(a, &s, end);
        s.step /= 2;
    }
    return ending != REFUSED;
}

static bool climb(struct ct_accuracy *a, const struct ct_method *m)
{
    const double end
        = ct_clock() + fmax(share_of_method, share_of_reference * a->reference_seconds);
    const bool is_fixed = strcmp(m->name, "rk4") == 0;
    return (is_fixed ? climb_steps : climb_tolerances)(a, m, end)
        || (ct_ctx_hand_over(&a->own, &a->said), false);
}

// method (ct_nmethod, out): those asked for, once each, in the order of the table of methods.
static bool choose_methods(struct ct_accuracy *a, const char *text,
                           const struct ct_method **method, int *n)
{
    static const char usual[] = "dopri5,dop853,rk4,radau5,generalized-alpha";
    if (!text || strcmp(text, "auto") == 0)
        text = usual;
    const char **names = CT_NEWN(a->own.scratch, const char *, ct_nmethod + 1);
    bool *is_wanted = CT_NEWN(a->own.scratch, bool, ct_nmethod + 1), ok = true;
    for (int i = 0; i < ct_nmethod; i++)
        names[i] = ct_methods[i]->name;
    for (const char *next; text; text = next) {
        const size_t length = strcspn(text, ",");
        next = text[length] ? text + length + 1 : NULL;
        const char *name = ct_arena_strndup(a->own.scratch, text, length);
        int i = 0;
        while (i < ct_nmethod && strcmp(names[i], name) != 0)
            i++;
        if (i == ct_nmethod)
            ok = ct_error(&a->own, (struct ct_mark){0}, CT_E_USAGE,
                          "this version has no method '%s'%s", name,
                          ct_suggest_or_list(a->own.scratch, name, names, (size_t)ct_nmethod));
        is_wanted[i] = true;
    }
    *n = 0;
    for (int i = 0; i < ct_nmethod; i++)
        if (is_wanted[i])
            method[(*n)++] = ct_methods[i];
    return ok;
}

// ---- the whole -------------------------------------------------------------------------------------------

static void choose_best(struct ct_accuracy *a)
{
    if (a->uncertainty > a->wanted)
        return; // an error that small cannot be seen
    for (size_t i = 0; i < a->npoint; i++)
        if (a->point[i].error <= a->wanted
            && (!a->best || a->point[i].seconds < a->best->seconds))
            a->best = &a->point[i];
}

// The model as simulate would run it says what is wrong with the options, and how many samples there are.
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
    end_run(a);
    if (ok && !m->has_duration && !(a->duration > 0))
        return ct_error(&a->own, m->mark, CT_E_KEY_MISSING,
                        "there is no end time: 'simulation' needs a 'duration'");
    a->nresult = a->system->equations.nresult;
    a->scale = CT_NEWN(a->own.model, double, a->nresult + 1);
    a->deviation = CT_NEWN(a->own.model, double, a->nresult + 1);
    return ok;
}

static bool study(struct ct_accuracy *a)
{
    const struct ct_method **method
        = CT_NEWN(a->own.model, const struct ct_method *, ct_nmethod);
    int n;
    if (!choose_methods(a, a->o->run.method, method, &n) || !learn_sizes(a))
        return false;
    if (a->o->reference ? !read_reference(a, a->o->reference) : !find_reference(a))
        return false;
    const size_t nvariant = a->o->variant ? a->o->nvariant : 1;
    const double all = (double)nvariant * n;
    for (size_t v = 0; v < nvariant; v++) {
        if (a->o->variant) {
            a->variant = &a->o->variant[v];
            a->system = a->variant->system;
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
    else if (a->uncertainty > reference_margin * a->wanted)
        ct_warning(&a->own, (struct ct_mark){0}, CT_E_REFERENCE,
                   "the reference (%s) is known to %.2g only: smaller errors mean nothing",
                   a->source, a->uncertainty);
    choose_best(a);
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
    if (a->o->progress) {
        ct_progress_init(&a->progress, a->o->progress, "accuracy");
        ct_progress_update(&a->progress, 0);
    }
    const bool ok
        = (a->wanted > 0 && isfinite(a->wanted))
            ? study(a)
            : ct_error(&a->own, (struct ct_mark){0}, CT_E_USAGE,
                       "the wanted error is %g; it must be greater than 0", a->wanted);
    ct_progress_finish(&a->progress);
    ct_ctx_hand_over(c->ctx, &a->own);
    return ok;
}

struct ct_accuracy *ct_accuracy_create(struct ct_ctx *ctx, struct ct_system *sys,
                                       const struct ct_accuracy_options *options)
{
    static const struct ct_accuracy_options standard;
    if (!sys)
        return NULL;
    struct create c = {ctx, calloc(1, sizeof *c.a)};
    if (!c.a) {
        ctx->no_memory = true;
        return NULL;
    }
    c.a->system = sys;
    c.a->o = options ? options : &standard;
    c.a->wanted = c.a->o->error != 0 ? c.a->o->error : standard_error;
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

// ---- what it says ------------------------------------------------------------------------------------------

struct output {
    struct ct_ctx *ctx;
    const struct ct_accuracy *a;
    const char *path;
};

static bool write_table(void *task)
{
    const struct output *o = task;
    return ct_precision_write(o->ctx, o->path, o->a->point, o->a->npoint);
}

bool ct_accuracy_write(struct ct_ctx *ctx, const struct ct_accuracy *a, const char *path)
{
    struct output o = {ctx, a, path};
    return a && ct_enter(ctx, write_table, &o);
}

static bool draw_plot(void *task)
{
    const struct output *o = task;
    const struct ct_accuracy *a = o->a;
    const struct ct_precision_plot plot = {.title = a->system->model.name,
                                           .wanted = a->wanted,
                                           .uncertainty = a->uncertainty,
                                           .best = a->best};
    return ct_precision_draw(o->ctx, o->path, a->point, a->npoint, &plot);
}

bool ct_accuracy_draw(struct ct_ctx *ctx, const struct ct_accuracy *a, const char *path)
{
    struct output o = {ctx, a, path};
    return a && ct_enter(ctx, draw_plot, &o);
}

static void print_setting(const struct ct_precision_point *p, FILE *out)
{
    char text[CT_PRECISION_NUMBER_SIZE];
    char name[80];
    ct_precision_name(name, sizeof name, p);
    fprintf(out, "method %s, %s %s: error %.2g in %.3g s\n", name,
            p->has_step ? "step" : "tolerance", ct_precision_number(text, p->tolerance),
            p->error, p->seconds);
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
        fputs(": not in the reference, or zero but for rounding\n", out);
}

// The cheapest of those with the least error; NULL if all failed.
static const struct ct_precision_point *find_nearest(const struct ct_accuracy *a)
{
    const struct ct_precision_point *nearest = NULL;
    double least = INFINITY;
    for (size_t i = 0; i < a->npoint; i++)
        least = fmin(least, a->point[i].error);
    for (size_t i = 0; i < a->npoint; i++)
        if (a->point[i].error <= (1 + same_error) * least
            && (!nearest || a->point[i].seconds < nearest->seconds))
            nearest = &a->point[i];
    return nearest;
}

void ct_accuracy_print_summary(const struct ct_accuracy *a, FILE *out)
{
    char wanted[CT_PRECISION_NUMBER_SIZE];
    const struct ct_precision_point *nearest = find_nearest(a);
    fprintf(out, "reference     %s", a->source);
    if (!isnan(a->uncertainty))
        fprintf(out, ": they differ by %.2g", a->uncertainty);
    fputc('\n', out);
    print_left_out(a, out);
    ct_precision_number(wanted, a->wanted);
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
