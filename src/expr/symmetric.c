// See symmetric.h.
#include "expr/symmetric.h"

#include <string.h>

struct ct_symmetric ct_symmetric_create(struct ct_arena *arena, size_t n)
{
    return (struct ct_symmetric){
        .arena = arena, .n = n, .row = CT_NEWN(arena, struct ct_symmetric_row, n + 1)};
}

// Place of the first entry in a column of at least j.
static size_t find(const struct ct_symmetric_row *r, size_t j)
{
    size_t low = 0, high = r->n;
    if (r->n && r->place[r->n - 1].column < j)
        return r->n;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (r->place[middle].column < j)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static bool has(const struct ct_symmetric_row *r, size_t at, size_t j)
{
    return at < r->n && r->place[at].column == j;
}

static void insert(struct ct_symmetric *s, struct ct_symmetric_row *r, size_t at, size_t j)
{
    const struct ct_symmetric_place p = {j, s->nvalue};
    CT_PUSH(s->arena, r->place, r->n, r->cap, p);
    memmove(&r->place[at + 1], &r->place[at], (r->n - 1 - at) * sizeof p);
    r->place[at] = p;
}

ct_ex *ct_symmetric_at(struct ct_symmetric *s, size_t i, size_t j)
{
    struct ct_symmetric_row *r = &s->row[i];
    const size_t at = find(r, j);
    if (has(r, at, j))
        return &s->value[r->place[at].value];
    insert(s, r, at, j);
    if (i != j)
        insert(s, &s->row[j], find(&s->row[j], i), i);
    CT_PUSH(s->arena, s->value, s->nvalue, s->cap, CT_EX_ZERO);
    return &s->value[s->nvalue - 1];
}

ct_ex ct_symmetric_get(const struct ct_symmetric *s, size_t i, size_t j)
{
    const struct ct_symmetric_row *r = &s->row[i];
    const size_t at = find(r, j);
    return has(r, at, j) ? s->value[r->place[at].value] : CT_EX_ZERO;
}

void ct_symmetric_add(struct ct_exs *x, struct ct_symmetric *s, size_t i, size_t j, ct_ex v)
{
    if (ct_ex_is_zero(v))
        return;
    ct_ex *sum = ct_symmetric_at(s, i, j);
    *sum = ct_ex_add(x, *sum, v);
}

void ct_symmetric_subtract(struct ct_exs *x, struct ct_symmetric *s, size_t i, size_t j,
                           ct_ex v)
{
    if (ct_ex_is_zero(v))
        return;
    ct_ex *sum = ct_symmetric_at(s, i, j);
    *sum = ct_ex_sub(x, *sum, v);
}
