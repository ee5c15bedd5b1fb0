// Collecting the reduced equations; see reduced.h.
#include "report/reduced.h"

#include "expr/collect.h"
#include "formulate/dynamics.h"

// Beyond this many nodes of an expanded expression nobody reads it as a formula of its own, and
// collecting takes seconds.
static const double largest_collected = 20000;

struct quaternions {
    ct_ex (*at)[4];
    size_t n;
};

static struct quaternions quaternions_of(struct ct_arena *a, const struct ct_equations *e)
{
    struct quaternions s = {ct_arena_calloc(a, e->nq + 1, sizeof *s.at), 0};
    for (size_t i = 0; i + 3 < e->nq; i++) {
        if (e->q[i].quaternion != 0)
            continue;
        for (size_t k = 0; k < 4; k++)
            s.at[s.n][k] = e->q[i + k].symbol;
        s.n++;
    }
    return s;
}

static ct_ex collect(struct ct_equations *e, ct_ex v)
{
    if (ct_ex_is_zero(v) || ct_ex_is_const(e->x, v, NULL) || ct_ex_symbol(e->x, v))
        return v;
    struct ct_arena *work = ct_arena_create();
    if (!work)
        return v;
    const struct quaternions s = quaternions_of(work, e);
    const struct ct_collect_options o = {.scratch = work, .quaternion = s.at, .nquaternion = s.n};
    v = ct_ex_collect(e->x, v, &o);
    ct_arena_destroy(work);
    return v;
}

// What is there at rest and what the speeds add, each collected: gravity stays apart from the
// centrifugal terms, even if both share a factor.
static ct_ex collect_force(struct ct_equations *e, struct ct_arena *a, ct_ex v)
{
    struct ct_exs *x = e->x;
    const ct_ex whole = collect(e, v);
    if (!(ct_ex_kinds(x, v) & 1u << CT_SYM_U))
        return whole;
    ct_ex *from = CT_NEWN(a, ct_ex, e->nu), *zero = CT_NEWN(a, ct_ex, e->nu);
    for (size_t i = 0; i < e->nu; i++)
        from[i] = e->u[i].symbol;
    const ct_ex still = collect(e, ct_ex_subst(x, v, from, zero, e->nu));
    const ct_ex moving = collect(e, ct_ex_sub(x, v, still));
    const ct_ex apart = ct_ex_add(x, moving, still);
    const double size = ct_ex_tree_size(x, a, apart), least = ct_ex_tree_size(x, a, whole);
    return size <= 1.5 * least + 8 ? apart : whole;
}

static double size_of_all(struct ct_equations *e, struct ct_arena *a)
{
    double size = 0;
    for (size_t i = 0; i < e->nM; i++)
        size += ct_ex_tree_size(e->x, a, e->M[i].value);
    for (size_t i = 0; i < e->nJ; i++)
        size += ct_ex_tree_size(e->x, a, e->J[i].value);
    for (size_t i = 0; i < e->nu; i++)
        size += ct_ex_tree_size(e->x, a, e->Q[i]);
    for (size_t i = 0; i < e->nrow; i++)
        size += ct_ex_tree_size(e->x, a, e->row[i].phi) + ct_ex_tree_size(e->x, a, e->row[i].gam);
    return size;
}

void ct_reduced_prepare(struct ct_arena *a, struct ct_equations *e, bool may_collect,
                        struct ct_reduced *r)
{
    *r = (struct ct_reduced){
        .M = CT_NEWN(a, ct_ex, e->nM + 1),
        .J = CT_NEWN(a, ct_ex, e->nJ + 1),
        .Q = CT_NEWN(a, ct_ex, e->nu + 1),
        .phi = CT_NEWN(a, ct_ex, e->nrow + 1),
        .gam = CT_NEWN(a, ct_ex, e->nrow + 1),
        .rate = CT_NEWN(a, ct_ex, e->nq + 1),
    };
    r->is_collected = may_collect && size_of_all(e, a) <= largest_collected;
    for (size_t i = 0; i < e->nM; i++)
        r->M[i] = r->is_collected ? collect(e, e->M[i].value) : e->M[i].value;
    for (size_t i = 0; i < e->nJ; i++)
        r->J[i] = r->is_collected ? collect(e, e->J[i].value) : e->J[i].value;
    for (size_t i = 0; i < e->nu; i++)
        r->Q[i] = r->is_collected ? collect_force(e, a, e->Q[i]) : e->Q[i];
    for (size_t i = 0; i < e->nrow; i++) {
        r->phi[i] = r->is_collected ? collect(e, e->row[i].phi) : e->row[i].phi;
        r->gam[i] = r->is_collected ? collect(e, e->row[i].gam) : e->row[i].gam;
    }
    for (size_t i = 0; i < e->nq; i++)
        r->rate[i] = collect(e, e->q[i].rate);
}

// M is symmetric and holds its lower triangle.
ct_ex ct_reduced_left(struct ct_equations *e, const struct ct_reduced *r, size_t i)
{
    ct_ex sum = CT_EX_ZERO;
    for (size_t k = 0; k < e->nM; k++) {
        const int row = e->M[k].row, column = e->M[k].column;
        if (row != (int)i && column != (int)i)
            continue;
        const ct_ex acceleration = e->u[row == (int)i ? column : row].derivative;
        sum = ct_ex_add(e->x, sum, ct_ex_mul(e->x, r->M[k], acceleration));
    }
    return sum;
}

ct_ex ct_reduced_right(struct ct_equations *e, const struct ct_reduced *r, size_t i)
{
    ct_ex sum = r->Q[i];
    for (size_t k = 0; k < e->nJ; k++)
        if (e->J[k].column == (int)i)
            sum = ct_ex_add(e->x, sum, ct_ex_mul(e->x, r->J[k], e->row[e->J[k].row].lam));
    return sum;
}

ct_ex ct_reduced_row_left(struct ct_equations *e, const struct ct_reduced *r, size_t row)
{
    ct_ex sum = CT_EX_ZERO;
    for (size_t k = 0; k < e->nJ; k++)
        if (e->J[k].row == (int)row)
            sum = ct_ex_add(e->x, sum,
                            ct_ex_mul(e->x, r->J[k], e->u[e->J[k].column].derivative));
    return sum;
}
