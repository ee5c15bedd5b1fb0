// See residual.h.
//
// Coordinates are varied along the motions that speeds stand for: dq_i = sum_k Z_ik de_k with q' = Z(q) u.
// For a plain coordinate that is the coordinate itself, for a quaternion a body rotation.
#include "formulate/residual.h"
#include "formulate/composite.h"
#include "formulate/open.h"

// Directions of the seeds: the speeds k as variations of the place, of the speed, of u'.
enum { PLACE, SPEED, ACCELERATION, NLEVEL };

struct seeds {
    struct ct_arena *a; // NULL: scratch
    struct ct_seed *e;
    size_t n, cap;
};

static void plant(struct ct_build *b, struct seeds *s, ct_ex symbol, size_t direction,
                  ct_ex value)
{
    const struct ct_seed seed = {symbol, (uint32_t)direction, value};
    CT_PUSH(s->a ? s->a : b->ctx->scratch, s->e, s->n, s->cap, seed);
}

static size_t direction(const struct ct_build *b, int level, size_t speed)
{
    return (size_t)level * b->eqs->nu + speed;
}

// Z, as seeds of the coordinates.
static void plant_places(struct ct_build *b, struct seeds *s)
{
    const struct ct_equations *e = b->eqs;
    struct ct_arena *scratch = b->ctx->scratch;
    struct seeds speeds = {0};
    struct ct_slope *Z;
    ct_ex *rate = CT_NEWN(scratch, ct_ex, e->nq + 1);
    for (size_t i = 0; i < e->nq; i++)
        rate[i] = e->q[i].rate;
    for (size_t k = 0; k < e->nu; k++)
        plant(b, &speeds, e->u[k].symbol, k, CT_EX_ONE);
    const size_t nZ
        = ct_ex_jacobian(b->x, scratch, scratch, rate, e->nq, speeds.e, speeds.n, &Z);
    for (size_t i = 0; i < nZ; i++)
        plant(b, s, e->q[Z[i].row].symbol, direction(b, PLACE, Z[i].direction), Z[i].value);
}

// The entries of one level out of all, their directions counted from 0.
static size_t pick(struct ct_build *b, const struct ct_slope *all, size_t n, int level,
                   struct ct_slope **out)
{
    size_t nout = 0, cap = 0;
    *out = NULL;
    for (size_t i = 0; i < n; i++) {
        struct ct_slope s = all[i];
        // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): without speeds there is no slope
        if (s.direction / b->eqs->nu != (size_t)level)
            continue;
        s.direction %= (uint32_t)b->eqs->nu;
        CT_PUSH(b->arena, *out, nout, cap, s);
    }
    return nout;
}

// M u' - Q - J' lam, where M and Q are not those of the sweep.
static void assemble_rows(struct ct_build *b, ct_ex *r)
{
    const struct ct_equations *e = b->eqs;
    struct ct_exs *x = b->x;
    for (size_t k = 0; k < e->nu; k++)
        r[k] = ct_ex_neg(x, e->Q[k]);
    for (size_t i = 0; i < e->nM; i++) {
        const int k = e->M[i].row, l = e->M[i].column;
        r[k] = ct_ex_add(x, r[k], ct_ex_mul(x, e->M[i].value, e->u[l].derivative));
        if (k != l)
            r[l] = ct_ex_add(x, r[l], ct_ex_mul(x, e->M[i].value, e->u[k].derivative));
    }
    for (size_t i = 0; i < e->nJ; i++) {
        const int k = e->J[i].column;
        r[k] = ct_ex_sub(x, r[k], ct_ex_mul(x, e->J[i].value, e->row[e->J[i].row].lam));
    }
}

// The sweep in ground axes or, in space, inverse dynamics in axes of the bodies, whichever takes fewer operations.
static void derive_rows(struct ct_build *b, ct_ex *r)
{
    const size_t n = b->eqs->nu;
    const struct ct_members *s = b->is_planar ? NULL : ct_members_derive(b);
    for (size_t k = 0; k < n; k++)
        r[k] = ct_sweep_residual(b, (int)k);
    if (!s)
        return;
    ct_ex *by_members = CT_NEWN(b->ctx->scratch, ct_ex, n + 1);
    ct_composite_residual(b, s, b->effort, by_members);
    const struct ct_tape_counts swept = ct_ex_count(b->ctx->scratch, b->x, r, n),
                                other = ct_ex_count(b->ctx->scratch, b->x, by_members, n);
    for (size_t k = 0; k < n && ct_counted_cost(&other) < ct_counted_cost(&swept); k++)
        r[k] = by_members[k];
}

void ct_residual_rows(struct ct_build *b)
{
    struct ct_equations *e = b->eqs;
    if (e->residual)
        return;
    e->residual = CT_NEW(b->arena, struct ct_residual);
    e->residual->r = CT_NEWN(b->arena, ct_ex, e->nu + 1);
    if (e->is_truncated)
        assemble_rows(b, e->residual->r);
    else
        derive_rows(b, e->residual->r);
}

size_t ct_residual_seeds(struct ct_build *b, struct ct_arena *a, struct ct_seed **out,
                         size_t *nplace)
{
    const struct ct_equations *e = b->eqs;
    struct seeds seeds = {.a = a};
    plant_places(b, &seeds);
    *nplace = seeds.n;
    for (size_t k = 0; k < e->nu; k++) {
        plant(b, &seeds, e->u[k].symbol, direction(b, SPEED, k), CT_EX_ONE);
        plant(b, &seeds, e->u[k].derivative, direction(b, ACCELERATION, k), CT_EX_ONE);
    }
    *out = seeds.e;
    return seeds.n;
}

void ct_residual_derive(struct ct_build *b)
{
    struct ct_equations *e = b->eqs;
    struct ct_arena *scratch = b->ctx->scratch;
    struct ct_seed *seed;
    struct ct_slope *all;
    size_t nplace;
    ct_residual_rows(b);
    struct ct_residual *f = e->residual;
    f->has_slopes = true;
    const size_t nseed = ct_residual_seeds(b, scratch, &seed, &nplace);
    const size_t n = ct_ex_jacobian(b->x, scratch, scratch, f->r, e->nu, seed, nseed, &all);
    f->ndq = pick(b, all, n, PLACE, &f->dq);
    f->ndu = pick(b, all, n, SPEED, &f->du);
    f->nda = pick(b, all, n, ACCELERATION, &f->da);
    ct_ex *v = CT_NEWN(scratch, ct_ex, e->nrow + 1);
    for (size_t i = 0; i < e->nrow; i++)
        v[i] = e->row[i].v;
    f->ndv = ct_ex_jacobian(b->x, scratch, b->arena, v, e->nrow, seed, nplace, &f->dv);
}

size_t ct_slopes_derive(struct ct_build *b, struct ct_arena *a, const ct_ex *f, size_t nf,
                        const ct_ex *more, size_t nmore, struct ct_slope **out)
{
    struct ct_equations *e = b->eqs;
    struct seeds seeds = {0};
    size_t nplace;
    seeds.n = seeds.cap = ct_residual_seeds(b, b->ctx->scratch, &seeds.e, &nplace);
    const size_t first = direction(b, NLEVEL, 0);
    for (size_t i = 0; i < e->nrow; i++)
        plant(b, &seeds, e->row[i].lam, first + i, CT_EX_ONE);
    for (size_t i = 0; i < nmore; i++)
        plant(b, &seeds, more[i], first + e->nrow + i, CT_EX_ONE);
    return ct_ex_jacobian(b->x, b->ctx->scratch, a, f, nf, seeds.e, seeds.n, out);
}
