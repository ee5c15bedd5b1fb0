// Buckling of large systems; see buckling.h.
//
// Factors and shapes of the linear problem come from block Lanczos in the metric of the stiffness. Each is refined on the
// path of equilibria with the stiffness K and the rows J there:
//
//     K y - J' mu = K1 x,  J y = 0,    d = -y' K1 x/(y' K1 y),    K1 = (K - K_0)/c
//
// takes the factor from c to c + d and the shape from x to y; once K is singular, d vanishes.
#include "analysis/buckling.h"
#include "analysis/sparse_modes.h"
#include "numeric/dense.h"

#include <math.h>
#include <string.h>

static const double refined = 1e-13, nearly = 1e-6; // of a factor
static const double part
    = 0.5; // of the first factor: the second load level, large against round-off of K
static const double in_proportion
    = 0.1; // of a factor: by which those of path and linear problem may differ, so that one leads to the other
enum { MOST_LEVELS = 40, MOST_STEPS = 30 };

struct search {
    struct ct_linear *l;
    struct ct_arena *a;
    size_t at, nu, n; // n: rows, too
    struct ct_point *free, *here;
    double *y0, *memory0; // with factor 0
    double *lam0, *b, *x, *f;
};

static struct search search_create(struct ct_linear *l, size_t at)
{
    const struct ct_evaluator *m = l->m;
    struct ct_arena *a = l->arena;
    struct search s = {.l = l, .a = a, .at = at, .nu = m->nu, .n = m->nu + m->nrow};
    s.free = ct_point_create(l);
    s.here = ct_point_create(l);
    double **const vectors[] = {&s.lam0, &s.b, &s.x, &s.f};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, double, s.n + 1);
    s.y0 = CT_NEWN(a, double, m->nq + m->nu + 1);
    s.memory0 = CT_NEWN(a, double, m->e->nmemory + 1);
    memcpy(s.y0, l->y, (m->nq + m->nu + 1) * sizeof *s.y0);
    memcpy(s.lam0, l->lam, m->nrow * sizeof *s.lam0);
    memcpy(s.memory0, m->input + m->at_memory, m->e->nmemory * sizeof *s.memory0);
    return s;
}

static void start_again(struct search *s)
{
    struct ct_evaluator *m = s->l->m;
    memcpy(s->l->y, s->y0, (m->nq + m->nu + 1) * sizeof *s->y0);
    memcpy(s->l->lam, s->lam0, m->nrow * sizeof *s->lam0);
    memcpy(m->input + m->at_memory, s->memory0, m->e->nmemory * sizeof *s->memory0);
    m->input[s->at] = 0;
    ct_evaluator_prepare(m);
}

// y = K1 x from factors 0 and c; f: work
static void apply_change(struct search *s, double *y, const double *x, double c)
{
    ct_point_apply(y, s->here->K, s->here->nK, x, s->nu);
    ct_point_apply(s->f, s->free->K, s->free->nK, x, s->nu);
    for (size_t i = 0; i < s->nu; i++)
        y[i] = (y[i] - s->f[i]) / c;
}

// ---- the linear problem -----------------------------------------------------------------------------------------

// Is there a stiffness in every direction, and against none of them?
static bool is_stable(struct search *s)
{
    struct ct_motion_mode *mode;
    size_t n;
    const char *how;
    bool applies;
    const bool ok = ct_sparse_modes(s->l->ctx, s->a, s->l, 1, &mode, &n, &how, &applies);
    return ok && applies && n && mode[0].re == 0 && mode[0].im > 0;
}

// With the load `level`: how many there are; false where the path does not lead there.
static bool factors_with(struct search *s, double level, size_t count, double *c, double *shape,
                         size_t *n)
{
    *n = 0;
    start_again(s);
    if (!ct_buckling_load(s->l, s->at, level) || !ct_point_evaluate(s->here))
        return false;
    start_again(s);
    *n = ct_sparse_modes_factors(s->l->ctx, s->a, s->l, s->here, level, count, c, shape);
    return true;
}

static size_t estimate(struct search *s, size_t count, double *c, double *shape)
{
    double level = 1;
    size_t n, again;
    for (int i = 0; i < MOST_LEVELS && !factors_with(s, level, count, c, shape, &n); i++)
        level /= 4;
    return n && factors_with(s, part * c[0], count, c, shape, &again) && again ? again : n;
}

// ---- on the path ------------------------------------------------------------------------------------------------

// One step from the place in l with factor c: d as above, x becomes y. False where K is singular to the last digit.
static bool step(struct search *s, double c, double *x, double *d)
{
    struct ct_sparse *matrix = ct_point_factor(s->here, 1, 0);
    if (!matrix)
        return false;
    memset(s->b, 0, s->n * sizeof *s->b);
    apply_change(s, s->b, x, c);
    ct_sparse_solve_extended(matrix, s->x, s->b);
    double *K1y = x; // no longer needed
    const double work = ct_vector_dot(s->x, s->b, s->nu);
    apply_change(s, K1y, s->x, c);
    *d = -work / ct_vector_dot(s->x, K1y, s->nu);
    const double size = sqrt(ct_vector_dot(s->x, s->x, s->nu));
    for (size_t i = 0; i < s->nu; i++)
        x[i] = s->x[i] / size;
    return isfinite(size);
}

// From an estimate c with its shape x. False where the iteration leads nowhere.
static bool refine(struct search *s, double c, double *x, struct ct_buckling_factor *out)
{
    double d, last = INFINITY;
    *out = (struct ct_buckling_factor){.factor = c};
    for (int i = 0; i < MOST_STEPS; i++) {
        if (!ct_buckling_load(s->l, s->at, c)) {
            out->factor = s->l->m->input[s->at];
            out->is_exact = out->is_limit = true;
            return true;
        }
        if (!ct_point_evaluate(s->here))
            return false;
        out->factor = c;
        out->is_exact = true;
        if (!step(s, c, x, &d))
            return true;
        out->factor = c + d;
        if (fabs(d) <= refined * c || (fabs(d) <= nearly * c && fabs(d) > last / 2))
            return true;
        c += d;
        if (!(c > 0))
            break;
        last = fabs(d);
    }
    out->is_exact = false;
    return false;
}

static void insert(struct ct_buckling_list *list, struct ct_buckling_factor f)
{
    size_t at = list->n++;
    for (; at > 0 && list->factor[at - 1].factor > f.factor; at--)
        list->factor[at] = list->factor[at - 1];
    list->factor[at] = f;
}

bool ct_buckling_find_sparse(struct ct_linear *l, size_t at, size_t count,
                             struct ct_buckling_list *list, bool *applies)
{
    struct search s = search_create(l, at);
    double *c = CT_NEWN(s.a, double, count + 1), *shape = CT_NEWN(s.a, double, s.nu *count + 1);
    *list = (struct ct_buckling_list){.has_potential = true};
    list->factor = CT_NEWN(s.a, struct ct_buckling_factor, count + 1);
    *applies = is_stable(&s) && ct_point_evaluate(s.free);
    const size_t n = *applies ? estimate(&s, count, c, shape) : 0;
    *applies = n > 0;
    start_again(&s);
    for (size_t k = 0; k < n; k++) {
        struct ct_buckling_factor f;
        const bool ok = refine(&s, c[k], shape + s.nu * k, &f);
        if (!ok) {
            f = (struct ct_buckling_factor){.factor = c[k]};
            start_again(&s);
        }
        insert(list, f);
        // where K does not follow the load in proportion, others may lie below
        *applies &= f.is_exact && !f.is_limit && fabs(f.factor - c[k]) <= in_proportion * c[k];
        if (!*applies)
            break;
    }
    return l->ctx->nerror == 0;
}
