// Sparse LU with one pattern; see factors.h.
#include "numeric/factors.h"

#include "numeric/klu_include.h"
#include "numeric/selected_inverse.h"

#include <math.h>
#include <stdlib.h>

// ---- the pattern -------------------------------------------------------------------------------

struct cell {
    int column, row, entry;
};

static int by_place(const void *a, const void *b)
{
    const struct cell *p = a, *q = b;
    return p->column != q->column ? p->column - q->column : p->row - q->row;
}

struct ct_pattern *ct_pattern_create(struct ct_arena *a, int n, const int *row,
                                     const int *column, int nentry, int *place)
{
    struct ct_pattern *p = CT_NEW(a, struct ct_pattern);
    struct cell *cell = CT_NEWN(a, struct cell, nentry + 1);
    p->n = n;
    p->start = CT_NEWN(a, int, n + 1);
    p->row = CT_NEWN(a, int, nentry + 1);
    for (int k = 0; k < nentry; k++)
        cell[k] = (struct cell){column[k], row[k], k};
    qsort(cell, (size_t)nentry, sizeof *cell, by_place);
    for (int k = 0; k < nentry; k++) {
        if (k == 0 || by_place(&cell[k - 1], &cell[k]) != 0) {
            p->row[p->nz++] = cell[k].row;
            p->start[cell[k].column + 1]++;
        }
        place[cell[k].entry] = p->nz - 1;
    }
    for (int j = 0; j < n; j++)
        p->start[j + 1] += p->start[j];
    return p;
}

#if CT_HAS_KLU

// Pivots are taken from the diagonal in the order of low fill while element growth stays below this
// limit. Structural matrices are nearly positive definite; for these any order of the diagonal is
// stable, and an off-diagonal pivot can destroy the sparsity. If growth is larger, pivots are
// searched for by threshold partial pivoting, and kept while growth is at most this many times that
// of the search. Growth loses as many digits: three of sixteen. Default: lost digits against
// searches, which allocate. Test: factors.
static const double growth_limit = 1e3;

// ---- orders ------------------------------------------------------------------------------------

struct ct_pattern_order {
    klu_common common;
    klu_symbolic *symbolic;
};

static void release_order(void *order)
{
    struct ct_pattern_order *o = order;
    klu_free_symbolic(&o->symbolic, &o->common);
}

bool ct_pattern_minimum_degree(struct ct_pattern *graph, int *first)
{
    klu_common common;
    klu_defaults(&common); // minimum degree order among them
    common.btf = 0;
    klu_symbolic *s = klu_analyze(graph->n, graph->start, graph->row, &common);
    for (int i = 0; s && i < graph->n; i++)
        first[i] = s->Q[i];
    const bool ok = s != NULL;
    if (ok) {
        graph->operations = s->est_flops;
        graph->fill = s->lnz + s->unz;
    }
    klu_free_symbolic(&s, &common);
    return ok;
}

bool ct_pattern_order(struct ct_arena *a, struct ct_pattern *p, double *value, int *first)
{
    struct ct_pattern_order *o = CT_NEW(a, struct ct_pattern_order);
    ct_arena_on_destroy(a, release_order, o);
    klu_defaults(&o->common);
    o->common.btf = 0;                  // the matrix is one block
    o->common.tol = CT_PIVOT_THRESHOLD; // rows are scaled by their largest entry
    o->symbolic = klu_analyze_given(p->n, p->start, p->row, first, first, &o->common);
    if (!o->symbolic)
        return false;
    klu_numeric *numeric = klu_factor(p->start, p->row, value, o->symbolic, &o->common);
    if (!numeric || o->common.status != KLU_OK) {
        klu_free_numeric(&numeric, &o->common);
        return false;
    }
    klu_flops(o->symbolic, numeric, &o->common);
    p->operations = o->common.flops;
    p->fill = numeric->lnz + numeric->unz;
    p->order = o;
    klu_free_numeric(&numeric, &o->common);
    return true;
}

// ---- factors -----------------------------------------------------------------------------------

struct ct_factors {
    const struct ct_pattern *p;
    klu_symbolic *symbolic;
    klu_common common;
    klu_numeric *numeric;
    bool is_complex;
    long npivoting;
    double growth; // reciprocal growth with the pivots when they were chosen
    // for entries of the inverse
    long extracted; // value of npivoting when they were last extracted
    struct ct_arena *arena;
    struct ct_lu_factors t;
    struct ct_selected_inverse *selected;
    double *scale;     // by pivot: scale of the row (n)
    int *row, *column; // by pivot (n)
    int *place;        // by entry: index of its entry of the inverse (nz)
    int *scale_of;     // by entry: index of its pivot (nz)
};

static void release_numeric(void *factors)
{
    struct ct_factors *f = factors;
    if (f->is_complex)
        klu_z_free_numeric(&f->numeric, &f->common);
    else
        klu_free_numeric(&f->numeric, &f->common);
}

struct ct_factors *ct_factors_create(struct ct_arena *a, const struct ct_pattern *p,
                                     bool is_complex)
{
    struct ct_factors *f = CT_NEW(a, struct ct_factors);
    *f = (struct ct_factors){.p = p,
                             .symbolic = p->order->symbolic,
                             .common = p->order->common,
                             .is_complex = is_complex};
    ct_arena_on_destroy(a, release_numeric, f);
    if (!is_complex)
        f->arena = ct_arena_create_under(a);
    return f;
}

// Reciprocal pivot growth; 0 where it cannot be computed.
static double inverse_growth(struct ct_factors *f, double *value)
{
    const struct ct_pattern *p = f->p;
    klu_common *c = &f->common;
    const bool ok = f->is_complex
                      ? klu_z_rgrowth(p->start, p->row, value, f->symbolic, f->numeric, c)
                      : klu_rgrowth(p->start, p->row, value, f->symbolic, f->numeric, c);
    return ok ? c->rgrowth : 0;
}

// Factor with the same pivots; false if growth is too large.
static bool refactor(struct ct_factors *f, double *value)
{
    const struct ct_pattern *p = f->p;
    klu_common *c = &f->common;
    const bool ok = f->is_complex
                      ? klu_z_refactor(p->start, p->row, value, f->symbolic, f->numeric, c)
                      : klu_refactor(p->start, p->row, value, f->symbolic, f->numeric, c);
    return ok && c->status == KLU_OK && inverse_growth(f, value) * growth_limit >= f->growth;
}

// Factor with new pivots: a diagonal entry is the pivot if it is at least tol times the largest
// entry in its column.
static bool factor(struct ct_factors *f, double *value, double tol)
{
    const struct ct_pattern *p = f->p;
    release_numeric(f);
    f->common.tol = tol;
    f->numeric = f->is_complex ? klu_z_factor(p->start, p->row, value, f->symbolic, &f->common)
                               : klu_factor(p->start, p->row, value, f->symbolic, &f->common);
    if (!f->numeric || f->common.status != KLU_OK)
        return false;
    f->growth = inverse_growth(f, value);
    return true;
}

bool ct_factors_compute(struct ct_factors *f, double *value)
{
    if (f->numeric && refactor(f, value))
        return true;
    f->npivoting++;
    return (factor(f, value, 0) && f->growth * growth_limit >= 1)
        || factor(f, value, CT_PIVOT_THRESHOLD);
}

void ct_factors_solve(struct ct_factors *f, double *x)
{
    if (f->is_complex)
        klu_z_solve(f->symbolic, f->numeric, f->p->n, 1, x, &f->common);
    else
        klu_solve(f->symbolic, f->numeric, f->p->n, 1, x, &f->common);
}

// Copy L and U from KLU, for the entries of the inverse.
static void prepare_inverse(struct ct_factors *f)
{
    const struct ct_pattern *p = f->p;
    struct ct_arena *a = f->arena;
    const int n = p->n;
    ct_arena_clear(a);
    f->t = (struct ct_lu_factors){n,
                                  CT_NEWN(a, int, n + 1),
                                  CT_NEWN(a, int, f->numeric->lnz + 1),
                                  CT_NEWN(a, int, n + 1),
                                  CT_NEWN(a, int, f->numeric->unz + 1),
                                  CT_NEWN(a, double, f->numeric->lnz + 1),
                                  CT_NEWN(a, double, f->numeric->unz + 1)};
    f->scale = CT_NEWN(a, double, n + 1);
    f->row = CT_NEWN(a, int, n + 1);
    f->column = CT_NEWN(a, int, n + 1);
    klu_sort(f->symbolic, f->numeric, &f->common);
}

static void extract(struct ct_factors *f)
{
    const struct ct_lu_factors *t = &f->t;
    klu_extract(f->numeric, f->symbolic, t->L_start, t->L_row, t->L, t->U_start, t->U_row, t->U,
                NULL, NULL, NULL, f->row, f->column, f->scale, NULL, &f->common);
}

// Entry (row, column) of the matrix corresponds to entry (pivot of its column, pivot of its row) of
// the factors' inverse.
static void map_inverse_entries(struct ct_factors *f)
{
    const struct ct_pattern *p = f->p;
    struct ct_arena *a = f->arena;
    int *pivot_of_row = CT_NEWN(a, int, p->n + 1), *pivot_of_column = CT_NEWN(a, int, p->n + 1);
    for (int i = 0; i < p->n; i++) {
        pivot_of_row[f->row[i]] = i;
        pivot_of_column[f->column[i]] = i;
    }
    f->selected = ct_selected_inverse_create(a, &f->t);
    f->place = CT_NEWN(a, int, p->nz + 1);
    f->scale_of = CT_NEWN(a, int, p->nz + 1);
    for (int j = 0; j < p->n; j++)
        for (int k = p->start[j]; k < p->start[j + 1]; k++) {
            f->scale_of[k] = pivot_of_row[p->row[k]];
            f->place[k]
                = ct_selected_inverse_index(f->selected, pivot_of_column[j], f->scale_of[k]);
        }
}

void ct_factors_inverse(struct ct_factors *f, double *z)
{
    const bool is_new = f->extracted != f->npivoting;
    if (is_new)
        prepare_inverse(f);
    extract(f);
    if (is_new)
        map_inverse_entries(f);
    f->extracted = f->npivoting;
    const double *Z = ct_selected_inverse_compute(f->selected);
    for (int k = 0; k < f->p->nz; k++)
        z[k] = Z[f->place[k]] / f->scale[f->scale_of[k]];
}

double ct_factors_fill(const struct ct_factors *f)
{
    return f->numeric->lnz + f->numeric->unz;
}

long ct_factors_npivoting(const struct ct_factors *f)
{
    return f->npivoting;
}

#else

bool ct_pattern_order(struct ct_arena *a, struct ct_pattern *p, double *value, int *first)
{
    (void)a, (void)p, (void)value, (void)first;
    return false;
}

bool ct_pattern_minimum_degree(struct ct_pattern *graph, int *first)
{
    (void)graph, (void)first;
    return false;
}

// Nothing below is called without an order.

struct ct_factors *ct_factors_create(struct ct_arena *a, const struct ct_pattern *p,
                                     bool is_complex)
{
    (void)a, (void)p, (void)is_complex;
    return NULL;
}

bool ct_factors_compute(struct ct_factors *f, double *value)
{
    (void)f, (void)value;
    return false;
}

void ct_factors_solve(struct ct_factors *f, double *x)
{
    (void)f, (void)x;
}

void ct_factors_inverse(struct ct_factors *f, double *z)
{
    (void)f, (void)z;
}

double ct_factors_fill(const struct ct_factors *f)
{
    (void)f;
    return 0;
}

long ct_factors_npivoting(const struct ct_factors *f)
{
    (void)f;
    return 0;
}

#endif
