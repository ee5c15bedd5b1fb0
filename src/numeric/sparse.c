// Sparse LU by KLU with iterative refinement; see sparse.h.
#include "numeric/sparse.h"

#include "numeric/dense.h"
#include "numeric/klu_include.h"

#if CT_HAS_KLU
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// Pivot threshold for an order that was chosen for the values too: prefer the given order more
// strongly than CT_PIVOT_THRESHOLD. Definition: KLU's own default.
static const double order_preference = 1e-3;
// Backward error above which a solution is refined: some tens of units of round-off. Default: the
// cost of a second solution against some digits. Test: factors.
static const double refinement_limit = 1e-14;

struct ct_sparse {
    int n, nz;
    int *start, *row; // compressed columns
    double *value;
    size_t nentry;
    int *place; // by entry: index among the values
    double *r, *scale;
    long double *sum;
    double operations; // of the last factorisation
    klu_common common;
    klu_symbolic *symbolic;
    klu_numeric *numeric;
};

static void release(void *sparse)
{
    struct ct_sparse *s = sparse;
    klu_free_numeric(&s->numeric, &s->common);
    klu_free_symbolic(&s->symbolic, &s->common);
}

struct cell {
    int column, row;
    size_t entry;
};

static int by_place(const void *a, const void *b)
{
    const struct cell *p = a, *q = b;
    return p->column != q->column ? p->column - q->column : p->row - q->row;
}

static void compress(struct ct_arena *a, struct ct_sparse *s, const int *row, const int *column)
{
    struct cell *cell = CT_NEWN(a, struct cell, s->nentry + 1);
    for (size_t k = 0; k < s->nentry; k++)
        cell[k] = (struct cell){column[k], row[k], k};
    qsort(cell, s->nentry, sizeof *cell, by_place);
    s->start = CT_NEWN(a, int, s->n + 1);
    s->row = CT_NEWN(a, int, s->nentry + 1);
    s->place = CT_NEWN(a, int, s->nentry + 1);
    for (size_t k = 0; k < s->nentry; k++) {
        if (k == 0 || by_place(&cell[k - 1], &cell[k]) != 0) {
            s->row[s->nz++] = cell[k].row;
            s->start[cell[k].column + 1]++;
        }
        s->place[cell[k].entry] = s->nz - 1;
    }
    for (int j = 0; j < s->n; j++)
        s->start[j + 1] += s->start[j];
}

static struct ct_sparse *create(struct ct_arena *a, int n, const int *row, const int *column,
                                size_t nentry)
{
    struct ct_sparse *s = CT_NEW(a, struct ct_sparse);
    s->n = n;
    s->nentry = nentry;
    compress(a, s, row, column);
    s->value = CT_NEWN(a, double, s->nz + 1);
    s->r = CT_NEWN(a, double, n);
    s->sum = CT_NEWN(a, long double, n);
    s->scale = CT_NEWN(a, double, n);
    klu_defaults(&s->common);
    s->common.tol = CT_PIVOT_THRESHOLD;
    s->common.scale = 0; // no scaling of rows, so that pivots can be compared with each other
    ct_arena_on_destroy(a, release, s);
    return s;
}

struct ct_sparse *ct_sparse_create(struct ct_arena *a, int n, const int *row, const int *column,
                                   size_t nentry, enum ct_sparse_order order)
{
    if (n == 0)
        return NULL;
    struct ct_sparse *s = create(a, n, row, column, nentry);
    s->common.ordering = order == CT_SPARSE_ANY; // COLAMD, else AMD
    s->symbolic = klu_analyze(n, s->start, s->row, &s->common);
    return s->symbolic ? s : NULL;
}

struct ct_sparse *ct_sparse_create_along(struct ct_arena *a, int n, const int *row,
                                         const int *column, size_t nentry, int *first_rows,
                                         int *first_columns)
{
    if (n == 0)
        return NULL;
    struct ct_sparse *s = create(a, n, row, column, nentry);
    s->common.btf = 0; // the order is for the whole matrix
    s->common.tol = order_preference;
    s->symbolic = klu_analyze_given(n, s->start, s->row, first_rows, first_columns, &s->common);
    return s->symbolic ? s : NULL;
}

static void gather(struct ct_sparse *s, const double *value)
{
    memset(s->value, 0, (size_t)s->nz * sizeof *s->value);
    for (size_t k = 0; k < s->nentry; k++)
        s->value[s->place[k]] += value[k];
}

bool ct_sparse_factor_repivot(struct ct_sparse *s, const double *value)
{
    gather(s, value);
    klu_free_numeric(&s->numeric, &s->common);
    s->numeric = klu_factor(s->start, s->row, s->value, s->symbolic, &s->common);
    if (!s->numeric || s->common.status != KLU_OK)
        return false;
    klu_flops(s->symbolic, s->numeric, &s->common);
    s->operations = s->common.flops;
    return true;
}

bool ct_sparse_factor(struct ct_sparse *s, const double *value)
{
    if (!s->numeric)
        return ct_sparse_factor_repivot(s, value);
    gather(s, value);
    return klu_refactor(s->start, s->row, s->value, s->symbolic, s->numeric, &s->common)
        && s->common.status == KLU_OK;
}

// r = b - A x. Returns the largest of |r_i| / (|b_i| + max_j |A_ij| max |x|) over the rows.
static double backward_error(struct ct_sparse *s, const double *x, const double *b)
{
    double worst = 0, most = 0;
    memcpy(s->r, b, (size_t)s->n * sizeof *s->r);
    memset(s->scale, 0, (size_t)s->n * sizeof *s->scale);
    for (int j = 0; j < s->n; j++) {
        most = fmax(most, fabs(x[j]));
        for (int k = s->start[j]; k < s->start[j + 1]; k++) {
            s->r[s->row[k]] -= s->value[k] * x[j];
            s->scale[s->row[k]] = fmax(s->scale[s->row[k]], fabs(s->value[k]));
        }
    }
    for (int i = 0; i < s->n; i++)
        if (!isfinite(s->r[i]))
            worst = INFINITY;
        else if (fabs(s->r[i]) > 0)
            worst = fmax(worst, fabs(s->r[i]) / (fabs(b[i]) + s->scale[i] * most));
    return worst;
}

double ct_sparse_solve(struct ct_sparse *s, double *x, const double *b, bool *is_refined)
{
    memcpy(x, b, (size_t)s->n * sizeof *x);
    klu_solve(s->symbolic, s->numeric, s->n, 1, x, &s->common);
    double error = backward_error(s, x, b);
    *is_refined = *is_refined || error > refinement_limit;
    if (!*is_refined)
        return error;
    klu_solve(s->symbolic, s->numeric, s->n, 1, s->r, &s->common);
    for (int i = 0; i < s->n; i++)
        x[i] += s->r[i];
    return backward_error(s, x, b);
}

// r = b - A x
static void residual_extended(struct ct_sparse *s, const double *x, const double *b)
{
    long double *sum = s->sum;
    for (int i = 0; i < s->n; i++)
        sum[i] = b[i];
    for (int j = 0; j < s->n; j++)
        for (int k = s->start[j]; k < s->start[j + 1]; k++)
            sum[s->row[k]] -= (long double)s->value[k] * x[j];
    for (int i = 0; i < s->n; i++)
        s->r[i] = (double)sum[i];
}

void ct_sparse_solve_extended(struct ct_sparse *s, double *x, const double *b)
{
    memcpy(x, b, (size_t)s->n * sizeof *x);
    klu_solve(s->symbolic, s->numeric, s->n, 1, x, &s->common);
    for (double last = INFINITY;;) { // until a correction is more than half of the last
        residual_extended(s, x, b);
        klu_solve(s->symbolic, s->numeric, s->n, 1, s->r, &s->common);
        const double size = ct_vector_largest(s->r, (size_t)s->n);
        if (!(size < last / 2))
            return;
        for (int k = 0; k < s->n; k++)
            x[k] += s->r[k];
        if (size <= DBL_EPSILON * ct_vector_largest(x, (size_t)s->n))
            return;
        last = size;
    }
}

double ct_sparse_pivot(const struct ct_sparse *s)
{
    const double *d = s->numeric->Udiag;
    double least = INFINITY, most = 0;
    for (int i = 0; i < s->n; i++) {
        least = fmin(least, fabs(d[i]));
        most = fmax(most, fabs(d[i]));
    }
    return most > 0 ? least / most : 0;
}

double ct_sparse_operations(const struct ct_sparse *s)
{
    return s->operations;
}

double ct_sparse_fill(const struct ct_sparse *s)
{
    return s->numeric->lnz + s->numeric->unz;
}

#else

struct ct_sparse *ct_sparse_create(struct ct_arena *a, int n, const int *row, const int *column,
                                   size_t nentry, enum ct_sparse_order order)
{
    (void)a, (void)n, (void)row, (void)column, (void)nentry, (void)order;
    return NULL;
}

struct ct_sparse *ct_sparse_create_along(struct ct_arena *a, int n, const int *row,
                                         const int *column, size_t nentry, int *first_rows,
                                         int *first_columns)
{
    (void)a, (void)n, (void)row, (void)column, (void)nentry, (void)first_rows,
        (void)first_columns;
    return NULL;
}

// Nothing below is called without a ct_sparse.

bool ct_sparse_factor(struct ct_sparse *s, const double *value)
{
    (void)s, (void)value;
    return false;
}

bool ct_sparse_factor_repivot(struct ct_sparse *s, const double *value)
{
    (void)s, (void)value;
    return false;
}

double ct_sparse_solve(struct ct_sparse *s, double *x, const double *b, bool *is_refined)
{
    (void)s, (void)x, (void)b, (void)is_refined;
    return 0;
}

void ct_sparse_solve_extended(struct ct_sparse *s, double *x, const double *b)
{
    (void)s, (void)x, (void)b;
}

double ct_sparse_pivot(const struct ct_sparse *s)
{
    (void)s;
    return 0;
}

double ct_sparse_operations(const struct ct_sparse *s)
{
    (void)s;
    return 0;
}

double ct_sparse_fill(const struct ct_sparse *s)
{
    (void)s;
    return 0;
}

#endif
