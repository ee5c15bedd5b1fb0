// Symbolic solver: the equations of systems with loops are eliminated as expressions, which are
// compiled to three programs; see solver.h.
//
//     solved    u', q'                                   run at every evaluation
//     checked   refined u' and lam, residuals            run in checks, at most once a step
//     closing   Phi, v and the corrections for them      run in projections
#include "codegen/native.h"
#include "numeric/dense.h"
#include "solve/constraint/solver.h"

#include <math.h>
#include <string.h>

struct symbolic_solver {
    struct ct_solver base;
    const struct ct_closed *c;
    size_t nmotion; // speeds without the model's states
    struct ct_program solved, checked, closing;
    double M_size, J_size; // largest entries where it was made
    bool has_power;        // is the last output of `solved`
    double *most;          // (nfree) largest value of each inertia so far
};

static struct symbolic_solver *symbolic_solver_of(struct ct_solver *f)
{
    return (struct symbolic_solver *)f; // its first member
}

// ---- creation ----------------------------------------

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

// Can the power be computed with the accelerations, as it depends on neither u' nor lam?
static bool has_power(const struct ct_equations *e)
{
    const unsigned later = 1u << CT_SYM_A | 1u << CT_SYM_LAM;
    return !ct_ex_is_zero(e->power) && !(ct_ex_kinds(e->x, e->power) & later);
}

static void compile_solved(struct symbolic_solver *f, struct ct_evaluator *m,
                           const struct ct_exs *x)
{
    struct list l = {.a = f->base.arena};
    push(&l, f->c->a, m->nu);
    for (size_t i = 0; i < m->nq; i++)
        push(&l, &m->e->q[i].rate, 1);
    push(&l, f->c->inertia, f->c->nfree);
    push(&l, f->c->pivot, f->c->npivot);
    f->has_power = has_power(m->e);
    if (f->has_power)
        push(&l, &m->e->power, 1);
    ct_evaluator_add_solution(f->base.arena, m, x, l.e, l.n, &f->solved);
}

static void compile_checked(struct symbolic_solver *f, struct ct_evaluator *m,
                            const struct ct_exs *x)
{
    const struct ct_closed *c = f->c;
    struct list l = {.a = f->base.arena};
    push(&l, c->better_a, m->nu);
    push(&l, c->better_lam, c->rank);
    push(&l, c->residual, m->nu + c->rank);
    push(&l, c->better_residual, m->nu + c->rank);
    push(&l, m->e->Q, m->nu);
    for (size_t i = 0; i < c->rank; i++)
        push(&l, &m->e->row[c->row[i]].gam, 1);
    push(&l, c->B, c->nB);
    ct_evaluator_add_program(f->base.arena, m, x, l.e, l.n, &f->checked);
    f->base.a = f->checked.out;
    f->base.lam = f->base.a + m->nu;
}

static void compile_closing(struct symbolic_solver *f, struct ct_evaluator *m,
                            const struct ct_exs *x)
{
    const struct ct_closed *c = f->c;
    struct list l = {.a = f->base.arena};
    for (size_t i = 0; i < m->nrow; i++)
        push(&l, &m->e->row[i].phi, 1);
    for (size_t i = 0; i < m->nrow; i++)
        push(&l, &m->e->row[i].v, 1);
    push(&l, c->dq, m->nu);
    push(&l, c->du, m->nu);
    push(&l, c->shift, c->nshift);
    push(&l, c->pivot, c->npivot);
    ct_evaluator_add_program(f->base.arena, m, x, l.e, l.n, &f->closing);
    f->base.phi = f->closing.out;
    f->base.v = f->base.phi + m->nrow;
    f->base.dq = f->base.v + m->nrow;
    f->base.du = f->base.dq + m->nu;
    f->base.shift = c->nshift ? f->base.du + m->nu : NULL;
}

// ---- evaluation ----------------------------------------

static double strength(struct symbolic_solver *f, const double *pivot)
{
    double least = INFINITY, volume = 1;
    for (size_t i = 0; i < f->c->npivot; i++) {
        const double size = fabs(pivot[i]) * f->c->scale[i];
        least = size < least ? size : least;
        volume *= pivot[i] * f->c->scale[i];
    }
    f->base.weakest = least;
    f->base.volume = volume;
    return least < 1 ? least : 1;
}

static double solve(struct ct_solver *base, struct ct_evaluator *m, double *a)
{
    struct symbolic_solver *f = symbolic_solver_of(base);
    const double *out = f->solved.out, *inertia = out + m->nu + m->nq;
    m->evaluations++;
    ct_program_run(&f->solved, m->input);
    base->has_fallen = false;
    for (size_t i = 0; i < f->c->nfree; i++) {
        if (!(inertia[i] > 0))
            return 0;
        if (inertia[i] > f->most[i])
            f->most[i] = inertia[i];
        base->has_fallen |= inertia[i] < base->least_part * f->most[i];
    }
    for (size_t i = 0; i < m->nu; i++) {
        a[i] = out[i];
        if (!isfinite(a[i]))
            return 0;
    }
    ct_evaluator_copy(m->rate, out + m->nu, m->nq);
    return strength(f, inertia + f->c->nfree);
}

// The residual r (nu + rank) relative to the largest terms of the equations. Equations of the
// model's own states are excluded. NaN counts as infinite.
static double relative(const struct symbolic_solver *f, const double *r, size_t nu,
                       const double *Q)
{
    const size_t n = f->nmotion;
    const double *gam = Q + nu, a = ct_vector_max_norm(f->base.a, n);
    const double forces = fmax(ct_vector_max_norm(Q, n), f->M_size * a);
    const double rates = fmax(ct_vector_max_norm(gam, f->c->rank), f->J_size * a);
    const double r0 = ct_vector_max_norm(r, n), r1 = ct_vector_max_norm(r + nu, f->c->rank);
    const double left = fmax(r0 > 0 ? r0 / forces : 0, r1 > 0 ? r1 / rates : 0);
    return isfinite(r0) && isfinite(r1) ? left : INFINITY;
}

static void check(struct ct_solver *base, struct ct_evaluator *m)
{
    struct symbolic_solver *f = symbolic_solver_of(base);
    const size_t n = m->nu + f->c->rank;
    const double *r = base->lam + f->c->rank, *better = r + n, *Q = better + n;
    ct_program_run(&f->checked, m->input);
    base->remainder = relative(f, r, m->nu, Q);
    base->refined_remainder = relative(f, better, m->nu, Q);
    base->kappa
        = base->kind == &ct_solver_symbolic_kkt ? NAN : ct_vector_max_norm(Q + n, f->c->nB);
}

static double close(struct ct_solver *base, struct ct_evaluator *m)
{
    struct symbolic_solver *f = symbolic_solver_of(base);
    ct_program_run(&f->closing, m->input);
    return strength(f, base->du + m->nu + f->c->nshift);
}

static void destroy(struct ct_solver *base, struct ct_evaluator *m)
{
    struct symbolic_solver *f = symbolic_solver_of(base);
    struct ct_program *const all[] = {&f->solved, &f->checked, &f->closing};
    for (size_t i = 0; i < COUNT(all); i++)
        ct_evaluator_remove_program(m, all[i]);
}

// Bytes of machine code; if there is none, the estimate for code without loops.
static double code_size(const struct symbolic_solver *f)
{
    return f->solved.native ? (double)ct_native_code_size(f->solved.native)
                            : ct_solver_code_size(f->base.operations);
}

static struct ct_solver *create(struct ct_arena *a, struct ct_evaluator *m,
                                const struct ct_partition_sets *p, double most_nodes,
                                const struct ct_solver_kind *kind)
{
    struct ct_arena *own = ct_arena_create_under(a);
    struct symbolic_solver *f = CT_NEW(own, struct symbolic_solver);
    struct ct_exs *x = ct_exs_clone(own, m->e->x);
    const double *J = m->Q + m->nu;
    struct ct_partition_sets valued = *p;
    if (!valued.value)
        valued.value = ct_solver_values(own, m);
    f->base = (struct ct_solver){.kind = kind, .arena = own};
    ct_solver_set_partition(&f->base, p);
    f->M_size = ct_vector_max_norm(m->motion.out, m->e->nM);
    f->J_size = ct_vector_max_norm(J, m->e->nJ);
    f->nmotion = m->e->nmotion;
    f->c = ct_closed_derive(own, x, m->e, &valued, m->motion.out, J,
                            kind == &ct_solver_symbolic_kkt ? CT_CLOSED_KKT
                                                            : CT_CLOSED_PARTITION,
                            (size_t)most_nodes);
    if (!f->c) {
        ct_arena_destroy(own);
        return NULL;
    }
    f->most = CT_NEWN(own, double, f->c->nfree + 1);
    compile_solved(f, m, x);
    compile_checked(f, m, x);
    compile_closing(f, m, x);
    f->base.operations = ct_solver_operations(&f->solved);
    f->base.cost = ct_solver_straight_cost(f->base.operations, code_size(f));
    return &f->base;
}

static struct ct_solver *create_partitioned(struct ct_arena *a, struct ct_evaluator *m,
                                            const struct ct_partition_sets *p,
                                            double most_nodes)
{
    return create(a, m, p, most_nodes, &ct_solver_symbolic);
}

static struct ct_solver *create_whole(struct ct_arena *a, struct ct_evaluator *m,
                                      const struct ct_partition_sets *p, double most_nodes)
{
    // where the constraints determine all accelerations, M is not needed
    return p->nfree ? create(a, m, p, most_nodes, &ct_solver_symbolic_kkt) : NULL;
}

const struct ct_solver_kind ct_solver_symbolic = {.name = "unrolled",
                                                  .create = create_partitioned,
                                                  .solve = solve,
                                                  .check = check,
                                                  .close = close,
                                                  .destroy = destroy};

const struct ct_solver_kind ct_solver_symbolic_kkt = {.name = "unrolled as one system",
                                                      .create = create_whole,
                                                      .solve = solve,
                                                      .check = check,
                                                      .close = close,
                                                      .destroy = destroy};

struct ct_solver_code ct_solver_code(const struct ct_solver *base)
{
    if (base->kind != &ct_solver_symbolic && base->kind != &ct_solver_symbolic_kkt)
        return (struct ct_solver_code){0};
    const struct symbolic_solver *f = (const struct symbolic_solver *)base;
    return (struct ct_solver_code){f->solved.listing, f->c->nfree, f->c->npivot, f->c->scale,
                                   &f->solved,        &f->checked, &f->closing,  f->c->nB,
                                   f->c->nshift,      f->M_size,   f->J_size,    f->has_power};
}
