// See damped.h.
#include "numeric/damped.h"

#include "numeric/dense.h"
#include "numeric/sparse.h"

#include <math.h>

// ---- rows ---------------------------------------------------------------------------------------

void ct_sparse_rows_clear(struct ct_sparse_rows *A)
{
    A->n = 0;
    if (A->start)
        A->start[0] = 0;
}

void ct_sparse_rows_add(struct ct_sparse_rows *A, const int *column, const double *value,
                        size_t n, double weight)
{
    size_t at = A->start ? A->start[A->n] : 0, nvalue = at, nstart = A->start ? A->n + 1 : 0;
    if (nstart == 0)
        CT_PUSH(A->arena, A->start, nstart, A->start_cap, 0);
    for (size_t k = 0; k < n; k++) {
        CT_PUSH(A->arena, A->column, at, A->column_cap, column ? column[k] : (int)k);
        CT_PUSH(A->arena, A->value, nvalue, A->value_cap, weight * value[k]);
    }
    CT_PUSH(A->arena, A->start, nstart, A->start_cap, at);
    A->n++;
}

void ct_sparse_rows_times(double *y, const struct ct_sparse_rows *A, size_t n, const double *x)
{
    for (size_t i = 0; i < n; i++) {
        y[i] = 0;
        for (size_t k = A->start[i]; k < A->start[i + 1]; k++)
            y[i] += A->value[k] * x[A->column[k]];
    }
}

double ct_sparse_rows_largest_column(const struct ct_sparse_rows *A, size_t n, size_t ncolumn,
                                     double *work)
{
    memset(work, 0, ncolumn * sizeof *work);
    for (size_t k = 0; n && k < A->start[n]; k++)
        work[A->column[k]] += A->value[k] * A->value[k];
    return sqrt(ct_vector_largest(work, ncolumn));
}

// ---- the system ---------------------------------------------------------------------------------

struct ct_damped {
    struct ct_arena *arena;            // data that depend on the pattern only
    size_t n, ncolumn, nentry, *start; // the pattern: rows, columns, entries of A and W
    int *column;
    const struct ct_sparse_rows *A; // matrix of the last factors
    size_t nfirst;                  // rows of A; those of W follow
    double damping;
    bool is_empty, is_singular;
    struct ct_sparse *K; // NULL: KLU is not available
    double *value;       // of K: n times damping or 1, ncolumn times -damping, A, A'
    double *b, *x;       // (n + ncolumn)
};

struct ct_damped *ct_damped_create(struct ct_arena *a)
{
    struct ct_damped *s = CT_NEW(a, struct ct_damped);
    s->arena = ct_arena_create_under(a);
    return s;
}

static bool has_pattern(const struct ct_damped *s, const struct ct_sparse_rows *A, size_t n,
                        size_t ncolumn)
{
    return s->start && s->n == n && s->ncolumn == ncolumn && s->nentry == A->start[n]
        && memcmp(s->start, A->start, (n + 1) * sizeof *s->start) == 0
        && memcmp(s->column, A->column, s->nentry * sizeof *s->column) == 0;
}

static void analyse(struct ct_damped *s, const struct ct_sparse_rows *A, size_t n,
                    size_t ncolumn)
{
    struct ct_arena *a = s->arena;
    s->start = NULL;
    ct_arena_clear(a);
    const size_t nentry = A->start[n], most = n + ncolumn + 2 * nentry;
    int *row = CT_NEWN(a, int, most), *column = CT_NEWN(a, int, most);
    s->n = n;
    s->ncolumn = ncolumn;
    s->nentry = nentry;
    s->start = CT_NEWN(a, size_t, n + 1);
    s->column = CT_NEWN(a, int, nentry + 1);
    s->value = CT_NEWN(a, double, most);
    s->b = CT_NEWN(a, double, n + ncolumn);
    s->x = CT_NEWN(a, double, n + ncolumn);
    memcpy(s->start, A->start, (n + 1) * sizeof *s->start);
    memcpy(s->column, A->column, nentry * sizeof *s->column);
    for (size_t i = 0; i < n + ncolumn; i++)
        row[i] = column[i] = (int)i;
    for (size_t i = 0, at = n + ncolumn; i < n; i++)
        for (size_t k = A->start[i]; k < A->start[i + 1]; k++, at++) {
            row[at] = column[at + nentry] = (int)i;
            column[at] = row[at + nentry] = (int)n + A->column[k];
        }
    s->K = ct_sparse_create(a, (int)(n + ncolumn), row, column, most, CT_SPARSE_ANY);
}

// By dense QR of A / sqrt(damping), W, sqrt(damping) I.
static void solve_dense(struct ct_damped *s, double *x, const double *b)
{
    const struct ct_sparse_rows *A = s->A;
    const size_t n = s->n + s->ncolumn, ncolumn = s->ncolumn;
    struct ct_arena *own = ct_arena_create_under(s->arena);
    double *D = CT_NEWN(own, double, n *ncolumn), *y = CT_NEWN(own, double, n);
    double *work = CT_NEWN(own, double, ct_lstsq_work((int)n, (int)ncolumn));
    for (size_t i = 0; i < s->n; i++) {
        const double weight = i < s->nfirst ? 1 / sqrt(s->damping) : 1;
        y[i] = weight * b[i];
        for (size_t k = A->start[i]; k < A->start[i + 1]; k++)
            D[i + n * (size_t)A->column[k]] += weight * A->value[k];
    }
    for (size_t k = 0; k < ncolumn; k++)
        D[s->n + k + n * k] = sqrt(s->damping);
    ct_lstsq(y, D, (int)n, (int)ncolumn, (int)n, 0, CT_NEWN(own, int, ncolumn), work);
    memcpy(x, y, ncolumn * sizeof *x);
    ct_arena_destroy(own);
}

void ct_damped_factor(struct ct_damped *s, const struct ct_sparse_rows *A, size_t nfirst,
                      size_t n, size_t ncolumn, double damping)
{
    s->is_empty = n == 0 || ncolumn == 0;
    if (s->is_empty) {
        s->ncolumn = ncolumn;
        return;
    }
    if (!has_pattern(s, A, n, ncolumn))
        analyse(s, A, n, ncolumn);
    s->A = A;
    s->nfirst = nfirst;
    s->damping = damping;
    if (!s->K)
        return;
    for (size_t i = 0; i < n + ncolumn; i++)
        s->value[i] = i < nfirst ? damping : i < n ? 1 : -damping;
    for (int side = 0; side < 2; side++)
        memcpy(s->value + n + ncolumn + (side ? s->nentry : 0), A->value,
               s->nentry * sizeof *s->value);
    s->is_singular = !ct_sparse_factor_repivot(s->K, s->value);
}

void ct_damped_solve(struct ct_damped *s, double *x, const double *b)
{
    if (s->is_empty) {
        memset(x, 0, s->ncolumn * sizeof *x);
        return;
    }
    if (!s->K) {
        solve_dense(s, x, b);
        return;
    }
    memcpy(s->b, b, s->n * sizeof *b); // the other entries stay zero
    if (!s->is_singular)
        ct_sparse_solve_extended(s->K, s->x, s->b);
    for (size_t k = 0; k < s->ncolumn; k++)
        x[k] = s->is_singular ? NAN : s->x[s->n + k];
}
