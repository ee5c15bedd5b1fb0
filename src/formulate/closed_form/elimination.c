// See elimination.h.
#include "formulate/closed_form/elimination.h"

#include "formulate/closed_form/block_elimination.h"
#include "formulate/closed_form/beam_augmented.h"
#include "formulate/closed_form/projection_step.h"
#include "formulate/closed_form/kkt.h"
#include "formulate/operation_count.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct elimination {
    struct ct_arena *a;
    struct ct_exs *x;
    const struct ct_equations *e;
    const struct ct_partition_sets *p;
    int *row;                    // kept rows, ascending
    int *kept_number;            // by row: its number among the kept rows plus one; 0: not kept
    struct ct_probed_row *J, *M; // (rank), as given; (nu), both triangles
    struct ct_blocks d;          // J_d
    struct ct_kkt *whole;        // all equations as one system; NULL: coordinate partitioning
    struct ct_kkt_system system; // the system that is factored in whole
    bool is_augmented;           // the system is that of beam_augmented.h
    ct_ex *B;                    // (nu x nfree), with unit rows for independent speeds
    size_t *first;               // its entries by column: rows B_row[first[j] ...]
    int *B_row;
    ct_ex *S;      // (nfree x nfree) factors L' D L of B' M B: D on the diagonal, L below it
    size_t *order; // (nfree) of the pivots of S, the first one last
};

// ---- lines --------------------------------------------------------------------------------------

static int ascending(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

static void put_both(struct elimination *s, struct ct_probed_row *M, const struct ct_entry *e,
                     double number)
{
    ct_probed_row_append(s->a, &M[e->row], e->column, e->value, number);
    if (e->row != e->column)
        ct_probed_row_append(s->a, &M[e->column], e->row, e->value, number);
}

static void read_matrices(struct elimination *s, const double *M, const double *J)
{
    const struct ct_equations *e = s->e;
    const int *number = s->kept_number;
    for (size_t i = 0; i < e->nJ; i++)
        if (number[e->J[i].row]) {
            const int r = number[e->J[i].row] - 1;
            ct_probed_row_append(s->a, &s->J[r], e->J[i].column, e->J[i].value, J[i]);
            ct_probed_row_append(s->a, &s->d.left[r], e->J[i].column, e->J[i].value, J[i]);
        }
    for (size_t i = 0; i < e->nM; i++)
        put_both(s, s->M, &e->M[i], M[i]);
    ct_probed_rows_sort(s->J, s->p->rank);
    ct_probed_rows_sort(s->d.left, s->p->rank);
    ct_probed_rows_sort(s->M, e->nu);
}

static void list_values(const struct ct_entry *e, size_t n, ct_ex *out)
{
    for (size_t i = 0; i < n; i++)
        out[i] = e[i].value;
}

// Reads the rows of beam_augmented.h, L after J_c.
static struct ct_kkt_system read_augmented(struct elimination *s)
{
    const struct ct_beam_augmented *c = s->e->augmented;
    const size_t n = c->nM + c->nJ + c->nL, nu = s->e->nu;
    struct ct_kkt_system k
        = {.n = c->n, .m = s->p->rank + c->n - nu, .threshold = CT_TIGHT_PIVOT};
    int *position = CT_NEWN(s->a, int, k.n + k.m + 1);
    ct_ex *v = CT_NEWN(s->a, ct_ex, n + 1);
    double *number = CT_NEWN(s->a, double, n + 1), *of_J = number + c->nM, *of_L = of_J + c->nJ;
    struct ct_arena *scratch = ct_arena_create_under(s->a);
    k.M = CT_NEWN(s->a, struct ct_probed_row, k.n + 1);
    k.J = CT_NEWN(s->a, struct ct_probed_row, k.m + 1);
    list_values(c->M, c->nM, v);
    list_values(c->J, c->nJ, v + c->nM);
    list_values(c->L, c->nL, v + c->nM + c->nJ);
    ct_ex_values(s->x, scratch, v, n, s->p->value, number);
    ct_arena_destroy(scratch);
    for (size_t i = 0; i < c->nM; i++)
        put_both(s, k.M, &c->M[i], number[i]);
    for (size_t i = 0; i < c->nJ; i++)
        if (s->kept_number[c->J[i].row])
            ct_probed_row_append(s->a, &k.J[s->kept_number[c->J[i].row] - 1], c->J[i].column,
                                 c->J[i].value, of_J[i]);
    for (size_t i = 0; i < c->nL; i++)
        ct_probed_row_append(s->a, &k.J[s->p->rank + (size_t)c->L[i].row - nu], c->L[i].column,
                             c->L[i].value, of_L[i]);
    ct_probed_rows_sort(k.M, k.n);
    ct_probed_rows_sort(k.J, k.m);
    memcpy(position, c->position_along, c->n * sizeof *position);
    for (size_t i = 0; i < k.m; i++) // an equation is placed next to its unknown
        position[c->n + i] = i < s->p->rank ? INT_MAX : position[nu + i - s->p->rank];
    k.position_along = position;
    return k;
}

// ---- reduced equations --------------------------------------------------------------------------

// Pairwise sum, so that many terms do not form one long dependency chain.
static ct_ex sum(struct ct_exs *x, ct_ex *term, size_t n)
{
    for (; n > 1; n = (n + 1) / 2)
        for (size_t i = 0; i < n / 2; i++)
            term[i] = ct_ex_add(x, term[i], term[n - 1 - i]);
    return n ? term[0] : CT_EX_ZERO;
}

// y (out) = A x for a sparse matrix of n rows.
static void apply(struct elimination *s, const struct ct_probed_row *A, size_t n,
                  const ct_ex *x, ct_ex *y)
{
    for (size_t i = 0; i < n; i++) {
        y[i] = CT_EX_ZERO;
        for (size_t k = 0; k < A[i].n; k++)
            y[i] = ct_ex_add_product(s->x, y[i], A[i].e[k].value, x[A[i].e[k].column]);
    }
}

static ct_ex dot_column(struct elimination *s, size_t j, const ct_ex *v, ct_ex *term)
{
    size_t n = 0;
    for (size_t k = s->first[j]; k < s->first[j + 1]; k++) {
        const int i = s->B_row[k];
        term[n] = ct_ex_mul(s->x, s->B[(size_t)i + s->e->nu * j], v[i]);
        n += !ct_ex_is_zero(term[n]);
    }
    return sum(s->x, term, n);
}

static void derive_B(struct elimination *s)
{
    const size_t nu = s->e->nu;
    size_t n = 0, cap = 0;
    s->B = CT_NEWN(s->a, ct_ex, nu * (s->p->nfree + 1));
    s->first = CT_NEWN(s->a, size_t, s->p->nfree + 1);
    for (size_t j = 0; j < s->p->nfree; j++) {
        ct_ex *x = s->B + nu * j;
        const int column = s->p->independent[j];
        ct_blocks_solve_column(&s->d, column, x);
        x[column] = CT_EX_ONE;
        for (size_t i = 0; i < nu; i++)
            if (!ct_ex_is_zero(x[i]))
                CT_PUSH(s->a, s->B_row, n, cap, (int)i);
        s->first[j + 1] = n;
    }
}

// The entry of the symmetric S for two free columns.
static ct_ex *S_at(const struct elimination *s, size_t i, size_t j)
{
    return &s->S[(i > j ? i : j) + s->p->nfree * (i > j ? j : i)];
}

// Number of products to factor S, from its pattern. The order is from the last column to the first
// or by least degree; order (nfree, out).
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

// Chooses the cheaper order. A beam in a loop has a sparse S, but columns next to the cut are
// coupled with all others and must come last.
static void choose_order(struct elimination *s)
{
    size_t *last_first = CT_NEWN(s->a, size_t, s->p->nfree + 1);
    s->order = CT_NEWN(s->a, size_t, s->p->nfree + 1);
    if (eliminate_pattern(s, false, last_first) <= eliminate_pattern(s, true, s->order))
        s->order = last_first;
}

// Factors B' M B = L' D L; false if the node limit is reached.
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
            ct_ex *off_diagonal = S_at(s, k, s->order[i]);
            if (ct_ex_is_zero(*off_diagonal))
                continue;
            const ct_ex l = ct_ex_div(s->x, *off_diagonal, *S_at(s, k, k));
            for (size_t j = 0; j <= i; j++) {
                ct_ex *entry = S_at(s, s->order[i], s->order[j]);
                *entry = ct_ex_sub_product(s->x, *entry, l, *S_at(s, k, s->order[j]));
            }
            *off_diagonal = l;
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
            z[to] = ct_ex_sub_product(s->x, z[to], *S_at(s, k, to), z[k]);
        }
    for (size_t at = 0; at < f; at++) {
        const size_t k = s->order[at];
        z[k] = ct_ex_div(s->x, z[k], *S_at(s, k, k));
        for (size_t i = 0; i < at; i++)
            z[k] = ct_ex_sub_product(s->x, z[k], *S_at(s, k, s->order[i]), z[s->order[i]]);
    }
}

// Solves with the factors of all equations.
static void solve_whole(struct elimination *s, const ct_ex *Q, const ct_ex *g, ct_ex *a,
                        ct_ex *lam)
{
    const size_t nu = s->e->nu, m = s->p->rank, n = s->whole->n;
    const size_t first = s->is_augmented ? s->e->augmented->n : nu; // multiplier
    ct_ex *b = CT_NEWN(s->a, ct_ex, n + 1), *y = CT_NEWN(s->a, ct_ex, n + 1);
    memcpy(b, Q, nu * sizeof *b);
    if (m)
        memcpy(b + first, g, m * sizeof *b);
    ct_kkt_solve(s->whole, s->x, b, y);
    memcpy(a, y, nu * sizeof *a);
    for (size_t i = 0; i < m; i++)
        lam[i] = ct_ex_neg(s->x, y[first + i]);
}

// a (nu, out), lam (rank, out): M a - J' lam = Q (nu), J a = g (rank; overwritten).
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
    ct_blocks_solve(&s->d, g, c);
    apply(s, s->M, nu, c, w);
    for (size_t i = 0; i < nu; i++)
        w[i] = ct_ex_sub(x, Q[i], w[i]);
    for (size_t j = 0; j < f; j++)
        z[j] = dot_column(s, j, w, term);
    solve_reduced(s, z);
    for (size_t i = 0; i < nu; i++) {
        a[i] = c[i];
        for (size_t j = 0; j < f; j++)
            a[i] = ct_ex_add_product(x, a[i], s->B[i + nu * j], z[j]);
    }
    apply(s, s->M, nu, a, w);
    for (size_t i = 0; i < nu; i++)
        w[i] = ct_ex_sub(x, w[i], Q[i]);
    ct_blocks_solve_transposed(&s->d, w, lam);
}

// r (nu, out) = M a; by M_c if it has fewer entries.
static void apply_mass(struct elimination *s, const ct_ex *a, ct_ex *r)
{
    const size_t nu = s->e->nu;
    if (!s->is_augmented) {
        apply(s, s->M, nu, a, r);
        return;
    }
    const struct ct_beam_augmented *c = s->e->augmented;
    ct_ex *y = CT_NEWN(s->a, ct_ex, c->n + 1), *f = CT_NEWN(s->a, ct_ex, c->n + 1);
    memcpy(y, a, nu * sizeof *y);
    ct_beam_augmented_extend(s->x, s->a, c, y);
    apply(s, s->system.M, c->n, y, f);
    ct_beam_augmented_project(s->x, s->a, c, f);
    memcpy(r, f, nu * sizeof *r);
}

// r (nu + rank, out) = M a - Q - J' lam, J a + gam.
static void residual(struct elimination *s, const ct_ex *a, const ct_ex *lam, ct_ex *r)
{
    const size_t nu = s->e->nu, m = s->p->rank;
    apply_mass(s, a, r);
    for (size_t i = 0; i < nu; i++)
        r[i] = ct_ex_sub(s->x, r[i], s->e->Q[i]);
    for (size_t i = 0; i < m; i++)
        for (size_t k = 0; k < s->J[i].n; k++) {
            ct_ex *to = &r[s->J[i].e[k].column];
            *to = ct_ex_sub_product(s->x, *to, s->J[i].e[k].value, lam[i]);
        }
    apply(s, s->J, m, a, r + nu);
    for (size_t i = 0; i < m; i++)
        r[nu + i] = ct_ex_add(s->x, r[nu + i], s->e->row[s->row[i]].gam);
}

// ---- entries ------------------------------------------------------------------------------------

static struct elimination create(struct ct_arena *a, struct ct_exs *x,
                                 const struct ct_equations *e,
                                 const struct ct_partition_sets *p)
{
    struct elimination s = {.a = a, .x = x, .e = e, .p = p};
    const size_t m = p->rank;
    s.row = CT_NEWN(a, int, m + 1);
    memcpy(s.row, p->row, m * sizeof *s.row);
    qsort(s.row, m, sizeof *s.row, ascending);
    s.kept_number = CT_NEWN(a, int, e->nrow + 1);
    for (size_t i = 0; i < m; i++)
        s.kept_number[s.row[i]] = (int)i + 1;
    s.J = CT_NEWN(a, struct ct_probed_row, m + 1);
    s.M = CT_NEWN(a, struct ct_probed_row, e->nu + 1);
    s.d = ct_blocks_create(a, x, m, e->nu);
    for (size_t i = 0; i < m; i++) {
        s.d.group[i] = e->row[s.row[i]].joint;
        s.d.block_of[p->dependent[i]] = CT_BLOCK_OPEN;
    }
    for (size_t i = 0; i < p->nfree; i++)
        s.d.block_of[p->independent[i]] = CT_BLOCK_NEVER;
    return s;
}

static void list_pivots(const struct elimination *s, struct ct_closed *c)
{
    c->pivot = CT_NEWN(s->a, ct_ex, s->d.nblock + 1);
    c->scale = CT_NEWN(s->a, double, s->d.nblock + 1);
    for (size_t k = 0; k < s->d.nblock; k++)
        if (ct_blocks_moves(&s->d, s->d.block[k].pivot)) {
            c->scale[c->npivot] = s->d.block[k].strength / fabs(s->d.block[k].pivot_number);
            c->pivot[c->npivot++] = s->d.block[k].pivot;
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
        if (s->d.block_of[i % s->e->nu] >= 0 && !ct_ex_is_zero(s->B[i]))
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

// Factors by pattern only, in the best of the orders. NULL if it takes `most` operations or more,
// or is singular.
static const struct ct_kkt *predict(const struct ct_kkt_system *k, struct ct_arena *scratch,
                                    double most, enum ct_kkt_order *best)
{
    const struct ct_kkt *least = NULL;
    for (int order = 0; order < CT_KKT_NORDER; order++) {
        const double below = least ? least->operations : most;
        const struct ct_kkt *found
            = ct_kkt_factor(scratch, NULL, k, (enum ct_kkt_order)order,
                            order == CT_KKT_POSITIONS ? CT_CLEARLY_CHEAPER * below : below);
        if (!found)
            continue;
        least = found;
        *best = (enum ct_kkt_order)order;
    }
    return least;
}

// Operation count of the entries and Q together, as they share subexpressions.
static double count_entries(struct elimination *s, const struct ct_entry *A, size_t nA,
                            const struct ct_entry *B, size_t nB, const struct ct_entry *C,
                            size_t nC)
{
    const size_t nu = s->e->nu;
    ct_ex *v = CT_NEWN(s->a, ct_ex, nu + nA + nB + nC + 1);
    memcpy(v, s->e->Q, nu * sizeof *v);
    list_values(A, nA, v + nu);
    list_values(B, nB, v + nu + nA);
    list_values(C, nC, v + nu + nA + nB);
    const size_t n = ct_ex_walk(s->x, v, nu + nA + nB + nC);
    double count = 0;
    for (size_t i = 0; i < n; i++)
        count += ct_op_info[s->x->node[s->x->stack[i]].op].narg > 0;
    return count;
}

// Tries the augmented form, with element starts as unknowns, and takes it if it is shorter.
static void try_augmented(struct elimination *s, struct ct_arena *scratch,
                          struct ct_pivot_order *found)
{
    const struct ct_beam_augmented *c = s->e->augmented;
    const struct ct_equations *e = s->e;
    if (!c || !s->p->value)
        return;
    const double more = count_entries(s, c->M, c->nM, c->J, c->nJ, c->L, c->nL)
                      - count_entries(s, e->M, e->nM, e->J, e->nJ, NULL, 0);
    enum ct_kkt_order order;
    s->system = read_augmented(s);
    const struct ct_kkt *k = predict(&s->system, scratch, found->operations - more, &order);
    if (!k)
        return;
    found->is_augmented = true;
    found->way = order;
    found->operations = k->operations + more;
}

// Operation count of the pivots of J_d, among the nodes of x from `first` on.
static double count_pivots(const struct elimination *s, struct ct_arena *scratch, size_t first)
{
    const struct ct_exs *x = s->x;
    bool *is_used = CT_NEWN(scratch, bool, x->nnode + 1);
    double n = 0;
    for (size_t k = 0; k < s->d.nblock; k++)
        is_used[s->d.block[k].pivot.id] = true;
    for (size_t id = x->nnode; id-- > first;) {
        const struct ct_exnode *e = &x->node[id];
        if (!is_used[id])
            continue;
        const uint32_t child[] = {e->a, e->b, e->c};
        const int narg = ct_op_info[e->op].narg;
        for (int k = 0; k < narg; k++)
            is_used[child[k]] = true;
        n += narg > 0;
    }
    return n;
}

static void list_order(struct ct_pivot_order *found, const struct ct_kkt *k)
{
    for (size_t i = 0, n = 0; i < k->npivot; i++) {
        const struct ct_kkt_pivot *v = &k->pivot[i];
        // [a b; b 0]: the off-diagonal entries are the pivots
        const bool is_crossed = v->size == 2 && ct_ex_is_zero(v->P[2]);
        for (int q = 0; q < v->size; q++, n++) {
            found->row[n] = v->at[is_crossed ? 1 - q : q];
            found->column[n] = v->at[q];
        }
    }
}

struct ct_pivot_order *ct_pivot_order_find(struct ct_arena *a, const struct ct_equations *e,
                                           const struct ct_partition_sets *p, const double *M,
                                           const double *J, double most)
{
    struct ct_arena *scratch = ct_arena_create_under(a);
    struct ct_exs *x = ct_exs_clone(scratch, e->x);
    struct elimination s = create(scratch, x, e, p);
    enum ct_kkt_order order = CT_KKT_DEGREE;
    struct ct_pivot_order *found = NULL;
    read_matrices(&s, M, J);
    const struct ct_kkt_system plain = {s.M, s.J, e->nu, p->rank, CT_LEAST_STRENGTH, NULL};
    const struct ct_kkt *k = predict(&plain, scratch, most, &order);
    struct ct_pivot_order t = {.operations = most};
    if (k) {
        t.row = CT_NEWN(a, int, k->n + 1);
        t.column = CT_NEWN(a, int, k->n + 1);
        t.way = order;
        t.operations = k->operations;
        list_order(&t, k);
    }
    const bool is_regular = ct_blocks_factor(&s.d, SIZE_MAX);
    if (is_regular)
        try_augmented(&s, scratch, &t);
    if (is_regular && (k || t.is_augmented)) {
        found = CT_NEW(a, struct ct_pivot_order);
        *found = t;
        found->operations += count_pivots(&s, scratch, e->x->nnode);
    }
    ct_arena_destroy(scratch);
    return found;
}

struct ct_closed *ct_closed_derive(struct ct_arena *a, struct ct_exs *x,
                                   const struct ct_equations *e,
                                   const struct ct_partition_sets *p, const double *M,
                                   const double *J, enum ct_closed_way way, size_t most_nodes)
{
    struct elimination s = create(a, x, e, p);
    const size_t most = x->nnode + most_nodes, nu = e->nu, m = p->rank;
    read_matrices(&s, M, J);
    if (!ct_blocks_factor(&s.d, most))
        return NULL;
    if (way == CT_CLOSED_KKT) {
        const struct ct_pivot_order *found
            = p->pivots ? p->pivots : ct_pivot_order_find(a, e, p, M, J, (double)most_nodes);
        if (!found)
            return NULL;
        s.is_augmented = found->is_augmented;
        s.system = s.is_augmented
                     ? read_augmented(&s)
                     : (struct ct_kkt_system){s.M, s.J, nu, m, CT_LEAST_STRENGTH, NULL};
        s.whole = ct_kkt_factor(a, x, &s.system, found->way, (double)most);
        if (!s.whole)
            return NULL;
    } else {
        // Limit: refinement and projections need several times the nodes of the factors
        const size_t enough = 20000, third = most_nodes / 3;
        derive_B(&s);
        if (!reduce(&s, third > enough ? x->nnode + third : most))
            return NULL;
    }
    struct ct_closed *c = CT_NEW(a, struct ct_closed);
    *c = (struct ct_closed){.rank = m, .nfree = p->nfree, .row = s.row};
    ct_ex **const speeds[] = {&c->a, &c->better_a, &c->dq, &c->du, &c->shift};
    for (size_t i = 0; i < COUNT(speeds); i++)
        *speeds[i] = CT_NEWN(a, ct_ex, nu + 1);
    c->lam = CT_NEWN(a, ct_ex, m + 1);
    c->better_lam = CT_NEWN(a, ct_ex, m + 1);
    c->residual = CT_NEWN(a, ct_ex, nu + m + 1);
    c->better_residual = CT_NEWN(a, ct_ex, nu + m + 1);
    derive_accelerations(&s, c);
    c->nshift = m < e->nrow ? 0 : nu;
    ct_projection_step_derive(a, x, e, s.row, &s.d, c->dq, c->du, c->nshift ? c->shift : NULL);
    list_pivots(&s, c);
    return x->nnode > most ? NULL : c;
}
