// Is the initial state a singular configuration? See singular.h.
//
// J has the same rank at all configurations of a motion except singular ones, where it is
// lower. The rank at the initial state is compared with that at a configuration 0.1 rad or m
// away: a step in the null space of J, projected onto the constraints by minimum-norm
// Gauss-Newton steps.
#include "solve/singular/singular.h"

#include "solve/constraint/partition_internal.h"

#include "numeric/dense.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Loops closed to 1e-13 are at a singular configuration only to about the root of that: smaller
// singular values of J count as zero.
// Derived: three times that root.
static const double rank_loss_tolerance = 1e-6;

// Rows are part of the dependence if their entry is at least this fraction of the largest. The
// choice of pivots decides by round-off among similar rows which ones it leaves out; null
// vectors of redundant rows turn by as much as the configuration.
// Default: between both. Test: singular_start
static const double involved_row_part = 0.3;

struct probe {
    struct ct_evaluator *m;
    double t, *y, *x, *d, *A, *work; // (ny), (nu), (larger of nu and nrow), (nrow x nu)
    int *iwork;                      // (larger of nu and nrow)
    double *eigen_work;
    double largest; // row of J near the configuration [m or 1]
};

static double *workspace(struct ct_arena *a, int n, int m)
{
    const size_t least = ct_lstsq_work(m, n), pivots = ct_qr_pivot_work(n, m);
    return CT_NEWN(a, double, least > pivots ? least : pivots);
}

// p->d = -J+ r.
static void minimum_norm_step(struct probe *p, const double *r)
{
    const int n = (int)p->m->nu, m = (int)p->m->nrow;
    memcpy(p->A, p->m->J, (size_t)(n * m) * sizeof *p->A);
    memset(p->d, 0, (size_t)(n > m ? n : m) * sizeof *p->d);
    for (int i = 0; i < m; i++)
        p->d[i] = -r[i];
    ct_lstsq(p->d, p->A, m, n, m, rank_loss_tolerance, p->iwork, p->work);
}

static void evaluate(struct probe *p)
{
    ct_evaluator_set(p->m, p->t, p->y);
    ct_evaluator_constraint(p->m);
}

// Move by `distance` [rad or m] in an arbitrary direction in the null space of J.
static void move(struct probe *p, struct ct_arena *scratch, double distance)
{
    const size_t n = p->m->nu, m = p->m->nrow;
    double *r = CT_NEWN(scratch, double, m + 1);
    evaluate(p);
    for (size_t k = 0; k < n; k++) {
        p->x[k] = fmod(1 + (double)k * 0.6180339887498949, 1) - 0.4; // golden-ratio sequence
        for (size_t i = 0; i < m; i++)
            r[i] += p->m->J[i + m * k] * p->x[k];
    }
    minimum_norm_step(p, r);
    for (size_t k = 0; k < n; k++)
        p->x[k] += p->d[k];
    const double size = ct_vector_largest(p->x, n);
    for (size_t k = 0; k < n && size > 0; k++)
        p->x[k] *= distance / size;
    ct_evaluator_retract(p->m, p->y, p->x);
}

// Project onto the constraints; false if that fails or moves by more than `distance`.
static bool close(struct probe *p, double distance)
{
    // Limit: iterations; five are usual
    enum { MOST = 20 };
    // [m, rad]. Derived: J then has an error of the same size; singular values that vanish in the
    // configuration are 1e-5 or less
    const double closed = sqrt(DBL_EPSILON);
    for (int i = 0; i < MOST; i++) {
        evaluate(p);
        if (ct_vector_largest(p->m->phi, p->m->nrow) < closed)
            return true;
        minimum_norm_step(p, p->m->phi);
        if (!(ct_vector_largest(p->d, p->m->nu) < distance))
            return false;
        ct_evaluator_retract(p->m, p->y, p->d);
    }
    return false;
}

// p->A (nu x nrow) = J'.
static void take_rows(struct probe *p)
{
    const size_t n = p->m->nu, m = p->m->nrow;
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < n; j++)
            p->A[j + n * i] = p->m->J[i + m * j];
}

// The rank of J: the remainders of the other rows are below `least` of their natural sizes.
static int find_rank(struct probe *p, double least)
{
    return ct_evaluator_order_rows(p->m, p->m->J, least, p->iwork, p->A, p->x, p->work);
}

// N (nrow x nrow, out): its first nrow - rank columns are a basis of null(J'), J' N = 0.
static bool find_combinations(struct probe *p, double *N)
{
    const int n = (int)p->m->nu, m = (int)p->m->nrow;
    take_rows(p);
    ct_matrix_multiply_transposed(N, p->A, p->A, m, n, m);
    return ct_symmetric_eigen(p->x, N, m, m, p->eigen_work);
}

// size (nrow, out): natural sizes of rows near a singular configuration, where rows may vanish.
static void size_rows(const struct probe *p, double *size)
{
    const size_t m = p->m->nrow, n = p->m->nu;
    for (size_t i = 0; i < m; i++) {
        size[i] = 0;
        for (size_t k = 0; k < n; k++)
            size[i] += p->m->J[i + m * k] * p->m->J[i + m * k];
        size[i] = sqrt(size[i]);
    }
}

// Multiply size (nrow) by the part of each row in the null space of J' `here` that is not in
// that `there`. `here` is overwritten.
static void weigh_rows(const struct probe *p, double *size, double *here, int nhere,
                       const double *there, int nthere)
{
    const size_t m = p->m->nrow;
    for (double *w = here; w < here + (size_t)nhere * m; w += m)
        for (const double *v = there; v < there + (size_t)nthere * m; v += m)
            ct_vector_add(w, -ct_vector_dot(w, v, m), v, m);
    for (size_t i = 0; i < m; i++) {
        double part = 0;
        for (size_t j = 0; j < (size_t)nhere; j++)
            part += here[i + m * j] * here[i + m * j];
        size[i] *= sqrt(part);
    }
}

static struct probe make_probe(struct ct_arena *scratch, struct ct_evaluator *m, double t,
                               const double *y)
{
    const size_t ny = m->nq + m->nu + 1, most = m->nu > m->nrow ? m->nu : m->nrow;
    struct probe p = {.m = m, .t = t};
    p.y = CT_NEWN(scratch, double, ny);
    p.x = CT_NEWN(scratch, double, most + 1);
    p.d = CT_NEWN(scratch, double, most + 1);
    p.A = CT_NEWN(scratch, double, m->nu * m->nrow + 1);
    p.iwork = CT_NEWN(scratch, int, most + 1);
    p.work = workspace(scratch, (int)m->nu, (int)m->nrow);
    p.eigen_work = CT_NEWN(scratch, double, ct_symmetric_eigenvalues_work((int)m->nrow));
    memcpy(p.y, y, ny * sizeof *p.y);
    evaluate(&p);
    return p;
}

// Rank of J at y. Rows are relative to the largest one near y, since all may vanish at y, with
// round-off as the lower limit. p->largest: that row, in its own unit.
static int find_rank_here(struct probe *p, struct ct_arena *scratch, const double *y)
{
    // Default: far enough for J to change, near enough to be similar. Test: singular_start
    const double distance = 0.1;
    const size_t ny = p->m->nq + p->m->nu + 1;
    move(p, scratch, distance);
    evaluate(p);
    find_rank(p, 0);
    const double row_size = fabs(p->A[0]);
    size_rows(p, p->x);
    p->largest = ct_vector_largest(p->x, p->m->nrow);
    memcpy(p->y, y, ny * sizeof *y);
    evaluate(p);
    return find_rank(p, fmax(rank_loss_tolerance * row_size, p->m->rank_tolerance));
}

// Rank of J near y, at the largest distance at which it exceeds `here`; if there is none,
// `here` or less.
static int find_rank_nearby(struct probe *p, struct ct_arena *scratch, const double *y,
                            int here)
{
    const double ways[] = {0.1, 0.02};
    // Derived: a hundred times the tolerance of closed loops
    const double part = 1e-3; // of the change of J, which is about as large as the distance
    const size_t ny = p->m->nq + p->m->nu + 1;
    int there = 0;
    for (size_t i = 0; i < COUNT(ways) && here < (int)p->m->nrow && there <= here; i++) {
        memcpy(p->y, y, ny * sizeof *p->y);
        move(p, scratch, ways[i]);
        if (close(p, ways[i]))
            there = find_rank(p, part * ways[i]);
    }
    return there;
}

bool ct_singular_start_test(struct ct_arena *scratch, const struct ct_partition *s, double t,
                            const double *y, bool *row)
{
    struct ct_evaluator *m = s->m;
    if (!m->nrow || ct_partition_is_large(s))
        return false;
    struct probe p = make_probe(scratch, m, t, y);
    const int n = (int)m->nrow, here = find_rank_here(&p, scratch, y);
    const int there = find_rank_nearby(&p, scratch, y, here);
    double *size = CT_NEWN(scratch, double, m->nrow);
    double *lost = CT_NEWN(scratch, double, m->nrow * m->nrow),
           *always = CT_NEWN(scratch, double, m->nrow * m->nrow);
    bool is_singular = there > here && find_combinations(&p, always);
    size_rows(&p, size);
    memcpy(p.y, y, (m->nq + m->nu + 1) * sizeof *p.y);
    evaluate(&p);
    is_singular = is_singular && find_combinations(&p, lost);
    if (!is_singular)
        return false;
    weigh_rows(&p, size, lost, n - here, always, n - there);
    const double most = ct_vector_largest(size, m->nrow);
    for (size_t i = 0; i < m->nrow; i++)
        row[i] = size[i] > involved_row_part * most;
    return true;
}

double ct_singular_start_misfit(struct ct_arena *scratch, const struct ct_partition *s,
                                double t, const double *y, int *freedoms)
{
    struct ct_evaluator *m = s->m;
    struct probe p = make_probe(scratch, m, t, y);
    const size_t n = m->nrow;
    const int here = find_rank_here(&p, scratch, y);
    double *w = CT_NEWN(scratch, double, n *n + 1), worst = 0;
    *freedoms = (int)m->nu - here;
    if (!find_combinations(&p, w))
        return 0;
    ct_evaluator_dynamics(m);
    for (size_t i = 0; i + (size_t)here < n; i++)
        worst = fmax(worst, fabs(ct_vector_dot(w + n * i, m->gam, n)));
    const double speed = ct_vector_largest(y + m->nq, m->nu);
    return worst / (p.largest * speed * speed);
}
