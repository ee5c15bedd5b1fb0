// Tables of work and precision; see work_precision.h.
#include "report/work_precision.h"

#include "report/columns.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

bool ct_work_precision_is_alike(const struct ct_work_precision_point *p,
                                const struct ct_work_precision_point *q)
{
    const bool same = !p->formulation == !q->formulation
                   && (!p->formulation || strcmp(p->formulation, q->formulation) == 0);
    return same && p->elements == q->elements && strcmp(p->method, q->method) == 0;
}

void ct_work_precision_name(char *text, size_t size, const struct ct_work_precision_point *p)
{
    int n = snprintf(text, size, "%s", p->method);
    if (p->elements > 0)
        n += snprintf(text + n, size - (size_t)n, ", N = %ld", p->elements);
    if (p->formulation)
        snprintf(text + n, size - (size_t)n, ", %s", p->formulation);
}

bool ct_work_precision_write(struct ct_ctx *ctx, const char *path,
                             const struct ct_work_precision_point *point, size_t n)
{
    static const char *const numbers[] = {"error", "seconds", "steps", "evaluations"};
    struct ct_columns t;
    ct_columns_init(&t, ctx->model, "method", CT_COLUMN_TEXT);
    const size_t tolerance = ct_columns_add(&t, "tolerance", CT_COLUMN_NUMBER),
                 elements = ct_columns_add(&t, "elements", CT_COLUMN_NUMBER),
                 formulation = ct_columns_add(&t, "formulation", CT_COLUMN_TEXT);
    for (size_t k = 0; k < COUNT(numbers); k++)
        ct_columns_add(&t, numbers[k], CT_COLUMN_NUMBER);
    for (size_t i = 0; i < n; i++) {
        const struct ct_work_precision_point *p = &point[i];
        const double value[] = {p->error, p->seconds, (double)p->steps, (double)p->evaluations};
        ct_columns_text(&t, 0, p->method);
        ct_columns_number(&t, tolerance, p->tolerance);
        ct_columns_number(&t, elements, p->elements > 0 ? (double)p->elements : (double)NAN);
        ct_columns_text(&t, formulation, p->formulation);
        for (size_t k = 0; k < COUNT(numbers); k++)
            ct_columns_number(&t, formulation + 1 + k, value[k]);
    }
    return ct_columns_write(ctx, &t, path);
}
