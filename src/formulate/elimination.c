// See elimination.h.
#include "formulate/elimination.h"
#include "formulate/kkt.h"
#include "formulate/shadow.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// A pivot is large enough from this part of the largest entries of its rows.
static const double threshold = 0.1;

// Pivots P: P^-1 is the adjoint divided by the determinant. The quotient is taken last, so that a row that
// repeats the pivot's gives 1 exactly: mechanisms of equal parts stay symmetric to the last bit.
struct block {
    int size, row[2], column[2];
    ct_ex adjoint[4], pivot;                  // by rows; the determinant
    double number[4], pivot_number, strength; // at the state of the shadow
};

struct step { // of elimination: row -= factor * rows of the block
    int row, block;
    ct_ex factor[2];
};

struct elimination {
    struct ct_arena *a;
    struct ct_exs *x;
    const struct ct_equations *e;
    const struct ct_partition *p;
    int *row;                    // kept rows, ascending
    struct ct_shadow_row *J, *M; // (rank), as given; (nu), both triangles
    struct ct_shadow_row *left;  // (rank) what elimination has left of J
    bool *is_done;               // (rank) rows
    int *block_of;               // (nu) columns; OPEN, INDEPENDENT
    int *level, *count; // (rank) steps that must come before; (nu) open rows with that column
    struct block *block;
    size_t nblock;
    struct step *step;
    size_t nstep, step_cap;
    struct ct_kkt *whole; // all equations as one system, or NULL: embedding
    ct_ex *B;             // (nu x nfree), unit rows in the independent places
    ct_ex *S;      // (nfree x nfree) L' D L of B' M B, lower triangle: D, and L beside it
    size_t *order; // (nfree) of the pivots of S, the first one last
};

enum { INDEPENDENT = -1, OPEN = -2 };

// ---- lines ----------------------------------------------------------------------------------------

static int ascending(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

static void read_matrices(struct elimination *s, const double *M, const double *J)
{
    const struct ct_equations *e = s->e;
    int *place = CT_NEWN(s->a, int, e->nrow + 1); // 1 + place of a kept row
    for (size_t i = 0; i < s->p->rank; i++)
        place[s->row[i]] = (int)i + 1;
    for (size_t i = 0; i < e->nJ; i++)
        if (place[e->J[i].row]) {
            const int r = place[e->J[i].row] - 1;
            ct_shadow_put(s->a, &s->J[r], e->J[i].column, e->J[i].value, J[i]);
            ct_shadow_put(s->a, &s->left[r], e->J[i].column, e->J[i].value, J[i]);
        }
    for (size_t i = 0; i < e->nM; i++) {
        ct_shadow_put(s->a, &s->M[e->M[i].row], e->M[i].column, e->M[i].value, M[i]);
        if (e->M[i].row != e->M[i].column)
            ct_shadow_put(s->a, &s->M[e->M[i].column], e->M[i].row, e->M[i].value, M[i]);
    }
    ct_shadow_sort(s->J, s->p->rank);
    ct_shadow_sort(s->left, s->p->rank);
    ct_shadow_sort(s->M, e->nu);
}

// ---- choice of pivots -------------------------------------------------------------------------------

struct choice {
    int size, row[2], column[2];
    bool is_loose; // a single entry that moves: it may vanish somewhere
    double cost;   // products per row
    int level;
    double strength;
};

static bool is_open(const struct elimination *s, const struct ct_shadow_entry *e)
{
    return s->block_of[e->column] == OPEN;
}

// The largest number of a row among the dependent columns.
static double row_size(const struct elimination *s, int row)
{
    double most = 0;
    for (size_t i = 0; i < s->left[row].n; i++)
        if (is_open(s, &s->left[row].e[i]))
            most = fmax(most, fabs(s->left[row].e[i].number));
    return most;
}

static bool is_better(const struct choice *a, const struct choice *b)
{
    if (b->size == 0 || a->is_loose != b->is_loose)
        return b->size == 0 || b->is_loose;
    if (a->cost < b->cost || a->cost > b->cost)
        return a->cost < b->cost;
    return a->level < b->level;
}

static bool moves(const struct elimination *s, ct_ex v)
{
    return (ct_ex_kinds(s->x, v) & ~(1u << CT_SYM_PARAM)) != 0;
}

static void try_single(const struct elimination *s, int row, double size, struct choice *best)
{
    const struct ct_shadow_row *l = &s->left[row];
    for (size_t i = 0; i < l->n; i++) {
        const struct ct_shadow_entry *e = &l->e[i];
        const double strength = fabs(e->number) / size;
        if (!is_open(s, e) || !(strength >= threshold))
            continue;
        const struct choice c = {.size = 1,
                                 .row = {row},
                                 .column = {e->column},
                                 .is_loose = moves(s, e->value),
                                 .cost = (s->count[e->column] - 1) * ((double)l->n - 1),
                                 .level = s->level[row],
                                 .strength = strength};
        if (is_better(&c, best))
            *best = c;
    }
}

static double number_at(const struct ct_shadow_row *l, int column)
{
    const struct ct_shadow_entry *e = ct_shadow_find(l, column);
    return e ? e->number : 0;
}

static void try_columns(const struct elimination *s, struct choice c, double size, double width,
                        struct choice *best)
{
    const struct ct_shadow_row *l = &s->left[c.row[0]], *k = &s->left[c.row[1]];
    double a[2], b[2];
    int inside = 0;
    for (int i = 0; i < 2; i++) {
        a[i] = number_at(l, c.column[i]);
        b[i] = number_at(k, c.column[i]);
        inside += (ct_shadow_find(l, c.column[i]) != NULL)
                + (ct_shadow_find(k, c.column[i]) != NULL);
    }
    c.strength = fabs(a[0] * b[1] - a[1] * b[0]) / size;
    c.cost = (s->count[c.column[0]] + s->count[c.column[1]] - inside) * (width - 1) / 2;
    if (c.strength >= threshold && is_better(&c, best))
        *best = c;
}

static void try_pair(const struct elimination *s, int i, int k, double size,
                     struct choice *best)
{
    const struct ct_shadow_row *l[2] = {&s->left[i], &s->left[k]};
    struct choice c = {.size = 2, .row = {i, k}};
    c.level = s->level[i] > s->level[k] ? s->level[i] : s->level[k];
    double width = (double)l[0]->n;
    for (size_t q = 0; q < l[1]->n; q++)
        width += !ct_shadow_find(l[0], l[1]->e[q].column);
    for (size_t p = 0; p < l[0]->n; p++)
        for (size_t q = 0; q < l[1]->n; q++) {
            c.column[0] = l[0]->e[p].column;
            c.column[1] = l[1]->e[q].column;
            if (is_open(s, &l[0]->e[p]) && is_open(s, &l[1]->e[q])
                && c.column[0] != c.column[1])
                try_columns(s, c, size, width, best);
        }
}

// Where nothing is large enough, the largest there is.
static void try_largest(const struct elimination *s, struct choice *best)
{
    for (int i = 0; i < (int)s->p->rank; i++) {
        const double size = s->is_done[i] ? 0 : row_size(s, i);
        for (size_t k = 0; size > 0 && k < s->left[i].n; k++) {
            const struct ct_shadow_entry *e = &s->left[i].e[k];
            const double strength = fabs(e->number) / size;
            if (is_open(s, e) && strength > best->strength)
                *best = (struct choice){
                    .size = 1, .row = {i}, .column = {e->column}, .strength = strength};
        }
    }
}

static struct choice choose(struct elimination *s)
{
    struct choice best = {0};
    const int n = (int)s->p->rank;
    memset(s->count, 0, s->e->nu * sizeof *s->count);
    for (int i = 0; i < n; i++)
        for (size_t k = 0; k < s->left[i].n && !s->is_done[i]; k++)
            s->count[s->left[i].e[k].column]++;
    for (int i = 0; i < n; i++) {
        const double size = s->is_done[i] ? 0 : row_size(s, i);
        if (!(size > 0))
            continue;
        try_single(s, i, size, &best);
        const int joint = s->e->row[s->row[i]].joint;
        for (int k = i + 1; k < n && joint >= 0 && s->e->row[s->row[k]].joint == joint; k++)
            if (!s->is_done[k])
                try_pair(s, i, k, size * row_size(s, k), &best);
    }
    if (!best.size)
        try_largest(s, &best);
    return best;
}

// ---- elimination --------------------------------------------------------------------------------------

static ct_ex value_at(const struct ct_shadow_row *l, int column)
{
    const struct ct_shadow_entry *e = ct_shadow_find(l, column);
    return e ? e->value : CT_EX_ZERO;
}

static ct_ex sub_product(struct ct_exs *x, ct_ex a, ct_ex b, ct_ex c)
{
    return ct_ex_sub(x, a, ct_ex_mul(x, b, c));
}

static ct_ex add_product(struct ct_exs *x, ct_ex a, ct_ex b, ct_ex c)
{
    return ct_ex_add(x, a, ct_ex_mul(x, b, c));
}

static void invert(struct elimination *s, struct block *b)
{
    struct ct_exs *x = s->x;
    const struct ct_shadow_row *l[2] = {&s->left[b->row[0]], &s->left[b->row[b->size - 1]]};
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
    b->pivot = sub_product(x, ct_ex_mul(x, P[0], P[3]), P[1], P[2]);
    b->pivot_number = N[0] * N[3] - N[1] * N[2];
}

// The next column of up to three lines, from places at[] on.
static int next_column(const struct ct_shadow_row *const l[3], const size_t at[3], int n)
{
    int next = INT32_MAX;
    for (int i = 0; i < n; i++)
        if (at[i] < l[i]->n && l[i]->e[at[i]].column < next)
            next = l[i]->e[at[i]].column;
    return next;
}

// left[row] -= factor * rows of b; the columns of b go.
static void subtract_rows(struct elimination *s, int row, const struct block *b,
                          const ct_ex *factor, const double *number)
{
    const struct ct_shadow_row *const l[3]
        = {&s->left[row], &s->left[b->row[0]], &s->left[b->row[b->size - 1]]};
    const int n = 1 + b->size;
    struct ct_shadow_row sum = {0};
    size_t at[3] = {0};
    for (int c; (c = next_column(l, at, n)) != INT32_MAX;) {
        ct_ex v = CT_EX_ZERO;
        double v_number = 0;
        for (int i = 0; i < n; i++) {
            if (at[i] >= l[i]->n || l[i]->e[at[i]].column != c)
                continue;
            const struct ct_shadow_entry *e = &l[i]->e[at[i]++];
            v = i ? sub_product(s->x, v, factor[i - 1], e->value) : e->value;
            v_number = i ? v_number - number[i - 1] * e->number : e->number;
        }
        if (c != b->column[0] && c != b->column[b->size - 1] && !ct_ex_is_zero(v))
            ct_shadow_put(s->a, &sum, c, v, v_number);
    }
    s->left[row] = sum;
}

static void eliminate_row(struct elimination *s, int row, int k)
{
    const struct block *b = &s->block[k];
    const struct ct_shadow_row *l = &s->left[row];
    struct step step = {.row = row, .block = k};
    double number[2] = {0};
    bool is_needed = false;
    for (int i = 0; i < b->size; i++)
        is_needed |= ct_shadow_find(l, b->column[i]) != NULL;
    if (!is_needed)
        return;
    for (int i = 0; i < b->size; i++) {
        for (int q = 0; q < b->size; q++) {
            const int p = b->size * q + i;
            step.factor[i]
                = add_product(s->x, step.factor[i], value_at(l, b->column[q]), b->adjoint[p]);
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

static bool eliminate(struct elimination *s, size_t most_nodes)
{
    for (size_t done = 0; done < s->p->rank;) {
        const struct choice c = choose(s);
        if (!c.size || s->x->nnode > most_nodes)
            return false;
        const int k = (int)s->nblock++;
        struct block *b = &s->block[k];
        *b = (struct block){.size = c.size, .strength = c.strength};
        for (int i = 0; i < c.size; i++) {
            b->row[i] = c.row[i];
            b->column[i] = c.column[i];
            s->is_done[c.row[i]] = true;
            s->block_of[c.column[i]] = k;
        }
        invert(s, b);
        for (int i = 0; i < (int)s->p->rank; i++)
            if (!s->is_done[i])
                eliminate_row(s, i, k);
        done += (size_t)c.size;
    }
    return true;
}

// ---- solutions ----------------------------------------------------------------------------------------------

// In pairs, so that the sum of many terms is not one long chain.
static ct_ex sum(struct ct_exs *x, ct_ex *term, size_t n)
{
    for (; n > 1; n = (n + 1) / 2)
        for (size_t i = 0; i < n / 2; i++)
            term[i] = ct_ex_add(x, term[i], term[n - 1 - i]);
    return n ? term[0] : CT_EX_ZERO;
}

// x = P^-1 t for the columns of block k, the rest of its rows taken off t.
static void solve_block(struct elimination *s, const struct block *b, int k, const ct_ex *t,
                        ct_ex *x)
{
    ct_ex rest[2] = {CT_EX_ZERO, CT_EX_ZERO};
    for (int i = 0; i < b->size; i++) {
        const struct ct_shadow_row *l = &s->left[b->row[i]];
        rest[i] = t[i];
        for (size_t q = l->n; q-- > 0;)
            if (s->block_of[l->e[q].column] > k)
                rest[i] = sub_product(s->x, rest[i], l->e[q].value, x[l->e[q].column]);
    }
    for (int i = 0; i < b->size; i++) {
        ct_ex v = CT_EX_ZERO;
        for (int q = 0; q < b->size; q++)
            v = add_product(s->x, v, b->adjoint[b->size * i + q], rest[q]);
        x[b->column[i]] = ct_ex_div(s->x, v, b->pivot);
    }
}

// x (nu, out in the dependent places) = J_d^-1 r; r (rank) is lost.
static void solve_rows(struct elimination *s, ct_ex *r, ct_ex *x)
{
    for (size_t i = 0; i < s->nstep; i++) {
        const struct step *t = &s->step[i];
        const struct block *b = &s->block[t->block];
        for (int q = 0; q < b->size; q++)
            r[t->row] = sub_product(s->x, r[t->row], t->factor[q], r[b->row[q]]);
    }
    for (int k = (int)s->nblock; k-- > 0;) {
        const struct block *b = &s->block[k];
        const ct_ex t[2] = {r[b->row[0]], r[b->row[b->size - 1]]};
        solve_block(s, b, k, t, x);
    }
}

// lam (rank, out) = J_d^-T w (nu).
static void solve_columns(struct elimination *s, const ct_ex *w, ct_ex *lam)
{
    struct ct_exs *x = s->x;
    ct_ex *t = CT_NEWN(s->a, ct_ex, s->e->nu + 1);
    memcpy(t, w, s->e->nu * sizeof *t);
    for (size_t k = 0; k < s->nblock; k++) {
        const struct block *b = &s->block[k];
        for (int i = 0; i < b->size; i++) {
            ct_ex v = CT_EX_ZERO;
            for (int q = 0; q < b->size; q++)
                v = add_product(x, v, b->adjoint[b->size * q + i], t[b->column[q]]);
            lam[b->row[i]] = ct_ex_div(x, v, b->pivot);
        }
        for (int i = 0; i < b->size; i++) {
            const struct ct_shadow_row *l = &s->left[b->row[i]];
            for (size_t q = 0; q < l->n; q++)
                if (s->block_of[l->e[q].column] > (int)k)
                    t[l->e[q].column]
                        = sub_product(x, t[l->e[q].column], l->e[q].value, lam[b->row[i]]);
        }
    }
    for (size_t i = s->nstep; i-- > 0;) {
        const struct block *b = &s->block[s->step[i].block];
        for (int q = 0; q < b->size; q++)
            lam[b->row[q]]
                = sub_product(x, lam[b->row[q]], s->step[i].factor[q], lam[s->step[i].row]);
    }
}

// ---- reduced equations ------------------------------------------------------------------------------------------

// y (out) = A x for a sparse matrix of n lines.
static void apply(struct elimination *s, const struct ct_shadow_row *A, size_t n,
                  const ct_ex *x, ct_ex *y)
{
    for (size_t i = 0; i < n; i++) {
        y[i] = CT_EX_ZERO;
        for (size_t k = 0; k < A[i].n; k++)
            y[i] = add_product(s->x, y[i], A[i].e[k].value, x[A[i].e[k].column]);
    }
}

static ct_ex dot_column(struct elimination *s, size_t j, const ct_ex *v, ct_ex *term)
{
    size_t n = 0;
    for (size_t i = 0; i < s->e->nu; i++) {
        term[n] = ct_ex_mul(s->x, s->B[i + s->e->nu * j], v[i]);
        n += !ct_ex_is_zero(term[n]);
    }
    return sum(s->x, term, n);
}

static void derive_B(struct elimination *s)
{
    const size_t nu = s->e->nu;
    s->B = CT_NEWN(s->a, ct_ex, nu * (s->p->nfree + 1));
    for (size_t j = 0; j < s->p->nfree; j++) {
        ct_ex *x = s->B + nu * j;
        const int column = s->p->independent[j];
        for (int k = (int)s->nblock; k-- > 0;) {
            const struct block *b = &s->block[k];
            ct_ex t[2];
            for (int i = 0; i < 2; i++)
                t[i] = ct_ex_neg(s->x, value_at(&s->left[b->row[i < b->size ? i : 0]], column));
            solve_block(s, b, k, t, x);
        }
        x[column] = CT_EX_ONE;
    }
}

// The entry of S between two free columns, in either order.
static ct_ex *S_at(const struct elimination *s, size_t i, size_t j)
{
    return &s->S[(i > j ? i : j) + s->p->nfree * (i > j ? j : i)];
}

// Products of eliminating S by its pattern, from the last column to the first or always the one with the fewest
// neighbours; order (nfree, out).
static double eliminate_pattern(struct elimination *s, bool by_degree, size_t *order)
{
    const size_t f = s->p->nfree;
    bool *joined = CT_NEWN(s->a, bool, f *f + 1), *is_done = CT_NEWN(s->a, bool, f + 1);
    size_t *degree = CT_NEWN(s->a, size_t, f + 1), *near = CT_NEWN(s->a, size_t, f + 1);
    double cost = 0;
    for (size_t i = 0; i < f; i++)
        for (size_t j = 0; j < f; j++) {
            joined[i + f * j] = i != j && !ct_ex_is_zero(*S_at(s, i, j));
            degree[j] += joined[i + f * j];
        }
    for (size_t left = f; left-- > 0;) {
        size_t k = left, n = 0;
        for (size_t i = f; by_degree && i-- > 0;)
            if (!is_done[i] && (is_done[k] || degree[i] < degree[k]))
                k = i;
        order[left] = k;
        is_done[k] = true;
        for (size_t i = 0; i < f; i++)
            if (!is_done[i] && joined[i + f * k])
                near[n++] = i;
        cost += 0.5 * (double)(n * (n + 3));
        for (size_t a = 0; a < n; a++) {
            degree[near[a]]--;
            for (size_t b = 0; b < a; b++)
                if (!joined[near[a] + f * near[b]]) {
                    joined[near[a] + f * near[b]] = joined[near[b] + f * near[a]] = true;
                    degree[near[a]]++;
                    degree[near[b]]++;
                }
        }
    }
    return cost;
}

// A beam in a loop has a sparse S whose columns next to the cut are joined to all others: they come last.
static void choose_order(struct elimination *s)
{
    size_t *last_first = CT_NEWN(s->a, size_t, s->p->nfree + 1);
    s->order = CT_NEWN(s->a, size_t, s->p->nfree + 1);
    if (eliminate_pattern(s, false, last_first) <= eliminate_pattern(s, true, s->order))
        s->order = last_first;
}

// B' M B = L' D L; false if the nodes do not suffice.
static bool reduce(struct elimination *s, size_t most_nodes)
{
    const size_t nu = s->e->nu, f = s->p->nfree;
    ct_ex *MB = CT_NEWN(s->a, ct_ex, nu + 1), *term = CT_NEWN(s->a, ct_ex, nu + 1);
    s->S = CT_NEWN(s->a, ct_ex, f * f + 1);
    for (size_t j = 0; j < f; j++) {
        apply(s, s->M, nu, s->B + nu * j, MB);
        for (size_t i = j; i < f; i++)
            s->S[i + f * j] = dot_column(s, i, MB, term);
        if (s->x->nnode > most_nodes)
            return false;
    }
    choose_order(s);
    for (size_t at = f; at-- > 0;) {
        const size_t k = s->order[at];
        if (s->x->nnode > most_nodes)
            return false;
        for (size_t i = at; i-- > 0;) {
            ct_ex *beside = S_at(s, k, s->order[i]);
            if (ct_ex_is_zero(*beside))
                continue;
            const ct_ex l = ct_ex_div(s->x, *beside, *S_at(s, k, k));
            for (size_t j = 0; j <= i; j++) {
                ct_ex *entry = S_at(s, s->order[i], s->order[j]);
                *entry = sub_product(s->x, *entry, l, *S_at(s, k, s->order[j]));
            }
            *beside = l;
        }
    }
    return true;
}

// z (nfree, in and out) = (B' M B)^-1 z.
static void solve_reduced(struct elimination *s, ct_ex *z)
{
    const size_t f = s->p->nfree;
    for (size_t at = f; at-- > 0;)
        for (size_t i = 0; i < at; i++) {
            const size_t k = s->order[at], to = s->order[i];
            z[to] = sub_product(s->x, z[to], *S_at(s, k, to), z[k]);
        }
    for (size_t at = 0; at < f; at++) {
        const size_t k = s->order[at];
        z[k] = ct_ex_div(s->x, z[k], *S_at(s, k, k));
        for (size_t i = 0; i < at; i++)
            z[k] = sub_product(s->x, z[k], *S_at(s, k, s->order[i]), z[s->order[i]]);
    }
}

// The same from the factors of all equations.
static void solve_whole(struct elimination *s, const ct_ex *Q, const ct_ex *g, ct_ex *a,
                        ct_ex *lam)
{
    const size_t nu = s->e->nu, m = s->p->rank;
    ct_ex *b = CT_NEWN(s->a, ct_ex, nu + m + 1), *y = CT_NEWN(s->a, ct_ex, nu + m + 1);
    memcpy(b, Q, nu * sizeof *b);
    if (m)
        memcpy(b + nu, g, m * sizeof *b);
    ct_kkt_solve(s->whole, s->x, b, y);
    memcpy(a, y, nu * sizeof *a);
    for (size_t i = 0; i < m; i++)
        lam[i] = ct_ex_neg(s->x, y[nu + i]);
}

// a (nu, out), lam (rank, out): M a - J' lam = Q (nu), J a = g (rank; lost).
static void solve(struct elimination *s, const ct_ex *Q, ct_ex *g, ct_ex *a, ct_ex *lam)
{
    struct ct_exs *x = s->x;
    const size_t nu = s->e->nu, f = s->p->nfree;
    if (s->whole) {
        solve_whole(s, Q, g, a, lam);
        return;
    }
    ct_ex *c = CT_NEWN(s->a, ct_ex, nu + 1), *w = CT_NEWN(s->a, ct_ex, nu + 1);
    ct_ex *z = CT_NEWN(s->a, ct_ex, f + 1), *term = CT_NEWN(s->a, ct_ex, nu + 1);
    solve_rows(s, g, c);
    apply(s, s->M, nu, c, w);
    for (size_t i = 0; i < nu; i++)
        w[i] = ct_ex_sub(x, Q[i], w[i]);
    for (size_t j = 0; j < f; j++)
        z[j] = dot_column(s, j, w, term);
    solve_reduced(s, z);
    for (size_t i = 0; i < nu; i++) {
        a[i] = c[i];
        for (size_t j = 0; j < f; j++)
            a[i] = add_product(x, a[i], s->B[i + nu * j], z[j]);
    }
    apply(s, s->M, nu, a, w);
    for (size_t i = 0; i < nu; i++)
        w[i] = ct_ex_sub(x, w[i], Q[i]);
    solve_columns(s, w, lam);
}

// r (nu + rank, out) = M a - Q - J' lam, J a + gam.
static void residual(struct elimination *s, const ct_ex *a, const ct_ex *lam, ct_ex *r)
{
    const size_t nu = s->e->nu, m = s->p->rank;
    apply(s, s->M, nu, a, r);
    for (size_t i = 0; i < nu; i++)
        r[i] = ct_ex_sub(s->x, r[i], s->e->Q[i]);
    for (size_t i = 0; i < m; i++)
        for (size_t k = 0; k < s->J[i].n; k++) {
            ct_ex *to = &r[s->J[i].e[k].column];
            *to = sub_product(s->x, *to, s->J[i].e[k].value, lam[i]);
        }
    apply(s, s->J, m, a, r + nu);
    for (size_t i = 0; i < m; i++)
        r[nu + i] = ct_ex_add(s->x, r[nu + i], s->e->row[s->row[i]].gam);
}

// ---- entries --------------------------------------------------------------------------------------------------------

static struct elimination create(struct ct_arena *a, struct ct_exs *x,
                                 const struct ct_equations *e, const struct ct_partition *p)
{
    struct elimination s = {.a = a, .x = x, .e = e, .p = p};
    const size_t m = p->rank;
    s.row = CT_NEWN(a, int, m + 1);
    memcpy(s.row, p->row, m * sizeof *s.row);
    qsort(s.row, m, sizeof *s.row, ascending);
    s.J = CT_NEWN(a, struct ct_shadow_row, m + 1);
    s.left = CT_NEWN(a, struct ct_shadow_row, m + 1);
    s.M = CT_NEWN(a, struct ct_shadow_row, e->nu + 1);
    s.is_done = CT_NEWN(a, bool, m + 1);
    s.level = CT_NEWN(a, int, m + 1);
    s.count = CT_NEWN(a, int, e->nu + 1);
    s.block = CT_NEWN(a, struct block, m + 1);
    s.block_of = CT_NEWN(a, int, e->nu + 1);
    for (size_t i = 0; i < m; i++)
        s.block_of[p->dependent[i]] = OPEN;
    for (size_t i = 0; i < p->nfree; i++)
        s.block_of[p->independent[i]] = INDEPENDENT;
    return s;
}

static void list_pivots(const struct elimination *s, struct ct_closed *c)
{
    c->pivot = CT_NEWN(s->a, ct_ex, s->nblock + 1);
    c->scale = CT_NEWN(s->a, double, s->nblock + 1);
    for (size_t k = 0; k < s->nblock; k++)
        if (moves(s, s->block[k].pivot)) {
            c->scale[c->npivot] = s->block[k].strength / fabs(s->block[k].pivot_number);
            c->pivot[c->npivot++] = s->block[k].pivot;
        }
    if (s->whole) {
        c->nfree = 0;
        return;
    }
    c->inertia = CT_NEWN(s->a, ct_ex, c->nfree + 1);
    for (size_t j = 0; j < c->nfree; j++)
        c->inertia[j] = s->S[j + c->nfree * j];
    c->B = CT_NEWN(s->a, ct_ex, s->e->nu * c->nfree + 1);
    for (size_t i = 0; i < s->e->nu * c->nfree; i++)
        if (s->block_of[i % s->e->nu] >= 0 && !ct_ex_is_zero(s->B[i]))
            c->B[c->nB++] = s->B[i];
}

static void derive_accelerations(struct elimination *s, struct ct_closed *c)
{
    struct ct_arena *a = s->a;
    const size_t nu = s->e->nu, m = s->p->rank;
    ct_ex *g = CT_NEWN(a, ct_ex, m + 1), *Q = CT_NEWN(a, ct_ex, nu + 1);
    ct_ex *const a_of[] = {c->a, c->better_a}, *const lam_of[] = {c->lam, c->better_lam};
    for (size_t i = 0; i < m; i++)
        g[i] = ct_ex_neg(s->x, s->e->row[s->row[i]].gam);
    solve(s, s->e->Q, g, a_of[0], lam_of[0]);
    residual(s, c->a, c->lam, c->residual);
    for (size_t i = 0; i < nu; i++)
        Q[i] = ct_ex_neg(s->x, c->residual[i]);
    for (size_t i = 0; i < m; i++)
        g[i] = ct_ex_neg(s->x, c->residual[nu + i]);
    solve(s, Q, g, a_of[1], lam_of[1]);
    for (size_t i = 0; i < nu; i++)
        c->better_a[i] = ct_ex_add(s->x, c->a[i], c->better_a[i]);
    for (size_t i = 0; i < m; i++)
        c->better_lam[i] = ct_ex_add(s->x, c->lam[i], c->better_lam[i]);
    residual(s, c->better_a, c->better_lam, c->better_residual);
}

static void derive_projections(struct elimination *s, struct ct_closed *c)
{
    const size_t m = s->p->rank;
    ct_ex *r = CT_NEWN(s->a, ct_ex, m + 1);
    for (size_t i = 0; i < m; i++)
        r[i] = ct_ex_neg(s->x, s->e->row[s->row[i]].phi);
    solve_rows(s, r, c->dq);
    for (size_t i = 0; i < m; i++)
        r[i] = ct_ex_neg(s->x, s->e->row[s->row[i]].v);
    solve_rows(s, r, c->du);
}

// Operations of the better order, which may be wanted.
static double predict(const struct elimination *s, struct ct_arena *scratch,
                      enum ct_kkt_order *best)
{
    double least = INFINITY;
    for (int order = 0; order < CT_KKT_NORDER; order++) {
        const struct ct_kkt *k = ct_kkt_factor(scratch, NULL, s->M, s->e->nu, s->J, s->p->rank,
                                               (enum ct_kkt_order)order, 0);
        if (!k || k->operations >= least)
            continue;
        least = k->operations;
        if (best)
            *best = (enum ct_kkt_order)order;
    }
    return least;
}

double ct_closed_predict(struct ct_arena *scratch, struct ct_exs *x,
                         const struct ct_equations *e, const struct ct_partition *p,
                         const double *M, const double *J)
{
    struct elimination s = create(scratch, x, e, p);
    read_matrices(&s, M, J);
    return predict(&s, scratch, NULL);
}

struct ct_closed *ct_closed_derive(struct ct_arena *a, struct ct_exs *x,
                                   const struct ct_equations *e, const struct ct_partition *p,
                                   const double *M, const double *J, enum ct_closed_way way,
                                   size_t most_nodes)
{
    struct elimination s = create(a, x, e, p);
    const size_t most = x->nnode + most_nodes, nu = e->nu, m = p->rank;
    read_matrices(&s, M, J);
    if (!eliminate(&s, most))
        return NULL;
    if (way == CT_CLOSED_WHOLE) {
        enum ct_kkt_order order = CT_KKT_DEGREE;
        predict(&s, a, &order);
        s.whole = ct_kkt_factor(a, x, s.M, nu, s.J, m, order, most);
        if (!s.whole)
            return NULL;
    } else {
        derive_B(&s);
        if (!reduce(&s, most))
            return NULL;
    }
    struct ct_closed *c = CT_NEW(a, struct ct_closed);
    *c = (struct ct_closed){.rank = m, .nfree = p->nfree, .row = s.row};
    ct_ex **const speeds[] = {&c->a, &c->better_a, &c->dq, &c->du};
    for (size_t i = 0; i < COUNT(speeds); i++)
        *speeds[i] = CT_NEWN(a, ct_ex, nu + 1);
    c->lam = CT_NEWN(a, ct_ex, m + 1);
    c->better_lam = CT_NEWN(a, ct_ex, m + 1);
    c->residual = CT_NEWN(a, ct_ex, nu + m + 1);
    c->better_residual = CT_NEWN(a, ct_ex, nu + m + 1);
    derive_accelerations(&s, c);
    derive_projections(&s, c);
    list_pivots(&s, c);
    return x->nnode > most ? NULL : c;
}
