// Impulses: speeds after the rates of drivers have jumped. See run_internal.h.
// Both kinds of jump solve the same problem with different quadratic forms, half u' W u + ...: find
// the speeds that J allows and whose change is smallest in that form. For an impulse it is the
// kinetic energy, and W is M. For `continuous` it is `continuity` of the equations: speeds of
// joints and beams, which do not depend on the trees. (8.5)
#include "solve/run/run_internal.h"

#include <string.h>

// This part of the kinetic energy is added, since speeds of joints do not determine the motion of a
// floating body. Joints then keep their speeds up to that part, and up to a higher power of it with
// each repetition. Derived: the third power is below the unit round-off.
static const double share_of_momentum = 1e-6;
enum { TIMES = 3 };

struct ct_impulse {
    double *W, *w, *first; // (nu x nu), (nu), (nu)
};

struct ct_impulse *ct_impulse_create(struct ct_arena *a, const struct ct_evaluator *m)
{
    struct ct_impulse *j = CT_NEW(a, struct ct_impulse);
    const bool is_kept = m->momentum.nout > m->nu;
    j->W = CT_NEWN(a, double, is_kept ? m->nu * m->nu + 1 : 1);
    j->w = CT_NEWN(a, double, m->nu + 1);
    j->first = CT_NEWN(a, double, m->nu + 1);
    return j;
}

// x (nu) += c A u.
static void add_product(double *x, double c, const double *A, const double *u, size_t n)
{
    for (size_t k = 0; k < n; k++)
        for (size_t i = 0; i < n; i++)
            x[i] += c * A[i + n * k] * u[k];
}

static double trace(const double *A, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += A[i + n * i];
    return sum;
}

// W (nu x nu): the gradient of `continuity` is linear in u.
static void find_quadratic_form(struct ct_evaluator *m, double *W, const double *u)
{
    const size_t n = m->nu;
    const double *gradient = m->momentum.out + n;
    double *at = m->input + m->at_u;
    memset(at, 0, n * sizeof *at);
    ct_program_run(&m->momentum, m->input);
    for (size_t k = 0; k < n; k++)
        for (size_t i = 0; i < n; i++)
            W[i + n * k] = -gradient[i];
    for (size_t k = 0; k < n; k++) {
        at[k] = 1;
        ct_program_run(&m->momentum, m->input);
        for (size_t i = 0; i < n; i++)
            W[i + n * k] += gradient[i];
        at[k] = 0;
    }
    memcpy(at, u, n * sizeof *at);
}

// w (nu) = before - after, of the gradient that begins at `first`, + W u.
static void find_right_side(const struct ct_evaluator *m, double *w, size_t first,
                            const double *before, const double *W, const double *u)
{
    for (size_t i = 0; i < m->nu; i++)
        w[i] = before[first + i] - m->momentum.out[first + i];
    add_product(w, 1, W, u, m->nu);
}

static enum ct_eval apply_continuous(struct ct_run *r, const double *before, double *u)
{
    struct ct_evaluator *m = r->m;
    struct ct_impulse *j = r->impulse;
    const size_t n = m->nu;
    find_quadratic_form(m, j->W, u);
    ct_program_run(&m->momentum, m->input);
    const double *M = ct_partition_mass(r->s), all = trace(M, n);
    const double share = all > 0 ? share_of_momentum * trace(j->W, n) / all : 0;
    double *w = j->w, *momentum = j->first;
    find_right_side(m, momentum, 0, before, M, u);
    find_right_side(m, w, n, before, j->W, u);
    for (size_t i = 0; i < n * n; i++)
        j->W[i] += share * M[i];
    for (size_t i = 0; i < n; i++)
        momentum[i] = w[i] + share * momentum[i];
    enum ct_eval e = ct_partition_impulse(r->s, j->W, momentum, u);
    for (int i = 1; i < TIMES && e == CT_EVAL_OK;
         i++) { // the right side of the first iteration is used in all of them
        memcpy(momentum, w, n * sizeof *w);
        add_product(momentum, share, M, u, n);
        e = ct_partition_impulse(r->s, j->W, momentum, u);
    }
    return e;
}

enum ct_eval ct_impulse_apply(struct ct_run *r, const double *before, double *u)
{
    struct ct_evaluator *m = r->m;
    ct_evaluator_dynamics(m);
    if (m->momentum.nout > m->nu)
        return apply_continuous(r, before, u);
    ct_program_run(&m->momentum, m->input);
    const double *M = ct_partition_mass(r->s);
    find_right_side(m, r->impulse->w, 0, before, M, u);
    return ct_partition_impulse(r->s, M, r->impulse->w, u);
}
