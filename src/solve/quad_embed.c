// See quad_embed.h.
#include "solve/quad_embed.h"
#include "solve/quad_program.h"

#include <math.h>
#include <string.h>

#ifdef CT_HAVE_QUADMATH

typedef ct_quad quad;

struct ct_quad_embed {
    const struct ct_machine *m;
    struct ct_quad_program motion, constraint;
    quad *input, *out;       // of the machine's layout; of the larger program
    quad *J;                 // (nrow x nu)
    quad *Jd, *B;            // (rank x rank), (rank x free)
    quad *M, *S;             // (nu x nu), (free x free)
    quad *c, *b, *d, *f;     // (nu + nrow) each
    int *pivot, *pivot_of_S; // (rank), (free)
};

static quad size_of(quad a)
{
    return a < 0 ? -a : a;
}

// ---- dense factors --------------------------------------------------------------------------------------------

// A (n x n) = P L U in place. False if it is singular.
static bool factor(quad *A, int *pivot, int n)
{
    for (int k = 0; k < n; k++) {
        int p = k;
        for (int i = k + 1; i < n; i++)
            p = size_of(A[i + n * k]) > size_of(A[p + n * k]) ? i : p;
        pivot[k] = p;
        for (int j = 0; j < n && p != k; j++) {
            const quad x = A[k + n * j];
            A[k + n * j] = A[p + n * j];
            A[p + n * j] = x;
        }
        if (!(size_of(A[k + n * k]) > 0))
            return false;
        for (int i = k + 1; i < n; i++)
            A[i + n * k] /= A[k + n * k];
        for (int j = k + 1; j < n; j++)
            for (int i = k + 1; i < n; i++)
                A[i + n * j] -= A[i + n * k] * A[k + n * j];
    }
    return true;
}

// b (n) <- A^-1 b.
static void solve(const quad *A, const int *pivot, int n, quad *b)
{
    for (int k = 0; k < n; k++) {
        const quad x = b[pivot[k]];
        b[pivot[k]] = b[k];
        b[k] = x;
    }
    for (int k = 0; k < n; k++)
        for (int i = k + 1; i < n; i++)
            b[i] -= A[i + n * k] * b[k];
    for (int k = n - 1; k >= 0; k--) {
        b[k] /= A[k + n * k];
        for (int i = 0; i < k; i++)
            b[i] -= A[i + n * k] * b[k];
    }
}

// ---- closing --------------------------------------------------------------------------------------------------

static void scatter_J(struct ct_quad_embed *x, const quad *value)
{
    const struct ct_equations *e = x->m->e;
    for (size_t i = 0; i < e->nJ; i++)
        x->J[(size_t)e->J[i].row + x->m->nrow * (size_t)e->J[i].column] = value[i];
}

// phi, v into x->out, J_d in factors. False where it is singular.
static bool evaluate_constraint(struct ct_quad_embed *x, const struct ct_embed *s)
{
    const size_t nrow = x->m->nrow;
    const int r = s->rank;
    ct_quad_evaluate(&x->constraint, x->input, x->out);
    scatter_J(x, x->out + 2 * nrow);
    for (int j = 0; j < r; j++)
        for (int i = 0; i < r; i++)
            x->Jd[i + r * j] = x->J[(size_t)s->row[i] + nrow * (size_t)s->dependent[j]];
    return factor(x->Jd, x->pivot, r);
}

// p (4) <- p o (1, d/2) / |...|, which is a turn by d but for its cube.
static void turn(quad *p, const quad *d)
{
    const quad w[4] = {p[0], p[1], p[2], p[3]}, v[3] = {d[0] / 2, d[1] / 2, d[2] / 2};
    quad norm = 0;
    p[0] = w[0] - w[1] * v[0] - w[2] * v[1] - w[3] * v[2];
    p[1] = w[1] + w[0] * v[0] + w[2] * v[2] - w[3] * v[1];
    p[2] = w[2] + w[0] * v[1] + w[3] * v[0] - w[1] * v[2];
    p[3] = w[3] + w[0] * v[2] + w[1] * v[1] - w[2] * v[0];
    for (int i = 0; i < 4; i++)
        norm += p[i] * p[i];
    quad root = sqrt((double)norm);
    root = (root + norm / root) / 2; // to all digits
    for (int i = 0; i < 4; i++)
        p[i] /= root;
}

// q <- q (+) d, d (nu) a small motion in the speeds. 0: quaternions are normalised.
static void retract(struct ct_quad_embed *x, const quad *d)
{
    const struct ct_machine *m = x->m;
    quad *q = x->input + m->at_q;
    size_t next = 0;
    for (size_t k = 0; k < m->nu; k++) {
        if (m->e->u[k].q >= 0) {
            q[m->e->u[k].q] += d[k];
            continue;
        }
        while (m->e->q[next].quaternion != 0)
            next++;
        turn(q + next, d + k);
        next++;
        k += 2;
    }
}

// d (nu, out) = the correction of what depends for r (nrow); the largest of it.
static double correct(struct ct_quad_embed *x, const struct ct_embed *s, const quad *r)
{
    double most = 0;
    for (int i = 0; i < s->rank; i++)
        x->c[i] = -r[s->row[i]];
    solve(x->Jd, x->pivot, s->rank, x->c);
    memset(x->d, 0, x->m->nu * sizeof *x->d);
    for (int i = 0; i < s->rank; i++) {
        x->d[s->dependent[i]] = x->c[i];
        most = fmax(most, fabs((double)x->c[i]));
    }
    return most;
}

// What depends in x->input, from the rest of it. Newton doubles digits from 1e-16 on, so that the last correction tells.
static enum ct_eval close(struct ct_quad_embed *x, const struct ct_embed *s)
{
    enum { MOST = 12 };
    const double closed = 1e-20, stray = 1;
    quad *u = x->input + x->m->at_u;
    double moved = INFINITY;
    memset(x->d, 0, x->m->nu * sizeof *x->d);
    retract(x, x->d);
    for (int i = 0; i < MOST && !(moved < closed); i++) {
        if (!evaluate_constraint(x, s))
            return CT_EVAL_RETRY;
        moved = correct(x, s, x->out);
        if (!(moved < stray))
            return CT_EVAL_RETRY;
        retract(x, x->d);
    }
    if (!(moved < closed) || !evaluate_constraint(x, s))
        return CT_EVAL_RETRY;
    correct(x, s, x->out + x->m->nrow);
    for (size_t k = 0; k < x->m->nu; k++)
        u[k] += x->d[k];
    return CT_EVAL_OK;
}

static void take_input(struct ct_quad_embed *x)
{
    for (size_t i = 0; i < x->m->ninput; i++)
        x->input[i] = x->m->input[i];
}

enum ct_eval ct_quad_embed_project(struct ct_quad_embed *x, const struct ct_embed *s, double t,
                                   double *y)
{
    const size_t n = x->m->nq + x->m->nu;
    take_input(x);
    x->input[0] = t;
    for (size_t i = 0; i < n; i++)
        x->input[x->m->at_q + i] = y[i];
    const enum ct_eval e = close(x, s);
    for (size_t i = 0; i < n && e == CT_EVAL_OK; i++)
        y[i] = (double)x->input[x->m->at_q + i];
    return e;
}

// ---- accelerations ----------------------------------------------------------------------------------------------

// B = -J_d^-1 J_i, and c = -J_d^-1 gam, J_d in factors.
static void find_tangents(struct ct_quad_embed *x, const struct ct_embed *s, const quad *gam)
{
    const int r = s->rank, free = (int)x->m->nu - r;
    for (int j = 0; j < free; j++) {
        for (int i = 0; i < r; i++)
            x->B[i + r * j] = -x->J[(size_t)s->row[i] + x->m->nrow * (size_t)s->independent[j]];
        solve(x->Jd, x->pivot, r, x->B + r * j);
    }
    for (int i = 0; i < r; i++)
        x->c[i] = -gam[s->row[i]];
    solve(x->Jd, x->pivot, r, x->c);
}

// v (free, out) = [B; 1]' w for w (nu)
static void reduce(const struct ct_quad_embed *x, const struct ct_embed *s, const quad *w,
                   quad *v)
{
    const int r = s->rank, free = (int)x->m->nu - r;
    for (int j = 0; j < free; j++) {
        v[j] = w[s->independent[j]];
        for (int k = 0; k < r; k++)
            v[j] += x->B[k + r * j] * w[s->dependent[k]];
    }
}

// S = [B; 1]' M [B; 1], b = [B; 1]' (Q - M c).
static void reduce_system(struct ct_quad_embed *x, const struct ct_embed *s, const quad *Q)
{
    const int r = s->rank, n = (int)x->m->nu, free = n - r;
    for (int j = 0; j < free; j++) {
        for (int i = 0; i < n; i++) {
            x->f[i] = x->M[i + n * s->independent[j]];
            for (int k = 0; k < r; k++)
                x->f[i] += x->M[i + n * s->dependent[k]] * x->B[k + r * j];
        }
        reduce(x, s, x->f, x->S + free * j);
    }
    for (int i = 0; i < n; i++) {
        x->f[i] = Q[i];
        for (int k = 0; k < r; k++)
            x->f[i] -= x->M[i + n * s->dependent[k]] * x->c[k];
    }
    reduce(x, s, x->f, x->b);
}

enum ct_eval ct_quad_embed_accelerate(struct ct_quad_embed *x, const struct ct_embed *s,
                                      double *a, double *rate)
{
    const struct ct_equations *e = x->m->e;
    const int r = s->rank, n = (int)x->m->nu, free = n - r;
    take_input(x);
    if (close(x, s) != CT_EVAL_OK)
        return CT_EVAL_RETRY;
    ct_quad_evaluate(&x->motion, x->input, x->out);
    const quad *Q = x->out + e->nM, *J = Q + n, *gam = J + e->nJ, *q1 = gam + x->m->nrow;
    for (size_t i = 0; i < e->nM; i++) {
        const int k = e->M[i].row, l = e->M[i].column;
        x->M[k + n * l] = x->M[l + n * k] = x->out[i];
    }
    find_tangents(x, s, gam);
    reduce_system(x, s, Q);
    if (!factor(x->S, x->pivot_of_S, free))
        return CT_EVAL_RETRY;
    solve(x->S, x->pivot_of_S, free, x->b);
    for (int j = 0; j < free; j++)
        a[s->independent[j]] = (double)x->b[j];
    for (int i = 0; i < r; i++) {
        for (int j = 0; j < free; j++)
            x->c[i] += x->B[i + r * j] * x->b[j];
        a[s->dependent[i]] = (double)x->c[i];
    }
    for (size_t i = 0; i < x->m->nq; i++)
        rate[i] = (double)q1[i];
    return CT_EVAL_OK;
}

struct ct_quad_embed *ct_quad_embed_create(struct ct_arena *a, const struct ct_machine *m)
{
    enum {
        MOST = 60
    }; // unknowns: factors then cost more than a thousand evaluations in double precision
    const size_t n = m->nu, most = m->motion.nout + m->constraint.nout + 1;
    if (n > MOST || !m->nrow || !m->e->has_dynamics || m->e->x->ntable)
        return NULL;
    struct ct_quad_embed *x = CT_NEW(a, struct ct_quad_embed);
    *x = (struct ct_quad_embed){.m = m,
                                .motion = ct_quad_load(a, &m->motion),
                                .constraint = ct_quad_load(a, &m->constraint)};
    quad **const square[] = {&x->Jd, &x->B, &x->M, &x->S};
    for (size_t i = 0; i < COUNT(square); i++)
        *square[i] = CT_NEWN(a, quad, n * n + 1);
    quad **const vectors[] = {&x->c, &x->b, &x->d, &x->f};
    for (size_t i = 0; i < COUNT(vectors); i++)
        *vectors[i] = CT_NEWN(a, quad, n + m->nrow + 1);
    x->input = CT_NEWN(a, quad, m->ninput);
    x->out = CT_NEWN(a, quad, most);
    x->J = CT_NEWN(a, quad, m->nrow * n + 1);
    x->pivot = CT_NEWN(a, int, n + 1);
    x->pivot_of_S = CT_NEWN(a, int, n + 1);
    return x;
}

#else

enum ct_eval ct_quad_embed_project(struct ct_quad_embed *x, const struct ct_embed *s, double t,
                                   double *y)
{
    (void)x, (void)s, (void)t, (void)y;
    return CT_EVAL_RETRY;
}

enum ct_eval ct_quad_embed_accelerate(struct ct_quad_embed *x, const struct ct_embed *s,
                                      double *a, double *rate)
{
    (void)x, (void)s, (void)a, (void)rate;
    return CT_EVAL_RETRY;
}

struct ct_quad_embed *ct_quad_embed_create(struct ct_arena *a, const struct ct_machine *m)
{
    (void)a, (void)m;
    return NULL;
}

#endif
