// M = L' D L from the last speed to the first, unrolled: speeds are numbered from ground outwards, so this
// order makes no fill in a branched chain, and entries that are zero by structure cost nothing. M is
// positive definite, so no pivots are sought. Source: Featherstone (2008), key featherstone2008, 8.5.
#include "formulate/solution.h"

// Beyond this a loop over a dense matrix is as fast as straight-line code.
static const size_t most_speeds = 24;

void ct_solution_derive(struct ct_build *b)
{
    struct ct_equations *e = b->eqs;
    struct ct_exs *x = b->x;
    const size_t n = e->nu;
    if (e->nrow || n == 0 || n > most_speeds)
        return;
    ct_ex *H = CT_NEWN(b->arena, ct_ex, n * n), *u = CT_NEWN(b->arena, ct_ex, n);
    for (size_t i = 0; i < e->nM; i++)
        H[(size_t)e->M[i].row + n * (size_t)e->M[i].column] = e->M[i].value;
    // H becomes D on the diagonal and L (unit, lower) below
    for (size_t k = n; k-- > 0;)
        for (size_t i = k; i-- > 0;) {
            const ct_ex a = ct_ex_div(x, H[k + n * i], H[k + n * k]);
            for (size_t j = 0; j <= i; j++)
                H[i + n * j] = ct_ex_sub(x, H[i + n * j], ct_ex_mul(x, a, H[k + n * j]));
            H[k + n * i] = a;
        }
    for (size_t k = 0; k < n; k++)
        u[k] = e->Q[k];
    for (size_t k = n; k-- > 0;) // L' z = Q
        for (size_t i = 0; i < k; i++)
            u[i] = ct_ex_sub(x, u[i], ct_ex_mul(x, H[k + n * i], u[k]));
    for (size_t k = 0; k < n; k++) { // D y = z, L u = y
        u[k] = ct_ex_div(x, u[k], H[k + n * k]);
        for (size_t i = 0; i < k; i++)
            u[k] = ct_ex_sub(x, u[k], ct_ex_mul(x, H[k + n * i], u[i]));
    }
    e->solution = u;
}
