// Gauss-Legendre quadrature of expressions.
#include "expr/quadrature.h"
#include "base/pi.h"

#include <assert.h>
#include <math.h>

// P_n(z) and its derivative by the three-term recurrence.
static double legendre(int n, double z, double *slope)
{
    double p = 1, before = 0;
    for (int k = 1; k <= n; k++) {
        const double next = ((2 * k - 1) * z * p - (k - 1) * before) / k;
        before = p;
        p = next;
    }
    *slope = n * (z * p - before) / (z * z - 1);
    return p;
}

void ct_gauss(int n, double point[], double weight[])
{
    assert(n >= 1 && n <= CT_GAUSS_MOST);
    for (int i = 0; i < (n + 1) / 2; i++) {
        const bool middle = 2 * i + 1 == n;
        double z = middle ? 0 : cos(CT_PI * (i + 0.75) / (n + 0.5)), slope = 1;
        // the estimate is good to 1e-2 / n^2, each step doubles the digits
        for (int step = 0; step < 5 && !middle; step++)
            z -= legendre(n, z, &slope) / slope;
        legendre(n, z, &slope);
        point[i] = (1 - z) / 2;
        point[n - 1 - i] = (1 + z) / 2;
        weight[i] = weight[n - 1 - i] = 1 / ((1 - z * z) * slope * slope);
    }
}

static const uint32_t none = UINT32_MAX; // not a polynomial
// Limit: largest degree that is distinguished, far above that of a rule; the sum of two such
// degrees stays far below `none`
static const uint32_t most = 1000;

static uint32_t larger(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

static uint32_t node_degree(const struct ct_exs *x, uint32_t id, ct_ex s)
{
    const struct ct_exnode *n = &x->node[id];
    const int narg = ct_op_info[n->op].narg;
    if (narg == 0)
        return id == s.id;
    const uint32_t arg[3] = {n->a, n->b, n->c};
    uint32_t d[3] = {0}, highest = 0;
    for (int i = 0; i < narg; i++) {
        d[i] = x->memo[arg[i]].id;
        highest = larger(highest, d[i]);
    }
    if (highest == none || highest == 0)
        return highest;
    double k;
    switch ((enum ct_op)n->op) {
    case CT_OP_ADD:
    case CT_OP_SUB:
    case CT_OP_NEG:
        return highest;
    case CT_OP_MUL:
        return d[0] + d[1] <= most ? d[0] + d[1] : none;
    case CT_OP_DIV:
        return d[1] == 0 ? d[0] : none;
    case CT_OP_POW:
        if (ct_ex_is_const(x, (ct_ex){n->b}, &k) && k >= 0 && k == floor(k) && k * d[0] <= most)
            return (uint32_t)k * d[0];
        return none;
    default:
        return none;
    }
}

int ct_ex_degree(struct ct_exs *x, ct_ex f, ct_ex s)
{
    const size_t n = ct_ex_walk(x, &f, 1);
    for (size_t i = 0; i < n; i++)
        x->memo[x->stack[i]] = (ct_ex){node_degree(x, x->stack[i], s)};
    const uint32_t degree = x->memo[f.id].id;
    return degree == none ? -1 : (int)degree;
}

ct_ex ct_ex_integral(struct ct_exs *x, ct_ex f, ct_ex s, ct_ex a, ct_ex b, int n)
{
    double point[CT_GAUSS_MOST], weight[CT_GAUSS_MOST];
    const ct_ex length = ct_ex_sub(x, b, a);
    ct_ex sum = CT_EX_ZERO;
    ct_gauss(n, point, weight);
    for (int i = 0; i < n; i++) {
        const ct_ex at = ct_ex_add(x, a, ct_ex_scale(x, point[i], length));
        sum = ct_ex_add(x, sum, ct_ex_scale(x, weight[i], ct_ex_subst(x, f, &s, &at, 1)));
    }
    return ct_ex_mul(x, length, sum);
}
