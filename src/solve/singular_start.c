// A start in a singular position; see singular.h.
//
// The rank of J is the same wherever the mechanism can go, but for singular positions, where it is less. So it is
// compared with the rank a little way off, along what J lets move and brought back onto the constraints.
#include "solve/singular.h"

#include "numeric/dense.h"

#include <math.h>
#include <string.h>

// Loops that close to 1e-13 meet a singular position to about the root of that: what is less of J is left out.
static const double unmet = 1e-6;

struct probe {
    struct ct_machine *m;
    double t, *y, *x, *d, *A, *work; // (ny), (nu), (larger of nu and nrow), (nrow x nu)
    int *iwork, *row;                // (nu); (nrow) rows by independence
};

static double *workspace(struct ct_arena *a, int n, int m)
{
    const size_t least = ct_lstsq_work(m, n), pivots = ct_qr_pivot_work(n, m);
    return CT_NEWN(a, double, least > pivots ? least : pivots);
}

// p->d = -J+ r.
static void least_step(struct probe *p, const double *r)
{
    const int n = (int)p->m->nu, m = (int)p->m->nrow;
    memcpy(p->A, p->m->J, (size_t)(n * m) * sizeof *p->A);
    memset(p->d, 0, (size_t)(n > m ? n : m) * sizeof *p->d);
    for (int i = 0; i < m; i++)
        p->d[i] = -r[i];
    ct_lstsq(p->d, p->A, m, n, m, unmet, p->iwork, p->work);
}

static void evaluate(struct probe *p)
{
    ct_machine_set(p->m, p->t, p->y);
    ct_machine_constraint(p->m);
}

// Move by `way` [rad or m] in a direction of no meaning that J allows.
static void move(struct probe *p, struct ct_arena *scratch, double way)
{
    const size_t n = p->m->nu, m = p->m->nrow;
    double *r = CT_NEWN(scratch, double, m + 1);
    evaluate(p);
    for (size_t k = 0; k < n; k++) {
        p->x[k] = fmod(1 + (double)k * 0.6180339887498949, 1) - 0.4; // in no simple relation
        for (size_t i = 0; i < m; i++)
            r[i] += p->m->J[i + m * k] * p->x[k];
    }
    least_step(p, r);
    for (size_t k = 0; k < n; k++)
        p->x[k] += p->d[k];
    const double size = ct_vector_largest(p->x, n);
    for (size_t k = 0; k < n && size > 0; k++)
        p->x[k] *= way / size;
    ct_machine_retract(p->m, p->y, p->x);
}

// Back onto the constraints; false if that does not succeed, or leads far away.
static bool close(struct probe *p, double way)
{
    enum { MOST = 20 };
    const double closed = 1e-9; // [m, rad]: far below what is looked for in J
    for (int i = 0; i < MOST; i++) {
        evaluate(p);
        if (ct_vector_largest(p->m->phi, p->m->nrow) < closed)
            return true;
        least_step(p, p->m->phi);
        if (!(ct_vector_largest(p->d, p->m->nu) < way))
            return false;
        ct_machine_retract(p->m, p->y, p->d);
    }
    return false;
}

// Rows of J by independence into p->row; how many are independent, what is left of others being less than this part of the
// largest.
static int find_rank(struct probe *p, double part)
{
    const int n = (int)p->m->nu, m = (int)p->m->nrow;
    for (int i = 0; i < m; i++)
        for (int j = 0; j < n; j++)
            p->A[j + n * i] = p->m->J[i + m * j];
    return ct_qr_pivot(p->A, p->row, p->x, n, m, n, part, p->work);
}

bool ct_singular_is_start(struct ct_arena *scratch, const struct ct_embed *s, double t,
                          const double *y, bool *row)
{
    enum { LARGE = 200 }; // where factors cost more than steps
    const double ways[] = {0.1, 0.02};
    const double part = 1e-3; // of J's change along the way, which is about as large as the way
    struct ct_machine *m = s->m;
    const size_t ny = m->nq + m->nu + 1, most = m->nu > m->nrow ? m->nu : m->nrow;
    int there = 0;
    if (!m->nrow || s->rank >= LARGE)
        return false;
    struct probe p = {.m = m, .t = t};
    p.y = CT_NEWN(scratch, double, ny);
    p.x = CT_NEWN(scratch, double, most + 1);
    p.d = CT_NEWN(scratch, double, most + 1);
    p.A = CT_NEWN(scratch, double, m->nu * m->nrow + 1);
    p.iwork = CT_NEWN(scratch, int, m->nu + 1);
    p.row = CT_NEWN(scratch, int, m->nrow + 1);
    p.work = workspace(scratch, (int)m->nu, (int)m->nrow);
    memcpy(p.y, y, ny * sizeof *p.y);
    evaluate(&p);
    const int here = find_rank(&p, unmet);
    for (size_t i = 0; i < COUNT(ways) && here < (int)m->nrow && there <= here; i++) {
        memcpy(p.y, y, ny * sizeof *p.y);
        move(&p, scratch, ways[i]);
        if (close(&p, ways[i]))
            there = find_rank(&p, part * ways[i]);
    }
    memset(row, 0, m->nrow * sizeof *row);
    for (int i = 0; i < there && there > here; i++)
        row[p.row[i]] = true;
    for (int i = 0; i < here; i++)
        row[s->row[i]] = false;
    memcpy(p.y, y, ny * sizeof *p.y);
    evaluate(&p);
    return there > here;
}
