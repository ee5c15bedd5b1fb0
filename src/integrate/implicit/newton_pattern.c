// Symbolic analysis of the sparse Newton matrix: sparsity pattern and elimination order; see
// newton_sparse.h.
#include "integrate/implicit/newton_pattern.h"

#include "numeric/inverse.h"

#include <string.h>

enum part { S, X, W };

// ---- entries and terms --------------------------------------------------------------------------

// Entries in the order in which they are found, with repetitions. The target of a term is an index
// into this list until the pattern is known.
struct entries {
    struct ct_arena *a;
    int *row, *column, *part;
    size_t n, row_cap, column_cap, part_cap;
};

static int add_entry(struct entries *s, enum part part, int row, int column)
{
    size_t n = s->n;
    CT_PUSH(s->a, s->row, n, s->row_cap, row);
    n = s->n;
    CT_PUSH(s->a, s->column, n, s->column_cap, column);
    n = s->n;
    CT_PUSH(s->a, s->part, n, s->part_cap, (int)part);
    return (int)s->n++;
}

static const int *find_rows(struct ct_arena *a, const struct ct_newton_list *A, int nrow)
{
    int *start = CT_NEWN(a, int, nrow + 1);
    for (int i = 0; i < A->n; i++)
        start[A->row[i] + 1]++;
    for (int i = 0; i < nrow; i++)
        start[i + 1] += start[i];
    return start;
}

static void fill_lists(struct ct_arena *a, struct ct_newton_pattern *p)
{
    const struct ct_jacobian_pattern *s = p->jacobian_pattern;
    struct ct_newton_list *const list[] = {&p->K, &p->C, &p->M, &p->R, &p->D, &p->J};
    const int n[] = {s->nK, s->nC, s->nM, s->nR, s->nD, s->nJ};
    for (size_t i = 0; i < COUNT(list); i++) {
        *list[i] = (struct ct_newton_list){.row = s->row + p->nvalue,
                                           .column = s->column + p->nvalue,
                                           .first = p->nvalue,
                                           .n = n[i]};
        p->nvalue += n[i];
        if (list[i] != &p->D && list[i] != &p->J)
            list[i]->start = find_rows(a, list[i], p->nu + p->nauxiliary);
    }
}

// Where row i of K, C, M or R is in the matrix.
static int row_of(const struct ct_newton_pattern *p, int i)
{
    return i < p->nu ? i : p->first_auxiliary + i - p->nu;
}

// A list at row `first`, columns from `column` on.
static void add_copies(struct ct_newton_pattern *p, struct entries *s, enum part part,
                       const struct ct_newton_list *A, int first, int column)
{
    for (int i = 0; i < A->n; i++) {
        const int row = first ? first + A->row[i] : row_of(p, A->row[i]);
        const struct ct_newton_copy c
            = {add_entry(s, part, row, column + A->column[i]), A->first + i, 1};
        CT_PUSH(s->a, p->copy, p->ncopy, p->copy_cap, c);
    }
}

// -J', in the last columns.
static void add_transposed(struct ct_newton_pattern *p, struct entries *s)
{
    const struct ct_newton_list *J = &p->J;
    for (int i = 0; i < J->n; i++) {
        const int column = p->first_auxiliary - p->most_rows + J->row[i];
        const struct ct_newton_copy c
            = {add_entry(s, S, J->column[i], column), J->first + i, -1};
        CT_PUSH(s->a, p->copy, p->ncopy, p->copy_cap, c);
    }
}

// Entries of a list by column: entry[start[k]] ... entry[start[k + 1] - 1]
struct by_column {
    int *start, *entry;
};

static struct by_column sort_by_column(struct ct_arena *a, const struct ct_newton_list *A,
                                       int nu)
{
    struct by_column c = {CT_NEWN(a, int, nu + 2), CT_NEWN(a, int, A->n + 1)};
    for (int i = 0; i < A->n; i++)
        c.start[A->column[i] + 2]++;
    for (int k = 2; k < nu + 2; k++)
        c.start[k] += c.start[k - 1];
    for (int i = 0; i < A->n; i++)
        c.entry[c.start[A->column[i] + 1]++] = i;
    return c;
}

// -A J' at row `first`, in the columns of eta.
static void add_products(struct ct_newton_pattern *p, struct entries *s, enum part part,
                         const struct ct_newton_list *A, int first)
{
    const struct by_column by = sort_by_column(s->a, A, p->nu);
    const struct ct_newton_list *J = &p->J;
    for (int j = 0; j < J->n; j++)
        for (int k = by.start[J->column[j]]; k < by.start[J->column[j] + 1]; k++) {
            const int i = by.entry[k];
            const int row = first ? first + A->row[i] : row_of(p, A->row[i]);
            const int target = add_entry(s, part, row, p->nu + J->row[j]);
            const struct ct_newton_product x = {target, A->first + i, J->first + j};
            CT_PUSH(s->a, p->product, p->nproduct, p->product_cap, x);
        }
}

static void add_rotation(struct ct_newton_pattern *p, struct entries *s, enum part part,
                         int row, int column, int a, int speed, double half)
{
    const struct ct_newton_rotation t = {add_entry(s, part, row, column), a, speed, half};
    CT_PUSH(s->a, p->rotation, p->nrotation, p->rotation_cap, t);
}

// -A N at row `first`: of a rotation's three columns a, b, c become (b w2 - c w1, c w0 - a w2, a w1
// - b w0)/2.
static void add_rotations(struct ct_newton_pattern *p, struct entries *s, const int *q_of,
                          enum part part, const struct ct_newton_list *A, int first)
{
    const struct by_column by = sort_by_column(s->a, A, p->nu);
    for (int k = 0; k < p->nu; k++) {
        if (q_of[k] != CT_MOVES_ROTATION)
            continue;
        for (int i = 0; i < 3; i++) {
            const int next = (i + 1) % 3, other = (i + 2) % 3;
            for (int l = by.start[k + i]; l < by.start[k + i + 1]; l++) {
                const int of = A->row[by.entry[l]], a = A->first + by.entry[l];
                const int row = first ? first + of : row_of(p, of);
                add_rotation(p, s, part, row, k + next, a, k + other, -0.5);
                add_rotation(p, s, part, row, k + other, a, k + next, 0.5);
            }
        }
        k += 2;
    }
}

static void add_terms(struct ct_newton_pattern *p, struct entries *s, const int *q_of)
{
    const int nu = p->nu, below = nu + p->most_rows;
    add_copies(p, s, S, &p->M, 0, 0);
    add_copies(p, s, X, &p->C, 0, 0);
    add_copies(p, s, W, &p->K, 0, 0);
    add_copies(p, s, S, &p->R, 0, p->first_auxiliary);
    add_copies(p, s, S, &p->J, nu, 0);
    add_transposed(p, s);
    if (!p->is_stabilised)
        return;
    add_copies(p, s, S, &p->J, below, 0);
    add_copies(p, s, W, &p->D, below, 0);
    add_products(p, s, S, &p->M, 0);
    add_products(p, s, X, &p->C, 0);
    add_products(p, s, S, &p->J, below);
    add_rotations(p, s, q_of, X, &p->M, 0);
    add_rotations(p, s, q_of, W, &p->C, 0);
    add_rotations(p, s, q_of, W, &p->J, below);
}

// Replaces targets by their index in the pattern: part * nz + entry.
static void resolve_targets(struct ct_newton_pattern *p, struct ct_arena *a,
                            const struct entries *s)
{
    int *entry = CT_NEWN(s->a, int, s->n + 1);
    p->pattern = ct_pattern_create(a, p->n, s->row, s->column, (int)s->n, entry);
    const int nz = p->pattern->nz;
    for (size_t i = 0; i < p->ncopy; i++)
        p->copy[i].target = s->part[p->copy[i].target] * nz + entry[p->copy[i].target];
    for (size_t i = 0; i < p->nproduct; i++)
        p->product[i].target = s->part[p->product[i].target] * nz + entry[p->product[i].target];
    for (size_t i = 0; i < p->nrotation; i++)
        p->rotation[i].target
            = s->part[p->rotation[i].target] * nz + entry[p->rotation[i].target];
    for (int i = 0; i < p->n - p->nu; i++)
        p->index[i] = entry[p->index[i]];
}

// ---- numbers ------------------------------------------------------------------------------------

void ct_newton_pattern_assemble(const struct ct_newton_pattern *p, double *A, const double *v,
                                const double *w)
{
    memset(A, 0, CT_NEWTON_PARTS * (size_t)p->pattern->nz * sizeof *A);
    for (size_t i = 0; i < p->ncopy; i++)
        A[p->copy[i].target] += p->copy[i].sign * v[p->copy[i].a];
    for (size_t i = 0; i < p->nproduct; i++)
        A[p->product[i].target] -= v[p->product[i].a] * v[p->product[i].b];
    for (size_t i = 0; w && i < p->nrotation; i++)
        A[p->rotation[i].target]
            += p->rotation[i].half * v[p->rotation[i].a] * w[p->rotation[i].speed];
    for (int i = p->first_auxiliary; i < p->n; i++)
        A[p->index[i - p->nu]] = -1;
}

void ct_newton_pattern_form(const struct ct_newton_pattern *p, double *G, const double *A,
                            double c, double e)
{
    const int nz = p->pattern->nz, *row = p->pattern->row;
    const double x = c / e, y = 1 / e, z = 1 / c;
    for (int i = 0; i < nz; i++)
        G[i] = A[i] + x * A[i + nz]
             + (ct_newton_pattern_is_force(p, row[i]) ? y : z) * A[i + 2 * nz];
}

// Random values with large diagonals, for the analysis of the pattern before real values are known.
// They are the same each time.
static void set_random_values(const struct ct_newton_pattern *p, double *v)
{
    unsigned long long seed = 1;
    for (int i = 0; i < p->nvalue; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        v[i] = (double)(seed >> 11) / (double)(1ull << 52) - 1;
    }
    const struct ct_newton_list *const heavy[] = {&p->M, &p->K};
    const double much = 100; // Derived: outweighs a hundred other entries of its row
    for (size_t k = 0; k < COUNT(heavy); k++)
        for (int i = 0; i < heavy[k]->n; i++)
            if (heavy[k]->row[i] == heavy[k]->column[i])
                v[heavy[k]->first + i] += much;
}

// A graph whose nodes are speeds, auxiliary unknowns and constraint rows, for the elimination
// order.
static struct ct_pattern *find_graph(const struct ct_newton_pattern *p,
                                     struct ct_arena *scratch)
{
    const struct ct_newton_list *const lists[] = {&p->M, &p->C, &p->K, &p->R, &p->J, &p->J};
    const int nunknown = p->nu + p->nauxiliary, nnode = nunknown + p->most_rows;
    struct entries s = {.a = scratch};
    for (size_t k = 0; k < COUNT(lists); k++)
        for (int i = 0; i < lists[k]->n; i++) {
            const int row = lists[k]->row[i] + (k < 4 ? 0 : nunknown),
                      column = lists[k]->column[i] + (k == 3 ? p->nu : 0);
            add_entry(&s, S, k < 5 ? row : column, k < 5 ? column : row);
        }
    for (int i = 0; i < nnode; i++)
        add_entry(&s, S, i, i);
    int *entry = CT_NEWN(scratch, int, s.n);
    return ct_pattern_create(scratch, nnode, s.row, s.column, (int)s.n, entry);
}

// first (n, out): the elimination order of speeds and auxiliary unknowns with little fill. The
// multipliers of a row follow the last speed in that row, where elimination has made their diagonal
// entry nonzero.
static bool find_first(const struct ct_newton_pattern *p, struct ct_arena *scratch, int *first)
{
    const int most_rows = p->most_rows, nunknown = p->nu + p->nauxiliary;
    int *node = CT_NEWN(scratch, int, nunknown + most_rows),
        *last = CT_NEWN(scratch, int, most_rows + 1);
    int *rank = CT_NEWN(scratch, int, nunknown + most_rows), n = 0, at = 0;
    if (!ct_pattern_minimum_degree(find_graph(p, scratch), node))
        return false;
    for (int i = 0; i < nunknown + most_rows; i++)
        rank[node[i]] = node[i] < nunknown ? at++ : 0;
    for (int i = 0; i < p->J.n; i++)
        if (last[p->J.row[i]] < rank[p->J.column[i]])
            last[p->J.row[i]] = rank[p->J.column[i]];
    const struct ct_newton_list rows = {.row = NULL, .column = last, .n = most_rows};
    const struct by_column after = sort_by_column(scratch, &rows, nunknown);
    for (int i = 0; i < nunknown + most_rows; i++) {
        if (node[i] >= nunknown)
            continue;
        first[n++] = row_of(p, node[i]);
        for (int k = after.start[rank[node[i]]]; k < after.start[rank[node[i]] + 1]; k++)
            for (int j = p->nu + after.entry[k]; j < p->first_auxiliary; j += most_rows)
                first[n++] = j;
    }
    return true;
}

static bool find_order(struct ct_newton_pattern *p, struct ct_arena *a,
                       struct ct_arena *scratch)
{
    int *first = CT_NEWN(scratch, int, p->n);
    if (!find_first(p, scratch, first))
        return false;

    double *v = CT_NEWN(scratch, double, p->nvalue + 1);
    double *w = CT_NEWN(scratch, double, p->nu + 1);
    double *A = CT_NEWN(scratch, double, CT_NEWTON_PARTS * p->pattern->nz + 1);
    set_random_values(p, v);
    for (int k = 0; k < p->nu; k++)
        w[k] = 1;
    ct_newton_pattern_assemble(p, A, v, w);
    ct_newton_pattern_form(p, A, A, 1, 1);
    return ct_pattern_order(a, p->pattern, A, first);
}

// ---- comparison with dense matrices -------------------------------------------------------------

static struct ct_newton_work sparse_work(const struct ct_newton_pattern *p)
{
    const double nterm = (double)(p->ncopy + p->nproduct + p->nrotation), nz = p->pattern->nz;
    return (struct ct_newton_work){
        .assembly = CT_SPARSE_OPERATION_COST * (nterm + CT_NEWTON_PARTS * nz),
        .factorization
        = CT_SPARSE_OPERATION_COST * (p->pattern->operations + 2 * CT_NEWTON_PARTS * nz),
        .solution = CT_SPARSE_OPERATION_COST * 2 * p->pattern->fill,
    };
}

static struct ct_newton_work full_work(double n)
{
    return (struct ct_newton_work){
        .assembly = 4 * n * n, .factorization = 2. / 3 * n * n * n, .solution = 2 * n * n};
}

struct ct_newton_work ct_newton_work(const struct ct_newton_pattern *plan, int n)
{
    return plan ? sparse_work(plan) : full_work(n);
}

// Operations of a step with new derivatives and the usual number of solutions.
static double work_of_step(struct ct_newton_work w)
{
    // Derived: the median number of corrections a factorisation of radau5 on the shipped systems.
    const double solutions = 15;
    return w.assembly + w.factorization + solutions * w.solution;
}

// May the sparse form take fewer operations than the dense one? Found from counts alone, before
// products are listed.
static bool may_pay(const struct ct_newton_pattern *p, struct ct_arena *scratch)
{
    const struct ct_newton_list *const lists[] = {&p->M, &p->C, &p->J};
    double nproduct = 0, nentry = p->M.n + p->C.n + p->K.n + p->R.n;
    for (size_t i = 0; i < COUNT(lists) && p->is_stabilised; i++) {
        const struct by_column by = sort_by_column(scratch, lists[i], p->nu);
        for (int j = 0; j < p->J.n; j++) {
            const int k = p->J.column[j];
            nproduct += by.start[k + 1] - by.start[k];
        }
    }
    return CT_SPARSE_OPERATION_COST * (nproduct + nentry)
         < work_of_step(full_work(p->first_auxiliary));
}

static void *copy_to_arena(struct ct_arena *a, const void *x, size_t n, size_t size)
{
    void *kept = ct_arena_calloc(a, n + 1, size);
    return n ? memcpy(kept, x, n * size) : kept;
}

// The symbolic analysis, with temporary data in `scratch`.
static struct ct_newton_pattern *make(struct ct_arena *a, struct ct_arena *scratch,
                                      const struct ct_dae *dae, bool is_stabilised, bool anyway)
{
    struct ct_newton_pattern *p = CT_NEW(a, struct ct_newton_pattern);
    struct entries s = {.a = scratch};
    p->jacobian_pattern = dae->jacobian_pattern;
    p->nu = dae->nu;
    p->most_rows = dae->most_rows;
    p->nauxiliary = dae->jacobian_pattern->nauxiliary;
    p->first_auxiliary = dae->nu + (is_stabilised ? 2 : 1) * dae->most_rows;
    p->n = p->first_auxiliary + p->nauxiliary;
    p->is_stabilised = is_stabilised;
    p->index = CT_NEWN(a, int, p->n - p->nu + 1);
    fill_lists(a, p);
    if (!anyway && !may_pay(p, scratch))
        return NULL;
    add_terms(p, &s, dae->q_of);
    for (int i = 0; i < p->n - p->nu; i++)
        p->index[i] = add_entry(&s, S, p->nu + i, p->nu + i);
    resolve_targets(p, a, &s);
    // Limit: patterns that are more than half full are not ordered, the dense matrix serves
    // instead.
    const double n = p->first_auxiliary, most = 0.5;
    const bool is_dense
        // auxiliary unknowns are there to make it sparse
        = p->pattern->nz > most * n * n && !p->nauxiliary;
    if ((!anyway && is_dense) || !find_order(p, a, scratch)
        || (!anyway && work_of_step(sparse_work(p)) > work_of_step(full_work(n))))
        return NULL;
    if (p->nauxiliary) {
        const struct by_column M = sort_by_column(a, &p->M, p->nu);
        p->M_start = M.start;
        p->M_entry = M.entry;
    }
    p->copy = copy_to_arena(a, p->copy, p->ncopy, sizeof *p->copy);
    p->product = copy_to_arena(a, p->product, p->nproduct, sizeof *p->product);
    p->rotation = copy_to_arena(a, p->rotation, p->nrotation, sizeof *p->rotation);
    return p;
}

static struct ct_newton_pattern *plan(struct ct_arena *a, const struct ct_dae *dae,
                                      bool is_stabilised, bool anyway)
{
    if (!dae->jacobian_pattern || dae->nu <= CT_MOST_INVERTED) // inverses serve those
        return NULL;
    struct ct_arena *scratch = ct_arena_create_under(a);
    struct ct_newton_pattern *p = make(a, scratch, dae, is_stabilised, anyway);
    ct_arena_destroy(scratch);
    return p;
}

struct ct_newton_pattern *ct_newton_pattern_create(struct ct_arena *a, const struct ct_dae *dae,
                                                   bool is_stabilised)
{
    return plan(a, dae, is_stabilised, false);
}

struct ct_newton_pattern *ct_newton_pattern_create_always(struct ct_arena *a,
                                                          const struct ct_dae *dae,
                                                          bool is_stabilised)
{
    return plan(a, dae, is_stabilised, true);
}
