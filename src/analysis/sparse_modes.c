// See sparse_modes.h.
//
// The unknowns are nu speeds x and nrow multipliers mu. The operator OP maps x to the solution
// y of
//
//     [ K - s M  J' ] [ y  ]   [ F x ]        modes:     F = M, symmetric in the metric M
//     [ J        0  ] [ mu ] = [ 0   ]        buckling:  F = -dK, s = 0, symmetric in the metric K
//
// The matrix is factored once. The eigenvalues theta of OP with the largest size belong to the
// eigenvalues closest to the shift s: w^2 = s + 1/theta for modes, c = 1/theta for load
// factors.
#include "analysis/sparse_modes.h"
#include "analysis/sparse_linearization.h"
#include "base/sort.h"
#include "numeric/arpack.h"
#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

// [m/s^2, rad/s^2] Below it accelerations are round-off, and the state is an equilibrium.
// Derived: n eps of accelerations of order 10, some hundred terms.
static const double still = 1e-9;
// If K is singular, the shift is this far below zero, relative to the largest K over the
// largest M. Round-off of K, eps times that ratio, is small compared with the shift. An
// eigenvalue below `zero` times the shift is zero: this is what round-off of 1/theta leaves.
// Derived: eps / 1e-9 = 2e-7 is the relative error of 1/theta, and 1e-6 is a few times that.
static const double small_shift = 1e-9, zero = 1e-6;

struct large {
    struct ct_ctx *ctx;
    struct ct_arena *a;
    struct ct_linear *l;
    struct ct_point *p;
    size_t nu, nrow, n;
    struct ct_sparse *matrix;
    double *b, *x, *f; // workspace, n each
    double shift;
    const struct ct_point *loaded; // the stiffness under load, for buckling; NULL: modes
    double factor;                 // the load factor of `loaded`
};

// ---- matrices -------------------------------------------------------------------------------

static void apply_metric(void *data, double *y, const double *x)
{
    const struct large *g = data;
    if (g->loaded)
        ct_point_apply(y, g->p->K, g->p->nK, x, g->nu);
    else
        ct_point_apply(y, g->p->M, g->p->nM, x, g->nu);
}

// [ K - shift M, J'; J, 0 ]
static bool factor_point(struct large *g, double shift)
{
    g->matrix = ct_point_factor(g->p, 1, -shift);
    g->shift = shift;
    return g->matrix != NULL;
}

// x (nu, out): the first nu entries of the solution for the right-hand side (r, 0)
static void solve(struct large *g, double *x, const double *r)
{
    memcpy(g->b, r, g->nu * sizeof *r);
    memset(g->b + g->nu, 0, g->nrow * sizeof *g->b);
    ct_sparse_solve_extended(g->matrix, g->x, g->b);
    memcpy(x, g->x, g->nu * sizeof *x);
}

// y = OP x; metric_x is the product of the metric and x.
static void apply_operator(void *data, double *y, const double *x, const double *metric_x)
{
    struct large *g = data;
    if (!g->loaded) {
        solve(g, y, metric_x);
        return;
    }
    ct_point_apply(g->b, g->loaded->K, g->loaded->nK, x, g->nu);
    for (size_t i = 0; i < g->nu; i++) // -dK x, dK = (K_loaded - K)/factor
        g->f[i] = (metric_x[i] - g->b[i]) / g->factor;
    solve(g, y, g->f);
}

// ---- is the system of the required kind? ---------------------------------------------------

// Accelerations and multipliers at rest: r = 0, J a = 0. False if the matrix of masses and rows
// is singular.
static bool balance(struct large *g)
{
    struct ct_linear *l = g->l;
    double *r = CT_NEWN(g->a, double, g->nu + 1);
    if (l->is_resting)
        return ct_point_evaluate(g->p);
    memset(l->a, 0, g->nu * sizeof *l->a);
    memset(l->lam, 0, g->nrow * sizeof *l->lam);
    if (!ct_point_evaluate(g->p))
        return false;
    for (size_t i = 0; i < g->nu; i++)
        r[i] = -g->p->r[i];
    if (ct_vector_largest(r, g->nu) == 0) // no force acts
        return true;
    g->matrix = ct_point_factor(g->p, 0, 1);
    if (!g->matrix)
        return false;
    solve(g, l->a, r);
    for (size_t i = 0; i < g->nrow; i++) // r - J' lam = -M a: the unknown of the matrix is -lam
        l->lam[i] = -g->x[g->nu + i];
    l->acceleration = ct_vector_largest(l->a, g->nu);
    return ct_point_evaluate(g->p);
}

// Pseudorandom numbers in [-1, 1), the same in every run.
static double random_number(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 4503599627370496.0 - 1;
}

// Compares K x with K' x for a random x, each entry relative to the largest entries of its row
// and column. A follower load at the end of a long beam is small compared with the stiffness of
// the elements, and must still be seen.
static bool is_symmetric(struct large *g, const struct ct_point *p)
{
    uint64_t state = 1;
    double *size = CT_NEWN(g->a, double, g->nu + 1),
           *transposed = CT_NEWN(g->a, double, g->nu + 1), *x = g->x, *Kx = g->f;
    for (size_t i = 0; i < p->nK; i++)
        size[p->K[i].row] = fmax(size[p->K[i].row], fabs(p->K[i].value));
    for (size_t i = 0; i < g->nu; i++) {
        size[i] = size[i] > 0 ? sqrt(size[i]) : 1;
        x[i] = random_number(&state) / size[i];
    }
    ct_point_apply(Kx, p->K, p->nK, x, g->nu);
    for (size_t i = 0; i < p->nK; i++)
        transposed[p->K[i].direction] += p->K[i].value * x[p->K[i].row];
    for (size_t i = 0; i < g->nu; i++)
        if (!(fabs(Kx[i] - transposed[i]) <= ct_roundoff((int)g->nu) * size[i]))
            return false;
    return true;
}

static bool is_of_this_kind(struct large *g)
{
    const struct ct_evaluator *m = g->l->m;
    if ((g->nrow && m->e->ndriver) || ct_vector_largest(g->l->y + m->nq, g->nu) > 0)
        return false;
    if (!balance(g) || ct_vector_largest(g->p->v, g->nrow) > 0) // drivers of chords
        return false;
    if (g->nrow && g->l->acceleration > still)
        return false; // the rows depend on the acceleration
    const double rate
        = sqrt(ct_point_largest(g->p->K, g->p->nK) * ct_point_largest(g->p->M, g->p->nM));
    return ct_point_largest(g->p->C, g->p->nC) <= ct_roundoff((int)g->nu) * rate
        && is_symmetric(g, g->p);
}

// ---- eigenvalues ----------------------------------------------------------------------------

// n eigenvalues theta of OP, |theta| descending, and eigenvectors (nu x n) of unit size in the
// metric.
struct pairs {
    double *theta, *vector;
    size_t n;
};

struct ranked {
    double theta;
    size_t at;
};

static int by_rank(const void *context, const void *x, const void *y)
{
    (void)context;
    const struct ranked *p = x, *q = y;
    const double a = fabs(p->theta), b = fabs(q->theta);
    return a != b ? (a < b) - (a > b) : (p->at > q->at) - (p->at < q->at);
}

static void rank(struct large *g, struct pairs *out, struct ranked *order)
{
    for (size_t i = 0; i < out->n; i++)
        order[i] = (struct ranked){out->theta[i], i};
    ct_sort(g->a, order, out->n, sizeof *order, by_rank, NULL);
}

// Finds the `count` eigenvalues of OP that are largest in size. Finds fewer if there are no
// more or ARPACK fails.
//
// A Krylov space from one start vector contains one eigenvector of a multiple eigenvalue;
// others appear by round-off only. Multiple eigenvalues are common: a round beam bends alike
// about two axes, and a free body has six motions of frequency 0. The search is therefore
// repeated in the complement of the eigenvectors found, until it finds no eigenvalue larger
// than the last one wanted. Each repetition adds at least one wanted eigenvalue or is the last,
// so that there are at most `count` of them.
static struct pairs find_pairs(struct large *g, size_t count)
{
    // Limit: of a search.
    enum { MORE = 2 }; // vectors of a repeated search: a double eigenvalue at once
    const struct ct_operator op = {apply_operator, apply_metric, g};
    // dimension of the null space of J, which contains the range of OP
    const size_t room = g->nu - g->nrow;
    const size_t wanted = count < room ? count : room, most = wanted + MORE * (wanted + 1);
    uint64_t state = 7;
    struct pairs all = {CT_NEWN(g->a, double, most), CT_NEWN(g->a, double, g->nu *most), 0};
    struct ranked *order = CT_NEWN(g->a, struct ranked, most);
    // last: smallest wanted theta found so far
    double *start = CT_NEWN(g->a, double, g->nu), last = 0;
    for (size_t i = 0; i <= wanted + 1 && all.n < room; i++) {
        for (size_t k = 0; k < g->nu; k++)
            start[k] = random_number(&state);
        struct ct_arena *meanwhile = ct_arena_create_under(g->a);
        const int n = ct_arpack_largest(meanwhile, &op, (int)g->nu, i ? MORE : (int)wanted,
                                        (int)(room - all.n), all.vector, (int)all.n, start,
                                        all.theta + all.n, all.vector + g->nu * all.n);
        ct_arena_destroy(meanwhile);
        if (n <= 0)
            break;
        double largest_new = 0;
        for (int k = 0; k < n; k++)
            largest_new = fmax(largest_new, fabs(all.theta[all.n + (size_t)k]));
        const bool is_complete = all.n >= wanted && largest_new <= last;
        all.n += (size_t)n;
        rank(g, &all, order);
        if (is_complete)
            break;
        last = all.n >= wanted ? fabs(order[wanted - 1].theta) : 0;
    }
    struct pairs out
        = {CT_NEWN(g->a, double, wanted + 1), CT_NEWN(g->a, double, g->nu *wanted + 1), 0};
    for (; out.n < wanted && out.n < all.n; out.n++) {
        out.theta[out.n] = order[out.n].theta;
        memcpy(out.vector + g->nu * out.n, all.vector + g->nu * order[out.n].at,
               g->nu * sizeof *out.vector);
    }
    return out;
}

// Factors the matrix near the lowest eigenvalues. If a rigid-body motion makes K singular, the
// shift is slightly below zero.
static bool factor_lowest(struct large *g)
{
    const double ratio = ct_point_largest(g->p->K, g->p->nK)
                       / fmax(ct_point_largest(g->p->M, g->p->nM), DBL_MIN);
    return factor_point(g, 0) || factor_point(g, -small_shift * fmax(ratio, 1))
        || ct_error(g->ctx, (struct ct_mark){.file = g->l->m->model->file}, CT_E_SINGULAR,
                    "the stiffness and the constraints are singular");
}

// w^2 [1/s^2] from theta
static double eigenvalue(const struct large *g, double theta)
{
    const double w2 = g->shift + 1 / theta;
    return fabs(w2) <= zero * fabs(g->shift) ? 0 : w2;
}

// ---- entry points --------------------------------------------------------------------------

static struct large large_create(struct ct_ctx *ctx, struct ct_arena *a, struct ct_linear *l)
{
    struct large g = {.ctx = ctx, .a = a, .l = l, .p = ct_point_here(l)};
    g.nu = l->m->nu;
    g.nrow = l->m->nrow;
    g.n = g.nu + g.nrow;
    double **const vectors[] = {&g.b, &g.x, &g.f};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, double, g.n + 1);
    return g;
}

bool ct_sparse_modes(struct ct_ctx *ctx, struct ct_arena *a, struct ct_linear *l, size_t count,
                     struct ct_motion_mode **mode, size_t *nmode, const char **how,
                     bool *applies)
{
    struct large g = large_create(ctx, a, l);
    *applies = is_of_this_kind(&g);
    *nmode = 0;
    *how = "sparse symmetric";
    if (!*applies)
        return true;
    if (!factor_lowest(&g))
        return false;
    const struct pairs z = find_pairs(&g, count);
    if (z.n < count && z.n < g.nu - g.nrow)
        ct_warning(ctx, (struct ct_mark){.file = l->m->model->file}, 0,
                   "%zu of %zu modes are found to round-off, the others are left out", z.n,
                   count);
    *mode = CT_NEWN(a, struct ct_motion_mode, 2 * z.n + 1);
    for (size_t i = 0; i < z.n; i++) {
        double *y = CT_NEWN(a, double, 2 * g.nu + 1);
        memcpy(y, z.vector + g.nu * i, g.nu * sizeof *y);
        ct_mode_add_undamped(*mode, nmode, eigenvalue(&g, z.theta[i]), y, (int)g.nu);
    }
    ct_modes_sort(a, *mode, *nmode);
    return true;
}

static int ascending(const void *context, const void *a, const void *b)
{
    (void)context;
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

bool ct_sparse_modes_stiffness(struct ct_linear *l, size_t count, double *w2)
{
    struct ct_arena *a = ct_arena_create_under(l->arena);
    struct large g = large_create(l->ctx, a, l);
    bool ok = is_of_this_kind(&g) && factor_lowest(&g);
    if (ok) {
        const struct pairs z = find_pairs(&g, count);
        for (size_t i = 0; i < z.n; i++)
            w2[i] = eigenvalue(&g, z.theta[i]);
        ct_sort(a, w2, z.n, sizeof *w2, ascending, NULL);
        ok = z.n == count;
    }
    ct_arena_destroy(a);
    return ok;
}

size_t ct_sparse_modes_factors(struct ct_linear *l, const struct ct_point *loaded,
                               double factor, size_t count, double *c, double *shape)
{
    struct ct_arena *a = ct_arena_create_under(l->arena);
    struct large g = large_create(l->ctx, a, l);
    size_t n = 0;
    if (is_of_this_kind(&g) && is_symmetric(&g, loaded) && factor_point(&g, 0)) {
        g.loaded = loaded;
        g.factor = factor;
        const struct pairs z
            = find_pairs(&g, 2 * count); // twice as many: half of them may be negative factors
        for (size_t i = 0; i < z.n && n < count; i++)
            if (z.theta[i] > ct_roundoff((int)g.nu) * fabs(z.theta[0])) {
                c[n] = 1 / z.theta[i];
                memcpy(shape + g.nu * n++, z.vector + g.nu * i, g.nu * sizeof *shape);
            }
    }
    ct_arena_destroy(a);
    return n;
}
