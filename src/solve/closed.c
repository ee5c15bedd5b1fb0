// See closed.h.
#include "solve/closed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Beyond so many nodes code leaves the caches.
static const double most_nodes = 400000;

// ---- creation ---------------------------------------------------------------------------------------

static int ascending(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

static int *sorted(struct ct_arena *a, const int *v, size_t n)
{
    int *copy = CT_NEWN(a, int, n + 1);
    memcpy(copy, v, n * sizeof *copy);
    qsort(copy, n, sizeof *copy, ascending);
    return copy;
}

struct list {
    struct ct_arena *a;
    ct_ex *e;
    size_t n, cap;
};

static void push(struct list *l, const ct_ex *e, size_t n)
{
    for (size_t i = 0; i < n; i++)
        CT_PUSH(l->a, l->e, l->n, l->cap, e[i]);
}

static void compile_solved(struct ct_form *f, struct ct_machine *m, const struct ct_exs *x)
{
    struct list l = {.a = f->arena};
    push(&l, f->c->a, m->nu);
    for (size_t i = 0; i < m->nq; i++)
        push(&l, &m->e->q[i].rate, 1);
    push(&l, f->c->inertia, f->c->nfree);
    push(&l, f->c->pivot, f->c->npivot);
    ct_machine_compile(f->arena, m, x, l.e, l.n, &f->solved);
}

static void compile_checked(struct ct_form *f, struct ct_machine *m, const struct ct_exs *x)
{
    const struct ct_closed *c = f->c;
    struct list l = {.a = f->arena};
    push(&l, c->better_a, m->nu);
    push(&l, c->better_lam, c->rank);
    push(&l, c->residual, m->nu + c->rank);
    push(&l, c->better_residual, m->nu + c->rank);
    push(&l, m->e->Q, m->nu);
    for (size_t i = 0; i < c->rank; i++)
        push(&l, &m->e->row[c->row[i]].gam, 1);
    push(&l, c->B, c->nB);
    ct_machine_compile(f->arena, m, x, l.e, l.n, &f->checked);
    f->a = f->checked.out;
    f->lam = f->a + m->nu;
}

static void compile_closing(struct ct_form *f, struct ct_machine *m, const struct ct_exs *x)
{
    const struct ct_closed *c = f->c;
    struct list l = {.a = f->arena};
    for (size_t i = 0; i < m->nrow; i++)
        push(&l, &m->e->row[i].phi, 1);
    for (size_t i = 0; i < m->nrow; i++)
        push(&l, &m->e->row[i].v, 1);
    push(&l, c->dq, m->nu);
    push(&l, c->du, m->nu);
    push(&l, c->pivot, c->npivot);
    ct_machine_compile(f->arena, m, x, l.e, l.n, &f->closing);
    f->phi = f->closing.out;
    f->v = f->phi + m->nrow;
    f->dq = f->v + m->nrow;
    f->du = f->dq + m->nu;
}

static double largest(const double *v, size_t n)
{
    double max = 0;
    for (size_t i = 0; i < n; i++)
        max = fabs(v[i]) > max || isnan(v[i]) ? fabs(v[i]) : max;
    return max;
}

static long operations_of(const struct ct_program *p)
{
    const struct ct_tape_counts c = p->listing->counts;
    return c.multiplications + c.additions + c.divisions + c.functions;
}

struct ct_form *ct_form_create(struct ct_arena *a, struct ct_machine *m,
                               const struct ct_partition *p, double operations)
{
    struct ct_arena *own = ct_arena_create_under(a);
    struct ct_form *f = CT_NEW(own, struct ct_form);
    struct ct_exs *x = ct_exs_clone(own, m->e->x);
    const double *J = m->Q + m->nu;
    *f = (struct ct_form){.arena = own,
                          .row = sorted(own, p->row, p->rank),
                          .dependent = sorted(own, p->dependent, p->rank),
                          .M_size = largest(m->motion.out, m->e->nM),
                          .J_size = largest(J, m->e->nJ)};
    // a call of a solver costs about as much as so many operations; the checks are twice the solution again
    const double call = 500, most = fmin(4 * (operations + call), most_nodes);
    f->c = ct_closed_derive(own, x, m->e, p, J, (size_t)most);
    if (f->c)
        compile_solved(f, m, x);
    if (!f->c
        || (double)(operations_of(&f->solved) - operations_of(&m->motion))
               > operations + call) {
        ct_form_destroy(m, f);
        return NULL;
    }
    compile_checked(f, m, x);
    compile_closing(f, m, x);
    return f;
}

void ct_form_destroy(struct ct_machine *m, struct ct_form *f)
{
    struct ct_program *const all[] = {&f->solved, &f->checked, &f->closing};
    for (size_t i = 0; i < COUNT(all); i++)
        ct_machine_forget(m, all[i]);
    ct_arena_destroy(f->arena);
}

bool ct_form_is_for(const struct ct_form *f, const struct ct_partition *p)
{
    // both lists are small sets of distinct places
    size_t n = 0;
    if (f->c->rank != p->rank)
        return false;
    for (size_t i = 0; i < p->rank; i++) {
        n += bsearch(&p->row[i], f->row, p->rank, sizeof *f->row, ascending) != NULL;
        n += bsearch(&p->dependent[i], f->dependent, p->rank, sizeof *f->dependent, ascending)
          != NULL;
    }
    return n == 2 * p->rank;
}

// ---- evaluation -----------------------------------------------------------------------------------------

static double strength(const struct ct_form *f, const double *pivot)
{
    double least = 1;
    for (size_t i = 0; i < f->c->npivot; i++)
        least = fmin(least, fabs(pivot[i]) * f->c->scale[i]);
    return least;
}

double ct_form_solve(struct ct_form *f, struct ct_machine *m, double *a)
{
    const double *out = f->solved.out, *inertia = out + m->nu + m->nq;
    m->evaluations++;
    ct_program_run(&f->solved, m->input);
    for (size_t i = 0; i < f->c->nfree; i++)
        if (!(inertia[i] > 0))
            return 0;
    for (size_t i = 0; i < m->nu; i++)
        if (!isfinite(out[i]))
            return 0;
    memcpy(a, out, m->nu * sizeof *a);
    memcpy(m->rate, out + m->nu, m->nq * sizeof *m->rate);
    return strength(f, inertia + f->c->nfree);
}

// r (nu + rank) against the largest terms of its equations. NaN counts as infinite.
static double relative(const struct ct_form *f, const double *r, size_t nu, const double *Q)
{
    const double *gam = Q + nu, a = largest(f->a, nu);
    const double forces = fmax(largest(Q, nu), f->M_size * a);
    const double rates = fmax(largest(gam, f->c->rank), f->J_size * a);
    const double r0 = largest(r, nu), r1 = largest(r + nu, f->c->rank);
    const double left = fmax(r0 > 0 ? r0 / forces : 0, r1 > 0 ? r1 / rates : 0);
    return isfinite(r0) && isfinite(r1) ? left : INFINITY;
}

void ct_form_check(struct ct_form *f, struct ct_machine *m)
{
    const size_t n = m->nu + f->c->rank;
    const double *r = f->lam + f->c->rank, *better = r + n, *Q = better + n;
    ct_program_run(&f->checked, m->input);
    f->left = relative(f, r, m->nu, Q);
    f->left_better = relative(f, better, m->nu, Q);
    f->kappa = largest(Q + n, f->c->nB);
}

double ct_form_close(struct ct_form *f, struct ct_machine *m)
{
    ct_program_run(&f->closing, m->input);
    return strength(f, f->du + m->nu);
}
