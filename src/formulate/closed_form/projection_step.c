// See projection_step.h.
#include "formulate/closed_form/projection_step.h"

// r (rank, out) = -D d of the rows. D d is the change of v by a displacement d (nu) at constant u.
static void negative_velocity_change(struct ct_arena *a, struct ct_exs *x,
                                     const struct ct_equations *e, const int *row, size_t rank,
                                     const ct_ex *d, ct_ex *r)
{
    ct_ex *q = CT_NEWN(a, ct_ex, e->nq + 1), *dq = CT_NEWN(a, ct_ex, e->nq + 1);
    ct_ex *u = CT_NEWN(a, ct_ex, e->nu + 1), *any = CT_NEWN(a, ct_ex, e->nu + 1);
    for (size_t k = 0; k < e->nu; k++) {
        u[k] = e->u[k].symbol;
        any[k]
            = e->u[k].derivative; // no row contains it: it stands for d, which is constant here
    }
    for (size_t i = 0; i < e->nq; i++) {
        q[i] = e->q[i].symbol;
        dq[i] = e->q[i].rate;
    }
    ct_ex_subst_list(x, dq, e->nq, u, any, e->nu);
    for (size_t i = 0; i < rank; i++)
        r[i] = ct_ex_diff_along(x, e->row[row[i]].v, q, dq, e->nq);
    ct_ex_subst_list(x, r, rank, any, d, e->nu);
    for (size_t i = 0; i < rank; i++)
        r[i] = ct_ex_neg(x, r[i]);
}

void ct_projection_step_derive(struct ct_arena *a, struct ct_exs *x,
                               const struct ct_equations *e, const int *row,
                               struct ct_blocks *J_d, ct_ex *dq, ct_ex *du, ct_ex *shift)
{
    const size_t m = J_d->rank;
    ct_ex *r = CT_NEWN(a, ct_ex, m + 1);
    for (size_t i = 0; i < m; i++)
        r[i] = ct_ex_neg(x, e->row[row[i]].phi);
    ct_blocks_solve(J_d, r, dq);
    for (size_t i = 0; i < m; i++)
        r[i] = ct_ex_neg(x, e->row[row[i]].v);
    ct_blocks_solve(J_d, r, du);
    if (!shift)
        return;
    negative_velocity_change(a, x, e, row, m, dq, r);
    ct_blocks_solve(J_d, r, shift);
}
