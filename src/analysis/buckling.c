// See buckling.h.
//
// The method follows the path of equilibria as the load grows and monitors the eigenvalues of
// the stiffness K. An equilibrium buckles where an eigenvalue of K changes its sign. For small
// systems K is dense, in the independent coordinates of the equilibrium at load factor 0, and
// all its eigenvalues are computed. For large systems K is sparse, and the eigenvalues w2 of K
// y = w2 M y closest to zero are computed instead: they have the signs of those of K
// (Sylvester's law of inertia).
//
// If a sparse K changes nearly in proportion to the load, the path is not searched. Each load
// factor is then refined from the solution of the linear problem. With the present estimate c
// of the factor and x of the shape, one step solves
//
//     K y - J' mu = K1 x,  J y = 0,    d = -y' K1 x/(y' K1 y),    K1 = (K - K_0)/c
//
// and replaces c by c + d and x by y. The correction d vanishes when K is singular.
#include "analysis/buckling.h"
#include "analysis/sparse_modes.h"
#include "base/sort.h"
#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

// The second load level at which K is evaluated to find its slope, relative to the estimate of the
// first load factor. The slope is a difference quotient, with an error of cond(K) eps/small_load by
// round-off and of the order of small_load by curvature. Derived: both are equal at the square root
// of cond(K) eps, 1e-4 for 1000 elements.
static const double small_load = 1e-2;
// Largest slope of a beam axis [rad] at which the search continues. The beam model shortens the
// axis by half the square of the slope, which is half of its length at a slope of 1.
// Definition: of the second-order shortening of the beam axis.
static const double steepest = 1;
// Derived: the square root of eps.
static const double straight = 1e-8; // [rad] below it the axis is straight but for round-off
// At a limit point the eigenvalue falls to zero with the square root of the remaining path. If
// the eigenvalue at the end of the path is larger than this fraction of its value one step
// before, Newton's method has left the path and the end is not a limit point.
// Derived: Newton's method converges to within sqrt(eps) of a limit point, where the eigenvalue
// has fallen to eps^(1/4). The geometric mean of that and 1 is eps^(1/8).
static const double folded = 1.1e-2;
// Derived: first_step, 1/16, beyond the estimate.
static const double behind = 1 + 1. / 16; // of the last estimate: where the search may end
// Relative to the load factor: a correction below this that is not less than half the last one
// is round-off.
// Derived: the square root of the error that Newton's method leaves.
static const double nearly = 1e-6;
// Largest relative difference of a load factor from its linear estimate for which the estimate
// is refined directly.
// Limit: beyond it the path is searched.
static const double in_proportion = 0.1;
// Steps along the path: the first relative to the estimated factor, the shortest relative to
// the present factor.
// Limit: of the number of steps.
static const double first_step = 1. / 16, shortest_step = 1. / 64;
// Limit: of the time of the search. Factors that are not found then are reported as missing.
enum {
    MOST_LEVELS = 40,
    MOST_HALVINGS = 30,
    MOST_TRIES = 1000,
    MOST_REFINE = 100,
    MOST_STEPS = 30,
    MOST_STOPS = 2000
};

struct search {
    struct ct_linear *l;
    struct ct_arena *a;
    size_t at, count;
    // number of eigenvalues (directions with stiffness at some load; sparse: those nearest
    // zero)
    int n;
    int f;            // number of independent speeds
    int *independent; // independent speeds at load factor 0  (f)
    double *P;        // basis of the directions with stiffness  (f x n)
    double *K0, *K1, *K, *work, *B, *value, *T;
    int *pivot;
    struct ct_buckling_factor *found;
    size_t nfound, cap;
    double searched;                // largest load factor that the search has reached
    bool is_large;                  // the stiffness is sparse
    bool has_potential;             // the loads have one: the stiffness is symmetric
    struct ct_point *free, *loaded; // sparse stiffness without and with load
    // shapes of the linear problem, nu x (count + 1); workspace, nu + nrow each
    double *shape, *b, *y, *K0x;
    bool is_steep; // a beam has exceeded `steepest`: the search ended there
};

// A point on the path of equilibria.
struct place {
    double factor;
    struct ct_kept_state state;
};

static struct place place_create(const struct ct_linear *l)
{
    return (struct place){.state = ct_kept_state_create(l)};
}

static void keep(const struct ct_linear *l, size_t at, struct place *p)
{
    p->factor = l->m->input[at];
    ct_linear_keep(l, &p->state);
}

static void set_factor(const struct ct_linear *l, size_t at, double factor)
{
    l->m->input[at] = factor;
    ct_evaluator_prepare(l->m);
}

static void go_back(struct ct_linear *l, size_t at, const struct place *p)
{
    ct_linear_go_back(l, &p->state);
    set_factor(l, at, p->factor);
}

bool ct_buckling_load(struct ct_linear *l, size_t at, double factor)
{
    struct ct_equilibrium_result result;
    struct place last = place_create(l);
    keep(l, at, &last);
    int tries = 0;
    for (int i = 0; i < MOST_HALVINGS && tries < MOST_TRIES && last.factor != factor; tries++) {
        const double here = last.factor, next = here + (factor - here) * ldexp(1, -i);
        set_factor(l, at, next);
        if (ct_equilibrium_rates(l, &result)) {
            keep(l, at, &last);
            i = i > 0 ? i - 1 : 0;
        } else {
            go_back(l, at, &last);
            i++;
        }
    }
    return last.factor == factor;
}

// ---- stiffness in the independent coordinates of load factor 0 -----------------------------

// K (f x f, out) = T^-T Kr T^-1, the stiffness in the coordinates y0 = T y of factor 0.
static bool stiffness(struct search *s, double *K)
{
    const struct ct_linear *l = s->l;
    const int f = s->f, nu = l->nu;
    bool same = true;
    memcpy(K, l->Kr, (size_t)f * (size_t)f * sizeof *K);
    for (int i = 0; i < f; i++)
        same &= l->independent[i] == s->independent[i];
    if (same)
        return l->nfree == f;
    for (int j = 0; j < f; j++)
        for (int i = 0; i < f; i++)
            s->T[i + f * j] = l->Z[s->independent[i] + nu * j];
    if (l->nfree != f || !ct_lu(s->T, s->pivot, f, f))
        return false;
    ct_lu_solve(K, s->T, s->pivot, f, f, f, f, true);
    for (int j = 0; j < f; j++)
        for (int i = 0; i < f; i++)
            s->B[j + f * i] = K[i + f * j];
    ct_lu_solve(s->B, s->T, s->pivot, f, f, f, f, true);
    for (int j = 0; j < f; j++)
        for (int i = 0; i < f; i++)
            K[i + f * j] = s->B[j + f * i];
    return true;
}

// out (n x n) = P' K P
static void restrict_to(struct search *s, double *out, const double *K)
{
    ct_matrix_multiply(s->B, K, s->P, s->f, s->f, s->n);
    ct_matrix_multiply_transposed(out, s->P, s->B, s->n, s->f, s->n);
}

// Finds a basis P of the directions that have stiffness at some load. Rigid-body motions, which
// have none at any load, are left out.
static void find_directions(struct search *s)
{
    const int f = s->f;
    double *H = s->K, *v = s->B;
    for (int j = 0; j < f; j++)
        for (int i = 0; i < f; i++)
            H[i + f * j] = (s->K0[i + f * j] + s->K0[j + f * i]) / 2;
    ct_symmetric_eigen(s->value, H, f, f, s->work);
    const double stiffest = fmax(fabs(s->value[0]), fabs(s->value[f - 1]));
    const double change = ct_vector_largest(s->K1, (size_t)f * (size_t)f);
    s->n = 0;
    for (int k = 0; k < f; k++) {
        ct_matrix_multiply(v, s->K1, H + f * k, f, f, 1);
        if (fabs(s->value[k]) > ct_roundoff(f) * stiffest
            || ct_vector_largest(v, (size_t)f) > ct_roundoff(f) * change)
            memcpy(s->P + f * s->n++, H + f * k, (size_t)f * sizeof *s->P);
    }
}

// ---- the linear problem ---------------------------------------------------------------------

static int ascending(const void *context, const void *a, const void *b)
{
    (void)context;
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// Positive c with det(K0 + c K1) = 0: c = -1/mu, mu eigenvalues of K0^-1 K1. Returns their number.
static int linear_factors(struct search *s, double *c)
{
    const int n = s->n;
    double *K0 = CT_NEWN(s->a, double, (size_t)n *(size_t)n + 1),
           *K1 = CT_NEWN(s->a, double, (size_t)n *(size_t)n + 1),
           *V = CT_NEWN(s->a, double, (size_t)n *(size_t)n + 1),
           *re = CT_NEWN(s->a, double, n + 1), *im = CT_NEWN(s->a, double, n + 1),
           *work = CT_NEWN(s->a, double, ct_eigen_work(n));
    int found = 0;
    restrict_to(s, K0, s->K0);
    restrict_to(s, K1, s->K1);
    if (!n || !ct_lu(K0, s->pivot, n, n))
        return 0;
    ct_lu_solve(K1, K0, s->pivot, n, n, n, n, false);
    if (!ct_eigen(re, im, V, K1, n, n, work))
        return 0;
    double size = 0;
    for (int k = 0; k < n; k++)
        size = fmax(size, hypot(re[k], im[k]));
    for (int k = 0; k < n; k++)
        if (fabs(im[k]) <= sqrt(DBL_EPSILON) * size && re[k] < -ct_roundoff(n) * size)
            c[found++] = -1 / re[k];
    ct_sort(s->a, c, (size_t)found, sizeof *c, ascending, NULL);
    return found;
}

// K1 = (K(c) - K0)/c in s->K1. False if no equilibrium is found at factor c.
static bool slope(struct search *s, const struct place *start, double c)
{
    const size_t ff = (size_t)s->f * (size_t)s->f;
    go_back(s->l, s->at, start);
    if (!ct_buckling_load(s->l, s->at, c) || !stiffness(s, s->K1))
        return false;
    s->has_potential &= ct_linear_is_symmetric(s->a, s->K1, s->f);
    for (size_t i = 0; i < ff; i++)
        s->K1[i] = (s->K1[i] - s->K0[i]) / c;
    find_directions(s);
    return true;
}

// Load factors of the linear problem with sparse stiffness. Finds `count` of them and one more,
// which tells how far to search.
static bool sparse_factors(struct search *s, const struct place *start, double level, double *c,
                           int *n)
{
    go_back(s->l, s->at, start);
    const bool reached = ct_buckling_load(s->l, s->at, level) && ct_point_evaluate(s->loaded);
    go_back(s->l, s->at, start);
    *n = reached
           ? (int)ct_sparse_modes_factors(s->l, s->loaded, level, s->count + 1, c, s->shape)
           : 0;
    return reached;
}

static bool dense_factors(struct search *s, const struct place *start, double level, double *c,
                          int *n)
{
    if (!slope(s, start, level))
        return false;
    *n = linear_factors(s, c);
    return true;
}

// Load factors c of the linear problem. The slope of K is first taken at the given load or a
// part of it, then at a fraction of the factor that the first estimate gives.
static int estimate(struct search *s, const struct place *start, double *c)
{
    bool (*const factors)(struct search *, const struct place *, double, double *, int *)
        = s->is_large ? sparse_factors : dense_factors;
    double level = 1;
    int n = 0;
    for (int i = 0; i < MOST_LEVELS && !factors(s, start, level, c, &n); i++)
        level /= 4;
    const double second = n ? small_load * c[0] : 0;
    int again = 0;
    if (n && level > second && factors(s, start, second, c, &again))
        n = again;
    return n;
}

// ---- search along the path -----------------------------------------------------------------

// Eigenvalues of the stiffness at the present equilibrium, ascending, in s->value.
static bool eigenvalues(struct search *s)
{
    const int n = s->n;
    if (s->is_large)
        return ct_sparse_modes_stiffness(s->l, (size_t)n, s->value);
    double *H = s->K0; // workspace: K0 is no longer needed
    if (!stiffness(s, s->K))
        return false;
    restrict_to(s, H, s->K);
    for (int j = 0; j < n; j++)
        for (int i = 0; i < j; i++)
            H[i + n * j] = H[j + n * i] = (H[i + n * j] + H[j + n * i]) / 2;
    return ct_symmetric_eigenvalues(s->value, H, n, n, s->work);
}

// Eigenvalue k at a load factor above that of `from`, by continuation from there. False if the
// path ends before the factor.
static bool eigenvalue_at(struct search *s, const struct place *from, double factor, int k,
                          double *value)
{
    go_back(s->l, s->at, from);
    if (!ct_buckling_load(s->l, s->at, factor) || !eigenvalues(s))
        return false;
    *value = s->value[k];
    return true;
}

// Finds the factor in (a, b) at which eigenvalue k falls through zero, by the Illinois method,
// or by bisection if the path ends before b. va > 0 is the eigenvalue at a; at b it is vb <= 0,
// or b cannot be reached. On return `a` is the last point before the zero, and the eigenvalue
// there is returned.
static double refine(struct search *s, struct place *a, double va, double b, double vb,
                     bool reached, int k, struct ct_buckling_factor *out)
{
    double low = a->factor;
    for (int i = 0; i < MOST_REFINE && b > low; i++) {
        double c = reached ? (low * vb - b * va) / (vb - va) : low + (b - low) / 2, v;
        if (!(c > low && c < b))
            c = low + (b - low) / 2;
        if (!(c > low && c < b))
            break;
        // towards a limit point the eigenvalue falls: if it rises, Newton's method has left the
        // path
        if (!eigenvalue_at(s, a, c, k, &v) || (!reached && v > va)) {
            b = c;
            reached = false;
            continue;
        }
        if (v > 0) {
            keep(s->l, s->at, a);
            low = c;
            va = v;
            vb /= 2;
        } else {
            b = c;
            vb = v;
            reached = true;
            va /= 2;
        }
        if (v == 0)
            low = b = c;
    }
    out->factor = low + (b - low) / 2;
    out->is_exact = true;
    out->is_limit = !reached;
    return va;
}

static int count_negative(const struct search *s)
{
    int n = 0;
    while (n < s->n && s->value[n] < 0)
        n++;
    return n;
}

// Largest angle between a beam section and the frame of its beam [rad].
static double steepness(struct search *s)
{
    struct ct_evaluator *m = s->l->m;
    double largest = 0;
    if (!m->e->nbent_beam)
        return 0;
    ct_program_run(&m->validity, m->input);
    const double *square = m->validity.out + m->e->nvalidity;
    for (size_t i = 0; i < m->e->nbent_beam; i++)
        for (size_t k = 0; k < m->e->bent_beam[i].n; k++)
            largest = fmax(largest, sqrt(*square++));
    return largest;
}

// Is the step short enough? The next eigenvalue to vanish may lose at most half its value and
// may overshoot zero by at most half of it.
static bool is_gentle(const double *before, const double *after, int next, int n)
{
    return next == n || (before[next] > 0 && after[next] >= before[next] / 2)
        || (after[next] <= 0 && after[next] >= -before[next] / 2);
}

// Follows the path of equilibria and refines each load factor at which an eigenvalue changes
// its sign. The search ends at the factor `last`, or at the slope `steepest` of a beam if the
// axis bends under the load. The linear problem only gives the length of the first step there:
// a bent axis couples stretch and bending in K, and shortens with the square of the load, so
// that the factors of the path may be far from the linear ones.
static bool follow_path(struct search *s, const struct place *start, double step, double last)
{
    struct place here = place_create(s->l), next = place_create(s->l),
                 first = place_create(s->l);
    go_back(s->l, s->at, start);
    if ((!s->is_large && !ct_linear_rest(s->l)) || !eigenvalues(s))
        return false;
    keep(s->l, s->at, &here);
    double *before = CT_NEWN(s->a, double, s->n + 1), *after = CT_NEWN(s->a, double, s->n + 1);
    int negative = count_negative(s);
    const int least = negative; // eigenvalues that are negative without the load: unstable
    memcpy(before, s->value, (size_t)s->n * sizeof *before);
    s->searched = 0;
    bool is_bent = false, is_lost = false;
    double h = step;
    for (int i = 0; i < MOST_STOPS && s->nfound < s->count && (here.factor < last || is_bent);
         i++) {
        const double c = is_bent ? here.factor + h : fmin(here.factor + h, last);
        const bool is_shortest = h <= shortest_step * fmax(here.factor, step);
        go_back(s->l, s->at, &here);
        const bool arrived = ct_buckling_load(s->l, s->at, c);
        const double end = s->l->m->input[s->at];
        const bool reached = arrived && eigenvalues(s);
        const double steep = reached ? steepness(s) : 0;
        const bool is_steep = steep > steepest;
        if (reached)
            memcpy(after, s->value, (size_t)s->n * sizeof *after);
        if (!is_shortest
            && (!reached || is_steep || !is_gentle(before, after, negative, s->n))) {
            h = arrived ? h / 2 : fmin((end - here.factor) / 2, h / 2);
            continue;
        }
        s->is_steep = is_steep;
        if (is_steep)
            break;
        if (reached)
            keep(s->l, s->at, &next);
        const int now = reached ? count_negative(s) : negative + 1;
        for (int k = negative; k < now && s->nfound < s->count; k++) {
            struct ct_buckling_factor f = {0};
            go_back(s->l, s->at, &here);
            keep(s->l, s->at, &first);
            const double left
                = refine(s, &first, before[k], c, reached ? after[k] : 0, reached, k, &f);
            is_lost = f.is_limit && left > folded * before[k];
            if (is_lost)
                break;
            if (k >= least)
                CT_PUSH(s->a, s->found, s->nfound, s->cap, f);
        }
        s->searched = first.factor;
        if (!reached || is_lost)
            break;
        negative = now;
        s->searched = c;
        is_bent = steep > straight;
        const struct place spare = here;
        here = next;
        next = spare;
        memcpy(before, after, (size_t)s->n * sizeof *before);
        h = fmin(2 * h, fmax(here.factor, step));
    }
    return s->l->ctx->nerror == 0;
}

// ---- refinement of linear factors, sparse stiffness ----------------------------------------

// y (nu, out) = K1 x, from factors 0 and c
static void apply_slope(struct search *s, double *y, const double *x, double c)
{
    const size_t nu = (size_t)s->l->nu;
    ct_point_apply(y, s->loaded->K, s->loaded->nK, x, nu);
    ct_point_apply(s->K0x, s->free->K, s->free->nK, x, nu);
    for (size_t i = 0; i < nu; i++)
        y[i] = (y[i] - s->K0x[i]) / c;
}

// One refinement step at the equilibrium in l with factor c: d (out) is the correction of c,
// and x becomes y. False if K is singular to working precision.
static bool step(struct search *s, double c, double *x, double *d)
{
    const size_t nu = (size_t)s->l->nu, n = nu + (size_t)s->l->nrow;
    struct ct_sparse *matrix = ct_point_factor(s->loaded, 1, 0);
    if (!matrix)
        return false;
    memset(s->b, 0, n * sizeof *s->b);
    apply_slope(s, s->b, x, c);
    ct_sparse_solve_extended(matrix, s->y, s->b);
    double *K1y = x; // workspace: x is no longer needed
    const double work = ct_vector_dot(s->y, s->b, nu);
    apply_slope(s, K1y, s->y, c);
    *d = -work / ct_vector_dot(s->y, K1y, nu);
    const double size = sqrt(ct_vector_dot(s->y, s->y, nu));
    for (size_t i = 0; i < nu; i++)
        x[i] = s->y[i] / size;
    return isfinite(size);
}

// Refines the estimate `linear` with its shape x to the load factor on the path. False if the
// factor is too far from the estimate.
static bool refine_linear(struct search *s, double linear, double *x,
                          struct ct_buckling_factor *out)
{
    double c = linear, d = INFINITY, last;
    for (int i = 0; i < MOST_STEPS && fabs(c - linear) <= in_proportion * linear; i++) {
        last = fabs(d);
        if (!ct_buckling_load(s->l, s->at, c) || !ct_point_evaluate(s->loaded))
            return false;
        const bool is_singular = !step(s, c, x, &d);
        c += is_singular ? 0 : d;
        if (is_singular || fabs(d) <= DBL_EPSILON * c
            || (fabs(d) <= nearly * c && fabs(d) > last / 2)) {
            *out = (struct ct_buckling_factor){.factor = c, .linear = linear, .is_exact = true};
            return fabs(c - linear) <= in_proportion * linear;
        }
    }
    return false;
}

static int by_factor(const void *context, const void *a, const void *b)
{
    (void)context;
    const struct ct_buckling_factor *x = a, *y = b;
    return (x->factor > y->factor) - (x->factor < y->factor);
}

// Refines all n linear factors, at most `count`. False if one of them is too far from its
// estimate: the path may then have lower factors that the linear problem does not show.
static bool refine_all(struct search *s, const struct place *start, const double *c, int n)
{
    const size_t nu = (size_t)s->l->nu;
    go_back(s->l, s->at, start);
    for (size_t k = 0; k < (size_t)n && k < s->count; k++) {
        struct ct_buckling_factor f;
        if (!refine_linear(s, c[k], s->shape + nu * k, &f)) {
            s->nfound = 0;
            return false;
        }
        CT_PUSH(s->a, s->found, s->nfound, s->cap, f);
    }
    ct_sort(s->a, s->found, s->nfound, sizeof *s->found, by_factor, NULL);
    return true;
}

// ---- entry points --------------------------------------------------------------------------

static void reserve_dense(struct search *s)
{
    const size_t f = (size_t)s->f + 1;
    double **const squares[] = {&s->P, &s->K0, &s->K1, &s->K, &s->B, &s->T};
    for (size_t i = 0; i < COUNT(squares); i++)
        *squares[i] = CT_NEWN(s->a, double, f *f);
    s->value = CT_NEWN(s->a, double, f);
    s->work = CT_NEWN(s->a, double, ct_symmetric_eigenvalues_work((int)f));
    s->pivot = CT_NEWN(s->a, int, f);
    s->independent = CT_NEWN(s->a, int, f);
    memcpy(s->independent, s->l->independent, (size_t)s->f * sizeof *s->independent);
}

static void reserve_sparse(struct search *s)
{
    const size_t f = (size_t)s->f,
                 next_to_zero = s->count + 2; // the negative ones and the next
    s->n = (int)(next_to_zero < f ? next_to_zero : f);
    s->value = CT_NEWN(s->a, double, next_to_zero);
    s->free = ct_point_create(s->l);
    s->loaded = ct_point_create(s->l);
    const size_t nu = (size_t)s->l->nu, n = nu + (size_t)s->l->nrow;
    double **const vectors[] = {&s->b, &s->y, &s->K0x};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(s->a, double, n + 1);
    s->shape = CT_NEWN(s->a, double, nu *(s->count + 1) + 1);
}

static bool no_buckling(const struct search *s)
{
    return ct_error(s->l->ctx, (struct ct_mark){.file = s->l->m->model->file}, CT_E_NO_BUCKLING,
                    "the load does not lead to buckling: no positive factor makes the "
                    "stiffness vanish%s",
                    s->has_potential ? ""
                                     : "; it has no potential and may lead to flutter: "
                                       "see the modes of the loaded model");
}

static bool none_on_path(const struct search *s)
{
    return ct_error(s->l->ctx, (struct ct_mark){.file = s->l->m->model->file}, CT_E_NO_BUCKLING,
                    "the load does not lead to buckling: up to a factor of %.3g the stiffness "
                    "does not vanish%s",
                    s->searched,
                    s->is_steep
                        ? "; beyond it sections of beams turn by more than 1 rad against "
                          "their frames, which is no longer the beam's motion"
                        : "");
}

// Can sparse matrices be used? They require an equilibrium that is stable without the load,
// with stiffness in all directions.
static bool is_stable(struct search *s)
{
    double least;
    return s->f && ct_sparse_modes_stiffness(s->l, 1, &least) && least > 0;
}

bool ct_buckling_find(struct ct_linear *l, size_t at, size_t count,
                      struct ct_buckling_list *list, bool *applies)
{
    struct search s = {.l = l,
                       .a = l->arena,
                       .at = at,
                       .count = count,
                       .is_large = !l->M,
                       .has_potential = true};
    s.f = s.is_large ? l->nu - l->nrow : l->nfree;
    *list = (struct ct_buckling_list){.has_potential = true};
    *applies = !s.is_large || is_stable(&s);
    if (!*applies)
        return true;
    if (!s.f)
        return no_buckling(&s);
    struct place start = place_create(l);
    double *c = CT_NEWN(s.a, double, (s.is_large ? count : (size_t)s.f) + 1);
    keep(l, at, &start);
    if (s.is_large) {
        reserve_sparse(&s);
        if (!ct_point_evaluate(s.free))
            return false;
    } else {
        reserve_dense(&s);
        stiffness(&s, s.K0);
        s.has_potential = ct_linear_is_symmetric(s.a, s.K0, s.f);
    }
    const int n = estimate(&s, &start, c);
    *applies = !s.is_large || n; // without eigenvalues the load may have no potential
    if (!n)
        return *applies ? no_buckling(&s) : true;
    list->has_potential = s.has_potential;
    const bool is_refined = s.is_large && refine_all(&s, &start, c, n);
    if (!is_refined && list->has_potential
        && !follow_path(&s, &start, first_step * c[0], behind * c[n - 1]))
        return false;
    if (list->has_potential && !s.nfound)
        return none_on_path(&s);
    for (size_t k = 0; k < (size_t)n && k < count && !list->has_potential; k++) {
        const struct ct_buckling_factor f = {.factor = c[k]};
        CT_PUSH(s.a, s.found, s.nfound, s.cap, f);
    }
    for (size_t k = 0; k < s.nfound && k < (size_t)n && !is_refined; k++)
        s.found[k].linear = c[k];
    list->factor = s.found;
    list->n = s.nfound;
    return true;
}
