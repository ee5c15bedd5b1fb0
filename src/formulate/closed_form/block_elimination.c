// See block_elimination.h.
#include "formulate/closed_form/block_elimination.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct ct_blocks ct_blocks_create(struct ct_arena *a, struct ct_exs *x, size_t rank, size_t nu)
{
    struct ct_blocks s = {.a = a, .x = x, .rank = rank, .nu = nu};
    s.group = CT_NEWN(a, int, rank + 1);
    s.left = CT_NEWN(a, struct ct_probed_row, rank + 1);
    s.is_done = CT_NEWN(a, bool, rank + 1);
    s.level = CT_NEWN(a, int, rank + 1);
    s.in = CT_NEWN(a, struct ct_block_rows, nu + 1);
    s.best = CT_NEWN(a, struct ct_block_choice, rank + 1);
    s.is_stale = CT_NEWN(a, bool, rank + 1);
    s.block = CT_NEWN(a, struct ct_block, rank + 1);
    s.block_of = CT_NEWN(a, int, nu + 1);
    return s;
}

bool ct_blocks_moves(const struct ct_blocks *s, ct_ex v)
{
    return (ct_ex_kinds(s->x, v) & ~(1u << CT_SYM_PARAM)) != 0;
}

// ---- choice of pivots ---------------------------------------------------------------------------

static bool is_open(const struct ct_blocks *s, const struct ct_probed_entry *e)
{
    return s->block_of[e->column] == CT_BLOCK_OPEN;
}

// The largest magnitude in a row among the dependent columns.
static double row_size(const struct ct_blocks *s, int row)
{
    double most = 0;
    for (size_t i = 0; i < s->left[row].n; i++)
        if (is_open(s, &s->left[row].e[i]))
            most = fmax(most, fabs(s->left[row].e[i].number));
    return most;
}

static bool is_better(const struct ct_block_choice *a, const struct ct_block_choice *b)
{
    if (b->size == 0 || a->is_loose != b->is_loose)
        return b->size == 0 || b->is_loose;
    if (a->cost < b->cost || a->cost > b->cost)
        return a->cost < b->cost;
    return a->level < b->level;
}

static void try_single(const struct ct_blocks *s, int row, double size,
                       struct ct_block_choice *best)
{
    const struct ct_probed_row *l = &s->left[row];
    for (size_t i = 0; i < l->n; i++) {
        const struct ct_probed_entry *e = &l->e[i];
        const double strength = fabs(e->number) / size;
        if (!is_open(s, e) || !(strength >= CT_TIGHT_PIVOT))
            continue;
        const struct ct_block_choice c
            = {.size = 1,
               .row = {row},
               .column = {e->column},
               .is_loose = ct_blocks_moves(s, e->value),
               .cost = (s->in[e->column].nopen - 1) * ((double)l->n - 1),
               .level = s->level[row],
               .strength = strength};
        if (is_better(&c, best))
            *best = c;
    }
}

static double number_at(const struct ct_probed_row *l, int column)
{
    const struct ct_probed_entry *e = ct_probed_row_find(l, column);
    return e ? e->number : 0;
}

static void try_columns(const struct ct_blocks *s, struct ct_block_choice c, double size,
                        double width, struct ct_block_choice *best)
{
    const struct ct_probed_row *l = &s->left[c.row[0]], *k = &s->left[c.row[1]];
    double a[2], b[2];
    int inside = 0;
    for (int i = 0; i < 2; i++) {
        a[i] = number_at(l, c.column[i]);
        b[i] = number_at(k, c.column[i]);
        inside += (ct_probed_row_find(l, c.column[i]) != NULL)
                + (ct_probed_row_find(k, c.column[i]) != NULL);
    }
    c.strength = fabs(a[0] * b[1] - a[1] * b[0]) / size;
    c.cost = (s->in[c.column[0]].nopen + s->in[c.column[1]].nopen - inside) * (width - 1) / 2;
    if (c.strength >= CT_TIGHT_PIVOT && is_better(&c, best))
        *best = c;
}

static void try_pair(const struct ct_blocks *s, int i, int k, double size,
                     struct ct_block_choice *best)
{
    const struct ct_probed_row *l[2] = {&s->left[i], &s->left[k]};
    struct ct_block_choice c = {.size = 2, .row = {i, k}};
    c.level = s->level[i] > s->level[k] ? s->level[i] : s->level[k];
    double width = (double)l[0]->n;
    for (size_t q = 0; q < l[1]->n; q++)
        width += !ct_probed_row_find(l[0], l[1]->e[q].column);
    for (size_t p = 0; p < l[0]->n; p++)
        for (size_t q = 0; q < l[1]->n; q++) {
            c.column[0] = l[0]->e[p].column;
            c.column[1] = l[1]->e[q].column;
            if (is_open(s, &l[0]->e[p]) && is_open(s, &l[1]->e[q])
                && c.column[0] != c.column[1])
                try_columns(s, c, size, width, best);
        }
}

// If no pivot passes the threshold, takes the largest.
static void try_largest(const struct ct_blocks *s, struct ct_block_choice *best)
{
    for (int i = 0; i < (int)s->rank; i++) {
        const double size = s->is_done[i] ? 0 : row_size(s, i);
        for (size_t k = 0; size > 0 && k < s->left[i].n; k++) {
            const struct ct_probed_entry *e = &s->left[i].e[k];
            const double strength = fabs(e->number) / size;
            if (is_open(s, e) && strength > best->strength)
                *best = (struct ct_block_choice){
                    .size = 1, .row = {i}, .column = {e->column}, .strength = strength};
        }
    }
}

// The best pivot with row i alone or as its first row.
static struct ct_block_choice best_of_row(const struct ct_blocks *s, int i)
{
    struct ct_block_choice best = {0};
    const double size = row_size(s, i);
    if (!(size > 0))
        return best;
    try_single(s, i, size, &best);
    const int group = s->group[i];
    for (int k = i + 1; k < (int)s->rank && group >= 0 && s->group[k] == group; k++)
        if (!s->is_done[k])
            try_pair(s, i, k, size * row_size(s, k), &best);
    return best;
}

static struct ct_block_choice choose(struct ct_blocks *s)
{
    struct ct_block_choice best = {0};
    for (int i = 0; i < (int)s->rank; i++) {
        if (s->is_done[i])
            continue;
        if (s->is_stale[i])
            s->best[i] = best_of_row(s, i);
        s->is_stale[i] = false;
        if (s->best[i].size && is_better(&s->best[i], &best))
            best = s->best[i];
    }
    if (!best.size)
        try_largest(s, &best);
    return best;
}

// ---- rows of the columns ------------------------------------------------------------------------

// Row r or the number of rows in one of its columns has changed: so has its pivot, and those of the
// rows that it may form a block with.
static void mark_stale(struct ct_blocks *s, int r)
{
    int first = r;
    while (first > 0 && s->group[r] >= 0 && s->group[first - 1] == s->group[r])
        first--;
    for (; first <= r; first++)
        s->is_stale[first] = true;
}

// Adds `by` to the number of open rows in each column of row r.
static void count_row(struct ct_blocks *s, int r, int by)
{
    for (size_t i = 0; i < s->left[r].n; i++) {
        struct ct_block_rows *in = &s->in[s->left[r].e[i].column];
        in->nopen += by;
        for (size_t k = 0; k < in->n; k++)
            mark_stale(s, in->row[k]);
    }
}

static void list_row(struct ct_blocks *s, int column, int r)
{
    struct ct_block_rows *in = &s->in[column];
    CT_PUSH(s->a, in->row, in->n, in->cap, r);
}

static int by_index(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

// Open rows (n, out) that have or had an entry in a column of block b, ascending.
static int *rows_of(struct ct_blocks *s, const struct ct_block *b, size_t *n)
{
    const struct ct_block_rows *p = &s->in[b->column[0]], *q = &s->in[b->column[b->size - 1]];
    int *row = CT_NEWN(s->a, int, p->n + q->n + 1);
    *n = 0;
    for (size_t i = 0; i < p->n + (b->size == 2 ? q->n : 0); i++) {
        row[*n] = i < p->n ? p->row[i] : q->row[i - p->n];
        *n += !s->is_done[row[*n]];
    }
    qsort(row, *n, sizeof *row, by_index);
    return row;
}

// ---- elimination --------------------------------------------------------------------------------

static ct_ex value_at(const struct ct_probed_row *l, int column)
{
    const struct ct_probed_entry *e = ct_probed_row_find(l, column);
    return e ? e->value : CT_EX_ZERO;
}

static void invert(struct ct_blocks *s, struct ct_block *b)
{
    struct ct_exs *x = s->x;
    const struct ct_probed_row *l[2] = {&s->left[b->row[0]], &s->left[b->row[b->size - 1]]};
    const int i = b->column[0], k = b->column[b->size - 1];
    if (b->size == 1) {
        b->adjoint[0] = CT_EX_ONE;
        b->number[0] = 1;
        b->pivot = value_at(l[0], i);
        b->pivot_number = number_at(l[0], i);
        return;
    }
    const ct_ex P[4]
        = {value_at(l[0], i), value_at(l[0], k), value_at(l[1], i), value_at(l[1], k)};
    const double N[4]
        = {number_at(l[0], i), number_at(l[0], k), number_at(l[1], i), number_at(l[1], k)};
    const ct_ex adjoint[4] = {P[3], ct_ex_neg(x, P[1]), ct_ex_neg(x, P[2]), P[0]};
    const double number[4] = {N[3], -N[1], -N[2], N[0]};
    memcpy(b->adjoint, adjoint, sizeof adjoint);
    memcpy(b->number, number, sizeof number);
    b->pivot = ct_ex_sub_product(x, ct_ex_mul(x, P[0], P[3]), P[1], P[2]);
    b->pivot_number = N[0] * N[3] - N[1] * N[2];
}

// The next column of up to three sparse rows, from positions at[] on.
static int next_column(const struct ct_probed_row *const l[3], const size_t at[3], int n)
{
    int next = INT32_MAX;
    for (int i = 0; i < n; i++)
        if (at[i] < l[i]->n && l[i]->e[at[i]].column < next)
            next = l[i]->e[at[i]].column;
    return next;
}

// left[row] -= factor * rows of b; removes the columns of b.
static void subtract_rows(struct ct_blocks *s, int row, const struct ct_block *b,
                          const ct_ex *factor, const double *number)
{
    const struct ct_probed_row *const l[3]
        = {&s->left[row], &s->left[b->row[0]], &s->left[b->row[b->size - 1]]};
    const int n = 1 + b->size;
    struct ct_probed_row sum = {0};
    size_t at[3] = {0};
    for (int c; (c = next_column(l, at, n)) != INT32_MAX;) {
        ct_ex v = CT_EX_ZERO;
        double v_number = 0;
        for (int i = 0; i < n; i++) {
            if (at[i] >= l[i]->n || l[i]->e[at[i]].column != c)
                continue;
            const struct ct_probed_entry *e = &l[i]->e[at[i]++];
            v = i ? ct_ex_sub_product(s->x, v, factor[i - 1], e->value) : e->value;
            v_number = i ? v_number - number[i - 1] * e->number : e->number;
        }
        if (c == b->column[0] || c == b->column[b->size - 1] || ct_ex_is_zero(v))
            continue;
        ct_probed_row_append(s->a, &sum, c, v, v_number);
        if (!ct_probed_row_find(l[0], c))
            list_row(s, c, row);
    }
    count_row(s, row, -1);
    s->left[row] = sum;
    count_row(s, row, 1);
}

static void eliminate_row(struct ct_blocks *s, int row, int k)
{
    const struct ct_block *b = &s->block[k];
    const struct ct_probed_row *l = &s->left[row];
    struct ct_block_step step = {.row = row, .block = k};
    double number[2] = {0};
    bool is_needed = false;
    for (int i = 0; i < b->size; i++)
        is_needed |= ct_probed_row_find(l, b->column[i]) != NULL;
    if (!is_needed)
        return;
    for (int i = 0; i < b->size; i++) {
        for (int q = 0; q < b->size; q++) {
            const int p = b->size * q + i;
            step.factor[i] = ct_ex_add_product(s->x, step.factor[i], value_at(l, b->column[q]),
                                               b->adjoint[p]);
            number[i] += number_at(l, b->column[q]) * b->number[p] / b->pivot_number;
        }
        step.factor[i] = ct_ex_div(s->x, step.factor[i], b->pivot);
    }
    subtract_rows(s, row, b, step.factor, number);
    CT_PUSH(s->a, s->step, s->nstep, s->step_cap, step);
    for (int i = 0; i < b->size; i++)
        if (s->level[row] <= s->level[b->row[i]])
            s->level[row] = s->level[b->row[i]] + 1;
}

bool ct_blocks_factor(struct ct_blocks *s, size_t most_nodes)
{
    for (int i = 0; i < (int)s->rank; i++) {
        for (size_t k = 0; k < s->left[i].n; k++)
            list_row(s, s->left[i].e[k].column, i);
        count_row(s, i, 1);
        s->is_stale[i] = true;
    }
    for (size_t done = 0; done < s->rank;) {
        const struct ct_block_choice c = choose(s);
        if (!c.size || s->x->nnode > most_nodes)
            return false;
        const int k = (int)s->nblock++;
        struct ct_block *b = &s->block[k];
        *b = (struct ct_block){.size = c.size, .strength = c.strength};
        for (int i = 0; i < c.size; i++) {
            b->row[i] = c.row[i];
            b->column[i] = c.column[i];
            s->is_done[c.row[i]] = true;
            s->block_of[c.column[i]] = k;
            count_row(s, c.row[i], -1);
        }
        invert(s, b);
        size_t n;
        const int *row = rows_of(s, b, &n);
        for (size_t i = 0; i < n; i++)
            eliminate_row(s, row[i], k);
        done += (size_t)c.size;
    }
    return true;
}

// ---- solutions ----------------------------------------------------------------------------------

// x = P^-1 t for the columns of block k, after subtracting the other entries of its rows from t.
static void solve_block(struct ct_blocks *s, int k, const ct_ex *t, ct_ex *x)
{
    const struct ct_block *b = &s->block[k];
    ct_ex rest[2] = {CT_EX_ZERO, CT_EX_ZERO};
    for (int i = 0; i < b->size; i++) {
        const struct ct_probed_row *l = &s->left[b->row[i]];
        rest[i] = t[i];
        for (size_t q = l->n; q-- > 0;)
            if (s->block_of[l->e[q].column] > k)
                rest[i] = ct_ex_sub_product(s->x, rest[i], l->e[q].value, x[l->e[q].column]);
    }
    for (int i = 0; i < b->size; i++) {
        ct_ex v = CT_EX_ZERO;
        for (int q = 0; q < b->size; q++)
            v = ct_ex_add_product(s->x, v, b->adjoint[b->size * i + q], rest[q]);
        x[b->column[i]] = ct_ex_div(s->x, v, b->pivot);
    }
}

void ct_blocks_solve_column(struct ct_blocks *s, int column, ct_ex *x)
{
    for (int k = (int)s->nblock; k-- > 0;) {
        const struct ct_block *b = &s->block[k];
        ct_ex t[2];
        for (int i = 0; i < 2; i++)
            t[i] = ct_ex_neg(s->x, value_at(&s->left[b->row[i < b->size ? i : 0]], column));
        solve_block(s, k, t, x);
    }
}

void ct_blocks_solve(struct ct_blocks *s, ct_ex *r, ct_ex *x)
{
    for (size_t i = 0; i < s->nstep; i++) {
        const struct ct_block_step *t = &s->step[i];
        const struct ct_block *b = &s->block[t->block];
        for (int q = 0; q < b->size; q++)
            r[t->row] = ct_ex_sub_product(s->x, r[t->row], t->factor[q], r[b->row[q]]);
    }
    for (int k = (int)s->nblock; k-- > 0;) {
        const struct ct_block *b = &s->block[k];
        const ct_ex t[2] = {r[b->row[0]], r[b->row[b->size - 1]]};
        solve_block(s, k, t, x);
    }
}

void ct_blocks_solve_transposed(struct ct_blocks *s, const ct_ex *w, ct_ex *lam)
{
    struct ct_exs *x = s->x;
    ct_ex *t = CT_NEWN(s->a, ct_ex, s->nu + 1);
    memcpy(t, w, s->nu * sizeof *t);
    for (size_t k = 0; k < s->nblock; k++) {
        const struct ct_block *b = &s->block[k];
        for (int i = 0; i < b->size; i++) {
            ct_ex v = CT_EX_ZERO;
            for (int q = 0; q < b->size; q++)
                v = ct_ex_add_product(x, v, b->adjoint[b->size * q + i], t[b->column[q]]);
            lam[b->row[i]] = ct_ex_div(x, v, b->pivot);
        }
        for (int i = 0; i < b->size; i++) {
            const struct ct_probed_row *l = &s->left[b->row[i]];
            for (size_t q = 0; q < l->n; q++)
                if (s->block_of[l->e[q].column] > (int)k)
                    t[l->e[q].column] = ct_ex_sub_product(x, t[l->e[q].column], l->e[q].value,
                                                          lam[b->row[i]]);
        }
    }
    for (size_t i = s->nstep; i-- > 0;) {
        const struct ct_block *b = &s->block[s->step[i].block];
        for (int q = 0; q < b->size; q++)
            lam[b->row[q]] = ct_ex_sub_product(x, lam[b->row[q]], s->step[i].factor[q],
                                               lam[s->step[i].row]);
    }
}
