// See sparse_modes.h.
#include "analysis/sparse_modes.h"
#include "analysis/sparse_linearization.h"
#include "base/sort.h"
#include "numeric/arpack.h"
#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { BLOCK = 4 };
static const double still
    = 1e-9; // accelerations beside those of the weights: an equilibrium to round-off
static const double absent = 1e-12;    // damping against the masses' rates: none
static const double symmetric = 1e-12; // of K
static const double found
    = 1e-9; // residual of a mode: its eigenvalue is right to the square of that
static const double gone = 1e-10; // of a vector, once the basis is taken off: nothing new

struct large {
    struct ct_ctx *ctx;
    struct ct_arena *a;
    struct ct_linear *l;
    struct ct_point *p;
    size_t nu, nrow, n;
    struct ct_sparse *matrix;
    double *b, *x; // n each
    double shift;
    // buckling: K takes the place of the masses, and the operator is -K^-1 dK
    const struct ct_point *loaded; // NULL: modes
    double factor;                 // there
    // Lanczos
    size_t k, most;     // vectors so far
    double *V, *MV, *T; // nu x most, nu x most, most x most
    double *W, *R;      // nu x BLOCK; BLOCK x BLOCK
};

// ---- matrices ---------------------------------------------------------------------------------------------

// The metric.
static void apply_masses(struct large *g, double *y, const double *x)
{
    if (g->loaded)
        ct_point_apply(y, g->p->K, g->p->nK, x, g->nu);
    else
        ct_point_apply(y, g->p->M, g->p->nM, x, g->nu);
}

// y = -dK x, dK = (K_loaded - K)/factor
static void apply_softening(struct large *g, double *y, const double *x)
{
    ct_point_apply(y, g->p->K, g->p->nK, x, g->nu);
    ct_point_apply(g->b, g->loaded->K, g->loaded->nK, x, g->nu);
    for (size_t i = 0; i < g->nu; i++)
        y[i] = (y[i] - g->b[i]) / g->factor;
}

// [ K - shift M, J'; J, 0 ]
static bool factor_point(struct large *g, double shift)
{
    g->matrix = ct_point_factor(g->p, 1, -shift);
    g->shift = shift;
    return g->matrix != NULL;
}

// x (nu, out): the first part of the solution for (r, 0)
static void solve(struct large *g, double *x, const double *r)
{
    memcpy(g->b, r, g->nu * sizeof *r);
    memset(g->b + g->nu, 0, g->nrow * sizeof *g->b);
    ct_sparse_solve_extended(g->matrix, g->x, g->b);
    memcpy(x, g->x, g->nu * sizeof *x);
}

// The operator, symmetric in the metric: y (nu, out) of x, Mx its product with the metric.
static void operate(struct large *g, double *y, const double *x, const double *Mx)
{
    if (g->loaded) {
        apply_softening(g, y, x);
        solve(g, y, y);
    } else {
        solve(g, y, Mx);
    }
}

// ---- is it of this kind? -------------------------------------------------------------------------------------

// Accelerations and multipliers at rest: r = 0, J a = 0. False where masses and rows are singular.
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
    if (ct_vector_largest(r, g->nu) == 0) // nothing acts
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

// Numbers in [-1, 1) that are the same in every run.
static double chance(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 4503599627370496.0 - 1;
}

// K x against K' x, each row and column measured by its largest entry: a load that follows the end of a long beam is small
// beside the stiffness of its elements.
static bool is_symmetric(struct large *g, const struct ct_point *p)
{
    uint64_t state = 1;
    double *size = g->W, *x = g->W + g->nu, *Kx = g->W + 2 * g->nu, *transposed = Kx + g->nu;
    memset(size, 0, g->nu * sizeof *size);
    memset(transposed, 0, g->nu * sizeof *transposed);
    for (size_t i = 0; i < p->nK; i++)
        size[p->K[i].row] = fmax(size[p->K[i].row], fabs(p->K[i].value));
    for (size_t i = 0; i < g->nu; i++) {
        size[i] = size[i] > 0 ? sqrt(size[i]) : 1;
        x[i] = chance(&state) / size[i];
    }
    ct_point_apply(Kx, p->K, p->nK, x, g->nu);
    for (size_t i = 0; i < p->nK; i++)
        transposed[p->K[i].direction] += p->K[i].value * x[p->K[i].row];
    for (size_t i = 0; i < g->nu; i++)
        if (!(fabs(Kx[i] - transposed[i]) <= symmetric * size[i]))
            return false;
    return true;
}

static bool is_of_this_kind(struct large *g)
{
    const struct ct_evaluator *m = g->l->m;
    if ((g->nrow && m->e->ndriver) || ct_vector_largest(g->l->y + m->nq, g->nu) > 0)
        return false;
    if (!balance(g) || ct_vector_largest(g->p->v, g->nrow) > 0) // motions of chords
        return false;
    if (g->nrow && g->l->acceleration > still)
        return false; // the rows turn while it accelerates
    const double rate
        = sqrt(ct_point_largest(g->p->K, g->p->nK) * ct_point_largest(g->p->M, g->p->nM));
    return ct_point_largest(g->p->C, g->p->nC) <= absent * rate && is_symmetric(g, g->p);
}

// ---- Lanczos -----------------------------------------------------------------------------------------------------

// Take the basis off x, in the masses' metric, twice; what is left becomes a unit vector of the basis. c (k, may be NULL):
// the coefficients are added. False if nothing is left.
static bool take_in(struct large *g, double *x, double *c, double *size)
{
    double *Mx = g->MV + g->nu * g->k, *v = g->V + g->nu * g->k;
    apply_masses(g, Mx, x);
    const double before = sqrt(fmax(ct_vector_dot(x, Mx, g->nu), 0));
    for (int pass = 0; pass < 2; pass++)
        for (size_t j = 0; j < g->k; j++) {
            const double h = ct_vector_dot(g->MV + g->nu * j, x, g->nu);
            for (size_t i = 0; i < g->nu; i++)
                x[i] -= h * g->V[i + g->nu * j];
            if (c)
                c[j] += h;
        }
    apply_masses(g, Mx, x);
    *size = sqrt(fmax(ct_vector_dot(x, Mx, g->nu), 0));
    if (!(*size > gone * before))
        return false;
    for (size_t i = 0; i < g->nu; i++) {
        v[i] = x[i] / *size;
        Mx[i] /= *size;
    }
    g->k++;
    return true;
}

// The lowest modes that the basis holds: theta (descending |theta|), vectors S (k x k, by columns of the eigenproblem).
struct ritz {
    double *theta, *S, *residual;
    size_t *order;
};

static void find_ritz(struct large *g, size_t k, size_t behind, struct ritz *z)
{
    double *work = CT_NEWN(g->a, double, ct_symmetric_eigenvalues_work((int)k));
    for (size_t j = 0; j < k; j++)
        for (size_t i = 0; i < k; i++)
            z->S[i + k * j] = (g->T[i + g->most * j] + g->T[j + g->most * i]) / 2;
    ct_symmetric_eigen(z->theta, z->S, (int)k, (int)k, work);
    for (size_t i = 0; i < k; i++) {
        size_t at = i;
        for (; at > 0 && fabs(z->theta[z->order[at - 1]]) < fabs(z->theta[i]); at--)
            z->order[at] = z->order[at - 1];
        z->order[at] = i;
    }
    // what the last block leads to outside the basis: R s
    for (size_t j = 0; j < k; j++) {
        double sum = 0;
        for (size_t r = 0; r < BLOCK; r++) {
            double part = 0;
            for (size_t c = 0; c < behind; c++)
                part += g->R[r + BLOCK * c] * z->S[k - behind + c + k * j];
            sum += part * part;
        }
        z->residual[j] = sqrt(sum);
    }
}

static bool have_converged(const struct ritz *z, size_t k, size_t count)
{
    if (k < count)
        return false;
    for (size_t i = 0; i < count; i++)
        if (z->residual[z->order[i]] > found * fabs(z->theta[z->order[i]]))
            return false;
    return true;
}

// Blocks until `count` modes are found, or the basis is complete. Returns the size of the basis.
static size_t iterate(struct large *g, size_t count, struct ritz *z)
{
    uint64_t state = 7;
    double size, *r = CT_NEWN(g->a, double, g->nu + 1);
    for (size_t c = 0; c < BLOCK;
         c++) { // into the range: along the constraints, without what has no mass
        double *w = g->W + g->nu * c;
        for (size_t i = 0; i < g->nu; i++)
            r[i] = chance(&state);
        apply_masses(g, w, r);
        operate(g, w, r, w);
    }
    size_t first = 0; // of the newest block
    for (size_t c = 0; c < BLOCK; c++)
        take_in(g, g->W + g->nu * c, NULL, &size);
    for (;;) {
        const size_t last = g->k, n = last - first;
        for (size_t c = 0; c < n; c++)
            operate(g, g->W + g->nu * c, g->V + g->nu * (first + c),
                    g->MV + g->nu * (first + c));
        for (size_t c = 0; c < n; c++)
            for (size_t j = 0; j < last; j++)
                g->T[j + g->most * (first + c)] = g->T[first + c + g->most * j]
                    = ct_vector_dot(g->MV + g->nu * j, g->W + g->nu * c, g->nu);
        memset(g->R, 0, BLOCK * BLOCK * sizeof *g->R);
        const bool is_full = last + BLOCK > g->most;
        for (size_t c = 0; c < n && !is_full; c++) {
            double *coefficient = CT_NEWN(g->a, double, g->k + 1);
            const size_t at = g->k;
            if (take_in(g, g->W + g->nu * c, coefficient, &size))
                g->R[at - last + BLOCK * c] = size;
            for (size_t j = last; j < at; j++)
                g->R[j - last + BLOCK * c] = coefficient[j];
        }
        find_ritz(g, last, n, z);
        if (have_converged(z, last, count) || g->k == last || is_full)
            return last;
        first = last;
    }
}

// Eigenvalues theta of [K - s M, J'; J, 0]^-1 M (n of them, |theta| descending) and vectors (nu x n) of unit mass.
struct pairs {
    double *theta, *vector;
    size_t n;
};

static struct pairs by_lanczos(struct large *g, size_t count)
{
    struct ct_arena *a = g->a;
    g->most = 8 * count + 20 * BLOCK;
    g->most = g->most > g->nu ? g->nu + BLOCK : g->most;
    g->V = CT_NEWN(a, double, g->nu *(g->most + BLOCK));
    g->MV = CT_NEWN(a, double, g->nu *(g->most + BLOCK));
    g->T = CT_NEWN(a, double, g->most * g->most);
    struct ritz z = {.theta = CT_NEWN(a, double, g->most + 1),
                     .S = CT_NEWN(a, double, g->most * g->most + 1),
                     .residual = CT_NEWN(a, double, g->most + 1),
                     .order = CT_NEWN(a, size_t, g->most + 1)};
    const size_t k = iterate(g, count, &z);
    struct pairs out = {CT_NEWN(a, double, count + 1), CT_NEWN(a, double, g->nu *count + 1), 0};
    for (; out.n < count && out.n < k; out.n++) {
        const size_t j = z.order[out.n];
        double *y = out.vector + g->nu * out.n;
        if (z.residual[j] > found * fabs(z.theta[j]))
            break;
        out.theta[out.n] = z.theta[j];
        for (size_t p = 0; p < k; p++)
            for (size_t q = 0; q < g->nu; q++)
                y[q] += g->V[q + g->nu * p] * z.S[p + k * j];
    }
    return out;
}

// ---- ARPACK ------------------------------------------------------------------------------------------------------

static void operator_solve(void *data, double *y, const double *f)
{
    solve(data, y, f);
}

static void operator_masses(void *data, double *y, const double *x)
{
    apply_masses(data, y, x);
}

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

// A single vector leads to one of several equal eigenvalues, and to others by round-off only (a round beam bends about two
// axes alike, a free body has six motions of frequency 0). So the search is repeated in the complement of what was
// found until that holds nothing more of the wanted ones. n is 0 where ARPACK is not available or fails.
static struct pairs by_arpack(struct large *g, size_t count)
{
    enum { MORE = 2, MOST_SEARCHES = 50 };
    const struct ct_operator op = {operator_solve, operator_masses, g};
    const size_t most = count + MORE * MOST_SEARCHES;
    uint64_t state = 7;
    struct pairs all = {CT_NEWN(g->a, double, most), CT_NEWN(g->a, double, g->nu *most), 0},
                 out;
    struct ranked *order = CT_NEWN(g->a, struct ranked, most);
    double *start = CT_NEWN(g->a, double, g->nu), last = 0; // of the wanted ones so far
    for (int i = 0; i < MOST_SEARCHES; i++) {
        for (size_t k = 0; k < g->nu; k++)
            start[k] = chance(&state);
        struct ct_arena *meanwhile = ct_arena_create_under(g->a);
        const int n = ct_arpack_largest(meanwhile, &op, (int)g->nu, i ? MORE : (int)count,
                                        all.vector, (int)all.n, start, all.theta + all.n,
                                        all.vector + g->nu * all.n);
        ct_arena_destroy(meanwhile);
        if (n <= 0)
            return (struct pairs){0};
        double largest_new = 0;
        for (int k = 0; k < n; k++)
            largest_new = fmax(largest_new, fabs(all.theta[all.n + (size_t)k]));
        const bool is_complete = all.n >= count && largest_new <= last;
        all.n += (size_t)n;
        rank(g, &all, order);
        if (is_complete)
            break;
        last = all.n >= count ? fabs(order[count - 1].theta) : 0;
    }
    if (all.n < count)
        return (struct pairs){0};
    out = (struct pairs){CT_NEWN(g->a, double, count + 1),
                         CT_NEWN(g->a, double, g->nu *count + 1), count};
    for (size_t i = 0; i < count; i++) {
        out.theta[i] = order[i].theta;
        memcpy(out.vector + g->nu * i, all.vector + g->nu * order[i].at,
               g->nu * sizeof *out.vector);
    }
    return out;
}

// ---- all of it ---------------------------------------------------------------------------------------------------

static void add_modes(struct large *g, const struct pairs *z, struct ct_motion_mode *mode,
                      size_t *nswitch)
{
    for (size_t i = 0; i < z->n; i++) {
        double *y = CT_NEWN(g->a, double, 2 * g->nu + 1);
        memcpy(y, z->vector + g->nu * i, g->nu * sizeof *y);
        double w2 = g->shift + 1 / z->theta[i];
        if (fabs(w2) <= 1e-6 * fabs(g->shift))
            w2 = 0; // round-off of the shift
        ct_mode_add_undamped(mode, nswitch, w2, y, (int)g->nu);
    }
}

// Few against what is free to move; else their complement would be too small for restarts.
static bool are_few(const struct large *g, size_t count)
{
    return 4 * count + 40 < g->nu - (g->nrow < g->nu ? g->nrow : g->nu);
}

static struct large large_create(struct ct_ctx *ctx, struct ct_arena *a, struct ct_linear *l)
{
    struct large g = {.ctx = ctx, .a = a, .l = l, .p = ct_point_create(l)};
    g.nu = l->m->nu;
    g.nrow = l->m->nrow;
    g.n = g.nu + g.nrow;
    g.b = CT_NEWN(a, double, g.n + 1);
    g.x = CT_NEWN(a, double, g.n + 1);
    g.W = CT_NEWN(a, double, BLOCK *g.nu + 1);
    g.R = CT_NEWN(a, double, BLOCK *BLOCK);
    return g;
}

bool ct_sparse_modes(struct ct_ctx *ctx, struct ct_arena *a, struct ct_linear *l, size_t count,
                     struct ct_motion_mode **mode, size_t *nswitch, const char **how,
                     bool *applies)
{
    struct large g = large_create(ctx, a, l);
    *applies = is_of_this_kind(&g);
    *nswitch = 0;
    *how = "sparse symmetric";
    if (!*applies)
        return true;
    if (!factor_point(&g, 0)) { // something is free to move: shifted by a little of the lowest
        const double ratio = ct_point_largest(g.p->K, g.p->nK)
                           / fmax(ct_point_largest(g.p->M, g.p->nM), DBL_MIN);
        if (!factor_point(&g, -1e-9 * fmax(ratio, 1)))
            return ct_error(ctx, (struct ct_mark){.file = l->m->model->file}, CT_E_SINGULAR,
                            "the stiffness and the constraints are singular");
    }
    struct pairs z = {0};
    if (are_few(&g, count))
        z = by_arpack(&g, count);
    if (!z.n)
        z = by_lanczos(&g, count);
    if (z.n < count && z.n < g.nu)
        ct_warning(ctx, (struct ct_mark){.file = l->m->model->file}, 0,
                   "%zu of %zu modes are found to round-off, the others are left out", z.n,
                   count);
    *mode = CT_NEWN(a, struct ct_motion_mode, 2 * count + 1);
    add_modes(&g, &z, *mode, nswitch);
    ct_modes_sort(a, *mode, *nswitch);
    return true;
}

size_t ct_sparse_modes_factors(struct ct_ctx *ctx, struct ct_arena *a, struct ct_linear *l,
                               const struct ct_point *loaded, double factor, size_t count,
                               double *c, double *shape)
{
    const double none = 1e-9; // of the largest 1/c
    struct large g = large_create(ctx, a, l);
    size_t n = 0;
    if (!is_of_this_kind(&g) || !is_symmetric(&g, loaded) || !factor_point(&g, 0))
        return 0;
    g.loaded = loaded;
    g.factor = factor;
    const size_t both = 2 * count < g.nu ? 2 * count : g.nu; // of loads that pull, too
    const struct pairs z = by_lanczos(&g, both);
    for (size_t i = 0; i < z.n && n < count; i++)
        if (z.theta[i] > none * fabs(z.theta[0])) {
            c[n] = 1 / z.theta[i];
            memcpy(shape + g.nu * n++, z.vector + g.nu * i, g.nu * sizeof *shape);
        }
    return n;
}
