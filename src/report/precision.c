// Tables of work and precision; see precision.h.
#include "report/precision.h"

#include "report/csv.h"
#include "report/json.h"
#include "report/number.h"

#include <stdio.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

bool ct_precision_is_alike(const struct ct_precision_point *p,
                           const struct ct_precision_point *q)
{
    const bool same = !p->formulation == !q->formulation
                   && (!p->formulation || strcmp(p->formulation, q->formulation) == 0);
    return same && p->elements == q->elements && strcmp(p->method, q->method) == 0;
}

void ct_precision_name(char *text, size_t size, const struct ct_precision_point *p)
{
    int n = snprintf(text, size, "%s", p->method);
    if (p->elements > 0)
        n += snprintf(text + n, size - (size_t)n, ", N = %ld", p->elements);
    if (p->formulation)
        snprintf(text + n, size - (size_t)n, ", %s", p->formulation);
}

const char *ct_precision_number(char text[CT_PRECISION_NUMBER_SIZE], double v)
{
    for (int digits = 1; digits < 17; digits++) {
        snprintf(text, CT_PRECISION_NUMBER_SIZE, "%.*g", digits, v);
        if (strtod(text, NULL) == v && strspn(text, "+-.0123456789e") == strlen(text))
            return text;
    }
    return ct_number_format(text, v); // what is not finite, and locales with another point
}

static void write_number(struct ct_csv *w, double v)
{
    char text[CT_PRECISION_NUMBER_SIZE];
    ct_csv_text(w, isnan(v) ? "" : ct_precision_number(text, v));
}

static void write_count(struct ct_csv *w, long v)
{
    char text[CT_PRECISION_NUMBER_SIZE];
    snprintf(text, sizeof text, "%ld", v);
    ct_csv_text(w, text);
}

static bool write_csv(struct ct_ctx *ctx, const char *path,
                      const struct ct_precision_point *point, size_t n)
{
    static const char *const column[] = {"method", "tolerance", "elements", "formulation",
                                         "error",  "seconds",   "steps",    "evaluations"};
    struct ct_csv w;
    if (!ct_csv_open(ctx, &w, path, column, COUNT(column)))
        return false;
    for (size_t i = 0; i < n; i++) {
        ct_csv_text(&w, point[i].method);
        write_number(&w, point[i].tolerance);
        if (point[i].elements > 0)
            write_count(&w, point[i].elements);
        else
            ct_csv_text(&w, "");
        ct_csv_text(&w, point[i].formulation ? point[i].formulation : "");
        write_number(&w, point[i].error);
        write_number(&w, point[i].seconds);
        write_count(&w, point[i].steps);
        write_count(&w, point[i].evaluations);
        if (!ct_csv_end_row(ctx, &w)) {
            ct_csv_abandon(&w);
            return false;
        }
    }
    return ct_csv_close(ctx, &w);
}

static bool write_json(struct ct_ctx *ctx, const char *path,
                       const struct ct_precision_point *point, size_t n)
{
    struct ct_outfile file;
    if (!ct_outfile_open(ctx, &file, path))
        return false;
    double *column = CT_NEWN(ctx->model, double, 5 * n + 1);
    for (size_t i = 0; i < n; i++) {
        column[i] = point[i].tolerance;
        column[n + i] = point[i].error;
        column[2 * n + i] = point[i].seconds;
        column[3 * n + i] = (double)point[i].steps;
        column[4 * n + i] = (double)point[i].evaluations;
    }
    static const char *const rest[] = {"error", "seconds", "steps", "evaluations"};
    struct ct_json j;
    ct_json_init(&j, file.stream);
    ct_json_object(&j, NULL);
    ct_json_array(&j, "method");
    for (size_t i = 0; i < n; i++)
        ct_json_text(&j, NULL, point[i].method);
    ct_json_end(&j);
    ct_json_numbers(&j, "tolerance", column, n);
    ct_json_array(&j, "elements");
    for (size_t i = 0; i < n; i++)
        ct_json_number(&j, NULL, point[i].elements > 0 ? (double)point[i].elements : NAN);
    ct_json_end(&j);
    ct_json_array(&j, "formulation");
    for (size_t i = 0; i < n; i++)
        ct_json_text(&j, NULL, point[i].formulation);
    ct_json_end(&j);
    for (size_t k = 0; k < COUNT(rest); k++)
        ct_json_numbers(&j, rest[k], column + (k + 1) * n, n);
    ct_json_end(&j);
    return ct_outfile_close(ctx, &file);
}

bool ct_precision_write(struct ct_ctx *ctx, const char *path,
                        const struct ct_precision_point *point, size_t n)
{
    const char *dot = path ? strrchr(path, '.') : NULL;
    if (dot && strcmp(dot, ".json") == 0)
        return write_json(ctx, path, point, n);
    return write_csv(ctx, path && strcmp(path, "-") != 0 ? path : NULL, point, n);
}
