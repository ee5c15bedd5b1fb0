// See numeric_probe.h.
#include "formulate/closed_form/numeric_probe.h"

#include <stdlib.h>

void ct_probed_row_append(struct ct_arena *a, struct ct_probed_row *l, int column, ct_ex value,
                          double number)
{
    const struct ct_probed_entry e = {column, value, number};
    CT_PUSH(a, l->e, l->n, l->cap, e);
}

const struct ct_probed_entry *ct_probed_row_find(const struct ct_probed_row *l, int column)
{
    size_t low = 0, high = l->n;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (l->e[middle].column < column)
            low = middle + 1;
        else
            high = middle;
    }
    return low < l->n && l->e[low].column == column ? &l->e[low] : NULL;
}

static int by_column(const void *a, const void *b)
{
    const struct ct_probed_entry *p = a, *q = b;
    return p->column - q->column;
}

void ct_probed_rows_sort(struct ct_probed_row *l, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (l[i].n)
            qsort(l[i].e, l[i].n, sizeof *l[i].e, by_column);
}
