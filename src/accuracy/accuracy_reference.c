// Reference of a work-precision study: runs with tight tolerances of different methods that agree,
// runs in quadruple precision, or a file.
#include "accuracy/accuracy.h"

#include "expr/unit.h"
#include "io/sheet.h"
#include "io/text.h"
#include "solve/run/quad_run.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <string.h>

// Sample times in a file are matched to this part of the run. Derived: files with nine digits.
static const double same_time = 1e-9;
static const double reference_limit = 20, quad_limit = 10; // Limit: [s]
enum { NREFERENCE = 4 };                                   // Definition: of the lists below

// ---- runs that agree --------------------------------------------------------------------

struct candidate {
    const char *method;
    double rtol;
    double *row;    // nsample x nresult; NULL: the run did not finish
    double seconds; // duration of the run; INFINITY: stopped by its time limit
};

static bool keep_row(void *user, double t, const double *value, size_t n)
{
    struct ct_accuracy *a = user;
    (void)t;
    memcpy(a->store + a->nrow++ * n, value, n * sizeof *value);
    return true;
}

static bool run_candidate(struct ct_accuracy *a, struct candidate *c)
{
    struct ct_work_precision_point p;
    const struct ct_setting s = {.method = c->method, .tolerance = 1, .rtol = c->rtol};
    a->store = CT_NEWN(a->own.model, double, a->nsample * a->nresult + 1);
    const enum ct_ending ending = ct_accuracy_run(a, &s, reference_limit, keep_row, &p);
    c->seconds = ending == CT_RUN_LATE ? INFINITY : p.seconds;
    if (ending == CT_RUN_DONE) {
        c->row = a->store;
        a->reference_seconds = fmax(a->reference_seconds, p.seconds);
    } else {
        ct_ctx_hand_over(&a->own, &a->said); // discarded if another run is better
    }
    return ending != CT_RUN_REFUSED;
}

// Choose the pair of runs with the least distance; the first of them is the reference.
static void choose_pair(struct ct_accuracy *a, const struct candidate *c, int n)
{
    double *scale = CT_NEWN(a->own.model, double, a->nresult + 1);
    for (int i = 0; i < n; i++)
        for (int j = i + 1; j < n; j++) {
            if (!c[i].row || !c[j].row)
                continue;
            const double distance = ct_accuracy_compare(a, c[i].row, c[j].row, scale);
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

// Fewer than two runs finished: take that one. Its accuracy is unknown.
static void choose_single(struct ct_accuracy *a, const struct candidate *c, int n)
{
    for (int i = 0; i < n && !a->reference; i++)
        if (c[i].row) {
            a->reference = c[i].row;
            ct_accuracy_compare(a, a->reference, a->reference, a->scale);
            a->source = ct_arena_printf(
                a->own.model, "%s alone: no other method came to its end", c[i].method);
        }
}
// ---- in quadruple precision --------------------------------------------------------------

// Time of an evaluation in quadruple precision, over that in double precision. Limit: of the time
// of a study; a run that takes longer is given up in any case (is_in_time).
static const double quad_slowdown = 50;

// Is there time for two runs in quadruple precision, with at least as many steps?
static bool has_time(const struct candidate *c)
{
    return 2 * quad_slowdown * c->seconds < quad_limit;
}

static bool is_in_time(void *user)
{
    const double *end = user;
    return ct_monotonic_time() < *end;
}

// Two runs in quadruple precision with different steps. The first becomes the reference if they
// agree better than the runs in double precision do, and if it is the same motion: as close to
// those as the wanted error, or as those are to each other.
static void run_quad(struct ct_accuracy *a)
{
    // Derived: the error of double precision is above 1e-16; both are far below it, and four digits
    // apart
    const double tolerance[2] = {1e-26, 1e-22};
    // Derived: 4 units of round-off of stored results, 4 * 2.2e-16
    const double double_rounding = 1e-15;
    double *row[2], *scale = CT_NEWN(a->own.model, double, a->nresult + 1);
    struct ct_sim_options o = a->o->run;
    o.method = "dop853";
    a->said.ndiagnostic = a->said.nerror = 0;
    a->sim = ct_sim_create(&a->said, a->system, &o);
    bool ok = a->sim && ct_quad_can_run(ct_run_evaluator(a->sim->run));
    double end = ct_monotonic_time() + quad_limit;
    for (int i = 0; i < 2 && ok; i++) {
        row[i] = CT_NEWN(a->own.model, double, a->nsample * a->nresult + 1);
        ok = ct_quad_run(a->own.model, ct_run_evaluator(a->sim->run), ct_run_state(a->sim->run),
                         a->duration, a->nsample, tolerance[i], is_in_time, &end, row[i]);
    }
    ct_accuracy_end_run(a);
    if (!ok)
        return;
    const double own = ct_accuracy_compare(a, row[0], row[1], scale);
    if (own > a->uncertainty)
        return;
    const double distance = ct_accuracy_compare(a, row[0], a->reference, scale);
    if (distance > fmax(a->uncertainty, a->wanted))
        return;
    a->reference = row[0];
    memcpy(a->scale, scale, a->nresult * sizeof *scale);
    a->source = ct_arena_printf(a->own.model,
                                "quadruple precision (from %s it differs by %.2g), checked "
                                "with another tolerance",
                                a->source, distance);
    a->uncertainty = fmax(own, double_rounding);
}

bool ct_accuracy_find_reference(struct ct_accuracy *a)
{
    // Definition: settings that differ from those of the table. Loops lose digits below 1e-13; the
    // last setting is for mechanisms that only one method can integrate.
    struct candidate open[NREFERENCE] = {{.method = "dop853", .rtol = 2e-14},
                                         {.method = "dopri5", .rtol = 7e-14},
                                         {.method = "radau5", .rtol = 5e-13},
                                         {.method = "dop853", .rtol = 3e-13}};
    // Definition: the same with loops
    struct candidate loops[NREFERENCE] = {{.method = "dop853", .rtol = 3e-13},
                                          {.method = "dopri5", .rtol = 3e-13},
                                          {.method = "radau5", .rtol = 5e-13},
                                          {.method = "dop853", .rtol = 1.5e-12}};
    struct candidate *c = a->system->equations.nrow ? loops : open;
    a->uncertainty = INFINITY;
    for (int i = 0; i < NREFERENCE; i++) {
        if (i > 1
            && a->uncertainty
                   <= (i < NREFERENCE - 1 ? CT_REFERENCE_MARGIN * a->wanted : DBL_MAX))
            continue;
        if (i == NREFERENCE - 1 && !c[0].row) // stiff system
            // Definition: the last of the list
            c[i] = (struct candidate){.method = "radau5", .rtol = 1e-11};
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
    else if (has_time(&c[0]))
        run_quad(a);
    return true;
}
// ---- a file ------------------------------------------------------------------------------

static bool read_sheet(struct ct_accuracy *a, const char *path, struct ct_sheet *sheet)
{
    // Limit: with a message
    const size_t max_bytes = (size_t)1 << 30;
    char *text;
    size_t n;
    switch (ct_text_read_regular(a->own.scratch, path, max_bytes, &text, &n)) {
    case CT_TEXT_UNREADABLE:
        return ct_error(&a->own, (struct ct_mark){0}, CT_E_TABLE,
                        "cannot read the reference '%s': %s", path, strerror(errno));
    case CT_TEXT_TOO_BIG:
        return ct_error(&a->own, (struct ct_mark){0}, CT_E_TABLE,
                        "the reference '%s' is larger than %zu MiB", path, max_bytes >> 20);
    case CT_TEXT_ENDLESS:
        return ct_error(&a->own, (struct ct_mark){0}, CT_E_TABLE,
                        "the reference '%s' is no regular file", path);
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
        || ct_error(&a->own, sheet->mark[k], CT_E_TABLE_DATA, "'%.60s' is not a finite number",
                    text);
}

// Index of the column of that name, or ncolumn.
static size_t find_column(const struct ct_sheet *sheet, const char *name)
{
    size_t c = 0;
    while (c < sheet->ncolumn && strcmp(sheet->field[c], name) != 0)
        c++;
    return c;
}

// of (nresult, out): column of each result in the file.
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

// Index of the sample at time t, or nsample.
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

// largest (nresult, in and out): largest value of each column, at sample times and others.
static bool fill_reference(struct ct_accuracy *a, const struct ct_sheet *sheet, size_t time,
                           const size_t *of, double *largest)
{
    const size_t n = a->nresult;
    size_t matched = 0;
    for (size_t r = 1; r < sheet->nrow; r++) {
        double t;
        if (!read_field(a, sheet, r * sheet->ncolumn + time, &t))
            return false;
        const size_t k = find_sample(a, t);
        matched += k < a->nsample;
        for (size_t i = 0; i < n; i++) {
            double v;
            if (of[i] >= sheet->ncolumn)
                continue;
            if (!read_field(a, sheet, r * sheet->ncolumn + of[i], &v))
                return false;
            largest[i] = fmax(largest[i], fabs(v));
            if (k < a->nsample)
                a->reference[k * n + i] = v;
        }
    }
    a->source = ct_arena_printf(a->own.model, "%s, at %zu of %zu samples", sheet->file, matched,
                                a->nsample);
    return matched
        || ct_error(&a->own, (struct ct_mark){.file = sheet->file, .is_table = true},
                    CT_E_TABLE_DATA, "the reference has no row at the time of a sample");
}

bool ct_accuracy_read_reference(struct ct_accuracy *a, const char *path)
{
    struct ct_sheet sheet = {0};
    size_t time, *of = CT_NEWN(a->own.scratch, size_t, a->nresult + 1);
    if (!read_sheet(a, path, &sheet) || !find_columns(a, &sheet, &time, of))
        return false;
    a->reference = CT_NEWN(a->own.model, double, a->nsample * a->nresult + 1);
    for (size_t i = 0; i < a->nsample * a->nresult; i++)
        a->reference[i] = NAN;
    double *largest = CT_NEWN(a->own.scratch, double, a->nresult + 1);
    if (!fill_reference(a, &sheet, time, of, largest))
        return false;
    ct_accuracy_compare(a, a->reference, a->reference, a->scale);
    for (size_t i = 0; i < a->nresult; i++) // columns of round-off size are still left out
        a->scale[i] = a->scale[i] > 0 ? fmax(a->scale[i], largest[i]) : 0;
    a->uncertainty = NAN;
    return true;
}
